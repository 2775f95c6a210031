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

#[test]
fn experiment() {
    let truth = MaxwellNorton::from_reference_rate(2.0, 3.0, 10e6).unwrap();
    for (slow, fast) in [(5.0, 10.0), (4.0, 16.0)] {
        let exact = [by_the_chain(&truth, slow), by_the_chain(&truth, fast)];
        let t = std::time::Instant::now();
        for seed in 0..3 {
            let tests = [noisy(&exact[0], 0.01, 2 * seed), noisy(&exact[1], 0.01, 2 * seed + 1)];
            let selection =
                Selection::new(Candidate::standard(), NoiseLevels::known(0.01, 0.01)).unwrap();
            let c = selection.compare(&tests).unwrap();
            println!("{slow} {fast} {:?} infl {:.2} neff {:.0}", c.decision, c.inflation, c.effective_samples);
            for law in &c.laws {
                println!("   {:30} chi2 {:8.1} adeq {:.3} lnZ {:9.2} P {:.4} det {:.1} {:?} {:?}", law.name, law.chi_square, law.adequacy.unwrap(), law.ln_evidence, law.probability, law.determined, law.termination, law.parameters);
            }
        }
        println!("{:?}", t.elapsed());
    }
    let exact = by_the_line(&constant_q_stack(0.07), 10.0);
    for seed in 0..2 {
        let t = std::time::Instant::now();
        let selection =
            Selection::new(Candidate::standard(), NoiseLevels::known(0.01, 0.01)).unwrap();
        let c = selection.compare(&[noisy(&exact, 0.01, seed)]).unwrap();
        println!("{:?} infl {:.2} neff {:.0}", c.decision, c.inflation, c.effective_samples);
        for law in &c.laws {
            println!("   {:30} chi2 {:8.1} adeq {:.3} lnZ {:9.2} P {:.4} det {:.1} {:?} {:?}", law.name, law.chi_square, law.adequacy.unwrap(), law.ln_evidence, law.probability, law.determined, law.termination, law.parameters);
        }
        println!("{:?}", t.elapsed());
    }
    let _ = in_parallel(&[1], |x| *x);
}
