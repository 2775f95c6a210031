//! State of one segment: travelling waves and stationary branches.
//!
//! Cell j has its centre at (j + ½) dx. Its waves R = s - v and L = s + v, s = σ/Z, travel one cell
//! per step; an end of the segment is half a cell from the nearest centre, and a wave reaches it
//! half a step later.
//!
//! The elastic part of a step strains all branches equally, dσᵢ = (Eᵢ/E) dσ. The *excess* pᵢ = σᵢ -
//! (Eᵢ/E) σ of a branch therefore does not change. The relaxation changes neither strain nor
//! velocity; each branch relaxes by its own exact flow. The energy per volume is ρv²/2 + σ²/(2E) +
//! Σ pᵢ²/(2Eᵢ), because Σ pᵢ = 0; the part of the waves is ρ(R² + L²)/4.
#![allow(
    clippy::indexing_slicing,
    reason = "there is one flow, modulus, fraction and row of `block`, `scratch` and every tangent per branch (rows of the excess too, or \
              none for a single branch); waves and rows of the excess have one value per cell; a block from `first` has `count` \
              cells left; a segment has four cells or more by its grid"
)]

use super::branch::{BranchFlow, Waves};
use super::segment::Segment;
use super::tangent::{BarTangent, Source};
use crate::inelastic::{LANES, StressChange, lanes};
use crate::sliding_window::SlidingWindow;

#[derive(Debug, Clone)]
pub(super) struct Bar {
    pub(super) right: SlidingWindow,
    pub(super) left: SlidingWindow,
    /// pᵢ of every cell, one row per branch; empty for a single branch, whose excess is zero
    pub(super) excess: Vec<Vec<f64>>,
    pub(super) tangents: Vec<BarTangent>,
    /// Eᵢ \[Pa\]
    moduli: Vec<f64>,
    /// Eᵢ/E
    pub(super) fractions: Vec<f64>,
    flows: Vec<Box<dyn BranchFlow>>,
    half_flows: Vec<Box<dyn BranchFlow>>,
    elastic: bool,
    pub(super) modulus: f64,
    /// Z = ρc
    pub(super) specific_impedance: f64,
    /// A Z
    pub(super) impedance: f64,
    /// A dx
    cell_volume: f64,
    density: f64,
    pub(super) cell_length: f64,
    /// One row per branch and one for their sum.
    scratch: Vec<Vec<f64>>,
    pub(super) block: Block,
}

/// Stress and change of every branch in one block of cells.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) stress: Vec<[f64; LANES]>,
    pub(super) change: Vec<StressChange>,
    /// Σ σᵢ
    pub(super) total: [f64; LANES],
    /// Sum of the changes of all branches.
    pub(super) total_change: [f64; LANES],
}

impl Bar {
    /// Creates the segment divided into `cells`, moving at `velocity`. Its wave speed is changed to
    /// exactly one cell per `step`.
    pub(super) fn new(segment: &Segment, cells: usize, step: f64, velocity: f64) -> Self {
        let cell_length = segment.length() / cells as f64;
        let wave_speed = cell_length / step;
        let modulus = segment.density() * wave_speed * wave_speed;
        let scale = modulus / segment.modulus();
        let branches = segment.branches();
        let moduli: Vec<f64> = branches.iter().map(|b| scale * b.modulus).collect();
        let flows = |duration: f64| -> Vec<Box<dyn BranchFlow>> {
            let each = branches.iter().zip(&moduli);
            each.map(|(b, modulus)| b.law.flow(*modulus, duration))
                .collect()
        };
        let flows_of_step = flows(step);
        let rows = if branches.len() > 1 {
            branches.len()
        } else {
            0
        };
        let specific_impedance = segment.density() * wave_speed;
        Self {
            right: SlidingWindow::filled(cells, -velocity),
            left: SlidingWindow::filled(cells, velocity),
            excess: vec![vec![0.0; cells]; rows],
            tangents: Vec::new(),
            fractions: moduli.iter().map(|e| e / modulus).collect(),
            elastic: flows_of_step.iter().all(|flow| flow.is_elastic()),
            half_flows: flows(0.5 * step),
            flows: flows_of_step,
            modulus,
            specific_impedance,
            impedance: segment.area() * specific_impedance,
            cell_volume: segment.area() * cell_length,
            density: segment.density(),
            cell_length,
            scratch: vec![vec![0.0; cells]; if rows > 0 { rows + 1 } else { 0 }],
            block: Block {
                stress: vec![[0.0; LANES]; branches.len()],
                change: vec![StressChange::default(); branches.len()],
                total: [0.0; LANES],
                total_change: [0.0; LANES],
            },
            moduli,
        }
    }

