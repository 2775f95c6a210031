//! The result of a comparison of laws.

use std::fmt;

use crate::catalogue::Law;
use crate::least_squares::Termination;
use crate::selection::decision::{Advice, Decision};

/// The result of a [`Selection`](super::Selection).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// The candidates that exist for these data, in their order.
    pub laws: Vec<ComparedLaw>,
    /// The verdict.
    pub decision: Decision,
    /// Advice to consider before the verdict is used.
    pub advice: Vec<Advice>,
    /// Sum of the probabilities of the nonlinear candidates.
    pub nonlinear_probability: f64,
    /// Number of independent samples: the number of samples divided by `inflation`.
    pub effective_samples: f64,
    /// Samples per independent sample: 1 + 2 Σ ρ_l of the whitened residual of the best candidate.
    pub inflation: f64,
    /// Longest cell of the grids of nonlinear laws \[m\].
    pub cell: f64,
}

impl Comparison {
    /// Returns true if a nonlinear law is named.
    #[must_use]
    pub fn is_nonlinear_verdict(&self) -> bool {
        self.law().is_some_and(|law| !law.is_linear)
    }

    /// Returns true if a nonlinear law is in question, or if no law explains the data.
    pub(super) fn asks_for_nonlinear_laws(&self) -> bool {
        let is_nonlinear = |place: &usize| self.laws.get(*place).is_some_and(|law| !law.is_linear);
        match &self.decision {
            Decision::Law { candidate, .. } => is_nonlinear(candidate),
            Decision::CannotTell { between, .. } => between.iter().any(is_nonlinear),
            Decision::NoneOfThese { .. } => true,
        }
    }

    /// The named law, if any.
    #[must_use]
    pub fn law(&self) -> Option<&ComparedLaw> {
        match self.decision {
            Decision::Law { candidate, .. } => self.laws.get(candidate),
            _ => None,
        }
    }
}

/// Formats the verdict, the advice, and a line per law.
impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |indices: &[usize]| -> String {
            let laws = indices.iter().filter_map(|index| self.laws.get(*index));
            let names: Vec<String> = laws.map(ComparedLaw::with_limit).collect();
            names.join("; ")
        };
        match &self.decision {
            Decision::Law {
                candidate,
                probability,
            } => writeln!(
                f,
                "{} (probability {probability:.3})",
                names(std::slice::from_ref(candidate))
            )?,
            Decision::CannotTell { between, reason } => {
                writeln!(f, "cannot distinguish between {}: {reason}", names(between))?;
            }
            Decision::NoneOfThese { best, adequacy } => writeln!(
                f,
                "none of these: the misfit of the best, {}, has a probability of {adequacy:.1e}",
                names(std::slice::from_ref(best))
            )?,
        }
        for advice in &self.advice {
            writeln!(f, "advice: {advice}")?;
        }
        for law in &self.laws {
            write!(
                f,
                "  {:<28} probability {:.3}, chi-square {:.0} with {:.0} effective samples",
                law.name, law.probability, law.chi_square, self.effective_samples
            )?;
            match law.adequacy {
                Some(adequacy) => writeln!(f, ", adequacy {adequacy:.3}")?,
                None => writeln!(f, ", adequacy unknown because the noise is unknown")?,
            }
        }
        Ok(())
    }
}

/// One candidate after the comparison.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ComparedLaw {
    /// Name of the law.
    pub name: String,
    /// The law of the catalogue; `None` for any other model.
    pub law: Option<Law>,
    /// True if the response is proportional to the impact velocity.
    pub is_linear: bool,
    /// True if the law is linear with a loss factor that may be flat.
    pub is_flat_loss: bool,
    /// Names of the parameters.
    pub parameter_names: Vec<String>,
    /// The most probable parameters.
    pub parameters: Vec<f64>,
    /// The likeliest parameters, without the prior.
    pub likeliest: Vec<f64>,
    /// χ² of the whitened residual at the likeliest parameters, against the stated noise.
    pub chi_square: f64,
    /// Probability of a misfit at least this large if this law were true; `None` if the level of
    /// the noise is not known.
    pub adequacy: Option<f64>,
    /// ln Z, up to a constant of the data.
    pub ln_evidence: f64,
    /// Standard error of ln Z.
    pub ln_evidence_error: f64,
    /// Posterior probability; the probabilities of all laws sum to one.
    pub probability: f64,
    /// Number of parameters that the data determine better than the prior.
    pub determined: f64,
    /// Reason for the end of the fit.
    pub termination: Termination,
    /// True if χ² no longer changes when the excitation is estimated again. Laws for which it still
    /// changes are not compared.
    pub is_settled: bool,
    /// Special cases of this law that the data do not exclude at 95 %, the simplest first.
    pub limits: Vec<Limit>,
    pub(super) weight: f64,
}

impl ComparedLaw {
    /// Name of the law, followed by its simplest special case that is not excluded, if any, such as
    /// `two Maxwell branches, of which one has an unbounded relaxation time, which is the law
    /// Zener`.
    #[must_use]
    pub fn with_limit(&self) -> String {
        match self.limits.first() {
            None => self.name.clone(),
            Some(Limit { special, limit }) => {
                format!("{}, {limit}, which is the law {special}", self.name)
            }
        }
    }
}

/// A special case of a law that explains the data as well as the law itself.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Limit {
    /// Name of the special case.
    pub special: String,
    /// The limit, in words that follow the name of the law.
    pub limit: String,
}
