//! The direct problem of paper D by the method of characteristics.
//!
//! Given E, F(σ) and the velocity v_e(t) at x = -L, find the velocity v_r(t) of the free end x = 0
//! (Ödeen 1993, paper D, eqs. 1-8). The paper used a "finite system method" that no public text
//! describes; this module solves the same equations as follows.
//!
//! # Method
//! With Z = ρc and s = σ/Z, the combinations R = s - v and L = s + v travel right and left at speed
//! c and both change at the rate -(E/Z) F(Z s). On a grid with dx = c dt the propagation is an
//! exact shift by one node (Courant number 1). The source is split off symmetrically (Strang): half
//! a step of relaxation, the shift, half a step of relaxation, each with the exact flow of the law.
//! The two halves between consecutive shifts are one whole flow, so that each cell relaxes once per
//! step. The scheme is second order for smooth histories, exact for F = 0, stable for any F, and
//! cannot create energy: the shift conserves Σ(R² + L²) and the flow can only reduce |s|. After a
//! jump the error is first order.
//!
//! # Sensitivities
//! The tangent-linear model is integrated in the same sweep. It is written in the dimensionless
//! time t c/L since the start of the excitation, so that the grid does not depend on E; the
//! derivative at constant time adds (t/2) ∂v/∂t at the end.
//!
//! Theory: `docs/theory/direct-problem.md`.

mod branched;
mod by_sample;
mod time_levels;

pub use branched::{BranchedProblem, Direction, LinearBranch};

use crate::band_limited::VelocityHistory;
use crate::error::{RodwaveError, check_cells, check_positive, check_samples, check_that};
use crate::inelastic::{
    InelasticLaw, LANES, MAX_PARAMETERS, RelaxationFlow, StressChange, check_parameters, lanes,
};
use crate::rod::InelasticRod;
use crate::sliding_window::SlidingWindow;
use time_levels::TimeLevels;

/// Name of this solver in the provenance of virtual records.
pub const GENERATOR: &str = "rodwave::characteristics";

/// Fewest cells of a grid. The time interpolation uses three steps after the last requested time;
/// the waves that enter in these steps must not have reached the free end.
const FEWEST_CELLS: usize = 8;

/// Direct problem of a rod cut into equal cells, between the section of excitation, x = -L, and its
/// free end, x = 0.
///
/// ```
/// use rodwave::band_limited::SampledHistory;
/// use rodwave::inelastic::MaxwellNorton;
/// use rodwave::{DirectProblem, InelasticRod};
///
/// let rate = 51_200.0;
/// let excitation: Vec<f64> = (0..150)
///     .map(|k| 8.0 * (-((f64::from(k) / rate - 0.4e-3) / 80e-6).powi(2)).exp())
///     .collect();
/// let rod = InelasticRod::new(0.394, 910.0, 2.58e9, MaxwellNorton::new(2.108, 7e13)?)?;
/// let times: Vec<f64> = (0..120).map(|k| f64::from(k) / rate).collect();
/// let response = DirectProblem::new(rod, 200)?
///     .free_end_velocity(&SampledHistory::new(&excitation, rate)?, &times)?;
/// // the free end doubles the incident velocity, which dissipation by the law has reduced
/// let peak = response.iter().copied().fold(0.0, f64::max);
/// assert!(peak > 10.0 && peak < 16.0);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DirectProblem<L> {
    rod: InelasticRod<L>,
    cells: usize,
}

/// Velocity of the free end with its derivatives with respect to the modulus and the parameters of
/// the law, all at the same times.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Response {
    /// v_r [m/s], one entry for each time.
    pub velocity: Vec<f64>,
    /// dv_r/d ln E [m/s].
    pub by_log_modulus: Vec<f64>,
    /// dv_r/dp [m/s] for each parameter p of the law, in the order of
    /// [`InelasticLaw::PARAMETERS`].
    pub by_parameter: Vec<Vec<f64>>,
}

