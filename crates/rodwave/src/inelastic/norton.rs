//! The Maxwell-Norton law, F = |σ|^κ sgn(σ)/B (Ödeen 1993, paper D, Table 1, model 2).
#![allow(
    clippy::indexing_slicing,
    reason = "the counter stays below `LANES`, the length of every array of cells; the law has two parameters of `MAX_PARAMETERS`"
)]

use super::{
    DEFAULT_REFERENCE_STRESS, InelasticLaw, LANES, RelaxationFlow, RelaxedStress, StressChange,
    cell_by_cell, elementary,
};
use crate::RodwaveError;
use crate::error::{check_array, check_finite, check_positive, check_that};

/// Inelastic strain rate F(σ) = r (|σ|/σ_ref)^κ sgn(σ) = |σ|^κ sgn(σ)/B with exponent κ and
/// reference rate r [1/s] at σ_ref \[Pa\].
///
/// κ = 1 is the linear Maxwell law. κ < 1 is allowed (the stress then vanishes in finite time). κ =
/// 1 is therefore not at the edge of the range that an identification searches.
///
/// ```
/// use rodwave::inelastic::{InelasticLaw, MaxwellNorton};
///
/// let law = MaxwellNorton::new(2.108, 7e13)?;
/// assert!((law.coefficient() / 7e13 - 1.0).abs() < 1e-12);
/// assert!((law.inelastic_strain_rate(5e6) / (5e6_f64.powf(2.108) / 7e13) - 1.0).abs() < 1e-12);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxwellNorton {
    exponent: f64,
    reference_rate: f64,
    reference_stress: f64,
}

impl MaxwellNorton {
    /// Creates the law with exponent κ and coefficient B [Pa^κ s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless κ and B are finite and above 0.
    pub fn new(exponent: f64, coefficient: f64) -> Result<Self, RodwaveError> {
        check_exponent(exponent)?;
        check_positive("coefficient B [Pa^kappa s]", coefficient)?;
        // in logarithms, because σ_ref^κ overflows long before the rate does
        let rate = (exponent * DEFAULT_REFERENCE_STRESS.ln() - coefficient.ln()).exp();
        Self::from_reference_rate(exponent, rate, DEFAULT_REFERENCE_STRESS)
    }

    /// Creates the law with exponent κ and F(`reference_stress` \[Pa\]) = `reference_rate` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0.
    pub fn from_reference_rate(
        exponent: f64,
        reference_rate: f64,
        reference_stress: f64,
    ) -> Result<Self, RodwaveError> {
        Ok(Self {
            exponent: check_exponent(exponent)?,
            reference_rate: check_positive("reference rate [1/s]", reference_rate)?,
            reference_stress: check_positive("reference stress [Pa]", reference_stress)?,
        })
    }

    /// Exponent κ.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Coefficient B [Pa^κ s].
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        (self.exponent * self.reference_stress.ln() - self.reference_rate.ln()).exp()
    }
}

/// Checks that the flow can be computed with an exponent. At exponents of some hundred, the law is
/// already perfectly plastic.
fn check_exponent(exponent: f64) -> Result<f64, RodwaveError> {
    check_that(
        exponent > 0.0 && exponent <= 1e6,
        "exponent kappa",
        exponent,
        "above 0 and at most 1e6",
    )
}

impl InelasticLaw for MaxwellNorton {
    const PARAMETERS: &'static [&'static str] = &["exponent", "ln_reference_rate"];
    type Flow = NortonFlow;

    #[inline]
    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        let ratio = stress.abs() / self.reference_stress;
        (self.reference_rate * ratio.powf(self.exponent)).copysign(stress)
    }

    fn flow(&self, modulus: f64, duration: f64) -> NortonFlow {
        NortonFlow {
            excess: self.exponent - 1.0,
            advance: modulus * duration * self.reference_rate / self.reference_stress,
            reference_stress: self.reference_stress,
            series: series_of_decrement(self.exponent - 1.0),
        }
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.exponent, self.reference_rate.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [exponent, ln_rate] = check_array("parameter array", parameters)?;
        check_finite("exponent kappa", exponent)?;
        Self::from_reference_rate(exponent, ln_rate.exp(), self.reference_stress)
    }

    fn reference_stress(&self) -> f64 {
        self.reference_stress
    }
}

