//! A law fitted to all tests: its parameters with errors and verdicts.

use std::sync::Arc;

use maxwellid::common_error::CommonErrorEstimate;
use maxwellid::profile::Profile;
use maxwellid::recorder::{NarrowedBand, RecorderCheck};
use maxwellid::selection::{Candidate, Comparison};
use maxwellid::{
    DEFAULT_CELL, Estimate, Fit, FitFlag, Identification, Law, Noise, RodModel, RodTest, Role,
    Scale, SpecimenUncertainty, Verdict,
};

use super::{IdentifySheet, words};
use crate::outcome::{Outcome, Quantity, finite, shown_unit};
use crate::{InStep, RodlabError};

/// Standing of the parameters of a law.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Standing {
    /// The law is possible.
    Possible,
    /// The data reject the law.
    Rejected(String),
    /// The law is nonlinear, and the recorder biases its parameters.
    Biased,
}

/// A law at the minimum of its fit.
pub(super) struct FittedLaw {
    pub(super) law: Law,
    pub(super) standing: Standing,
    pub(super) estimates: Vec<Estimate>,
    pub(super) flags: Vec<FitFlag>,
    /// Root mean square of simulated minus measured response, relative to the impact velocity.
    pub(super) relative_error: f64,
    /// Most likely errors of rods and transducers.
    common_errors: Vec<CommonErrorEstimate>,
    /// Simulated minus measured response, divided by the impact velocity; one list per test.
    pub(super) residuals: Vec<Vec<f64>>,
    parameters: Vec<f64>,
    termination: String,
    starts: usize,
    skips: usize,
}

/// Returns the parameters of the law at which the comparison found the highest likelihood, in the
/// parametrisation of the fit. Fit and comparison may use different parametrisations of the same
/// law.
fn found_by(comparison: &Comparison, [of_fit, of_comparison]: [&Candidate; 2]) -> Option<Vec<f64>> {
    let mut laws = comparison.laws.iter();
    let compared = laws.find(|compared| compared.law == of_fit.law())?;
    if compared.parameter_names == of_fit.model().parameter_names() {
        return Some(compared.likeliest.clone());
    }
    // converts the parameters between the two parametrisations of the law
    let case = of_fit.at_limit(of_comparison, &compared.likeliest)?;
    Some(case.parameters)
}

/// A fitted model.
pub(super) type Identified = Identification<Arc<dyn RodModel>>;

/// Fit of a law. It starts from the result of the comparison, if there is one.
pub(super) struct LawFit {
    law: Law,
    candidate: Candidate,
    fit: Fit<Arc<dyn RodModel>>,
}

impl LawFit {
    /// Prepares the fit with the `cell` \[m\] of the sheet. A rejected law keeps the grid of the
    /// comparison, because it has no errors from which a grid could be chosen.
    pub(super) fn of(
        (law, sheet): (Law, &IdentifySheet),
        cell: Option<f64>,
        comparison: Option<&Comparison>,
        is_rejected: bool,
    ) -> Result<Self, RodlabError> {
        let candidate = sheet.activated(Candidate::of_fit(law))?;
        let of_comparison = sheet.activated(Candidate::of(law))?;
        let mut fit = Fit::of(Arc::clone(candidate.model()));
        if let Some(cell) = cell.or(is_rejected.then_some(DEFAULT_CELL)) {
            fit = fit.with_cell(cell);
        }
        let found = comparison.and_then(|found| found_by(found, [&candidate, &of_comparison]));
        if let Some(start) = found {
            fit = fit.only_from(start);
        }
        Ok(Self {
            law,
            candidate,
            fit,
        })
    }

    pub(super) fn law(&self) -> Law {
        self.law
    }

    fn refused(&self) -> impl Fn(maxwellid::MaxwellidError) -> RodlabError + use<> {
        let what = format!("the law {}", self.law.name());
        move |error| RodlabError::step(what.as_str(), error)
    }

    pub(super) fn fitted(&self, tests: &[RodTest]) -> Result<Identified, RodlabError> {
        self.fit.to(tests).map_err(self.refused())
    }

    /// Returns the estimate on a narrower band, for comparison with `identified`.
    pub(super) fn on_narrowed_band(
        &self,
        identified: &Identified,
        tests: &[RodTest],
        recorders: &[RecorderCheck],
    ) -> Result<NarrowedBand, RodlabError> {
        let cutoffs: Vec<Option<f64>> = recorders.iter().map(|r| Some(r.cutoff_hz)).collect();
        self.fit
            .on_narrowed_band(identified, tests, &cutoffs)
            .map_err(self.refused())
    }

    /// Returns the law at the lowest minimum, together with its profiles. The computation of the
    /// profiles may find a lower minimum than `found`.
    pub(super) fn with_profiles(
        &self,
        found: &Identified,
        tests: &[RodTest],
    ) -> Result<(FittedLaw, Vec<Profile>), RodlabError> {
        let fit = self.fit.clone().continuing(found);
        let (identified, profiles) = fit
            .with_profiles(&self.candidate, tests)
            .in_step("profile likelihoods")?;
        Ok((FittedLaw::of(self.law, &identified), profiles))
    }
}

