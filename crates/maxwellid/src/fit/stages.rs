//! The two stages of a fit: first from the starts to a minimum on a coarse grid, then from this
//! minimum on a grid that is fine enough, with the noise of both histories.

use super::{
    Course, Fit, Method, SCAN_CELL, modulus_at, padded, root_mean_square, start_error, value,
};
use crate::agreement::FitFlag;
use crate::common_error::{CommonErrors, are_moved};
use crate::deviation::Deviation;
use crate::error::MaxwellidError;
use crate::historical;
use crate::least_squares::{LeastSquares, Minimum, minimise, minimise_to, within};
use crate::model::{DEFAULT_CELL, RodModel};
use crate::parallel::all_in_order;
use crate::profile::Held;
use crate::residual::TestResidual;
use crate::start::{StartOutcome, arrival_lag, best_candidate, minima, modulus_after_lag, spread};
use crate::test::RodTest;
use crate::whitening::{TRANSFER_HOLDS, Transfer, Weighting};

/// Shortest cell chosen for accuracy \[m\].
pub(super) const SHORTEST_CELL: f64 = 0.25e-3;

/// Number of refinements after the first solution.
const REFINEMENTS: usize = 8;

/// Factor on the cell in each refinement, which doubles the work.
const FINER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Fraction of the requested accuracy for which a grid is chosen, because the error is computed at
/// the start and may be larger at the solution.
const MARGIN: f64 = 0.6;

/// Largest shift of a parameter by the error of the solver as a fraction of its standard error, if
/// noise is stated.
const SHARE_OF_ERROR: f64 = 0.3;

/// Largest number of minima that are rejected in succession because their front arrives at another
/// time than the measured one.
const CYCLE_SKIPS: usize = 5;

/// Largest number of rounds. Each round recomputes the transfer if the parameters have changed
/// enough, fits the parameters, and re-estimates the excitation.
const ROUNDS: usize = 24;

/// Predicted relative reduction of the sum of squares below which a minimisation of the first stage
/// ends.
const PRELIMINARY: f64 = 1e-4;

/// Predicted relative reduction of a white sum of squares below which a minimisation ends; for
/// about a hundred samples this is a χ² of 0.001.
const WHITE: f64 = 1e-5;

/// Number of successive rounds in which the transfer is due again and the parameters change by more
/// than [`NEARER`] times the smallest change so far, after which the fit ends without convergence.
/// This happens with laws that do not fit the data.
const NO_NEARER: usize = 3;
const NEARER: f64 = 0.9;

/// Change of the parameters in a round, in standard errors, below which the fit has converged.
pub(super) const SETTLED: f64 = 0.05;

impl<M: RodModel> Fit<M> {
    pub(super) fn minimise(
        &self,
        problem: &TestResidual<'_, M>,
        start: &[f64],
        reduction: Option<f64>,
    ) -> Result<Option<Minimum>, MaxwellidError> {
        let rounding = rounding(problem);
        match (self.method, reduction) {
            (Method::DampedLeastSquares, None) => minimise(problem, start, rounding),
            (Method::DampedLeastSquares, Some(reduction)) => {
                minimise_to(problem, start, rounding, reduction)
            }
            (Method::Historical, _) => historical::minimise(problem, start, rounding),
        }
    }

