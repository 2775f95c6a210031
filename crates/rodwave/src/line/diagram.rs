//! Velocity, stress and strain of a whole line as functions of position and time: the x-t diagram.

use super::bar::Bar;
use super::cell_strains::CellStrains;
use super::grid::Grid;
use super::ledger::Ledger;
use super::march::March;
use crate::RodwaveError;
use crate::error::check_that;
use crate::inelastic::LANES;

/// Largest number of values of one quantity, which then takes a gigabyte.
const MOST_VALUES: usize = 1 << 27;

/// Histories of every cell of a [`Line`](super::Line).
///
/// | field | shape |
/// |---|---|
/// | `positions`, `bodies` | `(n_cells)` |
/// | `times` | `(n_times)` |
/// | `velocity`, `stress`, `strain` | `(n_times, n_cells)`, one time after the other |
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Diagram {
    /// The grid, with its time step dt.
    pub grid: Grid,
    /// Centre of each cell \[m\] from the left end, in the initial position of the line with its
    /// gaps.
    pub positions: Vec<f64>,
    /// Index of the body of each cell, from 0 at the left.
    pub bodies: Vec<usize>,
    /// Times \[s\].
    pub times: Vec<f64>,
    /// Particle velocity [m/s].
    pub velocity: Vec<f64>,
    /// Stress \[Pa\], positive in tension.
    pub stress: Vec<f64>,
    /// Strain since the start, positive in tension.
    pub strain: Vec<f64>,
    /// Energy and momentum at the end.
    pub ledger: Ledger,
}

impl Diagram {
    /// Returns the part of `quantity` (velocity, stress or strain) at time `index`; empty if there
    /// is no such time.
    #[must_use]
    pub fn at<'a>(&self, quantity: &'a [f64], index: usize) -> &'a [f64] {
        let n_cells = self.positions.len();
        let first = index.saturating_mul(n_cells);
        quantity
            .get(first..first.saturating_add(n_cells))
            .unwrap_or(&[])
    }

    /// Runs `march` until `duration` and records every `stride`-th time level.
    pub(super) fn record(
        mut march: March,
        places: Vec<(usize, f64)>,
        duration: f64,
        stride: usize,
    ) -> Result<Self, RodwaveError> {
        let steps = march.steps_of(duration)?;
        check_that(
            stride > 0,
            "stride of the diagram [steps]",
            0.0,
            "at least 1",
        )?;
        let n_times = steps / stride + 1;
        let values = n_times.saturating_mul(places.len());
        check_that(
            values <= MOST_VALUES,
            "number of values in a diagram",
            values as f64,
            "at most 2^27; use a longer stride or step",
        )?;
        let (bodies, positions) = places.into_iter().unzip();
        let empty = || Vec::with_capacity(values);
        let mut diagram = Self {
            grid: march.grid().clone(),
            positions,
            bodies,
            times: Vec::with_capacity(n_times),
            velocity: empty(),
            stress: empty(),
            strain: empty(),
            ledger: march.ledger(),
        };
        march.watch_cells();
        diagram.push(&mut march);
        for step in 1..=steps {
            march.advance()?;
            if step % stride == 0 {
                diagram.push(&mut march);
            }
        }
        diagram.ledger = march.finite_ledger()?;
        Ok(diagram)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "the strains are those of the cells before, and the stresses have been lengthened by the cells of this bar"
    )]
    fn push(&mut self, march: &mut March) {
        self.times.push(march.time());
        for (bar, strain) in march.cells_mut() {
            bar.read_cells(&mut self.velocity, &mut self.stress);
            match strain {
                CellStrains::OfStress => {
                    let read = &self.stress[self.strain.len()..];
                    self.strain.extend(read.iter().map(|s| s / bar.modulus));
                }
                CellStrains::Own(strains) => self.strain.extend_from_slice(strains),
            }
        }
    }
}

impl Bar {
    /// Appends velocity and stress of every cell, including the half relaxation that ends the step.
    fn read_cells(&mut self, velocity: &mut Vec<f64>, stress: &mut Vec<f64>) {
        let waves = self.right.as_slice().iter().zip(self.left.as_slice());
        velocity.extend(waves.clone().map(|(r, l)| 0.5 * (l - r)));
        if self.is_elastic() {
            let half_impedance = 0.5 * self.specific_impedance;
            stress.extend(waves.map(|(r, l)| half_impedance * (r + l)));
            return;
        }
        for first in (0..self.cells()).step_by(LANES) {
            let count = LANES.min(self.cells() - first);
            self.prepare_block(first, count, true);
            let sums = self.block.total.iter().zip(&self.block.total_change);
            stress.extend(sums.take(count).map(|(total, change)| total + change));
        }
    }
}
