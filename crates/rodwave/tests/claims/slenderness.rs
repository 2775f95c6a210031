//! Lateral inertia: tables computed elsewhere, a Rayleigh-Ritz calculation without Bessel functions, limits.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::medium::Medium;
use rodwave::modulus::Elastic;
use rodwave::slenderness::{
    CorrectedModulus, FirstBranch, LoveRayleigh, MindlinHerrmann, PochhammerChree, RodTheory,
    RoundRod, Slenderness, elementary_theory_error, rayleigh_to_shear_speed,
};

use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::{largest, worst};
use testbed::hold;

/// Radius in m, density in kg/m³ and modulus in Pa of a rod in which nothing is 1, so that a lost factor shows.
const RADIUS: f64 = 0.0079;
const DENSITY: f64 = 912.0;
const MODULUS: f64 = 2.4e9;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    table_of_errors(&mut report);
    viscoelastic_rod(&mut report);
    ritz(&mut report);
    limits(&mut report);
    condition_ii(&mut report);
    sensitivity(&mut report);
    hold!(report);
}

fn rod(poisson_ratio: f64) -> RoundRod {
    RoundRod {
        density: DENSITY,
        diameter: 2.0 * RADIUS,
        poisson_ratio,
    }
}

/// Love's theory, that of Mindlin and Herrmann with the shear coefficient of the table, the exact one.
fn theory(index: usize, nu: f64) -> Fallible<Box<dyn RodTheory>> {
    Ok(match index {
        0 => Box::new(LoveRayleigh::round(rod(nu))?),
        1 => {
            // the common approximation of the speed of Rayleigh's wave
            let kappa = (0.87 + 1.12 * nu) / (1.0 + nu);
            let theory = MindlinHerrmann::new(rod(nu))?;
            Box::new(theory.with_shear_coefficient(kappa * kappa)?)
        }
        _ => Box::new(PochhammerChree::new(rod(nu))?),
    })
}

fn exact(nu: f64) -> Fallible<PochhammerChree> {
    Ok(PochhammerChree::new(rod(nu))?)
}

fn found<T>(branch: FirstBranch<T>) -> Fallible<T> {
    branch
        .found()
        .ok_or_else(|| "no root on the first branch".into())
}

/// B = ρω²a²/E by a theory from K = -γ²a².
fn bar_number(theory: &dyn RodTheory, wave: Complex64) -> Fallible<Complex64> {
    let omega = 3.0e5; // any: B and K do not contain it separately
    let gamma = Complex64::I * wave.sqrt() / RADIUS;
    let corrected = found(theory.modulus(gamma, omega)?)?;
    Ok(DENSITY * (omega * RADIUS).powi(2) / corrected.modulus)
}

/// K = -γ²a² by a theory from B = ρω²a²/E.
fn wave_number(theory: &dyn RodTheory, bar: Complex64) -> Fallible<Complex64> {
    let omega = 3.0e5;
    let modulus = DENSITY * (omega * RADIUS).powi(2) / bar;
    let gamma = found(theory.propagation_coefficient(modulus, omega)?)?;
    Ok(-(gamma * RADIUS).powu(2))
}

/// E'_apparent/E' - 1 in per cent of an elastic rod, at λ/D.
fn apparent_error_percent(theory: &dyn RodTheory, wavelength_in_diameters: f64) -> Found {
    let wave = (PI / wavelength_in_diameters).powi(2);
    Ok(100.0 * (bar_number(theory, wave.into())?.re / wave - 1.0))
}

