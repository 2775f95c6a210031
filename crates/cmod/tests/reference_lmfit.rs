//! Fits of moduli with noise compared with fits by lmfit: the minimum, its χ² and the covariance of
//! the parameters, from `fixtures/reference/lmfit`.

use cmod::estimate::ComplexCovariance;
use cmod::rheology::{
    FitOptions, FittedLaw, Law, ModulusData, ModulusPoint, RheologicalFit, Scale,
};
use num_complex::Complex64;

use crate::rheology::measured::series;

const DATA: &str = include_str!("../../../fixtures/reference/lmfit/data.csv");
const FITS: &str = include_str!("../../../fixtures/reference/lmfit/fits.csv");

fn data(case: &str) -> ModulusData {
    let points: Vec<_> = DATA
        .lines()
        .filter_map(|line| line.strip_prefix(case)?.strip_prefix(','))
        .map(|rest| {
            let cells: Vec<f64> = rest.split(',').map(|cell| cell.parse().unwrap()).collect();
            ModulusPoint {
                frequency_hz: cells[0],
                modulus: Complex64::new(cells[1], cells[2]),
                covariance: ComplexCovariance {
                    real: cells[3],
                    imaginary: cells[4],
                    mixed: cells[5],
                },
            }
        })
        .collect();
    ModulusData::new(&points).unwrap()
}

/// Returns the rows of a quantity, as (row, column, value).
fn quantity(case: &str, quantity: &str) -> Vec<(usize, usize, f64)> {
    FITS.lines()
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|cells| cells[0] == case && cells[1] == quantity)
        .map(|cells| {
            (
                cells[2].parse().unwrap(),
                cells[3].parse().unwrap(),
                cells[4].parse().unwrap(),
            )
        })
        .collect()
}

pub(crate) fn coordinate(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Ratio => value.ln(),
        Scale::LogOdds => (value / (1.0 - value)).ln(),
        _ => value,
    }
}

fn compare(case: &str, fit: &RheologicalFit, parameters: usize) {
    let coordinates = quantity(case, "coordinate");
    assert_eq!(coordinates.len(), parameters);
    assert_eq!(fit.parameters.len(), parameters);
    let covariance = fit.covariance.as_ref().unwrap();
    let expected_covariance = quantity(case, "covariance");
    assert_eq!(expected_covariance.len(), parameters * parameters);
    let expected_error = |k: usize| expected_covariance[k * parameters + k].2.sqrt();
    for (k, _, expected) in coordinates {
        let parameter = &fit.parameters[k];
        let found = coordinate(parameter.scale, parameter.value);
        // tolerance: the iteration of this crate ends where χ² changes by less than its rounding
        // error, 1e-16 times some hundred degrees of freedom. The root of this change is the
        // distance from the minimum in standard errors
        let in_errors = (found - expected).abs() / expected_error(k);
        assert!(
            in_errors < 1e-5,
            "{case}, {}: {found} {expected}, {in_errors:e} standard errors",
            parameter.name
        );
        // tolerance: differences of eighth order with steps of 1e-3 have errors of 1e-10, and a
        // change of the parameters by 1e-5 standard errors, which are some 1e-3 of the parameters,
        // changes the standard errors by 1e-8
        let ratio = parameter.standard_error / expected_error(k) - 1.0;
        assert!(
            ratio.abs() < 1e-7,
            "{case}, {}: standard error, {ratio:e}",
            parameter.name
        );
    }
    for &(row, column, expected) in &expected_covariance {
        // compared as a correlation
        let difference =
            (covariance[row][column] - expected) / expected_error(row) / expected_error(column);
        assert!(
            difference.abs() < 1e-7,
            "{case}, correlation {row} {column}: {difference:e}"
        );
    }
    let (_, _, chi_squared) = quantity(case, "chi squared")[0];
    // tolerance: χ² is stationary at the minimum, so that the 1e-5 errors enter as their square;
    // 120 or more squared residuals are differences of numbers 1e3 times as large, and are rounded
    // accordingly
    assert!(
        (fit.chi_squared / chi_squared - 1.0).abs() < 1e-12,
        "{case}: chi-squared {} {chi_squared}",
        fit.chi_squared
    );
}

/// Fits a complex modulus with five parameters, from the starting points of this crate.
#[test]
fn five_parameters_are_lmfits() {
    let case = "havriliak negami";
    let fit = RheologicalFit::new(
        &data(case),
        Law::HavriliakNegami,
        &FitOptions::default().with_profiles(false),
    )
    .unwrap();
    compare(case, &fit, 5);
}

/// Fits a Prony series of three branches and a spring, from values that differ from
/// the true ones by up to a half.
#[test]
fn a_prony_series_is_lmfits() {
    let case = "prony";
    let branches = [(0.7e9, 1.2e-5), (0.4e9, 3e-4), (0.6e9, 2e-3)];
    let start = series(1.2e9, &branches);
    let fit = RheologicalFit::from_start(
        &data(case),
        &FittedLaw::GeneralisedMaxwell(start),
        &FitOptions::default().with_profiles(false),
    )
    .unwrap();
    compare(case, &fit, 7);
    // the order found from the data is that of the reference, with the same minimum
    let chosen = RheologicalFit::new(
        &data(case),
        Law::GeneralisedMaxwell,
        &FitOptions::default().with_profiles(false),
    )
    .unwrap();
    compare(case, &chosen, 7);
}
