//! Instruments of a virtual test: filter, sampling, noise and converter.

use std::collections::BTreeMap;

use labio::instrument::{Acquisition, AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{Channel, LabioError, Provenance, Quantity, Record};
use ndarray::Array2;
use rand_chacha::ChaCha8Rng;
use rodwave::band_limited::Recorder;
use rodwave::synthesis::DampedSynthesis;
use serde::Deserialize;

use super::level::LevelText;
use crate::outcome::Setting;
use crate::records::channel_called;
use crate::sheet::{Duration, Exact, Frequency};
use crate::{InStep, RodlabError};

/// Ratio of the sampling rate of computed histories to that of the recorder.
const FINER: usize = 8;
/// Default ratio of the cut-off of the filter to the sampling rate: 16 kHz for 51.2 kHz.
const USUAL_CUTOFF: f64 = 0.3125;
/// Number of samples by which the linear-phase filter reaches ahead, plus the number of samples at
/// rest before them that evaluations need.
const LEAST_BEFORE: usize = 24 + 16;
/// Maximum number of samples of a channel. It is limited because the finer history of the channel
/// is kept in memory.
const MOST_SAMPLES: f64 = 2_097_152.0;
/// Default time of a record before the impact \[s\].
const USUAL_BEFORE: f64 = 2e-3;
/// Default full scale of a converter, relative to the largest value of its channel.
const USUAL_FULL_SCALE: f64 = 1.25;

/// The instruments between the rod and the file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstrumentSheet {
    /// Sampling rate, such as `"65.536 kHz"`.
    pub sampling_rate: Exact<Frequency>,
    /// Length of a record, such as `"60 ms"`.
    pub length: Exact<Duration>,
    /// Time of a record before the impact; by default `"2 ms"`.
    pub before: Option<Exact<Duration>>,
    /// Filter before sampling; by default a linear-phase filter with half amplitude at 0.3125 of
    /// the sampling rate.
    pub anti_alias: Option<AntiAliasSheet>,
    /// Standard deviation of the white noise of a sample, as a fraction of the largest value of the
    /// channel, such as `"0.02 %"`, or in the unit of the channel, such as `"0.5 m/s2"`. None by
    /// default.
    pub noise: Option<LevelText>,
    /// Converter; by default none, so that the numbers are not rounded.
    pub converter: Option<ConverterSheet>,
    /// Noise levels of single channels, by their names.
    #[serde(default)]
    pub noise_of: BTreeMap<String, LevelText>,
}

/// An anti-alias filter.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum AntiAliasSheet {
    /// Linear-phase filter with a sharp edge; it has no delay.
    LinearPhase {
        /// Frequency of half amplitude.
        cutoff: Exact<Frequency>,
    },
    /// Butterworth filter, with its phase.
    Butterworth {
        /// Number of poles.
        order: u32,
        /// Corner frequency.
        cutoff: Exact<Frequency>,
    },
    /// Bessel filter, with its phase.
    Bessel {
        /// Number of poles.
        order: u32,
        /// Corner frequency.
        cutoff: Exact<Frequency>,
    },
}

impl AntiAliasSheet {
    pub(in crate::job) fn cutoff(&self) -> &Exact<Frequency> {
        match self {
            Self::LinearPhase { cutoff }
            | Self::Butterworth { cutoff, .. }
            | Self::Bessel { cutoff, .. } => cutoff,
        }
    }

    /// Returns the analogue filter; `None` for the linear-phase filter.
    pub(in crate::job) fn analogue(&self) -> Option<Result<AntiAlias, LabioError>> {
        match self {
            Self::LinearPhase { .. } => None,
            Self::Butterworth { order, cutoff } => {
                Some(AntiAlias::butterworth(*order, cutoff.si()))
            }
            Self::Bessel { order, cutoff } => Some(AntiAlias::bessel(*order, cutoff.si())),
        }
    }

    pub(in crate::job) fn in_words(&self) -> String {
        match self {
            Self::LinearPhase { cutoff } => format!("linear phase, half amplitude at {cutoff}"),
            Self::Butterworth { order, cutoff } => {
                format!("Butterworth of order {order}, {cutoff}")
            }
            Self::Bessel { order, cutoff } => format!("Bessel of order {order}, {cutoff}"),
        }
    }
}

/// A converter.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConverterSheet {
    /// Number of bits.
    pub bits: u32,
    /// Full scale, as a fraction of the largest value of each channel, by default `"125 %"`, or in
    /// the unit of the channels.
    pub full_scale: Option<LevelText>,
}

/// Signals of ideal sensors.
pub(super) struct History {
    /// Name of the method that computed the history.
    pub(super) generator: String,
    /// Time of the first value, counted from the impact \[s\]; before it everything is at rest.
    pub(super) begins: f64,
    /// Time step \[s\].
    pub(super) step: f64,
    pub(super) channels: Vec<Sensed>,
}

