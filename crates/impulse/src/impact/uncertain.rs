//! Prediction of an impact in a band of frequencies, with a band of uncertainty.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::spread::{Draws, Run, Spread, resampled};
use super::{
    DiscreteImpact, DrawnImpact, FirstForce, Impact, ImpactDraws, ImpactNumbers, ImpactSource,
    Prediction,
};
use crate::error::check_probability;
use crate::parallel::map_in_order;
use crate::{BandLimit, Coverage, Domain, ForceBand, ForceHistory, ImpulseError};

const FEWEST_STEPS: f64 = 4096.0;

/// Number of draws that are computed as one block, whatever the number of threads.
const SIDE_BY_SIDE: usize = 8;

/// Number of draws, in whole blocks, for which each source is also drawn alone: their standard
/// deviations are then known to 10 %.
const OF_PARTS: usize = 48;

/// Relative difference of the peak and of the end of the contacts up to which the step of the draws
/// resolves them. A peak of eight steps may be exact to 2 %, and its change with a draw only to 30
/// %.
const RESOLVED: f64 = 2e-3;

/// An impact with errors; created by [`Impact::with_errors`].
#[derive(Debug, Clone)]
pub struct UncertainImpact<'a, D> {
    impact: Impact<'a>,
    errors: D,
    band: Option<BandLimit>,
}

/// Largest force of an [`UncertainPrediction`], with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PeakForce {
    /// Force \[N\].
    pub force: f64,
    /// Time \[s\].
    pub time: f64,
    /// Standard error of the force \[N\]; without draws, the numerical error alone.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error: the number of draws minus one; infinite without
    /// draws.
    pub degrees_of_freedom: f64,
}

impl PeakForce {
    /// Returns the half width \[N\] of the interval that contains the force with the probability
    /// `level`, by Student's distribution.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn expanded_uncertainty(&self, level: f64) -> Result<f64, ImpulseError> {
        check_probability("level of an interval", level)?;
        let probability = 0.5 + 0.5 * level;
        let factor = if self.degrees_of_freedom.is_finite() {
            StudentsT::new(0.0, 1.0, self.degrees_of_freedom)
                .map_or(f64::NAN, |law| law.inverse_cdf(probability))
        } else {
            Normal::standard().inverse_cdf(probability)
        };
        Ok(factor * self.standard_error)
    }
}

/// Force, contacts and balance of an impact, the force in its band, and the errors of all these;
/// created by [`UncertainImpact::predict`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct UncertainPrediction {
    /// Prediction of the stated impact.
    pub prediction: Prediction,
    /// Start of the force without a band limit.
    pub first_force: FirstForce,
    /// The band.
    pub band: BandLimit,
    /// The force in the band.
    pub limited: ForceHistory,
    /// Numerical error \[N\] of the force in the band, at its times: twice its change with half the
    /// step, combined with its changes when parts of the lines of measured bodies are left out
    /// (root mean square over a period of the last line).
    pub numerical: Vec<f64>,
    /// Numerical errors of the scalar results; the error of the time at which the contact ends is
    /// at least the error due to the finite time step.
    pub numerical_numbers: ImpactNumbers,
    /// Standard deviations over the draws; `None` without draws.
    pub spread: Option<Spread>,
}

impl<'a> Impact<'a> {
    /// Sets the errors of bodies, contact and velocity: an [`ImpactErrors`](super::ImpactErrors) or
    /// any other source of draws. The prediction then has a band of uncertainty.
    #[must_use]
    pub fn with_errors<D: ImpactDraws>(self, errors: D) -> UncertainImpact<'a, D> {
        UncertainImpact {
            impact: self,
            errors,
            band: None,
        }
    }

    /// Upper end of the lines of the measured bodies \[Hz\], the lower one if both bodies are
    /// measured; infinite if both bodies are computed.
    fn highest_measured_hz(&self) -> f64 {
        self.lines()
            .map(|(frequency_step_hz, n_lines)| frequency_step_hz * (n_lines as f64 - 1.0))
            .fold(f64::INFINITY, f64::min)
    }

    /// Line spacing \[Hz\] and number of lines of the measured bodies.
    pub(super) fn lines(&self) -> impl Iterator<Item = (f64, usize)> {
        let domains = [self.first.domain(), self.second.domain()];
        domains.into_iter().filter_map(|domain| match domain {
            Domain::Lines {
                frequency_step_hz,
                n_lines,
            } => Some((frequency_step_hz, n_lines)),
            _ => None,
        })
    }
}

