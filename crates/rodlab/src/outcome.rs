//! Results of a job, with everything that a report, a table or another program needs.

mod column_name;
mod columns;
mod published;

pub(crate) use columns::Rows;
pub use published::{PublishedCells, PublishedColumn};

use labio::ContentHash;
use rodfigure::Figure;
use serde::{Deserialize, Serialize};

use crate::draw::DrawnLaws;
use crate::standing::Standing;

/// Prefix of the names of quantities that are checks of the result: they keep their verdict if the
/// result is in doubt.
pub const CHECK: &str = "check: ";

/// The result of one job on one sheet.
///
/// It does not depend on the time, the machine or the folder: the same sheet and files give the
/// same outcome, byte for byte.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Outcome {
    /// The job, such as `modulus`.
    pub job: &'static str,
    /// Title of the sheet.
    pub title: String,
    /// The verdict on the result.
    pub verdict: Verdict,
    /// The findings, in sentences; the first is the most important.
    pub summary: Vec<String>,
    /// Warnings about the use of the result, in sentences.
    pub warnings: Vec<String>,
    /// The input files.
    pub inputs: Vec<InputFile>,
    /// All settings, stated in the sheet or set by default.
    pub settings: Vec<Setting>,
    /// Accepted and rejected items, with reasons.
    pub log: Vec<LogEntry>,
    /// Single numbers of the result.
    pub quantities: Vec<Quantity>,
    /// Tables; each becomes a CSV file.
    pub tables: Vec<Table>,
    /// Figures; each becomes an SVG file and a part of the report. They show numbers of the tables.
    #[serde(serialize_with = "names_of_figures")]
    pub figures: Vec<Figure>,
    /// Files for other programs, such as a frequency response in universal file format.
    #[serde(skip)]
    pub attachments: Vec<Attachment>,
    /// Laws that a Monte Carlo computation fits to its draws.
    #[serde(skip)]
    pub(crate) drawn_laws: DrawnLaws,
}

impl Outcome {
    /// Returns an empty outcome of `job`.
    #[must_use]
    pub fn of(job: &'static str, title: impl Into<String>) -> Self {
        Self {
            job,
            title: title.into(),
            ..Self::default()
        }
    }

    /// Adds a finding, in sentences.
    pub(crate) fn say(&mut self, finding: impl Into<String>) {
        self.summary.push(finding.into());
    }

    /// Adds a finding before all others, in sentences.
    pub(crate) fn lead(&mut self, finding: impl Into<String>) {
        self.summary.insert(0, finding.into());
    }

    /// Adds a warning, in sentences.
    pub(crate) fn warn(&mut self, warning: impl Into<String>) {
        self.warnings.push(warning.into());
    }

    /// Adds the acceptance of a hit, a line or a test, with remarks.
    pub(crate) fn accept(
        &mut self,
        what: impl Into<String>,
        remarks: impl IntoIterator<Item: ToString>,
    ) {
        let reasons = remarks.into_iter().map(|remark| remark.to_string());
        self.log.push(LogEntry {
            what: what.into(),
            accepted: true,
            reasons: reasons.collect(),
        });
    }

    /// Adds the rejection of a hit, a line or a test.
    pub(crate) fn reject(&mut self, what: impl Into<String>, reason: impl ToString) {
        self.log.push(LogEntry::rejected(what, reason));
    }

