//! Acceptance limits of a line beyond the conditions of the paper: errors, amplification, coherence.

use super::Violation;
use crate::error::CmodError;
use crate::estimate::{ModulusLine, VarianceFreedom, coverage_factor};

/// Default of [`AcceptanceLimits::storage_modulus`]: E' to 1 %.
pub const GREATEST_STORAGE_MODULUS_ERROR: f64 = 0.01;

/// Default of [`AcceptanceLimits::loss_factor`]: the loss factor to 5 %.
pub const GREATEST_LOSS_FACTOR_ERROR: f64 = 0.05;

/// Number of standard errors that must lie within the accepted error of E' and of the loss factor. At five, one
/// line in 1.7 million at the very limit exceeds it: in practice none of a record.
pub const STANDARD_ERRORS_WITHIN: f64 = 5.0;

/// Probability of an error within [`STANDARD_ERRORS_WITHIN`] standard errors.
const PROBABILITY_WITHIN: f64 = 0.999_999_426_696_856;

/// Default of [`AcceptanceLimits::error_amplification`]. No calibration of a pair of sensors excludes an error of
/// 0.1 % in the ratio; amplified ten times it is 1 % of the modulus, the whole accepted error of E'.
pub const GREATEST_ERROR_AMPLIFICATION: f64 = 10.0;

/// Maximum ratio of the second order of an error to its standard error. At 0.1 it is a bias of a tenth of σ, and
/// the bounds of 1σ and 2σ keep their meaning.
pub const GREATEST_SECOND_ORDER: f64 = 0.1;

/// Default of [`AcceptanceLimits::greatest_poisson_ratio`]: that of an incompressible material, the maximum for an isotropic one.
pub const GREATEST_POISSON_RATIO: f64 = 0.5;

/// Number of standard errors of the common sources for [`AcceptanceLimits::common_storage_modulus`]: some 95 %.
pub const COMMON_STANDARD_ERRORS_WITHIN: f64 = 2.0;

/// Error limits that a valid line must meet. The limits of a method are part of its settings.
///
/// The conditions (i)-(iii) of paper A concern the physics of a line and not the size of its error. These limits
/// concern the errors that differ from line to line and between methods: the random error, and the lateral inertia
/// that the theory of the waves leaves in the modulus. With the defaults, noise and theory leave E' of a valid line
/// within 1 % and its loss factor within 5 %.
///
/// A common error, of the length, the density or the mass of the accelerometer, shifts all lines alike and
/// therefore makes none invalid. It is stated beside the random error
/// ([`ModulusLine::systematic_error`](crate::ModulusLine::systematic_error)) and is part of the standard error.
/// `common_storage_modulus` sets a bound on it, too.
///
/// A limit that is infinite (0 for the coherence) is not checked.
///
/// ```
/// use cmod::validity::AcceptanceLimits;
///
/// // a material of low loss: its loss factor is sufficient to 20 %
/// let limits = AcceptanceLimits { loss_factor: 0.2, ..AcceptanceLimits::default() };
/// assert_eq!(limits.storage_modulus, 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceptanceLimits {
    /// Greatest relative error of E' due to noise and to the theory of the waves: [`STANDARD_ERRORS_WITHIN`] standard
    /// errors of the random part, and the [bound](crate::estimate::Uncertainty::lateral_inertia_bound) on lateral
    /// inertia that was not removed. If the variance was estimated from few averages, the number of standard errors of
    /// the random part is the one with the same probability by Student's distribution; 7.6 for ten averages.
    pub storage_modulus: f64,
    /// Greatest relative error of E''/E', likewise.
    pub loss_factor: f64,
    /// Greatest relative common error of E' due to all common sources together, as
    /// [`COMMON_STANDARD_ERRORS_WITHIN`] standard errors. Infinite by default.
    pub common_storage_modulus: f64,
    /// Greatest Poisson's ratio ν that the material may have, from 0 to 0.5. One-dimensional theory makes E' too small by up to
    /// (πνD/λ)²/2 of itself: with 0.5, the default, 1 % at λ = 11 D. Where ν is known, [`LateralInertia`](crate::LateralInertia)
    /// removes that error. 0 is for waves without lateral inertia, as in one-dimensional simulations.
    pub greatest_poisson_ratio: f64,
    /// Greatest |dE/E| divided by |dΨ/Ψ|.
    pub error_amplification: f64,
    /// Least ordinary coherence, where a coherence is known.
    pub coherence: f64,
}

