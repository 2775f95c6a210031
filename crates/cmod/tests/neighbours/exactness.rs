//! Tests without noise: γ to the rounding of the data.

use std::f64::consts::TAU;

use cmod::estimate::ModulusEstimate;
use cmod::multi_point::Quantity;
use cmod::validity::{AcceptanceLimits, Violation};
use cmod::{EndSection, FreeEnd, ModulusLine, OneGauge, PulsedRod, Resonances, SeparatePulses};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, WaveMedium};
use rodwave::medium::{Medium, PropagationLaw};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use super::rod::{
    DENSITY, DIAMETER, LENGTH, VirtualRod, lines, polypropylene, relaxing, with_end_mass,
};
use crate::materials::polyamide;

/// Returns frequencies from 25 Hz to 15 kHz.
fn band() -> Vec<f64> {
    lines(600, 25.0)
}

fn at(distance: f64, quantity: Quantity) -> EndSection {
    EndSection { distance, quantity }
}

/// Returns the largest error of the modulus, divided by the amplification of its line, and checks
/// that all lines are present and none is doubtful.
fn error_of<L: PropagationLaw>(estimate: &ModulusEstimate, medium: &Medium<L>) -> f64 {
    assert!(estimate.refused().is_empty(), "{:?}", estimate.refused());
    assert_eq!(estimate.lines().len(), band().len());
    let error = |line: &ModulusLine| {
        let is_doubt = |violation: &Violation| matches!(violation, Violation::BranchAmbiguous(_));
        assert!(!line.validity.violations().iter().any(is_doubt), "{line:?}");
        let exact = medium.modulus(TAU * line.frequency_hz);
        relative(line.modulus, exact) / (1.0 + line.error_amplification)
    };
    largest(estimate.lines().iter().map(error))
}

/// Returns the largest errors of the free end, one gauge and separate pulses.
fn worst_of_material<L>(medium: &Medium<L>) -> [f64; 3]
where
    Medium<L>: WaveMedium<AngularFrequency> + Clone + 'static,
    L: PropagationLaw,
{
    use Quantity::{Acceleration, Displacement, Strain, Velocity};

    let frequency_hz = band();
    let none = vec![0.0; frequency_hz.len()];
    let ratio = |of: &dyn Fn(f64) -> Complex64| -> Vec<Complex64> {
        frequency_hz.iter().map(|f| of(TAU * f)).collect()
    };
    let mut worst = [0.0_f64; 3];
    // end masses from none, over the accelerometer of paper A, to a quarter of the mass of the rod
    for end_mass in [0.0, 2.9e-3, 0.016] {
        let rod = VirtualRod::new(medium, end_mass);
        for (first, second) in [
            (at(0.5, Strain), at(0.25, Strain)),
            (at(0.2, Strain), at(0.5, Strain)),
            (at(0.7, Strain), at(0.09, Strain)),
            (at(LENGTH, Acceleration), at(0.0, Acceleration)),
            (at(0.6, Velocity), at(0.1, Velocity)),
            (at(0.4, Displacement), at(0.0, Acceleration)),
            // Bacon's arrangement with overlapping pulses
            (at(0.35, Strain), at(0.0, Acceleration)),
        ] {
            let observed = ratio(&|w| {
                let force_by_strain = medium.modulus(w) * (0.125 * TAU * DIAMETER * DIAMETER);
                let by_strain = if first.quantity == second.quantity || first.quantity != Strain {
                    Complex64::ONE
                } else {
                    force_by_strain
                };
                rod.at(first, w) / by_strain / rod.at(second, w)
            });
            let method = FreeEnd::new(with_end_mass(end_mass), first, second).unwrap();
            let estimate = method.estimate(&frequency_hz, &observed, &none).unwrap();
            worst[0] = worst[0].max(error_of(&estimate, medium));
        }
        // the velocity wave is reflected with the opposite sign
        for (quantity, sign) in [(Strain, 1.0), (Velocity, -1.0)] {
            let reflected = ratio(&|w| {
                let [incident, reflected] = rod.waves(0.3, w);
                sign * reflected / incident
            });
            let method = OneGauge::new(with_end_mass(end_mass), at(0.3, quantity)).unwrap();
            let estimate = method.estimate(&frequency_hz, &reflected, &none).unwrap();
            worst[1] = worst[1].max(error_of(&estimate, medium));
        }
        let passing = ratio(&|w| rod.waves(0.2, w)[0] / rod.waves(0.6, w)[0]);
        let method = SeparatePulses::new(PulsedRod {
            distance: 0.4,
            diameter: DIAMETER,
            density: DENSITY,
        });
        let estimate = method.unwrap().estimate(&frequency_hz, &passing, &none);
        worst[2] = worst[2].max(error_of(&estimate.unwrap(), medium));
    }
    worst
}

