//! The modulus of the Zener model, the standard linear solid.

use num_complex::Complex64;

use super::{ComplexModulus, LaplaceModulus};
use crate::RodwaveError;
use crate::error::check_positive;

/// A spring in parallel with a Maxwell model: the simplest solid with a finite wave speed.
///
/// ```text
/// E(s) = E₀ + (E₁ - E₀) sτ/(1 + sτ)
/// ```
///
/// E₀ is the relaxed modulus, E(0), and E₁ the unrelaxed one, E(∞). The loss factor has its largest value
/// (E₁ - E₀)/(2 (E₀ E₁)^½) at ωτ = (E₀/E₁)^½.
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
    relaxed_modulus: f64,
    unrelaxed_modulus: f64,
    relaxation_time: f64,
}

impl Zener {
    /// A solid of `relaxed_modulus` E₀ \[Pa\], `unrelaxed_modulus` E₁ > E₀ \[Pa\] and `relaxation_time` τ \[s\] at
    /// constant strain.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0 and E₁ exceeds E₀.
    pub fn new(
        relaxed_modulus: f64,
        unrelaxed_modulus: f64,
        relaxation_time: f64,
    ) -> Result<Self, RodwaveError> {
        let relaxed_modulus = check_positive("relaxed modulus [Pa]", relaxed_modulus)?;
        let unrelaxed_modulus = check_positive("unrelaxed modulus [Pa]", unrelaxed_modulus)?;
        if unrelaxed_modulus <= relaxed_modulus {
            return Err(RodwaveError::NonPhysical {
                quantity: "unrelaxed modulus [Pa]",
                value: unrelaxed_modulus,
                expected: "more than the relaxed modulus",
            });
        }
        Ok(Self {
            relaxed_modulus,
            unrelaxed_modulus,
            relaxation_time: check_positive("relaxation time [s]", relaxation_time)?,
        })
    }
}

impl ComplexModulus for Zener {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }
}

impl LaplaceModulus for Zener {
    fn at_s(&self, s: Complex64) -> Complex64 {
        let s_tau = s * self.relaxation_time;
        self.relaxed_modulus
            + (self.unrelaxed_modulus - self.relaxed_modulus) * s_tau / (1.0 + s_tau)
    }
}
