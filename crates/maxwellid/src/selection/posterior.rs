//! The most probable parameters of one candidate, and the evidence for it.

use crate::common_error::CommonErrors;
use crate::error::MaxwellidError;
use crate::least_squares::{
    LeastSquares, Linearisation, Minimum, ScaledDecomposition, minimise_to, sum_of_squares, within,
};
use crate::model::{RodModel, linearised_response_of, response_of};
use crate::parallel::map_in_order;
use crate::selection::candidate::{Candidate, Prior};
use crate::selection::seen_test::{AtParameters, Inputs, SeenTest, SeenTests, rough_level};
use crate::test::RodTest;
use crate::whitening::TRANSFER_HOLDS;

/// Whitened residuals of all tests, followed by one row per parameter for its prior.
pub(crate) struct PosteriorProblem<'a> {
    pub(crate) model: &'a dyn RodModel,
    /// The tests, each with its most probable excitation.
    pub(crate) tests: &'a [SeenTest<'a>],
    pub(crate) common: &'a CommonErrors,
    /// Factor on the whitened residuals: 1/(standard deviation).
    pub(crate) weight: f64,
    pub(crate) prior: &'a Prior,
    /// Longest cell of a grid \[m\].
    pub(crate) cell: f64,
}

impl PosteriorProblem<'_> {
    pub(crate) fn samples(&self) -> usize {
        self.tests.iter().map(SeenTest::count).sum()
    }

    /// Whitens and weights a column of the samples of all tests [m/s].
    fn whiten(&self, column: &mut [f64]) {
        let mut rest = &mut *column;
        for test in self.tests {
            let (of_test, others) = rest.split_at_mut(test.count());
            rest = others;
            test.whiten(of_test);
        }
        for value in &mut *column {
            *value *= self.weight;
        }
        self.common.whiten(column);
    }

    fn finish(&self, mut simulated: Vec<f64>, parameters: &[f64]) -> Vec<f64> {
        let targets = self.tests.iter().flat_map(SeenTest::target);
        for (value, target) in simulated.iter_mut().zip(targets) {
            *value -= target;
        }
        self.whiten(&mut simulated);
        simulated.extend(
            parameters
                .iter()
                .zip(&self.prior.mean)
                .zip(&self.prior.deviation)
                .map(|((value, mean), deviation)| (value - mean) / deviation),
        );
        simulated
    }
}

impl LeastSquares for PosteriorProblem<'_> {
    fn residual(&self, parameters: &[f64]) -> Option<Vec<f64>> {
        let of_tests = map_in_order(self.tests, |test| {
            let response = response_of(self.model, &test.rod(self.cell), parameters)?;
            Some(test.seen(response))
        });
        let simulated = of_tests.into_iter().collect::<Option<Vec<_>>>()?.concat();
        let residual = self.finish(simulated, parameters);
        residual.iter().all(|r| r.is_finite()).then_some(residual)
    }

    fn linearisation(&self, parameters: &[f64]) -> Option<Linearisation> {
        let samples = self.samples();
        let of_tests = map_in_order(self.tests, |test| {
            let rod = test.rod(self.cell);
            let response = linearised_response_of(self.model, &rod, parameters)?;
            let by_parameter = response.by_parameter.into_iter();
            let seen: Vec<Vec<f64>> = by_parameter.map(|own| test.seen(own)).collect();
            Some((test.seen(response.velocity), seen))
        });
        let mut simulated = Vec::with_capacity(samples + parameters.len());
        let mut jacobian = vec![Vec::with_capacity(samples + parameters.len()); parameters.len()];
        for of_test in of_tests {
            let (velocity, by_parameter) = of_test?;
            simulated.extend(velocity);
            let pairs = jacobian.iter_mut().zip(by_parameter);
            pairs.for_each(|(column, own)| column.extend(own));
        }
        for (index, column) in jacobian.iter_mut().enumerate() {
            self.whiten(column);
            let rows = self.prior.deviation.iter().enumerate();
            column.extend(rows.map(|(row, s)| if row == index { 1.0 / s } else { 0.0 }));
        }
        let residual = self.finish(simulated, parameters);
        let finite = residual.iter().all(|r| r.is_finite())
            && jacobian.iter().flatten().all(|d| d.is_finite());
        finite.then_some(Linearisation { residual, jacobian })
    }

    fn step_limits(&self) -> Vec<f64> {
        self.model.step_limits()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        self.model.bounds()
    }
}

