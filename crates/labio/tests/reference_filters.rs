//! Analogue low-passes against SciPy's: `fixtures/reference/scipy/filters.csv`.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a reference that cannot be read must fail the test"
)]

use labio::instrument::AntiAlias;
use num_complex::Complex64;

const FILTERS: &str = include_str!("../../../fixtures/reference/scipy/filters.csv");

#[test]
fn low_passes_are_scipys() {
    let mut compared = 0;
    for line in FILTERS.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let order: u32 = cells[1].parse().unwrap();
        let [frequency, re, im] = [2, 3, 4].map(|cell| cells[cell].parse::<f64>().unwrap());
        let expected = Complex64::new(re, im);
        let filter = match cells[0] {
            "butterworth" => AntiAlias::butterworth(order, 10e3),
            _ => AntiAlias::bessel(order, 10e3),
        }
        .unwrap();
        // Relative, down to 1e-9 of the passband, where a product of up to twelve factors is the response. The roots of Bessel's polynomials
        // and the frequency at which half the power is lost are each known to some 1e-14.
        let error = (filter.response(frequency) - expected).norm() / expected.norm();
        assert!(error < 1e-13, "{line}: {error:e}");
        compared += 1;
    }
    assert_eq!(compared, 240);
}