impl<L: InelasticLaw> DirectProblem<L> {
    /// Cuts `rod` into `cells` equal cells.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for fewer than 8 cells or more than 2^27, and for a rod with a
    /// [spring](InelasticRod::with_spring).
    pub fn new(rod: InelasticRod<L>, cells: usize) -> Result<Self, RodwaveError> {
        check_cells(cells, FEWEST_CELLS, "from 8 to 2^27")?;
        check_that(
            rod.spring() <= 0.0,
            "share of a spring in the modulus",
            rod.spring(),
            "0: this solver has one branch; use `BranchedProblem` for several",
        )?;
        let problem = Self { rod, cells };
        check_positive("time step [s]", problem.time_step())?;
        Ok(problem)
    }

    /// The rod.
    #[must_use]
    pub fn rod(&self) -> &InelasticRod<L> {
        &self.rod
    }

    /// Time step dt = L/(c N) \[s\].
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.rod.transit_time() / self.cells as f64
    }

    /// Starts the march at time 0 from rest, with the velocity `velocity` [m/s] already imposed at
    /// x = -L.
    #[must_use]
    pub fn march(&self, velocity: f64) -> March<L> {
        March::new(self, velocity, 0)
    }

    /// Computes v_r [m/s] at `times` \[s\] for the excitation v_e.
    ///
    /// # Errors
    /// [`RodwaveError::ExcitationTooShort`] if a time is after the end of the excitation,
    /// [`RodwaveError::NonPhysical`] if a time is negative or not finite, or more than 1e9 time
    /// steps after the start of the excitation.
    pub fn free_end_velocity(
        &self,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Vec<f64>, RodwaveError> {
        let levels = TimeLevels::of(excitation, times, self.time_step())?;
        let mut march = self.march(excitation.at(levels.time(0)));
        let mut history = Vec::with_capacity(levels.steps + 1);
        history.push(march.free_end_velocity());
        for n in 1..=levels.steps {
            let velocity = excitation.at(levels.time(n));
            if velocity != 0.0 || !march.is_at_rest() {
                march.advance(velocity);
            }
            history.push(march.free_end_velocity());
        }
        let points = levels.interpolations(times);
        let velocity: Vec<f64> = points.iter().map(|point| point.value(&history)).collect();
        check_samples("velocity of the free end", &velocity)?;
        Ok(velocity)
    }

    /// Computes v_r and its derivatives at `times` \[s\] for the excitation v_e, with the
    /// tangent-linear model.
    ///
    /// # Errors
    /// The errors of [`Self::free_end_velocity`]; [`RodwaveError::LengthMismatch`] for a law with
    /// more than [`MAX_PARAMETERS`] parameters.
    pub fn free_end_velocity_with_sensitivities(
        &self,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Response, RodwaveError> {
        check_parameters::<L>()?;
        let step = self.time_step();
        let levels = TimeLevels::of(excitation, times, step)?;
        let tangents = 1 + L::PARAMETERS.len();
        let mut march = March::new(self, excitation.at(levels.time(0)), tangents);
        let mut history = Vec::with_capacity(levels.steps + 1);
        let mut tangent_history = vec![Vec::with_capacity(levels.steps + 1); tangents];
        for n in 0..=levels.steps {
            if n > 0 {
                let time = levels.time(n);
                let velocity = excitation.at(time);
                let by_log_modulus = -0.5 * levels.since_begin(time) * excitation.slope(time);
                if velocity != 0.0 || by_log_modulus != 0.0 || !march.is_at_rest() {
                    march.advance_with_tangents(velocity, by_log_modulus);
                }
            }
            history.push(march.free_end_velocity());
            for (history, tangent) in tangent_history.iter_mut().zip(&march.tangents) {
                history.push(tangent.free_end_velocity());
            }
        }
        let points = levels.interpolations(times);
        let at_times = |history: &Vec<f64>| -> Vec<f64> {
            points.iter().map(|point| point.value(history)).collect()
        };
        let mut derivatives = tangent_history.iter().map(at_times);
        let mut by_log_modulus = derivatives.next().unwrap_or_default();
        for ((derivative, time), point) in by_log_modulus.iter_mut().zip(times).zip(&points) {
            *derivative += 0.5 * levels.since_begin(*time) * point.slope(&history) / step;
        }
        let velocity = at_times(&history);
        check_samples("velocity of the free end", &velocity)?;
        Ok(Response {
            by_log_modulus,
            by_parameter: derivatives.collect(),
            velocity,
        })
    }
}

/// Energies per unit cross-sectional area since the start [J/m²]; supplied = stored + dissipated to
/// rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyBalance {
    /// Work done on the rod at x = -L.
    pub supplied: f64,
    /// Kinetic and elastic energy of the rod.
    pub stored: f64,
    /// Energy lost to the inelastic strain rate; never decreases.
    pub dissipated: f64,
}

