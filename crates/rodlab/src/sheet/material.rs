//! Materials of a sheet.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use rodwave::medium::Medium;
use rodwave::modulus::{
    ComplexModulus, ConstantQ, Elastic, FractionalZener, GeneralisedMaxwell, KelvinVoigt,
    LaplaceModulus, Maxwell, MaxwellBranch, PowerLawPropagation, Zener,
};
use serde::Deserialize;

use super::plausible;
use super::{Density, Duration, Frequency, Pressure, Ratio, Stated, Viscosity};
use crate::RodlabError;

/// Frequency \[Hz\] of the waves whose speed is checked: rods of a laboratory ring there.
const SOMEWHERE_HZ: f64 = 1e3;

/// Materials by the names that the rest of the sheet calls them.
pub type Materials = BTreeMap<String, MaterialSheet>;

/// A material: density and law.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialSheet {
    /// Density, as `"1150 kg/m3"`.
    pub density: Stated<Density>,
    /// Law of the modulus.
    pub law: LawSheet,
    /// Whether a wave speed that no solid has is meant.
    #[serde(default)]
    pub unusual: bool,
}

/// Laws of the modulus.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LawSheet {
    /// No losses.
    Elastic {
        /// Young's modulus, as `"206 GPa"`.
        modulus: Stated<Pressure>,
    },
    /// The same loss factor at all frequencies.
    ConstantQ {
        /// Absolute value of the modulus at the reference frequency.
        modulus: Stated<Pressure>,
        /// Loss factor.
        loss_factor: Stated<Ratio>,
        /// Reference frequency.
        at: Stated<Frequency>,
    },
    /// Spring and dashpot side by side.
    KelvinVoigt {
        /// Young's modulus.
        modulus: Stated<Pressure>,
        /// Viscosity, as `"20 kPa s"`.
        viscosity: Stated<Viscosity>,
    },
    /// Spring and dashpot in a row.
    Maxwell {
        /// Young's modulus.
        modulus: Stated<Pressure>,
        /// Viscosity, as `"2 MPa s"`.
        viscosity: Stated<Viscosity>,
    },
    /// Three elements.
    Zener {
        /// Modulus of slow processes.
        relaxed: Stated<Pressure>,
        /// Modulus of fast processes.
        unrelaxed: Stated<Pressure>,
        /// Relaxation time.
        relaxation_time: Stated<Duration>,
    },
    /// Three elements, the dashpot replaced by a fractional one.
    FractionalZener {
        /// Modulus of slow processes.
        relaxed: Stated<Pressure>,
        /// Modulus of fast processes.
        unrelaxed: Stated<Pressure>,
        /// Relaxation time.
        relaxation_time: Stated<Duration>,
        /// Exponent, above 0 and up to 1.
        exponent: Stated<Ratio>,
    },
    /// Maxwell branches beside a spring.
    Prony {
        /// Modulus of the spring; absent for none.
        #[serde(default)]
        equilibrium: Option<Stated<Pressure>>,
        /// Branches: modulus and relaxation time.
        branches: Vec<BranchSheet>,
    },
    /// Fit of powers to damping and wave number, as of paper E (eq. 7): alpha = a omega^p, k = b omega^q with omega in rad/s. It is causal for no
    /// choice of the numbers, and known for real frequencies only.
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

/// Any law that is analytic in the right half plane.
#[derive(Clone)]
pub struct AnalyticLaw(Arc<dyn LaplaceModulus + Send + Sync>);

impl fmt::Debug for AnalyticLaw {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("AnalyticLaw").finish_non_exhaustive()
    }
}

impl ComplexModulus for AnalyticLaw {
    fn at(&self, omega: f64) -> Complex64 {
        self.0.at(omega)
    }
}

impl LaplaceModulus for AnalyticLaw {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.0.at_s(s)
    }
}

/// A material that waves can run in.
#[derive(Debug, Clone)]
pub enum Material {
    /// Known in the right half plane.
    Analytic(Medium<AnalyticLaw>),
    /// Known for real frequencies.
    OnAxis(Medium<PowerLawPropagation>),
}

impl Material {
    /// Damping alpha [1/m] and wave number k [rad/m] together, as alpha + ik, at `frequency_hz`.
    #[must_use]
    pub fn propagation_coefficient(&self, frequency_hz: f64) -> Complex64 {
        match self {
            Self::Analytic(medium) => medium.propagation_coefficient(TAU * frequency_hz),
            Self::OnAxis(medium) => medium.propagation_coefficient(TAU * frequency_hz),
        }
    }
}

impl MaterialSheet {
    /// The material; `field` is its place in the sheet.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] with what `rodwave` says of its numbers; [`RodlabError::Request`] for a wave speed that no solid has.
    pub fn material(&self, field: &str) -> Result<Material, RodlabError> {
        let material = self.any_material(field)?;
        let wave_number = material.propagation_coefficient(SOMEWHERE_HZ).im;
        plausible::wave_speed(TAU * SOMEWHERE_HZ / wave_number, self.unusual, field)?;
        Ok(material)
    }

    fn any_material(&self, field: &str) -> Result<Material, RodlabError> {
        let refused = |error| RodlabError::step(field, error);
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
            } => {
                let branches = branches
                    .iter()
                    .map(|branch| MaxwellBranch {
                        modulus: branch.modulus.nominal(),
                        relaxation_time: branch.relaxation_time.nominal(),
                    })
                    .collect();
                let spring = equilibrium.as_ref().map_or(0.0, Stated::nominal);
                Arc::new(GeneralisedMaxwell::new(spring, branches).map_err(refused)?)
            }
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
                let medium = Medium::new(self.density.nominal(), law).map_err(refused)?;
                return Ok(Material::OnAxis(medium));
            }
        };
        let medium = Medium::new(self.density.nominal(), AnalyticLaw(law)).map_err(refused)?;
        Ok(Material::Analytic(medium))
    }
}

/// The material called `name`; `field` is the place where it is called so.
///
/// # Errors
///
/// [`RodlabError::Request`] with the names there are.
pub fn material_called(
    materials: &Materials,
    name: &str,
    field: &str,
) -> Result<Material, RodlabError> {
    let Some(sheet) = materials.get(name) else {
        let known: Vec<String> = materials.keys().map(|name| format!("`{name}`")).collect();
        return Err(RodlabError::request(
            field,
            format!("`{name}`"),
            if known.is_empty() {
                "a material, and `materials` has none".to_owned()
            } else {
                format!("one of the materials {}", known.join(", "))
            },
        ));
    };
    sheet.material(&format!("materials: {name}"))
}
