//! Kernels of the modulus: the two-point method with its branches, and a Prony series whose order
//! is chosen.

use std::f64::consts::TAU;
use std::hint::black_box;

use cmod::rheology::{FitOptions, ModulusData, ModulusPoint, PronyFit};
use cmod::two_point::{AveragedRatio, SpecimenUncertainty};
use cmod::{Specimen, TwoPoint};
use num_complex::Complex64;
use rodwave::modulus::{ComplexModulus, FractionalZener};

use super::{Kernel, noise};

const LINES: u32 = 1024;

pub(super) const TWO_POINT: Kernel = Kernel {
    name: "two-point",
    what: "two-point method by continuation, with branches and all errors, 1024 lines",
    of: "line",
    count: LINES,
    prepare: || {
        // test 6 of paper A, up to 20 kHz
        let specimen = Specimen {
            length: 0.799,
            diameter: 0.0158,
            density: 912.0,
            accelerometer_mass: 2.9e-3,
        };
        let method = TwoPoint::new(specimen)?.with_specimen_uncertainty(SpecimenUncertainty {
            length: 5e-4,
            diameter: 5e-5,
            density: 1.0,
            accelerometer_mass: 5e-5,
        })?;
        let mut state = 1;
        let frequency_hz: Vec<f64> = (1..=LINES)
            .map(|line| 20e3 / f64::from(LINES) * f64::from(line))
            .collect();
        let acceleration_ratio: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| {
                let x = Complex64::new(0.035, 1.0) * (TAU * f / 1680.0 * specimen.length);
                let error = Complex64::new(noise(&mut state), noise(&mut state)) * 7e-3;
                (x.cosh() + specimen.mass_ratio() * x * x.sinh()) * (1.0 + error)
            })
            .collect();
        let coherence = vec![1.0 - 9e-5; frequency_hz.len()];
        Ok(Box::new(move || {
            black_box(method.estimate_averaged(black_box(&AveragedRatio {
                frequency_hz: &frequency_hz,
                acceleration_ratio: &acceleration_ratio,
                coherence: &coherence,
                averages: 10.0,
            }))?);
            Ok(())
        }))
    },
};

pub(super) const PRONY_ORDER: Kernel = Kernel {
    name: "prony-order",
    what: "Prony series of chosen order to 60 points of a fractional law over five decades",
    of: "point",
    count: 60,
    prepare: || {
        let law = FractionalZener::new(1e8, 2e9, 1e-4, 0.35)?;
        let mut state = 2;
        let points: Vec<ModulusPoint> = (0..60_u32)
            .map(|j| {
                let frequency_hz = 10_f64.powf(f64::from(j) / 12.0);
                let modulus = law.at(TAU * frequency_hz);
                let sigma = 0.01 * modulus.norm();
                // noise of unit variance in the real and in the imaginary part
                let error = Complex64::new(noise(&mut state), noise(&mut state)) * 12_f64.sqrt();
                ModulusPoint::circular(frequency_hz, modulus + sigma * error, sigma)
            })
            .collect();
        let data = ModulusData::new(&points)?;
        let options = FitOptions::default().with_profiles(false);
        Ok(Box::new(move || {
            let chosen = PronyFit::new(black_box(&data), &options)?;
            black_box(chosen.orders.len());
            Ok(())
        }))
    },
};
