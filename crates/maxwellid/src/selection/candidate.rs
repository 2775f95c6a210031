//! A model with the prior knowledge of its parameters.

use std::sync::Arc;

use crate::arrhenius::{self, Arrhenius};
use crate::catalogue::{Entry, Law};
use crate::error::{MaxwellidError, check_positive, check_range};
use crate::law::IdentifiableLaw;
use crate::linear::{LinearLaw, MaxwellBranches};
use crate::model::{RodModel, check_counts};
use crate::selection::Ground;
use crate::special_case::SpecialCase;

/// A model that takes part in a [`Selection`](super::Selection), with the prior of its parameters.
///
/// # Prior
/// Each parameter is normally distributed and independent of the others; its range is ±2 standard
/// deviations. A range is not a hard bound: an estimate outside is only less probable. The linear
/// limits κ = 1 and σ_ref/m = 0 are within the ranges. ln E has a standard deviation of
/// [`Candidate::LN_MODULUS_DEVIATION`] about the value from the time of flight.
#[derive(Debug, Clone)]
pub struct Candidate {
    pub(crate) model: Arc<dyn RodModel>,
    /// Ranges of the parameters except ln E; `None` for a range that follows from the duration of
    /// the record.
    pub(super) ranges: Vec<Option<(f64, f64)>>,
    law: Option<Law>,
    is_flat_loss: bool,
    weight: f64,
}

/// Normal prior of all parameters of a model, ln E first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Prior {
    pub(crate) mean: Vec<f64>,
    pub(crate) deviation: Vec<f64>,
}

impl Prior {
    /// Returns an uninformative prior with the same number of parameters.
    pub(crate) fn flat(&self) -> Self {
        Self {
            mean: vec![0.0; self.mean.len()],
            deviation: vec![f64::INFINITY; self.deviation.len()],
        }
    }
}

impl Candidate {
    /// Prior standard deviation of ln E: the time of flight is accurate to a few per cent, and the
    /// modulus of a dispersive law at its reference frequency differs from that of the front.
    pub const LN_MODULUS_DEVIATION: f64 = 0.15;

    /// Creates a candidate from a law of the catalogue, with its model, its
    /// [prior ranges](Law#prior-ranges) and equal weight.
    ///
    /// [`Law::Maxwell`] becomes one linear branch, solved in the Laplace domain, whose parameters
    /// are not those of a [`crate::Fit`] of this law.
    #[must_use]
    pub fn of(law: Law) -> Self {
        match law {
            Law::Maxwell => Self::of_entry(Entry::linear(MaxwellBranches::maxwell()), Some(law)),
            _ => Self::of_fit(law),
        }
    }

    /// Creates a candidate of the catalogue with the parameters that a fit reports: those of
    /// [`Self::of`], but with the viscosity for [`Law::Maxwell`].
    #[must_use]
    pub fn of_fit(law: Law) -> Self {
        Self::of_entry(law.entry().clone(), Some(law))
    }

    /// Creates a candidate from a linear law, with the ranges that the law states.
    #[must_use]
    pub fn linear(law: impl LinearLaw + 'static) -> Self {
        Self::of_entry(Entry::linear(law), None)
    }

    fn of_entry(entry: Entry, law: Option<Law>) -> Self {
        Self {
            model: entry.model,
            ranges: entry.ranges,
            law,
            is_flat_loss: entry.is_flat_loss,
            weight: 1.0,
        }
    }

