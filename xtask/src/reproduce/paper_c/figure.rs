//! Figures 2 and 3.

use cmod::recovery::{RecoveryTest, ThreeElement};
use rodfigure::{Axis, Mark, Panel, Role};

use super::super::{Error, drawn};
use super::curves::{Quantity, of_figure, times_of_figure};
use testbed::papers::paper_c::PaperC;

/// Roles of the six tests.
fn roles() -> impl Iterator<Item = Role> {
    (0..5).map(Role::of_series).chain([Role::Reference])
}

/// Draws Figure 2: lines of the model, and points of the virtual measurements.
pub(crate) fn loss_factor(
    paper: &PaperC,
    model: &ThreeElement,
    readings: &[RecoveryTest],
) -> Result<(String, String), Error> {
    let mut marks = lines(paper, model, Quantity::LossFactor)?;
    for (test, role) in readings.iter().zip(roles()) {
        let change = test.change().iter();
        let points = change.map(|change| 100.0 * change / paper.virgin_loss_factor);
        let points = test.time().iter().copied().zip(points);
        marks.push(Mark::points("", role, points));
    }
    let title = "Paper C, Figure 2: loss factor after unloading (points: virtual measurements)";
    let label = "change of the loss factor over its virgin value";
    Ok(drawn("figure-2", title, panel(label, marks)))
}

/// Draws Figure 3: lines of the model only.
pub(crate) fn modulus(paper: &PaperC, model: &ThreeElement) -> Result<(String, String), Error> {
    let marks = lines(paper, model, Quantity::Modulus)?;
    let title = "Paper C, Figure 3: magnitude of the modulus after unloading, by the model";
    let label = "change of |E| over its virgin value";
    Ok(drawn("figure-3", title, panel(label, marks)))
}

fn lines(paper: &PaperC, model: &ThreeElement, quantity: Quantity) -> Result<Vec<Mark>, Error> {
    let curves = of_figure(paper, model, quantity)?;
    let tests = paper.tests.iter().zip(curves).zip(roles());
    Ok(tests
        .map(|((load, curve), role)| {
            let name = format!("Test {}", load.test);
            Mark::line(name, role, times_of_figure().zip(curve))
        })
        .collect())
}

fn panel(label: &str, marks: Vec<Mark>) -> Vec<Panel> {
    let time = Axis::logarithmic("recovery time", "s");
    vec![Panel::new(time, (label, "%"), marks)]
}
