//! Remaining errors of a modulus after correction by the theories of lateral inertia.

use crate::RodwaveError;
use crate::error::check_positive;

use super::theory::check_poisson_ratio;

/// Theory of longitudinal waves in rods, in order of complexity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Theory {
    /// One-dimensional, without lateral inertia: [`crate::medium`].
    Elementary,
    /// [`super::LoveRayleigh`].
    LoveRayleigh,
    /// [`super::PochhammerChree`].
    PochhammerChree,
}

impl Theory {
    /// Returns the relative error (E'_found - E')/E' of a modulus found by the theory from a
    /// measured wave number, at `wavelength_in_diameters` λ/D in a round rod of `poisson_ratio`
    /// ν.
    ///
    /// | theory | λ = 10 D, ν = 0.4 | 5 D | 3 D |
    /// |---|---|---|---|
    /// | elementary | -0.8 % | -3.2 % | -9.4 % |
    /// | Love | -0.01 % | -0.17 % | -1.3 % |
    /// | Pochhammer-Chree | 0 | 0 | 0 |
    ///
    /// The error follows from the dispersion relation of Pochhammer and Chree for long waves,
    ///
    /// ```text
    /// B/K = 1 - ½ν²K - ν²(7 - 4ν - 32ν² + 4ν³ + 24ν⁴)/(48(1-ν²)) K² + O(K³) ,    K = (πD/λ)²
    /// ```
    ///
    /// of which Love's theory contains the part 1/(1 + ½ν²K). The error grows smoothly with the
    /// frequency: a modulus corrected by one theory over a whole band is a smooth function, whereas
    /// a modulus corrected by two theories has a step at the change from one to the other, which no
    /// causal material has.
    ///
    /// ```
    /// use rodwave::slenderness::Theory;
    ///
    /// let at_the_limit_of_paper_a = Theory::Elementary.error_left(5.0, 0.40)?;
    /// assert!((at_the_limit_of_paper_a + 0.0323).abs() < 1e-4);
    /// # Ok::<(), rodwave::RodwaveError>(())
    /// ```
    ///
    /// # Validity
    /// Low losses and an exact ν are assumed. At λ = 3D, the error of Love's theory is
    /// overestimated by up to a quarter; below 3D, only its order of magnitude is correct.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless λ/D and (D/λ)⁴ are finite and above 0, and -1 < ν <=
    /// 0.5.
    pub fn error_left(
        self,
        wavelength_in_diameters: f64,
        poisson_ratio: f64,
    ) -> Result<f64, RodwaveError> {
        let wave = scaled_wave_number(wavelength_in_diameters)?;
        let nu = check_poisson_ratio(poisson_ratio)?;
        let polynomial = 7.0 + nu * (-4.0 + nu * (-20.0 + nu * (4.0 + 12.0 * nu)));
        let by_love = -nu * nu * polynomial / (48.0 * (1.0 - nu * nu)) * wave * wave;
        let inertia = 0.5 * nu * nu * wave;
        Ok(match self {
            Self::Elementary => by_love - inertia / (1.0 + inertia),
            Self::LoveRayleigh => by_love,
            Self::PochhammerChree => 0.0,
        })
    }
}

/// Relative errors of a modulus found by elementary theory from a measured wave number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ApparentModulusError {
    /// Error of E'.
    pub storage_modulus: f64,
    /// Error of E''/E'.
    pub loss_factor: f64,
}

/// Returns the errors of elementary theory at `wavelength_in_diameters` λ/D, by Love's theory.
///
/// ```text
/// δE'/E' = -e/(1+e)        δE'' = 0        δ(tan δ)/tan δ = e        e = (π²ν²/2)(D/λ)²
/// ```
///
/// With ν = 1/2 and λ = 5D, the magnitudes are 4.7 and 4.9 per cent: "less than 5 per cent" for
/// both in condition (i) (Ödeen 1993, paper A, section 4, after Pritz) applies to an incompressible
/// rod.
///
/// # Validity
/// λ > 3D and low losses; [`Theory::error_left`] has one term more.
///
/// # Errors
/// [`RodwaveError::NonPhysical`] unless λ/D and (D/λ)⁴ are finite and above 0, and -1 < ν <= 0.5.
pub fn elementary_theory_error(
    wavelength_in_diameters: f64,
    poisson_ratio: f64,
) -> Result<ApparentModulusError, RodwaveError> {
    let wave = scaled_wave_number(wavelength_in_diameters)?;
    let inertia = 0.5 * check_poisson_ratio(poisson_ratio)?.powi(2) * wave;
    Ok(ApparentModulusError {
        storage_modulus: -inertia / (1.0 + inertia),
        loss_factor: inertia,
    })
}

/// Computes K = (πD/λ)².
fn scaled_wave_number(wavelength_in_diameters: f64) -> Result<f64, RodwaveError> {
    let ratio = check_positive("wavelength over diameter", wavelength_in_diameters)?;
    let wave = (std::f64::consts::PI / ratio).powi(2);
    check_positive("(D/lambda)^4", wave * wave)?;
    Ok(wave)
}
