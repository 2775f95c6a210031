//! Errors of rods and transducers that are the same for many samples, and often for several tests.
//!
//! A length, a lateral inertia, a sensitivity or a delay q with a stated standard uncertainty u
//! moves the whole simulated response by u ∂S/∂q. Let A have one column a = u ∂S/∂q, whitened with
//! the noise, for each independent error: the white residual then has the covariance I + A Aᵀ
//! instead of I. The inverse square root of this covariance is a product of one factor per column,
//!
//! ```text
//! I - (1 - 1/√(1 + |a|²)) a aᵀ/|a|² ,
//! ```
//!
//! where the preceding factors have been applied to a. Fit, standard errors, profiles and the
//! comparison of laws then include these errors, as unknowns with a normal prior that are
//! eliminated (Golub & Pereyra 1973). The factors couple all tests that share an error: two tests
//! of one rod have one error of its length.
//!
//! The derivative with respect to ln L follows from those with respect to θ: two velocity histories
//! determine only E/(ρL²) and the function L F(ρLs) of s (see [`crate::SpecimenSensitivity`]).
//!
//! The response is linearised about the most likely delay and length, and about the stated values
//! of the other quantities. A linearisation about the stated length has an error of second order in
//! the error of the length. If this error exceeds the noise, E moves to the other side of its
//! minimum each time the columns are recomputed, and the fit does not converge.
//!
//! If the recorder is part of the model, the rise of the excitation between two points of its grid
//! is not resolved, which is a further common error. On a grid with a quarter of the spacing the
//! response of a nonlinear rod changes by Δ. For an instantaneous rise the error is of first order
//! in the spacing, so that the error on the original grid is Δ + Δ/4 + Δ/16 + .. = 4Δ/3. This
//! correction is added, with the standard uncertainty Δ.
//!
//! # Validity
//! The response is linear in gain errors of a few per cent. The density is not a common error of
//! this module: its error is the same for all rods of one material, and is added to the results by
//! [`crate::SpecimenUncertainty`].
//!
//! Theory: `docs/theory/identification.md#errors-of-rods-and-transducers`.

use std::fmt;

use crate::deviation::Deviation;
use crate::error::{MaxwellidError, check_not_negative};
use crate::least_squares::{Linearisation, ScaledDecomposition};
use crate::model::{DrivenRod, RodModel, delayed, linearised_response_of, response_of};
use crate::nuisance::Nuisances;
use crate::parallel::all_in_order;
use crate::test::RodTest;
use crate::whitening::Weighting;

/// Quantity that has the common error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorOf {
    /// Length L of a rod, relative.
    Length,
    /// Lateral inertia ν²k_p² of a rod, relative: twice the relative error of Poisson's ratio or of
    /// the diameter.
    LateralInertia,
    /// Gain of the transducer of the excitation, relative.
    ExcitationGain,
    /// Gain of the transducer of the response, relative.
    ResponseGain,
    /// Delay of the response relative to the excitation \[s\].
    Delay,
}

impl ErrorOf {
    /// Returns true for an error of a transducer, not of a rod.
    #[must_use]
    pub fn is_of_transducer(self) -> bool {
        !matches!(self, Self::Length | Self::LateralInertia)
    }
}

impl fmt::Display for ErrorOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "length",
            Self::LateralInertia => "lateral inertia",
            Self::ExcitationGain => "gain of the excitation",
            Self::ResponseGain => "gain of the response",
            Self::Delay => "delay of the response",
        })
    }
}

/// An error of a rod or a transducer. Tests that have errors with the same kind and the same
/// `shared_by` share one error.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonError {
    /// The quantity.
    pub of: ErrorOf,
    /// Name of the rod or the transducer.
    pub shared_by: String,
    /// Standard uncertainty: relative, or in seconds for a delay.
    pub standard_uncertainty: f64,
}

/// The most likely value of a common error.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CommonErrorEstimate {
    /// The error as stated with the tests.
    pub error: CommonError,
    /// Most likely value: true over stated value minus 1, or the delay \[s\].
    pub value: f64,
    /// Standard error of the value, at most the stated uncertainty.
    pub standard_error: f64,
}