    /// Puts the answer in doubt because a check fails; `reason` names the check, as a clause
    /// without a full stop. A repeated reason is listed once. If the data do not allow an answer,
    /// the reason becomes a warning, because the failed check may explain why there is no answer.
    pub fn doubt(&mut self, reason: impl Into<String>) {
        let reason = reason.into();
        match &mut self.verdict {
            Verdict::Answered => {
                self.verdict = Verdict::InDoubt {
                    reasons: vec![reason],
                };
            }
            Verdict::InDoubt { reasons } if reasons.contains(&reason) => {}
            Verdict::InDoubt { reasons } => reasons.push(reason),
            Verdict::NotAllowed { .. } => {
                let warning = sentence(&reason);
                if !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
        }
    }

    /// Puts the answer in doubt for each of the `reasons`.
    pub(crate) fn doubt_all(&mut self, reasons: impl IntoIterator<Item: Into<String>>) {
        for reason in reasons {
            self.doubt(reason);
        }
    }

    /// States that the data do not allow an answer; `reason` is a clause without a full stop.
    /// Earlier doubts become the first warnings, because the failed checks may explain why there is
    /// no answer.
    pub fn refuse(&mut self, reason: impl Into<String>) {
        let reason = reason.into();
        let earlier = std::mem::replace(&mut self.verdict, Verdict::NotAllowed { reason });
        if let Verdict::InDoubt { reasons } = earlier {
            let explaining = reasons.iter().map(|one| sentence(one));
            self.warnings.splice(0..0, explaining);
        }
    }

    /// States that the data do not allow an answer, like [`Self::refuse`], and adds a first finding
    /// that consists of `denial` and `reason`.
    pub(crate) fn deny(&mut self, denial: &str, reason: impl Into<String>) {
        let reason = reason.into();
        self.lead(format!("{denial}: {reason}."));
        self.refuse(reason);
    }

    /// Puts the settings that the sheet states before the defaults of the others.
    pub(crate) fn settle_settings(&mut self, mut stated: Vec<Setting>) {
        let mut open = std::mem::take(&mut self.settings);
        open.retain(|open| !stated.iter().any(|stated| open.is_stated_by(&stated.name)));
        stated.append(&mut open);
        self.settings = stated;
    }

    /// Adds the default of `name`, which applies if the sheet does not state this setting.
    pub(crate) fn by_default(&mut self, name: impl Into<String>, value: impl ToString) {
        self.settings.push(Setting::by_default(name, value));
    }

    /// Returns the outcome as it leaves the job. If the outcome is in doubt, its first sentence
    /// states this. Of its quantities, only checks that pass stay valid, because no single number
    /// of a doubtful result may be used.
    #[must_use]
    pub(crate) fn settled(mut self) -> Self {
        if let Verdict::InDoubt { reasons } = &self.verdict {
            let sentence = format!(
                "Do not use this result until the failed checks are explained: {}.",
                reasons.join("; ")
            );
            self.summary.insert(0, sentence);
            let believed =
                |quantity: &&mut Quantity| quantity.valid && !quantity.name.starts_with(CHECK);
            for quantity in self.quantities.iter_mut().filter(believed) {
                quantity.valid = false;
                Standing::InDoubt.word().clone_into(&mut quantity.verdict);
            }
        }
        self
    }
}

/// Serializes the names of the figures for `result.json`; their numbers are in the tables.
fn names_of_figures<S: serde::Serializer>(
    figures: &[Figure],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Named<'a> {
        name: &'a str,
        title: &'a str,
        caption: &'a str,
    }
    serializer.collect_seq(figures.iter().map(|figure| Named {
        name: &figure.name,
        title: &figure.title,
        caption: &figure.caption,
    }))
}

/// Verdict on a result. A mistake in the sheet or in a file gives no verdict, because there is no
/// result then.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Told", try_from = "Told")]
pub enum Verdict {
    /// The data allow an answer, and every check passes; exit status 0.
    #[default]
    Answered,
    /// There is an answer, but a check fails; exit status 3.
    InDoubt {
        /// The failed checks, one clause each.
        reasons: Vec<String>,
    },
    /// The data do not allow an answer; exit status 1.
    NotAllowed {
        /// The reason, in one sentence.
        reason: String,
    },
}

impl Verdict {
    /// Returns the standing of the verdict.
    #[must_use]
    pub fn standing(&self) -> Standing {
        match self {
            Self::Answered => Standing::Answered,
            Self::InDoubt { .. } => Standing::InDoubt,
            Self::NotAllowed { .. } => Standing::NotAllowed,
        }
    }

    /// Returns the result in one line: the reason why it is in doubt or not allowed, otherwise the
    /// first sentence of its `summary`.
    #[must_use]
    pub fn headline(&self, summary: &[String]) -> String {
        match self {
            Self::Answered => summary.first().cloned().unwrap_or_default(),
            Self::InDoubt { reasons } => reasons.join("; "),
            Self::NotAllowed { reason } => reason.clone(),
        }
    }
}

/// A [`Verdict`] in the form of `result.json`.
#[derive(Serialize, Deserialize)]
struct Told {
    answer: Standing,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    reasons: Vec<String>,
}

