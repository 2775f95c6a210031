//! Detection of hits that differ from the others: each hit is compared with the response estimated
//! from all other hits.
#![allow(
    clippy::indexing_slicing,
    reason = "each hit has lines of the input and of the output"
)]

use num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::Reason;
use super::hit_spectra::{FEWEST_HITS, HitSpectra, Lines};
use crate::dft;

/// Probability that any hit of a test is found by chance.
const LEVEL: f64 = 1e-3;
/// Smallest energy of a departure divided by the greatest energy among the other hits: a single
/// source of scatter, such as the impact position, causes a smaller ratio.
const ENERGY_OVER_OTHERS: f64 = 9.0;
/// Smallest peak of a departure divided by the greatest peak among the other hits.
const PEAK_OVER_OTHERS: f64 = 2.0;
/// Smallest relevant departure: one such hit in ten changes the mean by 0.05 %.
const LEAST_DEPARTURE: f64 = 0.005;
/// Correlation above which a delay is stated.
const LEAST_LIKENESS: f64 = 0.5;
/// Number of hits examined per channel: those with the largest departures.
const MOST_EXAMINED: usize = 12;

/// Departure of one hit from the response estimated from the others.
#[derive(Debug, Clone, Copy)]
struct Departure {
    /// Energy of the output predicted by the others.
    expected: f64,
    /// Gain of the output relative to the prediction.
    scale: f64,
    /// Energy of the whole departure.
    energy: f64,
    /// Energy of the departure after the gain has been fitted.
    rest: f64,
    /// Largest sample of that remaining departure, and its index.
    peak: (f64, usize),
    /// Delay of the output relative to the prediction, in samples, from the peak of their
    /// correlation.
    lag: i64,
}

/// The hit with the largest departure.
struct Odd {
    hit: usize,
    /// Square root of the ratio of the energy of its departure to that of the prediction.
    departure: f64,
    /// Largest departure, in the same measure, among the other hits.
    others: f64,
    figures: Departure,
    /// Index of the sample of a spike.
    index: Option<usize>,
}

/// Returns the hits whose output departs from the response of all other hits by more than those
/// hits depart from each other, each with its reason ([`Reason::Departs`]).
///
/// With the response $`H_{-j}`$ of all hits but hit $`j`$, $`P = H_{-j}X_j`$ is the prediction of
/// the output $`Y_j`$ by the other hits. Three numbers of hit $`j`$ are compared with the same
/// numbers of every other hit, which are computed in the same way without hit $`j`$:
///
/// - the gain $`g = \mathrm{Re}\sum\overline{P}Y_j/\sum\lvert P\rvert^2`$, with a limit from
///   Student's distribution of the gains of the others at a level of 0.1 % for all hits together;
/// - the energy of $`Y_j - gP`$, which must exceed a limit found in the same way and nine times the
///   largest energy of the others;
/// - the largest sample of $`Y_j - gP`$, which must exceed a limit found in the same way and twice
///   the largest sample of the others.
///
/// A departure below half a per cent is ignored. For the comparison with a harder hit, the energies
/// of the others are increased in proportion to the energy of the prediction, so that an effect
/// that grows with the force does not count against the harder hit. A hit that was found is
/// excluded from the search for the next one.
///
/// # Validity
///
/// The function needs four hits or more, most of them correct; with fewer hits nothing is found.
/// Scatter common to the hits, such as that of the impact position, widens the limits. A fault of
/// the input appears in all outputs.
#[must_use]
pub fn find_odd_hits(spectra: &HitSpectra) -> Vec<(usize, Reason)> {
    let (inputs, n_samples) = (&spectra.inputs, spectra.n_samples);
    let mut found: Vec<(usize, Reason)> = Vec::new();
    for (output, lines) in &spectra.outputs {
        let mut left: Vec<usize> = (0..inputs.len()).collect();
        while left.len() >= FEWEST_HITS {
            let Some(odd) = oddest(&left, inputs, lines, n_samples) else {
                break;
            };
            left.retain(|index| *index != odd.hit);
            found.push((
                odd.hit,
                Reason::Departs {
                    channel: output.clone(),
                    departure: odd.departure,
                    others: odd.others,
                    scale: odd.figures.scale,
                    delay: odd.figures.lag as f64 / spectra.sampling_rate_hz,
                    index: odd.index,
                },
            ));
        }
    }
    found.sort_by_key(|(hit, _)| *hit);
    found
}

