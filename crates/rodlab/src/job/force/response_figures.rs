//! Figures of a force from a response: force with bands, response, path, and choice of the
//! regularisation parameter.

use impulse::{ChosenParameter, ForceBand, Parameter, ReconstructedForce};
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::histories::milliseconds;
use super::response_answer::Bands;
use super::response_problem::Problem;
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

fn force(problem: &Problem<'_>, solved: &ReconstructedForce, bands: &Bands) -> Figure {
    let history = &solved.history;
    let time = milliseconds(history);
    let percent = 100.0 * bands.level;
    let band = |name: &str, role: Role, band: &ForceBand| {
        let edges = time.iter().zip(&band.lower).zip(&band.upper);
        let edges = edges.map(|((time, lower), upper)| (*time, *lower, *upper));
        Mark::band(format!("{name}, {percent:.0} %"), role, edges)
    };
    let mut marks = Vec::new();
    if let Some(known) = &bands.random {
        marks.push(band("whole history", Role::Second, &known.simultaneous));
        marks.push(band("at each time", Role::First, &known.pointwise));
    }
    marks.push(Mark::curve(
        "force",
        Role::First,
        &time,
        history.force().to_vec(),
    ));
    if let Some(measured) = &problem.measured {
        let (name, force) = ("measured force", measured.clone());
        marks.push(Mark::curve(name, Role::Reference, &time, force));
    }
    // shows the time in which the force acts, and half of its length on either side
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
    let response = Mark::curve("", Role::Second, &time, problem.first.samples.clone());
    let panels = vec![
        Panel::new(shown(), ("force", "N"), marks),
        Panel::new(shown(), ("response", problem.first.unit), vec![response]),
    ];
    Figure::new("force", "Force from the response", panels).with_caption(
        "Positive in compression; time from the first sample of the record. The bands include the part of the force that the regularisation removes.",
    )
}

/// Figure of the frequency response, shaded where it was not used.
fn path(problem: &Problem<'_>, solved: &ReconstructedForce) -> Figure {
    let path = &problem.first.path;
    let above_zero = path.frequency_hz.iter().skip(1);
    let kilohertz: Vec<f64> = above_zero.map(|f| 1e-3 * f).collect();
    let mut marks = Vec::new();
    if let Some(errors) = path.random_error() {
        let edges = path.values.iter().zip(&errors).skip(1);
        let edges = edges.zip(&kilohertz).map(|((value, error), f)| {
            let edge = |sign: f64| value.norm() * (1.0 + sign * 2.0 * error.magnitude);
            let positive = |edge: f64| if edge > 0.0 { edge } else { f64::NAN };
            (*f, positive(edge(-1.0)), positive(edge(1.0)))
        });
        marks.push(Mark::band("two standard errors", Role::First, edges));
    }
    let name = "response over force";
    let magnitudes = path.values.iter().skip(1).map(|h| h.norm()).collect();
    marks.push(Mark::curve(name, Role::First, &kilohertz, magnitudes));
    let half = 0.5e-3 * problem.sampling_rate_hz / problem.first.samples.len() as f64;
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
    let response = Axis::logarithmic("response over force", format!("{}/N", problem.first.unit));
    let panel =
        Panel::new(Axis::logarithmic("frequency", "kHz"), response, marks).with_greyed(greyed);
    let title = "Frequency response from the force to the response";
    Figure::new("path", title, vec![panel]).with_caption(
        "Where the frequency response is small, noise of the response is amplified in the force.",
    )
}

/// Figure of the L-curve, and of the function from which the parameter was chosen.
fn choice(chosen: &ChosenParameter) -> Figure {
    let nearest = chosen.curve.iter().min_by(|a, b| {
        let far = |point: &impulse::CurvePoint| (point.parameter / chosen.value).ln().abs();
        far(a).total_cmp(&far(b))
    });
    let place = |point: &impulse::CurvePoint| (point.squared_residual, point.squared_norm);
    let all = chosen.curve.iter().map(place);
    let mut corner = vec![Mark::line("all parameters", Role::First, all)];
    corner.extend(nearest.map(|point| Mark::points("chosen", Role::Second, [place(point)])));
    let (label, scale): (&str, fn(&str) -> Axis) = match chosen.method {
        Parameter::GeneralisedCrossValidation => {
            ("cross validation", |label| Axis::logarithmic(label, ""))
        }
        Parameter::Discrepancy => ("relative discrepancy", |label| Axis::linear(label, "")),
        _ => ("minus the curvature", |label| Axis::linear(label, "")),
    };
    let scores = chosen
        .curve
        .iter()
        .map(|point| (point.parameter, point.score));
    let method = vec![
        Mark::line("", Role::First, scores),
        Mark::at("chosen", chosen.value),
    ];
    let panels = vec![
        Panel::new(
            Axis::logarithmic("squared residual", ""),
            Axis::logarithmic("squared norm", ""),
            corner,
        ),
        Panel::new(Axis::logarithmic("parameter", ""), scale(label), method),
    ];
    let title = "Choice of the parameter of the regularisation";
    Figure::new("regularisation", title, panels).with_caption(
        "Above: penalised norm over residual. Below: the criterion of the method; the chosen parameter is at its minimum, or at its zero for the discrepancy principle.",
    )
}
