//! Tables of all lines: the modulus, and the sources of its uncertainty.

use cmod::ModulusLine;
use cmod::estimate::{Budget, BudgetedQuantity, ErrorSource};

use super::Found;
use super::reasons::Reasons;
use crate::outcome::{Column, Rows, Table};
use crate::{InStep, RodlabError};

/// Returns the table of the lines with a modulus, valid or not, with the `reasons` of invalid
/// lines.
pub(super) fn table(found: &Found<'_>, reasons: &Reasons) -> Table {
    let lines = found.estimate.lines();
    let giga = 1e-9;
    let mut rows = Rows::of(lines, "modulus", "Complex modulus")
        .number("frequency", "Hz", |l| l.frequency_hz)
        .number("E'", "GPa", |l| giga * l.modulus.re)
        .number("standard error of E'", "GPa", |l| {
            giga * l.standard_error.storage_modulus
        })
        .number("E''", "GPa", |l| giga * l.modulus.im)
        .number("standard error of E''", "GPa", |l| {
            giga * l.standard_error.loss_modulus
        })
        .number("covariance of E' and E''", "GPa^2", |l| {
            giga * giga * l.covariance().mixed
        })
        .number("loss factor", "", |l| l.loss_factor)
        .number("standard error of the loss factor", "", |l| {
            l.standard_error.loss_factor
        })
        .number("random error of E'", "GPa", |l| {
            giga * l.random_error().storage_modulus
        })
        .number("common error of E'", "GPa", |l| {
            giga * l.systematic_error().storage_modulus
        })
        .number("random error of the loss factor", "", |l| {
            l.random_error().loss_factor
        })
        .number("common error of the loss factor", "", |l| {
            l.systematic_error().loss_factor
        })
        .number("bound of the lateral inertia left in E'", "GPa", |l| {
            giga * l.lateral_inertia_bound().storage_modulus
        })
        .number("wave number", "rad/m", ModulusLine::wave_number)
        .number("standard error of the wave number", "rad/m", |l| {
            l.standard_error.wave_number
        })
        .number("damping coefficient", "1/m", |l| l.damping_coefficient())
        .number("standard error of the damping coefficient", "1/m", |l| {
            l.standard_error.damping_coefficient
        })
        .number("phase velocity", "m/s", |l| l.phase_velocity)
        .number("standard error of the phase velocity", "m/s", |l| {
            l.standard_error.phase_velocity
        })
        .number("error amplification", "", |l| l.error_amplification);
    if let Some(corrected) = found.corrected {
        let corrections = corrected.corrections().iter();
        let apparent = corrections.map(|line| giga * line.apparent_modulus.re);
        let name = "E' before the correction of lateral inertia";
        rows.table = rows.table.numbers(name, "GPa", apparent);
    }
    let validity = Column::validity(
        lines.iter().map(|line| line.validity.is_valid()).collect(),
        lines.iter().map(|line| line.validity.to_string()).collect(),
    );
    rows.table
        .with(validity.with_kinds(reasons.of_line.clone()))
}

/// Returns the sources of common errors that have a standard uncertainty on any line.
pub(super) fn sources_of<'a>(lines: impl IntoIterator<Item = &'a ModulusLine>) -> Vec<ErrorSource> {
    let mut sources: Vec<ErrorSource> = Vec::new();
    let lines = lines.into_iter();
    for shift in lines.flat_map(|line| &line.uncertainty.systematic) {
        if shift.source != ErrorSource::LateralInertia && !sources.contains(&shift.source) {
            sources.push(shift.source);
        }
    }
    sources
}

/// Returns the table of the sources of the uncertainty on every line: of E' in % of E', and of the
/// loss factor in absolute numbers. `None` if noise is the only source.
pub(super) fn budget(found: &Found<'_>) -> Result<Option<Table>, RodlabError> {
    let lines = found.estimate.lines();
    let sources = sources_of(lines);
    if sources.is_empty() {
        return Ok(None);
    }
    let frequency = lines.iter().map(|line| line.frequency_hz);
    let mut table =
        Table::new("budget", "Budget of uncertainty").numbers("frequency", "Hz", frequency);
    for (name, unit, quantity) in [
        ("E'", "%", BudgetedQuantity::StorageModulus),
        ("the loss factor", "", BudgetedQuantity::LossFactor),
    ] {
        let scales: Vec<f64> = lines
            .iter()
            .map(|line| match quantity {
                BudgetedQuantity::StorageModulus => 100.0 / line.modulus.re.abs(),
                _ => 1.0,
            })
            .collect();
        let budgets: Vec<Budget> = lines.iter().map(|line| line.budget(quantity)).collect();
        let column = |table: Table, what: &str, value: &dyn Fn(&Budget) -> f64| {
            let scaled = budgets.iter().zip(&scales);
            let values = scaled.map(|(budget, scale)| scale * value(budget));
            table.numbers(format!("{what}, of {name}"), unit, values)
        };
        table = column(table, "random", &Budget::random);
        for source in &sources {
            let of_source = |budget: &Budget| {
                let mut sources = budget.sources().iter();
                let own = sources.find(|(other, _)| other == source);
                own.map_or(0.0, |(_, error)| *error)
            };
            table = column(table, &source.to_string(), &of_source);
        }
        let expanded = budgets
            .iter()
            .map(|budget| budget.expanded_uncertainty(0.95))
            .collect::<Result<Vec<f64>, _>>()
            .in_step("the budget of uncertainty")?;
        let scaled = expanded.iter().zip(&scales);
        let largest = |budget: &Budget| match budget.sources().first() {
            Some((source, error)) if *error > budget.random() => source.to_string(),
            _ => "random".to_owned(),
        };
        table = table
            .numbers(
                format!("expanded uncertainty (95 %), of {name}"),
                unit,
                scaled.map(|(error, scale)| scale * error),
            )
            .words(
                format!("largest source, of {name}"),
                budgets.iter().map(largest),
            );
    }
    Ok(Some(table))
}
