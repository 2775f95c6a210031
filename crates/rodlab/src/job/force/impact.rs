//! The force when two bodies meet.

use impulse::{ContactLaw, ElasticMaterial, Impact, Prediction, PredictionFlag, TabulatedContact};
use serde::Deserialize;

use super::bodies::FaceBody;
use super::impact_lines::{Line, OnLines, UncertaintySheet, on_lines};
use super::{impact_figures, impact_tables};
use crate::job::Surroundings;
use crate::outcome::{Setting, Verdict};
use crate::sheet::body::BodySheet;
use crate::sheet::material::Materials;
use crate::sheet::{
    Duration, Exact, Force, Length, NotFollowed, Pressure, Ratio, Stated, Stiffness, Velocity,
};
use crate::{Outcome, RodlabError};

/// Two bodies that meet.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImpactSheet {
    /// The body that moves.
    pub first: BodySheet,
    /// The body at rest.
    pub second: BodySheet,
    /// Relative velocity before they meet.
    pub velocity: Stated<Velocity>,
    /// How long the force is followed.
    pub duration: Exact<Duration>,
    /// Step of the march; chosen for the bodies unless stated.
    #[serde(default)]
    pub time_step: Option<Exact<Duration>>,
    /// Law of the contact.
    #[serde(default)]
    pub contact: ContactSheet,
    /// The paper's own way besides: the stick force by the Fourier transform on lines up to a frequency. By default where a body was
    /// measured, on all its lines.
    #[serde(default)]
    pub lines: Option<Line>,
    /// How the errors of velocity and mobilities are followed to the stick force on lines.
    #[serde(default)]
    pub uncertainty: Option<UncertaintySheet>,
}

/// Law of the contact.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ContactSheet {
    /// Faces that do not give way.
    #[default]
    Rigid,
    /// A spring.
    Linear(NotFollowed<Stiffness>),
    /// The face of a thin rod on the plane face of a wide body.
    FlatPunch {
        /// Radius of the thin rod.
        radius: NotFollowed<Length>,
        /// Young's modulus of the wide body.
        modulus: NotFollowed<Pressure>,
        /// Its Poisson ratio.
        poisson_ratio: NotFollowed<Ratio>,
    },
    /// A spherical face on a plane one.
    Sphere {
        /// Radius of the sphere.
        radius: NotFollowed<Length>,
        /// Young's modulus of the sphere, then of the plane body.
        moduli: (NotFollowed<Pressure>, NotFollowed<Pressure>),
        /// Poisson ratio of the sphere, then of the plane body.
        poisson_ratios: (NotFollowed<Ratio>, NotFollowed<Ratio>),
    },
    /// A measured law: approach and force, from small to large.
    Table(Vec<(NotFollowed<Length>, NotFollowed<Force>)>),
}

impl ContactSheet {
    fn law(&self) -> Result<ContactLaw, RodlabError> {
        let material =
            |modulus: &NotFollowed<Pressure>, poisson_ratio: &NotFollowed<Ratio>| ElasticMaterial {
                modulus: modulus.si(),
                poisson_ratio: poisson_ratio.si(),
            };
        match self {
            Self::Rigid => Ok(ContactLaw::Rigid),
            Self::Linear(stiffness) => ContactLaw::linear(stiffness.si()),
            Self::FlatPunch {
                radius,
                modulus,
                poisson_ratio,
            } => ContactLaw::flat_punch(radius.si(), material(modulus, poisson_ratio)),
            Self::Sphere {
                radius,
                moduli,
                poisson_ratios,
            } => ContactLaw::hertz_sphere(
                radius.si(),
                material(&moduli.0, &poisson_ratios.0),
                material(&moduli.1, &poisson_ratios.1),
            ),
            Self::Table(points) => {
                let points: Vec<(f64, f64)> =
                    points.iter().map(|(d, f)| (d.si(), f.si())).collect();
                TabulatedContact::new(&points).map(ContactLaw::Tabulated)
            }
        }
        .map_err(|error| RodlabError::step("problem.contact", error))
    }

    fn in_words(&self) -> &'static str {
        match self {
            Self::Rigid => "faces that do not give way",
            Self::Linear(_) => "a spring",
            Self::FlatPunch { .. } => "the face of a thin rod on a wide body",
            Self::Sphere { .. } => "a spherical face on a plane one",
            Self::Table(_) => "a measured law",
        }
    }
}

/// Everything that was computed.
pub(super) struct Found {
    pub(super) prediction: Prediction,
    /// The same at a velocity that is one standard uncertainty higher.
    pub(super) faster: Option<Prediction>,
    pub(super) on_lines: Option<OnLines>,
}

impl Found {
    /// Standard error of the peak: of velocity and mobilities where the stick force on lines tells it, else of the velocity alone.
    pub(super) fn peak_error(&self) -> Option<f64> {
        let peak = self.prediction.peak();
        let on_lines = self
            .on_lines
            .as_ref()
            .and_then(|lines| lines.error_near(peak.time));
        on_lines.or_else(|| {
            let faster = self.faster.as_ref()?;
            Some((faster.peak().force - peak.force).abs())
        })
    }

