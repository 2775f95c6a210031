//! Standard errors compared with draws of the whole job: the two methods share the solvers, but not
//! the propagation of errors.

use rodlab::outcome::{Cells, Table};
use rodlab::{Outcome, RodlabError};

use crate::runs::{Folder, Refused, Words, column, copy_example, table};

/// Outcome of the sheet of an example with `draws` of a Monte Carlo calculation, after `change`.
fn drawn(
    name: &str,
    sheet: &str,
    draws: usize,
    change: impl Fn(&str) -> String,
) -> Result<Outcome, RodlabError> {
    let folder = Folder::new();
    copy_example(name, folder.path());
    let text = change(&folder.read(sheet));
    let (all, _) = text.trim_end().rsplit_once(')').unwrap();
    let separator = if all.trim_end().ends_with(',') {
        ""
    } else {
        ","
    };
    let text = format!("{all}{separator}\n    monte_carlo: {draws},\n)\n");
    folder.run(&text)
}

fn verdicts(table: &Table) -> Vec<bool> {
    table
        .columns
        .iter()
        .find_map(|column| match &column.cells {
            Cells::Validity { valid, .. } => Some(valid.clone()),
            _ => None,
        })
        .unwrap()
}

/// Errors of a modulus due to noise, length, diameter, density and mass, line by line.
#[test]
fn errors_of_a_modulus_are_the_scatter_of_its_draws() {
    let without_laws = |text: &str| {
        let (before, rest) = text.split_once("    // a law for").unwrap();
        let (_, after) = rest.split_once("    report_at").unwrap();
        format!("{before}    report_at{after}")
    };
    let outcome = drawn("polypropylene", "modulus.ron", 200, without_laws).unwrap();
    let lines = table(&outcome, "modulus");
    for name in ["E'", "E''"] {
        let linear = column(&outcome, "modulus", &format!("standard error of {name}"));
        let drawn = column(
            &outcome,
            "modulus",
            &format!("Monte Carlo standard error of {name}"),
        );
        let ratios: Vec<f64> = drawn.iter().zip(linear).map(|(a, b)| a / b).collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        // common errors are drawn 200 times for all lines together, so that each ratio scatters by
        // 5 %, most of it common to all lines
        assert!((mean - 1.0).abs() < 0.15, "{name}: {mean}");
        let valid = verdicts(lines);
        for (ratio, valid) in ratios.iter().zip(valid) {
            // the ratio scatters by 5 %; the limit is about five times as large
            assert!(!valid || (ratio - 1.0).abs() < 0.3, "{name}: {ratio}");
        }
    }
    let judged = verdicts(table(&outcome, "monte_carlo"));
    assert!(judged.len() >= 12 && judged.iter().all(|valid| *valid));
    outcome.summary.must_begin("By Monte Carlo, 200 draws");
}

#[test]
fn draws_do_not_depend_on_the_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let outcome = pool
            .build()
            .unwrap()
            .install(|| drawn("cone", "force.ron", 40, str::to_owned));
        let outcome = outcome.unwrap();
        column(&outcome, "monte_carlo", "Monte Carlo standard error").to_vec()
    };
    let alone = with(1);
    assert!(alone.iter().all(|deviation| deviation.is_finite()));
    assert_eq!(alone, with(3));
}

/// A force, whose bands are computed from draws, laws of a sweep over temperatures, and a bar.
#[test]
fn errors_of_other_jobs_are_the_scatter_of_their_draws() {
    for (name, sheet, draws, number) in [
        ("cone", "force.ron", 100, "peak force"),
        ("epoxy", "fit.ron", 60, "fractional Zener, exponent"),
        ("polymer_bar", "bar.ron", 60, "storage modulus at 2 kHz"),
    ] {
        let outcome = drawn(name, sheet, draws, str::to_owned).unwrap();
        let judged = table(&outcome, "monte_carlo");
        let Cells::Words(names) = &judged.columns[0].cells else {
            panic!("{judged:?}")
        };
        let at = names.iter().position(|own| own == number).unwrap();
        let linear = column(&outcome, "monte_carlo", "standard error")[at];
        let ratio = column(&outcome, "monte_carlo", "Monte Carlo standard error")[at] / linear;
        // four standard errors of the scatter of 60 draws, and the scatter of the 200 draws of the
        // force itself
        assert!((ratio - 1.0).abs() < 0.4, "{name}: {ratio}");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let refused = |name: &str, sheet: &str, draws, change: &dyn Fn(&str) -> String| {
        drawn(name, sheet, draws, change).refused()
    };
    refused("cone", "force.ron", 5, &str::to_owned).must_say("at least 20 draws");
    let unknown = refused("epoxy", "fit.ron", 100, &|text| {
        let (before, rest) = text.split_once("errors:").unwrap();
        let (_, after) = rest.split_once('\n').unwrap();
        format!("{before}\n{after}")
    });
    unknown.must_say("standard errors of the data");
}
