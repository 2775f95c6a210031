//! The specimen and its loading.

use std::f64::consts::PI;

use super::bar::Known;
use crate::ImpulseError;

/// The loading of the specimen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Loading {
    /// Waves of compression; stress and strain of the specimen are positive in compression.
    Compression,
    /// Waves of tension; stress and strain are positive in tension.
    Tension,
    /// Waves of torsion: strains are shear strains at the surface of the bars, forces are torques,
    /// and velocities are angular.
    Torsion,
}

impl Loading {
    /// Sign of the strain in the incident wave.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Compression => -1.0,
            Self::Tension | Self::Torsion => 1.0,
        }
    }
}

/// Dimensions of the specimen.
///
/// | loading | force to stress | velocities to strain rate |
/// |---|---|---|
/// | compression, tension | $`\sigma = F/(\pi D^2/4)`$ | $`\dot\varepsilon = (v_1 - v_2)/L`$ |
/// | torsion of a thin tube, mean radius $`r`$ | $`\tau = M/(2\pi r^2 h)`$ | $`\dot\gamma = r(\dot\theta_1 - \dot\theta_2)/L`$ |
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestSpecimen {
    /// Length \[m\].
    pub length: Known,
    /// Diameter \[m\]; the outer diameter of a tube.
    pub diameter: Known,
    /// Thickness of the wall of a tube in torsion \[m\].
    pub wall: Option<Known>,
}

impl TestSpecimen {
    pub(super) fn check(&self, loading: Loading) -> Result<(), ImpulseError> {
        self.length.check_positive("length of the specimen [m]")?;
        self.diameter
            .check_positive("diameter of the specimen [m]")?;
        match (loading, self.wall) {
            (Loading::Torsion, None) => Err(ImpulseError::NonPhysical {
                quantity: "thickness of the wall of the specimen [m]",
                value: f64::NAN,
                expected: "a value: torsion requires a thin tube",
            }),
            (Loading::Torsion, Some(wall)) => {
                wall.check_positive("thickness of the wall of the specimen [m]")?;
                if 2.0 * wall.value < self.diameter.value {
                    Ok(())
                } else {
                    Err(ImpulseError::NonPhysical {
                        quantity: "thickness of the wall of the specimen [m]",
                        value: wall.value,
                        expected: "less than its outer radius",
                    })
                }
            }
            (_, Some(wall)) => Err(ImpulseError::NonPhysical {
                quantity: "thickness of the wall of the specimen [m]",
                value: wall.value,
                expected: "none, except for torsion",
            }),
            (_, None) => Ok(()),
        }
    }

    /// Stress per unit of force, or of torque.
    pub(super) fn stress_per_force(&self) -> f64 {
        match self.wall {
            None => 4.0 / (PI * self.diameter.value.powi(2)),
            Some(wall) => 1.0 / (2.0 * PI * self.mean_radius().powi(2) * wall.value),
        }
    }

    /// Strain rate per unit of relative velocity, or of angular velocity.
    pub(super) fn rate_per_velocity(&self) -> f64 {
        match self.wall {
            None => 1.0 / self.length.value,
            Some(_) => self.mean_radius() / self.length.value,
        }
    }

    fn mean_radius(&self) -> f64 {
        0.5 * (self.diameter.value - self.wall.map_or(0.0, |wall| wall.value))
    }
}
