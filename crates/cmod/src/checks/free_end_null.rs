//! Check that no force acts at the free end except that of its mass.

mod common_errors;

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::{Check, CheckOutcome, check_level, chi_square_tail, fisher_tail};
use crate::error::{CmodError, check_positive, check_that};
use crate::estimate::VarianceFreedom;
use crate::free_end::{FreeEndShape, RodWithFreeEnd};
use crate::multi_point::{GaugeSpectra, GaugeUncertainty, Quantity};
use common_errors::{CommonErrors, NormalEquations};

/// Maximum number of Gauss-Newton steps per line.
const MOST_STEPS: u32 = 60;
/// Degrees of freedom of the noise of a line at or below which a ratio to this noise has no finite
/// variance.
const FEWEST_DEGREES_OF_FREEDOM: f64 = 4.0;
/// Smallest fraction of a Gauss-Newton step that is tried.
const SMALLEST_FRACTION: f64 = 1e-6;
/// Maximum number of Gauss-Newton steps of the common errors.
const MOST_ROUNDS: usize = 8;
/// Decrease of χ² over all lines by a step of the common errors, below which the errors count as
/// converged.
const LEAST_FALL: f64 = 0.1;

/// Free-end null check: three or more sections must agree on one motion of the free end and one γ.
///
/// Beyond the free end of a rod there is no force except that of its mass m. At the distance d from
/// the end every measured quantity is therefore an amplitude c times a known function of γ,
///
/// ```text
/// b_j = c f(γd_j) ,    f = sinh γd + lγ cosh γd (strain) or cosh γd + lγ sinh γd (motion) ,    l = m/(ρA)
/// ```
///
/// A support, a crack or a wrongly placed or calibrated sensor adds a second wave. On each line, γ
/// and one c per test are fitted, and χ² = 2Σ|b - cf|²/σ² has 2(M(n - 1) - 1) degrees of freedom
/// for M tests with n sections. The statistic is the sum over all lines divided by the sum of their
/// degrees of freedom; noise alone gives 1. With stated uncertainties, the errors of positions,
/// sensitivities, delays and end mass, which are common to all lines, are fitted as well: their
/// squares in standard deviations are added to the sum, whose degrees of freedom stay the same.
///
/// Two sections always agree on some γ, whatever their errors, so at least three are needed. A rod
/// whose waves are not one-dimensional, because of bending or of lateral inertia that changes the
/// shape of the waves near the end, fails as well.
///
/// ```
/// use cmod::checks::{FreeEndNull, USUAL_LEVEL};
/// use cmod::multi_point::{GaugeSpectra, Quantity};
/// use cmod::RodWithFreeEnd;
/// use num_complex::Complex64;
///
/// let rod = RodWithFreeEnd { diameter: 0.0106, density: 903.0, end_mass: 0.0 };
/// let frequency_hz: Vec<f64> = (1..=50).map(|j| 100.0 * f64::from(j)).collect();
/// let gamma: Vec<Complex64> =
///     frequency_hz.iter().map(|f| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0)).collect();
/// // the third gauge is 10 mm from its stated position
/// let at = |d: f64| gamma.iter().map(|gamma| (gamma * d).sinh()).collect::<Vec<_>>();
/// let spectra = [at(0.1), at(0.25), at(0.41)];
/// let outcome = FreeEndNull::new(rod, vec![0.1, 0.25, 0.40], Quantity::Strain)?.check(
///     &GaugeSpectra { frequency_hz: &frequency_hz, tests: &[&spectra], noise: &vec![vec![1e-3; 50]; 3] },
///     &gamma,
///     USUAL_LEVEL,
/// )?;
/// assert!(outcome.has_failed());
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FreeEndNull {
    rod: RodWithFreeEnd,
    distances: Vec<f64>,
    quantity: Quantity,
    /// Degrees of freedom of the noise of one sensor, if it was measured.
    noise_freedom: Option<VarianceFreedom>,
    uncertainty: GaugeUncertainty,
}