/// The state of a [`DirectProblem`] at one time level.
#[derive(Debug, Clone)]
pub struct March<L: InelasticLaw> {
    wave: WavePair,
    tangents: Vec<WavePair>,
    flow: L::Flow,
    half_flow: L::Flow,
    impedance: f64,
    steps: usize,
    /// ρ dx/4, the energy per unit area of a unit R² or L² in one cell
    energy_weight: f64,
    supplied: f64,
    dissipated: f64,
}

impl<L: InelasticLaw> March<L> {
    fn new(problem: &DirectProblem<L>, velocity: f64, tangents: usize) -> Self {
        let rod = &problem.rod;
        let step = problem.time_step();
        let mut march = Self {
            wave: WavePair::at_rest(problem.cells + 1),
            tangents: vec![WavePair::at_rest(problem.cells + 1); tangents],
            flow: rod.law().flow(rod.modulus(), step),
            half_flow: rod.law().flow(rod.modulus(), 0.5 * step),
            impedance: rod.specific_impedance(),
            steps: 0,
            energy_weight: rod.density() * rod.length() / problem.cells as f64 / 4.0,
            supplied: 0.0,
            dissipated: 0.0,
        };
        march.wave.impose_velocity(velocity);
        // the half cell at the driven end moves at `velocity` from the start; its energy has been
        // supplied
        let stored = march.stored();
        march.supplied = stored;
        march
    }

    /// Advances one time step; `velocity` [m/s] is the velocity at x = -L at the end of the step.
    pub fn advance(&mut self, velocity: f64) {
        let nodes = self.wave.len();
        let reached = (self.steps + 1).min(nodes);
        let flow = if self.steps == 0 {
            &self.half_flow
        } else {
            &self.flow
        };
        let relaxed = pulp::Arch::new().dispatch(Relax {
            wave: &mut self.wave,
            flow,
            impedance: self.impedance,
            reached,
        });
        self.dissipated += self.energy_weight * relaxed;
        self.supplied += 0.5 * self.energy_weight * self.wave.net_inflow();
        self.wave.shift(velocity);
        self.supplied += 0.5 * self.energy_weight * self.wave.net_inflow();
        self.steps += 1;
    }

    /// Advances one time step with the tangents; `velocity_tangent` is dv_e/d ln E at constant
    /// dimensionless time.
    fn advance_with_tangents(&mut self, velocity: f64, velocity_tangent: f64) {
        let reached = (self.steps + 1).min(self.wave.len());
        let flow = if self.steps == 0 {
            &self.half_flow
        } else {
            &self.flow
        };
        pulp::Arch::new().dispatch(RelaxWithTangents::<L> {
            wave: &mut self.wave,
            tangents: &mut self.tangents,
            flow,
            impedance: self.impedance,
            reached,
        });
        self.wave.shift(velocity);
        for (index, tangent) in self.tangents.iter_mut().enumerate() {
            tangent.shift(if index == 0 { velocity_tangent } else { 0.0 });
        }
        self.steps += 1;
    }

