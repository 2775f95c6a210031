//! Replacement of every stated quantity in the sheets of materials and bodies.

use super::face::assembly::AssemblySheet;
use super::face::{BodySheet, ElementSheet, EndSheet};
use super::material_sheet::{BranchSheet, LawSheet, MaterialSheet, Materials};
use crate::RodlabError;
use crate::sheet::{Kind, Stated};

/// A replacement of stated quantities: by draws within their uncertainties, or by an error for
/// every quantity with an uncertainty.
pub(crate) trait Replacement {
    /// Returns the quantity that replaces `stated`; `field` is its place in the sheet.
    fn stated<K: Kind>(
        &mut self,
        stated: &Stated<K>,
        field: &str,
    ) -> Result<Stated<K>, RodlabError>;

    /// Returns the number of standard uncertainties by which an independent error of a law from a
    /// result is moved; `source` names the error.
    fn standard(&mut self, source: &str) -> Result<f64, RodlabError>;

    fn materials(&mut self, materials: &Materials) -> Result<Materials, RodlabError> {
        let drawn = materials.iter().map(|(name, material)| {
            let field = format!("materials: {name}");
            let drawn = MaterialSheet {
                density: match &material.density {
                    Some(density) => Some(self.stated(density, &field)?),
                    None => None,
                },
                law: self.law(&material.law, &field)?,
                unusual: material.unusual,
                measured: match &material.measured {
                    Some(measured) => Some(
                        measured.moved(|source| self.standard(&format!("{field}, {source}")))?,
                    ),
                    None => None,
                },
            };
            Ok((name.clone(), drawn))
        });
        drawn.collect()
    }

    fn law(&mut self, law: &LawSheet, field: &str) -> Result<LawSheet, RodlabError> {
        Ok(match law {
            LawSheet::Elastic { modulus } => LawSheet::Elastic {
                modulus: self.stated(modulus, field)?,
            },
            LawSheet::ConstantQ {
                modulus,
                loss_factor,
                at,
            } => LawSheet::ConstantQ {
                modulus: self.stated(modulus, field)?,
                loss_factor: self.stated(loss_factor, field)?,
                at: self.stated(at, field)?,
            },
            LawSheet::KelvinVoigt { modulus, viscosity } => LawSheet::KelvinVoigt {
                modulus: self.stated(modulus, field)?,
                viscosity: self.stated(viscosity, field)?,
            },
            LawSheet::Maxwell { modulus, viscosity } => LawSheet::Maxwell {
                modulus: self.stated(modulus, field)?,
                viscosity: self.stated(viscosity, field)?,
            },
            LawSheet::Zener {
                relaxed,
                unrelaxed,
                relaxation_time,
            } => LawSheet::Zener {
                relaxed: self.stated(relaxed, field)?,
                unrelaxed: self.stated(unrelaxed, field)?,
                relaxation_time: self.stated(relaxation_time, field)?,
            },
            LawSheet::FractionalZener {
                relaxed,
                unrelaxed,
                relaxation_time,
                exponent,
            } => LawSheet::FractionalZener {
                relaxed: self.stated(relaxed, field)?,
                unrelaxed: self.stated(unrelaxed, field)?,
                relaxation_time: self.stated(relaxation_time, field)?,
                exponent: self.stated(exponent, field)?,
            },
            LawSheet::Prony {
                equilibrium,
                branches,
            } => LawSheet::Prony {
                equilibrium: match equilibrium {
                    Some(modulus) => Some(self.stated(modulus, field)?),
                    None => None,
                },
                branches: branches
                    .iter()
                    .map(|branch| {
                        Ok(BranchSheet {
                            modulus: self.stated(&branch.modulus, field)?,
                            relaxation_time: self.stated(&branch.relaxation_time, field)?,
                        })
                    })
                    .collect::<Result<_, RodlabError>>()?,
            },
            LawSheet::PowerLawPropagation { .. } | LawSheet::Result(_) => law.clone(),
        })
    }

