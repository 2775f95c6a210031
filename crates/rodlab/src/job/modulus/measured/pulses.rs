//! Windows that the sheet states around pulses.

use labio::hits::{Extent, samples_at_rest};
use labio::{LevelAtRest, PulseWindow, Record};

use crate::RodlabError;
use crate::digits::significant;
use crate::job::modulus::method::Pulse;
use crate::sheet::{Exact, Time};

/// Peak between the windows, relative to the smaller pulse, above which it is a pulse.
const OTHER_PULSE: f64 = 0.3;
/// Fraction of the smaller pulse at which the pulses on either side have ended.
const OF_TAIL: f64 = 0.15;
/// Number of standard deviations that noise does not reach between two windows.
const BEYOND_NOISE: f64 = 10.0;
/// Value at the edge of a window, relative to the peak in it, above which the window cuts a pulse.
/// At the lowest lines of a pulse, the error of its spectrum is about twice this.
const CUT: f64 = 0.01;
/// Number of standard deviations of the noise that such a value exceeds.
const CUT_BEYOND_NOISE: f64 = 5.0;

/// Returns the samples of a pulse; the end of the pulse must be within all hits.
pub(super) fn window(pulse: &Pulse<'_>, hits: &[&Record]) -> Result<PulseWindow, RodlabError> {
    let rate_hz = hits.first().map_or(f64::NAN, |hit| hit.sampling_rate_hz());
    let sample = |time: &Exact<Time>| Extent::Seconds(time.si()).samples(rate_hz).ok();
    let shortest = hits.iter().map(|hit| hit.n_samples()).min().unwrap_or(0);
    match (sample(pulse.from), sample(pulse.to)) {
        (Some(from), Some(to)) if from + 2 < to && to < shortest => Ok(PulseWindow {
            channel: pulse.channel.to_owned(),
            samples: from..to,
        }),
        _ => Err(RodlabError::request(
            pulse.field.as_str(),
            format!("\"{}\" to \"{}\"", pulse.from, pulse.to),
            format!(
                "an interval in the record of a hit, 0 to {:.4} ms",
                1e3 * shortest as f64 / rate_hz
            ),
        )),
    }
}

/// Returns the number of samples from which the level at rest of both channels is found: the
/// `silent` ones or, if they are not known, those before the first motion; `None` if there are too
/// few of these.
pub(super) fn samples_for_level(
    hits: &[&Record],
    windows: [&PulseWindow; 2],
    silent: Option<usize>,
) -> Result<Option<usize>, RodlabError> {
    let channels = windows.map(|window| window.channel.as_str());
    match silent {
        Some(silent) => Ok(Some(silent)),
        None => samples_at_rest(hits, &channels).map_err(refused),
    }
}

/// Returns the reason for doubt if there is another pulse between the `earlier` and the `later`
/// window, which means that the later one contains a later passage of the wave. In one channel, the
/// signal is tested between the two windows; in two channels, the later channel is tested from the
/// beginning of the earlier window on.
///
/// The tails of the two pulses do not count: samples before the signal first falls below 15 %
/// of the smaller pulse, and after it is last below. Another pulse exceeds 30 % of the smaller one
/// in the mean over the hits, and ten standard deviations of the noise.
pub(super) fn between(
    hits: &[&Record],
    windows: [&PulseWindow; 2],
    names: [&str; 2],
    n_rest: Option<usize>,
) -> Result<Option<String>, RodlabError> {
    let [earlier, later] = windows;
    let is_one_channel = earlier.channel == later.channel;
    let from = if is_one_channel {
        earlier.samples.end
    } else {
        earlier.samples.start
    };
    let (mut of_pulses, mut of_others, mut noise) = (0.0, 0.0, 0.0);
    for hit in hits {
        let signal = Signal::of(hit, &later.channel, n_rest)?;
        let mut smaller = signal.peak(later);
        if is_one_channel {
            smaller = smaller.min(signal.peak(earlier));
        }
        let between = signal.samples.get(from..later.samples.start);
        let between = between.unwrap_or_default();
        let is_over = |x: &f64| x.abs() < OF_TAIL * smaller;
        let begin = between.iter().position(is_over);
        let end = between.iter().rposition(is_over);
        let without_tails = begin
            .zip(end)
            .and_then(|(begin, end)| between.get(begin..end));
        of_others += largest(without_tails.unwrap_or_default());
        of_pulses += smaller;
        noise += signal.noise;
    }
    let is_pulse = of_others > OTHER_PULSE * of_pulses && of_others > BEYOND_NOISE * noise;
    let [first, second] = names.map(last_part);
    Ok(is_pulse.then(|| {
        format!(
            "between the windows `{first}` and `{second}` lies another pulse, {} % of the smaller one of the two: the window `{second}` may be that of a later passage",
            significant(100.0 * of_others / of_pulses, 2)
        )
    }))
}

/// Returns a clause for each edge of the windows at which a pulse is cut: in the mean over the
/// hits, the signal there exceeds 1 % of the peak in the window and five standard deviations of the
/// noise.
pub(super) fn cut(
    hits: &[&Record],
    windows: [&PulseWindow; 2],
    names: [&str; 2],
    n_rest: Option<usize>,
) -> Result<Vec<String>, RodlabError> {
    let mut found = Vec::new();
    for (window, name) in windows.into_iter().zip(names.map(last_part)) {
        let (mut edges, mut peak, mut noise) = ([0.0_f64; 2], 0.0, 0.0);
        for hit in hits {
            let signal = Signal::of(hit, &window.channel, n_rest)?;
            let at = [window.samples.start, window.samples.end.saturating_sub(1)];
            for (edge, at) in edges.iter_mut().zip(at) {
                *edge += signal.samples.get(at).copied().unwrap_or(0.0);
            }
            peak += signal.peak(window);
            noise += signal.noise;
        }
        for (edge, place) in edges.into_iter().zip(["beginning", "end"]) {
            let level = edge.abs();
            if level > CUT * peak && level > CUT_BEYOND_NOISE * noise {
                found.push(format!(
                    "at the {place} of the window `{name}` the signal is at {} % of the peak of the pulse",
                    significant(100.0 * level / peak, 2)
                ));
            }
        }
    }
    Ok(found)
}

/// Returns the last part of the name of a field.
fn last_part(field: &str) -> &str {
    field.rsplit('.').next().unwrap_or(field)
}

fn refused(error: labio::LabioError) -> RodlabError {
    RodlabError::step("cutting pulses out of the hits", error)
}

/// Largest absolute value.
fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// A channel of a hit relative to its level at rest.
struct Signal {
    samples: Vec<f64>,
    /// Standard deviation at rest; 0 if it is not known.
    noise: f64,
}

impl Signal {
    fn of(hit: &Record, channel: &str, n_rest: Option<usize>) -> Result<Self, RodlabError> {
        let mut samples = hit.channel(channel).map_err(refused)?.to_vec();
        let rest = n_rest.and_then(|n| samples.get(..n)).unwrap_or_default();
        let rest = LevelAtRest::of(rest.iter().copied());
        let (level, noise) = rest.map_or((0.0, 0.0), |rest| (rest.level, rest.noise));
        for x in &mut samples {
            *x -= level;
        }
        Ok(Self { samples, noise })
    }

    fn peak(&self, window: &PulseWindow) -> f64 {
        let pulse = self.samples.get(window.samples.clone());
        largest(pulse.unwrap_or_default())
    }
}
