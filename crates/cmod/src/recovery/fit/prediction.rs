//! Loss factors predicted by the model for a set of tests, with derivatives.
//!
//! The coordinates are ln E₂, the logarithm of the rate k = E₂ B σ_r^m at a reference stress within
//! the loads, and m. B itself is not a coordinate: it is the strain rate of the dashpot at 1 Pa,
//! seven decades below the loads, so the error of ln B is the error of m multiplied by ln σ_r.

use std::f64::consts::TAU;

use super::super::dashpot::Dashpot;
use super::super::least_squares::Linearised;
use super::super::test::whiten;
use super::super::{RecoveryTest, ThreeElementParameters};
use crate::error::CmodError;
use crate::vectors::dot;

/// Point in the space of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coordinates {
    /// Given modulus E₁ \[Pa\].
    pub(super) series_modulus: f64,
    /// Reference stress σ_r \[Pa\].
    pub(super) reference_stress: f64,
    /// Logarithm ln E₂.
    pub(super) log_parallel_modulus: f64,
    /// Logarithm ln k.
    pub(super) log_rate: f64,
    /// Exponent m.
    pub(super) exponent: f64,
}

impl Coordinates {
    pub(super) fn parameters(&self) -> ThreeElementParameters {
        ThreeElementParameters {
            series_modulus: self.series_modulus,
            parallel_modulus: self.log_parallel_modulus.exp(),
            coefficient: self.log_coefficient().exp(),
            exponent: self.exponent,
        }
    }

    pub(super) fn log_coefficient(&self) -> f64 {
        self.log_rate - self.log_parallel_modulus - self.exponent * self.reference_stress.ln()
    }

    pub(super) fn dashpot(&self) -> Dashpot {
        Dashpot {
            rate: self.log_rate.exp(),
            exponent: self.exponent,
            reference_stress: self.reference_stress,
        }
    }
}

/// Predicted Δtan δ of the readings of one test, with derivatives with respect to ln E₂, ln k and
/// m.
pub(super) struct Prediction {
    pub(super) change: Vec<f64>,
    pub(super) derivatives: [Vec<f64>; 3],
    /// Recovery time t_r \[s\].
    pub(super) recovery_time: f64,
}

pub(super) fn predict(test: &RecoveryTest, at: &Coordinates) -> Result<Prediction, CmodError> {
    let pair = at.dashpot();
    let m = at.exponent;
    let spring = test.load.response(&pair)?;
    let (rate, logarithm) = pair.local_rate(spring.value);
    // without a stress the loss factor does not change, whatever the parameters are
    let (rate_by_log_rate, rate_by_exponent) = if spring.value == 0.0 {
        (0.0, 0.0)
    } else {
        (
            1.0 + m * spring.by_log_rate / spring.value,
            logarithm + m * spring.by_exponent / spring.value,
        )
    };
    let amplitude =
        at.series_modulus * (m + 1.0) / (at.log_parallel_modulus.exp() * TAU * test.frequency_hz);
    let count = test.time.len();
    let mut change = Vec::with_capacity(count);
    let mut derivatives = [(); 3].map(|()| Vec::with_capacity(count));
    let [by_modulus, by_rate, by_exponent] = &mut derivatives;
    for t in &test.time {
        let fall = 1.0 + m * rate * t;
        let value = amplitude * rate / fall;
        change.push(value);
        by_modulus.push(-value);
        by_rate.push(value / fall * rate_by_log_rate);
        by_exponent
            .push(value * (1.0 / (m + 1.0) - rate * t / fall) + value / fall * rate_by_exponent);
    }
    Ok(Prediction {
        change,
        derivatives,
        recovery_time: 1.0 / (m * rate),
    })
}

/// Returns the whitened residuals, predicted minus measured, of all `tests`, with their derivatives
/// with respect to ln E₂, ln k and ln m.
pub(super) fn linearise(tests: &[RecoveryTest], at: &Coordinates) -> Result<Linearised, CmodError> {
    let mut residual = Vec::new();
    let mut jacobian: Vec<Vec<f64>> = vec![Vec::new(); 3];
    for test in tests {
        let Prediction {
            change,
            derivatives,
            ..
        } = predict(test, at)?;
        let pairs = change.iter().zip(&test.change);
        residual.extend(pairs.map(|(value, measured)| value - measured));
        for ((column, derivative), scale) in
            jacobian
                .iter_mut()
                .zip(derivatives)
                .zip([1.0, 1.0, at.exponent])
        {
            column.extend(derivative.iter().map(|value| value * scale));
        }
    }
    whiten(tests, &mut residual);
    for column in &mut jacobian {
        whiten(tests, column);
    }
    Ok(Linearised { residual, jacobian })
}

/// Returns the geometric mean of the largest stresses of the loads \[Pa\].
pub(super) fn reference_stress(tests: &[RecoveryTest]) -> f64 {
    let sum: f64 = tests
        .iter()
        .map(|test| test.load.largest_stress().ln())
        .sum();
    (sum / tests.len().max(1) as f64).exp()
}

/// Returns the factor f of the whitened `shape` that fits the whitened `data` best, and the
/// remaining χ².
pub(super) fn scaled(shape: &[f64], data: &[f64]) -> (f64, f64) {
    let factor = dot(shape, data) / dot(shape, shape);
    let left = shape
        .iter()
        .zip(data)
        .map(|(s, d)| (d - factor * s) * (d - factor * s))
        .sum();
    (factor, left)
}

const START_EXPONENTS: [f64; 9] = [0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 4.5, 7.0];

/// Returns the best point of a coarse grid over m and k. E₂ only scales the prediction and
/// therefore follows by linear least squares.
pub(super) fn grid_start(
    tests: &[RecoveryTest],
    series_modulus: f64,
) -> Result<Coordinates, CmodError> {
    let mut data = Vec::new();
    let mut log_duration = 0.0;
    for test in tests {
        data.extend(&test.change);
        log_duration += test.load.duration().ln();
    }
    whiten(tests, &mut data);
    let log_duration = log_duration / tests.len().max(1) as f64;
    let mut best: Option<(f64, Coordinates)> = None;
    let mut shape = Vec::with_capacity(data.len());
    for exponent in START_EXPONENTS {
        let averaged: Vec<RecoveryTest> = tests
            .iter()
            .map(|test| RecoveryTest {
                load: test.load.averaged(exponent),
                ..test.clone()
            })
            .collect();
        for step in -16..=16_i32 {
            let mut at = Coordinates {
                series_modulus,
                reference_stress: reference_stress(tests),
                log_parallel_modulus: 0.0,
                log_rate: f64::from(step) - log_duration,
                exponent,
            };
            shape.clear();
            for test in &averaged {
                shape.extend(predict(test, &at)?.change);
            }
            whiten(&averaged, &mut shape);
            let (factor, left) = scaled(&shape, &data);
            if factor > 0.0 && left.is_finite() && best.is_none_or(|(least, _)| left < least) {
                at.log_parallel_modulus = -factor.ln();
                best = Some((left, at));
            }
        }
    }
    best.map(|(_, at)| at).ok_or(CmodError::NoStart)
}
