//! Virtual tests with the striker and the recorder of paper D. The response is computed by the
//! lumped chain, driven by the excitation before sampling, and extrapolated from two grids.
#![allow(dead_code, reason = "each file of tests uses what it needs")]

use maxwellid::{Provenance, RodTestData};
use rodwave::band_limited::{Recorder, SampledHistory, VelocityHistory};
use rodwave::experiment::Acquisition;
use rodwave::inelastic::InelasticLaw;
use rodwave::lumped;
use testbed::noise::Noise;
use testbed::struck_rod::{self, StruckRod};

pub(crate) const DENSITY: f64 = 1100.0;
pub(crate) const LENGTH: f64 = 0.4;
pub(crate) const V0: f64 = 10.0;
pub(crate) const RATE: f64 = 51_200.0;

/// A struck rod: both velocities as recorded, and the excitation before sampling.
pub(crate) struct VirtualRod {
    pub(crate) data: RodTestData,
    pub(crate) excitation: SampledHistory,
}

pub(crate) fn times(count: usize) -> Vec<f64> {
    struck_rod::times(count, RATE)
}

pub(crate) fn struck<L: InelasticLaw>(
    length: f64,
    velocity: f64,
    modulus: f64,
    law: &L,
    samples_after: usize,
) -> VirtualRod {
    struck_before(length, velocity, modulus, law, 32, samples_after)
}

pub(crate) fn struck_before<L: InelasticLaw>(
    length: f64,
    velocity: f64,
    modulus: f64,
    law: &L,
    samples_before: usize,
    samples_after: usize,
) -> VirtualRod {
    let acquisition = Acquisition {
        recorder: Recorder {
            rate_hz: RATE,
            cutoff_hz: 16_000.0,
        },
        samples_before,
        samples_after,
        transducer_range: 0.02,
    };
    let rod = StruckRod::of_16_mm(law, velocity, length, DENSITY, modulus, acquisition);
    let record = rod.record().unwrap();
    let cells = (length / 1.5e-3).ceil() as usize;
    let at = times(record.excitation.len());
    let response = rod
        .by_two_chains(cells, &record.excitation_before_sampling, &at)
        .unwrap();
    VirtualRod {
        data: RodTestData {
            name: "virtual rod".into(),
            length,
            density: DENSITY,
            impact_velocity: velocity,
            sampling_rate_hz: RATE,
            excitation: record.excitation,
            response,
            provenance: Provenance::Virtual {
                generator: lumped::GENERATOR.into(),
            },
        },
        excitation: record.excitation_before_sampling,
    }
}

impl VirtualRod {
    pub(crate) fn named(&self, name: &str) -> RodTestData {
        RodTestData {
            name: name.into(),
            ..self.data.clone()
        }
    }

    /// Returns the record with white noise of `deviation` [m/s] on both histories.
    pub(crate) fn noisy(&self, deviation: f64, seed: u64) -> RodTestData {
        let mut data = self.data.clone();
        add_noise(&mut data, deviation, seed);
        data
    }

    /// The displacements \[m\], the integrals of the band-limited velocity histories.
    pub(crate) fn displacements(&self) -> RodTestData {
        let mut data = self.data.clone();
        for history in [&mut data.excitation, &mut data.response] {
            *history = integrated(history);
        }
        data
    }
}

/// Adds white noise of `deviation` to both histories.
pub(crate) fn add_noise(data: &mut RodTestData, deviation: f64, seed: u64) {
    let mut noise = Noise::seeded(seed);
    data.excitation = noise.added_to(&data.excitation, deviation);
    data.response = noise.added_to(&data.response, deviation);
}

/// Integral of `velocity` at the samples, by Simpson's rule with sixteen steps between two samples.
fn integrated(velocity: &[f64]) -> Vec<f64> {
    let history = SampledHistory::new(velocity, RATE).unwrap();
    let step = 1.0 / RATE / 16.0;
    let mut displacement = 0.0;
    (0..velocity.len())
        .map(|k| {
            if k > 0 {
                let from = (k - 1) as f64 / RATE;
                displacement += (0..8)
                    .map(|i| {
                        let t = from + 2.0 * f64::from(i) * step;
                        let at = |n: f64| history.at(t + n * step);
                        step / 3.0 * (at(0.0) + 4.0 * at(1.0) + at(2.0))
                    })
                    .sum::<f64>();
            }
            displacement
        })
        .collect()
}
