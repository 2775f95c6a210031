//! Fit of a law to moduli: the starting points, and the lowest of the minima found.

use super::data::ModulusData;
use super::fit::{FitOptions, RheologicalFit, enough};
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::least_squares::{Effort, minimise};
use super::model::{self, Model};
use super::order::PronyFit;
use super::power_law::PowerLawModel;
use super::profile::Elsewhere;
use super::prony::Prony;
use super::start::{self, Shape};
use crate::error::{CmodError, check_positive};

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
        macro_rules! linked {
            ($kind:ident, $model:expr, $starts:expr, $elsewhere:expr) => {{
                let model = $model?;
                let starts = match start {
                    Some(FittedLaw::$kind(own)) => vec![model.coordinates_of(own)],
                    _ => $starts,
                };
                let wrap = |at: &[f64]| Ok(FittedLaw::$kind(model.law_at(at)?));
                best_of(&model, data, &starts, $elsewhere, options, law, wrap)
            }};
        }
        let none = Vec::new;
        let (lowest, highest) = data.band();
        let middle = (lowest * highest).sqrt();
        let best = |shape, most| {
            let mut starts = start::of_one_relaxation(data, shape);
            starts.truncate(most);
            starts
        };
        let limits = |shape| start::at_the_limits(data, shape);
        match law {
            Law::Elastic => linked!(Elastic, model::elastic(), start::of_elastic(data), none()),
            Law::KelvinVoigt => {
                let starts = vec![start::of_kelvin_voigt(data)];
                linked!(KelvinVoigt, model::kelvin_voigt(), starts, none())
            }
            Law::ConstantQ => {
                let reference = match start {
                    Some(FittedLaw::ConstantQ(own)) => own.spring_pot().reference_omega(),
                    _ => middle,
                };
                let starts = vec![start::of_constant_q(data)];
                linked!(ConstantQ, model::constant_q(reference), starts, none())
            }
            Law::SpringPot => {
                let reference = match start {
                    Some(FittedLaw::SpringPot(own)) => own.reference_omega(),
                    _ => middle,
                };
                let starts = vec![start::of_spring_pot(data)];
                linked!(SpringPot, model::spring_pot(reference), starts, none())
            }
            Law::Maxwell => {
                let starts = start::of_fluid(data, &[1.0]);
                linked!(Maxwell, model::maxwell(), starts, none())
            }
            Law::FractionalMaxwell => {
                let starts = start::of_fluid(data, &[0.1, 0.3, 0.6, 0.9]);
                linked!(
                    FractionalMaxwell,
                    model::fractional_maxwell(),
                    starts,
                    none()
                )
            }
            Law::Zener => {
                let shape = Shape::Zener;
                linked!(Zener, model::zener(), best(shape, 1), limits(shape))
            }
            Law::FractionalZener => {
                let shape = Shape::FractionalZener;
                let model = model::fractional_zener();
                linked!(FractionalZener, model, best(shape, 2), limits(shape))
            }
            Law::HavriliakNegami => {
                let shape = Shape::HavriliakNegami;
                let model = model::havriliak_negami();
                linked!(HavriliakNegami, model, best(shape, 3), limits(shape))
            }
            Law::GeneralisedMaxwell => match start {
                Some(FittedLaw::GeneralisedMaxwell(own)) => {
                    let solid = own.equilibrium_modulus() > 0.0;
                    let model = Prony::new(solid, own.branches().len());
                    let at = Prony::coordinates(own.equilibrium_modulus(), own.branches());
                    let wrap = |at: &[f64]| Ok(FittedLaw::GeneralisedMaxwell(model.law_at(at)?));
                    best_of(&model, data, &[at], none(), options, law, wrap)
                }
                _ => Ok(PronyFit::new(data, options)?.fit),
            },
            Law::PowerLaw { density } => {
                let model = PowerLawModel::new(check_positive("density [kg/m^3]", density)?);
                let starts: Vec<_> = match start {
                    Some(own @ FittedLaw::PowerLaw(_)) => vec![own.coordinates()?],
                    _ => start::of_power_law(data, &model).into_iter().collect(),
                };
                let wrap = |at: &[f64]| Ok(FittedLaw::PowerLaw(model.law_at(at)));
                best_of(&model, data, &starts, none(), options, law, wrap)
            }
        }
    }
}

/// Minimises from all starting points and evaluates the best minimum.
fn best_of<M: Model>(
    model: &M,
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
    let sequence = 0..data.len();
    let scene = Scene {
        model,
        data,
        band: data.band(),
        sequences: std::slice::from_ref(&sequence),
        options,
        profiled_from: 0,
        ends_at_open: false,
        elsewhere: Elsewhere::new(data, elsewhere),
    };
    scene.judge(best, law, wrap)
}