/// Result of the fits of all lines.
struct Fitted {
    chi_square: f64,
    n_lines: usize,
    worst: Option<usize>,
    equations: NormalEquations,
}

impl FreeEndNull {
    /// Creates the check for sensors of one `quantity` at these `distances` \[m\] from the free
    /// end, in any order.
    ///
    /// # Errors
    /// [`CmodError::GaugeCount`] for fewer than three distances, [`CmodError::NonPhysical`] for the
    /// rod and for a distance that is not finite and above 0.
    pub fn new(
        rod: RodWithFreeEnd,
        distances: Vec<f64>,
        quantity: Quantity,
    ) -> Result<Self, CmodError> {
        rod.check()?;
        if distances.len() < 3 {
            return Err(CmodError::GaugeCount {
                found: distances.len(),
                expected: "3 or more",
            });
        }
        for &distance in &distances {
            check_positive("distance from the free end [m]", distance)?;
        }
        Ok(Self {
            rod,
            distances,
            quantity,
            noise_freedom: None,
            uncertainty: GaugeUncertainty::default(),
        })
    }

    /// Sets the uncertainties of positions, sensitivities, delays, free end and end mass. If
    /// a quantity is stated as exact, an error of this quantity makes the check fail.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] and [`CmodError::GaugeCount`] as for
    /// [`MultiPoint::with_uncertainty`](crate::MultiPoint::with_uncertainty).
    pub fn with_uncertainty(mut self, uncertainty: GaugeUncertainty) -> Result<Self, CmodError> {
        self.uncertainty = uncertainty.check(self.distances.len(), true)?;
        Ok(self)
    }

    /// Sets the degrees of freedom of a measured noise, per sensor and line.
    ///
    /// The ratio to an estimated noise power of ν degrees of freedom is on average ν/(ν - 2) times
    /// the ratio to the true noise power. The statistic is divided by this factor and compared with
    /// Fisher's distribution instead of chi-square, with the degrees of freedom of all sensors and
    /// lines together in the denominator. With chi-square, every record of some thousand lines
    /// would fail if its noise had an error of some per cent.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless a line has more than 4 degrees of freedom; with 4 or
    /// fewer, such ratios have no finite variance.
    pub fn with_noise_freedom(mut self, freedom: VarianceFreedom) -> Result<Self, CmodError> {
        let freedom = freedom.check()?;
        let is_enough = freedom.line > FEWEST_DEGREES_OF_FREEDOM;
        let quantity = "degrees of freedom of the noise of a line";
        let expected = "more than 4: use a longer silence or more hits";
        check_that(is_enough, quantity, freedom.line, expected)?;
        self.noise_freedom = Some(freedom);
        Ok(self)
    }

