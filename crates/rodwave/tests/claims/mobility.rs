//! Mobilities of chains: an integration of the equations of motion, closed forms, limits, balances.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::element::CrossSection;
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{PowerLawPropagation, Zener};
use rodwave::transition::TransitionMatrix;
use rodwave::{Chain, Termination};

use super::bodies::{aluminium, circle, cone, cylinder, nylon};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, relative, worst};
use testbed::hold;

const PRINTED: &str = "closed form";
const FREQUENCIES_HZ: [f64; 6] = [200.0, 650.0, 1700.0, 2900.0, 4200.0, 9700.0];

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    equations_of_motion(&mut report);
    rigid_bodies(&mut report);
    terminations(&mut report);
    balances(&mut report);
    hold!(report);
}

/// Mobility at the near face of a free body whose area varies, by integrating (A2) from the free end with the classical method of
/// Runge and Kutta.
fn integrated<L: PropagationLaw>(
    medium: &Medium<L>,
    omega: f64,
    length: f64,
    area: impl Fn(f64) -> f64,
) -> Complex64 {
    const STEPS: u32 = 4000;
    let h = -length / f64::from(STEPS);
    let modulus = medium.modulus(omega);
    let rate = |x: f64, (n, v): (Complex64, Complex64)| {
        (
            Complex64::new(0.0, omega * medium.density() * area(x)) * v,
            Complex64::new(0.0, omega) / (modulus * area(x)) * n,
        )
    };
    let mut y = (Complex64::ZERO, Complex64::ONE);
    for step in 0..STEPS {
        let x = length + f64::from(step) * h;
        let k1 = rate(x, y);
        let k2 = rate(
            x + h / 2.0,
            (y.0 + k1.0 * (h / 2.0), y.1 + k1.1 * (h / 2.0)),
        );
        let k3 = rate(
            x + h / 2.0,
            (y.0 + k2.0 * (h / 2.0), y.1 + k2.1 * (h / 2.0)),
        );
        let k4 = rate(x + h, (y.0 + k3.0 * h, y.1 + k3.1 * h));
        y.0 += (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0) * (h / 6.0);
        y.1 += (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1) * (h / 6.0);
    }
    // a force F on the face is N = -F
    -y.1 / y.0
}

fn equations_of_motion(report: &mut Claims) {
    const SOURCE: &str = "paper E, eq. A2, integrated by a method of fourth order";
    let why = "|γL| (|γ|h)⁴/120 of the integration at 9.7 kHz, magnified near a resonance";
    report.check(
        Claim::new(
            "rod of a Zener material solves the equations of motion",
            SOURCE,
        )
        .within(1e-9, why),
        || {
            let medium = Medium::new(910.0, Zener::new(2.2e9, 2.6e9, 3e-5)?)?;
            let face = circle(0.016)?;
            let area = PI / 4.0 * 0.016 * 0.016;
            let rod = Chain::from_impact_face()
                .rod(&medium, face, 0.4)
                .end(Termination::Free)?;
            worst(FREQUENCIES_HZ, |frequency_hz| {
                let omega = TAU * frequency_hz;
                let expected = integrated(&medium, omega, 0.4, |_| area);
                Ok(relative(rod.mobility(omega)?, expected))
            })
        },
    );
    report.check(
        Claim::new("truncated cone solves the equations of motion", SOURCE).within(1e-9, why),
        || {
            let (medium, body) = (nylon()?, cone(Termination::Free)?);
            let area = |x: f64| PI / 4.0 * (0.030 + (0.075 - 0.030) * x / 0.4).powi(2);
            worst(FREQUENCIES_HZ, |frequency_hz| {
                let omega = TAU * frequency_hz;
                let expected = integrated(&medium, omega, 0.4, area);
                Ok(relative(body.mobility(omega)?, expected))
            })
        },
    );
    report.check(
        Claim::new("exponential horn solves the equations of motion", SOURCE).within(1e-9, why),
        || {
            let medium = nylon()?;
            let body = Chain::from_impact_face()
                .horn(&medium, circle(0.050)?, circle(0.020)?, 0.4)
                .end(Termination::Free)?;
            let area = |x: f64| PI / 4.0 * 0.050 * 0.050 * (0.4_f64.powi(2)).powf(x / 0.4);
            worst(FREQUENCIES_HZ, |frequency_hz| {
                let omega = TAU * frequency_hz;
                let expected = integrated(&medium, omega, 0.4, area);
                Ok(relative(body.mobility(omega)?, expected))
            })
        },
    );
}

