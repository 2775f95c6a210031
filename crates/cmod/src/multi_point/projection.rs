//! Fit of one line by variable projection: the two waves are eliminated, and the residual is
//! minimised with respect to γ.
//!
//! Let b be the values of the gauges and A(γ) = [e^{-γx}, e^{γx}], both divided by the noise of
//! each gauge. The waves that fit b best are c = A⁺b. The misfit V and its Gauss-Newton step are
//!
//! ```text
//! V(γ) = |P b|² ,    P = I - A A⁺ ,    d = P A'c ,    γ ← γ + d^H P b / d^H d
//! ```
//!
//! The amplitude of each wave refers to the gauge at which the wave enters, so that neither column
//! grows. This multiplies the columns by constants and leaves P, d and the step unchanged. For
//! several tests, V, d^H P b and d^H d are sums over the tests.

mod details;
mod linearised;

pub(super) use details::{Details, TestWaves};

use num_complex::Complex64;

use super::spectra::WhiteLine;
use super::uncertainty::GaugeInfluence;
use crate::estimate::Termination;

/// Maximum number of Gauss-Newton steps on one line; a line that needs more has no minimum near its
/// start.
const MOST_STEPS: u32 = 60;
/// Maximum number of halvings of one step.
const MOST_HALVINGS: u32 = 12;

/// Misfit V and its derivatives at one γ.
#[derive(Debug, Clone, Copy)]
pub(super) struct Objective {
    /// Misfit V.
    pub(super) misfit: f64,
    /// Information d^H d, the inverse of the variance of γ.
    pub(super) information: f64,
    /// Gradient d^H P b.
    gradient: Complex64,
}

/// Minimum of the misfit V.
#[derive(Debug, Clone, Copy)]
pub(super) struct Minimum {
    pub(super) gamma: Complex64,
    /// Objective at γ, or at a negligible distance from it; `None` if another γ was evaluated
    /// later.
    pub(super) evaluated_at: Option<Objective>,
    pub(super) termination: Termination,
}

/// Orthonormal columns at one γ, with working memory for a row of gauges.
pub(super) struct Projection {
    /// Distances x - x₁ from the first gauge and x_n - x to the last.
    from_first: Vec<f64>,
    to_last: Vec<f64>,
    /// Sign of the forward wave in each row: -1 in the row of a free end at which the slope of a
    /// motion is 0.
    forward_signs: Vec<f64>,
    /// Length ℓ \[m\] of rod with the same mass as the mass attached at each row, 0 at a gauge. In
    /// the row of a mass the two waves have the factors 1 - ℓγ and 1 + ℓγ.
    end_lengths: Vec<f64>,
    gamma: Complex64,
    aperture: f64,
    forward: Vec<Complex64>,
    backward: Vec<Complex64>,
    slope_columns: [Vec<Complex64>; 2],
    basis: [Vec<Complex64>; 2],
    /// Product A'c of one test.
    slope: Vec<Complex64>,
    /// Tangent d of one test.
    tangent: Vec<Complex64>,
    /// Elements r₁₁, r₁₂, r₂₂ of the upper triangular matrix R in A = [q₁, q₂] R.
    r: (f64, Complex64, f64),
}

impl Projection {
    pub(super) fn new(positions: &[f64]) -> Self {
        Self::with_last_row(positions, false, 0.0)
    }

    /// Creates the projection. The last row is the free end if one is used, otherwise the last
    /// gauge (`is_slope` false, `end_length` 0). The force at the end accelerates a mass equal to
    /// that of a length ℓ = `end_length` \[m\] of rod:
    ///
    /// ```text
    /// c₁ e^{-γL} (1 - ℓγ) ± c₂ e^{γL} (1 + ℓγ) = 0 ,
    /// ```
    ///
    /// with + for gauges of strain and - for gauges of motion (`is_slope`).
    pub(super) fn with_last_row(positions: &[f64], is_slope: bool, end_length: f64) -> Self {
        let first = positions.first().copied().unwrap_or_default();
        let last = positions.last().copied().unwrap_or_default();
        let column = || vec![Complex64::ZERO; positions.len()];
        let mut forward_signs = vec![1.0; positions.len()];
        if let Some(sign) = forward_signs.last_mut().filter(|_| is_slope) {
            *sign = -1.0;
        }
        let mut end_lengths = vec![0.0; positions.len()];
        if let Some(length) = end_lengths.last_mut() {
            *length = end_length;
        }
        Self {
            forward_signs,
            end_lengths,
            gamma: Complex64::ZERO,
            from_first: positions.iter().map(|x| x - first).collect(),
            to_last: positions.iter().map(|x| last - x).collect(),
            aperture: last - first,
            forward: column(),
            backward: column(),
            slope_columns: [column(), column()],
            basis: [column(), column()],
            slope: column(),
            tangent: column(),
            r: (1.0, Complex64::ZERO, 1.0),
        }
    }

