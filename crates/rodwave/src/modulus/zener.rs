//! Modulus of the Zener model, the standard linear solid.

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::time_domain::{after_step, finite_compliance};
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus};
use crate::RodwaveError;
use crate::error::{check_positive, check_that};
use crate::quotient::quotient;

/// Spring in parallel with a Maxwell model: the simplest solid with a finite wave speed.
///
/// ```text
/// E(s) = E₀ + (E₁ - E₀) sτ/(1 + sτ)
/// ```
///
/// E₀ = E(0) is the relaxed modulus, E₁ = E(∞) the unrelaxed one. The loss factor has its largest
/// value (E₁ - E₀)/(2 (E₀ E₁)^½) at ωτ = (E₀/E₁)^½.
///
/// ```
/// use rodwave::modulus::{ComplexModulus, Zener};
///
/// let law = Zener::new(2.0e9, 2.2e9, 1e-4)?;
/// let modulus = law.at((2.0_f64 / 2.2).sqrt() / 1e-4);
/// assert!((modulus.im / modulus.re - 0.1 / 4.4_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zener {
    step: ModulusStep,
    relaxation_time: f64,
}

impl Zener {
    /// Creates a solid of `relaxed_modulus` E₀ \[Pa\], `unrelaxed_modulus` E₁ > E₀ \[Pa\] and
    /// `relaxation_time` τ \[s\] at constant strain.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0 and E₁ exceeds E₀.
    pub fn new(
        relaxed_modulus: f64,
        unrelaxed_modulus: f64,
        relaxation_time: f64,
    ) -> Result<Self, RodwaveError> {
        Ok(Self {
            step: ModulusStep::new(relaxed_modulus, unrelaxed_modulus)?,
            relaxation_time: check_positive("relaxation time [s]", relaxation_time)?,
        })
    }
}

/// Relaxed and unrelaxed modulus of a solid, E₀ < E₁.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ModulusStep {
    pub(super) relaxed: f64,
    pub(super) unrelaxed: f64,
}

impl ModulusStep {
    pub(super) fn new(relaxed: f64, unrelaxed: f64) -> Result<Self, RodwaveError> {
        let relaxed = check_positive("relaxed modulus [Pa]", relaxed)?;
        let unrelaxed = check_positive("unrelaxed modulus [Pa]", unrelaxed)?;
        check_that(
            unrelaxed > relaxed,
            "unrelaxed modulus [Pa]",
            unrelaxed,
            "more than the relaxed modulus",
        )?;
        Ok(Self { relaxed, unrelaxed })
    }

    /// E₁ - E₀ \[Pa\].
    pub(super) fn increment(&self) -> f64 {
        self.unrelaxed - self.relaxed
    }

    /// Returns the modulus of a fractional law, with `power` = (sτ)^α.
    pub(super) fn at(&self, power: Complex64) -> Complex64 {
        if power.norm_sqr() <= 1.0 {
            self.relaxed + quotient(self.increment() * power, 1.0 + power)
        } else {
            // avoids the difference of two large products in the imaginary part of the expression
            // above
            self.unrelaxed - quotient(self.increment().into(), 1.0 + power)
        }
    }

    /// Returns dE/d ln s of this law.
    pub(super) fn slope(&self, exponent: f64, power: Complex64) -> Complex64 {
        quotient(
            quotient(self.increment() * exponent * power, 1.0 + power),
            1.0 + power,
        )
    }
}

impl Zener {
    /// Computes ∂E/∂ln s.
    fn slope_at_s(&self, s: Complex64) -> Complex64 {
        self.step.slope(1.0, s * self.relaxation_time)
    }
}

impl ComplexModulus for Zener {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.slope_at_s(Complex64::new(0.0, omega))
    }
}

impl LaplaceModulus for Zener {
    fn at_s(&self, s: Complex64) -> Complex64 {
        let s_tau = s * self.relaxation_time;
        self.step.relaxed + quotient(self.step.increment() * s_tau, 1.0 + s_tau)
    }
}

/// Parameters: `ln_relaxed_modulus`, `ln_modulus_increment` (of E₁ - E₀), `ln_relaxation_time`.
impl DifferentiableModulus for Zener {
    fn parameter_names(&self) -> Vec<String> {
        named(&[
            "ln_relaxed_modulus",
            "ln_modulus_increment",
            "ln_relaxation_time",
        ])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![
            self.step.relaxed.ln(),
            self.step.increment().ln(),
            self.relaxation_time.ln(),
        ]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [relaxed, increment, relaxation_time] = exactly(parameters)?.map(f64::exp);
        Self::new(relaxed, relaxed + increment, relaxation_time)
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let relaxed = Complex64::from(self.step.relaxed);
        let modulus = self.at_s(s);
        write(
            modulus,
            &[relaxed, modulus - relaxed, self.slope_at_s(s)],
            derivatives,
        )
    }
}

/// The retardation time is τE₁/E₀: creep is slower than relaxation.
impl TimeDomainModulus for Zener {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        let decay = (-after_step(time)? / self.relaxation_time).exp();
        Ok(self.step.relaxed + self.step.increment() * decay)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        let retardation_time = self.relaxation_time * self.step.unrelaxed / self.step.relaxed;
        let decay = (-after_step(time)? / retardation_time).exp();
        finite_compliance(
            1.0 / self.step.relaxed - (1.0 / self.step.relaxed - 1.0 / self.step.unrelaxed) * decay,
        )
    }
}
