//! Table of the mobility, line by line.

use super::known::Known;
use crate::outcome::{Column, Table};
use crate::responses::with_errors;
use crate::universal::DECAY_RATE;

pub(super) fn mobility(known: &Known) -> Table {
    let response = &known.mobility;
    let values = || response.values.iter();
    let mut table = Table::new("mobility", "Mobility of the face")
        .numbers("frequency", "Hz", &response.frequency_hz)
        .numbers("real part", "m/(N s)", values().map(|h| h.re))
        .numbers("imaginary part", "m/(N s)", values().map(|h| h.im))
        .numbers("magnitude", "m/(N s)", values().map(|h| h.norm()))
        .numbers("phase", "deg", values().map(|h| h.arg().to_degrees()));
    if let Some(variance) = &response.variance {
        let root = variance.iter().map(|v| v.sqrt());
        table = table.numbers("standard error", "m/(N s)", root);
    }
    if let Some(errors) = response.random_error() {
        let magnitudes = errors.iter().map(|e| 100.0 * e.magnitude);
        let phases = errors.iter().map(|e| e.phase.to_degrees());
        table = table
            .numbers("standard error of the magnitude", "%", magnitudes)
            .numbers("standard error of the phase", "deg", phases);
    }
    table = with_errors(table, response, 0..response.values.len());
    if let Some(window) = response.added_damping {
        let rates = values().map(|_| window.decay_rate());
        table = table.numbers(DECAY_RATE, "1/s", rates);
    }
    table = match known.coherences.as_slice() {
        [low, high] => table
            .numbers("coherence of the heavy hammer", "", low)
            .numbers("coherence of the light hammer", "", high),
        [only] => table.numbers("coherence", "", only),
        _ => match &response.coherence {
            Some(coherence) => table.numbers("coherence", "", coherence),
            None => table,
        },
    };
    if let Some((shares, discrepancy)) = &known.merged {
        table = table
            .numbers("weight of the light hammer", "", shares)
            .numbers("discrepancy of the two hammers", "", discrepancy);
    }
    let valid = known.objections.iter().map(Option::is_none);
    let verdict = |(line, objection): (usize, &Option<String>)| match objection {
        Some(reason) => reason.clone(),
        None if line < known.first_measured => "valid, by the weighed mass".to_owned(),
        None => "valid".to_owned(),
    };
    let verdicts = known.objections.iter().enumerate().map(verdict);
    table.with(Column::validity(valid.collect(), verdicts.collect()))
}
