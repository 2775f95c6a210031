//! Virtual materials: constant and causal, or as printed in the papers.

use std::f64::consts::TAU;

use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, PowerLawPropagation};
use testbed::papers::paper_a::POLYPROPYLENE;

/// Returns a material of 2.6 GPa and a loss factor of 0.07, as in figure 3 of paper A.
pub(crate) fn polypropylene(density: f64) -> Medium<ConstantQ> {
    let (modulus, loss_factor, omega) = POLYPROPYLENE;
    let law = ConstantQ::new(modulus, loss_factor, omega).unwrap();
    Medium::new(density, law).unwrap()
}

/// Returns a material with E = 2.6 GPa at 1 kHz, as of a polymer, and a constant loss factor.
pub(crate) fn flat(density: f64, loss_factor: f64) -> Medium<ConstantQ> {
    let law = ConstantQ::new(2.6e9, loss_factor, TAU * 1e3).unwrap();
    Medium::new(density, law).unwrap()
}

/// Returns the power laws of polyamide (paper E, eq. 7).
pub(crate) fn printed_nylon(fraction: f64) -> PowerLawPropagation {
    PowerLawPropagation::new(fraction * 8.818e-5, 0.894, 8.937e-4, 0.970).unwrap()
}

/// Returns polyamide 6 according to paper E, eq. 7, with `fraction` of its damping coefficient.
pub(crate) fn polyamide(density: f64, fraction: f64) -> Medium<PowerLawPropagation> {
    Medium::new(density, printed_nylon(fraction)).unwrap()
}
