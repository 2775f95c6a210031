//! Findings of a screening, and the limits beyond which they count.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Number of standard errors attributed to chance.
const COVERAGE: f64 = 4.0;

/// Probability of a false alarm for a faultless body, for each of the three tests: energy
/// generation, mass, and delay.
pub(super) const LEVEL: f64 = 0.01;

/// Degrees of freedom above which the tails of Student's distribution used here are those of the
/// normal distribution to three digits.
const MANY: f64 = 1e5;

/// Acausal part of the energy that is always allowed.
const ACAUSAL: f64 = 0.01;

/// Relative mass error of the fitted law on nearly rigid lines: the neglected terms for rods of
/// constant loss factor and for two masses with a spring are up to 8e-4.
const MASS_TOLERANCE: f64 = 1e-3;

/// Number of standard errors allowed in addition to a tolerance.
const BESIDE_TOLERANCE: f64 = 2.0;

/// Number of combined standard errors by which the mass must differ from the weighed mass if the
/// standard error comes from the variances of the lines.
const MASS_ERRORS: f64 = 3.0;

/// Probability that noise alone makes the lowest lines contradict a free body of the weighed mass,
/// below which the contradiction is flagged.
const NOT_FREE: f64 = 1e-3;

/// Relative deviation of the front impedance that is never flagged: the impedance of a polymer
/// increases by as much within the measured band.
const FRONT_TOLERANCE: f64 = 0.1;

/// Energy before the impulse.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Causality {
    /// $`\sum_{t<0}g^2/\sum g^2`$ of the impulse response without rigid-body motion and
    /// instantaneous response, with lines rolled off. The mass of the rigid-body motion is chosen,
    /// within three stated uncertainties of scale and mass, so that least energy is before the
    /// impulse: an error of the scale otherwise leaves a step there.
    pub acausal_part: f64,
    /// The part expected from the variances; `None` without variances.
    pub expected_from_noise: Option<f64>,
}

/// Lines that generate energy.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Passivity {
    /// Number of lines whose real part is negative beyond chance, individually or in the mean with
    /// 7 or 63 neighbours: one faultless body in a hundred has such a line (without variances:
    /// negative beyond rounding).
    pub active_lines: usize,
    /// The most negative line: its index, and the distance of its real part from zero in standard
    /// errors or, without variances, relative to its magnitude.
    pub worst: Option<(usize, f64)>,
    /// Smallest advance and smallest delay \[s\] of the motion relative to the force with which a
    /// line that generates no energy would be found to generate energy; `None` if none below half
    /// the period of the highest line is detectable.
    pub seen_delays: [Option<f64>; 2],
}

/// Delay between force and motion from the nearly rigid lines of a free body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DelayCheck {
    /// Delay \[s\] of the motion after the force, by least squares of $`\arg(i\omega G) =
    /// -\omega\tau + b\omega^2 + c\omega^4`$: losses begin with the second order.
    pub delay: f64,
    /// Standard error of the delay \[s\], from the scatter of the lines and the stated uncertainty.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: f64,
    /// Possible error due to neglected orders \[s\].
    pub tolerance: f64,
}

impl DelayCheck {
    /// Smallest delay \[s\] that is flagged.
    #[must_use]
    pub fn least_seen(&self) -> f64 {
        least_doubted(self.standard_error, self.degrees_of_freedom, self.tolerance)
    }
}

/// Mass from the low lines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MassCheck {
    /// The mass \[kg\] in the low-frequency expansion $`\operatorname{Re}(i\omega G) = (1 -
    /// e\omega^2 - g\omega^4)/M`$, by least squares over the measured lines.
    pub apparent: f64,
    /// Standard error of the mass \[kg\]: the smaller of that from the scatter of the lines and
    /// that from their variances, if any. A law that does not fit increases the scatter, but not
    /// the variances.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: f64,
    /// The weighed mass \[kg\] and its standard error, including the error of the scale of the
    /// lines.
    pub weighed: (f64, f64),
    /// Number of lines used.
    pub n_lines: usize,
    /// Standard error \[kg\] and its degrees of freedom, from the scatter of the lines.
    pub(super) by_scatter: (f64, f64),
    /// Standard error \[kg\] and its degrees of freedom, from the variances of the lines.
    pub(super) by_variance: Option<(f64, f64)>,
    /// Mass \[kg\] by the mean of the lowest lines, its standard error from their variances, and
    /// the degrees of freedom of that error.
    pub(super) lowest: Option<[f64; 3]>,
}

