//! Comparison of rods of several branches with the line solver, which has other cells and other
//! derivatives, and with finite differences.

use super::*;
use crate::DirectProblem;
use crate::band_limited::SampledHistory;
use crate::inelastic::{Elastic, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use crate::line::{Body, Drive, End, Line, Segment};

const RATE: f64 = 102_400.0;
const LENGTH: f64 = 0.3;
const DENSITY: f64 = 1140.0;

fn samples() -> Vec<f64> {
    (0..140)
        .map(|k| {
            let t = (f64::from(k) - 20.0).max(0.0) / RATE;
            15.0 * (1.0 - (-t / 3e-5).exp()) * (-t / 2e-4).exp()
        })
        .collect()
}

fn history() -> SampledHistory {
    SampledHistory::new(&samples(), RATE).unwrap()
}

fn times() -> Vec<f64> {
    (0..120).map(|k| f64::from(k) / RATE).collect()
}

fn norton() -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(2.1, 60.0, 10e6).unwrap()
}

/// A spring with the share 0.3, linear branches with 0.2 and 0.1, and the law's branch with 0.4.
fn problem<L: InelasticLaw>(law: L, theta: &[f64; 6], cells: usize) -> BranchedProblem<L> {
    let [log_modulus, ratio, second, third, first_time, second_time] = *theta;
    let weights = [1.0, ratio.exp(), second.exp(), third.exp()];
    let sum: f64 = weights.iter().sum();
    let rod = InelasticRod::new(LENGTH, DENSITY, log_modulus.exp(), law).unwrap();
    let rod = rod.with_spring(weights[0] / sum).unwrap();
    let linear =
        [(weights[1], first_time), (weights[2], second_time)].map(|(weight, time)| LinearBranch {
            share: weight / sum,
            time: time.exp(),
        });
    BranchedProblem::new(rod, linear.to_vec(), cells).unwrap()
}

