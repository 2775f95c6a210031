use super::*;
use crate::branch::observation::{FreeEnd, PhaseObservation};

fn state(gamma: Complex64) -> State {
    State {
        gamma,
        slope: Complex64::new(0.0, 1e-3),
        variance: 0.02,
        covariance: 0.0,
        slope_variance: 2e-8,
    }
}

fn course(state: State, log_weight: f64) -> Course {
    Course {
        state,
        log_weight,
        last: None,
    }
}

fn relative(a: f64, b: f64) -> f64 {
    (a / b - 1.0).abs()
}

#[test]
fn logarithms_are_added_as_their_numbers_are() {
    for (a, b) in [(0.0, 0.0), (-1.0, 2.0), (2.0, -1.0), (-0.3, -0.2)] {
        let (a, b): (f64, f64) = (a, b);
        assert!((log_sum(a, b) - (a.exp() + b.exp()).ln()).abs() < 1e-14);
    }
    // e^-2000 and e^-3000 underflow to 0
    assert!((log_sum(-2000.0, -2000.0) - (LN_2 - 2000.0)).abs() < 1e-12);
    assert!((log_sum(-2000.0, -3000.0) + 2000.0).abs() < 1e-12);
}

#[test]
fn an_impossible_course_stands_lower() {
    // standard errors of 0.1 of α and k, 0.2 of their difference, and 1e-4 of dk/dω
    let at = |alpha: f64, k: f64, slope: f64| {
        let mut state = state(Complex64::new(alpha, k));
        state.slope.im = slope;
        course(state, -1.5).standing()
    };
    assert!((at(0.3, 5.0, 1e-3) + 1.5).abs() < 1e-12);
    assert!((at(0.0, 5.0, 0.0) + 1.5).abs() < 1e-12);
    // two standard errors below 0 cost 2 in each quantity
    assert!((at(-0.2, 5.0, 1e-3) + 3.5).abs() < 1e-9);
    assert!((at(5.4, 5.0, 1e-3) + 3.5).abs() < 1e-9);
    assert!((at(0.3, 5.0, -2e-4) + 3.5).abs() < 1e-9);
    // the costs of the three quantities are added; the cost of one quantity is limited to that of
    // eight standard errors below 0
    assert!((at(-0.2, -0.6, -2e-4) + 1.5 + 6.0).abs() < 1e-9);
    assert!((at(-7.0, 5.0, 1e-3) + 1.5 + 32.0).abs() < 1e-9);
}

pub(in crate::branch) fn line_at(
    omega: f64,
    length: f64,
    observed: Complex64,
    variance: f64,
) -> LineAt<'static> {
    let sight = Sight {
        observation: &FreeEnd,
        length,
        observed,
        variance,
    };
    LineAt {
        omega,
        missing: false,
        sight,
    }
}

fn line(omega: f64, root: Complex64, variance: f64) -> LineAt<'static> {
    line_at(omega, 2.0, FreeEnd.expand(root)[0], variance)
}

#[test]
fn a_line_determines_its_roots_where_they_are_far_apart() {
    // |Ψ'|²/(2|Ψ''|), or |Ψ'| where that is less, divided by six standard deviations of the noise
    let of = |root: Complex64, sigma: f64| {
        let [_, slope, curvature] = FreeEnd.expand(root);
        let distance = (slope.norm_sqr() / (2.0 * curvature.norm())).min(slope.norm());
        distance / (6.0 * sigma)
    };
    for root in [
        Complex64::new(0.1, 0.4),
        Complex64::new(0.05, 1.5),
        Complex64::new(0.3, 2.9),
    ] {
        let line = line(1000.0, root, 1e-4);
        assert!(relative(line.determination_at(root), of(root, 1e-2)) < 1e-12);
    }
    // The root with the lowest phase between 0 and π is used.
    let root = Complex64::new(0.05, 0.6);
    let found = line(1000.0, root, 1e-4).determination();
    assert!(relative(found, of(root, 1e-2)) < 1e-9, "{found}");
}

