//! Screening of a measured mobility for physical consistency.

use std::f64::consts::PI;
use std::fmt;

use num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::{LowFrequency, MeasuredBody};
use crate::fourier;

/// Number of standard errors attributed to chance.
const COVERAGE: f64 = 4.0;

/// Probability of a false alarm for a faultless body, for each of the three tests: energy
/// generation, mass, and delay.
const LEVEL: f64 = 0.01;

/// Degrees of freedom above which Student's distribution is normal to three digits of the relevant
/// tails.
const MANY: f64 = 1e5;

/// Numbers of neighbouring lines whose mean real part is tested.
const WIDTHS: [usize; 3] = [1, 8, 64];

/// Number of halvings and doublings in the search for the least detectable delay.
const DELAY_STEPS: i32 = 16;

/// Largest acausal part of the energy without a variance.
const ACAUSAL: f64 = 0.01;

/// Number of excluded lags next to the impulse, over which the roll-off smears jumps.
const NEAR_IMPULSE: usize = 4;

/// Fraction of the magnitude below minus which a real part counts as negative (rounding).
const ROUNDING: f64 = 1e-9;

/// Relative mass error of the fitted law on nearly rigid lines: the neglected terms for rods of
/// constant loss factor and for two masses with a spring are up to 8e-4.
const MASS_TOLERANCE: f64 = 1e-3;

/// Phase error at the last nearly rigid line in the delay: up to 1.3e-3 for the same bodies.
const DELAY_TOLERANCE: f64 = 1.5e-3;

/// Standard errors in addition to such a tolerance.
const BESIDE_TOLERANCE: f64 = 2.0;

/// Number of terms of the law fitted to the real part of nearly rigid lines, and to their phase.
const TERMS: usize = 3;

/// Number of lines averaged for the first estimate of the end of the nearly rigid lines.
const SMOOTH: usize = 5;

/// Fewest nearly rigid lines: one more than the fitted terms.
const FEWEST_RIGID: usize = TERMS + 1;

/// Real over imaginary part below which the lowest lines are those of a rigid or a fixed body.
const RIGID: f64 = 0.5;

/// Fewest resonance spacings for a scatter of their means.
const FEWEST_SPACINGS: usize = 3;

/// Factor by which a curve must rise and fall for an extremum to be that of a resonance, and
/// fraction of its mean, without which noise of low lines about zero would cause extrema all the
/// time.
const SWING: f64 = 1.5;
const LEAST_SWING: f64 = 0.3;

/// Fraction of its initial value to which the accelerance has fallen (or risen correspondingly) at
/// the last line used for the mass.
const NEARLY_RIGID: f64 = 0.85;

/// Relative deviation of the front impedance that is never flagged: the impedance of a polymer
/// increases by as much over the lines.
const FRONT_TOLERANCE: f64 = 0.1;

/// Energy before the impulse.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Causality {
    /// $`\sum_{t<0}g^2/\sum g^2`$ of the impulse response without rigid-body motion and
    /// instantaneous response, with lines rolled off.
    pub acausal_part: f64,
    /// The part expected from the variances; `None` without variances.
    pub expected_from_noise: Option<f64>,
}

/// Lines that generate energy.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Passivity {
    /// Number of lines that are negative beyond chance, individually or in the mean with 7 or 63
    /// neighbours: one faultless body in a hundred has one (without variances: negative beyond
    /// rounding).
    pub active_lines: usize,
    /// The most negative line: its index, and its distance from zero in standard errors, or in its
    /// magnitude without variances.
    pub worst: Option<(usize, f64)>,
    /// Least delays \[s\] of the motion relative to the force, before or after, for which an
    /// inactive line would become active; `None` if no delay below half the period of the
    /// highest line is detectable.
    pub seen_delays: [Option<f64>; 2],
}

/// Delay between force and motion from the nearly rigid lines of a free body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DelayCheck {
    /// Delay \[s\] of the motion after the force, by least squares of $`\arg(i\omega G) =
    /// -\omega\tau + b\omega^2 + c\omega^4`$: losses begin with the second order.
    pub delay: f64,
    /// Standard error of the delay \[s\], from the scatter of the lines.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: f64,
    /// Possible error due to neglected orders \[s\].
    pub tolerance: f64,
}

impl DelayCheck {
    /// Least delay \[s\] that is flagged.
    #[must_use]
    pub fn least_seen(&self) -> f64 {
        least_doubted(self.standard_error, self.degrees_of_freedom, self.tolerance)
    }
}

