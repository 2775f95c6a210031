//! Figures of a modulus: modulus and loss factor with their bands, Cole-Cole plot, dispersion,
//! number of half waves, coherence.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use cmod::ModulusLine;
use cmod::estimate::{Budget, BudgetedQuantity, ErrorSource, PlottedQuantity};
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::Found;
use super::lines::sources_of;
use super::reasons::Reasons;
use super::statement::unit_of;

/// Half width of a band, in standard errors.
const BAND: f64 = 2.0;
/// Maximum number of lines of a curve.
const MOST_LINES: usize = 1500;
/// Smallest width of a shaded range, as a fraction of the band.
const LEAST_WIDTH: f64 = 0.004;
/// Margin above and below the valid values, as a fraction of their range.
const MARGIN: f64 = 0.15;

/// Smallest share of an error source that is drawn, in % of the square of the uncertainty.
const LEAST_SHARE: f64 = 2.0;

/// Label and unit of the axis of frequency.
const KILOHERTZ: (&str, &str) = ("frequency", "kHz");

/// Curve over frequency: quantity, factor from SI to the unit of the axis, label and unit.
type Drawn = (PlottedQuantity, f64, &'static str, &'static str);

/// Returns the figures of the result, beginning with modulus and loss factor.
pub(super) fn figures(found: &Found<'_>, reasons: &Reasons) -> Vec<Figure> {
    let lines: Vec<&ModulusLine> = found.estimate.lines().iter().collect();
    if lines.is_empty() {
        return coherence(found).into_iter().collect();
    }
    let mut figures = Vec::new();
    let shown = shown(&lines);
    let greyed = greyed(&lines, reasons);
    let stride = lines.len().div_ceil(MOST_LINES);
    let every = if stride > 1 {
        format!(" One line in {stride} is drawn; the table contains all.")
    } else {
        String::new()
    };
    let giga = giga(&lines);
    let over_frequency = |drawn: &[Drawn]| -> Vec<Panel> {
        drawn
            .iter()
            .map(|drawn| panel(&shown, &greyed, drawn))
            .collect()
    };
    let title = "Storage modulus, loss modulus and loss factor";
    let panels = over_frequency(&[
        (PlottedQuantity::StorageModulus, giga.0, "E'", giga.1),
        (PlottedQuantity::LossModulus, giga.0, "E''", giga.1),
        (PlottedQuantity::LossFactor, 1.0, "loss factor", ""),
    ]);
    figures.push(Figure::new("modulus", title, panels).with_caption(format!(
        "Valid lines with bands of two standard errors; lines that are not valid are faint, on grey where there are many.{every}"
    )));
    let title = "Phase velocity and damping coefficient";
    let (damping, label) = (PlottedQuantity::DampingCoefficient, "damping coefficient");
    let panels = over_frequency(&[
        (PlottedQuantity::PhaseVelocity, 1.0, "phase velocity", "m/s"),
        (damping, 1.0, label, "1/m"),
    ]);
    figures.push(
        Figure::new("dispersion", title, panels).with_caption(format!(
            "Valid lines with bands of two standard errors.{every}"
        )),
    );
    figures.push(cole_cole(&shown, giga));
    figures.push(waves(found, &shown, &greyed));
    figures.extend(budget(&shown, &greyed));
    figures.extend(coherence(found));
    figures
}

/// Figure of the shares of the error sources in the square of the standard uncertainty; `None` if
/// noise is the only source.
fn budget(lines: &[&ModulusLine], greyed: &[Greyed]) -> Option<Figure> {
    let sources = sources_of(lines.iter().copied());
    if sources.is_empty() {
        return None;
    }
    let x: Vec<f64> = lines.iter().map(|line| 1e-3 * line.frequency_hz).collect();
    let curves = |quantity: BudgetedQuantity| -> Vec<(String, Vec<f64>)> {
        let budgets: Vec<Budget> = lines.iter().map(|line| line.budget(quantity)).collect();
        let shares = |of: &dyn Fn(&Budget) -> f64| -> Vec<f64> {
            let share = |(budget, line): (&Budget, &&ModulusLine)| {
                let part = of(budget) / budget.standard_uncertainty();
                let is_valid = line.validity.is_valid();
                if is_valid {
                    100.0 * part * part
                } else {
                    f64::NAN
                }
            };
            budgets.iter().zip(lines).map(share).collect()
        };
        let of_source = |source: ErrorSource| {
            move |budget: &Budget| {
                let own = budget.sources().iter().find(|(other, _)| *other == source);
                own.map_or(0.0, |(_, error)| *error)
            }
        };
        let named = sources
            .iter()
            .map(|source| (source.to_string(), shares(&of_source(*source))));
        let random = ("random".to_owned(), shares(&Budget::random));
        std::iter::once(random)
            .chain(named)
            .filter(|(_, values)| values.iter().any(|share| *share > LEAST_SHARE))
            .collect()
    };
    // a source has one role in both panels, and no other source has it
    let mut drawn: Vec<String> = Vec::new();
    let mut role = |name: &str| {
        let known = drawn.iter().position(|other| other == name);
        let index = known.unwrap_or(drawn.len());
        if known.is_none() {
            drawn.push(name.to_owned());
        }
        match index {
            5 => Role::Reference,
            6 => Role::Faint,
            _ => Role::of_series(index),
        }
    };
    let mut panel = |quantity: BudgetedQuantity, label: &str| {
        let marks = curves(quantity).into_iter().map(|(name, values)| {
            let role = role(&name);
            Mark::curve(name, role, &x, values)
        });
        Panel::new(KILOHERTZ, (label, "%"), marks.collect()).with_greyed(greyed.to_vec())
    };
    let panels = vec![
        panel(BudgetedQuantity::StorageModulus, "share in E'"),
        panel(BudgetedQuantity::LossFactor, "share in the loss factor"),
    ];
    Some(Figure::new("budget", "Contributions to the uncertainty", panels).with_caption(format!(
        "Shares in the square of the standard uncertainty on valid lines, for sources that contribute more than {LEAST_SHARE} % anywhere."
    )))
}

