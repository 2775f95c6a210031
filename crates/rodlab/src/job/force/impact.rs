//! Force between two bodies that meet.

use super::bodies::FaceBody;
use super::impact_lines::on_lines;
use super::impact_march;
use super::impact_sheet::{ContactSheet, ImpactSheet, SEED};
use super::impact_tables::Found;
use super::{impact_figures, impact_tables};
use crate::bodies::material_sheet::Materials;
use crate::digits::{significant, with_error, with_unit};
use crate::job::JobContext;
use crate::{Outcome, RodlabError};
use impulse::{FirstForce, ImpactNumbers, PredictionFlag, UncertainPrediction};

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
            "`rigid` (in RON `Rigid`), or the `front_impedance` of the measured bodies: a compliant contact is computed by marching in time",
        ));
    }
    if let (false, Some(step)) = (marched, &sheet.time_step) {
        return Err(RodlabError::request(
            "problem.time_step",
            step.to_string(),
            "no value, or the `front_impedance` of the measured bodies: without it there is no march in time",
        ));
    }
    defaults(sheet, bodies, marched, outcome)?;
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    context.progress.begins("force", 0);
    let found = Found {
        march: if marched {
            Some(impact_march::march(sheet, materials, bodies, context)?)
        } else {
            None
        },
        on_lines: on_lines(sheet, materials, bodies, context, outcome)?,
    };
    context.check_cancelled()?;
    if let Some(march) = &found.march {
        flags(march, bodies, outcome);
        slenderness(sheet, materials, march.band.upper_hz(), outcome)?;
        if let ContactSheet::Table(points) = &sheet.contact
            && let Some((_, last)) = points.last()
        {
            let (last, peak) = (last.with_uncertainty().value, march.prediction.peak().force);
            if peak > last {
                outcome.doubt(format!(
                    "the force reaches {} N, but the table of the contact ends at {} N: its last segment was extrapolated; measure the contact up to the larger force",
                    significant(peak, 3),
                    significant(last, 3)
                ));
            }
        }
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
            outcome.warn(
                "No `front_impedance` is stated for a measured body, and its lines do not show its behaviour at higher frequencies: there is no force by marching in time, no \
                 force without a band limit, and nothing after the first contact. The front impedance is the area of the face times the square root of \
                 modulus times density at high frequency; state it with its ±.",
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
        outcome.warn(
            "No uncertainty of the velocity is stated: no error of the force includes it, and the relative error of the force is at least that of the velocity.",
        );
    }
    outcome.figures = impact_figures::all(&found, bodies, sheet)?;
    Ok(())
}

/// Adds the defaults of optional fields.
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
        outcome.by_default("problem.uncertainty.seed", SEED);
    }
    outcome.by_default("problem.contact", ContactSheet::default().in_words());
    Ok(())
}

/// Number of standard errors by which the inner energy of a measured body must be below 0 for the
/// body to generate energy.
const GENERATED: f64 = 3.0;

/// Reports the objections to the prediction. There is no answer if a contact is not resolved, or if
/// a body generates energy. For a measured body, energy within three of its standard errors gives
/// only a warning.
fn flags(march: &UncertainPrediction, bodies: [&FaceBody; 2], outcome: &mut Outcome) {
    let errors = march.errors();
    let error_of_inner = |body: usize| -> Option<f64> {
        bodies.get(body)?.measured_to_hz()?;
        *errors.as_ref()?.inner.get(body)?
    };
    for flag in &march.prediction.flags {
        match flag {
            PredictionFlag::MakesEnergy { body, inner }
                if error_of_inner(*body).is_some_and(|error| -inner <= GENERATED * error) =>
            {
                outcome.warn(format!("{flag}, which is within the error of that energy"));
            }
            PredictionFlag::MakesEnergy { .. }
            | PredictionFlag::UnresolvedContact { .. }
            | PredictionFlag::ContactOfFewSteps { .. } => {
                outcome.refuse(flag.to_string());
            }
            PredictionFlag::Rings { .. } => outcome.doubt(flag.to_string()),
            _ => outcome.warn(flag.to_string()),
        }
    }
}

