//! Responses to several inputs at once, with multiple and partial coherence.
//!
//! Theory: `docs/theory/spectra.md#frequency-response`.

use ndarray::Array2;
use num_complex::Complex64;

use crate::channel;
use crate::frf;
use crate::{AveragedSpectra, Channel, LabioError, LineValidity};

/// Inputs depend on each other if of one no more than this part of its power is its own: three digits of a response would be
/// left in double precision.
const OWN_POWER: f64 = 1e-12;

/// The responses of one output to several inputs that act together,
/// $`Y = \sum_j H_j X_j`$ + noise.
///
/// | field | shape | unit |
/// |---|---|---|
/// | `frequency_hz` | `(n_lines)` | Hz |
/// | `values` | `(n_inputs, n_lines)` | unit of the output / unit of the input |
/// | `variance` | `(n_inputs, n_lines)` | its square |
/// | `partial_coherence`, `ordered_coherence` | `(n_inputs, n_lines)` | 1 |
/// | `multiple_coherence` | `(n_lines)` | 1 |
///
/// Invalid lines hold NaN.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MultiInputResponse {
    /// The inputs, in the order in which they were asked for.
    pub inputs: Vec<Channel>,
    /// The output.
    pub output: Channel,
    /// Number of hits or segments averaged.
    pub n_averages: usize,
    /// Number of independent hits or segments of the same variance.
    pub effective_averages: f64,
    /// Frequencies of the lines.
    pub frequency_hz: Vec<f64>,
    /// $`H_j`$, least squares in the output: H1 of several inputs.
    pub values: Array2<Complex64>,
    /// $`\mathrm E\lvert\delta H_j\rvert^2`$, twice the variance of a component.
    pub variance: Array2<f64>,
    /// Part of the output's power that is linear in all inputs together.
    pub multiple_coherence: Vec<f64>,
    /// Coherence of input j and the output after what is linear in all other inputs has been taken from both.
    pub partial_coherence: Array2<f64>,
    /// Part of the output's power that is linear in what input j has beyond the inputs *before* it (the conditioned spectra of
    /// Bendat and Piersol, in the order of the inputs): they sum to the multiple coherence.
    pub ordered_coherence: Array2<f64>,
    /// Whether each line carries information.
    pub validity: Vec<LineValidity>,
}