impl<D: ImpactDraws> UncertainImpact<'_, D> {
    /// Sets the band of the force. The default reaches up to 10 kHz as in paper E or, if that is
    /// lower, to half of the highest frequency of a measured body; the band is 12 dB down at that
    /// highest frequency.
    #[must_use]
    pub fn in_band(self, band: BandLimit) -> Self {
        Self {
            band: Some(band),
            ..self
        }
    }

    /// Computes the impact for `duration` \[s\] as [`Impact::predict`] does, the force in the band,
    /// and their errors. The errors come from a second march with half the step, from two or three
    /// marches with parts of the lines left out if a body is measured, and from one march per draw,
    /// with a step that resolves the band, the pulse and the contacts. The draws do not depend on
    /// the number of threads.
    ///
    /// The default step is that of [`BandLimit::time_step`] or a 4096th of the duration, whichever
    /// is shorter.
    ///
    /// # Errors
    ///
    /// The errors of [`Impact::predict`], [`Prediction::band_limited`] and the draws;
    /// [`ImpulseError::NonPhysical`] for a band beyond the lines of a measured body.
    pub fn predict(mut self, duration: f64) -> Result<UncertainPrediction, D::Error> {
        let band = self.checked_band()?;
        let resolved = band.time_step();
        let step = match self.impact.time_step {
            Some(step) => step,
            None => self.filling_the_period(resolved.min(duration / FEWEST_STEPS)),
        };
        let discrete = self.discretised(step, duration)?;
        let run = run(&discrete, band)?;
        self.errors.check_cancelled()?;
        // ringing of a body that is known only on the frequency axis must decay within a period
        // that depends on the duration
        let bodies = [self.impact.first, self.impact.second];
        let longer = bodies.iter().any(|b| b.domain() == Domain::FrequencyAxis);
        let check_for = if longer { 2.0 } else { 1.0 } * duration;
        let check = self::run(&self.discretised(0.5 * step, check_for)?, band)?;
        self.errors.check_cancelled()?;
        // the error left by the finer step equals the difference for a method of first order, and
        // is a third of it for second order
        let twice = |a: f64, b: f64| 2.0 * (a - b).abs();
        let at_times = resampled(&check.limited, check.limited.force(), &run.limited);
        let pairs = run.limited.force().iter().zip(at_times);
        let mut numerical: Vec<f64> = pairs.map(|(a, b)| twice(*a, b)).collect();
        let mut numerical_numbers = run.numbers().with(&check.numbers(), twice);
        if let Some((by_lines, numbers)) = self.errors_by_lines(&discrete, &run, band)? {
            numerical_numbers = numerical_numbers.with(&numbers, f64::hypot);
            for (error, by_lines) in numerical.iter_mut().zip(&by_lines) {
                *error = error.hypot(*by_lines);
            }
        }
        // steps may be in phase with the waves, so that the end is the same with half the step
        let within_a_step = step / 12.0_f64.sqrt();
        let end = numerical_numbers.end;
        numerical_numbers.end = end.map(|error| error.max(within_a_step));
        let spread = self.spread((step, &run), duration, band)?;
        let spread = spread.map(|(spread, stated)| {
            spread.at_times(&stated, &run.limited, &run.prediction.history)
        });
        Ok(UncertainPrediction {
            prediction: run.prediction,
            first_force: run.first_force,
            band,
            limited: run.limited,
            numerical,
            numerical_numbers,
            spread,
        })
    }

    fn checked_band(&self) -> Result<BandLimit, ImpulseError> {
        let highest_hz = self.impact.highest_measured_hz();
        let band = match self.band {
            Some(band) => band,
            None => BandLimit::by_default(highest_hz)?,
        };
        if band.upper_hz() > highest_hz * (1.0 + 1e-9) {
            return Err(ImpulseError::NonPhysical {
                quantity: "upper end of the band [Hz]",
                value: band.upper_hz(),
                expected: "at most the highest frequency of the measured bodies",
            });
        }
        Ok(band)
    }

    /// Returns the longest step up to `longest` that divides the period of a measured body.
    fn filling_the_period(&self, longest: f64) -> f64 {
        let period = self.impact.lines().map(|(step_hz, _)| 1.0 / step_hz).next();
        period.map_or(longest, |period| period / (period / longest).ceil())
    }

    fn discretised(&self, step: f64, duration: f64) -> Result<DiscreteImpact, ImpulseError> {
        self.impact.clone().in_steps_of(step).discretised(duration)
    }

    /// Returns the stated impact and its march with the step of the draws. This is the longest
    /// step, between the step that resolves `band` and the step `step` of `run`, with which the
    /// peak without a band limit and the end of the last contact agree with those of `run`. A step
    /// as long as the pulse would give a peak that depends on the impulse alone, whatever is drawn.
    fn for_draws(
        &self,
        (step, run): (f64, &Run),
        duration: f64,
        band: BandLimit,
    ) -> Result<(DiscreteImpact, Run), ImpulseError> {
        let numbers = run.numbers();
        let mut longer = step.max(band.time_step());
        loop {
            let discrete = self.discretised(self.filling_the_period(longer), duration)?;
            let stated = self::run(&discrete, band)?;
            let found = stated.numbers();
            let is_near = |a: Option<f64>, b: Option<f64>| match (a, b) {
                (Some(a), Some(b)) => (a - b).abs() <= RESOLVED * b.abs(),
                _ => true,
            };
            if longer <= step
                || is_near(found.peak, numbers.peak) && is_near(found.end, numbers.end)
            {
                return Ok((discrete, stated));
            }
            longer = step.max(0.5 * longer);
        }
    }

    /// Returns the standard deviations over the draws, and the march of the stated impact with the
    /// step of the draws.
    fn spread(
        &mut self,
        central: (f64, &Run),
        duration: f64,
        band: BandLimit,
    ) -> Result<Option<(Spread, Run)>, D::Error> {
        let n_draws = self.errors.n_draws();
        if n_draws < 2 {
            return Ok(None);
        }
        let (discrete, stated) = self.for_draws(central, duration, band)?;
        let mut draws = Draws::of(&stated);
        let mut left = n_draws;
        while left > 0 {
            let block = left.min(SIDE_BY_SIDE);
            let drawn: Vec<DrawnImpact> = (0..block)
                .map(|_| self.errors.draw(self.impact.velocity))
                .collect::<Result<_, _>>()?;
            let replaced = map_in_order(&drawn, |drawn| discrete.replaced(drawn));
            let replaced: Vec<DiscreteImpact> = replaced.into_iter().collect::<Result<_, _>>()?;
            for run in map_in_order(&replaced, |drawn| run(drawn, band)) {
                draws.add(&run?);
            }
            self.errors.check_cancelled()?;
            if n_draws - left < OF_PARTS {
                let pairs = drawn.iter().zip(&replaced);
                let parts: Vec<(ImpactSource, &DiscreteImpact)> = pairs
                    .flat_map(|(drawn, replaced)| {
                        let changed = ImpactSource::ALL.into_iter();
                        let changed = changed.filter(|of| drawn.changes(*of, self.impact.velocity));
                        changed.map(move |source| (source, replaced))
                    })
                    .collect();
                let runs = map_in_order(&parts, |(source, drawn)| {
                    let alone = discrete.with_source_of(drawn, *source)?;
                    Ok::<_, ImpulseError>((*source, run(&alone, band)?))
                });
                for part in runs {
                    let (source, run) = part?;
                    draws.add_part(source, &run.limited);
                }
                self.errors.check_cancelled()?;
            }
            left -= block;
        }
        Ok(Some((draws.spread(), stated)))
    }
}

