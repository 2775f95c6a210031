//! Passages of the pulse in the first shot: its first sample at each gauge and, for a single gauge,
//! the windows of the incident and the reflected pulse.

use std::ops::Range;

use super::BarSheet;
use crate::RodlabError;
use crate::job::JobContext;
use crate::records::channel_called;
use crate::sheet::{Exact, Time};

/// Fraction of the peak above which a sample belongs to the pulse.
const OF_PULSE: f64 = 0.02;
/// Fraction of the peak beyond which a sample of the other sign belongs to the reflected pulse.
const OF_REFLECTED: f64 = 0.05;
/// Number of standard deviations of the noise above which a sample does not count as noise.
const NO_NOISE: f64 = 8.0;
/// Shortest rest of the gauge between incident and reflected pulse, as a fraction of the time from
/// front to front.
const QUIET: f64 = 0.03;
/// Largest relative error of the guess of the wave speed.
const GUESS: f64 = 0.25;

/// Start and end, measured from the beginning of a record.
pub(super) type Window = (Exact<Time>, Exact<Time>);

/// The first shot, and the pulse in it.
pub(super) struct Passages {
    pub(super) rate_hz: f64,
    /// History of each gauge minus its level at rest.
    pub(super) histories: Vec<Vec<f64>>,
    /// First sample of the pulse at each gauge.
    pub(super) first: Vec<usize>,
    /// Samples of the incident and of the reflected pulse, for a single gauge.
    pub(super) windows: Option<[Range<usize>; 2]>,
    /// Absolute value above which a sample of the first gauge belongs to the pulse.
    threshold: f64,
}

impl Passages {
    pub(super) fn of(sheet: &BarSheet, context: &JobContext<'_>) -> Result<Self, RodlabError> {
        let loaded = sheet.records.load(context.folder, "records")?;
        let Some(named) = loaded.records.first() else {
            return Err(RodlabError::request(
                "records",
                "no record",
                "a record of a shot",
            ));
        };
        let record = &named.record;
        let rate_hz = record.sampling_rate_hz();
        let mut found = Self {
            rate_hz,
            histories: Vec::new(),
            first: Vec::new(),
            windows: None,
            threshold: 0.0,
        };
        for (at, gauge) in sheet.gauges.iter().enumerate() {
            let field = format!("gauges[{at}].channel");
            channel_called(record.channels(), &gauge.channel, &field)?;
            let history = record
                .channel(&gauge.channel)
                .map_err(|error| RodlabError::step(field, error))?;
            let (history, threshold, first) = at_rest(&history.to_vec(), rate_hz, sheet, at)?;
            if at == 0 {
                found.threshold = threshold;
            }
            if found.first.last().is_some_and(|before| *before >= first) {
                return Err(RodlabError::request(
                    format!("gauges[{at}]"),
                    format!(
                        "`{}`, which the pulse reaches after {:.4} ms, earlier than the gauge stated before it",
                        gauge.channel,
                        1e3 * first as f64 / rate_hz
                    ),
                    "gauges in the order in which the pulse passes them: are two channels interchanged, or are the distances measured from the struck end?",
                ));
            }
            found.histories.push(history);
            found.first.push(first);
        }
        if sheet.gauges.len() == 1 {
            found.windows = Some(found.windows_of(sheet)?);
        }
        Ok(found)
    }

    /// Returns the windows of a single gauge in the form of a sheet.
    pub(super) fn stated_windows(&self) -> Result<Option<[Window; 2]>, RodlabError> {
        let stated = |window: &Range<usize>| -> Result<Window, RodlabError> {
            Ok((self.time(window.start)?, self.time(window.end)?))
        };
        match &self.windows {
            Some([incident, reflected]) => Ok(Some([stated(incident)?, stated(reflected)?])),
            None => Ok(None),
        }
    }

    /// Returns the time of a sample in the form of a sheet.
    fn time(&self, sample: usize) -> Result<Exact<Time>, RodlabError> {
        let text = format!("{} us", 1e6 * sample as f64 / self.rate_hz);
        text.parse()
            .map_err(|error| RodlabError::step("the window of a pulse", error))
    }

