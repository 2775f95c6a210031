//! Interface of a theory of lateral inertia: both directions, and results that state whether they
//! are on the first branch.

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{check_all_finite, check_finite, check_positive, check_that};
use crate::quotient::quotient;

/// Theory of longitudinal waves in a rod with lateral inertia.
pub trait RodTheory {
    /// Returns the propagation coefficient γ = α + ik [1/m] of the first branch from the complex
    /// `modulus` E \[Pa\] at `omega` [rad/s].
    ///
    /// As without lateral inertia, k > 0 for ω > 0, γ(-ω) = conj γ(ω) for E(-ω) = conj E(ω), and
    /// γ = 0 at ω = 0.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless ω is finite, E finite and not 0, and ρω²a²/E finite.
    fn propagation_coefficient(
        &self,
        modulus: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<Complex64>, RodwaveError>;

    /// Returns the complex modulus, corrected for lateral inertia, from the
    /// `propagation_coefficient` γ [1/m] measured at `omega` [rad/s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless ω and γ are finite and not 0, and γ²a² neither
    /// overflows nor underflows.
    fn modulus(
        &self,
        propagation_coefficient: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<CorrectedModulus>, RodwaveError>;
}

/// Properties of a round rod that determine its waves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundRod {
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Diameter D \[m\].
    pub diameter: f64,
    /// Poisson's ratio ν, above -1 and at most 0.5.
    pub poisson_ratio: f64,
}

impl RoundRod {
    /// Checks that all numbers are physical.
    pub(super) fn checked(self) -> Result<Self, RodwaveError> {
        Ok(Self {
            density: check_positive("density [kg/m^3]", self.density)?,
            diameter: check_positive("diameter [m]", self.diameter)?,
            poisson_ratio: check_poisson_ratio(self.poisson_ratio)?,
        })
    }

    /// Scale that makes modulus and propagation coefficient dimensionless.
    pub(super) fn scale(&self) -> Scale {
        Scale {
            density: self.density,
            length: 0.5 * self.diameter,
        }
    }
}

/// Checks that -1 < ν <= 0.5, the range of stable isotropic solids including the incompressible
/// one.
pub(super) fn check_poisson_ratio(poisson_ratio: f64) -> Result<f64, RodwaveError> {
    check_that(
        poisson_ratio > -1.0 && poisson_ratio <= 0.5,
        "Poisson's ratio",
        poisson_ratio,
        "a value above -1 and at most 0.5",
    )
}

/// Result on the first branch of the dispersion relation, or the reason why there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use]
pub enum FirstBranch<T> {
    /// A result on the first branch.
    Found(T),
    /// No wave propagates at this frequency in this theory: the first branch ends where
    /// `lateral_inertia` is 1.
    BeyondCutOff {
        /// Re ρω²ν²k_p²/E, the inertia of the lateral motion relative to the stiffness.
        lateral_inertia: f64,
    },
    /// The branch was followed from low frequency and lost: another branch is too close to be
    /// distinguished, or the frequency is too high.
    Left {
        /// Fraction of the path, in ω or in γ for the inverse direction, up to which the branch was
        /// followed. It is 1 if a modulus was found from γ but does not give γ again on the first
        /// branch.
        reached: f64,
    },
}

impl<T> FirstBranch<T> {
    /// The result, if it was found.
    #[must_use]
    pub fn found(self) -> Option<T> {
        match self {
            Self::Found(value) => Some(value),
            Self::BeyondCutOff { .. } | Self::Left { .. } => None,
        }
    }

    /// Converts the result, if it was found.
    pub(super) fn map<U>(self, convert: impl FnOnce(T) -> U) -> FirstBranch<U> {
        match self {
            Self::Found(value) => FirstBranch::Found(convert(value)),
            Self::BeyondCutOff { lateral_inertia } => FirstBranch::BeyondCutOff { lateral_inertia },
            Self::Left { reached } => FirstBranch::Left { reached },
        }
    }
}

/// Complex modulus from a propagation coefficient, corrected for lateral inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CorrectedModulus {
    /// E = E' + iE'' \[Pa\].
    pub modulus: Complex64,
    /// Modulus by elementary theory from the same propagation coefficient, -ρω²/γ² \[Pa\] (Ödeen
    /// 1993, paper A, eq. 2).
    pub apparent_modulus: Complex64,
    /// ∂E/∂ν at constant propagation coefficient \[Pa\].
    pub by_poisson_ratio: Complex64,
}

/// Standard errors of a modulus due to the error of Poisson's ratio. They are fully correlated.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ModulusError {
    /// Error of E' \[Pa\].
    pub storage_modulus: f64,
    /// Error of E'' \[Pa\].
    pub loss_modulus: f64,
    /// Error of E''/E'.
    pub loss_factor: f64,
}

