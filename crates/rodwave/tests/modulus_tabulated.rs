//! Tables: interpolation between their lines, and rejected input.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::modulus::{ComplexModulus, FractionalZener, Tabulated};
use std::f64::consts::{PI, TAU};

fn law() -> FractionalZener {
    FractionalZener::new(2.0e9, 3.0e9, 1e-4, 0.5).unwrap()
}

fn lines(number: u32) -> (Vec<f64>, Vec<Complex64>) {
    let omega: Vec<f64> = (0..number)
        .map(|j| 1e3 * 100f64.powf(f64::from(j) / f64::from(number - 1)))
        .collect();
    let modulus = omega.iter().map(|&omega| law().at(omega)).collect();
    (omega, modulus)
}

#[test]
fn lines_come_back_and_their_conjugates_at_negative_frequencies() {
    let (omega, modulus) = lines(15);
    let table = Tabulated::new(&omega, &modulus).unwrap();
    for (&omega, &modulus) in omega.iter().zip(&modulus) {
        assert_eq!(table.lookup(omega), Ok(modulus));
        assert_eq!(table.lookup(-omega), Ok(modulus.conj()));
    }
}

/// Checks the order of the interpolation for a law that changes over some decades. At ten lines per
/// decade, the spacing h in ln ω is 0.23.
#[test]
fn interpolation_is_of_third_order_between_the_lines() {
    let worst = |number: u32| {
        let (omega, modulus) = lines(number);
        let table = Tabulated::new(&omega, &modulus).unwrap();
        (0..=500)
            .map(|j| 1.1e3 * 80f64.powf(f64::from(j) / 500.0))
            .map(|omega| (table.lookup(omega).unwrap() / law().at(omega) - 1.0).norm())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(21), worst(41));
    // The error is h³/24 times third derivatives in ln ω of some per cent, 1e-5. Halving h reduces
    // the error by a factor of 8, but of 4 near the maximum of E''.
    assert!(coarse < 1e-4, "{coarse:e}");
    assert!(fine < coarse / 3.5, "{coarse:e} {fine:e}");
}

#[test]
fn outside_the_table_nothing_is_known_unless_asked_for() {
    let (omega, modulus) = lines(15);
    let table = Tabulated::new(&omega, &modulus).unwrap();
    for outside in [0.0, 999.0, 1.1e5, f64::INFINITY, f64::NAN] {
        assert!(!table.covers(outside));
        match table.lookup(-outside) {
            Err(RodwaveError::OutsideTable { lower, upper, .. }) => {
                assert_eq!(lower, 1e3);
                assert_eq!(upper, omega[14]);
            }
            other => panic!("unexpected {other:?}"),
        }
    }
    assert_eq!(
        table.lookup(2e5).unwrap_err().to_string(),
        "magnitude of the angular frequency [rad/s] is 200000, expected a value from 1000 to 100000, the range of the table"
    );
    let held = table.held();
    assert_eq!(held.at(1.0), modulus[0]);
    assert_eq!(held.at(-1.0), modulus[0].conj());
    assert_eq!(held.at(0.0), Complex64::from(modulus[0].re));
    assert_eq!(held.at(1e9), modulus[14]);
    assert_eq!(held.slope(1e9), Complex64::ZERO);
    assert_eq!(held.at(2e3), held.table().lookup(2e3).unwrap());
    assert!(held.at(f64::NAN).re.is_nan());
}

#[test]
fn impossible_tables_are_refused() {
    let (omega, modulus) = lines(3);
    let with = |index: usize, value: Complex64| {
        let mut modulus = modulus.clone();
        modulus[index] = value;
        Tabulated::new(&omega, &modulus).unwrap_err().to_string()
    };
    assert_eq!(
        with(1, Complex64::new(2e9, -1e6)),
        "loss modulus of a line [Pa] is -1000000, expected a finite value, 0 or above"
    );
    assert_eq!(
        with(2, Complex64::new(f64::NAN, 1e6)),
        "storage modulus of a line [Pa] is NaN, expected a finite value above 0"
    );
    assert_eq!(
        Tabulated::new(&omega[..2], &modulus)
            .unwrap_err()
            .to_string(),
        "table of moduli has 3 entries, expected 2"
    );
    assert_eq!(
        Tabulated::new(&omega[..1], &modulus[..1])
            .unwrap_err()
            .to_string(),
        "table of moduli has 1 samples, expected at least 2"
    );
    assert_eq!(
        Tabulated::new(&[1.0, 2.0, 2.0], &modulus)
            .unwrap_err()
            .to_string(),
        "angular frequency of a line [rad/s] is 2, expected more than that of the previous line"
    );
    assert!(Tabulated::new(&[0.0, 2.0, 3.0], &modulus).is_err());
}