fn table_of_errors(report: &mut Claims) {
    // expected and half of the last printed digit
    type Row = (f64, f64, [(f64, f64); 3]);
    const ROWS: [Row; 9] = [
        (3.0, 0.35, [(-6.29, 0.005), (-4.56, 0.005), (-7.49, 0.005)]),
        (3.0, 0.40, [(-8.07, 0.005), (-5.77, 0.005), (-9.24, 0.005)]),
        (3.0, 0.499, [(-12.0, 0.05), (-8.4, 0.05), (-12.8, 0.05)]),
        (5.0, 0.35, [(-2.36, 0.005), (-1.64, 0.005), (-2.52, 0.005)]),
        (5.0, 0.40, [(-3.06, 0.005), (-2.13, 0.005), (-3.23, 0.005)]),
        // the table has -4.69 for Love's theory, whose closed form gives -4.6848
        (5.0, 0.499, [(-4.68, 0.005), (-3.27, 0.005), (-4.81, 0.005)]),
        (10.0, 0.35, [(-0.601, 5e-4), (-0.409, 5e-4), (-0.611, 5e-4)]),
        (10.0, 0.40, [(-0.783, 5e-4), (-0.538, 5e-4), (-0.794, 5e-4)]),
        (
            10.0,
            0.499,
            [(-1.21, 0.005), (-0.85, 0.005), (-1.22, 0.005)],
        ),
    ];
    const NAMES: [&str; 3] = ["Love", "Mindlin and Herrmann", "Pochhammer and Chree"];
    for (ratio, nu, printed) in ROWS {
        for (index, (expected, half_digit)) in printed.into_iter().enumerate() {
            let claim = Claim::new(
                format!("apparent E' at λ = {ratio} D, ν = {nu}: {}", NAMES[index]),
                "table computed beforehand by another program",
            )
            .expects(expected, "%")
            .within(half_digit, "half the last printed digit");
            report.check(claim, || {
                apparent_error_percent(theory(index, nu)?.as_ref(), ratio)
            });
        }
    }
}

/// ω at which the wavelength 2π/k is `ratio` diameters, by fixed-point iteration: k/ω hardly changes.
fn omega_of_wavelength(theory: &dyn RodTheory, modulus: Complex64, ratio: f64) -> Found {
    let target = TAU / (ratio * 2.0 * RADIUS);
    let mut omega = target * (modulus.re / DENSITY).sqrt();
    for _ in 0..60 {
        omega *= target / found(theory.propagation_coefficient(modulus, omega)?)?.im;
    }
    Ok(omega)
}

fn viscoelastic_rod(report: &mut Claims) {
    let modulus = MODULUS * Complex64::new(1.0, 0.08);
    let corrected = |ratio: f64| -> Fallible<CorrectedModulus> {
        let exact = exact(0.4)?;
        let omega = omega_of_wavelength(&exact, modulus, ratio)?;
        let gamma = found(exact.propagation_coefficient(modulus, omega)?)?;
        found(LoveRayleigh::round(rod(0.4))?.modulus(gamma, omega)?)
    };
    // relative to the truth: E' and E''/E' of one-dimensional theory, and what is left after Love's correction
    let rows = [
        (5.0, [0.967576, 1.03539, 0.998292, 1.00353]),
        (3.0, [0.907087, 1.11901, 0.987143, 1.02826]),
    ];
    for (ratio, row) in rows {
        for (index, expected) in row.into_iter().enumerate() {
            let name = [
                "E' of one-dimensional theory",
                "loss factor of one-dimensional theory",
                "E' after Love's correction",
                "loss factor after Love's correction",
            ][index];
            let claim = Claim::new(
                format!("ν = 0.4, tan δ = 0.08, λ = {ratio} D: {name} by the true one"),
                "roots of the printed frequency equation by mpmath, 25 digits",
            )
            .expects(expected, "1")
            .within(5e-6, "half the last printed digit");
            report.check(claim, || {
                let corrected = corrected(ratio)?;
                let e = if index < 2 {
                    corrected.apparent_modulus
                } else {
                    corrected.modulus
                };
                Ok(if index % 2 == 0 {
                    e.re / modulus.re
                } else {
                    e.im / e.re / 0.08
                })
            });
        }
    }
}

