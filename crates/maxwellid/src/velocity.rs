//! Velocity from a sampled displacement.
//!
//! A polynomial of degree d is fitted to the 2 m + 1 samples around each sample, and its slope is
//! the velocity (Savitzky and Golay, Anal. Chem. 36 (1964) 1627). A smoothing spline is equivalent
//! in the middle of a record; this filter is preferred because it has no data-dependent tuning, no
//! memory beyond m samples, exactly linear phase, and noise with a covariance in closed form,
//! because the velocity is a finite sum of displacements.

use crate::error::MaxwellidError;

/// A finite-difference differentiator v_k = Σ d_j u_{k+j}, j = -m..m.
///
/// Its response to e^{iωt} is i ω times [`Self::gain`]; it commutes with a linear rod, so that a
/// response and an excitation filtered by the same differentiator remain consistent. A nonlinear
/// rod does not commute with it: content above [`Self::bandwidth`] is lost before the rod is
/// simulated, as with the filter of a recorder (docs/theory/identification.md).
///
/// ```
/// use maxwellid::Differentiator;
///
/// let differentiator = Differentiator::new(2, 4)?; // five points, degree 4
/// // (u₋₂ - 8 u₋₁ + 8 u₁ - u₂)/12, the difference of fourth order
/// assert!((differentiator.weights()[3] - 8.0 / 12.0).abs() < 1e-12);
/// // a hundredth of the slope is lost at 0.12 of the sampling rate
/// assert!((differentiator.bandwidth(0.01) - 0.12).abs() < 0.01);
/// // white noise of 1 µm at 51.2 kHz becomes 49 mm/s
/// assert!((differentiator.noise_gain() * 51_200.0 * 1e-6 - 0.0486).abs() < 1e-4);
/// # Ok::<(), maxwellid::MaxwellidError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Differentiator {
    /// d_j, j = -m..m, for a sampling interval of 1
    weights: Vec<f64>,
}

