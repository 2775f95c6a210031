//! Result of a fit of a law to moduli: the errors of its parameters and tests of its residuals.

use std::fmt;

use num_complex::Complex64;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use super::count;
use super::data::ModulusData;
use super::law::FittedLaw;
use super::least_squares::Ending;
use super::model::Model;
use super::over_time::TransientTest;
use super::parameter::{CommonShift, Parameter};
use super::prony::Prony;
use super::support::Support;
use super::transient::{Lines, Reading};
use super::whiteness::Whiteness;
use crate::directions::Directions;
use crate::error::{CmodError, check_enough_readings, check_positive, check_that};
pub use crate::recovery::fit::ErrorScale;
use crate::vectors::subtract;

/// Criterion for the comparison of laws and of orders of a Prony series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Criterion {
    /// Schwarz's criterion χ² + p ln n. It finds the true order if there is one.
    #[default]
    Bic,
    /// Corrected Akaike criterion χ² + 2p + 2p(p + 1)/(n - p - 1) (Akaike, Hurvich & Tsai). It
    /// gives the best prediction, and chooses too many branches rather than too few.
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
    /// Basis of the standard errors.
    pub error_scale: ErrorScale,
    /// Level of the confidence intervals, between 0 and 1.
    pub confidence: f64,
    /// Criterion for the order of a Prony series.
    pub criterion: Criterion,
    /// Maximum number of branches of a Prony series whose order is found from the data; `None` for
    /// no limit.
    pub most_branches: Option<usize>,
    /// True if profiles are computed for parameters whose linearised interval is unreliable.
    /// Without profiles such a parameter counts as not identifiable.
    pub profiles: bool,
    /// True if profiles are also computed for the parameters of a Prony series whose order is found
    /// from the data. For a [master curve](super::MasterCurve) with many branches, they take most
    /// of the computing time. The shifts of a master curve have profiles in any case.
    pub series_profiles: bool,
}

impl Default for FitOptions {
    /// Returns the defaults: stated errors, a confidence level of 95 %, BIC, with profiles.
    fn default() -> Self {
        Self {
            error_scale: ErrorScale::Stated,
            confidence: 0.95,
            criterion: Criterion::Bic,
            most_branches: None,
            profiles: true,
            series_profiles: true,
        }
    }
}

impl FitOptions {
    /// Sets the basis of the standard errors.
    #[must_use]
    pub fn with_error_scale(self, error_scale: ErrorScale) -> Self {
        Self {
            error_scale,
            ..self
        }
    }

    /// Sets the level of the confidence intervals.
    #[must_use]
    pub fn with_confidence(self, confidence: f64) -> Self {
        Self { confidence, ..self }
    }

    /// Sets the criterion for the order of a Prony series.
    #[must_use]
    pub fn with_criterion(self, criterion: Criterion) -> Self {
        Self { criterion, ..self }
    }

    /// Limits the number of branches of a Prony series whose order is found from the data, for
    /// example to the number that a finite-element program accepts. If the data need more branches,
    /// the residuals show this.
    #[must_use]
    pub fn with_most_branches(self, most: usize) -> Self {
        Self {
            most_branches: Some(most),
            ..self
        }
    }

    /// Enables or disables profiles.
    #[must_use]
    pub fn with_profiles(self, profiles: bool) -> Self {
        Self { profiles, ..self }
    }

    /// Enables or disables profiles for the parameters of Prony series.
    #[must_use]
    pub fn with_series_profiles(self, series_profiles: bool) -> Self {
        Self {
            series_profiles,
            ..self
        }
    }

    pub(super) fn checked(self) -> Result<Self, CmodError> {
        let level = self.confidence;
        let is_right = level > 0.0 && level < 1.0;
        let expected = "a value between 0 and 1";
        check_that(is_right, "level of confidence", level, expected)?;
        Ok(self)
    }

    /// Returns the quantile by which a standard error is multiplied to give a confidence interval.
    pub(super) fn quantile(&self, degrees_of_freedom: usize) -> f64 {
        let probability = 0.5 * (1.0 + self.confidence);
        match self.error_scale {
            ErrorScale::FromResidual => StudentsT::new(0.0, 1.0, count(degrees_of_freedom))
                .map_or(f64::NAN, |student| student.inverse_cdf(probability)),
            _ => Normal::standard().inverse_cdf(probability),
        }
    }
}

