//! Force from a response and its path, computed by `impulse`, and the reconstruction of calibration
//! hits as a test of the method.

use std::ops::Range;

use impulse::{
    BlowSpan, CalibrationBlow, CalibrationLines, CalibrationScatter, ChoiceVerdict, ForceHistory,
    FrequencyBand, ImpulseError, Parameter, PivotingEnd, ReconstructedForce, Reconstruction,
    Regularisation, ResponseNoise, Sensor, TimeInterval,
};
use labio::{FrequencyResponse, Record};

use super::response_problem::{Noise, Problem, Seen, on_lines_of};
use super::response_sheet::{RegularisationSheet, ResponseSheet};
use crate::digits::short;
use crate::hits::FoundHits;
use crate::job::JobContext;
use crate::responses::{HitsSource, completed};
use crate::{InStep, Outcome, RodlabError};

/// Minimum number of calibration hits, so that each can be reconstructed from the others.
const FEWEST_HITS: usize = 3;

/// Maximum number of samples of the default time in which the force acts. It is limited because the
/// equations for this time are dense.
const LONGEST: usize = 512;

/// Fraction of the peak that the force by division may reach outside the assumed duration without
/// being taken for a force.
const ELSEWHERE: f64 = 0.1;

/// Largest force within twice the span of the assumed duration but outside that duration, relative
/// to the largest force outside twice the span, above which the force is taken to last longer.
const CONTINUES: f64 = 2.0;

/// Durations that are tried for the force, as multiples of the duration of the calibration hits.
const LONGER: [usize; 5] = [1, 2, 4, 8, 16];

/// Largest ringing of a band-limited force outside its duration, as a multiple of the ringing of
/// calibration hits. An impact that is shorter than the calibration hits rings more.
const RINGING: f64 = 1.5;

impl RegularisationSheet {
    /// Returns the regularisation in the form of `impulse`; `fixed`, if given, replaces the
    /// parameter of the sheet.
    fn regularisation(self, fixed: Option<f64>) -> Regularisation {
        let of = |parameter| fixed.map_or(parameter, Parameter::Given);
        match self {
            Self::Tikhonov { penalty, parameter } => Regularisation::Tikhonov {
                penalty,
                parameter: of(parameter),
            },
            Self::Truncated { parameter } => Regularisation::Truncated {
                parameter: of(parameter),
            },
        }
    }
}

/// Returns the frequency response from the force to the response of calibration hits.
pub(super) fn path_of<'a>(
    hits: &HitsSource,
    records: impl IntoIterator<Item = &'a Record>,
    context: &JobContext<'_>,
) -> Result<FrequencyResponse, RodlabError> {
    let field = "problem.path";
    let spectra = hits.spectra(records, context, field)?;
    spectra
        .response(
            hits.estimator.unwrap_or_default(),
            &hits.force,
            &hits.response,
        )
        .in_step(field)
}

/// Responses to an impact, with the sampling rate and the time in which the force acts.
struct Blow<'a> {
    seen: Vec<SeenBlow<'a>>,
    sampling_rate_hz: f64,
    acting: Option<TimeInterval>,
}

/// One response to an impact.
struct SeenBlow<'a> {
    path: &'a FrequencyResponse,
    samples: &'a [f64],
    noise: ResponseNoise<'a>,
    blows: Option<&'a CalibrationLines>,
}

impl<'a> SeenBlow<'a> {
    fn of(seen: &'a Seen) -> Self {
        Self {
            path: &seen.path,
            samples: &seen.samples,
            noise: seen.noise.of_response(),
            blows: seen.blows.as_ref(),
        }
    }

    fn sensor(&self) -> Result<Sensor<'_>, ImpulseError> {
        let path = self.path;
        let sensor = Sensor::new(self.samples, &path.values)?
            .without_lines(path.invalid_lines())
            .with_noise(self.noise)?;
        match &path.variance {
            Some(variance) => sensor.with_variance(variance),
            None => Ok(sensor),
        }
    }
}

