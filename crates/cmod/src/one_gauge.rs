//! Modulus from one gauge and a free end: the pulse and its reflection (Bacon, *Experimental
//! Mechanics* 38, 1998).
//!
//! A gauge at the distance d from the free end measures the incident pulse and later the reflected
//! pulse. Each of them is cut out of the record with its own window. With a mass m on the end and l
//! = m/(ρA),
//!
//! ```text
//! H = ε̂_r/ε̂_i = -e^{-2γd} (1 - lγ)/(1 + lγ) ,    v̂_r/v̂_i = +e^{-2γd} (1 - lγ)/(1 + lγ)
//! ```
//!
//! where lγ = iωm/Z is the ratio of the impedance of the mass to the impedance of the rod. Without
//! a mass the closed form is α = -ln|H|/2d and k = -arg(-H)/2d, with the phase continued from 0 Hz.
//!
//! # Errors
//! With noise of variance σ² in both spectra, and without a mass,
//!
//! ```text
//! E|δγ|² = σ²/(4d²|ε̂_i|²) · (1 + 1/|H|²)
//! ```
//!
//! The variance is least for 2x = 1 + e^{-4x}, that is, x = αd = 0.55. The reflected pulse has then
//! lost two thirds of its amplitude.
//!
//! Pulses that overlap at the gauge cannot be cut out. If the motion of the free end or of the
//! section is also recorded, the pulses need not be separated: see [`FreeEnd`](crate::FreeEnd).
//!
//! Theory: `docs/theory/neighbouring-methods.md`.

use num_complex::Complex64;
use rodwave::numerics::Jet;

use crate::error::{CmodError, check_positive};
use crate::estimate::{ErrorSource, Method};
use crate::free_end::{EndSection, RodWithFreeEnd};
use crate::multi_point::Quantity;
use crate::pulses::nearest_logarithm;
use crate::section_ratio::{Changed, RodOfRatio, SectionRatio, Settings};

/// Method for the modulus from the incident and the reflected pulse at one section.
///
/// ```
/// use cmod::multi_point::Quantity;
/// use cmod::{EndSection, OneGauge, RodWithFreeEnd};
/// use num_complex::Complex64;
///
/// // a wave with c = 1700 m/s and a loss factor of 0.1, 0.3 m from the free end
/// let frequency_hz: Vec<f64> = (1..=100).map(|j| 100.0 * f64::from(j)).collect();
/// let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0);
/// let ratio: Vec<Complex64> = frequency_hz.iter().map(|&f| -(-0.6 * gamma(f)).exp()).collect();
/// let rod = RodWithFreeEnd { diameter: 0.0106, density: 903.0, end_mass: 0.0 };
/// let gauge = EndSection { distance: 0.3, quantity: Quantity::Strain };
/// let estimate = OneGauge::new(rod, gauge)?.estimate(&frequency_hz, &ratio, &[1e-8; 100])?;
/// for line in estimate.valid() {
///     assert!((line.phase_velocity - 1700.0).abs() < 1e-9);
/// }
/// assert!(estimate.valid().count() > 90);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneGauge {
    rod: RodWithFreeEnd,
    section: EndSection,
    settings: Settings,
}

setters! { OneGauge: wave_speed, delay, uncertainty, limits }

impl OneGauge {
    /// Creates the method for one rod and one section.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for impossible values of the rod, and unless the distance from
    /// the end is finite and above 0.
    pub fn new(rod: RodWithFreeEnd, section: EndSection) -> Result<Self, CmodError> {
        rod.check()?;
        check_positive("distance from the free end [m]", section.distance)?;
        Ok(Self {
            rod,
            section,
            settings: Settings::default(),
        })
    }

    estimate! {
        /// Returns the complex modulus from the `ratio` H of the reflected to the incident pulse
        /// and its `variance` E|δH|², at the increasing frequencies `frequency_hz` \[Hz\]. All
        /// arrays have one entry per line.
        ///
        /// Both spectra must have the same origin of time, whatever their windows are.
        ///
        /// # Errors
        /// [`CmodError::NoLines`], [`CmodError::LengthMismatch`], [`CmodError::Frequency`],
        /// [`CmodError::FrequencyOrder`], [`CmodError::NegativeVariance`]. A single bad line is not
        /// an error: it is [refused](crate::ModulusEstimate::refused).
        ratio
    }

    /// Returns the reflection coefficient of the quantity at a free end without mass.
    fn reflection(&self) -> f64 {
        if self.section.quantity == Quantity::Strain {
            -1.0
        } else {
            1.0
        }
    }
}

impl SectionRatio for OneGauge {
    const METHOD: Method = Method("one gauge and a free end");

    fn jets(&self, gamma: Complex64, _omega: f64) -> [Jet; 2] {
        let l = self.rod.length_of_end_mass();
        let reflection = self.reflection();
        let way = Jet::decay(2.0 * self.section.distance, gamma);
        [
            way * Jet::linear(reflection - reflection * l * gamma, -reflection * l),
            Jet::linear(1.0 + l * gamma, l),
        ]
    }

    fn distance(&self) -> f64 {
        2.0 * self.section.distance
    }

    fn rod(&self) -> RodOfRatio {
        RodOfRatio {
            diameter: self.rod.diameter,
            density: self.rod.density,
        }
    }

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn changed(&self) -> Vec<Changed<Self>> {
        let uncertainty = &self.settings.uncertainty;
        let mut changed = self.rod.changed(uncertainty, |rod| Self { rod, ..*self });
        changed.extend(Changed::of(
            ErrorSource::Section(0),
            uncertainty.distance,
            |by| {
                let mut changed = *self;
                changed.section.distance += by;
                changed
            },
        ));
        changed
    }

    fn closed_form(&self, ratio: Complex64, expected: Complex64) -> Option<Complex64> {
        (self.rod.end_mass == 0.0)
            .then(|| nearest_logarithm(self.reflection() * ratio, self.distance(), expected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gauge_at_the_end_is_refused() {
        let rod = RodWithFreeEnd {
            diameter: 0.0106,
            density: 903.0,
            end_mass: 0.0,
        };
        let section = EndSection {
            distance: 0.0,
            quantity: Quantity::Strain,
        };
        assert_eq!(
            OneGauge::new(rod, section).unwrap_err().to_string(),
            "distance from the free end [m] is 0, expected a finite value above 0"
        );
    }
}
