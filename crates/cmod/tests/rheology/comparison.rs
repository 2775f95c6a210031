//! Laws side by side.

use cmod::rheology::{Comparison, FitOptions, Law};
use rodwave::modulus::{ComplexModulus, FractionalZener};

use crate::measured::{Noise, logarithmic, measured};

const LAWS: [Law; 6] = [
    Law::KelvinVoigt,
    Law::Zener,
    Law::FractionalZener,
    Law::HavriliakNegami,
    Law::GeneralisedMaxwell,
    Law::PowerLaw { density: 912.0 },
];

/// The true law is preferred; Havriliak-Negami, which contains it, costs one parameter more and gains nothing.
#[test]
fn true_law_is_preferred() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let frequency = logarithmic(20.0, 50e3, 150);
    for seed in 0..5 {
        let data = measured(
            |omega| law.at(omega),
            &frequency,
            Noise::circular(0.003),
            seed,
        );
        let comparison = Comparison::new(&data, &LAWS, &FitOptions::default()).unwrap();
        let best = comparison.best().unwrap();
        assert_eq!(best.law.law(), Law::FractionalZener, "{comparison}");
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
        // one parameter of 300 values: ln 300 = 5.7, less what chance gains
        let nested = row(Law::HavriliakNegami);
        assert!(
            nested.difference > 0.0 && nested.difference < 5.8,
            "{comparison}"
        );
        assert!(row(Law::Zener).difference > 100.0);
        assert!(row(Law::KelvinVoigt).difference > row(Law::Zener).difference);
    }
}

/// The table has a line for each law, refused ones included.
#[test]
fn table_names_what_was_refused() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let data = measured(
        |omega| law.at(omega),
        &[100.0, 900.0],
        Noise::circular(0.003),
        0,
    );
    let comparison = Comparison::new(&data, &LAWS, &FitOptions::default()).unwrap();
    assert_eq!(comparison.refused.len(), 1);
    assert_eq!(comparison.refused[0].0, Law::HavriliakNegami);
    let text = comparison.to_string();
    assert_eq!(text.lines().count(), 1 + LAWS.len());
    assert!(
        text.contains("Havriliak-Negami     4 readings, expected at least 5"),
        "{text}"
    );
}
