//! Responses from accepted hits: averaged, merged, completed and converted.

use labio::{
    AddedDamping, AveragedSpectra, Coherence, CompletedResponse, Departure, Detrend, Estimator,
    FrequencyResponse, LabioError, LineValidity, MergedResponse, Record, ResponseKind, RigidBand,
    RigidBody, SpectrumAverager, Window,
};

use super::sheet::{DetrendSheet, FrfSheet, WindowSheet};
use crate::hits::{expect_noise, level_at_rest};
use crate::job::JobContext;
use crate::median::upper_median;
use crate::responses::{JudgedLine, in_words, judged_lines, leakage_of};
use crate::{InStep, RodlabError};

/// A response with its errors and objections.
#[derive(Debug)]
pub(super) struct Estimated {
    /// The response, of the requested kind.
    pub(super) response: FrequencyResponse,
    /// Coherence of every test; none for a single hit.
    pub(super) coherences: Vec<Coherence>,
    /// The objection to each line; `None` for a valid line.
    pub(super) objections: Vec<Option<&'static str>>,
    /// The responses of two hammers, and their agreement.
    pub(super) merged: Option<MergedResponse>,
    /// Response completed by the weighed mass, with the mass that the lines indicate.
    pub(super) completed: Option<CompletedResponse>,
    /// Largest relative standard uncertainty that is common to all lines: due to the sensor chains,
    /// and to a disagreement of two hammers.
    pub(super) calibration: f64,
    /// Relative systematic error of each line, due to motion at the end of the record or, for
    /// segments, to the width of the lines; `None` if it is not known.
    pub(super) leakage: Option<Vec<f64>>,
    /// Cause of the systematic error.
    pub(super) cause: &'static str,
    /// Multiple coherence; `None` for a single input.
    pub(super) multiple: Option<Vec<f64>>,
}

/// Objection to the lines of a test with a single hit.
const ONE_HIT: &str = "error not known from one hit";

/// Objection to a line whose bias due to noise of the channels exceeds its random error.
const BIASED: &str = "bias by noise at rest larger than the random error";

/// Objection to a line that noise may have made coherent.
const WEAK: &str = "weaker than four standard errors of the neighbouring lines";

/// Objection to a line whose relative error due to the end of the record exceeds one half.
const RINGS_ON: &str = "rings beyond the end of the record";

/// Cause of the systematic error with hits.
const BY_THE_END: &str = "by truncation";

/// Cause of the systematic error with segments.
pub(super) const BY_WIDTH: &str = "by the width of the lines";

/// Objection to a line that is wider than the feature it shows.
const TOO_WIDE: &str = "feature narrower than the lines";

/// Relative error by leakage above which a line is refused.
const MOST_LEAKAGE: f64 = 0.5;

/// Number of standard deviations by which the number of coherent lines must exceed the number
/// expected by chance.
const BEYOND_CHANCE: f64 = 4.0;

impl Estimated {
    /// Returns true if more of `n_lines` lines are coherent than noise alone would make coherent.
    /// With noise alone, each line is coherent independently of the others, with the probability
    /// that at least one test exceeds the level of chance. Always true for a single hit, which has
    /// no coherence.
    pub(super) fn is_more_than_chance(&self, n_coherent: usize, n_lines: usize) -> bool {
        if self.coherences.is_empty() {
            return true;
        }
        let tests = i32::try_from(self.coherences.len()).unwrap_or(i32::MAX);
        let passes = 1.0 - (1.0 - Coherence::CHANCE).powi(tests);
        let expected = passes * n_lines as f64;
        n_coherent as f64 > expected + BEYOND_CHANCE * (expected * (1.0 - passes)).sqrt()
    }

    /// Returns true if the line contains information, even if its error is unknown.
    pub(super) fn is_measured(&self, line: usize) -> bool {
        let objection = self.objections.get(line).copied();
        objection.is_some_and(|objection| objection.is_none_or(|reason| reason == ONE_HIT))
    }