/// Result of a fit with a prior.
#[derive(Debug, Clone)]
pub(crate) struct Posterior {
    pub(crate) minimum: Minimum,
    /// Σ of the squares of the whitened, weighted residuals.
    pub(crate) chi_square: f64,
    /// Σ of the squares of the prior's rows.
    pub(crate) prior_square: f64,
    /// ½ ln det(1 + S Jᵀ J S), with the standard deviations S of the prior: the logarithm of the
    /// factor by which the data narrow the prior.
    pub(crate) occam: f64,
    /// Number of parameters that the data determine better than the prior: Σ s²/(1 + s²).
    pub(crate) determined: f64,
    /// The excitations, delays and lengths about which the tests are linearised.
    pub(crate) inputs: Inputs,
    /// True if χ² no longer changes when the excitation is estimated again.
    pub(crate) is_settled: bool,
}

/// Greatest likelihood of a candidate: its best fit without the prior.
#[derive(Debug, Clone)]
pub(crate) struct Likeliest {
    pub(crate) parameters: Vec<f64>,
    /// Σ of the squares of the whitened, weighted residuals.
    pub(crate) chi_square: f64,
    /// The whitened residuals.
    pub(crate) residual: Vec<f64>,
    pub(crate) is_settled: bool,
    /// Place of the special case from which the fit was found; `None` if the fit is near the most
    /// probable parameters.
    pub(crate) of_case: Option<usize>,
}

/// Place of the special case to which a start belongs, if any, and the starting parameters.
type Start = (Option<usize>, Vec<f64>);

/// The most probable parameters from the best of several starts.
pub(crate) struct Searched {
    pub(crate) probable: Posterior,
    /// Place of the special case, if the fit started from this case alone.
    pub(crate) of_case: Option<usize>,
}

/// Longest cell of the coarse grid on which starts are compared \[m\].
const SCAN_CELL: f64 = 8e-3;

/// Factors on E for the starts of linear models, because the time of flight may be off by a
/// fraction of a period.
const MODULUS_FACTORS: [f64; 3] = [1.0, 0.92, 1.09];

/// Number of starts of a linear model from which a minimum is sought. Its response is computed
/// fast, and laws with branches have several minima.
const LINEAR_STARTS: usize = 4;

/// Largest number of fits of a candidate, each with the excitation re-estimated. Without the secant
/// each fit reduces the change of χ² that remains to a tenth or less, or to 0.6 if the excitation
/// is that before the filter of a recorder.
const RENEWALS: usize = 16;

/// Number of successive fits that change the parameters, in standard errors, by no less than the
/// smallest change so far, after which the candidate is taken not to converge. This happens with
/// laws that do not explain the data.
const NO_NEARER: usize = 3;

/// Predicted relative reduction of χ² below which a fit ends: 1e-6 of a χ² of some hundreds
/// corresponds to a change of the parameters by a hundredth of their errors.
const REDUCTION: f64 = 1e-6;

/// Predicted relative reduction of χ² below which a preliminary minimisation ends, which shows
/// whether two starts lead to one minimum.
const PRELIMINARY: f64 = 1e-4;

/// Change of χ² between two fits below which the excitation is not re-estimated again; the change
/// of ln Z is half of it, 0.01.
const SETTLED: f64 = 0.02;

/// Limit of that change as a fraction of χ², if this is larger: a law with such a large χ² is
/// refuted in any case.
const SETTLED_SHARE: f64 = 1e-4;

/// Sum of all further reductions of χ² divided by the last one, if each re-estimation of the
/// excitation reduces χ² by three quarters of the previous reduction.
const STILL_FALLS: f64 = 3.0;

/// Change of the parameters, in standard errors, below which a fit that had converged before is
/// accepted after one re-estimation of the excitation.
const UNMOVED: f64 = 0.1;

/// Returns true if χ² changes by less than [`SETTLED`], or by less than the fraction
/// [`SETTLED_SHARE`] of it, between two fits.
fn is_settled(last: f64, next: f64) -> bool {
    (next - last).abs() < SETTLED.max(SETTLED_SHARE * next)
}

