//! Bodies of a sheet: computed chains of elements, lumped bodies, measured bodies, and assemblies
//! of several bodies.

pub mod assembly;
mod slenderness;

use std::sync::Arc;

use impulse::{
    Assembly, AtFace, Domain, ImpactBody, ImpulseError, MobilityLaw, SharedSubstructure,
};
use num_complex::Complex64;
use rodwave::chain::{
    AnalyticChain, AngularFrequency, Chain, ChainBuilder, LaplaceVariable, Termination,
};
use rodwave::element::Circle;
use serde::Deserialize;

use assembly::AssemblySheet;

use super::material::Material;
use super::material_sheet::{Materials, material_called};
use super::measured::MeasuredBodySheet;
use crate::sheet::plausible;
use crate::sheet::{AddedMass, ImpactMass, Length, SpecificImpedance, Stated, Stiffness};
use crate::{InStep, RodlabError};

/// A body: a chain of elements that starts at its impact face, a lumped body, a measured body, or
/// an assembly.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum BodySheet {
    /// A chain of elements.
    Chain {
        /// The elements in their order from the impact face.
        elements: Vec<ElementSheet>,
        /// End after the last element; by default free.
        #[serde(default)]
        end: EndSheet,
    },
    /// A rigid body.
    RigidMass(Stated<ImpactMass>),
    /// A long rod without reflections, described by its material and diameter.
    LongRod {
        /// Name of its material.
        material: String,
        /// Diameter.
        diameter: Stated<Length>,
    },
    /// A long rod, described by its characteristic impedance.
    Impedance(Stated<SpecificImpedance>),
    /// A body, described by the measured response of its impact face.
    Measured(Box<MeasuredBodySheet>),
    /// Bodies joined at points.
    Assembly(Box<AssemblySheet>),
}

/// An element of a body.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ElementSheet {
    /// A round rod.
    Rod {
        /// Name of its material.
        material: String,
        /// Diameter.
        diameter: Stated<Length>,
        /// Length.
        length: Stated<Length>,
    },
    /// A truncated cone.
    Cone {
        /// Name of its material.
        material: String,
        /// Diameter of the end towards the impact face.
        near: Stated<Length>,
        /// Diameter of the other end.
        far: Stated<Length>,
        /// Length.
        length: Stated<Length>,
    },
    /// An exponential horn.
    Horn {
        /// Name of its material.
        material: String,
        /// Diameter of the end towards the impact face.
        near: Stated<Length>,
        /// Diameter of the other end.
        far: Stated<Length>,
        /// Length.
        length: Stated<Length>,
    },
    /// A rigid mass.
    Mass(Stated<AddedMass>),
    /// A massless spring.
    Spring(Stated<Stiffness>),
    /// A massless dashpot.
    Dashpot(Stated<SpecificImpedance>),
}

/// The end after the last element.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum EndSheet {
    /// Free end.
    #[default]
    Free,
    /// A rigid wall.
    Fixed,
    /// A rigid mass, such as an accelerometer.
    Mass(Stated<ImpactMass>),
    /// A dashpot to the ground.
    Dashpot(Stated<SpecificImpedance>),
    /// A long rod without reflections.
    LongRod {
        /// Name of its material.
        material: String,
        /// Diameter.
        diameter: Stated<Length>,
    },
}

/// A computed body.
#[derive(Debug, Clone)]
pub enum ComputedBody {
    /// A chain whose materials are all known in the right half plane of the Laplace variable.
    Analytic(AnalyticChain),
    /// A chain with at least one material that is known for real frequencies only.
    OnAxis(Chain),
    /// A lumped body: a rigid mass or, if `mass` is `None`, a characteristic impedance.
    Lump {
        /// Mass of a rigid body.
        mass: Option<f64>,
        /// Characteristic impedance of a long rod.
        impedance: f64,
    },
    /// Computed bodies joined at points.
    Assembly(Arc<Assembly>),
}

