//! Conversion of a propagation coefficient with its errors to a line of the result, common to all
//! methods.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::slenderness::elementary_theory_error;

use super::{
    Acceptance, ComplexCovariance, ErrorSource, LineCovariance, ModulusEstimate, ModulusLine,
    Refusal, StandardError, SystematicShift, Termination, Uncertainty,
};
use crate::branch::ResolvedRoot;
use crate::complex_frequency::ComplexFrequency;
use crate::error::{CmodError, check_not_negative, check_positive};
use crate::validity::{GREATEST_SECOND_ORDER, Validity, Violation};

/// Propagation coefficient γ of one line with its errors.
pub(crate) struct Solution {
    pub(crate) index: usize,
    pub(crate) frequency: ComplexFrequency,
    /// Propagation coefficient γ [1/m] at `frequency`.
    pub(crate) gamma: Complex64,
    /// Density ρ [kg/m³].
    pub(crate) density: f64,
    /// Diameter D \[m\].
    pub(crate) diameter: f64,
    /// Covariance of γ due to noise [1/m²].
    pub(crate) random: ComplexCovariance,
    /// Shifts due to the errors of the specimen; empty if the specimen has no uncertainty. The
    /// error of one-dimensional theory is added by `into_line`.
    pub(crate) systematic: Vec<SystematicShift>,
    /// |dE/E| divided by the relative error of the measured quantity.
    pub(crate) error_amplification: f64,
    /// Ratio of the second-order to the first-order part of the random error.
    pub(crate) second_order: f64,
    /// Distance between the neighbouring sections \[m\], to determine the distance to a singular
    /// line.
    pub(crate) distance: f64,
    pub(crate) closed_form: Option<ResolvedRoot>,
    pub(crate) termination: Termination,
    /// Violations found so far: conditions (i)-(iii), the branch, the misfit.
    pub(crate) violations: Vec<Violation>,
}

