//! Identification of a law from one or several rod tests.
//!
//! Theory: `docs/theory/identification.md`.

mod bent;
mod stages;

use rodwave::RodwaveError;

use crate::agreement::{FitFlag, disagreements};
use crate::error::MaxwellidError;
use crate::least_squares::{Evaluations, Minimum, sum_of_squares};
use crate::model::{DEFAULT_CELL, MODULUS_BOUNDS, RodModel, check_cell, check_counts};
use crate::nuisance::Nuisances;
use crate::residual::TestResidual;
use crate::start::{StartOutcome, arrival_lag};
use crate::test::{Provenance, RodTest, check_temperatures};
use stages::{duration, noise_is_known};

pub(crate) use crate::identification::Identification;

/// Default of the requested accuracy of the simulated response, rms as a fraction of V0.
pub const DEFAULT_ACCURACY: f64 = 1e-3;

/// Longest cell of the grid for the search for starts \[m\]: any grid distinguishes starts that are
/// decades apart.
const SCAN_CELL: f64 = 8e-3;

/// Largest number of starts, beyond any practical use.
const MOST_STARTS: usize = 1_000_000;

/// The minimiser.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// Damped least squares (Levenberg and Marquardt) with a trust region of the step limits.
    #[default]
    DampedLeastSquares,
    /// Robbins and Monro, then Davidon, Fletcher and Powell, as in (Ödeen 1993, paper D, eq. 14),
    /// in scaled parameters. Of historical interest.
    Historical,
}

/// Settings of an identification: the law, the starts and the grid.
///
/// The parameters minimise the sum of squares (Ödeen 1993, paper D, eqs. 12, 13), in the
/// coordinates (ln E, shape, ln rate at 10 MPa), by damped least squares with the exact derivatives
/// of the direct problem. The paper's recursion (14) with gain 1/m on the printed parameters
/// diverges or stagnates: see the erratum in docs/theory.
///
/// # Stages
/// 1. The starts, on a coarse grid, have E from the time of flight and the candidates of the model;
///    more are added on request. A minimum whose front does not arrive with the measured one is
///    rejected.
/// 2. The grid is chosen for the requested accuracy, and the minimum is found on it, with the
///    [`crate::Nuisances`]. If the noise of the tests is stated ([`RodTest::with_noise`] and
///    similar methods), the residual is whitened with the noise of both histories, and the
///    excitation is estimated together with the parameters (errors in variables). At the solution a
///    grid with half the cell length verifies the accuracy; if it is not reached, the stage is
///    repeated on a finer grid.
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
    only_from: Option<Vec<f64>>,
    /// Excitations of the tests [m/s] from which a fit with stated noise starts.
    excitations: Vec<Vec<f64>>,
    /// Longest cell of the first grid of a fit with stated noise \[m\].
    first_cell: f64,
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

impl<M> Lowest<'_, M> {
    /// Returns true if the alternating estimation of parameters and excitation has converged.
    pub(crate) fn has_settled(&self) -> bool {
        !self.course.flags.contains(&FitFlag::Unsettled)
    }
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
            only_from: None,
            excitations: Vec::new(),
            first_cell: DEFAULT_CELL,
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

    /// Sets the number of starts. They are spread around the candidates of the model, by ±0.3 in ln
    /// E and by ±2 step limits in the other parameters; the lowest minimum is kept.
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

    /// Starts the fit with noise at θ = `parameters` alone, such as those of a previous fit: no
    /// other start is tried.
    #[must_use]
    pub fn only_from(mut self, parameters: Vec<f64>) -> Self {
        self.only_from = Some(parameters);
        self
    }

    /// Starts the fit where another fit of the same tests ended: only at its parameters, with its
    /// most likely excitations and with its cell, but with a cell of at most 4 mm, the default.
    #[must_use]
    pub fn continuing(self, found: &Identification<M>) -> Self {
        Self {
            excitations: found.excitations.clone(),
            first_cell: found.cell().min(DEFAULT_CELL),
            ..self.only_from(found.parameters().to_vec())
        }
    }

    /// Sets the longest cell of the grid \[m\], independent of the accuracy.
    #[must_use]
    pub fn with_cell(mut self, cell: f64) -> Self {
        self.cell = Some(cell);
        self
    }

    /// Sets the accuracy of the simulated response, rms as a fraction of V0 (default
    /// [`DEFAULT_ACCURACY`]). If noise is stated, the grid is refined if its error would shift a
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

    /// Permits data generated by the solver that inverts them. They serve only to check the
    /// optimiser, as in the paper's appendix: equal errors on both sides cancel, so that such a
    /// check gives no information on real data.
    #[must_use]
    pub fn round_trip(mut self) -> Self {
        self.round_trip = true;
        self
    }

    /// Identifies the model from all `tests` together.
    ///
    /// # Errors
    /// [`MaxwellidError`] if there is no test, too few samples, no arrival to start from, tests
    /// whose times of flight contradict each other, a window that ends before the wave has arrived,
    /// noise stated for some tests only, a calibration without noise, a start or a grid that is not
    /// physical, no start or more than a million, one recording used as two tests, an inconsistent
    /// model, or data of the inverting solver without [`Self::round_trip`]. A fit that does not
    /// converge or does not determine its parameters is no error: see
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
        check_temperatures(&self.model, tests)?;
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
                    "need a stated noise of the test, which sets their weight"
                },
            });
        }
        let parameters = self.model.step_limits().len();
        if let Some(start) = self
            .also_from
            .iter()
            .chain(&self.only_from)
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
        let start = match &self.only_from {
            Some(start) => start.clone(),
            None => self.coarse(tests, modulus, &mut course)?,
        };
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
                    && generator == self.model.solver()
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
        // a modulus outside these bounds comes from a wrong unit of density or length, and could
        // make the solver compute a million transits of the wave
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

pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (sum_of_squares(values) / values.len().max(1) as f64).sqrt()
}

/// Extends the parameters `start` of a model to `count` parameters, with the nuisances at their
/// reference values.
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

#[cfg(test)]
mod tests;
