//! A parameter with its error, its interval and what the data say of it.

use std::fmt;

use crate::estimate::ErrorSource;

/// Largest standard error, on the scale of the parameter, up to which the linearised interval is believed and the parameter
/// counts as identified without further search. At a quarter of a natural logarithm the two intervals differ by some tenths of
/// their width.
pub const LINEAR_BELOW: f64 = 0.25;

/// Widest interval of a parameter that counts as identified, on its scale: a factor of ten.
pub const WIDEST: f64 = std::f64::consts::LN_10;

/// The scale on which a parameter is fitted and its error is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scale {
    /// The natural logarithm, of what can be any number above 0.
    Ratio,
    /// ln(α/(1 - α)), of an exponent between 0 and 1.
    LogOdds,
    /// The value itself.
    Difference,
}

impl Scale {
    /// The value at a coordinate.
    #[must_use]
    pub fn value(self, coordinate: f64) -> f64 {
        match self {
            Self::Ratio => coordinate.exp(),
            Self::LogOdds => super::model::logistic(coordinate),
            Self::Difference => coordinate,
        }
    }
}

/// A parameter of a fitted law.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// What it is, as `relaxation time 2`.
    pub name: String,
    /// Its SI unit; 1 for a number.
    pub unit: &'static str,
    /// The value at the minimum.
    pub value: f64,
    /// The scale of the standard error.
    pub scale: Scale,
    /// Standard error on the scale by random and common errors together, from the linearised law; infinite if the data leave it
    /// open.
    pub standard_error: f64,
    /// Its part by the random errors of the lines.
    pub random_error: f64,
    /// Its part by the errors that the lines share.
    pub common_error: f64,
    /// Confidence interval at the level of the fit.
    pub interval: Interval,
    /// Whether the data determine it.
    pub verdict: Verdict,
}

/// Change of all parameters of a law by one standard uncertainty of one common source.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CommonShift {
    /// The source.
    pub source: ErrorSource,
    /// The changes, in the order of the parameters and on their scales.
    pub shift: Vec<f64>,
}

/// A confidence interval of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// Lower end; the end of the range of the parameter where the data set none.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// How it was found.
    pub method: IntervalMethod,
}

impl Interval {
    /// Whether `value` lies within.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }
}

/// How an interval was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum IntervalMethod {
    /// From the standard error on the scale of the parameter.
    Linear,
    /// From the profile of χ²: the parameter is held at a value, all others are fitted anew, and the end is where χ² has risen by
    /// the quantile of its distribution. Common errors widen it on both sides, in squares.
    Profile,
}

/// Whether the data determine a parameter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The interval has two ends, no more than [`WIDEST`] apart.
    Identified,
    /// It has two ends that are farther apart.
    PoorlyDetermined(Reason),
    /// Only values above the upper end are excluded.
    BoundedAbove(Reason),
    /// Only values below the lower end are excluded.
    BoundedBelow(Reason),
    /// The data set no end; the value is where the iteration stopped, not a property of the material.
    NotIdentifiable(Reason),
}

impl Verdict {
    /// Whether it is [`Verdict::Identified`].
    #[must_use]
    pub fn is_identified(&self) -> bool {
        matches!(self, Self::Identified)
    }

    /// Why it is not identified.
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

/// Why the data do not determine a parameter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// The relaxation takes place outside of the band; inside, its flank alone is seen.
    OutsideBand {
        /// Its relaxation time τ \[s\].
        relaxation_time: f64,
        /// 1/ω of the highest line \[s\].
        shortest: f64,
        /// 1/ω of the lowest line \[s\].
        longest: f64,
    },
    /// Another parameter makes up for a change of this one.
    Correlated {
        /// Its name.
        with: String,
        /// The coefficient of correlation of their errors.
        correlation: f64,
    },
    /// The law depends on it less than rounding shows.
    NoInfluence,
    /// The errors of the data are too large.
    Noise {
        /// Standard error on the scale of the parameter.
        standard_error: f64,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutsideBand {
                relaxation_time,
                shortest,
                longest,
            } => write!(
                f,
                "relaxation time {relaxation_time:.2e} s lies outside of the band, {shortest:.2e} to {longest:.2e} s"
            ),
            Self::Correlated { with, correlation } => {
                write!(f, "made up for by {with}, correlation {correlation:.3}")
            }
            Self::NoInfluence => f.write_str("the law does not depend on it here"),
            Self::Noise { standard_error } => write!(
                f,
                "the errors of the data leave a standard error of {standard_error:.2}"
            ),
        }
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
