//! Changes of the response from hit to hit: with the peak of the input, or from the first half of
//! the hits to the second.

use num_complex::Complex64;

use super::hit_spectra::{HitSpectra, Lines};
use super::odd::beyond_student;

/// Fewest hits for a change with the peak of the input.
const FEWEST_HITS: usize = 5;
/// Smallest ratio of the largest to the smallest peak of the input.
const LEAST_RANGE: f64 = 1.2;
/// Probability of finding a change with the peak of the input by chance.
const LEVEL: f64 = 1e-4;
/// Probability of finding a change between the halves by chance.
const LEVEL_OF_HALVES: f64 = 1e-3;
/// Smallest change relative to the response.
const LEAST_CHANGE: f64 = 0.005;
/// Smallest ratio of the variance between the halves to the variance within them, divided by the
/// number of hits: three times the greatest ratio that a uniform drift causes.
const STEP_OVER_DRIFT: f64 = 9.0;

/// A systematic difference between hits in the response to `input`.
#[derive(Debug, Clone, PartialEq)]
pub enum Trend {
    /// The gain of an output changes with the peak of the input.
    Gain {
        /// Name of the output.
        channel: String,
        /// Change of the gain from the smallest to the largest peak of the input, relative to the
        /// mean gain.
        change: f64,
    },
    /// The response differs between the first and the second half of the hits.
    Halves {
        /// Name of the output.
        channel: String,
        /// Number of hits in the first half.
        n_first: usize,
        /// Difference of the responses relative to their mean, over all lines.
        difference: f64,
    },
}

/// Returns the changes of the response of the outputs to the input over the hits, in their order.
///
/// With the response $`H`$ of all hits and $`P = HX_j`$, hit $`j`$ has the gain
/// $`\mathrm{Re}\sum\overline{P}Y_j/\sum\lvert P\rvert^2`$. Its slope over the peaks of the input
/// is tested by Student's distribution at a level of 1e-4, for at least five hits whose peaks
/// differ by 20 % or more. A saturated input makes the gain rise.
///
/// The responses $`H_1`$, $`H_2`$ of both halves of the hits, in their order, are compared by the
/// ratio of $`\sum\lvert H_1-H_2\rvert^2 w_1w_2/(w_1+w_2)`$, with the energies $`w`$ of the input
/// on a line, to the mean square of the departures of the hits from the response of their half. The
/// ratio is tested at a level of 0.1 % as a variance with one degree of freedom over one with
/// `n - 2`, because a cause common to all lines is a single variable. It must also exceed nine
/// times the number of hits: a uniform drift gives up to three times this number.
///
/// Changes below half a per cent are ignored, and nothing is found in fewer than four hits.
#[must_use]
pub fn find_trends(spectra: &HitSpectra) -> Vec<Trend> {
    let mut found = Vec::new();
    for (output, lines) in &spectra.outputs {
        let halves = Halves::of(&spectra.inputs, lines);
        if let Some(change) = change_of_gain(&halves.gains, &spectra.peaks) {
            found.push(Trend::Gain {
                channel: output.clone(),
                change,
            });
        }
        if let Some(difference) = halves.difference() {
            found.push(Trend::Halves {
                channel: output.clone(),
                n_first: spectra.inputs.len() / 2,
                difference,
            });
        }
    }
    found
}

/// Returns the relative change of the gain from the smallest to the largest peak, if it is large
/// and significant.
fn change_of_gain(gains: &[f64], peaks: &[f64]) -> Option<f64> {
    let largest = peaks.iter().copied().fold(0.0, f64::max);
    let smallest = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    if gains.len() < FEWEST_HITS || largest < LEAST_RANGE * smallest {
        return None;
    }
    let n = gains.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let (gain, peak) = (mean(gains), mean(peaks));
    let pairs = || gains.iter().zip(peaks).map(|(g, p)| (g - gain, p - peak));
    let square: f64 = pairs().map(|(_, p)| p * p).sum();
    let slope = pairs().map(|(g, p)| g * p).sum::<f64>() / square;
    let left: f64 = pairs().map(|(g, p)| (g - slope * p).powi(2)).sum();
    let error = (left / (n - 2.0) / square).sqrt();
    let change = slope * (largest - smallest) / gain;
    let is_significant = beyond_student((slope / error).abs(), gains.len() - 2) < LEVEL;
    (change.abs() >= LEAST_CHANGE && is_significant).then_some(change)
}

/// Comparison of both halves of the hits.
struct Halves {
    /// Gain of each hit.
    gains: Vec<f64>,
    /// Energy of the difference of the responses, weighted by the inputs.
    between: f64,
    /// Energy of the departures of the hits from the response of their half.
    within: f64,
    /// Square of the relative difference of the responses.
    relative: f64,
}

