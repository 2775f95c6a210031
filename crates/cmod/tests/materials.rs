//! Virtual materials, constant and causal or as printed.

use std::f64::consts::TAU;

use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, PowerLawPropagation};
use testbed::papers::paper_a::POLYPROPYLENE;

/// Material of 2.6 GPa and a loss factor of 0.07, as figure 3 of paper A shows.
pub(crate) fn polypropylene(density: f64) -> Medium<ConstantQ> {
    let (modulus, loss_factor, omega) = POLYPROPYLENE;
    let law = ConstantQ::new(modulus, loss_factor, omega).unwrap();
    Medium::new(density, law).unwrap()
}

/// A wave number of 1 to 2 kHz in a polymer: E = 2.6 GPa.
pub(crate) fn flat(density: f64, loss_factor: f64) -> Medium<ConstantQ> {
    let law = ConstantQ::new(2.6e9, loss_factor, TAU * 1e3).unwrap();
    Medium::new(density, law).unwrap()
}

/// Paper E, eq. 7.
pub(crate) fn printed_nylon(fraction: f64) -> PowerLawPropagation {
    PowerLawPropagation::new(fraction * 8.818e-5, 0.894, 8.937e-4, 0.970).unwrap()
}

/// Polyamide 6 by paper E, eq. 7, with `fraction` of its damping coefficient.
pub(crate) fn polyamide(density: f64, fraction: f64) -> Medium<PowerLawPropagation> {
    Medium::new(density, printed_nylon(fraction)).unwrap()
}
