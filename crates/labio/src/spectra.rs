//! Auto- and cross-spectra, averaged over hits or over segments of a long record.
//!
//! Theory: `docs/theory/spectra.md`.

mod averager;
mod detrend;
pub(crate) mod ending;
mod rest_noise;
mod ringing;
mod welch;

pub use averager::SpectrumAverager;
pub use detrend::Detrend;
pub use ending::completed_motion;
pub use rest_noise::RestNoise;
pub use ringing::{damping_of_ringing, from_rest};
pub use welch::Welch;

use num_complex::Complex64;

use crate::channel::{self, Channel};
use crate::error::too_few_averages;
use crate::{AddedDamping, LabioError, Record, Window};
#[allow(unused_imports, reason = "named in documentation")]
use crate::{Estimator, FrequencyResponse};

/// The Hermitian matrix of averaged one-sided energy spectral densities, line by line; scaled as in
/// [`SpectrumAverager`].
#[derive(Debug, Clone)]
pub struct AveragedSpectra {
    channels: Vec<Channel>,
    n_averages: usize,
    effective_averages: f64,
    n_samples: usize,
    window: Window,
    added_damping: Option<AddedDamping>,
    line_spacing_hz: f64,
    noise_bandwidth_hz: f64,
    frequency_hz: Vec<f64>,
    /// Duration \[s\] for each channel, by which the density of white noise is multiplied to give
    /// the energy of a line.
    noise_durations: Vec<f64>,
    /// Energy of the noise at rest in every line, one list per channel; `None` if the noise is not
    /// known.
    rest_energy: Vec<Option<Vec<f64>>>,
    /// Auto-spectra, one list per channel, `(n_lines)`.
    auto: Vec<Vec<f64>>,
    /// Cross-spectra, one list per pair in the order of `pair_index`, `(n_lines)`.
    cross: Vec<Vec<Complex64>>,
    tails: Option<AveragedTails>,
}

/// Spectra of the end parts of the hits.
#[derive(Debug, Clone)]
struct AveragedTails {
    /// Cross-spectra from each channel to the end part of each channel, `(n_lines)`, in rows by the
    /// first channel.
    sums: Vec<Vec<Complex64>>,
    /// True for a channel without a line at 0 Hz, because its motion continues without end.
    lacks_first: Vec<bool>,
}

/// Mean square of the weights of the leakage, averaged over all samples: 3/8 in the last quarter.
const NOISE_OF_THE_END: f64 = 3.0 / 32.0;
/// Probability below which noise alone does not explain the error of a line caused by the end of
/// the record.
const RARE: f64 = 0.01;

