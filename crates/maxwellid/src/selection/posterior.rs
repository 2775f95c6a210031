//! The most probable parameters of one candidate, and the evidence for it.

use crate::error::MaxwellidError;
use crate::least_squares::{
    LeastSquares, Linearisation, Minimum, ScaledDecomposition, minimise, sum_of_squares,
};
use crate::model::RodModel;
use crate::selection::candidate::{Candidate, Prior};
use crate::selection::covariance::CommonCovariance;
use crate::test::RodTest;

/// Whitened residuals of all tests, followed by one row a parameter for its prior.
pub(crate) struct PosteriorProblem<'a> {
    pub(crate) model: &'a dyn RodModel,
    pub(crate) tests: &'a [RodTest],
    pub(crate) times: &'a [Vec<f64>],
    pub(crate) covariance: &'a CommonCovariance,
    /// What the whitened residuals are multiplied by: 1/(standard deviation).
    pub(crate) weight: f64,
    pub(crate) prior: &'a Prior,
    /// Longest cell of a grid \[m\].
    pub(crate) cell: f64,
}

impl PosteriorProblem<'_> {
    pub(crate) fn samples(&self) -> usize {
        self.times.iter().map(Vec::len).sum()
    }

    /// Whitens and weighs a column of the samples of all tests, in m/s, V0 being taken out.
    fn whiten(&self, column: &mut [f64]) {
        let mut rest = &mut *column;
        for (test, times) in self.tests.iter().zip(self.times) {
            let (of_test, others) = rest.split_at_mut(times.len());
            rest = others;
            let scale = self.weight / test.impact_velocity;
            for value in of_test {
                *value *= scale;
            }
        }
        self.covariance.whiten(column);
    }

    fn measured(&self) -> impl Iterator<Item = f64> + '_ {
        self.tests.iter().flat_map(|test| test.response().iter().copied())
    }

    fn finish(&self, mut simulated: Vec<f64>, parameters: &[f64]) -> Vec<f64> {
        for (value, measured) in simulated.iter_mut().zip(self.measured()) {
            *value -= measured;
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
        let mut simulated = Vec::with_capacity(self.samples() + parameters.len());
        for (test, times) in self.tests.iter().zip(self.times) {
            let rod = test.driven_rod(times, self.cell);
            simulated.extend(self.model.response(&rod, parameters)?);
        }
        let residual = self.finish(simulated, parameters);
        residual.iter().all(|r| r.is_finite()).then_some(residual)
    }

    fn linearisation(&self, parameters: &[f64]) -> Option<Linearisation> {
        let samples = self.samples();
        let mut simulated = Vec::with_capacity(samples + parameters.len());
        let mut jacobian = vec![Vec::with_capacity(samples + parameters.len()); parameters.len()];
        for (test, times) in self.tests.iter().zip(self.times) {
            let rod = test.driven_rod(times, self.cell);
            let response = self.model.linearised_response(&rod, parameters)?;
            simulated.extend(response.velocity);
            for (column, derivative) in jacobian.iter_mut().zip(response.by_parameter) {
                column.extend(derivative);
            }
        }
        for (index, column) in jacobian.iter_mut().enumerate() {
            self.whiten(column);
            column.extend(self.prior.deviation.iter().enumerate().map(|(row, deviation)| {
                if row == index { 1.0 / deviation } else { 0.0 }
            }));
        }
        let residual = self.finish(simulated, parameters);
        let finite = residual.iter().all(|r| r.is_finite())
            && jacobian.iter().flatten().all(|d| d.is_finite());
        finite.then_some(Linearisation { residual, jacobian })
    }

    fn step_limits(&self) -> Vec<f64> {
        self.model.step_limits()
    }
}

/// What a fit with prior found.
#[derive(Debug, Clone)]
pub(crate) struct Posterior {
    pub(crate) minimum: Minimum,
    /// Σ of the squares of the whitened, weighted residuals.
    pub(crate) chi_square: f64,
    /// Σ of the squares of the prior's rows.
    pub(crate) prior_square: f64,
    /// ½ ln det(1 + S Jᵀ J S), S the standard deviations of the prior: by how much the data narrow the parameters.
    pub(crate) occam: f64,
    /// Number of parameters that the data determine better than the prior: Σ s²/(1 + s²).
    pub(crate) determined: f64,
}

/// Fits spend their time where a grid is; a start is good enough on a coarse one.
const SCAN_CELL: f64 = 8e-3;

/// Factors of E at which starts are tried: the time of flight may be a fraction of a period off.
const MODULUS_FACTORS: [f64; 3] = [1.0, 0.92, 1.09];

/// Starts from which a fit is made.
const FITS: usize = 2;

impl PosteriorProblem<'_> {
    /// The most probable parameters, from the best among the starts of `candidate`; `None` if the model exists at none of them.
    pub(crate) fn search(
        &self,
        candidate: &Candidate,
        modulus: f64,
        duration: f64,
    ) -> Result<Option<Posterior>, MaxwellidError> {
        let coarse = PosteriorProblem {
            cell: self.cell.max(SCAN_CELL),
            ..*self
        };
        let mut starts: Vec<(f64, Vec<f64>)> = MODULUS_FACTORS
            .iter()
            .flat_map(|factor| candidate.starts(modulus * factor, duration))
            .filter_map(|start| {
                let value = sum_of_squares(&coarse.residual(&start)?);
                Some((value, start))
            })
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<Posterior> = None;
        for (_, start) in starts.iter().take(FITS) {
            let found = self.from(start)?;
            let is_better = |found: &Posterior| {
                best.as_ref()
                    .is_none_or(|best| found.objective() < best.objective())
            };
            if let Some(found) = found.filter(is_better) {
                best = Some(found);
            }
        }
        Ok(best)
    }

    /// The most probable parameters near `start`.
    pub(crate) fn from(&self, start: &[f64]) -> Result<Option<Posterior>, MaxwellidError> {
        let Some(minimum) = minimise(self, start, 0.0)? else {
            return Ok(None);
        };
        let residual = &minimum.linearisation.residual;
        let (of_data, of_prior) = residual.split_at(self.samples());
        let Some(svd) =
            ScaledDecomposition::new(&minimum.linearisation, &self.prior.deviation)
        else {
            return Err(MaxwellidError::Decomposition {
                iteration: minimum.iterations,
            });
        };
        // rows of the data and of the prior together: squares of singular values are 1 + those of the data
        let occam = svd.singular_values.iter().map(|s| s.ln()).sum();
        let determined = svd.singular_values.iter().map(|s| 1.0 - 1.0 / (s * s)).sum();
        Ok(Some(Posterior {
            chi_square: sum_of_squares(of_data),
            prior_square: sum_of_squares(of_prior),
            occam,
            determined,
            minimum,
        }))
    }
}

impl Posterior {
    fn objective(&self) -> f64 {
        self.chi_square + self.prior_square
    }
}
