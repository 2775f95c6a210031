//! Identification of a law from one or several rod tests.
//!
//! Theory: `docs/theory/identification.md`.

mod bent;

use rodwave::RodwaveError;
use rodwave::characteristics::GENERATOR;

use crate::agreement::{FitFlag, disagreements};
use crate::error::MaxwellidError;
use crate::historical;
use crate::least_squares::{Evaluations, Minimum, minimise, minimise_to, sum_of_squares};
use crate::model::{MODULUS_BOUNDS, RodModel, check_cell, check_counts};
use crate::nuisance::Nuisances;
use crate::residual::TestResidual;
use crate::start::{StartOutcome, arrival_lag, best_candidate, minima, modulus_after_lag, spread};
use crate::test::{Provenance, RodTest};
use crate::whitening::{Transfer, Weighting};

pub(crate) use crate::identification::Identification;

use crate::profile::Held;

/// Default of the longest cell of the grid \[m\]; the requested accuracy may require a shorter one.
/// The scheme is of second order, with an error below 2e-4 of V0 in a polymer rod struck by the
/// projectile of paper D, a hundredth of the recorder's noise.
pub const DEFAULT_CELL: f64 = 4e-3;

/// Default of the requested accuracy of the simulated response, rms as a fraction of V0.
pub const DEFAULT_ACCURACY: f64 = 1e-3;

/// Longest cell of the grid for the search of starts \[m\]: any grid distinguishes decades.
const SCAN_CELL: f64 = 8e-3;

/// Shortest cell chosen for accuracy \[m\].
const SHORTEST_CELL: f64 = 0.25e-3;

/// Number of refinements after the first solution.
const REFINEMENTS: usize = 4;

/// Fraction of the requested accuracy at which a grid is aimed, since the error is found at a start
/// and not at the solution.
const MARGIN: f64 = 0.6;

/// Largest shift of a parameter by the error of the solver as a fraction of its standard error, if
/// noise is stated.
const SHARE_OF_ERROR: f64 = 0.3;

/// Number of minima that are left in succession because their front arrives at another time.
const CYCLE_SKIPS: usize = 5;

/// Largest number of starts, beyond any practical use.
const MOST_STARTS: usize = 1_000_000;

/// Number of alternations of parameters and excitation, and of the transfer about both.
const ROUNDS: usize = 24;

/// Remaining relative reduction of the sum of squares at which a preliminary minimum ends.
const PRELIMINARY: f64 = 1e-4;

/// Remaining relative reduction of a white sum of squares at a minimum: a thousandth of a variance
/// for some hundred samples.
const WHITE: f64 = 1e-5;

/// Change of the parameters, in standard errors, up to which the transfer from excitation to
/// response need not be renewed.
const TRANSFER_HOLDS: f64 = 0.5;

/// Change of the parameters, in standard errors, at which the alternation ends.
const SETTLED: f64 = 0.05;

/// The minimiser.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// Damped least squares (Levenberg and Marquardt) with a trust region of the step limits.
    #[default]
    DampedLeastSquares,
    /// Robbins and Monro, then Davidon, Fletcher and Powell, as (Ödeen 1993, paper D, eq. 14), in
    /// scaled parameters. Of historical interest.
    Historical,
}

