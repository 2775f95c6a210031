//! Tests with noise: the stated errors must cover the truth, and the branch must not be lost.

use std::f64::consts::TAU;

use cmod::multi_point::Quantity;
use cmod::validity::AcceptanceLimits;
use cmod::{ModulusLine, MultiPoint};
use num_complex::Complex64;
use rand_distr::{Distribution, Uniform};
use rodwave::waves::TravellingWaves;

use crate::virtual_rig::coverage::Coverage;
use testbed::noise::Noise;

use super::frame::{
    STRUCTURES, Structure, clean, flat, lines, noisy, polypropylene, rod, size, strains,
};

const SEEDS: u64 = 200;

/// Factors of the standard error within which errors are counted.
const FACTORS: [f64; 2] = [1.0, 2.0];
/// Fractions of normal errors within [`FACTORS`], with tolerances above the sampling error, which
/// is at most 0.7 % for 5000 values or more.
const USUAL: [(f64, f64); 2] = [(0.683, 0.05), (0.9545, 0.02)];
/// Fractions with tolerances for some 25 000 values: four times their scatter of 0.3 % and 0.13 %.
const OF_25_000: [(f64, f64); 2] = [(0.683, 0.012), (0.9545, 0.0055)];

fn add(coverage: &mut Coverage, line: &ModulusLine) {
    let exact = polypropylene().modulus(TAU * line.frequency_hz);
    coverage.add_with(line, exact, FACTORS);
}

/// Returns lines from 500 Hz to 8 kHz and the noise of the gauges, relative to the root mean square
/// of all strains.
fn set_up(
    structure: Structure,
    positions: &[f64],
    relative: &[f64],
) -> (Vec<f64>, Vec<Vec<Complex64>>, Vec<Vec<f64>>) {
    let frequency_hz = lines(500.0, 100.0, 76);
    let spectra = strains(structure, positions, &frequency_hz);
    let size = size(&spectra);
    let noise: Vec<f64> = relative.iter().map(|noise| noise * size).collect();
    let noise = flat(&noise, frequency_hz.len());
    (frequency_hz, spectra, noise)
}

fn least_squares(positions: &[f64]) -> MultiPoint {
    MultiPoint::new(rod(positions))
        .and_then(|method| method.with_limits(AcceptanceLimits::NONE))
        .unwrap()
}

#[test]
fn least_squares_state_their_errors() {
    let positions = [0.2, 0.27, 0.4, 0.45, 0.6];
    for structure in STRUCTURES {
        let (frequency_hz, spectra, noise) =
            set_up(structure, &positions, &[1e-2, 5e-3, 1e-2, 3e-2, 1e-2]);
        let method = least_squares(&positions);
        let mut coverage = Coverage::default();
        let (mut chi_square, mut freedom, mut misfits, mut lines) = (0.0, 0.0, 0.0, 0.0);
        for seed in 0..SEEDS {
            let strains = noisy(&spectra, &noise, seed);
            let result = method
                .estimate(&clean(&frequency_hz, &[&strains], &noise))
                .unwrap();
            result
                .modulus()
                .valid()
                .for_each(|line| add(&mut coverage, line));
            for fit in result.fits() {
                chi_square += fit.chi_square.unwrap();
                freedom += fit.degrees_of_freedom as f64;
                lines += 1.0;
            }
            for line in result.modulus().lines() {
                misfits += f64::from(line.validity.to_string().contains("misfit"));
            }
        }
        coverage.check_within(&format!("{structure:?}"), USUAL);
        if structure == Structure::I {
            coverage.check_within("I", OF_25_000);
        }
        // 15 200 lines with 4 degrees of freedom each: the mean has a standard error of 0.6 %
        assert!((chi_square / freedom - 1.0).abs() < 0.024);
        // about 15 lines, one in a thousand, are expected by chance
        assert!(misfits < 0.003 * lines, "{misfits} of {lines}");
    }
}

