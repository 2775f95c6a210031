//! Whether a measured mobility can be that of a body.

use std::f64::consts::PI;
use std::fmt;

use num_complex::Complex64;

use super::measured::FEWEST_LINES;
use super::{LowFrequency, MeasuredBody};
use crate::fourier;

/// Standard errors that chance is allowed: of a thousand lines without fault, one in sixteen thousand is flagged.
const COVERAGE: f64 = 4.0;

/// Without a variance: part of the energy that may stand ahead of the impulse.
const ACAUSAL: f64 = 0.01;

/// Lags next to the impulse that are not judged: the roll-off smears jumps over them.
const NEAR_IMPULSE: usize = 4;

/// A real part counts as negative below minus this fraction of the magnitude (rounding).
const ROUNDING: f64 = 1e-9;

/// A mass that is off by less is never flagged: the next term of the fitted law leaves as much.
const MASS_TOLERANCE: f64 = 0.01;

/// Real over imaginary part below which the lowest lines are those of a rigid or a fixed body.
const RIGID: f64 = 0.5;

/// Fewest resonance spacings from which the scatter of their means is known.
const FEWEST_SPACINGS: usize = 3;

/// Factor by which a curve must rise and fall for a turn in it to be that of a resonance, and part of its mean, without which the noise of low lines
/// about zero would turn all the time.
const SWING: f64 = 1.5;
const LEAST_SWING: f64 = 0.3;

/// The lines that tell the mass end where the accelerance has fallen to this part of its start.
const NEARLY_RIGID: f64 = 0.6;

/// Relative deviation of the front impedance that is never flagged: the impedance of a polymer grows by as much over the lines.
const FRONT_TOLERANCE: f64 = 0.1;

/// What stands ahead of the impulse.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Causality {
    /// $`\sum_{t<0}g^2/\sum g^2`$ of the impulse response without rigid-body motion and the answer at once, its lines rolled off.
    pub acausal_part: f64,
    /// The part that the variances let expect; none without variances.
    pub expected_from_noise: Option<f64>,
}

/// Lines that generate energy.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Passivity {
    /// Number of lines whose real part is negative by more than four standard errors (or by more than rounding, without variances).
    pub active_lines: usize,
    /// The one that is furthest below zero: its line, and how far in standard errors, or in its magnitude without variances.
    pub worst: Option<(usize, f64)>,
}

/// The mass by the low lines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MassCheck {
    /// The mass \[kg\] with which $`\operatorname{Re}(i\omega G) = (1 - e\omega^2)/M`$ begins, by least squares.
    pub apparent: f64,
    /// Its standard error \[kg\], by the scatter of the lines.
    pub standard_error: f64,
    /// The weighed one \[kg\], and its standard error.
    pub weighed: (f64, f64),
    /// Number of lines that tell it.
    pub n_lines: usize,
}

/// The answer at once.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrontLimit {
    /// Impedance [kg/s] by the mean real part over whole resonance spacings, in which what returns from inside the body cancels; negative or
    /// infinite where that is.
    pub apparent: f64,
    /// Its standard error [kg/s], by the scatter of the means from spacing to spacing.
    pub standard_error: f64,
    /// Number of spacings.
    pub n_spacings: usize,
    /// The impedance [kg/s] that was given, if it was.
    pub given: Option<f64>,
}

/// What [`MeasuredBody::screen`] found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Screening {
    /// Energy ahead of the impulse.
    pub causality: Causality,
    /// Lines that generate energy.
    pub passivity: Passivity,
    /// The mass; none if the body is not free or too few lines are nearly rigid.
    pub mass: Option<MassCheck>,
    /// The answer at once; none where the lines hold fewer than three resonance spacings and cannot tell.
    pub front: Option<FrontLimit>,
    free: bool,
    n_judged: usize,
}

