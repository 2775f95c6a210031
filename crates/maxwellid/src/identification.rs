//! Result of a fit.

use crate::agreement::FitFlag;
use crate::common_error::CommonErrorEstimate;
use crate::fit::{Course, root_mean_square};
use crate::identifiability::{
    IDENTIFIED_BELOW, Identifiability, Judged, Noise, Verdict, assess, correlation_inflation,
};
use crate::law::{IdentifiableLaw, Scale, StatedParameter};
use crate::least_squares::{
    Evaluations, LeastSquares, Linearisation, Minimum, ScaledDecomposition, Termination,
    sum_of_squares,
};
use crate::model::RodModel;
use crate::noise::{exceeds_noise, quiet_degrees, residual_variance};
use crate::nuisance::{NuisanceEstimate, Nuisances, Orthonormal};
use crate::parallel::map_in_order;
use crate::profile::Profile;
use crate::residual::TestResidual;
use crate::start::StartOutcome;

/// The result of a [`crate::Fit`].
#[derive(Debug, Clone)]
pub struct Identification<M> {
    model: M,
    parameters: Vec<f64>,
    /// Linearisation, divided by V0, with respect to θ. Gain, offset and the nuisances of the
    /// iteration are eliminated or, if there is a white linearisation, fixed.
    pub(crate) linearisation: Linearisation,
    /// White linearisation with respect to θ, with all nuisances eliminated; only if the noise was
    /// stated.
    pub(crate) white: Option<Linearisation>,
    pub(crate) lengths: Vec<usize>,
    white_lengths: Vec<usize>,
    unknowns: usize,
    /// Degrees of freedom of a noise that was estimated from quiet parts.
    quiet_degrees: Option<f64>,
    nuisances: Vec<Vec<NuisanceEstimate>>,
    common_errors: Vec<CommonErrorEstimate>,
    /// Most likely excitation of each test [m/s]; empty without noise.
    pub(crate) excitations: Vec<Vec<f64>>,
    termination: Termination,
    cell: f64,
    difference: f64,
    course: Course,
    /// Flags, one per parameter of the model, for a rise of χ² near the minimum that differs from
    /// the rise that the standard error implies.
    curved: Vec<bool>,
    /// Factor on the standard error of ln E, above 1 if χ² rises more slowly about the minimum than
    /// the error implies.
    widening: f64,
    /// Flags like `curved`, but with weights and excitation re-estimated at the ends of the
    /// intervals.
    bent: Vec<bool>,
    /// For each parameter of the model, the differences between the ends of its profile interval
    /// and its value: two if the interval is closed. Empty without profiles.
    ends: Vec<Vec<f64>>,
}

/// Range of the ratio of the half width of an interval to the half width that the standard error
/// implies, within which the standard error represents the interval.
pub(crate) const STRAIGHT: std::ops::RangeInclusive<f64> = 0.7..=1.4;

/// Greatest factor by which the standard error of ln E is widened to represent χ².
const WIDEST: f64 = 3.0;

impl<L: IdentifiableLaw> Identification<L> {
    /// The law at the minimum.
    #[must_use]
    pub fn law(&self) -> L {
        // the law exists at these parameters, because the residual does
        self.parameters
            .get(1..)
            .and_then(|of_law| self.model.with_parameters(of_law).ok())
            .unwrap_or_else(|| self.model.clone())
    }
}

impl<M: RodModel> Identification<M> {
    pub(crate) fn new(
        model: M,
        problem: &TestResidual<'_, M>,
        minimum: &Minimum,
        course: Course,
        difference: f64,
    ) -> Self {
        let of_model = problem.of_model();
        let eliminated = without_nuisances(&minimum.linearisation, of_model);
        let (linearisation, white) = if problem.weightings.is_empty() {
            (eliminated, None)
        } else {
            (
                over_impact_velocity(problem, minimum, of_model),
                Some(eliminated),
            )
        };
        let rows = minimum.linearisation.residual.len();
        let lengths: Vec<usize> = problem.times.iter().map(Vec::len).collect();
        let calibrations = (rows - lengths.iter().sum::<usize>()) / lengths.len().max(1);
        Self {
            nuisances: nuisance_estimates(problem, minimum),
            common_errors: problem.common_errors_at(&minimum.parameters),
            excitations: problem
                .weightings
                .iter()
                .map(|w| w.estimate.clone())
                .collect(),
            parameters: minimum.parameters.iter().take(of_model).copied().collect(),
            unknowns: unknowns(problem, minimum),
            quiet_degrees: quiet_degrees(problem.tests),
            white_lengths: lengths.iter().map(|length| length + calibrations).collect(),
            termination: minimum.termination,
            cell: problem.cell,
            model,
            linearisation,
            white,
            lengths,
            difference,
            course,
            curved: Vec::new(),
            widening: 1.0,
            bent: Vec::new(),
            ends: Vec::new(),
        }
        .with_curvature(problem, minimum)
    }

