//! Linear laws: derivatives, limits, the relations of a wave to its modulus.

use std::f64::consts::{FRAC_PI_2, TAU};

use num_complex::Complex64;
use rodwave::medium::{Medium, PropagationLaw, modulus_from_propagation};
use rodwave::modulus::{
    ConstantQ, DifferentiableModulus, Elastic, FractionalZener, GeneralisedMaxwell,
    HavriliakNegami, KelvinVoigt, LaplaceModulus, Maxwell, MaxwellBranch, SpringPot, Zener,
};

use super::bodies::nylon;
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, relative, worst};
use testbed::hold;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    gradients(&mut report);
    laws_in_laws(&mut report);
    power_laws(&mut report);
    waves(&mut report);
    hold!(report);
}

pub(super) fn branches(pairs: &[(f64, f64)]) -> Vec<MaxwellBranch> {
    pairs
        .iter()
        .map(|&(modulus, relaxation_time)| MaxwellBranch {
            modulus,
            relaxation_time,
        })
        .collect()
}

/// Unordered, with two branches of one relaxation time and a weak one.
pub(super) fn prony(equilibrium_modulus: f64) -> Fallible<GeneralisedMaxwell> {
    let pairs = [
        (0.3e9, 1e-3),
        (0.4e9, 1e-5),
        (1e3, 2e-4),
        (0.5e9, 1e-3),
        (0.6e9, 1e-4),
    ];
    Ok(GeneralisedMaxwell::new(
        equilibrium_modulus,
        branches(&pairs),
    )?)
}

/// Derivative of `function` at 0 by a difference of fourth order.
fn difference(step: f64, function: impl Fn(f64) -> Fallible<Complex64>) -> Fallible<Complex64> {
    let odd = |h: f64| -> Fallible<Complex64> { Ok(function(h)? - function(-h)?) };
    Ok((8.0 * odd(step)? - odd(2.0 * step)?) / (12.0 * step))
}

/// Three decades on either side of 10⁴ rad/s.
fn frequencies() -> impl Iterator<Item = f64> {
    (-12..=12).map(|j| 1e4 * 10f64.powf(0.25 * f64::from(j)))
}

fn gradient_of<M: DifferentiableModulus>(report: &mut Claims, name: &str, law: Fallible<M>) {
    let claim = Claim::new(
        format!("{name}: ∂E by every parameter and by ln ω"),
        "differences of fourth order",
    );
    let why = "rounding 4e-15 of ln E over the step of 3e-4";
    report.check(claim.within(1e-10, why), || {
        let law = law?;
        let parameters = law.parameters();
        let mut derivatives = vec![Complex64::ZERO; parameters.len()];
        worst(frequencies(), |omega| {
            let scale = law.at(omega).norm();
            law.gradient(omega, &mut derivatives)?;
            let mut errors = Vec::new();
            for (index, derivative) in derivatives.iter().enumerate() {
                let differenced = difference(3e-4, |h| {
                    let mut moved = parameters.clone();
                    moved[index] += h;
                    Ok(law.with_parameters(&moved)?.at(omega))
                })?;
                errors.push((derivative - differenced).norm() / scale);
            }
            let by_log = difference(3e-4, |h| Ok(law.at(omega * h.exp())))?;
            errors.push((law.slope(omega) - by_log).norm() / scale);
            Ok(largest(errors))
        })
    });
}

fn gradients(report: &mut Claims) {
    let series = branches(&[(0.1e9, 1e-2), (0.2e9, 1e-3), (0.2e9, 1e-4)]);
    let series = GeneralisedMaxwell::new(2.4e9, series);
    gradient_of(
        report,
        "Maxwell",
        Maxwell::new(2.7e9, 2.7e5).map_err(Into::into),
    );
    gradient_of(
        report,
        "Kelvin-Voigt",
        KelvinVoigt::new(2.7e9, 2.7e4).map_err(Into::into),
    );
    gradient_of(
        report,
        "Zener",
        Zener::new(2.5e9, 2.9e9, 1e-4).map_err(Into::into),
    );
    gradient_of(report, "Prony series", series.map_err(Into::into));
    gradient_of(
        report,
        "spring-pot",
        SpringPot::new(2.7e9, 0.4, 1e4).map_err(Into::into),
    );
    gradient_of(
        report,
        "constant Q",
        ConstantQ::new(2.7e9, 0.1, 1e4).map_err(Into::into),
    );
    let law = FractionalZener::new(2.5e9, 2.9e9, 1e-4, 0.5);
    gradient_of(report, "fractional Zener", law.map_err(Into::into));
    let law = HavriliakNegami::new(2.5e9, 2.9e9, 1e-4, 0.6, 1.4);
    gradient_of(report, "Havriliak-Negami", law.map_err(Into::into));
}

