//! Result in words and single numbers, and its standing.

use impulse::hopkinson::{Curve, HopkinsonResult};

use super::ShpbSheet;
use super::tables::{LEVEL, peak};
use crate::digits::{significant, with_error, with_unit};
use crate::outcome::{CHECK, Quantity, finite};
use crate::{InStep, Outcome, RodlabError};

/// Largest relative difference between errors from draws and linear errors that is not reported.
const NONLINEAR: f64 = 0.2;

pub(super) fn state(
    outcome: &mut Outcome,
    sheet: &ShpbSheet,
    result: &HopkinsonResult,
) -> Result<(), RodlabError> {
    let peak = peak(result);
    let value = |values: &[f64], at: usize| values.get(at).copied().unwrap_or(f64::NAN);
    let at = |values: &[f64]| value(values, peak);
    let strain = at(result.curves.of(Curve::Strain));
    let strain_error = at(&result.standard_error(Curve::Strain));
    let band = |curve| {
        let band = result.expanded_uncertainty(curve, LEVEL);
        band.in_step("bands")
    };
    let bands = [band(Curve::Stress)?, band(Curve::Strain)?];
    let (stress, stress_width) = result.largest_stress(LEVEL).in_step("bands")?;
    let stress_error = at(&result.standard_error(Curve::Stress)) * stress_width / at(&bands[0]);
    let loaded = result.loaded.clone();
    let (rate, rate_error) = mean_rate(result);
    let at_peak = format!(
        "{} at a strain of {}",
        with_unit(stress, Some(stress_width), "Pa"),
        with_error(Some(strain), Some(at(&bands[1]))),
    );
    let balanced = result.is_in_equilibrium(peak);
    let quoted = result.largest_in_equilibrium().filter(|_| !balanced);
    let headline = match quoted {
        Some(place) => {
            let [stress, strain] =
                [Curve::Stress, Curve::Strain].map(|curve| value(result.curves.of(curve), place));
            format!(
                "The largest stress in equilibrium is {} at a strain of {}",
                with_unit(stress, Some(value(&bands[0], place)), "Pa"),
                with_error(Some(strain), Some(value(&bands[1], place))),
            )
        }
        None => format!("The peak stress is {at_peak}"),
    };
    outcome.say(format!(
        "{headline} (95 % intervals) and a mean rate of {} 1/s.",
        significant(rate, 3),
    ));
    let time_us = |time: f64| 1e6 * (time - result.start_time);
    outcome.say(match result.equilibrium.from {
        Some(from) => format!(
            "From {} us after the arrival of the wave at the specimen, the forces of the two faces differ by no more than 5 % plus their error; the specimen is loaded for {} us.",
            significant(time_us(from), 3),
            significant(1e6 * result.time_step * loaded.len() as f64, 3),
        ),
        None => "No time was found from which the forces of the two faces differ by no more than 5 % plus their error.".to_owned(),
    });
    outcome.say(dominating(result, quoted.unwrap_or(peak)));
    if !balanced {
        let index = at(&result.equilibrium.index).abs();
        let error = at(&result.equilibrium.standard_error);
        let differ = if index.is_finite() {
            let error = significant(error, 2);
            format!(
                "differ by {} of their mean ± {error}",
                significant(index, 2)
            )
        } else {
            "cannot be compared".to_owned()
        };
        outcome.say(format!(
            "The stress has its peak, {at_peak}, where the forces of the two faces {differ}: the specimen is not known to be in equilibrium there."
        ));
    }
    outcome.say(format!(
        "All results are stated in the band up to {} kHz; there, a wave that is traced back to the specimen is amplified by a factor of up to {}.",
        significant(1e-3 * result.band_hz, 3),
        significant(result.amplification, 3),
    ));
    let mut say = |name: &str, unit: &str, value: f64, error: Option<f64>| {
        outcome.quantities.push(stated(name, unit, value, error));
    };
    say(
        "largest stress",
        "MPa",
        1e-6 * stress,
        Some(1e-6 * stress_error),
    );
    say(
        "strain at the largest stress",
        "",
        strain,
        Some(strain_error),
    );
    let known = result.equilibrium.index.get(peak);
    if !balanced && known.is_some_and(|index| index.is_finite()) {
        for quantity in outcome.quantities.iter_mut().rev().take(2) {
            quantity.valid = false;
            quantity.verdict = "the forces of the two faces differ here".to_owned();
        }
    }
    let mut say = |name: &str, unit: &str, value: f64, error: Option<f64>| {
        outcome.quantities.push(stated(name, unit, value, error));
    };
    if let Some(place) = quoted {
        for (name, unit, curve, factor) in [
            ("largest stress in equilibrium", "MPa", Curve::Stress, 1e-6),
            (
                "strain at the largest stress in equilibrium",
                "",
                Curve::Strain,
                1.0,
            ),
        ] {
            let error = factor * value(&result.standard_error(curve), place);
            let found = factor * value(result.curves.of(curve), place);
            say(name, unit, found, Some(error));
        }
    }
    say("mean strain rate", "1/s", rate, Some(rate_error));
    let energies = result.energies;
    say("work of deformation", "J", energies.deformation, None);
    say("work into the specimen", "J", energies.into_specimen, None);
    say(
        "work out of the specimen",
        "J",
        energies.out_of_specimen,
        None,
    );
    say("end of the band", "kHz", 1e-3 * result.band_hz, None);
    say("largest amplification", "", result.amplification, None);
    if let Some(from) = result.equilibrium.from {
        say("equilibrium after the arrival", "us", time_us(from), None);
    }
    for (name, arrival) in ["incident", "reflected", "transmitted"]
        .into_iter()
        .zip(result.arrivals)
    {
        if let Some(arrival) = arrival {
            say(
                &format!("arrival of the {name} wave at the specimen"),
                "us",
                1e6 * arrival.time,
                Some(1e6 * arrival.standard_error),
            );
        }
    }
    if sheet.align_arrivals {
        say(
            "delay removed from the transmitted bar",
            "us",
            1e6 * result.lag_taken,
            None,
        );
    }
    let equilibrium = &result.equilibrium;
    say(
        &format!("{CHECK}force on the incident face divided by force on the transmitted face"),
        "",
        equilibrium.force_ratio,
        Some(equilibrium.force_ratio_error),
    );
    say(
        &format!("{CHECK}work neither transmitted nor spent on deformation"),
        "J",
        energies.residual(),
        None,
    );
    Ok(())
}

