//! March of a rod with lateral inertia.
//!
//! Love's theory adds the kinetic energy of the lateral motion, ρr²(∂v/∂x)²/2 per volume, with r =
//! νk_p, Poisson's ratio ν and the polar radius of gyration k_p of the section:
//!
//! ```text
//! (1 - r² ∂²/∂x²) ρ ∂v/∂t = ∂σ/∂x ,    ∂σᵢ/∂t = wᵢE (∂v/∂x - Fᵢ(σᵢ)) ,    σ = Σ σᵢ
//! ```
//!
//! Waves are then dispersive, and there are no characteristics. Velocities at the nodes and
//! stresses in the cells between them are advanced in turn (leapfrog), with the step dt = dx/c, at
//! which the scheme is exact for an elastic rod without lateral inertia. With lateral inertia, each
//! step solves a tridiagonal system for the accelerations. Each cell is strained by half a step,
//! relaxed over a whole one with the exact flow of its branches, and strained by the other half.
//! The scheme is of second order.

use super::BranchedProblem;
use crate::band_limited::VelocityHistory;
use crate::characteristics::time_levels::TimeLevels;
use crate::error::{RodwaveError, check_not_negative, check_samples};
use crate::inelastic::{InelasticLaw, LANES, RelaxationFlow, lanes};
use crate::interpolation::Quintic;

impl<L: InelasticLaw> BranchedProblem<L> {
    /// Computes v_r [m/s] at `times` \[s\] for the excitation v_e, with lateral inertia r² =
    /// `lateral_inertia` \[m²\]: ν²D²/8 for a round rod.
    ///
    /// # Errors
    /// The errors of [`Self::free_end_velocity`]; [`RodwaveError::NonPhysical`] for a negative
    /// lateral inertia.
    pub fn free_end_velocity_with_lateral_inertia(
        &self,
        lateral_inertia: f64,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Vec<f64>, RodwaveError> {
        check_not_negative("lateral inertia [m^2]", lateral_inertia)?;
        let step = self.time_step();
        let levels = TimeLevels::of(excitation, times, step)?;
        let mut march = ThickMarch::new(self, lateral_inertia);
        // entry n is the velocity half a step before level n
        let mut history = Vec::with_capacity(levels.steps + 2);
        history.push(0.0);
        for n in 0..=levels.steps {
            march.advance(excitation.at(levels.time(n) + 0.5 * step));
            history.push(march.free_end_velocity());
        }
        let position = |time: f64| levels.since_begin(time) / step + 0.5;
        let at = |time: &f64| Quintic::around(position(*time)).value(&history);
        let velocity: Vec<f64> = times.iter().map(at).collect();
        check_samples("velocity of the free end", &velocity)?;
        Ok(velocity)
    }
}

/// Velocities at the nodes and stresses in the cells, as σ/(ρc).
struct ThickMarch<F> {
    system: MassMatrix,
    /// Velocity of the driven end [m/s].
    driven: f64,
    /// Velocities of the other nodes [m/s].
    velocity: Vec<f64>,
    /// Right-hand side and solution of the tridiagonal system.
    change: Vec<f64>,
    /// Rise of the velocity over each cell [m/s].
    rise: Vec<[f64; LANES]>,
    /// Sum of the stresses of all branches.
    stress: Vec<[f64; LANES]>,
    /// Share of the spring in the modulus.
    spring: f64,
    /// Share of each linear branch, and the fraction of its stress that remains after one step.
    linear: Vec<(f64, f64)>,
    /// Stress of each branch that relaxes; the branch of the law is the last.
    branches: Vec<Vec<[f64; LANES]>>,
    /// Stress of the spring.
    of_spring: Vec<[f64; LANES]>,
    of_law: f64,
    flow: F,
    impedance: f64,
}

impl<F: RelaxationFlow> ThickMarch<F> {
    fn new<L: InelasticLaw<Flow = F>>(problem: &BranchedProblem<L>, lateral_inertia: f64) -> Self {
        let rod = &problem.rod;
        let (cells, step) = (problem.cells, problem.time_step());
        let blocks = vec![[0.0; LANES]; cells.div_ceil(LANES)];
        let spacing = rod.length() / cells as f64;
        let of_law = problem.of_law();
        let linear = problem.linear.iter();
        Self {
            system: MassMatrix::new(cells, lateral_inertia / (spacing * spacing)),
            driven: 0.0,
            velocity: vec![0.0; cells],
            change: vec![0.0; cells],
            rise: blocks.clone(),
            stress: blocks.clone(),
            spring: rod.spring(),
            linear: linear
                .map(|branch| (branch.share, (-step / branch.time).exp()))
                .collect(),
            branches: vec![blocks.clone(); problem.linear.len() + 1],
            of_spring: blocks,
            of_law,
            flow: rod.law().flow(of_law * rod.modulus(), step),
            impedance: rod.specific_impedance(),
        }
    }

    fn free_end_velocity(&self) -> f64 {
        self.velocity.last().copied().unwrap_or(0.0)
    }