/// One channel of a [`History`].
pub(super) struct Sensed {
    pub(super) name: String,
    pub(super) quantity: Quantity,
    /// Values in SI units.
    pub(super) values: Vec<f64>,
}

impl Sensed {
    pub(super) fn new(name: impl Into<String>, quantity: Quantity, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            quantity,
            values,
        }
    }
}

impl InstrumentSheet {
    fn rate_hz(&self) -> f64 {
        self.sampling_rate.si()
    }

    /// Returns the time of a record before the impact \[s\].
    pub(super) fn before(&self) -> f64 {
        self.before.as_ref().map_or(USUAL_BEFORE, Exact::si)
    }

    /// Returns the time step of the required histories \[s\].
    pub(super) fn fine_step(&self) -> f64 {
        1.0 / (self.rate_hz() * FINER as f64)
    }

    /// Returns the duration of the required histories after the impact \[s\]: up to the end of the
    /// record, plus 32 samples for the filter.
    pub(super) fn duration(&self) -> f64 {
        self.length.si() - self.before() + 32.0 / self.rate_hz()
    }

    /// Returns the frequency \[Hz\] up to which the linear-phase filter passes the signal
    /// unchanged.
    pub(super) fn passes_up_to_hz(&self) -> f64 {
        self.cutoff_hz() - 0.08 * self.rate_hz()
    }

    /// Returns the synthesis of histories on a grid finer than the samples, for the experiment
    /// `field`.
    pub(super) fn synthesis(&self, field: &str) -> Result<DampedSynthesis, RodlabError> {
        let step = self.fine_step();
        DampedSynthesis::new(self.duration(), step)
            .and_then(|synthesis| synthesis.smoothed(2.5 * step))
            // the smoothing is compensated: it is not stated in the sheet, so it must not be
            // visible in the band
            .map(DampedSynthesis::flat)
            .in_step(field)
    }

    /// Returns the filter in the form of a sheet in RON.
    pub(super) fn filter_in_ron(&self) -> String {
        match &self.anti_alias {
            None => format!("LinearPhase(cutoff: \"{} Hz\")", self.cutoff_hz()),
            Some(AntiAliasSheet::LinearPhase { cutoff }) => {
                format!("LinearPhase(cutoff: \"{cutoff}\")")
            }
            Some(AntiAliasSheet::Butterworth { order, cutoff }) => {
                format!("Butterworth(order: {order}, cutoff: \"{cutoff}\")")
            }
            Some(AntiAliasSheet::Bessel { order, cutoff }) => {
                format!("Bessel(order: {order}, cutoff: \"{cutoff}\")")
            }
        }
    }

    /// Returns the cut-off frequency of the filter \[Hz\].
    pub(super) fn cutoff_hz(&self) -> f64 {
        match &self.anti_alias {
            None => USUAL_CUTOFF * self.rate_hz(),
            Some(filter) => filter.cutoff().si(),
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be between 0 and some millions"
    )]
    fn samples(&self, duration: f64, field: &str) -> Result<usize, RodlabError> {
        let samples = (duration * self.rate_hz()).round();
        if (LEAST_BEFORE as f64..=MOST_SAMPLES).contains(&samples) {
            Ok(samples as usize)
        } else {
            Err(RodlabError::request(
                field,
                format!("{samples} samples"),
                format!("{LEAST_BEFORE} to {MOST_SAMPLES}"),
            ))
        }
    }

    /// Returns the number of samples of a channel in a record.
    pub(super) fn samples_of_record(&self) -> Result<usize, RodlabError> {
        self.samples(self.length.si(), "instrument.length")
    }

    /// Checks the statements for consistency.
    pub(super) fn check(&self) -> Result<(), RodlabError> {
        let before = self.samples(self.before(), "instrument.before")?;
        let all = self.samples_of_record()?;
        if all < before + LEAST_BEFORE {
            return Err(RodlabError::request(
                "instrument.length",
                self.length.to_string(),
                format!("more than `before`, {} s, and 40 samples", self.before()),
            ));
        }
        if self.cutoff_hz() >= 0.5 * self.rate_hz() {
            return Err(RodlabError::request(
                "instrument.anti_alias.cutoff",
                format!("{} Hz", self.cutoff_hz()),
                format!("below half the sampling rate, {} Hz", 0.5 * self.rate_hz()),
            ));
        }
        Ok(())
    }

