//! Figures 2 and 3.

use cmod::recovery::{RecoveryTest, ThreeElement};
use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::LegendPosition;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::super::Error;
use super::curves::{Quantity, of_figure, times_of_figure};
use testbed::papers::paper_c::PaperC;

/// Colours, one per test; distinguishable with any kind of colour blindness together with the
/// legend's order.
const COLOURS: [&str; 6] = [
    "#c2410c", "#1d4ed8", "#15803d", "#7e22ce", "#0e7490", "#444444",
];

/// Draws Figure 2: lines of the model, points of the virtual readings.
pub(crate) fn loss_factor(
    paper: &PaperC,
    model: &ThreeElement,
    readings: &[RecoveryTest],
) -> Result<String, Error> {
    let mut plots = lines(paper, model, Quantity::LossFactor)?;
    for (test, colour) in readings.iter().zip(COLOURS) {
        let points: Vec<(f64, f64)> = test
            .time()
            .iter()
            .zip(test.change())
            .map(|(t, change)| (t.log10(), 100.0 * change / paper.virgin_loss_factor))
            .collect();
        plots.push(Plot::Scatter(
            ScatterPlot::new().with_data(points).with_color(colour),
        ));
    }
    Ok(drawn(
        plots,
        "Paper C, Figure 2: loss factor after unloading (points: virtual readings)",
        "change of the loss factor, % of its virgin value",
        LegendPosition::InsideTopRight,
    ))
}

/// Draws Figure 3, as far as the model applies.
pub(crate) fn modulus(paper: &PaperC, model: &ThreeElement) -> Result<String, Error> {
    Ok(drawn(
        lines(paper, model, Quantity::Modulus)?,
        "Paper C, Figure 3: magnitude of the modulus after unloading, by the model",
        "change of |E|, % of its virgin value",
        LegendPosition::InsideBottomRight,
    ))
}

fn lines(paper: &PaperC, model: &ThreeElement, quantity: Quantity) -> Result<Vec<Plot>, Error> {
    let curves = of_figure(paper, model, quantity)?;
    Ok(paper
        .tests
        .iter()
        .zip(curves)
        .zip(COLOURS)
        .map(|((load, curve), colour)| {
            let points: Vec<(f64, f64)> = times_of_figure().map(f64::log10).zip(curve).collect();
            Plot::Line(
                LinePlot::new()
                    .with_data(points)
                    .with_color(colour)
                    .with_legend(format!("Test {}", load.test)),
            )
        })
        .collect())
}

fn drawn(plots: Vec<Plot>, title: &str, y_label: &str, legend: LegendPosition) -> String {
    let layout = Layout::auto_from_plots(&plots)
        .with_title(title)
        .with_x_label("log10 of recovery time, s")
        .with_y_label(y_label)
        .with_legend_position(legend);
    let scene = Figure::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout])
        .with_cell_size(760.0, 480.0)
        .render();
    SvgBackend::default().render_scene(&scene)
}
