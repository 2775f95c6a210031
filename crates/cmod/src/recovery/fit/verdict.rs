//! Identifiability of the parameters by the tests, with reasons.

use std::fmt;

/// Standard error, of a logarithm or of the exponent, below which a parameter counts as identified.
/// For a logarithm, this means that the parameter is more than three times its standard error.
pub const IDENTIFIED_BELOW: f64 = 1.0 / 3.0;

/// Scale of the error of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Error of the natural logarithm.
    Ratio,
    /// Error of the value.
    Difference,
}

/// Reason why the tests do not determine a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// There is only one load. It gives two numbers, Δtan δᵢ and t_r, for three parameters.
    OneLoad,
    /// No reading is late enough to show a recovery: only Δtan δᵢ of each load is determined.
    RecoveryNotFollowed {
        /// The largest t/t_r of a reading.
        latest: f64,
    },
    /// All readings are so late that the loads are indistinguishable: only the product Δtan δᵢ t_r
    /// is determined, which is the same for all loads.
    OnlyTail {
        /// The smallest t/t_r of a reading.
        earliest: f64,
    },
    /// The loads differ and the readings cover the recovery, but their errors are too large.
    Noise {
        /// Largest of the standard errors of E₂, the rate k and m.
        standard_error: f64,
    },
}

/// Largest standard error of a logarithm that a message states; a larger one corresponds to a
/// factor without meaning.
const MOST_STATED: f64 = 10.0;

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneLoad => f.write_str(
                "one load determines only two numbers, but the model has three parameters",
            ),
            Self::RecoveryNotFollowed { latest } => write!(
                f,
                "the latest reading is at {latest:.2} of the recovery time, before the loss factor falls"
            ),
            Self::OnlyTail { earliest } => write!(
                f,
                "the earliest reading is at {earliest:.0} recovery times, where the curves of all loads coincide"
            ),
            Self::Noise { standard_error } if *standard_error <= MOST_STATED => write!(
                f,
                "the errors of the readings leave a standard error of {standard_error:.2} of ln E2, ln k or m"
            ),
            Self::Noise { .. } => {
                f.write_str("the errors of the readings do not determine E2, k and m separately")
            }
        }
    }
}

/// Identifiability of a parameter by the tests.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The standard error is below [`IDENTIFIED_BELOW`].
    Identified,
    /// The parameter follows from E₂, k and m, which are identified. This applies to B, the strain
    /// rate at 1 Pa. B is extrapolated over seven decades of stress, so its relative error may be
    /// large even if the rate at the loads is accurate.
    FollowsFromIdentified,
    /// The tests do not determine the parameter; its value is the point at which the iteration
    /// stopped, not a property of the material.
    NotIdentifiable(Reason),
    /// The parameter is given. No loss factor determines it: multiplying E₁ and E₂ by a factor and
    /// dividing B by the same factor leaves all predictions unchanged.
    Given,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Identified => f.write_str("identified"),
            Self::FollowsFromIdentified => {
                f.write_str("follows from E2, k and m, which are identified")
            }
            Self::NotIdentifiable(reason) => write!(f, "not identifiable: {reason}"),
            Self::Given => f.write_str("given"),
        }
    }
}

/// Parameter with its error and verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// Name of the quantity.
    pub name: &'static str,
    /// Symbol of the quantity.
    pub symbol: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Value in SI units.
    pub value: f64,
    /// Standard error of ln(value) or of the value, see `scale`; infinite if the tests do not
    /// determine the parameter.
    pub standard_error: f64,
    /// Scale of the error.
    pub scale: Scale,
    /// Identifiability by the tests.
    pub verdict: Verdict,
}
