use super::*;
use crate::{ContactEnd, ForceBand, ForceHistory, ImpactForce, separate};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

const STEP_HZ: f64 = 200.0;
const N_LINES: usize = 257;
const VELOCITY: f64 = 1.5;
const MASS: f64 = 0.3;
const IMPEDANCE: f64 = 900.0;

/// A mass behind a spring and a dashpot, and a long rod: the contact ends.
fn sprung_mass() -> (Vec<Complex64>, Vec<Complex64>) {
    let body = (0..N_LINES).map(|k| {
        let s = Complex64::new(0.0, TAU * STEP_HZ * k as f64);
        1.0 / (s * MASS) + s / 2e6 + 1e-4
    });
    (body.collect(), vec![(1.0 / IMPEDANCE).into(); N_LINES])
}

/// Errors of the lines, as a fraction of the sum of the mobilities.
fn variance(bodies: &(Vec<Complex64>, Vec<Complex64>), part: f64) -> Vec<f64> {
    let lines = bodies.0.iter().zip(&bodies.1);
    let mut lines: Vec<f64> = lines
        .map(|(a, b)| (part * (a + b).norm()).powi(2))
        .collect();
    lines[0] = f64::NAN; // not read
    lines
}

fn problem(bodies: &(Vec<Complex64>, Vec<Complex64>), zero_line: ZeroLine) -> StickProblem<'_> {
    StickProblem {
        first: &bodies.0,
        second: &bodies.1,
        frequency_step_hz: STEP_HZ,
        impact_velocity: VELOCITY,
        zero_line,
        roll_off_from_hz: Some(25e3),
        interpolation: 1,
        until: None,
    }
}

#[test]
fn linear_propagation_and_draws_agree() {
    let bodies = sprung_mass();
    let variance = variance(&bodies, 0.05);
    let n_draws = 1500;
    for zero_line in [ZeroLine::EffectiveMass(MASS), ZeroLine::QuietBeforeContact] {
        let problem = problem(&bodies, zero_line);
        let uncertainty = StickUncertainty {
            first_variance: Some(&variance),
            second_variance: None,
            first_scale: 0.01,
            second_scale: 0.02,
            first_delay: 1e-6,
            second_delay: 1e-6,
            impact_velocity: 0.02,
            effective_mass: 0.003,
        };
        let linear = problem.error(&uncertainty).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(41);
        let drawn = uncertainty
            .monte_carlo(&problem, 20.0, n_draws, &mut random)
            .unwrap();
        let stick = problem.solve().unwrap();
        let peak = stick.history.peak().force;
        let pairs = linear.standard_error().iter().zip(&drawn.stick_deviation);
        for (n, (linear, drawn)) in pairs.enumerate() {
            // tolerance: four times 1/sqrt(2*1500) = 1.8 %, and effects of second order, which are
            // of the size of the squared error of 5 %
            assert!((drawn / linear - 1.0).abs() < 0.08, "{n}: {drawn} {linear}");
        }
        for (mean, force) in drawn.stick_mean.iter().zip(stick.history.force()) {
            // tolerance: four times the standard error of a mean, and the effects of second order
            assert!((mean - force).abs() < 0.01 * peak, "{mean} {force}");
        }

        let impact = separate(&stick.history, 20.0).unwrap();
        let end = linear.contact_end(&stick.history, &impact).unwrap();
        assert_eq!(end.verdict, EndVerdict::Linear);
        // mean of the ends; a claim compares their scatter with the standard error
        let ends = &drawn.contact_ends;
        let mean = ends.iter().sum::<f64>() / ends.len() as f64;
        assert!(
            (mean - end.time).abs() < 0.3 * end.standard_error,
            "{mean} {end:?}"
        );

        // fraction of the samples of all drawn histories inside the band
        let band = linear.pointwise(&stick.history, 0.95).unwrap();
        let band = contact_band(&band, &impact);
        let n_samples = stick.history.force().len();
        let inside: f64 = drawn
            .impact_forces
            .iter()
            .map(|force| band.part_inside(force, 0..n_samples))
            .sum();
        let inside = inside / f64::from(1500);
        // samples outside the contact, where force and band are zero, count as inside; during the
        // contact 95 % are inside
        assert!(inside > 0.95, "{inside}");
        let contact = 0..stick.history.index_near(0.5 * end.time).unwrap();
        let begin = stick.history.index_near(0.0).unwrap() + 1;
        let inside: f64 = drawn
            .impact_forces
            .iter()
            .map(|force| band.part_inside(force, begin..contact.end))
            .sum();
        let inside = inside / f64::from(1500);
        // tolerance: three times 0.7 %; the errors of the scales are common to the whole contact,
        // so that the fraction scatters as that of about 1000 independent draws
        assert!((inside - 0.95).abs() < 0.02, "{inside}");
        let by_draws = drawn.contact_band(0.95).unwrap();
        let at = stick.history.index_near(0.5 * end.time).unwrap();
        // tolerance: the distance of the 2.5 % and 97.5 % quantiles of 1500 draws has an error of 7
        // %
        let width = |band: &ForceBand| band.upper[at] - band.lower[at];
        let ratio = width(&by_draws) / width(&band);
        assert!((ratio - 1.0).abs() < 0.15, "{ratio}");

        // lists of different lengths are refused
        let mut cut = drawn;
        cut.impact_forces[1].truncate(3);
        let refused = cut.contact_band(0.95).unwrap_err();
        assert!(
            matches!(refused, ImpulseError::LengthMismatch { found: 3, .. }),
            "{refused}"
        );
    }
}

