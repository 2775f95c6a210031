//! Derivatives of the velocity of the free end with respect to samples of the excitation.
//!
//! The tangent-linear model is integrated along one motion of the rod. Its coefficients, the
//! derivatives of the relaxation with respect to the stress of each node, are the same for all
//! samples. The tangents of [`LANES`] samples are computed together.

use super::time_levels::TimeLevels;
use super::{DirectProblem, March};
use crate::RodwaveError;
use crate::band_limited::{SamplePulses, VelocityHistory};
use crate::error::check_samples;
use crate::inelastic::{InelasticLaw, LANES, RelaxationFlow, lanes};

impl<L: InelasticLaw> DirectProblem<L> {
    /// Computes dv_r/dv_e at `times` \[s\] for the samples of `pulses`, along the motion that
    /// `excitation` drives. Each sample gives one column. Where |σ|/Z is below `least` [m/s], the
    /// law is linearised at |σ|/Z = `least`: Norton's law with an exponent below 1 has no finite
    /// slope at rest.
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
        let motion = Motion {
            excitation,
            levels: TimeLevels::of_pulses(excitation, pulses, times, self.time_step())?,
            nodes: self.cells + 1,
            shares: &[1.0],
        };
        let mut march = self.march(excitation.at(motion.levels.time(0)));
        by_samples(&motion, pulses, times, |velocity, slopes| {
            if let Some(slopes) = slopes.first_mut() {
                march.advance_with_slopes(velocity, slopes, least);
            }
        })
    }
}

/// The motion about which derivatives are taken.
pub(super) struct Motion<'a> {
    pub(super) excitation: &'a dyn VelocityHistory,
    pub(super) levels: TimeLevels,
    pub(super) nodes: usize,
    /// Share of the modulus of each branch that relaxes.
    pub(super) shares: &'a [f64],
}

/// Computes the derivatives of the velocity of the free end with respect to the samples of
/// `pulses`. `advance` makes a step of the motion; its first argument is the velocity at x = -L at
/// the end of the step. To its second argument it writes, for each branch and node, the derivative
/// of the change of the branch's stress with respect to this stress.
pub(super) fn by_samples(
    motion: &Motion<'_>,
    pulses: &SamplePulses,
    times: &[f64],
    mut advance: impl FnMut(f64, &mut [Vec<f64>]),
) -> Result<Vec<Vec<f64>>, RodwaveError> {
    let levels = motion.levels;
    let mut slopes = vec![vec![0.0; motion.nodes.next_multiple_of(LANES)]; motion.shares.len()];
    let each: Vec<usize> = (0..pulses.len()).collect();
    let mut groups: Vec<PulseGroup> = each
        .chunks(LANES)
        .map(|members| PulseGroup::new(members, pulses, motion))
        .collect();
    let mut rests = motion.excitation.at(levels.time(0)) == 0.0;
    for n in 1..=levels.steps {
        let time = levels.time(n);
        let velocity = motion.excitation.at(time);
        rests &= velocity == 0.0;
        if rests && groups.iter().all(|group| n < group.begin) {
            continue;
        }
        advance(velocity, &mut slopes);
        for group in &mut groups {
            group.advance(n, pulses, time, (&slopes, motion.shares));
        }
    }
    let points = levels.interpolations(times);
    let histories = groups.iter().flat_map(|group| &group.histories);
    let columns: Vec<Vec<f64>> = histories
        .map(|history| points.iter().map(|point| point.value(history)).collect())
        .collect();
    for column in &columns {
        check_samples("derivative of the velocity of the free end", column)?;
    }
    Ok(columns)
}

impl<L: InelasticLaw> March<L> {
    /// Advances one time step as [`Self::advance`] does, and writes to `slopes`, for each node, the
    /// derivative of the change of stress with respect to the stress.
    fn advance_with_slopes(&mut self, velocity: f64, slopes: &mut [f64], least: f64) {
        let nodes = self.wave.len();
        let flow = if self.steps == 0 {
            &self.half_flow
        } else {
            &self.flow
        };
        let (right, left) = self.wave.blocks_mut(nodes);
        pulp::Arch::new().dispatch(RelaxWithSlopes {
            waves: (right, left),
            slopes: slopes.as_chunks_mut::<LANES>().0,
            flow,
            impedance: self.impedance,
            least: self.impedance * least,
        });
        self.wave.shift(velocity);
        self.steps += 1;
    }
}

struct RelaxWithSlopes<'a, F> {
    waves: super::Blocks<'a>,
    slopes: &'a mut [[f64; LANES]],
    flow: &'a F,
    impedance: f64,
    /// Smallest stress \[Pa\] at which a slope is evaluated.
    least: f64,
}

