//! Reasons to doubt a branch.

use std::f64::consts::{FRAC_PI_2, PI};

/// Reason why the branch of a line may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BranchDoubt {
    /// Another root cannot be excluded: noise has moved the line to a point where two roots meet,
    /// or the phase of the line is too uncertain.
    #[error(
        "confidence {confidence:.4} in the branch, expected at least {least}: the other root is kL = {other:.2}"
    )]
    OtherRoot {
        /// Probability of the branch.
        confidence: f64,
        /// Required confidence.
        least: f64,
        /// Phase of the other root, in rad.
        other: f64,
    },
    /// Another wave speed explains the lines as well, so that the number of waves is unknown: the
    /// lines begin too far from 0 Hz, or are too far apart, and there is no prior knowledge.
    #[error(
        "a wave speed of {other:.0} m/s explains the first lines nearly as well as {chosen:.0} m/s"
    )]
    SeveralSpeeds {
        /// Chosen speed [m/s].
        chosen: f64,
        /// Other speed [m/s].
        other: f64,
    },
    /// The lines around this one do not lie on a smooth curve, or a stretch of lines at lower
    /// frequencies, longer than half a wave, does not.
    #[error(
        "over several lines the misfit of a smooth wave number is {chi_square:.1} times its expectation, expected at most {limit}"
    )]
    Erratic {
        /// Mean of |δΨ|² divided by its expectation.
        chi_square: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// The damping is negative beyond its error: the count of waves is wrong, Ψ is the complex
    /// conjugate, or the two ends are interchanged.
    #[error(
        "this line and its neighbours give alpha L = {damping_length:.1e}, {deviations:.1} standard errors below 0"
    )]
    Turned {
        /// Damping αL from this line and the lines around it.
        damping_length: f64,
        /// αL divided by its standard error.
        deviations: f64,
    },
    /// No line of the record determines its roots.
    #[error("the record is too noisy to count waves on any line")]
    Undetermined,
    /// The root of the line is farther from the value expected from the other lines than the noise
    /// allows.
    #[error("kL = {found:.2}, expected {expected:.2} from the other lines")]
    Leap {
        /// Phase expected from the other lines, in rad.
        expected: f64,
        /// Phase of the nearest root, in rad.
        found: f64,
    },
    /// The gap to the previous line is too long to count the waves: kL is expected to advance by
    /// more than half a wave.
    #[error(
        "kL is expected to advance by {advance:.2} from the previous line, more than half a wave"
    )]
    Gap {
        /// Expected advance of kL, in rad.
        advance: f64,
    },
    /// There are too few lines to distinguish wave speeds, and no guess was given.
    #[error(
        "{found} lines are too few to find the wave speed, expected {expected} or a guess of the wave speed"
    )]
    FewLines {
        /// Number of lines.
        found: usize,
        /// Required number.
        expected: usize,
    },
    /// The root itself has negative damping: noise has changed the sign of Im Ψ. The count of waves
    /// is not affected.
    #[error("the root has negative damping, alpha L = {damping_length:.1e}")]
    NegativeDamping {
        /// Damping αL of the root.
        damping_length: f64,
    },
}

impl BranchDoubt {
    /// Returns the doubt about a phase `found` that differs from the `expected` phase or follows
    /// an expected `advance` of more than half a wave from the previous line; all in rad.
    pub(crate) fn of_phase(advance: f64, expected: f64, found: f64) -> Option<Self> {
        if advance > PI {
            Some(Self::Gap { advance })
        } else if (found - expected).abs() > FRAC_PI_2 {
            Some(Self::Leap { expected, found })
        } else {
            None
        }
    }

    /// Returns true if the branch itself is doubtful, false if only the line is noisy.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        !matches!(self, Self::NegativeDamping { .. })
    }
}
