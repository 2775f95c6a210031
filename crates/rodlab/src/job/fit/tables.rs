//! Tables of the result.

use std::f64::consts::{LN_10, TAU};

use cmod::CmodError;
use cmod::rheology::{
    Comparison, ErrorScale, Law, MasterPoint, Parameter, PredictedModulus, ShiftLaws,
};
use num_complex::Complex64;

use super::columns::Row;
use super::steps::to_celsius;
use super::{Found, Sweep};
use crate::laws::of_value;
use crate::outcome::{Column, Table};
use crate::{InStep, RodlabError};

/// Returns the table of all fitted rows.
pub(super) fn data(found: &Found<'_>) -> Table {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let rows = || {
        found
            .steps
            .iter()
            .flat_map(|step| step.rows.iter().map(move |row| (step, row)))
    };
    let numbers = |name: String, unit: &str, of: &dyn Fn(&Row) -> f64| {
        Column::numbers(name, unit, rows().map(|(_, row)| of(row)).collect())
    };
    let mut columns = vec![
        Column::numbers(
            "temperature",
            "degC",
            rows()
                .map(|(step, _)| to_celsius(step.temperature))
                .collect(),
        ),
        numbers("temperature of the row".to_owned(), "degC", &|row| {
            to_celsius(row.temperature)
        }),
    ];
    let is_stated = found.error_scale == ErrorScale::Stated;
    if found.has_times() {
        // rows over frequency have no value in the columns for time, and vice versa
        let of_time = |row: &Row, value: f64| row.time().map_or(f64::NAN, |_| value);
        columns.extend([
            numbers("time".to_owned(), "s", &|row| {
                row.time().unwrap_or(f64::NAN)
            }),
            numbers("modulus over time".to_owned(), unit, &|row| {
                of_time(row, row.modulus.re / pascal)
            }),
        ]);
        if is_stated {
            columns.push(numbers(
                "standard error of the modulus over time".to_owned(),
                unit,
                &|row| of_time(row, row.covariance.real.sqrt() / pascal),
            ));
        }
    }
    if found.has_frequencies() {
        let of_frequency = |row: &Row, value: f64| row.time().map_or(value, |_| f64::NAN);
        columns.extend([
            numbers("frequency".to_owned(), "Hz", &|row| {
                of_frequency(row, row.frequency_hz)
            }),
            numbers(format!("{symbol}'"), unit, &|row| {
                of_frequency(row, row.modulus.re / pascal)
            }),
            numbers(format!("{symbol}''"), unit, &|row| {
                of_frequency(row, row.modulus.im / pascal)
            }),
            numbers("loss factor".to_owned(), "", &|row| {
                of_frequency(row, row.modulus.im / row.modulus.re)
            }),
        ]);
        if is_stated {
            columns.push(numbers(
                format!("standard error of {symbol}'"),
                unit,
                &|row| of_frequency(row, row.covariance.real.sqrt() / pascal),
            ));
            columns.push(numbers(
                format!("standard error of {symbol}''"),
                unit,
                &|row| of_frequency(row, row.covariance.imaginary.sqrt() / pascal),
            ));
        }
    }
    columns.push(Column::words(
        "file and line",
        rows().map(|(_, row)| row.place.clone()).collect(),
    ));
    Table::of("data", "Moduli that were fitted", columns)
}

/// Returns the tables of the master curve, its shifts, the laws of the shifts and the Prony series.
pub(super) fn of_sweep(found: &Found<'_>) -> Result<Vec<Table>, RodlabError> {
    let Some(sweep) = &found.sweep else {
        return Ok(Vec::new());
    };
    let mut tables = vec![
        master_curve(found, sweep).in_step("the master curve")?,
        shifts(sweep),
    ];
    if let Ok(laws) = &sweep.shift_laws {
        tables.push(shift_laws(laws, sweep.by_scatter.as_ref()));
    }
    tables.extend(series(sweep));
    Ok(tables)
}