    /// Compares χ² at the ends of the interval of each parameter, along the line of the conditional
    /// minimum, with the rise implied by the standard error.
    ///
    /// A front that moves over a grid makes χ² rough in ln E. The parabola through both ends has
    /// its vertex near the minimum. The standard error of ln E follows from the width of the
    /// parabola if this error is larger than the linearised one.
    #[allow(
        clippy::indexing_slicing,
        reason = "a right singular vector has an entry for each parameter of the problem, those of the model being the first"
    )]
    fn with_curvature(mut self, problem: &TestResidual<'_, M>, minimum: &Minimum) -> Self {
        let count = problem.of_model();
        self.curved = vec![false; count];
        let unit = vec![1.0; minimum.parameters.len()];
        let (Some(_), Some(svd)) = (
            &self.white,
            ScaledDecomposition::new(&minimum.linearisation, &unit),
        ) else {
            return self;
        };
        let least = sum_of_squares(&minimum.linearisation.residual);
        let indices: Vec<usize> = (0..count).collect();
        let promised = QUANTILE_95 * self.error_factor();
        let rises = map_in_order(&indices, |index| {
            let mut along = vec![0.0; unit.len()];
            let mut variance = 0.0;
            for (vector, s) in svd.right.iter().zip(&svd.singular_values) {
                let own = vector[*index] / (s * s);
                variance += own * vector[*index];
                for (a, v) in along.iter_mut().zip(vector) {
                    *a += own * v;
                }
            }
            let error = variance.sqrt();
            // a parameter with this error is not identified, whether χ² is curved or not
            if !(error.is_finite() && error < 2.0 * IDENTIFIED_BELOW) {
                return None;
            }
            Some([-1.0, 1.0].map(|sign| {
                let half = sign * promised / error;
                let end: Vec<f64> = minimum
                    .parameters
                    .iter()
                    .zip(&along)
                    .map(|(t, a)| t + half * a)
                    .collect();
                let residual = problem.residual(&end);
                residual.map_or(f64::INFINITY, |r| sum_of_squares(&r) - least)
            }))
        });
        for (index, rises) in rises.into_iter().enumerate() {
            let Some(rises) = rises else { continue };
            if index == 0 {
                let [below, above] = rises.map(|rise| rise.max(0.0).sqrt());
                let ratio = 2.0 * promised / (below + above);
                self.widening = ratio.clamp(1.0, WIDEST);
                self.curved[0] = !(WIDEST.recip()..=WIDEST).contains(&ratio);
            } else {
                self.curved[index] = rises.into_iter().any(|rise| self.is_bent_by(rise));
            }
        }
        self
    }

    /// Returns true if a rise of χ² at an end of a 95 % interval differs from the rise that the
    /// standard error implies.
    pub(crate) fn is_bent_by(&self, rise: f64) -> bool {
        let promised = QUANTILE_95 * self.error_factor();
        // the rise is proportional to the square of the distance
        !STRAIGHT.contains(&(promised / rise.max(0.0).sqrt()))
    }

    /// Sets the flags of the parameters whose error does not represent χ² with weights and
    /// excitation re-estimated.
    pub(crate) fn with_bent(mut self, bent: Vec<bool>) -> Self {
        self.bent = bent;
        self.curved = self.curved_or_bent();
        self
    }

    fn curved_or_bent(&self) -> Vec<bool> {
        let both = self.curved.iter().zip(&self.bent);
        both.map(|(curved, bent)| *curved || *bent).collect()
    }

    /// Standard deviation of the white residual in stated standard deviations, by which the
    /// standard errors are multiplied.
    pub(crate) fn error_factor(&self) -> f64 {
        let (chi_square, degrees) = self.chi_square();
        residual_variance(chi_square, degrees, self.quiet_degrees).sqrt()
    }

    /// Determines `curved` from the profiles, which extend further than the curvature at the
    /// minimum: a parameter is not curved if its interval is closed and both halves agree with the
    /// standard error. The standard error of a parameter with a closed interval is at least that of
    /// the longer half, in the quantity as stated: an interval symmetric about a viscosity, whose
    /// reciprocal determines the response, would end too low. A stated parameter that depends on
    /// several coordinates has no profile; its error is valid only if none of these coordinates is
    /// curved.
    pub(crate) fn judged_by(mut self, profiles: &[Profile]) -> Self {
        let Some(found) = self.identifiability(Noise::Stated) else {
            return self;
        };
        let errors = &found.coordinate_errors;
        self.curved = profiles
            .iter()
            .zip(errors)
            .map(|(profile, error)| {
                let is_straight = |end: Option<f64>| {
                    end.is_some_and(|end| {
                        STRAIGHT.contains(&((end - profile.value).abs() / (QUANTILE_95 * error)))
                    })
                };
                !(is_straight(profile.lower) && is_straight(profile.upper))
            })
            .collect();
        self.curved = self.curved_or_bent();
        self.ends = profiles
            .iter()
            .map(|profile| {
                let ends = [profile.lower, profile.upper].into_iter().flatten();
                ends.map(|end| end - profile.value).collect()
            })
            .collect();
        self.course
            .flags
            .retain(|flag| !matches!(flag, FitFlag::Curved { .. }));
        self.flag_curvature();
        self
    }

    fn flag_curvature(&mut self) {
        let names = self.model.parameter_names();
        let lacking = names
            .iter()
            .enumerate()
            .filter(|(index, _)| self.lacks_interval(*index));
        let flags: Vec<FitFlag> = lacking
            .map(|(_, name)| FitFlag::Curved {
                parameter: (*name).to_owned(),
            })
            .collect();
        self.course.flags.extend(flags);
    }

    /// Marks the minimum as unsettled, because a profile has found a lower minimum.
    pub(crate) fn unsettled(mut self) -> Self {
        self.course.flags.push(FitFlag::Unsettled);
        self
    }

    /// Residual and derivatives for the comparison of the tests, the number of rows of each test,
    /// and the standard deviation of a row.
    pub(crate) fn scores(&self) -> (&Linearisation, &[usize], f64) {
        match &self.white {
            Some(white) => (white, &self.white_lengths, self.ratio_to_noise().max(1.0)),
            None => {
                let residual = &self.linearisation.residual;
                let inflation = correlation_inflation(residual, &self.lengths);
                let noise = root_mean_square(residual) * inflation.sqrt();
                (&self.linearisation, &self.lengths, noise)
            }
        }
    }

    pub(crate) fn with_flags(mut self, flags: Vec<FitFlag>) -> Self {
        let ratio = self.ratio_to_noise();
        if self.exceeds_noise() {
            self.course
                .flags
                .push(FitFlag::ResidualAboveNoise { ratio });
        }
        self.course.flags.extend(flags);
        self.flag_curvature();
        self
    }

    /// Sum of squares of the white residual, NaN without stated noise, and its degrees of freedom.
    fn chi_square(&self) -> (f64, f64) {
        let samples: usize = self.lengths.iter().sum();
        let degrees = samples.saturating_sub(self.unknowns).max(1) as f64;
        let white = self.white.as_ref();
        let chi_square = white.map_or(f64::NAN, |white| sum_of_squares(&white.residual));
        (chi_square, degrees)
    }

    /// Standard deviation of the whitened residual: 1 if it contains only the stated noise; NaN
    /// without stated noise.
    #[must_use]
    pub fn ratio_to_noise(&self) -> f64 {
        let (chi_square, degrees) = self.chi_square();
        (chi_square / degrees).sqrt()
    }

    /// Returns true if the variance of the residual exceeds that of the noise by more than three
    /// standard deviations of their ratio.
    fn exceeds_noise(&self) -> bool {
        let (chi_square, degrees) = self.chi_square();
        exceeds_noise(chi_square, degrees, self.quiet_degrees)
    }

    /// Returns true if a parameter of the law is at a bound of the search.
    fn is_at_a_bound(&self) -> bool {
        let bounds = self.model.bounds();
        self.termination == Termination::AtBound
            || self
                .parameters
                .iter()
                .zip(bounds)
                .skip(1)
                .any(|(value, (low, high))| *value <= low || *value >= high)
    }

    /// The fitted model, as given.
    #[must_use]
    pub fn model(&self) -> &M {
        &self.model
    }

    /// θ at the minimum, in the order of [`RodModel::parameter_names`].
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Young's modulus at the minimum \[Pa\].
    #[must_use]
    pub fn modulus(&self) -> f64 {
        self.parameters.first().map_or(f64::NAN, |t| t.exp())
    }

    /// Number of iterations in all stages.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.course.iterations
    }

    /// Number of solutions of the direct problems by the minimiser, in all stages.
    #[must_use]
    pub fn evaluations(&self) -> Evaluations {
        self.course.evaluations
    }

    /// Reason for the end of the last iteration.
    #[must_use]
    pub fn termination(&self) -> Termination {
        self.termination
    }

    /// All starts and their results.
    #[must_use]
    pub fn starts(&self) -> &[StartOutcome] {
        &self.course.starts
    }

    /// Number of minima that were found and rejected because their front did not arrive with the
    /// measured one.
    #[must_use]
    pub fn cycle_skips_left(&self) -> usize {
        self.course.cycle_skips_left
    }

    /// Remarks on the fit.
    #[must_use]
    pub fn flags(&self) -> &[FitFlag] {
        &self.course.flags
    }

    /// Longest cell of the grid \[m\].
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Difference of the simulated response from that on a grid with half the cell length, at the
    /// solution: largest rms among the tests, as a fraction of V0. The error of a scheme of second
    /// order is 4/3 of it.
    #[must_use]
    pub fn grid_difference(&self) -> f64 {
        self.difference
    }

    /// The unknown nuisances of each test, empty if all are fixed.
    #[must_use]
    pub fn nuisances(&self) -> &[Vec<NuisanceEstimate>] {
        &self.nuisances
    }

    /// Estimates of the errors of rods and transducers that the tests state.
    #[must_use]
    pub fn common_errors(&self) -> &[CommonErrorEstimate] {
        &self.common_errors
    }

    /// Root mean square of simulated minus measured response over V0: the error δ of (Ödeen 1993,
    /// paper D, section 4).
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        root_mean_square(&self.linearisation.residual)
    }

    /// Simulated minus measured response over V0, one slice per test.
    pub fn residuals(&self) -> impl Iterator<Item = &[f64]> {
        let mut rest = self.linearisation.residual.as_slice();
        self.lengths.iter().map(move |length| {
            let (of_test, others) = rest.split_at(*length);
            rest = others;
            of_test
        })
    }

    /// Returns standard errors and verdicts of all parameters for `noise`; `None` if the Jacobian
    /// cannot be decomposed, or for [`Noise::Stated`] without stated noise.
    #[must_use]
    pub fn identifiability(&self, noise: Noise) -> Option<Identifiability> {
        let white = match noise {
            Noise::Stated => Some((self.white.as_ref()?, self.error_factor())),
            _ => None,
        };
        let mut found = assess(
            &self.model,
            &self.parameters,
            &Judged {
                linearisation: &self.linearisation,
                white,
                widening: self.widening,
            },
            &self.lengths,
            noise,
        )?;
        if self.is_at_a_bound() {
            // at a bound the parameters are not a minimum of the sum of squares, so that their
            // standard errors are meaningless; the damping was found for the shape at the bound
            for estimate in found.estimates.iter_mut().skip(1) {
                estimate.verdict = Verdict::NotIdentifiable;
            }
        }
        if noise == Noise::Stated {
            let unsettled = self.course.flags.contains(&FitFlag::Unsettled);
            let stated = self.model.stated(&self.parameters);
            for (estimate, stated) in found.estimates.iter_mut().zip(&stated) {
                let longer = self.longer_half(stated) / QUANTILE_95;
                estimate.standard_error = estimate.standard_error.max(longer);
                let is_known = estimate.standard_error < IDENTIFIED_BELOW;
                if unsettled || !is_known || self.exceeds_its_error(stated) {
                    estimate.verdict = Verdict::NotIdentifiable;
                }
            }
        }
        Some(found)
    }

    /// Returns true if the standard error of a stated parameter does not represent the values that
    /// the data exclude. If a parameter depends on one coordinate with a closed profile, its error
    /// is that of the longer half of the profile, and represents the excluded values.
    fn exceeds_its_error(&self, stated: &StatedParameter) -> bool {
        let weights = stated.gradient.iter().enumerate();
        let own: Vec<usize> = weights
            .filter_map(|(index, weight)| (*weight != 0.0).then_some(index))
            .collect();
        match own.as_slice() {
            [index] => self.lacks_interval(*index),
            all => all.iter().any(|index| is_set(&self.curved, *index)),
        }
    }

    /// Returns true if neither the standard error nor a closed profile of a coordinate represents
    /// the values that the data exclude.
    fn lacks_interval(&self, index: usize) -> bool {
        let is_closed = self.ends.get(index).is_some_and(|ends| ends.len() == 2);
        is_set(&self.curved, index) && (is_set(&self.bent, index) || !is_closed)
    }

    /// Longer half of the 95 % profile interval of a stated parameter that depends on one
    /// coordinate; 0 for a parameter that depends on several coordinates, or without a profile.
    fn longer_half(&self, stated: &StatedParameter) -> f64 {
        let weights = stated.gradient.iter().zip(&self.ends);
        let mut own = weights.filter(|(weight, _)| **weight != 0.0);
        let (Some((weight, ends)), None) = (own.next(), own.next()) else {
            return 0.0;
        };
        let halves = ends.iter().map(|end| match stated.scale {
            Scale::Ratio => (weight * end).exp_m1().abs(),
            Scale::Difference => (weight * end).abs(),
        });
        halves.fold(0.0, f64::max)
    }
}

