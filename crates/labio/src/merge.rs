//! One frequency response from several tests, with the share of every test in every line.
//!
//! Theory: `docs/theory/spectra.md#two-hammers`.

mod agreement;
mod entering;

pub use agreement::Agreement;

use std::fmt;

use ndarray::Array2;
use num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, Gamma};

use crate::error::{check_count, count_mismatch, too_few_averages};
use crate::{AveragedSpectra, Estimator, FrequencyResponse, LabioError, LineValidity};
use agreement::agreement;
use entering::{
    CLEAR, Entering, bias_at, clear_lines, common_error_at, common_variance, freedom_at, is_above,
};

/// Largest relative difference between frequencies that count as the same line; the sampling rates
/// of tests may differ slightly.
const FREQUENCY_TOLERANCE: f64 = 1e-9;

/// The common response of several tests between the same two points, for example with a heavy and a
/// light hammer.
///
/// A test contributes to a line if its coherence is above the level that noise alone reaches with a
/// probability of 5 % ([`Coherence::CHANCE`](crate::Coherence::CHANCE)); if no test reaches that
/// level, all contribute, and the line is not [coherent](Self::coherent).
///
/// | field | shape | unit |
/// |---|---|---|
/// | `shares` | `(n_tests, n_lines)` | 1, sums to 1 over the tests |
/// | `coherent`, `discrepancy`, `inflation` | `(n_lines)` | 1 |
/// | `agreement` | `(n_tests - 1)` | |
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MergedResponse {
    /// The merged response. Its number of averages is that of all tests together; its errors are
    /// stated line by line.
    pub response: FrequencyResponse,
    /// Provenance: share of each test in each line; 0 for all tests where no test has information.
    pub shares: Array2<f64>,
    /// True where the contributing tests are coherent. A test without coherence counts as
    /// coherent.
    pub coherent: Vec<bool>,
    /// Difference between the coherent tests in units of their errors. For two tests it is
    /// $`\frac\nu2\ln(1+2f/\nu)`$ with
    /// $`f=\lvert H_1-H_2\rvert^2/(\mathrm{Var}_1+\mathrm{Var}_2)`$, where the possible bias of a
    /// line counts as a variance, and ν is the degrees of freedom of the sum of variances (Welch
    /// and Satterthwaite). This is minus the logarithm of the probability of a difference this
    /// large by chance; its mean is 1 for any number of hits, and it is f for many hits. For more
    /// tests it is the mean over the tests, each compared with those of smaller variance. A gain
    /// between the tests that their common errors [explain](Agreement::explains_gain) is removed
    /// first. NaN if fewer than two tests are coherent.
    pub discrepancy: Vec<f64>,
    /// Factor on the variance where the discrepancy of the line and its neighbours exceeds chance
    /// (Birge's ratio); 1 elsewhere.
    pub inflation: Vec<f64>,
    /// Agreement of each later test with the first, over all lines that both have; `None` if there
    /// are too few such lines.
    pub agreement: Vec<Option<Agreement>>,
}

/// Number of lines on each side of a line whose discrepancies are averaged with its own.
const NEIGHBOURS: usize = 16;

/// Probability that chance alone makes the mean discrepancy of neighbouring lines significant on
/// any line of two tests.
const BY_CHANCE: f64 = 0.01;

#[allow(
    clippy::indexing_slicing,
    reason = "`like` has found the same number of lines in every list of every test; the spectra of a test have the lines of its response"
)]
impl MergedResponse {
    /// Uses for each line the test with the largest coherent power of the input,
    /// $`\gamma^2 G_{xx}`$ (Ödeen 1993, paper E, section 3.1, for inputs without noise). If there
    /// are tests with a coherence above the level that noise alone reaches with a probability of
    /// 1e-4, only these are considered.
    ///
    /// # Examples
    ///
    /// See the example program `merge_two_hammers`.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without a test, [`LabioError::UnknownChannel`],
    /// [`LabioError::ResponseMismatch`] if the tests differ in their lines or quantities.
    pub fn by_larger_input(
        tests: &[&AveragedSpectra],
        estimator: Estimator,
        input: &str,
        output: &str,
    ) -> Result<Self, LabioError> {
        let responses = tests
            .iter()
            .map(|test| test.response(estimator, input, output))
            .collect::<Result<Vec<_>, _>>()?;
        let levels = tests
            .iter()
            .map(|test| test.auto_lines(input))
            .collect::<Result<Vec<_>, _>>()?;
        Self::larger_of(&responses, &levels)
    }

