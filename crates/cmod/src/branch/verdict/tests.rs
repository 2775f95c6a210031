use super::*;
use crate::branch::forward;
use crate::branch::observation::{FreeEnd, PhaseObservation};

fn gamma(re: f64, im: f64) -> Complex64 {
    Complex64::new(re, im)
}

fn relative(a: f64, b: f64) -> f64 {
    (a / b - 1.0).abs()
}

fn smoothed_at(gamma: Complex64, variance: f64) -> Smoothed {
    Smoothed { gamma, variance }
}

/// Integrates by Simpson's rule with `n` intervals.
fn simpson<const N: usize>(
    from: f64,
    to: f64,
    n: u32,
    values: impl Fn(f64) -> [f64; N],
) -> [f64; N] {
    let h = (to - from) / f64::from(n);
    let mut sums = [0.0; N];
    for k in 0..=n {
        let weight = match k {
            0 => 1.0,
            k if k == n => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let values = values(from + h * f64::from(k));
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += h / 3.0 * weight * value;
        }
    }
    sums
}

/// Computes the normal distribution function Φ by Simpson's rule from -9, without the error
/// function.
fn normal_distribution(x: f64) -> f64 {
    let [sum] = simpson(-9.0, x, 4000, |t| [(-0.5 * t * t).exp()]);
    sum / (2.0 * PI).sqrt()
}

/// Computes the mean and the variance of a normal variable under the condition that it is positive,
/// by Simpson's rule over the range in which its density is significant.
fn positive_half(mean: f64, spread: f64) -> (f64, f64) {
    let from = 0.0_f64.max(mean - 12.0 * spread);
    let to = (mean + 12.0 * spread).max(3.0 * spread * spread / -mean.min(-spread));
    let moments = simpson(from, to, 20_000, |x| {
        // the exponent is relative to its value at 0, because the density would underflow
        let exponent =
            -0.5 * ((x - mean) / spread).powi(2) + 0.5 * (mean.min(0.0) / spread).powi(2);
        [1.0, x, x * x].map(|power| power * exponent.exp())
    });
    let first = moments[1] / moments[0];
    (first, moments[2] / moments[0] - first * first)
}

#[test]
fn a_damping_that_cannot_be_negative_has_the_moments_of_what_is_left() {
    for (mean, spread) in [
        (0.3, 0.1),
        (0.05, 0.1),
        (0.0, 0.2),
        (-0.1, 0.1),
        (-0.6, 0.2),
        (1.0, 0.3),
    ] {
        let (found, variance) = cut_below_zero(mean, spread);
        let (expected, expected_variance) = positive_half(mean, spread);
        // tolerance: error of Simpson's rule with more than a thousand points per standard error;
        // the variance also loses digits by cancellation
        assert!(
            relative(found, expected) < 1e-8,
            "{mean} {spread}: {found} {expected}"
        );
        assert!(relative(variance, expected_variance) < 1e-6);
    }
    // ten standard errors below 0 the asymptotic expansion is used; tolerance: its next term, 2/a³
    // with a = 10, is 2 % of 1/a
    let (found, variance) = cut_below_zero(-1.0, 0.1);
    assert!(relative(found, 0.1 / 10.0) < 0.05, "{found}");
    assert!((0.0..0.01).contains(&variance));
}

#[test]
fn the_spread_of_a_phase_is_half_the_variance_by_the_length() {
    let smoothed = smoothed_at(gamma(3.0, 7.0), 0.08);
    let phase = Phase::of(&smoothed, 0.5);
    // 15 standard errors above 0: nothing is truncated
    assert!((phase.raw - gamma(1.5, 3.5)).norm() < 1e-15);
    assert!(relative(phase.spread, 0.1) < 1e-12);
    assert!((phase.mean - phase.raw).norm() < 1e-15);
    assert!(relative(phase.damping_variance, 0.01) < 1e-12);
    let smoothed = smoothed_at(gamma(0.2, 7.0), 0.08);
    let phase = Phase::of(&smoothed, 0.5);
    let (mean, variance) = positive_half(0.1, 0.1);
    assert!(
        (phase.mean.re - mean).abs() < 1e-8 && relative(phase.damping_variance, variance) < 1e-6
    );
    assert!((phase.mean.im - 3.5).abs() < 1e-15);
    // γ without error
    let phase = Phase::of(&smoothed_at(gamma(0.0, 1.0), 0.0), 1.0);
    assert!(phase.mean.re.abs() < 1e-300 && phase.damping_variance.abs() < 1e-300);
}

