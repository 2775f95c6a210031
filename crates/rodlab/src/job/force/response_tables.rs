//! Tables of a force from a response.

use impulse::ReconstructedForce;

use super::histories::{times, with_band};
use super::response_answer::Bands;
use super::response_problem::Problem;
use crate::outcome::{Rows, Table};

/// Returns the table of the force, with one row for each sample.
pub(super) fn force(problem: &Problem<'_>, solved: &ReconstructedForce, bands: &Bands) -> Table {
    let history = &solved.history;
    let mut table = Table::new("force", "Force from the response")
        .numbers("time", "s", times(history))
        .numbers("response", problem.first.unit, &problem.first.samples)
        .numbers("force", "N", history.force());
    if let Some(known) = &bands.random {
        let errors = known.error.standard_error();
        table = table.numbers("standard error of the force", "N", errors);
        table = with_band(table, "pointwise band", &known.pointwise);
        table = with_band(table, "band of the whole history", &known.simultaneous);
    }
    table = table.numbers(
        "change by the regularisation",
        "N",
        &solved.regularisation_bias,
    );
    match &problem.measured {
        Some(measured) => table.numbers("measured force", "N", measured),
        None => table,
    }
}

/// Returns the table of the curve from which the parameter was chosen; `None` if it was not chosen.
pub(super) fn curve(solved: &ReconstructedForce) -> Option<Table> {
    let curve = &solved.parameter.as_ref()?.curve;
    if curve.is_empty() {
        return None;
    }
    let title = "Results with other regularisation parameters";
    let rows = Rows::of(curve, "regularisation", title)
        .number("parameter", "", |point| point.parameter)
        .number("squared residual", "", |point| point.squared_residual)
        .number("squared norm", "", |point| point.squared_norm)
        .number("degrees of freedom", "", |point| point.degrees_of_freedom)
        .number("score", "", |point| point.score);
    Some(rows.table)
}
