//! The interior of the truncated cone and the far ends of the bodies of paper E, by the printed
//! equations.

use std::f64::consts::{PI, TAU};

use rodwave::Termination;
use rodwave::element::Segment;
use testbed::difference::relative;

use crate::bodies::{circle, cone, cylinder, nylon};

/// Compares the states and the areas inside the cone with the printed solution (paper E, eqs. A3
/// and A4), with C and D determined from the state of the near face.
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
            // C e^{-γx} + D e^{γx} = vx and -C(γx + 1) e^{-γx} + D(γx - 1) e^{γx} = N γ x_A²/Z_A at
            // x = x_A
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
                // At a free end, the forces of the two waves cancel. At 200 Hz, where |γx| is 0.2
                // at the face, (γx + 1)e^{-γx} and (γx - 1)e^{γx} also cancel to one hundredth of
                // their size. The force at the face is therefore the scale, and rounding costs two
                // digits.
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

/// Checks that force and velocity of the far end obey the law of its dashpot, N = -qv (paper E,
/// eqs. A6 and A12).
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
                // tolerance: only one common factor relates the state here to the pair at the
                // termination, so the error is rounding of q v
                assert!(
                    left.norm() <= 1e-14 * resistance * end.velocity.norm(),
                    "q = {resistance}, {frequency_hz} Hz: {left}"
                );
            }
        }
    }
}
