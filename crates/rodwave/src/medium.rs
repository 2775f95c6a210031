//! Wave properties of a material: density and law, propagation coefficient and characteristic
//! impedance.
//!
//! ```text
//! γ = α + ik = iω (E/ρ)^{-1/2}          (Ödeen 1993, paper E, eq. 4)
//! Z/A = (E ρ)^{1/2} = iωρ/γ             (paper E, eqs. 5-6)
//! E = -ρω²/γ²                           (paper B, eq. 2; in real form: paper A, eq. 2; paper B, eq. 3)
//! ```
//!
//! The root for γ is the one with k > 0 for ω > 0. With E'' >= 0 this root has α >= 0, and e^{iωt -
//! γx} travels and decays along +x. For ω < 0 all quantities are the complex conjugates.
//!
//! A narrow-band pulse travels at the group velocity, which follows from the modulus and its slope:
//!
//! ```text
//! dγ/dω = (γ/ω) (1 - (dE/d ln ω)/(2E)) ,    c_g = 1/Im(dγ/dω)
//! ```
//!
//! Theory: `docs/theory/moduli.md#waves`.

pub(crate) mod power_law_propagation;

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{check_finite, check_laplace_variable, check_positive, check_propagation};
use crate::modulus::{ComplexModulus, LaplaceModulus, fourth_order_difference};
use crate::quotient::quotient;

/// Propagation of harmonic waves in a material of given density.
///
/// Every [`ComplexModulus`] is such a law. A fit to measured waves such as
/// [`PowerLawPropagation`](crate::modulus::PowerLawPropagation) is also such a law, although it is
/// not a modulus.
pub trait PropagationLaw {
    /// Propagation coefficient γ = α + ik [1/m] at `omega` [rad/s] for `density` [kg/m³]; 0 at ω =
    /// 0.
    fn propagation_coefficient(&self, omega: f64, density: f64) -> Complex64;

    /// Complex modulus E \[Pa\] at `omega` [rad/s] for `density` [kg/m³]; the limit at ω = 0.
    fn modulus(&self, omega: f64, density: f64) -> Complex64;

    /// Derivative dγ/dω [s/m] at `omega` ≠ 0 [rad/s] for `density` [kg/m³].
    ///
    /// The default is a fourth-order finite difference over ±0.2 % of ω, with a relative error of
    /// 1e-12 where γ is smooth on the scale of an octave.
    fn propagation_derivative(&self, omega: f64, density: f64) -> Complex64 {
        fourth_order_difference(omega, |omega| self.propagation_coefficient(omega, density)) / omega
    }
}

impl<M: ComplexModulus> PropagationLaw for M {
    fn propagation_coefficient(&self, omega: f64, density: f64) -> Complex64 {
        if omega == 0.0 {
            return Complex64::ZERO; // also for E(0) = 0: γ² is then of order ω
        }
        root(self.at(omega), Complex64::new(0.0, omega), density)
    }

    fn modulus(&self, omega: f64, _density: f64) -> Complex64 {
        self.at(omega)
    }

    fn propagation_derivative(&self, omega: f64, density: f64) -> Complex64 {
        let modulus = self.at(omega);
        let gamma = root(modulus, Complex64::new(0.0, omega), density);
        gamma / omega * (1.0 - 0.5 * self.slope(omega) / modulus)
    }
}

/// Computes γ = s (E/ρ)^{-1/2}, with the root of positive real part.
fn root(modulus: Complex64, s: Complex64, density: f64) -> Complex64 {
    quotient(s, (modulus / density).sqrt())
}

/// A linearly viscoelastic material of given density.
///
/// ```
/// use rodwave::medium::Medium;
/// use rodwave::modulus::Elastic;
///
/// let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
/// assert!((steel.phase_velocity(1e4) - 5146.0).abs() < 1.0);
/// assert!((steel.specific_characteristic_impedance(1e4).re / 4.003e7 - 1.0).abs() < 1e-3);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Medium<L> {
    density: f64,
    law: L,
}