    /// Returns `history` after filter and sampling. The record begins at time 0, and the impact is
    /// `before` later.
    #[allow(
        clippy::indexing_slicing,
        reason = "a row of the record is that of a channel of the history"
    )]
    pub(super) fn sampled(&self, history: &History) -> Result<Record, RodlabError> {
        let before = self.samples(self.before(), "instrument.before")?;
        let all = self.samples_of_record()?;
        let channels = history
            .channels
            .iter()
            .map(|channel| Channel::new(&channel.name, channel.quantity))
            .collect::<Result<Vec<_>, _>>()
            .in_step("instrument")?;
        let made_at = |recorder: Recorder, before: usize, all: usize| {
            let values = Array2::from_shape_fn((channels.len(), all), |(channel, sample)| {
                let time = (sample as f64 - before as f64) / recorder.rate_hz - history.begins;
                recorder.filtered(&history.channels[channel].values, history.step, time)
            });
            let made_by = Provenance::computed(&history.generator);
            Record::new(values, recorder.rate_hz, 0.0, channels.clone(), made_by)
                .in_step("instrument")
        };
        let filter = self.anti_alias.as_ref().and_then(AntiAliasSheet::analogue);
        let Some(filter) = filter else {
            let recorder = Recorder {
                rate_hz: self.rate_hz(),
                cutoff_hz: self.cutoff_hz(),
            };
            return made_at(recorder, before, all);
        };
        let filter = filter.in_step("instrument.anti_alias")?;
        // the history is first put on the fine grid, without the frequencies that the filter cannot
        // pass
        let fine = Recorder {
            rate_hz: FINER as f64 * self.rate_hz(),
            cutoff_hz: 2.0 * self.rate_hz(),
        };
        let front_end = Instrument::new()
            .anti_alias(filter)
            .sample(self.rate_hz(), 0.0)
            .in_step("instrument")?;
        let fine = made_at(fine, FINER * before, FINER * all)?;
        // filter and sampler use no random numbers
        let mut random = rand::SeedableRng::seed_from_u64(0);
        let taken = front_end.record::<ChaCha8Rng>(&fine, &mut random);
        Ok(taken.in_step("instrument")?.record)
    }

    /// Returns `sampled` with noise, after the converter. `peaks` are the largest values, to which
    /// relative levels refer.
    pub(super) fn recorded(
        &self,
        sampled: &Record,
        peaks: &[f64],
        random: &mut ChaCha8Rng,
    ) -> Result<Acquisition, RodlabError> {
        for name in self.noise_of.keys() {
            channel_called(sampled.channels(), name, "instrument.noise_of")?;
        }
        let mut instrument = Instrument::new();
        for (channel, peak) in sampled.channels().iter().zip(peaks) {
            let of_its_own = self.noise_of.get(channel.name());
            let field = of_its_own.map_or_else(
                || "instrument.noise".to_owned(),
                |_| format!("instrument.noise_of.{}", channel.name()),
            );
            if let Some(noise) = of_its_own.or(self.noise.as_ref()) {
                let level = noise.of(channel, *peak, &field)?;
                // density of noise that is white up to the Nyquist frequency
                let density = 2.0 * level * level / self.rate_hz();
                let spectrum = NoiseSpectrum::white(density).in_step("instrument")?;
                instrument = instrument.noise(channel.name(), spectrum);
            }
            if let Some(converter) = &self.converter {
                let field = "instrument.converter.full_scale";
                let range = match &converter.full_scale {
                    Some(full_scale) => full_scale.of(channel, *peak, field)?,
                    None => USUAL_FULL_SCALE * peak,
                };
                let converter =
                    Converter::new(converter.bits, range).in_step("instrument.converter")?;
                instrument = instrument.convert_channel(channel.name(), converter);
            }
        }
        instrument.record(sampled, random).in_step("instrument")
    }

    /// Returns the standard deviation of the noise of `channel` in SI units; `None` without noise.
    pub(super) fn noise_level(
        &self,
        channel: &Channel,
        peak: f64,
    ) -> Result<Option<f64>, RodlabError> {
        let noise = self.noise_of.get(channel.name()).or(self.noise.as_ref());
        noise
            .map(|noise| noise.of(channel, peak, "instrument.noise"))
            .transpose()
    }

    /// Returns the defaults of optional fields.
    pub(super) fn defaults(&self) -> Vec<Setting> {
        let anti_alias = format!("linear phase, half amplitude at {} Hz", self.cutoff_hz());
        let mut defaults = vec![
            Setting::by_default("instrument.before", "2 ms"),
            Setting::by_default("instrument.anti_alias", anti_alias),
            Setting::by_default("instrument.noise", "none"),
            Setting::by_default("instrument.converter", "none"),
        ];
        if self.converter.is_some() {
            defaults.push(Setting::by_default(
                "instrument.converter.full_scale",
                "125 %",
            ));
        }
        defaults
    }
}
