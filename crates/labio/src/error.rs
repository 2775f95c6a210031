//! Errors of records, files and spectral estimates.

use std::fmt;
use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Reasons to reject a record, a file or an estimate.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of an error names its fields")]
#[non_exhaustive]
pub enum LabioError {
    /// A scalar has an impossible value.
    #[error("{quantity} is {value}, expected {expected}")]
    NonPhysical {
        /// Name and unit of the quantity, for example `sampling rate \[Hz\]`.
        quantity: &'static str,
        value: f64,
        /// The condition that the value violates.
        expected: &'static str,
    },
    /// A sample is NaN or infinite.
    #[error("sample {index} of channel `{channel}` is {value}, expected a finite value")]
    NonFiniteSample {
        channel: String,
        /// Position of the sample, from 0.
        index: usize,
        value: f64,
    },
    /// Finite samples are so large that their spectrum overflows.
    #[error("the spectrum of channel `{channel}` overflows at line {line}")]
    SpectrumOverflow {
        channel: String,
        /// Index of the spectral line, from 0.
        line: usize,
    },
    /// Two counts that must be equal differ.
    #[error("{what}: found {found}, expected {expected}")]
    CountMismatch {
        /// The things counted.
        what: &'static str,
        found: usize,
        expected: usize,
    },
    /// There are too few samples for the operation.
    #[error("{what} has {found} samples, expected at least {expected}")]
    TooFewSamples {
        /// The data that are too short.
        what: &'static str,
        found: usize,
        expected: usize,
    },
    /// A pulse begins within the stated silence.
    #[error("a pulse begins after {found:.3e} s, expected a silence of {stated:.3e} s before it")]
    SilenceEnds {
        /// Time of the first sample of the pulse, in seconds from the beginning of the record.
        found: f64,
        /// Stated duration of the silence, in seconds.
        stated: f64,
    },
    /// The noise in the silence is too large, compared with the largest sample, to find a pulse.
    #[error(
        "the noise in the silence before a pulse is {noise:.3e}, expected at most 2 % of the largest sample, {peak:.3e}"
    )]
    NoisySilence {
        /// Standard deviation of the noise.
        noise: f64,
        /// Largest sample, counted from the level at rest.
        peak: f64,
    },
    /// A pulse has no echo of the opposite sign.
    #[error("no pulse of the opposite sign follows a pulse, expected one after {expected:.3e} s")]
    NoEcho {
        /// Expected delay, in seconds.
        expected: f64,
    },
    /// A pulse lasts until its echo, or its echo arrives at another time than expected.
    #[error(
        "a pulse lasts {pulse:.3e} s and changes sign {delay:.3e} s after its front, expected a rest of the channel and an echo after {expected:.3e} s"
    )]
    EchoOverlaps {
        /// Duration of the pulse, in seconds.
        pulse: f64,
        /// Time from the front of the pulse to the front of its echo, in seconds.
        delay: f64,
        /// Expected time between the two fronts, in seconds.
        expected: f64,
    },
    /// The next wave arrives before the echo of a pulse has passed.
    #[error(
        "the window of an echo may last {next:.3e} s before the next wave, expected more than the pulse of {pulse:.3e} s with its margins"
    )]
    EchoOvertaken {
        /// Duration of the pulse, in seconds.
        pulse: f64,
        /// Longest window of the echo that ends before the next wave, in seconds.
        next: f64,
    },
    /// The record ends before the echo of a pulse does.
    #[error("the record lasts {found:.3e} s, expected {expected:.3e} s up to the end of an echo")]
    EchoCut {
        /// Duration of the record, in seconds.
        found: f64,
        /// Duration needed, in seconds.
        expected: f64,
    },
    /// A channel still moves at the end of a hit that is to be padded with its level at rest.
    #[error(
        "`{channel}` deviates from its rest level by {remainder:.3e} rms in the last tenth of the record, expected no more than noise and a thousandth of its peak of {peak:.3e}"
    )]
    NotAtRest {
        channel: String,
        /// Root mean square deviation, in the last tenth of the record, from the level before the
        /// impact.
        remainder: f64,
        /// Largest excursion from that level.
        peak: f64,
    },
    /// Several hits have no noise: they are copies of one hit, or were computed.
    #[error(
        "the coherence of `{output}` with `{input}` over {hits} hits is 1 to within rounding, expected noise: hits that are copies of one hit, or were computed, have no random error"
    )]
    NoNoise {
        /// The channel used as the input.
        input: String,
        /// The channel used as the output.
        output: String,
        hits: usize,
    },
    /// An estimate needs more averages than exist.
    #[error("{estimate} needs at least {expected} averages, found {found}")]
    TooFewAverages {
        /// The requested estimate.
        estimate: &'static str,
        found: usize,
        expected: usize,
    },
    /// An estimate needs the noise of a channel at rest.
    #[error(
        "the errors-in-variables estimator needs the noise of `{channel}` at rest, which is not known"
    )]
    UnknownRestNoise { channel: String },
    /// A setting must be made before the first hit is added.
    #[error("{asked} must be chosen before the first hit, but {found} have been added")]
    TooManyAverages {
        asked: &'static str,
        /// Number of hits already added.
        found: usize,
    },
    /// Two windows would both weight the same samples.
    #[error("{asked} cannot be combined with {present}")]
    WindowConflict {
        /// The requested window.
        asked: &'static str,
        /// The window already in use.
        present: String,
    },
    /// A response cannot be combined with the first of several.
    #[error("the {what} of response {index} is {found}, expected {expected} as in the first")]
    ResponseMismatch {
        /// The property that differs.
        what: &'static str,
        /// Index of the response, from 0.
        index: usize,
        found: String,
        expected: String,
    },
    /// A response is not one of the six kinds between a force and a motion.
    #[error("a response from {input} to {output} is not between a force and a motion")]
    NoResponseKind {
        /// Name and unit of the input.
        input: String,
        /// Name and unit of the output.
        output: String,
    },
    /// Lines that are needed contain no information.
    #[error(
        "{what} needs every line, but {count} carry no information, the first at {first_hz} Hz"
    )]
    MissingLines {
        /// The result that needs the lines.
        what: &'static str,
        /// Frequency of the first missing line.
        first_hz: f64,
        count: usize,
    },
    /// A channel has no name.
    #[error("a channel of {quantity} has an empty name")]
    EmptyChannelName { quantity: &'static str },
    /// Two channels of one record have the same name.
    #[error("channels {first} and {second} are both named `{name}`")]
    DuplicateChannel {
        name: String,
        /// Index of the first channel of that name.
        first: usize,
        /// Index of the second channel of that name.
        second: usize,
    },
    /// No channel has the requested name.
    #[error("there is no channel `{name}`, only {}", quoted(known))]
    UnknownChannel {
        name: String,
        /// The known names.
        known: Vec<String>,
    },
    /// The channels of a hit differ from those of the hits before it.
    #[error("channel {index} is {found}, expected {expected} as in the previous hits")]
    ChannelMismatch {
        /// Index of the channel, from 0.
        index: usize,
        /// Name and quantity found.
        found: String,
        /// Name and quantity expected.
        expected: String,
    },
    /// A hit was sampled at a different rate from the hits before it.
    #[error(
        "the sampling rate is {found_hz} Hz, expected {expected_hz} Hz as in the previous hits"
    )]
    SamplingRateMismatch { found_hz: f64, expected_hz: f64 },
    /// The samples are not equally spaced in time.
    #[error(
        "time step {index} is {found} s, expected {expected} s within a relative deviation of {tolerance}"
    )]
    NonUniformTime {
        /// Index of the sample at which the step starts, from 0.
        index: usize,
        found: f64,
        /// The mean step.
        expected: f64,
        /// The relative deviation that is accepted.
        tolerance: f64,
    },
    /// The array in the file has the wrong number of axes.
    #[error("the {format} array has {found} axes, expected {expected}")]
    WrongDimensions {
        format: &'static str,
        found: usize,
        expected: usize,
    },
    /// The numbers in the file are of an unexpected type.
    #[error("the {format} array contains {found}, expected {expected}")]
    WrongElement {
        format: &'static str,
        found: String,
        expected: &'static str,
    },
    /// The data end too early.
    #[error("the {format} data end {missing_bytes} bytes too early")]
    Truncated {
        format: &'static str,
        missing_bytes: usize,
    },
    /// The file contains no data.
    #[error("the {format} file contains no data")]
    NoData { format: &'static str },
    /// Bytes follow the data of the file.
    #[error("{extra_bytes} bytes follow the {format} data")]
    TrailingBytes {
        format: &'static str,
        /// Number of bytes too many.
        extra_bytes: usize,
    },
    /// Part of a file does not match the format.
    #[error("{format}, {place}: {field} is {found}, expected {expected}")]
    Malformed {
        format: &'static str,
        place: Place,
        /// The field, as named in the description of the format.
        field: String,
        /// The text found (shortened if long).
        found: String,
        expected: String,
    },
    /// The unpacked contents of a file take more memory than allowed.
    #[error(
        "{format}, {place}: with {what} the contents need {needed} bytes of memory, expected at most {limit}; a caller who trusts the file may raise the limit"
    )]
    MemoryLimit {
        format: &'static str,
        place: Place,
        /// The next part to be read (shortened if long).
        what: String,
        /// Lower bound of the memory in bytes that the contents would need, including this part.
        needed: u64,
        /// Limit in bytes, see [`MemoryLimit`](crate::format::MemoryLimit).
        limit: u64,
    },
    /// The bytes are in no known format.
    #[error("{}", unknown_format(head, *n_bytes, known))]
    UnknownFormat {
        /// The first bytes, each as a Latin-1 character.
        head: String,
        n_bytes: usize,
        /// Names of the known formats.
        known: Vec<&'static str>,
    },
    /// A series of a file cannot be a channel of a record.
    #[error(
        "series {index} (`{name}`) is not a channel of a record: its {part} is {found}, expected {expected}"
    )]
    NoChannel {
        /// Position of the series among those of the file, from 0.
        index: usize,
        name: String,
        /// The part of the series that does not suit a channel.
        part: &'static str,
        found: String,
        expected: &'static str,
    },
    /// The format cannot represent the contents to be written.
    #[error("{format} cannot hold {what}")]
    NotRepresentable {
        format: &'static str,
        /// The part of the contents that the format cannot represent.
        what: String,
    },
    /// A text is not a known unit.
    #[error("`{found}` is not a known unit: `{token}` {reason}")]
    UnknownUnit {
        found: String,
        /// The part of the text that is not understood.
        token: String,
        /// The reason why that part is not understood.
        reason: &'static str,
    },
    /// A value has an unsuitable unit.
    #[error("{what} is in {found}, expected {expected}")]
    UnitMismatch {
        what: String,
        found: String,
        /// The unit or dimension expected.
        expected: String,
    },
    /// A requested hit does not exist or cannot be used.
    #[error("hit {number} {reason}")]
    NoSuchHit {
        /// Number of the hit, from 1.
        number: usize,
        reason: &'static str,
    },
    /// A text is not a day of the calendar.
    #[error("`{found}` is not a date, expected a day such as 2026-11-21")]
    NoDate { found: String },
    /// The bytes could not be written.
    #[error("the bytes could not be written")]
    Write {
        /// The error of the operating system.
        source: io::Error,
    },
    /// The bytes could not be read.
    #[error("the bytes could not be read")]
    Read {
        /// The error of the operating system.
        source: io::Error,
    },
    /// An error in a named file.
    #[error("in {}", path.display())]
    InFile { path: PathBuf, source: Box<Self> },
}

