//! The Maxwell-Gurevich-Rabinovich law, F = σ exp(|σ|/m)/η (Ödeen 1993, paper D, Table 1, model 3).

use super::{
    DEFAULT_REFERENCE_STRESS, InelasticLaw, LANES, RelaxationFlow, RelaxedStress, StressChange,
    cell_by_cell, elementary,
    exponential_integral::{self, E1_OF_ONE, EULER_GAMMA, e1},
};
use crate::RodwaveError;
use crate::error::{check_array, check_finite, check_positive};

/// Inelastic strain rate F(σ) = σ exp(|σ|/m)/η = r (σ/σ_ref) exp(β (|σ|/σ_ref - 1)), with β =
/// σ_ref/m and r = F(σ_ref).
///
/// β = 0 is the linear Maxwell law. β < 0 (a viscosity that grows with stress) is allowed. β = 0 is
/// therefore not at the edge of the range that an identification searches.
///
/// ```
/// use rodwave::inelastic::{InelasticLaw, MaxwellGurevichRabinovich};
///
/// let law = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6)?;
/// let expected = 8e6 * (8e6_f64 / 7.08e6).exp() / 3.5e6;
/// assert!((law.inelastic_strain_rate(8e6) / expected - 1.0).abs() < 1e-13);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxwellGurevichRabinovich {
    /// β = σ_ref/m
    sharpness: f64,
    reference_rate: f64,
    reference_stress: f64,
}

impl MaxwellGurevichRabinovich {
    /// Creates the law with viscosity η [Pa s] at vanishing stress and activation stress m \[Pa\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless η and m are finite and above 0.
    pub fn new(viscosity: f64, activation_stress: f64) -> Result<Self, RodwaveError> {
        check_positive("viscosity [Pa s]", viscosity)?;
        check_positive("activation stress m [Pa]", activation_stress)?;
        let sharpness = DEFAULT_REFERENCE_STRESS / activation_stress;
        let rate = DEFAULT_REFERENCE_STRESS / viscosity * sharpness.exp();
        Self::from_reference_rate(sharpness, rate, DEFAULT_REFERENCE_STRESS)
    }

    /// Creates the law with β = σ_ref/m and F(`reference_stress` \[Pa\]) = `reference_rate` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless β is finite, the others are finite and above 0, and the
    /// resulting viscosity is too, which requires |β| below about 700.
    pub fn from_reference_rate(
        sharpness: f64,
        reference_rate: f64,
        reference_stress: f64,
    ) -> Result<Self, RodwaveError> {
        let law = Self {
            sharpness: check_finite("sharpness beta = reference stress / m", sharpness)?,
            reference_rate: check_positive("reference rate [1/s]", reference_rate)?,
            reference_stress: check_positive("reference stress [Pa]", reference_stress)?,
        };
        // the flow uses the viscosity, which must therefore be finite and above 0
        check_positive("viscosity [Pa s]", law.viscosity())?;
        Ok(law)
    }

    /// Viscosity η [Pa s] at vanishing stress.
    #[must_use]
    pub fn viscosity(&self) -> f64 {
        self.reference_stress / self.reference_rate * self.sharpness.exp()
    }

    /// Activation stress m \[Pa\]: infinite for the linear law, negative if the viscosity grows
    /// with stress.
    #[must_use]
    pub fn activation_stress(&self) -> f64 {
        self.reference_stress / self.sharpness
    }
}

impl InelasticLaw for MaxwellGurevichRabinovich {
    const PARAMETERS: &'static [&'static str] = &["sharpness", "ln_reference_rate"];
    type Flow = GurevichRabinovichFlow;

    #[inline]
    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        let ratio = stress / self.reference_stress;
        self.reference_rate * ratio * (self.sharpness * (ratio.abs() - 1.0)).exp()
    }

    fn flow(&self, modulus: f64, duration: f64) -> GurevichRabinovichFlow {
        GurevichRabinovichFlow {
            advance: modulus * duration / self.viscosity(),
            inverse_activation_stress: self.sharpness / self.reference_stress,
            reference_stress: self.reference_stress,
        }
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.sharpness, self.reference_rate.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [sharpness, ln_rate] = check_array("parameter array", parameters)?;
        check_finite("ln reference rate", ln_rate)?;
        Self::from_reference_rate(sharpness, ln_rate.exp(), self.reference_stress)
    }

    fn reference_stress(&self) -> f64 {
        self.reference_stress
    }
}

