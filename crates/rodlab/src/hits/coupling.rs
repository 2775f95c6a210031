//! Test for a force that does not return to zero after the blow.

use std::f64::consts::TAU;
use std::ops::Range;

use labio::{Quantity, Record};
use num_complex::Complex64;

use super::{FoundHits, comparing};
use crate::RodlabError;
use crate::digits::{hertz, significant};

/// Fraction of the peak force above which a sample belongs to the blow.
const OF_BLOW: f64 = 0.05;
/// Minimum number of samples at rest before a blow.
const FEWEST_AT_REST: usize = 16;
/// Largest tolerated relative error of a line.
const TOLERATED: f64 = 0.02;
/// Smallest ratio of the mean error over the hits to its standard error at which the error counts
/// as alike in all hits.
const ABOVE_CHANCE: f64 = 4.0;
/// Lowest line that is used if no band is stated, as a multiple of the line spacing.
const LOWEST_LINE: f64 = 4.0;

impl FoundHits {
    /// Returns a reason for doubt if the `force` after the blow changes the spectrum of the force
    /// by more than 2 % at `from_hz`, the lowest frequency of the band, and does so alike in all
    /// hits. The true force is zero after the blow; the cause is the undershoot of an AC coupling,
    /// or a drift of the sensor. An input that is a motion gives no doubt: the body continues to
    /// move.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a missing channel.
    pub fn coupling(
        &self,
        force: &str,
        from_hz: Option<f64>,
    ) -> Result<Option<String>, RodlabError> {
        let hits = self.accepted();
        let channels = hits.iter().flat_map(|hit| hit.channels());
        let mut inputs = channels.filter(|channel| channel.name() == force);
        if inputs.any(|channel| !may_be_a_force(channel.quantity())) {
            return Ok(None);
        }
        let from_hz = from_hz.filter(|f| *f > 0.0).or_else(|| {
            let longest = hits.iter().map(|hit| hit.duration());
            longest.reduce(f64::max).map(|span| LOWEST_LINE / span)
        });
        let Some(from_hz) = from_hz else {
            return Ok(None);
        };
        let mut ratios = Vec::with_capacity(hits.len());
        for hit in hits {
            ratios.extend(ratio_after_blow(hit, force, from_hz)?);
        }
        let n = ratios.len() as f64;
        let mean = ratios.iter().sum::<Complex64>() / n;
        let square: f64 = ratios.iter().map(|ratio| (ratio - mean).norm_sqr()).sum();
        let error = (square / (n * (n - 1.0))).sqrt();
        let is_alike = n > 2.0 && mean.norm() > ABOVE_CHANCE * error;
        Ok((is_alike && mean.norm() > TOLERATED).then(|| {
            format!(
                "`{force}` does not return to zero after the blow, which changes its spectrum by {} % at {} and by less at higher frequencies: its amplifier is AC-coupled, or its sensor drifts; use only the higher frequencies, or state a force window",
                significant(100.0 * mean.norm(), 2),
                hertz(from_hz)
            )
        }))
    }
}

/// Returns true for a force, and for the signal of a sensor without calibration.
pub(super) fn may_be_a_force(quantity: Quantity) -> bool {
    matches!(
        quantity,
        Quantity::Force | Quantity::Voltage | Quantity::Charge
    )
}

/// Returns the spectrum of the force after the blow divided by that of the blow, at `frequency_hz`;
/// `None` if the hit has fewer than `FEWEST_AT_REST` samples at rest before the blow.
fn ratio_after_blow(
    hit: &Record,
    force: &str,
    frequency_hz: f64,
) -> Result<Option<Complex64>, RodlabError> {
    let samples = hit.channel(force).map_err(comparing)?;
    let omega = TAU * frequency_hz / hit.sampling_rate_hz();
    Ok(ratio(&samples.to_vec(), omega))
}

fn ratio(samples: &[f64], omega: f64) -> Option<Complex64> {
    let (first, end) = extent(samples)?;
    // margin before and after the blow, for the transients of a filter
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

/// Returns the first sample of the blow, and the first sample after the blow.
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

    #[test]
    fn only_a_force_must_return_to_zero() {
        let tested = Quantity::ALL.into_iter().filter(|of| may_be_a_force(*of));
        let expected = [Quantity::Force, Quantity::Voltage, Quantity::Charge];
        assert_eq!(tested.collect::<Vec<_>>(), expected);
    }

    /// The high-pass 1/(1 + ω_c/(iω)) of an AC coupling at 5 Hz removes a fraction of the force. To
    /// first order, this fraction is ω_c/(iω), with magnitude 0.25 at 20 Hz.
    #[test]
    fn an_ac_coupling_leaves_an_undershoot() {
        let rate_hz = 8192.0;
        let omega = TAU * 20.0 / rate_hz;
        let blow = |n: usize| {
            let x = (n as f64 - 800.0) / 4.0;
            let inside = (0.0..=1.0).contains(&x);
            if inside {
                (std::f64::consts::PI * x).sin()
            } else {
                0.0
            }
        };
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
        // the test counts the first 0.7 ms of the undershoot as part of the blow, an error of 2 %
        assert!((found - expected).norm() < 0.03, "{found}");
        assert_eq!(ratio(&coupled[795..], omega), None);
    }
}
