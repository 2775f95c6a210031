//! Accuracy of an estimated variance.

use crate::error::{CmodError, check_positive, check_that};

/// Degrees of freedom of the estimated variance of one line.
///
/// A variance from n averages has 2(n - 1) degrees of freedom, a variance from noise measured in K
/// segments has 2K. A line and its neighbours may share a pooled estimate: `line` is then the
/// number of degrees of freedom of the pooled estimate, and `own` the contribution of the line
/// itself. The sum of `own` over some lines is the number of degrees of freedom of these lines
/// together.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VarianceFreedom {
    /// Degrees of freedom ν of the variance of the line. The relative standard error of the
    /// variance is √(2/ν).
    pub line: f64,
    /// Contribution of the line to the degrees of freedom of all lines; at most `line`.
    pub own: f64,
}

impl VarianceFreedom {
    /// Creates the degrees of freedom of a `line`, with the `own` contribution of the line to the
    /// degrees of freedom of all lines.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless both are finite and above 0, and `own` is at most `line`.
    pub fn new(line: f64, own: f64) -> Result<Self, CmodError> {
        Self { line, own }.check()
    }

    /// Returns the degrees of freedom of a variance from n = `averages` averages of one line alone:
    /// 2(n - 1).
    ///
    /// # Errors
    /// [`CmodError::TooFewAverages`] for fewer than 2 averages.
    pub fn of_averages(averages: f64) -> Result<Self, CmodError> {
        if !(averages.is_finite() && averages >= 2.0) {
            return Err(CmodError::TooFewAverages { found: averages });
        }
        let line = 2.0 * (averages - 1.0);
        Ok(Self { line, own: line })
    }

    pub(crate) fn check(self) -> Result<Self, CmodError> {
        check_positive("degrees of freedom of a variance", self.line)?;
        const OWN: &str = "degrees of freedom that a line adds";
        check_positive(OWN, self.own)?;
        let expected = "at most those of its variance";
        check_that(self.own <= self.line, OWN, self.own, expected)?;
        Ok(self)
    }

    /// Returns the degrees of freedom of the sum Σ vᵢ of independent estimates, each with the
    /// degrees of freedom `self` (Welch and Satterthwaite).
    pub(crate) fn of_sum(self, parts: impl Iterator<Item = f64> + Clone) -> Self {
        let sum: f64 = parts.clone().sum();
        let squares: f64 = parts.map(|part| part * part).sum();
        let gain = sum * sum / squares;
        // a single non-zero part keeps its degrees of freedom
        let gain = if gain >= 1.0 { gain } else { 1.0 };
        Self {
            line: self.line * gain,
            own: self.own * gain,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r14_degrees_of_freedom_of_sums_are_those_of_welch_and_satterthwaite() {
        let one = VarianceFreedom::new(8.0, 2.0).unwrap();
        // the degrees of freedom of equal parts add up; a single part keeps its own
        let four = one.of_sum([3.0; 4].into_iter());
        assert_eq!(four, VarianceFreedom::new(32.0, 8.0).unwrap());
        assert_eq!(one.of_sum([3.0, 0.0].into_iter()), one);
        // three averages give 2(3 - 1) degrees of freedom
        let of_three = VarianceFreedom::new(4.0, 4.0).unwrap();
        assert_eq!(VarianceFreedom::of_averages(3.0).unwrap(), of_three);
        assert!(VarianceFreedom::of_averages(1.5).is_err());
        assert!(VarianceFreedom::new(2.0, 3.0).is_err());
        assert!(VarianceFreedom::new(f64::NAN, 1.0).is_err());
    }
}