    /// Replaces the quantities of a computed body; a measured body is kept as stated.
    fn body(&mut self, body: &BodySheet, field: &str) -> Result<BodySheet, RodlabError> {
        Ok(match body {
            BodySheet::Chain { elements, end } => BodySheet::Chain {
                elements: elements
                    .iter()
                    .map(|element| self.element(element, field))
                    .collect::<Result<_, _>>()?,
                end: self.end(end, field)?,
            },
            BodySheet::RigidMass(mass) => BodySheet::RigidMass(self.stated(mass, field)?),
            BodySheet::LongRod { material, diameter } => BodySheet::LongRod {
                material: material.clone(),
                diameter: self.stated(diameter, field)?,
            },
            BodySheet::Impedance(impedance) => BodySheet::Impedance(self.stated(impedance, field)?),
            BodySheet::Measured(_) => body.clone(),
            BodySheet::Assembly(assembly) => {
                BodySheet::Assembly(Box::new(self.assembly(assembly, field)?))
            }
        })
    }

    /// Replaces the quantities of an assembly; measured members are kept as stated.
    fn assembly(
        &mut self,
        assembly: &AssemblySheet,
        field: &str,
    ) -> Result<AssemblySheet, RodlabError> {
        let mut replaced = assembly.clone();
        for member in &mut replaced.members {
            if let Some(body) = &member.body {
                member.body = Some(self.body(body, field)?);
            }
        }
        for joint in &mut replaced.joints {
            if let Some(stiffness) = &joint.stiffness {
                joint.stiffness = Some(self.stated(stiffness, field)?);
            }
            if let Some(resistance) = &joint.resistance {
                joint.resistance = Some(self.stated(resistance, field)?);
            }
        }
        Ok(replaced)
    }

    fn element(
        &mut self,
        element: &ElementSheet,
        field: &str,
    ) -> Result<ElementSheet, RodlabError> {
        Ok(match element {
            ElementSheet::Rod {
                material,
                diameter,
                length,
            } => ElementSheet::Rod {
                material: material.clone(),
                diameter: self.stated(diameter, field)?,
                length: self.stated(length, field)?,
            },
            ElementSheet::Cone {
                material,
                near,
                far,
                length,
            } => ElementSheet::Cone {
                material: material.clone(),
                near: self.stated(near, field)?,
                far: self.stated(far, field)?,
                length: self.stated(length, field)?,
            },
            ElementSheet::Horn {
                material,
                near,
                far,
                length,
            } => ElementSheet::Horn {
                material: material.clone(),
                near: self.stated(near, field)?,
                far: self.stated(far, field)?,
                length: self.stated(length, field)?,
            },
            ElementSheet::Mass(mass) => ElementSheet::Mass(self.stated(mass, field)?),
            ElementSheet::Spring(stiffness) => ElementSheet::Spring(self.stated(stiffness, field)?),
            ElementSheet::Dashpot(resistance) => {
                ElementSheet::Dashpot(self.stated(resistance, field)?)
            }
        })
    }

    fn end(&mut self, end: &EndSheet, field: &str) -> Result<EndSheet, RodlabError> {
        Ok(match end {
            EndSheet::Free | EndSheet::Fixed => end.clone(),
            EndSheet::Mass(mass) => EndSheet::Mass(self.stated(mass, field)?),
            EndSheet::Dashpot(resistance) => EndSheet::Dashpot(self.stated(resistance, field)?),
            EndSheet::LongRod { material, diameter } => EndSheet::LongRod {
                material: material.clone(),
                diameter: self.stated(diameter, field)?,
            },
        })
    }
}

/// Replacement that refuses every quantity with an uncertainty, for a job that cannot propagate
/// uncertainties.
#[derive(Debug)]
pub(crate) struct WithoutUncertainty {
    /// Reason, which completes the message "the value without ±, because".
    pub(crate) why: &'static str,
}

impl Replacement for WithoutUncertainty {
    fn stated<K: Kind>(
        &mut self,
        stated: &Stated<K>,
        field: &str,
    ) -> Result<Stated<K>, RodlabError> {
        stated.exact(field, self.why)?;
        Ok(stated.clone())
    }

    fn standard(&mut self, _source: &str) -> Result<f64, RodlabError> {
        Ok(0.0) // a job without uncertainty has no law from a result
    }
}
