//! Accumulation of the spectra of hits.

use num_complex::Complex64;

use super::ending::{Completion, Ending, tail_length};
use super::{AveragedSpectra, AveragedTails, Detrend};
use crate::channel::{self, Channel};
use crate::dft::Dft;
use crate::error::{check_count, check_positive, count_mismatch, non_physical, too_few_averages};
use crate::window::check_length;
use crate::{AddedDamping, ForceWindow, LabioError, Record, Window};

/// Largest relative difference between sampling rates that count as equal: in a record of a million
/// samples, the last samples are then a thousandth of a sample apart. Rates computed from a column
/// of times differ in their last digits.
const SAMPLING_RATE_TOLERANCE: f64 = 1e-9;

/// Number of lines for which two channels and their sums fit into the first-level cache.
const LINES_A_BLOCK: usize = 512;

/// Sums of the spectra of hits, from which the averages can be computed at any time.
///
/// Memory: the samples of one hit, one transform per channel and the sums, independent of the
/// number of hits. Nothing is allocated after construction.
///
/// # Scaling
///
/// With $`X_k = \Delta t\sum_n w_n x_n e^{-2\pi i kn/N}`$ \[unit s\], the one-sided *energy*
/// spectral density of a hit is
///
/// ```math
/// G_{xy}(f_k) = \frac{c_k}{\overline{w^2}}\,X_k^* Y_k , \qquad
/// c_k = 1 \text{ at 0 Hz and at the Nyquist frequency, 2 elsewhere},
/// ```
///
/// with $`f_k = k/(N\Delta t)`$ and $`\overline{w^2}`$ the mean squared weight of the window. Its
/// unit is unit² s/Hz. With a rectangular window, Parseval's relation is exact,
/// $`\sum_k G_{xx}(f_k)/(N\Delta t) = \Delta t\sum_n x_n^2`$. Divided by the duration
/// $`N\Delta t`$, it is the power spectral density of a stationary signal. The *first* channel is
/// conjugated.
///
/// A [`ForceWindow`] and an exponential window ([`AddedDamping`]) are treated as parts of the
/// signals: levels are not corrected for them.
#[derive(Debug)]
pub struct SpectrumAverager {
    channels: Vec<Channel>,
    sampling_rate_hz: f64,
    n_samples: usize,
    window: Window,
    gains: Gains,
    detrend: Detrend,
    added_damping: Option<AddedDamping>,
    /// Weights, one list per channel, which is empty if all weights are 1.
    weights: Vec<Vec<f64>>,
    dft: Dft,
    /// Transforms of the current hit, one per channel.
    lines: Vec<Vec<Complex64>>,
    /// Sums of |X|^2, one list per channel.
    auto_sums: Vec<Vec<f64>>,
    /// Sums of conj(X) Y, one list per pair in the order of `pair_index`.
    cross_sums: Vec<Vec<Complex64>>,
    tails: Option<Tails>,
    n_averages: usize,
}

/// Data of the end parts of the hits.
#[derive(Debug)]
struct Tails {
    completion: Completion,
    /// Motion after the end, one entry per channel.
    endings: Vec<Ending>,
    /// End part of the current channel, from which the leakage is estimated.
    tail: Vec<f64>,
    /// Transforms of the end parts, one per channel.
    lines: Vec<Vec<Complex64>>,
    /// Sums of conj(X) T for the lines X of each channel and the end part T of each channel, in
    /// rows by the first channel.
    sums: Vec<Vec<Complex64>>,
}

/// Task that accumulates one hit with the vector instructions of the processor.
struct Accumulation<'a>(&'a mut SpectrumAverager);

impl pulp::NullaryFnOnce for Accumulation<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.accumulate_vectorised();
    }
}

