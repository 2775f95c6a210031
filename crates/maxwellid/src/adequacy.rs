//! The paper's measures of adequacy: a trained classifier, of historical interest and for
//! comparison.
//!
//! # Method
//! P_i(y) estimates whether pattern y belongs to law i: P_i = w_iᵀ φ(y), with 0 and 1 as targets
//! r_i on the standard samples. The weights follow by stochastic approximation (Robbins and Monro)
//! with a gain α_k = a₀/(k₀ + k) (Ödeen 1993, paper D, section 2.2):
//!
//! ```text
//! least mean square      w ← w + α_k φ (r - wᵀφ)
//! increment correction   w ← w + α_k φ sgn(r - wᵀφ)
//! ```
//!
//! The first form tends to the least-squares approximation of the probability of the class, which
//! [`Weights::least_squares`] computes directly for comparison; the second form tends to the
//! conditional median of a variable that is 0 or 1, which is not a probability.
//!
//! # Unspecified choices
//! The paper does not state the basis, gain, order and number of passes, nor the treatment of
//! values outside 0 to 1. Here they are settings; values outside 0 to 1 are returned unchanged.
//! With a constant in the basis and one recursion for all classes, the P_i of the first form sum to
//! one in the limit. The values of Table 3 sum to 1.04 to 1.76, so they are not this limit, and no
//! setting here is tuned to them.
//! # Limitations
//! The measures are not used for decisions: with sixty samples per law such a classifier is right
//! in about half of the cases, even without noise. Decisions come from [`crate::selection`].
//!
//! Theory: `docs/theory/adequacy.md#stochastic-approximation`.

use faer::Mat;
use faer::linalg::solvers::Solve;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::error::MaxwellidError;
use crate::vectors::dot;

/// Functions φ of the projected pattern z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Basis {
    /// 1 and z.
    Linear,
    /// 1, z, and the products of all pairs of components.
    Quadratic,
}

impl Basis {
    /// φ(z).
    #[must_use]
    pub fn of(self, projected: &[f64]) -> Vec<f64> {
        let mut features = vec![1.0];
        features.extend_from_slice(projected);
        if self == Self::Quadratic {
            for (i, a) in projected.iter().enumerate() {
                features.extend(projected.iter().skip(i).map(|b| a * b));
            }
        }
        features
    }
}

/// Form of the correction for an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Correction {
    /// Proportional to the error.
    LeastMeanSquare,
    /// Proportional to the sign of the error.
    Increment,
}

/// Settings of the stochastic approximation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobbinsMonro {
    /// Form of the recursion.
    pub correction: Correction,
    /// a₀ of the gain.
    pub gain: f64,
    /// k₀ of the gain; `None` for the mean of |φ|², for which the first correction does not
    /// overshoot.
    pub delay: Option<f64>,
    /// Number of passes over the samples, each in a different order.
    pub passes: usize,
    /// True to return the mean of the weights over the second half of the steps (Polyak and
    /// Ruppert) instead of the last weights.
    pub averages: bool,
    /// Seed of the random orders of the samples.
    pub seed: u64,
}

impl Default for RobbinsMonro {
    /// Returns the settings: least mean square, a₀ = 1, three hundred passes, averaged weights.
    fn default() -> Self {
        Self {
            correction: Correction::LeastMeanSquare,
            gain: 1.0,
            delay: None,
            passes: 300,
            averages: true,
            seed: 1993,
        }
    }
}

/// Weights of all classes.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    of_class: Vec<Vec<f64>>,
}

