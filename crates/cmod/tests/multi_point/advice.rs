//! Predicted errors of sets of positions.

use std::f64::consts::{PI, TAU};

use cmod::CmodError;
use cmod::multi_point::advice::{ExpectedWaves, common_spacing, predict, singular_frequencies};
use num_complex::Complex64;

use crate::frame::{lines, polypropylene};

const THREE_EQUAL: [f64; 3] = [-0.1, 0.0, 0.1];
const THREE_UNEQUAL: [f64; 3] = [-0.1, -0.03, 0.1];
const FIVE_EQUAL: [f64; 5] = [-0.1, -0.05, 0.0, 0.05, 0.1];

#[test]
fn explore() {
    let f = lines(500.0, 10.0, 1951);
    let medium = polypropylene();
    let fs = singular_frequencies(&medium, &THREE_EQUAL, 1e-6, 20e3).unwrap()[0];
    for (at, refl, r) in [
        (0.0, 0.0, 0.0),
        (-0.1, 0.0, 0.0),
        (0.0, 0.0, 1.0),
        (0.0, 0.0, -1.0),
        (0.0, 0.0, 0.5),
        (0.0, 0.0, -0.5),
        (0.0, 0.4, -1.0),
        (0.0, 0.5, -1.0),
        (-0.1, 0.4, -1.0),
        (0.0, 0.2, -1.0),
        (0.0, 0.1, -1.0),
        (0.0, 0.7, -1.0),
        (0.0, 0.4, -0.5),
        (-0.1, 0.1, -0.5),
    ] {
        let waves = ExpectedWaves {
            incident_at: at,
            reflector_at: refl,
            reflection: Complex64::from(r),
        };
        let mut text = format!("{at} {refl} {r}:");
        for p in [&THREE_EQUAL[..], &THREE_UNEQUAL, &FIVE_EQUAL] {
            let q = predict(&medium, p, waves, 0.01, &f).unwrap();
            let mut d: Vec<f64> = q.iter().map(|q| q.relative_deviation).collect();
            let below = d.iter().filter(|d| **d < 0.01).count() as f64 / d.len() as f64;
            d.sort_by(f64::total_cmp);
            let near = predict(&medium, p, waves, 0.01, &[0.987 * fs]).unwrap()[0];
            text += &format!(
                "  {:.2e} {:.0}% {:.1e}",
                d[d.len() / 2],
                100.0 * below,
                near.relative_deviation
            );
        }
        println!("{text}");
    }
}

/// One wave only. With u = e^{-γa} and q = (1/u, 1, u), |P_perp A'c|² of three equal distances is a²|sinh γa|²/(½ + |Ψ|²)
/// times ½ |q₀|² · 2: methods in closed form (paper B with the errors of Ψ).
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
