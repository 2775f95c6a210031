//! Time levels of a march.

use crate::band_limited::{SamplePulses, VelocityHistory, check_times};
use crate::error::{RodwaveError, check_steps};
use crate::interpolation::Quintic;

/// Equidistant times of a march, starting when its excitation first moves.
///
/// The first level does not depend on the length of a step. A front therefore enters the grid at
/// the same fraction of a step for any modulus. After a jump, the error of a march is of first
/// order in the step and changes with that fraction: with levels counted from time 0, the misfit of
/// a sharp impact oscillates with E by one unit of χ², with a period of one step in the latest
/// arrival.
#[derive(Debug, Clone, Copy)]
pub(super) struct TimeLevels {
    begin: f64,
    step: f64,
    /// Number of steps that the interpolation at the last time of the response needs.
    pub(super) steps: usize,
}

impl TimeLevels {
    /// Checks `times` \[s\] of a response to `excitation` and returns the levels, `step` \[s\]
    /// apart.
    pub(super) fn of(
        excitation: &dyn VelocityHistory,
        times: &[f64],
        step: f64,
    ) -> Result<Self, RodwaveError> {
        Self::from(excitation.begin(), excitation, times, step)
    }

    /// Returns levels as [`Self::of`] does, with the first one not later than the start of any of
    /// `pulses`.
    pub(super) fn of_pulses(
        excitation: &dyn VelocityHistory,
        pulses: &SamplePulses,
        times: &[f64],
        step: f64,
    ) -> Result<Self, RodwaveError> {
        let begins = (0..pulses.len()).map(|place| pulses.begin(place));
        let begin = begins.fold(excitation.begin(), f64::min).max(0.0);
        Self::from(begin, excitation, times, step)
    }

    fn from(
        begin: f64,
        excitation: &dyn VelocityHistory,
        times: &[f64],
        step: f64,
    ) -> Result<Self, RodwaveError> {
        let last = check_times(times, excitation)?;
        let steps = check_steps(((last - begin).max(0.0) / step).floor())? + 3;
        Ok(Self { begin, step, steps })
    }

    /// Time \[s\] of level `n`.
    pub(super) fn time(&self, n: usize) -> f64 {
        self.begin + n as f64 * self.step
    }

    /// Time \[s\] since the first level.
    pub(super) fn since_begin(&self, time: f64) -> f64 {
        time - self.begin
    }

    /// Number of the last level before `time` \[s\], limited to the existing levels.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of steps, not below 0"
    )]
    pub(super) fn before(&self, time: f64) -> usize {
        let steps = (self.since_begin(time) / self.step).floor().max(0.0);
        (steps as usize).min(self.steps)
    }

    /// Interpolations of histories at the levels, one for each of `times` \[s\].
    pub(super) fn interpolations(&self, times: &[f64]) -> Vec<Quintic> {
        let around = |time: &f64| Quintic::around(self.since_begin(*time) / self.step);
        times.iter().map(around).collect()
    }
}
