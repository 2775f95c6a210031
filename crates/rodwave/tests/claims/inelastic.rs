//! Inelastic laws in cases whose flow has a closed form.

use rodwave::inelastic::{InelasticLaw, RelaxationFlow};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

const MODULUS: f64 = 2.5e9;
const STRESSES: [f64; 7] = [1e2, -4e4, 1e6, -5e6, 1.2e7, 3e7, -6e7];

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    // √σ falls in proportion to time: at twice the initial time constant, the stress is zero
    let half = MaxwellNorton::from_reference_rate(0.5, 4.0, 10e6).unwrap();
    let extinct = 2.0 * 10e6 / (MODULUS * 4.0);
    let left = |part: f64| half.flow(MODULUS, part * extinct).relax(10e6) / 10e6;
    report
        .by("closed form: (1 - t/t_e)², t_e = 2σ₀^(1/2) B/E")
        .deviation(
            "Norton, κ = 1/2: stress left at half the time of extinction, at that time and long after",
            Within(3e-15, "rounding"),
            Ok(largest([left(0.5) - 0.25, left(1.0), left(50.0)])),
        );
    let norton = MaxwellNorton::from_reference_rate(1.0, 4.0, 10e6).unwrap();
    let gurevich = MaxwellGurevichRabinovich::from_reference_rate(0.0, 4.0, 10e6).unwrap();
    let maxwell = Maxwell::from_reference_rate(4.0, 10e6).unwrap();
    let decay = (-MODULUS * 1e-4 * 4.0 / 10e6).exp();
    let errors = STRESSES.into_iter().flat_map(|stress| {
        [
            maxwell.flow(MODULUS, 1e-4).relax(stress),
            norton.flow(MODULUS, 1e-4).relax(stress),
            gurevich.flow(MODULUS, 1e-4).relax(stress),
        ]
        .map(|relaxed| relaxed / (stress * decay) - 1.0)
    });
    report.by("paper D, Table 1, model 1").deviation(
        "Maxwell, Norton with κ = 1, Gurevich and Rabinovich with 1/m = 0: e^(-Eh/η)",
        Within(1e-15, "rounding"),
        Ok(largest(errors)),
    );
    let norton = MaxwellNorton::new(2.108, 38.16e18).unwrap();
    let gurevich = MaxwellGurevichRabinovich::new(314.6e9, 7.082e12).unwrap();
    report.by("paper D, Table 4").deviation(
        "printed parameters of Table 4 are returned as they were given",
        Within(4e-15, "rounding of a power of 1e7"),
        Ok(largest([
            norton.coefficient() / 38.16e18 - 1.0,
            gurevich.viscosity() / 314.6e9 - 1.0,
            gurevich.activation_stress() / 7.082e12 - 1.0,
            Maxwell::new(40.85e9).unwrap().viscosity() / 40.85e9 - 1.0,
        ])),
    );
    hold!(report);
}
