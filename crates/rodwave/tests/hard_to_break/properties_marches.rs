//! Properties of marches for any material: balances, scaling, delay and superposition.

use proptest::prelude::*;
use rodwave::band_limited::SampledHistory;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{
    InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
};
use rodwave::line::{Body, Drive, End, Line, Segment};
use rodwave::synthesis::DampedSynthesis;
use rodwave::{DirectProblem, InelasticRod};

use num_complex::Complex64;

use super::cases;

/// Smooth pulse of 60 µs with the maximum 1.
fn push(time: f64) -> f64 {
    if (0.0..=60e-6).contains(&time) {
        (std::f64::consts::PI * time / 60e-6).sin().powi(2)
    } else {
        0.0
    }
}

proptest! {
    #![proptest_config(cases(48, 3))]

    /// Checks that a striker and a rod exchange momentum and lose none. Energy is lost in the
    /// material and, to a small extent, when the contact closes; none is created.
    #[test]
    fn impacts_keep_momentum(
        length in 0.01..0.1_f64, diameter in 0.005..0.03_f64, density in 900.0..9000.0_f64, modulus in 9.0..11.5_f64,
        velocity in 0.1..30.0_f64, rate in -1.0..2.5_f64,
    ) {
        let test = ImpactTest {
            striker: Striker { length, diameter, density, modulus: 10f64.powf(modulus), velocity },
            rod: InelasticRod::new(0.3, 1140.0, 3.2e9, Maxwell::from_reference_rate(10f64.powf(rate), 1e7).unwrap()).unwrap(),
            diameter: 0.016,
            section_distance: 0.1,
        };
        // cells short enough for both bodies
        let speeds = (10f64.powf(modulus) / density).sqrt() / (3.2e9_f64 / 1140.0).sqrt();
        let cell = (0.2 * length / speeds).min(4e-3).min(length / 8.0);
        let history = test.run(cell, 3e-4).unwrap();
        let balance = history.balance;
        // tolerance: rounding of sums over thousands of steps
        prop_assert!(balance.momentum_residual.abs() < 1e-10, "{balance:?}");
        let after = balance.energy_after + balance.energy_dissipated;
        // tolerance: the staggered grid conserves energy to second order in the Courant number
        prop_assert!(after <= 1.02 * balance.energy_before, "{balance:?}");
        prop_assert!(balance.energy_dissipated >= -1e-9 * balance.energy_before);
        prop_assert!(history.contact_force.iter().all(|force| *force >= 0.0));
    }
}

/// Checks steps so long, or exponents so high, that powers overflow. For κ → ∞ the law is perfectly
/// plastic, and the stress falls to σ_ref (n E h r/σ_ref)^{-1/n}, whatever its initial value is.
#[test]
fn very_nonlinear_laws_do_not_overflow() {
    for exponent in [30.0, 300.0, 3e3, 1e5] {
        let law = MaxwellNorton::from_reference_rate(exponent, 1e3, 1e7).unwrap();
        let flow = law.flow(3e9, 1e-6);
        let n = exponent - 1.0;
        let expected = 1e7 * (-((n * 3e9 * 1e-6 * 1e3 / 1e7_f64).ln() / n)).exp();
        for stress in [3e8, 1e12, 1e40] {
            let found = flow.relax(stress);
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "κ = {exponent}: {found:e} {expected:e}"
            );
            let mut by_parameter = [0.0; 2];
            let with = flow.relax_with_sensitivity(stress, &mut by_parameter);
            assert!(with.stress.is_finite() && by_parameter.iter().all(|value| value.is_finite()));
            // derivative of σ1 with respect to ln r: -1/n times σ1
            assert!((by_parameter[1] * n / found + 1.0).abs() < 1e-9);
            let changed = |kappa: f64| {
                MaxwellNorton::from_reference_rate(kappa, 1e3, 1e7)
                    .unwrap()
                    .flow(3e9, 1e-6)
                    .relax(stress)
            };
            let h = 1e-4 * exponent;
            let difference = (changed(exponent + h) - changed(exponent - h)) / (2.0 * h);
            assert!(
                (by_parameter[0] - difference).abs()
                    <= 1e-5 * difference.abs() + 1e-7 * found / exponent
            );
        }
    }
    // a viscosity so low that the stress vanishes
    for rate in [1e12, 1e20, 1e60] {
        let law = MaxwellGurevichRabinovich::from_reference_rate(2.0, rate, 1e7).unwrap();
        let relaxed = law.flow(3e9, 1e-6).relax(1e7);
        assert!((0.0..1e-100).contains(&relaxed), "{relaxed}");
    }
}

/// Checks that the test reports the energy that an explicit chain creates if a material relaxes
/// within one step, and that shorter cells avoid it.
#[test]
fn stiff_impacts_are_refused() {
    let test = ImpactTest {
        striker: Striker::PAPER_D,
        // a relaxation time of 1e7/(3.2e9 · 1e4) s = 0.3 µs
        rod: InelasticRod::new(
            0.3,
            1140.0,
            3.2e9,
            Maxwell::from_reference_rate(1e4, 1e7).unwrap(),
        )
        .unwrap(),
        diameter: 0.016,
        section_distance: 0.1,
    };
    let error = test.run(2e-3, 3e-4).unwrap_err().to_string();
    assert!(error.starts_with("energy "), "{error}");
    let balance = test.run(3e-4, 1e-4).unwrap().balance;
    assert!(
        balance.momentum_residual.abs() < 1e-10 && balance.energy_after < balance.energy_before
    );
}

