//! Onset and time constant of the contact, and variance of the changes, from the front of a record.

use faer::{Mat, Side};

use crate::recorder::contact::{Contact, Shown, value_at};
use crate::recorder::filter::Observation;

/// Number of samples after the half height that are used as the front: its rise and the ringing of
/// the filter.
const AFTER: usize = 64;

/// Number of samples at rest that are used before the earliest start of the contact.
const BEFORE: usize = 12;

/// Number of samples by which the contact may begin before the record rises above its noise.
const EARLIER: usize = 4;

/// Number of standard deviations of the noise above which a sample belongs to the rise.
const ABOVE_NOISE: f64 = 3.0;

/// Time constants of the contact that are tried, in points.
const TIME_CONSTANTS: [f64; 7] = [0.25, 0.5, 1.0, 1.5, 2.5, 4.0, 8.0];

/// Exponents of the powers of two by which the variance of the changes is multiplied in a round.
const OCTAVES: std::ops::RangeInclusive<i32> = -10..=3;

/// Largest number of rounds; each searches over onset, variance and time constant in turn.
const ROUNDS: usize = 4;

/// Largest number of contacts in the mixture: the estimate for each takes a tenth of a second.
const MOST_CONTACTS: usize = 16;

/// Probability relative to that of the most likely contact below which a contact is omitted.
const LEAST_WEIGHT: f64 = 0.01;

/// The part of a record about its front, from which the prior is found.
pub(super) struct Front<'a> {
    record: &'a [f64],
    noise: Mat<f64>,
    /// First sample of the part.
    from: usize,
    /// Earliest and latest start of the contact, in points of the grid.
    begins: std::ops::Range<usize>,
    seen: &'a Observation,
}

impl<'a> Front<'a> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place within the record"
    )]
    pub(super) fn of(
        record: &'a [f64],
        noise: &Mat<f64>,
        half_rise: f64,
        seen: &'a Observation,
    ) -> Option<Self> {
        let half = half_rise.floor() as usize;
        let level = ABOVE_NOISE * noise[(0, 0)].sqrt();
        let rise = record.get(..=half)?.iter().rev();
        let risen = half.saturating_sub(rise.take_while(|v| v.abs() > level).count());
        let earliest = risen.saturating_sub(EARLIER);
        let from = earliest.saturating_sub(BEFORE);
        let to = (half + AFTER).min(record.len());
        let delay = seen.delay();
        let at = |sample: usize| (sample * seen.every()).saturating_sub(delay);
        Some(Self {
            record: record.get(from..to)?,
            noise: Mat::from_fn(to - from, to - from, |i, j| noise[(from + i, from + j)]),
            from,
            begins: at(earliest)..at(half + 2) + 1,
            seen,
        })
    }

    /// The most likely parameters of the prior; `None` if the covariance of the record is not
    /// positive definite.
    pub(super) fn contact(&self, largest: f64) -> Option<Contact<'static>> {
        let middle = self.begins.start.midpoint(self.begins.end);
        let mut best = Contact {
            begin: middle,
            memory: (-1.0_f64).exp(),
            change: largest.powi(2) / self.seen.every() as f64,
            step: largest.powi(2),
            factors: &[],
        };
        let mut known = self.shown(best.memory);
        let mut likelihood = self.ln_likelihood(&known, best)?;
        for _ in 0..ROUNDS {
            let before = best;
            for begin in self.begins.clone() {
                let tried = Contact { begin, ..best };
                if let Some(value) = self
                    .ln_likelihood(&known, tried)
                    .filter(|v| *v > likelihood)
                {
                    (best, likelihood) = (tried, value);
                }
            }
            let scale = best.change;
            for octave in OCTAVES {
                let change = scale * 2.0_f64.powi(octave);
                let tried = Contact { change, ..best };
                if let Some(value) = self
                    .ln_likelihood(&known, tried)
                    .filter(|v| *v > likelihood)
                {
                    (best, likelihood) = (tried, value);
                }
            }
            for constant in TIME_CONSTANTS {
                let memory = (-1.0 / constant).exp();
                let tried = Contact { memory, ..best };
                let shown = self.shown(memory);
                if let Some(value) = self
                    .ln_likelihood(&shown, tried)
                    .filter(|v| *v > likelihood)
                {
                    (best, likelihood, known) = (tried, value, shown);
                }
            }
            if best == before {
                break;
            }
        }
        Some(best)
    }

    /// Returns the contacts with any beginning and time constant that are likely given the record,
    /// with their probabilities; `best` is the most likely one.
    pub(super) fn likely(&self, best: Contact<'static>) -> Vec<(f64, Contact<'static>)> {
        self.likely_of(best, TIME_CONSTANTS.into_iter())
    }

    /// Returns the likely contacts on a grid that has `points` points for each point of the grid of
    /// the `coarse` contacts.
    pub(super) fn likely_on_finer_grid(
        mut self,
        coarse: &[(f64, Contact<'_>)],
        points: usize,
    ) -> Option<Vec<(f64, Contact<'static>)>> {
        let begins = coarse.iter().map(|(_, contact)| contact.begin);
        let (first, last) = (begins.clone().min()?, begins.max()?);
        self.begins = points * first.saturating_sub(1)..points * (last + 2);
        let (_, best) = coarse.first()?;
        let longest = TIME_CONSTANTS.into_iter().next_back()?;
        // in points of the finer grid the time constants of the coarse contacts are longer
        let longer = [2.0, 4.0].map(|factor| factor * longest);
        let constants = TIME_CONSTANTS.into_iter().chain(longer);
        Some(self.likely_of(best.on_finer_grid(points), constants))
    }

    fn likely_of(
        &self,
        best: Contact<'static>,
        constants: impl Iterator<Item = f64>,
    ) -> Vec<(f64, Contact<'static>)> {
        let mut all: Vec<(f64, Contact<'static>)> = Vec::new();
        for constant in constants {
            let memory = (-1.0 / constant).exp();
            let known = self.shown(memory);
            for begin in self.begins.clone() {
                let contact = Contact {
                    begin,
                    memory,
                    ..best
                };
                all.extend(
                    self.ln_likelihood(&known, contact)
                        .map(|value| (value, contact)),
                );
            }
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let largest = all.first().map_or(0.0, |(value, _)| *value);
        all.truncate(MOST_CONTACTS);
        for (value, _) in &mut all {
            *value = (*value - largest).exp();
        }
        all.retain(|(weight, _)| *weight > LEAST_WEIGHT);
        let sum: f64 = all.iter().map(|(weight, _)| weight).sum();
        all.iter_mut().for_each(|(weight, _)| *weight /= sum);
        all
    }

    /// The response of the samples to a contact with this `memory`.
    fn shown(&self, memory: f64) -> Shown {
        let earliest = self.begins.start;
        let last = (self.from + self.record.len()) * self.seen.every() + self.seen.lead();
        let points = last.saturating_sub(earliest);
        Shown::of(memory, (points, self.record.len()), self.seen)
    }

    fn ln_likelihood(&self, known: &Shown, contact: Contact<'_>) -> Option<f64> {
        let covariance = known.covariance(&contact, (self.from, &self.noise));
        let factor = covariance.llt(Side::Lower).ok()?;
        let lower = factor.L();
        let mut white = Mat::from_fn(self.record.len(), 1, |i, _| value_at(self.record, i));
        lower.solve_lower_triangular_in_place(white.as_mut());
        let square = white.squared_norm_l2();
        let ln_determinant: f64 = (0..self.record.len()).map(|i| lower[(i, i)].ln()).sum();
        let value = -0.5 * square - ln_determinant;
        value.is_finite().then_some(value)
    }
}