fn rigid_bodies(report: &mut Claims) {
    report.check(
        Claim::new(
            "mass of the truncated cone",
            "volume of a frustum, density of paper E",
        )
        .expects(
            1150.0 * PI * 0.400 / 12.0 * (0.030 * 0.030 + 0.030 * 0.075 + 0.075 * 0.075),
            "kg",
        )
        .within_part(1e-14, "rounding"),
        || Ok(cone(Termination::Free)?.free_mass().unwrap_or(f64::NAN)),
    );
    report.check(
        Claim::new(
            "mass of the compound cylinder",
            "volume of a cylinder, densities of paper E",
        )
        .expects(PI / 4.0 * 0.032 * 0.032 * 0.250 * (1150.0 + 2700.0), "kg")
        .within_part(1e-14, "rounding"),
        || Ok(cylinder(Termination::Free)?.free_mass().unwrap_or(f64::NAN)),
    );
    let why = "the bodies give way by (|γ|L)² at 1 mHz";
    for (name, far, body) in [
        ("TCA", false, cone(Termination::Free)),
        ("TCB", true, cone(Termination::Free)),
        ("CCA", false, cylinder(Termination::Free)),
        ("CCB", true, cylinder(Termination::Free)),
    ] {
        let claim = Claim::new(
            format!("face {name} at 1 mHz is that of a rigid mass: Ĝ iωM - 1"),
            "Newton's second law",
        )
        .within(1e-10, why);
        report.check(claim, move || {
            let (body, omega) = (body?, TAU * 1e-3);
            let mass = body.free_mass().unwrap_or(f64::NAN);
            let mobility = if far {
                body.far_face_mobility(omega)?
            } else {
                body.mobility(omega)?
            };
            Ok((mobility * Complex64::new(0.0, omega * mass) - 1.0).norm())
        });
    }
    report.check(
        Claim::new(
            "free rod at low frequency: Ĝ iωM = 1 + (γL)²/3 - (γL)⁴/45, 1 nHz to 1 Hz",
            "series of x coth x",
        )
        .within(1e-14, "rounding; the next term is 1e-18"),
        || {
            let medium = Medium::new(910.0, Zener::new(2.2e9, 2.6e9, 3e-5)?)?;
            let rod = Chain::from_impact_face()
                .rod(&medium, circle(0.016)?, 0.8)
                .end(Termination::Free)?;
            let mass = 910.0 * PI / 4.0 * 0.016 * 0.016 * 0.8;
            worst([1e-9, 1e-6, 1e-3, 1.0], |frequency_hz| {
                let omega = TAU * frequency_hz;
                let x = medium.propagation_coefficient(omega) * 0.8;
                let scaled = rod.mobility(omega)? * Complex64::new(0.0, omega * mass);
                Ok((scaled - 1.0 - x * x / 3.0 + x.powu(4) / 45.0).norm())
            })
        },
    );
}

fn terminations(report: &mut Claims) {
    let (length, omega) = (0.3, TAU * 1234.0);
    type End = fn(f64) -> Fallible<(Termination, Complex64)>;
    let ends: [(&str, End); 4] = [
        ("a mass", |omega| {
            Ok((Termination::Mass(0.05), Complex64::new(0.0, 0.05 * omega)))
        }),
        ("a dashpot", |_| {
            Ok((Termination::Dashpot(700.0), 700.0.into()))
        }),
        ("a measured impedance", |_| {
            let measured = Complex64::new(250.0, -80.0);
            Ok((Termination::impedance(move |_| measured), measured))
        }),
        ("a long rod of aluminium", |_| {
            let z = (69e9_f64 * 2700.0).sqrt() * PI / 4.0 * 0.010 * 0.010;
            let end = Termination::semi_infinite(&aluminium()?, circle(0.010)?);
            Ok((end, z.into()))
        }),
    ];
    for (name, end) in ends {
        let claim = Claim::new(
            format!("rod of Nylon-6 ended by {name}: both faces"),
            "closed form: Z(Z_end + Z tanh γL)/(Z + Z_end tanh γL)",
        )
        .within(1e-13, "a few dozen roundings");
        report.check(claim, move || {
            let (nylon, face) = (nylon()?, circle(0.030)?);
            let z =
                nylon.specific_characteristic_impedance(omega) * CrossSection::from(face).area();
            let t = (nylon.propagation_coefficient(omega) * length).tanh();
            let (termination, z_end) = end(omega)?;
            let rod = Chain::from_impact_face()
                .rod(&nylon, face, length)
                .end(termination)?;
            let near = (z + z_end * t) / (z * (z_end + z * t));
            let far = 1.0 / (z * t + z_end);
            Ok(largest([
                relative(rod.mobility(omega)?, near),
                relative(rod.far_face_mobility(omega)?, far),
            ]))
        });
    }
    report.check(
        Claim::new("rod of Nylon-6 fixed at its end", "closed form: tanh(γL)/Z")
            .within(1e-13, "a few dozen roundings"),
        || {
            let (nylon, face) = (nylon()?, circle(0.030)?);
            let z =
                nylon.specific_characteristic_impedance(omega) * CrossSection::from(face).area();
            let t = (nylon.propagation_coefficient(omega) * length).tanh();
            let rod = Chain::from_impact_face()
                .rod(&nylon, face, length)
                .end(Termination::Fixed)?;
            Ok(relative(rod.mobility(omega)?, t / z))
        },
    );
    report.check(
        Claim::new(
            "a hundred tapers damped by e^-1e6: the first alone is seen, 1/Z",
            PRINTED,
        )
        .within(1e-13, "a dozen roundings"),
        || {
            let law = PowerLawPropagation::new(1e-1, 1.0, 1.0, 1.0)?;
            let (lossy, face) = (Medium::new(1150.0, law)?, circle(0.02)?);
            let mut row = Chain::from_impact_face();
            for _ in 0..50 {
                row = row
                    .rod(&lossy, face, 1.0)
                    .cone(&lossy, circle(0.04)?, circle(0.01)?, 1.0);
            }
            let row = row.end(Termination::Fixed)?;
            let omega = 1e5;
            let z =
                lossy.specific_characteristic_impedance(omega) * CrossSection::from(face).area();
            Ok(relative(row.mobility(omega)?, 1.0 / z))
        },
    );
}