/// Formats the error in one sentence, such as `length of rod A: 1.00070 ± 0.00040 times the
/// stated value (± 0.00130 stated)`.
impl fmt::Display for CommonErrorEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let CommonError {
            of,
            shared_by,
            standard_uncertainty,
        } = &self.error;
        let (value, error) = (self.value, self.standard_error);
        write!(f, "{of} of {shared_by}: ")?;
        if *of == ErrorOf::Delay {
            let [value, error, before] = [value, error, *standard_uncertainty].map(|t| 1e6 * t);
            return write!(f, "{value:.2} us ± {error:.2} us (± {before:.2} us stated)");
        }
        let value = 1.0 + value;
        write!(
            f,
            "{value:.5} ± {error:.5} times the stated value (± {standard_uncertainty:.5} stated)"
        )
    }
}

impl RodTest {
    /// Adds errors of the rod and of the transducers. With such errors, a fit and a comparison of
    /// laws require the noise of the test.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless each uncertainty is finite and not below 0.
    pub fn with_common_errors(
        mut self,
        errors: impl IntoIterator<Item = CommonError>,
    ) -> Result<Self, MaxwellidError> {
        for error in errors {
            let value = error.standard_uncertainty;
            check_not_negative("standard uncertainty of a rod or a transducer", value)?;
            if value > 0.0 {
                self.common_errors.push(error);
            }
        }
        Ok(self)
    }

    /// Errors of the rod and of the transducers.
    #[must_use]
    pub fn common_errors(&self) -> &[CommonError] {
        &self.common_errors
    }
}

/// Relative standard uncertainty of an unstated transducer gain.
pub const UNSTATED_GAIN: f64 = 0.05;

/// Standard uncertainty, in samples, of an unstated delay between transducers.
pub const UNSTATED_DELAY: f64 = 1.0;

/// Adds to `tests` an error of the response's gain ([`UNSTATED_GAIN`]) and of its delay
/// ([`UNSTATED_DELAY`]), each the same in all tests. A second comparison with these errors shows
/// whether they explain why no law fits the data. `None` if a test states an error of its
/// transducers.
#[must_use]
pub fn with_unstated_transducers(tests: &[RodTest]) -> Option<Vec<RodTest>> {
    let allowed = |test: &RodTest| {
        let of_transducer = |error: &CommonError| error.of.is_of_transducer();
        if test.common_errors.iter().any(of_transducer) {
            return None;
        }
        let error = |of, standard_uncertainty| CommonError {
            of,
            shared_by: "the transducers".to_owned(),
            standard_uncertainty,
        };
        let mut allowed = test.clone();
        allowed.common_errors.extend([
            error(ErrorOf::ResponseGain, UNSTATED_GAIN),
            error(ErrorOf::Delay, UNSTATED_DELAY / test.sampling_rate_hz),
        ]);
        Some(allowed)
    };
    tests.iter().map(allowed).collect()
}

/// The value of one error in `deviation`, and the factor that turns the result of [`derivative`]
/// into the derivative with respect to this error.
fn of_error(deviation: Deviation, of: ErrorOf) -> (f64, f64) {
    match of {
        ErrorOf::Delay => (deviation.delay, 1.0),
        // `derivative` differentiates with respect to ln L
        ErrorOf::Length => (deviation.length, 1.0 / (1.0 + deviation.length)),
        _ => (0.0, 1.0),
    }
}

/// Largest relative deviation of the length about which a response is linearised.
const LARGEST_ERROR_OF_LENGTH: f64 = 0.1;

/// Change of a delay, in samples, below which the iteration over the delay ends: for a front that
/// rises in one sample the error of the linearisation is then 0.1 %.
const DELAY_SETTLED: f64 = 0.05;

