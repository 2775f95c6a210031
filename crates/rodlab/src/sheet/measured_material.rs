//! Materials of a sheet whose law and density are those of an earlier result.

use std::path::Path;
use std::sync::Arc;

use cmod::rheology::FittedLaw;
use rodwave::medium::Medium;
use rodwave::modulus::LaplaceModulus;

use super::material::{LawSheet, Material, MaterialSheet, Materials};
use crate::material_file::MaterialFile;
use crate::outcome::InputFile;
use crate::{Outcome, RodlabError, input};

/// Law and density of a result, moved by so many standard uncertainties of each independent error.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredMaterial {
    file: Arc<MaterialFile>,
    /// One for each error; none of a material as it was found.
    standard: Vec<f64>,
}

impl MeasuredMaterial {
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

/// The materials with every law from a result read; their files are inputs of the outcome, and
/// their doubts doubts of it.
pub(crate) fn read(
    materials: &Materials,
    folder: &Path,
    outcome: &mut Outcome,
) -> Result<Materials, RodlabError> {
    let mut found = materials.clone();
    for (name, material) in &mut found {
        if let LawSheet::Result(path) = &material.law {
            let field = format!("materials: {name}");
            if let Some(density) = &material.density {
                return Err(RodlabError::request(
                    format!("{field}.density"),
                    density.to_string(),
                    format!("no density: that of {path} belongs to its law"),
                ));
            }
            let file = Arc::new(of_file(path, &field, folder, outcome)?);
            for doubt in file.doubts() {
                outcome.doubt(format!("{field}: the law of {path} is in doubt: {doubt}"));
            }
            material.measured = Some(MeasuredMaterial {
                file,
                standard: Vec::new(),
            });
        }
    }
    Ok(found)
}

fn of_file(
    path: &str,
    field: &str,
    folder: &Path,
    outcome: &mut Outcome,
) -> Result<MaterialFile, RodlabError> {
    let full = folder.join(path);
    if !full.exists() {
        return Err(RodlabError::NoFile {
            pattern: path.to_owned(),
            folder: folder.to_path_buf(),
        });
    }
    let bytes = input::read(&full)?;
    outcome.inputs.push(InputFile {
        path: path.to_owned(),
        format: "material of a result".to_owned(),
        bytes: bytes.len() as u64,
        sha256: labio::ContentHash::of(&bytes).to_string(),
        pattern: None,
    });
    MaterialFile::read(&bytes, &format!("{field}: reading {path}"))
}

impl MaterialSheet {
    /// Lowest and highest frequency of the data of a law from a result \[Hz\].
    pub(crate) fn measured_band_hz(&self) -> Option<[f64; 2]> {
        self.measured.as_ref().map(MeasuredMaterial::band_hz)
    }
}
