//! Measurements during the recovery from one load.

use super::LoadHistory;
use crate::error::{
    CmodError, check_enough_readings, check_not_negative, check_positive, check_values,
};

/// Readings of the change Δtan δ = tan δ - tan δ₀ of the loss factor; one entry per reading in
/// every array.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LossFactorReadings<'a> {
    /// Times after unloading \[s\], increasing.
    pub time: &'a [f64],
    /// Changes Δtan δ.
    pub change: &'a [f64],
    /// Standard error of each tan δ, independent from reading to reading.
    pub standard_error: &'a [f64],
    /// Standard error of the virgin tan δ₀, which was measured once: its error is common to all
    /// readings, including the readings of other tests in the same fit. Set it to 0 if it is
    /// negligible.
    pub virgin_standard_error: f64,
}

/// Recovery test: the load, and the loss factor at one frequency after the load (paper C, Table 1
/// and Figure 2).
#[derive(Debug, Clone, PartialEq)]
pub struct RecoveryTest {
    pub(super) name: String,
    pub(super) load: LoadHistory,
    pub(super) frequency_hz: f64,
    pub(super) time: Vec<f64>,
    pub(super) change: Vec<f64>,
    pub(super) standard_error: Vec<f64>,
    pub(super) virgin_standard_error: f64,
}

impl RecoveryTest {
    /// Creates a test called `name`, with `readings` at `frequency_hz` \[Hz\] after `load`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a frequency that is not above 0, a negative error of the
    /// virgin loss factor, or a load without stress; [`CmodError::ReadingCount`] for unequal
    /// lengths; [`CmodError::TooFewReadings`] without readings; [`CmodError::Reading`] for times
    /// that are negative or do not increase, changes that are not finite, or errors that are not
    /// above 0.
    pub fn new(
        name: impl Into<String>,
        load: LoadHistory,
        frequency_hz: f64,
        readings: LossFactorReadings<'_>,
    ) -> Result<Self, CmodError> {
        let name = name.into();
        check_positive("frequency [Hz]", frequency_hz)?;
        check_positive("largest stress of the load [Pa]", load.largest_stress())?;
        check_positive("duration of the load [s]", load.duration())?;
        let LossFactorReadings {
            time,
            change,
            standard_error,
            virgin_standard_error,
        } = readings;
        check_not_negative(
            "standard error of the virgin loss factor",
            virgin_standard_error,
        )?;
        for (array, found) in [
            ("change of the loss factor", change.len()),
            ("standard error", standard_error.len()),
        ] {
            check_values(array, found, time.len(), "time")?;
        }
        check_enough_readings(time.len(), 1)?;
        let wrong = |quantity, index, value, expected| CmodError::Reading {
            test: name.clone(),
            quantity,
            index,
            value,
            expected,
        };
        let mut previous = None;
        for (index, ((&t, &change), &error)) in
            time.iter().zip(change).zip(standard_error).enumerate()
        {
            if !(t.is_finite() && t >= 0.0) {
                let expected = "a finite value, 0 or above";
                return Err(wrong("recovery time [s]", index, t, expected));
            }
            if previous.is_some_and(|previous| t <= previous) {
                let expected = "more than that of the previous reading";
                return Err(wrong("recovery time [s]", index, t, expected));
            }
            if !change.is_finite() {
                let expected = "a finite value";
                return Err(wrong("change of the loss factor", index, change, expected));
            }
            if !(error.is_finite() && error > 0.0) {
                let expected = "a finite value above 0";
                return Err(wrong("standard error", index, error, expected));
            }
            previous = Some(t);
        }
        Ok(Self {
            name,
            load,
            frequency_hz,
            time: time.to_vec(),
            change: change.to_vec(),
            standard_error: standard_error.to_vec(),
            virgin_standard_error,
        })
    }

    /// Returns the name of the test.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the load before the recovery.
    #[must_use]
    pub fn load(&self) -> &LoadHistory {
        &self.load
    }

    /// Returns the frequency of the loss factor \[Hz\].
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        self.frequency_hz
    }

    /// Returns the times after unloading \[s\].
    #[must_use]
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Returns the changes of the loss factor.
    #[must_use]
    pub fn change(&self) -> &[f64] {
        &self.change
    }
}

