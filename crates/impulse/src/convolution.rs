//! Convolution with a history that is generated step by step.

use std::fmt;

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

/// Block length up to which the convolution is summed directly; longer blocks use transforms.
const LEAF: usize = 64;

/// Convolution $`p_n = \sum_{j<n} w_{n-j} x_j`$ with a causal kernel w, where $`x_n`$ is given only
/// after $`p_n`$ has been computed.
///
/// The triangle of pairs (j, n) is cut into squares that double in size away from the diagonal:
/// when $`2^p`$ leaves are complete, their effect on as many leaves after them is computed by one
/// Fourier convolution. N steps cost $`O(N\log^2 N)`$ (Hairer, Lubich & Schlichte, SIAM J. Sci.
/// Stat. Comput. 6 (1985) 532).
pub(crate) struct OnlineConvolution<'a> {
    kernel: &'a [f64],
    given: Vec<f64>,
    /// Effect of complete blocks on later steps.
    pending: Vec<f64>,
    levels: Vec<Level>,
}

/// Squares of one size L, with transforms of 2L points.
struct Level {
    length: usize,
    fourier: RealFourier,
    /// Transform of the kernel from 0 to 2L, divided by 2L.
    kernel: Vec<Complex64>,
}

impl fmt::Debug for OnlineConvolution<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("OnlineConvolution")
            .field("steps", &self.given.len())
            .field("of", &self.kernel.len())
            .finish_non_exhaustive()
    }
}

impl<'a> OnlineConvolution<'a> {
    /// Creates a convolution for as many steps as the kernel has elements.
    pub(crate) fn new(kernel: &'a [f64]) -> Self {
        let mut levels = Vec::new();
        let mut length = LEAF;
        while length < kernel.len() {
            levels.push(Level::new(kernel, length));
            length *= 2;
        }
        Self {
            kernel,
            given: Vec::with_capacity(kernel.len()),
            pending: vec![0.0; kernel.len()],
            levels,
        }
    }

    /// Returns $`p_n`$ for the next step n.
    pub(crate) fn past(&self) -> f64 {
        let n = self.given.len();
        let begin = n - n % LEAF;
        let recent = self.given.get(begin..).unwrap_or_default();
        let kernel = self.kernel.get(1..=n - begin).unwrap_or_default();
        let direct: f64 = recent
            .iter()
            .zip(kernel.iter().rev())
            .map(|(x, w)| x * w)
            .sum();
        self.pending.get(n).copied().unwrap_or(0.0) + direct
    }

    /// Adds $`x_n`$.
    pub(crate) fn push(&mut self, value: f64) {
        self.given.push(value);
        let n = self.given.len();
        if n.is_multiple_of(LEAF) && n < self.kernel.len() {
            let level = (n / LEAF).trailing_zeros() as usize;
            if let Some(level) = self.levels.get_mut(level) {
                let block = self.given.get(n - level.length..).unwrap_or_default();
                let later = self.pending.get_mut(n..).unwrap_or_default();
                level.add(block, later);
            }
        }
    }

    /// Returns all values $`x_n`$.
    pub(crate) fn into_given(self) -> Vec<f64> {
        self.given
    }
}

impl Level {
    fn new(kernel: &[f64], length: usize) -> Self {
        let mut fourier = RealFourier::new(2 * length);
        for (sample, weight) in fourier.samples().iter_mut().zip(kernel) {
            *sample = *weight;
        }
        let scale = 0.5 / length as f64;
        Self {
            length,
            kernel: fourier.forward().iter().map(|line| line * scale).collect(),
            fourier,
        }
    }

    /// Adds the effect of `block` on the steps right after it.
    fn add(&mut self, block: &[f64], later: &mut [f64]) {
        let samples = self.fourier.samples();
        samples.fill(0.0);
        for (sample, value) in samples.iter_mut().zip(block) {
            *sample = *value;
        }
        for (line, weight) in self.fourier.forward().iter_mut().zip(&self.kernel) {
            *line *= weight;
        }
        // the circular convolution has wrapped onto the first half only
        let result = self.fourier.inverse().iter().skip(self.length);
        for (pending, value) in later.iter_mut().zip(result) {
            *pending += value;
        }
    }
}

/// Returns $`\sum_{j\le n} w_{n-j} x_j`$ for a whole history, by one transform.
pub(crate) fn causal_convolution(kernel: &[f64], given: &[f64]) -> Vec<f64> {
    let n = given.len();
    let n_points = (2 * n).next_power_of_two().max(2);
    let mut fourier = RealFourier::new(n_points);
    let mut transform = |values: &[f64]| {
        let samples = fourier.samples();
        samples.fill(0.0);
        for (sample, value) in samples.iter_mut().zip(values.iter().take(n)) {
            *sample = *value;
        }
        fourier.forward().to_vec()
    };
    let of_kernel = transform(kernel);
    transform(given);
    let scale = 1.0 / n_points as f64;
    for (line, w) in fourier.lines().iter_mut().zip(of_kernel) {
        *line = w * *line * scale;
    }
    let mut samples = fourier.inverse().to_vec();
    samples.truncate(n);
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irregular kernel and input.
    fn arrays(n: usize) -> (Vec<f64>, Vec<f64>) {
        let value = |k: usize, a: f64| (a * (k * k) as f64 + 0.3).sin();
        (0..n)
            .map(|k| (value(k, 0.37), value(k, 0.91) + 0.2))
            .unzip()
    }

    #[test]
    fn blocks_and_direct_sums_agree() {
        for n in [1, 63, 64, 65, 128, 1000, 3001] {
            let (kernel, given) = arrays(n);
            let mut online = OnlineConvolution::new(&kernel);
            let whole = causal_convolution(&kernel, &given);
            for step in 0..n {
                let direct: f64 = (0..step).map(|j| kernel[step - j] * given[j]).sum();
                // rounding of sums of up to 3000 terms of size 1
                assert!((online.past() - direct).abs() < 1e-11, "{n} {step}");
                let now = direct + kernel[0] * given[step];
                assert!((whole[step] - now).abs() < 1e-11, "{n} {step}");
                online.push(given[step]);
            }
        }
    }
}
