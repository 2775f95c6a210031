//! Sections at which a line is observed.

use super::bar::Bar;
use crate::inelastic::LANES;

/// Section of a body, stated by its distance from the left end of that body.
///
/// The values between the centres of cells are interpolated by a cubic. The interpolation rings for
/// some cells around a jump, and it extrapolates within half a cell of an end of a segment. For
/// values at the ends of a line, prefer [`LineHistory::ends`](super::LineHistory::ends), which are
/// exact there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gauge {
    /// Index of the body, from 0 at the left.
    pub body: usize,
    /// Distance from the left end of the body \[m\].
    pub position: f64,
}

/// Values at a gauge.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Particle velocity [m/s].
    pub velocity: f64,
    /// Stress \[Pa\], positive in tension.
    pub stress: f64,
    /// Strain since the start, positive in tension.
    pub strain: f64,
}

/// Number of cells in the cubic interpolation in space.
const STENCIL: usize = 4;

#[derive(Debug, Clone)]
pub(super) struct GaugeState {
    pub(super) segment: usize,
    first: usize,
    weights: [f64; STENCIL],
    strain: [f64; STENCIL],
    strain_tangents: Vec<[f64; STENCIL]>,
    pub(super) reading: Reading,
    pub(super) by_parameter: Vec<Reading>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "`first` leaves `STENCIL` cells of the bar, which has at least that many; a bar has a tangent for each parameter, and \
              `STENCIL` is below `LANES`"
)]
impl GaugeState {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positions inside the segment, cell counts far below 2^52"
    )]
    pub(super) fn new(bar: &Bar, segment: usize, distance: f64, tangents: usize) -> Self {
        // centres of cells are at (j + 1/2) dx
        let position = distance / bar.cell_length - 0.5;
        let last = (bar.cells() - STENCIL) as f64;
        let first = (position.floor() - 1.0).clamp(0.0, last);
        let u = position - first;
        let weights = std::array::from_fn(|i| {
            let others = (0..STENCIL).filter(|j| *j != i);
            others
                .map(|j| (u - j as f64) / (i as f64 - j as f64))
                .product()
        });
        Self {
            segment,
            first: first as usize,
            weights,
            strain: [0.0; STENCIL],
            strain_tangents: vec![[0.0; STENCIL]; tangents],
            reading: Reading::default(),
            by_parameter: vec![Reading::default(); tangents],
        }
    }

    /// Subtracts the stress before the elastic part of a step; only this part changes the strain,
    /// by dσ/E.
    pub(super) fn before_shift(&mut self, bar: &Bar) {
        self.add_stress(bar, -1.0);
    }

    /// Adds the stress after the elastic part of a step.
    pub(super) fn after_shift(&mut self, bar: &Bar) {
        self.add_stress(bar, 1.0);
    }

    fn add_stress(&mut self, bar: &Bar, sign: f64) {
        let cells = self.first..self.first + STENCIL;
        let factor = 0.5 * sign * bar.specific_impedance / bar.modulus;
        let (right, left) = (
            &bar.right.as_slice()[cells.clone()],
            &bar.left.as_slice()[cells.clone()],
        );
        for ((strain, r), l) in self.strain.iter_mut().zip(right).zip(left) {
            *strain += factor * (r + l);
        }
        for (strains, tangent) in self.strain_tangents.iter_mut().zip(&bar.tangents) {
            let by_right = &tangent.right.as_slice()[cells.clone()];
            let by_left = &tangent.left.as_slice()[cells.clone()];
            // d(Z/E)/(Z/E) = -½ d ln E = -d ln Z
            let growth = -tangent.impedance_growth;
            for (lane, strain) in strains.iter_mut().enumerate() {
                *strain +=
                    factor * (by_right[lane] + by_left[lane] + growth * (right[lane] + left[lane]));
            }
        }
    }

    /// Returns the values in the present state, including the half relaxation that ends the step.
    pub(super) fn read(&mut self, bar: &mut Bar) {
        bar.prepare_block(self.first, STENCIL, true);
        let interpolate = |values: &[f64]| -> f64 {
            values
                .iter()
                .zip(&self.weights)
                .map(|(value, weight)| value * weight)
                .sum()
        };
        let cells = self.first..self.first + STENCIL;
        let velocity = |right: &[f64], left: &[f64]| {
            0.5 * (interpolate(&left[cells.clone()]) - interpolate(&right[cells.clone()]))
        };
        let sum = |a: &[f64; LANES], b: &[f64; LANES]| -> [f64; STENCIL] {
            std::array::from_fn(|lane| a[lane] + b[lane])
        };
        self.reading = Reading {
            velocity: velocity(bar.right.as_slice(), bar.left.as_slice()),
            stress: interpolate(&sum(&bar.block.total, &bar.block.total_change)),
            strain: interpolate(&self.strain),
        };
        for (index, (reading, strain)) in self
            .by_parameter
            .iter_mut()
            .zip(&self.strain_tangents)
            .enumerate()
        {
            let changes = bar.tangent_changes(index, self.first, STENCIL);
            let tangent = &bar.tangents[index];
            *reading = Reading {
                velocity: velocity(tangent.right.as_slice(), tangent.left.as_slice()),
                stress: interpolate(&sum(&changes.stress, &changes.total)),
                strain: interpolate(strain),
            };
        }
    }
}
