//! Mobility of chains: limits of frequency and damping, terminations, energy, complex frequencies.

use std::f64::consts::{FRAC_PI_2, TAU};

use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Argument, ChainBuilder, WaveMedium};
use rodwave::element::CrossSection;
use rodwave::medium::Medium;
use rodwave::modulus::{PowerLawPropagation, Zener};
use rodwave::{Chain, Termination};
use testbed::difference::relative;

use crate::bodies::{aluminium, circle, nylon, polymer};

/// Checks that nothing overflows at αL = 1e4 and kL = 1e5, and that the mobilities equal closed
/// forms.
#[test]
fn strong_damping_and_many_waves() {
    let face = circle(0.02);
    let lossy = Medium::new(
        1150.0,
        PowerLawPropagation::new(1e-1, 1.0, 1.0, 1.0).unwrap(),
    )
    .unwrap();
    let omega = 1e5;
    // a hundred elements of αL = 1e4 and kL = 1e5 in series, with jumps of the impedance between
    // them
    let z = lossy.specific_characteristic_impedance(omega) * CrossSection::from(face).area();
    let mut row = Chain::from_impact_face();
    for _ in 0..50 {
        row = row
            .rod(&lossy, face, 1.0)
            .cone(&lossy, circle(0.04), circle(0.01), 1.0);
    }
    let row = row
        .horn(&lossy, face, circle(0.03), 1.0)
        .end(Termination::Fixed)
        .unwrap();
    assert!(relative(row.mobility(omega).unwrap(), 1.0 / z) < 1e-14);
    assert!(row.far_face_mobility(omega).unwrap() == Complex64::ZERO); // the end is fixed
    let inside = row.section(60, 0.5).unwrap().state(omega).unwrap();
    assert!(inside.velocity == Complex64::ZERO); // e^{-6e5}

    // undamped, kL = 1e5: Ĝ = -i cot(kL)/Z, whose phase is known to 1e5 roundings
    let (aluminium, length) = (aluminium(), 100.0);
    let omega = 1e5 / length * aluminium.phase_velocity(1.0);
    let rod = Chain::from_impact_face()
        .rod(&aluminium, face, length)
        .end(Termination::Free)
        .unwrap();
    let z = aluminium.specific_characteristic_impedance(omega).re * CrossSection::from(face).area();
    let phase = aluminium.wave_number(omega) * length;
    let expected = Complex64::new(0.0, -1.0 / (z * phase.tan()));
    assert!(relative(rod.mobility(omega).unwrap(), expected) < 1e-10);
}

/// Compares the recursion with the plain product of the matrices (paper E, eq. A10).
#[test]
fn recursion_agrees_with_the_product() {
    let chain = Chain::from_impact_face()
        .mass(0.003)
        .cone(&nylon(), circle(0.030), circle(0.060), 0.1)
        .spring(3e7)
        .rod(&aluminium(), circle(0.040), 0.2)
        .dashpot(5e4)
        .horn(&nylon(), circle(0.050), circle(0.020), 0.15)
        .end(Termination::Free)
        .unwrap();
    for frequency_hz in [0.01, 3.0, 400.0, 2900.0, 7700.0, 15_000.0] {
        let omega = TAU * frequency_hz;
        let product = chain.transition_matrix(omega).unwrap();
        let found = chain.mobility(omega).unwrap();
        assert!(
            relative(found, product.mobility_free_end().unwrap()) < 1e-12,
            "{frequency_hz}"
        ); // rounding, αL < 3
        let [[_, p12], [_, p22]] = product.entries();
        let far = chain.far_face_mobility(omega).unwrap();
        assert!(relative(far, p22 / p12) < 1e-12, "{frequency_hz}");
        let faces = chain.face_mobilities(omega).unwrap();
        assert!(faces.near == found && faces.far == far);
        // the far face has N = 0, and the determinant is 1
        assert!(
            relative(faces.transfer, 1.0 / p12) < 1e-12,
            "{frequency_hz}"
        );
    }
}

/// Builds a body, for real or for complex frequencies.
fn body<V: Argument>(builder: ChainBuilder<V>, end: Termination<V>) -> Chain<V>
where
    Medium<Zener>: WaveMedium<V>,
{
    let medium = polymer();
    builder
        .rod(&medium, circle(0.016), 0.3)
        .horn(&medium, circle(0.016), circle(0.03), 0.2)
        .cone(&medium, circle(0.03), circle(0.02), 0.1)
        .mass(0.01)
        .spring(2e7)
        .dashpot(1e4)
        .rod(&medium, circle(0.02), 0.2)
        .end(end)
        .unwrap()
}

