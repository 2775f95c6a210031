//! Predicted errors of sets of gauge positions.

use std::f64::consts::{PI, TAU};

use cmod::CmodError;
use cmod::multi_point::advice::{ExpectedWaves, common_spacing, predict, singular_frequencies};
use num_complex::Complex64;
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use super::frame::{lines, polypropylene};

const THREE_EQUAL: [f64; 3] = [-0.1, 0.0, 0.1];
const THREE_UNEQUAL: [f64; 3] = [-0.1, -0.03, 0.1];
const FIVE_EQUAL: [f64; 5] = [-0.1, -0.05, 0.0, 0.05, 0.1];

/// Returns the median of the relative deviation over 0.5-20 kHz, the fraction of the lines with a
/// deviation below 1 %, and the deviation at ka = 0.987 π.
fn summary(positions: &[f64]) -> (f64, f64, f64) {
    let medium = polypropylene();
    let waves = ExpectedWaves {
        incident_at: -0.1,
        reflector_at: 0.4,
        reflection: Complex64::from(0.5),
    };
    let predicted = |frequency_hz: &[f64]| -> Vec<f64> {
        predict(&medium, positions, waves, 0.01, frequency_hz)
            .unwrap()
            .iter()
            .map(|prediction| prediction.relative_deviation)
            .collect()
    };
    let mut deviations = predicted(&lines(500.0, 10.0, 1951));
    deviations.sort_by(f64::total_cmp);
    let below = deviations.partition_point(|deviation| *deviation < 0.01);
    let singular = singular_frequencies(&medium, &THREE_EQUAL, 1e-6, 20e3).unwrap()[0];
    (
        deviations[deviations.len() / 2],
        below as f64 / deviations.len() as f64,
        predicted(&[0.987 * singular])[0],
    )
}

#[test]
fn plans_of_positions() {
    let mut claims = Claims::default();
    what_unequal_distances_and_more_gauges_gain(&mut claims);
    three_equal_distances(&mut claims);
    grids(&mut claims);
    hold!(claims);
}

/// Compares with an independent computation, whose material and reflected wave are not stated: with
/// other waves, the errors agree only approximately.
fn what_unequal_distances_and_more_gauges_gain(claims: &mut Claims) {
    let [equal, unequal, five] = [&THREE_EQUAL[..], &THREE_UNEQUAL, &FIVE_EQUAL].map(summary);
    claims.by("errors of sets of positions over 0.2 m, computed separately for 1 % of noise (the material and the reflection of this computation are not stated)");
    claims.deviation(
        "three equal, three unequal and five equal distances: median error of the propagation coefficient, worst difference",
        Within(0.25, "another reflected wave changes the result by a quarter"),
        Ok(largest([
            equal.0 / 6.3e-3 - 1.0,
            unequal.0 / 5.0e-3 - 1.0,
            five.0 / 2.6e-3 - 1.0,
        ])),
    );
    claims.deviation(
        "three equal, three unequal and five equal distances: fraction of the band with errors below 1 %, worst difference",
        Within(0.04, "another reflected wave changes the result by four percentage points"),
        Ok(largest([equal.1 - 0.68, unequal.1 - 0.83, five.1 - 0.85])),
    );
    claims.deviation(
        "three equal and three unequal distances: error at ka = 0.987 pi, worst difference",
        Within(0.5, "another reflected wave changes the result by half"),
        Ok(largest([equal.2 / 2.8e-2 - 1.0, unequal.2 / 2.8e-3 - 1.0])),
    );
    // five gauges on a grid of half the spacing are not singular at this frequency, and neither are
    // five gauges at unequal distances
    let five_unequal = summary(&[-0.1, -0.072, -0.01, 0.059, 0.1]);
    assert!(five_unequal.0 < five.0 * 1.05);
    assert!(five_unequal.2 < 0.1 * equal.2);
}

