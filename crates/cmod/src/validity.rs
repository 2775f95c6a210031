//! Validity of a line: the conditions (i)-(iii) of paper A, section 4, the reports of the solver,
//! and the limits of the errors.
//!
//! Theory: `docs/theory/two-point-method.md#validity`.

mod limits;

pub use limits::{
    AcceptanceLimits, COMMON_STANDARD_ERRORS_WITHIN, GREATEST_ERROR_AMPLIFICATION,
    GREATEST_LOSS_FACTOR_ERROR, GREATEST_POISSON_RATIO, GREATEST_SECOND_ORDER,
    GREATEST_STORAGE_MODULUS_ERROR, STANDARD_ERRORS_WITHIN,
};

use std::fmt;

use num_complex::Complex64;

use rodwave::digits::{percent, significant};

use crate::branch::BranchDoubt;
use crate::uncertainty::ErrorSource;

/// Condition (i): the wavelength exceeds this many diameters. The error of one-dimensional theory
/// is then less than 5 per cent in the storage modulus and in the loss factor, due to lateral
/// inertia (paper A, after Pritz).
pub const LEAST_WAVELENGTH_IN_DIAMETERS: f64 = 5.0;

/// Condition (ii): the wavelength is less than this many lengths of the specimen. In longer waves
/// both ends move almost equally, and only the small difference of their motions contains
/// information (paper A, section 4).
pub const GREATEST_WAVELENGTH_IN_LENGTHS: f64 = 5.0;

/// Validity of a line, with the violated conditions.
#[derive(Debug, Clone, PartialEq)]
pub enum Validity {
    /// All conditions are met.
    Valid,
    /// At least one condition is violated; the numbers of the line are unreliable.
    Invalid(Vec<Violation>),
}

impl Validity {
    /// Creates the verdict from a list of violations.
    #[must_use]
    pub fn from_violations(violations: Vec<Violation>) -> Self {
        if violations.is_empty() {
            Self::Valid
        } else {
            Self::Invalid(violations)
        }
    }

    /// Returns true if all conditions are met.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        matches!(self, Self::Valid)
    }

    /// Returns true if E' meets all conditions, whatever the error of the loss factor is.
    #[must_use]
    pub fn storage_modulus_is_valid(&self) -> bool {
        self.violations().iter().all(Violation::is_of_loss_factor)
    }

    /// Returns the violations; the list is empty if the line is valid.
    #[must_use]
    pub fn violations(&self) -> &[Violation] {
        match self {
            Self::Valid => &[],
            Self::Invalid(violations) => violations,
        }
    }
}

impl fmt::Display for Validity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Invalid(violations) = self else {
            return formatter.write_str("valid");
        };
        for (index, violation) in violations.iter().enumerate() {
            let separator = if index == 0 { "" } else { "; " };
            write!(formatter, "{separator}{violation}")?;
        }
        Ok(())
    }
}

