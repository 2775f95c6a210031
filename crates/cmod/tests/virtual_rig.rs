//! The tests of papers A and B simulated with all steps of a laboratory: exact histories at the
//! sensors, anti-alias filter, noise, converter, ten hits, averaged spectra and modulus. The true
//! values are known.

pub(crate) mod coverage;
mod paper_a;
mod paper_b;

use labio::{AveragedSpectra, Record};
use rand_distr::{Distribution, Uniform};
use testbed::recorder::Recorder;

/// Number of hits of a test (paper A, section 3).
const BLOWS: usize = 10;

fn blows(recorder: &Recorder, seed: u64) -> Vec<Record> {
    let strength = Uniform::new(0.9, 1.1).unwrap();
    let drawn = |random: &mut _| strength.sample(random);
    recorder.blows(1.0, BLOWS, seed, drawn).unwrap()
}

/// Returns the spectra averaged over the hits of test `seed`.
fn averaged(recorder: &Recorder, seed: u64) -> AveragedSpectra {
    recorder.averaged(&blows(recorder, seed)).unwrap()
}
