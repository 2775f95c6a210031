//! The sheet of two bodies that meet.

use impulse::{ContactLaw, ElasticMaterial, TabulatedContact};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

use crate::bodies::face::BodySheet;
use crate::sheet::{
    Duration, Exact, Force, Frequency, Length, Pressure, Ratio, Stated, Stiffness, Velocity,
};
use crate::{InStep, Outcome, RodlabError};

/// Two bodies that meet.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImpactSheet {
    /// The moving body.
    pub first: BodySheet,
    /// The body at rest.
    pub second: BodySheet,
    /// Relative velocity before they meet.
    pub velocity: Stated<Velocity>,
    /// Duration of the computed force.
    pub duration: Exact<Duration>,
    /// Upper end of the band of the reported force, such as `"10 kHz"`, at which a Gaussian
    /// low-pass is 3 dB down; by default 10 kHz (Ödeen 1993, paper E), or half of the highest
    /// frequency of a measured body.
    pub band: Option<Exact<Frequency>>,
    /// Time step of the march; by default chosen for the band.
    pub time_step: Option<Exact<Duration>>,
    /// Law of the contact.
    #[serde(default)]
    pub contact: ContactSheet,
    /// Lines for the method of paper E, which computes the stick force by the Fourier transform, in
    /// addition to the march. By default all lines of a measured body, and none for computed
    /// bodies.
    pub lines: Option<Line>,
    /// Settings for the propagation of the uncertainties stated with ± to the force.
    pub uncertainty: Option<UncertaintySheet>,
}

/// Law of the contact.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ContactSheet {
    /// Rigid faces.
    #[default]
    Rigid,
    /// A spring.
    Linear(Stated<Stiffness>),
    /// The end face of a thin rod on the plane face of a wide body.
    FlatPunch {
        /// Radius of the thin rod.
        radius: Stated<Length>,
        /// Young's modulus of the wide body.
        modulus: Stated<Pressure>,
        /// Poisson's ratio of the wide body.
        poisson_ratio: Stated<Ratio>,
    },
    /// A spherical face on a plane face.
    Sphere {
        /// Radius of the sphere.
        radius: Stated<Length>,
        /// Young's moduli of the sphere and of the plane body, in this order.
        moduli: (Stated<Pressure>, Stated<Pressure>),
        /// Poisson's ratios of the sphere and of the plane body, in this order.
        poisson_ratios: (Stated<Ratio>, Stated<Ratio>),
    },
    /// A measured law: pairs of approach and force, in increasing order.
    Table(Vec<(Stated<Length>, Stated<Force>)>),
}

impl ContactSheet {
    pub(super) fn law(&self) -> Result<ContactLaw, RodlabError> {
        let material =
            |modulus: &Stated<Pressure>, poisson_ratio: &Stated<Ratio>| ElasticMaterial {
                modulus: modulus.nominal(),
                poisson_ratio: poisson_ratio.nominal(),
            };
        match self {
            Self::Rigid => Ok(ContactLaw::Rigid),
            Self::Linear(stiffness) => ContactLaw::linear(stiffness.nominal()),
            Self::FlatPunch {
                radius,
                modulus,
                poisson_ratio,
            } => ContactLaw::flat_punch(radius.nominal(), material(modulus, poisson_ratio)),
            Self::Sphere {
                radius,
                moduli,
                poisson_ratios,
            } => ContactLaw::hertz_sphere(
                radius.nominal(),
                material(&moduli.0, &poisson_ratios.0),
                material(&moduli.1, &poisson_ratios.1),
            ),
            Self::Table(points) => {
                // the law begins where the faces touch
                let stated = points.iter().map(|(d, f)| (d.nominal(), f.nominal()));
                let points: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(stated).collect();
                TabulatedContact::new(&points).map(ContactLaw::Tabulated)
            }
        }
        .in_step("problem.contact")
    }

    pub(super) fn in_words(&self) -> &'static str {
        match self {
            Self::Rigid => "a rigid contact",
            Self::Linear(_) => "a spring",
            Self::FlatPunch { .. } => "the face of a thin rod on a wide body",
            Self::Sphere { .. } => "a spherical face on a plane face",
            Self::Table(_) => "a measured law",
        }
    }
}

/// A band of lines.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Highest frequency, such as `"10 kHz"`.
    pub up_to: Exact<Frequency>,
    /// Number of samples of the force per period before interpolation, such as 2048; half of it is
    /// the number of lines above 0 Hz. Must not be stated for a measured body, whose own lines are
    /// used.
    pub samples: Option<usize>,
    /// Beginning of a raised cosine that reduces the spectrum to zero at the highest frequency; by
    /// default none.
    pub roll_off_from: Option<Exact<Frequency>>,
}

/// Propagation of the uncertainties stated with ± to the force.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct UncertaintySheet {
    /// Number of draws; by default 400 for the force on lines, 200 for the march.
    pub draws: Option<usize>,
    /// Seed of the draws; by default 1.
    pub seed: Option<u64>,
    /// Probability of the bands; by default 95 %.
    pub level: Option<Exact<Ratio>>,
}

/// Default seed of the draws.
pub(super) const SEED: u64 = 1;
/// Default probability of the bands.
const LEVEL: f64 = 0.95;

impl UncertaintySheet {
    /// Returns the number of draws, which is `usual` by default, the probability of the bands, and
    /// random numbers. The defaults are entered in `outcome`.
    pub(super) fn settled(&self, usual: usize, outcome: &mut Outcome) -> (usize, f64, ChaCha8Rng) {
        let draws = self.draws.unwrap_or(usual);
        let seed = self.seed.unwrap_or(SEED);
        let level = self.level.as_ref().map_or(LEVEL, Exact::si);
        outcome.by_default("problem.uncertainty.draws", draws);
        let name = "problem.uncertainty.seed";
        if outcome.settings.iter().all(|known| known.name != name) {
            outcome.by_default(name, seed);
        }
        outcome.by_default("problem.uncertainty.level", level);
        (draws, level, ChaCha8Rng::seed_from_u64(seed))
    }
}
