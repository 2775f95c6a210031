//! Stated uncertainties of rod and sections, compared with repeated draws of a wrong description of
//! the same rod.

use cmod::estimate::ErrorSource;

use super::methods::{Belief, RIGHT, UNCERTAINTY, methods, resonances};
use super::rod::{DENSITY, lines};
use testbed::noise::Noise;

#[test]
fn systematic_errors_are_those_of_wrong_descriptions() {
    let repetitions = 500;
    let [free_end, one_gauge, pulses] = methods(&lines(12, 620.0));
    for method in [free_end, one_gauge, pulses, resonances(lines(500, 10.0))] {
        let name = method.name;
        let right = method.without_noise(&RIGHT);
        let mut random = Noise::seeded(1978);
        let mut squares = vec![[0.0; 2]; right.lines().len()];
        for _ in 0..repetitions {
            let wrong = method.without_noise(&Belief::drawn(&mut random));
            assert_eq!(wrong.lines().len(), right.lines().len(), "{name}");
            for ((wrong, right), squares) in
                wrong.lines().iter().zip(right.lines()).zip(&mut squares)
            {
                let error = wrong.modulus - right.modulus;
                squares[0] += error.re * error.re;
                squares[1] += error.im * error.im;
            }
        }
        for (line, squares) in right.lines().iter().zip(squares) {
            let stated = line.systematic_error();
            let expected = [stated.storage_modulus, stated.loss_modulus];
            for (sum, expected) in squares.into_iter().zip(expected) {
                let found = (sum / f64::from(repetitions)).sqrt();
                // The scatter of 500 draws is 3.2 %; the tolerance is four times this value. The
                // second order of errors of some per mille is smaller.
                assert!(
                    (found / expected - 1.0).abs() < 0.128,
                    "{name}, {} Hz: {found:e} instead of {expected:e}",
                    line.frequency_hz
                );
            }
        }
    }
}

/// The density affects E = -ρω²/γ² even if no ratio depends on it: δE/E = δρ/ρ. A distance gives 2
/// δL/L.
#[test]
fn pulses_have_two_sources_and_both_in_closed_form() {
    let [.., pulses] = methods(&lines(12, 620.0));
    for line in pulses.without_noise(&RIGHT).lines() {
        let shifts: Vec<_> = line
            .uncertainty
            .systematic
            .iter()
            .map(|shift| (shift.source, shift.modulus / line.modulus))
            .collect();
        let [(first, by_distance), (second, by_density), (third, _)] = shifts[..] else {
            panic!("{shifts:?}");
        };
        assert_eq!(
            (first, second, third),
            (
                ErrorSource::Section(0),
                ErrorSource::Density,
                ErrorSource::LateralInertia
            )
        );
        // The central difference over 5e-4 of 0.4 has the remainder (γ δL)²/6, below 1e-4 here.
        assert!((by_distance / (2.0 * UNCERTAINTY.distance / 0.4) - 1.0).norm() < 1e-4);
        assert!((by_density / (UNCERTAINTY.density / DENSITY) - 1.0).norm() < 1e-12);
    }
}
