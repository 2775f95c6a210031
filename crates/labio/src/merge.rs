//! One frequency response of several tests, with the share that every test has in every line.
//!
//! Theory: `docs/theory/spectra.md#two-hammers`.

use ndarray::Array2;
use num_complex::Complex64;

use crate::{AveragedSpectra, Estimator, FrequencyResponse, LabioError, LineValidity};

/// Two tests have the same lines if their frequencies differ relatively by less than this, as sampling rates may.
const FREQUENCY_TOLERANCE: f64 = 1e-9;

/// The response that several tests of the same two points have in common, as of a heavy and a light hammer.
///
/// | field | shape | unit |
/// |---|---|---|
/// | `shares` | `(n_tests, n_lines)` | 1, sums to 1 over the tests |
/// | `discrepancy` | `(n_lines)` | 1 |
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MergedResponse {
    /// The merged response. Its number of averages is that of all tests together; a line's errors are its own.
    pub response: FrequencyResponse,
    /// Provenance: what part of a line comes from which test; 0 for all tests where no test has information.
    pub shares: Array2<f64>,
    /// How far the tests are apart in units of their errors, $`\frac1{m-1}\sum_h\lvert H_h-H\rvert^2/\mathrm{Var}_h`$ over the m tests that
    /// have information: 1 in the mean if they differ by their random errors only. NaN where fewer than two have.
    pub discrepancy: Vec<f64>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "`like` has found as many lines in every list of every test; the spectra of a test have the lines of its response"
)]
impl MergedResponse {
    /// Takes each line from the test with the larger averaged auto-spectrum of the input (Ödeen 1993, paper E, section 3.1). A
    /// test without information on a line does not compete for it.
    ///
    /// # Examples
    ///
    /// The program `merge_two_hammers` in the examples.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without a test, [`LabioError::UnknownChannel`], [`LabioError::ResponseMismatch`] if
    /// the tests have other lines or other quantities.
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
        let mut merged = Self::like(&responses)?;
        let averaged = responses.iter().all(|r| r.variance.is_some());
        if averaged {
            merged.response.coherence = Some(vec![f64::NAN; merged.discrepancy.len()]);
        } else {
            merged.response.variance = None;
        }
        let level = |test: usize, line: usize| levels[test][line];
        for line in 0..merged.discrepancy.len() {
            let candidates = (0..responses.len())
                .filter(|test| responses[*test].validity[line] == LineValidity::Valid);
            let Some(largest) = candidates.max_by(|a, b| {
                // of equals the first
                level(*a, line).total_cmp(&level(*b, line)).then(b.cmp(a))
            }) else {
                continue;
            };
            merged.shares[(largest, line)] = 1.0;
            merged.take(line, &responses[largest]);
            if averaged {
                merged.discrepancy[line] = discrepancy(&responses, line);
            }
        }
        Ok(merged)
    }

    /// Weighs the tests on each line by the inverse of their variances,
    ///
    /// ```math
    /// H = \frac{\sum_h H_h/\mathrm{Var}_h}{\sum_h 1/\mathrm{Var}_h}, \qquad
    /// \mathrm{Var} = \frac{1}{\sum_h 1/\mathrm{Var}_h},
    /// ```
    ///
    /// the linear combination of least variance. No test is thrown away where two are about equally good, and a large force with
    /// a low coherence does not win.
    ///
    /// # Validity
    ///
    /// The tests are independent, and their errors random: what they have in common, as a wrong sensitivity, is not
    /// averaged. The variances are estimates themselves; from n hits each, the stated variance is too small by a part of about 4/n.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without a test, or if the lists of one are not of one length; [`LabioError::TooFewAverages`] if a
    /// test is of one hit and has no variance; [`LabioError::ResponseMismatch`].
    pub fn by_inverse_variance(tests: &[FrequencyResponse]) -> Result<Self, LabioError> {
        let mut merged = Self::like(tests)?;
        for test in tests {
            if test.variance.is_none() {
                return Err(LabioError::TooFewAverages {
                    estimate: "a merge by inverse variance",
                    found: test.n_averages,
                    expected: 2,
                });
            }
        }
        let mut weights = vec![0.0; tests.len()];
        for line in 0..merged.discrepancy.len() {
            weigh(tests, line, &mut weights);
            let total: f64 = weights.iter().sum();
            if total <= 0.0 {
                continue;
            }
            let mut value = Complex64::ZERO;
            let mut variance = 0.0;
            for (index, (test, weight)) in tests.iter().zip(&weights).enumerate() {
                if *weight > 0.0 {
                    let share = weight / total;
                    merged.shares[(index, line)] = share;
                    value += test.values[line] * share;
                    variance += share * share * variance_at(test, line);
                }
            }
            let response = &mut merged.response;
            response.values[line] = value;
            response.validity[line] = LineValidity::Valid;
            if let Some(variances) = &mut response.variance {
                variances[line] = variance;
            }
            merged.discrepancy[line] = discrepancy(tests, line);
        }
        Ok(merged)
    }

    /// A response like those of the tests, with no line in it yet.
    fn like(tests: &[FrequencyResponse]) -> Result<Self, LabioError> {
        let Some(first) = tests.first() else {
            return Err(LabioError::CountMismatch {
                what: "tests to merge",
                found: 0,
                expected: 1,
            });
        };
        for (index, test) in tests.iter().enumerate() {
            test.check_lengths()?;
            check_alike(first, test, index)?;
        }
        let n_lines = first.values.len();
        let mut response = FrequencyResponse {
            n_averages: tests.iter().map(|test| test.n_averages).sum(),
            effective_averages: tests.iter().map(|test| test.effective_averages).sum(),
            variance: Some(vec![f64::NAN; n_lines]),
            coherence: None,
            ..first.clone()
        };
        for (line, validity) in first.validity.iter().enumerate() {
            // where no test has a line, the first says why; a line that is found valid overwrites it
            let reason = match validity {
                LineValidity::Valid => LineValidity::NoInput,
                reason => *reason,
            };
            response.invalidate(line, reason);
        }
        Ok(Self {
            response,
            shares: Array2::zeros((tests.len(), n_lines)),
            discrepancy: vec![f64::NAN; n_lines],
        })
    }

    fn take(&mut self, line: usize, test: &FrequencyResponse) {
        let response = &mut self.response;
        response.values[line] = test.values[line];
        response.validity[line] = test.validity[line];
        if let (Some(to), Some(from)) = (&mut response.coherence, &test.coherence) {
            to[line] = from[line];
        }
        if let (Some(to), Some(from)) = (&mut response.variance, &test.variance) {
            to[line] = from[line];
        }
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "`MergedResponse::like` has found as many lines in every list of every test"
)]
fn variance_at(test: &FrequencyResponse, line: usize) -> f64 {
    test.variance
        .as_ref()
        .map_or(f64::NAN, |variances| variances[line])
}

