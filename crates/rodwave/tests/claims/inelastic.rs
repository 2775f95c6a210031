//! Inelastic laws: their exact relaxation against an integration, identities, derivatives.

use rodwave::inelastic::{
    InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
};

use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, worst};
use testbed::hold;

const MODULUS: f64 = 2.5e9;
/// From far below to above the relaxation time at 10 MPa of the laws, about 1 ms.
const DURATIONS: [f64; 5] = [1e-8, 1e-6, 3e-5, 4e-4, 2e-3];
const STRESSES: [f64; 7] = [1e2, -4e4, 1e6, -5e6, 1.2e7, 3e7, -6e7];

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    battery(
        &mut report,
        "Maxwell",
        Maxwell::new(2.5e6).map_err(Into::into),
    );
    let law = MaxwellNorton::from_reference_rate(2.108, 4.0, 10e6);
    battery(&mut report, "Norton, κ = 2.108", law.map_err(Into::into));
    let law = MaxwellGurevichRabinovich::from_reference_rate(1.4, 4.0, 10e6);
    battery(
        &mut report,
        "Gurevich and Rabinovich, m = 7 MPa",
        law.map_err(Into::into),
    );
    closed_forms(&mut report);
    limits(&mut report);
    hold!(report);
}

fn cases() -> impl Iterator<Item = (f64, f64)> {
    DURATIONS
        .into_iter()
        .flat_map(|duration| STRESSES.map(|stress| (stress, duration)))
}

/// dσ/dt = -E F(σ) by the classical method of Runge and Kutta on ln|σ|: uniform steps while the stress barely changes, then steps in
/// proportion to the time passed.
fn integrated<L: InelasticLaw>(law: &L, stress: f64, duration: f64) -> f64 {
    let rate = |z: f64| -MODULUS * law.inelastic_strain_rate(z.exp()) / z.exp();
    let mut z = stress.abs().ln();
    let mut time = 0.0;
    while duration - time > 1e-12 * duration {
        let h = (1e-3 / rate(z).abs()).min(1e-3 * duration).max(2e-3 * time);
        let h = h.min(duration - time);
        let k1 = rate(z);
        let k2 = rate(z + 0.5 * h * k1);
        let k3 = rate(z + 0.5 * h * k2);
        let k4 = rate(z + h * k3);
        z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        time += h;
    }
    z.exp().copysign(stress)
}

