//! Measured data: a ratio of spectra, spectra of gauges or modes, with their errors.

mod file;
mod hits;
mod pulses;
mod vibration;

use cmod::estimate::ComplexCovariance;
use cmod::multi_point::Quantity;
use cmod::self_calibration::lines_per_independent_line;
use labio::ratio::add_random_errors;
use labio::{LabioError, Record, ResponseRatio, SectionSpectra, SensorError};
use num_complex::Complex64;
use rodfigure::Figure;
use serde::Deserialize;

use super::ModulusSheet;
use super::gauges::Damping;
use super::method::FromHits;
use crate::digits::significant;
use crate::draw::Draw;
use crate::hits::HitsSheet;
use crate::job::JobContext;
use crate::job::frf::ExponentialWindowSheet;
use crate::outcome::Setting;
use crate::outcome::{InputFile, LogEntry, Table};
use crate::records::{Records, Selector};
use crate::sheet::{BandSheet, Duration, Exact, Ratio as RatioKind};
use crate::{InStep, RodlabError};
use vibration::Modes;

/// Source of the spectra.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::large_enum_variant,
    reason = "a sheet contains only one of these"
)]
pub enum SourceSheet {
    /// Records of hits.
    Hits {
        /// The files and channels.
        records: Records,
        /// Cutting and criteria of the hits; by default each record is a hit, judged by the usual
        /// criteria.
        #[serde(default)]
        hits: HitsSheet,
        /// Silence of each record before the impact, such as `"2 ms"`. The noise is measured in it;
        /// methods with gauges need it. By default, for hits cut by a trigger, the pre-trigger less
        /// 0.2 ms, or less a fifth of the pre-trigger if that is shorter than 0.2 ms.
        #[serde(default)]
        silent: Option<Exact<Duration>>,
        /// Exponential window on all gauges from the end of the silence on, for rods that ring
        /// longer than the record; only with `MultiPoint`. By default, hits that end while the rod
        /// rings get as much damping as they need.
        #[serde(default)]
        exponential_window: Option<ExponentialWindowSheet>,
        /// Treatment of the end of hits that are at rest for three quarters of their length or
        /// more; `LeaveOut` by default.
        #[serde(default)]
        tail: TailSheet,
    },
    /// A ratio of spectra computed by another program.
    Ratio(RatioSheet),
}

/// Treatment of the samples after the motion of a hit has ended, which contain only noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum TailSheet {
    /// Left out, which gives fewer lines that are further apart and have less noise. Hits that are
    /// cut by a trigger keep their length.
    #[default]
    LeaveOut,
    /// Kept.
    Keep,
}

/// A ratio of spectra in a file, over a column of frequencies with its unit.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RatioSheet {
    /// Name of the file, relative to the sheet.
    pub path: String,
    /// Ratio of the impacted end to the free end, of the first section to the second, or of the
    /// later pulse to the earlier pulse.
    pub values: RatioValues,
    /// Errors of the ratio.
    pub errors: RatioErrors,
}

/// Place of the ratio in its file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RatioValues {
    /// A column, or a data set, of complex numbers.
    Complex(
        /// The column, by name or by number from 1, not counting the column of frequencies.
        Selector,
    ),
    /// Two columns.
    Parts {
        /// Real part.
        real: Selector,
        /// Imaginary part.
        imaginary: Selector,
    },
}

/// Errors of a ratio.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RatioErrors {
    /// The ordinary coherence of several hits.
    Coherence {
        /// Column of the coherence.
        column: Selector,
        /// Number of hits, or effective number of averages.
        averages: f64,
    },
    /// A column of the standard error of the complex value: the root of the sum of the variances of
    /// its two parts.
    StandardError {
        /// The column.
        column: Selector,
    },
    /// A standard error that is the same fraction of the value on all lines, such as `"0.1 %"`.
    Relative {
        /// The fraction.
        of_value: Exact<RatioKind>,
    },
}

/// Ratio of the upper end of a band to the highest line above which lines count as missing.
const LEFT_OUT: f64 = 1.02;

/// Spectra or modes to which a method is applied.
pub(super) enum Spectra {
    Ratio(ResponseRatio),
    Gauges(SectionSpectra),
    Modes(Modes),
}

