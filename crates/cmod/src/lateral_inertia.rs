//! Lateral inertia taken out of an estimate, with Poisson's ratio and its uncertainty.
//!
//! All methods of this crate find γ and make E = -ρω²/γ² of it, which leaves out that the rod also moves sideways: an
//! *apparent* modulus, too small for short waves. [`LateralInertia`] makes the modulus of the same γ by the simplest
//! theory that serves at its wavelength λ ([`rodwave::slenderness`]):
//!
//! | λ/D | theory | modulus |
//! |---|---|---|
//! | above 10 | none | that of the estimate |
//! | 3 to 10 | Love and Rayleigh | E + ρν²k_p²ω², k_p² = D²/8 |
//! | below 3 | Pochhammer and Chree | the exact frequency equation, solved for E |
//!
//! # Errors
//! The random error goes through the theory, δE = (dE/dγ) δγ. Poisson's ratio is one number for all lines: its error is a
//! systematic one, δE = (∂E/∂ν) δν at constant γ, added to those of the specimen with
//! [`ErrorSource::PoissonRatio`] and kept apart from them. It is 2δν/ν of the correction, to leading order. The errors that the
//! specimen has in the estimate go through the theory as the random ones do.
//!
//! What the theory itself leaves is [`LineCorrection::remaining_error`], which is no part of the standard errors: without a
//! correction above 10 D up to 1.2 % of E', with Love's below 0.2 % from 5 D on and about 1 % at 3 D. Between 10.1 D and 9.9 D
//! the modulus rises by the correction that sets in there.
//!
//! Theory: `docs/theory/slenderness.md#in-an-estimate`.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::slenderness::{
    FirstBranch, LoveRayleigh, PochhammerChree, RodTheory, RoundRod, Theory, recommend,
};

use crate::error::{CmodError, check_not_negative, check_positive};
use crate::estimate::{
    ErrorSource, LineCovariance, ModulusEstimate, ModulusLine, Refusal, RefusedLine, StandardError,
    SystematicShift, Uncertainty,
};
use crate::validity::{Validity, Violation};

/// Relative step in γ of the central difference that gives dE/dγ: E is analytic in γ, its third derivative by γ of the order
/// of E/γ³, so that truncation and rounding are both near 1e-10.
const STEP: f64 = 1e-5;

/// A round rod with its Poisson's ratio.
///
/// ```
/// use cmod::{LateralInertia, PulsedRod, SeparatePulses};
/// use num_complex::Complex64;
///
/// // a wave that lateral inertia has slowed down, in a rod of 15.8 mm: λ = 5 D at 20 kHz
/// let frequency_hz: Vec<f64> = (1..=40).map(|j| 500.0 * f64::from(j)).collect();
/// let gamma = |f: f64| Complex64::new(0.04, 1.0) * 78.0 * f / 20e3;
/// let ratio: Vec<Complex64> = frequency_hz.iter().map(|&f| (-0.3 * gamma(f)).exp()).collect();
/// let rod = PulsedRod { distance: 0.3, diameter: 0.0158, density: 912.0 };
/// let apparent = SeparatePulses::new(rod)?.estimate(&frequency_hz, &ratio, &[1e-6; 40])?;
///
/// let inertia = LateralInertia::new(0.0158, 912.0, 0.40)?.with_poisson_ratio_uncertainty(0.02)?;
/// let corrected = inertia.correct(&apparent)?;
/// let (before, after) = (&apparent.lines()[39], &corrected.modulus().lines()[39]);
/// assert!((after.modulus.re / before.modulus.re - 1.030).abs() < 1e-3);
/// // 2 × 0.02/0.40 of the correction
/// assert!((after.systematic_error().storage_modulus / after.modulus.re - 0.003).abs() < 2e-4);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralInertia {
    diameter: f64,
    density: f64,
    poisson_ratio: f64,
    poisson_ratio_uncertainty: f64,
    theory: Option<Theory>,
}

/// An estimate without lateral inertia.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CorrectedEstimate {
    settings: LateralInertia,
    modulus: ModulusEstimate,
    corrections: Vec<LineCorrection>,
}

/// What was done to one line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LineCorrection {
    /// The theory used.
    pub theory: Theory,
    /// λ/D.
    pub wavelength_in_diameters: f64,
    /// The modulus before \[Pa\].
    pub apparent_modulus: Complex64,
    /// ∂E/∂ν at constant γ \[Pa\].
    pub by_poisson_ratio: Complex64,
    /// Relative error of E' that the theory leaves, (E'_found - E')/E', for low losses; no part of the standard errors.
    pub remaining_error: f64,
}

