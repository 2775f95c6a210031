//! Conversion of a file to another format.
//!
//! No value is left out: a format that cannot store the values of the source is refused. The
//! written file is read back and compared with its source. The losses are listed: names, units and
//! notes that the new format cannot store, and numbers that it stores with fewer digits.

mod differences;
mod fit;

pub(crate) use fit::fitted;

use std::path::Path;

use labio::Contents;
use labio::format::mat5::Mat5;
use labio::format::npy::Npy;
use labio::format::npz::Npz;
use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58Writer};
use labio::format::wav::{WavEncoding, WavWriter};
use labio::format::{self, Strictness, Writer, csv::Csv};
use serde::Serialize;

use crate::digits::rate;
use crate::records::state_rate;
use crate::{InStep, RodlabError, cut_short, input, output};

/// Options of a conversion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConvertOptions {
    /// True to convert the readable part of a damaged file, and to list the unreadable parts.
    pub tolerant: bool,
    /// True to refuse a conversion with any loss.
    pub lossless: bool,
    /// True to write a universal file with IEEE numbers (58b), which keeps every bit, instead of
    /// text.
    pub binary: bool,
    /// True to replace an existing output.
    pub force: bool,
    /// Sampling rate \[Hz\] of the time histories, if the file does not state it, or states it
    /// rounded (by less than 0.1 %).
    pub rate_hz: Option<f64>,
}

/// A converted file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Conversion {
    /// Format of the source.
    pub from: String,
    /// Format of the new file.
    pub to: String,
    /// Number of data sets.
    pub n_series: usize,
    /// Number of bytes written.
    pub bytes: u64,
    /// Parts of the source that could not be read.
    pub not_read: Vec<String>,
    /// Warnings about the source.
    pub warnings: Vec<String>,
    /// Losses: contents that the new file lacks or stores with fewer digits.
    pub lost: Vec<String>,
}

impl Conversion {
    /// Returns the conversion as text; `input` and `output` are used only as names.
    #[must_use]
    pub fn to_text(&self, input: &Path, output: &Path) -> String {
        let sets = if self.n_series == 1 {
            "data set"
        } else {
            "data sets"
        };
        let mut text = format!(
            "{} ({}) -> {} ({}): {} {sets}, {} bytes\n",
            input.display(),
            self.from,
            output.display(),
            self.to,
            self.n_series,
            self.bytes
        );
        for (heading, lines) in [
            ("suspicious:", &self.warnings),
            ("not read:", &self.not_read),
            ("lost:", &self.lost),
        ] {
            if !lines.is_empty() {
                text += &format!("{heading}\n");
                for line in lines {
                    text += &format!("  {line}\n");
                }
            }
        }
        text
    }
}

/// File extensions with their formats.
const ENDINGS: [(&str, &str); 9] = [
    ("csv", "csv"),
    ("mat", "mat5"),
    ("npy", "npy"),
    ("npz", "npz"),
    ("txt", "csv"),
    ("uff", "uff58"),
    ("unv", "uff58"),
    ("uf", "uff58"),
    ("wav", "wav"),
];

