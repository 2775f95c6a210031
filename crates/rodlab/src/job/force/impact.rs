//! The force when two bodies meet.

use impulse::{
    ContactLaw, ElasticMaterial, FirstForce, ImpactNumbers, Prediction, PredictionFlag,
    TabulatedContact, UncertainPrediction,
};
use serde::Deserialize;

use super::bodies::FaceBody;
use super::impact_lines::{Line, OnLines, UncertaintySheet, on_lines};
use super::impact_march;
use super::{impact_figures, impact_tables};
use crate::bodies::face::BodySheet;
use crate::bodies::material_sheet::Materials;
use crate::job::JobContext;
use crate::outcome::Verdict;
use crate::sheet::{
    Duration, Exact, Force, Frequency, Length, Pressure, Ratio, Stated, Stiffness, Velocity,
};
use crate::{Outcome, RodlabError};

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
    /// Upper end of the band of the stated force, such as `"10 kHz"`, where a Gaussian low-pass is
    /// 3 dB down; by default 10 kHz (Ödeen 1993, paper E), or the highest frequency of a
    /// measured body.
    #[serde(default)]
    pub band: Option<Exact<Frequency>>,
    /// Step of the march; chosen for the band unless stated.
    #[serde(default)]
    pub time_step: Option<Exact<Duration>>,
    /// Law of the contact.
    #[serde(default)]
    pub contact: ContactSheet,
    /// The method of paper E in addition: the stick force by the Fourier transform on lines up to
    /// a frequency. By default used for a measured body, on all its lines.
    #[serde(default)]
    pub lines: Option<Line>,
    /// Propagation of the uncertainties stated with ± to the force.
    #[serde(default)]
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
    /// The face of a thin rod on the plane face of a wide body.
    FlatPunch {
        /// Radius of the thin rod.
        radius: Stated<Length>,
        /// Young's modulus of the wide body.
        modulus: Stated<Pressure>,
        /// Its Poisson ratio.
        poisson_ratio: Stated<Ratio>,
    },
    /// A spherical face on a plane one.
    Sphere {
        /// Radius of the sphere.
        radius: Stated<Length>,
        /// Young's modulus of the sphere, then of the plane body.
        moduli: (Stated<Pressure>, Stated<Pressure>),
        /// Poisson ratio of the sphere, then of the plane body.
        poisson_ratios: (Stated<Ratio>, Stated<Ratio>),
    },
    /// A measured law: approach and force, from small to large.
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
                // the law begins at the touch of the faces
                let stated = points.iter().map(|(d, f)| (d.nominal(), f.nominal()));
                let points: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(stated).collect();
                TabulatedContact::new(&points).map(ContactLaw::Tabulated)
            }
        }
        .map_err(|error| RodlabError::step("problem.contact", error))
    }

    pub(super) fn in_words(&self) -> &'static str {
        match self {
            Self::Rigid => "faces that do not give way",
            Self::Linear(_) => "a spring",
            Self::FlatPunch { .. } => "the face of a thin rod on a wide body",
            Self::Sphere { .. } => "a spherical face on a plane one",
            Self::Table(_) => "a measured law",
        }
    }
}

/// The computed results.
pub(super) struct Found {
    /// The force by marching in time; `None` if a measured body has no front impedance.
    pub(super) march: Option<UncertainPrediction>,
    pub(super) on_lines: Option<OnLines>,
}

pub(super) fn run(
    sheet: &ImpactSheet,
    materials: &Materials,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let first = FaceBody::read(&sheet.first, materials, "problem.first", context, outcome)?;
    let second = FaceBody::read(&sheet.second, materials, "problem.second", context, outcome)?;
    let bodies = [&first, &second];
    let marched = bodies.iter().all(|body| body.can_be_marched());
    if !marched && !matches!(sheet.contact, ContactSheet::Rigid) {
        return Err(RodlabError::request(
            "problem.contact",
            sheet.contact.in_words(),
            "`Rigid`, or the `front_impedance` of the measured bodies: a contact that gives way is marched in time",
        ));
    }
    if let (false, Some(step)) = (marched, &sheet.time_step) {
        return Err(RodlabError::request(
            "problem.time_step",
            step.to_string(),
            "no statement, or the `front_impedance` of the measured bodies: without it nothing is marched in time",
        ));
    }
    defaults(sheet, bodies, marched, outcome)?;
    context.has_read_all(&outcome.inputs)?;

    context.progress.begins("force", 0);
    let found = Found {
        march: if marched {
            Some(impact_march::march(sheet, materials, bodies, context)?)
        } else {
            None
        },
        on_lines: on_lines(sheet, materials, bodies, outcome)?,
    };
    context.check_cancelled()?;
    if let Some(march) = &found.march {
        flags(&march.prediction, outcome);
        answer(sheet, march, outcome);
        impact_tables::quantities(march, outcome);
        outcome.tables.push(impact_tables::limited(march)?);
        outcome.tables.push(impact_tables::history(march));
        outcome
            .tables
            .push(impact_tables::contacts(&march.prediction));
    }
    if let Some(lines) = &found.on_lines {
        if found.march.is_none() {
            outcome.tables.push(lines.until_the_faces_part());
            outcome.summary.extend(lines.answer(sheet));
            outcome.warnings.push(
                "No `front_impedance` is stated of a measured body, and its lines do not tell what it does above them: there is no force by marching in time, no \
                 force without a limit to the band, and nothing after the first contact."
                    .to_owned(),
            );
        }
        outcome
            .quantities
            .extend(lines.quantities(found.march.is_none()));
        outcome.tables.push(lines.table());
    }
    if sheet
        .velocity
        .with_uncertainty()
        .standard_uncertainty
        .is_none()
    {
        outcome.warnings.push(
            "No uncertainty of the velocity is stated: it is in no error of the force, and the relative error of the force is at least that of the velocity."
                .to_owned(),
        );
    }
    outcome.figures = impact_figures::all(&found, bodies, sheet)?;
    Ok(())
}

