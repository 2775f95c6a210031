//! From a propagation coefficient and its variance to a line of the result.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::medium::modulus_from_propagation;

use crate::estimate::{ModulusLine, Refusal, StandardError, Termination};
use crate::validity::{Validity, Violation, conditions};

/// At most so large a part of the standard error may its second order be: the bounds of 1σ and 2σ then keep their meaning.
const MOST_SECOND_ORDER: f64 = 0.1;

/// What of a rod its ratios need not know, but the modulus and its validity do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RodOfRatio {
    /// D \[m\].
    pub(crate) diameter: f64,
    /// ρ [kg/m³].
    pub(crate) density: f64,
    /// The length of condition (ii) \[m\]: the longest way between what is compared.
    pub(crate) length: f64,
}

/// γ of one line and all that goes with it.
pub(crate) struct SolvedRatio {
    pub(crate) index: usize,
    pub(crate) frequency_hz: f64,
    pub(crate) gamma: Complex64,
    /// E|δγ|² [1/m²].
    pub(crate) variance: f64,
    /// Second order of the error of γ by |δγ|² \[m\].
    pub(crate) curvature: f64,
    /// |dγ| by |dΨ/Ψ| [1/m].
    pub(crate) amplification: f64,
    pub(crate) termination: Termination,
    pub(crate) violations: Vec<Violation>,
    /// Distance by which half waves are counted \[m\].
    pub(crate) distance: f64,
}

impl SolvedRatio {
    pub(crate) fn into_modulus(self, rod: &RodOfRatio) -> Result<ModulusLine, Refusal> {
        let gamma = self.gamma;
        let omega = TAU * self.frequency_hz;
        let modulus =
            modulus_from_propagation(gamma, omega, rod.density).map_err(|_| Refusal::NoRoot)?;
        let mut violations = conditions(gamma, rod.diameter, rod.length);
        violations.extend(self.violations);
        let second_order = self.curvature * self.variance.sqrt();
        if second_order > MOST_SECOND_ORDER {
            violations.push(Violation::NearSingular {
                second_order,
                limit: MOST_SECOND_ORDER,
                half_waves: gamma.im * self.distance / PI,
            });
        }
        if let Termination::LostPatience {
            iterations,
            residual,
        } = self.termination
        {
            violations.push(Violation::NotConverged {
                iterations,
                residual,
            });
        }
        // E = -ρω²/γ²: dE/E = -2 dγ/γ
        let sensitivity = -2.0 * modulus / gamma;
        let line = ModulusLine {
            index: self.index,
            frequency_hz: self.frequency_hz,
            propagation_coefficient: gamma,
            modulus,
            loss_factor: modulus.im / modulus.re,
            phase_velocity: omega / gamma.im,
            standard_error: StandardError::propagated(modulus, sensitivity, self.variance),
            error_amplification: 2.0 * self.amplification / gamma.norm(),
            closed_form: None,
            termination: self.termination,
            validity: Validity::from_violations(violations),
        };
        let numbers = [
            modulus.norm(),
            line.loss_factor,
            line.phase_velocity,
            line.standard_error.storage_modulus,
            line.standard_error.loss_factor,
            line.error_amplification,
            second_order,
        ];
        if numbers.iter().all(|number| number.is_finite()) {
            Ok(line)
        } else {
            Err(Refusal::Undetermined)
        }
    }
}
