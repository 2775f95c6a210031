//! The end of the contact.

use std::ops::Range;

use crate::error::check_not_negative;
use crate::{ForceHistory, ImpulseError};

/// End of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ContactEnd {
    /// The faces separate at this time \[s\] after contact.
    Separated {
        /// First zero of the stick force, by linear interpolation between samples.
        time: f64,
    },
    /// The force stays compressive to the end of the history.
    InContact,
    /// The force never exceeds the threshold: there is no contact.
    NoContact,
}

/// A minimum of the force within the contact, where the faces came closest to separating.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Graze {
    /// Time \[s\].
    pub time: f64,
    /// Force \[N\].
    pub force: f64,
}

/// The impact force: the stick force until the faces separate, zero afterwards (Ödeen 1993, paper
/// E, eq. 3).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ImpactForce {
    /// Force over the time of the stick force; zero before time 0 and after the contact.
    pub history: ForceHistory,
    /// End of the contact, if it ends.
    pub end: ContactEnd,
    /// The lowest minimum of the force within the contact, if there is one. If it is small
    /// compared with the peak, the time of separation depends on details of the bodies: for
    /// the cone's end B of paper E the force falls to 0.2 N at 1.12 ms and is zero at 1.57 ms.
    pub closest_to_separation: Option<Graze>,
}

impl ImpactForce {
    /// Returns the samples from `margin` \[s\] before the contact to `margin` after its end, or to
    /// the end of the history if the contact does not end. Later the stick force is not the impact
    /// force.
    #[must_use]
    pub fn span(&self, margin: f64) -> Range<usize> {
        let history = &self.history;
        let end = match self.end {
            ContactEnd::Separated { time } => history.index_near(time + margin),
            ContactEnd::InContact | ContactEnd::NoContact => None,
        };
        let end = end.unwrap_or(history.force().len() - 1);
        history.index_near(-margin).unwrap_or(0)..end + 1
    }
}

/// Ends the contact at the first zero $`t_0`$ of the stick force, $`F = F_s[H(t) - H(t-t_0)]`$
/// (Ödeen 1993, paper E, eq. 3).
///
/// Time 0 of the history is the first touch; the part smeared before it by the band limit is set to
/// zero. The contact begins with the first sample from time 0 on that is above `threshold` \[N\].
/// The force ceases to be compressive when it falls below minus the threshold, and $`t_0`$ is then
/// the preceding zero. The threshold 0 gives the printed equation; set it to the level of ringing
/// or noise in the stick force.
///
/// # Validity
///
/// The bodies must not touch again after $`t_0`$, a condition that the printed equation does not
/// state: in one-dimensional theory the cone's end B touches three more times.
///
/// # Errors
///
/// [`ImpulseError::NonPhysical`] if the threshold is negative or not finite.
pub fn separate(stick: &ForceHistory, threshold: f64) -> Result<ImpactForce, ImpulseError> {
    check_not_negative("threshold of contact [N]", threshold)?;
    let samples = stick.force();
    let first_sample = stick.time_at(0).max(0.0);
    let touch = stick.index_near(first_sample).unwrap_or(samples.len());
    let after_touch = samples.get(touch..).unwrap_or_default();
    let first_pressed = after_touch.iter().position(|&force| force > threshold);
    let Some(begin) = first_pressed.map(|index| touch + index) else {
        return Ok(ImpactForce {
            history: stick.with_force(vec![0.0; samples.len()]),
            end: ContactEnd::NoContact,
            closest_to_separation: None,
        });
    };
    let contact = samples.get(begin..).unwrap_or_default();
    let (kept, end) = match contact.iter().position(|&force| force < -threshold) {
        None => (contact.len(), ContactEnd::InContact),
        Some(negative) => {
            // the first sample of the contact is positive, so a negative sample is never the first
            let before = contact.get(..negative).unwrap_or_default();
            let last = before.iter().rposition(|&force| force >= 0.0).unwrap_or(0);
            let fraction = match contact.get(last..) {
                Some([force, next, ..]) => force / (force - next),
                _ => 0.0,
            };
            let time = stick.time_at(begin + last) + fraction * stick.time_step();
            (last + 1, ContactEnd::Separated { time })
        }
    };
    let force = samples
        .iter()
        .enumerate()
        .map(|(index, &force)| {
            if (touch..begin + kept).contains(&index) {
                force
            } else {
                0.0
            }
        })
        .collect();
    Ok(ImpactForce {
        history: stick.with_force(force),
        end,
        closest_to_separation: lowest_minimum(stick, begin, begin + kept),
    })
}