/// First branch of an elastic cylinder by the method of Rayleigh and Ritz: u_r and u_z as polynomials of r, 14 terms each, 50
/// digits; (ωa/c₀)² at ka = 1, 2, 4, 8.
const RITZ: [(f64, [f64; 4]); 6] = [
    (
        0.02,
        [
            0.999718786580890895,
            3.49772818884996951,
            6.64360357697898755,
            23.2777182369375707,
        ],
    ),
    (
        0.3,
        [
            0.947753735045376094,
            2.88745495628418146,
            6.38929265944177181,
            21.3229598209700608,
        ],
    ),
    (
        0.4,
        [
            0.91600823648375943,
            2.68575962348539749,
            6.2092687531307476,
            20.6398420608982612,
        ],
    ),
    (
        0.49,
        [
            0.885500866857381302,
            2.52591663354172454,
            6.02619689629948292,
            20.0240062882797492,
        ],
    ),
    (
        -0.3,
        [
            0.941822839107359901,
            2.64327454772365029,
            6.72451313341943784,
            26.8029800580166803,
        ],
    ),
    (
        -0.8,
        [
            0.76568942507360776,
            2.3596335384479662,
            11.5387444102250995,
            62.1866429560876435,
        ],
    ),
];

fn ritz(report: &mut Claims) {
    for (nu, row) in RITZ {
        let claim = Claim::new(
            format!("first branch of a cylinder, ν = {nu}, ka = 1 to 8, from both sides"),
            "Rayleigh-Ritz by mpmath, 50 digits; no Bessel function",
        )
        .within(
            1e-11,
            "rounding of the frequency equation at ka = 8 and near the second branch",
        );
        report.check(claim, || {
            worst(
                [1.0, 2.0, 4.0, 8.0].into_iter().zip(row),
                |(ka, expected)| {
                    let wave = Complex64::from(ka * ka);
                    let inverse = bar_number(&exact(nu)?, wave)?;
                    let forward = wave_number(&exact(nu)?, expected.into())?;
                    Ok(largest([
                        (inverse / expected - 1.0).norm(),
                        (forward / wave - 1.0).norm(),
                    ]))
                },
            )
        });
    }
}

fn limits(report: &mut Claims) {
    for (nu, expected, source) in [
        (0.0, (3.0 - 5f64.sqrt()).sqrt(), "closed form √(3 - √5)"),
        (
            0.25,
            (2.0 - 2.0 / 3f64.sqrt()).sqrt(),
            "closed form √(2 - 2/√3)",
        ),
    ] {
        report.check(
            Claim::new(
                format!("Rayleigh's wave by the shear wave, ν = {nu}"),
                source,
            )
            .expects(expected, "1")
            .within_part(1e-14, "rounding"),
            || Ok(rayleigh_to_shear_speed(nu)?),
        );
    }
    for nu in [0.2, 0.4] {
        let claim = Claim::new(
            format!(
                "short waves in a rod of ν = {nu}: speed extrapolated to infinite ka, by Rayleigh's"
            ),
            "the surface wave",
        )
        .expects(1.0, "1")
        .within(5e-4, "terms of order 1/(ka)² at ka = 40");
        report.check(claim, || {
            let limit = rayleigh_to_shear_speed(nu)?.powi(2) / (2.0 + 2.0 * nu);
            let speed = |ka: f64| -> Found {
                Ok((bar_number(&exact(nu)?, (ka * ka).into())?.re / (ka * ka) / limit).sqrt())
            };
            Ok(2.0 * speed(80.0)? - speed(40.0)?)
        });
    }
    report.check(
        Claim::new(
            "without lateral contraction nothing is corrected",
            "elementary theory, ν = 0",
        )
        .within(1e-13, "rounding"),
        || {
            let bar = 7.0 / Complex64::new(1.0, 0.2);
            worst([0, 2], |index| {
                let theory = theory(index, 0.0)?;
                Ok(largest([
                    (wave_number(theory.as_ref(), bar)? / bar - 1.0).norm(),
                    (bar_number(theory.as_ref(), bar)? / bar - 1.0).norm(),
                ]))
            })
        },
    );
    report.check(
        Claim::new(
            "incompressible rod at λ = 5 D: error of E' by the stated rule",
            "paper A, condition (i), after Pritz",
        )
        .expects(-5.0, "%")
        .within(0.5, "half the printed digit"),
        || Ok(100.0 * elementary_theory_error(5.0, 0.5)?.storage_modulus),
    );
    report.check(
        Claim::new(
            "incompressible rod at λ = 5 D: error of the loss factor by the stated rule",
            "paper A, condition (i), after Pritz",
        )
        .expects(5.0, "%")
        .within(0.5, "half the printed digit"),
        || Ok(100.0 * elementary_theory_error(5.0, 0.5)?.loss_factor),
    );
    report.check(
        Claim::new(
            "incompressible rod at λ = 5 D: error of E' by the exact theory",
            "paper A, condition (i), after Pritz",
        )
        .expects(-5.0, "%")
        .within(0.5, "half the printed digit"),
        || apparent_error_percent(&exact(0.5)?, 5.0),
    );
    report.check(
        Claim::new(
            "Love's theory ends at B = 2/ν²: lateral inertia at 1.25 of it",
            "closed form ν²B/2",
        )
        .expects(1.25, "1")
        .within(1e-12, "rounding"),
        || {
            let omega = (2.5 / 0.16 * MODULUS / DENSITY).sqrt() / RADIUS;
            let love = LoveRayleigh::round(rod(0.4))?;
            match love.propagation_coefficient(MODULUS.into(), omega)? {
                FirstBranch::BeyondCutOff { lateral_inertia } => Ok(lateral_inertia),
                other => Err(format!("{other:?}").into()),
            }
        },
    );
}

