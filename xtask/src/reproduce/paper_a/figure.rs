//! Figures 3 to 6.

use std::f64::consts::TAU;

use cmod::ModulusLine;
use num_complex::Complex64;
use rodfigure::{Mark, Panel, Role};

use super::super::drawn;
use super::room_temperature::{Evaluated, is_admissible};
use super::temperature::{Heated, OF_FIGURE_5};
use super::wave_method::Comparison;

/// Largest number of points of a curve.
const POINTS: usize = 90;

/// Greatest relative standard error of the loss factor for which a point is shown.
pub(crate) const SHOWN: f64 = 0.05;

/// Returns the points of E' and E'' with their standard errors.
fn points(name: &str, role: Role, lines: &[ModulusLine]) -> [Mark; 2] {
    let shown: Vec<&ModulusLine> = lines
        .iter()
        .filter(|line| is_admissible(line))
        .filter(|line| line.standard_error.loss_factor < SHOWN * line.loss_factor)
        .collect();
    let every = shown.len().div_ceil(POINTS).max(1);
    let points = |part: fn(&ModulusLine) -> (f64, f64)| {
        let lines = shown.iter().step_by(every);
        let points = lines.map(|line| {
            let (value, error) = part(line);
            (1e-3 * line.frequency_hz, 1e-9 * value, 1e-9 * error)
        });
        Mark::points_with_errors(name, role, points)
    };
    [
        points(|line| (line.modulus.re, line.standard_error.storage_modulus)),
        points(|line| (line.modulus.im, line.standard_error.loss_modulus)),
    ]
}

/// Returns the curves of E' and E'' of a material.
fn material(law: impl Fn(f64) -> Complex64, [from, to]: [f64; 2]) -> [Mark; 2] {
    let curve = |part: fn(Complex64) -> f64| {
        let frequencies = (0..=100).map(|j| from + (to - from) * 0.01 * f64::from(j));
        let points = frequencies.map(|f| (1e-3 * f, 1e-9 * part(law(TAU * f))));
        Mark::line("material", Role::Reference, points)
    };
    [curve(|modulus| modulus.re), curve(|modulus| modulus.im)]
}

/// Returns the panels of E' and E'' over frequency.
fn panels(marks: Vec<[Mark; 2]>) -> Vec<Panel> {
    let (storage, loss) = marks.into_iter().map(<(Mark, Mark)>::from).unzip();
    vec![
        Panel::new(("frequency", "kHz"), ("E'", "GPa"), storage),
        Panel::new(("frequency", "kHz"), ("E''", "GPa"), loss),
    ]
}

/// Draws Figure 4 or one of the parts of Figure 3: all lengths of one diameter, with the results of
/// the pulse method if it was used.
pub(crate) fn room_temperature(
    name: &str,
    title: &str,
    tests: &[&Evaluated],
    pulses: Option<&Comparison>,
) -> (String, String) {
    let mut marks = Vec::new();
    for (index, test) in tests.iter().enumerate() {
        let name = format!("Test {}, {:.0} mm", test.row.test, 1e3 * test.length);
        marks.push(points(&name, Role::of_series(index), test.estimate.lines()));
    }
    if let Some(pulses) = pulses {
        let lines = pulses.estimate.lines();
        marks.push(points("separate pulses", Role::Fourth, lines));
    }
    if let Some(test) = tests.first() {
        let law = |omega: f64| test.medium.modulus(omega);
        marks.push(material(law, [300.0, 20e3]));
    }
    drawn(name, title, panels(marks))
}

/// Draws Figure 5.
pub(crate) fn temperatures(heated: &[Heated]) -> (String, String) {
    let of_figure = OF_FIGURE_5.iter().filter_map(|celsius| {
        let mut heated = heated.iter();
        heated.find(|one| (one.row.celsius - celsius).abs() < 0.5)
    });
    let (mut found, mut laws) = (Vec::new(), Vec::new());
    for (index, one) in of_figure.enumerate() {
        let name = format!("{:.0} °C", one.row.celsius);
        found.push(points(&name, Role::of_series(index), one.estimate.lines()));
        let law = |omega: f64| one.medium.modulus(omega);
        laws.push(material(law, [400.0, one.row.highest_hz]));
    }
    found.extend(laws);
    let title = "Paper A, Figure 5, virtual: Test 6, stated law of temperature";
    drawn("figure-5", title, panels(found))
}

/// Draws Figure 6: (a) E' and E'', (b) the loss factor, at 1 kHz.
pub(crate) fn at_one_kilohertz(heated: &[Heated]) -> (String, String) {
    let marks = |part: usize, scale: f64, role: Role, name: &str| {
        let rows = heated.iter().map(|one| &one.row);
        let law = rows
            .clone()
            .map(|row| (row.celsius, scale * row.exact[part]));
        let found = rows.map(|row| {
            let [value, error] = [row.values[part], row.errors[part]].map(|value| scale * value);
            (row.celsius, value, error)
        });
        vec![
            Mark::points_with_errors(name, role, found),
            Mark::line("law", Role::Reference, law),
        ]
    };
    let mut moduli = marks(0, 1e-9, Role::First, "E'");
    moduli.extend(marks(1, 1e-9, Role::Second, "E''"));
    let loss_factor = marks(2, 1.0, Role::Third, "E''/E'");
    let panels = vec![
        Panel::new(("temperature", "°C"), ("(a) modulus", "GPa"), moduli),
        Panel::new(("temperature", "°C"), ("(b) loss factor", ""), loss_factor),
    ];
    drawn("figure-6", "Paper A, Figure 6 at 1 kHz, virtual", panels)
}
