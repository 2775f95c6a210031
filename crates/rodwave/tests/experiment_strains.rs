//! Virtual test of paper B: the three-point relation for any ends, closed forms, and impulses.
use std::f64::consts::TAU;

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::chain::Termination;
use rodwave::element::{Circle, CrossSection};
use rodwave::experiment::end_accelerations::{HalfSine, RaisedCosine};
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember, GENERATOR};
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Zener};
use rodwave::synthesis::DampedSynthesis;

use crate::bodies::nylon;

/// Length [m] of the bar of paper B, and its middle section [m].
const LENGTH: f64 = 0.800;
const MIDDLE: f64 = 0.400;

fn section() -> Circle {
    Circle::of_diameter(0.016).unwrap()
}

fn area() -> f64 {
    CrossSection::from(section()).area()
}

fn support() -> impl Strategy<Value = EndSupport> {
    (0.0..1e7_f64, 0.0..1e3_f64, 1e-3..10.0_f64).prop_map(|(stiffness, resistance, mass)| {
        EndSupport {
            stiffness,
            resistance,
            mass,
        }
    })
}

proptest! {
    /// Checks paper B, eqs. 6-7, for any ends, any distance and both kinds of excitation. The
    /// strains are the sum of two waves whose magnitudes differ by up to e^{αL} (αL < 4 here). Near
    /// a node of the middle section, where ε₀ vanishes, the relation is tested relative to the
    /// terms that cancel: ε₁ + ε₂ = 2ε₀ cosh γa, to 1e-11 of the largest term (Ödeen 1993, paper B,
    /// eq. 5).
    #[test]
    fn three_point_relation(
        left in support(),
        right in support(),
        distance in 0.02..0.35_f64,
        frequency_hz in 100.0..10e3_f64,
        forced in any::<bool>(),
    ) {
        let nylon = nylon();
        let positions = [MIDDLE - distance, MIDDLE, MIDDLE + distance];
        let member = FrameMember::new(&nylon, section(), LENGTH, &positions, right.termination())
            .unwrap()
            .with_left_structure(left.termination())
            .unwrap();
        let pulse = HalfSine::new(1.0, 2e-4).unwrap();
        let excitation = if forced {
            Excitation::Force(&pulse)
        } else {
            Excitation::Velocity(&pulse)
        };
        let omega = TAU * frequency_hz;
        let strains = member.strain_spectra(&excitation, &[omega]).unwrap();
        let [first, middle, last] = [strains[0][0], strains[1][0], strains[2][0]];
        let cosh = (nylon.propagation_coefficient(omega) * distance).cosh();
        let size = first.norm() + last.norm() + 2.0 * (middle * cosh).norm();
        prop_assert!(size > 0.0);
        prop_assert!((first + last - 2.0 * middle * cosh).norm() < 1e-11 * size);
    }
}

/// Checks paper B, eqs. 1 and 2: ∂²ε/∂x² = γ²ε with γ² = -ρω²/E. The second derivative is computed
/// from five strains at spacing h with |γ|h = 1/20; its error is (γh)⁴/90 = 7e-8 of γ²ε.
#[test]
fn strain_obeys_the_wave_equation() {
    let density = 919.0;
    let bar = Medium::new(density, ConstantQ::new(2.6e9, 0.07, 1e4).unwrap()).unwrap();
    let beam = EndSupport::PAPER_B_BEAM;
    let pulse = HalfSine::new(50.0, 2e-4).unwrap();
    for right in [beam, beam.with_lump(0.5)] {
        for frequency_hz in [500.0, 1400.0, 3000.0, 9000.0] {
            let omega = TAU * frequency_hz;
            let square = -density * omega * omega / bar.modulus(omega);
            let step = 0.05 / square.norm().sqrt();
            let positions = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|n| MIDDLE + n * step);
            let strains =
                FrameMember::new(&bar, section(), LENGTH, &positions, right.termination())
                    .unwrap()
                    .with_left_structure(beam.termination())
                    .unwrap()
                    .strain_spectra(&Excitation::Force(&pulse), &[omega])
                    .unwrap();
            let [a, b, middle, c, d] = [0, 1, 2, 3, 4].map(|n: usize| strains[n][0]);
            let second = (16.0 * (b + c) - (a + d) - 30.0 * middle) / (12.0 * step * step);
            let size = square.norm() * a.norm().max(middle.norm()).max(d.norm());
            assert!(
                (second - square * middle).norm() < 1e-7 * size,
                "{frequency_hz} Hz: {second} {}",
                square * middle
            );
        }
    }
}

