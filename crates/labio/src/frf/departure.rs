//! Difference between two estimates of one response, for example with and without a window.

use super::{FrequencyResponse, LineValidity};
use crate::LabioError;
use crate::error::check_count;

/// Coherence above which lines are compared: below it, noise in the input causes an additional
/// bias.
const LEAST_COHERENCE: f64 = 0.9;
/// Fewest lines for a comparison.
const FEWEST_LINES: usize = 8;
/// Limit of the median difference in units of the stated error.
const APART: f64 = 2.0;
/// Limit, in units of the stated error, of the difference that one line in ten exceeds; chance
/// alone gives 3 with two hits and 2 with three.
const TENTH_APART: f64 = 4.0;

/// Relative difference between two estimates of one response, evaluated over their lines; medians
/// unless stated otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Median difference.
    pub median: f64,
    /// Difference that one line in ten exceeds.
    pub of_a_tenth: f64,
    /// Ratio of difference to stated error that one line in ten exceeds.
    pub errors_of_a_tenth: f64,
    /// Standard error of the difference of the complex lines, from both estimates together.
    pub stated: f64,
    /// Standard error of the complex line of this estimate.
    pub own: f64,
}

impl Departure {
    /// Returns true if the median difference exceeds twice the stated error, or if one line in ten
    /// differs by more than four times its stated error.
    #[must_use]
    pub fn is_beyond_errors(&self) -> bool {
        self.median > APART * self.stated || self.errors_of_a_tenth > TENTH_APART
    }
}

impl FrequencyResponse {
    /// Returns the difference from another estimate on the same lines, evaluated over the lines
    /// with a coherence above 0.9 in both estimates or, if there are fewer than eight such lines,
    /// in the other estimate. `None` without variances, or with fewer than eight lines.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] if the numbers of lines differ.
    pub fn departure_from(&self, other: &Self) -> Result<Option<Departure>, LabioError> {
        self.check_lengths()?;
        other.check_lengths()?;
        check_count(
            "lines of a response to compare",
            other.values.len(),
            self.values.len(),
        )?;
        let mut lines: Vec<(bool, [f64; 4])> = Vec::new();
        for ((one, two), coherences) in self
            .known_lines()
            .zip(other.known_lines())
            .zip(self.coherences().zip(other.coherences()))
        {
            let (Some((value, variance)), Some((reference, other))) = (one, two) else {
                continue;
            };
            if coherences.1.is_nan() || coherences.1 <= LEAST_COHERENCE {
                continue;
            }
            let scale = reference.norm();
            let (difference, error) = ((value - reference).norm(), (variance + other).sqrt());
            let line = [
                difference / scale,
                error / scale,
                variance.sqrt() / scale,
                difference / error,
            ];
            lines.push((coherences.0 > LEAST_COHERENCE, line));
        }
        // a window that cuts off most of the input leaves hardly any coherent lines
        let coherent = lines.iter().filter(|(coherent, _)| *coherent).count();
        let mut figures: [Vec<f64>; 4] = Default::default();
        for (_, line) in lines
            .iter()
            .filter(|(is_coherent, _)| *is_coherent || coherent < FEWEST_LINES)
        {
            for (figures, figure) in figures.iter_mut().zip(line) {
                figures.push(*figure);
            }
        }
        for figures in &mut figures {
            figures.sort_by(f64::total_cmp);
        }
        let [difference, stated, own, errors] = figures;
        if difference.len() < FEWEST_LINES {
            return Ok(None);
        }
        let median = |values: &[f64]| values.get(values.len() / 2).copied();
        let tenth = |values: &[f64]| values.get(values.len() - 1 - values.len() / 10).copied();
        let figures = median(&difference).zip(tenth(&difference));
        let of_errors = median(&stated).zip(median(&own)).zip(tenth(&errors));
        Ok(figures.zip(of_errors).map(
            |((median, of_a_tenth), ((stated, own), errors_of_a_tenth))| Departure {
                median,
                of_a_tenth,
                errors_of_a_tenth,
                stated,
                own,
            },
        ))
    }

    /// Returns the relative systematic error of every line caused by finite resolution. `halved` is
    /// the response from the same records cut into segments of half the length. NaN where one of
    /// the two responses has no value.
    ///
    /// The correlation functions from segments of duration T under a window w are the true ones
    /// multiplied by the lag window $`r_w(\tau) = \int w(t)w(t+\tau)\,dt`$, normalised to
    /// $`r_w(0) = 1`$. The impulse response is multiplied by the same window, so that $`H_1`$ is H
    /// smoothed over a line. To leading order the error is $`c H''/T^2`$, a third of the difference
    /// from the response of half the length,
    ///
    /// ```math
    /// \epsilon = \frac{1}{3\lvert H\rvert}\sqrt{\max\bigl(\lvert H_T - H_{T/2}\rvert^2 - \mathrm{Var}\,H_T,\,0\bigr)}
    /// ```
    ///
    /// on every second line; a line between two of these has the greater of their errors.
    ///
    /// # Validity
    ///
    /// The result is the magnitude of the error, without its sign, for resonances wider than a
    /// line. For narrower resonances the error is underestimated, but still large.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] unless `halved` has every second line of this response.
    pub fn resolution_error(&self, halved: &Self) -> Result<Vec<f64>, LabioError> {
        self.check_lengths()?;
        halved.check_lengths()?;
        check_count(
            "lines of the response from halved segments",
            halved.values.len(),
            self.values.len().div_ceil(2),
        )?;
        let none = || std::iter::repeat(&0.0);
        let even: Vec<f64> = self
            .values
            .iter()
            .zip(self.variance.iter().flatten().chain(none()))
            .step_by(2)
            .zip(&halved.values)
            .map(|((value, variance), halved)| {
                let square = (value - halved).norm_sqr();
                let excess = if square > *variance {
                    square - variance
                } else {
                    0.0 * square
                };
                excess.sqrt() / (3.0 * value.norm())
            })
            .collect();
        let at = |line: usize| even.get(line).copied();
        Ok((0..self.values.len())
            .map(|line| match (at(line / 2), at(line.div_ceil(2))) {
                (Some(one), Some(other)) if one.total_cmp(&other).is_lt() => other,
                (Some(one), _) => one,
                (None, _) => f64::NAN,
            })
            .collect())
    }

