//! Tests of derivatives, similarity and superposition of simulated responses.

use maxwellid::linear::{ConstantQ, LinearModel, MaxwellBranches};
use maxwellid::{DrivenRod, RodModel};
use proptest::prelude::*;
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};

use super::{DENSITY, LENGTH, MODULUS, RATE, excitation};

const CELL: f64 = 8e-3;
const STRESS: f64 = 10e6;

/// Response of a rod whose lengths are multiplied by `length` and whose times by `time`.
fn response(
    model: &dyn RodModel,
    parameters: &[f64],
    velocity: f64,
    length: f64,
    time: f64,
) -> Vec<f64> {
    let samples: Vec<f64> = excitation(velocity)
        .iter()
        .map(|v| v * length / time)
        .collect();
    let rate = RATE / time;
    let history = SampledHistory::new(&samples, rate).unwrap();
    let times: Vec<f64> = (0..150).map(|k| f64::from(k) / rate).collect();
    let rod = DrivenRod {
        length: LENGTH * length,
        density: DENSITY,
        sampling_rate_hz: rate,
        samples: &samples,
        excitation: &history,
        times: &times,
        cell: CELL * length,
        temperature: None,
        lateral_inertia: (2e-3 * length).powi(2),
    };
    model.response(&rod, parameters).unwrap()
}

