//! How long blows act.

use std::ops::Range;

use super::TimeInterval;
use crate::ImpulseError;
use crate::error::check_samples;

/// Part of its peak above which a force acts.
const ACTS: f64 = 0.02;

/// Samples that the anti-alias filter of a recorder rings before and after.
const RINGS_BEFORE: usize = 5;
const RINGS_AFTER: usize = 13;

/// Samples before and after its peak in which a blow acts: as long as the longest of some blows whose force was measured, above 2 % of the peak, and 5 samples
/// before and 13 after for the ringing of an anti-alias filter.
///
/// # Validity
///
/// Blows of the same hammer and tip on the same body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct BlowSpan {
    /// Samples before the peak.
    pub before: usize,
    /// Samples after the peak.
    pub after: usize,
}

impl BlowSpan {
    /// The span of the longest of these `forces` \[N\]; none if there is none, or one that nowhere presses.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonFinite`] for a force.
    pub fn of(forces: &[&[f64]]) -> Result<Option<Self>, ImpulseError> {
        let mut span = Self {
            before: 0,
            after: 0,
        };
        for force in forces {
            check_samples("force of a calibration blow", force)?;
            let largest = force
                .iter()
                .enumerate()
                .max_by(|(_, a), (_, b)| a.total_cmp(b));
            let Some((peak, largest)) = largest.filter(|(_, largest)| **largest > 0.0) else {
                return Ok(None);
            };
            let acts = |f: &f64| *f > ACTS * largest;
            let first = force.iter().position(acts).unwrap_or(peak);
            let last = force.iter().rposition(acts).unwrap_or(peak);
            span.before = span.before.max(peak - first);
            span.after = span.after.max(last - peak);
        }
        span.before += RINGS_BEFORE;
        span.after += RINGS_AFTER;
        Ok((!forces.is_empty()).then_some(span))
    }

    /// Its samples about the sample `peak`, those of a record of `n_samples`.
    #[must_use]
    pub fn about(self, peak: usize, n_samples: usize) -> Range<usize> {
        let end = peak.saturating_add(self.after + 1).min(n_samples);
        peak.saturating_sub(self.before).min(end)..end
    }

    /// The interval that holds these samples and no others, at `sampling_rate_hz`.
    #[must_use]
    pub fn interval(samples: &Range<usize>, sampling_rate_hz: f64) -> TimeInterval {
        // half a sample on either side: no rounding then takes one in or leaves one out
        TimeInterval {
            from: ((samples.start as f64 - 0.5) / sampling_rate_hz).max(0.0),
            to: (samples.end as f64 - 0.5) / sampling_rate_hz,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r22_a_span_is_that_of_the_longest_blow_about_its_peak() {
        let mut short = vec![0.0; 64];
        short[20..23].copy_from_slice(&[50.0, 100.0, 50.0]);
        let mut long = vec![0.0; 64];
        long[30..36].copy_from_slice(&[3.0, 90.0, 80.0, 40.0, 10.0, 1.0]);
        let span = BlowSpan::of(&[&short, &long]).unwrap().unwrap();
        // 1 N is below 2 % of 90 N
        assert_eq!((span.before, span.after), (1 + 5, 3 + 13));
        assert_eq!(span.about(31, 64), 25..48);
        assert_eq!(span.about(2, 10), 0..10);
        let interval = BlowSpan::interval(&(25..48), 1e3);
        assert!((interval.from - 24.5e-3).abs() < 1e-12 && (interval.to - 47.5e-3).abs() < 1e-12);
        assert_eq!(BlowSpan::of(&[]).unwrap(), None);
        assert_eq!(BlowSpan::of(&[&[0.0, -1.0]]).unwrap(), None);
        assert!(BlowSpan::of(&[&[0.0, f64::NAN]]).is_err());
    }
}
