//! Projection of measured lines onto physically possible bodies: causal, passive, or both.

use num_complex::Complex64;

use super::measured::LowFrequency;
use crate::{MeasuredBody, fourier};

/// Largest number of alternations between the causal and the passive set.
const ALTERNATIONS: usize = 50;

/// Relative change of the body by an alternation, below which the alternations end.
const SETTLED: f64 = 1e-9;

/// Set of bodies onto which lines are projected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Projection {
    /// Bodies that do not respond before the impulse.
    ///
    /// The rigid-body motion and the instantaneous response, $`1/Z`$, are subtracted; the second
    /// half of the period, which is the time before the impulse, is set to zero; the two subtracted
    /// parts are added again. Noise loses half of its power.
    ///
    /// Validity: free vibrations must decay within half a period $`1/(2\Delta f)`$. A band limit
    /// smears jumps into the time before the impulse: this part is removed too, so that lines near
    /// the end of the band change.
    Causal,
    /// Bodies that generate no energy: a real part below 0 becomes 0.
    Passive,
    /// Bodies that meet both conditions, by alternating projections.
    CausalAndPassive,
}

/// Change of the lines of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LineChange {
    /// Number of lines that have changed.
    pub n_lines: usize,
    /// Root of the sum of the squared changes, divided by the sum of the squared lines.
    pub relative: f64,
    /// Root mean square change over all lines in standard errors; `None` without variances.
    pub in_errors: Option<f64>,
    /// The line with the largest change in standard errors, and this change.
    pub largest: Option<(usize, f64)>,
}

impl MeasuredBody {
    /// Returns the body with its lines projected; the variances stay unchanged.
    #[must_use]
    pub fn projected(&self, onto: Projection) -> Self {
        match onto {
            Projection::Causal => self.causal(),
            Projection::Passive => self.passive(),
            Projection::CausalAndPassive => {
                let mut found = self.causal().passive();
                for _ in 1..ALTERNATIONS {
                    let next = found.causal().passive();
                    let change = next.change_from(&found);
                    found = next;
                    if change.relative < SETTLED {
                        break;
                    }
                }
                found
            }
        }
    }

    /// Compares the lines with those of `before`, in standard errors of `before`. Lines that only
    /// the longer spectrum has are not compared.
    #[must_use]
    pub fn change_from(&self, before: &Self) -> LineChange {
        let pairs = self.mobility().iter().zip(before.mobility());
        let largest = pairs
            .clone()
            .map(|(_, line)| line.norm())
            .fold(0.0, f64::max);
        let mut found = LineChange {
            n_lines: 0,
            relative: 0.0,
            in_errors: None,
            largest: None,
        };
        let (mut moved, mut size, mut errors, mut n_known) = (0.0, 0.0, 0.0, 0.0_f64);
        for (line, (after, line_before)) in pairs.enumerate() {
            let change = (after - line_before).norm();
            found.n_lines += usize::from(change > 0.0);
            moved += (change / largest).powi(2);
            size += (line_before.norm() / largest).powi(2);
            let variance = before.variance().and_then(|all| all.get(line));
            let Some(error) = variance.map(|v| v.sqrt()).filter(|error| *error > 0.0) else {
                continue;
            };
            let change = change / error;
            errors += change * change;
            n_known += 1.0;
            if change > found.largest.map_or(0.0, |(_, most)| most) {
                found.largest = Some((line, change));
            }
        }
        if moved > 0.0 {
            found.relative = (moved / size).sqrt();
        }
        found.in_errors = (n_known > 0.0).then(|| (errors / n_known).sqrt());
        found
    }

    fn causal(&self) -> Self {
        let conductance = self.conductance();
        let remainder = self.remainder(conductance);
        let n_samples = 2 * (remainder.len() - 1);
        let mut samples = fourier::to_samples(&remainder, n_samples);
        for sample in samples.iter_mut().skip(n_samples / 2) {
            *sample = 0.0;
        }
        let scale = 1.0 / n_samples as f64;
        let causal = fourier::to_spectrum(&samples);
        let lines = causal.iter().enumerate();
        let mobility = lines
            .map(|(line, value)| match (self.low_frequency(), line) {
                (LowFrequency::Free(_) | LowFrequency::Fixed, 0) => Complex64::ZERO,
                _ => value * scale + self.rigid(line) + conductance,
            })
            .collect();
        self.clone().with_mobility(mobility)
    }

    fn passive(&self) -> Self {
        let lines = self.mobility().iter();
        let mobility = lines.map(|line| Complex64::new(line.re.max(0.0), line.im));
        self.clone().with_mobility(mobility.collect())
    }
}