/// Converts values of all readings of `tests` (a residual, or its derivatives), test after test, to
/// uncorrelated values of unit variance.
///
/// The virgin loss factor was measured once, so its error is the same for all readings of all
/// tests. The covariance of the independent errors σᵢ and this common error is D (I + a aᵀ) D with
/// D = diag σᵢ, aᵢ = σ₀/σᵢ. The function applies (I + a aᵀ)^(-1/2) D⁻¹ in closed form.
pub(super) fn whiten(tests: &[RecoveryTest], values: &mut [f64]) {
    let errors = || {
        tests.iter().flat_map(|test| {
            let of_reading = |sigma: &f64| (*sigma, test.virgin_standard_error / sigma);
            test.standard_error.iter().map(of_reading)
        })
    };
    let mut projection = 0.0;
    let mut square = 0.0;
    for (value, (sigma, a)) in values.iter_mut().zip(errors()) {
        *value /= sigma;
        projection += a * *value;
        square += a * a;
    }
    if square > 0.0 {
        // (1 - 1/√(1+a²))/a², written without the difference
        let root = (1.0 + square).sqrt();
        let factor = projection / (root * (1.0 + root));
        for (value, (_, a)) in values.iter_mut().zip(errors()) {
            *value -= factor * a;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings<'a>(
        time: &'a [f64],
        change: &'a [f64],
        error: &'a [f64],
    ) -> LossFactorReadings<'a> {
        LossFactorReadings {
            time,
            change,
            standard_error: error,
            virgin_standard_error: 2e-3,
        }
    }

    fn test(readings: LossFactorReadings<'_>) -> Result<RecoveryTest, CmodError> {
        let load = LoadHistory::creep(32e6, 1800.0).unwrap();
        RecoveryTest::new("Test 2", load, 10e3, readings)
    }

    /// Checks Wᵀ C W = I over the readings of two tests, column by column. C contains the
    /// independent errors of the readings and, for any two readings, the variance of the virgin
    /// loss factor.
    #[test]
    fn r12_whitened_errors_of_all_tests_are_independent_and_of_unit_variance() {
        let sigma = [1e-3, 2e-3, 5e-4, 3e-3, 8e-4];
        let first = test(readings(&[1.0, 2.0, 3.0], &[0.0; 3], &sigma[..3])).unwrap();
        let second = test(readings(&[1.0, 5.0], &[0.0; 2], &sigma[3..])).unwrap();
        let tests = [first, second];
        let whitener: Vec<[f64; 5]> = (0..5)
            .map(|j| {
                let mut column = [0.0; 5];
                column[j] = 1.0;
                whiten(&tests, &mut column);
                column
            })
            .collect();
        let covariance = |i: usize, j: usize| 4e-6 + if i == j { sigma[i] * sigma[i] } else { 0.0 };
        for p in 0..5 {
            for q in 0..5 {
                let mut sum = 0.0;
                for i in 0..5 {
                    for j in 0..5 {
                        sum += whitener[i][p] * covariance(i, j) * whitener[j][q];
                    }
                }
                let expected = if p == q { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-12, "{p} {q}: {sum}");
            }
        }
    }

    #[test]
    fn impossible_readings_are_refused() {
        let text = |readings| test(readings).unwrap_err().to_string();
        let one = [1e-3; 2];
        assert_eq!(
            text(readings(&[1.0, 2.0], &[0.1], &one)),
            "change of the loss factor has 1 values, expected 2, one per time"
        );
        assert_eq!(
            text(readings(&[], &[], &[])),
            "0 data points, expected at least 1"
        );
        assert_eq!(
            text(readings(&[1.0, 1.0], &one, &one)),
            "recovery time [s] of reading 1 of Test 2 is 1, expected more than that of the previous reading"
        );
        assert_eq!(
            text(readings(&[-1.0, 1.0], &one, &one)),
            "recovery time [s] of reading 0 of Test 2 is -1, expected a finite value, 0 or above"
        );
        assert_eq!(
            text(readings(&[1.0, 2.0], &[0.1, f64::NAN], &one)),
            "change of the loss factor of reading 1 of Test 2 is NaN, expected a finite value"
        );
        assert_eq!(
            text(readings(&[1.0, 2.0], &one, &[0.0, 1.0])),
            "standard error of reading 0 of Test 2 is 0, expected a finite value above 0"
        );
        let unloaded = RecoveryTest::new(
            "rest",
            LoadHistory::creep(0.0, 1.0).unwrap(),
            10e3,
            readings(&[1.0, 2.0], &one, &one),
        );
        assert_eq!(
            unloaded.unwrap_err().to_string(),
            "largest stress of the load [Pa] is 0, expected a finite value above 0"
        );
    }
}
