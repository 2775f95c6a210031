//! A mass that strikes a long viscoelastic rod, against Talbot's inversion in 40 digits:
//! `fixtures/reference/mpmath`.

use impulse::{ForceHistory, Impact};
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::CrossSection;
use rodwave::medium::Medium;
use rodwave::modulus::FractionalZener;

use crate::bodies::mass;

const CONTACT: &str = include_str!("../../../fixtures/reference/mpmath/contact.csv");

/// The force between samples, by the parabola through the three nearest.
fn at(history: &ForceHistory, time: f64) -> f64 {
    let centre = history.index_near(time).unwrap().max(1);
    let [a, b, c] = [centre - 1, centre, centre + 1].map(|index| history.force()[index]);
    let u = (time - history.time_at(centre)) / history.time_step();
    b + 0.5 * u * (c - a) + 0.5 * u * u * (a - 2.0 * b + c)
}

/// Returns the reference forces with their times, from 5 us to 1.55 ms.
fn reference() -> Vec<(f64, f64)> {
    let rows = CONTACT.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(cells[..4], [2e-4, 1000.0, 0.05, 2.0]);
        (cells[4], cells[5])
    });
    rows.collect()
}

#[test]
fn a_mass_on_a_viscoelastic_rod() {
    let law = FractionalZener::new(2.2e9, 3.4e9, 2e-5, 0.35).unwrap();
    let medium = Medium::new(1000.0, law).unwrap();
    let section = CrossSection::of_area(2e-4).unwrap();
    let rod = AnalyticChain::analytic_from_impact_face()
        .end(Termination::semi_infinite(&medium, section))
        .unwrap();
    let mass = mass(0.05);
    let reference = reference();
    assert_eq!(reference.len(), 40);
    let peak = reference
        .iter()
        .map(|(_, force)| *force)
        .fold(0.0, f64::max);
    let impact = Impact::between(&mass, &rod).at_velocity(2.0);
    let errors = [1e-6, 0.5e-6].map(|step| {
        let prediction = impact.clone().in_steps_of(step).predict(1.6e-3).unwrap();
        let error = |(time, force): &(f64, f64)| (at(&prediction.history, *time) - force).abs();
        reference.iter().map(error).fold(0.0, f64::max) / peak
    });
    // The front decays as exp(-c t^0.35). A force that is constant in a step has an error in
    // proportion to its second derivative and to the square of the step. The error is largest at
    // the first of the times, which is ten steps behind the front: there it is (1/10)²/24 of the
    // few per cent by which the force has fallen.
    assert!(errors[1] < 3e-5, "{errors:?}");
    assert!(errors[0] / errors[1] > 3.0, "{errors:?}");
}
