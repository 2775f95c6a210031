//! The covariance of the residual that all candidates share.

use faer::{Mat, Side};
use faer::linalg::solvers::Llt;
use rodwave::band_limited::SampledHistory;

use crate::error::MaxwellidError;
use crate::model::{DrivenRod, RodModel};
use crate::test::RodTest;

/// Standard deviations of the noise of both histories, white from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevels {
    /// Of the excitation, as a share of V0.
    pub excitation: f64,
    /// Of the response, as a share of V0.
    pub response: f64,
    /// Number of samples from which the levels were estimated, if they were: the common factor of both is then uncertain, and is
    /// averaged over. `None` for levels that are known.
    pub degrees_of_freedom: Option<f64>,
}

impl NoiseLevels {
    /// Known levels, as shares of V0.
    #[must_use]
    pub fn known(excitation: f64, response: f64) -> Self {
        Self {
            excitation,
            response,
            degrees_of_freedom: None,
        }
    }

    /// Levels estimated from so many samples of rest; 0 if nothing but their ratio is known.
    #[must_use]
    pub fn estimated(excitation: f64, response: f64, samples: f64) -> Self {
        Self {
            excitation,
            response,
            degrees_of_freedom: Some(samples),
        }
    }

    pub(crate) fn check(&self) -> Result<(), MaxwellidError> {
        for (setting, value, least) in [
            ("noise of the excitation over V0", self.excitation, 0.0),
            ("noise of the response over V0", self.response, f64::MIN_POSITIVE),
            (
                "degrees of freedom of the noise level",
                self.degrees_of_freedom.unwrap_or(0.0),
                0.0,
            ),
        ] {
            if !(value.is_finite() && value >= least) {
                return Err(MaxwellidError::Setting {
                    setting,
                    value,
                    expected: "a finite value, not negative, and above 0 for the response",
                });
            }
        }
        Ok(())
    }
}

/// The covariance of simulated minus measured response, over V0², by its Cholesky factor for each test.
///
/// ```text
/// C = σ_r² I + σ_e² H Hᵀ
/// ```
///
/// H is the response to single samples of the excitation of a *linear* rod that explains the data best. It is the same for all
/// candidates: a candidate with a covariance of its own would win or lose by determinants. For a nonlinear rod H is that of a
/// linear rod of nearly the same response; the noise, some per cent of V0, sees the rod at rest before the wave and the loaded
/// rod behind it, which differ in damping, not in travel.
#[derive(Debug, Clone)]
pub(crate) struct CommonCovariance {
    /// Rows of the lower triangle of L, C = L Lᵀ, for each test.
    factors: Vec<Vec<Vec<f64>>>,
}

impl CommonCovariance {
    /// No excitation noise.
    pub(crate) fn white(tests: &[RodTest], noise: NoiseLevels) -> Self {
        let level = noise.excitation.hypot(noise.response);
        Self {
            factors: tests
                .iter()
                .map(|test| {
                    (0..test.times().len())
                        .map(|i| {
                            let mut row = vec![0.0; i + 1];
                            row[i] = level;
                            row
                        })
                        .collect()
                })
                .collect(),
        }
    }

    /// With the noise of the excitation propagated by `reference` at θ; `None` where that does not exist.
    pub(crate) fn propagated(
        tests: &[RodTest],
        noise: NoiseLevels,
        reference: &dyn RodModel,
        parameters: &[f64],
        cell: f64,
    ) -> Option<Self> {
        let factors = tests
            .iter()
            .map(|test| {
                let wanted = test.times().len();
                let kernel = sample_response(test, reference, parameters, cell)?;
                let covariance = Mat::from_fn(wanted, wanted, |i, j| {
                    // Σ over excitation samples m of H_im H_jm; H_im = kernel[i - m + LEAD]
                    let shared = i.min(j);
                    let apart = i.max(j) - shared;
                    let sum: f64 = (0..=shared + LEAD)
                        .map(|k| kernel[k] * kernel.get(k + apart).copied().unwrap_or(0.0))
                        .sum();
                    let white = if i == j { noise.response * noise.response } else { 0.0 };
                    white + noise.excitation * noise.excitation * sum
                });
                let factor = Llt::new(covariance.as_ref(), Side::Lower).ok()?;
                let lower = factor.L();
                Some(
                    (0..wanted)
                        .map(|i| (0..=i).map(|j| lower[(i, j)]).collect())
                        .collect(),
                )
            })
            .collect::<Option<_>>()?;
        Some(Self { factors })
    }

    /// L⁻¹ r of all tests, in place; `scales` multiplies the values of each test before.
    pub(crate) fn whiten(&self, residual: &mut [f64]) {
        let mut rest = residual;
        for factor in &self.factors {
            let (of_test, others) = rest.split_at_mut(factor.len().min(rest.len()));
            rest = others;
            for (i, row) in factor.iter().enumerate() {
                let (before, here) = of_test.split_at_mut(i);
                let (own, left) = match row.split_last() {
                    Some((own, left)) => (*own, left),
                    None => continue,
                };
                let known: f64 = left.iter().zip(before.iter()).map(|(l, r)| l * r).sum();
                here[0] = (here[0] - known) / own;
            }
        }
    }
}

/// Samples of the excitation before the one that is 1: the interpolation between samples reaches so far ahead.
const LEAD: usize = SampledHistory::HALF_WIDTH;

/// The response to an excitation whose sample `LEAD` is 1 and all others 0.
fn sample_response(
    test: &RodTest,
    reference: &dyn RodModel,
    parameters: &[f64],
    cell: f64,
) -> Option<Vec<f64>> {
    let count = test.times().len() + 2 * LEAD;
    let mut samples = vec![0.0; count];
    samples[LEAD] = 1.0;
    let excitation = SampledHistory::new(&samples, test.sampling_rate_hz).ok()?;
    let times: Vec<f64> = (0..count)
        .map(|k| k as f64 / test.sampling_rate_hz)
        .collect();
    reference.response(
        &DrivenRod {
            length: test.length,
            density: test.density,
            sampling_rate_hz: test.sampling_rate_hz,
            samples: &samples,
            excitation: &excitation,
            times: &times,
            cell,
        },
        parameters,
    )
}
