//! Test that no nonlinear law is named for linear rods of constant loss factor, struck at one
//! velocity.

use crate::virtual_tests;

use maxwellid::selection::Candidate;
use rodwave::modulus::ComplexModulus;
use testbed::noise::draws;
use virtual_tests::{MODULUS, by_the_line, compare, constant_q_stack, in_parallel, named};

const LOSS_FACTORS: [f64; 4] = [0.03, 0.05, 0.07, 0.10];

/// Checks that the material of the simulation has a loss factor constant to 1 % from 0.2 to 20 kHz,
/// and the modulus of Kjartansson's law to 0.2 %.
#[test]
fn the_stack_of_branches_has_a_constant_loss_factor() {
    let reference = std::f64::consts::TAU * 4e3;
    for loss_factor in LOSS_FACTORS {
        let stack = constant_q_stack(loss_factor);
        let law = rodwave::modulus::ConstantQ::new(MODULUS, loss_factor, reference).unwrap();
        for k in 0..=40 {
            let omega = std::f64::consts::TAU * 200.0 * 10.0_f64.powf(f64::from(k) / 20.0);
            let (found, expected) = (stack.at(omega), law.at(omega));
            let loss = found.im / found.re;
            assert!((loss / loss_factor - 1.0).abs() < 0.01, "{omega} {loss}");
            let ratio = found.norm() / expected.norm();
            assert!((ratio - 1.0).abs() < 0.002, "{omega} {ratio}");
        }
    }
}

/// Checks one record of each loss factor; `claims/selection.rs` has six more records of one loss
/// factor. If a fault gave a nonlinear verdict for a quarter of such records, the ten records
/// together would miss it with a probability of 6 %. `SEEDS=100` evaluates a hundred records.
#[test]
fn constant_q_at_one_velocity_is_not_called_nonlinear() {
    let exact = LOSS_FACTORS.map(|loss| [by_the_line(&constant_q_stack(loss), 10.0)]);
    let cases: Vec<u64> = (0..draws(4)).collect();
    let comparisons = in_parallel(&cases, |case| {
        let material = usize::try_from(case % 4).unwrap();
        compare(Candidate::standard(), &exact[material], *case)
    });
    let nonlinear = comparisons
        .iter()
        .filter(|c| c.is_nonlinear_verdict())
        .count();
    assert_eq!(nonlinear, 0);
    // the right law is not refuted, which would happen by chance in 0.1 % of the records
    let refuted = comparisons.iter().filter(|c| named(c) == "none").count();
    assert_eq!(refuted, 0);
    for comparison in &comparisons {
        assert!(comparison.nonlinear_probability < 1e-6, "{comparison:?}");
    }
}