    /// First stage: θ of the model from the starts, on a coarse grid, with the correct arrival of
    /// the front.
    pub(super) fn coarse(
        &self,
        tests: &[RodTest],
        modulus: f64,
        course: &mut Course,
    ) -> Result<Vec<f64>, MaxwellidError> {
        let cell = self.cell.unwrap_or(SCAN_CELL).max(SCAN_CELL);
        let problem = TestResidual::new(tests, &self.model, cell);
        let from = |modulus: f64| -> Vec<Vec<f64>> {
            if self.scan {
                self.model.starts(modulus, duration(tests))
            } else {
                vec![self.model.parameters(modulus)]
            }
        };
        let candidates = from(modulus);
        if candidates.is_empty() {
            return Err(start_error(modulus));
        }
        let mut starts =
            vec![best_candidate(&problem, &candidates).ok_or_else(|| start_error(modulus))?];
        if self.starts > 1 {
            starts.extend(spread(&self.model, &candidates, self.starts - 1));
        }
        let found = minima(&starts, |start| {
            self.minimise(&problem, start, Some(PRELIMINARY))
        })?;
        let mut best: Option<Minimum> = None;
        for (start, minimum) in starts.into_iter().zip(found) {
            let Some(minimum) = minimum else { continue };
            course.count(&minimum);
            course.starts.push(StartOutcome {
                start,
                parameters: minimum.parameters.clone(),
                relative_error: root_mean_square(&minimum.linearisation.residual),
                termination: minimum.termination,
            });
            if best
                .as_ref()
                .is_none_or(|best| value(&minimum) < value(best))
            {
                best = Some(minimum);
            }
        }
        let mut best = best.ok_or_else(|| start_error(modulus))?;
        for _ in 0..CYCLE_SKIPS {
            let Some((test, lag)) = arrival_lag(&problem, &best.parameters) else {
                break;
            };
            let present = modulus_at(&best.parameters);
            let Some(corrected) = modulus_after_lag(test, present, lag) else {
                break;
            };
            let candidates = from(corrected);
            let Some(start) = best_candidate(&problem, &candidates) else {
                break;
            };
            let Some(minimum) = self.minimise(&problem, &start, Some(PRELIMINARY))? else {
                break;
            };
            course.count(&minimum);
            if value(&minimum) >= value(&best) {
                break;
            }
            best = minimum;
            course.cycle_skips_left += 1;
        }
        Ok(best.parameters)
    }

