//! Page of validation, which is written and read back: a table for each crate.

use std::fmt::Write as _;

use testbed::claim::{Check, Verdict};

use super::{COMMAND, Section, faults};

const HEADINGS: &str = "| claim | source | unit | expected | ours | tolerance | why that tolerance | used | verdict |\n\
                        |---|---|---|--:|--:|--:|---|--:|---|\n";
/// Tolerated change of the used part of a tolerance, in points of percent.
const USED: f64 = 25.0;

/// Limit below which a difference from an expected 0 counts as rounding, and is shown with one
/// digit.
const ROUNDING: f64 = 1e-8;

/// Check, as the cells of its row.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Row {
    pub(super) claim: String,
    pub(super) source: String,
    pub(super) unit: String,
    pub(super) expected: String,
    pub(super) ours: String,
    pub(super) tolerance: String,
    pub(super) tolerance_from: String,
    pub(super) used: String,
    pub(super) verdict: String,
}

impl Row {
    /// Returns the change to the `new` row, if a reader would notice it.
    pub(super) fn change_to(&self, new: &Self) -> Option<String> {
        let said = [
            ("source", &self.source, &new.source),
            ("unit", &self.unit, &new.unit),
            ("expected", &self.expected, &new.expected),
            ("tolerance", &self.tolerance, &new.tolerance),
            ("why", &self.tolerance_from, &new.tolerance_from),
        ];
        if let Some((name, old, new)) = said.into_iter().find(|(_, old, new)| old != new) {
            return Some(format!("{name} was \"{old}\", is \"{new}\""));
        }
        if new.is_skipped() {
            return None;
        }
        match (self.used_percent(), new.used_percent()) {
            (Some(before), Some(now)) if (before - now).abs() <= USED => None,
            _ => Some(format!("used was {}, is {}", self.used, new.used)),
        }
    }

    pub(super) fn of(check: &Check) -> Self {
        let claim = &check.claim;
        let is_small = |ours: f64| claim.tolerance < ROUNDING || ours.abs() < ROUNDING;
        let near_rounding = claim.expected.abs() == 0.0 && check.ours.is_some_and(is_small);
        let ours = match check.ours {
            Some(ours) if near_rounding => digits(ours, 1),
            Some(ours) => number(ours),
            None => "-".to_owned(),
        };
        let used = match check.tolerance_used {
            Some(used) if used < 0.01 => "< 1 %".to_owned(),
            Some(used) => format!("{:.0} %", 100.0 * used),
            None => "-".to_owned(),
        };
        let verdict = match (check.verdict, &check.reason) {
            (Verdict::Pass, _) => "pass".to_owned(),
            (Verdict::Fail, None) => "FAIL".to_owned(),
            (Verdict::Fail, Some(reason)) => format!("FAIL: {reason}"),
            (Verdict::Skipped, reason) => {
                format!("skipped: {}", reason.as_deref().unwrap_or("no record"))
            }
        };
        let mut row = Self {
            claim: claim.what.clone(),
            source: claim.source.to_owned(),
            unit: claim.unit.to_owned(),
            expected: number(claim.expected),
            ours,
            tolerance: number(claim.tolerance),
            tolerance_from: claim.tolerance_from.to_owned(),
            used,
            verdict,
        };
        for cell in row.cells_mut() {
            *cell = cell.trim().replace('\n', " ").replace('|', "\\|");
        }
        row
    }

    pub(super) fn is_skipped(&self) -> bool {
        self.verdict.starts_with("skipped")
    }

    /// Returns the used part of the tolerance in percent; `None` if there is no computed number.
    pub(super) fn used_percent(&self) -> Option<f64> {
        match self.used.as_str() {
            "< 1 %" => Some(0.0),
            used => used.strip_suffix(" %")?.parse().ok(),
        }
    }

    fn cells_mut(&mut self) -> [&mut String; 9] {
        [
            &mut self.claim,
            &mut self.source,
            &mut self.unit,
            &mut self.expected,
            &mut self.ours,
            &mut self.tolerance,
            &mut self.tolerance_from,
            &mut self.used,
            &mut self.verdict,
        ]
    }

    fn to_line(&self) -> String {
        let mut row = self.clone();
        row.cells_mut().map(|cell| cell.clone()).join(" | ")
    }

    /// Reads a line of a table; `None` if the line is not a row or is the heading.
    fn read(line: &str) -> Option<Self> {
        let inner = line.strip_prefix("| ")?.strip_suffix(" |")?;
        let mut row = Self::default();
        let mut cells = inner.split(" | ");
        for slot in row.cells_mut() {
            *slot = cells.next()?.to_owned();
        }
        (cells.next().is_none() && row.claim != "claim").then_some(row)
    }
}

/// Rows of one crate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Table {
    pub(super) name: String,
    pub(super) rows: Vec<Row>,
}

impl Table {
    fn count(&self, verdict: &str) -> usize {
        let rows = self.rows.iter();
        rows.filter(|row| row.verdict.starts_with(verdict)).count()
    }
}

/// All tables, in the order of the page.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Page {
    pub(super) tables: Vec<Table>,
    /// Section on faults of the command, as it was read.
    pub(super) faults: String,
}

impl Page {
    pub(super) fn of(sections: &[Section], faults: String) -> Self {
        let table = |section: &Section| Table {
            name: section.name.to_owned(),
            rows: section.report.checks.iter().map(Row::of).collect(),
        };
        Self {
            tables: sections.iter().map(table).collect(),
            faults,
        }
    }

    /// Returns the row of a claim.
    pub(super) fn row(&self, table: &str, claim: &str) -> Option<&Row> {
        let table = self.tables.iter().find(|t| t.name == table)?;
        table.rows.iter().find(|row| row.claim == claim)
    }

