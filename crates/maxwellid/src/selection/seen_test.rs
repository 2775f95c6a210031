//! A test with the excitation and the covariance of the residual that are most likely for one candidate.
//!
//! Noise in the excitation favours every θ that damps it: without the correction of [`crate::whitening`] losses at high frequency
//! are found in noise alone, and linear laws of short relaxation times are preferred to the true nonlinear one. Each candidate
//! therefore has its own excitation and covariance. The determinant of the covariance does not enter: the excitation is not
//! marginalised; the most probable one is taken, with which the expectation of χ² under the true law is the number of samples.

use crate::error::MaxwellidError;
use crate::model::{DrivenRod, RodModel, response_of};
use crate::test::RodTest;
use crate::whitening::{Transfer, Weighting};

/// One test with its weighting.
#[derive(Debug, Clone)]
pub(crate) struct SeenTest<'a> {
    test: &'a RodTest,
    times: &'a [f64],
    weighting: Weighting,
    /// Target for the simulated response to the most likely excitation [m/s].
    target: Vec<f64>,
}

impl<'a> SeenTest<'a> {
    /// Creates the test for `model` at θ; `None` if the model does not exist there.
    pub(crate) fn of<M: RodModel>(
        test: &'a RodTest,
        times: &'a [f64],
        model: &M,
        parameters: &[f64],
        cell: f64,
    ) -> Option<Self> {
        let transfer = Transfer::new(model, parameters, test, &test.excitation_samples)?;
        let weighting = Weighting::new(test, transfer, 0.0, test.excitation_samples.clone())?;
        let mut residual = response_of(model, &test.driven_rod(times, cell), parameters)?;
        for (value, measured) in residual.iter_mut().zip(test.response()) {
            *value -= measured;
        }
        weighting.whiten(&mut residual);
        let weighting = weighting.cleaned(test, &residual)?;
        let pairs = test.response().iter().zip(&weighting.correction);
        Some(Self {
            test,
            times,
            target: pairs.map(|(measured, c)| measured - c).collect(),
            weighting,
        })
    }

    /// The rod driven by the most likely excitation.
    pub(crate) fn rod(&self, cell: f64) -> DrivenRod<'_> {
        DrivenRod {
            samples: &self.weighting.excitation,
            excitation: &self.weighting.history,
            ..self.test.driven_rod(self.times, cell)
        }
    }

    /// Number of samples compared.
    pub(crate) fn count(&self) -> usize {
        self.times.len()
    }

    pub(crate) fn target(&self) -> &[f64] {
        &self.target
    }

    /// Whitens values [m/s] to standard deviations in place.
    pub(crate) fn whiten(&self, values: &mut [f64]) {
        self.weighting.whiten(values);
    }
}

/// Standard deviation [m/s] of a residual for the comparison of starts, as if the rod only doubled the excitation.
pub(crate) fn rough_level(test: &RodTest) -> Result<f64, MaxwellidError> {
    let noise = test.noise().ok_or_else(|| MaxwellidError::NoiseUnknown {
        test: test.name().to_owned(),
    })?;
    let (excitation, response) = (&noise.excitation, &noise.response);
    Ok((2.0 * excitation.standard_deviation()).hypot(response.standard_deviation()))
}
