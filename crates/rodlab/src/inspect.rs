//! Contents of a file of any known format: channels, units, sampling, levels, and suspicions.
//!
//! ```no_run
//! let inspection = rodlab::inspect::inspect("hits.uff".as_ref())?;
//! println!("{}", inspection.to_text());
//! # Ok::<(), rodlab::RodlabError>(())
//! ```

mod levels;
mod suspicions;
mod text;
mod time_like;

pub use levels::Levels;

use std::path::Path;

use labio::format::{self, Reader, Strictness, customary_rate};
use labio::{Abscissa, ContentHash, Contents, Dimension, Ordinate, Provenance, Series, SeriesAxis};
use serde::Serialize;

use crate::digits::{prefix_for, rate, significant};
use crate::records::{is_rounded_step, step_without_unit, text_of_unit};
use crate::sheet::{Language, snake_case};
use crate::{InStep, RodlabError, cut_short, input};

/// Contents of a file.
#[derive(Debug, Clone, Serialize)]
pub struct Inspection {
    /// Path as it was given.
    pub path: String,
    /// Detected format, such as `uff58`.
    pub format: String,
    /// Number of bytes.
    pub bytes: u64,
    /// SHA-256 of the bytes, hexadecimal.
    pub sha256: String,
    /// Properties stated in the file, in the order of the file.
    pub properties: Vec<(String, String)>,
    /// Data sets, in the order of the file.
    pub series: Vec<InspectedSeries>,
    /// Records that `labio` forms from the data sets, including data sets without unit or rate.
    pub records: Vec<InspectedRecord>,
    /// Unreadable parts.
    pub defects: Vec<String>,
    /// Suspicions about the channels: clipping, lost samples, no signal, or a large offset. Levels
    /// are in SI units.
    pub suspicions: Vec<String>,
    /// Objections to each record if it is judged as one hit. Levels are in SI units.
    pub as_hits: Vec<String>,
    /// Hints, and statements that a sheet must make about the file.
    pub advice: Vec<String>,
}

/// One data set of a file.
#[derive(Debug, Clone, Serialize)]
pub struct InspectedSeries {
    /// Number in the file, from 1, for use in a sheet.
    pub number: usize,
    /// Name, empty if it has none.
    pub name: String,
    /// Kind of data, such as `time response`.
    pub kind: String,
    /// Unit as written in the file, or as it follows from other statements of the file; empty if
    /// there is none.
    pub unit: String,
    /// Physical quantity of the unit, if a channel can have this quantity.
    pub quantity: Option<String>,
    /// Number of values.
    pub samples: usize,
    /// True for complex values; the levels then refer to absolute values.
    pub complex: bool,
    /// First value of the abscissa, in its unit.
    pub from: f64,
    /// Spacing of the abscissa; `None` if it is uneven.
    pub step: Option<f64>,
    /// Unit of the abscissa as written in the file or fixed by its format; empty if unknown.
    pub abscissa_unit: String,
    /// Sampling rate \[Hz\], if the abscissa is an evenly spaced time in a known unit.
    pub sampling_rate_hz: Option<f64>,
    /// Levels, in the unit of the file; `None` if there is no finite value.
    pub levels: Option<Levels>,
    /// Number of values that are NaN or infinite.
    pub not_finite: usize,
    /// Other properties stated in the file.
    pub properties: Vec<(String, String)>,
}

/// Channels sampled together.
#[derive(Debug, Clone, Serialize)]
pub struct InspectedRecord {
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Number of samples.
    pub samples: usize,
    /// Sampling rate \[Hz\]; `None` if the file does not record it.
    pub sampling_rate_hz: Option<f64>,
    /// Duration \[s\]; `None` if the file does not record it.
    pub duration: Option<f64>,
}

/// Reads the file at `path` as far as possible, and describes its contents.
///
/// # Errors
///
/// [`RodlabError::Read`] if the file cannot be opened, [`RodlabError::Step`] if its format is
/// unknown or no part of it can be read, [`RodlabError::Request`] for a test sheet.
pub fn inspect(path: &Path) -> Result<Inspection, RodlabError> {
    let bytes = input::read(path)?;
    let name = path.display().to_string();
    inspect_bytes(&bytes, &name).map_err(|error| {
        if is_sheet(path, &bytes) {
            let expected = format!("a recording: `rodlab check {name}` reads a sheet");
            RodlabError::request(name.as_str(), "a test sheet", expected)
        } else {
            error
        }
    })
}

/// Returns true for a text that begins like a sheet and has the extension of its language.
fn is_sheet(path: &Path, bytes: &[u8]) -> bool {
    let language = std::str::from_utf8(bytes).ok().and_then(Language::of);
    let of_language = |language: Language| {
        let extension = path.extension();
        extension.is_some_and(|extension| extension == language.extension())
    };
    language.is_some_and(of_language)
}

