//! Fitted law with its errors, in a form in which later calculations can propagate the errors.

use super::fit::RheologicalFit;
use super::law::FittedLaw;
use crate::error::{CmodError, check_finite};
use crate::vectors::{dot, length, subtract};

/// Part of the error of a law that is independent of all other parts, with the size of one standard
/// uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct LawError {
    /// Source, such as `noise 1` or `density`.
    pub source: String,
    /// Changes of the parameters on their [scales](super::Scale), in the order of the parameters.
    pub shift: Vec<f64>,
}

/// Law with independent errors of its parameters.
///
/// The covariance of the parameters of a [`RheologicalFit`] is $`\sum_k e_k e_k^T`$: the vectors
/// $`e_k`$ are the axes of the random errors, and one vector for each common source. With standard
/// normal numbers $`z_k`$ the parameters $`p + \sum_k z_k e_k`$ are a random draw of the law.
/// Setting one $`z_k = \pm 1`$ at a time gives the effect of each source on any quantity computed
/// from the law.
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
    /// True for each parameter on which the modulus depends linearly.
    is_linear: Vec<bool>,
    errors: Vec<LawError>,
}

/// Smallest factor by which a modulus or a viscosity is multiplied.
const LEAST_FACTOR: f64 = 1e-3;

/// Lengths, on the scales of the parameters, that are tried in turn as the limit of the change of
/// the parameters due to a common error; the first that reproduces enough of the effect of the
/// error ([`Held::is_enough`]) is used. A law is nearly linear over the first length, but not
/// always over the second: for a series with weakly determined branches, fitted to lines with an
/// error of 0.03 % and a lateral inertia of 0.2 %, the second length doubles the error of a
/// computed impact force. The shifts of a master curve need the third length.
const REACHES: [f64; 3] = [0.3, 1.0, 3.0];

/// Largest fraction of the effect of a common error that a change of the parameters may fail to
/// reproduce.
const MOST_LOST: f64 = 0.5;

/// Part of the effect of a common error that a change may always fail to reproduce, in standard
/// errors of all data together.
const LEAST_LOST: f64 = 1.0;

/// Change of the parameters along the axes of their errors that reproduces the effect of a common
/// error as well as the limited length allows.
struct Held {
    change: Vec<f64>,
    /// Effect of the error on the data, in standard errors of all data together.
    effect: f64,
    /// Part of the effect that the change does not reproduce, in the same unit.
    lost: f64,
}

impl Held {
    /// Returns the shortest change that reproduces enough of the effect of the `wanted` change, or
    /// the longest change if none does. `signals` contains the signal-to-noise ratios S of the
    /// axes.
    fn of(wanted: &[f64], signals: &[f64]) -> Self {
        let [shorter @ .., longest] = REACHES;
        let tried = shorter.into_iter();
        let mut tried = tried.map(|reach| Self::within(reach, wanted, signals));
        tried
            .find(Self::is_enough)
            .unwrap_or_else(|| Self::within(longest, wanted, signals))
    }

    fn is_enough(&self) -> bool {
        self.lost <= LEAST_LOST.max(MOST_LOST * self.effect)
    }

