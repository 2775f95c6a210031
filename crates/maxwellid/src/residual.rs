//! The direct problem as residual: simulated minus measured response of all tests, over V0.

use rodwave::{DirectProblem, InelasticRod};

use crate::law::IdentifiableLaw;
use crate::least_squares::{LeastSquares, Linearisation};
use crate::test::RodTest;

/// The sum of squares of (Ödeen 1993, paper D, eq. 12), each residual divided by the impact velocity of its test.
///
/// Parameters θ = (ln E, parameters of the law).
pub(crate) struct TestResidual<'a, L> {
    pub(crate) tests: &'a [RodTest],
    /// The times of the samples in the window of each test.
    pub(crate) times: Vec<Vec<f64>>,
    pub(crate) law: L,
    /// Longest cell of the grid \[m\].
    pub(crate) cell: f64,
}

impl<'a, L: IdentifiableLaw> TestResidual<'a, L> {
    pub(crate) fn new(tests: &'a [RodTest], law: L, cell: f64) -> Self {
        Self {
            tests,
            times: tests.iter().map(RodTest::times).collect(),
            law,
            cell,
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.times.iter().map(Vec::len).sum()
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "lengths and cells are positive; the ratio is a cell count"
    )]
    pub(crate) fn problem(&self, test: &RodTest, parameters: &[f64]) -> Option<DirectProblem<L>> {
        let (log_modulus, of_law) = parameters.split_first()?;
        let law = self.law.with_parameters(of_law).ok()?;
        let rod = InelasticRod::new(test.length, test.density, log_modulus.exp(), law).ok()?;
        let cells = (test.length / self.cell).ceil().max(16.0) as usize;
        DirectProblem::new(rod, cells).ok()
    }
}

impl<L: IdentifiableLaw> LeastSquares for TestResidual<'_, L> {
    fn residual(&self, parameters: &[f64]) -> Option<Vec<f64>> {
        let mut residual = Vec::with_capacity(self.samples());
        for (test, times) in self.tests.iter().zip(&self.times) {
            let simulated = self
                .problem(test, parameters)?
                .free_end_velocity(&test.excitation, times)
                .ok()?;
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
        for (test, times) in self.tests.iter().zip(&self.times) {
            let response = self
                .problem(test, parameters)?
                .free_end_velocity_with_sensitivities(&test.excitation, times)
                .ok()?;
            let scale = 1.0 / test.impact_velocity;
            residual.extend(
                response
                    .velocity
                    .iter()
                    .zip(test.response())
                    .map(|(s, m)| scale * (s - m)),
            );
            let derivatives =
                std::iter::once(&response.by_log_modulus).chain(&response.by_parameter);
            for (column, derivative) in jacobian.iter_mut().zip(derivatives) {
                column.extend(derivative.iter().map(|d| scale * d));
            }
        }
        let finite = residual.iter().all(|r| r.is_finite())
            && jacobian.iter().flatten().all(|d| d.is_finite());
        finite.then_some(Linearisation { residual, jacobian })
    }

    fn step_limits(&self) -> Vec<f64> {
        // 10 % of E in one iteration: half a period of the waveform at most
        std::iter::once(0.1)
            .chain(L::STEP_LIMITS.iter().copied())
            .collect()
    }
}