/// Distance that chance exceeds with the probability of the level, or a tolerance with some
/// standard errors if that is greater.
fn least_doubted(standard_error: f64, freedom: f64, tolerance: f64) -> f64 {
    let by_chance = standard_error * quantile(1.0 - 0.5 * LEVEL, freedom);
    by_chance.max(tolerance + BESIDE_TOLERANCE * standard_error)
}

/// Mass from the low lines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MassCheck {
    /// The mass \[kg\] in the low-frequency expansion $`\operatorname{Re}(i\omega G) = (1 -
    /// e\omega^2 - g\omega^4)/M`$, by least squares over the measured lines.
    pub apparent: f64,
    /// Standard error of the mass \[kg\], from the scatter of the lines.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: f64,
    /// The weighed mass \[kg\] and its standard error, including that of the scale of the lines.
    pub weighed: (f64, f64),
    /// Number of lines used.
    pub n_lines: usize,
}

/// Instantaneous response of the face.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrontLimit {
    /// Impedance [kg/s] from the mean real part over whole resonance spacings, in which
    /// reflections from inside the body cancel; negative or infinite if the mean is negative
    /// or zero.
    pub apparent: f64,
    /// Standard error of the impedance [kg/s], from the scatter of the means between spacings.
    pub standard_error: f64,
    /// Number of spacings.
    pub n_spacings: usize,
    /// Given impedance [kg/s], if any.
    pub given: Option<f64>,
}

/// Result of [`MeasuredBody::screen`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Screening {
    /// Energy before the impulse.
    pub causality: Causality,
    /// Lines that generate energy.
    pub passivity: Passivity,
    /// The mass; `None` if the body is not free or too few lines are nearly rigid.
    pub mass: Option<MassCheck>,
    /// A delay between the channels; `None` if the body is not free or too few lines are nearly
    /// rigid.
    pub delay: Option<DelayCheck>,
    /// The instantaneous response; `None` if the lines contain fewer than three resonance
    /// spacings.
    pub front: Option<FrontLimit>,
    free: bool,
    n_judged: usize,
}

/// A fault of a measured mobility.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ScreeningFlag {
    /// Excess energy before the impulse: a delay between the channels, leakage, or ringing longer
    /// than the period.
    Acausal {
        /// The part found.
        part: f64,
        /// The part allowed.
        allowed: f64,
    },
    /// Lines that generate energy: a wrong sign, a phase error, or not the driving point.
    Active {
        /// Number of lines.
        lines: usize,
        /// Index of the worst line.
        worst_line: usize,
        /// Distance of the worst line from zero, in standard errors (in its magnitude without
        /// variances).
        worst: f64,
    },
    /// The nearly rigid lines have the phase of a delay between the channels.
    Delayed {
        /// Delay of the motion after the force \[s\]; negative if it is before.
        delay: f64,
        /// Standard error of the delay \[s\].
        standard_error: f64,
    },
    /// The mass of the low lines differs from the weighed one: a wrong sensitivity, a body that is
    /// not free, or a mass between gauge and face.
    MassContradicted {
        /// Mass from the mobility \[kg\].
        apparent: f64,
        /// Standard error of the difference \[kg\].
        standard_error: f64,
        /// Weighed mass \[kg\].
        weighed: f64,
    },
    /// No line of a free body is below its first antiresonance, so that its mass cannot be checked.
    MassNotSeen,
    /// The mean impedance of the lines differs from that of the material: a wrong sensitivity, or
    /// another section at the face.
    FrontContradicted {
        /// Impedance from the mobility [kg/s].
        apparent: f64,
        /// Standard error of that impedance [kg/s].
        standard_error: f64,
        /// Given impedance [kg/s].
        given: f64,
    },
    /// The lines give no positive impedance.
    FrontNotPositive {
        /// Mean real part \[m/(N s)\].
        mean: f64,
    },
}

