//! The prior of an excitation: a contact that begins, and what a record makes of it.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::recorder::filter::Observation;

/// Correlation of the steps at the begin and at the next point, between which a contact begins: two
/// parts of one step. Without correlation they ring, and with one step the front is on a point: of
/// blows in closed form the errors over their standard errors are 7, 2.4 and, so, 0.8 (root mean
/// square).
const OF_ONE_STEP: f64 = 0.8;

/// The covariance of the two steps, in h², times two numbers.
pub(super) fn in_step([first, second]: [f64; 2]) -> [f64; 2] {
    [first + OF_ONE_STEP * second, OF_ONE_STEP * first + second]
}

/// The parameters of the prior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    /// First point of the grid that moves.
    pub(super) begin: usize,
    /// e^{-1/τ}, τ in points.
    pub(super) memory: f64,
    /// Variance q of the change of velocity in one point [m²/s²].
    pub(super) change: f64,
    /// Variance h² of the steps at the begin and at the next point [m²/s²].
    pub(super) step: f64,
}

pub(super) fn value_at(values: &[f64], index: usize) -> f64 {
    values.get(index).copied().unwrap_or(0.0)
}

impl Contact {
    /// B w: what a change w of each point makes of the velocity.
    pub(super) fn moved(&self, changes: impl Iterator<Item = f64>) -> Vec<f64> {
        let (mut sum, mut delayed) = (0.0, 0.0);
        changes
            .enumerate()
            .map(|(point, change)| {
                if point < self.begin {
                    return 0.0;
                }
                sum += change;
                delayed = self.memory * (delayed + change);
                sum - delayed
            })
            .collect()
    }

    /// Bᵀ y.
    pub(super) fn moved_back(&self, values: &[f64]) -> Vec<f64> {
        let (mut sum, mut delayed) = (0.0, 0.0);
        let mut back: Vec<f64> = values
            .iter()
            .rev()
            .map(|value| {
                sum += value;
                delayed = self.memory * (delayed + value);
                sum - delayed
            })
            .collect();
        back.reverse();
        back
    }

    /// D w: the covariance of the changes times a history.
    pub(super) fn correlated(&self, mut values: Vec<f64>) -> Vec<f64> {
        let at = |point: usize| value_at(&values, point);
        let steps = in_step([at(self.begin), at(self.begin + 1)]);
        for (point, value) in values.iter_mut().enumerate() {
            *value *= if point < self.begin { 0.0 } else { self.change };
        }
        let moving = values.iter_mut().skip(self.begin);
        for (value, step) in moving.zip(steps) {
            *value += self.step * step;
        }
        values
    }

    /// The same contact on a grid of so many points for each of this one.
    pub(super) fn on_finer_grid(self, points: usize) -> Self {
        let finer = points as f64;
        Self {
            begin: points * self.begin,
            memory: self.memory.powf(1.0 / finer),
            change: self.change / finer,
            ..self
        }
    }

    /// Σ Gᵀ, a column of `points` points for each sample.
    fn columns(&self, samples: usize, points: usize, seen: &Observation) -> Vec<Vec<f64>> {
        let step = seen.of_step(self.memory, points);
        (0..samples)
            .map(|sample| {
                let newest = sample * seen.every() + seen.lead();
                let row = (0..points).map(|point| {
                    let since = newest.checked_sub(point);
                    since.map_or(0.0, |since| value_at(&step, since))
                });
                self.moved(self.correlated(row.collect()).into_iter())
            })
            .collect()
    }

    /// Mean of the excitation at `points` points, given its `record`; `None` as for
    /// [`Self::given`].
    pub(super) fn mean_given(
        &self,
        record: &[f64],
        noise: &Mat<f64>,
        points: usize,
        seen: &Observation,
    ) -> Option<Vec<f64>> {
        let columns = self.columns(record.len(), points, seen);
        let factor = covariance_of_record(&columns, noise, seen)
            .llt(Side::Lower)
            .ok()?;
        let solved = factor.solve(&Mat::from_fn(record.len(), 1, |i, _| value_at(record, i)));
        let mut mean = vec![0.0; points];
        for (i, column) in columns.iter().enumerate() {
            for (sum, value) in mean.iter_mut().zip(column) {
                *sum += solved[(i, 0)] * value;
            }
        }
        Some(mean)
    }