impl MassCheck {
    /// Returns the objection to the mass, if any.
    fn flag(&self) -> Option<ScreeningFlag> {
        let (weighed, weighed_error) = self.weighed;
        // the lines determine 1/M
        let beside_weighed = |own: f64, freedom: f64, apparent: f64| {
            let own = own * (weighed / apparent).powi(2);
            let error = own.hypot(weighed_error);
            (error, freedom * (error / own).powi(4))
        };
        let (error, freedom) = self.by_scatter;
        let (error, freedom) = beside_weighed(error, freedom, self.apparent);
        let mut allowed = least_doubted(error, freedom, MASS_TOLERANCE * weighed);
        if let Some((error, freedom)) = self.by_variance {
            let (error, freedom) = beside_weighed(error, freedom, self.apparent);
            let by_variance = least_doubted(error, freedom, MASS_TOLERANCE * weighed);
            allowed = allowed.min(by_variance.max(MASS_ERRORS * error));
        }
        // a negative or infinite mass is wrong whatever its error
        let difference = (weighed / self.apparent - 1.0).abs() * weighed;
        if self.apparent <= 0.0 || !(0.0..=allowed).contains(&difference) {
            return Some(ScreeningFlag::MassContradicted {
                apparent: self.apparent,
                standard_error: self.standard_error,
                weighed,
                weighed_error,
            });
        }
        let [at_most, standard_error, freedom] = self.lowest?;
        let (error, freedom) = beside_weighed(standard_error, freedom, at_most);
        let excess = (weighed / at_most - 1.0 - MASS_TOLERANCE) * weighed;
        (below(-excess / error, freedom) < NOT_FREE).then_some(ScreeningFlag::NotFree {
            at_most,
            standard_error,
            weighed,
            weighed_error,
        })
    }
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

/// Result of [`MeasuredBody::screen`](crate::MeasuredBody::screen).
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
    /// Relative standard error of the scale of all lines, which mass and impedance share; it is in
    /// none of their standard errors.
    pub scale_error: f64,
    pub(super) free: bool,
    pub(super) n_judged: usize,
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
            Some(mass) => flags.extend(mass.flag()),
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

/// A fault of a measured mobility.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScreeningFlag {
    /// Excess energy before the impulse: a delay between the channels, leakage, or ringing longer
    /// than the period.
    #[error("{part:.2e} of the energy is before the impulse, expected at most {allowed:.2e}")]
    Acausal {
        /// The part found.
        part: f64,
        /// The part allowed.
        allowed: f64,
    },
    /// Lines that generate energy, due to a wrong sign, a phase error, or a response that was not
    /// measured at the driving point.
    #[error("{lines} lines generate energy, the worst is line {worst_line}, {worst:.1} below zero")]
    Active {
        /// Number of lines.
        lines: usize,
        /// Index of the worst line.
        worst_line: usize,
        /// Distance of the real part of the worst line from zero in standard errors or, without
        /// variances, relative to its magnitude.
        worst: f64,
    },
    /// The nearly rigid lines have the phase of a delay between the channels.
    #[error(
        "the motion is {:.3} us ± {:.2} us {} the force, according to the phase of the nearly rigid lines",
        1e6 * .delay.abs(),
        1e6 * .standard_error,
        if *.delay < 0.0 { "before" } else { "after" }
    )]
    Delayed {
        /// Delay of the motion after the force \[s\]; negative if it is before.
        delay: f64,
        /// Standard error of the delay \[s\].
        standard_error: f64,
    },
    /// The mass of the low lines differs from the weighed one, due to a wrong sensitivity, a body
    /// that is not free, or a mass between gauge and face.
    #[error(
        "the low lines give a mass of {apparent:.4} kg ± {standard_error:.1e} kg, expected the weighed {weighed} kg ± {weighed_error:.1e} kg"
    )]
    MassContradicted {
        /// Mass from the mobility \[kg\].
        apparent: f64,
        /// Standard error of that mass \[kg\].
        standard_error: f64,
        /// Weighed mass \[kg\].
        weighed: f64,
        /// Standard error of the weighed mass \[kg\], including that of the scale of the lines.
        weighed_error: f64,
    },
    /// The lowest lines move more than the weighed mass alone, while a free body moves less up to
    /// its first resonance: a support has its resonance below these lines, for example.
    #[error(
        "the lowest lines move like a mass of {at_most:.4} kg ± {standard_error:.1e} kg, expected at least the weighed {weighed} kg ± {weighed_error:.1e} kg of a free body: its support may have a resonance below these lines"
    )]
    NotFree {
        /// Mass of a rigid body that would move as the lowest lines do \[kg\].
        at_most: f64,
        /// Standard error of that mass \[kg\].
        standard_error: f64,
        /// Weighed mass \[kg\].
        weighed: f64,
        /// Standard error of the weighed mass \[kg\], including that of the scale of the lines.
        weighed_error: f64,
    },
    /// No line lies below the first antiresonance of a free body, so that its mass cannot be
    /// checked.
    #[error("no line is low enough to determine the mass")]
    MassNotSeen,
    /// The mean impedance of the lines differs from that of the material, due to a wrong
    /// sensitivity or another section at the face.
    #[error(
        "the lines have a mean front impedance of {apparent:.4e} kg/s ± {standard_error:.1e} kg/s, expected the given {given:.4e} kg/s"
    )]
    FrontContradicted {
        /// Impedance from the mobility [kg/s].
        apparent: f64,
        /// Standard error of that impedance [kg/s].
        standard_error: f64,
        /// Given impedance [kg/s].
        given: f64,
    },
    /// The lines give no positive impedance.
    #[error("the mean real part of the lines is {mean:.2e} m/(N s), expected a value above 0")]
    FrontNotPositive {
        /// Mean real part \[m/(N s)\].
        mean: f64,
    },
}

/// Returns the least deviation that is flagged: the deviation that chance exceeds with the
/// probability [`LEVEL`], or the tolerance plus [`BESIDE_TOLERANCE`] standard errors if that is
/// greater.
fn least_doubted(standard_error: f64, freedom: f64, tolerance: f64) -> f64 {
    let by_chance = standard_error * quantile(1.0 - 0.5 * LEVEL, freedom);
    by_chance.max(tolerance + BESIDE_TOLERANCE * standard_error)
}

/// Probability of Student's distribution below `value`.
pub(super) fn below(value: f64, freedom: f64) -> f64 {
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
