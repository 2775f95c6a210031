//! Uncertainties of a rod with gauges that are common to all lines.

use num_complex::Complex64;

use super::spectra::GaugedRod;
use crate::error::{CmodError, check_not_negative, check_that};
use crate::estimate::{ErrorSource, SystematicShift};

/// Standard uncertainties of a rod with gauges, which are independent of each other and the same on
/// all lines. Set 0, or an empty list, for exact quantities.
///
/// ```text
/// density:           dE/E = dρ/ρ
/// position of j:     dE/E = -(2/γ) (∂γ/∂x_j) dx_j
/// sensitivity of j:  dE/E = -(2/γ) (∂γ/∂ln q_j) u_j
/// delay of j:        dE/E = -(2/γ) (∂γ/∂ln q_j) (-s dt_j)
/// ```
///
/// A gauge with an offset dx measures q(x) + q'(x) dx, which changes γ like any other error of this
/// gauge. For gauges at any positions, ∂γ/∂x_j = Σ d_j* q'_j/Σ|d|² over the tests, with q' = γ (N
/// e^{γx} - P e^{-γx}) and d as in [`MultiPoint`](super::MultiPoint::estimate); for three
/// equidistant gauges the derivative follows from dΨ. For an error of the sensitivity, q_j replaces
/// q'_j. A common shift of all gauges does not change γ, and neither does a common error of
/// sensitivity or delay; a common scale of the positions acts like a scale of the length: Σ ∂γ/∂x_j
/// = 0, Σ ∂γ/∂ln q_j = 0, Σ x_j ∂γ/∂x_j = γ.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GaugeUncertainty {
    /// Uncertainty of the density [kg/m³].
    pub density: f64,
    /// Uncertainty of the position of each gauge \[m\].
    pub positions: Vec<f64>,
    /// Relative uncertainty of the sensitivity of each gauge.
    pub factors: Vec<f64>,
    /// Uncertainty of the delay of the channel of each gauge \[s\].
    pub delays: Vec<f64>,
    /// Uncertainty of the position of the free end \[m\], if a free end is used.
    pub free_end: f64,
    /// Uncertainty of the mass on the free end \[kg\].
    pub end_mass: f64,
    /// Uncertainty of the diameter \[m\], which acts only through the mass on the free end.
    pub diameter: f64,
}

/// Error of one gauge: the additional measured value, expressed by factors on the value and on its
/// slope at the gauge.
#[derive(Debug, Clone, Copy)]
pub(super) struct GaugeError {
    pub(super) gauge: usize,
    pub(super) by_value: Complex64,
    /// Coefficient of the slope \[m\].
    pub(super) by_slope: f64,
}

impl GaugeError {
    /// Returns the error of a source that is wrong by its standard `uncertainty`, at s = σ + iω;
    /// `None` if the source does not belong to a gauge of the `rod` or to its free end.
    pub(super) fn of(
        source: ErrorSource,
        uncertainty: f64,
        s: Complex64,
        rod: &GaugedRod,
    ) -> Option<Self> {
        let (gauge, by_value, by_slope) = match source {
            ErrorSource::GaugePosition(gauge) => (gauge, Complex64::ZERO, uncertainty),
            ErrorSource::GaugeFactor(gauge) => (gauge, uncertainty.into(), 0.0),
            ErrorSource::GaugeDelay(gauge) => (gauge, -s * uncertainty, 0.0),
            ErrorSource::FreeEnd => {
                let last = rod.positions.len().checked_sub(1)?;
                (last, Complex64::ZERO, uncertainty)
            }
            _ => return None,
        };
        Some(Self {
            gauge,
            by_value,
            by_slope,
        })
    }
}

/// Influence of one gauge on γ.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct GaugeInfluence {
    /// Derivative ∂γ/∂x with respect to the position [1/m²].
    pub(super) position: Complex64,
    /// Derivative ∂γ/∂ln q with respect to the relative sensitivity [1/m].
    pub(super) scale: Complex64,
    /// Derivative ∂γ/∂ℓ [1/m²], where ℓ is the stated length of rod that has the same mass as the
    /// mass on the end. It is 0 except in the row of the end.
    pub(super) end_length: Complex64,
}

/// Required value of the mass on a free end, and of the uncertainties of the free end, if no free
/// end is used.
pub(super) const NO_FREE_END: &str = "0: no free end is used";

