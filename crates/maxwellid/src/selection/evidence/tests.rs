//! Comparison of ln Z with sums over a grid, which do not assume a normal density.

use rodwave::inelastic::{Elastic, Maxwell, MaxwellNorton};

use super::{
    Integrand, Proposal, Sample, cholesky, covariance, evidence, ln_mean, principal_axes,
    recurrence_steps, solved, t4_quantile,
};
use crate::catalogue::Law;
use crate::least_squares::{LeastSquares, ScaledDecomposition};
use crate::selection::posterior::{Posterior, PosteriorProblem};
use crate::selection::tests::test_of;
use crate::selection::{Candidate, Contest, Ground};
use crate::test::RodTest;

/// Step h of the grid in the coordinates of [`Integrand`]. The error of the sum over a normal
/// density is exp(-2π²/h²), which is negligible for all these steps; peaks of other shapes need the
/// shorter ones.
fn step_of(axes: usize, is_linear: bool) -> f64 {
    match (axes, is_linear) {
        (0..=2, _) => 0.2,
        // the response of a linear law is computed fast
        (_, true) => 0.3,
        (_, false) => 0.5,
    }
}

/// Logarithm of the sum over the grid, from the peak outwards as long as points contribute.
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
                // the omitted points are about 1e-4 of the sum
                if share > 1e-5 {
                    sum += share;
                    edge.push(next);
                }
            }
        }
    }
    top + f64::ln(sum) + axes as f64 * width.ln()
}

