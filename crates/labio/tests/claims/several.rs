//! Several simultaneous inputs, and several tests merged into one response.

use std::error::Error;

use labio::{
    AveragedSpectra, FrequencyResponse, LineValidity, MergedResponse, MultiInputResponse, Quantity,
    Record, Window,
};
use testbed::noise::Noise;

use super::estimators::noisy;
use super::hits::{mean, record};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, worst};
use testbed::hold;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    several_inputs(&mut report);
    merging(&mut report);
    hold!(report);
}

const GAINS: [f64; 3] = [2.0, -0.5, 1.5];

/// Spectra of three inputs, of which the second contains half of the first and the third contains
/// parts of both, and of their response with gains and noise.
fn three_inputs(n: usize, n_hits: u32, level: f64, seed: u64) -> Fallible<AveragedSpectra> {
    let mut rng = Noise::seeded(seed);
    let mut hits = Vec::new();
    for _ in 0..n_hits {
        let [a, b, c, noise] = [0, 1, 2, 3].map(|_| rng.white(n, 1.0));
        let sum = |parts: &[(f64, &Vec<f64>)]| -> Vec<f64> {
            let at = |i: usize| parts.iter().map(|(gain, x)| gain * x[i]).sum();
            (0..n).map(at).collect()
        };
        let b = sum(&[(1.0, &b), (0.5, &a)]);
        let c = sum(&[(1.0, &c), (0.3, &a), (-0.8, &b)]);
        let y = sum(&[
            (GAINS[0], &a),
            (GAINS[1], &b),
            (GAINS[2], &c),
            (level, &noise),
        ]);
        hits.push(of_channels([&a, &b, &c, &y])?);
    }
    Ok(AveragedSpectra::of(&hits, Window::Rectangular)?)
}

fn of_channels(samples: [&[f64]; 4]) -> Fallible<Record> {
    let [a, b, c, y] = samples;
    let of = Quantity::Velocity;
    record(
        &[("a", of, a), ("b", of, b), ("c", of, c), ("y", of, y)],
        1.0,
    )
}

fn of_three(n: usize, n_hits: u32, level: f64, seed: u64) -> Fallible<MultiInputResponse> {
    Ok(three_inputs(n, n_hits, level, seed)?.multi_input(&["a", "b", "c"], "y")?)
}

fn several_inputs(report: &mut Claims) {
    report.check(
        Claim::new(
            "three dependent inputs without noise: their gains",
            "gains of the model",
        )
        .within(
            1e-13,
            "rounding, amplified by lines where six averages make inputs nearly dependent",
        ),
        || {
            let response = of_three(64, 6, 0.0, 1)?;
            let multiple = response.multiple_coherence.iter();
            multiple.for_each(|c| assert!((c - 1.0).abs() < 1e-12, "{c}"));
            worst(GAINS.iter().enumerate(), |(input, gain)| {
                let values = response.values.row(input);
                Ok(largest(values.iter().map(|h| (h - gain).norm())))
            })
        },
    );
    report.check(
        Claim::new(
            "three dependent inputs, noise on the output: multiple coherence, and partial coherence of the last",
            "closed form of the model; the shares of the inputs, in their order, sum to the multiple coherence",
        )
        .within(0.011, "four standard errors over 513 lines, and the bias q(1 - γ²)/n"),
        || {
            let response = of_three(1024, 200, 1.0, 3)?;
            for (line, multiple) in response.multiple_coherence.iter().enumerate() {
                let parts = response.ordered_coherence.column(line).sum();
                assert!((parts - multiple).abs() < 1e-14, "line {line}");
            }
            // a = u, b = v + u/2, c = w - 0.8 v - 0.1 u: y = 1.6 u - 1.7 v + 1.5 w + e
            let total = 1.6_f64.powi(2) + 1.7_f64.powi(2) + 1.5_f64.powi(2) + 1.0;
            for (input, part) in [1.6_f64, 1.7, 1.5].into_iter().enumerate() {
                let ordered = mean(response.ordered_coherence.row(input));
                assert!((ordered - part * part / total).abs() < 0.011, "{input}: {ordered}");
            }
            Ok(largest([
                mean(&response.multiple_coherence) - (1.0 - 1.0 / total),
                mean(response.partial_coherence.row(2)) - 2.25 / 3.25,
            ]))
        },
    );
    report.check(
        Claim::new(
            "three dependent inputs, ten hits: scatter of the gains over lines relative to the stated variance",
            "definition of a variance",
        )
        .expects(1.0, "1")
        .within(0.09, "four standard errors over 4095 lines with heavy tails"),
        || {
            let response = of_three(8192, 10, 1.0, 4)?;
            let (mut scatter, mut stated) = (0.0, 0.0);
            for (input, gain) in GAINS.iter().enumerate() {
                for line in 1..4096 {
                    scatter += (response.values[(input, line)] - gain).norm_sqr();
                    stated += response.variance[(input, line)];
                }
            }
            Ok(scatter / stated)
        },
    );
}

