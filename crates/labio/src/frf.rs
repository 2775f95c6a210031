//! Frequency responses and their random errors, from averaged spectra.
//!
//! Theory: `docs/theory/spectra.md#frequency-response`.

mod bias;
mod coherence;
mod departure;
mod given;

pub use bias::Bias;
pub use coherence::Coherence;
pub(crate) use coherence::chance_level;
pub use departure::Departure;

use num_complex::Complex64;

use crate::channel::{self, Channel};
use crate::error::count_mismatch;
use crate::spectra::CrossLines;
use crate::{AddedDamping, AveragedSpectra, LabioError};

/// Standard deviation of an unknown phase, uniform over a turn: $`\pi/\sqrt3`$ rad.
const UNKNOWN_PHASE: f64 = 1.813_799_364_234_217_8;

/// Effective number of averages below which overlapped segments count as a single average.
const FEWEST_EFFECTIVE_AVERAGES: f64 = 1.5;

/// Smallest square with full precision: the last digit of a smaller square is below the smallest
/// normal number.
const LEAST_SQUARE: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Estimator of the frequency response from the averaged spectra of input x and output y.
///
/// If the input has noise with the power $`a`$ relative to the noise-free input, and the output
/// noise with the power $`b`$ relative to the noise-free output, both uncorrelated with each other
/// and with the signals, the expected values have the biases stated below.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Estimator {
    /// $`H_1 = G_{xy}/G_{xx}`$: not biased by output noise, too small by the factor $`1/(1+a)`$.
    /// Least squares in y.
    #[default]
    H1,
    /// $`H_2 = G_{yy}/G_{yx}`$: not biased by input noise, too large by the factor $`1+b`$. Least
    /// squares in x.
    H2,
    /// $`H_v = \sqrt{H_1 H_2}`$ with the phase of $`G_{xy}`$: total least squares, independent of
    /// the scales of x and y; wrong by the factor $`\sqrt{(1+b)/(1+a)}`$.
    Hv,
    /// Total least squares with the noise that both channels have at rest, relative to the measured
    /// spectra, $`\alpha = N_x/G_{xx}`$ and $`\beta = N_y/G_{yy}`$: not biased by the noise of
    /// either channel (errors in variables):
    ///
    /// ```math
    /// H_s = H_1\,\frac{2\beta}{R + \beta - \alpha}, \qquad R = \sqrt{(\beta-\alpha)^2 + 4\alpha\beta\gamma^2} .
    /// ```
    ///
    /// Only the ratio of the two noise levels matters: the estimate equals H1 if the input has no
    /// noise, and H2 if the output has no noise. It needs [`AveragedSpectra::with_rest_noise`] for
    /// both channels.
    Hs,
}

/// Validity of a line: valid, or the reason why it contains no information. The values of an
/// invalid line are NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LineValidity {
    /// The line is a measurement; its coherence and random error show its quality.
    Valid,
    /// The input auto-spectrum is zero, at the rounding level of the transform, or below 1e-292,
    /// where squares lose digits.
    NoInput,
    /// The output auto-spectrum is zero, at the rounding level of the transform, or below 1e-292.
    NoOutput,
    /// Input and output are nonzero, but their cross-spectrum is zero within rounding: H2 and Hv do
    /// not exist.
    NoCorrelation,
    /// The value would require a division by zero: an integration at 0 Hz, or the reciprocal of a
    /// response that is zero.
    NotDefined,
    /// The inputs of a multi-input system are linearly dependent: the response to a single input
    /// cannot be determined.
    DependentInputs,
}

/// Standard error of a line, to first order.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RandomError {
    /// Error of |H|, relative to |H|: $`\varepsilon = \sqrt{(1-\gamma^2)/(2 (n-1) \gamma^2)}`$.
    /// Infinite without coherence; above about 0.2 it is only qualitative.
    pub magnitude: f64,
    /// Error of the phase \[rad\]: the same number as the error of the magnitude, but at most
    /// $`\pi/\sqrt3`$, the value for an unknown phase.
    pub phase: f64,
}

