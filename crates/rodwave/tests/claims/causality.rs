//! The Kramers-Kronig residual: laws that are causal by construction pass, fits that are not do not.

use std::f64::consts::{FRAC_PI_2, TAU};

use num_complex::Complex64;
use rodwave::kramers_kronig::{KramersKronig, Verdict};
use rodwave::medium::Medium;
use rodwave::modulus::{
    ComplexModulus, ConstantQ, FractionalZener, HavriliakNegami, KelvinVoigt, Maxwell,
    PowerLawPropagation, SpringPot, Zener,
};

use super::bodies::nylon;
use testbed::claim::{Claim, Claims, Fallible};
use testbed::hold;

/// Lines between two frequencies in Hz, 20 a decade.
fn band(lowest_hz: f64, highest_hz: f64) -> Vec<f64> {
    let decades = (highest_hz / lowest_hz).log10();
    (0..)
        .map(|index| 0.05 * f64::from(index))
        .take_while(|position| *position <= decades + 1e-9)
        .map(|position| TAU * lowest_hz * 10f64.powf(position))
        .collect()
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let bands = [(500.0, 1e4), (1.0, 1e4), (4e3, 6e3)];
    report.check(
        Claim::new(
            "causal laws called causal, 16 laws on three bands",
            "theorem: a relaxing material is below the threshold",
        )
        .expects(48.0, "1"),
        || {
            let mut passed = 0.0;
            for (lowest, highest) in bands {
                let omega = band(lowest, highest);
                for law in causal_laws()? {
                    let modulus: Vec<_> = omega.iter().map(|&omega| law.at(omega)).collect();
                    let result = KramersKronig::of_modulus(&omega, &modulus, 0.0)?;
                    passed += f64::from(u8::from(result.verdict() == Verdict::Causal));
                }
            }
            Ok(passed)
        },
    );
    for (lowest, residual) in [(500.0, 3.3e-4), (100.0, 2.4e-3)] {
        report.check(
            Claim::new(
                format!("power laws of Nylon-6 from {lowest} Hz to 10 kHz: distance to the nearest causal material"),
                "erratum of paper E, eq. 7: no causal pair; another non-negative least-squares routine",
            )
            .expects(residual, "of |E|")
            .within_part(0.1, "the lines of the other computation are others"),
            || {
                let result = KramersKronig::of_medium(&nylon()?, &band(lowest, 1e4))?;
                Ok(result.residual)
            },
        );
    }
    let ratio = (FRAC_PI_2 * 0.03).tan();
    for (factor, causal) in [(1.0, true), (1.1, false), (0.9, false)] {
        report.check(
            Claim::new(
                format!(
                    "k ∝ ω^0.97 with {factor} of the loss that its dispersion asks for is causal"
                ),
                "closed form α/k = tan(0.03 π/2)",
            )
            .expects(f64::from(u8::from(causal)), "yes 1, no 0"),
            || {
                let law =
                    PowerLawPropagation::new(factor * ratio * 8.937e-4, 0.970, 8.937e-4, 0.970)?;
                let medium = Medium::new(1150.0, law)?;
                let result = KramersKronig::of_medium(&medium, &band(500.0, 1e4))?;
                Ok(f64::from(u8::from(result.verdict() == Verdict::Causal)))
            },
        );
    }
    report.check(
        Claim::new(
            "constant complex modulus E(1 + 0.07i), 0.1 to 10 kHz, is causal",
            "Kramers and Kronig: E' has to grow by (2/π) tan δ ln 100",
        )
        .expects(0.0, "yes 1, no 0"),
        || {
            let omega = band(100.0, 1e4);
            let modulus = vec![Complex64::new(2.6e9, 0.07 * 2.6e9); omega.len()];
            let result = KramersKronig::of_modulus(&omega, &modulus, 0.0)?;
            Ok(f64::from(u8::from(result.verdict() == Verdict::Causal)))
        },
    );
    hold!(report);
}

fn causal_laws() -> Fallible<Vec<Box<dyn ComplexModulus>>> {
    let mut laws: Vec<Box<dyn ComplexModulus>> = Vec::new();
    for tau in [1e-9, 1.234e-4, 1.0] {
        laws.push(Box::new(Maxwell::new(2.7e9, 2.7e9 * tau)?));
        laws.push(Box::new(Zener::new(2.5e9, 2.9e9, tau)?));
        laws.push(Box::new(KelvinVoigt::new(2.7e9, 2.7e9 * tau)?));
        laws.push(Box::new(FractionalZener::new(1.0e9, 3.0e9, tau, 0.7)?));
    }
    laws.push(Box::new(HavriliakNegami::new(
        1.0e9, 3.0e9, 1e-4, 0.6, 1.4,
    )?));
    laws.push(Box::new(SpringPot::new(2.7e9, 0.06, 1e4)?));
    laws.push(Box::new(SpringPot::new(2.7e9, 0.95, 1e4)?));
    laws.push(Box::new(ConstantQ::new(2.7e9, 0.3, 1e4)?));
    Ok(laws)
}
