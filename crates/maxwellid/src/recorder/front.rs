//! Begin, time constant and variance of the contact, from the front of a record.

use faer::{Mat, Side};

use crate::recorder::contact::{Contact, in_step, value_at};
use crate::recorder::filter::Observation;

/// Samples that a front is followed after its half height: its rise and the ringing of the filter.
const AFTER: usize = 64;

/// Samples of rest before the earliest begin of contact.
const BEFORE: usize = 12;

/// Samples by which the contact may begin before the record leaves its noise.
const EARLIER: usize = 4;

/// Standard deviations of the noise above which a sample belongs to the rise.
const ABOVE_NOISE: f64 = 3.0;

/// Time constants of the contact that are tried, in points.
const TIME_CONSTANTS: [f64; 7] = [0.25, 0.5, 1.0, 1.5, 2.5, 4.0, 8.0];

/// Powers of two by which the variance of a change is tried.
const OCTAVES: std::ops::RangeInclusive<i32> = -10..=3;

/// Rounds over begin, time constant and variance.
const ROUNDS: usize = 4;

/// Most contacts that are mixed: an estimate of each takes a tenth of a second.
const MOST_CONTACTS: usize = 16;

/// Probability over that of the most likely contact below which one is left out.
const LEAST_WEIGHT: f64 = 0.01;

/// G B for a contact that begins at the first point, by the point since then that a sample shows.
struct Products {
    /// The response to a step at the first point.
    step: Vec<f64>,
    /// Sums of products of the responses to steps at all points.
    products: Mat<f64>,
}

impl Products {
    /// What is shown at point `i` of a step `later` points after the first.
    fn shown(&self, i: usize, later: usize) -> f64 {
        let since = i.checked_sub(later);
        since.map_or(0.0, |since| value_at(&self.step, since))
    }
}

/// The part of a record about its front, from which the prior is found.
pub(super) struct Front<'a> {
    record: &'a [f64],
    noise: Mat<f64>,
    /// First sample of the part.
    from: usize,
    /// Earliest and latest begin of the contact, in points of the grid.
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

    /// The most likely parameters of the prior; `None` if the record has no likelihood.
    pub(super) fn contact(&self, largest: f64) -> Option<Contact> {
        let middle = self.begins.start.midpoint(self.begins.end);
        let mut best = Contact {
            begin: middle,
            memory: (-1.0_f64).exp(),
            change: largest.powi(2) / self.seen.every() as f64,
            step: largest.powi(2),
        };
        let mut known = self.products(best.memory);
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
                let products = self.products(memory);
                if let Some(value) = self
                    .ln_likelihood(&products, tried)
                    .filter(|v| *v > likelihood)
                {
                    (best, likelihood, known) = (tried, value, products);
                }
            }
            if best == before {
                break;
            }
        }
        Some(best)
    }

    /// The contacts of other begin and time constant that the record leaves likely beside the
    /// `best`, with their probabilities.
    pub(super) fn likely(&self, best: Contact) -> Vec<(f64, Contact)> {
        self.likely_of(best, TIME_CONSTANTS.into_iter())
    }

    /// The contacts that are likely on a grid of `points` points for each of the one on which
    /// `coarse` are.
    pub(super) fn likely_on_finer_grid(
        mut self,
        coarse: &[(f64, Contact)],
        points: usize,
    ) -> Option<Vec<(f64, Contact)>> {
        let begins = coarse.iter().map(|(_, contact)| contact.begin);
        let (first, last) = (begins.clone().min()?, begins.max()?);
        self.begins = points * first.saturating_sub(1)..points * (last + 2);
        let (_, best) = coarse.first()?;
        let longest = TIME_CONSTANTS.into_iter().next_back()?;
        let longer = [2, 4, 8].into_iter().take_while(|factor| *factor <= points);
        let longer = longer.map(|factor| longest * factor as f64);
        let constants = TIME_CONSTANTS.into_iter().chain(longer);
        Some(self.likely_of(best.on_finer_grid(points), constants))
    }

    fn likely_of(
        &self,
        best: Contact,
        constants: impl Iterator<Item = f64>,
    ) -> Vec<(f64, Contact)> {
        let mut all: Vec<(f64, Contact)> = Vec::new();
        for constant in constants {
            let memory = (-1.0 / constant).exp();
            let known = self.products(memory);
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

    /// What samples show of a contact that begins at the first point.
    fn products(&self, memory: f64) -> Products {
        let earliest = self.begins.start;
        let last = (self.from + self.record.len()) * self.seen.every() + self.seen.lead();
        let count = last.saturating_sub(earliest);
        let step = self.seen.of_step(memory, count);
        let mut products = Mat::zeros(count, count);
        for i in 0..count {
            for k in 0..=i {
                let before = match (i.checked_sub(1), k.checked_sub(1)) {
                    (Some(i), Some(k)) => products[(i, k)],
                    _ => 0.0,
                };
                let value = before + value_at(&step, i) * value_at(&step, k);
                products[(i, k)] = value;
                products[(k, i)] = value;
            }
        }
        Products { step, products }
    }

    fn ln_likelihood(&self, known: &Products, contact: Contact) -> Option<f64> {
        let lead = self.seen.lead();
        // points since the begin of the contact that a sample shows
        let since =
            |i: usize| ((self.from + i) * self.seen.every() + lead).checked_sub(contact.begin);
        let count = self.record.len();
        let covariance = Mat::from_fn(count, count, |i, k| {
            let prior = match (since(i), since(k)) {
                (Some(i), Some(k)) => {
                    let shown = |at: usize| [known.shown(at, 0), known.shown(at, 1)];
                    let of_steps = in_step(shown(k));
                    let pairs = shown(i).into_iter().zip(of_steps);
                    contact.change * known.products[(i, k)]
                        + contact.step * pairs.map(|(a, b)| a * b).sum::<f64>()
                }
                _ => 0.0,
            };
            prior + self.noise[(i, k)]
        });
        let factor = covariance.llt(Side::Lower).ok()?;
        let lower = factor.L();
        let mut white = self.record.to_vec();
        let (mut square, mut ln_determinant) = (0.0, 0.0);
        for i in 0..count {
            let (known, rest) = white.split_at_mut(i);
            let own = rest.first_mut()?;
            let along: f64 = known
                .iter()
                .enumerate()
                .map(|(k, z)| lower[(i, k)] * z)
                .sum();
            *own = (*own - along) / lower[(i, i)];
            square += *own * *own;
            ln_determinant += lower[(i, i)].ln();
        }
        let value = -0.5 * square - ln_determinant;
        value.is_finite().then_some(value)
    }
}
