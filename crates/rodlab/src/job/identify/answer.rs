//! Answer of an identification: the remaining laws, and valid statements about their parameters.

use maxwellid::common_error::CommonErrorEstimate;
use maxwellid::recorder::RecorderCheck;
use maxwellid::selection::{ADEQUACY_LEVEL, ComparedLaw, Comparison, Decision};
use maxwellid::{ErrorOf, FitFlag, Law, RodModel};

use super::Found;
use super::laws::{FittedLaw, Standing};
use super::words::Shown;
use crate::outcome::Outcome;

/// Returns a small probability as text with two digits; a probability below the range of
/// floating-point numbers is 0.
fn probability(p: f64) -> String {
    if p < 1e-300 {
        "below 1e-300".to_owned()
    } else {
        format!("{p:.1e}")
    }
}

/// Laws that the data do not exclude, by their places in the comparison.
pub(super) enum Left {
    /// One law.
    One { law: usize, probability: f64 },
    /// Several laws that the data cannot distinguish, the most probable first.
    Several { laws: Vec<usize>, reason: String },
    /// The laws that remain after the comparison, followed by all other nonlinear laws. The recorder
    /// biases nonlinear laws, so none of them can be named or excluded.
    Biased { laws: Vec<usize> },
    /// No law; `best` is the best of the excluded laws.
    None { best: usize, adequacy: f64 },
    /// The laws were not compared.
    Unknown,
}

/// Errors of the transducers with which a law explains the data; without these errors no law
/// explains them.
pub(super) struct SuspectTransducers {
    /// The law.
    pub(super) law: Law,
    /// Probability of the misfit of the best law without these errors.
    pub(super) misfit: f64,
    pub(super) errors: Vec<CommonErrorEstimate>,
}

impl SuspectTransducers {
    fn in_words(&self) -> String {
        let of = |wanted: ErrorOf| self.errors.iter().find(|found| found.error.of == wanted);
        let mut found = Vec::new();
        if let Some(gain) = of(ErrorOf::ResponseGain) {
            found.push(format!(
                "a response that reads {:.4} ± {:.4} times the motion",
                1.0 + gain.value,
                gain.standard_error
            ));
        }
        if let Some(delay) = of(ErrorOf::Delay) {
            found.push(format!(
                "a delay of the response of {:.2} us ± {:.2} us",
                1e6 * delay.value,
                1e6 * delay.standard_error
            ));
        }
        format!(
            "With the transducers as stated, no law explains the data (if the law with the smallest misfit were true, such a misfit would have a probability of {}); with {}, the law {} does: check the transducers, and state their uncertainty as the ± of the channels",
            probability(self.misfit),
            found.join(" and "),
            self.law.name()
        )
    }
}

impl Left {
    /// Returns the laws left by the comparison. If the recorder biases nonlinear laws, none of them
    /// can be named or excluded. With a single impact velocity, they then also remain if the
    /// comparison left several linear laws.
    pub(super) fn of(
        comparison: Option<&Comparison>,
        is_biased: bool,
        has_several_velocities: bool,
    ) -> Self {
        let Some(comparison) = comparison else {
            return Self::Unknown;
        };
        let laws = &comparison.laws;
        let is_linear = |index: usize| laws.get(index).is_some_and(|law| law.is_linear);
        let with_nonlinear = |mut first: Vec<usize>| {
            for index in 0..laws.len() {
                if !is_linear(index) && !first.contains(&index) {
                    first.push(index);
                }
            }
            Self::Biased { laws: first }
        };
        match &comparison.decision {
            Decision::Law { candidate, .. } if is_biased && !is_linear(*candidate) => {
                with_nonlinear(vec![*candidate])
            }
            Decision::Law {
                candidate,
                probability,
            } => Self::One {
                law: *candidate,
                probability: *probability,
            },
            Decision::CannotTell { between, .. }
                if is_biased
                    && (!has_several_velocities
                        || between.iter().any(|index| !is_linear(*index))) =>
            {
                with_nonlinear(between.clone())
            }
            Decision::CannotTell { between, reason } => Self::Several {
                laws: between.clone(),
                reason: reason.to_string(),
            },
            // a biased law may have been excluded only because of its bias
            Decision::NoneOfThese { .. } if is_biased && laws.iter().any(|law| !law.is_linear) => {
                with_nonlinear(Vec::new())
            }
            Decision::NoneOfThese { best, adequacy } => Self::None {
                best: *best,
                adequacy: *adequacy,
            },
            other => Self::Several {
                laws: (0..laws.len()).collect(),
                reason: format!("the comparison ended with {other:?}"),
            },
        }
    }