/// Returns the error [`LabioError::Read`].
pub(crate) fn not_read(source: io::Error) -> LabioError {
    LabioError::Read { source }
}

/// Returns the error [`LabioError::Write`].
pub(crate) fn not_written(source: io::Error) -> LabioError {
    LabioError::Write { source }
}

/// Returns the error [`LabioError::NonPhysical`].
pub(crate) fn non_physical<T>(
    quantity: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<T, LabioError> {
    Err(LabioError::NonPhysical {
        quantity,
        value,
        expected,
    })
}

/// Returns the error [`LabioError::NonFiniteSample`].
pub(crate) fn non_finite_sample<T>(
    channel: impl Into<String>,
    index: usize,
    value: f64,
) -> Result<T, LabioError> {
    Err(LabioError::NonFiniteSample {
        channel: channel.into(),
        index,
        value,
    })
}

/// Accepts the samples of `channel` if all of them are finite.
pub(crate) fn check_samples<'a>(
    channel: &str,
    samples: impl IntoIterator<Item = &'a f64>,
) -> Result<(), LabioError> {
    let mut numbered = samples.into_iter().enumerate();
    match numbered.find(|(_, sample)| !sample.is_finite()) {
        None => Ok(()),
        Some((index, &value)) => non_finite_sample(channel, index, value),
    }
}

