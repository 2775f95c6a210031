//! Tests of the residuals of a law for whiteness.

use std::fmt;
use std::ops::Range;

use statrs::distribution::{ContinuousCDF, Normal};

use super::count;
use super::transient::Reading;

/// Two tests of the whitened residuals in order of frequency: a test of their signs, and a test of
/// the correlation between neighbours.
///
/// A law that does not describe the material leaves residuals that keep their sign over many lines.
/// χ² detects this only if the stated errors are right; these two tests do not use the size of the
/// errors. Both use the residuals of E' and E'' together. They are one-sided: they detect too few
/// runs and a positive correlation.
///
/// # Validity
/// The tests are asymptotic: they apply to some twenty residuals or more, with errors that are
/// independent from line to line. The fitted parameters reduce the correlation slightly, so the
/// probabilities are slightly too large.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Whiteness {
    /// Number of runs, that is, of sequences of residuals with the same sign.
    pub runs: usize,
    /// Expected number of runs for independent residuals (Wald & Wolfowitz, *Ann. Math. Stat.*
    /// **11** (1940) 147).
    pub expected_runs: f64,
    /// Probability of at most this number of runs, for independent residuals.
    pub runs_p_value: f64,
    /// Correlation coefficient of neighbouring residuals.
    pub autocorrelation: f64,
    /// Probability of at least this coefficient, for independent residuals.
    pub autocorrelation_p_value: f64,
}

impl Whiteness {
    /// Tests `residual`, which has two entries per line; the second entry is only used for data
    /// over frequency. Lines are neighbours only within one of the `sequences`.
    pub(super) fn of(residual: &[f64], readings: &[Reading], sequences: &[Range<usize>]) -> Self {
        let mut runs = 0;
        let (mut expected, mut variance) = (0.0, 0.0);
        let (mut products, mut squares, mut pairs) = (0.0, 0.0, 0);
        for sequence in sequences {
            for part in 0..2 {
                let values: Vec<f64> = sequence
                    .clone()
                    .filter(|line| part == 0 || !readings.get(*line).is_some_and(Reading::is_real))
                    .filter_map(|line| residual.get(2 * line + part).copied())
                    .collect();
                if values.is_empty() {
                    continue;
                }
                let n = count(values.len());
                let positive = count(values.iter().filter(|r| **r > 0.0).count());
                let mean = 2.0 * positive * (n - positive) / n + 1.0;
                let changes = values
                    .windows(2)
                    .filter(|pair| matches!(pair, [a, b] if (*a > 0.0) != (*b > 0.0)))
                    .count();
                runs += changes + 1;
                expected += mean;
                if n > 1.0 {
                    variance += (mean - 1.0) * (mean - 2.0) / (n - 1.0);
                }
                for pair in values.windows(2) {
                    if let [a, b] = pair {
                        products += a * b;
                        pairs += 1;
                    }
                }
                squares += values.iter().map(|r| r * r).sum::<f64>();
            }
        }
        let standard = Normal::standard();
        // the addition of half a run is the continuity correction of the normal approximation
        let runs_p_value = if variance > 0.0 {
            standard.cdf((count(runs) + 0.5 - expected) / variance.sqrt())
        } else {
            1.0
        };
        let autocorrelation = if squares > 0.0 {
            products / squares
        } else {
            0.0
        };
        Self {
            runs,
            expected_runs: expected,
            runs_p_value,
            autocorrelation,
            autocorrelation_p_value: standard.sf(autocorrelation * count(pairs).sqrt()),
        }
    }

    /// Returns true if neither test rejects the residuals as white. `significance` is the maximum
    /// probability that at least one of the two tests wrongly rejects white residuals (Bonferroni).
    #[must_use]
    pub fn is_white(&self, significance: f64) -> bool {
        self.runs_p_value.min(self.autocorrelation_p_value) >= 0.5 * significance
    }
}

impl fmt::Display for Whiteness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} runs, {:.0} expected (p = {:.2e}), correlation of neighbours {:.2} (p = {:.2e})",
            self.runs,
            self.expected_runs,
            self.runs_p_value,
            self.autocorrelation,
            self.autocorrelation_p_value
        )
    }
}
