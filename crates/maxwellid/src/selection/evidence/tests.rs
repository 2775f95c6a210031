//! Comparison of ln Z with sums over a grid, which assume no normality.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodwave::InelasticRod;
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{Elastic, InelasticLaw, Maxwell, MaxwellNorton};
use rodwave::lumped::{self, LumpedRod};

use super::{Integrand, cholesky, covariance, evidence, principal_axes};
use crate::least_squares::ScaledDecomposition;
use crate::selection::{Candidate, Contest, Ground};
use crate::test::{Provenance, RodTest, RodTestData};

const RATE: f64 = 51_200.0;

/// A short rod driven by a smooth pulse, with white noise of `level` of its impact velocity of 10
/// m/s.
fn test_of<L: InelasticLaw>(law: &L, level: f64, seed: u64) -> RodTest {
    let excitation: Vec<f64> = (0..110)
        .map(|k| 8.0 * (-((f64::from(k) - 30.0) / 4.0_f64).powi(2)).exp())
        .collect();
    let times: Vec<f64> = (0..110).map(|k| f64::from(k) / RATE).collect();
    let rod = InelasticRod::new(0.2, 1140.0, 3e9, law.clone()).unwrap();
    let response = LumpedRod::new(&rod, 200, 0.5)
        .unwrap()
        .free_end_velocity(&SampledHistory::new(&excitation, RATE).unwrap(), &times)
        .unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noisy = |history: &[f64]| -> Vec<f64> {
        let noise = |v: &f64| {
            let z: f64 = StandardNormal.sample(&mut random);
            v + 10.0 * level * z
        };
        history.iter().map(noise).collect()
    };
    RodTest::new(RodTestData {
        name: "short".into(),
        length: 0.2,
        density: 1140.0,
        impact_velocity: 10.0,
        sampling_rate_hz: RATE,
        excitation: noisy(&excitation),
        response: noisy(&response),
        provenance: Provenance::Virtual {
            generator: lumped::GENERATOR.into(),
        },
    })
    .unwrap()
    .with_noise(10.0 * level, 10.0 * level)
    .unwrap()
}

/// Step of the grid in the units of the integrand. The error of the sum over a smooth peak is
/// exp(-2π²/h²), below rounding for a normal one; the other steps are for non-normal peaks.
fn step_of(axes: usize, is_linear: bool) -> f64 {
    match (axes, is_linear) {
        (0..=2, _) => 0.2,
        // a response that costs little
        (_, true) => 0.3,
        (_, false) => 0.5,
    }
}

/// ln of the sum over the grid, from the peak outwards as long as points contribute.
fn ln_sum(integrand: &Integrand<'_>) -> f64 {
    let axes = integrand.centre.len();
    let width = step_of(axes, integrand.problem.model.is_linear());
    let at = |place: &[i32]| {
        let z: Vec<f64> = place.iter().map(|k| width * f64::from(*k)).collect();
        integrand.at(&z)
    };
    let origin = vec![0; axes];
    let top = at(&origin);
    let mut seen = std::collections::BTreeSet::from([origin.clone()]);
    let mut edge = vec![origin];
    let mut sum = 1.0;
    while let Some(place) = edge.pop() {
        for axis in 0..axes {
            for step in [-1, 1] {
                let mut next = place.clone();
                next[axis] += step;
                if !seen.insert(next.clone()) {
                    continue;
                }
                let share = (at(&next) - top).exp();
                // what is beyond is a ten-thousandth of the sum
                if share > 1e-5 {
                    sum += share;
                    edge.push(next);
                }
            }
        }
    }
    top + f64::ln(sum) + axes as f64 * width.ln()
}

/// ln Z of a candidate by importance sampling and by the grid.
fn both(candidate: &Candidate, tests: &[RodTest]) -> (f64, f64) {
    let ground = Ground::of(tests).unwrap();
    let prior = candidate.prior(ground.modulus, ground.duration);
    let contest = Contest {
        candidate,
        prior: &prior,
        tests,
        times: &ground.times,
        cell: 8e-3,
        weight: 1.0,
    };
    let probable = contest
        .search(ground.modulus, ground.duration, &[])
        .unwrap()
        .unwrap();
    let seen = contest.seen(&probable.minimum.parameters).unwrap();
    let problem = contest.problem(&seen);
    let likelihood = |chi_square: f64| -0.5 * chi_square;
    let found = evidence(&problem, &probable, &likelihood).unwrap();
    let svd = ScaledDecomposition::new(&probable.minimum.linearisation, &prior.deviation).unwrap();
    let factor = cholesky(&covariance(&principal_axes(&svd, &prior.deviation))).unwrap();
    let volume: f64 = factor
        .iter()
        .zip(&prior.deviation)
        .map(|(row, s)| (row.last().unwrap() / s).ln() - 0.5 * std::f64::consts::TAU.ln())
        .sum();
    let by_grid = volume
        + ln_sum(&Integrand {
            problem: &problem,
            ln_likelihood: &likelihood,
            centre: &probable.minimum.parameters,
            factor,
        });
    (found.ln, by_grid)
}

/// Laws of two and three parameters, where the data determine them and where they do not.
#[test]
fn r01_the_evidence_is_that_of_a_grid() {
    let maxwell = Maxwell::new(1.5e6).unwrap();
    let norton = MaxwellNorton::from_reference_rate(2.0, 12.0, 10e6).unwrap();
    let data = [
        test_of(&maxwell, 0.01, 1),
        test_of(&norton, 0.01, 2),
        // nothing to be seen of a damping: what is left of a relaxation time is the prior beyond a
        // bound
        test_of(&Elastic, 0.02, 3),
    ];
    let mut off = Vec::new();
    for (number, test) in data.into_iter().enumerate() {
        let test = [test];
        for candidate in Candidate::standard() {
            let parameters = candidate.model().parameter_names().len();
            if !(2..=3).contains(&parameters) {
                continue;
            }
            let (found, expected) = both(&candidate, &test);
            if (found - expected).abs() > 0.1 {
                off.push((number, candidate.name().to_owned(), found, expected));
            }
        }
    }
    assert!(off.is_empty(), "{off:#?}");
}
