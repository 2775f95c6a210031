//! Spectra, coherence and windows against what SciPy made of the same samples: `fixtures/reference/scipy`.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a reference that cannot be read must fail the test"
)]

use labio::{
    AveragedSpectra, Channel, Detrend, Estimator, Provenance, Quantity, Record, Welch, Window,
};
use ndarray::Array2;
use num_complex::Complex64;

const REFERENCE: &str = include_str!("../../../fixtures/reference/scipy/spectra.csv");
const RATE: f64 = 2048.0;

/// Both sides round transforms of 64 samples to some 1e-16 of the root mean square line; the weakest line compared is 1e-4 of it.
const RELATIVE: f64 = 1e-12;

/// Weights are sums of five cosines at most: some roundings of 1.
const WEIGHT: f64 = 2e-15;

/// The values of a quantity of a case, in order; panics if the reference has none.
fn reference(case: &str, quantity: &str) -> Vec<Complex64> {
    let values: Vec<Complex64> = REFERENCE
        .lines()
        .skip(1)
        .map(|row| row.split(',').collect::<Vec<_>>())
        .filter(|row| row[0] == case && row[1] == quantity)
        .map(|row| Complex64::new(row[3].parse().unwrap(), row[4].parse().unwrap()))
        .collect();
    assert!(!values.is_empty(), "no reference for {quantity} of {case}");
    values
}

struct Congruence(u64);

impl Congruence {
    fn values(&mut self, n: usize) -> Vec<f64> {
        (0..n)
            .map(|_| {
                self.0 = self
                    .0
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            })
            .collect()
    }
}

fn record(n: usize) -> Record {
    let mut congruence = Congruence(1);
    let mut x = congruence.values(n);
    let e = congruence.values(n);
    let mut samples = Array2::zeros((2, n));
    let mut previous = 0.0;
    for i in 0..n {
        x[i] = x[i] + 0.25 + i as f64 / 1024.0;
        previous = 0.5 * previous + x[i];
        samples[(0, i)] = x[i];
        samples[(1, i)] = previous + 0.25 * e[i];
    }
    let channels = vec![
        Channel::new("x", Quantity::Force).unwrap(),
        Channel::new("y", Quantity::Velocity).unwrap(),
    ];
    Record::new(
        samples,
        RATE,
        0.0,
        channels,
        Provenance::computed("linear congruence"),
    )
    .unwrap()
}

fn assert_same(case: &str, quantity: &str, found: &[Complex64]) {
    let expected = reference(case, quantity);
    assert_eq!(found.len(), expected.len(), "{quantity} of {case}");
    for (line, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let difference = (found - expected).norm();
        assert!(
            difference <= RELATIVE * expected.norm(),
            "{quantity} of {case}, line {line}: {found}, SciPy {expected}"
        );
    }
}

fn complex(values: &[f64]) -> Vec<Complex64> {
    values.iter().map(|&value| value.into()).collect()
}

