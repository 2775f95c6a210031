//! Without noise, γ to the rounding of the data.

use std::f64::consts::TAU;

use cmod::estimate::ModulusEstimate;
use cmod::multi_point::Quantity;
use cmod::validity::Violation;
use cmod::{EndSection, FreeEnd, OneGauge, PulsedRod, Resonances, SeparatePulses};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, WaveMedium};
use rodwave::medium::{Medium, PropagationLaw};

use super::rod::{
    DENSITY, DIAMETER, VirtualRod, lines, polyamide_of_low_loss, polypropylene, relaxing,
    with_end_mass,
};

/// 25 Hz to 15 kHz.
fn band() -> Vec<f64> {
    lines(600, 25.0)
}

fn at(distance: f64, quantity: Quantity) -> EndSection {
    EndSection { distance, quantity }
}

/// All lines are there, right within rounding, and doubtful nowhere.
fn check<L: PropagationLaw>(name: &str, estimate: &ModulusEstimate, medium: &Medium<L>) {
    assert!(
        estimate.refused().is_empty(),
        "{name}: {:?}",
        estimate.refused()
    );
    assert_eq!(estimate.lines().len(), band().len(), "{name}");
    for line in estimate.lines() {
        let exact = medium.modulus(TAU * line.frequency_hz);
        let error = (line.modulus - exact).norm() / exact.norm();
        // The recursion of the chain rounds each of two quantities by a few 1e-15 of the larger of its two waves; 1e-13
        // leaves room for 20 such roundings. A node in one of them magnifies it as the error amplification tells; for the
        // waves themselves, these are differences of what may be ten times as large.
        let tolerance = 1e-12 * (1.0 + line.error_amplification);
        assert!(
            error < tolerance,
            "{name}, {} Hz: {error:e}",
            line.frequency_hz
        );
        let doubt = line
            .validity
            .violations()
            .iter()
            .find(|violation| matches!(violation, Violation::BranchAmbiguous(_)));
        assert_eq!(doubt, None, "{name}, {} Hz", line.frequency_hz);
    }
}

fn check_material<L>(material: &str, medium: &Medium<L>)
where
    Medium<L>: WaveMedium<AngularFrequency> + Clone + 'static,
    L: PropagationLaw,
{
    use Quantity::{Acceleration, Displacement, Strain, Velocity};

    let frequency_hz = band();
    let none = vec![0.0; frequency_hz.len()];
    // from none over the accelerometer of paper A to a quarter of the rod's mass
    for end_mass in [0.0, 2.9e-3, 0.016] {
        let rod = VirtualRod::new(medium, end_mass);
        let pairs = [
            (at(0.5, Strain), at(0.25, Strain)),
            (at(0.2, Strain), at(0.5, Strain)),
            (at(0.7, Strain), at(0.09, Strain)),
            (at(0.801, Acceleration), at(0.0, Acceleration)),
            (at(0.6, Velocity), at(0.1, Velocity)),
            (at(0.4, Displacement), at(0.0, Acceleration)),
        ];
        for (first, second) in pairs {
            let name = format!("{material}, {end_mass} kg, {first:?} by {second:?}");
            let ratio: Vec<Complex64> = frequency_hz
                .iter()
                .map(|f| rod.at(first, TAU * f) / rod.at(second, TAU * f))
                .collect();
            let method = FreeEnd::new(with_end_mass(end_mass), first, second).unwrap();
            let estimate = method.estimate(&frequency_hz, &ratio, &none).unwrap();
            check(&name, &estimate, medium);
        }

        // strain by a motion: what Bacon's pair of pulses becomes when they overlap
        let (gauge, end) = (at(0.35, Strain), at(0.0, Acceleration));
        let by_strain: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| {
                let area_modulus =
                    medium.modulus(TAU * f) * (0.25 * std::f64::consts::PI * DIAMETER * DIAMETER);
                rod.at(gauge, TAU * f) / area_modulus / rod.at(end, TAU * f)
            })
            .collect();
        let method = FreeEnd::new(with_end_mass(end_mass), gauge, end).unwrap();
        let estimate = method.estimate(&frequency_hz, &by_strain, &none).unwrap();
        check(
            &format!("{material}, {end_mass} kg, strain by acceleration"),
            &estimate,
            medium,
        );

        let reflected: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| {
                let [incident, reflected] = rod.waves(0.3, TAU * f);
                reflected / incident
            })
            .collect();
        let name = format!("{material}, {end_mass} kg, one gauge");
        let method = OneGauge::new(with_end_mass(end_mass), at(0.3, Strain)).unwrap();
        check(
            &name,
            &method.estimate(&frequency_hz, &reflected, &none).unwrap(),
            medium,
        );
        // the wave of velocity comes back with the other sign
        let reflected: Vec<Complex64> = reflected.into_iter().map(|ratio| -ratio).collect();
        let method = OneGauge::new(with_end_mass(end_mass), at(0.3, Velocity)).unwrap();
        check(
            &name,
            &method.estimate(&frequency_hz, &reflected, &none).unwrap(),
            medium,
        );

        let passing: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| rod.waves(0.2, TAU * f)[0] / rod.waves(0.6, TAU * f)[0])
            .collect();
        let method = SeparatePulses::new(PulsedRod {
            distance: 0.4,
            diameter: DIAMETER,
            density: DENSITY,
        });
        let estimate = method.unwrap().estimate(&frequency_hz, &passing, &none);
        check(
            &format!("{material}, {end_mass} kg, pulses"),
            &estimate.unwrap(),
            medium,
        );
    }
}

