//! Frequency responses from a sheet and files, compared with those of a body whose response is
//! known.
//!
//! The body is two masses joined by a spring and a dashpot, free in space. Its histories are
//! integrated in time; the expected accelerance is the closed form in the frequency domain.

mod judged_hits;
mod moving_records;
mod response;
mod several_inputs;

use testbed::measured;

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use labio::format;
use labio::instrument::{Converter, Instrument, NoiseSpectrum};
use labio::{
    Abscissa, Channel, Ordinate, Provenance, Quantity, Rating, Record, SensorChain, Series,
    SeriesKind,
};
use ndarray::Array2;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodlab::Outcome;
use rodlab::job;
use rodlab::outcome::Verdict;

use crate::runge_kutta::after_step;
use crate::runs::{self, Folder, json, with_causes, words, write_npy};

const RATE: f64 = 8192.0;
const N: usize = 4096;
const ONSET: f64 = 0.05;
const STRUCK: f64 = 1.2;
const OTHER: f64 = 0.8;
const MASS: f64 = STRUCK + OTHER;
/// Frequency \[rad/s\] and damping ratio of the mode, which decays by 25 nepers over a record.
const OMEGA: f64 = TAU * 300.0;
const ZETA: f64 = 0.03;

fn spring() -> (f64, f64) {
    let reduced = STRUCK * OTHER / MASS;
    (reduced * OMEGA * OMEGA, 2.0 * ZETA * OMEGA * reduced)
}

/// Accelerance of the struck mass, closed form.
fn accelerance(s: Complex64) -> Complex64 {
    let (stiffness, damping) = spring();
    let z = stiffness + damping * s;
    (OTHER * s * s + z) / (STRUCK * OTHER * s * s + MASS * z)
}

/// Force of a hit: a squared sine of `peak` N and `duration`.
fn blow(t: f64, peak: f64, duration: f64) -> f64 {
    if (0.0..duration).contains(&t) {
        peak * (PI * t / duration).sin().powi(2)
    } else {
        0.0
    }
}

/// Force and acceleration of the struck mass.
fn history(n: usize, force: impl Fn(f64) -> f64) -> Record {
    history_of(Quantity::Acceleration, n, force)
}

/// Force and a motion of the struck mass, by the Runge-Kutta method with 16 steps per sample.
fn history_of(quantity: Quantity, n: usize, force: impl Fn(f64) -> f64) -> Record {
    const STEPS: usize = 16;
    let h = 1.0 / RATE / STEPS as f64;
    let (stiffness, damping) = spring();
    // elongation and its rate, velocity of the centre of mass
    let rates = |t: f64, [q, p, _]: [f64; 3]| {
        let tension = stiffness * q + damping * p;
        let apart = force(t) / STRUCK - tension * MASS / (STRUCK * OTHER);
        [p, apart, force(t) / MASS]
    };
    let mut state = [0.0; 3];
    let mut samples = Array2::zeros((2, n));
    for k in 0..n {
        let start = k as f64 / RATE;
        samples[[0, k]] = force(start);
        let tension = stiffness * state[0] + damping * state[1];
        samples[[1, k]] = match quantity {
            Quantity::Velocity => state[2] + OTHER / MASS * state[1],
            _ => (force(start) - tension) / STRUCK,
        };
        for step in 0..STEPS {
            state = after_step(state, start + step as f64 * h, h, rates);
        }
    }
    let channels = vec![
        Channel::new("force", Quantity::Force).unwrap(),
        Channel::new("acceleration", quantity).unwrap(),
    ];
    Record::new(
        samples,
        RATE,
        0.0,
        channels,
        Provenance::computed("two masses"),
    )
    .unwrap()
}

/// Returns `history` as recorded with 24 bits and ±10 V, sensitivities of 2 mV/N and 100 mV/g, and
/// noise of `density` V²/Hz on the response and a hundredth of that on the force.
fn recorded(history: &Record, density: f64, seed: u64) -> Record {
    let chain = |value: f64, unit: &str| {
        SensorChain::of_sensitivity(Rating::new(value, unit).unwrap()).unwrap()
    };
    let instrument = Instrument::new()
        .sense("force", chain(2.0, "mV/N"))
        .sense("acceleration", chain(100.0, "mV/g"))
        .noise("force", NoiseSpectrum::white(density / 100.0).unwrap())
        .noise("acceleration", NoiseSpectrum::white(density).unwrap())
        .convert(Converter::new(24, 10.0).unwrap());
    let taken = instrument
        .record(history, &mut ChaCha8Rng::seed_from_u64(seed))
        .unwrap();
    assert!(taken.saturations.is_empty());
    taken.record
}