/// Returns true if a delay \[s\] of one of `tests` differs from its value in `before` by more than
/// the linearisation permits.
pub(crate) fn are_moved(tests: &[RodTest], before: &[Deviation], after: &[Deviation]) -> bool {
    let mut each = tests.iter().zip(before.iter().zip(after));
    each.any(|(test, (b, a))| (a.delay - b.delay).abs() * test.sampling_rate_hz >= DELAY_SETTLED)
}

/// Error of the response to a front on its grid, divided by the change of the response on a grid of
/// a quarter of the spacing, if the error is of first order in the spacing.
const MISSING_OF_FRONT: f64 = 4.0 / 3.0;

/// One column of the covariance, prepared for its factor.
#[derive(Debug, Clone)]
struct Direction {
    /// Unit vector along the column after the factors before it.
    unit: Vec<f64>,
    /// 1 - 1/√(1 + |a|²)
    removed: f64,
}

/// The common errors of several tests, as factors to apply to the white residual.
#[derive(Debug, Clone, Default)]
pub(crate) struct CommonErrors {
    /// The error of each column; `None` for the front of one test.
    errors: Vec<Option<CommonError>>,
    columns: Vec<Vec<f64>>,
    /// Columns of A before whitening [m/s].
    velocities: Vec<Vec<f64>>,
    directions: Vec<Direction>,
    /// Delay and length of each test about which its response is linearised.
    deviations: Vec<Deviation>,
    /// Linearised response of each test at the stated delay and length minus that at `deviations`,
    /// plus the correction for a finer grid of the front [m/s].
    offsets: Vec<Vec<f64>>,
    /// Change of the response on a finer grid of the front [m/s], for each test that has such a
    /// grid.
    of_fronts: Vec<Option<Vec<f64>>>,
}

