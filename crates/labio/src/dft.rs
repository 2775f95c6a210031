//! The discrete Fourier transform of real samples, with buffers that are allocated once.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{RealFftPlanner, RealToComplex};

/// $`X_k = \sum_n x_n e^{-2\pi i kn/N}`$ for $`k = 0 \ldots \lfloor N/2\rfloor`$, unscaled.
pub(crate) struct Dft {
    plan: Arc<dyn RealToComplex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Dft {
    pub(crate) fn new(n_samples: usize) -> Self {
        let plan = RealFftPlanner::new().plan_fft_forward(n_samples);
        Self {
            input: plan.make_input_vec(),
            output: plan.make_output_vec(),
            scratch: plan.make_scratch_vec(),
            plan,
        }
    }

    /// Transforms the first `n_samples` values of `samples`; missing ones count as zero.
    #[expect(
        clippy::expect_used,
        reason = "the transform fails only on wrong buffer lengths, and the buffers were made by the plan"
    )]
    pub(crate) fn of(&mut self, samples: impl Iterator<Item = f64>) -> &[Complex64] {
        self.input.fill(0.0);
        for (slot, sample) in self.input.iter_mut().zip(samples) {
            *slot = sample;
        }
        self.plan
            .process_with_scratch(&mut self.input, &mut self.output, &mut self.scratch)
            .expect("buffers of the plan");
        &self.output
    }
}

impl fmt::Debug for Dft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Dft")
            .field("n_samples", &self.input.len())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_transform_is_the_direct_sum_for_even_and_odd_lengths() {
        for n in [2, 7, 48, 125] {
            let samples: Vec<f64> = (0..n).map(|i| (1.7 * f64::from(i)).sin() + 0.3).collect();
            let mut dft = Dft::new(samples.len());
            let fast = dft.of(samples.iter().copied());
            assert_eq!(fast.len(), samples.len() / 2 + 1);
            for (k, line) in fast.iter().enumerate() {
                let direct: Complex64 = samples
                    .iter()
                    .enumerate()
                    .map(|(i, x)| {
                        x * Complex64::cis(-TAU * ((k * i) % samples.len()) as f64 / f64::from(n))
                    })
                    .sum();
                // a hundred terms of order one, each rounded to 1e-16
                assert!((line - direct).norm() < 1e-13, "n {n}, line {k}");
            }
        }
    }
}
