//! The tests that contribute to a merged line, with the errors that determine their weights.
#![allow(
    clippy::indexing_slicing,
    reason = "`MergedResponse::like` has found the same number of lines in every list of every test, and the entering tests are some of these tests"
)]

use num_complex::Complex64;

use crate::frf::chance_level;
use crate::{Coherence, FrequencyResponse, LineValidity};

/// Probability that noise alone reaches the coherence above which tests are compared.
pub(super) const CLEAR: f64 = 1e-4;

/// Number of lines on each side over which the coherence is averaged before this comparison. If
/// lines were chosen by their own coherence, those with an accidentally small variance would be
/// preferred: with three hits per test, half of all pairs of correct tests would seem to differ.
const CLEAR_NEIGHBOURS: usize = 8;

/// The tests that contribute to a line.
pub(super) struct Entering {
    pub(super) tests: Vec<usize>,
    pub(super) coherent: bool,
}

impl Entering {
    /// Returns the coherent tests or, if there are none, all tests that have information.
    pub(super) fn of(tests: &[FrequencyResponse], line: usize) -> Self {
        let informed: Vec<usize> = (0..tests.len())
            .filter(|h| tests[*h].validity[line] == LineValidity::Valid)
            .collect();
        let above_chance = |h: &usize| is_above(&tests[*h], line, Coherence::CHANCE);
        let coherent: Vec<usize> = informed.iter().copied().filter(above_chance).collect();
        if coherent.is_empty() {
            Self {
                tests: informed,
                coherent: false,
            }
        } else {
            Self {
                tests: coherent,
                coherent: true,
            }
        }
    }

    /// Returns the square of the most precise test's value, used as that of the common H.
    pub(super) fn square(&self, tests: &[FrequencyResponse], line: usize) -> f64 {
        let relative = |h: &usize| relative_variance(&tests[*h], line);
        let known = self.tests.iter().filter(|h| relative(h) >= 0.0);
        let best = known.min_by(|a, b| relative(a).total_cmp(&relative(b)));
        best.map_or(f64::NAN, |h| tests[*h].values[line].norm_sqr())
    }

    /// Returns the shares of the tests, from their variances for the common H; tests with zero
    /// variance share a line among themselves. Empty if no test has a variance.
    pub(super) fn shares(&self, tests: &[FrequencyResponse], line: usize) -> Vec<(usize, f64)> {
        let square = self.square(tests, line);
        let known = || {
            let variances = self.tests.iter().map(|h| {
                let test = &tests[*h];
                let bias = square * bias_at(test, line).powi(2);
                (*h, common_variance(test, line, square) + bias)
            });
            variances.filter(|(_, u)| *u >= 0.0 && u.is_finite())
        };
        let certain = known().filter(|(_, u)| *u <= 0.0).count();
        if certain > 0 {
            let share = 1.0 / certain as f64;
            let certain = known().filter(|(_, u)| *u <= 0.0);
            return certain.map(|(h, _)| (h, share)).collect();
        }
        let total: f64 = known().map(|(_, u)| u.recip()).sum();
        known().map(|(h, u)| (h, u.recip() / total)).collect()
    }