    /// Mean and covariance of the excitation at `points` points, given its `record`; `None` if the
    /// covariance of the record is not positive definite.
    pub(super) fn given(
        &self,
        record: &[f64],
        noise: &Mat<f64>,
        points: usize,
        seen: &Observation,
    ) -> Option<(Vec<f64>, Mat<f64>)> {
        let samples = record.len();
        let columns = self.columns(samples, points, seen);
        let factor = covariance_of_record(&columns, noise, seen)
            .llt(Side::Lower)
            .ok()?;
        let across = Mat::from_fn(samples, points, |i, point| {
            columns.get(i).map_or(0.0, |column| value_at(column, point))
        });
        let solved = factor.solve(&across);
        let mean = (0..points)
            .map(|point| {
                let weights = record.iter().enumerate();
                weights.map(|(i, v)| solved[(i, point)] * v).sum()
            })
            .collect();
        let mut covariance = across.transpose() * &solved;
        for point in 0..points {
            let mut unit = vec![0.0; points];
            if let Some(own) = unit.get_mut(point) {
                *own = 1.0;
            }
            let own = self.moved(self.correlated(self.moved_back(&unit)).into_iter());
            for (k, prior) in own.into_iter().enumerate() {
                covariance[(k, point)] = prior - covariance[(k, point)];
            }
        }
        Some((mean, covariance))
    }
}

/// K = G Σ Gᵀ + C_e, from the columns of Σ Gᵀ.
fn covariance_of_record(columns: &[Vec<f64>], noise: &Mat<f64>, seen: &Observation) -> Mat<f64> {
    let seen_columns: Vec<Vec<f64>> = columns.iter().map(|c| seen.of_history(c)).collect();
    Mat::from_fn(columns.len(), columns.len(), |i, k| {
        let own = seen_columns
            .get(k)
            .map_or(0.0, |column| value_at(column, i));
        own + noise[(i, k)]
    })
}

/// Mean of the excitation over `contacts` with their probabilities, from that `given` each.
pub(super) fn mixed_mean(
    contacts: &[(f64, Contact)],
    given: impl Fn(&Contact) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let mut sum: Vec<f64> = Vec::new();
    for (weight, contact) in contacts {
        let own = given(contact)?;
        sum.resize(own.len(), 0.0);
        for (sum, value) in sum.iter_mut().zip(own) {
            *sum += weight * value;
        }
    }
    Some(sum)
}

/// Mean and covariance of the excitation over `contacts` with their probabilities, from those
/// `given` each: P = Σ p (P_i + (u_i - u)(u_i - u)ᵀ) about u = Σ p u_i.
pub(super) fn mixed(
    contacts: &[(f64, Contact)],
    given: impl Fn(&Contact) -> Option<(Vec<f64>, Mat<f64>)>,
) -> Option<(Vec<f64>, Mat<f64>)> {
    let mut each = Vec::with_capacity(contacts.len());
    for (weight, contact) in contacts {
        let (mean, covariance) = given(contact)?;
        each.push((*weight, mean, covariance));
    }
    let points = each.first()?.1.len();
    let mut mean = vec![0.0; points];
    for (weight, own, _) in &each {
        let pairs = mean.iter_mut().zip(own);
        pairs.for_each(|(sum, value)| *sum += weight * value);
    }
    let mut covariance = Mat::zeros(points, points);
    for (weight, own, of_own) in &each {
        let off: Vec<f64> = own.iter().zip(&mean).map(|(a, b)| a - b).collect();
        for (k, of_column) in off.iter().enumerate() {
            for (i, of_row) in off.iter().enumerate() {
                covariance[(i, k)] += weight * (of_own[(i, k)] + of_row * of_column);
            }
        }
    }
    Some((mean, covariance))
}
