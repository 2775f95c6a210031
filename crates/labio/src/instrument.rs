//! Models of sensors, filters and converters for virtual experiments.
//!
//! An [`Instrument`] is a sequence of stages, applied in the order in which they are added. It
//! converts a finely sampled, error-free history to the record that a laboratory would obtain:
//! band-limited, delayed, noisy and rounded.
//!
//! ```
//! use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
//! use labio::{Channel, Provenance, Quantity, Record};
//! use ndarray::Array2;
//! use rand::SeedableRng;
//!
//! # fn main() -> Result<(), labio::LabioError> {
//! let velocity = Array2::from_shape_fn((1, 4096), |(_, k)| (-((k as f64 - 1000.0) / 50.0).powi(2)).exp());
//! let channels = vec![Channel::new("end A", Quantity::Velocity)?];
//! let history = Record::new(velocity, 1e6, 0.0, channels, Provenance::computed("closed form"))?;
//!
//! let recorder = Instrument::new()
//!     .gain("end A", 1.005)?
//!     .noise("end A", NoiseSpectrum::white(1e-12)?)
//!     .anti_alias(AntiAlias::butterworth(8, 40e3)?)
//!     .sample(100e3, 0.0)?
//!     .convert(Converter::new(16, 2.0)?);
//! let taken = recorder.record(&history, &mut rand_chacha::ChaCha8Rng::seed_from_u64(1))?;
//! assert_eq!(taken.record.n_samples(), 410);
//! assert!(taken.saturations.is_empty());
//! # Ok(())
//! # }
//! ```
//!
//! Theory: `docs/theory/hits.md#instruments-of-virtual-experiments`.

mod anti_alias;
mod converter;
mod noise;
mod stage;

pub use anti_alias::AntiAlias;
pub use converter::Converter;
pub use noise::NoiseSpectrum;

use ndarray::Array2;
use rand::Rng;

use crate::error::{check_finite, check_not_negative, check_positive};
use crate::{LabioError, Provenance, Record, SensorChain};
use stage::{Signals, Stage};

/// A sequence of stages that convert a history to a record.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Instrument {
    stages: Vec<Stage>,
}

/// A channel whose converter was overloaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Saturation {
    /// The channel.
    pub channel: String,
    /// Number of samples beyond the range.
    pub n_samples: usize,
}

/// Result of an instrument.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Acquisition {
    /// The record. Its provenance names the generator of the history and every stage.
    pub record: Record,
    /// Overloaded channels; empty if the record is valid.
    pub saturations: Vec<Saturation>,
}

