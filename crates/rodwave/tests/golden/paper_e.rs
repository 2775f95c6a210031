//! Bodies of paper E, built from the printed numbers.

use num_complex::Complex64;
use rodwave::medium::Medium;
use rodwave::modulus::PowerLawPropagation;
use rodwave::{Chain, Termination};
use testbed::papers::paper_e::bodies::Face;
use testbed::papers::paper_e::{self, PaperE};

use crate::reference_mpmath::errors_of_chains;

pub(crate) struct Bodies {
    pub(crate) nylon: Medium<PowerLawPropagation>,
    pub(crate) cone: Chain,
    pub(crate) cylinder: Chain,
    pub(crate) long_rod: Chain,
}

pub(crate) fn bodies() -> Bodies {
    let paper = paper_e::load().unwrap();
    let rod = PaperE::circle(paper.rod_diameter).unwrap();
    Bodies {
        cone: paper.printed(Face::ConeA).unwrap(),
        cylinder: paper.printed(Face::CylinderA).unwrap(),
        long_rod: Chain::from_impact_face()
            .end(Termination::semi_infinite(&paper.steel().unwrap(), rod))
            .unwrap(),
        nylon: paper.printed_nylon().unwrap(),
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
    let paper = paper_e::load().unwrap();
    let speed = (paper.steel_modulus / paper.steel_density).sqrt();
    let echo = 2.0 * (paper.rod_length - paper.gauge_distance) / speed;
    assert!((2.2e-3..2.4e-3).contains(&echo), "{echo}");
    // the period of the predicted impulse responses, 2048 samples up to 10 kHz, also contains the
    // ringing of the bodies
    let step_hz = paper.predicted_highest_hz / paper.predicted_samples;
    assert!(step_hz.recip() > 50.0 * echo);
}

/// Checks the impulse of each case. A free body gives all its momentum to a semi-infinite rod: the
/// impulse is V M, where M follows from the mobility of the printed body at low frequency. For TCB,
/// the sum of a separately computed force history is 0.983 N s.
#[test]
fn momentum_of_the_four_cases() {
    let paper = paper_e::load().unwrap();
    let bodies = bodies();
    let omega = 1e-2;
    let mut momenta = Vec::new();
    let (cone, cylinder) = (&bodies.cone, &bodies.cylinder);
    for (face, mobility, body) in [
        (Face::ConeA, cone.mobility(omega), cone),
        (Face::ConeB, cone.far_face_mobility(omega), cone),
        (Face::CylinderA, cylinder.mobility(omega), cylinder),
        (Face::CylinderB, cylinder.far_face_mobility(omega), cylinder),
    ] {
        let mass = body.free_mass().unwrap();
        // G iω M = 1 + O((γL)²), where γL is 3e-6 at this frequency, and rounding
        let unity = mobility.unwrap() * Complex64::new(0.0, omega * mass);
        assert!((unity - 1.0).norm() < 1e-10, "{face:?}: {unity}");
        momenta.push(mass * paper.case(face).unwrap().impact_velocity);
    }
    // tolerance: half a unit of the last digit
    assert!((momenta[1] - 0.983).abs() < 5e-4, "{momenta:?}");
    // two sections of nylon and two of aluminium
    let section = std::f64::consts::FRAC_PI_4 * 0.032_f64.powi(2) * 0.125;
    let mass = cylinder.free_mass().unwrap();
    assert!((mass / (2.0 * section * (1150.0 + 2700.0)) - 1.0).abs() < 1e-12);
}
