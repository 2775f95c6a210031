//! Removal of lateral inertia from an estimate, with Poisson's ratio and its uncertainty.
//!
//! All methods of this crate determine γ and compute E = -ρω²/γ² from it, which neglects the
//! lateral motion of the rod: E is an *apparent* modulus, which is too small for short waves.
//! [`LateralInertia`] computes the modulus from the same γ by a single theory for the whole band
//! ([`rodwave::slenderness`]):
//!
//! | section | theory | modulus | error left in E' |
//! |---|---|---|---|
//! | round | Pochhammer and Chree | the exact frequency equation, solved for E | none |
//! | rectangular | Love and Rayleigh | E + ρν²k_p²ω², k_p² = (b² + h²)/12 | 0.2 % at λ = 5 D, 1 % at 3.2 D of a circle of the same k_p |
//!
//! A different theory for each wavelength would cause a step in E' where two theories meet. No
//! causal material has such a step.
//!
//! # Errors
//! The random error is propagated through the theory, δE = (dE/dγ) δγ. Poisson's ratio is the same
//! number on all lines. Its error is therefore a common error, δE = (∂E/∂ν) δν at constant γ, and
//! is added to the common errors of the specimen as a separate source,
//! [`ErrorSource::PoissonRatio`]. To leading order this error is 2δν/ν times the correction. The
//! errors of the specimen in the estimate are also propagated through the theory: errors of γ like
//! the random errors, and a density that is wrong by 1 % makes the corrected modulus wrong by 1 %.
//! The diameter is another common error, D ∂E/∂D = 2E + γ ∂E/∂γ at constant γ, because the theories
//! have the form E = ρω²D² G(γD). To leading order this error is 2δD/D times the correction. It is
//! added to the error that the same diameter causes in the estimate.
//!
//! The bound on the effect of lateral inertia on the estimate ([`ErrorSource::LateralInertia`]) is
//! replaced by the remaining error of the theory, [`LineCorrection::remaining_error`]. The lines
//! are then judged again by the [limits](ModulusEstimate::limits) of the estimate.
//!
//! Theory: `docs/theory/slenderness.md#correction-of-an-estimate`.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::slenderness::{
    FirstBranch, LoveRayleigh, PochhammerChree, RectangularRod, RodTheory, RoundRod, Theory,
};

use crate::error::{CmodError, check_not_negative, check_positive, check_that};
use crate::estimate::{
    Acceptance, ErrorSource, LineCovariance, ModulusEstimate, ModulusLine, Refusal,
    SystematicShift, Uncertainty,
};
use crate::validity::Violation;

/// Relative step in γ of the central difference for dE/dγ: E is analytic in γ, and its third
/// derivative with respect to γ is of the order of E/γ³. The relative errors of truncation and
/// rounding are therefore both near 1e-10.
const STEP: f64 = 1e-5;

/// Correction of lateral inertia for a uniform rod of known Poisson's ratio.
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
/// assert!((after.modulus.re / before.modulus.re - 1.032).abs() < 1e-3);
/// // the common error is 2 × 0.02/0.40 of the correction
/// assert!((after.systematic_error().storage_modulus / after.modulus.re - 0.0032).abs() < 3e-4);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralInertia {
    section: Section,
    density: f64,
    poisson_ratio: f64,
    poisson_ratio_uncertainty: f64,
    /// Standard uncertainty of the diameter \[m\].
    pub(crate) diameter_uncertainty: f64,
    theory: Option<Theory>,
}

/// Cross-section of the rod.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Section {
    /// Diameter D \[m\].
    Round { diameter: f64 },
    /// Width b and height h \[m\].
    Rectangular { width: f64, height: f64 },
}

impl Section {
    /// Returns the diameter D \[m\] of the circle with the same polar radius of gyration as the
    /// section, k_p² = D²/8.
    fn diameter(self) -> f64 {
        match self {
            Self::Round { diameter } => diameter,
            Self::Rectangular { width, height } => width.hypot(height) * (2.0_f64 / 3.0).sqrt(),
        }
    }

    /// Returns the theory with the least remaining error.
    fn theory(self) -> Theory {
        match self {
            Self::Round { .. } => Theory::PochhammerChree,
            Self::Rectangular { .. } => Theory::LoveRayleigh,
        }
    }
}

/// Estimate from which lateral inertia has been removed.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CorrectedEstimate {
    settings: LateralInertia,
    modulus: ModulusEstimate,
    corrections: Vec<LineCorrection>,
}

