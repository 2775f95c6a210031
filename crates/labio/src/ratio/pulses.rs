//! Pulses cut out of hits, and the ratio of two pulses.

use std::f64::consts::TAU;
use std::ops::Range;

use ndarray::Array2;

use super::ResponseRatio;
use super::one_shot::{self, ChannelAtRest};
use crate::error::{check_count, check_enough_samples, check_finite, check_positive, non_physical};
use crate::{
    AveragedSpectra, Channel, LabioError, LevelAtRest, Record, RestNoise, Window, known_part,
};

/// Names of the two pulses in the records made from them.
const EARLIER: &str = "earlier pulse";
const LATER: &str = "later pulse";

/// Fewest samples that a pulse may have.
const FEWEST_SAMPLES: usize = 3;

/// A pulse in the samples `from..to` of a channel, in every hit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PulseWindow {
    /// Name of the channel.
    pub channel: String,
    /// The samples of the pulse, counted from the start of a hit.
    pub samples: Range<usize>,
}

impl PulseWindow {
    /// Accepts a window of three samples or more that ends within `hit`.
    pub(super) fn check(&self, hit: &Record) -> Result<(), LabioError> {
        check_enough_samples("the window of a pulse", self.samples.len(), FEWEST_SAMPLES)?;
        let at_least = self.samples.end.saturating_add(1);
        check_enough_samples("the hit that contains the pulse", hit.n_samples(), at_least)
    }
}

/// Returns the root-mean-square error of the spectrum of a pulse that was cut out of a record by a
/// rectangular window. It follows from the `noise` of the spectrum \[q s\] and the values of the
/// noise-free record at the two `edges` of the window \[q\],
///
/// ```text
/// σ² = noise² + Σ |q(edge)|²/ω²
/// ```
///
/// at each of `frequency_hz` \[Hz\]. Valid if the window is longer than a period. The second term
/// is not a random error, but it states the size of an error with unknown phase. This error is the
/// same in all hits and does not average out: it applies to the mean spectrum of the hits, not to
/// each spectrum.
///
/// # Errors
///
/// [`LabioError::NonPhysical`] for a noise that is negative or not finite, a frequency that is not
/// above 0, or an edge that is not finite.
pub fn noise_of_cut_pulse(
    noise: f64,
    edges: [f64; 2],
    frequency_hz: &[f64],
) -> Result<Vec<f64>, LabioError> {
    let check = |noise: f64| match noise.is_finite() && noise >= 0.0 {
        true => Ok(noise),
        false => non_physical("noise of a spectrum", noise, "a finite value, 0 or above"),
    };
    check(noise)?;
    for edge in edges {
        check_finite("value of the record at the edge of a window", edge)?;
    }
    let cut = edges[0].hypot(edges[1]);
    let at = |f: &f64| {
        check_positive("frequency [Hz]", *f)?;
        check(noise.hypot(cut / (TAU * f)))
    };
    frequency_hz.iter().map(at).collect()
}

