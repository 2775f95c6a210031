//! Result of a selection, in words.

use maxwellid::selection::{Comparison, Decision};
use serde::Serialize;

/// Result of the selection for a set of tests.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Verdict {
    /// Posterior probability of each candidate, by name.
    pub(crate) probabilities: Vec<(String, f64)>,
    pub(crate) decision: String,
    #[serde(skip)]
    pub(crate) names_a_nonlinear_law: bool,
    #[serde(skip)]
    pub(crate) named: Option<String>,
}

pub(crate) fn verdict(comparison: &Comparison) -> Verdict {
    let name = |index: usize| {
        comparison
            .laws
            .get(index)
            .map_or("?", |law| law.name.as_str())
    };
    Verdict {
        probabilities: comparison
            .laws
            .iter()
            .map(|law| (law.name.clone(), law.probability))
            .collect(),
        decision: match &comparison.decision {
            Decision::Law { candidate, .. } => name(*candidate).to_owned(),
            Decision::CannotTell { between, .. } => {
                let names: Vec<&str> = between.iter().map(|index| name(*index)).collect();
                format!("cannot tell: {}", names.join(" or "))
            }
            Decision::NoneOfThese { .. } => "none of these".into(),
            other => format!("{other:?}"),
        },
        names_a_nonlinear_law: comparison.is_nonlinear_verdict(),
        named: comparison.law().map(|law| law.name.clone()),
    }
}
