//! The least-squares problem in coordinates that regularisation does not couple.

use super::{Regularisation, outcome::CurvePoint};

/// Independent components of the force: spectral lines, or eigenvectors on a support.
pub(super) struct Modes {
    /// $`\mu`$: information of the responses on the component relative to the penalty; infinite
    /// without a penalty.
    pub(super) strengths: Vec<f64>,
    /// $`\beta^2`$: the part of the weighted responses that the component can explain, over all
    /// its real dimensions.
    pub(super) energies: Vec<f64>,
    /// Real dimensions of the component.
    pub(super) dimensions: Vec<f64>,
    /// The part of the weighted responses that no force can explain.
    pub(super) unexplained: f64,
    /// Number of real data.
    pub(super) n_data: f64,
}

/// The kind of regularisation, without its parameter.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    None,
    Tikhonov,
    Truncated,
}

impl Filter {
    pub(super) fn of(regularisation: Regularisation) -> Self {
        match regularisation {
            Regularisation::None => Self::None,
            Regularisation::Tikhonov { .. } => Self::Tikhonov,
            Regularisation::Truncated { .. } => Self::Truncated,
        }
    }

    /// Lost fraction $`1-\varphi`$ of a component; accurate if small.
    pub(super) fn lost(self, strength: f64, parameter: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Tikhonov if strength.is_infinite() => 0.0,
            Self::Tikhonov => parameter / (strength + parameter),
            Self::Truncated if strength >= parameter => 0.0,
            Self::Truncated => 1.0,
        }
    }

    /// Kept fraction $`\varphi`$ of a component.
    pub(super) fn kept(self, strength: f64, parameter: f64) -> f64 {
        match self {
            Self::Tikhonov if strength.is_finite() => strength / (strength + parameter),
            _ => 1.0 - self.lost(strength, parameter),
        }
    }
}

impl Modes {
    /// Smallest and largest finite strength, the smallest not below the rounding of the largest.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let finite = || self.strengths.iter().copied().filter(|mu| mu.is_finite());
        let largest = finite().fold(0.0, f64::max);
        let smallest = finite().filter(|mu| *mu > 0.0).fold(largest, f64::min);
        (largest > 0.0).then(|| (smallest.max(largest * f64::EPSILON), largest))
    }

    /// Number of real dimensions of all components.
    pub(super) fn n_dimensions(&self) -> f64 {
        self.dimensions.iter().sum()
    }

    /// Explainable but unexplained energy, $`\sum(1-\varphi)^2\beta^2`$.
    pub(super) fn sacrificed(&self, filter: Filter, parameter: f64) -> f64 {
        let modes = self.strengths.iter().zip(&self.energies);
        modes
            .map(|(mu, energy)| filter.lost(*mu, parameter).powi(2) * energy)
            .sum()
    }

    /// Residual, norm and degrees of freedom at a parameter; the score is NaN.
    pub(super) fn point(&self, filter: Filter, parameter: f64) -> CurvePoint {
        let [mut sacrificed, mut norm, mut lost_dimensions] = [0.0; 3];
        let modes = self
            .strengths
            .iter()
            .zip(&self.energies)
            .zip(&self.dimensions);
        for ((mu, energy), dimensions) in modes {
            let lost = filter.lost(*mu, parameter);
            let kept = filter.kept(*mu, parameter);
            sacrificed += lost * lost * energy;
            if *mu > 0.0 {
                norm += kept * kept * energy / mu;
            }
            lost_dimensions += lost * dimensions;
        }
        let surplus = (self.n_data - self.n_dimensions()).max(0.0);
        CurvePoint {
            parameter,
            squared_residual: self.unexplained + sacrificed,
            squared_norm: norm,
            degrees_of_freedom: self.n_dimensions() - lost_dimensions,
            // not n - sum of phi, which would lose the digits of a small difference
            freedom_left: surplus + lost_dimensions,
            score: f64::NAN,
        }
    }

    /// Curvature of the L-curve of Tikhonov's method, positive at its corner (P. C. Hansen's form,
    /// with $`\lambda = \alpha^2`$, and $`d\rho^2 = -\lambda\,d\eta^2`$).
    pub(super) fn curvature(&self, parameter: f64) -> f64 {
        let point = self.point(Filter::Tikhonov, parameter);
        let modes = self.strengths.iter().zip(&self.energies);
        // d eta^2/d alpha
        let slope: f64 = modes
            .filter(|(mu, _)| mu.is_finite() && **mu > 0.0)
            .map(|(mu, energy)| {
                let kept = Filter::Tikhonov.kept(*mu, parameter);
                kept * kept * Filter::Tikhonov.lost(*mu, parameter) * energy / mu
            })
            .sum();
        let alpha = parameter.sqrt();
        let slope = -4.0 / alpha * slope;
        let (norm, residual) = (point.squared_norm, point.squared_residual);
        let numerator = parameter * slope * residual
            + 2.0 * alpha * norm * residual
            + parameter * parameter * norm * slope;
        let denominator = (parameter * norm).hypot(residual).powi(3);
        -2.0 * norm * residual / slope * numerator / denominator
    }
}
