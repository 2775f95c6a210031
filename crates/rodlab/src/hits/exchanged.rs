//! Tests for exchanged input and output, and for a reversed force.

use labio::{Quantity, Record};
use ndarray::ArrayView1;

use super::{FoundHits, comparing};
use crate::RodlabError;
use crate::digits::significant;
use crate::median::upper_median;

/// Fraction of the greatest deviation from the median above which a channel counts as moving.
const MOVING: f64 = 0.1;
/// Ratio of the duration of the input to the duration of an output above which the two appear
/// exchanged.
const LONGER: f64 = 3.0;

impl FoundHits {
    /// Returns a reason for doubt for each of `outputs` whose motion lasts less than a third as
    /// long as that of `input`: an impact should end before the response to it. The durations are
    /// medians over the accepted hits.
    pub(super) fn exchanged(
        &self,
        input: &str,
        outputs: &[&str],
    ) -> Result<Vec<String>, RodlabError> {
        let hits = self.accepted();
        let duration = |channel: &str| -> Result<f64, RodlabError> {
            let durations: Result<Vec<f64>, RodlabError> =
                hits.iter().map(|hit| duration_s(hit, channel)).collect();
            Ok(upper_median(durations?).unwrap_or(0.0))
        };
        let of_input = duration(input)?;
        let mut doubts = Vec::new();
        for output in outputs {
            let of_output = duration(output)?;
            if of_input > LONGER * of_output {
                doubts.push(format!(
                    "the input `{input}` lasts {} ms, the output `{output}` {} ms: an impact ends before the response that it causes; input and output may be \
                     exchanged, or `{output}` has a spike",
                    significant(1e3 * of_input, 2),
                    significant(1e3 * of_output, 2)
                ));
            }
        }
        Ok(doubts)
    }

    /// Returns a warning if more than half of the impacts are negative in the channel `force`. A
    /// channel that is not a force gives no warning.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a missing channel.
    pub fn reversed(&self, force: &str) -> Result<Option<String>, RodlabError> {
        let hits = self.accepted();
        let mut negative = 0;
        for hit in &hits {
            let mut channels = hit.channels().iter();
            let is_force = channels.any(|c| c.name() == force && c.quantity() == Quantity::Force);
            let samples = hit.channel(force).map_err(comparing)?;
            // the mean is nearly the rest level, because an impact is short compared with the
            // record
            let level = samples.mean().unwrap_or(0.0);
            let largest = samples.iter().map(|x| x - level);
            let largest =
                largest.fold(0.0, |top: f64, x| if x.abs() > top.abs() { x } else { top });
            negative += usize::from(is_force && largest < 0.0);
        }
        Ok((2 * negative > hits.len()).then(|| {
            format!(
                "The impacts are negative in `{force}`. If a positive force is a push, the sensor is reversed: state `inverted` of its channel as true."
            )
        }))
    }
}

/// Returns the time \[s\] from the first to the last moving sample of a channel.
fn duration_s(hit: &Record, channel: &str) -> Result<f64, RodlabError> {
    let samples = hit.channel(channel).map_err(comparing)?;
    Ok(n_moving(samples) as f64 / hit.sampling_rate_hz())
}

/// Returns the number of samples from the first to the last moving sample.
fn n_moving(samples: ArrayView1<'_, f64>) -> usize {
    let level = upper_median(samples.iter().copied()).unwrap_or(0.0);
    let deviation = |x: &f64| (x - level).abs();
    let limit = MOVING * samples.iter().map(deviation).fold(0.0, f64::max);
    let moving = |x: &f64| deviation(x) > limit;
    let (first, last) = (
        samples.iter().position(moving),
        samples.iter().rposition(moving),
    );
    first.zip(last).map_or(0, |(first, last)| last - first + 1)
}
