//! Rayleigh's surface wave: the limit of the first branch for short waves.

use crate::RodwaveError;

use super::theory::check_poisson_ratio;

/// Speed of Rayleigh's surface wave relative to that of shear waves, c_R/c_S, for Poisson's ratio
/// ν.
///
/// With ξ = (c_R/c_S)² and r = (c_S/c_P)² = (1 - 2ν)/(2 - 2ν), the square ξ is the root in ]0, 1[
/// of
///
/// ```text
/// ξ³ - 8ξ² + (24 - 16r) ξ - 16 (1 - r) = 0
/// ```
///
/// ```
/// let incompressible = rodwave::slenderness::rayleigh_to_shear_speed(0.5)?;
/// assert!((incompressible - 0.955313).abs() < 1e-6);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
///
/// # Errors
/// [`RodwaveError::NonPhysical`] unless -1 < ν <= 0.5.
pub fn rayleigh_to_shear_speed(poisson_ratio: f64) -> Result<f64, RodwaveError> {
    Ok(RayleighWave::of(check_poisson_ratio(poisson_ratio)?)
        .squared_ratio
        .sqrt())
}

/// Square ξ = (c_R/c_S)² and its derivative with respect to ν.
#[derive(Debug, Clone, Copy)]
pub(super) struct RayleighWave {
    pub(super) squared_ratio: f64,
    pub(super) by_poisson_ratio: f64,
}

impl RayleighWave {
    /// Solves the equation for a Poisson's ratio that has been checked.
    pub(super) fn of(poisson_ratio: f64) -> Self {
        let r = (1.0 - 2.0 * poisson_ratio) / (2.0 - 2.0 * poisson_ratio);
        let cubic = |x: f64| ((x - 8.0) * x + (24.0 - 16.0 * r)) * x - 16.0 * (1.0 - r);
        // -16(1 - r) < 0 at 0 and 1 > 0 at 1, with one root between. Bisection is robust, and it is
        // done only once per rod.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if cubic(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let x = 0.5 * (low + high);
        let by_ratio = (3.0 * x - 16.0) * x + 24.0 - 16.0 * r;
        let by_r = 16.0 * (1.0 - x);
        let r_by_poisson_ratio = -0.5 / (1.0 - poisson_ratio).powi(2);
        Self {
            squared_ratio: x,
            by_poisson_ratio: -by_r * r_by_poisson_ratio / by_ratio,
        }
    }
}
