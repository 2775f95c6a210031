//! Cards of the Prony series for programs that use material models.

use cmod::CmodError;
use cmod::rheology::Comparison;
use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};

use super::lines::Lines;
use super::{CardsSheet, ProgramSheet};
use crate::outcome::Attachment;
use crate::sheet::Exact;
use crate::{Outcome, RodlabError};

/// The cards of the Prony series.
pub(super) fn attach(
    outcome: &mut Outcome,
    lines: &Lines<'_>,
    comparison: &Comparison,
    asked: &CardsSheet,
) -> Result<(), RodlabError> {
    let refused = |error| RodlabError::step("laws.cards", error);
    let fits = comparison.rows.iter().map(|row| &row.fit);
    let Some(fit) = fits
        .into_iter()
        .find(|fit| fit.law.prony_series().is_some())
    else {
        // the log states why it could not be fitted
        return Ok(());
    };
    let ratio = asked.poisson_ratio.with_uncertainty();
    let Some(density) = lines.density else {
        return Err(RodlabError::request(
            "laws.cards",
            "asked for, without a density",
            "the density of the material beside it",
        ));
    };
    let card =
        match MaterialCard::from_fit(&asked.name, density.value, ratio.value, fit, lines.data) {
            Ok(card) => card,
            Err(error @ CmodError::CardUndetermined { .. }) => {
                outcome
                    .warnings
                    .push(format!("No card is written: {error}."));
                return Ok(());
            }
            Err(error) => return Err(refused(error)),
        };
    let at = asked.poisson_ratio_at.as_ref().map(Exact::si);
    let at = at.unwrap_or_else(|| lines.data.middle_frequency_hz());
    let mut card = card
        .with_poisson_ratio_at(at, ratio.standard_uncertainty)
        .map_err(refused)?
        .with_comment(&match (&asked.temperature, &lines.temperature) {
            (Some(temperature), _) => format!("temperature of the data: {temperature}"),
            (None, Some(temperature)) => format!("temperature: {temperature}"),
            (None, None) => "temperature of the data: not stated".to_owned(),
        });
    for input in &outcome.inputs {
        card = card
            .with_comment(&format!("source: {}", input.path))
            .with_comment(&format!("SHA-256 {}", input.sha256));
    }
    for program in &asked.programs {
        let (name, text) = match program {
            ProgramSheet::Abaqus => (
                format!("{}.inp", asked.name),
                card.abaqus(Moduli::LongTerm, BulkBehaviour::Elastic),
            ),
            ProgramSheet::Ansys => (
                format!("{}.mac", asked.name),
                card.ansys(1, BulkBehaviour::Elastic),
            ),
            ProgramSheet::LsDyna => (format!("{}.k", asked.name), card.ls_dyna(1)),
            ProgramSheet::Comsol => (format!("{}-comsol.txt", asked.name), card.comsol()),
            ProgramSheet::CodeAster => {
                let [lowest, highest] = lines.data.band_hz();
                let text = card.code_aster(lowest, highest);
                (format!("{}-code-aster.py", asked.name), text)
            }
            ProgramSheet::Json => (format!("{}.json", asked.name), card.json()),
        };
        outcome.attachments.push(Attachment {
            name,
            bytes: text.map_err(refused)?.into_bytes(),
        });
    }
    Ok(())
}