/// Returns up to [`MOST_LINES`] evenly distributed lines.
fn shown<'a>(lines: &[&'a ModulusLine]) -> Vec<&'a ModulusLine> {
    let stride = lines.len().div_ceil(MOST_LINES).max(1);
    lines.iter().step_by(stride).copied().collect()
}

/// Returns factor and unit of a modulus.
fn giga(lines: &[&ModulusLine]) -> (f64, &'static str) {
    let valid = lines.iter().filter(|line| line.validity.is_valid());
    unit_of(valid.map(|line| line.modulus.re).fold(0.0, f64::max))
}

/// Returns frequency \[kHz\] and `value` of each line. The value is NaN for invalid lines if
/// `valid` is true, and for valid lines if it is false.
fn picked(
    lines: &[&ModulusLine],
    valid: bool,
    value: impl Fn(&ModulusLine) -> f64,
) -> Vec<(f64, f64)> {
    let point = |line: &&ModulusLine| {
        let is_picked = line.validity.is_valid() == valid;
        let value = if is_picked { value(line) } else { f64::NAN };
        (1e-3 * line.frequency_hz, value)
    };
    lines.iter().map(point).collect()
}

fn panel(lines: &[&ModulusLine], greyed: &[Greyed], drawn: &Drawn) -> Panel {
    let (quantity, factor, label, unit) = *drawn;
    let pick = |valid: bool, errors: f64| {
        picked(lines, valid, |line| {
            let (value, error) = quantity.of(line);
            factor * (value + errors * error)
        })
    };
    let values = |valid: bool| picked(lines, valid, |line| factor * quantity.of(line).0);
    let edges = pick(true, -BAND).into_iter().zip(pick(true, BAND));
    let edges: Vec<(f64, f64, f64)> = edges
        .map(|((x, lower), (_, upper))| (x, lower, upper))
        .collect();
    let mut axis = Axis::linear(label, unit);
    if let Some(range) = range(&edges) {
        axis = axis.within(range);
    }
    let marks = vec![
        Mark::points("not valid", Role::Faint, values(false)),
        Mark::band("two standard errors", Role::First, edges),
        Mark::line("valid", Role::First, values(true)),
    ];
    Panel::new(KILOHERTZ, axis, marks).with_greyed(greyed.to_vec())
}

/// Returns the range of the valid lines with a margin; values of invalid lines may be far outside
/// this range.
fn range(edges: &[(f64, f64, f64)]) -> Option<[f64; 2]> {
    let lower = edges.iter().map(|edge| edge.1).filter(|y| y.is_finite());
    let upper = edges.iter().map(|edge| edge.2).filter(|y| y.is_finite());
    let least = lower.fold(f64::INFINITY, f64::min);
    let greatest = upper.fold(f64::NEG_INFINITY, f64::max);
    let width = greatest - least;
    (width.is_finite() && width > 0.0)
        .then_some([least - MARGIN * width, greatest + MARGIN * width])
}

/// Returns the frequency ranges of invalid lines, each with the most frequent reason of its lines.
fn greyed(lines: &[&ModulusLine], reasons: &Reasons) -> Vec<Greyed> {
    let (Some(first), Some(last)) = (lines.first(), lines.last()) else {
        return Vec::new();
    };
    let least = LEAST_WIDTH * (last.frequency_hz - first.frequency_hz);
    let mut greyed = Vec::new();
    let mut end = 0;
    for run in lines.chunk_by(|a, b| a.validity.is_valid() == b.validity.is_valid()) {
        let start = end;
        end += run.len();
        let (Some(first), Some(last)) = (run.first(), run.last()) else {
            continue;
        };
        // a range ends halfway to the neighbouring valid line
        let edge = |inside: &ModulusLine, outside: Option<usize>| {
            let beyond = outside.and_then(|index| lines.get(index));
            let f = inside.frequency_hz;
            beyond.map_or(f, |line| 0.5 * (f + line.frequency_hz))
        };
        let (from, to) = (edge(first, start.checked_sub(1)), edge(last, Some(end)));
        if !first.validity.is_valid() && to - from > least {
            greyed.push(Greyed {
                from: 1e-3 * from,
                to: 1e-3 * to,
                because: commonest(reasons.of_line.get(start..end).unwrap_or_default()),
            });
        }
    }
    greyed
}

