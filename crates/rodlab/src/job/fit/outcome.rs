//! Results as sentences, quantities and verdicts.

use std::f64::consts::{LN_10, TAU};

use cmod::rheology::{Comparison, ErrorScale, MasterCurve, PolarScatter, Shift, ShiftLaws};

use super::errors::ASSUMED;
use super::master::CHANCE;
use super::shifted::Shifted;
use super::steps::{Step, celsius, to_celsius};
use super::{Found, Sweep};
use crate::digits::{hertz, percent, short, significant, with_error, with_unit};
use crate::laws::{WHITE, unexplained};
use crate::outcome::{CHECK, Quantity, finite, sentence};
use crate::sheet::Exact;
use crate::{InStep, Outcome, RodlabError};

/// Number of standard errors by which a shift must rise with temperature to count as wrong.
const RISES: f64 = 2.0;
/// Largest difference \[K\] without a warning between the reference used and the reference stated
/// in the sheet.
const NEAR_REFERENCE: f64 = 1.0;

/// Adds the warning that no errors are stated.
pub(super) fn errors_in_words(outcome: &mut Outcome, shifted: &Shifted) {
    if let Some(assumed) = shifted.assumed {
        let ratio = shifted.weights.magnitude / shifted.weights.phase;
        let unequal = if shifted.weights == PolarScatter::equal(ASSUMED) {
            String::new()
        } else {
            format!(
                ", which scatters {} times as much as the phase",
                significant(ratio, 2)
            )
        };
        outcome.warn(format!(
            "No errors of the moduli are stated: all rows are weighted by |E|{unequal}, temperatures are joined where they agree within {} of |E|, and \
             the errors of the results are from the scatter about the fit. State `errors` of the tables if they are known: without them \
             chi-square cannot test a law or the single curve.",
            percent(assumed)
        ));
    }
}

pub(super) fn state(outcome: &mut Outcome, found: &Found<'_>) -> Result<(), RodlabError> {
    if let Some(sweep) = &found.sweep {
        of_sweep(outcome, found, sweep)?;
    } else if let Some(step) = found.steps.first() {
        of_step(outcome, found, step);
    }
    Ok(())
}

/// Adds sentences about laws that could not be fitted.
pub(super) fn of_laws(outcome: &mut Outcome, found: &Found<'_>, comparison: Option<&Comparison>) {
    let Some(best) = comparison.and_then(Comparison::best) else {
        let reasons: Vec<String> = outcome
            .log
            .iter()
            .filter(|entry| entry.what.starts_with("law: "))
            .flat_map(|entry| entry.reasons.clone())
            .collect();
        let reason = format!("none of the laws can be fitted: {}", reasons.join("; "));
        if found.sweep.is_none() {
            outcome.refuse(reason);
        } else {
            outcome.doubt(reason);
        }
        return;
    };
    outcome
        .tables
        .extend(comparison.map(super::tables::parameters));
    let is_judged = found.sweep.is_none();
    if !is_judged && found.error_scale == ErrorScale::Stated && best.p_value() < CHANCE {
        outcome.warn(sentence(&unexplained(best)));
    }
}

/// Adds the sentence about a single temperature.
fn of_step(outcome: &mut Outcome, found: &Found<'_>, step: &Step) {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let rows = &step.rows;
    let (Some(first), Some(last), Some(middle)) =
        (rows.first(), rows.last(), rows.get(rows.len() / 2))
    else {
        return;
    };
    // the rows are in the order of frequency, so their times decrease
    let (first, last) = if first.time().is_some() && last.time().is_some() {
        (last, first)
    } else {
        (first, last)
    };
    let modulus = significant(middle.modulus.re / pascal, 3);
    let answer = if middle.time().is_some() {
        format!("{symbol} = {modulus} {unit}")
    } else {
        let loss = significant(middle.modulus.im / middle.modulus.re, 3);
        format!("{symbol}' = {modulus} {unit} and loss factor {loss}")
    };
    outcome.lead(format!(
        "{} rows from {} to {} at {}: {answer} at {}.",
        rows.len(),
        first.abscissa(),
        last.abscissa(),
        step.in_words(),
        middle.abscissa(),
    ));
    if found.sheet.laws.is_none() && !found.sheet.causal {
        outcome.warn("Nothing was fitted: there is one temperature, and the sheet has no `laws`.");
    }
}

