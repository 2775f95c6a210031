//! Error of a force by random draws of its inputs.

use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::StickUncertainty;
use crate::error::{check_enough, check_length, check_probability};
use crate::force_error::{Moments, check_draws, quantile};
use crate::{ContactEnd, Coverage, ForceBand, ImpulseError, StickProblem, ZeroLine, separate};

/// Fewest draws for a standard deviation.
const FEWEST_DRAWS: usize = 50;

/// Forces of drawn mobilities, velocities and masses.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MonteCarlo {
    /// Mean of the stick forces \[N\]; `(n_samples)`.
    pub stick_mean: Vec<f64>,
    /// Standard deviation of the stick forces \[N\]; `(n_samples)`.
    pub stick_deviation: Vec<f64>,
    /// Impact forces, until separation \[N\]; `(n_draws, n_samples)`.
    pub impact_forces: Vec<Vec<f64>>,
    /// Ends of the contacts that end \[s\], in increasing order.
    pub contact_ends: Vec<f64>,
    /// Time between samples \[s\].
    pub time_step: f64,
    /// Number of draws that are still in contact at the end of the history, or without contact.
    pub without_end: usize,
}

impl StickUncertainty<'_> {
    /// Solves `problem` for `n_draws` Gaussian draws of its inputs; those of the mobilities are
    /// circular and independent between lines. [`separate`] finds the end of each contact with
    /// `threshold` \[N\].
    ///
    /// # Errors
    ///
    /// The errors of [`StickProblem::error`] and [`separate`]; [`ImpulseError::TooShort`] for fewer
    /// than 50 draws; [`ImpulseError::NonPhysical`] for a velocity or mass so uncertain that a draw
    /// is not above zero.
    pub fn monte_carlo(
        &self,
        problem: &StickProblem<'_>,
        threshold: f64,
        n_draws: usize,
        random: &mut impl Rng,
    ) -> Result<MonteCarlo, ImpulseError> {
        problem.force_lines()?;
        self.check(problem)?;
        check_enough("set of draws", n_draws, FEWEST_DRAWS)?;
        let (n_period, n_shown) = problem.n_samples();
        check_draws(n_draws, n_shown)?;
        let mut stick = Moments::of(n_shown);
        let mut result = MonteCarlo {
            stick_mean: Vec::new(),
            stick_deviation: Vec::new(),
            impact_forces: Vec::with_capacity(n_draws),
            contact_ends: Vec::new(),
            time_step: 1.0 / (n_period as f64 * problem.frequency_step_hz),
            without_end: 0,
        };
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        for _ in 0..n_draws {
            let first = drawn(
                problem.first,
                self.first_variance,
                (self.first_scale, self.first_delay * problem.omega(1)),
                &mut normal,
            );
            let second = drawn(
                problem.second,
                self.second_variance,
                (self.second_scale, self.second_delay * problem.omega(1)),
                &mut normal,
            );
            let zero_line = match problem.zero_line {
                ZeroLine::EffectiveMass(mass) => {
                    ZeroLine::EffectiveMass(mass + self.effective_mass * normal())
                }
                other => other,
            };
            let draw = StickProblem {
                first: &first,
                second: &second,
                impact_velocity: problem.impact_velocity + self.impact_velocity * normal(),
                zero_line,
                ..*problem
            };
            let history = draw.solve()?.history;
            stick.add(history.force());
            let impact = separate(&history, threshold)?;
            match impact.end {
                ContactEnd::Separated { time } => result.contact_ends.push(time),
                ContactEnd::InContact | ContactEnd::NoContact => result.without_end += 1,
            }
            result.impact_forces.push(impact.history.force().to_vec());
        }
        result.stick_deviation = stick.deviations();
        result.stick_mean = stick.mean;
        result.contact_ends.sort_by(f64::total_cmp);
        Ok(result)
    }
}

impl MonteCarlo {
    /// Returns the pointwise band of the impact force: the central fraction `level` of the draws at
    /// each time. The factor is NaN, as no standard error is used.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1;
    /// [`ImpulseError::LengthMismatch`] if the lists of this result have been changed to
    /// different lengths.
    pub fn contact_band(&self, level: f64) -> Result<ForceBand, ImpulseError> {
        check_probability("level of a band", level)?;
        let n_samples = self.stick_mean.len();
        for force in &self.impact_forces {
            check_length("impact force of a draw", force.len(), n_samples)?;
        }
        let mut band = ForceBand {
            coverage: Coverage::Pointwise,
            level,
            factor: f64::NAN,
            lower: Vec::with_capacity(n_samples),
            upper: Vec::with_capacity(n_samples),
        };
        for sample in 0..n_samples {
            let at_this_time = self.impact_forces.iter().filter_map(|f| f.get(sample));
            let mut values: Vec<f64> = at_this_time.copied().collect();
            values.sort_by(f64::total_cmp);
            band.lower.push(quantile(&values, 0.5 - 0.5 * level));
            band.upper.push(quantile(&values, 0.5 + 0.5 * level));
        }
        Ok(band)
    }

    /// Returns the standard deviation of the impulse of the contact \[N s\]; `None` if there is a
    /// draw whose contact does not end.
    #[must_use]
    pub fn impulse_deviation(&self) -> Option<f64> {
        let impulses = self.impact_forces.iter();
        let impulses = impulses.map(|force| self.time_step * force.iter().sum::<f64>());
        let impulses: Vec<f64> = impulses.collect();
        let count = impulses.len() as f64;
        let mean = impulses.iter().sum::<f64>() / count;
        let square: f64 = impulses.iter().map(|j| (j - mean).powi(2)).sum();
        (self.without_end == 0 && count > 1.0).then(|| (square / (count - 1.0)).sqrt())
    }

    /// Returns the limits of the central fraction `level` of the ends of the contact \[s\], without
    /// the draws whose contact does not end; `None` if there is no end.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn contact_end_limits(&self, level: f64) -> Result<Option<[f64; 2]>, ImpulseError> {
        check_probability("level of an interval", level)?;
        let limits = [0.5 - 0.5 * level, 0.5 + 0.5 * level];
        let limits = limits.map(|part| quantile(&self.contact_ends, part));
        Ok((!self.contact_ends.is_empty()).then_some(limits))
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "`StickUncertainty::check` has found a variance for each line of the mobility"
)]
fn drawn(
    mobility: &[Complex64],
    variance: Option<&[f64]>,
    (scale, phase_per_line): (f64, f64),
    normal: &mut impl FnMut() -> f64,
) -> Vec<Complex64> {
    let scale = 1.0 + scale * normal();
    let phase = if phase_per_line > 0.0 {
        phase_per_line * normal()
    } else {
        0.0
    };
    let last = mobility.len() - 1;
    let lines = mobility.iter().enumerate();
    lines
        .map(|(line, g)| {
            let factor = scale * Complex64::from_polar(1.0, -phase * line as f64);
            let Some(variance) = variance.filter(|_| line > 0) else {
                return g * factor;
            };
            let error = if line == last {
                // only the real part of the force matters on this line
                Complex64::new(normal(), normal())
            } else {
                Complex64::new(normal(), normal()) * 0.5_f64.sqrt()
            };
            (g + error * variance[line].sqrt()) * factor
        })
        .collect()
}