    /// Returns this page; each row that was skipped because its record is missing is replaced by
    /// the row of `earlier` with the same words, if there is one.
    pub(super) fn with_rows_of(&self, earlier: &Self) -> Self {
        let mut page = self.clone();
        for table in &mut page.tables {
            for row in &mut table.rows {
                if let Some(kept) = earlier.row(&table.name, &row.claim)
                    && row.is_skipped()
                    && kept.change_to(row).is_none()
                {
                    *row = kept.clone();
                }
            }
        }
        page
    }

    /// Counts the checks of each crate, by their outcome.
    pub(super) fn tally(&self) -> String {
        let mut text =
            String::from("| | checks | passed | failed | skipped |\n|---|--:|--:|--:|--:|\n");
        let mut sums = [0; 4];
        for table in &self.tables {
            let counts = [
                table.rows.len(),
                table.count("pass"),
                table.count("FAIL"),
                table.count("skipped"),
            ];
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum += count;
            }
            let _ = writeln!(
                text,
                "| {} | {} |",
                table.name,
                counts.map(|c| c.to_string()).join(" | ")
            );
        }
        let _ = writeln!(
            text,
            "| all | {} |",
            sums.map(|c| c.to_string()).join(" | ")
        );
        text
    }

    pub(super) fn to_markdown(&self) -> String {
        let mut text = format!(
            "# Validation\n\n\
             Written by `{COMMAND}`; not edited by hand. `cargo xtask validate --check` is part of the gate.\n\n\
             The numbers in the column \"ours\" were computed by the libraries when this page was written. The expected numbers come \
             from independent sources, which the column \"source\" names: the printed tables of the thesis (S. Ödeen, Luleå 1993, papers \
             A to E; a printed value is uncertain by half a unit of its last digit), a closed form, another method of \
             computation, a conservation law, reference output of other software, or a measured record. \"Used\" is the \
             difference as a fraction of the tolerance. If the expected number is 0, \"ours\" is the difference; a difference that is \
             only rounding is shown with one digit. The records themselves are not part of the repository.\n\n{}",
            self.tally()
        );
        for table in &self.tables {
            let _ = write!(text, "\n## {}\n\n{HEADINGS}", table.name);
            for row in &table.rows {
                let _ = writeln!(text, "| {} |", row.to_line());
            }
        }
        let _ = write!(text, "\n## {}\n\n{}", faults::HEADING, self.faults);
        text.push_str("\n## Skipped\n\n");
        let before = text.len();
        for table in &self.tables {
            for row in table.rows.iter().filter(|row| row.is_skipped()) {
                let _ = writeln!(text, "- {}: {}: {}", table.name, row.claim, row.verdict);
            }
        }
        if text.len() == before {
            text.push_str("None.\n");
        }
        text
    }

    /// Reads the tables of a page written by [`to_markdown`](Self::to_markdown).
    pub(super) fn read(text: &str) -> Self {
        let mut page = Self::default();
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("## ") {
                page.tables.push(Table {
                    name: name.to_owned(),
                    rows: Vec::new(),
                });
            } else if let (Some(table), Some(row)) = (page.tables.last_mut(), Row::read(line)) {
                table.rows.push(row);
            }
        }
        // the list of skipped claims at the end and the table of faults contain no claims
        page.tables
            .retain(|table| !table.rows.is_empty() && table.name != faults::HEADING);
        let heading = format!("\n## {}\n\n", faults::HEADING);
        if let Some((_, rest)) = text.split_once(&heading) {
            rest.split("\n## ")
                .next()
                .unwrap_or(rest)
                .clone_into(&mut page.faults);
        }
        page
    }
}

/// Formats a number with five significant digits, without trailing zeros.
pub(super) fn number(value: f64) -> String {
    digits(value, 5)
}

/// Formats a number with the given count of significant digits, without trailing zeros; with a
/// power of ten if it would be long.
fn digits(value: f64, significant: usize) -> String {
    let scientific = format!("{value:.*e}", significant - 1);
    let Ok(short) = scientific.parse::<f64>() else {
        return value.to_string();
    };
    let size = short.abs();
    if size.abs() == 0.0 || (1e-4..1e7).contains(&size) || !size.is_finite() {
        short.to_string()
    } else {
        format!("{short:e}")
    }
}

#[cfg(test)]
mod tests {
    use testbed::claim::{Claim, Claims, NotMeasured};

    use super::*;

    fn section(ours: [Result<f64, NotMeasured>; 3]) -> Section {
        let [a, b, c] = ours;
        let length = |name: &str| {
            Claim::new(format!("length |{name}|"), "ruler")
                .expects(2.0, "m")
                .within(0.5, "its scale")
        };
        let mut report = Claims::default();
        report.checks.push(Check::of(length("a"), a));
        report.checks.push(Check::of(length("b"), b));
        let balance = Claim::new("balance", "conservation").within(1e-12, "rounding");
        report.checks.push(Check::of(balance, c));
        Section {
            name: "rods",
            report,
        }
    }

    #[test]
    fn rows_without_their_record_stay_as_they_were() {
        let absent = || Err(NotMeasured::Absent("lost".to_owned()));
        let earlier = Page::of(&[section([Ok(2.25), Ok(2.0), Ok(0.0)])], String::new());
        let now = Page::of(&[section([absent(), Ok(2.125), Ok(0.0)])], String::new());
        let kept = now.with_rows_of(&earlier);
        let ours: Vec<&str> = kept.tables[0]
            .rows
            .iter()
            .map(|r| r.ours.as_str())
            .collect();
        assert_eq!(ours, ["2.25", "2.125", "0"]);
    }
}