impl SpectrumAverager {
    /// Creates an averager for hits with these channels and this sampling.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for the sampling rate, [`LabioError::TooFewSamples`] for too few
    /// samples for the window, [`LabioError::CountMismatch`] without a channel,
    /// [`LabioError::DuplicateChannel`].
    pub fn new(
        channels: &[Channel],
        n_samples: usize,
        sampling_rate_hz: f64,
        window: Window,
    ) -> Result<Self, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        channel::check_distinct(channels)?;
        check_length(n_samples)?;
        let (weights, gains) = weigh(window, n_samples)?;
        let n_channels = channels.len();
        if n_channels == 0 {
            return count_mismatch("channels to average", 0, 1);
        }
        let n_lines = n_samples / 2 + 1;
        let n_pairs = n_channels * (n_channels - 1) / 2;
        Ok(Self {
            channels: channels.to_vec(),
            sampling_rate_hz,
            n_samples,
            window,
            gains,
            detrend: Detrend::None,
            added_damping: None,
            weights: vec![weights; n_channels],
            dft: Dft::new(n_samples),
            lines: vec![vec![Complex64::ZERO; n_lines]; n_channels],
            auto_sums: vec![vec![0.0; n_lines]; n_channels],
            cross_sums: vec![vec![Complex64::ZERO; n_lines]; n_pairs],
            tails: None,
            n_averages: 0,
        })
    }

    /// Creates an averager for hits with the channels and the sampling of `record`. The record
    /// itself is not added.
    ///
    /// # Errors
    ///
    /// The errors of [`SpectrumAverager::new`].
    pub fn for_records_like(record: &Record, window: Window) -> Result<Self, LabioError> {
        Self::new(
            record.channels(),
            record.n_samples(),
            record.sampling_rate_hz(),
            window,
        )
    }

    /// Sets the trend that is removed from every hit added from now on.
    #[must_use]
    pub fn with_detrend(self, detrend: Detrend) -> Self {
        Self { detrend, ..self }
    }

    /// Treats every hit as a transient that continues after its record: a velocity as constant, a
    /// displacement as a straight line, every other quantity at rest.
    ///
    /// The constant and the straight line are least-squares fits to the last quarter of the hit,
    /// weighted by a Hann window; the part after the end is added in closed form. Without an
    /// exponential window, the line at 0 Hz of a body that keeps moving is not defined. The
    /// residual of the last quarter gives [`AveragedSpectra::leakage`].
    ///
    /// # Validity
    ///
    /// The level before the hit is zero, as after [`Detrend::Rest`]. The impact is before the last
    /// quarter.
    ///
    /// # Errors
    ///
    /// [`LabioError::WindowConflict`] if the averager has a window other than the rectangular one;
    /// [`LabioError::TooManyAverages`] if hits have already been added.
    pub fn with_completion(mut self) -> Result<Self, LabioError> {
        self.check_no_other_window("completion of the motion")?;
        let n_channels = self.channels.len();
        let n_lines = self.n_samples / 2 + 1;
        self.tails = Some(Tails {
            completion: self.completion(),
            endings: self
                .channels
                .iter()
                .map(|channel| Ending::of(channel.quantity()))
                .collect(),
            tail: vec![0.0; tail_length(self.n_samples)],
            lines: vec![vec![Complex64::ZERO; n_lines]; n_channels],
            sums: vec![vec![Complex64::ZERO; n_lines]; n_channels * n_channels],
        });
        Ok(self)
    }

    fn completion(&self) -> Completion {
        let decay = self.added_damping.map_or(1.0, |window| {
            (-window.decay_rate() / self.sampling_rate_hz).exp()
        });
        Completion::new(self.n_samples, decay)
    }

    /// Applies a force window to one channel.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`]; [`LabioError::WindowConflict`] if the averager has a window
    /// other than the rectangular one; [`LabioError::TooManyAverages`] if hits have already been
    /// added.
    #[allow(
        clippy::indexing_slicing,
        reason = "the index that `find` returns for a channel is also the index of its weights"
    )]
    pub fn with_force_window(
        mut self,
        channel: &str,
        window: ForceWindow,
    ) -> Result<Self, LabioError> {
        self.check_no_other_window("a force window")?;
        let (index, _) = channel::find(&self.channels, channel)?;
        let gate = window.weights(self.n_samples, self.sampling_rate_hz)?;
        multiply(&mut self.weights[index], &gate);
        Ok(self)
    }

    /// Applies an exponential window to all channels, so that ratios of spectra are transfer
    /// functions on the line $`s = \sigma + i\omega`$: see [`AddedDamping`].
    ///
    /// # Errors
    ///
    /// [`LabioError::WindowConflict`] if the averager has a window other than the rectangular one,
    /// or already has an exponential window; [`LabioError::TooManyAverages`] if hits have already
    /// been added.
    pub fn with_exponential_window(mut self, window: AddedDamping) -> Result<Self, LabioError> {
        self.check_no_other_window("an exponential window")?;
        if self.added_damping.is_some() {
            return Err(LabioError::WindowConflict {
                asked: "an exponential window",
                present: "an exponential window".to_owned(),
            });
        }
        let decay = window.weights(self.n_samples, self.sampling_rate_hz)?;
        for weights in &mut self.weights {
            multiply(weights, &decay);
        }
        self.added_damping = Some(window);
        let completion = self.completion();
        if let Some(tails) = &mut self.tails {
            tails.completion = completion;
        }
        Ok(self)
    }

    /// Adds one hit. An error leaves the sums unchanged.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`], [`LabioError::ChannelMismatch`] or
    /// [`LabioError::SamplingRateMismatch`] if the hit does not match the averager.
    pub fn add(&mut self, hit: &Record) -> Result<(), LabioError> {
        self.check_channels(hit)?;
        check_count("samples of a hit", hit.n_samples(), self.n_samples)?;
        for (index, samples) in hit.samples().rows().into_iter().enumerate() {
            let input = self.dft.input();
            if let Some(samples) = samples.to_slice() {
                input.copy_from_slice(samples);
            } else {
                for (slot, sample) in input.iter_mut().zip(samples) {
                    *slot = *sample;
                }
            }
            self.transform(index);
        }
        self.accumulate();
        Ok(())
    }

    /// Adds one segment: `samples_of` returns the samples of a channel.
    pub(super) fn add_segment<'a>(&mut self, samples_of: impl Fn(usize) -> &'a [f64]) {
        for index in 0..self.channels.len() {
            self.dft.input().copy_from_slice(samples_of(index));
            self.transform(index);
        }
        self.accumulate();
    }

    /// Computes the lines of a channel from the samples in the input of the transform.
    #[allow(
        clippy::indexing_slicing,
        reason = "`channel` counts the channels, each of which has weights and lines"
    )]
    fn transform(&mut self, channel: usize) {
        let input = self.dft.input();
        self.detrend.apply(input);
        let weights = &self.weights[channel];
        let Some(tails) = &mut self.tails else {
            for (sample, weight) in input.iter_mut().zip(weights) {
                *sample *= weight;
            }
            self.dft.transform(&mut self.lines[channel]);
            return;
        };
        let n_tail = tails.tail.len();
        let begin = input.len() - n_tail;
        let ending = tails.endings[channel];
        let end = ending.fit(&input[begin..]);
        let at_end = input[begin..].iter().zip(&tails.completion.cut);
        for (index, (slot, (sample, cut))) in tails.tail.iter_mut().zip(at_end).enumerate() {
            *slot = cut * (sample - end.at(n_tail - index));
        }
        for (sample, weight) in input.iter_mut().zip(weights) {
            *sample *= weight;
        }
        for (sample, weight) in tails.tail.iter_mut().zip(weights.iter().skip(begin)) {
            *sample *= weight;
        }
        self.dft.transform(&mut self.lines[channel]);
        tails
            .completion
            .complete(ending, end, &mut self.lines[channel]);
        let input = self.dft.input();
        input[..begin].fill(0.0);
        input[begin..].copy_from_slice(&tails.tail);
        self.dft.transform(&mut tails.lines[channel]);
    }

    fn accumulate(&mut self) {
        pulp::Arch::new().dispatch(Accumulation(self));
        if let Some(tails) = &mut self.tails {
            let pairs = self
                .lines
                .iter()
                .flat_map(|x| tails.lines.iter().map(move |tail| (x, tail)));
            for ((x, tail), sums) in pairs.zip(&mut tails.sums) {
                for ((sum, x), tail) in sums.iter_mut().zip(x).zip(tail) {
                    *sum += x.conj() * tail;
                }
            }
        }
        self.n_averages += 1;
    }

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "all lists were made for `n_lines` lines, with which the last block ends"
    )]
    fn accumulate_vectorised(&mut self) {
        // in blocks that stay in the cache while all pairs are summed
        let n_lines = self.n_samples / 2 + 1;
        let mut start = 0;
        while start < n_lines {
            let block = start..n_lines.min(start + LINES_A_BLOCK);
            start = block.end;
            for (sums, lines) in self.auto_sums.iter_mut().zip(&self.lines) {
                for (sum, x) in sums[block.clone()].iter_mut().zip(&lines[block.clone()]) {
                    *sum += x.norm_sqr();
                }
            }
            let mut pairs = self.cross_sums.iter_mut();
            for (a, first) in self.lines.iter().enumerate() {
                let first = &first[block.clone()];
                for (second, sums) in self.lines.iter().skip(a + 1).zip(&mut pairs) {
                    let second = &second[block.clone()];
                    for ((sum, x), y) in sums[block.clone()].iter_mut().zip(first).zip(second) {
                        *sum += x.conj() * y;
                    }
                }
            }
        }
    }

    /// Number of hits added.
    #[must_use]
    pub fn n_averages(&self) -> usize {
        self.n_averages
    }

    /// Returns the averages over the hits added so far, which are treated as independent.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewAverages`] before the first hit; [`LabioError::SpectrumOverflow`] if
    /// finite samples were too large for finite spectra.
    pub fn spectra(&self) -> Result<AveragedSpectra, LabioError> {
        let (auto, cross) = (self.auto_sums.clone(), self.cross_sums.clone());
        self.averaged(auto, cross, self.n_averages as f64)
    }

    /// Form of [`SpectrumAverager::spectra`] that consumes the averager.
    pub(super) fn into_averages(
        mut self,
        effective_averages: f64,
    ) -> Result<AveragedSpectra, LabioError> {
        let auto = std::mem::take(&mut self.auto_sums);
        let cross = std::mem::take(&mut self.cross_sums);
        self.averaged(auto, cross, effective_averages)
    }

    /// Converts sums to averages.
    fn averaged(
        &self,
        mut auto: Vec<Vec<f64>>,
        mut cross: Vec<Vec<Complex64>>,
        effective_averages: f64,
    ) -> Result<AveragedSpectra, LabioError> {
        if self.n_averages == 0 {
            return too_few_averages("an averaged spectrum", 0, 1);
        }
        let time_step = 1.0 / self.sampling_rate_hz;
        let two_sided = time_step * time_step / (self.gains.power * self.n_averages as f64);
        if !two_sided.is_normal() {
            return non_physical(
                "sampling rate [Hz]",
                self.sampling_rate_hz,
                "a rate whose square is within the range of numbers",
            );
        }
        let n_samples = self.n_samples;
        let scale = |line: usize| {
            if line == 0 || 2 * line == n_samples {
                two_sided
            } else {
                2.0 * two_sided
            }
        };
        for (lines, channel) in auto.iter_mut().zip(&self.channels) {
            for (line, value) in lines.iter_mut().enumerate() {
                *value *= scale(line);
            }
            if let Some(line) = lines.iter().position(|value| !value.is_finite()) {
                return Err(LabioError::SpectrumOverflow {
                    channel: channel.name().to_owned(),
                    line,
                });
            }
        }
        // |conj(X) Y| <= (|X|^2 + |Y|^2)/2: cross-spectra are finite because the auto-spectra are
        for lines in &mut cross {
            for (line, value) in lines.iter_mut().enumerate() {
                *value *= scale(line);
            }
        }
        let line_spacing_hz = self.sampling_rate_hz / n_samples as f64;
        let noise_duration = |weights: &Vec<f64>| {
            let squares = if weights.is_empty() {
                n_samples as f64
            } else {
                weights.iter().map(|weight| weight * weight).sum()
            };
            squares * time_step / self.gains.power
        };
        let tails = self.tails.as_ref().map(|tails| {
            let scaled = |sums: &Vec<Complex64>| {
                let lines = sums.iter().enumerate();
                lines.map(|(line, sum)| sum * scale(line)).collect()
            };
            let lacks_first = |ending: &Ending| !tails.completion.has_first_line(*ending);
            AveragedTails {
                sums: tails.sums.iter().map(scaled).collect(),
                lacks_first: tails.endings.iter().map(lacks_first).collect(),
            }
        });
        Ok(AveragedSpectra {
            noise_durations: self.weights.iter().map(noise_duration).collect(),
            rest_energy: vec![None; self.channels.len()],
            channels: self.channels.clone(),
            n_averages: self.n_averages,
            effective_averages,
            n_samples,
            window: self.window,
            added_damping: self.added_damping,
            line_spacing_hz,
            noise_bandwidth_hz: self.gains.noise_bandwidth_lines * line_spacing_hz,
            frequency_hz: (0..=n_samples / 2)
                .map(|k| k as f64 * line_spacing_hz)
                .collect(),
            auto,
            cross,
            tails,
        })
    }

    fn check_no_other_window(&self, asked: &'static str) -> Result<(), LabioError> {
        if self.window != Window::Rectangular {
            return Err(LabioError::WindowConflict {
                asked,
                present: format!("{:?}", self.window),
            });
        }
        if self.n_averages > 0 {
            return Err(LabioError::TooManyAverages {
                asked,
                found: self.n_averages,
            });
        }
        Ok(())
    }

    /// Rejects a record with other channels or another sampling rate.
    pub(super) fn check_channels(&self, hit: &Record) -> Result<(), LabioError> {
        check_count(
            "channels of a hit",
            hit.channels().len(),
            self.channels.len(),
        )?;
        for (index, (found, expected)) in hit.channels().iter().zip(&self.channels).enumerate() {
            check_same_channel(index, found, expected)?;
        }
        check_same_rate(hit.sampling_rate_hz(), self.sampling_rate_hz)
    }
}