/// Values of the criteria, computed from χ² and the number of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scores {
    pub(super) aicc: f64,
    pub(super) bic: f64,
    /// Criterion for the weights of predictions: AIC, χ² + 2p, if the errors are known; otherwise
    /// AICc, whose correction applies to a variance from the residual.
    pub(super) prediction: f64,
}

impl Scores {
    /// Returns the scores. For errors from the residual the scatter is a further parameter, -2 ln L
    /// is n ln(χ²/n), and BIC includes a correction for few values, p ln n · n/(n - p - 1)
    /// (McQuarrie, Statistics & Probability Letters 44 (1999) 79).
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
        let aicc = if left > 0.0 {
            deviance + 2.0 * p + 2.0 * p * (p + 1.0) / left
        } else {
            f64::INFINITY
        };
        let bic = match scale {
            ErrorScale::FromResidual if left > 0.0 => deviance + p * n.ln() * n / left,
            // with so few values the residual does not determine the scatter
            ErrorScale::FromResidual => f64::INFINITY,
            _ => deviance + p * n.ln(),
        };
        Self {
            aicc,
            bic,
            prediction: match scale {
                ErrorScale::FromResidual => aicc,
                _ => deviance + 2.0 * p,
            },
        }
    }
}

/// Result of the fit of a law by weighted least squares.
///
/// The fit minimises χ² = Σ δᵀC⁻¹δ over the lines, where δ = (Re, Im) of the law minus the measured
/// modulus and C is the covariance of the line. The coordinates keep every parameter in its range,
/// and the derivatives are exact. Standard errors are of first order at the minimum; if they are
/// large, intervals and verdicts come from profiles of χ².
///
/// The weights follow from the random errors alone. If the random errors are stated, the covariance
/// of the data is C + Σ_s δE_s δE_sᵀ. χ² and the residuals are then the part that is explained
/// neither by the law nor by the common errors within their uncertainties. [Common
/// errors](ModulusData::with_common_errors) shift the parameters by g_s = J⁺W δE_s (J is the
/// whitened Jacobian, W the whitening), and the covariance of the parameters is C_random + Σ_s g_s
/// g_sᵀ. More lines do not reduce the contribution of the common errors.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct RheologicalFit {
    /// Law at the minimum.
    pub law: FittedLaw,
    /// Parameters of the law.
    pub parameters: Vec<Parameter>,
    /// Covariance of the parameters due to random and common errors, each on its
    /// [`Scale`](super::Scale), by rows; `None` if a combination of parameters is undetermined.
    pub covariance: Option<Vec<Vec<f64>>>,
    /// Part of the covariance due to the random errors.
    pub random_covariance: Option<Vec<Vec<f64>>>,
    /// Part of the covariance due to common errors, one vector per source.
    pub common_errors: Vec<CommonShift>,
    /// Singular values of the whitened Jacobian, descending: changes of the law along each of the
    /// `directions`, in standard errors of the data.
    pub signal_to_noise: Vec<f64>,
    /// Directions of the singular values: unit vectors in the scales of the parameters, one per
    /// singular value.
    pub directions: Vec<Vec<f64>>,
    /// χ² with the stated errors.
    pub chi_squared: f64,
    /// Number of values, two per line or one for data over time, minus the number of singular
    /// values above 0.
    pub degrees_of_freedom: usize,
    /// Basis of the standard errors.
    pub error_scale: ErrorScale,
    /// Factor of the random variances: 1, or χ²/ν for errors from the residual. If the variances of
    /// the lines are estimates with ν degrees of freedom, it is multiplied by (ν - 2)/(ν - 4) for
    /// the scatter of the weights.
    pub variance_factor: f64,
    /// Corrected Akaike information criterion, up to a constant that depends only on the data.
    pub aicc: f64,
    /// Bayesian information criterion, up to the same constant.
    pub bic: f64,
    /// Whitened residuals, law minus measured: two per line, the second of which is 0 for data over
    /// time.
    pub residuals: Vec<f64>,
    /// Test of the residuals for whiteness.
    pub whiteness: Whiteness,
    /// Reason why the iteration ended.
    pub ending: Ending,
    /// For a Prony series that was chosen without a spring, the largest E∞ \[Pa\] that the data do
    /// not exclude at the confidence level of the fit. If it is near 0, the material has no
    /// equilibrium modulus; if it is of the order of the modulus, the series lacks a spring by
    /// chance, because a slow branch fits as well.
    pub equilibrium_limit: Option<f64>,
    /// Ratio of the variance of χ² to its variance for known errors.
    pub(super) dispersion: f64,
    pub(super) information: Directions,
    pub(super) coordinates: Vec<f64>,
    /// Lowest and highest angular frequency of the data [rad/s].
    pub(super) band: (f64, f64),
    /// Orders among which the order of a Prony series was chosen; empty if the order was given.
    pub(super) alternatives: Vec<Alternative>,
    /// Lines of the data for a Prony series whose order was found from the data; empty otherwise.
    pub(super) support: Support,
}

