//! Cards of the Prony series for programs that compute with a material.

use cmod::rheology::Comparison;
use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};

use super::Found;
use super::laws::{CardsSheet, ProgramSheet};
use crate::outcome::Attachment;
use crate::{Outcome, RodlabError};

/// The cards of the Prony series.
pub(super) fn attach(
    outcome: &mut Outcome,
    found: &Found<'_>,
    comparison: &Comparison,
    asked: &CardsSheet,
) -> Result<(), RodlabError> {
    let refused = |error| RodlabError::step("laws.cards", error);
    let fitted = comparison
        .rows
        .iter()
        .find_map(|row| Some((&row.fit, row.fit.law.prony_series()?)));
    let Some((fit, series)) = fitted else {
        // it is in the log why it could not be fitted
        return Ok(());
    };
    let mut valid = found.estimate.valid().map(|line| line.frequency_hz);
    let band = valid.next().map_or_else(Vec::new, |first| {
        let last = valid.last().unwrap_or(first);
        vec![first, (first * last).sqrt(), last]
    });
    let card = match MaterialCard::from_fit(
        &asked.name,
        found.sheet.specimen.density.with_uncertainty().value,
        asked.poisson_ratio.si(),
        fit,
        &band,
    ) {
        Ok(card) => card,
        // a series without a spring is no solid: the programs do not take it
        Err(error @ cmod::CmodError::NonPhysical { .. }) if series.equilibrium_modulus() <= 0.0 => {
            outcome.warnings.push(format!(
                "No card is written: {error}; the valid lines do not reach low enough frequencies to show a long-term modulus."
            ));
            return Ok(());
        }
        Err(error) => return Err(refused(error)),
    };
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
        };
        outcome.attachments.push(Attachment {
            name,
            bytes: text.map_err(refused)?.into_bytes(),
        });
    }
    Ok(())
}