/// Accepts the channel at `index` of a hit if it is that of the hits before.
pub(super) fn check_same_channel(
    index: usize,
    found: &Channel,
    expected: &Channel,
) -> Result<(), LabioError> {
    if found == expected {
        return Ok(());
    }
    Err(LabioError::ChannelMismatch {
        index,
        found: found.to_string(),
        expected: expected.to_string(),
    })
}

/// Accepts a sampling rate that differs only in its last digits.
pub(super) fn check_same_rate(found_hz: f64, expected_hz: f64) -> Result<(), LabioError> {
    if (found_hz - expected_hz).abs() > SAMPLING_RATE_TOLERANCE * expected_hz {
        return Err(LabioError::SamplingRateMismatch {
            found_hz,
            expected_hz,
        });
    }
    Ok(())
}

/// Effect of a window on the level of noise and on its bandwidth.
#[derive(Debug, Clone, Copy)]
struct Gains {
    power: f64,
    noise_bandwidth_lines: f64,
}

/// Returns the weights, an empty list if all are 1, and their gains.
fn weigh(window: Window, n_samples: usize) -> Result<(Vec<f64>, Gains), LabioError> {
    if window == Window::Rectangular && n_samples >= 2 {
        let gains = Gains {
            power: 1.0,
            noise_bandwidth_lines: 1.0,
        };
        return Ok((Vec::new(), gains));
    }
    let sampled = window.sample(n_samples)?;
    let gains = Gains {
        power: sampled.power_gain,
        noise_bandwidth_lines: sampled.noise_bandwidth_lines,
    };
    Ok((sampled.weights, gains))
}

/// Multiplies `weights` by `factors`; an empty list of weights means that all are 1.
fn multiply(weights: &mut Vec<f64>, factors: &[f64]) {
    if weights.is_empty() {
        weights.extend_from_slice(factors);
    } else {
        for (weight, factor) in weights.iter_mut().zip(factors) {
            *weight *= factor;
        }
    }
}
