//! Modes of a ringing rod: waves to and fro with losses, not sums of modes; noise, a converter, and what a laboratory does wrong.

use std::f64::consts::TAU;

use cmod::estimate::ErrorSource;
use cmod::{FreeVibration, RodWithFreeEnd, SectionUncertainty};
use num_complex::Complex64;
use rodwave::fourier::RealFourier;
use testbed::noise::Noise;

const LENGTH: f64 = 0.6;
const DENSITY: f64 = 7800.0;
const RATE: f64 = 48e3;

/// E of a metal with a loss that changes slowly with frequency.
fn modulus(s: Complex64, loss: f64) -> Complex64 {
    206e9 * (s / (TAU * 5e3)).powf(loss * 2.0 / std::f64::consts::PI)
}

fn rod(end_mass: f64) -> RodWithFreeEnd {
    RodWithFreeEnd {
        diameter: 0.012,
        density: DENSITY,
        end_mass,
    }
}

/// Acceleration of the far end, which carries a mass, after a blow of a half sine on the near one: on a damped line of the Laplace transform.
fn ringing(loss: f64, end_mass: f64, n_samples: usize) -> Vec<f64> {
    let n = 4 * n_samples;
    let period = n as f64 / RATE;
    let damping = 16.0 / period;
    let mut transform = RealFourier::new(n);
    let duration = 60e-6;
    let area = std::f64::consts::FRAC_PI_4 * 0.012 * 0.012;
    for (line, value) in transform.lines().iter_mut().enumerate() {
        let s = Complex64::new(damping, TAU * line as f64 / period);
        let e = modulus(s, loss);
        let gamma = s * (DENSITY / e).sqrt();
        let w = std::f64::consts::PI / duration;
        // half sine of 1 kN
        let force = 1e3 * w * (1.0 + (-s * duration).exp()) / (s * s + w * w);
        let way = gamma * LENGTH;
        let echo = (-2.0 * way).exp();
        let mass = end_mass * s * s / (area * e * gamma);
        // cosh and sinh without overflow
        let (cosh, sinh) = (0.5 * (1.0 + echo), 0.5 * (1.0 - echo));
        *value = s * s * force * (-way).exp() / (area * e * gamma * (sinh + mass * cosh));
        // far above the modes that are read
        *value *= (-0.5 * (s.im / (TAU * 18e3)).powi(8)).exp();
    }
    let history = transform.inverse();
    let samples = history.iter().take(n_samples).enumerate();
    samples
        .map(|(index, x)| x / period * (damping * index as f64 / RATE).exp())
        .collect()
}

/// What a recorder of 16 bits with noise makes of it, from 2 ms on.
fn recorded(exact: &[f64], noise: f64, seed: u64) -> Vec<f64> {
    let largest = exact.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let step = largest / 32768.0;
    let mut normal = Noise::seeded(seed);
    exact[96..]
        .iter()
        .map(|x| ((x + noise * largest * normal.normal()) / step).round() * step)
        .collect()
}

fn method(end_mass: f64) -> FreeVibration {
    FreeVibration::new(rod(end_mass), LENGTH, 5000.0).unwrap()
}

#[test]
fn free_vibration_of_a_ringing_bar_tells_a_loss_of_one_in_ten_thousand() {
    for (loss, seconds, end_mass) in [
        (1e-4, 1.0, 0.0),
        (1e-4, 1.0, 0.004),
        (1e-5, 2.0, 0.0),
        (2e-3, 0.5, 0.0),
    ] {
        let exact = ringing(loss, end_mass, (seconds * RATE) as usize);
        let (mut within, mut count) = ([[0.0; 2]; 2], 0.0);
        for seed in 0..20 {
            let record = recorded(&exact, 1e-3, seed);
            let poles = method(end_mass).poles(&[&record], RATE).unwrap();
            assert_eq!(poles.strongest_elsewhere, None);
            let estimate = method(end_mass).estimate(&poles.found).unwrap();
            assert!(estimate.lines().len() >= 3, "{:?}", poles.missing);
            for line in estimate.lines() {
                let truth = modulus(Complex64::new(0.0, TAU * line.frequency_hz), loss);
                let storage = line.modulus.re / truth.re - 1.0;
                let factor = line.loss_factor - truth.im / truth.re;
                assert!(storage.abs() < 1e-4, "E' off by {storage:e}");
                let z = [
                    storage * truth.re / line.standard_error.storage_modulus,
                    factor / line.standard_error.loss_factor,
                ];
                for (within, z) in within.iter_mut().zip(z) {
                    within[0] += f64::from(z.abs() <= 1.0);
                    within[1] += f64::from(z.abs() <= 1.96);
                }
                count += 1.0;
                if seed == 0 {
                    println!(
                        "{loss:e} {:.1} Hz: {storage:.1e} ± {:.1e}, {:.3e} ± {:.1e}, z {z:.2?}",
                        line.frequency_hz,
                        line.standard_error.storage_modulus / truth.re,
                        line.loss_factor,
                        line.standard_error.loss_factor
                    );
                }
            }
        }
        println!("{loss:e}: {within:?} of {count}");
        for [one, two] in within {
            // 60 values or more: 6 and 3 %, three of each
            assert!((0.5..0.86).contains(&(one / count)), "{one} of {count}");
            assert!(two / count > 0.86, "{two} of {count}");
        }
    }
}