impl fmt::Display for ScreeningFlag {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Acausal { part, allowed } => write!(
                formatter,
                "{part:.2e} of the energy stands ahead of the impulse, {allowed:.2e} are allowed"
            ),
            Self::Active {
                lines,
                worst_line,
                worst,
            } => write!(
                formatter,
                "{lines} lines generate energy, the worst is line {worst_line}, {worst:.1} below zero"
            ),
            Self::Delayed {
                delay,
                standard_error,
            } => write!(
                formatter,
                "the motion is {:.3} us {} the force, ± {:.2} us, by the phase of the nearly rigid lines",
                1e6 * delay.abs(),
                if *delay < 0.0 { "ahead of" } else { "behind" },
                1e6 * standard_error
            ),
            Self::MassContradicted {
                apparent,
                standard_error,
                weighed,
            } => write!(
                formatter,
                "the low lines are those of {apparent:.4} kg ± {standard_error:.1e} kg, weighed are {weighed} kg"
            ),
            Self::MassNotSeen => {
                write!(formatter, "no line is low enough to tell the mass")
            }
            Self::FrontContradicted {
                apparent,
                standard_error,
                given,
            } => write!(
                formatter,
                "the lines have a front impedance of {apparent:.4e} kg/s ± {standard_error:.1e} kg/s on the average, given are {given:.4e} kg/s"
            ),
            Self::FrontNotPositive { mean } => write!(
                formatter,
                "the real part of the lines is {mean:.2e} m/(N s) on the average"
            ),
        }
    }
}

impl Screening {
    /// Returns the faults of the measurement; empty if there are none.
    #[must_use]
    pub fn flags(&self) -> Vec<ScreeningFlag> {
        let mut flags = Vec::new();
        let causality = &self.causality;
        // the relative scatter of the energy of n independent lines is (2/n)^½
        let chance = 1.0 + COVERAGE * (2.0 / self.n_judged as f64).sqrt();
        let allowed = ACAUSAL.max(causality.expected_from_noise.unwrap_or(0.0) * chance);
        // NaN also counts as too large
        if causality.acausal_part > allowed || causality.acausal_part.is_nan() {
            flags.push(ScreeningFlag::Acausal {
                part: causality.acausal_part,
                allowed,
            });
        }
        if let (1.., Some((worst_line, worst))) =
            (self.passivity.active_lines, self.passivity.worst)
        {
            flags.push(ScreeningFlag::Active {
                lines: self.passivity.active_lines,
                worst_line,
                worst,
            });
        }
        match self.mass {
            Some(mass) => {
                let (weighed, weighed_error) = mass.weighed;
                let own = mass.standard_error * (weighed / mass.apparent).powi(2);
                let error = own.hypot(weighed_error);
                let freedom = mass.degrees_of_freedom * (error / own).powi(4);
                let allowed = least_doubted(error, freedom, MASS_TOLERANCE * weighed);
                // a negative or infinite mass is wrong for any error; the lines determine 1/M
                let difference = (weighed / mass.apparent - 1.0).abs() * weighed;
                if mass.apparent <= 0.0 || !(0.0..=allowed).contains(&difference) {
                    flags.push(ScreeningFlag::MassContradicted {
                        apparent: mass.apparent,
                        standard_error: error,
                        weighed,
                    });
                }
            }
            None if self.free => flags.push(ScreeningFlag::MassNotSeen),
            None => {}
        }
        if let Some(delay) = &self.delay
            && delay.delay.abs() > delay.least_seen()
        {
            flags.push(ScreeningFlag::Delayed {
                delay: delay.delay,
                standard_error: delay.standard_error,
            });
        }
        if let Some(front) = &self.front {
            let (apparent, standard_error) = (front.apparent, front.standard_error);
            if !(apparent.is_finite() && apparent > 0.0) {
                flags.push(ScreeningFlag::FrontNotPositive {
                    mean: 1.0 / apparent,
                });
            } else if let Some(given) = front.given
                && (apparent - given).abs() > COVERAGE * standard_error + FRONT_TOLERANCE * given
            {
                flags.push(ScreeningFlag::FrontContradicted {
                    apparent,
                    standard_error,
                    given,
                });
            }
        }
        flags
    }
}

impl MeasuredBody {
    /// Tests the mobility for properties of every body: causality, passivity, its mass at low and
    /// its front impedance at high frequency.
    #[must_use]
    pub fn screen(&self) -> Screening {
        let (mass, delay) = self.rigid_lines();
        Screening {
            causality: self.causality(self.conductance()),
            passivity: self.passivity(),
            mass,
            delay,
            front: self.front_limit(),
            free: matches!(self.low_frequency(), LowFrequency::Free(_)),
            n_judged: self.mobility().len(),
        }
    }

