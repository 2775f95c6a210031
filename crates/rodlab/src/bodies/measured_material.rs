//! Materials of a sheet whose law and density are those of an earlier result.

use std::sync::Arc;

use cmod::rheology::FittedLaw;
use rodwave::medium::Medium;
use rodwave::modulus::LaplaceModulus;

use super::material::Material;
use crate::RodlabError;
use crate::material_file::MaterialFile;

/// Law and density of a result, moved by so many standard uncertainties of each independent error.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredMaterial {
    file: Arc<MaterialFile>,
    /// One for each error; none of a material as it was found.
    standard: Vec<f64>,
}

impl MeasuredMaterial {
    /// The material as it was found.
    pub(super) fn of(file: Arc<MaterialFile>) -> Self {
        Self {
            file,
            standard: Vec::new(),
        }
    }

    /// The material with every error moved by what `standard` says for its source.
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

    /// The material; `field` is its place in the sheet.
    pub(crate) fn material(&self, field: &str) -> Result<Material, RodlabError> {
        let (density, law) = self.file.moved(&self.standard, field)?;
        let law: Arc<dyn LaplaceModulus + Send + Sync> = match law {
            FittedLaw::Elastic(law) => Arc::new(law),
            FittedLaw::Maxwell(law) => Arc::new(law),
            FittedLaw::FractionalMaxwell(law) => Arc::new(law),
            FittedLaw::ConstantQ(law) => Arc::new(law),
            FittedLaw::SpringPot(law) => Arc::new(law),
            FittedLaw::KelvinVoigt(law) => Arc::new(law),
            FittedLaw::Zener(law) => Arc::new(law),
            FittedLaw::FractionalZener(law) => Arc::new(law),
            FittedLaw::HavriliakNegami(law) => Arc::new(law),
            FittedLaw::GeneralisedMaxwell(law) => Arc::new(law),
            FittedLaw::PowerLaw(law) => {
                let refused = |error| RodlabError::step(field, error);
                let law = law.law().map_err(refused)?;
                return Medium::new(density, law)
                    .map(Material::OnAxis)
                    .map_err(refused);
            }
            _ => {
                return Err(RodlabError::request(
                    field,
                    format!("the law of {}", self.file.title()),
                    "a law of this version of rodlab",
                ));
            }
        };
        Material::analytic(density, law, field)
    }

    /// Lowest and highest frequency of the data of the law \[Hz\].
    pub(crate) fn band_hz(&self) -> [f64; 2] {
        self.file.band_hz()
    }
}
