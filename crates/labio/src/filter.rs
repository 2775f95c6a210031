//! Linear filters given by their frequency response, applied to samples by the discrete Fourier
//! transform.

use num_complex::Complex64;

use crate::dft;

/// Applies the filter `response`, a function of the angular frequency \[rad/sample\], to `samples`.
///
/// The transform treats the samples as periodic. The padding between two periods is at least as
/// long as the samples and joins the last sample to the first by half a cosine: the filter's
/// response at one end does not reach the other end, and a constant signal stays constant.
pub(crate) fn filtered(samples: &[f64], response: impl Fn(f64) -> Complex64) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else {
        return Vec::new();
    };
    let n = samples.len();
    let n_total = (2 * n).next_power_of_two();
    let n_between = (n_total - n) as f64;

    let mut history = samples.to_vec();
    history.extend((1..=n_total - n).map(|k| {
        let phase = std::f64::consts::PI * k as f64 / (n_between + 1.0);
        last + (first - last) * (1.0 - phase.cos()) / 2.0
    }));
    let mut lines = dft::forward(&history);
    let step = std::f64::consts::TAU / n_total as f64;
    for (k, line) in lines.iter_mut().enumerate() {
        *line *= response(k as f64 * step);
    }
    let mut filtered = dft::inverse(&lines, n_total);
    filtered.truncate(n);
    filtered
}

/// Delays `samples` by a number of sampling intervals, by band-limited interpolation; a negative
/// `shift` advances them.
pub(crate) fn delayed(samples: &[f64], shift: f64) -> Vec<f64> {
    filtered(samples, |omega| Complex64::cis(-omega * shift))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_stays_a_level_and_a_whole_shift_moves_samples() {
        let mut samples = vec![3.0; 100];
        for sample in delayed(&samples, 0.37) {
            assert!((sample - 3.0).abs() < 1e-13); // roundings of a transform of 256 lines
        }
        samples[40] = 5.0;
        let moved = delayed(&samples, 7.0);
        for (k, sample) in moved.iter().enumerate() {
            let expected = if k == 47 { 5.0 } else { 3.0 };
            assert!((sample - expected).abs() < 1e-13);
        }
        assert!(delayed(&[], 1.0).is_empty());
    }
}