/// A measured frequency response with its coherence and errors.
///
/// | field | shape | unit |
/// |---|---|---|
/// | `frequency_hz` | `(n_lines)`, from 0 | Hz |
/// | `values` | `(n_lines)` | unit of output / unit of input |
/// | `coherence` | `(n_lines)`, or none for one average | 1 |
/// | `variance` | `(n_lines)`, or none for one average | square of the unit of `values` |
/// | `degrees_of_freedom` | `(n_lines)`, with the variance | 1 |
/// | `noise_bias`, `possible_bias`, `common_error` | `(n_lines)`, or none where not known | 1 |
/// | `validity` | `(n_lines)` | |
///
/// # Validity
///
/// The system is linear and stationary over the hits, each hit fits in the record, and the noise is
/// as the [`Estimator`] assumes. The random error is that of independent hits, or of the effective
/// number of overlapped segments (J. S. Bendat and A. G. Piersol, *Random Data*, for H1; the other
/// estimators agree to first order when the coherence is high).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct FrequencyResponse {
    /// The estimator of the values.
    pub estimator: Estimator,
    /// The input channel.
    pub input: Channel,
    /// The output channel.
    pub output: Channel,
    /// Number of hits or segments averaged.
    pub n_averages: usize,
    /// Effective number of averages, from which the errors are computed: the number of independent
    /// hits or segments that would give the same variance.
    pub effective_averages: f64,
    /// Number of samples of the transformed histories: if it is odd, there is no line at the
    /// Nyquist frequency.
    pub n_samples: usize,
    /// The exponential window on all channels, if one was applied: the values are then
    /// $`H(\sigma+i\omega)`$.
    pub added_damping: Option<AddedDamping>,
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Output over input; NaN on invalid lines.
    pub values: Vec<Complex64>,
    /// Ordinary coherence, NaN on invalid lines and on completed lines. `None` for a single
    /// average, where it would always be 1, and for values combined from several tests.
    pub coherence: Option<Vec<f64>>,
    /// `E|δH|² = |H|² (1 - γ²)/((n_e - 1) γ²)`, the variance of the complex line: *twice* that of
    /// its real or imaginary part. Estimating the response uses up one average, hence n_e - 1. NaN
    /// on invalid lines; `None` for a single average.
    pub variance: Option<Vec<f64>>,
    /// Degrees of freedom of the variance, 2(n_e - 1) for one test: the error of a component
    /// divided by its standard error has Student's distribution. Infinite if the variance was not
    /// estimated from hits; NaN on invalid lines. Present together with the variance.
    pub degrees_of_freedom: Option<Vec<f64>>,
    /// Relative bias of |H| caused by the noise of the channels at rest; `None` if the noise is not
    /// known. NaN on invalid lines, and on lines with no more power than the noise.
    pub noise_bias: Option<Vec<f64>>,
    /// Largest relative bias of |H| by noise if the noise at rest is not known: the bias of the
    /// estimator if all missing coherence were caused by noise on the channel that the estimator
    /// assumes to be noise-free. One matrix of spectra does not show which channel has the noise,
    /// so the true bias is between zero and this value. `None` if [`noise_bias`](Self::noise_bias)
    /// is known, and without coherence. NaN on invalid lines.
    pub possible_bias: Option<Vec<f64>>,
    /// Relative standard uncertainty common to the lines, such as that of the sensors, which does
    /// not decrease with the number of hits; `None` if not stated.
    pub common_error: Option<Vec<f64>>,
    /// Validity of each line.
    pub validity: Vec<LineValidity>,
}