/// Where condition (ii) begins for the long specimens of paper A: λ = 5 L.
fn condition_ii(report: &mut Claims) {
    report.check(
        Claim::new(
            "polypropylene rod of 800 mm: frequency above which the wave is short against it",
            "paper A, section 5; E of paper D, Table 4",
        )
        .expects(400.0, "Hz")
        .within(50.0, "printed as approximate; its zeros are no digits"),
        || {
            let medium = Medium::new(912.0, Elastic::new(2.58e9)?)?;
            let slenderness = |frequency_hz: f64| {
                Slenderness::of_wave_number(medium.wave_number(TAU * frequency_hz), 0.016, 0.8)
            };
            let (mut below, mut above) = (10.0, 10e3);
            while above - below > 1e-3 {
                let middle = 0.5 * (below + above);
                if slenderness(middle)?.is_short_against_length() {
                    above = middle;
                } else {
                    below = middle;
                }
            }
            Ok(above)
        },
    );
}

fn sensitivity(report: &mut Claims) {
    for (index, name) in ["Love", "Mindlin and Herrmann", "Pochhammer and Chree"]
        .into_iter()
        .enumerate()
    {
        let make = move |nu: f64| -> Fallible<Box<dyn RodTheory>> {
            // the shear coefficient of its own here: it moves with ν
            if index == 1 {
                return Ok(Box::new(MindlinHerrmann::new(rod(nu))?));
            }
            theory(index, nu)
        };
        let claim = Claim::new(
            format!("∂E/∂ν at λ = 4.4 D: {name}"),
            "central differences of the modulus",
        )
        .within(
            1e-7,
            "truncation 1e-10 of E, of which the slope is a hundredth or more",
        );
        report.check(claim, || {
            let (gamma, omega, h) = (Complex64::new(4.0, 90.0), 1.5e5, 1e-5);
            let solve = |nu: f64| found(make(nu)?.modulus(gamma, omega)?);
            worst([0.15, 0.4, 0.49], |nu| {
                let slope = (solve(nu + h)?.modulus - solve(nu - h)?.modulus) / (2.0 * h);
                Ok((solve(nu)?.by_poisson_ratio / slope - 1.0).norm())
            })
        });
        let claim = Claim::new(
            format!("lossy rod, modulus to wave and back: {name}"),
            "round trip through two equations",
        )
        .within(1e-10, "rounding, magnified near the second branch");
        report.check(claim, || {
            let modulus = MODULUS * Complex64::new(1.0, 0.3);
            worst([0.1, 0.5, 1.0, 1.4], |root_bar: f64| {
                let omega = root_bar * (MODULUS / DENSITY).sqrt() / RADIUS;
                let theory = make(0.4)?;
                let gamma = found(theory.propagation_coefficient(modulus, omega)?)?;
                let back = found(theory.modulus(gamma, omega)?)?.modulus;
                Ok((back / modulus - 1.0).norm())
            })
        });
    }
}
