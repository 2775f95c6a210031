//! A claim about a measured record, what we find, and the verdict.

use std::fmt::Write as _;
use std::io;

use labio::LabioError;
use serde::Serialize;

/// What is known of a record, as a number with a tolerance.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Claim {
    /// In words, without the number.
    pub(crate) what: String,
    /// Who says so.
    pub(crate) source: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) expected: f64,
    pub(crate) tolerance: f64,
    /// Where the tolerance comes from.
    pub(crate) tolerance_from: &'static str,
}

/// Why there is no number of ours.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) enum NotMeasured {
    /// The record is not there.
    Absent(String),
    /// The record is there, but the software could not get the number out of it.
    Refused(String),
}

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
    claim: Claim,
    ours: Option<f64>,
    tolerance_used: Option<f64>,
    verdict: Verdict,
    reason: Option<String>,
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
    /// Adds the checks of another record.
    pub(crate) fn and(mut self, other: Self) -> Self {
        self.checks.extend(other.checks);
        self.observations.extend(other.observations);
        self
    }
}

/// How many checks came out how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) total: usize,
    pub(crate) passed: usize,
    pub(crate) failed: usize,
    pub(crate) skipped: usize,
}

impl Check {
    pub(crate) fn of(claim: Claim, ours: Result<f64, NotMeasured>) -> Self {
        let (ours, reason, absent) = match ours {
            Ok(ours) => (Some(ours), None, false),
            Err(NotMeasured::Absent(reason)) => (None, Some(reason), true),
            Err(NotMeasured::Refused(reason)) => (None, Some(reason), false),
        };
        let tolerance_used = ours.map(|ours| (ours - claim.expected).abs() / claim.tolerance);
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

    /// The cells of the table, in the order of [`HEADINGS`].
    fn cells(&self) -> [String; 7] {
        let percent = |used: f64| format!("{:.0} %", 100.0 * used);
        let verdict = match (self.verdict, &self.reason) {
            (Verdict::Pass, _) => "pass".to_owned(),
            (Verdict::Fail, None) => "FAIL".to_owned(),
            (Verdict::Fail, Some(reason)) => format!("FAIL: {reason}"),
            (Verdict::Skipped, reason) => {
                format!("skipped: {}", reason.as_deref().unwrap_or("no record"))
            }
        };
        [
            self.claim.what.clone(),
            self.claim.unit.to_owned(),
            rounded(self.claim.expected),
            self.ours.map_or_else(|| "-".to_owned(), rounded),
            rounded(self.claim.tolerance),
            self.tolerance_used.map_or_else(|| "-".to_owned(), percent),
            verdict,
        ]
    }
}

const HEADINGS: [&str; 7] = [
    "claim",
    "unit",
    "expected",
    "ours",
    "tolerance",
    "used",
    "verdict",
];

impl Report {
    pub(crate) fn tally(&self) -> Tally {
        let count = |verdict| self.checks.iter().filter(|c| c.verdict == verdict).count();
        Tally {
            total: self.checks.len(),
            passed: count(Verdict::Pass),
            failed: count(Verdict::Fail),
            skipped: count(Verdict::Skipped),
        }
    }

    /// One sentence.
    fn summary(&self) -> String {
        let Tally {
            total,
            passed,
            failed,
            skipped,
        } = self.tally();
        format!("{total} checks: {passed} passed, {failed} failed, {skipped} skipped")
    }

    /// For the terminal: aligned columns.
    pub(crate) fn to_text(&self) -> String {
        let rows: Vec<[String; 7]> = std::iter::once(HEADINGS.map(str::to_owned))
            .chain(self.checks.iter().map(Check::cells))
            .collect();
        let mut widths = [0; 7];
        for row in &rows {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell.chars().count().max(*width);
            }
        }
        let mut text = String::new();
        for row in &rows {
            let mut line = String::new();
            for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
                // words to the left, numbers to the right
                let _ = if (2..6).contains(&column) {
                    write!(line, "{cell:>width$}  ")
                } else {
                    write!(line, "{cell:<width$}  ")
                };
            }
            let _ = writeln!(text, "{}", line.trim_end());
        }
        if !self.observations.is_empty() {
            let _ = writeln!(text, "\nmeasured besides");
        }
        for observation in &self.observations {
            let Observation { what, unit, ours } = observation;
            let _ = writeln!(text, "  {what}: {} {unit}", rounded(*ours));
        }
        let _ = writeln!(text, "\n{}", self.summary());
        text
    }

    /// For reading: every column, with sources.
    pub(crate) fn to_markdown(&self) -> String {
        let mut text = String::from("# Validation on measured records\n\n");
        let _ = writeln!(text, "{}.\n", self.summary());
        let _ = writeln!(
            text,
            "| {} | source | tolerance from |",
            HEADINGS.join(" | ")
        );
        let _ = writeln!(text, "|---|---|--:|--:|--:|--:|---|---|---|");
        for check in &self.checks {
            let _ = writeln!(
                text,
                "| {} | {} | {} |",
                check
                    .cells()
                    .map(|cell| cell.replace('|', "\\|"))
                    .join(" | "),
                check.claim.source,
                check.claim.tolerance_from
            );
        }
        if !self.observations.is_empty() {
            let _ = writeln!(
                text,
                "\nMeasured besides, without a claim to compare with:\n"
            );
            let _ = writeln!(text, "| what | unit | ours |\n|---|---|--:|");
        }
        for Observation { what, unit, ours } in &self.observations {
            let _ = writeln!(text, "| {what} | {unit} | {} |", rounded(*ours));
        }
        text
    }

    /// For programs: every digit.
    pub(crate) fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
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
pub(crate) fn refused(error: &dyn std::error::Error) -> NotMeasured {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    NotMeasured::Refused(text)
}

/// Five significant digits, without trailing zeros.
fn rounded(value: f64) -> String {
    match format!("{value:.4e}").parse::<f64>() {
        Ok(short) => short.to_string(),
        Err(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim() -> Claim {
        Claim {
            what: "length".to_owned(),
            source: "ruler",
            unit: "m",
            expected: 2.0,
            tolerance: 0.5,
            tolerance_from: "its scale",
        }
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
    fn a_report_lists_every_check_and_counts_them() {
        let report = Report {
            checks: vec![
                Check::of(claim(), Ok(2.25)),
                Check::of(claim(), Ok(3.0)),
                Check::of(claim(), Err(NotMeasured::Absent("lost".to_owned()))),
            ],
            observations: vec![Observation {
                what: "width".to_owned(),
                unit: "m",
                ours: 1.0 / 3.0,
            }],
        };
        assert_eq!(
            report.to_text(),
            "\
claim   unit  expected  ours  tolerance   used  verdict
length  m            2  2.25        0.5   50 %  pass
length  m            2     3        0.5  200 %  FAIL
length  m            2     -        0.5      -  skipped: lost

measured besides
  width: 0.33333 m

3 checks: 1 passed, 1 failed, 1 skipped
"
        );
    }
}
