//! The truncated cone and the compound cylinder of paper E: reference values, and its equations as printed.

use super::bodies::{aluminium, circle, cone, cylinder, nylon, relative};
use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::element::Segment;
use rodwave::{Chain, Termination};

/// Real and imaginary part each to 1e-10 of itself, lest the small one hide behind the large.
fn assert_close(found: Complex64, expected: Complex64, what: &str) {
    assert!(
        (found.re / expected.re - 1.0).abs() < 1e-10,
        "{what}: {found}"
    );
    assert!(
        (found.im / expected.im - 1.0).abs() < 1e-10,
        "{what}: {found}"
    );
}

/// The truncated cone and the compound cylinder of paper E struck at either face. Computed with 40 digits from (8) and (9),
/// given to 12.
#[test]
fn bodies_of_paper_e() {
    let table = [
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
    let (cone, cylinder) = (cone(Termination::Free), cylinder(Termination::Free));
    for (frequency_hz, row) in table {
        let omega = TAU * frequency_hz;
        let found = [
            cone.mobility(omega),
            cone.far_face_mobility(omega),
            cylinder.mobility(omega),
            cylinder.far_face_mobility(omega),
        ];
        for ((found, (re, im)), name) in
            found.into_iter().zip(row).zip(["TCA", "TCB", "CCA", "CCB"])
        {
            // 1e-10: the printed digits leave 5e-12, the rest is rounding near a resonance
            let what = format!("{name} at {frequency_hz} Hz");
            assert_close(found.unwrap(), Complex64::new(re, im), &what);
        }
        // with the other face struck, the same body turned round
        let turned = Chain::from_impact_face()
            .cone(&nylon(), circle(0.075), circle(0.030), 0.400)
            .end(Termination::Free)
            .unwrap();
        let (tcb_re, tcb_im) = row[1];
        assert_close(
            turned.mobility(omega).unwrap(),
            Complex64::new(tcb_re, tcb_im),
            "turned",
        );
    }
}

fn coth(x: Complex64) -> Complex64 {
    x.cosh() / x.sinh()
}

/// Printed (8) with (A7), in which a dashpot q stands behind the far end, and the rule for the other face; the geometry enters
/// by the distances of the ends from the apex.
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

/// Printed (A13) and (A14); φ = Z_B/Z_A.
fn printed_cylinder(omega: f64, resistance: f64) -> Complex64 {
    let area = PI / 4.0 * 0.032 * 0.032;
    let (nylon, aluminium) = (nylon(), aluminium());
    let z_a = nylon.specific_characteristic_impedance(omega) * area;
    let phi = aluminium.specific_characteristic_impedance(omega) * area / z_a;
    let a = coth(nylon.propagation_coefficient(omega) * 0.125);
    let b = coth(aluminium.propagation_coefficient(omega) * 0.125);
    let q = resistance / z_a;
    let middle = a * a * b * b + a * a + b * b;
    let (p, p2, p3) = (phi, phi * phi, phi * phi * phi);
    let m = a / p3 + b * (2.0 * a * a + 1.0) / p2 + a * (2.0 * b * b + 1.0) / p + b;
    let n = 1.0 / p3 + 3.0 * a * b / p2 + middle / p + a * b;
    let numerator = p3 + 3.0 * a * b * p2 + middle * p + a * b + q * p2 * m;
    let denominator =
        a * p3 + b * (2.0 * a * a + 1.0) * p2 + a * (2.0 * b * b + 1.0) * p + b + q * p2 * n;
    numerator / denominator / z_a
}

#[test]
fn printed_equations_of_paper_e() {
    for resistance in [0.0, 30.0, 1e3, 1e5] {
        let end = || Termination::Dashpot(resistance);
        for frequency_hz in [200.0, 650.0, 1700.0, 4200.0, 9700.0] {
            let omega = TAU * frequency_hz;
            // 1e-10: at 200 Hz |γx| is 0.4 and the differences of (8) lose a few digits; nothing else cancels
            let found = cone(end()).mobility(omega).unwrap();
            let printed = printed_cone(omega, 0.030, 0.075, resistance);
            assert!(
                relative(found, printed) < 1e-10,
                "cone {resistance} {frequency_hz}"
            );
            let found = cylinder(end()).mobility(omega).unwrap();
            let printed = printed_cylinder(omega, resistance);
            assert!(
                relative(found, printed) < 1e-10,
                "cylinder {resistance} {frequency_hz}"
            );
        }
    }
}

/// The rule of paper E for the far face of the cone is (8) for a cone that converges: its apex lies at a negative distance.
#[test]
fn printed_rule_for_the_far_face() {
    for frequency_hz in [650.0, 1700.0, 9700.0] {
        let omega = TAU * frequency_hz;
        let found = cone(Termination::Free).far_face_mobility(omega).unwrap();
        let printed = printed_cone(omega, 0.075, 0.030, 0.0);
        assert!(relative(found, printed) < 1e-10, "{frequency_hz}"); // as above
    }
}

/// Printed (A4) inside the cone, its two functions C and D taken from the state of the near face, and the impedance (A3) that it carries.
#[test]
fn printed_solution_inside_the_cone() {
    let segment = Segment::cone(circle(0.030), circle(0.075), 0.400).unwrap();
    let apex = 0.400 / (75.0 / 30.0 - 1.0);
    for resistance in [0.0, 1e3] {
        let cone = cone(Termination::Dashpot(resistance));
        for frequency_hz in [200.0, 1700.0, 9700.0] {
            let omega = TAU * frequency_hz;
            let gamma = nylon().propagation_coefficient(omega);
            let z_a = nylon().specific_characteristic_impedance(omega) * (PI / 4.0 * 0.030 * 0.030);
            let face = cone.section(0, 0.0).unwrap().state(omega).unwrap();
            // C e^{-γx} + D e^{γx} = vx and -C(γx + 1) e^{-γx} + D(γx - 1) e^{γx} = N γ x_A²/Z_A at x = x_A
            let (g, sum) = (gamma * apex, face.velocity * apex);
            let backward =
                (face.normal_force * gamma * apex * apex / z_a + sum * (g + 1.0)) / (2.0 * g);
            let (c, d) = ((sum - backward) * g.exp(), backward * (-g).exp());
            for distance in [0.1, 0.25, 0.4] {
                let x = apex + distance;
                let (forward, backward) = (c * (-gamma * x).exp(), d * (gamma * x).exp());
                let force = z_a / (gamma * apex * apex)
                    * (-forward * (gamma * x + 1.0) + backward * (gamma * x - 1.0));
                let velocity = (forward + backward) / x;
                let found = cone.section(0, distance).unwrap().state(omega).unwrap();
                let what = format!("q = {resistance}, {frequency_hz} Hz, {distance} m");
                // The forces of the two waves cancel at a free end; at 200 Hz, where |γx| is 0.2 at the face, (γx + 1)e^{-γx} and
                // (γx - 1)e^{γx} cancel to a hundredth besides. Hence the force at the face as the scale, and two digits for rounding.
                let scale = face.normal_force.norm();
                assert!(
                    (force - found.normal_force).norm() < 1e-12 * scale,
                    "N {what}"
                );
                assert!(relative(velocity, found.velocity) < 1e-11, "v {what}");
                let growth = segment.area_at(distance).unwrap() / segment.area_at(0.0).unwrap();
                assert!(
                    (growth / (x / apex).powi(2) - 1.0).abs() < 1e-14,
                    "Z {what}"
                );
            }
        }
    }
}

/// Printed (A6) and (A12): what the far end gives to its dashpot.
#[test]
fn dashpot_behind_the_far_end() {
    for resistance in [0.0, 30.0, 1e3, 1e5] {
        let (cone, cylinder) = (
            cone(Termination::Dashpot(resistance)),
            cylinder(Termination::Dashpot(resistance)),
        );
        for frequency_hz in [200.0, 1700.0, 9700.0] {
            let omega = TAU * frequency_hz;
            for end in [cone.section(0, 0.4), cylinder.section(3, 0.125)] {
                let end = end.unwrap().state(omega).unwrap();
                let left = end.normal_force + resistance * end.velocity;
                // the pair is carried from this end to the face and back by one factor: rounding of q v, or of nothing
                assert!(
                    left.norm() <= 1e-14 * resistance * end.velocity.norm(),
                    "q = {resistance}, {frequency_hz} Hz: {left}"
                );
            }
        }
    }
}
