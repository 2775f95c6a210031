//! Random specimens, computed in closed form by exponentials. Every method recovers the modulus,
//! counts waves that only increase, and gives the same result in every unit, thread and file.

use num_complex::Complex64;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use cmod::estimate::{PlottedQuantity, coverage_factor};
use cmod::multi_point::Quantity;
use cmod::validity::AcceptanceLimits;
use cmod::{
    EndSection, FreeEnd, ModulusEstimate, OneGauge, PulsedRod, RodWithFreeEnd, SeparatePulses,
    TwoPoint,
};

use super::specimen::{Specimen, strain_of_two_waves};

fn cases(cases: u32, seed: u64) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

const LINES: usize = 160;

fn any_specimen() -> impl Strategy<Value = Specimen> {
    (
        -1.0..1.0_f64,
        7.5..11.0_f64,
        2.5..4.0_f64,
        -3.0..-0.5_f64,
        0.0..0.05_f64,
    )
        .prop_map(|(length, modulus, density, loss, mass)| {
            let length = 10f64.powf(length);
            let (diameter, density) = (0.01 * length, 10f64.powf(density));
            Specimen {
                length,
                diameter,
                density,
                end_mass: mass
                    * density
                    * 0.25
                    * std::f64::consts::PI
                    * diameter
                    * diameter
                    * length,
                modulus: 10f64.powf(modulus),
                loss_factor: 10f64.powf(loss),
            }
        })
}

/// Returns lines over the first four half waves, starting far below the first half wave.
fn frequencies(specimen: &Specimen) -> Vec<f64> {
    let step = 4.0 * specimen.fundamental_hz() / LINES as f64;
    (1..=LINES).map(|k| step * k as f64).collect()
}

fn two_point(specimen: &Specimen) -> TwoPoint {
    TwoPoint::new(cmod::Specimen {
        length: specimen.length,
        diameter: specimen.diameter,
        density: specimen.density,
        accelerometer_mass: specimen.end_mass,
    })
    .unwrap()
    .with_limits(AcceptanceLimits::NONE)
    .unwrap()
}

fn estimated(specimen: &Specimen) -> ModulusEstimate {
    let frequency_hz = frequencies(specimen);
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| specimen.motion_at(specimen.length, *f))
        .collect();
    let variance = vec![1e-12; LINES];
    two_point(specimen)
        .estimate(&frequency_hz, &ratio, &variance)
        .unwrap()
}

/// Checks that at least `fewest` lines are valid, and that their modulus is that of the specimen;
/// tolerance: rounding errors of Ψ of some 1e-16, amplified like relative errors.
fn is_modulus_of(estimate: &ModulusEstimate, specimen: &Specimen, fewest: usize) {
    let valid: Vec<_> = estimate.valid().collect();
    assert!(
        valid.len() >= fewest,
        "{} valid lines of {specimen:?}",
        valid.len()
    );
    for line in valid {
        let error = (line.modulus / specimen.complex_modulus() - 1.0).norm();
        let allowed = 1e-13 * (10.0 + line.error_amplification);
        assert!(
            error < allowed,
            "{} Hz: {error:e} of {specimen:?}",
            line.frequency_hz
        );
    }
}

