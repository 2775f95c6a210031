//! Modulus and loss factor with their bands, Cole-Cole plot, dispersion, counted waves, coherence.

use cmod::ModulusLine;
use cmod::estimate::PlottedQuantity;
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::Found;
use super::reasons::Reasons;

/// Half the width of a band, in standard errors.
const BAND: f64 = 2.0;
/// Most lines of a curve.
const MOST_LINES: usize = 1500;
/// Smallest width of a shaded range, as a fraction of the band.
const LEAST_WIDTH: f64 = 0.004;
/// Margin above and below the valid values, as a fraction of their range.
const MARGIN: f64 = 0.15;

/// A curve over frequency: quantity, factor from SI to the axis, label and unit.
type Drawn = (PlottedQuantity, f64, &'static str, &'static str);

pub(super) fn figures(found: &Found<'_>, reasons: &Reasons) -> Vec<Figure> {
    let mut figures = Vec::new();
    if let Some(figure) = coherence(found) {
        figures.push(figure);
    }
    let lines: Vec<&ModulusLine> = found.estimate.lines().iter().collect();
    if lines.is_empty() {
        return figures;
    }
    let shown = shown(&lines);
    let greyed = greyed(&lines, reasons);
    let stride = lines.len().div_ceil(MOST_LINES);
    let every = if stride > 1 {
        format!(" One line of {stride} is drawn; the table has all.")
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
    figures.push(Figure {
        name: "modulus".to_owned(),
        title: "Storage modulus, loss modulus and loss factor".to_owned(),
        caption: format!(
            "Valid lines with bands of two standard errors; lines that are not valid faintly, and grey where there are many.{every}"
        ),
        panels: over_frequency(&[
            (PlottedQuantity::StorageModulus, giga.0, "E'", giga.1),
            (PlottedQuantity::LossModulus, giga.0, "E''", giga.1),
            (PlottedQuantity::LossFactor, 1.0, "loss factor", ""),
        ]),
    });
    figures.push(cole_cole(&shown, giga));
    figures.push(Figure {
        name: "dispersion".to_owned(),
        title: "Phase velocity and damping coefficient".to_owned(),
        caption: format!("Valid lines with bands of two standard errors.{every}"),
        panels: over_frequency(&[
            (PlottedQuantity::PhaseVelocity, 1.0, "phase velocity", "m/s"),
            (
                PlottedQuantity::DampingCoefficient,
                1.0,
                "damping coefficient",
                "1/m",
            ),
        ]),
    });
    figures.push(waves(found, &shown, &greyed));
    figures
}

/// A selection of evenly distributed lines, as many as a figure can show.
fn shown<'a>(lines: &[&'a ModulusLine]) -> Vec<&'a ModulusLine> {
    let stride = lines.len().div_ceil(MOST_LINES).max(1);
    lines.iter().step_by(stride).copied().collect()
}

/// Factor and unit of a modulus.
fn giga(lines: &[&ModulusLine]) -> (f64, &'static str) {
    let valid = lines.iter().filter(|line| line.validity.is_valid());
    let largest = valid.map(|line| line.modulus.re).fold(0.0, f64::max);
    if largest >= 0.1e9 {
        (1e-9, "GPa")
    } else {
        (1e-6, "MPa")
    }
}

fn kilohertz() -> Axis {
    Axis::linear("frequency", "kHz")
}

fn panel(lines: &[&ModulusLine], greyed: &[Greyed], drawn: &Drawn) -> Panel {
    let (quantity, factor, label, unit) = *drawn;
    let x: Vec<f64> = lines.iter().map(|line| 1e-3 * line.frequency_hz).collect();
    let pick = |valid: bool, of: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        let value = |line: &&ModulusLine| {
            if line.validity.is_valid() == valid {
                let (value, error) = quantity.of(line);
                factor * of(value, error)
            } else {
                f64::NAN
            }
        };
        lines.iter().map(value).collect()
    };
    let lower = pick(true, &|value, error| value - BAND * error);
    let upper = pick(true, &|value, error| value + BAND * error);
    let mut axis = Axis::linear(label, unit);
    if let Some(range) = range(&lower, &upper) {
        axis = axis.within(range);
    }
    Panel {
        x: kilohertz(),
        y: axis,
        marks: vec![
            Mark::Points {
                name: "not valid".to_owned(),
                role: Role::Faint,
                x: x.clone(),
                y: pick(false, &|value, _| value),
                error: Vec::new(),
            },
            Mark::Band {
                name: "two standard errors".to_owned(),
                role: Role::First,
                x: x.clone(),
                lower,
                upper,
            },
            Mark::Line {
                name: "valid".to_owned(),
                role: Role::First,
                x,
                y: pick(true, &|value, _| value),
            },
        ],
        greyed: greyed.to_vec(),
        equal_axes: false,
    }
}

