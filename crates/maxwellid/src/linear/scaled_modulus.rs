//! Any complex modulus as a law to be identified.

use num_complex::Complex64;
use rodwave::modulus::{DifferentiableModulus, LaplaceModulus};

use super::LinearLaw;
use crate::MaxwellidError;

/// A law of [`rodwave::modulus`], or one's own of its traits, up to a factor that ln E takes over.
///
/// ```text
/// E(s)/E = M(s; p)/|M(iω₀; p)|
/// ```
///
/// E is the magnitude at the reference frequency ω₀. Parameters that only scale the modulus would be told by the data twice
/// and stay as they are; the others are set free by index.
///
/// ```
/// use maxwellid::linear::ScaledModulus;
/// use rodwave::modulus::FractionalZener;
///
/// let law = FractionalZener::new(2.0e9, 2.6e9, 1e-4, 0.4)?;
/// // E₁ - E₀, the time and the exponent are free, E₀ stays
/// let scaled = ScaledModulus::new("fractional Zener", law, 25e3, &[
///     (1, (0.02e9_f64.ln(), 2e9_f64.ln())),
///     (2, (1e-6_f64.ln(), 1e-2_f64.ln())),
///     (3, (0.1, 0.9)),
/// ])?;
/// # let _ = scaled;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScaledModulus<M> {
    name: String,
    law: M,
    reference_omega: f64,
    free: Vec<(usize, (f64, f64))>,
    is_flat_loss: bool,
}

impl<M: LaplaceModulus + DifferentiableModulus> ScaledModulus<M> {
    /// The law with its present parameters as start; `free` are the indices of the parameters to be identified, each with
    /// its range (in the coordinates of the law).
    ///
    /// # Errors
    /// [`MaxwellidError::UnknownParameter`] for an index that the law does not have;
    /// [`MaxwellidError::InvalidRange`] for a range that is empty or not finite;
    /// [`MaxwellidError::Setting`] for a reference frequency that is not finite and above 0.
    pub fn new(
        name: impl Into<String>,
        law: M,
        reference_omega: f64,
        free: &[(usize, (f64, f64))],
    ) -> Result<Self, MaxwellidError> {
        let names = law.parameter_names();
        for (index, (low, high)) in free {
            let Some(parameter) = names.get(*index) else {
                return Err(MaxwellidError::UnknownParameter {
                    index: *index,
                    found: names.len(),
                });
            };
            if !(low.is_finite() && high.is_finite() && low < high) {
                return Err(MaxwellidError::InvalidRange {
                    parameter: parameter.clone(),
                    low: *low,
                    high: *high,
                });
            }
        }
        if !(reference_omega.is_finite() && reference_omega > 0.0) {
            return Err(MaxwellidError::Setting {
                setting: "reference frequency [rad/s]",
                value: reference_omega,
                expected: "a finite value above 0",
            });
        }
        Ok(Self {
            name: name.into(),
            law,
            reference_omega,
            free: free.to_vec(),
            is_flat_loss: false,
        })
    }

    /// States that the loss factor of this law can be nearly constant over a decade.
    #[must_use]
    pub fn of_flat_loss(mut self) -> Self {
        self.is_flat_loss = true;
        self
    }
}

impl<M: LaplaceModulus + DifferentiableModulus + std::fmt::Debug + Send + Sync> LinearLaw
    for ScaledModulus<M>
{
    fn name(&self) -> &str {
        &self.name
    }

    fn parameter_names(&self) -> Vec<String> {
        let names = self.law.parameter_names();
        self.free
            .iter()
            .filter_map(|(index, _)| names.get(*index).cloned())
            .collect()
    }

    fn start(&self) -> Vec<f64> {
        let all = self.law.parameters();
        self.free
            .iter()
            .filter_map(|(index, _)| all.get(*index).copied())
            .collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        self.free
            .iter()
            .map(|(_, (low, high))| (0.25 * (high - low)).min(1.0))
            .collect()
    }

    fn ranges(&self) -> Vec<(f64, f64)> {
        self.free.iter().map(|(_, range)| *range).collect()
    }

    fn is_flat_loss(&self) -> bool {
        self.is_flat_loss
    }

    fn shape(&self, s: Complex64, parameters: &[f64]) -> Option<Complex64> {
        if parameters.len() != self.free.len() {
            return None;
        }
        let mut all = self.law.parameters();
        for ((index, _), value) in self.free.iter().zip(parameters) {
            *all.get_mut(*index)? = *value;
        }
        let law = self.law.with_parameters(&all).ok()?;
        Some(law.at_s(s) / law.at(self.reference_omega).norm())
    }
}