#[test]
fn courses_that_have_run_together_are_one() {
    let gamma = Complex64::new(0.3, 5.0);
    // the variances are 0.02 and 2e-8, so courses are merged if γ differs by less than 0.0707 and
    // the slope by less than 7.07e-5
    let merged = |other: State, weights: (f64, f64)| {
        let mut courses = Courses {
            alive: vec![course(state(gamma), weights.0), course(other, weights.1)],
            ..Courses::default()
        };
        courses.merge();
        courses.alive
    };
    let near = state(gamma + Complex64::new(0.042, 0.056));
    let one = merged(near, (-1.0, -2.0));
    assert_eq!(one.len(), 1);
    assert!((one[0].state.gamma - gamma).norm() < 1e-15);
    assert!((one[0].log_weight - ((-1.0_f64).exp() + (-2.0_f64).exp()).ln()).abs() < 1e-12);
    // the state of the course with the larger weight is kept
    let one = merged(near, (-2.0, -1.0));
    assert!((one[0].state.gamma - near.gamma).norm() < 1e-15);
    assert_eq!(
        merged(state(gamma + Complex64::new(0.0, 0.072)), (-1.0, -2.0)).len(),
        2
    );
    let mut other_slope = near;
    other_slope.slope.im += 7.2e-5;
    assert_eq!(merged(other_slope, (-1.0, -2.0)).len(), 2);
    other_slope.slope.im -= 0.4e-5;
    assert_eq!(merged(other_slope, (-1.0, -2.0)).len(), 1);
    // the distance is relative to the smaller of the two variances
    let mut surer = near;
    surer.variance = 0.01;
    assert_eq!(merged(surer, (-1.0, -2.0)).len(), 2);
    surer = near;
    surer.slope_variance = 1e-10;
    surer.slope.im += 1e-5;
    assert_eq!(merged(surer, (-1.0, -2.0)).len(), 2);
}

#[test]
fn courses_that_have_become_negligible_are_given_up() {
    let at = |k: f64, log_weight: f64| course(state(Complex64::new(0.3, k)), log_weight);
    let mut courses = Courses {
        alive: vec![at(9.0, -30.1), at(5.0, -7.0), at(7.0, -29.9)],
        ..Courses::default()
    };
    courses.give_up();
    let kept: Vec<f64> = courses.alive.iter().map(|c| c.state.gamma.im).collect();
    assert_eq!(kept, [5.0, 7.0]);
    assert!(courses.crowded_out.abs() < 1e-300);
    // beyond the maximum number, the courses of the lowest weight are dropped, and their
    // probability is stored
    let many: Vec<Course> = (0..MOST_COURSES + 512)
        .map(|n| {
            let k = 5.0 + n as f64;
            at(k, if n < 512 { -LN_2 } else { 0.0 })
        })
        .collect();
    courses.alive = many;
    courses.give_up();
    assert_eq!(courses.alive.len(), MOST_COURSES);
    assert!(courses.alive.iter().all(|c| c.log_weight > -0.1));
    assert!(relative(courses.crowded_out, 256.0 / (256.0 + 2048.0)) < 1e-12);
}

#[test]
fn weights_are_probabilities_in_the_end() {
    let at = |k: f64, log_weight: f64| course(state(Complex64::new(0.3, k)), log_weight);
    let mut courses = Courses {
        alive: vec![at(5.0, -700.0), at(7.0, -699.0), at(9.0, -702.0)],
        ..Courses::default()
    };
    courses.normalise();
    let sum: f64 = courses.alive.iter().map(|c| c.log_weight.exp()).sum();
    assert!((sum - 1.0).abs() < 1e-12);
    let order: Vec<f64> = courses.alive.iter().map(|c| c.state.gamma.im).collect();
    assert_eq!(order, [7.0, 5.0, 9.0]);
    assert!((courses.alive[0].log_weight - courses.alive[1].log_weight - 1.0).abs() < 1e-9);
}

#[test]
fn the_excess_is_the_median_misfit_of_the_best_course() {
    let mut courses = Courses::default();
    assert_eq!(courses.excess().0, 0);
    let mut state = state(Complex64::new(0.3, 5.0));
    state.variance = 0.0;
    let mut last = None;
    let mut expected = Vec::new();
    for (n, deviations) in [0.5, 3.0, 1.0, 2.0, 0.1].into_iter().enumerate() {
        // if γ has no error, the misfit of a line is due to its noise alone
        let mut line = line(1000.0, state.gamma * 2.0, 1e-4);
        line.sight.observed += Complex64::new(0.0, deviations * 1e-2);
        let (passage, _) = state.update(&line.sight, last);
        courses.passages.push(passage);
        last = Some(n);
        expected.push(deviations * deviations);
    }
    courses.passages.push(state.skip(last));
    courses.alive = vec![Course {
        state,
        log_weight: 0.0,
        last: Some(5),
    }];
    let (count, excess) = courses.excess();
    assert_eq!(count, 5);
    expected.sort_by(f64::total_cmp);
    assert!(relative(excess, expected[2] / LN_2) < 1e-9, "{excess}");
}

