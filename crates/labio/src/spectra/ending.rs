//! Motion after the end of a record, which is missing from its transform.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

use super::Detrend;
use crate::channel;
use crate::{AddedDamping, LabioError, Quantity, Record};

/// Number of equal parts of a hit; the motion after its end is found from the last one.
const TAIL: usize = 4;
/// Fewest samples in the last part.
const LEAST_TAIL: usize = 8;

/// Motion of a body after the end of its record.
///
/// The motion that follows is missing from the transform of a record that stops at sample $`N`$.
/// For a free body that motion is known: its velocity is the constant $`u`$, its displacement
/// $`u + v(n - N)`$. With $`w = e^{-i\omega\Delta t}`$ and the decay $`q = e^{-\sigma\Delta t}`$ of
/// an exponential window, the part after the end is
///
/// ```math
/// \sum_{n\ge N}\bigl(u + v(n-N)\bigr)(qw)^n = (qw)^N\left(\frac{u}{1-qw} + \frac{v\,qw}{(1-qw)^2}\right),
/// ```
///
/// This is exact on every line except that at 0 Hz of a step without window, where the transform
/// does not exist. It equals the transform of the differences of the samples divided by $`1 - w`$.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    Rest,
    /// Constant level: a velocity that persists.
    Constant,
    /// Straight line: a displacement that continues.
    Ramp,
}

/// Straight line at the end of a record.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct End {
    /// Value at the sample that would follow the last one.
    pub(crate) level: f64,
    /// Change from sample to sample.
    pub(crate) slope: f64,
}

impl End {
    /// Returns the value `before` samples before the end.
    pub(crate) fn at(self, before: usize) -> f64 {
        self.level - self.slope * before as f64
    }
}

/// Returns the number of samples, out of `n_samples`, from which the motion after the record is
/// found.
pub(crate) fn tail_length(n_samples: usize) -> usize {
    (n_samples / TAIL).max(LEAST_TAIL).min(n_samples)
}

impl Ending {
    /// Returns the ending of a free or held body for the measured quantity.
    pub(crate) fn of(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Velocity => Self::Constant,
            Quantity::Displacement => Self::Ramp,
            _ => Self::Rest,
        }
    }

    /// Returns the least-squares line through `tail`, weighted by a Hann window; oscillations of a
    /// few periods in the tail are orthogonal to it.
    pub(crate) fn fit(self, tail: &[f64]) -> End {
        if self == Self::Rest || tail.is_empty() {
            return End::default();
        }
        let n = tail.len() as f64;
        let middle = (n - 1.0) / 2.0;
        let (mut weights, mut squares, mut level, mut moment) = (0.0, 0.0, 0.0, 0.0);
        for (index, x) in tail.iter().enumerate() {
            let weight = (PI * (index as f64 + 0.5) / n).sin().powi(2);
            let place = index as f64 - middle;
            weights += weight;
            squares += weight * place * place;
            level += weight * x;
            moment += weight * place * x;
        }
        let mean = level / weights;
        if self == Self::Constant || squares <= 0.0 {
            return End {
                level: mean,
                slope: 0.0,
            };
        }
        let slope = moment / squares;
        End {
            level: mean + slope * (n - middle),
            slope,
        }
    }
}

