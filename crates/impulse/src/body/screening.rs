//! Screening of a measured mobility for physical consistency.

mod finding;

pub use finding::{
    Causality, DelayCheck, FrontLimit, MassCheck, Passivity, Screening, ScreeningFlag,
};

use std::f64::consts::PI;
use std::ops::Range;

use super::{LowFrequency, MeasuredBody};
use crate::fourier;
use finding::{LEVEL, below};
use num_complex::Complex64;

/// Number of standard uncertainties of the delay; a line that a delay within this range would make
/// passive does not count as active.
const DELAYS: f64 = 3.0;

/// Number of standard uncertainties of scale and weighed mass within which the mass of the
/// rigid-body motion is chosen so that least energy is before the impulse.
const SCALES: f64 = 3.0;

/// Numbers of neighbouring lines whose mean real part is tested.
const WIDTHS: [usize; 3] = [1, 8, 64];

/// Number of halvings and doublings in the search for the least detectable delay.
const DELAY_STEPS: i32 = 16;

/// Number of excluded lags next to the impulse, over which the roll-off smears jumps.
const NEAR_IMPULSE: usize = 4;

/// Fraction of the magnitude attributed to rounding: a real part counts as negative only if it is
/// below minus this fraction.
const ROUNDING: f64 = 1e-9;

/// Phase error at the last nearly rigid line, for the tolerance of the delay: up to 1.3e-3 for rods
/// of constant loss factor and for two masses with a spring.
const DELAY_TOLERANCE: f64 = 1.5e-3;

/// Number of terms of the law fitted to the real part of nearly rigid lines, and to their phase.
const TERMS: usize = 3;

/// Number of lines averaged for the first estimate of the end of the nearly rigid lines.
const SMOOTH: usize = 5;

/// Fewest nearly rigid lines: one more than the fitted terms.
const FEWEST_RIGID: usize = TERMS + 1;

/// Ratio of real to imaginary part below which the lowest lines count as those of a rigid or a
/// fixed body.
const RIGID: f64 = 0.5;

/// Fewest resonance spacings from which the scatter of their means is found.
const FEWEST_SPACINGS: usize = 3;

/// Smallest rise and fall of a curve about an extremum that counts as a resonance: as a factor, and
/// as a fraction of the mean of the curve ([`LEAST_SWING`]). Without the latter, the noise of low
/// lines about zero would cause many spurious extrema.
const SWING: f64 = 1.5;
const LEAST_SWING: f64 = 0.3;

/// Fraction of its initial value to which the accelerance has fallen (or risen correspondingly) at
/// the last line used for the mass.
const NEARLY_RIGID: f64 = 0.85;

impl MeasuredBody {
    /// Tests the mobility for causality, passivity, the mass at low frequency, and the front
    /// impedance at high frequency.
    #[must_use]
    pub fn screen(&self) -> Screening {
        let (mass, delay) = self.rigid_lines();
        Screening {
            causality: self.causality(self.conductance()),
            passivity: self.passivity(),
            mass,
            delay,
            front: self.front_limit(),
            scale_error: self.scale_error(),
            free: matches!(self.low_frequency(), LowFrequency::Free(_)),
            n_judged: self.mobility().len(),
        }
    }

    fn causality(&self, conductance: f64) -> Causality {
        let remainder = self.remainder(conductance);
        let n_samples = 2 * (remainder.len() - 1);
        let near = NEAR_IMPULSE.min(n_samples / 8);
        let ahead_of_impulse = n_samples / 2..n_samples - near;
        let mut samples = rolled_off(&remainder);
        self.take_rigid(&mut samples, ahead_of_impulse.clone());
        // relative to the largest sample, so that no square overflows or underflows
        let largest = samples.iter().fold(0.0_f64, |top, g| top.max(g.abs()));
        if largest > 0.0 {
            samples.iter_mut().for_each(|g| *g /= largest);
        }
        let energy = |samples: &[f64]| samples.iter().map(|g| g * g).sum::<f64>();
        let ahead = samples.get(ahead_of_impulse);
        let ahead = energy(ahead.unwrap_or_default());
        let all = energy(samples.get(near..n_samples - near).unwrap_or_default());
        let share = |part: f64| if all > 0.0 { part / all } else { 0.0 };
        let expected_from_noise = self.variance().map(|variances| {
            let lines = variances.iter().enumerate();
            let noise: f64 = lines
                .map(|(line, variance)| {
                    2.0 * variance / largest / largest * roll_off(line, remainder.len()).powi(2)
                })
                .sum();
            // the noise is distributed evenly over the period; the samples are unscaled sums over
            // both sides of the spectrum
            share(noise * (n_samples / 2 - near) as f64)
        });
        Causality {
            acausal_part: share(ahead),
            expected_from_noise,
        }
    }

