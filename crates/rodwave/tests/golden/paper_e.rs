//! Bodies of paper E, built from the printed numbers.

use num_complex::Complex64;
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, PowerLawPropagation};
use rodwave::{Chain, Termination};

use super::table::GoldenTable;
use crate::reference_mpmath::errors_of_chains;

pub(crate) struct Bodies {
    pub(crate) nylon: Medium<PowerLawPropagation>,
    pub(crate) cone: Chain,
    pub(crate) cylinder: Chain,
    pub(crate) long_rod: Chain,
}

pub(crate) fn bodies() -> Bodies {
    let constants = GoldenTable::read("paper_e_constants.ron");
    let value = |name| constants.constant(name).value;
    let law = PowerLawPropagation::new(
        value("nylon_alpha_coefficient"),
        value("nylon_alpha_exponent"),
        value("nylon_k_coefficient"),
        value("nylon_k_exponent"),
    )
    .unwrap();
    let nylon = Medium::new(value("nylon_density"), law).unwrap();
    let elastic = |modulus, density| {
        Medium::new(value(density), Elastic::new(value(modulus)).unwrap()).unwrap()
    };
    let aluminium = elastic("aluminium_modulus", "aluminium_density");
    let steel = elastic("steel_modulus", "steel_density");
    let circle = |name| Circle::of_diameter(value(name)).unwrap();
    let face = circle("cylinder_diameter");
    let length = value("cylinder_section_length");
    assert!((value("cylinder_sections") - 4.0).abs() < 1e-12);
    Bodies {
        cone: Chain::from_impact_face()
            .cone(
                &nylon,
                circle("cone_diameter_a"),
                circle("cone_diameter_b"),
                value("cone_length"),
            )
            .end(Termination::Free)
            .unwrap(),
        cylinder: Chain::from_impact_face()
            .rod(&nylon, face, length)
            .rod(&aluminium, face, length)
            .rod(&nylon, face, length)
            .rod(&aluminium, face, length)
            .end(Termination::Free)
            .unwrap(),
        long_rod: Chain::from_impact_face()
            .end(Termination::semi_infinite(&steel, circle("rod_diameter")))
            .unwrap(),
        nylon,
    }
}

/// Checks that the printed numbers, read from the fixtures by this test and typed into the program
/// that made the reference, give the same mobilities (Ödeen 1993, paper E, eqs. A5 and A11).
#[test]
fn printed_bodies_have_the_mobilities_of_mpmath() {
    let [chains, medium] = errors_of_chains(&bodies());
    // tolerances as in reference_mpmath.rs
    assert!(chains < 2e-14 && medium < 4e-15, "{chains:e} {medium:e}");
}

/// Checks that the long rod is long enough: its echo has not returned to the gauges while the
/// impacts last, about 1 ms.
#[test]
fn no_reflected_wave_during_the_time_interval_of_interest() {
    let constants = GoldenTable::read("paper_e_constants.ron");
    let value = |name| constants.constant(name).value;
    let speed = (value("steel_modulus") / value("steel_density")).sqrt();
    let echo = 2.0 * (value("rod_length") - value("strain_gauge_distance")) / speed;
    assert!((2.2e-3..2.4e-3).contains(&echo), "{echo}");
    // the period of the predicted impulse responses, 2048 samples up to 10 kHz, also contains the
    // ringing of the bodies
    let step_hz = value("predicted_frequency_highest") / value("predicted_samples");
    assert!(step_hz.recip() > 50.0 * echo);
}

/// Checks the impulse of each case. A free body gives all its momentum to a semi-infinite rod: the
/// impulse is V M, where M follows from the mobility of the printed body at low frequency. For TCB,
/// the sum of a separately computed force history is 0.983 N s.
#[test]
fn momentum_of_the_four_cases() {
    let cases = GoldenTable::read("paper_e_cases.ron");
    let bodies = bodies();
    let omega = 1e-2;
    let mut momenta = Vec::new();
    for (case, mobility, body) in [
        ("TCA", bodies.cone.mobility(omega), &bodies.cone),
        ("TCB", bodies.cone.far_face_mobility(omega), &bodies.cone),
        ("CCA", bodies.cylinder.mobility(omega), &bodies.cylinder),
        (
            "CCB",
            bodies.cylinder.far_face_mobility(omega),
            &bodies.cylinder,
        ),
    ] {
        let mass = body.free_mass().unwrap();
        // G iω M = 1 + O((γL)²), where γL is 3e-6 at this frequency, and rounding
        let unity = mobility.unwrap() * Complex64::new(0.0, omega * mass);
        assert!((unity - 1.0).norm() < 1e-10, "{case}: {unity}");
        momenta.push(mass * cases.row(case).value("impact_velocity"));
    }
    // tolerance: half a unit of the last digit
    assert!((momenta[1] - 0.983).abs() < 5e-4, "{momenta:?}");
    // two sections of nylon and two of aluminium
    let cylinder = momenta[2] / cases.row("CCA").value("impact_velocity");
    let section = std::f64::consts::FRAC_PI_4 * 0.032_f64.powi(2) * 0.125;
    assert!((cylinder / (2.0 * section * (1150.0 + 2700.0)) - 1.0).abs() < 1e-12);
}
