//! Identification of a law from one or several rod tests.

use rodwave::RodwaveError;
use rodwave::characteristics::GENERATOR;

use crate::error::MaxwellidError;
use crate::identifiability::{Identifiability, Noise, assess};
use crate::law::IdentifiableLaw;
use crate::least_squares::{
    LeastSquares, Linearisation, Minimum, Termination, minimise, sum_of_squares,
};
use crate::model::RodModel;
use crate::residual::TestResidual;
use crate::test::{Provenance, RodTest};

/// Longest cell of the grid unless another is chosen \[m\]. The scheme is of second order; with cells of 4 mm it leaves about 2e-4 of
/// V0 in a polymer rod struck by the projectile of paper D, a hundredth of the recorder's noise.
pub const DEFAULT_CELL: f64 = 4e-3;

/// Longest cell of the grid on which the starting rate is looked for \[m\]: decades are told apart on any grid.
const SCAN_CELL: f64 = 8e-3;

/// An identification to be made: which law, from which start, on which grid.
///
/// The parameters are those of least squares (Ödeen 1993, paper D, eqs. 12, 13), in the coordinates (ln E, shape, ln rate at
/// 10 MPa), by damped least squares with the exact derivatives of the direct problem. The paper's recursion (14) with gain
/// 1/m on the printed parameters diverges or stands still: see the erratum in docs/theory.
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
    cell: f64,
    round_trip: bool,
}

impl<M: RodModel> Fit<M> {
    /// An identification of the parameters of `model`, a law or any other [`RodModel`]. The shape of a law is the starting value;
    /// the rate is scanned and E follows from the time of flight.
    #[must_use]
    pub fn of(model: M) -> Self {
        Self {
            model,
            modulus: None,
            scan: true,
            cell: DEFAULT_CELL,
            round_trip: false,
        }
    }

    /// Starts from Young's modulus `modulus` \[Pa\] and the parameters of the model itself instead.
    #[must_use]
    pub fn starting_from(mut self, modulus: f64) -> Self {
        self.modulus = Some(modulus);
        self.scan = false;
        self
    }

    /// Sets the longest cell of the grid \[m\].
    #[must_use]
    pub fn with_cell(mut self, cell: f64) -> Self {
        self.cell = cell;
        self
    }

    /// Permits data of the solver that inverts. Only a check of the optimiser, as that of the paper's appendix, needs it: the
    /// same errors on both sides cancel, so nothing is learnt about real data.
    #[must_use]
    pub fn round_trip(mut self) -> Self {
        self.round_trip = true;
        self
    }

    /// Identifies the law from all `tests` together.
    ///
    /// # Errors
    /// [`MaxwellidError`] if there is no test, too few samples, no arrival to start from, or data of the inverting solver without
    /// [`Self::round_trip`]. A fit that does not converge or does not determine its parameters is no error: see
    /// [`Identification::termination`] and [`Identification::identifiability`].
    pub fn to(&self, tests: &[RodTest]) -> Result<Identification<M>, MaxwellidError>
    where
        M: Clone,
    {
        let modulus = self.check(tests)?;
        let problem = TestResidual::new(tests, &self.model, self.cell);
        let parameters = self.model.parameter_names().len();
        if problem.samples() <= parameters {
            return Err(MaxwellidError::TooFewSamples {
                samples: problem.samples(),
                parameters,
            });
        }
        let start = if self.scan {
            let coarse = TestResidual::new(tests, &self.model, self.cell.max(SCAN_CELL));
            scan(&coarse, modulus)
        } else {
            self.model.parameters(modulus)
        };
        let minimum = minimise(&problem, &start, rounding(problem.samples()))?
            .ok_or_else(|| start_error(modulus))?;
        Ok(Identification::new(self.model.clone(), minimum, tests))
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
        let modulus = match self.modulus {
            Some(modulus) => modulus,
            // the longest rod has the smallest relative error in the time of flight
            None => tests
                .iter()
                .max_by(|a, b| a.length.total_cmp(&b.length))
                .unwrap_or(first)
                .modulus_from_time_of_flight()?,
        };
        if modulus.is_finite() && modulus > 0.0 {
            Ok(modulus)
        } else {
            Err(start_error(modulus))
        }
    }
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

/// Sum of squares (over V0²) that rounding leaves: 1e-14 of V0 a sample.
#[expect(
    clippy::cast_precision_loss,
    reason = "sample counts are far below 2^52"
)]
fn rounding(samples: usize) -> f64 {
    1e-28 * samples as f64
}

/// The one among the starts of the model that fits best.
fn scan<M: RodModel>(problem: &TestResidual<'_, M>, modulus: f64) -> Vec<f64> {
    let duration = problem
        .times
        .iter()
        .filter_map(|times| times.last().copied())
        .fold(0.0, f64::max);
    let mut best = (f64::INFINITY, problem.model.parameters(modulus));
    for candidate in problem.model.starts(modulus, duration) {
        if let Some(residual) = problem.residual(&candidate) {
            let value = sum_of_squares(&residual);
            if value < best.0 {
                best = (value, candidate);
            }
        }
    }
    best.1
}

/// The outcome of a [`Fit`].
#[derive(Debug, Clone)]
pub struct Identification<M> {
    model: M,
    parameters: Vec<f64>,
    linearisation: Linearisation,
    lengths: Vec<usize>,
    iterations: usize,
    termination: Termination,
}

impl<L: IdentifiableLaw> Identification<L> {
    /// The law at the minimum.
    #[must_use]
    pub fn law(&self) -> L {
        // the residual exists at these parameters, so the law does
        self.parameters
            .get(1..)
            .and_then(|of_law| self.model.with_parameters(of_law).ok())
            .unwrap_or_else(|| self.model.clone())
    }
}

impl<M: RodModel> Identification<M> {
    fn new(model: M, minimum: Minimum, tests: &[RodTest]) -> Self {
        Self {
            model,
            parameters: minimum.parameters,
            linearisation: minimum.linearisation,
            lengths: tests.iter().map(|test| test.window).collect(),
            iterations: minimum.iterations,
            termination: minimum.termination,
        }
    }

    /// The model that was fitted, as it was given.
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

    /// Number of iterations.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Why the iteration ended.
    #[must_use]
    pub fn termination(&self) -> Termination {
        self.termination
    }

    /// Root mean square of simulated minus measured response over V0: the error δ of (Ödeen 1993, paper D, section 4).
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        reason = "sample counts are far below 2^52"
    )]
    pub fn relative_error(&self) -> f64 {
        let residual = &self.linearisation.residual;
        (sum_of_squares(residual) / residual.len() as f64).sqrt()
    }

    /// Simulated minus measured response over V0, one slice for each test.
    pub fn residuals(&self) -> impl Iterator<Item = &[f64]> {
        let mut rest = self.linearisation.residual.as_slice();
        self.lengths.iter().map(move |length| {
            let (of_test, others) = rest.split_at(*length);
            rest = others;
            of_test
        })
    }

    /// Standard errors and verdicts of all parameters against `noise`; `None` if the Jacobian cannot be decomposed.
    #[must_use]
    pub fn identifiability(&self, noise: Noise) -> Option<Identifiability> {
        assess(
            &self.model,
            &self.parameters,
            &self.linearisation,
            &self.lengths,
            noise,
        )
    }
}
