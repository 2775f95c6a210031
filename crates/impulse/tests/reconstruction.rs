//! Forces from virtual responses of a struck rod, which are computed by the Laplace transform on a
//! damped line and inverted with frequency responses on the axis.

use impulse::{
    Parameter, Penalty, Reconstruction, Regularisation, ResponseNoise, Sensor, TimeInterval,
};
use num_complex::Complex64;

use crate::virtual_body::{Faces, Pulse, VirtualBody, noisy_lines};
use testbed::claim::{Ours, missing};
use testbed::noise::Noise;

pub(crate) const BODY: VirtualBody = VirtualBody {
    length: 0.4,
    n_samples: 2048,
    sampling_rate_hz: 50e3,
};
pub(crate) const PULSE: Pulse = Pulse {
    peak: 800.0,
    begin: 0.4e-3,
    duration: 0.8e-3,
};
pub(crate) const SUPPORT: TimeInterval = TimeInterval {
    from: 0.35e-3,
    to: 1.25e-3,
};
/// Noise of the accelerometers [m/s^2]: about 1 and 2 % of their signals.
const NOISE: [f64; 2] = [80.0, 160.0];
/// Relative standard deviation of a line of a frequency response.
const RESPONSE_ERROR: f64 = 0.02;
const SEEDS: u64 = 120;

pub(crate) fn truth() -> Vec<f64> {
    (0..BODY.n_samples)
        .map(|n| PULSE.at(n as f64 / BODY.sampling_rate_hz))
        .collect()
}

fn variances(faces: &Faces) -> [Vec<f64>; 2] {
    [0, 1].map(|face| {
        let lines = faces.frequency_responses[face].iter();
        lines
            .map(|h: &Complex64| (RESPONSE_ERROR * h.norm()).powi(2))
            .collect()
    })
}

/// Coverage of the truth by the bands.
pub(crate) struct Coverage {
    pub(crate) inside: f64,
    pub(crate) squares: f64,
    pub(crate) whole: f64,
}

/// Coverage over `seeds` draws of the noise, of every sample by itself and of whole histories.
pub(crate) fn coverage(
    faces: &Faces,
    n_sensors: usize,
    support: Option<TimeInterval>,
    seeds: u64,
) -> Ours<Coverage> {
    let truth = truth();
    let variances = variances(faces);
    // where the force acts
    let window = 18..62;
    let mut sums = Coverage {
        inside: 0.0,
        squares: 0.0,
        whole: 0.0,
    };
    for seed in 0..seeds {
        let mut random = Noise::seeded(seed);
        let responses = [0, 1].map(|face| random.added_to(&faces.responses[face], NOISE[face]));
        let lines = [0, 1].map(|face| {
            noisy_lines(
                &faces.frequency_responses[face],
                &variances[face],
                &mut random,
            )
        });
        let sensors = (0..n_sensors)
            .map(|face| -> Ours<Sensor<'_>> {
                Ok(Sensor::new(&responses[face], &lines[face])?
                    .with_noise(ResponseNoise::White(NOISE[face]))?
                    .with_variance(&variances[face])?)
            })
            .collect::<Ours<Vec<_>>>()?;
        let problem = Reconstruction::of_sensors(sensors, BODY.sampling_rate_hz)?;
        let problem = match support {
            None => problem,
            Some(support) => problem.acting_during(support),
        };
        let found = problem.solve()?;
        let error = found
            .error
            .known()
            .ok_or_else(|| missing("the error of the force"))?;
        let pointwise = error.pointwise(&found.history, 0.95)?;
        let simultaneous =
            error.simultaneous(&found.history, 0.95, window.clone(), 400, &mut random.0)?;
        sums.inside += pointwise.part_inside(&truth, window.clone());
        sums.whole += simultaneous.part_inside(&truth, window.clone()).floor();
        let squares: f64 = window
            .clone()
            .map(|n| ((found.history.force()[n] - truth[n]) / error.standard_error()[n]).powi(2))
            .sum();
        sums.squares += squares / window.len() as f64;
    }
    let seeds = seeds as f64;
    Ok(Coverage {
        inside: sums.inside / seeds,
        squares: sums.squares / seeds,
        whole: sums.whole / seeds,
    })
}

