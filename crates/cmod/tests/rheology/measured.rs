//! Moduli of a law with Gaussian noise of a given covariance.

use std::f64::consts::TAU;

use cmod::estimate::ComplexCovariance;
use cmod::rheology::{ModulusData, ModulusPoint};
use num_complex::Complex64;
use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell, MaxwellBranch};

use testbed::noise;

/// Returns frequencies at equal ratios.
pub(crate) fn logarithmic(from: f64, to: f64, lines: u32) -> Vec<f64> {
    let step = (to / from).ln() / f64::from(lines - 1);
    (0..lines)
        .map(|j| from * (step * f64::from(j)).exp())
        .collect()
}

/// Noise of E' and of E'', relative to |E|, and their correlation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    pub(crate) storage: f64,
    pub(crate) loss: f64,
    pub(crate) correlation: f64,
}

impl Noise {
    pub(crate) const fn circular(share: f64) -> Self {
        Self {
            storage: share,
            loss: share,
            correlation: 0.0,
        }
    }

    pub(crate) const CORRELATED: Self = Self {
        storage: 0.01,
        loss: 0.004,
        correlation: 0.6,
    };
}

pub(crate) fn points(
    law: impl Fn(f64) -> Complex64,
    frequency_hz: &[f64],
    noise: Noise,
    seed: u64,
) -> Vec<ModulusPoint> {
    let mut random = noise::Noise::seeded(seed);
    frequency_hz
        .iter()
        .map(|&frequency_hz| {
            let modulus = law(TAU * frequency_hz);
            let (a, b) = (noise.storage * modulus.norm(), noise.loss * modulus.norm());
            let (x, y) = (random.normal(), random.normal());
            let r = noise.correlation;
            let error = Complex64::new(a * x, b * (r * x + (1.0 - r * r).sqrt() * y));
            ModulusPoint {
                frequency_hz,
                modulus: modulus + error,
                covariance: ComplexCovariance {
                    real: a * a,
                    imaginary: b * b,
                    mixed: r * a * b,
                },
            }
        })
        .collect()
}

pub(crate) fn measured(
    law: impl Fn(f64) -> Complex64,
    frequency_hz: &[f64],
    noise: Noise,
    seed: u64,
) -> ModulusData {
    ModulusData::new(&points(law, frequency_hz, noise, seed)).unwrap()
}

/// Returns moduli with circular noise, relative to the modulus.
pub(crate) fn with_noise(
    law: &dyn ComplexModulus,
    frequency_hz: &[f64],
    share: f64,
    seed: u64,
) -> ModulusData {
    measured(|w| law.at(w), frequency_hz, Noise::circular(share), seed)
}

/// Returns a generalised Maxwell law with these moduli and relaxation times.
pub(crate) fn series(equilibrium: f64, branches: &[(f64, f64)]) -> GeneralisedMaxwell {
    let branch = |&(modulus, relaxation_time): &(f64, f64)| MaxwellBranch {
        modulus,
        relaxation_time,
    };
    let branches = branches.iter().map(branch).collect();
    GeneralisedMaxwell::new(equilibrium, branches).unwrap()
}
