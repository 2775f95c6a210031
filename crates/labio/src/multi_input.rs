//! Responses to several simultaneous inputs, with multiple and partial coherence.
//!
//! Theory: `docs/theory/spectra.md#frequency-response`.

mod conditioned_line;

use ndarray::Array2;
use num_complex::Complex64;

use crate::channel;
use crate::error::{count_mismatch, too_few_averages};
use crate::frf;
use crate::{
    AddedDamping, AveragedSpectra, Channel, Coherence, Estimator, FrequencyResponse, LabioError,
    LineValidity,
};
use conditioned_line::ConditionedLine;

/// The responses of one output to several inputs that act together,
/// $`Y = \sum_j H_j X_j`$ + noise.
///
/// | field | shape | unit |
/// |---|---|---|
/// | `frequency_hz` | `(n_lines)` | Hz |
/// | `values` | `(n_inputs, n_lines)` | unit of the output / unit of the input |
/// | `variance` | `(n_inputs, n_lines)` | square of the unit of `values` |
/// | `partial_coherence`, `ordered_coherence` | `(n_inputs, n_lines)` | 1 |
/// | `multiple_coherence` | `(n_lines)` | 1 |
/// | `noise_bias` | `(n_inputs, n_lines)` | 1 |
///
/// Invalid lines are NaN.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MultiInputResponse {
    /// The inputs, in the requested order.
    pub inputs: Vec<Channel>,
    /// The output.
    pub output: Channel,
    /// Number of hits or segments averaged.
    pub n_averages: usize,
    /// Number of independent hits or segments that would give the same variance.
    pub effective_averages: f64,
    /// Number of samples of the transformed histories.
    pub n_samples: usize,
    /// The exponential window on all channels, if one was applied.
    pub added_damping: Option<AddedDamping>,
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// $`H_j`$, by least squares in the output: H1 for several inputs.
    pub values: Array2<Complex64>,
    /// $`\mathrm E\lvert\delta H_j\rvert^2`$, twice the variance of the real or imaginary part.
    pub variance: Array2<f64>,
    /// Share of the output's power that is linear in all inputs together.
    pub multiple_coherence: Vec<f64>,
    /// Coherence of input j and the output after the parts that are linear in all other inputs have
    /// been removed from both.
    pub partial_coherence: Array2<f64>,
    /// Share of the output's power that is linear in that part of input j which is independent of
    /// the inputs *before* it (the conditioned spectra of Bendat and Piersol, in the order of the
    /// inputs): these shares sum to the multiple coherence.
    pub ordered_coherence: Array2<f64>,
    /// Relative bias of $`\lvert H_j\rvert`$ caused by the noise of the inputs at rest,
    /// $`-\mathrm{Re}\,(G_{xx}^{-1} N H)_j/H_j`$ to first order in the noises N; `None` unless the
    /// noise of all inputs is known.
    pub noise_bias: Option<Array2<f64>>,
    /// Validity of each line.
    pub validity: Vec<LineValidity>,
}

impl MultiInputResponse {
    fn number(&self, input: &str) -> Result<usize, LabioError> {
        channel::find(&self.inputs, input).map(|(number, _)| number)
    }

    /// Returns the response to one of the inputs. Its variance has $`2(n_e-q)`$ degrees of freedom;
    /// it has no ordinary coherence.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if `input` is not one of the inputs.
    #[allow(
        clippy::indexing_slicing,
        reason = "`number` finds the input among those of the rows"
    )]
    pub fn response_to(&self, input: &str) -> Result<FrequencyResponse, LabioError> {
        let number = self.number(input)?;
        let variance = self.variance.row(number).to_vec();
        let freedom = 2.0 * (self.effective_averages - self.inputs.len() as f64);
        let of = |variance: &f64| if variance.is_nan() { f64::NAN } else { freedom };
        Ok(FrequencyResponse {
            estimator: Estimator::H1,
            input: self.inputs[number].clone(),
            output: self.output.clone(),
            n_averages: self.n_averages,
            effective_averages: self.effective_averages,
            n_samples: self.n_samples,
            added_damping: self.added_damping,
            frequency_hz: self.frequency_hz.clone(),
            values: self.values.row(number).to_vec(),
            coherence: None,
            degrees_of_freedom: Some(variance.iter().map(of).collect()),
            variance: Some(variance),
            noise_bias: self
                .noise_bias
                .as_ref()
                .map(|bias| bias.row(number).to_vec()),
            possible_bias: None,
            common_error: None,
            validity: self.validity.clone(),
        })
    }

    /// Returns the partial coherence of one of the inputs. Each of the other inputs reduces the
    /// effective averages by one.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if `input` is not one of the inputs.
    pub fn coherence_with(&self, input: &str) -> Result<Coherence, LabioError> {
        let number = self.number(input)?;
        Ok(Coherence {
            frequency_hz: self.frequency_hz.clone(),
            values: self.partial_coherence.row(number).to_vec(),
            n_averages: self.n_averages,
            effective_averages: self.effective_averages - self.inputs.len() as f64 + 1.0,
            validity: self.validity.clone(),
        })
    }
}