/// Relaxation of the law: E1(y1) = E1(y0) + q with y = |σ|/m and q = E h/η, E1 the exponential
/// integral.
///
/// With y1 = y0 e^{-S}, the same relation reads ∫₀^S exp(-y0 e^{-s}) ds = q. This form is valid for
/// either sign of m and has no cancellation. The short steps of a solver use the Taylor series of
/// y1/y0 in q; long steps solve for y1.
///
/// All cells of a block use the number of terms that the longest step needs. The result of a cell
/// therefore depends on the other cells, by at most 4e-13 of the change and two rounding units of
/// the stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GurevichRabinovichFlow {
    /// q = E h/η
    advance: f64,
    /// 1/m
    inverse_activation_stress: f64,
    reference_stress: f64,
}

/// Largest number of terms of the series.
const MOST_TERMS: usize = 9;

/// Coefficients of the series y1/y0 - 1 = Σ aⁿ Rₙ(p)/n! with a = q e^p and p = y0. Row n - 1
/// contains the coefficients of Rₙ(p)/n!, starting with the constant.
///
/// dy/dq = -y e^y gives R₁ = -1 and Rₙ₊₁ = -((1 + n p) Rₙ + p Rₙ'). For large p, the series tends
/// to that of -ln(1 + ap)/p: with x = a (1 + |p|), the remainder after N terms is about xᴺ/(N + 1)
/// of the sum, and less for smaller |p|.
#[allow(
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, which refuses an index out of bounds"
)]
const SERIES: [[f64; MOST_TERMS]; MOST_TERMS] = {
    let mut series = [[0.0; MOST_TERMS]; MOST_TERMS];
    // Rₙ has integer coefficients
    let mut row = [0.0; MOST_TERMS];
    row[0] = -1.0;
    let (mut n, mut order, mut factorial) = (0, 1.0, 1.0);
    while n < MOST_TERMS {
        let mut next = [0.0; MOST_TERMS];
        let (mut k, mut power) = (0, 0.0);
        while k < MOST_TERMS {
            series[n][k] = row[k] / factorial;
            next[k] -= row[k] * (1.0 + power);
            if k + 1 < MOST_TERMS {
                next[k + 1] -= row[k] * order;
            }
            k += 1;
            power += 1.0;
        }
        row = next;
        n += 1;
        order += 1.0;
        factorial *= order;
    }
    series
};

/// Largest a (1 + |p|) for 5, 7 and 9 terms of the series. Up to these limits, the remainder is
/// below 2e-13 of the change of stress and below 1e-14 of the stress (found by comparison with 30
/// terms with exact coefficients, for |p| up to 10 000).
const LIMIT_OF_FIVE: f64 = 3.9e-3;
const LIMIT_OF_SEVEN: f64 = 2e-2;
const SERIES_LIMIT: f64 = 4.8e-2;

/// Computes y1/y0 - 1 = e^{-S} - 1 by `TERMS` terms of [`SERIES`].
#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "`TERMS` is 5, 7 or `MOST_TERMS`, the number of rows and columns of `SERIES`, and `n` counts its rows"
)]
fn shrink_by_series<const TERMS: usize>(a: f64, p: f64) -> f64 {
    let mut sum = 0.0;
    // plain loops: an iterator that is not inlined prevents vector instructions
    let mut n = TERMS;
    while n > 0 {
        n -= 1;
        let row = &SERIES[n];
        let (mut of_row, mut k) = (row[n], n);
        while k > 0 {
            k -= 1;
            of_row = of_row * p + row[k];
        }
        sum = sum * a + of_row;
    }
    a * sum
}

/// Computes S from the series.
fn decrement_by_series(a: f64, p: f64) -> f64 {
    -shrink_by_series::<MOST_TERMS>(a, p).ln_1p()
}