/// Returns samples whose transform, except for the line at 0 Hz, is that of the hit with its motion
/// after the end ([`SpectrumAverager::with_completion`](crate::SpectrumAverager::with_completion)):
/// for a velocity or a displacement, the mean in the first `n_rest` samples and the ramp from 0 to
/// the value at the end are subtracted, and a parabola for the slope at the end is added,
///
/// ```math
/// x_n - u\frac nN + v\,\frac{n(N-n)}{2N} .
/// ```
///
/// Under an exponential `window` that leaves $`q`$ at the end of the record, the following samples,
/// not yet multiplied by the weights of the window, are exact on all lines:
///
/// ```math
/// x_n + \frac{q}{1-q}\Bigl(u + v\,n + \frac{v\,qN}{1-q}\Bigr) .
/// ```
///
/// Other quantities are unchanged.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
pub fn completed_motion(
    hit: &Record,
    channel: &str,
    n_rest: Option<usize>,
    window: Option<AddedDamping>,
) -> Result<Vec<f64>, LabioError> {
    let (_, known) = channel::find(hit.channels(), channel)?;
    let ending = Ending::of(known.quantity());
    let mut samples = hit.channel(channel)?.to_vec();
    if ending == Ending::Rest {
        return Ok(samples);
    }
    let n_samples = samples.len();
    Detrend::Rest {
        n_samples: n_rest.unwrap_or(0),
    }
    .apply(&mut samples);
    let (_, tail) = samples.split_at(n_samples - tail_length(n_samples));
    let end = ending.fit(tail);
    let n = n_samples as f64;
    if let Some(window) = window {
        let left = (-window.decay_rate() * n / hit.sampling_rate_hz()).exp();
        let again = left / (1.0 - left);
        for (index, x) in samples.iter_mut().enumerate() {
            *x += again * (end.level + end.slope * (index as f64 + n * again));
        }
        return Ok(samples);
    }
    for (index, x) in samples.iter_mut().enumerate() {
        let at = index as f64;
        *x -= end.level * at / n - end.slope * at * (n - at) / (2.0 * n);
    }
    Ok(samples)
}

/// Sums of a step and of a ramp after the end of a record, for each line.
#[derive(Debug, Clone)]
pub(crate) struct Completion {
    steps: Vec<Complex64>,
    ramps: Vec<Complex64>,
    /// Weights of the tail in the leakage: half a cosine that rises from 0 to 1 at the end.
    pub(crate) cut: Vec<f64>,
    is_damped: bool,
}

impl Completion {
    /// Creates the sums for `n_samples` samples under an exponential window that falls by the
    /// factor `decay` per sample; 1 means no window.
    pub(crate) fn new(n_samples: usize, decay: f64) -> Self {
        let n = n_samples as f64;
        let end = decay.powf(n);
        let is_damped = decay < 1.0;
        let steps: Vec<Complex64> = (0..=n_samples / 2)
            .map(|line| {
                if line == 0 && !is_damped {
                    return Complex64::ZERO;
                }
                // on the lines of the transform, w to the power N is 1
                end / (1.0 - Complex64::from_polar(decay, -TAU * line as f64 / n))
            })
            .collect();
        let ramps = steps
            .iter()
            .enumerate()
            .map(|(line, step)| {
                let turn = Complex64::from_polar(decay, -TAU * line as f64 / n);
                step * step * turn / end.max(f64::MIN_POSITIVE)
            })
            .collect();
        let n_tail = tail_length(n_samples);
        let cut = (0..n_tail)
            .map(|index| 0.5 - 0.5 * (PI * (index as f64 + 0.5) / n_tail as f64).cos())
            .collect();
        Self {
            steps,
            ramps,
            cut,
            is_damped,
        }
    }

    /// Adds the motion after the end to `lines`. The line at 0 Hz becomes zero for a motion that
    /// never comes to rest.
    pub(crate) fn complete(&self, ending: Ending, end: End, lines: &mut [Complex64]) {
        if ending == Ending::Rest {
            return;
        }
        for ((line, step), ramp) in lines.iter_mut().zip(&self.steps).zip(&self.ramps) {
            *line += step * end.level + ramp * end.slope;
        }
        if let (false, Some(first)) = (self.is_damped, lines.first_mut()) {
            *first = Complex64::ZERO;
        }
    }

