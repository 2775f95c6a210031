//! Mean curve of several shots.

use impulse::hopkinson::{Curve, HopkinsonResult, MeanCurve};
use rodfigure::{Figure, Mark, Panel, Role};

use super::answer::stated;
use super::figures::around;
use super::tables::{LEVEL, band_of_mean, peak, scaled};
use crate::digits::{significant, with_unit};
use crate::outcome::Table;
use crate::{InStep, Outcome, RodlabError};

/// Probability that equal specimens are wrongly reported as different.
const CHANCE: f64 = 0.01;

pub(super) fn state(
    outcome: &mut Outcome,
    shots: &[HopkinsonResult],
    mean: &MeanCurve,
) -> Result<(), RodlabError> {
    let mut at = (0, f64::NEG_INFINITY);
    for (place, stress) in mean.stress.iter().enumerate() {
        if *stress > at.1 {
            at = (place, *stress);
        }
    }
    let value = |values: &[f64]| values.get(at.0).copied().unwrap_or(f64::NAN);
    let (_, width) = mean.largest_stress(LEVEL).in_step("bands")?;
    let megapascals = |pascals: f64, digits| significant(1e-6 * pascals, digits);
    outcome.say(format!(
        "The peak of the mean of {} shots is {} (95 % interval) at a strain of {} and a rate of {} 1/s.",
        mean.n_shots,
        with_unit(at.1, Some(width), "Pa"),
        significant(value(&mean.strain), 3),
        significant(value(&mean.strain_rate), 3),
    ));
    let differ = mean
        .specimens_differ(CHANCE)
        .in_step("the scatter of the shots")?;
    outcome.say(format!(
        "There the shots scatter by {} MPa (one standard deviation), of which noise and the sizes of the specimens explain {} MPa: {}.",
        megapascals(value(&mean.scatter), 2),
        megapascals(value(&mean.explained), 2),
        if differ {
            "the specimens differ"
        } else {
            "no difference between the specimens is seen"
        }
    ));
    let mut say = |name: &str, unit: &str, value: f64, error: Option<f64>| {
        outcome.quantities.push(stated(name, unit, value, error));
    };
    let error = value(&mean.standard_error()) * width / value(&band_of_mean(mean)?);
    say(
        "largest mean stress",
        "MPa",
        1e-6 * at.1,
        Some(1e-6 * error),
    );
    say(
        "strain at the largest mean stress",
        "",
        value(&mean.strain),
        None,
    );
    say(
        "variance between shots divided by the explained variance",
        "",
        mean.scatter_ratio(),
        None,
    );
    for (number, shot) in (1..).zip(shots) {
        let peak = peak(shot);
        let at = |values: &[f64]| values.get(peak).copied().unwrap_or(f64::NAN);
        say(
            &format!("largest stress of shot {number}"),
            "MPa",
            1e-6 * at(shot.curves.of(Curve::Stress)),
            Some(1e-6 * at(&shot.standard_error(Curve::Stress))),
        );
    }
    Ok(())
}

pub(super) fn table(mean: &MeanCurve) -> Result<Table, RodlabError> {
    let mega = |values: &[f64]| scaled(values, 1e-6);
    let half = mega(&band_of_mean(mean)?);
    let title = format!("Mean stress of {} shots over strain", mean.n_shots);
    Ok(Table::new("mean", title)
        .numbers("strain", "", &mean.strain)
        .numbers("mean stress", "MPa", mega(&mean.stress))
        .numbers("95 % half width of the mean stress", "MPa", half)
        .numbers(
            "standard deviation between shots",
            "MPa",
            mega(&mean.scatter),
        )
        .numbers(
            "standard deviation that is explained",
            "MPa",
            mega(&mean.explained),
        )
        .numbers(
            "common standard error of the mean stress",
            "MPa",
            mega(&mean.common),
        )
        .numbers("mean strain rate", "1/s", &mean.strain_rate))
}

pub(super) fn figure(shots: &[HopkinsonResult], mean: &MeanCurve) -> Result<Figure, RodlabError> {
    let strain = scaled(&mean.strain, 100.0);
    let stress = scaled(&mean.stress, 1e-6);
    let half = scaled(&band_of_mean(mean)?, 1e-6);
    let mut marks = vec![around("95 % band", Role::First, &strain, &stress, &half)];
    for (at, shot) in shots.iter().enumerate() {
        let of = |curve: Curve, factor: f64| {
            let values = shot.curves.of(curve).get(..shot.loaded.end);
            scaled(values.unwrap_or(&[]), factor)
        };
        let (strain, stress) = (of(Curve::Strain, 100.0), of(Curve::Stress, 1e-6));
        let name = format!("shot {}", at + 1);
        marks.push(Mark::curve(&name, Role::of_series(at + 1), &strain, stress));
    }
    marks.push(Mark::curve("mean", Role::First, &strain, stress));
    let panel = Panel::new(("strain", "%"), ("stress", "MPa"), marks);
    Ok(Figure::new("mean", "Mean stress over strain", vec![panel]).with_caption(
        "Engineering values; the band contains a single value of the mean with a probability of 95 %, up to the strain that all specimens reach.",
    ))
}
