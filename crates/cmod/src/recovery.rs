//! Creep recovery: the loss factor of a polymer after a load, and the nonlinear dashpot that
//! explains this loss factor (paper C).
//!
//! # Model
//! The model is a spring E₁ in series with a pair of elements in parallel: a spring E₂ and a
//! power-law dashpot. With σ_d the stress of the dashpot,
//!
//! ```text
//! dε_d/dt = B sgn(σ_d) |σ_d|^(m+1)                                    (Ödeen 1993, paper C, eq. 1)
//! η = dσ_d/dε̇_d = 1/[B (m+1) |σ_d|^m]                                 (eq. 2)
//! 1/E* = 1/E₁ + 1/(E₂ + iωη)                                          (small perturbation of the loaded state)
//! tan δ = E₁ωη/[E₂(E₁+E₂) + (ωη)²] → E₁/(ωη)                          (eq. 3, for E₂(E₁+E₂) ≪ (ωη)²)
//! ```
//!
//! Under a constant stress, the stress of the dashpot is gradually transferred to the parallel
//! spring. After unloading, the spring drives the dashpot back. The stress of the dashpot decays,
//! and the increase of the loss factor decays with it ([`Recovery`]):
//!
//! ```text
//! Δtan δ = Δtan δᵢ/(1 + t/t_r) ,   Δtan δᵢ = E₁(m+1)/(E₂ ω m t_r)      (eqs. 4, 5)
//! t_r = (t₁/m) [σ_a/E₂ - {m t_a/t₁ + (σ_a/E₂)^(-m)}^(-1/m)]^(-m) ,   t₁ = 1/(B E₂^(m+1))
//! ```
//!
//! These equations apply to a stress σ_a that acts for a time t_a. Any other load history is
//! integrated ([`LoadHistory`]). Only the stress of the dashpot at unloading depends on the
//! history, so eq. 4 is valid after every load.
//!
//! # Errata
//! - **Equation 5** is printed with t₁/(m\[..\]^(-m)), the outer exponent on the wrong side of the
//!   fraction; as printed, the equation gives t_r near 10¹⁴ s for the printed parameters and a
//!   change of 10⁻¹⁰ %. The form above follows from eqs. 1-3.
//! - **Equation 5**, Δtan δᵢ: the product E₂ ω m t_r is printed E₂ ω_m t_r.
//! - **B** is printed in Pa s^-2.8; by eq. 1 its unit is Pa^-(m+1) s^-1.
//! - **The survey** at the beginning of the thesis (section 3.3) puts E₁ parallel to the dashpot
//!   and E₂ in series. With this arrangement |E*| would tend to E₂ = 13.1 kPa.
//!
//! # Identifiability
//! One test gives two numbers, Δtan δᵢ and t_r, for the three parameters E₂, B and m, so two loads
//! are needed. E₁ does not follow from the loss factor at all: multiplying E₁ and E₂ by a factor
//! and dividing B by the same factor does not change the loss factor. E₁ must be the measured
//! modulus of the virgin material. See [`fit`].
//!
//! # Validity
//! The model is qualitative: the value E₂ = 13100 Pa of the paper implies strains of hundreds and
//! more, that is, tens of thousands of per cent, which no rod reached, and the predicted change of
//! |E| is far below the measured change. The paper states both. The model describes only the loss
//! factor at one frequency.
//!
//! Theory: `docs/theory/creep-recovery.md`.

mod dashpot;
pub mod fit;
mod integrator;
mod least_squares;
pub mod load;
pub mod recovered;
pub mod test;

pub use fit::{Estimate, Reason, RecoveryFit, SingleTestFit, Verdict};
pub use load::{LoadHistory, LoadSegment};
pub use recovered::Recovery;
pub use test::{LossFactorReadings, RecoveryTest};

use num_complex::Complex64;

use crate::error::{CmodError, check_not_negative, check_positive};
use dashpot::Dashpot;

/// Parameters of the three-element model of paper C.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThreeElementParameters {
    /// Modulus E₁ of the spring in series \[Pa\], the modulus of the virgin material.
    pub series_modulus: f64,
    /// Modulus E₂ of the spring parallel to the dashpot \[Pa\].
    pub parallel_modulus: f64,
    /// Coefficient B of the dashpot [Pa^-(m+1) s^-1].
    pub coefficient: f64,
    /// Exponent m of the dashpot; 0 for a Newtonian dashpot.
    pub exponent: f64,
}

/// Three-element model: a spring in series with a parallel pair of a spring and a power-law dashpot
/// (paper C, Figure 1).
///
/// ```
/// use cmod::recovery::{LoadHistory, ThreeElement, ThreeElementParameters};
///
/// // polyoximethylene as printed; 45 MPa during half an hour, Test 1
/// let material = ThreeElement::new(ThreeElementParameters {
///     series_modulus: 3100e6,
///     parallel_modulus: 13100.0,
///     coefficient: 4.55e-21,
///     exponent: 1.8,
/// })?;
/// let recovery = material.recovery(&LoadHistory::creep(45e6, 1800.0)?)?;
/// let omega = 2.0 * std::f64::consts::PI * 10e3;
/// // one minute after unloading the loss factor is 73 % above its virgin value of 0.025
/// let change = recovery.loss_factor_change(omega, 60.0);
/// assert!((change / 0.025 - 0.7338).abs() < 1e-4);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThreeElement {
    parameters: ThreeElementParameters,
}

