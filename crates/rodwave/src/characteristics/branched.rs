//! The direct problem of a rod whose material consists of several branches in parallel.
//!
//! ```text
//! σ = Σ σᵢ ,    ∂σᵢ/∂t = wᵢE (∂ε/∂t - Fᵢ(σᵢ)) ,    Σ wᵢ = 1
//! ```
//!
//! The waves travel as in [`super`], with σ the sum of the stresses of the branches. The shift
//! strains all branches equally, dσᵢ = wᵢ dσ, and so does not change the *excess* pᵢ = σᵢ - wᵢσ of
//! a branch at a node. Each branch relaxes by its own exact flow, and Σ pᵢ = 0. A spring does not
//! relax, and its excess is not stored.

mod lateral_inertia;

use super::by_sample::{Motion, by_samples, slopes_of};
use super::time_levels::TimeLevels;
use super::{FEWEST_CELLS, WavePair};
use crate::RodwaveError;
use crate::band_limited::{SamplePulses, VelocityHistory};
use crate::error::{check_cells, check_length, check_positive, check_samples};
use crate::inelastic::{
    InelasticLaw, LANES, RelaxationFlow, StressChange, check_parameters, lanes,
};
use crate::rod::InelasticRod;

/// A linear Maxwell branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearBranch {
    /// Share w of the modulus.
    pub share: f64,
    /// Relaxation time τ \[s\].
    pub time: f64,
}

/// Direct problem of a rod in which one branch obeys the law of the rod, in parallel with linear
/// Maxwell branches and, if the rod has one, with a [spring](InelasticRod::with_spring). The
/// modulus of the rod is the sum of the moduli of all branches.
///
/// ```
/// use rodwave::band_limited::SampledHistory;
/// use rodwave::characteristics::{BranchedProblem, LinearBranch};
/// use rodwave::{InelasticRod, inelastic::MaxwellNorton};
///
/// let rate = 204_800.0;
/// let excitation: Vec<f64> = (0..600)
///     .map(|k| 8.0 * (-((f64::from(k) / rate - 0.4e-3) / 80e-6).powi(2)).exp())
///     .collect();
/// // shares of the modulus: 0.5 for a spring, 0.1 for a Maxwell branch of 20 us, the rest for
/// // Norton's law
/// let rod = InelasticRod::new(0.394, 1140.0, 3e9, MaxwellNorton::new(2.1, 7e13)?)?.with_spring(0.5)?;
/// let fast = LinearBranch { share: 0.1, time: 20e-6 };
/// let times: Vec<f64> = (0..500).map(|k| f64::from(k) / rate).collect();
/// let response = BranchedProblem::new(rod, vec![fast], 100)?
///     .free_end_velocity(&SampledHistory::new(&excitation, rate)?, &times)?;
/// assert!(response.iter().copied().fold(0.0, f64::max) > 10.0);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BranchedProblem<L> {
    rod: InelasticRod<L>,
    linear: Vec<LinearBranch>,
    cells: usize,
}

/// A direction x in which the response of a [`BranchedProblem`] is differentiated.
#[derive(Debug, Clone, PartialEq)]
pub enum Direction {
    /// ln E at constant shares.
    LogModulus,
    /// Shares: dwᵢ/dx of each linear branch and, last, of the branch of the law. The share of the
    /// spring changes by the negative sum; without a spring the sum must be 0.
    Shares(Vec<f64>),
    /// Relaxation times: d ln τᵢ/dx of each linear branch.
    LogTimes(Vec<f64>),
    /// The parameter of the law with this index.
    Parameter(usize),
}

impl<L: InelasticLaw> BranchedProblem<L> {
    /// Cuts `rod` into `cells` equal cells, with `linear` branches in parallel with its law.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for fewer than 8 cells or more than 2^27, for a share or a
    /// time that is not above 0, and if no share is left for the law.
    pub fn new(
        rod: InelasticRod<L>,
        linear: Vec<LinearBranch>,
        cells: usize,
    ) -> Result<Self, RodwaveError> {
        check_cells(cells, FEWEST_CELLS, "from 8 to 2^27")?;
        for branch in &linear {
            check_positive("share of a linear branch in the modulus", branch.share)?;
            check_positive("relaxation time of a linear branch [s]", branch.time)?;
        }
        let problem = Self { rod, linear, cells };
        check_positive("share of the law's branch in the modulus", problem.of_law())?;
        check_positive("time step [s]", problem.time_step())?;
        Ok(problem)
    }

