//! Detection of windows that cut a pulse, and of pulses between two windows.

use super::PulseWindow;
use crate::{LabioError, LevelAtRest, Record};

/// Peak between the windows, relative to the smaller pulse, above which it counts as a pulse.
const OTHER_PULSE: f64 = 0.3;
/// Fraction of the smaller pulse below which the pulses on either side have ended.
const OF_TAIL: f64 = 0.15;
/// Number of standard deviations that noise does not reach between two windows.
const BEYOND_NOISE: f64 = 10.0;
/// Value at the edge of a window, relative to the peak in it, above which the window cuts a pulse.
/// On the lowest lines of a pulse, the relative error of its spectrum is about twice this value.
const CUT: f64 = 0.01;
/// Number of standard deviations of the noise that the value at the edge must exceed.
const CUT_BEYOND_NOISE: f64 = 5.0;

/// Returns the peak between the `earlier` and the `later` window divided by the peak of the smaller
/// pulse, if there is another pulse, which means that the later window contains a later passage of
/// the wave. In one channel, the signal is tested between the two windows. In two channels, the
/// later channel is tested from the beginning of the earlier window on, and the pulse in the later
/// window counts as the smaller one.
///
/// Both peaks are means over the `hits`, counted from the level in the first `n_rest` samples (from
/// 0 without them). The tails of the two pulses do not count: these are the samples before the
/// signal first falls below 15 % of the smaller pulse, and those after it was last below this
/// level. Another pulse exceeds 30 % of the smaller one and ten standard deviations of the noise.
///
/// # Errors
///
/// [`LabioError::TooFewSamples`] for a window that has fewer than three samples or extends beyond a
/// hit; [`LabioError::UnknownChannel`].
///
/// # Examples
///
/// ```
/// use labio::ratio::{PulseWindow, find_other_pulse};
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// // half sines of 1, 0.5 and 0.8 from the samples 100, 300 and 500 on
/// let samples = Array2::from_shape_fn((1, 700), |(_, n)| {
///     let sine = |from: usize| (std::f64::consts::PI * (n - from) as f64 / 40.0).sin();
///     match n {
///         100..140 => sine(100),
///         300..340 => 0.5 * sine(300),
///         500..540 => 0.8 * sine(500),
///         _ => 0.0,
///     }
/// });
/// let channels = vec![Channel::new("gauge", Quantity::Strain)?];
/// let hit = Record::new(samples, 1e5, 0.0, channels, Provenance::computed("example"))?;
/// let window = |samples| PulseWindow { channel: "gauge".to_owned(), samples };
/// let (first, second, third) = (window(90..150), window(290..350), window(490..550));
/// assert_eq!(find_other_pulse(&[&hit], None, &third, &first)?, Some(0.5 / 0.8));
/// assert_eq!(find_other_pulse(&[&hit], None, &second, &first)?, None);
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn find_other_pulse(
    hits: &[&Record],
    n_rest: Option<usize>,
    later: &PulseWindow,
    earlier: &PulseWindow,
) -> Result<Option<f64>, LabioError> {
    let is_one_channel = earlier.channel == later.channel;
    let from = if is_one_channel {
        earlier.samples.end
    } else {
        earlier.samples.start
    };
    let (mut of_pulses, mut of_others, mut noise) = (0.0, 0.0, 0.0);
    for hit in hits {
        earlier.check(hit)?;
        let signal = Signal::of(hit, later, n_rest)?;
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
    Ok(is_pulse.then_some(of_others / of_pulses))
}

/// Returns the signal at the first and the last sample of the `window` divided by the peak in it,
/// for each of the two at which a pulse is cut: its mean over the `hits` exceeds 1 % of the mean
/// peak, and five standard deviations of the noise. The signal is counted from the level in the
/// first `n_rest` samples (from 0 without them). [`noise_of_cut_pulse`](super::noise_of_cut_pulse)
/// gives the error of the spectrum.
///
/// # Errors
///
/// [`LabioError::TooFewSamples`] for a window that has fewer than three samples or extends beyond a
/// hit; [`LabioError::UnknownChannel`].
///
/// # Examples
///
/// ```
/// use labio::ratio::{PulseWindow, find_cut_edges};
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// // a triangle of 1 at sample 140, within the samples 100 to 180
/// let samples = Array2::from_shape_fn((1, 400), |(_, n)| {
///     (1.0 - (n as f64 - 140.0).abs() / 40.0).max(0.0)
/// });
/// let channels = vec![Channel::new("gauge", Quantity::Strain)?];
/// let hit = Record::new(samples, 1e5, 0.0, channels, Provenance::computed("example"))?;
/// let window = |samples| PulseWindow { channel: "gauge".to_owned(), samples };
/// assert_eq!(find_cut_edges(&[&hit], None, &window(90..190))?, [None, None]);
/// assert_eq!(find_cut_edges(&[&hit], None, &window(90..171))?, [None, Some(0.25)]);
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn find_cut_edges(
    hits: &[&Record],
    n_rest: Option<usize>,
    window: &PulseWindow,
) -> Result<[Option<f64>; 2], LabioError> {
    let (mut edges, mut peak, mut noise) = ([0.0_f64; 2], 0.0, 0.0);
    for hit in hits {
        let signal = Signal::of(hit, window, n_rest)?;
        let pulse = signal.samples.get(window.samples.clone());
        let ends = pulse.and_then(|pulse| Some([pulse.first()?, pulse.last()?]));
        for (edge, end) in edges.iter_mut().zip(ends.into_iter().flatten()) {
            *edge += end;
        }
        peak += signal.peak(window);
        noise += signal.noise;
    }
    Ok(edges.map(|edge| {
        let level = edge.abs();
        (level > CUT * peak && level > CUT_BEYOND_NOISE * noise).then_some(level / peak)
    }))
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
    /// Returns the channel of `window`, which is within the `hit`.
    fn of(hit: &Record, window: &PulseWindow, n_rest: Option<usize>) -> Result<Self, LabioError> {
        window.check(hit)?;
        let mut samples = hit.channel(&window.channel)?.to_vec();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;
    use ndarray::Array2;
    use testbed::noise::Noise;

    fn window(channel: &str, from: usize, to: usize) -> PulseWindow {
        PulseWindow {
            channel: channel.to_owned(),
            samples: from..to,
        }
    }

    /// Two gauges on an offset of 3, with noise: the first has pulses of 1 at 500 and 900, the
    /// second pulses of 1 at 700 and 1100 and of `other` at 900.
    fn hit(other: f64, noise: f64) -> Record {
        let mut rng = Noise::seeded(3);
        let pulse = |n: usize, at: usize| (1.0 - n.abs_diff(at) as f64 / 20.0).max(0.0);
        let samples = Array2::from_shape_fn((2, 1500), |(gauge, n)| {
            let pulses = match gauge {
                0 => pulse(n, 500) + pulse(n, 900),
                _ => pulse(n, 700) + other * pulse(n, 900) + pulse(n, 1100),
            };
            3.0 + pulses + noise * rng.normal()
        });
        let strain = Quantity::Strain;
        Record::of_test(samples, 1e5, &[("a", strain), ("b", strain)])
    }

    #[test]
    fn another_pulse_exceeds_a_part_of_the_smaller_one_and_the_noise() {
        let find = |hit: &Record, later: &PulseWindow, earlier: &PulseWindow| {
            find_other_pulse(&[hit], Some(400), later, earlier).unwrap()
        };
        let (a, b, last) = (
            window("a", 470, 530),
            window("b", 670, 730),
            window("b", 1070, 1130),
        );
        let found = find(&hit(0.5, 0.0), &last, &b).unwrap();
        // rounding errors of 3 + x
        assert!((found - 0.5).abs() < 1e-12, "{found}");
        // after a window of the first gauge, the whole pulse at 700 counts
        let found = find(&hit(0.5, 0.0), &last, &a).unwrap();
        assert!((found - 1.0).abs() < 1e-12, "{found}");
        assert_eq!(find(&hit(0.5, 0.0), &b, &a), None);
        assert_eq!(find(&hit(0.25, 0.0), &last, &b), None);
        // not found: ten standard deviations of the noise are 0.6, and the largest sample of the
        // other pulse is about 0.5
        assert!(find(&hit(0.4, 0.0), &last, &b).is_some());
        assert_eq!(find(&hit(0.4, 0.06), &last, &b), None);
    }

    #[test]
    fn a_window_cuts_a_pulse_where_the_signal_exceeds_the_noise() {
        let edges = |noise: f64, from: usize, to: usize| {
            find_cut_edges(&[&hit(0.0, noise)], Some(400), &window("a", from, to)).unwrap()
        };
        assert_eq!(edges(0.0, 470, 530), [None, None]);
        let [Some(first), None] = edges(0.0, 485, 530) else {
            panic!("{:?}", edges(0.0, 485, 530));
        };
        assert!((first - 0.25).abs() < 1e-12, "{first}");
        assert_eq!(edges(0.15, 485, 530), [None, None]);
    }

    #[test]
    fn a_window_beyond_the_hit_is_refused() {
        let hit = hit(0.0, 0.0);
        let (inside, beyond) = (window("a", 470, 530), window("a", 1470, 1500));
        assert!(find_cut_edges(&[&hit], None, &beyond).is_err());
        assert!(find_other_pulse(&[&hit], None, &beyond, &inside).is_err());
        assert!(find_other_pulse(&[&hit], None, &window("a", 600, 602), &inside).is_err());
    }
}