#[test]
fn welch_csd_and_coherence_are_scipys() {
    let welch = |n_samples, n_overlap, window, detrend| {
        Welch::new(n_samples)
            .unwrap()
            .with_overlap(n_overlap)
            .unwrap()
            .with_window(window)
            .with_detrend(detrend)
    };
    let cases = [
        (
            "hann_periodic",
            700,
            welch(64, 32, Window::HannPeriodic, Detrend::None),
        ),
        (
            "hann_periodic_mean",
            700,
            welch(64, 32, Window::HannPeriodic, Detrend::Mean),
        ),
        (
            "hann_symmetric_odd",
            500,
            welch(63, 31, Window::HannSymmetric, Detrend::Mean),
        ),
        (
            "blackman_harris_odd_linear",
            500,
            welch(51, 20, Window::BlackmanHarrisPeriodic, Detrend::Linear),
        ),
        (
            "flat_top_mean",
            600,
            welch(48, 36, Window::FlatTopPeriodic, Detrend::Mean),
        ),
        (
            "tukey",
            333,
            welch(40, 10, Window::TukeyPeriodic { taper: 0.25 }, Detrend::None),
        ),
        (
            "hamming_odd",
            333,
            welch(45, 22, Window::HammingPeriodic, Detrend::Mean),
        ),
        (
            "rectangular",
            512,
            welch(64, 0, Window::Rectangular, Detrend::None),
        ),
        (
            "hamming_symmetric_linear_75",
            411,
            welch(32, 24, Window::HammingSymmetric, Detrend::Linear),
        ),
        (
            "tukey_symmetric_odd_mean",
            407,
            welch(33, 16, Window::TukeySymmetric { taper: 0.5 }, Detrend::Mean),
        ),
        (
            "flat_top_symmetric_linear",
            300,
            welch(60, 40, Window::FlatTopSymmetric, Detrend::Linear),
        ),
        (
            "hann_periodic_linear_90",
            200,
            welch(20, 18, Window::HannPeriodic, Detrend::Linear),
        ),
    ];
    for (case, n, welch) in cases {
        let spectra = welch.spectra(&record(n)).unwrap();
        compare(case, &spectra);
    }
}

fn compare(case: &str, spectra: &AveragedSpectra) {
    let density = |channel| complex(&spectra.power_density(channel).unwrap());
    assert_same(case, "frequency", &complex(spectra.frequency_hz()));
    assert_same(case, "gxx", &density("x"));
    assert_same(case, "gyy", &density("y"));
    assert_same(case, "gxy", &spectra.cross_power_density("x", "y").unwrap());
    let mean_squares = spectra.mean_squares("x").unwrap();
    assert_same(case, "mean_squares", &complex(&mean_squares));
    let coherence = spectra.coherence("x", "y").unwrap();
    assert_same(case, "coherence", &complex(&coherence.values));

    // the estimators are ratios of what SciPy gives
    let (gxx, gyy) = (reference(case, "gxx"), reference(case, "gyy"));
    let gxy = reference(case, "gxy");
    for estimator in [Estimator::H1, Estimator::H2] {
        let response = spectra.response(estimator, "x", "y").unwrap();
        for (line, value) in response.values.iter().enumerate() {
            let expected = match estimator {
                Estimator::H1 => gxy[line] / gxx[line],
                _ => gyy[line] / gxy[line].conj(),
            };
            // a ratio of two numbers, each good to RELATIVE
            assert!((value - expected).norm() <= 2.0 * RELATIVE * expected.norm());
        }
    }
}

#[test]
fn windows_are_scipys() {
    let windows = [
        ("hann_periodic", Window::HannPeriodic),
        ("hann_symmetric", Window::HannSymmetric),
        ("hamming_periodic", Window::HammingPeriodic),
        ("hamming_symmetric", Window::HammingSymmetric),
        ("blackman_harris_periodic", Window::BlackmanHarrisPeriodic),
        ("blackman_harris_symmetric", Window::BlackmanHarrisSymmetric),
        ("flat_top_periodic", Window::FlatTopPeriodic),
        ("flat_top_symmetric", Window::FlatTopSymmetric),
        ("tukey_periodic", Window::TukeyPeriodic { taper: 0.3 }),
        ("tukey_symmetric", Window::TukeySymmetric { taper: 0.3 }),
    ];
    for (case, window) in windows {
        for n in [16, 15] {
            let expected = reference(case, &format!("weights_{n}"));
            let weights = window.sample(n).unwrap().weights;
            assert_eq!(weights.len(), expected.len());
            for (i, (weight, expected)) in weights.iter().zip(&expected).enumerate() {
                assert!(
                    (weight - expected.re).abs() < WEIGHT,
                    "{case}, {n} samples, weight {i}: {weight}, SciPy {}",
                    expected.re
                );
            }
        }
    }
}
