//! Tests of one rod at several temperatures.

use super::*;
use crate::runs::{Folder, Words};

/// Two tests at 20 and 45 degC of a rod whose rate grows with the temperature: the activation
/// energy is found, and without it a warning states the difference of the temperatures.
#[test]
fn an_activation_energy_is_found_from_two_temperatures() {
    let folder = Folder::new();
    let (kappa, rate, energy) = (1.8, 6.0, 80e3);
    let faster = (-energy / 8.314_462_618 * (1.0 / 318.15 - 1.0 / 293.15_f64)).exp();
    let files = [
        ("slow.csv", 3.0, 1.0, "20 degC", 1),
        ("fast.csv", 24.0, 1.0, "20 degC", 2),
        ("warm.csv", 10.0, faster, "45 degC", 3),
    ];
    let tests = files.map(|(file, velocity, factor, temperature, seed)| {
        let law = MaxwellNorton::from_reference_rate(kappa, factor * rate, 10e6).unwrap();
        let path = folder.file(file);
        velocities(&law, velocity).write(&path, 5e-3 * velocity, seed, "m/s", 1.0);
        let own = format!(r#"to: "2.5 ms", temperature: "{temperature}","#);
        test_entry(file, &format!("{velocity} m/s"), &own)
    });
    let norton = format!("laws: [Norton], compare: false, profiles: false, {QUICK}");
    let activated = format!(r#"arrhenius: (reference: "20 degC"), {norton}"#);
    let outcome = folder.run(&sheet(&tests, &activated)).unwrap();
    for (name, truth) in [
        ("Maxwell-Norton: exponent kappa", kappa),
        (
            "Maxwell-Norton: inelastic strain rate at 10 MPa F(10 MPa)",
            rate,
        ),
        ("Maxwell-Norton: activation energy Q", energy),
    ] {
        assert!(is_found(&outcome, name, truth, [3.0, 0.1]).valid);
    }
    assert!(
        outcome.summary.join(" ").contains(" kJ/mol ± "),
        "{:?}",
        outcome.summary
    );
    let without = folder.run(&sheet(&tests, &norton)).unwrap();
    let warned = without.warnings.join(" ");
    warned.must_say("temperatures of the tests differ by 25 K");
    let untold = tests
        .clone()
        .map(|test| test.replace(r#"temperature: "45 degC","#, ""));
    let refusal = refused(&folder, &sheet(&untold, &activated));
    refusal.must_say("tests[2].temperature is absent");
    let refusal = refused(&folder, &sheet(&tests[..2], &activated));
    refusal.must_say("temperatures within 0.0 K");
}
