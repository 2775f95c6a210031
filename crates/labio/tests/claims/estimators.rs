//! Frequency responses and coherences: known bodies, the bias due to noise, random errors.

use std::f64::consts::TAU;

use labio::{AveragedSpectra, Coherence, Estimator, SpectrumAverager, Window};
use num_complex::Complex64;
use testbed::noise::Noise;

use super::hits::{hit, mean, sum};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, worst};
use testbed::hold;

const RATE: f64 = 1000.0;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    known_bodies(&mut report);
    bias(&mut report);
    random_errors(&mut report);
    nothing_in_common(&mut report);
    hold!(report);
}

/// Circular convolution by direct summation: a line of the output is the response times the line of
/// the input.
fn circular(filter: &[f64], input: &[f64]) -> Vec<f64> {
    let n = input.len();
    let past = |i: usize| {
        filter
            .iter()
            .enumerate()
            .map(move |(lag, h)| h * input[(i + n - lag) % n])
    };
    (0..n).map(|i| past(i).sum()).collect()
}

fn known_bodies(report: &mut Claims) {
    // the second filter is a delay of seven samples
    const FILTERS: [[f64; 8]; 2] = [
        [0.7, -0.2, 0.0, 0.45, 0.1, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ];
    report.check(
        Claim::new(
            "H1, H2, Hv and coherence of a filter of five taps and of a delay, without noise",
            "transform of the taps by direct sum",
        )
        .within(2e-14, "rounding, amplified at the weakest of 49 lines"),
        || {
            worst(FILTERS, |filter| {
                let mut rng = Noise::seeded(11);
                let mut hits = Vec::new();
                for _ in 0..3 {
                    let input = rng.white(96, 1.0);
                    hits.push(hit(&input, &circular(&filter, &input), RATE)?);
                }
                let spectra = AveragedSpectra::of(&hits, Window::Rectangular)?;
                let responses =
                    worst([Estimator::H1, Estimator::H2, Estimator::Hv], |estimator| {
                        let response = spectra.response(estimator, "x", "y")?;
                        let lines = response.frequency_hz.iter().zip(&response.values);
                        Ok(largest(lines.map(|(f, value)| {
                            let turn = |lag: usize| Complex64::cis(-TAU * f * lag as f64 / RATE);
                            let taps = filter.iter().enumerate();
                            let exact: Complex64 = taps.map(|(lag, h)| h * turn(lag)).sum();
                            (value - exact).norm()
                        })))
                    })?;
                let coherence = spectra.coherence("x", "y")?.values;
                Ok(largest([
                    responses,
                    largest(coherence.iter().map(|c| c - 1.0)),
                ]))
            })
        },
    );
}

/// Hits of white noise through a gain of 2, with noise of relative power `a` on the input and `b`
/// on the output.
pub(super) fn noisy(seed: u64, n: usize, n_hits: u32, a: f64, b: f64) -> Fallible<AveragedSpectra> {
    let mut rng = Noise::seeded(seed);
    let silence = vec![0.0; n];
    let like = hit(&silence, &silence, RATE)?;
    let mut averager = SpectrumAverager::for_records_like(&like, Window::Rectangular)?;
    for _ in 0..n_hits {
        let clean = rng.white(n, 1.0);
        let output: Vec<f64> = clean.iter().map(|x| 2.0 * x).collect();
        let input = sum(&clean, &rng.white(n, a.sqrt()));
        let output = sum(&output, &rng.white(n, 2.0 * b.sqrt()));
        averager.add(&hit(&input, &output, RATE)?)?;
    }
    Ok(averager.spectra()?)
}

fn bias(report: &mut Claims) {
    let (a, b): (f64, f64) = (0.25, 0.5);
    report.check(
        Claim::new(
            "H1, H2 and Hv of a gain of 2 under noise of 25 % and 50 % of the power, relative",
            "closed forms H/(1 + N/S of the input), H(1 + N/S of the output), their geometric mean",
        )
        .within(
            0.013,
            "four standard errors over 257 lines, and half the squared random error",
        ),
        || {
            let spectra = noisy(3, 512, 200, a, b)?;
            let cases = [
                (Estimator::H1, 2.0 / (1.0 + a)),
                (Estimator::H2, 2.0 * (1.0 + b)),
                (Estimator::Hv, 2.0 * ((1.0 + b) / (1.0 + a)).sqrt()),
            ];
            worst(cases, |(estimator, expected)| {
                let values = spectra.response(estimator, "x", "y")?.values;
                Ok(mean(values.iter().map(|h| h.norm())) / expected - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            "coherence under noise of 25 % and 50 % of the power",
            "closed form 1/((1 + a)(1 + b))",
        )
        .expects(1.0 / ((1.0 + a) * (1.0 + b)), "1")
        .within(
            0.0094,
            "four standard errors over 257 lines, and the bias (1 - γ²)²/n",
        ),
        || Ok(mean(&noisy(3, 512, 200, a, b)?.coherence("x", "y")?.values)),
    );
    report.check(
        Claim::new(
            "stated bias of H1 and H2 if all missing coherence is noise on the channel that biases them",
            "closed forms -a/(1 + a) and b of the noise that was added",
        )
        .within(0.01, "four standard errors of the coherence over 257 lines"),
        || {
            let cases = [
                (Estimator::H1, a, 0.0, -a / (1.0 + a)),
                (Estimator::H2, 0.0, b, b),
            ];
            worst(cases, |(estimator, a, b, expected)| {
                let response = noisy(4, 512, 200, a, b)?.response(estimator, "x", "y")?;
                let bias = response.bias().ok_or("no coherence")?;
                let of = |bias: &labio::Bias| {
                    if a > 0.0 {
                        bias.input_noise
                    } else {
                        bias.output_noise
                    }
                };
                Ok(mean(bias.iter().map(of)) - expected)
            })
        },
    );
}

fn random_errors(report: &mut Claims) {
    const HITS: u32 = 20;
    const BENDAT: &str = "Bendat and Piersol";
    let g2: f64 = 1.0 / 1.3;
    let predicted = ((1.0 - g2) / (2.0 * f64::from(HITS - 1) * g2)).sqrt();
    let spectra = || noisy(5, 4096, HITS, 0.0, 0.3);
    // 0 Hz and the Nyquist frequency have half the degrees of freedom
    let scatter = |of: fn(&Complex64) -> f64| -> Fallible<f64> {
        let values = spectra()?.h1("x", "y")?.values;
        let inner = values[1..values.len() - 1].iter();
        Ok(mean(inner.map(|h| of(h).powi(2))).sqrt())
    };
    report.check(
        Claim::new(
            "random error of magnitude and phase of H1, 20 hits, noise of 30 %: scatter over lines, relative",
            BENDAT,
        )
        .within(0.075, "four standard errors over 2047 lines, and the second order"),
        || {
            let magnitude = scatter(|h| h.norm() / 2.0 - 1.0)?;
            Ok(largest([magnitude / predicted - 1.0, scatter(|h| h.arg())? / predicted - 1.0]))
        },
    );
    report.check(
        Claim::new(
            "random error of |H1|, 20 hits, noise of 30 %: median of the stated errors of the lines",
            BENDAT,
        )
        .expects(predicted, "1")
        .within_part(
            0.05,
            "bias of the coherence 1.2 %, four standard errors of the median",
        ),
        || {
            let errors = spectra()?
                .h1("x", "y")?
                .random_error()
                .ok_or("no coherence")?;
            let mut stated: Vec<f64> = errors.iter().map(|error| error.magnitude).collect();
            stated.sort_by(f64::total_cmp);
            Ok(stated[stated.len() / 2])
        },
    );
    report.check(
        Claim::new(
            "random error of the coherence, 20 hits, γ² = 1/1.3: scatter over lines",
            BENDAT,
        )
        .expects((2.0 * g2 / f64::from(HITS)).sqrt() * (1.0 - g2), "1")
        .within_part(
            0.13,
            "next order of the formula, (1 - γ²)/n of the first, and four standard errors",
        ),
        || {
            let values = spectra()?.coherence("x", "y")?.values;
            let centre = mean(&values);
            Ok(mean(values.iter().map(|v| (v - centre).powi(2))).sqrt())
        },
    );
}

fn nothing_in_common(report: &mut Claims) {
    const HITS: u32 = 10;
    let coherence = || -> Fallible<Coherence> {
        let mut rng = Noise::seeded(13);
        let mut hits = Vec::new();
        for _ in 0..HITS {
            let (x, y) = (rng.white(4096, 1.0), rng.white(4096, 1.0));
            hits.push(hit(&x, &y, RATE)?);
        }
        Ok(AveragedSpectra::of(&hits, Window::Rectangular)?.coherence("x", "y")?)
    };
    report.check(
        Claim::new("coherence of independent noise, ten hits", "beta law: 1/n")
            .expects(0.1, "1")
            .within(0.008, "four standard errors over 2049 lines"),
        || Ok(mean(&coherence()?.values)),
    );
    report.check(
        Claim::new(
            "coherence of independent noise, ten hits: mean of the stated bias",
            "beta law: (1 - γ²)²/n in the mean, (n - 1)/((n + 1)n)",
        )
        .expects(9.0 / 110.0, "1")
        .within(0.002, "four standard errors over 2049 lines"),
        || Ok(mean(coherence()?.bias())),
    );
    report.check(
        Claim::new(
            "independent noise, ten hits: lines above the level of 5 % by chance",
            "probability of the level",
        )
        .expects(5.0, "%")
        .within(1.9, "four binomial standard errors over 2049 lines"),
        || {
            let coherence = coherence()?;
            let level = coherence.chance_level(0.05)?;
            let above = coherence.values.iter().filter(|v| **v > level).count();
            Ok(100.0 * above as f64 / coherence.values.len() as f64)
        },
    );
}

#[test]
fn the_variance_of_a_line_is_twice_that_of_a_component() {
    let n_hits = 30;
    let spectra = noisy(19, 512, n_hits, 0.0, 0.4).unwrap();
    for response in [
        spectra.h1("x", "y").unwrap(),
        spectra.h2("x", "y").unwrap(),
        spectra.hv("x", "y").unwrap(),
    ] {
        let coherence = response.coherence.as_ref().unwrap();
        let errors = response.random_error().unwrap();
        let variances = response.variance.as_ref().unwrap();
        for k in 0..response.values.len() {
            let square = response.values[k].norm_sqr();
            let formula = square * (1.0 - coherence[k]) / (f64::from(n_hits - 1) * coherence[k]);
            let from_error = 2.0 * square * errors[k].magnitude.powi(2);
            // tolerance: the same numbers combined in another order, including the difference 1 -
            // coherence
            assert!((variances[k] - formula).abs() < 1e-12 * formula);
            assert!((variances[k] - from_error).abs() < 1e-12 * formula);
        }
    }
}