/// Checks that the strain histories of structures I and II differ as soon as the wave reflected by
/// the lump has arrived.
#[test]
fn structures_one_and_two() {
    let bar = Medium::new(919.0, ConstantQ::new(2.6e9, 0.07, 1e4).unwrap()).unwrap();
    let beam = EndSupport::PAPER_B_BEAM;
    let positions = [0.3, 0.4, 0.5];
    let pulse = RaisedCosine::new(50.0, 2e-4).unwrap();
    let synthesis = DampedSynthesis::new(20e-3, 2e-6).unwrap();
    let [one, two] = [beam, beam.with_lump(0.5)].map(|right| {
        FrameMember::analytic(
            &bar,
            section(),
            LENGTH,
            &positions,
            right.analytic_termination(),
        )
        .unwrap()
        .with_analytic_left_structure(beam.analytic_termination())
        .unwrap()
    });
    let excitation = Excitation::Force(&pulse);
    let [first, second] =
        [&one, &two].map(|member| member.record(&excitation, &synthesis).unwrap());
    assert_eq!(first.generator, GENERATOR);
    assert_eq!((first.strains.len(), first.strains[0].len()), (3, 10_001));
    let peak = first.strains[1]
        .iter()
        .fold(0.0_f64, |peak, e| peak.max(e.abs()));
    let difference = |from: usize, to: usize| {
        let pairs = first.strains[1][from..to]
            .iter()
            .zip(&second.strains[1][from..to]);
        pairs.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / peak
    };
    // the wave that the lump reflects reaches the middle after travelling 1.2 m at less than 2000
    // m/s; before that, the histories are equal, except for the alias of the next period, 1.1e-7
    assert!(difference(0, 300) < 1e-6);
    assert!(difference(300, 10_001) > 0.1);
}

/// Checks the impulses through both ends of the rod: with masses at both ends and no connection to
/// the ground, the final velocity is V = I/(m_L + M + m_R). The rod has transmitted I - m_L V
/// through its left end and m_R V through its right end, and ∫N dt = A E₀ ∫ε dt with the relaxed
/// modulus E₀.
#[test]
fn impulses_through_the_ends() {
    let zener = Zener::new(2.0e9, 2.6e9, 4e-5).unwrap();
    let bar = Medium::new(919.0, zener).unwrap();
    let (left, right) = (0.05, 0.12);
    let member = FrameMember::analytic(
        &bar,
        section(),
        LENGTH,
        &[0.0, LENGTH],
        Termination::Mass(right),
    )
    .unwrap()
    .with_analytic_left_structure(Termination::Mass(left))
    .unwrap();
    let pulse = HalfSine::new(80.0, 4e-4).unwrap();
    let interval = 4e-6;
    let record = member
        .record(
            &Excitation::Force(&pulse),
            &DampedSynthesis::new(0.2, interval).unwrap(),
        )
        .unwrap();
    let impulse = 80.0 * 4e-4 * 2.0 / std::f64::consts::PI;
    let velocity = impulse / (left + right + 919.0 * area() * LENGTH);
    let carried = |strains: &[f64]| -area() * 2.0e9 * interval * strains.iter().sum::<f64>();
    for (strains, expected) in [
        (&record.strains[0], impulse - left * velocity),
        (&record.strains[1], right * velocity),
    ] {
        // Tolerance: the lowest mode, at 0.4 kHz with a loss factor of 2.6 %, has decayed to
        // e^{-6}... e^{-9}, and oscillates about zero.
        let error = carried(strains) / expected - 1.0;
        assert!(error.abs() < 1e-4, "{error}");
    }
}

/// Compares the transforms of the histories, summed over a record that has decayed, with the
/// spectra.
#[test]
fn histories_and_spectra_agree() {
    let bar = Medium::new(919.0, Zener::new(2.4e9, 2.6e9, 5e-5).unwrap()).unwrap();
    let dashpot = 0.3 * area() * (2.6e9_f64 * 919.0).sqrt();
    let member = FrameMember::analytic(
        &bar,
        section(),
        LENGTH,
        &[0.25],
        Termination::Dashpot(dashpot),
    )
    .unwrap();
    let pulse = RaisedCosine::new(50.0, 2e-4).unwrap();
    let excitation = Excitation::Force(&pulse);
    let interval = 2e-6;
    let record = member
        .record(
            &excitation,
            &DampedSynthesis::new(40e-3, interval)
                .unwrap()
                .smoothed(2.5 * interval)
                .unwrap(),
        )
        .unwrap();
    for frequency_hz in [500.0, 1000.0, 3000.0, 8000.0] {
        let omega = TAU * frequency_hz;
        let terms = record.strains[0].iter().enumerate();
        let sum: Complex64 = terms
            .map(|(n, strain)| {
                strain * Complex64::cis(-omega * (record.start + n as f64 * interval))
            })
            .sum();
        let rounded = (-0.5 * (2.5 * omega * interval).powi(2)).exp();
        let expected = rounded * member.strain_spectra(&excitation, &[omega]).unwrap()[0][0];
        // tolerance, relative to the integral of the strain: the dashpot reflects 0.54 in each
        // round trip of 1 ms, and the alias is 1e-7
        let scale = 50.0 * 1e-4 / (area() * 2.6e9);
        let error = (sum * interval - expected).norm() / scale;
        assert!(error < 1e-5, "{frequency_hz}: {error}");
    }
}

#[test]
fn impossible_members_are_refused() {
    let bar = Medium::new(919.0, ConstantQ::new(2.6e9, 0.1, 1e4).unwrap()).unwrap();
    let member =
        |positions: &[f64]| FrameMember::new(&bar, section(), LENGTH, positions, Termination::Free);
    let pulse = HalfSine::new(1.0, 1e-4).unwrap();
    let at_rest = member(&[0.1])
        .unwrap()
        .strain_spectra(&Excitation::Force(&pulse), &[0.0]);
    assert_eq!(
        at_rest.unwrap_err().to_string(),
        "magnitude of the angular frequency [rad/s] is 0, expected a finite value above 0"
    );
}