fn is_set(flags: &[bool], index: usize) -> bool {
    flags.get(index).is_some_and(|flag| *flag)
}

/// The 97.5 % quantile of the normal distribution.
pub(crate) const QUANTILE_95: f64 = 1.959_963_984_540_054;

/// Orthogonalises the columns of θ to those of the nuisance parameters. At a minimum the residual
/// is orthogonal to the columns of the nuisance parameters.
fn without_nuisances(linearisation: &Linearisation, of_model: usize) -> Linearisation {
    let mut linearisation = linearisation.clone();
    let of_nuisances = linearisation.jacobian.split_off(of_model);
    if !of_nuisances.is_empty() {
        let orthonormal = Orthonormal::of(&of_nuisances);
        for column in &mut linearisation.jacobian {
            orthonormal.take_from(column);
        }
    }
    linearisation
}

/// The residual divided by V0 at a white minimum, with its derivatives with respect to θ alone.
fn over_impact_velocity<M: RodModel>(
    problem: &TestResidual<'_, M>,
    minimum: &Minimum,
    of_model: usize,
) -> Linearisation {
    problem
        .over_impact_velocity(&minimum.parameters)
        .map_or_else(
            || Linearisation {
                residual: vec![f64::NAN; problem.samples()],
                jacobian: vec![vec![f64::NAN; problem.samples()]; of_model],
            },
            |mut linearisation| {
                linearisation.jacobian.truncate(of_model);
                linearisation
            },
        )
}