    /// Second stage: the minimum on a sufficiently fine grid, and the difference from a grid of
    /// half the cell.
    pub(super) fn refined<'a>(
        &'a self,
        tests: &'a [RodTest],
        start: &[f64],
        course: &mut Course,
    ) -> Result<(TestResidual<'a, M>, Minimum, f64), MaxwellidError> {
        let requested = self.requested_accuracy(tests);
        // data generated by this solver come from a grid that the user states, or from the default
        // one
        let fixed = self.cell.or(self.round_trip.then_some(DEFAULT_CELL));
        let noise_is_known = noise_is_known(tests)?;
        let mut cell = match fixed {
            Some(cell) => cell,
            // the error of the grid depends on the excitation, which is not estimated yet
            None if noise_is_known => self.first_cell,
            None => {
                let problem = TestResidual::new(tests, &self.model, SCAN_CELL);
                let coarse = Self::grid_difference(&problem, start, SCAN_CELL)
                    .ok_or_else(|| start_error(modulus_at(start)))?;
                // the error is of second order
                let share = (MARGIN * requested / coarse).sqrt();
                (SCAN_CELL * share).clamp(SHORTEST_CELL, DEFAULT_CELL)
            }
        };
        let mut start = start.to_vec();
        let each = self.nuisances.of_iteration().len() * tests.len();
        start = padded(&start, self.model.step_limits().len() + each);
        let mut refinement = 0;
        let (mut common, mut weightings) = (CommonErrors::default(), Vec::new());
        loop {
            let mut problem = TestResidual::new(tests, &self.model, cell);
            problem.nuisances = self.nuisances;
            problem.common = common;
            problem.weightings = weightings;
            let (problem, minimum) = if noise_is_known {
                self.weighted(problem, &start, None, course)?
            } else {
                let minimum = self
                    .minimise(&problem, &start, None)?
                    .ok_or_else(|| start_error(modulus_at(&start)))?;
                course.count(&minimum);
                (problem, minimum)
            };
            let of_model = minimum.parameters.get(..problem.of_model());
            let difference = of_model
                .and_then(|of_model| Self::grid_difference(&problem, of_model, cell))
                .unwrap_or(f64::NAN);
            let finest = fixed.is_some() || cell <= SHORTEST_CELL;
            if difference <= requested || finest || refinement >= REFINEMENTS {
                // the difference is NaN if the response does not exist on half the cell
                if (difference.is_nan() || difference > requested) && fixed.is_none() {
                    course.flags.push(FitFlag::GridTooCoarse {
                        difference,
                        requested,
                    });
                }
                return Ok((problem, minimum, difference));
            }
            refinement += 1;
            start = minimum.parameters;
            (common, weightings) = (problem.common, problem.weightings);
            cell = (FINER * cell).max(SHORTEST_CELL);
        }
    }

    /// Returns the requested accuracy, or the accuracy that the stated noise requires if that is
    /// smaller.
    pub(super) fn requested_accuracy(&self, tests: &[RodTest]) -> f64 {
        let samples: usize = tests.iter().map(|test| test.window).sum();
        tests
            .iter()
            .filter_map(|test| {
                let noise = test.noise.as_ref()?.response.standard_deviation();
                Some(SHARE_OF_ERROR * noise / test.impact_velocity / (samples as f64).sqrt())
            })
            .fold(self.accuracy, f64::min)
    }

    /// Largest rms difference, divided by V0, among the tests, between the responses with `cell`
    /// and with half of it. The excitations are those about which `problem` is linearised: the
    /// noise of a measured excitation would need a finer grid than the motion of the rod.
    pub(super) fn grid_difference(
        problem: &TestResidual<'_, M>,
        of_model: &[f64],
        cell: f64,
    ) -> Option<f64> {
        let mut largest = 0.0_f64;
        for (index, test) in problem.tests.iter().enumerate() {
            let response = |cell| problem.response_on(index, of_model, cell);
            let difference: Vec<f64> = response(cell)?
                .iter()
                .zip(response(0.5 * cell)?)
                .map(|(a, b)| (a - b) / test.impact_velocity)
                .collect();
            largest = largest.max(root_mean_square(&difference));
        }
        Some(largest)
    }

    /// Second stage with stated noise: weights from the noise of both histories, and the excitation
    /// as an unknown. The parameter with the index `held`, if any, keeps its starting value.
    pub(super) fn weighted<'a>(
        &self,
        mut problem: TestResidual<'a, M>,
        start: &[f64],
        held: Option<usize>,
        course: &mut Course,
    ) -> Result<(TestResidual<'a, M>, Minimum), MaxwellidError> {
        let tests = problem.tests;
        let of_model = problem.of_model();
        let mut parameters = start.to_vec();
        let mut transfer_is_due = true;
        let mut last: Option<Minimum> = None;
        let mut deviations: Vec<Deviation> = (0..tests.len())
            .map(|test| problem.common.deviation(test))
            .collect();
        let mut settled = false;
        let (mut nearest, mut since) = (f64::INFINITY, 0);
        // start and minimum of the previous round with a recomputed transfer
        let mut renewal: Option<(Vec<f64>, Vec<f64>)> = None;
        let bounds = problem.bounds();
        // without a recorder in the model the rounds converge, and a secant could miss their limit
        let has_drive = |test: &RodTest| test.drive(false).is_some();
        let follows_secant = !self.model.is_linear() && tests.iter().any(has_drive);
        for _ in 0..ROUNDS {
            if transfer_is_due {
                let renewed = all_in_order(tests.len(), |index| {
                    let test = tests.get(index)?;
                    let is_linear = self.model.is_linear();
                    let measured = test.known_excitation(is_linear);
                    let of_before = self.excitations.get(index).map(Vec::as_slice);
                    let of_before = of_before.filter(|known| known.len() == measured.len());
                    let first = of_before.unwrap_or(measured);
                    let (estimate, excitation) =
                        problem.weightings.get(index).map_or((first, first), |w| {
                            (w.estimate.as_slice(), w.excitation.as_slice())
                        });
                    let of_model = parameters.get(..of_model)?;
                    let of_nuisances = problem.delay_of_nuisances(index, &parameters);
                    let mut about = *deviations.get(index)?;
                    about.delay += of_nuisances;
                    let transfer = Transfer::new(&self.model, of_model, test, (excitation, about))?;
                    let floor = self.accuracy * test.impact_velocity;
                    Weighting::new(test, (transfer, is_linear), floor, estimate.to_vec())
                });
                problem.weightings = renewed.ok_or_else(|| start_error(modulus_at(&parameters)))?;
            }
            problem = problem
                .with_common_errors(&parameters, deviations.clone())
                .ok_or_else(|| start_error(modulus_at(&parameters)))?;
            let found = match held {
                None => self
                    .minimise(&problem, &parameters, Some(WHITE))?
                    .map(|minimum| (minimum.movement(&parameters), minimum)),
                Some(index) => minimum_held(&problem, &parameters, index)?,
            };
            let (moved, minimum) = found.ok_or_else(|| start_error(modulus_at(&parameters)))?;
            course.count(&minimum);
            let start = std::mem::replace(&mut parameters, minimum.parameters.clone());
            let likelier = problem
                .most_likely_deviations(&parameters)
                .ok_or_else(|| start_error(modulus_at(&parameters)))?;
            let moves = are_moved(tests, &deviations, &likelier);
            settled = moved < SETTLED && last.is_some() && !transfer_is_due;
            let is_renewed = transfer_is_due;
            transfer_is_due = moved > TRANSFER_HOLDS || moves;
            // a steep front of the response hardly changes with the length as long as it stays
            // between two points of its grid, and jumps when it crosses a point: lengths updated in
            // every round may alternate between two values
            if is_renewed || transfer_is_due || !follows_secant {
                deviations = likelier;
            }
            if is_renewed && transfer_is_due && held.is_none() && follows_secant {
                let before = renewal.as_ref().map(|(start, end)| (&**start, &**end));
                let next = within(&minimum.meeting(&start, before), &bounds);
                renewal = Some((start, std::mem::replace(&mut parameters, next)));
            }
            last = Some(minimum);
            since = if transfer_is_due && moved > NEARER * nearest {
                since + 1
            } else {
                0
            };
            nearest = nearest.min(moved);
            if settled || since >= NO_NEARER {
                break;
            }
            problem = with_cleaned_excitations(problem, &parameters)?;
        }
        course.flags.retain(|flag| *flag != FitFlag::Unsettled);
        if !settled {
            course.flags.push(FitFlag::Unsettled);
        }
        match last {
            Some(minimum) => Ok((problem, minimum)),
            None => Err(start_error(modulus_at(&parameters))),
        }
    }
}

