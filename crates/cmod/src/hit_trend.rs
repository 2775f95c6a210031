//! Trend of the modulus over the hits of a test, for example due to temperature or to a mounting
//! that becomes loose.
//!
//! The random error of the modulus from one of n hits is √n times that of the modulus from all
//! hits. The relative deviation from the modulus of all hits is averaged over the valid lines, with
//! weights from their random errors,
//!
//! ```text
//! ε_k = Σ_j w_j Re δ_kj / Σ_j w_j ,   w_j = |E_j|²/σ_j² ,   δ_kj = (E_kj - E_j)/E_j ,
//! ```
//!
//! Errors of the specimen and of the sensors cancel to first order. For ratios of spectra Ψ, the
//! deviation of a line is linearised about the modulus of all hits,
//!
//! ```text
//! δ_kj = -2 (Ψ_kj - Ψ_j) (dγ/dΨ)_j / γ_j .
//! ```
//!
//! A straight line is fitted to ε_k against the number of the hit, or against its temperature. The
//! error of its slope follows from the scatter about the line, with n - 2 degrees of freedom.

use num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::error::{CmodError, check_values};
use crate::estimate::{ModulusEstimate, ModulusLine};
use crate::section_ratio::RatioMethod;

/// Minimum number of hits for a slope with a standard error.
pub const FEWEST_HITS: usize = 4;
/// Largest relative deviation with which a line is used. A larger deviation means that the line is
/// on another branch, or that the deviation is not linear in the ratio.
const LARGEST_DEVIATION: f64 = 0.2;

/// Trend of the modulus over hits.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HitTrend {
    /// Relative deviation of the modulus of each hit from the modulus of all hits.
    pub deviations: Vec<f64>,
    /// Relative change of the modulus per unit of the number, time or temperature against which the
    /// deviations are fitted.
    pub slope: f64,
    /// Standard error of the slope, from the scatter about the line.
    pub standard_error: f64,
    /// Probability of a slope at least as large if there is no trend.
    pub p_value: f64,
}

impl HitTrend {
    /// Fits the trend of the `deviations` of the hits ([`deviation`], [`deviations`]) against their
    /// numbers, times or temperatures, `over`.
    ///
    /// Returns `None` for fewer than four hits, if all values of `over` are equal, or if there is
    /// no scatter.
    ///
    /// # Errors
    /// [`CmodError::ReadingCount`] unless there is a value of `over` for each hit.
    pub fn of(deviations: Vec<f64>, over: &[f64]) -> Result<Option<Self>, CmodError> {
        check_values("abscissa", over.len(), deviations.len(), "hit")?;
        if deviations.len() < FEWEST_HITS {
            return Ok(None);
        }
        let n = deviations.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
        let (middle, level) = (mean(over), mean(&deviations));
        let spread: f64 = over.iter().map(|x| (x - middle).powi(2)).sum();
        let pairs = || over.iter().zip(&deviations);
        let slope = pairs().map(|(x, y)| (x - middle) * y).sum::<f64>() / spread;
        let scatter: f64 = pairs()
            .map(|(x, y)| (y - level - slope * (x - middle)).powi(2))
            .sum();
        let freedom = n - 2.0;
        let standard_error = (scatter / freedom / spread).sqrt();
        let Ok(student) = StudentsT::new(0.0, 1.0, freedom) else {
            return Ok(None);
        };
        let p_value = 2.0 * student.sf((slope / standard_error).abs());
        let known = slope.is_finite() && standard_error > 0.0 && p_value.is_finite();
        Ok(known.then_some(Self {
            deviations,
            slope,
            standard_error,
            p_value,
        }))
    }
}

/// Returns the relative deviation ε of the modulus of one `hit` from the modulus of `all` hits;
/// `None` if the two have no usable line in common.
#[must_use]
pub fn deviation(all: &ModulusEstimate, hit: &ModulusEstimate) -> Option<f64> {
    let mut of_hit = hit.lines().iter().peekable();
    let mut mean = WeightedMean::default();
    for line in all.valid() {
        while of_hit.next_if(|own| own.index < line.index).is_some() {}
        if let Some(own) = of_hit.next_if(|own| own.index == line.index) {
            mean.add((own.modulus - line.modulus) / line.modulus, weight(line));
        }
    }
    mean.value()
}

