//! Figures of the result.

use std::f64::consts::{LN_10, TAU};

use cmod::CmodError;
use cmod::rheology::{ErrorScale, PredictedModulus};
use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::steps::{Step, to_celsius};
use super::{Found, Sweep};
use crate::RodlabError;

/// Points of a curve.
const POINTS: u32 = 161;
/// Most temperatures that are all named in the legend.
const MOST_NAMED: usize = 8;

pub(super) fn figures(found: &Found<'_>) -> Result<Vec<Figure>, RodlabError> {
    let mut figures = Vec::new();
    if let Some(sweep) = &found.sweep {
        let refused = |error| RodlabError::step("figures of the master curve", error);
        figures.push(master_curve(found, sweep).map_err(refused)?);
        figures.push(shifts(sweep));
    }
    figures.extend(measured(found));
    Ok(figures)
}

/// Moduli as measured, and the Black diagram.
pub(super) fn measured(found: &Found<'_>) -> [Figure; 2] {
    [moduli(found), black_diagram(found)]
}

fn panel(x: Axis, y: Axis, marks: Vec<Mark>) -> Panel {
    Panel {
        x,
        y,
        marks,
        greyed: Vec::new(),
        equal_axes: false,
    }
}

/// Name of a step in the legend: of many, the first, the middle and the last are named.
fn name(found: &Found<'_>, index: usize) -> String {
    let count = found.steps.len();
    let is_named = count <= MOST_NAMED || [0, count / 2, count - 1].contains(&index);
    let step = found.steps.get(index).filter(|_| is_named);
    step.map_or_else(String::new, Step::in_words)
}

fn moduli(found: &Found<'_>) -> Figure {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let marks = |of: fn(Complex64) -> f64, error: fn(&super::columns::Row) -> f64| {
        let mut marks = Vec::new();
        for (index, step) in found.steps.iter().enumerate() {
            let x: Vec<f64> = step.rows.iter().map(|row| row.frequency_hz).collect();
            let shift = found.sweep.as_ref().and_then(|sweep| {
                let mut shifts = sweep.curve.shifts.iter();
                Some((
                    sweep,
                    shifts.find(|s| s.temperature.total_cmp(&step.temperature).is_eq())?,
                ))
            });
            if let Some((sweep, shift)) = shift {
                let at = |f: &f64| {
                    let law = &sweep.curve.fit.law;
                    of(shift.vertical * law.modulus(TAU * f * shift.log_shift.exp())) / pascal
                };
                marks.push(Mark::Line {
                    name: String::new(),
                    role: Role::of_series(index),
                    y: x.iter().map(at).collect(),
                    x: x.clone(),
                });
            }
            let errors = if found.error_scale == ErrorScale::Stated {
                step.rows.iter().map(|row| error(row) / pascal).collect()
            } else {
                Vec::new()
            };
            marks.push(Mark::Points {
                name: name(found, index),
                role: Role::of_series(index),
                x,
                y: step
                    .rows
                    .iter()
                    .map(|row| of(row.modulus) / pascal)
                    .collect(),
                error: errors,
            });
        }
        marks
    };
    let frequency = || Axis::logarithmic("frequency", "Hz");
    Figure {
        name: "moduli".to_owned(),
        title: "Moduli as measured".to_owned(),
        caption: if found.sweep.is_some() {
            "Lines: the series of the master curve at the shift of each temperature.".to_owned()
        } else {
            "As they stand in the tables.".to_owned()
        },
        panels: vec![
            panel(
                frequency(),
                Axis::logarithmic(format!("{symbol}'"), unit),
                marks(|modulus| modulus.re, |row| row.covariance.real.sqrt()),
            ),
            panel(
                frequency(),
                Axis::logarithmic(format!("{symbol}''"), unit),
                marks(|modulus| modulus.im, |row| row.covariance.imaginary.sqrt()),
            ),
        ],
    }
}

/// Loss angle over |E|, without frequency: temperatures of one curve lie on one line, as far as no
/// factor is needed.
fn black_diagram(found: &Found<'_>) -> Figure {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let of_step = |(index, step): (usize, &Step)| Mark::Points {
        name: name(found, index),
        role: Role::of_series(index),
        x: step
            .rows
            .iter()
            .map(|row| row.modulus.norm() / pascal)
            .collect(),
        y: step
            .rows
            .iter()
            .map(|row| row.modulus.arg().to_degrees())
            .collect(),
        error: Vec::new(),
    };
    Figure {
        name: "black_diagram".to_owned(),
        title: "Black diagram".to_owned(),
        caption: format!(
            "Loss angle over |{symbol}|: shifts in frequency do not move a point here. Temperatures that do not lie on one line make no \
             single curve by shifts in frequency alone."
        ),
        panels: vec![panel(
            Axis::logarithmic(format!("|{symbol}|"), unit),
            Axis::linear("loss angle", "deg"),
            found.steps.iter().enumerate().map(of_step).collect(),
        )],
    }
}