fn of_sweep(outcome: &mut Outcome, found: &Found<'_>, sweep: &Sweep) -> Result<(), RodlabError> {
    let curve = &sweep.curve;
    let reference = curve.reference_temperature;
    let frequencies = curve.points.iter().map(|point| point.reduced_frequency_hz);
    let lowest = frequencies.clone().fold(f64::INFINITY, f64::min);
    let highest = frequencies.fold(0.0, f64::max);
    let temperatures =
        |shift: Option<&Shift>| shift.map_or_else(String::new, |s| celsius(s.temperature));
    outcome.lead(format!(
        "One curve at {} from {} of {} temperatures ({} to {}), over {} decades of reduced {}, with a residual of {} of |{}|.",
        celsius(reference),
        curve.shifts.len(),
        found.steps.len(),
        temperatures(curve.shifts.first()),
        temperatures(curve.shifts.last()),
        significant((highest / lowest).log10(), 3),
        if found.has_frequencies() { "frequency" } else { "time" },
        percent(curve.relative_residual()),
        found.symbol(),
    ));
    if let Some(wanted) = &found.sheet.reference_temperature
        && (wanted.si() - reference).abs() > NEAR_REFERENCE
    {
        outcome.warn(format!(
            "No step is at {wanted}: the nearest one, at {}, is the reference.",
            celsius(reference)
        ));
    }
    quantities(outcome, found, sweep);
    one_curve(outcome, found, curve)?;
    falling(outcome, curve);
    match &sweep.shift_laws {
        Ok(laws) => {
            of_shift_laws(outcome, laws, sweep.by_scatter.as_ref());
            let scatter = curve.temperature_scatter();
            if let (Some(_), Ok(kelvin)) = (&sweep.by_scatter, scatter)
                && kelvin.is_finite()
            {
                let kelvin = significant(kelvin, 2);
                outcome.warn(match &found.sheet.temperature_uncertainty {
                    None => format!(
                        "The shifts differ from WLF by more than the errors of the moduli explain, as they would if the temperatures were wrong by {kelvin} K. If the \
                         measured temperatures can be that wrong, state `temperature_uncertainty`: the stated errors of the shifts, and of the master curve at the reference, do not include errors of temperature."
                    ),
                    Some(stated) => format!(
                        "The shifts differ from WLF by more than the errors of the moduli and the stated `temperature_uncertainty` of {stated} explain; the shifts scatter as if \
                         the temperatures were wrong by {kelvin} K. If WLF is valid for the material in this range, the temperature or the frequencies of a step are wrong, and \
                         so are the master curve and its errors."
                    ),
                });
            }
        }
        Err(error) => outcome.reject("laws of the shifts", error),
    }
    if !curve.unconnected.is_empty() {
        let all: Vec<String> = curve.unconnected.iter().map(|t| celsius(*t)).collect();
        outcome.doubt(format!(
            "{} of {} temperatures do not join the curve, because they do not overlap their neighbours within the errors: {}; state \
             `stated_shifts`, larger errors or a narrower band",
            all.len(),
            found.steps.len(),
            all.join(", ")
        ));
    }
    Ok(())
}

fn quantities(outcome: &mut Outcome, found: &Found<'_>, sweep: &Sweep) {
    let curve = &sweep.curve;
    let reference = curve.reference_temperature;
    let n_lines = curve.points.len();
    outcome.quantities.extend([
        Quantity::of(
            "reference temperature",
            "degC",
            to_celsius(reference),
            "mean of the rows of the step",
        ),
        Quantity::of(
            "residual of the master curve",
            "%",
            100.0 * curve.relative_residual(),
            format!("root mean square over {n_lines} lines, relative to |E|"),
        ),
    ]);
    let middle = found
        .steps
        .iter()
        .find(|step| step.temperature.total_cmp(&reference).is_eq())
        .and_then(|step| step.rows.get(step.rows.len() / 2));
    let Some(frequency) = middle.map(|row| row.frequency_hz) else {
        return;
    };
    let Ok(predicted) = curve.fit.prediction(TAU * frequency) else {
        return;
    };
    let (unit, pascal) = found.pascal;
    let modulus = predicted.modulus;
    let [[storage, _], [_, loss]] = predicted.covariance;
    let (factor, of_factor) = predicted.loss_factor();
    let at = format!("{} and {}", hertz(frequency), celsius(reference));
    for (name, unit, value, error) in [
        (
            "storage modulus",
            unit,
            modulus.re / pascal,
            finite(storage.sqrt() / pascal),
        ),
        (
            "loss modulus",
            unit,
            modulus.im / pascal,
            finite(loss.sqrt() / pascal),
        ),
        ("loss factor", "", factor, finite(of_factor)),
    ] {
        let verdict = "from the master curve, within its band";
        let quantity = Quantity::of(format!("{name} at {at}"), unit, value, verdict);
        let quantity = quantity.with_error(error).valid_if(error.is_some());
        outcome.quantities.push(quantity);
    }
}

/// Evidence, as a difference of BIC, up to which the choice of the factors is reported as open;
/// beyond it the evidence is very strong (Kass & Raftery 1995).
const OPEN: f64 = 10.0;

