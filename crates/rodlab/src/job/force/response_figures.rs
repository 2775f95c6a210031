//! Figures of a force from a response: force with bands, response, path, choice of the parameter.

use impulse::{ChosenParameter, ForceBand, Parameter, ReconstructedForce};
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::response::Problem;
use super::response_answer::Bands;
use super::response_solve::window;

pub(super) fn all(
    problem: &Problem<'_>,
    solved: &ReconstructedForce,
    bands: &Bands,
) -> Vec<Figure> {
    let mut figures = vec![force(problem, solved, bands), path(problem, solved)];
    let chosen = solved.parameter.as_ref().filter(|p| !p.curve.is_empty());
    figures.extend(chosen.map(choice));
    figures
}

fn panel(x: Axis, y: Axis, marks: Vec<Mark>) -> Panel {
    Panel {
        x,
        y,
        marks,
        greyed: Vec::new(),
        equal_axes: false,
    }
}

fn force(problem: &Problem<'_>, solved: &ReconstructedForce, bands: &Bands) -> Figure {
    let history = &solved.history;
    let time: Vec<f64> = (0..history.force().len())
        .map(|n| 1e3 * history.time_at(n))
        .collect();
    let line = |name: &str, role: Role, y: Vec<f64>| Mark::Line {
        name: name.to_owned(),
        role,
        x: time.clone(),
        y,
    };
    let band = |name: String, role: Role, band: &ForceBand| Mark::Band {
        name,
        role,
        x: time.clone(),
        lower: band.lower.clone(),
        upper: band.upper.clone(),
    };
    let percent = 100.0 * bands.level;
    let mut marks = Vec::new();
    if let Some((_, _, by_hits)) = &bands.scatter {
        marks.push(band(
            format!("by calibration hits, {percent:.0} %"),
            Role::Third,
            by_hits,
        ));
    }
    if let Some(known) = &bands.random {
        marks.push(band(
            format!("whole history, {percent:.0} %"),
            Role::Second,
            &known.simultaneous,
        ));
        marks.push(band(
            format!("at each time, {percent:.0} %"),
            Role::First,
            &known.pointwise,
        ));
    }
    marks.push(line("force", Role::First, history.force().to_vec()));
    if let Some(measured) = &problem.measured {
        marks.push(line("measured force", Role::Reference, measured.clone()));
    }
    // the time in which the force acts, with as much again on either side
    let inside = window(problem);
    let (from, to) = (
        1e3 * history.time_at(inside.start),
        1e3 * history.time_at(inside.end - 1),
    );
    let margin = if problem.acting.is_some() {
        0.5 * (to - from)
    } else {
        0.0
    };
    let shown = || Axis::linear("time", "ms").within([from - margin, to + margin]);
    Figure {
        name: "force".to_owned(),
        title: "Force from the response".to_owned(),
        caption: "Positive in compression; time from the first sample of the record. What the regularisation takes off is in the bands."
            .to_owned(),
        panels: vec![
            panel(shown(), Axis::linear("force", "N"), marks),
            panel(
                shown(),
                Axis::linear("response", problem.unit),
                vec![line("", Role::Second, problem.samples.clone())],
            ),
        ],
    }
}

/// The frequency response, shaded where it was not used.
fn path(problem: &Problem<'_>, solved: &ReconstructedForce) -> Figure {
    let path = &problem.path;
    let above_zero = path.frequency_hz.iter().skip(1);
    let kilohertz: Vec<f64> = above_zero.map(|f| 1e-3 * f).collect();
    let mut marks = Vec::new();
    if let Some(errors) = path.random_error() {
        let edge = |sign: f64| -> Vec<f64> {
            let lines = path.values.iter().zip(&errors).skip(1);
            lines
                .map(|(value, error)| value.norm() * (1.0 + sign * 2.0 * error.magnitude))
                .map(|value| if value > 0.0 { value } else { f64::NAN })
                .collect()
        };
        marks.push(Mark::Band {
            name: "two standard errors".to_owned(),
            role: Role::First,
            x: kilohertz.clone(),
            lower: edge(-1.0),
            upper: edge(1.0),
        });
    }
    marks.push(Mark::Line {
        name: "response over force".to_owned(),
        role: Role::First,
        y: path.values.iter().skip(1).map(|h| h.norm()).collect(),
        x: kilohertz,
    });
    let half = 0.5e-3 * problem.sampling_rate_hz / problem.samples.len() as f64;
    let mut greyed: Vec<Greyed> = Vec::new();
    for line in &solved.excluded {
        let at = 1e-3 * line.frequency_hz;
        match greyed.last_mut() {
            Some(last) if at - half <= last.to * (1.0 + 1e-9) => last.to = at + half,
            _ => greyed.push(Greyed {
                from: at - half,
                to: at + half,
                because: "not used".to_owned(),
            }),
        }
    }
    Figure {
        name: "path".to_owned(),
        title: "Frequency response from the force to the response".to_owned(),
        caption: "Where it is small, noise of the response becomes force.".to_owned(),
        panels: vec![Panel {
            greyed,
            ..panel(
                Axis::logarithmic("frequency", "kHz"),
                Axis::logarithmic("response over force", format!("{}/N", problem.unit)),
                marks,
            )
        }],
    }
}

/// The L-curve and the function evaluated by the method.
fn choice(chosen: &ChosenParameter) -> Figure {
    let of = |value: &dyn Fn(&impulse::CurvePoint) -> f64| -> Vec<f64> {
        chosen.curve.iter().map(value).collect()
    };
    let nearest = chosen.curve.iter().min_by(|a, b| {
        let far = |point: &impulse::CurvePoint| (point.parameter / chosen.value).ln().abs();
        far(a).total_cmp(&far(b))
    });
    let mut corner = vec![Mark::Line {
        name: "all parameters".to_owned(),
        role: Role::First,
        x: of(&|point| point.squared_residual),
        y: of(&|point| point.squared_norm),
    }];
    corner.extend(nearest.map(|point| Mark::Points {
        name: "chosen".to_owned(),
        role: Role::Second,
        x: vec![point.squared_residual],
        y: vec![point.squared_norm],
        error: Vec::new(),
    }));
    let (label, scale): (&str, fn(&str) -> Axis) = match chosen.method {
        Parameter::GeneralisedCrossValidation => {
            ("cross validation", |label| Axis::logarithmic(label, ""))
        }
        Parameter::Discrepancy => ("relative discrepancy", |label| Axis::linear(label, "")),
        _ => ("minus the curvature", |label| Axis::linear(label, "")),
    };
    Figure {
        name: "regularisation".to_owned(),
        title: "Choice of the parameter of the regularisation".to_owned(),
        caption: "Above, penalised norm over residual; below, what the method looks at: its minimum, or its zero for the discrepancy."
            .to_owned(),
        panels: vec![
            panel(
                Axis::logarithmic("squared residual", ""),
                Axis::logarithmic("squared norm", ""),
                corner,
            ),
            panel(
                Axis::logarithmic("parameter", ""),
                scale(label),
                vec![
                    Mark::Line {
                        name: String::new(),
                        role: Role::First,
                        x: of(&|point| point.parameter),
                        y: of(&|point| point.score),
                    },
                    Mark::At {
                        name: "chosen".to_owned(),
                        x: chosen.value,
                    },
                ],
            ),
        ],
    }
}
