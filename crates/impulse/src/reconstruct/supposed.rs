//! The force assumed for undetermined components, from calibration blows.

use faer::Mat;

use super::mean_blow::MeanBlow;
use super::support::Support;

/// Number of positions tried per sample.
const PLACES: i32 = 8;

/// Information of the responses on a component of the force.
pub(super) struct Told {
    pub(super) index: usize,
    pub(super) value: f64,
    /// Inverse of the variance of the value.
    pub(super) information: f64,
}

/// Mean blow at the position and of the size that best explain the values `told`, for components of value $`y`$ and information
/// $`\kappa`$: the least $`\sum (y - a\,m)^2/(1 + 1/\kappa)`$ within a sample of its best correlation with the determined force.
/// `components` transforms components to samples, `dual` samples to components. `None` if no blow explains anything.
#[allow(
    clippy::indexing_slicing,
    reason = "components and mean have an element for each sample of the support"
)]
pub(super) fn mean(
    mean: &MeanBlow,
    support: Support,
    (components, dual): (&Mat<f64>, &Mat<f64>),
    told: &[Told],
) -> Option<Vec<f64>> {
    let weights: Vec<f64> = told
        .iter()
        .map(|told| told.information / (1.0 + told.information))
        .collect();
    let force: Vec<f64> = (0..support.length)
        .map(|i| {
            let terms = told.iter().zip(&weights);
            terms
                .map(|(told, w)| w * told.value * components[(i, told.index)])
                .sum()
        })
        .collect();
    let placed = |place: f64| {
        let later = support.first as f64 + place - mean.peak();
        mean.samples(support.first, support.length, later)
    };
    let largest = |places: std::ops::Range<i32>, about: f64, of: &dyn Fn(&[f64]) -> f64| {
        places
            .map(|n| about + f64::from(n) / f64::from(PLACES))
            .map(|place| (of(&placed(place)), place))
            .max_by(|(a, _), (b, _)| a.total_cmp(b))
            .map(|(_, place)| place)
    };
    let last = i32::try_from(support.length).unwrap_or(i32::MAX / PLACES) * PLACES;
    let about = largest(0..last, 0.0, &|samples| {
        let pairs = samples.iter().zip(&force);
        pairs.map(|(m, f)| m * f).sum()
    })?;
    let fit = |samples: &[f64]| -> (f64, f64) {
        let (mut along, mut square) = (0.0, 0.0);
        for (told, w) in told.iter().zip(&weights) {
            let terms = samples.iter().enumerate();
            let m: f64 = terms.map(|(i, m)| dual[(i, told.index)] * m).sum();
            along += w * m * told.value;
            square += w * m * m;
        }
        (along / square, along * along.max(0.0) / square)
    };
    let place = largest(-PLACES..PLACES + 1, about, &|samples| fit(samples).1)?;
    let samples = placed(place);
    let (size, _) = fit(&samples);
    (size.is_finite() && size > 0.0).then(|| samples.iter().map(|m| size * m).collect())
}