impl FrequencyResponse {
    /// Returns the lists that exist, except values, frequencies and validity.
    pub(crate) fn lists_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        [
            &mut self.coherence,
            &mut self.variance,
            &mut self.degrees_of_freedom,
            &mut self.noise_bias,
            &mut self.possible_bias,
            &mut self.common_error,
        ]
        .into_iter()
        .flatten()
    }

    /// Keeps the first `n_lines` = L lines, which then correspond to $`2(L-1)`$ samples; keeps all
    /// lines if there are no more than L.
    pub fn truncate(&mut self, n_lines: usize) {
        if n_lines >= self.values.len() {
            return;
        }
        self.frequency_hz.truncate(n_lines);
        self.values.truncate(n_lines);
        self.validity.truncate(n_lines);
        for lines in self.lists_mut() {
            lines.truncate(n_lines);
        }
        self.n_samples = 2 * n_lines.saturating_sub(1);
    }

    /// Indices of the lines without information, which any use of the response must leave out.
    pub fn invalid_lines(&self) -> impl Iterator<Item = usize> + '_ {
        self.validity
            .iter()
            .enumerate()
            .filter(|(_, validity)| **validity != LineValidity::Valid)
            .map(|(line, _)| line)
    }

    /// Returns the random error of every line: NaN on invalid lines, infinite for a value of zero;
    /// `None` for a single average.
    #[must_use]
    pub fn random_error(&self) -> Option<Vec<RandomError>> {
        let variances = self.variance.as_ref()?;
        let line = |(value, variance): (&Complex64, &f64)| {
            let magnitude = (variance / 2.0).sqrt() / value.norm();
            let phase = if magnitude > UNKNOWN_PHASE {
                UNKNOWN_PHASE
            } else {
                magnitude
            };
            RandomError { magnitude, phase }
        };
        Some(self.values.iter().zip(variances).map(line).collect())
    }

    /// Returns $`s = \sigma + i\omega`$ \[rad/s\] of line `line`, with $`\sigma`$ of the
    /// exponential window, or 0.
    #[allow(
        clippy::indexing_slicing,
        reason = "`line` is the index of a value, and `check_lengths` has found a frequency for each"
    )]
    pub(crate) fn laplace_variable(&self, line: usize) -> Complex64 {
        let sigma = self.added_damping.map_or(0.0, |window| window.decay_rate());
        Complex64::new(sigma, std::f64::consts::TAU * self.frequency_hz[line])
    }

    /// Rejects a response whose lists, which are public, no longer have equal lengths.
    pub(crate) fn check_lengths(&self) -> Result<(), LabioError> {
        let expected = self.values.len();
        let length = |lines: &Option<Vec<f64>>| lines.as_ref().map_or(expected, Vec::len);
        let lists = [
            ("frequencies of the response", self.frequency_hz.len()),
            ("lines of the coherence", length(&self.coherence)),
            ("lines of the variance", length(&self.variance)),
            (
                "lines of the degrees of freedom",
                length(&self.degrees_of_freedom),
            ),
            ("lines of the noise bias", length(&self.noise_bias)),
            ("lines of the possible bias", length(&self.possible_bias)),
            ("lines of the common error", length(&self.common_error)),
            ("lines of the validity", self.validity.len()),
        ];
        match lists.into_iter().find(|(_, found)| *found != expected) {
            None => Ok(()),
            Some((what, found)) => count_mismatch(what, found, expected),
        }
    }

    /// Rejects a response with lines without information.
    pub(crate) fn check_complete(&self, what: &'static str) -> Result<(), LabioError> {
        self.check_lengths()?;
        let lines = self.frequency_hz.iter().zip(&self.validity);
        let mut missing = lines.filter(|(_, validity)| **validity != LineValidity::Valid);
        match missing.next() {
            None => Ok(()),
            Some((first_hz, _)) => Err(LabioError::MissingLines {
                what,
                first_hz: *first_hz,
                count: 1 + missing.count(),
            }),
        }
    }
}

