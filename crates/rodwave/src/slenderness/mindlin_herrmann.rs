//! Theory of Mindlin and Herrmann: a section has independent axial and radial motions.

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::check_positive;

use super::rayleigh_wave::RayleighWave;
use super::theory::{CorrectedModulus, FirstBranch, RodTheory, Root, RoundRod, Scale};

/// Theory of Mindlin and Herrmann for a round rod.
///
/// With a radial displacement proportional to the radius, the energies of the axial and the radial
/// motion, and a shear coefficient κ² on the shear stiffness between the two motions, the theory
/// gives
///
/// ```text
/// [(λ+2μ)k² - ρω²] [4(λ+μ) + (a²/2)(κ²μk² - ρω²)] = 4λ²k²
/// ```
///
/// In the variables of [this module](super), B = ρω²a²/E and K = k²a², it is free of the
/// singularity of λ at ν = 1/2:
///
/// ```text
/// K - B + ¼ [(1-ν)K - (1+ν)(1-2ν)B] [κ²K/(2+2ν) - B] = 0
/// ```
///
/// # Validity
/// By default κ is c_R/c_S, which gives short waves the speed of Rayleigh's surface wave. **For
/// long waves this is less accurate than Love's theory:** the shear energy of a motion that a long
/// wave does not have reduces the lateral inertia by about 30 per cent, K - B = ½ν²K² (1 - κ²μ/E).
/// The theory is included for comparison; use [`super::PochhammerChree`].
///
/// The branch is selected by the sign of a square root, which is correct for loss factors up to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MindlinHerrmann {
    scale: Scale,
    poisson_ratio: f64,
    shear_coefficient: f64,
    /// ∂κ²/∂ν
    shear_coefficient_by_poisson_ratio: f64,
}

impl MindlinHerrmann {
    /// Creates a round rod with κ² = (c_R/c_S)².
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless density and diameter are above 0 and -1 < ν <= 0.5.
    pub fn new(rod: RoundRod) -> Result<Self, RodwaveError> {
        let rod = rod.checked()?;
        let rayleigh = RayleighWave::of(rod.poisson_ratio);
        Ok(Self {
            scale: rod.scale(),
            poisson_ratio: rod.poisson_ratio,
            shear_coefficient: rayleigh.squared_ratio,
            shear_coefficient_by_poisson_ratio: rayleigh.by_poisson_ratio,
        })
    }

    /// Sets the shear coefficient κ², independent of ν.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless κ² is finite and above 0.
    pub fn with_shear_coefficient(self, shear_coefficient: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            shear_coefficient: check_positive("shear coefficient", shear_coefficient)?,
            shear_coefficient_by_poisson_ratio: 0.0,
            ..self
        })
    }

    /// Shear coefficient κ².
    #[must_use]
    pub fn shear_coefficient(&self) -> f64 {
        self.shear_coefficient
    }

    /// Ratio s = κ²/(2+2ν): for short waves, the first branch is K = B/s.
    fn shear_ratio(&self) -> f64 {
        self.shear_coefficient / (2.0 + 2.0 * self.poisson_ratio)
    }

    /// Coefficients of the two bracketed factors: p = 1-ν of K, q = (1+ν)(1-2ν) of B.
    fn stiffness_ratios(&self) -> (f64, f64) {
        let nu = self.poisson_ratio;
        (1.0 - nu, (1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Computes ∂B/∂ν at constant K, from the derivatives of the frequency equation.
    fn bar_by_poisson_ratio(&self, bar: Complex64, wave: Complex64) -> Complex64 {
        let (p, q) = self.stiffness_ratios();
        let s = self.shear_ratio();
        let first = p * wave - q * bar;
        let second = s * wave - bar;
        let q_by_nu = -1.0 - 4.0 * self.poisson_ratio;
        let s_by_nu =
            (0.5 * self.shear_coefficient_by_poisson_ratio - s) / (1.0 + self.poisson_ratio);
        let by_nu = 0.25 * ((-wave - q_by_nu * bar) * second + first * (s_by_nu * wave));
        let by_bar = -1.0 - 0.25 * (q * second + first);
        -by_nu / by_bar
    }
}

impl RodTheory for MindlinHerrmann {
    fn propagation_coefficient(
        &self,
        modulus: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<Complex64>, RodwaveError> {
        let (p, q) = self.stiffness_ratios();
        let s = self.shear_ratio();
        self.scale.propagation_coefficient(modulus, omega, |bar| {
            // ¼ps K² + linear K + constant = 0; the root that equals B for small B
            let quadratic = 0.25 * p * s;
            let linear = 1.0 - 0.25 * (p + q * s) * bar;
            let constant = 0.25 * q * bar * bar - bar;
            let root = (linear * linear - 4.0 * quadratic * constant).sqrt();
            let with = linear + root;
            FirstBranch::Found(if linear.re >= 0.0 {
                -2.0 * constant / with // no cancellation for small B
            } else {
                (root - linear) / (2.0 * quadratic)
            })
        })
    }

    fn modulus(
        &self,
        propagation_coefficient: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<CorrectedModulus>, RodwaveError> {
        let (p, q) = self.stiffness_ratios();
        let s = self.shear_ratio();
        self.scale.modulus(propagation_coefficient, omega, |wave| {
            // ¼q B² - linear B + constant = 0; the root that equals K for small K; q may be 0
            let linear = 1.0 + 0.25 * (p + q * s) * wave;
            let constant = wave + 0.25 * p * s * wave * wave;
            let bar = 2.0 * constant / (linear + (linear * linear - q * constant).sqrt());
            FirstBranch::Found(Root {
                value: bar,
                by_poisson_ratio: self.bar_by_poisson_ratio(bar, wave),
            })
        })
    }
}
