//! What was measured: ratios of spectra or spectra of gauges, with their errors.

mod file;
mod hits;
mod shot;

pub(super) use hits::averaged_ratio;
pub(super) use shot::{Shot, ShotChannel};

use cmod::estimate::VarianceFreedom;
use cmod::multi_point::Quantity;
use cmod::self_calibration::lines_per_independent_line;
use labio::Record;
use num_complex::Complex64;
use serde::Deserialize;

use super::gauges::Damping;
use super::method::MethodSheet;
use super::{ModulusSheet, gauges};
use crate::RodlabError;
use crate::chosen::Chosen;
use crate::figure::Figure;
use crate::hits::HitsSheet;
use crate::job::Surroundings;
use crate::job::frf::{BandSheet, ExponentialWindowSheet};
use crate::outcome::{Column, InputFile, LogEntry, Table};
use crate::records::{Records, Selector};
use crate::sheet::{Duration, Exact, Ratio as RatioKind};

/// Where the spectra come from.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::large_enum_variant, reason = "there is one of them in a sheet")]
pub enum SourceSheet {
    /// Records of hits.
    Hits {
        /// The files and channels.
        records: Records,
        /// How they are cut and judged; by default each record is a hit that is judged by the usual criteria.
        #[serde(default)]
        hits: HitsSheet,
        /// How long each hit's record is silent before the blow, as `"2 ms"`: there the noise is read, which gauges need. By default
        /// the pre-trigger but for 0.2 ms, or for a fifth of it if that is less, where hits are cut by a trigger.
        #[serde(default)]
        silent: Option<Exact<Duration>>,
        /// Lets all gauges fall exponentially from the end of the silence on, for rods that ring longer than the record: `MultiPoint` takes it. By default
        /// hits that end while the rod rings have as much as they need.
        #[serde(default)]
        exponential_window: Option<ExponentialWindowSheet>,
    },
    /// A ratio of spectra that another program has made.
    Ratio(RatioSheet),
}

/// A ratio of spectra in a file, over a column of frequencies with its unit.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RatioSheet {
    /// Name of the file, relative to the sheet.
    pub path: String,
    /// The ratio: impacted end by free end, first section by second, later pulse by earlier.
    pub values: RatioValues,
    /// How well it is known.
    pub errors: RatioErrors,
}

/// Where the ratio stands in its file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RatioValues {
    /// A column, or a data set, of complex numbers.
    Complex(
        /// By name, or by number from 1 without that of the frequencies.
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

/// How well a ratio is known.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RatioErrors {
    /// By the ordinary coherence of several hits.
    Coherence {
        /// Column of the coherence.
        column: Selector,
        /// Number of hits, or effective number of averages.
        averages: f64,
    },
    /// By the standard error of the complex value, real and imaginary part together, a column.
    StandardError {
        /// The column.
        column: Selector,
    },
    /// By a standard error that is the same part of the value on all lines, as `"0.1 %"`.
    Relative {
        /// That part.
        of_value: Exact<RatioKind>,
    },
}

/// What goes into a method.
pub(super) enum Spectra {
    Ratio(Ratio),
    Gauges(gauges::Gauges),
}

/// A ratio of spectra; all arrays have one entry a line.
pub(super) struct Ratio {
    pub(super) frequency_hz: Vec<f64>,
    pub(super) values: Vec<Complex64>,
    /// E|δΨ|².
    pub(super) variance: Vec<f64>,
    pub(super) coherence: Option<Vec<f64>>,
    /// Number of averages behind the coherence.
    pub(super) averages: Option<f64>,
    /// Degrees of freedom of the variances, where they are from hits or a coherence.
    pub(super) freedom: Option<Vec<VarianceFreedom>>,
    /// Lines by lines whose noise is independent.
    pub(super) lines_per_independent_line: f64,
    /// Delay of the numerator behind the denominator, where both are pulses \[s\].
    pub(super) delay: Option<f64>,
}

/// What was read, with its history.
pub(super) struct Measured {
    /// `None` if the hits do not give any; then `missing` says why.
    pub(super) spectra: Option<Spectra>,
    pub(super) missing: String,
    pub(super) inputs: Vec<InputFile>,
    pub(super) log: Vec<LogEntry>,
    pub(super) figures: Vec<Figure>,
    /// Sentences on the hits.
    pub(super) in_words: Vec<String>,
    pub(super) warnings: Vec<String>,
    /// What the channels of the hits measure.
    pub(super) quantities: Vec<(String, Quantity)>,
    /// The first accepted hit, for checks of arrivals, where it is known how long it is silent.
    pub(super) first_hit: Option<FirstHit>,
    /// What is uncertain of the sensors of the channels, in the order of the method.
    pub(super) sensors: Vec<SensorError>,
    /// Rate of the hits \[Hz\]; unknown of a ratio in a file.
    pub(super) sampling_rate_hz: Option<f64>,
    /// Hits that may be one measurement.
    pub(super) doubts: Vec<String>,
}

/// Standard uncertainties of the chain of one sensor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SensorError {
    /// Of its sensitivity, relative.
    pub(super) gain: f64,
    /// Of its time skew \[s\].
    pub(super) delay: f64,
}

/// A hit that begins with silence.
pub(super) struct FirstHit {
    pub(super) record: Record,
    /// Number of silent samples.
    pub(super) silent: usize,
    /// Sample on which the trigger fired, if there was one.
    pub(super) trigger: Option<usize>,
}

