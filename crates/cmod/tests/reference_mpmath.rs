//! The two-point method compared with acceleration ratios of 50 digits, from
//! `fixtures/reference/mpmath`.

use cmod::{Specimen, TwoPoint};
use num_complex::Complex64;

const TWO_POINT: &str = include_str!("../../../fixtures/reference/mpmath/two_point.csv");

struct Case {
    specimen: Specimen,
    frequency_hz: Vec<f64>,
    ratio: Vec<Complex64>,
    modulus: Vec<Complex64>,
}

fn case(name: &str) -> Case {
    let rows: Vec<Vec<f64>> = TWO_POINT
        .lines()
        .filter_map(|line| line.strip_prefix(name)?.strip_prefix(','))
        .map(|rest| rest.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 157, "{name}");
    let complex = |at: usize| {
        rows.iter()
            .map(move |row| Complex64::new(row[at], row[at + 1]))
    };
    Case {
        specimen: Specimen {
            length: rows[0][0],
            diameter: rows[0][1],
            density: rows[0][2],
            accelerometer_mass: rows[0][3],
        },
        frequency_hz: rows.iter().map(|row| row[4]).collect(),
        ratio: complex(5).collect(),
        modulus: complex(7).collect(),
    }
}

/// Inverts equation 1 of paper A, cosh γL + μγL sinh γL = Ψ, to γ and E on lines from 0.3 to 12
/// kHz, where waves must be counted.
#[test]
fn moduli_come_back_from_ratios_of_fifty_digits() {
    for name in ["Test 2", "Test 6", "Test 9", "no mass"] {
        let case = case(name);
        // a variance above 0, because lines with a random error of zero are refused
        let variance: Vec<f64> = case
            .ratio
            .iter()
            .map(|psi| 1e-12 * psi.norm_sqr())
            .collect();
        let estimate = TwoPoint::new(case.specimen)
            .unwrap()
            .estimate(&case.frequency_hz, &case.ratio, &variance)
            .unwrap();
        let mut compared = 0;
        for line in estimate.lines() {
            let index = case
                .frequency_hz
                .iter()
                .position(|f| (f - line.frequency_hz).abs() < 1e-9)
                .unwrap();
            // tolerance: the rounding of Ψ to a double and ten further roundings, with dE/E = -2
            // dx/x and dx = dΨ/f'(x) of equation 1
            let omega = std::f64::consts::TAU * line.frequency_hz;
            let expected = case.modulus[index];
            let x = Complex64::new(0.0, omega)
                * (case.specimen.density / expected).sqrt()
                * case.specimen.length;
            let area = std::f64::consts::FRAC_PI_4 * case.specimen.diameter.powi(2);
            let mu = case.specimen.accelerometer_mass
                / (case.specimen.density * case.specimen.length * area);
            let slope = x.sinh() + mu * (x.sinh() + x * x.cosh());
            let condition = 2.0 * (case.ratio[index].norm().max(1.0) / (x * slope).norm());
            let error = (line.modulus - expected).norm() / expected.norm();
            assert!(
                error < 10.0 * f64::EPSILON * (1.0 + condition),
                "{name}, {} Hz: {error:e}, condition {condition}",
                line.frequency_hz
            );
            compared += 1;
        }
        assert_eq!(compared, 157, "{name}: all lines");
    }
}
