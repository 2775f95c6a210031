//! Transformation from the frequency domain to the time domain.
//!
//! There are two methods, for two classes of bodies.
//!
//! 1. [`FourierSynthesis`]: the discrete transform of a one-sided spectrum. The resulting history
//!    is periodic; it is correct if the history decays within a period, and otherwise wrong without
//!    a warning.
//! 2. [`DampedSynthesis`]: the same transform for e^{-at} times the history, that is, from its
//!    Laplace transform on the line Re s = a. The alias of the next period is damped by e^{-aT_p}.
//!    The method is correct for any causal history, including that of two undamped finite elastic
//!    bodies, and requires laws that are analytic in the right half plane.
//!
//! Both methods use the kernel e^{+iωt} of the conventions and include the scaling: a transform \[q
//! s\] becomes a history \[q\].
//!
//! ```
//! use num_complex::Complex64;
//! use rodwave::synthesis::DampedSynthesis;
//!
//! // 2/(s² + 4) is the transform of sin 2t, which does not decay
//! let synthesis = DampedSynthesis::new(10.0, 1e-3)?;
//! let transform: Vec<Complex64> = synthesis.arguments().map(|s| 2.0 / (s * s + 4.0)).collect();
//! let history = synthesis.history(&transform)?;
//! assert!((history.samples[3000] - 6.0_f64.sin()).abs() < 2e-6);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! Theory: `docs/theory/chains.md#histories`.

mod damped;
mod fourier;

pub use damped::DampedSynthesis;
pub use fourier::FourierSynthesis;

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{check_length, check_samples};
use crate::fourier::RealFourier;

/// A history at equal intervals.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SynthesizedHistory {
    /// Time of the first sample \[s\].
    pub start: f64,
    /// Interval between samples \[s\].
    pub interval: f64,
    /// The samples; their unit is that of the transform divided by seconds.
    pub samples: Vec<f64>,
}

impl SynthesizedHistory {
    /// Time \[s\] of the sample with this `index`.
    #[must_use]
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.interval
    }
}

/// Computes $`\sum_k X_k e^{2\pi i kn/N}`$ over both sides, N even, from the lines 0 to N/2 of a
/// real history, without scaling.
///
/// Only the real parts of the lines at 0 and N/2 are used, because the samples are real.
fn to_samples(lines: &[Complex64]) -> Vec<f64> {
    let mut fourier = RealFourier::new(2 * (lines.len() - 1));
    fourier.lines().copy_from_slice(lines);
    fourier.inverse().to_vec()
}

/// Checks that the samples of a synthesis have not overflowed.
fn check_synthesized(samples: &[f64]) -> Result<(), RodwaveError> {
    check_samples("the synthesized history", samples)
}

/// Checks that the lines are finite and that there are as many as `expected`.
fn check_lines(
    name: &'static str,
    lines: &[Complex64],
    expected: usize,
) -> Result<(), RodwaveError> {
    check_length(name, lines.len(), expected)?;
    match lines.iter().enumerate().find(|(_, l)| !l.is_finite()) {
        None => Ok(()),
        Some((index, line)) => Err(RodwaveError::NonFiniteSample {
            history: name,
            index,
            value: line.norm(),
        }),
    }
}
