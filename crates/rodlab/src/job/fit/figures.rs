//! Figures of the result.

use std::f64::consts::{LN_10, TAU};

use cmod::CmodError;
use cmod::rheology::{ErrorScale, MasterCurve, MasterPoint, PredictedModulus};
use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::columns::Row;
use super::nomogram::nomogram;
use super::steps::{Step, to_celsius};
use super::{Found, Sweep};
use crate::{InStep, RodlabError};

/// Number of points of a curve.
const POINTS: u32 = 161;
/// Largest number of temperatures for which the legend names all of them.
const MOST_NAMED: usize = 5;

pub(super) fn figures(found: &Found<'_>) -> Result<Vec<Figure>, RodlabError> {
    let mut figures = Vec::new();
    if let Some(sweep) = &found.sweep {
        let series = series_over(&sweep.curve).in_step("figures of the master curve")?;
        figures.push(master_curve(found, sweep, &series));
        if found.has_frequencies() {
            figures.push(nomogram(found, &sweep.curve, &series));
        }
        figures.push(shifts(sweep));
    }
    figures.extend(measured(found));
    Ok(figures)
}

/// Figures of the moduli as measured, and the Black diagram of the moduli over frequency.
pub(super) fn measured(found: &Found<'_>) -> Vec<Figure> {
    let mut figures = Vec::new();
    if found.has_times() {
        figures.push(over_time(found));
    }
    if found.has_frequencies() {
        figures.extend([moduli(found), black_diagram(found)]);
    }
    figures
}

/// Returns the rows of a step over time or, if `over_time` is false, over frequency.
fn rows(step: &Step, over_time: bool) -> impl Iterator<Item = &Row> {
    let rows = step.rows.iter();
    rows.filter(move |row| row.over_time.is_some() == over_time)
}

/// Figure of the moduli over time as measured.
fn over_time(found: &Found<'_>) -> Figure {
    let (unit, pascal) = found.pascal;
    let of_step = |(index, step): (usize, &Step)| {
        let point = |row: &Row| {
            let error = if found.error_scale == ErrorScale::Stated {
                row.covariance.real.sqrt()
            } else {
                0.0
            };
            Some((row.time()?, row.modulus.re / pascal, error / pascal))
        };
        let points = rows(step, true).filter_map(point);
        Mark::points_with_errors(name(found, index), role_of(found, index), points)
    };
    let marks = found.steps.iter().enumerate().map(of_step).collect();
    let modulus = Axis::logarithmic(format!("{} over time", found.symbol()), unit);
    let panel = Panel::new(Axis::logarithmic("time", "s"), modulus, marks);
    Figure::new("over_time", "Moduli over time as measured", vec![panel]).with_caption(
        "As given in the tables: E(t) of relaxation, 1/J(t) of creep, from the start of the load.",
    )
}

/// Returns the name of a step in the legend. If there are more than [`MOST_NAMED`] steps, only the
/// first, the middle and the last have a name.
fn name(found: &Found<'_>, index: usize) -> String {
    let count = found.steps.len();
    let is_named = count <= MOST_NAMED || [0, count / 2, count - 1].contains(&index);
    let step = found.steps.get(index).filter(|_| is_named);
    step.map_or_else(String::new, Step::in_words)
}

/// Returns the role of a step. If there are more than [`MOST_NAMED`] steps, neighbouring steps
/// share a role, and the named steps have different roles.
fn role_of(found: &Found<'_>, index: usize) -> Role {
    let count = found.steps.len();
    Role::of_series(if count <= MOST_NAMED {
        index
    } else {
        index * MOST_NAMED / count
    })
}

fn moduli(found: &Found<'_>) -> Figure {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let marks = |of: fn(Complex64) -> f64, error: fn(&Row) -> f64| {
        let mut marks = Vec::new();
        for (index, step) in found.steps.iter().enumerate() {
            let rows = || rows(step, false);
            let x: Vec<f64> = rows().map(|row| row.frequency_hz).collect();
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
                let y = x.iter().map(at).collect();
                marks.push(Mark::curve("", role_of(found, index), &x, y));
            }
            let errors = if found.error_scale == ErrorScale::Stated {
                rows().map(|row| error(row) / pascal).collect()
            } else {
                Vec::new()
            };
            marks.push(Mark::Points {
                name: name(found, index),
                role: role_of(found, index),
                x,
                y: rows().map(|row| of(row.modulus) / pascal).collect(),
                error: errors,
            });
        }
        marks
    };
    let panel = |part: &str, marks| {
        let modulus = Axis::logarithmic(format!("{symbol}{part}"), unit);
        Panel::new(Axis::logarithmic("frequency", "Hz"), modulus, marks)
    };
    let storage = marks(|modulus| modulus.re, |row| row.covariance.real.sqrt());
    let loss = marks(|modulus| modulus.im, |row| row.covariance.imaginary.sqrt());
    let panels = vec![panel("'", storage), panel("''", loss)];
    Figure::new("moduli", "Moduli as measured", panels).with_caption(if found.sweep.is_some() {
        "Lines: the series of the master curve, shifted to each temperature."
    } else {
        "As given in the tables."
    })
}

