//! Standard errors compared with draws of the whole job: the two methods share the solvers, but not
//! the propagation of errors.

use rodlab::outcome::{Cells, Table};
use rodlab::{Outcome, RodlabError};

use crate::runs::{Folder, Refused, Words, column, table, words};

/// The result of an example whose sheet is changed by `change`, with this number of Monte Carlo
/// draws.
fn drawn(
    folder: &Folder,
    sheet: &str,
    draws: usize,
    change: impl Fn(&str) -> String,
) -> Result<Outcome, RodlabError> {
    let text = change(&folder.read(sheet));
    let (all, _) = text.trim_end().rsplit_once(')').unwrap();
    let all = all.trim_end().trim_end_matches(',');
    folder.run(&format!("{all},\n    monte_carlo: {draws},\n)\n"))
}

fn verdicts(table: &Table) -> Vec<bool> {
    let mut columns = table.columns.iter();
    let valid = columns.find_map(|column| match &column.cells {
        Cells::Validity { valid, .. } => Some(valid.clone()),
        _ => None,
    });
    valid.unwrap()
}

/// Errors of a modulus due to noise, length, diameter, density and mass, line by line.
#[test]
fn errors_of_a_modulus_are_the_scatter_of_its_draws() {
    let without_laws = |text: &str| {
        let (before, rest) = text.split_once("    // a law for").unwrap();
        let (_, after) = rest.split_once("    report_at").unwrap();
        format!("{before}    report_at{after}")
    };
    let folder = Folder::of_example("polypropylene");
    let outcome = drawn(&folder, "modulus.ron", 200, without_laws).unwrap();
    let lines = table(&outcome, "modulus");
    for name in ["E'", "E''"] {
        let of = |error: &str| column(&outcome, "modulus", &format!("{error} of {name}"));
        let pairs = of("Monte Carlo standard error")
            .iter()
            .zip(of("standard error"));
        let ratios: Vec<f64> = pairs.map(|(drawn, linear)| drawn / linear).collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        // tolerance: common errors are drawn 200 times for all lines together, so that each ratio
        // scatters by 5 %, most of it common to all lines
        assert!((mean - 1.0).abs() < 0.15, "{name}: {mean}");
        let valid = verdicts(lines);
        for (ratio, valid) in ratios.iter().zip(valid) {
            // tolerance: about five times the scatter of a ratio
            assert!(!valid || (ratio - 1.0).abs() < 0.3, "{name}: {ratio}");
        }
    }
    let judged = verdicts(table(&outcome, "monte_carlo"));
    assert!(judged.len() >= 12 && judged.iter().all(|valid| *valid));
    outcome.summary.must_begin("By Monte Carlo, 200 draws");
}

#[test]
fn draws_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::of_example("cone");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let outcome = (pool.build().unwrap())
            .install(|| drawn(&folder, "force.ron", 40, str::to_owned))
            .unwrap();
        column(&outcome, "monte_carlo", "Monte Carlo standard error").to_vec()
    };
    let alone = with(1);
    assert!(alone.iter().all(|deviation| deviation.is_finite()));
    assert_eq!(alone, with(3));
}

/// The epoxy example with only the temperatures within 10 K of its reference.
fn epoxy() -> Folder {
    let folder = Folder::of_example("epoxy");
    let sweep = folder.read("sweep.csv");
    let temperature = |row: &str| row.rsplit(',').next()?.parse::<f64>().ok();
    let is_near = |row: &&str| temperature(row).is_none_or(|t| (50.0..=70.0).contains(&t));
    let near: Vec<&str> = sweep.lines().filter(is_near).collect();
    folder.write("sweep.csv", near.join("\n"));
    folder
}

/// Linear errors of a force, of a fitted law and of the modulus of a bar equal the scatter of Monte
/// Carlo draws.
#[test]
fn errors_of_other_jobs_are_the_scatter_of_their_draws() {
    let [cone, bar] = ["cone", "polymer_bar"].map(Folder::of_example);
    for (folder, sheet, number) in [
        (cone, "force.ron", "peak force"),
        (epoxy(), "fit.ron", "fractional Zener, exponent"),
        (bar, "bar.ron", "storage modulus at 2 kHz"),
    ] {
        let outcome = drawn(&folder, sheet, 60, str::to_owned).unwrap();
        let mut names = words(&outcome, "monte_carlo", "quantity").iter();
        let at = names.position(|own| own == number).unwrap();
        let linear = column(&outcome, "monte_carlo", "standard error")[at];
        let ratio = column(&outcome, "monte_carlo", "Monte Carlo standard error")[at] / linear;
        // tolerance: four standard errors of the ratio, from 60 draws and, for the force, the 200
        // draws of its own error
        assert!((ratio - 1.0).abs() < 0.4, "{number}: {ratio}");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let few = drawn(&Folder::of_example("cone"), "force.ron", 5, str::to_owned);
    few.refused().must_say("at least 20 draws");
    let unknown = drawn(&Folder::of_example("epoxy"), "fit.ron", 100, |text| {
        let (before, rest) = text.split_once("errors:").unwrap();
        let (_, after) = rest.split_once('\n').unwrap();
        format!("{before}\n{after}")
    });
    unknown.refused().must_say("standard errors of the data");
}