/// Describes the contents of `bytes`; `path` is used only as a name.
///
/// # Errors
///
/// The errors of [`inspect`].
pub fn inspect_bytes(bytes: &[u8], path: &str) -> Result<Inspection, RodlabError> {
    let mut contents =
        format::read_bytes_with(bytes, Strictness::Tolerant).in_step(format!("reading {path}"))?;
    let is_table = is_table(&contents);
    let times = contents.series.first().and_then(time_like::step_of);
    // in a table, an evenly increasing column may contain row numbers instead of times
    let times = times.filter(|_| !is_table);
    // if the sheet states this sampling rate, a job reads the column as times and numbers the
    // channels from the next column
    let behind = times.and_then(|step| format::read_bytes_at(bytes, 1.0 / step).ok());
    let behind = behind.filter(|behind| behind.series.len() + 1 == contents.series.len());
    let column_of_times = times.filter(|_| behind.is_some());
    if let Some(behind) = behind {
        contents = behind;
    }
    let series: Vec<InspectedSeries> = contents
        .series
        .iter()
        .zip(1..)
        .map(|(series, number)| InspectedSeries::of(series, number))
        .collect();
    let mut advice = if is_table {
        vec![in_words(&contents)]
    } else {
        advice(&contents, &series)
    };
    if let Some(step) = column_of_times {
        advice.insert(
            0,
            format!(
                "column 1 increases evenly, like times, and channels are numbered from the next column: if it is in s, `sampling_rate` is {} Hz",
                rate(1.0 / step)
            ),
        );
    }
    // a column of times is not a channel
    contents
        .series
        .retain(|series| time_like::step_of(series).is_none());
    let of_times = suspicions::of_times(&contents.series);
    let rate_is_told = suspicions::complete(&mut contents)?;
    let mut found = contents.records(&Provenance::of_bytes(contents.format, bytes));
    if is_table {
        found.records.clear();
    }
    let records = found
        .records
        .iter()
        .map(|record| InspectedRecord {
            channels: record
                .channels()
                .iter()
                .map(|channel| channel.name().to_owned())
                .collect(),
            samples: record.n_samples(),
            sampling_rate_hz: rate_is_told.then(|| record.sampling_rate_hz()),
            duration: rate_is_told.then(|| record.duration()),
        })
        .collect();
    let (mut wrong, as_hits) = suspicions::of_records(&found.records, rate_is_told)?;
    wrong.extend(of_times);
    wrong.extend(cut_short::warning(bytes, contents.format, "the file"));
    for one in &series {
        if one.not_finite > 0 {
            wrong.push(format!(
                "{} of {} values of channel {} (`{}`) are NaN or infinite",
                one.not_finite, one.samples, one.number, one.name
            ));
        }
    }
    Ok(Inspection {
        path: path.to_owned(),
        format: contents.format.to_owned(),
        bytes: bytes.len() as u64,
        sha256: ContentHash::of(bytes).to_string(),
        properties: contents.properties,
        series,
        records,
        defects: contents.defects.iter().map(ToString::to_string).collect(),
        suspicions: wrong,
        as_hits,
        advice,
    })
}

impl InspectedSeries {
    fn of(series: &Series, number: usize) -> Self {
        let (levels, not_finite) = Levels::of(&series.ordinate);
        let (from, step) = match &series.abscissa {
            Abscissa::Even { start, step } => (*start, Some(*step)),
            Abscissa::Uneven(values) => (values.first().copied().unwrap_or(f64::NAN), None),
        };
        let time = series
            .abscissa_axis
            .unit
            .as_ref()
            .filter(|unit| unit.dimension() == Dimension::TIME);
        Self {
            number,
            name: series.name.trim().to_owned(),
            kind: snake_case(&format!("{:?}", series.kind)).replace('_', " "),
            unit: text_of_unit(&series.ordinate_axis).to_owned(),
            quantity: series
                .ordinate_axis
                .unit
                .as_ref()
                .and_then(labio::Unit::quantity)
                .map(|quantity| quantity.name().to_owned()),
            samples: series.ordinate.len(),
            complex: matches!(series.ordinate, Ordinate::Complex(_)),
            from,
            step,
            abscissa_unit: match (series.abscissa_axis.unit_text.as_str(), time) {
                ("", Some(unit)) => unit.symbol().to_owned(),
                (text, _) => text.to_owned(),
            },
            sampling_rate_hz: time
                .zip(step.filter(|step| *step > 0.0))
                .map(|(unit, step)| 1.0 / unit.to_si(step)),
            levels,
            not_finite,
            properties: series.properties.clone(),
        }
    }
}

/// Returns true if the series are columns of a table, not time histories: at least two columns in
/// Pa together with frequencies, or, in a text or spreadsheet file, columns of frequencies or
/// temperatures and no times.
fn is_table(contents: &Contents) -> bool {
    let of = |axis: &SeriesAxis, symbol: &str| {
        let expected = labio::Unit::parse(symbol).map(|unit| unit.dimension());
        let unit = axis.unit.as_ref().zip(expected.ok());
        unit.is_some_and(|(unit, dimension)| unit.dimension() == dimension)
    };
    let all = &contents.series;
    let count = |symbol: &str| {
        let columns = all.iter().filter(|s| of(&s.ordinate_axis, symbol));
        columns.count()
    };
    let is_over = |symbol: &str| all.iter().any(|s| of(&s.abscissa_axis, symbol));
    let is_of_moduli = count("Pa") >= 2 && (count("Hz") > 0 || is_over("Hz"));
    let is_tabular = format::reader(contents.format).is_some_and(Reader::reads_tables);
    is_of_moduli || (is_tabular && !is_over("s") && count("Hz") + count("K") > 0)
}