/// Minimum with the parameter at `index` held, and the change of the others in standard errors.
fn minimum_held<M: RodModel>(
    problem: &TestResidual<'_, M>,
    start: &[f64],
    index: usize,
) -> Result<Option<(f64, Minimum)>, MaxwellidError> {
    let held = Held {
        problem,
        index,
        value: start.get(index).copied().unwrap_or(f64::NAN),
    };
    let minimum = minimise_to(&held, start, rounding(problem), WHITE)?;
    Ok(minimum.map(|minimum| (minimum.movement(start), minimum)))
}

/// The problem linearised about the most likely excitations at `parameters`.
fn with_cleaned_excitations<'a, M: RodModel>(
    mut problem: TestResidual<'a, M>,
    parameters: &[f64],
) -> Result<TestResidual<'a, M>, MaxwellidError> {
    let rows = problem
        .residual_of_tests(parameters)
        .ok_or_else(|| start_error(modulus_at(parameters)))?;
    let cleaned: Option<Vec<Weighting>> = problem
        .weightings
        .drain(..)
        .zip(problem.tests)
        .zip(&rows)
        .map(|((weighting, test), residual)| {
            let window = residual.get(..test.window)?;
            weighting.cleaned(test, window)
        })
        .collect();
    problem.weightings = cleaned.ok_or_else(|| start_error(modulus_at(parameters)))?;
    Ok(problem)
}

/// Returns true if the noise of all tests is stated, false if none is; a mixture is an error.
pub(super) fn noise_is_known(tests: &[RodTest]) -> Result<bool, MaxwellidError> {
    let known = tests.iter().any(|test| test.noise.is_some());
    match tests.iter().find(|test| test.noise.is_none()) {
        Some(without) if known => Err(MaxwellidError::NoiseMissing {
            test: without.name.clone(),
        }),
        _ => Ok(known),
    }
}

/// Longest window \[s\].
pub(super) fn duration(tests: &[RodTest]) -> f64 {
    tests
        .iter()
        .filter_map(|test| test.times().last().copied())
        .fold(0.0, f64::max)
}

/// Sum of squares due to rounding, for an error of each sample of 1e-14 of V0 or, in a white
/// residual, of a millionth of the noise.
pub(super) fn rounding<M: RodModel>(problem: &TestResidual<'_, M>) -> f64 {
    let sample = if problem.weightings.is_empty() {
        1e-28
    } else {
        1e-12
    };
    sample * problem.samples() as f64
}