    /// Returns true if the line at 0 Hz exists for a motion with this ending.
    pub(crate) fn has_first_line(&self, ending: Ending) -> bool {
        self.is_damped || ending == Ending::Rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dft::forward;

    /// A step and a ramp after a record, summed far beyond its end; a slow decay makes the sum
    /// converge.
    #[test]
    fn s1_what_follows_is_added_as_if_the_record_were_longer() {
        let (n, decay): (usize, f64) = (32, 0.98);
        let motion = |k: usize| {
            if k < 10 {
                0.0
            } else {
                0.3 * (k - 10) as f64 + 2.0
            }
        };
        let whole = |samples: usize| -> Vec<f64> {
            let weighed = (0..samples).map(|k| motion(k) * decay.powf(k as f64));
            weighed.collect()
        };
        let mut lines = forward(&whole(n));
        let samples: Vec<f64> = (n - 8..n).map(motion).collect();
        let end = Ending::Ramp.fit(&samples);
        // rounding errors of the sums of a straight line
        assert!((end.level - motion(n)).abs() < 1e-12 && (end.slope - 0.3).abs() < 1e-13);
        Completion::new(n, decay).complete(Ending::Ramp, end, &mut lines);
        // a record 64 times as long, at whose end the weight is 0.98^2048 = 1e-18
        let long = forward(&whole(64 * n));
        for (line, value) in lines.iter().enumerate() {
            let exact = long[64 * line];
            assert!((value - exact).norm() < 1e-11 * exact.norm(), "{line}");
        }
    }

    #[test]
    fn s1_completed_samples_have_the_completed_lines() {
        let samples = ndarray::Array2::from_shape_fn((1, 48), |(_, n)| {
            let t = n as f64 - 12.0;
            if t < 0.0 {
                2.0
            } else {
                2.0 + 0.3 * t + (0.7 * t).sin()
            }
        });
        let hit = Record::of_test(samples, 1.0, &[("end", Quantity::Displacement)]);
        let plain: Vec<f64> = hit
            .channel("end")
            .unwrap()
            .iter()
            .map(|x| x - 2.0)
            .collect();
        let mut lines = forward(&plain);
        let end = Ending::Ramp.fit(&plain[36..]);
        Completion::new(48, 1.0).complete(Ending::Ramp, end, &mut lines);
        let found = forward(&completed_motion(&hit, "end", Some(12), None).unwrap());
        for (a, b) in found.iter().zip(&lines).skip(1) {
            // rounding errors of sums of numbers of a few tens
            assert!((a - b).norm() < 1e-11, "{a} {b}");
        }
        // the same under a window that falls to e^{-2.4} at the end
        let window = AddedDamping::new(0.05).unwrap();
        let weigh = |samples: &[f64]| -> Vec<f64> {
            let weights = window.weights(48, 1.0).unwrap();
            samples.iter().zip(weights).map(|(x, w)| x * w).collect()
        };
        let mut lines = forward(&weigh(&plain));
        Completion::new(48, (-0.05_f64).exp()).complete(Ending::Ramp, end, &mut lines);
        let found = completed_motion(&hit, "end", Some(12), Some(window)).unwrap();
        for (a, b) in forward(&weigh(&found)).iter().zip(&lines) {
            assert!((a - b).norm() < 1e-11, "{a} {b}");
        }
    }

    #[test]
    fn s1_ringing_does_not_tilt_the_line_at_the_end() {
        let tail: Vec<f64> = (0..100)
            .map(|k| 1.0 + (TAU * 5.3 * k as f64 / 100.0 + 0.4).sin())
            .collect();
        let Completion { cut, .. } = Completion::new(400, 1.0);
        assert_eq!(cut.len(), tail.len());
        // m cycles away, the transform of a Hann window is at most 1/(pi m (m^2 - 1)) of half its
        // sum: 0.2 % for 5.3 cycles
        let end = Ending::Constant.fit(&tail);
        assert!((end.level - 1.0).abs() < 0.004, "{end:?}");
        assert_eq!(
            Ending::of(Quantity::Acceleration).fit(&tail),
            End::default()
        );
    }
}
