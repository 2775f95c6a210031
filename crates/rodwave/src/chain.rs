//! Bodies made of elements in series: mobility of their faces and response of their sections.
//!
//! A body is a series of [elements](crate::element) along x from the impact face, with a
//! [`Termination`] after the last one. A compressive force F̂ on the impact face causes its
//! velocity v̂ = Ĝ F̂; Ĝ is the mobility (Ödeen 1993, paper E, eqs. 1 and A11).
//!
//! ```
//! use rodwave::element::Circle;
//! use rodwave::medium::Medium;
//! use rodwave::modulus::{Elastic, PowerLawPropagation};
//! use rodwave::{Chain, Termination};
//!
//! // the compound cylinder of paper E, struck at face A
//! let nylon = Medium::new(1150.0, PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?)?;
//! let aluminium = Medium::new(2700.0, Elastic::new(69e9)?)?;
//! let face = Circle::of_diameter(0.032)?;
//! let cylinder = Chain::from_impact_face()
//!     .rod(&nylon, face, 0.125)
//!     .rod(&aluminium, face, 0.125)
//!     .rod(&nylon, face, 0.125)
//!     .rod(&aluminium, face, 0.125)
//!     .end(Termination::Free)?;
//! let omega = 2.0 * std::f64::consts::PI * 1e3;
//! let mobility = cylinder.mobility(omega)?; // v/F, s/kg
//! assert!((mobility.im - 3.52231105718e-4).abs() < 1e-14);
//!
//! // the state at the middle of the last section, for an impulse of 1 N s on the impact face
//! let state = cylinder.section(3, 0.0625)?.state(omega)?;
//! assert!(state.velocity.norm() > 0.0);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Method
//! The pair (F, v) = (-N, v) is transferred from the termination to the impact face up to a common
//! factor; the mobility is v/F there. Each element contributes its transition matrix divided by
//! e^{αL} and the pair is normalised to magnitude one, so that nothing overflows at any αL or kL:
//! the factor e^{-αL} matters only for the response of a section. For passive elements no sum
//! of the recursion cancels except near a resonance or antiresonance of the body itself, and a free
//! or fixed end is simply the pair (0, 1) or (1, 0). A reflection coefficient r does not overflow
//! either, but it tends to 1 as ω → 0, where the mass of a free body is lost in the rounding of 1 -
//! r; in the pair the force is the sum of the inertia of the elements, and Ĝ iωM → 1 to full
//! precision.
//!
//! The plain product of the matrices (paper E, eq. A9) is [`Chain::transition_matrix`]; it serves
//! as a check.
//!
//! # Two domains
//! A [`Chain`] takes any law and is evaluated at real ω. An [`AnalyticChain`] takes only laws that
//! are [analytic](crate::modulus::LaplaceModulus) and can also be evaluated at complex s, as
//! [damped synthesis](crate::synthesis::DampedSynthesis) requires. The power laws of paper E, eq. 7
//! are not analytic, and a body that contains them cannot be an `AnalyticChain`.
//!
//! # Limitations
//! Bodies have no branches, and the theory is one-dimensional: see the limits in
//! [`element`](crate::element). A chain copies the media it is built from.
//!
//! Theory: `docs/theory/chains.md`.

mod argument;
mod builder;
mod element;
mod face;
mod section;
mod termination;

use std::ops::Range;

use num_complex::Complex64;

pub use argument::{AngularFrequency, Argument, LaplaceVariable, WaveMedium};
pub use builder::ChainBuilder;
pub use section::Section;
pub use termination::{Impedance, Termination};

use crate::RodwaveError;
use crate::element::Lumped;
use crate::transition::TransitionMatrix;
use element::Element;
use face::Face;

/// A body for real frequencies, or, with `V` = [`LaplaceVariable`], also for complex ones.
#[derive(Debug, Clone)]
pub struct Chain<V: Argument = AngularFrequency> {
    elements: Vec<Element<V>>,
    termination: Termination<V>,
}

/// Mobilities v/F \[s/kg\] of both faces of a body, with forces and velocities along +x. By
/// reciprocity, the transfer mobility is the same in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceMobilities {
    /// Mobility of the impact face: [`Chain::mobility`].
    pub near: Complex64,
    /// Velocity of the far face over the force on the impact face, equal to the velocity of the
    /// impact face over the force on the far face.
    pub transfer: Complex64,
    /// Mobility of the far face: [`Chain::far_face_mobility`].
    pub far: Complex64,
}

/// A body whose laws are all analytic in the right half plane; see
/// [`Chain::analytic_from_impact_face`].
pub type AnalyticChain = Chain<LaplaceVariable>;

