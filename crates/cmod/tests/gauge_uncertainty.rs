//! Uncertain density and positions of gauges, compared with estimates for gauges that are not at
//! their stated positions.

use std::f64::consts::TAU;

use cmod::estimate::{ErrorSource, ModulusLine, SystematicShift};
use cmod::{GaugeSpectra, GaugeUncertainty, GaugedRod, ModulusEstimate, MultiPoint, ThreePoint};
use num_complex::Complex64;

const DENSITY: f64 = 919.0;
/// Error of the position of a gauge \[m\].
const OFF: f64 = 2e-5;

fn gamma(frequency_hz: f64) -> Complex64 {
    Complex64::new(0.05, 1.0) * (TAU * frequency_hz / 1700.0)
}

fn frequencies() -> Vec<f64> {
    (1..=60).map(|line| 50.0 * f64::from(line)).collect()
}

/// Returns the spectra of two waves at gauges at these positions, in two tests with different
/// waves.
fn spectra(positions: &[f64]) -> Vec<Vec<Vec<Complex64>>> {
    let backward = [Complex64::new(0.5, 0.2), Complex64::new(-0.3, 0.6)];
    backward
        .iter()
        .map(|backward| {
            let at =
                |x: f64, f: f64| (-gamma(f) * x).exp() + backward * (gamma(f) * (x - 0.4)).exp();
            positions
                .iter()
                .map(|x| frequencies().iter().map(|f| at(*x, *f)).collect())
                .collect()
        })
        .collect()
}

#[derive(Clone, Copy, Debug)]
enum Method {
    Three,
    Multi,
}

/// Returns the estimate with the positions `stated`, for gauges at `true_positions`.
fn estimate(
    method: Method,
    stated: &[f64],
    true_positions: &[f64],
    uncertainty: GaugeUncertainty,
) -> ModulusEstimate {
    of_spectra(method, stated, &spectra(true_positions), uncertainty)
}

fn of_spectra(
    method: Method,
    stated: &[f64],
    tests: &[Vec<Vec<Complex64>>],
    uncertainty: GaugeUncertainty,
) -> ModulusEstimate {
    let rod = GaugedRod {
        positions: stated.to_vec(),
        diameter: 0.016,
        density: DENSITY,
    };
    let tests: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
    let frequency_hz = frequencies();
    let spectra = GaugeSpectra {
        frequency_hz: &frequency_hz,
        tests: &tests,
        noise: &vec![vec![1e-5; frequency_hz.len()]; stated.len()],
    };
    match method {
        Method::Three => ThreePoint::new(rod)
            .and_then(|method| method.with_uncertainty(uncertainty))
            .and_then(|method| method.estimate(&spectra))
            .unwrap(),
        Method::Multi => MultiPoint::new(rod)
            .and_then(|method| method.with_uncertainty(uncertainty))
            .and_then(|method| method.estimate(&spectra))
            .unwrap()
            .modulus()
            .clone(),
    }
}

fn positions_of(n_gauges: usize, of: f64) -> GaugeUncertainty {
    GaugeUncertainty {
        positions: vec![of; n_gauges],
        ..GaugeUncertainty::default()
    }
}

/// Returns dγ and dE of a line due to one gauge.
fn shift(line: &ModulusLine, source: ErrorSource) -> SystematicShift {
    let mut shifts = line.uncertainty.systematic.iter();
    *shifts.find(|shift| shift.source == source).unwrap()
}

const CASES: [(Method, &[f64]); 3] = [
    (Method::Three, &[0.0, 0.2, 0.4]),
    (Method::Multi, &[0.0, 0.2, 0.4]),
    (Method::Multi, &[0.0, 0.07, 0.12, 0.2, 0.4]),
];

#[test]
fn r08_a_gauge_that_is_off_by_its_uncertainty_moves_every_line_by_its_shift() {
    for (method, stated) in CASES {
        let right = estimate(method, stated, stated, positions_of(stated.len(), OFF));
        assert_eq!(right.lines().len(), frequencies().len());
        for gauge in 0..stated.len() {
            let mut elsewhere = stated.to_vec();
            elsewhere[gauge] += OFF;
            let wrong = estimate(method, stated, &elsewhere, GaugeUncertainty::default());
            for (right, wrong) in right.lines().iter().zip(wrong.lines()) {
                let shift = shift(right, ErrorSource::GaugePosition(gauge));
                let (of_gamma, of_modulus) = (shift.propagation_coefficient, shift.modulus);
                let moved = wrong.propagation_coefficient - right.propagation_coefficient;
                // tolerance: the second order, which is about (OFF k)² γ because there are no
                // singular lines here
                let tolerance = 0.01 * of_gamma.norm() + 1e-7 * right.wave_number();
                assert!(
                    (moved - of_gamma).norm() < tolerance,
                    "{method:?}, gauge {gauge}, {} Hz: {moved}, expected {of_gamma}",
                    right.frequency_hz
                );
                let moved = wrong.modulus - right.modulus;
                let tolerance = 0.01 * of_modulus.norm() + 1e-7 * right.modulus.norm();
                assert!((moved - of_modulus).norm() < tolerance);
            }
        }
    }
}

