//! The linear Maxwell law, F = σ/η (Ödeen 1993, paper D, Table 1, model 1).

use super::{
    DEFAULT_REFERENCE_STRESS, InelasticLaw, LANES, RelaxationFlow, RelaxedStress, StressChange,
};
use crate::RodwaveError;
use crate::error::{check_array, check_positive};

/// Linear Maxwell law F(σ) = σ/η with viscosity η [Pa s].
///
/// ```
/// use rodwave::inelastic::{InelasticLaw, Maxwell, RelaxationFlow};
///
/// let law = Maxwell::new(4e6)?;
/// // relaxation time η/E = 1.6 ms: after that time the stress has dropped by a factor e
/// let relaxed = law.flow(2.5e9, 4e6 / 2.5e9).relax(10e6);
/// assert!((relaxed - 10e6 * (-1.0_f64).exp()).abs() < 1e-8 * 10e6);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maxwell {
    reference_rate: f64,
    reference_stress: f64,
}

impl Maxwell {
    /// Creates the law with viscosity η [Pa s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless η is finite and above 0.
    pub fn new(viscosity: f64) -> Result<Self, RodwaveError> {
        check_positive("viscosity [Pa s]", viscosity)?;
        Self::from_reference_rate(
            DEFAULT_REFERENCE_STRESS / viscosity,
            DEFAULT_REFERENCE_STRESS,
        )
    }

    /// Creates the law with F(`reference_stress` \[Pa\]) = `reference_rate` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0.
    pub fn from_reference_rate(
        reference_rate: f64,
        reference_stress: f64,
    ) -> Result<Self, RodwaveError> {
        Ok(Self {
            reference_rate: check_positive("reference rate [1/s]", reference_rate)?,
            reference_stress: check_positive("reference stress [Pa]", reference_stress)?,
        })
    }

    /// Viscosity η [Pa s].
    #[must_use]
    pub fn viscosity(&self) -> f64 {
        self.reference_stress / self.reference_rate
    }
}

impl InelasticLaw for Maxwell {
    const PARAMETERS: &'static [&'static str] = &["ln_reference_rate"];
    type Flow = MaxwellFlow;

    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        stress * (self.reference_rate / self.reference_stress)
    }

    fn flow(&self, modulus: f64, duration: f64) -> MaxwellFlow {
        let exponent = modulus * duration * self.reference_rate / self.reference_stress;
        MaxwellFlow {
            exponent,
            factor: (-exponent).exp(),
            decrement: (-exponent).exp_m1(),
        }
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.reference_rate.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [ln_rate] = check_array("parameter array", parameters)?;
        Self::from_reference_rate(ln_rate.exp(), self.reference_stress)
    }

    fn reference_stress(&self) -> f64 {
        self.reference_stress
    }
}

/// Relaxation of the Maxwell law: σ1 = σ0 exp(-E h/η).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxwellFlow {
    exponent: f64,
    factor: f64,
    /// `factor` minus 1.
    decrement: f64,
}

impl RelaxationFlow for MaxwellFlow {
    #[inline]
    fn relax(&self, stress: f64) -> f64 {
        stress * self.factor
    }

    #[inline(always)]
    fn change(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        lanes!(|i| stress[i] * self.decrement)
    }

    #[inline(always)]
    fn change_with_sensitivity(&self, stress: &[f64; LANES], _parameters: usize) -> StressChange {
        let by_log_rate = lanes!(|i| stress[i] * (-self.exponent * self.factor));
        let mut result = StressChange {
            stress: self.change(stress),
            by_stress: [self.decrement; LANES],
            by_log_modulus: by_log_rate,
            ..StressChange::default()
        };
        result.by_parameter[0] = by_log_rate;
        result
    }

    #[inline]
    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        let relaxed = stress * self.factor;
        let by_log_rate = -self.exponent * relaxed;
        if let Some(by_parameter) = by_parameter.first_mut() {
            *by_parameter = by_log_rate;
        }
        RelaxedStress {
            stress: relaxed,
            by_stress: self.factor,
            by_log_modulus: by_log_rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inelastic::battery::battery;

    #[test]
    fn the_flow_is_exact() {
        battery(&Maxwell::new(2.5e6).unwrap());
    }
}
