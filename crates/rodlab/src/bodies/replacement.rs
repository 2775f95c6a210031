//! Replacement of every stated quantity in the sheets of materials and bodies.

use super::face::{BodySheet, ElementSheet, EndSheet};
use super::material_sheet::{LawSheet, Materials};
use crate::RodlabError;
use crate::sheet::{Kind, Stated};

/// A pass over the stated quantities, which replaces them by draws or shifted values, or refuses
/// every quantity with an uncertainty.
pub(crate) trait Replacement {
    /// Replaces the quantity `stated`; `field` is its place in the sheet.
    fn replace<K: Kind>(&mut self, stated: &mut Stated<K>, field: &str) -> Result<(), RodlabError>;

    /// Returns the number of standard uncertainties by which an independent error of a law from a
    /// result is moved; `source` names the error.
    fn standard(&mut self, source: &str) -> Result<f64, RodlabError>;

    /// Returns the materials with their quantities replaced.
    fn materials(&mut self, materials: &Materials) -> Result<Materials, RodlabError> {
        let mut replaced = materials.clone();
        for (name, material) in &mut replaced {
            let field = format!("materials: {name}");
            if let Some(density) = &mut material.density {
                self.replace(density, &field)?;
            }
            self.replace_in_law(&mut material.law, &field)?;
            if let Some(measured) = &material.measured {
                material.measured =
                    Some(measured.moved(|source| self.standard(&format!("{field}, {source}")))?);
            }
        }
        Ok(replaced)
    }

    /// Returns a computed body with its quantities replaced; a measured body is kept as stated.
    fn body(&mut self, body: &BodySheet, field: &str) -> Result<BodySheet, RodlabError> {
        let mut replaced = body.clone();
        self.replace_in_body(&mut replaced, field)?;
        Ok(replaced)
    }

    fn replace_in_law(&mut self, law: &mut LawSheet, field: &str) -> Result<(), RodlabError> {
        match law {
            LawSheet::Elastic { modulus } => self.replace(modulus, field),
            LawSheet::ConstantQ {
                modulus,
                loss_factor,
                at,
            } => {
                self.replace(modulus, field)?;
                self.replace(loss_factor, field)?;
                self.replace(at, field)
            }
            LawSheet::KelvinVoigt { modulus, viscosity }
            | LawSheet::Maxwell { modulus, viscosity } => {
                self.replace(modulus, field)?;
                self.replace(viscosity, field)
            }
            LawSheet::Zener {
                relaxed,
                unrelaxed,
                relaxation_time,
            } => {
                self.replace(relaxed, field)?;
                self.replace(unrelaxed, field)?;
                self.replace(relaxation_time, field)
            }
            LawSheet::FractionalZener {
                relaxed,
                unrelaxed,
                relaxation_time,
                exponent,
            } => {
                self.replace(relaxed, field)?;
                self.replace(unrelaxed, field)?;
                self.replace(relaxation_time, field)?;
                self.replace(exponent, field)
            }
            LawSheet::Prony {
                equilibrium,
                branches,
            } => {
                if let Some(modulus) = equilibrium {
                    self.replace(modulus, field)?;
                }
                branches.iter_mut().try_for_each(|branch| {
                    self.replace(&mut branch.modulus, field)?;
                    self.replace(&mut branch.relaxation_time, field)
                })
            }
            LawSheet::PowerLawPropagation { .. } | LawSheet::Result(_) => Ok(()),
        }
    }

    fn replace_in_body(&mut self, body: &mut BodySheet, field: &str) -> Result<(), RodlabError> {
        match body {
            BodySheet::Chain { elements, end } => {
                for element in elements {
                    self.replace_in_element(element, field)?;
                }
                self.replace_in_end(end, field)
            }
            BodySheet::RigidMass(mass) => self.replace(mass, field),
            BodySheet::LongRod { diameter, .. } => self.replace(diameter, field),
            BodySheet::Impedance(impedance) => self.replace(impedance, field),
            BodySheet::Measured(_) => Ok(()),
            BodySheet::Assembly(assembly) => {
                let bodies = assembly.members.iter_mut();
                for body in bodies.filter_map(|member| member.body.as_mut()) {
                    self.replace_in_body(body, field)?;
                }
                for joint in &mut assembly.joints {
                    if let Some(stiffness) = &mut joint.stiffness {
                        self.replace(stiffness, field)?;
                    }
                    if let Some(resistance) = &mut joint.resistance {
                        self.replace(resistance, field)?;
                    }
                }
                Ok(())
            }
        }
    }

    fn replace_in_element(
        &mut self,
        element: &mut ElementSheet,
        field: &str,
    ) -> Result<(), RodlabError> {
        match element {
            ElementSheet::Rod {
                diameter, length, ..
            } => {
                self.replace(diameter, field)?;
                self.replace(length, field)
            }
            ElementSheet::Cone {
                near, far, length, ..
            }
            | ElementSheet::Horn {
                near, far, length, ..
            } => {
                self.replace(near, field)?;
                self.replace(far, field)?;
                self.replace(length, field)
            }
            ElementSheet::Mass(mass) => self.replace(mass, field),
            ElementSheet::Spring(stiffness) => self.replace(stiffness, field),
            ElementSheet::Dashpot(resistance) => self.replace(resistance, field),
        }
    }

    fn replace_in_end(&mut self, end: &mut EndSheet, field: &str) -> Result<(), RodlabError> {
        match end {
            EndSheet::Free | EndSheet::Fixed => Ok(()),
            EndSheet::Mass(mass) => self.replace(mass, field),
            EndSheet::Dashpot(resistance) => self.replace(resistance, field),
            EndSheet::LongRod { diameter, .. } => self.replace(diameter, field),
        }
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
    fn replace<K: Kind>(&mut self, stated: &mut Stated<K>, field: &str) -> Result<(), RodlabError> {
        stated.exact(field, self.why)?;
        Ok(())
    }

    fn standard(&mut self, _source: &str) -> Result<f64, RodlabError> {
        Ok(0.0) // a job without uncertainty has no law from a result
    }
}
