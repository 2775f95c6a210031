//! A law fitted to moduli, with the errors of its parameters and what the residuals say of it.

use std::fmt;

use num_complex::Complex64;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use super::data::ModulusData;
use super::information::Information;
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::least_squares::{Effort, Ending, count, minimise};
use super::model::{self, Model};
use super::order::PronyFit;
use super::parameter::{CommonShift, Parameter};
use super::power_law::PowerLawModel;
use super::prony::Prony;
use super::start::{self, Shape};
use super::whiteness::Whiteness;
use crate::error::{CmodError, check_positive};
pub use crate::recovery::fit::ErrorScale;

/// By what laws, and orders of a Prony series, are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Criterion {
    /// χ² + p ln n (Schwarz): finds the true order where there is one.
    #[default]
    Bic,
    /// χ² + 2p + 2p(p + 1)/(n - p - 1) (Akaike, Hurvich & Tsai): best prediction, rather too many branches than too few.
    Aicc,
}

impl Criterion {
    pub(super) fn of(self, aicc: f64, bic: f64) -> f64 {
        match self {
            Self::Bic => bic,
            Self::Aicc => aicc,
        }
    }
}

/// Settings of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FitOptions {
    /// What the standard errors rest on.
    pub error_scale: ErrorScale,
    /// Level of the confidence intervals, between 0 and 1.
    pub confidence: f64,
    /// By what the order of a Prony series is chosen.
    pub criterion: Criterion,
    /// Whether profiles are computed where the linearised interval is not to be believed. Without them such a parameter counts as
    /// not identifiable.
    pub profiles: bool,
}

impl Default for FitOptions {
    /// Stated errors, 95 %, BIC, with profiles.
    fn default() -> Self {
        Self {
            error_scale: ErrorScale::Stated,
            confidence: 0.95,
            criterion: Criterion::Bic,
            profiles: true,
        }
    }
}

impl FitOptions {
    /// With another foundation of the standard errors.
    #[must_use]
    pub fn with_error_scale(self, error_scale: ErrorScale) -> Self {
        Self {
            error_scale,
            ..self
        }
    }

    /// With another level of the confidence intervals.
    #[must_use]
    pub fn with_confidence(self, confidence: f64) -> Self {
        Self { confidence, ..self }
    }

    /// With another criterion.
    #[must_use]
    pub fn with_criterion(self, criterion: Criterion) -> Self {
        Self { criterion, ..self }
    }

    /// With or without profiles.
    #[must_use]
    pub fn with_profiles(self, profiles: bool) -> Self {
        Self { profiles, ..self }
    }

    pub(super) fn checked(self) -> Result<Self, CmodError> {
        if self.confidence > 0.0 && self.confidence < 1.0 {
            Ok(self)
        } else {
            Err(CmodError::NonPhysical {
                quantity: "level of confidence",
                value: self.confidence,
                expected: "a value between 0 and 1",
            })
        }
    }

    /// Quantile by which a standard error is multiplied.
    pub(super) fn quantile(&self, degrees_of_freedom: usize) -> f64 {
        let probability = 0.5 * (1.0 + self.confidence);
        match self.error_scale {
            ErrorScale::FromResidual => StudentsT::new(0.0, 1.0, count(degrees_of_freedom))
                .map_or(f64::NAN, |student| student.inverse_cdf(probability)),
            _ => Normal::standard().inverse_cdf(probability),
        }
    }
}

/// How χ² and the number of parameters weigh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scores {
    pub(super) aicc: f64,
    pub(super) bic: f64,
}

impl Scores {
    /// With errors from the residual the scatter is one parameter more, and -2 ln L is n ln(χ²/n).
    pub(super) fn of(
        scale: ErrorScale,
        chi_squared: f64,
        values: usize,
        parameters: usize,
    ) -> Self {
        let n = count(values);
        let (deviance, p) = match scale {
            ErrorScale::FromResidual => (n * (chi_squared / n).ln(), count(parameters + 1)),
            _ => (chi_squared, count(parameters)),
        };
        let left = n - p - 1.0;
        Self {
            aicc: if left > 0.0 {
                deviance + 2.0 * p + 2.0 * p * (p + 1.0) / left
            } else {
                f64::INFINITY
            },
            bic: deviance + p * n.ln(),
        }
    }
}

