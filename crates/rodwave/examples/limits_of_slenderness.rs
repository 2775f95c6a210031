//! Error of the storage modulus that each theory computes from the wave number of the exact theory,
//! against D/λ.
//!
//! ```text
//! cargo run --release --package rodwave --example limits_of_slenderness
//! ```
//!
//! writes `target/examples/limits_of_slenderness.svg`.
#![allow(
    clippy::print_stdout,
    reason = "an example prints its results to the standard output"
)]

use std::error::Error;
use std::f64::consts::TAU;

use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};
use rodwave::slenderness::{
    LoveRayleigh, MindlinHerrmann, PochhammerChree, RodTheory, RoundRod, Theory,
};

const POISSON_RATIOS: [f64; 3] = [0.30, 0.40, 0.49];

/// Largest D/λ.
const LARGEST_RATIO: f64 = 0.4;

fn main() -> Result<(), Box<dyn Error>> {
    let mut panels = Vec::new();
    for poisson_ratio in POISSON_RATIOS {
        let label = format!("error of E', Poisson's ratio {poisson_ratio:.2}");
        let error = Axis::linear(label, "%").within([-20.0, 2.0]);
        panels.push(Panel::new(("D/λ", ""), error, errors(poisson_ratio)?));
        for wavelength_in_diameters in [10.0, 5.0, 3.0] {
            let left = |theory: Theory| theory.error_left(wavelength_in_diameters, poisson_ratio);
            println!(
                "nu = {poisson_ratio:.2}, lambda = {wavelength_in_diameters:4.1} D: elementary theory {:6.2} %, Love {:6.3} %",
                100.0 * left(Theory::Elementary)?,
                100.0 * left(Theory::LoveRayleigh)?,
            );
        }
    }
    let title = "Storage modulus from a measured wave number: effect of lateral inertia";
    let path = Figure::new("limits_of_slenderness", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("written: {}", path.display());
    Ok(())
}

/// Relative errors of E' in per cent by elementary theory, by Love's theory, and by the theory of
/// Mindlin and Herrmann.
fn errors(poisson_ratio: f64) -> Result<Vec<Mark>, Box<dyn Error>> {
    // At a given wave number, neither density nor modulus affects the error.
    let rod = RoundRod {
        density: 1000.0,
        diameter: 0.010,
        poisson_ratio,
    };
    let omega = 1e5;
    let exact = PochhammerChree::new(rod)?;
    let love = LoveRayleigh::round(rod)?;
    let mindlin_herrmann = MindlinHerrmann::new(rod)?;
    let storage_modulus = |theory: &dyn RodTheory, gamma| -> Result<_, Box<dyn Error>> {
        let corrected = theory.modulus(gamma, omega)?.found();
        Ok(corrected.ok_or("the first branch was lost")?)
    };

    let mut curves = [const { Vec::new() }; 3];
    for step in 1..=80 {
        let ratio = LARGEST_RATIO * f64::from(step) / 80.0;
        let gamma = Complex64::new(0.0, TAU * ratio / rod.diameter);
        let truth = storage_modulus(&exact, gamma)?;
        let found = [
            truth.apparent_modulus,
            storage_modulus(&love, gamma)?.modulus,
            storage_modulus(&mindlin_herrmann, gamma)?.modulus,
        ];
        for (curve, modulus) in curves.iter_mut().zip(found) {
            curve.push((ratio, 100.0 * (modulus.re / truth.modulus.re - 1.0)));
        }
    }
    let looks = [
        ("elementary", Role::Reference),
        ("Love", Role::Second),
        ("Mindlin-Herrmann", Role::First),
    ];
    let curves = curves.into_iter().zip(looks);
    Ok(curves
        .map(|(curve, (name, role))| Mark::line(name, role, curve))
        .collect())
}