    /// Uses for each line the test with the largest coherent level; `levels` has one list per test
    /// with the averaged auto-spectrum of the input.
    ///
    /// # Errors
    ///
    /// The errors of [`MergedResponse::by_larger_input`].
    pub fn larger_of(
        responses: &[FrequencyResponse],
        levels: &[&[f64]],
    ) -> Result<Self, LabioError> {
        let mut merged = Self::like(responses)?;
        let n_lines = merged.coherent.len();
        for level in levels {
            check_count("lines of the spectrum of the input", level.len(), n_lines)?;
        }
        check_count("spectra of the input", levels.len(), responses.len())?;
        let coherence = |test: usize, line: usize| {
            let coherence = responses[test].coherence.as_ref();
            coherence.map_or(1.0, |coherence| coherence[line])
        };
        if responses.iter().all(|r| r.variance.is_some()) {
            merged.response.coherence = Some(vec![f64::NAN; n_lines]);
        } else {
            merged.response.variance = None;
            merged.response.degrees_of_freedom = None;
        }
        let level = |test: usize, line: usize| coherence(test, line) * levels[test][line];
        for line in 0..n_lines {
            let Entering { tests, coherent } = Entering::of(responses, line);
            // a coherence that is above zero only by chance would turn noise power into coherent
            // power
            let clear = |test: &usize| is_above(&responses[*test], line, CLEAR);
            let any_clear = tests.iter().any(clear);
            let candidates = tests.into_iter().filter(|test| !any_clear || clear(test));
            let largest = candidates.max_by(|a, b| {
                // of tests with equal levels, the first one is used
                level(*a, line).total_cmp(&level(*b, line)).then(b.cmp(a))
            });
            let Some(largest) = largest else { continue };
            merged.coherent[line] = coherent;
            merged.shares[(largest, line)] = 1.0;
            merged.take(line, &responses[largest]);
        }
        merged.compare(responses);
        Ok(merged)
    }

    /// Weights the tests on each line by the inverse of their variances for a common H,
    ///
    /// ```math
    /// H = \frac{\sum_h H_h/(V_h + b_h^2)}{\sum_h 1/(V_h + b_h^2)}, \qquad
    /// V_h = \mathrm{Var}_h\max\Bigl(1, \frac{\lvert H\rvert^2}{\lvert H_h\rvert^2}\Bigr), \qquad
    /// \mathrm{Var} = \Bigl(1 + 4\sum_h\frac{p_h(1-p_h)}{\nu_h}\Bigr)\sum_h p_h^2\,V_h ,
    /// ```
    ///
    /// with |H| of the test with the smallest relative variance, the shares $`p_h`$, the degrees of
    /// freedom $`\nu_h`$, and the bias $`b_h`$ caused by noise at rest if that is known, or else
    /// the bias if all missing coherence were noise of the channel that the estimator assumes to be
    /// noise-free ([`FrequencyResponse::bias`]). The variance of H1 alone is unsuitable as a
    /// weight: input noise reduces it together with H1, and a test without signal would dominate.
    /// The sum over $`p_h(1-p_h)`$ is the cost of estimated weights (Meier 1953). The degrees of
    /// freedom are those of Welch and Satterthwaite, $`1/\nu = \sum_h p_h^2/\nu_h`$.
    ///
    /// # Validity
    ///
    /// The tests are independent, and their errors random. If they differ by more than these
    /// errors, the variance is [inflated](Self::inflation), and an
    /// [unexplained](Agreement::explains_gain) gain between them is added to the common error. For
    /// tests of two hits each, the variance is too small by a third.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without a test, or if the lists of a test have different
    /// lengths; [`LabioError::TooFewAverages`] if a test has one hit and no variance;
    /// [`LabioError::ResponseMismatch`].
    pub fn by_inverse_variance(tests: &[FrequencyResponse]) -> Result<Self, LabioError> {
        let mut merged = Self::like(tests)?;
        for test in tests {
            if test.variance.is_none() {
                return too_few_averages("a merge by inverse variance", test.n_averages, 2);
            }
        }
        for line in 0..merged.coherent.len() {
            let entering = Entering::of(tests, line);
            let shares = entering.shares(tests, line);
            if shares.is_empty() {
                continue;
            }
            merged.coherent[line] = entering.coherent;
            let of = |of_test: &dyn Fn(&FrequencyResponse) -> f64| -> f64 {
                shares.iter().map(|(h, p)| p * of_test(&tests[*h])).sum()
            };
            let value: Complex64 = shares.iter().map(|(h, p)| tests[*h].values[line] * p).sum();
            let scatter: f64 = shares
                .iter()
                .map(|(h, p)| p * p * common_variance(&tests[*h], line, value.norm_sqr()))
                .sum();
            let of_squares: f64 = shares
                .iter()
                .map(|(h, p)| p * p / freedom_at(&tests[*h], line))
                .sum();
            let cost = of(&|test| 1.0 / freedom_at(test, line)) - of_squares;
            for (h, share) in &shares {
                merged.shares[(*h, line)] = *share;
            }
            let response = &mut merged.response;
            response.values[line] = value;
            response.validity[line] = LineValidity::Valid;
            if let Some(variances) = &mut response.variance {
                variances[line] = scatter * (1.0 + 4.0 * cost);
            }
            if let Some(degrees) = &mut response.degrees_of_freedom {
                degrees[line] = 1.0 / of_squares;
            }
            if let Some(bias) = &mut response.noise_bias {
                bias[line] = of(&|test| test.noise_bias.as_ref().map_or(f64::NAN, |b| b[line]));
            }
            if let Some(bias) = &mut response.possible_bias {
                bias[line] = of(&|test| bias_at(test, line));
            }
            if let Some(error) = &mut response.common_error {
                error[line] = of(&|test| common_error_at(test, line));
            }
        }
        merged.compare(tests);
        Ok(merged)
    }

