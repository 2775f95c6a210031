//! Records of hits on a rod by an analyser. The exact histories are filtered once; each hit is
//! scaled by its own strength and has its own noise and rounding.

use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{
    AveragedSpectra, Channel, LabioError, Provenance, Quantity, Record, SpectrumAverager, Window,
};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::RodwaveError;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, RaisedCosine, Specimen};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;

/// Sampling rate \[Hz\]. Like the constants below, it is not stated in the papers.
pub const RATE_HZ: f64 = 65_536.0;
/// Number of samples of an exact history per sample of the recorder.
pub const OVERSAMPLING: usize = 8;
/// Number of samples before a hit on an end.
pub const LEAD: usize = 64;
/// Largest force \[N\] and duration \[s\] of a hit of strength 1.
pub const BLOW: (f64, f64) = (100.0, 8e-5);
/// Noise of a sensor, relative to the peak of its signal.
pub const NOISE: f64 = 2e-4;
/// Range of the converter, relative to the peak of a hit of strength 1: the strengths of the hits
/// differ by ± 10 %.
const RANGE: f64 = 1.25;
const FINER: f64 = OVERSAMPLING as f64;
/// Corner frequency of the anti-alias filter \[Hz\].
const CORNER_HZ: f64 = 22e3;

/// Recorder with the signals of its sensors before noise and rounding.
#[derive(Debug)]
pub struct Recorder {
    filtered: Record,
    bits: u32,
    window: Window,
}

impl Recorder {
    /// Filters and samples exact `histories`, one per channel, at [`OVERSAMPLING`] times the rate,
    /// for a converter with `bits` bits.
    pub fn new(
        histories: &[Vec<f64>],
        quantity: Quantity,
        bits: u32,
        window: Window,
    ) -> Result<Self, LabioError> {
        let n_samples = histories.iter().map(Vec::len).min().unwrap_or_default();
        let mut samples = Array2::zeros((histories.len(), n_samples));
        for (mut row, history) in samples.rows_mut().into_iter().zip(histories) {
            for (sample, value) in row.iter_mut().zip(history) {
                *sample = *value;
            }
        }
        let channels = (0..histories.len()).map(|index| Channel::new(name(index), quantity));
        let channels = channels.collect::<Result<_, _>>()?;
        let provenance = Provenance::computed("exact histories");
        let history = Record::new(samples, RATE_HZ * FINER, 0.0, channels, provenance)?;
        let front_end = Instrument::new()
            .anti_alias(AntiAlias::butterworth(8, CORNER_HZ)?)
            .sample(RATE_HZ, 0.0)?;
        // neither filter nor sampler uses random numbers
        let mut random = ChaCha8Rng::seed_from_u64(0);
        Ok(Self {
            filtered: front_end.record(&history, &mut random)?.record,
            bits,
            window,
        })
    }

    /// Returns a hit of the given strength, without noise and rounding.
    pub fn exact(&self, strength: f64) -> Result<Record, LabioError> {
        Record::new(
            &self.filtered.samples() * strength,
            RATE_HZ,
            0.0,
            self.filtered.channels().to_vec(),
            Provenance::computed("blow"),
        )
    }

    /// Returns `count` hits, each with a strength that `strength` draws. The range of the converter
    /// is set for hits of the strength `range`.
    pub fn blows(
        &self,
        range: f64,
        count: usize,
        seed: u64,
        mut strength: impl FnMut(&mut ChaCha8Rng) -> f64,
    ) -> Result<Vec<Record>, LabioError> {
        let mut instrument = Instrument::new();
        for channel in self.filtered.channels() {
            let history = self.filtered.channel(channel.name())?;
            let peak = history.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
            // one-sided density of white noise: variance over half the sampling rate
            let density = (NOISE * peak).powi(2) / (0.5 * RATE_HZ);
            let converter = Converter::new(self.bits, RANGE * range * peak)?;
            instrument = instrument
                .noise(channel.name(), NoiseSpectrum::white(density)?)
                .convert_channel(channel.name(), converter);
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut blow = || {
            let exact = self.exact(strength(&mut random))?;
            let taken = instrument.record(&exact, &mut random)?;
            assert!(taken.saturations.is_empty(), "{:?}", taken.saturations);
            Ok(taken.record)
        };
        (0..count).map(|_| blow()).collect()
    }

    /// Returns the averaged spectra of `records`.
    pub fn averaged(&self, records: &[Record]) -> Result<AveragedSpectra, LabioError> {
        let mut averager = SpectrumAverager::for_records_like(&self.filtered, self.window)?;
        for record in records {
            averager.add(record)?;
        }
        averager.spectra()
    }
}

/// Returns the name of the channel with this `index`.
pub fn name(index: usize) -> String {
    format!("sensor {index}")
}

/// Returns `history`, which has [`OVERSAMPLING`] values per sample of the recorder, after `lead`
/// samples at rest. The total length is `n_samples` samples of the recorder.
pub fn after_rest(history: &[f64], lead: usize, n_samples: usize) -> Vec<f64> {
    let rest = std::iter::repeat_n(0.0, lead * OVERSAMPLING);
    let whole = rest.chain(history.iter().copied());
    whole.take(n_samples * OVERSAMPLING).collect()
}

/// Returns the exact accelerations of the struck and the free end of a specimen, after [`LEAD`]
/// samples at rest, for `n_samples` samples of the recorder.
pub fn end_accelerations(
    medium: &Medium<ConstantQ>,
    specimen: &Specimen,
    n_samples: usize,
) -> Result<[Vec<f64>; 2], RodwaveError> {
    let interval = 1.0 / (RATE_HZ * FINER);
    let duration = (n_samples * OVERSAMPLING) as f64 * interval;
    // a smoothing over 2.5 intervals leaves no ringing, and is the same for both ends
    let synthesis = DampedSynthesis::new(duration, interval)?.smoothed(2.5 * interval)?;
    let exact = EndAccelerationTest::analytic(medium, specimen)?
        .record(&RaisedCosine::new(BLOW.0, BLOW.1)?, &synthesis)?;
    Ok([exact.impacted_end, exact.free_end].map(|history| after_rest(&history, LEAD, n_samples)))
}
