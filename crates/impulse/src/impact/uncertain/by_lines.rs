//! Error of an impact due to the unknown lines of measured bodies.
//!
//! Theory: `docs/theory/force-uncertainty.md#continuation-above-the-measured-lines`.

use super::{ImpactDraws, ImpactNumbers, Run, UncertainImpact, resampled, run};
use crate::impact::discrete::{DiscreteImpact, Less};
use crate::{BandLimit, ForceHistory, ImpulseError, PredictionFlag};

/// Half width of a rectangular distribution, divided by its standard deviation.
const EQUALLY: f64 = 1.732_050_807_568_877_2;

/// Half width of the 95 % interval of a normal distribution, divided by its standard deviation.
const TWO_SIDED: f64 = 1.96;

impl<D: ImpactDraws> UncertainImpact<'_, D> {
    /// Returns the errors of the force in the band, at its times, and of the [`ImpactNumbers`].
    /// They combine the changes of the prediction in two or three cases: without the echoes above
    /// the lines; with the upper third of the lines replaced by a continuation of the others; and,
    /// if a body still rings after half of the period of its lines (the inverse of their spacing),
    /// with only every second line. `None` if no body is measured.
    ///
    /// If half of that period is shorter than two histories or is not a whole number of steps,
    /// ringing does not enter the errors and is only flagged.
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
        let can_halve = lines.all(|(step_hz, _)| {
            let steps = 0.5 / (step_hz * history.time_step());
            4.0 * duration * step_hz <= 1.0 && (steps - steps.round()).abs() < 1e-6
        });
        let mut flags = stated.prediction.flags.iter();
        let rings = flags.any(|flag| matches!(flag, PredictionFlag::Rings { .. }));
        let mut left_out = vec![Less::Echoes, Less::UpperLines];
        if rings && can_halve {
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

    /// Returns the standard error of the force in the band \[N\] from its difference from `other`.
    /// Since the difference oscillates, the error is its root mean square over a period of the last
    /// line.
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
                (Some(before), Some(all)) => ((all - before) / (to - from) as f64).sqrt(),
                _ => 0.0,
            }
        });
        each.collect()
    }
}

/// Returns the errors of the numbers from their changes. The peak in the band has a uniform
/// distribution of half width equal to its change. For the other numbers, whose changes may be
/// small by chance, the change is the standard error. The errors of the peak in the band and of the
/// end of the contact are at least those that the error of the `force` causes there. The lines
/// hardly determine the peak without a band limit; its 95 % interval includes the peak in the band.
fn numbers_of(stated: &Run, other: &Run, force: &[f64]) -> ImpactNumbers {
    let numbers = stated.numbers();
    let mut changes = numbers.with(&other.numbers(), |a, b| (a - b).abs());
    let limited = &stated.limited;
    let at = |time: f64| Some(force.get(limited.index_near(time)?)? / EQUALLY);
    let of_peak = at(limited.smooth_peak().time);
    let of_end = numbers.end.and_then(|end| {
        let slope = limited.slope_near(end)?;
        Some(at(end)? / slope.abs())
    });
    let above = numbers.peak.zip(numbers.limited_peak);
    let of_unlimited = above.map(|(peak, limited)| (peak - limited).abs() / TWO_SIDED);
    changes.limited_peak = changes.limited_peak.map(|change| change / EQUALLY);
    let least = [
        (&mut changes.limited_peak, of_peak),
        (&mut changes.end, of_end),
        (&mut changes.peak, of_unlimited),
    ];
    for (change, least) in least {
        *change = change.map(|change| change.max(least.unwrap_or(0.0)));
    }
    changes
}
