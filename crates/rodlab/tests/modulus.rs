//! The job `modulus` on virtual records with known true values.
//!
//! The motions of the ends of the rod of paper A are computed by chain recursion and a damped
//! Fourier transform, pulses in a long rod by explicit integration of masses, springs and dashpots.
//! Neither uses the equations that the methods solve.

mod doubts;
mod ends;
mod gauges;

use crate::virtual_rod;

use std::f64::consts::TAU;
use std::fs;

use num_complex::Complex64;
use rodlab::Outcome;
use rodlab::outcome::{Cells, Verdict};
use virtual_rod::{RATE_HZ, SAMPLES};

use crate::runs::{Folder, Words, answered, column as numbers, doubts, json, quantity, table};

/// A sheet for the rod of paper A, with all hits in one long recording.
fn sheet(method: &str, rest: &str) -> String {
    format!(
        r#"Modulus(
    title: "Polypropylene, Test 6",
    specimen: (length: "799 mm ± 0.29 mm", diameter: "15.8 mm ± 0.03 mm", density: "912 kg/m3 ± 0.29 kg/m3",
        accelerometer_mass: "2.9 gram ± 0.03 gram"),
    // the waves of the rig are one-dimensional
    lateral_inertia: (poisson_ratio: "0"),
    method: {method},
    source: Hits(
        records: (
            files: ["hits.npy"],
            sampling_rate: "{RATE_HZ} Hz",
            channels: [
                (name: "struck end", from: 1, unit: "V", sensitivity: "0.5 mV/g"),
                (name: "free end", from: 2, unit: "V", sensitivity: "0.5 mV/g"),
            ],
        ),
        hits: (
            cut: Trigger(level: "2000 m/s2", length: "{SAMPLES} samples", pre_trigger: "1 ms"),
        ),
    ),
    {rest}
)"#
    )
}

/// A folder with `hits.npy`, which contains `count` hits on the rod.
fn hits(count: usize, seed: u64) -> Folder {
    let folder = Folder::new();
    virtual_rod::write_hits(folder.path(), count, seed);
    folder
}

const TWO_POINT: &str = r#"TwoPoint(impacted_end: "struck end", free_end: "free end")"#;
const BAND: &str = r#"band: (from: "50 Hz", to: "20 kHz"),"#;

fn is_valid(outcome: &Outcome) -> Vec<bool> {
    let table = table(outcome, "modulus");
    match &table.columns.last().unwrap().cells {
        Cells::Validity { valid, words, .. } => {
            let said: Vec<bool> = words.iter().map(|word| word == "valid").collect();
            assert_eq!(*valid, said);
            said
        }
        _ => panic!("no validity"),
    }
}

/// Checks every valid line: its errors are within the limits of 1 % and 5 %, and those of E' agree
/// with the standard errors. Returns the number of lines and the mean square of the errors of E'.
fn check_lines(outcome: &Outcome, exact: &dyn Fn(f64) -> Complex64) -> (usize, f64) {
    let frequency = numbers(outcome, "modulus", "frequency");
    let storage = numbers(outcome, "modulus", "E'");
    let storage_error = numbers(outcome, "modulus", "standard error of E'");
    let loss = numbers(outcome, "modulus", "loss factor");
    let (mut count, mut squares) = (0, 0.0);
    for (line, valid) in is_valid(outcome).iter().enumerate() {
        if !valid {
            continue;
        }
        let truth = exact(frequency[line]);
        let deviation = 1e9 * storage[line] - truth.re;
        assert!(
            deviation.abs() < 0.01 * truth.re,
            "E' at {} Hz: {} GPa, exact {}",
            frequency[line],
            storage[line],
            1e-9 * truth.re
        );
        let eta = truth.im / truth.re;
        assert!(
            (loss[line] - eta).abs() < 0.05 * eta,
            "loss factor at {} Hz: {}, exact {eta}",
            frequency[line],
            loss[line]
        );
        squares += (deviation / (1e9 * storage_error[line])).powi(2);
        count += 1;
    }
    assert!(count > 0);
    // tolerance: the standard errors include those of the specimen, which the records do not have,
    // so that the mean square is at most that of noise alone
    let mean_square = squares / f64::from(count);
    assert!(mean_square < 1.5, "{mean_square} of {count} lines");
    (usize::try_from(count).unwrap(), mean_square)
}

/// Compares every line of the causal estimate with the true modulus. Returns the number of lines,
/// the root mean square of the errors in standard errors, and the median standard error of the loss
/// factor.
fn check_causal(outcome: &Outcome, exact: &dyn Fn(f64) -> Complex64) -> (usize, f64, f64) {
    let column = |name: &str| numbers(outcome, "causal", name);
    let (storage, loss) = (column("E'"), column("loss factor"));
    let errors = [
        column("standard error of E'"),
        column("standard error of the loss factor"),
    ];
    let mut squares = 0.0;
    let frequency = column("frequency");
    for (line, frequency) in frequency.iter().enumerate() {
        let truth = exact(*frequency);
        let z = [
            (storage[line] - 1e-9 * truth.re) / errors[0][line],
            (loss[line] - truth.im / truth.re) / errors[1][line],
        ];
        assert!(z[0].abs() < 4.5 && z[1].abs() < 4.5, "{frequency}: {z:?}");
        squares += 0.5 * (z[0] * z[0] + z[1] * z[1]);
    }
    let mut of_loss = errors[1].to_vec();
    of_loss.sort_by(f64::total_cmp);
    let count = frequency.len();
    (count, (squares / count as f64).sqrt(), of_loss[count / 2])
}

#[test]
fn the_template_is_a_sheet_that_runs() {
    let folder = hits(6, 2);
    // the records are one long file, of sensors of 0.5 mV/g
    let template = include_str!("../templates/modulus.ron")
        .replace("hit-*.npy", "hits.npy")
        .replace("10 mV/g", "0.5 mV/g")
        .replace("        // hits: (cut", "        hits: (cut");
    let outcome = answered(folder.run(&template));
    // the lines determine the ratio of the sensitivities better than the stated 1 % of each
    let gain = quantity(&outcome, "error of the ratio of the sensitivities, found");
    assert!(gain.standard_error.unwrap() < 0.1, "{gain:?}");
    let columns: Vec<&str> = table(&outcome, "budget")
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert!(
        columns.contains(&"ratio of the sensitivities, of E'"),
        "{columns:?}"
    );
    // commented fields of the template are valid, too; its Poisson's ratio is not that of the
    // one-dimensional rig, which a causal estimate detects
    let causal = template.replace("    // causal: true", "    causal: true");
    answered(folder.run(&causal));
    let with_inertia = causal.replace("    // lateral_inertia: (", "    lateral_inertia: (");
    let outcome = folder.run(&with_inertia).unwrap();
    doubts(&outcome)[0].must_say("contradict every relaxing material");
    let optional = template
        .replace("    // limits: (", "    limits: (")
        .replace("    // lateral_inertia: (", "    lateral_inertia: (")
        .replace("    // checks: (", "    checks: (")
        .replace("    // laws: (", "    laws: (")
        .replace("    //     laws: [", "        laws: [")
        .replace("    //     criterion", "        criterion")
        .replace("    //     confidence", "        confidence")
        .replace("    //     most_lines: 400", "        most_lines: 40")
        .replace("    //     cards", "        cards")
        .replace(
            "    // ),\n\n    // Temperatures",
            "    ),\n\n    // Temperatures",
        )
        .replace("    // report_at", "    report_at");
    let outcome = answered(folder.run(&optional));
    assert_eq!(table(&outcome, "laws").columns[0].cells.len(), 3);
}