impl CommonErrors {
    /// Computes the factors for `tests` at θ, with the rods driven by their most likely
    /// excitations, for responses linearised about `deviations`. The columns are multiplied by
    /// `weight`. From `known`, the factors at the same θ with other excitations, the changes on the
    /// finer grids of the fronts are reused. Returns `None` if the model does not exist at θ.
    pub(crate) fn at<'a, M: RodModel + ?Sized>(
        (model, parameters): (&M, &[f64]),
        tests: &[RodTest],
        (deviations, known): (Vec<Deviation>, Option<&Self>),
        seen: impl Fn(usize) -> Option<(DrivenRod<'a>, &'a Weighting)> + Sync,
        weight: f64,
    ) -> Option<Self> {
        let mut common = Self {
            deviations,
            ..Self::default()
        };
        let is_linear = model.is_linear();
        let has_none =
            |test: &RodTest| test.common_errors.is_empty() && test.finer_front(is_linear).is_none();
        if tests.iter().all(has_none) {
            return Some(common);
        }
        let marched = all_in_order(tests.len(), |index| {
            let test = tests.get(index)?;
            let (rod, weighting) = seen(index)?;
            let deviation = common.deviation(index);
            let delay = deviation.delay;
            let effects = test.common_errors.iter().map(|error| {
                let mut own = derivative(model, parameters, &rod, error.of)?;
                let (_, factor) = of_error(deviation, error.of);
                own.iter_mut().for_each(|v| *v *= factor);
                Some(weighting.seen(test, own))
            });
            // an error of the length hardly changes the difference between the responses on the two
            // grids
            let same_delay =
                |known: &&Self| known.deviation(index).delay.to_bits() == delay.to_bits();
            let known_front = known
                .filter(same_delay)
                .and_then(|known| known.of_fronts.get(index).cloned().flatten());
            let of_front = match (test.finer_front(is_linear), known_front) {
                (None, _) => None,
                (Some(_), Some(known)) => Some(known),
                (Some(finer), None) => {
                    Some(finer.difference((model, parameters), (&rod, test.window), delay)?)
                }
            };
            Some((effects.collect::<Option<Vec<_>>>()?, of_front))
        })?;
        let samples = tests.iter().map(|test| test.window).sum();
        let mut begin = 0;
        for ((index, test), (effects, of_front)) in tests.iter().enumerate().zip(marched) {
            let (_, weighting) = seen(index)?;
            let deviation = common.deviation(index);
            let mut offset = Vec::new();
            for (place, (error, mut own)) in test.common_errors.iter().zip(effects).enumerate() {
                let (value, _) = of_error(deviation, error.of);
                // `value` is the sum of all errors of this kind, so that it is subtracted once
                let is_first = !test
                    .common_errors
                    .iter()
                    .take(place)
                    .any(|e| e.of == error.of);
                if value != 0.0 && is_first {
                    offset.resize(own.len(), 0.0);
                    let pairs = offset.iter_mut().zip(&own);
                    pairs.for_each(|(sum, by)| *sum -= value * by);
                }
                let place = common.place_of(error, samples);
                own.iter_mut()
                    .for_each(|v| *v *= error.standard_uncertainty);
                common.fill((place, begin), own, weighting, weight)?;
            }
            common.of_fronts.push(of_front.clone());
            if let Some(own) = of_front {
                offset.resize(own.len(), 0.0);
                let pairs = offset.iter_mut().zip(&own);
                pairs.for_each(|(sum, by)| *sum += MISSING_OF_FRONT * by);
                let place = common.new_place(None, samples);
                common.fill((place, begin), own, weighting, weight)?;
            }
            common.offsets.push(offset);
            begin += test.window;
        }
        common.factorise();
        Some(common)
    }

    /// Writes the effect [m/s] of one standard uncertainty on a test into the column at `place`,
    /// from the row `begin` on.
    fn fill(
        &mut self,
        (place, begin): (usize, usize),
        mut effect: Vec<f64>,
        weighting: &Weighting,
        weight: f64,
    ) -> Option<()> {
        let rows = begin..begin + effect.len();
        let velocities = self.velocities.get_mut(place)?;
        velocities.get_mut(rows.clone())?.copy_from_slice(&effect);
        weighting.whiten(&mut effect);
        effect.iter_mut().for_each(|v| *v *= weight);
        let column = self.columns.get_mut(place)?;
        column.get_mut(rows)?.copy_from_slice(&effect);
        Some(())
    }

    /// Computes the factor of each column.
    fn factorise(&mut self) {
        for column in &self.columns {
            let mut unit = column.clone();
            self.directions.iter().for_each(|d| d.apply(&mut unit));
            let square: f64 = unit.iter().map(|a| a * a).sum();
            if square > 0.0 {
                let length = square.sqrt();
                unit.iter_mut().for_each(|a| *a /= length);
                self.directions.push(Direction {
                    unit,
                    removed: 1.0 - 1.0 / (1.0 + square).sqrt(),
                });
            }
        }
    }

    #[cfg(test)]
    fn of_columns(columns: Vec<Vec<f64>>) -> Self {
        let mut common = Self {
            columns,
            ..Self::default()
        };
        common.factorise();
        common
    }

    fn known_place_of(&self, error: &CommonError) -> Option<usize> {
        let same = |known: &CommonError| known.of == error.of && known.shared_by == error.shared_by;
        let mut each = self.errors.iter();
        each.position(|known| known.as_ref().is_some_and(same))
    }

    /// Index of the column of `error`, a new column if no earlier test has that error.
    fn place_of(&mut self, error: &CommonError, samples: usize) -> usize {
        self.known_place_of(error)
            .unwrap_or_else(|| self.new_place(Some(error.clone()), samples))
    }

    fn new_place(&mut self, error: Option<CommonError>, samples: usize) -> usize {
        self.errors.push(error);
        self.columns.push(vec![0.0; samples]);
        self.velocities.push(vec![0.0; samples]);
        self.errors.len() - 1
    }

    /// Returns true if there is no error.
    pub(crate) fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Delay and length of a test about which its response is linearised.
    pub(crate) fn deviation(&self, test: usize) -> Deviation {
        self.deviations.get(test).copied().unwrap_or_default()
    }

    /// Adds to the response of a test at its deviation the difference from the linearised response
    /// at the stated delay and length, and the correction for a finer grid of the front.
    pub(crate) fn add_offset(&self, test: usize, velocity: &mut [f64]) {
        for (v, offset) in velocity
            .iter_mut()
            .zip(self.offsets.get(test).into_iter().flatten())
        {
            *v += offset;
        }
    }

    /// The most likely errors in units of their standard uncertainties, for a white residual of all
    /// tests before the factors are applied.
    fn most_likely(&self, mut white: Vec<f64>) -> Vec<f64> {
        // (1 + AᵀA)⁻¹ Aᵀ = Aᵀ (1 + A Aᵀ)⁻¹
        self.without(&mut white);
        let along =
            |column: &Vec<f64>| -> f64 { column.iter().zip(&white).map(|(a, r)| a * r).sum() };
        self.columns.iter().map(|column| -along(column)).collect()
    }

    /// The part of the response of all tests that the most likely errors explain [m/s].
    pub(crate) fn explained(&self, white: Vec<f64>) -> Vec<f64> {
        let mut explained = vec![0.0; white.len()];
        for (value, column) in self.most_likely(white).iter().zip(&self.velocities) {
            for (e, a) in explained.iter_mut().zip(column) {
                *e += value * a;
            }
        }
        explained
    }

    /// The most likely delay and length of each test; 0 where no error is stated.
    pub(crate) fn most_likely_deviations(
        &self,
        tests: &[RodTest],
        white: Vec<f64>,
    ) -> Vec<Deviation> {
        let values = self.most_likely(white);
        let value_of = |error: &CommonError| {
            let place = self.known_place_of(error)?;
            Some(error.standard_uncertainty * values.get(place)?)
        };
        tests
            .iter()
            .map(|test| {
                let sum = |of: ErrorOf, largest: f64| -> f64 {
                    let errors = test.common_errors.iter();
                    let own = errors.filter(|error| error.of == of);
                    let sum: f64 = own.filter_map(value_of).sum();
                    sum.clamp(-largest, largest)
                };
                // the excitation is known for this time beyond the window
                let longest = Nuisances::LARGEST_DELAY / test.sampling_rate_hz;
                Deviation {
                    delay: sum(ErrorOf::Delay, longest),
                    length: sum(ErrorOf::Length, LARGEST_ERROR_OF_LENGTH),
                }
            })
            .collect()
    }

    /// Applies the inverse square root of I + A Aᵀ to a white column of all tests.
    pub(crate) fn whiten(&self, column: &mut [f64]) {
        self.directions.iter().for_each(|d| d.apply(column));
    }

    /// Applies the inverse of I + A Aᵀ: a white residual minus the part of the most likely errors.
    pub(crate) fn without(&self, column: &mut [f64]) {
        self.whiten(column);
        self.directions.iter().rev().for_each(|d| d.apply(column));
    }

    /// Estimates of the stated errors, from the `white` residual (simulated minus measured) and its
    /// derivatives with respect to the other unknowns, at their minimum and before the factors are
    /// applied.
    #[allow(
        clippy::indexing_slicing,
        reason = "a right singular vector has an entry for each unknown, the errors being the last"
    )]
    pub(crate) fn estimates(&self, mut white: Linearisation) -> Vec<CommonErrorEstimate> {
        let others = white.jacobian.len();
        let count = self.columns.len();
        // rows of the priors with a residual of 0: each error is 0, with a standard deviation of 1
        white.jacobian.extend(self.columns.iter().cloned());
        white.residual.extend(vec![0.0; count]);
        for (index, column) in white.jacobian.iter_mut().enumerate() {
            let rows = 0..count;
            column.extend(rows.map(|k| if others + k == index { 1.0 } else { 0.0 }));
        }
        let ones = vec![1.0; white.jacobian.len()];
        let Some(svd) = ScaledDecomposition::new(&white, &ones) else {
            return Vec::new();
        };
        let each = self.errors.iter().enumerate();
        each.filter_map(|(k, error)| {
            let error = error.as_ref()?;
            let (mut value, mut variance) = (0.0, 0.0);
            let parts = svd.right.iter().zip(&svd.singular_values);
            for ((vector, s), projected) in parts.zip(&svd.projected) {
                let own = vector[others + k] / s;
                value -= own * projected;
                variance += own * own;
            }
            Some(CommonErrorEstimate {
                error: error.clone(),
                value: error.standard_uncertainty * value,
                standard_error: error.standard_uncertainty * f64::sqrt(variance),
            })
        })
        .collect()
    }
}

