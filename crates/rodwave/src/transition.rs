//! Transition matrices, which relate the states (N, v) at two sections.
//!
//! The state is the normal force N, positive in tension, and the particle velocity v, positive
//! along +x, both Fourier transforms. Along a rod (Ödeen 1993, paper E, eqs. A1-A2)
//!
//! ```text
//! dN/dx = γZ v ,    dv/dx = (γ/Z) N ,    γZ = iωρA ,    γ/Z = iω/(AE)
//! ```
//!
//! and a uniform part, or a mass between two faces, has a matrix P that gives (N, v) on its right
//! from (N, v) on its left. The matrix of elements in series is the product of their matrices, the
//! last element first: `P = P_B P_A` (paper E, eq. A9). Every P has determinant 1, as reciprocity
//! requires.
//!
//! # Limits of the plain product
//! The entries grow as e^{αL} over a damped body. Up to αL ≈ 700 nothing overflows, and the
//! free-end mobility, a ratio of two entries of one row, keeps its digits. Quantities that are
//! *differences* of large entries do not: the rounding errors of the determinant, the inverse and
//! the state transferred along +x grow by a factor e^{2αL}, and all digits are lost at αL ≈ 18. If
//! the matrix overflows, the mobility returns an error. A [`Chain`](crate::Chain) has none of these
//! limits.
//!
//! ```
//! use rodwave::medium::Medium;
//! use rodwave::modulus::{Elastic, PowerLawPropagation};
//! use rodwave::transition::TransitionMatrix;
//!
//! // Half of the compound cylinder of paper E, struck on its nylon face, at 1 kHz
//! let nylon = Medium::new(1150.0, PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?)?;
//! let aluminium = Medium::new(2700.0, Elastic::new(69e9)?)?;
//! let (omega, area, length) = (2.0 * std::f64::consts::PI * 1e3, 8.04e-4, 0.125);
//! let p_a = TransitionMatrix::uniform_rod(
//!     nylon.propagation_coefficient(omega),
//!     nylon.specific_characteristic_impedance(omega) * area,
//!     length,
//! )?;
//! let p_b = TransitionMatrix::uniform_rod(
//!     aluminium.propagation_coefficient(omega),
//!     aluminium.specific_characteristic_impedance(omega) * area,
//!     length,
//! )?;
//! let mobility = (p_b * p_a).mobility_free_end()?;
//! assert!(mobility.re > 0.0); // a passive body absorbs energy
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! Theory: `docs/theory/transition-matrices.md`.

use std::ops::Mul;

use num_complex::Complex64;

use crate::RodwaveError;
use crate::element::{Lumped, ScaledTransition, Segment, check_static_impedance};
use crate::error::{check_finite, check_laplace_variable, check_positive, check_that};
use crate::medium::{Medium, PropagationLaw};
use crate::modulus::LaplaceModulus;
use crate::quotient::quotient;

/// Largest αL of one element: e^{700} is near the largest double.
const LARGEST_DAMPING: f64 = 700.0;

/// State of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Normal force N̂, positive in tension \[N s\].
    pub normal_force: Complex64,
    /// Particle velocity v̂, positive along +x \[m\].
    pub velocity: Complex64,
}

/// Transition matrix P of an element or of elements in series at one frequency (paper E, eq. A8).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransitionMatrix {
    entries: [[Complex64; 2]; 2],
}

impl TransitionMatrix {
    /// Returns the identity matrix.
    #[must_use]
    pub fn identity() -> Self {
        Self {
            entries: [
                [Complex64::ONE, Complex64::ZERO],
                [Complex64::ZERO, Complex64::ONE],
            ],
        }
    }