impl ThreeElement {
    /// Creates the model with `parameters`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the moduli and the coefficient are finite and above 0, and
    /// the exponent is finite and not negative.
    pub fn new(parameters: ThreeElementParameters) -> Result<Self, CmodError> {
        check_positive("series modulus [Pa]", parameters.series_modulus)?;
        check_positive("parallel modulus [Pa]", parameters.parallel_modulus)?;
        check_positive("coefficient [Pa^-(m+1) s^-1]", parameters.coefficient)?;
        check_not_negative("exponent", parameters.exponent)?;
        Ok(Self { parameters })
    }

    /// Returns the parameters.
    #[must_use]
    pub fn parameters(&self) -> ThreeElementParameters {
        self.parameters
    }

    /// Returns the strain rate of the dashpot \[1/s\] at `dashpot_stress` \[Pa\] (paper C, eq. 1).
    #[must_use]
    pub fn dashpot_strain_rate(&self, dashpot_stress: f64) -> f64 {
        let ThreeElementParameters {
            coefficient,
            exponent,
            ..
        } = self.parameters;
        coefficient * dashpot_stress.abs().powf(exponent) * dashpot_stress
    }

    /// Returns 1/η = B(m+1)|σ_d|^m [1/(Pa s)] at `dashpot_stress` \[Pa\]: finite at rest, where η
    /// is infinite if m > 0.
    fn differential_fluidity(&self, dashpot_stress: f64) -> f64 {
        let ThreeElementParameters {
            coefficient,
            exponent,
            ..
        } = self.parameters;
        coefficient * (exponent + 1.0) * dashpot_stress.abs().powf(exponent)
    }

    /// Returns the differential viscosity η = dσ_d/dε̇_d \[Pa s\] at `dashpot_stress` \[Pa\] (paper
    /// C, eq. 2); infinite at rest if m > 0.
    #[must_use]
    pub fn differential_viscosity(&self, dashpot_stress: f64) -> f64 {
        1.0 / self.differential_fluidity(dashpot_stress)
    }

    /// Returns the differential modulus E* \[Pa\] for a small perturbation of angular frequency
    /// `omega` \[rad/s\] about `dashpot_stress` \[Pa\], from 1/E* = 1/E₁ + 1/(E₂ + iωη), without
    /// approximation.
    #[must_use]
    pub fn complex_modulus(&self, omega: f64, dashpot_stress: f64) -> Complex64 {
        self.parameters.series_modulus / (1.0 + self.relative_compliance(omega, dashpot_stress))
    }

    /// Returns the loss factor tan δ = E''/E' of the [complex modulus](Self::complex_modulus),
    /// without the loss of the virgin material.
    #[must_use]
    pub fn loss_factor(&self, omega: f64, dashpot_stress: f64) -> f64 {
        let ThreeElementParameters {
            series_modulus: e1,
            parallel_modulus: e2,
            ..
        } = self.parameters;
        let fluidity = self.differential_fluidity(dashpot_stress);
        e1 * (fluidity / omega) / (1.0 + (e2 * fluidity / omega) * ((e1 + e2) * fluidity / omega))
    }

    /// Returns Δtan δ = E₁/(ωη), the loss factor at high frequency (paper C, eq. 3), for `omega` in
    /// \[rad/s\] and `dashpot_stress` in \[Pa\].
    ///
    /// This value exceeds [`loss_factor`](Self::loss_factor) by the fraction E₂(E₁+E₂)/(ωη)².
    #[must_use]
    pub fn loss_factor_change(&self, omega: f64, dashpot_stress: f64) -> f64 {
        self.parameters.series_modulus * self.differential_fluidity(dashpot_stress) / omega
    }

    /// Returns the change |E*|/E₁ - 1 of the absolute value of the modulus, which is also accurate
    /// if the change is small.
    #[must_use]
    pub fn modulus_change(&self, omega: f64, dashpot_stress: f64) -> f64 {
        let z = self.relative_compliance(omega, dashpot_stress);
        // |1 + z|² - 1
        let excess = 2.0 * z.re + z.norm_sqr();
        (-0.5 * excess.ln_1p()).exp_m1()
    }

    /// Returns the recovery after `load`, which begins at rest and ends with unloading (eqs. 4, 5).
    ///
    /// # Errors
    /// [`CmodError::LoadNotIntegrated`] if a load that is not piecewise constant takes too many
    /// steps; [`CmodError::NonPhysical`] if a stress or a rate overflows.
    pub fn recovery(&self, load: &LoadHistory) -> Result<Recovery, CmodError> {
        Recovery::after(*self, load)
    }

