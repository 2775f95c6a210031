//! A claim, what we find, and the verdict.

use std::error::Error;
use std::io;

use labio::LabioError;
use serde::Serialize;

/// A number that is known otherwise than by our computing it, with a tolerance.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Claim {
    /// In words, without the number. With the crate it names the claim: no two are alike.
    pub(crate) what: String,
    /// Who says so: an equation, a table, a closed form, other software, a record, a law of conservation.
    pub(crate) source: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) expected: f64,
    pub(crate) tolerance: f64,
    /// Where the tolerance comes from.
    pub(crate) tolerance_from: &'static str,
}

impl Claim {
    /// A claim that expects zero exactly, until it is told otherwise.
    pub(crate) fn new(what: impl Into<String>, source: &'static str) -> Self {
        Self {
            what: what.into(),
            source,
            unit: "1",
            expected: 0.0,
            tolerance: 0.0,
            tolerance_from: "exact",
        }
    }

    pub(crate) fn expects(mut self, expected: f64, unit: &'static str) -> Self {
        self.expected = expected;
        self.unit = unit;
        self
    }

    pub(crate) fn within(mut self, tolerance: f64, because: &'static str) -> Self {
        self.tolerance = tolerance;
        self.tolerance_from = because;
        self
    }

    /// The tolerance as a part of what is expected, which is called before.
    pub(crate) fn within_part(self, part: f64, because: &'static str) -> Self {
        let tolerance = part * self.expected.abs();
        self.within(tolerance, because)
    }
}

/// Why there is no number of ours.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) enum NotMeasured {
    /// The record is not there.
    Absent(String),
    /// Everything is there, but the software could not get the number out of it.
    Refused(String),
}

/// Something that a claim needs, or any error of a crate.
pub(crate) type Fallible<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// A number of ours.
pub(crate) type Found = Fallible<f64>;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Verdict {
    Pass,
    Fail,
    Skipped,
}

/// A claim with its verdict.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Check {
    #[serde(flatten)]
    pub(crate) claim: Claim,
    pub(crate) ours: Option<f64>,
    pub(crate) tolerance_used: Option<f64>,
    pub(crate) verdict: Verdict,
    pub(crate) reason: Option<String>,
}

/// A number that nobody has made a claim about.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Observation {
    pub(crate) what: String,
    pub(crate) unit: &'static str,
    pub(crate) ours: f64,
}

#[derive(Debug, Default, Serialize)]
pub(crate) struct Report {
    pub(crate) checks: Vec<Check>,
    pub(crate) observations: Vec<Observation>,
}

impl Report {
    /// Adds the checks of another topic.
    pub(crate) fn and(mut self, other: Self) -> Self {
        self.checks.extend(other.checks);
        self.observations.extend(other.observations);
        self
    }

    /// Adds a claim and what `ours` finds; an error is a claim that failed.
    pub(crate) fn check(&mut self, claim: Claim, ours: impl FnOnce() -> Found) {
        let ours = ours().map_err(|error| refused(error.as_ref()));
        self.checks.push(Check::of(claim, ours));
    }

    #[cfg(test)]
    pub(crate) fn count(&self, verdict: Verdict) -> usize {
        self.checks.iter().filter(|c| c.verdict == verdict).count()
    }
}

impl Check {
    pub(crate) fn of(claim: Claim, ours: Result<f64, NotMeasured>) -> Self {
        let (ours, reason, absent) = match ours {
            Ok(ours) => (Some(ours), None, false),
            Err(NotMeasured::Absent(reason)) => (None, Some(reason), true),
            Err(NotMeasured::Refused(reason)) => (None, Some(reason), false),
        };
        let tolerance_used = ours.map(|ours| part(ours - claim.expected, claim.tolerance));
        let verdict = match tolerance_used {
            _ if absent => Verdict::Skipped,
            Some(used) if used <= 1.0 => Verdict::Pass,
            _ => Verdict::Fail,
        };
        Self {
            claim,
            ours,
            tolerance_used,
            verdict,
            reason,
        }
    }
}

/// Part of the tolerance that a difference uses. No difference uses none of a tolerance of zero.
fn part(difference: f64, tolerance: f64) -> f64 {
    let difference = difference.abs();
    if difference > 0.0 || difference.is_nan() {
        difference / tolerance
    } else {
        0.0
    }
}

/// Whether a file is simply not there.
pub(crate) fn is_absent(error: &LabioError) -> bool {
    match error {
        LabioError::InFile { source, .. } => is_absent(source),
        LabioError::Read { source } => source.kind() == io::ErrorKind::NotFound,
        _ => false,
    }
}

/// An error with its causes in one line.
pub(crate) fn refused(error: &dyn Error) -> NotMeasured {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    NotMeasured::Refused(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim() -> Claim {
        Claim::new("length", "ruler")
            .expects(2.0, "m")
            .within(0.5, "its scale")
    }

    #[test]
    fn the_verdict_is_the_fraction_of_the_tolerance() {
        let verdict = |ours| Check::of(claim(), ours).verdict;
        assert_eq!(verdict(Ok(2.5)), Verdict::Pass);
        assert_eq!(verdict(Ok(1.49)), Verdict::Fail);
        assert_eq!(verdict(Ok(f64::NAN)), Verdict::Fail);
        let refused = NotMeasured::Refused("illegible".to_owned());
        assert_eq!(verdict(Err(refused)), Verdict::Fail);
        let absent = NotMeasured::Absent("lost".to_owned());
        assert_eq!(verdict(Err(absent)), Verdict::Skipped);
    }

    #[test]
    fn a_claim_without_tolerance_wants_the_number_itself() {
        let claim = Claim::new("items", "count").expects(3.0, "1");
        assert_eq!(Check::of(claim.clone(), Ok(3.0)).verdict, Verdict::Pass);
        assert_eq!(Check::of(claim, Ok(3.1)).verdict, Verdict::Fail);
    }

    #[test]
    fn an_error_is_a_claim_that_failed_with_its_causes() {
        let mut report = Report::default();
        report.check(claim(), || Err("the ruler broke".into()));
        assert_eq!(report.count(Verdict::Fail), 1);
        assert_eq!(report.checks[0].reason.as_deref(), Some("the ruler broke"));
    }
}
