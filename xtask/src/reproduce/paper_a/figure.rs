//! Figures 3 to 6.

use std::f64::consts::TAU;

use cmod::ModulusLine;
use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::LegendPosition;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use num_complex::Complex64;

use super::room_temperature::{Evaluated, is_admissible};
use super::temperature::{Heated, OF_FIGURE_5};
use super::wave_method::Comparison;

const COLOURS: [&str; 3] = ["#15803d", "#1d4ed8", "#c2410c"];
const PULSE: &str = "#111827";
const MATERIAL: &str = "#888888";

/// Maximum number of points of a curve.
const POINTS: usize = 90;

/// Greatest relative standard error of the loss factor of a point.
pub(crate) const SHOWN: f64 = 0.05;

/// E' or E'' of a line with its standard error, in GPa, or that of the material.
#[derive(Clone, Copy)]
enum Part {
    Storage,
    Loss,
}

impl Part {
    const BOTH: [Self; 2] = [Self::Storage, Self::Loss];

    fn of(self, line: &ModulusLine) -> (f64, f64) {
        match self {
            Self::Storage => (
                1e-9 * line.modulus.re,
                1e-9 * line.standard_error.storage_modulus,
            ),
            Self::Loss => (
                1e-9 * line.modulus.im,
                1e-9 * line.standard_error.loss_modulus,
            ),
        }
    }

    fn of_modulus(self, modulus: Complex64) -> f64 {
        1e-9 * match self {
            Self::Storage => modulus.re,
            Self::Loss => modulus.im,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Storage => "E', GPa",
            Self::Loss => "E'', GPa",
        }
    }
}

fn points<'a>(
    lines: impl Iterator<Item = &'a ModulusLine>,
    part: Part,
    colour: &str,
    size: f64,
    legend: String,
) -> Plot {
    let lines: Vec<&ModulusLine> = lines
        .filter(|line| is_admissible(line))
        .filter(|line| line.standard_error.loss_factor < SHOWN * line.loss_factor)
        .collect();
    let every = lines.len().div_ceil(POINTS).max(1);
    let shown: Vec<&ModulusLine> = lines.into_iter().step_by(every).collect();
    Plot::Scatter(
        ScatterPlot::new()
            .with_data(
                shown
                    .iter()
                    .map(|line| (1e-3 * line.frequency_hz, part.of(line).0))
                    .collect::<Vec<_>>(),
            )
            .with_y_err(shown.iter().map(|line| part.of(line).1).collect::<Vec<_>>())
            .with_color(colour)
            .with_size(size)
            .with_legend(legend),
    )
}

fn material(law: &dyn Fn(f64) -> Complex64, part: Part, (from, to): (f64, f64)) -> Plot {
    let data: Vec<(f64, f64)> = (0..=100)
        .map(|j| from + (to - from) * 0.01 * f64::from(j))
        .map(|f| (1e-3 * f, part.of_modulus(law(f))))
        .collect();
    Plot::Line(
        LinePlot::new()
            .with_data(data)
            .with_color(MATERIAL)
            .with_legend("material"),
    )
}

/// Draws a panel of Figure 3, or Figure 4: all lengths of one diameter, with the pulse method where
/// it was used.
pub(crate) fn room_temperature(
    title: &str,
    tests: &[&Evaluated],
    pulses: Option<&Comparison>,
) -> String {
    let panels: Vec<Vec<Plot>> = Part::BOTH
        .into_iter()
        .map(|part| {
            let mut plots: Vec<Plot> = tests
                .iter()
                .zip(COLOURS)
                .map(|(test, colour)| {
                    points(
                        test.estimate.lines().iter(),
                        part,
                        colour,
                        1.8,
                        format!("Test {}, {:.0} mm", test.row.test, 1e3 * test.length),
                    )
                })
                .collect();
            if let Some(pulses) = pulses {
                plots.push(points(
                    pulses.estimate.lines().iter(),
                    part,
                    PULSE,
                    3.0,
                    "separate pulses".into(),
                ));
            }
            if let Some(test) = tests.first() {
                let law = |f: f64| test.medium.modulus(TAU * f);
                plots.push(material(&law, part, (300.0, 20e3)));
            }
            plots
        })
        .collect();
    stacked(title, panels)
}

