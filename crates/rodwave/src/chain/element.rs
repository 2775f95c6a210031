//! An element with its material.

use std::sync::Arc;

use num_complex::Complex64;

use super::{Argument, WaveMedium};
use crate::RodwaveError;
use crate::element::{Lumped, ScaledTransition, Segment, check_static_impedance};
use crate::error::{check_positive, check_propagation};
use crate::quotient::quotient;

/// One element of a chain.
#[derive(Debug, Clone)]
pub(super) enum Element<V> {
    Segment {
        medium: Arc<dyn WaveMedium<V>>,
        segment: Segment,
    },
    Lumped(Lumped),
}

/// Elements on either side of a section; `None` where the section is a face of the element.
#[derive(Debug, Clone)]
pub(super) struct Parts<V> {
    pub(super) near: Option<Element<V>>,
    pub(super) far: Option<Element<V>>,
}

/// Propagation coefficient and impedance at a section.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalWaves {
    pub(super) propagation_coefficient: Complex64,
    pub(super) characteristic_impedance: Complex64,
}

impl<V: Argument> Element<V> {
    /// Transition matrix from the near to the far face.
    #[inline]
    pub(super) fn transition(&self, argument: V) -> Result<ScaledTransition, RodwaveError> {
        let s = argument.s();
        match self {
            Self::Lumped(lumped) => Ok(lumped.transition(s)),
            Self::Segment { medium, .. } if s == Complex64::ZERO => {
                check_static_impedance(medium.static_impedance())?;
                Ok(ScaledTransition::IDENTITY)
            }
            Self::Segment { medium, segment } => segment.scaled_transition(
                medium.propagation_coefficient(argument),
                s,
                medium.density(),
            ),
        }
    }

    /// Splits the element at the section at `distance` from the near face.
    pub(super) fn cut(&self, distance: f64) -> Result<Parts<V>, RodwaveError> {
        let (medium, segment) = match self {
            Self::Segment { medium, segment } => (medium, segment),
            Self::Lumped(_) if distance == 0.0 => {
                return Ok(Parts {
                    near: None,
                    far: Some(self.clone()),
                });
            }
            Self::Lumped(_) => {
                return Err(RodwaveError::NonPhysical {
                    quantity: "distance of the section [m]",
                    value: distance,
                    expected: "0 in an element without length",
                });
            }
        };
        segment.check_distance(distance)?;
        let part = |segment| Self::Segment {
            medium: Arc::clone(medium),
            segment,
        };
        Ok(match segment.cut(distance) {
            Ok(cut) => Parts {
                near: Some(part(cut.near)),
                far: Some(part(cut.far)),
            },
            Err(_) if distance == 0.0 => Parts {
                near: None,
                far: Some(self.clone()),
            },
            Err(_) => Parts {
                near: Some(self.clone()),
                far: None,
            },
        })
    }

    /// Propagation coefficient and characteristic impedance at `distance` from the near face.
    pub(super) fn local_waves(
        &self,
        distance: f64,
        argument: V,
    ) -> Result<LocalWaves, RodwaveError> {
        let Self::Segment { medium, segment } = self else {
            return Err(RodwaveError::NonPhysical {
                quantity: "length of the element [m]",
                value: 0.0,
                expected: "above 0, for waves to travel in it",
            });
        };
        let gamma = medium.propagation_coefficient(argument);
        let gamma = check_propagation(gamma, argument.s())?;
        check_positive(
            "magnitude of the propagation coefficient [1/m]",
            gamma.norm(),
        )?;
        let inertia = argument.s() * (medium.density() * segment.area_at(distance)?);
        Ok(LocalWaves {
            propagation_coefficient: gamma,
            characteristic_impedance: quotient(inertia, gamma),
        })
    }
}
