//! Error of a force history: its size, its correlation over time, and confidence bands.
//!
//! Theory: `docs/theory/force-uncertainty.md#first-order-errors`.

use std::ops::Range;

use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::{ChiSquared, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::error::{check_enough, check_length, check_probability};
use crate::{ForceHistory, ImpulseError, fourier};

/// Fewest draws for a 95 % quantile: with fewer, it would rest on fewer than ten draws.
const FEWEST_DRAWS: usize = 200;

/// Largest number of values in all draws together, which take two gibibytes.
const MOST_NUMBERS: usize = 1 << 28;

/// The random error of a force history, to first order in its causes.
///
/// The error is a sum of independent Gaussian parts. Correlated over time are: one part from
/// circular errors of spectral lines, with the same standard deviation at all times of a period;
/// one for each cause common to all times, such as the impact velocity; one for the samples of a
/// support. A further part may be independent from sample to sample.
#[derive(Debug, Clone)]
pub struct ForceError {
    standard_error: Vec<f64>,
    lines: Option<LineErrors>,
    /// Effect of one standard deviation of each common cause on the force.
    common: Vec<Vec<f64>>,
    support: Option<SupportErrors>,
    /// Index of the first sample with an independent error, and the standard errors from this
    /// sample on.
    independent: Option<(usize, Vec<f64>)>,
    degrees_of_freedom: Option<f64>,
}

/// Errors of the lines of a period.
#[derive(Debug, Clone)]
struct LineErrors {
    /// $`\mathrm E\lvert\delta F_k\rvert^2`$ \[N²\] of the amplitudes, $`F(t) = \sum_k F_k
    /// e^{i\omega_k t}`$ over both sides.
    variances: Vec<f64>,
    n_period: usize,
    /// Range of the samples whose mean error is added to all samples, and the sign of this
    /// addition.
    reference: Option<(Range<usize>, f64)>,
}

/// Errors of the samples from `first` on: a matrix times independent standard normal numbers.
#[derive(Debug, Clone)]
struct SupportErrors {
    first: usize,
    /// Matrix by rows, `(n_support, n_support)`.
    factor: Vec<Vec<f64>>,
}

/// Meaning of the limits of a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Coverage {
    /// The force at each single time is inside with the stated probability.
    Pointwise,
    /// The whole history is inside with the stated probability.
    Simultaneous,
}

/// A band around a force history.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ForceBand {
    /// The event to which the level applies.
    pub coverage: Coverage,
    /// The probability, between 0 and 1.
    pub level: f64,
    /// Half width in standard errors.
    pub factor: f64,
    /// Lower limits \[N\]; `(n_samples)`.
    pub lower: Vec<f64>,
    /// Upper limits \[N\]; `(n_samples)`.
    pub upper: Vec<f64>,
}

impl ForceBand {
    /// Fraction of the samples of `force` that are inside the band, over those indices of `window`
    /// that exist in both.
    #[must_use]
    pub fn part_inside(&self, force: &[f64], window: Range<usize>) -> f64 {
        let limits = self.lower.iter().zip(&self.upper).zip(force);
        let inside: Vec<bool> = limits
            .skip(window.start)
            .take(window.len())
            .map(|((lower, upper), f)| lower <= f && f <= upper)
            .collect();
        inside.iter().filter(|i| **i).count() as f64 / inside.len() as f64
    }

    /// Restricts the band to forces without tension: no limit below zero.
    #[must_use]
    pub fn compressive(mut self) -> Self {
        for limit in self.lower.iter_mut().chain(&mut self.upper) {
            *limit = limit.max(0.0);
        }
        self
    }
}

impl ForceError {
    /// Creates a zero error on `n_samples` samples.
    pub(crate) fn none(n_samples: usize) -> Self {
        Self {
            standard_error: vec![0.0; n_samples],
            lines: None,
            common: Vec::new(),
            support: None,
            independent: None,
            degrees_of_freedom: None,
        }
    }