/// Reads `input`, whatever its name, and writes it to `output` in the format of its extension:
/// `csv`, `txt`, `mat`, `npy`, `npz`, `uff`, `unv`, `uf` or `wav`. The new file appears complete or
/// not at all. An existing output is replaced only with the option `force`; the input is never
/// replaced.
///
/// # Errors
///
/// [`RodlabError::Read`] or [`RodlabError::Write`] for a file that cannot be opened or written;
/// [`RodlabError::Step`] if the content of the source cannot be read, or the new format cannot hold
/// its values; [`RodlabError::Request`] for an existing output, an unknown extension, an unwanted
/// loss, `output` equal to `input`, or a sampling rate that contradicts that of the file or that a
/// WAV file needs and nothing states.
pub fn convert(
    input: &Path,
    output: &Path,
    options: ConvertOptions,
) -> Result<Conversion, RodlabError> {
    let format = format_of(output)?;
    if let (Ok(source), Ok(target)) = (input.canonicalize(), output.canonicalize())
        && source == target
    {
        return Err(RodlabError::request(
            "the output",
            format!("{}, which is the input", output.display()),
            "another file",
        ));
    }
    if !options.force && output.symlink_metadata().is_ok() {
        return Err(is_there(output));
    }
    let bytes = input::read(input)?;
    let contents = contents_of(&bytes, input, options)?;
    let mut series = contents.series.iter();
    if format == "wav" && series.any(|series| series.abscissa_axis.unit.is_none()) {
        return Err(RodlabError::request(
            format!("the sampling rate of {}", input.display()),
            "not stated in the file",
            "`--rate` with the rate, such as `--rate 51.2kHz`: a WAV file states it",
        ));
    }
    let fitted = fitted(&contents, format);
    let writing = |error| RodlabError::step(format!("converting to {format}"), error);
    let mut written = Vec::new();
    writer(format, options)
        .write(&fitted, &mut written)
        .map_err(writing)?;
    let back = format::read_bytes(&written).map_err(writing)?;
    let lost = differences::between(&contents, &back);
    if options.lossless && !lost.is_empty() {
        return Err(RodlabError::request(
            format!("the conversion of {} to {format}", input.display()),
            format!("not without loss ({})", lost.join("; ")),
            "another format, or no --lossless",
        ));
    }
    if options.force {
        output::write_whole(output, &written)?;
    } else {
        output::write_new(output, &written).map_err(|error| match error {
            RodlabError::Exists { path } => is_there(&path),
            error => error,
        })?;
    }
    Ok(Conversion {
        from: contents.format.to_owned(),
        to: format.to_owned(),
        n_series: contents.series.len(),
        bytes: written.len() as u64,
        warnings: cut_short::warning(&bytes, contents.format, "the file")
            .into_iter()
            .collect(),
        not_read: contents.defects.iter().map(ToString::to_string).collect(),
        lost,
    })
}

/// Returns the contents of the file `input`, with the sampling rate of the options.
fn contents_of(
    bytes: &[u8],
    input: &Path,
    options: ConvertOptions,
) -> Result<Contents, RodlabError> {
    let mut contents = match (options.rate_hz, options.tolerant) {
        (_, true) => format::read_bytes_with(bytes, Strictness::Tolerant),
        (Some(rate_hz), false) => format::read_bytes_at(bytes, rate_hz),
        (None, false) => format::read_bytes(bytes),
    }
    .in_step(format!("reading {}", input.display()))?;
    if let Some(rate_hz) = options.rate_hz {
        let file = input.display().to_string();
        for series in &mut contents.series {
            let text = format!("{} Hz", rate(rate_hz));
            state_rate(series, (rate_hz, &text), "`--rate`", (&file, "no `--rate`"))?;
            let axis = &mut series.abscissa_axis;
            if axis.label == "index" && axis.unit.is_some() {
                "Time".clone_into(&mut axis.label);
            }
        }
    }
    Ok(contents)
}

/// Returns the error for an output that exists and must not be replaced.
fn is_there(output: &Path) -> RodlabError {
    RodlabError::request(
        "the output",
        format!("{}, which exists already", output.display()),
        "a new file, or --force to replace it",
    )
}

fn format_of(output: &Path) -> Result<&'static str, RodlabError> {
    let ending = output
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    ENDINGS
        .iter()
        .find(|(known, _)| *known == ending)
        .map(|(_, format)| *format)
        .ok_or_else(|| {
            let known: Vec<&str> = ENDINGS.iter().map(|(ending, _)| *ending).collect();
            RodlabError::request(
                "the extension of the output",
                format!("`{ending}`"),
                format!("one of {}", known.join(", ")),
            )
        })
}

fn writer(format: &str, options: ConvertOptions) -> Box<dyn Writer> {
    match format {
        "csv" => Box::new(Csv),
        "mat5" => Box::new(Mat5),
        "npy" => Box::new(Npy),
        "npz" => Box::new(Npz),
        "wav" => Box::new(WavWriter {
            encoding: WavEncoding::Float64,
        }),
        _ => Box::new(Uff58Writer {
            encoding: if options.binary {
                Encoding::Binary(ByteOrder::LittleEndian)
            } else {
                Encoding::Ascii
            },
            precision: Precision::Double,
        }),
    }
}