#[test]
fn courses_begin_at_every_root_with_a_speed_that_is_possible() {
    let root = Complex64::new(0.2, 1.0);
    let (omega, first_omega, length) = (2000.0, 1000.0, 2.0);
    let line = line(omega, root, 1e-8);
    let anchors = Anchors {
        slowest: 500.0,
        fastest: 1e4,
        speed: None,
        known: &[],
    };
    let begun = |anchors: &Anchors<'_>, greatest_transit: f64| {
        let mut courses = Courses::default();
        courses.begin_at(&line, first_omega, greatest_transit, anchors);
        courses.alive
    };
    // phases from 0.4 to 8 rad: 1, 2π - 1 and 2π + 1 are roots, of which the second has the other
    // sign of the damping
    let phases = |courses: &[Course]| -> Vec<f64> {
        let mut phases: Vec<f64> = courses
            .iter()
            .map(|c| c.log_weight)
            .map(|prior| (-prior).exp())
            .collect();
        phases.sort_by(f64::total_cmp);
        phases
    };
    let all = phases(&begun(&anchors, f64::INFINITY));
    let tau = 2.0 * PI;
    assert_eq!(all.len(), 3);
    for (found, expected) in all.iter().zip([1.0, tau - 1.0, tau + 1.0]) {
        assert!(relative(*found, expected) < 1e-6, "{all:?}");
    }
    // a transit time of 3 ms limits the phase to 6 rad, a slowest wave of 600 m/s limits it to 6.67
    // rad
    assert_eq!(begun(&anchors, 3e-3).len(), 2);
    let slower = Anchors {
        slowest: 600.0,
        ..anchors
    };
    assert_eq!(begun(&slower, f64::INFINITY).len(), 2);
    // The course is extrapolated down one octave, to the first line: k/ω increases as causality
    // requires, and the slope is that of a constant loss factor.
    let course = begun(&anchors, f64::INFINITY)
        .into_iter()
        .min_by(|a, b| a.state.gamma.im.total_cmp(&b.state.gamma.im))
        .unwrap();
    let slowness = root / (length * omega);
    let first = slowness + Complex64::new(0.0, 2.0 / PI * slowness.re * LN_2);
    let state = course.state;
    assert!((state.gamma - first * first_omega).norm() < 1e-9);
    let slope = first - Complex64::new(0.0, 2.0 / PI * first.re);
    assert!((state.slope - slope).norm() < 1e-12);
    let share = INITIAL_SPREAD.powi(2) / root.norm_sqr()
        + (DISPERSION.powi(2) + WANDER.powi(2) * LN_2 / 3.0) * LN_2 * LN_2;
    let variance = first.norm_sqr() * share;
    assert!(relative(state.variance, variance * first_omega * first_omega) < 1e-9);
    assert!(relative(state.covariance, variance * first_omega) < 1e-9);
    let of_slope = variance + DISPERSION.powi(2) * first.norm_sqr();
    assert!(relative(state.slope_variance, of_slope) < 1e-9);
}

#[test]
fn a_guessed_speed_weighs_by_its_relative_error() {
    let anchors = Anchors {
        slowest: 500.0,
        fastest: 1e4,
        speed: Some((2000.0, 0.1)),
        known: &[],
    };
    // e^0.2 times the guess is two standard errors away
    let prior = anchors.log_prior_of_speed(2000.0 * 0.2_f64.exp());
    assert!((prior + 2.0).abs() < 1e-12, "{prior}");
    let known = super::super::anchor::KnownWaveNumber {
        omega: 1000.0,
        wave_number: 4.4,
        standard_error: 0.2,
    };
    // k differs from the anchor by 0.6; the variance of the anchor is 0.04, and that of k is half
    // of 0.02
    let likelihood = known.log_likelihood(&state(Complex64::new(0.3, 5.0)));
    assert!((likelihood + 0.5 * 0.36 / 0.05).abs() < 1e-12);
}
