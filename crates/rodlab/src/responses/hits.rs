//! Frequency response from hits.

use labio::hits::Criteria;
use labio::{
    AddedDamping, AveragedSpectra, Estimator, ForceWindow, FrequencyResponse, LabioError,
    MergedResponse, Quantity, Record, RestNoise, SensorError, SpectrumAverager, Window,
};
use serde::Deserialize;

use super::leakage_of;
use crate::context::JobContext;
use crate::digits::short;
use crate::hits::{
    FoundHits, HitKind, HitsSheet, expect_independent, expect_noise, level_at_rest, silent_samples,
};
use crate::median::upper_median;
use crate::outcome::Setting;
use crate::records::{Records, expect_motion, expect_quantity};
use crate::sheet::{Duration, Exact, Ratio, Time};
use crate::{InStep, Outcome, RodlabError};

/// Hits with a force and a response.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HitsSource {
    /// The files and their channels.
    pub records: Records,
    /// The selection of the hits that are averaged.
    #[serde(default)]
    pub hits: HitsSheet,
    /// Channel of the force, such as `"hammer"`.
    pub force: String,
    /// Channel of the response, such as `"face"`.
    pub response: String,
    /// Estimator of the response from the averaged spectra; by default `H1`, for noise on the
    /// response.
    pub estimator: Option<Estimator>,
    /// Window that sets the force to 0 outside the contact of the hammer.
    pub force_window: Option<ForceWindowSheet>,
    /// Exponential window on both channels, stated by its weight at the end of a hit, such as
    /// `"1 %"`.
    pub exponential_window: Option<Exact<Ratio>>,
    /// Time before an impact in which the channels are at rest, such as `"20 ms"`. The noise for
    /// `Hs`, and the bias of the other estimators, are determined in it. By default the pre-trigger
    /// of hits that are cut by a trigger, less the rise time of the impact, or else the rest found
    /// in the records.
    pub silent: Option<Exact<Duration>>,
}

/// Method of combining two tests line by line.
///
/// The errors stated by the two methods have the same coverage within 1 %. Weighting gives smaller
/// errors if the variances are well known. State `LargerInput` for tests of about three hits whose
/// noise at rest is not known: their variances are too uncertain for weights.
/// `docs/theory/spectra.md` compares the two methods.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum MergeSheet {
    /// Weighting of the two tests by the inverse of their relative variances.
    #[default]
    InverseVariance,
    /// Choice of the test with the larger coherent spectrum of the input (Ödeen 1993, paper E,
    /// section 3.1).
    #[serde(alias = "LargerForce")]
    LargerInput,
}

impl MergeSheet {
    /// Returns the response merged from `tests`. Each test has the relative standard uncertainty of
    /// its sensors, which is common to all of its lines.
    ///
    /// # Errors
    ///
    /// The errors of [`MergedResponse::by_inverse_variance`] and
    /// [`MergedResponse::by_larger_input`].
    pub fn merge(
        self,
        tests: &[(AveragedSpectra, f64)],
        estimator: Estimator,
        (input, output): (&str, &str),
    ) -> Result<MergedResponse, LabioError> {
        let responses = tests
            .iter()
            .map(|(spectra, sensors)| {
                let response = spectra.response(estimator, input, output)?;
                response.with_common_error(*sensors)
            })
            .collect::<Result<Vec<FrequencyResponse>, _>>()?;
        match self {
            Self::InverseVariance => MergedResponse::by_inverse_variance(&responses),
            Self::LargerInput => {
                let levels = tests
                    .iter()
                    .map(|(spectra, _)| spectra.auto(input))
                    .collect::<Result<Vec<_>, _>>()?;
                let levels: Vec<&[f64]> = levels.iter().map(Vec::as_slice).collect();
                MergedResponse::larger_of(&responses, &levels)
            }
        }
    }
}

/// Returns one clause for each difference between two hammers that exceeds its error; `second` is
/// the name of the second hammer.
#[must_use]
pub fn disagreements(merged: &MergedResponse, second: &str, output: &str) -> Vec<String> {
    let mut said = Vec::new();
    for agreement in merged.agreement.iter().flatten() {
        if !agreement.explains_gain() {
            said.push(format!(
                "`{output}`: {second} gives {:.4} times the response of the other hammer, ± {} %, on {} common lines: the sensors explain ± {} %, and half of the power of the difference is included in the error that all lines share",
                agreement.gain,
                short(100.0 * agreement.relative_error),
                agreement.n_lines,
                short(100.0 * agreement.expected),
            ));
        }
        if !agreement.explains_delay() {
            said.push(format!(
                "`{output}`: the response to {second} is {} us {} than the response to the other hammer, ± {} us",
                short(1e6 * agreement.delay.abs()),
                if agreement.delay > 0.0 {
                    "later"
                } else {
                    "earlier"
                },
                short(1e6 * agreement.delay_error),
            ));
        }
    }
    let inflated = merged.inflation.iter().filter(|factor| **factor > 1.0);
    let (count, most) = inflated.fold((0, 1.0_f64), |(n, most), f| (n + 1, most.max(*f)));
    if count > 0 {
        said.push(format!(
            "`{output}`: the hammers differ by more than their errors on {count} lines, whose errors are therefore increased by a factor of up to {}",
            short(most.sqrt())
        ));
    }
    said
}

