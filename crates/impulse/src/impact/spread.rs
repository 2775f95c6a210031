//! Standard deviations of the results of an impact over draws of its uncertain inputs.

use super::{FirstForce, ImpactNumbers, ImpactSource, Prediction};
use crate::ForceHistory;
use crate::force_error::{Moments, quantile};

/// Result of one march, with its force in the band.
pub(super) struct Run {
    pub(super) prediction: Prediction,
    pub(super) first_force: FirstForce,
    pub(super) limited: ForceHistory,
}

impl Run {
    pub(super) fn numbers(&self) -> ImpactNumbers {
        ImpactNumbers::of(&self.prediction, self.first_force, &self.limited)
    }
}

/// Standard deviations of an impact over draws, part of an
/// [`UncertainPrediction`](super::UncertainPrediction).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Spread {
    /// Number of draws.
    pub n_draws: usize,
    /// Standard deviations of the scalar results. The deviation of the end is `None` if the number
    /// of main contacts differs from draw to draw.
    pub numbers: ImpactNumbers,
    /// Standard deviation of the force in the band, at its times \[N\].
    pub limited: Vec<f64>,
    /// Standard deviation of the force without a band limit, at its times \[N\].
    pub force: Vec<f64>,
    /// Standard deviations of the force in the band \[N\] due to one source alone, with the others
    /// as stated, over up to 48 draws; one entry per drawn source.
    pub parts: Vec<(ImpactSource, Vec<f64>)>,
    /// Largest ratio of the deviation of the force in the band to its standard deviation, one per
    /// draw, in ascending order.
    largest: Vec<f64>,
}

impl Spread {
    /// Returns the multiple of the standard deviation within which the whole force in the band lies
    /// for a fraction `level` of the draws.
    #[must_use]
    pub fn simultaneous_factor(&self, level: f64) -> f64 {
        quantile(&self.largest, level)
    }

    /// Returns the deviations at the times of other histories.
    pub(super) fn at_times(self, of: &Run, limited: &ForceHistory, force: &ForceHistory) -> Self {
        Self {
            limited: resampled(&of.limited, &self.limited, limited),
            parts: (self.parts.iter())
                .map(|(source, part)| (*source, resampled(&of.limited, part, limited)))
                .collect(),
            force: resampled(&of.prediction.history, &self.force, force),
            ..self
        }
    }
}

/// Sums over draws of the impact.
pub(super) struct Draws {
    numbers: Vec<ImpactNumbers>,
    /// True if all draws have as many main contacts as the stated impact.
    contacts_agree: bool,
    n_contacts: usize,
    limited: Moments,
    force: Moments,
    limited_forces: Vec<Vec<f64>>,
    parts: Vec<(ImpactSource, Moments)>,
}

impl Draws {
    /// Creates the sums for draws of the `stated` impact.
    pub(super) fn of(stated: &Run) -> Self {
        Self {
            numbers: Vec::new(),
            contacts_agree: true,
            n_contacts: stated.prediction.main_contacts().count(),
            limited: Moments::of(stated.limited.force().len()),
            force: Moments::of(stated.prediction.history.force().len()),
            limited_forces: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// Adds the force in the band of a draw of one `source` alone.
    pub(super) fn add_part(&mut self, source: ImpactSource, limited: &ForceHistory) {
        let known = self.parts.iter().position(|(of, _)| *of == source);
        let at = known.unwrap_or(self.parts.len());
        if known.is_none() {
            let moments = Moments::of(limited.force().len());
            self.parts.push((source, moments));
        }
        if let Some((_, moments)) = self.parts.get_mut(at) {
            moments.add(limited.force());
        }
    }

    pub(super) fn add(&mut self, run: &Run) {
        self.numbers.push(run.numbers());
        self.contacts_agree &= run.prediction.main_contacts().count() == self.n_contacts;
        self.limited.add(run.limited.force());
        self.force.add(run.prediction.history.force());
        self.limited_forces.push(run.limited.force().to_vec());
    }

    pub(super) fn spread(&self) -> Spread {
        let mut numbers = ImpactNumbers::from_all(std::array::from_fn(|at| {
            let values = self.numbers.iter();
            let values: Option<Vec<f64>> = values
                .map(|numbers| numbers.all().get(at).copied().flatten())
                .collect();
            values.map(|values| deviation(&values))
        }));
        if !self.contacts_agree {
            numbers.end = None;
        }
        let limited = self.limited.deviations();
        let largest = |force: &Vec<f64>| {
            let ratios = force.iter().zip(&self.limited.mean).zip(&limited);
            ratios
                .filter(|(_, deviation)| **deviation > 0.0)
                .map(|((force, mean), deviation)| ((force - mean) / deviation).abs())
                .fold(0.0, f64::max)
        };
        let mut largest: Vec<f64> = self.limited_forces.iter().map(largest).collect();
        largest.sort_by(f64::total_cmp);
        Spread {
            n_draws: self.numbers.len(),
            numbers,
            limited,
            force: self.force.deviations(),
            parts: (self.parts.iter())
                .map(|(source, moments)| (*source, moments.deviations()))
                .collect(),
            largest,
        }
    }
}

fn deviation(values: &[f64]) -> f64 {
    let mut moments = Moments::of(1);
    for value in values {
        moments.add(&[*value]);
    }
    moments.deviations().first().copied().unwrap_or(f64::NAN)
}

/// Interpolates `values` linearly from the times of `of` to the times of `to`.
pub(super) fn resampled(of: &ForceHistory, values: &[f64], to: &ForceHistory) -> Vec<f64> {
    let (start, step) = (of.time_at(0), of.time_step());
    let mut pairs = values.windows(2).enumerate().peekable();
    (0..to.force().len())
        .map(|index| {
            let position = (to.time_at(index) - start) / step;
            while pairs
                .peek()
                .is_some_and(|(at, _)| *at as f64 + 1.0 < position)
                && pairs.len() > 1
            {
                pairs.next();
            }
            match pairs.peek() {
                Some((at, [a, b])) => {
                    let fraction = (position - *at as f64).clamp(0.0, 1.0);
                    a + fraction * (b - a)
                }
                _ => values.first().copied().unwrap_or(0.0),
            }
        })
        .collect()
}
