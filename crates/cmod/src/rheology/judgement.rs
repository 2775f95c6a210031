//! Evaluation of a minimum: errors, intervals and verdicts of all parameters.

use std::iter;
use std::ops::Range;

use super::count;
use super::data::ModulusData;
use super::explained::Explained;
use super::fit::{ErrorScale, FitOptions, RheologicalFit, Scores};
use super::law::{FittedLaw, Law};
use super::least_squares::{Effort, Minimum, minimise};
use super::model::{Model, ParameterKind};
use super::parameter::{
    CommonShift, Interval, IntervalMethod, LINEAR_BELOW, Parameter, Reason, Verdict, WIDEST,
};
use super::profile::{Elsewhere, End, Profile};
use super::support::Support;
use super::whiteness::Whiteness;
use crate::directions::Directions;
use crate::error::CmodError;
use crate::vectors::add_square;

/// Correlation above which the linear error of a parameter is unreliable if the other parameter has
/// a large error.
const ASSOCIATED: f64 = 0.3;

/// Minimisation problem and settings for the evaluation of a minimum.
pub(super) struct Scene<'a, M: ?Sized> {
    pub(super) model: &'a M,
    pub(super) data: &'a ModulusData,
    /// Lowest and highest angular frequency of the data [rad/s].
    pub(super) band: (f64, f64),
    pub(super) sequences: Vec<Range<usize>>,
    pub(super) options: FitOptions,
    /// First parameter whose profile is computed. Earlier parameters count as not identifiable if
    /// their linear error is unreliable.
    pub(super) profiled_from: usize,
    /// True if the evaluation ends at the first parameter, other than parameter 0, that is not
    /// identified, because the fit is then not used.
    pub(super) ends_at_open: bool,
    pub(super) elsewhere: Elsewhere,
}

/// Smallest penalty in χ² for a loss. Together with the threshold it amounts to four standard
/// deviations, which noise reaches with a probability of 1 in 30 000.
const LEAST_PRICE: f64 = 12.0;
/// Largest number of minima that are judged in succession, each lower than the previous one.
const ROUNDS: usize = 6;
/// Decrease of the logarithm of a loss at which the loss counts as vanished: to e^-30 of its value.
const VANISHED: f64 = 30.0;

impl<'a, M: Model + ?Sized> Scene<'a, M> {
    /// Creates the scene of a fit to `data` as one sequence, with profiles of all parameters.
    pub(super) fn new(model: &'a M, data: &'a ModulusData, options: FitOptions) -> Self {
        Self {
            model,
            data,
            band: data.band(),
            sequences: iter::once(0..data.len()).collect(),
            options,
            profiled_from: 0,
            ends_at_open: false,
            elsewhere: Elsewhere::default(),
        }
    }

