//! Residual of the direct problem: simulated minus measured response of all tests, divided by V0 or
//! by its standard deviation.

use rodwave::band_limited::SampledHistory;

use crate::common_error::{CommonErrorEstimate, CommonErrors};
use crate::deviation::Deviation;
use crate::least_squares::{LeastSquares, Linearisation};
use crate::model::{DrivenRod, RodModel, delayed, linearised_response_of, response_of};
use crate::nuisance::{IteratedNuisance, Nuisances, Orthonormal};
use crate::parallel::all_in_order;
use crate::test::RodTest;
use crate::whitening::Weighting;

/// The sum of squares of (Ödeen 1993, paper D, eq. 12), each residual divided by the impact
/// velocity of its test or, with weightings, whitened.
///
/// The parameters are θ of the model, followed by the nuisances of the iteration of each test.
pub(crate) struct TestResidual<'a, M> {
    pub(crate) tests: &'a [RodTest],
    /// Times of the samples in the window of each test.
    pub(crate) times: Vec<Vec<f64>>,
    pub(crate) model: &'a M,
    /// Longest cell of the grid \[m\].
    pub(crate) cell: f64,
    pub(crate) nuisances: Nuisances,
    /// Weightings, one per test, or empty.
    pub(crate) weightings: Vec<Weighting>,
    /// Common errors of the weighted tests.
    pub(crate) common: CommonErrors,
}

/// Difference of gain, and of offset over V0, for the derivatives with respect to those of the
/// excitation.
const DIFFERENCE: f64 = 1e-5;

/// Difference of time, in samples, for dS/dt.
const TIME_DIFFERENCE: f64 = 0.02;

/// The simulated response of one test and its derivatives with respect to θ and to the nuisances of
/// the iteration [m/s].
struct Simulated {
    velocity: Vec<f64>,
    derivatives: Vec<Vec<f64>>,
}

/// Contribution of one test to the residual.
pub(crate) struct TestRows {
    residual: Vec<f64>,
    /// Columns of θ and of the test's own nuisances of the iteration.
    columns: Vec<Vec<f64>>,
    /// Columns of gain and offset, if these are unknown.
    linear_columns: Vec<Vec<f64>>,
    /// Gain - 1 and offset \[m/s\], if unknown.
    linear: Vec<f64>,
}