    pub(super) fn n_gauges(&self) -> usize {
        self.from_first.len()
    }

    /// Sets the columns at γ; returns `None` if the gauges cannot separate the two waves, or if γ
    /// overflows.
    fn set(&mut self, gamma: Complex64, weights: &[f64]) -> Option<()> {
        let whole = (-gamma * self.aperture).exp();
        self.gamma = gamma;
        let mut forward_power = 0.0;
        let mut backward_power = 0.0;
        let mut shared = Complex64::ZERO;
        for ((((x, sign), length), w), (f, b)) in self
            .from_first
            .iter()
            .zip(&self.forward_signs)
            .zip(&self.end_lengths)
            .zip(weights)
            .zip(self.forward.iter_mut().zip(&mut self.backward))
        {
            let wave = (-gamma * x).exp();
            *f = wave * (sign * w);
            // e^{-γ(x_n - x)}: it follows from the exponential of the other column
            *b = whole * wave.conj() * (w / wave.norm_sqr());
            if *length > 0.0 {
                *f *= 1.0 - length * gamma;
                *b *= 1.0 + length * gamma;
            }
            forward_power += f.norm_sqr();
            backward_power += b.norm_sqr();
            shared += f.conj() * *b;
        }
        let r11 = forward_power.sqrt();
        let r12 = shared / r11;
        let scale = r11.recip();
        let [q1, q2] = &mut self.basis;
        let mut rest = 0.0;
        for ((f, b), (q1, q2)) in self
            .forward
            .iter()
            .zip(&self.backward)
            .zip(q1.iter_mut().zip(q2.iter_mut()))
        {
            *q1 = f * scale;
            *q2 = b - r12 * *q1;
            rest += q2.norm_sqr();
        }
        let distinguishable = rest.is_finite() && rest > 1e-26 * backward_power;
        let r22 = rest.sqrt();
        let scale = r22.recip();
        for q2 in q2.iter_mut() {
            *q2 *= scale;
        }
        self.r = (r11, r12, r22);
        distinguishable.then_some(())
    }

    fn set_slopes(&mut self) {
        let [first, second] = &mut self.slope_columns;
        for ((s, f), x) in first.iter_mut().zip(&self.forward).zip(&self.from_first) {
            *s = f * -x;
        }
        for ((s, b), x) in second.iter_mut().zip(&self.backward).zip(&self.to_last) {
            *s = b * -x;
        }
        let columns = self.forward.iter().zip(&self.backward);
        let slopes = first.iter_mut().zip(second);
        for ((length, (f, b)), (on_forward, on_backward)) in
            self.end_lengths.iter().zip(columns).zip(slopes)
        {
            if *length > 0.0 {
                let [of_f, of_b] = by_end_length(*length, self.gamma);
                *on_forward += f * of_f * length / self.gamma;
                *on_backward += b * of_b * length / self.gamma;
            }
        }
    }

    fn coefficients(&self, vector: impl Iterator<Item = Complex64>) -> [Complex64; 2] {
        let [q1, q2] = &self.basis;
        let mut y = [Complex64::ZERO; 2];
        for (v, (q1, q2)) in vector.zip(q1.iter().zip(q2)) {
            y[0] += q1.conj() * v;
            y[1] += q2.conj() * v;
        }
        y
    }

