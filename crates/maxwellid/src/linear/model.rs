//! The direct problem of a linear rod with its derivatives.

use num_complex::Complex64;
use rodwave::band_limited::VelocityHistory;

use super::LinearLaw;
use super::laplace_line::LaplaceLine;

/// A rod of a linear law, ready for identification; parameters θ = (ln E, p).
#[derive(Debug, Clone)]
pub struct LinearModel<L> {
    law: L,
}

/// What the response is needed for.
#[derive(Clone, Copy)]
pub(crate) struct Record<'a> {
    /// Distance of the sections \[m\].
    pub(crate) length: f64,
    /// Density [kg/m³].
    pub(crate) density: f64,
    pub(crate) sampling_rate_hz: f64,
    pub(crate) excitation: &'a dyn VelocityHistory,
    /// Samples over which the excitation is known, and the response wanted.
    pub(crate) known: usize,
    pub(crate) wanted: usize,
}

impl<L: LinearLaw> LinearModel<L> {
    /// The model of this law.
    #[must_use]
    pub fn new(law: L) -> Self {
        Self { law }
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &L {
        &self.law
    }

    /// v_r [m/s] at the samples of the record.
    pub(crate) fn velocity(&self, record: Record<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let (ln_modulus, of_law) = parameters.split_first()?;
        let line = LaplaceLine::new(record.known, record.sampling_rate_hz);
        let mut lines = line.transform(record.excitation, record.known)?;
        for (value, s) in lines.iter_mut().zip(line.arguments()) {
            let shape = self.law.shape(s, of_law)?;
            *value *= secant_and_tangent(propagation(record, *ln_modulus, s, shape)).0;
        }
        finite(line.history(&mut lines, record.wanted)?)
    }

    /// v_r [m/s] and its derivatives by ln E and p.
    pub(crate) fn velocity_with_derivatives(
        &self,
        record: Record<'_>,
        parameters: &[f64],
    ) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let (ln_modulus, of_law) = parameters.split_first()?;
        let line = LaplaceLine::new(record.known, record.sampling_rate_hz);
        let mut lines = line.transform(record.excitation, record.known)?;
        let mut derivatives = vec![vec![Complex64::ZERO; lines.len()]; parameters.len()];
        let mut by_law = vec![Complex64::ZERO; of_law.len()];
        for (k, (value, s)) in lines.iter_mut().zip(line.arguments()).enumerate() {
            let shape = self.law.shape_with_derivatives(s, of_law, &mut by_law)?;
            let gamma_length = propagation(record, *ln_modulus, s, shape);
            let (secant, tangent) = secant_and_tangent(gamma_length);
            *value *= secant;
            // ∂(γL)/∂p = -½ γL ∂ln E/∂p
            let by_ln_modulus = 0.5 * *value * tangent * gamma_length;
            let (first, rest) = derivatives.split_first_mut()?;
            first[k] = by_ln_modulus;
            for (column, by_parameter) in rest.iter_mut().zip(&by_law) {
                column[k] = by_ln_modulus * by_parameter / shape;
            }
        }
        let velocity = finite(line.history(&mut lines, record.wanted)?)?;
        let columns = derivatives
            .iter_mut()
            .map(|column| finite(line.history(column, record.wanted)?))
            .collect::<Option<_>>()?;
        Some((velocity, columns))
    }
}

/// γL = sL (ρ/E)^½ with Re γL >= 0.
fn propagation(record: Record<'_>, ln_modulus: f64, s: Complex64, shape: Complex64) -> Complex64 {
    let slowness = (record.density * (-ln_modulus).exp() / shape).sqrt();
    let gamma_length = s * slowness * record.length;
    if gamma_length.re < 0.0 {
        -gamma_length
    } else {
        gamma_length
    }
}

/// 1/cosh z and tanh z for Re z >= 0, without overflow.
fn secant_and_tangent(z: Complex64) -> (Complex64, Complex64) {
    let once = (-z).exp();
    let twice = once * once;
    let denominator = (1.0 + twice).inv();
    (2.0 * once * denominator, (1.0 - twice) * denominator)
}

fn finite(history: Vec<f64>) -> Option<Vec<f64>> {
    history.iter().all(|v| v.is_finite()).then_some(history)
}