/// Compares with the error that follows from the errors of Ψ = (q₁ + q₂)/(2q₀).
fn three_equal_distances(claims: &mut Claims) {
    let medium = polypropylene();
    let waves = ExpectedWaves {
        incident_at: 0.0,
        reflector_at: 0.3,
        reflection: Complex64::new(-0.6, 0.2),
    };
    let frequency_hz = lines(500.0, 50.0, 200);
    let found = predict(&medium, &THREE_EQUAL, waves, 0.01, &frequency_hz).unwrap();
    assert_eq!(found.len(), 200);
    claims.by(
        "variance of gamma by (1/2 + Psi^2) sigma^2/(a e_0 sinh(gamma a))^2, with absolute values",
    );
    claims.deviation(
        "predicted error of three equal distances, 0.5 to 10 kHz",
        Within(2e-13, "rounding of a projection near singular lines"),
        Ok(largest(found.iter().map(|prediction| {
            let gamma = medium.propagation_coefficient(TAU * prediction.frequency_hz);
            let middle = 1.0 + waves.reflection * (-gamma * 0.6).exp();
            let psi = (gamma * 0.1).cosh();
            let variance = 1e-4 * (0.5 + psi.norm_sqr())
                / (0.01 * middle.norm_sqr() * (gamma * 0.1).sinh().norm_sqr());
            let expected = variance.sqrt() / gamma.norm();
            prediction.relative_deviation / expected - 1.0
        }))),
    );
}

fn grids(claims: &mut Claims) {
    for (positions, expected) in [
        (&THREE_EQUAL[..], 0.1),
        (&FIVE_EQUAL, 0.05),
        (&THREE_UNEQUAL, 0.01), // 70 mm and 130 mm
        (&[0.0, 0.06, 0.15], 0.03),
    ] {
        let spacing = common_spacing(positions, 1e-6).unwrap();
        assert!((spacing.unwrap() - expected).abs() < 1e-9);
    }
    // distances in the golden ratio have no common measure: the remainder is below a millimetre
    let golden = [0.0, 0.1 * (5.0_f64.sqrt() - 1.0), 0.2];
    assert!(common_spacing(&golden, 1e-4).unwrap().is_none());

    let medium = polypropylene();
    let singular = |positions| singular_frequencies(&medium, positions, 1e-6, 20e3).unwrap();
    let found = singular(&THREE_EQUAL);
    assert_eq!(found.len(), 2); // half waves of 0.1 m at 1680 m/s: every 8.4 kHz
    assert!(singular(&THREE_UNEQUAL).is_empty());
    claims.by("singular lines: k a = n pi");
    claims.deviation(
        "three equal distances of 0.1 m: both singular frequencies up to 20 kHz",
        Within(1e-12, "bisection"),
        Ok(largest((1..).zip(&found).map(|(n, f)| {
            medium.wave_number(TAU * f) * 0.1 / (f64::from(n) * PI) - 1.0
        }))),
    );
}

#[test]
fn impossible_plans_are_refused() {
    let medium = polypropylene();
    let waves = ExpectedWaves {
        incident_at: 0.0,
        reflector_at: 0.4,
        reflection: Complex64::from(-1.0),
    };
    assert!(matches!(
        predict(&medium, &[0.0, 0.1], waves, 0.01, &[1e3]),
        Err(CmodError::GaugeCount { found: 2, .. })
    ));
    assert!(predict(&medium, &THREE_EQUAL, waves, -0.01, &[1e3]).is_err());
    assert!(predict(&medium, &THREE_EQUAL, waves, 0.01, &[]).is_err());
    let nowhere = ExpectedWaves {
        reflector_at: f64::NAN,
        ..waves
    };
    assert!(predict(&medium, &THREE_EQUAL, nowhere, 0.01, &[1e3]).is_err());
    assert!(common_spacing(&THREE_EQUAL, 0.0).is_err());
    // at 0 Hz the wave number is 0, and its relative error is infinite and not NaN
    let at_rest = predict(&medium, &THREE_EQUAL, waves, 0.01, &[0.0]).unwrap();
    assert!(at_rest[0].relative_deviation.is_infinite());
}