    /// Checks `spectra`, one row per distance, with the probability `level` of a false alarm. The
    /// fit on each line starts from the `propagation_coefficient` γ [1/m], which may come from any
    /// method. Lines with a non-finite γ or value are skipped.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for the level; for the `spectra` the errors of
    /// [`MultiPoint::estimate`](crate::MultiPoint::estimate); [`CmodError::LengthMismatch`] for γ;
    /// [`CmodError::NoNoise`] if the noise of a sensor is 0; [`CmodError::NoLines`] if no line can
    /// be checked.
    pub fn check(
        &self,
        spectra: &GaugeSpectra<'_>,
        propagation_coefficient: &[Complex64],
        level: f64,
    ) -> Result<CheckOutcome, CmodError> {
        let level = check_level(level)?;
        let n = self.distances.len();
        spectra.check(n)?;
        crate::error::check_length(
            "propagation coefficient",
            propagation_coefficient.len(),
            spectra.frequency_hz.len(),
        )?;
        let freedom = 2 * (spectra.tests.len() * (n - 1) - 1);
        let mut errors = CommonErrors::of(&self.uncertainty, &self.rod);
        let mut fitted = self.fitted(spectra, propagation_coefficient, &errors)?;
        let mut total = fitted.chi_square;
        if errors.count() > 0 {
            for _ in 0..MOST_ROUNDS {
                let improved = errors.improve(&fitted.equations, fitted.chi_square);
                let Some((least, fall)) = improved else { break };
                total = least;
                if fall < LEAST_FALL {
                    break;
                }
                fitted = self.fitted(spectra, propagation_coefficient, &errors)?;
            }
        }
        let count = fitted.n_lines;
        let all = (count * freedom) as f64;
        let (statistic, p_value) = match self.noise_freedom {
            None => (total / all, chi_square_tail(total, all)),
            Some(noise) => {
                let statistic = total / all * (1.0 - 2.0 / noise.line);
                let of_noise = (count * n) as f64 * noise.own;
                // the variance of the ratio is (ν - 2)/(ν - 4) times that with a known noise
                let of_lines = all * (noise.line - 4.0) / (noise.line - 2.0);
                (statistic, fisher_tail(statistic, of_lines, of_noise))
            }
        };
        let outcome = CheckOutcome::judged(Check::FreeEndNull, (statistic, 1.0), p_value, level);
        Ok(outcome.at(fitted.worst))
    }

    /// Fits γ and the amplitudes of all lines with these common errors.
    fn fitted(
        &self,
        spectra: &GaugeSpectra<'_>,
        propagation_coefficient: &[Complex64],
        errors: &CommonErrors,
    ) -> Result<Fitted, CmodError> {
        let mut fit = Fit::new(self, errors, spectra.tests.len());
        let mut fitted = Fitted {
            chi_square: 0.0,
            n_lines: 0,
            worst: None,
            equations: NormalEquations::new(errors.count()),
        };
        let mut largest = 0.0;
        let lines = propagation_coefficient.iter().zip(spectra.frequency_hz);
        for (index, (&gamma, frequency_hz)) in lines.enumerate() {
            if noises(spectra, index).any(|noise| noise == 0.0) {
                return Err(CmodError::NoNoise {
                    what: "noise of a sensor at line",
                    index,
                });
            }
            let omega = TAU * frequency_hz;
            if !gamma.is_finite() || !fit.load(spectra, index, omega) {
                continue;
            }
            let (misfit, gamma) = fit.least_misfit(gamma);
            if errors.count() > 0 {
                fit.add_to(&mut fitted.equations, gamma, omega);
            }
            fitted.chi_square += 2.0 * misfit;
            fitted.n_lines += 1;
            if misfit > largest {
                (largest, fitted.worst) = (misfit, Some(index));
            }
        }
        if fitted.n_lines == 0 {
            return Err(CmodError::NoLines);
        }
        Ok(fitted)
    }
}

/// Returns the noise of all sensors at one line.
#[allow(
    clippy::indexing_slicing,
    reason = "`GaugeSpectra::check` has refused noise of another length"
)]
fn noises(spectra: &GaugeSpectra<'_>, index: usize) -> impl Iterator<Item = f64> {
    spectra.noise.iter().map(move |noise| noise[index])
}

/// Fit of one line to the values of all tests, divided by the noise of each sensor.
struct Fit<'a> {
    errors: &'a CommonErrors,
    shape_of_end: FreeEndShape,
    /// Distances of the sensors from the free end, with their errors \[m\].
    distances: Vec<f64>,
    /// Values of all sensors, (n_tests · n_sensors).
    values: Vec<Complex64>,
    weights: Vec<f64>,
    factors: Vec<Complex64>,
    /// Functions f and f' of each sensor, divided by the noise of the sensor.
    shape: Vec<(Complex64, Complex64)>,
    /// Changes of all values by each common error, without those that γ and the amplitudes explain.
    columns: Vec<Vec<Complex64>>,
    residual: Vec<Complex64>,
}

