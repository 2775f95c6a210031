use super::*;
use crate::branch::forward::tests::line_at;

fn line(omega: f64, observed: f64, variance: f64) -> LineAt<'static> {
    line_at(omega, 1.0, observed.into(), variance)
}

fn places(records: &[usize]) -> Vec<Place> {
    let numbered = records.iter().enumerate();
    numbered
        .map(|(line, record)| Place {
            record: *record,
            line,
        })
        .collect()
}

fn relative(a: f64, b: f64) -> f64 {
    (a / b - 1.0).abs()
}

/// Returns equally spaced lines whose values are on a straight line, offset by `step` alternately
/// upwards and downwards; `variance` is the stated variance.
fn zigzag(n: usize, step: f64, variance: f64) -> Vec<LineAt<'static>> {
    (0..n)
        .map(|k| {
            let k = k as f64;
            let sign = if k % 2.0 < 0.5 { 1.0 } else { -1.0 };
            line(10.0 + k, 0.05 * k + sign * step, variance)
        })
        .collect()
}

#[test]
fn noise_that_is_not_stated_has_a_form_and_a_least_value() {
    let observed = Complex64::new(3.0, 4.0);
    assert!(relative(assumed_variance(observed), 9e-4 * 25.5) < 1e-12);
    assert!(relative(least_variance(observed), 1e-8 * 25.25) < 1e-12);
}

#[test]
fn a_deviation_is_from_the_straight_line_through_the_neighbours() {
    // a quarter of the way from 1 to 3 the straight line is at 1.5; the variances of the three
    // lines are weighted with the factors 9/16, 1 and 1/16
    let (first, last) = (line(10.0, 1.0, 0.016), line(14.0, 3.0, 0.032));
    let middle = line(11.0, 1.7, 0.004);
    let expected = 0.2 * 0.2 / (0.004 + 9.0 / 16.0 * 0.016 + 0.032 / 16.0);
    assert!(relative(deviation(&first, &middle, &last).unwrap(), expected) < 1e-12);
    // three quarters of the way from the first line to the last
    let middle = line(13.0, 1.7, 0.004);
    let expected = 0.8 * 0.8 / (0.004 + 0.016 / 16.0 + 9.0 / 16.0 * 0.032);
    assert!(relative(deviation(&first, &middle, &last).unwrap(), expected) < 1e-12);
    assert!(deviation(&first, &middle, &line(10.0, 3.0, 1.0)).is_none());
}

#[test]
fn scatter_of_neighbours_is_the_level_of_noise() {
    let variance = 1e-6;
    // the deviation is 2 step, and its variance is 1 + 1/4 + 1/4 times that of a line; the median
    // of an exponential variable of mean 1 is ln 2
    let level = |step: f64| 4.0 * step * step / (1.5 * variance) / LN_2;
    let of = |step: f64, stated: bool| {
        let lines = zigzag(9, step, variance);
        NoiseLevel::of(&lines, &places(&[0; 9]), stated).factor
    };
    // steps of three times and of one third of the expected deviation
    for step in [1.8e-3, 0.2e-3] {
        assert!(relative(of(step, false), level(step)) < 1e-9);
    }
    // the stated noise is accepted up to a scatter of twice its variance, and never lowered
    assert!(level(1.0e-3) > 2.0 && level(0.7e-3) < 2.0 && level(0.7e-3) > 1.0);
    assert!(relative(of(1.0e-3, true), level(1.0e-3)) < 1e-9);
    assert!(of(0.7e-3, true).total_cmp(&1.0).is_eq());
    assert!(of(0.1e-3, true).total_cmp(&1.0).is_eq());
}

