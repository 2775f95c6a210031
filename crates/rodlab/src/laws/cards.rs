//! Material cards of the Prony series for other programs.

use cmod::CmodError;
use cmod::rheology::Comparison;
use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::lines::Lines;
use super::{CardsSheet, ProgramSheet};
use crate::digits::{hertz, percent};
use crate::material_file::DENSITY;
use crate::outcome::Attachment;
use crate::sheet::{Exact, ValueWithUncertainty};
use crate::{Outcome, RodlabError};

/// Smallest deviation of a card from the fitted series, relative to |E|, that is reported.
const NOTABLE: f64 = 5e-3;

/// Adds the cards of the Prony series.
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
        // the log states why the series could not be fitted
        return Ok(());
    };
    let ratio = asked.poisson_ratio.with_uncertainty();
    let Some(density) = lines.density else {
        return Err(RodlabError::request(
            "laws.cards",
            "requested without a density",
            "the density of the material as well",
        ));
    };
    let card =
        match MaterialCard::from_fit(&asked.name, density.value, ratio.value, fit, lines.data) {
            Ok(card) => card,
            Err(error @ CmodError::CardUndetermined { .. }) => {
                outcome.warn(format!("No card is written: {error}."));
                return Ok(());
            }
            Err(error) => return Err(refused(error)),
        };
    if let Some(deviation) = card.deviation()
        && deviation.relative > NOTABLE
    {
        outcome.warn(format!(
            "The cards deviate from the fitted series by up to {} of |E|, at {}: a card has only relaxation times within the band. Choose a band that is wider than the band of the application.",
            percent(deviation.relative),
            hertz(deviation.frequency_hz)
        ));
    }
    let at = asked.poisson_ratio_at.as_ref().map(Exact::si);
    let at = at.unwrap_or_else(|| lines.data.middle_frequency_hz());
    let card = match card.with_poisson_ratio_at(at, ratio.standard_uncertainty) {
        Ok(card) => card,
        // the elastic bulk modulus is computed from the ratio at one frequency; at frequencies with
        // a different modulus, the card may then be physically impossible
        Err(error @ CmodError::NonPhysical { .. }) if asked.poisson_ratio_at.is_none() => {
            outcome.warn(format!(
                "No card is written: {error}. The ratio is assumed to apply at {}; state `poisson_ratio_at` if it applies at another frequency.",
                hertz(at)
            ));
            return Ok(());
        }
        Err(error) => return Err(refused(error)),
    };
    let mut card = card.with_comment(&match (&asked.temperature, &lines.temperature) {
        (Some(temperature), _) => format!("temperature of the data: {temperature}"),
        (None, Some(temperature)) => format!("temperature: {temperature}"),
        (None, None) => "temperature of the data: not stated".to_owned(),
    });
    for input in &outcome.inputs {
        card = card
            .with_comment(&format!("source: {}", input.path))
            .with_comment(&format!("SHA-256 {}", input.sha256));
    }
    let band = lines.data.band_hz();
    let attachment = |name: &str, program: ProgramSheet, card: &MaterialCard<'_>| {
        let (name, text) = written(name, program, card, band);
        let bytes = text.map_err(refused)?.into_bytes();
        Ok::<_, RodlabError>(Attachment { name, bytes })
    };
    for program in &asked.programs {
        let own = attachment(&asked.name, *program, &card)?;
        outcome.attachments.push(own);
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let draws = asked.draws.unwrap_or(0);
    if draws > 0 && card.errors().is_empty() {
        outcome.warn(
            "No cards of draws are written: no change of the series has the effect of a common error.",
        );
        return Ok(());
    }
    for draw in 1..=draws {
        let (number, of) = (format!("{draw:04}"), format!("draw {draw} of {draws}"));
        let tries = std::iter::repeat_with(|| {
            let moved = drawn(&card, (density, ratio), &mut random)?;
            moved.with_poisson_ratio_at(at, Some(0.0))
        });
        let Some(moved) = tries.take(MOST_TRIES).find_map(Result::ok) else {
            outcome.warn(format!(
                "Only {} cards of draws are written: none of the next {MOST_TRIES} draws is a valid material.",
                draw - 1
            ));
            return Ok(());
        };
        let moved = moved.with_comment(&of);
        for program in &asked.programs {
            let name = format!("{}-{number}", asked.name);
            outcome
                .attachments
                .push(attachment(&name, *program, &moved)?);
        }
    }
    Ok(())
}

/// Fixed seed of the draws, so that the same sheet and files give the same cards.
const SEED: u64 = 1;

/// Maximum number of draws for one card. A draw that is not a valid material is repeated.
const MOST_TRIES: usize = 100;

/// Returns one draw of `card`, with drawn errors of its series, its density and its Poisson's
/// ratio. If the moduli were computed with the density, the error of the density also moves the
/// series.
fn drawn<'a>(
    card: &MaterialCard<'a>,
    (density, ratio): (ValueWithUncertainty, ValueWithUncertainty),
    random: &mut ChaCha8Rng,
) -> Result<MaterialCard<'a>, CmodError> {
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let standard: Vec<f64> = card.errors().iter().map(|_| normal()).collect();
    let mut sources = card.errors().iter().zip(&standard);
    let of_series = sources.find(|(error, _)| error.source == DENSITY);
    let of_density = of_series.map_or_else(&mut normal, |(_, standard)| *standard);
    card.moved(
        &standard,
        density.value + density.uncertainty() * of_density,
        ratio.value + ratio.uncertainty() * normal(),
    )
}

/// Returns name and text of the file for one program.
fn written(
    name: &str,
    program: ProgramSheet,
    card: &MaterialCard<'_>,
    [lowest, highest]: [f64; 2],
) -> (String, Result<String, CmodError>) {
    match program {
        ProgramSheet::Abaqus => (
            format!("{name}.inp"),
            card.abaqus(Moduli::LongTerm, BulkBehaviour::Elastic),
        ),
        ProgramSheet::Ansys => (format!("{name}.mac"), card.ansys(1, BulkBehaviour::Elastic)),
        ProgramSheet::LsDyna => (format!("{name}.k"), card.ls_dyna(1)),
        ProgramSheet::Comsol => (format!("{name}-comsol.txt"), card.comsol()),
        ProgramSheet::CodeAster => {
            let text = card.code_aster(lowest, highest);
            (format!("{name}-code-aster.py"), text)
        }
        ProgramSheet::Json => (format!("{name}.json"), card.json()),
    }
}
