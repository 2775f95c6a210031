//! The Maxwell-Eyring law, F = ε̇₀ sinh(σ/σ*) (Eyring, *J. Chem. Phys.* **4** (1936) 283).

use super::{
    DEFAULT_REFERENCE_STRESS, InelasticLaw, LANES, RelaxationFlow, RelaxedStress, StressChange,
    cell_by_cell, elementary,
};
use crate::RodwaveError;
use crate::error::{check_array, check_finite, check_positive};

/// Flow of thermally activated segments: F(σ) = ε̇₀ sinh(σ/σ*) = r sinh(β σ/σ_ref)/sinh β, with β =
/// σ_ref/σ* and r = F(σ_ref). The limit β → 0 is the linear Maxwell law.
///
/// ```
/// use rodwave::inelastic::{Eyring, InelasticLaw};
///
/// let law = Eyring::new(0.3, 2.5e6)?;
/// assert!((law.inelastic_strain_rate(8e6) / (0.3 * f64::sinh(3.2)) - 1.0).abs() < 1e-13);
/// // 1.6 nm³, as for polycarbonate at room temperature
/// assert!((law.activation_volume(293.0) / 1.6e-27 - 1.0).abs() < 0.02);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eyring {
    /// β = σ_ref/σ*
    sharpness: f64,
    reference_rate: f64,
    reference_stress: f64,
}

/// Boltzmann's constant [J/K].
const BOLTZMANN: f64 = 1.380_649e-23;

impl Eyring {
    /// Creates the law with the rate factor ε̇₀ [1/s] and the activation stress σ* \[Pa\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0, and the rate at 10 MPa is
    /// finite.
    pub fn new(rate_factor: f64, activation_stress: f64) -> Result<Self, RodwaveError> {
        check_positive("rate factor [1/s]", rate_factor)?;
        check_positive("activation stress [Pa]", activation_stress)?;
        let sharpness = DEFAULT_REFERENCE_STRESS / activation_stress;
        let rate = rate_factor * sharpness.sinh();
        Self::from_reference_rate(sharpness, rate, DEFAULT_REFERENCE_STRESS)
    }

    /// Creates the law with β = σ_ref/σ* and F(`reference_stress` \[Pa\]) = `reference_rate` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0, and the resulting viscosity
    /// is too, which requires β below about 700.
    pub fn from_reference_rate(
        sharpness: f64,
        reference_rate: f64,
        reference_stress: f64,
    ) -> Result<Self, RodwaveError> {
        let law = Self {
            sharpness: check_positive(
                "sharpness beta = reference stress / activation stress",
                sharpness,
            )?,
            reference_rate: check_positive("reference rate [1/s]", reference_rate)?,
            reference_stress: check_positive("reference stress [Pa]", reference_stress)?,
        };
        // the flow uses the viscosity, which must therefore be finite and above 0
        check_positive("viscosity [Pa s]", law.viscosity())?;
        Ok(law)
    }

    /// Activation stress σ* \[Pa\].
    #[must_use]
    pub fn activation_stress(&self) -> f64 {
        self.reference_stress / self.sharpness
    }

    /// Rate factor ε̇₀ [1/s].
    #[must_use]
    pub fn rate_factor(&self) -> f64 {
        self.reference_rate / self.sharpness.sinh()
    }

    /// Viscosity η = σ*/ε̇₀ [Pa s] at vanishing stress.
    #[must_use]
    pub fn viscosity(&self) -> f64 {
        self.activation_stress() / self.rate_factor()
    }

    /// Activation volume k T/σ* \[m³\] at `temperature` \[K\], for uniaxial stress.
    #[must_use]
    pub fn activation_volume(&self, temperature: f64) -> f64 {
        BOLTZMANN * temperature / self.activation_stress()
    }

    /// Exponent d ln F/d ln σ at the reference stress.
    #[must_use]
    pub fn exponent_at_reference(&self) -> f64 {
        self.sharpness / self.sharpness.tanh()
    }
}