fn phase(mean: Complex64, damping_variance: f64, spread: f64) -> Phase {
    Phase {
        raw: mean,
        spread,
        mean,
        damping_variance,
    }
}

#[test]
fn the_probability_of_a_root_is_that_of_its_half_plane() {
    let here = phase(gamma(0.3, 2.0), 0.04, 0.1);
    // roots of different phase: the mean is 0.05 from the middle between the roots, on the side of
    // the first root, with a standard error of 0.1
    let p = here.probability_of_first(gamma(0.3, 2.1), gamma(0.3, 1.8));
    assert!((p - normal_distribution(0.5)).abs() < 1e-9, "{p}");
    // roots of different damping: the mean is 0.1 from the middle, on the side of the second root,
    // with a standard error of 0.2
    let p = here.probability_of_first(gamma(0.6, 2.0), gamma(0.2, 2.0));
    assert!((p - normal_distribution(-0.5)).abs() < 1e-9, "{p}");
    // roots that differ in both, in the direction (0.6, 0.8): the mean is 0.1 from the middle, on
    // the side of the first root
    let (ahead, error) = (0.1, (0.36 * 0.04 + 0.64 * 0.01_f64).sqrt());
    let middle = gamma(0.3, 2.0) - ahead * gamma(0.6, 0.8);
    let half = 0.35 * gamma(0.6, 0.8);
    let p = here.probability_of_first(middle + half, middle - half);
    assert!((p - normal_distribution(ahead / error)).abs() < 1e-9, "{p}");
    let q = here.probability_of_first(middle - half, middle + half);
    assert!((p + q - 1.0).abs() < 1e-12);
    // at nine standard errors from the middle the probability is 1 to all digits, or almost 0
    let far = phase(gamma(0.3, 2.0), 0.04, 0.001);
    let exactly = |p: f64, expected: f64| p.total_cmp(&expected).is_eq();
    assert!(exactly(
        far.probability_of_first(gamma(0.3, 2.001), gamma(0.3, 1.981)),
        1.0
    ));
    assert!(far.probability_of_first(gamma(0.3, 1.981), gamma(0.3, 2.001)) < 1e-15);
    // without an error the nearer root is certain; halfway between two roots the probability is ½
    let known = phase(gamma(0.0, 2.0), 0.0, 0.0);
    assert!(exactly(
        known.probability_of_first(gamma(0.0, 2.1), gamma(0.0, 1.8)),
        1.0
    ));
    assert!(exactly(
        known.probability_of_first(gamma(0.0, 2.1), gamma(0.0, 1.9)),
        0.5
    ));
}

fn line_at(observed: Complex64, variance: f64) -> LineAt<'static> {
    forward::tests::line_at(1000.0, 1.0, observed, variance)
}

#[test]
fn any_root_can_be_asked_for() {
    let root = gamma(0.1, 2.8);
    let line = line_at(FreeEnd.expand(root)[0], 1e-4);
    let here = phase(gamma(0.1, 2.9), 1e-3, 0.3);
    let Some([first, second]) = here.nearest_roots(&line) else {
        panic!("a cosine has roots");
    };
    assert!((first - root).norm() < 1e-9);
    let p = here.probability_of(first, &line);
    assert!((p - here.probability_of_first(first, second)).abs() < 1e-15 && p > 0.5);
    let q = here.probability_of(second, &line);
    assert!((p + q - 1.0).abs() < 1e-12);
    // a phase within 0.005 rad of a root counts as this root; farther away there is no root
    let near = here.probability_of(first + gamma(0.0, 0.004), &line);
    assert!((near - p).abs() < 1e-15);
    assert!(here.probability_of(first + gamma(0.0, 0.006), &line) < 1e-15);
}