impl ResponseRatio {
    /// Returns the ratio of a `later` pulse to an `earlier` one. The level of a channel at rest,
    /// which is its mean over the first `n_silent` samples of a hit, is subtracted before the
    /// pulses are cut out. The error caused by cutting off the rest of the pulses is not random,
    /// but its size is added to the variance, which is found from the coherence of several hits or
    /// from the first `n_silent` samples of a single hit.
    ///
    /// # Validity
    ///
    /// Without `n_silent` the channels must be at 0 before the impact: an offset would count as the
    /// cut end of a pulse.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for a window that has fewer than three samples or extends
    /// beyond a hit; the errors of [`Self::of_hits`] and [`Self::of_shot`].
    pub fn of_pulses(
        hits: &[&Record],
        n_silent: Option<usize>,
        later: &PulseWindow,
        earlier: &PulseWindow,
    ) -> Result<Self, LabioError> {
        let count = hits.len() as f64;
        let mut pulses = Vec::with_capacity(hits.len());
        let mut edges = [[0.0; 2]; 2];
        let mut level_errors = [0.0; 2];
        let mut delay = 0.0;
        let mut repeated: f64 = 1.0;
        let shortest = later.samples.len().min(earlier.samples.len());
        for hit in hits {
            let (record, [of_earlier, of_later]) = pulses_of(hit, n_silent, [earlier, later])?;
            delay += (of_later.centre - of_earlier.centre) / count;
            // the noise lasts for the shorter window, and the record around the pulse is 0
            repeated = repeated.max(hit.n_samples() as f64 / shortest as f64);
            for (sums, pulse) in edges.iter_mut().zip([&of_earlier, &of_later]) {
                for (sum, edge) in sums.iter_mut().zip(pulse.edges) {
                    *sum += edge / count;
                }
            }
            level_errors = [of_earlier.level_error, of_later.level_error];
            pulses.push(record);
        }
        let spectra = AveragedSpectra::of(&pulses, Window::Rectangular)?;
        let mut ratio = match (hits, n_silent) {
            ([hit], Some(n_silent)) => {
                let noise = |of: &PulseWindow| RestNoise::before(&[hit], &of.channel, n_silent);
                let (of_later, of_earlier) = (noise(later)?, noise(earlier)?);
                let at_rest = |channel, noise, window: &PulseWindow| ChannelAtRest {
                    channel,
                    noise,
                    duration: window.samples.len() as f64 / hit.sampling_rate_hz(),
                };
                let ratio = one_shot::ratio(
                    &spectra,
                    at_rest(LATER, &of_later, later),
                    at_rest(EARLIER, &of_earlier, earlier),
                )?;
                // the coherence of several hits includes the error of the level; a single hit has
                // no coherence
                for (edges, error) in edges.iter_mut().zip(level_errors) {
                    *edges = edges.map(|edge: f64| edge.hypot(error));
                }
                Self {
                    lines_per_independent_line: repeated,
                    ..ratio
                }
            }
            _ => Self::averaged(&spectra, LATER, EARLIER, repeated)?,
        };
        ratio.delay = (delay > 0.0).then_some(delay);
        for (name, edges) in [EARLIER, LATER].into_iter().zip(edges) {
            ratio.add_cut(&spectra.auto(name)?, edges)?;
        }
        ratio.with_sensors_of(hits, [&later.channel, &earlier.channel])
    }

    /// Adds the part of the variance that is caused by the edges of one pulse of this `energy`, and
    /// the degrees of freedom of the sum ([`known_part::gains`]).
    fn add_cut(&mut self, energy: &[f64], edges: [f64; 2]) -> Result<(), LabioError> {
        check_count("energies of a pulse", energy.len(), self.values.len())?;
        // at 0 Hz the error of the edges is not defined, and none is added to this line
        let lines = self.frequency_hz.get(1..).unwrap_or_default();
        let noises = noise_of_cut_pulse(0.0, edges, lines)?;
        let lines = self.values.iter().zip(energy).skip(1).zip(&noises);
        // the energy of a one-sided line is twice |q|²
        let cut =
            lines.map(|((value, energy), noise)| value.norm_sqr() * 2.0 * noise * noise / energy);
        let cut: Vec<f64> = [0.0].into_iter().chain(cut).collect();
        let gains = known_part::gains(&self.variance, &cut, self.lines_per_independent_line);
        for (freedom, gain) in self.freedom.iter_mut().flatten().zip(gains) {
            if gain.is_finite() {
                freedom.line *= gain;
                freedom.own *= gain;
            }
        }
        for (variance, cut) in self.variance.iter_mut().zip(cut) {
            *variance += cut;
        }
        Ok(())
    }
}

/// A pulse of a hit.
struct Pulse {
    /// Values at the edges of the window, relative to the level at rest.
    edges: [f64; 2],
    /// Standard error of the level at rest.
    level_error: f64,
    /// Time of the centre of its energy \[s\].
    centre: f64,
}

