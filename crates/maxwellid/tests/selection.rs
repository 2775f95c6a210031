//! Which law: no nonlinear verdict from one velocity on linear data, the right one from two, and doubts where they belong.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a failing test should say so at once"
)]

mod virtual_tests;

use maxwellid::selection::{Candidate, NoiseLevels, Selection};
use rodwave::inelastic::MaxwellNorton;
use virtual_tests::{by_the_chain, by_the_line, constant_q_stack, in_parallel, noisy};

fn selection() -> Selection {
    Selection::new(Candidate::standard(), NoiseLevels::known(0.01, 0.01))
        .unwrap()
        .with_cell(8e-3)
        .unwrap()
}

#[test]
fn norton() {
    let truth = MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap();
    for (slow, fast) in [(5.0, 15.0), (5.0, 20.0)] {
        let exact = [by_the_chain(&truth, slow), by_the_chain(&truth, fast)];
        let t = std::time::Instant::now();
        let cases: Vec<u64> = (0..16).collect();
        let r = in_parallel(&cases, |seed| {
            let tests = [
                noisy(&exact[0], 0.01, 2 * seed),
                noisy(&exact[1], 0.01, 2 * seed + 1),
            ];
            let c = selection().compare(&tests).unwrap();
            format!(
                "{:?} {:?}",
                c.decision,
                c.laws
                    .iter()
                    .map(|l| (l.chi_square, l.probability))
                    .collect::<Vec<_>>()
            )
        });
        for r in r {
            println!("{r}");
        }
        println!("{:?}", t.elapsed());
    }
}
#[test]
fn cq() {
    let t = std::time::Instant::now();
    let cases: Vec<u64> = (0..16).collect();
    let exact = [0.03, 0.05, 0.07, 0.1].map(|d| by_the_line(&constant_q_stack(d), 10.0));
    println!("{:?}", t.elapsed());
    let r = in_parallel(&cases, |seed| {
        let c = selection()
            .compare(&[noisy(&exact[*seed as usize % 4], 0.01, *seed)])
            .unwrap();
        format!(
            "{:?} {:?}",
            c.decision,
            c.laws
                .iter()
                .map(|l| (l.chi_square, l.probability))
                .collect::<Vec<_>>()
        )
    });
    for r in r {
        println!("{r}");
    }
    println!("{:?}", t.elapsed());
}
