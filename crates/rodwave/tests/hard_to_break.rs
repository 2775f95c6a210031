//! Extreme input, with values, sizes and materials at the limits of the floating-point range, and
//! laws of physics that any body must obey.

mod extremes_media;
mod hostile;
mod hostile_bodies;
mod hostile_histories;
mod hostile_laws;
mod properties_chains;
mod properties_marches;

use proptest::test_runner::{Config, RngSeed};

type Findings = hostile::Findings<rodwave::RodwaveError>;

/// Numbers that a function returns for its arguments.
type Numbers = Result<Vec<f64>, rodwave::RodwaveError>;

fn parts(values: impl IntoIterator<Item = num_complex::Complex64>) -> Vec<f64> {
    values.into_iter().flat_map(|z| [z.re, z.im]).collect()
}

fn cases(cases: u32, seed: u64) -> Config {
    Config {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..Config::default()
    }
}