impl AveragedSpectra {
    /// Responses of `output` to `inputs` that act together.
    ///
    /// With the spectra scaled to unit autos, $`R_{ij} = G_{ij}/\sqrt{G_{ii}G_{jj}}`$ and $`r_i = G_{iy}/\sqrt{G_{ii}G_{yy}}`$, the responses
    /// solve $`R h = r`$, $`h_j = H_j\sqrt{G_{jj}/G_{yy}}`$, and
    ///
    /// ```math
    /// \gamma^2_{y:x} = r^* R^{-1} r, \qquad
    /// \mathrm{Var}\,h_j = \frac{(1-\gamma^2_{y:x})\,(R^{-1})_{jj}}{n_e - q}, \qquad
    /// \gamma^2_{jy\cdot\mathrm{rest}} = \frac{\lvert h_j\rvert^2}{\lvert h_j\rvert^2 + (1-\gamma^2_{y:x})(R^{-1})_{jj}} .
    /// ```
    ///
    /// With q inputs the q fitted responses cost q averages: for one input it is the variance of [`AveragedSpectra::h1`].
    ///
    /// # Validity
    ///
    /// Noise on the output only. Inputs that depend on each other linearly cannot be told apart: such lines are flagged
    /// [`LineValidity::DependentInputs`]. A single test in which all inputs keep their ratio, as two shakers on one signal, is
    /// of that kind however many averages are taken.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without an input, [`LabioError::UnknownChannel`], [`LabioError::DuplicateChannel`] if a
    /// channel is named twice, [`LabioError::TooFewAverages`] unless there is effectively more than one average more than inputs.
    #[allow(
        clippy::indexing_slicing,
        reason = "the lists hold the q inputs and behind them the output, and all spectra of one average have the same lines"
    )]
    pub fn multi_input(
        &self,
        inputs: &[&str],
        output: &str,
    ) -> Result<MultiInputResponse, LabioError> {
        let q = inputs.len();
        if q == 0 {
            return Err(LabioError::CountMismatch {
                what: "inputs",
                found: 0,
                expected: 1,
            });
        }
        let names = inputs.iter().chain(std::iter::once(&output));
        let channels = names
            .map(|name| channel::find(self.channels(), name).map(|(_, channel)| channel.clone()))
            .collect::<Result<Vec<Channel>, _>>()?;
        channel::check_distinct(&channels)?;
        if self.n_averages() <= q || self.effective_averages() <= q as f64 {
            return Err(LabioError::TooFewAverages {
                estimate: "a response to several inputs",
                found: self.n_averages(),
                expected: q + 1,
            });
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
            frequency_hz: self.frequency_hz().to_vec(),
            values: Array2::from_elem((q, n_lines), Complex64::new(none, none)),
            variance: Array2::from_elem((q, n_lines), none),
            multiple_coherence: vec![none; n_lines],
            partial_coherence: Array2::from_elem((q, n_lines), none),
            ordered_coherence: Array2::from_elem((q, n_lines), none),
            validity: vec![LineValidity::Valid; n_lines],
        };
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
                    LineValidity::Valid
                } else {
                    LineValidity::DependentInputs
                }
            };
        }
        Ok(response)
    }
}

/// Solves one line by Cholesky's factors, R = L L*.
struct ConditionedLine {
    q: usize,
    /// L, row by row.
    factor: Vec<Complex64>,
    /// A column of L^-1.
    column: Vec<Complex64>,
    /// L^-1 r: what each input adds to those before it.
    ordered: Vec<Complex64>,
    /// R^-1 r.
    responses: Vec<Complex64>,
    /// Diagonal of R^-1.
    inverse_diagonal: Vec<f64>,
    multiple: f64,
}

#[allow(
    clippy::indexing_slicing,
    reason = "the factor has q rows of q elements, the lists q elements, and every index counts to q"
)]
impl ConditionedLine {
    fn new(q: usize) -> Self {
        Self {
            q,
            factor: vec![Complex64::ZERO; q * q],
            column: vec![Complex64::ZERO; q],
            ordered: vec![Complex64::ZERO; q],
            responses: vec![Complex64::ZERO; q],
            inverse_diagonal: vec![0.0; q],
            multiple: f64::NAN,
        }
    }

    /// Of the scaled spectra of inputs 0 .. q-1 and the output q; false if inputs are dependent.
    fn solve(&mut self, scaled: impl Fn(usize, usize) -> Complex64) -> bool {
        let q = self.q;
        for i in 0..q {
            for j in 0..=i {
                let (row_i, row_j) = (&self.factor[i * q..][..j], &self.factor[j * q..][..j]);
                let products = row_i.iter().zip(row_j).map(|(a, b)| a * b.conj());
                let rest = scaled(i, j) - products.sum::<Complex64>();
                self.factor[i * q + j] = if i > j {
                    rest / self.factor[j * q + j]
                } else if rest.re > OWN_POWER {
                    rest.re.sqrt().into()
                } else {
                    return false;
                };
            }
        }
        for i in 0..q {
            let known = self.factor[i * q..][..i].iter().zip(&self.ordered);
            let known: Complex64 = known.map(|(l, c)| l * c).sum();
            self.ordered[i] = (scaled(i, q) - known) / self.factor[i * q + i];
        }
        for i in (0..q).rev() {
            let later = (i + 1..q).map(|k| self.factor[k * q + i].conj() * self.responses[k]);
            let later: Complex64 = later.sum();
            self.responses[i] = (self.ordered[i] - later) / self.factor[i * q + i].conj();
        }
        for j in 0..q {
            self.column.fill(Complex64::ZERO);
            let mut squares = 0.0;
            for i in j..q {
                let known = self.factor[i * q..][..i].iter().zip(&self.column);
                let known: Complex64 = known.map(|(l, c)| l * c).sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                self.column[i] = (unit - known) / self.factor[i * q + i];
                squares += self.column[i].norm_sqr();
            }
            self.inverse_diagonal[j] = squares;
        }
        let explained: f64 = self.ordered.iter().map(Complex64::norm_sqr).sum();
        // at most 1 up to rounding, as the ordinary one
        self.multiple = explained.min(1.0);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Provenance, Quantity, Record, SpectrumAverager, Window};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const NAMES: [&str; 4] = ["a", "b", "c", "y"];
    const GAINS: [f64; 3] = [2.0, -0.5, 1.5];

