//! Virtual rods.

use cmod::multi_point::Quantity;
use cmod::{EndSection, RodWithFreeEnd};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, Chain, Termination, WaveMedium};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Zener};

use crate::materials::flat;

/// Length of all rods \[m\], as in Test 3 of paper A.
pub(crate) const LENGTH: f64 = 0.801;
pub(crate) const DIAMETER: f64 = 0.0106;
pub(crate) const DENSITY: f64 = 903.0;

pub(crate) fn polypropylene() -> Medium<ConstantQ> {
    flat(DENSITY, 0.07)
}

/// Returns a material with one relaxation within the band.
pub(crate) fn relaxing() -> Medium<Zener> {
    Medium::new(DENSITY, Zener::new(2.4e9, 2.8e9, 4e-5).unwrap()).unwrap()
}

pub(crate) fn with_end_mass(end_mass: f64) -> RodWithFreeEnd {
    RodWithFreeEnd {
        diameter: DIAMETER,
        density: DENSITY,
        end_mass,
    }
}

/// Rod that is struck at one end and has a mass on the other end.
pub(crate) struct VirtualRod {
    chain: Chain,
}

impl VirtualRod {
    pub(crate) fn new<M>(medium: &M, end_mass: f64) -> Self
    where
        M: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        let chain = Chain::from_impact_face()
            .rod(medium, Circle::of_diameter(DIAMETER).unwrap(), LENGTH)
            .end(Termination::Mass(end_mass))
            .unwrap();
        Self { chain }
    }

    /// Returns the quantity measured at a section, up to a real factor, for an impulse of 1 N s.
    pub(crate) fn at(&self, section: EndSection, omega: f64) -> Complex64 {
        let position = LENGTH - section.distance;
        let state = self
            .chain
            .section(0, position)
            .unwrap()
            .state(omega)
            .unwrap();
        match section.quantity {
            Quantity::Strain => state.normal_force,
            Quantity::Displacement => state.velocity / Complex64::new(0.0, omega),
            Quantity::Velocity => state.velocity,
            Quantity::Acceleration => state.velocity * Complex64::new(0.0, omega),
        }
    }

    /// Returns the normal forces of the waves towards the free end and back, at this distance from
    /// the end.
    pub(crate) fn waves(&self, distance: f64, omega: f64) -> [Complex64; 2] {
        let section = self.chain.section(0, LENGTH - distance).unwrap();
        let waves = section.waves(omega).unwrap();
        [waves.forward_at(0.0), waves.backward_at(0.0)]
    }
}

/// Returns `count` frequencies, `step` \[Hz\] apart.
pub(crate) fn lines(count: u32, step: f64) -> Vec<f64> {
    (1..=count).map(|j| step * f64::from(j)).collect()
}
