//! Fit of a law to moduli: the starting points, and the lowest of the minima found.

use super::data::ModulusData;
use super::fit::{FitOptions, RheologicalFit, enough};
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::least_squares::{Effort, minimise};
use super::model::Model;
use super::order::PronyFit;
use super::profile::Elsewhere;
use crate::error::CmodError;

impl RheologicalFit {
    /// Fits `law` to `data`. The starting points are the best points of a grid.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer values (two per line) than parameters, or for as
    /// many values as parameters if the errors follow from the residual; [`CmodError::NonPhysical`]
    /// for a density or a confidence level outside its range; [`CmodError::NoLaw`] if no starting
    /// point has a finite χ².
    pub fn new(data: &ModulusData, law: Law, options: &FitOptions) -> Result<Self, CmodError> {
        Self::of_law(data, law, None, options)
    }

    /// Fits the law of `start`, starting from its parameters. A Prony series keeps its number of
    /// branches.
    ///
    /// Only one minimisation is performed, without a search for other minima. Use this function for
    /// data that are similar to the data of a previous fit.
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn from_start(
        data: &ModulusData,
        start: &FittedLaw,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        Self::of_law(data, start.law(), Some(start), options)
    }

    fn of_law(
        data: &ModulusData,
        law: Law,
        start: Option<&FittedLaw>,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        if !law.is_defined_on(data) {
            return Err(CmodError::LawOverTime {
                law: law.to_string(),
            });
        }
        let (lowest, highest) = data.band();
        let middle = Some((lowest * highest).sqrt());
        let (model, reference_omega, starts) = match start {
            Some(own) => (own.model()?, own.reference_omega(), vec![own.coordinates()]),
            None if law == Law::GeneralisedMaxwell => return Ok(PronyFit::new(data, options)?.fit),
            None => (law.model(0, middle)?, middle, law.starts(data)),
        };
        let wrap = |at: &[f64]| law.at_coordinates(at, reference_omega);
        best_of(&*model, data, &starts, law.limits(data), options, law, wrap)
    }
}

/// Minimises from all starting points and evaluates the best minimum.
fn best_of(
    model: &dyn Model,
    data: &ModulusData,
    starts: &[Vec<f64>],
    mut elsewhere: Vec<Vec<f64>>,
    options: &FitOptions,
    law: Law,
    wrap: impl Fn(&[f64]) -> Result<FittedLaw, CmodError>,
) -> Result<RheologicalFit, CmodError> {
    let options = options.checked()?;
    enough(data, model.kinds().len(), options.error_scale)?;
    let minima = starts
        .iter()
        .filter_map(|start| minimise(model, data, start, None, Effort::Full));
    let mut minima: Vec<_> = minima.collect();
    minima.sort_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared));
    elsewhere.extend(minima.iter().skip(1).map(|other| other.at.clone()));
    let best = minima.into_iter().next().ok_or_else(|| CmodError::NoLaw {
        law: law.to_string(),
    })?;
    let scene = Scene {
        elsewhere: Elsewhere::new(data, elsewhere),
        ..Scene::new(model, data, options)
    };
    scene.judge(best, law, wrap)
}
