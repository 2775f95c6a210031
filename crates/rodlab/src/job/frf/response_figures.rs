//! Figures of a response: magnitude, phase and coherence; the Nyquist plot; the comparison of two
//! hammers.
#![allow(
    clippy::indexing_slicing,
    reason = "`line` is the index of a line of the response, and every list has one element per line"
)]

use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::estimate::Estimated;
use super::scope::Band;
use super::thin;
use super::words::{name_of, unit_of};
use crate::outcome::capital;

const N_BUCKETS: usize = 400;
const KHZ: f64 = 1e-3;
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// Indices of the lines that are drawn, and their frequencies \[kHz\].
struct Drawn {
    kept: Vec<usize>,
    frequency: Vec<f64>,
}

impl Drawn {
    fn of(estimated: &Estimated) -> Self {
        let response = &estimated.response;
        let frequency: Vec<f64> = response.frequency_hz.iter().map(|f| f * KHZ).collect();
        let magnitudes: Vec<f64> = response.values.iter().map(|h| h.norm()).collect();
        let mut curves: Vec<&[f64]> = vec![&magnitudes];
        curves.extend(estimated.coherences.iter().map(|c| c.values.as_slice()));
        let kept = thin::logarithmically(&frequency, &curves, N_BUCKETS);
        Self {
            frequency: thin::at(&frequency, &kept),
            kept,
        }
    }

    fn each(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        self.kept.iter().map(|line| value(*line)).collect()
    }

    /// Returns two curves: the valid lines and, if there are any, the invalid lines.
    fn lines(&self, estimated: &Estimated, value: impl Fn(usize) -> f64) -> Vec<Mark> {
        let kinds = [(true, Role::First), (false, Role::Faint)].into_iter();
        let there = kinds.filter(|(valid, _)| {
            let is_of_it = |line: &usize| estimated.is_valid(*line) == *valid;
            self.kept.iter().any(is_of_it)
        });
        let line = |(valid, role): (bool, Role)| {
            let name = if valid {
                "valid lines"
            } else {
                "lines that are not valid"
            };
            let values = self.each(|line| {
                if estimated.is_valid(line) == valid {
                    value(line)
                } else {
                    f64::NAN
                }
            });
            Mark::curve(name, role, &self.frequency, values)
        };
        there.map(line).collect()
    }

    fn panel(&self, y: Axis, marks: Vec<Mark>, greyed: &[Greyed], band: Band) -> Panel {
        let band = [band.from_hz * KHZ, band.to_hz * KHZ];
        let x = Axis::logarithmic("frequency", "kHz").within(band);
        Panel::new(x, y, marks).with_greyed(greyed.to_vec())
    }
}

/// Figure of the magnitude with its band of one standard error, the phase and the coherence.
pub(super) fn bode(
    estimated: &Estimated,
    output: &str,
    input: &str,
    file: &str,
    band: Band,
    greyed: &[Greyed],
) -> Figure {
    let response = &estimated.response;
    let drawn = Drawn::of(estimated);
    let errors = response.random_error();
    let mut marks = Vec::new();
    if let Some(errors) = &errors {
        // the band has the same number of decibels up and down
        let edge = |line: usize, sign: f64| {
            let relative = errors[line].magnitude;
            if relative.is_finite() && estimated.is_valid(line) {
                response.values[line].norm() * (sign * relative).exp()
            } else {
                f64::NAN
            }
        };
        let lines = drawn.kept.iter().zip(&drawn.frequency);
        let edges = lines.map(|(line, f)| (*f, edge(*line, -1.0), edge(*line, 1.0)));
        marks.push(Mark::band(
            "one standard error (random)",
            Role::First,
            edges,
        ));
    }
    marks.extend(drawn.lines(estimated, |line| response.values[line].norm()));
    let magnitude = drawn.panel(
        Axis::logarithmic(
            format!("magnitude of {}", name_of(response)),
            unit_of(response),
        ),
        marks,
        greyed,
        band,
    );
    let (axis, marks) = phase(estimated, &drawn);
    let phase = drawn.panel(axis, marks, greyed, band);
    let mut panels = vec![magnitude, phase];
    if !estimated.coherences.is_empty() {
        let marks = coherence(estimated, &drawn);
        panels.push(drawn.panel(
            Axis::linear("coherence", "").within([0.0, 1.0]),
            marks,
            greyed,
            band,
        ));
    }
    let of_coherence = if estimated.coherences.is_empty() {
        "A single hit has no coherence and no random error: no line is valid."
    } else {
        "Lines with a coherence that chance would reach once in twenty are faint."
    };
    let (name, of) = (format!("response_{file}"), capital(&name_of(response)));
    Figure::new(name, format!("{of} of {output} over {input}"), panels).with_caption(format!(
        "Magnitude, phase and coherence; the band is one random standard error of a line and does not include the calibration. {of_coherence} If there are many lines, their extremes are drawn."
    ))
}