/// Measured data with their source.
#[derive(Default)]
pub(super) struct Measured {
    /// Spectra or modes; `None` if the hits do not give any, for the reason `missing`.
    pub(super) spectra: Option<Spectra>,
    pub(super) missing: String,
    pub(super) inputs: Vec<InputFile>,
    pub(super) log: Vec<LogEntry>,
    pub(super) figures: Vec<Figure>,
    /// Sentences about the hits.
    pub(super) in_words: Vec<String>,
    pub(super) warnings: Vec<String>,
    /// Quantities of the channels of the hits.
    pub(super) quantities: Vec<(String, Quantity)>,
    /// The first accepted hit, for checks of arrivals, if its silence is known.
    pub(super) first_hit: Option<FirstHit>,
    /// Sampling rate of the hits \[Hz\]; unknown for a ratio in a file.
    pub(super) sampling_rate_hz: Option<f64>,
    /// Pairs of hits that may be the same measurement, and hits that depart from the others.
    pub(super) doubts: Vec<String>,
    /// Spectra of each accepted hit alone; empty if the method uses all hits together.
    pub(super) each: Vec<Spectra>,
    /// Clauses about windows that cut off a part of a pulse.
    pub(super) cut_pulses: Vec<String>,
    /// Numbers of the accepted hits, counted from 0 over all hits that were found.
    pub(super) accepted: Vec<usize>,
    /// Number of hits that were found.
    pub(super) n_found: usize,
}

/// A hit that begins with silence.
pub(super) struct FirstHit {
    pub(super) record: Record,
    /// Number of silent samples.
    pub(super) silent: usize,
    /// Sample at which the trigger fired, if there was one.
    pub(super) trigger: Option<usize>,
}

pub(super) fn of(
    sheet: &ModulusSheet,
    context: &JobContext<'_>,
    settings: &mut Vec<Setting>,
) -> Result<Measured, RodlabError> {
    let mut measured = match &sheet.source {
        SourceSheet::Hits {
            records,
            hits,
            silent,
            exponential_window,
            tail,
        } => {
            let damping = damping(sheet, exponential_window.as_ref())?;
            hits::of_hits(
                sheet,
                (records, hits, silent.as_ref(), &damping, *tail),
                context,
                settings,
            )?
        }
        SourceSheet::Ratio(ratio) => file::of_file(sheet, ratio, context, settings)?,
    };
    if let Some(spectra) = &mut measured.spectra {
        measured
            .warnings
            .extend(spectra.missing_of(sheet.band.as_ref()));
        spectra.cut(sheet.band.as_ref())?;
        for spectra in &mut measured.each {
            spectra.cut(sheet.band.as_ref())?;
        }
        if let Some(draw) = &context.draw {
            spectra.add(draw).in_step("errors of the spectra")?;
        }
    }
    Ok(measured)
}

/// Returns the damping that is added to the hits before their transform.
fn damping(
    sheet: &ModulusSheet,
    window: Option<&ExponentialWindowSheet>,
) -> Result<Damping, RodlabError> {
    let may_ring = matches!(
        sheet.method.taken_from_hits(),
        FromHits::Gauges { may_ring: true, .. }
    );
    match (may_ring, window) {
        (true, Some(window)) => Ok(Damping::Window(window.clone())),
        (true, None) => Ok(Damping::OfRinging {
            lowest_hz: sheet.band.as_ref().map_or(0.0, |band| band.from.si()),
        }),
        (false, None) => Ok(Damping::None),
        (false, Some(window)) => Err(RodlabError::request(
            "source.hits.exponential_window",
            window.to_string(),
            format!(
                "none with {}: only MultiPoint corrects the modulus for the window",
                sheet.method.name()
            ),
        )),
    }
}

impl Measured {
    /// Returns the errors that all lines of the ratio share; none without a ratio.
    pub(super) fn of_ratio(&self) -> SensorError {
        match &self.spectra {
            Some(Spectra::Ratio(ratio)) => ratio.common,
            _ => SensorError::default(),
        }
    }

    /// Returns the errors of the sensor of each gauge; empty without gauges.
    pub(super) fn of_gauges(&self) -> &[SensorError] {
        match &self.spectra {
            Some(Spectra::Gauges(gauges)) => &gauges.sensors,
            _ => &[],
        }
    }
}

impl Spectra {
    pub(super) fn frequency_hz(&self) -> &[f64] {
        match self {
            Self::Ratio(ratio) => &ratio.frequency_hz,
            Self::Gauges(gauges) => &gauges.frequency_hz,
            Self::Modes(modes) => &modes.frequency_hz,
        }
    }

    /// Returns the ratio on each line; `None` for gauges and modes.
    pub(super) fn ratios(&self) -> Option<&[Complex64]> {
        match self {
            Self::Ratio(ratio) => Some(&ratio.values),
            Self::Gauges(_) | Self::Modes(_) => None,
        }
    }

