//! The direct problem as residual: simulated minus measured response of all tests, over V0.

use crate::least_squares::{LeastSquares, Linearisation};
use crate::model::{DrivenRod, RodModel};
use crate::test::RodTest;

/// The sum of squares of (Ödeen 1993, paper D, eq. 12), each residual divided by the impact velocity of its test.
pub(crate) struct TestResidual<'a, M> {
    pub(crate) tests: &'a [RodTest],
    /// The times of the samples in the window of each test.
    pub(crate) times: Vec<Vec<f64>>,
    pub(crate) model: &'a M,
    /// Longest cell of the grid \[m\].
    pub(crate) cell: f64,
}

impl<'a, M: RodModel> TestResidual<'a, M> {
    pub(crate) fn new(tests: &'a [RodTest], model: &'a M, cell: f64) -> Self {
        Self {
            tests,
            times: tests.iter().map(RodTest::times).collect(),
            model,
            cell,
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.times.iter().map(Vec::len).sum()
    }

    fn driven(&self) -> impl Iterator<Item = (&'a RodTest, DrivenRod<'_>)> {
        self.tests
            .iter()
            .zip(&self.times)
            .map(|(test, times)| (test, test.driven_rod(times, self.cell)))
    }
}

impl<M: RodModel> LeastSquares for TestResidual<'_, M> {
    fn residual(&self, parameters: &[f64]) -> Option<Vec<f64>> {
        let mut residual = Vec::with_capacity(self.samples());
        for (test, rod) in self.driven() {
            let simulated = self.model.response(&rod, parameters)?;
            let scale = 1.0 / test.impact_velocity;
            residual.extend(
                simulated
                    .iter()
                    .zip(test.response())
                    .map(|(s, m)| scale * (s - m)),
            );
        }
        residual.iter().all(|r| r.is_finite()).then_some(residual)
    }

    fn linearisation(&self, parameters: &[f64]) -> Option<Linearisation> {
        let samples = self.samples();
        let mut residual = Vec::with_capacity(samples);
        let mut jacobian = vec![Vec::with_capacity(samples); parameters.len()];
        for (test, rod) in self.driven() {
            let response = self.model.linearised_response(&rod, parameters)?;
            let scale = 1.0 / test.impact_velocity;
            residual.extend(
                response
                    .velocity
                    .iter()
                    .zip(test.response())
                    .map(|(s, m)| scale * (s - m)),
            );
            for (column, derivative) in jacobian.iter_mut().zip(&response.by_parameter) {
                column.extend(derivative.iter().map(|d| scale * d));
            }
        }
        let finite = residual.iter().all(|r| r.is_finite())
            && jacobian.iter().flatten().all(|d| d.is_finite());
        finite.then_some(Linearisation { residual, jacobian })
    }

    fn step_limits(&self) -> Vec<f64> {
        self.model.step_limits()
    }
}
