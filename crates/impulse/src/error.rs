//! Errors of force computations.

use num_complex::Complex64;
use rodwave::RodwaveError;
use thiserror::Error;

/// Reasons why a force could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the message of an error names its fields")]
#[non_exhaustive]
pub enum ImpulseError {
    /// A scalar has an impossible value.
    #[error("{quantity} is {value}, expected {expected}")]
    NonPhysical {
        /// Name and unit of the quantity, for example `impact velocity \[m/s\]`.
        quantity: &'static str,
        value: f64,
        /// The condition it violates.
        expected: &'static str,
    },
    /// An element of an array is NaN or infinite.
    #[error("element {index} of the {what} is not finite")]
    NonFinite {
        what: &'static str,
        /// Position of the element, from 0.
        index: usize,
    },
    /// The length of an array does not match that of the other arrays.
    #[error("the {what} has {found} elements, expected {expected}")]
    LengthMismatch {
        what: &'static str,
        found: usize,
        expected: usize,
    },
    /// An array is too short for the operation.
    #[error("the {what} has {found} elements, expected at least {expected}")]
    TooShort {
        what: &'static str,
        /// Length found.
        found: usize,
        /// Length needed.
        expected: usize,
    },
    /// The two mobilities cancel at a line: no finite force gives a velocity there.
    #[error("the sum of the mobilities vanishes at line {index}")]
    VanishingMobility {
        /// Index of the spectral line.
        index: usize,
    },
    /// The force spectrum is not finite although all inputs are.
    #[error("the force spectrum overflows at line {index}")]
    SpectrumOverflow {
        /// Index of the spectral line.
        index: usize,
    },
    /// A line to be excluded does not exist.
    #[error("line {index} is to be left out, but there are only {n_lines} lines")]
    UnknownLine { index: usize, n_lines: usize },
    /// An interval ends before it begins, or is not a number.
    #[error("the {what} runs from {from} to {to}, expected finite and increasing limits")]
    EmptyInterval {
        what: &'static str,
        /// Lower limit.
        from: f64,
        /// Upper limit.
        to: f64,
    },
    /// The support of the force lies outside the record.
    #[error("the support from {from} s to {to} s contains no sample of the response")]
    SupportOutsideRecord {
        /// Start of the support \[s\].
        from: f64,
        /// End of the support \[s\].
        to: f64,
    },
    /// The support of the force is too long for its dense equations.
    #[error("the support of the force contains {found} samples, expected at most {expected}")]
    SupportTooLong {
        /// Length found.
        found: usize,
        /// Largest length.
        expected: usize,
    },
    /// The noise of this sensor is known and that of sensor 0 is not, or the reverse: the two
    /// cannot be weighted.
    #[error(
        "the noise is known for only one of sensor {index} and sensor 0, expected both or neither"
    )]
    MixedNoise { index: usize },
    /// The discrepancy principle requires the noise of the response, which is not known.
    #[error("the discrepancy principle needs the noise of the response, which is not known")]
    NoiseNotKnown,
    /// A method requires a support, but the force is sought over the whole record.
    #[error("{what} needs a support, but none is given")]
    NoSupport { what: &'static str },
    /// Truncation may not be used for a force without tension: it removes components that such a
    /// force requires.
    #[error(
        "a force without tension cannot be regularised by truncation, expected Tikhonov regularisation or none"
    )]
    TruncatedWithoutTension,
    /// The eigenvalue iteration did not converge.
    #[error("the eigenvalues of {size} equations were not found")]
    NoDecomposition { size: usize },
    /// A body made of elements has no mobility at this Laplace variable.
    #[error("mobility at s = {s} 1/s: {source}")]
    Body {
        /// The Laplace variable [1/s].
        s: Complex64,
        source: RodwaveError,
    },
    /// A mobility is requested outside its domain.
    #[error("the mobility was requested at s = {s} 1/s, expected {expected}")]
    OutsideDomain {
        /// The Laplace variable [1/s].
        s: Complex64,
        expected: &'static str,
    },
    /// Time marching needs the unknown behaviour of a measured body above its lines.
    #[error(
        "a measured body has no front impedance, expected the impedance A sqrt(E rho) [kg/s] of its face, which time marching needs; \
         the stick force on lines does not need it"
    )]
    NoFrontImpedance,
    /// A mobility has no finite value.
    #[error("the mobility of the {body} body at s = {s} 1/s is not finite")]
    InfiniteMobility {
        body: &'static str,
        /// The Laplace variable [1/s].
        s: Complex64,
    },
    /// Two bodies are known on different lines.
    #[error(
        "the lines of the {what} are {found_hz} Hz apart, expected {expected_hz} Hz as for the other body"
    )]
    GridMismatch {
        /// The spectrum.
        what: &'static str,
        /// Spacing of its lines \[Hz\].
        found_hz: f64,
        /// Spacing of the lines of the other body \[Hz\].
        expected_hz: f64,
    },
    /// A measured body has no line at 0 Hz, and nothing replaces it.
    #[error(
        "line 0 of the {what} is not finite, expected the line at 0 Hz, a weighed mass or a fixed body"
    )]
    MissingZeroLine {
        /// The spectrum.
        what: &'static str,
    },
    /// The stated mass of a body differs from the mass that its mobility shows at low frequency.
    #[error(
        "the mobility of the {body} body at low frequency is that of {found} kg, expected its stated mass of {expected} kg"
    )]
    MassContradictsMobility {
        body: &'static str,
        /// Mass from the mobility \[kg\].
        found: f64,
        /// Stated mass \[kg\].
        expected: f64,
    },
    /// The faces have no instantaneous response to a force, which time marching requires.
    #[error(
        "the velocity of the faces after the first step of {time_step} s is {weight} m/s per newton, expected a value above 0"
    )]
    ActiveFaces {
        /// Velocity after the first step, divided by the force [m/(N s)].
        weight: f64,
        /// The time step \[s\].
        time_step: f64,
    },
    /// Both faces have a mass, without compliance between them.
    #[error(
        "the mobility of the faces falls to {ratio} over a decade at the end of the band, as for two rigid masses, \
         expected a contact law between them: without one, the impact force is infinite"
    )]
    RigidFaces {
        /// Mobility at ten times a frequency far above the band, divided by the mobility at this
        /// frequency.
        ratio: f64,
    },
    /// The time integration has overflowed.
    #[error("the force is not finite at step {step}, {time} s after contact")]
    Diverged {
        /// The step, from 0.
        step: usize,
        /// The time \[s\].
        time: f64,
    },
    /// The force of a contact law does not increase with the approach at some point.
    #[error("point {index} of the contact law is ({approach} m, {force} N), expected {expected}")]
    ContactTable {
        index: usize,
        /// Approach of the point \[m\].
        approach: f64,
        /// Force of the point \[N\].
        force: f64,
        /// The condition that it violates.
        expected: &'static str,
    },
    /// A joint of an assembly names a point that its member does not have.
    #[error("{place} is point {point} of member {member}, expected {expected}")]
    NoSuchPoint {
        /// Place at which the point is named.
        place: &'static str,
        /// Index of the member.
        member: usize,
        /// Index of the point.
        point: usize,
        /// Points that exist.
        expected: &'static str,
    },
    /// A member of an assembly is not joined to the struck one.
    #[error(
        "member {member} is not joined to the struck member, directly or through others, expected a joint"
    )]
    NotJoined {
        /// Index of the member.
        member: usize,
    },
    /// A result, or an intermediate square, overflows or underflows.
    #[error("the {what} is outside the range of floating-point numbers")]
    OutOfRange {
        /// The quantity computed.
        what: &'static str,
    },
    /// The record of a bar contains no pulse.
    #[error(
        "the record of the {bar} has a peak of {largest} with a noise of {noise}, expected a pulse of ten times the noise"
    )]
    NoPulse {
        bar: &'static str,
        /// Largest sample after the level at rest is subtracted.
        largest: f64,
        /// Standard deviation of the samples before the pulse.
        noise: f64,
    },
    /// The transmitted bar responds before the incident bar.
    #[error(
        "the transmitted bar responds at {transmitted} s, before the incident bar at {incident} s, expected the reverse: the two channels may be exchanged"
    )]
    TransmittedFirst {
        /// First sample of the pulse on the incident bar \[s\].
        incident: f64,
        /// First sample of the pulse on the transmitted bar \[s\].
        transmitted: f64,
    },
    /// A record is disturbed before the stated end of its silence.
    #[error(
        "the silence in the record of the {bar} ends at {found} s, expected silence up to {stated} s: state a shorter silence"
    )]
    SilenceEnds {
        bar: &'static str,
        /// Time of the first sample far from rest \[s\].
        found: f64,
        /// Stated end of the silence \[s\].
        stated: f64,
    },
    /// A bar has no longitudinal wave of the first mode.
    #[error(
        "a bar has no wave of the first mode at {frequency_hz} Hz, expected a band that ends below it"
    )]
    NoBarWave {
        /// The frequency \[Hz\].
        frequency_hz: f64,
    },
    /// No usable spectral line remains for a force.
    #[error("none of the {n_lines} lines can be used")]
    NoUsableLine { n_lines: usize },
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

