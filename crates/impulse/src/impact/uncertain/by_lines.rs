//! Error of an impact by the lines of measured bodies that are not known.
//!
//! Theory: `docs/theory/force-uncertainty.md#above-the-lines`.

use super::{ImpactDraws, ImpactNumbers, Run, UncertainImpact, resampled, run};
use crate::impact::discrete::{DiscreteImpact, Less};
use crate::{BandLimit, ForceHistory, ImpulseError, PredictionFlag};

impl<D: ImpactDraws> UncertainImpact<'_, D> {
    /// Errors of the force in the band, at its times, and of the numbers: the changes without the
    /// echoes above the lines, with the upper third of the lines taken from the others, and, where a
    /// body rings for longer than half of its period, with every second line. `None` if no body is
    /// measured.
    ///
    /// A period of the lines that is shorter than four histories has no half that holds one: its
    /// ringing is flagged only.
    pub(super) fn errors_by_lines(
        &self,
        discrete: &DiscreteImpact,
        stated: &Run,
        band: BandLimit,
    ) -> Result<Option<(Vec<f64>, ImpactNumbers)>, ImpulseError> {
        let bodies = [self.impact.first, self.impact.second];
        let history = &stated.prediction.history;
        let duration = history.time_step() * history.force().len() as f64;
        let mut lines = self.impact.lines();
        let holds_half = lines.all(|(step_hz, _)| 4.0 * duration * step_hz <= 1.0);
        let mut flags = stated.prediction.flags.iter();
        let rings = flags.any(|flag| matches!(flag, PredictionFlag::Rings { .. }));
        let mut left_out = vec![Less::Echoes, Less::UpperLines];
        if rings && holds_half {
            left_out.push(Less::EverySecondLine);
        }
        let mut errors: Option<(Vec<f64>, ImpactNumbers)> = None;
        for less in left_out {
            let Some(other) = discrete.with_less(bodies, less)? else {
                return Ok(None);
            };
            let other = run(&other, band)?;
            let force = self.change_over_a_period(&stated.limited, &other.limited);
            let numbers = numbers_of(stated, &other, &force);
            errors = Some(match errors {
                None => (force, numbers),
                Some((all, all_numbers)) => {
                    let both = all.iter().zip(&force).map(|(a, b)| a.hypot(*b)).collect();
                    (both, all_numbers.with(&numbers, f64::hypot))
                }
            });
        }
        Ok(errors)
    }

    /// Error of the force in the band by its change to `other` \[N\], which rings, as the root mean
    /// square over a period of the last line. The force is between the two or as far on the other
    /// side, with equal probability.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive count, which saturates"
    )]
    fn change_over_a_period(&self, stated: &ForceHistory, other: &ForceHistory) -> Vec<f64> {
        let at_times = resampled(other, other.force(), stated);
        let pairs = stated.force().iter().zip(at_times);
        let mut sums = vec![0.0];
        for (a, b) in pairs {
            let sum = sums.last().copied().unwrap_or(0.0);
            sums.push(sum + (a - b) * (a - b));
        }
        let reach = 0.5 / self.impact.highest_measured_hz();
        let reach = (reach / stated.time_step()).round() as usize;
        let last = sums.len() - 1;
        let each = (0..last).map(|n| {
            let (from, to) = (
                n.saturating_sub(reach),
                (n + 1).saturating_add(reach).min(last),
            );
            match (sums.get(from), sums.get(to)) {
                (Some(before), Some(all)) => ((all - before) / (3.0 * (to - from) as f64)).sqrt(),
                _ => 0.0,
            }
        });
        each.collect()
    }
}

/// Errors of the numbers by their changes, which may be small by accident: the peak and the end of
/// the contact have no less than the error of the `force` there.
fn numbers_of(stated: &Run, other: &Run, force: &[f64]) -> ImpactNumbers {
    let numbers = stated.numbers();
    let mut changes = numbers.with(&other.numbers(), |a, b| (a - b).abs());
    let limited = &stated.limited;
    let at = |time: f64| force.get(limited.index_near(time)?).copied();
    let of_peak = at(limited.smooth_peak().time).unwrap_or(0.0);
    changes.limited_peak = changes
        .limited_peak
        .map(|change| (change / 3.0_f64.sqrt()).max(of_peak));
    let of_end = numbers.end.and_then(|end| {
        let slope = limited.slope_near(end)?;
        Some(at(end)? / slope.abs())
    });
    changes.end = changes.end.map(|change| change.max(of_end.unwrap_or(0.0)));
    changes
}
