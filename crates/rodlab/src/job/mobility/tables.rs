//! Table of the mobility, line by line.

use num_complex::Complex64;

use super::known::Known;
use crate::outcome::{Column, Table};
use crate::responses::error_columns;
use crate::universal::DECAY_RATE;

pub(super) fn mobility(known: &Known) -> Table {
    let response = &known.mobility;
    let of = |value: &dyn Fn(&Complex64) -> f64| response.values.iter().map(value).collect();
    let mut columns = vec![
        Column::numbers("frequency", "Hz", response.frequency_hz.clone()),
        Column::numbers("real part", "m/(N s)", of(&|h| h.re)),
        Column::numbers("imaginary part", "m/(N s)", of(&|h| h.im)),
        Column::numbers("magnitude", "m/(N s)", of(&|h| h.norm())),
        Column::numbers("phase", "deg", of(&|h| h.arg().to_degrees())),
    ];
    if let Some(variance) = &response.variance {
        let root = variance.iter().map(|v| v.sqrt()).collect();
        columns.push(Column::numbers("standard error", "m/(N s)", root));
    }
    if let Some(errors) = response.random_error() {
        let magnitudes = errors.iter().map(|e| 100.0 * e.magnitude).collect();
        columns.push(Column::numbers(
            "standard error of the magnitude",
            "%",
            magnitudes,
        ));
        let phases = errors.iter().map(|e| e.phase.to_degrees()).collect();
        columns.push(Column::numbers(
            "standard error of the phase",
            "deg",
            phases,
        ));
    }
    columns.extend(error_columns(response, 0..response.values.len()));
    if let Some(window) = response.added_damping {
        let rates = vec![window.decay_rate(); response.values.len()];
        columns.push(Column::numbers(DECAY_RATE, "1/s", rates));
    }
    match known.coherences.as_slice() {
        [low, high] => {
            columns.push(Column::numbers(
                "coherence of the heavy hammer",
                "",
                low.clone(),
            ));
            columns.push(Column::numbers(
                "coherence of the light hammer",
                "",
                high.clone(),
            ));
        }
        [only] => columns.push(Column::numbers("coherence", "", only.clone())),
        _ => {
            if let Some(coherence) = &response.coherence {
                columns.push(Column::numbers("coherence", "", coherence.clone()));
            }
        }
    }
    if let Some((shares, discrepancy)) = &known.merged {
        columns.push(Column::numbers(
            "weight of the light hammer",
            "",
            shares.clone(),
        ));
        columns.push(Column::numbers(
            "discrepancy of the two hammers",
            "",
            discrepancy.clone(),
        ));
    }
    columns.push(Column::validity(
        known.objections.iter().map(Option::is_none).collect(),
        known
            .objections
            .iter()
            .enumerate()
            .map(|(line, objection)| match objection {
                Some(reason) => reason.clone(),
                None if line < known.first_measured => "valid, by the weighed mass".to_owned(),
                None => "valid".to_owned(),
            })
            .collect(),
    ));
    Table::of("mobility", "Mobility of the face", columns)
}
