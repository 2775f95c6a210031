//! Frequency responses, coherence and their random errors, from averaged spectra.

use num_complex::Complex64;

use crate::channel::{self, Channel};
use crate::{AveragedSpectra, LabioError};

/// Standard deviation of a phase of which nothing is known: uniform over a turn, $`\pi/\sqrt3`$ rad.
const UNKNOWN_PHASE: f64 = 1.813_799_364_234_217_8;

/// How the frequency response was formed from the averaged spectra of input x and output y.
///
/// With noise of relative level $`a = N_x/G_{xx}`$ on the input and $`b = N_y/G_{yy}`$ on the output, uncorrelated with everything,
/// the expectations are biased as given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Estimator {
    /// $`H_1 = G_{xy}/G_{xx}`$: free of output noise, too small by $`1/(1+a)`$. Least squares in y.
    H1,
    /// $`H_2 = G_{yy}/G_{yx}`$: free of input noise, too large by $`1+b`$. Least squares in x.
    H2,
    /// $`H_v = \sqrt{H_1 H_2}`$, phase of $`G_{xy}`$: the scale-free total least squares, too large by
    /// $`\sqrt{(1+b)/(1+a)}`$.
    Hv,
}

/// Whether a line carries information, or why not. The values of a line that does not are NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LineValidity {
    /// The line is a measurement; how good, its coherence and random error say.
    Valid,
    /// The input auto-spectrum is zero or at the rounding of the transform.
    NoInput,
    /// The output auto-spectrum is zero or at the rounding of the transform.
    NoOutput,
    /// Input and output are both there, but their cross-spectrum is zero within rounding: H2 and Hv do not exist.
    NoCorrelation,
}

/// Standard deviation of a line, to first order in its size.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RandomError {
    /// Of |H|, relative to |H|: $`\varepsilon = \sqrt{(1-\gamma^2)/(2 n \gamma^2)}`$. Infinite without coherence; beyond about
    /// 0.2 it only says that the line is bad.
    pub magnitude: f64,
    /// Of the phase \[rad\]: the same number, but never more than $`\pi/\sqrt3`$, which means an unknown phase.
    pub phase: f64,
}

/// A measured frequency response with the figures that say how good it is.
///
/// | field | shape | unit |
/// |---|---|---|
/// | `frequency_hz` | `(n_lines)`, from 0 | Hz |
/// | `values` | `(n_lines)` | unit of output / unit of input |
/// | `coherence`, `random_error` | `(n_lines)`, or none for one average | 1 |
/// | `validity` | `(n_lines)` | |
///
/// # Validity
///
/// The system is linear and stationary over the hits, each hit fits in the record, and the noise is as the
/// [`Estimator`] wants it. The random error assumes independent hits (J. S. Bendat and A. G. Piersol, *Random Data*, for
/// H1; the other estimators agree to first order when the coherence is high).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct FrequencyResponse {
    /// How the values were formed.
    pub estimator: Estimator,
    /// The input channel.
    pub input: Channel,
    /// The output channel.
    pub output: Channel,
    /// Number of hits averaged.
    pub n_averages: usize,
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Output over input; NaN where `validity` says why.
    pub values: Vec<Complex64>,
    /// Ordinary coherence, NaN on invalid lines; none for a single average, where it would be 1 whatever was measured.
    pub coherence: Option<Vec<f64>>,
    /// Random error, NaN on invalid lines; none for a single average.
    pub random_error: Option<Vec<RandomError>>,
    /// Whether each line carries information.
    pub validity: Vec<LineValidity>,
}

impl FrequencyResponse {
    /// Indices of the lines that carry no information, to be left out of whatever is made of the response.
    pub fn invalid_lines(&self) -> impl Iterator<Item = usize> + '_ {
        self.validity
            .iter()
            .enumerate()
            .filter(|(_, validity)| **validity != LineValidity::Valid)
            .map(|(line, _)| line)
    }
}

/// Ordinary coherence $`\gamma^2 = |G_{xy}|^2/(G_{xx}G_{yy})`$: the part of the output's power that is linear in the input.
///
/// With noise-to-signal ratios $`N_x/S_x`$ and $`N_y/S_y`$ it tends to
/// $`1/((1+N_x/S_x)(1+N_y/S_y))`$. Nonlinearity, leakage and a second input lower it as well.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Coherence {
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Coherence; NaN where `validity` says why.
    pub values: Vec<f64>,
    /// Number of hits averaged.
    pub n_averages: usize,
    /// Whether each line carries information.
    pub validity: Vec<LineValidity>,
}