/// Checks that, in a linear rod, twice the excitation causes exactly twice the response, and the
/// response to two excitations is the sum of their responses.
#[test]
fn linear_rods_superpose() {
    // waves of 2000 m/s: a step is 1 µs and a sample 5 µs, so that a delay by samples is a delay by
    // whole steps
    let rod = || InelasticRod::new(0.4, 1140.0, 1140.0 * 4e6, Maxwell::new(2e6).unwrap()).unwrap();
    let samples = |scale: f64, late: usize| -> Vec<f64> {
        (0..120_usize)
            // at rest at first, so that both records contain the ringing of the interpolation
            // before the onset
            .map(|k| scale * push(k.saturating_sub(late + 24) as f64 * 5e-6))
            .collect()
    };
    let answer = |samples: &[f64]| {
        let history = SampledHistory::new(samples, 2e5).unwrap();
        let times: Vec<f64> = (0..100).map(|k| 5e-6 * f64::from(k)).collect();
        let problem = DirectProblem::new(rod(), 200).unwrap();
        problem.free_end_velocity(&history, &times).unwrap()
    };
    let (one, two) = (answer(&samples(1.0, 0)), answer(&samples(2.0, 0)));
    assert!(one.iter().zip(&two).all(|(one, two)| 2.0 * one == *two));
    let late = answer(&samples(1.0, 17));
    let sum: Vec<f64> = samples(1.0, 0)
        .iter()
        .zip(samples(1.0, 17))
        .map(|(a, b)| a + b)
        .collect();
    for ((one, late), both) in one.iter().zip(&late).zip(answer(&sum)) {
        assert!((one + late - both).abs() < 1e-13);
    }
    // a pulse that begins 17 samples later causes the same response 17 samples later, to the
    // rounding of the times
    for (k, value) in one.iter().enumerate().take(80) {
        assert!(
            (late[k + 17] - value).abs() < 1e-10,
            "{k}: {} {value}",
            late[k + 17]
        );
    }
}

/// Checks that a nonlinear march scales if lengths, times and masses are scaled by powers of two.
#[test]
fn marches_scale() {
    let run = |metre: f64, second: f64, kilogram: f64| {
        let pascal = kilogram / (metre * second * second);
        let law = MaxwellNorton::from_reference_rate(3.0, 1e3 / second, 1e7 * pascal).unwrap();
        let density = 1140.0 * (kilogram / metre.powi(3));
        let rod = InelasticRod::new(0.4 * metre, density, 3.2e9 * pascal, law).unwrap();
        let problem = DirectProblem::new(rod, 64).unwrap();
        let mut march = problem.march(0.0);
        let mut history = Vec::new();
        for n in 0..300 {
            march.advance(10.0 * push(f64::from(n) * 1e-6) * metre / second);
            history.push(march.free_end_velocity() * second / metre);
        }
        history
    };
    let here = run(1.0, 1.0, 1.0);
    for (metre, second, kilogram) in [
        (1024.0, 1.0, 1.0),
        (1.0, 2f64.powi(-20), 1.0),
        (0.25, 4.0, 2f64.powi(30)),
    ] {
        for (one, other) in here.iter().zip(run(metre, second, kilogram)) {
            // wave speed and impedance are computed by a square root, which rounds equally for even
            // powers of two
            assert!((one - other).abs() <= 1e-13 * 10.0, "{one} {other}");
        }
    }
}

/// Checks a synthesis with a period of ten million samples, and a march of a million steps.
#[test]
fn long_records() {
    let synthesis = DampedSynthesis::new(10.0, 2e-6).unwrap();
    let lines: Vec<Complex64> = synthesis.arguments().map(|s| 1.0 / (s + 3.0)).collect();
    assert_eq!(lines.len(), 5_000_001);
    // e^{-3t}, with half of its jump in the sample at 0
    let history = synthesis.history(&lines).unwrap();
    for index in [1000, 500_000, 2_000_000] {
        let time = history.time(index);
        let found = history.samples[index];
        assert!(
            (found - (-3.0 * time).exp()).abs() < 1e-3,
            "{time}: {found}"
        );
    }
    let bar = Segment::elastic(0.01, 1e-4, 7800.0, 2e11).unwrap();
    let line = Line::new([Body::new([bar]).unwrap()])
        .unwrap()
        .with_left_end(End::Force(Drive::of(|t| 100.0 * push(t))))
        .unwrap();
    let mut march = line.march(5e-7).unwrap();
    for _ in 0..1_000_000 {
        march.advance().unwrap();
    }
    let ledger = march.ledger();
    // tolerance: a million steps, each with a random rounding error
    assert!(ledger.energy_residual().abs() < 1e-11 * ledger.stored);
}
