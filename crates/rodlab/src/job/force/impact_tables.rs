//! What was found of an impact as numbers and tables.

use impulse::{Prediction, PredictionFlag};

use super::impact::{Found, ImpactSheet};
use crate::Outcome;
use crate::outcome::{Column, Quantity, Table};

pub(super) fn quantities(sheet: &ImpactSheet, found: &Found, outcome: &mut Outcome) {
    let prediction = &found.prediction;
    let balance = prediction.balance();
    let finished = !prediction
        .flags
        .iter()
        .any(|flag| matches!(flag, PredictionFlag::StillInContact));
    let relative = sheet
        .velocity
        .with_uncertainty()
        .standard_uncertainty
        .map(|uncertainty| uncertainty / sheet.velocity.with_uncertainty().value);
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
        found.peak_error(),
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
    let bodies = balance.velocity_after.into_iter().zip(balance.inner);
    for (body, (velocity, inner)) in ["first", "second"].iter().zip(bodies) {
        add(
            &format!("velocity of the {body} body after"),
            "m/s",
            velocity,
            None,
            finished,
        );
        add(
            &format!("energy left in the {body} body"),
            "J",
            Some(inner),
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
        outcome.quantities.extend(lines.quantities());
    }
}

pub(super) fn history(found: &Found) -> Table {
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

pub(super) fn contacts(prediction: &Prediction) -> Table {
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