impl BodySheet {
    /// Returns the computed body; `field` is its place in the sheet.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] that names the faulty element; [`RodlabError::Request`] for a measured body.
    pub fn body(&self, materials: &Materials, field: &str) -> Result<ComputedBody, RodlabError> {
        match self {
            Self::RigidMass(mass) => Ok(ComputedBody::Lump {
                mass: Some(mass.nominal()),
                impedance: 0.0,
            }),
            Self::Impedance(impedance) => Ok(ComputedBody::Lump {
                mass: None,
                impedance: impedance.nominal(),
            }),
            Self::LongRod { material, diameter } => chain(
                &[],
                &EndSheet::LongRod {
                    material: material.clone(),
                    diameter: diameter.clone(),
                },
                materials,
                field,
            ),
            Self::Chain { elements, end } => chain(elements, end, materials, field),
            Self::Measured(_) => Err(RodlabError::request(
                field,
                "a measured body",
                "a computed body: a chain, a rigid mass, a long rod, an impedance or an assembly of these",
            )),
            Self::Assembly(assembly) => {
                let member = |at: usize| assembly.computed_member(at, materials, field);
                let assembled = assembly.assembled(field, member)?;
                Ok(ComputedBody::Assembly(Arc::new(assembled)))
            }
        }
    }
}

/// Materials of the elements and of the end; `None` for an element or an end without a material.
struct Placed {
    elements: Vec<Option<Material>>,
    end: Option<Material>,
}

/// Largest number of elements of a body.
const MOST_ELEMENTS: f64 = 200.0;

fn chain(
    elements: &[ElementSheet],
    end: &EndSheet,
    materials: &Materials,
    field: &str,
) -> Result<ComputedBody, RodlabError> {
    let place = format!("{field}.elements");
    plausible::at_most(elements.len() as f64, MOST_ELEMENTS, "elements", place)?;
    let mut placed = Placed {
        elements: Vec::with_capacity(elements.len()),
        end: None,
    };
    for (at, element) in elements.iter().enumerate() {
        let place = format!("{field}.elements[{at}]");
        let material = match element.solid() {
            None => None,
            Some((material, diameters)) => {
                for (name, diameter) in diameters {
                    plausible::diameter(diameter, format!("{place}.{name}"))?;
                }
                let place = format!("{place}.material");
                Some(material_called(materials, material, &place)?)
            }
        };
        placed.elements.push(material);
    }
    if let EndSheet::LongRod { material, diameter } = end {
        plausible::diameter(diameter, format!("{field}.end.diameter"))?;
        let place = format!("{field}.end.material");
        placed.end = Some(material_called(materials, material, &place)?);
    }
    let analytic = placed
        .elements
        .iter()
        .flatten()
        .chain(&placed.end)
        .all(|material| matches!(material, Material::Analytic(_)));
    if analytic {
        analytic_chain(elements, end, &placed)
            .map(ComputedBody::Analytic)
            .in_step(field)
    } else {
        axis_chain(elements, end, &placed)
            .map(ComputedBody::OnAxis)
            .in_step(field)
    }
}

/// Defines the function that builds one of the two kinds of chain. A macro is used because the
/// builders differ in the argument of their media, for which `rodwave` has no common trait.
macro_rules! chain_of {
    ($name:ident, $argument:ty, $begin:expr, $($kind:ident)|+) => {
        fn $name(
            elements: &[ElementSheet],
            end: &EndSheet,
            placed: &Placed,
        ) -> Result<Chain<$argument>, rodwave::RodwaveError> {
            let mut body: ChainBuilder<$argument> = $begin;
            for (element, material) in elements.iter().zip(&placed.elements) {
                body = match (element, material) {
                    $((ElementSheet::Rod { diameter, length, .. }, Some(Material::$kind(medium))) => {
                        body.rod(medium, Circle::of_diameter(diameter.nominal())?, length.nominal())
                    })+
                    $((ElementSheet::Cone { near, far, length, .. }, Some(Material::$kind(medium))) => {
                        let ends = [Circle::of_diameter(near.nominal())?, Circle::of_diameter(far.nominal())?];
                        body.cone(medium, ends[0], ends[1], length.nominal())
                    })+
                    $((ElementSheet::Horn { near, far, length, .. }, Some(Material::$kind(medium))) => {
                        let ends = [Circle::of_diameter(near.nominal())?, Circle::of_diameter(far.nominal())?];
                        body.horn(medium, ends[0], ends[1], length.nominal())
                    })+
                    (ElementSheet::Mass(mass), _) => body.mass(mass.nominal()),
                    (ElementSheet::Spring(stiffness), _) => body.spring(stiffness.nominal()),
                    (ElementSheet::Dashpot(resistance), _) => body.dashpot(resistance.nominal()),
                    // not reached: `chain` chooses the function by the kinds of the materials
                    _ => body,
                };
            }
            body.end(match (end, &placed.end) {
                $((EndSheet::LongRod { diameter, .. }, Some(Material::$kind(medium))) => {
                    Termination::semi_infinite(medium, Circle::of_diameter(diameter.nominal())?)
                })+
                (EndSheet::Fixed, _) => Termination::Fixed,
                (EndSheet::Mass(mass), _) => Termination::Mass(mass.nominal()),
                (EndSheet::Dashpot(resistance), _) => Termination::Dashpot(resistance.nominal()),
                _ => Termination::Free,
            })
        }
    };
}