#[test]
fn analytic_chain_continues_the_other() {
    let on_axis = body(Chain::from_impact_face(), Termination::Dashpot(20.0));
    let analytic = body(
        AnalyticChain::analytic_from_impact_face(),
        Termination::Dashpot(20.0),
    );
    for omega in [0.0, 1e-3, 10.0, 1e4, -2e4] {
        let (found, expected) = (
            analytic.mobility(omega).unwrap(),
            on_axis.mobility(omega).unwrap(),
        );
        assert!(relative(found, expected) < 1e-12, "{omega}"); // the two evaluations of the laws round differently
        let at_s = analytic.mobility_at_s(Complex64::new(0.0, omega)).unwrap();
        assert_eq!(at_s, found);
    }
    // The mean of an analytic function on the circle around s₀ is its value at the centre.
    let (centre, radius, points) = (Complex64::new(3e3, 8e3), 2.5e3, 64);
    let mean = (0..points)
        .map(|k| {
            let s = centre + Complex64::from_polar(radius, TAU * f64::from(k) / f64::from(points));
            analytic.mobility_at_s(s).unwrap()
        })
        .sum::<Complex64>()
        / f64::from(points);
    let at_centre = analytic.mobility_at_s(centre).unwrap();
    // the nearest pole is more than 3000/s away: the remainder is below (2500/3000)^64 = 1e-5 of a
    // residue, and the convergence shows that no pole is inside the circle
    assert!(relative(mean, at_centre) < 1e-5);
    // a positive real function is real for real s, and has Re G >= 0 in the right half plane
    let real = analytic.mobility_at_s(Complex64::new(2e3, 0.0)).unwrap();
    assert!(real.re > 0.0 && real.im.abs() < 1e-15 * real.re);
    // for large s, the mobility is that of the struck rod alone, G → 1/Z(∞); the next section
    // contributes e^{-2αL}, αL > 100
    let first = analytic.mobility_at_s(Complex64::new(1e9, 0.0)).unwrap();
    let z = (2.6e9_f64 * 910.0).sqrt() * CrossSection::from(circle(0.016)).area();
    assert!((first.re * z - 1.0).abs() < 1e-5); // (E₁ - E₀)/E₁/(2sτ) = 2.6e-6
    let far = analytic
        .far_face_mobility_at_s(Complex64::new(1e3, 1e3))
        .unwrap();
    assert!(far.re > 0.0);
    let wall = Termination::impedance_at_s(|s| 1e4 + 0.1 * s);
    assert!(
        body(AnalyticChain::analytic_from_impact_face(), wall)
            .mobility_at_s(centre)
            .unwrap()
            .re
            > 0.0
    );
}

/// Checks that the energy that an elastic body takes up goes into the dashpot at its end: Re Ĝ = q
/// |v_end/F|².
#[test]
fn energy_balance_of_an_elastic_body() {
    let aluminium = aluminium();
    let chain = Chain::from_impact_face()
        .cone(&aluminium, circle(0.03), circle(0.06), 0.3)
        .mass(0.2)
        .spring(1e8)
        .horn(&aluminium, circle(0.05), circle(0.02), 0.4)
        .rod(&aluminium, circle(0.02), 0.5)
        .end(Termination::Dashpot(2e3))
        .unwrap();
    let end = chain.section(4, 0.5).unwrap();
    for frequency_hz in [1.0, 500.0, 2600.0, 9000.0, 30_000.0] {
        let omega = TAU * frequency_hz;
        let taken = chain.mobility(omega).unwrap().re;
        let dissipated = 2e3 * end.state(omega).unwrap().velocity.norm_sqr();
        // rounding, relative to |Ĝ| because Re Ĝ is small if almost nothing is dissipated
        let tolerance = 1e-12 * chain.mobility(omega).unwrap().norm();
        assert!(
            (taken - dissipated).abs() < tolerance,
            "{frequency_hz} Hz: {taken} {dissipated}"
        );
    }
}

/// Checks an undamped rod at its antiresonance and at its resonance: no floating-point number gives
/// exactly kL = π/2 or π, so the frequencies are not rejected.
#[test]
fn undamped_resonances_do_not_break() {
    let aluminium = aluminium();
    let rod = Chain::from_impact_face()
        .rod(&aluminium, circle(0.02), 1.0)
        .end(Termination::Free)
        .unwrap();
    let quarter = FRAC_PI_2 * aluminium.phase_velocity(1.0);
    assert!(rod.mobility(quarter).unwrap().norm() < 1e-15);
    assert!(rod.mobility(2.0 * quarter).unwrap().norm() > 1e10);
}