/// The range of the valid lines with a margin: lines that are not valid may lie anywhere.
fn range(lower: &[f64], upper: &[f64]) -> Option<[f64; 2]> {
    let finite = |values: &[f64], start: f64, pick: fn(f64, f64) -> f64| {
        let values = values.iter().copied().filter(|value| value.is_finite());
        values.fold(start, pick)
    };
    let least = finite(lower, f64::INFINITY, f64::min);
    let greatest = finite(upper, f64::NEG_INFINITY, f64::max);
    let width = greatest - least;
    (width.is_finite() && width > 0.0)
        .then_some([least - MARGIN * width, greatest + MARGIN * width])
}

/// Stretches of invalid lines, each with the most frequent reason of its lines.
#[allow(
    clippy::indexing_slicing,
    reason = "`lines` are all lines of the estimate, and each has its list of reasons"
)]
fn greyed(lines: &[&ModulusLine], reasons: &Reasons) -> Vec<Greyed> {
    let (Some(first), Some(last)) = (lines.first(), lines.last()) else {
        return Vec::new();
    };
    let least = LEAST_WIDTH * (last.frequency_hz - first.frequency_hz);
    let mut greyed = Vec::new();
    let mut start = 0;
    while start < lines.len() {
        if lines[start].validity.is_valid() {
            start += 1;
            continue;
        }
        let length = lines[start..]
            .iter()
            .take_while(|line| !line.validity.is_valid())
            .count();
        let end = start + length - 1;
        // halfway to the valid neighbours
        let edge = |inside: usize, outside: Option<usize>| {
            let f = lines[inside].frequency_hz;
            let beyond = outside.and_then(|index| lines.get(index));
            beyond.map_or(f, |line| 0.5 * (f + line.frequency_hz))
        };
        let (from, to) = (edge(start, start.checked_sub(1)), edge(end, Some(end + 1)));
        if to - from > least {
            greyed.push(Greyed {
                from: 1e-3 * from,
                to: 1e-3 * to,
                because: commonest(&reasons.of_line[start..=end]),
            });
        }
        start = end + 1;
    }
    greyed
}

