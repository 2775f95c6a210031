//! Moduli at several temperatures.

use super::data::ModulusData;
use crate::error::{CmodError, check_positive};

/// Moduli of one material at several temperatures, with the known factor of the modulus at each.
///
/// ```text
/// E(ω, T) = b_T E_ref(ω a_T)
/// ```
///
/// a_T is what a master curve finds. b_T is 1 unless given: of a network of rubber b_T = ρT/(ρᵣTᵣ), because its elasticity
/// is that of entropy; of a glass or a crystalline polymer nothing of the kind is known, and a factor that is fitted
/// beside a_T hides a material whose curves cannot be shifted to one.
#[derive(Debug, Clone, PartialEq)]
pub struct TemperatureSweep {
    pub(super) temperatures: Vec<f64>,
    pub(super) data: Vec<ModulusData>,
    /// ρT, or 1; the factor b_T is its ratio to that of the reference.
    pub(super) vertical: Vec<f64>,
}

impl TemperatureSweep {
    /// Data at absolute temperatures \[K\], in the order of increasing temperature.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] below two temperatures or below three points at one of them; [`CmodError::Temperature`]
    /// unless all are finite, above 0 and increasing.
    pub fn new(steps: Vec<(f64, ModulusData)>) -> Result<Self, CmodError> {
        if steps.len() < 2 {
            return Err(CmodError::TooFewReadings {
                found: steps.len(),
                expected: 2,
            });
        }
        let (temperatures, data): (Vec<f64>, Vec<ModulusData>) = steps.into_iter().unzip();
        let mut previous = 0.0;
        for (index, &kelvin) in temperatures.iter().enumerate() {
            if !(kelvin.is_finite() && kelvin > previous) {
                return Err(CmodError::Temperature {
                    index,
                    kelvin,
                    previous,
                });
            }
            previous = kelvin;
        }
        if let Some(short) = data.iter().find(|data| data.len() < 3) {
            return Err(CmodError::TooFewReadings {
                found: short.len(),
                expected: 3,
            });
        }
        Ok(Self {
            vertical: vec![1.0; temperatures.len()],
            temperatures,
            data,
        })
    }

    /// With the factor of the elasticity of rubber, b_T = ρT/(ρᵣTᵣ), for `densities` [kg/m³] at the temperatures.
    ///
    /// # Errors
    /// [`CmodError::LengthMismatch`]; [`CmodError::NonPhysical`] unless all are finite and above 0.
    pub fn with_rubber_elasticity(mut self, densities: &[f64]) -> Result<Self, CmodError> {
        crate::error::check_length("array of densities", densities.len(), self.data.len())?;
        for ((vertical, density), temperature) in self
            .vertical
            .iter_mut()
            .zip(densities)
            .zip(&self.temperatures)
        {
            *vertical = check_positive("density [kg/m^3]", *density)? * temperature;
        }
        Ok(self)
    }

    /// Temperatures \[K\].
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        &self.temperatures
    }

    /// The data at each temperature.
    #[must_use]
    pub fn data(&self) -> &[ModulusData] {
        &self.data
    }

    /// b_T for a reference.
    #[allow(
        clippy::indexing_slicing,
        reason = "`MasterCurve::new` refuses a reference beyond the temperatures, each of which has its factor"
    )]
    pub(super) fn factors(&self, reference: usize) -> Vec<f64> {
        let own = self.vertical[reference];
        self.vertical
            .iter()
            .map(|vertical| vertical / own)
            .collect()
    }
}
