//! Lubich's convolution quadrature.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::{Front, Quadrature, TimeGrid};
use crate::{Domain, ImpactBody, ImpulseError, fourier};

/// `wⱼ = (r⁻ʲ/M) Σₗ G(δ(r e^{2πil/M})/h) e^{-2πijl/M}`, `M = 2N`, `r = ε^{1/(2M)}`: the
/// coefficients of $`G(\delta(z)/h)`$ to about $`\sqrt\epsilon`$ of the largest (Lubich, Numer.
/// Math. 52 (1988) 129 and 413).
pub(super) fn weights<B: ImpactBody + ?Sized>(
    body: &B,
    grid: TimeGrid,
    quadrature: Quadrature,
    front: Front,
) -> Result<Vec<f64>, ImpulseError> {
    let n_points = 2 * grid.n_steps;
    let radius = f64::EPSILON.powf(0.5 / n_points as f64);
    let mut lines = Vec::with_capacity(grid.n_steps + 1);
    for line in 0..=grid.n_steps {
        // the other half of the circle is conjugate; the inverse transform has the kernel e^{+}, so
        // the circle is traversed in the opposite direction
        let z = Complex64::from_polar(radius, -TAU * line as f64 / n_points as f64);
        let delta = match quadrature {
            Quadrature::Trapezoid => 2.0 * (1.0 - z) / (1.0 + z),
            Quadrature::Bdf2 | Quadrature::CellAverages => 1.5 - 2.0 * z + 0.5 * z * z,
        };
        let s = delta / grid.time_step;
        if body.domain() != Domain::RightHalfPlane {
            return Err(ImpulseError::OutsideDomain {
                s,
                expected: "a body whose laws are analytic, as convolution quadrature requires",
            });
        }
        let mobility = body.mobility_at(s)?;
        if !mobility.is_finite() {
            return Err(ImpulseError::InfiniteMobility {
                body: "impacting",
                s,
            });
        }
        lines.push(mobility - s * front.compliance);
    }
    let mut weights = fourier::to_samples(&lines, n_points);
    weights.truncate(grid.n_steps);
    let scale = 1.0 / n_points as f64;
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight *= scale * radius.powf(-(index as f64));
    }
    Ok(weights)
}
