//! A reconstruction is linear in the response and shifts with it in time.

use impulse::{Parameter, Penalty, Reconstruction, Regularisation};
use num_complex::Complex64;
use proptest::prelude::*;

const N: usize = 96;

/// `1/(1 - a e^{-iθ})`: a body whose response decays by `a` from sample to sample.
fn lines(decay: f64) -> Vec<Complex64> {
    (0..=N / 2)
        .map(|k| 1.0 / (1.0 - decay * Complex64::cis(-std::f64::consts::TAU * k as f64 / N as f64)))
        .collect()
}

fn solved(response: &[f64], decay: f64, parameter: f64) -> Vec<f64> {
    Reconstruction::new(response, 1000.0, &lines(decay))
        .unwrap()
        .with_regularisation(Regularisation::Tikhonov {
            penalty: Penalty::Size,
            parameter: Parameter::Given(parameter),
        })
        .solve()
        .unwrap()
        .history
        .force()
        .to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn forces_add_and_shift_with_responses(
        a in prop::collection::vec(-1.0..1.0_f64, N),
        b in prop::collection::vec(-1.0..1.0_f64, N),
        factor in -5.0..5.0_f64,
        shift in 0..N,
        decay in 0.0..0.9_f64,
        parameter in 1e-6..1.0_f64,
    ) {
        let both: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + factor * b).collect();
        let mut late = a.clone();
        late.rotate_right(shift);
        let [x, y, z, w] = [&a, &b, &both, &late].map(|response| solved(response, decay, parameter));
        for k in 0..N {
            prop_assert!((x[k] + factor * y[k] - z[k]).abs() < 1e-12);
            prop_assert!((x[k] - w[(k + shift) % N]).abs() < 1e-12);
        }
    }

    /// A response in another unit, even one whose squares are near the limits of the floating-point
    /// range, gives the force multiplied by that unit and the same residual and end of the
    /// response.
    #[test]
    fn the_unit_of_the_response_is_no_part_of_the_force(
        a in prop::collection::vec(-1.0..1.0_f64, N),
        decay in 0.0..0.9_f64,
        power in -600..400_i32,
    ) {
        let unit = 2.0_f64.powi(power);
        let scaled: Vec<f64> = a.iter().map(|x| x * unit).collect();
        let path = lines(decay);
        let narrow = impulse::FrequencyBand { from_hz: 100.0, to_hz: 300.0 };
        let [plain, other] = [&a, &scaled].map(|response| {
            Reconstruction::new(response, 1000.0, &path).unwrap().within(narrow).solve().unwrap()
        });
        for (x, y) in plain.history.force().iter().zip(other.history.force()) {
            prop_assert!((x * unit - y).abs() < 1e-13 * unit);
        }
        prop_assert!((plain.relative_residual - other.relative_residual).abs() < 1e-12);
        prop_assert_eq!(plain.response_end, other.response_end);
    }
}
