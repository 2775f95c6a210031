//! Results of tracking: lines with their branches.

use num_complex::Complex64;

use super::Branch;
use super::doubt::BranchDoubt;

/// Line with its branch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TrackedLine {
    /// Root x = γℓ of Ψ(x) = Ψ of this line that is nearest to `expected`; 0 at 0 Hz, and `None`
    /// where the line is not finite or has no root nearby.
    pub root: Option<Complex64>,
    /// Smoothed γℓ, from this line and all others.
    pub expected: Complex64,
    /// Standard error of the real part and of the imaginary part of `expected`.
    pub expected_error: f64,
    /// Probability that the root belongs to the γ of the material; 0 where the assumptions have
    /// failed.
    pub confidence: f64,
    /// Reason to doubt the line. The count of waves is in doubt only if
    /// [`BranchDoubt::is_ambiguous`] returns true.
    pub doubt: Option<BranchDoubt>,
}

impl TrackedLine {
    pub(super) const AT_REST: Self = Self {
        root: Some(Complex64::ZERO),
        expected: Complex64::ZERO,
        expected_error: 0.0,
        confidence: 1.0,
        doubt: None,
    };

    /// Returns the integers s and n of Table 1 for the root, or for `expected` if there is no root.
    #[must_use]
    pub fn branch(&self) -> Branch {
        Branch::at(self.root.unwrap_or(self.expected).im)
    }
}

/// Wave speed that explains the lines, and its probability.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SpeedHypothesis {
    /// Phase velocity ω/k at the first line [m/s].
    pub wave_speed: f64,
    /// Probability; the sum over all hypotheses is at most 1, because improbable wave speeds are
    /// not listed.
    pub probability: f64,
}

/// Result of [`BranchTracker::track`](crate::branch::BranchTracker::track).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TrackedBranches {
    /// Tracked lines per record, in the order of the input.
    pub records: Vec<Vec<TrackedLine>>,
    /// Possible wave speeds, the most probable first; empty if no line could be used as a start.
    pub hypotheses: Vec<SpeedHypothesis>,
    /// Scatter of the lines about the smooth curve relative to the stated noise, as a ratio of
    /// amplitudes; at least 1 with a stated variance.
    pub noise_factor: f64,
}

/// Origin of a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) record: usize,
    pub(super) line: usize,
}