/// A law fitted by weighted least squares.
///
/// χ² = Σ δᵀC⁻¹δ over the lines, with δ = (Re, Im) of the law minus the measured modulus and C the covariance of the line, is
/// minimised in coordinates that keep every parameter in its range, with exact derivatives. Errors are of first order
/// at the minimum; where they are large, intervals and verdicts come from profiles of χ².
///
/// Weights, χ² and the whiteness of the residuals are those of the random errors. [Common errors](ModulusData::with_common_errors)
/// shift the parameters by g_s = J⁺W δE_s (J the whitened Jacobian, W the whitening), and the covariance of the parameters is
/// C_random + Σ_s g_s g_sᵀ: more lines do not lessen it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct RheologicalFit {
    /// The law at the minimum.
    pub law: FittedLaw,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Covariance of the parameters by random and common errors, each on its [`Scale`](super::Scale), by rows; `None` if a
    /// combination of them is not determined at all.
    pub covariance: Option<Vec<Vec<f64>>>,
    /// Its part by the random errors.
    pub random_covariance: Option<Vec<Vec<f64>>>,
    /// Its part by common errors, one vector for each source.
    pub common_errors: Vec<CommonShift>,
    /// Singular values of the whitened Jacobian, descending: by how many standard errors of the data the law changes along each
    /// of the `directions`.
    pub signal_to_noise: Vec<f64>,
    /// Unit vectors in the scales of the parameters, one for each singular value.
    pub directions: Vec<Vec<f64>>,
    /// χ² with the stated errors.
    pub chi_squared: f64,
    /// Two for each line, less the number of singular values above 0.
    pub degrees_of_freedom: usize,
    /// What the standard errors rest on.
    pub error_scale: ErrorScale,
    /// Factor of the random variances: 1, or χ²/ν for errors from the residual; times (ν - 2)/(ν - 4) where the variances of the lines
    /// are estimates with ν degrees of freedom, for the scatter of the weights.
    pub variance_factor: f64,
    /// Corrected Akaike information criterion, up to a constant of the data.
    pub aicc: f64,
    /// Bayesian information criterion, up to the same constant.
    pub bic: f64,
    /// Whitened residuals, law minus measured: two for each line.
    pub residuals: Vec<f64>,
    /// Whether they are noise.
    pub whiteness: Whiteness,
    /// Why the iteration ended.
    pub ending: Ending,
    /// Variance of χ² by that of known errors.
    pub(super) dispersion: f64,
    pub(super) information: Information,
    pub(super) coordinates: Vec<f64>,
}

impl RheologicalFit {
    /// Fits `law` to `data`; the starts are the best points of a grid.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer values (two a line) than parameters, or no more where the residual shall tell the
    /// errors; [`CmodError::NonPhysical`] for a density or a level of confidence out of its range; [`CmodError::NoLaw`] if
    /// no start has a finite χ².
    pub fn new(data: &ModulusData, law: Law, options: &FitOptions) -> Result<Self, CmodError> {
        match law {
            Law::KelvinVoigt => {
                let model = model::kelvin_voigt()?;
                let starts = vec![start::of_kelvin_voigt(data)];
                let wrap = |at: &[f64]| Ok(FittedLaw::KelvinVoigt(model.law_at(at)?));
                best_of(&model, data, &starts, options, law, wrap)
            }
            Law::Zener => {
                let model = model::zener()?;
                let starts = start::of_one_relaxation(data, Shape::Zener);
                let wrap = |at: &[f64]| Ok(FittedLaw::Zener(model.law_at(at)?));
                best_of(&model, data, &starts, options, law, wrap)
            }
            Law::FractionalZener => {
                let model = model::fractional_zener()?;
                let mut starts = start::of_one_relaxation(data, Shape::FractionalZener);
                starts.truncate(2);
                let wrap = |at: &[f64]| Ok(FittedLaw::FractionalZener(model.law_at(at)?));
                best_of(&model, data, &starts, options, law, wrap)
            }
            Law::HavriliakNegami => {
                let model = model::havriliak_negami()?;
                let mut starts = start::of_one_relaxation(data, Shape::HavriliakNegami);
                starts.truncate(3);
                let wrap = |at: &[f64]| Ok(FittedLaw::HavriliakNegami(model.law_at(at)?));
                best_of(&model, data, &starts, options, law, wrap)
            }
            Law::GeneralisedMaxwell => Ok(PronyFit::new(data, options)?.fit),
            Law::PowerLaw { density } => {
                let model = PowerLawModel::new(check_positive("density [kg/m^3]", density)?);
                let starts: Vec<_> = start::of_power_law(data, &model).into_iter().collect();
                let wrap = |at: &[f64]| Ok(FittedLaw::PowerLaw(model.law_at(at)));
                best_of(&model, data, &starts, options, law, wrap)
            }
        }
    }

