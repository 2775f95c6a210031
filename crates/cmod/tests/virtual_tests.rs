//! The two-point method on virtual tests: end accelerations are computed by integration of the
//! equations of motion along the rod, independently of the equation that the method solves.

use std::f64::consts::TAU;

use cmod::estimate::Termination;
use cmod::validity::AcceptanceLimits;
use cmod::{ModulusEstimate, Specimen, TwoPoint};
use num_complex::Complex64;
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::ComplexModulus;
use testbed::claim::{Claims, Within};
use testbed::difference::relative;
use testbed::hold;
use testbed::papers::paper_a;

use crate::materials::polyamide;

/// Polypropylene as a virtual material, with the constant loss factor of 0.07 of paper A, figure 3.
struct ConstantLoss;

impl ComplexModulus for ConstantLoss {
    fn at(&self, omega: f64) -> Complex64 {
        Complex64::new(2.6e9, 0.07 * 2.6e9 * omega.signum())
    }
}

/// Returns Ψ by integration of paper E, eq. A2, from the free end with its accelerometer to the
/// impacted end, with the classical fourth-order Runge-Kutta method in steps of |γ|h = 4e-3: the
/// error is |γL| (|γ|h)⁴/120 < 2e-10 for |γL| < 64.
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

fn estimate(specimen: Specimen, frequency_hz: &[f64], ratio: &[Complex64]) -> ModulusEstimate {
    TwoPoint::new(specimen)
        .and_then(|method| method.with_limits(AcceptanceLimits::ONE_DIMENSIONAL))
        .and_then(|method| method.estimate(frequency_hz, ratio, &vec![0.0; ratio.len()]))
        .unwrap()
}

/// Returns the largest relative error of the modulus on valid lines of 25 Hz to 20 kHz. Lines are
/// valid if they fulfil conditions (i) and (ii).
fn error_of<L: PropagationLaw>(name: &str, medium: &Medium<L>, specimen: Specimen) -> f64 {
    let frequency_hz: Vec<f64> = (1..=800).map(|j| 25.0 * f64::from(j)).collect();
    let of_line = |f: &f64| integrated_ratio(medium, &specimen, *f);
    let ratio: Vec<Complex64> = frequency_hz.iter().map(of_line).collect();
    let found = estimate(specimen, &frequency_hz, &ratio);
    assert!(found.refused().is_empty());
    let (mut valid, mut worst) = (0, 0.0_f64);
    for line in found.lines() {
        let omega = TAU * line.frequency_hz;
        let error = relative(line.modulus, medium.modulus(omega));
        // tolerance: 3e-12 per radian for the integration and 1e-13 for rounding, both relative to
        // the largest velocity in the rod, and amplified
        let phase = line.propagation_coefficient.norm() * specimen.length;
        let largest = (line.propagation_coefficient.re * specimen.length).exp()
            * (1.0 + specimen.mass_ratio() * phase);
        let ratio_error = largest * (3e-12 * phase + 1e-13) / ratio[line.index].norm();
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
            worst = worst.max(error);
        }
    }
    assert!(valid > 600, "{name}: {valid} valid lines"); // the shortest specimen begins at 1.7 kHz
    // Condition (iii): with the opposite time factor all waves grow.
    let conjugated: Vec<Complex64> = ratio.iter().map(Complex64::conj).collect();
    let growing = estimate(specimen, &frequency_hz, &conjugated);
    assert_eq!(growing.valid().count(), 0, "{name}");
    worst
}

#[test]
fn the_modulus_of_every_specimen_of_paper_a_is_recovered() {
    let paper = paper_a::load().unwrap();
    assert_eq!(paper.tests.len(), 10);
    let mut worst = 0.0_f64;
    for test in &paper.tests {
        let specimen = test.specimen(&paper);
        let name = format!("Test {}", test.name);
        let error = if test.material == "Polyamide 6" {
            error_of(&name, &polyamide(test.density, 1.0), specimen)
        } else {
            let medium = Medium::new(test.density, ConstantLoss).unwrap();
            error_of(&name, &medium, specimen)
        };
        worst = worst.max(error);
    }
    let mut claims = Claims::default();
    claims.by("paper A, Table 2; accelerations by integration of paper E, eq. A2, along the rod");
    claims.deviation(
        "Tests 1 to 10: modulus on lines of conditions (i) to (iii) up to 20 kHz, worst of all",
        Within(1e-11, "the integration of the rod, 4e-12"),
        Ok(worst),
    );
    hold!(claims);
}