impl Coherence {
    /// Expected bias of each line, to first order $`(1-\gamma^2)^2/n`$: with few hits an estimate is too high, and n hits
    /// of pure noise give 1/n.
    #[must_use]
    pub fn bias(&self) -> Vec<f64> {
        self.values
            .iter()
            .map(|coherence| (1.0 - coherence).powi(2) / self.n_averages as f64)
            .collect()
    }
}

impl AveragedSpectra {
    /// Frequency response $`H_1 = G_{xy}/G_{xx}`$: for noise on the output.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn h1(&self, input: &str, output: &str) -> Result<FrequencyResponse, LabioError> {
        self.response(Estimator::H1, input, output)
    }

    /// Frequency response $`H_2 = G_{yy}/G_{yx}`$: for noise on the input.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn h2(&self, input: &str, output: &str) -> Result<FrequencyResponse, LabioError> {
        self.response(Estimator::H2, input, output)
    }

    /// Frequency response $`H_v = \sqrt{H_1H_2}`$: for the same relative noise on both.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn hv(&self, input: &str, output: &str) -> Result<FrequencyResponse, LabioError> {
        self.response(Estimator::Hv, input, output)
    }

    /// Ordinary coherence between two channels.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`]; [`LabioError::TooFewAverages`] for a single hit, whose coherence is 1 by
    /// construction and says nothing.
    pub fn coherence(&self, input: &str, output: &str) -> Result<Coherence, LabioError> {
        if self.n_averages() < 2 {
            return Err(LabioError::TooFewAverages {
                estimate: "the coherence",
                found: self.n_averages(),
                expected: 2,
            });
        }
        let lines = self.pair(input, output)?;
        let validity: Vec<LineValidity> = lines.iter().map(|line| line.validity).collect();
        Ok(Coherence {
            frequency_hz: self.frequency_hz().to_vec(),
            values: lines.iter().map(PairLine::coherence).collect(),
            n_averages: self.n_averages(),
            validity,
        })
    }

    fn response(
        &self,
        estimator: Estimator,
        input: &str,
        output: &str,
    ) -> Result<FrequencyResponse, LabioError> {
        let (_, input_channel) = channel::find(self.channels(), input)?;
        let (_, output_channel) = channel::find(self.channels(), output)?;
        let mut lines = self.pair(input, output)?;
        let rounding = self.transform_rounding();
        if estimator != Estimator::H1 {
            for line in &mut lines {
                let least = rounding * rounding * line.input * line.output;
                if line.validity == LineValidity::Valid && line.cross.norm_sqr() <= least {
                    line.validity = LineValidity::NoCorrelation;
                }
            }
        }
        let averaged = self.n_averages() > 1;
        Ok(FrequencyResponse {
            estimator,
            input: input_channel.clone(),
            output: output_channel.clone(),
            n_averages: self.n_averages(),
            frequency_hz: self.frequency_hz().to_vec(),
            values: lines.iter().map(|line| line.ratio(estimator)).collect(),
            coherence: averaged.then(|| lines.iter().map(PairLine::coherence).collect()),
            random_error: averaged.then(|| {
                lines
                    .iter()
                    .map(|line| RandomError::of(line.coherence(), self.n_averages()))
                    .collect()
            }),
            validity: lines.iter().map(|line| line.validity).collect(),
        })
    }

    /// Relative rounding error of a transform: $`\epsilon\log_2 N`$ of the root mean square line.
    fn transform_rounding(&self) -> f64 {
        f64::EPSILON * (self.n_samples() as f64).log2().max(1.0)
    }

    fn pair(&self, input: &str, output: &str) -> Result<Vec<PairLine>, LabioError> {
        let inputs = self.auto(input)?;
        let outputs = self.auto(output)?;
        let crosses = self.cross(input, output)?;
        let mean = |auto: &[f64]| auto.iter().sum::<f64>() / auto.len() as f64;
        let rounding = self.transform_rounding().powi(2);
        let (least_input, least_output) = (rounding * mean(&inputs), rounding * mean(&outputs));
        let line = |((input, output), cross)| PairLine {
            input,
            output,
            cross,
            validity: if input <= least_input {
                LineValidity::NoInput
            } else if output <= least_output {
                LineValidity::NoOutput
            } else {
                LineValidity::Valid
            },
        };
        Ok(inputs
            .into_iter()
            .zip(outputs)
            .zip(crosses)
            .map(line)
            .collect())
    }
}

