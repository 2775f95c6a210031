//! Trends removed from the samples of a hit or segment before windowing.

/// A trend that is removed from every hit or segment, channel by channel, before the window is
/// applied.
///
/// Nothing is removed by default. From a hit, only the level before the impact may be removed
/// ([`Detrend::Rest`]): the mean of a force pulse belongs to its impulse, and the mean and straight
/// line of a ringing body belong to its motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Detrend {
    /// Nothing is removed.
    #[default]
    None,
    /// The mean is removed: for noise records with an offset.
    Mean,
    /// The least-squares straight line is removed: for noise records with drift.
    Linear,
    /// The mean of the first samples is removed: for hits with an offset that are at rest in those
    /// samples ([`samples_at_rest`](crate::hits::samples_at_rest)).
    Rest {
        /// Number of samples at rest.
        n_samples: usize,
    },
}

impl Detrend {
    pub(super) fn apply(self, samples: &mut [f64]) {
        match self {
            Self::None => {}
            Self::Mean => Self::Rest {
                n_samples: samples.len(),
            }
            .apply(samples),
            Self::Rest { n_samples } => {
                let rest = samples.get(..n_samples).unwrap_or(samples);
                let mean = sum(rest, |_, x| x) / rest.len().max(1) as f64;
                for sample in samples {
                    *sample -= mean;
                }
            }
            Self::Linear => {
                let n = samples.len() as f64;
                let middle = (n - 1.0) / 2.0;
                let mean = sum(samples, |_, x| x) / n;
                // sum of squared distances from the middle
                let squares = n * (n * n - 1.0) / 12.0;
                let slope = sum(samples, |i, x| (i as f64 - middle) * x) / squares;
                for (i, sample) in samples.iter_mut().enumerate() {
                    *sample -= mean + slope * (i as f64 - middle);
                }
            }
        }
    }
}

/// Returns the sum of `term` over all samples, computed in eight lanes: faster than one lane, and
/// the bound of the rounding error is about an eighth.
fn sum(samples: &[f64], term: impl Fn(usize, f64) -> f64) -> f64 {
    let mut lanes = [0.0; 8];
    let mut start = 0;
    for chunk in samples.chunks(lanes.len()) {
        for (offset, (lane, &sample)) in lanes.iter_mut().zip(chunk).enumerate() {
            *lane += term(start + offset, sample);
        }
        start += chunk.len();
    }
    lanes.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Trend = fn(f64) -> f64;

    #[test]
    fn trends_are_removed_and_what_is_orthogonal_to_them_stays() {
        // a parabola about the middle is orthogonal to a straight line; its mean over -5..5 is 10
        let parabola = |i: i32| f64::from((i - 5) * (i - 5));
        let sampled = |trend: Trend| -> Vec<f64> {
            (0..11)
                .map(|i| parabola(i) - 10.0 + trend(f64::from(i)))
                .collect()
        };
        let cases: [(Detrend, Trend); 3] = [
            (Detrend::None, |_| 0.0),
            (Detrend::Mean, |_| 7.0),
            (Detrend::Linear, |i| 7.0 - 0.75 * i),
        ];
        for (detrend, trend) in cases {
            let mut samples = sampled(trend);
            detrend.apply(&mut samples);
            for (i, sample) in (0..).zip(&samples) {
                // a few rounding errors of numbers of order ten
                assert!((sample - (parabola(i) - 10.0)).abs() < 1e-13, "{detrend:?}");
            }
        }
    }

    #[test]
    fn s8_the_level_of_the_first_samples_is_removed() {
        let mut samples = [3.0, 1.0, 2.0, 9.0, 2.0];
        Detrend::Rest { n_samples: 3 }.apply(&mut samples);
        for (found, expected) in samples.iter().zip([1.0, -1.0, 0.0, 7.0, 0.0]) {
            assert!((found - expected).abs() < 1e-14);
        }
    }
}