impl Weights {
    /// Computes weights by stochastic approximation from `features` φ and the class of each sample.
    ///
    /// # Errors
    /// [`MaxwellidError::UnequalSamples`] unless features and classes have equal numbers and all
    /// features have one length; [`MaxwellidError::Setting`] for a gain that is not positive, a
    /// delay that is negative, or a class that is not below the number of samples.
    #[allow(
        clippy::indexing_slicing,
        reason = "`order` is a permutation of the samples, and `check` has found an entry for each in `features` and `class_of`"
    )]
    pub fn robbins_monro(
        features: &[Vec<f64>],
        class_of: &[usize],
        settings: &RobbinsMonro,
    ) -> Result<Self, MaxwellidError> {
        let (length, classes) = check(features, class_of)?;
        let mean_square = features
            .iter()
            .map(|phi| phi.iter().map(|f| f * f).sum::<f64>())
            .sum::<f64>()
            / features.len() as f64;
        let delay = settings.delay.unwrap_or(mean_square);
        for (setting, value, is_good) in [
            (
                "gain of the stochastic approximation",
                settings.gain,
                settings.gain > 0.0,
            ),
            ("delay of the gain", delay, delay >= 0.0),
        ] {
            if !(value.is_finite() && is_good) {
                return Err(MaxwellidError::Setting {
                    setting,
                    value,
                    expected: "a finite value above 0",
                });
            }
        }
        let Some(steps) = settings
            .passes
            .checked_mul(features.len())
            .filter(|n| *n > 0)
        else {
            return Err(MaxwellidError::Setting {
                setting: "number of passes",
                value: settings.passes as f64,
                expected: "at least 1, and a number of steps that can be counted",
            });
        };
        let mut order: Vec<usize> = (0..features.len()).collect();
        let mut random = ChaCha8Rng::seed_from_u64(settings.seed);
        let mut weights = vec![vec![0.0; length]; classes];
        let mut mean = vec![vec![0.0; length]; classes];
        let (mut step, mut averaged) = (0_usize, 0_usize);
        for _ in 0..settings.passes {
            order.shuffle(&mut random);
            for &sample in &order {
                step += 1;
                let gain = settings.gain / (delay + step as f64);
                let phi = &features[sample];
                for (class, own) in weights.iter_mut().enumerate() {
                    let target = if class_of[sample] == class { 1.0 } else { 0.0 };
                    let error = target - dot(own, phi);
                    let answer = match settings.correction {
                        Correction::LeastMeanSquare => error,
                        Correction::Increment => error.signum(),
                    };
                    for (weight, feature) in own.iter_mut().zip(phi) {
                        *weight += gain * answer * feature;
                    }
                }
                if 2 * step > steps {
                    averaged += 1;
                    for (mean, own) in mean.iter_mut().zip(&weights) {
                        for (mean, own) in mean.iter_mut().zip(own) {
                            *mean += (own - *mean) / averaged as f64;
                        }
                    }
                }
            }
        }
        Ok(Self {
            of_class: if settings.averages { mean } else { weights },
        })
    }

    /// Computes the limit of the least-mean-square form, W = (ΦᵀΦ + λ N I)⁻¹ Φᵀ R.
    ///
    /// # Errors
    /// [`MaxwellidError::UnequalSamples`]; [`MaxwellidError::Setting`] for a negative `ridge` λ, if
    /// ΦᵀΦ is singular without one, or for a class that is not below the number of samples.
    #[allow(
        clippy::indexing_slicing,
        reason = "`check` finds a class and `length` features for each sample"
    )]
    pub fn least_squares(
        features: &[Vec<f64>],
        class_of: &[usize],
        ridge: f64,
    ) -> Result<Self, MaxwellidError> {
        let (length, classes) = check(features, class_of)?;
        let refused = MaxwellidError::Setting {
            setting: "ridge of the least squares",
            value: ridge,
            expected: "a finite value not below 0, above 0 if the features are dependent",
        };
        if !(ridge.is_finite() && ridge >= 0.0) {
            return Err(refused);
        }
        let count = features.len();
        let phi = Mat::from_fn(count, length, |i, j| features[i][j]);
        let targets = Mat::from_fn(
            count,
            classes,
            |i, c| {
                if class_of[i] == c { 1.0 } else { 0.0 }
            },
        );
        let mut normal = phi.transpose() * &phi;
        for j in 0..length {
            normal[(j, j)] += ridge * count as f64;
        }
        let Ok(cholesky) = faer::linalg::solvers::Llt::new(normal.as_ref(), faer::Side::Lower)
        else {
            return Err(refused);
        };
        let weights = cholesky.solve(&(phi.transpose() * &targets));
        Ok(Self {
            of_class: (0..classes)
                .map(|c| (0..length).map(|j| weights[(j, c)]).collect())
                .collect(),
        })
    }

    /// Returns P_i for the features of a pattern; values outside 0 to 1 are possible.
    ///
    /// # Errors
    ///
    /// [`MaxwellidError::WrongLength`] if the number of features is not that of the samples.
    pub fn adequacies(&self, features: &[f64]) -> Result<Vec<f64>, MaxwellidError> {
        let expected = self.of_class.first().map_or(0, Vec::len);
        check_count("set of features", features.len(), expected)?;
        Ok(self.of_class.iter().map(|own| dot(own, features)).collect())
    }
}

/// Checks the samples; returns the length of the features and the number of classes.
fn check(features: &[Vec<f64>], class_of: &[usize]) -> Result<(usize, usize), MaxwellidError> {
    let length = features.first().map_or(0, Vec::len);
    let unequal = features.iter().position(|phi| phi.len() != length);
    if features.len() != class_of.len() || length == 0 || unequal.is_some() {
        return Err(MaxwellidError::UnequalSamples {
            features: features.len(),
            classes: class_of.len(),
            unequal,
        });
    }
    check_finite_samples(features)?;
    Ok((length, n_classes(class_of)?))
}

