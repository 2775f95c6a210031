//! Degrees of freedom of an estimated variance.

use crate::LabioError;

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

    /// Returns the degrees of freedom of v + c, where v is an estimate with these degrees of
    /// freedom and c is known (Welch and Satterthwaite); unchanged if v is not above 0 or the
    /// result is not finite.
    #[must_use]
    pub fn with_known_part(self, variance: f64, known: f64) -> Self {
        let gain = (1.0 + known / variance).powi(2);
        if variance.is_nan() || variance <= 0.0 || !gain.is_finite() {
            return self;
        }
        Self {
            line: self.line * gain,
            own: self.own * gain,
        }
    }
}

/// Accepts a number of averages that is large enough for a coherence.
pub(super) fn check_averages(averages: f64) -> Result<f64, LabioError> {
    if averages.is_finite() && averages >= 2.0 {
        Ok(averages)
    } else {
        Err(LabioError::NonPhysical {
            quantity: "number of averages",
            value: averages,
            expected: "at least 2: the coherence of a single average is always 1",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_part_adds_degrees_of_freedom() {
        let one = DegreesOfFreedom {
            line: 8.0,
            own: 2.0,
        };
        let four = DegreesOfFreedom {
            line: 32.0,
            own: 8.0,
        };
        // half of the variance is known: the relative error of the sum is half as large
        assert_eq!(one.with_known_part(5.0, 5.0), four);
        for (variance, known) in [(0.0, 5.0), (f64::NAN, 5.0), (1.0, f64::NAN), (1e-300, 1e10)] {
            assert_eq!(one.with_known_part(variance, known), one);
        }
        let of_three = DegreesOfFreedom {
            line: 4.0,
            own: 4.0,
        };
        assert_eq!(DegreesOfFreedom::of_averages(3.0).unwrap(), of_three);
        assert!(DegreesOfFreedom::of_averages(1.5).is_err());
        assert!(DegreesOfFreedom::of_averages(f64::NAN).is_err());
    }
}
