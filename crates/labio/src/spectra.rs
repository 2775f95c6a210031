//! Auto- and cross-spectra, averaged over hits as they come.

use ndarray::Array2;
use num_complex::Complex64;

use crate::channel::{self, Channel};
use crate::dft::Dft;
use crate::error::check_positive;
use crate::{LabioError, Record, SampledWindow, Window};

/// Two sampling rates are the same if they differ relatively by less than this: over a record of a million samples the
/// last ones are then a thousandth of a sample apart. Rates taken from a column of times differ in their last digits.
const SAMPLING_RATE_TOLERANCE: f64 = 1e-9;

/// Sums of the spectra of hits, from which the averages can be taken at any time.
///
/// Memory: the samples of one hit, one transform a channel and the sums, whatever the number of hits. Nothing is
/// allocated after construction.
///
/// # Scaling
///
/// With $`X_k = \Delta t\sum_n w_n x_n e^{-2\pi i kn/N}`$ \[unit s\], the one-sided *energy* spectral density of a hit is
///
/// ```math
/// G_{xy}(f_k) = \frac{c_k}{\overline{w^2}}\,X_k^* Y_k , \qquad
/// c_k = 1 \text{ at 0 Hz and at the Nyquist frequency, 2 elsewhere},
/// ```
///
/// with $`f_k = k/(N\Delta t)`$ and $`\overline{w^2}`$ the mean squared weight of the window. Its unit is unit² s/Hz. A rectangular
/// window makes Parseval's relation exact, $`\sum_k G_{xx}(f_k)/(N\Delta t) = \Delta t\sum_n x_n^2`$. Divided by the duration
/// $`N\Delta t`$ it is the power spectral density of a stationary signal. The conjugate is on the *first* channel.
#[derive(Debug)]
pub struct SpectrumAverager {
    channels: Vec<Channel>,
    sampling_rate_hz: f64,
    n_samples: usize,
    window: Window,
    sampled_window: SampledWindow,
    dft: Dft,
    /// Transforms of the hit at hand, `(n_channels, n_lines)`.
    lines: Array2<Complex64>,
    /// Sums of |X|^2, `(n_channels, n_lines)`.
    auto_sums: Array2<f64>,
    /// Sums of conj(X) Y over the pairs in the order of `pair_index`, `(n_pairs, n_lines)`.
    cross_sums: Array2<Complex64>,
    n_averages: usize,
}