/// Computes S for a step of any length.
#[cold]
fn decrement_of_long_step(q: f64, y0: f64) -> f64 {
    if y0 < 0.0 {
        // The viscosity falls to η as the stress relaxes. Steps of the series are made until the
        // integral can be evaluated.
        if q == f64::INFINITY {
            return q;
        }
        let (mut done, mut left, mut p) = (0.0, q, y0);
        while left > 0.0 && p < -LARGEST_ENTIRE {
            let step = left.min(SERIES_LIMIT / ((1.0 - p) * p.exp()));
            let advance = decrement_by_series(step * p.exp(), p);
            done += advance;
            p *= (-advance).exp();
            left -= step;
        }
        return done + decrement_by_entire_integral(left, -p);
    }
    if y0 < 1e-300 {
        return q;
    }
    let target = e1(y0) + q;
    if target == f64::INFINITY {
        return target;
    }
    if target > E1_OF_ONE {
        // As a function of z = ln y, E1 is convex and decreasing, and E1 > -z - γ: Newton's method,
        // started left of the root, approaches it from the left.
        let mut z = -target - EULER_GAMMA;
        // below z = -40, E1 equals -z - γ to the last digit, and e^z eventually underflows
        let most = if z < -40.0 { 0 } else { 60 };
        for _ in 0..most {
            let y = z.exp();
            let correction = (e1(y) - target) * y.exp();
            z += correction;
            if correction.abs() < 1e-15 * (1.0 + z.abs()) {
                break;
            }
        }
        y0.ln() - z
    } else {
        // For y > 1, ln E1 is nearly linear in y.
        let mut y = (-target.ln()).clamp(1.0, y0.max(1.0));
        for _ in 0..60 {
            let value = e1(y);
            let correction = (value / target).ln() * y * value * y.exp();
            if !correction.is_finite() {
                // e^y overflows; -ln E1 equals y + ln y + 1/y to the sixth digit
                for _ in 0..4 {
                    y = -target.ln() - y.ln() - y.recip();
                }
                break;
            }
            y += correction;
            if correction.abs() < 1e-15 * y {
                break;
            }
        }
        (y0 / y).ln().max(0.0)
    }
}

/// Largest -y0 for [`decrement_by_entire_integral`].
const LARGEST_ENTIRE: f64 = 40.0;

/// Solves ∫₀^S exp(x e^{-s}) ds = S + Ein(x) - Ein(x e^{-S}) = q for S, with x > 0 and Ein(x) = Σ
/// xᵏ/(k k!). The integral is concave in S; Newton's method, started at 0, therefore approaches the
/// root from below.
fn decrement_by_entire_integral(q: f64, x: f64) -> f64 {
    let all = exponential_integral::entire(x);
    let mut decrement = 0.0_f64;
    for _ in 0..100 {
        let rest = x * (-decrement).exp();
        let integral = decrement + (all - exponential_integral::entire(rest));
        let correction = (q - integral) * (-rest).exp();
        decrement += correction;
        if correction <= 1e-15 * decrement {
            break;
        }
    }
    decrement
}

impl GurevichRabinovichFlow {
    /// Computes y0 = |σ0|/m and a = q e^{y0} of several cells.
    #[inline(always)]
    fn relative_steps(&self, stress: &[f64; LANES]) -> ([f64; LANES], [f64; LANES]) {
        let y0 = lanes!(|i| stress[i].abs() * self.inverse_activation_stress);
        let growth = elementary::exp(&y0);
        (y0, lanes!(|i| self.advance * growth[i]))
    }

    /// Computes y1/y0 from y0 = |σ0|/m.
    #[inline]
    fn factor(&self, y0: f64) -> f64 {
        let a = self.advance * y0.exp();
        if a * (1.0 + y0.abs()) < SERIES_LIMIT {
            1.0 + shrink_by_series::<MOST_TERMS>(a, y0)
        } else if self.advance > 0.0 {
            (-decrement_of_long_step(self.advance, y0)).exp()
        } else {
            1.0
        }
    }

    /// Number of equal parts into which a step must be divided for the series to be valid in each
    /// part; `None` if there are too many. The stress falls, so the first part has the largest a
    /// (1 + |y0|). The exact relaxation of the whole step is that of the parts in sequence.
    #[inline(always)]
    fn parts(&self, hardest: f64) -> Option<f64> {
        if hardest < SERIES_LIMIT {
            return Some(1.0);
        }
        let parts = (hardest / SERIES_LIMIT).ceil();
        // m < 0: the rate may rise as the stress falls, and a later part may have a larger a (1 +
        // |y0|) than the first
        (parts <= MOST_PARTS && self.inverse_activation_stress >= 0.0).then_some(parts)
    }

