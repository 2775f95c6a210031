//! Stated standard errors compared with repeated noise, and the effect of strong noise.

use std::f64::consts::TAU;

use cmod::RatioOfSpectra;
use cmod::estimate::ModulusEstimate;
use num_complex::Complex64;

use super::methods::{Belief, methods, resonances};
use super::rod::{lines, polypropylene};
use testbed::noise::Noise;

/// Returns the ratio over four tests with noise of `noise` times the root mean square of the two
/// signals of each line.
fn measured(spectra: &[[Complex64; 2]], noise: f64, random: &mut Noise) -> RatioOfSpectra {
    let level: Vec<f64> = spectra
        .iter()
        .map(|[n, d]| noise * (0.5 * (n.norm_sqr() + d.norm_sqr())).sqrt())
        .collect();
    let mut tests = vec![[Vec::new(), Vec::new()]; 4];
    for [numerator, denominator] in &mut tests {
        for (pair, level) in spectra.iter().zip(&level) {
            numerator.push(pair[0] + random.circular(level * level));
            denominator.push(pair[1] + random.circular(level * level));
        }
    }
    let numerators: Vec<&[Complex64]> = tests.iter().map(|test| test[0].as_slice()).collect();
    let denominators: Vec<&[Complex64]> = tests.iter().map(|test| test[1].as_slice()).collect();
    RatioOfSpectra::new(&numerators, &denominators, &level, &level).unwrap()
}

/// Compares the stated errors of E', E'' and E''/E' with repetitions of noise in four tests each.
/// The mean squares are compared, because the errors differ slightly from repetition to repetition.
fn assert_scatter(
    name: &str,
    repetitions: u32,
    count: usize,
    mut estimate: impl FnMut() -> ModulusEstimate,
) {
    let mut sums = vec![[[0.0; 2]; 3]; count];
    for _ in 0..repetitions {
        let noisy = estimate();
        assert_eq!(noisy.lines().len(), count, "{name}");
        for (line, sums) in noisy.lines().iter().zip(&mut sums) {
            let exact = polypropylene().modulus(TAU * line.frequency_hz);
            let error = line.modulus - exact;
            let stated = line.standard_error;
            let pairs = [
                (error.re, stated.storage_modulus),
                (error.im, stated.loss_modulus),
                (line.loss_factor - exact.im / exact.re, stated.loss_factor),
            ];
            for (sum, (error, stated)) in sums.iter_mut().zip(pairs) {
                sum[0] += error * error;
                sum[1] += stated * stated;
            }
        }
    }
    for (line, sums) in sums.into_iter().enumerate() {
        for [found, expected] in sums {
            // tolerance: four times the scatter of a root mean square of n values, 1/√(2n)
            let ratio = f64::sqrt(found / expected);
            let tolerance = 4.0 / f64::from(2 * repetitions).sqrt();
            assert!(
                (ratio - 1.0).abs() < tolerance,
                "{name}, line {line}: {ratio}"
            );
        }
    }
}

#[test]
fn standard_errors_are_those_of_repeated_noise() {
    // Sections and lines away from singular lines, where the errors are of first order only.
    let frequency_hz = lines(12, 620.0);
    let certain = Belief::certain(Some(1700.0));
    for method in methods(&frequency_hz) {
        let mut random = Noise::seeded(1988);
        let mut noisy = || {
            let measured = measured(&method.spectra, 3e-3, &mut random);
            method.estimate(&certain, &measured.ratio, &measured.variance)
        };
        noisy();
        assert_scatter(method.name, 3000, frequency_hz.len(), noisy);
    }
    // the polynomial at a resonance averages the noise of its lines
    let method = resonances(lines(260, 10.0));
    let mut random = Noise::seeded(1970);
    assert_scatter("resonances", 1000, 3, || {
        let measured = measured(&method.spectra, 0.01, &mut random);
        method.estimate(&certain, &measured.ratio, &measured.variance)
    });
}

/// With noise of 5 % and a fifth of the lines missing, every line that is reported as valid is on
/// the right branch.
#[test]
fn valid_lines_are_on_their_branch_whatever_the_noise() {
    let frequency_hz = lines(300, 40.0);
    let medium = polypropylene();
    let certain = Belief::certain(None);
    for method in methods(&frequency_hz) {
        let (name, mut kept) = (method.name, 0);
        for seed in 0..20 {
            let mut random = Noise::seeded(seed);
            let mut ratio = measured(&method.spectra, 0.05, &mut random);
            for psi in &mut ratio.ratio {
                if random.normal() < -0.8416 {
                    *psi = Complex64::new(f64::NAN, 0.0);
                }
            }
            let estimate = method.estimate(&certain, &ratio.ratio, &ratio.variance);
            for line in estimate.valid() {
                kept += 1;
                let exact = medium.propagation_coefficient(TAU * line.frequency_hz);
                // on another branch γ times the longest distance, 0.6 m, would be wrong by π/2 or
                // more; errors due to noise are smaller
                let away = (line.propagation_coefficient - exact).norm() * 0.6;
                assert!(
                    away < 0.8,
                    "{name}, seed {seed}, {} Hz: {away}",
                    line.frequency_hz
                );
            }
        }
        // of 6000 lines a fifth is missing, and lines near singular lines or below condition (ii)
        // are not valid
        assert!(kept > 2000, "{name}: {kept}");
    }
}
