//! Joint fit of the model to all tests.

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::super::least_squares::{Ending, Linearised, minimise};
use super::super::{RecoveryTest, ThreeElement};
use super::prediction::{Coordinates, grid_start, linearise, predict};
use super::single::SingleTestFit;
use super::verdict::{Estimate, IDENTIFIED_BELOW, Reason, Scale, Verdict};
use crate::directions::Directions;
use crate::error::{CmodError, check_enough_readings, check_not_negative, check_positive};

/// Modulus of the virgin material, which the loss factors do not determine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesModulus {
    /// Modulus E₁ \[Pa\]: the measured |E| at the frequency of the tests.
    pub value: f64,
    /// Standard error of E₁ \[Pa\].
    pub standard_error: f64,
}

/// Basis of the standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorScale {
    /// The errors stated with the readings.
    #[default]
    Stated,
    /// The residual of the fit; the stated errors are then relative weights and are multiplied by
    /// √(χ²/ν).
    FromResidual,
}

/// Disagreement of the tests of a joint fit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Disagreement {
    /// χ² of the joint fit minus the sum of χ² of the tests alone.
    pub chi_squared: f64,
    /// Degrees of freedom of this difference.
    pub degrees_of_freedom: usize,
    /// Probability of a larger difference if the model describes all tests.
    pub p_value: f64,
}

/// Fit of the parameters of the three-element model to recovery tests, by weighted least squares
/// over all readings.
///
/// The coordinates are ln E₂, ln k and ln m, where k = E₂Bσ_r^m is the rate at the geometric mean
/// σ_r of the largest stresses. The derivatives are exact, the starting point is the best point of
/// a grid, and the iteration is damped least squares. The standard errors are a first-order
/// approximation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct RecoveryFit {
    /// Model at the minimum.
    pub model: ThreeElement,
    /// Reference stress σ_r \[Pa\].
    pub reference_stress: f64,
    /// Estimates of E₁, E₂, B, m and k, in this order.
    pub estimates: [Estimate; 5],
    /// Covariance of (ln E₂, ln B, m), by rows; `None` if a combination of these parameters is
    /// undetermined.
    pub covariance: Option<[[f64; 3]; 3]>,
    /// Singular values of the Jacobian, descending: changes of the predictions along each of the
    /// `directions`, in standard errors of the readings. A value of 0 belongs to a combination of
    /// parameters on which the predictions do not depend.
    pub signal_to_noise: Vec<f64>,
    /// Directions of the singular values: unit vectors in (ln E₂, ln k, ln m), one per value.
    pub directions: Vec<Vec<f64>>,
    /// χ² of the readings.
    pub chi_squared: f64,
    /// Degrees of freedom ν: the number of readings minus the number of singular values above 0.
    pub degrees_of_freedom: usize,
    /// Recovery time t_r \[s\] of each test.
    pub recovery_times: Vec<f64>,
    /// Reason why the iteration ended.
    pub ending: Ending,
}

impl RecoveryFit {
    /// Fits the model to all `tests` together.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer than three readings in all, or if the errors follow
    /// from the residual and there is no degree of freedom; [`CmodError::NonPhysical`] for a
    /// modulus that is not above 0 or whose error is negative; [`CmodError::NoStart`] if the
    /// readings show no rise of the loss factor; [`CmodError::LoadNotIntegrated`].
    pub fn new(
        tests: &[RecoveryTest],
        series_modulus: SeriesModulus,
        error_scale: ErrorScale,
    ) -> Result<Self, CmodError> {
        let e1 = check_positive("series modulus [Pa]", series_modulus.value)?;
        check_not_negative(
            "standard error of the series modulus [Pa]",
            series_modulus.standard_error,
        )?;
        let readings: usize = tests.iter().map(|test| test.time.len()).sum();
        check_enough_readings(readings, 3)?;
        let start = grid_start(tests, e1)?;
        let coordinates = |at: &[f64]| match *at {
            [log_parallel_modulus, log_rate, log_exponent] => Coordinates {
                log_parallel_modulus,
                log_rate,
                exponent: log_exponent.exp(),
                ..start
            },
            _ => start,
        };
        let first = [
            start.log_parallel_modulus,
            start.log_rate,
            start.exponent.ln(),
        ];
        let minimum = minimise(&first, |at| {
            match linearise(tests, &coordinates(at)) {
                // a step to rates that cannot be integrated is rejected
                Err(CmodError::LoadNotIntegrated { .. }) if at != first => {
                    Ok(Linearised::not_finite())
                }
                other => other,
            }
        })?
        .ok_or(CmodError::NoStart)?;
        let at = coordinates(&minimum.parameters);
        let chi_squared = minimum.linearised.sum_of_squares();
        let rank = minimum.directions.rank();
        let degrees_of_freedom = readings.saturating_sub(rank);
        if error_scale == ErrorScale::FromResidual && degrees_of_freedom == 0 {
            return Err(CmodError::TooFewReadings {
                found: readings,
                expected: rank + 1,
            });
        }
        let variance = match error_scale {
            ErrorScale::Stated => 1.0,
            ErrorScale::FromResidual => chi_squared / degrees_of_freedom as f64,
        };
        let mut recovery_times = Vec::with_capacity(tests.len());
        for test in tests {
            recovery_times.push(predict(test, &at)?.recovery_time);
        }
        let errors = Errors::new(
            &minimum.directions,
            &at,
            variance,
            series_modulus.standard_error / e1,
        );
        let reason = errors
            .unidentified()
            .map(|standard_error| reason(tests, &recovery_times, standard_error));
        let model = ThreeElement::new(at.parameters())?;
        Ok(Self {
            model,
            reference_stress: at.reference_stress,
            estimates: errors.estimates(&at, reason),
            covariance: (rank == 3).then_some(errors.of_parameters),
            signal_to_noise: minimum.directions.singular_values,
            directions: minimum.directions.vectors,
            chi_squared,
            degrees_of_freedom,
            recovery_times,
            ending: minimum.ending,
        })
    }

