//! Frequency responses and coherences: known bodies, the bias by noise, random errors.

use std::f64::consts::TAU;

use labio::{AveragedSpectra, Coherence, Estimator, FrequencyResponse, SpectrumAverager, Window};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::hits::{hit, mean, noise, sum};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::largest;
use testbed::hold;

const RATE: f64 = 1000.0;
const BENDAT: &str = "Bendat and Piersol";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    known_bodies(&mut report);
    bias(&mut report);
    random_errors(&mut report);
    nothing_in_common(&mut report);
    hold!(report);
}

/// Circular convolution by direct sum, so that a line of the output is the response times the line of the input.
fn circular(filter: &[f64], input: &[f64]) -> Vec<f64> {
    let n = input.len();
    (0..n)
        .map(|i| {
            let past = filter.iter().enumerate();
            past.map(|(lag, h)| h * input[(i + n - lag) % n]).sum()
        })
        .collect()
}

fn known_bodies(report: &mut Claims) {
    const FILTER: [f64; 5] = [0.7, -0.2, 0.0, 0.45, 0.1];
    let spectra = || -> Fallible<AveragedSpectra> {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut hits = Vec::new();
        for _ in 0..3 {
            let input = noise(&mut rng, 96, 1.0);
            hits.push(hit(&input, &circular(&FILTER, &input), RATE)?);
        }
        Ok(AveragedSpectra::of(&hits, Window::Rectangular)?)
    };
    for (name, estimator) in [
        ("H1", Estimator::H1),
        ("H2", Estimator::H2),
        ("Hv", Estimator::Hv),
    ] {
        report.check(
            Claim::new(
                format!("{name} of a filter of five taps without noise"),
                "transform of the taps by direct sum",
            )
            .within(1e-12, "rounding, amplified by the weakest of 49 lines"),
            || {
                let response = spectra()?.response(estimator, "x", "y")?;
                let lines = response.frequency_hz.iter().zip(&response.values);
                Ok(largest(lines.map(|(f, value)| {
                    let exact: Complex64 = FILTER
                        .iter()
                        .enumerate()
                        .map(|(lag, h)| h * Complex64::cis(-TAU * f * lag as f64 / RATE))
                        .sum();
                    (value - exact).norm()
                })))
            },
        );
    }
    report.check(
        Claim::new("coherence of a linear body without noise", "definition")
            .expects(1.0, "1")
            .within(1e-12, "rounding, amplified by the weakest of 49 lines"),
        || {
            let values = spectra()?.coherence("x", "y")?.values;
            Ok(1.0 - largest(values.iter().map(|c| c - 1.0)))
        },
    );
    report.check(
        Claim::new(
            "delay of seven samples turns the phase by -ωτ",
            "shift theorem",
        )
        .within(1e-12, "rounding"),
        || {
            let mut pulse = vec![0.0; 100];
            pulse[3] = 2.0;
            let mut later = vec![0.0; 100];
            later[10] = 2.0;
            let hit = hit(&pulse, &later, RATE)?;
            let response = AveragedSpectra::of([&hit], Window::Rectangular)?.h1("x", "y")?;
            let lines = response.frequency_hz.iter().zip(&response.values);
            Ok(largest(lines.map(|(f, value)| {
                (value - Complex64::cis(-TAU * f * 7.0 / RATE)).norm()
            })))
        },
    );
}

/// Hits of white noise through a gain of 2, with noise of relative power `a` on the input and `b` on the output.
pub(super) fn noisy(seed: u64, n: usize, n_hits: u32, a: f64, b: f64) -> Fallible<AveragedSpectra> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let silence = vec![0.0; n];
    let like = hit(&silence, &silence, RATE)?;
    let mut averager = SpectrumAverager::for_records_like(&like, Window::Rectangular)?;
    for _ in 0..n_hits {
        let clean = noise(&mut rng, n, 1.0);
        let output: Vec<f64> = clean.iter().map(|x| 2.0 * x).collect();
        let input = sum(&clean, &noise(&mut rng, n, a.sqrt()));
        let output = sum(&output, &noise(&mut rng, n, 2.0 * b.sqrt()));
        averager.add(&hit(&input, &output, RATE)?)?;
    }
    Ok(averager.spectra()?)
}