impl SpectrumAverager {
    /// An averager for hits with these channels and this sampling.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for the sampling rate, [`LabioError::TooFewSamples`] for the window,
    /// [`LabioError::CountMismatch`] without a channel, [`LabioError::DuplicateChannel`].
    pub fn new(
        channels: &[Channel],
        n_samples: usize,
        sampling_rate_hz: f64,
        window: Window,
    ) -> Result<Self, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        channel::check_distinct(channels)?;
        let sampled_window = window.sample(n_samples)?;
        let n_channels = channels.len();
        if n_channels == 0 {
            return Err(LabioError::CountMismatch {
                what: "channels to average",
                found: 0,
                expected: 1,
            });
        }
        let n_lines = n_samples / 2 + 1;
        Ok(Self {
            channels: channels.to_vec(),
            sampling_rate_hz,
            n_samples,
            window,
            sampled_window,
            dft: Dft::new(n_samples),
            lines: Array2::zeros((n_channels, n_lines)),
            auto_sums: Array2::zeros((n_channels, n_lines)),
            cross_sums: Array2::zeros((n_channels * (n_channels - 1) / 2, n_lines)),
            n_averages: 0,
        })
    }

    /// An averager for hits that have the channels and the sampling of `record`, which is not added.
    ///
    /// # Errors
    ///
    /// As [`SpectrumAverager::new`].
    pub fn for_records_like(record: &Record, window: Window) -> Result<Self, LabioError> {
        Self::new(
            record.channels(),
            record.n_samples(),
            record.sampling_rate_hz(),
            window,
        )
    }

    /// Adds one hit. After an error the sums are what they were.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`], [`LabioError::ChannelMismatch`] or [`LabioError::SamplingRateMismatch`] if the
    /// hit is not like the ones before.
    pub fn add(&mut self, hit: &Record) -> Result<(), LabioError> {
        self.check_like(hit)?;
        for (samples, mut line) in hit.samples().rows().into_iter().zip(self.lines.rows_mut()) {
            let weighted = samples
                .iter()
                .zip(&self.sampled_window.weights)
                .map(|(sample, weight)| sample * weight);
            for (slot, value) in line.iter_mut().zip(self.dft.of(weighted)) {
                *slot = *value;
            }
        }
        self.auto_sums
            .zip_mut_with(&self.lines, |sum, line| *sum += line.norm_sqr());
        let n_channels = self.channels.len();
        for (a, first) in self.lines.rows().into_iter().enumerate() {
            for (b, second) in self.lines.rows().into_iter().enumerate().skip(a + 1) {
                let mut sums = self.cross_sums.row_mut(pair_index(n_channels, a, b));
                for ((sum, x), y) in sums.iter_mut().zip(first).zip(second) {
                    *sum += x.conj() * y;
                }
            }
        }
        self.n_averages += 1;
        Ok(())
    }

    /// Number of hits added.
    #[must_use]
    pub fn n_averages(&self) -> usize {
        self.n_averages
    }

    /// The averages over the hits added so far.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewAverages`] before the first hit; [`LabioError::SpectrumOverflow`] if finite samples were too
    /// large for finite spectra.
    pub fn spectra(&self) -> Result<AveragedSpectra, LabioError> {
        if self.n_averages == 0 {
            return Err(LabioError::TooFewAverages {
                estimate: "an averaged spectrum",
                found: 0,
                expected: 1,
            });
        }
        let time_step = 1.0 / self.sampling_rate_hz;
        let two_sided =
            time_step * time_step / (self.sampled_window.power_gain * self.n_averages as f64);
        let n_samples = self.n_samples;
        let scale = |line: usize| {
            if line == 0 || 2 * line == n_samples {
                two_sided
            } else {
                2.0 * two_sided
            }
        };
        let mut auto = self.auto_sums.clone();
        for (mut row, channel) in auto.rows_mut().into_iter().zip(&self.channels) {
            for (line, value) in row.iter_mut().enumerate() {
                *value *= scale(line);
                if !value.is_finite() {
                    return Err(LabioError::SpectrumOverflow {
                        channel: channel.name().to_owned(),
                        line,
                    });
                }
            }
        }
        // |conj(X) Y| <= (|X|^2 + |Y|^2)/2: finite with the auto-spectra
        let mut cross = self.cross_sums.clone();
        for ((_, line), value) in cross.indexed_iter_mut() {
            *value *= scale(line);
        }
        let line_spacing_hz = self.sampling_rate_hz / n_samples as f64;
        Ok(AveragedSpectra {
            channels: self.channels.clone(),
            n_averages: self.n_averages,
            n_samples,
            window: self.window,
            line_spacing_hz,
            noise_bandwidth_hz: self.sampled_window.noise_bandwidth_lines * line_spacing_hz,
            frequency_hz: (0..=n_samples / 2)
                .map(|k| k as f64 * line_spacing_hz)
                .collect(),
            auto,
            cross,
        })
    }

    fn check_like(&self, hit: &Record) -> Result<(), LabioError> {
        let counts = [
            (
                "channels of a hit",
                hit.channels().len(),
                self.channels.len(),
            ),
            ("samples of a hit", hit.n_samples(), self.n_samples),
        ];
        for (what, found, expected) in counts {
            if found != expected {
                return Err(LabioError::CountMismatch {
                    what,
                    found,
                    expected,
                });
            }
        }
        for (index, (found, expected)) in hit.channels().iter().zip(&self.channels).enumerate() {
            if found != expected {
                return Err(LabioError::ChannelMismatch {
                    index,
                    found: found.to_string(),
                    expected: expected.to_string(),
                });
            }
        }
        let (found_hz, expected_hz) = (hit.sampling_rate_hz(), self.sampling_rate_hz);
        if (found_hz - expected_hz).abs() > SAMPLING_RATE_TOLERANCE * expected_hz {
            return Err(LabioError::SamplingRateMismatch {
                found_hz,
                expected_hz,
            });
        }
        Ok(())
    }
}