    /// Share of the branch of the law.
    fn of_law(&self) -> f64 {
        let linear: f64 = self.linear.iter().map(|branch| branch.share).sum();
        1.0 - self.rod.spring() - linear
    }

    /// Shares of the branches that relax; the branch of the law is the last.
    fn shares(&self) -> Vec<f64> {
        let linear = self.linear.iter().map(|branch| branch.share);
        linear.chain([self.of_law()]).collect()
    }

    /// Time step dt = L/(c N) \[s\].
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.rod.transit_time() / self.cells as f64
    }

    /// Computes v_r [m/s] at `times` \[s\] for the excitation v_e.
    ///
    /// # Errors
    /// The errors of [`DirectProblem::free_end_velocity`](super::DirectProblem::free_end_velocity).
    pub fn free_end_velocity(
        &self,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Vec<f64>, RodwaveError> {
        let levels = TimeLevels::of(excitation, times, self.time_step())?;
        let mut march = BranchedMarch::new(self, excitation.at(levels.time(0)), Vec::new());
        let mut history = Vec::with_capacity(levels.steps + 1);
        history.push(march.wave.free_end_velocity());
        for n in 1..=levels.steps {
            march.advance(excitation.at(levels.time(n)));
            history.push(march.wave.free_end_velocity());
        }
        let points = levels.interpolations(times);
        let velocity: Vec<f64> = points.iter().map(|point| point.value(&history)).collect();
        check_samples("velocity of the free end", &velocity)?;
        Ok(velocity)
    }

    /// Computes v_r and its derivatives dv_r/dx in `directions` at `times` \[s\] for the excitation
    /// v_e, with the tangent-linear model. The derivatives are in the order of the directions.
    ///
    /// # Errors
    /// The errors of [`Self::free_end_velocity`]; [`RodwaveError::LengthMismatch`] for a direction
    /// whose number of shares or times differs from that of the problem, for a parameter that the
    /// law does not have, and for a law with more than
    /// [`MAX_PARAMETERS`](crate::inelastic::MAX_PARAMETERS) parameters.
    pub fn free_end_velocity_with_sensitivities(
        &self,
        excitation: &dyn VelocityHistory,
        times: &[f64],
        directions: &[Direction],
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), RodwaveError> {
        check_parameters::<L>()?;
        let step = self.time_step();
        let levels = TimeLevels::of(excitation, times, step)?;
        let sources: Vec<Source> = directions
            .iter()
            .map(|direction| self.source(direction))
            .collect::<Result<_, _>>()?;
        let mut march = BranchedMarch::new(self, excitation.at(levels.time(0)), sources);
        let mut history = Vec::with_capacity(levels.steps + 1);
        let mut tangents = vec![Vec::with_capacity(levels.steps + 1); march.tangents.len()];
        for n in 0..=levels.steps {
            if n > 0 {
                let time = levels.time(n);
                let velocity_tangent = -0.5 * levels.since_begin(time) * excitation.slope(time);
                march.advance_with_tangents(excitation.at(time), velocity_tangent);
            }
            history.push(march.wave.free_end_velocity());
            for (history, tangent) in tangents.iter_mut().zip(&march.tangents) {
                history.push(tangent.wave.free_end_velocity());
            }
        }
        let points = levels.interpolations(times);
        let at_times = |history: &Vec<f64>| -> Vec<f64> {
            points.iter().map(|point| point.value(history)).collect()
        };
        let mut derivatives: Vec<Vec<f64>> = tangents.iter().map(at_times).collect();
        for (derivatives, direction) in derivatives.iter_mut().zip(directions) {
            if *direction == Direction::LogModulus {
                for ((derivative, time), point) in derivatives.iter_mut().zip(times).zip(&points) {
                    *derivative += 0.5 * levels.since_begin(*time) * point.slope(&history) / step;
                }
            }
        }
        let velocity = at_times(&history);
        check_samples("velocity of the free end", &velocity)?;
        Ok((velocity, derivatives))
    }

    /// Returns the coefficients of the tangent of a direction for each branch that relaxes.
    fn source(&self, direction: &Direction) -> Result<Source, RodwaveError> {
        let shares = self.shares();
        let mut source = Source {
            stiffening: 0.0,
            growth: vec![0.0; shares.len()],
            of_flow: vec![0.0; shares.len()],
            parameter: None,
        };
        match direction {
            // at constant dimensionless time, Z and E h are proportional to E^½ (h: time step)
            Direction::LogModulus => {
                source.stiffening = 0.5;
                source.of_flow.fill(0.5);
            }
            Direction::Shares(growth) => {
                check_length("changes of shares", growth.len(), shares.len())?;
                source.growth.clone_from(growth);
                // the flow of the law depends on the modulus of its branch
                let of_law = growth
                    .last()
                    .zip(shares.last())
                    .zip(source.of_flow.last_mut());
                if let Some(((growth, share), of_flow)) = of_law {
                    *of_flow = growth / share;
                }
            }
            Direction::LogTimes(changes) => {
                check_length(
                    "changes of relaxation times",
                    changes.len(),
                    self.linear.len(),
                )?;
                for (of_flow, change) in source.of_flow.iter_mut().zip(changes) {
                    *of_flow = *change;
                }
            }
            Direction::Parameter(index) => {
                let count = L::PARAMETERS.len();
                check_length(
                    "parameters of the law",
                    index.saturating_add(1).max(count),
                    count,
                )?;
                source.parameter = Some(*index);
            }
        }
        Ok(source)
    }

    /// Computes dv_r/dv_e at `times` \[s\] for the samples of `pulses`, along the motion that
    /// `excitation` drives. Each sample gives one column; for `least` [m/s] see
    /// [`DirectProblem`](super::DirectProblem::free_end_velocity_by_samples).
    ///
    /// # Errors
    /// The errors of [`Self::free_end_velocity`].
    pub fn free_end_velocity_by_samples(
        &self,
        excitation: &dyn VelocityHistory,
        pulses: &SamplePulses,
        times: &[f64],
        least: f64,
    ) -> Result<Vec<Vec<f64>>, RodwaveError> {
        let levels = TimeLevels::of_pulses(excitation, pulses, times, self.time_step())?;
        let motion = Motion {
            excitation,
            levels,
            nodes: self.cells + 1,
            shares: &self.shares(),
        };
        let mut march = BranchedMarch::new(self, excitation.at(levels.time(0)), Vec::new());
        by_samples(&motion, pulses, times, |velocity, slopes| {
            march.advance_with_slopes(velocity, slopes, least);
        })
    }
}

