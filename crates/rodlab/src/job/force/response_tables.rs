//! Tables of a force from a response.

use impulse::{ForceBand, ReconstructedForce};

use super::response_answer::Bands;
use super::response_problem::Problem;
use crate::outcome::{Column, Table};

/// Returns the table of the force, with one row for each sample.
pub(super) fn force(problem: &Problem<'_>, solved: &ReconstructedForce, bands: &Bands) -> Table {
    let history = &solved.history;
    let steps = 0..history.force().len();
    let mut columns = vec![
        Column::numbers("time", "s", steps.map(|n| history.time_at(n)).collect()),
        Column::numbers(
            "response",
            problem.first.unit,
            problem.first.samples.clone(),
        ),
        Column::numbers("force", "N", history.force().to_vec()),
    ];
    let limits = |name: &str, band: &ForceBand| {
        [
            Column::numbers(format!("{name}, lower"), "N", band.lower.clone()),
            Column::numbers(format!("{name}, upper"), "N", band.upper.clone()),
        ]
    };
    if let Some(known) = &bands.random {
        columns.push(Column::numbers(
            "standard error of the force",
            "N",
            known.error.standard_error().to_vec(),
        ));
        columns.extend(limits("pointwise band", &known.pointwise));
        columns.extend(limits("band of the whole history", &known.simultaneous));
    }
    columns.push(Column::numbers(
        "change by the regularisation",
        "N",
        solved.regularisation_bias.clone(),
    ));
    if let Some(measured) = &problem.measured {
        columns.push(Column::numbers("measured force", "N", measured.clone()));
    }
    Table::of("force", "Force from the response", columns)
}

/// Returns the table of the curve from which the parameter was chosen; `None` if it was not chosen.
pub(super) fn curve(solved: &ReconstructedForce) -> Option<Table> {
    let curve = &solved.parameter.as_ref()?.curve;
    if curve.is_empty() {
        return None;
    }
    let of = |value: &dyn Fn(&impulse::CurvePoint) -> f64| curve.iter().map(value).collect();
    Some(Table {
        name: "regularisation".to_owned(),
        title: "Results with other regularisation parameters".to_owned(),
        columns: vec![
            Column::numbers("parameter", "", of(&|point| point.parameter)),
            Column::numbers("squared residual", "", of(&|point| point.squared_residual)),
            Column::numbers("squared norm", "", of(&|point| point.squared_norm)),
            Column::numbers(
                "degrees of freedom",
                "",
                of(&|point| point.degrees_of_freedom),
            ),
            Column::numbers("score", "", of(&|point| point.score)),
        ],
    })
}
