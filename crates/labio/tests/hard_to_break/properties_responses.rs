//! The six kinds of a response, merges, and impulse responses.

use labio::{
    Channel, Estimator, FrequencyResponse, LineValidity, MergedResponse, Quantity, ResponseKind,
};
use num_complex::Complex64;
use proptest::prelude::*;

use super::{INPUT, OUTPUT, any_hits, averaged};

fn response(values: Vec<Complex64>, spacing_hz: f64) -> FrequencyResponse {
    let force = Channel::new(INPUT, Quantity::Force).unwrap();
    let motion = Channel::new(OUTPUT, Quantity::Acceleration).unwrap();
    FrequencyResponse::of_lines(force, motion, spacing_hz, values).unwrap()
}

fn any_response() -> impl Strategy<Value = FrequencyResponse> {
    let value =
        (-10.0..10.0_f64, -10.0..10.0_f64).prop_map(|(re, im)| Complex64::new(re + 0.01, im));
    let values = prop::collection::vec(value, 3..40);
    // a mobility in arbitrary units
    (values, -200..200_i32, 1e-2..1e3_f64).prop_map(|(values, power, spacing)| {
        let factor = 10.0_f64.powi(power);
        response(values.iter().map(|v| v * factor).collect(), spacing)
    })
}

proptest! {
    /// Conversion to any two kinds and back, in units that make the numbers very large or small.
    #[test]
    fn kinds_invert_each_other(given in any_response(), via in 0..6_usize, over in 0..6_usize) {
        let back = given.to_kind(ResponseKind::ALL[via]).unwrap().to_kind(ResponseKind::ALL[over]).unwrap()
            .to_kind(ResponseKind::Accelerance).unwrap();
        prop_assert_eq!(&back.output, &given.output);
        for line in 1..given.values.len() {
            prop_assert_eq!(back.validity[line], LineValidity::Valid);
            // tolerance: rounding errors of a few products, quotients and powers
            let apart = (back.values[line] - given.values[line]).norm();
            prop_assert!(apart < 1e-13 * given.values[line].norm());
        }
    }

    /// The relative error of a line is the same for every kind.
    #[test]
    fn relative_errors_survive_every_kind((hits, _) in any_hits(3), via in 0..6_usize) {
        let given = averaged(&hits).h1(INPUT, OUTPUT).unwrap();
        let other = given.to_kind(ResponseKind::ALL[via]).unwrap();
        let errors = given.random_error().unwrap().into_iter().zip(other.random_error().unwrap());
        for (line, (a, b)) in errors.enumerate() {
            if given.validity[line] == LineValidity::Valid && other.validity[line] == LineValidity::Valid {
                prop_assert!((a.magnitude - b.magnitude).abs() <= 1e-12 * a.magnitude);
            }
        }
    }

    /// The result of a merge does not depend on the order of the hammers, shares are between 0 and
    /// 1, and a test merged with itself is unchanged.
    #[test]
    fn hammers_are_equal((first, _) in any_hits(3), seed in 0..1000_u32) {
        let other: Vec<_> = first.iter().map(|hit| {
            let lift = f64::from(seed) / 500.0;
            let rows: Vec<Vec<f64>> = hit.samples().rows().into_iter()
                .map(|row| row.iter().enumerate().map(|(n, x)| x + lift * (n as f64).sin()).collect()).collect();
            super::record([&rows[0], &rows[1]], hit.sampling_rate_hz())
        }).collect();
        let [a, b] = [averaged(&first), averaged(&other)];
        let [x, y] = [&a, &b].map(|spectra| spectra.h1(INPUT, OUTPUT).unwrap());
        let there = MergedResponse::by_inverse_variance(&[x.clone(), y.clone()]).unwrap();
        let back = MergedResponse::by_inverse_variance(&[y, x.clone()]).unwrap();
        let itself = MergedResponse::by_inverse_variance(&[x.clone(), x.clone()]).unwrap();
        for line in 0..x.values.len() {
            if there.response.validity[line] != LineValidity::Valid {
                continue;
            }
            let scale = there.response.values[line].norm();
            prop_assert!((there.response.values[line] - back.response.values[line]).norm() <= 1e-12 * scale);
            prop_assert!((there.shares.column(line).sum() - 1.0).abs() < 1e-14);
            if x.validity[line] == LineValidity::Valid {
                prop_assert!((itself.response.values[line] - x.values[line]).norm() <= 1e-14 * x.values[line].norm());
            }
        }
        let larger = MergedResponse::by_larger_input(&[&a, &b], Estimator::H1, INPUT, OUTPUT).unwrap();
        let turned = MergedResponse::by_larger_input(&[&b, &a], Estimator::H1, INPUT, OUTPUT).unwrap();
        for line in 0..x.values.len() {
            let levels = [&a, &b].map(|spectra| spectra.auto(INPUT).unwrap()[line]);
            // of tests with equal levels, the first one is used
            if levels[0].to_bits() != levels[1].to_bits() && larger.response.validity[line] == LineValidity::Valid {
                prop_assert_eq!(larger.response.values[line], turned.response.values[line]);
            }
        }
    }

    /// Conversion of lines to an impulse response and back, in any units.
    #[test]
    fn impulse_responses_keep_the_lines(given in any_response()) {
        let mut given = given;
        let last = given.values.len() - 1;
        for line in [0, last] {
            given.values[line].im = 0.0; // a real history determines only the real part
        }
        let impulse = given.impulse_response().unwrap();
        let largest = given.values.iter().fold(0.0_f64, |top, v| top.max(v.norm()));
        for (there, back) in given.values.iter().zip(impulse.lines()) {
            prop_assert!((there - back).norm() < 1e-13 * largest);
        }
        prop_assert!((0.0..=1.0).contains(&impulse.acausal_part()));
    }

    /// The acausal part is a ratio and does not depend on the unit.
    #[test]
    fn the_acausal_part_has_no_unit(given in any_response(), power in -150..150_i32) {
        let plain: Vec<Complex64> = given.values.iter().map(|v| v / given.values[0].norm()).collect();
        let other = plain.iter().map(|v| v * 2.0_f64.powi(power * 3)).collect();
        let part = |values| response(values, 1.0).impulse_response().unwrap().acausal_part();
        prop_assert!((part(plain) - part(other)).abs() < 1e-14);
    }
}