/// A linear branch during one step: Δσ = `loss` σ.
#[derive(Debug, Clone, Copy)]
struct LinearFlow {
    loss: f64,
    /// dΔσ/d ln τ divided by σ: twice the derivative with respect to ln E at constant dimensionless
    /// time.
    by_log_time: f64,
}

impl LinearFlow {
    fn over(duration: f64, time: f64) -> Self {
        let ratio = duration / time;
        Self {
            loss: (-ratio).exp_m1(),
            by_log_time: ratio * (-ratio).exp(),
        }
    }
}

/// Coefficients of the tangent of a [`Direction`]. Vectors have one entry per branch that relaxes;
/// the entry of the branch of the law is the last.
struct Source {
    /// Relative change of the impedance.
    stiffening: f64,
    /// Change of each share.
    growth: Vec<f64>,
    /// Change of each flow, in units of its derivative with respect to ln τ or ln E.
    of_flow: Vec<f64>,
    /// Parameter of the law.
    parameter: Option<usize>,
}

/// Values of one branch at all nodes, in blocks.
type Row = Vec<[f64; LANES]>;

/// A derivative of the state.
struct Tangent {
    source: Source,
    wave: WavePair,
    /// Derivative of the excess of each branch that relaxes.
    excess: Vec<Row>,
}

struct BranchedMarch<L: InelasticLaw> {
    wave: WavePair,
    excess: Vec<Row>,
    tangents: Vec<Tangent>,
    shares: Vec<f64>,
    /// Flows for half a step, used in the first step, and for a whole step.
    flows: [Flows<L::Flow>; 2],
    /// Changes of the stresses of the branches in one block, and their derivatives in one
    /// direction.
    changes: Vec<StressChange>,
    by: Row,
    impedance: f64,
    /// Nodes that a wave has reached; 0 before the first step.
    reached: usize,
}

/// Flows of the branches that relax, for one duration.
struct Flows<F> {
    linear: Vec<LinearFlow>,
    of_law: F,
}