impl Default for AcceptanceLimits {
    fn default() -> Self {
        Self {
            greatest_poisson_ratio: GREATEST_POISSON_RATIO,
            ..Self::ONE_DIMENSIONAL
        }
    }
}

impl AcceptanceLimits {
    /// Default limits for waves without lateral inertia: simulated ones, or those of a rod whose Poisson's ratio is 0.
    pub const ONE_DIMENSIONAL: Self = Self {
        storage_modulus: GREATEST_STORAGE_MODULUS_ERROR,
        loss_factor: GREATEST_LOSS_FACTOR_ERROR,
        common_storage_modulus: f64::INFINITY,
        greatest_poisson_ratio: 0.0,
        error_amplification: GREATEST_ERROR_AMPLIFICATION,
        coherence: 0.0,
    };

    /// No limits: only the conditions of the paper and the reports of the solution are checked. One-dimensional
    /// theory is taken as exact.
    pub const NONE: Self = Self {
        storage_modulus: f64::INFINITY,
        loss_factor: f64::INFINITY,
        common_storage_modulus: f64::INFINITY,
        greatest_poisson_ratio: 0.0,
        error_amplification: f64::INFINITY,
        coherence: 0.0,
    };

    pub(crate) fn check(self) -> Result<Self, CmodError> {
        let above_zero = [
            ("greatest error of E'", self.storage_modulus),
            ("greatest error of the loss factor", self.loss_factor),
            ("greatest common error of E'", self.common_storage_modulus),
            ("greatest error amplification", self.error_amplification),
        ];
        for (quantity, value) in above_zero {
            if value.is_nan() || value <= 0.0 {
                return Err(CmodError::NonPhysical {
                    quantity,
                    value,
                    expected: "a value above 0, infinite if it is not asked",
                });
            }
        }
        if !(0.0..=1.0).contains(&self.coherence) {
            return Err(CmodError::NonPhysical {
                quantity: "least coherence",
                value: self.coherence,
                expected: "a value from 0 to 1",
            });
        }
        if !(0.0..=0.5).contains(&self.greatest_poisson_ratio) {
            return Err(CmodError::NonPhysical {
                quantity: "greatest poisson's ratio",
                value: self.greatest_poisson_ratio,
                expected: "a value from 0 to 0.5",
            });
        }
        Ok(self)
    }
}

/// Limits for the lines of one record.
pub(crate) struct Acceptance {
    limits: AcceptanceLimits,
    degrees_of_freedom: Option<f64>,
    own_degrees_of_freedom: Option<f64>,
    /// Number of standard errors of the random part.
    factor: f64,
}

impl Acceptance {
    /// Creates the limits for variances with `degrees_of_freedom`; `None` if they are known.
    pub(crate) fn new(
        limits: AcceptanceLimits,
        degrees_of_freedom: Option<f64>,
    ) -> Result<Self, CmodError> {
        let factor = match degrees_of_freedom {
            None => STANDARD_ERRORS_WITHIN,
            Some(_) => coverage_factor(PROBABILITY_WITHIN, degrees_of_freedom)?,
        };
        Ok(Self {
            limits,
            degrees_of_freedom,
            own_degrees_of_freedom: degrees_of_freedom,
            factor,
        })
    }

    /// Creates the limits for one line, with a variance of this `freedom`; `None` if it is known.
    pub(crate) fn of_line(
        limits: AcceptanceLimits,
        freedom: Option<VarianceFreedom>,
    ) -> Result<Self, CmodError> {
        Ok(Self {
            own_degrees_of_freedom: freedom.map(|freedom| freedom.own),
            ..Self::new(limits, freedom.map(|freedom| freedom.line))?
        })
    }

