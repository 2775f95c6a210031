//! Uncertainties of a gauged rod that are common to all lines.

use num_complex::Complex64;

use super::spectra::GaugedRod;
use crate::error::{CmodError, check_not_negative};
use crate::estimate::{ErrorSource, SystematicShift};

/// Standard uncertainties of a rod with gauges, independent of each other and the same on all lines; 0, or no positions, for what is
/// exact.
///
/// ```text
/// density:           dE/E = dρ/ρ
/// position of j:     dE/E = -(2/γ) (∂γ/∂x_j) dx_j
/// ```
///
/// Where a gauge is off by dx it measures q(x) + q'(x) dx, and γ follows as from any other error of that gauge: of several gauges
/// ∂γ/∂x_j = Σ d_j* q'_j/Σ|d|² over the tests, q' = γ (N e^{γx} - P e^{-γx}) and d as in [`MultiPoint`](super::MultiPoint::estimate); of three
/// by dΨ. A common shift of all gauges changes nothing, and a common scale is one of the length: Σ ∂γ/∂x_j = 0, Σ x_j ∂γ/∂x_j = γ.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GaugeUncertainty {
    /// Of the density [kg/m³].
    pub density: f64,
    /// Of the position of each gauge \[m\].
    pub positions: Vec<f64>,
}

impl GaugeUncertainty {
    pub(super) fn check(self, rod: &GaugedRod) -> Result<Self, CmodError> {
        check_not_negative("uncertainty of the density [kg/m^3]", self.density)?;
        for position in &self.positions {
            check_not_negative("uncertainty of the position of a gauge [m]", *position)?;
        }
        if !self.positions.is_empty() && self.positions.len() != rod.positions.len() {
            return Err(CmodError::GaugeCount {
                found: self.positions.len(),
                expected: "an uncertainty of the position of each gauge, or none",
            });
        }
        Ok(self)
    }

    /// Whether the position of a gauge is uncertain.
    pub(super) fn is_of_positions(&self) -> bool {
        self.positions.iter().any(|position| *position > 0.0)
    }

    /// Shifts of a line with `gamma` and `modulus` in a rod of this `density`, from ∂γ/∂x of each gauge.
    pub(super) fn shifts(
        &self,
        gamma: Complex64,
        modulus: Complex64,
        density: f64,
        by_position: &[Complex64],
    ) -> Vec<SystematicShift> {
        let of_density = (self.density > 0.0).then(|| {
            let shift = modulus * (self.density / density);
            SystematicShift::new(ErrorSource::Density, shift, Complex64::ZERO)
        });
        let of_positions = self.positions.iter().zip(by_position).enumerate();
        of_density
            .into_iter()
            .chain(
                of_positions
                    .filter(|(_, (position, _))| **position > 0.0)
                    .map(|(gauge, (position, by_position))| {
                        let of_gamma = by_position * position;
                        SystematicShift::new(
                            ErrorSource::GaugePosition(gauge),
                            -2.0 * modulus / gamma * of_gamma,
                            of_gamma,
                        )
                    }),
            )
            .collect()
    }
}