fn models() -> Vec<(Box<dyn RodModel>, Vec<f64>)> {
    let maxwell = Maxwell::from_reference_rate(20.0, STRESS).unwrap();
    let norton = MaxwellNorton::from_reference_rate(1.6, 10.0, STRESS).unwrap();
    let gurevich = MaxwellGurevichRabinovich::from_reference_rate(1.0, 10.0, STRESS).unwrap();
    let (zener, flat) = (
        LinearModel::new(MaxwellBranches::zener()),
        LinearModel::new(ConstantQ::default()),
    );
    let at = |model: &dyn RodModel| model.parameters(MODULUS);
    vec![
        (Box::new(maxwell), at(&maxwell)),
        (Box::new(norton), at(&norton)),
        (Box::new(gurevich), at(&gurevich)),
        (Box::new(zener.clone()), at(&zener)),
        (Box::new(flat.clone()), at(&flat)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Compares the columns of the Jacobian with central differences at random parameters.
    #[test]
    fn derivatives_are_those_of_the_response(shifts in prop::collection::vec(-0.3..0.3_f64, 4), velocity in 2.0..20.0_f64, radius in 0.0..3e-3_f64) {
        for (model, centre) in models() {
            let parameters: Vec<f64> = centre.iter().zip(&shifts).map(|(p, s)| p + s).collect();
            let samples = excitation(velocity);
            let history = SampledHistory::new(&samples, RATE).unwrap();
            let times: Vec<f64> = (0..150).map(|k| f64::from(k) / RATE).collect();
            let rod = DrivenRod {
                length: LENGTH, density: DENSITY, sampling_rate_hz: RATE, samples: &samples, excitation: &history,
                times: &times, cell: CELL, temperature: None, lateral_inertia: radius * radius,
            };
            let exact = model.linearised_response(&rod, &parameters).unwrap();
            let step = 1e-4;
            for (index, column) in exact.by_parameter.iter().enumerate() {
                let moved = |sign: f64| {
                    let mut parameters = parameters.clone();
                    parameters[index] += sign * step;
                    model.response(&rod, &parameters).unwrap()
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                // sums of squares are compared, because a change of E moves the time levels of the
                // grid across samples, and the response has a kink there
                let square = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
                let differences = up.iter().zip(&down).map(|(up, down)| (up - down) / (2.0 * step));
                let apart = square(&mut differences.zip(column).map(|(difference, c)| difference - c));
                let all = square(&mut column.iter().copied()).max((1e-6 * velocity).powi(2));
                prop_assert!(apart < 1e-6 * all, "{} {index}: {}", model.name(), (apart / all).sqrt());
            }
        }
    }

    /// Checks that a rod scaled by the factors L in length and T in time has the scaled response,
    /// with moduli scaled by (L/T)² and relaxation times by T.
    #[test]
    fn units_of_length_and_time_are_no_part_of_the_rod(powers in [-6..6_i32, -6..6_i32]) {
        let [length, time] = powers.map(|p| 2.0_f64.powi(p));
        let stress = (length / time).powi(2);
        let zener = LinearModel::new(MaxwellBranches::zener());
        let at = zener.parameters(MODULUS);
        let mut scaled = at.clone();
        scaled[0] += stress.ln();
        *scaled.last_mut().unwrap() += time.ln();
        let maxwell = Maxwell::from_reference_rate(20.0, STRESS).unwrap();
        // r = σ_ref/η at the same reference stress: η scales with stress and time
        let of_maxwell = maxwell.parameters(MODULUS);
        let scaled_maxwell = vec![of_maxwell[0] + stress.ln(), of_maxwell[1] - (stress * time).ln()];
        for (model, one, other) in [
            (&zener as &dyn RodModel, at, scaled),
            (&maxwell as &dyn RodModel, of_maxwell, scaled_maxwell),
        ] {
            let plain = response(model, &one, 10.0, 1.0, 1.0);
            let scaled = response(model, &other, 10.0, length, time);
            for (a, b) in plain.iter().zip(&scaled) {
                // tolerance: rounding of the logarithm of the modulus changes the phase of a wave
                prop_assert!((a * length / time - b).abs() < 1e-9 * 10.0 * length / time, "{}", model.name());
            }
        }
    }

    /// Checks that the response of a linear law is proportional to the excitation.
    #[test]
    fn linear_laws_superpose(power in -40..40_i32) {
        let factor = 2.0_f64.powi(power);
        for (model, parameters) in models() {
            if !model.is_linear() {
                continue;
            }
            let one = response(&*model, &parameters, 1.0, 1.0, 1.0);
            let other = response(&*model, &parameters, factor, 1.0, 1.0);
            for (a, b) in one.iter().zip(&other) {
                prop_assert!((a * factor - b).abs() <= 1e-12 * factor, "{}", model.name());
            }
        }
    }
}

/// Checks that responses are finite for loss factors from 1e-300 to 1e300 and rods from 1 mm to 1
/// km, and finite or refused for extreme parameters and cells.
#[test]
fn responses_stay_finite_at_the_ends() {
    let flat = LinearModel::new(ConstantQ::default());
    for loss_factor in [1e-300, 1e-9, 1e-3, 0.5, 10.0, 1e300] {
        let parameters = [MODULUS.ln(), f64::ln(loss_factor)];
        for length in [2.5e-3, 1.0, 2.5e3] {
            let found = response(&flat, &parameters, 10.0, length, length);
            assert!(
                found.iter().all(|v| v.is_finite()),
                "{loss_factor} {length}"
            );
        }
    }
    let samples = excitation(10.0);
    let history = SampledHistory::new(&samples, RATE).unwrap();
    let answered = |model: &dyn RodModel, parameters: &[f64], cell: f64| {
        let rod = DrivenRod {
            length: LENGTH,
            density: DENSITY,
            sampling_rate_hz: RATE,
            samples: &samples,
            excitation: &history,
            times: &[0.0, 1e-3],
            cell,
            temperature: None,
            lateral_inertia: 0.0,
        };
        model.response(&rod, parameters)
    };
    for (model, parameters) in models() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
            for index in 0..parameters.len() {
                let mut parameters = parameters.clone();
                parameters[index] = bad;
                if let Some(found) = answered(&*model, &parameters, CELL) {
                    assert!(
                        found.iter().all(|v| v.is_finite()),
                        "{} {index} {bad}",
                        model.name()
                    );
                }
            }
        }
        for cell in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-300, 1e-12] {
            // a law that is solved in the Laplace domain has no grid
            let has_grid = !model.name().contains('Q') && model.name() != "Zener";
            assert!(
                !has_grid || answered(&*model, &parameters, cell).is_none(),
                "{} with a cell of {cell}",
                model.name()
            );
        }
    }
}
