//! Tables that a sheet names: ratios of spectra, measured loss factors, frequency responses.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use rodlab::job::{self, Sheet, Silent};
use rodlab::outcome::Outcome;

use super::super::records::prints;

const RATIOS: [&str; 5] = [
    r#"Modulus(title: "parts", specimen: (length: "799 mm ± 0.3 mm", diameter: "15.8 mm", density: "912 kg/m3 ± 0.3 kg/m3",
        accelerometer_mass: "2.9 gram ± 0.03 gram"), method: TwoPoint(impacted_end: "struck end", free_end: "free end"),
        source: Ratio(path: "table", values: Parts(real: 1, imaginary: 2), errors: Coherence(column: 3, averages: 10)))"#,
    r#"Modulus(title: "one column", specimen: (length: "799 mm", diameter: "15.8 mm", density: "912 kg/m3"),
        method: TwoPoint(impacted_end: "struck end", free_end: "free end"),
        source: Ratio(path: "table", values: Complex(1), errors: StandardError(column: 2)), lateral_inertia: (poisson_ratio: "0.40"))"#,
    r#"Modulus(title: "relative", specimen: (length: "799 mm", diameter: "15.8 mm", density: "912 kg/m3"),
        method: TwoPoint(impacted_end: "struck end", free_end: "free end"),
        source: Ratio(path: "table", values: Complex("H"), errors: Relative(of_value: "0.1 %")))"#,
    r#"Recovery(title: "readings", series_modulus: "3.1 GPa", frequency: "10 kHz", virgin_loss_factor: "0.025 ± 0.0002",
        tests: [(name: "45 MPa", load: [Constant(stress: "45 MPa", duration: "30 min")],
        readings: File(path: "table", readings: 1, standard_errors: 2))])"#,
    r#"Fit(title: "moduli", tables: [(files: ["table"], frequency: 1, modulus: Parts(storage: 2, loss: 3), temperature: Stated("23 degC"))],
        laws: (laws: [Zener]))"#,
];

const RESPONSES: [&str; 3] = [
    r#"Mobility(title: "as it stands", source: File(file: "table"), support: Free(mass: "1.504 kg ± 1 gram"))"#,
    r#"Mobility(title: "with coherence", source: File(file: "table", data_set: 1, coherence: 2, averages: 8),
        head_mass: "12.5 gram ± 0.1 gram", support: Free(mass: "1.504 kg ± 1 gram"))"#,
    r#"Mobility(title: "in parts", source: File(file: "table", data_set: 1, imaginary: 2, kind: Accelerance, standard_error: 3),
        front_impedance: "3.2e3 kg/s")"#,
];

/// Checks tables of spectral ratios, loss factors and moduli.
pub fn ratio_table(bytes: &[u8]) {
    jobs(bytes, &RATIOS);
}

/// Checks tables of frequency responses.
pub fn response_table(bytes: &[u8]) {
    jobs(bytes, &RESPONSES);
}

/// Returns the parent of the temporary folders from which jobs read their tables: a folder in
/// memory if there is one, otherwise /tmp.
pub fn memory() -> &'static Path {
    let shared = Path::new("/dev/shm");
    if shared.is_dir() {
        shared
    } else {
        Path::new("/tmp")
    }
}

fn jobs(table: &[u8], sheets: &[&str]) {
    let folder = tempfile::tempdir_in(memory()).expect("a folder");
    fs::write(folder.path().join("table"), table).expect("a table");
    for text in sheets {
        let path = folder.path().join("sheet.ron");
        let job = job::parse(&path, text).expect("a sheet of this file");
        let sheet = Sheet {
            path,
            text: (*text).to_owned(),
            job,
        };
        let interrupted = AtomicBool::new(false);
        if let Err(error) = job::check(&sheet, &Silent, &interrupted) {
            prints(&error);
        } else {
            match job::run(&sheet, &Silent, &interrupted) {
                Ok(outcome) => found(&outcome),
                Err(error) => prints(&error),
            }
        }
    }
}

/// Checks that valid values are finite and that the columns of a table have equal lengths.
fn found(outcome: &Outcome) {
    for quantity in &outcome.quantities {
        let numbers = [quantity.value, quantity.standard_error];
        let are_finite = numbers.into_iter().flatten().all(f64::is_finite);
        assert!(!quantity.valid || are_finite, "{quantity:?}");
    }
    for table in &outcome.tables {
        let mut lengths = table.columns.iter().map(|column| column.cells.len());
        let first = lengths.next();
        assert!(
            lengths.all(|n| Some(n) == first),
            "columns of `{}`",
            table.name
        );
    }
}
