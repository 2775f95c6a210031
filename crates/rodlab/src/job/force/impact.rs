//! The force when two bodies meet.

use impulse::{
    ContactLaw, ElasticMaterial, Impact, LineBand, Prediction, PredictionFlag, StickForce,
    TabulatedContact,
};
use serde::Deserialize;

use super::impact_figures;
use crate::job::Surroundings;
use crate::outcome::{Column, Quantity, Setting, Table, Verdict};
use crate::sheet::body::{BodySheet, ComputedBody};
use crate::sheet::material::Materials;
use crate::sheet::{
    Duration, Force, Frequency, Length, Pressure, Ratio, Stated, Stiffness, Velocity,
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
    pub duration: Stated<Duration>,
    /// Step of the march; chosen for the bodies unless stated.
    #[serde(default)]
    pub time_step: Option<Stated<Duration>>,
    /// Law of the contact.
    #[serde(default)]
    pub contact: ContactSheet,
    /// The paper's own way besides: the stick force by the Fourier transform on lines up to a frequency.
    #[serde(default)]
    pub lines: Option<Line>,
}

/// A band of lines.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Highest frequency.
    pub up_to: Stated<Frequency>,
    /// Samples of the force over the period.
    pub samples: usize,
}

/// Law of the contact.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ContactSheet {
    /// Faces that do not give way.
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
    fn law(&self) -> Result<ContactLaw, RodlabError> {
        let material =
            |modulus: &Stated<Pressure>, poisson_ratio: &Stated<Ratio>| ElasticMaterial {
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
    pub(super) on_lines: Option<StickForce>,
}

impl Found {
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
    let first = sheet.first.body(materials, "problem.first")?;
    let second = sheet.second.body(materials, "problem.second")?;
    let law = sheet.contact.law()?;
    settings(sheet, outcome);
    around.has_read_all()?;

    around.progress.begins("force", 0);
    let found = predict(sheet, [&first, &second], law)?;
    flags(&found.prediction, outcome);
    answer(sheet, &found, outcome);
    quantities(sheet, &found, outcome);
    outcome.tables.push(history_table(&found));
    outcome.tables.push(contact_table(&found.prediction));
    outcome.figures = impact_figures::all(&found, [&first, &second], sheet)?;
    Ok(())
}

fn predict(
    sheet: &ImpactSheet,
    [first, second]: [&ComputedBody; 2],
    law: ContactLaw,
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
    let velocity = sheet.velocity.si();
    // the kernels do not depend on the velocity
    let discrete = at(velocity).discretised(duration).map_err(refused)?;
    let faster = sheet
        .velocity
        .standard_uncertainty()
        .filter(|uncertainty| *uncertainty > 0.0)
        .map(|uncertainty| discrete.at_velocity(velocity + uncertainty).predict())
        .transpose()
        .map_err(refused)?;
    let on_lines = sheet
        .lines
        .as_ref()
        .map(|lines| {
            at(velocity).stick_force_on_lines(LineBand {
                highest_hz: lines.up_to.si(),
                n_samples: lines.samples,
            })
        })
        .transpose()
        .map_err(|error| RodlabError::step("problem.lines", error))?;
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
        let value = format!("up to {}, {} samples", lines.up_to, lines.samples);
        say("lines", value, false);
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
    let error = peak_error(found).map_or_else(String::new, |error| format!(" ± {error:.2} N"));
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
    if sheet.velocity.standard_uncertainty().is_none() {
        outcome.warnings.push(
            "no uncertainty of the velocity is stated: the force has no error; it is known no better than the velocity, in parts"
                .to_owned(),
        );
    }
}

fn peak_error(found: &Found) -> Option<f64> {
    let faster = found.faster.as_ref()?;
    Some((faster.peak().force - found.prediction.peak().force).abs())
}

fn quantities(sheet: &ImpactSheet, found: &Found, outcome: &mut Outcome) {
    let prediction = &found.prediction;
    let balance = prediction.balance();
    let finished = !prediction
        .flags
        .iter()
        .any(|flag| matches!(flag, PredictionFlag::StillInContact));
    let relative = sheet
        .velocity
        .standard_uncertainty()
        .map(|uncertainty| uncertainty / sheet.velocity.si());
    let mut add = |name: &str, unit: &str, value: Option<f64>, error: Option<f64>, valid: bool| {
        outcome.quantities.push(Quantity {
            name: name.to_owned(),
            unit: unit.to_owned(),
            value,
            standard_error: error,
            valid: valid && value.is_some(),
            verdict: match (value, valid) {
                (None, _) => "not defined for these bodies".to_owned(),
                (_, true) => "computed from the bodies".to_owned(),
                (_, false) => "of an impact that is not over: follow it longer".to_owned(),
            },
        });
    };
    add(
        "peak force",
        "N",
        Some(prediction.peak().force),
        peak_error(found),
        true,
    );
    add(
        "time of the peak",
        "ms",
        Some(1e3 * prediction.peak().time),
        None,
        true,
    );
    add(
        "end of the last contact",
        "ms",
        Some(1e3 * prediction.duration()),
        None,
        finished,
    );
    let impulse_error = relative
        .zip(found.faster.as_ref())
        .map(|(_, faster)| (faster.balance().impulse - balance.impulse).abs());
    add(
        "impulse",
        "N s",
        Some(balance.impulse),
        impulse_error,
        finished,
    );
    add(
        "coefficient of restitution",
        "",
        balance.restitution,
        None,
        finished,
    );
    for (body, number) in ["first", "second"].iter().zip(0..) {
        let velocity: Option<f64> = balance.velocity_after[number];
        add(
            &format!("velocity of the {body} body after"),
            "m/s",
            velocity,
            None,
            finished,
        );
        let inner = Some(balance.inner[number]);
        add(
            &format!("energy left in the {body} body"),
            "J",
            inner,
            None,
            finished,
        );
    }
    add(
        "energy residual",
        "",
        Some(balance.energy_residual),
        None,
        true,
    );
    if let Some(lines) = &found.on_lines {
        let peak = lines.history.peak().force;
        add(
            "peak of the stick force on lines",
            "N",
            Some(peak),
            None,
            true,
        );
    }
}

fn history_table(found: &Found) -> Table {
    let prediction = &found.prediction;
    let history = &prediction.history;
    let steps = history.force().len();
    let in_contact = (0..steps)
        .map(|step| {
            let time = history.time_at(step);
            let touches = prediction
                .contacts
                .iter()
                .any(|contact| contact.begin <= time && contact.end.is_none_or(|end| time <= end));
            if touches { "contact" } else { "apart" }.to_owned()
        })
        .collect();
    let mut columns = vec![
        Column::numbers(
            "time",
            "s",
            (0..steps).map(|n| history.time_at(n)).collect(),
        ),
        Column::numbers("force", "N", history.force().to_vec()),
    ];
    if let Some(errors) = found.force_errors() {
        columns.push(Column::numbers("standard error of the force", "N", errors));
    }
    columns.extend([
        Column::numbers(
            "velocity of the first face",
            "m/s",
            prediction.face_velocity[0].clone(),
        ),
        Column::numbers(
            "velocity of the second face",
            "m/s",
            prediction.face_velocity[1].clone(),
        ),
        Column::numbers("approach of the faces", "m", prediction.approach.clone()),
        Column::words("state", in_contact),
    ]);
    Table {
        name: "force".to_owned(),
        title: "Force, faces and state of the contact".to_owned(),
        columns,
    }
}

fn contact_table(prediction: &Prediction) -> Table {
    let of = |value: &dyn Fn(&impulse::ContactInterval) -> f64| {
        prediction.contacts.iter().map(value).collect::<Vec<f64>>()
    };
    Table {
        name: "contacts".to_owned(),
        title: "Contacts".to_owned(),
        columns: vec![
            Column::numbers("begin", "s", of(&|contact| contact.begin)),
            Column::numbers("end", "s", of(&|contact| contact.end.unwrap_or(f64::NAN))),
            Column::numbers("impulse", "N s", of(&|contact| contact.impulse)),
            Column::numbers("largest force", "N", of(&|contact| contact.peak)),
        ],
    }
}
