//! Table 1: s and n of each quarter turn of kL.

use std::f64::consts::FRAC_PI_2;

use cmod::branch::{Branch, FreeEndRoot};
use num_complex::Complex64;
use serde::Serialize;

use super::super::number::above;
use super::super::{Table, table_of};
use testbed::papers::paper_a::PaperA;

/// Values of α/k for which roots are computed.
const LOSSES: [f64; 3] = [1e-4, 0.035, 0.2];

/// Quarter turn of kL.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    interval: String,
    s: i8,
    n: u32,
    #[serde(skip)]
    phase: [String; 2],
    /// True if the library gives the restored s and n, and if φ is in the same quarter as kL.
    pub(crate) agrees: bool,
    /// Greatest |γ_0 L - γL| over the quarter turn, by eqs. 3 and 4 on this branch from Ψ = cosh
    /// γL.
    pub(crate) at_rounding: f64,
}

pub(crate) fn all(paper: &PaperA) -> Vec<Row> {
    paper
        .branches
        .iter()
        .map(|turn| {
            let branch = Branch::in_quadrant(turn.quarter_turn as u32);
            let sign = |value: f64| if value > 0.0 { "+" } else { "-" };
            let mut error = 0.0_f64;
            let mut quarters = true;
            for loss in LOSSES {
                for j in 1..32_u32 {
                    let wave = (turn.quarter_turn + f64::from(j) / 32.0) * FRAC_PI_2;
                    let exact = Complex64::new(loss * wave, wave);
                    let ratio = exact.cosh();
                    error = error.max((FreeEndRoot::of(ratio).on(branch) - exact).norm());
                    // in the same quarter, the sines and cosines of φ and kL have the same signs
                    quarters &=
                        sign(ratio.im) == turn.sin_phase && sign(ratio.re) == turn.cos_phase;
                }
            }
            Row {
                interval: turn.interval.clone(),
                s: branch.sign(),
                n: branch.half_waves(),
                phase: [turn.sin_phase.clone(), turn.cos_phase.clone()],
                agrees: quarters
                    && (f64::from(branch.sign()) - turn.s).abs() < 0.5
                    && (f64::from(branch.half_waves()) - turn.n).abs() < 0.5,
                at_rounding: error,
            }
        })
        .collect()
}

pub(crate) fn table(rows: &[Row]) -> Table {
    table_of!(rows, |row|
        "kL" => row.interval,
        "sin φ" => row.phase[0],
        "cos φ" => row.phase[1],
        "s" => format!("{:+}", row.s),
        "n" => row.n,
        "greatest error of γL" => above(row.at_rounding, 1e-11),
    )
}