impl AveragedSpectra {
    /// Returns the frequency response $`H_1 = G_{xy}/G_{xx}`$, suited to noise on the output.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn h1(&self, input: &str, output: &str) -> Result<FrequencyResponse, LabioError> {
        self.response(Estimator::H1, input, output)
    }

    /// Returns the frequency response $`H_2 = G_{yy}/G_{yx}`$, suited to noise on the input.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn h2(&self, input: &str, output: &str) -> Result<FrequencyResponse, LabioError> {
        self.response(Estimator::H2, input, output)
    }

    /// Returns the frequency response $`H_v = \sqrt{H_1H_2}`$, suited to the same relative noise on
    /// input and output.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn hv(&self, input: &str, output: &str) -> Result<FrequencyResponse, LabioError> {
        self.response(Estimator::Hv, input, output)
    }

    /// Returns the frequency response from the given estimator.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`]; [`LabioError::UnknownRestNoise`] for [`Estimator::Hs`] if
    /// the noise of either channel is unknown.
    pub fn response(
        &self,
        estimator: Estimator,
        input: &str,
        output: &str,
    ) -> Result<FrequencyResponse, LabioError> {
        let (_, input_channel) = channel::find(self.channels(), input)?;
        let (_, output_channel) = channel::find(self.channels(), output)?;
        let pair = self.pair(input, output)?;
        let averages = self.effective_averages();
        let averaged = self.can_have_coherence();
        let freedom = 2.0 * (averages - 1.0);
        let least_coherence = self.transform_rounding().powi(2);
        let mut lines = pulp::Arch::new().dispatch(EstimatesOf {
            pair,
            estimator,
            averages,
            least_coherence,
        });
        if !(self.has_first_line(input)? && self.has_first_line(output)?) {
            lines.leave_out_first();
        }
        let mut response = FrequencyResponse {
            estimator,
            input: input_channel.clone(),
            output: output_channel.clone(),
            n_averages: self.n_averages(),
            effective_averages: averages,
            n_samples: self.n_samples(),
            added_damping: self.added_damping(),
            frequency_hz: self.frequency_hz().to_vec(),
            values: lines.values,
            coherence: averaged.then_some(lines.coherence),
            // an invalid line remains NaN
            degrees_of_freedom: averaged.then(|| {
                let of = |variance: &f64| if variance.is_nan() { f64::NAN } else { freedom };
                lines.variance.iter().map(of).collect()
            }),
            variance: averaged.then_some(lines.variance),
            noise_bias: None,
            possible_bias: None,
            common_error: None,
            validity: lines.validity,
        };
        self.consider_rest_noise(&mut response)?;
        response.possible_bias = response.bias_by_coherence();
        Ok(response)
    }

    /// Rounding error of a transform relative to its root-mean-square line, $`\epsilon\log_2 N`$.
    pub(crate) fn transform_rounding(&self) -> f64 {
        f64::EPSILON * (self.n_samples() as f64).log2().max(1.0)
    }

    /// Returns true if there are at least two averages, and their effective number is at least
    /// [`FEWEST_EFFECTIVE_AVERAGES`].
    pub(crate) fn can_have_coherence(&self) -> bool {
        self.n_averages() >= 2 && self.effective_averages() >= FEWEST_EFFECTIVE_AVERAGES
    }

    fn pair(&self, input: &str, output: &str) -> Result<Pair<'_>, LabioError> {
        let inputs = self.auto_lines(input)?;
        let outputs = self.auto_lines(output)?;
        let means = (mean(inputs), mean(outputs));
        Ok(Pair {
            inputs,
            outputs,
            crosses: self.cross_lines(input, output)?,
            least_input: self.least_signal(means.0),
            least_output: self.least_signal(means.1),
            half_exponents: (half_exponent(means.0), half_exponent(means.1)),
        })
    }

    /// Level of an auto-spectrum with mean `mean` below which it is only rounding error of its
    /// transform, or so small that squares lose digits at the lower end of the floating-point
    /// range.
    pub(crate) fn least_signal(&self, mean: f64) -> f64 {
        (self.transform_rounding().powi(2) * mean).max(LEAST_SQUARE)
    }
}