pub(super) fn of(
    sheet: &ModulusSheet,
    around: &Surroundings<'_>,
    chosen: &mut Chosen,
) -> Result<Measured, RodlabError> {
    let mut measured = match &sheet.source {
        SourceSheet::Hits {
            records,
            hits,
            silent,
            exponential_window,
        } => {
            let damping = damping(sheet, exponential_window.as_ref())?;
            hits::of_hits(
                sheet,
                (records, hits, silent.as_ref(), &damping),
                around,
                chosen,
            )?
        }
        SourceSheet::Ratio(ratio) => file::of_file(sheet, ratio, around, chosen)?,
    };
    if let Some(spectra) = &mut measured.spectra {
        spectra.cut(sheet.band.as_ref())?;
    }
    Ok(measured)
}

/// Damping that is added to the hits before their transform.
fn damping(
    sheet: &ModulusSheet,
    window: Option<&ExponentialWindowSheet>,
) -> Result<Damping, RodlabError> {
    match (&sheet.method, window) {
        (MethodSheet::MultiPoint { .. }, Some(window)) => Ok(Damping::Window(window.clone())),
        (MethodSheet::MultiPoint { .. }, None) => Ok(Damping::OfRinging {
            lowest_hz: sheet.band.as_ref().map_or(0.0, |band| band.from.si()),
        }),
        (_, None) => Ok(Damping::None),
        (method, Some(window)) => Err(RodlabError::request(
            "source.exponential_window",
            window.to_string(),
            format!(
                "none with {}: only MultiPoint takes it off again",
                method.name()
            ),
        )),
    }
}

impl Measured {
    /// What the sensors leave uncertain of the ratio of two channels: they are independent of each other, and one channel alone has nothing.
    pub(super) fn of_ratio(&self) -> SensorError {
        match self.sensors.as_slice() {
            [_] => SensorError::default(),
            several => several
                .iter()
                .fold(SensorError::default(), |sum, own| SensorError {
                    gain: sum.gain.hypot(own.gain),
                    delay: sum.delay.hypot(own.delay),
                }),
        }
    }

    /// What a channel of the hits measures.
    pub(super) fn quantity_of(&self, channel: &str) -> Option<Quantity> {
        let found = self.quantities.iter().find(|(name, _)| name == channel);
        found.map(|(_, quantity)| *quantity)
    }
}

impl Spectra {
    pub(super) fn frequency_hz(&self) -> &[f64] {
        match self {
            Self::Ratio(ratio) => &ratio.frequency_hz,
            Self::Gauges(gauges) => &gauges.frequency_hz,
        }
    }

    /// Lines by lines whose noise is independent.
    pub(super) fn lines_per_independent_line(&self) -> f64 {
        match self {
            Self::Ratio(ratio) => ratio.lines_per_independent_line,
            Self::Gauges(gauges) => {
                lines_per_independent_line(&gauges.frequency_hz, gauges.decay_rate())
            }
        }
    }

    /// Leaves the lines of the band, or all above 0 Hz.
    fn cut(&mut self, band: Option<&BandSheet>) -> Result<(), RodlabError> {
        let all = self.frequency_hz();
        let (from, to) = match band {
            Some(band) => (
                all.partition_point(|f| *f < band.from.si()),
                all.partition_point(|f| *f <= band.to.si()),
            ),
            None => (all.partition_point(|f| *f <= 0.0), all.len()),
        };
        if from >= to {
            let (first, last) = (all.first(), all.last());
            return Err(RodlabError::request(
                "band",
                band.map_or("not stated".to_owned(), |band| {
                    format!("{} to {}", band.from, band.to)
                }),
                format!(
                    "a band with lines, which lie between {} and {} Hz",
                    first.copied().unwrap_or(f64::NAN),
                    last.copied().unwrap_or(f64::NAN)
                ),
            ));
        }
        match self {
            Self::Ratio(ratio) => {
                keep(&mut ratio.frequency_hz, from, to);
                keep(&mut ratio.values, from, to);
                keep(&mut ratio.variance, from, to);
                if let Some(coherence) = &mut ratio.coherence {
                    keep(coherence, from, to);
                }
                if let Some(freedom) = &mut ratio.freedom {
                    keep(freedom, from, to);
                }
            }
            Self::Gauges(gauges) => {
                keep(&mut gauges.frequency_hz, from, to);
                for spectrum in gauges.tests.iter_mut().flatten() {
                    keep(spectrum, from, to);
                }
                for noise in &mut gauges.noise {
                    keep(noise, from, to);
                }
            }
        }
        Ok(())
    }
}

fn keep<T>(values: &mut Vec<T>, from: usize, to: usize) {
    values.truncate(to);
    values.drain(..from.min(values.len()));
}

/// The ratio that the modulus was found from.
pub(super) fn table(spectra: &Spectra) -> Option<Table> {
    let Spectra::Ratio(ratio) = spectra else {
        return None;
    };
    let of = |pick: fn(&Complex64) -> f64| ratio.values.iter().map(pick).collect();
    let mut columns = vec![
        Column::numbers("frequency", "Hz", ratio.frequency_hz.clone()),
        Column::numbers("real part", "", of(|value| value.re)),
        Column::numbers("imaginary part", "", of(|value| value.im)),
        Column::numbers(
            "standard error",
            "",
            ratio.variance.iter().map(|v| v.sqrt()).collect(),
        ),
    ];
    if let Some(coherence) = &ratio.coherence {
        columns.push(Column::numbers("coherence", "", coherence.clone()));
    }
    Some(Table {
        name: "ratio".to_owned(),
        title: "Ratio of spectra".to_owned(),
        columns,
    })
}
