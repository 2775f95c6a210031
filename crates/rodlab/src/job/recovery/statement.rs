//! Results as quantities and sentences.

use cmod::CmodError;
use cmod::recovery::RecoveryTest;
use cmod::recovery::fit::{
    Ending, ErrorScale, Estimate, Scale, SingleTestFit, Verdict as Identified,
};

use super::{Found, RecoverySheet};
use crate::Outcome;
use crate::digits::{hertz, percent, significant, to_error, with_error};
use crate::outcome::{Quantity, finite, shown_unit};

/// Number of standard deviations by which χ² of the readings may exceed its expected value. If it
/// exceeds it by more, the model or the stated errors are wrong.
const DEVIATIONS: f64 = 3.0;

/// p-value below which the tests contradict each other.
const CONTRADICTED: f64 = 1e-3;

/// States the verdict if no model could be fitted, and the results of each test alone.
pub(super) fn without_fit(
    outcome: &mut Outcome,
    sheet: &RecoverySheet,
    (tests, singles): (&[RecoveryTest], &[Result<SingleTestFit, CmodError>]),
    error: &CmodError,
) {
    outcome.refuse(format!("no model can be fitted: {error}"));
    outcome.say(format!("No model can be fitted: {error}."));
    of_single_tests(outcome, tests, singles, has_stated_errors(sheet));
}

/// Returns true if the errors of the result are based on the standard errors of the readings, not
/// on the residual.
fn has_stated_errors(sheet: &RecoverySheet) -> bool {
    sheet.error_scale != Some(ErrorScale::FromResidual)
}

/// Returns the largest chi-square that the errors of the readings explain: the mean ν plus
/// [`DEVIATIONS`] standard deviations (2ν)^½.
fn most_explained(freedom: f64) -> f64 {
    freedom + DEVIATIONS * (2.0 * freedom).sqrt()
}

pub(super) fn state(outcome: &mut Outcome, found: &Found<'_>) {
    let fit = &found.fit;
    let unidentified = fit.estimates.iter().find_map(|estimate| {
        matches!(estimate.verdict, Identified::NotIdentifiable(_))
            .then(|| format!("{} is {}", estimate.name, estimate.verdict))
    });
    for estimate in &fit.estimates {
        outcome.quantities.push(quantity(estimate));
    }
    match unidentified {
        Some(reason) => {
            // objections to a refused answer become warnings, which do not invalidate quantities,
            // so the fitted quantities are invalidated here
            if let Some(objection) = objections(found).into_iter().next() {
                let estimates = found.fit.estimates.iter().zip(&mut outcome.quantities);
                let fitted = estimates
                    .filter(|(one, own)| own.valid && !matches!(one.verdict, Identified::Given));
                for (_, quantity) in fitted {
                    quantity.valid = false;
                    quantity.verdict.clone_from(&objection);
                }
            }
            outcome.say(format!(
                "The tests do not determine the model: the {reason}."
            ));
            outcome.refuse(reason);
        }
        None => outcome.say(answer(found)),
    }
    outcome.say(format!(
        "{} readings of {} tests at {}: chi-square {} with {} degrees of freedom.",
        found.tests.iter().map(|t| t.time().len()).sum::<usize>(),
        found.tests.len(),
        hertz(found.sheet.frequency.si()),
        significant(fit.chi_squared, 3),
        fit.degrees_of_freedom,
    ));
    outcome.quantities.push(Quantity::of(
        "chi-square of the readings",
        "",
        fit.chi_squared,
        format!("{} degrees of freedom", fit.degrees_of_freedom),
    ));
    of_single_tests(
        outcome,
        &found.tests,
        &found.singles,
        has_stated_errors(found.sheet),
    );
    if let Some(paper) = &found.paper {
        for (name, unit, value) in [
            (
                "modulus of the spring beside the dashpot, procedure of the paper",
                "Pa",
                paper.parameters.parallel_modulus,
            ),
            (
                "coefficient of the dashpot, procedure of the paper",
                "Pa^-(m+1) s^-1",
                paper.parameters.coefficient,
            ),
            (
                "exponent of the dashpot, procedure of the paper",
                "",
                paper.parameters.exponent,
            ),
        ] {
            outcome.quantities.push(Quantity::of(
                name,
                unit,
                value,
                "without errors: compare with the joint fit",
            ));
        }
    }
    warn(outcome, found);
}

/// Returns the first sentence of the answer.
fn answer(found: &Found<'_>) -> String {
    let of = |symbol: &str| found.fit.estimates.iter().find(|e| e.symbol == symbol);
    let exponent = of("m").map_or_else(String::new, |m| {
        with_error(Some(m.value), Some(m.standard_error))
    });
    let modulus = of("E2").map_or_else(String::new, |e| {
        format!(
            "{} kPa ± {}",
            to_error(1e-3 * e.value, 1e-3 * e.value * e.standard_error),
            percent(e.standard_error)
        )
    });
    format!(
        "The dashpot has the exponent m = {exponent}, and the spring in parallel with it the modulus E2 = {modulus}."
    )
}

