//! Waves towards and from the free end, at the first gauge and at the ends of the bar, computed
//! from the history of the first gauge and the condition at the free end; and the residual of the
//! model.

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use super::BarSheet;
use super::passages::Passages;
use super::table::Line;
use crate::outcome::{CHECK, Quantity};

/// Frequencies between which the spectrum of the waves is reduced to 0, as multiples of the last
/// valid frequency.
const FALLS: [f64; 2] = [0.75, 1.25];
/// Maximum number of passages of the gauge that are summed.
const MOST_PASSAGES: usize = 400;

/// Maximum number of round trips through the bar that are marked.
const MOST_DRAWN: u32 = 4;

/// Histories of the waves of the first shot.
pub(super) struct Waves {
    /// Times \[s\] at which the front of the pulse returns to each gauge after its first passage.
    pub(super) returns: Vec<Vec<f64>>,
    /// Name of the place, wave towards the free end, and wave from the free end.
    pub(super) at: Vec<(String, Vec<f64>, Vec<f64>)>,
    /// Gauge whose history the model predicts.
    pub(super) gauge: String,
    /// History of this gauge in the band, in the scale of the first gauge.
    pub(super) measured: Vec<f64>,
    /// Prediction of the model for this history.
    pub(super) predicted: Vec<f64>,
    pub(super) rate_hz: f64,
}

impl Waves {
    /// Root mean square of the residual of the model, relative to the root mean square of the
    /// history.
    pub(super) fn misfit(&self) -> Quantity {
        let pairs = self.measured.iter().zip(&self.predicted);
        let left: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
        let all: f64 = self.measured.iter().map(|x| x * x).sum();
        Quantity {
            name: format!(
                "{CHECK}part of {} that the model does not explain",
                self.gauge
            ),
            unit: "%".to_owned(),
            value: Some(100.0 * (left / all).sqrt()).filter(|value| value.is_finite()),
            standard_error: None,
            valid: true,
            verdict: "valid".to_owned(),
        }
    }
}

/// Lines of a Fourier transform, with the propagation coefficient interpolated between the valid
/// lines and a weight that ends the band.
struct Band {
    transform: RealFourier,
    n_samples: usize,
    n_transform: usize,
    gamma: Vec<Complex64>,
    weight: Vec<f64>,
}

impl Band {
    fn of(valid: &[&Line], n_samples: usize, rate_hz: f64) -> Option<Self> {
        let (first, last) = (valid.first()?, valid.last()?);
        let n_transform = (4 * n_samples).next_power_of_two();
        let n_lines = n_transform / 2 + 1;
        let frequency = |line: usize| line as f64 * rate_hz / n_transform as f64;
        let gamma = |line: usize| {
            let f = frequency(line);
            let after = valid.partition_point(|line| line.frequency_hz < f);
            // outside the valid lines, gamma/f is that of the nearest valid line
            let (below, above) = match (after.checked_sub(1), valid.get(after)) {
                (Some(below), Some(above)) => (valid.get(below).copied().unwrap_or(first), *above),
                (None, _) => (*first, *first),
                (_, None) => (*last, *last),
            };
            let per_frequency = |line: &Line| line.gamma / line.frequency_hz;
            let width = above.frequency_hz - below.frequency_hz;
            let part = if width > 0.0 {
                (f - below.frequency_hz) / width
            } else {
                0.0
            };
            f * (per_frequency(below) * (1.0 - part) + per_frequency(above) * part)
        };
        let weight = |line: usize| {
            let [from, to] = FALLS;
            let place =
                ((frequency(line) / last.frequency_hz - from) / (to - from)).clamp(0.0, 1.0);
            0.5 * (1.0 + (std::f64::consts::PI * place).cos())
        };
        Some(Self {
            transform: RealFourier::new(n_transform),
            n_samples,
            n_transform,
            gamma: (0..n_lines).map(gamma).collect(),
            weight: (0..n_lines).map(weight).collect(),
        })
    }

    fn transformed(&mut self, history: &[f64]) -> Vec<Complex64> {
        self.transform.samples().fill(0.0);
        for (to, from) in self.transform.samples().iter_mut().zip(history) {
            *to = *from;
        }
        self.transform.forward().to_vec()
    }

    /// Returns the spectrum of a history, weighted by the band.
    fn spectrum(&mut self, history: &[f64]) -> Vec<Complex64> {
        let lines = self.transformed(history);
        let weighted = lines.iter().zip(&self.weight);
        weighted.map(|(line, weight)| line * weight).collect()
    }

    /// Returns a history from its lines, each multiplied by a function of the propagation
    /// coefficient.
    fn history(&mut self, lines: &[Complex64], of: impl Fn(Complex64) -> Complex64) -> Vec<f64> {
        let factors = self.gamma.iter().map(|gamma| of(*gamma));
        for ((to, from), factor) in self.transform.lines().iter_mut().zip(lines).zip(factors) {
            *to = from * factor;
        }
        let scale = 1.0 / self.n_transform as f64;
        let samples = self.transform.inverse().iter().take(self.n_samples);
        samples.map(|x| scale * x).collect()
    }
}