    /// Adds errors of the lines of a period of `n_period` samples. The mean error over `reference`
    /// is then added to all samples with the given sign, as for a constant that was determined from
    /// the force itself.
    #[allow(
        clippy::indexing_slicing,
        reason = "there are sums for two periods, places in the period are taken modulo it, and a mean is over one period at most"
    )]
    pub(crate) fn with_lines(
        mut self,
        variances: Vec<f64>,
        n_period: usize,
        reference: Option<(Range<usize>, f64)>,
    ) -> Self {
        let lines: Vec<Complex64> = variances.iter().map(|v| (*v).into()).collect();
        let covariance = fourier::to_samples(&lines, n_period);
        let n_samples = self.standard_error.len();
        // cumulative sums of the periodic covariance over the lags
        let mut sums = vec![0.0; 2 * n_period + 1];
        for lag in 0..2 * n_period {
            sums[lag + 1] = sums[lag] + covariance[lag % n_period];
        }
        let with_reference = |time: usize, reference: &Range<usize>| -> f64 {
            let from = reference.start + n_period - time % n_period;
            let from = from % n_period;
            let length = reference.len().min(n_period);
            (sums[from + length] - sums[from]) / length as f64
        };
        let variance_of_mean = reference.as_ref().map(|(range, _)| {
            range.clone().map(|t| with_reference(t, range)).sum::<f64>() / range.len() as f64
        });
        let variance = covariance.first().copied().unwrap_or(0.0);
        for (time, error) in self.standard_error.iter_mut().enumerate().take(n_samples) {
            let total = match (&reference, variance_of_mean) {
                (Some((range, sign)), Some(of_mean)) => {
                    variance + 2.0 * sign * with_reference(time, range) + of_mean
                }
                _ => variance,
            };
            // rounding may make the difference of nearly equal numbers negative
            *error = (*error * *error + total.max(0.0)).sqrt();
        }
        self.lines = Some(LineErrors {
            variances,
            n_period,
            reference,
        });
        self
    }

    /// Adds a cause common to all times, by the effect of one standard deviation of it.
    pub(crate) fn with_common(mut self, effect: Vec<f64>) -> Self {
        for (error, effect) in self.standard_error.iter_mut().zip(&effect) {
            *error = error.hypot(*effect);
        }
        self.common.push(effect);
        self
    }

    /// Adds errors of the samples from `first` on, given by the rows of a square root of their
    /// covariance.
    pub(crate) fn with_support(mut self, first: usize, factor: Vec<Vec<f64>>) -> Self {
        for (error, row) in self.standard_error.iter_mut().skip(first).zip(&factor) {
            let variance: f64 = row.iter().map(|x| x * x).sum();
            *error = (*error * *error + variance).sqrt();
        }
        self.support = Some(SupportErrors { first, factor });
        self
    }

    /// Adds independent errors of the samples from `first` on, by their standard errors.
    pub(crate) fn with_independent(mut self, first: usize, standard_errors: Vec<f64>) -> Self {
        for (error, own) in self
            .standard_error
            .iter_mut()
            .skip(first)
            .zip(&standard_errors)
        {
            *error = error.hypot(*own);
        }
        self.independent = Some((first, standard_errors));
        self
    }

    /// Sets the degrees of freedom of the standard errors: bands use Student's distribution.
    pub(crate) fn with_degrees_of_freedom(self, degrees_of_freedom: f64) -> Self {
        Self {
            degrees_of_freedom: Some(degrees_of_freedom),
            ..self
        }
    }

    /// Standard errors of the samples \[N\]; `(n_samples)`.
    #[must_use]
    pub fn standard_error(&self) -> &[f64] {
        &self.standard_error
    }

    /// Returns the band around `history` that contains the force at each single time with the
    /// probability `level`.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1;
    /// [`ImpulseError::LengthMismatch`].
    pub fn pointwise(&self, history: &ForceHistory, level: f64) -> Result<ForceBand, ImpulseError> {
        check_probability("level of a band", level)?;
        let probability = 0.5 + 0.5 * level;
        let factor = match self.degrees_of_freedom {
            None => Normal::standard().inverse_cdf(probability),
            Some(degrees) => StudentsT::new(0.0, 1.0, degrees).map_or(f64::NAN, |distribution| {
                distribution.inverse_cdf(probability)
            }),
        };
        self.band(history, Coverage::Pointwise, level, factor)
    }

    /// Returns the band around `history` that contains the whole force over the samples `window`
    /// with the probability `level`. Its half width is a multiple of the standard error, found from
    /// `n_draws` correlated histories of errors. If the standard errors have limited degrees of
    /// freedom, the scale of each draw scatters as in Student's distribution.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the level; [`ImpulseError::TooShort`] for fewer than 200
    /// draws or for a window without samples; [`ImpulseError::LengthMismatch`].
    pub fn simultaneous(
        &self,
        history: &ForceHistory,
        level: f64,
        window: Range<usize>,
        n_draws: usize,
        random: &mut impl Rng,
    ) -> Result<ForceBand, ImpulseError> {
        check_probability("level of a band", level)?;
        check_draws(n_draws, 1)?;
        check_enough("set of draws", n_draws, FEWEST_DRAWS)?;
        let n_inside = self
            .standard_error
            .get(window.clone())
            .map_or(0, <[f64]>::len);
        check_enough("window of the band", n_inside, 1)?;
        // the scale scatters as the square root of chi-square divided by its degrees of freedom
        let scale = self.degrees_of_freedom.and_then(|degrees| {
            let squares = ChiSquared::new(degrees).ok()?;
            Some((degrees, squares))
        });
        let mut largest: Vec<f64> = (0..n_draws)
            .map(|_| {
                let draw = self.draw(random);
                let scale = scale.map_or(1.0, |(degrees, squares)| {
                    (random.sample(squares) / degrees).sqrt()
                });
                let samples = draw.iter().zip(&self.standard_error);
                let ratios = samples.skip(window.start).take(window.len());
                ratios
                    .filter(|(_, error)| **error > 0.0)
                    .map(|(draw, error)| (draw / error).abs() / scale)
                    .fold(0.0, f64::max)
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        let factor = quantile(&largest, level);
        self.band(history, Coverage::Simultaneous, level, factor)
    }

    /// Draws a random history of errors \[N\]; `(n_samples)`.
    pub fn draw(&self, random: &mut impl Rng) -> Vec<f64> {
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        let mut draw = vec![0.0; self.standard_error.len()];
        if let Some(lines) = &self.lines {
            for (sample, error) in draw.iter_mut().zip(lines.draw(&mut normal)) {
                *sample += error;
            }
        }
        for effect in &self.common {
            let size = normal();
            for (sample, effect) in draw.iter_mut().zip(effect) {
                *sample += size * effect;
            }
        }
        if let Some(SupportErrors { first, factor }) = &self.support {
            let numbers: Vec<f64> = factor.iter().map(|_| normal()).collect();
            for (sample, row) in draw.iter_mut().skip(*first).zip(factor) {
                let terms = row.iter().zip(&numbers);
                *sample += terms.map(|(a, z)| a * z).sum::<f64>();
            }
        }
        if let Some((first, errors)) = &self.independent {
            for (sample, error) in draw.iter_mut().skip(*first).zip(errors) {
                *sample += normal() * error;
            }
        }
        draw
    }

    fn band(
        &self,
        history: &ForceHistory,
        coverage: Coverage,
        level: f64,
        factor: f64,
    ) -> Result<ForceBand, ImpulseError> {
        if !factor.is_finite() {
            return Err(ImpulseError::NonPhysical {
                quantity: "level of a band",
                value: level,
                expected: "a probability with finite limits",
            });
        }
        let force = history.force();
        check_length(
            "force history of a band",
            force.len(),
            self.standard_error.len(),
        )?;
        let limits = |sign: f64| {
            let samples = force.iter().zip(&self.standard_error);
            samples
                .map(|(f, error)| f + sign * factor * error)
                .collect()
        };
        Ok(ForceBand {
            coverage,
            level,
            factor,
            lower: limits(-1.0),
            upper: limits(1.0),
        })
    }
}

impl LineErrors {
    fn draw(&self, normal: &mut impl FnMut() -> f64) -> Vec<f64> {
        let lines: Vec<Complex64> = self
            .variances
            .iter()
            .enumerate()
            .map(|(line, variance)| {
                if line == 0 || 2 * line == self.n_period {
                    Complex64::new(variance.sqrt() * normal(), 0.0)
                } else {
                    Complex64::new(normal(), normal()) * (0.5 * variance).sqrt()
                }
            })
            .collect();
        let mut samples = fourier::to_samples(&lines, self.n_period);
        if let Some((range, sign)) = &self.reference {
            let quiet = samples.get(range.clone()).unwrap_or_default();
            let mean = sign * quiet.iter().sum::<f64>() / range.len() as f64;
            for sample in &mut samples {
                *sample += mean;
            }
        }
        samples
    }
}

/// Running means and sums of squares of samples.
pub(crate) struct Moments {
    count: f64,
    pub(crate) mean: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    pub(crate) fn of(n_samples: usize) -> Self {
        Self {
            count: 0.0,
            mean: vec![0.0; n_samples],
            squares: vec![0.0; n_samples],
        }
    }

    pub(crate) fn add(&mut self, samples: &[f64]) {
        self.count += 1.0;
        let moments = self.mean.iter_mut().zip(&mut self.squares);
        for ((mean, squares), sample) in moments.zip(samples) {
            let away = sample - *mean;
            *mean += away / self.count;
            *squares += away * (sample - *mean);
        }
    }

    pub(crate) fn deviations(&self) -> Vec<f64> {
        let squares = self.squares.iter();
        squares.map(|s| (s / (self.count - 1.0)).sqrt()).collect()
    }
}

pub(crate) fn quantile(values: &[f64], level: f64) -> f64 {
    let position = level * (values.len() as f64 - 1.0);
    let mut above = values
        .iter()
        .enumerate()
        .skip_while(|(i, _)| (*i as f64) < position);
    above.next().map_or(f64::NAN, |(_, value)| *value)
}

/// Rejects `n_draws` draws of `numbers_each` numbers each that together exceed [`MOST_NUMBERS`].
pub(crate) fn check_draws(n_draws: usize, numbers_each: usize) -> Result<(), ImpulseError> {
    if n_draws.saturating_mul(numbers_each) <= MOST_NUMBERS {
        Ok(())
    } else {
        Err(ImpulseError::NonPhysical {
            quantity: "number of draws, each with its history,",
            value: n_draws as f64,
            expected: "at most 2^28 numbers in all draws together",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn coloured() -> ForceError {
        let variances: Vec<f64> = (0..=32)
            .map(|k| 1.0 / (1.0 + f64::from(k).powi(2)))
            .collect();
        let ramp: Vec<f64> = (0..48).map(|n| 0.03 * f64::from(n)).collect();
        let factor = vec![
            vec![0.8, 0.0, 0.0],
            vec![0.5, 0.3, 0.0],
            vec![0.1, 0.2, 0.9],
        ];
        ForceError::none(48)
            .with_lines(variances, 64, Some((40..48, -1.0)))
            .with_common(ramp)
            .with_support(10, factor)
            .with_independent(20, vec![0.4, 0.0, 1.5])
    }

    #[test]
    fn draws_scatter_by_the_standard_errors() {
        let error = coloured();
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let n_draws = 4000;
        let mut squares = vec![0.0; 48];
        for _ in 0..n_draws {
            for (sum, x) in squares.iter_mut().zip(error.draw(&mut random)) {
                *sum += x * x;
            }
        }
        for (n, sum) in squares.iter().enumerate() {
            let found = (sum / f64::from(n_draws)).sqrt();
            // tolerance: five times the standard error of a standard deviation, 1/sqrt(2*4000) =
            // 1.1 %, because 48 samples are compared
            let ratio = found / error.standard_error()[n];
            assert!((ratio - 1.0).abs() < 0.056, "{n} {ratio}");
        }
    }

    #[test]
    fn bands_hold_what_they_say() {
        let error = coloured();
        let history = ForceHistory::new(0.0, 1.0, vec![3.0; 48]).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let pointwise = error.pointwise(&history, 0.95).unwrap();
        let simultaneous = error
            .simultaneous(&history, 0.95, 0..48, 2000, &mut random)
            .unwrap();
        assert!((pointwise.factor - 1.959_964).abs() < 1e-6);
        assert!(simultaneous.factor > pointwise.factor);
        let n_draws = 2000;
        let (mut samples, mut histories) = (0.0, 0.0);
        for _ in 0..n_draws {
            let drawn: Vec<f64> = error.draw(&mut random).iter().map(|e| 3.0 + e).collect();
            samples += pointwise.part_inside(&drawn, 0..48);
            histories += simultaneous.part_inside(&drawn, 0..48).floor();
        }
        // tolerance: the count over 2000 draws has a standard error of sqrt(0.05*0.95/2000) = 0.5
        // %, and the factor of the band contributes as much; three standard errors for the whole
        // histories
        assert!(
            (samples / f64::from(n_draws) - 0.95).abs() < 0.015,
            "{samples}"
        );
        assert!(
            (histories / f64::from(n_draws) - 0.95).abs() < 0.021,
            "{histories}"
        );
    }

    #[test]
    fn few_degrees_of_freedom_widen_the_band() {
        let error = ForceError::none(1)
            .with_common(vec![2.0])
            .with_degrees_of_freedom(3.0);
        let history = ForceHistory::new(0.0, 1.0, vec![0.0]).unwrap();
        // from tables of Student's distribution
        let band = error.pointwise(&history, 0.95).unwrap();
        assert!((band.factor - 3.182_446).abs() < 1e-5);
        assert!((band.upper[0] - 6.364_893).abs() < 1e-5);
        // for one sample both bands are the same; the quantile of 40 000 draws is known to 1.2 %
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let whole = error.simultaneous(&history, 0.95, 0..1, 40_000, &mut random);
        assert!((whole.unwrap().factor / band.factor - 1.0).abs() < 0.05);
        assert_eq!(
            error.pointwise(&history, 1.0).unwrap_err().to_string(),
            "level of a band is 1, expected a probability between 0 and 1"
        );
    }
}
