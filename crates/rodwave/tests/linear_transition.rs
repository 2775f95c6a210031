//! Transition matrices against integration of the equations of motion, the compound cylinder of paper E, and the
//! limits of the plain product.
#![allow(
    clippy::unwrap_used,
    reason = "in a test, a refusal where none is expected is a failure"
)]

use std::f64::consts::PI;

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::RodwaveError;
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{Elastic, PowerLawPropagation, Zener};
use rodwave::transition::{State, TransitionMatrix};

/// Length of each of the four sections of the compound cylinder [m] (paper E).
const SECTION: f64 = 0.125;

/// Cross-section of the compound cylinder, diameter 32 mm [m²].
fn area() -> f64 {
    PI * 0.032f64.powi(2) / 4.0
}

fn nylon() -> Medium<PowerLawPropagation> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    Medium::new(1150.0, law).unwrap()
}

fn aluminium() -> Medium<Elastic> {
    Medium::new(2700.0, Elastic::new(69e9).unwrap()).unwrap()
}

fn rod<L: PropagationLaw>(medium: &Medium<L>, length: f64, omega: f64) -> TransitionMatrix {
    TransitionMatrix::uniform_rod(
        medium.propagation_coefficient(omega),
        medium.specific_characteristic_impedance(omega) * area(),
        length,
    )
    .unwrap()
}

fn relative(a: Complex64, b: Complex64) -> f64 {
    (a - b).norm() / b.norm()
}

/// Paper E, eq. 9, by products of A10. The reference was computed from (9) with 40 digits and is given to 12.
#[test]
fn compound_cylinder_has_the_mobility_of_paper_e() {
    let rows = [
        (
            100.0,
            (5.82588165916e-6, -2.00742012736e-3),
            (1.91181467262e-6, -2.03921895148e-3),
        ),
        (
            1000.0,
            (7.91809056486e-5, 3.52231105718e-4),
            (4.60934471297e-5, 5.46301178705e-5),
        ),
        (
            2500.0,
            (2.45834470276e-4, 9.59612500319e-4),
            (1.19138983695e-5, -2.56789489377e-4),
        ),
        (
            5000.0,
            (1.17376788626e-4, -5.48143204229e-4),
            (4.36249800141e-6, -6.95050576031e-5),
        ),
        (
            8900.0,
            (1.53766745325e-3, 1.60264981624e-3),
            (2.98807001438e-6, -1.94545071098e-5),
        ),
    ];
    for (frequency_hz, face_a, face_b) in rows {
        let omega = 2.0 * PI * frequency_hz;
        let (a, b) = (
            rod(&nylon(), SECTION, omega),
            rod(&aluminium(), SECTION, omega),
        );
        let cases = [(b * a * b * a, face_a, 'A'), (a * b * a * b, face_b, 'B')];
        for (matrix, (re, im), face) in cases {
            let mobility = matrix.mobility_free_end().unwrap();
            let reference = Complex64::new(re, im);
            // 1e-10: the printed digits leave 5e-12; the rest is a rounding of 1e-16 seen through a quotient near a
            // resonance. Real and imaginary parts separately, lest the small one hide behind the large.
            assert!(
                (mobility.re / re - 1.0).abs() < 1e-10,
                "{face} {frequency_hz}: {mobility}"
            );
            assert!(
                (mobility.im / im - 1.0).abs() < 1e-10,
                "{face} {frequency_hz}: {mobility}"
            );
            assert!(relative(mobility, reference) < 1e-10);
        }
    }
}

/// (A2) by the classical fourth-order Runge-Kutta method.
fn integrated(medium: &Medium<Zener>, length: f64, omega: f64, left: State) -> State {
    let force_rate = Complex64::new(0.0, omega * medium.density() * area());
    let velocity_rate = Complex64::new(0.0, omega) / (medium.modulus(omega) * area());
    let steps = 4000;
    let h = length / f64::from(steps);
    let derivative = |(n, v): (Complex64, Complex64)| (force_rate * v, velocity_rate * n);
    let mut y = (left.normal_force, left.velocity);
    for _ in 0..steps {
        let k1 = derivative(y);
        let k2 = derivative((y.0 + k1.0 * (h / 2.0), y.1 + k1.1 * (h / 2.0)));
        let k3 = derivative((y.0 + k2.0 * (h / 2.0), y.1 + k2.1 * (h / 2.0)));
        let k4 = derivative((y.0 + k3.0 * h, y.1 + k3.1 * h));
        y.0 += (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0) * (h / 6.0);
        y.1 += (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1) * (h / 6.0);
    }
    State {
        normal_force: y.0,
        velocity: y.1,
    }
}

#[test]
fn uniform_rod_is_the_solution_of_the_equations_of_motion() {
    let medium = Medium::new(910.0, Zener::new(2.2e9, 2.6e9, 3e-5).unwrap()).unwrap();
    let left = State {
        normal_force: Complex64::new(3.0, -1.0),
        velocity: Complex64::new(0.01, 0.02),
    };
    for frequency_hz in [50.0, 700.0, 5000.0, 20_000.0] {
        let omega = 2.0 * PI * frequency_hz;
        let expected = integrated(&medium, 0.4, omega, left);
        let found = rod(&medium, 0.4, omega).transfer(left);
        // |γ|L < 32 over 4000 steps: error |γL| (|γ|h)⁴/120 < 1e-9.
        assert!(
            relative(found.normal_force, expected.normal_force) < 2e-9,
            "{frequency_hz} Hz"
        );
        assert!(
            relative(found.velocity, expected.velocity) < 2e-9,
            "{frequency_hz} Hz"
        );
    }
}