#[test]
fn every_method_finds_the_modulus_of_a_rod_without_noise() {
    check_material("polypropylene", &polypropylene());
    check_material("one relaxation", &relaxing());
    check_material("polyamide of low loss", &polyamide_of_low_loss());
}

/// The two-point method and the free end with d₁ = L, d₂ = 0 are one method.
#[test]
fn two_accelerations_are_the_two_point_method() {
    use cmod::{Specimen, TwoPoint};

    let end_mass = 2.9e-3;
    let rod = VirtualRod::new(&polypropylene(), end_mass);
    let frequency_hz = band();
    let ends = [
        at(super::rod::LENGTH, Quantity::Acceleration),
        at(0.0, Quantity::Acceleration),
    ];
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| rod.at(ends[0], TAU * f) / rod.at(ends[1], TAU * f))
        .collect();
    let variance: Vec<f64> = ratio.iter().map(|ratio| 1e-6 * ratio.norm_sqr()).collect();
    let free_end = FreeEnd::new(with_end_mass(end_mass), ends[0], ends[1])
        .unwrap()
        .estimate(&frequency_hz, &ratio, &variance)
        .unwrap();
    let two_point = TwoPoint::new(Specimen {
        length: super::rod::LENGTH,
        diameter: DIAMETER,
        density: DENSITY,
        accelerometer_mass: end_mass,
    })
    .unwrap()
    .estimate(&frequency_hz, &ratio, &variance)
    .unwrap();
    for (one, other) in free_end.lines().iter().zip(two_point.lines()) {
        // Two iterations on the same numbers: a few roundings, amplified.
        let tolerance = 1e-13 * (1.0 + one.error_amplification);
        assert!((one.modulus - other.modulus).norm() < tolerance * one.modulus.norm());
        let errors = [one, other].map(|line| line.standard_error.loss_modulus);
        assert!((errors[0] / errors[1] - 1.0).abs() < 1e-9);
        assert!((one.error_amplification / other.error_amplification - 1.0).abs() < 1e-9);
    }
}

/// At every resonance of the band, and at no other frequency, whatever the mass on the end.
#[test]
fn resonances_are_those_of_the_chain() {
    let medium = polypropylene();
    let frequency_hz = lines(1500, 5.0);
    let ends = [
        at(super::rod::LENGTH, Quantity::Acceleration),
        at(0.0, Quantity::Acceleration),
    ];
    for end_mass in [0.0, 2.9e-3, 0.016] {
        let rod = VirtualRod::new(&medium, end_mass);
        let ratio_at = |f: f64| rod.at(ends[0], TAU * f) / rod.at(ends[1], TAU * f);
        let ratio: Vec<Complex64> = frequency_hz.iter().map(|f| ratio_at(*f)).collect();
        let method = Resonances::new(with_end_mass(end_mass), super::rod::LENGTH).unwrap();
        let estimate = method
            .estimate(&frequency_hz, &ratio, &vec![0.0; 1500])
            .unwrap();
        let changes = ratio
            .windows(2)
            .filter(|pair| pair[0].re * pair[1].re < 0.0)
            .count();
        assert_eq!(estimate.lines().len(), changes, "{end_mass} kg");
        for (n, line) in (1..).zip(estimate.lines()) {
            assert!(
                ratio_at(line.frequency_hz).re.abs() < 1e-3,
                "{} Hz",
                line.frequency_hz
            );
            let exact = medium.modulus(TAU * line.frequency_hz);
            let error = (line.modulus - exact).norm() / exact.norm();
            // The remainder of a polynomial of third degree over 0.3 rad of kL: 0.3⁴/192 = 4.2e-5, times 2/kL, for a massless
            // end. The mass μ puts 1 + μ(4 + kL) on the fourth derivative and takes as much off by the first.
            assert!(
                error < 6e-5 / f64::from(n),
                "{end_mass} kg, {} Hz: {error:e}",
                line.frequency_hz
            );
        }
    }
}
