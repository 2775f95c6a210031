//! Fit of one test: the two numbers of equation 4.

use std::f64::consts::TAU;
use std::slice::from_ref;

use super::super::dashpot::Dashpot;
use super::super::least_squares::{Ending, Linearised, minimise};
use super::super::test::whiten;
use super::super::{RecoveryTest, ThreeElement, ThreeElementParameters};
use super::prediction::scaled;
use crate::error::{CmodError, check_enough_readings, check_positive};

/// Fit of equation 4 to one test: Δtan δ = Δtan δᵢ/(1 + t/t_r).
///
/// A test determines only the two numbers Δtan δᵢ and t_r; no material model enters except the form
/// of the curve. According to the three-element model, Δtan δᵢ t_r = E₁(m+1)/(E₂ωm) is the same for
/// all loads. This checks the model without a fit of its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct SingleTestFit {
    /// Initial change Δtan δᵢ.
    pub initial_change: f64,
    /// Recovery time t_r \[s\].
    pub recovery_time: f64,
    /// Standard error of ln Δtan δᵢ, from the errors stated with the readings; infinite if not
    /// determined.
    pub initial_change_error: f64,
    /// Standard error of ln t_r; infinite if not determined.
    pub recovery_time_error: f64,
    /// Product Δtan δᵢ t_r \[s\], the value that Δtan δ multiplied by the time approaches at late
    /// times.
    pub tail: f64,
    /// Standard error of the logarithm of the product; infinite if not determined.
    pub tail_error: f64,
    /// χ² of the readings.
    pub chi_squared: f64,
    /// Degrees of freedom of χ²: the number of readings minus 2.
    pub degrees_of_freedom: usize,
    /// Reason why the iteration ended.
    pub ending: Ending,
}

impl SingleTestFit {
    /// Fits equation 4 to `test` by least squares.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer than two readings; [`CmodError::NoStart`] if the
    /// readings show no rise of the loss factor.
    pub fn new(test: &RecoveryTest) -> Result<Self, CmodError> {
        let count = test.time.len();
        check_enough_readings(count, 2)?;
        let shape = |log_time: f64| -> Vec<f64> {
            let mut shape: Vec<f64> = test
                .time
                .iter()
                .map(|t| 1.0 / (1.0 + t / log_time.exp()))
                .collect();
            whiten(from_ref(test), &mut shape);
            shape
        };
        let mut data = test.change.clone();
        whiten(from_ref(test), &mut data);
        let latest = test.time.iter().fold(0.0, |l: f64, t| l.max(*t)).ln();
        let mut best: Option<(f64, [f64; 2])> = None;
        for step in -40..=20_i32 {
            let log_time = latest + 0.25 * f64::from(step);
            let (factor, left) = scaled(&shape(log_time), &data);
            if factor > 0.0 && left.is_finite() && best.is_none_or(|(least, _)| left < least) {
                best = Some((left, [factor.ln(), log_time]));
            }
        }
        let (_, start) = best.ok_or(CmodError::NoStart)?;
        let minimum = minimise(&start, |at| {
            let (change, time) = match *at {
                [change, time] => (change.exp(), time.exp()),
                _ => (f64::NAN, f64::NAN),
            };
            let value = |t: f64| change / (1.0 + t / time);
            let mut residual: Vec<f64> = test
                .time
                .iter()
                .zip(&test.change)
                .map(|(t, measured)| value(*t) - measured)
                .collect();
            let mut by_change: Vec<f64> = test.time.iter().map(|t| value(*t)).collect();
            let mut by_time: Vec<f64> = test
                .time
                .iter()
                .map(|t| value(*t) * t / (t + time))
                .collect();
            for column in [&mut residual, &mut by_change, &mut by_time] {
                whiten(from_ref(test), column);
            }
            Ok::<_, CmodError>(Linearised {
                residual,
                jacobian: vec![by_change, by_time],
            })
        })?
        .ok_or(CmodError::NoStart)?;
        let &[log_change, log_time] = minimum.parameters.as_slice() else {
            return Err(CmodError::NoStart);
        };
        let error = |g: [f64; 2]| minimum.directions.covariance(&g, &g).sqrt();
        Ok(Self {
            initial_change: log_change.exp(),
            recovery_time: log_time.exp(),
            initial_change_error: error([1.0, 0.0]),
            recovery_time_error: error([0.0, 1.0]),
            tail: (log_change + log_time).exp(),
            tail_error: error([1.0, 1.0]),
            chi_squared: minimum.linearised.sum_of_squares(),
            degrees_of_freedom: count - 2,
            ending: minimum.ending,
        })
    }

    /// Returns the parameters with `exponent` m and `series_modulus` E₁ \[Pa\] that give this curve
    /// after the load of `test`.
    ///
    /// There is exactly one pair of E₂ and B for every m; in the words of the paper, an infinite
    /// number of sets of parameter values give identical results.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless `exponent` and `series_modulus` are finite and above 0;
    /// [`CmodError::NoStart`] if no rate gives t_r; [`CmodError::LoadNotIntegrated`].
    pub fn parameters_for(
        &self,
        test: &RecoveryTest,
        exponent: f64,
        series_modulus: f64,
    ) -> Result<ThreeElementParameters, CmodError> {
        let m = check_positive("exponent", exponent)?;
        check_positive("series modulus [Pa]", series_modulus)?;
        let reference_stress = test.load.largest_stress();
        let omega = TAU * test.frequency_hz;
        let parallel_modulus = series_modulus * (m + 1.0) / (self.tail * omega * m);
        // solves t_r = 1/(m λ₀), λ₀ = k |s₀/σ_r|^m, for ln k; ln λ₀ rises with ln k with a slope
        // between 1 and m + 1
        let mut log_rate = -(m * self.recovery_time).ln();
        for _ in 0..100 {
            let pair = Dashpot {
                rate: log_rate.exp(),
                exponent: m,
                reference_stress,
            };
            let spring = test.load.response(&pair)?;
            let (rate, _) = pair.local_rate(spring.value);
            let excess = (m * rate * self.recovery_time).ln();
            let slope = 1.0 + m * spring.by_log_rate / spring.value;
            let step = excess / slope;
            if !step.is_finite() {
                break;
            }
            log_rate -= step;
            if step.abs() < 1e-9 {
                let coefficient =
                    (log_rate - parallel_modulus.ln() - m * reference_stress.ln()).exp();
                let model = ThreeElement::new(ThreeElementParameters {
                    series_modulus,
                    parallel_modulus,
                    coefficient,
                    exponent: m,
                })?;
                return Ok(model.parameters());
            }
        }
        Err(CmodError::NoStart)
    }
}