/// As ω → 0 every free body moves as a rigid one: G iωM → 1.
#[test]
fn free_bodies_are_rigid_at_low_frequency() {
    let tip = 0.05;
    let mass = area() * SECTION * 2.0 * (1150.0 + 2700.0) + tip;
    for omega in [1e-3, 1e-1, 1.0] {
        let (a, b) = (
            rod(&nylon(), SECTION, omega),
            rod(&aluminium(), SECTION, omega),
        );
        let tip = TransitionMatrix::lumped_mass(tip, omega).unwrap();
        let mobility = (tip * b * a * b * a).mobility_free_end().unwrap();
        // The body deforms by (|γ|L)² < 1e-6 at 1 rad/s, and as ω^1.8 below.
        let deformation = 4e-6 * omega.powf(1.8);
        assert!(
            (mobility * Complex64::new(0.0, omega * mass) - 1.0).norm() < deformation + 1e-14,
            "{omega} rad/s"
        );
    }
    let at_rest = TransitionMatrix::uniform_rod(Complex64::ZERO, Complex64::ONE, 1.0).unwrap();
    assert_eq!(at_rest, TransitionMatrix::identity());
}

/// A rod cut anywhere, and a body seen from its other end.
#[test]
fn elements_compose_and_reciprocity_holds() {
    let omega = 2.0 * PI * 3000.0;
    let whole = rod(&nylon(), 0.3, omega);
    let cut = rod(&nylon(), 0.2, omega) * rod(&nylon(), 0.1, omega);
    for (row, expected) in cut.entries().iter().zip(whole.entries()) {
        for (entry, expected) in row.iter().zip(expected) {
            assert!(relative(*entry, expected) < 1e-14); // a dozen roundings
        }
    }
    let mass = TransitionMatrix::lumped_mass(0.1, omega).unwrap();
    let body = mass * rod(&aluminium(), 0.2, omega) * whole;
    // Struck at one end, moved at the other: v(right) per force left, 1/P12, is the same from both sides. Seen from
    // the other end the order is reversed and v changes sign twice.
    let turned = whole * rod(&aluminium(), 0.2, omega) * mass;
    assert!(relative(body.entries()[0][1], turned.entries()[0][1]) < 1e-13);
    assert!((body.determinant() - 1.0).norm() < 1e-13);
    let unity = (body * body.inverse()).entries();
    assert!((unity[0][0] - 1.0).norm() < 1e-12 && (unity[1][1] - 1.0).norm() < 1e-12);
}

/// What the module says of large αL: the mobility keeps its digits until the overflow, the determinant does not.
#[test]
fn large_damping_spoils_the_determinant_before_the_mobility() {
    let (z_a, z_b) = (Complex64::new(1100.0, 80.0), Complex64::new(900.0, -10.0));
    let product = |alpha_length: f64| {
        let a = TransitionMatrix::uniform_rod(Complex64::new(alpha_length, 3.0), z_a, 1.0);
        let b = TransitionMatrix::uniform_rod(Complex64::new(alpha_length, 2.0), z_b, 1.0);
        b.unwrap() * a.unwrap()
    };
    // Mobility of A backed by B by the impedance that A sees, an overflow-free form: 1 - tanh < 1e-15 beyond 18.
    let long = product(20.0).mobility_free_end().unwrap();
    assert!(relative(long, 1.0 / z_a) < 1e-14);
    assert!((product(20.0).determinant() - 1.0).norm() > 1.0);
    // near 300 + 300 a plain quotient of the entries, above 1e250, would overflow
    assert!(relative(product(300.0).mobility_free_end().unwrap(), 1.0 / z_a) < 1e-14);
    assert!(product(400.0).mobility_free_end().is_err());
}

#[test]
fn impossible_elements_are_refused() {
    let one = Complex64::ONE;
    let refused = [
        TransitionMatrix::uniform_rod(one, one, 0.0),
        TransitionMatrix::uniform_rod(one, one, f64::NAN),
        TransitionMatrix::uniform_rod(one, Complex64::ZERO, 1.0),
        TransitionMatrix::uniform_rod(Complex64::new(701.0, 1.0), one, 1.0),
        TransitionMatrix::uniform_rod(Complex64::new(f64::NAN, 1.0), one, 1.0),
        TransitionMatrix::uniform_rod(Complex64::new(1.0, f64::INFINITY), one, 1.0),
        TransitionMatrix::lumped_mass(-1e-3, 1.0),
        TransitionMatrix::lumped_mass(1e-3, f64::NAN),
    ];
    for (case, result) in refused.into_iter().enumerate() {
        assert!(
            matches!(result, Err(RodwaveError::NonPhysical { .. })),
            "case {case}"
        );
    }
    let error = TransitionMatrix::identity()
        .mobility_free_end()
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "magnitude of the entry P12 [kg/s] is 0, expected a finite value above 0"
    );
}

proptest! {
    /// det P = 1 for any row of a rod, a mass and a rod of moderate damping.
    #[test]
    fn determinants_are_one(
        alpha in 0.0..1.5f64, k in 0.0..40.0f64, z in 1.0..1e5f64, mass in 0.0..1.0f64, omega in 0.0..1e5f64,
    ) {
        let rod = TransitionMatrix::uniform_rod(
            Complex64::new(alpha, k),
            Complex64::new(z, 0.1 * z),
            1.0,
        ).unwrap();
        let row = rod * TransitionMatrix::lumped_mass(mass, omega).unwrap() * rod;
        let largest = row.entries()[0][0].norm().max(1.0);
        // Rounding of the two products of which the determinant is the difference.
        prop_assert!((row.determinant() - 1.0).norm() < 1e-14 * largest * largest);
    }
}