/// Diagrams without frequency: loss angle over |E|, loss factor over E', and E'' over E'. The
/// temperatures of a master curve coincide in them if no factors of the modulus are needed.
fn black_diagram(found: &Found<'_>) -> Figure {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let panel = |x: Axis, y: Axis, of: &dyn Fn(Complex64) -> (f64, f64)| {
        let of_step = |(index, step): (usize, &Step)| {
            let points = rows(step, false).map(|row| of(row.modulus));
            Mark::points(name(found, index), role_of(found, index), points)
        };
        let marks = found.steps.iter().enumerate().map(of_step);
        Panel::new(x, y, marks.collect())
    };
    let storage = || Axis::logarithmic(format!("{symbol}'"), unit);
    let panels = vec![
        panel(
            Axis::logarithmic(format!("|{symbol}|"), unit),
            Axis::linear("loss angle", "deg"),
            &|modulus| (modulus.norm() / pascal, modulus.arg().to_degrees()),
        ),
        panel(
            storage(),
            Axis::logarithmic("loss factor", ""),
            &|modulus| (modulus.re / pascal, modulus.im / modulus.re),
        ),
        panel(
            Axis::linear(format!("{symbol}'"), unit),
            Axis::linear(format!("{symbol}''"), unit),
            &|modulus| (modulus.re / pascal, modulus.im / pascal),
        ),
    ];
    Figure::new(
        "black_diagram",
        "Black diagram, wicket plot and Cole-Cole plot",
        panels,
    )
    .with_caption(format!(
        "Loss angle against |{symbol}| (Black), loss factor against {symbol}' (wicket) and {symbol}'' against {symbol}' (Cole and Cole). A shift in \
         frequency does not move a point in these plots: if the points of all temperatures do not fall on one curve, shifts in frequency alone cannot join them."
    ))
}

/// Returns the Prony series of a master curve at reduced frequencies \[Hz\] in the range of its
/// points.
fn series_over(curve: &MasterCurve) -> Result<Vec<(f64, PredictedModulus)>, CmodError> {
    let reduced = curve.points.iter().map(|point| point.reduced_frequency_hz);
    let lowest = reduced.clone().fold(f64::INFINITY, f64::min);
    let highest = reduced.fold(0.0, f64::max);
    let at = |i| lowest * (highest / lowest).powf(f64::from(i) / f64::from(POINTS - 1));
    let predicted = |f: f64| Ok((f, curve.fit.prediction(TAU * f)?));
    (0..POINTS).map(at).map(predicted).collect()
}