    /// Advances one step; `driven` [m/s] is the velocity at x = -L in the middle of the step.
    fn advance(&mut self, driven: f64) {
        let stress = self.stress.as_flattened();
        let after = stress.iter().skip(1).take(self.change.len() - 1);
        let pairs = stress.iter().zip(after.chain([&0.0]));
        for (change, (own, next)) in self.change.iter_mut().zip(pairs) {
            *change = next - own;
        }
        self.system.solve(driven - self.driven, &mut self.change);
        self.driven = driven;
        for (velocity, change) in self.velocity.iter_mut().zip(&self.change) {
            *velocity += change;
        }
        let before = std::iter::once(&driven).chain(&self.velocity);
        let rises = self.rise.as_flattened_mut().iter_mut();
        for ((rise, v), before) in rises.zip(&self.velocity).zip(before) {
            *rise = v - before;
        }
        pulp::Arch::new().dispatch(StrainAndRelax(self));
    }
}

/// Strains and relaxes all cells with the vector instructions of the processor. Without these
/// instructions, the results are the same to the last digit.
struct StrainAndRelax<'a, F>(&'a mut ThickMarch<F>);

impl<F: RelaxationFlow> pulp::NullaryFnOnce for StrainAndRelax<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let march = self.0;
        let total = march.of_spring.iter_mut().zip(&mut march.stress);
        for ((spring, total), rise) in total.zip(&march.rise) {
            *spring = lanes!(|i| spring[i] + march.spring * rise[i]);
            *total = *spring;
        }
        let Some((of_law, linear)) = march.branches.split_last_mut() else {
            return;
        };
        for (branch, (share, remaining)) in linear.iter_mut().zip(&march.linear) {
            let half = 0.5 * share;
            let cells = branch.iter_mut().zip(&mut march.stress).zip(&march.rise);
            for ((own, total), rise) in cells {
                *own = lanes!(|i| (own[i] + half * rise[i]) * remaining + half * rise[i]);
                *total = lanes!(|i| total[i] + own[i]);
            }
        }
        let (half, impedance) = (0.5 * march.of_law, march.impedance);
        let inverse = impedance.recip();
        let cells = of_law.iter_mut().zip(&mut march.stress).zip(&march.rise);
        for ((own, total), rise) in cells {
            let strained = lanes!(|i| impedance * (own[i] + half * rise[i]));
            let change = march.flow.change(&strained);
            *own = lanes!(|i| inverse * (strained[i] + change[i]) + half * rise[i]);
            *total = lanes!(|i| total[i] + own[i]);
        }
    }
}

/// Mass matrix of the nodes after the driven one, divided by ρdx: 1 - r²δ²/dx², with half a cell at
/// the free end. It is symmetric and tridiagonal, and factorised once.
struct MassMatrix {
    /// r²/dx², the coupling of neighbouring nodes.
    coupling: f64,
    /// Reciprocal of each pivot.
    inverse: Vec<f64>,
}

impl MassMatrix {
    fn new(nodes: usize, coupling: f64) -> Self {
        let mut inverse: Vec<f64> = Vec::with_capacity(nodes);
        for node in 0..nodes {
            let own = if node + 1 == nodes {
                0.5 + coupling
            } else {
                1.0 + 2.0 * coupling
            };
            let before = inverse.last().copied().unwrap_or(0.0);
            inverse.push((own - coupling * coupling * before).recip());
        }
        Self { coupling, inverse }
    }

    /// Replaces the right-hand side by the changes of velocity, for the change `driven` of the
    /// driven node.
    fn solve(&self, driven: f64, changes: &mut [f64]) {
        let mut before = driven;
        for (change, inverse) in changes.iter_mut().zip(&self.inverse) {
            *change = (*change + self.coupling * before) * inverse;
            before = *change;
        }
        let mut after = 0.0;
        for (change, inverse) in changes.iter_mut().zip(&self.inverse).rev() {
            *change += self.coupling * inverse * after;
            after = *change;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InelasticRod;
    use crate::band_limited::SampledHistory;
    use crate::inelastic::MaxwellNorton;

    /// Compares the leapfrog without lateral inertia with the characteristics.
    #[test]
    fn a_thin_rod_is_that_of_the_characteristics() {
        let rate = 102_400.0;
        let excitation: Vec<f64> = (0..300)
            .map(|k| 8.0 * (-((f64::from(k) - 60.0) / 9.0).powi(2)).exp())
            .collect();
        let history = SampledHistory::new(&excitation, rate).unwrap();
        let times: Vec<f64> = (0..280).map(|k| f64::from(k) / rate).collect();
        let law = MaxwellNorton::from_reference_rate(2.1, 30.0, 10e6).unwrap();
        let rod = InelasticRod::new(0.3, 1140.0, 3e9, law)
            .and_then(|rod| rod.with_spring(0.3))
            .unwrap();
        let fast = crate::characteristics::LinearBranch {
            share: 0.2,
            time: 30e-6,
        };
        let problem = BranchedProblem::new(rod, vec![fast], 400).unwrap();
        let thin = problem.free_end_velocity(&history, &times).unwrap();
        let found = problem
            .free_end_velocity_with_lateral_inertia(0.0, &history, &times)
            .unwrap();
        let pairs = thin.iter().zip(&found);
        let apart = pairs.fold(0.0, |top, (a, b)| f64::max(top, (a - b).abs()));
        // tolerance: both methods are of second order, with errors of about 1e-4 of the velocity at
        // 400 cells
        assert!(apart < 2e-3, "{apart}");
    }
}
