//! Tables of the result.

use std::f64::consts::{LN_10, TAU};

use cmod::CmodError;
use cmod::rheology::{
    Arrhenius, Comparison, ErrorScale, MasterPoint, PredictedModulus, Shift, ShiftLaws, Wlf,
};
use num_complex::Complex64;

use super::columns::Row;
use super::steps::{Step, to_celsius};
use super::{Found, Sweep};
use crate::laws::of_value;
use crate::outcome::{Rows, Table};
use crate::{InStep, RodlabError};

/// Returns the table of all fitted rows.
pub(super) fn data(found: &Found<'_>) -> Table {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let steps = found.steps.iter();
    let rows: Vec<(&Step, &Row)> = steps
        .flat_map(|step| step.rows.iter().map(move |row| (step, row)))
        .collect();
    let mut table = Rows::of(&rows, "data", "Moduli that were fitted")
        .number("temperature", "degC", |(step, _)| {
            to_celsius(step.temperature)
        })
        .number("temperature of the row", "degC", |(_, row)| {
            to_celsius(row.temperature)
        });
    let is_stated = found.error_scale == ErrorScale::Stated;
    if found.has_times() {
        // rows over frequency have no value in the columns for time, and vice versa
        let of_time = |row: &Row, value: f64| row.time().map_or(f64::NAN, |_| value);
        table = table
            .number("time", "s", |(_, row)| row.time().unwrap_or(f64::NAN))
            .number("modulus over time", unit, |(_, row)| {
                of_time(row, row.modulus.re / pascal)
            });
        if is_stated {
            let name = "standard error of the modulus over time";
            table = table.number(name, unit, |(_, row)| {
                of_time(row, row.covariance.real.sqrt() / pascal)
            });
        }
    }
    if found.has_frequencies() {
        let of_frequency = |row: &Row, value: f64| row.time().map_or(value, |_| f64::NAN);
        table = table
            .number("frequency", "Hz", |(_, row)| {
                of_frequency(row, row.frequency_hz)
            })
            .number(format!("{symbol}'"), unit, |(_, row)| {
                of_frequency(row, row.modulus.re / pascal)
            })
            .number(format!("{symbol}''"), unit, |(_, row)| {
                of_frequency(row, row.modulus.im / pascal)
            })
            .number("loss factor", "", |(_, row)| {
                of_frequency(row, row.modulus.im / row.modulus.re)
            });
        if is_stated {
            let name = format!("standard error of {symbol}'");
            table = table
                .number(&name, unit, |(_, row)| {
                    of_frequency(row, row.covariance.real.sqrt() / pascal)
                })
                .number(format!("{name}'"), unit, |(_, row)| {
                    of_frequency(row, row.covariance.imaginary.sqrt() / pascal)
                });
        }
    }
    table.word("file and line", |(_, row)| &row.place).table
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
    let rows: Vec<(&MasterPoint, &PredictedModulus)> = points.into_iter().zip(&predicted).collect();
    let error = |[first, second]: [[f64; 2]; 2], part: usize| {
        let variance = if part == 0 { first[0] } else { second[1] };
        variance.sqrt() / pascal
    };
    let left = |point: &MasterPoint, fitted: Complex64| {
        100.0 * (point.modulus - fitted) / point.modulus.norm()
    };
    let title = format!(
        "Master curve at {}: lines at their reduced {}, and the series",
        super::steps::celsius(curve.reference_temperature),
        if found.has_times() {
            "times and frequencies"
        } else {
            "frequencies"
        }
    );
    let mut table =
        Rows::of(&rows, "master_curve", title).number("temperature", "degC", |(point, _)| {
            to_celsius(point.temperature)
        });
    if found.has_times() {
        let held = |point: &MasterPoint, value: f64| point.reduced_time.map_or(f64::NAN, |_| value);
        table = table
            .number("reduced time", "s", |(point, _)| {
                point.reduced_time.unwrap_or(f64::NAN)
            })
            .number("modulus over time", unit, |(point, _)| {
                held(point, point.modulus.re / pascal)
            })
            .number("modulus over time of the series", unit, |(point, _)| {
                held(point, point.fitted.re / pascal)
            })
            .number("residual of the modulus over time", "%", |(point, _)| {
                held(point, left(point, point.fitted).re)
            });
    }
    let swept = |point: &MasterPoint, value: f64| point.reduced_time.map_or(value, |_| f64::NAN);
    table = table.number("reduced frequency", "Hz", |(point, _)| {
        point.reduced_frequency_hz
    });
    if found.has_frequencies() {
        table = table
            .number(format!("{symbol}'"), unit, |(point, _)| {
                swept(point, point.modulus.re / pascal)
            })
            .number(format!("{symbol}''"), unit, |(point, _)| {
                swept(point, point.modulus.im / pascal)
            })
            .number("loss factor", "", |(point, _)| {
                swept(point, point.modulus.im / point.modulus.re)
            });
    }
    let of_series = |prime: &str| format!("{symbol}{prime} of the series");
    table = table
        .number(of_series("'"), unit, |(_, series)| {
            series.modulus.re / pascal
        })
        .number(of_series("''"), unit, |(_, series)| {
            series.modulus.im / pascal
        });
    for (part, prime) in ["'", "''"].into_iter().enumerate() {
        let name = format!("standard error of {}", of_series(prime));
        table = table.number(name, unit, |(_, series)| error(series.covariance, part));
    }
    if found.has_frequencies() {
        let residual = |prime: &str| format!("residual of {symbol}{prime} by |{symbol}|");
        table = table
            .number(residual("'"), "%", |(point, series)| {
                swept(point, left(point, series.modulus).re)
            })
            .number(residual("''"), "%", |(point, series)| {
                swept(point, left(point, series.modulus).im)
            });
    }
    Ok(table.table)
}

