//! Waves towards and from the free end, at the first gauge and at the ends of the bar, and the
//! residual of the model.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::waves::FreeEndWaves;

use super::BarSheet;
use super::passages::Passages;
use super::table::Line;
use crate::outcome::{CHECK, Quantity, finite};

/// Maximum number of round trips through the bar that are marked.
const MOST_DRAWN: u32 = 4;

/// Histories of the waves of the first shot.
pub(super) struct Waves {
    /// Times \[s\] at which the front of the pulse passes each gauge again after its first passage.
    pub(super) returns: Vec<Vec<f64>>,
    /// For each place: its name, the wave towards the free end, and the wave from the free end.
    pub(super) at: Vec<(String, Vec<f64>, Vec<f64>)>,
    /// Gauge whose history the model predicts.
    pub(super) gauge: String,
    /// Measured history of `gauge` in the band of the valid lines, scaled to the calibration of the
    /// first gauge.
    pub(super) measured: Vec<f64>,
    /// History of `gauge` predicted by the model.
    pub(super) predicted: Vec<f64>,
    pub(super) rate_hz: f64,
}

impl Waves {
    /// Root mean square of the difference between measured and predicted history, relative to the
    /// root mean square of the measured history.
    pub(super) fn misfit(&self) -> Quantity {
        let pairs = self.measured.iter().zip(&self.predicted);
        let left: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
        let all: f64 = self.measured.iter().map(|x| x * x).sum();
        let gauge = &self.gauge;
        let name = format!("{CHECK}part of {gauge} that the model does not explain");
        let value = finite(100.0 * (left / all).sqrt());
        Quantity::of(name, "%", value, "valid").valid_if(true)
    }
}

/// Returns the waves; `None` if there are no valid lines or no gauge.
///
/// # Errors
///
/// The errors of [`FreeEndWaves`].
pub(super) fn of(
    lines: &[Line],
    sheet: &BarSheet,
    passages: &Passages,
) -> Result<Option<Waves>, RodwaveError> {
    let valid: Vec<&Line> = lines.iter().filter(|line| line.is_valid).collect();
    let (Some(middle), Some(gauge), Some(pulse), Some(last), Some(own)) = (
        valid.get(valid.len() / 2),
        sheet.gauges.first(),
        passages.pulses.first(),
        sheet.gauges.last(),
        passages.pulses.last(),
    ) else {
        return Ok(None);
    };
    let history = &pulse.history;
    let rate_hz = passages.rate_hz;
    let (to_end, length) = (gauge.distance(), sheet.bar.length.si());
    let frequency_hz: Vec<f64> = valid.iter().map(|line| line.frequency_hz).collect();
    let gamma: Vec<Complex64> = valid.iter().map(|line| line.gamma).collect();
    let mut bar = FreeEndWaves::new(&frequency_hz, &gamma, history.len(), rate_hz)?;
    let wave = bar.incident(history, to_end)?;
    let mut at = Vec::new();
    for (place, from_end) in [
        (format!("at {}", gauge.channel), to_end),
        ("at the free end".to_owned(), 0.0),
        ("at the struck end".to_owned(), length),
    ] {
        let waves = bar.waves_at(&wave, from_end)?;
        let towards = waves.towards_end.iter().enumerate();
        let towards = towards.map(|(at, sample)| {
            if at as f64 / rate_hz > waves.known_until {
                f64::NAN
            } else {
                *sample
            }
        });
        at.push((place, towards.collect(), waves.from_end));
    }
    let measured = bar.in_band(&own.history)?;
    let [predicted, measured] = match &passages.windows {
        // a single gauge: the prediction starts from the incident pulse alone and ends after its
        // reflection
        Some([incident, reflected]) => {
            let pulse = history.iter().enumerate();
            let pulse = pulse.map(|(at, x)| if incident.contains(&at) { *x } else { 0.0 });
            let pulse = bar.incident_pulse(&pulse.collect::<Vec<f64>>(), to_end)?;
            let both = bar.strain_at(&pulse, to_end)?;
            [both, measured].map(|history| history.into_iter().take(reflected.end).collect())
        }
        None => {
            let both = bar.strain_at(&wave, last.distance())?;
            // the scale of the measured history is fitted, because the estimate also fits the ratio
            // of the gauge calibrations
            let products = measured.iter().zip(&both);
            let (product, square) =
                products.fold((0.0, 0.0), |(p, s), (a, b)| (p + a * b, s + a * a));
            let scaled = measured.iter().map(|x| x * product / square).collect();
            [both, scaled]
        }
    };
    let speed = middle.phase_velocity();
    let duration = history.len() as f64 / rate_hz;
    let returns = sheet
        .gauges
        .iter()
        .zip(&passages.pulses)
        .map(|(gauge, pulse)| {
            let front = pulse.first_sample as f64 / rate_hz;
            let round = |n: u32| front + 2.0 * f64::from(n) * length / speed;
            let pairs =
                (0..MOST_DRAWN).map(|n| [round(n), round(n) + 2.0 * gauge.distance() / speed]);
            let within = pairs.flatten().skip(1);
            within.take_while(|time| *time < duration).collect()
        });
    Ok(Some(Waves {
        returns: returns.collect(),
        at,
        gauge: last.channel.clone(),
        measured,
        predicted,
        rate_hz,
    }))
}
