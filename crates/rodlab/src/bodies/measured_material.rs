//! Materials of a sheet that take their law and density from an earlier result.

use std::sync::Arc;

use cmod::rheology::FittedLaw;
use rodwave::medium::Medium;
use rodwave::modulus::{DifferentiableModulus, GeneralisedMaxwell, MaxwellBranch};

use super::material::Material;
use crate::material_file::MaterialFile;
use crate::{InStep, RodlabError};

/// Law and density of a result. Each independent error is moved by a number of its standard
/// uncertainties.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredMaterial {
    file: Arc<MaterialFile>,
    /// Number of standard uncertainties, one per error; empty for the material as found.
    standard: Vec<f64>,
}

impl MeasuredMaterial {
    /// Returns the material as found.
    pub(super) fn of(file: Arc<MaterialFile>) -> Self {
        Self {
            file,
            standard: Vec::new(),
        }
    }

    /// Returns the material with every error moved by the number of standard uncertainties that
    /// `standard` returns for its source.
    pub(crate) fn moved(
        &self,
        mut standard: impl FnMut(&str) -> Result<f64, RodlabError>,
    ) -> Result<Self, RodlabError> {
        let sources = self.file.sources();
        Ok(Self {
            file: Arc::clone(&self.file),
            standard: sources.map(&mut standard).collect::<Result<_, _>>()?,
        })
    }

    /// Returns the material; `field` is its place in the sheet.
    pub(crate) fn material(&self, field: &str) -> Result<Material, RodlabError> {
        let (density, law) = self.file.moved(&self.standard, field)?;
        match law.into_analytic() {
            Ok(law) => Material::analytic(density, law, field),
            Err(law) => {
                let law = law.law().in_step(field)?;
                Medium::new(density, law)
                    .map(Material::OnAxis)
                    .in_step(field)
            }
        }
    }

    /// Returns the density \[kg/m³\] and the law as springs and Maxwell branches; `None` if the law
    /// cannot be written in this form. `field` is the place of the material in the sheet.
    pub(super) fn prony(
        &self,
        field: &str,
    ) -> Result<Option<(f64, GeneralisedMaxwell)>, RodlabError> {
        let (density, law) = self.file.moved(&self.standard, field)?;
        // the parameters are logarithms: of one modulus, of a modulus and a time, or of two moduli
        // and a time
        let numbers = match &law {
            FittedLaw::Elastic(law) => law.parameters(),
            FittedLaw::Maxwell(law) => law.parameters(),
            FittedLaw::Zener(law) => law.parameters(),
            FittedLaw::GeneralisedMaxwell(law) => return Ok(Some((density, law.clone()))),
            _ => return Ok(None),
        };
        let branch = |modulus: f64, time: f64| MaxwellBranch {
            modulus: modulus.exp(),
            relaxation_time: time.exp(),
        };
        let law = match *numbers {
            [modulus] => GeneralisedMaxwell::new(modulus.exp(), Vec::new()),
            [modulus, time] => GeneralisedMaxwell::new(0.0, vec![branch(modulus, time)]),
            [relaxed, step, time] => {
                GeneralisedMaxwell::new(relaxed.exp(), vec![branch(step, time)])
            }
            _ => return Ok(None),
        };
        let law = law.in_step(field)?;
        Ok(Some((density, law)))
    }

    /// Lowest and highest frequency \[Hz\] of the data from which the law was fitted.
    pub(crate) fn band_hz(&self) -> [f64; 2] {
        self.file.band_hz()
    }
}
