//! Virtual struck rods, computed by the lumped chain, which is not the solver of the
//! identification, and written as files of a recorder.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use labio::instrument::{Instrument, NoiseSpectrum};
use labio::{Channel, Provenance, Quantity, Record};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::band_limited::{Recorder, SampledHistory};
use rodwave::experiment::Acquisition;
use rodwave::inelastic::{InelasticLaw, Maxwell};
use rodwave::line::Segment;
use rodwave::modulus::GeneralisedMaxwell;
use testbed::struck_rod::{StruckRod, by_line, rounded, times};

pub(crate) const LENGTH: f64 = 0.394;
pub(crate) const DENSITY: f64 = 912.0;
pub(crate) const MODULUS: f64 = 2.6e9;
pub(crate) const RATE: f64 = 51_200.0;

const ACQUISITION: Acquisition = Acquisition {
    recorder: Recorder {
        rate_hz: RATE,
        cutoff_hz: 16_000.0,
    },
    samples_before: 64,
    samples_after: 96,
    transducer_range: 0.020,
};

/// Both histories of one test, without noise.
pub(crate) struct Histories {
    pub(crate) near_end: Vec<f64>,
    pub(crate) free_end: Vec<f64>,
    quantity: Quantity,
}

/// Standard deviation \[s\] of the smoothing by the rounded face of a striker.
const ROUNDING: f64 = 30e-6;

fn rod<L: InelasticLaw>(law: &L, velocity: f64) -> StruckRod<L> {
    StruckRod::of_16_mm(law, velocity, LENGTH, DENSITY, MODULUS, ACQUISITION)
}

/// Velocities of a rod that is struck at `velocity` by a striker with a rounded face: the near end
/// moves as with a flat striker, smoothed by a normal density of 30 us. The rod is driven by the
/// samples, so that a recorder loses nothing.
pub(crate) fn velocities<L: InelasticLaw>(law: &L, velocity: f64) -> Histories {
    let rod = rod(law, velocity);
    let (near_end, times) = smooth_excitation(&rod);
    let driven = SampledHistory::new(&near_end, RATE).unwrap();
    Histories {
        free_end: rod.by_chain(400, &driven, &times).unwrap(),
        near_end,
        quantity: Quantity::Velocity,
    }
}

/// Velocities of a rod of linear material with parallel branches, driven like those of
/// [`velocities`].
pub(crate) fn linear_velocities(material: &GeneralisedMaxwell, velocity: f64) -> Histories {
    let (excitation, times) = smooth_excitation(&rod(&Maxwell::new(4e6).unwrap(), velocity));
    let segment = Segment::prony(LENGTH, 1e-4, DENSITY, material).unwrap();
    let driven = SampledHistory::new(&excitation, RATE).unwrap();
    Histories {
        near_end: excitation,
        free_end: by_line(segment, &driven, &times, 1.5e-6).unwrap(),
        quantity: Quantity::Velocity,
    }
}

/// Velocity of the near end [m/s] for a rounded striker, and the times of its samples \[s\].
fn smooth_excitation<L: InelasticLaw>(rod: &StruckRod<L>) -> (Vec<f64>, Vec<f64>) {
    let record = rod.record().unwrap();
    let times = times(record.excitation.len(), RATE);
    let smooth = rounded(&record.excitation_before_sampling, &times, ROUNDING);
    (smooth, times)
}

/// Velocities for a flat striker as recorded, in the order of an experiment: striker, rod, filter,
/// sampling.
pub(crate) fn velocities_of_a_flat_striker<L: InelasticLaw>(law: &L, velocity: f64) -> Histories {
    let record = rod(law, velocity).record().unwrap();
    Histories {
        near_end: record.excitation,
        free_end: record.response,
        quantity: Quantity::Velocity,
    }
}

/// Displacements of both ends for a flat striker, as recorded.
pub(crate) fn displacements<L: InelasticLaw>(law: &L, velocity: f64) -> Histories {
    let Acquisition {
        recorder,
        samples_before,
        samples_after,
        ..
    } = ACQUISITION;
    let duration = samples_after as f64 / RATE + recorder.reach();
    let test = rod(law, velocity).test().unwrap();
    let pair = test.displacements(1e-3, duration).unwrap();
    let recorded = |displacement: &[f64]| -> Vec<f64> {
        (0..samples_before + samples_after)
            .map(|k| {
                let time = (k as f64 - samples_before as f64) / RATE;
                recorder.filtered(displacement, pair.step, time)
            })
            .collect()
    };
    Histories {
        near_end: recorded(&pair.section),
        free_end: recorded(&pair.free_end),
        quantity: Quantity::Displacement,
    }
}

impl Histories {
    /// Writes a CSV with white noise of the standard deviation `noise` on both histories, with
    /// times in milliseconds and values in `unit`, the SI unit divided by `per_si`.
    pub(crate) fn write(&self, path: &Path, noise: f64, seed: u64, unit: &str, per_si: f64) {
        let samples = Array2::from_shape_fn((2, self.near_end.len()), |(channel, k)| {
            [&self.near_end, &self.free_end][channel][k]
        });
        let names = ["near end", "free end"];
        let channels = names
            .map(|name| Channel::new(name, self.quantity).unwrap())
            .to_vec();
        let exact =
            Record::new(samples, RATE, 0.0, channels, Provenance::computed("chain")).unwrap();
        let density = 2.0 * noise * noise / RATE;
        let instrument = names.into_iter().fold(Instrument::new(), |taken, name| {
            taken.noise(name, NoiseSpectrum::white(density).unwrap())
        });
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let record = instrument.record(&exact, &mut random).unwrap().record;
        let mut text = format!("time,near end,free end\nms,{unit},{unit}\n");
        for (k, (near, free)) in record
            .samples()
            .row(0)
            .iter()
            .zip(record.samples().row(1))
            .enumerate()
        {
            let time = 1e3 * record.time_at(k);
            writeln!(text, "{time},{},{}", near * per_si, free * per_si).unwrap();
        }
        fs::write(path, text).unwrap();
    }
}
