//! Figures of a bar: attenuation and phase velocity, the waves at the gauge and at the ends, and
//! the residual of the model.

use rodfigure::{Figure, Mark, Panel, Role};

use super::passages::Passages;
use super::separated::Waves;
use super::table::Line;
use crate::RodlabError;

/// Figure of the damping coefficient and the phase velocity with their bands.
pub(super) fn propagation(lines: &[Line]) -> Result<Figure, RodlabError> {
    let mut drawn = [Vec::new(), Vec::new()];
    for line in lines {
        let x = 1e-3 * line.frequency_hz;
        let [damping, _, speed] = line.half_widths()?;
        let values = [(line.gamma.re, damping), (line.phase_velocity(), speed)];
        for (drawn, (y, half)) in drawn.iter_mut().zip(values) {
            let y = if line.is_valid { y } else { f64::NAN };
            drawn.push((x, y, half));
        }
    }
    let panel = |drawn: &[(f64, f64, f64)], label: &str, unit: &str| {
        let edges = drawn.iter().map(|(x, y, half)| (*x, y - half, y + half));
        let line = drawn.iter().map(|(x, y, _)| (*x, *y));
        let marks = vec![
            Mark::band("95 % band", Role::First, edges),
            Mark::line(label, Role::First, line),
        ];
        Panel::new(("frequency", "kHz"), (label, unit), marks)
    };
    let [damping, speed] = &drawn;
    let panels = vec![
        panel(damping, "damping coefficient", "1/m"),
        panel(speed, "phase velocity", "m/s"),
    ];
    Ok(Figure::new("propagation", "Propagation of waves in the bar", panels).with_caption(
        "Valid lines with their 95 % bands. The curves include the effect of lateral inertia, for which the modulus is corrected.",
    ))
}

/// Figures of the first shot: its passages, its waves, and the residual of the model.
pub(super) fn waves(waves: &Waves, passages: &Passages) -> Vec<Figure> {
    let step = 1e3 / waves.rate_hz;
    let times = |n: usize| -> Vec<f64> { (0..n).map(|at| step * at as f64).collect() };
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let Some(largest) = passages.pulses.first().map(|pulse| peak(&pulse.history)) else {
        return Vec::new();
    };
    let scaled = |values: &[f64]| values.iter().map(|x| x / largest).collect::<Vec<f64>>();
    let panel = |label: &str, marks| {
        let time = ("time from the beginning of the record", "ms");
        Panel::new(time, (label, "of the peak at the first gauge"), marks)
    };
    let mut panels = Vec::new();
    for (pulse, returns) in passages.pulses.iter().zip(&waves.returns) {
        let x = times(pulse.history.len());
        let record = scaled(&pulse.history);
        let mut marks = vec![Mark::curve("record", Role::First, &x, record)];
        let mut at = |name: &str, sample: usize| {
            marks.push(Mark::at(name, step * sample as f64));
        };
        at("1", pulse.first_sample);
        if let Some([incident, reflected]) = &passages.windows {
            at("incident pulse to", incident.end);
            at("reflected pulse from", reflected.start);
            at("reflected pulse to", reflected.end);
        } else {
            for (number, time) in returns.iter().enumerate() {
                marks.push(Mark::at(format!("{}", number + 2), 1e3 * time));
            }
        }
        panels.push(panel("record minus its level at rest", marks));
    }
    let passed = Figure::new("passages", "Passages of the pulse", panels).with_caption(
        "The first shot. The passages of the pulse past a gauge are numbered: first its front, then its returns from the free end and from the struck end, as expected for the wave speed in the middle of the band. With one gauge, the windows are marked.",
    );
    let separated = waves.at.iter().map(|(place, along, against)| {
        let x = times(along.len());
        let marks = vec![
            Mark::curve("towards the free end", Role::First, &x, scaled(along)),
            Mark::curve("from the free end", Role::Second, &x, scaled(against)),
        ];
        panel(&format!("waves {place}"), marks)
    });
    let (name, title) = ("separated_waves", "Waves at the gauge and at the ends");
    let separated = Figure::new(name, title, separated.collect()).with_caption(
        "Computed from the first gauge and the free end, in the band of the valid lines. A wave that is traced back to the struck end grows, and ends correspondingly earlier.",
    );
    let x = times(waves.measured.len());
    let left: Vec<f64> = waves
        .measured
        .iter()
        .zip(&waves.predicted)
        .map(|(a, b)| a - b)
        .collect();
    let both = vec![
        Mark::curve("record", Role::First, &x, scaled(&waves.measured)),
        Mark::curve("model", Role::Reference, &x, scaled(&waves.predicted)),
    ];
    let left = Mark::curve("residual", Role::First, &x, scaled(&left));
    let panels = vec![
        panel("history", both),
        panel("record minus model", vec![left]),
    ];
    let model = Figure::new("model", "Model and record", panels).with_caption(format!(
        "The history at {} in the band of the valid lines: as recorded, and as predicted from the waves at the first gauge. Below: the residual.",
        waves.gauge
    ));
    vec![passed, separated, model]
}
