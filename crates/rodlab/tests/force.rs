//! Impact forces from sheets, against closed forms.

use std::path::Path;

use rodlab::RodlabError;
use rodlab::outcome::Outcome;

use crate::runs::{Refused, Words, answered, column, json, outcome_of, quantity};

fn attempt(text: &str) -> Result<Outcome, RodlabError> {
    outcome_of(Path::new(""), text)
}

fn value(outcome: &Outcome, name: &str) -> f64 {
    quantity(outcome, name).value.unwrap()
}

fn error(outcome: &Outcome, name: &str) -> f64 {
    quantity(outcome, name).standard_error.unwrap()
}

/// A mass on a long rod.
fn mass(more: &str) -> Outcome {
    let text = format!(
        r#"Force(title: "mass", problem: Impact(
            first: RigidMass("0.5 kg"), second: Impedance("1000 kg/s"),
            velocity: "2 m/s ± 1 %", duration: "4 ms", {more}))"#
    );
    attempt(&text).unwrap()
}

#[test]
fn a_mass_on_a_long_rod_presses_with_a_falling_exponential() {
    let outcome = mass(r#"time_step: "2 us""#);
    let (mass, impedance, velocity) = (0.5, 1000.0, 2.0);
    let time = column(&outcome, "force", "time");
    let force = column(&outcome, "force", "force");
    let errors = column(&outcome, "force", "standard error of the force");
    for ((t, f), error) in time.iter().zip(force).zip(errors) {
        // tolerance: the error is of second order in Z h/M = 4e-3, where h is the time step: at
        // most 1.6e-5
        let exact = impedance * velocity * (-impedance / mass * t).exp();
        assert!((f / exact - 1.0).abs() < 1.6e-5, "{t}: {f}, exact {exact}");
        // the force is proportional to the velocity; tolerance: the error from 200 draws is known
        // to 5 %
        assert!((error / (0.01 * f) - 1.0).abs() < 0.15, "{t}: {error}");
    }
    // the mass still has a fraction exp(-8) = 3.4e-4 of its momentum
    assert!(
        (value(&outcome, "impulse") / (mass * velocity * (1.0 - (-8.0_f64).exp())) - 1.0).abs()
            < 1e-6
    );
    assert!((error(&outcome, "impulse") / value(&outcome, "impulse") - 0.01).abs() < 0.0015);
    // the faces are still in contact, so that values after the contact are not valid
    let restitution = quantity(&outcome, "coefficient of restitution");
    assert!(!restitution.valid, "{restitution:?}");
    assert_eq!(
        outcome.warnings,
        ["the faces are still in contact at the end"]
    );
}

#[test]
fn lines_do_not_halve_the_error_of_a_jump() {
    let outcome = mass(r#"lines: (up_to: "50 kHz", samples: 4096)"#);
    // the force is proportional to the velocity; the plain transform overshoots a jump by 9 %
    let relative = error(&outcome, "peak force") / value(&outcome, "peak force");
    assert!((0.0085..0.0115).contains(&relative), "{relative}");
    let stick = "peak of the stick force on lines";
    // the peak is interpolated between samples; its error is that of the nearest sample
    assert!((error(&outcome, stick) / value(&outcome, stick) - 0.01).abs() < 1e-4);
}

#[test]
fn equal_rods_exchange_their_velocities() {
    // de Saint-Venant's solution: the force is Z V/2 for one round trip, 2 L/c, and the striker
    // stops
    let outcome = attempt(
        r#"Force(
            title: "equal rods",
            materials: { "steel": (density: "7800 kg/m3", law: Elastic(modulus: "200 GPa")) },
            problem: Impact(
                first: Chain(elements: [Rod(material: "steel", diameter: "16 mm", length: "0.5 m")]),
                second: Chain(elements: [Rod(material: "steel", diameter: "16 mm", length: "0.5 m")]),
                velocity: "3 m/s",
                duration: "0.6 ms",
            ),
        )"#,
    )
    .unwrap();
    let celerity = (200e9_f64 / 7800.0).sqrt();
    let impedance = 7800.0 * celerity * std::f64::consts::PI * 0.016_f64.powi(2) / 4.0;
    let plateau = 0.5 * impedance * 3.0;
    let [time, force] = ["time", "force"].map(|name| column(&outcome, "force", name));
    let during = time.iter().zip(force);
    for (t, f) in during.filter(|(t, _)| **t < 0.99 / celerity) {
        assert!(
            (f / plateau - 1.0).abs() < 1e-6,
            "{t}: {f}, expected {plateau}"
        );
    }
    // tolerances: a jump is spread over one time step of 0.15 µs, and the contact lasts 0.2 ms; in
    // the step of the jump the force is off by a fraction of a per cent
    assert!((value(&outcome, "peak force") / plateau - 1.0).abs() < 1e-2);
    assert!(
        (value(&outcome, "end of the last contact") / (2e3 * 0.5 / celerity * 1.0) - 1.0).abs()
            < 2e-3
    );
    assert!((value(&outcome, "coefficient of restitution") - 1.0).abs() < 2e-3);
    assert!(value(&outcome, "velocity of the first body after").abs() < 6e-3);
    assert!((value(&outcome, "velocity of the second body after") - 3.0).abs() < 6e-3);
    // a warning states that no uncertainty was stated
    outcome.warnings.must_say("No uncertainty of the velocity");
}

/// A cone of constant loss factor on a long rod, as in the tour.
fn cone(duration: &str, more: &str) -> String {
    format!(
        r#"Force(
            title: "cone",
            materials: {{
                "nylon": (density: "1150 kg/m3", law: ConstantQ(modulus: "2.6 GPa", loss_factor: "0.094", at: "3 kHz")),
                "steel": (density: "7780 kg/m3", law: Elastic(modulus: "206 GPa")),
            }},
            problem: Impact(
                first: Chain(elements: [Cone(material: "nylon", near: "75 mm", far: "30 mm", length: "400 mm")]),
                second: LongRod(material: "steel", diameter: "10 mm"),
                velocity: "0.93 m/s ± 1 %", duration: "{duration}", {more}
            ),
        )"#
    )
}

