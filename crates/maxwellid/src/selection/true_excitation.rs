//! The excitation is measured too: the covariance of the residual, and the excitation as the response suggests it.
//!
//! With measured excitation x and response y, both with noise, and the rod's response R(θ, ξ) to the true excitation ξ, the
//! most probable ξ for given θ is eliminated:
//!
//! ```text
//! min_ξ |y - R(θ, ξ)|²/σ_r² + |x - ξ|²/σ_e² = rᵀ C⁻¹ r ,    r = y - R(θ, x) ,    C = σ_r² I + σ_e² H Hᵀ ,    H = ∂R/∂ξ ,
//! ξ̂ = x + σ_e² Hᵀ C⁻¹ r ,    gradient = -2 rᵀ C⁻¹ ∂R(θ, ξ̂)/∂θ .
//! ```
//!
//! The derivatives are taken at ξ̂, not at x: noise in x would otherwise reward every θ that damps it, which is how a law "finds"
//! losses at high frequency in noise alone. H and ξ̂ stay during a fit and are renewed after it, until nothing changes.

use faer::linalg::solvers::Llt;
use faer::{Mat, Side};
use rodwave::band_limited::SampledHistory;

use super::noise::NoiseLevels;
use crate::model::{DrivenRod, RodModel};
use crate::test::RodTest;

/// Samples between excitations for which the response of a nonlinear rod to a small disturbance is computed; those between
/// are shifted. The load changes over some ten samples.
const COLUMN_STEP: usize = 8;

/// Disturbance of a sample of the excitation of a nonlinear rod, over V0: of the size of noise.
const DISTURBANCE: f64 = 0.01;

/// Longest cell for the response to disturbances \[m\]: per cents of the noise do not matter.
const CELL: f64 = 8e-3;

/// One test as seen with the most probable excitation.
#[derive(Debug, Clone)]
pub(crate) struct TrueExcitation {
    samples: Vec<f64>,
    history: SampledHistory,
    /// y + H (ξ̂ - x): R(θ, ξ̂) less this is -r to first order.
    target: Vec<f64>,
    /// Rows of the lower triangle of L, C = L Lᵀ, over V0².
    factor: Vec<Vec<f64>>,
    times: Vec<f64>,
    length: f64,
    density: f64,
    sampling_rate_hz: f64,
    pub(crate) impact_velocity: f64,
}

impl TrueExcitation {
    /// The measured excitation, with a covariance as if the rod only doubled it.
    pub(crate) fn measured(test: &RodTest, noise: NoiseLevels) -> Self {
        let times = test.times();
        let level = (2.0 * noise.excitation).hypot(noise.response);
        let factor = (0..times.len())
            .map(|i| {
                let mut row = vec![0.0; i + 1];
                row[i] = level;
                row
            })
            .collect();
        Self {
            samples: test.excitation_samples.clone(),
            history: test.excitation.clone(),
            target: test.response().to_vec(),
            factor,
            times,
            length: test.length,
            density: test.density,
            sampling_rate_hz: test.sampling_rate_hz,
            impact_velocity: test.impact_velocity,
        }
    }

    /// C and ξ̂ of `model` at θ; `None` where the model does not exist.
    pub(crate) fn estimate(
        test: &RodTest,
        noise: NoiseLevels,
        model: &dyn RodModel,
        parameters: &[f64],
        cell: f64,
    ) -> Option<Self> {
        let measured = Self::measured(test, noise);
        let count = measured.times.len();
        let wanted = Mat::from_fn(count, 1, |i, _| test.response()[i]);
        let simulated = model.response(&measured.rod(cell), parameters)?;
        let residual = Mat::from_fn(count, 1, |i, _| wanted[(i, 0)] - simulated[i]);
        let kernel = disturbances(&measured, model, parameters)?;
        let mut covariance = &kernel * kernel.transpose();
        let (of_excitation, of_response) = (noise.excitation.powi(2), noise.response.powi(2));
        for j in 0..count {
            for i in 0..count {
                covariance[(i, j)] *= of_excitation;
            }
            covariance[(j, j)] += of_response;
        }
        let cholesky = Llt::new(covariance.as_ref(), Side::Lower).ok()?;
        let solved = faer::linalg::solvers::Solve::solve(&cholesky, &residual);
        let change = kernel.transpose() * &solved;
        let shift = &kernel * &change;
        let samples: Vec<f64> = measured
            .samples
            .iter()
            .enumerate()
            .map(|(m, x)| x + of_excitation * change[(m, 0)])
            .collect();
        let lower = cholesky.L();
        Some(Self {
            history: SampledHistory::new(&samples, test.sampling_rate_hz).ok()?,
            samples,
            target: (0..count)
                .map(|i| wanted[(i, 0)] + of_excitation * shift[(i, 0)])
                .collect(),
            factor: (0..count)
                .map(|i| (0..=i).map(|j| lower[(i, j)]).collect())
                .collect(),
            ..measured
        })
    }

