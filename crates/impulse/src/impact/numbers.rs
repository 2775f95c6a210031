//! Scalar results of an impact, and their element-wise combination.

use super::{FirstForce, Prediction};
use crate::ForceHistory;

/// Number of quantities in [`ImpactNumbers`].
const COUNT: usize = 11;

/// Scalar results of an impact in SI units, or their errors; `None` for those that an impact does
/// not define.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ImpactNumbers {
    /// Largest force \[N\] without a band limit; if the first force is [`FirstForce::Unbounded`],
    /// the largest force in the band.
    pub peak: Option<f64>,
    /// Time of the largest force \[s\].
    pub time_of_peak: Option<f64>,
    /// Largest force in the band \[N\].
    pub limited_peak: Option<f64>,
    /// Time of the largest force in the band \[s\].
    pub time_of_limited_peak: Option<f64>,
    /// End of the last main contact \[s\].
    pub end: Option<f64>,
    /// Impulse \[N s\].
    pub impulse: Option<f64>,
    /// Coefficient of restitution, if a body is free.
    pub restitution: Option<f64>,
    /// Velocity of each body after the impact [m/s], if it is free.
    pub velocity_after: [Option<f64>; 2],
    /// Inner energy left in each body \[J\].
    pub inner: [Option<f64>; 2],
}

impl ImpactNumbers {
    pub(super) fn of(
        prediction: &Prediction,
        first_force: FirstForce,
        limited: &ForceHistory,
    ) -> Self {
        let in_band = limited.smooth_peak();
        let sampled = prediction.peak();
        let (peak, time_of_peak) = match first_force {
            FirstForce::Unbounded => (in_band.force, in_band.time),
            FirstForce::Jump(jump) if jump >= sampled.force => (jump, 0.0),
            _ => (sampled.force, sampled.time),
        };
        let balance = prediction.balance();
        Self {
            peak: Some(peak),
            time_of_peak: Some(time_of_peak),
            limited_peak: Some(in_band.force),
            time_of_limited_peak: Some(in_band.time),
            end: Some(prediction.duration()),
            impulse: Some(balance.impulse),
            restitution: balance.restitution,
            velocity_after: balance.velocity_after,
            inner: balance.inner.map(Some),
        }
    }

    /// The quantities in the order of the fields.
    pub(super) fn all(&self) -> [Option<f64>; COUNT] {
        let ([v1, v2], [w1, w2]) = (self.velocity_after, self.inner);
        [
            self.peak,
            self.time_of_peak,
            self.limited_peak,
            self.time_of_limited_peak,
            self.end,
            self.impulse,
            self.restitution,
            v1,
            v2,
            w1,
            w2,
        ]
    }

    pub(super) fn from_all(all: [Option<f64>; COUNT]) -> Self {
        let [
            peak,
            time_of_peak,
            limited_peak,
            time_of_limited_peak,
            end,
            impulse,
            restitution,
            v1,
            v2,
            w1,
            w2,
        ] = all;
        Self {
            peak,
            time_of_peak,
            limited_peak,
            time_of_limited_peak,
            end,
            impulse,
            restitution,
            velocity_after: [v1, v2],
            inner: [w1, w2],
        }
    }

    /// Combines the quantities one by one; a result is `None` if either quantity is missing.
    pub(super) fn with(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let other = other.all();
        let mut pairs = self.all().into_iter().zip(other);
        Self::from_all(std::array::from_fn(|_| {
            let (a, b) = pairs.next()?;
            Some(combine(a?, b?))
        }))
    }
}