impl<L: InelasticLaw> BranchedMarch<L> {
    fn new(problem: &BranchedProblem<L>, velocity: f64, sources: Vec<Source>) -> Self {
        let rod = &problem.rod;
        let (step, nodes) = (problem.time_step(), problem.cells + 1);
        let shares = problem.shares();
        let rows = || vec![vec![[0.0; LANES]; nodes.div_ceil(LANES)]; shares.len()];
        let tangents = sources.into_iter().map(|source| Tangent {
            source,
            wave: WavePair::at_rest(nodes),
            excess: rows(),
        });
        let mut march = Self {
            wave: WavePair::at_rest(nodes),
            excess: rows(),
            tangents: tangents.collect(),
            flows: [0.5 * step, step].map(|duration| Flows {
                linear: problem
                    .linear
                    .iter()
                    .map(|branch| LinearFlow::over(duration, branch.time))
                    .collect(),
                of_law: rod.law().flow(problem.of_law() * rod.modulus(), duration),
            }),
            changes: vec![StressChange::default(); shares.len()],
            by: vec![[0.0; LANES]; shares.len()],
            impedance: rod.specific_impedance(),
            reached: 0,
            shares,
        };
        march.wave.impose_velocity(velocity);
        march
    }

    /// Returns true if a step changes nothing; `moves` states whether the driven end moves at the
    /// end of the step.
    fn rests(&self, moves: bool) -> bool {
        self.reached == 0 && !moves && self.wave.is_at_rest()
    }

    fn advance(&mut self, velocity: f64) {
        if self.rests(velocity != 0.0) {
            return;
        }
        pulp::Arch::new().dispatch(Relax {
            march: self,
            slopes: None,
        });
        self.wave.shift(velocity);
    }

    /// Advances one time step and writes to `slopes`, for each branch and node, the derivative of
    /// the change of the branch's stress with respect to this stress.
    fn advance_with_slopes(&mut self, velocity: f64, slopes: &mut [Vec<f64>], least: f64) {
        let of_law = self.shares.last().copied().unwrap_or(1.0);
        let least = of_law * self.impedance * least;
        pulp::Arch::new().dispatch(Relax {
            march: self,
            slopes: Some((slopes, least)),
        });
        self.wave.shift(velocity);
    }

    fn advance_with_tangents(&mut self, velocity: f64, velocity_tangent: f64) {
        if self.rests(velocity != 0.0 || velocity_tangent != 0.0) {
            return;
        }
        pulp::Arch::new().dispatch(RelaxWithTangents(self));
        self.wave.shift(velocity);
        for tangent in &mut self.tangents {
            // the excitation in dimensionless time depends on E
            tangent
                .wave
                .shift(2.0 * tangent.source.stiffening * velocity_tangent);
        }
    }
}

/// One step of relaxation of the nodes that a wave has reached, as a task that can run with the
/// vector instructions of the processor.
struct Relax<'a, 's, L: InelasticLaw> {
    march: &'a mut BranchedMarch<L>,
    /// Slopes to be written, and the least stress \[Pa\] at which the slope of the law is
    /// evaluated.
    slopes: Option<(&'s mut [Vec<f64>], f64)>,
}

impl<L: InelasticLaw> pulp::NullaryFnOnce for Relax<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "shares, rows of the excess and rows of the slopes have one entry per branch, the last for the law, and rows have a block for each of the waves"
    )]
    fn call(self) {
        let BranchedMarch {
            wave,
            excess,
            shares,
            flows,
            impedance,
            reached,
            ..
        } = self.march;
        let Flows {
            linear,
            of_law: flow,
        } = &flows[usize::from(*reached > 0)];
        let nodes = wave.len();
        *reached = (*reached + 1).min(nodes);
        let (half, inverse) = (0.5 * *impedance, 1.0 / *impedance);
        let of_law = linear.len();
        let mut slopes = self.slopes;
        // tangents may move where the rod is at rest
        let count = if slopes.is_some() { nodes } else { *reached };
        let (right, left) = wave.blocks_mut(count);
        for (block, (right, left)) in right.iter_mut().zip(left).enumerate() {
            let (r, l) = (*right, *left);
            let stress = lanes!(|i| half * (r[i] + l[i]));
            let own = |branch: usize| {
                let (share, p) = (shares[branch], &excess[branch][block]);
                lanes!(|i| share * stress[i] + p[i])
            };
            let law = own(of_law);
            let mut total = if let Some((slopes, least)) = &mut slopes {
                let change = flow.change_with_sensitivity(&law, 0);
                slopes[of_law].as_chunks_mut::<LANES>().0[block] =
                    slopes_of(flow, &law, *least, &change.by_stress);
                change.stress
            } else {
                flow.change(&law)
            };
            let of_flow = total;
            for (branch, linear) in linear.iter().enumerate() {
                let stress = own(branch);
                total = lanes!(|i| total[i] + linear.loss * stress[i]);
                if let Some((slopes, _)) = &mut slopes {
                    slopes[branch].as_chunks_mut::<LANES>().0[block] = [linear.loss; LANES];
                }
            }
            for (branch, share) in shares.iter().enumerate() {
                let p = excess[branch][block];
                let change = match linear.get(branch) {
                    Some(linear) => {
                        lanes!(|i| linear.loss * (share * stress[i] + p[i]))
                    }
                    None => of_flow,
                };
                excess[branch][block] = lanes!(|i| p[i] + change[i] - share * total[i]);
            }
            *right = lanes!(|i| r[i] + inverse * total[i]);
            *left = lanes!(|i| l[i] + inverse * total[i]);
        }
    }
}

