//! Kramers-Kronig residual: laws that are causal by construction pass, and fits that are not causal
//! fail.
use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::kramers_kronig::{KramersKronig, Verdict};
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{
    ComplexModulus, ConstantQ, Elastic, FractionalZener, GeneralisedMaxwell, HavriliakNegami,
    KelvinVoigt, LaplaceModulus, Maxwell, SpringPot, Zener,
};

use crate::bodies::{nylon, prony};

/// Returns the angular frequencies [rad/s] of a band from its ends in Hz, with 20 lines per decade.
pub(crate) fn band(lowest_hz: f64, highest_hz: f64) -> Vec<f64> {
    let decades = (highest_hz / lowest_hz).log10();
    let mut omega = Vec::new();
    let mut position = 0.0;
    while position <= decades + 1e-9 {
        omega.push(TAU * lowest_hz * 10f64.powf(position));
        position += 0.05;
    }
    omega
}

pub(crate) fn of_law<L: PropagationLaw>(law: L, omega: &[f64]) -> KramersKronig {
    KramersKronig::of_medium(&Medium::new(1150.0, law).unwrap(), omega).unwrap()
}

pub(crate) fn laws() -> Vec<Box<dyn ComplexModulus>> {
    let mut laws: Vec<Box<dyn ComplexModulus>> = vec![Box::new(Elastic::new(2.7e9).unwrap())];
    for tau in [1e-9, 1.1e-5, 1.234e-4, 1.0, 1e6] {
        laws.push(Box::new(Maxwell::new(2.7e9, 2.7e9 * tau).unwrap()));
        laws.push(Box::new(Zener::new(2.5e9, 2.9e9, tau).unwrap()));
        laws.push(Box::new(KelvinVoigt::new(2.7e9, 2.7e9 * tau).unwrap()));
        let fractional = FractionalZener::new(1.0e9, 3.0e9, tau, 0.7);
        laws.push(Box::new(fractional.unwrap()));
        let negami = HavriliakNegami::new(1.0e9, 3.0e9, tau, 0.6, 1.4);
        laws.push(Box::new(negami.unwrap()));
    }
    for exponent in [0.01, 0.06, 0.5, 0.95] {
        laws.push(Box::new(SpringPot::new(2.7e9, exponent, 1e4).unwrap()));
    }
    for loss_factor in [1e-4, 0.02, 0.3] {
        laws.push(Box::new(ConstantQ::new(2.7e9, loss_factor, 1e4).unwrap()));
    }
    let branches = [0, 1, 2, 3, 4, 5, 6].map(|j| (0.1e9, 1.7e-7 * 8f64.powi(j)));
    laws.push(Box::new(prony(2.0e9, &branches)));
    laws
}

/// Checks that the equilibrium modulus, the branches and the viscosity of the nearest material form
/// a law whose values at the lines are those of the result.
#[test]
fn nearest_material_has_the_values_of_its_lines() {
    let omega = band(500.0, 1e4);
    let law = FractionalZener::new(2.0e9, 3.0e9, 1e-4, 0.5).unwrap();
    let result = of_law(law, &omega);
    let prony =
        GeneralisedMaxwell::new(result.equilibrium_modulus, result.branches.clone()).unwrap();
    let mut sum = 0.0;
    for (line, &omega) in result.lines.iter().zip(&omega) {
        let dashpot = Complex64::new(0.0, omega * result.viscosity);
        let causal = prony.at_s(Complex64::new(0.0, omega)) + dashpot;
        // Tolerance: rounding of sums of about ten positive terms.
        assert!((causal - line.causal_modulus).norm() < 1e-13 * causal.norm());
        assert!(((line.modulus - causal) / line.modulus.norm() - line.residual).norm() < 1e-13);
        sum += line.residual.norm_sqr();
    }
    let residual = (sum / omega.len() as f64).sqrt();
    // Tolerance: rounding of 1e-14 in each line, relative to a residual of 1e-5.
    assert!((residual / result.residual - 1.0).abs() < 1e-7);
}

