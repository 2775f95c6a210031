//! Effects of the stages of an instrument on the signals.

use ndarray::{Array2, ArrayViewMut1, Axis, Slice};
use num_complex::Complex64;
use rand::Rng;

use super::{AntiAlias, Converter, NoiseSpectrum, Saturation};
use crate::error::{check_count, non_physical};
use crate::filter::{delayed, filtered};
use crate::{Channel, LabioError, Quantity, SensorChain, channel};

/// Largest deviation of the ratio of two sampling rates from a whole number: rates are written with
/// few digits.
const RATIO_TOLERANCE: f64 = 1e-9;

/// One stage of an instrument; a stage of a single channel begins with the name of the channel.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Stage {
    Sense(String, Box<SensorChain>),
    /// A factor.
    Gain(String, f64),
    /// A constant to be added.
    Offset(String, f64),
    /// Time \[s\] by which the channel is late.
    Delay(String, f64),
    /// Step to whose multiples the samples are rounded.
    Resolution(String, f64),
    Noise(String, NoiseSpectrum),
    CrossTalk(Array2<f64>),
    AntiAlias(AntiAlias),
    Sample {
        rate_hz: f64,
        aperture: f64,
    },
    /// Converter of the named channel or, without a name, of all channels.
    Convert(Option<String>, Converter),
}

/// The state between two stages.
pub(super) struct Signals {
    pub(super) samples: Array2<f64>,
    pub(super) rate_hz: f64,
    pub(super) channels: Vec<Channel>,
    pub(super) saturations: Vec<Saturation>,
}

impl Signals {
    fn row(&mut self, name: &str) -> Result<ArrayViewMut1<'_, f64>, LabioError> {
        let (index, _) = channel::find(&self.channels, name)?;
        Ok(self.samples.row_mut(index))
    }

    pub(super) fn pass<R: Rng + ?Sized>(
        &mut self,
        stage: &Stage,
        rng: &mut R,
    ) -> Result<(), LabioError> {
        let rate_hz = self.rate_hz;
        match stage {
            Stage::Sense(channel, chain) => self.sense(channel, chain)?,
            Stage::Gain(channel, factor) => self.row(channel)?.map_inplace(|x| *x *= factor),
            Stage::Offset(channel, value) => self.row(channel)?.map_inplace(|x| *x += value),
            Stage::Delay(channel, time) => {
                let duration = self.samples.ncols() as f64 / rate_hz;
                if time.abs() >= duration {
                    return non_physical(
                        "delay of a channel [s]",
                        *time,
                        "less than the duration of the history",
                    );
                }
                let row = self.row(channel)?;
                replace(row, |samples| delayed(samples, time * rate_hz));
            }
            Stage::Resolution(channel, step) => {
                self.row(channel)?
                    .map_inplace(|x| *x = (*x / step).round() * step);
            }
            Stage::Noise(channel, spectrum) => {
                let mut row = self.row(channel)?;
                let noise = spectrum.draw(row.len(), rate_hz, rng);
                row.iter_mut().zip(noise).for_each(|(x, noise)| *x += noise);
            }
            Stage::CrossTalk(matrix) => self.mix(matrix)?,
            Stage::AntiAlias(filter) => {
                let per_radian = rate_hz / std::f64::consts::TAU;
                for row in self.samples.rows_mut() {
                    replace(row, |samples| {
                        filtered(samples, |omega| filter.response(omega * per_radian))
                    });
                }
            }
            Stage::Sample {
                rate_hz: wanted_hz,
                aperture,
            } => self.sample(*wanted_hz, *aperture)?,
            Stage::Convert(channel, converter) => {
                if let Some(name) = channel {
                    channel::find(&self.channels, name)?;
                }
                for (mut row, of) in self.samples.rows_mut().into_iter().zip(&self.channels) {
                    if channel.as_deref().is_some_and(|name| name != of.name()) {
                        continue;
                    }
                    let n_samples = converter.convert(row.iter_mut(), rng);
                    if n_samples > 0 {
                        self.saturations.push(Saturation {
                            channel: of.name().to_owned(),
                            n_samples,
                        });
                    }
                }
            }
        }
        Ok(())
    }

    fn sense(&mut self, name: &str, chain: &SensorChain) -> Result<(), LabioError> {
        let (index, felt) = channel::find(&self.channels, name)?;
        let recorded = chain
            .recorded_dimension(felt.quantity())
            .and_then(Quantity::of_dimension)
            .ok_or_else(|| LabioError::UnitMismatch {
                what: format!("the sensor of `{name}`"),
                found: "a unit that yields no channel quantity".to_owned(),
                expected: format!("one that senses {}", felt.quantity().unit()),
            })?;
        let sensed = Channel::new(name, recorded)?;
        self.row(name)?
            .map_inplace(|x| *x = chain.recorded_from(*x));
        if let Some(slot) = self.channels.get_mut(index) {
            *slot = sensed;
        }
        Ok(())
    }

    fn mix(&mut self, matrix: &Array2<f64>) -> Result<(), LabioError> {
        let n = self.channels.len();
        for found in [matrix.nrows(), matrix.ncols()] {
            check_count("rows and columns of the cross-talk matrix", found, n)?;
        }
        self.samples = matrix.dot(&self.samples);
        Ok(())
    }

    fn sample(&mut self, wanted_hz: f64, aperture: f64) -> Result<(), LabioError> {
        let ratio = self.rate_hz / wanted_hz;
        let every = ratio.round();
        if (ratio - every).abs() > RATIO_TOLERANCE * ratio || !(1.0..1e9).contains(&every) {
            return non_physical(
                "sampling rate of the history over that of the recorder",
                ratio,
                "a whole number of at least 1",
            );
        }
        if aperture > 0.0 {
            let half = aperture * self.rate_hz / 2.0;
            for row in self.samples.rows_mut() {
                replace(row, |samples| {
                    filtered(samples, |omega| Complex64::from(sinc(omega * half)))
                });
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a whole number from 1 to 1e9"
        )]
        let every = every as isize;
        let kept = Slice::new(0, None, every);
        self.samples = self.samples.slice_axis(Axis(1), kept).to_owned();
        self.rate_hz = wanted_hz;
        Ok(())
    }
}

fn replace(mut row: ArrayViewMut1<'_, f64>, by: impl Fn(&[f64]) -> Vec<f64>) {
    let samples = by(&row.to_vec());
    row.iter_mut().zip(samples).for_each(|(x, new)| *x = new);
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

impl Stage {
    pub(super) fn name(&self) -> String {
        match self {
            Self::Sense(channel, _) => format!("the sensor of `{channel}`"),
            Self::Gain(channel, factor) => format!("gain {factor} of `{channel}`"),
            Self::Offset(channel, value) => format!("offset {value} of `{channel}`"),
            Self::Delay(channel, time) => format!("`{channel}` delayed by {time} s"),
            Self::Resolution(channel, step) => format!("`{channel}` in steps of {step}"),
            Self::Noise(channel, spectrum) => format!("{} in `{channel}`", spectrum.name()),
            Self::CrossTalk(_) => "cross-talk".to_owned(),
            Self::AntiAlias(filter) => filter.name(),
            Self::Sample { rate_hz, aperture } => {
                format!("samples at {rate_hz} Hz with an aperture of {aperture} s")
            }
            Self::Convert(channel, converter) => match channel {
                None => converter.name(),
                Some(channel) => format!("{} for `{channel}`", converter.name()),
            },
        }
    }
}