/// Compares the estimated with the true errors at tenths of every interval, for Zener, fractional
/// and constant-loss laws on 5 to 40 lines, evenly spaced in ω and in ln ω.
#[test]
fn f8_the_error_of_interpolation_is_estimated() {
    let (from, to) = (TAU * 100.0, TAU * 10e3);
    let mut laws: Vec<Box<dyn Fn(f64) -> Complex64>> = Vec::new();
    // loss peaks below, at the ends of, within and above the band
    for peak in [0.5, 1.0, 5.0, 20.0, 100.0, 200.0] {
        let tau = 1.0 / (peak * from);
        for step in [0.1, 1.0] {
            let zener = move |omega: f64| {
                let s = Complex64::new(0.0, omega * tau);
                2e9 * (1.0 + step * s / (1.0 + s))
            };
            laws.push(Box::new(zener));
            for power in [0.4, 0.7] {
                let fractional = move |omega: f64| {
                    let s = Complex64::new(0.0, omega * tau).powf(power);
                    2e9 * (1.0 + step * s / (1.0 + s))
                };
                laws.push(Box::new(fractional));
            }
        }
    }
    for loss in [0.01, 0.05, 0.2] {
        let constant =
            move |omega: f64| 3e9 * Complex64::new(0.0, omega / from).powf(2.0 / PI * loss);
        laws.push(Box::new(constant));
    }
    let mut ratios: [Vec<f64>; 4] = Default::default();
    for law in &laws {
        for number in [5_u32, 7, 10, 14, 20, 28, 40] {
            for is_log in [false, true] {
                let at = |part: f64| {
                    if is_log {
                        from * (to / from).powf(part)
                    } else {
                        from + (to - from) * part
                    }
                };
                let omega: Vec<f64> = (0..number)
                    .map(|j| at(f64::from(j) / f64::from(number - 1)))
                    .collect();
                let modulus: Vec<Complex64> = omega.iter().map(|omega| law(*omega)).collect();
                let table = Tabulated::new(&omega, &modulus).unwrap();
                for pair in omega.windows(2) {
                    for tenth in 1..10 {
                        let between = (pair[0].ln()
                            + (pair[1] / pair[0]).ln() * f64::from(tenth) / 10.0)
                            .exp();
                        let error = table.lookup(between).unwrap() - law(between);
                        let estimate = table.interpolation_error(between).unwrap();
                        // rounding of the table is not an error of the interpolation
                        let rounding = 1e-13 * law(between).norm();
                        let group = 2 * usize::from(is_log);
                        ratios[group].push((estimate.re + rounding) / (error.re.abs() + rounding));
                        ratios[group + 1]
                            .push((estimate.im + rounding) / (error.im.abs() + rounding));
                    }
                }
            }
        }
    }
    for (what, ratios) in ["E' linear", "E'' linear", "E' log", "E'' log"]
        .iter()
        .zip(&mut ratios)
    {
        ratios.sort_by(f64::total_cmp);
        let covered =
            ratios.iter().filter(|ratio| **ratio >= 1.0).count() as f64 / ratios.len() as f64;
        let median = ratios[ratios.len() / 2];
        assert!(
            covered > 0.95 && median < 20.0,
            "{what}: {covered} {median}"
        );
    }
}

#[test]
fn f8_three_lines_tell_no_error() {
    let (omega, modulus) = lines(3);
    let table = Tabulated::new(&omega, &modulus).unwrap();
    assert_eq!(table.interpolation_error(2e3), None);
    let (omega, modulus) = lines(4);
    let table = Tabulated::new(&omega, &modulus).unwrap();
    assert!(
        table
            .interpolation_error(2e3)
            .is_some_and(|error| error.re > 0.0 && error.im > 0.0)
    );
    assert_eq!(
        table.interpolation_error(-2e3),
        table.interpolation_error(2e3)
    );
    assert_eq!(table.interpolation_error(2e5), None);
}