/// Returns the slopes of `flow` at these stresses, or at `least` \[Pa\] where a stress is smaller
/// in magnitude. `at_stress` contains the slopes at the stresses themselves.
#[inline(always)]
pub(super) fn slopes_of<F: RelaxationFlow>(
    flow: &F,
    stress: &[f64; LANES],
    least: f64,
    at_stress: &[f64; LANES],
) -> [f64; LANES] {
    if stress.iter().all(|stress| stress.abs() >= least) {
        return *at_stress;
    }
    flow.change_with_sensitivity(&lanes!(|i| stress[i].abs().max(least)), 0)
        .by_stress
}

impl<F: RelaxationFlow> pulp::NullaryFnOnce for RelaxWithSlopes<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let inverse = 1.0 / self.impedance;
        let (right, left) = self.waves;
        for ((right, left), slopes) in right.iter_mut().zip(left).zip(self.slopes) {
            let (r, l) = (*right, *left);
            let stress = lanes!(|i| 0.5 * self.impedance * (r[i] + l[i]));
            let change = self.flow.change_with_sensitivity(&stress, 0);
            *right = lanes!(|i| r[i] + change.stress[i] * inverse);
            *left = lanes!(|i| l[i] + change.stress[i] * inverse);
            *slopes = slopes_of(self.flow, &stress, self.least, &change.by_stress);
        }
    }
}

/// Tangents of up to [`LANES`] samples, one per lane: the waves R and L at each node.
struct PulseGroup {
    members: Vec<usize>,
    nodes: usize,
    /// First step in which a tangent moves.
    begin: usize,
    /// R at the nodes, from the index `of_right` on; `left` contains L from `of_left` on. A shift
    /// of the waves moves only these two indices.
    right: Vec<[f64; LANES]>,
    left: Vec<[f64; LANES]>,
    of_right: usize,
    of_left: usize,
    /// Excess of each branch over its share of s = σ/Z at each node; empty if there is a single
    /// branch and no spring.
    excess: Vec<Vec<[f64; LANES]>>,
    /// Derivative of the velocity of the free end at each time level, for each sample of the group.
    histories: Vec<Vec<f64>>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "both buffers hold the nodes and the steps from `begin` on, by which the windows have moved at the last step"
)]
impl PulseGroup {
    fn new(members: &[usize], pulses: &SamplePulses, motion: &Motion<'_>) -> Self {
        let Motion { nodes, levels, .. } = *motion;
        let steps = levels.steps;
        // a branch in parallel with a spring has an excess as well
        let rows = match motion.shares {
            [share] if *share >= 1.0 => 0,
            shares => shares.len(),
        };
        let begins = members.iter().map(|member| pulses.begin(*member));
        let begin = levels.before(begins.fold(f64::INFINITY, f64::min));
        let length = nodes + steps - begin + 1;
        let mut group = Self {
            members: members.to_vec(),
            nodes,
            begin,
            right: vec![[0.0; LANES]; length],
            left: vec![[0.0; LANES]; length],
            of_right: length - nodes,
            of_left: 0,
            excess: vec![vec![[0.0; LANES]; nodes]; rows],
            histories: vec![vec![0.0; steps + 1]; members.len()],
        };
        if begin == 0 {
            let velocity = group.velocity(pulses, levels.time(0));
            group.impose(&velocity);
        }
        group
    }

    fn velocity(&self, pulses: &SamplePulses, time: f64) -> [f64; LANES] {
        let mut velocity = [0.0; LANES];
        for (lane, member) in velocity.iter_mut().zip(&self.members) {
            *lane = pulses.at(*member, time);
        }
        velocity
    }

    fn impose(&mut self, velocity: &[f64; LANES]) {
        let left = self.left[self.of_left];
        self.right[self.of_right] = lanes!(|i| left[i] - 2.0 * velocity[i]);
    }

    /// Makes step `n`, which ends at `time`.
    fn advance(
        &mut self,
        n: usize,
        pulses: &SamplePulses,
        time: f64,
        (slopes, shares): (&[Vec<f64>], &[f64]),
    ) {
        if n < self.begin || n == 0 {
            return;
        }
        let reached = (n - self.begin + 1).min(self.nodes);
        pulp::Arch::new().dispatch(RelaxTangents {
            right: &mut self.right[self.of_right..self.of_right + reached],
            left: &mut self.left[self.of_left..self.of_left + reached],
            excess: &mut self.excess,
            slopes,
            shares,
        });
        if n > self.begin || self.begin == 0 {
            self.of_right -= 1;
            self.of_left += 1;
        }
        let last = self.of_right + self.nodes - 1;
        let arriving = self.right[last];
        self.left[self.of_left + self.nodes - 1] = lanes!(|i| -arriving[i]);
        let velocity = self.velocity(pulses, time);
        self.impose(&velocity);
        for (history, value) in self.histories.iter_mut().zip(arriving) {
            history[n] = -value;
        }
    }
}

struct RelaxTangents<'a> {
    right: &'a mut [[f64; LANES]],
    left: &'a mut [[f64; LANES]],
    excess: &'a mut [Vec<[f64; LANES]>],
    slopes: &'a [Vec<f64>],
    shares: &'a [f64],
}

