//! What a job hands back: everything that a report, a table or another program can want of it.

use serde::{Deserialize, Serialize};

use crate::figure::Figure;
use crate::standing::Standing;

/// Start of the names of quantities that are checks of the result itself: they keep their verdict where the result is in doubt.
pub const CHECK: &str = "check: ";

/// The result of one job on one sheet.
///
/// Nothing in it depends on the clock, the machine or the folder: the same sheet and files give the same outcome, byte for byte.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// The job, as `modulus`.
    pub job: &'static str,
    /// Title of the sheet.
    pub title: String,
    /// Whether there is an answer.
    pub verdict: Verdict,
    /// What was found, in sentences; the first is the one to read.
    pub summary: Vec<String>,
    /// What a reader has to know before believing it, in sentences.
    pub warnings: Vec<String>,
    /// The files that were read.
    pub inputs: Vec<InputFile>,
    /// Everything that was chosen, by the sheet or by default.
    pub settings: Vec<Setting>,
    /// What was accepted and what was rejected, with reasons.
    pub log: Vec<LogEntry>,
    /// Single numbers that were found.
    pub quantities: Vec<Quantity>,
    /// Tables; each becomes a file of comma-separated values.
    pub tables: Vec<Table>,
    /// Figures; each becomes a file of scalable graphics and a part of the report. Their numbers are those of the tables.
    #[serde(serialize_with = "names_of_figures")]
    pub figures: Vec<Figure>,
    /// Files for other programs, as a frequency response in universal file format.
    #[serde(skip)]
    pub attachments: Vec<Attachment>,
}

impl Outcome {
    /// An outcome of `job` with nothing in it yet.
    #[must_use]
    pub fn of(job: &'static str, title: impl Into<String>) -> Self {
        Self {
            job,
            title: title.into(),
            verdict: Verdict::Answered,
            summary: Vec::new(),
            warnings: Vec::new(),
            inputs: Vec::new(),
            settings: Vec::new(),
            log: Vec::new(),
            quantities: Vec::new(),
            tables: Vec::new(),
            figures: Vec::new(),
            attachments: Vec::new(),
        }
    }

    /// Puts the answer in doubt because a check fails; `reason` says which, as a clause without a full stop. A result that the data do
    /// not allow stays so, and a reason counts once.
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
            Verdict::NotAllowed { .. } => {}
        }
    }

    /// The outcome as it leaves its job. Where it is in doubt, the first sentence says so, and no quantity is valid but the checks that
    /// pass: a number of a result that must not be used is not to be used either.
    #[must_use]
    pub(crate) fn settled(mut self) -> Self {
        if let Verdict::InDoubt { reasons } = &self.verdict {
            let sentence = format!(
                "Do not use this result until the failed checks are explained: {}.",
                reasons.join("; ")
            );
            self.summary.insert(0, sentence);
            let because = format!("{}: {}", Standing::InDoubt, reasons.join("; "));
            let believed =
                |quantity: &&mut Quantity| quantity.valid && !quantity.name.starts_with(CHECK);
            for quantity in self.quantities.iter_mut().filter(believed) {
                quantity.valid = false;
                quantity.verdict.clone_from(&because);
            }
        }
        self
    }
}

/// What `result.json` says of a figure; its numbers are in the tables.
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

/// The standing of a result, apart from errors of the sheet or of a file, which end without a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Told", try_from = "Told")]
pub enum Verdict {
    /// The data allow an answer and every check passes; exit status 0.
    Answered,
    /// There is an answer, but a check fails; exit status 3.
    InDoubt {
        /// The failed checks, a clause each.
        reasons: Vec<String>,
    },
    /// The data do not allow an answer; exit status 1.
    NotAllowed {
        /// Why, in a sentence.
        reason: String,
    },
}

impl Verdict {
    /// Its standing.
    #[must_use]
    pub fn standing(&self) -> Standing {
        match self {
            Self::Answered => Standing::Answered,
            Self::InDoubt { .. } => Standing::InDoubt,
            Self::NotAllowed { .. } => Standing::NotAllowed,
        }
    }

    /// What there is to say in one line: why the result is in doubt or not allowed, else the first sentence of its `summary`.
    #[must_use]
    pub fn headline(&self, summary: &[String]) -> String {
        match self {
            Self::Answered => summary.first().cloned().unwrap_or_default(),
            Self::InDoubt { reasons } => reasons.join("; "),
            Self::NotAllowed { reason } => reason.clone(),
        }
    }
}

/// A [`Verdict`] as `result.json` has it.
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
                "the verdict is `{}`, expected that of a result",
                told.answer
            )),
        }
    }
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InputFile {
    /// Path as the sheet says it, relative to the sheet.
    pub path: String,
    /// Format in which it was recognised.
    pub format: String,
    /// Number of bytes.
    pub bytes: u64,
    /// SHA-256 of the bytes, hexadecimal.
    pub sha256: String,
    /// The name or pattern of the sheet that found it, as `hits-*.npy`; absent where the sheet names one file and no pattern.
    #[serde(default)]
    pub pattern: Option<String>,
}

/// Something that was chosen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// Place in the sheet, as `specimen.length`.
    pub name: String,
    /// Value with its unit, as it was understood.
    pub value: String,
    /// Whether the sheet says so, or a default does.
    pub by_default: bool,
}

/// A decision on a hit, a line or a test.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LogEntry {
    /// What was judged, as `hits.npy, hit 3 at 1.204 s`.
    pub what: String,
    /// The decision.
    pub accepted: bool,
    /// Why; may be empty for what was accepted.
    pub reasons: Vec<String>,
}

/// A number that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Name in the field's words.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value in that unit; absent where the data do not give one.
    pub value: Option<f64>,
    /// Standard error in that unit, where there is one.
    pub standard_error: Option<f64>,
    /// Whether it may be believed.
    pub valid: bool,
    /// Why or why not: `identified`, `not identifiable: ...`, `wavelength below five diameters`.
    pub verdict: String,
}

/// A table: columns of one length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Name of its file without extension, as `modulus`.
    pub name: String,
    /// Heading.
    pub title: String,
    /// Columns, each with its unit.
    pub columns: Vec<Column>,
}

/// A column of a [`Table`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Column {
    /// Name in the field's words.
    pub name: String,
    /// Unit; empty for pure numbers and words.
    pub unit: String,
    /// What stands in it.
    pub cells: Cells,
}

impl Column {
    /// A column of numbers; NaN means that there is none.
    #[must_use]
    pub fn numbers(name: impl Into<String>, unit: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            cells: Cells::Numbers(values),
        }
    }

    /// A column of words.
    #[must_use]
    pub fn words(name: impl Into<String>, words: Vec<String>) -> Self {
        Self {
            name: name.into(),
            unit: String::new(),
            cells: Cells::Words(words),
        }
    }
}

/// The cells of a [`Column`].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cells {
    /// Numbers in the unit of the column; NaN where there is none (empty in CSV, null in JSON).
    Numbers(Vec<f64>),
    /// Words.
    Words(Vec<String>),
}

impl Cells {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Words(words) => words.len(),
        }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A file for another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Name of the file with extension, as `mobility.uff`.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}