impl InelasticLaw for Eyring {
    const PARAMETERS: &'static [&'static str] = &["ln_sharpness", "ln_reference_rate"];
    type Flow = EyringFlow;

    #[inline]
    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        // e^{β(|σ|/σ_ref - 1)} does not overflow where the rate does not
        let x = self.sharpness * (stress.abs() / self.reference_stress);
        let shares = (-2.0 * x).exp_m1() / (-2.0 * self.sharpness).exp_m1();
        (self.reference_rate * (x - self.sharpness).exp() * shares).copysign(stress)
    }

    fn flow(&self, modulus: f64, duration: f64) -> EyringFlow {
        let advance = modulus * duration / self.viscosity();
        EyringFlow {
            activation_stress: self.activation_stress(),
            advance,
            left: (-advance).exp(),
            decay: -(-advance).exp_m1(),
            advance_by_ln_sharpness: advance * (1.0 - self.exponent_at_reference()),
        }
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.sharpness.ln(), self.reference_rate.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [ln_sharpness, ln_rate] = check_array("parameter array", parameters)?;
        check_finite("ln sharpness", ln_sharpness)?;
        check_finite("ln reference rate", ln_rate)?;
        Self::from_reference_rate(ln_sharpness.exp(), ln_rate.exp(), self.reference_stress)
    }

    fn reference_stress(&self) -> f64 {
        self.reference_stress
    }
}

/// Relaxation of the Eyring law: tanh(y1/2) = e^{-q} tanh(y0/2) with y = |σ|/σ* and q = E h/η.
///
/// The change of a short step follows from tanh((y0 - y1)/2) = T (1 - e^{-q})/(1 - e^{-q} T²), T =
/// tanh(y0/2), whose terms are all positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyringFlow {
    activation_stress: f64,
    /// q
    advance: f64,
    /// e^{-q}
    left: f64,
    /// 1 - e^{-q}
    decay: f64,
    /// dq/d ln β at constant rate
    advance_by_ln_sharpness: f64,
}

/// Coefficients of tanh(x)/x in powers of x².
const TANH: [f64; 6] = [
    1.0,
    -1.0 / 3.0,
    2.0 / 15.0,
    -17.0 / 315.0,
    62.0 / 2835.0,
    -1382.0 / 155_925.0,
];

/// Largest y0 for the series [`TANH`], whose first omitted term is 1e-17 at this limit; above it,
/// 1 - e^{-y0} loses at most one digit.
const SMALL: f64 = 0.125;

/// Largest z of the series of artanh: the first omitted term is 3e-18.
const LARGEST: f64 = 0.125;

/// Quantities of a step of several cells.
struct Step {
    /// T = tanh(y0/2)
    tanh: [f64; LANES],
    /// 1 - T²
    rest: [f64; LANES],
    /// tanh((y0 - y1)/2)
    drop: [f64; LANES],
}

impl EyringFlow {
    #[inline(always)]
    fn step(&self, stress: &[f64; LANES]) -> Step {
        let inverse = 1.0 / self.activation_stress;
        let y0 = lanes!(|i| stress[i].abs() * inverse);
        let small = elementary::exp(&lanes!(|i| -y0[i]));
        let tanh = lanes!(|i| {
            let x = 0.5 * y0[i];
            if y0[i] < SMALL {
                x * elementary::polynomial(&TANH, x * x)
            } else {
                (1.0 - small[i]) / (1.0 + small[i])
            }
        });
        let rest = lanes!(|i| {
            let once = 1.0 / (1.0 + small[i]);
            4.0 * small[i] * once * once
        });
        let drop = lanes!(|i| {
            let all = rest[i] + self.decay * tanh[i] * tanh[i];
            // above 700 σ*, both terms of `all` have underflowed to 0, and the stress drops at once
            if all > 0.0 {
                tanh[i] * self.decay / all
            } else {
                1.0
            }
        });
        Step { tanh, rest, drop }
    }