/// Returns the hit among `left` with the largest departure, if it exceeds its limits.
fn oddest(left: &[usize], inputs: &[Lines], outputs: &[Lines], n_samples: usize) -> Option<Odd> {
    let departures = |hits: &[usize]| -> Vec<Departure> {
        let sums = Sums::of(hits, inputs, outputs);
        hits.iter()
            .map(|hit| sums.departure(&inputs[*hit], &outputs[*hit], n_samples))
            .collect()
    };
    let all = departures(left);
    let mut order: Vec<usize> = (0..left.len()).collect();
    order.sort_by(|a, b| all[*b].energy.total_cmp(&all[*a].energy));
    let mut candidates: Vec<usize> = order.iter().copied().take(MOST_EXAMINED).collect();
    let relative = |place: &usize| all[*place].energy / all[*place].expected;
    order.sort_by(|a, b| relative(b).total_cmp(&relative(a)));
    candidates.extend(order.iter().copied().take(MOST_EXAMINED));
    candidates.sort_unstable();
    candidates.dedup();
    let n_others = left.len() - 1;
    let limit = deviations(LEVEL / left.len() as f64, n_others);
    let mut worst: Option<(f64, usize, f64, Option<usize>)> = None;
    for place in candidates {
        let one = all[place];
        if one.energy < LEAST_DEPARTURE.powi(2) * one.expected {
            continue;
        }
        let others: Vec<usize> = left
            .iter()
            .copied()
            .filter(|hit| *hit != left[place])
            .collect();
        let others = departures(&others);
        let of = |figure: &dyn Fn(&Departure) -> f64| -> Vec<f64> {
            others.iter().map(figure).collect()
        };
        // allows for departures that grow in proportion to the force
        let growth = |other: &Departure| (one.expected / other.expected).max(1.0);
        let beyond = |value: f64, of_others: &[f64], over: f64| -> f64 {
            let (mean, deviation) = scatter(of_others);
            let largest = of_others.iter().copied().fold(0.0, f64::max);
            value / (mean + limit * deviation).max(over * largest)
        };
        let energy = beyond(
            one.rest,
            &of(&|other| other.rest * growth(other)),
            ENERGY_OVER_OTHERS,
        );
        let spike = beyond(
            one.peak.0,
            &of(&|other| other.peak.0 * growth(other).sqrt()),
            PEAK_OVER_OTHERS,
        );
        let (_, deviation) = scatter(&of(&|other| other.scale));
        let gain = (one.scale - 1.0).abs() / (limit * deviation);
        let excess = energy.max(spike).max(gain);
        if excess > 1.0 && worst.is_none_or(|(most, ..)| excess > most) {
            let largest = of(&|other| other.energy / other.expected)
                .into_iter()
                .fold(0.0, f64::max);
            let at = (spike > 1.0 && spike >= gain).then_some(one.peak.1);
            worst = Some((excess, place, largest.sqrt(), at));
        }
    }
    worst.map(|(_, place, others, index)| Odd {
        hit: left[place],
        departure: (all[place].energy / all[place].expected).sqrt(),
        others,
        figures: all[place],
        index,
    })
}

/// Returns mean and standard deviation.
fn scatter(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0)).sqrt())
}

/// Returns the number of standard deviations of `n` values by which one more value differs from
/// their mean with this probability.
fn deviations(probability: f64, n: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if beyond_student(middle, n - 1) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    high * (1.0 + 1.0 / n as f64).sqrt()
}

