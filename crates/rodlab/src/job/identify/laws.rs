//! A law fitted to all tests: its parameters with errors and verdicts.

use maxwellid::{
    Estimate, Fit, FitFlag, IdentifiableLaw, Noise, RodTest, Role, Scale, SpecimenUncertainty,
    Verdict,
};
use rodwave::inelastic::{
    DEFAULT_REFERENCE_STRESS, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};

use super::{LawName, words};
use crate::RodlabError;
use crate::outcome::{LogEntry, Outcome, Quantity};

/// A law at its minimum.
pub(super) struct FittedLaw {
    pub(super) name: String,
    pub(super) estimates: Vec<Estimate>,
    pub(super) flags: Vec<FitFlag>,
    /// Root mean square of simulated minus measured response, as a share of the impact velocity.
    pub(super) relative_error: f64,
    /// Simulated minus measured response over the impact velocity, a slice for each test.
    pub(super) residuals: Vec<Vec<f64>>,
    termination: String,
    starts: usize,
    skips: usize,
}

pub(super) fn fit(
    law: LawName,
    cell: Option<f64>,
    tests: &[RodTest],
) -> Result<FittedLaw, RodlabError> {
    let refused = |error| RodlabError::step("laws", error);
    // the rate is scanned; the shapes are those from which paper D starts
    match law {
        LawName::Maxwell => of(Maxwell::new(1e6).map_err(refused)?, cell, tests),
        LawName::Norton => of(
            MaxwellNorton::from_reference_rate(1.5, 1.0, DEFAULT_REFERENCE_STRESS)
                .map_err(refused)?,
            cell,
            tests,
        ),
        LawName::GurevichRabinovich => of(
            MaxwellGurevichRabinovich::from_reference_rate(1.0, 1.0, DEFAULT_REFERENCE_STRESS)
                .map_err(refused)?,
            cell,
            tests,
        ),
    }
}

fn of<L: IdentifiableLaw + 'static>(
    law: L,
    cell: Option<f64>,
    tests: &[RodTest],
) -> Result<FittedLaw, RodlabError> {
    let fit = match cell {
        Some(cell) => Fit::of(law).with_cell(cell),
        None => Fit::of(law),
    };
    let identified = fit
        .to(tests)
        .map_err(|error| RodlabError::step(format!("the law {}", L::NAME), error))?;
    let estimates = identified
        .identifiability(Noise::Stated)
        .map(|found| found.estimates)
        .unwrap_or_default();
    Ok(FittedLaw {
        name: L::NAME.to_owned(),
        estimates,
        flags: identified.flags().to_vec(),
        relative_error: identified.relative_error(),
        residuals: identified.residuals().map(<[f64]>::to_vec).collect(),
        termination: identified.termination().to_string(),
        starts: identified.starts().len(),
        skips: identified.cycle_skips_left(),
    })
}

impl FittedLaw {
    /// The law with the errors by an uncertain specimen in those of its parameters.
    pub(super) fn with_specimen_uncertainty(mut self, specimen: &SpecimenUncertainty) -> Self {
        let with_specimen = |estimate: Estimate| estimate.with_specimen_uncertainty(specimen);
        self.estimates = self.estimates.into_iter().map(with_specimen).collect();
        self
    }

    /// Whether the data determine more than the modulus.
    pub(super) fn has_identified_damping(&self) -> bool {
        self.estimates
            .iter()
            .skip(1)
            .any(|e| e.role == Role::Coordinate && e.verdict == Verdict::Identified)
    }

    /// One sentence.
    pub(super) fn in_words(&self) -> String {
        if self.estimates.is_empty() {
            return format!(
                "{}: the errors of its parameters could not be found.",
                self.name
            );
        }
        let parameters: Vec<String> = self
            .estimates
            .iter()
            .filter(|estimate| estimate.role == Role::Coordinate)
            .map(words::of_estimate)
            .collect();
        format!(
            "{}: {}; simulated and measured response differ by {:.2} % of the impact velocity (root mean square).",
            self.name,
            parameters.join("; "),
            100.0 * self.relative_error
        )
    }

    /// Quantities and log.
    pub(super) fn tell(&self, outcome: &mut Outcome) {
        for estimate in &self.estimates {
            outcome.quantities.push(self.quantity(estimate));
        }
        outcome.quantities.push(Quantity {
            name: format!("{}: difference of the responses", self.name),
            unit: "%".to_owned(),
            value: Some(100.0 * self.relative_error),
            standard_error: None,
            valid: true,
            verdict: "root mean square, in parts of the impact velocity".to_owned(),
        });
        outcome.log.push(LogEntry {
            what: format!("fit of the law {}", self.name),
            accepted: true,
            reasons: vec![format!(
                "{}; starts: {}; minima of another period left: {}",
                self.termination, self.starts, self.skips
            )],
        });
    }

    fn quantity(&self, estimate: &Estimate) -> Quantity {
        let error = match estimate.scale {
            Scale::Ratio => estimate.value.abs() * estimate.standard_error,
            Scale::Difference => estimate.standard_error,
        };
        let identified = estimate.verdict == Verdict::Identified;
        Quantity {
            name: format!("{}: {} {}", self.name, estimate.name, estimate.symbol),
            unit: if estimate.unit == "1" {
                String::new()
            } else {
                estimate.unit.to_owned()
            },
            value: Some(estimate.value).filter(|value| value.is_finite()),
            standard_error: Some(error).filter(|error| error.is_finite()),
            valid: identified,
            verdict: match estimate.role {
                Role::Derived => format!("derived; {}", estimate.verdict),
                Role::Coordinate => estimate.verdict.to_string(),
            },
        }
    }
}