    /// Returns E₁/(E₂ + iωη).
    fn relative_compliance(&self, omega: f64, dashpot_stress: f64) -> Complex64 {
        let fluidity = self.differential_fluidity(dashpot_stress);
        self.parameters.series_modulus * fluidity
            / Complex64::new(self.parameters.parallel_modulus * fluidity, omega)
    }

    /// Returns the parallel pair of spring and dashpot, with the rate at `reference_stress`.
    fn dashpot(&self, reference_stress: f64) -> Dashpot {
        let ThreeElementParameters {
            parallel_modulus,
            coefficient,
            exponent,
            ..
        } = self.parameters;
        Dashpot {
            rate: parallel_modulus * coefficient * reference_stress.powf(exponent),
            exponent,
            reference_stress,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const PRINTED: ThreeElementParameters = ThreeElementParameters {
        series_modulus: 3100e6,
        parallel_modulus: 13100.0,
        coefficient: 4.55e-21,
        exponent: 1.8,
    };

    /// Compares the viscosity with the slope of eq. 1 (Ödeen 1993, paper C, eq. 2).
    #[test]
    fn viscosity_is_the_slope_of_the_power_law() {
        let model = ThreeElement::new(PRINTED).unwrap();
        for stress in [-45e6, -1e5, 3e3, 32e6] {
            // central difference of eq. 1: error (h/σ)² m(m+1)/6 = 1e-8 · 0.84
            let h = 1e-4 * f64::abs(stress);
            let slope = (model.dashpot_strain_rate(stress + h)
                - model.dashpot_strain_rate(stress - h))
                / (2.0 * h);
            let product = slope * model.differential_viscosity(stress);
            assert!((product - 1.0).abs() < 1e-8, "{stress}: {product}");
        }
        assert_eq!(
            model.differential_viscosity(0.0).to_bits(),
            f64::INFINITY.to_bits()
        );
    }

    #[test]
    fn modulus_is_that_of_springs_and_dashpot() {
        // E₁ = 2, E₂ = 1, η = 1 at ω = 1 (m = 0): 1/E* = 1/2 + 1/(1+i) = (2 - i)/2, E* = (4 + 2i)/5
        let model = ThreeElement::new(ThreeElementParameters {
            series_modulus: 2.0,
            parallel_modulus: 1.0,
            coefficient: 1.0,
            exponent: 0.0,
        })
        .unwrap();
        let modulus = model.complex_modulus(1.0, 7.0);
        assert!(
            (modulus - Complex64::new(0.8, 0.4)).norm() < 1e-15,
            "{modulus}"
        );
        assert!((model.loss_factor(1.0, 7.0) - 0.5).abs() < 1e-15);
        assert!((model.loss_factor_change(1.0, 7.0) - 2.0).abs() < 1e-15);
        // |E*| = √0.8
        let change = model.modulus_change(1.0, 7.0);
        assert!(
            (change - (0.8_f64.sqrt() / 2.0 - 1.0)).abs() < 1e-15,
            "{change}"
        );
    }

    /// Compares the form for high frequency with the exact loss factor (Ödeen 1993, paper C, eq.
    /// 3).
    #[test]
    fn high_frequency_form_errs_as_stated() {
        let model = ThreeElement::new(PRINTED).unwrap();
        let (omega, stress) = (2.0, 45e6); // slow enough for the difference to show
        let eta = model.differential_viscosity(stress);
        let share = PRINTED.parallel_modulus * (PRINTED.series_modulus + PRINTED.parallel_modulus)
            / (omega * eta).powi(2);
        let excess =
            model.loss_factor_change(omega, stress) / model.loss_factor(omega, stress) - 1.0;
        assert!(
            share > 1e-3 && (excess / share - 1.0).abs() < 1e-10,
            "{excess} {share}"
        );
    }

    #[test]
    fn at_rest_there_is_only_the_series_spring() {
        let model = ThreeElement::new(PRINTED).unwrap();
        let modulus = model.complex_modulus(1e4, 0.0);
        assert!((modulus - Complex64::from(3100e6)).norm() < 1e-6);
        assert!(model.modulus_change(1e4, 0.0).abs() < 1e-300);
    }

    #[test]
    fn impossible_parameters_are_refused() {
        let text = |change: fn(&mut ThreeElementParameters)| {
            let mut parameters = PRINTED;
            change(&mut parameters);
            ThreeElement::new(parameters).unwrap_err().to_string()
        };
        assert_eq!(
            text(|parameters| parameters.series_modulus = f64::NAN),
            "series modulus [Pa] is NaN, expected a finite value above 0"
        );
        assert_eq!(
            text(|parameters| parameters.parallel_modulus = -1.0),
            "parallel modulus [Pa] is -1, expected a finite value above 0"
        );
        assert_eq!(
            text(|parameters| parameters.coefficient = 0.0),
            "coefficient [Pa^-(m+1) s^-1] is 0, expected a finite value above 0"
        );
        assert_eq!(
            text(|parameters| parameters.exponent = -0.5),
            "exponent is -0.5, expected a finite value, 0 or above"
        );
    }
}