impl Halves {
    fn of(inputs: &[Lines], outputs: &[Lines]) -> Self {
        let n_hits = inputs.len();
        let mut gains = vec![(0.0, 0.0); n_hits];
        let (mut between, mut within) = (0.0, 0.0);
        let (mut difference, mut whole) = (0.0, 0.0);
        let n_lines = inputs.first().map_or(0, Vec::len);
        for line in 0..n_lines {
            let pairs = || {
                let pairs = inputs.iter().zip(outputs);
                pairs.filter_map(move |(x, y)| Some((*x.get(line)?, *y.get(line)?)))
            };
            // energies of the input, cross-spectra and energies of the output of both halves
            let mut sums = [(0.0, Complex64::ZERO, 0.0); 2];
            let [first, second] = &mut sums;
            for (hit, (x, y)) in pairs().enumerate() {
                let half = if hit < n_hits / 2 {
                    &mut *first
                } else {
                    &mut *second
                };
                half.0 += x.norm_sqr();
                half.1 += x.conj() * y;
                half.2 += y.norm_sqr();
            }
            let [first, second] = sums;
            let energy = first.0 + second.0;
            if !(first.0 > 0.0 && second.0 > 0.0) {
                continue;
            }
            let response = (first.1 + second.1) / energy;
            for (gain, (x, y)) in gains.iter_mut().zip(pairs()) {
                let predicted = response * x;
                gain.0 += (predicted.conj() * y).re;
                gain.1 += predicted.norm_sqr();
            }
            let apart = (first.1 / first.0 - second.1 / second.0).norm_sqr();
            between += apart * first.0 * second.0 / energy;
            for half in [first, second] {
                within += (half.2 - half.1.norm_sqr() / half.0).max(0.0);
            }
            difference += apart * energy;
            whole += response.norm_sqr() * energy;
        }
        Self {
            gains: gains.into_iter().map(|(with, of)| with / of).collect(),
            between,
            within,
            relative: difference / whole,
        }
    }

    /// Returns the relative difference of the halves, if it is large and significant.
    fn difference(&self) -> Option<f64> {
        let n = self.gains.len();
        let ratio = self.between * (n - 2) as f64 / self.within;
        let difference = self.relative.sqrt();
        let is_significant = ratio > STEP_OVER_DRIFT * n as f64
            && beyond_student(ratio.sqrt(), n - 2) < LEVEL_OF_HALVES;
        (difference >= LEAST_CHANGE && is_significant).then_some(difference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quantity, Record};
    use ndarray::Array2;
    use testbed::half_sine::half_sine;
    use testbed::noise::Noise;

    const N: usize = 2048;

    /// Trends in eight hits of a body with one mode, with peaks of the force in irregular order and
    /// noise of 1e-4. `input` gives the recorded force for the true force, `pole` the angle of the
    /// mode per sample for the index of a hit.
    fn found(seed: u64, input: impl Fn(f64) -> f64, pole: impl Fn(usize) -> f64) -> Vec<Trend> {
        let mut rng = Noise::seeded(seed);
        let blows = [1.0, 1.3, 0.9, 1.2, 1.35, 0.95, 1.1, 1.25];
        let hits: Vec<Record> = blows
            .into_iter()
            .enumerate()
            .map(|(hit, peak)| {
                let force = |n: usize| peak * half_sine((n as f64 - 200.0) / 12.0);
                let z = Complex64::from_polar(0.98, pole(hit));
                let mut state = Complex64::ZERO;
                let mut samples = Array2::zeros((2, N));
                for n in 0..N {
                    state = z * state + force(n);
                    let mut noise = || rng.normal();
                    samples[[0, n]] = input(force(n)) + 1e-4 * noise();
                    samples[[1, n]] = state.im + 1e-4 * noise();
                }
                let channels = [("force", Quantity::Force), ("end", Quantity::Acceleration)];
                Record::of_test(samples, 10_000.0, &channels)
            })
            .collect();
        let hits: Vec<&Record> = hits.iter().collect();
        find_trends(&HitSpectra::of(&hits, "force", &["end"], Some(150)).unwrap())
    }

    #[test]
    fn a_saturated_force_and_another_body_are_found_and_right_hits_are_not() {
        for seed in 0..20 {
            assert_eq!(found(seed, |f| f, |_| 0.3), []);
            // a uniform drift is not a difference between the halves
            assert_eq!(found(seed, |f| f, |hit| 0.3 + 1e-3 * hit as f64), []);
        }
        // the gain is 1 / (1 - 0.02 f²) or less: up to 1.2 % from 0.9 to 1.35 N
        let saturated = found(1, |f| f * (1.0 - 0.02 * f * f), |_| 0.3);
        assert!(
            matches!(saturated[..], [Trend::Gain { change, .. }] if (0.005..0.025).contains(&change)),
            "{saturated:?}"
        );
        let bodies = found(1, |f| f, |hit| if hit < 4 { 0.3 } else { 0.33 });
        assert!(
            matches!(bodies[..], [Trend::Halves { n_first: 4, .. }]),
            "{bodies:?}"
        );
    }
}