/// Returns the waves; `None` if there are no valid lines or no gauge.
pub(super) fn of(lines: &[Line], sheet: &BarSheet, passages: &Passages) -> Option<Waves> {
    let valid: Vec<&Line> = lines.iter().filter(|line| line.is_valid).collect();
    let slowest = valid.iter().map(|line| line.phase_velocity());
    let slowest = slowest.fold(f64::INFINITY, f64::min);
    let (gauge, history) = (sheet.gauges.first()?, passages.histories.first()?);
    let (to_end, length) = (gauge.distance(), sheet.bar.length.si());
    let mut band = Band::of(&valid, history.len(), passages.rate_hz)?;
    let strain = band.spectrum(history);
    let duration = history.len() as f64 / passages.rate_hz;
    let reach = |passages: &usize| 2.0 * to_end * *passages as f64 / slowest < duration;
    let passes = (1..MOST_PASSAGES).take_while(reach).count();
    // P (1 - e^{-2 gamma b}) = strain, solved for the incident wave P as a sum over the passages
    let sum = |gamma: Complex64| {
        let once = (-2.0 * gamma * to_end).exp();
        (0..passes).fold(Complex64::ONE, |sum, _| 1.0 + once * sum)
    };
    let along = band.history(&strain, sum);
    // the wave is limited to the band again: the end of the record is a step, whose lines above the
    // band would grow as the wave is traced back
    let in_band = band.spectrum(&along);
    let along = band.transformed(&along);
    let carried = |way: f64| move |gamma: Complex64| (-gamma * way).exp();
    let back = |way: f64| move |gamma: Complex64| -(-gamma * way).exp();
    let mut at = Vec::new();
    for (place, from_end) in [
        (format!("at {}", gauge.channel), to_end),
        ("at the free end".to_owned(), 0.0),
        ("at the struck end".to_owned(), length),
    ] {
        let mut towards = band.history(&in_band, carried(to_end - from_end));
        // the last samples at the struck end are unknown, because these waves reach the gauge after
        // the end of the record, and the step there is spread over two periods of the last valid
        // line
        let periods = 2.0 / valid.last()?.frequency_hz;
        let known = duration - (from_end - to_end).max(0.0) / slowest - periods;
        for (at, sample) in towards.iter_mut().enumerate() {
            if at as f64 / passages.rate_hz > known {
                *sample = f64::NAN;
            }
        }
        at.push((
            place,
            towards,
            band.history(&in_band, back(to_end + from_end)),
        ));
    }
    let (last, own) = (sheet.gauges.last()?, passages.histories.last()?);
    let from_end = last.distance();
    let own = band.spectrum(own);
    let measured = band.history(&own, |_| Complex64::ONE);
    let [predicted, measured] = match &passages.windows {
        // a single gauge: the prediction starts from the incident pulse alone and ends after its
        // reflection
        Some([incident, reflected]) => {
            let pulse = history.iter().enumerate();
            let pulse = pulse.map(|(at, x)| if incident.contains(&at) { *x } else { 0.0 });
            let pulse = band.spectrum(&pulse.collect::<Vec<f64>>());
            let both = band.history(&pulse, |gamma| 1.0 - (-2.0 * gamma * to_end).exp());
            [both, measured].map(|history| history.into_iter().take(reflected.end).collect())
        }
        None => {
            let both = band.history(&along, |gamma| {
                (-gamma * (to_end - from_end)).exp() - (-gamma * (to_end + from_end)).exp()
            });
            // the scale is fitted, because the estimate also determines the ratio of the
            // calibrations
            let products = measured.iter().zip(&both);
            let (product, square) =
                products.fold((0.0, 0.0), |(p, s), (a, b)| (p + a * b, s + a * a));
            let scaled = measured.iter().map(|x| x * product / square).collect();
            [both, scaled]
        }
    };
    let speed = valid.get(valid.len() / 2)?.phase_velocity();
    let returns = sheet
        .gauges
        .iter()
        .zip(&passages.first)
        .map(|(gauge, first)| {
            let front = *first as f64 / passages.rate_hz;
            let round = |n: u32| front + 2.0 * f64::from(n) * length / speed;
            let pairs =
                (0..MOST_DRAWN).map(|n| [round(n), round(n) + 2.0 * gauge.distance() / speed]);
            let within = pairs.flatten().skip(1);
            within.take_while(|time| *time < duration).collect()
        });
    Some(Waves {
        returns: returns.collect(),
        at,
        gauge: last.channel.clone(),
        measured,
        predicted,
        rate_hz: passages.rate_hz,
    })
}
