//! Forces from virtual responses of a struck rod, which are computed by the Laplace transform on a
//! damped line and inverted with frequency responses on the axis.

use crate::virtual_body;

use impulse::{
    ForceBand, Parameter, Penalty, Reconstruction, Regularisation, ResponseEnd, ResponseNoise,
    Sensor, TimeInterval,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use virtual_body::{Faces, Pulse, VirtualBody, noisy, noisy_lines};

const BODY: VirtualBody = VirtualBody {
    length: 0.4,
    n_samples: 2048,
    sampling_rate_hz: 50e3,
};
const PULSE: Pulse = Pulse {
    peak: 800.0,
    begin: 0.4e-3,
    duration: 0.8e-3,
};
const SUPPORT: TimeInterval = TimeInterval {
    from: 0.35e-3,
    to: 1.25e-3,
};
/// Noise of the accelerometers [m/s^2]: about 1 and 2 % of their signals.
const NOISE: [f64; 2] = [80.0, 160.0];
/// Relative standard deviation of a line of a frequency response.
const RESPONSE_ERROR: f64 = 0.02;
const SEEDS: u64 = 120;

fn truth() -> Vec<f64> {
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

#[test]
fn the_two_ways_of_the_clean_body_agree() {
    let faces = BODY.struck_by(PULSE).unwrap();
    let truth = truth();
    for face in [0, 1] {
        let response = &faces.responses[face];
        let lines = &faces.frequency_responses[face];
        let problem = Reconstruction::new(response, BODY.sampling_rate_hz, lines).unwrap();
        let found = problem.acting_during(SUPPORT).solve().unwrap();
        assert_eq!(found.response_end, ResponseEnd::DiedOut);
        let largest = found.history.force().iter().zip(&truth);
        let largest = largest.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // the part of the pulse above 25 kHz aliases: (f T)^-3 = 1.3e-4 of it at 20 periods, and
        // the accelerance grows there
        assert!(largest < 1e-3 * PULSE.peak, "{face}: {largest}");
    }
}

/// Coverage over seeds, of every sample by itself and of whole histories, on all lines and on a
/// support, for one sensor and for two.
#[test]
fn bands_cover_the_true_force_at_their_level() {
    let faces = BODY.struck_by(PULSE).unwrap();
    let truth = truth();
    let variances = variances(&faces);
    for (n_sensors, support) in [(1, None), (1, Some(SUPPORT)), (2, Some(SUPPORT))] {
        let (mut inside, mut squares) = (Vec::new(), Vec::new());
        let mut whole = 0.0;
        for seed in 0..SEEDS {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let responses =
                [0, 1].map(|face| noisy(&faces.responses[face], NOISE[face], &mut random));
            let lines = [0, 1].map(|face| {
                noisy_lines(
                    &faces.frequency_responses[face],
                    &variances[face],
                    &mut random,
                )
            });
            let sensors = (0..n_sensors).map(|face| {
                let sensor = Sensor::new(&responses[face], &lines[face]).unwrap();
                let noise = ResponseNoise::White(NOISE[face]);
                let sensor = sensor.with_noise(noise).unwrap();
                sensor.with_variance(&variances[face]).unwrap()
            });
            let problem =
                Reconstruction::of_sensors(sensors.collect(), BODY.sampling_rate_hz).unwrap();
            let problem = match support {
                None => problem,
                Some(support) => problem.acting_during(support),
            };
            let found = problem.solve().unwrap();
            let error = found.error.known().unwrap();
            let window = 18..62;
            let pointwise = error.pointwise(&found.history, 0.95).unwrap();
            let simultaneous: ForceBand = error
                .simultaneous(&found.history, 0.95, window.clone(), 400, &mut random)
                .unwrap();
            inside.push(pointwise.part_inside(&truth, window.clone()));
            whole += simultaneous.part_inside(&truth, window.clone()).floor();
            let squared = window.map(|n| {
                let error = error.standard_error()[n];
                ((found.history.force()[n] - truth[n]) / error).powi(2)
            });
            let squared: Vec<f64> = squared.collect();
            squares.push(squared.iter().sum::<f64>() / squared.len() as f64);
        }
        let case = format!("{n_sensors} sensors, support {support:?}");
        // Errors of neighbouring samples are correlated, so that the part inside scatters between
        // seeds by 0.09 to 0.13, and the mean square by 0.8 to 1 (300 other seeds). The limits are
        // 3.3 standard errors of a mean: one in a thousand.
        let n = SEEDS as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
        let (inside, squares) = (mean(&inside), mean(&squares));
        assert!(
            (inside - 0.95).abs() < 3.3 * 0.13 / n.sqrt(),
            "{case}: {inside}"
        );
        assert!((squares - 1.0).abs() < 3.3 / n.sqrt(), "{case}: {squares}");
        // sqrt(0.95*0.05/120) = 2 %, and the factor is of 400 draws, 1.1 %: three of both
        assert!(whole / n > 0.95 - 0.07, "{case}: {whole}");
    }
}

/// A perturbed body: chi-square reveals an error that the band does not include.
#[test]
fn a_body_that_is_another_one_is_seen_in_the_residual() {
    let faces = BODY.struck_by(PULSE).unwrap();
    let other = VirtualBody {
        length: 0.41,
        ..BODY
    };
    let other = other.struck_by(PULSE).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let response = noisy(&faces.responses[1], NOISE[1], &mut random);
    let chi_square = |lines: &[Complex64]| {
        let sensor = Sensor::new(&response, lines).unwrap();
        let sensor = sensor.with_noise(ResponseNoise::White(NOISE[1])).unwrap();
        let problem = Reconstruction::of_sensors(vec![sensor], BODY.sampling_rate_hz).unwrap();
        let found = problem.acting_during(SUPPORT).solve().unwrap();
        found.reduced_chi_square.unwrap()
    };
    // sqrt(2/2003) = 3 %, four of them
    let right = chi_square(&faces.frequency_responses[1]);
    assert!((right - 1.0).abs() < 0.13, "{right}");
    let wrong = chi_square(&other.frequency_responses[1]);
    assert!(wrong > 1.5, "{wrong}");
}

/// The far face with a slow sensor gives little information at high frequencies: only a regularised
/// force is near the truth, with or without the condition of no tension.
#[test]
fn a_slow_sensor_needs_regularisation() {
    let faces = BODY.struck_by(PULSE).unwrap();
    let truth = truth();
    // a first-order low-pass of 300 Hz, three times, in time: the recursion that follows from its
    // pole, and its exact response
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
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let response = noisy(&response, level, &mut random);
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