impl AveragedSpectra {
    /// Averages `hits`, which must all have the same channels and sampling as the first.
    ///
    /// # Errors
    ///
    /// The errors of [`SpectrumAverager::add`] and [`SpectrumAverager::spectra`].
    pub fn of<'a>(
        hits: impl IntoIterator<Item = &'a Record>,
        window: Window,
    ) -> Result<Self, LabioError> {
        let mut hits = hits.into_iter();
        let Some(first) = hits.next() else {
            return too_few_averages("an averaged spectrum", 0, 1);
        };
        let mut averager = SpectrumAverager::for_records_like(first, window)?;
        averager.add(first)?;
        for hit in hits {
            averager.add(hit)?;
        }
        let effective_averages = averager.n_averages() as f64;
        averager.into_averages(effective_averages)
    }

    /// The channels, in the order of the hits' rows.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Number of hits or segments averaged.
    #[must_use]
    pub fn n_averages(&self) -> usize {
        self.n_averages
    }

    /// Effective number of averages: the number of *independent* hits or segments that would give
    /// the same variance. It is less than [`AveragedSpectra::n_averages`] if segments overlap
    /// ([`SampledWindow::independent_averages`](crate::SampledWindow::independent_averages)).
    #[must_use]
    pub fn effective_averages(&self) -> f64 {
        self.effective_averages
    }

    /// Number of samples per hit or segment.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// The window applied.
    #[must_use]
    pub fn window(&self) -> Window {
        self.window
    }

    /// The exponential window applied to all channels, if any.
    #[must_use]
    pub fn added_damping(&self) -> Option<AddedDamping> {
        self.added_damping
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

    /// Sets the noise of `channel` at rest, from which the bias of responses
    /// ([`FrequencyResponse::noise_bias`]) is found and which [`Estimator::Hs`] needs. The effect
    /// of windows is included.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    #[allow(
        clippy::indexing_slicing,
        reason = "the index that `find` returns for a channel is also the index of its duration and its energy"
    )]
    pub fn with_rest_noise(mut self, channel: &str, noise: &RestNoise) -> Result<Self, LabioError> {
        let (index, _) = channel::find(&self.channels, channel)?;
        let duration = self.noise_durations[index];
        let lines = self.frequency_hz.iter();
        let energy = lines.map(|f| noise.density_at(*f) * duration).collect();
        self.rest_energy[index] = Some(energy);
        Ok(self)
    }

    /// Energy \[unit² s/Hz\] of the noise at rest in every line, if known.
    #[allow(
        clippy::indexing_slicing,
        reason = "the index that `find` returns for a channel is also the index of its energy"
    )]
    pub(crate) fn rest_energy(&self, channel: &str) -> Result<Option<&[f64]>, LabioError> {
        let (index, _) = channel::find(&self.channels, channel)?;
        Ok(self.rest_energy[index].as_deref())
    }

    /// Equivalent noise bandwidth of a line \[Hz\].
    #[must_use]
    pub fn noise_bandwidth_hz(&self) -> f64 {
        self.noise_bandwidth_hz
    }

    /// Returns the averaged auto-spectrum $`G_{xx}`$ \[unit² s/Hz\] of a channel; `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn auto(&self, channel: &str) -> Result<Vec<f64>, LabioError> {
        self.auto_lines(channel).map(<[f64]>::to_vec)
    }

    /// Returns the averaged cross-spectrum $`G_{xy} = \overline{X^* Y}`$ \[unit unit s/Hz\] from
    /// `first` to `second`; `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn cross(&self, first: &str, second: &str) -> Result<Vec<Complex64>, LabioError> {
        Ok(match self.cross_lines(first, second)? {
            CrossLines::Auto(lines) => lines.iter().map(|&g| g.into()).collect(),
            CrossLines::Stored(lines) => lines.to_vec(),
            CrossLines::Conjugate(lines) => lines.iter().map(Complex64::conj).collect(),
        })
    }

    /// Returns the averaged power spectral density \[unit²/Hz\] of a stationary channel,
    /// $`G_{xx}/(N\Delta t)`$; `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn power_density(&self, channel: &str) -> Result<Vec<f64>, LabioError> {
        // the line spacing is the inverse of the duration
        let density = |energy: &f64| energy * self.line_spacing_hz;
        Ok(self.auto_lines(channel)?.iter().map(density).collect())
    }

    /// Returns the averaged cross power spectral density \[unit unit/Hz\], $`G_{xy}/(N\Delta t)`$;
    /// `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn cross_power_density(
        &self,
        first: &str,
        second: &str,
    ) -> Result<Vec<Complex64>, LabioError> {
        let energies = self.cross(first, second)?;
        Ok(energies.iter().map(|g| g * self.line_spacing_hz).collect())
    }

    /// Returns the mean squares of the lines of a periodic channel \[unit²\], which are the power
    /// density times the noise bandwidth: a sine of amplitude A at the frequency of a line gives
    /// $`A^2/2`$ on that line. `(n_lines)`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn mean_squares(&self, channel: &str) -> Result<Vec<f64>, LabioError> {
        let mut lines = self.power_density(channel)?;
        for line in &mut lines {
            *line *= self.noise_bandwidth_hz;
        }
        Ok(lines)
    }

    /// Returns the relative systematic error of the lines of a frequency response caused by
    /// truncation of the motion at the end of the record; `(n_lines)`, `None` unless the averager
    /// was made [`with_completion`](SpectrumAverager::with_completion).
    ///
    /// The motion after the end of the record is missing in every line. Its effect is estimated as
    /// the change that a smooth end of the record would cause. With the transform $`T`$ of the last
    /// quarter, weighted by $`\tfrac12(1-\cos)`$ rising from 0 to 1 at its end, the error is
    ///
    /// ```math
    /// \epsilon = \frac{\lvert G_{x T_y} - H_1 G_{x T_x}\rvert}{\lvert G_{xy}\rvert} ,
    /// ```
    ///
    /// less the contribution of noise, 3/32 of the relative variance of $`H_1`$. If there is only
    /// noise, the square of the error divided by this contribution has Fisher's distribution of 2
    /// and $`2(n_e - 1)`$ degrees of freedom. The result is 0 on a line where noise alone reaches
    /// the error with a probability above 1 %. If no more lines are below 1 % than chance permits,
    /// this limit is 1 % for all lines together, that is 1 % divided by their number.
    ///
    /// # Validity
    ///
    /// The result is the magnitude of the error, without its sign. An error that is hidden by
    /// noise, for which the result is 0, is at most about three standard errors of the line for
    /// five averages, and about one standard error for thirty. On a line away from resonances the
    /// result is correct to a few per cent. At the peak of a resonance of decay rate $`\delta`$ in
    /// a record of length $`T`$ it is 0.8 of the true error for $`\delta T = 4.6`$ (a remainder of
    /// 1 %), and a larger part for shorter ringing.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    #[allow(
        clippy::indexing_slicing,
        reason = "the indices that `find` returns are indices of channels, and every pair of channels has its lines"
    )]
    pub fn leakage(&self, input: &str, output: &str) -> Result<Option<Vec<f64>>, LabioError> {
        let (x, _) = channel::find(&self.channels, input)?;
        let (y, _) = channel::find(&self.channels, output)?;
        let Some(tails) = &self.tails else {
            return Ok(None);
        };
        let n_channels = self.channels.len();
        let (of_output, of_input) = (
            &tails.sums[x * n_channels + y],
            &tails.sums[x * n_channels + x],
        );
        let crosses = self.cross_lines(input, output)?;
        let (inputs, outputs) = (self.auto_lines(input)?, self.auto_lines(output)?);
        let degrees = self.effective_averages - 1.0;
        // square of the error, its expected value if there is only noise, and the probability that
        // noise alone reaches it
        let lines: Vec<(f64, f64, f64)> = (0..self.frequency_hz.len())
            .map(|line| {
                let cross = crosses.at(line);
                let missing = of_output[line] - cross / inputs[line] * of_input[line];
                let square = missing.norm_sqr() / cross.norm_sqr();
                if !self.can_have_coherence() {
                    return (square, 0.0, 0.0);
                }
                let coherence = cross.norm_sqr() / (inputs[line] * outputs[line]);
                let noise =
                    NOISE_OF_THE_END * (1.0 - coherence) / (self.effective_averages * coherence);
                let probability = (1.0 + square / (noise * degrees)).powf(-degrees);
                (square, noise, probability)
            })
            .collect();
        let n_lines = lines.len() as f64;
        let rare = lines.iter().filter(|(.., p)| *p < RARE).count() as f64;
        // the last quarter of a record resolves every fourth line
        let is_at_rest = rare < RARE * n_lines + 4.0 * (4.0 * RARE * n_lines).sqrt();
        let level = if is_at_rest { RARE / n_lines } else { RARE };
        let error = |(square, noise, probability): &(f64, f64, f64)| {
            if *probability > level {
                0.0
            } else {
                (square - noise).max(0.0).sqrt()
            }
        };
        Ok(Some(lines.iter().map(error).collect()))
    }

    /// Returns true if the line at 0 Hz of a channel is defined.
    pub(crate) fn has_first_line(&self, channel: &str) -> Result<bool, LabioError> {
        let (index, _) = channel::find(&self.channels, channel)?;
        let lacks = self.tails.as_ref().and_then(|t| t.lacks_first.get(index));
        Ok(!lacks.copied().unwrap_or(false))
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "the index that `find` returns for a channel is also the index of its lines"
    )]
    pub(crate) fn auto_lines(&self, channel: &str) -> Result<&[f64], LabioError> {
        let (index, _) = channel::find(&self.channels, channel)?;
        Ok(&self.auto[index])
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`pair_index` is the index of a pair of channels that `find` has found, and every pair has its lines"
    )]
    pub(crate) fn cross_lines(
        &self,
        first: &str,
        second: &str,
    ) -> Result<CrossLines<'_>, LabioError> {
        let (a, _) = channel::find(&self.channels, first)?;
        let (b, _) = channel::find(&self.channels, second)?;
        let n_channels = self.channels.len();
        Ok(match a.cmp(&b) {
            std::cmp::Ordering::Equal => CrossLines::Auto(&self.auto[a]),
            std::cmp::Ordering::Less => {
                CrossLines::Stored(&self.cross[pair_index(n_channels, a, b)])
            }
            std::cmp::Ordering::Greater => {
                CrossLines::Conjugate(&self.cross[pair_index(n_channels, b, a)])
            }
        })
    }
}

/// The lines of a cross-spectrum as stored.
#[derive(Debug, Clone, Copy)]
pub(crate) enum CrossLines<'a> {
    /// Auto-spectrum: both channels are the same.
    Auto(&'a [f64]),
    /// Stored cross-spectrum from the first to the second channel.
    Stored(&'a [Complex64]),
    /// Stored cross-spectrum from the second to the first channel, which must be conjugated.
    Conjugate(&'a [Complex64]),
}

impl CrossLines<'_> {
    #[allow(
        clippy::indexing_slicing,
        reason = "all spectra of one average have the same lines, and the caller passes the index of a line"
    )]
    pub(crate) fn at(self, line: usize) -> Complex64 {
        match self {
            Self::Auto(lines) => lines[line].into(),
            Self::Stored(lines) => lines[line],
            Self::Conjugate(lines) => lines[line].conj(),
        }
    }
}

/// Returns the row of the pair (a, b), a < b < n, for pairs in the order (0,1), (0,2) .. (0,n-1),
/// (1,2) ..
fn pair_index(n_channels: usize, a: usize, b: usize) -> usize {
    a * (2 * n_channels - a - 1) / 2 + b - a - 1
}

#[cfg(test)]
mod tests;
