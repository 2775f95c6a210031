//! Detection of parameters for which χ², with weights and excitation re-estimated, does not rise as
//! the standard errors imply.

use super::{Course, Fit, Lowest, value};
use crate::identifiability::{IDENTIFIED_BELOW, Noise};
use crate::identification::{Identification, QUANTILE_95};
use crate::model::RodModel;
use crate::noise::HistoryNoise;
use crate::residual::TestResidual;
use crate::selection::DISTINCT_VELOCITIES;
use crate::test::RodTest;

/// Noise of the excitation relative to the impact velocity above which χ² is also evaluated at
/// distant values of the shape parameters. This is not needed at a noise of 0.01: there the mean
/// square of error over standard error of 200 fits is at most 1.3, so that none of the minima is
/// off by many standard errors.
const NOISY: f64 = 0.015;

/// Changes of a shape parameter, in units of its step limit, after which χ² is evaluated again.
const RIVALS: [f64; 4] = [4.0, 2.0, -2.0, -4.0];

/// Rise of χ² beyond which a value of a shape parameter is excluded: five standard errors.
const OUT_OF_QUESTION: f64 = 25.0;

impl<M: RodModel> Fit<M> {
    /// Returns one flag per parameter of a nonlinear law. A flag is set if χ² at the ends of the
    /// interval of the parameter, with weights and excitation re-estimated at each end, does not
    /// rise as the standard error implies: with one impact velocity a change of the excitation may
    /// compensate a wrong exponent. Parameters that are not identified are not tested. With much
    /// noise, the excitation fitted to a wrong exponent can cause a minimum with errors that are
    /// far too small. Above [`NOISY`], χ² must therefore also rise at the shape parameters changed
    /// by [`RIVALS`], by at least a quarter of the rise that the error implies.
    pub(super) fn bent(
        &self,
        lowest: &Lowest<'_, M>,
        identification: &Identification<M>,
    ) -> Vec<bool> {
        let Lowest {
            problem, minimum, ..
        } = lowest;
        let mut bent = vec![false; problem.of_model()];
        if problem.weightings.is_empty()
            || self.model.is_linear()
            || have_distinct_velocities(problem.tests)
        {
            return bent;
        }
        let Some(judged) = identification.identifiability(Noise::Stated) else {
            return bent;
        };
        let least = value(minimum);
        let rise_at = |index: usize, change: f64| {
            // the other parameters start at the minimum: if they started at their optimum for the
            // changed one, the excitation might not be re-estimated
            let mut start = minimum.parameters.clone();
            if let Some(own) = start.get_mut(index) {
                *own += change;
            }
            let mut there = TestResidual::new(problem.tests, &self.model, problem.cell);
            there.nuisances = self.nuisances;
            there.weightings.clone_from(&problem.weightings);
            there.common = problem.common.clone();
            let held = self.weighted(there, &start, Some(index), &mut Course::default());
            held.map_or(f64::INFINITY, |(_, held)| value(&held) - least)
        };
        let errors = judged.coordinate_errors.iter().zip(&mut bent);
        for (index, (error, bent)) in errors.enumerate().skip(1) {
            if *error < IDENTIFIED_BELOW {
                *bent = [-1.0, 1.0].into_iter().any(|sign| {
                    identification.is_bent_by(rise_at(index, sign * QUANTILE_95 * error))
                });
            }
        }
        let is_noisy = problem.tests.iter().any(|test| {
            let noise = test.noise.as_ref().map(|noise| &noise.excitation);
            let deviation = noise.map_or(0.0, HistoryNoise::standard_deviation);
            deviation > NOISY * test.impact_velocity
        });
        let mut left = judged.coordinate_errors.iter().zip(&bent).skip(1);
        if is_noisy && left.any(|(error, bent)| *error < IDENTIFIED_BELOW && !bent) {
            let shapes = 1..self.model.damping_parameter().unwrap_or(1);
            let limits = self.model.step_limits();
            let bounds = self.model.bounds();
            let errors = &judged.coordinate_errors;
            let each = limits.iter().zip(&bounds).zip(errors).skip(1);
            let has_rival = shapes
                .zip(each)
                .any(|(index, ((limit, (low, high)), error))| {
                    let at = minimum.parameters.get(index).copied().unwrap_or(f64::NAN);
                    RIVALS.iter().map(|steps| steps * limit).any(|change| {
                        let promised = (change / error).powi(2);
                        let enough = (0.25 * promised).min(OUT_OF_QUESTION);
                        let is_inside = (*low..=*high).contains(&(at + change));
                        is_inside
                            && rise_at(index, change)
                                < enough * identification.error_factor().powi(2)
                    })
                });
            if has_rival {
                bent.iter_mut().skip(1).for_each(|bent| *bent = true);
            }
        }
        bent
    }
}

/// Returns true if the ratio of the highest to the lowest impact velocity is at least
/// [`DISTINCT_VELOCITIES`].
fn have_distinct_velocities(tests: &[RodTest]) -> bool {
    let velocities = tests.iter().map(|test| test.impact_velocity);
    let (slowest, fastest) = velocities.fold((f64::INFINITY, 0.0), |(low, high), v| {
        (f64::min(low, v), f64::max(high, v))
    });
    fastest >= DISTINCT_VELOCITIES * slowest
}
