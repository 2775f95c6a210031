//! Modes of the free vibration of the rod, from the histories of the hits.

use std::f64::consts::TAU;

use cmod::FreeVibration;
use cmod::free_vibration::Pole;
use labio::Record;
use num_complex::Complex64;

use super::ModulusSheet;
use super::estimate::{length, rod_with_free_end};
use super::measured::{Measured, Ratio};
use super::method::MethodSheet;
use crate::RodlabError;
use crate::digits::significant;

/// The poles of the modes as ratios s/iω; `None` if no mode stands out, which is then stated in `measured`.
pub(super) fn ratio(
    sheet: &ModulusSheet,
    hits: &[&Record],
    measured: &mut Measured,
) -> Result<Option<Ratio>, RodlabError> {
    let MethodSheet::FreeVibration {
        channel,
        from,
        wave_speed,
    } = &sheet.method
    else {
        return Ok(None);
    };
    let refused = |error| RodlabError::step("the modes of the free vibration", error);
    let rate_hz = hits.first().map_or(0.0, |hit| hit.sampling_rate_hz());
    let first = labio::hits::Extent::Seconds(from.si())
        .samples(rate_hz)
        .map_err(|error| RodlabError::step("method.from", error))?;
    let mut records: Vec<Vec<f64>> = Vec::with_capacity(hits.len());
    for hit in hits {
        let history = hit
            .channel(channel)
            .map_err(|error| RodlabError::step("method.channel", error))?;
        let free: Vec<f64> = history.iter().skip(first).copied().collect();
        if free.len() < 64 {
            return Err(RodlabError::request(
                "method.from",
                from.to_string(),
                format!(
                    "a time well before the end of the hit, {:.4} ms",
                    1e3 * hit.duration()
                ),
            ));
        }
        records.push(free);
    }
    let length = length(sheet)?;
    let rod = rod_with_free_end(sheet);
    let method = FreeVibration::new(rod, length, wave_speed.si()).map_err(refused)?;
    let records: Vec<&[f64]> = records.iter().map(Vec::as_slice).collect();
    let poles = method.poles(&records, rate_hz).map_err(refused)?;
    if !poles.missing.is_empty() {
        let missing: Vec<String> = poles
            .missing
            .iter()
            .map(|mode| format!("{} at {} Hz", mode.order, significant(mode.frequency_hz, 3)))
            .collect();
        measured.in_words.push(format!(
            "Modes that do not stand out: {}.",
            missing.join(", ")
        ));
    }
    if let Some(strongest) = poles.strongest_elsewhere {
        measured.doubts.push(format!(
            "the strongest vibration, at {} Hz, is none of the modes that were found: another motion, or a wave speed that is off by more than a fifth",
            significant(strongest, 5)
        ));
    }
    let Some(lowest) = poles.found.first() else {
        measured.missing = format!(
            "no mode stands out near the frequencies of waves of {wave_speed} in {} m",
            significant(length, 4)
        );
        return Ok(None);
    };
    let of = |value: &dyn Fn(&Pole) -> f64| poles.found.iter().map(value).collect::<Vec<f64>>();
    Ok(Some(Ratio {
        frequency_hz: of(&|pole| pole.s.im / TAU),
        values: poles
            .found
            .iter()
            .map(|pole| pole.s / Complex64::new(0.0, pole.s.im))
            .collect(),
        variance: of(&|pole| pole.variance / (pole.s.im * pole.s.im)),
        coherence: None,
        averages: None,
        freedom: Some(poles.found.iter().map(|pole| pole.freedom).collect()),
        lines_per_independent_line: 1.0,
        delay: None,
        wave_speed: Some(method.wave_speed_of(lowest)),
    }))
}
