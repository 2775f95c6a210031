//! Errors of this crate.

use num_complex::Complex64;
use thiserror::Error;

/// Reasons to reject a body, a law or a computation.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RodwaveError {
    /// A physical quantity has an impossible value, or is not a number.
    #[error("{quantity} is {value}, expected {expected}")]
    NonPhysical {
        /// Name and unit of the quantity, for example `density [kg/m^3]`.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// The condition it violates, for example `a finite value above 0`.
        expected: &'static str,
    },
    /// A sample of a history is NaN or infinite.
    #[error("sample {index} of {history} is {value}, expected a finite value")]
    NonFiniteSample {
        /// Name of the history.
        history: &'static str,
        /// Position of the sample, from 0.
        index: usize,
        /// The value found.
        value: f64,
    },
    /// An element of a body is invalid, or its response at the given frequency is not defined.
    #[error("element {index}: {source}")]
    InElement {
        /// Position of the element, from 0 at the impact face.
        index: usize,
        /// The error of the element.
        source: Box<Self>,
    },
    /// Two arrays differ in length although their lengths must be equal.
    #[error("{what} has {found} entries, expected {expected}")]
    LengthMismatch {
        /// The array with the wrong length.
        what: &'static str,
        /// Length found.
        found: usize,
        /// Length expected.
        expected: usize,
    },
    /// A history has too few samples for an operation.
    #[error("{history} has {found} samples, expected at least {expected}")]
    TooFewSamples {
        /// Name of the history.
        history: &'static str,
        /// Number of samples found.
        found: usize,
        /// Number needed.
        expected: usize,
    },
    /// A value is requested outside a table.
    #[error(
        "{quantity} is {value}, expected a value from {lower} to {upper}, the range of the table"
    )]
    OutsideTable {
        /// Name and unit of the argument, for example `angular frequency [rad/s]`.
        quantity: &'static str,
        /// The argument found.
        value: f64,
        /// The smallest argument in the table.
        lower: f64,
        /// The largest argument in the table.
        upper: f64,
    },
    /// A requested section is outside the body.
    #[error(
        "{what} is {position} m from the end of a body of {length} m, expected a position inside the body"
    )]
    OutsideBody {
        /// The object at the section, for example `a gauge`.
        what: &'static str,
        /// The position found, in metres.
        position: f64,
        /// Length of the body, in metres.
        length: f64,
    },
    /// The law of a branch of a line has no parameter of this name.
    #[error("segment {segment}, branch {branch} has no parameter `{name}`")]
    UnknownParameter {
        /// Position of the segment, from 0 at the left end.
        segment: usize,
        /// Position of the branch in its material, from 0.
        branch: usize,
        /// The requested name.
        name: &'static str,
    },
    /// A law has no finite propagation coefficient at the given frequency, for example a tabulated
    /// law outside its band, or a fluid at rest.
    #[error("the law has no finite propagation coefficient at s = {s} 1/s")]
    NoPropagation {
        /// The Laplace variable, iω on the frequency axis.
        s: Complex64,
    },
    /// The response is requested beyond the end of the excitation.
    #[error("the response is requested until {needed} s, but the excitation ends at {found} s")]
    ExcitationTooShort {
        /// End of the requested window, in seconds from the first sample.
        needed: f64,
        /// End of the excitation, in seconds from its first sample.
        found: f64,
    },
}

impl RodwaveError {
    /// Adds the position of the element to an error.
    pub(crate) fn in_element(self, index: usize) -> Self {
        let source = Box::new(self);
        Self::InElement { index, source }
    }
}

/// Returns `value` if the condition `holds`, otherwise the error that it is not `expected`.
#[inline]
pub(crate) fn check_that(
    holds: bool,
    quantity: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<f64, RodwaveError> {
    if holds {
        Ok(value)
    } else {
        Err(RodwaveError::NonPhysical {
            quantity,
            value,
            expected,
        })
    }
}

/// Checks that a value is finite and above zero, and returns it.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<f64, RodwaveError> {
    let holds = value.is_finite() && value > 0.0;
    check_that(holds, quantity, value, "a finite value above 0")
}

