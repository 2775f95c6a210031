//! Code that runs millions of times allocates no memory: the steps of a march, and a chain at one
//! frequency. An allocator counts the allocations of the thread; everything is built before the
//! counting starts.

use std::hint::black_box;

use allocation_counter::measure;
use num_complex::Complex64;
use rodwave::chain::AnalyticChain;
use rodwave::inelastic::{
    Elastic, Eyring, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use rodwave::line::{Body, End, Line, Segment};
use rodwave::medium::Medium;
use rodwave::modulus;
use rodwave::{Chain, DirectProblem, InelasticRod, Termination};

use crate::bodies::{aluminium, circle, nylon, polypropylene, prony, steel};

#[test]
fn the_allocator_counts() {
    assert_eq!(measure(|| drop(black_box(vec![1.0; 8]))).count_total, 1);
}

/// Checks that a march allocates no memory from its first step until its windows have returned to
/// the start of their buffers, while the results are read at each step.
fn march_allocates_nothing<L: InelasticLaw>(law: &L) {
    for (cells, velocity) in [(8, 9.0), (47, 9.0), (400, 9.0), (100, 60.0)] {
        let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law.clone()).unwrap();
        let problem = DirectProblem::new(rod, cells).unwrap();
        let mut march = problem.march(velocity);
        let mut sum = 0.0;
        let allocated = measure(|| {
            for _ in 0..3000 {
                march.advance(black_box(velocity));
                sum += march.free_end_velocity() + march.energy().dissipated;
            }
            sum += march.state().map(|node| node.stress).sum::<f64>();
        });
        assert!(sum.is_finite(), "{law:?}");
        assert_eq!(allocated.count_total, 0, "{law:?}, {cells} cells");
    }
}

#[test]
fn a_march_allocates_nothing() {
    march_allocates_nothing(&Elastic);
    march_allocates_nothing(&Maxwell::new(4e6).unwrap());
    march_allocates_nothing(&MaxwellNorton::new(2.108, 7e13).unwrap());
    march_allocates_nothing(&MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap());
    march_allocates_nothing(&Eyring::new(0.3, 2.5e6).unwrap());
    // the rare cases: steps too long for the series, stresses that vanish in finite time, a
    // viscosity that grows with stress
    march_allocates_nothing(&MaxwellNorton::from_reference_rate(0.6, 1e4, 10e6).unwrap());
    march_allocates_nothing(&MaxwellGurevichRabinovich::new(1e3, 5e6).unwrap());
    march_allocates_nothing(
        &MaxwellGurevichRabinovich::from_reference_rate(-1.5, 300.0, 10e6).unwrap(),
    );
}

#[test]
fn a_line_allocates_nothing() {
    let segment = || Segment::new(0.2, 2e-4, 910.0).unwrap();
    let norton = MaxwellNorton::new(2.108, 7e13).unwrap();
    let several = segment()
        .with_branch(2e9, Elastic)
        .unwrap()
        .with_branch(4e8, Maxwell::new(4e5).unwrap())
        .unwrap()
        .with_branch(3e8, norton)
        .unwrap();
    let single = segment().with_branch(2.58e9, norton).unwrap();
    let striker = Segment::elastic(0.1, 2e-4, 2700.0, 69e9).unwrap();
    let bodies = [
        Body::new([striker]).unwrap().moving_at(9.0).unwrap(),
        Body::new([several, single]).unwrap(),
    ];
    let line = Line::new(bodies).unwrap().with_gap(0, 1e-4).unwrap();
    let line = line.with_right_end(End::Mass(0.02)).unwrap();
    let mut march = line.march(1e-6).unwrap();
    let mut sum = 0.0;
    let allocated = measure(|| {
        for _ in 0..3000 {
            march.advance().unwrap();
            sum += march.contact_force(0) + march.ledger().stored;
        }
    });
    assert!(sum > 0.0);
    assert_eq!(allocated.count_total, 0);
}

/// Builds a body with every kind of element and laws of every kind: closed forms, sums, powers, a
/// table, measured waves.
fn body(termination: Termination) -> Chain {
    let (thin, thick) = (circle(0.02), circle(0.05));
    let prony = Medium::new(912.0, prony(2e9, &[(4e8, 1e-3), (5e8, 1e-5)])).unwrap();
    let lines = [(2.4e9, 1.6e8), (2.6e9, 1.5e8), (2.8e9, 1.5e8)];
    let lines = lines.map(|(re, im)| Complex64::new(re, im));
    let table = modulus::Tabulated::new(&[1e3, 1e4, 1e5], &lines).unwrap();
    let table = Medium::new(1000.0, table.held()).unwrap();
    let fractional = modulus::FractionalZener::new(1e9, 3e9, 1e-4, 0.4).unwrap();
    let fractional = Medium::new(950.0, fractional).unwrap();
    Chain::from_impact_face()
        .rod(&aluminium(), thin, 0.1)
        .cone(&prony, thin, thick, 0.2)
        .horn(&polypropylene(), thick, thin, 0.1)
        .mass(0.01)
        .rod(&table, thin, 0.1)
        .spring(1e7)
        .rod(&nylon(), thin, 0.1)
        .dashpot(1e3)
        .rod(&fractional, thin, 0.1)
        .end(termination)
        .unwrap()
}

#[test]
fn a_chain_at_one_frequency_allocates_nothing() {
    for termination in [
        Termination::Free,
        Termination::Fixed,
        Termination::Mass(0.3),
        Termination::Dashpot(80.0),
        Termination::impedance(|omega| Complex64::new(3.0, omega)),
        Termination::semi_infinite(&steel(), circle(0.02)),
    ] {
        let name = format!("{termination:?}");
        let body = body(termination);
        let section = body.section(2, 0.03).unwrap();
        let mut sum = Complex64::ZERO;
        let allocated = measure(|| {
            for step in 1_u32..200 {
                let omega = 400.0 * f64::from(step);
                sum += body.mobility(omega).unwrap() + body.far_face_mobility(omega).unwrap();
                sum += body.transition_matrix(omega).unwrap().determinant();
                sum += section.state(omega).unwrap().velocity;
                sum += section.waves(omega).unwrap().at(0.01);
            }
        });
        assert!(sum.is_finite(), "{name}");
        assert_eq!(allocated.count_total, 0, "{name}");
    }
}

#[test]
fn an_analytic_chain_at_one_complex_s_allocates_nothing() {
    let law = modulus::HavriliakNegami::new(1e9, 3e9, 1e-4, 0.6, 0.8).unwrap();
    let medium = Medium::new(1000.0, law).unwrap();
    let rod = AnalyticChain::analytic_from_impact_face()
        .rod(&medium, circle(0.02), 0.5)
        .mass(0.1)
        .end(Termination::Free)
        .unwrap();
    let section = rod.section(0, 0.2).unwrap();
    let mut sum = Complex64::ZERO;
    let allocated = measure(|| {
        for step in 0_u32..200 {
            let s = Complex64::new(300.0, 400.0 * f64::from(step));
            sum += rod.mobility_at_s(s).unwrap() + rod.far_face_mobility_at_s(s).unwrap();
            sum += section.state_at_s(s).unwrap().velocity;
        }
    });
    assert!(sum.is_finite());
    assert_eq!(allocated.count_total, 0);
}