fn master_curve(found: &Found<'_>, sweep: &Sweep) -> Result<Table, CmodError> {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let curve = &sweep.curve;
    let mut points: Vec<_> = curve.points.iter().collect();
    points.sort_by(|a, b| a.reduced_frequency_hz.total_cmp(&b.reduced_frequency_hz));
    let predicted = points
        .iter()
        .map(|point| curve.fit.prediction(TAU * point.reduced_frequency_hz))
        .collect::<Result<Vec<_>, _>>()?;
    let rows = || points.iter().zip(&predicted);
    let numbers = |name: &str, unit: &str, of: &dyn Fn(&MasterPoint, &PredictedModulus) -> f64| {
        let values = rows().map(|(point, predicted)| of(point, predicted));
        Column::numbers(name, unit, values.collect())
    };
    let error = |[first, second]: [[f64; 2]; 2], part: usize| {
        let variance = if part == 0 { first[0] } else { second[1] };
        variance.sqrt() / pascal
    };
    let left = |point: &MasterPoint, fitted: Complex64| {
        100.0 * (point.modulus - fitted) / point.modulus.norm()
    };
    let mut columns = vec![numbers("temperature", "degC", &|point, _| {
        to_celsius(point.temperature)
    })];
    if found.has_times() {
        let held = |point: &MasterPoint, value: f64| point.reduced_time.map_or(f64::NAN, |_| value);
        columns.extend([
            numbers("reduced time", "s", &|point, _| {
                point.reduced_time.unwrap_or(f64::NAN)
            }),
            numbers("modulus over time", unit, &|point, _| {
                held(point, point.modulus.re / pascal)
            }),
            numbers("modulus over time of the series", unit, &|point, _| {
                held(point, point.fitted.re / pascal)
            }),
            numbers("residual of the modulus over time", "%", &|point, _| {
                held(point, left(point, point.fitted).re)
            }),
        ]);
    }
    let swept = |point: &MasterPoint, value: f64| point.reduced_time.map_or(value, |_| f64::NAN);
    columns.push(numbers("reduced frequency", "Hz", &|point, _| {
        point.reduced_frequency_hz
    }));
    if found.has_frequencies() {
        columns.extend([
            numbers(&format!("{symbol}'"), unit, &|point, _| {
                swept(point, point.modulus.re / pascal)
            }),
            numbers(&format!("{symbol}''"), unit, &|point, _| {
                swept(point, point.modulus.im / pascal)
            }),
            numbers("loss factor", "", &|point, _| {
                swept(point, point.modulus.im / point.modulus.re)
            }),
        ]);
    }
    columns.extend([
        numbers(&format!("{symbol}' of the series"), unit, &|_, series| {
            series.modulus.re / pascal
        }),
        numbers(&format!("{symbol}'' of the series"), unit, &|_, series| {
            series.modulus.im / pascal
        }),
        numbers(
            &format!("standard error of {symbol}' of the series"),
            unit,
            &|_, series| error(series.covariance, 0),
        ),
        numbers(
            &format!("standard error of {symbol}'' of the series"),
            unit,
            &|_, series| error(series.covariance, 1),
        ),
    ]);
    if found.has_frequencies() {
        columns.extend([
            numbers(
                &format!("residual of {symbol}' by |{symbol}|"),
                "%",
                &|point, series| swept(point, left(point, series.modulus).re),
            ),
            numbers(
                &format!("residual of {symbol}'' by |{symbol}|"),
                "%",
                &|point, series| swept(point, left(point, series.modulus).im),
            ),
        ]);
    }
    Ok(Table {
        name: "master_curve".to_owned(),
        title: format!(
            "Master curve at {}: lines at their reduced {}, and the series",
            super::steps::celsius(curve.reference_temperature),
            if found.has_times() {
                "times and frequencies"
            } else {
                "frequencies"
            }
        ),
        columns,
    })
}

fn shifts(sweep: &Sweep) -> Table {
    let all = &sweep.curve.shifts;
    let log = |value: f64| value / LN_10;
    let numbers = |name: &str, unit: &str, of: &dyn Fn(&cmod::rheology::Shift) -> f64| {
        Column::numbers(name, unit, all.iter().map(of).collect())
    };
    let words = |shift: &cmod::rheology::Shift| {
        if shift
            .temperature
            .total_cmp(&sweep.curve.reference_temperature)
            .is_eq()
        {
            "reference".to_owned()
        } else if shift.is_stated {
            "as stated, without overlap".to_owned()
        } else {
            shift.verdict.to_string()
        }
    };
    Table {
        name: "shifts".to_owned(),
        title: "Shifts of the temperatures".to_owned(),
        columns: vec![
            numbers("temperature", "degC", &|shift| {
                to_celsius(shift.temperature)
            }),
            numbers("log10 of the shift", "", &|shift| log(shift.log_shift)),
            numbers("standard error", "", &|shift| log(shift.standard_error)),
            numbers("part due to the choice of the order", "", &|shift| {
                log(shift.order_error)
            }),
            numbers("lower end", "", &|shift| log(shift.interval.lower)),
            numbers("upper end", "", &|shift| log(shift.interval.upper)),
            numbers(
                "log10 of the shift from the colder one, by overlap",
                "",
                &|shift| shift.overlap.map_or(f64::NAN, log),
            ),
            numbers("factor of the modulus", "", &|shift| shift.vertical),
            numbers("relative standard error of the factor", "", &|shift| {
                shift.vertical_standard_error
            }),
            Column::words("verdict", all.iter().map(words).collect()),
        ],
    }
}