/// Settings of an identification: the law, the starts and the grid.
///
/// The parameters are those of least squares (Ödeen 1993, paper D, eqs. 12, 13), in the coordinates
/// (ln E, shape, ln rate at 10 MPa), by damped least squares with the exact derivatives of the
/// direct problem. The paper's recursion (14) with gain 1/m on the printed parameters diverges or
/// stagnates: see the erratum in docs/theory.
///
/// # Stages
/// 1. Starts, on a coarse grid: E from the time of flight, the candidates of the model, more on
///    request. A minimum whose front arrives at another time than the measured one is rejected.
/// 2. The grid is chosen for the requested accuracy, and the minimum is found on it, with the
///    [`crate::Nuisances`]. If the noise of the tests is stated ([`RodTest::with_noise`] and
///    similar methods), the residual is whitened with the noise of both histories, and the
///    excitation is estimated together with the parameters (errors in variables). At the solution a
///    grid of half the cell verifies the accuracy, or the stage is repeated on it.
///
/// ```
/// use maxwellid::{Fit, Provenance, RodTest, RodTestData, Verdict};
/// use rodwave::band_limited::SampledHistory;
/// use rodwave::inelastic::Maxwell;
/// use rodwave::lumped::{self, LumpedRod};
/// use rodwave::InelasticRod;
///
/// // a virtual test, made by a solver other than the one that inverts
/// let rate = 51_200.0;
/// let excitation: Vec<f64> = (0..140)
///     .map(|k| 8.0 * (-((f64::from(k) - 35.0) / 4.0_f64).powi(2)).exp())
///     .collect();
/// let times: Vec<f64> = (0..140).map(|k| f64::from(k) / rate).collect();
/// let rod = InelasticRod::new(0.391, 1140.0, 3.209e9, Maxwell::new(4e6)?)?;
/// let response = LumpedRod::new(&rod, 400, 0.5)?
///     .free_end_velocity(&SampledHistory::new(&excitation, rate)?, &times)?;
/// let test = RodTest::new(RodTestData {
///     name: "polyamide 6".into(),
///     length: 0.391,
///     density: 1140.0,
///     impact_velocity: 10.0,
///     sampling_rate_hz: rate,
///     excitation,
///     response,
///     provenance: Provenance::Virtual { generator: lumped::GENERATOR.into() },
/// })?;
///
/// let identified = Fit::of(Maxwell::new(1e6)?).to(&[test])?;
/// assert!((identified.modulus() / 3.209e9 - 1.0).abs() < 1e-3);
/// assert!((identified.law().viscosity() / 4e6 - 1.0).abs() < 0.01);
/// let at_two_per_cent = identified.identifiability(maxwellid::Noise::Known(0.02)).unwrap();
/// assert!(at_two_per_cent.estimates.iter().all(|e| e.verdict == Verdict::Identified));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Fit<M> {
    model: M,
    modulus: Option<f64>,
    scan: bool,
    cell: Option<f64>,
    accuracy: f64,
    round_trip: bool,
    starts: usize,
    also_from: Vec<Vec<f64>>,
    nuisances: Nuisances,
    method: Method,
}

/// The lowest minimum and its problem.
pub(crate) struct Lowest<'a, M> {
    pub(crate) problem: TestResidual<'a, M>,
    pub(crate) minimum: Minimum,
    /// Difference from the response on a grid of half the cell.
    pub(crate) difference: f64,
    pub(crate) course: Course,
}

impl<M: RodModel> Fit<M> {
    /// Creates an identification of the parameters of `model`, a law or any other [`RodModel`]. The
    /// shape of a law is the starting value; the rate is scanned and E follows from the time of
    /// flight.
    #[must_use]
    pub fn of(model: M) -> Self {
        Self {
            model,
            modulus: None,
            scan: true,
            cell: None,
            accuracy: DEFAULT_ACCURACY,
            round_trip: false,
            starts: 1,
            also_from: Vec::new(),
            nuisances: Nuisances::default(),
            method: Method::default(),
        }
    }

    /// Sets the start to Young's modulus `modulus` \[Pa\] and the parameters of the model itself.
    #[must_use]
    pub fn starting_from(mut self, modulus: f64) -> Self {
        self.modulus = Some(modulus);
        self.scan = false;
        self
    }

    /// Sets the number of starts, spread over 30 % of E and, around each candidate of the model,
    /// two step limits of the other parameters; the lowest minimum is kept.
    /// [`Identification::starts`] lists their results. [`Self::to`] rejects 0.
    #[must_use]
    pub fn with_starts(mut self, count: usize) -> Self {
        self.starts = count;
        self
    }