    /// Fits the law that `start` is, with its number of branches if it is a Prony series, from its parameters.
    ///
    /// One minimisation, without a search for others: for data like those fitted before.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn from_start(
        data: &ModulusData,
        start: &FittedLaw,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        let law = start.law();
        match start {
            FittedLaw::KelvinVoigt(own) => {
                let model = model::kelvin_voigt()?;
                let wrap = |at: &[f64]| Ok(FittedLaw::KelvinVoigt(model.law_at(at)?));
                best_of(
                    &model,
                    data,
                    &[model.coordinates_of(own)],
                    options,
                    law,
                    wrap,
                )
            }
            FittedLaw::Zener(own) => {
                let model = model::zener()?;
                let wrap = |at: &[f64]| Ok(FittedLaw::Zener(model.law_at(at)?));
                best_of(
                    &model,
                    data,
                    &[model.coordinates_of(own)],
                    options,
                    law,
                    wrap,
                )
            }
            FittedLaw::FractionalZener(own) => {
                let model = model::fractional_zener()?;
                let wrap = |at: &[f64]| Ok(FittedLaw::FractionalZener(model.law_at(at)?));
                best_of(
                    &model,
                    data,
                    &[model.coordinates_of(own)],
                    options,
                    law,
                    wrap,
                )
            }
            FittedLaw::HavriliakNegami(own) => {
                let model = model::havriliak_negami()?;
                let wrap = |at: &[f64]| Ok(FittedLaw::HavriliakNegami(model.law_at(at)?));
                best_of(
                    &model,
                    data,
                    &[model.coordinates_of(own)],
                    options,
                    law,
                    wrap,
                )
            }
            FittedLaw::GeneralisedMaxwell(own) => {
                let solid = own.equilibrium_modulus() > 0.0;
                let model = Prony::new(solid, own.branches().len());
                let at = Prony::coordinates(own.equilibrium_modulus(), own.branches());
                let wrap = |at: &[f64]| Ok(FittedLaw::GeneralisedMaxwell(model.law_at(at)?));
                best_of(&model, data, &[at], options, law, wrap)
            }
            FittedLaw::PowerLaw(own) => {
                let model = PowerLawModel::new(own.density);
                let at = vec![
                    own.damping_factor.ln(),
                    own.damping_exponent,
                    own.wave_number_factor.ln(),
                    own.wave_number_exponent,
                ];
                let wrap = |at: &[f64]| Ok(FittedLaw::PowerLaw(model.law_at(at)));
                best_of(&model, data, &[at], options, law, wrap)
            }
        }
    }

    /// The parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Probability of no smaller χ², if the law is true and the stated errors are right. Where the variances are estimates, χ² has a
    /// wider distribution, of the same mean; it is that of a multiple of a χ² with the same mean and variance.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        ChiSquared::new(count(self.degrees_of_freedom) / self.dispersion)
            .map_or(f64::NAN, |distribution| {
                distribution.sf(self.chi_squared / self.dispersion)
            })
    }

    /// Modulus of the law at `omega` > 0 [rad/s] with the covariance that follows from that of the parameters, random and common.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the frequency is finite and above 0; [`CmodError::ChangedResult`] if a law of more parameters
    /// has been put in the place of the fitted one.
    pub fn prediction(&self, omega: f64) -> Result<PredictedModulus, CmodError> {
        let omega = check_positive("angular frequency [rad/s]", omega)?;
        let model = self.law.model()?;
        let parameters = model.kinds().len();
        let mut modulus = [Complex64::ZERO];
        let mut gradient = vec![Complex64::ZERO; parameters];
        let Some(at) = self.coordinates.get(..parameters) else {
            return Err(CmodError::ChangedResult {
                what: "fitted parameters",
                found: self.coordinates.len(),
                expected: parameters,
            });
        };
        model.evaluate(at, &[omega], &mut modulus, &mut gradient);
        let random_covariance = self
            .information
            .of_modulus(&gradient)
            .map(|row| row.map(|entry| self.variance_factor * entry));
        let mut covariance = random_covariance;
        for error in &self.common_errors {
            let products = gradient.iter().zip(&error.shift).map(|(g, s)| g * s);
            let shift: Complex64 = products.sum();
            let parts = [shift.re, shift.im];
            for (row, own) in covariance.iter_mut().zip(parts) {
                for (entry, other) in row.iter_mut().zip(parts) {
                    *entry += own * other;
                }
            }
        }
        Ok(PredictedModulus {
            modulus: modulus[0],
            covariance,
            random_covariance,
        })
    }
}

