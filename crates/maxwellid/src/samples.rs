//! Standard samples of the paper's classifier: responses of each law to the measured excitation,
//! and their projection.
//!
//! A standard sample is the response of one law, with parameters from its stated ranges, to the
//! excitation of the given tests (Ödeen 1993, paper D, section 2.2); other tests need new samples.
//! The pattern is that of eq. (9), y^k = |v_e(t_k) - v_r(t_k)|, divided by V0, or the signed
//! difference, which contains more information.
//!
//! # Unspecified choices
//! The paper specifies neither the ranges and their sampling, nor the instants t_k, nor a
//! projection. Here the ranges are those of the [`Candidate`]; they are sampled by a Halton
//! sequence, so that sixty samples are evenly distributed; all samples of the window are used; the
//! projection is that of Karhunen and Loève on the largest principal components, scaled to unit
//! variance.
//!
//! Theory: `docs/theory/adequacy.md#patterns-and-standard-samples`.

use faer::Mat;

use crate::adequacy::{check_count, check_finite_samples};
use crate::error::MaxwellidError;
use crate::model::DEFAULT_CELL;
use crate::model::response_of;
use crate::parallel::map_in_order;
use crate::selection::{Candidate, Ground};
use crate::test::RodTest;

/// Largest number of samples per law.
const MOST_SAMPLES: usize = 1_000_000;

/// Definition of the pattern of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Pattern {
    /// |v_e - v_r|/V0 (paper D, eq. 9).
    Absolute,
    /// (v_e - v_r)/V0.
    Signed,
}

/// Standard samples of several laws for the same tests.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StandardSamples {
    /// Names of the laws, the classes.
    pub classes: Vec<String>,
    /// Class of each sample.
    pub class_of: Vec<usize>,
    /// Parameters of each sample.
    pub parameters: Vec<Vec<f64>>,
    /// Pattern of each sample, all tests in sequence.
    pub patterns: Vec<Vec<f64>>,
    kind: Pattern,
}

impl StandardSamples {
    /// Computes `count` samples per law for the excitations of `tests`.
    ///
    /// With the feature `rayon` samples are computed in parallel, with identical results.
    ///
    /// # Errors
    /// [`MaxwellidError`] if there is no test or no arrival;
    /// [`MaxwellidError::TooFewStandardSamples`] for fewer than two samples per law, or if a law
    /// exists at fewer than two of them; [`MaxwellidError::Setting`] for more than a million per
    /// law.
    pub fn of(
        candidates: &[Candidate],
        tests: &[RodTest],
        count: usize,
        kind: Pattern,
    ) -> Result<Self, MaxwellidError> {
        if count > MOST_SAMPLES {
            return Err(MaxwellidError::Setting {
                setting: "number of standard samples per law",
                value: count as f64,
                expected: "at most a million",
            });
        }
        let ground = Ground::of(tests)?;
        let wanted: Vec<(usize, Vec<f64>)> = candidates
            .iter()
            .enumerate()
            .flat_map(|(class, candidate)| {
                let ranges = candidate.ranges(ground.modulus, ground.duration);
                (1..=count).map(move |index| (class, filled(&ranges, index)))
            })
            .collect();
        let respond = |(class, parameters): &(usize, Vec<f64>)| -> Option<Vec<f64>> {
            let mut pattern = Vec::new();
            for (test, times) in tests.iter().zip(&ground.times) {
                let rod = test.driven_rod(times, DEFAULT_CELL);
                let response = response_of(&candidates.get(*class)?.model, &rod, parameters)?;
                pattern.extend(differences(test, &response, kind));
            }
            Some(pattern)
        };
        let patterns = map_in_order(&wanted, respond);
        let mut samples = Self {
            classes: candidates.iter().map(|c| c.name().to_owned()).collect(),
            class_of: Vec::new(),
            parameters: Vec::new(),
            patterns: Vec::new(),
            kind,
        };
        for ((class, parameters), pattern) in wanted.into_iter().zip(patterns) {
            if let Some(pattern) = pattern {
                samples.class_of.push(class);
                samples.parameters.push(parameters);
                samples.patterns.push(pattern);
            }
        }
        for (class, name) in samples.classes.iter().enumerate() {
            let found = samples.class_of.iter().filter(|of| **of == class).count();
            if found < 2 {
                return Err(MaxwellidError::TooFewStandardSamples {
                    law: name.clone(),
                    found,
                });
            }
        }
        Ok(samples)
    }

    /// The pattern of the measured responses.
    #[must_use]
    pub fn measured(&self, tests: &[RodTest]) -> Vec<f64> {
        tests
            .iter()
            .flat_map(|test| differences(test, test.response(), self.kind))
            .collect()
    }

    /// Computes the projection on the `components` largest principal components of all samples
    /// together.
    ///
    /// # Errors
    /// [`MaxwellidError::TooManyComponents`] if there are fewer above rounding, or none is
    /// requested; [`MaxwellidError::UnequalSamples`] for patterns of different length.
    pub fn projection(&self, components: usize) -> Result<KarhunenLoeve, MaxwellidError> {
        KarhunenLoeve::of(&self.patterns, components)
    }
}

fn differences(test: &RodTest, response: &[f64], kind: Pattern) -> Vec<f64> {
    test.excitation_samples
        .iter()
        .zip(response)
        .map(|(e, r)| {
            let difference = (e - r) / test.impact_velocity;
            match kind {
                Pattern::Absolute => difference.abs(),
                Pattern::Signed => difference,
            }
        })
        .collect()
}

/// Bases of the Halton sequence: the first primes, one per parameter.
const PRIMES: [u32; 8] = [2, 3, 5, 7, 11, 13, 17, 19];