/// Inverse variances; 0 without information. Tests without any scatter share a line among themselves.
#[allow(
    clippy::indexing_slicing,
    reason = "`MergedResponse::like` has found as many lines in every list of every test"
)]
fn weigh(tests: &[FrequencyResponse], line: usize, weights: &mut [f64]) {
    let mut certain = false;
    for (test, weight) in tests.iter().zip(&mut *weights) {
        let variance = variance_at(test, line);
        *weight = if test.validity[line] == LineValidity::Valid && variance >= 0.0 {
            variance.recip()
        } else {
            0.0
        };
        certain |= weight.is_infinite();
    }
    if certain {
        for weight in weights {
            *weight = if weight.is_infinite() { 1.0 } else { 0.0 };
        }
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "`MergedResponse::like` has found as many lines in every list of every test"
)]
fn discrepancy(tests: &[FrequencyResponse], line: usize) -> f64 {
    let mut weights = vec![0.0; tests.len()];
    weigh(tests, line, &mut weights);
    let m = weights.iter().filter(|weight| **weight > 0.0).count();
    if m < 2 {
        return f64::NAN;
    }
    let total: f64 = weights.iter().sum();
    let values = || {
        let lines = tests.iter().map(|test| test.values[line]);
        lines.zip(&weights).filter(|(_, weight)| **weight > 0.0)
    };
    let mean: Complex64 = values().map(|(h, weight)| h * weight).sum::<Complex64>() / total;
    let squares: f64 = values().map(|(h, w)| w * (h - mean).norm_sqr()).sum();
    squares / (m as f64 - 1.0)
}

fn check_alike(
    first: &FrequencyResponse,
    test: &FrequencyResponse,
    index: usize,
) -> Result<(), LabioError> {
    let differ = |what, found: String, expected: String| {
        Err(LabioError::ResponseMismatch {
            what,
            index,
            found,
            expected,
        })
    };
    if test.n_samples != first.n_samples {
        let (found, expected) = (test.n_samples, first.n_samples);
        return differ("number of samples", found.to_string(), expected.to_string());
    }
    if test.values.len() != first.values.len() {
        let (found, expected) = (test.values.len(), first.values.len());
        return differ("number of lines", found.to_string(), expected.to_string());
    }
    for (what, found, expected) in [
        ("input", &test.input, &first.input),
        ("output", &test.output, &first.output),
    ] {
        if found != expected {
            return differ(what, found.to_string(), expected.to_string());
        }
    }
    if test.estimator != first.estimator {
        let (found, expected) = (test.estimator, first.estimator);
        return differ("estimator", format!("{found:?}"), format!("{expected:?}"));
    }
    if test.added_damping != first.added_damping {
        let rate = |r: &FrequencyResponse| r.added_damping.map_or(0.0, |w| w.decay_rate());
        let (found, expected) = (rate(test), rate(first));
        return differ(
            "added decay rate [1/s]",
            found.to_string(),
            expected.to_string(),
        );
    }
    let (found, expected) = (test.values.len(), first.values.len());
    if found != expected {
        return differ("number of lines", found.to_string(), expected.to_string());
    }
    for (found, expected) in test.frequency_hz.iter().zip(&first.frequency_hz) {
        if (found - expected).abs() > FREQUENCY_TOLERANCE * expected {
            return differ(
                "frequency of a line [Hz]",
                found.to_string(),
                expected.to_string(),
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