/// Returns the sum of the conjugates of f times the values of the sensors.
fn along<'v>(
    shape: &[(Complex64, Complex64)],
    values: impl IntoIterator<Item = &'v Complex64>,
) -> Complex64 {
    let pairs = shape.iter().zip(values);
    pairs.map(|((f, _), value)| f.conj() * value).sum()
}

impl<'a> Fit<'a> {
    fn new(check: &FreeEndNull, errors: &'a CommonErrors, n_tests: usize) -> Self {
        let n_sensors = check.distances.len();
        let distances = check.distances.iter().enumerate();
        let distances = distances.map(|(sensor, stated)| errors.distance(sensor, *stated));
        Self {
            errors,
            shape_of_end: FreeEndShape {
                quantity: check.quantity,
                length_of_end_mass: errors.end_length(check.rod.length_of_end_mass()),
            },
            distances: distances.collect(),
            values: Vec::with_capacity(n_sensors * n_tests),
            weights: Vec::with_capacity(n_sensors),
            factors: Vec::with_capacity(n_sensors),
            shape: Vec::with_capacity(n_sensors),
            columns: vec![Vec::with_capacity(n_sensors * n_tests); errors.count()],
            residual: Vec::with_capacity(n_sensors * n_tests),
        }
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`GaugeSpectra::check` has refused spectra of another length"
    )]
    fn load(&mut self, spectra: &GaugeSpectra<'_>, index: usize, omega: f64) -> bool {
        self.weights.clear();
        self.factors.clear();
        for (sensor, noise) in noises(spectra, index).enumerate() {
            let factor = self.errors.factor(sensor, omega);
            // the noise was measured in the same units as the value
            self.weights.push(factor.norm() / noise);
            self.factors.push(factor);
        }
        self.values.clear();
        for test in spectra.tests {
            let sensors = test.iter().zip(&self.weights).zip(&self.factors);
            let values =
                sensors.map(|((spectrum, weight), factor)| weight * spectrum[index] / factor);
            self.values.extend(values);
        }
        self.values.iter().all(|value| value.is_finite())
    }

    /// Returns Σ|b - cf|² at γ, and the Gauss-Newton step from γ.
    fn misfit(&mut self, gamma: Complex64) -> (f64, Complex64) {
        self.shape.clear();
        for (distance, weight) in self.distances.iter().zip(&self.weights) {
            let jet = self.shape_of_end.at(*distance, gamma);
            self.shape.push((weight * jet.value, weight * jet.first));
        }
        let power: f64 = self.shape.iter().map(|(f, _)| f.norm_sqr()).sum();
        let slopes = self.shape.iter().map(|(_, slope)| slope);
        let drift = along(&self.shape, slopes) / power;
        let n = self.shape.len();
        let (mut misfit, mut gradient, mut curvature) = (0.0, Complex64::ZERO, 0.0);
        for test in self.values.chunks_exact(n) {
            let pairs = || self.shape.iter().zip(test);
            let c = along(&self.shape, test) / power;
            for ((f, slope), b) in pairs() {
                let rest = b - c * f;
                // d is the component of f'c that is perpendicular to f
                let d = c * (slope - drift * f);
                misfit += rest.norm_sqr();
                gradient += d.conj() * rest;
                curvature += d.norm_sqr();
            }
        }
        (misfit, gradient / curvature)
    }

    /// Adds the line to the equations of the common errors, linearised about its minimum at γ.
    fn add_to(&mut self, equations: &mut NormalEquations, gamma: Complex64, omega: f64) {
        self.misfit(gamma);
        let n = self.shape.len();
        let power: f64 = self.shape.iter().map(|(f, _)| f.norm_sqr()).sum();
        let slopes = self.shape.iter().map(|(_, slope)| slope);
        let drift = along(&self.shape, slopes) / power;
        self.columns.iter_mut().for_each(Vec::clear);
        self.residual.clear();
        // changes of all values by γ
        let mut by_gamma = Vec::with_capacity(self.values.len());
        for test in self.values.chunks_exact(n) {
            let c = along(&self.shape, test) / power;
            let pairs = self.shape.iter().zip(test);
            self.residual.extend(pairs.map(|((f, _), b)| b - c * f));
            by_gamma.extend(self.shape.iter().map(|(f, slope)| c * (slope - drift * f)));
            for (sensor, (distance, weight)) in self.distances.iter().zip(&self.weights).enumerate()
            {
                let about = (&self.shape_of_end, gamma, omega);
                let changes = self.errors.changes((sensor, *distance), about);
                for (column, change) in self.columns.iter_mut().zip(changes) {
                    column.push(c * weight * change);
                }
            }
        }
        let curvature: f64 = by_gamma.iter().map(Complex64::norm_sqr).sum();
        for column in &mut self.columns {
            for values in column.chunks_exact_mut(n) {
                let amplitude = along(&self.shape, &*values) / power;
                let pairs = values.iter_mut().zip(&self.shape);
                pairs.for_each(|(value, (f, _))| *value -= amplitude * f);
            }
            let pairs = by_gamma.iter().zip(column.iter());
            let share = pairs.map(|(d, value)| d.conj() * value).sum::<Complex64>() / curvature;
            let pairs = column.iter_mut().zip(&by_gamma);
            pairs.for_each(|(value, d)| *value -= share * d);
        }
        equations.add(&self.columns, &self.residual);
    }

    /// Returns the least misfit near `start`, and γ there. Each Gauss-Newton step is halved until
    /// the misfit decreases.
    fn least_misfit(&mut self, start: Complex64) -> (f64, Complex64) {
        let mut gamma = start;
        let (mut best, mut step) = self.misfit(gamma);
        for _ in 0..MOST_STEPS {
            let mut fraction = 1.0;
            let (previous, from) = (best, gamma);
            while fraction > SMALLEST_FRACTION && step.is_finite() {
                let trial = from + fraction * step;
                let (misfit, next) = self.misfit(trial);
                if misfit < best {
                    (best, gamma, step) = (misfit, trial, next);
                    break;
                }
                fraction *= 0.5;
            }
            // a decrease of half of χ² by less than 1e-3 changes no verdict
            if previous - best < 1e-3 {
                break;
            }
        }
        (best, gamma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::noise::Noise;

    fn rod(end_mass: f64) -> RodWithFreeEnd {
        RodWithFreeEnd {
            diameter: 0.0106,
            density: 903.0,
            end_mass,
        }
    }

    fn gamma(frequency_hz: &[f64]) -> Vec<Complex64> {
        let at = |f: &f64| Complex64::new(0.05, 1.0) * (TAU * f / 1700.0);
        frequency_hz.iter().map(at).collect()
    }

    /// Five gauges are each 0.3 to 0.6 mm from their stated positions, with errors of the
    /// sensitivity of 0.5 to 0.9 %. The check fails if positions and sensitivities are stated as
    /// exact. It passes with stated uncertainties of 0.5 mm and 1 %, but fails in spite of them if
    /// one of the gauges is another 8 mm away.
    #[test]
    fn stated_uncertainties_explain_what_they_cover_and_no_more() {
        let rod = rod(1e-3);
        let frequency_hz: Vec<f64> = (4..=160).map(|j| 50.0 * f64::from(j)).collect();
        let gamma = gamma(&frequency_hz);
        let stated = [0.25, 0.31, 0.40, 0.51, 0.55];
        let noise = 1e-3;
        let outcome = |seed: u64, moved: f64, uncertain: bool| {
            let mut random = Noise::seeded(seed);
            let signs = [1.0, -1.0, -1.0, 1.0, -1.0];
            let sensors = stated.iter().zip(signs).enumerate();
            let spectra: Vec<Vec<Complex64>> = sensors
                .map(|(sensor, (d, sign))| {
                    let off = 0.3e-3 + 0.07e-3 * sensor as f64;
                    let d = d + sign * off + if sensor == 2 { moved } else { 0.0 };
                    let gain = 1.0 - sign * (0.005 + 0.001 * sensor as f64);
                    let length = rod.length_of_end_mass();
                    let value = |gamma: &Complex64| {
                        let shape = (gamma * d).sinh() + length * gamma * (gamma * d).cosh();
                        gain * shape + random.circular(noise * noise)
                    };
                    gamma.iter().map(value).collect()
                })
                .collect();
            let measured = GaugeSpectra {
                frequency_hz: &frequency_hz,
                tests: &[&spectra],
                noise: &vec![vec![noise; frequency_hz.len()]; stated.len()],
            };
            let uncertainty = GaugeUncertainty {
                positions: vec![0.5e-3; 5],
                factors: vec![0.01; 5],
                ..GaugeUncertainty::default()
            };
            let check = FreeEndNull::new(rod, stated.to_vec(), Quantity::Strain).unwrap();
            let check = if uncertain {
                check.with_uncertainty(uncertainty).unwrap()
            } else {
                check
            };
            check.check(&measured, &gamma, 0.01).unwrap()
        };
        assert!(outcome(1, 0.0, false).has_failed());
        assert!(outcome(1, 8e-3, true).has_failed());
        // the noise differs from record to record, but the errors of the gauges do not: the sum of
        // their squares, in units of the stated variances, is 6.6 instead of the expected 10, so at
        // most about 1 % of the records fail
        let failures = (0..40).filter(|seed| outcome(*seed, 0.0, true).has_failed());
        assert!(failures.count() <= 2);
    }

    /// The assumed noise is 10 % too small in amplitude. With chi-square over many lines a correct
    /// record fails. With Fisher's distribution for a noise of 100 degrees of freedom in all, whose
    /// power has a standard error of 14 %, the record passes.
    #[test]
    fn a_noise_that_is_known_to_some_per_cent_fails_nobody() {
        let rod = rod(0.0);
        let frequency_hz: Vec<f64> = (1..=900).map(|j| 10.0 * f64::from(j)).collect();
        let gamma = gamma(&frequency_hz);
        let distances = [0.1, 0.25, 0.41];
        let noise = 1e-3;
        // errors of random phase whose squares have the distribution of circular noise
        let mut state = 12345.0_f64;
        let mut uniform = || {
            state = (state * 997.0 + 0.5) % 65_521.0;
            (state + 0.5) / 65_521.0
        };
        let spectra: Vec<Vec<Complex64>> = distances
            .iter()
            .map(|d| {
                let value = |gamma: &Complex64| {
                    let size = noise * (-uniform().ln()).sqrt();
                    (gamma * d).sinh() + Complex64::from_polar(size, TAU * uniform())
                };
                gamma.iter().map(value).collect()
            })
            .collect();
        let too_small = vec![vec![0.9 * noise; frequency_hz.len()]; 3];
        let measured = GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &[&spectra],
            noise: &too_small,
        };
        let check = FreeEndNull::new(rod, distances.to_vec(), Quantity::Strain).unwrap();
        let known = check.check(&measured, &gamma, 0.01).unwrap();
        assert!(known.has_failed(), "{known}");
        // expected 1/0.9² = 1.235, within three standard deviations for 1800 degrees of freedom
        assert!((known.statistic - 1.235).abs() < 0.123, "{known}");
        let estimated = check
            .clone()
            .with_noise_freedom(VarianceFreedom::new(50.0, 100.0 / 2700.0).unwrap())
            .unwrap()
            .check(&measured, &gamma, 0.01)
            .unwrap();
        assert!(!estimated.has_failed(), "{estimated}");
        let too_few = VarianceFreedom::new(4.0, 1.0).unwrap();
        assert_eq!(
            check.with_noise_freedom(too_few).unwrap_err().to_string(),
            "degrees of freedom of the noise of a line is 4, expected more than 4: use a longer silence or more hits"
        );
    }
}