impl GaugeUncertainty {
    pub(crate) fn check(self, n_gauges: usize, has_free_end: bool) -> Result<Self, CmodError> {
        for (quantity, value) in [
            (
                "uncertainty of the position of the free end [m]",
                self.free_end,
            ),
            ("uncertainty of the mass on the end [kg]", self.end_mass),
            ("uncertainty of the diameter [m]", self.diameter),
        ] {
            check_not_negative(quantity, value)?;
            check_that(has_free_end || value <= 0.0, quantity, value, NO_FREE_END)?;
        }
        check_not_negative("uncertainty of the density [kg/m^3]", self.density)?;
        for (quantity, values, expected) in [
            (
                "uncertainty of the position of a gauge [m]",
                &self.positions,
                "an uncertainty of the position of each gauge, or none",
            ),
            (
                "relative uncertainty of the sensitivity of a gauge",
                &self.factors,
                "an uncertainty of the sensitivity of each gauge, or none",
            ),
            (
                "uncertainty of the delay of a gauge [s]",
                &self.delays,
                "an uncertainty of the delay of each gauge, or none",
            ),
        ] {
            for value in values {
                check_not_negative(quantity, *value)?;
            }
            if !values.is_empty() && values.len() != n_gauges {
                return Err(CmodError::GaugeCount {
                    found: values.len(),
                    expected,
                });
            }
        }
        Ok(self)
    }

    /// Returns true if any property of a gauge or of the free end is uncertain.
    pub(super) fn is_of_gauges(&self) -> bool {
        [&self.positions, &self.factors, &self.delays]
            .into_iter()
            .flatten()
            .any(|value| *value > 0.0)
            || self.free_end > 0.0
            || self.end_mass > 0.0
    }

    /// Returns the changes of the length m/(ρA) \[m\] of rod that has the same mass as the mass on
    /// the end, with their sources.
    fn of_end_length(&self, rod: &GaugedRod, mass: f64) -> [(ErrorSource, f64); 3] {
        let length = rod.length_of(mass);
        [
            (ErrorSource::AccelerometerMass, rod.length_of(self.end_mass)),
            (
                ErrorSource::Diameter,
                -2.0 * length * self.diameter / rod.diameter,
            ),
            (ErrorSource::Density, -length * self.density / rod.density),
        ]
    }

    /// Returns the uncertain sources of the gauges with their standard uncertainties: positions,
    /// sensitivities, delays and the free end.
    pub(super) fn of_gauges(&self) -> impl Iterator<Item = (ErrorSource, f64)> {
        fn of(
            values: &[f64],
            source: fn(usize) -> ErrorSource,
        ) -> impl Iterator<Item = (ErrorSource, f64)> {
            let numbered = values.iter().enumerate();
            numbered
                .filter(|(_, value)| **value > 0.0)
                .map(move |(gauge, value)| (source(gauge), *value))
        }
        of(&self.positions, ErrorSource::GaugePosition)
            .chain(of(&self.factors, ErrorSource::GaugeFactor))
            .chain(of(&self.delays, ErrorSource::GaugeDelay))
            .chain((self.free_end > 0.0).then_some((ErrorSource::FreeEnd, self.free_end)))
    }

    /// Returns the shifts of a line at `s` with `gamma` and `modulus` in this `rod`, from the
    /// influence of each gauge.
    pub(super) fn shifts(
        &self,
        s: Complex64,
        (gamma, modulus): (Complex64, Complex64),
        (rod, end_mass): (&GaugedRod, f64),
        influence: &[GaugeInfluence],
    ) -> Vec<SystematicShift> {
        let by_length = influence.last().map_or(Complex64::ZERO, |i| i.end_length);
        let of_rod = self.of_end_length(rod, end_mass).into_iter();
        let of_rod = of_rod.filter_map(|(source, of_length)| {
            let of_density = match source {
                ErrorSource::Density => self.density / rod.density,
                _ => 0.0,
            };
            let of_gamma = by_length * of_length;
            let shift = modulus * of_density - 2.0 * modulus / gamma * of_gamma;
            let acts = of_density > 0.0 || of_gamma != Complex64::ZERO;
            acts.then(|| SystematicShift::new(source, shift, of_gamma))
        });
        let of_gauges = self.of_gauges().filter_map(|(source, uncertainty)| {
            let error = GaugeError::of(source, uncertainty, s, rod)?;
            let influence = influence.get(error.gauge)?;
            let of_gamma = error.by_slope * influence.position + error.by_value * influence.scale;
            let of_modulus = -2.0 * modulus / gamma * of_gamma;
            Some(SystematicShift::new(source, of_modulus, of_gamma))
        });
        of_rod.chain(of_gauges).collect()
    }
}