    /// Returns errors, intervals and verdicts. If a profile finds a lower minimum, the evaluation
    /// starts again from that minimum.
    pub(super) fn judge(
        &self,
        mut minimum: Minimum,
        law: Law,
        wrap: impl Fn(&[f64]) -> Result<FittedLaw, CmodError>,
    ) -> Result<RheologicalFit, CmodError> {
        let no_law = || CmodError::NoLaw {
            law: law.to_string(),
        };
        let values = self.data.values();
        for round in 0..ROUNDS {
            let parameters = minimum.at.len();
            let information =
                Directions::of_law(&minimum.linearised, parameters).ok_or_else(no_law)?;
            let degrees_of_freedom = values.saturating_sub(information.rank());
            let variance_factor = match self.options.error_scale {
                ErrorScale::FromResidual => minimum.chi_squared / count(degrees_of_freedom.max(1)),
                _ => 1.0,
            } * self.data.scatter.of_covariance;
            let common = self.common_shifts(&minimum, &information);
            let quantile = self.options.quantile(degrees_of_freedom);
            // in the last round the minimum is kept even if there is a lower minimum next to it;
            // the ends of the interval are then open
            let is_last = round + 1 == ROUNDS;
            let others = match self.others(&minimum, variance_factor * quantile * quantile) {
                Err(_) if is_last => Ok(Vec::new()),
                others => others,
            };
            let judged = others.and_then(|others| {
                self.parameters(
                    &minimum,
                    (&information, &common),
                    &others,
                    (variance_factor, quantile),
                    is_last,
                )
            });
            match judged {
                Ok(parameters) => {
                    let scale = self.options.error_scale;
                    let left = Explained::of(self.data, &minimum.linearised, &information, scale);
                    let scores = Scores::of(scale, left.chi_squared, values, minimum.at.len());
                    let scaled = |row: &Vec<f64>| row.iter().map(|c| variance_factor * c).collect();
                    let random: Option<Vec<Vec<f64>>> = information
                        .matrix()
                        .map(|matrix| matrix.iter().map(scaled).collect());
                    return Ok(RheologicalFit {
                        law: wrap(&minimum.at)?,
                        parameters,
                        covariance: random.clone().map(|random| with_common(random, &common)),
                        random_covariance: random,
                        common_errors: common,
                        signal_to_noise: information.singular_values.clone(),
                        directions: information.vectors.clone(),
                        chi_squared: left.chi_squared,
                        degrees_of_freedom,
                        error_scale: scale,
                        variance_factor,
                        aicc: scores.aicc,
                        bic: scores.bic,
                        whiteness: Whiteness::of(
                            &left.residual,
                            &self.data.readings,
                            &self.sequences,
                        ),
                        residuals: left.residual,
                        ending: minimum.ending,
                        equilibrium_limit: None,
                        dispersion: self.data.scatter.of_chi_squared,
                        information,
                        coordinates: minimum.at,
                        band: self.band,
                        alternatives: Vec::new(),
                        support: Support::default(),
                    });
                }
                Err(lower) => {
                    minimum = minimise(self.model, self.data, &lower, None, Effort::Full)
                        .ok_or_else(no_law)?;
                }
            }
        }
        Err(no_law())
    }

    /// Returns the change of the coordinates due to each common error of the data.
    fn common_shifts(&self, minimum: &Minimum, information: &Directions) -> Vec<CommonShift> {
        let of = |(source, error): (usize, &super::data::CommonError)| CommonShift {
            source: error.source,
            shift: information.change(&minimum.linearised, &self.data.whitened_shift(source)),
        };
        self.data.common.iter().enumerate().map(of).collect()
    }

    /// Returns the minima, found from other starting points, whose χ² exceeds the least χ² by no
    /// more than the threshold; or, as an error, the coordinates of a lower minimum.
    fn others(&self, minimum: &Minimum, threshold: f64) -> Result<Vec<Vec<f64>>, Vec<f64>> {
        let mut others = Vec::new();
        if !self.options.profiles {
            return Ok(others);
        }
        let problem = (self.model, self.data);
        let least = minimum.chi_squared + threshold;
        for found in self.elsewhere.minima(problem, None, least) {
            let rise = found.chi_squared - minimum.chi_squared;
            if rise < -2e-2 * threshold {
                return Err(found.at);
            }
            if rise <= threshold && self.model.is_in_order(&found.at) {
                others.push(found.at);
            }
        }
        Ok(others)
    }

