//! Moduli, media and inelastic laws with hostile parameters, frequencies and times.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::inelastic::{
    InelasticLaw, Maxwell as MaxwellFlow, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
};
use rodwave::kramers_kronig::KramersKronig;
use rodwave::medium::{Medium, PropagationLaw, modulus_from_propagation, propagation_from_modulus};
use rodwave::modulus::{
    ConstantQ, DifferentiableModulus, Elastic, FractionalZener, GeneralisedMaxwell,
    HavriliakNegami, KelvinVoigt, LaplaceModulus, Maxwell, MaxwellBranch, OmegaBand,
    PowerLawPropagation, PronyStandIn, SpringPot, Tabulated, TimeDomainModulus, Zener,
};

use super::hostile::are_modest;
use super::{Findings, Numbers, parts};

/// Returns the modulus on and off the axis, the wave that follows from it, its parameters and its
/// derivatives.
fn linear(law: &impl DifferentiableModulus, omega: f64, arguments: &[f64]) -> Numbers {
    let modulus = law.try_at(omega)?;
    let at_s = law.try_at_s(Complex64::new(1.0, omega))?;
    let mut numbers = parts([modulus, at_s]);
    numbers.extend(law.parameters());
    let mut gradient = vec![Complex64::ZERO; law.parameter_names().len()];
    law.gradient(omega, &mut gradient)?;
    // these functions do not check their arguments
    if are_modest(arguments) {
        numbers.extend(parts(gradient));
        numbers.extend(parts([law.slope(omega)]));
    }
    Ok(numbers)
}

fn waves(law: impl LaplaceModulus, density: f64, omega: f64) -> Numbers {
    let medium = Medium::new(density, law)?;
    let gamma = medium.try_propagation_coefficient(omega)?;
    let at_s = medium.try_propagation_coefficient_at_s(Complex64::new(1.0, omega))?;
    Ok(parts([gamma, at_s]))
}

fn in_time(law: &impl TimeDomainModulus, time: f64) -> Numbers {
    // one of the two values may be an error while the other is not, for example if the creep
    // compliance of a fluid overflows
    let answers = [law.relaxation_modulus(time), law.creep_compliance(time)];
    Ok(answers.into_iter().flatten().collect())
}

#[test]
fn linear_laws() {
    let mut findings = Findings::default();
    findings.sweep_pairs("Elastic", &[3e9, 1e4, 1e-3], |a| {
        let law = Elastic::new(a[0])?;
        Ok([linear(&law, a[1], a)?, in_time(&law, a[2])?].concat())
    });
    findings.sweep_pairs("Maxwell", &[3e9, 1e6, 1e4, 1e-3], |a| {
        let law = Maxwell::new(a[0], a[1])?;
        Ok([linear(&law, a[2], a)?, in_time(&law, a[3])?].concat())
    });
    findings.sweep_pairs("KelvinVoigt", &[3e9, 1e4, 1e4, 1e-3], |a| {
        let law = KelvinVoigt::new(a[0], a[1])?;
        Ok([linear(&law, a[2], a)?, in_time(&law, a[3])?].concat())
    });
    findings.sweep_pairs("Zener", &[2e9, 3e9, 1e-5, 1e4, 1e-3], |a| {
        let law = Zener::new(a[0], a[1], a[2])?;
        Ok([linear(&law, a[3], a)?, in_time(&law, a[4])?].concat())
    });
    findings.sweep_pairs("FractionalZener", &[2e9, 3e9, 1e-5, 0.5, 1e4, 1e-3], |a| {
        let law = FractionalZener::new(a[0], a[1], a[2], a[3])?;
        Ok([linear(&law, a[4], a)?, in_time(&law, a[5])?].concat())
    });
    findings.sweep_pairs("HavriliakNegami", &[2e9, 3e9, 1e-5, 0.5, 0.7, 1e4], |a| {
        linear(
            &HavriliakNegami::new(a[0], a[1], a[2], a[3], a[4])?,
            a[5],
            a,
        )
    });
    findings.sweep_pairs("SpringPot", &[3e9, 0.1, 1e4, 1e3, 1e-3], |a| {
        let law = SpringPot::new(a[0], a[1], a[2])?;
        Ok([linear(&law, a[3], a)?, in_time(&law, a[4])?].concat())
    });
    findings.sweep_pairs("ConstantQ", &[3e9, 0.1, 1e4, 1e3, 1e-3], |a| {
        let law = ConstantQ::new(a[0], a[1], a[2])?;
        Ok([linear(&law, a[3], a)?, in_time(&law, a[4])?].concat())
    });
    findings.sweep_pairs(
        "GeneralisedMaxwell",
        &[1e9, 1e9, 1e-5, 2e9, 1e-3, 1e4, 1e-3],
        |a| {
            let branches = [1, 3].map(|i| MaxwellBranch {
                modulus: a[i],
                relaxation_time: a[i + 1],
            });
            let law = GeneralisedMaxwell::new(a[0], branches.to_vec())?;
            Ok([linear(&law, a[5], a)?, in_time(&law, a[6])?].concat())
        },
    );
    findings.none();
}

