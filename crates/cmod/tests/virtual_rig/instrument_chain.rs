//! From histories to averaged spectra: filter once, noise and rounding for every blow.

use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{AveragedSpectra, Channel, Provenance, Quantity, Record, SpectrumAverager, Window};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Uniform};

/// Sampling rate of the recorder [Hz].
pub(crate) const RATE_HZ: f64 = 65_536.0;
/// Histories are finer by this factor.
pub(crate) const OVERSAMPLING: usize = 8;
/// Blows of a test, paper A, section 3.
pub(crate) const BLOWS: usize = 10;
/// Noise of a sensor by the peak of its signal.
const NOISE: f64 = 2e-4;
/// Range of the converter by the peak: blows differ by ± 10 %.
const RANGE: f64 = 1.25;

/// Blows on one set-up, from noise-free and filtered histories.
pub(crate) struct Recorder {
    filtered: Record,
    back_end: Instrument,
    window: Window,
}

impl Recorder {
    /// From exact `histories` (n_channels)(n_samples) at [`OVERSAMPLING`] times the rate, all of the record, by a converter of
    /// `bits`.
    pub(crate) fn new(
        histories: &[Vec<f64>],
        quantity: Quantity,
        bits: u32,
        window: Window,
    ) -> Self {
        let mut samples = Array2::zeros((histories.len(), histories[0].len()));
        for (mut row, history) in samples.rows_mut().into_iter().zip(histories) {
            for (sample, value) in row.iter_mut().zip(history) {
                *sample = *value;
            }
        }
        let channels: Vec<Channel> = (0..histories.len())
            .map(|index| Channel::new(name(index), quantity).unwrap())
            .collect();
        let rate = RATE_HZ * OVERSAMPLING as f64;
        let history = Record::new(
            samples,
            rate,
            0.0,
            channels,
            Provenance::computed("chain recursion"),
        )
        .unwrap();
        let front_end = Instrument::new()
            .anti_alias(AntiAlias::butterworth(8, 22e3).unwrap())
            .sample(RATE_HZ, 0.0)
            .unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let filtered = front_end.record(&history, &mut random).unwrap().record;

        let mut back_end = Instrument::new();
        for index in 0..histories.len() {
            let channel = filtered.channel(&name(index)).unwrap();
            let peak = channel.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
            // one-sided density of white noise: variance by half the rate
            let density = (NOISE * peak).powi(2) / (0.5 * RATE_HZ);
            back_end = back_end
                .noise(name(index), NoiseSpectrum::white(density).unwrap())
                .convert_channel(name(index), Converter::new(bits, RANGE * peak).unwrap());
        }
        Self {
            filtered,
            back_end,
            window,
        }
    }

    /// One blow of a strength of its own.
    fn blow(&self, random: &mut ChaCha8Rng, strength: f64) -> Record {
        let samples = &self.filtered.samples() * strength;
        let signal = Record::new(
            samples,
            RATE_HZ,
            0.0,
            self.filtered.channels().to_vec(),
            Provenance::computed("blow"),
        )
        .unwrap();
        let taken = self.back_end.record(&signal, random).unwrap();
        assert!(taken.saturations.is_empty());
        taken.record
    }

    /// Spectra of every blow of test `seed`.
    pub(crate) fn blows(&self, seed: u64) -> Vec<Record> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let strength = Uniform::new(0.9, 1.1).unwrap();
        (0..BLOWS)
            .map(|_| {
                let strength = strength.sample(&mut random);
                self.blow(&mut random, strength)
            })
            .collect()
    }

    /// Spectra averaged over the blows of test `seed`.
    pub(crate) fn averaged(&self, seed: u64) -> AveragedSpectra {
        let mut averager = SpectrumAverager::for_records_like(&self.filtered, self.window).unwrap();
        for blow in self.blows(seed) {
            averager.add(&blow).unwrap();
        }
        averager.spectra().unwrap()
    }

    /// Spectra of one `record`.
    pub(crate) fn spectra_of(&self, record: &Record) -> AveragedSpectra {
        AveragedSpectra::of([record], self.window).unwrap()
    }

    /// Spectra averaged over `count` records of silence: the noise, as a laboratory measures it.
    pub(crate) fn silence(&self, count: usize, seed: u64) -> AveragedSpectra {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut averager = SpectrumAverager::for_records_like(&self.filtered, self.window).unwrap();
        for _ in 0..count {
            averager.add(&self.blow(&mut random, 0.0)).unwrap();
        }
        averager.spectra().unwrap()
    }

    /// Spectra without noise and converter.
    pub(crate) fn without_noise(&self) -> AveragedSpectra {
        self.spectra_of(&self.filtered)
    }
}

/// Name of the channel `index`.
pub(crate) fn name(index: usize) -> String {
    format!("sensor {index}")
}

/// A `history` of the recorder's fineness after `lead` samples of the recorder at rest, `n_samples` of it in all.
pub(crate) fn after_rest(history: &[f64], lead: usize, n_samples: usize) -> Vec<f64> {
    let rest = std::iter::repeat_n(0.0, lead * OVERSAMPLING);
    let whole = rest.chain(history.iter().copied());
    whole.take(n_samples * OVERSAMPLING).collect()
}