/// Calls `with` with the problem of a candidate about its most probable parameters; the mean of ln
/// E in its prior is moved by `by` of its standard deviations.
fn about_the_peak<R>(
    candidate: &Candidate,
    tests: &[RodTest],
    by: f64,
    with: impl FnOnce(&PosteriorProblem<'_>, &Posterior, Vec<Vec<f64>>) -> R,
) -> R {
    let ground = Ground::of(tests).unwrap();
    let mut prior = candidate.prior(ground.modulus, ground.duration);
    prior.mean[0] += by * prior.deviation[0];
    let contest = Contest::of(candidate, &prior, (tests, &ground.times), 8e-3);
    let found = contest.search(ground.modulus, ground.duration, &[]);
    let probable = found.unwrap().unwrap().probable;
    let seen = contest.seen(&probable.minimum.parameters).unwrap();
    let svd = ScaledDecomposition::new(&probable.minimum.linearisation, &prior.deviation).unwrap();
    let factor = cholesky(&covariance(&principal_axes(&svd, &prior.deviation))).unwrap();
    with(&contest.problem(&seen), &probable, factor)
}

/// ln Z of a candidate by importance sampling, by the grid, and by Laplace's method.
fn each(candidate: &Candidate, tests: &[RodTest]) -> [f64; 3] {
    with_prior_moved(candidate, tests, 0.0)
}

/// [`each`] with the mean of ln E in the prior moved by `by` of its standard deviations.
fn with_prior_moved(candidate: &Candidate, tests: &[RodTest], by: f64) -> [f64; 3] {
    about_the_peak(candidate, tests, by, |problem, probable, factor| {
        let likelihood = |chi_square: f64| -0.5 * chi_square;
        let found = evidence(problem, probable, (&likelihood, 0.1)).unwrap();
        let deviations = &problem.prior.deviation;
        let volume: f64 = factor
            .iter()
            .zip(deviations)
            .map(|(row, s)| (row.last().unwrap() / s).ln() - 0.5 * std::f64::consts::TAU.ln())
            .sum();
        let by_grid = volume
            + ln_sum(&Integrand {
                problem,
                ln_likelihood: &likelihood,
                centre: &probable.minimum.parameters,
                factor,
            });
        let laplace = probable.ln_evidence(likelihood(probable.chi_square));
        [found.ln, by_grid, laplace]
    })
}

/// Compares three values of ln Z for one parameter that the data determine: its posterior is nearly
/// normal over its standard error, 1e-4 in ln E, so that Laplace's method is exact.
#[test]
fn laplace_has_the_evidence_of_a_normal_posterior() {
    for seed in 3..6 {
        let test = [test_of(&Elastic, 0.005, seed)];
        let [found, by_grid, laplace] = each(&Candidate::of(Law::Elastic), &test);
        assert!((laplace - by_grid).abs() < 0.01, "{laplace} {by_grid}");
        assert!((found - by_grid).abs() < 0.05, "{found} {by_grid}");
    }
}

/// Checks, where the data determine E, that a prior whose mean is off by two standard deviations
/// reduces ln Z by 2²/2 = 2 in all three computations.
#[test]
fn a_prior_that_is_off_costs_half_its_square() {
    let test = [test_of(&Elastic, 0.005, 3)];
    let elastic = Candidate::of(Law::Elastic);
    let plain = with_prior_moved(&elastic, &test, 0.0);
    for by in [-2.0, 2.0] {
        let moved = with_prior_moved(&elastic, &test, by);
        for (plain, moved) in plain.iter().zip(moved) {
            // tolerance: the prior mean from the time of flight is already off by a fiftieth of the
            // standard deviation of the prior
            assert!((moved - plain + 2.0).abs() < 0.1, "{plain} {moved}");
        }
    }
}

/// Compares the evidence of all candidates with this many parameters, for data that determine the
/// parameters and for data that do not.
fn assert_as_by_a_grid(parameters: usize) {
    let maxwell = Maxwell::new(1.5e6).unwrap();
    let norton = MaxwellNorton::from_reference_rate(2.0, 12.0, 10e6).unwrap();
    let data = [
        test_of(&maxwell, 0.01, 1),
        test_of(&norton, 0.01, 2),
        // no damping is visible: the data exclude only relaxation times below a bound
        test_of(&Elastic, 0.02, 3),
    ];
    let mut off = Vec::new();
    for (number, test) in data.into_iter().enumerate() {
        let test = [test];
        for candidate in Candidate::standard() {
            if candidate.model().parameter_names().len() != parameters {
                continue;
            }
            let [found, expected, _] = each(&candidate, &test);
            if (found - expected).abs() > 0.1 {
                off.push((number, candidate.name().to_owned(), found, expected));
            }
        }
    }
    assert!(off.is_empty(), "{off:#?}");
}

#[test]
fn r01_the_evidence_of_two_parameters_is_that_of_a_grid() {
    assert_as_by_a_grid(2);
}

#[test]
fn r01_the_evidence_of_three_parameters_is_that_of_a_grid() {
    assert_as_by_a_grid(3);
}

/// Compares the quantiles with Student's t with four degrees of freedom of `statrs`.
#[test]
fn quantiles_are_those_of_students_t() {
    use statrs::distribution::{ContinuousCDF, StudentsT};
    let student = StudentsT::new(0.0, 1.0, 4.0).unwrap();
    for p in [1e-6, 0.01, 0.3, 0.5, 0.75, 0.99, 1.0 - 1e-6] {
        let back = student.cdf(t4_quantile(p));
        assert!((back - p).abs() < 1e-9 * p.max(0.01), "{p} {back}");
    }
}

#[test]
fn a_factor_times_its_transpose_is_the_matrix_that_it_solves() {
    let axes = [
        vec![2.0, 0.5, 0.1],
        vec![0.0, 1.0, -0.4],
        vec![0.3, 0.0, 0.7],
    ];
    let matrix = covariance(&axes);
    let factor = cholesky(&matrix).unwrap();
    let entry =
        |i: usize, j: usize| -> f64 { factor[i].iter().zip(&factor[j]).map(|(a, b)| a * b).sum() };
    for i in 0..3 {
        for j in 0..3 {
            let of_axes: f64 = axes.iter().map(|axis| axis[i] * axis[j]).sum();
            assert!((matrix[i][j] - of_axes).abs() < 1e-12);
            assert!((entry(i, j) - matrix[i][j]).abs() < 1e-12, "{i} {j}");
        }
    }
    let x = [1.0, -2.0, 3.0];
    let product = |row: &Vec<f64>| row.iter().zip(&x).map(|(l, x)| l * x).sum();
    let b: Vec<f64> = factor.iter().map(product).collect();
    for (found, expected) in solved(&factor, &b).iter().zip(x) {
        assert!((found - expected).abs() < 1e-12);
    }
    assert!(cholesky(&[vec![1.0, 2.0], vec![2.0, 4.0]]).is_none());
    assert!(cholesky(&[vec![1.0, 2.0], vec![2.0, 3.0]]).is_none());
}

/// Checks the weights 1 and 3, whose mean is 2 with the relative variance (20/16 - 1)/2.
#[test]
fn the_mean_of_weights_has_the_error_of_their_scatter() {
    let (ln, error) = ln_mean(&[700.0, 700.0 + 3_f64.ln()]);
    assert!((ln - 700.0 - 2_f64.ln()).abs() < 1e-12 && (error - 0.125_f64.sqrt()).abs() < 1e-12);
    assert_eq!(
        ln_mean(&[f64::NEG_INFINITY; 2]),
        (f64::NEG_INFINITY, f64::INFINITY)
    );
}

/// Checks that the first step is the inverse of the golden ratio for one axis and of the plastic
/// number for two.
#[test]
fn points_of_one_axis_follow_the_golden_ratio() {
    assert!((recurrence_steps(1)[0] - 0.618_033_988_749_895).abs() < 1e-12);
    let two = recurrence_steps(2);
    assert!(
        (two[0] - 0.754_877_666_246_693).abs() < 1e-12 && (two[1] - two[0] * two[0]).abs() < 1e-12
    );
}

fn skewed() -> Proposal {
    Proposal {
        centre: vec![0.5, -1.0],
        factor: vec![vec![1.5], vec![0.6, 0.8]],
        scales: vec![[1.0, 2.0], [0.5, 1.0]],
    }
}

/// Checks that the density of a proposal integrates to one and that its points are distributed
/// accordingly: along the first axis, with scales 1 and 2, a third of them are below the centre.
#[test]
fn points_of_a_proposal_are_distributed_by_its_density() {
    let proposal = skewed();
    let width = 0.1;
    let (mut all, mut below) = (0.0, 0.0);
    for i in -600..600 {
        for j in -600..600 {
            let z = [width * (f64::from(i) + 0.5), width * (f64::from(j) + 0.5)];
            let share = width * width * proposal.ln_density(&z).exp();
            all += share;
            below += if z[0] < 0.5 { share } else { 0.0 };
        }
    }
    // tolerance: about 1e-5 of t with four degrees of freedom is beyond ±60
    assert!((all - 1.0).abs() < 1e-3, "{all}");
    assert!((below - 1.0 / 3.0).abs() < 1e-3, "{below}");
    let steps = recurrence_steps(2);
    let points: Vec<Vec<f64>> = (0..3000)
        .map(|index| proposal.point(index, &steps))
        .collect();
    let share = |is_in: &dyn Fn(&[f64]) -> bool| {
        points.iter().filter(|z| is_in(z)).count() as f64 / points.len() as f64
    };
    // tolerance: evenly spread points have an error of about a thousandth
    assert!((share(&|z| z[0] < 0.5) - 1.0 / 3.0).abs() < 2e-3);
    // half of the points on each side are within 0.741, the quartile of t, times the scale of that
    // side
    let quartile = t4_quantile(0.75);
    let within = share(&|z| z[0] > 0.5 - 1.5 * quartile && z[0] < 0.5 + 3.0 * quartile);
    assert!((within - 0.5).abs() < 2e-3, "{within}");
    // along the second axis of the factor, with scales 0.5 and 1, also a third of the points are
    // below the centre
    let along = |z: &[f64]| solved(&proposal.factor, &[z[0] - 0.5, z[1] + 1.0])[1];
    assert!((share(&|z| along(z) < 0.0) - 1.0 / 3.0).abs() < 2e-3);
    let row = proposal.covariances(1).unwrap();
    assert!((row[0] - 0.9).abs() < 1e-12 && (row[1] - 1.0).abs() < 1e-12);
}

/// Checks that points are weighted against the mixture of all proposals: if the integrand is twice
/// that mixture, every weight is two.
#[test]
fn weights_are_ratios_to_the_mixture_of_proposals() {
    let proposals = [
        (300.0, skewed()),
        (100.0, Proposal::about_the_centre(vec![[1.0; 2]; 2])),
    ];
    let steps = recurrence_steps(2);
    let points: Vec<Vec<f64>> = (0..50)
        .map(|index| proposals[0].1.point(index, &steps))
        .collect();
    let mixture = |z: &Vec<f64>| {
        0.75 * proposals[0].1.ln_density(z).exp() + 0.25 * proposals[1].1.ln_density(z).exp()
    };
    let sample = Sample {
        ln_values: points.iter().map(|z| (2.0 * mixture(z)).ln()).collect(),
        proposals: proposals.to_vec(),
        points,
    };
    for weight in sample.ln_weights() {
        assert!((weight - 2_f64.ln()).abs() < 1e-12, "{weight}");
    }
}

/// Checks that a normal posterior has its standard deviation as the scale on either side, and no
/// ridge, and that there is a ridge where the data do not determine a share.
#[test]
fn proposals_follow_a_posterior_where_it_is_wider_than_its_normal() {
    let likelihood = |chi_square: f64| -0.5 * chi_square;
    let maxwell = Candidate::of(Law::Maxwell);
    let test = [test_of(&Maxwell::new(1.5e6).unwrap(), 0.002, 1)];
    about_the_peak(&maxwell, &test, 0.0, |problem, probable, factor| {
        let integrand = Integrand {
            problem,
            ln_likelihood: &likelihood,
            centre: &probable.minimum.parameters,
            factor,
        };
        for scale in integrand.scales().iter().flatten() {
            // tolerance: the relaxation time is known to some per cent, and the posterior of its
            // logarithm is normal to the same accuracy
            assert!((0.9..1.2).contains(scale), "{scale}");
        }
        assert!(integrand.ridges().is_empty());
    });
    // two branches for data of one branch: the data do not determine the share of the second one
    let test = [test_of(&Maxwell::new(1.5e6).unwrap(), 0.01, 1)];
    let two = Candidate::of(Law::TwoMaxwellBranches);
    about_the_peak(&two, &test, 0.0, |problem, probable, factor| {
        let axes = factor.len();
        let integrand = Integrand {
            problem,
            ln_likelihood: &likelihood,
            centre: &probable.minimum.parameters,
            factor,
        };
        let top = integrand.at(&vec![0.0; axes]);
        let ridges = integrand.ridges();
        assert!(!ridges.is_empty());
        for ridge in &ridges {
            assert!(top - integrand.at(&ridge.centre) < 3.0);
        }
        let first = Proposal::about_the_centre(vec![[1.0; 2]; axes]);
        let mut followed = 0;
        for (axis, sign) in (0..axes).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let Some(next) = integrand.next_on_ridge(&first, axis, sign) else {
                continue;
            };
            // the first step is three standard deviations, each 1 at the centre, along the axis
            let along = next.centre[axis];
            assert!((along - 3.0 * sign).abs() < 1e-9, "{along}");
            let Some(after) = integrand.next_on_ridge(&next, axis, sign) else {
                continue;
            };
            let variance = next.covariances(axis).unwrap()[axis];
            let moved = after.centre[axis] - along;
            assert!((moved - 3.0 * sign * variance.sqrt()).abs() < 1e-9);
            followed += 1;
        }
        assert!(followed > axes, "{followed}");
        // with proposals along the ridges, the error is below the requested 0.1
        let found = evidence(problem, probable, (&likelihood, 0.1)).unwrap();
        assert!(found.error < 0.1, "{found:?}");
    });
    // without visible damping, the data exclude high rates and no low rates
    let test = [test_of(&Elastic, 0.02, 3)];
    let gurevich = Candidate::of(Law::GurevichRabinovich);
    about_the_peak(&gurevich, &test, 0.0, |problem, probable, factor| {
        let centre = &probable.minimum.parameters;
        let integrand = Integrand {
            problem,
            ln_likelihood: &likelihood,
            centre,
            factor,
        };
        let [below, above] = integrand.scales()[2];
        let [down, up] = [-1.0, 1.0].map(|z| integrand.at(&[0.0, 0.0, z]));
        assert!(up < down - 1.0 && above < 0.5 * below, "{below} {above}");
        // the model does not exist beyond its bounds, on either side
        for bound in [problem.bounds()[0].0 - 0.1, problem.bounds()[0].1 + 0.1] {
            let z = (bound - centre[0]) / integrand.factor[0][0];
            assert!(integrand.at(&[z, 0.0, 0.0]) == f64::NEG_INFINITY);
        }
    });
}

/// Checks that the sampling of an integrand a hundred times as narrow as every proposal ends at the
/// largest number of points, with a large error.
#[test]
fn an_integrand_that_no_proposal_meets_ends_with_a_large_error() {
    let test = [test_of(&Maxwell::new(1.5e6).unwrap(), 0.01, 1)];
    let likelihood = |chi_square: f64| -5e3 * chi_square;
    about_the_peak(
        &Candidate::of(Law::Norton),
        &test,
        0.0,
        |problem, probable, _| {
            let found = evidence(problem, probable, (&likelihood, 0.1)).unwrap();
            assert!(found.error > 0.1, "{found:?}");
        },
    );
}