#[test]
fn waves_in_media() {
    let mut findings = Findings::default();
    findings.sweep_pairs("Medium of Elastic", &[1e3, 3e9, 1e4], |a| {
        waves(Elastic::new(a[1])?, a[0], a[2])
    });
    findings.sweep_pairs("Medium of Zener", &[1e3, 2e9, 3e9, 1e-5, 1e4], |a| {
        waves(Zener::new(a[1], a[2], a[3])?, a[0], a[4])
    });
    findings.sweep_pairs("Medium of ConstantQ", &[1e3, 2e9, 0.1, 1e4, 1e4], |a| {
        waves(ConstantQ::new(a[1], a[2], a[3])?, a[0], a[4])
    });
    findings.sweep_pairs(
        "PowerLawPropagation",
        &[1e-6, 1.1, 1e-3, 0.98, 1e4, 1e3],
        |a| {
            let law = PowerLawPropagation::new(a[0], a[1], a[2], a[3])?;
            let gamma = Medium::new(a[5], law)?.try_propagation_coefficient(a[4])?;
            Ok(parts([gamma]))
        },
    );
    findings.sweep_pairs("modulus_from_propagation", &[0.1, 10.0, 1e4, 1e3], |a| {
        let gamma = Complex64::new(a[0], a[1]);
        modulus_from_propagation(gamma, a[2], a[3]).map(|e| parts([e]))
    });
    findings.sweep_pairs("propagation_from_modulus", &[2e9, 1e8, 1e4, 1e3], |a| {
        let modulus = Complex64::new(a[0], a[1]);
        propagation_from_modulus(modulus, a[2], a[3]).map(|gamma| parts([gamma]))
    });
    findings.none();
}

#[test]
fn tables_and_stand_ins() {
    let mut findings = Findings::default();
    findings.sweep_pairs("Tabulated", &[1e3, 1e4, 2e9, 1e8, 3e9, 2e8, 5e3], |a| {
        let table = [Complex64::new(a[2], a[3]), Complex64::new(a[4], a[5])];
        let table = Tabulated::new(&a[..2], &table)?;
        Ok(parts([
            table.lookup(a[6])?,
            table.held().slope_and_value(a[6]),
        ]))
    });
    findings.sweep_pairs(
        "Tabulated, three lines",
        &[1e3, 1e4, 1e5, 2e9, 3e9, 4e9, 5e3],
        |a| {
            let table = [a[3], a[4], a[5]].map(|e| Complex64::new(e, 0.1 * e));
            let table = Tabulated::new(&a[..3], &table)?;
            Ok(parts([table.lookup(a[6])?]))
        },
    );
    findings.sweep("PronyStandIn", &[2e9, 0.1, 1e4, 1e2, 1e5, 2.0], |a| {
        let law = ConstantQ::new(a[0], a[1], a[2])?;
        let band = OmegaBand {
            from: a[3],
            to: a[4],
        };
        let stand_in = PronyStandIn::new(&law, band, a[5])?;
        let modulus = stand_in.law().unrelaxed_modulus();
        Ok(vec![modulus, stand_in.greatest_error()])
    });
    findings.sweep(
        "KramersKronig",
        &[1e3, 1e4, 1e5, 2e9, 1e8, 3e9, 1e8, 0.01],
        |a| {
            let modulus =
                [(a[3], a[4]), (a[5], a[6]), (3.2e9, 1e8)].map(|(re, im)| Complex64::new(re, im));
            let found = KramersKronig::of_modulus(&a[..3], &modulus, a[7])?;
            let lines = found.lines.iter();
            let mut numbers = parts(lines.flat_map(|line| [line.causal_modulus, line.residual]));
            numbers.extend([found.residual, found.residual_lower_bound, found.threshold]);
            Ok(numbers)
        },
    );
    findings.none();
}