/// Correction of the modulus of one line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LineCorrection {
    /// Theory used.
    pub theory: Theory,
    /// Ratio λ/D; for a rectangle D is the diameter of the circle with the same polar radius of
    /// gyration.
    pub wavelength_in_diameters: f64,
    /// Apparent modulus before the correction \[Pa\].
    pub apparent_modulus: Complex64,
    /// Derivative ∂E/∂ν at constant γ \[Pa\].
    pub by_poisson_ratio: Complex64,
    /// Derivative ∂E/∂D at constant γ [Pa/m]; for a rectangle D is the diameter of the circle with
    /// the same polar radius of gyration.
    pub by_diameter: Complex64,
    /// Relative error of E' that remains after the correction, (E'_found - E')/E', for low losses.
    /// It is the bound on the common error [`ErrorSource::LateralInertia`] of the line. For a
    /// rectangle the value of a circle with the same polar radius of gyration is used, which is a
    /// good approximation for sections about as wide as high.
    pub remaining_error: f64,
}

impl CorrectedEstimate {
    /// Returns the correction that was applied, with the rod and Poisson's ratio.
    #[must_use]
    pub fn settings(&self) -> &LateralInertia {
        &self.settings
    }

    /// Returns the modulus per line.
    #[must_use]
    pub fn modulus(&self) -> &ModulusEstimate {
        &self.modulus
    }

    /// Returns the correction of each of the [lines](ModulusEstimate::lines) of the modulus, in
    /// their order.
    #[must_use]
    pub fn corrections(&self) -> &[LineCorrection] {
        &self.corrections
    }
}

impl LateralInertia {
    /// Creates the correction for a round rod of `diameter` D \[m\], `density` ρ [kg/m³] and
    /// `poisson_ratio` ν. All three are taken as exact, unless the uncertainty of ν or D is set.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless diameter and density are finite and above 0 and 0 <= ν <=
    /// 0.5.
    pub fn new(diameter: f64, density: f64, poisson_ratio: f64) -> Result<Self, CmodError> {
        check_positive("diameter [m]", diameter)?;
        Self::of_section(Section::Round { diameter }, density, poisson_ratio)
    }

    /// Creates the correction for a rectangular section, `width` b by `height` h \[m\], of
    /// `density` ρ [kg/m³] and `poisson_ratio` ν. All of them are taken as exact.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless width, height and density are finite and above 0 and 0 <=
    /// ν <= 0.5.
    pub fn rectangular(
        width: f64,
        height: f64,
        density: f64,
        poisson_ratio: f64,
    ) -> Result<Self, CmodError> {
        check_positive("width [m]", width)?;
        check_positive("height [m]", height)?;
        Self::of_section(
            Section::Rectangular { width, height },
            density,
            poisson_ratio,
        )
    }

    fn of_section(section: Section, density: f64, poisson_ratio: f64) -> Result<Self, CmodError> {
        check_positive("density [kg/m^3]", density)?;
        let is_right = (0.0..=0.5).contains(&poisson_ratio);
        let expected = "a value from 0 to 0.5";
        check_that(is_right, "Poisson's ratio", poisson_ratio, expected)?;
        Ok(Self {
            section,
            density,
            poisson_ratio,
            poisson_ratio_uncertainty: 0.0,
            diameter_uncertainty: 0.0,
            theory: None,
        })
    }

    /// Sets the standard uncertainty of Poisson's ratio ν.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the uncertainty is finite and not negative.
    pub fn with_poisson_ratio_uncertainty(mut self, uncertainty: f64) -> Result<Self, CmodError> {
        self.poisson_ratio_uncertainty =
            check_not_negative("uncertainty of Poisson's ratio", uncertainty)?;
        Ok(self)
    }

    /// Sets the standard uncertainty of the diameter D \[m\]; for a rectangle, that of the circle
    /// with the same polar radius of gyration.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the uncertainty is finite and not negative.
    pub fn with_diameter_uncertainty(mut self, uncertainty: f64) -> Result<Self, CmodError> {
        self.diameter_uncertainty =
            check_not_negative("uncertainty of the diameter [m]", uncertainty)?;
        Ok(self)
    }

    /// Sets the theory, for comparisons; the default is the theory of Pochhammer and Chree for a
    /// round rod and the theory of Love for a rectangle.
    #[must_use]
    pub fn with_theory(mut self, theory: Theory) -> Self {
        self.theory = Some(theory);
        self
    }