/// One of the orders of a Prony series among which a criterion chose.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Alternative {
    /// Probability of the order, from the criterion for predictions.
    pub(super) weight: f64,
    pub(super) model: Prony,
    pub(super) coordinates: Vec<f64>,
    pub(super) information: Directions,
}

/// Relative rounding error of a frequency that is stated in hertz.
const ROUNDING: f64 = 1e-12;

impl RheologicalFit {
    /// Returns the parameter with this `name`.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Returns the probability of a χ² at least as large, if the law is true and the stated errors
    /// are right. If the variances are estimates, χ² has a wider distribution with the same mean;
    /// this distribution is approximated by a multiple of a χ² variable with the same mean and
    /// variance.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        ChiSquared::new(count(self.degrees_of_freedom) / self.dispersion)
            .map_or(f64::NAN, |distribution| {
                distribution.sf(self.chi_squared / self.dispersion)
            })
    }

    /// Returns the modulus at `omega` > 0 [rad/s] with its covariance due to the errors of the
    /// parameters, random and common.
    ///
    /// If a criterion chose the order of a Prony series, the modulus is the mean over the orders
    /// with their weights w (exp(-AIC/2), normalised; AICc for errors from the residual), and the
    /// scatter of the orders is included as an error: C = Σ w (C_k + d_k d_kᵀ), where d_k is the
    /// difference of order k from the mean (Buckland, Burnham & Augustin, *Biometrics* **53**
    /// (1997) 603). Such a series is not a law of the material. Therefore, within the band, neither
    /// the real nor the imaginary part is given a smaller error than the mean of the lines within a
    /// decade of `omega`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the frequency is finite and above 0;
    /// [`CmodError::ChangedResult`] if the fitted law was replaced by a law with more parameters.
    pub fn prediction(&self, omega: f64) -> Result<PredictedModulus, CmodError> {
        let omega = check_positive("angular frequency [rad/s]", omega)?;
        self.predicted(omega, Reading::Oscillation)
    }

    /// Returns E(t), or 1/J(t) of creep, at `time` > 0 \[s\] after a step, as the real part of the
    /// modulus, with its covariance as in [`Self::prediction`]. The result counts as within the
    /// band if 1/t is within the band.
    ///
    /// # Errors
    /// The errors of [`Self::prediction`]; [`CmodError::LawOverTime`] for power laws.
    pub fn prediction_over_time(
        &self,
        test: TransientTest,
        time: f64,
    ) -> Result<PredictedModulus, CmodError> {
        let time = check_positive("time since the load [s]", time)?;
        if let FittedLaw::PowerLaw(_) = self.law {
            return Err(CmodError::LawOverTime {
                law: self.law.law().to_string(),
            });
        }
        self.predicted(time.recip(), test.reading(0.0))
    }

    fn predicted(&self, omega: f64, reading: Reading) -> Result<PredictedModulus, CmodError> {
        let model = self.law.model()?;
        let parameters = model.kinds().len();
        let Some(at) = self.coordinates.get(..parameters) else {
            return Err(CmodError::ChangedResult {
                what: "fitted parameters",
                found: self.coordinates.len(),
                expected: parameters,
            });
        };
        let (modulus, gradient) = evaluated(model.as_ref(), at, omega, reading);
        let own = self.information.of_modulus(&gradient);
        let alternatives = self.alternatives.iter().map(|other| {
            // the coordinates of the series may be followed by the coordinates of shifts, on which
            // the series does not depend
            let (at, _) = other.coordinates.split_at(other.model.kinds().len());
            let (modulus, gradient) = evaluated(&other.model, at, omega, reading);
            let covariance = other.information.of_modulus(&gradient);
            (other.weight, modulus, covariance)
        });
        let mut all: Vec<_> = alternatives.collect();
        if all.is_empty() {
            all.push((1.0, modulus, own));
        }
        let scaled = |(weight, modulus, covariance): (f64, Complex64, [[f64; 2]; 2])| {
            let covariance = covariance.map(|row| row.map(|entry| self.variance_factor * entry));
            (weight, modulus, covariance)
        };
        let (mean, mut random_covariance) = mean_of(all.into_iter().map(scaled));
        let within_band =
            self.band.0 <= omega * (1.0 + ROUNDING) && omega <= self.band.1 * (1.0 + ROUNDING);
        if within_band {
            let [[real, _], [_, imaginary]] = &mut random_covariance;
            let least = self.support.variances_about(omega, reading);
            *real = real.max(self.variance_factor * least[0]);
            *imaginary = imaginary.max(self.variance_factor * least[1]);
        }
        let mut covariance = random_covariance;
        for error in &self.common_errors {
            let products = gradient.iter().zip(&error.shift).map(|(g, s)| g * s);
            let shift: Complex64 = products.sum();
            add_square(&mut covariance, 1.0, shift);
        }
        Ok(PredictedModulus {
            modulus: mean,
            covariance,
            random_covariance,
            within_band,
        })
    }
}

