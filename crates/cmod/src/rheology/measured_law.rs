//! A fitted law with its errors, in the form in which a later calculation follows them.

use super::fit::RheologicalFit;
use super::law::FittedLaw;
use crate::error::CmodError;

/// Part of the error of a law: independent of all other parts, with one standard uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct LawError {
    /// Source, such as `noise 1` or `density`.
    pub source: String,
    /// Changes of the parameters on their [scales](super::Scale), in their order.
    pub shift: Vec<f64>,
}

/// Law with independent errors of its parameters.
///
/// The covariance of the parameters of a [`RheologicalFit`] is $`\sum_k e_k e_k^T`$: the axes of
/// the random errors, and one vector for each common source. With standard normal numbers $`z_k`$
/// the parameters $`p + \sum_k z_k e_k`$ are a draw of the law; one $`z_k = \pm 1`$ at a time gives
/// the effect of each source on whatever is computed from the law.
///
/// ```
/// use cmod::rheology::{FitOptions, Law, MeasuredLaw, ModulusData, ModulusPoint, RheologicalFit};
/// use num_complex::Complex64;
///
/// let line = |f: f64| ModulusPoint::circular(f, Complex64::new(2.0e9, 0.0), 2e7);
/// let data = ModulusData::new(&[line(100.0), line(200.0)])?;
/// let fit = RheologicalFit::new(&data, Law::Elastic, &FitOptions::default())?;
/// let law = MeasuredLaw::of(&fit)?;
/// // 1 % on each of two real parts
/// let above = law.moved(&[1.0])?.modulus(1.0).re / 2.0e9;
/// assert!((above - 1.01_f64.powf(0.5_f64.sqrt())).abs() < 1e-4 || (above - 0.99_f64.powf(0.5_f64.sqrt())).abs() < 1e-4);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredLaw {
    law: FittedLaw,
    coordinates: Vec<f64>,
    errors: Vec<LawError>,
}

impl MeasuredLaw {
    /// Takes the law of `fit` with the axes of its random errors and its common errors.
    ///
    /// An axis of which the data determine little is held by a prior of one standard deviation of a
    /// factor e for the parameters: with a signal-to-noise ratio s its length is 1/√(1 + s²)
    /// instead of 1/s, and a change c by a common error is c s²/(1 + s²).
    ///
    /// # Errors
    ///
    /// [`CmodError::CardUndetermined`] if a combination of the parameters is undetermined, or a
    /// common error acts on one that is nearly so.
    pub fn of(fit: &RheologicalFit) -> Result<Self, CmodError> {
        if fit.covariance.is_none() {
            let least = fit.signal_to_noise.last().copied();
            return Err(CmodError::CardUndetermined {
                what: "a combination of the parameters",
                value: least.unwrap_or(0.0),
                expected: "a change of the law in standard errors of the data, above 0",
            });
        }
        let size = fit.variance_factor.sqrt();
        let signals: Vec<f64> = fit.signal_to_noise.iter().map(|s| s / size).collect();
        let axes = || signals.iter().zip(&fit.directions);
        let random = axes()
            .enumerate()
            .map(|(at, (signal, direction))| LawError {
                source: format!("noise {}", at + 1),
                shift: direction
                    .iter()
                    .map(|part| part / signal.hypot(1.0))
                    .collect(),
            });
        let mut common = Vec::with_capacity(fit.common_errors.len());
        for error in &fit.common_errors {
            let mut shift = vec![0.0; error.shift.len()];
            for (signal, direction) in axes() {
                let along: f64 = direction.iter().zip(&error.shift).map(|(a, b)| a * b).sum();
                // in standard errors of the data
                let lost = along * signal / (1.0 + signal * signal);
                if lost.abs() > 1.0 {
                    return Err(CmodError::CardUndetermined {
                        what: "the effect of a common error on a combination of the parameters",
                        value: lost.abs(),
                        expected: "at most 1 standard error of the data",
                    });
                }
                let held = along * signal * signal / (1.0 + signal * signal);
                for (sum, part) in shift.iter_mut().zip(direction) {
                    *sum += held * part;
                }
            }
            common.push(LawError {
                source: error.source.to_string(),
                shift,
            });
        }
        let errors = random.chain(common).collect();
        Self::new(fit.law.clone(), errors)
    }

