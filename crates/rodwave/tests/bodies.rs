//! Media and bodies that several tests build, including those of paper E.

use rodwave::band_limited::VelocityHistory;
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{
    ConstantQ, Elastic, GeneralisedMaxwell, MaxwellBranch, PowerLawPropagation, Zener,
};
use rodwave::{Chain, Termination};

/// Paper E, eq. 7.
pub(crate) fn nylon_law() -> PowerLawPropagation {
    PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap()
}

pub(crate) fn nylon() -> Medium<PowerLawPropagation> {
    Medium::new(1150.0, nylon_law()).unwrap()
}

pub(crate) fn aluminium() -> Medium<Elastic> {
    Medium::new(2700.0, Elastic::new(69e9).unwrap()).unwrap()
}

pub(crate) fn steel() -> Medium<Elastic> {
    Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap()
}

pub(crate) fn polypropylene() -> Medium<ConstantQ> {
    Medium::new(915.0, ConstantQ::new(2.6e9, 0.07, 1e4).unwrap()).unwrap()
}

pub(crate) fn polymer() -> Medium<Zener> {
    Medium::new(910.0, Zener::new(2.2e9, 2.6e9, 3e-5).unwrap()).unwrap()
}

pub(crate) fn prony(equilibrium_modulus: f64, branches: &[(f64, f64)]) -> GeneralisedMaxwell {
    let branches = branches
        .iter()
        .map(|&(modulus, relaxation_time)| MaxwellBranch {
            modulus,
            relaxation_time,
        });
    GeneralisedMaxwell::new(equilibrium_modulus, branches.collect()).unwrap()
}

pub(crate) fn circle(diameter: f64) -> Circle {
    Circle::of_diameter(diameter).unwrap()
}

/// Truncated cone of paper E, struck at its thin end.
pub(crate) fn cone(end: Termination) -> Chain {
    Chain::from_impact_face()
        .cone(&nylon(), circle(0.030), circle(0.075), 0.400)
        .end(end)
        .unwrap()
}

/// Compound cylinder of paper E, struck at its Nylon-6 face.
pub(crate) fn cylinder(end: Termination) -> Chain {
    let (nylon, aluminium, face) = (nylon(), aluminium(), circle(0.032));
    Chain::from_impact_face()
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .end(end)
        .unwrap()
}

/// Smooth pulse of velocity, defined at every time.
pub(crate) struct Gaussian {
    pub(crate) peak: f64,
    pub(crate) centre: f64,
    pub(crate) width: f64,
}

impl VelocityHistory for Gaussian {
    fn at(&self, time: f64) -> f64 {
        self.peak * (-((time - self.centre) / self.width).powi(2)).exp()
    }

    fn slope(&self, time: f64) -> f64 {
        -2.0 * (time - self.centre) / self.width.powi(2) * self.at(time)
    }

    fn end(&self) -> f64 {
        1.0
    }
}

/// Pulse as smooth as those that an aluminium projectile of 30 mm causes after some centimetres of
/// rod; that of the script that computed
/// the reference of `solve_ivp`.
pub(crate) const PULSE: Gaussian = Gaussian {
    peak: 8.0,
    centre: 300e-6,
    width: 60e-6,
};
