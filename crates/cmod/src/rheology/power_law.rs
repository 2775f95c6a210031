//! Power laws of the damping coefficient and the wave number, which together with a density give
//! the modulus.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::modulus::PowerLawPropagation;

use super::data::ModulusData;
use super::model::{Model, ParameterKind};
use super::parameter::Scale;
use super::straight_line;
use super::transient::Lines;

/// Law E = -ρω²/γ² with γ = a ω^p + i b ω^q (Ödeen 1993, paper E, eq. 7).
///
/// p and q are the fitted values, even if they are not physical. For an elastic rod, q is 1 plus an
/// error of either sign.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PowerLaw {
    /// Factor a [s^p/m].
    pub damping_factor: f64,
    /// Exponent p.
    pub damping_exponent: f64,
    /// Factor b [s^q/m].
    pub wave_number_factor: f64,
    /// Exponent q.
    pub wave_number_exponent: f64,
    /// Density ρ [kg/m³], as given.
    pub density: f64,
}

impl PowerLaw {
    /// Returns the propagation coefficient γ [1/m] at `omega` > 0 [rad/s].
    #[must_use]
    pub fn propagation_coefficient(&self, omega: f64) -> Complex64 {
        Complex64::new(
            self.damping_factor * omega.powf(self.damping_exponent),
            self.wave_number_factor * omega.powf(self.wave_number_exponent),
        )
    }

    /// Returns the complex modulus \[Pa\] at `omega` > 0 [rad/s].
    #[must_use]
    pub fn modulus(&self, omega: f64) -> Complex64 {
        let slowness = self.propagation_coefficient(omega) / omega;
        -self.density / (slowness * slowness)
    }

    /// Returns the corresponding law of `rodwave`.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for q > 1, which means a material that softens as the rate of
    /// loading increases, and for p <= 0.
    pub fn law(&self) -> Result<PowerLawPropagation, RodwaveError> {
        PowerLawPropagation::new(
            self.damping_factor,
            self.damping_exponent,
            self.wave_number_factor,
            self.wave_number_exponent,
        )
    }
}

/// Model with the coordinates ln a, p, ln b, q.
#[derive(Debug, Clone)]
pub(super) struct PowerLawModel {
    density: f64,
    kinds: Vec<ParameterKind>,
}

impl PowerLawModel {
    pub(super) fn new(density: f64) -> Self {
        Self {
            density,
            kinds: vec![
                ParameterKind::new("damping factor", "s^p/m", Scale::Ratio).of_loss(0),
                ParameterKind::new("damping exponent", "1", Scale::Difference).of_loss(0),
                ParameterKind::new("wave number factor", "s^q/m", Scale::Ratio),
                ParameterKind::new("wave number exponent", "1", Scale::Difference),
            ],
        }
    }

    pub(super) fn law_at(&self, at: &[f64]) -> PowerLaw {
        match *at {
            [a, p, b, q] => PowerLaw {
                damping_factor: a.exp(),
                damping_exponent: p,
                wave_number_factor: b.exp(),
                wave_number_exponent: q,
                density: self.density,
            },
            // unreachable, because all callers have four coordinates
            _ => PowerLaw {
                damping_factor: f64::NAN,
                damping_exponent: f64::NAN,
                wave_number_factor: f64::NAN,
                wave_number_exponent: f64::NAN,
                density: self.density,
            },
        }
    }

    /// Fits straight lines through ln α and ln k of the points with α > 0; `None` for fewer than
    /// two such points.
    pub(super) fn start(&self, data: &ModulusData) -> Option<Vec<f64>> {
        let mut damping = Vec::new();
        let mut wave_number = Vec::new();
        for (omega, modulus) in data.omega.iter().zip(&data.modulus) {
            let gamma = Complex64::new(0.0, *omega) * (self.density / modulus).sqrt();
            if gamma.im > 0.0 {
                wave_number.push((omega.ln(), gamma.im.ln()));
                if gamma.re > 0.0 {
                    damping.push((omega.ln(), gamma.re.ln()));
                }
            }
        }
        let (a, p) = straight_line(&damping)?;
        let (b, q) = straight_line(&wave_number)?;
        Some(vec![a, p, b, q])
    }
}

impl Model for PowerLawModel {
    fn kinds(&self) -> &[ParameterKind] {
        &self.kinds
    }

    fn evaluate(
        &self,
        at: &[f64],
        lines: Lines<'_>,
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool {
        let law = self.law_at(at);
        let rows = gradient.chunks_exact_mut(4);
        for (((omega, _), modulus), row) in lines.iter().zip(modulus).zip(rows) {
            let gamma = law.propagation_coefficient(omega);
            let slowness = gamma / omega;
            *modulus = -self.density / (slowness * slowness);
            // dE = -2E dγ/γ
            let factor = -2.0 * *modulus / gamma;
            let logarithm = omega.ln();
            let by_damping = factor * gamma.re;
            let by_wave_number = factor * Complex64::new(0.0, gamma.im);
            row.copy_from_slice(&[
                by_damping,
                by_damping * logarithm,
                by_wave_number,
                by_wave_number * logarithm,
            ]);
        }
        true
    }
}