    pub(crate) fn degrees_of_freedom(&self) -> Option<f64> {
        self.degrees_of_freedom
    }

    pub(crate) fn own_degrees_of_freedom(&self) -> Option<f64> {
        self.own_degrees_of_freedom
    }

    pub(crate) fn limits(&self) -> &AcceptanceLimits {
        &self.limits
    }

    /// Returns the limits that `line` exceeds.
    pub(crate) fn violations(&self, line: &ModulusLine) -> Vec<Violation> {
        let mut violations = Vec::new();
        let random = line.random_error();
        let inertia = line.lateral_inertia_bound();
        let storage = line.modulus.re.abs();
        let loss = line.loss_factor.abs();
        for (quantity, random, inertia, limit) in [
            (
                "E'",
                random.storage_modulus / storage,
                inertia.storage_modulus / storage,
                self.limits.storage_modulus,
            ),
            (
                "the loss factor",
                random.loss_factor / loss,
                inertia.loss_factor / loss,
                self.limits.loss_factor,
            ),
        ] {
            // the bound is not a standard error: it adds to the possible random error
            let error = self.factor * random + inertia;
            if inertia > limit {
                violations.push(Violation::LateralInertiaTooLarge {
                    quantity,
                    error: inertia,
                    limit,
                });
            } else if error > limit {
                violations.push(Violation::ErrorTooLarge {
                    quantity,
                    error,
                    limit,
                });
            }
        }
        let common =
            COMMON_STANDARD_ERRORS_WITHIN * line.systematic_error().storage_modulus / storage;
        let largest = line
            .uncertainty
            .systematic
            .iter()
            .max_by(|a, b| a.modulus.re.abs().total_cmp(&b.modulus.re.abs()));
        if common > self.limits.common_storage_modulus
            && let Some(largest) = largest
        {
            violations.push(Violation::CommonErrorTooLarge {
                error: common,
                largest: largest.source,
                limit: self.limits.common_storage_modulus,
            });
        }
        if line.error_amplification > self.limits.error_amplification {
            violations.push(Violation::ErrorAmplified {
                amplification: line.error_amplification,
                limit: self.limits.error_amplification,
            });
        }
        violations
    }

    /// Returns the violation of the least coherence, if `coherence` is below it.
    pub(crate) fn incoherent(&self, coherence: f64) -> Option<Violation> {
        (coherence < self.limits.coherence).then_some(Violation::CoherenceTooLow {
            coherence,
            limit: self.limits.coherence,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_standard_errors_of_a_known_variance_are_more_of_an_estimated_one() {
        let known = Acceptance::new(AcceptanceLimits::default(), None).unwrap();
        assert!((coverage_factor(PROBABILITY_WITHIN, None).unwrap() - known.factor).abs() < 1e-6);
        // Student's distribution with 18 degrees of freedom: the tail by its series, 2.87e-7 at 7.59
        let ten_averages = Acceptance::new(AcceptanceLimits::default(), Some(18.0)).unwrap();
        assert!(
            (ten_averages.factor - 7.6).abs() < 0.1,
            "{}",
            ten_averages.factor
        );
    }

    #[test]
    fn impossible_limits_are_refused() {
        let text = |limits: AcceptanceLimits| limits.check().unwrap_err().to_string();
        let default = AcceptanceLimits::default();
        assert_eq!(
            text(AcceptanceLimits {
                storage_modulus: 0.0,
                ..default
            }),
            "greatest error of E' is 0, expected a value above 0, infinite if it is not asked"
        );
        assert_eq!(
            text(AcceptanceLimits {
                coherence: 1.5,
                ..default
            }),
            "least coherence is 1.5, expected a value from 0 to 1"
        );
        assert_eq!(
            text(AcceptanceLimits {
                greatest_poisson_ratio: 0.6,
                ..default
            }),
            "greatest poisson's ratio is 0.6, expected a value from 0 to 0.5"
        );
        let nan = AcceptanceLimits {
            error_amplification: f64::NAN,
            ..default
        };
        assert!(nan.check().is_err());
        assert!(AcceptanceLimits::NONE.check().is_ok());
    }
}
