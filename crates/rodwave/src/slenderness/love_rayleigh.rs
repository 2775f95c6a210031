//! Theory of Love, after Rayleigh: inertia of a quasi-static lateral motion.

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::check_positive;

use super::theory::{
    CorrectedModulus, FirstBranch, RodTheory, Root, RoundRod, Scale, check_poisson_ratio,
};

/// Theory of Love and Rayleigh.
///
/// ```text
/// k² = ρω²/(E - ρν²k_p²ω²)            E = ρω²/k² + ρν²k_p²ω²            (k complex: k² = -γ²)
/// ```
///
/// with the polar radius of gyration k_p of the cross-section: k_p² = D²/8 for a circle, (b² +
/// h²)/12 for a rectangle. Only E' is corrected: the apparent E'' is correct.
///
/// # Validity
/// The correction is exact to leading order in (D/λ)². The remaining error of E' is about 0.2 % at
/// λ = 5D and 1 % at λ = 3D ([`Theory::error_left`](super::Theory::error_left)). In this theory,
/// waves do not propagate where ρν²k_p²ω² exceeds E.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoveRayleigh {
    scale: Scale,
    poisson_ratio: f64,
}

/// Rod of rectangular cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectangularRod {
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Width b \[m\].
    pub width: f64,
    /// Height h \[m\].
    pub height: f64,
    /// Poisson's ratio ν, above -1 and at most 0.5.
    pub poisson_ratio: f64,
}

impl LoveRayleigh {
    /// Creates a round rod.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless density and diameter are above 0 and -1 < ν <= 0.5.
    pub fn round(rod: RoundRod) -> Result<Self, RodwaveError> {
        let rod = rod.checked()?;
        Self::with_radius_of_gyration(rod.density, rod.diameter / 8f64.sqrt(), rod.poisson_ratio)
    }

    /// Creates a rectangular rod.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless density, width and height are above 0 and -1 < ν <=
    /// 0.5.
    pub fn rectangular(rod: RectangularRod) -> Result<Self, RodwaveError> {
        let width = check_positive("width [m]", rod.width)?;
        let height = check_positive("height [m]", rod.height)?;
        Self::with_radius_of_gyration(
            rod.density,
            width.hypot(height) / 12f64.sqrt(),
            rod.poisson_ratio,
        )
    }

    /// Creates a rod of any cross-section from its density, `polar_radius_of_gyration` and
    /// Poisson's ratio.
    fn with_radius_of_gyration(
        density: f64,
        polar_radius_of_gyration: f64,
        poisson_ratio: f64,
    ) -> Result<Self, RodwaveError> {
        let length = check_positive("polar radius of gyration [m]", polar_radius_of_gyration)?;
        Ok(Self {
            scale: Scale {
                density: check_positive("density [kg/m^3]", density)?,
                length,
            },
            poisson_ratio: check_poisson_ratio(poisson_ratio)?,
        })
    }

    /// Polar radius of gyration k_p of the cross-section \[m\].
    #[must_use]
    pub fn polar_radius_of_gyration(&self) -> f64 {
        self.scale.length
    }
}

impl RodTheory for LoveRayleigh {
    fn propagation_coefficient(
        &self,
        modulus: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<Complex64>, RodwaveError> {
        self.scale.propagation_coefficient(modulus, omega, |bar| {
            let inertia = self.poisson_ratio.powi(2) * bar;
            if inertia.re < 1.0 {
                FirstBranch::Found(bar / (1.0 - inertia))
            } else {
                FirstBranch::BeyondCutOff {
                    lateral_inertia: inertia.re,
                }
            }
        })
    }

    fn modulus(
        &self,
        propagation_coefficient: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<CorrectedModulus>, RodwaveError> {
        let nu = self.poisson_ratio;
        self.scale.modulus(propagation_coefficient, omega, |wave| {
            let bar = wave / (1.0 + nu * nu * wave);
            FirstBranch::Found(Root {
                value: bar,
                by_poisson_ratio: -2.0 * nu * bar * bar,
            })
        })
    }
}