impl Blow<'_> {
    /// Returns the reconstruction by division, in the band of the sheet, with the errors of each
    /// line from the calibration hits.
    fn divided(&self, sheet: &ResponseSheet) -> Result<Reconstruction<'_>, ImpulseError> {
        let sensors = self.seen.iter().map(SeenBlow::sensor);
        let sensors = sensors.collect::<Result<Vec<_>, _>>()?;
        let mut reconstruction = Reconstruction::of_sensors(sensors, self.sampling_rate_hz)?;
        if let Some(band) = band(sheet) {
            reconstruction = reconstruction.within(band);
        }
        // calibration hits and window are the same for all responses
        if let Some(blows) = self.seen.first().and_then(|seen| seen.blows) {
            reconstruction = reconstruction.like_blows(blows);
        }
        let window = self.seen.first().and_then(|seen| seen.path.added_damping);
        if let Some(window) = window {
            reconstruction = reconstruction.with_added_damping(window.decay_rate());
        }
        Ok(reconstruction)
    }

    /// Computes the force with the settings of the sheet; `fixed`, if given, replaces the parameter
    /// of the regularisation.
    fn force(
        &self,
        sheet: &ResponseSheet,
        fixed: Option<f64>,
    ) -> Result<ReconstructedForce, ImpulseError> {
        let mut reconstruction = self.divided(sheet)?;
        if let Some(stated) = sheet.regularisation {
            reconstruction = reconstruction.with_regularisation(stated.regularisation(fixed));
        }
        if let Some(acting) = self.acting {
            reconstruction = reconstruction.acting_during(acting);
        }
        if sheet.non_negative {
            reconstruction = reconstruction.non_negative();
        }
        reconstruction.solve()
    }
}

fn band(sheet: &ResponseSheet) -> Option<FrequencyBand> {
    sheet.band.as_ref().map(|band| FrequencyBand {
        from_hz: band.from.si(),
        to_hz: band.to.si(),
    })
}

impl<'a> Problem<'a> {
    fn blow(&self) -> Blow<'_> {
        Blow {
            seen: self.seen().map(SeenBlow::of).collect(),
            sampling_rate_hz: self.sampling_rate_hz,
            acting: self.acting,
        }
    }

    /// Returns `measured` in the band of the reconstructed force. The force has no part outside the
    /// band, unless the time in which it acts is known.
    pub(super) fn in_band(&self, measured: &[f64]) -> Vec<f64> {
        match band(self.sheet) {
            Some(band) if self.acting.is_none() => band.of(measured, self.sampling_rate_hz),
            _ => measured.to_vec(),
        }
    }
}

/// Computes the force, or returns the reason why the data do not determine one.
pub(super) fn solve(
    problem: &Problem<'_>,
) -> Result<Result<ReconstructedForce, String>, RodlabError> {
    let found = problem.blow().force(problem.sheet, None);
    let solved = match found {
        Ok(solved) => solved,
        // these errors are due to the data, not to the sheet
        Err(
            error @ (ImpulseError::NoUsableLine { .. } | ImpulseError::SpectrumOverflow { .. }),
        ) => {
            return Ok(Err(error.to_string()));
        }
        Err(error) => return Err(RodlabError::step("problem", error)),
    };
    if let Some(parameter) = &solved.parameter
        && parameter.verdict == ChoiceVerdict::NotReached
    {
        return Ok(Err(
            "the response is no larger than its noise: any force, or none, explains it".to_owned(),
        ));
    }
    if let Some(end) = solved.non_negativity
        && end.end != PivotingEnd::Converged
    {
        return Ok(Err(format!(
            "no force without tension was found in {} steps: state a regularisation",
            end.steps
        )));
    }
    Ok(Ok(solved))
}