    /// Computes the changes cell by cell, for steps too long for the series.
    #[cold]
    #[inline(never)]
    fn change_cell_by_cell(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        lanes!(|i| self.relax(stress[i]) - stress[i])
    }
}

impl RelaxationFlow for GurevichRabinovichFlow {
    #[inline]
    fn relax(&self, stress: f64) -> f64 {
        stress * self.factor(stress.abs() * self.inverse_activation_stress)
    }

    #[inline(always)]
    fn change(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        let (y0, a) = self.relative_steps(stress);
        let hardest = hardest(&y0, &a);
        if hardest < LIMIT_OF_FIVE {
            lanes!(|i| stress[i] * shrink_by_series::<5>(a[i], y0[i]))
        } else if hardest < LIMIT_OF_SEVEN {
            lanes!(|i| stress[i] * shrink_by_series::<7>(a[i], y0[i]))
        } else if let Some(parts) = self.parts(hardest) {
            let relaxation = in_parts(&y0, &a, parts);
            lanes!(|i| stress[i] * relaxation.shrink[i])
        } else {
            self.change_cell_by_cell(stress)
        }
    }

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "the counter stays below `LANES`, the length of every array of cells; the law has two parameters of `MAX_PARAMETERS`"
    )]
    fn change_with_sensitivity(&self, stress: &[f64; LANES], parameters: usize) -> StressChange {
        let (y0, a) = self.relative_steps(stress);
        let hardest = hardest(&y0, &a);
        let Relaxation {
            shrink,
            mean_growth,
        } = if hardest < LIMIT_OF_FIVE {
            in_one_part::<5>(&y0, &a)
        } else if hardest < LIMIT_OF_SEVEN {
            in_one_part::<7>(&y0, &a)
        } else if let Some(parts) = self.parts(hardest) {
            in_parts(&y0, &a, parts)
        } else {
            return cell_by_cell(self, stress, parameters);
        };
        let inverse_reference = 1.0 / self.reference_stress;
        let mut result = StressChange::default();
        for i in 0..LANES {
            let (shrink, mean_growth) = (shrink[i], mean_growth[i]);
            let change = stress[i] * shrink;
            let relaxed = stress[i] + change;
            let growth = mean_growth * (y0[i] * shrink);
            // q e^{y1} = q e^{y0} e^{y1 - y0}
            let by_log_modulus = -relaxed * a[i] * (1.0 + growth);
            let by_inverse_m = relaxed * stress[i].abs() * shrink * mean_growth;
            result.stress[i] = change;
            result.by_stress[i] = shrink + growth + shrink * growth;
            result.by_log_modulus[i] = by_log_modulus;
            result.by_parameter[0][i] = by_inverse_m * inverse_reference - by_log_modulus;
            result.by_parameter[1][i] = by_log_modulus;
        }
        result
    }

    #[inline]
    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        let inverse_m = self.inverse_activation_stress;
        let y0 = stress.abs() * inverse_m;
        let factor = self.factor(y0);
        let relaxed = stress * factor;
        let y1 = y0 * factor;
        let by_log_modulus = -relaxed * y1.exp() * self.advance;
        // at constant η: dσ1/d(1/m) = σ1 (e^{y1 - y0} - 1) m, whose limit for 1/m -> 0 is σ1
        // (|σ1| - |σ0|)
        let drop = relaxed.abs() - stress.abs();
        let exponent = drop * inverse_m;
        let by_inverse_m = relaxed
            * drop
            * if exponent.abs() < 1e-12 {
                1.0
            } else {
                exponent.exp_m1() / exponent
            };
        // at constant r = F(σ_ref): ln η = ln σ_ref + β - ln r
        let by_sharpness = by_inverse_m / self.reference_stress - by_log_modulus;
        for (entry, by) in by_parameter.iter_mut().zip([by_sharpness, by_log_modulus]) {
            *entry = by;
        }
        RelaxedStress {
            stress: relaxed,
            by_stress: factor * (y1 - y0).exp(),
            by_log_modulus,
        }
    }
}