impl<'a, M: RodModel> TestResidual<'a, M> {
    pub(crate) fn new(tests: &'a [RodTest], model: &'a M, cell: f64) -> Self {
        Self {
            tests,
            times: tests.iter().map(RodTest::times).collect(),
            model,
            cell,
            nuisances: Nuisances::default(),
            weightings: Vec::new(),
            common: CommonErrors::default(),
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.times.iter().map(Vec::len).sum()
    }

    /// Number of parameters of the model.
    pub(crate) fn of_model(&self) -> usize {
        self.model.step_limits().len()
    }

    fn own_nuisances<'p>(&self, test: usize, parameters: &'p [f64]) -> &'p [f64] {
        let each = self.nuisances.of_iteration().len();
        let first = self.of_model() + test * each;
        parameters.get(first..first + each).unwrap_or(&[])
    }

    /// Simulates one test at given values of its nuisances; `linearise` requests derivatives.
    fn simulated(&self, test: usize, parameters: &[f64], linearise: bool) -> Option<Simulated> {
        let of_model = parameters.get(..self.of_model())?;
        let own = self.own_nuisances(test, parameters);
        let velocity = |own: &[f64], shift: f64| self.velocity(test, of_model, own, shift);
        if !linearise {
            return Some(Simulated {
                velocity: velocity(own, 0.0)?,
                derivatives: Vec::new(),
            });
        }
        let mut simulated = self.driven(test, own, 0.0, |rod| {
            let response = linearised_response_of(self.model, rod, of_model)?;
            let derivatives = response.by_parameter.into_iter();
            Some(Simulated {
                velocity: self.seen(test, response.velocity)?,
                derivatives: derivatives
                    .map(|derivative| self.seen(test, derivative))
                    .collect::<Option<_>>()?,
            })
        })?;
        let test_of = self.tests.get(test)?;
        for (index, (nuisance, _)) in self.nuisances.of_iteration().into_iter().enumerate() {
            let difference = match nuisance {
                IteratedNuisance::Delay => {
                    let h = TIME_DIFFERENCE / test_of.sampling_rate_hz;
                    let (late, early) = (velocity(own, h)?, velocity(own, -h)?);
                    late.iter()
                        .zip(&early)
                        .map(|(l, e)| (l - e) / (2.0 * h))
                        .collect()
                }
                IteratedNuisance::ExcitationGain | IteratedNuisance::ExcitationOffset => {
                    let step = match nuisance {
                        IteratedNuisance::ExcitationGain => DIFFERENCE,
                        _ => DIFFERENCE * test_of.impact_velocity,
                    };
                    let mut moved = own.to_vec();
                    *moved.get_mut(index)? += step;
                    velocity(&moved, 0.0)?
                        .iter()
                        .zip(&simulated.velocity)
                        .map(|(m, v)| (m - v) / step)
                        .collect()
                }
            };
            simulated.derivatives.push(difference);
        }
        self.add_correction(test, &mut simulated.velocity);
        Some(simulated)
    }

    /// Returns S at the times of the samples minus the delay minus `shift` \[s\].
    fn velocity(&self, test: usize, of_model: &[f64], own: &[f64], shift: f64) -> Option<Vec<f64>> {
        self.driven(test, own, shift, |rod| {
            self.seen(test, response_of(self.model, rod, of_model)?)
        })
    }

    /// Samples of a test from the response of its rod.
    fn seen(&self, test: usize, response: Vec<f64>) -> Option<Vec<f64>> {
        Some(match self.weightings.get(test) {
            Some(weighting) => weighting.seen(self.tests.get(test)?, response),
            None => response,
        })
    }

    /// S of one test on a grid of `cell` \[m\], with its nuisances at their reference values.
    pub(crate) fn response_on(&self, test: usize, of_model: &[f64], cell: f64) -> Option<Vec<f64>> {
        self.driven(test, &[], 0.0, |rod| {
            let rod = DrivenRod { cell, ..*rod };
            self.seen(test, response_of(self.model, &rod, of_model)?)
        })
    }

    fn add_correction(&self, test: usize, velocity: &mut [f64]) {
        if let Some(weighting) = self.weightings.get(test) {
            for (v, c) in velocity.iter_mut().zip(&weighting.correction) {
                *v += c;
            }
        }
        self.common.add_offset(test, velocity);
    }

    /// The delay \[s\] of a test among its nuisances, 0 if it is known.
    pub(crate) fn delay_of_nuisances(&self, test: usize, parameters: &[f64]) -> f64 {
        let own = self.own_nuisances(test, parameters);
        let mut each = self.nuisances.of_iteration().into_iter().zip(own);
        each.find_map(|((of, _), value)| (of == IteratedNuisance::Delay).then_some(*value))
            .unwrap_or(0.0)
    }

    /// The delay \[s\] of the response of a test at `parameters`.
    pub(crate) fn delay(&self, test: usize, parameters: &[f64]) -> f64 {
        self.common.deviation(test).delay + self.delay_of_nuisances(test, parameters)
    }

    /// Calls `ask` with the rod of a test, with the excitation and the times that its nuisances
    /// give.
    fn driven<R>(
        &self,
        test: usize,
        own: &[f64],
        shift: f64,
        ask: impl Fn(&DrivenRod<'_>) -> Option<R>,
    ) -> Option<R> {
        let deviation = self.common.deviation(test);
        let (mut delay, mut gain, mut offset) = (shift + deviation.delay, 1.0, 0.0);
        let mut excitation_changed = false;
        for ((nuisance, _), value) in self.nuisances.of_iteration().into_iter().zip(own) {
            match nuisance {
                IteratedNuisance::Delay => delay += value,
                IteratedNuisance::ExcitationGain => gain += value,
                IteratedNuisance::ExcitationOffset => offset = *value,
            }
            excitation_changed |= nuisance != IteratedNuisance::Delay;
        }
        let test_of = self.tests.get(test)?;
        let weighting = self.weightings.get(test);
        let mut times = match weighting {
            Some(weighting) => weighting.times(test_of),
            None => self.times.get(test)?.clone(),
        };
        if delay != 0.0 {
            times = delayed(&times, delay);
        }
        let rod = match weighting {
            Some(weighting) => weighting.driven_rod(test_of, &times, self.cell),
            None => test_of.driven_rod(&times, self.cell),
        };
        let rod = deviation.of_rod(rod);
        if !excitation_changed {
            return ask(&rod);
        }
        let changed: Vec<f64> = rod.samples.iter().map(|v| gain * v + offset).collect();
        let history = SampledHistory::new(&changed, rod.sampling_rate_hz).ok()?;
        ask(&DrivenRod {
            samples: &changed,
            excitation: &history,
            ..rod
        })
    }

    /// Divides a history by V0 or, with weightings, whitens it.
    fn weigh(&self, test: usize, history: &mut [f64]) -> Option<()> {
        match self.weightings.get(test) {
            Some(weighting) => weighting.whiten(history),
            None => {
                let scale = 1.0 / self.tests.get(test)?.impact_velocity;
                history.iter_mut().for_each(|h| *h *= scale);
            }
        }
        Some(())
    }

    /// Rows of one test. With `project` gain and offset are eliminated from residual and columns.
    #[allow(
        clippy::indexing_slicing,
        reason = "a linear nuisance has an entry for each of its columns, that of an unknown gain being the first"
    )]
    pub(crate) fn rows(
        &self,
        test: usize,
        parameters: &[f64],
        linearise: bool,
        project: bool,
    ) -> Option<TestRows> {
        let mut simulated = self.simulated(test, parameters, linearise)?;
        if !linearise {
            self.add_correction(test, &mut simulated.velocity);
        }
        let measured = self.tests.get(test)?.response();
        let mut residual: Vec<f64> = simulated
            .velocity
            .iter()
            .zip(measured)
            .map(|(s, m)| s - m)
            .collect();
        self.weigh(test, &mut residual)?;
        let linear_freedoms = [self.nuisances.response_gain, self.nuisances.response_offset];
        let mut linear_columns = Vec::new();
        if linear_freedoms[0].is_unknown() {
            linear_columns.push(simulated.velocity.clone());
        }
        if linear_freedoms[1].is_unknown() {
            linear_columns.push(vec![1.0; residual.len()]);
        }
        for column in &mut linear_columns {
            self.weigh(test, column)?;
        }
        let mut columns = simulated.derivatives;
        for column in &mut columns {
            self.weigh(test, column)?;
        }
        self.append_calibrations(
            test,
            parameters,
            &mut residual,
            &mut columns,
            &mut linear_columns,
        );
        let mut linear = Vec::new();
        if !linear_columns.is_empty() {
            let orthonormal = Orthonormal::of(&linear_columns);
            let mut rest = residual.clone();
            linear = orthonormal.take_from(&mut rest);
            linear.iter_mut().for_each(|c| *c = -*c);
            if linear_freedoms[0].is_unknown() {
                // the gain is the first of the linear nuisances
                let gain = 1.0 + linear[0];
                columns.iter_mut().flatten().for_each(|d| *d *= gain);
            }
            if project {
                for column in &mut columns {
                    orthonormal.take_from(column);
                }
            }
            // the sum of squares is that of the eliminated problem in either case
            residual = rest;
        }
        let finite = residual
            .iter()
            .chain(columns.iter().flatten())
            .all(|v| v.is_finite());
        finite.then_some(TestRows {
            residual,
            columns,
            linear_columns,
            linear,
        })
    }

    /// Appends a row per calibration: (value - its calibration)/standard deviation.
    fn append_calibrations(
        &self,
        test: usize,
        parameters: &[f64],
        residual: &mut Vec<f64>,
        columns: &mut [Vec<f64>],
        linear_columns: &mut [Vec<f64>],
    ) {
        let of_model = self.of_model();
        let own = self.own_nuisances(test, parameters);
        let iterated = self.nuisances.of_iteration();
        for (index, ((_, freedom), value)) in iterated.iter().zip(own).enumerate() {
            if let Some(weight) = freedom.prior_weight() {
                residual.push(weight * value);
                for (k, column) in columns.iter_mut().enumerate() {
                    column.push(if k == of_model + index { weight } else { 0.0 });
                }
                linear_columns
                    .iter_mut()
                    .for_each(|column| column.push(0.0));
            }
        }
        let linear = [self.nuisances.response_gain, self.nuisances.response_offset];
        let unknown: Vec<_> = linear.into_iter().filter(|f| f.is_unknown()).collect();
        for (index, freedom) in unknown.iter().enumerate() {
            if let Some(weight) = freedom.prior_weight() {
                residual.push(0.0);
                columns.iter_mut().for_each(|column| column.push(0.0));
                for (k, column) in linear_columns.iter_mut().enumerate() {
                    column.push(if k == index { weight } else { 0.0 });
                }
            }
        }
    }

    /// Gain - 1 and offset of each test, if unknown.
    pub(crate) fn linear_nuisances(&self, parameters: &[f64]) -> Option<Vec<Vec<f64>>> {
        (0..self.tests.len())
            .map(|test| Some(self.rows(test, parameters, false, true)?.linear))
            .collect()
    }

    /// The residual of each test, with the rows of its calibrations at the end, minus the part that
    /// the most likely common errors explain.
    pub(crate) fn residual_of_tests(&self, parameters: &[f64]) -> Option<Vec<Vec<f64>>> {
        let of_tests = self.white_of_tests(parameters)?;
        let mut all = of_tests.concat();
        self.common.without(&mut all);
        let mut rest = all.into_iter();
        let own = |of_test: &Vec<f64>| rest.by_ref().take(of_test.len()).collect();
        Some(of_tests.iter().map(own).collect())
    }

    /// The residual of each test, before the factors of the common errors are applied.
    fn white_of_tests(&self, parameters: &[f64]) -> Option<Vec<Vec<f64>>> {
        all_in_order(self.tests.len(), |test| {
            Some(self.rows(test, parameters, false, true)?.residual)
        })
    }

    fn white(&self, parameters: &[f64]) -> Option<Vec<f64>> {
        Some(self.white_of_tests(parameters)?.concat())
    }

    /// The most likely delays and lengths of the tests at `parameters`, 0 for known ones.
    pub(crate) fn most_likely_deviations(&self, parameters: &[f64]) -> Option<Vec<Deviation>> {
        if self.common.is_empty() {
            return Some(vec![Deviation::default(); self.tests.len()]);
        }
        let white = self.white(parameters)?;
        Some(self.common.most_likely_deviations(self.tests, white))
    }

    /// The most likely common errors at a minimum.
    pub(crate) fn common_errors_at(&self, parameters: &[f64]) -> Vec<CommonErrorEstimate> {
        if self.common.is_empty() {
            return Vec::new();
        }
        let white = self.stacked(parameters, true);
        white.map_or_else(Vec::new, |white| self.common.estimates(white))
    }

    /// Renews the common errors at `parameters`, with the responses linearised about
    /// `deviations`;
    /// `None` if the model does not exist there. If transducers are unknown, there are no common
    /// errors.
    pub(crate) fn with_common_errors(
        mut self,
        parameters: &[f64],
        deviations: Vec<Deviation>,
    ) -> Option<Self> {
        if self.nuisances.any() {
            return Some(self);
        }
        let of_model = parameters.get(..self.of_model())?;
        let each = self.tests.iter().zip(&self.weightings).zip(&deviations);
        let times: Vec<Vec<f64>> = each
            .map(|((test, weighting), at)| delayed(&weighting.times(test), at.delay))
            .collect();
        self.common = CommonErrors::at(
            (self.model, of_model),
            self.tests,
            (deviations.clone(), None),
            |test| {
                let weighting = self.weightings.get(test)?;
                let of_test = self.tests.get(test)?;
                let rod = weighting.driven_rod(of_test, times.get(test)?, self.cell);
                Some((deviations.get(test)?.of_rod(rod), weighting))
            },
            1.0,
        )?;
        Some(self)
    }

    /// Residual divided by V0, for the nuisances and the most likely errors of the white residuals,
    /// with derivatives with respect to θ and the nuisances of the iteration.
    pub(crate) fn over_impact_velocity(&self, parameters: &[f64]) -> Option<Linearisation> {
        let linear = self.linear_nuisances(parameters)?;
        let mut residual = Vec::with_capacity(self.samples());
        let mut jacobian = vec![Vec::with_capacity(self.samples()); self.of_model()];
        let errors = if self.common.is_empty() {
            vec![0.0; self.samples()]
        } else {
            self.common.explained(self.white(parameters)?)
        };
        for (test, (of_test, linear)) in self.tests.iter().zip(&linear).enumerate() {
            let simulated = self.simulated(test, parameters, true)?;
            let mut coefficients = linear.iter().copied();
            let gain = if self.nuisances.response_gain.is_unknown() {
                1.0 + coefficients.next()?
            } else {
                1.0
            };
            let offset = if self.nuisances.response_offset.is_unknown() {
                coefficients.next()?
            } else {
                0.0
            };
            let scale = 1.0 / of_test.impact_velocity;
            let errors = errors.get(residual.len()..)?;
            residual.extend(
                simulated
                    .velocity
                    .iter()
                    .zip(of_test.response())
                    .zip(errors)
                    .map(|((s, m), error)| scale * (gain * s + offset + error - m)),
            );
            for (column, derivative) in jacobian.iter_mut().zip(&simulated.derivatives) {
                column.extend(derivative.iter().map(|d| scale * gain * d));
            }
        }
        Some(Linearisation { residual, jacobian })
    }

    /// Residual and columns of all tests, with their common errors.
    pub(crate) fn assembled(&self, parameters: &[f64], project: bool) -> Option<Linearisation> {
        let mut all = self.stacked(parameters, project)?;
        self.common.whiten(&mut all.residual);
        for column in &mut all.jacobian {
            self.common.whiten(column);
        }
        Some(all)
    }

    /// Residual and columns of all tests. Without `project` gain and offset of each test have
    /// separate columns at the end.
    pub(crate) fn stacked(&self, parameters: &[f64], project: bool) -> Option<Linearisation> {
        let rows = all_in_order(self.tests.len(), |test| {
            self.rows(test, parameters, true, project)
        })?;
        let samples = rows.iter().map(|rows| rows.residual.len()).sum();
        let of_model = self.of_model();
        let each = self.nuisances.of_iteration().len();
        let linear = rows.first().map_or(0, |rows| rows.linear_columns.len());
        let count = of_model + each * rows.len();
        let all = count + if project { 0 } else { linear * rows.len() };
        let mut residual = Vec::with_capacity(samples);
        let mut jacobian = vec![vec![0.0; samples]; all];
        for (test, rows) in rows.into_iter().enumerate() {
            let place = residual.len()..residual.len() + rows.residual.len();
            residual.extend(rows.residual);
            for (k, column) in rows.columns.into_iter().enumerate() {
                let at = if k < of_model { k } else { k + test * each };
                let rows = jacobian.get_mut(at)?.get_mut(place.clone())?;
                rows.copy_from_slice(&column);
            }
            if !project {
                for (k, column) in rows.linear_columns.into_iter().enumerate() {
                    let whole = jacobian.get_mut(count + test * linear + k)?;
                    whole.get_mut(place.clone())?.copy_from_slice(&column);
                }
            }
        }
        Some(Linearisation { residual, jacobian })
    }
}