impl FittedLaw {
    /// Returns the parameters at the minimum, ln E first.
    pub(super) fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Returns the law with the errors due to an uncertain specimen added to the errors of its
    /// parameters.
    pub(super) fn with_specimen_uncertainty(mut self, specimen: &SpecimenUncertainty) -> Self {
        let with_specimen = |estimate: Estimate| estimate.with_specimen_uncertainty(specimen);
        self.estimates = self.estimates.into_iter().map(with_specimen).collect();
        self
    }

    pub(super) fn of(law: Law, identified: &Identified) -> Self {
        let estimates = identified
            .identifiability(Noise::Stated)
            .map(|found| found.estimates)
            .unwrap_or_default();
        Self {
            law,
            standing: Standing::Possible,
            estimates,
            flags: identified.flags().to_vec(),
            relative_error: identified.relative_error(),
            common_errors: identified.common_errors().to_vec(),
            residuals: identified.residuals().map(<[f64]>::to_vec).collect(),
            parameters: identified.parameters().to_vec(),
            termination: identified.termination().to_string(),
            starts: identified.starts().len(),
            skips: identified.cycle_skips_left(),
        }
    }

    /// Returns true if the fit of parameters and excitation has not converged; then no parameter is
    /// stated.
    pub(super) fn is_unsettled(&self) -> bool {
        self.flags.contains(&FitFlag::Unsettled)
    }

    /// Returns true if the data determine the damping in addition to the modulus, whatever the
    /// standing of the law is.
    pub(super) fn has_identified_damping(&self) -> bool {
        self.estimates
            .iter()
            .skip(1)
            .any(|e| e.role == Role::Coordinate && e.verdict == Verdict::Identified)
    }

    /// Returns true if the law is nonlinear and its damping is reported as that of the material.
    pub(super) fn is_stated_nonlinear(&self) -> bool {
        !self.law.is_linear()
            && self.standing == Standing::Possible
            && self.has_identified_damping()
    }

    /// Returns true if a profile may show more than the linearised errors do.
    pub(super) fn is_worth_profiles(&self) -> bool {
        let curved = |flag: &FitFlag| matches!(flag, FitFlag::Curved { .. } | FitFlag::Unsettled);
        self.has_identified_damping() || self.flags.iter().any(curved)
    }

    /// Returns one sentence about the law.
    pub(super) fn in_words(&self) -> String {
        let difference = format!(
            "simulated and measured response differ by {:.2} % of the impact velocity (root mean square)",
            100.0 * self.relative_error
        );
        match &self.standing {
            Standing::Rejected(reason) => {
                return format!("{}: {reason}; {difference}.", self.law.name());
            }
            Standing::Biased => {
                return format!(
                    "{}: its parameters are not identified, because the recorder biases them; {difference}.",
                    self.law.name()
                );
            }
            Standing::Possible => {}
        }
        if self.estimates.is_empty() {
            return format!(
                "{}: the errors of its parameters could not be determined.",
                self.law.name()
            );
        }
        let parameters: Vec<String> = self
            .estimates
            .iter()
            .filter(|estimate| estimate.role == Role::Coordinate)
            .map(words::of_estimate)
            .collect();
        format!(
            "{}: {}; {difference}.",
            self.law.name(),
            parameters.join("; ")
        )
    }

    /// Adds the quantities and log entries of the law.
    pub(super) fn tell(&self, outcome: &mut Outcome) {
        for estimate in &self.estimates {
            outcome.quantities.push(self.quantity(estimate));
        }
        outcome.quantities.push(Quantity::of(
            format!("{}: difference of the responses", self.law.name()),
            "%",
            100.0 * self.relative_error,
            "root mean square, relative to the impact velocity",
        ));
        let mut ended = self.termination.to_string();
        for (count, what) in [
            (self.starts, "starts tried"),
            (self.skips, "rejected minima of another period"),
        ] {
            if count > 0 {
                ended += &format!("; {what}: {count}");
            }
        }
        let errors = self.common_errors.iter().map(ToString::to_string);
        let remarks = std::iter::once(ended).chain(errors);
        outcome.accept(format!("fit of the law {}", self.law.name()), remarks);
    }

    fn quantity(&self, estimate: &Estimate) -> Quantity {
        let error = match estimate.scale {
            Scale::Ratio => estimate.value.abs() * estimate.standard_error,
            Scale::Difference => estimate.standard_error,
        };
        let verdict = match (&self.standing, estimate.role) {
            (Standing::Rejected(reason), _) => reason.clone(),
            (Standing::Biased, _) => "not identified: the recorder biases it".to_owned(),
            (Standing::Possible, Role::Derived) => format!("derived; {}", estimate.verdict),
            (Standing::Possible, Role::Coordinate) => estimate.verdict.to_string(),
        };
        let is_possible = self.standing == Standing::Possible;
        let name = format!("{}: {} {}", self.law.name(), estimate.name, estimate.symbol);
        let (unit, value) = (shown_unit(estimate.unit), finite(estimate.value));
        Quantity::of(name, unit, value, verdict)
            .with_error(finite(error))
            .valid_if(is_possible && estimate.verdict == Verdict::Identified)
    }
}