    /// Returns the amplitudes c = A⁺b of the waves of one test.
    fn waves_of(&self, values: &[Complex64]) -> [Complex64; 2] {
        self.amplitudes(self.coefficients(values.iter().copied()))
    }

    /// Returns R⁻¹ y.
    fn amplitudes(&self, y: [Complex64; 2]) -> [Complex64; 2] {
        let (r11, r12, r22) = self.r;
        let backward = y[1] / r22;
        [(y[0] - r12 * backward) / r11, backward]
    }

    /// Sets `slope` to A'c and returns its coefficients.
    fn set_slope(&mut self, c: [Complex64; 2]) -> [Complex64; 2] {
        let [first, second] = &self.slope_columns;
        for (s, (f, b)) in self.slope.iter_mut().zip(first.iter().zip(second)) {
            *s = f * c[0] + b * c[1];
        }
        self.coefficients(self.slope.iter().copied())
    }

    /// Sets `slope` to A'c and `tangent` to d = P A'c, and returns the coefficients of A'c.
    fn set_tangent(&mut self, c: [Complex64; 2]) -> [Complex64; 2] {
        let w = self.set_slope(c);
        let [q1, q2] = &self.basis;
        let slopes = self.slope.iter().zip(q1.iter().zip(q2));
        for (d, (slope, (q1, q2))) in self.tangent.iter_mut().zip(slopes) {
            *d = slope - w[0] * q1 - w[1] * q2;
        }
        w
    }

    /// Returns the misfit V without its derivatives.
    pub(super) fn misfit(&mut self, gamma: Complex64, line: &WhiteLine) -> Option<f64> {
        self.set(gamma, &line.weights)?;
        let [q1, q2] = &self.basis;
        let mut misfit = 0.0;
        for values in line.values.chunks_exact(self.n_gauges()) {
            let y = self.coefficients(values.iter().copied());
            for (value, (q1, q2)) in values.iter().zip(q1.iter().zip(q2)) {
                misfit += (value - y[0] * q1 - y[1] * q2).norm_sqr();
            }
        }
        misfit.is_finite().then_some(misfit)
    }

    /// Returns the misfit V, the information and the gradient at γ.
    pub(super) fn evaluate(&mut self, gamma: Complex64, line: &WhiteLine) -> Option<Objective> {
        self.set(gamma, &line.weights)?;
        self.set_slopes();
        let mut objective = Objective {
            misfit: 0.0,
            information: 0.0,
            gradient: Complex64::ZERO,
        };
        for values in line.values.chunks_exact(self.n_gauges()) {
            let y = self.coefficients(values.iter().copied());
            let w = self.set_slope(self.amplitudes(y));
            let [q1, q2] = &self.basis;
            for ((value, slope), (q1, q2)) in values.iter().zip(&self.slope).zip(q1.iter().zip(q2))
            {
                let residual = value - y[0] * q1 - y[1] * q2;
                let d = slope - w[0] * q1 - w[1] * q2;
                objective.misfit += residual.norm_sqr();
                objective.information += d.norm_sqr();
                objective.gradient += d.conj() * residual;
            }
        }
        (objective.misfit.is_finite() && objective.information.is_finite()).then_some(objective)
    }

    /// Minimises V by Gauss-Newton steps with halving from `start`; returns `None` if γ cannot be
    /// determined.
    ///
    /// The iteration ends when the step is a hundredth of the standard error estimated from the
    /// residuals, or at the level of rounding. This last step is still taken; the error that then
    /// remains is this step times a factor of the order of the relative noise.
    pub(super) fn minimise(&mut self, start: Complex64, line: &WhiteLine) -> Option<Minimum> {
        let mut gamma = start;
        let mut now = self.evaluate(gamma, line)?;
        let rounding = 16.0 * f64::EPSILON * line.power.sqrt();
        for iterations in 1..=MOST_STEPS {
            if now.information <= 0.0 {
                return None;
            }
            let mut step = now.gradient / now.information;
            let moved = step.norm() * now.information.sqrt();
            let negligible = step.norm() <= 1e-12 * gamma.norm()
                || moved <= 1e-2 * now.misfit.sqrt()
                || moved <= rounding;
            let termination = Termination::Converged {
                iterations,
                residual: now.misfit.sqrt(),
            };
            if negligible {
                return Some(Minimum {
                    gamma: gamma + step,
                    evaluated_at: Some(now),
                    termination,
                });
            }
            // The model varies with the phase over the aperture, so no step exceeds one radian.
            let most = self.aperture.recip();
            if step.norm() > most {
                step *= most / step.norm();
            }
            let mut halvings = 0;
            loop {
                if let Some(next) = self.evaluate(gamma + step, line)
                    && next.misfit <= now.misfit
                {
                    gamma += step;
                    now = next;
                    break;
                }
                halvings += 1;
                if halvings > MOST_HALVINGS {
                    return Some(lost(gamma, &now, iterations));
                }
                step *= 0.5;
            }
        }
        Some(lost(gamma, &now, MOST_STEPS))
    }