/// Checks that a causal law with a scatter of one per cent is within the threshold that includes
/// the scatter, and beyond the threshold that does not. With such scatter, the power laws of paper
/// E cannot be distinguished from a causal material.
#[test]
fn scatter_has_to_be_known() {
    let omega = band(500.0, 1e4);
    let noisy = |law: &dyn Fn(f64) -> Complex64| -> Vec<Complex64> {
        omega
            .iter()
            .enumerate()
            .map(|(index, &omega)| {
                // Errors of equal magnitude, with directions spread by the golden ratio: their rms
                // is exactly 1 %.
                let direction = TAU * 0.618_033_988_749_895 * index as f64;
                law(omega) * (1.0 + Complex64::from_polar(0.01, direction))
            })
            .collect()
    };
    let law = ConstantQ::new(2.6e9, 0.07, 1e4).unwrap();
    let measured = noisy(&|omega| law.at(omega));
    let verdict = |modulus: &[Complex64], error| {
        KramersKronig::of_modulus(&omega, modulus, error)
            .unwrap()
            .verdict()
    };
    assert_eq!(verdict(&measured, 0.01), Verdict::Causal);
    assert_eq!(verdict(&measured, 0.0), Verdict::NotCausal);
    let nylon = nylon();
    let measured = noisy(&|omega| nylon.modulus(omega));
    assert_eq!(verdict(&measured, 0.01), Verdict::Causal);
}

/// Checks that each line is weighted by its own error: lines with large errors neither mask nor
/// disturb the others.
#[test]
fn lines_count_by_their_own_errors() {
    let omega = band(500.0, 1e4);
    // the error of every other line is a hundred times larger
    let error = |index: usize| 2.6e9 * if index.is_multiple_of(2) { 1e-3 } else { 0.1 };
    let errors: Vec<f64> = (0..omega.len()).map(error).collect();
    let measured = |law: &dyn Fn(f64) -> Complex64| -> Vec<Complex64> {
        let lines = omega.iter().enumerate();
        lines
            .map(|(index, &omega)| {
                let direction = TAU * 0.618_033_988_749_895 * index as f64;
                law(omega) + Complex64::from_polar(error(index), direction)
            })
            .collect()
    };
    let test = |modulus: &[Complex64]| {
        KramersKronig::of_measured_modulus(&omega, modulus, &errors).unwrap()
    };
    let law = ConstantQ::new(2.6e9, 0.07, 1e4).unwrap();
    let causal = test(&measured(&|omega| law.at(omega)));
    assert_eq!(causal.verdict(), Verdict::Causal);
    // the residual of the material itself is exactly 1
    assert!(causal.residual <= 1.0 + 1e-3, "{}", causal.residual);
    let not_causal = measured(&|_| Complex64::new(2.6e9, 0.07 * 2.6e9));
    assert_eq!(test(&not_causal).verdict(), Verdict::NotCausal);
    // with the same error for all lines, the lines with large errors mask the violation
    let worst = KramersKronig::of_modulus(&omega, &not_causal, 0.1).unwrap();
    assert_eq!(worst.verdict(), Verdict::Causal);

    let refused = |errors: &[f64]| {
        KramersKronig::of_measured_modulus(&omega[..3], &not_causal[..3], errors)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused(&[1.0]),
        "array of standard errors has 1 entries, expected 3"
    );
    assert_eq!(
        refused(&[1.0, 0.0, 1.0]),
        "standard error of the modulus [Pa] is 0, expected a finite value above 0"
    );
}

