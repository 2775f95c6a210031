//! Results of an impact as numbers and tables.

use impulse::{
    FirstForce, ForceBand, ImpactNumbers, Prediction, PredictionFlag, UncertainPrediction,
};

use super::histories::{times, with_band};
use super::impact_lines::OnLines;
use super::impact_march::{in_words, khz};
use crate::outcome::{Quantity, Rows, Table};
use crate::{InStep, Outcome, RodlabError};

/// The computed results.
pub(super) struct Found {
    /// Force by marching in time; `None` if a measured body has no front impedance.
    pub(super) march: Option<UncertainPrediction>,
    pub(super) on_lines: Option<OnLines>,
}

/// Function that reads one number of a march. A [`Named`] number also has a name, a unit, and the
/// value of the unit in SI.
type Read = dyn Fn(&ImpactNumbers) -> Option<f64>;

type Named<'a> = (&'a str, &'a str, f64, &'a Read);

pub(super) fn quantities(march: &UncertainPrediction, outcome: &mut Outcome) {
    let numbers = march.numbers();
    let errors = march.errors();
    let finished = !march
        .prediction
        .flags
        .iter()
        .any(|flag| matches!(flag, PredictionFlag::StillInContact));
    let about_errors = in_words(march.spread.as_ref());
    let band = format!("in the band up to {} kHz", khz(march.band.upper_hz()));
    let peak = match march.first_force {
        FirstForce::Unbounded => {
            format!("{band}: without a band limit the first force is unbounded")
        }
        FirstForce::Jump(jump) => {
            format!(
                "without a band limit; the force jumps to the plane-wave value {jump:.1} N when the faces meet"
            )
        }
        _ => "without a band limit".to_owned(),
    };
    let mut add = |(name, unit, one, of): Named<'_>, valid: bool, about: &str| {
        let value = of(&numbers);
        // a number that is equal in all draws, such as the time of a first jump, has no error
        let error = errors.as_ref().and_then(of).filter(|error| *error > 0.0);
        let why = match (value, valid) {
            (None, _) => "not defined for these bodies".to_owned(),
            (_, false) if march.prediction.fades() => {
                "the force fades without a separation".to_owned()
            }
            (_, false) => "the impact is not over: increase `problem.duration`".to_owned(),
            _ if error.is_some() => format!("{about}; error {about_errors}"),
            _ => format!("{about}; no error: {}", no_error(march, name)),
        };
        let error = error.filter(|_| value.is_some()).map(|error| error / one);
        let quantity = Quantity::of(name, unit, value.map(|value| value / one), why);
        let is_valid = valid && value.is_some();
        outcome
            .quantities
            .push(quantity.with_error(error).valid_if(is_valid));
    };
    add(("peak force", "N", 1.0, &|n| n.peak), true, &peak);
    add(
        ("peak force in the band", "N", 1.0, &|n| n.limited_peak),
        true,
        &band,
    );
    add(
        ("time of the peak", "ms", 1e-3, &|n| n.time_of_peak),
        true,
        &peak,
    );
    add(
        ("time of the peak in the band", "ms", 1e-3, &|n| {
            n.time_of_limited_peak
        }),
        true,
        &band,
    );
    add(
        ("end of the last contact", "ms", 1e-3, &|n| n.end),
        finished && !march.prediction.fades(),
        "zero of the force, or of the approach of a soft contact, between steps",
    );
    let computed = "computed from the bodies";
    add(("impulse", "N s", 1.0, &|n| n.impulse), finished, computed);
    add(
        ("coefficient of restitution", "", 1.0, &|n| n.restitution),
        finished,
        computed,
    );
    let [of_first, of_second]: [[&Read; 2]; 2] = [
        [&|n| n.velocity_after[0], &|n| n.inner[0]],
        [&|n| n.velocity_after[1], &|n| n.inner[1]],
    ];
    for (body, [velocity, inner]) in [("first", of_first), ("second", of_second)] {
        add(
            (
                &format!("velocity of the {body} body after"),
                "m/s",
                1.0,
                velocity,
            ),
            finished,
            computed,
        );
        add(
            (&format!("energy left in the {body} body"), "J", 1.0, inner),
            finished,
            computed,
        );
    }
    outcome.quantities.extend([
        Quantity::of(
            "numerical error of the peak force in the band",
            "N",
            march.numerical_numbers.limited_peak,
            "from the change with half the time step and, for measured bodies, from the change when parts of their lines are left out; part of its standard error",
        ),
        Quantity::of(
            "energy residual",
            "",
            march.prediction.balance().energy_residual,
            computed,
        ),
    ]);
}

/// Returns the reason why a number has no error.
fn no_error(march: &UncertainPrediction, name: &str) -> &'static str {
    match &march.spread {
        None => "no quantity is stated with ±",
        Some(_) if name == "end of the last contact" => {
            "the number of contacts differs from draw to draw"
        }
        Some(_) => "it does not depend on anything stated with ±, or some draws have no value",
    }
}

/// Returns the band that contains the whole history of the band-limited force with a probability of
/// 95 %; `None` without draws.
pub(super) fn whole_history(march: &UncertainPrediction) -> Result<Option<ForceBand>, RodlabError> {
    march.simultaneous(0.95).in_step("the band of the force")
}

/// Returns the table of the force in the band.
pub(super) fn limited(march: &UncertainPrediction) -> Result<Table, RodlabError> {
    let history = &march.limited;
    let title = format!("Force in the band up to {} kHz", khz(march.band.upper_hz()));
    let mut table = Table::new("force_in_band", title)
        .numbers("time", "s", times(history))
        .numbers("force in the band", "N", history.force());
    if let Some(errors) = march.limited_errors() {
        table = table.numbers("standard error of the force", "N", errors);
    }
    if let Some(band) = whole_history(march)? {
        table = with_band(table, "95 % band, whole history", &band);
    }
    Ok(table.numbers("numerical error of the force", "N", &march.numerical))
}

/// Returns the table of the march itself, without a band limit.
pub(super) fn history(march: &UncertainPrediction) -> Table {
    let prediction = &march.prediction;
    let history = &prediction.history;
    let in_contact = times(history).map(|time| {
        let mut contacts = prediction.contacts.iter();
        let touches = contacts
            .any(|contact| contact.begin <= time && contact.end.is_none_or(|end| time <= end));
        if touches { "contact" } else { "apart" }
    });
    let title = "Unfiltered force of the march, faces and state of the contact";
    let mut table = Table::new("force", title)
        .numbers("time", "s", times(history))
        .numbers("force", "N", history.force());
    if let Some(spread) = &march.spread {
        table = table.numbers("standard error of the force", "N", &spread.force);
    }
    let [first, second] = &prediction.face_velocity;
    table
        .numbers("velocity of the first face", "m/s", first)
        .numbers("velocity of the second face", "m/s", second)
        .numbers("approach of the faces", "m", &prediction.approach)
        .words("state", in_contact)
}

pub(super) fn contacts(prediction: &Prediction) -> Table {
    Rows::of(&prediction.contacts, "contacts", "Contacts")
        .number("start", "s", |contact| contact.begin)
        .number("end", "s", |contact| contact.end.unwrap_or(f64::NAN))
        .number("impulse", "N s", |contact| contact.impulse)
        .number("largest force", "N", |contact| contact.peak)
        .table
}