fn laws_in_laws(report: &mut Claims) {
    type Law = fn() -> Fallible<Box<dyn LaplaceModulus>>;
    let pairs: [(&str, Law, Law); 5] = [
        (
            "Prony series of one branch is Zener's law",
            || {
                Ok(Box::new(GeneralisedMaxwell::new(
                    2.5e9,
                    branches(&[(0.4e9, 1e-4)]),
                )?))
            },
            || Ok(Box::new(Zener::new(2.5e9, 2.9e9, 1e-4)?)),
        ),
        (
            "Prony series without a spring is Maxwell's law",
            || {
                Ok(Box::new(GeneralisedMaxwell::new(
                    0.0,
                    branches(&[(2.7e9, 1e-4)]),
                )?))
            },
            || Ok(Box::new(Maxwell::new(2.7e9, 2.7e5)?)),
        ),
        (
            "fractional Zener with α = 1 is Zener's law",
            || Ok(Box::new(FractionalZener::new(2.5e9, 2.9e9, 1e-4, 1.0)?)),
            || Ok(Box::new(Zener::new(2.5e9, 2.9e9, 1e-4)?)),
        ),
        (
            "Havriliak-Negami with β = 1 is the fractional Zener law",
            || {
                Ok(Box::new(HavriliakNegami::new(
                    2.5e9, 2.9e9, 1e-4, 0.3, 1.0,
                )?))
            },
            || Ok(Box::new(FractionalZener::new(2.5e9, 2.9e9, 1e-4, 0.3)?)),
        ),
        (
            "constant Q is the spring-pot of exponent (2/π) arctan tan δ",
            || Ok(Box::new(ConstantQ::new(2.7e9, 0.2, 1e4)?)),
            || {
                Ok(Box::new(SpringPot::new(
                    2.7e9,
                    0.2_f64.atan() / FRAC_PI_2,
                    1e4,
                )?))
            },
        ),
    ];
    for (name, special, general) in pairs {
        let claim = Claim::new(name, "limit of the law, in the right half plane");
        report.check(claim.within(1e-14, "rounding of ten operations"), || {
            let (special, general) = (special()?, general()?);
            worst(frequencies(), |omega| {
                let s = Complex64::new(0.3 * omega, omega);
                Ok(relative(special.at_s(s), general.at_s(s)))
            })
        });
    }
    report.check(
        Claim::new(
            "constant Q: one loss factor over six decades, relative",
            "Kjartansson's definition",
        )
        .within(1e-13, "rounding of the exponent"),
        || {
            let law = ConstantQ::new(2.6e9, 0.07, 6283.0)?;
            worst(frequencies(), |omega| {
                let modulus = rodwave::modulus::ComplexModulus::at(&law, omega);
                Ok(modulus.im / modulus.re / 0.07 - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            "constant Q: |E| at the reference frequency",
            "Kjartansson's definition",
        )
        .expects(2.6e9, "Pa")
        .within_part(1e-14, "rounding"),
        || {
            Ok(
                rodwave::modulus::ComplexModulus::at(&ConstantQ::new(2.6e9, 0.07, 6283.0)?, 6283.0)
                    .norm(),
            )
        },
    );
}

fn power_laws(report: &mut Claims) {
    let omega = TAU * 1e3;
    report.check(
        Claim::new(
            "Nylon-6: damping coefficient at 1 kHz",
            "paper E, eq. 7, by logarithms",
        )
        .expects((8.818e-5_f64.ln() + 0.894 * omega.ln()).exp(), "1/m")
        .within_part(1e-13, "rounding of a logarithm near 10"),
        || Ok(nylon()?.damping_coefficient(omega)),
    );
    report.check(
        Claim::new(
            "Nylon-6: wave number at 1 kHz",
            "paper E, eq. 7, by logarithms",
        )
        .expects((8.937e-4_f64.ln() + 0.970 * omega.ln()).exp(), "1/m")
        .within_part(1e-13, "rounding of a logarithm near 10"),
        || Ok(nylon()?.wave_number(omega)),
    );
    for (frequency_hz, expected) in [(500.0, 0.107), (10_000.0, 0.085)] {
        report.check(
            Claim::new(
                format!("Nylon-6: loss factor at {frequency_hz} Hz"),
                "paper E, eq. 7, computed elsewhere to three digits",
            )
            .expects(expected, "1")
            .within(5e-4, "half the last printed digit"),
            || {
                let modulus = nylon()?.modulus(TAU * frequency_hz);
                Ok(modulus.im / modulus.re)
            },
        );
    }
}

/// Media of every kind of law.
fn every_medium(check: &mut dyn FnMut(&dyn PropagationLaw) -> Fallible<()>) -> Fallible<()> {
    check(&Elastic::new(2.7e9)?)?;
    check(&Maxwell::new(2.7e9, 2.7e5)?)?;
    check(&KelvinVoigt::new(2.7e9, 2.7e4)?)?;
    check(&Zener::new(2.5e9, 2.9e9, 1e-4)?)?;
    check(&prony(0.4e9)?)?;
    check(&SpringPot::new(2.7e9, 0.4, 1e4)?)?;
    check(&ConstantQ::new(2.7e9, 0.1, 1e4)?)?;
    check(&FractionalZener::new(2.5e9, 2.9e9, 1e-4, 0.5)?)?;
    check(&HavriliakNegami::new(2.5e9, 2.9e9, 1e-4, 0.6, 1.4)?)?;
    check(nylon()?.law())
}

fn waves(report: &mut Claims) {
    const DENSITY: f64 = 1150.0;
    report.check(
        Claim::new("γ²E = -ρω² for ten laws", "paper E, eq. 5")
            .within(1e-13, "half a dozen roundings"),
        || {
            let mut errors = Vec::new();
            every_medium(&mut |law| {
                for omega in frequencies() {
                    let gamma = law.propagation_coefficient(omega, DENSITY);
                    let balance = gamma * gamma * law.modulus(omega, DENSITY);
                    errors.push(relative(balance, Complex64::from(-DENSITY * omega * omega)));
                }
                Ok(())
            })?;
            Ok(largest(errors))
        },
    );
    report.check(
        Claim::new(
            "waves decay and energy is lost: least α and E'' of ten laws that are below zero",
            "passivity",
        )
        .within(1e-14, "none may be"),
        || {
            let mut below = vec![0.0];
            every_medium(&mut |law| {
                for omega in frequencies() {
                    let modulus = law.modulus(omega, DENSITY);
                    let gamma = law.propagation_coefficient(omega, DENSITY);
                    below.push((gamma.re / gamma.norm()).min(0.0));
                    below.push((modulus.im / modulus.norm()).min(0.0));
                }
                Ok(())
            })?;
            Ok(largest(below))
        },
    );
    report.check(
        Claim::new(
            "characteristic impedance in its printed form, ρω(k + iα)/|γ|²",
            "paper E, eq. 6",
        )
        .within(1e-13, "a dozen roundings"),
        || {
            let medium = nylon()?;
            worst(frequencies(), |omega| {
                let gamma = medium.propagation_coefficient(omega);
                let factor = DENSITY * omega / gamma.norm_sqr();
                let printed = Complex64::new(factor * gamma.im, factor * gamma.re);
                Ok(relative(
                    medium.specific_characteristic_impedance(omega),
                    printed,
                ))
            })
        },
    );
    report.check(
        Claim::new(
            "E' and E'' from α and k in the printed real form",
            "paper A, eq. 2; paper B, eq. 3",
        )
        .within(1e-13, "a dozen roundings"),
        || {
            let (alpha, k, omega) = (0.21_f64, 4.1_f64, 6e3_f64);
            let modulus = modulus_from_propagation(Complex64::new(alpha, k), omega, DENSITY)?;
            let common = DENSITY * omega * omega / (k * k + alpha * alpha).powi(2);
            Ok(largest([
                modulus.re / (common * (k * k - alpha * alpha)) - 1.0,
                modulus.im / (common * 2.0 * k * alpha) - 1.0,
            ]))
        },
    );
    report.check(
        Claim::new(
            "group velocity of a Zener medium against dω/dk by differences",
            "definition",
        )
        .within(1e-9, "rounding 1e-15 over a step of 1e-4, truncation 1e-16"),
        || {
            let medium = Medium::new(DENSITY, Zener::new(2.5e9, 2.9e9, 1e-4)?)?;
            worst(frequencies(), |omega| {
                let k = |h: f64| Ok(medium.wave_number(omega * (1.0 + h)).into());
                let slope = difference(1e-4, k)?.re / omega;
                Ok(medium.group_velocity(omega) * slope - 1.0)
            })
        },
    );
}