/// What speaks against a measured mobility.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ScreeningFlag {
    /// Too much ahead of the impulse: a delay between the channels, leakage, or ringing that the period does not hold.
    Acausal {
        /// The part found.
        part: f64,
        /// The part allowed.
        allowed: f64,
    },
    /// Lines that generate energy: a wrong sign, a phase error, or not the driving point.
    Active {
        /// How many.
        lines: usize,
        /// The worst.
        worst_line: usize,
        /// How far below zero, in standard errors (in its magnitude without variances).
        worst: f64,
    },
    /// The low lines have another mass than the balance: a wrong sensitivity, a body that is not free, or a mass between gauge
    /// and face.
    MassContradicted {
        /// By the mobility \[kg\].
        apparent: f64,
        /// Standard error of the difference \[kg\].
        standard_error: f64,
        /// By the balance \[kg\].
        weighed: f64,
    },
    /// A free body has no line below its first antiresonance, so that its mass cannot be checked.
    MassNotSeen,
    /// The lines have another impedance on the average than that of the material: a wrong sensitivity, or another section at the face.
    FrontContradicted {
        /// By the mobility [kg/s].
        apparent: f64,
        /// Its standard error [kg/s].
        standard_error: f64,
        /// Given [kg/s].
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
    /// What speaks against the measurement; empty if nothing does.
    #[must_use]
    pub fn flags(&self) -> Vec<ScreeningFlag> {
        let mut flags = Vec::new();
        let causality = &self.causality;
        // the energy of n independent lines scatters by (2/n)^½ of itself
        let chance = 1.0 + COVERAGE * (2.0 / self.n_judged as f64).sqrt();
        let allowed = ACAUSAL.max(causality.expected_from_noise.unwrap_or(0.0) * chance);
        // a part that is no number is no better
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
                let error = mass.standard_error.hypot(weighed_error);
                // a mass that is negative or infinite is wrong whatever its error
                let difference = (mass.apparent - weighed).abs();
                if mass.apparent <= 0.0
                    || !(0.0..=3.0 * error + MASS_TOLERANCE * weighed).contains(&difference)
                {
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
    /// Judges the mobility by what every body must obey: it answers after the force, takes energy, begins as its mass, ends as its
    /// front.
    #[must_use]
    pub fn screen(&self) -> Screening {
        Screening {
            causality: self.causality(self.conductance()),
            passivity: self.passivity(),
            mass: self.mass_check(),
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
        // relative to the largest: no square then leaves the range of numbers
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
            // spread evenly over the period; samples are unscaled sums over both sides
            share(noise * (n_samples / 2 - near) as f64)
        });
        Causality {
            acausal_part: share(ahead),
            expected_from_noise,
        }
    }

    /// Mean of Re G over whole resonance spacings: $`\operatorname{Re}\coth\gamma L`$ has the mean 1 over each, however much the body damps.
    fn front_limit(&self) -> Option<FrontLimit> {
        // of nearly rigid lines the real part is noise
        let lines = self.mobility().iter().skip(1);
        let real: Vec<f64> = lines
            .skip_while(|line| line.re.abs() < RIGID * line.im.abs())
            .map(|line| line.re)
            .collect();
        // of a reversed sensor the resonances point down
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
        let mut passivity = Passivity {
            active_lines: 0,
            worst: None,
        };
        for (line, value) in self.mobility().iter().enumerate().skip(1) {
            let variance = self.variance().and_then(|variances| variances.get(line));
            // half of the variance is that of the real part
            let error = variance.map_or(0.0, |variance| (0.5 * variance).sqrt());
            let rounding = ROUNDING * value.norm();
            if value.re >= -(COVERAGE * error).max(rounding) {
                continue;
            }
            passivity.active_lines += 1;
            let unit = if error > 0.0 { error } else { value.norm() };
            let distance = -value.re / unit;
            if passivity.worst.is_none_or(|(_, worst)| distance > worst) {
                passivity.worst = Some((line, distance));
            }
        }
        passivity
    }

    /// Least squares of Re(iωG) = p + q ω² over the lines that are nearly rigid.
    fn mass_check(&self) -> Option<MassCheck> {
        let LowFrequency::Free(weighed) = self.low_frequency() else {
            return None;
        };
        let lines = self.mobility().iter().enumerate().skip(1);
        let accelerance: Vec<(f64, f64)> = lines
            .map(|(line, value)| {
                let omega = self.omega(line);
                (omega * omega, (Complex64::new(0.0, omega) * value).re)
            })
            .collect();
        let start = accelerance
            .iter()
            .take(FEWEST_LINES)
            .map(|(_, value)| value)
            .sum::<f64>()
            / FEWEST_LINES as f64;
        let rigid: Vec<(f64, f64)> = accelerance
            .iter()
            .take_while(|(_, value)| value / start > NEARLY_RIGID)
            .copied()
            .collect();
        let n_lines = rigid.len();
        if n_lines <= FEWEST_LINES {
            return None;
        }
        let count = n_lines as f64;
        let mean_x = rigid.iter().map(|(x, _)| x).sum::<f64>() / count;
        let mean_y = rigid.iter().map(|(_, y)| y).sum::<f64>() / count;
        let square: f64 = rigid.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
        let product: f64 = rigid.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
        let slope = product / square;
        let intercept = mean_y - slope * mean_x;
        let misfit: f64 = rigid
            .iter()
            .map(|(x, y)| (y - intercept - slope * x).powi(2))
            .sum();
        let variance = misfit / (count - 2.0) * (1.0 / count + mean_x * mean_x / square);
        Some(MassCheck {
            apparent: 1.0 / intercept,
            standard_error: variance.sqrt() / (intercept * intercept),
            weighed: (weighed.mass, weighed.standard_error),
            n_lines,
        })
    }
}

/// Indices of the highest or of the lowest turns of a curve that swings by at least [`SWING`], of whichever there are more: between
/// neighbours lies one resonance spacing.
fn turns(curve: &[f64]) -> Vec<usize> {
    let least = LEAST_SWING * curve.iter().sum::<f64>() / curve.len() as f64;
    let (mut highest, mut lowest) = (Vec::new(), Vec::new());
    let (mut top, mut bottom) = ((0, f64::NEG_INFINITY), (0, f64::INFINITY));
    // not known before the first swing
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