/// Returns the error [`LabioError::CountMismatch`].
pub(crate) fn count_mismatch<T>(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<T, LabioError> {
    Err(LabioError::CountMismatch {
        what,
        found,
        expected,
    })
}

/// Returns the error [`LabioError::UnitMismatch`].
pub(crate) fn unit_mismatch<T>(
    what: impl Into<String>,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> Result<T, LabioError> {
    Err(LabioError::UnitMismatch {
        what: what.into(),
        found: found.into(),
        expected: expected.into(),
    })
}

/// Returns the error [`LabioError::TooFewSamples`].
pub(crate) fn too_few_samples<T>(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<T, LabioError> {
    Err(LabioError::TooFewSamples {
        what,
        found,
        expected,
    })
}

/// Returns the error [`LabioError::TooFewAverages`].
pub(crate) fn too_few_averages<T>(
    estimate: &'static str,
    found: usize,
    expected: usize,
) -> Result<T, LabioError> {
    Err(LabioError::TooFewAverages {
        estimate,
        found,
        expected,
    })
}

/// Creates a [`LabioError::Truncated`] of the format called `format`.
pub(crate) fn truncated(format: &'static str, missing_bytes: impl TryInto<usize>) -> LabioError {
    LabioError::Truncated {
        format,
        missing_bytes: missing_bytes.try_into().unwrap_or(usize::MAX),
    }
}

/// Creates a [`LabioError::NotRepresentable`] of the format called `format`.
pub(crate) fn not_representable(format: &'static str, what: impl Into<String>) -> LabioError {
    LabioError::NotRepresentable {
        format,
        what: what.into(),
    }
}

/// Creates a [`LabioError::Malformed`] of the format called `format`.
pub(crate) fn malformed(
    format: &'static str,
    place: Place,
    field: impl Into<String>,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> LabioError {
    LabioError::Malformed {
        format,
        place,
        field: field.into(),
        found: found.into(),
        expected: expected.into(),
    }
}

/// Suggestion for a file of a known but unsupported kind, recognised by its first bytes: its kind,
/// and how to convert it to a supported one; empty for an unknown kind.
fn unknown_format(head: &str, n_bytes: usize, known: &[&str]) -> String {
    if n_bytes == 0 {
        return "the file is empty".to_owned();
    }
    format!(
        "the {n_bytes} bytes that begin with \"{}\" are not in a known format ({}){}",
        head.escape_default(),
        known.join(", "),
        way_out(head)
    )
}

fn way_out(head: &str) -> &'static str {
    const KNOWN: [(&str, &str); 9] = [
        ("\x1f\u{8b}", "; gzip: unpack it"),
        ("PK\x03\x04", "; a ZIP archive: unpack it"),
        ("7z\u{bc}\u{af}", "; a 7-Zip archive: unpack it"),
        (
            "CDF",
            "; netCDF-3: `nccopy -k nc4 old.nc new.nc` converts it to netCDF-4, which can be read",
        ),
        (
            "MDF     ",
            "; an ASAM measurement data file: export it as HDF5, MATLAB or CSV",
        ),
        ("|CF,", "; an imc file: export it as CSV or MATLAB"),
        ("SQLite format 3", "; a database: export its table as CSV"),
        ("%PDF", "; a document: export its table as CSV"),
        ("\u{89}PNG", "; an image: export its numbers as CSV"),
    ];
    let found = KNOWN.iter().find(|(begin, _)| head.starts_with(begin));
    found.map_or("", |(_, words)| words)
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Offset in bytes, from 0.
    Byte(u64),
    /// Line, from 1.
    Line(u64),
    /// Line and column of a table, both from 1.
    Cell {
        /// Line, from 1.
        line: u64,
        /// Column of the table, from 1.
        column: u64,
    },
}

impl Place {
    /// Returns the place of a cell; `column` counts from 0.
    pub(crate) fn cell(line: u64, column: usize) -> Self {
        let column = column as u64 + 1;
        Self::Cell { line, column }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Cell { line, column } => write!(f, "line {line}, column {column}"),
        }
    }
}

fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

/// Accepts the expected count.
pub(crate) fn check_count(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), LabioError> {
    if found == expected {
        Ok(())
    } else {
        count_mismatch(what, found, expected)
    }
}

/// Accepts at least the expected number of samples.
pub(crate) fn check_enough_samples(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), LabioError> {
    if found >= expected {
        Ok(())
    } else {
        too_few_samples(what, found, expected)
    }
}

/// Accepts a finite value above zero.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<f64, LabioError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        non_physical(quantity, value, "a finite value above 0")
    }
}

/// Accepts a finite value.
pub(crate) fn check_finite(quantity: &'static str, value: f64) -> Result<f64, LabioError> {
    if value.is_finite() {
        Ok(value)
    } else {
        non_physical(quantity, value, "a finite value")
    }
}

/// Accepts a finite value that is zero or above.
pub(crate) fn check_not_negative(quantity: &'static str, value: f64) -> Result<f64, LabioError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        non_physical(quantity, value, "a finite value of at least 0")
    }
}
