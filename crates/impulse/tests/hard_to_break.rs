//! Properties that are valid for any two bodies, and arguments at the ends of the floating-point
//! range.

mod extremes_sizes;
mod extremes_values;
#[path = "../../rodwave/tests/hard_to_break/hostile.rs"]
mod hostile;
mod properties_impacts;
mod properties_reconstruction;

use rodwave::chain::{AnalyticChain, Termination};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use crate::bodies::circle;

/// A free rod with damping.
pub(crate) fn lossy_rod(diameter: f64, length: f64, loss_factor: f64) -> AnalyticChain {
    let nylon = ConstantQ::new(2.6e9, loss_factor, 18.8e3).unwrap();
    AnalyticChain::analytic_from_impact_face()
        .rod(
            &Medium::new(1150.0, nylon).unwrap(),
            circle(diameter),
            length,
        )
        .end(Termination::Free)
        .unwrap()
}