    /// Returns the median relative error due to leakage of the valid lines, and the median relative
    /// random error of their complex values; `None` if one of the two is unknown.
    pub(super) fn median_leakage(&self) -> Option<(f64, f64)> {
        let errors = self.response.random_error()?;
        let lines = self.leakage.as_ref()?.iter().zip(&errors).enumerate();
        let known = lines.filter(|(line, (leak, _))| self.is_valid(*line) && leak.is_finite());
        let (leaks, errors): (Vec<f64>, Vec<f64>) = known
            .map(|(_, (leak, error))| (*leak, std::f64::consts::SQRT_2 * error.magnitude))
            .unzip();
        upper_median(leaks).zip(upper_median(errors))
    }

    /// Returns the line of `lines` with the largest relative error due to leakage, and this error.
    /// Lines whose leakage does not exceed the random error of the complex value are not
    /// considered.
    pub(super) fn largest_leakage(&self, lines: &[usize]) -> Option<(usize, f64)> {
        let errors = self.response.random_error()?;
        let leakage = self.leakage.as_ref()?;
        let exceeding = lines.iter().filter_map(|line| {
            let (leak, error) = (leakage.get(*line)?, errors.get(*line)?);
            let random = std::f64::consts::SQRT_2 * error.magnitude;
            (leak.is_finite() && *leak > random).then_some((*line, *leak))
        });
        exceeding.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns true if the line is valid, or if the only objection is that noise may have made it
    /// coherent.
    pub(super) fn is_coherent(&self, line: usize) -> bool {
        let objection = self.objections.get(line).copied();
        objection.is_some_and(|objection| objection.is_none_or(|reason| reason == WEAK))
    }

    pub(super) fn is_valid(&self, line: usize) -> bool {
        self.objections.get(line).is_some_and(Option::is_none)
    }
}

/// Returns the exponential window of the sheet for hits of `duration` \[s\].
pub(super) fn added_damping(
    sheet: &FrfSheet,
    duration: f64,
) -> Result<Option<AddedDamping>, RodlabError> {
    let window = sheet.exponential_window.as_ref();
    window
        .map(|window| window.over(duration))
        .transpose()
        .in_step("exponential_window")
}

/// Returns the trend that is removed from `hits` before the windows are applied.
fn detrend(sheet: &FrfSheet, hits: &[&Record]) -> Result<Detrend, RodlabError> {
    match sheet.detrend {
        Some(DetrendSheet::Nothing) => Ok(Detrend::None),
        Some(DetrendSheet::Mean) => Ok(Detrend::Mean),
        Some(DetrendSheet::Line) => Ok(Detrend::Linear),
        Some(DetrendSheet::Rest) => match level_at_rest(hits, "detrend")? {
            Detrend::None => Err(RodlabError::request(
                "detrend",
                "Rest",
                "16 samples of rest or more before the impact in every accepted hit",
            )),
            rest => Ok(rest),
        },
        None => level_at_rest(hits, "detrend"),
    }
}

/// Returns an averager for `hits` with the windows of the sheet; an error if there is no hit.
pub(super) fn averager(
    sheet: &FrfSheet,
    hits: &[&Record],
) -> Result<SpectrumAverager, RodlabError> {
    let Some(first) = hits.first() else {
        return Err(RodlabError::step("averaging hits", no_hit()));
    };
    let window = sheet.window_or_default().window();
    let mut averager = SpectrumAverager::for_records_like(first, window)
        .in_step("window")?
        .with_detrend(detrend(sheet, hits)?);
    if let Some(force_window) = &sheet.force_window {
        averager = averager
            .with_force_window(&sheet.input, force_window.window("force_window")?)
            .in_step("force_window")?;
    }
    if let Some(damping) = added_damping(sheet, first.duration())? {
        averager = averager
            .with_exponential_window(damping)
            .in_step("exponential_window")?;
    }
    if window == Window::Rectangular {
        averager = averager.with_completion().in_step("averaging hits")?;
    }
    Ok(averager)
}

fn no_hit() -> LabioError {
    LabioError::TooFewAverages {
        estimate: "an averaged spectrum",
        found: 0,
        expected: 1,
    }
}

/// Returns the change of the response of `output` by windows, and by removing a trend other than
/// the level at rest. `None` if the sheet uses neither.
pub(super) fn departure(
    sheet: &FrfSheet,
    hits: &[&Record],
    spectra: &AveragedSpectra,
    output: &str,
    context: &JobContext<'_>,
) -> Result<Option<Departure>, RodlabError> {
    let plain = FrfSheet {
        window: None,
        force_window: None,
        detrend: None,
        ..sheet.clone()
    };
    let rectangular = matches!(sheet.window, None | Some(WindowSheet::Rectangular));
    let at_rest = matches!(sheet.detrend, None | Some(DetrendSheet::Rest));
    if rectangular && at_rest && sheet.force_window.is_none() {
        return Ok(None);
    }
    let response = |spectra: &AveragedSpectra| {
        spectra
            .response(Estimator::H1, &sheet.input, output)
            .in_step("response without windows")
    };
    let without = response(&self::spectra(&plain, hits, context)?)?;
    response(spectra)?
        .departure_from(&without)
        .in_step("response without windows")
}

/// Returns the averaged spectra of `hits`; an error if there is no hit.
pub(super) fn spectra(
    sheet: &FrfSheet,
    hits: &[&Record],
    context: &JobContext<'_>,
) -> Result<AveragedSpectra, RodlabError> {
    let averaging = |error| RodlabError::step("averaging hits", error);
    let mut averager = averager(sheet, hits)?;
    context.progress.begins("averaging hits", hits.len());
    for hit in hits {
        context.check_cancelled()?;
        averager.add(hit).map_err(averaging)?;
        context.progress.one_more();
    }
    averager.spectra().map_err(averaging)
}

/// Returns the response from the input to `output` of one or two tests. `hits` contains one hit of
/// each test, from which the sensor chain is read.
pub(super) fn estimate(
    sheet: &FrfSheet,
    tests: &[AveragedSpectra],
    output: &str,
    hits: &[&Record],
) -> Result<Estimated, RodlabError> {
    let input = sheet.input.as_str();
    let refused = |error| RodlabError::step(format!("response of `{output}`"), error);
    let estimator = sheet.estimator.unwrap_or_default();
    let with_sensors = tests
        .iter()
        .zip(hits)
        .map(|(test, hit)| Ok((test.clone(), sensors(hit, [input, output])?)))
        .collect::<Result<Vec<_>, _>>()
        .map_err(refused)?;
    let (response, merged) = if let ([_, _, ..], Some(second)) = (tests, &sheet.second_hammer) {
        let merge = second.merge.unwrap_or_default();
        let merged = merge
            .merge(&with_sensors, estimator, (input, output))
            .in_step("second_hammer")?;
        (merged.response.clone(), Some(merged))
    } else {
        let none = LabioError::TooFewAverages {
            estimate: "a frequency response",
            found: 0,
            expected: 1,
        };
        let response = match with_sensors.first() {
            Some((test, sensors)) => test
                .response(estimator, input, output)
                .and_then(|response| response.with_common_error(*sensors)),
            None => Err(none),
        };
        (response.map_err(refused)?, None)
    };
    let shares = merged.as_ref().map(|merged| merged.shares.row(0).to_vec());
    let leakage = leakage_of(tests, input, output, shares.as_deref()).map_err(refused)?;
    let mut coherences = Vec::new();
    let mut of_one_hit = Vec::with_capacity(tests.len());
    for test in tests {
        expect_noise(test, (input, output), &format!("response of `{output}`"))?;
        let coherence = match test.coherence(input, output) {
            Ok(coherence) => Some(coherence),
            // the coherence of a single hit is not defined
            Err(LabioError::TooFewAverages { .. }) => None,
            Err(error) => return Err(refused(error)),
        };
        of_one_hit.push(coherence.is_none());
        coherences.extend(coherence);
    }
    let mut objections = objections(&response, &coherences, merged.as_ref())?;
    for (line, objection) in objections.iter_mut().enumerate() {
        let first = merged
            .as_ref()
            .map_or(Some(&1.0), |merged| merged.shares.get((0, line)));
        let first = first.copied().unwrap_or(f64::NAN);
        let alone = of_one_hit.iter().zip([first, 1.0 - first]);
        if objection.is_none()
            && alone
                .into_iter()
                .any(|(alone, share)| *alone && share > 0.0)
        {
            *objection = Some(ONE_HIT);
        }
    }
    finish(
        sheet,
        Estimated {
            response,
            coherences,
            objections,
            merged,
            completed: None,
            calibration: 0.0,
            leakage,
            cause: BY_THE_END,
            multiple: None,
        },
    )
}

/// Returns the response from `input` to `output`, averaged over segments, with all inputs of the
/// sheet. `halved` contains the spectra of segments of half the length.
pub(super) fn of_segments(
    sheet: &FrfSheet,
    [spectra, halved]: [&AveragedSpectra; 2],
    (input, output): (&str, &str),
    record: &Record,
) -> Result<Estimated, RodlabError> {
    let place = format!("response of `{output}`");
    let refused = |error| RodlabError::step(place.clone(), error);
    let estimator = sheet.estimator.unwrap_or_default();
    let inputs = sheet.inputs();
    let sensors = sensors(record, [input, output]).map_err(refused)?;
    let (response, halved, coherence, multiple) = if sheet.further_inputs.is_empty() {
        expect_noise(spectra, (input, output), &place)?;
        let coherence = spectra.coherence(input, output).map_err(refused)?;
        let of = |spectra: &AveragedSpectra| spectra.response(estimator, input, output);
        (of(spectra), of(halved), coherence, None)
    } else {
        let of = |spectra: &AveragedSpectra| spectra.multi_input(&inputs, output);
        let all = of(spectra).map_err(refused)?;
        let coherence = all.coherence_with(input).map_err(refused)?;
        let mut multiple = coherence.clone();
        multiple.values.clone_from(&all.multiple_coherence);
        if multiple.is_one_to_rounding() {
            return Err(RodlabError::NoNoise {
                place,
                input: inputs.join("`, `"),
                output: output.to_owned(),
                hits: spectra.n_averages(),
            });
        }
        let halved = of(halved).and_then(|all| all.response_to(input));
        (
            all.response_to(input),
            halved,
            coherence,
            Some(multiple.values),
        )
    };
    let response = response
        .and_then(|response| response.with_common_error(sensors))
        .map_err(refused)?;
    let leakage = halved
        .and_then(|halved| response.resolution_error(&halved))
        .map_err(refused)?;
    let coherences = vec![coherence];
    finish(
        sheet,
        Estimated {
            objections: objections(&response, &coherences, None)?,
            response,
            coherences,
            merged: None,
            completed: None,
            calibration: 0.0,
            leakage: Some(leakage),
            cause: BY_WIDTH,
            multiple,
        },
    )
}

/// Marks lines with a large systematic error as invalid, completes the response by the weighed
/// mass, and converts it.
fn finish(sheet: &FrfSheet, estimated: Estimated) -> Result<Estimated, RodlabError> {
    let Estimated {
        response,
        mut objections,
        mut leakage,
        ..
    } = estimated;
    let leaks = leakage.iter().flatten();
    for (objection, leak) in objections.iter_mut().zip(leaks) {
        if objection.is_none() && *leak > MOST_LEAKAGE {
            *objection = Some(if estimated.cause == BY_WIDTH {
                TOO_WIDE
            } else {
                RINGS_ON
            });
        }
    }
    let completed = match &sheet.weighed_mass {
        None => None,
        Some(weighed) => {
            let mass = weighed.mass.with_uncertainty();
            let band = RigidBand {
                from_hz: weighed.below.si(),
                to_hz: weighed.fitted_to.si(),
            };
            let body = RigidBody::new(mass.value, mass.uncertainty()).in_step("weighed_mass")?;
            let completed = body.complete(&response, band).in_step("weighed_mass")?;
            for objection in objections.iter_mut().take(completed.first_measured) {
                *objection = None;
            }
            if let Some(leaks) = &mut leakage {
                leaks
                    .iter_mut()
                    .take(completed.first_measured)
                    .for_each(|leak| *leak = 0.0);
            }
            Some(completed)
        }
    };
    let response = completed
        .as_ref()
        .map_or(response, |completed| completed.response.clone());
    let response = match sheet.kind.unwrap_or_default().kind() {
        Some(kind) => response.to_kind(kind).in_step("kind")?,
        None => response,
    };
    for (objection, validity) in objections.iter_mut().zip(&response.validity) {
        if *validity != LineValidity::Valid {
            *objection = Some(in_words(*validity));
        }
    }
    let common = response.common_error.iter().flatten();
    let calibration = common
        .copied()
        .filter(|error| error.is_finite())
        .fold(0.0, f64::max);
    Ok(Estimated {
        response,
        objections,
        completed,
        calibration,
        leakage,
        ..estimated
    })
}

/// Returns the relative standard uncertainty due to the sensor chains of these channels.
fn sensors(hit: &Record, [first, second]: [&str; 2]) -> Result<f64, LabioError> {
    let both = hit.sensor_error(first)?.combined(hit.sensor_error(second)?);
    Ok(both.gain)
}

/// Returns the objection to each line: no information, a coherence that noise alone would reach, a
/// value below four standard errors of the neighbouring lines, or a bias due to the noise at rest
/// that exceeds the random error.
fn objections(
    response: &FrequencyResponse,
    coherences: &[Coherence],
    merged: Option<&MergedResponse>,
) -> Result<Vec<Option<&'static str>>, RodlabError> {
    let objection = |(validity, line): (&LineValidity, &JudgedLine)| {
        if *validity != LineValidity::Valid {
            return Some(in_words(*validity));
        }
        match (line.is_coherent, merged) {
            (true, _) if line.is_weak => Some(WEAK),
            (true, _) => line.is_biased.then_some(BIASED),
            (false, None) => Some("coherence no higher than by chance"),
            (false, Some(_)) => Some("coherence no higher than by chance in both tests"),
        }
    };
    let judged = judged_lines(response, coherences, merged)?;
    Ok(response
        .validity
        .iter()
        .zip(&judged)
        .map(objection)
        .collect())
}

/// Refuses a kind of response, or a weighed mass, that does not suit the channels.
pub(super) fn check_kind(
    sheet: &FrfSheet,
    hit: &Record,
    (from, output): (&str, &str),
) -> Result<(), RodlabError> {
    let quantity = |name: &str| {
        let found = hit.channels().iter().find(|c| c.name() == name);
        found.map(|channel| (channel.quantity(), channel.to_string()))
    };
    let (Some((from, input)), Some((to, output))) = (quantity(from), quantity(output)) else {
        return Ok(());
    };
    if ResponseKind::between(from, to).is_some() {
        return Ok(());
    }
    let expected = format!("a force and a motion as input and output, not {output} over {input}");
    match (sheet.kind.unwrap_or_default().kind(), &sheet.weighed_mass) {
        (Some(kind), _) => Err(RodlabError::request("kind", kind.to_string(), expected)),
        (None, Some(_)) => Err(RodlabError::request("weighed_mass", "stated", expected)),
        (None, None) => Ok(()),
    }
}
