//! The two-point method on virtual tests: end accelerations by integration of the equations of motion along the rod,
//! which shares nothing with the equation that the method solves.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

use std::f64::consts::TAU;

use cmod::branch::BranchDoubt;
use cmod::estimate::Termination;
use cmod::validity::{
    AcceptanceLimits, GREATEST_ERROR_AMPLIFICATION, GREATEST_LOSS_FACTOR_ERROR,
    GREATEST_STORAGE_MODULUS_ERROR, Violation,
};
use cmod::{ModulusLine, Solver, Specimen, TwoPoint};
use num_complex::Complex64;
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{ComplexModulus, PowerLawPropagation};
use rodwave::transition::{State, TransitionMatrix};

/// The usual limits, for waves without lateral inertia.
const ONE_DIMENSIONAL: AcceptanceLimits = AcceptanceLimits {
    storage_modulus: GREATEST_STORAGE_MODULUS_ERROR,
    loss_factor: GREATEST_LOSS_FACTOR_ERROR,
    error_amplification: GREATEST_ERROR_AMPLIFICATION,
    ..AcceptanceLimits::NONE
};

/// Mass of the accelerometers of paper A with their connectors [kg].
const ACCELEROMETER: f64 = 2.9e-3;

/// Polypropylene as a virtual material: constant loss factor 0.07, of the size that paper A, figure 3 shows.
struct ConstantLoss;

impl ComplexModulus for ConstantLoss {
    fn at(&self, omega: f64) -> Complex64 {
        Complex64::new(2.6e9, 0.07 * 2.6e9 * omega.signum())
    }
}

/// Polyamide 6 by paper E, eq. 7, with `fraction` of its damping coefficient.
fn polyamide(fraction: f64) -> PowerLawPropagation {
    PowerLawPropagation::new(fraction * 8.818e-5, 0.894, 8.937e-4, 0.970).unwrap()
}

fn specimen(diameter_mm: f64, length_mm: f64, density: f64) -> Specimen {
    Specimen {
        length: 1e-3 * length_mm,
        diameter: 1e-3 * diameter_mm,
        density,
        accelerometer_mass: ACCELEROMETER,
    }
}

/// Paper A, table 2.
fn tests_1_to_9() -> [Specimen; 9] {
    [
        specimen(10.7, 199.0, 904.0),
        specimen(10.7, 401.0, 906.0),
        specimen(10.6, 801.0, 903.0),
        specimen(15.7, 201.0, 918.0),
        specimen(15.8, 400.0, 908.0),
        specimen(15.8, 799.0, 912.0),
        specimen(18.8, 201.0, 918.0),
        specimen(18.8, 400.0, 915.0),
        specimen(18.8, 800.0, 915.0),
    ]
}

fn test_10() -> Specimen {
    specimen(10.7, 800.0, 1118.0)
}