/// Checks the shifts due to a sensitivity that is too large, and due to a channel that is late.
#[test]
fn a_gauge_that_reads_too_much_or_late_moves_every_line_by_its_shift() {
    const FACTOR: f64 = 1e-6;
    const DELAY: f64 = 1e-10;
    for (method, stated) in CASES {
        let uncertainty = GaugeUncertainty {
            factors: vec![FACTOR; stated.len()],
            delays: vec![DELAY; stated.len()],
            ..GaugeUncertainty::default()
        };
        let right = of_spectra(method, stated, &spectra(stated), uncertainty);
        for gauge in 0..stated.len() {
            for (source, error) in [
                (
                    ErrorSource::GaugeFactor(gauge),
                    (|_| FACTOR.into()) as fn(f64) -> Complex64,
                ),
                (ErrorSource::GaugeDelay(gauge), |f| {
                    Complex64::new(0.0, -TAU * f * DELAY)
                }),
            ] {
                let mut wrong = spectra(stated);
                for test in &mut wrong {
                    for (value, f) in test[gauge].iter_mut().zip(frequencies()) {
                        *value *= error(f).exp();
                    }
                }
                let wrong = of_spectra(method, stated, &wrong, GaugeUncertainty::default());
                for (right, wrong) in right.lines().iter().zip(wrong.lines()) {
                    let shift = shift(right, source);
                    let moved = wrong.modulus - right.modulus;
                    // tolerance: the second order, relative to the shift several times the error
                    let tolerance = 0.02 * shift.modulus.norm() + 1e-9 * right.modulus.norm();
                    assert!(
                        (moved - shift.modulus).norm() < tolerance,
                        "{method:?}, {source}, {} Hz: {moved}, expected {}",
                        right.frequency_hz,
                        shift.modulus
                    );
                }
            }
        }
    }
}

/// A common shift of all gauges changes nothing, and a common scale acts like a change of the
/// length.
#[test]
fn r08_shifts_of_all_gauges_together_are_those_of_the_whole_rod() {
    for (method, stated) in CASES {
        let estimate = estimate(method, stated, stated, positions_of(stated.len(), OFF));
        for line in estimate.lines() {
            let by = |gauge: usize| {
                let shift = shift(line, ErrorSource::GaugePosition(gauge));
                shift.propagation_coefficient / OFF
            };
            let together: Complex64 = (0..stated.len()).map(by).sum();
            let scaled: Complex64 = (0..stated.len())
                .map(|gauge| stated[gauge] * by(gauge))
                .sum();
            let size: f64 = (0..stated.len()).map(|gauge| by(gauge).norm()).sum();
            assert!(together.norm() < 1e-9 * size, "{method:?}: {together}");
            let gamma = line.propagation_coefficient;
            assert!(
                (scaled - gamma).norm() < 1e-9 * size,
                "{method:?}: {scaled} {gamma}"
            );
        }
    }
}

#[test]
fn r08_an_uncertain_density_is_a_plain_factor_that_is_the_same_on_all_lines() {
    for (method, stated) in CASES {
        let exact = estimate(method, stated, stated, GaugeUncertainty::default());
        let uncertain = GaugeUncertainty {
            density: 0.001 * DENSITY,
            ..GaugeUncertainty::default()
        };
        let uncertain = estimate(method, stated, stated, uncertain);
        for (exact, uncertain) in exact.lines().iter().zip(uncertain.lines()) {
            let of_density = |shift: &SystematicShift| shift.source == ErrorSource::Density;
            assert!(!exact.uncertainty.systematic.iter().any(of_density));
            let shift = shift(uncertain, ErrorSource::Density);
            assert!((shift.modulus / uncertain.modulus - 0.001).norm() < 1e-12);
            assert_eq!(uncertain.random_error(), exact.random_error());
            let loss = uncertain.standard_error.loss_factor / exact.standard_error.loss_factor;
            assert!((loss - 1.0).abs() < 1e-9, "a factor of E leaves E''/E'");
        }
    }
}

#[test]
fn uncertainties_are_as_many_as_gauges_and_not_below_0() {
    let rod = || GaugedRod {
        positions: vec![0.0, 0.2, 0.4],
        diameter: 0.016,
        density: DENSITY,
    };
    for positions in [vec![1e-3; 2], vec![1e-3, -1e-3, 0.0], vec![f64::NAN; 3]] {
        let uncertainty = GaugeUncertainty {
            positions,
            ..GaugeUncertainty::default()
        };
        let three = ThreePoint::new(rod()).unwrap();
        assert!(three.with_uncertainty(uncertainty.clone()).is_err());
        let multi = MultiPoint::new(rod()).unwrap();
        assert!(multi.with_uncertainty(uncertainty).is_err());
    }
}
