//! Bodies of paper E, computed by the printed equations.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::{Chain, Termination};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use crate::bodies::{aluminium, circle, cone, cylinder, nylon, steel};

const FREQUENCIES_HZ: [f64; 6] = [200.0, 650.0, 1700.0, 2900.0, 4200.0, 9700.0];
const DASHPOTS: [f64; 4] = [0.0, 30.0, 1e3, 1e5];

fn coth(x: Complex64) -> Complex64 {
    x.cosh() / x.sinh()
}

/// Mobility of the cone by the printed (8) with (A7), which has a dashpot behind the far end. The
/// distances a and b of the ends from the apex are negative for a cone that converges.
fn printed_cone(omega: f64, near: f64, far: f64, resistance: f64) -> Complex64 {
    let apex = 0.400 / (far / near - 1.0);
    let gamma = nylon().propagation_coefficient(omega);
    let (a, b) = (gamma * apex, gamma * (apex + 0.400));
    let z = nylon().specific_characteristic_impedance(omega) * (PI / 4.0 * near * near);
    let q = resistance / z;
    let c = coth(b - a);
    let numerator = 1.0 - b * c - q * a * a / b;
    let denominator = 1.0 - a * b - (b - a) * c - q * (a * a / b) * (1.0 + a * c);
    a / z * numerator / denominator
}

/// Mobility of the compound cylinder by the printed (9) in its general form (A13), (A14), with φ =
/// Z_B/Z_A.
fn printed_cylinder(omega: f64, resistance: f64) -> Complex64 {
    let area = PI / 4.0 * 0.032 * 0.032;
    let (nylon, aluminium) = (nylon(), aluminium());
    let z_a = nylon.specific_characteristic_impedance(omega) * area;
    let p = aluminium.specific_characteristic_impedance(omega) * area / z_a;
    let a = coth(nylon.propagation_coefficient(omega) * 0.125);
    let b = coth(aluminium.propagation_coefficient(omega) * 0.125);
    let q = resistance / z_a;
    let middle = a * a * b * b + a * a + b * b;
    let (p2, p3) = (p * p, p * p * p);
    let m = a / p3 + b * (2.0 * a * a + 1.0) / p2 + a * (2.0 * b * b + 1.0) / p + b;
    let n = 1.0 / p3 + 3.0 * a * b / p2 + middle / p + a * b;
    let numerator = p3 + 3.0 * a * b * p2 + middle * p + a * b + q * p2 * m;
    let denominator =
        a * p3 + b * (2.0 * a * a + 1.0) * p2 + a * (2.0 * b * b + 1.0) * p + b + q * p2 * n;
    numerator / denominator / z_a
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let why = Within(
        5e-14,
        "a few dozen rounding errors, and cancellation in the printed form at 200 Hz",
    );
    let mut check = |what: &str, source, deviation: &dyn Fn(f64, f64) -> f64| {
        let cases = DASHPOTS.iter().flat_map(|q| {
            let at = FREQUENCIES_HZ.iter();
            at.map(|frequency_hz| deviation(TAU * frequency_hz, *q))
        });
        report.by(source).deviation(what, why, Ok(largest(cases)));
    };
    check(
        "truncated cone, thin face, on dashpots from none to 1e5 kg/s, 0.2 to 9.7 kHz",
        "paper E, eqs. 8 and A7",
        &|omega, q| {
            let found = cone(Termination::Dashpot(q)).mobility(omega).unwrap();
            relative(found, printed_cone(omega, 0.030, 0.075, q))
        },
    );
    check(
        "truncated cone, thick face, computed as the far face, 0.2 to 9.7 kHz",
        "paper E, eq. 8",
        &|omega, _| {
            let found = cone(Termination::Free).far_face_mobility(omega);
            relative(found.unwrap(), printed_cone(omega, 0.075, 0.030, 0.0))
        },
    );
    check(
        "compound cylinder, face A, on dashpots from none to 1e5 kg/s, 0.2 to 9.7 kHz",
        "paper E, eqs. 9, A13 and A14",
        &|omega, q| {
            let found = cylinder(Termination::Dashpot(q)).mobility(omega).unwrap();
            relative(found, printed_cylinder(omega, q))
        },
    );
    check(
        "semi-infinite steel rod has the mobility 1/Z",
        "paper E, eq. 10",
        &|omega, _| {
            let end = Termination::semi_infinite(&steel(), circle(0.010));
            let long = Chain::from_impact_face().end(end).unwrap();
            // ρcA from the printed constants, without the media of the crate
            let z = (206e9_f64 * 7780.0).sqrt() * PI / 4.0 * 0.010 * 0.010;
            relative(long.mobility(omega).unwrap(), Complex64::from(1.0 / z))
        },
    );
    hold!(report);
}
