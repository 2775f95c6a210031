//! Hits with faults, each of which must be found with its reason, and the measured records, if they
//! are available.

#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    clippy::panic,
    clippy::float_cmp,
    clippy::indexing_slicing,
    reason = "a failing test may panic, a skipped test prints a note, and whole numbers are exact"
)]

mod bars;
mod body;
mod long_records;
mod moving_bodies;
mod odd_hits;
mod reasons;

use testbed::measured;

use std::f64::consts::TAU;

use labio::format::npy;
use labio::hits::{
    Criteria, Extent, HitLog, HitSpectra, Reason, Slope, Trigger, find_hits, find_hits_in_blocks,
    find_odd_hits, samples_at_rest,
};
use labio::{
    AddedDamping, AveragedSpectra, Channel, Detrend, FrequencyResponse, LabioError, LineValidity,
    Provenance, Quantity, Rating, Record, SensorChain, SpectrumAverager, Window,
};
use ndarray::Array2;
use num_complex::Complex64;
use proptest::prelude::*;
use rand::RngExt;
use testbed::half_sine::half_sine;
use testbed::noise::Noise;

use crate::records::{InBlocks, record_of};

const RATE_HZ: f64 = 10_000.0;
const ONSET: usize = 500;
const N: usize = 10_000;
const FORCE: &str = "force";
const CHANNELS: [(&str, Quantity); 2] = [
    (FORCE, Quantity::Force),
    ("response", Quantity::Acceleration),
];

/// Contact of 2 ms with a peak of 1 at its middle.
fn contact(t: f64) -> f64 {
    half_sine(t / 0.002)
}

/// Oscillation that a force sensor with a resonance of 3 kHz adds after a contact, beginning with a
/// swing to the other side.
fn ringing(t: f64) -> f64 {
    let t = t - 0.002;
    if t > 0.0 {
        -0.1 * (-t / 0.001).exp() * (TAU * 3000.0 * t).sin()
    } else {
        0.0
    }
}

fn response(t: f64) -> f64 {
    if t > 0.0 {
        400.0 * (-t / 0.05).exp() * (TAU * 700.0 * t).sin()
    } else {
        0.0
    }
}

/// A good hit of 80 N with noise and ringing; each modification must be detected.
fn hit(change: impl Fn(usize, f64, &mut f64, &mut f64)) -> Record {
    let mut rng = Noise::seeded(17);
    let mut samples = Array2::zeros((2, N));
    for k in 0..N {
        let t = (k as f64 - ONSET as f64) / RATE_HZ;
        let mut force = 80.0 * (contact(t) + ringing(t)) + 0.05 * rng.normal();
        let mut acceleration = response(t) + 0.2 * rng.normal();
        change(k, t, &mut force, &mut acceleration);
        samples[[0, k]] = force;
        samples[[1, k]] = acceleration;
    }
    record_of(samples, RATE_HZ, &CHANNELS)
}

fn reasons(record: &Record) -> Vec<Reason> {
    Criteria::default().judge(record, FORCE, None).unwrap()
}

/// Returns the only reason for rejecting the record; panics if there is not exactly one.
fn only(record: &Record) -> Reason {
    let mut found = reasons(record);
    assert_eq!(found.len(), 1, "{found:#?}");
    found.remove(0)
}
