//! Stated uncertainties of rod and sections, compared with repeated draws of a wrong description of
//! the same rod.

use super::methods::{Belief, RIGHT, methods, resonances};
use super::rod::lines;
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
                // tolerance: four times the scatter of 500 draws, 3.2 %; the second order of errors
                // of some per mille is smaller
                assert!(
                    (found / expected - 1.0).abs() < 0.128,
                    "{name}, {} Hz: {found:e} instead of {expected:e}",
                    line.frequency_hz
                );
            }
        }
    }
}