/// Parameters of the sample `index`, counted from 1.
fn filled(ranges: &[(f64, f64)], index: usize) -> Vec<f64> {
    ranges
        .iter()
        .zip(PRIMES.iter().cycle())
        .map(|((low, high), base)| low + (high - low) * radical_inverse(index, *base))
        .collect()
}

/// Radical inverse: the digits of `index` in this base, after the point and in reverse.
fn radical_inverse(mut index: usize, base: u32) -> f64 {
    let (base, fraction) = (base as usize, 1.0 / f64::from(base));
    let (mut value, mut weight) = (0.0, fraction);
    while index > 0 {
        value += weight * (index % base) as f64;
        index /= base;
        weight *= fraction;
    }
    value
}

/// Projection of patterns on principal components (Karhunen-Loève), each of unit variance over the
/// samples.
#[derive(Debug, Clone, PartialEq)]
pub struct KarhunenLoeve {
    mean: Vec<f64>,
    /// Components divided by their standard deviations.
    axes: Vec<Vec<f64>>,
    explained: f64,
}

impl KarhunenLoeve {
    #[allow(
        clippy::indexing_slicing,
        reason = "all patterns and their mean have `length` entries, which is checked first"
    )]
    fn of(patterns: &[Vec<f64>], components: usize) -> Result<Self, MaxwellidError> {
        let count = patterns.len();
        let length = patterns.first().map_or(0, Vec::len);
        for pattern in patterns {
            check_count("pattern", pattern.len(), length)?;
        }
        check_finite_samples(patterns)?;
        let mean: Vec<f64> = (0..length)
            .map(|k| patterns.iter().map(|p| p[k]).sum::<f64>() / count as f64)
            .collect();
        let centred = Mat::from_fn(count, length, |i, k| patterns[i][k] - mean[k]);
        let svd = centred
            .thin_svd()
            .map_err(|_| MaxwellidError::Decomposition { iteration: 0 })?;
        let values = svd.S().column_vector();
        let largest = if values.nrows() > 0 { values[0] } else { 0.0 };
        let above_rounding = (0..values.nrows())
            .take_while(|k| values[*k] > 1e-10 * largest)
            .count();
        if components == 0 || components > above_rounding {
            return Err(MaxwellidError::TooManyComponents {
                requested: components,
                found: above_rounding,
            });
        }
        let axes = svd.V();
        let deviation = |k: usize| values[k] / (count as f64).sqrt();
        let power =
            |range: std::ops::Range<usize>| -> f64 { range.map(|k| values[k] * values[k]).sum() };
        Ok(Self {
            axes: (0..components)
                .map(|k| (0..length).map(|i| axes[(i, k)] / deviation(k)).collect())
                .collect(),
            explained: power(0..components) / power(0..values.nrows()),
            mean,
        })
    }

    /// Coordinates of a pattern.
    ///
    /// # Errors
    ///
    /// [`MaxwellidError::WrongLength`] for a pattern of other tests than those of the samples.
    pub fn project(&self, pattern: &[f64]) -> Result<Vec<f64>, MaxwellidError> {
        check_count("pattern", pattern.len(), self.mean.len())?;
        Ok(self
            .axes
            .iter()
            .map(|axis| {
                axis.iter()
                    .zip(pattern.iter().zip(&self.mean))
                    .map(|(a, (p, m))| a * (p - m))
                    .sum()
            })
            .collect())
    }

    /// Fraction of the variance of the samples explained by the components.
    #[must_use]
    pub fn explained(&self) -> f64 {
        self.explained
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixty_points_of_the_sequence_fill_the_range_evenly() {
        for base in [2, 3, 5] {
            let mut values: Vec<f64> = (1..=60).map(|k| radical_inverse(k, base)).collect();
            values.sort_by(f64::total_cmp);
            // the largest power of the base below 60 is at least 25, and each of as many equal
            // cells contains a point
            let gap = values
                .windows(2)
                .fold(0.0_f64, |top, w| top.max(w[1] - w[0]));
            assert!(gap < 0.05, "{base} {gap}");
        }
        // 6 = 110 in base 2: 0.011; 5 = 12 in base 3: 0.21
        assert!((radical_inverse(6, 2) - 0.375).abs() < 1e-15);
        assert!((radical_inverse(5, 3) - 7.0 / 9.0).abs() < 1e-15);
    }

    /// Points in a plane of a three-dimensional space: two components contain everything, with unit
    /// variance and no correlation.
    #[test]
    fn the_projection_is_white_and_finds_the_dimension() {
        let patterns: Vec<Vec<f64>> = (1..=50)
            .map(|k| {
                let (a, b) = (radical_inverse(k, 2), 0.3 * radical_inverse(k, 3));
                vec![a + b, a - b, 2.0 * a + 1.0]
            })
            .collect();
        let projection = KarhunenLoeve::of(&patterns, 2).unwrap();
        assert!((projection.explained() - 1.0).abs() < 1e-12);
        let projected: Vec<Vec<f64>> = patterns
            .iter()
            .map(|p| projection.project(p).unwrap())
            .collect();
        for i in 0..2 {
            for j in 0..2 {
                let product: f64 = projected.iter().map(|z| z[i] * z[j]).sum::<f64>() / 50.0;
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 1e-10, "{i} {j} {product}");
            }
        }
        let mut unequal = patterns.clone();
        unequal[7].pop();
        let error = KarhunenLoeve::of(&unequal, 2).unwrap_err();
        assert_eq!(error.to_string(), "the pattern has 2 numbers, expected 3");
        let error = KarhunenLoeve::of(&patterns, 3).unwrap_err();
        assert_eq!(
            error.to_string(),
            "3 principal components were requested, the samples have 2"
        );
    }
}