/// Relaxation of Norton's law: |σ1| = |σ0| (1 + n a)^(-1/n), with n = κ - 1 and a = E h F(σ0)/σ0.
///
/// The longest step of a block determines the number of parts into which all its steps are divided
/// for the series. The other cells of a block therefore affect the stress of a cell by some
/// rounding units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NortonFlow {
    /// n = κ - 1
    excess: f64,
    /// E h r/σ_ref, the value of a at the reference stress
    advance: f64,
    reference_stress: f64,
    series: [f64; TERMS],
}

impl NortonFlow {
    /// Returns a = E h F(σ0)/σ0 and the ratio |σ0|/σ_ref, for σ0 different from 0.
    #[inline]
    fn relative_step(&self, stress: f64) -> (f64, f64) {
        let ratio = stress.abs() / self.reference_stress;
        (self.advance * ratio.powf(self.excess), ratio)
    }

    /// Computes (1 + n a)^(-1/n): by a binomial series for the short steps of a solver, otherwise
    /// in closed form.
    #[inline]
    fn factor(&self, a: f64) -> f64 {
        let n = self.excess;
        if self.is_short(a) {
            return 1.0 - self.short_decrement(a);
        }
        let x = n * a;
        if x <= -1.0 || n == 0.0 && a == f64::INFINITY {
            0.0 // κ < 1 and the stress has vanished within the step
        } else if x.abs() < 1e-300 {
            (-a).exp()
        } else {
            (-a * (x.ln_1p() / x)).exp()
        }
    }

    /// Returns true if κ > 1 and n a, with the power (σ0/σ_ref)^{κ-1} in a, is above the range of a
    /// double.
    #[inline]
    fn overflows(&self, a: f64) -> bool {
        self.excess > 0.0 && self.advance > 0.0 && self.excess * a == f64::INFINITY
    }

    /// [`Self::factor`] for a step that [overflows](Self::overflows): (n a)^{-1/n}, n = κ - 1, in
    /// logarithms.
    #[cold]
    fn factor_of_overflow(&self, ratio: f64) -> f64 {
        let n = self.excess;
        (-((n * self.advance).ln() / n + ratio.ln())).exp().min(1.0)
    }

    /// Returns true if the series of [`Self::short_decrement`] is valid.
    #[inline(always)]
    fn is_short(&self, a: f64) -> bool {
        a * (1.0 + self.excess.abs()) < SHORT
    }

    /// Computes 1 - (1 + n a)^(-1/n) by its series.
    #[inline(always)]
    fn short_decrement(&self, a: f64) -> f64 {
        a * elementary::polynomial(&self.series, a)
    }

    /// Decrease of the stress of several cells: by the series, over the whole step or in parts, or
    /// in closed form; `None` if a step [overflows](Self::overflows).
    #[inline(always)]
    fn fall(&self, a: &[f64; LANES]) -> Option<Fall> {
        let largest = elementary::largest(a);
        let hardest = largest * (1.0 + self.excess.abs());
        if hardest < SHORT {
            let decrement = lanes!(|i| self.short_decrement(a[i]));
            return Some(Fall::by(decrement));
        }
        let parts = (hardest / SHORT).ceil();
        if parts.is_nan() || self.overflows(largest) {
            return None;
        }
        if parts > MOST_PARTS || self.excess < 0.0 {
            return Some(self.long_fall(a));
        }
        // the rate falls with the stress, so the first part has the largest a
        let per_part = 1.0 / parts;
        let mut step = lanes!(|i| a[i] * per_part);
        let mut decrement = [0.0; LANES];
        let mut left = parts;
        while left > 0.5 {
            for i in 0..LANES {
                let by = self.short_decrement(step[i]);
                decrement[i] += by - decrement[i] * by;
                // the factor 1 + n a by which |σ|ⁿ has fallen
                step[i] /= 1.0 + self.excess * step[i];
            }
            left -= 1.0;
        }
        Some(Fall::by(decrement))
    }