    /// Returns the windows of the incident and of the reflected pulse at the only gauge.
    fn windows_of(&self, sheet: &BarSheet) -> Result<[Range<usize>; 2], RodlabError> {
        let (Some(history), Some(first), Some(gauge)) = (
            self.histories.first(),
            self.first.first().copied(),
            sheet.gauges.first(),
        ) else {
            return Err(RodlabError::request("gauges", "empty", "one gauge"));
        };
        let Some(speed) = &sheet.wave_speed else {
            return Err(RodlabError::request(
                "wave_speed",
                "missing",
                format!(
                    "a guess within {} %: with one gauge, the reflection is recognised by its travel time",
                    100.0 * GUESS
                ),
            ));
        };
        let ms = |samples: usize| 1e3 * samples as f64 / self.rate_hz;
        let Reflection { end, front } = self.reflection(history, first);
        let way = 2.0 * gauge.distance() / speed.si();
        let overlap = |found: String| {
            RodlabError::request(
                "gauges",
                format!(
                    "one gauge, {} from the free end, {found}",
                    gauge.from_free_end
                ),
                format!(
                    "a pulse that has passed the gauge before its reflection returns from the free end after about {:.3} ms: add a second gauge to separate overlapping waves, \
                     or use a shorter striker or a gauge farther from the end",
                    1e3 * way
                ),
            )
        };
        let short = |needed: String| {
            RodlabError::request(
                "records",
                format!("a record of {:.3} ms", ms(history.len())),
                format!("a record up to the end of the reflected pulse, {needed} ms"),
            )
        };
        let Some(front) = front else {
            let due = first as f64 / self.rate_hz + (1.0 + GUESS) * way;
            if history.len() as f64 / self.rate_hz < due {
                return Err(short(format!("about {:.3}", 1e3 * due)));
            }
            return Err(overlap(
                "at which no pulse of the opposite sign returns".to_owned(),
            ));
        };
        let apart = front - first;
        let quiet = front.saturating_sub(end);
        if (quiet as f64) < QUIET * apart as f64
            || (apart as f64 / self.rate_hz / way - 1.0).abs() > GUESS
        {
            return Err(overlap(format!(
                "at which the pulse lasts {:.3} ms and changes sign {:.3} ms after its front",
                ms(end - first),
                ms(apart)
            )));
        }
        // the next wave after the reflected pulse comes from the struck end
        let behind = sheet.bar.length.si() - gauge.distance();
        let until_next = 0.9 * apart as f64 * behind / gauge.distance();
        let margin = quiet / 4;
        let length =
            samples(until_next / self.rate_hz, self.rate_hz).map_or(apart, |n| n.min(apart));
        let (from, back) = (first.saturating_sub(margin), front.saturating_sub(margin));
        if end + margin >= from + length {
            return Err(overlap(format!(
                "at which the wave from the struck end arrives {:.3} ms after the reflected front, before the reflected pulse of {:.3} ms has passed",
                1e3 * until_next / self.rate_hz,
                ms(end - first)
            )));
        }
        if back + length >= history.len() {
            return Err(short(format!("{:.3}", ms(back + length))));
        }
        Ok([from..from + length, back..back + length])
    }

    /// Returns the end of the pulse that begins at sample `first`, and the front of the pulse that
    /// returns with the other sign.
    fn reflection(&self, history: &[f64], first: usize) -> Reflection {
        let sign = history.get(first).map_or(1.0, |x| x.signum());
        let behind = history.get(first..).unwrap_or_default();
        let is_back = |x: &f64| sign * x < -OF_REFLECTED / OF_PULSE * self.threshold;
        let Some(back) = behind.iter().position(is_back) else {
            return Reflection {
                end: history.len(),
                front: None,
            };
        };
        let before = behind.get(..back).unwrap_or_default();
        let is_quiet = |x: &f64| x.abs() <= self.threshold;
        let front = before
            .iter()
            .rposition(is_quiet)
            .map_or(0, |quiet| quiet + 1);
        let pulse = before.get(..front).unwrap_or_default();
        let end = pulse
            .iter()
            .rposition(|x| !is_quiet(x))
            .map_or(0, |last| last + 1);
        Reflection {
            end: first + end,
            front: Some(first + front),
        }
    }
}

/// Returns the number of samples in a time \[s\].
fn samples(time: f64, rate_hz: f64) -> Option<usize> {
    labio::hits::Extent::Seconds(time).samples(rate_hz).ok()
}

/// The incident pulse and its reflection.
struct Reflection {
    /// First sample after the incident pulse.
    end: usize,
    /// First sample of the reflected pulse.
    front: Option<usize>,
}

/// Returns the history minus its level in the silence, the absolute value above which a sample
/// belongs to the pulse, and the index of the first such sample.
fn at_rest(
    history: &[f64],
    rate_hz: f64,
    sheet: &BarSheet,
    at: usize,
) -> Result<(Vec<f64>, f64, usize), RodlabError> {
    let silence = samples(sheet.silent.si(), rate_hz).unwrap_or(usize::MAX);
    // only the first half of the silence is used, because the pulse begins in it if it is stated
    // too long
    let rest = history.get(..silence / 2).unwrap_or_default();
    if rest.len() < 8 || silence >= history.len() {
        return Err(RodlabError::request(
            "silent",
            format!("`{}`, {silence} samples of {}", sheet.silent, history.len()),
            "16 samples or more before the pulse, and a pulse after them: record with a longer pre-trigger",
        ));
    }
    let level = rest.iter().sum::<f64>() / rest.len() as f64;
    let noise = rest.iter().map(|x| (x - level).powi(2)).sum::<f64>() / rest.len() as f64;
    let history: Vec<f64> = history.iter().map(|x| x - level).collect();
    let peak = history.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let noise = noise.sqrt();
    let threshold = (OF_PULSE * peak).max(NO_NOISE * noise);
    let first = history.iter().position(|x| x.abs() > threshold);
    match first {
        Some(first) if first >= silence && noise <= OF_PULSE * peak => {
            Ok((history, threshold, first))
        }
        Some(first) if noise <= OF_PULSE * peak => Err(RodlabError::request(
            "silent",
            format!(
                "`{}`, but the pulse begins at gauges[{at}] after {:.4} ms",
                sheet.silent,
                1e3 * first as f64 / rate_hz
            ),
            "a silence that ends before the pulse, because noise and level at rest are determined in it; if there is no silence, record with a longer pre-trigger",
        )),
        _ => Err(RodlabError::request(
            "silent",
            format!(
                "`{}`, in which gauges[{at}] varies by {:.2} times its largest sample",
                sheet.silent,
                noise / peak
            ),
            "a silence before the pulse, and a pulse of at least 50 times the noise in this silence: record with a longer pre-trigger, or with more gain",
        )),
    }
}
