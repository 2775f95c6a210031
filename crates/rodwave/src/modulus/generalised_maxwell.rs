//! Modulus of a spring and any number of Maxwell models in parallel: a Prony series.

use num_complex::Complex64;

use super::differentiable::write;
use super::time_domain::after_step;
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus};
use crate::RodwaveError;
use crate::error::{check_length, check_not_negative, check_positive};
use crate::quotient::quotient;

/// One Maxwell model of a [`GeneralisedMaxwell`] law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxwellBranch {
    /// Modulus Eᵢ of the spring \[Pa\].
    pub modulus: f64,
    /// Relaxation time τᵢ \[s\].
    pub relaxation_time: f64,
}

/// Prony series: the law that finite-element programs use.
///
/// ```text
/// E(s) = E∞ + Σ Eᵢ sτᵢ/(1 + sτᵢ) ,    E(t) = E∞ + Σ Eᵢ e^{-t/τᵢ}
/// ```
///
/// Every monotonic relaxation is the limit of such series. E∞, the equilibrium modulus, is E(0);
/// E∞ + Σ Eᵢ is E(∞). With E∞ = 0, the material is a fluid of viscosity Σ Eᵢτᵢ. The creep
/// compliance is that of the [`RetardationSpectrum`](super::RetardationSpectrum).
///
/// ```
/// use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell, MaxwellBranch};
///
/// let law = GeneralisedMaxwell::new(2.2e9, vec![
///     MaxwellBranch { modulus: 0.2e9, relaxation_time: 1e-3 },
///     MaxwellBranch { modulus: 0.2e9, relaxation_time: 1e-4 },
/// ])?;
/// assert_eq!(law.at(0.0).re, 2.2e9);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralisedMaxwell {
    equilibrium_modulus: f64,
    branches: Vec<MaxwellBranch>,
}

impl GeneralisedMaxwell {
    /// Creates a spring of `equilibrium_modulus` E∞ >= 0 \[Pa\] in parallel with `branches`, in any
    /// order.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless E∞ is finite and not negative, all moduli and times of
    /// the branches are finite and above 0, and there is at least a spring or a branch.
    pub fn new(
        equilibrium_modulus: f64,
        branches: Vec<MaxwellBranch>,
    ) -> Result<Self, RodwaveError> {
        check_not_negative("equilibrium modulus [Pa]", equilibrium_modulus)?;
        for branch in &branches {
            check_positive("modulus of a branch [Pa]", branch.modulus)?;
            check_positive("relaxation time of a branch [s]", branch.relaxation_time)?;
        }
        let law = Self {
            equilibrium_modulus,
            branches,
        };
        check_positive("unrelaxed modulus [Pa]", law.unrelaxed_modulus())?;
        Ok(law)
    }

    /// Equilibrium modulus E∞ = E(0) \[Pa\].
    #[must_use]
    pub fn equilibrium_modulus(&self) -> f64 {
        self.equilibrium_modulus
    }

    /// The Maxwell models, in the order of construction.
    #[must_use]
    pub fn branches(&self) -> &[MaxwellBranch] {
        &self.branches
    }

    /// Unrelaxed modulus E∞ + Σ Eᵢ \[Pa\].
    #[must_use]
    pub fn unrelaxed_modulus(&self) -> f64 {
        let branches: f64 = self.branches.iter().map(|branch| branch.modulus).sum();
        self.equilibrium_modulus + branches
    }
}

impl ComplexModulus for GeneralisedMaxwell {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        let branches = self.branches.iter();
        let s = Complex64::new(0.0, omega);
        branches.map(|branch| branch.slope_at_s(s)).sum()
    }
}

impl LaplaceModulus for GeneralisedMaxwell {
    fn at_s(&self, s: Complex64) -> Complex64 {
        let branches: Complex64 = self.branches.iter().map(|branch| branch.at_s(s)).sum();
        self.equilibrium_modulus + branches
    }
}

impl MaxwellBranch {
    /// Computes Eᵢ sτᵢ/(1 + sτᵢ).
    fn at_s(&self, s: Complex64) -> Complex64 {
        let s_tau = s * self.relaxation_time;
        quotient(self.modulus * s_tau, 1.0 + s_tau)
    }

    /// Derivative with respect to ln s, which equals the derivative with respect to ln τᵢ.
    fn slope_at_s(&self, s: Complex64) -> Complex64 {
        quotient(self.at_s(s), 1.0 + s * self.relaxation_time)
    }
}

/// Parameters: `ln_equilibrium_modulus` unless E∞ = 0, which stays 0, and then `ln_modulus_1`,
/// `ln_relaxation_time_1` and so on, for the branches in the order of construction.
impl DifferentiableModulus for GeneralisedMaxwell {
    fn parameter_names(&self) -> Vec<String> {
        let equilibrium =
            (self.equilibrium_modulus > 0.0).then(|| String::from("ln_equilibrium_modulus"));
        let branches = (1..=self.branches.len())
            .flat_map(|i| [format!("ln_modulus_{i}"), format!("ln_relaxation_time_{i}")]);
        equilibrium.into_iter().chain(branches).collect()
    }

    fn parameters(&self) -> Vec<f64> {
        let equilibrium = (self.equilibrium_modulus > 0.0).then(|| self.equilibrium_modulus.ln());
        let branches = self
            .branches
            .iter()
            .flat_map(|branch| [branch.modulus.ln(), branch.relaxation_time.ln()]);
        equilibrium.into_iter().chain(branches).collect()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let solid = usize::from(self.equilibrium_modulus > 0.0);
        let expected = solid + 2 * self.branches.len();
        check_length("array of parameters", parameters.len(), expected)?;
        let (equilibrium, branches) = parameters.split_at(solid);
        let equilibrium_modulus = match equilibrium {
            [logarithm] => check_positive("equilibrium modulus [Pa]", logarithm.exp())?,
            _ => 0.0,
        };
        let branches = branches
            .as_chunks()
            .0
            .iter()
            .map(|[modulus, time]| MaxwellBranch {
                modulus: modulus.exp(),
                relaxation_time: time.exp(),
            });
        Self::new(equilibrium_modulus, branches.collect())
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let equilibrium =
            (self.equilibrium_modulus > 0.0).then(|| Complex64::from(self.equilibrium_modulus));
        let branches = self
            .branches
            .iter()
            .flat_map(|branch| [branch.at_s(s), branch.slope_at_s(s)]);
        let values: Vec<_> = equilibrium.into_iter().chain(branches).collect();
        write(self.at_s(s), &values, derivatives)
    }
}

impl TimeDomainModulus for GeneralisedMaxwell {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        let time = after_step(time)?;
        let branches: f64 = self
            .branches
            .iter()
            .map(|branch| branch.modulus * (-time / branch.relaxation_time).exp())
            .sum();
        Ok(self.equilibrium_modulus + branches)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        self.retardation_spectrum().creep_compliance(time)
    }
}
