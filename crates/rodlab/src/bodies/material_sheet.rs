//! Materials of a sheet.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use rodwave::RodwaveError;
use rodwave::medium::Medium;
use rodwave::modulus::{
    ConstantQ, Elastic, FractionalZener, GeneralisedMaxwell, KelvinVoigt, LaplaceModulus, Maxwell,
    MaxwellBranch, PowerLawPropagation, Zener,
};
use serde::Deserialize;

use super::material::Material;
use super::measured_material::MeasuredMaterial;
use crate::material_file::MaterialFile;
use crate::outcome::InputFile;
use crate::sheet::plausible;
use crate::sheet::{
    Density, Duration, Frequency, Kind, Pressure, Ratio, Stated, Viscosity, quoted,
};
use crate::{InStep, Outcome, RodlabError, input};

/// Frequency \[Hz\] at which the wave speed is checked; it is typical of the resonances of
/// laboratory rods.
const SOMEWHERE_HZ: f64 = 1e3;

/// Materials by their names in the sheet.
pub type Materials = BTreeMap<String, MaterialSheet>;

/// A material: density and law.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialSheet {
    /// Density, such as `"1150 kg/m3"`; not stated for a law from a result, because the result
    /// contains the density.
    pub density: Option<Stated<Density>>,
    /// Law of the modulus.
    pub law: LawSheet,
    /// Confirms a wave speed outside the range of solids.
    #[serde(default)]
    pub unusual: bool,
    /// Law and density in the file of [`LawSheet::Result`], after it has been read.
    #[serde(skip)]
    pub(crate) measured: Option<MeasuredMaterial>,
}

/// Laws of the modulus.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LawSheet {
    /// No losses.
    Elastic {
        /// Young's modulus, such as `"206 GPa"`.
        modulus: Stated<Pressure>,
    },
    /// Same loss factor at all frequencies.
    ConstantQ {
        /// Absolute value of the modulus at the reference frequency.
        modulus: Stated<Pressure>,
        /// Loss factor.
        loss_factor: Stated<Ratio>,
        /// Reference frequency.
        at: Stated<Frequency>,
    },
    /// Spring and dashpot in parallel.
    KelvinVoigt {
        /// Young's modulus.
        modulus: Stated<Pressure>,
        /// Viscosity, such as `"20 kPa s"`.
        viscosity: Stated<Viscosity>,
    },
    /// Spring and dashpot in series.
    Maxwell {
        /// Young's modulus.
        modulus: Stated<Pressure>,
        /// Viscosity, such as `"2 MPa s"`.
        viscosity: Stated<Viscosity>,
    },
    /// Zener's law of three elements: a spring in parallel with a spring and a dashpot in series.
    Zener {
        /// Modulus at low frequency.
        relaxed: Stated<Pressure>,
        /// Modulus at high frequency.
        unrelaxed: Stated<Pressure>,
        /// Relaxation time.
        relaxation_time: Stated<Duration>,
    },
    /// Zener's law with a fractional dashpot.
    FractionalZener {
        /// Modulus at low frequency.
        relaxed: Stated<Pressure>,
        /// Modulus at high frequency.
        unrelaxed: Stated<Pressure>,
        /// Relaxation time.
        relaxation_time: Stated<Duration>,
        /// Exponent, above 0 and up to 1.
        exponent: Stated<Ratio>,
    },
    /// Maxwell branches in parallel with a spring.
    Prony {
        /// Modulus of the spring; absent if there is none.
        equilibrium: Option<Stated<Pressure>>,
        /// Branches, each with a modulus and a relaxation time.
        branches: Vec<BranchSheet>,
    },
    /// Power laws fitted to damping and wave number, as in paper E (eq. 7): alpha = a omega^p, k =
    /// b omega^q with omega in rad/s. In general the law is not causal; it is known for
    /// real frequencies only.
    PowerLawPropagation {
        /// a, for alpha in 1/m.
        damping_factor: f64,
        /// p.
        damping_exponent: f64,
        /// b, for k in rad/m.
        wave_number_factor: f64,
        /// q.
        wave_number_exponent: f64,
    },
    /// Law with its errors and density from an earlier result, stated by the path of the file
    /// `material.json`, relative to the sheet, such as `"nylon-result/material.json"`.
    Result(String),
}