/// Number of classes: the largest class number plus 1, at most the number of samples.
pub(crate) fn n_classes(class_of: &[usize]) -> Result<usize, MaxwellidError> {
    match class_of.iter().max() {
        Some(&top) if top >= class_of.len() => Err(MaxwellidError::Setting {
            setting: "class of a standard sample",
            value: top as f64,
            expected: "a number below the number of samples",
        }),
        top => Ok(top.map_or(0, |top| top + 1)),
    }
}

/// Accepts samples whose values are all finite.
pub(crate) fn check_finite_samples(samples: &[Vec<f64>]) -> Result<(), MaxwellidError> {
    match samples.iter().flatten().find(|value| !value.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(MaxwellidError::Setting {
            setting: "feature of a standard sample",
            value,
            expected: "a finite value",
        }),
    }
}

/// Accepts the expected number of values.
pub(crate) fn check_count(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), MaxwellidError> {
    if found == expected {
        Ok(())
    } else {
        Err(MaxwellidError::WrongLength {
            what,
            found,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::noise::Noise;

    /// Three classes of points in a plane, overlapping.
    fn cloud() -> (Vec<Vec<f64>>, Vec<usize>) {
        let mut noise = Noise::seeded(7);
        let mut normal = || noise.normal();
        let centres = [(0.0, 0.0), (1.5, 0.0), (0.0, 1.5)];
        let points: Vec<(usize, [f64; 2])> = (0..180)
            .map(|k| {
                let (x, y) = centres[k % 3];
                (k % 3, [x + normal(), y + normal()])
            })
            .collect();
        let features = points.iter().map(|(_, z)| Basis::Linear.of(z)).collect();
        (features, points.iter().map(|(class, _)| *class).collect())
    }

    #[test]
    fn the_recursion_tends_to_the_least_squares() {
        let (features, classes) = cloud();
        let limit = Weights::least_squares(&features, &classes, 0.0).unwrap();
        let distance = |passes: usize| {
            let settings = RobbinsMonro {
                passes,
                ..RobbinsMonro::default()
            };
            let found = Weights::robbins_monro(&features, &classes, &settings).unwrap();
            let pairs = found
                .of_class
                .iter()
                .flatten()
                .zip(limit.of_class.iter().flatten());
            pairs.fold(0.0_f64, |top, (a, b)| top.max((a - b).abs()))
        };
        let distances = [distance(3), distance(30), distance(300)];
        // with a new order of the samples in every pass, the distance decreases as 1/passes at best
        // and as 1/√passes at worst; 0.32 is 1/√10, for ten times the passes
        assert!(distances[1] < 0.5 * distances[0], "{distances:?}");
        assert!(distances[2] < 0.32 * distances[1], "{distances:?}");
        assert!(distances[2] < 2e-3, "{distances:?}");
    }

    /// The increment correction minimises the mean of |r - wφ|: this mean is smaller for its
    /// weights than for the least-squares weights.
    #[test]
    fn increments_tend_to_the_median() {
        let (features, classes) = cloud();
        let settings = RobbinsMonro {
            correction: Correction::Increment,
            ..RobbinsMonro::default()
        };
        let found = Weights::robbins_monro(&features, &classes, &settings).unwrap();
        let limit = Weights::least_squares(&features, &classes, 0.0).unwrap();
        let mean_error = |weights: &Weights| -> f64 {
            let cases = features.iter().zip(&classes);
            cases
                .flat_map(|(phi, class)| {
                    let adequacies = weights.adequacies(phi).unwrap().into_iter().enumerate();
                    adequacies.map(|(i, p)| (f64::from(u8::from(i == *class)) - p).abs())
                })
                .sum::<f64>()
                / features.len() as f64
        };
        let (of_increments, of_squares) = (mean_error(&found), mean_error(&limit));
        assert!(of_increments < of_squares, "{of_increments} {of_squares}");
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let features = vec![vec![1.0, 2.0], vec![1.0]];
        assert!(Weights::least_squares(&features, &[0, 1], 0.0).is_err());
        assert!(Weights::least_squares(&features[..1], &[0, 1], 0.0).is_err());
        // a class number that is too large is refused before weights are allocated for so many
        // classes
        for class in [1 << 16, usize::MAX] {
            let error = Weights::least_squares(&features[..1], &[class], 1e-3).unwrap_err();
            assert!(
                error
                    .to_string()
                    .starts_with("class of a standard sample is "),
                "{error}"
            );
        }
        // one sample cannot determine two weights
        assert!(Weights::least_squares(&features[..1], &[0], 0.0).is_err());
        assert!(Weights::least_squares(&features[..1], &[0], 1e-3).is_ok());
        let settings = RobbinsMonro {
            gain: 0.0,
            ..RobbinsMonro::default()
        };
        assert!(Weights::robbins_monro(&features[..1], &[0], &settings).is_err());
    }
}
