//! Class-conditional conformal p-values: an adequacy that may reject all laws.
//!
//! A nonconformity A_i(y) measures the distance of a pattern from the standard samples of law i:
//! here the distance to the nearest sample. Its rank among the nonconformities of the samples
//! themselves, each against the others,
//!
//! ```text
//! p_i(y) = (#{j : A_ij >= A_i(y)} + 1)/(N_i + 1) ,
//! ```
//!
//! is a p-value with only one assumption about distributions: under law i, y is exchangeable with
//! the samples of that law. Then p_i <= ε has a probability of at most ε. If all p_i are small,
//! none of the laws is adequate; if several are large, the data do not decide. The p_i do not sum
//! to one, and are not probabilities of laws; those come from [`crate::selection`].
//!
//! Exchangeable means: drawn from the same ranges, with the same noise. With samples that contain
//! no noise, every noisy measurement is rejected.
//!
//! Theory: `docs/theory/adequacy.md#conformal-p-values`.

use crate::adequacy::{check_finite_samples, n_classes};
use crate::error::MaxwellidError;

/// Computes the p-values of a pattern for the laws of `class_of`, from projected or plain patterns
/// of the standard samples.
///
/// ```
/// use maxwellid::conformal::p_values;
///
/// let samples = [[0.0], [0.1], [0.2], [0.3], [5.0], [5.2], [5.4], [5.6]].map(|z| z.to_vec());
/// let classes = [0, 0, 0, 0, 1, 1, 1, 1];
/// let near_the_second = p_values(&samples, &classes, &[5.3])?;
/// assert_eq!(near_the_second, [0.2, 1.0]);
/// assert_eq!(p_values(&samples, &classes, &[2.0])?, [0.2, 0.2]); // none of them
/// # Ok::<(), maxwellid::MaxwellidError>(())
/// ```
///
/// # Errors
/// [`MaxwellidError::UnequalSamples`] unless samples and classes have equal numbers, and samples
/// and pattern equal lengths; [`MaxwellidError::TooFewStandardSamples`] for a class with fewer than
/// two.
pub fn p_values(
    samples: &[Vec<f64>],
    class_of: &[usize],
    pattern: &[f64],
) -> Result<Vec<f64>, MaxwellidError> {
    let unequal = samples.iter().position(|s| s.len() != pattern.len());
    if samples.len() != class_of.len() || unequal.is_some() {
        return Err(MaxwellidError::UnequalSamples {
            features: samples.len(),
            classes: class_of.len(),
            unequal,
        });
    }
    check_finite_samples(samples)?;
    check_finite_samples(std::slice::from_ref(&pattern.to_vec()))?;
    let classes = n_classes(class_of)?;
    (0..classes)
        .map(|class| {
            let own: Vec<&Vec<f64>> = samples
                .iter()
                .zip(class_of)
                .filter(|(_, of)| **of == class)
                .map(|(sample, _)| sample)
                .collect();
            if own.len() < 2 {
                return Err(MaxwellidError::TooFewStandardSamples {
                    law: format!("class {class}"),
                    found: own.len(),
                });
            }
            let nearest = |of: &[f64], without: Option<usize>| {
                own.iter()
                    .enumerate()
                    .filter(|(index, _)| Some(*index) != without)
                    .map(|(_, sample)| square_of_distance(sample, of))
                    .fold(f64::INFINITY, f64::min)
            };
            let found = nearest(pattern, None);
            let as_far = own
                .iter()
                .enumerate()
                .filter(|(index, sample)| nearest(sample, Some(*index)) >= found)
                .count();
            Ok((as_far + 1) as f64 / (own.len() + 1) as f64)
        })
        .collect()
}

fn square_of_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::noise::Noise;

    #[test]
    fn a_class_beyond_the_number_of_samples_is_refused() {
        let error = p_values(&[vec![0.0]], &[usize::MAX], &[0.0]).unwrap_err();
        assert!(
            error
                .to_string()
                .ends_with("expected a number below the number of samples"),
            "{error}"
        );
    }

    /// Checks that a fraction ε = 0.1 of the p-values of patterns of the law itself is at most ε,
    /// for samples that are not normally distributed.
    #[test]
    fn the_p_value_of_the_true_class_is_valid() {
        let mut random = Noise::seeded(3);
        let mut draw =
            |shift: f64| -> Vec<f64> { (0..3).map(|_| shift + random.normal().exp()).collect() };
        let (mut below, mut rejected) = (0, 0);
        let cases = 1000;
        for _ in 0..cases {
            let samples: Vec<Vec<f64>> = (0..40).map(|_| draw(0.0)).collect();
            let classes = vec![0; 40];
            if p_values(&samples, &classes, &draw(0.0)).unwrap()[0] <= 0.1 {
                below += 1;
            }
            if p_values(&samples, &classes, &draw(-6.0)).unwrap()[0] <= 0.1 {
                rejected += 1;
            }
        }
        // tolerance: about 3.3 standard deviations of the count, of 10 each, below and above 100 of
        // 1000; a pattern has 40 neighbours and a sample 39, which changes the fraction by up to
        // 1/40
        assert!((70..=135).contains(&below), "{below}");
        assert_eq!(rejected, cases);
    }
}