fn commonest(of_lines: &[Vec<&'static str>]) -> String {
    let mut counts: Vec<(&'static str, usize)> = Vec::new();
    for reason in of_lines.iter().flatten() {
        match counts.iter_mut().find(|(known, _)| known == reason) {
            Some((_, count)) => *count += 1,
            None => counts.push((reason, 1)),
        }
    }
    // the first by name of equal counts
    counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    counts
        .first()
        .map_or_else(String::new, |(reason, _)| (*reason).to_owned())
}

fn cole_cole(lines: &[&ModulusLine], (giga, unit): (f64, &'static str)) -> Figure {
    let valid = || lines.iter().filter(|line| line.validity.is_valid());
    Figure {
        name: "cole_cole".to_owned(),
        title: "Loss modulus over storage modulus".to_owned(),
        caption: "The Cole-Cole plot of the valid lines: one relaxation time makes half a circle, many make an arc or less.".to_owned(),
        panels: vec![Panel {
            x: Axis::linear("E'", unit),
            y: Axis::linear("E''", unit),
            marks: vec![Mark::Points {
                name: "valid lines".to_owned(),
                role: Role::First,
                x: valid().map(|line| giga * line.modulus.re).collect(),
                y: valid().map(|line| giga * line.modulus.im).collect(),
                error: Vec::new(),
            }],
            greyed: Vec::new(),
            equal_axes: false,
        }],
    }
}

/// Half waves between the sections: a curve that is not smooth shows a wrong count.
fn waves(found: &Found<'_>, lines: &[&ModulusLine], greyed: &[Greyed]) -> Figure {
    let x: Vec<f64> = lines.iter().map(|line| 1e-3 * line.frequency_hz).collect();
    let half_waves = |wave_number: f64| wave_number * found.distance / std::f64::consts::PI;
    let mut marks = Vec::new();
    let closed: Vec<f64> = lines
        .iter()
        .map(|line| {
            let root = line.closed_form.as_ref();
            root.map_or(f64::NAN, |root| root.gamma_length.im / std::f64::consts::PI)
        })
        .collect();
    if closed.iter().any(|value| value.is_finite()) {
        marks.push(Mark::Line {
            name: "closed form it starts from".to_owned(),
            role: Role::Reference,
            x: x.clone(),
            y: closed,
        });
    }
    let of = |valid: bool| -> Vec<f64> {
        let value = |line: &&ModulusLine| {
            if line.validity.is_valid() == valid {
                half_waves(line.wave_number())
            } else {
                f64::NAN
            }
        };
        lines.iter().map(value).collect()
    };
    marks.push(Mark::Points {
        name: "not valid".to_owned(),
        role: Role::Faint,
        x: x.clone(),
        y: of(false),
        error: Vec::new(),
    });
    marks.push(Mark::Line {
        name: "valid".to_owned(),
        role: Role::First,
        x,
        y: of(true),
    });
    Figure {
        name: "waves".to_owned(),
        title: "Half waves between the sections".to_owned(),
        caption: "The wave number times the distance over which waves are counted, by π. It starts at 0 and grows smoothly; a leap \
                  would be a wave too many or too few."
            .to_owned(),
        panels: vec![Panel {
            x: kilohertz(),
            y: Axis::linear("half waves", ""),
            marks,
            greyed: greyed.to_vec(),
            equal_axes: false,
        }],
    }
}

/// The measured ratio, and its coherence.
fn coherence(found: &Found<'_>) -> Option<Figure> {
    let ratio = found.ratio()?;
    let stride = ratio.frequency_hz.len().div_ceil(MOST_LINES).max(1);
    let picked = |values: &[f64]| -> Vec<f64> { values.iter().step_by(stride).copied().collect() };
    let x: Vec<f64> = picked(&ratio.frequency_hz)
        .iter()
        .map(|f| 1e-3 * f)
        .collect();
    let magnitude: Vec<f64> = ratio.values.iter().map(|value| value.norm()).collect();
    let error: Vec<f64> = ratio.variance.iter().map(|v| (0.5 * v).sqrt()).collect();
    let edge = |sign: f64| -> Vec<f64> {
        let pairs = magnitude.iter().zip(&error);
        picked(
            &pairs
                .map(|(m, e)| m + sign * BAND * e)
                .collect::<Vec<f64>>(),
        )
    };
    let line = |y: Vec<f64>| Mark::Line {
        name: String::new(),
        role: Role::First,
        x: x.clone(),
        y,
    };
    let panel = |y: Axis, marks: Vec<Mark>| Panel {
        x: kilohertz(),
        y,
        marks,
        greyed: Vec::new(),
        equal_axes: false,
    };
    let mut panels = vec![panel(
        Axis::logarithmic("magnitude of the ratio", ""),
        vec![
            Mark::Band {
                name: "two standard errors".to_owned(),
                role: Role::First,
                x: x.clone(),
                lower: edge(-1.0),
                upper: edge(1.0),
            },
            line(picked(&magnitude)),
        ],
    )];
    if let Some(coherence) = &ratio.coherence {
        let least = coherence
            .iter()
            .filter(|value| value.is_finite())
            .fold(0.99_f64, |least, value| least.min(*value));
        let room = 0.05 * (1.0 - least);
        panels.push(panel(
            Axis::linear("coherence", "").within([least - room, 1.0 + room]),
            vec![line(picked(coherence))],
        ));
    }
    Some(Figure {
        name: "ratio".to_owned(),
        title: "Ratio of spectra and its coherence".to_owned(),
        caption: "What the modulus is found from.".to_owned(),
        panels,
    })
}