/// The spectra of a pair of channels.
struct Pair<'a> {
    inputs: &'a [f64],
    outputs: &'a [f64],
    crosses: CrossLines<'a>,
    least_input: f64,
    least_output: f64,
    /// Half the binary exponents of the mean auto-spectra.
    half_exponents: (i32, i32),
}

/// Estimates of a pair of channels. Lines without information are NaN.
struct Estimates {
    values: Vec<Complex64>,
    coherence: Vec<f64>,
    variance: Vec<f64>,
    validity: Vec<LineValidity>,
}

impl Estimates {
    /// Flags the line at 0 Hz as not defined.
    fn leave_out_first(&mut self) {
        let nothing = Complex64::new(f64::NAN, f64::NAN);
        self.values.iter_mut().take(1).for_each(|x| *x = nothing);
        for lines in [&mut self.coherence, &mut self.variance] {
            lines.iter_mut().take(1).for_each(|x| *x = f64::NAN);
        }
        let first = self.validity.iter_mut().take(1);
        first.for_each(|x| *x = LineValidity::NotDefined);
    }
}

/// Task that computes [`Pair::estimates`] with the vector instructions of the processor.
struct EstimatesOf<'a> {
    pair: Pair<'a>,
    estimator: Estimator,
    averages: f64,
    least_coherence: f64,
}

impl pulp::NullaryFnOnce for EstimatesOf<'_> {
    type Output = Estimates;

    #[inline(always)]
    fn call(self) -> Estimates {
        self.pair
            .estimates(self.estimator, self.averages, self.least_coherence)
    }
}

/// Task that computes [`Pair::coherence`] with the vector instructions of the processor.
struct CoherenceOf<'a> {
    pair: &'a Pair<'a>,
    coherence: &'a mut [f64],
}

impl pulp::NullaryFnOnce for CoherenceOf<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.pair.coherence(self.coherence);
    }
}

