//! A virtual free body with two modes, whose response is known in closed form, the hammers that
//! strike it, and the path of the results.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

use labio::{Channel, LabioError, Provenance, Quantity, Record};
use ndarray::Array2;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Sampling rate \[Hz\].
const RATE: f64 = 51_200.0;
/// Number of samples of a hit: the slowest mode has decayed by 36 nepers at the end.
const N_SAMPLES: usize = 16_384;
/// Mass of the body \[kg\].
pub(crate) const MASS: f64 = 2.0;

/// A mode seen at the face that is struck.
struct Mode {
    frequency_hz: f64,
    damping_ratio: f64,
    modal_mass: f64,
}

const MODES: [Mode; 2] = [
    Mode {
        frequency_hz: 900.0,
        damping_ratio: 0.02,
        modal_mass: 1.6,
    },
    Mode {
        frequency_hz: 2640.0,
        damping_ratio: 0.015,
        modal_mass: 1.1,
    },
];

impl Mode {
    fn pole(&self) -> Complex64 {
        let omega = TAU * self.frequency_hz;
        let damped = omega * (1.0 - self.damping_ratio.powi(2)).sqrt();
        Complex64::new(-self.damping_ratio * omega, damped)
    }

    /// Residue of the mobility at the pole: s/(m (s - p)(s - p*)).
    fn residue(&self) -> Complex64 {
        let pole = self.pole();
        pole / (self.modal_mass * Complex64::new(0.0, 2.0 * pole.im))
    }
}

/// Acceleration after a unit impulse, without the jump of the velocity at the impulse.
fn ringing(time: f64) -> f64 {
    let mode = |mode: &Mode| 2.0 * (mode.residue() * mode.pole() * (mode.pole() * time).exp()).re;
    MODES.iter().map(mode).sum()
}

/// Sum over the samples of the ringing, each multiplied by $`e^{-i\omega t}`$ \[1/kg\]: two
/// geometric series per mode. The first sample counts half.
fn sampled_ringing(frequency_hz: f64) -> Complex64 {
    let omega = TAU * frequency_hz;
    let series = |residue: Complex64, pole: Complex64| {
        let ratio = ((pole - Complex64::new(0.0, omega)) / RATE).exp();
        residue * pole * (1.0 / (1.0 - ratio) - 0.5) / RATE
    };
    let mode = |mode: &Mode| {
        let (residue, pole) = (mode.residue(), mode.pole());
        series(residue, pole) + series(residue.conj(), pole.conj())
    };
    MODES.iter().map(mode).sum()
}

/// Jump of the velocity per impulse \[1/kg\], chosen so that the accelerance of the sampled body at
/// 0 Hz is the reciprocal of its mass.
fn jump() -> f64 {
    1.0 / MASS - sampled_ringing(0.0).re
}

/// Accelerance \[1/kg\] of the sampled body.
pub(crate) fn accelerance(frequency_hz: f64) -> Complex64 {
    jump() + sampled_ringing(frequency_hz)
}

/// A hammer, and the noise of the measured force and acceleration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hammer {
    /// Mean peak force \[N\]; hits differ by a tenth.
    pub(crate) peak_force: f64,
    /// Duration of contact \[s\], a half-sine.
    pub(crate) contact: f64,
    /// Standard deviation of the noise on the force \[N\].
    pub(crate) force_noise: f64,
    /// Standard deviation of the noise on the acceleration \[m/s^2\].
    pub(crate) acceleration_noise: f64,
}

impl Hammer {
    /// Returns force and acceleration of `n_hits` hits.
    pub(crate) fn strike(&self, n_hits: usize, seed: u64) -> Result<Vec<Record>, LabioError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let channels = vec![
            Channel::new("hammer", Quantity::Force)?,
            Channel::new("face", Quantity::Acceleration)?,
        ];
        let impulse_response: Vec<f64> = (0..N_SAMPLES)
            .map(|n| ringing(n as f64 / RATE) * if n == 0 { 0.5 } else { 1.0 })
            .collect();
        let begin = 100;
        let mut hits = Vec::with_capacity(n_hits);
        for _ in 0..n_hits {
            let peak = self.peak_force * (1.0 + 0.1 * normal());
            let mut samples = Array2::zeros((2, N_SAMPLES));
            for n in begin..N_SAMPLES {
                let time = (n - begin) as f64 / RATE;
                if time >= self.contact {
                    break;
                }
                let force = peak * (PI * time / self.contact).sin();
                samples[(0, n)] = force;
                samples[(1, n)] += jump() * force;
                for (lag, response) in impulse_response[..N_SAMPLES - n].iter().enumerate() {
                    samples[(1, n + lag)] += force * response / RATE;
                }
            }
            for n in 0..N_SAMPLES {
                samples[(0, n)] += self.force_noise * normal();
                samples[(1, n)] += self.acceleration_noise * normal();
            }
            let provenance = Provenance::computed("free body with two modes");
            hits.push(Record::new(
                samples,
                RATE,
                0.0,
                channels.clone(),
                provenance,
            )?);
        }
        Ok(hits)
    }
}

/// Path from the command line, or that of the file `name` in `target/examples`.
pub(crate) fn table_path(name: &str) -> Result<PathBuf, Box<dyn Error>> {
    if let Some(path) = std::env::args_os().nth(1) {
        return Ok(path.into());
    }
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .ok_or("the crate lies in the folder crates of its workspace")?;
    let folder = workspace.join("target/examples");
    std::fs::create_dir_all(&folder)?;
    Ok(folder.join(name))
}
