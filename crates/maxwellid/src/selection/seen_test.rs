//! A test with the excitation and the covariance of the residual that are most likely for one
//! candidate.
//!
//! Noise in the excitation favours every θ that damps this noise: without the correction of
//! [`crate::whitening`], losses at high frequencies are found in noise alone, and linear laws with
//! short relaxation times are preferred to the true nonlinear law. Each candidate therefore has its
//! own excitation and covariance. The likelihood does not contain the determinant of the
//! covariance, because the excitation is set to its most probable value and not marginalised. The
//! expectation of χ² under the true law is the number of samples.

use crate::common_error::{CommonErrors, are_moved};
use crate::deviation::Deviation;
use crate::error::MaxwellidError;
use crate::model::{DrivenRod, RodModel, delayed, response_of};
use crate::parallel::all_in_order;
use crate::test::RodTest;
use crate::whitening::{Transfer, Weighting};

/// One test with its weighting.
#[derive(Debug, Clone)]
pub(crate) struct SeenTest<'a> {
    test: &'a RodTest,
    /// Times at which the response of the rod is needed, minus the delay about which the response
    /// is linearised \[s\].
    times: Vec<f64>,
    /// Delay and length about which the response is linearised.
    deviation: Deviation,
    weighting: Weighting,
    /// Measured response, corrected for the linearisation, with which the simulated response to the
    /// most likely excitation is compared [m/s].
    target: Vec<f64>,
}

/// All tests of a comparison, with their common errors.
#[derive(Debug, Clone, Default)]
pub(crate) struct SeenTests<'a> {
    pub(crate) tests: Vec<SeenTest<'a>>,
    pub(crate) common: CommonErrors,
    /// Delay and length of each test about which its response is linearised.
    deviations: Vec<Deviation>,
}

/// A candidate at θ.
#[derive(Clone, Copy)]
pub(crate) struct AtParameters<'a> {
    pub(crate) model: &'a dyn RodModel,
    pub(crate) parameters: &'a [f64],
    /// Longest cell of a grid \[m\].
    pub(crate) cell: f64,
    /// Factor on the white residual.
    pub(crate) weight: f64,
}

/// Largest number of iterations over delays and lengths.
const DELAYS: usize = 6;

/// Excitations, delays and lengths about which the tests are linearised.
#[derive(Debug, Clone, Default)]
pub(crate) struct Inputs {
    /// Excitation of each test [m/s]; the recorded excitations if empty.
    excitations: Vec<Vec<f64>>,
    /// Delay and length of each test; the stated ones if empty.
    deviations: Vec<Deviation>,
}

impl<'a> SeenTests<'a> {
    /// Creates the tests, their rods linearised about these `inputs`; `None` if the model does not
    /// exist.
    ///
    /// Each call linearises once about the excitation. Before the parameters have converged, the
    /// most likely excitation compensates for part of their error; further linearisations about
    /// this excitation would compensate for more of the error, and the next fit would not correct
    /// the parameters.
    pub(crate) fn of(tests: &'a [RodTest], at: AtParameters<'_>, inputs: Inputs) -> Option<Self> {
        let is_linear = at.model.is_linear();
        let before_filter = !is_linear && tests.iter().any(|test| test.drive(false).is_some());
        let Inputs {
            excitations,
            mut deviations,
        } = inputs;
        deviations.resize(tests.len(), Deviation::default());
        let about = all_in_order(tests.len(), |place| {
            let test = tests.get(place)?;
            let known = excitations.get(place).filter(|_| before_filter);
            let excitation = known.map_or_else(|| test.known_excitation(is_linear), Vec::as_slice);
            SeenTest::about(test, (excitation.to_vec(), *deviations.get(place)?), at)
        });
        let about = Self {
            tests: about?,
            common: CommonErrors::default(),
            deviations,
        };
        about.cleaned(tests, at)?.finished(tests, at)
    }

    /// The tests at other parameters nearby, where transfers and covariances are still valid,
    /// starting from the present excitations.
    pub(crate) fn moved_to(self, tests: &[RodTest], at: AtParameters<'_>) -> Option<Self> {
        self.cleaned(tests, at)?.finished(tests, at)
    }

    /// The most likely excitations, delays and lengths.
    pub(crate) fn inputs(&self) -> Inputs {
        let tests = self.tests.iter();
        Inputs {
            excitations: tests.map(|test| test.weighting.estimate.clone()).collect(),
            deviations: self.deviations.clone(),
        }
    }

    /// The tests with their most likely delays, lengths and excitations.
    fn cleaned(mut self, tests: &[RodTest], at: AtParameters<'_>) -> Option<Self> {
        let mut white = Vec::new();
        // the present common errors were computed at other parameters
        self.common = CommonErrors::default();
        for _ in 0..DELAYS {
            self = self.with_common_errors(tests, at)?;
            white = self.residual_of_records(at)?;
            let deviations = self.common.most_likely_deviations(tests, white.clone());
            let moves = are_moved(tests, &self.deviations, &deviations);
            self.deviations = deviations;
            if !moves {
                break;
            }
        }
        self.common.without(&mut white);
        let mut rest = white.as_slice();
        let cleaned: Option<Vec<SeenTest<'a>>> = self
            .tests
            .into_iter()
            .map(|of_test| {
                let (own, others) = rest.split_at(of_test.count());
                rest = others;
                let own: Vec<f64> = own.iter().map(|value| value / at.weight).collect();
                of_test.cleaned(&own)
            })
            .collect();
        Some(Self {
            tests: cleaned?,
            common: self.common,
            deviations: self.deviations,
        })
    }

