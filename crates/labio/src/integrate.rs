//! Integrals and derivatives of histories, with a chosen treatment of low frequencies.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::LabioError;
use crate::dft;
use crate::error::{check_enough_samples, check_positive, check_samples, count_mismatch};

/// Treatment of low frequencies in an integration. An offset of 1 becomes a drift of t, so every
/// integration needs a definition of the offset.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LowFrequency {
    /// Treats the history as one period of a periodic history. Its mean is removed, and the
    /// integral has zero mean: this is exact for a sum of the spectral lines of the record; for a
    /// transient it is wrong by a constant and, if the mean of the transient was not zero, a ramp.
    MeanRemoved,
    /// Removes the mean, as [`Self::MeanRemoved`] does, and all lines below a frequency by a sharp
    /// cut-off.
    CutBelow {
        /// First frequency that is kept \[Hz\].
        frequency_hz: f64,
    },
    /// Treats the body as at rest over the first samples, for impacts. Their mean is the offset and
    /// is removed; the integral starts from 0. The trapezoidal rule is used; it gives a result that
    /// is too small by the factor $`\frac{\omega\Delta t}{2}\cot\frac{\omega\Delta t}{2}`$. An
    /// error $`\delta`$ of the offset causes a drift $`\delta t`$.
    AtRest {
        /// Number of samples before the hit.
        n_samples: usize,
    },
}

/// Integrates `samples`, sampled at `sampling_rate_hz` \[Hz\], over time: acceleration to velocity,
/// velocity to displacement.
///
/// # Examples
///
/// ```
/// use labio::{LowFrequency, integrate};
///
/// // at rest with an offset of 0.5, then an acceleration of 2 for a second
/// let acceleration: Vec<f64> = (0..300).map(|n| if n > 100 && n <= 200 { 2.5 } else { 0.5 }).collect();
/// let velocity = integrate(&acceleration, 100.0, LowFrequency::AtRest { n_samples: 50 })?;
/// assert!((velocity[299] - 2.0).abs() < 1e-12);
/// # Ok::<(), labio::LabioError>(())
/// ```
///
/// # Errors
///
/// [`LabioError::NonPhysical`] for the sampling rate or the cut-off frequency,
/// [`LabioError::TooFewSamples`] for fewer than two samples or without a sample at rest,
/// [`LabioError::CountMismatch`] if there are more samples at rest than samples,
/// [`LabioError::NonFiniteSample`].
pub fn integrate(
    samples: &[f64],
    sampling_rate_hz: f64,
    low: LowFrequency,
) -> Result<Vec<f64>, LabioError> {
    check(samples, sampling_rate_hz)?;
    let lowest_hz = match low {
        LowFrequency::MeanRemoved => 0.0,
        LowFrequency::CutBelow { frequency_hz } => {
            check_positive("cut-off frequency [Hz]", frequency_hz)?
        }
        LowFrequency::AtRest { n_samples } => {
            return integrate_from_rest(samples, sampling_rate_hz, n_samples);
        }
    };
    let spacing_hz = sampling_rate_hz / samples.len() as f64;
    let mut lines = dft::forward(samples);
    for (k, line) in lines.iter_mut().enumerate() {
        let f = k as f64 * spacing_hz;
        *line = if k == 0 || f < lowest_hz || 2 * k == samples.len() {
            Complex64::ZERO
        } else {
            *line / Complex64::new(0.0, TAU * f)
        };
    }
    in_range("integral", dft::inverse(&lines, samples.len()))
}

/// Differentiates `samples`, sampled at `sampling_rate_hz` \[Hz\], with respect to time, as one
/// period of a periodic history: each line is multiplied by $`i\omega`$. The line at the Nyquist
/// frequency, whose derivative is zero at every sample, is multiplied by 0.
///
/// # Validity
///
/// If the end of a history does not match its beginning, the history has a jump there, and its
/// derivative a spike with ripples.
///
/// # Errors
///
/// [`LabioError::NonPhysical`] for the sampling rate, [`LabioError::TooFewSamples`] for fewer than
/// two samples, [`LabioError::NonFiniteSample`].
pub fn differentiate(samples: &[f64], sampling_rate_hz: f64) -> Result<Vec<f64>, LabioError> {
    check(samples, sampling_rate_hz)?;
    let spacing_hz = sampling_rate_hz / samples.len() as f64;
    let mut lines = dft::forward(samples);
    for (k, line) in lines.iter_mut().enumerate() {
        *line *= if 2 * k == samples.len() {
            Complex64::ZERO
        } else {
            Complex64::new(0.0, TAU * k as f64 * spacing_hz)
        };
    }
    in_range("derivative", dft::inverse(&lines, samples.len()))
}

