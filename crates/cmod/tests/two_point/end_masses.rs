//! Masses of the two accelerometers, of which only the mass on the free end has an effect.

use std::f64::consts::TAU;

use cmod::estimate::Termination;
use cmod::validity::AcceptanceLimits;
use cmod::{Specimen, TwoPoint};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use super::rod::{SPECIMEN, acceleration_ratio};
use crate::materials;

fn polypropylene() -> Medium<ConstantQ> {
    materials::polypropylene(SPECIMEN.density)
}

fn frequencies() -> Vec<f64> {
    (1..=400).map(|j| 50.0 * f64::from(j)).collect()
}

/// Both accelerometers of paper A, figure 1, with unequal masses: no mass, the same mass, and
/// twenty times the mass at the struck end give the modulus of the material. Without a mass at the
/// free end the solution is the closed form, without iteration.
#[test]
fn the_mass_on_the_impacted_end_does_not_matter() {
    let frequency_hz = frequencies();
    for (impacted_mass, accelerometer_mass) in [
        (0.0, 2.9e-3),
        (2.9e-3, 2.9e-3),
        (58e-3, 2.9e-3),
        (2.9e-3, 0.0),
    ] {
        let specimen = Specimen {
            accelerometer_mass,
            ..SPECIMEN
        };
        let ratio = acceleration_ratio(&polypropylene(), &specimen, impacted_mass, &frequency_hz);
        let estimate = TwoPoint::new(specimen)
            .unwrap()
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)
            .unwrap()
            .estimate(&frequency_hz, &ratio, &[0.0; 400])
            .unwrap();
        assert!(estimate.valid().count() > 350);
        for line in estimate.lines() {
            let exact = polypropylene().modulus(TAU * line.frequency_hz);
            let error = (line.modulus - exact).norm() / exact.norm();
            // tolerance: rounding errors of Ψ, 1e-14 because of the mass at the struck end, are
            // amplified
            let tolerance = 1e-13 * (1.0 + line.error_amplification);
            assert!(error < tolerance, "{} Hz: {error:e}", line.frequency_hz);
            let is_closed = line.termination == Termination::ClosedForm;
            assert_eq!(is_closed, accelerometer_mass == 0.0);
        }
    }
}