    /// Returns the increase of χ² that defines the end of an interval, for each parameter.
    ///
    /// A search for a loss over the whole band always finds a loss, even if the material has none.
    /// Therefore the data count as compatible with no loss unless χ² without the loss is larger by
    /// the threshold plus a penalty. The penalty is g ln n for the g parameters of the loss
    /// (Schwarz), or [`LEAST_PRICE`] if that is larger. If the data are compatible with no loss,
    /// the interval of a parameter of the loss ends only where χ² has risen by the threshold plus
    /// the penalty. The same applies to a parallel spring, because a spring and a loss can replace
    /// each other.
    fn thresholds(&self, minimum: &Minimum, threshold: f64, variance_factor: f64) -> Vec<f64> {
        let kinds = self.model.kinds();
        // the parameters of one branch vanish together
        let mut known: Vec<(usize, f64)> = Vec::new();
        let of = |(index, kind): (usize, &ParameterKind)| {
            let is_profiled = self.options.profiles && index >= self.profiled_from;
            let Some(loss) = kind.loss.filter(|_| is_profiled) else {
                return threshold;
            };
            if let Some((_, known)) = known.iter().find(|(at, _)| *at == loss.coordinate) {
                return *known;
            }
            let members = kinds.iter().filter(|other| other.loss == kind.loss).count();
            let price = count(members) * count(self.data.values()).ln();
            let dearer = threshold + variance_factor * price.max(LEAST_PRICE);
            let mut start = minimum.at.clone();
            if let Some(coordinate) = start.get_mut(loss.coordinate) {
                *coordinate += loss.vanishes_towards * VANISHED;
            }
            let held = Some(loss.coordinate);
            let effort = Effort::Below(minimum.chi_squared + dearer);
            let without = minimise(self.model, self.data, &start, held, effort);
            let own = match without {
                Some(without) if without.chi_squared - minimum.chi_squared < dearer => dearer,
                _ => threshold,
            };
            known.push((loss.coordinate, own));
            own
        };
        let mut thresholds: Vec<f64> = kinds.iter().enumerate().map(of).collect();
        let is_part = |kind: &ParameterKind| kind.unit == "Pa" && kind.relaxation_time.is_some();
        if kinds.iter().any(is_part) {
            let dearest = thresholds.iter().copied().fold(threshold, f64::max);
            for (own, kind) in thresholds.iter_mut().zip(kinds) {
                if kind.unit == "Pa" && kind.loss.is_none() {
                    *own = dearest;
                }
            }
        }
        thresholds
    }