    /// Change of the force \[N\] in every step for one standard uncertainty of the velocity.
    pub(super) fn force_errors(&self) -> Option<Vec<f64>> {
        let faster = self.faster.as_ref()?.history.force();
        let here = self.prediction.history.force();
        Some(
            faster
                .iter()
                .zip(here)
                .map(|(a, b)| (a - b).abs())
                .collect(),
        )
    }
}

pub(super) fn run(
    sheet: &ImpactSheet,
    materials: &Materials,
    around: &Surroundings<'_>,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let first = FaceBody::read(&sheet.first, materials, "problem.first", around, outcome)?;
    let second = FaceBody::read(&sheet.second, materials, "problem.second", around, outcome)?;
    let law = sheet.contact.law()?;
    settings(sheet, outcome);
    around.has_read_all()?;

    around.progress.begins("force", 0);
    let found = predict(sheet, [&first, &second], law, outcome)?;
    around.go_on()?;
    flags(&found.prediction, outcome);
    answer(sheet, &found, outcome);
    impact_tables::quantities(sheet, &found, outcome);
    outcome.tables.push(impact_tables::history(&found));
    outcome
        .tables
        .push(impact_tables::contacts(&found.prediction));
    if let Some(lines) = &found.on_lines {
        outcome.tables.push(lines.table());
    }
    outcome.figures = impact_figures::all(&found, [&first, &second], sheet)?;
    Ok(())
}

fn predict(
    sheet: &ImpactSheet,
    [first, second]: [&FaceBody; 2],
    law: ContactLaw,
    outcome: &mut Outcome,
) -> Result<Found, RodlabError> {
    let bodies = [first.impact_body()?, second.impact_body()?];
    let duration = sheet.duration.si();
    let at = |velocity: f64| {
        let impact = Impact::between(&*bodies[0], &*bodies[1])
            .at_velocity(velocity)
            .through(law.clone());
        match &sheet.time_step {
            Some(step) => impact.in_steps_of(step.si()),
            None => impact,
        }
    };
    let refused = |error| RodlabError::step("problem", error);
    let stated = sheet.velocity.with_uncertainty();
    let velocity = stated.value;
    // the kernels do not depend on the velocity
    let discrete = at(velocity).discretised(duration).map_err(refused)?;
    let faster = stated
        .standard_uncertainty
        .filter(|uncertainty| *uncertainty > 0.0)
        .map(|uncertainty| discrete.at_velocity(velocity + uncertainty).predict())
        .transpose()
        .map_err(refused)?;
    let on_lines = on_lines(sheet, [first, second], outcome)?;
    Ok(Found {
        prediction: discrete.predict().map_err(refused)?,
        faster,
        on_lines,
    })
}

fn settings(sheet: &ImpactSheet, outcome: &mut Outcome) {
    let mut say = |name: &str, value: String, by_default: bool| {
        outcome.settings.push(Setting {
            name: format!("problem.{name}"),
            value,
            by_default,
        });
    };
    say("velocity", sheet.velocity.to_string(), false);
    say("duration", sheet.duration.to_string(), false);
    match &sheet.time_step {
        Some(step) => say("time_step", step.to_string(), false),
        None => say("time_step", "chosen for the bodies".to_owned(), true),
    }
    say(
        "contact",
        sheet.contact.in_words().to_owned(),
        matches!(sheet.contact, ContactSheet::Rigid),
    );
    if let Some(lines) = &sheet.lines {
        let samples = lines
            .samples
            .map_or_else(String::new, |samples| format!(", {samples} samples"));
        let roll_off = lines
            .roll_off_from
            .as_ref()
            .map_or_else(String::new, |from| format!(", rolled off from {from}"));
        say(
            "lines",
            format!("up to {}{samples}{roll_off}", lines.up_to),
            false,
        );
    }
}

/// What speaks against the prediction; a body that makes energy leaves no answer.
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

fn answer(sheet: &ImpactSheet, found: &Found, outcome: &mut Outcome) {
    let prediction = &found.prediction;
    let peak = prediction.peak();
    let error = found
        .peak_error()
        .map_or_else(String::new, |error| format!(" ± {error:.2} N"));
    let impulse = prediction.balance().impulse;
    let counts = |contact: &&impulse::ContactInterval| contact.impulse > 1e-3 * impulse;
    let counting = prediction.contacts.iter().filter(counts).count();
    outcome.summary.push(format!(
        "The force comes to {:.1} N{error} at {:.4} ms, at an impact velocity of {}; the last of {} contact{} with more than a thousandth of the impulse ends at {:.4} ms.",
        peak.force,
        1e3 * peak.time,
        sheet.velocity,
        counting,
        if counting == 1 { "" } else { "s" },
        1e3 * prediction.duration(),
    ));
    let balance = prediction.balance();
    let restitution = balance.restitution.map_or_else(
        || "neither body is free, so that there is no coefficient of restitution".to_owned(),
        |e| format!("the coefficient of restitution is {e:.4}"),
    );
    outcome.summary.push(format!(
        "The impulse is {:.5} N s; {restitution}; work and energy agree to {:.0e} of the impulse times the velocity.",
        balance.impulse,
        balance.energy_residual.abs(),
    ));
    if sheet.velocity.with_uncertainty().standard_uncertainty.is_none() {
        outcome.warnings.push(
            "no uncertainty of the velocity is stated: the force has no error; it is known no better than the velocity, in parts"
                .to_owned(),
        );
    }
}
