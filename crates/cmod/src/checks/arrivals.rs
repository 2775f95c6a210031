//! First wave in the records of several channels: its arrival and its sign.

use super::{Check, CheckOutcome, check_level, fisher_tail, of_the_least, student_tail_below};
use crate::error::{CmodError, check_not_negative, check_positive, check_values};

/// Minimum number of samples from which a mean square is computed, before the hit or between the
/// hit and the wave.
const FEWEST_SAMPLES: usize = 8;

/// Record of a hit in one channel.
#[derive(Debug, Clone, Copy)]
pub struct Channel<'a> {
    /// Samples in any unit, at the same times in all channels.
    pub samples: &'a [f64],
    /// Distance of the section from the impacted end \[m\].
    pub distance: f64,
}

/// Records of a hit, with the time of the hit. The inputs come from these sources:
///
/// | quantity | source |
/// |---|---|
/// | noise | the samples before the hit, per channel |
/// | time of the hit | the trigger, a contact or the hammer's channel |
/// | speeds | any estimate, or prior knowledge of the material |
#[derive(Debug, Clone)]
pub struct Arrivals<'a> {
    channels: Vec<Channel<'a>>,
    interval: f64,
    blow: usize,
}

/// Mean, mean square and number of independent samples of the noise in a part of a record.
struct Noise {
    mean: f64,
    mean_square: f64,
    /// Number of samples per independent square, 1 + 2Σρ² over the lags of the autocorrelation ρ; 1
    /// for white noise.
    correlation: f64,
    /// Number of samples per independent sum, 1 + 2Σ|ρ|.
    persistence: f64,
    independent: f64,
}

/// Comparison of the first wave of a channel with that of the reference channel.
struct Wave {
    /// Correlation divided by its scatter.
    correlation: f64,
    /// Probabilities that noise alone gives a lower (`opposite`) and a higher (`same`) correlation.
    opposite: f64,
    same: f64,
    channel: Option<usize>,
}

impl<'a> Arrivals<'a> {
    /// Creates the checks for records of two or more channels, sampled every `interval` \[s\], of a
    /// hit that begins at sample `blow`.
    ///
    /// # Errors
    /// [`CmodError::GaugeCount`] for fewer than two channels, [`CmodError::NonPhysical`] for the
    /// interval or a distance, [`CmodError::ReadingCount`] for histories of different length,
    /// [`CmodError::TooFewSamples`] if fewer than 8 samples precede the hit or none follows it,
    /// [`CmodError::NonFiniteSample`].
    pub fn new(channels: Vec<Channel<'a>>, interval: f64, blow: usize) -> Result<Self, CmodError> {
        check_positive("sampling interval [s]", interval)?;
        let Some(first) = channels.first().filter(|_| channels.len() > 1) else {
            return Err(CmodError::GaugeCount {
                found: channels.len(),
                expected: "2 or more",
            });
        };
        let expected = first.samples.len();
        if blow < FEWEST_SAMPLES || blow >= expected {
            return Err(CmodError::TooFewSamples {
                what: "the record before the hit, or after it,",
                found: blow.min(expected.saturating_sub(blow)),
                expected: FEWEST_SAMPLES,
            });
        }
        for (channel, Channel { samples, distance }) in channels.iter().enumerate() {
            check_not_negative("distance from the impacted end [m]", *distance)?;
            let each = "sample of the first channel";
            check_values("history of a channel", samples.len(), expected, each)?;
            if let Some((index, &value)) = samples.iter().enumerate().find(|(_, s)| !s.is_finite())
            {
                return Err(CmodError::NonFiniteSample {
                    channel,
                    index,
                    value,
                });
            }
        }
        Ok(Self {
            channels,
            interval,
            blow,
        })
    }