    /// Returns the places of the remaining laws.
    pub(super) fn places(&self) -> &[usize] {
        match self {
            Self::One { law, .. } => std::slice::from_ref(law),
            Self::Several { laws, .. } | Self::Biased { laws } => laws,
            Self::None { .. } | Self::Unknown => &[],
        }
    }

    /// Returns the findings of the comparison about `law`, if the comparison excludes it.
    pub(super) fn excluded<'a>(
        &self,
        law: Law,
        comparison: Option<&'a Comparison>,
    ) -> Option<&'a ComparedLaw> {
        let mut laws = comparison?.laws.iter().enumerate();
        let (place, compared) = laws.find(|(_, compared)| compared.law == Some(law))?;
        (!self.places().contains(&place)).then_some(compared)
    }

    /// Returns the standing of the parameters of this law.
    pub(super) fn standing(
        &self,
        law: &FittedLaw,
        comparison: Option<&Comparison>,
        is_biased: bool,
    ) -> Standing {
        if is_biased && !law.law.is_linear() {
            return Standing::Biased;
        }
        let Some(compared) = self.excluded(law.law, comparison) else {
            return Standing::Possible;
        };
        // a law with an acceptable misfit is not rejected by the data; it is excluded because
        // another law is more probable
        let (excluded, misfit) = match compared.adequacy {
            Some(p) if p < ADEQUACY_LEVEL => ("rejected", probability(p)),
            Some(p) => ("less probable", format!("{p:.3}")),
            None => ("less probable", "not known".to_owned()),
        };
        Standing::Rejected(format!(
            "{excluded} (probability {:.3} among the laws, probability of such a misfit {misfit})",
            compared.probability
        ))
    }
}

/// Adds the first sentences, the verdict and the warnings.
pub(super) fn tell(found: &Found, outcome: &mut Outcome) {
    let biased: Vec<&RecorderCheck> = found.recorders.iter().filter(|r| r.is_biased()).collect();
    let is_biased = !biased.is_empty() || found.sensitive().next().is_some();
    tell_comparison(found, is_biased, outcome);
    for law in &found.laws {
        outcome.say(law.in_words());
        if law.standing == Standing::Possible {
            for flag in &law.flags {
                outcome.warn(format!("{}: {flag}", law.law.name()));
            }
        }
    }
    let is_shown =
        |law: &FittedLaw| Some(law.law) == found.profiled && law.standing == Standing::Possible;
    if found.laws.iter().any(is_shown) {
        for profile in &found.profiles {
            outcome.say(Shown::of(profile).in_words(profile));
        }
    }
    let asks_nonlinear =
        found.comparison.is_some() || found.laws.iter().any(|law| !law.law.is_linear());
    for check in biased.iter().filter(|_| asks_nonlinear) {
        outcome.warn(check.to_string());
    }
    for band in found.sensitive() {
        outcome.warn(format!(
            "{band}: the filter of the recorder biases the parameters of nonlinear laws; use a striker with a smoother pulse or a faster recorder"
        ));
    }
    let is_left = |law: &FittedLaw| !law.law.is_linear() && law.standing == Standing::Possible;
    let through_recorder = found
        .tests
        .iter()
        .any(|test| test.unfiltered_excitation().is_some());
    if through_recorder && found.laws.iter().any(is_left) {
        outcome.warn(
            "the recorder is part of the model: if a front rises faster than the recorder can follow, E of a nonlinear law may be wrong by another 0.1 %, which its error does not include \
             (found in virtual tests with a rigid contact)",
        );
    }
    tell_verdict(found, is_biased, outcome);
}

