//! Result that every method returns: a modulus per line with its error and validity, and the
//! method.
//!
//! | part | where |
//! |---|---|
//! | numbers per line | [`ModulusLine`] |
//! | standard errors, random and common (systematic), their covariances | [`Uncertainty`], [`StandardError`] |
//! | error contributions of a line, expanded uncertainty | [`Budget`] |
//! | validity of a line | [`crate::validity`] |
//! | the method | [`Method`] |
//! | a table for a file | [`ModulusEstimate::columns`] |
//! | curves and bands for a figure | [`ModulusEstimate::curve`] |

mod acceptance;
mod budget;
mod columns;
mod curve;
mod freedom;
mod solution;

pub(crate) use acceptance::Acceptance;
pub use budget::{Budget, BudgetedQuantity};
pub use columns::{Column, Columns};
pub use curve::{Curve, CurveSegment, PlottedQuantity};
pub use freedom::VarianceFreedom;
pub(crate) use solution::Solution;

pub use crate::uncertainty::{
    ComplexCovariance, ErrorSource, LineCovariance, StandardError, SystematicShift, Uncertainty,
    coverage_factor,
};

use std::fmt;

use num_complex::Complex64;

use crate::branch::ResolvedRoot;
use crate::validity::{AcceptanceLimits, Validity, Violation};

/// Complex modulus on the lines of a measurement.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModulusEstimate {
    method: Method,
    limits: AcceptanceLimits,
    lines: Vec<ModulusLine>,
    refused: Vec<RefusedLine>,
}

/// Name of an estimation method, such as `two-point method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Method(pub(crate) &'static str);

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }
}

impl ModulusEstimate {
    /// Creates an estimate without lines.
    pub(crate) fn empty(method: Method, limits: AcceptanceLimits) -> Self {
        Self {
            method,
            limits,
            lines: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// Reserves memory for `count` more lines.
    pub(crate) fn expect_lines(&mut self, count: usize) {
        self.lines.reserve_exact(count);
    }

    /// Appends a line, or inserts its refusal in the order of the measured lines.
    pub(crate) fn add(
        &mut self,
        index: usize,
        frequency_hz: f64,
        line: Result<ModulusLine, Refusal>,
    ) {
        match line {
            Ok(line) => self.lines.push(line),
            Err(reason) => {
                let place = self.refused.partition_point(|line| line.index <= index);
                self.refused.insert(
                    place,
                    RefusedLine {
                        index,
                        frequency_hz,
                        reason,
                    },
                );
            }
        }
    }

    /// Returns the method.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method
    }

    /// Returns the limits by which the lines were judged.
    #[must_use]
    pub fn limits(&self) -> &AcceptanceLimits {
        &self.limits
    }

    /// Returns all lines that have a modulus, valid or not, in order of frequency. All their
    /// numbers are finite.
    #[must_use]
    pub fn lines(&self) -> &[ModulusLine] {
        &self.lines
    }

    /// Returns the estimate restricted to the lines between two frequencies \[Hz\], both included.
    #[must_use]
    pub fn within(&self, from_hz: f64, to_hz: f64) -> Self {
        let band = from_hz..=to_hz;
        let lines = self.lines.iter();
        let refused = self.refused.iter();
        Self {
            method: self.method,
            limits: self.limits,
            lines: lines
                .filter(|line| band.contains(&line.frequency_hz))
                .cloned()
                .collect(),
            refused: refused
                .filter(|line| band.contains(&line.frequency_hz))
                .cloned()
                .collect(),
        }
    }

    /// Returns the lines that fulfil every condition of [`crate::validity`].
    pub fn valid(&self) -> impl Iterator<Item = &ModulusLine> {
        self.lines.iter().filter(|line| line.validity.is_valid())
    }

    /// Returns the informative lines without the lines that two waves do not explain. A line is
    /// informative unless its branch, its convergence or its linearised error is in doubt. Lines of
    /// negative damping are included, because otherwise no check could detect negative damping.
    pub(crate) fn telling(&self) -> impl Iterator<Item = &ModulusLine> {
        let misfit = |violation: &Violation| matches!(violation, Violation::Misfit { .. });
        self.telling_but_for_misfit()
            .filter(move |line| !line.validity.violations().iter().any(misfit))
    }

    /// Returns the informative lines, including the lines that two waves do not explain.
    pub(crate) fn telling_but_for_misfit(&self) -> impl Iterator<Item = &ModulusLine> {
        self.lines.iter().filter(|line| line.is_informative())
    }

    /// Returns the lines without a modulus, with the reason.
    #[must_use]
    pub fn refused(&self) -> &[RefusedLine] {
        &self.refused
    }
}

/// Complex modulus at one frequency.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModulusLine {
    /// Position of the line in the arrays given to the method, from 0; for free vibration, position
    /// of the pole.
    pub index: usize,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Propagation coefficient γ = α + ik [1/m].
    pub propagation_coefficient: Complex64,
    /// Complex modulus E = E' + iE'' \[Pa\].
    pub modulus: Complex64,
    /// Loss factor E''/E'.
    pub loss_factor: f64,
    /// Phase velocity ω/k [m/s].
    pub phase_velocity: f64,
    /// Standard errors of this line from all sources, random and common, to first order.
    pub standard_error: StandardError,
    /// Covariances from which the standard errors follow, with random and systematic parts
    /// separate.
    pub uncertainty: Uncertainty,
    /// |dE/E| divided by |dΨ/Ψ|: amplification of the relative error of the measured quantity in
    /// the modulus. For several gauges, the measured quantity is the root mean square of the
    /// gauges.
    pub error_amplification: f64,
    /// Ratio of the second-order to the first-order part of the random error, at one standard
    /// error. The second-order part is not contained in the standard errors.
    pub second_order: f64,
    /// Root in closed form with its branch, from which the solution starts: for the two-point
    /// method, the root without end mass; for the three-point method, the solution itself. `None`
    /// for gauges at any positions, where there is no closed form.
    pub closed_form: Option<ResolvedRoot>,
    /// Termination of the solution.
    pub termination: Termination,
    /// Validity of the line.
    pub validity: Validity,
}

