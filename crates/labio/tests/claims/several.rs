//! Several inputs at once, and several tests made into one.

use labio::{
    Channel, FrequencyResponse, MergedResponse, MultiInputResponse, Provenance, Quantity, Record,
    SpectrumAverager, Window,
};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::estimators::noisy;
use super::hits::{mean, noise};
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

/// Three inputs, the second with half of the first in it and the third with the first two, through gains; noise on the output.
fn three_inputs(n: usize, n_hits: u32, level: f64, seed: u64) -> Fallible<MultiInputResponse> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let channels = ["a", "b", "c", "y"]
        .iter()
        .map(|name| Channel::new(*name, Quantity::Velocity))
        .collect::<Result<Vec<_>, _>>()?;
    let mut averager = SpectrumAverager::new(&channels, n, 1.0, Window::Rectangular)?;
    for _ in 0..n_hits {
        let drawn = [0, 1, 2, 3].map(|_| noise(&mut rng, n, 1.0));
        let mut samples = Array2::zeros((4, n));
        for i in 0..n {
            let a = drawn[0][i];
            let b = drawn[1][i] + 0.5 * a;
            let c = drawn[2][i] + 0.3 * a - 0.8 * b;
            let y = GAINS[0] * a + GAINS[1] * b + GAINS[2] * c + level * drawn[3][i];
            for (row, value) in [a, b, c, y].into_iter().enumerate() {
                samples[(row, i)] = value;
            }
        }
        let provenance = Provenance::computed("noise");
        averager.add(&Record::new(
            samples,
            1.0,
            0.0,
            channels.clone(),
            provenance,
        )?)?;
    }
    Ok(averager.spectra()?.multi_input(&["a", "b", "c"], "y")?)
}

fn several_inputs(report: &mut Claims) {
    report.check(
        Claim::new(
            "three dependent inputs without noise: their gains",
            "the gains",
        )
        .within(
            1e-9,
            "rounding, amplified by lines where six averages make inputs nearly dependent",
        ),
        || {
            let response = three_inputs(64, 6, 0.0, 1)?;
            worst(GAINS.iter().enumerate(), |(input, gain)| {
                Ok(largest(
                    response.values.row(input).iter().map(|h| (h - gain).norm()),
                ))
            })
        },
    );
    // a = u, b = v + u/2, c = w - 0.8 v - 0.1 u: y = 1.6 u - 1.7 v + 1.5 w + e
    let parts = [1.6_f64.powi(2), 1.7_f64.powi(2), 1.5_f64.powi(2)];
    let total = parts.iter().sum::<f64>() + 1.0;
    let why = "four standard errors over 513 lines, and the bias q(1 - γ²)/n";
    report.check(
        Claim::new(
            "three dependent inputs, noise on the output: multiple coherence",
            "closed form of the model",
        )
        .expects(1.0 - 1.0 / total, "1")
        .within(0.011, why),
        || Ok(mean(&three_inputs(1024, 200, 1.0, 3)?.multiple_coherence)),
    );
    report.check(
        Claim::new(
            "three dependent inputs, noise on the output: partial coherence of the last",
            "closed form of the model",
        )
        .expects(2.25 / 3.25, "1")
        .within(0.011, why),
        || {
            Ok(mean(
                &three_inputs(1024, 200, 1.0, 3)?
                    .partial_coherence
                    .row(2)
                    .to_vec(),
            ))
        },
    );
    report.check(
        Claim::new("three dependent inputs: parts of the coherence in their order, sum less the multiple one", "they add up")
            .within(1e-12, "rounding"),
        || {
            let response = three_inputs(1024, 200, 1.0, 3)?;
            Ok(largest(response.multiple_coherence.iter().enumerate().map(|(line, multiple)| {
                response.ordered_coherence.column(line).sum() - multiple
            })))
        },
    );
    report.check(
        Claim::new("three dependent inputs, ten hits: scatter of the gains over lines by the stated variance", "definition of a variance")
            .expects(1.0, "1")
            .within(0.09, "four standard errors over 4095 lines with heavy tails"),
        || {
            let response = three_inputs(8192, 10, 1.0, 4)?;
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
    // two tests of a gain of 2, one with ten times the power of noise of the other
    let tests = || -> Fallible<[FrequencyResponse; 2]> {
        Ok([
            noisy(21, 2048, 20, 0.0, 0.01)?.h1("x", "y")?,
            noisy(22, 2048, 20, 0.0, 0.1)?.h1("x", "y")?,
        ])
    };
    let square_error = |response: &FrequencyResponse| {
        let squares: Vec<f64> = response
            .values
            .iter()
            .map(|h| (h - 2.0).norm_sqr())
            .collect();
        mean(&squares)
    };
    report.check(
        Claim::new("two tests merged by inverse variance: squared error by that of the better test", "closed form: noise powers of 1 and 10 give 10/11")
            .expects(10.0 / 11.0, "1")
            .within(0.05, "4/n that the estimated weights cost, and four standard errors of a ratio of like errors"),
        || {
            let tests = tests()?;
            let merged = MergedResponse::by_inverse_variance(&tests)?.response;
            Ok(square_error(&merged) / square_error(&tests[0]))
        },
    );
}