/// Returns `spectra` with the noise of both channels, measured in the silence before these hits, if
/// the length of the silence is known.
pub(crate) fn with_silence(
    mut spectra: AveragedSpectra,
    hits: &[&Record],
    n_silent: Option<usize>,
    channels: &[&str],
    field: &str,
) -> Result<AveragedSpectra, RodlabError> {
    let Some(n_silent) = n_silent.filter(|n| *n >= RestNoise::FEWEST_SAMPLES) else {
        return Ok(spectra);
    };
    for channel in channels {
        let noise = RestNoise::before(hits, channel, n_silent).in_step(field)?;
        spectra = spectra.with_rest_noise(channel, &noise).in_step(field)?;
    }
    Ok(spectra)
}

/// Window on the force. It is 1 from `start` to `end` and falls to 0 over `taper` on either side;
/// times are counted from the start of the hit.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceWindowSheet {
    /// Beginning of the flat part, such as `"8 ms"`.
    pub start: Exact<Time>,
    /// End of the flat part, such as `"14 ms"`.
    pub end: Exact<Time>,
    /// Length of either edge, such as `"1 ms"`.
    pub taper: Exact<Time>,
}

impl ForceWindowSheet {
    /// Returns the window; `field` is its place in the sheet.
    pub(crate) fn window(&self, field: &str) -> Result<ForceWindow, RodlabError> {
        ForceWindow::new(self.start.si(), self.end.si(), self.taper.si()).in_step(field)
    }
}

impl HitsSource {
    /// Reads the files, and finds and judges the hits. Files, settings, warnings and all decisions
    /// are entered in `outcome`.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] with the place below `field` for files, for channels, and for a response
    /// that is not a motion.
    pub fn read(
        &self,
        context: &JobContext<'_>,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<FoundHits, RodlabError> {
        let place = format!("{field}.records");
        let loaded = self.records.load(context.folder, &place)?;
        if let Some(first) = loaded.records.first() {
            let record = &first.record;
            expect_quantity(
                record,
                &self.force,
                Quantity::Force,
                &format!("{field}.force"),
            )?;
            expect_motion(record, &self.response, &format!("{field}.response"))?;
        }
        let records = loaded.entered_in(outcome);
        let weigh = |criteria: Criteria| match &self.exponential_window {
            None => Ok(criteria),
            Some(weight) => criteria
                .with_end_weight(weight.si())
                .in_step(format!("{field}.exponential_window")),
        };
        let place = format!("{field}.hits");
        let kind = HitKind::Hammer;
        let mut found = (self.hits).find_weighed(kind, weigh, records, &self.force, &place)?;
        let window = (self.force_window.is_some(), None);
        found.judge((&self.force, &[&self.response]), window, outcome)?;
        outcome.settings.extend(Self::defaults(field));
        outcome.doubt_all(expect_independent(
            &[&found],
            &[&self.force, &self.response],
        )?);
        Ok(found)
    }

    /// Returns the defaults of the fields that the sheet does not state, except those of the hits.
    fn defaults(field: &str) -> [Setting; 3] {
        let estimator = format!("{:?}", Estimator::default());
        [
            Setting::by_default(format!("{field}.estimator"), estimator),
            Setting::by_default(format!("{field}.force_window"), "none"),
            Setting::by_default(format!("{field}.exponential_window"), "none"),
        ]
    }

