//! A measured contact curve.

use crate::ImpulseError;
use crate::error::check_enough;

/// A piecewise linear force-approach curve, with optionally stiffer unloading.
///
/// Loading follows the curve and, beyond its last point, the extension of the last piece. Without
/// an unloading stiffness, unloading follows the same path. With an unloading stiffness, the force
/// falls from the end of loading to zero along a straight line of that stiffness and leaves a dent;
/// reloading follows the same straight line. The energy between the two paths is lost.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedContact {
    /// Points (δ, F), the first of them (0, 0).
    points: Vec<(f64, f64)>,
    /// Energy up to each point.
    energy: Vec<f64>,
    unloading_stiffness: Option<f64>,
}

impl TabulatedContact {
    /// Creates a curve through `points` (δ \[m\], F \[N\]), the first of them (0, 0).
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] for fewer than two points; [`ImpulseError::ContactTable`] unless
    /// both δ and F are finite and increase from point to point, with slopes and energies within
    /// the floating-point range.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, ImpulseError> {
        check_enough("contact law", points.len(), 2)?;
        let wrong = |index: usize, (approach, force): (f64, f64), expected| {
            Err(ImpulseError::ContactTable {
                index,
                approach,
                force,
                expected,
            })
        };
        let mut energy = Vec::with_capacity(points.len());
        let mut before = (0.0, 0.0);
        for (index, &point) in points.iter().enumerate() {
            if !(point.0.is_finite() && point.1.is_finite()) {
                return wrong(index, point, "finite values");
            }
            if index == 0 {
                if point.0.abs() > 0.0 || point.1.abs() > 0.0 {
                    return wrong(index, point, "(0, 0) as the first point");
                }
                energy.push(0.0);
                continue;
            }
            if point.0 <= before.0 || point.1 <= before.1 {
                return wrong(
                    index,
                    point,
                    "approach and force above those of the previous point",
                );
            }
            let so_far = energy.last().copied().unwrap_or(0.0);
            let up_to_here = so_far + 0.5 * (point.0 - before.0) * (point.1 + before.1);
            let slope = (point.1 - before.1) / (point.0 - before.0);
            if !(up_to_here.is_finite() && up_to_here > so_far && slope.is_finite()) {
                return wrong(
                    index,
                    point,
                    "a piece whose slope and energy are within the range of floating-point numbers",
                );
            }
            energy.push(up_to_here);
            before = point;
        }
        Ok(Self {
            points: points.to_vec(),
            energy,
            unloading_stiffness: None,
        })
    }

    /// Sets the `stiffness` [N/m] of unloading.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] unless it is finite and not below the steepest piece of the
    /// curve: otherwise the contact would return more energy than it has absorbed.
    pub fn unloading_with(self, stiffness: f64) -> Result<Self, ImpulseError> {
        let steepest = self.pieces().map(|(_, slope)| slope).fold(0.0, f64::max);
        if stiffness.is_finite() && stiffness >= steepest {
            Ok(Self {
                unloading_stiffness: Some(stiffness),
                ..self
            })
        } else {
            Err(ImpulseError::NonPhysical {
                quantity: "unloading stiffness [N/m]",
                value: stiffness,
                expected: "a finite value not below the steepest slope of the loading curve",
            })
        }
    }

    /// Index of the first point of each piece, and the slope of the piece.
    fn pieces(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.points.windows(2).enumerate().map(|(index, piece)| {
            let slope = match piece {
                [(x0, y0), (x1, y1)] => (y1 - y0) / (x1 - x0),
                _ => 0.0,
            };
            (index, slope)
        })
    }

    /// Force and energy of the loading curve.
    #[allow(
        clippy::indexing_slicing,
        reason = "there are at least two points, each with its energy, and a piece begins before the last of them"
    )]
    fn loading(&self, delta: f64) -> (f64, f64) {
        let after = self.points.partition_point(|(x, _)| *x <= delta);
        let piece = after.clamp(1, self.points.len() - 1) - 1;
        let (x0, y0) = self.points[piece];
        let (x1, y1) = self.points[piece + 1];
        let way = delta - x0;
        let force = y0 + (y1 - y0) / (x1 - x0) * way;
        (force, self.energy[piece] + 0.5 * way * (y0 + force))
    }

    /// Returns the force at `delta` >= 0 after a deepest approach of `deepest`.
    pub(super) fn force(&self, deepest: f64, delta: f64) -> f64 {
        match self.unloading_stiffness {
            Some(stiffness) if delta < deepest => {
                (self.loading(deepest).0 - stiffness * (deepest - delta)).max(0.0)
            }
            _ => self.loading(delta).0,
        }
    }

    /// Returns the approach at which the force vanishes on unloading.
    pub(super) fn dent(&self, deepest: f64) -> f64 {
        self.unloading_stiffness.map_or(0.0, |stiffness| {
            deepest - self.loading(deepest).0 / stiffness
        })
    }

    /// Returns the energy from a fixed origin to `delta` >= 0 after a deepest approach of
    /// `deepest`.
    pub(super) fn energy(&self, deepest: f64, delta: f64) -> f64 {
        match self.unloading_stiffness {
            Some(stiffness) if delta < deepest => {
                let (force, energy) = self.loading(deepest);
                let left = (force - stiffness * (deepest - delta)).max(0.0);
                energy - 0.5 * (force * force - left * left) / stiffness
            }
            _ => self.loading(delta).1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> TabulatedContact {
        TabulatedContact::new(&[(0.0, 0.0), (1.0, 2.0), (3.0, 3.0)]).unwrap()
    }

    #[test]
    fn loading_follows_the_points_and_the_last_piece() {
        for (delta, force) in [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (2.0, 2.5), (5.0, 4.0)] {
            assert!((curve().force(0.0, delta) - force).abs() < 1e-14, "{delta}");
        }
    }

    #[test]
    fn unloading_leaves_a_dent() {
        let hysteretic = curve().unloading_with(2.0).unwrap();
        // unloading from (3, 3) with a slope of 2 reaches zero at 1.5
        for (delta, force) in [(3.0, 3.0), (2.5, 2.0), (1.5, 0.0), (0.7, 0.0)] {
            assert!(
                (hysteretic.force(3.0, delta) - force).abs() < 1e-14,
                "{delta}"
            );
        }
        // loading takes 1 + 5 J, unloading returns 9/4 J
        let lost = hysteretic.energy(0.0, 3.0)
            - (hysteretic.energy(3.0, 3.0) - hysteretic.energy(3.0, 0.0));
        assert!((lost - (6.0 - 2.25)).abs() < 1e-14);
    }

    #[test]
    fn curves_that_do_not_grow_are_refused() {
        let text = |points: &[(f64, f64)]| TabulatedContact::new(points).unwrap_err().to_string();
        assert_eq!(
            text(&[(0.0, 0.0), (1.0, 2.0), (2.0, 1.0)]),
            "point 2 of the contact law is (2 m, 1 N), expected approach and force above those of the previous point"
        );
        assert_eq!(
            text(&[(0.0, 1.0), (1.0, 2.0)]),
            "point 0 of the contact law is (0 m, 1 N), expected (0, 0) as the first point"
        );
        assert!(TabulatedContact::new(&[(0.0, 0.0), (f64::NAN, 2.0)]).is_err());
        assert!(curve().unloading_with(1.9).is_err());
    }
}
