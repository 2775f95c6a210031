//! Which theory for which wavelength, and what error it leaves.

use crate::RodwaveError;
use crate::error::check_positive;

use super::theory::check_poisson_ratio;

/// λ/D above which elementary theory is recommended.
const ELEMENTARY_FROM: f64 = 10.0;

/// λ/D above which Love's theory is recommended.
const LOVE_FROM: f64 = 3.0;

/// A theory of longitudinal waves in rods, the simplest first.
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

/// The theory to use, and the relative errors of E' from a measured wave number by it and by simpler ones.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Recommendation {
    /// The simplest theory that serves.
    pub theory: Theory,
    /// Error of E' by elementary theory, (E'_apparent - E')/E'.
    pub elementary_error: f64,
    /// Error that Love's theory leaves in E', to leading order.
    pub love_error: f64,
}

impl Recommendation {
    /// Error of E' that the recommended theory leaves; 0 for the exact one.
    #[must_use]
    pub fn error(&self) -> f64 {
        match self.theory {
            Theory::Elementary => self.elementary_error,
            Theory::LoveRayleigh => self.love_error,
            Theory::PochhammerChree => 0.0,
        }
    }
}

/// The theory for a wave of `wavelength_in_diameters` λ/D in a round rod of Poisson's ratio ν.
///
/// | λ/D | theory | error left in E' |
/// |---|---|---|
/// | above 10 | elementary | up to 1.2 %, below 0.8 % for ν <= 0.4 |
/// | 3 to 10 | Love | below 0.2 % from 5 on, about 1 % at 3 |
/// | below 3 | Pochhammer-Chree | none |
///
/// The errors returned are those of the dispersion relation of Pochhammer and Chree for long waves,
///
/// ```text
/// B/K = 1 - ½ν²K - ν²(7 - 4ν - 32ν² + 4ν³ + 24ν⁴)/(48(1-ν²)) K² + O(K³) ,    K = (πD/λ)²
/// ```
///
/// of which Love's theory has 1/(1 + ½ν²K). They are for low losses, the errors of ν itself not included. At λ = 3D that of
/// Love's theory is up to a quarter too large; below 3D neither is more than an order of magnitude.
///
/// ```
/// use rodwave::slenderness::{Theory, recommend};
///
/// let at_the_limit_of_paper_a = recommend(5.0, 0.40)?;
/// assert_eq!(at_the_limit_of_paper_a.theory, Theory::LoveRayleigh);
/// assert!((at_the_limit_of_paper_a.elementary_error + 0.0323).abs() < 1e-4);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
///
/// # Errors
/// [`RodwaveError::NonPhysical`] unless λ/D is finite and above 0, (D/λ)⁴ too, and -1 < ν <= 0.5.
pub fn recommend(
    wavelength_in_diameters: f64,
    poisson_ratio: f64,
) -> Result<Recommendation, RodwaveError> {
    let wave = scaled_wave_number(wavelength_in_diameters)?;
    let nu = check_poisson_ratio(poisson_ratio)?;
    let polynomial = 7.0 + nu * (-4.0 + nu * (-20.0 + nu * (4.0 + 12.0 * nu)));
    let love_error = -nu * nu * polynomial / (48.0 * (1.0 - nu * nu)) * wave * wave;
    let inertia = 0.5 * nu * nu * wave;
    Ok(Recommendation {
        theory: if wavelength_in_diameters > ELEMENTARY_FROM {
            Theory::Elementary
        } else if wavelength_in_diameters > LOVE_FROM {
            Theory::LoveRayleigh
        } else {
            Theory::PochhammerChree
        },
        elementary_error: love_error - inertia / (1.0 + inertia),
        love_error,
    })
}

/// Relative errors of a modulus that elementary theory finds from a measured wave number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ApparentModulusError {
    /// Of E'.
    pub storage_modulus: f64,
    /// Of E''/E'.
    pub loss_factor: f64,
}

/// Errors of elementary theory at `wavelength_in_diameters` λ/D, by Love's theory.
///
/// ```text
/// δE'/E' = -e/(1+e)        δE'' = 0        δ(tan δ)/tan δ = e        e = (π²ν²/2)(D/λ)²
/// ```
///
/// With ν = 1/2 and λ = 5D they are 4.7 and 4.9 per cent: the "less than 5 per cent" of condition (i) for both (Ödeen 1993,
/// paper A, section 4, after Pritz) is that of an incompressible rod.
///
/// # Validity
/// λ > 3D, low losses; [`recommend`] has one term more.
///
/// # Errors
/// [`RodwaveError::NonPhysical`] unless λ/D is finite and above 0, (D/λ)⁴ too, and -1 < ν <= 0.5.
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

/// K = (πD/λ)².
fn scaled_wave_number(wavelength_in_diameters: f64) -> Result<f64, RodwaveError> {
    let ratio = check_positive("wavelength over diameter", wavelength_in_diameters)?;
    let wave = (std::f64::consts::PI / ratio).powi(2);
    check_positive("(D/lambda)^4", wave * wave)?;
    Ok(wave)
}