    fn channels() -> Vec<Channel> {
        NAMES
            .iter()
            .map(|name| Channel::new(*name, Quantity::Velocity).unwrap())
            .collect()
    }

    /// Three inputs, the second with half of the first in it and the third with the first two, through gains; noise on the output.
    fn spectra(n: usize, n_hits: usize, noise: f64, seed: u64) -> AveragedSpectra {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut averager = SpectrumAverager::new(&channels(), n, 1.0, Window::Rectangular).unwrap();
        for _ in 0..n_hits {
            let mut samples = Array2::zeros((4, n));
            for i in 0..n {
                let a = normal();
                let b = normal() + 0.5 * a;
                let c = normal() + 0.3 * a - 0.8 * b;
                samples[(0, i)] = a;
                samples[(1, i)] = b;
                samples[(2, i)] = c;
                samples[(3, i)] = GAINS[0] * a + GAINS[1] * b + GAINS[2] * c + noise * normal();
            }
            let provenance = Provenance::computed("noise");
            let hit = Record::new(samples, 1.0, 0.0, channels(), provenance).unwrap();
            averager.add(&hit).unwrap();
        }
        averager.spectra().unwrap()
    }

    #[test]
    fn gains_of_dependent_inputs_are_separated_exactly_without_noise() {
        let response = spectra(64, 6, 0.0, 1)
            .multi_input(&["a", "b", "c"], "y")
            .unwrap();
        for line in 0..33 {
            for (j, gain) in GAINS.iter().enumerate() {
                // rounding, amplified by inputs that six averages make nearly dependent on some lines
                assert!((response.values[(j, line)] - gain).norm() < 1e-9);
            }
            assert!((response.multiple_coherence[line] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn one_input_is_h1_and_the_ordinary_coherence() {
        let n_hits = 5;
        let spectra = spectra(64, n_hits, 1.0, 2);
        let several = spectra.multi_input(&["a"], "y").unwrap();
        let single = spectra.h1("a", "y").unwrap();
        let coherence = single.coherence.unwrap();
        let variance = single.variance.unwrap();
        for line in 0..33 {
            // the same ratio by way of square roots
            assert!((several.values[(0, line)] / single.values[line] - 1.0).norm() < 1e-13);
            for found in [
                several.multiple_coherence[line],
                several.partial_coherence[(0, line)],
                several.ordered_coherence[(0, line)],
            ] {
                assert!((found - coherence[line]).abs() < 1e-13);
            }
            let ratio = several.variance[(0, line)] / variance[line];
            assert!((ratio - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn coherences_are_those_of_the_model() {
        let spectra = spectra(1024, 200, 1.0, 3);
        let response = spectra.multi_input(&["a", "b", "c"], "y").unwrap();
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / 513.0;
        // a = u, b = v + u/2, c = w - 0.8 v - 0.1 u: y = 2a - b/2 + 3c/2 + e = 1.6 u - 1.7 v + 1.5 w + e
        let parts = [1.6_f64.powi(2), 1.7_f64.powi(2), 1.5_f64.powi(2)];
        let total = parts.iter().sum::<f64>() + 1.0;
        // a coherence has a standard error below sqrt(2/200)/2 = 0.05, its mean over 513 lines 0.0022; bias q/200 (1-g2) = 0.0017
        let close = |found: f64, expected: f64| (found - expected).abs() < 0.011;
        let multiple = mean(&mut response.multiple_coherence.iter().copied());
        assert!(close(multiple, 1.0 - 1.0 / total), "{multiple}");
        for (j, part) in parts.iter().enumerate() {
            let ordered = mean(&mut response.ordered_coherence.row(j).iter().copied());
            assert!(close(ordered, part / total), "{j}: {ordered}");
        }
        // conditioned on the rest, c is w, whose part of y is (3/2)^2 against noise 1
        let partial = mean(&mut response.partial_coherence.row(2).iter().copied());
        assert!(close(partial, 2.25 / 3.25), "{partial}");
        for line in 0..513 {
            let sum = response.ordered_coherence.column(line).sum();
            assert!((sum - response.multiple_coherence[line]).abs() < 1e-13);
        }
    }

    #[test]
    fn variances_are_the_scatter_over_lines() {
        let (n, n_hits) = (8192, 10);
        let response = spectra(n, n_hits, 1.0, 4)
            .multi_input(&["a", "b", "c"], "y")
            .unwrap();
        for (j, gain) in GAINS.iter().enumerate() {
            let lines = 1..n / 2;
            let count = lines.len() as f64;
            let square = |k: usize| (response.values[(j, k)] - gain).norm_sqr();
            let scatter = lines.clone().map(square).sum::<f64>() / count;
            let stated = lines.map(|k| response.variance[(j, k)]).sum::<f64>() / count;
            // heavy tails of 1/(chi-square of 8 averages): relative standard deviation about 1.4 a line, 2.2 % of 4095: four of these
            assert!(
                (scatter / stated - 1.0).abs() < 0.09,
                "{j}: {scatter} {stated}"
            );
        }
    }

    #[test]
    fn inputs_that_depend_on_each_other_are_flagged() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut averager =
            SpectrumAverager::new(&channels(), 32, 1.0, Window::Rectangular).unwrap();
        for _ in 0..6 {
            let mut samples = Array2::zeros((4, 32));
            for i in 0..32 {
                let a: f64 = StandardNormal.sample(&mut rng);
                samples[(0, i)] = a;
                samples[(1, i)] = -3.0 * a;
                samples[(3, i)] = a;
            }
            let provenance = Provenance::computed("noise");
            averager
                .add(&Record::new(samples, 1.0, 0.0, channels(), provenance).unwrap())
                .unwrap();
        }
        let spectra = averager.spectra().unwrap();
        let validity = |inputs: &[&str]| spectra.multi_input(inputs, "y").unwrap().validity;
        let all = |validity: Vec<LineValidity>, expected| validity.iter().all(|v| *v == expected);
        assert!(all(validity(&["a", "b"]), LineValidity::DependentInputs));
        assert!(all(validity(&["a", "c"]), LineValidity::NoInput));
        assert!(all(validity(&["a"]), LineValidity::Valid));
    }

    #[test]
    fn requests_that_cannot_be_met_are_refused() {
        let spectra = spectra(16, 2, 1.0, 6);
        let refusals = [
            spectra.multi_input(&[], "y"),
            spectra.multi_input(&["a", "z"], "y"),
            spectra.multi_input(&["a", "y"], "y"),
            spectra.multi_input(&["a", "b"], "y"),
        ]
        .map(|result| result.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        inputs: found 0, expected 1
        there is no channel `z`, only `a`, `b`, `c`, `y`
        channels 1 and 2 are both named `y`
        a response to several inputs needs at least 3 averages, found 2
        ");
    }
}