/// Returns the samples in the time in which the force acts; all samples if this time is not known.
pub(super) fn window(problem: &Problem<'_>) -> Range<usize> {
    let n_samples = problem.first.samples.len();
    let Some(acting) = &problem.acting else {
        return 0..n_samples;
    };
    let rate = problem.sampling_rate_hz;
    let inside = |n: &usize| {
        let time = *n as f64 / rate;
        (acting.from..=acting.to).contains(&time)
    };
    let first = (0..n_samples).find(inside).unwrap_or(0);
    let last = (0..n_samples).rfind(inside).unwrap_or(first);
    first..last + 1
}

/// Returns the scatter between hits on the lines of a response, and enters the errors of the
/// average in `path`.
pub(super) fn lines_of_hits(
    hits: &HitsSource,
    records: &[&Record],
    path: &mut FrequencyResponse,
) -> Result<Option<CalibrationLines>, RodlabError> {
    let Some(variance) = &path.variance else {
        return Ok(None);
    };
    let mut forces = forces_of(hits, records)?;
    if let (Some(window), Some(first)) = (path.added_damping, records.first()) {
        let weights = window
            .weights(first.n_samples(), first.sampling_rate_hz())
            .in_step("problem.path")?;
        for (sample, weight) in forces.iter_mut().flat_map(|f| f.iter_mut().zip(&weights)) {
            *sample *= weight;
        }
    }
    let forces: Vec<&[f64]> = forces.iter().map(Vec::as_slice).collect();
    let lines = CalibrationLines::of(variance, &forces)
        .in_step("problem.path, noise by calibration hits")?;
    path.variance = Some(lines.variance.clone());
    Ok(Some(lines))
}

fn forces_of(hits: &HitsSource, records: &[&Record]) -> Result<Vec<Vec<f64>>, RodlabError> {
    let forces = records.iter().map(|record| {
        record
            .channel(&hits.force)
            .map(|samples| samples.to_vec())
            .in_step("problem.path")
    });
    forces.collect()
}

/// Returns the duration of the calibration hits about their peaks; `None` if it has [`LONGEST`]
/// samples or more.
pub(super) fn span_of(
    hits: &HitsSource,
    records: &[&Record],
) -> Result<Option<BlowSpan>, RodlabError> {
    let forces = forces_of(hits, records)?;
    let forces: Vec<&[f64]> = forces.iter().map(Vec::as_slice).collect();
    let span = BlowSpan::of(&forces).in_step("problem.path")?;
    Ok(span.filter(|span| span.before + span.after < LONGEST))
}

