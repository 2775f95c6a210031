//! One draw of a Monte Carlo computation: random numbers for the errors of the data.

use std::sync::{Mutex, PoisonError};

use cmod::estimate::ComplexCovariance;
use cmod::rheology::FittedLaw;
use maxwellid::Law;
use num_complex::Complex64;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Text after "expected" in the error message about data without errors.
pub(crate) const NEEDS_ERRORS: &str =
    "standard errors of the data: without them the draws have no scatter to be compared with";

/// Random numbers of one draw, and the laws that are fitted to the drawn data.
#[derive(Debug)]
pub struct Draw {
    random: Mutex<ChaCha8Rng>,
    pub(crate) laws: DrawnLaws,
}

/// Laws of a result that are fitted to each draw.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct DrawnLaws {
    /// Laws of a modulus whose parameters are all identifiable; fits to the drawn data start from
    /// them. A Prony series is excluded, because its errors include the error of the number of its
    /// branches.
    pub(crate) of_modulus: Vec<FittedLaw>,
    /// Laws of an impacted rod.
    pub(crate) of_rod: Vec<Law>,
}

impl Draw {
    pub(crate) fn new(random: ChaCha8Rng, laws: DrawnLaws) -> Self {
        Self {
            random: Mutex::new(random),
            laws,
        }
    }

    /// Draws a number from the standard normal distribution.
    pub(crate) fn standard(&self) -> f64 {
        self.with_random(|random| random.sample(StandardNormal))
    }

    /// Calls `of` with the random number generator, and returns its result.
    pub(crate) fn with_random<T>(&self, of: impl FnOnce(&mut ChaCha8Rng) -> T) -> T {
        let mut random = self.random.lock().unwrap_or_else(PoisonError::into_inner);
        of(&mut random)
    }

    /// Draws a complex error without preferred phase, whose squared magnitude has the mean
    /// `mean_square`; returns 0 if the mean square is infinite.
    pub(crate) fn complex(&self, mean_square: f64) -> Complex64 {
        let error = Complex64::new(self.standard(), self.standard());
        if mean_square.is_finite() {
            error * (0.5 * mean_square).sqrt()
        } else {
            Complex64::ZERO
        }
    }

    /// Draws a complex error whose real and imaginary parts have this covariance.
    pub(crate) fn with_covariance(&self, covariance: ComplexCovariance) -> Complex64 {
        let ComplexCovariance {
            real,
            imaginary,
            mixed,
        } = covariance;
        let (first, second) = (self.standard(), self.standard());
        let slope = if real > 0.0 { mixed / real } else { 0.0 };
        let along = first * real.sqrt();
        let across = second * (imaginary - slope * mixed).max(0.0).sqrt();
        Complex64::new(along, slope * along + across)
    }

    /// Adds an error to each of the `values` on neighbouring lines. Their mean squares are
    /// `mean_squares`; errors within `lines_per_independent_line` lines are correlated.
    pub(crate) fn add(
        &self,
        values: &mut [Complex64],
        mean_squares: impl IntoIterator<Item = f64>,
        lines_per_independent_line: f64,
    ) {
        let spacing = lines_per_independent_line.max(1.0);
        let (mut last, mut next) = (self.complex(2.0), self.complex(2.0));
        let mut part = 0.0;
        for (value, mean_square) in values.iter_mut().zip(mean_squares) {
            // interpolates between two independent errors and keeps their variance
            let error = (last * (1.0 - part) + next * part) / f64::hypot(1.0 - part, part);
            if mean_square.is_finite() {
                *value += error * (0.5 * mean_square).sqrt();
            }
            part += 1.0 / spacing;
            if part >= 1.0 {
                (last, next) = (next, self.complex(2.0));
                part -= 1.0;
            }
        }
    }
}
