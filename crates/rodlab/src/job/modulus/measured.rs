//! What was measured: from hits or a file to ratios of spectra or spectra of gauges, with their errors.

use cmod::multi_point::Quantity;
use cmod::two_point::variance_from_coherence;
use labio::{AveragedSpectra, Dimension, Record, Unit, Window};
use num_complex::Complex64;
use serde::Deserialize;

use super::method::{self, MethodSheet};
use super::{ModulusSheet, gauges, histories, pulses};
use crate::RodlabError;
use crate::chosen::Chosen;
use crate::figure::Figure;
use crate::hits::{FoundHits, HitsSheet};
use crate::job::Surroundings;
use crate::job::frf::BandSheet;
use crate::number_file::NumberFile;
use crate::outcome::{Column, InputFile, LogEntry, Table};
use crate::records::{Records, Selector};
use crate::sheet::{Duration, Ratio as RatioKind, Stated};

/// Fewest hits of which a coherence can be formed. The spectra of gauges have their errors from the silence before a hit: of one hit,
/// too.
const FEWEST_HITS: usize = 2;

/// So long before the trigger a blow begins at most, unless the sheet says how long the silence is \[s\].
const RISE: f64 = 0.2e-3;

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
        silent: Option<Stated<Duration>>,
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
        of_value: Stated<RatioKind>,
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
    /// Effective number of averages, where the variance is from a coherence.
    pub(super) averages: Option<f64>,
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
    /// Relative standard error that the sensitivities leave in the ratio of the channels, where they state any.
    pub(super) calibration_error: f64,
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
        } => of_hits(sheet, (records, hits, silent.as_ref()), around, chosen)?,
        SourceSheet::Ratio(ratio) => of_file(sheet, ratio, around, chosen)?,
    };
    if let Some(spectra) = &mut measured.spectra {
        spectra.cut(sheet.band.as_ref())?;
    }
    Ok(measured)
}

fn of_hits(
    sheet: &ModulusSheet,
    (records, hits, silent): (&Records, &HitsSheet, Option<&Stated<Duration>>),
    around: &Surroundings<'_>,
    chosen: &mut Chosen,
) -> Result<Measured, RodlabError> {
    let loaded = records.load(around.folder, "source.records")?;
    chosen.extend(loaded.settings);
    if let Some(first) = loaded.records.first() {
        check_channels(&sheet.method, &first.record)?;
    }
    let channels = sheet.method.channels();
    let reference = channels.first().map_or("", |taken| taken.channel);
    let found = hits.find(loaded.records, reference, "source.hits")?;
    chosen.extend(found.settings().to_vec());
    let silent = silent_samples(&found, silent, chosen)?;
    let mut in_words = found.in_words();
    if let Some(first) = in_words.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    let accepted = found.accepted();
    let mut measured = Measured {
        spectra: None,
        missing: String::new(),
        inputs: loaded.inputs,
        log: found.log(),
        figures: histories::figures(&found, &channels, silent),
        in_words: vec![format!("{in_words}.")],
        warnings: loaded.warnings,
        quantities: quantities(accepted.first().copied()),
        first_hit: None,
        calibration_error: calibration_error(accepted.first().copied(), &channels),
    };
    let fewest = match &sheet.method {
        MethodSheet::ThreePoint { .. } | MethodSheet::MultiPoint { .. } => 1,
        _ => FEWEST_HITS,
    };
    if accepted.len() < fewest {
        let why = if fewest == FEWEST_HITS {
            ": the coherence of one is 1 whatever was measured"
        } else {
            ""
        };
        measured.missing = format!(
            "{} accepted of {} found, expected at least {fewest}{why}",
            if accepted.len() == 1 {
                "1 hit is"
            } else {
                "no hit is"
            },
            found.n_found()
        );
        return Ok(measured);
    }
    let spectra = match &sheet.method {
        MethodSheet::TwoPoint {
            impacted_end,
            free_end,
            ..
        }
        | MethodSheet::Resonances {
            impacted_end,
            free_end,
        } => Spectra::Ratio(averaged_ratio(
            accepted.iter().copied(),
            impacted_end,
            free_end,
        )?),
        MethodSheet::FreeEnd { first, second, .. } => Spectra::Ratio(averaged_ratio(
            accepted.iter().copied(),
            &first.channel,
            &second.channel,
        )?),
        MethodSheet::SeparatePulses { first, second, .. } => {
            Spectra::Ratio(pulses::separate(&accepted, first, second)?)
        }
        MethodSheet::OneGauge {
            section,
            incident,
            reflected,
            ..
        } => Spectra::Ratio(pulses::reflected(
            &accepted,
            &section.channel,
            incident,
            reflected,
        )?),
        MethodSheet::ThreePoint { gauges } | MethodSheet::MultiPoint { gauges, .. } => {
            Spectra::Gauges(gauges::of_hits(&accepted, gauges, silent)?)
        }
    };
    measured.first_hit = found
        .hits()
        .find(|hit| hit.hit.is_accepted())
        .and_then(|hit| {
            let record = hit.hit.record()?;
            Some(FirstHit {
                record: record.clone(),
                silent: silent?,
                trigger: trigger_of(hit.hit, record),
            })
        });
    measured.spectra = Some(spectra);
    Ok(measured)
}