fn shift_laws(own: &ShiftLaws, by_scatter: Option<&ShiftLaws>) -> Table {
    let all: Vec<(&str, &ShiftLaws)> = std::iter::once(("errors of the shifts", own))
        .chain(by_scatter.map(|laws| ("equal, by the scatter", laws)))
        .collect();
    let numbers = |name: &str,
                   unit: &str,
                   of_wlf: &dyn Fn(&ShiftLaws) -> f64,
                   of_arrhenius: &dyn Fn(&ShiftLaws) -> f64| {
        let pairs = all
            .iter()
            .flat_map(|(_, laws)| [of_wlf(laws), of_arrhenius(laws)]);
        Column::numbers(name, unit, pairs.collect())
    };
    let none = |_: &ShiftLaws| f64::NAN;
    let names = all
        .iter()
        .flat_map(|_| ["WLF".to_owned(), "Arrhenius".to_owned()]);
    let weights = all
        .iter()
        .flat_map(|(errors, _)| [(*errors).to_owned(), (*errors).to_owned()]);
    Table {
        name: "shift_laws".to_owned(),
        title: "Laws of the shifts".to_owned(),
        columns: vec![
            Column::words("law", names.collect()),
            Column::words("errors", weights.collect()),
            numbers("C1", "", &|laws| laws.wlf.c1, &none),
            numbers(
                "standard error of C1",
                "",
                &|laws| laws.wlf.c1_standard_error,
                &none,
            ),
            numbers("C2", "K", &|laws| laws.wlf.c2, &none),
            numbers(
                "standard error of C2",
                "K",
                &|laws| laws.wlf.c2_standard_error,
                &none,
            ),
            numbers("activation energy", "kJ/mol", &none, &|laws| {
                1e-3 * laws.arrhenius.activation_energy
            }),
            numbers(
                "standard error of the activation energy",
                "kJ/mol",
                &none,
                &|laws| 1e-3 * laws.arrhenius.standard_error,
            ),
            numbers("chi-square", "", &|laws| laws.wlf.chi_squared, &|laws| {
                laws.arrhenius.chi_squared
            }),
            numbers(
                "degrees of freedom",
                "",
                &|laws| laws.wlf.degrees_of_freedom as f64,
                &|laws| laws.arrhenius.degrees_of_freedom as f64,
            ),
            numbers("probability", "", &ShiftLaws::wlf_p_value, &|laws| {
                laws.arrhenius_p_value
            }),
            numbers(
                "lower end of C1",
                "",
                &|laws| laws.wlf.c1_interval.lower,
                &none,
            ),
            numbers(
                "upper end of C1",
                "",
                &|laws| laws.wlf.c1_interval.upper,
                &none,
            ),
            numbers(
                "lower end of C2",
                "K",
                &|laws| laws.wlf.c2_interval.lower,
                &none,
            ),
            numbers(
                "upper end of C2",
                "K",
                &|laws| laws.wlf.c2_interval.upper,
                &none,
            ),
        ],
    }
}

/// Returns the table of the parameters of all laws with their confidence intervals.
pub(super) fn parameters(comparison: &Comparison) -> Table {
    let all: Vec<_> = comparison
        .rows
        .iter()
        .flat_map(|row| {
            row.fit
                .parameters
                .iter()
                .map(|own| (row.fit.law.law(), own))
        })
        .collect();
    let words = |name: &str, of: &dyn Fn(&(Law, &Parameter)) -> String| {
        Column::words(name, all.iter().map(of).collect())
    };
    let numbers = |name: &str, of: &dyn Fn(&Parameter) -> f64| {
        Column::numbers(name, "", all.iter().map(|(_, own)| of(own)).collect())
    };
    Table {
        name: "parameters".to_owned(),
        title: "Parameters of the laws".to_owned(),
        columns: vec![
            words("law", &|(law, _)| law.to_string()),
            words("parameter", &|(_, own)| own.name.clone()),
            words("unit", &|(_, own)| own.unit.to_owned()),
            numbers("value", &|own| own.value),
            numbers("standard error", &|own| {
                of_value(own, own.standard_error).unwrap_or(f64::NAN)
            }),
            numbers("lower end", &|own| own.interval.lower),
            numbers("upper end", &|own| own.interval.upper),
            words("verdict", &|(_, own)| own.verdict.to_string()),
        ],
    }
}

/// Returns the table of the Prony series of the master curve.
fn series(sweep: &Sweep) -> Option<Table> {
    let fit = &sweep.curve.fit;
    let count = 2 * sweep.curve.series()?.branches().len()
        + usize::from(sweep.curve.series()?.equilibrium_modulus() > 0.0);
    let parameters: Vec<_> = fit.parameters.iter().take(count).collect();
    let column = |name: &str, of: &dyn Fn(&Parameter) -> f64| {
        Column::numbers(
            name,
            "",
            parameters.iter().map(|parameter| of(parameter)).collect(),
        )
    };
    Some(Table {
        name: "series".to_owned(),
        title: "Prony series of the master curve".to_owned(),
        columns: vec![
            Column::words(
                "parameter",
                parameters.iter().map(|p| p.name.clone()).collect(),
            ),
            Column::words(
                "unit",
                parameters.iter().map(|p| p.unit.to_owned()).collect(),
            ),
            column("value", &|p| p.value),
            column("standard error", &|p| {
                of_value(p, p.standard_error).unwrap_or(f64::NAN)
            }),
            Column::words(
                "verdict",
                parameters
                    .iter()
                    .map(|p| {
                        let determined = p.verdict.is_identified();
                        if determined {
                            "identified"
                        } else {
                            "not identified by itself"
                        }
                        .to_owned()
                    })
                    .collect(),
            ),
        ],
    })
}
