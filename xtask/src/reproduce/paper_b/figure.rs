//! Figures 2 and 4.

use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::LegendPosition;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::super::Error;
use super::estimates::{Line, Series};
use super::rig::{GAUGE_DISTANCE, Mounting, positions, strains};
use testbed::papers::paper_b::PaperB;

const COLOURS: [&str; 4] = ["#c2410c", "#1d4ed8", "#15803d", "#444444"];

/// Draws Figure 2 over the band of the paper: the strain ratios depend on the ends, Ψ is the same
/// in every structure.
pub(crate) fn phasors(paper: &PaperB) -> Result<String, Error> {
    let positions = positions(paper, GAUGE_DISTANCE);
    // close enough for the loops at the nodes of the middle gauge to be round
    let frequency_hz: Vec<f64> = (0..=2000_u32)
        .map(|j| paper.lowest_hz + (paper.highest_hz - paper.lowest_hz) * f64::from(j) / 2000.0)
        .collect();
    let mut panels = Vec::new();
    for mounting in [Mounting::StructureI, Mounting::StructureII] {
        let strain = strains(paper, mounting, &positions, &frequency_hz)?;
        let ratio = |of: &dyn Fn(usize) -> num_complex::Complex64| -> Vec<(f64, f64)> {
            (0..frequency_hz.len())
                .map(|line| {
                    let value = of(line) / strain[1][line];
                    (value.re, value.im)
                })
                .collect()
        };
        let curve = |data, colour: &str, legend: &str| {
            Plot::Line(
                LinePlot::new()
                    .with_data(data)
                    .with_color(colour)
                    .with_legend(legend),
            )
        };
        panels.push((
            mounting,
            vec![
                curve(ratio(&|line| strain[0][line]), COLOURS[0], "ε1/ε0"),
                curve(ratio(&|line| strain[2][line]), COLOURS[1], "ε2/ε0"),
                curve(
                    ratio(&|line| 0.5 * (strain[0][line] + strain[2][line])),
                    COLOURS[3],
                    "Ψ",
                ),
            ],
        ));
    }
    let layouts = panels
        .iter()
        .map(|(mounting, plots)| {
            Layout::auto_from_plots(plots)
                .with_title(format!("Paper B, Figure 2: {}", mounting.name()))
                .with_x_label("real part")
                .with_y_label("imaginary part")
                .with_legend_position(LegendPosition::InsideTopRight)
        })
        .collect();
    Ok(drawn(
        panels.into_iter().map(|(_, plots)| plots).collect(),
        layouts,
        (1, 2),
        (460.0, 420.0),
    ))
}

/// Draws Figure 4: points with bars of one standard error, and the material.
pub(crate) fn moduli(series: &[Series]) -> String {
    let storage = |line: &Line| (line.storage_modulus, line.storage_error, line.truth.re);
    let loss = |line: &Line| (line.loss_modulus, line.loss_error, line.truth.im);
    let panel = |part: &dyn Fn(&Line) -> (f64, f64, f64)| {
        let mut plots = Vec::new();
        for (one, colour) in series.iter().zip(COLOURS) {
            let valid: Vec<&Line> = one.lines.iter().filter(|line| line.valid).collect();
            plots.push(Plot::Scatter(
                ScatterPlot::new()
                    .with_data(
                        valid
                            .iter()
                            .map(|line| (1e-3 * line.frequency_hz, 1e-9 * part(line).0))
                            .collect::<Vec<_>>(),
                    )
                    .with_y_err(
                        valid
                            .iter()
                            .map(|line| 1e-9 * part(line).1)
                            .collect::<Vec<_>>(),
                    )
                    .with_color(colour)
                    .with_size(2.5)
                    .with_legend(one.way.clone()),
            ));
        }
        if let Some(one) = series.first() {
            plots.push(Plot::Line(
                LinePlot::new()
                    .with_data(
                        one.lines
                            .iter()
                            .map(|line| (1e-3 * line.frequency_hz, 1e-9 * part(line).2))
                            .collect::<Vec<_>>(),
                    )
                    .with_color("#999999")
                    .with_legend("material"),
            ));
        }
        plots
    };
    let panels = vec![panel(&storage), panel(&loss)];
    let layouts = panels
        .iter()
        .zip(["E', GPa", "E'', GPa"])
        .map(|(plots, label)| {
            Layout::auto_from_plots(plots)
                .with_title("Paper B, Figure 4 on virtual tests")
                .with_x_label("frequency, kHz")
                .with_y_label(label)
                .with_legend_position(LegendPosition::OutsideRightTop)
        })
        .collect();
    drawn(panels, layouts, (2, 1), (860.0, 320.0))
}

fn drawn(
    panels: Vec<Vec<Plot>>,
    layouts: Vec<Layout>,
    (rows, columns): (usize, usize),
    (width, height): (f64, f64),
) -> String {
    let scene = Figure::new(rows, columns)
        .with_plots(panels)
        .with_layouts(layouts)
        .with_cell_size(width, height)
        .render();
    SvgBackend::default().render_scene(&scene)
}
