//! Moduli in the time domain: relaxation after a step of strain, creep after a step of stress.

use mittagleffler::MittagLeffler;

use super::LaplaceModulus;
use crate::RodwaveError;
use crate::error::{check_finite, check_positive};

/// Law whose relaxation modulus and creep compliance have closed forms.
///
/// A strain ε₀ applied at t = 0 and held requires the stress E(t) ε₀; a stress σ₀ applied and held
/// causes the strain J(t) σ₀. Their Laplace transforms are
///
/// ```text
/// ∫₀^∞ E(t) e^{-st} dt = E(s)/s ,    ∫₀^∞ J(t) e^{-st} dt = 1/(s E(s))
/// ```
///
/// Both are defined after the step, t > 0. At t = 0 they jump; E(t) of some laws is infinite there.
///
/// ```
/// use rodwave::modulus::{TimeDomainModulus, Zener};
///
/// let law = Zener::new(2.0e9, 2.2e9, 1e-4)?;
/// let after_one_relaxation_time = law.relaxation_modulus(1e-4)?;
/// assert!((after_one_relaxation_time - 2.0e9 - 0.2e9 / std::f64::consts::E).abs() < 1.0);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
pub trait TimeDomainModulus: LaplaceModulus {
    /// Relaxation modulus E(t) \[Pa\] at `time` t > 0 \[s\] after a step of strain.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the time is finite and above 0.
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError>;

    /// Creep compliance J(t) [1/Pa] at `time` t > 0 \[s\] after a step of stress.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the time is finite and above 0.
    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError>;
}

pub(super) fn after_step(time: f64) -> Result<f64, RodwaveError> {
    check_positive("time after the step [s]", time)
}

/// Checks that a relaxation modulus has not overflowed, and returns it.
pub(super) fn finite_modulus(modulus: f64) -> Result<f64, RodwaveError> {
    check_finite("relaxation modulus [Pa]", modulus)
}

/// Checks that a creep compliance has not overflowed, and returns it.
pub(super) fn finite_compliance(compliance: f64) -> Result<f64, RodwaveError> {
    check_finite("creep compliance [1/Pa]", compliance)
}

/// Computes the decay of fractional relaxation from 1 to 0, E_α(-(t/τ)^α) with the Mittag-Leffler
/// function E_α, for 0 < α <= 1.
///
/// For α = 1 it is e^{-t/τ}. The absolute error of the library's function is a few 1e-15, compared
/// with the value 1 at t = 0, which suffices for a solid with E₀ > 0.
pub(super) fn fractional_decay(exponent: f64, time_ratio: f64) -> Result<f64, RodwaveError> {
    fractional_decay_of_power(exponent, time_ratio.powf(exponent))
}

/// Computes [`fractional_decay`] from the power (t/τ)^α; t/τ itself may overflow or vanish.
pub(super) fn fractional_decay_of_power(exponent: f64, power: f64) -> Result<f64, RodwaveError> {
    let argument = -power;
    if exponent >= 1.0 {
        return Ok(argument.exp());
    }
    if argument == f64::NEG_INFINITY {
        return Ok(0.0);
    }
    match argument.mittag_leffler(exponent, 1.0) {
        Some(decay) if decay.re.is_finite() => Ok(decay.re),
        _ => Err(RodwaveError::NonPhysical {
            quantity: "argument of the Mittag-Leffler function",
            value: argument,
            expected: "an argument at which the function can be evaluated",
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares E_α(-x) at large x with 1/(x Γ(1-α)), the first term of its asymptotic series, and
    /// checks the limits. The second term is smaller by the factor x.
    #[test]
    fn decay_has_its_algebraic_tail_and_its_limits() {
        for exponent in [0.05, 0.3, 0.5, 0.8, 0.99] {
            for decades in [8, 20, 100] {
                let x = 10f64.powi(decades);
                let tail = 1.0 / (x * statrs::function::gamma::gamma(1.0 - exponent));
                let decay = fractional_decay(exponent, x.powf(1.0 / exponent)).unwrap();
                assert!((decay - tail).abs() < 1e-15, "α = {exponent}, x = {x:e}");
            }
            assert!((fractional_decay(exponent, 1e-300).unwrap() - 1.0).abs() < 1e-14);
        }
        assert!(fractional_decay(0.5, f64::NAN).is_err());
    }
}