impl From<Verdict> for Told {
    fn from(verdict: Verdict) -> Self {
        Self {
            answer: verdict.standing(),
            reasons: match verdict {
                Verdict::Answered => Vec::new(),
                Verdict::InDoubt { reasons } => reasons,
                Verdict::NotAllowed { reason } => vec![reason],
            },
        }
    }
}

impl TryFrom<Told> for Verdict {
    type Error = String;

    fn try_from(told: Told) -> Result<Self, String> {
        match told.answer {
            Standing::Answered => Ok(Self::Answered),
            Standing::InDoubt => Ok(Self::InDoubt {
                reasons: told.reasons,
            }),
            Standing::NotAllowed => Ok(Self::NotAllowed {
                reason: told.reasons.join("; "),
            }),
            Standing::WrongInput => Err(format!(
                "the verdict is `{}`, expected the verdict of a result",
                told.answer
            )),
        }
    }
}

/// An input file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InputFile {
    /// Path as written in the sheet, relative to the sheet.
    pub path: String,
    /// Detected format.
    pub format: String,
    /// Number of bytes.
    pub bytes: u64,
    /// SHA-256 of the bytes, hexadecimal.
    pub sha256: String,
    /// Pattern of the sheet that matched the file, such as `hits-*.npy`; absent if the sheet names
    /// the file itself.
    pub pattern: Option<String>,
}

impl InputFile {
    /// Returns the file at `path` with its detected format and its contents.
    pub(crate) fn of(path: &str, format: &str, bytes: &[u8]) -> Self {
        Self::hashed(path, format, bytes, Some(ContentHash::of(bytes)))
    }

    /// Returns the file like [`Self::of`], with the known hash of its contents.
    pub(crate) fn hashed(
        path: &str,
        format: &str,
        bytes: &[u8],
        hash: Option<ContentHash>,
    ) -> Self {
        Self {
            path: path.to_owned(),
            format: format.to_owned(),
            bytes: bytes.len() as u64,
            sha256: hash.map(|hash| hash.to_string()).unwrap_or_default(),
            pattern: None,
        }
    }
}

/// A setting.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// Place in the sheet, such as `specimen.length`.
    pub name: String,
    /// Value with its unit, as interpreted.
    pub value: String,
    /// True if set by default, false if stated in the sheet.
    pub by_default: bool,
}

impl Setting {
    /// Returns the default of `name`, which applies if the sheet does not state this setting.
    pub(crate) fn by_default(name: impl Into<String>, value: impl ToString) -> Self {
        Self {
            name: name.into(),
            value: value.to_string(),
            by_default: true,
        }
    }

    /// Returns true if the `statement` states this setting or a part of it.
    fn is_stated_by(&self, statement: &str) -> bool {
        let rest = statement.strip_prefix(&self.name);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    }
}

/// A decision on a hit, a line or a test.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LogEntry {
    /// The hit, line or test, such as `hits.npy, hit 3 at 1.204 s`.
    pub what: String,
    /// True if accepted, false if rejected.
    pub accepted: bool,
    /// The reasons; may be empty for an accepted item.
    pub reasons: Vec<String>,
}

impl LogEntry {
    /// Returns the rejection of `what`.
    pub(crate) fn rejected(what: impl Into<String>, reason: impl ToString) -> Self {
        Self {
            what: what.into(),
            accepted: false,
            reasons: vec![reason.to_string()],
        }
    }
}

/// A single number of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Name, in the terms of the field.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value in this unit; absent if the data do not determine it.
    pub value: Option<f64>,
    /// Standard error in this unit, if it is known.
    pub standard_error: Option<f64>,
    /// True if the value may be used.
    pub valid: bool,
    /// Reason for the validity, such as `identified`, `not identifiable: ...`,
    /// `wavelength below five diameters`.
    pub verdict: String,
}

impl Quantity {
    /// Returns a quantity without standard error, which is valid if it has a value.
    pub(crate) fn of(
        name: impl Into<String>,
        unit: impl Into<String>,
        value: impl Into<Option<f64>>,
        verdict: impl Into<String>,
    ) -> Self {
        let value = value.into();
        Self {
            name: name.into(),
            unit: unit.into(),
            value,
            standard_error: None,
            valid: value.is_some(),
            verdict: verdict.into(),
        }
    }

    /// The quantity with its standard error, if it is known.
    pub(crate) fn with_error(mut self, standard_error: impl Into<Option<f64>>) -> Self {
        self.standard_error = standard_error.into();
        self
    }

