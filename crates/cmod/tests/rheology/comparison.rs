//! Laws side by side.

use cmod::rheology::{Comparison, FitOptions, Law};
use rodwave::modulus::{ComplexModulus, FractionalZener};

use super::measured::{Noise, logarithmic, measured};

const LAWS: [Law; 6] = [
    Law::KelvinVoigt,
    Law::Zener,
    Law::FractionalZener,
    Law::HavriliakNegami,
    Law::GeneralisedMaxwell,
    Law::PowerLaw { density: 912.0 },
];

/// The true law is preferred to all that do not contain it. Havriliak-Negami does: it costs one parameter more, and gains no more
/// than chance.
#[test]
fn true_law_is_preferred() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let frequency = logarithmic(20.0, 50e3, 150);
    let mut first = 0;
    for seed in 0..10 {
        let data = measured(
            |omega| law.at(omega),
            &frequency,
            Noise::circular(0.003),
            seed,
        );
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
        // χ² of one degree of freedom: above 12 once in 2000; the larger law is never worse
        assert!((-1e-6..12.0).contains(&gain), "{comparison}");
        assert!(truth.difference < 12.0 - 5.7, "{comparison}");
        assert!(row(Law::GeneralisedMaxwell).difference > truth.difference + 6.0);
        assert!(row(Law::Zener).difference > 100.0);
        assert!(row(Law::KelvinVoigt).difference > row(Law::Zener).difference);
    }
    // a gain of more than ln 300 = 5.7 has the probability 0.017: 2 of 10 seeds once in 80
    assert!(first >= 8, "{first}");
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