/// Condition violated by a line. Its error text is the reason why the line is not used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// Condition (i), λ > 5D: the rod is not slender for this wave.
    #[error("wavelength {} m, expected more than 5 diameters, {} m", significant(*.wavelength, 3), significant(*.limit, 3))]
    WavelengthTooShort {
        /// Wavelength λ = 2π/k \[m\].
        wavelength: f64,
        /// Limit 5D \[m\].
        limit: f64,
    },
    /// Condition (ii), λ < 5L: the specimen is too short for this wave.
    #[error("wavelength {} m, expected less than {} m, five times the length over which waves are counted", significant(*.wavelength, 3), significant(*.limit, 3))]
    WavelengthTooLong {
        /// Wavelength λ = 2π/k \[m\].
        wavelength: f64,
        /// Limit 5L \[m\].
        limit: f64,
    },
    /// Condition (iii), α > 0: a growing wave is impossible in a passive material.
    #[error("damping coefficient {} 1/m, expected more than 0", significant(*.damping_coefficient, 3))]
    DampingNotPositive {
        /// Damping coefficient α [1/m].
        damping_coefficient: f64,
    },
    /// Condition (iii), k > 0.
    #[error("wave number {} rad/m, expected more than 0", significant(*.wave_number, 3))]
    WaveNumberNotPositive {
        /// Wave number k [rad/m].
        wave_number: f64,
    },
    /// The number of half waves in the specimen is doubtful.
    #[error("branch: {0}")]
    BranchAmbiguous(BranchDoubt),
    /// The iteration did not converge.
    #[error("no convergence in {iterations} iterations, residual {residual:.1e}")]
    NotConverged {
        /// Number of Newton steps.
        iterations: u32,
        /// |f(γL)| at the last step.
        residual: f64,
    },
    /// The continuation came so near to a double root that it may have left its branch.
    #[error(
        "root followed up to a mass ratio of {mass_ratio:.2e}, expected up to {expected:.2e}: two roots meet nearby"
    )]
    RootNotFollowed {
        /// Mass ratio where the steps became too small.
        mass_ratio: f64,
        /// Mass ratio of the specimen.
        expected: f64,
    },
    /// The series in the mass ratio is not accurate enough: E' or E'' from two terms and from four
    /// terms differ by more than one third (paper A, section 5).
    #[error(
        "series: E' changes by {storage_change:.2} and E'' by {loss_change:.2} from two terms to four, expected at most 1/3"
    )]
    SeriesTruncated {
        /// Relative change |E'₂ - E'₄|/|E'₄|.
        storage_change: f64,
        /// Relative change |E''₂ - E''₄|/|E''₄|.
        loss_change: f64,
    },
    /// The line is so near to a singular line, or so noisy, that the error of γ is nonlinear: the
    /// second order of the error is not small compared with the first, and the stated standard
    /// error is unreliable.
    #[error(
        "second-order error is {second_order:.2} of the standard error, expected at most {limit}, \
         at {half_waves:.2} half waves between neighbouring sensors"
    )]
    NearSingular {
        /// Ratio of the second-order to the first-order part of the error, at one standard error.
        second_order: f64,
        /// Accepted limit.
        limit: f64,
        /// Number ka/π of half waves, where a is the smallest distance between sensors.
        half_waves: f64,
    },
    /// The random error, together with the bound on lateral inertia, exceeds the accepted limit,
    /// see [`AcceptanceLimits`].
    #[error("{quantity} may be off by {}, expected at most {}", percent(*.error), percent(*.limit))]
    ErrorTooLarge {
        /// `E'` or `the loss factor`.
        quantity: &'static str,
        /// Five standard errors of the random part relative to the value (more than five if the
        /// variance was estimated from few averages), plus the bound on lateral inertia that was
        /// not removed.
        error: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// The random error is within its limit only because noise made the loss factor of the line too
    /// large, see [`judged_by_neighbours`](crate::ModulusEstimate::judged_by_neighbours).
    #[error(
        "loss factor may be off by {} of the mean loss factor of the neighbouring lines, expected at most {}: noise has made the loss factor of this line too large",
        percent(*.error), percent(*.limit)
    )]
    LossWithinNoise {
        /// Five standard errors (more than five if the variance was estimated from few averages)
        /// relative to the mean loss factor of the neighbouring lines.
        error: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// Lateral inertia that the theory of the waves leaves in the modulus is above its limit, see
    /// [`AcceptanceLimits`].
    #[error(
        "uncorrected lateral inertia may change {quantity} by {}, expected at most {}",
        percent(*.error), percent(*.limit)
    )]
    LateralInertiaTooLarge {
        /// `E'` or `the loss factor`.
        quantity: &'static str,
        /// Bound on the error relative to the value.
        error: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// The common errors exceed the limit that was set, see
    /// [`AcceptanceLimits::common_storage_modulus`].
    #[error(
        "E' may be off by {} due to common errors, expected at most {}; largest contribution: {largest}",
        percent(*.error), percent(*.limit)
    )]
    CommonErrorTooLarge {
        /// Two standard errors of all common sources together, relative to the value.
        error: f64,
        /// Source of the largest contribution.
        largest: ErrorSource,
        /// Accepted limit.
        limit: f64,
    },
    /// A small error of the measured quantity, whatever its cause, is strongly amplified.
    #[error("relative errors are amplified {amplification:.1} times, expected at most {limit}")]
    ErrorAmplified {
        /// Amplification: |dE/E| divided by |dΨ/Ψ|.
        amplification: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// The relation between the motions of the ends is not that of a linear rod without noise.
    #[error("coherence {coherence:.4}, expected at least {limit:.4}")]
    CoherenceTooLow {
        /// Ordinary coherence.
        coherence: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// The middle gauge of three is at a node: the denominator of Ψ is noisy, and Ψ is therefore
    /// too small.
    #[error(
        "noise is {noise_to_signal:.2} of the signal of the middle gauge, expected at most {limit}"
    )]
    NodeAtMiddleGauge {
        /// Ratio of noise to signal, as amplitudes.
        noise_to_signal: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// The noise of the gauges is too large compared with their signal, and the first-order errors
    /// are unreliable.
    #[error("noise is {noise_to_signal:.2} of the signal of the gauges, expected at most {limit}")]
    SignalTooWeak {
        /// Ratio of noise to signal, as root mean squares.
        noise_to_signal: f64,
        /// Accepted limit.
        limit: f64,
    },
    /// Two waves do not explain the signals of the gauges within their noise.
    #[error(
        "misfit of two waves: chi-square {chi_square:.1} with {degrees_of_freedom} degrees of freedom, expected at most {limit:.1}"
    )]
    Misfit {
        /// Twice the sum of squares of the residuals, each divided by the standard deviation of
        /// its gauge.
        chi_square: f64,
        /// Number 2(M(n - 2) - 1) for M tests with n gauges.
        degrees_of_freedom: usize,
        /// Value that noise alone exceeds on one line in a thousand.
        limit: f64,
    },
}