fn master_curve(found: &Found<'_>, sweep: &Sweep, series: &[(f64, PredictedModulus)]) -> Figure {
    let (unit, pascal) = found.pascal;
    let symbol = found.symbol();
    let curve = &sweep.curve;
    let marks = |of: fn(Complex64) -> f64, error: fn(&PredictedModulus) -> f64, scale: f64| {
        let side = |point: &PredictedModulus, sign: f64| {
            (of(point.modulus) + 2.0 * sign * error(point)) / scale
        };
        let edges = series
            .iter()
            .map(|(x, point)| (*x, side(point, -1.0), side(point, 1.0)));
        let series = series.iter().map(|(x, point)| (*x, side(point, 0.0)));
        let (band, role) = ("two standard errors of the series", Role::Reference);
        let mut marks = vec![
            Mark::band(band, role, edges),
            Mark::line("series", role, series),
        ];
        for (index, step) in found.steps.iter().enumerate() {
            let points = curve
                .points
                .iter()
                .filter(|point| {
                    point.reduced_time.is_none()
                        && point.temperature.total_cmp(&step.temperature).is_eq()
                })
                .map(|point| (point.reduced_frequency_hz, of(point.modulus) / scale));
            let (name, role) = (name(found, index), role_of(found, index));
            let mut points = points.peekable();
            if points.peek().is_some() {
                marks.push(Mark::points(name, role, points));
            }
        }
        marks
    };
    let panel = |label: &str, unit: &str, marks| {
        let frequency = Axis::logarithmic("reduced frequency", "Hz");
        Panel::new(frequency, Axis::logarithmic(label, unit), marks)
    };
    let storage = marks(
        |modulus| modulus.re,
        |point| point.covariance[0][0].sqrt(),
        pascal,
    );
    let loss = marks(
        |modulus| modulus.im,
        |point| point.covariance[1][1].sqrt(),
        pascal,
    );
    let factor = marks(
        |modulus| modulus.im / modulus.re,
        |point| point.loss_factor().1,
        1.0,
    );
    let mut panels = Vec::new();
    if found.has_times() {
        let marks = found.steps.iter().enumerate().flat_map(|(index, step)| {
            let own = || {
                let points = curve.points.iter();
                points.filter(|point| point.temperature.total_cmp(&step.temperature).is_eq())
            };
            let values = |of: fn(&MasterPoint) -> f64| {
                let points =
                    own().filter_map(|point| Some((point.reduced_time?, of(point) / pascal)));
                points.collect::<Vec<(f64, f64)>>()
            };
            let role = role_of(found, index);
            let measured = values(|point| point.modulus.re);
            [
                Mark::points(name(found, index), role, measured),
                Mark::line("", role, values(|point| point.fitted.re)),
            ]
        });
        let modulus = Axis::logarithmic(format!("{symbol} over time"), unit);
        let time = Axis::logarithmic("reduced time", "s");
        panels.push(Panel::new(time, modulus, marks.collect()));
    }
    panels.extend([
        panel(&format!("{symbol}'"), unit, storage),
        panel(&format!("{symbol}''"), unit, loss),
        panel("loss factor", "", factor),
    ]);
    let reference = super::steps::celsius(curve.reference_temperature);
    let caption = if found.has_times() {
        "Rows of all temperatures at their reduced times, each temperature with the series for its own ramp, and over frequency the \
         prediction of the series."
    } else {
        "Lines of all temperatures at their reduced frequencies, with the series that is fitted to all together."
    };
    let title = format!("Master curve at {reference}");
    Figure::new("master_curve", title, panels).with_caption(caption)
}

fn shifts(sweep: &Sweep) -> Figure {
    let all = &sweep.curve.shifts;
    let celsius: Vec<f64> = all
        .iter()
        .map(|shift| to_celsius(shift.temperature))
        .collect();
    let temperature = ("temperature", "degC");
    let fitted = all.iter().zip(&celsius);
    let fitted = fitted.map(|(s, at)| (*at, s.log_shift / LN_10, s.standard_error / LN_10));
    let mut marks = vec![Mark::points_with_errors("fitted", Role::First, fitted)];
    let laws = sweep.by_scatter.as_ref().or(sweep.shift_laws.as_ref().ok());
    if let (Some(laws), Some(first), Some(last)) = (laws, all.first(), all.last()) {
        let kelvin: Vec<f64> = (0..POINTS)
            .map(|i| {
                let share = f64::from(i) / f64::from(POINTS - 1);
                first.temperature + share * (last.temperature - first.temperature)
            })
            .collect();
        let line = |name: &str, role: Role, of: &dyn Fn(f64) -> Option<(f64, f64)>| {
            let log = |t: f64| of(t).map_or(f64::NAN, |(log, _)| log / LN_10);
            Mark::line(name, role, kelvin.iter().map(|t| (to_celsius(*t), log(*t))))
        };
        marks.push(line("WLF", Role::Second, &|t| laws.wlf.log_shift(t)));
        marks.push(line("Arrhenius", Role::Third, &|t| {
            laws.arrhenius.log_shift(t)
        }));
    }
    let mut panels = vec![Panel::new(temperature, ("log10 of the shift", ""), marks)];
    if all.iter().any(|shift| (shift.vertical - 1.0).abs() > 1e-12) {
        let factors = all.iter().zip(&celsius);
        let factors =
            factors.map(|(s, at)| (*at, s.vertical, s.vertical * s.vertical_standard_error));
        let marks = vec![Mark::points_with_errors("", Role::First, factors)];
        panels.push(Panel::new(
            temperature,
            ("factor of the modulus", ""),
            marks,
        ));
    }
    Figure::new("shifts", "Shifts over temperature", panels).with_caption(
        "Points with one standard error, and the laws fitted to those that are identified.",
    )
}