impl AveragedSpectra {
    /// Returns the responses of `output` to `inputs` that act simultaneously.
    ///
    /// With the spectra scaled to unit auto-spectra, $`R_{ij} = G_{ij}/\sqrt{G_{ii}G_{jj}}`$ and
    /// $`r_i = G_{iy}/\sqrt{G_{ii}G_{yy}}`$, the responses solve $`R h = r`$,
    /// $`h_j = H_j\sqrt{G_{jj}/G_{yy}}`$, and
    ///
    /// ```math
    /// \gamma^2_{y:x} = r^* R^{-1} r, \qquad
    /// \mathrm{Var}\,h_j = \frac{(1-\gamma^2_{y:x})\,(R^{-1})_{jj}}{n_e - q}, \qquad
    /// \gamma^2_{jy\cdot\mathrm{rest}} = \frac{\lvert h_j\rvert^2}{\lvert h_j\rvert^2 + (1-\gamma^2_{y:x})(R^{-1})_{jj}} .
    /// ```
    ///
    /// The q fitted responses reduce the number of averages by q: for one input, the variance is
    /// that of [`AveragedSpectra::h1`].
    ///
    /// # Validity
    ///
    /// Valid for noise on the output only. Linearly dependent inputs cannot be separated: such
    /// lines are flagged [`LineValidity::DependentInputs`]. The inputs of a test in which their
    /// ratios stay the same, such as two shakers driven by one signal, are dependent for any number
    /// of averages.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without an input, [`LabioError::UnknownChannel`],
    /// [`LabioError::DuplicateChannel`] if a channel is named twice, [`LabioError::TooFewAverages`]
    /// unless the effective number of averages exceeds the number of inputs by more than one.
    #[allow(
        clippy::indexing_slicing,
        reason = "the lists contain the q inputs and then the output, and all spectra of one average have the same lines"
    )]
    pub fn multi_input(
        &self,
        inputs: &[&str],
        output: &str,
    ) -> Result<MultiInputResponse, LabioError> {
        let q = inputs.len();
        if q == 0 {
            return count_mismatch("inputs", 0, 1);
        }
        let names = inputs.iter().chain(std::iter::once(&output));
        let channels = names
            .map(|name| channel::find(self.channels(), name).map(|(_, channel)| channel.clone()))
            .collect::<Result<Vec<Channel>, _>>()?;
        channel::check_distinct(&channels)?;
        if self.n_averages() <= q || self.effective_averages() <= q as f64 {
            return too_few_averages("a response to several inputs", self.n_averages(), q + 1);
        }
        let mut autos = Vec::with_capacity(q + 1);
        let mut least = Vec::with_capacity(q + 1);
        let mut crosses = Vec::with_capacity((q + 1) * (q + 1));
        for first in &channels {
            let auto = self.auto_lines(first.name())?;
            autos.push(auto);
            least.push(self.least_signal(frf::mean(auto)));
            for second in &channels {
                crosses.push(self.cross_lines(first.name(), second.name())?);
            }
        }

        let n_lines = self.frequency_hz().len();
        let none = f64::NAN;
        let mut response = MultiInputResponse {
            inputs: channels[..q].to_vec(),
            output: channels[q].clone(),
            n_averages: self.n_averages(),
            effective_averages: self.effective_averages(),
            n_samples: self.n_samples(),
            added_damping: self.added_damping(),
            frequency_hz: self.frequency_hz().to_vec(),
            values: Array2::from_elem((q, n_lines), Complex64::new(none, none)),
            variance: Array2::from_elem((q, n_lines), none),
            multiple_coherence: vec![none; n_lines],
            partial_coherence: Array2::from_elem((q, n_lines), none),
            ordered_coherence: Array2::from_elem((q, n_lines), none),
            noise_bias: None,
            validity: vec![LineValidity::Valid; n_lines],
        };
        let noises = channels[..q]
            .iter()
            .map(|input| self.rest_energy(input.name()))
            .collect::<Result<Option<Vec<&[f64]>>, _>>()?;
        let mut bias = noises
            .as_ref()
            .map(|_| Array2::from_elem((q, n_lines), none));
        let mut line_of = ConditionedLine::new(q);
        let auto = |channel: usize, line: usize| autos[channel][line];
        for line in 0..n_lines {
            let carries = |channel: usize| auto(channel, line) > least[channel];
            response.validity[line] = if !(0..q).all(carries) {
                LineValidity::NoInput
            } else if !carries(q) {
                LineValidity::NoOutput
            } else {
                let level = |channel: usize| auto(channel, line).sqrt();
                let scaled =
                    |i: usize, j: usize| crosses[i * (q + 1) + j].at(line) / level(i) / level(j);
                if line_of.solve(scaled) {
                    let unexplained = 1.0 - line_of.multiple;
                    response.multiple_coherence[line] = line_of.multiple;
                    for j in 0..q {
                        let (h, own) = (line_of.responses[j], line_of.inverse_diagonal[j]);
                        let unit = level(q) / level(j);
                        let scatter = unexplained * own;
                        response.values[(j, line)] = h * unit;
                        response.variance[(j, line)] =
                            unit * unit * scatter / (self.effective_averages() - q as f64);
                        response.partial_coherence[(j, line)] =
                            h.norm_sqr() / (h.norm_sqr() + scatter);
                        response.ordered_coherence[(j, line)] = line_of.ordered[j].norm_sqr();
                    }
                    if let (Some(noises), Some(bias)) = (&noises, &mut bias) {
                        let share = |j: usize| noises[j][line] / auto(j, line);
                        let noisy = (0..q).map(|j| line_of.responses[j] * share(j)).collect();
                        for (j, part) in line_of.inverse_times(noisy).into_iter().enumerate() {
                            bias[(j, line)] = -(part / line_of.responses[j]).re;
                        }
                    }
                    LineValidity::Valid
                } else {
                    LineValidity::DependentInputs
                }
            };
        }
        response.noise_bias = bias;
        Ok(response)
    }
}

#[cfg(test)]
mod tests;