impl Violation {
    /// Returns true if only the error of the loss factor exceeds its limit, which does not affect
    /// E'.
    fn is_of_loss_factor(&self) -> bool {
        match self {
            Self::LossWithinNoise { .. } => true,
            Self::ErrorTooLarge { quantity, .. }
            | Self::LateralInertiaTooLarge { quantity, .. } => *quantity != "E'",
            _ => false,
        }
    }
}

/// Checks the conditions (i), (ii) and (iii) on a `propagation_coefficient` γ [1/m] found with a
/// specimen of `diameter` and `length` \[m\].
///
/// Conditions (i) and (ii) are not checked unless the wave number is positive, because there is no
/// wavelength otherwise.
#[must_use]
pub fn conditions(
    propagation_coefficient: Complex64,
    diameter: f64,
    length: f64,
) -> Vec<Violation> {
    let Complex64 {
        re: damping_coefficient,
        im: wave_number,
    } = propagation_coefficient;
    let mut violations = Vec::new();
    if wave_number > 0.0 {
        let wavelength = std::f64::consts::TAU / wave_number;
        let shortest = LEAST_WAVELENGTH_IN_DIAMETERS * diameter;
        if wavelength <= shortest {
            violations.push(Violation::WavelengthTooShort {
                wavelength,
                limit: shortest,
            });
        }
        let longest = GREATEST_WAVELENGTH_IN_LENGTHS * length;
        if wavelength >= longest {
            violations.push(Violation::WavelengthTooLong {
                wavelength,
                limit: longest,
            });
        }
    } else {
        violations.push(Violation::WaveNumberNotPositive { wave_number });
    }
    if damping_coefficient.is_nan() || damping_coefficient <= 0.0 {
        violations.push(Violation::DampingNotPositive {
            damping_coefficient,
        });
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(alpha: f64, wavelength: f64) -> Vec<Violation> {
        let k = std::f64::consts::TAU / wavelength;
        conditions(Complex64::new(alpha, k), 0.01, 0.8)
    }

    #[test]
    fn each_condition_is_asked_at_its_limit() {
        assert!(with(0.1, 0.0501).is_empty());
        assert!(matches!(
            with(0.1, 0.0499)[..],
            [Violation::WavelengthTooShort { .. }]
        ));
        assert!(with(0.1, 3.99).is_empty());
        assert!(matches!(
            with(0.1, 4.01)[..],
            [Violation::WavelengthTooLong { .. }]
        ));
        assert!(matches!(
            with(0.0, 1.0)[..],
            [Violation::DampingNotPositive { .. }]
        ));
        assert!(matches!(
            with(f64::NAN, 1.0)[..],
            [Violation::DampingNotPositive { .. }]
        ));
        assert!(matches!(
            conditions(Complex64::new(0.1, -1.0), 0.01, 0.8)[..],
            [Violation::WaveNumberNotPositive { .. }]
        ));
    }

    #[test]
    fn the_verdict_names_the_numbers() {
        let verdict = Validity::from_violations(with(-0.25, 4.5));
        assert_eq!(
            verdict.to_string(),
            "wavelength 4.50 m, expected less than 4.00 m, five times the length over which waves are counted; \
             damping coefficient -0.250 1/m, expected more than 0"
        );
        assert!(!verdict.is_valid() && verdict.violations().len() == 2);
        assert_eq!(Validity::from_violations(Vec::new()).to_string(), "valid");
    }

    #[test]
    fn violations_name_their_numbers() {
        let violations = vec![
            Violation::NearSingular {
                second_order: 0.251,
                limit: 0.1,
                half_waves: 0.987,
            },
            Violation::NodeAtMiddleGauge {
                noise_to_signal: 0.3,
                limit: 0.1,
            },
            Violation::ErrorTooLarge {
                quantity: "E'",
                error: 0.0234,
                limit: 0.01,
            },
            Violation::LateralInertiaTooLarge {
                quantity: "E'",
                error: 0.0187,
                limit: 0.01,
            },
            Violation::CommonErrorTooLarge {
                error: 0.0201,
                largest: ErrorSource::Density,
                limit: 0.01,
            },
            Violation::ErrorAmplified {
                amplification: 23.42,
                limit: 10.0,
            },
            Violation::CoherenceTooLow {
                coherence: 0.93,
                limit: 0.99,
            },
            Violation::Misfit {
                chi_square: 31.4,
                degrees_of_freedom: 4,
                limit: 18.5,
            },
        ];
        assert_eq!(
            Validity::from_violations(violations).to_string(),
            "second-order error is 0.25 of the standard error, expected at most 0.1, \
             at 0.99 half waves between neighbouring sensors; \
             noise is 0.30 of the signal of the middle gauge, expected at most 0.1; \
             E' may be off by 2.3 %, expected at most 1.0 %; \
             uncorrected lateral inertia may change E' by 1.9 %, expected at most 1.0 %; \
             E' may be off by 2.0 % due to common errors, expected at most 1.0 %; largest contribution: density; \
             relative errors are amplified 23.4 times, expected at most 10; \
             coherence 0.9300, expected at least 0.9900; \
             misfit of two waves: chi-square 31.4 with 4 degrees of freedom, expected at most 18.5"
        );
    }
}