    /// Minimises |S (x - `wanted`)|² + μ |x|² over x, with the smallest μ >= 0 for which |x| is at
    /// most `reach`.
    fn within(reach: f64, wanted: &[f64], signals: &[f64]) -> Self {
        let held = |factor: f64| -> Vec<f64> {
            let pairs = wanted.iter().zip(signals);
            pairs
                .map(|(wanted, s)| wanted * s * s / (s * s + factor).max(f64::MIN_POSITIVE))
                .collect()
        };
        let mut change = held(0.0);
        if length(&change) > reach {
            let largest = signals.iter().fold(0.0_f64, |a, s| a.max(*s)).powi(2);
            let mut high = largest * length(wanted) / reach;
            let mut low = 1e-20 * high;
            for _ in 0..60 {
                let middle = (low * high).sqrt();
                if length(&held(middle)) > reach {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            change = held(high);
        }
        let square = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            let each = wanted.iter().zip(&change).zip(signals);
            let parts = each.map(|((wanted, x), s)| (of(*wanted, *x) * s).powi(2));
            parts.sum::<f64>().sqrt()
        };
        Self {
            effect: square(&|wanted, _| wanted),
            lost: square(&|wanted, x| wanted - x),
            change,
        }
    }
}

impl MeasuredLaw {
    /// Creates the law of `fit` with the axes of its random errors and its common errors.
    ///
    /// An axis that the data determine poorly is limited by a prior, whose standard deviation is 1
    /// on the scales of the parameters: for a logarithm, a factor of e. If s is the signal-to-noise
    /// ratio of the axis, the standard uncertainty along the axis is 1/√(1 + s²) instead of 1/s; it
    /// is 1 if the data do not determine the axis at all. A common error is represented by a short
    /// change of the parameters that reproduces at least half of the effect of the error on the
    /// data, or all but one standard error of all data together.
    ///
    /// # Errors
    ///
    /// [`CmodError::CardUndetermined`] if a change of length 3 on the scales of the parameters
    /// fails to reproduce more than half of the effect of a common error, and more than one
    /// standard error of all data together.
    pub fn of(fit: &RheologicalFit) -> Result<Self, CmodError> {
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
            let along = |(_, direction): (&f64, &Vec<f64>)| dot(direction, &error.shift);
            let wanted: Vec<f64> = axes().map(along).collect();
            let held = Held::of(&wanted, &signals);
            if !held.is_enough() {
                return Err(CmodError::CardUndetermined {
                    what: "the change of the parameters due to a common error",
                    value: held.lost / held.effect,
                    expected: "at most 0.5, the fraction of the effect of the error that a change by up to 3 does not reproduce",
                });
            }
            let mut shift = vec![0.0; error.shift.len()];
            for (change, direction) in held.change.iter().zip(&fit.directions) {
                subtract(&mut shift, -change, direction);
            }
            common.push(LawError {
                source: error.source.to_string(),
                shift,
            });
        }
        let whole = fit.law.model()?;
        // some parameters may have been held constant in the fit
        let of_all = |error: LawError| {
            let shift = whole.kinds().iter().map(|kind| {
                let mut own = fit.parameters.iter().zip(&error.shift);
                let own = own.find(|(parameter, _)| parameter.name == kind.name);
                own.map_or(0.0, |(_, change)| *change)
            });
            LawError {
                shift: shift.collect(),
                source: error.source,
            }
        };
        let errors = random.chain(common).map(of_all).collect();
        Self::new(fit.law.clone(), errors)
    }

    /// Creates a measured law from a law and its independent errors.
    ///
    /// # Errors
    ///
    /// [`CmodError::ChangedResult`] for an error without one change per parameter,
    /// [`CmodError::NonPhysical`] for a change that is not finite.
    pub fn new(law: FittedLaw, errors: Vec<LawError>) -> Result<Self, CmodError> {
        let coordinates = law.coordinates();
        for error in &errors {
            if error.shift.len() != coordinates.len() {
                return Err(CmodError::ChangedResult {
                    what: "changes of the parameters by an error of a law",
                    found: error.shift.len(),
                    expected: coordinates.len(),
                });
            }
            for change in &error.shift {
                check_finite("change of a parameter of a law", *change)?;
            }
        }
        let model = law.model()?;
        let units = model.kinds().iter().map(|kind| kind.unit);
        Ok(Self {
            is_linear: units.map(|unit| unit.starts_with("Pa")).collect(),
            law,
            coordinates,
            errors,
        })
    }

    /// Returns the law.
    #[must_use]
    pub fn law(&self) -> &FittedLaw {
        &self.law
    }

    /// Returns the independent errors of the law.
    #[must_use]
    pub fn errors(&self) -> &[LawError] {
        &self.errors
    }

