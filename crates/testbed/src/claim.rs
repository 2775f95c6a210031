//! Claims: a number known from another source, the computed number, and the verdict. Integration
//! tests assert the claims; `cargo xtask validate` collects their rows in docs/validation.md.

use std::error::Error;
use std::path::Path;
use std::{io, iter};

use serde::{Deserialize, Deserializer, Serialize};

use crate::generated::write_whole;

/// Environment variable that names the folder for the rows of claims.
pub const FOLDER: &str = "RODLAB_CLAIMS";

/// Text of a claim. Without the alias, the derived `Deserialize` would borrow the text from its
/// input.
pub type Words = &'static str;

/// Number known from a source other than the program, with a tolerance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Claim {
    /// Description without the number. No two claims of a crate have the same description: crate
    /// and description identify the claim.
    pub what: String,
    /// Source: an equation, a table, a closed form, other software, a record, a conservation law.
    #[serde(deserialize_with = "kept")]
    pub source: Words,
    #[serde(deserialize_with = "kept")]
    pub unit: Words,
    pub expected: f64,
    pub tolerance: f64,
    /// Origin of the tolerance.
    #[serde(deserialize_with = "kept")]
    pub tolerance_from: Words,
}

impl Claim {
    /// Creates a claim that expects zero exactly, until another value is set.
    pub fn new(what: impl Into<String>, source: &'static str) -> Self {
        Self {
            what: what.into(),
            source,
            unit: "1",
            expected: 0.0,
            tolerance: 0.0,
            tolerance_from: "exact",
        }
    }

    pub fn expects(mut self, expected: f64, unit: &'static str) -> Self {
        self.expected = expected;
        self.unit = unit;
        self
    }

    pub fn within(mut self, tolerance: f64, because: &'static str) -> Self {
        self.tolerance = tolerance;
        self.tolerance_from = because;
        self
    }

    /// Sets the tolerance as a fraction of the expected value, which must be set before.
    pub fn within_part(self, part: f64, because: &'static str) -> Self {
        let tolerance = part * self.expected.abs();
        self.within(tolerance, because)
    }
}

/// Reason why there is no computed number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotMeasured {
    /// The record does not exist.
    Absent(String),
    /// All data exist, but the software could not compute the number.
    Refused(String),
}

/// Input of a claim, or an error of any crate.
pub type Fallible<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Reads a text of a row and keeps it in memory until the task ends.
fn kept<'de, D: Deserializer<'de>>(words: D) -> Result<&'static str, D::Error> {
    String::deserialize(words).map(|words| &*words.leak())
}

/// Computed number.
pub type Found = Fallible<f64>;

/// Computed number, or the reason why there is none.
pub type Ours<T = f64> = Result<T, NotMeasured>;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    Pass,
    Fail,
    Skipped,
}

/// Claim with its verdict.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Check {
    #[serde(flatten)]
    pub claim: Claim,
    pub ours: Option<f64>,
    pub tolerance_used: Option<f64>,
    pub verdict: Verdict,
    pub reason: Option<String>,
}

/// Computed number without an expected value.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Observation {
    pub what: String,
    #[serde(deserialize_with = "kept")]
    pub unit: Words,
    pub ours: f64,
}

/// Allowed difference from the expected number, with its reason.
#[derive(Debug, Clone, Copy)]
pub struct Within(pub f64, pub &'static str);

/// Claims of one topic, in the order in which they are made.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Claims {
    #[serde(skip)]
    pub source: &'static str,
    pub checks: Vec<Check>,
    pub observations: Vec<Observation>,
}

impl Claims {
    /// Sets the source of the claims that follow: an equation, a table or a law.
    pub fn by(&mut self, source: &'static str) -> &mut Self {
        self.source = source;
        self
    }

    /// Adds the claim that `what` equals `expected`, in `unit`.
    pub fn claim(
        &mut self,
        what: impl Into<String>,
        unit: &'static str,
        expected: f64,
        within: Within,
        ours: Ours,
    ) {
        let claim = Claim::new(what, self.source)
            .expects(expected, unit)
            .within(within.0, within.1);
        self.checks.push(Check::of(claim, ours));
    }

    /// Adds the claim that a relative deviation is zero.
    pub fn deviation(&mut self, what: impl Into<String>, within: Within, ours: Ours) {
        self.claim(what, "1", 0.0, within, ours);
    }

    /// Adds a claim and the result of `ours`; if `ours` returns an error, the claim fails.
    pub fn check(&mut self, claim: Claim, ours: impl FnOnce() -> Found) {
        let ours = ours().map_err(|error| refused(error.as_ref()));
        self.checks.push(Check::of(claim, ours));
    }

