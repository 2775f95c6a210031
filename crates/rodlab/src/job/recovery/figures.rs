//! Figures of a creep recovery: recovery curves, residuals, the master curve of all tests, and
//! predictions.

use cmod::CmodError;
use cmod::recovery::RecoveryTest;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::{Found, curves};

/// Half width of a band, in standard errors.
const BAND: f64 = 2.0;

pub(super) fn figures(found: &Found<'_>) -> Result<Vec<Figure>, CmodError> {
    let mut figures = vec![recovery(found)?, one_curve(found)];
    if !found.predictions.is_empty() {
        figures.push(predictions(found)?);
    }
    Ok(figures)
}

/// Returns the factor from a change of the loss factor to the number on the axis, and the axis.
fn change_axis(found: &Found<'_>) -> (f64, Axis) {
    found.sheet.virgin_loss_factor.as_ref().map_or_else(
        || (1.0, Axis::linear("change of the loss factor", "")),
        |virgin| {
            let label = "change of the loss factor over its virgin value";
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

/// Returns line and band of the model after the load of `test`.
fn model(
    found: &Found<'_>,
    test: &RecoveryTest,
    scale: f64,
    (role, name): (Role, &str),
) -> Result<[Mark; 2], CmodError> {
    let times = curves::times(&found.tests);
    let curve = found.curve(test, &times)?;
    let edges = times.iter().zip(&curve).map(|(time, point)| {
        let edge = |sign: f64| scale * (point.change + sign * BAND * point.standard_error);
        (*time, finite_or_gap(edge(-1.0)), finite_or_gap(edge(1.0)))
    });
    let changes = curve.iter().map(|point| scale * point.change).collect();
    Ok([
        Mark::band("", role, edges),
        Mark::curve(name, role, &times, changes),
    ])
}

/// Replaces an infinite edge of a band, which the tests do not determine, by a gap.
fn finite_or_gap(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

fn recovery(found: &Found<'_>) -> Result<Figure, CmodError> {
    let (scale, axis) = change_axis(found);
    let (mut marks, mut residuals) = (Vec::new(), Vec::new());
    for (index, (test, errors)) in found.tests.iter().zip(&found.standard_errors).enumerate() {
        let role = Role::of_series(index);
        marks.extend(model(found, test, scale, (role, ""))?);
        let readings = test.time().iter().zip(test.change()).zip(errors);
        let drawn = readings.clone();
        let drawn = drawn.map(|((time, change), error)| (*time, scale * change, scale * error));
        marks.push(Mark::points_with_errors(test.name(), role, drawn));
        let predicted = found.predicted(test)?;
        let left = readings.zip(&predicted);
        let left =
            left.map(|(((time, change), error), model)| (*time, (change - model.change) / error));
        residuals.push(Mark::points("", role, left));
    }
    let panels = vec![
        Panel::new(time_axis(), axis, marks),
        Panel::new(time_axis(), ("residual over standard error", ""), residuals),
    ];
    Ok(Figure::new("recovery", "Recovery of the loss factor", panels).with_caption(
        "Above: readings with their standard errors, and the common model with bands of two standard errors. Below: the residual \
         of the model over the standard error of each reading; two thirds should be between -1 and 1.",
    ))
}

/// Figure of all tests, with changes divided by the initial change and times divided by the
/// recovery time of each test. According to equation 4 the tests then form one curve, whatever the
/// values of the parameters are.
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
        let times = test.time().iter().map(|t| t / single.recovery_time);
        for value in times.clone().filter(|value| *value > 0.0) {
            farthest = farthest.max(value);
            nearest = nearest.min(value);
        }
        let by_initial = |value: &f64| value / single.initial_change;
        let readings = times.zip(test.change()).zip(errors);
        let drawn = readings.map(|((x, change), error)| (x, by_initial(change), by_initial(error)));
        let role = Role::of_series(index);
        marks.push(Mark::points_with_errors(test.name(), role, drawn));
    }
    let x = (0..=60).map(|i| nearest * (farthest / nearest).powf(f64::from(i) / 60.0));
    let law = x.map(|x| (x, 1.0 / (1.0 + x)));
    marks.push(Mark::line("1/(1 + t/tr)", Role::Reference, law));
    let time = Axis::logarithmic("time after unloading over recovery time", "");
    let panel = Panel::new(time, ("change over initial change", ""), marks);
    Figure::new("one_curve", "All tests on one curve", vec![panel]).with_caption(
        "Each test, divided by the initial change and the recovery time that are fitted to it alone. The model requires all of \
         them to follow the grey curve.",
    )
}

fn predictions(found: &Found<'_>) -> Result<Figure, CmodError> {
    let (scale, axis) = change_axis(found);
    let mut marks = Vec::new();
    for (index, (name, test)) in found.predictions.iter().enumerate() {
        let role = Role::of_series(index);
        marks.extend(model(found, test, scale, (role, name))?);
    }
    let panel = Panel::new(time_axis(), axis, marks);
    let title = "Predicted recovery after other loads";
    Ok(Figure::new("predictions", title, vec![panel]).with_caption(
        "Bands of two standard errors, from the errors of the readings and of the parameters; they do not include an error of the \
         model itself for such a load.",
    ))
}