/// One step of relaxation with all tangents.
struct RelaxWithTangents<'a, L: InelasticLaw>(&'a mut BranchedMarch<L>);

impl<L: InelasticLaw> pulp::NullaryFnOnce for RelaxWithTangents<'_, L> {
    type Output = ();

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "as for `Relax`; tangents have as many nodes and branches as the waves"
    )]
    fn call(self) {
        let march = self.0;
        let (half, inverse) = (0.5 * march.impedance, 1.0 / march.impedance);
        let flows = &march.flows[usize::from(march.reached > 0)];
        march.reached = (march.reached + 1).min(march.wave.len());
        let of_law = flows.linear.len();
        let reached = march.reached;
        let shares = &march.shares;
        let (changes, by) = (&mut march.changes, &mut march.by);
        let (right, left) = march.wave.blocks_mut(reached);
        for (block, (right, left)) in right.iter_mut().zip(left).enumerate() {
            let (r, l) = (*right, *left);
            let stress = lanes!(|i| half * (r[i] + l[i]));
            let mut total = [0.0; LANES];
            for (branch, share) in shares.iter().enumerate() {
                let p = march.excess[branch][block];
                let own = lanes!(|i| share * stress[i] + p[i]);
                match flows.linear.get(branch) {
                    Some(linear) => {
                        let change = &mut changes[branch];
                        change.stress = lanes!(|i| linear.loss * own[i]);
                        change.by_stress = [linear.loss; LANES];
                        change.by_log_modulus = lanes!(|i| linear.by_log_time * own[i]);
                    }
                    None => {
                        changes[branch] = flows
                            .of_law
                            .change_with_sensitivity(&own, L::PARAMETERS.len());
                    }
                }
                let change = &changes[branch].stress;
                total = lanes!(|i| total[i] + change[i]);
            }
            for tangent in &mut march.tangents {
                let Tangent {
                    source,
                    wave,
                    excess,
                } = tangent;
                let (rights, lefts) = wave.blocks_mut(reached);
                let (dr, dl) = (rights[block], lefts[block]);
                let stiffening = source.stiffening;
                let moved = lanes!(|i| half * (dr[i] + dl[i]) + stiffening * stress[i]);
                let mut total_by = [0.0; LANES];
                for (branch, share) in shares.iter().enumerate() {
                    let (p, growth) = (&excess[branch][block], source.growth[branch]);
                    let change = &changes[branch];
                    let own = lanes!(|i| share * moved[i] + growth * stress[i] + p[i]);
                    let mut of_branch = lanes!(|i| change.by_stress[i] * own[i]);
                    let (factor, of_flow) = match source.parameter {
                        Some(of) if branch == of_law => (1.0, &change.by_parameter[of]),
                        _ => (source.of_flow[branch], &change.by_log_modulus),
                    };
                    of_branch = lanes!(|i| of_branch[i] + factor * of_flow[i]);
                    total_by = lanes!(|i| total_by[i] + of_branch[i]);
                    by[branch] = of_branch;
                }
                for (branch, share) in shares.iter().enumerate() {
                    let (p, growth, of_branch) =
                        (excess[branch][block], source.growth[branch], &by[branch]);
                    excess[branch][block] =
                        lanes!(|i| p[i] + of_branch[i] - share * total_by[i] - growth * total[i]);
                }
                let change = lanes!(|i| inverse * (total_by[i] - stiffening * total[i]));
                rights[block] = lanes!(|i| dr[i] + change[i]);
                lefts[block] = lanes!(|i| dl[i] + change[i]);
            }
            for (branch, share) in shares.iter().enumerate() {
                let (p, change) = (march.excess[branch][block], &changes[branch].stress);
                march.excess[branch][block] = lanes!(|i| p[i] + change[i] - share * total[i]);
            }
            *right = lanes!(|i| r[i] + inverse * total[i]);
            *left = lanes!(|i| l[i] + inverse * total[i]);
        }
    }
}

#[cfg(test)]
mod tests;
