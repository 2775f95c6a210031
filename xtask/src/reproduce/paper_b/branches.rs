//! Table 1 applied to the bar: s and n of each quarter turn of ka, and the error of γa computed
//! with these s and n.

use std::f64::consts::{FRAC_PI_2, TAU};

use cmod::branch::{Branch, FreeEndRoot};
use serde::Serialize;

use super::super::number::above;
use super::super::{Error, Table, table_of};
use super::rig::{GAUGE_DISTANCE, polypropylene};
use testbed::papers::paper_b::PaperB;

/// Quarter turn of ka.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    quarter_turn: u32,
    /// Lower limit of the quarter turn, in Hz
    from_hz: f64,
    s: i8,
    n: u32,
    cos_phase: &'static str,
    sin_phase: &'static str,
    /// Largest |γa - γa of the material| over the quarter turn, with γa computed from Ψ = cosh γa
    /// on this branch
    error: f64,
}

/// Returns the first four quarter turns, as in the table.
pub(crate) fn all(paper: &PaperB) -> Result<Vec<Row>, Error> {
    let medium = polypropylene(paper)?;
    let frequency_of = |half_turns: f64| {
        let (mut low, mut high) = (0.0, 1e6);
        // k grows with frequency, so bisection finds the limit
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if medium.wave_number(TAU * middle) * GAUGE_DISTANCE < half_turns * FRAC_PI_2 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    };
    let sign = |positive: bool| if positive { "+" } else { "-" };
    Ok((0..4_u32)
        .map(|quarter_turn| {
            let branch = Branch::in_quadrant(quarter_turn);
            let (from, to) = (
                frequency_of(f64::from(quarter_turn)),
                frequency_of(f64::from(quarter_turn + 1)),
            );
            let error = (1..32_u32)
                .map(|j| {
                    let f = from + (to - from) * f64::from(j) / 32.0;
                    let exact = medium.propagation_coefficient(TAU * f) * GAUGE_DISTANCE;
                    (FreeEndRoot::of(exact.cosh()).on(branch) - exact).norm()
                })
                .fold(0.0, f64::max);
            let turn = quarter_turn % 4;
            Row {
                quarter_turn,
                from_hz: from,
                s: branch.sign(),
                n: branch.half_waves(),
                cos_phase: sign(turn == 0 || turn == 3),
                sin_phase: sign(turn < 2),
                error,
            }
        })
        .collect())
}

pub(crate) fn table(rows: &[Row]) -> Table {
    table_of!(rows, |row|
        "quarter turn of ka" => row.quarter_turn,
        "from, Hz" => format!("{:.0}", row.from_hz),
        "sin φ" => row.sin_phase,
        "cos φ" => row.cos_phase,
        "s" => format!("{:+}", row.s),
        "n" => row.n,
        "greatest error of γa" => above(row.error, 1e-12),
    )
}
