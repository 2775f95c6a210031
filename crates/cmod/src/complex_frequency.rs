//! Frequency lines of records to which damping was added before the transform.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::medium::modulus_from_propagation;

/// Line s = σ + iω of the Laplace transform of a record; this transform is the Fourier transform of
/// e^{-σt} times the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ComplexFrequency {
    hz: f64,
    /// Added damping σ [1/s].
    added_damping: f64,
}

impl ComplexFrequency {
    pub(crate) fn new(hz: f64, added_damping: f64) -> Self {
        Self { hz, added_damping }
    }

    /// Creates the line s = iω.
    pub(crate) fn on_axis(hz: f64) -> Self {
        Self::new(hz, 0.0)
    }

    /// Returns ω/2π \[Hz\].
    pub(crate) fn hz(self) -> f64 {
        self.hz
    }

    pub(crate) fn is_on_axis(self) -> bool {
        self.added_damping == 0.0
    }

    /// Returns s = σ + iω [1/s].
    pub(crate) fn laplace(self) -> Complex64 {
        Complex64::new(self.added_damping, TAU * self.hz)
    }

    /// Returns s/i = ω - iσ \[rad/s\].
    pub(crate) fn omega(self) -> Complex64 {
        Complex64::new(TAU * self.hz, -self.added_damping)
    }

    /// Returns E = ρs²/γ² \[Pa\].
    pub(crate) fn modulus(self, gamma: Complex64, density: f64) -> Result<Complex64, RodwaveError> {
        let omega = TAU * self.hz;
        let on_axis = modulus_from_propagation(gamma, omega, density)?;
        Ok(if self.added_damping == 0.0 {
            on_axis
        } else {
            on_axis * (self.omega() / omega).powi(2)
        })
    }
}