    /// The quantity with the given validity.
    pub(crate) fn valid_if(self, valid: bool) -> Self {
        Self { valid, ..self }
    }
}

/// A table with columns of equal length. Reports show it as it is; other programs get
/// [`Table::published`].
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of its file without extension, such as `modulus`.
    pub name: String,
    /// Title.
    pub title: String,
    /// Columns, each with its unit.
    pub columns: Vec<Column>,
}

impl Table {
    /// Returns the validity of the rows; `None` without a column of validity.
    pub(crate) fn valid(&self) -> Option<&[bool]> {
        self.columns.iter().find_map(|column| match &column.cells {
            Cells::Validity { valid, .. } => Some(valid.as_slice()),
            _ => None,
        })
    }
}

/// A column of a [`Table`].
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name, in the terms of the field; the name for other programs is derived from it and the
    /// unit.
    pub name: String,
    /// Unit; empty for pure numbers and words.
    pub unit: String,
    /// Contents of the column.
    pub cells: Cells,
}

/// Beginning of the name of a column of standard errors, followed by the name of their column.
pub(crate) const ERROR_OF: &str = "standard error of ";

impl Column {
    /// Returns the numbers; `None` for words and verdicts.
    pub(crate) fn known_numbers(&self) -> Option<&[f64]> {
        match &self.cells {
            Cells::Numbers(values) => Some(values),
            Cells::Words(_) | Cells::Validity { .. } => None,
        }
    }

    /// Returns true if the column contains the standard errors of `other`.
    pub(crate) fn is_error_of(&self, other: &Self) -> bool {
        let of = self.name.strip_prefix(ERROR_OF);
        let is_same = |of: &str| of.strip_prefix("the ").unwrap_or(of) == other.name;
        self.unit == other.unit && of.is_some_and(is_same)
    }

    /// Returns a column of numbers; NaN stands for a missing number.
    #[must_use]
    pub fn numbers(name: impl Into<String>, unit: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            cells: Cells::Numbers(values),
        }
    }

    /// Returns a column of words.
    #[must_use]
    pub fn words(name: impl Into<String>, words: Vec<String>) -> Self {
        Self {
            name: name.into(),
            unit: String::new(),
            cells: Cells::Words(words),
        }
    }

    /// Returns a column with the validity of the rows, and words that state the reasons against a
    /// row.
    #[must_use]
    pub fn validity(valid: Vec<bool>, words: Vec<String>) -> Self {
        Self {
            name: "validity".to_owned(),
            unit: String::new(),
            cells: Cells::Validity {
                valid,
                words,
                kinds: Vec::new(),
            },
        }
    }

    /// Adds the kinds of the reasons against each row to a column of validity; a report denotes
    /// them by letters.
    pub(crate) fn with_kinds(mut self, of_rows: Vec<Vec<&'static str>>) -> Self {
        if let Cells::Validity { kinds, .. } = &mut self.cells {
            *kinds = of_rows;
        }
        self
    }
}

/// The cells of a [`Column`].
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Numbers in the unit of the column; NaN for a missing number.
    Numbers(Vec<f64>),
    /// Words.
    Words(Vec<String>),
    /// Verdicts on the rows.
    Validity {
        /// True for each valid row.
        valid: Vec<bool>,
        /// The verdicts in words, with the reasons.
        words: Vec<String>,
        /// The reasons without their numbers; empty if the words themselves are the reasons.
        kinds: Vec<Vec<&'static str>>,
    },
}

impl Cells {
    /// Returns the number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Words(words) => words.len(),
            // the length of the shorter list, because cells beyond it would be empty
            Self::Validity { valid, words, .. } => valid.len().min(words.len()),
        }
    }

    /// Returns true if there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A file for another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Name of the file with extension, such as `mobility.uff`.
    pub name: String,
    /// Contents of the file.
    pub bytes: Vec<u8>,
}

/// Returns the number if it is finite.
pub(crate) fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}

/// Returns the unit as it is shown: that of a pure number, `1`, is empty.
pub(crate) fn shown_unit(unit: &str) -> &str {
    if unit == "1" { "" } else { unit }
}

/// Returns the text with an initial capital letter.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

pub(crate) fn sentence(clause: &str) -> String {
    capital(clause) + "."
}