/// Returns the phase over one turn of 360 degrees, interrupted where it wraps. The range is chosen
/// so that the phase wraps as rarely as possible.
fn phase(estimated: &Estimated, drawn: &Drawn) -> (Axis, Vec<Mark>) {
    let response = &estimated.response;
    let from = |begin: f64, line: usize| {
        let turned = response.values[line].arg() * DEGREES - begin;
        begin + turned.rem_euclid(360.0)
    };
    let passes = |begin: &f64| {
        let lines = drawn.kept.iter().filter(|line| estimated.is_valid(**line));
        let phases: Vec<f64> = lines.map(|line| from(*begin, *line)).collect();
        let pairs = phases.windows(2);
        pairs
            .filter(|pair| (pair[1] - pair[0]).abs() > 180.0)
            .count()
    };
    // of several ranges with equally many wraps, the first is used
    let begin = [-180.0, -270.0, -90.0, 0.0]
        .into_iter()
        .min_by_key(passes)
        .unwrap_or(-180.0);
    let marks = drawn.lines(estimated, |line| from(begin, line));
    (
        Axis::linear("phase", "deg").within([begin, begin + 360.0]),
        marks.into_iter().map(interrupted).collect(),
    )
}

fn interrupted(mark: Mark) -> Mark {
    let Mark::Line { name, role, x, y } = mark else {
        return mark;
    };
    let mut broken_x = Vec::with_capacity(x.len());
    let mut broken_y = Vec::with_capacity(y.len());
    let mut before = f64::NAN;
    for (x, y) in x.into_iter().zip(y) {
        if (y - before).abs() > 180.0 {
            broken_x.push(x);
            broken_y.push(f64::NAN);
        }
        broken_x.push(x);
        broken_y.push(y);
        before = y;
    }
    Mark::Line {
        name,
        role,
        x: broken_x,
        y: broken_y,
    }
}

fn coherence(estimated: &Estimated, drawn: &Drawn) -> Vec<Mark> {
    let several = estimated.coherences.len() > 1;
    let mut marks = Vec::new();
    for (index, coherence) in estimated.coherences.iter().enumerate() {
        let name = match (several, index) {
            (false, _) => "coherence",
            (true, 0) => "first hammer",
            (true, _) => "second hammer",
        };
        let values = drawn.each(|line| coherence.values[line]);
        marks.push(Mark::curve(
            name,
            Role::of_series(index),
            &drawn.frequency,
            values,
        ));
    }
    // a logarithmic axis has no 0 Hz
    let mut above_0 = drawn.frequency.iter().filter(|f| **f > 0.0);
    let ends = [above_0.next(), drawn.frequency.last()];
    let level = estimated
        .coherences
        .first()
        .and_then(|c| c.chance_level(labio::Coherence::CHANCE).ok());
    if let ([Some(first), Some(last)], Some(level)) = (ends, level) {
        let (name, ends) = ("reached by chance once in twenty", [*first, *last]);
        let points = ends.map(|end| (end, level));
        marks.push(Mark::line(name, Role::Reference, points));
    }
    marks
}

/// Figure of the imaginary over the real part, for the valid lines of the band.
pub(super) fn nyquist(
    estimated: &Estimated,
    output: &str,
    input: &str,
    file: &str,
    band: Band,
) -> Figure {
    let response = &estimated.response;
    let shown =
        |line: usize| estimated.is_measured(line) && band.holds(response.frequency_hz[line]);
    let part = |part: fn(&num_complex::Complex64) -> f64| -> Vec<f64> {
        let lines = response.values.iter().enumerate();
        lines
            .map(|(line, value)| if shown(line) { part(value) } else { f64::NAN })
            .collect()
    };
    let (real, imaginary) = (part(|h| h.re), part(|h| h.im));
    let (name, unit) = (name_of(response), unit_of(response));
    let panel = Panel {
        equal_axes: true,
        ..Panel::new(
            (format!("real part of {name}"), unit.as_str()),
            (format!("imaginary part of {name}"), unit.as_str()),
            vec![Mark::curve("", Role::First, &real, imaginary)],
        )
    };
    let title = format!("Nyquist plot of the {name} of {output} over {input}");
    Figure::new(format!("nyquist_{file}"), title, vec![panel]).with_caption(
        "Imaginary over real part of the valid lines of the band; a single resonance is a circle.",
    )
}

/// Figure of the responses of two hammers, and of their difference.
pub(super) fn merge(
    estimated: &Estimated,
    output: &str,
    file: &str,
    band: Band,
    greyed: &[Greyed],
) -> Option<Figure> {
    let merged = estimated.merged.as_ref()?;
    let shares = merged.shares.row(0).to_vec();
    let drawn = Drawn::of(estimated);
    let panel = |y: Axis, values: &[f64]| {
        let values = thin::at(values, &drawn.kept);
        let line = Mark::curve("", Role::First, &drawn.frequency, values);
        drawn.panel(y, vec![line], greyed, band)
    };
    let share = Axis::linear("share of the first hammer", "").within([0.0, 1.0]);
    let panels = vec![
        panel(share, &shares),
        panel(Axis::logarithmic("discrepancy", ""), &merged.discrepancy),
    ];
    let title = format!("Response of {output} merged from two hammers");
    Some(Figure::new(format!("merge_{file}"), title, panels).with_caption(
        "Share of the first hammer in every line, and the difference of the two in units of their random errors: 1 on average if they differ by chance only.",
    ))
}