impl<L: PropagationLaw> Medium<L> {
    /// Creates a material of `density` ρ [kg/m³] that obeys `law`.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the density is finite and above 0.
    pub fn new(density: f64, law: L) -> Result<Self, RodwaveError> {
        Ok(Self {
            density: check_positive("density [kg/m^3]", density)?,
            law,
        })
    }

    /// Density ρ [kg/m³].
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Complex modulus E \[Pa\] at `omega` [rad/s].
    #[must_use]
    pub fn modulus(&self, omega: f64) -> Complex64 {
        self.law.modulus(omega, self.density)
    }

    /// Propagation coefficient γ = α + ik [1/m] at `omega` [rad/s] (paper E, eq. 4); 0 at ω = 0.
    #[must_use]
    pub fn propagation_coefficient(&self, omega: f64) -> Complex64 {
        self.law.propagation_coefficient(omega, self.density)
    }

    /// Returns [`Medium::propagation_coefficient`] for an unchecked `omega` [rad/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for a frequency that is not finite,
    /// [`RodwaveError::NoPropagation`] for a γ that is not finite.
    pub fn try_propagation_coefficient(&self, omega: f64) -> Result<Complex64, RodwaveError> {
        let omega = check_finite("angular frequency [rad/s]", omega)?;
        let s = Complex64::new(0.0, omega);
        check_propagation(self.propagation_coefficient(omega), s)
    }

    /// Damping coefficient α = Re γ [1/m], an even function of `omega` [rad/s].
    #[must_use]
    pub fn damping_coefficient(&self, omega: f64) -> f64 {
        self.propagation_coefficient(omega).re
    }

    /// Wave number k = Im γ [rad/m], an odd function of `omega` [rad/s].
    #[must_use]
    pub fn wave_number(&self, omega: f64) -> f64 {
        self.propagation_coefficient(omega).im
    }

    /// Phase velocity ω/k [m/s] at `omega` [rad/s], an even function. At ω = 0, the velocity that
    /// follows from the static modulus E(0), which is 0 for a fluid.
    #[must_use]
    pub fn phase_velocity(&self, omega: f64) -> f64 {
        if omega == 0.0 {
            let speed = (self.modulus(0.0) / self.density).sqrt();
            speed.norm_sqr() / speed.re.max(f64::MIN_POSITIVE) // 1/Re(1/c), and 0 where c = 0
        } else {
            omega / self.wave_number(omega)
        }
    }

    /// Group velocity dω/dk [m/s] at `omega` [rad/s], an even function. At ω = 0, the velocity that
    /// follows from the static modulus E(0), which is 0 for a fluid.
    ///
    /// It is exact for every law with an exact slope; see [`ComplexModulus::slope`] and
    /// [`PropagationLaw::propagation_derivative`].
    ///
    /// # Validity
    /// With losses, a pulse changes its shape, and none of its points needs to travel with c_g; the
    /// concept is valid for αλ ≪ 1. In a relaxing material, k grows more slowly than ω, and c_g
    /// exceeds the phase velocity ω/k. It can even exceed the front speed (E(∞)/ρ)^½: by up to 12 %
    /// in a Zener material with E₁ = 10 E₀.
    ///
    /// ```
    /// use rodwave::medium::Medium;
    /// use rodwave::modulus::ConstantQ;
    ///
    /// // k ∝ ω^{1-g}: the group is faster than the phase by 1/(1-g), g = (1/π) atan tan δ
    /// let medium = Medium::new(912.0, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
    /// let ratio = medium.group_velocity(1e4) / medium.phase_velocity(1e4);
    /// let g = 0.07_f64.atan() / std::f64::consts::PI;
    /// assert!((ratio * (1.0 - g) - 1.0).abs() < 1e-12);
    /// # Ok::<(), rodwave::RodwaveError>(())
    /// ```
    #[must_use]
    pub fn group_velocity(&self, omega: f64) -> f64 {
        if omega == 0.0 {
            self.phase_velocity(0.0)
        } else {
            1.0 / self.law.propagation_derivative(omega, self.density).im
        }
    }

