//! Uncertainty of the end of a contact.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::{ContactEnd, ForceBand, ForceError, ForceHistory, ImpactForce};

/// Interval in standard errors of the time within which the force must be linear.
const REACH: f64 = 2.0;
/// Largest deviation from a straight line at the reach, in standard errors of the force, divided by
/// the reach.
const STRAIGHT: f64 = 0.25;
/// Probability above which an earlier separation is reported.
const WORTH_A_WORD: f64 = 1e-3;

/// The standard error of the end of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EndError {
    /// The end $`t_0`$ \[s\].
    pub time: f64,
    /// $`\sigma_F(t_0)/\lvert\dot F_s(t_0)\rvert`$ \[s\].
    pub standard_error: f64,
    /// Verdict on the validity of the standard error.
    pub verdict: EndVerdict,
}

/// Linearity of the relation between the end of a contact and the force.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum EndVerdict {
    /// The force is linear within two standard errors of the end.
    Linear,
    /// The force is not linear there, or the record ends there. The distribution of the end is
    /// skewed; a Monte Carlo computation shows it.
    Curved {
        /// Deviation two standard errors from the end, in standard errors of the force there;
        /// infinite beyond the record.
        deviation: f64,
    },
    /// The faces may have separated earlier, where the force is close to zero within the contact.
    /// The end has two or more likely values, which a standard error cannot describe.
    MayEndEarlier {
        /// Time of the minimum \[s\].
        time: f64,
        /// Probability that the force is tensile there.
        probability: f64,
    },
}

impl ForceError {
    /// Returns the standard error of the end of `impact`, which was separated from `stick`; `None`
    /// if the contact does not end.
    #[must_use]
    pub fn contact_end(&self, stick: &ForceHistory, impact: &ImpactForce) -> Option<EndError> {
        let ContactEnd::Separated { time } = impact.end else {
            return None;
        };
        let force = stick.force();
        let step = stick.time_step();
        let last = (0..force.len())
            .take_while(|n| stick.time_at(*n) <= time)
            .last()?;
        let next = force.get(last + 1)?;
        let slope = (next - force.get(last)?) / step;
        let of_force = *self.standard_error().get(last)?;
        let standard_error = of_force / slope.abs();
        Some(EndError {
            time,
            standard_error,
            verdict: self
                .early_end(stick, impact, time - REACH * standard_error)
                .unwrap_or_else(|| {
                    let deviation = [-1.0, 1.0]
                        .map(|side| {
                            let away = side * REACH * standard_error;
                            interpolated(stick, time + away)
                                .map_or(f64::INFINITY, |f| (f - slope * away).abs() / of_force)
                        })
                        .into_iter()
                        .fold(0.0, f64::max);
                    // without error the end is certain for any curvature of the force
                    if of_force > 0.0 && deviation > STRAIGHT * REACH {
                        EndVerdict::Curved { deviation }
                    } else {
                        EndVerdict::Linear
                    }
                }),
        })
    }

    /// Returns the most likely minimum within the contact and before `until` at which the force may
    /// have been tensile.
    fn early_end(
        &self,
        stick: &ForceHistory,
        impact: &ImpactForce,
        until: f64,
    ) -> Option<EndVerdict> {
        let normal = Normal::standard();
        let samples = impact.history.force().windows(3).enumerate();
        samples
            .filter_map(|(index, window)| {
                let [before, force, after] = window else {
                    return None;
                };
                let time = stick.time_at(index + 1);
                let error = *self.standard_error().get(index + 1)?;
                let is_minimum = *before > 0.0 && force < before && force <= after;
                (is_minimum && time < until && error > 0.0)
                    .then(|| (time, normal.cdf(-force / error)))
            })
            .max_by(|(_, a), (_, b)| a.total_cmp(b))
            .filter(|(_, probability)| *probability > WORTH_A_WORD)
            .map(|(time, probability)| EndVerdict::MayEndEarlier { time, probability })
    }
}

/// Returns the band of the impact force of `impact` from the band of its stick force. The band
/// excludes tension; it is zero before contact and after the upper limit of the stick force first
/// falls to zero beyond the stated end. Where the lower limit is zero the contact may have ended.
///
/// # Validity
///
/// The contact must end near its stated end; [`EndVerdict::MayEndEarlier`] reports that it may not.
#[must_use]
pub fn contact_band(stick_band: &ForceBand, impact: &ImpactForce) -> ForceBand {
    let mut band = stick_band.clone().compressive();
    let history = &impact.history;
    let end = match impact.end {
        ContactEnd::Separated { time } => time,
        ContactEnd::InContact => f64::INFINITY,
        ContactEnd::NoContact => f64::NEG_INFINITY,
    };
    let mut has_ended = false;
    let limits = band.lower.iter_mut().zip(&mut band.upper);
    for (index, (lower, upper)) in limits.enumerate() {
        let time = history.time_at(index);
        has_ended |= time > end && *upper <= 0.0;
        if has_ended || time < 0.0 {
            (*lower, *upper) = (0.0, 0.0);
        }
        if time > end {
            *lower = 0.0;
        }
    }
    band
}

/// Linear interpolation between samples.
fn interpolated(history: &ForceHistory, time: f64) -> Option<f64> {
    let position = (time - history.time_at(0)) / history.time_step();
    let force = history.force();
    let before = (0..force.len()).find(|n| *n as f64 + 1.0 > position)?;
    let fraction = position - before as f64;
    let (a, b) = (force.get(before)?, force.get(before + 1)?);
    (fraction >= 0.0).then(|| a + fraction * (b - a))
}