/// Modulus that a fitted law predicts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PredictedModulus {
    /// Complex modulus \[Pa\].
    pub modulus: Complex64,
    /// Covariance of (E', E'') \[Pa²\], by rows; infinite where the data leave it open. Of the law, if it is true: a wrong law is
    /// no more certain by it.
    pub covariance: [[f64; 2]; 2],
    /// Its part by the random errors.
    pub random_covariance: [[f64; 2]; 2],
}

/// Minimises from all starts and judges the best.
fn best_of<M: Model>(
    model: &M,
    data: &ModulusData,
    starts: &[Vec<f64>],
    options: &FitOptions,
    law: Law,
    wrap: impl Fn(&[f64]) -> Result<FittedLaw, CmodError>,
) -> Result<RheologicalFit, CmodError> {
    let options = options.checked()?;
    enough(data, model.kinds().len(), options.error_scale)?;
    let best = starts
        .iter()
        .filter_map(|start| minimise(model, data, start, None, Effort::Full))
        .min_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared))
        .ok_or_else(|| CmodError::NoLaw {
            law: law.to_string(),
        })?;
    let sequence = 0..data.len();
    let scene = Scene {
        model,
        data,
        band: data.band(),
        sequences: std::slice::from_ref(&sequence),
        options,
    };
    scene.judge(best, law, wrap)
}

pub(super) fn enough(
    data: &ModulusData,
    parameters: usize,
    scale: ErrorScale,
) -> Result<(), CmodError> {
    let spare = usize::from(scale == ErrorScale::FromResidual);
    let expected = parameters.saturating_add(spare);
    if 2 * data.len() < expected {
        return Err(CmodError::TooFewReadings {
            found: 2 * data.len(),
            expected,
        });
    }
    Ok(())
}

impl fmt::Display for RheologicalFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: chi-squared {:.1} of {} degrees of freedom, BIC {:.1}",
            self.law.law(),
            self.chi_squared,
            self.degrees_of_freedom,
            self.bic
        )?;
        for parameter in &self.parameters {
            writeln!(
                f,
                "{:<22} {:>11.4e} {:<6} [{:.3e}, {:.3e}] {}",
                parameter.name,
                parameter.value,
                parameter.unit,
                parameter.interval.lower,
                parameter.interval.upper,
                parameter.verdict
            )?;
        }
        write!(f, "residuals: {}", self.whiteness)
    }
}