    /// Checks that every channel is silent until a wave of the speed `fastest` [m/s] can have
    /// arrived from the impacted end. `level` is the probability of a false alarm.
    ///
    /// The statistic of a channel is the mean square between the hit and this arrival, divided by
    /// the mean square before the hit. For noise alone it is about 1 and has the F-distribution,
    /// with degrees of freedom that are reduced for the correlation of the noise before the hit.
    /// The p-value of the check is the smallest of all channels, corrected for the number of
    /// channels. Channels with fewer than 8 samples between hit and arrival are not checked.
    ///
    /// `fastest` is the speed of the front, √(E/ρ) of the unrelaxed modulus: it exceeds any phase
    /// velocity of the band by the dispersion that the loss factor causes between the band and the
    /// sampling rate. A record filtered with a linear-phase filter fails, because such a filter
    /// rings before the wave.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for the speed and the level, [`CmodError::TooFewSamples`] if no
    /// channel can be checked, [`CmodError::NoNoise`] for a channel without any noise before the
    /// hit.
    pub fn causality(&self, fastest: f64, level: f64) -> Result<CheckOutcome, CmodError> {
        let level = check_level(level)?;
        check_positive("fastest wave speed [m/s]", fastest)?;
        let mut worst = (f64::INFINITY, 0.0, None);
        let (mut count, mut longest) = (0, 0);
        for (index, channel) in self.channels.iter().enumerate() {
            let silent = self.samples_of(channel.distance / fastest);
            let ahead = self.after_blow(channel, silent);
            longest = longest.max(ahead.len());
            if ahead.len() < FEWEST_SAMPLES {
                continue;
            }
            count += 1;
            let noise = self.noise(index, channel)?;
            let n = ahead.len() as f64;
            let deviations = ahead.iter().map(|value| (value - noise.mean).powi(2));
            let before = self.blow as f64;
            // The mean of the noise is itself an estimate and scatters.
            let expected = noise.mean_square * (1.0 + noise.persistence / before);
            let statistic = deviations.sum::<f64>() / n / expected;
            let p_value = fisher_tail(
                statistic,
                (n / noise.correlation).max(1.0),
                (noise.independent - 1.0).max(1.0),
            );
            if p_value < worst.0 {
                worst = (p_value, statistic, Some(index));
            }
        }
        if count == 0 {
            return Err(CmodError::TooFewSamples {
                what: "the record between the hit and the fastest wave",
                found: longest,
                expected: FEWEST_SAMPLES,
            });
        }
        let p_value = of_the_least(worst.0, count);
        Ok(CheckOutcome::judged(Check::Causality, (worst.1, 1.0), p_value, level).at(worst.2))
    }

