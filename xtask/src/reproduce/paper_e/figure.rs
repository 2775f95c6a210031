//! Figures 5 and 6, and the impulse responses and mobilities from which they are computed.

use impulse::ForceHistory;
use num_complex::Complex64;
use rodfigure::{Axis, Mark, Panel, Role};

use super::super::{Error, drawn};
use super::forces::Forces;
use super::measurement::Measurement;
use super::responses::Responses;
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;

/// Start of the time axis, in ms, relative to the start of the contact, which the band limit
/// smears.
const AHEAD: f64 = -0.1;

/// Draws the histories of the cone (Figure 5) or of the cylinder (Figure 6), with the uncertainty
/// of method (I).
pub(crate) fn histories(forces: &[&Forces], number: u32, until_ms: f64) -> (String, String) {
    let time = || Axis::linear("time", "ms").within([AHEAD, until_ms]);
    let mut panels = Vec::new();
    for one in forces {
        let shown = |history: &ForceHistory, until_ms: f64| -> Vec<(usize, f64)> {
            (0..history.force().len())
                .map(|n| (n, 1e3 * history.time_at(n)))
                .filter(|(_, time)| (AHEAD..until_ms).contains(time))
                .collect()
        };
        let line = |name: &str, role, history: &ForceHistory, until_ms: f64| {
            let shown = shown(history, until_ms).into_iter();
            let points = shown.map(|(n, time)| (time, 1e-3 * history.force()[n]));
            Mark::line(name, role, points)
        };
        let end = one.rows.first().and_then(|row| row.end);
        let gauged = end.map_or(until_ms, |end| until_ms.min(1e3 * end));
        let force = format!("force of {} at {} m/s", one.face.name(), one.velocity);
        let marks = vec![
            line("(I) on lines", Role::First, &one.measured, until_ms),
            line("(II) on lines", Role::Second, &one.predicted, until_ms),
            line("(II) marched", Role::Third, &one.marched, until_ms),
            line("gauges", Role::Reference, &one.gauges, gauged),
        ];
        panels.push(Panel::new(time(), (force, "kN"), marks));

        let samples = shown(&one.stick, until_ms).into_iter();
        let (truth, band) = (one.truth.force(), &one.stick_band);
        let found = samples.clone();
        let found = found.map(|(n, time)| (time, one.stick.force()[n] - truth[n]));
        let edges = samples.map(|(n, time)| (time, band.lower[n], band.upper[n], truth[n]));
        let edges = edges.map(|(time, lower, upper, truth)| (time, lower - truth, upper - truth));
        let reach = |reach: f64, (_, lower, upper): (f64, f64, f64)| reach.max(-lower).max(upper);
        let reach = 1.1 * edges.clone().fold(0.0, reach);
        let marks = vec![
            Mark::band("band of 95 %", Role::First, edges),
            Mark::line("(I)", Role::First, found),
        ];
        let error = Axis::linear(format!("error of (I), {}", one.face.name()), "N");
        panels.push(Panel::new(time(), error.within([-reach, reach]), marks));
    }
    let title = format!("Paper E, Figure {number}, virtual");
    drawn(&format!("figure-{number}"), &title, panels)
}

/// Draws the impulse responses.
pub(crate) fn impulse_responses(responses: &Responses) -> (String, String) {
    let faces = Face::ALL.into_iter().zip(&responses.of_faces);
    let panels = faces.map(|(face, [measured, predicted])| {
        let time = || responses.time.iter().copied();
        let [measured, predicted] = [measured, predicted].map(|values| time().zip(values.clone()));
        let marks = compared(measured, "predicted", predicted);
        let label = format!("G of {}", face.name());
        Panel::new(("time", "ms"), (label, "m/(N s^2)"), marks)
    });
    let title = "Paper E: impulse responses, virtual";
    drawn("impulse-responses", title, panels.collect())
}

/// Draws the magnitudes of the mobilities, measured and computed by eq. 7.
pub(crate) fn mobilities(
    paper: &PaperE,
    measurements: &[Measurement],
) -> Result<(String, String), Error> {
    let mut panels = Vec::new();
    for (face, measurement) in Face::ALL.into_iter().zip(measurements) {
        let step_hz = measurement.frequency_step_hz;
        let predicted = impulse::lines_of(&paper.printed(face)?, step_hz, paper.n_lines())?;
        let curve = |mobility: &[Complex64], every: usize| -> Vec<(f64, f64)> {
            let lines = (0_u32..).zip(mobility).skip(1).step_by(every);
            lines
                .map(|(n, mobility)| (1e-3 * f64::from(n) * step_hz, mobility.norm()))
                .collect()
        };
        let magnitude = Axis::logarithmic(format!("|G| of {}", face.name()), "s/kg");
        let measured = curve(&measurement.larger_force.mobility, 4);
        let marks = compared(measured, "predicted, eq. 7", curve(&predicted, 1));
        panels.push(Panel::new(("frequency", "kHz"), magnitude, marks));
    }
    Ok(drawn("mobilities", "Paper E: mobilities, virtual", panels))
}

/// Returns measured points and a predicted line.
fn compared(
    measured: impl IntoIterator<Item = (f64, f64)>,
    name: &str,
    predicted: impl IntoIterator<Item = (f64, f64)>,
) -> Vec<Mark> {
    vec![
        Mark::points("measured", Role::First, measured),
        Mark::line(name, Role::Second, predicted),
    ]
}