/// Returns a quantity that is stated if it is finite, with its standard error if that is finite.
pub(super) fn stated(name: &str, unit: &str, value: f64, error: Option<f64>) -> Quantity {
    Quantity::of(name, unit, finite(value), "valid").with_error(error.and_then(finite))
}

/// Returns `shot 2: ` if there are several shots.
pub(super) fn shot(at: usize, of: usize) -> String {
    if of > 1 {
        format!("shot {}: ", at + 1)
    } else {
        String::new()
    }
}

/// Reports the objections to a shot as a refusal, a doubt or a warning.
pub(super) fn findings(outcome: &mut Outcome, result: &HopkinsonResult, shot: &str) {
    for finding in &result.findings {
        let words = format!("{shot}{finding}");
        if finding.forbids() {
            outcome.summary = vec![format!("There is no stress-strain curve: {words}.")];
            for quantity in &mut outcome.quantities {
                quantity.valid = false;
                quantity.verdict.clone_from(&words);
            }
            outcome.refuse(words);
            return;
        }
        if finding.is_remark() {
            outcome.warn(format!("{words}."));
        } else {
            outcome.doubt(words);
        }
    }
}

/// Compares the errors from draws with the linear errors at the largest stress. A difference of
/// more than 20 % puts the result in doubt.
pub(super) fn monte_carlo(
    outcome: &mut Outcome,
    result: &HopkinsonResult,
    n_draws: Option<usize>,
    shot: &str,
) {
    let (Some(drawn), Some(n_draws)) = (&result.monte_carlo, n_draws) else {
        return;
    };
    let at = |values: &[f64]| values.get(peak(result)).copied().unwrap_or(f64::NAN);
    for (name, curve) in [("stress", Curve::Stress), ("strain", Curve::Strain)] {
        let ratio = at(drawn.of(curve)) / at(&result.standard_error(curve));
        let scatter = 1.0 / (2.0 * n_draws as f64).sqrt();
        let name =
            format!("{CHECK}{shot}standard error of the {name} by draws over the linear one");
        let error = Some(ratio * scatter);
        outcome.quantities.push(stated(&name, "", ratio, error));
        if (ratio - 1.0).abs() > NONLINEAR + 3.0 * scatter {
            outcome.doubt(format!(
                "{shot}the errors do not act linearly: in {n_draws} draws the {name} scatters by {} times its linear standard error, expected 0.8 to 1.2",
                significant(ratio, 3)
            ));
        }
    }
}

/// Returns the mean strain rate from the first load to the largest strain. Its standard error is
/// the error of the largest strain divided by the duration.
fn mean_rate(result: &HopkinsonResult) -> (f64, f64) {
    let strain = result.curves.of(Curve::Strain);
    let loaded = result.loaded.clone();
    let at = |index: usize| strain.get(index).copied().unwrap_or(f64::NAN);
    let last = loaded.clone().fold(loaded.start, |most, index| {
        if at(index) > at(most) { index } else { most }
    });
    let duration = (last - loaded.start) as f64 * result.time_step;
    let error = result.standard_error(Curve::Strain).get(last).copied();
    (
        (at(last) - at(loaded.start)) / duration,
        error.unwrap_or(f64::NAN) / duration,
    )
}

/// Returns a sentence about the error sources that dominate at the largest stress.
fn dominating(result: &HopkinsonResult, peak: usize) -> String {
    let largest = |curve: Curve| {
        let mut sources: Vec<(f64, String)> = result
            .common
            .iter()
            .filter_map(|source| {
                let effect = source.on(curve).get(peak)?.abs();
                Some((effect, source.source.to_string()))
            })
            .collect();
        let random = result.random.of(curve).get(peak).copied();
        sources.push((random.unwrap_or(0.0), "noise".to_owned()));
        sources.sort_by(|a, b| b.0.total_cmp(&a.0));
        sources.into_iter().next().map_or_else(String::new, |s| s.1)
    };
    format!(
        "At the largest stress, the error of the stress is mainly due to {}, and the error of the strain to {}.",
        largest(Curve::Stress),
        largest(Curve::Strain)
    )
}
