//! Between samples and one-sided spectra; unscaled in both directions.

use num_complex::Complex64;
use realfft::RealFftPlanner;

/// $`X_k = \sum_n x_n e^{-2\pi i kn/N}`$ for $`k = 0 \ldots \lfloor N/2\rfloor`$.
#[expect(
    clippy::expect_used,
    reason = "the transform fails only on wrong buffer lengths, and the output was made by the plan"
)]
pub(crate) fn to_spectrum(samples: &[f64]) -> Vec<Complex64> {
    let plan = RealFftPlanner::new().plan_fft_forward(samples.len());
    let mut spectrum = plan.make_output_vec();
    plan.process(&mut samples.to_vec(), &mut spectrum)
        .expect("buffers of the plan");
    spectrum
}

/// $`x_n = \sum_k X_k e^{2\pi i kn/N}`$ over both sides, from the one-sided spectrum of a real history of `n_samples` samples, which
/// has $`\lfloor N/2\rfloor + 1`$ lines.
///
/// The lines at 0 Hz and at the Nyquist frequency keep their real parts, all that real samples can show of them.
#[expect(
    clippy::expect_used,
    reason = "the transform fails only on wrong buffer lengths, which are made here, and on imaginary parts at 0 Hz and \
              the Nyquist frequency, which are removed here"
)]
pub(crate) fn to_samples(spectrum: &[Complex64], n_samples: usize) -> Vec<f64> {
    let plan = RealFftPlanner::new().plan_fft_inverse(n_samples);
    let mut lines = plan.make_input_vec();
    for (index, (line, value)) in lines.iter_mut().zip(spectrum).enumerate() {
        *line = *value;
        if index == 0 || 2 * index == n_samples {
            line.im = 0.0;
        }
    }
    let mut samples = plan.make_output_vec();
    plan.process(&mut lines, &mut samples)
        .expect("buffers of the plan");
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_number_of_samples() {
        for n in [2, 9, 64] {
            let samples: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.9).cos()).collect();
            let back = to_samples(&to_spectrum(&samples), samples.len());
            for (x, y) in samples.iter().zip(&back) {
                // rounding of two transforms of 64 points
                assert!((x * f64::from(n) - y).abs() < 1e-13);
            }
        }
    }
}
