//! Rod with a mass at either end, computed by the chain of `rodwave`.

use std::f64::consts::TAU;

use cmod::Specimen;
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, Chain, Termination, WaveMedium};
use rodwave::element::Circle;

pub(crate) const SPECIMEN: Specimen = Specimen {
    length: 0.4,
    diameter: 0.0158,
    density: 908.0,
    accelerometer_mass: 2.9e-3,
};

/// Returns â₁/â₂ of a rod of `medium` that carries `impacted_mass` [kg] at the struck end and the
/// accelerometer of the `specimen` at the other end.
pub(crate) fn acceleration_ratio<M>(
    medium: &M,
    specimen: &Specimen,
    impacted_mass: f64,
    frequency_hz: &[f64],
) -> Vec<Complex64>
where
    M: WaveMedium<AngularFrequency> + Clone + 'static,
{
    let chain = Chain::from_impact_face()
        .mass(impacted_mass)
        .rod(
            medium,
            Circle::of_diameter(specimen.diameter).unwrap(),
            specimen.length,
        )
        .end(Termination::Mass(specimen.accelerometer_mass))
        .unwrap();
    let velocity = |x: f64, f: f64| {
        let section = chain.section(1, x).unwrap();
        section.state(TAU * f).unwrap().velocity
    };
    let ratio = |&f: &f64| velocity(0.0, f) / velocity(specimen.length, f);
    frequency_hz.iter().map(ratio).collect()
}
