//! Variance of the changes of an excitation at its later fronts.
//!
//! The variance q of the prior is that of the changes near the first front. Waves that return from
//! the free end, and the end of the contact, may change the velocity more abruptly. With the
//! variance of the first front, the estimate smooths such a later front, and its error is far above
//! the stated standard error: for an impact given in closed form with a returning wave, the mean
//! square of error over standard error is 180.
//!
//! The innovations z = L⁻¹ v_e of the record, K = L Lᵀ, are standard normal numbers if the prior
//! is right (Mehra, *IEEE Trans. Autom. Control* **15** (1970) 175). Where the mean of z² over a
//! part of the record exceeds 1 by three of its standard errors, the variance of the changes in
//! this part is multiplied by this mean, and K is computed again, until no part exceeds the limit
//! or the variance is that of a step as high as the record. The variance is never reduced below
//! that of the first front.

use faer::{Mat, Side};

use crate::recorder::contact::{Contact, Shown, value_at};
use crate::recorder::filter::Observation;

/// Number of samples in a part: a front rises within two to four samples.
const PART: usize = 4;

/// Number of samples to either side of a part that are included in its mean, so that a front at the
/// border of two parts raises both.
const ABOUT: usize = 2;

/// Number of standard errors by which the mean square must exceed 1.
const ABOVE_CHANCE: f64 = 3.0;

/// Largest number of times that a variance is raised; two or three suffice.
const ROUNDS: usize = 6;

/// Factors of the variance of the changes in the parts of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LaterFronts {
    of_parts: Vec<f64>,
}

impl LaterFronts {
    /// Finds the factors from the innovations of a `record`; `contact` is its most likely contact.
    /// `None` if the covariance of the record is not positive definite.
    pub(super) fn of(
        record: &[f64],
        noise: &Mat<f64>,
        contact: Contact<'_>,
        seen: &Observation,
    ) -> Option<Self> {
        let points = seen.points(record.len());
        let shown = Shown::of(contact.memory, (points, record.len()), seen);
        let mut found = Self {
            of_parts: vec![1.0; record.len().div_ceil(PART)],
        };
        let most = contact.step / contact.change;
        for _ in 0..ROUNDS {
            let factors = found.at_points(points, seen);
            let contact = contact.with_factors(&factors);
            let factor = shown
                .covariance(&contact, (0, noise))
                .llt(Side::Lower)
                .ok()?;
            let mut innovations = Mat::from_fn(record.len(), 1, |i, _| value_at(record, i));
            factor
                .L()
                .solve_lower_triangular_in_place(innovations.as_mut());
            if !found.raise(innovations.col_as_slice(0), most) {
                break;
            }
        }
        Some(found)
    }

    /// Raises the factors where the innovations require it, to `most` at most; returns true if it
    /// has raised one.
    fn raise(&mut self, innovations: &[f64], most: f64) -> bool {
        let mut is_raised = false;
        for (part, factor) in self.of_parts.iter_mut().enumerate() {
            let from = (part * PART).saturating_sub(ABOUT);
            let about = innovations.iter().skip(from);
            let about = about.take((part + 1) * PART + ABOUT - from);
            let count = about.len() as f64;
            let mean = about.map(|z| z * z).sum::<f64>() / count;
            if mean > 1.0 + ABOVE_CHANCE * (2.0 / count).sqrt() && *factor < most {
                *factor = (*factor * mean).min(most);
                is_raised = true;
            }
        }
        is_raised
    }

    /// Factors at the points of the grid of `seen`. A point belongs to the part that contains its
    /// sample, which is later by the delay of the filter; points after the last part have the
    /// factor 1.
    pub(super) fn at_points(&self, points: usize, seen: &Observation) -> Vec<f64> {
        let part = |point: usize| (point + seen.delay()) / seen.every() / PART;
        (0..points)
            .map(|point| self.of_parts.get(part(point)).copied().unwrap_or(1.0))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that innovations of size 1 raise no factor, and that three of size 10 raise the parts
    /// within two samples of them to the mean square over eight samples: (300 + 5)/8 in their own
    /// part, (200 + 6)/8 and (100 + 7)/8 in the parts before and after it.
    #[test]
    fn a_front_raises_the_parts_about_it() {
        let flat = || LaterFronts {
            of_parts: vec![1.0; 5],
        };
        let mut innovations = [1.0; 20];
        let mut unchanged = flat();
        assert!(!unchanged.raise(&innovations, 40.0));
        assert_eq!(unchanged, flat());
        innovations[8..11].fill(10.0);
        let mut raised = flat();
        assert!(raised.raise(&innovations, 40.0));
        let expected = [1.0, 206.0 / 8.0, 305.0 / 8.0, 107.0 / 8.0, 1.0];
        // two points per sample and no delay, so that the last two points are after the last part
        let at_points = raised.at_points(42, &Observation::direct(2));
        for (point, found) in at_points.iter().enumerate() {
            let of_part = expected.get(point / 8).unwrap_or(&1.0);
            assert!((found - of_part).abs() < 1e-12, "{point} {found}");
        }
        // the second call raises the factor of the third part to its limit
        assert!(raised.raise(&innovations, 40.0));
        assert!((raised.of_parts[2] - 40.0).abs() < 1e-12);
        raised.raise(&innovations, 40.0);
        assert!(!raised.raise(&innovations, 40.0));
    }
}
