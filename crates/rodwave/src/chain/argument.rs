//! Arguments of a chain: frequencies on the real axis, or points of the right half plane of s.

use std::fmt::Debug;

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::check_finite;
use crate::error::check_laplace_variable;
use crate::medium::{Medium, PropagationLaw};
use crate::modulus::LaplaceModulus;

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::AngularFrequency {}
    impl Sealed for super::LaplaceVariable {}
}

/// Argument of a body's response: [`AngularFrequency`] or [`LaplaceVariable`].
pub trait Argument: Copy + Debug + sealed::Sealed + 'static {
    /// Creates the argument for the frequency `omega` [rad/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] if it is not finite.
    fn on_axis(omega: f64) -> Result<Self, RodwaveError>;

    /// Laplace variable s [1/s]; on the frequency axis, s = iω.
    fn s(self) -> Complex64;
}

/// A real, finite angular frequency ω [rad/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularFrequency(f64);

impl AngularFrequency {
    /// Angular frequency ω [rad/s].
    #[must_use]
    pub fn omega(self) -> f64 {
        self.0
    }
}

impl Argument for AngularFrequency {
    fn on_axis(omega: f64) -> Result<Self, RodwaveError> {
        Ok(Self(check_finite("angular frequency [rad/s]", omega)?))
    }

    #[inline]
    fn s(self) -> Complex64 {
        Complex64::new(0.0, self.0)
    }
}

/// A finite Laplace variable s [1/s], Re s >= 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaplaceVariable(Complex64);

impl LaplaceVariable {
    /// Creates the variable from `s` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless s is finite and Re s >= 0.
    pub fn new(s: Complex64) -> Result<Self, RodwaveError> {
        Ok(Self(check_laplace_variable(s)?))
    }
}

impl Argument for LaplaceVariable {
    fn on_axis(omega: f64) -> Result<Self, RodwaveError> {
        let omega = check_finite("angular frequency [rad/s]", omega)?;
        Ok(Self(Complex64::new(0.0, omega)))
    }

    #[inline]
    fn s(self) -> Complex64 {
        self.0
    }
}

/// Material of a chain. Every [`Medium`] implements it for real frequencies, and for complex ones
/// if its law is [analytic](LaplaceModulus).
pub trait WaveMedium<V>: Debug + Send + Sync {
    /// Density ρ [kg/m³].
    fn density(&self) -> f64;

    /// Propagation coefficient γ [1/m].
    fn propagation_coefficient(&self, argument: V) -> Complex64;

    /// Characteristic impedance per unit area [Pa s/m] at rest, 0 for a fluid.
    fn static_impedance(&self) -> Complex64;
}

impl<L: PropagationLaw + Debug + Send + Sync> WaveMedium<AngularFrequency> for Medium<L> {
    fn density(&self) -> f64 {
        self.density()
    }

    #[inline]
    fn propagation_coefficient(&self, argument: AngularFrequency) -> Complex64 {
        self.propagation_coefficient(argument.omega())
    }

    fn static_impedance(&self) -> Complex64 {
        self.specific_characteristic_impedance(0.0)
    }
}

impl<M: LaplaceModulus + Debug + Send + Sync> WaveMedium<LaplaceVariable> for Medium<M> {
    fn density(&self) -> f64 {
        self.density()
    }

    #[inline]
    fn propagation_coefficient(&self, argument: LaplaceVariable) -> Complex64 {
        self.propagation_coefficient_at_s(argument.s())
    }

    fn static_impedance(&self) -> Complex64 {
        self.specific_characteristic_impedance(0.0)
    }
}