    /// Removes from `samples` the part of the rigid-body motion that an error of the scale or of
    /// the weighed mass leaves in them.
    ///
    /// Lines with the relative error e of their scale and a mass with the relative error d leave
    /// $`(e + d)/(i\omega M)`$ after the rigid-body motion is removed: a step of half
    /// $`(e + d)/M`$ on either side of the impulse, which decreases linearly over half a period.
    /// $`e + d`$ is found from the samples `ahead` of the impulse, within the stated uncertainties.
    fn take_rigid(&self, samples: &mut [f64], ahead: Range<usize>) {
        let LowFrequency::Free(weighed) = self.low_frequency() else {
            return;
        };
        let most = SCALES
            * self
                .scale_error()
                .hypot(weighed.standard_error / weighed.mass);
        if most <= 0.0 {
            return;
        }
        let lines = 0..self.mobility().len();
        let rigid = rolled_off(&lines.map(|line| self.rigid(line)).collect::<Vec<_>>());
        // relative to the largest sample, so that no square overflows or underflows
        let largest = rigid.iter().fold(0.0_f64, |top, g| top.max(g.abs()));
        let (mut product, mut square) = (0.0, 0.0);
        for (sample, rigid) in samples.iter().zip(&rigid).take(ahead.end).skip(ahead.start) {
            let rigid = rigid / largest;
            product += sample / largest * rigid;
            square += rigid * rigid;
        }
        let error = (product / square).clamp(-most, most);
        if error.is_finite() {
            for (sample, rigid) in samples.iter_mut().zip(&rigid) {
                *sample -= error * rigid;
            }
        }
    }

    /// Finds the front impedance from the mean of Re G over whole resonance spacings: the mean of
    /// $`\operatorname{Re}\coth\gamma L`$ over one spacing is 1 for any damping.
    fn front_limit(&self) -> Option<FrontLimit> {
        // the real part of nearly rigid lines is noise
        let lines = self.mobility().iter().skip(1);
        let real: Vec<f64> = lines
            .skip_while(|line| line.re.abs() < RIGID * line.im.abs())
            .map(|line| line.re)
            .collect();
        // the resonances of a reversed sensor are negative
        let sign = real.iter().sum::<f64>().signum();
        let turns = turns(&real.iter().map(|re| sign * re).collect::<Vec<f64>>());
        let means: Vec<f64> = turns
            .windows(2)
            .filter_map(|pair| match pair {
                [from, to] => real.get(*from..*to),
                _ => None,
            })
            .map(|spacing| spacing.iter().sum::<f64>() / spacing.len() as f64)
            .collect();
        let n_spacings = means.len();
        if n_spacings < FEWEST_SPACINGS {
            return None;
        }
        let count = n_spacings as f64;
        let mean = means.iter().sum::<f64>() / count;
        let square = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        let standard_error = (square / (count - 1.0) / count).sqrt();
        Some(FrontLimit {
            apparent: 1.0 / mean,
            standard_error: standard_error / (mean * mean),
            n_spacings,
            given: self.given_front(),
        })
    }

    fn passivity(&self) -> Passivity {
        let (active_lines, worst) = self.active(0.0);
        let seen_delays = [-1.0, 1.0].map(|sign| {
            if active_lines > 0 {
                return None;
            }
            let highest = PI / self.omega(self.mobility().len() - 1);
            let is_seen = |delay: f64| self.active(sign * delay).0 > 0;
            let first = (0..=DELAY_STEPS)
                .rev()
                .map(|halvings| highest * 0.5_f64.powi(halvings))
                .find(|delay| is_seen(*delay))?;
            // four halvings find the delay to a few percent
            let (mut unseen, mut seen) = (0.5 * first, first);
            for _ in 0..4 {
                let middle = 0.5 * (unseen + seen);
                if is_seen(middle) {
                    seen = middle;
                } else {
                    unseen = middle;
                }
            }
            Some(seen)
        });
        Passivity {
            active_lines,
            worst,
            seen_delays,
        }
    }

