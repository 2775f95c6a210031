//! Tests without noise: the estimate is the propagation coefficient of the material, whatever the
//! ends are.

use std::f64::consts::TAU;

use cmod::multi_point::Quantity;
use cmod::validity::Violation;
use cmod::{ModulusEstimate, ModulusLine, MultiPoint, ThreePoint};
use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::waves::TravellingWaves;
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use super::frame::{STRUCTURES, clean, flat, lines, polypropylene, rod, strains};

fn error(line: &ModulusLine) -> f64 {
    let exact = polypropylene().propagation_coefficient(TAU * line.frequency_hz);
    relative(line.propagation_coefficient, exact)
}

/// Returns the largest error of γ, and checks that all lines are present and none is doubtful.
fn worst(estimate: &ModulusEstimate, n_lines: usize) -> f64 {
    assert!(estimate.refused().is_empty(), "{:?}", estimate.refused());
    assert_eq!(estimate.lines().len(), n_lines);
    for line in estimate.lines() {
        let is_doubt = |violation: &Violation| matches!(violation, Violation::BranchAmbiguous(_));
        assert!(!line.validity.violations().iter().any(is_doubt), "{line:?}");
    }
    largest(estimate.lines().iter().map(error))
}

/// Evaluates a member of a structure with gauges at three sections, equidistant for the closed form
/// (paper B, figure 1), and with more gauges.
#[test]
fn closed_form_is_exact_in_any_structure() {
    let frequency_hz = lines(50.0, 25.0, 400);
    let (mut three, mut several) = (0.0_f64, 0.0_f64);
    for (structure, positions) in STRUCTURES.into_iter().flat_map(|structure| {
        [
            vec![0.3, 0.4, 0.5],
            vec![0.3, 0.37, 0.5],
            vec![0.1, 0.15, 0.3, 0.32],
            vec![0.2, 0.3, 0.4, 0.5, 0.6],
            vec![0.05, 0.12, 0.3, 0.41, 0.7],
        ]
        .map(|positions| (structure, positions))
    }) {
        let strains = strains(structure, &positions, &frequency_hz);
        let tests: [&[Vec<Complex64>]; 1] = [&strains];
        let noise = flat(&vec![0.0; positions.len()], 400);
        let spectra = clean(&frequency_hz, &tests, &noise);
        if let Ok(method) = ThreePoint::new(rod(&positions)) {
            three = three.max(worst(&method.estimate(&spectra).unwrap(), 400));
        }
        let method = MultiPoint::new(rod(&positions)).unwrap();
        several = several.max(worst(method.estimate(&spectra).unwrap().modulus(), 400));
    }
    assert!(three > 0.0);
    let mut claims = Claims::default();
    claims.by("paper B, eqs. 6 to 9: three gauges in closed form, any ends");
    claims.deviation(
        "three gauges, structures I, II and dismounted: propagation coefficient, 50 Hz to 10 kHz",
        Within(
            1e-10,
            "strains of 1e-12, magnified up to 100-fold at low frequency and nodes",
        ),
        Ok(three),
    );
    claims.by("least squares over three to five gauges, any ends");
    claims.deviation(
        "five sets of gauges, structures I, II and dismounted: propagation coefficient, 50 Hz to 10 kHz",
        Within(
            1e-9,
            "strains of 1e-12, magnified up to 1000-fold at low frequency and nodes",
        ),
        Ok(several),
    );
    hold!(claims);
}

/// The joint estimate evaluates each test with its own waves.
#[test]
fn tests_on_different_structures_are_evaluated_together() {
    let frequency_hz = lines(100.0, 50.0, 150);
    let positions = [0.2, 0.29, 0.5];
    let spectra = STRUCTURES.map(|structure| strains(structure, &positions, &frequency_hz));
    let tests: Vec<&[Vec<Complex64>]> = spectra.iter().map(Vec::as_slice).collect();
    let noise = flat(&[1e-9; 3], 150);
    let method = MultiPoint::new(rod(&positions)).unwrap();
    let joint = method
        .estimate(&clean(&frequency_hz, &tests, &noise))
        .unwrap();
    assert!(worst(joint.modulus(), 150) < 1e-9);
    let single: Vec<_> = tests
        .iter()
        .map(|test| {
            method
                .estimate(&clean(&frequency_hz, &[test], &noise))
                .unwrap()
        })
        .collect();
    for (index, fit) in joint.fits().iter().enumerate() {
        assert_eq!(fit.degrees_of_freedom, 4); // 2 (3 · 1 - 1)
        // the inverse variances of the tests add up
        let sum: f64 = single
            .iter()
            .map(|single| single.fits()[index].propagation_variance.recip())
            .sum();
        assert!((fit.propagation_variance * sum - 1.0).abs() < 1e-6);
    }
}

/// For three gauges γ and its errors are the same as in closed form, 1/(a²|q₀|²|sinh γa|²) (½ +
/// |Ψ|²) σ².
#[test]
fn three_equal_distances_are_the_closed_form() {
    let frequency_hz = lines(100.0, 50.0, 150);
    let positions = [0.3, 0.4, 0.5];
    for structure in STRUCTURES {
        let strains = strains(structure, &positions, &frequency_hz);
        let tests: [&[Vec<Complex64>]; 1] = [&strains];
        // different noise at each gauge
        let noise = flat(&[1e-9, 3e-9, 0.5e-9], 150);
        let spectra = clean(&frequency_hz, &tests, &noise);
        let closed = ThreePoint::new(rod(&positions)).unwrap();
        let closed = closed.estimate(&spectra).unwrap();
        let squares = MultiPoint::new(rod(&positions)).unwrap();
        let squares = squares.estimate(&spectra).unwrap();
        for (a, b) in closed.lines().iter().zip(squares.modulus().lines()) {
            let difference = a.propagation_coefficient - b.propagation_coefficient;
            assert!(difference.norm() < 1e-9 * a.propagation_coefficient.norm());
            let ratio = a.standard_error.storage_modulus / b.standard_error.storage_modulus;
            // tolerance: the problem is ill-conditioned near nodes of the middle gauge
            assert!((ratio - 1.0).abs() < 1e-5, "{} Hz: {ratio}", a.frequency_hz);
        }
        for fit in squares.fits() {
            assert_eq!((fit.chi_square, fit.degrees_of_freedom), (None, 0));
        }
    }
}

