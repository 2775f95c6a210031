//! The bodies of paper E: numbers of 40 digits and the printed equations.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::{Chain, Termination};

use super::bodies::{aluminium, circle, cone, cylinder, nylon, steel};
use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::{largest, relative, worst};
use testbed::hold;

const DIGITS_40: &str = "paper E, eqs. 8 and 9, evaluated with 40 digits";
const FREQUENCIES_HZ: [f64; 6] = [200.0, 650.0, 1700.0, 2900.0, 4200.0, 9700.0];

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    reference_numbers(&mut report);
    printed_equations(&mut report);
    hold!(report);
}

/// Frequency in Hz; real and imaginary part of v/F in s/kg at the faces TCA, TCB, CCA, CCB.
const REFERENCE: [(f64, [(f64, f64); 4]); 5] = [
    (
        100.0,
        [
            (5.31702952414e-6, -1.4623478043e-3),
            (9.31840260879e-7, -1.49841205652e-3),
            (5.82588165916e-6, -2.00742012736e-3),
            (1.91181467262e-6, -2.03921895148e-3),
        ],
    ),
    (
        1000.0,
        [
            (5.70373002497e-5, 3.06064811985e-4),
            (1.01565191904e-5, -6.99280439324e-5),
            (7.91809056486e-5, 3.52231105718e-4),
            (4.60934471297e-5, 5.46301178705e-5),
        ],
    ),
    (
        2500.0,
        [
            (2.20833662124e-4, -3.37985844279e-4),
            (3.94183962733e-5, -1.2385051913e-4),
            (2.45834470276e-4, 9.59612500319e-4),
            (1.19138983695e-5, -2.56789489377e-4),
        ],
    ),
    (
        5000.0,
        [
            (3.06939503322e-4, 3.14599004025e-4),
            (5.03250036202e-5, 1.91254852944e-5),
            (1.17376788626e-4, -5.48143204229e-4),
            (4.36249800141e-6, -6.95050576031e-5),
        ],
    ),
    (
        8900.0,
        [
            (4.50113158686e-4, 1.72090787155e-4),
            (7.26455200693e-5, 9.3924835634e-6),
            (1.53766745325e-3, 1.60264981624e-3),
            (2.98807001438e-6, -1.94545071098e-5),
        ],
    ),
];

fn reference_numbers(report: &mut Claims) {
    for (frequency_hz, row) in REFERENCE {
        for (face, (re, im)) in row.into_iter().enumerate() {
            let name = ["TCA", "TCB", "CCA", "CCB"][face];
            // real and imaginary part each against itself, lest the small one hide behind the large
            let claim = Claim::new(
                format!(
                    "mobility of face {name} at {frequency_hz} Hz: relative error of its parts"
                ),
                DIGITS_40,
            )
            .within(1e-10, "12 printed digits, and rounding near a resonance");
            report.check(claim, || {
                let omega = TAU * frequency_hz;
                let found = match face {
                    0 => cone(Termination::Free)?.mobility(omega)?,
                    1 => cone(Termination::Free)?.far_face_mobility(omega)?,
                    2 => cylinder(Termination::Free)?.mobility(omega)?,
                    _ => cylinder(Termination::Free)?.far_face_mobility(omega)?,
                };
                Ok(largest([found.re / re - 1.0, found.im / im - 1.0]))
            });
        }
    }
}

fn coth(x: Complex64) -> Complex64 {
    x.cosh() / x.sinh()
}

/// Printed (8) with (A7), in which a dashpot stands behind the far end; the geometry enters by the distances of the ends from the
/// apex, negative for a cone that converges.
fn printed_cone(omega: f64, near: f64, far: f64, resistance: f64) -> Fallible<Complex64> {
    let nylon = nylon()?;
    let apex = 0.400 / (far / near - 1.0);
    let gamma = nylon.propagation_coefficient(omega);
    let (a, b) = (gamma * apex, gamma * (apex + 0.400));
    let z = nylon.specific_characteristic_impedance(omega) * (PI / 4.0 * near * near);
    let q = resistance / z;
    let c = coth(b - a);
    let numerator = 1.0 - b * c - q * a * a / b;
    let denominator = 1.0 - a * b - (b - a) * c - q * (a * a / b) * (1.0 + a * c);
    Ok(a / z * numerator / denominator)
}

/// Printed (9) by its general form (A13), (A14); φ = Z_B/Z_A.
fn printed_cylinder(omega: f64, resistance: f64) -> Fallible<Complex64> {
    let area = PI / 4.0 * 0.032 * 0.032;
    let (nylon, aluminium) = (nylon()?, aluminium()?);
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
    Ok(numerator / denominator / z_a)
}

fn printed_equations(report: &mut Claims) {
    let why = "the differences of the printed form lose digits at 200 Hz";
    let mut check = |what: &str, source, deviation: &dyn Fn(f64) -> Found| {
        report.check(Claim::new(what, source).within(1e-10, why), || {
            worst(FREQUENCIES_HZ, |frequency_hz| deviation(TAU * frequency_hz))
        });
    };
    check(
        "truncated cone as printed, face A, 0.2 to 9.7 kHz",
        "paper E, eq. 8",
        &|omega| {
            let found = cone(Termination::Free)?.mobility(omega)?;
            Ok(relative(found, printed_cone(omega, 0.030, 0.075, 0.0)?))
        },
    );
    check(
        "truncated cone as printed, face B by the rule for the far face",
        "paper E, eq. 8",
        &|omega| {
            let found = cone(Termination::Free)?.far_face_mobility(omega)?;
            Ok(relative(found, printed_cone(omega, 0.075, 0.030, 0.0)?))
        },
    );
    check(
        "truncated cone on a dashpot as printed",
        "paper E, eq. A7",
        &|omega| {
            let found = cone(Termination::Dashpot(1e3))?.mobility(omega)?;
            Ok(relative(found, printed_cone(omega, 0.030, 0.075, 1e3)?))
        },
    );
    check(
        "compound cylinder as printed, face A, 0.2 to 9.7 kHz",
        "paper E, eq. 9",
        &|omega| {
            let found = cylinder(Termination::Free)?.mobility(omega)?;
            Ok(relative(found, printed_cylinder(omega, 0.0)?))
        },
    );
    check(
        "compound cylinder on a dashpot as printed",
        "paper E, eqs. A13 and A14",
        &|omega| {
            let found = cylinder(Termination::Dashpot(1e3))?.mobility(omega)?;
            Ok(relative(found, printed_cylinder(omega, 1e3)?))
        },
    );
    check(
        "semi-infinite steel rod has the mobility 1/Z",
        "paper E, eq. 10",
        &|omega| {
            let face = circle(0.010)?;
            let long =
                Chain::from_impact_face().end(Termination::semi_infinite(&steel()?, face))?;
            // c A of the printed constants, by hand: no medium of ours
            let z = (206e9_f64 * 7780.0).sqrt() * PI / 4.0 * 0.010 * 0.010;
            Ok(relative(long.mobility(omega)?, Complex64::from(1.0 / z)))
        },
    );
}