    /// Removes lateral inertia from every line of an `estimate`.
    ///
    /// A corrected line is no longer judged by the condition λ > 5D, which concerns the error that
    /// has been removed. The error limits are applied again; all other violations are kept. A line
    /// without a wavelength, or beyond the first branch of the theory, is refused as
    /// [`Refusal::LateralInertia`].
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a diameter or a density with which γ²D² or ρω²D² overflows or
    /// underflows; [`CmodError::TheoryOfRoundRods`] if the theory of Pochhammer and Chree is set
    /// for a rectangle.
    pub fn correct(&self, estimate: &ModulusEstimate) -> Result<CorrectedEstimate, CmodError> {
        let diameter = self.section.diameter();
        let out_of_range = |_| CmodError::NonPhysical {
            quantity: "diameter [m]",
            value: diameter,
            expected: "a value with which the theories of lateral inertia can be evaluated",
        };
        let round = RoundRod {
            density: self.density,
            diameter,
            poisson_ratio: self.poisson_ratio,
        };
        let chosen = self.theory.unwrap_or_else(|| self.section.theory());
        let theory: Option<Box<dyn RodTheory>> = match (chosen, self.section) {
            (Theory::Elementary, _) => None,
            (Theory::LoveRayleigh, Section::Rectangular { width, height }) => Some(Box::new(
                LoveRayleigh::rectangular(RectangularRod {
                    density: self.density,
                    width,
                    height,
                    poisson_ratio: self.poisson_ratio,
                })
                .map_err(out_of_range)?,
            )),
            (Theory::LoveRayleigh, Section::Round { .. }) => {
                Some(Box::new(LoveRayleigh::round(round).map_err(out_of_range)?))
            }
            (_, Section::Round { .. }) => {
                Some(Box::new(PochhammerChree::new(round).map_err(out_of_range)?))
            }
            (_, Section::Rectangular { .. }) => {
                return Err(CmodError::TheoryOfRoundRods {
                    theory: "the theory of Pochhammer and Chree",
                });
            }
        };
        let mut corrections = Vec::new();
        let modulus = estimate.revised(Refusal::LateralInertia, |line, acceptance| {
            let in_diameters = line.wavelength() / diameter;
            let remaining_error = chosen.error_left(in_diameters, self.poisson_ratio).ok()?;
            let corrected = match &theory {
                None => Corrected::none(line),
                Some(theory) => Corrected::by(theory.as_ref(), line)?,
            };
            let correction = LineCorrection {
                theory: chosen,
                wavelength_in_diameters: in_diameters,
                apparent_modulus: line.modulus,
                by_poisson_ratio: corrected.by_poisson_ratio,
                by_diameter: corrected.by_relative_diameter(line) / diameter,
                remaining_error,
            };
            let shifts = self.shifts(line, &corrected, &correction);
            let line = corrected.line(line, shifts, acceptance)?;
            corrections.push(correction);
            Some(line)
        })?;
        Ok(CorrectedEstimate {
            settings: *self,
            modulus,
            corrections,
        })
    }

    /// Returns the common errors added by the correction, which are due to the diameter, to
    /// Poisson's ratio and to the theory itself.
    fn shifts(
        &self,
        line: &ModulusLine,
        corrected: &Corrected,
        correction: &LineCorrection,
    ) -> Vec<SystematicShift> {
        let mut shifts = Vec::new();
        if self.diameter_uncertainty > 0.0 && corrected.is_corrected {
            shifts.push(SystematicShift::new(
                ErrorSource::Diameter,
                correction.by_diameter * self.diameter_uncertainty,
                Complex64::ZERO,
            ));
        }
        let uncertainty = self.poisson_ratio_uncertainty;
        if uncertainty > 0.0 && corrected.is_corrected {
            let first = corrected.by_poisson_ratio * uncertainty;
            // ½ρω²a²δν² ξ² with ξ of variance 1 has the root mean square √3/2 ρω²a²δν²; it is the
            // only term if ν = 0
            let inertia = TAU * line.frequency_hz * 0.5 * self.section.diameter();
            let second = 0.75_f64.sqrt() * self.density * (inertia * uncertainty).powi(2);
            shifts.push(SystematicShift::new(
                ErrorSource::PoissonRatio,
                Complex64::new(first.re.hypot(second), first.im),
                Complex64::ZERO,
            ));
        }
        // elementary theory has no error of E''; the error of Love's theory is its next term,
        // proportional to K²E ~ conj(E)
        let left = correction.remaining_error.abs();
        if left > 0.0 {
            let bound = if corrected.is_corrected {
                corrected.modulus.conj() * left
            } else {
                Complex64::new(corrected.modulus.re.abs() * left, 0.0)
            };
            shifts.push(SystematicShift::of_lateral_inertia(bound));
        }
        shifts
    }
}

