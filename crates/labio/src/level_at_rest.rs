//! Level and noise of a channel at rest, before the impact.

/// Level and noise of a channel at rest, from the n samples x before the impact:
///
/// ```text
/// level = Σx/n ,    noise² = Σ(x - level)²/n ,    level_error² = noise²/n .
/// ```
///
/// All numbers are in the unit of the samples. The error of the level assumes white noise. The
/// number of samples at rest is found by [`samples_at_rest`](crate::hits::samples_at_rest).
///
/// ```
/// use labio::LevelAtRest;
///
/// let samples = [3.5, 2.5, 3.5, 2.5, 90.0, 70.0];
/// let rest = LevelAtRest::of(samples.into_iter().take(4)).expect("four samples");
/// assert_eq!((rest.level, rest.noise, rest.level_error), (3.0, 0.5, 0.25));
/// assert!(LevelAtRest::of(samples.into_iter().take(0)).is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LevelAtRest {
    /// Mean of the samples.
    pub level: f64,
    /// Standard deviation of one sample.
    pub noise: f64,
    /// Standard error of the level.
    pub level_error: f64,
}

impl LevelAtRest {
    /// Returns level and noise of the `samples` at rest; `None` if there are none.
    #[must_use]
    pub fn of(samples: impl Iterator<Item = f64> + Clone) -> Option<Self> {
        let count = samples.clone().count() as f64;
        let level = samples.clone().sum::<f64>() / count;
        let square = samples.map(|x| (x - level).powi(2)).sum::<f64>() / count;
        (count > 0.0).then_some(Self {
            level,
            noise: square.sqrt(),
            level_error: (square / count).sqrt(),
        })
    }
}
