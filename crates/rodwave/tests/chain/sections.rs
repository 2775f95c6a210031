//! Interior of a chain: transfer functions, reciprocity, and the waves at several sections.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::chain::AnalyticChain;
use rodwave::element::Segment;
use rodwave::transition::{State, TransitionMatrix};
use rodwave::waves::TravellingWaves;
use rodwave::{Chain, RodwaveError, Termination};
use testbed::difference::relative;

use crate::bodies::{aluminium, circle, nylon};

fn body() -> Chain {
    Chain::from_impact_face()
        .rod(&nylon(), circle(0.030), 0.2)
        .mass(0.02)
        .cone(&aluminium(), circle(0.030), circle(0.050), 0.15)
        .spring(5e7)
        .horn(&nylon(), circle(0.050), circle(0.020), 0.1)
        .end(Termination::Dashpot(300.0))
        .unwrap()
}

/// Compares the state at a section with that of the impact face, transferred by the matrices of the
/// elements between the two (Ödeen 1993, paper E, eq. A8).
#[test]
fn states_follow_from_the_impact_face() {
    let chain = body();
    for frequency_hz in [1.0, 300.0, 2000.0, 9000.0] {
        let omega = TAU * frequency_hz;
        let mut state = State {
            normal_force: Complex64::new(-1.0, 0.0),
            velocity: chain.mobility(omega).unwrap(),
        };
        let check = |element: usize, distance: f64, expected: State| {
            let found = chain
                .section(element, distance)
                .unwrap()
                .state(omega)
                .unwrap();
            // tolerance: along +x, the rounding errors of the matrices grow with e^{2αL}, αL < 1
            let what = format!("element {element} at {distance} m, {frequency_hz} Hz");
            assert!(
                relative(found.normal_force, expected.normal_force) < 1e-11,
                "{what}"
            );
            assert!(
                relative(found.velocity, expected.velocity) < 1e-11,
                "{what}"
            );
        };
        let rod = Segment::rod(circle(0.030), 0.2).unwrap();
        let cone = Segment::cone(circle(0.030), circle(0.050), 0.15).unwrap();
        let horn = Segment::horn(circle(0.050), circle(0.020), 0.1).unwrap();
        let nylon = |segment: &Segment| segment.transition_matrix(&nylon(), omega).unwrap();
        let metal = |segment: &Segment| segment.transition_matrix(&aluminium(), omega).unwrap();
        let part = |segment: &Segment, length| segment.cut(length).unwrap().near;
        let mass = TransitionMatrix::lumped_mass(0.02, omega).unwrap();
        let spring = TransitionMatrix::spring(5e7, omega).unwrap();
        check(0, 0.0, state);
        check(0, 0.07, nylon(&part(&rod, 0.07)).transfer(state));
        state = nylon(&rod).transfer(state);
        check(0, 0.2, state);
        check(1, 0.0, state);
        state = mass.transfer(state);
        check(2, 0.0, state);
        check(2, 0.1, metal(&part(&cone, 0.1)).transfer(state));
        state = metal(&cone).transfer(state);
        check(3, 0.0, state);
        state = spring.transfer(state);
        check(4, 0.0, state);
        check(4, 0.03, nylon(&part(&horn, 0.03)).transfer(state));
        state = nylon(&horn).transfer(state);
        check(4, 0.1, state);
        // the last section obeys the condition of the termination (A6): N = -q v
        assert!(relative(state.normal_force, -300.0 * state.velocity) < 1e-11);
    }
}

/// Compares the waves found from the forces at three sections of a rod with the waves that the
/// chain predicts (paper B, eq. 4).
#[test]
fn waves_from_several_sections() {
    let chain = Chain::from_impact_face()
        .mass(0.1)
        .rod(&nylon(), circle(0.030), 0.8)
        .rod(&aluminium(), circle(0.030), 0.3)
        .end(Termination::Free)
        .unwrap();
    let positions = [0.31, 0.40, 0.52];
    for frequency_hz in [500.0, 1500.0, 3000.0, 9000.0] {
        let omega = TAU * frequency_hz;
        let gamma = nylon().propagation_coefficient(omega);
        let forces: Vec<Complex64> = positions
            .iter()
            .map(|x| {
                chain
                    .section(1, *x)
                    .unwrap()
                    .state(omega)
                    .unwrap()
                    .normal_force
            })
            .collect();
        let found = TravellingWaves::from_sections(gamma, &positions, &forces).unwrap();
        let expected = chain.section(1, 0.40).unwrap().waves(omega).unwrap();
        // rounding of kx up to 30, magnified by the condition number
        let tolerance = 1e-13 * found.condition_number * found.waves.at(0.40).norm();
        assert!((found.waves.forward_at(0.40) - expected.forward_at(0.0)).norm() < tolerance);
        assert!((found.waves.backward_at(0.40) - expected.backward_at(0.0)).norm() < tolerance);
        assert!(found.misfit < 1e-12);
        // the waves also agree elsewhere in the rod, at the face of the aluminium
        let face = chain
            .section(1, 0.8)
            .unwrap()
            .state(omega)
            .unwrap()
            .normal_force;
        assert!((found.waves.at(0.8) - face).norm() < 10.0 * tolerance);
    }
}

/// Checks that a semi-infinite rod returns no wave.
#[test]
fn one_wave_before_a_matched_end() {
    let chain = Chain::from_impact_face()
        .rod(&nylon(), circle(0.030), 2.0)
        .end(Termination::semi_infinite(&nylon(), circle(0.030)))
        .unwrap();
    let omega = TAU * 3000.0;
    let gamma = nylon().propagation_coefficient(omega);
    for x in [0.0, 0.7, 2.0] {
        let waves = chain.section(0, x).unwrap().waves(omega).unwrap();
        // N = -F e^{-γx}; rounding of kx = 35
        assert!((waves.forward_at(0.0) + (-gamma * x).exp()).norm() < 1e-13);
        assert!(waves.backward_at(0.0).norm() < 1e-14);
    }
}

#[test]
fn states_at_complex_s() {
    let chain = AnalyticChain::analytic_from_impact_face()
        .rod(&aluminium(), circle(0.03), 1.0)
        .end(Termination::Free)
        .unwrap();
    let s = Complex64::new(800.0, 5000.0);
    let c = (69e9_f64 / 2700.0).sqrt();
    let found = chain.section(0, 0.25).unwrap().state_at_s(s).unwrap();
    // v = F/Z cosh(s(L-x)/c)/sinh(sL/c), N = -F sinh(s(L-x)/c)/sinh(sL/c)
    let z = chain
        .section(0, 0.0)
        .unwrap()
        .state_at_s(s)
        .unwrap()
        .velocity
        .inv()
        * (s / c).cosh()
        / (s / c).sinh();
    let force = -(s * 0.75 / c).sinh() / (s / c).sinh();
    assert!(relative(found.normal_force, force) < 1e-14); // about twelve roundings
    assert!(relative(found.velocity * z, (s * 0.75 / c).cosh() / (s / c).sinh()) < 1e-14);
}

#[test]
fn sections_without_waves_say_so() {
    let chain = body();
    assert!(matches!(
        chain.section(1, 0.0).unwrap().waves(100.0),
        Err(RodwaveError::InElement { index: 1, .. })
    ));
}