#[test]
fn every_method_finds_the_modulus_of_a_rod_without_noise() {
    let found = [
        worst_of_material(&polypropylene()),
        worst_of_material(&relaxing()),
        worst_of_material(&polyamide(DENSITY, 0.2)),
    ];
    let mut claims = Claims::default();
    for (method, (source, name)) in [
        (
            "cosh or sinh of gamma d at two sections before a free end with a mass",
            "free end, seven pairs of strains and motions",
        ),
        (
            "ratio of the reflected to the incident wave, exp(-2 gamma d) times that at the mass",
            "one gauge, strain and velocity",
        ),
        ("exp(-gamma d) between two sections", "separate pulses"),
    ]
    .into_iter()
    .enumerate()
    {
        claims.by(source);
        claims.deviation(
            format!("{name}, three materials and end masses: modulus, 25 Hz to 15 kHz, relative to the amplification"),
            // tolerance: each of two quantities has an error of a few 1e-15 of the larger of its
            // two waves, which may be ten times as large as the quantity
            Within(1e-12, "rounding of the chain: differences of waves"),
            Ok(largest(found.map(|worst| worst[method]))),
        );
    }
    resonances(&mut claims);
    damping_of_one_gauge(&mut claims);
    hold!(claims);
}

fn damping_of_one_gauge(claims: &mut Claims) {
    let frequency_hz = [900.0, 1700.0, 3100.0, 5200.0, 8800.0];
    let rod = VirtualRod::new(&polypropylene(), 0.0);
    let ratio = frequency_hz.map(|f| {
        let [incident, reflected] = rod.waves(0.3, TAU * f);
        reflected / incident
    });
    let variance = ratio.map(|h| 9e-6 * h.norm_sqr());
    let estimate = OneGauge::new(with_end_mass(0.0), at(0.3, Quantity::Strain))
        .and_then(|method| method.with_wave_speed(1700.0))
        .and_then(|method| method.with_limits(AcceptanceLimits::NONE))
        .and_then(|method| method.estimate(&frequency_hz, &ratio, &variance))
        .unwrap();
    assert_eq!(estimate.lines().len(), 5);
    let error = |line: &ModulusLine| {
        let h = ratio[line.index].norm();
        let expected = (0.5 * variance[line.index]).sqrt() / (2.0 * 0.3 * h);
        line.standard_error.damping_coefficient / expected - 1.0
    };
    claims.by("variance of gamma: variance of H divided by (2 d H)^2");
    claims.deviation(
        "one gauge before a free end: standard error of the damping coefficient",
        Within(2e-15, "some roundings"),
        Ok(largest(estimate.lines().iter().map(error))),
    );
}

/// Checks the estimates at every resonance of the band and at no other frequency, for several
/// masses on the end.
fn resonances(claims: &mut Claims) {
    let medium = polypropylene();
    let frequency_hz = lines(1500, 5.0);
    let ends = [LENGTH, 0.0].map(|distance| at(distance, Quantity::Acceleration));
    let mut worst = 0.0_f64;
    for end_mass in [0.0, 2.9e-3, 0.016] {
        let rod = VirtualRod::new(&medium, end_mass);
        let ratio_at = |f: f64| rod.at(ends[0], TAU * f) / rod.at(ends[1], TAU * f);
        let ratio: Vec<Complex64> = frequency_hz.iter().map(|f| ratio_at(*f)).collect();
        let method = Resonances::new(with_end_mass(end_mass), LENGTH).unwrap();
        let estimate = method
            .estimate(&frequency_hz, &ratio, &vec![0.0; 1500])
            .unwrap();
        let changes = ratio
            .windows(2)
            .filter(|pair| pair[0].re * pair[1].re < 0.0)
            .count();
        assert_eq!(estimate.lines().len(), changes, "{end_mass} kg");
        for (n, line) in (1..).zip(estimate.lines()) {
            let real = ratio_at(line.frequency_hz).re;
            assert!(real.abs() < 1e-3, "{} Hz: {real}", line.frequency_hz);
            let exact = medium.modulus(TAU * line.frequency_hz);
            worst = worst.max(f64::from(n) * relative(line.modulus, exact));
        }
    }
    claims.by("resonances: the real part of the ratio of the ends changes its sign");
    claims.deviation(
        "modulus at the n-th resonance up to 7.5 kHz, n times the error, three end masses",
        // tolerance: without a mass on the end the error is 0.3⁴/192 = 4.2e-5 of kL, times 2/kL.
        // The mass μ multiplies the fourth derivative by 1 + μ(4 + kL), and increases the first
        // derivative equally
        Within(
            6e-5,
            "a polynomial of third degree over 0.3 rad, 0.3^4/192, and the mass",
        ),
        Ok(worst),
    );
}