impl CorrectedModulus {
    /// Loss factor E''/E'.
    #[must_use]
    pub fn loss_factor(&self) -> f64 {
        self.modulus.im / self.modulus.re
    }

    /// Returns the standard errors due to the `poisson_ratio_error` δν, to first order: |Re ∂E/∂ν|
    /// δν for E', and the corresponding products for E'' and E''/E'.
    ///
    /// To leading order the correction is proportional to ν², and its relative error is 2 δν/ν.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless δν is finite and not negative.
    pub fn standard_error(&self, poisson_ratio_error: f64) -> Result<ModulusError, RodwaveError> {
        check_that(
            poisson_ratio_error.is_finite() && poisson_ratio_error >= 0.0,
            "standard error of Poisson's ratio",
            poisson_ratio_error,
            "a finite value, at least 0",
        )?;
        let slope = self.by_poisson_ratio;
        let loss_factor_slope = (slope.im - slope.re * self.loss_factor()) / self.modulus.re;
        let error = ModulusError {
            storage_modulus: poisson_ratio_error * slope.re.abs(),
            loss_modulus: poisson_ratio_error * slope.im.abs(),
            loss_factor: poisson_ratio_error * loss_factor_slope.abs(),
        };
        check_all_finite(
            "standard error due to that of Poisson's ratio",
            [error.storage_modulus, error.loss_modulus, error.loss_factor],
        )?;
        Ok(error)
    }
}

/// Root of f(B, K, ν) = 0 in the unknown variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Root {
    /// B or K.
    pub(super) value: Complex64,
    /// Derivative with respect to ν, with the other variable constant.
    pub(super) by_poisson_ratio: Complex64,
}

/// Density and length that make modulus and propagation coefficient dimensionless: B = ρω²l²/E, K =
/// -γ²l².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// ρ [kg/m³].
    pub(super) density: f64,
    /// l \[m\].
    pub(super) length: f64,
}

impl Scale {
    /// Computes γ from E; `solve` gives K from B.
    pub(super) fn propagation_coefficient(
        &self,
        modulus: Complex64,
        omega: f64,
        solve: impl FnOnce(Complex64) -> FirstBranch<Complex64>,
    ) -> Result<FirstBranch<Complex64>, RodwaveError> {
        check_positive("magnitude of the complex modulus [Pa]", modulus.norm())?;
        let omega = check_finite("angular frequency [rad/s]", omega)?;
        let velocity = (modulus / self.density).sqrt();
        let bar_number = (omega * self.length / velocity).powu(2);
        check_finite("magnitude of rho omega^2 l^2/E", bar_number.norm())?;
        if omega != 0.0 {
            check_positive("magnitude of rho omega^2 l^2/E", bar_number.norm())?;
        }
        let phase_sign = Complex64::new(0.0, omega.signum());
        let branch = solve(bar_number).map(|k| phase_sign * k.sqrt() / self.length);
        if let FirstBranch::Found(gamma) = branch {
            check_finite(
                "magnitude of the propagation coefficient [1/m]",
                gamma.norm(),
            )?;
        }
        Ok(branch)
    }

    /// Computes E from γ; `solve` gives B from K.
    pub(super) fn modulus(
        &self,
        propagation_coefficient: Complex64,
        omega: f64,
        solve: impl FnOnce(Complex64) -> FirstBranch<Root>,
    ) -> Result<FirstBranch<CorrectedModulus>, RodwaveError> {
        check_finite("angular frequency [rad/s]", omega)?;
        check_positive("magnitude of the angular frequency [rad/s]", omega.abs())?;
        check_positive(
            "magnitude of the propagation coefficient [1/m]",
            propagation_coefficient.norm(),
        )?;
        let wave_number = -(propagation_coefficient * self.length).powu(2);
        check_positive("magnitude of gamma^2 l^2", wave_number.norm())?;
        let velocity = quotient(Complex64::new(0.0, omega), propagation_coefficient);
        let apparent_modulus = self.density * velocity * velocity;
        let branch = solve(wave_number).map(|root| {
            let modulus = apparent_modulus * (wave_number / root.value);
            CorrectedModulus {
                modulus,
                apparent_modulus,
                by_poisson_ratio: -modulus * (root.by_poisson_ratio / root.value),
            }
        });
        if let FirstBranch::Found(found) = branch {
            let numbers = [
                found.modulus,
                found.apparent_modulus,
                found.by_poisson_ratio,
            ];
            check_all_finite(
                "magnitude of the modulus or of its derivative [Pa]",
                numbers.map(Complex64::norm),
            )?;
        }
        Ok(branch)
    }
}
