//! Choice of the number of branches of a Prony series.

use cmod::rheology::{Criterion, FitOptions, Law, PronyFit, RheologicalFit};
use std::f64::consts::TAU;

use rodwave::modulus::{ComplexModulus, ConstantQ, FractionalZener, HavriliakNegami};

use super::measured::{logarithmic, series, with_noise};

/// One to five branches, at least 1.2 decades apart: the true order must be found for at least 90
/// of 100 seeds, and no branch may be negative or 0.
#[test]
fn separated_branches_are_counted() {
    let all = [
        (0.3e9, 2e-6),
        (0.2e9, 4e-5),
        (0.25e9, 8e-4),
        (0.15e9, 1.6e-2),
        (0.2e9, 0.3),
    ];
    for branches in 1..=5 {
        let law = series(1.5e9, &all[..branches]);
        let longest = all[branches - 1].1;
        let frequency = logarithmic(0.05 / longest, 5e5, 40 * (branches as u32 + 1));
        let mut right = 0;
        for seed in 0..100 {
            let data = with_noise(&law, &frequency, 0.005, seed);
            let options = FitOptions::default().with_profiles(false);
            let fit = PronyFit::new(&data, &options).unwrap();
            let found = fit.fit.law.prony_series().unwrap();
            let solid = found.equilibrium_modulus() > 0.0;
            right += u32::from(solid && found.branches().len() == branches);
            for pair in found.branches().windows(2) {
                assert!(pair[0].relaxation_time < pair[1].relaxation_time);
            }
            for branch in found.branches() {
                assert!(branch.modulus > 0.0 && branch.relaxation_time > 0.0);
            }
            assert!(fit.orders.iter().any(|order| order.branches == branches));
        }
        assert!(right >= 90, "{branches} branches: {right} of 100");
    }
}

/// A fluid has no spring, and the chosen series has none.
#[test]
fn fluid_keeps_no_spring() {
    let law = series(0.0, &[(0.3e9, 4e-5), (0.2e9, 8e-4)]);
    let frequency = logarithmic(5.0, 5e4, 100);
    let mut right = 0;
    for seed in 0..20 {
        let data = with_noise(&law, &frequency, 0.01, seed);
        let fit = PronyFit::new(&data, &FitOptions::default()).unwrap();
        let found = fit.fit.law.prony_series().unwrap();
        right += u32::from(found.equilibrium_modulus() == 0.0 && found.branches().len() == 2);
    }
    assert!(right >= 18, "{right} of 20");
}

/// No longer series has a lower χ² than the longest series that was tried, except for the accuracy
/// of the search, because χ² is convex in the spectrum.
#[test]
fn no_longer_series_fits_better() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let frequency = logarithmic(20.0, 50e3, 120);
    for seed in 0..5 {
        let data = with_noise(&law, &frequency, 0.005, seed);
        let options = FitOptions::default().with_profiles(false);
        let fit = PronyFit::new(&data, &options).unwrap();
        let least = fit
            .orders
            .iter()
            .map(|order| order.chi_squared)
            .fold(f64::INFINITY, f64::min);
        let longest = fit.orders.iter().map(|order| order.branches).max().unwrap();
        for more in 1..=2 {
            let longer = PronyFit::with_order(&data, longest + more, &options).unwrap();
            // tolerance: the search for further branches ends where the predicted decrease of χ² is
            // less than 1
            assert!(
                longer.fit.chi_squared > least - 1.5,
                "{least} {}",
                longer.fit.chi_squared
            );
        }
    }
}

/// A fractional material is not a Prony series. The fit needs one or two branches per decade, with
/// AICc no fewer than with BIC. The fractional law is preferred by far, and its residuals are
/// white, whereas the residuals of a series that is too short are not.
#[test]
fn fractional_material_is_recognised() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let frequency = logarithmic(20.0, 50e3, 150);
    let options = FitOptions::default();
    for seed in 0..10 {
        let data = with_noise(&law, &frequency, 0.003, seed);
        let series = PronyFit::new(&data, &options).unwrap();
        let fractional = RheologicalFit::new(&data, Law::FractionalZener, &options).unwrap();
        let branches = series.fit.law.prony_series().unwrap().branches().len();
        assert!((3..=8).contains(&branches), "{branches}");
        assert!(fractional.bic < series.fit.bic - 6.0);
        assert!(fractional.whiteness.is_white(0.001));
        // a single relaxation leaves systematic residuals
        let one = PronyFit::with_order(&data, 1, &options).unwrap();
        assert!(!one.fit.whiteness.is_white(0.001));
        let [by_aicc, by_bic] = [Criterion::Aicc, Criterion::Bic].map(|criterion| {
            let options = options.with_criterion(criterion).with_profiles(false);
            let fit = PronyFit::new(&data, &options).unwrap();
            fit.fit.parameters.len()
        });
        assert!(by_aicc >= by_bic);
    }
}

