//! Judgement of a line by the acceptance limits.

use super::{ModulusEstimate, ModulusLine, Refusal, VarianceFreedom};
use crate::error::CmodError;
use crate::uncertainty::{PROBABILITY_WITHIN, coverage_factor};
use crate::validity::{
    AcceptanceLimits, COMMON_STANDARD_ERRORS_WITHIN, STANDARD_ERRORS_WITHIN, Validity, Violation,
};

/// Limits for the lines of one record.
pub(crate) struct Acceptance {
    pub(super) limits: AcceptanceLimits,
    pub(super) degrees_of_freedom: Option<f64>,
    pub(super) own_degrees_of_freedom: Option<f64>,
    /// Number of standard errors that make up the possible random error.
    factor: f64,
}

impl Acceptance {
    /// Creates the limits for variances with `degrees_of_freedom`; `None` if the variances are
    /// known.
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

    /// Creates the limits for one line whose variance has the given `freedom`; `None` if the
    /// variance is known.
    pub(crate) fn of_line(
        limits: AcceptanceLimits,
        freedom: Option<VarianceFreedom>,
    ) -> Result<Self, CmodError> {
        Ok(Self {
            own_degrees_of_freedom: freedom.map(|freedom| freedom.own),
            ..Self::new(limits, freedom.map(|freedom| freedom.line))?
        })
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
            // the bound is not a standard error: it is added to the possible random error
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

    /// Returns the violation of the limit of the loss factor, if the random error of `line` is too
    /// large for a loss factor of `mean`.
    fn by_neighbours(&self, line: &ModulusLine, mean: f64) -> Option<Violation> {
        let limit = self.limits.loss_factor;
        let error = self.factor * line.random_error().loss_factor / mean.abs();
        (error > limit).then_some(Violation::LossWithinNoise { error, limit })
    }

    /// Returns the violation of the coherence limit, if `coherence` is below it.
    pub(crate) fn incoherent(&self, coherence: f64) -> Option<Violation> {
        (coherence < self.limits.coherence).then_some(Violation::CoherenceTooLow {
            coherence,
            limit: self.limits.coherence,
        })
    }
}

/// Number of lines on either side whose loss factors are compared with that of a line.
const NEIGHBOURS: usize = 8;

impl ModulusEstimate {
    /// Returns the estimate in which the random error of the loss factor is also compared with the
    /// mean loss factor of the eight lines on either side.
    ///
    /// The relative error of a line is computed with the loss factor of that line, which contains
    /// noise. If the error of all lines is above the limit, only the few lines whose loss factor is
    /// increased most by noise would be valid, and these loss factors would be far too large.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for degrees of freedom of a line that are not positive.
    pub fn judged_by_neighbours(&self) -> Result<Self, CmodError> {
        let lines = self.lines();
        let mut places = 0..lines.len();
        self.revised(Refusal::Undetermined, |line, acceptance| {
            let index = places.next()?;
            let mut judged = line.clone();
            if !line.validity.is_valid() {
                return Some(judged);
            }
            let around = index.saturating_sub(NEIGHBOURS)..lines.len().min(index + NEIGHBOURS + 1);
            let others = around.filter(|other| *other != index);
            let mut sums = (0.0, 0.0);
            for other in others.filter_map(|other| lines.get(other)) {
                let variance = other.random_error().loss_factor.powi(2);
                if variance > 0.0 && variance.is_finite() {
                    sums.0 += other.loss_factor / variance;
                    sums.1 += 1.0 / variance;
                }
            }
            if sums.1 > 0.0
                && let Some(violation) = acceptance.by_neighbours(line, sums.0 / sums.1)
            {
                judged.validity = Validity::from_violations(vec![violation]);
            }
            Some(judged)
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
        // Student's distribution with 18 degrees of freedom has a one-sided tail of 2.87e-7 at
        // 7.59, according to the series of the tail
        let ten_averages = Acceptance::new(AcceptanceLimits::default(), Some(18.0)).unwrap();
        assert!(
            (ten_averages.factor - 7.6).abs() < 0.1,
            "{}",
            ten_averages.factor
        );
    }
}
