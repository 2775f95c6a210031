//! Mobilities of chains: numbers of 40 digits, the printed equations of paper E, an integration of the equations of motion,
//! limits.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::element::CrossSection;
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{PowerLawPropagation, Zener};
use rodwave::transition::TransitionMatrix;
use rodwave::{Chain, Termination};

use super::super::check::{Claim, Fallible, Found, Report};
use super::super::difference::{largest, relative, worst};
use super::bodies::{aluminium, circle, cone, cylinder, nylon};

const DIGITS_40: &str = "paper E, eqs. 8 and 9, evaluated with 40 digits";
const PRINTED: &str = "closed form";
const FREQUENCIES_HZ: [f64; 6] = [200.0, 650.0, 1700.0, 2900.0, 4200.0, 9700.0];

pub(super) fn report() -> Report {
    let mut report = Report::default();
    reference_numbers(&mut report);
    printed_equations(&mut report);
    equations_of_motion(&mut report);
    rigid_bodies(&mut report);
    terminations(&mut report);
    balances(&mut report);
    report
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

fn reference_numbers(report: &mut Report) {
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

fn printed_equations(report: &mut Report) {
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
            let long = Chain::from_impact_face()
                .end(Termination::semi_infinite(&super::bodies::steel()?, face))?;
            // c A of the printed constants, by hand: no medium of ours
            let z = (206e9_f64 * 7780.0).sqrt() * PI / 4.0 * 0.010 * 0.010;
            Ok(relative(long.mobility(omega)?, Complex64::from(1.0 / z)))
        },
    );
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

fn equations_of_motion(report: &mut Report) {
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

fn rigid_bodies(report: &mut Report) {
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

fn terminations(report: &mut Report) {
    let (length, omega) = (0.3, TAU * 1234.0);
    let ends: [(&str, fn(f64) -> Fallible<(Termination, Complex64)>); 4] = [
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

fn balances(report: &mut Report) {
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
