//! Trend of the modulus over the hits of a test, by temperature or by a mounting that works loose.
//!
//! Each hit by itself gives a modulus, less accurate than their mean by √n. Its relative deviation from
//! that of all hits is averaged over the valid lines, with the weights of their random errors,
//!
//! ```text
//! ε_k = Σ_j w_j Re (E_kj - E_j)/E_j / Σ_j w_j ,   w_j = |E_j|²/σ_j² ,
//! ```
//!
//! in which errors of the specimen and of the sensors cancel to first order. A straight line through
//! ε_k over the number of the hit, or over its temperature, has a slope with the error of the scatter
//! about the line, and n - 2 degrees of freedom.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::error::{CmodError, check_length};
use crate::estimate::ModulusEstimate;

/// Fewest hits for a slope whose error is known.
pub const FEWEST_HITS: usize = 4;
/// Largest relative deviation of a line that takes part: it has another branch otherwise.
const LARGEST_DEVIATION: f64 = 0.2;

/// Trend of the modulus over hits.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HitTrend {
    /// Relative deviation of each hit from all.
    pub deviations: Vec<f64>,
    /// Relative change of the modulus per unit of what the hits differ in.
    pub slope: f64,
    /// Standard error of the slope, by the scatter about the line.
    pub standard_error: f64,
    /// Probability of a slope at least as large without a trend.
    pub p_value: f64,
}

impl HitTrend {
    /// Finds the trend of the deviations of the hits ([`deviation`]), whose numbers, times or
    /// temperatures are `over`.
    ///
    /// `None` for fewer than four hits, or if all values of `over` are equal.
    ///
    /// # Errors
    /// [`CmodError::LengthMismatch`] unless there is a value of `over` for each hit.
    pub fn of(deviations: Vec<f64>, over: &[f64]) -> Result<Option<Self>, CmodError> {
        check_length("places of the hits", over.len(), deviations.len())?;
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

/// Returns the relative deviation ε of the modulus of one hit from that of all; `None` without a line
/// that both have.
#[must_use]
pub fn deviation(all: &ModulusEstimate, hit: &ModulusEstimate) -> Option<f64> {
    let mut of_hit = hit.lines().iter().peekable();
    let (mut sum, mut weights) = (0.0, 0.0);
    for line in all.valid() {
        while of_hit.next_if(|own| own.index < line.index).is_some() {}
        let Some(own) = of_hit.next_if(|own| own.index == line.index) else {
            continue;
        };
        let change = ((own.modulus - line.modulus) / line.modulus).re;
        let weight = line.modulus.norm_sqr() / line.uncertainty.random.modulus.mean_square();
        if change.abs() <= LARGEST_DEVIATION && weight.is_finite() {
            sum += weight * change;
            weights += weight;
        }
    }
    (weights > 0.0).then(|| sum / weights)
}
