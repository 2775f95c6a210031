//! Information in the data: covariance, standard errors, and a verdict for each parameter.
//!
//! Theory: `docs/theory/identification.md#verdicts`.

use crate::law::{Role, Scale, StatedParameter};
use crate::least_squares::{Linearisation, ScaledDecomposition, sum_of_squares};
use crate::model::RodModel;
use crate::specimen::{SpecimenSensitivity, SpecimenUncertainty};
use crate::vectors::dot;

/// Limit of the standard error of an identified parameter: of ln(value), so that the value is three
/// standard errors, or of the exponent itself.
pub const IDENTIFIED_BELOW: f64 = 1.0 / 3.0;

/// The noise used for the errors.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Noise {
    /// Standard deviation of each sample of the response, as a fraction of the impact velocity. The
    /// errors are those of data with this noise, but never smaller than those implied by the
    /// residual of the fit.
    Known(f64),
    /// Noise stated with the tests ([`crate::RodTest::with_noise`] and similar methods), of
    /// excitation and response, propagated through the rod. The errors are increased if the
    /// residual is larger than chance permits.
    Stated,
    /// Noise estimated from the residual of the fit, with the number of independent samples reduced
    /// by the autocorrelation of the residual.
    FromResidual,
}

/// Verdict on the determination of a parameter by the data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The standard error is below [`IDENTIFIED_BELOW`].
    Identified,
    /// Undetermined: within the noise, values of another order of magnitude (or other exponents)
    /// fit the data equally well. The stated value is the one at which the iteration stopped, not a
    /// property of the material.
    NotIdentifiable,
    /// Bounded above: the data exclude only values above the bound, at 95 % ([`crate::profile`]).
    BoundedAbove(f64),
    /// Bounded below: the data exclude only values below the bound, at 95 % ([`crate::profile`]).
    BoundedBelow(f64),
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Identified => f.write_str("identified"),
            Self::NotIdentifiable => f.write_str("not identifiable from these data"),
            Self::BoundedAbove(bound) => write!(f, "at most {bound:.4}"),
            Self::BoundedBelow(bound) => write!(f, "at least {bound:.4}"),
        }
    }
}

/// A parameter with its error and verdict.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// Name of the quantity.
    pub name: &'static str,
    /// Symbol of the quantity.
    pub symbol: &'static str,
    /// SI unit of the quantity.
    pub unit: &'static str,
    /// Value, in SI units.
    pub value: f64,
    /// Standard error of ln(value) if `scale` is a ratio, of the value if it is a difference.
    pub standard_error: f64,
    /// Part of the standard error due to an uncertain specimen, the same in all tests; 0 unless
    /// [stated](Estimate::with_specimen_uncertainty).
    pub specimen_error: f64,
    /// Sensitivity to length and density of the specimen.
    pub sensitivity: SpecimenSensitivity,
    /// Scale of the error.
    pub scale: Scale,
    /// Role: coordinate of the identification, or derived from coordinates.
    pub role: Role,
    /// Verdict on the determination by the data.
    pub verdict: Verdict,
}

impl Estimate {
    /// Adds the error due to an uncertain specimen to the standard error. The verdict does not
    /// change, because it states what the histories determine.
    #[must_use]
    pub fn with_specimen_uncertainty(mut self, specimen: &SpecimenUncertainty) -> Self {
        let error = self.sensitivity.standard_error(specimen);
        self.specimen_error = self.specimen_error.hypot(error);
        self.standard_error = self.standard_error.hypot(error);
        self
    }

    /// The 95 % interval of the linearised problem, symmetric in ln(value) or in the value
    /// according to `scale`. Infinite if the data do not determine the parameter.
    #[must_use]
    pub fn interval_95(&self) -> (f64, f64) {
        // the normal distribution has 95 % within 1.96 standard deviations
        let half = 1.959_964 * self.standard_error;
        match self.scale {
            Scale::Ratio => (self.value * (-half).exp(), self.value * half.exp()),
            Scale::Difference => (self.value - half, self.value + half),
        }
    }
}

/// Information in the data on the parameters at the minimum.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Identifiability {
    /// Estimates: E first, then the parameters of the law as stated in the literature.
    pub estimates: Vec<Estimate>,
    /// Singular values of the Jacobian over the noise, descending: the change of the response, in
    /// standard deviations, for a unit change of (ln E, shape, ln rate) along each singular
    /// direction.
    pub signal_to_noise: Vec<f64>,
    /// Correlation matrix of (ln E, parameters of the law), by rows.
    pub correlation: Vec<Vec<f64>>,
    /// Standard errors of θ = (ln E, parameters of the law).
    pub coordinate_errors: Vec<f64>,
    /// Standard deviation of a sample, as a fraction of V0; for [`Noise::Stated`], the standard
    /// deviation of a white sample in stated standard deviations.
    pub noise: f64,
    /// Factor by which the variances were increased for the autocorrelation of the residual; 1 for
    /// white residuals.
    pub correlation_inflation: f64,
}

/// Inputs of the assessment: the residual divided by V0; for stated noise, the white residual and
/// the factor on its noise; and the factor on the standard error of ln E.
pub(crate) struct Judged<'a> {
    pub(crate) linearisation: &'a Linearisation,
    pub(crate) white: Option<(&'a Linearisation, f64)>,
    pub(crate) widening: f64,
}