    /// Creates a response with the properties of the tests, but without lines yet.
    fn like(tests: &[FrequencyResponse]) -> Result<Self, LabioError> {
        let Some(first) = tests.first() else {
            return count_mismatch("tests to merge", 0, 1);
        };
        for (index, test) in tests.iter().enumerate() {
            test.check_lengths()?;
            check_alike(first, test, index)?;
        }
        let n_lines = first.values.len();
        let nothing = || vec![f64::NAN; n_lines];
        let mut response = FrequencyResponse {
            n_averages: tests.iter().map(|test| test.n_averages).sum(),
            effective_averages: tests.iter().map(|test| test.effective_averages).sum(),
            variance: Some(nothing()),
            degrees_of_freedom: Some(nothing()),
            noise_bias: tests.iter().all(|t| t.noise_bias.is_some()).then(nothing),
            possible_bias: tests
                .iter()
                .any(|t| t.possible_bias.is_some())
                .then(nothing),
            common_error: tests.iter().any(|t| t.common_error.is_some()).then(nothing),
            coherence: None,
            ..first.clone()
        };
        for (line, validity) in first.validity.iter().enumerate() {
            // where no test has a line, the reason stated by the first test is kept; a valid line
            // overwrites it
            let reason = match validity {
                LineValidity::Valid => LineValidity::NoInput,
                reason => *reason,
            };
            response.invalidate(line, reason);
        }
        Ok(Self {
            response,
            shares: Array2::zeros((tests.len(), n_lines)),
            coherent: vec![false; n_lines],
            discrepancy: nothing(),
            inflation: vec![1.0; n_lines],
            agreement: Vec::new(),
        })
    }

    fn take(&mut self, line: usize, test: &FrequencyResponse) {
        let response = &mut self.response;
        response.values[line] = test.values[line];
        response.validity[line] = test.validity[line];
        for (to, from) in [
            (&mut response.coherence, &test.coherence),
            (&mut response.variance, &test.variance),
            (&mut response.degrees_of_freedom, &test.degrees_of_freedom),
            (&mut response.noise_bias, &test.noise_bias),
            (&mut response.possible_bias, &test.possible_bias),
        ] {
            if let (Some(to), Some(from)) = (to, from) {
                to[line] = from[line];
            }
        }
        if let Some(to) = &mut response.common_error {
            to[line] = common_error_at(test, line);
        }
    }