    /// Checks that the first wave has the same sign in all channels, for sensors of one quantity.
    /// `level` is the largest probability of a false alarm.
    ///
    /// Each channel is correlated with the channel nearest to the impact, over the `duration` \[s\]
    /// after the arrival of a wave of the given `speed` [m/s]. The statistic is the lowest
    /// correlation of all channels, divided by its scatter due to noise: many standard deviations
    /// above 0 if the sign is right, below 0 if it is wrong. The statistic follows Student's
    /// distribution, because the noise is estimated from the samples before the hit. The
    /// `duration` must end before a reflection arrives. If the wave is below the noise, the check
    /// is undecided.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for the speed, the duration and the level,
    /// [`CmodError::TooFewSamples`] if the record ends before the duration, [`CmodError::NoNoise`]
    /// for a channel without any noise before the hit.
    pub fn polarity(
        &self,
        speed: f64,
        duration: f64,
        level: f64,
    ) -> Result<CheckOutcome, CmodError> {
        let level = check_level(level)?;
        check_positive("wave speed [m/s]", speed)?;
        check_positive("duration of the first wave [s]", duration)?;
        let length = self.samples_of(duration);
        if length == 0 {
            return Err(CmodError::TooFewSamples {
                what: "the first wave",
                found: 0,
                expected: 1,
            });
        }
        let nearest = (0..self.channels.len()).min_by(|a, b| {
            let distance = |index: &usize| self.channels.get(*index).map_or(0.0, |c| c.distance);
            distance(a).total_cmp(&distance(b))
        });
        let first_wave = |channel: &Channel<'a>| {
            let way = self.samples_of(channel.distance / speed);
            let arrival = self.blow.saturating_add(way);
            channel
                .samples
                .get(arrival..arrival.saturating_add(length))
                .ok_or(CmodError::TooFewSamples {
                    what: "the record from the arrival of the first wave",
                    found: channel.samples.len().saturating_sub(arrival),
                    expected: length,
                })
        };
        let mut least = Wave {
            correlation: f64::INFINITY,
            opposite: f64::INFINITY,
            same: 0.0,
            channel: None,
        };
        let reference = nearest.and_then(|index| self.channels.get(index).map(|c| (index, c)));
        let Some((reference_index, reference)) = reference else {
            return Err(CmodError::NoLines);
        };
        let mean = self.noise(reference_index, reference)?.mean;
        let wave: Vec<f64> = first_wave(reference)?
            .iter()
            .map(|value| value - mean)
            .collect();
        for (index, channel) in self.channels.iter().enumerate() {
            if index == reference_index {
                continue;
            }
            let noise = self.noise(index, channel)?;
            let pairs = wave.iter().zip(first_wave(channel)?);
            let product: f64 = pairs.map(|(a, b)| a * (b - noise.mean)).sum();
            let power: f64 = wave.iter().map(|a| a * a).sum();
            let scatter = (noise.mean_square * noise.persistence * power).sqrt();
            let z = product / scatter;
            if !z.is_finite() {
                return Err(CmodError::NoNoise {
                    what: "the first wave or the noise of channel",
                    index,
                });
            }
            let freedom = Some((noise.independent - 1.0).max(1.0));
            let opposite = student_tail_below(z, freedom);
            if (opposite, z) < (least.opposite, least.correlation) {
                least = Wave {
                    correlation: z,
                    opposite,
                    same: student_tail_below(-z, freedom),
                    channel: Some(index),
                };
            }
        }
        let p_value = of_the_least(least.opposite, self.channels.len() - 1);
        let statistic = (least.correlation, 0.0);
        let outcome = CheckOutcome::judged(Check::Polarity, statistic, p_value, level);
        let is_lost = least.same > level && !outcome.has_failed();
        Ok(outcome.undecided_if(is_lost).at(least.channel))
    }

    /// Returns the number of whole samples in a time.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "times are finite and not negative, and the cast saturates"
    )]
    fn samples_of(&self, time: f64) -> usize {
        (time / self.interval).floor() as usize
    }

    /// Returns the first `count` samples after the hit, or all available samples if there are
    /// fewer.
    fn after_blow(&self, channel: &Channel<'a>, count: usize) -> &'a [f64] {
        let after = channel.samples.get(self.blow..).unwrap_or_default();
        after.get(..count).unwrap_or(after)
    }

    fn noise(&self, index: usize, channel: &Channel<'_>) -> Result<Noise, CmodError> {
        let quiet = channel.samples.get(..self.blow).unwrap_or_default();
        let n = quiet.len() as f64;
        let mean = quiet.iter().sum::<f64>() / n;
        let power: f64 = quiet.iter().map(|value| (value - mean).powi(2)).sum();
        if power <= 0.0 {
            return Err(CmodError::NoNoise {
                what: "the noise before the hit in channel",
                index,
            });
        }
        // The sums end at the first lag whose ρ is compatible with white noise.
        let (mut correlation, mut persistence) = (1.0, 1.0);
        for lag in 1..quiet.len() / 4 {
            let pairs = quiet.iter().zip(quiet.iter().skip(lag));
            let product: f64 = pairs.map(|(a, b)| (a - mean) * (b - mean)).sum();
            let rho = product / power;
            if rho.abs() < 3.0 / n.sqrt() {
                break;
            }
            correlation += 2.0 * rho * rho;
            persistence += 2.0 * rho.abs();
        }
        Ok(Noise {
            mean,
            mean_square: power / (n - persistence).max(1.0),
            correlation,
            persistence,
            independent: n / correlation,
        })
    }
}
