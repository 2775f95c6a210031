//! Derivatives of a modulus with respect to the parameters of its law.

use num_complex::Complex64;

use super::LaplaceModulus;
use crate::RodwaveError;
use crate::error::{check_array, check_length};

/// Complex modulus with exact derivatives with respect to its parameters.
///
/// A parameter that can have any value above 0 is replaced by its natural logarithm, in SI units,
/// and its name begins with `ln_`. A fit then cannot leave the range, and a step of 0.01 is a
/// change by one per cent. For two ordered moduli, E₁ > E₀, the coordinates are ln E₀ and ln (E₁ -
/// E₀), which preserve the order. Exponents are not transformed.
///
/// ```
/// use num_complex::Complex64;
/// use rodwave::modulus::{ComplexModulus, DifferentiableModulus, Maxwell};
///
/// let law = Maxwell::new(2.5e9, 2.5e6)?;
/// assert_eq!(law.parameter_names(), ["ln_modulus", "ln_relaxation_time"]);
/// let mut derivatives = [Complex64::ZERO; 2];
/// let modulus = law.gradient(1e4, &mut derivatives)?;
/// assert_eq!(modulus, law.at(1e4));
/// assert_eq!(derivatives[0], modulus); // E is proportional to its modulus
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
pub trait DifferentiableModulus: LaplaceModulus {
    /// Names of the parameters, in the order of every parameter array.
    fn parameter_names(&self) -> Vec<String>;

    /// The parameters, in the order of [`Self::parameter_names`].
    fn parameters(&self) -> Vec<f64>;

    /// Returns the law with other parameters. Its other properties, such as a reference frequency,
    /// are unchanged.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] unless the number of parameters is that of the law;
    /// [`RodwaveError::NonPhysical`] if a value is outside its range.
    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError>
    where
        Self: Sized;

    /// Returns E(iω) \[Pa\] at `omega` [rad/s] and writes the derivatives ∂E/∂p \[Pa per unit of
    /// p\] to `derivatives`.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] unless `derivatives` has one entry per parameter.
    fn gradient(
        &self,
        omega: f64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        self.gradient_at_s(Complex64::new(0.0, omega), derivatives)
    }

    /// Returns E(s) \[Pa\] at the Laplace variable `s` [1/s], off the negative real axis, and
    /// writes the derivatives ∂E/∂p \[Pa per unit of p\] to `derivatives`.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] unless `derivatives` has one entry per parameter.
    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError>;
}

/// Converts the parameters to an array of the length required by the law.
pub(super) fn exactly<const N: usize>(parameters: &[f64]) -> Result<[f64; N], RodwaveError> {
    check_array("array of parameters", parameters)
}

/// Copies the derivatives of a value to the caller's slice and returns the value.
pub(super) fn write(
    value: Complex64,
    values: &[Complex64],
    derivatives: &mut [Complex64],
) -> Result<Complex64, RodwaveError> {
    check_length("array of derivatives", derivatives.len(), values.len())?;
    derivatives.copy_from_slice(values);
    Ok(value)
}

/// Converts names to the form returned by the trait.
pub(super) fn named(names: &[&str]) -> Vec<String> {
    names.iter().map(ToString::to_string).collect()
}