/// Ratios σ1/σ0 - 1 and (e^{y1 - y0} - 1)/(y1 - y0) of several cells.
struct Relaxation {
    shrink: [f64; LANES],
    mean_growth: [f64; LANES],
}

/// Returns the largest a (1 + |y0|) of several cells.
#[inline(always)]
fn hardest(y0: &[f64; LANES], a: &[f64; LANES]) -> f64 {
    elementary::largest(&lanes!(|i| a[i] * (1.0 + y0[i].abs())))
}

/// Largest number of parts into which a step is divided for the series; longer steps are solved
/// exactly, cell by cell.
const MOST_PARTS: f64 = 8.0;

/// Relaxes several cells by `TERMS` terms of the series.
#[inline(always)]
fn in_one_part<const TERMS: usize>(y0: &[f64; LANES], a: &[f64; LANES]) -> Relaxation {
    let shrink = lanes!(|i| shrink_by_series::<TERMS>(a[i], y0[i]));
    Relaxation {
        shrink,
        mean_growth: lanes!(|i| mean_growth_by_series::<TERMS>(y0[i] * shrink[i])),
    }
}

/// Relaxes several cells in equal parts; e^y is propagated from part to part by its own series.
#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "the counter stays below `LANES`, the length of every array of cells"
)]
fn in_parts(y0: &[f64; LANES], a: &[f64; LANES], parts: f64) -> Relaxation {
    let mut y = *y0;
    let per_part = 1.0 / parts;
    let mut step = lanes!(|i| a[i] * per_part);
    let (mut shrink, mut growth) = ([0.0; LANES], [0.0; LANES]);
    let mut left = parts;
    while left > 0.5 {
        for i in 0..LANES {
            let by = shrink_by_series::<MOST_TERMS>(step[i], y[i]);
            let drop = y[i] * by;
            let gain = drop * mean_growth_by_series::<MOST_TERMS>(drop);
            shrink[i] += by + shrink[i] * by;
            growth[i] += gain + growth[i] * gain;
            y[i] += drop;
            step[i] += step[i] * gain;
        }
        left -= 1.0;
    }
    let mean_growth = lanes!(|i| {
        let drop = y0[i] * shrink[i];
        if drop.abs() < 1e-12 {
            1.0
        } else {
            growth[i] / drop
        }
    });
    Relaxation {
        shrink,
        mean_growth,
    }
}

