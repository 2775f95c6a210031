//! Specimen of Test 6 from 20 to 140 °C: Figures 5 and 6.

use std::f64::consts::TAU;

use cmod::{ModulusEstimate, ModulusLine, Solver};
use rayon::prelude::*;
use rodwave::digits::significant;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use serde::Serialize;

use super::super::coverage::within;
use super::super::{Error, Table, table_of};
use super::rig::{SEED, VirtualTest};
use super::room_temperature::{is_admissible, valid_band};
use testbed::papers::paper_a::PaperA;

/// 0 °C in K.
const CELSIUS: f64 = 273.15;
/// Assumed law: at 20 °C and 1 kHz, a modulus of 2.6 GPa and a loss factor of 0.07. The modulus
/// decreases by a factor of e (2.718) every `FALL` K; the loss factor grows by `GROWTH` per K.
pub(crate) const FALL: f64 = 75.0;
pub(crate) const GROWTH: f64 = 5e-4;
/// Temperatures of Figure 5, in °C.
pub(crate) const OF_FIGURE_5: [f64; 3] = [20.0, 80.0, 140.0];

/// Half width of the range around 1 kHz, in Hz.
pub(crate) const NEAR_HZ: f64 = 50.0;

/// Rod at one temperature.
#[derive(Debug)]
pub(crate) struct Heated {
    pub(crate) row: Row,
    pub(crate) estimate: ModulusEstimate,
    pub(crate) medium: Medium<ConstantQ>,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) celsius: f64,
    pub(crate) valid: usize,
    pub(crate) lowest_hz: f64,
    pub(crate) highest_hz: f64,
    /// Values around 1 kHz: E' and E'' in Pa, and the loss factor.
    pub(crate) values: [f64; 3],
    #[serde(skip)]
    pub(crate) errors: [f64; 3],
    pub(crate) exact: [f64; 3],
    pub(crate) within_two: f64,
}

fn law(celsius: f64) -> Result<ConstantQ, Error> {
    let above = celsius - 20.0;
    Ok(ConstantQ::new(
        2.6e9 * (-above / FALL).exp(),
        0.07 + GROWTH * above,
        TAU * 1e3,
    )?)
}

pub(crate) fn all(paper: &PaperA) -> Result<Vec<Heated>, Error> {
    let test = super::named(paper, "6")?;
    let steps =
        ((paper.highest_temperature - paper.lowest_temperature) / paper.temperature_step).round();
    (0..=steps as u32)
        .into_par_iter()
        .map(|step| {
            let celsius =
                paper.lowest_temperature - CELSIUS + paper.temperature_step * f64::from(step);
            let rig = VirtualTest::new(paper, test, law(celsius)?)?;
            let ratio = rig.ratio(1.0, SEED + 100 + u64::from(step))?;
            let estimate = rig.estimate(&ratio, Solver::Continuation)?;
            let near = |line: &&ModulusLine| {
                (line.frequency_hz - paper.frequency_of_figure_6).abs() <= NEAR_HZ
                    && is_admissible(line)
            };
            let near: Vec<&ModulusLine> = estimate.lines().iter().filter(near).collect();
            let [storage, loss, factor] = [
                mean(&near, &|l| (l.modulus.re, l.standard_error.storage_modulus)),
                mean(&near, &|l| (l.modulus.im, l.standard_error.loss_modulus)),
                mean(&near, &|l| (l.loss_factor, l.standard_error.loss_factor)),
            ];
            let modulus = rig.medium.modulus(TAU * paper.frequency_of_figure_6);
            let exact = |line: &ModulusLine| rig.medium.modulus(TAU * line.frequency_hz);
            let [lowest_hz, highest_hz] = valid_band(&estimate);
            let row = Row {
                celsius,
                valid: estimate.valid().count(),
                lowest_hz,
                highest_hz,
                values: [storage.0, loss.0, factor.0],
                errors: [storage.1, loss.1, factor.1],
                exact: [modulus.re, modulus.im, modulus.im / modulus.re],
                within_two: within(&estimate, &exact, 2.0),
            };
            Ok(Heated {
                row,
                medium: rig.medium,
                estimate,
            })
        })
        .collect()
}

/// Returns the mean of independent values, with its standard error. The mean is not weighted: the
/// variance of a line is estimated from only ten hits, and weights computed from it would make the
/// error of the mean too small.
fn mean(lines: &[&ModulusLine], value: &dyn Fn(&ModulusLine) -> (f64, f64)) -> (f64, f64) {
    let count = lines.len() as f64;
    let (sum, squares) = lines
        .iter()
        .map(|line| value(line))
        .fold((0.0, 0.0), |(sum, squares), (value, error)| {
            (sum + value, squares + error * error)
        });
    (sum / count, squares.sqrt() / count)
}

pub(crate) fn table(heated: &[Heated]) -> Table {
    let found = |row: &Row, part: usize, scale: f64| {
        let error = significant(scale * row.errors[part], 1);
        format!("{:.4} ± {error}", scale * row.values[part])
    };
    table_of!(heated, |Heated { row, .. }|
        "temperature, °C" => format!("{:.0}", row.celsius),
        "valid lines" => row.valid,
        "from, Hz" => format!("{:.0}", row.lowest_hz),
        "to, Hz" => format!("{:.0}", row.highest_hz),
        "E' at 1 kHz, GPa" => found(row, 0, 1e-9),
        "of the law" => format!("{:.4}", 1e-9 * row.exact[0]),
        "E'', GPa" => found(row, 1, 1e-9),
        "of the law" => format!("{:.4}", 1e-9 * row.exact[1]),
        "E''/E'" => found(row, 2, 1.0),
        "of the law" => format!("{:.4}", row.exact[2]),
        "within 2 s.e., %" => format!("{:.0}", 100.0 * row.within_two),
    )
}