impl<M: RodModel> LeastSquares for TestResidual<'_, M> {
    fn residual(&self, parameters: &[f64]) -> Option<Vec<f64>> {
        let mut residual = self.white(parameters)?;
        self.common.whiten(&mut residual);
        Some(residual)
    }

    fn linearisation(&self, parameters: &[f64]) -> Option<Linearisation> {
        self.assembled(parameters, true)
    }

    fn step_limits(&self) -> Vec<f64> {
        let mut limits = self.model.step_limits();
        for test in self.tests {
            limits.extend(self.nuisances.of_iteration().iter().map(
                |(nuisance, _)| match nuisance {
                    IteratedNuisance::Delay => 1.0 / test.sampling_rate_hz,
                    IteratedNuisance::ExcitationGain => 0.2,
                    IteratedNuisance::ExcitationOffset => 0.2 * test.impact_velocity,
                },
            ));
        }
        limits
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        let mut bounds = self.model.bounds();
        for test in self.tests {
            bounds.extend(self.nuisances.of_iteration().iter().map(
                |(nuisance, _)| match nuisance {
                    IteratedNuisance::Delay => {
                        let largest = Nuisances::LARGEST_DELAY / test.sampling_rate_hz;
                        (-largest, largest)
                    }
                    IteratedNuisance::ExcitationGain => (-0.9, 9.0),
                    IteratedNuisance::ExcitationOffset => {
                        (-test.impact_velocity, test.impact_velocity)
                    }
                },
            ));
        }
        bounds
    }
}
