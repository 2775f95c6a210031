//! Test for a response that changes over the hits: a saturated channel, or another body.

use labio::hits::{HitSpectra, Trend, find_trends};

use super::FoundHits;
use crate::digits::significant;

impl FoundHits {
    /// Returns a reason for doubt for each output whose gain changes with the peak of the `input`,
    /// or whose response differs between the halves of the hits ([`find_trends`]).
    pub(super) fn trends(&self, spectra: &HitSpectra, input: &str) -> Vec<String> {
        let (numbers, _) = self.numbered();
        let number = |hit: usize| numbers.get(hit).copied().unwrap_or_default();
        let in_words = |trend: &Trend| match trend {
            Trend::Gain { channel, change } => {
                let (changes, saturated) = if *change > 0.0 {
                    ("rises", input)
                } else {
                    ("falls", channel.as_str())
                };
                format!(
                    "the gain of `{channel}` {changes} by {} % from the weakest to the strongest hit: `{saturated}` saturates, or the body is nonlinear",
                    significant(100.0 * change.abs(), 2)
                )
            }
            Trend::Halves {
                channel,
                n_first,
                difference,
            } => format!(
                "the response of `{channel}` up to hit {} differs from that of hit {} and later hits by {} %, far more than the hits of each group differ from each other: the groups were measured on two bodies, or with two set-ups",
                number(n_first.saturating_sub(1)),
                number(*n_first),
                significant(100.0 * difference, 2)
            ),
        };
        find_trends(spectra).iter().map(in_words).collect()
    }
}
