//! Coverage factors of normal errors with a known or an estimated variance.

use std::array;
use std::f64::consts::PI;
use std::sync::LazyLock;

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::error::{CmodError, check_positive, check_that};

/// Probability of an error within five standard errors
/// ([`STANDARD_ERRORS_WITHIN`](crate::validity::STANDARD_ERRORS_WITHIN)).
pub(crate) const PROBABILITY_WITHIN: f64 = 0.999_999_426_696_856;

const PROBABILITY: &str = "probability of coverage";

/// Returns the factor k for which |error| <= kσ with this `probability`: from Student's
/// distribution if σ was estimated with `degrees_of_freedom`, otherwise from the normal
/// distribution.
///
/// # Errors
/// [`CmodError::NonPhysical`] unless the probability is between 0 and 1, the degrees of freedom are
/// 0.01 or more, and the factor is a number.
pub fn coverage_factor(
    probability: f64,
    degrees_of_freedom: Option<f64>,
) -> Result<f64, CmodError> {
    let is_right = probability > 0.0 && probability < 1.0;
    let expected = "a value between 0 and 1";
    check_that(is_right, PROBABILITY, probability, expected)?;
    let range = FEWEST_OF_SERIES..MANY;
    if let Some(freedom) = degrees_of_freedom.filter(|freedom| range.contains(freedom))
        && let Some(series) = series_of(probability)
    {
        return Ok(series.at(freedom));
    }
    directly(probability, degrees_of_freedom)
}

/// Returns the factor from the quantile of the distribution.
fn directly(probability: f64, degrees_of_freedom: Option<f64>) -> Result<f64, CmodError> {
    // the lower tail is used, because the upper tail would lose digits for a small tail probability
    let tail = 0.5 * (1.0 - probability);
    let quantile = match degrees_of_freedom {
        None => Normal::standard().inverse_cdf(tail),
        Some(freedom) if freedom >= MANY && freedom.is_finite() => {
            quantile_of_many(Normal::standard().inverse_cdf(tail), freedom)
        }
        Some(freedom) => {
            let freedom = check_positive("degrees of freedom", freedom)?;
            let is_enough = freedom >= FEWEST;
            check_that(is_enough, "degrees of freedom", freedom, "at least 0.01")?;
            let student =
                StudentsT::new(0.0, 1.0, freedom).map_err(|_| CmodError::NonPhysical {
                    quantity: "degrees of freedom",
                    value: freedom,
                    expected: "a finite value above 0",
                })?;
            let quantile = student.inverse_cdf(tail);
            // with few degrees of freedom the inverse of the incomplete beta function is not always
            // accurate
            if (student.cdf(quantile) / tail - 1.0).abs() < 1e-6 {
                quantile
            } else {
                f64::NAN
            }
        }
    };
    let expected =
        "a value with a finite quantile: less close to 1, or with more degrees of freedom";
    check_that(quantile.is_finite(), PROBABILITY, probability, expected)?;
    Ok(-quantile)
}

/// Minimum degrees of freedom. With one degree of freedom Student's distribution has neither a mean
/// nor a variance; far below one, the inverse of the incomplete beta function has no correct
/// digits.
const FEWEST: f64 = 0.01;

/// Degrees of freedom above which Student's distribution is expanded about the normal distribution,
/// because the inverse of the incomplete beta function does not terminate for very many degrees of
/// freedom.
const MANY: f64 = 1e4;

/// Returns Student's quantile from the normal quantile `z` (Abramowitz & Stegun, 26.7.5). The first
/// omitted term is z⁹/(1000 ν⁴), below 1e-11 for every tail that a double can represent.
fn quantile_of_many(z: f64, freedom: f64) -> f64 {
    let w = z * z;
    let first = (w + 1.0) / 4.0;
    let second = ((5.0 * w + 16.0) * w + 3.0) / 96.0;
    let third = (((3.0 * w + 19.0) * w + 17.0) * w - 15.0) / 384.0;
    z * (1.0 + (first + (second + third / freedom) / freedom) / freedom)
}

/// Minimum degrees of freedom for which the factor has a series.
const FEWEST_OF_SERIES: f64 = 1.0;

/// Number of terms of a [`Series`].
const TERMS: usize = 48;

/// Chebyshev series of ln k in 1/ν, for one probability and ν from 1 to [`MANY`]. The degrees of
/// freedom may differ from line to line, and the computation of Student's quantile takes as long as
/// the rest of the computation of a line. Therefore the two probabilities that are needed on every
/// line have a series, with an accuracy of 1e-10 of k.
struct Series {
    coefficients: [f64; TERMS],
}

/// Probabilities with a series: the probability of the limits of a line, and the probability of a
/// stated interval.
static SERIES: [(f64, LazyLock<Option<Series>>); 2] = [
    (
        PROBABILITY_WITHIN,
        LazyLock::new(|| Series::of(PROBABILITY_WITHIN)),
    ),
    (0.95, LazyLock::new(|| Series::of(0.95))),
];

