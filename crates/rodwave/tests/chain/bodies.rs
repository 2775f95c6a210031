//! The bodies of paper E, and what the tests of chains compare with.

use num_complex::Complex64;
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, PowerLawPropagation};
use rodwave::{Chain, Termination};

pub(crate) fn nylon() -> Medium<PowerLawPropagation> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    Medium::new(1150.0, law).unwrap()
}

pub(crate) fn aluminium() -> Medium<Elastic> {
    Medium::new(2700.0, Elastic::new(69e9).unwrap()).unwrap()
}

pub(crate) fn circle(diameter: f64) -> Circle {
    Circle::of_diameter(diameter).unwrap()
}

pub(crate) fn cone(end: Termination) -> Chain {
    Chain::from_impact_face()
        .cone(&nylon(), circle(0.030), circle(0.075), 0.400)
        .end(end)
        .unwrap()
}

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

pub(crate) fn relative(a: Complex64, b: Complex64) -> f64 {
    (a - b).norm() / b.norm()
}