impl ModulusLine {
    /// Returns the covariance of E' and E'' \[Pa²\] from all sources.
    #[must_use]
    pub fn covariance(&self) -> ComplexCovariance {
        self.uncertainty.total_covariance().modulus
    }

    /// Returns the standard errors due to noise alone; they are independent from line to line.
    #[must_use]
    pub fn random_error(&self) -> StandardError {
        self.standard_error_of(&self.uncertainty.random)
    }

    /// Returns the standard errors due to the common sources alone, that is, specimen and theory. A
    /// common source acts on all lines.
    #[must_use]
    pub fn systematic_error(&self) -> StandardError {
        self.standard_error_of(&self.uncertainty.systematic_covariance())
    }

    /// Returns the largest possible errors due to lateral inertia that was not removed; 0 if all of
    /// it was removed. They are bounds, not standard errors: E' is too small and E''/E' too large
    /// by at most these amounts.
    #[must_use]
    pub fn lateral_inertia_bound(&self) -> StandardError {
        self.standard_error_of(&LineCovariance {
            modulus: ComplexCovariance::of_shift(self.uncertainty.lateral_inertia_bound()),
            ..LineCovariance::default()
        })
    }

    /// Returns true unless the branch, the convergence or the linearised error of the line is in
    /// doubt.
    pub(crate) fn is_informative(&self) -> bool {
        let spoils = |violation: &Violation| {
            matches!(
                violation,
                Violation::BranchAmbiguous(_)
                    | Violation::NotConverged { .. }
                    | Violation::SeriesTruncated { .. }
                    | Violation::NearSingular { .. }
                    | Violation::NodeAtMiddleGauge { .. }
                    | Violation::SignalTooWeak { .. }
            )
        };
        !self.validity.violations().iter().any(spoils)
    }

    fn standard_error_of(&self, covariance: &LineCovariance) -> StandardError {
        StandardError::of(
            self.modulus,
            self.propagation_coefficient,
            self.frequency_hz,
            covariance,
        )
    }

    /// Returns the damping coefficient α [1/m].
    #[must_use]
    pub fn damping_coefficient(&self) -> f64 {
        self.propagation_coefficient.re
    }

    /// Returns the wave number k [rad/m].
    #[must_use]
    pub fn wave_number(&self) -> f64 {
        self.propagation_coefficient.im
    }

    /// Returns the wavelength λ = 2π/k \[m\]; its sign is that of k.
    #[must_use]
    pub fn wavelength(&self) -> f64 {
        std::f64::consts::TAU / self.propagation_coefficient.im
    }
}

/// Reason why the solution of one line ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Termination {
    /// The solution follows from a formula, without iteration.
    ClosedForm,
    /// The last step, or the residual, is of the order of rounding.
    Converged {
        /// Number of Newton steps.
        iterations: u32,
        /// |f(γL)| at the solution.
        residual: f64,
    },
    /// The iteration was ended before it converged.
    LostPatience {
        /// Number of Newton steps.
        iterations: u32,
        /// |f(γL)| at the last step.
        residual: f64,
    },
}

impl Termination {
    /// Returns true if the solution solves its equation.
    #[must_use]
    pub fn was_successful(&self) -> bool {
        !matches!(self, Self::LostPatience { .. })
    }
}

/// Line without a modulus.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RefusedLine {
    /// Position of the line in the arrays given to the method, from 0; for free vibration, position
    /// of the pole.
    pub index: usize,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Reason for the refusal.
    pub reason: Refusal,
}

/// Reason why a line has no modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// At 0 Hz both ends have the same motion for any material: Ψ = 1.
    #[error("a line at 0 Hz contains no information on the modulus")]
    ZeroFrequency,
    /// The ratio, or its variance, is NaN or infinite, for example where an auto-spectrum is 0.
    #[error("the measured ratio or its variance is not finite")]
    NotFinite,
    /// A value of a gauge is NaN or infinite.
    #[error("a spectrum or its noise is not finite")]
    SpectrumNotFinite,
    /// The noise of some gauges is 0 and the noise of others is not. Gauges without noise would
    /// have infinite weight.
    #[error("the noise is 0 for some gauges only, expected 0 for all gauges or for none")]
    NoiseOfSomeGauges,
    /// The line agrees with any wave number: there is no signal, a node at the middle gauge, or the
    /// gauges cannot separate the two waves.
    #[error("the gauges do not determine a wave number")]
    Undetermined,
    /// The wave is not on the first branch of the theory that was chosen to remove lateral inertia.
    #[error("lateral inertia: the wave is beyond the first branch of the theory")]
    LateralInertia,
    /// Damping was added to the records, and there are too few lines to continue the modulus to the
    /// real frequency.
    #[error(
        "too few lines to determine how the modulus varies, which is needed to remove the added damping"
    )]
    NotContinued,
    /// The lines are too far apart to determine a resonance.
    #[error(
        "{found} lines within 0.3 rad of the resonance, expected at least {expected}; a longer record has more closely spaced lines"
    )]
    FewLinesAtResonance {
        /// Number of lines near the resonance.
        found: usize,
        /// Required number of lines.
        expected: usize,
    },
    /// The iteration diverged to infinity, or to γ = 0, where there is no modulus.
    #[error("no root with a finite modulus was found")]
    NoRoot,
}