    /// The rod driven by ξ̂.
    pub(crate) fn rod(&self, cell: f64) -> DrivenRod<'_> {
        DrivenRod {
            length: self.length,
            density: self.density,
            sampling_rate_hz: self.sampling_rate_hz,
            samples: &self.samples,
            excitation: &self.history,
            times: &self.times,
            cell,
        }
    }

    /// Number of samples compared.
    pub(crate) fn count(&self) -> usize {
        self.times.len()
    }

    /// What the simulated response to ξ̂ is compared with [m/s].
    pub(crate) fn target(&self) -> &[f64] {
        &self.target
    }

    /// L⁻¹ u/V0 in place.
    pub(crate) fn whiten(&self, values: &mut [f64]) {
        for value in &mut *values {
            *value /= self.impact_velocity;
        }
        for (i, row) in self.factor.iter().enumerate() {
            let (before, here) = values.split_at_mut(i);
            if let Some((own, left)) = row.split_last() {
                let known: f64 = left.iter().zip(before.iter()).map(|(l, v)| l * v).sum();
                here[0] = (here[0] - known) / own;
            }
        }
    }
}

/// H: response at the samples of the window, by samples of the excitation.
fn disturbances(
    test: &TrueExcitation,
    model: &dyn RodModel,
    parameters: &[f64],
) -> Option<Mat<f64>> {
    let (rows, columns) = (test.times.len(), test.samples.len());
    let disturbed = |samples: &[f64]| -> Option<Vec<f64>> {
        let excitation = SampledHistory::new(samples, test.sampling_rate_hz).ok()?;
        let rod = DrivenRod {
            samples,
            excitation: &excitation,
            ..test.rod(CELL)
        };
        model.response(&rod, parameters)
    };
    let mut kernels: Vec<(usize, Vec<f64>)> = Vec::new();
    if model.is_linear() {
        // far enough from the beginning for the interpolation to reach ahead
        let at = SampledHistory::HALF_WIDTH.min(columns - 1);
        let mut samples = vec![0.0; columns];
        samples[at] = 1.0;
        kernels.push((at, disturbed(&samples)?));
    } else {
        let plain = disturbed(&test.samples)?;
        let size = DISTURBANCE * test.impact_velocity;
        let mut samples = test.samples.clone();
        for at in (COLUMN_STEP / 2..columns).step_by(COLUMN_STEP) {
            samples[at] += size;
            let found = disturbed(&samples)?;
            samples[at] = test.samples[at];
            let kernel = found.iter().zip(&plain).map(|(a, b)| (a - b) / size);
            kernels.push((at, kernel.collect()));
        }
    }
    let nearest = |column: usize| {
        if model.is_linear() {
            0
        } else {
            (column / COLUMN_STEP).min(kernels.len() - 1)
        }
    };
    Some(Mat::from_fn(rows, columns, |i, m| {
        let (at, kernel) = &kernels[nearest(m)];
        // response i to excitation m is that of i + at - m to excitation at
        (i + at)
            .checked_sub(m)
            .and_then(|row| kernel.get(row))
            .copied()
            .unwrap_or(0.0)
    }))
}
