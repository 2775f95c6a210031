//! Linearisation of one line about a given propagation coefficient.

use num_complex::Complex64;

use super::Projection;
use crate::multi_point::spectra::WhiteLine;
use crate::multi_point::uncertainty::GaugeError;

/// Linearisation of a line about a given γ, in units of its noise.
#[derive(Debug, Clone)]
pub(in super::super) struct About {
    /// Step from the given γ to the γ of the line [1/m].
    pub(in super::super) step: Complex64,
    /// Inverse of the variance of γ.
    pub(in super::super) information: f64,
    /// Change of γ due to each error [1/m].
    pub(in super::super) moves: Vec<Complex64>,
    /// Scalar products of the contributions of the errors to the residual, with each other (by
    /// rows). They are doubled because each part of a complex value has half the variance; so are
    /// `gradient`, the products with the residual, and `square`, the square of the residual.
    pub(in super::super) normal: Vec<f64>,
    pub(in super::super) gradient: Vec<f64>,
    pub(in super::super) square: f64,
}

impl Projection {
    /// Linearises the line about a rod with the propagation coefficient `gamma`: returns the
    /// Gauss-Newton step to the γ of the measured values, the inverse of the variance of this γ,
    /// and the products of the residual with the errors of the gauges. Each of `errors` gives a
    /// gauge, the factor on its values q and the factor on their slope q'.
    pub(in super::super) fn about(
        &mut self,
        gamma: Complex64,
        line: &WhiteLine,
        errors: &[GaugeError],
    ) -> Option<About> {
        let objective = self.evaluate(gamma, line)?;
        let step = objective.gradient / objective.information;
        let n = self.n_gauges();
        let count = line.values.len();
        let (mut residuals, mut tangents) = (Vec::with_capacity(count), Vec::with_capacity(count));
        // for each error, its contribution to the values, projected by P
        let mut added = vec![Vec::with_capacity(count); errors.len()];
        for values in line.values.chunks_exact(n) {
            let y = self.coefficients(values.iter().copied());
            let c = self.amplitudes(y);
            self.set_tangent(c);
            tangents.extend_from_slice(&self.tangent);
            let [q1, q2] = &self.basis;
            for (value, (q1, q2)) in values.iter().zip(q1.iter().zip(q2)) {
                residuals.push(value - y[0] * q1 - y[1] * q2);
            }
            for (error, added) in errors.iter().zip(&mut added) {
                let at =
                    |column: &[Complex64]| column.get(error.gauge).copied().unwrap_or_default();
                let (forward, backward) = (at(&self.forward) * c[0], at(&self.backward) * c[1]);
                let value = error.by_value * (forward + backward)
                    + error.by_slope * gamma * (backward - forward);
                let (first, second) = (at(q1), at(q2));
                added.extend((0..n).zip(q1.iter().zip(q2)).map(|(gauge, (q1, q2))| {
                    let own = if gauge == error.gauge {
                        value
                    } else {
                        Complex64::ZERO
                    };
                    own - (first.conj() * q1 + second.conj() * q2) * value
                }));
            }
        }
        let information = objective.information;
        let along = |values: &[Complex64]| -> Complex64 {
            let products = tangents
                .iter()
                .zip(values)
                .map(|(d, value)| d.conj() * value);
            products.sum::<Complex64>() / information
        };
        let moves: Vec<Complex64> = added.iter().map(|added| along(added)).collect();
        // subtract the part that is explained by a change of γ
        for (added, moves) in added.iter_mut().zip(&moves) {
            for (value, d) in added.iter_mut().zip(&tangents) {
                *value -= moves * d;
            }
        }
        for (residual, d) in residuals.iter_mut().zip(&tangents) {
            *residual -= step * d;
        }
        let product = |a: &[Complex64], b: &[Complex64]| -> f64 {
            2.0 * a.iter().zip(b).map(|(a, b)| (a.conj() * b).re).sum::<f64>()
        };
        Some(About {
            step,
            information,
            moves,
            normal: added
                .iter()
                .flat_map(|a| added.iter().map(move |b| product(a, b)))
                .collect(),
            gradient: added.iter().map(|a| product(a, &residuals)).collect(),
            square: product(&residuals, &residuals),
        })
    }
}