/// The Hermitian matrix of averaged one-sided energy spectral densities, line by line; scaled as
/// [`SpectrumAverager`] says.
#[derive(Debug, Clone)]
pub struct AveragedSpectra {
    channels: Vec<Channel>,
    n_averages: usize,
    n_samples: usize,
    window: Window,
    line_spacing_hz: f64,
    noise_bandwidth_hz: f64,
    frequency_hz: Vec<f64>,
    auto: Array2<f64>,
    cross: Array2<Complex64>,
}

impl AveragedSpectra {
    /// The averages over `hits`, which all have the channels and the sampling of the first.
    ///
    /// # Errors
    ///
    /// As [`SpectrumAverager::add`] and [`SpectrumAverager::spectra`].
    pub fn of<'a>(
        hits: impl IntoIterator<Item = &'a Record>,
        window: Window,
    ) -> Result<Self, LabioError> {
        let mut hits = hits.into_iter();
        let Some(first) = hits.next() else {
            return Err(LabioError::TooFewAverages {
                estimate: "an averaged spectrum",
                found: 0,
                expected: 1,
            });
        };
        let mut averager = SpectrumAverager::for_records_like(first, window)?;
        averager.add(first)?;
        for hit in hits {
            averager.add(hit)?;
        }
        averager.spectra()
    }

    /// The channels, in the order of the hits' rows.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Number of hits averaged.
    #[must_use]
    pub fn n_averages(&self) -> usize {
        self.n_averages
    }

    /// Number of samples a hit.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// The window that was applied.
    #[must_use]
    pub fn window(&self) -> Window {
        self.window
    }

    /// Frequencies of the lines \[Hz\], from 0; `(n_lines)`.
    #[must_use]
    pub fn frequency_hz(&self) -> &[f64] {
        &self.frequency_hz
    }

    /// Distance between lines \[Hz\]: the inverse of the duration of a hit.
    #[must_use]
    pub fn line_spacing_hz(&self) -> f64 {
        self.line_spacing_hz
    }

    /// Equivalent noise bandwidth of a line \[Hz\].
    #[must_use]
    pub fn noise_bandwidth_hz(&self) -> f64 {
        self.noise_bandwidth_hz
    }

    /// Averaged auto-spectrum $`G_{xx}`$ \[unit² s/Hz\] of a channel; `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn auto(&self, channel: &str) -> Result<Vec<f64>, LabioError> {
        let (index, _) = channel::find(&self.channels, channel)?;
        Ok(self.auto.row(index).to_vec())
    }

    /// Averaged cross-spectrum $`G_{xy} = \overline{X^* Y}`$ \[unit unit s/Hz\] from `first` to `second`; `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn cross(&self, first: &str, second: &str) -> Result<Vec<Complex64>, LabioError> {
        let (a, _) = channel::find(&self.channels, first)?;
        let (b, _) = channel::find(&self.channels, second)?;
        let n_channels = self.channels.len();
        Ok(match a.cmp(&b) {
            std::cmp::Ordering::Equal => self.auto.row(a).iter().map(|&s| s.into()).collect(),
            std::cmp::Ordering::Less => self.cross.row(pair_index(n_channels, a, b)).to_vec(),
            std::cmp::Ordering::Greater => self
                .cross
                .row(pair_index(n_channels, b, a))
                .iter()
                .map(Complex64::conj)
                .collect(),
        })
    }
}

