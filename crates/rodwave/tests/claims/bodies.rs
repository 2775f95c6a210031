//! The bodies of paper E.

use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, PowerLawPropagation};
use rodwave::{Chain, RodwaveError, Termination};

/// Paper E, eq. 7.
pub(super) fn nylon() -> Result<Medium<PowerLawPropagation>, RodwaveError> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    Medium::new(1150.0, law)
}

pub(super) fn aluminium() -> Result<Medium<Elastic>, RodwaveError> {
    Medium::new(2700.0, Elastic::new(69e9)?)
}

pub(super) fn steel() -> Result<Medium<Elastic>, RodwaveError> {
    Medium::new(7780.0, Elastic::new(206e9)?)
}

pub(super) fn circle(diameter: f64) -> Result<Circle, RodwaveError> {
    Circle::of_diameter(diameter)
}

/// The truncated cone, struck at its thin end.
pub(super) fn cone(end: Termination) -> Result<Chain, RodwaveError> {
    Chain::from_impact_face()
        .cone(&nylon()?, circle(0.030)?, circle(0.075)?, 0.400)
        .end(end)
}

/// The compound cylinder, struck at the Nylon-6.
pub(super) fn cylinder(end: Termination) -> Result<Chain, RodwaveError> {
    let (nylon, aluminium, face) = (nylon()?, aluminium()?, circle(0.032)?);
    Chain::from_impact_face()
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .end(end)
}