/// Evaluates ten tests of paper B together: the error decreases by √10, and is still stated
/// correctly.
#[test]
fn ten_tests_together_state_their_errors() {
    let positions = [0.25, 0.35, 0.55];
    let (frequency_hz, spectra, noise) = set_up(Structure::II, &positions, &[2e-2; 3]);
    let method = least_squares(&positions);
    let mut coverage = Coverage::default();
    let mut waves = Coverage::default();
    let mut single = Coverage::default();
    for seed in 0..SEEDS / 2 {
        let tests: Vec<_> = (0..10)
            .map(|test| noisy(&spectra, &noise, 1000 * seed + test))
            .collect();
        let tests: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
        let result = method
            .estimate(&clean(&frequency_hz, &tests, &noise))
            .unwrap();
        for (index, line) in result.modulus().lines().iter().enumerate() {
            if !line.validity.is_valid() {
                continue;
            }
            add(&mut coverage, line);
            // the strain at a section beyond the gauges, from the waves of one test
            let found = result.waves(index, 3, 0.6, Quantity::Strain).unwrap();
            let exact = truth(&spectra, &positions, line).at(0.6);
            let error = found.sum() - exact;
            let stated = (0.5 * found.sum_variance()).sqrt();
            waves.add_error(error, [stated; 2], FACTORS);
            // each wave is converted to a velocity: v = iω u, ε = -γu for P and γu for N
            let found = result.waves(index, 3, 0.1, Quantity::Velocity).unwrap();
            let exact = truth(&spectra, &positions, line);
            let gamma = polypropylene().propagation_coefficient(TAU * line.frequency_hz);
            let velocity = Complex64::new(0.0, TAU * line.frequency_hz) / gamma;
            let forward = found.forward + velocity * exact.forward_at(0.1);
            let backward = found.backward - velocity * exact.backward_at(0.1);
            let stated = [found.forward_variance, found.backward_variance];
            let stated = stated.map(|variance| (0.5 * variance).sqrt());
            single.add_error(Complex64::new(forward.re, backward.im), stated, FACTORS);
        }
    }
    coverage.check_within("modulus", USUAL);
    waves.check_within("sum of the waves", USUAL);
    single.check_within("single waves", USUAL);
}

/// Returns the waves of the strain, from the gauges without noise and the exact γ.
fn truth(spectra: &[Vec<Complex64>], positions: &[f64], line: &ModulusLine) -> TravellingWaves {
    let gamma = polypropylene().propagation_coefficient(TAU * line.frequency_hz);
    let values: Vec<Complex64> = spectra.iter().map(|s| s[line.index]).collect();
    let found = TravellingWaves::from_sections(gamma, positions, &values);
    found.unwrap().waves
}

/// A fifth of the lines is arbitrary and the others have 5 % noise: the count of waves stays right
/// on all the other lines.
#[test]
fn the_branch_survives_bad_lines() {
    let positions = [0.2, 0.27, 0.4, 0.45, 0.6];
    let frequency_hz = lines(100.0, 25.0, 400);
    let spectra = strains(Structure::I, &positions, &frequency_hz);
    // relative to the root mean square of the five gauges on each line
    let relative = |factor: f64| -> Vec<Vec<f64>> {
        let of_line = |index: usize| {
            let power: f64 = spectra.iter().map(|s| s[index].norm_sqr()).sum();
            factor * (power / 5.0).sqrt()
        };
        vec![(0..frequency_hz.len()).map(of_line).collect(); 5]
    };
    let (noise, rubbish) = (relative(0.05), relative(1.0));
    let method = least_squares(&positions);
    for seed in 0..20 {
        let mut strains = noisy(&spectra, &noise, seed);
        let nothing = vec![vec![Complex64::ZERO; frequency_hz.len()]; 5];
        let bad_lines = noisy(&nothing, &rubbish, 100 + seed);
        let mut random = Noise::seeded(seed).0;
        let chance = Uniform::new(0.0, 1.0).unwrap();
        let bad: Vec<bool> = frequency_hz
            .iter()
            .map(|_| chance.sample(&mut random) < 0.2)
            .collect();
        for (spectrum, rubbish) in strains.iter_mut().zip(&bad_lines) {
            for (index, bad) in bad.iter().enumerate() {
                if *bad {
                    spectrum[index] = rubbish[index];
                }
            }
        }
        let result = method
            .estimate(&clean(&frequency_hz, &[&strains], &noise))
            .unwrap();
        let mut valid = 0;
        for line in result.modulus().valid() {
            if bad[line.index] {
                continue;
            }
            valid += 1;
            let exact = polypropylene().propagation_coefficient(TAU * line.frequency_hz);
            let error = (line.propagation_coefficient - exact).norm();
            // an error of half a wave over the aperture would give 7.9
            assert!(
                error < 3.0,
                "seed {seed}, {} Hz: {error}",
                line.frequency_hz
            );
        }
        assert!(valid > 200, "seed {seed}: {valid} valid lines");
    }
}