    /// Adds the start θ = `parameters`, for example from
    /// [`crate::selection::ComparedLaw::likeliest`]; the lowest minimum is kept.
    #[must_use]
    pub fn also_from(mut self, parameters: Vec<f64>) -> Self {
        self.also_from.push(parameters);
        self
    }

    /// Sets the longest cell of the grid \[m\], independent of the accuracy.
    #[must_use]
    pub fn with_cell(mut self, cell: f64) -> Self {
        self.cell = Some(cell);
        self
    }

    /// Sets the accuracy of the simulated response, rms as a fraction of V0 (default
    /// [`DEFAULT_ACCURACY`]). If noise is stated, the grid is finer if its error would shift a
    /// parameter by more than a third of its standard error.
    #[must_use]
    pub fn with_accuracy(mut self, share: f64) -> Self {
        self.accuracy = share;
        self
    }

    /// Sets the unknown properties of the transducers.
    #[must_use]
    pub fn with_nuisances(mut self, nuisances: Nuisances) -> Self {
        self.nuisances = nuisances;
        self
    }

    /// Sets the minimiser.
    #[must_use]
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Permits data of the inverting solver. Only a check of the optimiser, as in the paper's
    /// appendix, needs it: equal errors on both sides cancel, so that it gives no information
    /// on real data.
    #[must_use]
    pub fn round_trip(mut self) -> Self {
        self.round_trip = true;
        self
    }

    /// Identifies the model from all `tests` together.
    ///
    /// # Errors
    /// [`MaxwellidError`] if there is no test, too few samples, no arrival to start from, tests
    /// whose times of flight contradict each other, a window that ends before the wave has
    /// arrived, noise stated for some tests only, a calibration without noise, a start or a
    /// grid that is not physical, no start or more than a million, one recording as two tests, an
    /// inconsistent model, or data of the inverting solver without [`Self::round_trip`]. A fit
    /// that does not converge or does not determine its parameters is no error: see
    /// [`Identification::termination`], [`Identification::flags`] and
    /// [`Identification::identifiability`].
    pub fn to(&self, tests: &[RodTest]) -> Result<Identification<M>, MaxwellidError>
    where
        M: Clone,
    {
        let modulus = self.check_all(tests)?;
        Ok(self.concluded(self.lowest(tests, modulus)?))
    }

    /// Checks settings and tests, and returns the starting value of Young's modulus \[Pa\].
    pub(crate) fn check_all(&self, tests: &[RodTest]) -> Result<f64, MaxwellidError> {
        let modulus = self.check(tests)?;
        check_counts(&self.model, modulus, duration(tests))?;
        let noise_is_known = noise_is_known(tests)?;
        self.nuisances.check(noise_is_known)?;
        if let Some(test) = tests.iter().find(|test| !test.common_errors.is_empty())
            && (self.nuisances.any() || !noise_is_known)
        {
            return Err(MaxwellidError::CommonErrors {
                test: test.name.clone(),
                because: if noise_is_known {
                    "are not combined with unknown transducers: state one or the other"
                } else {
                    "need a stated noise to be weighed against"
                },
            });
        }
        let parameters = self.model.step_limits().len();
        if let Some(start) = self
            .also_from
            .iter()
            .find(|start| start.len() != parameters)
        {
            return Err(MaxwellidError::InconsistentModel {
                model: self.model.name().to_owned(),
                what: "starting values",
                found: start.len(),
                expected: parameters,
            });
        }
        let samples: usize = tests.iter().map(|test| test.window).sum();
        if samples <= parameters {
            return Err(MaxwellidError::TooFewSamples {
                samples,
                parameters,
            });
        }
        Ok(modulus)
    }