    /// Returns the averaged spectra of `hits`, after subtraction of the level at rest before the
    /// impact, and completed by the motion after the end of each hit. It is an error if there is no
    /// hit.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for an error of `labio`; [`RodlabError::NoNoise`] for several hits
    /// without noise.
    pub fn spectra<'a>(
        &self,
        hits: impl IntoIterator<Item = &'a Record>,
        context: &JobContext<'_>,
        field: &str,
    ) -> Result<AveragedSpectra, RodlabError> {
        let averaging = |error| RodlabError::step(format!("{field}, averaging hits"), error);
        let hits: Vec<&Record> = hits.into_iter().collect();
        let Some(first) = hits.first() else {
            return AveragedSpectra::of([], Window::Rectangular).map_err(averaging);
        };
        let duration = first.duration();
        let mut averager = SpectrumAverager::for_records_like(first, Window::Rectangular)
            .and_then(SpectrumAverager::with_completion)
            .map_err(averaging)?
            .with_detrend(level_at_rest(&hits, field)?);
        if let Some(window) = &self.force_window {
            let gate = window.window(&format!("{field}.force_window"))?;
            averager = averager
                .with_force_window(&self.force, gate)
                .in_step(format!("{field}.force_window"))?;
        }
        if let Some(weight) = &self.exponential_window {
            let place = |error| RodlabError::step(format!("{field}.exponential_window"), error);
            let damping = AddedDamping::to_end_weight(weight.si(), duration).map_err(place)?;
            averager = averager.with_exponential_window(damping).map_err(place)?;
        }
        for hit in hits {
            context.check_cancelled()?;
            averager.add(hit).map_err(averaging)?;
        }
        let spectra = averager.spectra().map_err(averaging)?;
        expect_noise(&spectra, (&self.force, &self.response), field)?;
        Ok(spectra)
    }

    /// Returns the number of samples before an impact in which the channels are at rest, if it is
    /// known, and enters it in `outcome`.
    pub(crate) fn silent_samples(
        &self,
        found: &FoundHits,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<Option<usize>, RodlabError> {
        let place = format!("{field}.silent");
        let channels = [self.force.as_str(), self.response.as_str()];
        let rest = (place.as_str(), Some(&channels[..]));
        silent_samples(found, self.silent.as_ref(), rest, &mut outcome.settings)
    }

    /// Judges the effect of the force window on the response of `hits`; an effect beyond the stated
    /// errors is a doubt.
    pub(crate) fn judge_window(
        &self,
        hits: &[&Record],
        spectra: &AveragedSpectra,
        context: &JobContext<'_>,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<(), RodlabError> {
        if self.force_window.is_none() {
            return Ok(());
        }
        let plain = Self {
            force_window: None,
            ..self.clone()
        };
        let plain = plain.spectra(hits.iter().copied(), context, field)?;
        let h1 = |spectra: &AveragedSpectra| spectra.h1(&self.force, &self.response);
        let departure = h1(spectra)
            .and_then(|with| with.departure_from(&h1(&plain)?))
            .in_step(format!("{field}.force_window"))?;
        if let Some(departure) = departure.filter(labio::Departure::is_beyond_errors) {
            outcome.doubt(format!(
                "{field}: the force window changes the response by {} % in the median and by {} % or more on a tenth of the lines, but its stated error is {} %: it cuts off part of the hits",
                short(100.0 * departure.median),
                short(100.0 * departure.of_a_tenth),
                short(100.0 * departure.own)
            ));
        }
        Ok(())
    }

    /// Adds the error due to truncated records to the variance of `response`, and warns if it
    /// exceeds the random error in the median. `shares` are the shares of the first of two tests in
    /// the lines.
    pub(crate) fn add_leakage(
        &self,
        response: FrequencyResponse,
        tests: &[(AveragedSpectra, f64)],
        shares: Option<&[f64]>,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<FrequencyResponse, RodlabError> {
        let leakage = leakage_of(
            tests.iter().map(|(test, _)| test),
            &self.force,
            &self.response,
            shares,
        )
        .in_step(field)?;
        let (Some(leakage), Some(variance)) = (leakage, &response.variance) else {
            return Ok(response);
        };
        let lines = response.values.iter().zip(variance).zip(&leakage);
        let (known, mut figures): (Vec<f64>, Vec<[f64; 2]>) = lines
            .map(|((value, variance), leak)| {
                let known = (leak * value.norm()).powi(2);
                (known, [*leak, variance.sqrt() / value.norm()])
            })
            .unzip();
        figures.retain(|figures| figures.iter().all(|figure| figure.is_finite()));
        let median = |which: fn(&[f64; 2]) -> f64| upper_median(figures.iter().map(which));
        let of_leakage = median(|[leak, _]| *leak);
        if let (Some(leak), Some(random)) = (of_leakage, median(|[_, random]| *random))
            && leak > random
        {
            outcome.warn(format!(
                "{field}: the body still moves at the end of the records. The error of the truncation is {} % of a line in the median, compared with a random error of {} %; the stated errors include both. Record longer.",
                short(100.0 * leak),
                short(100.0 * random)
            ));
        }
        response.with_known_variance(&known).in_step(field)
    }

    /// Returns the standard uncertainties of scale and delay of the whole response, due to the
    /// sensor chains of `hit`.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a missing channel.
    pub fn calibration(&self, hit: &Record, field: &str) -> Result<SensorError, RodlabError> {
        let of = |channel: &str| hit.sensor_error(channel).in_step(field);
        Ok(of(&self.force)?.combined(of(&self.response)?))
    }
}