/// Accepts a result if it has not overflowed.
fn in_range(what: &str, result: Vec<f64>) -> Result<Vec<f64>, LabioError> {
    check_samples(what, &result)?;
    Ok(result)
}

fn integrate_from_rest(
    samples: &[f64],
    sampling_rate_hz: f64,
    n_at_rest: usize,
) -> Result<Vec<f64>, LabioError> {
    check_enough_samples("the time at rest", n_at_rest, 1)?;
    let Some(at_rest) = samples.get(..n_at_rest) else {
        return count_mismatch("samples at rest, at most", n_at_rest, samples.len());
    };
    let offset = at_rest.iter().sum::<f64>() / n_at_rest as f64;
    let half_step = 0.5 / sampling_rate_hz;
    let mut integral = 0.0;
    let mut previous: Option<f64> = None;
    let integrals = samples
        .iter()
        .map(|sample| {
            let value = sample - offset;
            if let Some(previous) = previous {
                integral += half_step * (previous + value);
            }
            previous = Some(value);
            integral
        })
        .collect();
    in_range("integral", integrals)
}

fn check(samples: &[f64], sampling_rate_hz: f64) -> Result<(), LabioError> {
    check_positive("sampling rate [Hz]", sampling_rate_hz)?;
    check_enough_samples("the history", samples.len(), 2)?;
    check_samples("history", samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 100.0;

    /// Returns n samples of the p-th derivative of a sum of two sines, which have three and seven
    /// periods in the n samples.
    fn periodic(n: usize, p: i32) -> Vec<f64> {
        (0..n)
            .map(|i| {
                [(3.0, 1.5, 0.2), (7.0, -0.4, 1.0)]
                    .iter()
                    .map(|(line, amplitude, phase)| {
                        let omega = TAU * line * RATE / n as f64;
                        let angle = omega * i as f64 / RATE + phase + TAU / 4.0 * f64::from(p);
                        amplitude * omega.powi(p) * angle.sin()
                    })
                    .sum()
            })
            .collect()
    }

    #[test]
    fn lines_below_the_cut_are_removed_and_those_on_it_stay() {
        let n = 64;
        let history = periodic(n, 1);
        let cut = |line: f64| LowFrequency::CutBelow {
            frequency_hz: line * RATE / n as f64,
        };
        let only_seven: Vec<f64> = (0..n)
            .map(|i| -0.4 * (TAU * 7.0 * i as f64 / n as f64 + 1.0).sin())
            .collect();
        for line in [3.5, 7.0] {
            let integral = integrate(&history, RATE, cut(line)).unwrap();
            for (found, expected) in integral.iter().zip(&only_seven) {
                assert!((found - expected).abs() < 1e-13);
            }
        }
        let all = integrate(&history, RATE, cut(3.0)).unwrap();
        assert!((all[0] - periodic(n, 0)[0]).abs() < 1e-13);
    }

    #[test]
    fn bad_requests_are_refused() {
        let history = [1.0, 2.0, 3.0];
        let refusals = [
            integrate(&history[..1], RATE, LowFrequency::MeanRemoved),
            integrate(&history, 0.0, LowFrequency::MeanRemoved),
            integrate(
                &history,
                RATE,
                LowFrequency::CutBelow { frequency_hz: -1.0 },
            ),
            integrate(&history, RATE, LowFrequency::AtRest { n_samples: 0 }),
            integrate(&history, RATE, LowFrequency::AtRest { n_samples: 4 }),
            differentiate(&[], RATE),
            differentiate(&[1.0, f64::NAN], RATE),
        ]
        .map(|result| result.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        the history has 1 samples, expected at least 2
        sampling rate [Hz] is 0, expected a finite value above 0
        cut-off frequency [Hz] is -1, expected a finite value above 0
        the time at rest has 0 samples, expected at least 1
        samples at rest, at most: found 4, expected 3
        the history has 0 samples, expected at least 2
        sample 1 of channel `history` is NaN, expected a finite value
        ");
    }
}