/// Row of the pair (a, b), a < b < n, when the pairs stand as (0,1), (0,2) .. (0,n-1), (1,2) ..
fn pair_index(n_channels: usize, a: usize, b: usize) -> usize {
    a * (2 * n_channels - a - 1) / 2 + b - a - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Provenance, Quantity};
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const NAMES: [&str; 3] = ["a", "b", "c"];

    fn record(rows: &[Vec<f64>], sampling_rate_hz: f64) -> Record {
        let samples = Array2::from_shape_fn((rows.len(), rows[0].len()), |(c, n)| rows[c][n]);
        let channels = NAMES[..rows.len()]
            .iter()
            .map(|name| Channel::new(*name, Quantity::Velocity).unwrap())
            .collect();
        let provenance = Provenance::computed("random numbers");
        Record::new(samples, sampling_rate_hz, 0.0, channels, provenance).unwrap()
    }

    fn noise(rng: &mut ChaCha8Rng, n: usize) -> Vec<f64> {
        (0..n).map(|_| StandardNormal.sample(rng)).collect()
    }

    proptest! {
        /// Energy in time is energy in frequency, for even and odd lengths.
        #[test]
        fn parseval(samples in prop::collection::vec(-1e3..1e3_f64, 3..200), rate in 1.0..1e6_f64) {
            let energy: f64 = samples.iter().map(|x| x * x).sum::<f64>() / rate;
            let spectra = AveragedSpectra::of([&record(&[samples], rate)], Window::Rectangular).unwrap();
            let lines: f64 = spectra.auto("a").unwrap().iter().sum::<f64>() * spectra.line_spacing_hz();
            // 200 terms of one sign, each rounded a few times
            prop_assert!((lines - energy).abs() <= 1e-13 * energy);
        }
    }

    #[test]
    fn the_spectral_matrix_is_the_average_of_direct_sums() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (n, rate, n_hits) = (30, 50.0, 4);
        let hits: Vec<Vec<Vec<f64>>> = (0..n_hits)
            .map(|_| (0..3).map(|_| noise(&mut rng, n)).collect())
            .collect();
        let records: Vec<Record> = hits.iter().map(|rows| record(rows, rate)).collect();
        let spectra = AveragedSpectra::of(&records, Window::HannPeriodic).unwrap();
        assert_eq!(spectra.n_averages(), n_hits);
        let transform = |samples: &[f64], k: usize| -> Complex64 {
            (0..n)
                .map(|i| {
                    let hann = (TAU / 2.0 * i as f64 / n as f64).sin().powi(2);
                    samples[i] * hann / rate * Complex64::cis(-TAU * (k * i) as f64 / n as f64)
                })
                .sum()
        };
        for (a, first) in NAMES.iter().enumerate() {
            for (b, second) in NAMES.iter().enumerate() {
                let cross = spectra.cross(first, second).unwrap();
                for (k, line) in cross.iter().enumerate() {
                    let sides = if k == 0 || k == n / 2 { 1.0 } else { 2.0 };
                    let mean: Complex64 = hits
                        .iter()
                        .map(|h| transform(&h[a], k).conj() * transform(&h[b], k))
                        .sum::<Complex64>()
                        / n_hits as f64;
                    let expected = sides * mean / 0.375; // mean squared Hann weight
                    // spectra are of order n/rate^2 = 0.01; a few hundred roundings
                    assert!((line - expected).norm() < 1e-15, "{first}{second} {k}");
                }
            }
        }
    }

    #[test]
    fn a_sine_has_its_energy_in_one_line_and_its_amplitude_through_the_coherent_gain() {
        let (n, rate, amplitude, line) = (64, 32.0, 3.0, 5);
        let sine: Vec<f64> = (0..n)
            .map(|i| amplitude * (TAU * (line * i) as f64 / n as f64 + 0.4).sin())
            .collect();
        let duration = n as f64 / rate;
        let hann = Window::HannPeriodic.sample(n).unwrap();
        for (window, gain, power_gain) in [
            (Window::Rectangular, 1.0, 1.0),
            (Window::HannPeriodic, hann.coherent_gain, hann.power_gain),
        ] {
            let spectra =
                AveragedSpectra::of([&record(std::slice::from_ref(&sine), rate)], window).unwrap();
            let peak = spectra.auto("a").unwrap()[line];
            // one-sided: G = 2 (gain A T / 2)^2 / mean w^2; one-line closed form, so only rounding remains
            let found = (2.0 * peak * power_gain).sqrt() / (duration * gain);
            assert!((found - amplitude).abs() < 1e-13 * amplitude);
        }
    }

    #[test]
    fn averaged_spectra_of_noise_spread_as_chi_square() {
        // 2 n G/E[G] is chi-square with 2n degrees of freedom: mean 1, relative variance 1/n, third moment 2/n^2
        let (n_samples, rate, n_hits) = (8192, 1000.0, 10);
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut averager = SpectrumAverager::new(
            &[Channel::new("a", Quantity::Velocity).unwrap()],
            n_samples,
            rate,
            Window::Rectangular,
        )
        .unwrap();
        for _ in 0..n_hits {
            let hit = record(&[noise(&mut rng, n_samples)], rate);
            averager.add(&hit).unwrap();
        }
        let spectra = averager.spectra().unwrap();
        // unit white noise: power density 2/rate, energy density times the duration
        let expected = 2.0 / rate * n_samples as f64 / rate;
        let relative: Vec<f64> = spectra.auto("a").unwrap()[1..n_samples / 2]
            .iter()
            .map(|g| g / expected)
            .collect();
        let lines = relative.len() as f64;
        let moment = |p: i32, about: f64| -> f64 {
            relative.iter().map(|g| (g - about).powi(p)).sum::<f64>() / lines
        };
        let (mean, hits) = (moment(1, 0.0), n_hits as f64);
        let (variance, third) = (moment(2, 1.0), moment(3, 1.0));
        // 4095 independent lines; four standard errors of each moment of a gamma law of shape 10:
        // mean sqrt(1/10/4095) = 0.0049; variance sqrt((2 + 6/10)/100/4095) = 0.0025; third moment, by its sixth, 0.0030
        assert!((mean - 1.0).abs() < 4.0 * 0.0049, "mean {mean}");
        assert!(
            (variance - 1.0 / hits).abs() < 4.0 * 0.0025,
            "variance {variance}"
        );
        assert!(
            (third - 2.0 / (hits * hits)).abs() < 4.0 * 0.0030,
            "third {third}"
        );
    }

    #[test]
    fn a_hit_unlike_the_others_is_refused_and_leaves_the_sums_alone() {
        let good = record(&[vec![1.0, 2.0, 0.5], vec![0.0, 1.0, 0.0]], 10.0);
        let mut averager = SpectrumAverager::for_records_like(&good, Window::Rectangular).unwrap();
        averager.add(&good).unwrap();
        let before = averager.spectra().unwrap();
        let other_channel = Record::new(
            good.samples().to_owned(),
            10.0,
            0.0,
            vec![
                Channel::new("a", Quantity::Velocity).unwrap(),
                Channel::new("b", Quantity::Force).unwrap(),
            ],
            Provenance::computed("test"),
        )
        .unwrap();
        let refusals = [
            record(&[vec![1.0, 2.0], vec![0.0, 1.0]], 10.0),
            record(&[vec![1.0, 2.0, 3.0]], 10.0),
            record(&[vec![1.0, 2.0, 0.5], vec![0.0, 1.0, 0.0]], 10.001),
            other_channel,
        ]
        .map(|hit| averager.add(&hit).unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        samples of a hit: found 2, expected 3
        channels of a hit: found 1, expected 2
        the sampling rate is 10.001 Hz, expected 10 Hz as in the hits before
        channel 1 is `b` [N], expected `b` [m/s] as in the hits before
        ");
        assert_eq!(averager.spectra().unwrap().auto, before.auto);
        assert_eq!(averager.n_averages(), 1);
    }

    #[test]
    fn finite_samples_with_an_infinite_spectrum_are_an_error() {
        let hit = record(&[vec![1e200, -1e200, 1e200]], 10.0);
        let error = AveragedSpectra::of([&hit], Window::Rectangular).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the spectrum of channel `a` overflows at line 0"
        );
    }

    #[test]
    fn no_hit_is_an_error() {
        let error = AveragedSpectra::of([], Window::Rectangular).unwrap_err();
        assert_eq!(
            error.to_string(),
            "an averaged spectrum needs at least 1 averages, found 0"
        );
    }
}