    /// [`Self::fall`] by exp(-a ln(1 + x)/x), x = n a, for the cells whose step is not short.
    #[inline(always)]
    fn long_fall(&self, a: &[f64; LANES]) -> Fall {
        let sum = lanes!(|i| 1.0 + self.excess * a[i]);
        let ln_sum = elementary::ln(&sum);
        // x is computed from the rounded value of 1 + x whose logarithm is taken: the quotient ln(1
        // + x)/x is then exact to rounding
        let exponent = lanes!(|i| {
            let rounded = sum[i] - 1.0;
            if rounded == 0.0 {
                -a[i]
            } else {
                -a[i] * (ln_sum[i] / rounded)
            }
        });
        let closed = elementary::exp(&exponent);
        let mut fall = Fall::by(lanes!(|i| self.short_decrement(a[i])));
        for i in 0..LANES {
            if !self.is_short(a[i]) {
                fall.kept[i] = if sum[i] > 0.0 { closed[i] } else { 0.0 };
                fall.decrement[i] = 1.0 - fall.kept[i];
            }
        }
        fall
    }

    /// Computes the changes cell by cell, for steps that overflow.
    #[cold]
    #[inline(never)]
    fn change_cell_by_cell(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        lanes!(|i| self.relax(stress[i]) - stress[i])
    }

    /// Computes ln(|σ|/σ_ref) and a of several cells.
    #[inline(always)]
    fn relative_steps(&self, stress: &[f64; LANES]) -> ([f64; LANES], [f64; LANES]) {
        let inverse = 1.0 / self.reference_stress;
        let ln_ratio = elementary::ln(&lanes!(|i| stress[i].abs() * inverse));
        let power = elementary::exp(&lanes!(|i| self.excess * ln_ratio[i]));
        (ln_ratio, lanes!(|i| self.advance * power[i]))
    }
}

/// Largest a (1 + |n|) of a short step: the first omitted term of the series is then (2e-2)^9 of
/// the first term, 5e-16.
const SHORT: f64 = 2e-2;

/// Decrease of the stress of several cells in one step.
struct Fall {
    /// 1 - |σ1/σ0|
    decrement: [f64; LANES],
    /// |σ1/σ0|
    kept: [f64; LANES],
}

impl Fall {
    #[inline(always)]
    fn by(decrement: [f64; LANES]) -> Self {
        Self {
            decrement,
            kept: lanes!(|i| 1.0 - decrement[i]),
        }
    }
}

/// Largest number of parts into which a step is divided for the series.
const MOST_PARTS: f64 = 16.0;

/// Terms of the series of the decrement.
const TERMS: usize = 9;

/// Coefficients of 1 - (1 + n a)^(-1/n) = Σ (-1)^k Π_{j<=k}(1 + j n)/(k+1)! a^(k+1), from k = 0.
fn series_of_decrement(n: f64) -> [f64; TERMS] {
    let mut coefficient = 1.0;
    let mut order = 1.0;
    std::array::from_fn(|_| {
        let present = coefficient;
        coefficient *= -(1.0 + order * n) / (order + 1.0);
        order += 1.0;
        present
    })
}

impl RelaxationFlow for NortonFlow {
    #[inline]
    fn relax(&self, stress: f64) -> f64 {
        if stress == 0.0 {
            return 0.0;
        }
        let (a, ratio) = self.relative_step(stress);
        stress
            * if self.overflows(a) {
                self.factor_of_overflow(ratio)
            } else {
                self.factor(a)
            }
    }

    #[inline(always)]
    fn change(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        let (_, a) = self.relative_steps(stress);
        match self.fall(&a) {
            Some(Fall { decrement, .. }) => lanes!(|i| -stress[i] * decrement[i]),
            None => self.change_cell_by_cell(stress),
        }
    }

