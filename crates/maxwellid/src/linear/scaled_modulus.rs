//! Laws made from any complex modulus.

use num_complex::Complex64;
use rodwave::modulus::DifferentiableModulus;

use super::LinearLaw;
use crate::error::{MaxwellidError, check_positive, check_range};

/// A parameter of a modulus that is identified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeParameter {
    /// Index among the parameters of the modulus.
    pub index: usize,
    /// Name of the parameter.
    pub name: &'static str,
    /// Range of the parameter, in the coordinates of the modulus.
    pub range: (f64, f64),
}

/// A law of [`rodwave::modulus`], or a user-defined law with the same traits, scaled to the
/// magnitude E at a reference frequency.
///
/// ```text
/// E(s)/E = M(s; p)/|M(iω₀; p)|
/// ```
///
/// E is the magnitude at the reference frequency ω₀. Parameters that only scale the modulus would
/// be redundant and stay fixed; the others are selected by their index.
///
/// ```
/// use maxwellid::linear::{FreeParameter, ScaledModulus};
/// use rodwave::modulus::FractionalZener;
///
/// let law = FractionalZener::new(2.0e9, 2.6e9, 1e-4, 0.4)?;
/// // E₁ - E₀, the time and the exponent are identified, E₀ stays fixed
/// let scaled = ScaledModulus::new("fractional Zener", law, 25e3, &[
///     FreeParameter { index: 1, name: "ln_modulus_increment", range: (0.02e9_f64.ln(), 2e9_f64.ln()) },
///     FreeParameter { index: 2, name: "ln_relaxation_time", range: (1e-6_f64.ln(), 1e-2_f64.ln()) },
///     FreeParameter { index: 3, name: "exponent", range: (0.1, 0.9) },
/// ])?;
/// # let _ = scaled;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScaledModulus<M> {
    name: String,
    law: M,
    reference_omega: f64,
    free: Vec<FreeParameter>,
    is_flat_loss: bool,
}

impl<M: DifferentiableModulus> ScaledModulus<M> {
    /// Creates the scaled law from `law`, whose present parameters are the start of the
    /// identification. `free` are the parameters to be identified, each with its index and range.
    ///
    /// # Errors
    /// [`MaxwellidError::UnknownParameter`] for an index that the law does not have;
    /// [`MaxwellidError::InvalidRange`] for a range that is empty or not finite;
    /// [`MaxwellidError::Setting`] for a reference frequency that is not finite and above 0.
    pub fn new(
        name: impl Into<String>,
        law: M,
        reference_omega: f64,
        free: &[FreeParameter],
    ) -> Result<Self, MaxwellidError> {
        let names = law.parameter_names();
        for parameter in free {
            if parameter.index >= names.len() {
                return Err(MaxwellidError::UnknownParameter {
                    index: parameter.index,
                    found: names.len(),
                });
            }
            check_range(parameter.name, parameter.range)?;
        }
        check_positive("reference frequency [rad/s]", reference_omega)?;
        Ok(Self {
            name: name.into(),
            law,
            reference_omega,
            free: free.to_vec(),
            is_flat_loss: false,
        })
    }

    /// Declares that the loss factor of this law can be nearly constant over a decade.
    #[must_use]
    pub fn of_flat_loss(mut self) -> Self {
        self.is_flat_loss = true;
        self
    }
}

impl<M: DifferentiableModulus + std::fmt::Debug + Send + Sync> LinearLaw for ScaledModulus<M> {
    fn name(&self) -> &str {
        &self.name
    }

    fn parameter_names(&self) -> Vec<&'static str> {
        self.free.iter().map(|parameter| parameter.name).collect()
    }

    fn start(&self) -> Vec<f64> {
        let all = self.law.parameters();
        self.free
            .iter()
            .filter_map(|parameter| all.get(parameter.index).copied())
            .collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        self.free
            .iter()
            .map(|parameter| (0.25 * (parameter.range.1 - parameter.range.0)).min(1.0))
            .collect()
    }

    fn ranges(&self) -> Vec<(f64, f64)> {
        self.free.iter().map(|parameter| parameter.range).collect()
    }

    fn is_flat_loss(&self) -> bool {
        self.is_flat_loss
    }

    fn shape(&self, s: Complex64, parameters: &[f64]) -> Option<Complex64> {
        self.shapes(&[s], parameters)?.pop()
    }

    fn shapes(&self, arguments: &[Complex64], parameters: &[f64]) -> Option<Vec<Complex64>> {
        if parameters.len() != self.free.len() {
            return None;
        }
        let mut all = self.law.parameters();
        for (parameter, value) in self.free.iter().zip(parameters) {
            *all.get_mut(parameter.index)? = *value;
        }
        let law = self.law.with_parameters(&all).ok()?;
        let reference = law.at(self.reference_omega).norm();
        let each = arguments.iter().map(|s| law.at_s(*s) / reference);
        Some(each.collect())
    }
}