fn commonest(of_lines: &[Vec<&'static str>]) -> String {
    let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
    for reason in of_lines.iter().flatten() {
        *counts.entry(reason).or_default() += 1;
    }
    // of several reasons with the same count, the first in alphabetical order is used
    let most = counts.into_iter().rev().max_by_key(|(_, count)| *count);
    most.map_or_else(String::new, |(reason, _)| reason.to_owned())
}

fn cole_cole(lines: &[&ModulusLine], (giga, unit): (f64, &'static str)) -> Figure {
    let valid = lines.iter().filter(|line| line.validity.is_valid());
    let points = valid.map(|line| (giga * line.modulus.re, giga * line.modulus.im));
    let marks = vec![Mark::points("valid lines", Role::First, points)];
    let panel = Panel::new(("E'", unit), ("E''", unit), marks);
    Figure::new("cole_cole", "Loss modulus over storage modulus", vec![panel]).with_caption(
        "The Cole-Cole plot of the valid lines: a single relaxation time gives a semicircle, a distribution of relaxation times a flatter arc; a narrow band shows only a part of the curve.",
    )
}

/// Figure of the number of half waves between the sections; a curve that is not smooth indicates a
/// wrong count.
fn waves(found: &Found<'_>, lines: &[&ModulusLine], greyed: &[Greyed]) -> Figure {
    let half_waves = |line: &ModulusLine| line.wave_number() * found.distance / PI;
    let mut marks = Vec::new();
    let closed = lines.iter().map(|line| {
        let root = line.closed_form.as_ref();
        let half_waves = root.map_or(f64::NAN, |root| root.gamma_length.im / PI);
        (1e-3 * line.frequency_hz, half_waves)
    });
    if closed.clone().any(|(_, value)| value.is_finite()) {
        marks.push(Mark::line(
            "closed form used as start",
            Role::Reference,
            closed,
        ));
    }
    let not_valid = picked(lines, false, half_waves);
    marks.push(Mark::points("not valid", Role::Faint, not_valid));
    marks.push(Mark::line(
        "valid",
        Role::First,
        picked(lines, true, half_waves),
    ));
    let panel = Panel::new(KILOHERTZ, ("half waves", ""), marks).with_greyed(greyed.to_vec());
    Figure::new("waves", "Half waves between the sections", vec![panel]).with_caption(
        "The wave number times the distance over which waves are counted, divided by π. It starts at 0 and grows smoothly; a jump \
         means a wave too many or too few.",
    )
}

/// Figure of the measured ratio and its coherence.
fn coherence(found: &Found<'_>) -> Option<Figure> {
    let ratio = found.ratio()?;
    let stride = ratio.frequency_hz.len().div_ceil(MOST_LINES).max(1);
    let kilohertz = ratio.frequency_hz.iter().map(|f| 1e-3 * f);
    let magnitude = ratio.values.iter().map(|value| value.norm());
    let error = ratio.variance.iter().map(|v| (0.5 * v).sqrt());
    let lines = kilohertz.clone().zip(magnitude.clone()).zip(error);
    let edges = lines.map(|((x, m), e)| (x, m - BAND * e, m + BAND * e));
    let magnitudes = kilohertz.clone().zip(magnitude).step_by(stride);
    let marks = vec![
        Mark::band("two standard errors", Role::First, edges.step_by(stride)),
        Mark::line("", Role::First, magnitudes),
    ];
    let axis = Axis::logarithmic("magnitude of the ratio", "");
    let mut panels = vec![Panel::new(KILOHERTZ, axis, marks)];
    if let Some(coherence) = &ratio.coherence {
        let least = coherence
            .iter()
            .filter(|value| value.is_finite())
            .fold(0.99_f64, |least, value| least.min(*value));
        let room = 0.05 * (1.0 - least);
        let axis = Axis::linear("coherence", "").within([least - room, 1.0 + room]);
        let values = kilohertz.zip(coherence.iter().copied()).step_by(stride);
        let marks = vec![Mark::line("", Role::First, values)];
        panels.push(Panel::new(KILOHERTZ, axis, marks));
    }
    Some(
        Figure::new("ratio", "Ratio of spectra and its coherence", panels)
            .with_caption("The data from which the modulus is determined."),
    )
}