    /// Characteristic impedance per unit area Z/A = (Eρ)^½ [Pa s/m] at `omega` [rad/s] (paper E,
    /// eq. 5).
    ///
    /// Multiplied by the area of the cross-section it is the Z of paper E. At ω = 0 it is the limit
    /// (E(0) ρ)^½.
    #[must_use]
    pub fn specific_characteristic_impedance(&self, omega: f64) -> Complex64 {
        (self.modulus(omega) * self.density).sqrt()
    }
}

impl<M: LaplaceModulus> Medium<M> {
    /// Propagation coefficient γ = s (E(s)/ρ)^{-1/2} [1/m] at the Laplace variable `s` [1/s], Re
    /// s > 0.
    #[must_use]
    pub fn propagation_coefficient_at_s(&self, s: Complex64) -> Complex64 {
        root(self.law.at_s(s), s, self.density)
    }

    /// Returns [`Medium::propagation_coefficient_at_s`] for an unchecked `s` [1/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless s is finite with Re s >= 0;
    /// [`RodwaveError::NoPropagation`] for a γ that is not finite, such as that of a fluid at s
    /// = 0.
    pub fn try_propagation_coefficient_at_s(
        &self,
        s: Complex64,
    ) -> Result<Complex64, RodwaveError> {
        check_laplace_variable(s)?;
        check_propagation(self.propagation_coefficient_at_s(s), s)
    }

    /// Characteristic impedance per unit area (E(s) ρ)^½ [Pa s/m] at the Laplace variable `s`
    /// [1/s], Re s > 0.
    #[must_use]
    pub fn specific_characteristic_impedance_at_s(&self, s: Complex64) -> Complex64 {
        (self.law.at_s(s) * self.density).sqrt()
    }
}

/// Returns the complex modulus E = -ρω²/γ² \[Pa\] from the `propagation_coefficient` γ [1/m] at
/// `omega` [rad/s] in a material of `density` [kg/m³] (paper A, eq. 2; paper B, eq. 3).
///
/// ```text
/// E' = ρω² (k² - α²)/(k² + α²)² ,    E'' = ρω² 2kα/(k² + α²)²
/// ```
///
/// γ and -γ give the same modulus. α < 0, which noise can cause, gives E'' < 0.
///
/// # Errors
/// [`RodwaveError::NonPhysical`] unless all are finite, the density is above 0 and γ is not 0 (at
/// ω = 0 the propagation coefficient does not determine the modulus), or if the modulus overflows.
pub fn modulus_from_propagation(
    propagation_coefficient: Complex64,
    omega: f64,
    density: f64,
) -> Result<Complex64, RodwaveError> {
    check_positive(
        "magnitude of the propagation coefficient [1/m]",
        propagation_coefficient.norm(),
    )?;
    let omega = check_finite("angular frequency [rad/s]", omega)?;
    let density = check_positive("density [kg/m^3]", density)?;
    let velocity = quotient(Complex64::new(0.0, omega), propagation_coefficient);
    let modulus = density * velocity * velocity;
    check_finite("magnitude of the complex modulus [Pa]", modulus.norm())?;
    Ok(modulus)
}

/// Returns the propagation coefficient γ = iω (E/ρ)^{-1/2} [1/m] from the complex `modulus` \[Pa\]
/// at `omega` [rad/s] in a material of `density` [kg/m³] (paper E, eq. 4); 0 at ω = 0.
///
/// The root has k > 0 for ω > 0. Its α is >= 0 exactly if E'' >= 0; a negative loss modulus gives α
/// < 0.
///
/// # Errors
/// [`RodwaveError::NonPhysical`] unless all are finite, the density is above 0 and E is not 0;
/// [`RodwaveError::NoPropagation`] for a γ that overflows.
pub fn propagation_from_modulus(
    modulus: Complex64,
    omega: f64,
    density: f64,
) -> Result<Complex64, RodwaveError> {
    check_positive("magnitude of the complex modulus [Pa]", modulus.norm())?;
    let omega = check_finite("angular frequency [rad/s]", omega)?;
    let density = check_positive("density [kg/m^3]", density)?;
    let s = Complex64::new(0.0, omega);
    check_propagation(root(modulus, s, density), s)
}
