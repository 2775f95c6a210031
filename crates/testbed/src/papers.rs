//! Tables of the papers: as printed, converted to SI, and as typed values.
//!
//! The module reads the transcribed tables of `fixtures/papers`. It calls none of our numerical
//! code, which keeps the reference independent.

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

/// Folder of the transcribed work, relative to the root of the workspace.
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

/// Returns the contents of `folder`, sorted: the order does not depend on the file system.
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

    fn value(file: &str, row: &str, column: &str) -> f64 {
        transcribed_table(file)
            .unwrap()
            .value(row, column)
            .unwrap()
            .value
            .to_f64()
    }

    /// Guards against accidental loss or gain of rows and values in any table.
    #[test]
    fn every_table_has_the_rows_and_values_it_had() {
        let counts: Vec<_> = transcribed_tables(workspace_root())
            .unwrap()
            .iter()
            .map(|table| {
                (
                    file_name(&table.source).into_string().unwrap(),
                    table.rows.len(),
                    table.value_count(),
                )
            })
            .collect();
        let expected = [
            ("instruments.ron", 19, 0),
            ("paper_a_constants.ron", 28, 28),
            ("paper_a_figures.ron", 12, 12),
            ("paper_a_table_1.ron", 7, 0),
            ("paper_a_table_1_branches.ron", 7, 21),
            ("paper_a_table_2.ron", 10, 40),
            ("paper_b_constants.ron", 17, 17),
            ("paper_b_table_1.ron", 7, 0),
            ("paper_c_constants.ron", 26, 26),
            ("paper_c_table_1.ron", 6, 13),
            ("paper_d_constants.ron", 18, 18),
            ("paper_d_table_1.ron", 3, 0),
            ("paper_d_table_2.ron", 25, 100),
            ("paper_d_table_3.ron", 5, 15),
            ("paper_d_table_4.ron", 14, 14),
            ("paper_d_table_5.ron", 5, 20),
            ("paper_d_table_a1.ron", 8, 32),
            ("paper_e_cases.ron", 4, 12),
            ("paper_e_constants.ron", 33, 33),
            ("survey_constants.ron", 28, 28),
        ]
        .map(|(file, rows, values)| (file.to_owned(), rows, values));
        assert_eq!(counts, expected);
        assert_eq!(
            counts.iter().map(|(_, _, values)| values).sum::<usize>(),
            429
        );
    }

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

    /// Eqs. 3 and 4 give γL back from Ψ = cosh γL with the integers of the reconstructed Table 1
    /// (Ödeen 1993, paper A, eqs. 3 and 4).
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
                // Rounding of 1 - r² and of the arc sine near π/2 costs some of the sixteen digits.
                assert!(
                    (Complex64::new(alpha, k) - expected).norm() < 1e-12,
                    "{} at {part}",
                    row.label
                );
            }
        }
    }

    /// `E_2`, `B` and `m` of paper C are consistent: with the corrected equation (5), they give a
    /// recovery that is nearly complete after the printed five hours, and 73 % of the virgin loss
    /// factor one minute after the unloading of Test 1.
    #[test]
    fn the_parameters_of_paper_c_are_consistent() {
        let constant = |name| value("paper_c_constants.ron", name, "value");
        let condition = |column| value("paper_c_table_1.ron", "1", column);
        let (e_1, e_2, b, m) = (
            constant("E_1"),
            constant("E_2"),
            constant("B"),
            constant("m"),
        );
        let t_1 = 1.0 / (b * e_2.powf(m + 1.0));
        let strain = condition("mean_stress") / e_2;
        let bracket =
            strain - (m * condition("load_duration") / t_1 + strain.powf(-m)).powf(-1.0 / m);
        let t_r = t_1 / m * bracket.powf(-m);
        let omega = std::f64::consts::TAU * constant("frequency");
        let relative_change = |t: f64| {
            e_1 * (m + 1.0) / (e_2 * omega * m * t_r) / (1.0 + t / t_r) / constant("tan_delta_0")
        };
        // Numbers from an independent evaluation, rounded to their last digit.
        assert!((t_r - 259.4).abs() < 0.05, "t_r = {t_r} s");
        assert!((relative_change(60.0) - 0.7338).abs() < 5e-5);
        assert!(relative_change(constant("recovery_time")) < 0.02);
        assert!(
            (condition("mean_stress")
                - value("paper_c_table_1.ron", "6", "mean_stress")
                - value("paper_c_table_1.ron", "6", "stress_amplitude"))
            .abs()
                < 1.0
        );
    }

    /// The corrected sample period of paper E agrees with the printed duration and usable band.
    #[test]
    fn the_sampling_of_paper_e_is_consistent() {
        let table = transcribed_table("paper_e_constants.ron").unwrap();
        let cell = |name| table.value(name, "value").unwrap();
        let period = cell("mobility_sample_period");
        let samples = cell("mobility_samples").value.to_f64();
        // Each printed number is accurate to half a unit of its last digit.
        let duration = cell("mobility_duration");
        let allowed = duration.tolerance.to_f64() + samples * period.tolerance.to_f64();
        assert!((samples * period.value.to_f64() - duration.value.to_f64()).abs() <= allowed);
        let half_of_spectrum = 0.25 / period.value.to_f64();
        let highest = cell("mobility_frequency_highest");
        assert!((half_of_spectrum - highest.value.to_f64()).abs() <= highest.tolerance.to_f64());
    }

    /// The values of paper D that the survey repeats agree with paper D.
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