    /// Compares the joint fit with the fits of the tests alone. The difference is χ² of the joint
    /// fit minus the sum of χ² of the `singles`. It has n - p degrees of freedom for the n numbers
    /// that the single tests determine and the p parameters of the model. Returns `None` if the
    /// single tests determine no more numbers than the model has parameters.
    ///
    /// The tests may contradict each other, for example after a wrong stress, although each of them
    /// follows equation 4. The contradiction then hardly changes the probability of χ² of all
    /// readings, which has many more degrees of freedom than the difference.
    #[must_use]
    pub fn disagreement(&self, singles: &[SingleTestFit]) -> Option<Disagreement> {
        let alone: f64 = singles.iter().map(|single| single.chi_squared).sum();
        let freedom: usize = singles.iter().map(|single| single.degrees_of_freedom).sum();
        let degrees_of_freedom = self.degrees_of_freedom.checked_sub(freedom)?;
        let chi_squared = (self.chi_squared - alone).max(0.0);
        let law = ChiSquared::new(degrees_of_freedom as f64).ok()?;
        Some(Disagreement {
            chi_squared,
            degrees_of_freedom,
            p_value: law.sf(chi_squared),
        })
    }

    /// Returns the predicted Δtan δ with its standard error at the times of `test`, which need not
    /// be one of the fitted tests. The error is infinite where the fitted tests do not determine
    /// the prediction.
    ///
    /// # Errors
    /// [`CmodError::LoadNotIntegrated`].
    pub fn prediction(&self, test: &RecoveryTest) -> Result<Vec<PredictedChange>, CmodError> {
        let parameters = self.model.parameters();
        let log_parallel_modulus = parameters.parallel_modulus.ln();
        let at = Coordinates {
            series_modulus: parameters.series_modulus,
            reference_stress: self.reference_stress,
            log_parallel_modulus,
            log_rate: self.estimates[4].value.ln(),
            exponent: parameters.exponent,
        };
        let predicted = predict(test, &at)?;
        let [by_modulus, by_rate, by_exponent] = &predicted.derivatives;
        Ok(predicted
            .change
            .iter()
            .zip(by_modulus)
            .zip(by_rate.iter().zip(by_exponent))
            .map(|((change, a), (b, c))| {
                let gradient = [*a, *b, c * at.exponent];
                let variance: f64 = self
                    .signal_to_noise
                    .iter()
                    .zip(&self.directions)
                    .map(|(s, vector)| {
                        let along: f64 = vector.iter().zip(gradient).map(|(v, g)| v * g).sum();
                        if *s > 0.0 {
                            (along / s).powi(2)
                        } else if along.abs() <= 1e-6 * change.abs() {
                            0.0
                        } else {
                            f64::INFINITY
                        }
                    })
                    .sum();
                PredictedChange {
                    change: *change,
                    standard_error: variance.sqrt(),
                }
            })
            .collect())
    }
}

/// Predicted change of the loss factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedChange {
    /// Predicted change Δtan δ.
    pub change: f64,
    /// Standard error, from the errors stated with the readings; infinite if undetermined.
    pub standard_error: f64,
}

/// Standard errors of the coordinates and of the derived parameters.
struct Errors {
    parallel_modulus: f64,
    rate: f64,
    exponent: f64,
    series_modulus: f64,
    /// Covariance of (ln E₂, ln B, m).
    of_parameters: [[f64; 3]; 3],
}

