//! Bodies, described by the mobility of their impact face.
//!
//! Theory: `docs/theory/stick-force.md#measured-bodies`.

mod chain;
mod law;
mod measured;
mod projection;
mod reciprocity;
mod screening;

use num_complex::Complex64;

use crate::ImpulseError;

pub use law::MobilityLaw;
pub use measured::{LowFrequency, MeasuredBody, WeighedMass};
pub use projection::{LineChange, Projection};
pub use reciprocity::Reciprocity;
pub use screening::{
    Causality, DelayCheck, FrontLimit, MassCheck, Passivity, Screening, ScreeningFlag,
};

/// Domain in which the mobility of a body is known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Domain {
    /// Right half plane, $`\operatorname{Re} s \ge 0`$, where the law is analytic. Every method
    /// applies.
    RightHalfPlane,
    /// Real frequencies, as for the power laws (Ödeen 1993, paper E, eq. 7). Free vibrations must
    /// decay.
    FrequencyAxis,
    /// The lines $`k\,\Delta f`$ of a measurement.
    Lines {
        /// $`\Delta f`$ \[Hz\].
        frequency_step_hz: f64,
        /// Number of lines, including the line at 0 Hz.
        n_lines: usize,
    },
}

/// A body described by the response of its impact face: $`\hat v = G\hat F`$, with a compressive
/// force and the velocity along it.
///
/// Implemented by [`rodwave::Chain`] (real frequencies), [`rodwave::chain::AnalyticChain`] (complex
/// ones), [`MobilityLaw`] (a user-defined formula) and [`MeasuredBody`].
pub trait ImpactBody {
    /// Domain in which the mobility is known.
    fn domain(&self) -> Domain;

    /// Returns the mobility $`G(s)`$ \[m/(N s)\] at the Laplace variable `s` [1/s].
    ///
    /// # Errors
    ///
    /// [`ImpulseError::OutsideDomain`]; errors of the body itself.
    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError>;

    /// Mass \[kg\] of a free body, from its low-frequency limit $`G \to 1/(sM)`$; `None` if the
    /// body is held or semi-infinite.
    fn free_mass(&self) -> Option<f64>;

    /// Front impedance $`Z`$ [kg/s], from the high-frequency limit $`G \to 1/Z`$, if it cannot be
    /// found from [`ImpactBody::mobility_at`] at high frequency.
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

/// Largest number of lines of a spectrum, which take one gibibyte.
const MOST_LINES: usize = 1 << 26;

/// Returns the mobilities \[m/(N s)\] of `body` on the lines $`k\,\Delta f`$, $`k = 0 \ldots n-1`$,
/// for a [`StickProblem`](crate::StickProblem).
///
/// The element at 0 Hz is set to zero: it is never read, and the mobility of a free body is
/// infinite there.
///
/// # Errors
///
/// [`ImpulseError::NonPhysical`] for the step, or for more than $`2^{26}`$ lines;
/// [`ImpulseError::GridMismatch`] or [`ImpulseError::LengthMismatch`] for a measured body whose
/// lines have another spacing or are too few; errors of the body.
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
        crate::error::check_spacing("measured body", found_hz, frequency_step_hz)?;
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
