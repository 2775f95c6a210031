//! Discrete Fourier transform of real samples, with buffers that are allocated once.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

thread_local! {
    /// Plans of the lengths in use, kept because the twiddle factors of a long transform cost as
    /// much as several transforms.
    static PLANS: RefCell<Plans> = RefCell::default();
}

/// Number of lengths whose plans are kept: a test uses one or two lengths, and the limit bounds the
/// memory of a program that uses thousands.
const KEPT_LENGTHS: usize = 16;

#[derive(Default)]
struct Plans {
    planner: RealFftPlanner<f64>,
    lengths: Vec<usize>,
}

impl Plans {
    fn of(&mut self, n_samples: usize) -> &mut RealFftPlanner<f64> {
        if !self.lengths.contains(&n_samples) {
            if self.lengths.len() == KEPT_LENGTHS {
                *self = Self::default();
            }
            self.lengths.push(n_samples);
        }
        &mut self.planner
    }
}

/// Forward transform, $`X_k = \sum_n x_n e^{-2\pi i kn/N}`$ for
/// $`k = 0 \ldots \lfloor N/2\rfloor`$, unscaled.
///
/// Each channel is transformed separately. Two real channels in one complex transform are no faster
/// with this library, and rounding errors of a strong channel would then leak into a weak one.
pub(crate) struct Dft {
    plan: Arc<dyn RealToComplex<f64>>,
    input: Vec<f64>,
    scratch: Vec<Complex64>,
}

impl Dft {
    pub(crate) fn new(n_samples: usize) -> Self {
        let plan = PLANS.with_borrow_mut(|plans| plans.of(n_samples).plan_fft_forward(n_samples));
        Self {
            input: plan.make_input_vec(),
            scratch: plan.make_scratch_vec(),
            plan,
        }
    }

    /// The samples to transform; they must be filled in again before every transform.
    pub(crate) fn input(&mut self) -> &mut [f64] {
        &mut self.input
    }

    /// Transforms the contents of [`Dft::input`] and overwrites them.
    #[expect(
        clippy::expect_used,
        reason = "the transform fails only on wrong buffer lengths: the plan made the input, and the output has the lines of the plan"
    )]
    pub(crate) fn transform(&mut self, output: &mut [Complex64]) {
        self.plan
            .process_with_scratch(&mut self.input, output, &mut self.scratch)
            .expect("buffers of the plan");
    }
}

impl fmt::Debug for Dft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Dft")
            .field("n_samples", &self.input.len())
            .finish_non_exhaustive()
    }
}

/// Returns the unscaled transform of real `samples`.
pub(crate) fn forward(samples: &[f64]) -> Vec<Complex64> {
    let mut lines = vec![Complex64::ZERO; samples.len() / 2 + 1];
    let mut dft = Dft::new(samples.len());
    dft.input().copy_from_slice(samples);
    dft.transform(&mut lines);
    lines
}

/// Inverse transform, $`x_n = \frac1N\sum_k X_k e^{2\pi i kn/N}`$ with the sum over the two-sided
/// spectrum. `lines` is the one-sided spectrum, $`\lfloor N/2\rfloor + 1`$ values. The lines at 0
/// Hz and at the Nyquist frequency occur once in the sum; only their real parts are used.
#[expect(
    clippy::expect_used,
    reason = "the transform fails only on wrong buffer lengths or imaginary parts of the end lines, which are set to 0"
)]
pub(crate) fn inverse(lines: &[Complex64], n_samples: usize) -> Vec<f64> {
    let plan: Arc<dyn ComplexToReal<f64>> =
        PLANS.with_borrow_mut(|plans| plans.of(n_samples).plan_fft_inverse(n_samples));
    let mut input = lines.to_vec();
    if let Some(first) = input.first_mut() {
        first.im = 0.0;
    }
    if n_samples.is_multiple_of(2)
        && let Some(last) = input.last_mut()
    {
        last.im = 0.0;
    }
    let mut samples = plan.make_output_vec();
    plan.process(&mut input, &mut samples)
        .expect("buffers of the plan, real end lines");
    for sample in &mut samples {
        *sample /= n_samples as f64;
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_transform_is_the_direct_sum_for_even_and_odd_lengths() {
        for n in [2, 7, 48, 125] {
            let samples: Vec<f64> = (0..n).map(|i| (1.7 * f64::from(i)).sin() + 0.3).collect();
            let fast = forward(&samples);
            assert_eq!(fast.len(), samples.len() / 2 + 1);
            for (k, line) in fast.iter().enumerate() {
                let direct: Complex64 = samples
                    .iter()
                    .enumerate()
                    .map(|(i, x)| {
                        x * Complex64::cis(-TAU * ((k * i) % samples.len()) as f64 / f64::from(n))
                    })
                    .sum();
                // tolerance: a hundred terms of order one, each rounded to 1e-16
                assert!((line - direct).norm() < 1e-13, "n {n}, line {k}");
            }
            for (there, back) in samples.iter().zip(inverse(&fast, samples.len())) {
                assert!((there - back).abs() < 1e-14, "n {n}"); // rounding of two short transforms
            }
        }
    }

    #[test]
    fn plans_of_many_lengths_are_not_kept() {
        let n_kept = || PLANS.with_borrow(|plans| plans.lengths.len());
        for n in 2..60 {
            let _ = forward(&vec![1.0; n]);
            assert!(n_kept() <= KEPT_LENGTHS);
        }
    }
}
