//! A struck body of three modes, integrated in time.

use super::*;

/// A free body of 2 kg with modes of 310, 640 and 1130 Hz, struck by a squared sine with a peak of
/// 0.1 kN and a duration of 1.2 ms. Its motion is integrated in time and compared with the closed
/// form in frequency.
pub(super) struct Body {
    /// Decay rate of the modes \[1/s\].
    pub(super) decay: f64,
    /// Noise of force and motion, divided by their peaks.
    pub(super) noise: f64,
    pub(super) quantity: Quantity,
}

impl Body {
    const MASS: f64 = 2.0;
    const MODES: [(f64, f64); 3] = [(310.0, 0.8), (640.0, 1.5), (1130.0, 1.1)];
    pub(super) const SAMPLES: usize = 4096;
    const BLOW: f64 = 0.0012;

    /// Motion divided by force at s.
    pub(super) fn response(&self, s: Complex64) -> Complex64 {
        let receptance = Self::MODES
            .iter()
            .map(|(f, mass)| {
                let damped = s + self.decay;
                1.0 / (mass * (damped * damped + (TAU * f).powi(2)))
            })
            .sum::<Complex64>()
            + 1.0 / (Self::MASS * s * s);
        match self.quantity {
            Quantity::Displacement => receptance,
            Quantity::Velocity => s * receptance,
            _ => s * s * receptance,
        }
    }

    /// Force and motion of a hit without noise.
    pub(super) fn clean(&self, rng: &mut Noise) -> [Vec<f64>; 2] {
        const STEPS: usize = 8;
        let peak = 100.0 * (1.0 + 0.2 * rng.0.random::<f64>());
        let onset = (400.0 + 30.0 * rng.0.random::<f64>()) / RATE_HZ;
        let force = |t: f64| {
            let t = t - onset;
            peak * half_sine(t / Self::BLOW).powi(2)
        };
        // the rigid motion is a mode of frequency zero
        let modes: Vec<(f64, f64, f64)> = std::iter::once((0.0, 0.0, Self::MASS))
            .chain(Self::MODES.map(|(f, mass)| (TAU * f, self.decay, mass)))
            .collect();
        let h = 1.0 / RATE_HZ / STEPS as f64;
        let mut state = vec![[0.0_f64; 2]; modes.len()];
        let acceleration = |[x, v]: [f64; 2], f: f64, (omega, decay, mass): (f64, f64, f64)| {
            f / mass - 2.0 * decay * v - (omega * omega + decay * decay) * x
        };
        let (mut forces, mut motion) = (Vec::new(), Vec::new());
        for k in 0..Self::SAMPLES {
            let t = k as f64 / RATE_HZ;
            forces.push(force(t));
            motion.push(
                state
                    .iter()
                    .zip(&modes)
                    .map(|(x, mode)| match self.quantity {
                        Quantity::Displacement => x[0],
                        Quantity::Velocity => x[1],
                        _ => acceleration(*x, force(t), *mode),
                    })
                    .sum(),
            );
            for step in 0..STEPS {
                let t = t + step as f64 * h;
                for (x, mode) in state.iter_mut().zip(&modes) {
                    let rates = |x: [f64; 2], t: f64| [x[1], acceleration(x, force(t), *mode)];
                    let by = |k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
                    let k1 = rates(*x, t);
                    let k2 = rates(by(k1, h / 2.0), t + h / 2.0);
                    let k3 = rates(by(k2, h / 2.0), t + h / 2.0);
                    let k4 = rates(by(k3, h), t + h);
                    for i in 0..2 {
                        x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
                    }
                }
            }
        }
        [forces, motion]
    }

    pub(super) fn hits(&self, count: usize, seed: u64) -> Vec<Record> {
        let mut rng = Noise::seeded(seed);
        (0..count)
            .map(|_| {
                let clean = self.clean(&mut rng);
                let peaks = clean
                    .each_ref()
                    .map(|x| x.iter().fold(0.0_f64, |p, x| p.max(x.abs())));
                let samples = Array2::from_shape_fn((2, Self::SAMPLES), |(channel, k)| {
                    clean[channel][k] + self.noise * peaks[channel] * rng.normal()
                });
                moving(samples, self.quantity)
            })
            .collect()
    }
}

pub(super) fn moving(samples: Array2<f64>, quantity: Quantity) -> Record {
    record_of(
        samples,
        RATE_HZ,
        &[(FORCE, Quantity::Force), ("motion", quantity)],
    )
}