impl Solution {
    /// Returns the judged line, or a refusal if one of its numbers is not finite.
    pub(crate) fn into_line(self, acceptance: &Acceptance) -> Result<ModulusLine, Refusal> {
        let gamma = self.gamma;
        let frequency_hz = self.frequency.hz();
        let modulus = self
            .frequency
            .modulus(gamma, self.density)
            .map_err(|_| Refusal::NoRoot)?;
        let mut violations = self.violations;
        if self.second_order > GREATEST_SECOND_ORDER {
            violations.push(Violation::NearSingular {
                second_order: self.second_order,
                limit: GREATEST_SECOND_ORDER,
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
        // from E = -ρω²/γ² follows dE/dγ = -2E/γ
        let random = LineCovariance {
            modulus: self.random.through(-2.0 * modulus / gamma),
            propagation_coefficient: self.random,
        };
        let mut systematic = self.systematic;
        systematic.extend(lateral_inertia(
            modulus,
            gamma.im * self.diameter,
            acceptance.limits.greatest_poisson_ratio,
        ));
        let uncertainty = Uncertainty {
            random,
            systematic,
            degrees_of_freedom: acceptance.degrees_of_freedom,
            own_degrees_of_freedom: acceptance.own_degrees_of_freedom,
        };
        let standard_error = StandardError::of(
            modulus,
            gamma,
            frequency_hz,
            &uncertainty.total_covariance(),
        );
        let mut line = ModulusLine {
            index: self.index,
            frequency_hz,
            propagation_coefficient: gamma,
            modulus,
            loss_factor: modulus.im / modulus.re,
            phase_velocity: TAU * frequency_hz / gamma.im,
            standard_error,
            uncertainty,
            error_amplification: self.error_amplification,
            second_order: self.second_order,
            closed_form: self.closed_form,
            termination: self.termination,
            validity: Validity::Valid,
        };
        violations.extend(acceptance.violations(&line));
        line.validity = Validity::from_violations(violations);
        let numbers = [
            modulus.norm(),
            line.loss_factor,
            line.phase_velocity,
            line.error_amplification,
            line.second_order,
        ];
        if numbers.iter().all(|number| number.is_finite()) && line.standard_error.is_finite() {
            Ok(line)
        } else {
            Err(Refusal::Undetermined)
        }
    }
}

impl ModulusEstimate {
    /// Returns the estimate with every modulus multiplied by 1 + `change`, for example to convert
    /// it from the temperature of the test to another temperature; `standard_error` is the standard
    /// error of `change`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless 1 + `change` is positive and the standard error is not
    /// negative.
    pub fn changed_by(&self, change: f64, standard_error: f64) -> Result<Self, CmodError> {
        check_positive(
            "ratio of the modulus at the reference to that of the test",
            1.0 + change,
        )?;
        check_not_negative(
            "standard error of the change of the modulus",
            standard_error,
        )?;
        // from E = -ρω²/γ² follows the factor on γ
        let turn = (1.0 + change).powf(-0.5);
        let scaled = |covariance: LineCovariance| LineCovariance {
            modulus: covariance.modulus.through(Complex64::from(1.0 + change)),
            propagation_coefficient: covariance
                .propagation_coefficient
                .through(Complex64::from(turn)),
        };
        self.revised(Refusal::Undetermined, |line, acceptance| {
            let mut line = line.clone();
            let of_modulus = line.modulus * standard_error;
            let of_gamma = -0.5 * turn / (1.0 + change) * line.propagation_coefficient;
            line.modulus *= 1.0 + change;
            line.propagation_coefficient *= turn;
            line.uncertainty.random = scaled(line.uncertainty.random);
            for shift in &mut line.uncertainty.systematic {
                shift.modulus *= 1.0 + change;
                shift.propagation_coefficient *= turn;
            }
            if standard_error > 0.0 {
                line.uncertainty.systematic.push(SystematicShift::new(
                    ErrorSource::Temperature,
                    of_modulus,
                    of_gamma * standard_error,
                ));
            }
            line.revised(acceptance, |_| true)
        })
    }

    /// Returns the estimate with every line replaced by `revise`, which judges the line with an
    /// acceptance for its degrees of freedom. Lines for which `revise` returns `None` are refused
    /// for `reason`.
    pub(crate) fn revised(
        &self,
        reason: Refusal,
        mut revise: impl FnMut(&ModulusLine, &Acceptance) -> Option<ModulusLine>,
    ) -> Result<Self, CmodError> {
        let mut acceptance = Acceptance::new(self.limits, None)?;
        let mut revised = Self {
            lines: Vec::with_capacity(self.lines.len()),
            ..self.clone()
        };
        for line in &self.lines {
            let degrees_of_freedom = line.uncertainty.degrees_of_freedom;
            if acceptance.degrees_of_freedom != degrees_of_freedom {
                acceptance = Acceptance::new(self.limits, degrees_of_freedom)?;
            }
            let line_or_reason = revise(line, &acceptance).ok_or(reason);
            revised.add(line.index, line.frequency_hz, line_or_reason);
        }
        Ok(revised)
    }
}

impl ModulusLine {
    /// Returns the line with all results derived from its corrected modulus, propagation
    /// coefficient and uncertainty. Violations that do not concern the size of an error are kept if
    /// `stays` returns true for them. Returns `None` if a number is not finite.
    pub(crate) fn revised(
        mut self,
        acceptance: &Acceptance,
        stays: impl Fn(&Violation) -> bool,
    ) -> Option<Self> {
        self.loss_factor = self.modulus.im / self.modulus.re;
        self.phase_velocity = TAU * self.frequency_hz / self.propagation_coefficient.im;
        self.standard_error = self.standard_error_of(&self.uncertainty.total_covariance());
        let mut violations = self.validity.violations().to_vec();
        violations.retain(|violation| {
            let of_size = matches!(
                violation,
                Violation::ErrorTooLarge { .. }
                    | Violation::LateralInertiaTooLarge { .. }
                    | Violation::CommonErrorTooLarge { .. }
                    | Violation::ErrorAmplified { .. }
            );
            !of_size && stays(violation)
        });
        violations.extend(acceptance.violations(&self));
        self.validity = Validity::from_violations(violations);
        let is_finite = self.loss_factor.is_finite() && self.standard_error.is_finite();
        is_finite.then_some(self)
    }
}

/// Returns the error of one-dimensional theory for a `modulus` at kD = `wave_number`: E' is too
/// small by at most the fraction ½ν²(kD/2)², and E'' is not affected. `None` if `wave_number` or ν
/// is zero.
fn lateral_inertia(
    modulus: Complex64,
    wave_number: f64,
    poisson_ratio: f64,
) -> Option<SystematicShift> {
    let error = elementary_theory_error(TAU / wave_number, poisson_ratio).ok()?;
    // E'' is not affected, so E''/E' is too large by the fraction by which E' is too small
    let bound = modulus.re.abs() * error.loss_factor;
    (bound > 0.0).then(|| SystematicShift::of_lateral_inertia(Complex64::new(bound, 0.0)))
}
