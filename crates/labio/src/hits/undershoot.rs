//! Detection of a force that does not return to zero after the impact.

use std::f64::consts::TAU;
use std::ops::Range;

use num_complex::Complex64;

use crate::error::check_positive;
use crate::{LabioError, Record};

/// Fraction of the peak force above which a sample belongs to the impact.
const OF_BLOW: f64 = 0.05;
/// Minimum number of samples at rest before an impact.
const FEWEST_AT_REST: usize = 16;
/// Largest tolerated relative error of a line.
const TOLERATED: f64 = 0.02;
/// Smallest ratio of the mean error over the hits to its standard error at which the error counts
/// as common to all hits.
const ABOVE_CHANCE: f64 = 4.0;
/// Lowest line that is used if no band is stated, as a multiple of the line spacing.
const LOWEST_LINE: f64 = 4.0;

/// Error of the spectrum of a force that does not return to zero after the impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Undershoot {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Spectrum of the force after the impact divided by that of the impact; mean over the hits.
    pub ratio: Complex64,
    /// Standard error of the mean.
    pub standard_error: f64,
}

/// Returns the error of the spectrum of the `force` at `from_hz`, the lowest frequency that is used
/// (`None` for four lines of the longest hit), if the error is above 2 % and common to all `hits`.
/// The true force is zero after the impact; the cause of the error is the undershoot of an AC
/// coupling, or a drift of the sensor. The error falls with frequency.
///
/// The impact lasts from sample $`b`$ to sample $`e`$: the time about the peak in which the force
/// exceeds 5 % of the peak, with a margin of the same length on both sides. With the mean $`F_0`$
/// of the samples before the impact, the error of one hit is
///
/// ```math
/// r = \frac{\sum_{n \ge e} (F_n - F_0)\,e^{-i\omega n}}
/// {\sum_{b \le n < e} (F_n - F_0)\,e^{-i\omega n}} .
/// ```
///
/// The error is common to all hits if the mean of $`r`$ exceeds four of its standard errors.
///
/// # Validity
///
/// Three hits or more are needed; hits with fewer than 16 samples before the impact are left out.
/// With fewer hits, or if the channel is a motion, which continues after the impact, nothing is
/// found.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`]; [`LabioError::NonPhysical`] for a frequency that is not above 0.
///
/// # Examples
///
/// ```
/// use labio::hits::find_undershoot;
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// // after an impact of 10 samples the force is -1 % of its peak, and returns within 100 samples
/// let samples = Array2::from_shape_fn((1, 1000), |(_, n)| match n {
///     100..110 => 1.0,
///     110.. => -0.01 * (-(n as f64 - 110.0) / 100.0).exp(),
///     _ => 0.0,
/// });
/// let channels = vec![Channel::new("hammer", Quantity::Force)?];
/// let hit = Record::new(samples, 1e4, 0.0, channels, Provenance::computed("example"))?;
/// let found = find_undershoot(&[&hit; 3], "hammer", Some(10.0))?.expect("an undershoot");
/// // 0.01 · 100/10 / |1 + iω · 10 ms|, without the first 10 samples, which are part of the impact
/// assert!((found.ratio.norm() - 0.077).abs() < 0.003);
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn find_undershoot(
    hits: &[&Record],
    force: &str,
    from_hz: Option<f64>,
) -> Result<Option<Undershoot>, LabioError> {
    let longest = hits.iter().map(|hit| hit.duration()).reduce(f64::max);
    let Some(frequency_hz) = from_hz.or_else(|| longest.map(|span| LOWEST_LINE / span)) else {
        return Ok(None);
    };
    check_positive("lowest frequency [Hz]", frequency_hz)?;
    let mut ratios = Vec::with_capacity(hits.len());
    for hit in hits {
        let (_, channel) = crate::channel::find(hit.channels(), force)?;
        if !channel.quantity().may_be_force() {
            return Ok(None);
        }
        let omega = TAU * frequency_hz / hit.sampling_rate_hz();
        ratios.extend(ratio(&hit.channel(force)?.to_vec(), omega));
    }
    let n = ratios.len() as f64;
    let mean = ratios.iter().sum::<Complex64>() / n;
    let square: f64 = ratios.iter().map(|ratio| (ratio - mean).norm_sqr()).sum();
    let standard_error = (square / (n * (n - 1.0))).sqrt();
    let is_alike = n > 2.0 && mean.norm() > ABOVE_CHANCE * standard_error;
    Ok((is_alike && mean.norm() > TOLERATED).then_some(Undershoot {
        frequency_hz,
        ratio: mean,
        standard_error,
    }))
}

/// Returns r at `omega` (in rad per sample); `None` if there are fewer than `FEWEST_AT_REST`
/// samples at rest before the impact.
fn ratio(samples: &[f64], omega: f64) -> Option<Complex64> {
    let (first, end) = extent(samples)?;
    // margin before and after the impact, for the transients of a filter
    let beside = end - first;
    let before = first.saturating_sub(beside);
    if before < FEWEST_AT_REST {
        return None;
    }
    let rest = samples.iter().take(before).sum::<f64>() / before as f64;
    let sum = |range: Range<usize>| -> Complex64 {
        let part = samples.iter().enumerate();
        part.skip(range.start)
            .take(range.len())
            .map(|(n, x)| (x - rest) * Complex64::cis(-omega * n as f64))
            .sum()
    };
    let over = (end + beside).min(samples.len());
    let blow = sum(before..over);
    (blow.norm() > 0.0).then(|| sum(over..samples.len()) / blow)
}

/// Returns the first sample of the impact, and the first sample after the impact.
fn extent(samples: &[f64]) -> Option<(usize, usize)> {
    let magnitudes = samples.iter().map(|x| x.abs()).enumerate();
    let (at, peak) = magnitudes.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let acts = |x: &&f64| x.abs() > OF_BLOW * peak;
    let after = samples.iter().skip(at).take_while(acts).count();
    let before = samples.iter().take(at).rev().take_while(acts).count();
    Some((at - before, at + after))
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::half_sine::half_sine;

    /// The high-pass 1/(1 + ω_c/(iω)) of an AC coupling at 5 Hz removes a fraction of the force. To
    /// first order, this fraction is ω_c/(iω), with magnitude 0.25 at 20 Hz.
    #[test]
    fn an_ac_coupling_leaves_an_undershoot() {
        let rate_hz = 8192.0;
        let omega = TAU * 20.0 / rate_hz;
        let blow = |n: usize| half_sine((n as f64 - 800.0) / 4.0);
        // a constant offset is not an undershoot
        let force: Vec<f64> = (0..65_536).map(|n| blow(n) + 0.01).collect();
        assert!(ratio(&force, omega).unwrap().norm() < 1e-9);
        let decay = (-TAU * 5.0 / rate_hz).exp();
        let (mut last, mut state) = (0.0, 0.0);
        let coupled: Vec<f64> = (0..65_536)
            .map(|n| {
                state = decay * (state + blow(n) - last);
                last = blow(n);
                state
            })
            .collect();
        let found = ratio(&coupled, omega).unwrap();
        let expected = -(1.0 / (1.0 + Complex64::new(0.0, 4.0)));
        // the first 0.7 ms of the undershoot count as part of the impact, an error of 2 %
        assert!((found - expected).norm() < 0.03, "{found}");
        assert_eq!(ratio(&coupled[795..], omega), None);
    }
}