    pub(super) fn cells(&self) -> usize {
        self.right.len()
    }

    pub(super) fn is_elastic(&self) -> bool {
        self.elastic
    }

    /// Relaxes every cell over a whole step and returns the energy dissipated \[J\].
    pub(super) fn relax(&mut self) -> f64 {
        if self.elastic {
            return 0.0;
        }
        if !self.tangents.is_empty() {
            return pulp::Arch::new().dispatch(RelaxWithTangents(self));
        }
        let cells = self.cells();
        if let [flow] = &self.flows[..] {
            let waves = Waves {
                right: self.right.blocks_mut(cells),
                left: self.left.blocks_mut(cells),
                impedance: self.specific_impedance,
            };
            return 0.5 * self.cell_volume / self.modulus * flow.relax_waves(waves);
        }
        pulp::Arch::new().dispatch(RelaxBranches(self))
    }

    #[inline(always)]
    fn relax_branches(&mut self) -> f64 {
        let (right, left) = (self.right.as_mut_slice(), self.left.as_mut_slice());
        let half_impedance = 0.5 * self.specific_impedance;
        let mut dissipated = 0.0;
        let [sum, stresses @ ..] = &mut self.scratch[..] else {
            return 0.0; // without a branch there are no waves
        };
        sum.fill(0.0);
        for (branch, stress) in stresses.iter_mut().enumerate() {
            if self.flows[branch].is_elastic() {
                stress.fill(0.0);
                continue;
            }
            let fraction = self.fractions[branch] * half_impedance;
            let excess = &self.excess[branch];
            for (((stress, r), l), p) in stress.iter_mut().zip(&*right).zip(&*left).zip(excess) {
                *stress = p + fraction * (r + l);
            }
            dissipated += self.flows[branch].change(stress) / self.moduli[branch];
            for (sum, change) in sum.iter_mut().zip(&*stress) {
                *sum += change;
            }
        }
        for ((excess, change), fraction) in
            self.excess.iter_mut().zip(&*stresses).zip(&self.fractions)
        {
            for ((p, change), sum) in excess.iter_mut().zip(change).zip(&*sum) {
                *p += change - fraction * sum;
            }
        }
        let inverse = 1.0 / self.specific_impedance;
        for ((r, l), sum) in right.iter_mut().zip(left).zip(&*sum) {
            *r += sum * inverse;
            *l += sum * inverse;
        }
        0.5 * self.cell_volume * dissipated
    }

    #[inline(always)]
    fn relax_with_tangents(&mut self) -> f64 {
        let inverse = 1.0 / self.specific_impedance;
        let mut dissipated = 0.0;
        for first in (0..self.cells()).step_by(LANES) {
            let count = LANES.min(self.cells() - first);
            self.prepare_block(first, count, false);
            for index in 0..self.tangents.len() {
                self.relax_tangent(index, first, count);
            }
            let block = &self.block;
            for (branch, (stress, change)) in block.stress.iter().zip(&block.change).enumerate() {
                let loss: f64 = stress[..count]
                    .iter()
                    .zip(&change.stress)
                    .map(|(stress, change)| change * (2.0 * stress + change))
                    .sum();
                dissipated -= loss / self.moduli[branch];
                if let Some(excess) = self.excess.get_mut(branch) {
                    let fraction = self.fractions[branch];
                    for ((p, change), sum) in excess[first..first + count]
                        .iter_mut()
                        .zip(&change.stress)
                        .zip(&block.total_change)
                    {
                        *p += change - fraction * sum;
                    }
                }
            }
            let right = &mut self.right.as_mut_slice()[first..first + count];
            let left = &mut self.left.as_mut_slice()[first..first + count];
            for ((r, l), sum) in right.iter_mut().zip(left).zip(&block.total_change) {
                *r += sum * inverse;
                *l += sum * inverse;
            }
        }
        0.5 * self.cell_volume * dissipated
    }