    /// Finds the lowest minimum from the starts for `modulus` and from the requested ones.
    pub(crate) fn lowest<'a>(
        &'a self,
        tests: &'a [RodTest],
        modulus: f64,
    ) -> Result<Lowest<'a, M>, MaxwellidError> {
        let mut course = Course::default();
        let start = self.coarse(tests, modulus, &mut course)?;
        let mut lowest = self.lowest_from(tests, &start, course)?;
        for start in &self.also_from {
            let found = &lowest.minimum;
            if found.is_reached_from(&padded(start, found.parameters.len())) {
                continue;
            }
            let next = self.lowest_from(tests, start, lowest.course.clone())?;
            if value(&next.minimum) < value(&lowest.minimum) {
                lowest = next;
            }
        }
        Ok(lowest)
    }

    /// Finds the minimum near `start`.
    pub(crate) fn lowest_from<'a>(
        &'a self,
        tests: &'a [RodTest],
        start: &[f64],
        mut course: Course,
    ) -> Result<Lowest<'a, M>, MaxwellidError> {
        let (problem, minimum, difference) = self.refined(tests, start, &mut course)?;
        Ok(Lowest {
            problem,
            minimum,
            difference,
            course,
        })
    }

    fn minimise(
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
    fn coarse(
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

    /// Second stage: the minimum on a sufficiently fine grid, and the difference from one of half
    /// the cell.
    fn refined<'a>(
        &'a self,
        tests: &'a [RodTest],
        start: &[f64],
        course: &mut Course,
    ) -> Result<(TestResidual<'a, M>, Minimum, f64), MaxwellidError> {
        let requested = self.requested_accuracy(tests);
        // data of this solver come from a grid known to the user, or the default one
        let fixed = self.cell.or(self.round_trip.then_some(DEFAULT_CELL));
        let noise_is_known = noise_is_known(tests)?;
        let mut cell = match fixed {
            Some(cell) => cell,
            // the relevant excitation is not known yet
            None if noise_is_known => DEFAULT_CELL,
            None => {
                let problem = TestResidual::new(tests, &self.model, SCAN_CELL);
                let coarse = Self::grid_difference(&problem, start, SCAN_CELL)
                    .ok_or_else(|| start_error(modulus_at(start)))?;
                // second-order error
                let share = (MARGIN * requested / coarse).sqrt();
                (SCAN_CELL * share).clamp(SHORTEST_CELL, DEFAULT_CELL)
            }
        };
        let mut start = start.to_vec();
        let each = self.nuisances.of_iteration().len() * tests.len();
        start = padded(&start, self.model.step_limits().len() + each);
        let mut refinement = 0;
        loop {
            let mut problem = TestResidual::new(tests, &self.model, cell);
            problem.nuisances = self.nuisances;
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
                // a response that does not exist on half the cell has no accuracy
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
            cell = (0.5 * cell).max(SHORTEST_CELL);
        }
    }

    /// The requested accuracy, or that required by the stated noise if smaller.
    #[expect(
        clippy::cast_precision_loss,
        reason = "sample counts are far below 2^52"
    )]
    fn requested_accuracy(&self, tests: &[RodTest]) -> f64 {
        let samples: usize = tests.iter().map(|test| test.window).sum();
        tests
            .iter()
            .filter_map(|test| {
                let noise = test.noise.as_ref()?.response.standard_deviation();
                Some(SHARE_OF_ERROR * noise / test.impact_velocity / (samples as f64).sqrt())
            })
            .fold(self.accuracy, f64::min)
    }

    /// Largest rms difference over V0, among the tests, of the responses with `cell` and half of
    /// it, to the excitations about which `problem` is linearised: the noise of a measured one
    /// would need a finer grid than the motion of the rod.
    fn grid_difference(problem: &TestResidual<'_, M>, of_model: &[f64], cell: f64) -> Option<f64> {
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
    /// as an unknown. If a parameter, given by its index, is `held` at the start, the
    /// derivatives of the minimum are those by the others.
    fn weighted<'a>(
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
        let mut delays = vec![0.0; tests.len()];
        let mut settled = false;
        for _ in 0..ROUNDS {
            if transfer_is_due {
                let renewed: Option<Vec<Weighting>> = tests
                    .iter()
                    .enumerate()
                    .map(|(index, test)| {
                        let is_linear = self.model.is_linear();
                        let measured = test.known_excitation(is_linear);
                        let (estimate, excitation) = problem
                            .weightings
                            .get(index)
                            .map_or((measured, measured), |w| {
                                (w.estimate.as_slice(), w.excitation.as_slice())
                            });
                        let of_model = parameters.get(..of_model)?;
                        let transfer = Transfer::new(&self.model, of_model, test, excitation)?;
                        let floor = self.accuracy * test.impact_velocity;
                        Weighting::new(test, (transfer, is_linear), floor, estimate.to_vec())
                    })
                    .collect();
                problem.weightings = renewed.ok_or_else(|| start_error(modulus_at(&parameters)))?;
            }
            problem = problem
                .with_common_errors(&parameters, delays)
                .ok_or_else(|| start_error(modulus_at(&parameters)))?;
            let found = match held {
                None => self
                    .minimise(&problem, &parameters, Some(WHITE))?
                    .map(|minimum| (minimum.movement(&parameters), minimum)),
                Some(index) => minimum_held(&problem, &parameters, index)?,
            };
            let (moved, minimum) = found.ok_or_else(|| start_error(modulus_at(&parameters)))?;
            course.count(&minimum);
            parameters.clone_from(&minimum.parameters);
            delays = problem
                .most_likely_delays(&parameters)
                .ok_or_else(|| start_error(modulus_at(&parameters)))?;
            settled = moved < SETTLED && last.is_some() && !transfer_is_due;
            last = Some(minimum);
            if settled {
                break;
            }
            transfer_is_due = moved > TRANSFER_HOLDS;
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

    pub(crate) fn concluded(&self, lowest: Lowest<'_, M>) -> Identification<M>
    where
        M: Clone,
    {
        let Lowest {
            problem,
            minimum,
            difference,
            course,
        } = &lowest;
        let mut course = course.clone();
        if let Some((test, lag)) = arrival_lag(problem, &minimum.parameters) {
            course.flags.push(FitFlag::ArrivalOff {
                test: test.name.clone(),
                lag,
            });
        }
        let identification =
            Identification::new(self.model.clone(), problem, minimum, course, *difference);
        let bent = self.bent(&lowest, &identification);
        let identification = identification.with_bent(bent);
        let names = self.model.parameter_names();
        let tests: Vec<String> = problem.tests.iter().map(|test| test.name.clone()).collect();
        let (linearisation, lengths, noise) = identification.scores();
        let flags = disagreements(linearisation, lengths, noise, &names, &tests);
        identification.with_flags(flags)
    }

    /// Checks the tests and returns the starting value of Young's modulus.
    fn check(&self, tests: &[RodTest]) -> Result<f64, MaxwellidError> {
        let first = tests.first().ok_or(MaxwellidError::NoTest)?;
        if !self.round_trip {
            for test in tests {
                if let Provenance::Virtual { generator } = &test.provenance
                    && generator == GENERATOR
                {
                    return Err(MaxwellidError::InverseCrime {
                        test: test.name.clone(),
                        generator: generator.clone(),
                    });
                }
            }
        }
        for (quantity, value) in [
            ("cell of the grid [m]", self.cell.unwrap_or(SCAN_CELL)),
            ("accuracy as a share of V0", self.accuracy),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(MaxwellidError::Start {
                    source: RodwaveError::NonPhysical {
                        quantity,
                        value,
                        expected: "a finite value above 0",
                    },
                });
            }
        }
        if let Some(cell) = self.cell {
            for test in tests {
                check_cell(cell, test.length)?;
            }
        }
        if !(1..=MOST_STARTS).contains(&self.starts) {
            return Err(MaxwellidError::Setting {
                setting: "number of starts",
                value: self.starts as f64,
                expected: "from 1 to a million",
            });
        }
        crate::test::check_distinct(tests)?;
        crate::test::check_together(tests)?;
        let modulus = match self.modulus {
            Some(modulus) => modulus,
            // the longest rod has the smallest relative error in the time of flight
            None => tests
                .iter()
                .max_by(|a, b| a.length.total_cmp(&b.length))
                .unwrap_or(first)
                .modulus_from_time_of_flight()?,
        };
        if !(modulus.is_finite() && modulus > 0.0) {
            return Err(start_error(modulus));
        }
        // a wrong unit of density or length; otherwise a wave that crosses the rod a million times
        // would be computed
        let (low, high) = MODULUS_BOUNDS;
        if !(low..=high).contains(&modulus) {
            return Err(MaxwellidError::Start {
                source: RodwaveError::NonPhysical {
                    quantity: "modulus to start from, given or from the time of flight [Pa]",
                    value: modulus,
                    expected: "from 1e3 to 1e13",
                },
            });
        }
        Ok(modulus)
    }
}

/// Minimum with the parameter at `index` held, and the change of the others in standard errors.
fn minimum_held<M: RodModel>(
    problem: &TestResidual<'_, M>,
    start: &[f64],
    index: usize,
) -> Result<Option<(f64, Minimum)>, MaxwellidError> {
    let mut others = start.to_vec();
    let value = others.remove(index);
    let held = Held {
        problem,
        index,
        value,
    };
    let minimum = minimise_to(&held, &others, rounding(problem), WHITE)?;
    Ok(minimum.map(|mut minimum| {
        let moved = minimum.movement(&others);
        minimum.parameters.insert(index, value);
        (moved, minimum)
    }))
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

/// Record of the iterations.
#[derive(Debug, Clone, Default)]
pub(crate) struct Course {
    pub(crate) iterations: usize,
    pub(crate) evaluations: Evaluations,
    pub(crate) starts: Vec<StartOutcome>,
    pub(crate) cycle_skips_left: usize,
    pub(crate) flags: Vec<FitFlag>,
}

impl Course {
    fn count(&mut self, minimum: &Minimum) {
        self.iterations += minimum.iterations;
        self.evaluations += minimum.evaluations;
    }
}

pub(crate) fn value(minimum: &Minimum) -> f64 {
    sum_of_squares(&minimum.linearisation.residual)
}

#[expect(
    clippy::cast_precision_loss,
    reason = "sample counts are far below 2^52"
)]
pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (sum_of_squares(values) / values.len().max(1) as f64).sqrt()
}

