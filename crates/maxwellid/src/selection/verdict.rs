//! Verdict on the compared laws.
#![allow(
    clippy::indexing_slicing,
    reason = "`laws` is not empty, and `order` is a permutation of its indices"
)]

use super::{Advice, ComparedLaw, Comparison, Decision, Doubt, Selection};

/// Factor of reduction of the number of independent samples above which it is reported; white
/// residuals give at most about 1.3.
const CORRELATED_FROM: f64 = 1.5;

/// Largest total probability of the laws that are omitted where several laws remain in question, as
/// a fraction of the probability that all other laws may have where one law is named. With a
/// fraction of 1 and 5 % noise, the true law was omitted in three of a hundred such verdicts.
const LEFT_OUT: f64 = 0.2;

impl Selection {
    /// Computes probabilities, verdict and advice for `laws`, of which there must be at least one.
    pub(super) fn decide(
        &self,
        mut laws: Vec<ComparedLaw>,
        effective_samples: f64,
        inflation: f64,
        slowest: f64,
        has_several_velocities: bool,
    ) -> Comparison {
        let largest = laws
            .iter()
            .fold(f64::NEG_INFINITY, |top, law| top.max(law.ln_evidence));
        let total: f64 = laws
            .iter()
            .map(|law| law.weight * (law.ln_evidence - largest).exp())
            .sum();
        for law in &mut laws {
            law.probability = law.weight * (law.ln_evidence - largest).exp() / total;
        }
        let mut order: Vec<usize> = (0..laws.len()).collect();
        order.sort_by(|a, b| laws[*b].probability.total_cmp(&laws[*a].probability));
        let nonlinear = laws
            .iter()
            .filter(|law| !law.is_linear)
            .map(|law| law.probability)
            .sum();
        let verdict = self.verdict(&laws, &order, has_several_velocities);
        let decision = with_special_cases(verdict, &laws);
        let mut advice = Vec::new();
        // with one velocity a nonlinear law cannot be distinguished from a frequency-independent
        // loss
        if !has_several_velocities && nonlinear > 1.0 - self.required_probability {
            advice.push(Advice::SecondVelocity { present: slowest });
        }
        if inflation > CORRELATED_FROM {
            advice.push(Advice::CorrelatedResidual { inflation });
        }
        Comparison {
            laws,
            decision,
            advice,
            nonlinear_probability: nonlinear,
            effective_samples,
            inflation,
            cell: self.cell,
        }
    }

    fn verdict(
        &self,
        laws: &[ComparedLaw],
        order: &[usize],
        has_several_velocities: bool,
    ) -> Decision {
        let least =
            (0..laws.len()).min_by(|a, b| laws[*a].chi_square.total_cmp(&laws[*b].chi_square));
        if let Some(best) = least
            && let Some(adequacy) = laws[best].adequacy
            && adequacy < self.adequacy_level
        {
            return Decision::NoneOfThese { best, adequacy };
        }
        let first = order[0];
        let probability = laws[first].probability;
        // total probability of the laws that remain in question
        let held = 1.0 - LEFT_OUT * (1.0 - self.required_probability);
        // an unsettled law matters only above this probability
        let counts = |index: usize| laws[index].probability > 1.0 - self.required_probability;
        if let Some(unsettled) = order.iter().find(|i| !laws[**i].is_settled && counts(**i)) {
            // if the most probable law is unsettled, its probability does not exclude the other
            // laws; only their own misfit does
            let explains = |index: usize| {
                !laws[first].is_settled
                    && laws[index]
                        .adequacy
                        .is_none_or(|adequacy| adequacy >= self.adequacy_level)
            };
            let possible = |index: usize| laws[index].probability > 1.0 - held;
            let left = |index: &usize| possible(*index) || explains(*index);
            return Decision::CannotTell {
                between: order.iter().copied().filter(left).collect(),
                reason: Doubt::Unsettled { law: *unsettled },
            };
        }
        if probability < self.required_probability {
            let mut sum = 0.0;
            let between = order
                .iter()
                .copied()
                .take_while(|index| {
                    let wanted = sum < held;
                    sum += laws[*index].probability;
                    wanted
                })
                .collect();
            return Decision::CannotTell {
                between,
                reason: Doubt::Probabilities {
                    first: probability,
                    required: self.required_probability,
                },
            };
        }
        if !laws[first].is_linear && !has_several_velocities {
            let flat = order.iter().copied().filter(|i| laws[*i].is_flat_loss);
            // if the level of the noise is not known, no misfit refutes a linear law
            let explains = flat
                .clone()
                .map(|index| (index, laws[index].adequacy.unwrap_or(1.0)))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            match explains {
                None => {
                    return Decision::CannotTell {
                        between: vec![first],
                        reason: Doubt::NoFlatLossCompetitor,
                    };
                }
                Some((linear, adequacy)) if adequacy >= self.adequacy_level => {
                    return Decision::CannotTell {
                        between: vec![first, linear],
                        reason: Doubt::OneVelocity { linear, adequacy },
                    };
                }
                Some(_) => {}
            }
        }
        Decision::Law {
            candidate: first,
            probability,
        }
    }
}

/// Adds the special cases that the data do not exclude, and that only the priors make less probable
/// than their general law.
fn with_special_cases(decision: Decision, laws: &[ComparedLaw]) -> Decision {
    let (mut between, reason) = match &decision {
        Decision::Law { candidate, .. } => (vec![*candidate], None),
        Decision::CannotTell { between, reason } => (between.clone(), Some(*reason)),
        Decision::NoneOfThese { .. } => return decision,
    };
    let n_before = between.len();
    let limits = between.iter().filter_map(|general| laws.get(*general));
    let names: Vec<&str> = limits
        .flat_map(|general| &general.limits)
        .map(|limit| limit.special.as_str())
        .collect();
    for (index, law) in laws.iter().enumerate() {
        if names.contains(&law.name.as_str()) && !between.contains(&index) {
            between.push(index);
        }
    }
    if between.len() == n_before {
        return decision;
    }
    Decision::CannotTell {
        between,
        reason: reason.unwrap_or(Doubt::SpecialCase),
    }
}