/// Returns index and value of the largest sample.
fn largest(force: &[f64]) -> Option<(usize, f64)> {
    let all = force.iter().copied().enumerate();
    all.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Returns the samples of the span about the peak of a force, and the largest force outside this
/// span as a fraction of the peak.
fn about_peak(span: BlowSpan, force: &[f64]) -> Option<(Range<usize>, f64)> {
    let (at, peak) = largest(force)?;
    let window = span.about(at, force.len());
    let outside = force.iter().enumerate();
    let outside = outside.filter(|(index, _)| !window.contains(index));
    let elsewhere = outside.fold(0.0_f64, |top, (_, f)| top.max(f.abs()));
    Some((window, elsewhere / peak))
}

/// Effect of the band of the sheet on the calibration hits.
pub(super) struct HitsInBand {
    /// Largest band-limited force outside the span of a hit, as a fraction of its peak.
    outside: f64,
    /// Mean fraction by which the band limit lowers the peak.
    pub(super) lost: f64,
}

impl HitsInBand {
    /// Computes the effect of the band; `None` if the sheet states no band.
    pub(super) fn of(
        sheet: &ResponseSheet,
        hits: &HitsSource,
        records: &[&Record],
        span: BlowSpan,
    ) -> Result<Option<Self>, RodlabError> {
        let Some(band) = band(sheet) else {
            return Ok(None);
        };
        let (mut outside, mut lost) = (0.0_f64, 0.0);
        let forces = forces_of(hits, records)?;
        for (force, record) in forces.iter().zip(records) {
            let inside = band.of(force, record.sampling_rate_hz());
            let peaks = largest(force).zip(largest(&inside));
            let Some((((_, whole), (_, part)), (_, elsewhere))) =
                peaks.zip(about_peak(span, &inside))
            else {
                return Ok(None);
            };
            outside = outside.max(elsewhere);
            lost += (1.0 - part / whole) / forces.len() as f64;
        }
        Ok(Some(Self { outside, lost }))
    }
}

/// Returns true if the largest `force` inside `wider` but outside `window` is more than
/// [`CONTINUES`] times the largest outside `wider`. Returns false if fewer samples are outside
/// `wider` than inside.
fn continues(force: &[f64], window: &Range<usize>, wider: &Range<usize>) -> bool {
    let largest = |ranges: [Range<usize>; 2]| {
        let parts = ranges.into_iter().flat_map(|range| force.get(range));
        parts.flatten().fold(0.0_f64, |most, f| most.max(f.abs()))
    };
    let beside = largest([wider.start..window.start, window.end..wider.end]);
    let further = largest([0..wider.start, wider.end..force.len()]);
    force.len() >= 2 * wider.len() && beside > CONTINUES * further
}

/// Returns the time in which the force acts, about the peak of the force by division. It is as long
/// as the calibration hits, or as the least multiple of their duration beyond which the force does
/// not continue. Returns `None` if the force at other times exceeds [`ELSEWHERE`] of the peak plus
/// [`RINGING`] times the ringing of the calibration hits in the same band.
pub(super) fn acting_like_hits(
    problem: &Problem<'_>,
    span: Option<BlowSpan>,
    hits: Option<&HitsInBand>,
    outcome: &mut Outcome,
) -> Result<Option<(BlowSpan, TimeInterval)>, RodlabError> {
    let Some(span) = span else { return Ok(None) };
    // no regularisation is used here: it would only smooth the force
    let divided = problem
        .blow()
        .divided(problem.sheet)
        .and_then(|r| r.solve());
    // errors of the data are reported when the force itself is computed
    let Ok(divided) = divided else {
        return Ok(None);
    };
    // the force is multiplied by the exponential window, because its noise is then equal at all
    // times
    let decay = problem
        .first
        .path
        .added_damping
        .map_or(0.0, |window| window.decay_rate());
    let force: Vec<f64> = (divided.history.force().iter().enumerate())
        .map(|(n, f)| f * (-decay * n as f64 / problem.sampling_rate_hz).exp())
        .collect();
    let allowed = ELSEWHERE + hits.map_or(0.0, |hits| RINGING * hits.outside);
    let mut at_first = 0.0;
    let mut longest = None;
    for times in LONGER {
        let span = span.longer(times);
        let Some((window, elsewhere)) = about_peak(span, &force) else {
            return Ok(None);
        };
        if times == 1 {
            at_first = elsewhere;
        }
        if elsewhere <= allowed && window.len() < LONGEST {
            let acting = BlowSpan::interval(&window, problem.sampling_rate_hz);
            longest = Some((span, acting));
            let Some((wider, _)) = about_peak(span.longer(2), &force) else {
                return Ok(longest);
            };
            if !continues(&force, &window, &wider) {
                return Ok(longest);
            }
        }
    }
    if let Some((_, acting)) = &longest {
        outcome.doubt(format!(
            "the force seems to act for longer than {} ms, the longest time that can be assumed with these calibration hits: state `acting`",
            short(1e3 * (acting.to - acting.from))
        ));
        return Ok(longest);
    }
    outcome.doubt(format!(
        "the force found by division reaches {:.0} % of its peak outside the duration of a calibration hit; the time in which it acts is therefore not limited, and the force has no \
         part on lines that the hits do not determine: state `acting`",
        100.0 * at_first
    ));
    Ok(None)
}

/// Returns the channel of the force, which is the same for all responses.
fn force_of(sources: &[HitsSource]) -> &str {
    sources.first().map_or("", |hits| &hits.force)
}

/// Estimates errors from calibration hits: the force of each hit is reconstructed with the path of
/// the other hits, in the same way as the force of the impact.
pub(super) fn scatter(
    problem: &Problem<'_>,
    solved: &ReconstructedForce,
    (sources, found, span): (&[HitsSource], &FoundHits, Option<BlowSpan>),
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Option<CalibrationScatter>, RodlabError> {
    let accepted = found.accepted();
    if accepted.len() < FEWEST_HITS {
        outcome.warn(format!(
            "{} calibration hits cannot be reconstructed from each other, which requires at least {FEWEST_HITS} hits: the errors do not include differences from hit to hit.",
            accepted.len()
        ));
        return Ok(None);
    }
    let step = |error| RodlabError::step("problem.path, reconstructing calibration hits", error);
    let window = window(problem);
    let fixed = solved.parameter.as_ref().map(|parameter| parameter.value);
    context
        .progress
        .begins("calibration hits from each other", accepted.len());
    let mut forces: Vec<(ForceHistory, Vec<f64>, Vec<f64>)> = Vec::with_capacity(accepted.len());
    for (index, hit) in accepted.iter().enumerate() {
        context.check_cancelled()?;
        let others = accepted
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index)
            .map(|(_, record)| *record)
            .collect::<Vec<_>>();
        let seen = sources.iter().zip(problem.seen()).map(|(hits, seen)| {
            let path = path_of(hits, others.iter().copied(), context)?;
            let mut path = on_lines_of(path, hit, &hits.response)?;
            let lines = lines_of_hits(hits, &others, &mut path)?;
            let samples =
                completed(hit, &hits.response, path.added_damping).in_step("problem.path")?;
            let noise = match (&seen.noise, &lines) {
                (Noise::Lines(_), Some(lines)) => Noise::Lines(lines.noise.clone()),
                (other, _) => other.clone(),
            };
            Ok(Seen {
                path,
                samples,
                noise,
                blows: lines,
                unit: seen.unit,
            })
        });
        let seen: Vec<Seen> = seen.collect::<Result<_, RodlabError>>()?;
        let measured = hit
            .channel(force_of(sources))
            .in_step("problem.path")?
            .to_vec();
        let measured = problem.in_band(&measured);
        let largest = largest(&measured);
        // the time in which the force acts is placed about the peak of each hit, wherever the hit
        // is in its record
        let (window, acting) = match (span, largest) {
            (Some(span), Some((at, _))) => {
                let window = span.about(at, measured.len());
                let acting = BlowSpan::interval(&window, problem.sampling_rate_hz);
                (window, Some(acting))
            }
            _ => (window.clone(), problem.acting),
        };
        if largest.is_some_and(|(at, _)| !window.contains(&at)) {
            outcome.warn(format!(
                "The peak of calibration hit {} is outside the time in which the force acts: the hits cannot show how good the reconstruction is.",
                index + 1
            ));
            return Ok(None);
        }
        let blow = Blow {
            seen: seen.iter().map(SeenBlow::of).collect(),
            sampling_rate_hz: problem.sampling_rate_hz,
            acting,
        };
        let again = blow.force(problem.sheet, fixed).map_err(step)?;
        let cut = |samples: &[f64]| samples.get(window.clone()).unwrap_or_default().to_vec();
        let errors = again.error.known().map(|error| cut(error.standard_error()));
        let history = again.history;
        forces.push((
            ForceHistory::new(0.0, history.time_step(), cut(history.force())).map_err(step)?,
            cut(&measured),
            errors.unwrap_or_default(),
        ));
        context.progress.one_more();
    }
    let blows: Vec<CalibrationBlow<'_>> = forces
        .iter()
        .map(|(reconstructed, measured, errors)| CalibrationBlow {
            reconstructed,
            measured,
            standard_error: (!errors.is_empty()).then_some(errors.as_slice()),
        })
        .collect();
    let longest = forces.iter().map(|(_, measured, _)| measured.len()).max();
    CalibrationScatter::of(&blows, 0..longest.unwrap_or(0))
        .map(Some)
        .map_err(step)
}