/// Amount by which χ² of a law must exceed that of a special case before the law is also fitted
/// from this case, and by which the second fit must be better.
const WORSE: f64 = 0.02;

/// Distances from the mean of the prior, in standard deviations. If a parameter of a special case
/// is further from the mean than the largest distance, fits also start with the parameter at each
/// of these distances: further out the response hardly depends on the parameter, and a fit would
/// move it back by no more than a step limit per iteration.
const BACK: [f64; 3] = [1.0, 2.0, 3.0];

/// A law that is a limit of a candidate.
pub(crate) struct Limiting<'a> {
    /// Parameters at which the candidate equals the law.
    pub(crate) parameters: Vec<f64>,
    /// Smallest χ² of the law.
    pub(crate) chi_square: f64,
    /// The most probable fit of the law; `None` if its excitation is not of the kind that drives
    /// the candidate: a linear rod is driven by the excitation after the filter of the recorder, a
    /// nonlinear one by that before the filter.
    pub(crate) probable: Option<&'a Posterior>,
}

/// One candidate with its tests.
pub(crate) struct Contest<'a> {
    pub(crate) candidate: &'a Candidate,
    pub(crate) prior: &'a Prior,
    pub(crate) tests: &'a [RodTest],
    pub(crate) times: &'a [Vec<f64>],
    pub(crate) cell: f64,
    /// Factor on the whitened residuals.
    pub(crate) weight: f64,
    /// χ² above which the excitation is not re-estimated again, because the candidate cannot
    /// explain the data.
    pub(crate) hopeless: f64,
}

impl<'a> Contest<'a> {
    /// Creates the contest of `candidate` on `tests` with samples at `times`, with a factor of 1 on
    /// the residuals and no limit of χ².
    pub(crate) fn of(
        candidate: &'a Candidate,
        prior: &'a Prior,
        (tests, times): (&'a [RodTest], &'a [Vec<f64>]),
        cell: f64,
    ) -> Self {
        Self {
            candidate,
            prior,
            tests,
            times,
            cell,
            weight: 1.0,
            hopeless: f64::INFINITY,
        }
    }
}