impl RandomError {
    fn of(coherence: f64, n_averages: usize) -> Self {
        let magnitude = ((1.0 - coherence) / (2.0 * n_averages as f64 * coherence)).sqrt();
        let phase = if magnitude > UNKNOWN_PHASE {
            UNKNOWN_PHASE
        } else {
            magnitude
        };
        Self { magnitude, phase }
    }
}

/// The spectra of one line of a pair of channels.
struct PairLine {
    input: f64,
    output: f64,
    cross: Complex64,
    validity: LineValidity,
}

impl PairLine {
    fn coherence(&self) -> f64 {
        if self.validity == LineValidity::Valid || self.validity == LineValidity::NoCorrelation {
            // at most 1 by Schwarz' inequality: the bound takes off rounding only
            (self.cross.norm() / self.input * (self.cross.norm() / self.output)).min(1.0)
        } else {
            f64::NAN
        }
    }

    fn ratio(&self, estimator: Estimator) -> Complex64 {
        if self.validity != LineValidity::Valid {
            return Complex64::new(f64::NAN, f64::NAN);
        }
        match estimator {
            Estimator::H1 => self.cross / self.input,
            Estimator::H2 => self.output / self.cross.conj(),
            Estimator::Hv => {
                self.cross / self.cross.norm() * (self.output.sqrt() / self.input.sqrt())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Provenance, Quantity, Record, SpectrumAverager, Window};
    use ndarray::Array2;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const RATE: f64 = 1000.0;

    fn hit(input: &[f64], output: &[f64]) -> Record {
        let samples =
            Array2::from_shape_fn((2, input.len()), |(channel, n)| [input, output][channel][n]);
        let channels = vec![
            Channel::new("x", Quantity::Force).unwrap(),
            Channel::new("y", Quantity::Velocity).unwrap(),
        ];
        Record::new(samples, RATE, 0.0, channels, Provenance::computed("test")).unwrap()
    }

    fn noise(rng: &mut ChaCha8Rng, n: usize, level: f64) -> Vec<f64> {
        (0..n)
            .map(|_| {
                let unit: f64 = StandardNormal.sample(rng);
                level * unit
            })
            .collect()
    }

    /// Circular convolution by direct sum, so that a line of the output is the response times the line of the input.
    fn circular(filter: &[f64], input: &[f64]) -> Vec<f64> {
        let n = input.len();
        (0..n)
            .map(|i| {
                let past = filter.iter().enumerate();
                past.map(|(lag, h)| h * input[(i + n - lag) % n]).sum()
            })
            .collect()
    }

    fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a + b).collect()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn a_known_filter_is_found_by_all_estimators() {
        let filter = [0.7, -0.2, 0.0, 0.45, 0.1]; // last tap makes the zeros lie off the unit circle
        let n = 96;
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let hits: Vec<Record> = (0..3)
            .map(|_| {
                let input = noise(&mut rng, n, 1.0);
                hit(&input, &circular(&filter, &input))
            })
            .collect();
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        for response in [
            spectra.h1("x", "y"),
            spectra.h2("x", "y"),
            spectra.hv("x", "y"),
        ] {
            let response = response.unwrap();
            assert_eq!(response.invalid_lines().count(), 0);
            for (f, value) in response.frequency_hz.iter().zip(&response.values) {
                let exact: Complex64 = filter
                    .iter()
                    .enumerate()
                    .map(|(lag, h)| h * Complex64::cis(-TAU * f * lag as f64 / RATE))
                    .sum();
                // rounding of the transforms, amplified by the weakest of 49 lines of noise
                assert!((value - exact).norm() < 1e-12, "{f} Hz: {value} {exact}");
            }
            let coherence = response.coherence.unwrap();
            assert!(coherence.iter().all(|c| (c - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_delay_turns_the_phase_backwards() {
        let n = 100;
        let mut pulse = vec![0.0; n];
        pulse[3] = 2.0;
        let mut later = vec![0.0; n];
        later[10] = 2.0;
        let spectra = AveragedSpectra::of([&hit(&pulse, &later)], Window::Rectangular).unwrap();
        let response = spectra.h1("x", "y").unwrap();
        for (f, value) in response.frequency_hz.iter().zip(&response.values) {
            // seven samples; rounding only
            assert!((value - Complex64::cis(-TAU * f * 7.0 / RATE)).norm() < 1e-12);
        }
    }

    #[test]
    fn one_average_gives_a_response_but_no_coherence() {
        let one = hit(&[1.0, 0.0, 0.0, 0.0], &[0.5, 0.25, 0.0, 0.0]);
        let spectra = AveragedSpectra::of([&one], Window::Rectangular).unwrap();
        let response = spectra.h1("x", "y").unwrap();
        assert!(response.coherence.is_none() && response.random_error.is_none());
        let error = spectra.coherence("x", "y").unwrap_err();
        assert!(matches!(
            error,
            LabioError::TooFewAverages {
                found: 1,
                expected: 2,
                ..
            }
        ));
    }

    /// Hits of white noise through a gain of 2, with noise of relative power `a` on the input and `b` on the output.
    fn noisy(seed: u64, n: usize, n_hits: usize, a: f64, b: f64) -> AveragedSpectra {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut averager = SpectrumAverager::for_records_like(
            &hit(&vec![0.0; n], &vec![0.0; n]),
            Window::Rectangular,
        )
        .unwrap();
        for _ in 0..n_hits {
            let clean = noise(&mut rng, n, 1.0);
            let output: Vec<f64> = clean.iter().map(|x| 2.0 * x).collect();
            let input = sum(&clean, &noise(&mut rng, n, a.sqrt()));
            let output = sum(&output, &noise(&mut rng, n, 2.0 * b.sqrt()));
            averager.add(&hit(&input, &output)).unwrap();
        }
        averager.spectra().unwrap()
    }

    #[test]
    fn noise_biases_the_estimators_and_the_coherence_as_theory_says() {
        let (a, b, n_hits) = (0.25, 0.5, 200);
        let spectra = noisy(3, 512, n_hits, a, b);
        let magnitudes = |response: FrequencyResponse| -> Vec<f64> {
            response.values.iter().map(|h| h.norm()).collect()
        };
        let h1 = magnitudes(spectra.h1("x", "y").unwrap());
        let h2 = magnitudes(spectra.h2("x", "y").unwrap());
        let hv = magnitudes(spectra.hv("x", "y").unwrap());
        let coherence = spectra.coherence("x", "y").unwrap();
        let g2 = 1.0 / ((1.0 + a) * (1.0 + b));
        // random error of a line 0.047, of the mean over 257 lines 0.003; four of these, plus the second-order bias of |H|
        // (half the squared random error, 0.001): 1.3 %
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.013;
        assert!(close(mean(&h1), 2.0 / (1.0 + a)), "{}", mean(&h1));
        assert!(close(mean(&h2), 2.0 * (1.0 + b)), "{}", mean(&h2));
        assert!(close(mean(&hv), 2.0 * ((1.0 + b) / (1.0 + a)).sqrt()));
        // standard error of a line sqrt(2 g2) (1 - g2)/sqrt n = 0.034, of the mean 0.0021; four of these, plus bias 0.001
        assert!((mean(&coherence.values) - g2).abs() < 0.0094);
        // line by line, by Schwarz' inequality: H1 is never above H2
        assert!(h1.iter().zip(&h2).all(|(h1, h2)| h1 <= h2));
        // and the truth lies between their expectations
        assert!(mean(&h1) < 2.0 && 2.0 < mean(&h2));
    }

    #[test]
    fn random_errors_are_the_spread_over_lines() {
        let n_hits = 20;
        let spectra = noisy(5, 4096, n_hits, 0.0, 0.3);
        let response = spectra.h1("x", "y").unwrap();
        let lines = 1..response.values.len() - 1; // DC and Nyquist have half the degrees of freedom
        let magnitude: Vec<f64> = lines
            .clone()
            .map(|k| (response.values[k].norm() / 2.0 - 1.0).powi(2))
            .collect();
        let phase: Vec<f64> = lines.map(|k| response.values[k].arg().powi(2)).collect();
        let g2: f64 = 1.0 / 1.3;
        let predicted = ((1.0 - g2) / (2.0 * n_hits as f64 * g2)).sqrt();
        // 2047 lines give a standard deviation to 1.6 %, four times that is 6.3 %; the finite number of hits (a factor
        // n/(n-1) in the variance) adds 2.6 %
        for spread in [mean(&magnitude).sqrt(), mean(&phase).sqrt()] {
            assert!(
                (spread / predicted - 1.0).abs() < 0.09,
                "{spread} {predicted}"
            );
        }
        // and what is reported a line, from the estimated coherence, is that number in the middle
        let mut reported: Vec<f64> = response
            .random_error
            .unwrap()
            .iter()
            .map(|e| e.magnitude)
            .collect();
        reported.sort_by(f64::total_cmp);
        let median = reported[reported.len() / 2];
        // bias of the estimated coherence, (1 - g2)^2/n = 0.0027, is 1.2 % of 1 - g2; spread of the median 1 %
        assert!(
            (median / predicted - 1.0).abs() < 0.05,
            "{median} {predicted}"
        );
    }

    #[test]
    fn the_coherence_of_nothing_in_common_is_its_bias() {
        let n_hits = 10;
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        let hits: Vec<Record> = (0..n_hits)
            .map(|_| hit(&noise(&mut rng, 4096, 1.0), &noise(&mut rng, 4096, 1.0)))
            .collect();
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        let coherence = spectra.coherence("x", "y").unwrap();
        // beta law (1, n-1): mean 1/n, standard deviation 0.09, of the mean of 2049 lines 0.002: four of these
        assert!((mean(&coherence.values) - 0.1).abs() < 0.008);
        // the stated bias, taken at the estimate, is (1-g2)^2/n with mean ((n-1)/n)(n/(n+1))/n = 0.0818
        assert!((mean(&coherence.bias()) - 0.0818).abs() < 0.002);
    }

    #[test]
    fn empty_lines_are_flagged_with_their_reason() {
        // every fifth sample of 60: lines 0, 12 and 24 have all the energy, the others what the transform rounds
        let train: Vec<f64> = (0..60)
            .map(|i| if i % 5 == 0 { 1.0 / 3.0 } else { 0.0 })
            .collect();
        let silent = vec![0.0; train.len()];
        let train_in = hit(&train, &train);
        let spectra = AveragedSpectra::of([&train_in, &train_in], Window::Rectangular).unwrap();
        let response = spectra.h1("x", "y").unwrap();
        for (k, validity) in response.validity.iter().enumerate() {
            if k % 12 == 0 {
                assert_eq!(*validity, LineValidity::Valid);
                // one rounding of a ratio
                assert!((response.values[k] - 1.0).norm() < 1e-15);
            } else {
                assert_eq!(*validity, LineValidity::NoInput, "line {k}");
                assert!(response.values[k].is_nan());
            }
        }
        let mut pulse = silent.clone();
        pulse[0] = 1.0;
        let nothing_out = hit(&pulse, &silent);
        let spectra = AveragedSpectra::of([&nothing_out, &nothing_out], Window::Rectangular);
        let response = spectra.unwrap().h1("x", "y").unwrap();
        assert!(
            response
                .validity
                .iter()
                .all(|v| *v == LineValidity::NoOutput)
        );
        // two hits of opposite sign in the output only: the cross-spectrum cancels
        let minus: Vec<f64> = pulse.iter().map(|x| -x).collect();
        let hits = [hit(&pulse, &pulse), hit(&pulse, &minus)];
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        let h1 = spectra.h1("x", "y").unwrap();
        let h2 = spectra.h2("x", "y").unwrap();
        assert!(h1.values.iter().all(|h| h.norm() < 1e-15));
        assert!(
            h1.random_error
                .unwrap()
                .iter()
                .all(|e| e.magnitude.is_infinite())
        );
        assert!(
            h2.validity
                .iter()
                .all(|v| *v == LineValidity::NoCorrelation)
        );
    }
}
