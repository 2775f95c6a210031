//! Lumped chain and characteristics, compared with `scipy.integrate.solve_ivp`:
//! `fixtures/reference/solve_ivp`.

use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::lumped::LumpedRod;
use rodwave::{DirectProblem, InelasticRod};
use testbed::difference::largest_difference;

use crate::bodies::PULSE;

const CHAIN: &str = include_str!("../../../fixtures/reference/solve_ivp/chain.csv");
const CONTINUUM: &str = include_str!("../../../fixtures/reference/solve_ivp/continuum.csv");

struct Reference {
    times: Vec<f64>,
    velocity: Vec<f64>,
    /// Error of the reference [m/s], estimated by the script.
    error: f64,
}

fn reference(table: &str, law: &str) -> Reference {
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .filter_map(|line| line.strip_prefix(law)?.strip_prefix(','))
        .map(|rest| rest.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 60, "{law}");
    Reference {
        times: rows.iter().map(|row| row[0]).collect(),
        velocity: rows.iter().map(|row| row[1]).collect(),
        error: rows[0][2],
    }
}

fn rod<L: InelasticLaw>(law: L) -> InelasticRod<L> {
    InelasticRod::new(0.4, 1100.0, 2.5e9, law).unwrap()
}

/// Extrapolation (4 fine - coarse)/3 for an error that decreases with the square of the step.
fn extrapolated(fine: &[f64], coarse: &[f64]) -> Vec<f64> {
    let pairs = fine.iter().zip(coarse);
    pairs.map(|(f, c)| (4.0 * f - c) / 3.0).collect()
}

/// Checks that the error of `solve` is of second order in the step, and that the extrapolation from
/// two steps is within `tolerance` of the reference.
fn converges(
    name: &str,
    reference: &Reference,
    steps: [usize; 2],
    tolerance: f64,
    solve: impl Fn(usize) -> Vec<f64>,
) {
    let [coarse, fine] = steps.map(solve);
    let ratio = largest_difference(&coarse, &reference.velocity)
        / largest_difference(&fine, &reference.velocity);
    assert!((3.5..4.5).contains(&ratio), "{name}: {ratio}");
    let left = largest_difference(&extrapolated(&fine, &coarse), &reference.velocity);
    assert!(left < tolerance + reference.error, "{name}: {left:e} m/s");
}

/// Compares the chain with sixty masses integrated by `solve_ivp`: only the second-order error of
/// the time step of the leapfrog scheme remains. The dispersion of the cells is the same in both.
#[test]
fn the_lumped_chain_is_its_differential_equations() {
    fn check<L: InelasticLaw>(name: &str, law: L) {
        let reference = reference(CHAIN, name);
        // with steps of a sixteenth and a 32nd of the transit of a cell, the errors are 6e-4 m/s
        // and a quarter of it; tolerance: the fourth order that remains after the extrapolation,
        // about 1e-4 of these errors
        converges(name, &reference, [16, 32], 1e-7, |parts| {
            LumpedRod::new(&rod(law.clone()), 60, 1.0 / parts as f64)
                .unwrap()
                .free_end_velocity(&PULSE, &reference.times)
                .unwrap()
        });
    }
    check("maxwell", Maxwell::new(4e6).unwrap());
    check("norton", MaxwellNorton::new(2.108, 7e13).unwrap());
    check(
        "gurevich",
        MaxwellGurevichRabinovich::new(8e6, 7e6).unwrap(),
    );
}

/// Compares the characteristics with the continuous rod, whose reference uses collocation in space,
/// neither cells nor characteristics.
#[test]
fn characteristics_converge_to_the_collocated_rod() {
    fn check<L: InelasticLaw>(name: &str, law: L) {
        let reference = reference(CONTINUUM, name);
        // with 50 and 100 cells, the errors are 7e-5 to 1e-3 m/s and a quarter of them; tolerance:
        // the fourth order that remains is about the square of this error over 16 m/s
        converges(name, &reference, [50, 100], 1e-6, |cells| {
            DirectProblem::new(rod(law.clone()), cells)
                .unwrap()
                .free_end_velocity(&PULSE, &reference.times)
                .unwrap()
        });
    }
    check("maxwell", Maxwell::new(4e6).unwrap());
    check("norton", MaxwellNorton::new(2.108, 7e13).unwrap());
    check(
        "gurevich",
        MaxwellGurevichRabinovich::new(8e6, 7e6).unwrap(),
    );
}