    /// Returns the matrix of a uniform rod of `length` L \[m\], from its `propagation_coefficient`
    /// γ [1/m] and `characteristic_impedance` Z [kg/s] (paper E, eq. A10).
    ///
    /// ```text
    /// P = [ cosh γL          Z sinh γL ]
    ///     [ (1/Z) sinh γL    cosh γL   ]
    /// ```
    ///
    /// At ω = 0, a solid gives the identity. A fluid gives an error, because its impedance is 0
    /// there.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the length is above 0, γ is finite with |α|L <= 700,
    /// and Z is finite and not 0.
    pub fn uniform_rod(
        propagation_coefficient: Complex64,
        characteristic_impedance: Complex64,
        length: f64,
    ) -> Result<Self, RodwaveError> {
        let length = check_positive("length [m]", length)?;
        let gamma_length = propagation_coefficient * length;
        check_finite("phase over the rod kL [rad]", gamma_length.im)?;
        check_that(
            gamma_length.re.abs() <= LARGEST_DAMPING,
            "damping over the rod alpha L",
            gamma_length.re,
            "at most 700, otherwise the matrix overflows",
        )?;
        check_positive(
            "magnitude of the characteristic impedance [kg/s]",
            characteristic_impedance.norm(),
        )?;
        let (cosh, sinh) = (gamma_length.cosh(), gamma_length.sinh());
        Self {
            entries: [
                [cosh, characteristic_impedance * sinh],
                [quotient(sinh, characteristic_impedance), cosh],
            ],
        }
        .checked()
    }

    /// Returns the matrix of a rigid `mass` \[kg\] between two faces, at `omega` [rad/s]: the
    /// velocity is common, the force jumps by iωmv.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the mass is finite and not negative and the frequency
    /// is finite.
    pub fn lumped_mass(mass: f64, omega: f64) -> Result<Self, RodwaveError> {
        Self::lumped(Lumped::mass(mass)?, omega)
    }

    /// Returns the matrix of a massless spring of this `stiffness` k [N/m] between two faces, at
    /// `omega` [rad/s]: the force is common, the velocity jumps by iωN/k.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the stiffness is finite and above 0 and the frequency
    /// is finite.
    pub fn spring(stiffness: f64, omega: f64) -> Result<Self, RodwaveError> {
        Self::lumped(Lumped::spring(stiffness)?, omega)
    }

    /// Returns the matrix of a massless dashpot of this `resistance` q [kg/s] between two faces:
    /// the force is common, the velocity jumps by N/q.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the resistance is finite and above 0.
    pub fn dashpot(resistance: f64) -> Result<Self, RodwaveError> {
        Self::lumped(Lumped::dashpot(resistance)?, 0.0)
    }

    fn lumped(element: Lumped, omega: f64) -> Result<Self, RodwaveError> {
        let omega = check_finite("angular frequency [rad/s]", omega)?;
        Self::from_scaled(&element.transition(Complex64::new(0.0, omega)))
    }

    /// Converts a matrix that was divided by a power of e.
    pub(crate) fn from_scaled(scaled: &ScaledTransition) -> Result<Self, RodwaveError> {
        if scaled.exponent > LARGEST_DAMPING {
            return Err(RodwaveError::NonPhysical {
                quantity: "damping over the element",
                value: scaled.exponent,
                expected: "at most 700, otherwise the matrix overflows",
            });
        }
        let growth = scaled.exponent.exp();
        Self {
            entries: [
                [scaled.p11 * growth, scaled.p12 * growth],
                [scaled.p21 * growth, scaled.p22 * growth],
            ],
        }
        .checked()
    }

    /// Checks that the entries are finite.
    pub(crate) fn checked(self) -> Result<Self, RodwaveError> {
        for entry in self.entries.as_flattened() {
            check_finite("magnitude of an entry of the matrix", entry.norm())?;
        }
        Ok(self)
    }

    /// Entries, row by row: the first row gives N from (N, v), the second v from (N, v).
    #[must_use]
    pub fn entries(&self) -> [[Complex64; 2]; 2] {
        self.entries
    }

    /// Determinant, which is 1 except for rounding; see the limits of the plain product in the
    /// [module](self).
    #[must_use]
    pub fn determinant(&self) -> Complex64 {
        let [[a, b], [c, d]] = self.entries;
        a * d - b * c
    }

