//! Virtual tests: the striker and the recorder of paper D, the response of the lumped chain to the
//! excitation as it was before sampling, extrapolated from two grids.

use maxwellid::{Provenance, RodTestData};
use rodwave::InelasticRod;
use rodwave::band_limited::Recorder;
use rodwave::experiment::{Acquisition, VelocityRecord};
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::InelasticLaw;
use rodwave::lumped::{self, LumpedRod};

use testbed::claim::Ours;
use testbed::noise::Noise;

pub(super) const RATE_HZ: f64 = 51_200.0;
pub(super) const DENSITY: f64 = 1100.0;
pub(super) const LENGTH: f64 = 0.4;
pub(super) const VELOCITY: f64 = 10.0;

pub(super) fn times(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 / RATE_HZ).collect()
}

/// Record of a rod 8 mm longer than the distance between the sections, by the recorder of paper D.
pub(super) fn recorded<L: InelasticLaw>(
    modulus: f64,
    law: &L,
    velocity: f64,
    samples_after: usize,
) -> Ours<VelocityRecord> {
    let test = ImpactTest {
        striker: Striker {
            velocity,
            ..Striker::PAPER_D
        },
        rod: InelasticRod::new(LENGTH + 0.008, DENSITY, modulus, law.clone())?,
        diameter: 0.016,
        section_distance: LENGTH,
    };
    let acquisition = Acquisition {
        recorder: Recorder {
            rate_hz: RATE_HZ,
            cutoff_hz: 16_000.0,
        },
        samples_before: 32,
        samples_after,
        transducer_range: 0.02,
    };
    Ok(test.record(&acquisition, 1e-3)?)
}

/// A test without noise.
pub(super) fn struck<L: InelasticLaw>(
    modulus: f64,
    law: &L,
    velocity: f64,
    samples_after: usize,
) -> Ours<RodTestData> {
    let record = recorded(modulus, law, velocity, samples_after)?;
    let rod = InelasticRod::new(LENGTH, DENSITY, modulus, law.clone())?;
    let at = times(record.excitation.len());
    let chain = |cells| -> Ours<Vec<f64>> {
        Ok(LumpedRod::new(&rod, cells, 0.5)?
            .free_end_velocity(&record.excitation_before_sampling, &at)?)
    };
    // cells of 1.5 mm and of half of that
    let (coarse, fine) = (chain(267)?, chain(534)?);
    let response = coarse
        .iter()
        .zip(fine)
        .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
        .collect();
    Ok(data(
        record.excitation,
        response,
        velocity,
        lumped::GENERATOR,
    ))
}

pub(super) fn data(
    excitation: Vec<f64>,
    response: Vec<f64>,
    velocity: f64,
    generator: &str,
) -> RodTestData {
    RodTestData {
        name: format!("virtual rod, {velocity} m/s"),
        length: LENGTH,
        density: DENSITY,
        impact_velocity: velocity,
        sampling_rate_hz: RATE_HZ,
        excitation,
        response,
        provenance: Provenance::Virtual {
            generator: generator.into(),
        },
    }
}

/// White noise of `deviation` on both histories.
pub(super) fn noisy(clean: &RodTestData, deviation: f64, seed: u64) -> RodTestData {
    let mut noise = Noise::seeded(seed);
    RodTestData {
        excitation: noise.added_to(&clean.excitation, deviation),
        response: noise.added_to(&clean.response, deviation),
        ..clean.clone()
    }
}
