//! Complex moduli: what a linearly viscoelastic material is in the frequency domain.
//!
//! With the time factor e^{+iωt} the stress of a rod under a strain ε̂ is (Ödeen 1993, paper A, section 2)
//!
//! ```text
//! σ̂ = E(ω) ε̂ ,    E = E' + i E'' ,    E'' >= 0 for ω > 0
//! ```
//!
//! | law | E(ω) | E(0) | `at_s` |
//! |---|---|---|---|
//! | [`Elastic`] | E | E | yes |
//! | [`Maxwell`] | E iωτ/(1 + iωτ), τ = η/E | 0 | yes |
//! | [`KelvinVoigt`] | E + iωη | E | yes |
//! | [`Zener`] | E₀ + (E₁ - E₀) iωτ/(1 + iωτ) | E₀ | yes |
//! | [`PowerLawPropagation`] | from γ = a ω^p + i b ω^q and the density | the limit, mostly 0 | no |
//!
//! The last one is a fit to measured waves, not a modulus: without a density it has none. It is therefore no
//! [`ComplexModulus`] but, like every `ComplexModulus`, a [`PropagationLaw`](crate::medium::PropagationLaw), which is
//! all that a [`Medium`](crate::medium::Medium) asks for.
//!
//! # What this does not do
//! Laws with a spectrum of relaxation times and tabulated moduli are not here; any type can implement the traits.

mod elastic;
mod kelvin_voigt;
mod maxwell;
mod power_law_propagation;
mod zener;

pub use elastic::Elastic;
pub use kelvin_voigt::KelvinVoigt;
pub use maxwell::Maxwell;
pub use power_law_propagation::PowerLawPropagation;
pub use zener::Zener;

use num_complex::Complex64;

/// A complex modulus E(ω).
///
/// # Requirements
/// For every finite ω: E(-ω) = conj E(ω), because histories are real, and ω E''(ω) >= 0, because no energy is created.
/// E(0) is the static limit, and it is real. What is not a number goes in and comes out: callers check their
/// frequencies.
pub trait ComplexModulus {
    /// Complex modulus E = E' + iE'' \[Pa\] at `omega` [rad/s], of either sign or 0.
    fn at(&self, omega: f64) -> Complex64;
}

/// A complex modulus that is analytic in the open right half of the plane of s.
///
/// Only such a law may be used where the transform is taken off the ω axis, as in the damped transforms of impact
/// problems. A table of measured values, or a fit to one, cannot claim this.
///
/// # Requirements
/// `at_s` continues `at`: E(s = iω) = E(ω). It is real for real s >= 0, and E(conj s) = conj E(s).
pub trait LaplaceModulus: ComplexModulus {
    /// Modulus E(s) \[Pa\] at the Laplace variable `s` [1/s], Re s >= 0.
    fn at_s(&self, s: Complex64) -> Complex64;
}
