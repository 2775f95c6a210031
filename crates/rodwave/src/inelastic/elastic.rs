//! The elastic rod, F = 0: the null hypothesis of every damping law.

use super::{InelasticLaw, RelaxationFlow, RelaxedStress};
use crate::RodwaveError;
use crate::error::check_array;

/// Elastic law, F(σ) = 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Elastic;

impl InelasticLaw for Elastic {
    const PARAMETERS: &'static [&'static str] = &[];
    type Flow = ElasticFlow;

    fn inelastic_strain_rate(&self, _stress: f64) -> f64 {
        0.0
    }

    fn flow(&self, _modulus: f64, _duration: f64) -> ElasticFlow {
        ElasticFlow
    }

    fn parameters(&self) -> Vec<f64> {
        Vec::new()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [] = check_array("parameter array", parameters)?;
        Ok(Self)
    }

    fn reference_stress(&self) -> f64 {
        super::DEFAULT_REFERENCE_STRESS
    }
}

/// Relaxation of the elastic law: the stress does not change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElasticFlow;

impl RelaxationFlow for ElasticFlow {
    #[inline]
    fn relax(&self, stress: f64) -> f64 {
        stress
    }

    #[inline]
    fn relax_with_sensitivity(&self, stress: f64, _by_parameter: &mut [f64]) -> RelaxedStress {
        RelaxedStress {
            stress,
            by_stress: 1.0,
            by_log_modulus: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inelastic::battery::battery;

    #[test]
    fn the_flow_is_exact() {
        battery(&Elastic);
    }
}