impl LawSheet {
    /// Name of the law, such as `Prony`.
    fn kind(&self) -> String {
        let all = format!("{self:?}");
        let name = all.split(|c: char| !c.is_alphanumeric()).next();
        name.unwrap_or_default().to_owned()
    }

    /// Returns the law as springs and Maxwell branches; `None` if it cannot be written in this
    /// form.
    fn prony(&self) -> Option<Result<GeneralisedMaxwell, RodwaveError>> {
        let branch = |modulus: f64, relaxation_time: f64| {
            vec![MaxwellBranch {
                modulus,
                relaxation_time,
            }]
        };
        let (spring, branches) = match self {
            Self::Elastic { modulus } => (modulus.nominal(), Vec::new()),
            Self::Maxwell { modulus, viscosity } => {
                let modulus = modulus.nominal();
                (0.0, branch(modulus, viscosity.nominal() / modulus))
            }
            Self::Zener {
                relaxed,
                unrelaxed,
                relaxation_time,
            } => {
                let relaxed = relaxed.nominal();
                let step = unrelaxed.nominal() - relaxed;
                (relaxed, branch(step, relaxation_time.nominal()))
            }
            Self::Prony {
                equilibrium,
                branches,
            } => return Some(prony(equilibrium.as_ref(), branches)),
            _ => return None,
        };
        Some(GeneralisedMaxwell::new(spring, branches))
    }
}

fn prony(
    equilibrium: Option<&Stated<Pressure>>,
    branches: &[BranchSheet],
) -> Result<GeneralisedMaxwell, RodwaveError> {
    let branches = branches
        .iter()
        .map(|branch| MaxwellBranch {
            modulus: branch.modulus.nominal(),
            relaxation_time: branch.relaxation_time.nominal(),
        })
        .collect();
    GeneralisedMaxwell::new(equilibrium.map_or(0.0, Stated::nominal), branches)
}

/// A branch of [`LawSheet::Prony`].
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BranchSheet {
    /// Modulus.
    pub modulus: Stated<Pressure>,
    /// Relaxation time.
    pub relaxation_time: Stated<Duration>,
}

impl MaterialSheet {
    /// Returns the material; `field` is its place in the sheet.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] with the error of `rodwave`; [`RodlabError::Request`] for a wave speed
    /// or a density outside the range of solids.
    pub fn material(&self, field: &str) -> Result<Material, RodlabError> {
        let material = self.any_material(field)?;
        let wave_number = material.propagation_coefficient(SOMEWHERE_HZ).im;
        plausible::wave_speed(TAU * SOMEWHERE_HZ / wave_number, self.unusual, field)?;
        if let Some(density) = self.density.as_ref().filter(|_| !self.unusual) {
            plausible::density(density, format!("{field}.density"))?;
        }
        Ok(material)
    }

    /// Returns the stated density; `field` is the place of the material in the sheet.
    pub(crate) fn stated_density(&self, field: &str) -> Result<&Stated<Density>, RodlabError> {
        self.density.as_ref().ok_or_else(|| {
            RodlabError::request(
                field,
                "no density",
                format!("a density, such as {}", <Density as Kind>::EXAMPLE),
            )
        })
    }

    /// Returns the density \[kg/m³\] and the law as springs and Maxwell branches; `None` if the law
    /// cannot be written in this form. `field` is the place of the material in the sheet.
    pub(crate) fn prony(
        &self,
        field: &str,
    ) -> Result<Option<(f64, GeneralisedMaxwell)>, RodlabError> {
        if let Some(measured) = &self.measured {
            return measured.prony(field);
        }
        let Some(law) = self.law.prony() else {
            return Ok(None);
        };
        let law = law.in_step(field)?;
        Ok(Some((self.stated_density(field)?.nominal(), law)))
    }

    /// Returns density and law in words, for the settings.
    pub(crate) fn in_words(&self) -> String {
        match (&self.density, &self.law) {
            (None, LawSheet::Result(path)) => format!("law and density of {path}"),
            (Some(density), law) => format!("{}, density {density}", law.kind()),
            (None, law) => law.kind(),
        }
    }

