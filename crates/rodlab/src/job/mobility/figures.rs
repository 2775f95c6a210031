//! Figures of a mobility: Bode with coherence, Nyquist, impulse response.

use std::f64::consts::TAU;

use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::MobilitySheet;
use super::known::Known;
use super::screening::ImpulseResponse;

#[allow(
    clippy::indexing_slicing,
    reason = "`n` counts the lines of the mobility, and every list has an element for each"
)]
pub(super) fn bode(known: &Known, sheet: &MobilitySheet) -> Figure {
    let response = &known.mobility;
    // a logarithmic axis has no 0 Hz
    let lines = || 1..response.values.len();
    let kilohertz: Vec<f64> = lines().map(|n| 1e-3 * response.frequency_hz[n]).collect();
    let of = |value: &dyn Fn(usize) -> f64| lines().map(value).collect::<Vec<f64>>();
    let believed = |line: usize, value: f64| {
        if known.is_valid(line) {
            value
        } else {
            f64::NAN
        }
    };
    let line = |name: &str, role: Role, y: Vec<f64>| Mark::Line {
        name: name.to_owned(),
        role,
        x: kilohertz.clone(),
        y,
    };
    let norm = |n: usize| response.values[n].norm();
    let phase = |n: usize| response.values[n].arg().to_degrees();
    let mut magnitude = Vec::new();
    let mut angle = Vec::new();
    if let Some(errors) = response.random_error() {
        let edge = |sign: f64| {
            of(&|n| {
                let value = norm(n) * (1.0 + sign * 2.0 * errors[n].magnitude);
                believed(n, if value > 0.0 { value } else { f64::NAN })
            })
        };
        magnitude.push(Mark::Band {
            name: "two standard errors".to_owned(),
            role: Role::First,
            x: kilohertz.clone(),
            lower: edge(-1.0),
            upper: edge(1.0),
        });
        let edge = |sign: f64| {
            of(&|n| {
                believed(
                    n,
                    phase(n) + sign * 2.0 * errors[n].phase.to_degrees().min(90.0),
                )
            })
        };
        angle.push(Mark::Band {
            name: String::new(),
            role: Role::First,
            x: kilohertz.clone(),
            lower: edge(-1.0),
            upper: edge(1.0),
        });
    }
    if lines().any(|n| !known.is_valid(n)) {
        magnitude.push(line("not believed", Role::Faint, of(&norm)));
    }
    if let Some(weighed) = sheet.support.weighed() {
        let rigid = of(&|n| 1.0 / (TAU * response.frequency_hz[n] * weighed.mass));
        magnitude.push(line("weighed mass, 1/(ωM)", Role::Reference, rigid));
    }
    magnitude.push(line("mobility", Role::First, of(&|n| believed(n, norm(n)))));
    angle.push(line("", Role::First, of(&|n| believed(n, phase(n)))));
    let panel = |y: Axis, marks: Vec<Mark>, greyed: Vec<Greyed>| Panel {
        x: Axis::logarithmic("frequency", "kHz"),
        y,
        marks,
        greyed,
        equal_axes: false,
    };
    let completed = || {
        let until = response.frequency_hz.get(known.first_measured);
        until
            .filter(|_| known.first_measured > 0)
            .map(|to| Greyed {
                from: f64::NEG_INFINITY,
                to: 1e-3 * to,
                because: "by the weighed mass".to_owned(),
            })
            .into_iter()
            .collect::<Vec<_>>()
    };
    let mut panels = vec![
        panel(
            Axis::logarithmic("mobility", "m/(N s)"),
            magnitude,
            completed(),
        ),
        panel(
            Axis::linear("phase", "deg").within([-100.0, 100.0]),
            angle,
            completed(),
        ),
    ];
    let coherences: Vec<&Vec<f64>> = if known.coherences.is_empty() {
        response.coherence.iter().collect()
    } else {
        known.coherences.iter().collect()
    };
    if !coherences.is_empty() {
        let names = match coherences.len() {
            1 => [""; 2],
            _ => ["low", "high"],
        };
        let marks = coherences
            .iter()
            .zip(names)
            .enumerate()
            .map(|(at, (values, name))| line(name, Role::of_series(at), of(&|n| values[n])))
            .collect();
        panels.push(panel(
            Axis::linear("coherence", "").within([0.0, 1.05]),
            marks,
            Vec::new(),
        ));
    }
    Figure {
        name: "mobility".to_owned(),
        title: "Mobility of the face".to_owned(),
        caption: "A passive body has a phase between -90 and 90 degrees.".to_owned(),
        panels,
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "`n` counts the lines of the mobility, and every list has an element for each"
)]
pub(super) fn nyquist(known: &Known) -> Figure {
    let response = &known.mobility;
    let of = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (1..response.values.len())
            .map(|n| {
                if known.is_valid(n) {
                    value(n)
                } else {
                    f64::NAN
                }
            })
            .collect()
    };
    Figure {
        name: "nyquist".to_owned(),
        title: "Mobility in the complex plane".to_owned(),
        caption: "Resonances are loops to the right; a passive body stays right of the vertical axis. Below the first resonance of a free body the curve comes from far below."
            .to_owned(),
        panels: vec![Panel {
            x: Axis::linear("real part", "m/(N s)"),
            y: Axis::linear("imaginary part", "m/(N s)"),
            marks: vec![Mark::Line {
                name: String::new(),
                role: Role::First,
                x: of(&|n| response.values[n].re),
                y: of(&|n| response.values[n].im),
            }],
            greyed: Vec::new(),
            equal_axes: true,
        }],
    }
}

pub(super) fn impulse_response(response: &ImpulseResponse) -> Figure {
    let milliseconds: Vec<f64> = response.time.iter().map(|t| 1e3 * t).collect();
    let mut marks = vec![Mark::Line {
        name: "impulse response".to_owned(),
        role: Role::First,
        x: milliseconds.clone(),
        y: response.values.clone(),
    }];
    if let Some(rigid) = response.rigid {
        marks.push(Mark::Line {
            name: "of the mass, 1/M".to_owned(),
            role: Role::Reference,
            y: vec![rigid; milliseconds.len()],
            x: milliseconds,
        });
    }
    Figure {
        name: "impulse_response".to_owned(),
        title: "Velocity of the face after a unit impulse".to_owned(),
        caption: "Means over one step. The answer at once, the velocity under the force itself, is left out."
            .to_owned(),
        panels: vec![Panel {
            x: Axis::linear("time", "ms"),
            y: Axis::linear("impulse response", "1/kg"),
            marks,
            greyed: Vec::new(),
            equal_axes: false,
        }],
    }
}