    /// Compares the tests line by line and as a whole; differences beyond chance are added to the
    /// errors.
    fn compare(&mut self, tests: &[FrequencyResponse]) {
        if tests.iter().any(|test| test.variance.is_none()) {
            return;
        }
        let entering: Vec<Entering> = (0..self.coherent.len())
            .map(|line| Entering::of(tests, line))
            .collect();
        let clear: Vec<Vec<bool>> = tests.iter().map(clear_lines).collect();
        if let Some((first, others)) = tests.split_first() {
            let enters = |test: usize, line: usize| {
                entering[line].tests.contains(&test) && clear[test][line]
            };
            for (other, test) in others.iter().zip(1..) {
                let both =
                    (0..entering.len()).filter(|line| enters(0, *line) && enters(test, *line));
                self.agreement.push(agreement(first, other, both));
            }
        }
        // a gain that the sensors explain is a common error, which is not tested line by line
        let explained = self.agreement.iter().map(|agreement| match agreement {
            Some(agreement) if agreement.expected > 0.0 && agreement.explains_gain() => {
                agreement.gain
            }
            _ => 1.0,
        });
        let gains: Vec<f64> = std::iter::once(1.0).chain(explained).collect();
        let mut known = Vec::new();
        for (line, entering) in entering.iter().enumerate() {
            if !entering.coherent {
                continue;
            }
            let compared = (clear.as_slice(), gains.as_slice());
            if let Some((discrepancy, freedom)) = entering.discrepancy(tests, compared, line) {
                self.discrepancy[line] = discrepancy;
                known.push((line, freedom));
            }
        }
        for (at, (line, freedom)) in known.iter().enumerate() {
            let from = at.saturating_sub(NEIGHBOURS);
            let near = &known[from..known.len().min(at + NEIGHBOURS + 1)];
            let count = near.len() as f64;
            let mean = near
                .iter()
                .map(|(line, _)| self.discrepancy[*line])
                .sum::<f64>()
                / count;
            // each discrepancy is exponential with mean 1
            let by_chance = Gamma::new(count, 1.0).map_or(1.0, |sum| sum.sf(mean * count));
            if by_chance * known.len() as f64 > BY_CHANCE {
                continue;
            }
            // converts a discrepancy to a square divided by its variance; the mean discrepancy by
            // chance is 1
            let square = |discrepancy: f64| {
                if freedom.is_finite() {
                    0.5 * freedom * (2.0 * discrepancy / freedom).exp_m1()
                } else {
                    discrepancy
                }
            };
            self.inflation[*line] = square(mean) / square(1.0);
            if let Some(variances) = &mut self.response.variance {
                variances[*line] *= self.inflation[*line];
            }
        }
        // of two tests whose gains differ by d, either may be wrong: a root-mean-square error of
        // d/√2 for each
        let unexplained = self
            .agreement
            .iter()
            .flatten()
            .filter(|a| !a.explains_gain());
        let apart = unexplained.fold(0.0_f64, |most, a| most.max(a.gain.abs().ln().abs()));
        if apart > 0.0 {
            let n_lines = self.coherent.len();
            let errors = self
                .response
                .common_error
                .get_or_insert_with(|| vec![0.0; n_lines]);
            for error in errors {
                *error = error.hypot(apart / std::f64::consts::SQRT_2);
            }
        }
    }
}

fn check_alike(
    first: &FrequencyResponse,
    test: &FrequencyResponse,
    index: usize,
) -> Result<(), LabioError> {
    let differ = |what, found: &dyn fmt::Display, expected: &dyn fmt::Display| {
        Err(LabioError::ResponseMismatch {
            what,
            index,
            found: found.to_string(),
            expected: expected.to_string(),
        })
    };
    if test.n_samples != first.n_samples {
        return differ("number of samples", &test.n_samples, &first.n_samples);
    }
    let lines = |r: &FrequencyResponse| r.values.len();
    if lines(test) != lines(first) {
        return differ("number of lines", &lines(test), &lines(first));
    }
    if test.input != first.input {
        return differ("input", &test.input, &first.input);
    }
    if test.output != first.output {
        return differ("output", &test.output, &first.output);
    }
    if test.estimator != first.estimator {
        let name = |r: &FrequencyResponse| format!("{:?}", r.estimator);
        return differ("estimator", &name(test), &name(first));
    }
    if test.added_damping != first.added_damping {
        let rate = |r: &FrequencyResponse| r.added_damping.map_or(0.0, |w| w.decay_rate());
        return differ("added decay rate [1/s]", &rate(test), &rate(first));
    }
    for (found, expected) in test.frequency_hz.iter().zip(&first.frequency_hz) {
        if (found - expected).abs() > FREQUENCY_TOLERANCE * expected {
            return differ("frequency of a line [Hz]", found, expected);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