impl Direction {
    fn apply(&self, column: &mut [f64]) {
        let along: f64 = self.unit.iter().zip(&*column).map(|(u, c)| u * c).sum();
        for (c, u) in column.iter_mut().zip(&self.unit) {
            *c -= self.removed * along * u;
        }
    }
}

/// Relative change of an excitation, to either side, for the numerical derivative of the response
/// with respect to the gain of the excitation.
const GAIN_DIFFERENCE: f64 = 1e-3;

/// Relative change of the lateral inertia, to either side, for its numerical derivative.
const INERTIA_DIFFERENCE: f64 = 1e-2;

/// Shift in time, in samples, to either side, for the numerical derivative with respect to a delay.
const TIME_DIFFERENCE: f64 = 0.1;

/// Derivative of the simulated response with respect to an error [m/s].
fn derivative<M: RodModel + ?Sized>(
    model: &M,
    parameters: &[f64],
    rod: &DrivenRod<'_>,
    of: ErrorOf,
) -> Option<Vec<f64>> {
    let difference = |more: &[f64], less: &[f64], by: f64| -> Vec<f64> {
        more.iter().zip(less).map(|(m, l)| (m - l) / by).collect()
    };
    match of {
        ErrorOf::ResponseGain => response_of(model, rod, parameters),
        ErrorOf::Length => {
            let by_parameter = linearised_response_of(model, rod, parameters)?.by_parameter;
            let mut sum = vec![0.0; rod.times.len()];
            let sensitivities = model.specimen_sensitivities(parameters);
            for (column, sensitivity) in by_parameter.iter().zip(sensitivities) {
                for (s, d) in sum.iter_mut().zip(column) {
                    *s -= sensitivity.length * d;
                }
            }
            Some(sum)
        }
        ErrorOf::LateralInertia => {
            let scaled = |factor: f64| {
                let rod = DrivenRod {
                    lateral_inertia: factor * rod.lateral_inertia,
                    ..*rod
                };
                response_of(model, &rod, parameters)
            };
            let (less, more) = (
                scaled(1.0 - INERTIA_DIFFERENCE)?,
                scaled(1.0 + INERTIA_DIFFERENCE)?,
            );
            Some(difference(&more, &less, 2.0 * INERTIA_DIFFERENCE))
        }
        ErrorOf::ExcitationGain => {
            // the motion is the record divided by the gain
            let scaled = |factor: f64| -> Option<Vec<f64>> {
                let samples: Vec<f64> = rod.samples.iter().map(|v| factor * v).collect();
                let rate = rod.sampling_rate_hz;
                let excitation = rodwave::band_limited::SampledHistory::new(&samples, rate).ok()?;
                let rod = DrivenRod {
                    samples: &samples,
                    excitation: &excitation,
                    ..*rod
                };
                response_of(model, &rod, parameters)
            };
            let (less, more) = (
                scaled(1.0 - GAIN_DIFFERENCE)?,
                scaled(1.0 + GAIN_DIFFERENCE)?,
            );
            Some(difference(&less, &more, 2.0 * GAIN_DIFFERENCE))
        }
        ErrorOf::Delay => {
            let h = TIME_DIFFERENCE / rod.sampling_rate_hz;
            let shifted = |by: f64| -> Option<Vec<f64>> {
                let times = delayed(rod.times, by);
                let rod = DrivenRod {
                    times: &times,
                    ..*rod
                };
                response_of(model, &rod, parameters)
            };
            Some(difference(&shifted(h)?, &shifted(-h)?, 2.0 * h))
        }
    }
}

#[cfg(test)]
mod tests;