impl Errors {
    fn new(directions: &Directions, at: &Coordinates, variance: f64, series_modulus: f64) -> Self {
        let m = at.exponent;
        let log_stress = at.reference_stress.ln();
        // gradients in (ln E₂, ln k, ln m); ln B = ln k - ln E₂ - m ln σ_r. The second entry is the
        // effect of the error of E₁: E₂ is proportional to E₁, and B is inversely proportional.
        let gradients = [
            ([1.0, 0.0, 0.0], series_modulus),
            ([-1.0, 1.0, -m * log_stress], -series_modulus),
            ([0.0, 0.0, m], 0.0),
        ];
        let of_parameters = gradients.map(|(g, g_shared)| {
            gradients
                .map(|(h, h_shared)| variance * directions.covariance(&g, &h) + g_shared * h_shared)
        });
        let rate = [0.0, 1.0, 0.0];
        let [[of_parallel_modulus, ..], _, [.., of_exponent]] = of_parameters;
        Self {
            parallel_modulus: of_parallel_modulus.sqrt(),
            rate: (variance * directions.covariance(&rate, &rate)).sqrt(),
            exponent: of_exponent.sqrt(),
            series_modulus,
            of_parameters,
        }
    }

    /// Returns the largest standard error if a parameter is not identified; otherwise `None`.
    fn unidentified(&self) -> Option<f64> {
        let errors = [self.parallel_modulus, self.rate, self.exponent];
        // a comparison with NaN is false: an unknown error counts as not identified
        let identified = errors.iter().all(|error| *error < IDENTIFIED_BELOW);
        (!identified).then(|| errors.into_iter().fold(0.0, f64::max))
    }

    fn estimates(&self, at: &Coordinates, reason: Option<Reason>) -> [Estimate; 5] {
        let judged = |standard_error: f64| match reason {
            None => Verdict::Identified,
            Some(_) if standard_error < IDENTIFIED_BELOW => Verdict::Identified,
            Some(reason) => Verdict::NotIdentifiable(reason),
        };
        // the smaller m is, the smaller is its error: without the condition on E2 and k, m would
        // count as identified only where its estimate is too small
        let others = self.parallel_modulus.max(self.rate);
        let exponent = judged(self.exponent.max(others));
        let parameters = at.parameters();
        [
            Estimate {
                name: "series modulus",
                symbol: "E1",
                unit: "Pa",
                value: parameters.series_modulus,
                standard_error: self.series_modulus,
                scale: Scale::Ratio,
                verdict: Verdict::Given,
            },
            Estimate {
                name: "parallel modulus",
                symbol: "E2",
                unit: "Pa",
                value: parameters.parallel_modulus,
                standard_error: self.parallel_modulus,
                scale: Scale::Ratio,
                verdict: judged(self.parallel_modulus),
            },
            Estimate {
                name: "coefficient",
                symbol: "B",
                unit: "Pa^-(m+1) s^-1",
                value: parameters.coefficient,
                standard_error: self.of_parameters[1][1].sqrt(),
                scale: Scale::Ratio,
                verdict: reason.map_or(Verdict::FollowsFromIdentified, Verdict::NotIdentifiable),
            },
            Estimate {
                name: "exponent",
                symbol: "m",
                unit: "1",
                value: parameters.exponent,
                standard_error: self.exponent,
                scale: Scale::Difference,
                verdict: exponent,
            },
            Estimate {
                name: "rate at the reference stress",
                symbol: "k",
                unit: "1/s",
                value: at.log_rate.exp(),
                standard_error: self.rate,
                scale: Scale::Ratio,
                verdict: judged(self.rate),
            },
        ]
    }
}

fn reason(tests: &[RecoveryTest], recovery_times: &[f64], standard_error: f64) -> Reason {
    let one_load = tests
        .windows(2)
        .all(|pair| matches!(pair, [a, b] if a.load == b.load));
    if one_load {
        return Reason::OneLoad;
    }
    let mut earliest = f64::INFINITY;
    let mut latest = 0.0_f64;
    for (test, recovery_time) in tests.iter().zip(recovery_times) {
        for t in &test.time {
            earliest = earliest.min(t / recovery_time);
            latest = latest.max(t / recovery_time);
        }
    }
    if latest < 0.3 {
        Reason::RecoveryNotFollowed { latest }
    } else if earliest > 3.0 {
        Reason::OnlyTail { earliest }
    } else {
        Reason::Noise { standard_error }
    }
}

impl fmt::Display for RecoveryFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "three-element model, chi-squared {:.1} with {} degrees of freedom, reference stress {:.2} MPa",
            self.chi_squared,
            self.degrees_of_freedom,
            1e-6 * self.reference_stress
        )?;
        for estimate in &self.estimates {
            let of = match estimate.scale {
                Scale::Ratio => "ln",
                Scale::Difference => "  ",
            };
            writeln!(
                f,
                "{:<2} = {:<10.4e} {:<15} s.e. {of} {:<7.4} {}",
                estimate.symbol,
                estimate.value,
                estimate.unit,
                estimate.standard_error,
                estimate.verdict
            )?;
        }
        write!(f, "signal to noise")?;
        for value in &self.signal_to_noise {
            write!(f, " {value:.3e}")?;
        }
        Ok(())
    }
}