chain_of!(
    analytic_chain,
    LaplaceVariable,
    AnalyticChain::analytic_from_impact_face(),
    Analytic
);
chain_of!(
    axis_chain,
    AngularFrequency,
    Chain::from_impact_face(),
    Analytic | OnAxis
);

impl ComputedBody {
    /// Returns the body in the form used by `impulse`.
    pub(crate) fn impact_body(&self) -> Result<Arc<dyn ImpactBody + Send + Sync>, RodlabError> {
        Ok(match self {
            Self::Analytic(chain) => Arc::new(chain.clone()),
            Self::OnAxis(chain) => Arc::new(chain.clone()),
            Self::Lump { mass, impedance } => Arc::new(lump(*mass, *impedance)?),
            Self::Assembly(assembly) => Arc::clone(assembly) as Arc<_>,
        })
    }

    /// Returns the body as a member of an assembly. The two faces of a chain are its points.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] if this is not a valid body.
    pub fn substructure(&self) -> Result<SharedSubstructure, RodlabError> {
        Ok(match self {
            Self::Analytic(chain) => Arc::new(chain.clone()),
            Self::OnAxis(chain) => Arc::new(chain.clone()),
            Self::Lump { mass, impedance } => Arc::new(AtFace::of(lump(*mass, *impedance)?)),
            Self::Assembly(assembly) => Arc::new(AtFace::of(assembly.as_ref().clone())),
        })
    }

    /// Mobility \[m/(N s)\] at `frequency_hz`.
    ///
    /// # Errors
    ///
    /// The errors of `rodwave` or `impulse`.
    pub fn mobility(&self, frequency_hz: f64) -> Result<Complex64, ImpulseError> {
        self.mobility_at(Complex64::new(0.0, std::f64::consts::TAU * frequency_hz))
    }

    /// Mobility \[m/(N s)\] at the Laplace variable `s` [1/s].
    ///
    /// # Errors
    ///
    /// The errors of `rodwave` or `impulse`.
    pub fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        match self {
            Self::Analytic(chain) => chain.mobility_at(s),
            Self::OnAxis(chain) => chain.mobility_at(s),
            Self::Lump { mass, impedance } => Ok(lump_mobility(*mass, *impedance, s)),
            Self::Assembly(assembly) => assembly.mobility_at(s),
        }
    }

    /// Mass of the body \[kg\] if it is free, otherwise `None`.
    #[must_use]
    pub fn free_mass(&self) -> Option<f64> {
        match self {
            Self::Analytic(chain) => ImpactBody::free_mass(chain),
            Self::OnAxis(chain) => ImpactBody::free_mass(chain),
            Self::Lump { mass, .. } => *mass,
            Self::Assembly(assembly) => assembly.free_mass(),
        }
    }

    /// Domain of the Laplace variable in which the mobility is known.
    #[must_use]
    pub fn domain(&self) -> Domain {
        match self {
            Self::Analytic(chain) => chain.domain(),
            Self::OnAxis(chain) => chain.domain(),
            Self::Lump { .. } => Domain::RightHalfPlane,
            Self::Assembly(assembly) => assembly.domain(),
        }
    }
}

/// Returns the mobility law of a rigid mass, or, without a `mass`, of a long rod with this
/// impedance.
fn lump(
    mass: Option<f64>,
    impedance: f64,
) -> Result<MobilityLaw<impl Fn(Complex64) -> Complex64 + Clone>, RodlabError> {
    let law = MobilityLaw::analytic(move |s| lump_mobility(mass, impedance, s));
    match mass {
        Some(mass) => law.free(mass).in_step("a rigid mass"),
        None => Ok(law),
    }
}

fn lump_mobility(mass: Option<f64>, impedance: f64, s: Complex64) -> Complex64 {
    match mass {
        Some(mass) => 1.0 / (mass * s),
        None => Complex64::from(1.0 / impedance),
    }
}
