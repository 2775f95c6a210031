//! Degrees of freedom of an estimated variance.

use crate::LabioError;
use crate::error::non_physical;

/// Degrees of freedom of the estimated variance of one line.
///
/// A variance from n averages has 2(n - 1) degrees of freedom, a variance from noise measured in K
/// segments has 2K. A line and its neighbours may share an estimate that was pooled over them:
/// `line` is then the number for the pooled estimate, and `own` the contribution of the line
/// itself. The sum of `own` over several lines is the number of degrees of freedom of these lines
/// together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DegreesOfFreedom {
    /// ν of the variance of the line: its relative standard error is √(2/ν).
    pub line: f64,
    /// Contribution of the line to the degrees of freedom of all lines; at most `line`.
    pub own: f64,
}

impl DegreesOfFreedom {
    /// Returns the degrees of freedom of a variance from n = `averages` averages of this line
    /// alone: 2(n - 1).
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for fewer than 2 averages.
    pub fn of_averages(averages: f64) -> Result<Self, LabioError> {
        let line = 2.0 * (check_averages(averages)? - 1.0);
        Ok(Self { line, own: line })
    }
}

/// Accepts a number of averages that is large enough for a coherence.
pub(super) fn check_averages(averages: f64) -> Result<f64, LabioError> {
    if averages.is_finite() && averages >= 2.0 {
        Ok(averages)
    } else {
        non_physical(
            "number of averages",
            averages,
            "at least 2: the coherence of a single average is always 1",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_give_degrees_of_freedom() {
        let of_three = DegreesOfFreedom {
            line: 4.0,
            own: 4.0,
        };
        assert_eq!(DegreesOfFreedom::of_averages(3.0).unwrap(), of_three);
        assert!(DegreesOfFreedom::of_averages(1.5).is_err());
        assert!(DegreesOfFreedom::of_averages(f64::NAN).is_err());
    }
}
