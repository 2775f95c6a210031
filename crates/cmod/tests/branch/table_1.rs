//! Table 1 of paper A, both the part that is legible in print and the reconstructed part.

use std::f64::consts::FRAC_PI_2;

use cmod::branch::{Branch, BranchTracker, FreeEnd, FreeEndRoot, PhaseRecord, resolve};
use num_complex::Complex64;
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use super::rig::{Clean, rods_of_paper_a};
use crate::golden::golden;
use crate::materials::flat;

/// Compares with the integers of paper B, table 1, which equal those of paper A.
#[test]
fn every_quarter_turn_has_its_integers() {
    let rows = golden("paper_a_table_1_branches.ron");
    assert_eq!(rows.len(), 7);
    for row in rows {
        let quarter = row.value("quarter_turn") as u32;
        let branch = Branch::in_quadrant(quarter);
        let found = [f64::from(branch.sign()), f64::from(branch.half_waves())];
        assert_eq!(
            found,
            ["s", "n"].map(|name| row.value(name)),
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

/// Checks the integers of a specimen without accelerometer, line by line.
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
    assert!(roots.iter().all(|root| root.doubt.is_none()));
    let lines = || roots.iter().zip(&clean.exact);
    let wrong = lines()
        .zip(&tracked.records[0])
        .filter(|((root, exact), line)| {
            let right = Branch::in_quadrant((exact.im / FRAC_PI_2) as u32);
            root.branch != right || line.branch() != right
        });
    let mut claims = Claims::default();
    claims.by("paper A, Table 1 (layout lost in print, restored)");
    claims.claim(
        "800 lines up to 20 kHz, each alone and tracked: lines with other integers s or n",
        "1",
        0.0,
        Within(0.5, "a count"),
        Ok(wrong.count() as f64),
    );
    claims.by("paper A, eqs. 3 and 4: cosh(gamma L) = Psi");
    claims.deviation(
        "closed form along a record without mass, 25 Hz to 20 kHz",
        Within(
            3e-13,
            "rounding of the transition matrix, amplified near kL = n pi",
        ),
        Ok(largest(
            lines().map(|(root, exact)| relative(root.gamma_length, *exact)),
        )),
    );
    claims.by("paper A, eq. 4 (as printed, its differences lose digits)");
    claims.deviation(
        "closed form: damping of 1e-6 at kL from 0.3 to 9, away from n pi",
        Within(1e-12, "some thousand roundings of Psi"),
        Ok(largest((0..30).map(small_damping))),
    );
    hold!(claims);
}

/// Returns the relative error of αL = 1e-6 at kL = 0.3 (j + 1).
fn small_damping(j: u32) -> f64 {
    let damping = 1e-6;
    let angle = 0.3 * f64::from(j + 1);
    if angle.sin().abs() < 0.1 {
        return 0.0;
    }
    // for 1e-6, cosh is 1 + x²/2 and sinh is x to all digits of a double
    let ratio = Complex64::new(
        (1.0 + 0.5 * damping * damping) * angle.cos(),
        damping * angle.sin(),
    );
    let branch = Branch::in_quadrant((angle / FRAC_PI_2) as u32);
    FreeEndRoot::of(ratio).on(branch).re / damping - 1.0
}