    /// Returns true if nothing has moved yet, in which case a step without velocity changes
    /// nothing.
    fn is_at_rest(&self) -> bool {
        self.steps == 0 && self.supplied == 0.0
    }

    /// Velocity of the free end [m/s] at the present time.
    #[must_use]
    pub fn free_end_velocity(&self) -> f64 {
        self.wave.free_end_velocity()
    }

    /// Number of steps made.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Stress \[Pa\] and velocity [m/s] at every node, from x = -L to x = 0, at the present time
    /// (before the half relaxation that ends the step, which differs by a term of order dt).
    pub fn state(&self) -> impl Iterator<Item = NodeState> + '_ {
        let impedance = self.impedance;
        self.wave
            .right
            .as_slice()
            .iter()
            .zip(self.wave.left.as_slice())
            .map(move |(r, l)| NodeState {
                stress: 0.5 * impedance * (r + l),
                velocity: 0.5 * (l - r),
            })
    }

    /// The energy balance since the start.
    #[must_use]
    pub fn energy(&self) -> EnergyBalance {
        EnergyBalance {
            supplied: self.supplied,
            stored: self.stored(),
            dissipated: self.dissipated,
        }
    }

    /// Trapezoidal sum over the nodes of ρ dx (R² + L²)/4.
    fn stored(&self) -> f64 {
        let WavePair { right, left } = &self.wave;
        let nodes = right.as_slice().iter().zip(left.as_slice());
        let sum: f64 = nodes.map(|(r, l)| r * r + l * l).sum();
        let ends = right.first().powi(2)
            + left.first().powi(2)
            + right.last().powi(2)
            + left.last().powi(2);
        self.energy_weight * (sum - 0.5 * ends)
    }
}

/// Stress and velocity at one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeState {
    /// σ \[Pa\], positive in tension.
    pub stress: f64,
    /// v [m/s], positive towards the free end.
    pub velocity: f64,
}

/// [`relax`] as a task that can run with the vector instructions of the processor. Without
/// these instructions, the results are the same to the last digit.
struct Relax<'a, F> {
    wave: &'a mut WavePair,
    flow: &'a F,
    impedance: f64,
    reached: usize,
}

impl<F: RelaxationFlow> pulp::NullaryFnOnce for Relax<'_, F> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        relax(self.wave, self.flow, self.impedance, self.reached)
    }
}

/// Relaxes the first `reached` nodes (those ahead of the front are at rest) and returns the loss of
/// Σ(R² + L²).
#[inline(always)]
fn relax<F: RelaxationFlow>(wave: &mut WavePair, flow: &F, impedance: f64, reached: usize) -> f64 {
    let inverse = 1.0 / impedance;
    let (right, left) = wave.blocks_mut(reached);
    let mut loss = [0.0; LANES];
    let mut loss_of_end = None;
    for (right, left) in right.iter_mut().zip(left) {
        relax_block(right, left, flow, impedance, inverse, &mut loss);
        loss_of_end.get_or_insert(loss[0]);
    }
    // the end node carries half a cell
    loss.iter().sum::<f64>() - 0.5 * loss_of_end.unwrap_or(0.0)
}

#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "the counter stays below `LANES`, the length of all five arrays"
)]
fn relax_block<F: RelaxationFlow>(
    right: &mut [f64; LANES],
    left: &mut [f64; LANES],
    flow: &F,
    impedance: f64,
    inverse: f64,
    loss: &mut [f64; LANES],
) {
    let scaled: [f64; LANES] = lanes!(|i| 0.5 * (right[i] + left[i]));
    let change = flow.change(&lanes!(|i| impedance * scaled[i]));
    for i in 0..LANES {
        let change = change[i] * inverse;
        right[i] += change;
        left[i] += change;
        // R² + L² changes by 2 change (R + L) + 2 change²
        loss[i] -= 2.0 * change * (2.0 * scaled[i] + change);
    }
}

