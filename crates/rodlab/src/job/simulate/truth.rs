//! Properties of the virtual specimen, which are the expected results of an evaluation.

use std::f64::consts::TAU;

use rodwave::medium::Medium;

use crate::Outcome;
use crate::bodies::material::AnalyticLaw;
use crate::outcome::{Column, Quantity, Table};

/// Lines per decade in a table of the modulus.
const LINES_PER_DECADE: f64 = 20.0;

/// True values of single numbers.
#[derive(Default)]
pub(super) struct Truth(Vec<(String, f64, String)>);

impl Truth {
    pub(super) fn add(&mut self, name: impl Into<String>, value: f64, unit: &str) {
        self.0.push((name.into(), value, unit.to_owned()));
    }

    /// Adds the true values as a table and as quantities.
    pub(super) fn tell(self, outcome: &mut Outcome) {
        let rows = || self.0.iter();
        outcome.tables.push(Table {
            name: "truth".to_owned(),
            title: "True values of the virtual specimen".to_owned(),
            columns: vec![
                Column::words("quantity", rows().map(|row| row.0.clone()).collect()),
                Column::numbers("value", "", rows().map(|row| row.1).collect()),
                Column::words("unit", rows().map(|row| row.2.clone()).collect()),
            ],
        });
        outcome.quantities.extend(
            self.0
                .into_iter()
                .map(|(name, value, unit)| Quantity::of(name, unit, value, "stated in the sheet")),
        );
    }
}

/// Returns the table of the modulus of `medium` between two frequencies \[Hz\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of lines, some hundred at most"
)]
pub(super) fn modulus(medium: &Medium<AnalyticLaw>, from: f64, to: f64) -> Table {
    let decades = (to / from).log10().clamp(0.1, 12.0);
    let steps = (LINES_PER_DECADE * decades).ceil() as usize;
    let frequency: Vec<f64> = (0..=steps)
        .map(|step| from * (to / from).powf(step as f64 / steps as f64))
        .collect();
    let modulus: Vec<_> = frequency.iter().map(|f| medium.modulus(TAU * f)).collect();
    let column = |name: &str, unit: &str, values: Vec<f64>| Column::numbers(name, unit, values);
    Table {
        name: "true-modulus".to_owned(),
        title: "Modulus of the virtual specimen".to_owned(),
        columns: vec![
            column(
                "storage modulus",
                "Pa",
                modulus.iter().map(|e| e.re).collect(),
            ),
            column("loss modulus", "Pa", modulus.iter().map(|e| e.im).collect()),
            column(
                "loss factor",
                "",
                modulus.iter().map(|e| e.im / e.re).collect(),
            ),
            column(
                "phase velocity",
                "m/s",
                frequency
                    .iter()
                    .map(|f| medium.phase_velocity(TAU * f))
                    .collect(),
            ),
        ]
        .into_iter()
        .fold(
            vec![column("frequency", "Hz", frequency.clone())],
            |mut all, one| {
                all.push(one);
                all
            },
        ),
    }
}