impl CorrectedEstimate {
    /// The rod and Poisson's ratio.
    #[must_use]
    pub fn settings(&self) -> &LateralInertia {
        &self.settings
    }

    /// The modulus a line.
    #[must_use]
    pub fn modulus(&self) -> &ModulusEstimate {
        &self.modulus
    }

    /// What was done to each of the [lines](ModulusEstimate::lines) of the modulus, in their order.
    #[must_use]
    pub fn corrections(&self) -> &[LineCorrection] {
        &self.corrections
    }
}

impl LateralInertia {
    /// Of a rod of this `diameter` D \[m\], `density` ρ [kg/m³] and `poisson_ratio` ν, taken as exact.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless diameter and density are finite and above 0 and 0 <= ν <= 0.5.
    pub fn new(diameter: f64, density: f64, poisson_ratio: f64) -> Result<Self, CmodError> {
        check_positive("diameter [m]", diameter)?;
        check_positive("density [kg/m^3]", density)?;
        if !(0.0..=0.5).contains(&poisson_ratio) {
            return Err(CmodError::NonPhysical {
                quantity: "poisson's ratio",
                value: poisson_ratio,
                expected: "a value from 0 to 0.5",
            });
        }
        Ok(Self {
            diameter,
            density,
            poisson_ratio,
            poisson_ratio_uncertainty: 0.0,
            theory: None,
        })
    }

    /// The same with a standard uncertainty of ν.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless it is finite and not negative.
    pub fn with_poisson_ratio_uncertainty(mut self, uncertainty: f64) -> Result<Self, CmodError> {
        self.poisson_ratio_uncertainty =
            check_not_negative("uncertainty of poisson's ratio", uncertainty)?;
        Ok(self)
    }

    /// The same with one theory at all wavelengths, to compare them.
    #[must_use]
    pub fn with_theory(mut self, theory: Theory) -> Self {
        self.theory = Some(theory);
        self
    }

    /// Takes lateral inertia out of every line of an `estimate`.
    ///
    /// A corrected line is no longer judged by the condition λ > 5D, which is about the error that has been removed; all
    /// other violations stay. A line without a wavelength, or beyond the first branch of the theory, is refused as
    /// [`Refusal::LateralInertia`].
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a diameter or a density with which γ²D² or ρω²D² leave the range of numbers.
    pub fn correct(&self, estimate: &ModulusEstimate) -> Result<CorrectedEstimate, CmodError> {
        let rod = RoundRod {
            density: self.density,
            diameter: self.diameter,
            poisson_ratio: self.poisson_ratio,
        };
        let out_of_range = |_| CmodError::NonPhysical {
            quantity: "diameter [m]",
            value: self.diameter,
            expected: "a value with which the theories of lateral inertia can be evaluated",
        };
        let love = LoveRayleigh::round(rod).map_err(out_of_range)?;
        let exact = PochhammerChree::new(rod).map_err(out_of_range)?;
        let (mut lines, mut corrections) = (Vec::new(), Vec::new());
        let mut refused = estimate.refused().to_vec();
        for line in estimate.lines() {
            let in_diameters = line.wavelength() / self.diameter;
            let recommended = recommend(in_diameters, self.poisson_ratio).ok();
            let found = recommended.and_then(|recommended| {
                let theory = self.theory.unwrap_or(recommended.theory);
                let (corrected, remaining) = match theory {
                    Theory::Elementary => (Corrected::none(line), recommended.elementary_error),
                    Theory::LoveRayleigh => (Corrected::by(&love, line)?, recommended.love_error),
                    _ => (Corrected::by(&exact, line)?, 0.0),
                };
                let correction = LineCorrection {
                    theory,
                    wavelength_in_diameters: in_diameters,
                    apparent_modulus: line.modulus,
                    by_poisson_ratio: corrected.by_poisson_ratio,
                    remaining_error: remaining,
                };
                Some((
                    corrected.line(line, self.poisson_ratio_uncertainty)?,
                    correction,
                ))
            });
            match found {
                Some((line, correction)) => {
                    lines.push(line);
                    corrections.push(correction);
                }
                None => refused.push(RefusedLine {
                    index: line.index,
                    frequency_hz: line.frequency_hz,
                    reason: Refusal::LateralInertia,
                }),
            }
        }
        refused.sort_by_key(|line| line.index);
        Ok(CorrectedEstimate {
            settings: *self,
            modulus: ModulusEstimate::new(estimate.method().clone(), lines, refused),
            corrections,
        })
    }
}

