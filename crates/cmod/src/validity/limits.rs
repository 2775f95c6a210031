//! Limits of a line in addition to the conditions of the paper: errors, amplification, coherence.

use crate::error::{CmodError, check_that};

/// Default of [`AcceptanceLimits::storage_modulus`]: 1 % of E'.
pub const GREATEST_STORAGE_MODULUS_ERROR: f64 = 0.01;

/// Default of [`AcceptanceLimits::loss_factor`]: 5 % of the loss factor.
pub const GREATEST_LOSS_FACTOR_ERROR: f64 = 0.05;

/// Number of standard errors that must be within the accepted error of E' and of the loss factor.
/// If five standard errors of a line are equal to the accepted error, its error is beyond the
/// accepted error with a probability of 1 in 1.7 million, which in practice does not occur in a
/// record.
pub const STANDARD_ERRORS_WITHIN: f64 = 5.0;

/// Default of [`AcceptanceLimits::error_amplification`]. No calibration of a pair of sensors
/// excludes an error of 0.1 % in the ratio. Amplified ten times, this error is 1 % of the modulus,
/// which is the whole accepted error of E'.
pub const GREATEST_ERROR_AMPLIFICATION: f64 = 10.0;

/// Maximum ratio of the second order of an error to its standard error. At 0.1 the second order is
/// a bias of a tenth of σ, and the bounds of 1σ and 2σ remain meaningful.
pub const GREATEST_SECOND_ORDER: f64 = 0.1;

/// Default of [`AcceptanceLimits::greatest_poisson_ratio`]: the value of an incompressible
/// material, which is the maximum for an isotropic material.
pub const GREATEST_POISSON_RATIO: f64 = 0.5;

/// Number of standard errors of the common sources for
/// [`AcceptanceLimits::common_storage_modulus`]: about 95 %.
pub const COMMON_STANDARD_ERRORS_WITHIN: f64 = 2.0;

/// Error limits that a valid line must meet. The limits of a method are part of its settings.
///
/// The conditions (i)-(iii) of paper A concern the physics of a line and not the size of its error.
/// These limits concern the errors that differ from line to line and between methods: the random
/// error, and the lateral inertia that the theory of the waves leaves in the modulus. With the
/// defaults, the errors of a valid line due to noise and theory are within 1 % of E' and within 5 %
/// of the loss factor.
///
/// A common error, for example of the length, the density or the mass of the accelerometer, affects
/// all lines and therefore makes no line invalid. It is stated next to the random error
/// ([`ModulusLine::systematic_error`](crate::ModulusLine::systematic_error)) and is part of the
/// standard error. `common_storage_modulus` can also limit this error.
///
/// A limit that is infinite (0 for the coherence) is not checked.
///
/// ```
/// use cmod::validity::AcceptanceLimits;
///
/// // a material of low loss, whose loss factor need only be accurate to 20 %
/// let limits = AcceptanceLimits { loss_factor: 0.2, ..AcceptanceLimits::default() };
/// assert_eq!(limits.storage_modulus, 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceptanceLimits {
    /// Largest relative error of E' due to noise and to the theory of the waves:
    /// [`STANDARD_ERRORS_WITHIN`] standard errors of the random part, and the
    /// [bound](crate::estimate::Uncertainty::lateral_inertia_bound) on lateral inertia that was not
    /// removed. If the variance was estimated from few averages, the number of standard errors of
    /// the random part is increased to give the same probability by Student's distribution; it is
    /// 7.6 for ten averages.
    pub storage_modulus: f64,
    /// Largest relative error of E''/E', with the same number of standard errors.
    pub loss_factor: f64,
    /// Largest relative error of E' due to all common sources together, as
    /// [`COMMON_STANDARD_ERRORS_WITHIN`] standard errors. Infinite by default.
    pub common_storage_modulus: f64,
    /// Largest Poisson's ratio ν that the material may have, from 0 to 0.5. One-dimensional theory
    /// makes E' too small by up to the fraction (πνD/λ)²/2: with 0.5, the default, this is 1 % at λ
    /// = 11 D. If ν is known, [`LateralInertia`](crate::LateralInertia) removes this error. Set 0
    /// for waves without lateral inertia, as in one-dimensional simulations.
    pub greatest_poisson_ratio: f64,
    /// Largest |dE/E| divided by |dΨ/Ψ|.
    pub error_amplification: f64,
    /// Smallest ordinary coherence, if a coherence is known.
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
    /// Default limits for waves without lateral inertia: simulated waves, or the waves of a rod
    /// whose Poisson's ratio is 0.
    pub const ONE_DIMENSIONAL: Self = Self {
        storage_modulus: GREATEST_STORAGE_MODULUS_ERROR,
        loss_factor: GREATEST_LOSS_FACTOR_ERROR,
        common_storage_modulus: f64::INFINITY,
        greatest_poisson_ratio: 0.0,
        error_amplification: GREATEST_ERROR_AMPLIFICATION,
        coherence: 0.0,
    };

    /// No limits. Only the conditions of the paper and the reports of the solver are checked, and
    /// one-dimensional theory is treated as exact.
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
            let expected = "a value above 0, infinite for no limit";
            check_that(value > 0.0, quantity, value, expected)?;
        }
        let is_coherence = (0.0..=1.0).contains(&self.coherence);
        let expected = "a value from 0 to 1";
        check_that(is_coherence, "least coherence", self.coherence, expected)?;
        let ratio = self.greatest_poisson_ratio;
        let is_ratio = (0.0..=0.5).contains(&ratio);
        let expected = "a value from 0 to 0.5";
        check_that(is_ratio, "greatest Poisson's ratio", ratio, expected)?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_limits_are_refused() {
        let changed = |change: fn(&mut AcceptanceLimits)| {
            let mut limits = AcceptanceLimits::default();
            change(&mut limits);
            limits.check()
        };
        let text = |change: fn(&mut AcceptanceLimits)| changed(change).unwrap_err().to_string();
        assert_eq!(
            text(|limits| limits.storage_modulus = 0.0),
            "greatest error of E' is 0, expected a value above 0, infinite for no limit"
        );
        assert_eq!(
            text(|limits| limits.coherence = 1.5),
            "least coherence is 1.5, expected a value from 0 to 1"
        );
        assert_eq!(
            text(|limits| limits.greatest_poisson_ratio = 0.6),
            "greatest Poisson's ratio is 0.6, expected a value from 0 to 0.5"
        );
        assert!(changed(|limits| limits.error_amplification = f64::NAN).is_err());
        assert!(AcceptanceLimits::NONE.check().is_ok());
    }
}
