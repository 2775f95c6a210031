//! Construction of a chain.

use std::sync::Arc;

use super::element::Element;
use super::{AngularFrequency, Argument, Chain, Termination, WaveMedium};
use crate::RodwaveError;
use crate::element::{CrossSection, IntoCrossSection, Lumped, Segment};
use crate::error::check_positive;

/// Builder of a chain. The elements follow each other along x, the first at the impact face.
///
/// [`ChainBuilder::end`] reports invalid elements. A cross-section may be passed as a `Result`,
/// whose error is reported there too.
#[derive(Debug, Clone)]
#[must_use = "a chain is made by `end`"]
pub struct ChainBuilder<V: Argument = AngularFrequency> {
    elements: Vec<Element<V>>,
    first_error: Option<RodwaveError>,
}

impl<V: Argument> ChainBuilder<V> {
    pub(super) fn new() -> Self {
        Self {
            elements: Vec::new(),
            first_error: None,
        }
    }

    /// Adds a uniform rod of `medium` with this `section` and `length` \[m\].
    pub fn rod<M>(self, medium: &M, section: impl IntoCrossSection, length: f64) -> Self
    where
        M: WaveMedium<V> + Clone + 'static,
    {
        let section = section.into_cross_section();
        self.segment(
            medium,
            section.and_then(|section| Segment::rod(section, length)),
        )
    }

    /// Adds a truncated cone of `medium` and `length` \[m\], from the section `near` at the end
    /// closer to the impact face to the section `far` at the other end.
    pub fn cone<M>(
        self,
        medium: &M,
        near: impl IntoCrossSection,
        far: impl IntoCrossSection,
        length: f64,
    ) -> Self
    where
        M: WaveMedium<V> + Clone + 'static,
    {
        let ends = ends(near, far);
        self.segment(
            medium,
            ends.and_then(|[near, far]| Segment::cone(near, far, length)),
        )
    }

    /// Adds an exponential horn of `medium` and `length` \[m\], from the section `near` at the end
    /// closer to the impact face to the section `far` at the other end.
    pub fn horn<M>(
        self,
        medium: &M,
        near: impl IntoCrossSection,
        far: impl IntoCrossSection,
        length: f64,
    ) -> Self
    where
        M: WaveMedium<V> + Clone + 'static,
    {
        let ends = ends(near, far);
        self.segment(
            medium,
            ends.and_then(|[near, far]| Segment::horn(near, far, length)),
        )
    }

    /// Adds a rigid mass \[kg\].
    pub fn mass(self, mass: f64) -> Self {
        self.element(Lumped::mass(mass).map(Element::Lumped))
    }

    /// Adds a massless spring of this `stiffness` k [N/m] between the faces of its neighbours.
    pub fn spring(self, stiffness: f64) -> Self {
        self.element(Lumped::spring(stiffness).map(Element::Lumped))
    }

    /// Adds a massless dashpot of this `resistance` q [kg/s] between the faces of its neighbours.
    pub fn dashpot(self, resistance: f64) -> Self {
        self.element(Lumped::dashpot(resistance).map(Element::Lumped))
    }

    /// Ends the body with this termination.
    ///
    /// # Errors
    /// [`RodwaveError::InElement`] with the first invalid element, counted from 0 at the impact
    /// face; [`RodwaveError::NonPhysical`] if the termination is invalid.
    pub fn end(self, termination: Termination<V>) -> Result<Chain<V>, RodwaveError> {
        if let Some(error) = self.first_error {
            return Err(error);
        }
        termination.check()?;
        Ok(Chain {
            elements: self.elements,
            termination,
        })
    }

    fn segment<M>(self, medium: &M, segment: Result<Segment, RodwaveError>) -> Self
    where
        M: WaveMedium<V> + Clone + 'static,
    {
        // a `Medium` has checked its density; other implementations of the trait may not have
        let density = check_positive("density [kg/m^3]", medium.density());
        self.element(density.and(segment).map(|segment| Element::Segment {
            medium: Arc::new(medium.clone()),
            segment,
        }))
    }

    fn element(mut self, element: Result<Element<V>, RodwaveError>) -> Self {
        match element {
            Ok(element) => self.elements.push(element),
            Err(source) => {
                // every element before the first invalid one has been pushed, so the count is the
                // index of the first invalid one
                let index = self.elements.len();
                self.first_error
                    .get_or_insert_with(|| source.in_element(index));
            }
        }
        self
    }
}

/// The sections at both ends of an element.
fn ends(
    near: impl IntoCrossSection,
    far: impl IntoCrossSection,
) -> Result<[CrossSection; 2], RodwaveError> {
    Ok([near.into_cross_section()?, far.into_cross_section()?])
}
