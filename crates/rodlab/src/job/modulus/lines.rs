//! The table of all lines.

use cmod::ModulusLine;

use super::Found;
use crate::outcome::{Column, Table};

/// Every line that has a modulus, valid or not.
pub(super) fn table(found: &Found<'_>) -> Table {
    let lines = found.estimate.lines();
    let numbers = |name: &str, unit: &str, value: &dyn Fn(&ModulusLine) -> f64| {
        Column::numbers(name, unit, lines.iter().map(value).collect())
    };
    let giga = 1e-9;
    let mut columns = vec![
        numbers("frequency", "Hz", &|l| l.frequency_hz),
        numbers("E'", "GPa", &|l| giga * l.modulus.re),
        numbers("standard error of E'", "GPa", &|l| {
            giga * l.standard_error.storage_modulus
        }),
        numbers("E''", "GPa", &|l| giga * l.modulus.im),
        numbers("standard error of E''", "GPa", &|l| {
            giga * l.standard_error.loss_modulus
        }),
        numbers("covariance of E' and E''", "GPa^2", &|l| {
            giga * giga * l.covariance().mixed
        }),
        numbers("loss factor", "", &|l| l.loss_factor),
        numbers("standard error of the loss factor", "", &|l| {
            l.standard_error.loss_factor
        }),
        numbers("random error of E'", "GPa", &|l| {
            giga * l.random_error().storage_modulus
        }),
        numbers("common error of E'", "GPa", &|l| {
            giga * l.systematic_error().storage_modulus
        }),
        numbers("random error of the loss factor", "", &|l| {
            l.random_error().loss_factor
        }),
        numbers("common error of the loss factor", "", &|l| {
            l.systematic_error().loss_factor
        }),
        numbers("lateral inertia left in E', at most", "GPa", &|l| {
            giga * l.lateral_inertia_bound().storage_modulus
        }),
        numbers("wave number", "rad/m", &ModulusLine::wave_number),
        numbers("standard error of the wave number", "rad/m", &|l| {
            l.standard_error.wave_number
        }),
        numbers(
            "damping coefficient",
            "1/m",
            &ModulusLine::damping_coefficient,
        ),
        numbers("standard error of the damping coefficient", "1/m", &|l| {
            l.standard_error.damping_coefficient
        }),
        numbers("phase velocity", "m/s", &|l| l.phase_velocity),
        numbers("standard error of the phase velocity", "m/s", &|l| {
            l.standard_error.phase_velocity
        }),
        numbers("error amplification", "", &|l| l.error_amplification),
    ];
    if let Some(corrected) = found.corrected {
        let corrections = corrected.corrections().iter();
        columns.push(Column::numbers(
            "E' with lateral inertia in it",
            "GPa",
            corrections
                .map(|line| giga * line.apparent_modulus.re)
                .collect(),
        ));
    }
    columns.push(Column::words(
        "validity",
        lines.iter().map(|line| line.validity.to_string()).collect(),
    ));
    Table {
        name: "modulus".to_owned(),
        title: "Complex modulus".to_owned(),
        columns,
    }
}