    /// Computes σ1 - σ0 of several cells, for drops below [`LARGEST`].
    #[inline(always)]
    fn change_of(&self, stress: &[f64; LANES], drop: &[f64; LANES]) -> [f64; LANES] {
        lanes!(|i| {
            let z = drop[i];
            let fall = 2.0 * z * elementary::polynomial(&elementary::ARTANH, z * z);
            -(self.activation_stress * fall).copysign(stress[i])
        })
    }
}

impl RelaxationFlow for EyringFlow {
    #[inline]
    fn relax(&self, stress: f64) -> f64 {
        let y0 = stress.abs() / self.activation_stress;
        let small = (-y0).exp();
        let falls = -(-y0).exp_m1();
        // y1 = ln((1 + e^{-q} T)/(1 - e^{-q} T))
        let y1 = (2.0 * self.left * falls / (self.decay + small * (1.0 + self.left))).ln_1p();
        (y1 * self.activation_stress)
            .min(stress.abs())
            .copysign(stress)
    }

    #[inline(always)]
    fn change(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        let step = self.step(stress);
        if elementary::largest(&step.drop) < LARGEST {
            self.change_of(stress, &step.drop)
        } else {
            lanes!(|i| self.relax(stress[i]) - stress[i])
        }
    }

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "the counter stays below `LANES`, the length of every array of cells; the law has two parameters of `MAX_PARAMETERS`"
    )]
    fn change_with_sensitivity(&self, stress: &[f64; LANES], parameters: usize) -> StressChange {
        let Step { tanh, rest, drop } = self.step(stress);
        if elementary::largest(&drop) >= LARGEST {
            return cell_by_cell(self, stress, parameters);
        }
        let mut result = StressChange {
            stress: self.change_of(stress, &drop),
            ..StressChange::default()
        };
        for i in 0..LANES {
            let square = tanh[i] * tanh[i];
            // 1 - e^{-2q} T²
            let all = rest[i] + self.decay * (1.0 + self.left) * square;
            let by_stress = -self.decay * (1.0 + self.left * square) / all;
            let by_advance = -2.0 * self.left * tanh[i] / all;
            let by_advance = (self.activation_stress * by_advance).copysign(-stress[i]);
            result.by_stress[i] = by_stress;
            result.by_log_modulus[i] = by_advance * self.advance;
            result.by_parameter[0][i] = by_stress * stress[i] - result.stress[i]
                + by_advance * self.advance_by_ln_sharpness;
            result.by_parameter[1][i] = result.by_log_modulus[i];
        }
        result
    }

    #[inline]
    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        let y0 = stress.abs() / self.activation_stress;
        let small = (-y0).exp();
        let relaxed = self.relax(stress);
        // (1 + e^{-q} T)(1 - e^{-q} T)(1 + e^{-y0})²
        let sum = (1.0 + self.left) + small * self.decay;
        let all = sum * (self.decay + small * (1.0 + self.left));
        let (by_stress, by_advance) = if all > 0.0 {
            let falls = -(-2.0 * y0).exp_m1();
            (
                4.0 * small * self.left / all,
                -2.0 * self.left * falls / all,
            )
        } else {
            // above 700 σ*, if the step has zero length: the stress does not change
            (1.0, 0.0)
        };
        let by_advance = (self.activation_stress * by_advance).copysign(-stress);
        let by_log_modulus = by_advance * self.advance;
        let by_ln_sharpness =
            by_stress * stress - relaxed + by_advance * self.advance_by_ln_sharpness;
        for (entry, by) in by_parameter
            .iter_mut()
            .zip([by_ln_sharpness, by_log_modulus])
        {
            *entry = by;
        }
        RelaxedStress {
            stress: relaxed,
            by_stress,
            by_log_modulus,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inelastic::battery::battery;

    #[test]
    fn the_flow_is_exact() {
        for sharpness in [1e-6, 1e-3, 0.1, 0.7, 2.0, 4.0, 7.0] {
            battery(&Eyring::from_reference_rate(sharpness, 4.0, 10e6).unwrap());
        }
    }
}
