//! Linear rods of constant loss factor, struck at one velocity: no nonlinear law is named.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a failing test should say so at once"
)]

mod virtual_tests;

use maxwellid::selection::{Candidate, Comparison, Selection};
use rodwave::modulus::ComplexModulus;
use virtual_tests::{by_the_line, constant_q_stack, in_parallel, noisy};

const LOSS_FACTORS: [f64; 4] = [0.03, 0.05, 0.07, 0.10];

/// What the generator is called: a loss factor constant to 1 % from 0.2 to 20 kHz, the modulus to 0.2 % that of Kjartansson.
#[test]
fn the_stack_of_branches_has_a_constant_loss_factor() {
    for loss_factor in LOSS_FACTORS {
        let stack = constant_q_stack(loss_factor);
        let law = rodwave::modulus::ConstantQ::new(2.6e9, loss_factor, std::f64::consts::TAU * 4e3)
            .unwrap();
        for k in 0..=40 {
            let omega = std::f64::consts::TAU * 200.0 * 10.0_f64.powf(f64::from(k) / 20.0);
            let (found, expected) = (stack.at(omega), law.at(omega));
            let loss = found.im / found.re;
            assert!((loss / loss_factor - 1.0).abs() < 0.01, "{omega} {loss}");
            assert!(
                (found.norm() / expected.norm() - 1.0).abs() < 0.002,
                "{omega} {found} {expected}"
            );
        }
    }
}

fn compare(candidates: Vec<Candidate>, index: usize) -> Comparison {
    let exact = by_the_line(&constant_q_stack(LOSS_FACTORS[index % 4]), 10.0);
    let test = noisy(&exact, 0.01, u64::try_from(index).unwrap());
    Selection::new(candidates)
        .unwrap()
        .with_cell(8e-3)
        .unwrap()
        .compare(&[test])
        .unwrap()
}

#[test]
fn constant_q_at_one_velocity_is_never_called_nonlinear() {
    let cases: Vec<usize> = (0..24).collect();
    let t = std::time::Instant::now();
    let comparisons = in_parallel(&cases, |case| compare(Candidate::standard(), *case));
    println!("{:?}", t.elapsed());
    for c in &comparisons {
        println!(
            "{:?} {:?}",
            c.decision,
            c.laws.iter().map(|l| l.chi_square).collect::<Vec<_>>()
        );
    }
    let nonlinear = comparisons
        .iter()
        .filter(|c| c.is_nonlinear_verdict())
        .count();
    assert!(nonlinear <= 1, "{nonlinear}");
}