/// H1 with the denominator as input, and its variance by the coherence.
pub(super) fn averaged_ratio<'a>(
    hits: impl IntoIterator<Item = &'a Record>,
    numerator: &str,
    denominator: &str,
) -> Result<Ratio, RodlabError> {
    let averaging = |error| RodlabError::step("averaging the spectra of the hits", error);
    let spectra = AveragedSpectra::of(hits, Window::Rectangular).map_err(averaging)?;
    let response = spectra.h1(denominator, numerator).map_err(averaging)?;
    let coherence = response
        .coherence
        .unwrap_or_else(|| vec![f64::NAN; response.values.len()]);
    let variance =
        variance_from_coherence(&response.values, &coherence, response.effective_averages)
            .map_err(|error| RodlabError::step("the variance of the ratio", error))?;
    Ok(Ratio {
        frequency_hz: response.frequency_hz,
        values: response.values,
        variance,
        coherence: Some(coherence),
        averages: Some(response.effective_averages),
    })
}

/// The channels of the method are there, and of quantities that it takes.
fn check_channels(method: &MethodSheet, record: &Record) -> Result<(), RodlabError> {
    let known = record.channels();
    let mut first: Option<(&str, labio::Quantity)> = None;
    for taken in method.channels() {
        let Some(channel) = known.iter().find(|c| c.name() == taken.channel) else {
            let names: Vec<String> = known.iter().map(|c| format!("`{}`", c.name())).collect();
            return Err(RodlabError::request(
                taken.field,
                format!("`{}`", taken.channel),
                format!("one of the channels {}", names.join(", ")),
            ));
        };
        let quantity = channel.quantity();
        let is = || format!("`{}`, a channel of {}", taken.channel, quantity.name());
        let motion = matches!(
            quantity,
            labio::Quantity::Displacement
                | labio::Quantity::Velocity
                | labio::Quantity::Acceleration
        );
        if taken.motion && !motion {
            let expected = "a channel of acceleration, velocity or displacement";
            return Err(RodlabError::request(taken.field, is(), expected));
        }
        if method::of_channel(quantity).is_none() {
            let expected = "a channel of strain, acceleration, velocity or displacement";
            return Err(RodlabError::request(taken.field, is(), expected));
        }
        match first {
            Some((name, wanted)) if method.one_quantity() && wanted != quantity => {
                return Err(RodlabError::request(
                    taken.field,
                    is(),
                    format!("{}, as `{name}` is", wanted.name()),
                ));
            }
            Some(_) => {}
            None => first = Some((taken.channel, quantity)),
        }
    }
    Ok(())
}

impl Measured {
    /// What a channel of the hits measures.
    pub(super) fn quantity_of(&self, channel: &str) -> Option<Quantity> {
        let found = self.quantities.iter().find(|(name, _)| name == channel);
        found.map(|(_, quantity)| *quantity)
    }
}

fn quantities(record: Option<&Record>) -> Vec<(String, Quantity)> {
    let channels = record.map(Record::channels).unwrap_or_default();
    channels
        .iter()
        .filter_map(|channel| {
            let quantity = method::of_channel(channel.quantity())?;
            Some((channel.name().to_owned(), quantity.into()))
        })
        .collect()
}