    /// Creates a law with independent errors.
    ///
    /// # Errors
    ///
    /// [`CmodError::ChangedResult`] for an error that has not one change for each parameter,
    /// [`CmodError::NonPhysical`] for a change that is not finite.
    pub fn new(law: FittedLaw, errors: Vec<LawError>) -> Result<Self, CmodError> {
        let coordinates = law.coordinates()?;
        for error in &errors {
            if error.shift.len() != coordinates.len() {
                return Err(CmodError::ChangedResult {
                    what: "changes of the parameters by an error of a law",
                    found: error.shift.len(),
                    expected: coordinates.len(),
                });
            }
            if let Some(value) = error.shift.iter().find(|change| !change.is_finite()) {
                return Err(CmodError::NonPhysical {
                    quantity: "change of a parameter of a law",
                    value: *value,
                    expected: "a finite number",
                });
            }
        }
        Ok(Self {
            law,
            coordinates,
            errors,
        })
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &FittedLaw {
        &self.law
    }

    /// Its independent errors.
    #[must_use]
    pub fn errors(&self) -> &[LawError] {
        &self.errors
    }

    /// The law moved by `standard[k]` standard uncertainties of error k; errors beyond the end of
    /// the slice are not moved.
    ///
    /// # Errors
    ///
    /// [`CmodError`] of the law if its parameters leave their range.
    pub fn moved(&self, standard: &[f64]) -> Result<FittedLaw, CmodError> {
        let mut at = self.coordinates.clone();
        for (error, standard) in self.errors.iter().zip(standard) {
            for (coordinate, change) in at.iter_mut().zip(&error.shift) {
                *coordinate += standard * change;
            }
        }
        self.law
            .law()
            .at_coordinates(&at, self.law.reference_omega())
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;
    use rodwave::modulus::{ComplexModulus, FractionalZener};

    use super::*;
    use crate::estimate::ErrorSource;
    use crate::rheology::{CommonError, FitOptions, Law, ModulusData, ModulusPoint};

    /// Lines with a relative error of 1e-3 and a common error of 2e-3.
    fn data() -> ModulusData {
        let material = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
        let points: Vec<ModulusPoint> = (0..40)
            .map(|j| {
                let frequency_hz = 100.0 * 1.12_f64.powi(j);
                let modulus = material.at(std::f64::consts::TAU * frequency_hz);
                let error = Complex64::from_polar(1e-3, 2.4 * f64::from(j * j));
                ModulusPoint::circular(frequency_hz, modulus * (1.0 + error), 1e-3 * modulus.norm())
            })
            .collect();
        let shift = points.iter().map(|point| 2e-3 * point.modulus).collect();
        ModulusData::new(&points)
            .unwrap()
            .with_common_errors(vec![CommonError {
                source: ErrorSource::Density,
                shift,
            }])
            .unwrap()
    }

    /// Sum of squares of half the differences by one error at a time, against the covariance that
    /// the fit predicts.
    #[test]
    fn independent_errors_have_the_covariance_of_the_prediction() {
        let data = data();
        for law in Law::all(1150.0) {
            let fit = RheologicalFit::new(&data, law, &FitOptions::default()).unwrap();
            let Ok(measured) = MeasuredLaw::of(&fit) else {
                continue;
            };
            let n = measured.errors().len();
            for omega in [1e3, 1e4, 4e4] {
                let mut found = [0.0; 2];
                for k in 0..n {
                    let at = |z: f64| {
                        let mut standard = vec![0.0; n];
                        standard[k] = z;
                        measured.moved(&standard).unwrap().modulus(omega)
                    };
                    // small, for the derivative: some directions are far from linear at one
                    // standard uncertainty
                    let half = (at(1e-3) - at(-1e-3)) / 2e-3;
                    found[0] += half.re * half.re;
                    found[1] += half.im * half.im;
                }
                let expected = fit.prediction(omega).unwrap().covariance;
                for (part, found) in found.into_iter().enumerate() {
                    let expected = expected[part][part];
                    // the prior lessens an error, and other orders of a series are only in the
                    // prediction
                    let least = fit
                        .signal_to_noise
                        .iter()
                        .fold(f64::INFINITY, |a, s| a.min(*s));
                    let least = least / fit.variance_factor.sqrt();
                    let lessened = 1.0 - 1.0 / (1.0 + least * least);
                    let size = 1e-9 * measured.law().modulus(omega).norm();
                    assert!(
                        found <= 1.01 * expected + size * size,
                        "{law} {omega} {part}: {found:e} {expected:e}"
                    );
                    if fit.alternatives.len() <= 1 {
                        assert!(
                            found >= 0.99 * lessened * lessened * expected - size * size,
                            "{law} {omega} {part}: {found:e} {expected:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn parameters_give_the_law_again() {
        let data = data();
        for law in Law::all(1150.0) {
            let fit = RheologicalFit::new(&data, law, &FitOptions::default()).unwrap();
            let values: Vec<f64> = fit.parameters.iter().map(|p| p.value).collect();
            let again = law
                .with_parameters(&values, fit.law.reference_omega())
                .unwrap();
            for omega in [1e2, 1e4, 1e6] {
                let (a, b) = (again.modulus(omega), fit.law.modulus(omega));
                assert!((a - b).norm() <= 1e-12 * b.norm(), "{law}: {a} {b}");
            }
            let refused = law.with_parameters(&values[1..], fit.law.reference_omega());
            let odd = matches!(law, Law::GeneralisedMaxwell) || values.len() == 1;
            assert!(
                odd || matches!(refused, Err(CmodError::ChangedResult { .. })),
                "{refused:?}"
            );
            let mut bad = values.clone();
            bad[0] = f64::NAN;
            assert!(
                law.with_parameters(&bad, fit.law.reference_omega())
                    .is_err()
            );
        }
    }
}
