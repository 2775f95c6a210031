//! Table 1 of paper A, as far as it survives and as it is reconstructed.

use std::f64::consts::FRAC_PI_2;

use cmod::branch::{Branch, BranchTracker, FreeEnd, FreeEndRoot, PhaseRecord, resolve};
use num_complex::Complex64;

use super::rig::{Clean, flat, golden, rods_of_paper_a};

#[test]
fn every_quarter_turn_has_its_integers() {
    let table = golden("paper_a_table_1_branches.ron");
    assert_eq!(table.rows.len(), 7);
    for row in table.rows {
        let integer = |name: &str| row.values[name].value as i64;
        let quarter = u32::try_from(integer("quarter_turn")).unwrap();
        let branch = Branch::in_quadrant(quarter);
        assert_eq!(i64::from(branch.sign()), integer("s"), "{}", row.label);
        assert_eq!(
            i64::from(branch.half_waves()),
            integer("n"),
            "{}",
            row.label
        );
        for part in [0.1, 0.5, 0.9] {
            let exact = Complex64::new(0.2, FRAC_PI_2 * (f64::from(quarter) + part));
            let ratio = exact.cosh();
            let sign = |value: f64| if value > 0.0 { "+" } else { "-" };
            assert_eq!(sign(ratio.re), row.text["cos_phase"], "{}", row.label);
            assert_eq!(sign(ratio.im), row.text["sin_phase"], "{}", row.label);
            assert!((FreeEndRoot::of(ratio).on(branch) - exact).norm() < 1e-13);
        }
    }
}

/// A specimen without accelerometer, line by line: the integers are those of the quadrant of the exact kL.
#[test]
fn the_integers_of_a_record_are_those_of_its_quadrants() {
    let mut rod = rods_of_paper_a()[5];
    rod.accelerometer = 0.0;
    let lines = (1..=800).map(|j| 25.0 * f64::from(j)).collect();
    let clean = Clean::of(&flat(rod.density, 0.07), rod, lines);
    let roots = resolve(&clean.frequency_hz, &clean.ratio).unwrap();
    let tracked = BranchTracker::new()
        .track(&[PhaseRecord {
            observation: &FreeEnd,
            length: rod.length,
            frequency_hz: &clean.frequency_hz,
            observed: &clean.ratio,
            variance: None,
        }])
        .unwrap();
    for (index, exact) in clean.exact.iter().enumerate() {
        let quadrant = (exact.im / FRAC_PI_2) as u32;
        assert_eq!(roots[index].branch, Branch::in_quadrant(quadrant));
        assert_eq!(tracked.records[0][index].branch(), roots[index].branch);
        assert!((roots[index].gamma_length - exact).norm() < 1e-10);
        assert_eq!(roots[index].doubt, None);
    }
}