impl Contest<'_> {
    pub(crate) fn problem<'a>(&'a self, seen: &'a SeenTests<'a>) -> PosteriorProblem<'a> {
        PosteriorProblem {
            model: self.candidate.model.as_ref(),
            tests: &seen.tests,
            common: &seen.common,
            weight: self.weight,
            prior: self.prior,
            cell: self.cell,
        }
    }

    /// Tests weighted at θ; `None` if the model does not exist there.
    pub(crate) fn seen(&self, parameters: &[f64]) -> Option<SeenTests<'_>> {
        self.seen_after(parameters, Inputs::default())
    }

    /// Tests weighted at the parameters, excitations, delays and lengths of a fit.
    pub(crate) fn seen_at(&self, found: &Posterior) -> Option<SeenTests<'_>> {
        self.seen_after(&found.minimum.parameters, found.inputs.clone())
    }

    /// Tests weighted at θ, starting from these excitations, delays and lengths.
    fn seen_after(&self, parameters: &[f64], inputs: Inputs) -> Option<SeenTests<'_>> {
        SeenTests::of(self.tests, self.at(parameters), inputs)
    }

    fn at<'a>(&'a self, parameters: &'a [f64]) -> AtParameters<'a> {
        AtParameters {
            model: self.candidate.model.as_ref(),
            parameters,
            cell: self.cell,
            weight: self.weight,
        }
    }

    /// Misfit for the comparison of starts: the squares of the residuals divided by `levels`, and
    /// of the deviations from the prior; `None` if the model does not exist at `start`.
    fn rough_misfit(&self, start: &[f64], levels: &[f64]) -> Option<f64> {
        let mut sum = 0.0;
        for ((test, times), level) in self.tests.iter().zip(self.times).zip(levels) {
            let rod = test.driven_rod(times, self.cell.max(SCAN_CELL));
            let response = response_of(&self.candidate.model, &rod, start)?;
            sum += response
                .iter()
                .zip(test.response())
                .map(|(s, m)| ((s - m) / level).powi(2))
                .sum::<f64>();
        }
        let prior = self.prior.mean.iter().zip(&self.prior.deviation);
        let unlikely = start
            .iter()
            .zip(prior)
            .map(|(t, (m, s))| ((t - m) / s).powi(2));
        Some(sum + unlikely.sum::<f64>())
    }

    /// Finds the most probable parameters, from the best of the candidate's starts for `modulus`
    /// and from its special cases; `None` if the model exists at none of them.
    pub(crate) fn search(
        &self,
        modulus: f64,
        duration: f64,
        special_cases: &[Limiting<'_>],
    ) -> Result<Option<Searched>, MaxwellidError> {
        let levels = self
            .tests
            .iter()
            .map(rough_level)
            .collect::<Result<Vec<_>, _>>()?;
        let (factors, followed) = if self.candidate.model.is_linear() {
            (&MODULUS_FACTORS[..], LINEAR_STARTS)
        } else {
            (&MODULUS_FACTORS[..1], 1)
        };
        let of_candidate = factors
            .iter()
            .flat_map(|factor| self.candidate.starts(modulus * factor, duration))
            .map(|start| (None, start));
        let of_cases = special_cases.iter().enumerate().flat_map(|(place, case)| {
            let starts = self.starts_of(case).into_iter();
            starts.map(move |start| (Some(place), start))
        });
        let starts: Vec<Start> = of_candidate.chain(of_cases).collect();
        let misfits = map_in_order(&starts, |(_, start)| self.rough_misfit(start, &levels));
        let mut ranked: Vec<(f64, &Start)> = misfits
            .into_iter()
            .zip(&starts)
            .filter_map(|(misfit, start)| Some((misfit?, start)))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked.truncate(followed);
        let of_case = match ranked.as_slice() {
            [(_, (of_case, _))] => *of_case,
            _ => None,
        };
        let first: Vec<&Vec<f64>> = ranked.iter().map(|(_, (_, start))| start).collect();
        let distinct = self.distinct_minima(&first)?;
        let found = map_in_order(&distinct, |start| self.from(start));
        let mut best: Option<Posterior> = None;
        for posterior in found {
            best = Posterior::better(best, posterior?);
        }
        Ok(best.map(|probable| Searched { probable, of_case }))
    }

    /// Starts from a special case: its parameters and, if some are outside the prior range, the
    /// parameters moved back to each of the distances [`BACK`].
    fn starts_of(&self, case: &Limiting<'_>) -> Vec<Vec<f64>> {
        let back = |deviations: f64| -> Vec<f64> {
            let prior = self.prior.mean.iter().zip(&self.prior.deviation);
            let pairs = case.parameters.iter().zip(prior);
            pairs
                .map(|(t, (mean, s))| t.max(mean - deviations * s).min(mean + deviations * s))
                .collect()
        };
        let mut starts = vec![case.parameters.clone()];
        let [.., most] = BACK;
        if back(most) != case.parameters {
            starts.extend(BACK.map(back));
        }
        starts
    }

    /// Distinct minima found from `starts`, of which the best is the first. The excitation is that
    /// of the best start for all of them, so that starts that lead to one minimum end at the same
    /// point.
    fn distinct_minima(&self, starts: &[&Vec<f64>]) -> Result<Vec<Vec<f64>>, MaxwellidError> {
        if let [start] = starts {
            return Ok(vec![start.to_vec()]);
        }
        let Some(tests) = starts.iter().find_map(|start| self.seen(start)) else {
            return Ok(Vec::new());
        };
        let problem = self.problem(&tests);
        let found = map_in_order(starts, |start| {
            minimise_to(&problem, start, 0.0, PRELIMINARY)
        });
        let mut distinct: Vec<Minimum> = Vec::new();
        for minimum in found {
            let Some(minimum) = minimum? else { continue };
            let is_known = |known: &Minimum| known.is_reached_from(&minimum.parameters);
            if !distinct.iter().any(is_known) {
                distinct.push(minimum);
            }
        }
        Ok(distinct
            .into_iter()
            .map(|minimum| minimum.parameters)
            .collect())
    }

    /// Finds the most probable parameters near `start`.
    pub(crate) fn from(&self, start: &[f64]) -> Result<Option<Posterior>, MaxwellidError> {
        self.settled_posterior(start, None)
    }

    /// Finds the most probable parameters near those of another fit, with its excitations.
    pub(crate) fn near_fit(&self, fit: &Posterior) -> Result<Option<Posterior>, MaxwellidError> {
        self.settled_posterior(&fit.minimum.parameters, Some(fit))
    }

    fn settled_posterior(
        &self,
        start: &[f64],
        fit: Option<&Posterior>,
    ) -> Result<Option<Posterior>, MaxwellidError> {
        let found = self.settled_from(start, fit)?;
        found
            .map(|found| Posterior::of(&self.problem(&found.seen), &found))
            .transpose()
    }

    /// Minimises from `start` and re-estimates excitation and covariance at the minimum, until χ²
    /// no longer changes; `None` if the model does not exist at `start`.
    ///
    /// Re-estimation and fit together are one step of a fixed-point iteration of the parameters.
    /// From the third step on, each step starts at the fixed point of the secant through the last
    /// two (Anderson 1965, depth one), so that an iteration that would alternate between two points
    /// converges to a point between them. If a converged `fit` is given and the first step hardly
    /// moves from `start`, the search ends after this step.
    fn settled_from(
        &self,
        start: &[f64],
        fit: Option<&Posterior>,
    ) -> Result<Option<Settled<'_>>, MaxwellidError> {
        let is_linear = self.candidate.model.is_linear();
        let before_filter = !is_linear && self.tests.iter().any(|t| t.drive(false).is_some());
        let bounds = self.candidate.model.bounds();
        let mut at = start.to_vec();
        let mut found: Option<Settled<'_>> = None;
        let (mut nearest, mut since) = (f64::INFINITY, 0);
        for _ in 0..RENEWALS {
            let last = found.as_ref();
            let last_chi_square = last.map(|last| last.chi_square);
            let held = last.filter(|last| {
                before_filter && last.minimum.movement(&last.transferred_at) < TRANSFER_HOLDS
            });
            let transferred_at = held.map_or(&at, |last| &last.transferred_at).clone();
            let seen = if let Some(last) = held {
                last.seen.clone().moved_to(self.tests, self.at(&at))
            } else {
                let of_last = last.map(|last| last.seen.inputs());
                let inputs = of_last.or_else(|| fit.map(|fit| fit.inputs.clone()));
                self.seen_after(&at, inputs.unwrap_or_default())
            };
            let Some(seen) = seen else {
                return Ok(found);
            };
            let problem = self.problem(&seen);
            let Some(minimum) = minimise_to(&problem, &at, 0.0, REDUCTION)? else {
                return Ok(found);
            };
            let of_data = minimum.linearisation.residual.iter();
            let chi_square = of_data.take(problem.samples()).map(|r| r * r).sum();
            // at unchanged parameters a re-estimation gives the same excitation, unless it starts
            // from the previous excitation, as it does before the filter
            let rests = minimum.parameters == at && !before_filter
                || last.is_none()
                    && fit.is_some_and(|fit| fit.is_settled)
                    && minimum.movement(&at) < UNMOVED;
            let is_settled =
                rests || last.is_some_and(|last| is_settled(last.chi_square, chi_square));
            let next = Settled {
                start: at,
                transferred_at,
                seen,
                minimum,
                chi_square,
                is_settled,
            };
            let last = last.map(|last| (&*last.start, &*last.minimum.parameters));
            at = within(&next.minimum.meeting(&next.start, last), &bounds);
            let movement = next.minimum.movement(&next.start);
            since = if movement < nearest { 0 } else { since + 1 };
            nearest = nearest.min(movement);
            let is_hopeless = last_chi_square.is_some_and(|last| {
                chi_square - STILL_FALLS * (last - chi_square).max(0.0) > self.hopeless
            });
            found = Some(next);
            if is_settled || is_hopeless || since >= NO_NEARER {
                break;
            }
        }
        Ok(found)
    }

    /// Finds the likeliest parameters near the most probable ones and near the special cases.
    /// Starts are used in ascending order of their known χ², but only those whose known χ² is below
    /// the best result so far.
    pub(crate) fn likeliest(
        &self,
        probable: &Posterior,
        special_cases: &[Limiting<'_>],
    ) -> Result<Option<Likeliest>, MaxwellidError> {
        let cases = special_cases.iter().enumerate();
        let cases = cases.map(|(place, case)| (Some(place), &case.parameters, case.probable));
        let own = (None, &probable.minimum.parameters, Some(probable));
        let mut starts: Vec<_> = std::iter::once(own).chain(cases).collect();
        let promised = |place: Option<usize>| {
            let case = place.and_then(|place| special_cases.get(place));
            case.map_or(probable.chi_square, |case| case.chi_square)
        };
        starts.sort_by(|a, b| promised(a.0).total_cmp(&promised(b.0)));
        let mut best: Option<Likeliest> = None;
        for (place, start, fit) in starts {
            let exceeds = |least: f64| {
                let best = best.as_ref();
                best.is_none_or(|best| best.chi_square > least + WORSE)
            };
            if exceeds(promised(place))
                && let Some(next) = self.likeliest_from(start, fit)?
                && exceeds(next.chi_square)
            {
                let is_near = probable.minimum.is_reached_from(&next.parameters);
                best = Some(Likeliest {
                    of_case: place.filter(|_| !is_near),
                    ..next
                });
            }
        }
        Ok(best)
    }

    fn likeliest_from(
        &self,
        start: &[f64],
        fit: Option<&Posterior>,
    ) -> Result<Option<Likeliest>, MaxwellidError> {
        let flat = self.prior.flat();
        let alone = Contest {
            prior: &flat,
            ..*self
        };
        let Some(found) = alone.settled_from(start, fit)? else {
            return Ok(None);
        };
        let mut residual = found.minimum.linearisation.residual;
        // the rows after those of the samples belong to the prior
        residual.truncate(alone.problem(&found.seen).samples());
        Ok(Some(Likeliest {
            parameters: found.minimum.parameters,
            chi_square: found.chi_square,
            residual,
            is_settled: found.is_settled,
            of_case: None,
        }))
    }
}