#[allow(
    clippy::indexing_slicing,
    reason = "right singular vectors, rows and columns of the covariance have an entry for each parameter, of which the damping is one by \
              `check_counts`"
)]
pub(crate) fn assess(
    model: &dyn RodModel,
    at: &[f64],
    judged: &Judged<'_>,
    lengths: &[usize],
    noise: Noise,
) -> Option<Identifiability> {
    let parameters = at.len();
    let linearisation = judged
        .white
        .map_or(judged.linearisation, |(white, _)| white);
    let decomposition = ScaledDecomposition::new(linearisation, &vec![1.0; parameters])?;
    let degrees = linearisation
        .residual
        .len()
        .saturating_sub(parameters)
        .max(1);
    let from_residual = (sum_of_squares(&linearisation.residual) / degrees as f64).sqrt();
    let (noise, correlation_inflation) = match noise {
        _ if judged.white.is_some() => (judged.white.map_or(1.0, |(_, ratio)| ratio), 1.0),
        Noise::Known(known) if known >= from_residual => (known, 1.0),
        _ => (
            from_residual,
            correlation_inflation(&linearisation.residual, lengths),
        ),
    };
    let variance = noise * noise * correlation_inflation;
    let width = |index| if index == 0 { judged.widening } else { 1.0 };
    // (JᵀJ)⁻¹ = V S⁻² Vᵀ; a direction without signal has infinite variance
    let covariance: Vec<Vec<f64>> = (0..parameters)
        .map(|i| {
            (0..parameters)
                .map(|j| {
                    let narrow: f64 = decomposition
                        .right
                        .iter()
                        .zip(&decomposition.singular_values)
                        .map(|(vector, s)| {
                            let product = vector[i] * vector[j];
                            if product == 0.0 {
                                0.0
                            } else {
                                product * variance / (s * s)
                            }
                        })
                        .sum();
                    narrow * width(i) * width(j)
                })
                .collect()
        })
        .collect();
    let correlation = (0..parameters)
        .map(|i| {
            (0..parameters)
                .map(|j| {
                    let scale = (covariance[i][i] * covariance[j][j]).sqrt();
                    if i == j {
                        1.0
                    } else {
                        covariance[i][j] / scale
                    }
                })
                .collect()
        })
        .collect();
    let specimen = model.specimen_sensitivities(at);
    let mut estimates: Vec<Estimate> = model
        .stated(at)
        .iter()
        .map(|stated| estimate(stated, &covariance, &specimen))
        .collect();
    // if the data do not determine the damping, they do not determine the shape of the law, even if
    // the linearised error of the shape is small
    let damping_seen = model.damping_parameter().is_none_or(|index| {
        let jacobian = &linearisation.jacobian;
        let own = besides(&jacobian[index], &jacobian[0]);
        variance < IDENTIFIED_BELOW * IDENTIFIED_BELOW * own
    });
    if !damping_seen {
        for estimate in estimates.iter_mut().skip(1) {
            estimate.verdict = Verdict::NotIdentifiable;
        }
    }
    Some(Identifiability {
        estimates,
        signal_to_noise: decomposition
            .singular_values
            .iter()
            .map(|s| s / noise)
            .collect(),
        coordinate_errors: covariance
            .iter()
            .enumerate()
            .map(|(index, row)| row[index].sqrt())
            .collect(),
        correlation,
        noise,
        correlation_inflation,
    })
}

/// |a - (a·b) b/b²|²: the square of the part of a column that is orthogonal to another one.
fn besides(column: &[f64], other: &[f64]) -> f64 {
    let along = dot(column, other) / dot(other, other);
    let rest = column.iter().zip(other).map(|(a, b)| a - along * b);
    rest.map(|r| r * r).sum()
}

fn estimate(
    parameter: &StatedParameter,
    covariance: &[Vec<f64>],
    specimen: &[SpecimenSensitivity],
) -> Estimate {
    let gradient = &parameter.gradient;
    let variance: f64 = gradient
        .iter()
        .zip(covariance)
        .map(|(g, row)| {
            let product: f64 = row
                .iter()
                .zip(gradient)
                .map(|(c, h)| if *h == 0.0 { 0.0 } else { c * h })
                .sum();
            if *g == 0.0 { 0.0 } else { g * product }
        })
        .sum();
    let standard_error = variance.max(0.0).sqrt();
    Estimate {
        name: parameter.name,
        symbol: parameter.symbol,
        unit: parameter.unit,
        value: parameter.value,
        standard_error,
        specimen_error: 0.0,
        sensitivity: SpecimenSensitivity::through(gradient, specimen),
        scale: parameter.scale,
        role: parameter.role,
        // NaN, from a parameter that cannot be assessed, compares as false and gives
        // `NotIdentifiable`
        verdict: if standard_error < IDENTIFIED_BELOW {
            Verdict::Identified
        } else {
            Verdict::NotIdentifiable
        },
    }
}

/// Variance inflation 1 + 2 Σ ρ_l over the initial autocorrelations above 2/√n of the residuals,
/// pooled over the tests (after Geyer, 1992).
pub(crate) fn correlation_inflation(residual: &[f64], lengths: &[usize]) -> f64 {
    let variance = sum_of_squares(residual);
    if variance <= 0.0 {
        return 1.0;
    }
    let longest = lengths.iter().copied().max().unwrap_or(0);
    let mut inflation = 1.0;
    for lag in 1..longest / 2 {
        let mut covariance = 0.0;
        let mut pairs = 0_usize;
        let mut rest = residual;
        for length in lengths {
            let (of_test, others) = rest.split_at((*length).min(rest.len()));
            rest = others;
            covariance += of_test
                .iter()
                .zip(of_test.iter().skip(lag))
                .map(|(a, b)| a * b)
                .sum::<f64>();
            pairs += of_test.len().saturating_sub(lag);
        }
        let correlation = covariance / pairs.max(1) as f64 / (variance / residual.len() as f64);
        // white residuals have correlations of order n^(-1/2), of either sign
        if correlation < 2.0 / (residual.len() as f64).sqrt() {
            break;
        }
        inflation += 2.0 * correlation;
    }
    inflation
}