trait SlopeAndValue {
    fn slope_and_value(&self, omega: f64) -> Complex64;
}

impl<M: rodwave::modulus::ComplexModulus> SlopeAndValue for M {
    fn slope_and_value(&self, omega: f64) -> Complex64 {
        self.slope(omega) + PropagationLaw::modulus(self, omega, 1.0)
    }
}

/// Returns the stress relaxed over one step, by three functions of the flow, and the parameters of
/// the law. The relaxed stress must be between the initial stress and 0.
fn inelastic<L: InelasticLaw>(law: &L, modulus: f64, duration: f64, stress: f64) -> Numbers {
    let flow = law.flow(modulus, duration);
    let relaxed = flow.relax(stress);
    let mut by_parameter = vec![0.0; L::PARAMETERS.len()];
    let with_derivatives = flow.relax_with_sensitivity(stress, &mut by_parameter);
    let lanes = flow.change(&[stress; rodwave::inelastic::LANES]);
    let mut numbers = vec![relaxed, with_derivatives.stress];
    numbers.extend(lanes);
    numbers.extend(law.parameters());
    let (low, high) = (stress.min(0.0), stress.max(0.0));
    assert!((low..=high).contains(&relaxed), "{relaxed:e} of {stress:e}");
    Ok(numbers)
}

/// Checks flows as the solver uses them, with checked moduli and steps and at finite stresses. A
/// NaN from the law would spread through the rod unnoticed.
#[test]
fn inelastic_laws() {
    let mut findings = Findings::default();
    let asked = |a: &[f64]| {
        if a[0] > 0.0 && a[1] > 0.0 && are_modest(a) {
            Ok(())
        } else {
            Err(RodwaveError::TooFewSamples {
                history: "not asked",
                found: 0,
                expected: 0,
            })
        }
    };
    findings.sweep_pairs("Maxwell flow", &[3e9, 1e-6, 1e7, 1e6], |a| {
        asked(a)?;
        inelastic(&MaxwellFlow::new(a[3])?, a[0], a[1], a[2])
    });
    findings.sweep_pairs("Maxwell flow by rate", &[3e9, 1e-6, 1e7, 1e2, 1e7], |a| {
        asked(a)?;
        inelastic(
            &MaxwellFlow::from_reference_rate(a[3], a[4])?,
            a[0],
            a[1],
            a[2],
        )
    });
    findings.sweep_pairs("Norton flow", &[3e9, 1e-6, 1e7, 3.0, 1e2, 1e7], |a| {
        asked(a)?;
        let law = MaxwellNorton::from_reference_rate(a[3], a[4], a[5])?;
        inelastic(&law, a[0], a[1], a[2])
    });
    findings.sweep_pairs(
        "Gurevich-Rabinovich flow",
        &[3e9, 1e-6, 1e7, 2.0, 1e2, 1e7],
        |a| {
            asked(a)?;
            let law = MaxwellGurevichRabinovich::from_reference_rate(a[3], a[4], a[5])?;
            inelastic(&law, a[0], a[1], a[2])
        },
    );
    findings.none();
}
