//! Forces from virtual responses of a struck rod, which are computed by the Laplace transform on a
//! damped line and inverted with frequency responses on the axis.

use std::f64::consts::TAU;

use impulse::{Reconstruction, ResponseNoise, Sensor, TimeInterval};
use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rodwave::chain::{AnalyticChain, Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;

use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;

const RATE_HZ: f64 = 50e3;
const SAMPLES: usize = 2048;
/// Ratio of the rate at which the responses are computed to the sampling rate.
const FINER: usize = 4;
/// The force: ½P (1 - cos 2π(t - t₀)/T), in N and s.
const PEAK: f64 = 800.0;
const BEGIN: f64 = 0.4e-3;
const LASTS: f64 = 0.8e-3;
const SUPPORT: TimeInterval = TimeInterval {
    from: 0.35e-3,
    to: 1.25e-3,
};
/// Noise of the accelerometers, in m/s².
const NOISE: [f64; 2] = [80.0, 160.0];
/// Relative standard deviation of a line of a frequency response.
const RESPONSE_ERROR: f64 = 0.02;
const SEEDS: u64 = 60;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("force of a virtual blow on a rod of loss factor 0.1");
    let faces = struck();
    let truth = truth();
    for (face, name) in [(0, "struck"), (1, "far")] {
        claims.deviation(
            format!("force from the acceleration of the {name} face, without noise"),
            Within(1e-3, "what of the pulse is above 25 kHz and aliases"),
            faces
                .as_ref()
                .map_err(Clone::clone)
                .and_then(|faces| without_noise(faces, face, &truth)),
        );
    }
    for (sensors, name) in [(1, "one sensor"), (2, "two sensors")] {
        claims.by("force of a virtual blow, 60 draws of the noise");
        let covered = faces
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|faces| coverage(faces, sensors, &truth));
        claims.claim(
            format!("{name}: part of the force inside its pointwise band of 95 %"),
            "1",
            0.95,
            Within(
                0.055,
                "parts of 60 histories scatter by 0.13: 3.3 errors of the mean",
            ),
            of(&covered, |covered| covered.inside),
        );
        claims.claim(
            format!("{name}: mean square of the error over the stated variance"),
            "1",
            1.0,
            Within(
                0.43,
                "mean squares of 60 histories scatter by 1: 3.3 errors of the mean",
            ),
            of(&covered, |covered| covered.squares),
        );
        claims.claim(
            format!("{name}: whole histories inside the simultaneous band of 95 %"),
            "1",
            0.95,
            Within(
                0.09,
                "sqrt(0.95 0.05/60) = 2.8 % and 1.1 % of its factor: three of both",
            ),
            of(&covered, |covered| covered.whole),
        );
    }
    claims.by("chi-square of the residual over its degrees of freedom");
    claims.claim(
        "far face with noise as stated: reduced chi-square",
        "1",
        1.0,
        Within(0.13, "sqrt(2/2003) = 3 %, four of them"),
        faces.as_ref().map_err(Clone::clone).and_then(chi_square),
    );
    hold!(claims);
}

/// Accelerations and accelerances of the struck and of the far face.
struct Faces {
    responses: [Vec<f64>; 2],
    lines: [Vec<Complex64>; 2],
}

fn truth() -> Vec<f64> {
    (0..SAMPLES)
        .map(|n| {
            let phase = (n as f64 / RATE_HZ - BEGIN) / LASTS;
            if (0.0..1.0).contains(&phase) {
                0.5 * PEAK * (1.0 - (TAU * phase).cos())
            } else {
                0.0
            }
        })
        .collect()
}

/// The pulse in closed form.
fn transform(s: Complex64) -> Complex64 {
    let omega = TAU / LASTS;
    let window = (1.0 - (-s * LASTS).exp()) * (-s * BEGIN).exp();
    0.5 * PEAK * window * (1.0 / s - s / (s * s + omega * omega))
}

