//! Two masses with a spring and a dashpot between them, struck by a virtual hammer: integrated in
//! time, and with mobilities in closed form.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::runge_kutta::after_step;
use crate::runs::Folder;

pub(crate) const RATE: f64 = 51_200.0;
pub(crate) const SAMPLES: usize = 2048;

/// Two masses with a spring and a dashpot between them.
#[derive(Clone, Copy)]
pub(crate) struct Body {
    pub(crate) struck: f64,
    pub(crate) behind: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
}

/// A body that rings at 1.7 kHz for 10 ms.
pub(crate) const BODY: Body = Body {
    struck: 1.0,
    behind: 0.5,
    stiffness: 4e7,
    damping: 400.0,
};

impl Body {
    pub(crate) fn mobility(self, frequency_hz: f64) -> Complex64 {
        let s = Complex64::new(0.0, TAU * frequency_hz);
        let link = self.stiffness + self.damping * s;
        let both = self.struck * self.behind * s * s + (self.struck + self.behind) * link;
        (self.behind * s * s + link) / (s * both)
    }

    /// Velocity of the other mass divided by a force on the struck mass.
    pub(crate) fn transfer(self, frequency_hz: f64) -> Complex64 {
        let s = Complex64::new(0.0, TAU * frequency_hz);
        let link = self.stiffness + self.damping * s;
        let both = self.struck * self.behind * s * s + (self.struck + self.behind) * link;
        link / (s * both)
    }

    /// Accelerations of the struck mass and of the other \[m/s²\] under `force`, sampled at
    /// [`RATE`], by the classical Runge-Kutta method in eight steps per sample: the error of a step
    /// is (omega h)^5/120 = 1e-10.
    pub(crate) fn accelerations(self, force: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        const STEPS: usize = 8;
        let step = 1.0 / (RATE * STEPS as f64);
        let link = |state: [f64; 4]| {
            self.stiffness * (state[0] - state[2]) + self.damping * (state[1] - state[3])
        };
        let rate = |time: f64, state: [f64; 4]| {
            let pull = link(state);
            [
                state[1],
                (force(time) - pull) / self.struck,
                state[3],
                pull / self.behind,
            ]
        };
        let mut state = [0.0; 4];
        let mut samples = Vec::with_capacity(SAMPLES);
        for sample in 0..SAMPLES {
            let start = sample as f64 / RATE;
            let pull = link(state);
            samples.push([(force(start) - pull) / self.struck, pull / self.behind]);
            for n in 0..STEPS {
                state = after_step(state, start + n as f64 * step, step, rate);
            }
        }
        samples
    }
}

/// Hammer and noise of a test.
#[derive(Clone, Copy)]
pub(crate) struct Hammer {
    /// Length of the pulse \[s\], a raised cosine.
    pub(crate) pulse: f64,
    /// Standard deviation of the noise of the accelerometer [m/s²].
    pub(crate) noise: f64,
    pub(crate) hits: usize,
    pub(crate) seed: u64,
    /// Peak of the first hit \[N\]; each further hit is 20 N harder.
    pub(crate) peak: f64,
}

pub(crate) const HAMMER: Hammer = Hammer {
    pulse: 0.3e-3,
    noise: 0.5,
    hits: 8,
    seed: 3,
    peak: 170.0,
};

/// Writes `{prefix}N.csv`: time, force, accelerations of the struck mass and of the other mass.
pub(crate) fn strike(folder: &Path, prefix: &str, body: Body, hammer: Hammer) {
    let noise = |seed| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        move || {
            // normal numbers by the method of Box and Muller
            let (a, b): (f64, f64) = (random.random(), random.random());
            (-2.0 * (1.0 - a).ln()).sqrt() * (TAU * b).cos()
        }
    };
    let mut normal = noise(hammer.seed);
    let mut normal_behind = noise(hammer.seed + 1000);
    for hit in 1..=hammer.hits {
        let peak = hammer.peak + 20.0 * (hit - 1) as f64;
        let begin = 4e-3;
        let force = |time: f64| {
            let phase = (time - begin) / hammer.pulse;
            if (0.0..1.0).contains(&phase) {
                0.5 * peak * (1.0 - (TAU * phase).cos())
            } else {
                0.0
            }
        };
        let mut text = "time [s],force [N],acceleration [m/s^2],behind [m/s^2]\n".to_owned();
        for (n, [acceleration, behind]) in body.accelerations(force).iter().enumerate() {
            let time = n as f64 / RATE;
            let felt = force(time) + 0.01 * normal();
            let noisy = acceleration + hammer.noise * normal();
            let behind = behind + hammer.noise * normal_behind();
            writeln!(text, "{time:.9},{felt},{noisy},{behind}").unwrap();
        }
        fs::write(folder.join(format!("{prefix}{hit}.csv")), text).unwrap();
    }
}

/// A folder with these hits.
pub(crate) fn struck(prefix: &str, body: Body, hammer: Hammer) -> Folder {
    let folder = Folder::new();
    strike(folder.path(), prefix, body, hammer);
    folder
}