/// Ψ by integration of paper E, eq. A2, from the free end with its accelerometer to the impacted end, with the classical
/// fourth-order Runge-Kutta method in steps of |γ|h = 4e-3: the error is |γL| (|γ|h)⁴/120 < 2e-10 for |γL| < 64.
fn integrated_ratio<L: PropagationLaw>(
    medium: &Medium<L>,
    specimen: &Specimen,
    frequency_hz: f64,
) -> Complex64 {
    let omega = TAU * frequency_hz;
    let force_rate = Complex64::new(0.0, omega * medium.density() * specimen.area());
    let velocity_rate = Complex64::new(0.0, omega) / (medium.modulus(omega) * specimen.area());
    let derivative = |n: Complex64, v: Complex64| (force_rate * v, velocity_rate * n);
    let steps = (0..)
        .map(|j| 64 << j)
        .find(|&steps| {
            let phase = medium.propagation_coefficient(omega).norm() * specimen.length;
            phase / f64::from(steps) < 4e-3
        })
        .unwrap_or(64);
    let h = -specimen.length / f64::from(steps);
    let mut v = Complex64::ONE;
    let mut n = Complex64::new(0.0, -omega * specimen.accelerometer_mass);
    for _ in 0..steps {
        let (n1, v1) = derivative(n, v);
        let (n2, v2) = derivative(n + n1 * (h / 2.0), v + v1 * (h / 2.0));
        let (n3, v3) = derivative(n + n2 * (h / 2.0), v + v2 * (h / 2.0));
        let (n4, v4) = derivative(n + n3 * h, v + v3 * h);
        n += (n1 + 2.0 * n2 + 2.0 * n3 + n4) * (h / 6.0);
        v += (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (h / 6.0);
    }
    v
}

/// A record as an analyser would give it.
struct Record {
    frequency_hz: Vec<f64>,
    ratio: Vec<Complex64>,
}

impl Record {
    fn of<L: PropagationLaw>(
        medium: &Medium<L>,
        specimen: &Specimen,
        frequency_hz: Vec<f64>,
    ) -> Self {
        let ratio = frequency_hz
            .iter()
            .map(|&f| integrated_ratio(medium, specimen, f))
            .collect();
        Self {
            frequency_hz,
            ratio,
        }
    }

    fn estimate(&self, specimen: Specimen, solver: Solver) -> Vec<ModulusLine> {
        let estimate = TwoPoint::new(specimen)
            .unwrap()
            .with_limits(ONE_DIMENSIONAL)
            .unwrap()
            .with_solver(solver)
            .estimate(
                &self.frequency_hz,
                &self.ratio,
                &vec![0.0; self.ratio.len()],
            )
            .unwrap();
        assert!(estimate.refused().is_empty());
        estimate.lines().to_vec()
    }
}

/// From 25 Hz to 20 kHz in steps of 25 Hz.
fn dense_lines() -> Vec<f64> {
    (1..=800).map(|j| 25.0 * f64::from(j)).collect()
}

/// The 1572 lines between 362 Hz and 20 kHz.
fn lines_of_test_10() -> Vec<f64> {
    (0..1572)
        .map(|j| 362.0 + (20_000.0 - 362.0) * f64::from(j) / 1571.0)
        .collect()
}

/// Number of lines whose root is not that of the material.
fn wrong_roots<L: PropagationLaw>(lines: &[ModulusLine], medium: &Medium<L>) -> usize {
    lines
        .iter()
        .filter(|line| {
            let exact = medium.propagation_coefficient(TAU * line.frequency_hz);
            (line.propagation_coefficient - exact).norm() > 1e-4 * exact.norm()
        })
        .count()
}

fn check_recovery<L: PropagationLaw>(name: &str, medium: &Medium<L>, specimen: Specimen) {
    let record = Record::of(medium, &specimen, dense_lines());
    let mut valid = 0;
    for line in record.estimate(specimen, Solver::Continuation) {
        let omega = TAU * line.frequency_hz;
        let exact = medium.modulus(omega);
        let error = (line.modulus - exact).norm() / exact.norm();
        // The error of the integration, 3e-12 a radian, and 1e-13 of rounding, both of the largest velocity in the rod;
        // it comes out amplified.
        let phase = line.propagation_coefficient.norm() * specimen.length;
        let largest = (line.propagation_coefficient.re * specimen.length).exp()
            * (1.0 + specimen.mass_ratio() * phase);
        let ratio_error = largest * (3e-12 * phase + 1e-13) / record.ratio[line.index].norm();
        let tolerance = line.error_amplification * ratio_error;
        assert!(
            error < tolerance,
            "{name}, {} Hz: {error:e} > {tolerance:e}",
            line.frequency_hz
        );
        assert!(matches!(line.termination, Termination::Converged { .. }));
        let wavelength = medium.phase_velocity(omega) / line.frequency_hz;
        let slender = wavelength > 5.0 * specimen.diameter;
        let long = wavelength < 5.0 * specimen.length;
        assert_eq!(
            line.validity.is_valid(),
            slender && long,
            "{name}: {}",
            line.validity
        );
        if line.validity.is_valid() {
            valid += 1;
            // What a user sees wherever the paper would plot the line: the error of the generator, 4e-12, and no more.
            assert!(error < 1e-11, "{name}, {} Hz: {error:e}", line.frequency_hz);
        }
    }
    assert!(valid > 600, "{name}: {valid} valid lines"); // the shortest specimen begins at 1.7 kHz
}

#[test]
fn the_modulus_of_every_specimen_of_paper_a_is_recovered() {
    for (index, specimen) in tests_1_to_9().into_iter().enumerate() {
        let medium = Medium::new(specimen.density, ConstantLoss).unwrap();
        check_recovery(&format!("Test {}", index + 1), &medium, specimen);
    }
    let medium = Medium::new(test_10().density, polyamide(1.0)).unwrap();
    check_recovery("Test 10", &medium, test_10());
}

/// The two generators, integration and transition matrices of ten slices, agree: Ψ is what it is meant to be, with the
/// impacted end over the free end, and the mass of the accelerometer at the impacted end does not matter.
#[test]
fn the_ratio_is_impacted_end_over_free_end() {
    let specimen = test_10();
    let medium = Medium::new(specimen.density, polyamide(1.0)).unwrap();
    for frequency_hz in [30.0, 500.0, 3210.0, 9000.0] {
        let omega = TAU * frequency_hz;
        let slice = TransitionMatrix::uniform_rod(
            medium.propagation_coefficient(omega),
            medium.specific_characteristic_impedance(omega) * specimen.area(),
            specimen.length / 10.0,
        )
        .unwrap();
        let mass = TransitionMatrix::lumped_mass(ACCELEROMETER, omega).unwrap();
        let rod = (0..10).fold(TransitionMatrix::identity(), |rod, _| slice * rod);
        // struck from the left with a force of 1 N s on the left accelerometer
        let whole = mass * rod * mass;
        let impacted = State {
            normal_force: Complex64::from(-1.0),
            velocity: whole.mobility_free_end().unwrap(),
        };
        let free = whole.transfer(impacted);
        assert!(free.normal_force.norm() < 1e-12);
        let ratio = impacted.velocity / free.velocity;
        let integrated = integrated_ratio(&medium, &specimen, frequency_hz);
        // 2e-10 of the integration, see there; forward transfer costs e^{2αL} < 20 of the rounding.
        assert!(
            (ratio - integrated).norm() < 1e-9 * ratio.norm(),
            "{frequency_hz} Hz"
        );
    }
}

/// Newton's iteration as printed against continuation, at a fifth of the loss of polyamide 6 and μ = 0.036.
#[test]
fn newton_as_printed_runs_to_wrong_roots_at_low_loss_and_continuation_does_not() {
    let medium = Medium::new(test_10().density, polyamide(0.2)).unwrap();
    let mut specimen = test_10();
    specimen.accelerometer_mass *= 0.036 / specimen.mass_ratio();
    let record = Record::of(&medium, &specimen, lines_of_test_10());

    let newton = record.estimate(specimen, Solver::Newton);
    let failures = wrong_roots(&newton, &medium);
    // 294 in an independent computation; lines at the border of a basin may fall either way.
    assert!(failures.abs_diff(294) <= 3, "{failures}");
    // Conditions (i)-(iii) find out most of them, but not all.
    let valid: Vec<_> = newton
        .into_iter()
        .filter(|line| line.validity.is_valid())
        .collect();
    let unseen = wrong_roots(&valid, &medium);
    assert!(unseen > 0 && unseen < failures / 10, "{unseen}");

    let continuation = record.estimate(specimen, Solver::Continuation);
    assert_eq!(wrong_roots(&continuation, &medium), 0);
    assert!(
        continuation
            .iter()
            .all(|line| line.termination.was_successful())
    );
    assert!(
        continuation
            .iter()
            .all(|line| line.closed_form.unwrap().doubt.is_none())
    );
}

/// Paper A, section 5: for μ < 0.04 the series does as well as the iteration, within (i) and (ii).
#[test]
fn series_serves_for_small_mass_ratios() {
    let specimen = specimen(15.8, 799.0, 912.0);
    assert!(specimen.mass_ratio() < 0.04);
    let medium = Medium::new(specimen.density, ConstantLoss).unwrap();
    let record = Record::of(&medium, &specimen, dense_lines());
    let exact = record.estimate(specimen, Solver::Continuation);
    let series = record.estimate(specimen, Solver::Series);
    let mut accepted = 0;
    for (line, exact) in series.iter().zip(&exact) {
        let truncated = line
            .validity
            .violations()
            .iter()
            .any(|violation| matches!(violation, Violation::SeriesTruncated { .. }));
        if truncated {
            continue;
        }
        accepted += 1;
        let error = (line.modulus - exact.modulus).norm() / exact.modulus.norm();
        // The criterion lets the third and fourth terms change E'' by a third, which is 0.023 of |E| at this loss factor;
        // the terms left out are smaller.
        assert!(error < 0.023, "{} Hz: {error}", line.frequency_hz);
    }
    // All but the multiples of π, where coth γ₀L is large, and the upper end.
    assert!(accepted > series.len() / 2, "{accepted}");
}

/// Numbers of mean 0 and variance 1, by a linear congruential generator and the transformation of Box and Muller.
struct Normal {
    state: u64,
}

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.state = self
            .state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// E|z|² = `variance`, half in each part.
    fn circular(&mut self, variance: f64) -> Complex64 {
        let radius = (-variance * self.uniform().ln()).sqrt();
        Complex64::from_polar(radius, TAU * self.uniform())
    }
}