/// Returns the lowest sample in `begin..end` that is below its neighbours there.
fn lowest_minimum(stick: &ForceHistory, begin: usize, end: usize) -> Option<Graze> {
    let contact = stick.force().get(begin..end).unwrap_or_default();
    contact
        .windows(3)
        .enumerate()
        .filter_map(|(index, window)| match window {
            [before, force, after] if force < before && force <= after => Some(Graze {
                time: stick.time_at(begin + index + 1),
                force: *force,
            }),
            _ => None,
        })
        .min_by(|a, b| a.force.total_cmp(&b.force))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(force: &[f64]) -> ForceHistory {
        ForceHistory::new(0.0, 0.5, force.to_vec()).unwrap()
    }

    /// (Ödeen 1993, paper E, eq. 3).
    #[test]
    fn the_contact_ends_at_the_first_zero_and_stays_ended() {
        let stick = history(&[0.0, 4.0, 1.0, 2.0, 3.0, -1.0, -2.0, 5.0]);
        let impact = separate(&stick, 0.0).unwrap();
        assert_eq!(
            impact.history.force(),
            [0.0, 4.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0]
        );
        // 3 N to -1 N: three quarters of a step after 2 s
        assert_eq!(impact.end, ContactEnd::Separated { time: 2.375 });
        let graze = impact.closest_to_separation.unwrap();
        assert_eq!((graze.time, graze.force), (1.0, 1.0));
    }

    #[test]
    fn the_span_of_a_contact_has_margins_within_the_history() {
        let force = vec![0.0, 0.0, 4.0, 2.0, -2.0, 0.0, 0.0, 0.0];
        let stick = ForceHistory::new(-1.0, 0.5, force).unwrap();
        let impact = separate(&stick, 0.0).unwrap();
        // the contact lasts from 0 to 0.75 s
        assert_eq!(impact.end, ContactEnd::Separated { time: 0.75 });
        assert_eq!(impact.span(0.5), 1..6);
        assert_eq!(impact.span(9.0), 0..8);
        let pressed = separate(&history(&[1.0; 4]), 0.0).unwrap();
        assert_eq!(pressed.span(0.5), 0..4);
    }

    #[test]
    fn a_ledge_of_a_rising_force_is_no_graze() {
        let stick = history(&[0.0, 1.0, 1.0, 3.0, 2.0, 3.0, -1.0]);
        let graze = separate(&stick, 0.0).unwrap().closest_to_separation;
        let graze = graze.unwrap();
        assert_eq!((graze.time, graze.force), (2.0, 2.0));
    }

    #[test]
    fn ringing_below_the_threshold_neither_begins_nor_ends_a_contact() {
        let stick = history(&[0.1, -0.1, 4.0, 2.0, -0.1, 0.1, 2.0, 1.0]);
        let impact = separate(&stick, 0.2).unwrap();
        assert_eq!(impact.end, ContactEnd::InContact);
        assert_eq!(impact.history, stick);
        let to_the_letter = separate(&stick, 0.0).unwrap();
        assert_eq!(
            to_the_letter.end,
            ContactEnd::Separated { time: 0.25 },
            "0.1 N at 0 s to -0.1 N at 0.5 s"
        );
    }

    #[test]
    fn what_stands_ahead_of_time_0_is_no_contact() {
        let stick = ForceHistory::new(-1.0, 0.5, vec![0.3, -0.3, 2.0, 4.0, 2.0, -2.0]).unwrap();
        let impact = separate(&stick, 0.0).unwrap();
        assert_eq!(impact.history.force(), [0.0, 0.0, 2.0, 4.0, 2.0, 0.0]);
        assert_eq!(impact.end, ContactEnd::Separated { time: 1.25 });
    }

    #[test]
    fn a_pull_is_no_contact() {
        let impact = separate(&history(&[0.0, -1.0, -2.0]), 0.0).unwrap();
        assert_eq!(impact.end, ContactEnd::NoContact);
        assert!(
            impact
                .history
                .force()
                .iter()
                .all(|force| force.abs() < f64::MIN_POSITIVE)
        );
        assert!(separate(&history(&[1.0]), f64::NAN).is_err());
    }

    #[test]
    fn a_pull_of_just_the_threshold_is_still_ringing() {
        // a force of exactly minus the threshold does not end the contact; the next lower
        // floating-point number does
        let at = separate(&history(&[0.0, 4.0, -0.25, 2.0, 1.0]), 0.25).unwrap();
        assert_eq!(at.end, ContactEnd::InContact);
        let below = separate(&history(&[0.0, 4.0, (-0.25_f64).next_down(), 2.0]), 0.25);
        assert!(matches!(below.unwrap().end, ContactEnd::Separated { .. }));
    }

    #[test]
    fn a_late_contact_ends_where_it_ends() {
        let stick = history(&[
            0.0, 0.0, 0.0, 2.0, 1.0, 1.0, 3.0, -1.0, 5.0, 5.0, 0.5, 5.0, 5.0,
        ]);
        let impact = separate(&stick, 0.0).unwrap();
        assert_eq!(impact.history.force()[7..], [0.0; 6]);
        // the first sample of a flat minimum counts as the minimum; samples after the contact do
        // not count
        let graze = impact.closest_to_separation.unwrap();
        assert_eq!((graze.time, graze.force), (2.0, 1.0));
    }
}
