//! Quantisation step of a converter, found from its samples.

use ndarray::ArrayView1;

/// Share of samples at rest that equal the previous sample, above which the noise counts as too
/// small to change the output of the converter. Gaussian noise with a standard deviation of 0.26
/// steps, centred between two thresholds of the converter, gives this share.
const STILL: f64 = 0.9;

/// Smallest step of a converter relative to the largest excursion: that of 24 bits if the excursion
/// uses a quarter of the range. Numbers with a smaller step were computed.
const FINEST: f64 = 2e-7;
/// Largest deviation of the outputs of a converter from multiples of its step, in steps: an
/// allowance for rounded calibration factors, a relative 2e-10 over 2²² steps.
const ROUNDING: f64 = 1e-3;

/// Returns the smallest nonzero difference between consecutive samples, in their unit: the step of
/// the recorder's numbers, or less; 0 if all samples are equal.
#[must_use]
pub fn smallest_step(samples: &[f64]) -> f64 {
    let mut smallest = f64::INFINITY;
    for (a, b) in samples.iter().zip(samples.iter().skip(1)) {
        let step = (b - a).abs();
        if step > 0.0 && step < smallest {
            smallest = step;
        }
    }
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// Returns true if two outputs of a converter are the same finite number.
pub(crate) fn same(a: f64, b: f64) -> bool {
    a - b == 0.0
}

/// Returns the step of a converter whose noise is too small to change its output at rest, in the
/// first `n_rest` of the `samples`; `None` if the noise changes it, or if the samples are not
/// multiples of a step.
///
/// The rounding errors of a converter with so little noise are not noise: they follow the signal
/// and are the same in every hit.
pub(crate) fn step_above_noise(samples: ArrayView1<'_, f64>, n_rest: usize) -> Option<f64> {
    let rest = samples.iter().take(n_rest);
    let n_pairs = rest.len().checked_sub(1).filter(|pairs| *pairs > 0)?;
    let n_still = rest
        .clone()
        .zip(rest.skip(1))
        .filter(|(a, b)| same(**a, **b))
        .count();
    if (n_still as f64) < STILL * n_pairs as f64 {
        return None;
    }
    let samples = samples.to_vec();
    let step = smallest_step(&samples);
    are_multiples(&samples, step).then_some(step)
}

/// Returns true if the differences of all `samples` from the first are multiples of `step`, and the
/// step is at least [`FINEST`]: with a finer step, any numbers could pass this test.
pub(crate) fn are_multiples(samples: &[f64], step: f64) -> bool {
    let Some(level) = samples.first() else {
        return false;
    };
    let excursion = samples.iter().map(|x| (x - level).abs());
    let finest = FINEST * excursion.fold(0.0, f64::max);
    let is_multiple = |x: &f64| {
        let steps = (x - level) / step;
        (steps - steps.round()).abs() < ROUNDING
    };
    step > finest && samples.iter().all(is_multiple)
}