    /// The tests with the common errors at their excitations, delays and lengths, and with the
    /// targets corrected for them.
    fn finished(self, tests: &[RodTest], at: AtParameters<'_>) -> Option<Self> {
        let mut seen = self.with_common_errors(tests, at)?;
        for (index, of_test) in seen.tests.iter_mut().enumerate() {
            let mut added = vec![0.0; of_test.count()];
            seen.common.add_offset(index, &mut added);
            let pairs = of_test.target.iter_mut().zip(&added);
            pairs.for_each(|(target, offset)| *target -= offset);
        }
        Some(seen)
    }

    /// Computes the common errors, with the responses linearised about the present delays and
    /// lengths.
    fn with_common_errors(mut self, tests: &[RodTest], at: AtParameters<'_>) -> Option<Self> {
        for (of_test, deviation) in self.tests.iter_mut().zip(&self.deviations) {
            of_test.times = delayed(&of_test.weighting.times(of_test.test), deviation.delay);
            of_test.deviation = *deviation;
        }
        let seen = |index: usize| {
            let of_test = self.tests.get(index)?;
            Some((of_test.rod(at.cell), &of_test.weighting))
        };
        let model = (at.model, at.parameters);
        let known = (!self.common.is_empty()).then_some(&self.common);
        let deviations = (self.deviations.clone(), known);
        self.common = CommonErrors::at(model, tests, deviations, seen, at.weight)?;
        Some(self)
    }

    /// The white residual of the response to the measured excitations, of all tests.
    fn residual_of_records(&self, at: AtParameters<'_>) -> Option<Vec<f64>> {
        let of_tests = all_in_order(self.tests.len(), |index| {
            let of_test = self.tests.get(index)?;
            let test = of_test.test;
            let mut own = if test.drive(at.model.is_linear()).is_some() {
                let response = response_of(at.model, &of_test.rod(at.cell), at.parameters)?;
                let mut own = of_test.seen(response);
                let pairs = own.iter_mut().zip(&of_test.weighting.correction);
                pairs.for_each(|(v, c)| *v += c);
                own
            } else {
                let rod = test.driven_rod(&of_test.times, at.cell);
                let rod = of_test.deviation.of_rod(rod);
                response_of(at.model, &rod, at.parameters)?
            };
            self.common.add_offset(index, &mut own);
            for (value, measured) in own.iter_mut().zip(test.response()) {
                *value -= measured;
            }
            of_test.whiten(&mut own);
            own.iter_mut().for_each(|value| *value *= at.weight);
            Some(own)
        });
        Some(of_tests?.concat())
    }
}

impl<'a> SeenTest<'a> {
    /// The test with the rod linearised about an excitation, a delay and a length.
    fn about(
        test: &'a RodTest,
        (excitation, deviation): (Vec<f64>, Deviation),
        at: AtParameters<'_>,
    ) -> Option<Self> {
        let transfer = Transfer::new(at.model, at.parameters, test, (&excitation, deviation))?;
        let transfer = (transfer, at.model.is_linear());
        let weighting = Weighting::new(test, transfer, 0.0, excitation)?;
        Some(Self::of(test, weighting))
    }

    fn of(test: &'a RodTest, weighting: Weighting) -> Self {
        let pairs = test.response().iter().zip(&weighting.correction);
        Self {
            test,
            times: Vec::new(),
            deviation: Deviation::default(),
            target: pairs.map(|(measured, c)| measured - c).collect(),
            weighting,
        }
    }

    /// The test with the excitation that is most likely for this white residual.
    fn cleaned(self, white_residual: &[f64]) -> Option<Self> {
        let weighting = self.weighting.cleaned(self.test, white_residual)?;
        Some(Self::of(self.test, weighting))
    }

    /// The rod driven by the most likely excitation.
    pub(crate) fn rod(&self, cell: f64) -> DrivenRod<'_> {
        let rod = self.weighting.driven_rod(self.test, &self.times, cell);
        self.deviation.of_rod(rod)
    }

    /// The samples of a response of [`Self::rod`].
    pub(crate) fn seen(&self, response: Vec<f64>) -> Vec<f64> {
        self.weighting.seen(self.test, response)
    }

    /// Number of samples compared.
    pub(crate) fn count(&self) -> usize {
        self.test.window
    }

    pub(crate) fn target(&self) -> &[f64] {
        &self.target
    }

    /// Whitens values [m/s] to standard deviations in place.
    pub(crate) fn whiten(&self, values: &mut [f64]) {
        self.weighting.whiten(values);
    }
}

/// Standard deviation [m/s] of a residual for the comparison of starts, under the assumption that
/// the response is twice the excitation.
pub(crate) fn rough_level(test: &RodTest) -> Result<f64, MaxwellidError> {
    let noise = test.noise().ok_or_else(|| MaxwellidError::NoiseUnknown {
        test: test.name().to_owned(),
    })?;
    let (excitation, response) = (&noise.excitation, &noise.response);
    Ok((2.0 * excitation.standard_deviation()).hypot(response.standard_deviation()))
}
