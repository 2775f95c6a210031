//! Derivatives of a modulus by the parameters of its law.

use num_complex::Complex64;

use super::ComplexModulus;
use crate::RodwaveError;

/// A complex modulus with exact derivatives by its parameters.
///
/// A parameter that nature allows to be any number above 0 is held as its natural logarithm, in SI units, and its name
/// begins with `ln_`: a fit then cannot leave the range, and a step of 0.01 is one per cent. Where two moduli are
/// ordered, E₁ > E₀, the coordinates are ln E₀ and ln (E₁ - E₀), which keep the order. Exponents are held as they are.
///
/// ```
/// use num_complex::Complex64;
/// use rodwave::modulus::{ComplexModulus, DifferentiableModulus, Maxwell};
///
/// let law = Maxwell::new(2.5e9, 2.5e6)?;
/// assert_eq!(law.parameter_names(), ["ln_modulus", "ln_relaxation_time"]);
/// let mut derivatives = [Complex64::ZERO; 2];
/// law.gradient(1e4, &mut derivatives)?;
/// assert_eq!(derivatives[0], law.at(1e4)); // E is proportional to its modulus
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
pub trait DifferentiableModulus: ComplexModulus {
    /// Names of the parameters, in the order of every parameter array.
    fn parameter_names(&self) -> Vec<String>;

    /// The parameters, in the order of [`Self::parameter_names`].
    fn parameters(&self) -> Vec<f64>;

    /// The law with other parameters; what is no parameter, as a reference frequency, stays.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] unless there are as many as the law has;
    /// [`RodwaveError::NonPhysical`] if a value is out of its range.
    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError>
    where
        Self: Sized;

    /// Writes the derivatives ∂E/∂p \[Pa per unit of p\] at `omega` [rad/s] to `derivatives`.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] unless `derivatives` has one entry a parameter.
    fn gradient(&self, omega: f64, derivatives: &mut [Complex64]) -> Result<(), RodwaveError>;
}

/// The parameters as an array of the length that the law has.
pub(super) fn exactly<const N: usize>(parameters: &[f64]) -> Result<[f64; N], RodwaveError> {
    parameters
        .try_into()
        .map_err(|_| RodwaveError::LengthMismatch {
            what: "array of parameters",
            found: parameters.len(),
            expected: N,
        })
}

/// Copies the derivatives to the place that the caller gave.
pub(super) fn write(
    values: &[Complex64],
    derivatives: &mut [Complex64],
) -> Result<(), RodwaveError> {
    if values.len() != derivatives.len() {
        return Err(RodwaveError::LengthMismatch {
            what: "array of derivatives",
            found: derivatives.len(),
            expected: values.len(),
        });
    }
    derivatives.copy_from_slice(values);
    Ok(())
}

/// Names as the trait returns them.
pub(super) fn named(names: &[&str]) -> Vec<String> {
    names.iter().map(ToString::to_string).collect()
}
