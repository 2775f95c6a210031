//! Predicted errors of sets of positions.

use std::f64::consts::{PI, TAU};

use cmod::CmodError;
use cmod::multi_point::advice::{ExpectedWaves, common_spacing, predict, singular_frequencies};
use num_complex::Complex64;

use super::frame::{lines, polypropylene};

const THREE_EQUAL: [f64; 3] = [-0.1, 0.0, 0.1];
const THREE_UNEQUAL: [f64; 3] = [-0.1, -0.03, 0.1];
const FIVE_EQUAL: [f64; 5] = [-0.1, -0.05, 0.0, 0.05, 0.1];

/// Median of the relative deviation over 0.5-20 kHz, part of the lines below 1 %, and the deviation at ka = 0.987 π.
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

/// An independent computation for polypropylene, 0.2 m, 1 % of the incident wave, 0.5-20 kHz. Its material and its reflected
/// wave are not stated, so not its digits are asked for but, with waves of our own, its size: medians within 25 %, bands
/// within 4 points, the line next to the singular one within 50 %.
#[test]
fn what_unequal_distances_and_more_gauges_gain() {
    let near = |found: f64, expected: f64, tolerance: f64| {
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{found} for {expected}"
        );
    };
    for (positions, median, below, singular) in [
        (&THREE_EQUAL[..], 6.3e-3, 0.68, 2.8e-2),
        (&THREE_UNEQUAL, 5.0e-3, 0.83, 2.8e-3),
        (&FIVE_EQUAL, 2.6e-3, 0.85, f64::NAN),
    ] {
        let found = summary(positions);
        near(found.0, median, 0.25);
        assert!((found.1 - below).abs() < 0.04, "{} for {below}", found.1);
        if singular.is_finite() {
            near(found.2, singular, 0.5);
        }
    }
    // five on a grid of half the spacing are not singular there, nor five at unequal distances
    let five_unequal = summary(&[-0.1, -0.072, -0.01, 0.059, 0.1]);
    assert!(five_unequal.0 < summary(&FIVE_EQUAL).0 * 1.05);
    assert!(five_unequal.2 < 0.1 * summary(&THREE_EQUAL).2);
}

/// E|δγ|² = σ² (½ + |Ψ|²)/(a²|q₀|²|sinh γa|²), from the errors of Ψ = (q₁ + q₂)/(2q₀).
#[test]
fn the_prediction_for_three_equal_distances_is_the_closed_form() {
    let medium = polypropylene();
    let frequency_hz = lines(500.0, 50.0, 200);
    let waves = ExpectedWaves {
        incident_at: 0.0,
        reflector_at: 0.3,
        reflection: Complex64::new(-0.6, 0.2),
    };
    let found = predict(&medium, &THREE_EQUAL, waves, 0.01, &frequency_hz).unwrap();
    for prediction in found {
        let gamma = medium.propagation_coefficient(TAU * prediction.frequency_hz);
        let middle = 1.0 + waves.reflection * (-gamma * 0.6).exp();
        let psi = (gamma * 0.1).cosh();
        let variance = 1e-4 * (0.5 + psi.norm_sqr())
            / (0.01 * middle.norm_sqr() * (gamma * 0.1).sinh().norm_sqr());
        let expected = variance.sqrt() / gamma.norm();
        assert!((prediction.relative_deviation / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn grids_and_their_singular_frequencies() {
    let spacing = |positions: &[f64]| common_spacing(positions, 1e-6).unwrap();
    for (positions, expected) in [
        (&THREE_EQUAL[..], 0.1),
        (&FIVE_EQUAL, 0.05),
        (&THREE_UNEQUAL, 0.01), // 70 mm and 130 mm
        (&[0.0, 0.06, 0.15], 0.03),
    ] {
        assert!((spacing(positions).unwrap() - expected).abs() < 1e-9);
    }
    // the golden section has no common measure: what is left is below a millimetre
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    assert!(
        common_spacing(&[0.0, 0.2 * golden, 0.2], 1e-4)
            .unwrap()
            .is_none()
    );

    let medium = polypropylene();
    let found = singular_frequencies(&medium, &THREE_EQUAL, 1e-6, 20e3).unwrap();
    assert_eq!(found.len(), 2); // half waves of 0.1 m at 1680 m/s: every 8.4 kHz
    for (number, frequency_hz) in found.iter().enumerate() {
        let phase = medium.wave_number(TAU * frequency_hz) * 0.1;
        assert!((phase / PI - (number + 1) as f64).abs() < 1e-9);
    }
    assert!(
        singular_frequencies(&medium, &THREE_UNEQUAL, 1e-6, 20e3)
            .unwrap()
            .is_empty()
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
    // 0 Hz: no wave number, no error, and no NaN
    let at_rest = predict(&medium, &THREE_EQUAL, waves, 0.01, &[0.0]).unwrap();
    assert!(at_rest[0].relative_deviation.is_infinite());
}