#[expect(clippy::float_cmp, reason = "constants of the program")]
fn series_of(probability: f64) -> Option<&'static Series> {
    let (_, series) = SERIES.iter().find(|(of, _)| *of == probability)?;
    series.as_ref()
}

impl Series {
    /// Returns the series through the factors at the [`TERMS`] zeros of the Chebyshev polynomial;
    /// `None` if one of the factors is not a number.
    fn of(probability: f64) -> Option<Self> {
        let angle = |node: usize| PI * (node as f64 + 0.5) / TERMS as f64;
        let mut logarithms = [0.0; TERMS];
        for (node, logarithm) in logarithms.iter_mut().enumerate() {
            let inverse = 0.5 * (1.0 + LEAST_INVERSE + (1.0 - LEAST_INVERSE) * angle(node).cos());
            *logarithm = directly(probability, Some(1.0 / inverse)).ok()?.ln();
        }
        let coefficients = array::from_fn(|term| {
            let weight = if term == 0 { 1.0 } else { 2.0 };
            let values = logarithms.iter().enumerate();
            let sum: f64 = values
                .map(|(node, logarithm)| logarithm * (term as f64 * angle(node)).cos())
                .sum();
            weight * sum / TERMS as f64
        });
        Some(Self { coefficients })
    }

    /// Returns k, by Clenshaw's recursion.
    fn at(&self, freedom: f64) -> f64 {
        let x = (2.0 / freedom - 1.0 - LEAST_INVERSE) / (1.0 - LEAST_INVERSE);
        let [first, rest @ ..] = &self.coefficients;
        let (mut b1, mut b2) = (0.0, 0.0);
        for coefficient in rest.iter().rev() {
            (b1, b2) = (2.0 * x * b1 - b2 + coefficient, b1);
        }
        (x * b1 - b2 + first).exp()
    }
}

const LEAST_INVERSE: f64 = 1.0 / MANY;

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with tables of Student's distribution and, for many degrees of freedom, with the
    /// normal distribution.
    #[test]
    fn coverage_factors_are_those_of_the_tables() {
        for (probability, freedom, quantile) in [
            (0.95, Some(2.0), 4.3027),
            (0.95, Some(18.0), 2.1009),
            (0.99, Some(18.0), 2.8784),
            (0.6826894921, None, 1.0),
            (0.9999994267, None, 5.0),
        ] {
            let factor = coverage_factor(probability, freedom).unwrap();
            assert!((factor / quantile - 1.0).abs() < 3e-5, "{factor}");
        }
        let many = coverage_factor(0.9999994267, Some(1e7)).unwrap();
        assert!((many - 5.0).abs() < 1e-4, "{many}");
        for (probability, freedom) in [
            (0.0, None),
            (1.0, None),
            (f64::NAN, None),
            (0.5, Some(0.0)),
            (0.5, Some(0.0099)),
            (1e-12, Some(1e-310)),
        ] {
            assert!(coverage_factor(probability, freedom).is_err());
        }
        // with one degree of freedom it is Cauchy's distribution
        for probability in [1e-3, 0.5, 0.99, 0.999_999] {
            let factor = coverage_factor(probability, Some(1.0)).unwrap();
            let exact = (0.5 * PI * probability).tan();
            assert!((factor / exact - 1.0).abs() < 1e-9, "{factor} {exact}");
        }
    }

    /// Checks that the factor increases with the probability, or does not exist.
    #[test]
    fn coverage_factors_rise_with_the_probability() {
        for exponent in -8..=20 {
            let freedom = Some(10_f64.powf(0.25 * f64::from(exponent)));
            let mut before = 0.0;
            for probability in [1e-16, 1e-12, 1e-6, 0.1, 0.5, 0.9, 1.0 - 1e-6, 1.0 - 1e-16] {
                if let Ok(factor) = coverage_factor(probability, freedom) {
                    assert!(factor >= before, "{probability} {freedom:?}: {factor}");
                    before = factor;
                }
            }
        }
    }

    /// Compares the series with the quantile at five hundred values of the degrees of freedom. With
    /// 48 terms the error of ln k is 4e-13, and the inverse of the incomplete beta function has
    /// errors of some 1e-11; with 24 terms the error would be 5e-9.
    #[test]
    fn the_series_is_the_quantile() {
        for probability in [PROBABILITY_WITHIN, 0.95] {
            let series = series_of(probability).unwrap();
            for step in 0..500 {
                let freedom = MANY.powf(f64::from(step) / 500.0);
                let exact = directly(probability, Some(freedom)).unwrap();
                let error = series.at(freedom) / exact - 1.0;
                assert!(error.abs() < 1e-10, "{probability} {freedom}: {error:e}");
            }
        }
        assert!(series_of(0.9).is_none());
    }
}