#[test]
fn the_level_is_not_inferred_beyond_a_tenth() {
    // differences of 0.8 between neighbours may be the signal: the inferred noise is limited to 0.1
    // (1/4 + |Ψ|²)^1/2, evaluated at the middle line
    let lines = zigzag(9, 0.4, 1e-6);
    let level = NoiseLevel::of(&lines, &places(&[0; 9]), false).factor;
    let mut most: Vec<f64> = lines
        .iter()
        .map(|line| 0.01 * (0.25 + line.sight.observed.norm_sqr()) / 1e-6)
        .collect();
    // the median of the inverse values belongs to the same line as the median of the values
    most.sort_by(f64::total_cmp);
    assert!(relative(level, most[4]) < 1e-9, "{level} {}", most[4]);
}

#[test]
fn lines_of_different_records_are_no_neighbours() {
    // two smooth records that differ by 0.5, interleaved
    let lines: Vec<LineAt<'_>> = (0..12)
        .map(|k| line(10.0 + f64::from(k), 0.5 * f64::from(k % 2), 1e-6))
        .collect();
    let alternating: Vec<usize> = (0..12).map(|k| k % 2).collect();
    let apart = NoiseLevel::of(&lines, &places(&alternating), true);
    assert!(apart.factor.total_cmp(&1.0).is_eq());
    let together = NoiseLevel::of(&lines, &places(&[0; 12]), true);
    assert!(together.factor > 1e3);
    // missing lines are not used: if all lines are missing, the level remains 1
    let mut gap = zigzag(9, 1.8e-3, 1e-6);
    for line in &mut gap {
        line.missing = true;
    }
    assert!(
        NoiseLevel::of(&gap, &places(&[0; 9]), false)
            .factor
            .total_cmp(&1.0)
            .is_eq()
    );
}

fn level(stated: bool, factor: f64) -> NoiseLevel {
    NoiseLevel {
        variance: vec![1e-3, 1e-12],
        stated,
        factor,
        adjusted: false,
    }
}

#[test]
fn a_level_multiplies_variances_down_to_the_least() {
    let mut lines = [line(1.0, 2.0, 7.0), line(2.0, 2.0, 7.0)];
    level(false, 4.0).apply(&mut lines);
    assert!(relative(lines[0].sight.variance, 4e-3) < 1e-12);
    assert!(relative(lines[1].sight.variance, 1e-8 * 4.25) < 1e-12);
    assert!(relative(level(false, 4.0).factor(), 2.0) < 1e-12);
}

#[test]
fn a_level_is_adjusted_beyond_four_standard_errors_of_the_misfit() {
    // for 10000 lines the median has a standard error of 0.0144; four standard errors are 0.058, so
    // the initial limit of 1.3 is the larger one and applies
    let many = 10_000;
    let mut high = level(true, 1.0);
    assert!(!high.adjust((many, 1.29)));
    assert!(high.adjust((many, 1.31)) && relative(high.factor, 1.31) < 1e-12);
    // after the first adjustment the limit is 1.1
    assert!(!high.adjust((many, 1.09)));
    assert!(high.adjust((many, 1.11)) && relative(high.factor, 1.31 * 1.11) < 1e-12);
    // a small misfit lowers the level, but not below the stated noise
    assert!(!high.adjust((many, 0.95)));
    assert!(high.adjust((many, 0.1)) && high.factor.total_cmp(&1.0).is_eq());
    assert!(!high.adjust((many, 0.1)));
    // for 100 lines four standard errors are 0.577
    let few = 100;
    let mut free = level(false, 2.0);
    assert!(!free.adjust((few, 1.57)) && !free.adjust((few, 0.43)));
    assert!(free.adjust((few, 0.42)) && relative(free.factor, 0.84) < 1e-12);
    assert!(free.adjust((few, 1.58)));
    // for many lines the level is lowered if the misfit is below 1/1.3
    let mut free = level(false, 0.5);
    assert!(!free.adjust((many, 0.78)));
    assert!(free.adjust((many, 0.76)) && relative(free.factor, 0.38) < 1e-12);
    assert!(free.adjust((many, 0.0)) && free.factor > 0.0);
}