    /// Loads stresses and changes of the branches in `count` cells from `first` into the block.
    #[inline(always)]
    pub(super) fn prepare_block(&mut self, first: usize, count: usize, half_step: bool) {
        let half_impedance = 0.5 * self.specific_impedance;
        let right = &self.right.as_slice()[first..first + count];
        let left = &self.left.as_slice()[first..first + count];
        let block = &mut self.block;
        block.total = [0.0; LANES];
        for ((total, r), l) in block.total.iter_mut().zip(right).zip(left) {
            *total = half_impedance * (r + l);
        }
        block.total_change = [0.0; LANES];
        let flows = if half_step {
            &self.half_flows
        } else {
            &self.flows
        };
        for (branch, flow) in flows.iter().enumerate() {
            let stress = &mut block.stress[branch];
            *stress = [0.0; LANES];
            for (stress, total) in stress.iter_mut().zip(&block.total) {
                *stress = self.fractions[branch] * total;
            }
            if let Some(excess) = self.excess.get(branch) {
                for (stress, p) in stress.iter_mut().zip(&excess[first..first + count]) {
                    *stress += p;
                }
            }
            block.change[branch] = flow.change_with_sensitivity(stress);
            for (total, change) in block
                .total_change
                .iter_mut()
                .zip(&block.change[branch].stress)
            {
                *total += change;
            }
        }
    }

    /// Relaxes the tangent `index` in the block: the derivatives of the waves and of the excess of
    /// the branches with respect to one parameter.
    #[inline(always)]
    fn relax_tangent(&mut self, index: usize, first: usize, count: usize) {
        let inverse = 1.0 / self.specific_impedance;
        let changes = self.tangent_changes(index, first, count);
        let tangent = &mut self.tangents[index];
        let growth = tangent.impedance_growth;
        let total_change = &self.block.total_change;
        let change = lanes!(|i| (changes.total[i] - growth * total_change[i]) * inverse);
        let right = &mut tangent.right.as_mut_slice()[first..first + count];
        let left = &mut tangent.left.as_mut_slice()[first..first + count];
        for ((r, l), change) in right.iter_mut().zip(left).zip(change) {
            *r += change;
            *l += change;
        }
        for (branch, excess) in tangent.excess.iter_mut().enumerate() {
            let (fraction, growth) = (self.fractions[branch], tangent.fraction_growth[branch]);
            let branch_change = &tangent.branch_change[branch];
            let change = lanes!(|i| branch_change[i]
                - fraction * changes.total[i]
                - growth * total_change[i]);
            for (excess, change) in excess[first..first + count].iter_mut().zip(change) {
                *excess += change;
            }
        }
    }