/// Compares P and N with the separation of waves by the exact propagation coefficient, and the
/// reflection of a free end with -1.
#[test]
fn the_waves_are_those_of_the_rod() {
    let frequency_hz = lines(300.0, 50.0, 100);
    let positions = [0.2, 0.29, 0.5, 0.55];
    let spectra = strains(super::frame::Structure::Free, &positions, &frequency_hz);
    let tests: [&[Vec<Complex64>]; 1] = [&spectra];
    let noise = flat(&[1e-9; 4], 100);
    let result = MultiPoint::new(rod(&positions))
        .unwrap()
        .estimate(&clean(&frequency_hz, &tests, &noise))
        .unwrap();
    for (index, frequency) in frequency_hz.iter().enumerate() {
        let gamma = polypropylene().propagation_coefficient(TAU * frequency);
        let values: Vec<Complex64> = spectra.iter().map(|spectrum| spectrum[index]).collect();
        let known = TravellingWaves::from_sections(gamma, &positions, &values).unwrap();
        let found = result.waves(index, 0, 0.4, Quantity::Strain).unwrap();
        let size = found.forward.norm() + found.backward.norm();
        assert!((found.forward - known.waves.forward_at(0.4)).norm() < 1e-8 * size);
        assert!((found.backward - known.waves.backward_at(0.4)).norm() < 1e-8 * size);
        let end = result.waves(index, 0, 0.8, Quantity::Strain).unwrap();
        assert!(end.sum().norm() < 1e-8 * end.forward.norm());
        // a = -ω² u, ε = ∂u/∂x: at a free end the two waves of the acceleration are equal
        let acceleration = result.waves(index, 0, 0.8, Quantity::Acceleration).unwrap();
        assert!((acceleration.backward / acceleration.forward - 1.0).norm() < 1e-8);
        let expected = (TAU * frequency).powi(2) / gamma * end.forward;
        assert!((acceleration.forward - expected).norm() < 1e-8 * expected.norm());
    }
    assert!(result.waves(0, 1, 0.4, Quantity::Strain).is_none());
    assert!(result.waves(100, 0, 0.4, Quantity::Strain).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any gauges at least 30 mm apart, any structure, any weights and any scale of the spectra,
    /// with noise far below the strains. Three strains have two exact solutions, which are close to
    /// each other near half a wave between gauges; those lines are invalid.
    #[test]
    fn any_gauges_find_the_material(
        first in 0.05..0.2_f64,
        distances in prop::collection::vec(0.03..0.14_f64, 2..5),
        weights in prop::collection::vec(0.1..10.0_f64, 5),
        scale in -9..9_i32,
        structure in 0..3_usize,
    ) {
        let mut positions = vec![first];
        let mut position = first;
        for distance in distances {
            position += distance;
            positions.push(position);
        }
        let frequency_hz = lines(100.0, 50.0, 120);
        let mut spectra = strains(STRUCTURES[structure], &positions, &frequency_hz);
        let scale = 10.0_f64.powi(scale);
        spectra.iter_mut().flatten().for_each(|value| *value *= scale);
        let weights: Vec<f64> = weights.iter().take(positions.len()).map(|w| 1e-12 * scale * w).collect();
        let tests: [&[Vec<Complex64>]; 1] = [&spectra];
        let result = MultiPoint::new(rod(&positions)).unwrap()
            .estimate(&clean(&frequency_hz, &tests, &flat(&weights, 120)))
            .unwrap();
        prop_assert_eq!(result.modulus().lines().len(), 120);
        let mut wrong = 0;
        for line in result.modulus().lines() {
            // tolerance: errors of 1e-12 in the generated strains, amplified as relative errors of
            // the gauges; dE/E is twice dγ/γ
            if error(line) > 1e-11 * (1.0 + line.error_amplification) {
                prop_assert!(!line.validity.is_valid(), "{} Hz: {:e}", line.frequency_hz, error(line));
                wrong += 1;
            }
        }
        prop_assert!(wrong < 12, "{wrong} lines");
    }
}

/// A single line has many possible wave numbers and is reported as ambiguous; a guess of the speed
/// resolves this.
#[test]
fn one_line_needs_a_guess() {
    let frequency_hz = [6000.0];
    let positions = [0.3, 0.4, 0.5];
    let spectra = strains(super::frame::Structure::I, &positions, &frequency_hz);
    let tests: [&[Vec<Complex64>]; 1] = [&spectra];
    let noise = flat(&[0.0; 3], 1);
    let input = clean(&frequency_hz, &tests, &noise);
    let method = MultiPoint::new(rod(&positions)).unwrap();
    let alone = method.estimate(&input).unwrap();
    assert!(matches!(
        alone.modulus().lines()[0].validity.violations(),
        [.., Violation::BranchAmbiguous(_)]
    ));
    let guessed = method.with_wave_speed(1600.0).unwrap();
    let guessed = guessed.estimate(&input).unwrap();
    assert!(worst(guessed.modulus(), 1) < 1e-9);
    assert_eq!(guessed.modulus().valid().count(), 1);
}