/// Returns the relative deviations ε of the modulus of each hit from the modulus of all hits, to
/// first order in the deviation of the ratios of the hit from the `ratios` of all hits. All ratios
/// have one entry per line used for the estimate. Returns `None` if `method` has no derivative at a
/// valid line, or if a hit has no usable line.
#[must_use]
pub fn deviations(
    method: &dyn RatioMethod,
    all: &ModulusEstimate,
    ratios: &[Complex64],
    hits: &[&[Complex64]],
) -> Option<Vec<f64>> {
    let mut means = vec![WeightedMean::default(); hits.len()];
    for line in all.valid() {
        let gamma = line.propagation_coefficient;
        let by_ratio = method.ratio_about(line.frequency_hz, gamma)?.by_ratio;
        let (relative, weight) = (-2.0 * by_ratio / gamma, weight(line));
        let ratio = ratios.get(line.index)?;
        for (mean, hit) in means.iter_mut().zip(hits) {
            mean.add(relative * (hit.get(line.index)? - ratio), weight);
        }
    }
    means.iter().map(WeightedMean::value).collect()
}

/// Returns the weight |E|²/σ² of a line.
fn weight(line: &ModulusLine) -> f64 {
    line.modulus.norm_sqr() / line.uncertainty.random.modulus.mean_square()
}

/// Weighted mean of the real parts of relative deviations.
#[derive(Debug, Clone, Copy, Default)]
struct WeightedMean {
    sum: f64,
    weights: f64,
}

impl WeightedMean {
    /// Adds a deviation, unless it is too large or not finite.
    fn add(&mut self, deviation: Complex64, weight: f64) {
        if deviation.re.abs() <= LARGEST_DEVIATION && weight.is_finite() {
            self.sum += weight * deviation.re;
            self.weights += weight;
        }
    }

    fn value(&self) -> Option<f64> {
        (self.weights > 0.0).then(|| self.sum / self.weights)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{Specimen, TwoPoint};

    /// Compares [`deviation`] and [`deviations`] with the known changes of the modulus from hit to
    /// hit, for a rod whose ratio is cosh γL.
    #[test]
    fn deviations_of_hits_are_the_differences_of_their_moduli() {
        let specimen = Specimen {
            length: 0.8,
            diameter: 0.012,
            density: 910.0,
            accelerometer_mass: 0.0,
        };
        let method = TwoPoint::new(specimen).unwrap();
        let frequency_hz: Vec<f64> = (4..80).map(|line| 25.0 * f64::from(line)).collect();
        let ratios = |change: f64| -> Vec<Complex64> {
            let modulus = (1.0 + change) * Complex64::new(2e9, 1e8);
            let ratio = |hz: &f64| {
                let gamma = Complex64::new(0.0, TAU * hz) * (910.0 / modulus).sqrt();
                (0.8 * gamma).cosh()
            };
            frequency_hz.iter().map(ratio).collect()
        };
        let variance = vec![1e-6; frequency_hz.len()];
        let estimate =
            |ratio: &[Complex64]| method.estimate(&frequency_hz, ratio, &variance).unwrap();
        let of_all = ratios(0.0);
        let all = estimate(&of_all);
        assert!(all.valid().count() > 20, "{}", all.valid().count());
        let changes = [-2e-5, 0.0, 1e-5, 3e-5];
        let hits = changes.map(ratios);
        let hits: Vec<&[Complex64]> = hits.iter().map(Vec::as_slice).collect();
        let found = deviations(&method, &all, &of_all, &hits).unwrap();
        for ((found, change), hit) in found.iter().zip(changes).zip(hits) {
            // the error is of second order, (γL δ)² with γL up to 7
            assert!((found - change).abs() < 1e-7, "{found} {change}");
            let by_estimates = deviation(&all, &estimate(hit)).unwrap();
            assert!((by_estimates - change).abs() < 1e-9, "{by_estimates}");
        }
        // a hit without a usable line has no deviation
        let silent = vec![Complex64::new(f64::NAN, 0.0); of_all.len()];
        assert_eq!(deviations(&method, &all, &of_all, &[&silent]), None);
    }
}
