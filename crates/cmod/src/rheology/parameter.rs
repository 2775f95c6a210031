//! Parameter with its error, its interval and its identifiability.

use std::fmt;

use crate::estimate::ErrorSource;

/// Largest standard error, on the scale of the parameter, up to which the linearised interval is
/// used and the parameter counts as identified without further search. At a standard error of a
/// quarter of a natural logarithm, this interval and the interval from the profile differ by some
/// tenths of their width.
pub const LINEAR_BELOW: f64 = 0.25;

/// Widest interval of a parameter that counts as identified, on its scale: a factor of ten.
pub const WIDEST: f64 = std::f64::consts::LN_10;

/// Scale on which a parameter is fitted and its error is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scale {
    /// Natural logarithm, for any number above 0.
    Ratio,
    /// Log odds ln(α/(1 - α)), for an exponent between 0 and 1.
    LogOdds,
    /// The value itself.
    Difference,
}

impl Scale {
    /// Returns the value at a coordinate.
    #[must_use]
    pub fn value(self, coordinate: f64) -> f64 {
        match self {
            Self::Ratio => coordinate.exp(),
            Self::LogOdds => logistic(coordinate),
            Self::Difference => coordinate,
        }
    }

    /// Returns the coordinate of a value; the result is not finite for a value out of the range.
    #[must_use]
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::Ratio => value.ln(),
            Self::LogOdds => (value / (1.0 - value)).ln(),
            Self::Difference => value,
        }
    }
}

/// Returns the number between 0 and 1 whose log odds are the coordinate.
pub(super) fn logistic(coordinate: f64) -> f64 {
    (1.0 + (-coordinate).exp()).recip()
}

/// Parameter of a fitted law.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Name, such as `relaxation time 2`.
    pub name: String,
    /// SI unit; `1` for a dimensionless number.
    pub unit: &'static str,
    /// Value at the minimum.
    pub value: f64,
    /// Scale of the standard error.
    pub scale: Scale,
    /// Standard error on this scale, due to random and common errors together, from the linearised
    /// law; infinite if undetermined.
    pub standard_error: f64,
    /// Part of the error due to the random errors of the lines.
    pub random_error: f64,
    /// Part of the error due to the common errors of the lines.
    pub common_error: f64,
    /// Confidence interval at the level of the fit.
    pub interval: Interval,
    /// Identifiability by the data.
    pub verdict: Verdict,
}

/// Change of all parameters of a law due to one standard uncertainty of one common source.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CommonShift {
    /// Source of the error.
    pub source: ErrorSource,
    /// Changes of the parameters, in their order and on their scales.
    pub shift: Vec<f64>,
}

/// Confidence interval of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// Lower end, or the end of the range of the parameter if the data set no limit.
    pub lower: f64,
    /// Upper end, or the end of the range of the parameter if the data set no limit.
    pub upper: f64,
    /// Method by which the interval was determined.
    pub method: IntervalMethod,
}

impl Interval {
    /// Returns true if `value` lies within the interval.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }
}

/// Method by which an interval was determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum IntervalMethod {
    /// Linearised interval, from the standard error on the scale of the parameter.
    Linear,
    /// Profile of χ²: the parameter is held at a value, and all other parameters are fitted again.
    /// An end of the interval is where χ² has risen by the quantile of its distribution. Common
    /// errors are added in squares to both sides of the interval.
    Profile,
}

/// Identifiability of a parameter by the data.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The interval has two ends, no more than [`WIDEST`] apart.
    Identified,
    /// The interval has two ends that are farther apart.
    PoorlyDetermined(Reason),
    /// Only values above the upper end are excluded.
    BoundedAbove(Reason),
    /// Only values below the lower end are excluded.
    BoundedBelow(Reason),
    /// The data set no limit; the value is the point at which the iteration stopped, not a property
    /// of the material.
    NotIdentifiable(Reason),
}

impl Verdict {
    /// Returns true if the verdict is [`Verdict::Identified`].
    #[must_use]
    pub fn is_identified(&self) -> bool {
        matches!(self, Self::Identified)
    }

    /// Returns the reason why the parameter is not identified.
    #[must_use]
    pub fn reason(&self) -> Option<&Reason> {
        match self {
            Self::Identified => None,
            Self::PoorlyDetermined(reason)
            | Self::BoundedAbove(reason)
            | Self::BoundedBelow(reason)
            | Self::NotIdentifiable(reason) => Some(reason),
        }
    }
}

/// Reason why the data do not determine a parameter.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The relaxation takes place outside the band; only its flank is inside the band.
    #[error(
        "relaxation time {relaxation_time:.2e} s is outside the band, {shortest:.2e} to {longest:.2e} s"
    )]
    OutsideBand {
        /// Relaxation time τ \[s\].
        relaxation_time: f64,
        /// Value of 1/ω of the highest line \[s\].
        shortest: f64,
        /// Value of 1/ω of the lowest line \[s\].
        longest: f64,
    },
    /// Another parameter compensates for a change of this parameter.
    #[error("compensated by {with}, correlation {correlation:.3}")]
    Correlated {
        /// Name of the other parameter.
        with: String,
        /// Correlation coefficient of the errors of the two parameters.
        correlation: f64,
    },
    /// The influence of the parameter on the law is below the rounding error.
    #[error("the law does not depend on this parameter here")]
    NoInfluence,
    /// The errors of the data are too large.
    #[error("the errors of the data leave {}", left_by(*.standard_error))]
    Noise {
        /// Standard error on the scale of the parameter.
        standard_error: f64,
    },
}

/// Largest standard error that a message states; usually that of a logarithm.
const MOST_STATED: f64 = 10.0;

/// Returns the consequence of the errors of the data for a parameter, as a part of a message.
fn left_by(standard_error: f64) -> String {
    if standard_error <= MOST_STATED {
        format!("a standard error of {standard_error:.2}")
    } else {
        "this parameter undetermined".to_owned()
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Identified => f.write_str("identified"),
            Self::PoorlyDetermined(reason) => write!(f, "poorly determined: {reason}"),
            Self::BoundedAbove(reason) => write!(f, "bounded above only: {reason}"),
            Self::BoundedBelow(reason) => write!(f, "bounded below only: {reason}"),
            Self::NotIdentifiable(reason) => write!(f, "not identifiable: {reason}"),
        }
    }
}