fn merging(report: &mut Claims) {
    report.check(
        Claim::new(
            "two tests merged by inverse variance: squared error relative to that of the better test",
            "closed form: noise powers of 1 and 10 give 10/11",
        )
        .expects(10.0 / 11.0, "1")
        .within(0.05, "4/n caused by the estimated weights, and four standard errors of a ratio of similar errors"),
        || {
            let test = |seed, noise| Ok::<_, Box<dyn Error + Send + Sync>>(noisy(seed, 2048, 20, 0.0, noise)?.h1("x", "y")?);
            let tests = [test(21, 0.01)?, test(22, 0.1)?];
            let square_error = |response: &FrequencyResponse| {
                mean(response.values.iter().map(|h| (h - 2.0).norm_sqr()))
            };
            let merged = MergedResponse::by_inverse_variance(&tests)?.response;
            Ok(square_error(&merged) / square_error(&tests[0]))
        },
    );
}

#[test]
fn one_input_is_h1_and_the_ordinary_coherence() {
    let spectra = three_inputs(64, 5, 1.0, 2).unwrap();
    let several = spectra.multi_input(&["a"], "y").unwrap();
    let single = spectra.h1("a", "y").unwrap();
    let coherence = single.coherence.unwrap();
    let variance = single.variance.unwrap();
    for line in 0..33 {
        // tolerance: rounding errors of square roots
        assert!((several.values[(0, line)] / single.values[line] - 1.0).norm() < 1e-13);
        for found in [
            several.multiple_coherence[line],
            several.partial_coherence[(0, line)],
            several.ordered_coherence[(0, line)],
        ] {
            assert!((found - coherence[line]).abs() < 1e-13);
        }
        let ratio = several.variance[(0, line)] / variance[line];
        assert!((ratio - 1.0).abs() < 1e-11);
    }
}

#[test]
fn inputs_that_depend_on_each_other_are_flagged() {
    let mut rng = Noise::seeded(5);
    let hits = [0; 6].map(|_| {
        let a = rng.white(32, 1.0);
        let b: Vec<f64> = a.iter().map(|a| -3.0 * a).collect();
        of_channels([&a, &b, &[0.0; 32], &a]).unwrap()
    });
    let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
    let validity = |inputs: &[&str]| spectra.multi_input(inputs, "y").unwrap().validity;
    let all = |validity: Vec<LineValidity>, expected| validity.iter().all(|v| *v == expected);
    assert!(all(validity(&["a", "b"]), LineValidity::DependentInputs));
    assert!(all(validity(&["a", "c"]), LineValidity::NoInput));
    assert!(all(validity(&["a"]), LineValidity::Valid));
}

#[test]
fn requests_that_cannot_be_met_are_refused() {
    let spectra = three_inputs(16, 2, 1.0, 6).unwrap();
    let refusals = [
        spectra.multi_input(&[], "y"),
        spectra.multi_input(&["a", "z"], "y"),
        spectra.multi_input(&["a", "y"], "y"),
        spectra.multi_input(&["a", "b"], "y"),
    ]
    .map(|result| result.unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    inputs: found 0, expected 1
    there is no channel `z`, only `a`, `b`, `c`, `y`
    channels 1 and 2 are both named `y`
    a response to several inputs needs at least 3 averages, found 2
    ");
}
