//! What a user asks of a line beyond the conditions of the paper: errors, amplification, coherence.

use super::Violation;
use crate::error::CmodError;
use crate::estimate::{ModulusLine, VarianceFreedom, coverage_factor};

/// Default of [`AcceptanceLimits::storage_modulus`]: E' to 1 %.
pub const GREATEST_STORAGE_MODULUS_ERROR: f64 = 0.01;

/// Default of [`AcceptanceLimits::loss_factor`]: the loss factor to 5 %.
pub const GREATEST_LOSS_FACTOR_ERROR: f64 = 0.05;

/// So many standard errors must lie within the accepted error of E' and of the loss factor. At five, one line in 1.7
/// million at the very limit exceeds it: of all lines of a record, none.
pub const STANDARD_ERRORS_WITHIN: f64 = 5.0;

/// Probability of an error within [`STANDARD_ERRORS_WITHIN`] standard errors.
const PROBABILITY_WITHIN: f64 = 0.999_999_426_696_856;

/// Default of [`AcceptanceLimits::error_amplification`]. No calibration of a pair of sensors excludes an error of 0.1 % in
/// the ratio; amplified ten times it is 1 % of the modulus, all that is accepted of E'.
pub const GREATEST_ERROR_AMPLIFICATION: f64 = 10.0;

/// At most so large a part of the standard error may its second order be. At 0.1 it is a bias of a tenth of σ, and the
/// bounds of 1σ and 2σ keep their meaning.
pub const GREATEST_SECOND_ORDER: f64 = 0.1;

/// What errors are accepted of a valid line. The limits of a method are part of its settings.
///
/// The conditions (i)-(iii) of paper A are about the physics of a line and say nothing of the size of its error. These
/// limits do: of a valid line E' is known to 1 % and the loss factor to 5 %, if the defaults are kept. A limit that
/// is infinite (0 for the coherence) is not asked.
///
/// ```
/// use cmod::validity::AcceptanceLimits;
///
/// // a material of low loss: its loss factor to 20 % will do
/// let limits = AcceptanceLimits { loss_factor: 0.2, ..AcceptanceLimits::default() };
/// assert_eq!(limits.storage_modulus, 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceptanceLimits {
    /// Greatest relative error of E'. [`STANDARD_ERRORS_WITHIN`] standard errors must be less: the largest relative
    /// standard error accepted is one fifth of this limit. If the variance was estimated from few averages, the random
    /// part counts with as many standard errors as are exceeded as rarely by Student's distribution; 7.6 for ten averages.
    pub storage_modulus: f64,
    /// Greatest relative error of E''/E', likewise.
    pub loss_factor: f64,
    /// Greatest |dE/E| by |dΨ/Ψ|.
    pub error_amplification: f64,
    /// Least ordinary coherence, where a coherence is known.
    pub coherence: f64,
}

impl Default for AcceptanceLimits {
    fn default() -> Self {
        Self {
            storage_modulus: GREATEST_STORAGE_MODULUS_ERROR,
            loss_factor: GREATEST_LOSS_FACTOR_ERROR,
            error_amplification: GREATEST_ERROR_AMPLIFICATION,
            coherence: 0.0,
        }
    }
}

impl AcceptanceLimits {
    /// No limits: only the conditions of the paper and what the solution reports are asked.
    pub const NONE: Self = Self {
        storage_modulus: f64::INFINITY,
        loss_factor: f64::INFINITY,
        error_amplification: f64::INFINITY,
        coherence: 0.0,
    };

    pub(crate) fn check(self) -> Result<Self, CmodError> {
        let above_zero = [
            ("greatest error of E'", self.storage_modulus),
            ("greatest error of the loss factor", self.loss_factor),
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
        Ok(self)
    }
}

/// The limits for the lines of one record.
pub(crate) struct Acceptance {
    limits: AcceptanceLimits,
    degrees_of_freedom: Option<f64>,
    own_degrees_of_freedom: Option<f64>,
    /// Standard errors that the random part counts with.
    factor: f64,
}

impl Acceptance {
    /// For variances with so many `degrees_of_freedom`; `None` if they are known.
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

    /// For one line, of a variance of this `freedom`; `None` if it is known.
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

    /// What of the limits `line` exceeds.
    pub(crate) fn violations(&self, line: &ModulusLine) -> Vec<Violation> {
        let mut violations = Vec::new();
        let total = &line.standard_error;
        let (random, systematic);
        let (random, systematic) = if line.uncertainty.systematic.is_empty() {
            (total, None)
        } else {
            random = line.random_error();
            systematic = line.systematic_error();
            (&random, Some(&systematic))
        };
        let within = |random: f64, systematic: Option<f64>| {
            (self.factor * random).hypot(STANDARD_ERRORS_WITHIN * systematic.unwrap_or(0.0))
        };
        let storage = within(
            random.storage_modulus,
            systematic.map(|error| error.storage_modulus),
        ) / line.modulus.re.abs();
        if storage > self.limits.storage_modulus {
            violations.push(Violation::ErrorTooLarge {
                quantity: "E'",
                error: storage,
                limit: self.limits.storage_modulus,
            });
        }
        let loss = within(
            random.loss_factor,
            systematic.map(|error| error.loss_factor),
        ) / line.loss_factor.abs();
        if loss > self.limits.loss_factor {
            violations.push(Violation::ErrorTooLarge {
                quantity: "the loss factor",
                error: loss,
                limit: self.limits.loss_factor,
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

    /// Whether a `coherence` is too low.
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
        let nan = AcceptanceLimits {
            error_amplification: f64::NAN,
            ..default
        };
        assert!(nan.check().is_err());
        assert!(AcceptanceLimits::NONE.check().is_ok());
    }
}