/// [`relax_with_tangents`] as a task that can run with the vector instructions of the processor.
struct RelaxWithTangents<'a, L: InelasticLaw> {
    wave: &'a mut WavePair,
    tangents: &'a mut [WavePair],
    flow: &'a L::Flow,
    impedance: f64,
    reached: usize,
}

impl<L: InelasticLaw> pulp::NullaryFnOnce for RelaxWithTangents<'_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        relax_with_tangents::<L>(
            self.wave,
            self.tangents,
            self.flow,
            self.impedance,
            self.reached,
        );
    }
}

/// Relaxes the waves as [`relax`] does, together with the tangents (index 0 for ln E, then the
/// parameters of the law).
#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    clippy::needless_range_loop,
    reason = "`blocks_mut` cuts the waves and all tangents, which have as many nodes, into the same number of blocks; whether zipped iterators of so short a loop are inlined depends on the folder of the build"
)]
fn relax_with_tangents<L: InelasticLaw>(
    wave: &mut WavePair,
    tangents: &mut [WavePair],
    flow: &L::Flow,
    impedance: f64,
    reached: usize,
) {
    let inverse = 1.0 / impedance;
    let (right, left) = wave.blocks_mut(reached);
    let mut tangent_blocks: [Blocks<'_>; 1 + MAX_PARAMETERS] = Default::default();
    for (blocks, tangent) in tangent_blocks.iter_mut().zip(tangents) {
        *blocks = tangent.blocks_mut(reached);
    }
    let [(right_by_modulus, left_by_modulus), by_parameter @ ..] = &mut tangent_blocks;
    let by_modulus = right_by_modulus.iter_mut().zip(left_by_modulus.iter_mut());
    let wave_blocks = right.iter_mut().zip(left);
    for (block, ((right, left), by_modulus)) in wave_blocks.zip(by_modulus).enumerate() {
        let (r, l) = (*right, *left);
        let scaled = lanes!(|i| 0.5 * (r[i] + l[i]));
        let change =
            flow.change_with_sensitivity(&lanes!(|i| impedance * scaled[i]), L::PARAMETERS.len());
        *right = lanes!(|i| r[i] + change.stress[i] * inverse);
        *left = lanes!(|i| l[i] + change.stress[i] * inverse);
        // at constant dimensionless time, Z and E h are proportional to E^½ (h: time step)
        let source = lanes!(|i| {
            0.5 * (scaled[i] * change.by_stress[i]
                + (change.by_log_modulus[i] - change.stress[i]) * inverse)
        });
        relax_tangent_block(by_modulus.0, by_modulus.1, &change, &source);
        for parameter in 0..L::PARAMETERS.len().min(MAX_PARAMETERS) {
            let (right, left) = &mut by_parameter[parameter];
            let source = lanes!(|i| change.by_parameter[parameter][i] * inverse);
            relax_tangent_block(&mut right[block], &mut left[block], &change, &source);
        }
    }
}

#[inline(always)]
fn relax_tangent_block(
    right: &mut [f64; LANES],
    left: &mut [f64; LANES],
    change: &StressChange,
    source: &[f64; LANES],
) {
    // copies share no memory, so the compiler need not check for overlap
    let (r, l) = (*right, *left);
    let change = lanes!(|i| change.by_stress[i] * 0.5 * (r[i] + l[i]) + source[i]);
    *right = lanes!(|i| r[i] + change[i]);
    *left = lanes!(|i| l[i] + change[i]);
}

/// R and L at the nodes, in blocks of lanes.
type Blocks<'a> = (&'a mut [[f64; LANES]], &'a mut [[f64; LANES]]);

/// The waves R = s - v and L = s + v [m/s] at the nodes.
#[derive(Debug, Clone)]
struct WavePair {
    right: SlidingWindow,
    left: SlidingWindow,
}

impl WavePair {
    fn at_rest(nodes: usize) -> Self {
        Self {
            right: SlidingWindow::zeros(nodes),
            left: SlidingWindow::zeros(nodes),
        }
    }

    fn len(&self) -> usize {
        self.right.len()
    }

    /// R and L of the first `reached` nodes, padded with zeros to whole blocks.
    #[inline(always)]
    fn blocks_mut(&mut self, reached: usize) -> Blocks<'_> {
        (
            self.right.blocks_mut(reached),
            self.left.blocks_mut(reached),
        )
    }

    /// R² - L² at x = -L, which is -4 s v: the inflow of energy up to a factor.
    fn net_inflow(&self) -> f64 {
        self.right.first().powi(2) - self.left.first().powi(2)
    }

    fn impose_velocity(&mut self, velocity: f64) {
        self.right.set_first(self.left.first() - 2.0 * velocity);
    }

    /// Moves R one node to the right and L one node to the left, with a free end at x = 0 and the
    /// given velocity at x = -L.
    fn shift(&mut self, velocity: f64) {
        self.right.slide_towards_end();
        self.left.slide_towards_start();
        self.left.set_last(-self.right.last());
        self.impose_velocity(velocity);
    }

    fn free_end_velocity(&self) -> f64 {
        -self.right.last()
    }

    /// Returns true if there is no wave at the driven end, from which all other waves have come.
    fn is_at_rest(&self) -> bool {
        self.right.first() == 0.0 && self.left.first() == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};

    /// Compares a march that uses the vector instructions of the processor with one that does not.
    fn digits_are_the_same<L: InelasticLaw<Flow: Clone>>(law: &L) {
        let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law.clone()).unwrap();
        let problem = DirectProblem::new(rod, 75).unwrap();
        let mut march = March::new(&problem, 9.0, 1 + L::PARAMETERS.len());
        for step in 0..400_u32 {
            let (mut plain, mut with_tangents) = (march.clone(), march.clone());
            let reached = (march.steps + 1).min(march.wave.len());
            let relaxed = relax(&mut plain.wave, &march.flow, march.impedance, reached);
            let dispatched = pulp::Arch::new().dispatch(Relax {
                wave: &mut march.wave,
                flow: &march.flow,
                impedance: march.impedance,
                reached,
            });
            assert_eq!(relaxed.to_bits(), dispatched.to_bits(), "{law:?}");
            assert_same_bits(&plain.wave, &march.wave);
            march.wave.clone_from(&with_tangents.wave);
            relax_with_tangents::<L>(
                &mut with_tangents.wave,
                &mut with_tangents.tangents,
                &march.flow,
                march.impedance,
                reached,
            );
            pulp::Arch::new().dispatch(RelaxWithTangents::<L> {
                wave: &mut march.wave,
                tangents: &mut march.tangents,
                flow: &march.flow,
                impedance: march.impedance,
                reached,
            });
            assert_same_bits(&with_tangents.wave, &march.wave);
            for (plain, vector) in with_tangents.tangents.iter().zip(&march.tangents) {
                assert_same_bits(plain, vector);
            }
            // an oscillating velocity, so that blocks with small and with large stresses occur
            march.wave.shift(9.0 + 8.0 * (0.1 * f64::from(step)).sin());
            for tangent in &mut march.tangents {
                tangent.shift(1.0);
            }
            march.steps += 1;
        }
    }

    fn assert_same_bits(a: &WavePair, b: &WavePair) {
        for (a, b) in [(&a.right, &b.right), (&a.left, &b.left)] {
            let values = a.as_slice().iter().zip(b.as_slice());
            for (a, b) in values {
                assert_eq!(a.to_bits(), b.to_bits(), "{a} {b}");
            }
        }
    }

    #[test]
    fn vector_instructions_change_no_digit() {
        digits_are_the_same(&Maxwell::new(4e6).unwrap());
        digits_are_the_same(&MaxwellNorton::new(2.108, 7e13).unwrap());
        // one part and a few terms, then several parts
        digits_are_the_same(&MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap());
        digits_are_the_same(&MaxwellGurevichRabinovich::new(2e5, 7.08e6).unwrap());
    }
}