/// Coverage of the bands of a force that is not restricted to a support; claims check forces on a
/// support.
#[test]
fn bands_cover_the_true_force_at_their_level() {
    let faces = BODY.struck_by(PULSE).unwrap();
    // Errors of neighbouring samples are correlated: between seeds the fraction of samples inside
    // has a standard deviation of 0.09 to 0.13, and the mean square one of 0.8 to 1 (300 other
    // seeds). Tolerance: 3.3 standard errors of a mean, exceeded once in a thousand.
    let n = (SEEDS as f64).sqrt();
    let Coverage {
        inside,
        squares,
        whole,
    } = coverage(&faces, 1, None, SEEDS).unwrap();
    assert!((inside - 0.95).abs() < 3.3 * 0.13 / n, "{inside}");
    assert!((squares - 1.0).abs() < 3.3 / n, "{squares}");
    // tolerance: three standard errors, which combine sqrt(0.95*0.05/120) = 2 % of the count and
    // 1.1 % of a factor from 400 draws
    assert!(whole > 0.95 - 0.07, "{whole}");
}

/// Reduced chi-square of a force reconstructed from the acceleration of the far face and these
/// `lines` of its accelerance.
pub(crate) fn chi_square(faces: &Faces, lines: &[Complex64]) -> Ours {
    let mut random = Noise::seeded(11);
    let response = random.added_to(&faces.responses[1], NOISE[1]);
    let sensor = Sensor::new(&response, lines)?.with_noise(ResponseNoise::White(NOISE[1]))?;
    let found = Reconstruction::of_sensors(vec![sensor], BODY.sampling_rate_hz)?
        .acting_during(SUPPORT)
        .solve()?;
    found
        .reduced_chi_square
        .ok_or_else(|| missing("the chi-square"))
}

/// Reconstruction with the accelerance of a rod of another length: chi-square reveals the error,
/// which the band does not include.
#[test]
fn a_body_that_is_another_one_is_seen_in_the_residual() {
    let faces = BODY.struck_by(PULSE).unwrap();
    let other = VirtualBody {
        length: 0.41,
        ..BODY
    };
    let other = other.struck_by(PULSE).unwrap();
    // with the right rod chi-square is 1, which a claim checks
    let wrong = chi_square(&faces, &other.frequency_responses[1]).unwrap();
    assert!(wrong > 1.5, "{wrong}");
}

/// The far face with a slow sensor gives little information at high frequencies: only a regularised
/// force is near the truth, with or without the condition of no tension.
#[test]
fn a_slow_sensor_needs_regularisation() {
    let faces = BODY.struck_by(PULSE).unwrap();
    let truth = truth();
    // three first-order low-pass filters of 300 Hz in series: on the samples by recursion with
    // their pole, and on the lines by their exact response
    let pole = (-std::f64::consts::TAU * 300.0 / BODY.sampling_rate_hz).exp();
    let mut response = faces.responses[1].clone();
    for _ in 0..3 {
        let mut state = 0.0;
        for x in &mut response {
            state = pole * state + (1.0 - pole) * *x;
            *x = state;
        }
    }
    let lines: Vec<Complex64> = faces.frequency_responses[1]
        .iter()
        .enumerate()
        .map(|(k, h)| {
            let turn = -std::f64::consts::TAU * k as f64 / BODY.n_samples as f64;
            h * ((1.0 - pole) / (1.0 - pole * Complex64::cis(turn))).powu(3)
        })
        .collect();
    let level = 0.02 * response.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut random = Noise::seeded(12);
    let response = random.added_to(&response, level);
    let problem = Reconstruction::new(&response, BODY.sampling_rate_hz, &lines)
        .unwrap()
        .acting_during(SUPPORT);
    let smooth = Regularisation::Tikhonov {
        penalty: Penalty::Curvature,
        parameter: Parameter::GeneralisedCrossValidation,
    };
    let error = |problem: Reconstruction<'_>| {
        let found = problem.solve().unwrap();
        let pairs = found.history.force().iter().zip(&truth);
        let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
        let all: f64 = truth.iter().map(|f| f * f).sum();
        (squares / all).sqrt()
    };
    let plain = error(problem.clone());
    let regularised = error(problem.clone().with_regularisation(smooth));
    let pressing = error(problem.with_regularisation(smooth).non_negative());
    assert!(plain > 0.5, "{plain}: there is nothing to regularise");
    assert!(
        regularised < 0.1 && pressing < 0.1,
        "{regularised} {pressing}"
    );
}