fn evaluated<M: Model + ?Sized>(
    model: &M,
    at: &[f64],
    omega: f64,
    reading: Reading,
) -> (Complex64, Vec<Complex64>) {
    let mut modulus = [Complex64::ZERO];
    let mut gradient = vec![Complex64::ZERO; at.len()];
    let lines = Lines::new(std::slice::from_ref(&omega), std::slice::from_ref(&reading));
    model.evaluate(at, lines, &mut modulus, &mut gradient);
    (modulus[0], gradient)
}

/// Returns the mean and the covariance of a mixture, given the weight, mean and covariance of each
/// part; the weights sum to 1.
pub(super) fn mean_of(
    parts: impl Iterator<Item = (f64, Complex64, [[f64; 2]; 2])>,
) -> (Complex64, [[f64; 2]; 2]) {
    let parts: Vec<_> = parts.collect();
    let mean: Complex64 = parts
        .iter()
        .map(|(weight, modulus, _)| weight * modulus)
        .sum();
    let mut sum = [[0.0; 2]; 2];
    for (weight, modulus, covariance) in parts {
        for (row, own) in sum.iter_mut().zip(&covariance) {
            subtract(row, -weight, own);
        }
        add_square(&mut sum, weight, modulus - mean);
    }
    (mean, sum)
}

/// Adds `weight` d dᵀ to the covariance, where d = (Re, Im) of `difference`.
fn add_square(covariance: &mut [[f64; 2]; 2], weight: f64, difference: Complex64) {
    let parts = [difference.re, difference.im];
    for (row, own) in covariance.iter_mut().zip(parts) {
        subtract(row, -weight * own, &parts);
    }
}

/// Modulus predicted by one or several fitted laws.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PredictedModulus {
    /// Complex modulus \[Pa\].
    pub modulus: Complex64,
    /// Covariance of (E', E'') \[Pa²\], by rows; infinite if undetermined. The covariance assumes
    /// that the law is true and does not include the error of a wrong law.
    pub covariance: [[f64; 2]; 2],
    /// Part of the covariance due to the random errors and to the choice of an order or a law.
    pub random_covariance: [[f64; 2]; 2],
    /// True if the frequency lies between the lowest and the highest line of the data. Outside this
    /// band the modulus and its covariance are valid only if the law also describes the material
    /// there, which the data cannot show.
    pub within_band: bool,
}

impl PredictedModulus {
    /// Returns the loss factor η = E''/E' and its standard error, to first order:
    ///
    /// ```text
    /// s²(η) = (s²(E'') - 2 η cov(E', E'') + η² s²(E')) / E'²
    /// ```
    #[must_use]
    pub fn loss_factor(&self) -> (f64, f64) {
        let [[storage, mixed], [_, loss]] = self.covariance;
        let factor = self.modulus.im / self.modulus.re;
        let variance = factor * factor * storage - 2.0 * factor * mixed + loss;
        (factor, variance.max(0.0).sqrt() / self.modulus.re)
    }
}

/// Refuses data with fewer values than `parameters`. If the errors follow from the residual, data
/// with as many values as parameters are also refused.
pub(super) fn enough(
    data: &ModulusData,
    parameters: usize,
    scale: ErrorScale,
) -> Result<(), CmodError> {
    let spare = usize::from(scale == ErrorScale::FromResidual);
    let expected = parameters.saturating_add(spare);
    check_enough_readings(data.values(), expected)
}

impl fmt::Display for RheologicalFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: chi-squared {:.1} with {} degrees of freedom, BIC {:.1}",
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
