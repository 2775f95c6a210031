//! One figure per material: measured and simulated response of the four tests, and the residual.

use kuva::backend::svg::SvgBackend;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::materials::{History, Material};

/// Returns the figure as SVG.
pub(crate) fn svg(material: &Material, impact_velocity: f64) -> String {
    let mut plots = Vec::new();
    let mut layouts = Vec::new();
    for history in &material.histories {
        let panel = responses(history);
        layouts.push(
            Layout::auto_from_plots(&panel)
                .with_title(history.name.clone())
                .with_x_label("time from the first sample, ms")
                .with_y_label("velocity of the free end, m/s"),
        );
        plots.push(panel);
    }
    for history in &material.histories {
        let panel = vec![residual(history, impact_velocity)];
        layouts.push(
            Layout::auto_from_plots(&panel)
                .with_x_label("time from the first sample, ms")
                .with_y_label("simulated - measured, % of V0"),
        );
        plots.push(panel);
    }
    let columns = material.histories.len();
    let scene = Figure::new(2, columns)
        .with_title(format!(
            "{}: virtual measurements (points) and the identified law (lines)",
            material.material
        ))
        .with_title_size(18)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(380.0, 280.0)
        .render();
    SvgBackend::default().render_scene(&scene)
}

fn milliseconds(times: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    times
        .iter()
        .zip(values)
        .map(|(t, v)| (1e3 * t, *v))
        .collect()
}

fn responses(history: &History) -> Vec<Plot> {
    vec![
        Plot::Scatter(
            ScatterPlot::new()
                .with_data(milliseconds(&history.times, &history.measured))
                .with_color("#555555")
                .with_size(1.8),
        ),
        Plot::Line(
            LinePlot::new()
                .with_data(milliseconds(&history.times, &history.simulated))
                .with_color("#c2410c")
                .with_stroke_width(1.4),
        ),
    ]
}

fn residual(history: &History, impact_velocity: f64) -> Plot {
    let values: Vec<f64> = history
        .simulated
        .iter()
        .zip(&history.measured)
        .map(|(s, m)| 100.0 * (s - m) / impact_velocity)
        .collect();
    Plot::Line(
        LinePlot::new()
            .with_data(milliseconds(&history.times, &values))
            .with_color("#1d4ed8")
            .with_stroke_width(1.0),
    )
}