#[test]
fn a_local_misfit_is_a_running_mean_from_both_sides() {
    let n = 40_u32;
    let lines: Vec<LineAt<'_>> = (0..n).map(|_| line_at(gamma(1.0, 0.0), 1.0)).collect();
    let smoothed = |step: f64| -> Vec<Smoothed> {
        (0..n)
            .map(|k| smoothed_at(gamma(0.0, step * f64::from(k)), 0.0))
            .collect()
    };
    let mut chi_square = vec![Some(1.0); lines.len()];
    chi_square[20] = Some(17.0);
    let misfit = local_misfit(&chi_square, &smoothed(0.1), &lines);
    // the misfit is 1 + 16/8 at the erratic line, and its excess over 1 is multiplied by 7/8 per
    // line of distance
    for (k, found) in misfit.iter().enumerate() {
        let away = i32::try_from(k.abs_diff(20)).unwrap();
        let expected = 1.0 + 2.0 * 0.875_f64.powi(away);
        assert!(relative(*found, expected) < 1e-12, "{k}: {found}");
    }
    // a skipped line has no misfit
    chi_square[20] = None;
    let misfit = local_misfit(&chi_square, &smoothed(0.1), &lines);
    assert!(misfit.iter().all(|m| (m - 1.0).abs() < 1e-12));
    // ten erratic lines over less than half a wave leave all mean misfits finite; over more than
    // half a wave they make those of all following lines infinite
    chi_square[15..25].fill(Some(100.0));
    let short = local_misfit(&chi_square, &smoothed(0.05), &lines);
    assert!(short.iter().all(|m| m.is_finite()) && short[20] > ERRATIC);
    let long = local_misfit(&chi_square, &smoothed(0.5), &lines);
    let lost = long.iter().position(|m| m.is_infinite()).unwrap();
    // the mean over the following lines exceeds the limit already at the first line, 15 lines
    // before the erratic stretch
    let began = short.iter().position(|m| *m > ERRATIC).unwrap();
    assert_eq!(lost, began + 7, "7 steps of 0.5 rad are the first above π");
    assert!(long[lost..].iter().all(|m| m.is_infinite()));
}

fn verdict(misfit: f64, chi_square: Option<f64>, smoothed: Smoothed) -> Verdict {
    Verdict {
        courses: vec![(1.0, vec![smoothed])],
        misfits: vec![Misfit {
            around: misfit,
            own: chi_square,
        }],
        determined: true,
        crowded_out: 0.0,
    }
}

#[test]
fn a_line_is_strange_beyond_four_standard_deviations_of_all_that_is_uncertain() {
    let at = gamma(0.2, 2.0);
    let [value, slope, curvature] = FreeEnd.expand(at);
    let smoothed = smoothed_at(at, 0.02);
    let phase = Phase::of(&smoothed, 1.0);
    let noise = 1e-3;
    // E|δx|² is the variance of the smoothed γ, and E|δx²/2|² half of its square
    let expected = noise + slope.norm_sqr() * 0.02 + 0.5 * curvature.norm_sqr() * 0.02_f64.powi(2);
    let strange = |deviations: f64, chi_square: Option<f64>| {
        let observed = value + deviations * expected.sqrt() * gamma(0.6, 0.8);
        let misfit = Misfit {
            around: 1.0,
            own: chi_square,
        };
        is_strange(&misfit, &line_at(observed, noise), &phase)
    };
    assert!(strange(4.001, Some(9.0)) && !strange(3.999, Some(9.0)));
    // a line counts as an outlier only where the filter also found a large misfit
    assert!(!strange(5.0, Some(3.999)) && strange(5.0, Some(4.0)) && !strange(5.0, None));
}