#[allow(
    clippy::indexing_slicing,
    reason = "a decision names the laws by their places in the comparison that it is of"
)]
fn tell_comparison(found: &Found, is_biased: bool, outcome: &mut Outcome) {
    let Some(comparison) = &found.comparison else {
        outcome.warn(
            "the laws were not compared: a good fit of one of them does not show that it is the law of the material",
        );
        return;
    };
    let name = |index: usize| comparison.laws[index].name.clone();
    let names = |laws: &[usize]| -> String {
        let names: Vec<String> = laws.iter().map(|index| name(*index)).collect();
        names.join(", ")
    };
    match &found.left {
        Left::One { law, .. } if found.is_without_damping(*law) => {
            outcome.say(format!(
                "The data cannot tell the laws elastic and {} apart: they do not determine the damping of the latter.",
                name(*law)
            ));
        }
        Left::One { law, probability } => outcome.say(format!(
            "The data support the law {} with a probability of {probability:.3}.",
            name(*law)
        )),
        Left::Several { laws, reason } => outcome.say(format!(
            "The data cannot tell the laws {} apart: {reason}.",
            names(laws)
        )),
        Left::Biased { laws } => {
            // because no nonlinear law is excluded, nonlinear laws with an equilibrium are not
            // excluded either
            let with_equilibrium = |place: &usize| {
                let law = comparison.laws.get(*place).and_then(|compared| compared.law);
                law.is_some_and(|law| Law::WITH_EQUILIBRIUM.contains(&law))
            };
            let others = if laws.iter().any(with_equilibrium) {
                ""
            } else {
                ", and nonlinear laws with an equilibrium"
            };
            outcome.say(format!(
                "The data cannot tell the laws {}{others} apart: the recorder biases nonlinear laws, so none of them can be named or excluded.",
                names(laws)
            ));
        }
        Left::None { best, adequacy } => outcome.say(format!(
            "None of the laws explains the data. The smallest misfit is that of {}; if this law were true, a misfit as large would have a probability of {}.",
            name(*best),
            probability(*adequacy),
        )),
        Left::Unknown => {}
    }
    for index in found.left.places() {
        let law = &comparison.laws[*index];
        if !law.limits.is_empty() {
            outcome.say(format!(
                "The data do not exclude this limit: {}.",
                law.with_limit()
            ));
        }
    }
    if is_biased
        && !found.several_velocities
        && let Left::One { law, .. } = &found.left
        && comparison.laws[*law].is_linear
    {
        outcome.say(
            "The bias of this recorder is part of the comparison of the nonlinear laws; only a test at another impact velocity can exclude them.",
        );
    }
    for advice in &comparison.advice {
        outcome.warn(advice.to_string());
    }
}

/// Ratio of the residual to the noise up to which a law explains the records.
const EXPLAINED: f64 = 1.3;

/// Returns the ratio of the residual to the noise, if it is larger than expected by chance.
fn residual_above(law: &FittedLaw) -> Option<f64> {
    law.flags.iter().find_map(|flag| match flag {
        FitFlag::ResidualAboveNoise { ratio } => Some(*ratio),
        _ => None,
    })
}

/// Warning that unstated differences in temperature between the tests may change the exponent of a
/// nonlinear law.
const UNSTATED_TEMPERATURES: &str = "The temperatures of the tests are not stated. If the tests at one velocity were a few kelvin warmer, their strain rate was higher, and the exponent of a nonlinear law absorbs this difference: repeat the first velocity at the end, and state `temperature` of each test.";

/// Returns the disagreement of a test with the others, if there is one.
fn disagreement(law: &FittedLaw) -> Option<&FitFlag> {
    let mut flags = law.flags.iter();
    flags.find(|flag| matches!(flag, FitFlag::TestDisagrees { .. }))
}

