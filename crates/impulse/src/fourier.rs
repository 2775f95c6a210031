//! Transforms between samples and one-sided spectra; unscaled in both directions.

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

/// Returns $`X_k = \sum_n x_n e^{-2\pi i kn/N}`$ for $`k = 0 \ldots \lfloor N/2\rfloor`$.
pub(crate) fn to_spectrum(samples: &[f64]) -> Vec<Complex64> {
    let mut fourier = RealFourier::new(samples.len());
    fourier.samples().copy_from_slice(samples);
    fourier.forward().to_vec()
}

/// Returns $`x_n = \sum_k X_k e^{2\pi i kn/N}`$, summed over both sides, from the one-sided
/// spectrum of a real history of `n_samples` samples, which has $`\lfloor N/2\rfloor + 1`$ lines.
///
/// Only the real parts of the lines at 0 Hz and at the Nyquist frequency are used, as samples are
/// real.
pub(crate) fn to_samples(spectrum: &[Complex64], n_samples: usize) -> Vec<f64> {
    let mut fourier = RealFourier::new(n_samples);
    for (line, value) in fourier.lines().iter_mut().zip(spectrum) {
        *line = *value;
    }
    fourier.inverse().to_vec()
}
