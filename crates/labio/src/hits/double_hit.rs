//! Detection of a second contact, in contrast to the ringing of a sensor.

/// One contact in a force history.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Contact {
    begin: usize,
    end: usize,
    peak: f64,
    peak_at: usize,
}

/// A contact other than the main one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SecondContact {
    /// Peak divided by the peak of the main contact.
    pub(super) ratio: f64,
    /// Number of samples between the peaks.
    pub(super) separation: usize,
}

/// Smallest ratio of a contact to the opposite swings next to it. In a decaying oscillation, a
/// swing never exceeds the opposite swing before it, and in the pre-ringing of a filter never the
/// opposite swing after it; the rest of the factor is a margin for noise.
const CONTACT_OVER_SWING: f64 = 1.5;

/// Returns the largest contact other than the main one that exceeds `threshold`. The rest level
/// must have been subtracted from `force`, and `force` must be positive in the main contact.
///
/// A contact ends when the force falls below half the threshold, and the next begins when it
/// exceeds the threshold. Ringing swings to both sides: a contact below [`CONTACT_OVER_SWING`]
/// times the opposite swing next to it, on the side of the main contact, is treated as ringing, and
/// so is a weak second contact hidden in ringing. "Next to it" means within twice the width of the
/// contact plus the duration of the main contact, which must be longer than a period of the sensor
/// for the sensor to measure it.
pub(super) fn second_contact(force: &[f64], threshold: f64) -> Option<SecondContact> {
    let contacts = contacts(force, threshold);
    let main = contacts
        .iter()
        .max_by(|a, b| a.peak.total_cmp(&b.peak))
        .copied()?;
    contacts
        .iter()
        .filter(|contact| contact.begin != main.begin)
        .filter(|contact| {
            let near = main.end - main.begin + 2 * (contact.end - contact.begin);
            let between = if contact.begin > main.begin {
                main.end.max(contact.begin.saturating_sub(near))..contact.begin
            } else {
                contact.end..main.begin.min(contact.end + near)
            };
            #[allow(
                clippy::indexing_slicing,
                reason = "contacts lie within the force and not in each other"
            )]
            let swing = force[between]
                .iter()
                .fold(0.0, |swing: f64, f| swing.max(-f));
            contact.peak > CONTACT_OVER_SWING * swing
        })
        .max_by(|a, b| a.peak.total_cmp(&b.peak))
        .map(|contact| SecondContact {
            ratio: contact.peak / main.peak,
            separation: contact.peak_at.abs_diff(main.peak_at),
        })
}

fn contacts(force: &[f64], threshold: f64) -> Vec<Contact> {
    let mut contacts = Vec::new();
    let mut open: Option<Contact> = None;
    for (index, &f) in force.iter().enumerate() {
        match &mut open {
            None if f > threshold => {
                open = Some(Contact {
                    begin: index,
                    end: index + 1,
                    peak: f,
                    peak_at: index,
                });
            }
            None => {}
            Some(contact) if f < threshold / 2.0 => {
                contacts.push(Contact {
                    end: index,
                    ..*contact
                });
                open = None;
            }
            Some(contact) => {
                contact.end = index + 1;
                if f > contact.peak {
                    (contact.peak, contact.peak_at) = (f, index);
                }
            }
        }
    }
    contacts.extend(open);
    contacts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half_sine(force: &mut [f64], begin: usize, length: usize, peak: f64) {
        for k in 0..length {
            force[begin + k] += peak * (std::f64::consts::PI * k as f64 / length as f64).sin();
        }
    }

    /// Adds ringing of `amplitude` that begins with a swing to the other side.
    fn ring(force: &mut [f64], begin: usize, amplitude: f64) {
        for (k, f) in force[begin..].iter_mut().enumerate() {
            let t = k as f64;
            *f -= amplitude * (-t / 40.0).exp() * (std::f64::consts::TAU * t / 9.0).sin();
        }
    }

    #[test]
    fn a_bounce_is_found_before_and_after_the_main_contact() {
        let mut force = vec![0.0; 400];
        half_sine(&mut force, 50, 20, 100.0);
        assert_eq!(second_contact(&force, 5.0), None);
        half_sine(&mut force, 150, 30, 20.0);
        let found = second_contact(&force, 5.0).unwrap();
        // from the peak at sample 60 (20 samples from 50 on) to the peak at sample 165 (30 samples
        // from 150 on)
        assert_eq!(found.separation, 105);
        assert!((found.ratio - 0.2).abs() < 1e-12);
        force.reverse();
        assert_eq!(second_contact(&force, 5.0).unwrap().separation, 105);
    }

    #[test]
    fn ringing_is_no_contact_but_a_contact_within_it_is() {
        let mut force = vec![0.0; 400];
        half_sine(&mut force, 50, 20, 100.0);
        ring(&mut force, 70, 15.0);
        assert_eq!(second_contact(&force, 5.0), None);
        let mut mirrored = force.clone();
        mirrored.reverse();
        assert_eq!(
            second_contact(&mirrored, 5.0),
            None,
            "ringing of a filter before"
        );
        half_sine(&mut force, 150, 30, 40.0);
        let found = second_contact(&force, 5.0).unwrap();
        // tolerance: the ringing, 15·exp(-2) = 2 % of the main peak at that time
        assert!((found.ratio - 0.4).abs() < 0.021, "{found:?}");
    }

    #[test]
    fn a_force_with_two_peaks_that_never_lets_go_is_one_contact() {
        let mut force = vec![0.0; 400];
        half_sine(&mut force, 50, 40, 100.0);
        half_sine(&mut force, 80, 40, 60.0);
        assert_eq!(second_contact(&force, 5.0), None);
    }
}