const NOISE: f64 = 1e-9;

/// Writes the record in volts without names or units, as some recorders export it.
fn write(path: &Path, volts: &Record) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let rows: Vec<Vec<f64>> = volts
        .samples()
        .rows()
        .into_iter()
        .map(|row| row.to_vec())
        .collect();
    write_npy(path, &rows);
}

fn hits(n_hits: u64, duration: f64, density: f64) -> Folder {
    let folder = Folder::new();
    write_hits(folder.path(), n_hits, duration, density);
    folder
}

fn write_hits(folder: &Path, n_hits: u64, duration: f64, density: f64) {
    write_hits_from(0, folder, n_hits, duration, density);
}

/// Writes hits; the noise of hit `n` has the seed `seed + n`.
fn write_hits_from(seed: u64, folder: &Path, n_hits: u64, duration: f64, density: f64) {
    for hit in 0..n_hits {
        let peak = 150.0 + 10.0 * hit as f64;
        let history = history(N, |t| blow(t - ONSET, peak, duration));
        write(
            &folder.join(format!("hit_{hit}.npy")),
            &recorded(&history, density, seed + hit),
        );
    }
}

fn records(files: &str) -> String {
    format!(
        r#"(files: ["{files}"], sampling_rate: "8192 Hz", channels: [
            (name: "hammer", from: 1, unit: "V", sensitivity: "2 mV/N ± 1 %"),
            (name: "struck end", from: 2, unit: "V", sensitivity: "100 mV/g ± 2 %"),
        ])"#
    )
}

/// A sheet with the fields `rest`.
fn sheet_of(files: &str, rest: &str) -> String {
    format!(
        r#"Frf(title: "Two masses", records: {}, input: "hammer", {rest})"#,
        records(files)
    )
}

fn run(folder: &Folder, text: &str) -> Result<Outcome, String> {
    let here = folder.path().display().to_string();
    let run = folder.run(text);
    run.map_err(|error| with_causes(&error).replace(&here, "FOLDER"))
}

/// The outcome of a sheet with these further fields.
fn frf(folder: &Folder, files: &str, rest: &str) -> Result<Outcome, String> {
    run(folder, &sheet_of(files, rest))
}

fn column(outcome: &Outcome, table: &str, column: &str) -> Vec<f64> {
    runs::column(outcome, table, column).to_vec()
}

fn quantity(outcome: &Outcome, name: &str) -> (f64, Option<f64>) {
    let found = runs::quantity(outcome, name);
    (found.value.unwrap(), found.standard_error)
}

/// Frequencies and values of the response in the table.
fn response(outcome: &Outcome, kind: &str) -> Vec<(f64, Complex64)> {
    let of = |name: String| column(outcome, "response_struck_end", &name);
    let frequency = column(outcome, "response_struck_end", "frequency");
    let real = of(format!("real part of {kind}"));
    let imaginary = of(format!("imaginary part of {kind}"));
    frequency
        .into_iter()
        .zip(real.into_iter().zip(imaginary))
        .map(|(f, (re, im))| (f, Complex64::new(re, im)))
        .collect()
}

fn on_axis(frequency_hz: f64) -> Complex64 {
    Complex64::new(0.0, TAU * frequency_hz)
}

/// Mean of |δH|² divided by the variance in the table, and the fraction of lines beyond two
/// standard deviations.
fn spread(outcome: &Outcome, kind: &str, truth: impl Fn(f64) -> Complex64) -> (f64, f64) {
    let errors = column(
        outcome,
        "response_struck_end",
        "random error of the magnitude",
    );
    let ratios: Vec<f64> = response(outcome, kind)
        .into_iter()
        .zip(errors)
        .map(|((f, value), percent)| {
            // variance of the complex value, twice that of the magnitude
            let variance = 2.0 * (value.norm() * percent / 100.0).powi(2);
            (value - truth(f)).norm_sqr() / variance
        })
        .collect();
    let n = ratios.len() as f64;
    let beyond = ratios.iter().filter(|ratio| **ratio > 4.0).count() as f64;
    (ratios.iter().sum::<f64>() / n, beyond / n)
}

const BAND: &str = r#"band: (from: "20 Hz", to: "1.2 kHz"),"#;
