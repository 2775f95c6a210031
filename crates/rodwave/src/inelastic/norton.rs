//! The Maxwell-Norton law, F = |σ|^κ sgn(σ)/B (Ödeen 1993, paper D, Table 1, model 2).

use super::{DEFAULT_REFERENCE_STRESS, InelasticLaw, RelaxationFlow, RelaxedStress, check_count};
use crate::RodwaveError;
use crate::error::{check_finite, check_positive};

/// F(σ) = r (|σ|/σ_ref)^κ sgn(σ) = |σ|^κ sgn(σ)/B with exponent κ and reference rate r [1/s] at σ_ref \[Pa\].
///
/// κ = 1 is the linear Maxwell law; κ < 1 is allowed (the stress then vanishes in finite time), so that the linear
/// limit is no wall for an identification.
///
/// ```
/// use rodwave::inelastic::{InelasticLaw, MaxwellNorton};
///
/// let law = MaxwellNorton::new(2.108, 7e13)?;
/// assert!((law.coefficient() / 7e13 - 1.0).abs() < 1e-12);
/// assert!((law.inelastic_strain_rate(5e6) / (5e6_f64.powf(2.108) / 7e13) - 1.0).abs() < 1e-12);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxwellNorton {
    exponent: f64,
    reference_rate: f64,
    reference_stress: f64,
}

impl MaxwellNorton {
    /// The law with exponent κ and coefficient B [Pa^κ s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless κ and B are finite and above 0.
    pub fn new(exponent: f64, coefficient: f64) -> Result<Self, RodwaveError> {
        check_positive("exponent kappa", exponent)?;
        check_positive("coefficient B [Pa^kappa s]", coefficient)?;
        // in logarithms, because σ_ref^κ overflows long before the rate does
        let rate = (exponent * DEFAULT_REFERENCE_STRESS.ln() - coefficient.ln()).exp();
        Self::from_reference_rate(exponent, rate, DEFAULT_REFERENCE_STRESS)
    }

    /// The law with exponent κ and F(`reference_stress` \[Pa\]) = `reference_rate` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0.
    pub fn from_reference_rate(
        exponent: f64,
        reference_rate: f64,
        reference_stress: f64,
    ) -> Result<Self, RodwaveError> {
        Ok(Self {
            exponent: check_positive("exponent kappa", exponent)?,
            reference_rate: check_positive("reference rate [1/s]", reference_rate)?,
            reference_stress: check_positive("reference stress [Pa]", reference_stress)?,
        })
    }

    /// Exponent κ.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Coefficient B [Pa^κ s].
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        (self.exponent * self.reference_stress.ln() - self.reference_rate.ln()).exp()
    }
}

impl InelasticLaw for MaxwellNorton {
    const PARAMETERS: &'static [&'static str] = &["exponent", "ln_reference_rate"];
    type Flow = NortonFlow;

    #[inline]
    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        let ratio = stress.abs() / self.reference_stress;
        (self.reference_rate * ratio.powf(self.exponent)).copysign(stress)
    }

    fn flow(&self, modulus: f64, duration: f64) -> NortonFlow {
        NortonFlow {
            excess: self.exponent - 1.0,
            advance: modulus * duration * self.reference_rate / self.reference_stress,
            reference_stress: self.reference_stress,
        }
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.exponent, self.reference_rate.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        check_count(parameters, Self::PARAMETERS.len())?;
        check_finite("exponent kappa", parameters[0])?;
        Self::from_reference_rate(parameters[0], parameters[1].exp(), self.reference_stress)
    }

    fn reference_stress(&self) -> f64 {
        self.reference_stress
    }
}

/// |σ1| = |σ0| (1 + n a)^(-1/n), with n = κ - 1 and a = E h F(σ0)/σ0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NortonFlow {
    /// n = κ - 1
    excess: f64,
    /// E h r/σ_ref, the value of a at the reference stress
    advance: f64,
    reference_stress: f64,
}

impl NortonFlow {
    /// a = E h F(σ0)/σ0 and the ratio |σ0|/σ_ref, for σ0 different from 0.
    #[inline]
    fn relative_step(&self, stress: f64) -> (f64, f64) {
        let ratio = stress.abs() / self.reference_stress;
        (self.advance * ratio.powf(self.excess), ratio)
    }

    /// (1 + n a)^(-1/n): binomial series for the short steps of a solver, closed form otherwise.
    #[inline]
    fn factor(&self, a: f64) -> f64 {
        let n = self.excess;
        if a * (1.0 + n.abs()) < 2e-3 {
            // Σ (-a)^k Π(1 + j n)/k!; the first omitted term is below (2e-3)^6 = 6e-17
            return 1.0
                - a * (1.0
                    - (1.0 + n) * a / 2.0
                        * (1.0
                            - (1.0 + 2.0 * n) * a / 3.0
                                * (1.0
                                    - (1.0 + 3.0 * n) * a / 4.0
                                        * (1.0 - (1.0 + 4.0 * n) * a / 5.0))));
        }
        let x = n * a;
        if x <= -1.0 {
            0.0 // κ < 1 and the stress has vanished within the step
        } else if x.abs() < 1e-300 {
            (-a).exp()
        } else {
            (-a * (x.ln_1p() / x)).exp()
        }
    }
}

impl RelaxationFlow for NortonFlow {
    #[inline]
    fn relax(&self, stress: f64) -> f64 {
        if stress == 0.0 {
            return 0.0;
        }
        stress * self.factor(self.relative_step(stress).0)
    }

    #[inline]
    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        by_parameter.fill(0.0);
        if stress == 0.0 {
            return RelaxedStress {
                stress: 0.0,
                // F'(0) is 0 for κ > 1 and E h r/σ_ref for κ = 1; for κ < 1 the stress is gone
                by_stress: if self.excess > 0.0 {
                    1.0
                } else if self.excess < 0.0 {
                    0.0
                } else {
                    (-self.advance).exp()
                },
                by_log_modulus: 0.0,
            };
        }
        let (a, ratio) = self.relative_step(stress);
        let factor = self.factor(a);
        let relaxed = stress * factor;
        if factor == 0.0 {
            return RelaxedStress {
                stress: 0.0,
                by_stress: 0.0,
                by_log_modulus: 0.0,
            };
        }
        let x = self.excess * a;
        let by_log_rate = -relaxed * a / (1.0 + x);
        by_parameter[0] = relaxed * a * (a * bend(x) - ratio.ln() / (1.0 + x));
        by_parameter[1] = by_log_rate;
        RelaxedStress {
            stress: relaxed,
            // (σ1/σ0)^κ = factor / (1 + n a)
            by_stress: factor / (1.0 + x),
            by_log_modulus: by_log_rate,
        }
    }
}

/// [ln(1+x) - x/(1+x)]/x², by its series where the difference cancels.
fn bend(x: f64) -> f64 {
    if x.abs() < 1e-2 {
        // Σ (-x)^k (k+1)/(k+2), first omitted term x^8
        let mut sum = 0.0;
        for k in (0_u8..8).rev() {
            sum = f64::from(k + 1) / f64::from(k + 2) - x * sum;
        }
        sum
    } else {
        (x.ln_1p() - x / (1.0 + x)) / (x * x)
    }
}