    /// Returns the number of lines divided by the number of lines with independent noise.
    pub(super) fn lines_per_independent_line(&self) -> f64 {
        match self {
            Self::Ratio(ratio) => ratio.lines_per_independent_line,
            Self::Gauges(gauges) => {
                lines_per_independent_line(&gauges.frequency_hz, gauges.decay_rate())
            }
            Self::Modes(_) => 1.0,
        }
    }

    /// Adds drawn random errors.
    fn add(&mut self, draw: &Draw) -> Result<(), LabioError> {
        let shared = self.lines_per_independent_line();
        let add = |values: &mut [Complex64], mean_squares: &[f64]| {
            draw.with_random(|random| add_random_errors(values, mean_squares, shared, random))
        };
        match self {
            Self::Ratio(ratio) => add(&mut ratio.values, &ratio.variance)?,
            Self::Gauges(gauges) => {
                let square = |noise: &Vec<f64>| noise.iter().map(|noise| noise * noise).collect();
                let noise: Vec<Vec<f64>> = gauges.noise.iter().map(square).collect();
                for test in &mut gauges.tests {
                    for (lines, noise) in test.iter_mut().zip(&noise) {
                        add(lines, noise)?;
                    }
                }
            }
            Self::Modes(modes) => {
                for pole in &mut modes.poles {
                    let covariance = ComplexCovariance::circular(pole.variance);
                    pole.s += draw.with_random(|random| covariance.draw(random));
                }
            }
        }
        Ok(())
    }

    /// Returns a warning if the spectra end more than 2 % below the upper end of the band.
    fn missing_of(&self, band: Option<&BandSheet>) -> Option<String> {
        let band = band?;
        let highest = *match self {
            Self::Ratio(ratio) => ratio.frequency_hz.last(),
            Self::Gauges(gauges) => gauges.frequency_hz.last(),
            Self::Modes(_) => None,
        }?;
        (band.to.si() > LEFT_OUT * highest).then(|| {
            format!(
                "The band ends at {}, but the spectra end at {} Hz: there is no modulus above it.",
                band.to,
                significant(highest, 5)
            )
        })
    }

    /// Keeps the lines of the band or, without a band, all lines above 0 Hz.
    fn cut(&mut self, band: Option<&BandSheet>) -> Result<(), RodlabError> {
        let all = self.frequency_hz();
        let (from, to) = match band {
            Some(band) => (
                all.partition_point(|f| *f < band.from.si()),
                all.partition_point(|f| *f <= band.to.si()),
            ),
            None => (all.partition_point(|f| *f <= 0.0), all.len()),
        };
        if let Some(band) = band.filter(|band| band.from.si() >= band.to.si()) {
            return Err(RodlabError::request(
                "band",
                format!("from {} to {}", band.from, band.to),
                "`from` below `to`",
            ));
        }
        if from >= to {
            let (first, last) = (all.first(), all.last());
            return Err(RodlabError::request(
                "band",
                band.map_or("not stated".to_owned(), |band| {
                    format!("{} to {}", band.from, band.to)
                }),
                format!(
                    "a band with lines, which are between {} and {} Hz",
                    first.copied().unwrap_or(f64::NAN),
                    last.copied().unwrap_or(f64::NAN)
                ),
            ));
        }
        match self {
            Self::Ratio(ratio) => ratio.keep(from, to),
            Self::Gauges(gauges) => gauges.keep(from, to),
            Self::Modes(modes) => {
                keep(&mut modes.frequency_hz, from, to);
                keep(&mut modes.poles, from, to);
            }
        }
        Ok(())
    }
}

fn keep<T>(values: &mut Vec<T>, from: usize, to: usize) {
    values.truncate(to);
    values.drain(..from.min(values.len()));
}

/// Returns the table of the ratio or the modes from which the modulus was determined.
pub(super) fn table(spectra: &Spectra) -> Option<Table> {
    let ratio = match spectra {
        Spectra::Ratio(ratio) => ratio,
        Spectra::Modes(modes) => return Some(modes.table()),
        Spectra::Gauges(_) => return None,
    };
    let table = Table::new("ratio", "Ratio of spectra")
        .numbers("frequency", "Hz", &ratio.frequency_hz)
        .numbers("real part", "", ratio.values.iter().map(|r| r.re))
        .numbers("imaginary part", "", ratio.values.iter().map(|r| r.im))
        .numbers(
            "standard error",
            "",
            ratio.variance.iter().map(|v| v.sqrt()),
        );
    Some(match &ratio.coherence {
        Some(coherence) => table.numbers("coherence", "", coherence),
        None => table,
    })
}
