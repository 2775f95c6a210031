//! Recovery curves, residuals, the master curve of all tests, and predictions.

use cmod::CmodError;
use cmod::recovery::RecoveryTest;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::{Found, curves};

/// Half the width of a band, in standard errors.
const BAND: f64 = 2.0;

pub(super) fn figures(found: &Found<'_>) -> Result<Vec<Figure>, CmodError> {
    let mut figures = vec![recovery(found)?, one_curve(found)];
    if !found.predictions.is_empty() {
        figures.push(predictions(found)?);
    }
    Ok(figures)
}

/// Factor from a change of the loss factor to the number on the axis, and the axis.
fn change_axis(found: &Found<'_>) -> (f64, Axis) {
    found.sheet.virgin_loss_factor.as_ref().map_or_else(
        || (1.0, Axis::linear("change of the loss factor", "")),
        |virgin| {
            let label = "change of the loss factor by its virgin value";
            (
                100.0 / virgin.with_uncertainty().value,
                Axis::linear(label, "%"),
            )
        },
    )
}

fn time_axis() -> Axis {
    Axis::logarithmic("time after unloading", "s")
}

/// Line and band of the model after the load of `test`.
fn model(
    found: &Found<'_>,
    test: &RecoveryTest,
    scale: f64,
    (role, name): (Role, &str),
) -> Result<[Mark; 2], CmodError> {
    let times = curves::times(&found.tests);
    let curve = found.curve(test, &times)?;
    let edge = |sign: f64| -> Vec<f64> {
        let at = |point: &cmod::recovery::fit::PredictedChange| {
            scale * (point.change + sign * BAND * point.standard_error)
        };
        curve.iter().map(at).map(finite_or_gap).collect()
    };
    Ok([
        Mark::Band {
            name: String::new(),
            role,
            x: times.clone(),
            lower: edge(-1.0),
            upper: edge(1.0),
        },
        Mark::Line {
            name: name.to_owned(),
            role,
            y: curve.iter().map(|point| scale * point.change).collect(),
            x: times,
        },
    ])
}

/// Replaces an edge not determined by the tests with a gap.
fn finite_or_gap(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

fn recovery(found: &Found<'_>) -> Result<Figure, CmodError> {
    let (scale, axis) = change_axis(found);
    let (mut marks, mut residuals) = (Vec::new(), Vec::new());
    for (index, (test, errors)) in found.tests.iter().zip(&found.standard_errors).enumerate() {
        let role = Role::of_series(index);
        marks.extend(model(found, test, scale, (role, ""))?);
        marks.push(Mark::Points {
            name: test.name().to_owned(),
            role,
            x: test.time().to_vec(),
            y: test.change().iter().map(|change| scale * change).collect(),
            error: errors.iter().map(|error| scale * error).collect(),
        });
        let predicted = found.predicted(test)?;
        let readings = test.change().iter().zip(&predicted).zip(errors);
        residuals.push(Mark::Points {
            name: String::new(),
            role,
            x: test.time().to_vec(),
            y: readings
                .map(|((change, model), error)| (change - model.change) / error)
                .collect(),
            error: Vec::new(),
        });
    }
    Ok(Figure {
        name: "recovery".to_owned(),
        title: "Recovery of the loss factor".to_owned(),
        caption: "Above: readings with their standard errors, and the common model with bands of two standard errors. Below: what the \
                  model leaves over, by the standard error of each reading; two thirds should lie between -1 and 1."
            .to_owned(),
        panels: vec![
            panel(time_axis(), axis, marks),
            panel(
                time_axis(),
                Axis::linear("residual by standard error", ""),
                residuals,
            ),
        ],
    })
}

/// All tests over time divided by their recovery times: the form required by equation 4 for all
/// values of the parameters.
fn one_curve(found: &Found<'_>) -> Figure {
    let mut marks = Vec::new();
    let mut farthest: f64 = 10.0;
    let mut nearest: f64 = 0.1;
    let tests = found
        .tests
        .iter()
        .zip(&found.singles)
        .zip(&found.standard_errors);
    for (index, ((test, single), errors)) in tests.enumerate() {
        let Ok(single) = single else { continue };
        let x: Vec<f64> = test
            .time()
            .iter()
            .map(|t| t / single.recovery_time)
            .collect();
        for value in x.iter().filter(|value| **value > 0.0) {
            farthest = farthest.max(*value);
            nearest = nearest.min(*value);
        }
        let by_initial = |values: &[f64]| -> Vec<f64> {
            values.iter().map(|v| v / single.initial_change).collect()
        };
        marks.push(Mark::Points {
            name: test.name().to_owned(),
            role: Role::of_series(index),
            x,
            y: by_initial(test.change()),
            error: by_initial(errors),
        });
    }
    let x: Vec<f64> = (0..=60)
        .map(|i| nearest * (farthest / nearest).powf(f64::from(i) / 60.0))
        .collect();
    marks.push(Mark::Line {
        name: "1/(1 + t/tr)".to_owned(),
        role: Role::Reference,
        y: x.iter().map(|x| 1.0 / (1.0 + x)).collect(),
        x,
    });
    Figure {
        name: "one_curve".to_owned(),
        title: "All tests on one curve".to_owned(),
        caption: "Each test by the initial change and the recovery time that are fitted to it alone. The model demands the grey \
                  curve of all of them."
            .to_owned(),
        panels: vec![panel(
            Axis::logarithmic("time after unloading by recovery time", ""),
            Axis::linear("change by initial change", ""),
            marks,
        )],
    }
}

fn predictions(found: &Found<'_>) -> Result<Figure, CmodError> {
    let (scale, axis) = change_axis(found);
    let mut marks = Vec::new();
    for (index, (name, test)) in found.predictions.iter().enumerate() {
        let role = Role::of_series(index);
        marks.extend(model(found, test, scale, (role, name))?);
    }
    Ok(Figure {
        name: "predictions".to_owned(),
        title: "Predicted recovery after other loads".to_owned(),
        caption: "Bands of two standard errors, by the errors of the readings and of the parameters; that the model holds for such a \
                  load is not part of them."
            .to_owned(),
        panels: vec![panel(time_axis(), axis, marks)],
    })
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