fn tell_verdict(found: &Found, is_biased: bool, outcome: &mut Outcome) {
    let is_none = matches!(found.left, Left::None { .. });
    let has_damping = |law: &FittedLaw| law.has_identified_damping();
    let stands = |law: &FittedLaw| law.standing == Standing::Possible && has_damping(law);
    let is_left = |linear: bool| match &found.comparison {
        None => {
            !linear
                && found
                    .laws
                    .iter()
                    .any(|law| law.standing == Standing::Biased)
        }
        Some(comparison) => found
            .left
            .places()
            .iter()
            .filter_map(|index| comparison.laws.get(*index))
            .any(|law| law.is_linear == linear),
    };
    let is_unsettled = |law: &&FittedLaw| law.standing == Standing::Possible && law.is_unsettled();
    let unsettled = found.laws.iter().find(is_unsettled);
    let not_settled = |law: &FittedLaw| {
        format!(
            "the fit of {} does not converge, so none of its parameters is stated",
            law.law.name()
        )
    };
    if !found.laws.iter().any(has_damping) {
        if let Some(law) = unsettled {
            outcome.refuse(not_settled(law));
            return;
        }
        let of_rod = if found.may_be_elastic() {
            "within their noise, the rod may be elastic"
        } else {
            "an elastic rod does not explain them, but many values of the damping fit them"
        };
        outcome.refuse(format!(
            "these data do not determine the damping of any law: {of_rod}"
        ));
        return;
    }
    if !found.laws.iter().any(stands) {
        let reason = if is_none {
            "none of the laws explains the data, so none of their parameters is a property of the material: the specimen, the instruments or their errors are not as stated, \
             or lateral inertia slows the short waves (state `diameter` and `poisson_ratio` of the specimen)"
                .to_owned()
        } else if is_biased && is_left(true) {
            format!(
                "the recorder biases the nonlinear laws, and these data do not determine the damping of any remaining linear law ({})",
                found.why_biased()
            )
        } else if is_biased {
            format!(
                "the recorder biases the nonlinear laws, and no other law remains: none of their parameters is identified ({})",
                found.why_biased()
            )
        } else if let Some(law) = unsettled {
            not_settled(law)
        } else {
            "the data do not determine the damping of any remaining law".to_owned()
        };
        outcome.refuse(reason);
        return;
    }
    let is_nonlinear = |law: &FittedLaw| stands(law) && !law.law.is_linear();
    if let Some(transducers) = &found.transducers {
        // the identification of a linear law depends only on the ratio of the two records, not on
        // the scale of the motion
        if found.laws.iter().any(is_nonlinear) {
            outcome.doubt(transducers.in_words());
        } else {
            outcome.warn(transducers.in_words());
        }
    }
    // residuals of the remaining laws; `None` if one of these laws explains the records
    let above: Option<Vec<f64>> = found
        .laws
        .iter()
        .filter(|law| stands(law))
        .map(residual_above)
        .collect();
    let least = above.map(|above| above.into_iter().fold(f64::INFINITY, f64::min));
    if let Some(least) = least.filter(|least| *least > EXPLAINED) {
        outcome.doubt(format!(
            "no remaining law explains the records within their noise, and the best one leaves a residual of {least:.2} times the noise: the specimen, the instruments or their \
             errors are not as stated"
        ));
    }
    if found.several_velocities
        && !found.temperatures_are_stated
        && found.laws.iter().any(is_nonlinear)
    {
        outcome.warn(UNSTATED_TEMPERATURES);
    }
    // disagreements of the tests; `None` if the tests agree on one of the remaining laws
    let disagreements: Option<Vec<&FitFlag>> = found
        .laws
        .iter()
        .filter(|law| stands(law))
        .map(disagreement)
        .collect();
    if let Some(disagreement) = disagreements.and_then(|flags| flags.first().copied()) {
        outcome.doubt(format!(
            "the tests contradict each other for every remaining law ({disagreement}): the specimens, their temperatures, the lengths or the transducers differ between the \
             tests by more than their stated errors"
        ));
    }
    if is_biased && is_left(false) {
        let why = found.why_biased();
        outcome.warn(format!("Nonlinear laws are not identified: {why}. Use a striker with a smoother pulse or a faster recorder."));
    }
}