fn master_curve(found: &Found<'_>, sweep: &Sweep) -> Result<Figure, CmodError> {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let curve = &sweep.curve;
    let reduced = curve.points.iter().map(|point| point.reduced_frequency_hz);
    let lowest = reduced.clone().fold(f64::INFINITY, f64::min);
    let highest = reduced.fold(0.0, f64::max);
    let x: Vec<f64> = (0..POINTS)
        .map(|i| lowest * (highest / lowest).powf(f64::from(i) / f64::from(POINTS - 1)))
        .collect();
    let predicted = x
        .iter()
        .map(|f| curve.fit.prediction(TAU * f))
        .collect::<Result<Vec<PredictedModulus>, _>>()?;
    let marks = |of: fn(Complex64) -> f64, error: fn(&PredictedModulus) -> f64, scale: f64| {
        let side = |sign: f64| -> Vec<f64> {
            let at =
                |point: &PredictedModulus| (of(point.modulus) + 2.0 * sign * error(point)) / scale;
            predicted.iter().map(at).collect()
        };
        let mut marks = vec![
            Mark::Band {
                name: "two standard errors of the series".to_owned(),
                role: Role::Reference,
                x: x.clone(),
                lower: side(-1.0),
                upper: side(1.0),
            },
            Mark::Line {
                name: "series".to_owned(),
                role: Role::Reference,
                x: x.clone(),
                y: side(0.0),
            },
        ];
        for (index, step) in found.steps.iter().enumerate() {
            let points: Vec<_> = curve
                .points
                .iter()
                .filter(|point| point.temperature.total_cmp(&step.temperature).is_eq())
                .collect();
            marks.push(Mark::Points {
                name: name(found, index),
                role: Role::of_series(index),
                x: points
                    .iter()
                    .map(|point| point.reduced_frequency_hz)
                    .collect(),
                y: points
                    .iter()
                    .map(|point| of(point.modulus) / scale)
                    .collect(),
                error: Vec::new(),
            });
        }
        marks
    };
    let of_factor = |point: &PredictedModulus| {
        let [[storage, mixed], [_, loss]] = point.covariance;
        let tan = point.modulus.im / point.modulus.re;
        (tan * tan * storage - 2.0 * tan * mixed + loss)
            .max(0.0)
            .sqrt()
            / point.modulus.re
    };
    let frequency = || Axis::logarithmic("reduced frequency", "Hz");
    Ok(Figure {
        name: "master_curve".to_owned(),
        title: format!(
            "Master curve at {}",
            super::steps::celsius(curve.reference_temperature)
        ),
        caption: "Lines of all temperatures at their reduced frequencies, with the series that is fitted to all together.".to_owned(),
        panels: vec![
            panel(
                frequency(),
                Axis::logarithmic(format!("{symbol}'"), unit),
                marks(|modulus| modulus.re, |point| point.covariance[0][0].sqrt(), pascal),
            ),
            panel(
                frequency(),
                Axis::logarithmic(format!("{symbol}''"), unit),
                marks(|modulus| modulus.im, |point| point.covariance[1][1].sqrt(), pascal),
            ),
            panel(
                frequency(),
                Axis::logarithmic("loss factor", ""),
                marks(|modulus| modulus.im / modulus.re, of_factor, 1.0),
            ),
        ],
    })
}

fn shifts(sweep: &Sweep) -> Figure {
    let all = &sweep.curve.shifts;
    let celsius: Vec<f64> = all
        .iter()
        .map(|shift| to_celsius(shift.temperature))
        .collect();
    let temperature = || Axis::linear("temperature", "degC");
    let mut marks = vec![Mark::Points {
        name: "fitted".to_owned(),
        role: Role::First,
        x: celsius.clone(),
        y: all.iter().map(|shift| shift.log_shift / LN_10).collect(),
        error: all
            .iter()
            .map(|shift| shift.standard_error / LN_10)
            .collect(),
    }];
    let laws = sweep.by_scatter.as_ref().or(sweep.shift_laws.as_ref().ok());
    if let (Some(laws), Some(first), Some(last)) = (laws, all.first(), all.last()) {
        let kelvin: Vec<f64> = (0..POINTS)
            .map(|i| {
                let share = f64::from(i) / f64::from(POINTS - 1);
                first.temperature + share * (last.temperature - first.temperature)
            })
            .collect();
        let line = |name: &str, role: Role, of: &dyn Fn(f64) -> Option<(f64, f64)>| Mark::Line {
            name: name.to_owned(),
            role,
            x: kelvin.iter().map(|t| to_celsius(*t)).collect(),
            y: kelvin
                .iter()
                .map(|t| of(*t).map_or(f64::NAN, |(log, _)| log / LN_10))
                .collect(),
        };
        marks.push(line("WLF", Role::Second, &|t| laws.wlf.log_shift(t)));
        marks.push(line("Arrhenius", Role::Third, &|t| {
            laws.arrhenius.log_shift(t)
        }));
    }
    let mut panels = vec![panel(
        temperature(),
        Axis::linear("log10 of the shift", ""),
        marks,
    )];
    if all.iter().any(|shift| (shift.vertical - 1.0).abs() > 1e-12) {
        let points = Mark::Points {
            name: String::new(),
            role: Role::First,
            x: celsius,
            y: all.iter().map(|shift| shift.vertical).collect(),
            error: all
                .iter()
                .map(|shift| shift.vertical * shift.vertical_standard_error)
                .collect(),
        };
        panels.push(panel(
            temperature(),
            Axis::linear("factor of the modulus", ""),
            vec![points],
        ));
    }
    Figure {
        name: "shifts".to_owned(),
        title: "Shifts over temperature".to_owned(),
        caption:
            "Points with one standard error, and the laws fitted to those that are identified."
                .to_owned(),
        panels,
    }
}