/// Materials with a continuous spectrum are not Prony series. The 95 % intervals of a predicted
/// modulus have their nominal coverage inside the band only if the scatter between the orders is
/// included.
#[test]
fn l5_predictions_of_continuous_spectra_cover() {
    let fractional = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let constant = ConstantQ::new(2.6e9, 0.1, 6e3).unwrap();
    let skew = HavriliakNegami::new(1.0e9, 4.0e9, 1e-4, 0.6, 0.4).unwrap();
    let laws: [(&str, &dyn ComplexModulus); 3] = [
        ("fractional Zener", &fractional),
        ("constant Q", &constant),
        ("Havriliak-Negami", &skew),
    ];
    let seeds: u64 = testbed::noise::draws(20);
    let options = FitOptions::default().with_profiles(false);
    let (mut all, mut inside) = ([0.0; 2], 0.0);
    for (name, law) in laws {
        for (lines, noise) in [(60, 0.01), (150, 0.003)] {
            let frequency = logarithmic(50.0, 20e3, lines);
            let mut covered = [0.0; 2];
            let mut checked = 0.0;
            for seed in 0..seeds {
                let data = with_noise(law, &frequency, noise, seed);
                let fit = PronyFit::new(&data, &options).unwrap().fit;
                for f in logarithmic(60.0, 18e3, 12) {
                    let predicted = fit.prediction(TAU * f).unwrap();
                    assert!(predicted.within_band);
                    let error = predicted.modulus - law.at(TAU * f);
                    let [[storage, _], [_, loss]] = predicted.covariance;
                    checked += 1.0;
                    covered[0] += f64::from(u8::from(error.re.abs() < 1.96 * storage.sqrt()));
                    covered[1] += f64::from(u8::from(error.im.abs() < 1.96 * loss.sqrt()));
                }
                assert!(!fit.prediction(TAU * 25e3).unwrap().within_band);
            }
            let share = covered.map(|covered| covered / checked);
            println!("{name}, {lines} lines, {noise}: {share:.3?}");
            inside += checked;
            all[0] += covered[0];
            all[1] += covered[1];
        }
    }
    let share = all.map(|covered| covered / inside);
    println!("{share:.3?}");
    for share in share {
        assert!((0.92..0.98).contains(&share), "{share}");
    }
}

/// A series without a spring states the largest spring that the data allow: almost none for a fluid
/// that has relaxed in the band, and most of the modulus if a slow branch replaces the spring by
/// chance.
#[test]
fn l8_missing_spring_has_a_limit() {
    let frequency = logarithmic(5.0, 5e4, 100);
    let fluid = series(0.0, &[(0.3e9, 4e-5), (0.2e9, 8e-4)]);
    let mut fluids = 0;
    for seed in 0..5 {
        let data = with_noise(&fluid, &frequency, 0.01, seed);
        let fit = PronyFit::new(&data, &FitOptions::default()).unwrap().fit;
        let spring = fit.law.prony_series().unwrap().equilibrium_modulus();
        let limit = fit.equilibrium_limit.unwrap_or(spring);
        // a fifth of |E| = 5 MPa at 5 Hz, the lowest frequency, where |E| is known to 1 %
        assert!(limit < 1e6, "{seed}: {limit:e} {fit}");
        fluids += usize::from(fit.equilibrium_limit.is_some());
    }
    // BIC selects a spring by chance for some per cent of all fluids
    assert!(fluids >= 3, "{fluids} of 5");
    let solid = series(1.5e9, &[(0.4e9, 4e-5), (0.3e9, 6e-3)]);
    let frequency = logarithmic(100.0, 5e4, 40);
    let mut without = 0;
    for seed in 0..40 {
        let data = with_noise(&solid, &frequency, 0.01, seed);
        let fit = PronyFit::new(&data, &FitOptions::default()).unwrap().fit;
        if let Some(limit) = fit.equilibrium_limit {
            without += 1;
            assert!(limit > 1.4e9, "{seed}: {limit:e} {fit}");
        }
        let spring = fit.law.prony_series().unwrap().equilibrium_modulus();
        assert_eq!(spring > 0.0, fit.equilibrium_limit.is_none());
    }
    println!("{without} of 40 solids without a spring");
}

/// A series for a fractional law has five branches or more. With a limit of three, the best series
/// of three branches is returned, whose residuals exceed noise.
#[test]
fn the_number_of_branches_can_be_limited() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let data = with_noise(&law, &logarithmic(50.0, 20e3, 120), 0.003, 1);
    let options = FitOptions::default().with_profiles(false);
    let branches = |fit: &PronyFit| fit.fit.law.prony_series().unwrap().branches().len();
    let free = PronyFit::new(&data, &options).unwrap();
    assert!(branches(&free) > 3, "{}", branches(&free));
    let limited = PronyFit::new(&data, &options.with_most_branches(3)).unwrap();
    let given = PronyFit::with_order(&data, 3, &options).unwrap();
    assert_eq!(branches(&limited), 3);
    assert!(limited.orders.iter().all(|order| order.branches <= 3));
    assert!(limited.fit.chi_squared < 1.001 * given.fit.chi_squared);
    assert!(!limited.fit.whiteness.is_white(0.001));
}