/// Returns true if the noise of all tests is stated; a mixture is an error.
fn noise_is_known(tests: &[RodTest]) -> Result<bool, MaxwellidError> {
    let known = tests.iter().any(|test| test.noise.is_some());
    match tests.iter().find(|test| test.noise.is_none()) {
        Some(without) if known => Err(MaxwellidError::NoiseMissing {
            test: without.name.clone(),
        }),
        _ => Ok(known),
    }
}

/// Longest window \[s\].
fn duration(tests: &[RodTest]) -> f64 {
    tests
        .iter()
        .filter_map(|test| test.times().last().copied())
        .fold(0.0, f64::max)
}

/// Extends `start` of a model by nuisances at their references.
fn padded(start: &[f64], count: usize) -> Vec<f64> {
    let nuisances = std::iter::repeat(&0.0);
    start.iter().chain(nuisances).take(count).copied().collect()
}

/// E \[Pa\] from ln E, the first of θ.
fn modulus_at(parameters: &[f64]) -> f64 {
    parameters.first().map_or(f64::NAN, |t| t.exp())
}

fn start_error(modulus: f64) -> MaxwellidError {
    MaxwellidError::Start {
        source: RodwaveError::NonPhysical {
            quantity: "Young's modulus [Pa]",
            value: modulus,
            expected: "a finite value above 0",
        },
    }
}

/// Sum of squares due to rounding: 1e-14 of V0 per sample, or a millionth of the noise for a white
/// residual.
#[expect(
    clippy::cast_precision_loss,
    reason = "sample counts are far below 2^52"
)]
fn rounding<M: RodModel>(problem: &TestResidual<'_, M>) -> f64 {
    let sample = if problem.weightings.is_empty() {
        1e-28
    } else {
        1e-12
    };
    sample * problem.samples() as f64
}

#[cfg(test)]
mod tests;