    /// Returns the matrix from right to left, for a determinant of 1.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let [[a, b], [c, d]] = self.entries;
        Self {
            entries: [[d, -b], [-c, a]],
        }
    }

    /// Returns the state on the right of the elements from the state on their `left`.
    #[must_use]
    pub fn transfer(&self, left: State) -> State {
        let [[a, b], [c, d]] = self.entries;
        State {
            normal_force: a * left.normal_force + b * left.velocity,
            velocity: c * left.normal_force + d * left.velocity,
        }
    }

    /// Returns the mobility Ĝ = -v̂/N̂ [s/kg] at the left face when the right end is free (paper E,
    /// eq. A11 with q = 0 in A12): G = P₁₁/P₁₂.
    ///
    /// For a body of mass M, G → 1/(iωM) as ω → 0.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] if P₁₂ is not finite or is 0, as at ω = 0, where a free body
    /// has its pole.
    pub fn mobility_free_end(&self) -> Result<Complex64, RodwaveError> {
        let [[p11, p12], _] = self.entries;
        let scale = check_positive("magnitude of the entry P12 [kg/s]", p12.norm())?;
        // scaled, because the quotient of two numbers above 1e154 would overflow on the way
        let mobility = (p11 / scale) / (p12 / scale);
        check_finite("magnitude of the mobility [s/kg]", mobility.norm())?;
        Ok(mobility)
    }
}

impl Segment {
    /// Returns the transition matrix from the near to the far end for a part made of `medium`, at
    /// `omega` [rad/s].
    ///
    /// At ω = 0 it is the identity for a solid.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] if the frequency is not finite, if the matrix would overflow
    /// (as for αL > 700; the chain has no such limit), or for a fluid, E(0) = 0, at ω = 0;
    /// [`RodwaveError::NoPropagation`] if the law has no finite propagation coefficient.
    pub fn transition_matrix<L: PropagationLaw>(
        &self,
        medium: &Medium<L>,
        omega: f64,
    ) -> Result<TransitionMatrix, RodwaveError> {
        let s = Complex64::new(0.0, check_finite("angular frequency [rad/s]", omega)?);
        let gamma = medium.propagation_coefficient(omega);
        if omega == 0.0 {
            check_static_impedance(medium.specific_characteristic_impedance(0.0))?;
        }
        TransitionMatrix::from_scaled(&self.scaled_transition(gamma, s, medium.density())?)
    }

    /// Returns the transition matrix from the near to the far end for a part made of `medium`, at
    /// the Laplace variable `s` [1/s], Re s >= 0.
    ///
    /// # Errors
    /// The errors of [`Segment::transition_matrix`], and [`RodwaveError::NonPhysical`] for Re s
    /// < 0.
    pub fn transition_matrix_at_s<M: LaplaceModulus>(
        &self,
        medium: &Medium<M>,
        s: Complex64,
    ) -> Result<TransitionMatrix, RodwaveError> {
        check_laplace_variable(s)?;
        let mut gamma = Complex64::ZERO;
        if s == Complex64::ZERO {
            check_static_impedance(medium.specific_characteristic_impedance_at_s(s))?;
        } else {
            gamma = medium.propagation_coefficient_at_s(s);
        }
        TransitionMatrix::from_scaled(&self.scaled_transition(gamma, s, medium.density())?)
    }
}

/// Puts elements in series, those of `right` first: `p_b * p_a` is A followed by B along +x (paper
/// E, eq. A9).
impl Mul for TransitionMatrix {
    type Output = Self;

    fn mul(self, right: Self) -> Self {
        let [[a, b], [c, d]] = self.entries;
        let [[e, f], [g, h]] = right.entries;
        Self {
            entries: [
                [a * e + b * g, a * f + b * h],
                [c * e + d * g, c * f + d * h],
            ],
        }
    }
}
