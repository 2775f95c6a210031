//! Response of a section inside the body.

use num_complex::Complex64;

use super::element::{Element, Parts};
use super::face::Face;
use super::{Argument, Chain, LaplaceVariable};
use crate::RodwaveError;
use crate::error::check_finite;
use crate::transition::State;
use crate::waves::TravellingWaves;

/// A section of a chain; created by [`Chain::section`].
#[derive(Debug, Clone)]
pub struct Section<'a, V: Argument> {
    chain: &'a Chain<V>,
    element: &'a Element<V>,
    index: usize,
    distance: f64,
    /// The elements on either side of the section.
    parts: Parts<V>,
}

impl<'a, V: Argument> Section<'a, V> {
    pub(super) fn new(
        chain: &'a Chain<V>,
        index: usize,
        distance: f64,
    ) -> Result<Self, RodwaveError> {
        let Some(element) = chain.elements.get(index) else {
            return Err(RodwaveError::LengthMismatch {
                what: "the list of elements up to the section",
                found: index.saturating_add(1),
                expected: chain.elements.len(),
            });
        };
        let parts = element
            .cut(distance)
            .map_err(|error| error.in_element(index))?;
        Ok(Self {
            chain,
            element,
            index,
            distance,
            parts,
        })
    }

    /// State of the section at `omega` [rad/s] for a compressive impulse of 1 N s on the impact
    /// face, F̂ = 1: the transfer functions N̂/F̂ and v̂/F̂ \[s/kg\]. For a section within a cone,
    /// see paper E, eq. A4.
    ///
    /// Quotients of two such states are the transfer functions between two sections, whatever the
    /// excitation. Where the waves have decayed below 1e-308, the state is 0.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`].
    pub fn state(&self, omega: f64) -> Result<State, RodwaveError> {
        self.state_for(V::on_axis(omega)?)
    }

    /// Returns the waves along +x and -x whose sum is the normal force of the section at `omega`
    /// [rad/s], for a compressive impulse of 1 N s on the impact face, with x = 0 at the
    /// section (Ödeen 1993, paper E, eq. A15).
    ///
    /// In a cone or a horn, travelling waves are not independent solutions; the waves returned are
    /// those of a uniform rod that continues the section.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`]; [`RodwaveError::InElement`] for a lumped element, and at
    /// ω = 0.
    pub fn waves(&self, omega: f64) -> Result<TravellingWaves, RodwaveError> {
        let argument = V::on_axis(omega)?;
        let state = self.state_for(argument)?;
        let local = self
            .element
            .local_waves(self.distance, argument)
            .map_err(|error| error.in_element(self.index))?;
        let waves = TravellingWaves::of_normal_force(
            state,
            local.propagation_coefficient,
            local.characteristic_impedance,
        );
        let size = waves.forward_at(0.0).norm() + waves.backward_at(0.0).norm();
        check_finite("magnitude of the waves at the section", size)?;
        Ok(waves)
    }

    fn state_for(&self, argument: V) -> Result<State, RodwaveError> {
        let chain = self.chain;
        let pass = |face: &mut Face, part: &Option<Element<V>>| {
            if let Some(part) = part {
                let transition = part.transition(argument);
                face.pass(&transition.map_err(|error| error.in_element(self.index))?);
            }
            Ok::<(), RodwaveError>(())
        };
        let end = chain.termination.face(argument)?;
        let after = self.index + 1..chain.elements.len();
        let mut face = chain.carried(end, after, argument)?;
        pass(&mut face, &self.parts.far)?;
        let here = face;
        face.restart();
        pass(&mut face, &self.parts.near)?;
        let face = chain.carried(face, 0..self.index, argument)?;
        here.over_force_of(&face)
    }
}

impl Section<'_, LaplaceVariable> {
    /// State of the section at the Laplace variable `s` [1/s], Re s >= 0, for a compressive impulse
    /// of 1 N s on the impact face.
    ///
    /// # Errors
    /// The errors of [`Section::state`], and [`RodwaveError::NonPhysical`] for Re s < 0.
    pub fn state_at_s(&self, s: Complex64) -> Result<State, RodwaveError> {
        self.state_for(LaplaceVariable::new(s)?)
    }
}