    /// Number of lines that generate energy if the motion is delayed by a further `delay` \[s\],
    /// and the worst of them.
    fn active(&self, delay: f64) -> (usize, Option<(usize, f64)>) {
        let turned = |(line, value): (usize, &Complex64)| {
            let value = value * Complex64::cis(-self.omega(line) * delay);
            let allowed = DELAYS * self.omega(line) * self.delay_error() * value.norm();
            (value.re + allowed, ROUNDING * value.norm())
        };
        let real: Vec<(f64, f64)> = self.mobility().iter().enumerate().map(turned).collect();
        let mut active = vec![false; real.len()];
        let mut worst: Option<(usize, f64)> = None;
        let mut add = |from: usize, to: usize, line: usize, distance: f64| {
            for slot in active.iter_mut().take(to).skip(from) {
                *slot = true;
            }
            if worst.is_none_or(|(_, worst)| distance > worst) {
                worst = Some((line, distance));
            }
        };
        let Some(variances) = self.variance() else {
            for (line, (value, rounding)) in real.iter().enumerate().skip(1) {
                if value < &-rounding {
                    add(line, line + 1, line, -value * ROUNDING / rounding);
                }
            }
            return (active.iter().filter(|line| **line).count(), worst);
        };
        let lines: Vec<(f64, f64, f64, f64)> = real
            .iter()
            .zip(variances)
            .zip(self.freedom())
            // half of the variance belongs to the real part
            .map(|(((value, rounding), variance), freedom)| {
                let square = 0.5 * variance;
                (*value, square, square * square / freedom, *rounding)
            })
            .collect();
        let n_trials: usize = WIDTHS.iter().map(|width| lines.len() / width).sum();
        for width in WIDTHS {
            for (index, window) in lines.chunks_exact(width).enumerate() {
                let mut sums = [0.0; 4];
                for (value, square, by_freedom, rounding) in window {
                    sums[0] += value;
                    sums[1] += square;
                    sums[2] += by_freedom;
                    sums[3] += rounding;
                }
                let [value, square, by_freedom, rounding] = sums;
                if value >= -rounding {
                    continue;
                }
                let distance = value / square.sqrt();
                // lines without variance have an infinite distance and are included
                if below(distance, square * square / by_freedom) < LEVEL / n_trials as f64 {
                    let from = index * width;
                    add(from, from + width, from + width / 2, -distance);
                }
            }
        }
        (active.iter().filter(|line| **line).count(), worst)
    }

