//! An inspection as text, in columns.

use std::fmt::Write;

use super::{InspectedSeries, Inspection};
use crate::digits::{hertz, short};

/// Largest number of records listed one by one.
const MOST_RECORDS: usize = 8;
/// Largest number of data sets or channels listed one by one.
const MOST_LISTED: usize = 20;

/// Returns the first [`MOST_LISTED`] names, separated by commas, and the number of the others.
pub(super) fn listed(names: &[String]) -> String {
    match names.split_at_checked(MOST_LISTED) {
        Some((first, others)) if !others.is_empty() => {
            format!("{} and {} more", first.join(", "), others.len())
        }
        _ => names.join(", "),
    }
}

impl Inspection {
    /// Returns the inspection as text, with one line per data set.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        // writing to a string does not fail
        let _ = self.write_to(&mut text);
        text
    }

    fn write_to(&self, text: &mut String) -> std::fmt::Result {
        writeln!(text, "{}: {}, {} bytes", self.path, self.format, self.bytes)?;
        writeln!(text, "sha256 {}", self.sha256)?;
        for (key, value) in &self.properties {
            writeln!(text, "  {key}: {}", value.escape_debug())?;
        }
        if self.series.is_empty() {
            writeln!(text, "no data sets")?;
        } else {
            writeln!(text)?;
            let mut rows = vec![
                [
                    "#",
                    "name",
                    "kind",
                    "unit",
                    "samples",
                    "rate or step",
                    "from",
                    "minimum",
                    "maximum",
                    "mean",
                    "rms",
                ]
                .map(str::to_owned),
            ];
            rows.extend(self.series.iter().take(MOST_LISTED).map(row));
            aligned(&rows, text)?;
            if self.series.len() > MOST_LISTED {
                writeln!(text, "and {} more", self.series.len() - MOST_LISTED)?;
            }
        }
        if !self.records.is_empty() {
            writeln!(text)?;
        }
        for (record, number) in self.records.iter().zip(1..).take(MOST_RECORDS) {
            let duration = record.duration.map_or_else(
                || "rate not stated".to_owned(),
                |duration| format!("{} s", short(duration)),
            );
            writeln!(
                text,
                "record {number}: {} ({} samples, {duration})",
                listed(&record.channels),
                record.samples
            )?;
        }
        if self.records.len() > MOST_RECORDS {
            writeln!(text, "... {} records in all", self.records.len())?;
        }
        for (heading, lines) in [
            ("not read:", &self.defects),
            ("suspicious (levels in SI units):", &self.suspicions),
            (
                "if each record is one hit (levels in SI units):",
                &self.as_hits,
            ),
            ("for a sheet:", &self.advice),
        ] {
            if !lines.is_empty() {
                writeln!(text, "\n{heading}")?;
                for line in lines {
                    writeln!(text, "  {line}")?;
                }
            }
        }
        Ok(())
    }
}

fn row(series: &InspectedSeries) -> [String; 11] {
    let unless_empty = |text: &str| if text.is_empty() { "-" } else { text }.to_owned();
    let sampling = match (series.sampling_rate_hz, series.step) {
        (Some(rate), _) => hertz(rate),
        (None, Some(step)) => format!("{} {}", short(step), series.abscissa_unit)
            .trim()
            .to_owned(),
        (None, None) => "uneven".to_owned(),
    };
    let level = |of: fn(&super::Levels) -> f64| {
        series
            .levels
            .as_ref()
            .map_or_else(|| "-".to_owned(), |levels| short(of(levels)))
    };
    [
        series.number.to_string(),
        unless_empty(&series.name),
        if series.complex {
            format!("{} (magnitudes)", series.kind)
        } else {
            series.kind.clone()
        },
        unless_empty(&series.unit),
        series.samples.to_string(),
        sampling,
        format!("{} {}", short(series.from), series.abscissa_unit)
            .trim()
            .to_owned(),
        level(|l| l.least),
        level(|l| l.greatest),
        level(|l| l.mean),
        level(|l| l.rms),
    ]
}

/// Appends the rows in columns, with words aligned left and numbers right.
fn aligned(rows: &[[String; 11]], text: &mut String) -> std::fmt::Result {
    const TO_THE_LEFT: [bool; 11] = [
        false, true, true, true, false, false, false, false, false, false, false,
    ];
    let mut widths = [0; 11];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    for row in rows {
        let mut line = String::new();
        for ((cell, width), left) in row.iter().zip(widths).zip(TO_THE_LEFT) {
            if left {
                write!(line, "{cell:<width$}  ")?;
            } else {
                write!(line, "{cell:>width$}  ")?;
            }
        }
        writeln!(text, "{}", line.trim_end())?;
    }
    Ok(())
}