#[test]
fn r07_the_peak_is_one_number_whatever_the_step_and_the_record() {
    let draws = "uncertainty: (draws: 20)";
    let reference = attempt(&cone("1 ms", draws)).unwrap();
    let peak = value(&reference, "peak force in the band");
    let numerical = "numerical error of the peak force in the band";
    for (duration, step) in [
        ("0.25 ms", ""),
        ("4 ms", ""),
        ("1 ms", r#"time_step: "3 us","#),
    ] {
        let outcome = attempt(&cone(duration, &format!("{step} {draws}"))).unwrap();
        let away = (value(&outcome, "peak force in the band") - peak).abs();
        let allowed = value(&outcome, numerical) + value(&reference, numerical);
        assert!(away <= allowed, "{duration} {step}: {away}, {allowed}");
        assert!(allowed < 3e-3 * peak, "{allowed}");
        // the quantity `peak force` does not depend on the step either
        let plain = value(&outcome, "peak force");
        assert!((plain - peak).abs() <= allowed, "{plain} {peak}");
    }
    let wide = attempt(&cone("1 ms", &format!(r#"band: "40 kHz", {draws}"#))).unwrap();
    assert!(value(&wide, "peak force in the band") > 1.01 * peak);
}

#[test]
fn r06_the_error_is_that_of_the_curve_and_follows_every_stated_uncertainty() {
    let sheet = |modulus: &str, length: &str, contact: &str| {
        format!(
            r#"Force(
                title: "two rods",
                materials: {{ "steel": (density: "7800 kg/m3", law: Elastic(modulus: "200 GPa{modulus}")) }},
                problem: Impact(
                    first: Chain(elements: [Rod(material: "steel", diameter: "16 mm", length: "0.5 m{length}")]),
                    second: LongRod(material: "steel", diameter: "16 mm"),
                    velocity: "3 m/s ± 0.1 %", duration: "0.6 ms", {contact}
                ),
            )"#
        )
    };
    let relative = |outcome: &Outcome, name: &str| error(outcome, name) / value(outcome, name);
    let exact = attempt(&sheet("", "", "")).unwrap();
    assert!((relative(&exact, "peak force in the band") / 1e-3 - 1.0).abs() < 0.2);
    // Z grows with the root of the modulus, and the impulse with the length of the pulse
    let soft = attempt(&sheet(" ± 4 %", "", "")).unwrap();
    assert!((relative(&soft, "peak force in the band") / 0.02 - 1.0).abs() < 0.2);
    let long = attempt(&sheet("", " ± 2 %", "")).unwrap();
    assert!((relative(&long, "impulse") / 0.02 - 1.0).abs() < 0.2);
    assert!(relative(&long, "peak force in the band") < 2e-3);
    // with a contact spring, too, the uncertainty of the modulus has an effect
    let spring = r#"contact: Linear("200 MN/m")"#;
    let stiff = attempt(&sheet("", "", spring)).unwrap();
    let through = attempt(&sheet(" ± 4 %", "", spring)).unwrap();
    assert!(
        relative(&through, "peak force in the band")
            > 5.0 * relative(&stiff, "peak force in the band")
    );
    // without any stated uncertainty no quantity has an error
    let none = sheet("", "", "").replace(" ± 0.1 %", "");
    let none = attempt(&none).unwrap();
    assert!(none.quantities.iter().all(|q| q.standard_error.is_none()));
}

#[test]
fn the_same_sheet_gives_the_same_bytes() {
    let text = rodlab::templates::JobName::Force.template(rodlab::sheet::Language::Ron);
    let [once, again] = [0, 1].map(|_| attempt(text));
    assert_eq!(json(&answered(once)), json(&again.unwrap()));
}

#[test]
fn what_cannot_be_is_refused_where_it_stands() {
    let with = |first: &str, velocity: &str| {
        let text = format!(
            r#"Force(title: "x", materials: {{ "steel": (density: "7800 kg/m3", law: Elastic(modulus: "200 GPa")) }},
            problem: Impact(first: {first}, second: Impedance("1000 kg/s"), velocity: {velocity}, duration: "1 ms"))"#
        );
        attempt(&text).refused()
    };
    let rod = |material: &str, diameter: &str| {
        format!(
            r#"Chain(elements: [Mass("10 gram"), Rod(material: "{material}", diameter: "{diameter}", length: "1 m")])"#
        )
    };
    let refusals = [
        with(&rod("stel", "16 mm"), r#""1 m/s""#),
        with(&rod("steel", "16 kg"), r#""1 m/s""#),
        with(&rod("steel", "16 mm"), r#""0 m/s""#),
        with(&rod("steel", "16 mm"), "1"),
        with("RigidMass(\"-1 kg\")", r#""1 m/s""#),
        with("Sphere", r#""1 m/s""#),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r#"
    problem.first.elements[1].material is `stel`, expected one of the materials `steel`
    test.ron:2:103: Force.problem.Impact.first.Chain.elements[1].Rod.diameter: `16 kg` has the dimension of a mass (kg), expected a length, such as "800 mm", with or without ±
    test.ron:2:172: Force.problem.Impact.velocity: `0 m/s` is not above 0, expected a velocity, such as "0.93 m/s", with or without ±
    test.ron:2:172: Force.problem.Impact.velocity: found the number `1`, expected a velocity with its unit in quotes, such as "0.93 m/s"
    test.ron:2:46: Force.problem.Impact.first.RigidMass: `-1 kg` is not above 0, expected a mass, such as "1.5 kg" or "2.9 gram", with or without ±
    test.ron:2:36: Force.problem.Impact.first: found `Sphere`, expected one of `Chain`, `RigidMass`, `LongRod`, `Impedance`, `Measured`, `Assembly`
    "#);
}

/// A wave of 6 kHz in a polymer rod is 0.24 m long, 2.4 diameters of one rod and twelve diameters
/// of the other.
#[test]
fn waves_too_short_for_a_rod_are_named() {
    let warnings = |diameter: &str| {
        let outcome = attempt(&format!(
            r#"Force(title: "thick", problem: Impact(
                first: RigidMass("0.5 kg"),
                second: LongRod(material: "pmma", diameter: "{diameter}"),
                velocity: "2 m/s",
                duration: "2 ms",
                band: "6 kHz",
            ), materials: {{"pmma": (density: "1190 kg/m3", law: Elastic(modulus: "2.5 GPa"))}})"#
        ))
        .unwrap();
        let of_rod = |warning: &&String| warning.contains("lateral inertia");
        outcome.warnings.iter().find(of_rod).cloned()
    };
    let found = warnings("100 mm").unwrap();
    found.must_say_all(&["problem.second", "2.4 diameters"]);
    assert_eq!(warnings("20 mm"), None);
}