    /// Returns the coherence of each line; NaN for a response without coherence.
    fn coherences(&self) -> impl Iterator<Item = f64> + '_ {
        let known = self.coherence.iter().flatten().copied();
        known.chain(std::iter::repeat(f64::NAN))
    }

    /// Returns value and variance of each line; `None` for lines without information.
    fn known_lines(&self) -> impl Iterator<Item = Option<(num_complex::Complex64, f64)>> + '_ {
        let none = std::iter::repeat(&f64::NAN);
        let lines = self.values.iter().zip(&self.validity);
        let variances = self.variance.iter().flatten().chain(none);
        lines.zip(variances).map(|((value, validity), variance)| {
            (*validity == LineValidity::Valid).then_some((*value, *variance))
        })
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::{Channel, Quantity};

    /// Returns a response with these real values, a coherence of 0.95 and the variance `variance`.
    fn response(values: &[f64], variance: f64) -> FrequencyResponse {
        let channel = |quantity| Channel::new("x", quantity).unwrap();
        let lines = values.iter().map(|value| Complex64::from(*value)).collect();
        FrequencyResponse::of_lines(
            channel(Quantity::Force),
            channel(Quantity::Velocity),
            1.0,
            lines,
        )
        .unwrap()
        .with_coherence(vec![0.95; values.len()], 10)
        .unwrap()
        .with_variance(vec![variance; values.len()])
        .unwrap()
    }

    /// Twenty lines, 0, 0.1, ... 1.9 % above a reference of 2: the eleventh line is the median, and
    /// one line in ten exceeds the eighteenth. Variances of 9e-4 and 16e-4 give an error of 0.05.
    #[test]
    fn a_departure_is_counted_over_lines() {
        let lines: Vec<f64> = (0..20).map(|k| 2.0 + 2e-3 * f64::from(k)).collect();
        let (one, two) = (response(&lines, 9e-4), response(&[2.0; 20], 16e-4));
        let found = one.departure_from(&two).unwrap().unwrap();
        for (figure, expected) in [
            (found.median, 0.010),
            (found.of_a_tenth, 0.017),
            (found.errors_of_a_tenth, 0.034 / 0.05),
            (found.stated, 0.025),
            (found.own, 0.015),
        ] {
            assert!((figure - expected).abs() < 1e-14, "{found:?}");
        }
        assert!(!found.is_beyond_errors());
        // both numbers exactly at their limits, then each of them above its limit
        let at = |median: f64, errors_of_a_tenth: f64| Departure {
            median,
            errors_of_a_tenth,
            ..found
        };
        let limit = 2.0 * found.stated;
        assert!(!at(limit, 4.0).is_beyond_errors());
        assert!(at(limit * 1.01, 0.1).is_beyond_errors());
        assert!(at(0.0, 4.01).is_beyond_errors());
    }

    #[test]
    fn lines_of_low_coherence_or_without_a_value_are_not_compared() {
        let mut one = response(&[3.0; 12], 1.0);
        let mut two = response(&[2.0; 12], 1.0);
        one.validity[0] = LineValidity::NotDefined;
        if let Some(coherence) = &mut two.coherence {
            // lines 1 to 3 are not compared: a coherence of 0.9 is not above the limit
            (coherence[1], coherence[2], coherence[3]) = (0.9, 0.5, f64::NAN);
        }
        // low coherence on all lines, as under a window that cuts off part of the input
        one.coherence = Some(vec![0.2; 12]);
        let found = one.departure_from(&two).unwrap().unwrap();
        assert!((found.median - 0.5).abs() < 1e-15);
        // eight lines are compared; with one line fewer there is no comparison
        one.validity[11] = LineValidity::NotDefined;
        assert_eq!(one.departure_from(&two).unwrap(), None);
        one.variance = None;
        assert_eq!(one.departure_from(&two).unwrap(), None);
        assert!(matches!(
            two.departure_from(&response(&[2.0; 11], 1.0)),
            Err(LabioError::CountMismatch {
                found: 11,
                expected: 12,
                ..
            })
        ));
    }

    /// Expected errors: a third of √(0.36 - 0.11)/2; zero where 0.36 is less than the variance; a
    /// third of √0.81/3; on the lines between, the greater of the neighbours.
    #[test]
    fn the_error_of_resolution_is_a_third_of_the_difference_beyond_chance() {
        let mut full = response(&[2.0, 2.0, 2.0, 2.0, 3.0], 0.11);
        if let Some(variance) = &mut full.variance {
            (variance[2], variance[4]) = (0.37, 0.0);
        }
        let halved = response(&[2.6, 2.6, 3.9], 0.0);
        let found = full.resolution_error(&halved).unwrap();
        for (error, expected) in found.iter().zip([0.25 / 3.0, 0.25 / 3.0, 0.0, 0.1, 0.1]) {
            assert!((error - expected).abs() < 1e-15, "{found:?}");
        }
        assert!(full.resolution_error(&response(&[2.0; 4], 0.0)).is_err());
    }
}