    /// Returns the parameters or, as an error, the coordinates of a lower minimum.
    #[allow(
        clippy::indexing_slicing,
        reason = "`at`, the variances, the correlations, the thresholds and each common shift have one entry for each of the kinds of the model"
    )]
    fn parameters(
        &self,
        minimum: &Minimum,
        (information, common): (&Directions, &[CommonShift]),
        others: &[Vec<f64>],
        (variance_factor, quantile): (f64, f64),
        is_last: bool,
    ) -> Result<Vec<Parameter>, Vec<f64>> {
        let threshold = variance_factor * quantile * quantile;
        let thresholds = self.thresholds(minimum, threshold, variance_factor);
        let kinds = self.model.kinds();
        let mut parameters = Vec::with_capacity(kinds.len());
        let standard_errors: Vec<f64> = (0..kinds.len())
            .map(|index| (variance_factor * information.variance(index)).sqrt())
            .collect();
        // the linear error of a parameter is also unreliable if it is correlated with a parameter
        // of large error
        let is_linear = |index: usize| {
            let errors_are_small = (0..kinds.len()).all(|other| {
                // a comparison with NaN is false, so an unknown error counts as large
                standard_errors[other] <= LINEAR_BELOW
                    || other != index && information.correlation(index, other).abs() < ASSOCIATED
            });
            let near = 2.0 * quantile * standard_errors[index];
            let is_near = |other: &Vec<f64>| (other[index] - minimum.at[index]).abs() <= near;
            errors_are_small && thresholds[index] <= threshold && others.iter().all(is_near)
        };
        for (index, kind) in kinds.iter().enumerate() {
            let here = minimum.at[index];
            let standard_error = standard_errors[index];
            let common_error = common
                .iter()
                .fold(0.0, |sum: f64, error| sum.hypot(error.shift[index]));
            let total = standard_error.hypot(common_error);
            let value = |coordinate: f64| kind.scale.value(coordinate);
            let (interval, verdict) = if is_linear(index) {
                let interval = Interval {
                    lower: value(here - quantile * total),
                    upper: value(here + quantile * total),
                    method: IntervalMethod::Linear,
                };
                (interval, Verdict::Identified)
            } else {
                let ends = [-1.0, 1.0].map(|direction: f64| {
                    if !self.options.profiles || index < self.profiled_from {
                        return End::Open;
                    }
                    let profile = Profile {
                        model: self.model,
                        data: self.data,
                        at: &minimum.at,
                        chi_squared: minimum.chi_squared,
                        elsewhere: &self.elsewhere,
                        index,
                        threshold: thresholds[index],
                    };
                    profile.end(direction * (0.5 * quantile * standard_error).min(0.7))
                });
                let ends = match ends {
                    [End::LowerMinimum(at), _] | [_, End::LowerMinimum(at)] if !is_last => {
                        return Err(at);
                    }
                    [End::LowerMinimum(_), _] | [_, End::LowerMinimum(_)] => [None, None],
                    [End::At(lower), End::At(upper)] => [Some(lower), Some(upper)],
                    [End::At(lower), End::Open] => [Some(lower), None],
                    [End::Open, End::At(upper)] => [None, Some(upper)],
                    [End::Open, End::Open] => [None, None],
                };
                let wider = |end: f64| {
                    here + (end - here).signum() * (end - here).hypot(quantile * common_error)
                };
                let ends = ends.map(|end| end.map(wider));
                let interval = Interval {
                    lower: value(ends[0].unwrap_or(f64::NEG_INFINITY)),
                    upper: value(ends[1].unwrap_or(f64::INFINITY)),
                    method: IntervalMethod::Profile,
                };
                let reason = || self.reason(minimum, information, index, standard_error);
                let verdict = match ends {
                    [Some(lower), Some(upper)] if upper - lower <= WIDEST => Verdict::Identified,
                    [Some(_), Some(_)] => Verdict::PoorlyDetermined(reason()),
                    [Some(_), None] => Verdict::BoundedBelow(reason()),
                    [None, Some(_)] => Verdict::BoundedAbove(reason()),
                    [None, None] => Verdict::NotIdentifiable(reason()),
                };
                (interval, verdict)
            };
            parameters.push(Parameter {
                name: kind.name.clone(),
                unit: kind.unit,
                value: value(here),
                scale: kind.scale,
                standard_error: total,
                random_error: standard_error,
                common_error,
                interval,
                verdict,
            });
            let is_open = |parameter: &Parameter| !parameter.verdict.is_identified();
            if self.ends_at_open && index > 0 && parameters.last().is_some_and(is_open) {
                break;
            }
        }
        Ok(parameters)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`index` and the partner are indices of kinds of the model, and a kind contains the index of its own relaxation time"
    )]
    fn reason(
        &self,
        minimum: &Minimum,
        information: &Directions,
        index: usize,
        standard_error: f64,
    ) -> Reason {
        let kinds = self.model.kinds();
        let parameters = kinds.len();
        let (lowest, highest) = self.band;
        if let Some(time) = kinds[index].relaxation_time {
            let relaxation_time = minimum.at[time].exp();
            if relaxation_time * highest < 1.0 || relaxation_time * lowest > 1.0 {
                return Reason::OutsideBand {
                    relaxation_time,
                    shortest: highest.recip(),
                    longest: lowest.recip(),
                };
            }
        }
        let column: f64 = minimum
            .linearised
            .jacobian
            .iter()
            .skip(index)
            .step_by(parameters)
            .map(|entry| entry * entry)
            .sum();
        if column.sqrt() <= 1e-6 {
            return Reason::NoInfluence;
        }
        match information.partner(index) {
            Some((partner, correlation)) if correlation.abs() > 0.9 => Reason::Correlated {
                with: kinds[partner].name.clone(),
                correlation,
            },
            _ => Reason::Noise { standard_error },
        }
    }
}

/// Returns C_random + Σ_s g_s g_sᵀ.
fn with_common(mut covariance: Vec<Vec<f64>>, common: &[CommonShift]) -> Vec<Vec<f64>> {
    for error in common {
        add_square(&mut covariance, 1.0, &error.shift);
    }
    covariance
}
