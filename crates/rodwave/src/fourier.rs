//! Discrete Fourier transform of real samples, with buffers that are allocated once.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Transform $`X_k = \sum_n x_n e^{-2\pi i kn/N}`$, $`k = 0 \ldots \lfloor N/2\rfloor`$, of real
/// samples, and its inverse; both are unscaled.
///
/// ```
/// let mut fourier = rodwave::fourier::RealFourier::new(8);
/// fourier.samples()[1] = 1.0;
/// let lines = fourier.forward().to_vec();
/// assert!((lines[2].im + 1.0).abs() < 1e-15); // e^{-2πi 2/8}
/// assert!((fourier.inverse()[1] - 8.0).abs() < 1e-14); // both transforms together multiply by 8
/// ```
#[derive(Clone)]
pub struct RealFourier {
    forward: Option<Arc<dyn RealToComplex<f64>>>,
    inverse: Option<Arc<dyn ComplexToReal<f64>>>,
    samples: Vec<f64>,
    lines: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl RealFourier {
    /// Creates a transform of N = `n_samples` samples, all 0.
    #[must_use]
    pub fn new(n_samples: usize) -> Self {
        Self {
            forward: None,
            inverse: None,
            samples: vec![0.0; n_samples],
            lines: vec![Complex64::ZERO; n_samples / 2 + 1],
            scratch: Vec::new(),
        }
    }

    /// Input samples of [`Self::forward`].
    pub fn samples(&mut self) -> &mut [f64] {
        &mut self.samples
    }

    /// Input lines of [`Self::inverse`], ⌊N/2⌋ + 1 of them.
    pub fn lines(&mut self) -> &mut [Complex64] {
        &mut self.lines
    }

    /// Transforms the samples to lines; the samples are overwritten.
    #[expect(
        clippy::expect_used,
        clippy::missing_panics_doc,
        reason = "the transform fails only on wrong buffer lengths, and the buffers are of the length of the plan"
    )]
    pub fn forward(&mut self) -> &mut [Complex64] {
        let n_samples = self.samples.len();
        if n_samples == 0 {
            return &mut self.lines;
        }
        let plan = self.forward.get_or_insert_with(|| forward_plan(n_samples));
        enlarge(&mut self.scratch, plan.get_scratch_len());
        plan.process_with_scratch(&mut self.samples, &mut self.lines, &mut self.scratch)
            .expect("buffers of the plan");
        &mut self.lines
    }

    /// Transforms the lines to samples; the lines are overwritten.
    ///
    /// Only the real parts of the lines at 0 Hz and at the Nyquist frequency are used, because the
    /// samples are real.
    #[expect(
        clippy::expect_used,
        clippy::missing_panics_doc,
        reason = "the transform fails only on wrong buffer lengths, and on imaginary parts at 0 Hz and the Nyquist frequency, \
                  which are removed here"
    )]
    pub fn inverse(&mut self) -> &mut [f64] {
        let n_samples = self.samples.len();
        if n_samples == 0 {
            return &mut self.samples;
        }
        let plan = self.inverse.get_or_insert_with(|| inverse_plan(n_samples));
        if let Some(mean) = self.lines.first_mut() {
            mean.im = 0.0;
        }
        if n_samples.is_multiple_of(2)
            && let Some(nyquist) = self.lines.last_mut()
        {
            nyquist.im = 0.0;
        }
        enlarge(&mut self.scratch, plan.get_scratch_len());
        plan.process_with_scratch(&mut self.lines, &mut self.samples, &mut self.scratch)
            .expect("buffers of the plan");
        &mut self.samples
    }
}

impl fmt::Debug for RealFourier {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("RealFourier")
            .field("n_samples", &self.samples.len())
            .finish_non_exhaustive()
    }
}

thread_local! {
    /// Plans of the lengths in use. They are kept because the twiddle factors of a long transform
    /// cost as much as several transforms.
    static PLANS: RefCell<Plans> = RefCell::new(Plans::empty());
}

/// Number of lengths whose plans are kept. Without this limit, a program that uses thousands of
/// lengths would keep them all.
const KEPT_LENGTHS: usize = 16;

struct Plans {
    planner: RealFftPlanner<f64>,
    lengths: Vec<usize>,
}

impl Plans {
    fn empty() -> Self {
        Self {
            planner: RealFftPlanner::new(),
            lengths: Vec::new(),
        }
    }

    fn of(&mut self, n_samples: usize) -> &mut RealFftPlanner<f64> {
        if !self.lengths.contains(&n_samples) {
            if self.lengths.len() == KEPT_LENGTHS {
                *self = Self::empty();
            }
            self.lengths.push(n_samples);
        }
        &mut self.planner
    }
}

/// Creates plans in a function that is not inlined: otherwise each crate that creates plans would
/// compile all algorithms of the library again.
#[inline(never)]
fn forward_plan(n_samples: usize) -> Arc<dyn RealToComplex<f64>> {
    PLANS.with_borrow_mut(|plans| plans.of(n_samples).plan_fft_forward(n_samples))
}

#[inline(never)]
fn inverse_plan(n_samples: usize) -> Arc<dyn ComplexToReal<f64>> {
    PLANS.with_borrow_mut(|plans| plans.of(n_samples).plan_fft_inverse(n_samples))
}

fn enlarge(scratch: &mut Vec<Complex64>, length: usize) {
    if scratch.len() < length {
        scratch.resize(length, Complex64::ZERO);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_samples_have_no_lines_but_the_mean() {
        assert_eq!(*RealFourier::new(0).forward(), [Complex64::ZERO]);
        assert!(RealFourier::new(0).inverse().is_empty());
    }

    #[test]
    fn the_transform_is_the_direct_sum_for_even_and_odd_lengths() {
        for n in [2_u32, 9, 64] {
            let samples: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.9).cos()).collect();
            let mut fourier = RealFourier::new(samples.len());
            fourier.samples().copy_from_slice(&samples);
            let turn = std::f64::consts::TAU / f64::from(n);
            for (k, line) in (0..n).zip(fourier.forward().iter()) {
                let direct: Complex64 = (0..n)
                    .zip(&samples)
                    .map(|(i, x)| x * Complex64::cis(-turn * f64::from(i * k % n)))
                    .sum();
                // tolerance: up to 64 terms of order one, each rounded to 1e-16
                assert!((line - direct).norm() < 1e-13, "n {n}, line {k}");
            }
            for (x, y) in samples.iter().zip(fourier.inverse()) {
                assert!((x * f64::from(n) - *y).abs() < 1e-13);
            }
        }
    }
}
