//! Comparison of laws.

use cmod::rheology::{Comparison, FitOptions, Law};
use rodwave::modulus::{
    ComplexModulus, ConstantQ, Elastic, FractionalMaxwell, FractionalZener, Maxwell, Zener,
};

use super::measured::{logarithmic, with_noise};

const LAWS: [Law; 6] = [
    Law::KelvinVoigt,
    Law::Zener,
    Law::FractionalZener,
    Law::HavriliakNegami,
    Law::GeneralisedMaxwell,
    Law::PowerLaw { density: 912.0 },
];

/// The true law is preferred to all laws that do not contain it. The Havriliak-Negami law contains
/// it; this law has one parameter more, and lowers χ² no more than by chance.
#[test]
fn true_law_is_preferred() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let frequency = logarithmic(20.0, 50e3, 150);
    let mut first = 0;
    for seed in 0..10 {
        let data = with_noise(&law, &frequency, 0.003, seed);
        let comparison = Comparison::new(&data, &LAWS, &FitOptions::default()).unwrap();
        assert!(comparison.refused.is_empty());
        let total: f64 = comparison.rows.iter().map(|row| row.weight).sum();
        assert!((total - 1.0).abs() < 1e-12);
        for pair in comparison.rows.windows(2) {
            assert!(pair[0].difference <= pair[1].difference);
            assert!(pair[0].weight >= pair[1].weight);
        }
        let row = |law| {
            let rows = comparison.rows.iter();
            rows.clone().find(|row| row.fit.law.law() == law).unwrap()
        };
        let best = comparison.best().unwrap();
        first += u32::from(best.law.law() == Law::FractionalZener);
        let (nested, truth) = (row(Law::HavriliakNegami), row(Law::FractionalZener));
        let gain = truth.fit.chi_squared - nested.fit.chi_squared;
        // χ² of one degree of freedom exceeds 12 with a probability of 1 in 2000; χ² of the larger
        // law is never above that of the law that it contains
        assert!((-1e-6..12.0).contains(&gain), "{comparison}");
        assert!(truth.difference < 12.0 - 5.7, "{comparison}");
        assert!(row(Law::GeneralisedMaxwell).difference > truth.difference + 6.0);
        assert!(row(Law::Zener).difference > 100.0);
        assert!(row(Law::KelvinVoigt).difference > row(Law::Zener).difference);
    }
    // a gain above ln 300 = 5.7, with which BIC prefers the larger law, has the probability 0.017;
    // more than two of 10 seeds have such a gain with a probability of 1 in 2000
    assert!(first >= 8, "{first}");
}

/// The table has a row for each law, including laws that could not be fitted.
#[test]
fn table_names_what_was_refused() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let data = with_noise(&law, &[100.0, 900.0], 0.003, 0);
    let comparison = Comparison::new(&data, &LAWS, &FitOptions::default()).unwrap();
    assert_eq!(comparison.refused.len(), 1);
    assert_eq!(comparison.refused[0].0, Law::HavriliakNegami);
    let text = comparison.to_string();
    assert_eq!(text.lines().count(), 1 + LAWS.len());
    assert!(
        text.contains("Havriliak-Negami     4 data points, expected at least 5"),
        "{text}"
    );
}

/// Zener's law and a generalised Maxwell model with one branch are the same function. They share
/// one weight, and the law is named Zener's.
#[test]
fn l7_same_function_counts_once() {
    let law = Zener::new(2.0e9, 2.6e9, 4e-5).unwrap();
    let frequency = logarithmic(100.0, 40e3, 60);
    let laws = [
        Law::GeneralisedMaxwell,
        Law::Zener,
        Law::FractionalZener,
        Law::KelvinVoigt,
    ];
    let mut right = 0;
    for seed in 0..40 {
        let data = with_noise(&law, &frequency, 0.005, seed);
        let comparison = Comparison::new(&data, &laws, &FitOptions::default()).unwrap();
        right += u32::from(comparison.best().unwrap().law.law() == Law::Zener);
        let twin = comparison.rows.iter().find(|row| row.same_as.is_some());
        if let Some(twin) = twin {
            assert_eq!(twin.fit.law.law(), Law::GeneralisedMaxwell);
            assert_eq!((twin.same_as, twin.weight), (Some(Law::Zener), 0.0));
        }
        let all: f64 = comparison.rows.iter().map(|row| row.weight).sum();
        assert!((all - 1.0).abs() < 1e-12);
    }
    // BIC accepts one parameter too many with the probability P(chi-square of 1 > 4.8) = 0.03
    assert!(right >= 36, "{right}");
}

/// For a constant loss factor, constant Q is selected, with its loss factor. Each of the other
/// simple laws is selected for its own data.
#[test]
fn l8_simple_laws_are_named() {
    let frequency = logarithmic(100.0, 20e3, 60);
    let elastic = Elastic::new(2.0e9).unwrap();
    let maxwell = Maxwell::new(2.0e9, 4e5).unwrap();
    let fractional = FractionalMaxwell::new(2.0e9, 1e-4, 0.4).unwrap();
    let constant = ConstantQ::new(2.6e9, 0.1, 6e3).unwrap();
    let cases: [(&dyn ComplexModulus, Law); 4] = [
        (&elastic, Law::Elastic),
        (&maxwell, Law::Maxwell),
        (&fractional, Law::FractionalMaxwell),
        (&constant, Law::ConstantQ),
    ];
    let laws = [
        Law::Elastic,
        Law::Maxwell,
        Law::FractionalMaxwell,
        Law::SpringPot,
        Law::ConstantQ,
        Law::KelvinVoigt,
        Law::Zener,
        Law::FractionalZener,
        Law::GeneralisedMaxwell,
        Law::PowerLaw { density: 1000.0 },
    ];
    let options = FitOptions::default().with_profiles(false);
    for (law, name) in cases {
        let mut right = 0;
        let mut covered = 0;
        for seed in 0..20 {
            let data = with_noise(law, &frequency, 0.01, seed);
            let comparison = Comparison::new(&data, &laws, &options).unwrap();
            let best = comparison.best().unwrap();
            right += u32::from(best.law.law() == name);
            if let Some(loss) = best.parameter("loss factor") {
                covered += u32::from(loss.interval.contains(0.1));
            }
            let middle = std::f64::consts::TAU * 1e3;
            let predicted = comparison.prediction(middle).unwrap().unwrap();
            let error = predicted.modulus.re - law.at(middle).re;
            assert!(error.abs() < 5.0 * predicted.covariance[0][0].sqrt());
        }
        println!("{name}: {right} of 20");
        // nine other laws, each of which is selected by chance in some per cent of all cases
        assert!(right >= 16, "{name}: {right}");
        assert!(name != Law::ConstantQ || covered + 3 >= right, "{covered}");
    }
}