#[test]
fn impossible_spectra_are_refused() {
    let omega = [1.0, 2.0, 3.0];
    let modulus = [Complex64::new(1e9, 1e7); 3];
    assert!(KramersKronig::of_modulus(&omega, &modulus, 0.0).is_ok());
    let refused = [
        KramersKronig::of_modulus(&omega, &modulus[..2], 0.0),
        KramersKronig::of_modulus(&omega[..2], &modulus[..2], 0.0),
        KramersKronig::of_modulus(&[0.0, 1.0, 2.0], &modulus, 0.0),
        KramersKronig::of_modulus(&[1e-305, 1.0, 2.0], &modulus, 0.0),
        KramersKronig::of_modulus(&omega, &[Complex64::ZERO; 3], 0.0),
        KramersKronig::of_modulus(&omega, &modulus, f64::NAN),
        KramersKronig::of_modulus(&omega, &modulus, -0.1),
    ];
    let expected = [
        "array of moduli has 2 entries, expected 3",
        "array of moduli has 2 samples, expected at least 3",
        "angular frequency of a line [rad/s] is 0, expected a finite value above 0",
        "slowest relaxation time of the grid [s] is inf, expected a finite value above 0",
        "magnitude of the complex modulus [Pa] is 0, expected a finite value above 0",
        "relative standard error of the modulus is NaN, expected a finite value, 0 or above",
        "relative standard error of the modulus is -0.1, expected a finite value, 0 or above",
    ];
    for (outcome, expected) in refused.into_iter().zip(expected) {
        let error: RodwaveError = outcome.unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
}

/// Standard normal numbers by the Box-Muller method, from a linear congruential generator (MMIX by
/// Knuth).
fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    move || (-2.0 * uniform().ln()).sqrt() * (TAU * uniform()).cos()
}

/// Tests a material with a constant loss factor of 0.1 at 60 lines from 0.5 to 10 kHz with 5 % of
/// noise: the unchanged modulus must be causal, the modulus with doubled losses must not.
#[test]
fn f7_a_doubled_loss_is_found_beneath_the_noise() {
    let omega: Vec<f64> = (0..60)
        .map(|j| TAU * 500.0 * 20f64.powf(f64::from(j) / 59.0))
        .collect();
    let law = ConstantQ::new(2.3e9, 0.1, 1e4).unwrap();
    let mut found = [0, 0];
    let seeds = 40;
    for seed in 0..seeds {
        let mut normal = normals(seed);
        for (case, factor) in [1.0, 2.0].into_iter().enumerate() {
            let (mut modulus, mut errors) = (Vec::new(), Vec::new());
            for &omega in &omega {
                let right = Medium::new(1150.0, law).unwrap().modulus(omega);
                let given = Complex64::new(right.re, factor * right.im);
                let error = 0.05 * given.norm();
                let part = error / 2f64.sqrt();
                modulus.push(given + Complex64::new(part * normal(), part * normal()));
                errors.push(error);
            }
            let tested = KramersKronig::of_measured_modulus(&omega, &modulus, &errors).unwrap();
            found[case] += u64::from(tested.verdict() != Verdict::Causal);
        }
    }
    // tolerance: with a rate of false alarms of 1 %, more than 2 of 40 have a probability below 1
    // %; with a rate of detection of 95 %, 33 or fewer of 40 have a probability of 0.3 %
    assert!(found[0] <= 2, "false alarms {found:?}");
    assert!(found[1] >= 34, "{found:?}");
}

/// Checks a Zener material whose values are wrong by 1.5 times a common error that oscillates with
/// the frequency: no relaxing material has these values unless the error is stated.
#[test]
fn a_declared_common_error_is_no_violation() {
    let omega: Vec<f64> = (1..=100).map(|j| 500.0 * f64::from(j)).collect();
    let relaxing = |omega: f64| {
        let s_tau = Complex64::new(0.0, omega * 1e-4);
        2e9 + 1e9 * s_tau / (1.0 + s_tau)
    };
    let wave: Vec<Complex64> = omega
        .iter()
        .map(|omega| Complex64::new(5e7 * (omega / 2e3).sin(), 0.0))
        .collect();
    let measured = omega.iter().zip(&wave);
    let modulus: Vec<Complex64> = measured.map(|(w, e)| relaxing(*w) + 1.5 * e).collect();
    let errors = vec![1e7; omega.len()];
    let silent = KramersKronig::of_measured_modulus(&omega, &modulus, &errors).unwrap();
    assert_eq!(silent.verdict(), Verdict::NotCausal);
    let declared = KramersKronig::of_modulus_with_common_errors(&omega, &modulus, &errors, &[wave]);
    let declared = declared.unwrap();
    assert_eq!(declared.verdict(), Verdict::Causal);
    assert!((declared.common_errors[0] - 1.5).abs() < 0.1);
}
