//! Polynomial of third degree through complex values with weights, by orthogonal polynomials
//! (Forsythe).

use num_complex::Complex64;

/// Number of coefficients of the polynomial.
const TERMS: usize = 4;
/// Maximum number of Newton steps to a zero.
const MOST_STEPS: u32 = 30;

/// Least-squares fit of a polynomial of third degree over abscissas from -1 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalPolynomial {
    /// Coefficients of the recurrence p_{k+1} = (t - centre_k) p_k - ratio_k p_{k-1} with p₀ = 1.
    centre: [f64; TERMS],
    ratio: [f64; TERMS],
    /// Weighted square Σ w p_k² of each polynomial.
    power: [f64; TERMS],
    coefficients: [Complex64; TERMS],
}

#[allow(
    clippy::indexing_slicing,
    reason = "k is the index of a term, and all lists are arrays of `TERMS` elements"
)]
impl LocalPolynomial {
    /// Fits points of abscissa, value and weight; `None` if they do not determine the polynomial.
    pub(super) fn through(
        points: impl Iterator<Item = (f64, Complex64, f64)> + Clone,
    ) -> Option<Self> {
        let mut fit = Self {
            centre: [0.0; TERMS],
            ratio: [0.0; TERMS],
            power: [0.0; TERMS],
            coefficients: [Complex64::ZERO; TERMS],
        };
        let mut previous_power = 0.0;
        for k in 0..TERMS {
            let (mut power, mut moment, mut product) = (0.0, 0.0, Complex64::ZERO);
            for (t, value, weight) in points.clone() {
                let p = fit.basis(t)[k].0;
                power += weight * p * p;
                moment += weight * p * p * t;
                product += weight * p * value;
            }
            fit.power[k] = power;
            fit.centre[k] = moment / power;
            fit.coefficients[k] = product / power;
            fit.ratio[k] = if k == 0 { 0.0 } else { power / previous_power };
            previous_power = power;
        }
        let numbers = fit.coefficients.iter().all(|c| c.is_finite());
        numbers.then_some(fit)
    }

    /// Returns p_k and p_k' at t.
    fn basis(&self, t: f64) -> [(f64, f64); TERMS] {
        let mut basis = [(1.0, 0.0); TERMS];
        for k in 1..TERMS {
            let (p, slope) = basis[k - 1];
            let (before, slope_before) = if k > 1 { basis[k - 2] } else { (0.0, 0.0) };
            let shifted = t - self.centre[k - 1];
            basis[k] = (
                shifted * p - self.ratio[k - 1] * before,
                p + shifted * slope - self.ratio[k - 1] * slope_before,
            );
        }
        basis
    }

    /// Returns the value and the slope of the polynomial at t.
    pub(super) fn at(&self, t: f64) -> (Complex64, Complex64) {
        let terms = self.coefficients.iter().zip(self.basis(t));
        terms.fold(
            (Complex64::ZERO, Complex64::ZERO),
            |sum, (c, (p, slope))| (sum.0 + c * p, sum.1 + c * slope),
        )
    }

    /// Returns the derivative of the value at t with respect to the value of a point at `at` that
    /// has this `weight`.
    pub(super) fn influence(&self, t: f64, at: f64, weight: f64) -> f64 {
        let terms = self.basis(t).into_iter().zip(self.basis(at));
        let sum: f64 = terms
            .zip(self.power)
            .map(|(((p, _), (q, _)), power)| p * q / power)
            .sum();
        weight * sum
    }

    /// Returns the zero of the real part that Newton's method finds from the middle of the points;
    /// `None` if the zero is outside the range of the points.
    pub(super) fn zero_of_real_part(&self) -> Option<f64> {
        let mut t = 0.0;
        for _ in 0..MOST_STEPS {
            let (value, slope) = self.at(t);
            let step = value.re / slope.re;
            t -= step;
            if t.is_nan() || t.abs() > 1.0 {
                return None;
            }
            if step.abs() < 1e-13 {
                return Some(t);
            }
        }
        None
    }
}