/// Standard errors against the scatter of 4000 noisy repetitions.
#[test]
fn standard_errors_are_those_of_a_monte_carlo_experiment() {
    let specimen = specimen(10.7, 401.0, 906.0);
    let medium = Medium::new(specimen.density, ConstantLoss).unwrap();
    // from poor to good: kL = 0.6, π/2, 0.9 π, 3π/2 and beyond
    let frequency_hz = vec![400.0, 1060.0, 1900.0, 3150.0, 6000.0];
    let record = Record::of(&medium, &specimen, frequency_hz.clone());
    let deviation = 1e-3;
    let variance: Vec<f64> = record
        .ratio
        .iter()
        .map(|r| r.norm_sqr() * deviation * deviation)
        .collect();
    let method = TwoPoint::new(specimen).unwrap();
    let method = method.with_limits(ONE_DIMENSIONAL).unwrap();
    let clean = method
        .estimate(&frequency_hz, &record.ratio, &variance)
        .unwrap();

    let repetitions = 4000;
    let mut normal = Normal { state: 1993 };
    let mut squares = [[0.0; 3]; 5];
    for _ in 0..repetitions {
        let noisy: Vec<Complex64> = record
            .ratio
            .iter()
            .zip(&variance)
            .map(|(ratio, variance)| ratio + normal.circular(*variance))
            .collect();
        let estimate = method.estimate(&frequency_hz, &noisy, &variance).unwrap();
        for ((line, clean), squares) in estimate.lines().iter().zip(clean.lines()).zip(&mut squares)
        {
            let error = line.modulus - clean.modulus;
            squares[0] += error.re * error.re;
            squares[1] += error.im * error.im;
            squares[2] += (line.loss_factor - clean.loss_factor).powi(2);
        }
    }
    for (line, squares) in clean.lines().iter().zip(squares) {
        let found = squares.map(|square| (square / f64::from(repetitions)).sqrt());
        let error = line.standard_error;
        let expected = [error.storage_modulus, error.loss_modulus, error.loss_factor];
        for (found, expected) in found.into_iter().zip(expected) {
            // Scatter of a standard deviation from 4000 values: 1/8000^½ = 1.1 %; four of them.
            assert!(
                (found / expected - 1.0).abs() < 0.045,
                "{} Hz: {found:e} instead of {expected:e}",
                line.frequency_hz
            );
        }
    }
}