/// Uses the vectors of the processor explicitly. From loops over lanes, a compiler makes one loop
/// over nodes, which must gather each vector from as many nodes as it has lanes.
impl pulp::WithSimd for RelaxTangents<'_> {
    type Output = ();

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "slopes, shares and the excess, unless it is empty, have a row for each branch, with all nodes, and a node has `LANES` lanes"
    )]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        let nodes = self.right.iter_mut().zip(self.left);
        let half = simd.splat_f64s(0.5);
        if let ([slopes], true) = (self.slopes, self.excess.is_empty()) {
            for ((right, left), slope) in nodes.zip(slopes) {
                let half_slope = simd.splat_f64s(0.5 * slope);
                let right = S::as_mut_simd_f64s(right).0;
                let left = S::as_mut_simd_f64s(left).0;
                for (right, left) in right.iter_mut().zip(left) {
                    let change = simd.mul_f64s(half_slope, simd.add_f64s(*right, *left));
                    *right = simd.add_f64s(*right, change);
                    *left = simd.add_f64s(*left, change);
                }
            }
            return;
        }
        for (node, (right, left)) in nodes.enumerate() {
            let right = S::as_mut_simd_f64s(right).0;
            let left = S::as_mut_simd_f64s(left).0;
            for (part, (right, left)) in right.iter_mut().zip(left).enumerate() {
                let scaled = simd.mul_f64s(half, simd.add_f64s(*right, *left));
                let mut total = simd.splat_f64s(0.0);
                let branches = self.excess.iter_mut().zip(self.slopes).zip(self.shares);
                for ((excess, slopes), share) in branches {
                    let excess = &mut S::as_mut_simd_f64s(&mut excess[node]).0[part];
                    let of_share = simd.mul_f64s(simd.splat_f64s(*share), scaled);
                    let slope = simd.splat_f64s(slopes[node]);
                    let change = simd.mul_f64s(slope, simd.add_f64s(of_share, *excess));
                    total = simd.add_f64s(total, change);
                    *excess = simd.add_f64s(*excess, change);
                }
                for (excess, share) in self.excess.iter_mut().zip(self.shares) {
                    let excess = &mut S::as_mut_simd_f64s(&mut excess[node]).0[part];
                    let of_share = simd.mul_f64s(simd.splat_f64s(*share), total);
                    *excess = simd.sub_f64s(*excess, of_share);
                }
                *right = simd.add_f64s(*right, total);
                *left = simd.add_f64s(*left, total);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::band_limited::{SamplePulses, SampledHistory};
    use crate::inelastic::{Eyring, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
    use crate::{DirectProblem, InelasticRod};

    const RATE: f64 = 102_400.0;

    /// Compares the derivatives with differences between responses to excitations that differ in
    /// one sample.
    fn agrees_with_differences<L: crate::inelastic::InelasticLaw>(law: L) {
        let rod = InelasticRod::new(0.3, 1140.0, 3e9, law).unwrap();
        let problem = DirectProblem::new(rod, 60).unwrap();
        let mut samples: Vec<f64> = (0..120)
            .map(|k| {
                let t = (f64::from(k) - 30.0).max(0.0) / RATE;
                12.0 * (1.0 - (-t / 2e-5).exp()) * (-t / 2e-4).exp()
            })
            .collect();
        // the first sample is not zero, so that the levels of all marches begin there
        samples[0] = 1e-9;
        let times: Vec<f64> = (0..100).map(|k| f64::from(k) / RATE).collect();
        // more samples than a group has lanes; the first one is at the start of the record
        let places: Vec<usize> = (0..95).step_by(5).collect();
        let pulses = SamplePulses::new(&places, RATE).unwrap();
        let excitation = SampledHistory::new(&samples, RATE).unwrap();
        let found = problem
            .free_end_velocity_by_samples(&excitation, &pulses, &times, 0.0)
            .unwrap();
        let response = |place: usize, change: f64| {
            let mut changed = samples.clone();
            changed[place] += change;
            let history = SampledHistory::new(&changed, RATE).unwrap();
            problem.free_end_velocity(&history, &times).unwrap()
        };
        for (place, column) in places.iter().zip(&found) {
            let (above, below) = (response(*place, 1e-6), response(*place, -1e-6));
            for (k, by) in column.iter().enumerate() {
                let difference = (above[k] - below[k]) / 2e-6;
                // tolerance: at rest F is proportional to h^κ for a change h of the sample, and the
                // error of the difference quotient to h^(κ - 1)
                assert!(
                    (by - difference).abs() < 1e-6,
                    "{place} {k}: {by} {difference}"
                );
            }
        }
    }

    #[test]
    fn derivatives_by_samples_are_those_of_differences() {
        agrees_with_differences(Maxwell::new(4e5).unwrap());
        agrees_with_differences(MaxwellNorton::from_reference_rate(2.1, 40.0, 10e6).unwrap());
        agrees_with_differences(MaxwellGurevichRabinovich::new(1e6, 8e6).unwrap());
        agrees_with_differences(Eyring::new(3.0, 4e6).unwrap());
    }
}