    /// Finds mass and delay from the measured nearly rigid lines of a free body: least squares of
    /// the real part of iωG with the terms 1, ω², ω⁴, and of its phase with ω, ω², ω⁴.
    fn rigid_lines(&self) -> (Option<MassCheck>, Option<DelayCheck>) {
        let LowFrequency::Free(weighed) = self.low_frequency() else {
            return (None, None);
        };
        let lines = self.mobility().iter().enumerate();
        let accelerance: Vec<(f64, Complex64)> = lines
            .skip(self.first_measured().max(1))
            .map(|(line, value)| {
                let omega = self.omega(line);
                (omega, Complex64::new(0.0, omega) * value)
            })
            .collect();
        let Some((unit, _)) = accelerance.last().copied() else {
            return (None, None);
        };
        let smooth: Vec<f64> = accelerance
            .windows(SMOOTH)
            .map(|near| near.iter().map(|(_, a)| a.re).sum::<f64>() / SMOOTH as f64)
            .collect();
        let Some(start) = smooth.first() else {
            return (None, None);
        };
        let above = smooth
            .iter()
            .take_while(|mean| *mean / start > NEARLY_RIGID);
        let mut n_lines = above.count() + SMOOTH - 1;
        // the end of the nearly rigid lines follows from the fit, because a single line is noisy
        let mut fitted = None;
        for _ in 0..5 {
            let rigid = accelerance.get(..n_lines).unwrap_or_default();
            let even = rigid.iter().map(|(omega, a)| {
                let square = (omega / unit).powi(2);
                ([1.0, square, square * square], a.re)
            });
            let Some(fit) = Fit::of(even) else {
                return (None, None);
            };
            let [p, q, r] = fit.terms;
            n_lines = accelerance
                .iter()
                .take_while(|(omega, _)| {
                    let square = (omega / unit).powi(2);
                    ((q * square + r * square * square) / p).abs() < 1.0 - NEARLY_RIGID
                })
                .count()
                .max(FEWEST_RIGID);
            fitted = Some((fit, rigid));
        }
        let Some((fit, rigid)) = fitted else {
            return (None, None);
        };
        let [intercept, ..] = fit.terms;
        let scale = self.scale_error() * weighed.mass;
        let of_mass = |error: f64| error / (intercept * intercept);
        let by_scatter = (of_mass(fit.error), fit.degrees_of_freedom);
        let variances = self.accelerance_variances(rigid.len().max(SMOOTH));
        let by_variance = variances.as_ref().map(|variances| {
            let (error, freedom) = of_sum(&fit.weights, variances);
            (of_mass(error), freedom)
        });
        // variances of 0 do not mean that the lines are exact
        let by_variance = by_variance.filter(|(error, _)| error.is_finite() && *error > 0.0);
        let (standard_error, degrees_of_freedom) = match by_variance {
            Some(own) if own.0 < by_scatter.0 => own,
            _ => by_scatter,
        };
        let lowest = variances.as_ref().and_then(|variances| {
            let (error, freedom) = of_sum(&[1.0 / SMOOTH as f64; SMOOTH], variances);
            (error > 0.0 && *start > 0.0).then(|| [1.0 / start, error / start / start, freedom])
        });
        let mass = MassCheck {
            apparent: 1.0 / intercept,
            standard_error,
            degrees_of_freedom,
            weighed: (weighed.mass, weighed.standard_error.hypot(scale)),
            n_lines: rigid.len(),
            by_scatter,
            by_variance,
            lowest,
        };
        let phase = rigid.iter().map(|(omega, a)| {
            let x = omega / unit;
            ([x, x * x, x.powi(4)], (a / intercept).arg())
        });
        let delay = Fit::of(phase).map(|fit| {
            let [slope, ..] = fit.terms;
            DelayCheck {
                delay: -slope / unit,
                standard_error: (fit.error / unit).hypot(self.delay_error()),
                degrees_of_freedom: fit.degrees_of_freedom,
                tolerance: rigid
                    .last()
                    .map_or(0.0, |(omega, _)| DELAY_TOLERANCE / omega),
            }
        });
        (Some(mass), delay)
    }

    /// Returns the variance of the real part of iωG of the first `n_lines` measured lines, with its
    /// degrees of freedom; `None` without variances.
    fn accelerance_variances(&self, n_lines: usize) -> Option<Vec<(f64, f64)>> {
        let lines = self.variance()?.iter().zip(self.freedom()).enumerate();
        let measured = lines.skip(self.first_measured().max(1)).take(n_lines);
        // half of the variance belongs to the real part
        let of_real = measured.map(|(line, (variance, freedom))| {
            let omega = self.omega(line);
            (0.5 * omega * omega * variance, *freedom)
        });
        Some(of_real.collect())
    }
}

/// Returns the standard error of a weighted sum of independent values with these variances, and its
/// degrees of freedom.
fn of_sum(weights: &[f64], variances: &[(f64, f64)]) -> (f64, f64) {
    let (mut sum, mut by_freedom) = (0.0, 0.0);
    for (weight, (variance, freedom)) in weights.iter().zip(variances) {
        let part = weight * weight * variance;
        sum += part;
        by_freedom += part * part / freedom;
    }
    (sum.sqrt(), sum * sum / by_freedom)
}

/// Returns the factor of a line by which the lines are rolled off towards the last of `n_lines`.
fn roll_off(line: usize, n_lines: usize) -> f64 {
    0.5 + 0.5 * (PI * line as f64 / (n_lines - 1) as f64).cos()
}

