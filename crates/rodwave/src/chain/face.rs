//! The pair (F, v) that is transferred along the chain.

use num_complex::Complex64;

use crate::RodwaveError;
use crate::element::ScaledTransition;
use crate::error::{check_finite, check_positive};
use crate::transition::State;

/// Compressive force F = -N and velocity v of a section up to a common factor, normalised to
/// magnitude one, for free motion of the part on one side of the section.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub(super) force: Complex64,
    pub(super) velocity: Complex64,
    /// The pair has been multiplied by `factor` e^{-`exponent`} since its creation.
    factor: f64,
    exponent: f64,
}

impl Face {
    pub(super) const FREE: Self = Self::new(Complex64::ZERO, Complex64::ONE);
    pub(super) const FIXED: Self = Self::new(Complex64::ONE, Complex64::ZERO);

    pub(super) const fn new(force: Complex64, velocity: Complex64) -> Self {
        Self {
            force,
            velocity,
            factor: 1.0,
            exponent: 0.0,
        }
    }

    /// Creates the face of a body with the `impedance` F/v [kg/s].
    pub(super) fn of_impedance(impedance: Complex64) -> Result<Self, RodwaveError> {
        check_finite("impedance of the termination [kg/s]", impedance.norm())?;
        let mut face = Self::new(impedance, Complex64::ONE);
        face.normalise();
        face.restart();
        Ok(face)
    }

    /// Transfers the pair from the far to the near face of an element.
    #[inline]
    pub(super) fn pass(&mut self, transition: &ScaledTransition) {
        let (force, velocity) = (self.force, self.velocity);
        self.force = transition.p22 * force + transition.p12 * velocity;
        self.velocity = transition.p21 * force + transition.p11 * velocity;
        self.exponent += transition.exponent;
        self.normalise();
    }

    #[inline]
    fn normalise(&mut self) {
        let factor = (self.force.l1_norm() + self.velocity.l1_norm()).recip();
        self.force = self.force.scale(factor);
        self.velocity = self.velocity.scale(factor);
        self.factor *= factor;
    }

    /// Resets the factor by which the pair has been multiplied.
    pub(super) fn restart(&mut self) {
        self.factor = 1.0;
        self.exponent = 0.0;
    }

    /// Mobility v/F \[s/kg\].
    pub(super) fn mobility(&self) -> Result<Complex64, RodwaveError> {
        let (force, size) = self.scaled_force()?;
        let mobility = (self.velocity / size) / force;
        check_finite("magnitude of the mobility [s/kg]", mobility.norm())?;
        Ok(mobility)
    }

    /// State of this section per unit force at the face `struck`, to which this pair has been
    /// transferred.
    pub(super) fn over_force_of(&self, struck: &Self) -> Result<State, RodwaveError> {
        let (force, size) = struck.scaled_force()?;
        let per_force = force.inv() * (struck.factor * (-struck.exponent).exp() / size);
        let state = State {
            normal_force: -self.force * per_force,
            velocity: self.velocity * per_force,
        };
        check_finite(
            "magnitude of the state of the section",
            state.normal_force.norm() + state.velocity.norm(),
        )?;
        Ok(state)
    }

    /// Force divided by its magnitude, and the magnitude. In a quotient, the square of a small
    /// force would underflow.
    fn scaled_force(&self) -> Result<(Complex64, f64), RodwaveError> {
        let size = check_positive("magnitude of the impedance of the face", self.force.norm())?;
        Ok((self.force / size, size))
    }
}