/// E of one line by one theory.
struct Corrected {
    modulus: Complex64,
    /// dE/dγ by that of elementary theory, -2E_apparent/γ.
    factor: Complex64,
    by_poisson_ratio: Complex64,
    is_corrected: bool,
}

impl Corrected {
    fn none(line: &ModulusLine) -> Self {
        Self {
            modulus: line.modulus,
            factor: Complex64::ONE,
            by_poisson_ratio: Complex64::ZERO,
            is_corrected: false,
        }
    }

    fn by(theory: &impl RodTheory, line: &ModulusLine) -> Option<Self> {
        let omega = TAU * line.frequency_hz;
        let gamma = line.propagation_coefficient;
        let at = |gamma: Complex64| {
            theory
                .modulus(gamma, omega)
                .ok()
                .and_then(FirstBranch::found)
        };
        let found = at(gamma)?;
        let (larger, smaller) = (at(gamma * (1.0 + STEP))?, at(gamma * (1.0 - STEP))?);
        let slope = (larger.modulus - smaller.modulus) / (2.0 * STEP);
        // the density of the estimate may not be that of the theory: the ratio of moduli is
        let scale = line.modulus / found.apparent_modulus;
        Some(Self {
            modulus: found.modulus * scale,
            factor: slope / (-2.0 * found.apparent_modulus),
            by_poisson_ratio: found.by_poisson_ratio * scale,
            is_corrected: true,
        })
    }

    /// The line with everything that follows from the modulus.
    fn line(&self, line: &ModulusLine, poisson_ratio_uncertainty: f64) -> Option<ModulusLine> {
        let Uncertainty {
            random,
            systematic,
            degrees_of_freedom,
            own_degrees_of_freedom,
        } = line.uncertainty.clone();
        let random = LineCovariance {
            modulus: random.modulus.through(self.factor),
            ..random
        };
        let mut systematic: Vec<SystematicShift> = systematic
            .into_iter()
            .map(|shift| SystematicShift {
                modulus: shift.modulus * self.factor,
                ..shift
            })
            .collect();
        if poisson_ratio_uncertainty > 0.0 {
            systematic.push(SystematicShift::new(
                ErrorSource::PoissonRatio,
                self.by_poisson_ratio * poisson_ratio_uncertainty,
                Complex64::ZERO,
            ));
        }
        let uncertainty = Uncertainty::new(random, systematic, degrees_of_freedom)
            .with_own_degrees_of_freedom(own_degrees_of_freedom);
        let standard_error = StandardError::of(
            self.modulus,
            line.propagation_coefficient,
            line.frequency_hz,
            &uncertainty.total_covariance(),
        );
        let violations = line.validity.violations().iter().copied();
        let stays = |violation: &Violation| {
            !(self.is_corrected && matches!(violation, Violation::WavelengthTooShort { .. }))
        };
        let corrected = ModulusLine {
            modulus: self.modulus,
            loss_factor: self.modulus.im / self.modulus.re,
            standard_error,
            uncertainty,
            error_amplification: line.error_amplification
                * self.factor.norm()
                * (line.modulus.norm() / self.modulus.norm()),
            validity: Validity::from_violations(violations.filter(stays).collect()),
            ..line.clone()
        };
        let is_finite = corrected.loss_factor.is_finite() && corrected.standard_error.is_finite();
        is_finite.then_some(corrected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_rods_are_refused() {
        assert_eq!(
            LateralInertia::new(0.01, 900.0, 0.6)
                .unwrap_err()
                .to_string(),
            "poisson's ratio is 0.6, expected a value from 0 to 0.5"
        );
        assert_eq!(
            LateralInertia::new(-0.01, 900.0, 0.4)
                .unwrap_err()
                .to_string(),
            "diameter [m] is -0.01, expected a finite value above 0"
        );
        let rod = LateralInertia::new(0.01, 900.0, 0.4).unwrap();
        assert_eq!(
            rod.with_poisson_ratio_uncertainty(f64::NAN)
                .unwrap_err()
                .to_string(),
            "uncertainty of poisson's ratio is NaN, expected a finite value, 0 or above"
        );
    }
}