fn shifts(sweep: &Sweep) -> Table {
    let log = |value: f64| value / LN_10;
    let words = |shift: &Shift| {
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
    let by_overlap = "log10 of the shift from the colder one, by overlap";
    Rows::of(&sweep.curve.shifts, "shifts", "Shifts of the temperatures")
        .number("temperature", "degC", |shift| to_celsius(shift.temperature))
        .number("log10 of the shift", "", |shift| log(shift.log_shift))
        .number("standard error", "", |shift| log(shift.standard_error))
        .number("part due to the choice of the order", "", |shift| {
            log(shift.order_error)
        })
        .number("lower end", "", |shift| log(shift.interval.lower))
        .number("upper end", "", |shift| log(shift.interval.upper))
        .number(by_overlap, "", |shift| shift.overlap.map_or(f64::NAN, log))
        .number("factor of the modulus", "", |shift| shift.vertical)
        .number("relative standard error of the factor", "", |shift| {
            shift.vertical_standard_error
        })
        .word("verdict", words)
        .table
}

fn shift_laws(own: &ShiftLaws, by_scatter: Option<&ShiftLaws>) -> Table {
    let all: Vec<(&str, &ShiftLaws)> = std::iter::once(("errors of the shifts", own))
        .chain(by_scatter.map(|laws| ("equal, by the scatter", laws)))
        .collect();
    // every pair of laws has two rows
    let both = |wlf: &dyn Fn(&ShiftLaws) -> f64, arrhenius: &dyn Fn(&ShiftLaws) -> f64| {
        let pairs = all.iter().map(|(_, laws)| [wlf(laws), arrhenius(laws)]);
        pairs.flatten().collect::<Vec<f64>>()
    };
    let none = |_: &ShiftLaws| f64::NAN;
    let wlf = |value: fn(&Wlf) -> f64| both(&|laws| value(&laws.wlf), &none);
    let arrhenius = |value: fn(&Arrhenius) -> f64| both(&none, &|laws| value(&laws.arrhenius));
    let names = all.iter().flat_map(|_| ["WLF", "Arrhenius"]);
    let weights = all.iter().flat_map(|(errors, _)| [*errors, *errors]);
    Table::new("shift_laws", "Laws of the shifts")
        .words("law", names)
        .words("errors", weights)
        .numbers("C1", "", wlf(|law| law.c1))
        .numbers("standard error of C1", "", wlf(|law| law.c1_standard_error))
        .numbers("C2", "K", wlf(|law| law.c2))
        .numbers(
            "standard error of C2",
            "K",
            wlf(|law| law.c2_standard_error),
        )
        .numbers(
            "activation energy",
            "kJ/mol",
            arrhenius(|law| 1e-3 * law.activation_energy),
        )
        .numbers(
            "standard error of the activation energy",
            "kJ/mol",
            arrhenius(|law| 1e-3 * law.standard_error),
        )
        .numbers(
            "chi-square",
            "",
            both(&|laws| laws.wlf.chi_squared, &|laws| {
                laws.arrhenius.chi_squared
            }),
        )
        .numbers(
            "degrees of freedom",
            "",
            both(&|laws| laws.wlf.degrees_of_freedom as f64, &|laws| {
                laws.arrhenius.degrees_of_freedom as f64
            }),
        )
        .numbers(
            "probability",
            "",
            both(&ShiftLaws::wlf_p_value, &|laws| laws.arrhenius_p_value),
        )
        .numbers("lower end of C1", "", wlf(|law| law.c1_interval.lower))
        .numbers("upper end of C1", "", wlf(|law| law.c1_interval.upper))
        .numbers("lower end of C2", "K", wlf(|law| law.c2_interval.lower))
        .numbers("upper end of C2", "K", wlf(|law| law.c2_interval.upper))
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
    Rows::of(&all, "parameters", "Parameters of the laws")
        .word("law", |(law, _)| law.to_string())
        .word("parameter", |(_, own)| &own.name)
        .word("unit", |(_, own)| own.unit)
        .number("value", "", |(_, own)| own.value)
        .number("standard error", "", |(_, own)| {
            of_value(own, own.standard_error).unwrap_or(f64::NAN)
        })
        .number("lower end", "", |(_, own)| own.interval.lower)
        .number("upper end", "", |(_, own)| own.interval.upper)
        .word("verdict", |(_, own)| own.verdict.to_string())
        .table
}

/// Returns the table of the Prony series of the master curve.
fn series(sweep: &Sweep) -> Option<Table> {
    let fit = &sweep.curve.fit;
    let count = 2 * sweep.curve.series()?.branches().len()
        + usize::from(sweep.curve.series()?.equilibrium_modulus() > 0.0);
    let parameters = fit.parameters.get(..count).unwrap_or(&fit.parameters);
    let rows = Rows::of(parameters, "series", "Prony series of the master curve")
        .word("parameter", |own| &own.name)
        .word("unit", |own| own.unit)
        .number("value", "", |own| own.value)
        .number("standard error", "", |own| {
            of_value(own, own.standard_error).unwrap_or(f64::NAN)
        })
        .word("verdict", |own| {
            if own.verdict.is_identified() {
                "identified"
            } else {
                "not identified by itself"
            }
        });
    Some(rows.table)
}