/// A fit with the excitation and covariance estimated at its start.
struct Settled<'a> {
    start: Vec<f64>,
    /// Parameters at which the transfers from excitation to response were computed.
    transferred_at: Vec<f64>,
    seen: SeenTests<'a>,
    minimum: Minimum,
    /// Σ of the squares of the whitened, weighted residuals.
    chi_square: f64,
    is_settled: bool,
}

impl Posterior {
    /// ln Z by Laplace's method, from the logarithm of the likelihood at the most probable
    /// parameters.
    pub(crate) fn ln_evidence(&self, ln_likelihood: f64) -> f64 {
        ln_likelihood - 0.5 * self.prior_square - self.occam
    }

    fn of(problem: &PosteriorProblem<'_>, found: &Settled<'_>) -> Result<Self, MaxwellidError> {
        let minimum = &found.minimum;
        let residual = &minimum.linearisation.residual;
        let (of_data, of_prior) = residual.split_at(problem.samples());
        let svd = ScaledDecomposition::new(&minimum.linearisation, &problem.prior.deviation)
            .ok_or(MaxwellidError::Decomposition {
                iteration: minimum.iterations,
            })?;
        // the rows contain data and prior: the squares of the singular values are 1 plus those for
        // the data alone
        let values = &svd.singular_values;
        Ok(Self {
            chi_square: sum_of_squares(of_data),
            prior_square: sum_of_squares(of_prior),
            occam: svd.singular_values.iter().map(|s| s.ln()).sum(),
            determined: values.iter().map(|s| 1.0 - 1.0 / (s * s)).sum(),
            inputs: found.seen.inputs(),
            is_settled: found.is_settled,
            minimum: minimum.clone(),
        })
    }

    /// The minimised function, -2 ln of the product of likelihood and prior.
    fn misfit(&self) -> f64 {
        self.chi_square + self.prior_square
    }

    /// Returns the more probable of two fits.
    pub(crate) fn better(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        match (one, other) {
            (Some(one), Some(other)) if other.misfit() < one.misfit() => Some(other),
            (one, other) => one.or(other),
        }
    }
}

#[cfg(test)]
mod tests;