impl Differentiator {
    /// Creates the filter of 2 `half_width` + 1 points and a polynomial of degree `degree`.
    ///
    /// # Errors
    /// [`MaxwellidError::Differentiator`] unless 1 <= `degree` <= 2 `half_width` <= 200.
    pub fn new(half_width: usize, degree: usize) -> Result<Self, MaxwellidError> {
        if !(1..=100).contains(&half_width) || degree < 1 || degree > 2 * half_width {
            return Err(MaxwellidError::Differentiator { half_width, degree });
        }
        let m = half_width.cast_signed();
        // positions in units of the half width, so that powers stay within [-1, 1]
        let (scale, points): (f64, Vec<f64>) = (
            half_width as f64,
            (-m..=m).map(|j| j as f64 / half_width as f64).collect(),
        );
        // Gram's polynomials qₖ, orthonormal over the points, from x qₖ₋₁ minus its part along the
        // previous ones, each with its slope at 0. Powers of x would be linearly dependent within
        // rounding from degree 20 on.
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let constant = (points.len() as f64).sqrt().recip();
        let mut polynomials: Vec<(Vec<f64>, f64)> = vec![(vec![constant; points.len()], 0.0)];
        let mut weights = vec![0.0; points.len()];
        for _ in 0..degree {
            let Some((before, slope_before)) = polynomials.last() else {
                break;
            };
            let mut next: Vec<f64> = before.iter().zip(&points).map(|(q, x)| q * x).collect();
            // (x q)' = q + x q'
            #[allow(
                clippy::indexing_slicing,
                reason = "there are 2m + 1 points, and a value of every polynomial at each"
            )]
            let mut slope = before[half_width] + points[half_width] * slope_before;
            for _ in 0..2 {
                for (other, its_slope) in &polynomials {
                    let along = dot(&next, other);
                    next.iter_mut()
                        .zip(other)
                        .for_each(|(q, o)| *q -= along * o);
                    slope -= along * its_slope;
                }
            }
            let length = dot(&next, &next).sqrt();
            next.iter_mut().for_each(|q| *q /= length);
            slope /= length;
            // the slope of the fit is the sum of the slopes of the polynomials, each times its
            // coefficient
            for (weight, q) in weights.iter_mut().zip(&next) {
                *weight += slope * q / scale;
            }
            polynomials.push((next, slope));
        }
        Ok(Self { weights })
    }

    /// The weights d_j for a sampling interval of 1, j = -m..m.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Half width m of the filter in samples.
    #[must_use]
    pub fn half_width(&self) -> usize {
        self.weights.len() / 2
    }

    /// Ratio of the computed to the true slope of a sinusoid at `frequency`, a fraction of the
    /// sampling rate.
    #[must_use]
    pub fn gain(&self, frequency: f64) -> f64 {
        let omega = std::f64::consts::TAU * frequency;
        let half = self.half_width();
        let sum: f64 = self
            .weights
            .iter()
            .enumerate()
            .map(|(j, d)| d * (omega * (j as f64 - half as f64)).sin())
            .sum();
        if omega == 0.0 { 1.0 } else { sum / omega }
    }

    /// Lowest frequency, as a fraction of the sampling rate, at which the error of the gain is
    /// `tolerance`; found to 1e-4.
    #[must_use]
    pub fn bandwidth(&self, tolerance: f64) -> f64 {
        if tolerance.is_nan() {
            return f64::NAN;
        }
        (1..5000)
            .map(|k| f64::from(k) * 1e-4)
            .find(|f| (self.gain(*f) - 1.0).abs() > tolerance)
            .unwrap_or(0.5)
    }

    /// (Σ d_j²)^½: standard deviation of the velocity divided by the product of the standard
    /// deviation of a white noise of the displacement and the sampling rate.
    #[must_use]
    pub fn noise_gain(&self) -> f64 {
        self.autocovariance(0).sqrt()
    }

    /// Σ_j d_j d_{j+lag}: the autocovariance of the velocity for white noise of the displacement of
    /// variance 1 at a sampling rate of 1.
    #[must_use]
    pub fn autocovariance(&self, lag: usize) -> f64 {
        self.weights
            .iter()
            .zip(self.weights.iter().skip(lag))
            .map(|(a, b)| a * b)
            .sum()
    }

    /// Returns the velocity [m/s] of a displacement \[m\] sampled at `rate_hz` \[Hz\]. The first
    /// velocity belongs to the displacement of index `half_width`, the last one to the displacement
    /// `half_width` samples before the last, so that nothing is extrapolated. The result is empty
    /// for a record shorter than the filter.
    #[must_use]
    #[allow(
        clippy::indexing_slicing,
        reason = "a window is as long as the weights, of which there are three or more"
    )]
    pub fn velocity(&self, displacement: &[f64], rate_hz: f64) -> Vec<f64> {
        displacement
            .windows(self.weights.len())
            .map(|window| {
                // differences from the middle sample avoid the rounding error of a large
                // displacement
                let middle = window[window.len() / 2];
                let sum: f64 = self
                    .weights
                    .iter()
                    .zip(window)
                    .map(|(d, u)| d * (u - middle))
                    .sum();
                sum * rate_hz
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_covariance_is_that_of_the_sum() {
        let differentiator = Differentiator::new(3, 2).unwrap();
        // seven points and degree 2: d_j = j/Σj² = j/28
        for (d, j) in differentiator.weights().iter().zip(-3_i32..) {
            assert!((d - f64::from(j) / 28.0).abs() < 1e-14);
        }
        // Σ j²/28² = 1/28; lag 1: Σ j(j+1)/28² = 16/784
        assert!((differentiator.autocovariance(0) - 1.0 / 28.0).abs() < 1e-15);
        assert!((differentiator.autocovariance(1) - 16.0 / 784.0).abs() < 1e-15);
        assert!(differentiator.autocovariance(7).abs() < 1e-300);
    }

    #[test]
    fn filters_that_do_not_exist_are_refused() {
        for (half_width, degree) in [(0, 1), (2, 5), (2, 0), (101, 4)] {
            assert_eq!(
                Differentiator::new(half_width, degree)
                    .unwrap_err()
                    .to_string(),
                format!(
                    "no differentiator has {half_width} points to either side and degree {degree}: \
                     expected 1 <= degree <= 2 points <= 200"
                )
            );
        }
    }
}
