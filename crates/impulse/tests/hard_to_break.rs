//! Laws that hold for any two bodies, and numbers at the ends of the floating-point range.

mod extremes_sizes;
mod extremes_values;
#[path = "../../rodwave/tests/hard_to_break/hostile.rs"]
mod hostile;
mod properties_impacts;
mod properties_reconstruction;

use impulse::MobilityLaw;
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic};

/// A free rod: of steel, or of a material with damping.
pub(crate) fn rod(length: f64, diameter: f64, loss_factor: Option<f64>) -> AnalyticChain {
    let circle = Circle::of_diameter(diameter).unwrap();
    let builder = AnalyticChain::analytic_from_impact_face();
    let builder = match loss_factor {
        None => builder.rod(
            &Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap(),
            circle,
            length,
        ),
        Some(loss_factor) => {
            let nylon = ConstantQ::new(2.6e9, loss_factor, 18.8e3).unwrap();
            builder.rod(&Medium::new(1150.0, nylon).unwrap(), circle, length)
        }
    };
    builder.end(Termination::Free).unwrap()
}

pub(crate) fn mass(kilograms: f64) -> MobilityLaw<impl Fn(Complex64) -> Complex64> {
    MobilityLaw::analytic(move |s| 1.0 / (s * kilograms))
        .free(kilograms)
        .unwrap()
}

pub(crate) fn long_rod(impedance: f64) -> MobilityLaw<impl Fn(Complex64) -> Complex64> {
    MobilityLaw::analytic(move |_| Complex64::from(1.0 / impedance))
}
