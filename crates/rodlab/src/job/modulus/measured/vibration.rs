//! Modes of the free vibration of the rod, from the histories of the hits.

use std::f64::consts::TAU;

use cmod::FreeVibration;
use cmod::free_vibration::Pole;
use labio::Record;

use super::Measured;
use crate::digits::significant;
use crate::job::modulus::ModulusSheet;
use crate::job::modulus::method::Vibration;
use crate::job::modulus::method::rod::{length, rod_with_free_end};
use crate::outcome::Table;
use crate::{InStep, RodlabError};

/// The modes of a rod.
pub(in crate::job::modulus) struct Modes {
    pub(super) frequency_hz: Vec<f64>,
    /// One pole for each frequency.
    pub(in crate::job::modulus) poles: Vec<Pole>,
}

impl Modes {
    /// Returns the table of frequencies and decay rates, with the standard error of the decay rate.
    /// The angular frequency has the same standard error.
    pub(super) fn table(&self) -> Table {
        let decay = self.poles.iter().map(|pole| -pole.s.re);
        let errors = self.poles.iter().map(|pole| (0.5 * pole.variance).sqrt());
        let orders = self.poles.iter().map(|pole| f64::from(pole.order));
        Table::new("modes", "Modes of the free vibration")
            .numbers("mode", "", orders)
            .numbers("frequency", "Hz", &self.frequency_hz)
            .numbers("decay rate", "1/s", decay)
            .numbers("standard error of the decay rate", "1/s", errors)
    }
}

/// Returns the modes. If no mode stands out, returns `None`, and `measured` states the reason.
pub(super) fn modes(
    sheet: &ModulusSheet,
    &Vibration {
        channel,
        from,
        wave_speed,
    }: &Vibration<'_>,
    hits: &[&Record],
    measured: &mut Measured,
) -> Result<Option<Modes>, RodlabError> {
    let rate_hz = hits.first().map_or(0.0, |hit| hit.sampling_rate_hz());
    let first = labio::hits::Extent::Seconds(from.si())
        .samples(rate_hz)
        .in_step("method.free_vibration.from")?;
    let mut records: Vec<Vec<f64>> = Vec::with_capacity(hits.len());
    for hit in hits {
        let history = hit
            .channel(channel)
            .in_step("method.free_vibration.channel")?;
        let free: Vec<f64> = history.iter().skip(first).copied().collect();
        if free.len() < 64 {
            return Err(RodlabError::request(
                "method.free_vibration.from",
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
    let method = FreeVibration::new(rod, length, wave_speed.si())
        .in_step("the modes of the free vibration")?;
    let records: Vec<&[f64]> = records.iter().map(Vec::as_slice).collect();
    let poles = method
        .poles(&records, rate_hz)
        .in_step("the modes of the free vibration")?;
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
            "a strong vibration, at {} Hz, belongs to none of the modes that were found: it is another motion, such as bending, or the stated wave speed is off by more than a fifth",
            significant(strongest, 5)
        ));
    }
    if let Some(mode) = poles.departing.first() {
        measured.doubts.push(format!(
            "mode {}, at {} Hz, is not at {} Hz, to which the mode below leads: one of the two is another vibration, such as bending",
            mode.order,
            significant(mode.frequency_hz, 5),
            significant(mode.expected_hz, 5)
        ));
    }
    if let Some(mode) = poles.changing.first() {
        measured.doubts.push(format!(
            "the decay of mode {} is not exponential: {} 1/s at first, {} 1/s after its amplitude has fallen to 1/e; the damping depends on the \
             amplitude, a support takes part in the vibration, or two modes are close together",
            mode.order,
            significant(mode.decay_rate, 3),
            significant(mode.later, 3)
        ));
    }
    let divisor = poles.found.iter().map(|pole| pole.order).reduce(divisor);
    if let Some(divisor) = divisor
        && divisor > 1
        && poles.found.len() > 1
    {
        measured.doubts.push(format!(
            "every mode that was found has a multiple of {divisor} as its number: the wave speed is probably {divisor} times that stated, or about {} m/s",
            significant(f64::from(divisor) * wave_speed.si(), 2)
        ));
    }
    if poles.found.is_empty() {
        measured.missing = format!(
            "no mode stands out near the frequencies expected for a wave speed of {wave_speed} and a length of {} m",
            significant(length, 4)
        );
        return Ok(None);
    }
    Ok(Some(Modes {
        frequency_hz: poles.found.iter().map(|pole| pole.s.im / TAU).collect(),
        poles: poles.found,
    }))
}

/// Returns the greatest common divisor.
fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}
