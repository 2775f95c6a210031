//! Materials and bodies of sheets against closed forms: each law as a long rod, each element at low
//! frequency.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use num_complex::Complex64;
use rodlab::Outcome;

use crate::runs::{Refused, column, outcome_of};

const DENSITY: f64 = 1150.0;
const DIAMETER: f64 = 0.02;

fn computed(law: &str, body: &str) -> Outcome {
    let text = format!(
        r#"Mobility(title: "computed", materials: {{ "it": (density: "1150 kg/m3", law: {law}, unusual: true) }},
        source: Computed(body: {body}, up_to: "10 kHz", lines: 100))"#
    );
    outcome_of(Path::new("."), &text).unwrap()
}

fn lines(outcome: &Outcome) -> Vec<(f64, Complex64)> {
    let parts = column(outcome, "mobility", "real part").iter();
    parts
        .zip(column(outcome, "mobility", "imaginary part"))
        .zip(column(outcome, "mobility", "frequency"))
        .skip(1)
        .map(|((re, im), f)| (*f, Complex64::new(*re, *im)))
        .collect()
}

#[test]
fn a_long_rod_of_each_law_has_its_characteristic_impedance() {
    let area = PI * DIAMETER * DIAMETER / 4.0;
    let power = |s: Complex64, exponent: f64| (s.ln() * exponent).exp();
    type Law = Box<dyn Fn(Complex64) -> Complex64>;
    let relaxed = |s: Complex64, tau: f64| s * tau / (1.0 + s * tau);
    let laws: Vec<(&str, Law)> = vec![
        (
            r#"Elastic(modulus: "3 GPa")"#,
            Box::new(|_| Complex64::from(3e9)),
        ),
        (
            r#"ConstantQ(modulus: "3 GPa", loss_factor: "0.1", at: "2 kHz")"#,
            // E* = 3 GPa (s/w0)^(2 atan(0.1)/pi): |E*| is 3 GPa at 2 kHz, and Im/Re = 0.1 at every
            // frequency
            Box::new(move |s| 3e9 * power(s / (TAU * 2e3), 2.0 * 0.1_f64.atan() / PI)),
        ),
        (
            r#"KelvinVoigt(modulus: "3 GPa", viscosity: "20 kPa s")"#,
            Box::new(|s| 3e9 + 20e3 * s),
        ),
        (
            r#"Maxwell(modulus: "3 GPa", viscosity: "2 MPa s")"#,
            Box::new(move |s| 3e9 * relaxed(s, 2e6 / 3e9)),
        ),
        (
            r#"Zener(relaxed: "3 GPa", unrelaxed: "3.6 GPa", relaxation_time: "30 us")"#,
            Box::new(move |s| 3e9 + 0.6e9 * relaxed(s, 30e-6)),
        ),
        (
            r#"FractionalZener(relaxed: "3 GPa", unrelaxed: "3.6 GPa", relaxation_time: "30 us", exponent: "0.4")"#,
            Box::new(move |s| 3e9 + 0.6e9 * relaxed(power(s * 30e-6, 0.4), 1.0)),
        ),
        (
            r#"Prony(equilibrium: "3 GPa", branches: [(modulus: "0.2 GPa", relaxation_time: "20 us"), (modulus: "0.1 GPa", relaxation_time: "1 ms")])"#,
            Box::new(move |s| 3e9 + 0.2e9 * relaxed(s, 20e-6) + 0.1e9 * relaxed(s, 1e-3)),
        ),
        (
            "PowerLawPropagation(damping_factor: 8.818e-5, damping_exponent: 0.894, wave_number_factor: 8.937e-4, wave_number_exponent: 0.970)",
            // E* = rho s^2/gamma^2, gamma = a omega^p + i b omega^q
            Box::new(|s| {
                let omega = s.im;
                let gamma =
                    Complex64::new(8.818e-5 * omega.powf(0.894), 8.937e-4 * omega.powf(0.970));
                DENSITY * s * s / (gamma * gamma)
            }),
        ),
    ];
    for (law, modulus) in &laws {
        let outcome = computed(law, r#"LongRod(material: "it", diameter: "20 mm")"#);
        for (f, found) in lines(&outcome) {
            let exact = 1.0 / (area * (DENSITY * modulus(Complex64::new(0.0, TAU * f))).sqrt());
            assert!(
                (found / exact - 1.0).norm() < 1e-12,
                "{law} at {f} Hz: {found}, exact {exact}"
            );
            // the body absorbs energy: the real part is positive
            assert!(found.re > 0.0);
        }
    }
}

#[test]
fn every_element_has_its_mass_at_low_frequency() {
    let law = r#"Elastic(modulus: "3000 GPa")"#;
    let rod = DENSITY * PI * DIAMETER * DIAMETER / 4.0 * 0.1;
    // end areas of a horn A(x) = A0 (A1/A0)^(x/L)
    let (near, far) = (PI * 0.03_f64.powi(2) / 4.0, PI * 0.01_f64.powi(2) / 4.0);
    let cone = DENSITY * PI / 12.0 * 0.1 * (9e-4 + 3e-4 + 1e-4);
    let horn = DENSITY * 0.1 * (near - far) / (near / far).ln();
    for (elements, mass) in [
        (
            r#"Rod(material: "it", diameter: "20 mm", length: "100 mm")"#,
            rod,
        ),
        (
            r#"Cone(material: "it", near: "30 mm", far: "10 mm", length: "100 mm")"#,
            cone,
        ),
        (
            r#"Horn(material: "it", near: "30 mm", far: "10 mm", length: "100 mm")"#,
            horn,
        ),
        (
            r#"Mass("20 gram"), Rod(material: "it", diameter: "20 mm", length: "100 mm")"#,
            0.02 + rod,
        ),
    ] {
        let outcome = computed(law, &format!("Chain(elements: [{elements}])"));
        let (f, found) = lines(&outcome)[0];
        let exact = 1.0 / Complex64::new(0.0, TAU * f * mass);
        // for c = 51 km/s the elastic term is (omega L/c)^2/3 = 5e-7 at 100 Hz, two or three times
        // as much if the section varies
        assert!(
            (found / exact - 1.0).norm() < 3e-6,
            "{elements}: {found}, {exact}"
        );
    }
    // a spring and a dashpot in series before a wall: their mobilities i omega/k and 1/c add
    let outcome = computed(
        law,
        r#"Chain(elements: [Spring("2 MN/m"), Dashpot("300 kg/s")], end: Fixed)"#,
    );
    for (f, found) in lines(&outcome) {
        let exact = Complex64::new(0.0, TAU * f) / 2e6 + 1.0 / 300.0;
        assert!((found / exact - 1.0).norm() < 1e-12);
    }
    // a chain that ends with a dashpot or with a mass
    for (end, impedance) in [
        (
            r#"Dashpot("300 kg/s")"#,
            Box::new(|_| Complex64::from(300.0)) as Box<dyn Fn(Complex64) -> Complex64>,
        ),
        (r#"Mass("0.4 kg")"#, Box::new(|s| 0.4 * s)),
    ] {
        let outcome = computed(
            law,
            &format!(r#"Chain(elements: [Spring("2 MN/m")], end: {end})"#),
        );
        for (f, found) in lines(&outcome) {
            let s = Complex64::new(0.0, TAU * f);
            let exact = s / 2e6 + 1.0 / impedance(s);
            assert!((found / exact - 1.0).norm() < 1e-12);
        }
    }
}

/// Two pieces of a rod with a sleeve between them and a spring and a dashpot at the end, joined in
/// an arbitrary order: the impedance is that of the members in series.
#[test]
fn an_assembly_has_the_impedances_of_its_members_in_a_row() {
    let outcome = computed(
        r#"Zener(relaxed: "3 GPa", unrelaxed: "3.6 GPa", relaxation_time: "30 us")"#,
        r#"Assembly(face: "rod", members: [
            (name: "tail", body: Chain(elements: [Rod(material: "it", diameter: "20 mm", length: "250 mm")])),
            (name: "sleeve", body: RigidMass("120 gram")),
            (name: "rod", body: Chain(elements: [Rod(material: "it", diameter: "20 mm", length: "400 mm")])),
        ], joints: [
            (between: ("tail, end", "ground"), stiffness: "5 MN/m", resistance: "300 kg/s"),
            (between: ("sleeve", "rod, end")),
            (between: ("tail", "sleeve"), stiffness: "20 MN/m"),
        ])"#,
    );
    let area = PI * DIAMETER * DIAMETER / 4.0;
    for (f, found) in lines(&outcome) {
        let s = Complex64::new(0.0, TAU * f);
        let modulus = 3e9 + 0.6e9 * (s * 30e-6) / (1.0 + s * 30e-6);
        let characteristic = area * (modulus * DENSITY).sqrt();
        let gamma = s * (DENSITY / modulus).sqrt();
        // impedance of a rod that is terminated by the impedance `end`
        let along = |length: f64, end: Complex64| {
            let tanh = (gamma * length).tanh();
            characteristic * (end + characteristic * tanh) / (characteristic + end * tanh)
        };
        let tail = along(0.25, 5e6 / s + 300.0);
        let behind = 0.12 * s + 1.0 / (1.0 / tail + s / 20e6);
        let exact = 1.0 / along(0.4, behind);
        assert!(
            (found / exact - 1.0).norm() < 1e-9,
            "{f} Hz: {found}, exact {exact}"
        );
    }
}

#[test]
fn what_is_wrong_with_an_assembly_is_said_at_its_place() {
    let refused = |face: &str, joints: &str, rest: &str| {
        let text = format!(
            r#"Mobility(title: "computed", materials: {}, source: Computed(up_to: "10 kHz", lines: 100,
            body: Assembly(face: "{face}", members: [(name: "rod", body: RigidMass("1 kg")), (name: "bit", body: RigidMass("2 kg")){rest}],
            joints: [{joints}])))"#,
            "{}"
        );
        outcome_of(Path::new("."), &text).refused()
    };
    let joined = r#"(between: ("rod", "bit"), stiffness: "1 MN/m")"#;
    for (face, joints, rest, expected) in [
        (
            "rot",
            joined,
            "",
            r#"body.face is "rot", expected one of "rod", "bit""#,
        ),
        (
            "rod, end",
            joined,
            "",
            r#"body.face is "end", expected one of "face""#,
        ),
        (
            "rod",
            "",
            "",
            r#"body.joints is no joint that leads from "rod" to "bit""#,
        ),
        (
            "rod",
            r#"(between: ("rod", "bit"), stiffness: "0 N/m")"#,
            "",
            "stiffness",
        ),
        (
            "rod",
            joined,
            r#", (name: "bit", body: RigidMass("1 kg"))"#,
            "members[2]",
        ),
        (
            "rod",
            joined,
            r#", (name: "ground", body: RigidMass("1 kg"))"#,
            "members[2]",
        ),
        (
            "rod",
            joined,
            r#", (name: "empty")"#,
            "both or neither of `body` and `measured`",
        ),
    ] {
        let found = refused(face, joints, rest);
        assert!(found.contains(expected), "{found}, expected {expected}");
    }
}
