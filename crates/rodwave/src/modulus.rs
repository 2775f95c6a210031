//! Complex moduli: linearly viscoelastic materials in the frequency domain.
//!
//! With the time factor e^{+iωt}, the stress of a rod under a strain ε̂ is (Ödeen 1993, paper A,
//! section 2)
//!
//! ```text
//! σ̂ = E(ω) ε̂ ,    E = E' + i E'' ,    E'' >= 0 for ω > 0
//! ```
//!
//! | law | E(s), s = iω | E(0) | E(∞) | E(s) | ∂E/∂p | E(t), J(t) |
//! |---|---|---|---|---|---|---|
//! | [`Elastic`] | E | E | E | yes | yes | yes |
//! | [`Maxwell`] | E sτ/(1 + sτ), τ = η/E | 0 | E | yes | yes | yes |
//! | [`KelvinVoigt`] | E + sη | E | ∞ | yes | yes | yes |
//! | [`Zener`] | E₀ + (E₁ - E₀) sτ/(1 + sτ) | E₀ | E₁ | yes | yes | yes |
//! | [`GeneralisedMaxwell`] | E∞ + Σ Eᵢ sτᵢ/(1 + sτᵢ) | E∞ | E∞ + Σ Eᵢ | yes | yes | yes |
//! | [`SpringPot`] | Eᵣ (s/ωᵣ)^α | 0 | ∞ | yes | yes | yes |
//! | [`ConstantQ`] | E₀ (s/ω₀)^{2g}, g = (1/π) atan tan δ | 0 | ∞ | yes | yes | yes |
//! | [`FractionalMaxwell`] | E₁ (sτ)^α/(1 + (sτ)^α) | 0 | E₁ | yes | yes | yes |
//! | [`FractionalZener`] | E₀ + (E₁ - E₀) (sτ)^α/(1 + (sτ)^α) | E₀ | E₁ | yes | yes | yes |
//! | [`HavriliakNegami`] | E₁ - (E₁ - E₀)/(1 + (sτ)^α)^β | E₀ | E₁ | yes | yes | no |
//! | [`HeldTable`] | monotone interpolation of a [`Tabulated`] modulus | E' of the first line | last line | no | no | no |
//! | [`PowerLawPropagation`] | from γ = a ω^p + i b ω^q and the density | the limit, mostly 0 | | no | of γ | no |
//!
//! The last three columns state whether a law implements the traits [`LaplaceModulus`],
//! [`DifferentiableModulus`] and [`TimeDomainModulus`]. (In a Prony series, E∞ is the equilibrium
//! modulus for t → ∞.)
//!
//! The last law is a fit to measured waves. Without a density, it has no modulus; it is therefore
//! not a [`ComplexModulus`]. Like every `ComplexModulus`, it is a
//! [`PropagationLaw`](crate::medium::PropagationLaw), which is all that a
//! [`Medium`](crate::medium::Medium) requires. [`kramers_kronig`](crate::kramers_kronig) tests
//! whether the storage and the loss modulus of a law are causal. [`PronyStandIn`] approximates laws
//! of fractional order by a Prony series for time-domain solvers.
//!
//! # Limitations
//! Temperature, large strain and ageing are not included. Moduli that grow faster with the
//! frequency than the modulus of a dashpot, or that resonate, are not relaxations. Any type can
//! implement the traits.
//!
//! Theory: `docs/theory/moduli.md`.

mod constant_q;
pub(crate) mod differentiable;
mod elastic;
mod fractional_maxwell;
mod fractional_zener;
mod generalised_maxwell;
mod havriliak_negami;
mod kelvin_voigt;
mod maxwell;
mod monotone_cubic;
mod prony_stand_in;
mod retardation_spectrum;
mod spring_pot;
mod tabulated;
mod time_domain;
mod zener;

pub use constant_q::ConstantQ;
pub use differentiable::DifferentiableModulus;
pub use elastic::Elastic;
pub use fractional_maxwell::FractionalMaxwell;
pub use fractional_zener::FractionalZener;
pub use generalised_maxwell::{GeneralisedMaxwell, MaxwellBranch};
pub use havriliak_negami::HavriliakNegami;
pub use kelvin_voigt::KelvinVoigt;
pub use maxwell::Maxwell;
pub use prony_stand_in::{CutPlaneModulus, OmegaBand, PronyStandIn};
pub use retardation_spectrum::{KelvinVoigtElement, RetardationSpectrum};
pub use spring_pot::SpringPot;
pub use tabulated::{HeldTable, Tabulated};
pub use time_domain::TimeDomainModulus;
pub use zener::Zener;