proptest! {
    #![proptest_config(cases(32, 11))]

    #[test]
    fn accelerations_of_two_points(specimen in any_specimen()) {
        let estimate = estimated(&specimen);
        // lines below 2/5 half waves are not valid, because the wave is longer than five specimens
        is_modulus_of(&estimate, &specimen, LINES / 2);
        // kL increases from line to line
        let mut before = 0.0;
        for line in estimate.lines() {
            let phase = line.wave_number() * specimen.length;
            prop_assert!(phase > before, "{phase} after {before}");
            before = phase;
            prop_assert!(line.damping_coefficient() > 0.0);
        }
    }

    /// Checks that the result does not depend on the units of time, length and mass; powers of two
    /// are exact, and the ratio has no unit.
    #[test]
    fn scales_are_a_matter_of_taste(specimen in any_specimen(), metre in -2..3_i32, second in 0..2_i32, kilogram in -30..30_i32) {
        let (metre, second, kilogram) = (2f64.powi(metre), 2f64.powi(second), 2f64.powi(kilogram));
        // wave speeds must remain in the range of the search
        prop_assume!((100.0..5000.0).contains(&((specimen.modulus / specimen.density).sqrt() * metre / second)));
        prop_assume!((100.0..5000.0).contains(&(specimen.modulus / specimen.density).sqrt()));
        let pascal = kilogram / (metre * second * second);
        let scaled = Specimen {
            length: specimen.length * metre,
            diameter: specimen.diameter * metre,
            density: specimen.density * (kilogram / metre.powi(3)),
            end_mass: specimen.end_mass * kilogram,
            modulus: specimen.modulus * pascal,
            loss_factor: specimen.loss_factor,
        };
        let (here, there) = (estimated(&specimen), estimated(&scaled));
        for (one, other) in here.valid().zip(there.valid()) {
            prop_assert_eq!(one.index, other.index);
            let allowed = 1e-13 * (10.0 + one.error_amplification);
            prop_assert!((one.modulus * pascal / other.modulus - 1.0).norm() < allowed);
        }
    }
}

/// Checks tan δ from 1e-9 to 10 for every method: valid lines are correct within the rounding error
/// amplified by the method, and losses below rounding are valid only within their stated error.
#[test]
fn all_but_lossless_and_all_but_fluid() {
    for exponent in [-9, -8, -7, -6, -5, -4, -3, -2, -1, 0, 1] {
        let specimen = Specimen {
            loss_factor: 10f64.powi(exponent),
            ..Specimen::polymer()
        };
        let frequency_hz = frequencies(&specimen);
        let variance = vec![1e-30; LINES]; // rounding is all the noise there is
        let rod = RodWithFreeEnd {
            diameter: specimen.diameter,
            density: specimen.density,
            end_mass: 0.0,
        };
        let acceleration = |distance| EndSection {
            distance,
            quantity: Quantity::Acceleration,
        };
        let speed = std::f64::consts::TAU * frequency_hz[9] / specimen.gamma(frequency_hz[9]).im;
        let ratio = |near: f64, far: f64| -> Vec<Complex64> {
            let at = |f: &f64| specimen.motion_at(far, *f) / specimen.motion_at(near, *f);
            frequency_hz.iter().map(at).collect()
        };
        let decay: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| strain_of_two_waves(specimen.gamma(*f), 0.4, Complex64::ZERO))
            .collect();
        // ratio of the reflected wave to the arriving wave at the gauge, 0.4 m before the free end:
        // the waves travel 0.8 m, and the strain changes its sign
        let reflected: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| -strain_of_two_waves(specimen.gamma(*f), 0.8, Complex64::ZERO))
            .collect();
        let gauge = EndSection {
            distance: 0.4,
            quantity: Quantity::Strain,
        };
        let pulses = SeparatePulses::new(PulsedRod {
            distance: 0.4,
            diameter: specimen.diameter,
            density: specimen.density,
        });
        let estimates = [
            two_point(&specimen).estimate(&frequency_hz, &ratio(0.0, 1.0), &variance),
            FreeEnd::new(rod, acceleration(1.0), acceleration(0.3))
                .and_then(|method| method.with_wave_speed(speed))
                .and_then(|method| method.estimate(&frequency_hz, &ratio(0.3, 1.0), &variance)),
            pulses
                .and_then(|method| method.with_wave_speed(speed))
                .and_then(|method| method.estimate(&frequency_hz, &decay, &variance)),
            OneGauge::new(rod, gauge)
                .and_then(|method| method.with_wave_speed(speed))
                .and_then(|method| method.estimate(&frequency_hz, &reflected, &variance)),
        ];
        for (method, estimate) in estimates.into_iter().enumerate() {
            let estimate = estimate.unwrap();
            for line in estimate.valid() {
                let storage = (line.modulus.re / specimen.modulus - 1.0).abs();
                let loss = (line.loss_factor / specimen.loss_factor - 1.0).abs();
                // tolerance: a rounding error of Ψ changes E, amplified, by some 1e-16 of |E| in
                // any direction, and hence tan δ by a part larger by 1/tan δ
                let roundings = if method == 3 { 1e-14 } else { 1e-15 };
                let rounding = roundings * (10.0 + line.error_amplification);
                let seen = rounding * (1.0 + specimen.loss_factor + specimen.loss_factor.recip());
                assert!(
                    storage < rounding * (1.0 + specimen.loss_factor.powi(2)),
                    "method {method}, tan δ 1e{exponent}: E' {storage:e}"
                );
                assert!(
                    loss < seen * (1.0 + specimen.loss_factor),
                    "method {method}, tan δ 1e{exponent}: {loss:e}"
                );
            }
            // not for one gauge, for which few lines have wavelengths below five distances
            if (-6..=-1).contains(&exponent) && method < 3 {
                let valid = estimate.valid().count();
                assert!(
                    valid > LINES / 4,
                    "method {method}, tan δ 1e{exponent}: {valid} valid lines"
                );
            }
        }
    }
}