/// Checks that a value is finite and not below zero, and returns it.
pub(crate) fn check_not_negative(quantity: &'static str, value: f64) -> Result<f64, RodwaveError> {
    let holds = value.is_finite() && value >= 0.0;
    check_that(holds, quantity, value, "a finite value, 0 or above")
}

/// Checks that a value is finite, and returns it.
pub(crate) fn check_finite(quantity: &'static str, value: f64) -> Result<f64, RodwaveError> {
    check_that(value.is_finite(), quantity, value, "a finite value")
}

/// Checks that all values are finite.
pub(crate) fn check_all_finite(
    quantity: &'static str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), RodwaveError> {
    values
        .into_iter()
        .try_for_each(|value| check_finite(quantity, value).map(drop))
}

/// Largest number of cells of a march. Each of its arrays then takes a gigabyte.
const MOST_CELLS: usize = 1 << 27;

/// Checks that a number of cells is sufficient for a march and within the memory limit.
pub(crate) fn check_cells(
    cells: usize,
    fewest: usize,
    expected: &'static str,
) -> Result<usize, RodwaveError> {
    let holds = (fewest..=MOST_CELLS).contains(&cells);
    check_that(holds, "number of cells", cells as f64, expected)?;
    Ok(cells)
}

/// Rounds a number of time steps down to an integer, after a check that it is at most 1e9, which
/// limits the length of a march and the memory of its histories.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be between 0 and 1e9"
)]
pub(crate) fn check_steps(steps: f64) -> Result<usize, RodwaveError> {
    let holds = (0.0..=1e9).contains(&steps);
    Ok(check_that(holds, "number of time steps", steps, "at most 1e9")? as usize)
}

/// Checks that an array has the expected length.
#[inline]
pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), RodwaveError> {
    if found == expected {
        Ok(())
    } else {
        Err(RodwaveError::LengthMismatch {
            what,
            found,
            expected,
        })
    }
}

/// Converts parameters to an array of the length that a law requires.
pub(crate) fn check_array<const N: usize>(
    what: &'static str,
    parameters: &[f64],
) -> Result<[f64; N], RodwaveError> {
    let array = parameters.try_into();
    array.map_err(|_| RodwaveError::LengthMismatch {
        what,
        found: parameters.len(),
        expected: N,
    })
}

/// Checks that a history has at least the expected number of samples.
pub(crate) fn check_enough_samples(
    history: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), RodwaveError> {
    if found >= expected {
        Ok(())
    } else {
        Err(RodwaveError::TooFewSamples {
            history,
            found,
            expected,
        })
    }
}

/// Checks that all samples of a history are finite.
pub(crate) fn check_samples(history: &'static str, samples: &[f64]) -> Result<(), RodwaveError> {
    match samples.iter().enumerate().find(|(_, s)| !s.is_finite()) {
        None => Ok(()),
        Some((index, &value)) => Err(RodwaveError::NonFiniteSample {
            history,
            index,
            value,
        }),
    }
}

/// Checks that the propagation coefficient of a law is finite at `s`, and returns it.
#[inline]
pub(crate) fn check_propagation(
    propagation_coefficient: Complex64,
    s: Complex64,
) -> Result<Complex64, RodwaveError> {
    if propagation_coefficient.is_finite() {
        Ok(propagation_coefficient)
    } else {
        Err(RodwaveError::NoPropagation { s })
    }
}

/// Checks that s is finite and in the closed right half plane, and returns it.
pub(crate) fn check_laplace_variable(s: Complex64) -> Result<Complex64, RodwaveError> {
    check_finite("imaginary part of the Laplace variable [rad/s]", s.im)?;
    check_not_negative("real part of the Laplace variable [1/s]", s.re)?;
    Ok(s)
}