/// What is taken of all that the sheet may leave open.
fn defaults(
    sheet: &ImpactSheet,
    bodies: [&FaceBody; 2],
    marched: bool,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    if marched {
        outcome.by_default("problem.time_step", "chosen for the band");
        let band = impact_march::band_in_words(impact_march::band(sheet, bodies)?);
        outcome.by_default("problem.band", band);
        let uncertainty = sheet.uncertainty.as_ref();
        if uncertainty.is_none_or(|stated| stated.draws.is_none()) {
            outcome.by_default("problem.uncertainty.draws_of_march", impact_march::DRAWS);
        }
        outcome.by_default("problem.uncertainty.seed", impact_march::SEED);
    }
    outcome.by_default("problem.contact", ContactSheet::default().in_words());
    Ok(())
}

/// Objections to the prediction; there is no answer for a body that generates energy.
fn flags(prediction: &Prediction, outcome: &mut Outcome) {
    for flag in &prediction.flags {
        match flag {
            PredictionFlag::MakesEnergy { .. } | PredictionFlag::UnresolvedContact { .. } => {
                outcome.verdict = Verdict::NotAllowed {
                    reason: flag.to_string(),
                };
            }
            _ => outcome.warnings.push(flag.to_string()),
        }
    }
}

fn answer(sheet: &ImpactSheet, march: &UncertainPrediction, outcome: &mut Outcome) {
    let numbers = march.numbers();
    let errors = march.errors();
    let error = |of: &dyn Fn(&ImpactNumbers) -> Option<f64>| errors.as_ref().and_then(of);
    let stated = |error: Option<f64>, unit: &str, scale: f64, digits: usize| {
        error.map_or_else(String::new, |error| {
            format!(" ± {:.digits$} {unit}", scale * error)
        })
    };
    let in_band = march.limited.smooth_peak();
    let band_khz = impact_march::khz(march.band.upper_hz());
    outcome.summary.push(format!(
        "In the band up to {band_khz} kHz the force comes to {:.1} N{} at {:.4} ms, at an impact velocity of {}.",
        in_band.force,
        stated(error(&|e| e.limited_peak), "N", 1.0, 2),
        1e3 * in_band.time,
        sheet.velocity,
    ));
    outcome.summary.push(match march.first_force {
        FirstForce::Unbounded => {
            "Without a limit to the band the first force has no bound: the impedance of a face grows with frequency without end, and the force of the first \
             step depends on the step."
                .to_owned()
        }
        _ => format!(
            "Without a limit to the band it comes to {:.1} N{} at {:.4} ms.",
            numbers.peak.unwrap_or(f64::NAN),
            stated(error(&|e| e.peak), "N", 1.0, 2),
            1e3 * numbers.time_of_peak.unwrap_or(f64::NAN),
        ),
    });
    let prediction = &march.prediction;
    let counting = prediction.main_contacts().count();
    let plural = if counting == 1 { "" } else { "s" };
    let pressing = prediction.flags.contains(&PredictionFlag::StillInContact);
    outcome.summary.push(if pressing {
        format!("The last of {counting} contact{plural} with more than a thousandth of the impulse lasts at the end: the faces still press.")
    } else {
        format!(
            "The last of {counting} contact{plural} with more than a thousandth of the impulse ends at {:.4} ms{}.",
            1e3 * prediction.duration(),
            stated(error(&|e| e.end), "us", 1e6, 3),
        )
    });
    let balance = prediction.balance();
    let restitution = match balance.restitution {
        _ if pressing => {
            "the faces still press, so that there is no coefficient of restitution".to_owned()
        }
        None => "neither body is free, so that there is no coefficient of restitution".to_owned(),
        Some(e) => format!("the coefficient of restitution is {e:.4}"),
    };
    outcome.summary.push(format!(
        "The impulse is {:.5} N s{}; {restitution}; work and energy agree to {} of the impulse times the velocity.",
        balance.impulse,
        stated(error(&|e| e.impulse), "N s", 1.0, 5),
        match balance.energy_residual.abs() {
            none if none <= 0.0 => "rounding".to_owned(),
            part => format!("{part:.0e}"),
        },
    ));
}