fn theta() -> [f64; 6] {
    let of = |share: f64| (share / 0.3).ln();
    [
        3e9_f64.ln(),
        of(0.2),
        of(0.1),
        of(0.4),
        2e-5_f64.ln(),
        3e-4_f64.ln(),
    ]
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

/// Compares the response with that of the line solver, which has cells instead of nodes, stores the
/// excess of the spring too, and has its ends half a cell away from the nearest cell centre.
#[test]
fn the_response_is_that_of_the_line() {
    let found = problem(norton(), &theta(), 240)
        .free_end_velocity(&history(), &times())
        .unwrap();
    let segment = Segment::new(LENGTH, 1.0, DENSITY)
        .unwrap()
        .with_branch(0.9e9, Elastic)
        .unwrap()
        .with_branch(0.6e9, Maxwell::new(0.6e9 * 2e-5).unwrap())
        .unwrap()
        .with_branch(0.3e9, Maxwell::new(0.3e9 * 3e-4).unwrap())
        .unwrap()
        .with_branch(1.2e9, norton())
        .unwrap();
    let step = segment.transit_time() / 240.0;
    let excitation = history();
    let line = Line::new([Body::new([segment]).unwrap()])
        .unwrap()
        .with_left_end(End::Velocity(Drive::of(move |t| excitation.at(t))))
        .unwrap();
    let run = line.run(step * (1.0 + 1e-9), 1.19e-3, &[]).unwrap();
    let expected = run.ends[1].velocity_at(run.grid.time_step, &times());
    // tolerance: both solvers are of second order in the length of their 240 cells
    let difference = distance(&found, &expected) / norm(&expected);
    assert!(difference < 2e-4, "{difference}");
}

/// Compares a rod whose only branch is that of the law with [`DirectProblem`].
#[test]
fn a_single_branch_has_the_response_of_the_direct_problem() {
    let rod = InelasticRod::new(LENGTH, DENSITY, 3e9, norton()).unwrap();
    let one = DirectProblem::new(rod.clone(), 60).unwrap();
    let expected = one.free_end_velocity(&history(), &times()).unwrap();
    let found = BranchedProblem::new(rod, Vec::new(), 60)
        .unwrap()
        .free_end_velocity(&history(), &times())
        .unwrap();
    assert!(distance(&found, &expected) < 1e-12 * norm(&expected));
}

fn has_derivatives_of_differences<L: InelasticLaw>(law: &L) {
    let excitation = history();
    let response = |law: &L, theta: &[f64; 6]| {
        problem(law.clone(), theta, 60)
            .free_end_velocity(&excitation, &times())
            .unwrap()
    };
    let shares = [0.2, 0.1, 0.4];
    // dwᵢ/dx_k = wᵢ (δ_ik - w_k), where x_k is the logarithm of the ratio of share k to the share
    // of the spring
    let ratios = (0..3).map(|k| {
        let own = |i: usize| if i == k { 1.0 } else { 0.0 };
        Direction::Shares((0..3).map(|i| shares[i] * (own(i) - shares[k])).collect())
    });
    let directions: Vec<Direction> = std::iter::once(Direction::LogModulus)
        .chain(ratios)
        .chain([vec![1.0, 0.0], vec![0.0, 1.0]].map(Direction::LogTimes))
        .chain((0..L::PARAMETERS.len()).map(Direction::Parameter))
        .collect();
    let (velocity, by) = problem(law.clone(), &theta(), 60)
        .free_end_velocity_with_sensitivities(&excitation, &times(), &directions)
        .unwrap();
    assert!(distance(&velocity, &response(law, &theta())) < 1e-12 * norm(&velocity));
    let h = 1e-6;
    for (index, derivative) in by.iter().enumerate() {
        let at = |h: f64| {
            let (mut theta, mut of_law) = (theta(), law.parameters());
            match theta.get_mut(index) {
                Some(own) => *own += h,
                None => of_law[index - 6] += h,
            }
            response(&law.with_parameters(&of_law).unwrap(), &theta)
        };
        let pairs = at(h).into_iter().zip(at(-h));
        let difference: Vec<f64> = pairs.map(|(a, b)| (a - b) / (2.0 * h)).collect();
        // tolerance: the interpolation in time is piecewise and so has corners as a function of ln
        // E
        let error = distance(derivative, &difference) / norm(&difference);
        assert!(error < 1e-5, "{index}: {error}");
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    has_derivatives_of_differences(&norton());
    has_derivatives_of_differences(&MaxwellGurevichRabinovich::new(1e6, 8e6).unwrap());
}

fn has_samples_of_differences(problem: &BranchedProblem<MaxwellNorton>) {
    let mut samples = samples();
    // the first sample is not zero, so that the levels of all marches begin there
    samples[0] = 1e-9;
    let excitation = SampledHistory::new(&samples, RATE).unwrap();
    let places: Vec<usize> = (0..110).step_by(6).collect();
    let pulses = SamplePulses::new(&places, RATE).unwrap();
    let found = problem
        .free_end_velocity_by_samples(&excitation, &pulses, &times(), 0.0)
        .unwrap();
    for (place, column) in places.iter().zip(&found) {
        let at = |change: f64| {
            let mut changed = samples.clone();
            changed[*place] += change;
            let history = SampledHistory::new(&changed, RATE).unwrap();
            problem.free_end_velocity(&history, &times()).unwrap()
        };
        let pairs = at(1e-6).into_iter().zip(at(-1e-6));
        let difference: Vec<f64> = pairs.map(|(a, b)| (a - b) / 2e-6).collect();
        assert!(distance(column, &difference) < 1e-6, "{place}");
    }
}

#[test]
fn derivatives_by_samples_are_those_of_differences() {
    has_samples_of_differences(&problem(norton(), &theta(), 60));
    // a single branch, with and without a spring
    let rod = InelasticRod::new(LENGTH, DENSITY, 3e9, norton()).unwrap();
    has_samples_of_differences(&BranchedProblem::new(rod.clone(), Vec::new(), 60).unwrap());
    let rod = rod.with_spring(0.6).unwrap();
    has_samples_of_differences(&BranchedProblem::new(rod, Vec::new(), 60).unwrap());
}

#[test]
fn branches_that_are_not_physical_are_refused() {
    let rod = || InelasticRod::new(LENGTH, DENSITY, 3e9, norton()).unwrap();
    for (share, time) in [(0.0, 1e-5), (1.0, 1e-5), (0.1, 0.0), (f64::NAN, 1e-5)] {
        let branch = LinearBranch { share, time };
        let refused = BranchedProblem::new(rod(), vec![branch], 60).unwrap_err();
        assert!(matches!(refused, RodwaveError::NonPhysical { .. }));
    }
    let problem = BranchedProblem::new(rod(), Vec::new(), 60).unwrap();
    for wrong in [
        Direction::Shares(vec![0.1, -0.1]),
        Direction::LogTimes(vec![1.0]),
        Direction::Parameter(2),
    ] {
        let refused = problem.free_end_velocity_with_sensitivities(&history(), &times(), &[wrong]);
        assert!(matches!(refused, Err(RodwaveError::LengthMismatch { .. })));
    }
}