impl Instrument {
    /// Creates an instrument that changes nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    fn then(mut self, stage: Stage) -> Self {
        self.stages.push(stage);
        self
    }

    /// Converts a physical quantity to the recorded output of the sensor chain:
    /// $`u = u_0 + p\,G\,S\,y`$. The record is then in volts (or coulombs); calibrating it with
    /// another chain simulates an error of calibration.
    #[must_use]
    pub fn sense(self, channel: impl Into<String>, chain: SensorChain) -> Self {
        self.then(Stage::Sense(channel.into(), Box::new(chain)))
    }

    /// Multiplies a channel by a factor: a gain error of 0.5 % is the factor 1.005.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the factor is not finite.
    pub fn gain(self, channel: impl Into<String>, factor: f64) -> Result<Self, LabioError> {
        let factor = check_finite("gain of a channel", factor)?;
        Ok(self.then(Stage::Gain(channel.into(), factor)))
    }

    /// Adds a constant to a channel.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the constant is not finite.
    pub fn offset(self, channel: impl Into<String>, value: f64) -> Result<Self, LabioError> {
        let value = check_finite("offset of a channel", value)?;
        Ok(self.then(Stage::Offset(channel.into(), value)))
    }

    /// Delays a channel by `time` \[s\] (advances it if negative), by band-limited interpolation.
    ///
    /// # Validity
    ///
    /// Valid for signals that have no content at half the sampling rate and are at rest at both
    /// ends.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the time is not finite and, when recording, if it exceeds the
    /// duration.
    pub fn delay(self, channel: impl Into<String>, time: f64) -> Result<Self, LabioError> {
        let time = check_finite("delay of a channel [s]", time)?;
        Ok(self.then(Stage::Delay(channel.into(), time)))
    }

    /// Rounds a channel to multiples of `step`, the resolution of a transducer.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the step is not positive.
    pub fn resolution(self, channel: impl Into<String>, step: f64) -> Result<Self, LabioError> {
        let step = check_positive("resolution of a channel", step)?;
        Ok(self.then(Stage::Resolution(channel.into(), step)))
    }

    /// Adds Gaussian noise with this spectrum, up to half the sampling rate of the signals at this
    /// stage.
    #[must_use]
    pub fn noise(self, channel: impl Into<String>, spectrum: NoiseSpectrum) -> Self {
        self.then(Stage::Noise(channel.into(), spectrum))
    }

    /// Mixes all channels: $`y_i = \sum_j C_{ij} x_j`$, with `matrix` of shape
    /// `(n_channels, n_channels)`, whose diagonal is 1 for channels that keep their gain.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if a coefficient is not finite.
    pub fn cross_talk(self, matrix: Array2<f64>) -> Result<Self, LabioError> {
        for &coefficient in &matrix {
            check_finite("coefficient of cross-talk", coefficient)?;
        }
        Ok(self.then(Stage::CrossTalk(matrix)))
    }

    /// Filters all channels by the exact frequency response of the analogue filter at every line of
    /// the discrete transform.
    ///
    /// # Validity
    ///
    /// Valid for histories sampled so finely that, after the filter, they have no content at half
    /// their sampling rate.
    #[must_use]
    pub fn anti_alias(self, filter: AntiAlias) -> Self {
        self.then(Stage::AntiAlias(filter))
    }

    /// Samples the signals at `rate_hz`; each sample is the mean over `aperture` \[s\] centred on
    /// its instant (0: the value itself). The rate of the history must be a whole multiple of
    /// `rate_hz`. Aliasing is not prevented: that is the task of the anti-alias filter.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the rate is not positive or the aperture is negative and,
    /// when recording, if the ratio of the rates is not a whole number.
    pub fn sample(self, rate_hz: f64, aperture: f64) -> Result<Self, LabioError> {
        let stage = Stage::Sample {
            rate_hz: check_positive("sampling rate [Hz]", rate_hz)?,
            aperture: check_not_negative("aperture [s]", aperture)?,
        };
        Ok(self.then(stage))
    }

    /// Digitises all channels.
    #[must_use]
    pub fn convert(self, converter: Converter) -> Self {
        self.then(Stage::Convert(None, converter))
    }

    /// Digitises one channel.
    #[must_use]
    pub fn convert_channel(self, channel: impl Into<String>, converter: Converter) -> Self {
        self.then(Stage::Convert(Some(channel.into()), converter))
    }

    /// Returns the record of `history`. The same random generator in the same state gives the same
    /// record.
    ///
    /// # Errors
    ///
    /// - [`LabioError::UnknownChannel`]: a stage names a channel that the history does not have.
    /// - [`LabioError::UnitMismatch`]: a sensor does not measure the quantity of its channel.
    /// - [`LabioError::CountMismatch`]: the size of the cross-talk matrix differs from the number
    ///   of channels.
    /// - [`LabioError::NonPhysical`]: the sampling rate does not divide that of the history, or a
    ///   delay exceeds its duration.
    /// - [`LabioError::TooFewSamples`], [`LabioError::NonFiniteSample`]: no samples are left, or
    ///   some are not finite.
    pub fn record<R: Rng + ?Sized>(
        &self,
        history: &Record,
        rng: &mut R,
    ) -> Result<Acquisition, LabioError> {
        let mut signals = Signals {
            samples: history.samples().to_owned(),
            rate_hz: history.sampling_rate_hz(),
            channels: history.channels().to_vec(),
            saturations: Vec::new(),
        };
        for stage in &self.stages {
            signals.pass(stage, rng)?;
        }
        let stages: Vec<String> = self.stages.iter().map(Stage::name).collect();
        let origin = match history.provenance() {
            Provenance::Computed { generator } => generator.clone(),
            other => other.to_string(),
        };
        let generator = if stages.is_empty() {
            origin
        } else {
            format!("{origin}, recorded with {}", stages.join("; "))
        };
        let record = Record::new(
            signals.samples,
            signals.rate_hz,
            history.start_time(),
            signals.channels,
            Provenance::computed(generator),
        )?;
        Ok(Acquisition {
            record,
            saturations: signals.saturations,
        })
    }
}
