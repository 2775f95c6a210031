//! Predictions of the model, with the printed parameters, for the loads of Table 1.

use std::fmt::Write;

use cmod::recovery::ThreeElement;
use rodwave::digits::significant;
use serde::Serialize;

use super::super::{Error, Table};
use testbed::papers::paper_c::PaperC;

/// Recovery times of the table, in s.
const TIMES: [f64; 7] = [60.0, 300.0, 600.0, 1800.0, 3600.0, 7200.0, 18000.0];

/// Row of the table.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    test: String,
    mean_stress: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    stress_amplitude: Option<f64>,
    duration: f64,
    /// `t_r` of eq. 5 in s
    recovery_time: f64,
    /// `t_r` of eq. 5 as printed, in s; `None` for a periodic load, which has no closed form
    #[serde(skip_serializing_if = "Option::is_none")]
    recovery_time_as_printed: Option<f64>,
    /// Δtan δ/tan `δ_0` right after unloading and at [`TIMES`]
    initial_change: f64,
    changes: Vec<f64>,
    /// ΔE/`E_0` at 60 s
    modulus_change: f64,
}

/// Quantity whose change a figure shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    LossFactor,
    Modulus,
}

pub(crate) fn all(paper: &PaperC, model: &ThreeElement) -> Result<Vec<Row>, Error> {
    let omega = paper.omega();
    let mut rows = Vec::new();
    for load in &paper.tests {
        let recovery = model.recovery(&paper.load_history(load)?)?;
        let virgin = paper.virgin_loss_factor_of(load);
        rows.push(Row {
            test: load.test.clone(),
            mean_stress: load.mean_stress,
            stress_amplitude: load.stress_amplitude,
            duration: load.duration,
            recovery_time: recovery.recovery_time(),
            recovery_time_as_printed: load
                .stress_amplitude
                .is_none()
                .then(|| as_printed(paper, load.mean_stress, load.duration)),
            initial_change: recovery.initial_loss_factor_change(omega) / virgin,
            changes: TIMES
                .iter()
                .map(|t| recovery.loss_factor_change(omega, *t) / virgin)
                .collect(),
            modulus_change: recovery.modulus_change(omega, TIMES[0]),
        });
    }
    Ok(rows)
}

/// Returns `t_r` of eq. 5 with the exponents as printed: `t_1/(m[..]^{-m})`.
fn as_printed(paper: &PaperC, stress: f64, duration: f64) -> f64 {
    let m = paper.exponent;
    let t_1 = 1.0 / (paper.coefficient * paper.parallel_modulus.powf(m + 1.0));
    let strain = stress / paper.parallel_modulus;
    let bracket = strain - (m * duration / t_1 + strain.powf(-m)).powf(-1.0 / m);
    t_1 / (m * bracket.powf(-m))
}

pub(crate) fn table(rows: &[Row]) -> Table {
    let mut headings = vec![
        "test".to_owned(),
        "sigma_a, MPa".into(),
        "sigma_c, MPa".into(),
        "t_a, s".into(),
        "t_r, s".into(),
        "t_r as printed, s".into(),
        "at 0 s, %".into(),
    ];
    headings.extend(TIMES.iter().map(|t| format!("at {t} s, %")));
    headings.push("|E| at 60 s, %".into());
    let mut table = Table::new(&headings);
    for row in rows {
        let mut cells = vec![
            row.test.clone(),
            significant(1e-6 * row.mean_stress, 2),
            row.stress_amplitude
                .map_or("-".into(), |s| significant(1e-6 * s, 2)),
            format!("{:.0}", row.duration),
            format!("{:.1}", row.recovery_time),
            row.recovery_time_as_printed
                .map_or("-".into(), |t| significant(t, 2)),
            format!("{:.2}", 100.0 * row.initial_change),
        ];
        cells.extend(row.changes.iter().map(|c| format!("{:.2}", 100.0 * c)));
        cells.push(significant(100.0 * row.modulus_change, 2));
        table.row(cells);
    }
    table
}

/// Returns the recovery times of the figures: 50 s to 20 000 s, evenly in the logarithm.
pub(crate) fn times_of_figure() -> impl Iterator<Item = f64> {
    (0..=200_u32).map(|i| 50.0 * 400.0_f64.powf(f64::from(i) / 200.0))
}

/// Returns the change of `quantity` in per cent at the times of the figures, one list per test.
pub(crate) fn of_figure(
    paper: &PaperC,
    model: &ThreeElement,
    quantity: Quantity,
) -> Result<Vec<Vec<f64>>, Error> {
    let omega = paper.omega();
    let mut curves = Vec::new();
    for load in &paper.tests {
        let recovery = model.recovery(&paper.load_history(load)?)?;
        let virgin = paper.virgin_loss_factor_of(load);
        curves.push(
            times_of_figure()
                .map(|t| match quantity {
                    Quantity::LossFactor => 100.0 * recovery.loss_factor_change(omega, t) / virgin,
                    Quantity::Modulus => 100.0 * recovery.modulus_change(omega, t),
                })
                .collect(),
        );
    }
    Ok(curves)
}

pub(crate) fn csv(
    paper: &PaperC,
    model: &ThreeElement,
    quantity: Quantity,
) -> Result<String, Error> {
    let curves = of_figure(paper, model, quantity)?;
    let mut text = String::from("recovery time");
    for load in &paper.tests {
        let _ = write!(text, ",Test {}", load.test);
    }
    let _ = writeln!(text, "\ns{}", ",%".repeat(paper.tests.len()));
    for (index, t) in times_of_figure().enumerate() {
        let _ = write!(text, "{t:.6e}");
        for curve in &curves {
            let _ = write!(text, ",{:.6e}", curve[index]);
        }
        text.push('\n');
    }
    Ok(text)
}

pub(crate) fn conclusion(paper: &PaperC, rows: &[Row]) -> Vec<String> {
    let left = |row: &Row| row.changes.last().copied().unwrap_or(f64::NAN);
    let greatest_left = rows.iter().map(left).fold(0.0, f64::max);
    let printed = rows
        .iter()
        .filter_map(|row| row.recovery_time_as_printed)
        .fold(f64::INFINITY, f64::min);
    let strain = paper
        .tests
        .iter()
        .map(|load| load.mean_stress / paper.parallel_modulus)
        .fold(0.0, f64::max);
    let modulus = rows
        .iter()
        .map(|row| row.modulus_change)
        .fold(0.0, f64::min);
    let change = |test: &str| {
        rows.iter()
            .find(|row| row.test == test)
            .map_or(f64::NAN, |row| 100.0 * row.changes[0])
    };
    vec![
        format!(
            "The printed E_2, B and m with the corrected eq. 5 give what the paper describes: the change of the loss factor grows faster than stress \
             and more slowly than duration, and at most {:.1} % is left after five hours. Eq. 5 as printed gives recovery times of {:.0e} s and \
             more, that is, no recovery at all.",
            100.0 * greatest_left,
            printed,
        ),
        format!(
            "Test 6 at 60 s: {:.0} %, between Test 1 ({:.0} %) and Test 2 ({:.0} %), as the paper found; the periodic part of the \
             load alone explains this, without fatigue.",
            change("6"),
            change("1"),
            change("2"),
        ),
        format!(
            "The paper concedes two shortcomings of the model: the limiting strain would be {strain:.0}, and the modulus changes by {:.3} % at most, \
             much less than measured.",
            100.0 * modulus.abs(),
        ),
    ]
}