/// Draws Figure 5.
pub(crate) fn temperatures(heated: &[Heated]) -> String {
    let of_figure: Vec<&Heated> = OF_FIGURE_5
        .iter()
        .filter_map(|celsius| {
            heated
                .iter()
                .find(|one| (one.row.celsius - celsius).abs() < 0.5)
        })
        .collect();
    let panels = Part::BOTH
        .into_iter()
        .map(|part| {
            let mut plots = Vec::new();
            for (one, colour) in of_figure.iter().zip(COLOURS.iter()) {
                plots.push(points(
                    one.estimate.lines().iter(),
                    part,
                    colour,
                    1.8,
                    format!("{:.0} °C", one.row.celsius),
                ));
            }
            for (index, one) in of_figure.iter().enumerate() {
                let law = |f: f64| one.medium.modulus(TAU * f);
                let curve = material(&law, part, (400.0, one.row.highest_hz));
                plots.push(match curve {
                    // one entry in the legend is enough
                    Plot::Line(line) if index > 0 => Plot::Line(LinePlot {
                        legend_label: None,
                        ..line
                    }),
                    other => other,
                });
            }
            plots
        })
        .collect();
    stacked(
        "Paper A, Figure 5, virtual: Test 6, stated law of temperature",
        panels,
    )
}

/// Draws Figure 6: (a) E' and E'', (b) the loss factor, at 1 kHz.
pub(crate) fn at_one_kilohertz(heated: &[Heated]) -> String {
    let curve = |part: usize, scale: f64, colour: &str, legend: &str| {
        let found: Vec<(f64, f64, f64)> = heated
            .iter()
            .map(|one| {
                let row = &one.row;
                (
                    row.celsius,
                    scale * row.values[part],
                    scale * row.errors[part],
                )
            })
            .collect();
        let law: Vec<(f64, f64)> = heated
            .iter()
            .map(|one| (one.row.celsius, scale * one.row.exact[part]))
            .collect();
        [
            Plot::Scatter(
                ScatterPlot::new()
                    .with_data(
                        found
                            .iter()
                            .map(|(t, value, _)| (*t, *value))
                            .collect::<Vec<_>>(),
                    )
                    .with_y_err(found.iter().map(|(_, _, error)| *error).collect::<Vec<_>>())
                    .with_color(colour)
                    .with_size(3.0)
                    .with_legend(legend),
            ),
            Plot::Line(
                LinePlot::new()
                    .with_data(law)
                    .with_color(MATERIAL)
                    .with_legend(format!("{legend} of the law")),
            ),
        ]
    };
    let panels = vec![
        curve(0, 1e-9, COLOURS[1], "E'")
            .into_iter()
            .chain(curve(1, 1e-9, COLOURS[2], "E''"))
            .collect(),
        curve(2, 1.0, COLOURS[0], "E''/E'")
            .into_iter()
            .collect::<Vec<Plot>>(),
    ];
    let layouts = panels
        .iter()
        .zip([("(a) modulus", "GPa"), ("(b) loss factor", "E''/E'")])
        .map(|(plots, (name, label))| {
            Layout::auto_from_plots(plots)
                .with_title(format!("Paper A, Figure 6 {name} at 1 kHz, virtual"))
                .with_x_label("temperature, °C")
                .with_y_label(label)
                .with_legend_position(LegendPosition::OutsideRightTop)
        })
        .collect();
    drawn(panels, layouts)
}

fn stacked(title: &str, panels: Vec<Vec<Plot>>) -> String {
    let layouts = panels
        .iter()
        .zip(Part::BOTH)
        .map(|(plots, part)| {
            Layout::auto_from_plots(plots)
                .with_title(title)
                .with_x_label("frequency, kHz")
                .with_y_label(part.label())
                .with_legend_position(LegendPosition::OutsideRightTop)
        })
        .collect();
    drawn(panels, layouts)
}

fn drawn(panels: Vec<Vec<Plot>>, layouts: Vec<Layout>) -> String {
    let scene = Figure::new(2, 1)
        .with_plots(panels)
        .with_layouts(layouts)
        .with_cell_size(860.0, 320.0)
        .render();
    SvgBackend::default().render_scene(&scene)
}
