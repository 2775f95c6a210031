//! Data for the reconstruction of a force from a response.

use impulse::{CalibrationLines, ResponseNoise, TimeInterval};
use labio::hits::Extent;
use labio::{FrequencyResponse, LineValidity, Quantity as Physical, Record, ResponseKind};
use num_complex::Complex64;

use super::response_sheet::{FurtherResponse, NoiseSheet, ResponseSheet};
use crate::hits::Stretch;
use crate::responses::completed;
use crate::{InStep, Outcome, RodlabError};

/// Minimum number of samples at rest: the standard deviation is then known to 16 %.
pub(super) const FEWEST_AT_REST: usize = 20;

/// The data of a reconstruction.
pub(super) struct Problem<'a> {
    pub(super) sheet: &'a ResponseSheet,
    /// The responses; the first is the field `response` of the sheet.
    pub(super) first: Seen,
    pub(super) further: Vec<Seen>,
    pub(super) sampling_rate_hz: f64,
    /// Standard deviation of the first response before the force acts, if there are at least
    /// [`FEWEST_AT_REST`] samples.
    pub(super) rest: Option<f64>,
    /// Time in which the force acts: as stated in the sheet, or determined from the calibration
    /// hits.
    pub(super) acting: Option<TimeInterval>,
    /// Mean fraction by which the band limit lowers the peaks of the calibration hits.
    pub(super) lost_in_band: Option<f64>,
    /// The measured force, if there is one.
    pub(super) measured: Option<Vec<f64>>,
}

/// A response with its relation to the force.
pub(super) struct Seen {
    /// Response over force, on the lines of the record; NaN if unknown.
    pub(super) path: FrequencyResponse,
    /// Samples of the response.
    pub(super) samples: Vec<f64>,
    /// Noise of the response, if known.
    pub(super) noise: Noise,
    /// Scatter of the calibration hits on each line.
    pub(super) blows: Option<CalibrationLines>,
    /// Unit of the response.
    pub(super) unit: &'static str,
}

impl Problem<'_> {
    /// All responses.
    pub(super) fn seen(&self) -> impl Iterator<Item = &Seen> {
        std::iter::once(&self.first).chain(&self.further)
    }
}

/// Noise of a response.
#[derive(Clone)]
pub(super) enum Noise {
    Unknown,
    /// Standard deviation of each sample.
    White(f64),
    /// Variance of every line, from the scatter between calibration hits.
    Lines(Vec<f64>),
}

impl Noise {
    pub(super) fn of_response(&self) -> ResponseNoise<'_> {
        match self {
            Self::Unknown => ResponseNoise::Unknown,
            Self::White(deviation) => ResponseNoise::White(*deviation),
            Self::Lines(lines) => ResponseNoise::Lines(lines),
        }
    }
}

/// Returns the responses with their `paths`, and the other data of the impact.
pub(super) fn problem<'a>(
    sheet: &'a ResponseSheet,
    paths: Vec<FrequencyResponse>,
    record: &Record,
    outcome: &mut Outcome,
) -> Result<Problem<'a>, RodlabError> {
    let further = |at: usize| move |field: &str| further_place(at, field);
    let mut paths = paths.into_iter();
    let Some(path) = paths.next() else {
        return Err(RodlabError::request("problem.path", "none", "a path"));
    };
    let of_problem = |field: &str| format!("problem.{field}");
    let first = seen(
        (&sheet.response, &sheet.noise),
        path,
        record,
        &of_problem,
        outcome,
    )?;
    let rest = sheet
        .further
        .iter()
        .zip(paths)
        .enumerate()
        .map(|(at, (named, path))| {
            let FurtherResponse {
                response, noise, ..
            } = named;
            seen((response, noise), path, record, &further(at), outcome)
        });
    let rest = rest.collect::<Result<Vec<_>, _>>()?;
    let measured = sheet
        .compare_with
        .as_ref()
        .map(|name| record.channel(name).map(|samples| samples.to_vec()))
        .transpose()
        .in_step("problem.response")?;
    Ok(Problem {
        sheet,
        first,
        further: rest,
        sampling_rate_hz: record.sampling_rate_hz(),
        rest: None,
        acting: sheet.acting.as_ref().map(|acting| TimeInterval {
            from: acting.from.si(),
            to: acting.to.si(),
        }),
        lost_in_band: None,
        measured,
    })
}