/// Accepts a spacing `found_hz` of lines that equals the spacing `expected_hz` of the other body,
/// within the precision of a step computed from a sampling rate.
pub(crate) fn check_spacing(
    what: &'static str,
    found_hz: f64,
    expected_hz: f64,
) -> Result<(), ImpulseError> {
    if (found_hz / expected_hz - 1.0).abs() > 1e-9 {
        return Err(ImpulseError::GridMismatch {
            what,
            found_hz,
            expected_hz,
        });
    }
    Ok(())
}

/// Accepts a finite value.
pub(crate) fn check_finite(quantity: &'static str, value: f64) -> Result<f64, ImpulseError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ImpulseError::NonPhysical {
            quantity,
            value,
            expected: "a finite value",
        })
    }
}

/// Accepts an array of the expected length.
pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), ImpulseError> {
    if found == expected {
        Ok(())
    } else {
        Err(ImpulseError::LengthMismatch {
            what,
            found,
            expected,
        })
    }
}

/// Accepts an array of at least the expected length.
pub(crate) fn check_enough(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), ImpulseError> {
    if found >= expected {
        Ok(())
    } else {
        Err(ImpulseError::TooShort {
            what,
            found,
            expected,
        })
    }
}

/// Accepts a probability above 0 and below 1.
pub(crate) fn check_probability(quantity: &'static str, value: f64) -> Result<f64, ImpulseError> {
    if value > 0.0 && value < 1.0 {
        Ok(value)
    } else {
        Err(ImpulseError::NonPhysical {
            quantity,
            value,
            expected: "a probability between 0 and 1",
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

/// Accepts lines that are all finite.
pub(crate) fn check_lines_finite(
    what: &'static str,
    lines: &[Complex64],
) -> Result<(), ImpulseError> {
    match lines.iter().position(|line| !line.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ImpulseError::NonFinite { what, index }),
    }
}

/// Accepts samples that are all finite.
pub(crate) fn check_samples(what: &'static str, samples: &[f64]) -> Result<(), ImpulseError> {
    match samples.iter().position(|sample| !sample.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ImpulseError::NonFinite { what, index }),
    }
}