    /// Computes the derivatives of σ before the change and of the change of σ with respect to one
    /// parameter, for the current block.
    #[inline(always)]
    pub(super) fn tangent_changes(
        &mut self,
        index: usize,
        first: usize,
        count: usize,
    ) -> TangentChanges {
        let block = &self.block;
        let tangent = &mut self.tangents[index];
        let half_impedance = 0.5 * self.specific_impedance;
        let mut result = TangentChanges {
            stress: [0.0; LANES],
            total: [0.0; LANES],
        };
        let right = &tangent.right.as_slice()[first..first + count];
        let left = &tangent.left.as_slice()[first..first + count];
        let growth = tangent.impedance_growth;
        let sums = result.stress.iter_mut().zip(&block.total);
        for (((stress, total), r), l) in sums.zip(right).zip(left) {
            *stress = half_impedance * (r + l) + growth * total;
        }
        for (branch, change) in block.change.iter().enumerate() {
            let (fraction, growth) = (self.fractions[branch], tangent.fraction_growth[branch]);
            let mut by = lanes!(|i| fraction * result.stress[i] + growth * block.total[i]);
            if let Some(excess) = tangent.excess.get(branch) {
                for (by, p) in by.iter_mut().zip(&excess[first..first + count]) {
                    *by += p;
                }
            }
            by = lanes!(|i| change.by_stress[i] * by[i]);
            let source = match tangent.source {
                Source::LogModulus(of) if of == branch => Some(&change.by_log_modulus),
                Source::Parameter(of, parameter) if of == branch => {
                    Some(&change.by_parameter[parameter])
                }
                _ => None,
            };
            if let Some(source) = source {
                by = lanes!(|i| by[i] + source[i]);
            }
            tangent.branch_change[branch] = by;
            result.total = lanes!(|i| result.total[i] + by[i]);
        }
        result
    }

    /// Adds half of the effect that a change of the wave speed has on the tangents in one step: -½
    /// c dt ∂R/∂x and +½ c dt ∂L/∂x per relative change of the modulus.
    pub(super) fn drag_tangents(&mut self) {
        for tangent in &mut self.tangents {
            let quarter = 0.5 * tangent.impedance_growth;
            if quarter != 0.0 {
                add_slope(
                    tangent.right.as_mut_slice(),
                    self.right.as_slice(),
                    -quarter,
                );
                add_slope(tangent.left.as_mut_slice(), self.left.as_slice(), quarter);
            }
        }
    }

    /// Kinetic and elastic energy \[J\].
    pub(super) fn energy(&self) -> f64 {
        let squares = |values: &[f64]| -> f64 { values.iter().map(|x| x * x).sum() };
        let waves = squares(self.right.as_slice()) + squares(self.left.as_slice());
        let excess: f64 = self
            .excess
            .iter()
            .zip(&self.moduli)
            .map(|(row, modulus)| squares(row) / modulus)
            .sum();
        self.cell_volume * (0.25 * self.density * waves + 0.5 * excess)
    }

    /// Momentum along x [N s].
    pub(super) fn momentum(&self) -> f64 {
        let sum = |values: &[f64]| -> f64 { values.iter().sum() };
        let velocities = 0.5 * (sum(self.left.as_slice()) - sum(self.right.as_slice()));
        self.density * self.cell_volume * velocities
    }
}

/// [`Bar::relax_branches`] as a task that can run with the vector instructions of the processor.
struct RelaxBranches<'a>(&'a mut Bar);

impl pulp::NullaryFnOnce for RelaxBranches<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        self.0.relax_branches()
    }
}

/// [`Bar::relax_with_tangents`] as a task that can run with the vector instructions of the
/// processor.
struct RelaxWithTangents<'a>(&'a mut Bar);

impl pulp::NullaryFnOnce for RelaxWithTangents<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        self.0.relax_with_tangents()
    }
}

/// Derivatives of σ and of its change with respect to one parameter.
pub(super) struct TangentChanges {
    pub(super) stress: [f64; LANES],
    pub(super) total: [f64; LANES],
}

/// Adds `factor` dx ∂u/∂x, computed by second-order differences.
fn add_slope(target: &mut [f64], u: &[f64], factor: f64) {
    let last = u.len() - 1;
    let half = 0.5 * factor;
    for (target, around) in target[1..last].iter_mut().zip(u.windows(3)) {
        *target += half * (around[2] - around[0]);
    }
    target[0] += half * (4.0 * u[1] - 3.0 * u[0] - u[2]);
    target[last] += half * (3.0 * u[last] - 4.0 * u[last - 1] + u[last - 2]);
}