    /// Returns the discrepancy between the tests, divided by their `gains`, and the degrees of
    /// freedom of their variances.
    pub(super) fn discrepancy(
        &self,
        tests: &[FrequencyResponse],
        (clear, gains): (&[Vec<bool>], &[f64]),
        line: usize,
    ) -> Option<(f64, f64)> {
        let square = self.square(tests, line);
        let mut known: Vec<(Complex64, f64, f64)> = self
            .tests
            .iter()
            .filter(|h| clear[**h][line])
            .map(|h| {
                let test = &tests[*h];
                let variance = common_variance(test, line, square);
                let bias = square * bias_at(test, line).powi(2);
                let value = test.values[line] / gains[*h];
                (value, variance + bias, freedom_at(test, line))
            })
            .filter(|(_, variance, _)| *variance > 0.0 && variance.is_finite())
            .collect();
        // each test is compared with those of smaller variance, so that the order of the tests does
        // not matter
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        let ((mut mean, mut variance, mut freedom), others) = match known.split_first() {
            Some((first, others)) if !others.is_empty() => (*first, others),
            _ => return None,
        };
        let (mut sum, mut least) = (0.0, f64::INFINITY);
        for (value, own, own_freedom) in others {
            let both = variance + own;
            let of_both = both * both / (variance * variance / freedom + own * own / own_freedom);
            let squares = (value - mean).norm_sqr() / both;
            sum += if of_both.is_finite() {
                0.5 * of_both * (2.0 * squares / of_both).ln_1p()
            } else {
                squares
            };
            least = least.min(of_both);
            let share = own / both;
            mean = mean * share + value * (1.0 - share);
            let scatter = share * share / freedom + (1.0 - share).powi(2) / own_freedom;
            (variance, freedom) = (variance * own / both, 1.0 / scatter);
        }
        Some((sum / others.len() as f64, least))
    }
}

/// Returns true for lines around which the mean coherence is above that reached by noise alone, and
/// for completed lines.
pub(super) fn clear_lines(test: &FrequencyResponse) -> Vec<bool> {
    let Some(coherence) = &test.coherence else {
        return vec![true; test.values.len()];
    };
    let level = chance_level(CLEAR, test.effective_averages);
    let mean_about = |line: usize| {
        let near = coherence.iter().skip(line.saturating_sub(CLEAR_NEIGHBOURS));
        let near = near.take(line.min(CLEAR_NEIGHBOURS) + CLEAR_NEIGHBOURS + 1);
        let known = near.filter(|coherence| !coherence.is_nan());
        let (sum, count) = known.fold((0.0, 0.0), |(sum, n), c| (sum + c, n + 1.0));
        sum / count
    };
    let lines = coherence.iter().enumerate();
    lines
        .map(|(line, own)| own.is_nan() || mean_about(line) > level)
        .collect()
}

/// Returns true if noise alone reaches the coherence of a line with less than this probability, and
/// also for completed lines.
pub(super) fn is_above(test: &FrequencyResponse, line: usize, probability: f64) -> bool {
    let level = chance_level(probability, test.effective_averages);
    let coherence = test.coherence.as_ref().map(|coherence| coherence[line]);
    coherence.is_none_or(|coherence| coherence.is_nan() || coherence > level)
}

/// Returns the variance of a line divided by the square of its value, plus the square of the bias
/// where it is known.
pub(super) fn relative_variance(test: &FrequencyResponse, line: usize) -> f64 {
    let variance = test.variance.as_ref().map_or(f64::NAN, |v| v[line]);
    if variance <= 0.0 {
        return variance;
    }
    variance / test.values[line].norm_sqr() + bias_at(test, line).powi(2)
}

/// Returns the known or else the possible bias of a line; 0 for a completed line.
pub(super) fn bias_at(test: &FrequencyResponse, line: usize) -> f64 {
    match (&test.noise_bias, &test.possible_bias) {
        (Some(bias), _) => bias[line],
        (None, Some(bias)) if !bias[line].is_nan() => bias[line],
        _ => 0.0,
    }
}

/// Returns the variance of a test for a common H with this square: not less than the test's own
/// variance.
pub(super) fn common_variance(test: &FrequencyResponse, line: usize, square: f64) -> f64 {
    let variance = test.variance.as_ref().map_or(f64::NAN, |v| v[line]);
    if variance <= 0.0 {
        return variance;
    }
    let own = test.values[line].norm_sqr();
    if square > own {
        square * variance / own
    } else {
        variance
    }
}

pub(super) fn freedom_at(test: &FrequencyResponse, line: usize) -> f64 {
    let freedom = test.degrees_of_freedom.as_ref();
    freedom.map_or(f64::INFINITY, |freedom| freedom[line])
}

pub(super) fn common_error_at(test: &FrequencyResponse, line: usize) -> f64 {
    test.common_error.as_ref().map_or(0.0, |error| error[line])
}