/// Describes a table in words, and names the job that reads it.
fn in_words(contents: &Contents) -> String {
    let first = contents.series.first();
    let abscissa = first
        .map(|series| &series.abscissa_axis)
        .filter(|axis| axis.label != "index");
    let columns = contents.series.iter().map(|series| &series.ordinate_axis);
    let units: Vec<&str> = abscissa
        .into_iter()
        .chain(columns)
        .map(|axis| match axis.unit_text.as_str() {
            "" => "-",
            unit => unit,
        })
        .collect();
    let n_rows = contents.series.iter().map(|series| series.ordinate.len());
    format!(
        "a table of {} columns ({}) and {} rows, not a recording: `rodlab fit` reads it by the names of its columns (`rodlab init fit`); \
         a recording needs `sampling_rate` in the sheet",
        units.len(),
        units.join(", "),
        n_rows.max().unwrap_or(0)
    )
}

/// Returns sentences about missing units and sampling rates, which a sheet must state, and about
/// sampling rates that may have been rounded.
fn advice(contents: &Contents, inspected: &[InspectedSeries]) -> Vec<String> {
    let mut advice = Vec::new();
    let numbers = |is: &dyn Fn(&Series) -> bool| -> Vec<String> {
        let all = contents.series.iter().zip(1_usize..);
        all.filter(|(series, _)| is(series))
            .map(|(_, number)| number.to_string())
            .collect()
    };
    let without_time = numbers(&|series| series.abscissa_axis.unit.is_none());
    if !without_time.is_empty() {
        advice.push(format!(
            "the file does not state the sampling rate of {}: state `sampling_rate` in the sheet",
            channels(&without_time)
        ));
    }
    if let Some(step) = contents.series.iter().find_map(step_without_unit) {
        let rate_hz = 1.0 / step;
        let told = if contents.defects.iter().any(is_rounded_step) {
            let (size, prefix) = prefix_for(rate_hz, "Hz");
            format!(
                "about {} {prefix}Hz, from rounded times: state the recorder's rate",
                significant(rate_hz / size, 2)
            )
        } else {
            format!("{} Hz", rate(rate_hz))
        };
        advice.push(format!(
            "the times have no unit: if they are in s, `sampling_rate` is {told}"
        ));
    }
    for (series, number) in contents.series.iter().zip(1_usize..) {
        if let Some(step) = time_like::step_of(series) {
            advice.push(format!(
                "channel {number} increases evenly, like times: if they are in s, `sampling_rate` is {} Hz",
                rate(1.0 / step)
            ));
        }
    }
    let without_unit = numbers(&|series| {
        series.ordinate_axis.unit.is_none() && time_like::step_of(series).is_none()
    });
    if !without_unit.is_empty() {
        advice.push(format!(
            "the file does not state a known unit of {}: state `unit` in the sheet",
            channels(&without_unit)
        ));
    }
    let mut rates: Vec<String> = inspected
        .iter()
        .filter_map(|series| {
            let (step, rate_hz) = series.step.zip(series.sampling_rate_hz)?;
            let rate = rounded_from(step, rate_hz)?;
            Some(format!(
                "the step of {step} {} may be a rounded {} Hz: a sheet can state `sampling_rate`",
                series.abscissa_unit, rate
            ))
        })
        .collect();
    rates.dedup();
    advice.extend(rates);
    advice
}

/// Returns channel numbers in words: `channel 1`, or `channels 1, 2`.
fn channels(numbers: &[String]) -> String {
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("channel{plural} {}", text::listed(numbers))
}

/// Returns the customary sampling rate \[Hz\] whose reciprocal, rounded, may be `step`. `step` is
/// in the unit of the file, and its reciprocal is `rate_hz` in Hz. Returns `None` if there is no
/// such rate, or if it equals `rate_hz`.
fn rounded_from(step: f64, rate_hz: f64) -> Option<f64> {
    let text = format!("{step:e}");
    let (digits, exponent) = text.split_once('e')?;
    let decimals = digits
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    // a step with more than seven significant digits is not a rounded one
    if decimals > 6 {
        return None;
    }
    let exponent: i32 = exponent.parse().ok()?;
    let half_unit = 0.5 * 10.0_f64.powi(exponent - i32::try_from(decimals).ok()?);
    let rate = customary_rate(1.0 / rate_hz, half_unit / (step * rate_hz))?.rate_hz;
    ((rate / rate_hz - 1.0).abs() > 1e-12).then_some(rate)
}
