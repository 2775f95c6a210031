//! Figures: attenuation and phase velocity, the waves at the gauge and at the ends, what the model
//! leaves.

use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::passages::Passages;
use super::separated::Waves;
use super::table::Line;
use crate::RodlabError;

fn panel(x: Axis, y: Axis, marks: Vec<Mark>) -> Panel {
    Panel {
        x,
        y,
        marks,
        greyed: Vec::new(),
        equal_axes: false,
    }
}

fn line(name: impl Into<String>, role: Role, x: &[f64], y: Vec<f64>) -> Mark {
    Mark::Line {
        name: name.into(),
        role,
        x: x.to_vec(),
        y,
    }
}

/// Damping coefficient and phase velocity with their bands.
pub(super) fn propagation(lines: &[Line]) -> Result<Figure, RodlabError> {
    let x: Vec<f64> = lines.iter().map(|line| 1e-3 * line.frequency_hz).collect();
    let mut drawn = [Vec::new(), Vec::new()];
    for line in lines {
        let [damping, _, speed] = line.half_widths()?;
        let values = [(line.gamma.re, damping), (line.phase_velocity(), speed)];
        for (drawn, value) in drawn.iter_mut().zip(values) {
            drawn.push(if line.is_valid {
                value
            } else {
                (f64::NAN, f64::NAN)
            });
        }
    }
    let of = |drawn: &[(f64, f64)], label: &str, unit: &str| {
        let edge = |sign: f64| drawn.iter().map(|(y, half)| y + sign * half).collect();
        let marks = vec![
            Mark::Band {
                name: "95 %".to_owned(),
                role: Role::First,
                x: x.clone(),
                lower: edge(-1.0),
                upper: edge(1.0),
            },
            line(
                label,
                Role::First,
                &x,
                drawn.iter().map(|(y, _)| *y).collect(),
            ),
        ];
        panel(
            Axis::linear("frequency", "kHz"),
            Axis::linear(label, unit),
            marks,
        )
    };
    let [damping, speed] = &drawn;
    Ok(Figure {
        name: "propagation".to_owned(),
        title: "Propagation of waves in the bar".to_owned(),
        caption: "Valid lines with their bands of 95 %, with the lateral inertia that the modulus is corrected for.".to_owned(),
        panels: vec![
            of(damping, "damping coefficient", "1/m"),
            of(speed, "phase velocity", "m/s"),
        ],
    })
}

/// The first shot: its passages, its waves, and what the model leaves.
pub(super) fn waves(waves: &Waves, passages: &Passages) -> Vec<Figure> {
    let step = 1e3 / waves.rate_hz;
    let times = |n: usize| -> Vec<f64> { (0..n).map(|at| step * at as f64).collect() };
    let time = || Axis::linear("time from the beginning of the record", "ms");
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let Some(largest) = passages.histories.first().map(|history| peak(history)) else {
        return Vec::new();
    };
    let scaled = |values: &[f64]| values.iter().map(|x| x / largest).collect::<Vec<f64>>();
    let axis = |label: &str| Axis::linear(label, "of the peak at the first gauge");
    let mut panels = Vec::new();
    let fronts = passages.first.iter().zip(&waves.returns);
    for (history, (first, returns)) in passages.histories.iter().zip(fronts) {
        let mut marks = vec![line(
            "record",
            Role::First,
            &times(history.len()),
            scaled(history),
        )];
        let mut at = |name: &str, sample: usize| {
            marks.push(Mark::At {
                name: name.to_owned(),
                x: step * sample as f64,
            });
        };
        at("1", *first);
        if let Some([incident, reflected]) = &passages.windows {
            at("incident pulse to", incident.end);
            at("reflected pulse from", reflected.start);
            at("reflected pulse to", reflected.end);
        } else {
            for (number, time) in returns.iter().enumerate() {
                marks.push(Mark::At {
                    name: format!("{}", number + 2),
                    x: 1e3 * time,
                });
            }
        }
        panels.push(panel(time(), axis("record less its level"), marks));
    }
    let passed = Figure {
        name: "passages".to_owned(),
        title: "Passages of the pulse".to_owned(),
        caption: "The first shot. Passages by a gauge are numbered: its front, then what comes back from the free and from the struck end with the speed in the middle \
                  of the band; of one gauge the windows are marked.".to_owned(),
        panels,
    };
    let separated = waves.at.iter().map(|(place, along, against)| {
        let x = times(along.len());
        let marks = vec![
            line("towards the free end", Role::First, &x, scaled(along)),
            line("from the free end", Role::Second, &x, scaled(against)),
        ];
        panel(time(), axis(&format!("waves {place}")), marks)
    });
    let separated = Figure {
        name: "separated_waves".to_owned(),
        title: "Waves at the gauge and at the ends".to_owned(),
        caption: "By the first gauge and the free end, in the band of the valid lines. A wave that is carried back to the struck end grows, and ends as much earlier."
            .to_owned(),
        panels: separated.collect(),
    };
    let x = times(waves.measured.len());
    let left: Vec<f64> = waves
        .measured
        .iter()
        .zip(&waves.predicted)
        .map(|(a, b)| a - b)
        .collect();
    let model = Figure {
        name: "model".to_owned(),
        title: "Model and record".to_owned(),
        caption: format!(
            "What the waves of the first gauge ask for at {}, and what was recorded there, in the band of the valid lines; below what is left.",
            waves.gauge
        ),
        panels: vec![
            panel(
                time(),
                axis("history"),
                vec![
                    line("record", Role::First, &x, scaled(&waves.measured)),
                    line("model", Role::Reference, &x, scaled(&waves.predicted)),
                ],
            ),
            panel(
                time(),
                axis("record less model"),
                vec![line("left", Role::First, &x, scaled(&left))],
            ),
        ],
    };
    vec![passed, separated, model]
}
