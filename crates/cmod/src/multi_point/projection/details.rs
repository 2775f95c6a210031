//! Details of one line at its solution: waves with their covariance, and second-order errors.

use num_complex::Complex64;

use super::{Objective, Projection, by_end_length};
use crate::multi_point::spectra::WhiteLine;

/// Waves of one test and their derivative with respect to γ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct TestWaves {
    /// Amplitude of the wave along +x at the first gauge, and of the wave along -x at the last
    /// gauge.
    pub(in super::super) amplitudes: [Complex64; 2],
    /// Product A⁺A'c, which is -dc/dγ.
    pub(in super::super) drift: [Complex64; 2],
}

/// Details of a line at its solution.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Details {
    pub(in super::super) objective: Objective,
    /// Matrix (A^H A)⁻¹: its two diagonal elements and its element (1, 2).
    pub(in super::super) waves_covariance: (f64, f64, Complex64),
    /// Second-order error of γ divided by |δγ|² [m].
    pub(in super::super) curvature: f64,
    /// Second-order part q of the residual along its tangent, d^H q, where the residual is P b - δγ
    /// d - δγ² q.
    pub(in super::super) along: Complex64,
}

impl Details {
    /// Returns the point at which the residual vanishes again to second order, γ - d^H d/d^H q. For
    /// a line with as many unknowns as values this is γ - 2g'/g'' for the ratio g(γ) that it
    /// solves.
    pub(in super::super) fn mirrored(&self, gamma: Complex64) -> Complex64 {
        gamma - self.objective.information / self.along
    }
}

impl Projection {
    /// Returns the details at the solution `gamma` and the waves of every test. `at` is the
    /// objective if it was last evaluated at `gamma` or sufficiently near; if `at` is `None`, the
    /// objective is evaluated here.
    pub(in super::super) fn details(
        &mut self,
        gamma: Complex64,
        at: Option<Objective>,
        line: &WhiteLine,
    ) -> Option<(Details, Vec<TestWaves>)> {
        let objective = match at {
            Some(objective) => objective,
            None => self.evaluate(gamma, line)?,
        };
        let mut waves = Vec::with_capacity(line.n_tests());
        let mut bend = 0.0;
        let mut along = Complex64::ZERO;
        for values in line.values.chunks_exact(self.n_gauges()) {
            let c = self.waves_of(values);
            let w = self.set_tangent(c);
            let drift = self.amplitudes(w);
            // P(A''c/2 - A'A⁺A'c): second-order change of the residual, beyond the tangent d, for a
            // change of γ by 1
            let [first, second] = &self.slope_columns;
            let columns = first.iter().zip(second);
            for (((s, (f, b)), x), y) in self
                .slope
                .iter_mut()
                .zip(columns)
                .zip(&self.from_first)
                .zip(&self.to_last)
            {
                *s = f * (-0.5 * x * c[0] - drift[0]) + b * (-0.5 * y * c[1] - drift[1]);
            }
            // additional second derivative of the row of a mass, which is at x_n, compared with the
            // second derivative of a gauge row
            let rows = self.slope.iter_mut().zip(&self.forward);
            for ((s, f), (x, length)) in rows.zip(self.from_first.iter().zip(&self.end_lengths)) {
                if *length > 0.0 {
                    let [of_f, _] = by_end_length(*length, gamma);
                    *s -= f * of_f * (0.5 * x * length / gamma) * c[0];
                }
            }
            let z = self.coefficients(self.slope.iter().copied());
            let [q1, q2] = &self.basis;
            let slopes = self.slope.iter().zip(&self.tangent);
            for ((s, d), (q1, q2)) in slopes.zip(q1.iter().zip(q2)) {
                let q = s - z[0] * q1 - z[1] * q2;
                bend += q.norm_sqr();
                along += d.conj() * q;
            }
            waves.push(TestWaves {
                amplitudes: c,
                drift,
            });
        }
        let (r11, r12, r22) = self.r;
        let backward = (r22 * r22).recip();
        let shared = -r12 * backward / r11;
        let forward = (1.0 + r12.norm_sqr() * backward) / (r11 * r11);
        let details = Details {
            objective,
            waves_covariance: (forward, backward, shared),
            curvature: (bend / objective.information).sqrt(),
            along,
        };
        Some((details, waves))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two waves at three equidistant gauges.
    fn three_gauges(gamma: Complex64) -> WhiteLine {
        let values: Vec<Complex64> = [0.0, 0.1, 0.2]
            .iter()
            .map(|x| (-gamma * x).exp() + 0.4 * (gamma * x).exp())
            .collect();
        WhiteLine::of_values(values, vec![1.0; 3])
    }

    /// Compares the curvature, |q|/|d| in |P(γ+δ)b| = |δ d + δ² q + ...|, with the curvature of the
    /// closed form for three equidistant gauges.
    #[test]
    fn the_curvature_is_the_second_order_of_the_residual() {
        let mut projection = Projection::new(&[0.0, 0.1, 0.2]);
        let gamma = Complex64::new(0.9, 28.0);
        let line = three_gauges(gamma);
        let (details, _) = projection.details(gamma, None, &line).unwrap();
        // Three equidistant gauges solve cosh γa = Ψ: δΨ = a sinh γa δγ + a² cosh γa δγ²/2.
        // tolerance: P also depends on γ, which adds a term of the order of the aperture to q; near
        // ka = π this term is small compared with the first.
        let coth = (gamma * 0.1).cosh() / (gamma * 0.1).sinh();
        assert!((details.curvature / (0.05 * coth.norm()) - 1.0).abs() < 0.2);
    }
}