fn struck() -> Ours<Faces> {
    let medium = Medium::new(1150.0, ConstantQ::new(3e9, 0.1, 1e4)?)?;
    let section = Circle::of_diameter(0.020)?;
    let analytic = AnalyticChain::analytic_from_impact_face()
        .rod(&medium, section, 0.4)
        .end(Termination::Free)?;
    let chain = Chain::from_impact_face()
        .rod(&medium, section, 0.4)
        .end(Termination::Free)?;
    let synthesis = DampedSynthesis::new(SAMPLES as f64 / RATE_HZ, 1.0 / (RATE_HZ * FINER as f64))?;
    let history = |far: bool| -> Ours<Vec<f64>> {
        let mut spectrum = Vec::new();
        for s in synthesis.arguments() {
            let mobility = if far {
                analytic.far_face_mobility_at_s(s)?
            } else {
                analytic.mobility_at_s(s)?
            };
            spectrum.push(s * mobility * transform(s));
        }
        let fine = synthesis.history(&spectrum)?.samples;
        Ok(fine.iter().step_by(FINER).take(SAMPLES).copied().collect())
    };
    let lines = |far: bool| -> Ours<Vec<Complex64>> {
        // the accelerance of a free body at 0 Hz is that of its mass
        let mass = chain.free_mass().ok_or_else(|| missing("the mass"))?;
        let mut lines = vec![Complex64::from(1.0 / mass)];
        for line in 1..=SAMPLES / 2 {
            let omega = TAU * line as f64 * RATE_HZ / SAMPLES as f64;
            let mobility = if far {
                chain.far_face_mobility(omega)?
            } else {
                chain.mobility(omega)?
            };
            lines.push(Complex64::new(0.0, omega) * mobility);
        }
        Ok(lines)
    };
    Ok(Faces {
        responses: [history(false)?, history(true)?],
        lines: [lines(false)?, lines(true)?],
    })
}

fn without_noise(faces: &Faces, face: usize, truth: &[f64]) -> Ours {
    let found = Reconstruction::new(&faces.responses[face], RATE_HZ, &faces.lines[face])?
        .acting_during(SUPPORT)
        .solve()?;
    let pairs = found.history.force().iter().zip(truth);
    Ok(largest(pairs.map(|(a, b)| (a - b).abs() / PEAK)))
}

/// Coverage of the truth by the bands.
struct Coverage {
    inside: f64,
    squares: f64,
    whole: f64,
}

fn coverage(faces: &Faces, sensors: usize, truth: &[f64]) -> Ours<Coverage> {
    let variances = faces.lines.each_ref().map(|lines| {
        let variance = |h: &Complex64| (RESPONSE_ERROR * h.norm()).powi(2);
        lines.iter().map(variance).collect::<Vec<f64>>()
    });
    // where the force acts
    let window = 18..62;
    let mut sums = Coverage {
        inside: 0.0,
        squares: 0.0,
        whole: 0.0,
    };
    for seed in 0..SEEDS {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let responses = [0, 1].map(|face| noisy(&faces.responses[face], NOISE[face], &mut random));
        let lines =
            [0, 1].map(|face| noisy_lines(&faces.lines[face], &variances[face], &mut random));
        let sensors = (0..sensors)
            .map(|face| -> Ours<Sensor<'_>> {
                Ok(Sensor::new(&responses[face], &lines[face])?
                    .with_noise(ResponseNoise::White(NOISE[face]))?
                    .with_variance(&variances[face])?)
            })
            .collect::<Ours<Vec<_>>>()?;
        let found = Reconstruction::of_sensors(sensors, RATE_HZ)?
            .acting_during(SUPPORT)
            .solve()?;
        let error = found
            .error
            .known()
            .ok_or_else(|| missing("the error of the force"))?;
        let pointwise = error.pointwise(&found.history, 0.95)?;
        let simultaneous =
            error.simultaneous(&found.history, 0.95, window.clone(), 400, &mut random)?;
        sums.inside += pointwise.part_inside(truth, window.clone());
        sums.whole += simultaneous.part_inside(truth, window.clone()).floor();
        let squares: f64 = window
            .clone()
            .map(|n| ((found.history.force()[n] - truth[n]) / error.standard_error()[n]).powi(2))
            .sum();
        sums.squares += squares / window.len() as f64;
    }
    let seeds = SEEDS as f64;
    Ok(Coverage {
        inside: sums.inside / seeds,
        squares: sums.squares / seeds,
        whole: sums.whole / seeds,
    })
}

fn chi_square(faces: &Faces) -> Ours {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let response = noisy(&faces.responses[1], NOISE[1], &mut random);
    let sensor =
        Sensor::new(&response, &faces.lines[1])?.with_noise(ResponseNoise::White(NOISE[1]))?;
    let found = Reconstruction::of_sensors(vec![sensor], RATE_HZ)?
        .acting_during(SUPPORT)
        .solve()?;
    found
        .reduced_chi_square
        .ok_or_else(|| missing("the chi-square"))
}

fn noisy(values: &[f64], level: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    values.iter().map(|x| x + level * normal()).collect()
}

/// Lines with circular errors of these variances; the errors at 0 Hz and at the Nyquist frequency
/// are real.
fn noisy_lines(lines: &[Complex64], variances: &[f64], random: &mut ChaCha8Rng) -> Vec<Complex64> {
    let last = lines.len() - 1;
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let values = lines.iter().zip(variances).enumerate();
    values
        .map(|(k, (line, variance))| {
            let error = if k == 0 || k == last {
                Complex64::from(normal())
            } else {
                Complex64::new(normal(), normal()) * 0.5_f64.sqrt()
            };
            line + variance.sqrt() * error
        })
        .collect()
}