fn quantity(estimate: &Estimate) -> Quantity {
    let identified = !matches!(estimate.verdict, Identified::NotIdentifiable(_));
    let mut verdict = estimate.verdict.to_string();
    let standard_error = match estimate.scale {
        Scale::Difference => Some(estimate.standard_error),
        // this is the error of the logarithm; from 0.5 on it is meaningless as an error of the
        // value
        Scale::Ratio if estimate.standard_error < 0.5 => {
            Some(estimate.value * estimate.standard_error)
        }
        Scale::Ratio => {
            if identified {
                let factor = significant(estimate.standard_error.exp(), 2);
                verdict = format!("{verdict}; known to a factor of {factor}");
            }
            None
        }
    };
    let name = format!("{} ({})", estimate.name, estimate.symbol);
    let (unit, value) = (
        shown_unit(estimate.unit),
        identified.then_some(estimate.value),
    );
    Quantity::of(name, unit, value, verdict)
        .with_error(standard_error.filter(|error| identified && error.is_finite()))
}

/// Adds initial change and recovery time of each test, from equation 4 of paper C. If the errors
/// are stated, chi-square of the readings tests the equation.
fn of_single_tests(
    outcome: &mut Outcome,
    tests: &[RecoveryTest],
    singles: &[Result<SingleTestFit, CmodError>],
    errors_are_stated: bool,
) {
    for (test, single) in tests.iter().zip(singles) {
        let name = test.name();
        match single {
            Ok(single) => {
                let freedom = single.degrees_of_freedom as f64;
                let misfit = (errors_are_stated
                    && freedom > 0.0
                    && single.chi_squared > most_explained(freedom))
                .then(|| {
                    format!(
                        "the readings do not follow 1/(1 + t/t_r): chi-square {} with {freedom} degrees of freedom",
                        significant(single.chi_squared, 3)
                    )
                });
                for (what, unit, value, error) in [
                    (
                        "initial change of the loss factor",
                        "",
                        single.initial_change,
                        single.initial_change_error,
                    ),
                    (
                        "recovery time",
                        "s",
                        single.recovery_time,
                        single.recovery_time_error,
                    ),
                ] {
                    let determined = error < 0.5;
                    let verdict = match &misfit {
                        _ if !determined => "not determined by this test alone",
                        Some(misfit) => misfit,
                        None => "determined by this test",
                    };
                    let (name, found) =
                        (format!("{what}, {name} alone"), determined.then_some(value));
                    let quantity = Quantity::of(name, unit, found, verdict)
                        .with_error(determined.then_some(value * error))
                        .valid_if(determined && misfit.is_none());
                    outcome.quantities.push(quantity);
                }
            }
            Err(error) => outcome.reject(format!("{name} by itself"), error),
        }
    }
}

/// Returns the objections to the fit of all tests, one clause each.
fn objections(found: &Found<'_>) -> Vec<String> {
    let fit = &found.fit;
    let freedom = fit.degrees_of_freedom as f64;
    let most = most_explained(freedom);
    let mut objections = Vec::new();
    if has_stated_errors(found.sheet) && freedom > 0.0 && fit.chi_squared > most {
        objections.push(format!(
            "the readings scatter more about the model than their stated errors allow: chi-square {} with {} degrees of freedom, \
             expected below {}; either the errors are larger than stated, or the model is not valid; in both cases the errors of the result are too small",
            significant(fit.chi_squared, 3),
            fit.degrees_of_freedom,
            significant(most, 3)
        ));
    }
    let singles: Option<Vec<SingleTestFit>> = found
        .singles
        .iter()
        .map(|single| single.as_ref().ok().copied())
        .collect();
    let apart = singles.and_then(|singles| fit.disagreement(&singles));
    if let Some(apart) = apart
        && has_stated_errors(found.sheet)
        && apart.p_value < CONTRADICTED
    {
        objections.push(format!(
            "the tests contradict each other: chi-square rises by {} with {} degrees of freedom from the tests alone to one model for all, probability {} by chance; \
             a load or the readings of a test are wrong, or the model is not valid",
            significant(apart.chi_squared, 3),
            apart.degrees_of_freedom,
            significant(apart.p_value, 2)
        ));
    }
    if fit.ending != Ending::Converged {
        objections.push(format!(
            "the fit did not converge ({:?}): its values are those at which the iteration stopped",
            fit.ending
        ));
    }
    objections
}

fn warn(outcome: &mut Outcome, found: &Found<'_>) {
    outcome.doubt_all(objections(found));
    outcome.warn(
        "The model describes the loss factor at the frequency of the tests and nothing else: its spring moduli are not moduli of the \
         material under creep.",
    );
}

/// Adds the predicted change of the loss factor 1 minute, 10 minutes and 1 hour after the unloading
/// of each predicted load.
pub(super) fn predict(outcome: &mut Outcome, found: &Found<'_>) -> Result<(), CmodError> {
    for (name, test) in &found.predictions {
        let times = [60.0, 600.0, 3600.0];
        for (time, point) in times.iter().zip(found.curve(test, &times)?) {
            let name = format!("change of the loss factor {time:.0} s after {name}, predicted");
            let error = finite(point.standard_error);
            let quantity = Quantity::of(name, "", point.change, "from the common model");
            let quantity = quantity.with_error(error).valid_if(error.is_some());
            outcome.quantities.push(quantity);
        }
    }
    Ok(())
}