    /// Creates a candidate from an inelastic law, started from its present shape; `shape_ranges`
    /// are the ranges of its parameters except the last, the rate. The range of the rate is from a
    /// relaxation time of a hundredth of the record to one of ten thousand records.
    ///
    /// # Errors
    /// [`MaxwellidError::InvalidRange`]; [`MaxwellidError::Setting`] unless there is one range per
    /// shape parameter.
    pub fn inelastic<L: IdentifiableLaw + 'static>(
        law: L,
        shape_ranges: &[(f64, f64)],
    ) -> Result<Self, MaxwellidError> {
        let expected = L::PARAMETERS.len().saturating_sub(1);
        if shape_ranges.len() != expected {
            return Err(MaxwellidError::Setting {
                setting: "number of ranges of shape parameters",
                value: shape_ranges.len() as f64,
                expected: "one for each parameter of the law but the last",
            });
        }
        for (name, range) in L::PARAMETERS.iter().zip(shape_ranges) {
            check_range(name, *range)?;
        }
        let rate = (!L::PARAMETERS.is_empty()).then_some(None);
        Ok(Self {
            ranges: shape_ranges.iter().copied().map(Some).chain(rate).collect(),
            model: Arc::new(law),
            law: None,
            is_flat_loss: false,
            weight: 1.0,
        })
    }

    /// Creates a candidate from any model; `ranges` are the ranges of its parameters except ln E.
    /// `is_flat_loss` is true for a linear model whose loss factor may be nearly constant over a
    /// decade.
    ///
    /// # Errors
    /// The errors of [`Self::inelastic`].
    pub fn of_model(
        model: Arc<dyn RodModel>,
        ranges: &[(f64, f64)],
        is_flat_loss: bool,
    ) -> Result<Self, MaxwellidError> {
        let names = model.parameter_names();
        if ranges.len() + 1 != names.len() {
            return Err(MaxwellidError::Setting {
                setting: "number of ranges of parameters",
                value: ranges.len() as f64,
                expected: "one for each parameter but ln E",
            });
        }
        for (name, range) in names.iter().skip(1).zip(ranges) {
            check_range(name, *range)?;
        }
        Ok(Self {
            ranges: ranges.iter().copied().map(Some).collect(),
            law: None,
            is_flat_loss: is_flat_loss && model.is_linear(),
            model,
            weight: 1.0,
        })
    }

    /// Makes the rates and relaxation times of the candidate thermally activated: its parameters
    /// are those at `reference_temperature` \[K\], followed by an activation energy of 20 to 300
    /// kJ/mol. A law without rates and times, such as that of constant Q, is returned unchanged.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless the temperature is finite and above 0.
    pub fn with_activation(self, reference_temperature: f64) -> Result<Self, MaxwellidError> {
        match Arrhenius::of(Arc::clone(&self.model), reference_temperature) {
            Ok(model) => Ok(Self {
                model: Arc::new(model),
                ranges: self
                    .ranges
                    .into_iter()
                    .chain([Some(arrhenius::RANGE)])
                    .collect(),
                ..self
            }),
            Err(MaxwellidError::NotActivated { .. }) => Ok(self),
            Err(error) => Err(error),
        }
    }

    /// Sets the prior probability relative to the other candidates; 1 by default.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless it is finite and above 0.
    pub fn with_prior_weight(self, weight: f64) -> Result<Self, MaxwellidError> {
        check_positive("prior weight of a model", weight)?;
        Ok(Self { weight, ..self })
    }

    /// Returns the laws of [`Law::STANDARD`]: the elastic rod, the three laws of paper D, and their
    /// linear competitors.
    #[must_use]
    pub fn standard() -> Vec<Self> {
        Law::STANDARD.map(Self::of).to_vec()
    }

    /// Returns the nonlinear laws with an equilibrium, which contain the nonlinear laws of
    /// [`Self::standard`] as special cases. [Add](super::Selection::with_further) them to compare
    /// them where a nonlinear law is in question.
    #[must_use]
    pub fn with_equilibrium() -> Vec<Self> {
        Law::WITH_EQUILIBRIUM.map(Self::of).to_vec()
    }

    /// Name of the model.
    #[must_use]
    pub fn name(&self) -> &str {
        self.model.name()
    }

    /// The law of the catalogue from which this candidate was created; `None` for any other model.
    #[must_use]
    pub fn law(&self) -> Option<Law> {
        self.law
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<dyn RodModel> {
        &self.model
    }

    /// Returns the parameters at which this candidate equals the candidate `special` with
    /// `parameters`, and the limit in words; `None` if this candidate does not contain `special`.
    #[must_use]
    pub fn at_limit(&self, special: &Self, parameters: &[f64]) -> Option<SpecialCase> {
        let branch = self.law.and_then(Law::of_branch);
        if branch.is_some() && branch == special.law {
            let (ln_modulus, of_law) = parameters.split_first()?;
            let (of_neighbours, limit) = self.law.map(Law::of_branch_alone)?;
            return Some(SpecialCase {
                parameters: std::iter::once(*ln_modulus)
                    .chain(of_neighbours)
                    .chain(of_law.iter().copied())
                    .collect(),
                limit: limit.to_owned(),
            });
        }
        let mut case = self.model.special_case(&special.model.prony(parameters)?)?;
        if self.model.needs_temperature()
            && special.model.needs_temperature()
            && let (Some(own), Some(energy)) = (case.parameters.last_mut(), parameters.last())
        {
            *own = *energy;
        }
        Some(case)
    }

    /// Returns true if the model is linear with a loss factor that may be flat.
    #[must_use]
    pub fn is_flat_loss(&self) -> bool {
        self.is_flat_loss
    }

    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// Ranges of all parameters, ln E first, for a modulus from the time of flight and a duration
    /// of the record \[s\].
    pub(crate) fn ranges(&self, modulus: f64, duration: f64) -> Vec<(f64, f64)> {
        let starts = self.model.starts(modulus, duration);
        let of_starts = |index: usize| {
            starts
                .iter()
                .filter_map(|start| start.get(index + 1))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(*value), high.max(*value))
                })
        };
        let half = 2.0 * Self::LN_MODULUS_DEVIATION;
        std::iter::once((modulus.ln() - half, modulus.ln() + half))
            .chain(
                self.ranges
                    .iter()
                    .enumerate()
                    .map(|(index, range)| range.unwrap_or_else(|| of_starts(index))),
            )
            .collect()
    }

    /// Accepts a candidate whose model is consistent and has a range for each parameter.
    pub(crate) fn check(&self, ground: &Ground) -> Result<(), MaxwellidError> {
        check_counts(self.model.as_ref(), ground.modulus, ground.duration)?;
        let expected = self.model.parameter_names().len();
        let found = 1 + self.ranges.len();
        if found != expected {
            return Err(MaxwellidError::InconsistentModel {
                model: self.name().to_owned(),
                what: "ranges including that of ln E",
                found,
                expected,
            });
        }
        Ok(())
    }

    pub(crate) fn prior(&self, modulus: f64, duration: f64) -> Prior {
        let ranges = self.ranges(modulus, duration);
        Prior {
            mean: ranges
                .iter()
                .map(|(low, high)| 0.5 * (low + high))
                .collect(),
            deviation: ranges
                .iter()
                .map(|(low, high)| 0.25 * (high - low))
                .collect(),
        }
    }

    /// Starting values of the parameters.
    pub(crate) fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>> {
        let mut starts = self.model.starts(modulus, duration);
        if self.model.is_linear() {
            // a linear law has one start; further ones follow from its prior by changes of one
            // parameter at a time
            let Prior { mean, deviation } = self.prior(modulus, duration);
            let first = starts.first().cloned().unwrap_or_default();
            let prior = mean.iter().zip(&deviation);
            for (index, (mean, deviation)) in prior.enumerate().skip(1) {
                for sign in [-1.0, 0.0, 1.0] {
                    let mut start = first.clone();
                    if let Some(parameter) = start.get_mut(index) {
                        *parameter = mean + sign * deviation;
                        starts.push(start);
                    }
                }
            }
        }
        starts
    }
}