/// Returns the probability that a Student variable is beyond `t` on either side, as a finite sum
/// for a whole number of degrees of freedom (M. Abramowitz and I. A. Stegun, *Handbook of
/// Mathematical Functions*, 26.7.3 and 26.7.4). Absolute error 1e-15.
pub(super) fn beyond_student(t: f64, degrees: usize) -> f64 {
    let law = StudentsT::new(0.0, 1.0, degrees as f64).ok();
    let law = law.filter(|_| !t.is_nan());
    law.map_or(f64::NAN, |law| 2.0 * law.sf(t))
}

/// Sums of the spectra of several hits.
struct Sums {
    inputs: Vec<f64>,
    crosses: Lines,
}

impl Sums {
    fn of(hits: &[usize], inputs: &[Lines], outputs: &[Lines]) -> Self {
        let n_lines = inputs.first().map_or(0, Vec::len);
        let mut sums = Self {
            inputs: vec![0.0; n_lines],
            crosses: vec![Complex64::ZERO; n_lines],
        };
        for hit in hits {
            let lines = inputs[*hit].iter().zip(&outputs[*hit]);
            let slots = sums.inputs.iter_mut().zip(&mut sums.crosses);
            for ((input, cross), (x, y)) in slots.zip(lines) {
                *input += x.norm_sqr();
                *cross += x.conj() * y;
            }
        }
        sums
    }

    /// Returns the departure of a hit, which is included in the sums, from the response of all
    /// others.
    fn departure(&self, x: &Lines, y: &Lines, n_samples: usize) -> Departure {
        let sums = self.inputs.iter().zip(&self.crosses);
        let expected: Lines = sums
            .zip(x.iter().zip(y))
            .map(|((input, cross), (x, y))| {
                let others = input - x.norm_sqr();
                if others > 0.0 {
                    (cross - x.conj() * y) / others * x
                } else {
                    Complex64::ZERO
                }
            })
            .collect();
        let energy: f64 = expected.iter().map(Complex64::norm_sqr).sum();
        let products: Lines = expected.iter().zip(y).map(|(p, y)| p.conj() * y).collect();
        let scale = products.iter().map(|product| product.re).sum::<f64>() / energy;
        let departure = |scale: f64| -> Lines {
            let pairs = y.iter().zip(&expected);
            pairs.map(|(y, p)| y - p * scale).collect()
        };
        let square = |lines: &Lines| -> f64 { lines.iter().map(Complex64::norm_sqr).sum() };
        let rest = departure(scale);
        Departure {
            expected: energy,
            scale,
            energy: square(&departure(1.0)),
            rest: square(&rest),
            peak: largest(&dft::inverse(&rest, n_samples)),
            lag: {
                let (top, at) = largest(&dft::inverse(&products, n_samples));
                // the two-sided spectrum divided by the number of samples; an output of pure noise
                // has no correlation at any delay
                let most = (energy * square(y)).sqrt() * 2.0 / n_samples as f64;
                let at = if top > LEAST_LIKENESS * most { at } else { 0 };
                let at = i64::try_from(at).unwrap_or(0);
                let n = i64::try_from(n_samples).unwrap_or(i64::MAX);
                if 2 * at > n { at - n } else { at }
            },
        }
    }
}

/// Returns the largest magnitude and its index.
fn largest(samples: &[f64]) -> (f64, usize) {
    let places = samples.iter().map(|x| x.abs()).zip(0..);
    places.fold((0.0, 0), |top, one| if one.0 > top.0 { one } else { top })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_of_student_are_those_of_tables() {
        // the two-sided 1 % points of 1 to 5 degrees of freedom
        for (degrees, t) in [
            (1, 63.6567),
            (2, 9.92484),
            (3, 5.84091),
            (4, 4.60409),
            (5, 4.03214),
        ] {
            let tail = beyond_student(t, degrees);
            // tolerance: t is given to six digits
            assert!((tail - 0.01).abs() < 1e-6, "{degrees}: {tail}");
        }
        // with 10 others: 4.781 is the 0.1 % point of 9 degrees of freedom
        assert!((deviations(1e-3, 10) - 4.78091 * 1.1_f64.sqrt()).abs() < 1e-4);
    }
}
