//! Checks of a record and of a modulus that need no reference.
//!
//! Every correct record or modulus fulfils certain conditions, whatever the material. Each check
//! measures the violation of one condition and computes the p-value: the probability that noise
//! alone, at the level found in the data, causes at least as large a violation. The check fails if
//! the p-value is below the chosen level. No threshold is set by hand.
//!
//! | check | condition | causes of a violation |
//! |---|---|---|
//! | [`FreeEndNull`] | no force at the free end except that of its mass, according to three or more sections | wrong position, polarity, calibration or delay of a sensor; bending; a support that holds the rod |
//! | [`Arrivals::causality`] | no signal before the fastest wave can arrive | a channel that is early; a non-causal filter |
//! | [`Arrivals::polarity`] | the first wave has the same sign in all channels | a sensor that is connected the wrong way round |
//! | [`passivity`] | E'' >= 0 | kernel of the transform with the other sign, a delay between channels, a wrong boundary condition |
//! | [`relaxation`] | a modulus over time does not rise | compliance and modulus interchanged, drift of the force or of the displacement, ageing |
//! | [`kramers_kronig`] | E' and E'' belong to one relaxing material | anything that distorts the modulus over frequency |
//!
//! A correct record fails a check with at most the probability given by the level. A passed check
//! only states that a possible error is below the noise: its
//! [noise floor](CheckOutcome::noise_floor) gives the amount. The level applies to each check
//! separately: if a correct record undergoes k checks at the level p, at least one fails by chance
//! with a probability of up to 1 - (1 - p)^k, at most kp.
//!
//! If the noise was estimated from few hits or from a short quiet part of the record, every check
//! takes the degrees of freedom of this estimate into account: Fisher's and Student's distributions
//! replace chi-square and the normal distribution.
//!
//! Theory: `docs/theory/checks-without-truth.md`.

mod arrivals;
mod free_end_null;
mod kramers_kronig;
mod passivity;
mod relaxation;

pub use arrivals::{Arrivals, Channel};
pub use free_end_null::FreeEndNull;
pub use kramers_kronig::{kramers_kronig, kramers_kronig_on};
pub use passivity::passivity;
pub use relaxation::relaxation;

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use crate::error::{CmodError, check_that};

/// Default probability of a false alarm.
pub const USUAL_LEVEL: f64 = 0.01;

/// Condition that is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Check {
    /// No force at the free end except that of its mass.
    FreeEndNull,
    /// No signal before the fastest wave can arrive.
    Causality,
    /// The first wave has the same sign in all channels.
    Polarity,
    /// E'' >= 0.
    Passivity,
    /// A modulus over time does not rise.
    Relaxation,
    /// E' and E'' belong to one relaxing material.
    KramersKronig,
}

impl fmt::Display for Check {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::FreeEndNull => "free-end null",
            Self::Causality => "causality",
            Self::Polarity => "polarity",
            Self::Passivity => "passivity",
            Self::Relaxation => "relaxation",
            Self::KramersKronig => "Kramers-Kronig",
        })
    }
}

/// Verdict of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CheckVerdict {
    /// The statistic is consistent with noise alone.
    Passed,
    /// Noise alone gives a statistic at least as extreme with a probability below the level.
    Failed,
    /// The signal is below the noise, or a bound was not reached: no statement is possible.
    Undecided,
}

/// Outcome of one check.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CheckOutcome {
    /// Condition that was checked.
    pub check: Check,
    /// Measure of the violation, as defined by the check.
    pub statistic: f64,
    /// Average statistic of noise alone.
    pub noise_floor: f64,
    /// Probability that noise alone gives a statistic at least as extreme. For [`kramers_kronig`],
    /// [`passivity`] and [`relaxation`] it is an upper bound.
    pub p_value: f64,
    /// Chosen probability of a false alarm.
    pub level: f64,
    /// Place of the largest violation: the position of a line in the measured arrays, or a
    /// channel, from 0.
    pub worst: Option<usize>,
    /// Verdict at this level.
    pub verdict: CheckVerdict,
}

impl CheckOutcome {
    /// Judges the check by its p-value.
    fn judged(
        check: Check,
        (statistic, noise_floor): (f64, f64),
        p_value: f64,
        level: f64,
    ) -> Self {
        Self {
            check,
            statistic,
            noise_floor,
            p_value,
            level,
            worst: None,
            verdict: if p_value < level {
                CheckVerdict::Failed
            } else {
                CheckVerdict::Passed
            },
        }
    }