/// Compares the effect of each delay with a finite difference of the force; a claim does so for the
/// other common causes.
#[test]
fn delays_act_as_differences_of_the_force_say() {
    let bodies = sprung_mass();
    let base = problem(&bodies, ZeroLine::EffectiveMass(MASS));
    // a delay of a nanosecond turns the last line by 3e-4 rad
    let small = 1e-9;
    let late = |of: &[Complex64]| -> Vec<Complex64> {
        let lines = of.iter().enumerate();
        let phase = |line: usize| TAU * STEP_HZ * line as f64 * small;
        lines
            .map(|(line, g)| g * Complex64::from_polar(1.0, -phase(line)))
            .collect()
    };
    let none = StickUncertainty::default();
    let cases = [
        (
            (late(&bodies.0), bodies.1.clone()),
            StickUncertainty {
                first_delay: small,
                ..none
            },
        ),
        (
            (bodies.0.clone(), late(&bodies.1)),
            StickUncertainty {
                second_delay: small,
                ..none
            },
        ),
    ];
    let force = base.solve().unwrap().history;
    for (index, (changed, uncertainty)) in cases.iter().enumerate() {
        let changed = problem(changed, base.zero_line).solve().unwrap().history;
        let error = base.error(uncertainty).unwrap();
        let largest = error.standard_error().iter().copied().fold(0.0, f64::max);
        assert!(largest > 0.0);
        for (n, error) in error.standard_error().iter().enumerate() {
            let difference = (changed.force()[n] - force.force()[n]).abs();
            // tolerance: effects of second order, 1e-6, and rounding of the forces divided by their
            // difference
            assert!((difference - error).abs() < 1e-4 * largest, "{index} {n}");
        }
    }
}

fn history(force: &[f64]) -> (ForceHistory, ImpactForce) {
    let stick = ForceHistory::new(0.0, 1e-3, force.to_vec()).unwrap();
    let impact = separate(&stick, 0.0).unwrap();
    (stick, impact)
}

