//! Duration of blows.

use std::ops::Range;

use super::TimeInterval;
use crate::ImpulseError;
use crate::error::check_samples;

/// Fraction of its peak above which a force counts as acting.
const ACTS: f64 = 0.02;

/// Samples of ringing of a recorder's anti-alias filter before and after a blow.
const RINGS_BEFORE: usize = 5;
const RINGS_AFTER: usize = 13;

/// Number of samples before and after its peak in which a blow acts: the largest numbers of several
/// measured blows above 2 % of their peaks, plus 5 samples before and 13 after for the ringing of
/// an anti-alias filter.
///
/// # Validity
///
/// Valid for blows of the same hammer and tip on the same body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct BlowSpan {
    /// Samples before the peak.
    pub before: usize,
    /// Samples after the peak.
    pub after: usize,
}

impl BlowSpan {
    /// Returns the span of the longest of these `forces` \[N\]; `None` if there are none, or if a
    /// force is nowhere compressive.
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

    /// Span `times` times as long on either side.
    #[must_use]
    pub fn longer(self, times: usize) -> Self {
        Self {
            before: times.saturating_mul(self.before),
            after: times.saturating_mul(self.after),
        }
    }

    /// Samples of the span about the sample `peak`, within a record of `n_samples`.
    #[must_use]
    pub fn about(self, peak: usize, n_samples: usize) -> Range<usize> {
        let end = peak.saturating_add(self.after + 1).min(n_samples);
        peak.saturating_sub(self.before).min(end)..end
    }

    /// Interval that contains exactly these samples, at `sampling_rate_hz`.
    #[must_use]
    pub fn interval(samples: &Range<usize>, sampling_rate_hz: f64) -> TimeInterval {
        // half a sample on either side, so that rounding neither adds nor removes one
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