/// A line without a known misfit is undetermined, however well its root agrees with the course.
#[test]
fn r21_a_line_without_a_misfit_is_undetermined() {
    let at = gamma(0.2, 2.0);
    let smoothed = smoothed_at(at, 2e-4);
    let line = line_at(FreeEnd.expand(at)[0], 1e-6);
    let known = verdict(1.0, Some(1.0), smoothed).line(0, &line);
    assert!(known.doubt.is_none() && known.confidence > 0.99);
    let missing = Verdict {
        misfits: Vec::new(),
        ..verdict(1.0, Some(1.0), smoothed)
    };
    let tracked = missing.line(0, &line);
    assert_eq!(tracked.doubt, Some(BranchDoubt::Undetermined));
    assert!(tracked.root.is_none() && tracked.confidence.abs() < 1e-300);
}

#[test]
fn doubts_come_in_the_order_of_their_weight() {
    let at = gamma(0.2, 2.0);
    let smoothed = smoothed_at(at, 2e-4);
    let line = line_at(FreeEnd.expand(at)[0], 1e-6);
    let ask = |verdict: &Verdict, at: Complex64, confidence: f64, roots, rivals| {
        let mut confidence = confidence;
        let smoothed = smoothed_at(at, 2e-4);
        let best = Phase::of(&smoothed, 1.0);
        let misfit = &verdict.misfits[0];
        let doubt = verdict.doubt(misfit, &line, &best, &mut confidence, roots, rivals);
        (doubt, confidence)
    };
    let clear = verdict(1.0, Some(1.0), smoothed);
    let roots = (at, gamma(0.2, 4.2));
    let usual = |verdict: &Verdict| ask(verdict, at, 0.99995, roots, (0.0, None));
    assert_eq!(usual(&clear), (None, 0.99995));
    // a confidence equal to the required one is sufficient
    assert_eq!(ask(&clear, at, 0.9999, roots, (0.0, None)), (None, 0.9999));
    let lost = Verdict {
        determined: false,
        ..verdict(1.0, Some(1.0), smoothed)
    };
    assert_eq!(usual(&lost), (Some(BranchDoubt::Undetermined), 0.0));
    let erratic = BranchDoubt::Erratic {
        chi_square: 6.5,
        limit: 6.0,
    };
    let misfit = verdict(6.5, Some(1.0), smoothed);
    assert_eq!(usual(&misfit), (Some(erratic), 0.0));
    // with a standard error of 0.01, a damping of five standard errors below 0 means a wrong count
    // of waves; three standard errors below 0 are noise
    let (doubt, confidence) = ask(&clear, gamma(-0.05, 2.0), 0.99995, roots, (0.0, None));
    let Some(BranchDoubt::Turned {
        damping_length,
        deviations,
    }) = doubt
    else {
        panic!("{doubt:?}");
    };
    assert!((damping_length + 0.05).abs() < 1e-15 && relative(deviations, 5.0) < 1e-9);
    assert!(confidence.abs() < 1e-15);
    let (doubt, _) = ask(&clear, gamma(-0.03, 2.0), 0.99995, roots, (0.0, None));
    assert_eq!(doubt, None);
    // the doubt is about the other speed if more than half of the missing confidence belongs to it;
    // otherwise the doubt is about the other root
    let (doubt, confidence) = ask(&clear, at, 0.9, roots, (0.06, Some(4.0)));
    assert_eq!(
        doubt,
        Some(BranchDoubt::SeveralSpeeds {
            chosen: 500.0,
            other: 250.0
        })
    );
    assert!((confidence - 0.9).abs() < 1e-15);
    let (doubt, _) = ask(&clear, at, 0.9, roots, (0.04, Some(4.0)));
    assert_eq!(
        doubt,
        Some(BranchDoubt::OtherRoot {
            confidence: 0.9,
            least: 0.9999,
            other: 4.2
        })
    );
    // there is no doubt about the other speed where the confidence is high, nor about another root
    // that coincides with the first
    assert_eq!(ask(&clear, at, 0.99995, roots, (0.06, Some(4.0))).0, None);
    let same = (at, at + gamma(0.0, 0.004));
    assert_eq!(ask(&clear, at, 0.9, same, (0.0, None)).0, None);
    let negative = (gamma(-0.001, 2.0), gamma(0.2, 4.2));
    assert_eq!(
        ask(&clear, at, 0.99995, negative, (0.0, None)).0,
        Some(BranchDoubt::NegativeDamping {
            damping_length: -0.001
        })
    );
}
