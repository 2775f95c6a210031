//! Grid with one time step for all segments and a whole number of cells in each.

use crate::RodwaveError;
use crate::error::{check_positive, check_that};

/// Fewest cells of a segment: the interpolation at a gauge needs four.
const FEWEST_CELLS: f64 = 4.0;

/// Default of the largest relative change of a wave speed that is made to get whole numbers of
/// cells.
pub(super) const DEFAULT_SPEED_TOLERANCE: f64 = 1e-3;

/// Largest refinement of the grid, relative to the requested one, in the search for whole numbers
/// of cells.
const LARGEST_REFINEMENT: f64 = 64.0;

/// A time step and the numbers of cells of the segments.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Grid {
    /// Time step \[s\].
    pub time_step: f64,
    /// Number of cells of each segment.
    pub cells: Vec<usize>,
    /// Relative change of the wave speed of each segment that makes its transit time a whole number
    /// of steps.
    pub speed_change: Vec<f64>,
}

impl Grid {
    /// Largest magnitude of [`Self::speed_change`], the relative rounding of a transit time.
    #[must_use]
    pub fn largest_rounding(&self) -> f64 {
        let changes = self.speed_change.iter();
        changes.fold(0.0, |largest, change| largest.max(change.abs()))
    }

    /// Creates the grid for segments of these transit times \[s\], with a time step of at most
    /// `longest_step`.
    ///
    /// With a common step and Courant number 1 everywhere, segment k has T_k/dt cells, which in
    /// general is not a whole number. Rounding this number at an arbitrary step would be a
    /// first-order error. The search therefore finds the step with the least rounding between half
    /// the longest step and the longest step; two segments then have a second-order error, and
    /// commensurable ones none. If the best step exceeds the tolerance, finer steps are tried.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive and far below 2^52"
    )]
    pub(super) fn of(
        transit_times: &[f64],
        longest_step: f64,
        tolerance: f64,
    ) -> Result<Self, RodwaveError> {
        for (index, time) in transit_times.iter().enumerate() {
            check_positive("transit time of a segment [s]", *time)
                .map_err(|error| error.in_element(index))?;
        }
        let longest = transit_times.iter().copied().fold(0.0, f64::max);
        let shortest = transit_times.iter().copied().fold(f64::INFINITY, f64::min);
        let fewest = (longest / longest_step.min(shortest / FEWEST_CELLS)).ceil();
        // this also catches NaN quotients of transit times
        check_that(
            fewest * LARGEST_REFINEMENT <= 1e9,
            "number of cells of the longest segment",
            fewest,
            "at most 1e9/64; use a longer time step or avoid very short segments",
        )?;
        let misfit = |count: f64| -> f64 {
            let step = longest / count;
            transit_times
                .iter()
                .map(|time| ((time / step).round() * step / time - 1.0).abs())
                .fold(0.0, f64::max)
        };
        let mut best = (fewest, misfit(fewest));
        let mut count = fewest + 1.0;
        // commensurable times differ by rounding errors, which do not require a finer grid
        while best.1 > 1e-13
            && (count <= 2.0 * fewest || best.1 > tolerance && count <= LARGEST_REFINEMENT * fewest)
        {
            let error = misfit(count);
            if error < best.1 {
                best = (count, error);
            }
            count += 1.0;
        }
        let (count, error) = best;
        check_that(
            error <= tolerance,
            "relative change of a wave speed needed for whole numbers of cells",
            error,
            "at most the tolerance; use a shorter time step",
        )?;
        let time_step = longest / count;
        let cells: Vec<usize> = transit_times
            .iter()
            .map(|time| (time / time_step).round() as usize)
            .collect();
        let speed_change = transit_times
            .iter()
            .zip(&cells)
            .map(|(time, cells)| time / (*cells as f64 * time_step) - 1.0)
            .collect();
        Ok(Self {
            time_step,
            cells,
            speed_change,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commensurable_segments_are_not_changed() {
        let grid = Grid::of(&[30e-6, 50e-6, 20e-6], 1.01e-6, 1e-3).unwrap();
        assert_eq!(grid.cells, [30, 50, 20]);
        assert!(grid.speed_change.iter().all(|change| change.abs() < 1e-12));
    }

    #[test]
    fn two_segments_err_by_the_second_order_of_the_step() {
        // among n numbers of cells, the least rounding is of order 1/n of a step, and it is
        // distributed over n steps
        let times = [100e-6, 100e-6 / std::f64::consts::SQRT_2];
        for cells in [20.0, 80.0, 320.0] {
            let grid = Grid::of(&times, 100e-6 / cells, 1.0).unwrap();
            let worst = grid.speed_change[1].abs();
            assert!(worst < 2.0 / (cells * cells), "{cells}: {worst}");
            assert!(grid.time_step <= 100e-6 / cells && grid.time_step > 49e-6 / cells);
        }
    }

    #[test]
    fn a_short_segment_asks_for_a_short_step() {
        let grid = Grid::of(&[1e-3, 1.3e-6], 1e-5, 1e-3).unwrap();
        assert!(grid.cells[1] >= 4);
        assert!(grid.speed_change.iter().all(|change| change.abs() < 1e-3));
    }
}
