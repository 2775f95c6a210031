//! Tables of the papers, as printed, converted to SI, and as typed values.
//!
//! The module reads the transcribed tables of `fixtures/papers`. The tables are converted without
//! numerical code of the other crates, so that they are an independent reference.

pub mod decimal;
pub mod error;
pub mod paper_a;
pub mod paper_b;
pub mod paper_c;
pub mod paper_d;
pub mod paper_e;
pub mod printed_table;
pub mod si_table;
pub mod unit;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use crate::generated::workspace_root;

use self::error::FixtureError;
use self::printed_table::PrintedTable;
use self::si_table::SiTable;

/// Folder of the tables of the transcribed thesis, relative to the root of the workspace.
pub const PAPERS: &str = "fixtures/papers/odeen1993";
/// File with the readings of the units of paper D; it is not a table of the paper.
const READINGS: &str = "paper_d_readings.ron";

/// Returns every transcribed table in SI, by file name.
pub fn transcribed_tables(root: &Path) -> Result<Vec<SiTable>, FixtureError> {
    files(&root.join(PAPERS))?
        .iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .filter(|path| file_name(path) != READINGS)
        .map(|path| PrintedTable::read(path))
        .collect()
}

/// Returns the single table of `file`.
pub fn transcribed_table(file: &str) -> Result<SiTable, FixtureError> {
    PrintedTable::read(&workspace_root().join(PAPERS).join(file))
}

/// Returns the paths in `folder` in sorted order, which does not depend on the file system.
pub fn files(folder: &Path) -> Result<Vec<PathBuf>, FixtureError> {
    let fail = |source| FixtureError::Io {
        path: folder.to_path_buf(),
        source,
    };
    let mut paths = fs::read_dir(folder)
        .map_err(fail)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(fail)?;
    paths.sort();
    Ok(paths)
}

pub fn file_name(path: &Path) -> OsString {
    path.file_name().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;

    #[test]
    fn the_index_of_the_papers_is_complete() {
        let index = fs::read_to_string(workspace_root().join(PAPERS).join("README.md")).unwrap();
        let listed: Vec<(&str, &str, usize)> = index
            .lines()
            .filter(|line| line.starts_with("| `"))
            .map(|line| {
                let cells: Vec<&str> = line.split('|').map(str::trim).collect();
                (
                    cells[1].trim_matches('`'),
                    cells[3],
                    cells[5].parse().unwrap(),
                )
            })
            .collect();
        let tables = transcribed_tables(workspace_root()).unwrap();
        let found: Vec<_> = tables
            .iter()
            .map(|table| {
                (
                    table.source.file_name().unwrap().to_str().unwrap(),
                    table.lines.as_str(),
                    table.errata,
                )
            })
            .collect();
        assert_eq!(listed, found);
    }

    /// Checks that γL follows from Ψ = cosh γL by (Ödeen 1993, paper A, eqs. 3 and 4) with the
    /// integers of the reconstructed Table 1.
    #[test]
    fn the_branches_of_paper_a_invert_the_hyperbolic_cosine() {
        let table = transcribed_table("paper_a_table_1_branches.ron").unwrap();
        for row in &table.rows {
            let integer = |column| table.value(&row.label, column).unwrap().value.to_f64();
            let sign = |column| {
                if table.text(&row.label, column).unwrap() == "+" {
                    1.0
                } else {
                    -1.0
                }
            };
            for part in [0.1, 0.5, 0.9] {
                let expected = Complex64::new(
                    0.2,
                    (integer("quarter_turn") + part) * std::f64::consts::FRAC_PI_2,
                );
                let psi = expected.cosh();
                assert!(
                    psi.re * sign("cos_phase") > 0.0 && psi.im * sign("sin_phase") > 0.0,
                    "{}",
                    row.label
                );
                let a = 0.5 * (1.0 - psi.norm_sqr());
                let c = a.hypot(psi.im);
                let alpha = (c - a).sqrt().asinh();
                let beta = (c + a).sqrt().asin();
                let k = integer("s") * beta + integer("n") * std::f64::consts::PI;
                // tolerance: rounding of 1 - r² and of the arc sine near π/2, which loses some of
                // the sixteen digits
                assert!(
                    (Complex64::new(alpha, k) - expected).norm() < 1e-12,
                    "{} at {part}",
                    row.label
                );
            }
        }
    }

    /// Checks that the values of paper D that the survey repeats agree with paper D.
    #[test]
    fn the_survey_repeats_paper_d() {
        let survey = |name: &str| {
            transcribed_table("survey_constants.ron")
                .unwrap()
                .value(name, "value")
                .unwrap()
                .printed
                .clone()
        };
        let table_4 = transcribed_table("paper_d_table_4.ron").unwrap();
        for parameter in ["E", "kappa", "B"] {
            let printed = &table_4
                .value(&format!("Polypropylene / {parameter}"), "value")
                .unwrap()
                .printed;
            assert_eq!(&survey(&format!("polypropylene_{parameter}")), printed);
        }
        let table_3 = transcribed_table("paper_d_table_3.ron").unwrap();
        for measure in ["P_1", "P_2", "P_3"] {
            assert_eq!(
                survey(&format!("polypropylene_{measure}")),
                table_3.value("Polypropylene", measure).unwrap().printed
            );
        }
    }
}