    #[inline(always)]
    fn change_with_sensitivity(&self, stress: &[f64; LANES], parameters: usize) -> StressChange {
        let (ln_ratio, a) = self.relative_steps(stress);
        let Some(Fall { decrement, kept }) = self.fall(&a) else {
            return cell_by_cell(self, stress, parameters);
        };
        // short steps use the series, which does not need the logarithm
        let ln_factor = if self.is_short(elementary::largest(&a)) {
            [0.0; LANES]
        } else {
            elementary::ln(&lanes!(|i| 1.0 + self.excess * a[i]))
        };
        let mut result = StressChange::default();
        for i in 0..LANES {
            let a = a[i];
            let x = self.excess * a;
            let inverse = 1.0 / (1.0 + x);
            // κ < 1, and the stress has vanished within the step or was zero
            let gone = x <= -1.0;
            let relaxed = stress[i] * kept[i];
            let by_log_rate = if gone { 0.0 } else { -relaxed * a * inverse };
            // the expression of the function `bend`, with another limit for the series: the result
            // is multiplied by a, and a rounding error of 1e-15 divided by the square of 2e-2 is
            // negligible
            let bend = if x.abs() < SHORT {
                0.5 - x * (2.0 / 3.0 - x * (0.75 - x * (0.8 - x * (5.0 / 6.0 - x * (6.0 / 7.0)))))
            } else {
                (ln_factor[i] - x * inverse) / (x * x)
            };
            result.stress[i] = -stress[i] * decrement[i];
            // (σ1/σ0)^κ - 1 = factor/(1 + x) - 1, without its cancellation where κ > 1
            result.by_stress[i] = if x < 0.0 {
                if gone { -1.0 } else { kept[i] * inverse - 1.0 }
            } else {
                -(decrement[i] + x) * inverse
            };
            result.by_log_modulus[i] = by_log_rate;
            result.by_parameter[0][i] = if gone {
                0.0
            } else {
                relaxed * a * (a * bend - ln_ratio[i] * inverse)
            };
            result.by_parameter[1][i] = by_log_rate;
        }
        result
    }

    #[inline]
    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        by_parameter.fill(0.0);
        if stress == 0.0 {
            return RelaxedStress {
                stress: 0.0,
                // E h F'(0) is 0 for κ > 1 and E h r/σ_ref for κ = 1; for κ < 1 a small stress
                // vanishes within the step
                by_stress: if self.excess > 0.0 {
                    1.0
                } else if self.excess < 0.0 {
                    0.0
                } else {
                    (-self.advance).exp()
                },
                by_log_modulus: 0.0,
            };
        }
        let (a, ratio) = self.relative_step(stress);
        if self.overflows(a) {
            let relaxed = stress * self.factor_of_overflow(ratio);
            let n = self.excess;
            // σ1 = σ_ref (n E h r/σ_ref)^{-1/n} does not depend on σ0
            let by_exponent = relaxed * ((n * self.advance).ln() - 1.0) / n / n;
            for (slot, value) in by_parameter.iter_mut().zip([by_exponent, -relaxed / n]) {
                *slot = value;
            }
            return RelaxedStress {
                stress: relaxed,
                by_stress: 0.0,
                by_log_modulus: -relaxed / n,
            };
        }
        let factor = self.factor(a);
        let relaxed = stress * factor;
        if factor == 0.0 {
            return RelaxedStress {
                stress: 0.0,
                by_stress: 0.0,
                by_log_modulus: 0.0,
            };
        }
        let x = self.excess * a;
        let by_log_rate = -relaxed * a / (1.0 + x);
        let by_exponent = relaxed * a * (a * bend(x) - ratio.ln() / (1.0 + x));
        for (entry, by) in by_parameter.iter_mut().zip([by_exponent, by_log_rate]) {
            *entry = by;
        }
        RelaxedStress {
            stress: relaxed,
            // (σ1/σ0)^κ = factor / (1 + n a)
            by_stress: factor / (1.0 + x),
            by_log_modulus: by_log_rate,
        }
    }
}

/// Computes [ln(1+x) - x/(1+x)]/x², by its series where the difference cancels.
fn bend(x: f64) -> f64 {
    if x.abs() < 1e-2 {
        // Σ (-x)^k (k+1)/(k+2), first omitted term x^8
        let mut sum = 0.0;
        for k in (0_u8..8).rev() {
            sum = f64::from(k + 1) / f64::from(k + 2) - x * sum;
        }
        sum
    } else {
        (x.ln_1p() - x / (1.0 + x)) / (x * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inelastic::battery::battery;

    #[test]
    fn the_flow_is_exact() {
        for exponent in [0.7, 0.999_999, 1.0, 1.000_001, 1.55, 2.108, 3.5] {
            battery(&MaxwellNorton::from_reference_rate(exponent, 4.0, 10e6).unwrap());
        }
    }
}