impl Chain {
    /// Starts a body at its impact face, with elements of any law.
    pub fn from_impact_face() -> ChainBuilder {
        ChainBuilder::new()
    }
}

impl AnalyticChain {
    /// Starts a body at its impact face, with elements whose laws can be continued to complex s.
    ///
    /// ```
    /// use num_complex::Complex64;
    /// use rodwave::chain::{AnalyticChain, Termination};
    /// use rodwave::element::Circle;
    /// use rodwave::medium::Medium;
    /// use rodwave::modulus::Elastic;
    ///
    /// let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
    /// let rod = AnalyticChain::analytic_from_impact_face()
    ///     .rod(&steel, Circle::of_diameter(0.010)?, 1.0)
    ///     .end(Termination::Free)?;
    /// let at_complex_s = rod.mobility_at_s(Complex64::new(2e3, 1e4))?;
    /// let at_real_frequency = rod.mobility(1e4)?;
    /// assert!(at_complex_s.re > 0.0 && at_real_frequency.re.abs() < 1e-12);
    /// # Ok::<(), rodwave::RodwaveError>(())
    /// ```
    ///
    /// A chain of a medium that is defined only on the frequency axis does not compile:
    ///
    /// ```compile_fail,E0277
    /// use rodwave::chain::{AnalyticChain, Termination};
    /// use rodwave::element::Circle;
    /// use rodwave::medium::Medium;
    /// use rodwave::modulus::PowerLawPropagation;
    ///
    /// let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    /// let nylon = Medium::new(1150.0, law)?;
    /// let rod = AnalyticChain::analytic_from_impact_face()
    ///     .rod(&nylon, Circle::of_diameter(0.010)?, 1.0)
    ///     .end(Termination::Free)?;
    /// # Ok::<(), rodwave::RodwaveError>(())
    /// ```
    pub fn analytic_from_impact_face() -> ChainBuilder<LaplaceVariable> {
        ChainBuilder::new()
    }

    /// Mobility G(s) = v/F \[s/kg\] of the impact face at the Laplace variable `s` [1/s], Re s >=
    /// 0.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`], and [`RodwaveError::NonPhysical`] for Re s < 0.
    pub fn mobility_at_s(&self, s: Complex64) -> Result<Complex64, RodwaveError> {
        self.impact_face(LaplaceVariable::new(s)?)?.mobility()
    }

    /// Mobility G(s) = v/F \[s/kg\] of the far face at the Laplace variable `s` [1/s]: see
    /// [`Chain::far_face_mobility`].
    ///
    /// # Errors
    /// The errors of [`AnalyticChain::mobility_at_s`].
    pub fn far_face_mobility_at_s(&self, s: Complex64) -> Result<Complex64, RodwaveError> {
        self.far_face(LaplaceVariable::new(s)?)?.mobility()
    }

    /// Mobilities of both faces at the Laplace variable `s` [1/s]: see [`Chain::face_mobilities`].
    ///
    /// # Errors
    /// The errors of [`AnalyticChain::mobility_at_s`].
    pub fn face_mobilities_at_s(&self, s: Complex64) -> Result<FaceMobilities, RodwaveError> {
        self.faces(LaplaceVariable::new(s)?)
    }
}

impl<V: Argument> Chain<V> {
    /// Number of elements between the impact face and the termination.
    #[must_use]
    pub fn n_elements(&self) -> usize {
        self.elements.len()
    }

    /// Mass M \[kg\] of the low-frequency limit Ĝ → 1/(iωM); `None` if the end is not free.
    #[must_use]
    pub fn free_mass(&self) -> Option<f64> {
        let end = match self.termination {
            Termination::Free => 0.0,
            Termination::Mass(mass) => mass,
            _ => return None,
        };
        let elements = self.elements.iter().map(|element| match element {
            Element::Segment { medium, segment } => medium.density() * segment.volume(),
            Element::Lumped(Lumped::Mass(mass)) => *mass,
            Element::Lumped(_) => 0.0,
        });
        Some(elements.sum::<f64>() + end)
    }