pub use crate::medium::power_law_propagation::PowerLawPropagation;

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{check_finite, check_laplace_variable, check_that};

/// A complex modulus E(ω).
///
/// # Requirements
/// For every finite ω: E(-ω) = conj E(ω), because histories are real, and ω E''(ω) >= 0, because no
/// energy is created. E(0) is the static limit, and it is real. NaN gives NaN: callers must check
/// their frequencies, or call [`ComplexModulus::try_at`].
pub trait ComplexModulus {
    /// Complex modulus E = E' + iE'' \[Pa\] at `omega` [rad/s], of either sign or 0.
    fn at(&self, omega: f64) -> Complex64;

    /// Returns [`ComplexModulus::at`] for an unchecked `omega` [rad/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the frequency and the modulus are finite.
    fn try_at(&self, omega: f64) -> Result<Complex64, RodwaveError> {
        check_modulus(self.at(check_finite("angular frequency [rad/s]", omega)?))
    }

    /// Derivative dE/d(ln |ω|) = ω dE/dω \[Pa\] at `omega` [rad/s]; 0 at ω = 0.
    ///
    /// All laws of this module have a closed form. The default is a fourth-order finite difference
    /// over ±0.2 % of ω, whose relative error is of order 1e-12 where E is smooth on the scale of
    /// an octave.
    fn slope(&self, omega: f64) -> Complex64 {
        fourth_order_difference(omega, |omega| self.at(omega))
    }
}

/// Complex modulus that is analytic in the open right half of the plane of s.
///
/// Only such a law may be used if the transform is evaluated off the ω axis, as in the damped
/// transforms of impact problems. A table of measured values, or a law fitted to one, need not be
/// analytic.
///
/// # Requirements
/// `at_s` continues `at`: E(s = iω) = E(ω). It is real for real s >= 0, and E(conj s) = conj E(s).
pub trait LaplaceModulus: ComplexModulus {
    /// Modulus E(s) \[Pa\] at the Laplace variable `s` [1/s], Re s >= 0.
    ///
    /// The laws of this module are analytic in the whole plane except for poles or a cut on the
    /// negative real axis.
    fn at_s(&self, s: Complex64) -> Complex64;

    /// Returns [`LaplaceModulus::at_s`] for an unchecked `s` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless s is finite with Re s >= 0 and the modulus is finite.
    fn try_at_s(&self, s: Complex64) -> Result<Complex64, RodwaveError> {
        check_modulus(self.at_s(check_laplace_variable(s)?))
    }
}

fn check_modulus(modulus: Complex64) -> Result<Complex64, RodwaveError> {
    check_finite("magnitude of the complex modulus [Pa]", modulus.norm())?;
    Ok(modulus)
}

/// Derivative of `function` with respect to ln |ω|; 0 at ω = 0.
///
/// With h = 1e-3, the truncation error is h⁴/30 = 3e-14 of the fifth derivative with respect to ln
/// ω, and the rounding error is 1.5 ulp/h = 3e-13 of the value.
pub(crate) fn fourth_order_difference(
    omega: f64,
    function: impl Fn(f64) -> Complex64,
) -> Complex64 {
    const STEP: f64 = 1e-3;
    if omega == 0.0 {
        return Complex64::ZERO;
    }
    let odd = |step: f64| function(omega * step.exp()) - function(omega * (-step).exp());
    (8.0 * odd(STEP) - odd(2.0 * STEP)) / (12.0 * STEP)
}

/// Checks that an exponent is above 0 and at most 1.
fn check_exponent(quantity: &'static str, value: f64) -> Result<f64, RodwaveError> {
    check_that(
        value > 0.0 && value <= 1.0,
        quantity,
        value,
        "above 0 and at most 1",
    )
}

/// Checks that an exponent is above 0 and below 1.
fn check_fraction(quantity: &'static str, value: f64) -> Result<f64, RodwaveError> {
    check_that(
        value > 0.0 && value < 1.0,
        quantity,
        value,
        "above 0 and below 1",
    )
}