/// Noise of 0.5 % and 2 % of Ψ from 12.5 Hz on, where it drowns the signal: above 362 Hz the waves are counted right.
#[test]
fn branches_survive_mild_noise() {
    let specimen = test_10();
    let frequency_hz: Vec<f64> = (1..=1600).map(|j| 12.5 * f64::from(j)).collect();
    for fraction in [1.0, 0.2] {
        let medium = Medium::new(specimen.density, polyamide(fraction)).unwrap();
        let clean = Record::of(&medium, &specimen, frequency_hz.clone());
        for (noise, seed) in [0.005, 0.02]
            .into_iter()
            .flat_map(|noise| (1..=5).map(move |seed| (noise, seed)))
        {
            let mut normal = Normal { state: seed };
            let noisy =
                |ratio: &Complex64| ratio + normal.circular(noise * noise * ratio.norm_sqr());
            let record = Record {
                frequency_hz: frequency_hz.clone(),
                ratio: clean.ratio.iter().map(noisy).collect(),
            };
            let label = format!("loss x {fraction}, noise {noise}, seed {seed}");
            for line in record.estimate(specimen, Solver::Continuation) {
                let doubt = line.closed_form.unwrap().doubt;
                // At a multiple of π a single line may be doubtful; the count never is.
                assert!(
                    !doubt.is_some_and(|doubt| doubt.is_ambiguous())
                        || matches!(doubt, Some(BranchDoubt::OtherRoot { .. })),
                    "{label}: {doubt:?}"
                );
                if line.frequency_hz > 362.0 {
                    let exact = medium.wave_number(TAU * line.frequency_hz);
                    let off = (line.propagation_coefficient.im - exact).abs() * specimen.length;
                    // A miscount is off by π, or by twice the distance to the nearest nπ. Near nπ noise alone makes
                    // (2 x 0.02)^½ = 0.2 rad, and up to twice that.
                    assert!(off < 0.5, "{label}, {} Hz: {off} rad", line.frequency_hz);
                }
            }
        }
    }
}