    /// Mobility Ĝ = v̂/F̂ \[s/kg\] of the impact face at `omega` [rad/s], of either sign: F̂
    /// presses on the face, v̂ is the velocity of the face along F̂ (paper E, eqs. A5 and A11). For
    /// the truncated cone and the compound cylinder it agrees with the closed forms (paper E, eqs.
    /// 8, 9, A7, A13 and A14), for a semi-infinite rod it is 1/Z (paper E, eqs. 10 and A16).
    ///
    /// At ω = 0 the static limit is returned: 0 for a fixed body, 1/q for a dashpot q at the end.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] if the frequency is not finite, or if Ĝ is infinite: for a
    /// free body at ω = 0, and for an undamped body exactly at an antiresonance.
    /// [`RodwaveError::InElement`] if a law has no finite propagation coefficient, and for a fluid,
    /// E(0) = 0, at ω = 0.
    pub fn mobility(&self, omega: f64) -> Result<Complex64, RodwaveError> {
        self.impact_face(V::on_axis(omega)?)?.mobility()
    }

    /// Mobility Ĝ = v̂/F̂ \[s/kg\] of the far face at `omega` [rad/s], where F̂ presses on it
    /// against +x and v̂ is the velocity along F̂; the termination remains and the impact face is
    /// free.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`].
    pub fn far_face_mobility(&self, omega: f64) -> Result<Complex64, RodwaveError> {
        self.far_face(V::on_axis(omega)?)?.mobility()
    }

    /// Mobilities of both faces and between them at `omega` [rad/s], with which a body can be
    /// joined to others at its faces. The termination remains. A semi-infinite rod or a wall has no
    /// far face; the far mobility is then that of the face on which the termination acts.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`].
    pub fn face_mobilities(&self, omega: f64) -> Result<FaceMobilities, RodwaveError> {
        self.faces(V::on_axis(omega)?)
    }

    /// Transition matrix from the impact face to the far face at `omega` [rad/s], computed as the
    /// plain product of the matrices of the elements (paper E, eqs. A8-A9).
    ///
    /// The termination is not included. For the limits of the product see
    /// [`transition`](crate::transition).
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`], [`RodwaveError::InElement`] where the matrix of an
    /// element overflows, and [`RodwaveError::NonPhysical`] where the product does.
    pub fn transition_matrix(&self, omega: f64) -> Result<TransitionMatrix, RodwaveError> {
        let argument = V::on_axis(omega)?;
        let mut product = TransitionMatrix::identity();
        for (index, element) in self.elements.iter().enumerate() {
            let matrix = element
                .transition(argument)
                .and_then(|scaled| TransitionMatrix::from_scaled(&scaled))
                .map_err(|error| error.in_element(index))?;
            product = matrix * product;
        }
        product.checked()
    }

    /// Returns the section at `distance` \[m\] from the near face of `element`. Elements are
    /// counted from 0 at the impact face.
    ///
    /// A lumped element has only its near face, at `distance` 0.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] for an element that does not exist,
    /// [`RodwaveError::InElement`] for a distance outside the element.
    pub fn section(&self, element: usize, distance: f64) -> Result<Section<'_, V>, RodwaveError> {
        Section::new(self, element, distance)
    }

    /// Mobilities of both faces and between them. For the pair (F, v) that is transferred from the
    /// termination, the transfer mobility is the velocity at the termination over the force at the
    /// impact face.
    fn faces(&self, argument: V) -> Result<FaceMobilities, RodwaveError> {
        let mut end = self.termination.face(argument)?;
        end.restart();
        let near = self.carried(end, 0..self.elements.len(), argument)?;
        Ok(FaceMobilities {
            near: near.mobility()?,
            transfer: end.over_force_of(&near)?.velocity,
            far: self.far_face(argument)?.mobility()?,
        })
    }

    fn impact_face(&self, argument: V) -> Result<Face, RodwaveError> {
        let end = self.termination.face(argument)?;
        self.carried(end, 0..self.elements.len(), argument)
    }

    /// Carries the pair through the elements of the `range`, towards the impact face.
    fn carried(
        &self,
        mut face: Face,
        range: Range<usize>,
        argument: V,
    ) -> Result<Face, RodwaveError> {
        let elements = self.elements.get(range.clone()).unwrap_or_default();
        for (index, element) in elements.iter().enumerate().rev() {
            let transition = element
                .transition(argument)
                .map_err(|error| error.in_element(range.start + index))?;
            face.pass(&transition);
        }
        Ok(face)
    }

    /// Returns the pair at the far face, with the impact face free and the termination in place.
    fn far_face(&self, argument: V) -> Result<Face, RodwaveError> {
        let mut face = Face::FREE;
        for (index, element) in self.elements.iter().enumerate() {
            let transition = element
                .transition(argument)
                .map_err(|error| error.in_element(index))?;
            face.pass(&transition.turned());
        }
        let end = self.termination.face(argument)?;
        // F/v = F₁/v₁ + F₂/v₂
        Ok(Face::new(
            face.force * end.velocity + end.force * face.velocity,
            face.velocity * end.velocity,
        ))
    }
}
