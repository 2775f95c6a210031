//! What is known of a body: the mobility of its impact face.
//!
//! Theory: `docs/theory/stick-force.md#measured-bodies`.

mod chain;
mod law;
mod measured;
mod reciprocity;
mod screening;

use num_complex::Complex64;

use crate::ImpulseError;

pub use law::MobilityLaw;
pub use measured::{LowFrequency, MeasuredBody, WeighedMass};
pub use reciprocity::Reciprocity;
pub use screening::{Causality, FrontLimit, MassCheck, Passivity, Screening, ScreeningFlag};

/// Where the mobility of a body is known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Domain {
    /// At every $`s`$ with $`\operatorname{Re} s \ge 0`$: the law is analytic there. Every method applies.
    RightHalfPlane,
    /// At every real frequency, as the power laws of (Ödeen 1993, paper E, eq. 7). What rings must die out.
    FrequencyAxis,
    /// At the lines $`k\,\Delta f`$ of a measurement.
    Lines {
        /// $`\Delta f`$ \[Hz\].
        frequency_step_hz: f64,
        /// Number of lines, that at 0 Hz included.
        n_lines: usize,
    },
}

/// A body as its impact face shows it: $`\hat v = G\hat F`$, with the force pressing and the velocity along it.
///
/// Implemented by [`rodwave::Chain`] (real frequencies), [`rodwave::chain::AnalyticChain`] (complex ones), [`MobilityLaw`]
/// (a formula of the user's) and [`MeasuredBody`].
pub trait ImpactBody {
    /// Where the mobility is known.
    fn domain(&self) -> Domain;

    /// Mobility $`G(s)`$ \[m/(N s)\] at the Laplace variable `s` [1/s].
    ///
    /// # Errors
    ///
    /// [`ImpulseError::OutsideDomain`]; what the body itself reports.
    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError>;

    /// Mass \[kg\] with which a free body answers at low frequency, $`G \to 1/(sM)`$; none if something holds the body or it is
    /// endless.
    fn free_mass(&self) -> Option<f64>;

    /// Impedance $`Z`$ [kg/s] with which the face answers at once, $`G \to 1/Z`$, where it cannot be found by asking for
    /// [`ImpactBody::mobility_at`] at high frequency.
    fn front_impedance(&self) -> Option<f64> {
        None
    }
}

impl<B: ImpactBody + ?Sized> ImpactBody for &B {
    fn domain(&self) -> Domain {
        (**self).domain()
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        (**self).mobility_at(s)
    }

    fn free_mass(&self) -> Option<f64> {
        (**self).free_mass()
    }

    fn front_impedance(&self) -> Option<f64> {
        (**self).front_impedance()
    }
}

/// Most lines of a spectrum: a gibibyte.
const MOST_LINES: usize = 1 << 26;

/// Mobilities \[m/(N s)\] of `body` on the lines $`k\,\Delta f`$, $`k = 0 \ldots n-1`$, as [`StickProblem`](crate::StickProblem) takes them.
///
/// The element at 0 Hz is zero: it is infinite for a free body and never read.
///
/// # Errors
///
/// [`ImpulseError::NonPhysical`] for the step, or for more than $`2^{26}`$ lines; [`ImpulseError::GridMismatch`] or [`ImpulseError::LengthMismatch`] for a measured
/// body with other or too few lines; what the body reports.
pub fn lines_of<B: ImpactBody + ?Sized>(
    body: &B,
    frequency_step_hz: f64,
    n_lines: usize,
) -> Result<Vec<Complex64>, ImpulseError> {
    crate::error::check_positive("frequency step [Hz]", frequency_step_hz)?;
    if n_lines > MOST_LINES {
        return Err(ImpulseError::NonPhysical {
            quantity: "number of lines",
            value: n_lines as f64,
            expected: "at most 2^26",
        });
    }
    if let Domain::Lines {
        frequency_step_hz: found_hz,
        n_lines: found,
    } = body.domain()
    {
        // as many digits as a step that was computed from a sampling rate keeps
        if (found_hz / frequency_step_hz - 1.0).abs() > 1e-9 {
            return Err(ImpulseError::GridMismatch {
                what: "measured body",
                found_hz,
                expected_hz: frequency_step_hz,
            });
        }
        if found < n_lines {
            return Err(ImpulseError::LengthMismatch {
                what: "measured body",
                found,
                expected: n_lines,
            });
        }
    }
    let step = std::f64::consts::TAU * frequency_step_hz;
    (0..n_lines)
        .map(|line| match line {
            0 => Ok(Complex64::ZERO),
            _ => body.mobility_at(Complex64::new(0.0, step * line as f64)),
        })
        .collect()
}