/// Warns about factors of the modulus that were chosen from the data. If the choice is open and
/// changes a shift, or a parameter of the preferred law, by more than one standard error, the
/// warning states the largest change. Otherwise only factors of rubber elasticity are reported.
pub(super) fn of_factors(
    outcome: &mut Outcome,
    curve: &MasterCurve,
    comparison: Option<&Comparison>,
) {
    let Some(choice) = &curve.factor_choice else {
        return;
    };
    let best = comparison.and_then(Comparison::best);
    let fits = std::iter::once((&curve.fit, "shift factor", String::new()))
        .chain(best.map(|fit| (fit, "", format!(" of the {}", fit.law.law()))));
    let largest = fits
        .flat_map(|(fit, begin, whose)| {
            let all = fit.parameters.iter().zip(choice.changes(fit));
            all.filter(move |(own, _)| own.name.starts_with(begin) && own.verdict.is_identified())
                .map(move |(own, change)| (format!("{}{whose}", own.name), change))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let evidence = significant(choice.evidence.abs(), 2);
    match largest.filter(|(_, change)| *change > 1.0 && choice.evidence < OPEN) {
        Some((name, change)) => {
            let (used, other) = if choice.is_entropic {
                ("T/T_r is", "1")
            } else {
                ("1 is", "T/T_r")
            };
            outcome.warn(format!(
                "Factors of the modulus of 1 and of T/T_r (rubber elasticity) describe the curves almost equally well: BIC differs by {evidence}. {used} \
                 used; with {other} the {name} would change by {} standard errors, and all stated errors allow for this. State `vertical_shifts` if the \
                 factors are known: T/T_r for a rubber far above its glass transition, 1 for a glass. Otherwise a wider range of temperatures or \
                 smaller errors decide.",
                significant(change, 2)
            ));
        }
        None if choice.is_entropic => outcome.warn(format!(
            "The factors of the modulus are those of rubber elasticity, T/T_r, which describe the curves better than a factor of 1 (BIC lower by {evidence}). \
             State `vertical_shifts` for other factors."
        )),
        None => {}
    }
}

/// Tests whether one curve describes all temperatures.
fn one_curve(
    outcome: &mut Outcome,
    found: &Found<'_>,
    curve: &MasterCurve,
) -> Result<(), RodlabError> {
    let fit = &curve.fit;
    let chi = format!(
        "chi-square {} with {} degrees of freedom",
        significant(fit.chi_squared, 4),
        fit.degrees_of_freedom
    );
    let white = fit.whiteness.is_white(WHITE);
    if found.error_scale == ErrorScale::Stated {
        let p = fit.p_value();
        let name = format!("{CHECK}one curve for all temperatures, probability");
        let check = Quantity::of(name, "", p, chi.as_str()).valid_if(p >= CHANCE);
        outcome.quantities.push(check);
        if p < CHANCE {
            outcome.doubt(format!(
                "the temperatures do not form a single curve within the stated errors: {chi}"
            ));
        }
    }
    if !white {
        outcome.warn(format!(
            "The residual of the master curve is not noise ({}): the curves at the different temperatures differ in shape, or the instrument \
             has an error that depends on frequency. In both cases the stated errors of shifts and parameters are too small.",
            fit.whiteness
        ));
    }
    let scaled = curve
        .shifts
        .iter()
        .filter(|shift| shift.vertical_standard_error > 0.0)
        .count();
    if scaled > 0 {
        outcome.warn(format!(
            "Without factors of the modulus the temperatures do not form a single curve: {scaled} factors were estimated in addition to the shifts."
        ));
    }
    let stated = found.sheet.scale_uncertainty.as_ref();
    let stated = stated.map_or(0.0, Exact::si);
    if let Some(scatter) = curve.factor_scatter()
        && scatter > stated
    {
        outcome.doubt(format!(
            "the factors of the modulus scatter by {} about a smooth change with temperature, as after repeated clamping: the modulus at the \
             reference temperature is uncertain by the same amount, which the stated errors do not include; state `scale_uncertainty`",
            percent(scatter)
        ));
    }
    let departure = curve.departure_of_reference(stated);
    if let Some(departure) = departure.in_step("scale_uncertainty")? {
        let factor = departure.log_factor.exp();
        outcome.doubt(format!(
            "the sweep at the reference temperature, {}, departs from its neighbours by a factor of {}, expected 1, as after repeated clamping: all \
             moduli of the master curve are wrong by this factor if the neighbours are right; choose another reference temperature to compare, or \
             repeat the sweep",
            celsius(curve.reference_temperature),
            with_error(Some(factor), Some(factor * departure.standard_error))
        ));
    }
    let open: Vec<String> = curve
        .shifts
        .iter()
        .filter(|shift| !shift.verdict.is_identified())
        .map(|shift| celsius(shift.temperature))
        .collect();
    if !open.is_empty() {
        outcome.warn(format!(
            "The shifts at {} are not identified: their curves are too flat. They are not used for the laws of the shifts.",
            open.join(", ")
        ));
    }
    Ok(())
}

/// Checks that relaxation is faster at higher temperature.
fn falling(outcome: &mut Outcome, curve: &MasterCurve) {
    let rises: Vec<String> = curve
        .shifts
        .windows(2)
        .filter_map(|pair| {
            let [colder, warmer] = pair else {
                return None;
            };
            let rise = warmer.log_shift - colder.log_shift;
            let error = warmer.standard_error.hypot(colder.standard_error);
            (rise > RISES * error && rise > 0.0).then(|| {
                format!(
                    "{} to {}",
                    celsius(colder.temperature),
                    celsius(warmer.temperature)
                )
            })
        })
        .collect();
    let (name, verdict) = (
        format!("{CHECK}shifts that rise with temperature"),
        "by more than two standard errors",
    );
    let check = Quantity::of(name, "", rises.len() as f64, verdict);
    outcome.quantities.push(check.valid_if(rises.is_empty()));
    if !rises.is_empty() {
        outcome.doubt(format!(
            "the shifts do not fall with temperature from {}: relaxation would be slower at the higher temperature",
            rises.join(", ")
        ));
    }
}

fn of_shift_laws(outcome: &mut Outcome, own: &ShiftLaws, by_scatter: Option<&ShiftLaws>) {
    let laws = by_scatter.unwrap_or(own);
    let (wlf, arrhenius) = (&laws.wlf, &laws.arrhenius);
    let is_wlf = own.wlf_p_value() >= CHANCE;
    let is_arrhenius = laws.arrhenius_p_value >= CHANCE;
    let constants = wlf.constants_are_identified();
    let verdict = match (is_wlf, constants) {
        (false, _) => format!(
            "the shifts differ from the law by more than their errors, chi-square {} with {} degrees of freedom; fitted with equal errors \
             of all shifts",
            significant(own.wlf.chi_squared, 3),
            own.wlf.degrees_of_freedom
        ),
        (true, false) => {
            "only C1/C2 is determined: the shifts are nearly a straight line".to_owned()
        }
        (true, true) => "identified".to_owned(),
    };
    for (name, unit, value, error, interval) in [
        (
            "WLF, C1",
            "",
            wlf.c1,
            wlf.c1_standard_error,
            wlf.c1_interval,
        ),
        (
            "WLF, C2",
            "K",
            wlf.c2,
            wlf.c2_standard_error,
            wlf.c2_interval,
        ),
    ] {
        let within = if interval.upper.is_finite() {
            let (lower, upper) = (
                significant(interval.lower, 4),
                significant(interval.upper, 4),
            );
            format!("; interval {lower} to {upper} {unit}")
                .trim_end()
                .to_owned()
        } else {
            String::new()
        };
        let verdict = format!("{verdict}{within}");
        let quantity = Quantity::of(name, unit, finite(value), verdict);
        let quantity = quantity.with_error(finite(error));
        outcome
            .quantities
            .push(quantity.valid_if(is_wlf && constants));
    }
    let verdict = match (is_wlf, is_arrhenius) {
        (true, true) => "identified".to_owned(),
        (false, _) => verdict,
        (true, false) => format!(
            "rejected in favour of WLF, probability {}",
            significant(laws.arrhenius_p_value, 2)
        ),
    };
    let (name, energy) = ("Arrhenius, activation energy", arrhenius.activation_energy);
    let quantity = Quantity::of(name, "kJ/mol", 1e-3 * energy, verdict)
        .with_error(1e-3 * arrhenius.standard_error)
        .valid_if(is_arrhenius && is_wlf);
    outcome.quantities.push(quantity);
    // decrease of log₁₀ a_T per kelvin at the reference temperature; it is the same for both laws
    let slope = wlf.slope / LN_10;
    outcome.say(if is_arrhenius && is_wlf {
        format!(
            "The shifts follow Arrhenius: {}.",
            with_unit(
                arrhenius.activation_energy,
                Some(arrhenius.standard_error),
                "J/mol"
            )
        )
    } else {
        format!(
            "The shifts follow WLF with C1 = {} and C2 = {}{}; log a falls by {} per K at the reference. The \
             probability of Arrhenius relative to WLF is {}.",
            with_error(Some(wlf.c1), Some(wlf.c1_standard_error)),
            with_unit(wlf.c2, Some(wlf.c2_standard_error), "K"),
            if is_wlf { "" } else { ", fitted with equal errors of all shifts because their own errors do not explain the deviations" },
            short(slope),
            significant(laws.arrhenius_p_value, 2),
        )
    });
}
