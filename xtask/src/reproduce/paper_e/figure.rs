//! Figures 5 and 6, and the impulse responses and mobilities behind them.

use impulse::{ForceHistory, Kernel, Quadrature, TimeGrid};
use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::LegendPosition;
use kuva::plot::{BandPlot, LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use num_complex::Complex64;

use super::super::{Error, Table};
use super::forces::Forces;
use super::measurement::Measurement;
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;

const GAUGES: &str = "#111827";
const MEASURED: &str = "#1d4ed8";
const PREDICTED: &str = "#c2410c";
const MARCHED: &str = "#15803d";

/// Time shown before contact, in ms, for the smearing due to the band limit.
const AHEAD: f64 = -0.1;

/// Draws histories of the cone (Figure 5) or of the cylinder (Figure 6), with the uncertainty of
/// (I).
pub(crate) fn histories(forces: &[&Forces], number: u32, until_ms: f64) -> String {
    let mut panels = Vec::new();
    let mut layouts = Vec::new();
    for one in forces {
        let name = one.face.name();
        let shown = |history: &ForceHistory, until_ms: f64| -> Vec<usize> {
            (0..history.force().len())
                .filter(|n| (AHEAD..until_ms).contains(&(1e3 * history.time_at(*n))))
                .collect()
        };
        let line = |history: &ForceHistory, until_ms: f64, colour: &str, legend: &str| {
            let curve: Vec<(f64, f64)> = shown(history, until_ms)
                .into_iter()
                .map(|n| (1e3 * history.time_at(n), 1e-3 * history.force()[n]))
                .collect();
            LinePlot::new()
                .with_data(curve)
                .with_color(colour)
                .with_legend(legend)
        };
        let gauged = one
            .rows
            .first()
            .and_then(|row| row.end)
            .map_or(until_ms, |end| 1e3 * end);
        let plots = vec![
            Plot::Line(
                line(&one.marched, until_ms, MARCHED, "(II) marched").with_stroke_width(3.0),
            ),
            Plot::Line(line(&one.measured, until_ms, MEASURED, "(I) on lines")),
            Plot::Line(line(&one.predicted, until_ms, PREDICTED, "(II) on lines")),
            Plot::Line(line(&one.gauges, gauged.min(until_ms), GAUGES, "gauges").with_dashed()),
        ];
        layouts.push(
            layout(&plots, until_ms)
                .with_title(format!(
                    "Figure {number}, virtual: {name}, {} m/s",
                    one.velocity
                ))
                .with_y_label("force, kN")
                .with_legend_position(LegendPosition::InsideTopRight),
        );
        panels.push(plots);

        let samples = shown(&one.stick, until_ms);
        let time: Vec<f64> = samples
            .iter()
            .map(|n| 1e3 * one.stick.time_at(*n))
            .collect();
        let off = |values: &[f64]| -> Vec<f64> {
            samples
                .iter()
                .map(|n| values[*n] - one.truth.force()[*n])
                .collect()
        };
        let found = off(one.stick.force());
        let plots = vec![
            Plot::Band(
                BandPlot::new(
                    time.clone(),
                    off(&one.stick_band.lower),
                    off(&one.stick_band.upper),
                )
                .with_color(MEASURED)
                .with_opacity(0.25),
            ),
            Plot::Line(
                LinePlot::new()
                    .with_data(time.into_iter().zip(found).collect::<Vec<_>>())
                    .with_color(MEASURED),
            ),
        ];
        layouts.push(
            layout(&plots, until_ms)
                .with_title(format!("{name}: error of (I) in its band of 95 %"))
                .with_y_label("force, N")
                .with_legend_position(LegendPosition::InsideTopRight),
        );
        panels.push(plots);
    }
    drawn(panels, layouts, (2, 2), (560.0, 340.0))
}

fn layout(plots: &[Plot], until_ms: f64) -> Layout {
    Layout::auto_from_plots(plots)
        .with_x_axis_min(AHEAD)
        .with_x_axis_max(until_ms)
        .with_x_label("time, ms")
}

/// Number of time steps of the impulse responses.
const STEPS: u32 = 256;

/// Responses of the faces to a unit impulse, without the jump at time 0: measured, and predicted
/// with the same band limit.
pub(crate) struct Responses {
    /// Times in ms.
    time: Vec<f64>,
    /// Measured and predicted, in m/(N s²).
    of_faces: Vec<[Vec<f64>; 2]>,
}

impl Responses {
    pub(crate) fn of(paper: &PaperE, measurements: &[Measurement]) -> Result<Self, Error> {
        // half of the band is omitted from the spectra, so that twice the sample period would
        // suffice
        let grid = TimeGrid {
            time_step: 0.5 * paper.sample_period,
            n_steps: STEPS as usize,
        };
        let mut responses = Self {
            // the first steps contain the jump
            time: (2..STEPS)
                .map(|n| 1e3 * grid.time_step * f64::from(n))
                .collect(),
            of_faces: Vec::new(),
        };
        for (face, measurement) in Face::ALL.into_iter().zip(measurements) {
            let predicted = impulse::lines_of(
                &paper.causal(face)?,
                measurement.frequency_step_hz,
                paper.n_lines(),
            )?;
            let response = |mobility: &[Complex64]| -> Result<Vec<f64>, Error> {
                let body = super::measurement::Laboratory(paper).on_lines(face, mobility, None)?;
                let kernel = Kernel::of(&body, grid, Quadrature::CellAverages)?;
                let weights = kernel.weights().iter().skip(2);
                Ok(weights.map(|weight| weight / grid.time_step).collect())
            };
            responses.of_faces.push([
                response(&measurement.larger_force.mobility)?,
                response(&predicted)?,
            ]);
        }
        Ok(responses)
    }

    pub(crate) fn table(&self) -> Table {
        let mut headings = vec!["time, ms".to_owned()];
        for face in Face::ALL {
            headings.push(format!("{} measured, m/(N s^2)", face.name()));
            headings.push(format!("{} predicted, m/(N s^2)", face.name()));
        }
        let mut table = Table::new(&headings.iter().map(String::as_str).collect::<Vec<_>>());
        for (n, time) in self.time.iter().enumerate() {
            let mut cells = vec![format!("{time:.3}")];
            for pair in &self.of_faces {
                cells.extend(pair.iter().map(|values| format!("{:.4e}", values[n])));
            }
            table.row(cells);
        }
        table
    }

    pub(crate) fn figure(&self) -> String {
        let (mut panels, mut layouts) = (Vec::new(), Vec::new());
        for (face, [measured, predicted]) in Face::ALL.into_iter().zip(&self.of_faces) {
            let curve = |values: &[f64]| -> Vec<(f64, f64)> {
                self.time
                    .iter()
                    .copied()
                    .zip(values.iter().copied())
                    .collect()
            };
            let plots = vec![
                Plot::Scatter(
                    ScatterPlot::new()
                        .with_data(curve(measured))
                        .with_color(MEASURED)
                        .with_size(1.8)
                        .with_legend("measured"),
                ),
                Plot::Line(
                    LinePlot::new()
                        .with_data(curve(predicted))
                        .with_color(PREDICTED)
                        .with_legend("predicted"),
                ),
            ];
            layouts.push(
                Layout::auto_from_plots(&plots)
                    .with_title(format!("Impulse response of {}, virtual", face.name()))
                    .with_x_label("time, ms")
                    .with_y_label("G, m/(N s²)")
                    .with_legend_position(LegendPosition::InsideTopRight),
            );
            panels.push(plots);
        }
        drawn(panels, layouts, (2, 2), (520.0, 320.0))
    }
}

/// Draws the magnitudes of the mobilities, measured and by eq. 7.
pub(crate) fn mobilities(paper: &PaperE, measurements: &[Measurement]) -> Result<String, Error> {
    let (mut panels, mut layouts) = (Vec::new(), Vec::new());
    for (face, measurement) in Face::ALL.into_iter().zip(measurements) {
        let step_hz = measurement.frequency_step_hz;
        let predicted = impulse::lines_of(&paper.printed(face)?, step_hz, paper.n_lines())?;
        let curve = |mobility: &[Complex64], every: usize| -> Vec<(f64, f64)> {
            (1..mobility.len())
                .step_by(every)
                .map(|n| {
                    #[expect(clippy::cast_precision_loss, reason = "a thousand lines")]
                    let frequency = 1e-3 * n as f64 * step_hz;
                    (frequency, mobility[n].norm().log10())
                })
                .collect()
        };
        let plots = vec![
            Plot::Scatter(
                ScatterPlot::new()
                    .with_data(curve(&measurement.larger_force.mobility, 4))
                    .with_color(MEASURED)
                    .with_size(1.8)
                    .with_legend("measured"),
            ),
            Plot::Line(
                LinePlot::new()
                    .with_data(curve(&predicted, 1))
                    .with_color(PREDICTED)
                    .with_legend("predicted, eq. 7"),
            ),
        ];
        layouts.push(
            Layout::auto_from_plots(&plots)
                .with_title(format!("Mobility of {}, virtual", face.name()))
                .with_x_label("frequency, kHz")
                .with_y_label("log10 of |G|, s/kg")
                .with_legend_position(LegendPosition::InsideTopRight),
        );
        panels.push(plots);
    }
    Ok(drawn(panels, layouts, (2, 2), (520.0, 320.0)))
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