/// Returns the impulse response of rolled-off `lines`, summed over both sides of the spectrum.
fn rolled_off(lines: &[Complex64]) -> Vec<f64> {
    let rolled: Vec<Complex64> = lines
        .iter()
        .enumerate()
        .map(|(line, value)| value * roll_off(line, lines.len()))
        .collect();
    fourier::to_samples(&rolled, 2 * (rolled.len() - 1))
}

/// Least squares with three terms.
struct Fit {
    terms: [f64; TERMS],
    /// Weights of the values in the first term.
    weights: Vec<f64>,
    /// Standard error of the first term, from the scatter.
    error: f64,
    degrees_of_freedom: f64,
}

impl Fit {
    /// Fits rows to their values by modified Gram-Schmidt orthogonalisation from the last term to
    /// the first, of which the part independent of the other terms remains. Returns `None` for
    /// fewer than [`FEWEST_RIGID`] rows or for dependent terms.
    fn of(rows: impl Iterator<Item = ([f64; TERMS], f64)>) -> Option<Self> {
        let (mut columns, mut values) = ([const { Vec::new() }; TERMS], Vec::new());
        for (row, value) in rows {
            for (column, x) in columns.iter_mut().zip(row) {
                column.push(x);
            }
            values.push(value);
        }
        let n_rows = values.len();
        if n_rows < FEWEST_RIGID {
            return None;
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let take = |from: &mut [f64], part: f64, of: &[f64]| {
            for (value, x) in from.iter_mut().zip(of) {
                *value -= part * x;
            }
        };
        let [mut first, mut second, third] = columns;
        let of_third = dot(&third, &third);
        let second_by_third = dot(&second, &third) / of_third;
        take(&mut second, second_by_third, &third);
        let first_by_third = dot(&first, &third) / of_third;
        take(&mut first, first_by_third, &third);
        let of_second = dot(&second, &second);
        let first_by_second = dot(&first, &second) / of_second;
        take(&mut first, first_by_second, &second);
        let of_first = dot(&first, &first);
        let c = dot(&values, &third) / of_third;
        take(&mut values, c, &third);
        let b = dot(&values, &second) / of_second;
        take(&mut values, b, &second);
        let a = dot(&values, &first) / of_first;
        take(&mut values, a, &first);
        let degrees_of_freedom = (n_rows - TERMS) as f64;
        let error = (dot(&values, &values) / degrees_of_freedom / of_first).sqrt();
        let b = b - a * first_by_second;
        let c = c - a * first_by_third - b * second_by_third;
        let fit = Self {
            terms: [a, b, c],
            weights: first.iter().map(|x| x / of_first).collect(),
            error,
            degrees_of_freedom,
        };
        (fit.error.is_finite() && [a, b, c].iter().all(|term| term.is_finite())).then_some(fit)
    }
}

/// Returns the indices of the maxima or of the minima, whichever are more numerous, between which
/// the curve varies by at least a factor [`SWING`]: neighbours are one resonance spacing apart.
fn turns(curve: &[f64]) -> Vec<usize> {
    let least = LEAST_SWING * curve.iter().sum::<f64>() / curve.len() as f64;
    let (mut highest, mut lowest) = (Vec::new(), Vec::new());
    let (mut top, mut bottom) = ((0, f64::NEG_INFINITY), (0, f64::INFINITY));
    // unknown before the first extremum
    let mut rising: Option<bool> = None;
    for (index, &value) in curve.iter().enumerate() {
        if value > top.1 {
            top = (index, value);
        }
        if value < bottom.1 {
            bottom = (index, value);
        }
        let fallen = value * SWING < top.1 && value + least < top.1;
        let risen = value > SWING * bottom.1.max(0.0) && value > bottom.1 + least;
        if rising != Some(false) && fallen {
            if rising == Some(true) {
                highest.push(top.0);
            }
            rising = Some(false);
            bottom = (index, value);
        } else if rising != Some(true) && risen {
            if rising == Some(false) {
                lowest.push(bottom.0);
            }
            rising = Some(true);
            top = (index, value);
        }
    }
    if highest.len() >= lowest.len() {
        highest
    } else {
        lowest
    }
}
