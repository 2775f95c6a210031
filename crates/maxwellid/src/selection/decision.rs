//! Verdict on the law, with reasons for doubt and advice.

use std::fmt;

/// Verdict on the law.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Decision {
    /// One law, by its index among the candidates.
    Law {
        /// Index of the candidate.
        candidate: usize,
        /// Probability of the law.
        probability: f64,
    },
    /// Several laws explain the data; more data are needed.
    CannotTell {
        /// The candidates between which the data do not decide, most probable first.
        between: Vec<usize>,
        /// The reason.
        reason: Doubt,
    },
    /// No candidate explains the data.
    NoneOfThese {
        /// The candidate with the least misfit.
        best: usize,
        /// Probability of a misfit at least this large if this candidate were true.
        adequacy: f64,
    },
}

/// Reasons why no law is named.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Doubt {
    /// No candidate reaches the required probability.
    #[error("the most probable law has a probability of {first:.3}, less than {required}")]
    Probabilities {
        /// Probability of the first candidate.
        first: f64,
        /// Required probability.
        required: f64,
    },
    /// A nonlinear law leads, but all tests have one impact velocity, and a linear law with a flat
    /// loss also explains the data.
    #[error(
        "a nonlinear law is the most probable, but a linear law of flat loss also explains the data, which are from one impact velocity (adequacy {adequacy:.3})"
    )]
    OneVelocity {
        /// The linear law.
        linear: usize,
        /// Adequacy of the linear law: the probability of a misfit at least this large if it were
        /// true.
        adequacy: f64,
    },
    /// A nonlinear law leads, but all tests have one impact velocity, and no linear law with a flat
    /// loss was among the candidates.
    #[error(
        "a nonlinear law is the most probable, but the data are from one impact velocity and no linear law of flat loss is among the candidates"
    )]
    NoFlatLossCompetitor,
    /// The misfit of a special case of the most probable law does not exclude it.
    #[error("the data do not exclude a special case of the most probable law")]
    SpecialCase,
    /// The misfit of a law that is not excluded still changes when the excitation is estimated
    /// again.
    #[error("the misfit of one of these laws still changes when the excitation is estimated again")]
    Unsettled {
        /// The law.
        law: usize,
    },
}

/// Advice to consider before the verdict is used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Advice {
    /// Repeat at another impact velocity. The response of a linear rod is proportional to the
    /// velocity; a rod with a Norton law has an apparent relaxation time ∝ V0^{1-κ}.
    SecondVelocity {
        /// The only impact velocity [m/s].
        present: f64,
    },
    /// The residual of the best candidate is correlated: the model or the description of the
    /// instruments is incomplete.
    CorrelatedResidual {
        /// Factor by which the number of independent samples is reduced.
        inflation: f64,
    },
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SecondVelocity { present } => write!(
                f,
                "repeat the test at an impact velocity other than {present} m/s: only the response of a linear rod is proportional to the velocity"
            ),
            Self::CorrelatedResidual { inflation } => write!(
                f,
                "the residual of the best law is correlated (one independent sample in {inflation:.1}): the law or the description of the instruments is incomplete"
            ),
        }
    }
}