    /// Returns the law, moved by `standard[k]` standard uncertainties of error k. Errors beyond the
    /// end of the slice are not applied.
    ///
    /// Moduli and viscosities change by fractions of their values, so that changes of branches that
    /// cancel each other cancel for any size of the change. All other parameters change on their
    /// scales.
    ///
    /// # Errors
    ///
    /// [`CmodError`] of the law if its parameters leave their range.
    pub fn moved(&self, standard: &[f64]) -> Result<FittedLaw, CmodError> {
        let mut changes = vec![0.0; self.coordinates.len()];
        for (error, standard) in self.errors.iter().zip(standard) {
            subtract(&mut changes, -standard, &error.shift);
        }
        let each = self.coordinates.iter().zip(&self.is_linear).zip(changes);
        let at: Vec<f64> = each
            .map(|((coordinate, is_linear), change)| {
                coordinate
                    + if *is_linear {
                        (1.0 + change).max(LEAST_FACTOR).ln()
                    } else {
                        change
                    }
            })
            .collect();
        self.law
            .law()
            .at_coordinates(&at, self.law.reference_omega())
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;
    use rodwave::modulus::{ComplexModulus, FractionalZener, GeneralisedMaxwell, MaxwellBranch};

    use super::*;
    use crate::estimate::ErrorSource;
    use crate::rheology::{CommonError, FitOptions, Law, ModulusData, ModulusPoint};

    /// Returns lines with a relative error of 1e-3 and a common error of 2e-3.
    fn points(
        material: &dyn ComplexModulus,
        lowest_hz: f64,
        ratio: f64,
        lines: i32,
    ) -> Vec<ModulusPoint> {
        (0..lines)
            .map(|j| {
                let frequency_hz = lowest_hz * ratio.powi(j);
                let modulus = material.at(std::f64::consts::TAU * frequency_hz);
                let error = Complex64::from_polar(1e-3, 2.4 * f64::from(j * j));
                ModulusPoint::circular(frequency_hz, modulus * (1.0 + error), 1e-3 * modulus.norm())
            })
            .collect()
    }

    fn data() -> ModulusData {
        let material = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
        let points = points(&material, 100.0, 1.12, 40);
        let shift = points.iter().map(|point| 2e-3 * point.modulus).collect();
        ModulusData::new(&points)
            .unwrap()
            .with_common_errors(vec![CommonError {
                source: ErrorSource::Density,
                shift,
            }])
            .unwrap()
    }

    /// Compares the covariance that the fit predicts with the sum of squares of half the
    /// differences due to one error at a time.
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
                    // a small step, because some directions are far from linear at one standard
                    // uncertainty
                    let half = (at(1e-3) - at(-1e-3)) / 2e-3;
                    found[0] += half.re * half.re;
                    found[1] += half.im * half.im;
                }
                let expected = fit.prediction(omega).unwrap().covariance;
                for (part, found) in found.into_iter().enumerate() {
                    let expected = expected[part][part];
                    // the two variances may differ: the prior reduces an error, and only the
                    // prediction includes other orders of a series
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

    /// Fits a polymer with branches over four decades, measured over one and a half decades to 0.1
    /// %, with two common errors: one of the density, and one of the diameter that rises as the
    /// square of the frequency. The branches are weakly determined, because changes of the branches
    /// and of the spring compensate each other.
    #[test]
    fn a_series_with_weakly_determined_branches_is_followed() {
        let branches = (2..6).map(|k| MaxwellBranch {
            modulus: 2e8,
            relaxation_time: 10.0_f64.powi(-k),
        });
        let material = GeneralisedMaxwell::new(2e9, branches.collect()).unwrap();
        let points = points(&material, 500.0, 1.044, 80);
        let of_inertia = |point: &ModulusPoint| {
            let share = 0.01 * (point.frequency_hz / 15e3).powi(2);
            share * point.modulus
        };
        let error = |source, of: &dyn Fn(&ModulusPoint) -> Complex64| CommonError {
            source,
            shift: points.iter().map(of).collect(),
        };
        let common = vec![
            error(ErrorSource::Density, &|point| 5e-3 * point.modulus),
            error(ErrorSource::Diameter, &of_inertia),
        ];
        let data = ModulusData::new(&points).unwrap();
        let data = data.with_common_errors(common).unwrap();
        let fit = RheologicalFit::new(&data, Law::GeneralisedMaxwell, &FitOptions::default());
        let fit = fit.unwrap();
        let weakest = fit.signal_to_noise.last().unwrap() / fit.variance_factor.sqrt();
        assert!(weakest < 10.0, "every branch is determined: {weakest}");
        let measured = MeasuredLaw::of(&fit).unwrap();
        let omega: Vec<f64> = data.omega().to_vec();
        let moved = |k: usize, z: f64| {
            let mut standard = vec![0.0; measured.errors().len()];
            standard[k] = z;
            let law = measured.moved(&standard).unwrap();
            let change = |omega: &f64| {
                let before = measured.law().modulus(*omega);
                (law.modulus(*omega) - before) / before
            };
            omega.iter().map(change).collect::<Vec<Complex64>>()
        };
        let rms = |values: &[Complex64]| {
            let sum: f64 = values.iter().map(Complex64::norm_sqr).sum();
            (sum / values.len() as f64).sqrt()
        };
        for (k, error) in measured.errors().iter().enumerate() {
            let (up, down) = (moved(k, 1.0), moved(k, -1.0));
            let pairs = || up.iter().zip(&down);
            let odd: Vec<Complex64> = pairs().map(|(u, d)| 0.5 * (u - d)).collect();
            let even: Vec<Complex64> = pairs().map(|(u, d)| 0.5 * (u + d)).collect();
            let wanted: Vec<Complex64> = match error.source.as_str() {
                "density" => points.iter().map(|_| Complex64::from(5e-3)).collect(),
                "diameter" => points.iter().map(|p| of_inertia(p) / p.modulus).collect(),
                _ => {
                    // tolerance: below the error of a line, 1e-3
                    assert!(rms(&odd) < 3e-4 && rms(&even) < 1e-4, "{}", error.source);
                    continue;
                }
            };
            let off: Vec<Complex64> = odd.iter().zip(&wanted).map(|(o, w)| o - w).collect();
            // tolerance: a relaxing law reproduces only about half of the error of the diameter, a
            // relative change that rises with frequency without a change of the loss factor
            assert!(
                rms(&off) < 0.6 * rms(&wanted) && rms(&even) < 0.25 * rms(&wanted),
                "{}: {:e} and {:e} of {:e}",
                error.source,
                rms(&off),
                rms(&even),
                rms(&wanted)
            );
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