fn bias(report: &mut Claims) {
    let (a, b): (f64, f64) = (0.25, 0.5);
    let why = "four standard errors over 257 lines, and half the squared random error";
    let cases = [
        (
            "H1",
            Estimator::H1,
            2.0 / (1.0 + a),
            "closed form H/(1 + N/S of the input)",
        ),
        (
            "H2",
            Estimator::H2,
            2.0 * (1.0 + b),
            "closed form H(1 + N/S of the output)",
        ),
        (
            "Hv",
            Estimator::Hv,
            2.0 * ((1.0 + b) / (1.0 + a)).sqrt(),
            "closed form, mean of both",
        ),
    ];
    for (name, estimator, expected, source) in cases {
        report.check(
            Claim::new(
                format!("{name} of a gain of 2 under noise of 25 % and 50 % of the power"),
                source,
            )
            .expects(expected, "1")
            .within_part(0.013, why),
            || {
                let response = noisy(3, 512, 200, a, b)?.response(estimator, "x", "y")?;
                let magnitudes: Vec<f64> = response.values.iter().map(|h| h.norm()).collect();
                Ok(mean(&magnitudes))
            },
        );
    }
    let g2 = 1.0 / ((1.0 + a) * (1.0 + b));
    report.check(
        Claim::new(
            "coherence under noise of 25 % and 50 % of the power",
            "closed form 1/((1 + a)(1 + b))",
        )
        .expects(g2, "1")
        .within(
            0.0094,
            "four standard errors over 257 lines, and the bias (1 - γ²)²/n",
        ),
        || Ok(mean(&noisy(3, 512, 200, a, b)?.coherence("x", "y")?.values)),
    );
    // what the response says of itself, at the expected coherence
    for (name, estimator) in [("H1", Estimator::H1), ("H2", Estimator::H2)] {
        let (expected, channel) = match estimator {
            Estimator::H1 => (-a / (1.0 + a), "input"),
            _ => (b, "output"),
        };
        report.check(
            Claim::new(
                format!("{name}: stated bias if all missing coherence is noise on the {channel}"),
                "closed form of the noise that was added",
            )
            .expects(expected, "1")
            .within(0.02, "four standard errors of the coherence over 257 lines"),
            || {
                let (a, b) = if channel == "input" {
                    (a, 0.0)
                } else {
                    (0.0, b)
                };
                let response = noisy(4, 512, 200, a, b)?.response(estimator, "x", "y")?;
                let bias = response.bias().ok_or("no coherence")?;
                let all: Vec<f64> = bias
                    .iter()
                    .map(|b| {
                        if channel == "input" {
                            b.input_noise
                        } else {
                            b.output_noise
                        }
                    })
                    .collect();
                Ok(mean(&all))
            },
        );
    }
}

fn random_errors(report: &mut Claims) {
    const HITS: u32 = 20;
    let g2: f64 = 1.0 / 1.3;
    let predicted = ((1.0 - g2) / (2.0 * f64::from(HITS - 1) * g2)).sqrt();
    let response =
        || -> Fallible<FrequencyResponse> { Ok(noisy(5, 4096, HITS, 0.0, 0.3)?.h1("x", "y")?) };
    // 0 Hz and the Nyquist frequency have half the degrees of freedom
    let inner = |values: &[Complex64]| values[1..values.len() - 1].to_vec();
    report.check(
        Claim::new(
            "random error of |H1|, 20 hits, noise of 30 %: scatter over lines",
            BENDAT,
        )
        .expects(predicted, "1")
        .within_part(
            0.075,
            "four standard errors over 2047 lines, and the second order",
        ),
        || {
            let squares: Vec<f64> = inner(&response()?.values)
                .iter()
                .map(|h| (h.norm() / 2.0 - 1.0).powi(2))
                .collect();
            Ok(mean(&squares).sqrt())
        },
    );
    report.check(
        Claim::new(
            "random error of the phase of H1, 20 hits, noise of 30 %: scatter over lines",
            BENDAT,
        )
        .expects(predicted, "rad")
        .within_part(
            0.075,
            "four standard errors over 2047 lines, and the second order",
        ),
        || {
            let squares: Vec<f64> = inner(&response()?.values)
                .iter()
                .map(|h| h.arg().powi(2))
                .collect();
            Ok(mean(&squares).sqrt())
        },
    );
    report.check(
        Claim::new(
            "random error of |H1|, 20 hits, noise of 30 %: median of what the lines state",
            BENDAT,
        )
        .expects(predicted, "1")
        .within_part(
            0.05,
            "bias of the coherence 1.2 %, four standard errors of the median",
        ),
        || {
            let mut stated: Vec<f64> = response()?
                .random_error()
                .ok_or("no coherence")?
                .iter()
                .map(|error| error.magnitude)
                .collect();
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
            "first order: (1 - γ²)/n of the next, and four standard errors",
        ),
        || {
            let values = noisy(5, 4096, HITS, 0.0, 0.3)?.coherence("x", "y")?.values;
            let centre = mean(&values);
            let squares: Vec<f64> = values.iter().map(|v| (v - centre).powi(2)).collect();
            Ok(mean(&squares).sqrt())
        },
    );
}

fn nothing_in_common(report: &mut Claims) {
    const HITS: u32 = 10;
    let coherence = || -> Fallible<Coherence> {
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        let mut hits = Vec::new();
        for _ in 0..HITS {
            let (x, y) = (noise(&mut rng, 4096, 1.0), noise(&mut rng, 4096, 1.0));
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
        || Ok(mean(&coherence()?.bias())),
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