    fn any_material(&self, field: &str) -> Result<Material, RodlabError> {
        if let Some(measured) = &self.measured {
            return measured.material(field);
        }
        let refused = |error| RodlabError::step(field, error);
        if let LawSheet::Result(path) = &self.law {
            return Err(RodlabError::request(
                field,
                format!("the law of the result {path}"),
                "a law with its numbers: this job does not propagate the errors of a result",
            ));
        }
        let density = self.stated_density(field)?.nominal();
        let law: Arc<dyn LaplaceModulus + Send + Sync> = match &self.law {
            LawSheet::Elastic { modulus } => {
                Arc::new(Elastic::new(modulus.nominal()).map_err(refused)?)
            }
            LawSheet::ConstantQ {
                modulus,
                loss_factor,
                at,
            } => Arc::new(
                ConstantQ::new(modulus.nominal(), loss_factor.nominal(), TAU * at.nominal())
                    .map_err(refused)?,
            ),
            LawSheet::KelvinVoigt { modulus, viscosity } => {
                Arc::new(KelvinVoigt::new(modulus.nominal(), viscosity.nominal()).map_err(refused)?)
            }
            LawSheet::Maxwell { modulus, viscosity } => {
                Arc::new(Maxwell::new(modulus.nominal(), viscosity.nominal()).map_err(refused)?)
            }
            LawSheet::Zener {
                relaxed,
                unrelaxed,
                relaxation_time,
            } => Arc::new(
                Zener::new(
                    relaxed.nominal(),
                    unrelaxed.nominal(),
                    relaxation_time.nominal(),
                )
                .map_err(refused)?,
            ),
            LawSheet::FractionalZener {
                relaxed,
                unrelaxed,
                relaxation_time,
                exponent,
            } => Arc::new(
                FractionalZener::new(
                    relaxed.nominal(),
                    unrelaxed.nominal(),
                    relaxation_time.nominal(),
                    exponent.nominal(),
                )
                .map_err(refused)?,
            ),
            LawSheet::Prony {
                equilibrium,
                branches,
            } => Arc::new(prony(equilibrium.as_ref(), branches).map_err(refused)?),
            LawSheet::PowerLawPropagation {
                damping_factor,
                damping_exponent,
                wave_number_factor,
                wave_number_exponent,
            } => {
                let law = PowerLawPropagation::new(
                    *damping_factor,
                    *damping_exponent,
                    *wave_number_factor,
                    *wave_number_exponent,
                )
                .map_err(refused)?;
                let medium = Medium::new(density, law).map_err(refused)?;
                return Ok(Material::OnAxis(medium));
            }
            // not reached: a law from a result is refused above
            LawSheet::Result(_) => return Err(RodlabError::request(field, "no law", "a law")),
        };
        Material::analytic(density, law, field)
    }
}

/// Returns the material called `name`; `field` is the place of the name in the sheet.
///
/// # Errors
///
/// [`RodlabError::Request`] with the existing names if there is no such material.
pub fn material_called(
    materials: &Materials,
    name: &str,
    field: &str,
) -> Result<Material, RodlabError> {
    let Some(sheet) = materials.get(name) else {
        let expected = if materials.is_empty() {
            "a material, but `materials` has none".to_owned()
        } else {
            format!("one of the materials {}", quoted(materials.keys()))
        };
        let found = format!("`{name}`");
        return Err(RodlabError::request(field, found, expected));
    };
    sheet.material(&format!("materials: {name}"))
}

impl MaterialSheet {
    /// Lowest and highest frequency \[Hz\] of the data behind a law from a result; `None` for other
    /// laws.
    pub(crate) fn measured_band_hz(&self) -> Option<[f64; 2]> {
        self.measured.as_ref().map(MeasuredMaterial::band_hz)
    }
}

/// Returns the materials after reading every law that comes from a result. The files become inputs
/// of the outcome, and doubts about their laws become doubts of the outcome.
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
                    format!("no density: {path} contains the density of its law"),
                ));
            }
            let file = Arc::new(of_file(path, &field, folder, outcome)?);
            for doubt in file.doubts() {
                outcome.doubt(format!("{field}: the law of {path} is in doubt: {doubt}"));
            }
            material.measured = Some(MeasuredMaterial::of(file));
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
        return Err(RodlabError::no_file(path, folder, field));
    }
    let bytes = input::read(&full)?;
    let input = InputFile::of(path, "material of a result", &bytes);
    outcome.inputs.push(input);
    MaterialFile::read(&bytes, &format!("{field}: reading {path}"))
}