/// Returns both pulses of a hit in an otherwise silent record, the earlier pulse first.
#[allow(
    clippy::indexing_slicing,
    reason = "the window is of three samples or more and ends within the hit; the rows are those of the two pulses"
)]
fn pulses_of(
    hit: &Record,
    n_silent: Option<usize>,
    windows: [&PulseWindow; 2],
) -> Result<(Record, [Pulse; 2]), LabioError> {
    let mut samples = Array2::zeros((2, hit.n_samples()));
    let mut channels = Vec::with_capacity(2);
    let mut pulse = |row: usize, name: &str| {
        let window = windows[row];
        let history = hit.channel(&window.channel)?;
        window.check(hit)?;
        let range = window.samples.clone();
        let rest = LevelAtRest::of(history.iter().copied().take(n_silent.unwrap_or(0)));
        let (level, level_error) = rest.map_or((0.0, 0.0), |rest| (rest.level, rest.level_error));
        let edges = [range.start, range.end - 1].map(|index| history[index] - level);
        let (mut energy, mut moment) = (0.0, 0.0);
        for index in range {
            let value = history[index] - level;
            samples[[row, index]] = value;
            energy += value.powi(2);
            moment += index as f64 * value.powi(2);
        }
        let (_, channel) = crate::channel::find(hit.channels(), &window.channel)?;
        channels.push(Channel::new(name, channel.quantity())?);
        Ok(Pulse {
            edges,
            level_error,
            centre: moment / energy / hit.sampling_rate_hz(),
        })
    };
    let pulses = [pulse(0, EARLIER)?, pulse(1, LATER)?];
    let (rate_hz, start) = (hit.sampling_rate_hz(), hit.start_time());
    let record = Record::new(samples, rate_hz, start, channels, hit.provenance().clone())?;
    Ok((record, pulses))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DegreesOfFreedom;
    use num_complex::Complex64;
    use testbed::noise::Noise;

    /// The variance of a line from two averages is distributed as χ²₂/2; a known variance is added
    /// to it. If the sum has ν degrees of freedom, the squared error of the line divided by the sum
    /// should exceed the limit of F(2, ν) at 5 %, ν/2 (0.05^(-2/ν) - 1), on 5 % of the lines. The
    /// squared error is exponentially distributed, so that it exceeds the limit with the
    /// probability exp(-limit · stated/true variance). The test checks that this probability is not
    /// much higher on the lines with the highest ν, whose variance may be too small by chance.
    #[test]
    fn degrees_of_freedom_of_few_hits_do_not_follow_the_scatter_of_their_variance() {
        const SCATTER: f64 = 4.0; // the variance that the cut adds is 1
        const LINES: usize = 16_000;
        for repeated in [1, 8] {
            let mut rng = Noise::seeded(7);
            let drawn = (0..LINES / repeated).flat_map(|_| {
                let chi_square = rng.normal().powi(2) + rng.normal().powi(2);
                vec![SCATTER * chi_square / 2.0; repeated]
            });
            let variance: Vec<f64> = drawn.collect();
            let frequency_hz: Vec<f64> = (0..LINES).map(|line| line as f64).collect();
            let energy: Vec<f64> = frequency_hz
                .iter()
                .map(|f| 2.0 / (TAU * f).powi(2))
                .collect();
            let values = vec![Complex64::ONE; LINES];
            let mut ratio = ResponseRatio {
                freedom: Some(vec![DegreesOfFreedom::of_averages(2.0).unwrap(); LINES]),
                lines_per_independent_line: repeated as f64,
                ..ResponseRatio::from_variance(frequency_hz, values, variance).unwrap()
            };
            ratio.add_cut(&energy, [1.0, 0.0]).unwrap();
            let stated = ratio.variance.iter().zip(ratio.freedom.as_ref().unwrap());
            let mut exceeding: Vec<(f64, f64)> = stated
                .skip(1)
                .map(|(variance, DegreesOfFreedom { line: nu, .. })| {
                    let limit = nu / 2.0 * (0.05_f64.powf(-2.0 / nu) - 1.0);
                    (*nu, (-limit * variance / (SCATTER + 1.0)).exp())
                })
                .collect();
            exceeding.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mean = |lines: &[(f64, f64)]| {
                lines.iter().map(|(_, part)| part).sum::<f64>() / lines.len() as f64
            };
            assert!(mean(&exceeding) < 0.05, "{}", mean(&exceeding));
            // 11 % is expected, because the mean over nine lines contains the line itself. The
            // variance of the line alone would give 47 %, and a mean over nine lines, each of which
            // is repeated eight times, 36 %
            let tenth = mean(&exceeding[exceeding.len() * 9 / 10..]);
            assert!(tenth < 0.2, "{tenth}");
        }
    }
}