/// A rod as a transition matrix.
fn matrix<L: PropagationLaw>(medium: &Medium<L>, omega: f64) -> Fallible<TransitionMatrix> {
    let area = PI / 4.0 * 0.032 * 0.032;
    Ok(TransitionMatrix::uniform_rod(
        medium.propagation_coefficient(omega),
        medium.specific_characteristic_impedance(omega) * area,
        0.125,
    )?)
}

fn balances(report: &mut Claims) {
    report.check(
        Claim::new(
            "compound cylinder by the product of its transition matrices, 0.2 to 9.7 kHz",
            "paper E, eq. A10",
        )
        .within(1e-12, "rounding of the product, magnified near a resonance"),
        || {
            let body = cylinder(Termination::Free)?;
            worst(FREQUENCIES_HZ, |frequency_hz| {
                let omega = TAU * frequency_hz;
                let (a, b) = (matrix(&nylon()?, omega)?, matrix(&aluminium()?, omega)?);
                let product = (b * a * b * a).mobility_free_end()?;
                Ok(relative(body.mobility(omega)?, product))
            })
        },
    );
    report.check(
        Claim::new(
            "determinant of a row of rods and a mass, minus 1",
            "reciprocity",
        )
        .within(1e-12, "rounding of the two products of the determinant"),
        || {
            worst(FREQUENCIES_HZ, |frequency_hz| {
                let omega = TAU * frequency_hz;
                let (a, b) = (matrix(&nylon()?, omega)?, matrix(&aluminium()?, omega)?);
                let row = b * TransitionMatrix::lumped_mass(0.1, omega)? * a;
                Ok((row.determinant() - 1.0).norm())
            })
        },
    );
    report.check(
        Claim::new(
            "struck at one end and moved at the other: the same from both sides of a row",
            "reciprocity (Maxwell, Betti)",
        )
        .within(1e-12, "rounding"),
        || {
            worst(FREQUENCIES_HZ, |frequency_hz| {
                let omega = TAU * frequency_hz;
                let (a, b) = (matrix(&nylon()?, omega)?, matrix(&aluminium()?, omega)?);
                let mass = TransitionMatrix::lumped_mass(0.1, omega)?;
                let (there, back) = (b * mass * a * a, a * a * mass * b);
                Ok(relative(there.entries()[0][1], back.entries()[0][1]))
            })
        },
    );
    report.check(
        Claim::new(
            "power that the cone and the cylinder give out, 10 Hz to 20 kHz: largest part of |Ĝ|",
            "energy: Re Ĝ is not negative",
        )
        .within(1e-12, "rounding"),
        || {
            let bodies = [cone(Termination::Free)?, cylinder(Termination::Free)?];
            let mut given = vec![0.0];
            for step in 1..=2000 {
                let omega = TAU * 10.0 * f64::from(step);
                for body in &bodies {
                    for mobility in [body.mobility(omega)?, body.far_face_mobility(omega)?] {
                        given.push((-mobility.re / mobility.norm()).max(0.0));
                    }
                }
            }
            Ok(largest(given))
        },
    );
}