fn unknowns<M: RodModel>(problem: &TestResidual<'_, M>, minimum: &Minimum) -> usize {
    let Nuisances {
        response_gain,
        response_offset,
        ..
    } = problem.nuisances;
    let linear =
        usize::from(response_gain.is_unknown()) + usize::from(response_offset.is_unknown());
    minimum.parameters.len() + linear * problem.tests.len()
}

/// The nuisances with their standard errors, from the Jacobian with respect to all unknowns.
#[allow(
    clippy::indexing_slicing,
    reason = "the unknowns are θ, then the iterated nuisances of each test, which are all parameters of the minimum, then the eliminated \
              ones of each test: a right singular vector has an entry for each"
)]
fn nuisance_estimates<M: RodModel>(
    problem: &TestResidual<'_, M>,
    minimum: &Minimum,
) -> Vec<Vec<NuisanceEstimate>> {
    let mut estimates = vec![Vec::new(); problem.tests.len()];
    if !problem.nuisances.any() {
        return estimates;
    }
    let (Some(all), Some(linear)) = (
        problem.assembled(&minimum.parameters, false),
        problem.linear_nuisances(&minimum.parameters),
    ) else {
        return estimates;
    };
    let count = all.jacobian.len();
    let Some(svd) = ScaledDecomposition::new(&all, &vec![1.0; count]) else {
        return estimates;
    };
    let variance = if problem.weightings.is_empty() {
        sum_of_squares(&all.residual) / all.residual.len().saturating_sub(count).max(1) as f64
    } else {
        1.0
    };
    let standard_error = |index: usize| -> f64 {
        let sum: f64 = svd
            .right
            .iter()
            .zip(&svd.singular_values)
            .map(|(vector, s)| (vector[index] / s).powi(2))
            .sum();
        (variance * sum).sqrt()
    };
    let iterated = problem.nuisances.of_iteration();
    let first_linear = minimum.parameters.len();
    for (test, (estimates, linear)) in estimates.iter_mut().zip(&linear).enumerate() {
        for (k, (nuisance, _)) in iterated.iter().enumerate() {
            let index = problem.of_model() + test * iterated.len() + k;
            estimates.push(NuisanceEstimate {
                name: nuisance.name(),
                value: nuisance.reference() + minimum.parameters[index],
                standard_error: standard_error(index),
            });
        }
        let names = problem.nuisances.linear_names();
        for (k, ((name, reference), value)) in names.iter().zip(linear).enumerate() {
            estimates.push(NuisanceEstimate {
                name,
                value: reference + value,
                standard_error: standard_error(first_linear + test * names.len() + k),
            });
        }
    }
    estimates
}
