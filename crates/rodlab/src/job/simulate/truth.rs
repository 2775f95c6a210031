//! Properties of the virtual specimen, which are the expected results of an evaluation.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::medium::Medium;

use crate::Outcome;
use crate::bodies::material::AnalyticLaw;
use crate::outcome::{Quantity, Rows, Table};

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
        let title = "True values of the virtual specimen";
        let rows = Rows::of(&self.0, "truth", title)
            .word("quantity", |(name, ..)| name)
            .number("value", "", |(_, value, _)| *value)
            .word("unit", |(.., unit)| unit);
        outcome.tables.push(rows.table);
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
    let rows: Vec<(f64, Complex64)> = (0..=steps)
        .map(|step| from * (to / from).powf(step as f64 / steps as f64))
        .map(|frequency| (frequency, medium.modulus(TAU * frequency)))
        .collect();
    Rows::of(&rows, "true-modulus", "Modulus of the virtual specimen")
        .number("frequency", "Hz", |(frequency, _)| *frequency)
        .number("storage modulus", "Pa", |(_, e)| e.re)
        .number("loss modulus", "Pa", |(_, e)| e.im)
        .number("loss factor", "", |(_, e)| e.im / e.re)
        .number("phase velocity", "m/s", |(frequency, _)| {
            medium.phase_velocity(TAU * frequency)
        })
        .table
}
