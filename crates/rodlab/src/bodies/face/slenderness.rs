//! Wavelengths in the rods of a body, compared with the diameters of the rods.

use std::f64::consts::TAU;

use super::{BodySheet, ElementSheet, EndSheet};
use crate::RodlabError;
use crate::bodies::material_sheet::{Materials, material_called};
use crate::sheet::{Length, Stated};

impl BodySheet {
    /// Returns the least ratio of wavelength to diameter at `frequency_hz` over all rods, cones and
    /// horns; infinite if the body has none. `field` is the place of the body in the sheet.
    pub(crate) fn shortest_wave(
        &self,
        materials: &Materials,
        frequency_hz: f64,
        field: &str,
    ) -> Result<f64, RodlabError> {
        let mut parts = Vec::new();
        self.collect_parts(&mut parts);
        let mut shortest = f64::INFINITY;
        for (material, diameter) in parts {
            let material = material_called(materials, material, field)?;
            let propagation = material.propagation_coefficient(frequency_hz);
            shortest = shortest.min(TAU / propagation.im / diameter.nominal());
        }
        Ok(shortest)
    }

    /// Collects the materials and the diameters of all parts in which waves propagate.
    fn collect_parts<'a>(&'a self, parts: &mut Vec<(&'a str, &'a Stated<Length>)>) {
        match self {
            Self::LongRod { material, diameter } => parts.push((material, diameter)),
            Self::Chain { elements, end } => {
                for (material, diameters) in elements.iter().filter_map(ElementSheet::solid) {
                    parts.extend(diameters.iter().map(|(_, diameter)| (material, *diameter)));
                }
                if let EndSheet::LongRod { material, diameter } = end {
                    parts.push((material, diameter));
                }
            }
            Self::Assembly(assembly) => {
                let members = assembly.members.iter();
                for body in members.filter_map(|member| member.body.as_ref()) {
                    body.collect_parts(parts);
                }
            }
            Self::RigidMass(_) | Self::Impedance(_) | Self::Measured(_) => {}
        }
    }
}

/// Diameters of an element, with the names of their fields.
type Diameters<'a> = Vec<(&'static str, &'a Stated<Length>)>;

impl ElementSheet {
    /// Returns the material and the diameters of an element in which waves propagate.
    pub(super) fn solid(&self) -> Option<(&str, Diameters<'_>)> {
        match self {
            Self::Rod {
                material, diameter, ..
            } => Some((material, vec![("diameter", diameter)])),
            Self::Cone {
                material,
                near,
                far,
                ..
            }
            | Self::Horn {
                material,
                near,
                far,
                ..
            } => Some((material, vec![("near", near), ("far", far)])),
            Self::Mass(_) | Self::Spring(_) | Self::Dashpot(_) => None,
        }
    }
}
