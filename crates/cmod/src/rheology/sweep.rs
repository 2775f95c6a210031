//! Moduli of a material at several temperatures.

use super::data::ModulusData;
use crate::error::{CmodError, check_enough_readings, check_finite, check_positive, check_values};

/// Moduli of one material at several temperatures, with the factor of the modulus at each
/// temperature, if it is known.
///
/// ```text
/// E(ω, T) = b_T E_ref(ω a_T)
/// ```
///
/// A master curve determines a_T. If densities are given, b_T = ρT/(ρᵣTᵣ) follows from rubber
/// elasticity, which is entropic. Otherwise b_T is 1 or T/Tᵣ, whichever describes the curves
/// better, and is estimated if they are compatible with neither.
#[derive(Debug, Clone, PartialEq)]
pub struct TemperatureSweep {
    pub(super) temperatures: Vec<f64>,
    pub(super) data: Vec<ModulusData>,
    /// Value ρT, or 1, of each temperature; the factor b_T is the ratio of this value to the value
    /// at the reference.
    pub(super) vertical: Vec<f64>,
    /// True if the factors are stated.
    pub(super) vertical_is_stated: bool,
    /// Stated ln a_T, up to a constant; they connect temperatures whose curves do not overlap.
    pub(super) stated_shifts: Option<Vec<f64>>,
}

impl TemperatureSweep {
    /// Creates a sweep from data at absolute temperatures \[K\], in order of increasing
    /// temperature.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer than two temperatures, or fewer than three points at
    /// one temperature; [`CmodError::Temperature`] unless all temperatures are finite, above 0 and
    /// increasing.
    pub fn new(steps: Vec<(f64, ModulusData)>) -> Result<Self, CmodError> {
        check_enough_readings(steps.len(), 2)?;
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
        for data in &data {
            check_enough_readings(data.len(), 3)?;
        }
        Ok(Self {
            vertical: vec![1.0; temperatures.len()],
            vertical_is_stated: false,
            stated_shifts: None,
            temperatures,
            data,
        })
    }

    /// Sets ln a_T at each temperature, up to a constant, for example from a known law of
    /// [shifts](super::ShiftLaws). If neighbouring curves do not overlap, the stated shift between
    /// them is used; if they overlap, the shift is fitted.
    ///
    /// # Errors
    /// [`CmodError::ReadingCount`]; [`CmodError::NonPhysical`] unless all values are finite.
    pub fn with_stated_shifts(mut self, log_shifts: &[f64]) -> Result<Self, CmodError> {
        let count = self.data.len();
        check_values("array of shifts", log_shifts.len(), count, "temperature")?;
        for value in log_shifts {
            check_finite("stated ln a_T", *value)?;
        }
        self.stated_shifts = Some(log_shifts.to_vec());
        Ok(self)
    }

    /// Sets the factor of rubber elasticity, b_T = ρT/(ρᵣTᵣ), from the `densities` [kg/m³] at all
    /// temperatures.
    ///
    /// # Errors
    /// [`CmodError::ReadingCount`]; [`CmodError::NonPhysical`] unless all densities are finite
    /// and above 0.
    pub fn with_rubber_elasticity(mut self, densities: &[f64]) -> Result<Self, CmodError> {
        let count = self.data.len();
        check_values("array of densities", densities.len(), count, "temperature")?;
        for ((vertical, density), temperature) in self
            .vertical
            .iter_mut()
            .zip(densities)
            .zip(&self.temperatures)
        {
            *vertical = check_positive("density [kg/m^3]", *density)? * temperature;
        }
        self.vertical_is_stated = true;
        Ok(self)
    }

    /// Sets the factor of rubber elasticity at constant density, b_T = T/Tᵣ.
    pub(super) fn entropic(mut self) -> Self {
        self.vertical.clone_from(&self.temperatures);
        self.vertical_is_stated = true;
        self
    }

    /// Sets the factor of the modulus to 1 at all temperatures, so that no factor is estimated.
    #[must_use]
    pub fn without_factors(mut self) -> Self {
        self.vertical.fill(1.0);
        self.vertical_is_stated = true;
        self
    }

    /// Returns the sweep with only these `steps`.
    pub(super) fn part(&self, steps: std::ops::RangeInclusive<usize>) -> Self {
        let (first, count) = (*steps.start(), steps.count());
        let pick = |values: &[f64]| values.iter().skip(first).take(count).copied().collect();
        Self {
            temperatures: pick(&self.temperatures),
            data: self.data.iter().skip(first).take(count).cloned().collect(),
            vertical: pick(&self.vertical),
            vertical_is_stated: self.vertical_is_stated,
            stated_shifts: self.stated_shifts.as_deref().map(pick),
        }
    }

    /// Returns the temperatures \[K\].
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        &self.temperatures
    }

    /// Returns the data at each temperature.
    #[must_use]
    pub fn data(&self) -> &[ModulusData] {
        &self.data
    }

    /// Returns b_T of all temperatures, with the temperature of index `reference` as reference.
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
