//! What can be wrong with a request for a force.

use num_complex::Complex64;
use rodwave::RodwaveError;
use thiserror::Error;

/// Why a force could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ImpulseError {
    /// A scalar has a value that cannot be.
    #[error("{quantity} is {value}, expected {expected}")]
    NonPhysical {
        /// Name and unit of the quantity, as `impact velocity \[m/s\]`.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// The condition it violates.
        expected: &'static str,
    },
    /// An element of an array is NaN or infinite.
    #[error("element {index} of the {what} is not finite")]
    NonFinite {
        /// Name of the array.
        what: &'static str,
        /// Position of the element, from 0.
        index: usize,
    },
    /// An array does not have the length that the others fix.
    #[error("the {what} has {found} elements, expected {expected}")]
    LengthMismatch {
        /// Name of the array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// An array is too short for what is asked.
    #[error("the {what} has {found} elements, expected at least {expected}")]
    TooShort {
        /// Name of the array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length needed.
        expected: usize,
    },
    /// The two mobilities cancel: no finite force gives a velocity there.
    #[error("the sum of the mobilities vanishes at line {index}")]
    VanishingMobility {
        /// Index of the spectral line.
        index: usize,
    },
    /// The force spectrum is not finite although everything that entered it is.
    #[error("the force spectrum overflows at line {index}")]
    SpectrumOverflow {
        /// Index of the spectral line.
        index: usize,
    },
    /// A line to be left out does not exist.
    #[error("line {index} is to be left out, but there are only {n_lines} lines")]
    UnknownLine {
        /// Index of the line.
        index: usize,
        /// Number of lines.
        n_lines: usize,
    },
    /// An interval ends before it begins, or is not a number.
    #[error("the {what} runs from {from} to {to}, expected finite and increasing limits")]
    EmptyInterval {
        /// Which interval.
        what: &'static str,
        /// Its lower limit.
        from: f64,
        /// Its upper limit.
        to: f64,
    },
    /// The force is said to act when nothing was recorded.
    #[error("the support from {from} s to {to} s holds no sample of the response")]
    SupportOutsideRecord {
        /// Begin of the support \[s\].
        from: f64,
        /// End of the support \[s\].
        to: f64,
    },
    /// The force acts for longer than its dense equations are solved for.
    #[error("the support holds {found} samples, expected at most {expected}")]
    SupportTooLong {
        /// Its length.
        found: usize,
        /// The largest length.
        expected: usize,
    },
    /// The noise of some sensors is known, and not of this one: they cannot be weighed against each other.
    #[error("the noise of sensor {index} is known and that of sensor 0 is not, or the reverse")]
    MixedNoise {
        /// Index of the sensor.
        index: usize,
    },
    /// A regularisation parameter is to be found from the noise of the response.
    #[error("the discrepancy principle needs the noise of the response, and it is not known")]
    NoiseNotKnown,
    /// The force is sought all over the record.
    #[error("{what} needs a support, and there is none")]
    NoSupport {
        /// The force that needs one.
        what: &'static str,
    },
    /// Components are cut off that a force without tension cannot be without.
    #[error(
        "a force without tension cannot be regularised by truncation, expected none or Tikhonov's"
    )]
    TruncatedWithoutTension,
    /// The iteration for eigenvalues did not end.
    #[error("the eigenvalues of the {size} equations of the support were not found")]
    NoDecomposition {
        /// Number of equations.
        size: usize,
    },
    /// A body of elements has no mobility there.
    #[error("mobility at s = {s} 1/s: {source}")]
    Body {
        /// The Laplace variable [1/s].
        s: Complex64,
        /// What is wrong.
        source: RodwaveError,
    },
    /// A mobility is asked for where it is not known.
    #[error("the mobility is asked for at s = {s} 1/s, expected {expected}")]
    OutsideDomain {
        /// The Laplace variable [1/s].
        s: Complex64,
        /// Where it is known.
        expected: &'static str,
    },
    /// A measured body is to be marched in time, and what it does above its lines is not known.
    #[error(
        "a measured body has no front impedance, expected the impedance A sqrt(E rho) [kg/s] of its face for a force by marching in time; \
         without it the stick force on lines can be had"
    )]
    NoFrontImpedance,
    /// A mobility has no finite value.
    #[error("the mobility of the {body} body at s = {s} 1/s is not finite")]
    InfiniteMobility {
        /// Which body.
        body: &'static str,
        /// The Laplace variable [1/s].
        s: Complex64,
    },
    /// Two bodies are known on different lines.
    #[error(
        "the lines of the {what} are {found_hz} Hz apart, expected {expected_hz} Hz as those of the other body"
    )]
    GridMismatch {
        /// Which spectrum.
        what: &'static str,
        /// Distance of its lines \[Hz\].
        found_hz: f64,
        /// Distance of the lines of the other \[Hz\].
        expected_hz: f64,
    },
    /// A measured body has no line at 0 Hz, and nothing stands in for it.
    #[error(
        "line 0 of the {what} is not finite, expected the line at 0 Hz, a weighed mass or a fixed body"
    )]
    MissingZeroLine {
        /// Which spectrum.
        what: &'static str,
    },
    /// The mass of a body is not the one with which its mobility begins.
    #[error(
        "the mobility of the {body} body begins as that of {found} kg, expected its mass of {expected} kg"
    )]
    MassContradictsMobility {
        /// Which body.
        body: &'static str,
        /// Mass by the mobility \[kg\].
        found: f64,
        /// Mass that was stated \[kg\].
        expected: f64,
    },
    /// The faces do not yield to a force at once: no march can find it.
    #[error(
        "the faces answer a force step within {time_step} s with {weight} m/(N s), expected a velocity above 0"
    )]
    ActiveFaces {
        /// Velocity after the first step over the force [m/(N s)].
        weight: f64,
        /// The time step \[s\].
        time_step: f64,
    },
    /// Two faces with a mass on each, and nothing soft between them.
    #[error(
        "the mobility of the faces falls to {ratio} over a decade at the end of the band, as that of two rigid masses, \
         expected a contact law between them: the force of a rigid contact is infinite"
    )]
    RigidFaces {
        /// Mobility a decade higher over the mobility.
        ratio: f64,
    },
    /// The march has left the range of numbers.
    #[error("the force is not finite at step {step}, {time} s after contact")]
    Diverged {
        /// The step, from 0.
        step: usize,
        /// The time \[s\].
        time: f64,
    },
    /// The points of a contact law are not those of a force that grows with the approach.
    #[error("point {index} of the contact law is ({approach} m, {force} N), expected {expected}")]
    ContactTable {
        /// Index of the point.
        index: usize,
        /// Its approach \[m\].
        approach: f64,
        /// Its force \[N\].
        force: f64,
        /// What it violates.
        expected: &'static str,
    },
    /// A result, or a square on the way to it, is too large or too small for a number.
    #[error("the {what} leaves the range of numbers")]
    OutOfRange {
        /// What was computed.
        what: &'static str,
    },
    /// No spectral line is left to compute a force from.
    #[error("none of the {n_lines} lines can be used")]
    NoUsableLine {
        /// Number of lines.
        n_lines: usize,
    },
}

