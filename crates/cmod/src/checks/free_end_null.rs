//! Check that no force acts at the free end except that of its mass.

use num_complex::Complex64;

use super::{Check, CheckOutcome, check_level, chi_square_tail, fisher_tail};
use crate::error::{CmodError, check_positive};
use crate::estimate::VarianceFreedom;
use crate::free_end::{FreeEndShape, RodWithFreeEnd};
use crate::multi_point::{GaugeSpectra, Quantity};

/// Maximum number of Gauss-Newton steps per line.
const MOST_STEPS: u32 = 60;
/// Degrees of freedom of the noise of a line at or below which a ratio to this noise has no finite
/// variance.
const FEWEST_DEGREES_OF_FREEDOM: f64 = 4.0;
/// Smallest fraction of a Gauss-Newton step that is tried.
const SMALLEST_FRACTION: f64 = 1e-6;

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
/// degrees of freedom; noise alone gives 1.
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
/// // the third gauge is 10 mm from where it is said to be
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
        })
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
        if freedom.line <= FEWEST_DEGREES_OF_FREEDOM {
            return Err(CmodError::NonPhysical {
                quantity: "degrees of freedom of the noise of a line",
                value: freedom.line,
                expected: "more than 4: use a longer silence or more hits",
            });
        }
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
        let mut fit = Fit::new(self, n, spectra.tests.len());
        let (mut total, mut count) = (0.0, 0_usize);
        let mut worst = (0.0, None);
        for (index, &gamma) in propagation_coefficient.iter().enumerate() {
            if noises(spectra, index).any(|noise| noise == 0.0) {
                return Err(CmodError::NoNoise {
                    what: "noise of a sensor at line",
                    index,
                });
            }
            if !gamma.is_finite() || !fit.load(spectra, index) {
                continue;
            }
            let chi_square = 2.0 * fit.least_misfit(gamma);
            total += chi_square;
            count += 1;
            if chi_square > worst.0 {
                worst = (chi_square, Some(index));
            }
        }
        if count == 0 {
            return Err(CmodError::NoLines);
        }
        let all = (count * freedom) as f64;
        let (statistic, p_value) = match self.noise_freedom {
            None => (total / all, chi_square_tail(total, all)),
            Some(noise) => {
                let statistic = total / all * (1.0 - 2.0 / noise.line);
                let of_noise = (count * n) as f64 * noise.own;
                // the variance of the ratio is larger than with a known noise by (ν - 2)/(ν - 4)
                let of_lines = all * (noise.line - 4.0) / (noise.line - 2.0);
                (statistic, fisher_tail(statistic, of_lines, of_noise))
            }
        };
        let outcome = CheckOutcome::judged(Check::FreeEndNull, (statistic, 1.0), p_value, level);
        Ok(outcome.at(worst.1))
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
    check: &'a FreeEndNull,
    /// Values of all sensors, (n_tests · n_sensors).
    values: Vec<Complex64>,
    weights: Vec<f64>,
    /// Functions f and f' of each sensor, divided by the noise of the sensor.
    shape: Vec<(Complex64, Complex64)>,
}

impl<'a> Fit<'a> {
    fn new(check: &'a FreeEndNull, n_sensors: usize, n_tests: usize) -> Self {
        Self {
            check,
            values: Vec::with_capacity(n_sensors * n_tests),
            weights: Vec::with_capacity(n_sensors),
            shape: Vec::with_capacity(n_sensors),
        }
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`GaugeSpectra::check` has refused spectra of another length"
    )]
    fn load(&mut self, spectra: &GaugeSpectra<'_>, index: usize) -> bool {
        self.weights.clear();
        let noises = noises(spectra, index).map(f64::recip);
        self.weights.extend(noises);
        self.values.clear();
        for test in spectra.tests {
            for (spectrum, weight) in test.iter().zip(&self.weights) {
                self.values.push(spectrum[index] * weight);
            }
        }
        self.values.iter().all(|value| value.is_finite())
    }

    /// Returns Σ|b - cf|² at γ, and the Gauss-Newton step from γ.
    fn misfit(&mut self, gamma: Complex64) -> (f64, Complex64) {
        let l = self.check.rod.length_of_end_mass();
        let shape = FreeEndShape {
            quantity: self.check.quantity,
            length_of_end_mass: l,
        };
        self.shape.clear();
        for (distance, weight) in self.check.distances.iter().zip(&self.weights) {
            let jet = shape.at(*distance, gamma);
            self.shape.push((weight * jet.value, weight * jet.first));
        }
        let power: f64 = self.shape.iter().map(|(f, _)| f.norm_sqr()).sum();
        let drift: Complex64 = self
            .shape
            .iter()
            .map(|(f, slope)| f.conj() * slope)
            .sum::<Complex64>()
            / power;
        let n = self.shape.len();
        let (mut misfit, mut gradient, mut curvature) = (0.0, Complex64::ZERO, 0.0);
        for test in self.values.chunks_exact(n) {
            let pairs = || self.shape.iter().zip(test);
            let c = pairs().map(|((f, _), b)| f.conj() * b).sum::<Complex64>() / power;
            for ((f, slope), b) in pairs() {
                let rest = b - c * f;
                // d = P_perp f' c
                let d = c * (slope - drift * f);
                misfit += rest.norm_sqr();
                gradient += d.conj() * rest;
                curvature += d.norm_sqr();
            }
        }
        (misfit, gradient / curvature)
    }

    /// Returns the least misfit near `start`. Each Gauss-Newton step is halved until the misfit
    /// decreases.
    fn least_misfit(&mut self, start: Complex64) -> f64 {
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
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise that is assumed 10 % too small in amplitude: with chi-square over many lines a correct
    /// record fails. With Fisher's distribution for a noise of 100 degrees of freedom in all, whose
    /// power has a standard error of 14 %, the record passes.
    #[test]
    fn a_noise_that_is_known_to_some_per_cent_fails_nobody() {
        let rod = RodWithFreeEnd {
            diameter: 0.0106,
            density: 903.0,
            end_mass: 0.0,
        };
        let frequency_hz: Vec<f64> = (1..=900).map(|j| 10.0 * f64::from(j)).collect();
        let gamma: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| Complex64::new(0.05, 1.0) * (std::f64::consts::TAU * f / 1700.0))
            .collect();
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
                    (gamma * d).sinh()
                        + Complex64::from_polar(size, std::f64::consts::TAU * uniform())
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