    /// Returns the contributions of the gauges to d^H d at `gamma`. The noise of each gauge
    /// contributes to the variance of γ in the same proportions.
    pub(super) fn shares(&mut self, gamma: Complex64, line: &WhiteLine) -> Option<Vec<f64>> {
        self.set(gamma, &line.weights)?;
        self.set_slopes();
        let mut shares = vec![0.0; self.n_gauges()];
        for values in line.values.chunks_exact(self.n_gauges()) {
            self.set_tangent(self.waves_of(values));
            for (share, d) in shares.iter_mut().zip(&self.tangent) {
                *share += d.norm_sqr();
            }
        }
        Some(shares)
    }

    /// Returns the influence of each gauge on the solution `gamma`: an additional value δb changes
    /// γ by d^H δb/d^H d, where δb is q' dx for an offset dx of the position and q u for a relative
    /// error u of the sensitivity. The same applies to a change of the length of rod that
    /// represents the mass on the end.
    pub(super) fn influence(
        &mut self,
        gamma: Complex64,
        line: &WhiteLine,
    ) -> Option<Vec<GaugeInfluence>> {
        let information = self.evaluate(gamma, line)?.information;
        let mut influence = vec![GaugeInfluence::default(); self.n_gauges()];
        for values in line.values.chunks_exact(self.n_gauges()) {
            let c = self.waves_of(values);
            self.set_tangent(c);
            for ((((of_gauge, d), forward), backward), length) in influence
                .iter_mut()
                .zip(&self.tangent)
                .zip(&self.forward)
                .zip(&self.backward)
                .zip(&self.end_lengths)
            {
                let part = d.conj() / information;
                of_gauge.position += part * gamma * (backward * c[1] - forward * c[0]);
                of_gauge.scale += part * (backward * c[1] + forward * c[0]);
                let [of_f, of_b] = by_end_length(*length, gamma);
                of_gauge.end_length -= part * (of_b * backward * c[1] + of_f * forward * c[0]);
            }
        }
        Some(influence)
    }
}

/// Returns the derivatives of ln(1 - ℓγ) and ln(1 + ℓγ) with respect to ℓ [1/m].
fn by_end_length(length: f64, gamma: Complex64) -> [Complex64; 2] {
    [
        -gamma / (1.0 - length * gamma),
        gamma / (1.0 + length * gamma),
    ]
}

fn lost(gamma: Complex64, now: &Objective, iterations: u32) -> Minimum {
    Minimum {
        gamma,
        evaluated_at: None,
        termination: Termination::LostPatience {
            iterations,
            residual: now.misfit.sqrt(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_told_apart_is_refused() {
        let mut projection = Projection::new(&[0.0, 0.1, 0.2]);
        let line = WhiteLine::of_values(vec![Complex64::ONE; 3], vec![1.0; 3]);
        assert!(projection.evaluate(Complex64::ZERO, &line).is_none());
        let half_waves = Complex64::new(0.0, std::f64::consts::PI / 0.1);
        assert!(projection.evaluate(half_waves, &line).is_none());
        assert!(
            projection
                .evaluate(Complex64::new(f64::NAN, 1.0), &line)
                .is_none()
        );
        assert!(
            projection
                .evaluate(Complex64::new(1e5, 1.0), &line)
                .is_none()
        );
    }
}