    fn causality(&self, conductance: f64) -> Causality {
        let remainder = self.remainder(conductance);
        let last = (remainder.len() - 1) as f64;
        let roll_off = |line: usize| 0.5 + 0.5 * (PI * line as f64 / last).cos();
        let rolled: Vec<Complex64> = remainder
            .iter()
            .enumerate()
            .map(|(line, value)| value * roll_off(line))
            .collect();
        let n_samples = 2 * (rolled.len() - 1);
        let mut samples = fourier::to_samples(&rolled, n_samples);
        // relative to the largest: no square then overflows or underflows
        let largest = samples.iter().fold(0.0_f64, |top, g| top.max(g.abs()));
        if largest > 0.0 {
            samples.iter_mut().for_each(|g| *g /= largest);
        }
        let energy = |samples: &[f64]| samples.iter().map(|g| g * g).sum::<f64>();
        let near = NEAR_IMPULSE.min(n_samples / 8);
        let ahead = samples.get(n_samples / 2..n_samples - near);
        let ahead = energy(ahead.unwrap_or_default());
        let all = energy(samples.get(near..n_samples - near).unwrap_or_default());
        let share = |part: f64| if all > 0.0 { part / all } else { 0.0 };
        let expected_from_noise = self.variance().map(|variances| {
            let lines = variances.iter().enumerate();
            let noise: f64 = lines
                .map(|(line, variance)| 2.0 * variance / largest / largest * roll_off(line).powi(2))
                .sum();
            // distributed evenly over the period; samples are unscaled sums over both sides
            share(noise * (n_samples / 2 - near) as f64)
        });
        Causality {
            acausal_part: share(ahead),
            expected_from_noise,
        }
    }

    /// Mean of Re G over whole resonance spacings: the mean of $`\operatorname{Re}\coth\gamma L`$
    /// over each is 1 for any damping.
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
            // to a few percent
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
            (value.re, ROUNDING * value.norm())
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
                // also an infinite distance for lines without variance
                if below(distance, square * square / by_freedom) < LEVEL / n_trials as f64 {
                    let from = index * width;
                    add(from, from + width, from + width / 2, -distance);
                }
            }
        }
        (active.iter().filter(|line| **line).count(), worst)
    }

    /// Mass and delay from the measured nearly rigid lines of a free body: least squares of the
    /// real part of iωG by even powers of ω, and of its phase by the others.
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
        // the fit, not the noise of one line, determines the end of the lines
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
        let mass = MassCheck {
            apparent: 1.0 / intercept,
            standard_error: fit.error / (intercept * intercept),
            degrees_of_freedom: fit.degrees_of_freedom,
            weighed: (weighed.mass, weighed.standard_error.hypot(scale)),
            n_lines: rigid.len(),
        };
        let phase = rigid.iter().map(|(omega, a)| {
            let x = omega / unit;
            ([x, x * x, x.powi(4)], (a / intercept).arg())
        });
        let delay = Fit::of(phase).map(|fit| {
            let [slope, ..] = fit.terms;
            DelayCheck {
                delay: -slope / unit,
                standard_error: fit.error / unit,
                degrees_of_freedom: fit.degrees_of_freedom,
                tolerance: rigid
                    .last()
                    .map_or(0.0, |(omega, _)| DELAY_TOLERANCE / omega),
            }
        });
        (Some(mass), delay)
    }
}

/// Least squares by three terms.
struct Fit {
    terms: [f64; TERMS],
    /// Standard error of the first term, from the scatter.
    error: f64,
    degrees_of_freedom: f64,
}

impl Fit {
    /// Fits rows and their values: modified Gram-Schmidt from the last term to the first, whose
    /// independent part remains at the end. `None` if the number of rows is less than that of
    /// terms plus two, or for dependent terms.
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
            error,
            degrees_of_freedom,
        };
        (fit.error.is_finite() && [a, b, c].iter().all(|term| term.is_finite())).then_some(fit)
    }
}

/// Probability of Student's distribution below `value`.
fn below(value: f64, freedom: f64) -> f64 {
    if value.is_nan() {
        f64::NAN
    } else if freedom < MANY {
        StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |law| law.cdf(value))
    } else {
        Normal::standard().cdf(value)
    }
}

/// Quantile that Student's distribution exceeds with the probability 1 - `probability`.
fn quantile(probability: f64, freedom: f64) -> f64 {
    if freedom < MANY {
        let law = StudentsT::new(0.0, 1.0, freedom);
        law.map_or(f64::INFINITY, |law| law.inverse_cdf(probability))
    } else {
        Normal::standard().inverse_cdf(probability)
    }
}

/// Indices of the maxima or minima, whichever are more, of a curve that varies by at least
/// [`SWING`]: neighbours are one resonance spacing apart.
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