/// Returns the response of a channel with its `path`; `place` returns the places of its fields in
/// the sheet.
fn seen(
    (name, noise): (&str, &NoiseSheet),
    path: FrequencyResponse,
    record: &Record,
    place: &dyn Fn(&str) -> String,
    outcome: &mut Outcome,
) -> Result<Seen, RodlabError> {
    let step = |error| RodlabError::step(place("response"), error);
    let path = on_lines_of(path, record, name)?;
    let samples = record.channel(name).map_err(step)?.to_vec();
    let channel = record.channels().iter().find(|c| c.name() == name);
    let unit = channel.map_or("", |channel| channel.quantity().unit());
    let noise = match (noise, channel) {
        (NoiseSheet::White(level), Some(channel)) => {
            Noise::White(level.of(channel, &place("noise.White"))?)
        }
        (NoiseSheet::FromRest(stretch), _) => {
            let rate = record.sampling_rate_hz();
            let place = place("noise.FromRest");
            Noise::White(noise_at_rest(
                &samples,
                (stretch, &place),
                rate,
                unit,
                outcome,
            )?)
        }
        _ => Noise::Unknown,
    };
    Ok(Seen {
        samples: completed(record, name, path.added_damping).map_err(step)?,
        path,
        noise,
        blows: None,
        unit,
    })
}

/// Returns the standard deviation over the beginning of the record.
fn noise_at_rest(
    samples: &[f64],
    (stretch, place): (&Stretch, &str),
    rate: f64,
    unit: &str,
    outcome: &mut Outcome,
) -> Result<f64, RodlabError> {
    let n_rest = match stretch.extent() {
        Extent::Samples(n) => n,
        Extent::Seconds(seconds) => (0..samples.len())
            .take_while(|n| ((*n + 1) as f64) <= seconds * rate * (1.0 + 1e-9))
            .count(),
    };
    let rest = samples.get(..n_rest).unwrap_or_default();
    if rest.len() < FEWEST_AT_REST {
        return Err(RodlabError::request(
            place,
            match stretch.extent() {
                Extent::Samples(_) => stretch.to_string(),
                Extent::Seconds(_) => format!("{stretch}, {n_rest} samples"),
            },
            format!("from {FEWEST_AT_REST} to {} samples", samples.len()),
        ));
    }
    let n = rest.len() as f64;
    let (mean, deviation) = scatter_about_mean(rest);
    if mean.abs() > 4.0 * deviation / n.sqrt() {
        outcome.warn(format!(
            "The response has an offset of {mean:.3e} {unit} at rest: it is treated as response and makes lines near 0 Hz wrong."
        ));
    }
    Ok(deviation)
}

/// Returns mean and standard deviation.
pub(super) fn scatter_about_mean(samples: &[f64]) -> (f64, f64) {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, variance.sqrt())
}

/// Returns `path` as a response of the quantity of the channel, with as many lines as the record;
/// lines above the last of `path` are unknown.
pub(super) fn on_lines_of(
    path: FrequencyResponse,
    record: &Record,
    channel: &str,
) -> Result<FrequencyResponse, RodlabError> {
    let known = record.channels().iter().find(|c| c.name() == channel);
    let kind = known.and_then(|channel| kind_of(channel.quantity()));
    let Some(kind) = kind else {
        return Err(RodlabError::request(
            "problem.response",
            format!("`{channel}`"),
            "a channel of acceleration, velocity or displacement",
        ));
    };
    let mut path = path.to_kind(kind).in_step("problem.path")?;
    let n_lines = record.n_samples() / 2 + 1;
    let spacing = record.sampling_rate_hz() / record.n_samples() as f64;
    path.values
        .resize(n_lines, Complex64::new(f64::NAN, f64::NAN));
    path.validity.resize(n_lines, LineValidity::NotDefined);
    if let Some(variance) = &mut path.variance {
        variance.resize(n_lines, f64::NAN);
    }
    path.coherence = None;
    path.n_samples = record.n_samples();
    path.frequency_hz = (0..n_lines).map(|line| line as f64 * spacing).collect();
    Ok(path)
}

/// Returns the place of a field of a further response in the sheet.
pub(super) fn further_place(at: usize, field: &str) -> String {
    format!("problem.further[{at}].{field}")
}

/// Returns the kind of response from a force to a motion of this quantity; `None` if it is not a
/// motion.
fn kind_of(quantity: Physical) -> Option<ResponseKind> {
    ResponseKind::between(Physical::Force, quantity)
}