    /// Adds the claims of another topic.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        self.checks.extend(other.checks);
        self.observations.extend(other.observations);
        self
    }

    pub fn count(&self, verdict: Verdict) -> usize {
        self.checks.iter().filter(|c| c.verdict == verdict).count()
    }

    /// Asserts every claim. Before that, if the variable `RODLAB_CLAIMS` names a folder, the rows
    /// of the claims are written to `section/topic.json` in it. A claim whose record is missing is
    /// skipped with a message. The macro [`hold!`](crate::hold) provides section and topic.
    ///
    /// # Panics
    ///
    /// If a claim fails (the message names all that fail), or if the rows cannot be written.
    #[allow(
        clippy::panic,
        clippy::print_stderr,
        reason = "the assertion of a test, and a skipped test prints a note"
    )]
    pub fn hold(&self, section: &str, topic: &str) {
        if let Some(folder) = std::env::var_os(FOLDER) {
            let file = format!("{}.json", topic.replace("::", "-"));
            let path = Path::new(&folder).join(section).join(file);
            let written = serde_json::to_string_pretty(self)
                .map_err(io::Error::from)
                .and_then(|text| write_whole(&path, &text).map_err(io::Error::other));
            if let Err(error) = written {
                panic!("{}: {error}", path.display());
            }
        }
        let mut failed = Vec::new();
        for Check {
            claim,
            ours,
            verdict,
            reason,
            ..
        } in &self.checks
        {
            let reason = reason.as_deref().unwrap_or_default();
            match verdict {
                Verdict::Pass => {}
                Verdict::Skipped => eprintln!("skipped: {}: {reason}", claim.what),
                Verdict::Fail => failed.push(format!(
                    "{}: expected {}, ours {ours:?}, tolerance {} ({}) {reason}",
                    claim.what, claim.expected, claim.tolerance, claim.tolerance_from
                )),
            }
        }
        assert!(
            failed.is_empty(),
            "{} of {} claims failed:\n{}",
            failed.len(),
            self.checks.len(),
            failed.join("\n")
        );
    }
}

/// Asserts the claims of a module and writes their rows for the page of claims.
#[macro_export]
macro_rules! hold {
    ($claims:expr) => {
        $crate::hold!($claims, env!("CARGO_PKG_NAME"))
    };
    ($claims:expr, $section:expr) => {
        $claims.hold($section, module_path!())
    };
}

/// Returns `number` of the value in `found`, or the reason why it is missing.
pub fn of<T>(found: &Ours<T>, number: impl FnOnce(&T) -> f64) -> Ours {
    found.as_ref().map(number).map_err(Clone::clone)
}

/// Converts an error of a library to the reason why a number is missing.
impl<E: Error> From<E> for NotMeasured {
    fn from(error: E) -> Self {
        refused(&error)
    }
}

/// Returns the reason that `what`, an input of a claim, is missing.
pub fn missing(what: &str) -> NotMeasured {
    NotMeasured::Refused(format!("{what} is missing"))
}

impl Check {
    pub fn of(claim: Claim, ours: Result<f64, NotMeasured>) -> Self {
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

/// Returns the fraction of the tolerance that a difference uses; 0 for a difference of zero, even
/// if the tolerance is zero.
fn part(difference: f64, tolerance: f64) -> f64 {
    let difference = difference.abs();
    if difference > 0.0 || difference.is_nan() {
        difference / tolerance
    } else {
        0.0
    }
}

/// Returns true if the cause of `error`, at any depth, is a file that does not exist.
pub fn is_absent(error: &(dyn Error + 'static)) -> bool {
    let mut causes = iter::successors(Some(error), |&error| error.source());
    causes.any(|cause| {
        let cause = cause.downcast_ref::<io::Error>();
        cause.is_some_and(|io| io.kind() == io::ErrorKind::NotFound)
    })
}

/// Returns the reason why the record at `path` was not read.
pub fn unread(path: &Path, error: &(dyn Error + 'static)) -> NotMeasured {
    if is_absent(error) {
        NotMeasured::Absent(format!("{} does not exist", path.display()))
    } else {
        refused(error)
    }
}

/// Returns an error together with its causes, as one line.
pub fn refused(error: &dyn Error) -> NotMeasured {
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
        let mut report = Claims::default();
        report.check(claim(), || Err("the ruler broke".into()));
        assert_eq!(report.count(Verdict::Fail), 1);
        assert_eq!(report.checks[0].reason.as_deref(), Some("the ruler broke"));
    }

    #[test]
    fn what_a_library_refuses_is_a_claim_that_failed_with_the_reason() {
        let found = || -> Ours<[f64; 2]> {
            let first: f64 = "2.5".parse()?;
            let second: f64 = "two and a half".parse()?;
            Ok([first, second])
        };
        let found = found();
        let mut claims = Claims::default();
        claims.by("a ruler");
        claims.claim("length", "m", 2.5, Within(0.1, "its scale"), Ok(2.55));
        claims.deviation("width", Within(0.1, "its scale"), of(&found, |f| f[1]));
        let checks = claims.checks;
        assert_eq!(checks[0].verdict, Verdict::Pass);
        assert_eq!(checks[0].claim.source, "a ruler");
        assert_eq!(checks[1].verdict, Verdict::Fail);
        assert_eq!(checks[1].reason.as_deref(), Some("invalid float literal"));
    }
}