/// Computes (e^x - 1)/x by `TERMS` terms. |x| is below the limit of the same number of terms of
/// [`SERIES`], and the remainder is below 1e-14.
#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "`TERMS` is 5, 7 or `MOST_TERMS`, the number of coefficients"
)]
fn mean_growth_by_series<const TERMS: usize>(x: f64) -> f64 {
    /// 1/(k + 1)!
    const COEFFICIENTS: [f64; MOST_TERMS] = [
        1.0,
        1.0 / 2.0,
        1.0 / 6.0,
        1.0 / 24.0,
        1.0 / 120.0,
        1.0 / 720.0,
        1.0 / 5040.0,
        1.0 / 40_320.0,
        1.0 / 362_880.0,
    ];
    let (mut sum, mut k) = (0.0, TERMS);
    while k > 0 {
        k -= 1;
        sum = sum * x + COEFFICIENTS[k];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inelastic::battery::battery;
    use crate::inelastic::exponential_integral::GAUSS_LEGENDRE;

    #[test]
    fn the_flow_is_exact() {
        for sharpness in [-1.5, -1e-9, 0.0, 1e-9, 1e-4, 0.3, 1.4, 4.0] {
            battery(&MaxwellGurevichRabinovich::from_reference_rate(sharpness, 4.0, 10e6).unwrap());
        }
    }

    /// Computes y1/y0 - 1 without the series: ∫₀^S exp(p (1 - e^{-s})) ds = a, with the integral by
    /// quadrature, is solved for S by Newton's method.
    fn shrink_by_quadrature(a: f64, p: f64) -> f64 {
        // for S < 0.05, where pS < 0.1, the quadrature is exact to rounding
        let integrand = |s: f64| (-p * (-s).exp_m1()).exp();
        let mut decrement = a;
        for _ in 0..20 {
            let half = 0.5 * decrement;
            let area: f64 = GAUSS_LEGENDRE
                .iter()
                .map(|(node, weight)| {
                    weight * (integrand(half * (1.0 - node)) + integrand(half * (1.0 + node)))
                })
                .sum();
            decrement += (a - half * area) / integrand(decrement);
        }
        (-decrement).exp_m1()
    }

    #[test]
    fn each_number_of_terms_reaches_its_limit() {
        for p in [-8.0, -1.5, -0.2, 0.0, 1e-3, 0.3, 1.0, 2.0, 5.0, 12.0, 60.0] {
            let largest = |limit: f64| limit / (1.0 + f64::abs(p));
            for part in [1e-6, 1e-3, 0.1, 0.5, 0.9, 1.0] {
                let [five, seven, nine] = [LIMIT_OF_FIVE, LIMIT_OF_SEVEN, SERIES_LIMIT]
                    .map(|limit| part * largest(limit));
                for (found, a) in [
                    (shrink_by_series::<5>(five, p), five),
                    (shrink_by_series::<7>(seven, p), seven),
                    (shrink_by_series::<9>(nine, p), nine),
                ] {
                    let expected = shrink_by_quadrature(a, p);
                    // tolerance: 2e-13 from the truncation of the series, and some units of
                    // rounding of the quadrature
                    assert!(
                        (found / expected - 1.0).abs() < 2e-13,
                        "p {p}, a {a}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn neighbours_in_the_block_move_a_change_by_rounding_only() {
        use crate::inelastic::{InelasticLaw, MaxwellGurevichRabinovich, RelaxationFlow};

        let flow = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6)
            .unwrap()
            .flow(2.58e9, 5.85e-7);
        for stress in [1.0, 1e5, -2e6, 1e7] {
            let alone = flow.change(&[stress; LANES]);
            // these stresses require five, seven and nine terms, division into parts, and the
            // solution cell by cell
            for harder in [1.05e7, 1.4e7, 2.1e7, 3e7, 4e7, 8e7] {
                let mut cells = [stress; LANES];
                cells[LANES - 1] = harder;
                let together = flow.change(&cells);
                // tolerance: twice the largest truncation error of the series, and the rounding of
                // the stress in cells that are solved one by one
                let allowed = 4e-13 * alone[0].abs() + 2.0 * f64::EPSILON * stress.abs();
                for (alone, together) in alone.iter().zip(&together).take(LANES - 1) {
                    assert!(
                        (alone - together).abs() <= allowed,
                        "{stress} Pa beside {harder} Pa: {alone} {together}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_viscosity_that_grows_with_stress_takes_no_longer() {
        for x in [1e-9, 0.3, 2.0, 15.0, 40.0] {
            // a whole step equals its two parts in sequence; the longest second part lasts for a
            // million relaxation times
            for (first, second) in [(0.1, 0.4), (0.5, 30.0), (3.0, 1e6)] {
                let [first, second] = [first, second].map(|q| q * f64::exp(x));
                let whole = decrement_of_long_step(first + second, -x);
                let part = decrement_of_long_step(first, -x);
                let rest = decrement_of_long_step(second, -x * (-part).exp());
                assert!(
                    (whole / (part + rest) - 1.0).abs() < 1e-12,
                    "{x} {first}: {whole}"
                );
            }
        }
        // after 1e16 relaxation times, the viscosity η alone has determined the result
        let far = decrement_of_long_step(1e16, -3.0);
        assert!((far / 1e16 - 1.0).abs() < 1e-15, "{far}");
        assert!(decrement_of_long_step(f64::INFINITY, -3.0).is_infinite());
    }

    #[test]
    fn series_and_exact_relation_agree_at_the_limit_of_the_series() {
        // both solve the same equation; tolerance: the truncation of the series, below 1e-14, and
        // the rounding of E1
        for y0 in [1e-9, 1e-3, 0.1, 1.0, 4.0, 12.0] {
            let q = SERIES_LIMIT / ((1.0 + y0) * f64::exp(y0));
            let series = decrement_by_series(q * f64::exp(y0), y0);
            let exact = decrement_of_long_step(q, y0);
            assert!(
                (series - exact).abs() < 2e-14 * (1.0 + e1(y0)),
                "y0 {y0}: {series} {exact}"
            );
        }
    }
}