/// Checks that many lines take memory and time in proportion to their number.
#[test]
fn a_hundred_thousand_lines() {
    let specimen = Specimen::polymer();
    let step = 4.0 * specimen.fundamental_hz() / 1e5;
    let frequency_hz: Vec<f64> = (1..=100_000_u32).map(|k| step * f64::from(k)).collect();
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| specimen.motion_at(1.0, *f))
        .collect();
    let estimate = two_point(&specimen)
        .estimate(&frequency_hz, &ratio, &vec![1e-12; 100_000])
        .unwrap();
    is_modulus_of(&estimate, &specimen, 50_000);
}

/// Checks that a table that is written and read again has every number to its last bit.
#[test]
fn files_keep_every_bit() {
    let estimate = estimated(&Specimen::polymer());
    let columns = estimate.columns();
    let text = ron::to_string(&columns).unwrap();
    let read: ron::Value = ron::from_str(&text).unwrap();
    let mut written: Vec<f64> = columns
        .iter()
        .flat_map(|column| column.values.clone())
        .collect();
    let mut found = Vec::new();
    numbers(&read, &mut found);
    assert_eq!(found.len(), written.len());
    for (found, written) in found.iter().zip(&mut written) {
        assert_eq!(found.to_bits(), written.to_bits());
    }
    for quantity in [PlottedQuantity::LossFactor, PlottedQuantity::StorageModulus] {
        let curve = estimate.curve(quantity, 2.0);
        let read: ron::Value = ron::from_str(&ron::to_string(&curve).unwrap()).unwrap();
        let mut found = Vec::new();
        numbers(&read, &mut found);
        assert!(found.len() >= 3 * estimate.valid().count());
        assert!(found.iter().all(|number| number.is_finite()));
    }
}

fn numbers(value: &ron::Value, into: &mut Vec<f64>) {
    match value {
        ron::Value::Number(number) => into.push(number.into_f64()),
        ron::Value::Seq(entries) => entries.iter().for_each(|entry| numbers(entry, into)),
        ron::Value::Map(map) => map.values().for_each(|entry| numbers(entry, into)),
        ron::Value::Option(Some(entry)) => numbers(entry, into),
        _ => {}
    }
}

/// Checks that Student's factor approaches the normal factor without a step as the number of
/// averages increases. Reference values from mpmath 1.3.0 with 40 digits: the root of the
/// regularised incomplete beta function.
#[test]
fn coverage_of_many_averages() {
    let reference = [
        (0.95, 1e2, 1.983_971_518_523_552_3),
        (0.95, 1e3, 1.962_339_080_826_408_5),
        (0.95, 9_999.0, 1.960_201_263_621_357_7),
        (0.95, 1e4, 1.960_201_239_890_626_3),
        (0.95, 1e6, 1.959_966_356_814_107),
    ];
    for (probability, freedom, expected) in reference {
        let found = coverage_factor(probability, Some(freedom)).unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{freedom}: {found} {expected}"
        );
    }
    let normal = coverage_factor(0.99, None).unwrap();
    let mut before = f64::INFINITY;
    for exponent in 0..=300 {
        let found = coverage_factor(0.99, Some(10f64.powi(exponent))).unwrap();
        assert!(
            found <= before && found >= normal * (1.0 - 1e-12),
            "1e{exponent}"
        );
        before = found;
    }
}