    fn at(self, worst: Option<usize>) -> Self {
        Self { worst, ..self }
    }

    fn undecided_if(mut self, is_open: bool) -> Self {
        if is_open {
            self.verdict = CheckVerdict::Undecided;
        }
        self
    }

    /// Returns true if the record, or the modulus, violates the condition.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.verdict == CheckVerdict::Failed
    }
}

impl fmt::Display for CheckOutcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match self.verdict {
            CheckVerdict::Passed => "passed",
            CheckVerdict::Failed => "failed",
            CheckVerdict::Undecided => "undecided",
        };
        write!(
            formatter,
            "{} {verdict}: {:.3e}, noise alone {:.3e}, p = {:.1e} at level {:.1e}",
            self.check, self.statistic, self.noise_floor, self.p_value, self.level
        )
    }
}

/// Accepts a probability between 0 and 1.
fn check_level(level: f64) -> Result<f64, CmodError> {
    let is_right = level > 0.0 && level < 1.0;
    let expected = "a probability between 0 and 1";
    check_that(is_right, "level of the check", level, expected)
}

/// Returns P(χ² > `value`) for the given degrees of freedom.
fn chi_square_tail(value: f64, degrees_of_freedom: f64) -> f64 {
    ChiSquared::new(degrees_of_freedom).map_or(f64::NAN, |law| law.sf(value.max(0.0)))
}

/// Returns P(F > `value`) for the quotient F of two mean squares.
fn fisher_tail(value: f64, numerator: f64, denominator: f64) -> f64 {
    FisherSnedecor::new(numerator, denominator).map_or(f64::NAN, |law| law.sf(value.max(0.0)))
}

/// Returns P(z < `value`) for a normal variable z of variance 1.
fn normal_tail_below(value: f64) -> f64 {
    Normal::standard().cdf(value)
}

/// Returns P(t < `value`) for a normal variable divided by the root of an estimate of its variance
/// with `degrees_of_freedom`; `None` stands for a known variance.
fn student_tail_below(value: f64, degrees_of_freedom: Option<f64>) -> f64 {
    degrees_of_freedom.map_or_else(
        || normal_tail_below(value),
        |freedom| match StudentsT::new(0.0, 1.0, freedom) {
            Ok(law) if !value.is_nan() => law.cdf(value),
            _ => f64::NAN,
        },
    )
}

/// Returns the probability that the smallest of `count` independent p-values is below `p_value`.
fn of_the_least(p_value: f64, count: usize) -> f64 {
    -(count as f64 * (-p_value).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_those_of_tables() {
        // quantiles from tables: 99.9 % of chi-square with 4 and 100 degrees of freedom, 95 % of
        // F(5, 10), 2.5 % of the normal distribution
        assert!((chi_square_tail(18.467, 4.0) - 1e-3).abs() < 1e-6);
        assert!((chi_square_tail(149.449, 100.0) - 1e-3).abs() < 1e-6);
        assert!((fisher_tail(3.3258, 5.0, 10.0) - 0.05).abs() < 1e-5);
        assert!((normal_tail_below(-1.959964) - 0.025).abs() < 1e-7);
        // quantile of 2.5 % of Student's distribution with 4 degrees of freedom
        assert!((student_tail_below(-2.776445, Some(4.0)) - 0.025).abs() < 1e-7);
        assert!((student_tail_below(-1.959964, None) - 0.025).abs() < 1e-7);
        // 1 - (1 - p)^n keeps its digits also for p far below the rounding error of 1
        assert!((of_the_least(0.1, 3) - 0.271).abs() < 1e-15);
        assert!((of_the_least(1e-20, 10) - 1e-19).abs() < 1e-33);
    }

    #[test]
    fn an_outcome_says_its_numbers() {
        let outcome = CheckOutcome::judged(Check::FreeEndNull, (5.5, 1.0), 3e-4, 0.01);
        assert!(outcome.has_failed());
        assert_eq!(
            outcome.to_string(),
            "free-end null failed: 5.500e0, noise alone 1.000e0, p = 3.0e-4 at level 1.0e-2"
        );
        assert_eq!(
            check_level(1.0).unwrap_err().to_string(),
            "level of the check is 1, expected a probability between 0 and 1"
        );
    }
}
