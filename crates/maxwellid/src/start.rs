//! Starts of a fit, and the escape from a minimum whose arrival is off by half a period.

use crate::error::MaxwellidError;
use crate::least_squares::{Minimum, Termination, sum_of_squares};
use crate::model::{RodModel, delayed, response_of};
use crate::parallel::map_in_order;
use crate::residual::TestResidual;
use crate::test::RodTest;

/// One of several starts and its result, on the grid of the scan and with equal weights of all
/// samples.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StartOutcome {
    /// θ at the start.
    pub start: Vec<f64>,
    /// θ at the end.
    pub parameters: Vec<f64>,
    /// Root mean square of the residual over V0 at the end.
    pub relative_error: f64,
    /// Reason for the end of the iteration.
    pub termination: Termination,
}

/// Half the range of ln E over which starts are spread: 30 % in E are 15 % in the time of flight.
const MODULUS_SPREAD: f64 = 0.3;

/// Half the range of the other parameters, in step limits.
const SPREAD: f64 = 2.0;

/// Returns `count` starts around the candidates of the model, spread by an additive recurrence with
/// the powers of the generalised golden ratio (Roberts, 2018). The starts are not random, and a
/// larger `count` begins with the same starts.
#[allow(
    clippy::indexing_slicing,
    reason = "there is a candidate, and the index is a remainder of a division by their number"
)]
pub(crate) fn spread<M: RodModel>(
    model: &M,
    candidates: &[Vec<f64>],
    count: usize,
) -> Vec<Vec<f64>> {
    let limits = model.step_limits();
    let bounds = model.bounds();
    // the root of x^(d+1) = x + 1
    let exponent = 1.0 / (limits.len() as f64 + 1.0);
    let ratio = (0..60).fold(1.5_f64, |x, _| (x + 1.0).powf(exponent));
    (0..count)
        .map(|index| {
            let from = &candidates[index % candidates.len()];
            let round = (index / candidates.len()) as f64 + 1.0;
            from.iter()
                .zip(&limits)
                .zip(&bounds)
                .enumerate()
                .map(|(k, ((t, limit), (low, high)))| {
                    let half = if k == 0 {
                        MODULUS_SPREAD
                    } else {
                        SPREAD * limit
                    };
                    let share = (0.5 + round * ratio.powf(-(k as f64 + 1.0))).fract();
                    (t + half * (2.0 * share - 1.0)).clamp(*low, *high)
                })
                .collect()
        })
        .collect()
}

/// The best-fitting of `candidates` without iteration; `None` if the model exists at none of them.
pub(crate) fn best_candidate<M: RodModel>(
    problem: &TestResidual<'_, M>,
    candidates: &[Vec<f64>],
) -> Option<Vec<f64>> {
    use crate::least_squares::LeastSquares;
    let values = map_in_order(candidates, |candidate| {
        problem.residual(candidate).map(|r| sum_of_squares(&r))
    });
    values
        .into_iter()
        .zip(candidates)
        .filter_map(|(value, candidate)| Some((value?, candidate)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.clone())
}

/// Minima from all `starts`, in their order; `None` for a start at which the model does not exist.
pub(crate) fn minima<F>(
    starts: &[Vec<f64>],
    minimise: F,
) -> Result<Vec<Option<Minimum>>, MaxwellidError>
where
    F: Fn(&[f64]) -> Result<Option<Minimum>, MaxwellidError> + Sync,
{
    map_in_order(starts, |start| minimise(start))
        .into_iter()
        .collect()
}

/// Smallest lag of the arrival, in samples, at which the minimum is regarded as a wrong one.
const SMALLEST_LAG: usize = 2;

/// Amount by which the correlation at a lag must exceed the correlation without lag.
const BETTER: f64 = 0.1;

/// Returns the test and the delay \[s\], in addition to the delay of the fit, at which simulated
/// and measured response correlate best; `None` if no delay improves the correlation by more than
/// sampling and noise can.
///
/// The correlation is that of the differences of neighbouring samples, in which fronts dominate.
pub(crate) fn arrival_lag<'a, M: RodModel>(
    problem: &TestResidual<'a, M>,
    parameters: &[f64],
) -> Option<(&'a RodTest, f64)> {
    let mut best: Option<(f64, &RodTest, f64)> = None;
    for (index, (test, times)) in problem.tests.iter().zip(&problem.times).enumerate() {
        let of_model = parameters.get(..problem.of_model())?;
        let times = delayed(times, problem.delay(index, parameters));
        let rod = test.driven_rod(&times, problem.cell);
        let simulated = response_of(problem.model, &rod, of_model)?;
        let differences = |history: &[f64]| -> Vec<f64> {
            let pairs = history.iter().zip(history.iter().skip(1));
            pairs.map(|(before, after)| after - before).collect()
        };
        let (simulated, measured) = (differences(&simulated), differences(test.response()));
        let norm = (sum_of_squares(&simulated) * sum_of_squares(&measured)).sqrt();
        if norm <= 0.0 {
            continue;
        }
        let correlation = |late: usize, early: usize| -> f64 {
            let pairs = simulated.iter().skip(early).zip(measured.iter().skip(late));
            pairs.map(|(s, m)| s * m).sum::<f64>() / norm
        };
        let in_phase = correlation(0, 0);
        let half = measured.len() / 2;
        let lags = (SMALLEST_LAG..half).flat_map(|lag| [(lag, 0), (0, lag)]);
        for (late, early) in lags {
            let value = correlation(late, early);
            if value > in_phase + BETTER && best.is_none_or(|(top, _, _)| value > top) {
                let lag = (late as f64 - early as f64) / test.sampling_rate_hz;
                best = Some((value, test, lag));
            }
        }
    }
    best.map(|(_, test, lag)| (test, lag))
}

/// Young's modulus \[Pa\] at which the front of `test` arrives `lag` \[s\] later than with
/// `modulus`; `None` if the front would arrive in less than a tenth of its time of flight.
pub(crate) fn modulus_after_lag(test: &RodTest, modulus: f64, lag: f64) -> Option<f64> {
    let transit = test.length * (test.density / modulus).sqrt();
    let corrected = transit + lag;
    (corrected > 0.1 * transit).then(|| test.density * (test.length / corrected).powi(2))
}