/// Wavelength, in diameters, at which lateral inertia lowers the wave speed by about one per cent,
/// for a Poisson's ratio of 0.35.
const SLENDER: f64 = 5.0;

/// Warns if the shortest waves in the band are shorter than five diameters of a rod.
fn slenderness(
    sheet: &ImpactSheet,
    materials: &Materials,
    upper_hz: f64,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    for (body, field) in [
        (&sheet.first, "problem.first"),
        (&sheet.second, "problem.second"),
    ] {
        let shortest = body.shortest_wave(materials, upper_hz, field)?;
        if shortest < SLENDER {
            outcome.warn(format!(
                "{field}: at the end of the band, {} kHz, a wave is {} diameters of a rod long: the force neglects lateral inertia, which lowers the wave speed by about one per cent at {SLENDER} diameters and by more for shorter waves; state a `band` that ends lower",
                impact_march::khz(upper_hz),
                significant(shortest, 2),
            ));
        }
    }
    Ok(())
}

fn answer(sheet: &ImpactSheet, march: &UncertainPrediction, outcome: &mut Outcome) {
    let numbers = march.numbers();
    let errors = march.errors();
    let error = |of: &dyn Fn(&ImpactNumbers) -> Option<f64>| errors.as_ref().and_then(of);
    let in_band = march.limited.smooth_peak();
    let band_khz = impact_march::khz(march.band.upper_hz());
    let limited = format!(
        "In the band up to {band_khz} kHz the peak force is {} at {:.4} ms, at an impact velocity of {}",
        with_unit(in_band.force, error(&|e| e.limited_peak), "N"),
        1e3 * in_band.time,
        sheet.velocity,
    );
    let is_short = |flag: &PredictionFlag| matches!(flag, PredictionFlag::ContactOfFewSteps { .. });
    outcome.say(match march.first_force {
        _ if march.prediction.flags.iter().any(is_short) => {
            format!("{limited}. Without a band limit the force depends on the time step.")
        }
        FirstForce::Unbounded => format!(
            "{limited}. Without a band limit the first force is unbounded: the impedance of a face grows with frequency without bound, so the force in the first step \
             depends on the length of the time step."
        ),
        _ => format!(
            "{limited}; without a band limit it is {} at {:.4} ms.",
            with_unit(numbers.peak.unwrap_or(f64::NAN), error(&|e| e.peak), "N"),
            1e3 * numbers.time_of_peak.unwrap_or(f64::NAN),
        ),
    });
    let prediction = &march.prediction;
    let counting = prediction.main_contacts().count();
    let last = if counting == 1 {
        "The only contact".to_owned()
    } else {
        format!("The last of {counting} contacts")
    };
    let pressing = prediction.flags.contains(&PredictionFlag::StillInContact);
    outcome.say(if prediction.fades() {
        "The force of the last contact fades without a separation: the faces stay together, and there is no end of the contact.".to_owned()
    } else if pressing {
        format!("{last} with more than a thousandth of the impulse has not ended: the faces are still in contact; increase `problem.duration`.")
    } else {
        format!(
            "{last} with more than a thousandth of the impulse ends at {}.",
            with_unit(prediction.duration(), error(&|e| e.end), "s"),
        )
    });
    let balance = prediction.balance();
    let restitution = match balance.restitution {
        _ if pressing => {
            "the faces are still in contact, so there is no coefficient of restitution".to_owned()
        }
        None => "neither body is free, so there is no coefficient of restitution".to_owned(),
        Some(e) => format!(
            "the coefficient of restitution is {}",
            // an error of at most 1e-4 of the value is less than about one unit of the fourth digit
            match error(&|n| n.restitution) {
                Some(error) if error > 1e-4 * e => with_error(Some(e), Some(error)),
                _ => significant(e, 4),
            }
        ),
    };
    outcome.say(format!(
        "The impulse is {}; {restitution}; work and energy agree to {} of the impulse times the velocity.",
        with_unit(balance.impulse, error(&|e| e.impulse), "N s"),
        match balance.energy_residual.abs() {
            none if none <= 0.0 => "rounding".to_owned(),
            part => format!("{part:.0e}"),
        },
    ));
}