impl Pair<'_> {
    /// Computes each quantity in one branch-free pass, which can be vectorised: the NaN of an
    /// invalid line propagates.
    #[inline(always)]
    fn estimates(&self, estimator: Estimator, averages: f64, least_coherence: f64) -> Estimates {
        let n_lines = self.inputs.len();
        let mut validity = self.validity();
        let mut values = vec![Complex64::ZERO; n_lines];
        self.h1(&mut values);
        let mut coherence = vec![0.0; n_lines];
        self.coherence(&mut coherence);
        if matches!(estimator, Estimator::H2 | Estimator::Hv) {
            for (coherence, validity) in coherence.iter_mut().zip(&mut validity) {
                if *coherence <= least_coherence {
                    *validity = LineValidity::NoCorrelation;
                    *coherence = f64::NAN;
                }
            }
        }

        // |H|^2 (1 - c)/((n - 1) c), written so that H1 without coherence keeps its finite variance
        let mut variance = vec![0.0; n_lines];
        let per_line = 1.0 / (averages - 1.0);
        let autos = self.inputs.iter().zip(self.outputs);
        for ((variance, (x, y)), c) in variance.iter_mut().zip(autos).zip(&coherence) {
            *variance = (1.0 - c) * per_line * (y / x);
        }
        // H2 = H1/coherence, and Hv is the geometric mean of H1 and H2
        let both = values.iter_mut().zip(&mut variance).zip(&coherence);
        match estimator {
            Estimator::H1 | Estimator::Hs => {}
            Estimator::H2 => {
                for ((value, variance), c) in both {
                    let factor = 1.0 / c;
                    *value *= factor;
                    *variance *= factor * factor;
                }
            }
            Estimator::Hv => {
                for ((value, variance), c) in both {
                    let factor = 1.0 / c;
                    *value *= factor.sqrt();
                    *variance *= factor;
                }
            }
        }
        Estimates {
            values,
            coherence,
            variance,
            validity,
        }
    }

    fn validity(&self) -> Vec<LineValidity> {
        let autos = self.inputs.iter().zip(self.outputs);
        autos
            .map(|(input, output)| {
                if *input <= self.least_input {
                    LineValidity::NoInput
                } else if *output <= self.least_output {
                    LineValidity::NoOutput
                } else {
                    LineValidity::Valid
                }
            })
            .collect()
    }

    #[inline(always)]
    fn h1(&self, values: &mut [Complex64]) {
        let autos = self.inputs.iter().zip(self.outputs);
        let lines = values.iter_mut().zip(autos);
        match self.crosses {
            CrossLines::Auto(crosses) => {
                for ((value, (x, y)), g) in lines.zip(crosses) {
                    *value = self.ratio(Complex64::new(*g, 0.0), *x, *y);
                }
            }
            CrossLines::Stored(crosses) => {
                for ((value, (x, y)), g) in lines.zip(crosses) {
                    *value = self.ratio(*g, *x, *y);
                }
            }
            CrossLines::Conjugate(crosses) => {
                for ((value, (x, y)), g) in lines.zip(crosses) {
                    *value = self.ratio(g.conj(), *x, *y);
                }
            }
        }
    }

    #[inline(always)]
    fn ratio(&self, cross: Complex64, input: f64, output: f64) -> Complex64 {
        let keep = self.keep(input, output);
        Complex64::new(cross.re / input + keep, cross.im / input + keep)
    }

    #[inline(always)]
    fn keep(&self, input: f64, output: f64) -> f64 {
        if input > self.least_input && output > self.least_output {
            0.0
        } else {
            f64::NAN
        }
    }

    #[inline(always)]
    fn coherence(&self, values: &mut [f64]) {
        // Levels are scaled near 1 by powers of two, which is exact: no square then overflows or
        // underflows.
        let to_input = power_of_two(-self.half_exponents.0);
        let to_output = power_of_two(-self.half_exponents.1);
        let autos = self.inputs.iter().zip(self.outputs);
        let lines = values.iter_mut().zip(autos);
        let coherence = |re: f64, im: f64, x: f64, y: f64| {
            let (re, im) = (re * to_input * to_output, im * to_input * to_output);
            let scaled = (x * to_input * to_input) * (y * to_output * to_output);
            // at most 1 by the Schwarz inequality: the bound removes only rounding errors
            let bounded = ((re * re + im * im) / scaled).min(1.0);
            bounded + self.keep(x, y)
        };
        match self.crosses {
            CrossLines::Auto(crosses) => {
                for ((value, (x, y)), g) in lines.zip(crosses) {
                    *value = coherence(*g, 0.0, *x, *y);
                }
            }
            // |conj(G)|² = |G|²
            CrossLines::Stored(crosses) | CrossLines::Conjugate(crosses) => {
                for ((value, (x, y)), g) in lines.zip(crosses) {
                    *value = coherence(g.re, g.im, *x, *y);
                }
            }
        }
    }

    /// Returns the coherence alone; NaN without input or output.
    fn coherences(&self) -> Vec<f64> {
        let mut coherence = vec![0.0; self.inputs.len()];
        pulp::Arch::new().dispatch(CoherenceOf {
            pair: self,
            coherence: &mut coherence,
        });
        coherence
    }
}

/// Returns the mean, summed in eight independent lanes.
pub(crate) fn mean(values: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    for chunk in values.chunks(lanes.len()) {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    lanes.iter().sum::<f64>() / values.len() as f64
}

/// Returns half the binary exponent of a level.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the exponent of a finite number lies between -1074 and 1024"
)]
fn half_exponent(mean: f64) -> i32 {
    if mean > 0.0 && mean.is_finite() {
        (mean.log2() / 2.0).round() as i32
    } else {
        0
    }
}

fn power_of_two(exponent: i32) -> f64 {
    2.0_f64.powi(exponent)
}

#[cfg(test)]
mod tests;