/// Number of samples before the blow, if it is known.
fn silent_samples(
    found: &FoundHits,
    stated: Option<&Stated<Duration>>,
    chosen: &mut Chosen,
) -> Result<Option<usize>, RodlabError> {
    let name = "source.silent";
    let first = found.hits().find_map(|hit| Some((hit, hit.hit.record()?)));
    let Some((hit, record)) = first else {
        return Ok(None);
    };
    let rate = record.sampling_rate_hz();
    let extent = |seconds: f64| {
        labio::hits::Extent::Seconds(seconds)
            .samples(rate)
            .map_err(|error| RodlabError::step(name, error))
    };
    if let Some(stated) = stated {
        chosen.stated(name, stated);
        return extent(stated.si()).map(Some);
    }
    if let Some(trigger) = trigger_of(hit.hit, record) {
        // the trigger fires some time after the blow began
        let before = trigger as f64 / rate;
        let silent = before - (0.2 * before).min(RISE);
        chosen.by_default(
            name,
            format!(
                "{:.4} ms, the pre-trigger but for the rise of the blow",
                1e3 * silent
            ),
        );
        return extent(silent).map(Some);
    }
    chosen.by_default(name, "not known");
    Ok(None)
}

/// The sample of a hit on which the trigger fired; none where each record is a hit.
fn trigger_of(hit: &labio::hits::Hit, record: &Record) -> Option<usize> {
    let before = hit.time() - record.start_time();
    (before > 0.0)
        .then(|| labio::hits::Extent::Seconds(before).samples(record.sampling_rate_hz()))
        .and_then(Result::ok)
}

/// What the sensitivities of the channels leave uncertain of their ratio; they are independent of each other, and one channel alone
/// has none.
fn calibration_error(record: Option<&Record>, channels: &[method::Taken<'_>]) -> f64 {
    let of = |taken: &method::Taken<'_>| {
        let chain = record?.chain(taken.channel).ok()??;
        Some(chain.relative_uncertainty())
    };
    match channels {
        [_] => 0.0,
        several => several.iter().filter_map(of).fold(0.0, f64::hypot),
    }
}

fn of_file(
    sheet: &ModulusSheet,
    source: &RatioSheet,
    around: &Surroundings<'_>,
    chosen: &mut Chosen,
) -> Result<Measured, RodlabError> {
    let words = sheet.method.ratio_in_words()?;
    let file = NumberFile::read(&source.path, around.folder, "source.path")?;
    let hertz = Unit::parse("Hz").map_or(Dimension::NONE, |unit| unit.dimension());
    let (values, frequency_hz) = match &source.values {
        RatioValues::Complex(selector) => {
            let column = file.column(selector, "source.values")?;
            (
                column.complex_numbers()?,
                column.abscissa(hertz, "frequencies")?,
            )
        }
        RatioValues::Parts { real, imaginary } => {
            let column = file.column(real, "source.values.real")?;
            let real = column.pure_numbers()?;
            let imaginary = file
                .column(imaginary, "source.values.imaginary")?
                .pure_numbers()?;
            let pairs = real.iter().zip(&imaginary);
            (
                pairs.map(|(re, im)| Complex64::new(*re, *im)).collect(),
                column.abscissa(hertz, "frequencies")?,
            )
        }
    };
    chosen.stated("source.path", &source.path);
    chosen.stated("source.values", words);
    let refused = |error| RodlabError::step("source.errors", error);
    let (variance, coherence, averages) = match &source.errors {
        RatioErrors::Coherence { column, averages } => {
            let coherence = file
                .column(column, "source.errors.column")?
                .pure_numbers()?;
            chosen.stated("source.errors", format!("coherence of {averages} averages"));
            let variance =
                variance_from_coherence(&values, &coherence, *averages).map_err(refused)?;
            (variance, Some(coherence), Some(*averages))
        }
        RatioErrors::StandardError { column } => {
            chosen.stated("source.errors", "a column of standard errors");
            let errors = file
                .column(column, "source.errors.column")?
                .pure_numbers()?;
            (errors.iter().map(|e| e * e).collect(), None, None)
        }
        RatioErrors::Relative { of_value } => {
            chosen.stated("source.errors", format!("{of_value} of each value"));
            let relative = of_value.si();
            let of = |value: &Complex64| relative * relative * value.norm_sqr();
            (values.iter().map(of).collect(), None, None)
        }
    };
    Ok(Measured {
        spectra: Some(Spectra::Ratio(Ratio {
            frequency_hz,
            values,
            variance,
            coherence,
            averages,
        })),
        missing: String::new(),
        inputs: vec![file.input],
        log: Vec::new(),
        figures: Vec::new(),
        in_words: Vec::new(),
        warnings: Vec::new(),
        quantities: Vec::new(),
        first_hit: None,
        calibration_error: 0.0,
    })
}

impl Spectra {
    pub(super) fn frequency_hz(&self) -> &[f64] {
        match self {
            Self::Ratio(ratio) => &ratio.frequency_hz,
            Self::Gauges(gauges) => &gauges.frequency_hz,
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