/// Accepts a finite value above zero.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<f64, ImpulseError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ImpulseError::NonPhysical {
            quantity,
            value,
            expected: "a finite value above 0",
        })
    }
}

/// Accepts a finite value that is not negative.
pub(crate) fn check_not_negative(quantity: &'static str, value: f64) -> Result<f64, ImpulseError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ImpulseError::NonPhysical {
            quantity,
            value,
            expected: "a finite value, 0 or above",
        })
    }
}

/// Accepts finite limits in increasing order.
pub(crate) fn check_interval(what: &'static str, from: f64, to: f64) -> Result<(), ImpulseError> {
    if from.is_finite() && to.is_finite() && from < to {
        Ok(())
    } else {
        Err(ImpulseError::EmptyInterval { what, from, to })
    }
}

/// Accepts finite lines only.
pub(crate) fn check_lines_finite(
    what: &'static str,
    lines: &[Complex64],
) -> Result<(), ImpulseError> {
    match lines.iter().position(|line| !line.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ImpulseError::NonFinite { what, index }),
    }
}

/// Accepts finite samples only.
pub(crate) fn check_samples(what: &'static str, samples: &[f64]) -> Result<(), ImpulseError> {
    match samples.iter().position(|sample| !sample.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ImpulseError::NonFinite { what, index }),
    }
}
