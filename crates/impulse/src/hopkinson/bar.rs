//! A bar with its gauges.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use rodwave::medium::PropagationLaw;
use rodwave::modulus::Elastic;
use rodwave::slenderness::{PochhammerChree, RodTheory, RoundRod};

use crate::ImpulseError;
use crate::error::{check_not_negative, check_positive};

/// A value with its standard uncertainty, both in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// The value.
    pub value: f64,
    /// Standard uncertainty of the value, 0 for an exact value.
    pub standard_uncertainty: f64,
}

impl Known {
    /// Creates a value without error.
    #[must_use]
    pub fn exactly(value: f64) -> Self {
        Self::within(value, 0.0)
    }

    /// Creates a value with a standard uncertainty in its unit.
    #[must_use]
    pub fn within(value: f64, standard_uncertainty: f64) -> Self {
        Self {
            value,
            standard_uncertainty,
        }
    }

    /// Returns the value moved by `standard` standard uncertainties.
    pub(super) fn moved(self, standard: f64) -> f64 {
        self.value + standard * self.standard_uncertainty
    }

    pub(super) fn check_positive(&self, quantity: &'static str) -> Result<(), ImpulseError> {
        check_positive(quantity, self.value)?;
        check_not_negative(quantity, self.standard_uncertainty).map(|_| ())
    }
}

/// Density and law of the modulus of a bar: Young's modulus, or the shear modulus for torsion.
#[derive(Clone)]
pub struct BarMaterial {
    density: f64,
    law: Arc<dyn PropagationLaw + Send + Sync>,
    known_to_hz: f64,
}

impl fmt::Debug for BarMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BarMaterial")
            .field("density", &self.density)
            .finish_non_exhaustive()
    }
}

impl BarMaterial {
    /// Creates a material of `density` [kg/m³] with any law of `rodwave`.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the density.
    pub fn new(
        density: f64,
        law: Arc<dyn PropagationLaw + Send + Sync>,
    ) -> Result<Self, ImpulseError> {
        check_positive("density of a bar [kg/m^3]", density)?;
        Ok(Self {
            density,
            law,
            known_to_hz: f64::INFINITY,
        })
    }

    /// Returns the material with a law that was measured up to `frequency_hz` \[Hz\]: a default
    /// band extends no higher.
    #[must_use]
    pub fn known_to(self, frequency_hz: f64) -> Self {
        Self {
            known_to_hz: frequency_hz,
            ..self
        }
    }

    /// Frequency up to which the law was measured \[Hz\], infinite for a law that is valid at all
    /// frequencies.
    #[must_use]
    pub fn known_to_hz(&self) -> f64 {
        self.known_to_hz
    }

    /// Creates an elastic material from its `density` [kg/m³] and the speed of long waves in its
    /// bars [m/s], $`E = \rho c^2`$.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a value that is not above 0.
    pub fn of_wave_speed(density: f64, speed: f64) -> Result<Self, ImpulseError> {
        check_positive("wave speed of a bar [m/s]", speed)?;
        let modulus = check_positive("modulus of a bar [Pa]", density * speed * speed)?;
        let law = Elastic::new(modulus).map_err(|source| ImpulseError::Body {
            s: Complex64::ZERO,
            source,
        })?;
        Self::new(density, Arc::new(law))
    }

    /// Returns the material with its complex modulus multiplied by `factor` and its density
    /// multiplied by `density_factor`.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a factor that is not above 0.
    pub fn scaled(&self, factor: f64, density_factor: f64) -> Result<Self, ImpulseError> {
        check_positive("factor of a modulus", factor)?;
        check_positive("factor of a density", density_factor)?;
        Ok(Self {
            density: self.density * density_factor,
            law: Arc::new(Scaled {
                law: Arc::clone(&self.law),
                factor,
            }),
            known_to_hz: self.known_to_hz,
        })
    }

    /// Density [kg/m³].
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Complex modulus \[Pa\] at `omega` [rad/s].
    #[must_use]
    pub fn modulus(&self, omega: f64) -> Complex64 {
        self.law.modulus(omega, self.density)
    }
}

/// A law with its modulus multiplied by a factor.
struct Scaled {
    law: Arc<dyn PropagationLaw + Send + Sync>,
    factor: f64,
}

impl PropagationLaw for Scaled {
    fn propagation_coefficient(&self, omega: f64, density: f64) -> Complex64 {
        self.law.propagation_coefficient(omega, density) / self.factor.sqrt()
    }

    fn modulus(&self, omega: f64, density: f64) -> Complex64 {
        self.law.modulus(omega, density) * self.factor
    }
}

