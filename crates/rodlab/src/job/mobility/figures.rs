//! Figures of a mobility: Bode diagram with coherence, Nyquist diagram, and impulse response.

use std::f64::consts::TAU;

use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::MobilitySheet;
use super::known::Known;
use super::screening::ImpulseResponse;

#[allow(
    clippy::indexing_slicing,
    reason = "`n` is the index of a line of the mobility, and every list has one element per line"
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
    let line = |name: &str, role: Role, y: Vec<f64>| Mark::curve(name, role, &kilohertz, y);
    let norm = |n: usize| response.values[n].norm();
    let phase = |n: usize| response.values[n].arg().to_degrees();
    let mut magnitude = Vec::new();
    let mut angle = Vec::new();
    if let Some(errors) = response.random_error() {
        let edge = |n: usize, sign: f64| {
            let value = norm(n) * (1.0 + sign * 2.0 * errors[n].magnitude);
            believed(n, if value > 0.0 { value } else { f64::NAN })
        };
        let places = || lines().zip(&kilohertz);
        let edges = places().map(|(n, f)| (*f, edge(n, -1.0), edge(n, 1.0)));
        magnitude.push(Mark::band("two standard errors", Role::First, edges));
        let edge = |n: usize, sign: f64| {
            let error = errors[n].phase.to_degrees().min(90.0);
            believed(n, phase(n) + sign * 2.0 * error)
        };
        let edges = places().map(|(n, f)| (*f, edge(n, -1.0), edge(n, 1.0)));
        angle.push(Mark::band("", Role::First, edges));
    }
    if lines().any(|n| !known.is_valid(n)) {
        magnitude.push(line("not reliable", Role::Faint, of(&norm)));
    }
    if let Some(weighed) = sheet.support.weighed() {
        let rigid = of(&|n| 1.0 / (TAU * response.frequency_hz[n] * weighed.mass));
        magnitude.push(line("weighed mass, 1/(ωM)", Role::Reference, rigid));
    }
    magnitude.push(line("mobility", Role::First, of(&|n| believed(n, norm(n)))));
    angle.push(line("", Role::First, of(&|n| believed(n, phase(n)))));
    let panel = |y: Axis, marks: Vec<Mark>, greyed: Vec<Greyed>| {
        Panel::new(Axis::logarithmic("frequency", "kHz"), y, marks).with_greyed(greyed)
    };
    let completed = || {
        let until = response.frequency_hz.get(known.first_measured);
        until
            .filter(|_| known.first_measured > 0)
            .map(|to| Greyed {
                from: f64::NEG_INFINITY,
                to: 1e-3 * to,
                because: "from the weighed mass".to_owned(),
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
            _ => ["heavy hammer", "light hammer"],
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
    Figure::new("mobility", "Mobility of the face", panels)
        .with_caption("A passive body has a phase between -90 and 90 degrees.")
}

pub(super) fn nyquist(known: &Known) -> Figure {
    let response = &known.mobility;
    let values = response.values.iter().enumerate().skip(1);
    let points = values.map(|(n, value)| {
        if known.is_valid(n) {
            (value.re, value.im)
        } else {
            (f64::NAN, f64::NAN)
        }
    });
    let marks = vec![Mark::line("", Role::First, points)];
    let panel = Panel {
        equal_axes: true,
        ..Panel::new(
            ("real part", "m/(N s)"),
            ("imaginary part", "m/(N s)"),
            marks,
        )
    };
    Figure::new("nyquist", "Mobility in the complex plane", vec![panel]).with_caption(
        "Resonances are loops to the right; a passive body stays right of the vertical axis. For a free body, the curve starts at large negative imaginary parts below the first resonance.",
    )
}

pub(super) fn impulse_response(response: &ImpulseResponse) -> Figure {
    let milliseconds: Vec<f64> = response.time.iter().map(|t| 1e3 * t).collect();
    let values = response.values.clone();
    let mut marks = vec![Mark::curve(
        "impulse response",
        Role::First,
        &milliseconds,
        values,
    )];
    if let Some(rigid) = response.rigid {
        let points = milliseconds.into_iter().map(|time| (time, rigid));
        marks.push(Mark::line("of the mass, 1/M", Role::Reference, points));
    }
    let panel = Panel::new(("time", "ms"), ("impulse response", "1/kg"), marks);
    let title = "Velocity of the face after a unit impulse";
    Figure::new("impulse_response", title, vec![panel]).with_caption(
        "Means over one step. The immediate response, the velocity during the force itself, is left out.",
    )
}
