use super::*;
use crate::{Quantity, Record, RestNoise, Window};
use ndarray::Array2;
use testbed::noise::Noise;

const RATE: f64 = 1000.0;

fn hit(input: &[f64], output: &[f64]) -> Record {
    let samples =
        Array2::from_shape_fn((2, input.len()), |(channel, n)| [input, output][channel][n]);
    Record::of_test(
        samples,
        RATE,
        &[("x", Quantity::Force), ("y", Quantity::Velocity)],
    )
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn one_average_gives_a_response_but_no_coherence() {
    let one = hit(&[1.0, 0.0, 0.0, 0.0], &[0.5, 0.25, 0.0, 0.0]);
    let spectra = AveragedSpectra::of([&one], Window::Rectangular).unwrap();
    let response = spectra.h1("x", "y").unwrap();
    assert!(response.coherence.is_none() && response.random_error().is_none());
    let error = spectra.coherence("x", "y").unwrap_err();
    assert!(matches!(
        error,
        LabioError::TooFewAverages {
            found: 1,
            expected: 2,
            ..
        }
    ));
}

#[test]
fn empty_lines_are_flagged_with_their_reason() {
    // a pulse in every fifth of 60 samples: only lines 0, 12 and 24 have energy; on the other lines
    // the transform has only rounding errors
    let train: Vec<f64> = (0..60)
        .map(|i| if i % 5 == 0 { 1.0 / 3.0 } else { 0.0 })
        .collect();
    let silent = vec![0.0; train.len()];
    let train_in = hit(&train, &train);
    let spectra = AveragedSpectra::of([&train_in, &train_in], Window::Rectangular).unwrap();
    let response = spectra.h1("x", "y").unwrap();
    for (k, validity) in response.validity.iter().enumerate() {
        if k % 12 == 0 {
            assert_eq!(*validity, LineValidity::Valid);
            // tolerance: one rounding error of a ratio
            assert!((response.values[k] - 1.0).norm() < 1e-15);
        } else {
            assert_eq!(*validity, LineValidity::NoInput, "line {k}");
            assert!(response.values[k].is_nan());
        }
    }
    let mut pulse = silent.clone();
    pulse[0] = 1.0;
    let nothing_out = hit(&pulse, &silent);
    let spectra = AveragedSpectra::of([&nothing_out, &nothing_out], Window::Rectangular);
    let response = spectra.unwrap().h1("x", "y").unwrap();
    assert!(
        response
            .validity
            .iter()
            .all(|v| *v == LineValidity::NoOutput)
    );
    assert!(response.values.iter().all(|value| value.is_nan()));
    // two hits whose outputs have opposite signs: their cross-spectra cancel
    let minus: Vec<f64> = pulse.iter().map(|x| -x).collect();
    let hits = [hit(&pulse, &pulse), hit(&pulse, &minus)];
    let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
    let h1 = spectra.h1("x", "y").unwrap();
    let h2 = spectra.h2("x", "y").unwrap();
    assert!(h1.values.iter().all(|h| h.norm() < 1e-15));
    assert!(
        h1.random_error()
            .unwrap()
            .iter()
            .all(|e| e.magnitude.is_infinite())
    );
    // for a coherence of 0, the relative error of H1 is -1 if the noise is on the input, and 0 if
    // it is on the output
    for bias in h1.bias().unwrap() {
        assert!((bias.input_noise + 1.0).abs() < 1e-15 && bias.output_noise.abs() < 1e-15);
        assert!(bias.scatter.is_infinite());
    }
    assert!(
        h2.validity
            .iter()
            .all(|v| *v == LineValidity::NoCorrelation)
    );
    let Err(LabioError::MissingLines { count, .. }) = h2.check_complete("a check") else {
        panic!("lines without correlation are missing");
    };
    assert_eq!(count, h2.values.len());
}

#[test]
fn the_coherence_does_not_depend_on_the_units() {
    let mut rng = Noise::seeded(17);
    let pairs: Vec<(Vec<f64>, Vec<f64>)> = (0..3)
        .map(|_| (rng.white(64, 1.0), rng.white(64, 1.0)))
        .collect();
    let coherence = |input: i32, output: i32| {
        let scaled = |values: &[f64], exponent: i32| -> Vec<f64> {
            values.iter().map(|v| v * 2.0_f64.powi(exponent)).collect()
        };
        let hits: Vec<Record> = pairs
            .iter()
            .map(|(x, y)| hit(&scaled(x, input), &scaled(y, output)))
            .collect();
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        spectra.coherence("x", "y").unwrap().values
    };
    let as_it_is = coherence(0, 0);
    assert!(as_it_is.iter().all(|c| (0.0..1.0).contains(c)));
    // multiplication by a power of two is exact; without scaling, the square of the cross-spectrum
    // would overflow at 2^1600
    for (input, output) in [(400, 400), (-400, -400), (400, -400), (-380, 400)] {
        assert_eq!(coherence(input, output), as_it_is, "2^{input}, 2^{output}");
    }
}

#[test]
fn a_phase_of_which_nothing_is_known_is_anywhere_on_the_turn() {
    let channels = || Channel::new("x", Quantity::Force).unwrap();
    let of_error = |magnitude: f64| {
        let values = vec![Complex64::new(0.0, 2.0); 3];
        let variance = vec![2.0 * (2.0 * magnitude).powi(2); 3];
        let response = FrequencyResponse::of_lines(channels(), channels(), 1.0, values).unwrap();
        let stated = FrequencyResponse {
            variance: Some(variance),
            ..response
        };
        stated.random_error().unwrap()[1]
    };
    // tolerance: one rounding error of a square root
    let small = of_error(0.1);
    assert!((small.magnitude - 0.1).abs() < 1e-15 && (small.phase - 0.1).abs() < 1e-15);
    // the standard deviation of an angle that is uniform over a turn
    let large = of_error(5.0);
    assert!((large.magnitude - 5.0).abs() < 1e-14);
    assert!((large.phase - std::f64::consts::PI / 3.0_f64.sqrt()).abs() < 1e-15);
}

#[test]
fn the_scatter_of_a_magnitude_is_half_its_squared_error() {
    let channels = || Channel::new("x", Quantity::Force).unwrap();
    let values = vec![Complex64::new(3.0, 4.0); 3];
    let response = FrequencyResponse::of_lines(channels(), channels(), 1.0, values).unwrap();
    let response = response.with_coherence(vec![0.8; 3], 5).unwrap();
    let error = response.random_error().unwrap()[2].magnitude;
    let bias = response.bias().unwrap()[2];
    assert!((bias.scatter - 0.5 * error * error).abs() < 1e-16);
}

/// Student's quantiles for 2(n-1) degrees of freedom, from tables: 68.27 % and 95 %.
const STUDENT: [(usize, f64, f64); 4] = [
    (3, 1.142, 2.776),
    (5, 1.067, 2.306),
    (10, 1.029, 2.101),
    (30, 1.009, 2.002),
];

/// Spectra of `n_hits` hits, whose input is an impulse and whose output is twice the impulse, with
/// noise of these powers on the two channels; and the noise found from the silence before the
/// impulses.
fn blows(
    seed: u64,
    n_hits: usize,
    [on_input, on_output]: [f64; 2],
) -> (AveragedSpectra, [RestNoise; 2]) {
    const LENGTH: usize = 512;
    let mut rng = Noise::seeded(seed);
    let hits: Vec<Record> = (0..n_hits)
        .map(|_| {
            let mut blow = vec![0.0; LENGTH];
            blow[LENGTH / 2] = (LENGTH as f64).sqrt();
            let answer: Vec<f64> = blow.iter().map(|x| 2.0 * x).collect();
            hit(
                &sum(&blow, &rng.white(LENGTH, on_input.sqrt())),
                &sum(&answer, &rng.white(LENGTH, 2.0 * on_output.sqrt())),
            )
        })
        .collect();
    let all: Vec<&Record> = hits.iter().collect();
    let rest = ["x", "y"].map(|channel| RestNoise::before(&all, channel, LENGTH / 2).unwrap());
    (
        AveragedSpectra::of(&hits, Window::Rectangular).unwrap(),
        rest,
    )
}

/// Returns the shares of magnitudes and phases within the 68 % and the 95 % interval of Student's
/// distribution, over the lines of `seeds` tests.
fn covered(n_hits: usize, noise: [f64; 2], estimator: Estimator, seeds: u64) -> [[f64; 2]; 2] {
    let (_, one, two) = *STUDENT.iter().find(|(n, _, _)| *n == n_hits).unwrap();
    let mut counts = [[0.0; 2]; 2];
    let mut total = 0.0;
    for seed in 0..seeds {
        let (spectra, [on_input, on_output]) = blows(1000 + seed, n_hits, noise);
        let spectra = spectra
            .with_rest_noise("x", &on_input)
            .and_then(|spectra| spectra.with_rest_noise("y", &on_output))
            .unwrap();
        let response = spectra.response(estimator, "x", "y").unwrap();
        let errors = response.random_error().unwrap();
        for (value, error) in response.values.iter().zip(&errors).take(256).skip(1) {
            let off = (value / 2.0).ln();
            for (part, count) in [off.re, off.im].iter().zip(&mut counts) {
                count[0] += f64::from(part.abs() < one * error.magnitude);
                count[1] += f64::from(part.abs() < two * error.magnitude);
            }
            total += 1.0;
        }
    }
    counts.map(|count| count.map(|c| 100.0 * c / total))
}

#[test]
fn s13_few_hits_are_covered_by_students_law() {
    for (n_hits, _, _) in STUDENT {
        for (noise, estimator) in [
            ([0.0, 0.01], Estimator::H1),
            ([0.01, 0.0], Estimator::H2),
            ([0.01, 0.01], Estimator::Hs),
        ] {
            let seeds = if n_hits > 10 { 8 } else { 20 };
            let of_parts = covered(n_hits, noise, estimator, seeds);
            println!("{n_hits} hits, noise {noise:?}, {estimator:?}: {of_parts:.1?}");
            for [one, two] in of_parts {
                // tolerance: three standard errors of 1 % and 0.5 % for 2040 lines or more, plus
                // the second order of the error
                assert!(
                    (one - 68.3).abs() < 5.0 && (two - 95.0).abs() < 3.0,
                    "{n_hits}: {one} {two}"
                );
            }
        }
    }
}

#[test]
fn s13_bias_by_noise_at_rest_is_told_and_can_be_removed() {
    let noise = [0.2, 0.1];
    let (spectra, [on_input, on_output]) = blows(7, 60, noise);
    let unknown = spectra.response(Estimator::Hs, "x", "y").unwrap_err();
    insta::assert_snapshot!(unknown, @"the errors-in-variables estimator needs the noise of `x` at rest, which is not known");
    assert!(spectra.h1("x", "y").unwrap().noise_bias.is_none());
    let spectra = spectra
        .with_rest_noise("x", &on_input)
        .and_then(|spectra| spectra.with_rest_noise("y", &on_output))
        .unwrap();
    for (estimator, expected) in [
        (Estimator::H1, 1.0 / 1.2 - 1.0),
        (Estimator::H2, 0.1),
        (Estimator::Hv, (1.1_f64 / 1.2).sqrt() - 1.0),
        (Estimator::Hs, 0.0),
    ] {
        let response = spectra.response(estimator, "x", "y").unwrap();
        let off: Vec<f64> = response.values[1..256]
            .iter()
            .map(|h| h.norm() / 2.0 - 1.0)
            .collect();
        let stated = mean(&response.noise_bias.as_ref().unwrap()[1..256]);
        // tolerance: four standard errors of the mean of 255 lines, which scatter by ((a +
        // b)/120)^½ = 5 % each, plus a bias of 0.1 % caused by this scatter
        assert!(
            (mean(&off) - expected).abs() < 0.014,
            "{estimator:?} {}",
            mean(&off)
        );
        // tolerance: an error of 2 % of the noise, and the scatter of the auto-spectra, from which
        // the bias is computed
        assert!((stated - expected).abs() < 0.015, "{estimator:?} {stated}");
    }
}