/// A strain gauge on a bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarGauge {
    /// Distance from the end of the bar at the specimen \[m\].
    pub distance: Known,
    /// Relative standard uncertainty of the strain: gauge factor, bridge and amplifier.
    pub factor_uncertainty: f64,
    /// Standard uncertainty of the time of its record relative to the other gauges \[s\].
    pub delay_uncertainty: f64,
}

impl BarGauge {
    /// Creates a gauge at `distance` \[m\] without error.
    #[must_use]
    pub fn at(distance: f64) -> Self {
        Self {
            distance: Known::exactly(distance),
            factor_uncertainty: 0.0,
            delay_uncertainty: 0.0,
        }
    }
}

/// A bar with its gauges.
#[derive(Debug, Clone)]
pub struct HopkinsonBar {
    /// Material.
    pub material: BarMaterial,
    /// Diameter \[m\].
    pub diameter: Known,
    /// Length \[m\].
    pub length: Known,
    /// Poisson's ratio, for the lateral inertia after Pochhammer and Chree; without it, waves are
    /// taken as one-dimensional.
    pub poisson_ratio: Option<Known>,
    /// One or two gauges.
    pub gauges: Vec<BarGauge>,
}

impl HopkinsonBar {
    pub(super) fn check(&self) -> Result<(), ImpulseError> {
        self.diameter.check_positive("diameter of a bar [m]")?;
        self.length.check_positive("length of a bar [m]")?;
        if self.gauges.is_empty() || self.gauges.len() > 2 {
            return Err(ImpulseError::LengthMismatch {
                what: "list of gauges of a bar",
                found: self.gauges.len(),
                expected: if self.gauges.is_empty() { 1 } else { 2 },
            });
        }
        for gauge in &self.gauges {
            gauge
                .distance
                .check_positive("distance of a gauge from the specimen [m]")?;
            check_not_negative("uncertainty of a gauge factor", gauge.factor_uncertainty)?;
            check_not_negative("uncertainty of a delay [s]", gauge.delay_uncertainty)?;
            if gauge.distance.value >= self.length.value {
                return Err(ImpulseError::NonPhysical {
                    quantity: "distance of a gauge from the specimen [m]",
                    value: gauge.distance.value,
                    expected: "less than the length of its bar",
                });
            }
        }
        if let [first, second] = self.gauges.as_slice()
            && (first.distance.value - second.distance.value).abs() <= 0.0
        {
            return Err(ImpulseError::NonPhysical {
                quantity: "distance between the two gauges of a bar [m]",
                value: 0.0,
                expected: "a value above 0: two gauges at one section measure the same strain",
            });
        }
        Ok(())
    }

    /// Propagation coefficient $`\gamma = \alpha + ik`$ [1/m] at `omega` > 0 [rad/s].
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NoBarWave`] where there is no longitudinal wave of the first mode.
    pub fn propagation(&self, omega: f64) -> Result<Complex64, ImpulseError> {
        let material = &self.material;
        let none = || ImpulseError::NoBarWave {
            frequency_hz: omega / std::f64::consts::TAU,
        };
        let gamma = match &self.poisson_ratio {
            None => material
                .law
                .propagation_coefficient(omega, material.density),
            Some(ratio) => PochhammerChree::new(RoundRod {
                density: material.density,
                diameter: self.diameter.value,
                poisson_ratio: ratio.value,
            })
            .and_then(|theory| theory.propagation_coefficient(material.modulus(omega), omega))
            .map_err(|source| ImpulseError::Body {
                s: Complex64::new(0.0, omega),
                source,
            })?
            .found()
            .ok_or_else(none)?,
        };
        if gamma.is_finite() && gamma.im > 0.0 {
            Ok(gamma)
        } else {
            Err(none())
        }
    }

    /// Phase velocity [m/s] at `frequency_hz` > 0.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::propagation`].
    pub fn phase_velocity(&self, frequency_hz: f64) -> Result<f64, ImpulseError> {
        let omega = std::f64::consts::TAU * frequency_hz;
        Ok(omega / self.propagation(omega)?.im)
    }

    /// Returns an elastic bar without dispersion, with the phase velocity of this bar at
    /// `frequency_hz` > 0.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::propagation`].
    pub fn as_elastic(&self, frequency_hz: f64) -> Result<Self, ImpulseError> {
        let speed = self.phase_velocity(frequency_hz)?;
        Ok(Self {
            material: BarMaterial::of_wave_speed(self.material.density, speed)?,
            poisson_ratio: None,
            ..self.clone()
        })
    }
}