#[test]
fn an_end_is_flagged_where_it_is_not_linear() {
    let line: Vec<f64> = (0..40).map(|n| 105.0 - 5.0 * f64::from(n)).collect();
    let (stick, impact) = history(&line);
    let error = ForceError::none(40).with_common(vec![10.0; 40]);
    let end = error.contact_end(&stick, &impact).unwrap();
    // 10 N divided by 5 N/ms
    assert!((end.standard_error - 2e-3).abs() < 1e-12);
    assert_eq!(end.verdict, EndVerdict::Linear);

    // a curvature of 0.05 N/ms^2 changes the force by 0.8 N at two standard errors, 4 ms, from the
    // end: small compared with its standard error of 10 N. Ten times this curvature is flagged.
    for (curvature, is_linear) in [(0.05, true), (0.5, false)] {
        let bent: Vec<f64> = (0..40)
            .map(|n| {
                let t = f64::from(n) - 20.5;
                -5.0 * t - curvature * t * t
            })
            .collect();
        // from the maximum on, so that the contact has no minimum inside
        let from = if is_linear { 0 } else { 16 };
        let (stick, impact) = history(&bent[from..]);
        let error = ForceError::none(bent.len() - from).with_common(vec![10.0; bent.len() - from]);
        let end = error.contact_end(&stick, &impact).unwrap();
        assert_eq!(end.verdict == EndVerdict::Linear, is_linear, "{end:?}");
    }

    let mut graze = line;
    for (n, force) in [(3, 60.0), (4, 12.0), (5, 60.0)] {
        graze[n] = force;
    }
    let (stick, impact) = history(&graze);
    let end = error.contact_end(&stick, &impact).unwrap();
    let EndVerdict::MayEndEarlier { time, probability } = end.verdict else {
        panic!("{end:?}")
    };
    // one tail of a normal distribution beyond 1.2 standard deviations
    assert!((time - 4e-3).abs() < 1e-9 && (probability - 0.11507).abs() < 1e-5);

    let (stick, impact) = history(&[1.0, 2.0, 3.0]);
    assert_eq!(impact.end, ContactEnd::InContact);
    let error = ForceError::none(3).with_common(vec![1.0; 3]);
    assert!(error.contact_end(&stick, &impact).is_none());
}

#[test]
fn errors_that_cannot_be_are_refused() {
    let bodies = sprung_mass();
    let problem = problem(&bodies, ZeroLine::EffectiveMass(MASS));
    let mut negative = vec![0.0; N_LINES];
    negative[7] = -1.0;
    let short = vec![0.0; 3];
    let none = StickUncertainty::default();
    let refused =
        |uncertainty: StickUncertainty<'_>| problem.error(&uncertainty).unwrap_err().to_string();
    assert_eq!(
        refused(StickUncertainty {
            first_variance: Some(&negative),
            ..none
        }),
        "variance of a mobility [(m/(N s))^2] is -1, expected a finite value, 0 or above"
    );
    assert_eq!(
        refused(StickUncertainty {
            second_variance: Some(&short),
            ..none
        }),
        "the variance of the second mobility has 3 elements, expected 257"
    );
    assert_eq!(
        refused(StickUncertainty {
            impact_velocity: f64::NAN,
            ..none
        }),
        "standard error of the impact velocity [m/s] is NaN, expected a finite value, 0 or above"
    );
    let mut random = ChaCha8Rng::seed_from_u64(1);
    assert!(none.monte_carlo(&problem, 0.0, 10, &mut random).is_err());
}

#[test]
fn impulses_and_ends_of_draws_have_their_scatter() {
    let mut draws = MonteCarlo {
        stick_mean: vec![0.0; 2],
        stick_deviation: vec![0.0; 2],
        // impulses of 1.5, 2.5 and 3.5 N s
        impact_forces: vec![vec![1.0, 2.0], vec![3.0, 2.0], vec![2.0, 5.0]],
        contact_ends: (0..101).map(f64::from).collect(),
        time_step: 0.5,
        without_end: 0,
    };
    assert_eq!(draws.impulse_deviation(), Some(1.0));
    assert_eq!(draws.contact_end_limits(0.9).unwrap(), Some([5.0, 95.0]));
    assert!(draws.contact_end_limits(1.0).is_err());
    draws.without_end = 1;
    draws.contact_ends.clear();
    assert_eq!(draws.impulse_deviation(), None);
    assert_eq!(draws.contact_end_limits(0.9).unwrap(), None);
}