fn run(discrete: &DiscreteImpact, band: BandLimit) -> Result<Run, ImpulseError> {
    let prediction = discrete.predict()?;
    Ok(Run {
        first_force: discrete.first_force(),
        limited: prediction.band_limited(band)?,
        prediction,
    })
}

impl UncertainPrediction {
    /// Returns the scalar results of the stated impact.
    #[must_use]
    pub fn numbers(&self) -> ImpactNumbers {
        ImpactNumbers::of(&self.prediction, self.first_force, &self.limited)
    }

    /// Returns the standard errors of the scalar results, including the numerical errors; `None`
    /// without draws.
    #[must_use]
    pub fn errors(&self) -> Option<ImpactNumbers> {
        let spread = self.spread.as_ref()?;
        Some(spread.numbers.with(&self.numerical_numbers, f64::hypot))
    }

    /// Largest force in the band, with its error.
    #[must_use]
    pub fn peak(&self) -> PeakForce {
        let peak = self.limited.smooth_peak();
        let numerical = self.numerical_numbers.limited_peak;
        let error = self.errors().and_then(|errors| errors.limited_peak);
        let spread = self.spread.as_ref();
        let degrees_of_freedom = spread.map_or(f64::INFINITY, |spread| {
            spread.n_draws.saturating_sub(1) as f64
        });
        PeakForce {
            force: peak.force,
            time: peak.time,
            standard_error: error.or(numerical).unwrap_or(f64::NAN),
            degrees_of_freedom,
        }
    }

    /// Returns the standard errors of the force in the band \[N\], including the numerical error;
    /// `None` without draws.
    #[must_use]
    pub fn limited_errors(&self) -> Option<Vec<f64>> {
        let spread = self.spread.as_ref()?;
        let pairs = spread.limited.iter().zip(&self.numerical);
        Some(pairs.map(|(a, b)| a.hypot(*b)).collect())
    }

    /// Returns the band of uncertainty that contains the whole force in the band of frequencies
    /// with the probability `level`; `None` without draws.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn simultaneous(&self, level: f64) -> Result<Option<ForceBand>, ImpulseError> {
        check_probability("level of a band", level)?;
        let (Some(spread), Some(errors)) = (&self.spread, self.limited_errors()) else {
            return Ok(None);
        };
        let factor = spread.simultaneous_factor(level);
        let at = |sign: f64| {
            let pairs = self.limited.force().iter().zip(&errors);
            pairs.map(|(f, error)| f + sign * factor * error).collect()
        };
        Ok(Some(ForceBand {
            coverage: Coverage::Simultaneous,
            level,
            factor,
            lower: at(-1.0),
            upper: at(1.0),
        }))
    }
}

mod by_lines;
#[cfg(test)]
mod tests;