fn battery<L: InelasticLaw>(report: &mut Claims, name: &str, law: Fallible<L>) {
    const SOURCE: &str = "dσ/dt = -E F(σ) by a method of fourth order";
    let law = match law {
        Ok(law) => law,
        Err(error) => {
            return report.check(Claim::new(name, SOURCE), || Err(error));
        }
    };
    report.check(
        Claim::new(
            format!("{name}: relaxed stress, 35 cases of stress and time"),
            SOURCE,
        )
        .within(1e-9, "steps of a thousandth of a time constant"),
        || {
            worst(cases(), |(stress, duration)| {
                let relaxed = law.flow(MODULUS, duration).relax(stress);
                Ok(relaxed / integrated(&law, stress, duration) - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            format!("{name}: two halves of a relaxation are the whole"),
            "semigroup",
        )
        .within(
            2e-13,
            "rounding; the exponential integral of 20 carries 1e-15",
        ),
        || {
            worst(cases(), |(stress, duration)| {
                let half = law.flow(MODULUS, 0.5 * duration);
                let whole = law.flow(MODULUS, duration).relax(stress);
                Ok(whole / half.relax(half.relax(stress)) - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            format!("{name}: stress after the relaxation by the stress before, above 1"),
            "no energy is created",
        )
        .within(1e-15, "none may be"),
        || {
            worst(cases(), |(stress, duration)| {
                let part = law.flow(MODULUS, duration).relax(stress) / stress;
                Ok((part - 1.0).max(0.0) + (-part).max(0.0))
            })
        },
    );
    derivatives(report, name, &law);
}

fn derivatives<L: InelasticLaw>(report: &mut Claims, name: &str, law: &L) {
    const H: f64 = 1e-4;
    const SOURCE: &str = "central differences";
    let why = "(1e-4)² times a third derivative of order one";
    // relative to the derivative or, where it is a small part of the stress, to the rounding of that
    let error = |exact: f64, plus: f64, minus: f64, stress: f64| {
        let difference = (plus - minus) / (2.0 * H);
        let scale = exact.abs().max(1e-5 * stress.abs());
        (exact - difference) / scale
    };
    let by_parameter = |stress: f64, duration: f64| {
        let mut values = vec![0.0; L::PARAMETERS.len()];
        let flow = law.flow(MODULUS, duration);
        let relaxed = flow.relax_with_sensitivity(stress, &mut values);
        (relaxed, values)
    };
    report.check(
        Claim::new(format!("{name}: derivative by the stress before"), SOURCE).within(2e-6, why),
        || {
            worst(cases(), |(stress, duration)| {
                let flow = law.flow(MODULUS, duration);
                let exact = by_parameter(stress, duration).0.by_stress * stress;
                let [plus, minus] = [H, -H].map(|h: f64| flow.relax(stress * h.exp()));
                Ok(error(exact, plus, minus, stress))
            })
        },
    );
    report.check(
        Claim::new(
            format!("{name}: derivative by the logarithm of the modulus"),
            SOURCE,
        )
        .within(2e-6, why),
        || {
            worst(cases(), |(stress, duration)| {
                let exact = by_parameter(stress, duration).0.by_log_modulus;
                let [plus, minus] =
                    [H, -H].map(|h: f64| law.flow(MODULUS * h.exp(), duration).relax(stress));
                Ok(error(exact, plus, minus, stress))
            })
        },
    );
    for (index, parameter) in L::PARAMETERS.iter().enumerate() {
        report.check(
            Claim::new(format!("{name}: derivative by {parameter}"), SOURCE).within(2e-6, why),
            || {
                worst(cases(), |(stress, duration)| {
                    let exact = by_parameter(stress, duration).1[index];
                    let moved = |h: f64| -> Fallible<f64> {
                        let mut parameters = law.parameters();
                        parameters[index] += h;
                        let law = law.with_parameters(&parameters)?;
                        Ok(law.flow(MODULUS, duration).relax(stress))
                    };
                    Ok(error(exact, moved(H)?, moved(-H)?, stress))
                })
            },
        );
    }
}

/// E₁(x) = ∫ exp(-x e^w) dw over w > 0, by Simpson's rule.
fn exponential_integral(x: f64) -> f64 {
    // exp(-x e^w) falls below e^{-60} at w = ln(60/x)
    let end = (60.0_f64.max(2.0 * x) / x).ln();
    let count = 4000;
    let h = end / f64::from(count);
    let sum: f64 = (0..=count)
        .map(|k| {
            let weight = match k {
                0 => 1.0,
                k if k == count => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * (-x * (f64::from(k) * h).exp()).exp()
        })
        .sum();
    sum * h / 3.0
}

fn closed_forms(report: &mut Claims) {
    report.check(
        Claim::new(
            "Norton, κ = 2.108, 10 MPa for 0.4 ms",
            "closed form a(1 + na)^(-1/n)",
        )
        .expects(
            {
                let (n, a) = (1.108_f64, 2.5e9 * 0.4e-3 * 4.0 / 10e6);
                10e6 * (1.0 + n * a).powf(-1.0 / n)
            },
            "Pa",
        )
        .within_part(1e-13, "rounding"),
        || {
            let law = MaxwellNorton::from_reference_rate(2.108, 4.0, 10e6)?;
            Ok(law.flow(MODULUS, 0.4e-3).relax(10e6))
        },
    );
    report.check(
        Claim::new(
            "Gurevich and Rabinovich: E₁(|σ|/m) grows by Eh/η, m = 7.08 MPa, η = 3.5 MPa s",
            "closed form; E₁ by Simpson's rule",
        )
        .within(1e-9, "Simpson's rule with 4000 steps"),
        || {
            let (viscosity, m) = (3.5e6, 7.08e6);
            let law = MaxwellGurevichRabinovich::new(viscosity, m)?;
            worst(
                [(2e6, 1e-4), (1.2e7, 4e-4), (3e7, 3e-5)],
                |(stress, duration): (f64, f64)| {
                    let after = law.flow(MODULUS, duration).relax(stress);
                    let grown = exponential_integral(after / m) - exponential_integral(stress / m);
                    Ok(grown / (MODULUS * duration / viscosity) - 1.0)
                },
            )
        },
    );
    report.check(
        Claim::new(
            "Norton, κ = 1/2: stress left at the time of extinction, as a part",
            "closed form: 2σ₀^(1/2) B/E",
        )
        .within(1e-12, "the square of a rounding"),
        || {
            // √σ falls in proportion to time: at twice the initial time constant nothing is left
            let law = MaxwellNorton::from_reference_rate(0.5, 4.0, 10e6)?;
            let time = 2.0 * 10e6 / (MODULUS * 4.0);
            Ok(law.flow(MODULUS, time).relax(10e6) / 10e6)
        },
    );
    report.check(
        Claim::new(
            "Norton, κ = 1/2: stress left at half the time of extinction, as a part",
            "closed form: (1 - t/t_e)²",
        )
        .expects(0.25, "1")
        .within(1e-13, "rounding"),
        || {
            let law = MaxwellNorton::from_reference_rate(0.5, 4.0, 10e6)?;
            let time = 10e6 / (MODULUS * 4.0);
            Ok(law.flow(MODULUS, time).relax(10e6) / 10e6)
        },
    );
}

fn limits(report: &mut Claims) {
    let linear = |stress: f64| stress * (-2.5e9 * 1e-4 * 4.0 / 10e6_f64).exp();
    report.check(
        Claim::new(
            "Norton with κ = 1 is linear: e^(-Eh/η)",
            "paper D, Table 1, model 1",
        )
        .within(1e-13, "rounding"),
        || {
            let flow = MaxwellNorton::from_reference_rate(1.0, 4.0, 10e6)?.flow(MODULUS, 1e-4);
            Ok(largest(STRESSES.map(|s| flow.relax(s) / linear(s) - 1.0)))
        },
    );
    report.check(
        Claim::new(
            "Gurevich and Rabinovich with 1/m = 0 is linear: e^(-Eh/η)",
            "paper D, Table 1, model 1",
        )
        .within(1e-13, "rounding"),
        || {
            let law = MaxwellGurevichRabinovich::from_reference_rate(0.0, 4.0, 10e6)?;
            let flow = law.flow(MODULUS, 1e-4);
            Ok(largest(STRESSES.map(|s| flow.relax(s) / linear(s) - 1.0)))
        },
    );
    report.check(
        Claim::new(
            "printed parameters of Table 4 are returned as they were given, relative",
            "paper D, Table 4",
        )
        .within(1e-13, "rounding of a power of 1e7"),
        || {
            let norton = MaxwellNorton::new(2.108, 38.16e18)?;
            let gurevich = MaxwellGurevichRabinovich::new(314.6e9, 7.082e12)?;
            Ok(largest([
                norton.coefficient() / 38.16e18 - 1.0,
                gurevich.viscosity() / 314.6e9 - 1.0,
                gurevich.activation_stress() / 7.082e12 - 1.0,
                Maxwell::new(40.85e9)?.viscosity() / 40.85e9 - 1.0,
            ]))
        },
    );
}