/// Modulus of one line from one theory.
struct Corrected {
    modulus: Complex64,
    /// Ratio of dE/dγ to its value in elementary theory, -2E_apparent/γ.
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

    fn by(theory: &dyn RodTheory, line: &ModulusLine) -> Option<Self> {
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
        // the density of the estimate may differ from the density of the theory; the ratio of the
        // moduli is independent of the density
        let scale = line.modulus / found.apparent_modulus;
        Some(Self {
            modulus: found.modulus * scale,
            factor: slope / (-2.0 * found.apparent_modulus),
            by_poisson_ratio: found.by_poisson_ratio * scale,
            is_corrected: true,
        })
    }

    /// Returns D ∂E/∂D \[Pa\] at constant γ, 2E + γ ∂E/∂γ; 0 without a correction.
    fn by_relative_diameter(&self, line: &ModulusLine) -> Complex64 {
        2.0 * (self.modulus - self.factor * line.modulus)
    }

    /// Propagates a common error of the apparent modulus to the corrected modulus. Errors that act
    /// through γ are multiplied by the factor of the random errors, and a relative error of the
    /// modulus remains the same relative error of the corrected modulus.
    fn through(&self, shift: SystematicShift, line: &ModulusLine) -> SystematicShift {
        let by_gamma =
            -2.0 * line.modulus * shift.propagation_coefficient / line.propagation_coefficient;
        let direct = (shift.modulus - by_gamma) * (self.modulus / line.modulus);
        SystematicShift {
            modulus: by_gamma * self.factor + direct,
            ..shift
        }
    }

    /// Returns the line with all results derived from the modulus; `shifts` are the common errors
    /// of the correction.
    fn line(
        &self,
        line: &ModulusLine,
        shifts: Vec<SystematicShift>,
        acceptance: &Acceptance,
    ) -> Option<ModulusLine> {
        let known = &line.uncertainty;
        let random = LineCovariance {
            modulus: known.random.modulus.through(self.factor),
            ..known.random
        };
        let mut systematic: Vec<SystematicShift> = known
            .systematic
            .iter()
            .filter(|shift| shift.source != ErrorSource::LateralInertia)
            .map(|shift| self.through(*shift, line))
            .collect();
        for shift in shifts {
            // the error of the diameter in the estimate and in the correction is one error
            match systematic
                .iter_mut()
                .find(|known| known.source == shift.source)
            {
                Some(known) => known.modulus += shift.modulus,
                None => systematic.push(shift),
            }
        }
        let corrected = ModulusLine {
            modulus: self.modulus,
            uncertainty: Uncertainty {
                random,
                systematic,
                ..*known
            },
            error_amplification: line.error_amplification
                * self.factor.norm()
                * (line.modulus.norm() / self.modulus.norm()),
            ..line.clone()
        };
        let short =
            |violation: &Violation| matches!(violation, Violation::WavelengthTooShort { .. });
        corrected.revised(acceptance, |violation| {
            !(self.is_corrected && short(violation))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_rods_are_refused() {
        let text = |made: Result<LateralInertia, CmodError>| made.unwrap_err().to_string();
        assert_eq!(
            text(LateralInertia::new(0.01, 900.0, 0.6)),
            "Poisson's ratio is 0.6, expected a value from 0 to 0.5"
        );
        assert_eq!(
            text(LateralInertia::rectangular(0.01, f64::NAN, 900.0, 0.4)),
            "height [m] is NaN, expected a finite value above 0"
        );
        assert_eq!(
            text(LateralInertia::new(-0.01, 900.0, 0.4)),
            "diameter [m] is -0.01, expected a finite value above 0"
        );
        let rod = LateralInertia::new(0.01, 900.0, 0.4).unwrap();
        assert_eq!(
            text(rod.with_poisson_ratio_uncertainty(f64::NAN)),
            "uncertainty of Poisson's ratio is NaN, expected a finite value, 0 or above"
        );
        assert_eq!(
            text(rod.with_diameter_uncertainty(-1e-5)),
            "uncertainty of the diameter [m] is -0.00001, expected a finite value, 0 or above"
        );
    }
}
