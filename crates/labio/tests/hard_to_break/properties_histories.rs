//! Integrals, derivatives, and hits without units.

use labio::hits::{Criteria, Extent, Trigger, find_hits};
use labio::{LowFrequency, differentiate, integrate};
use proptest::prelude::*;

use super::{INPUT, record};

proptest! {
    /// The derivative of the integral is the history without its mean and without the line at the
    /// Nyquist frequency, whose integral is zero at every sample.
    #[test]
    fn a_derivative_undoes_an_integral(
        samples in prop::collection::vec(-1e3..1e3_f64, 3..150),
        rate in prop_oneof![1e-3..1e7_f64, Just(1.0 / 3.0)],
    ) {
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let nyquist = if samples.len().is_multiple_of(2) {
            samples.iter().enumerate().map(|(k, x)| sign(k) * x).sum::<f64>() / n
        } else {
            0.0
        };
        let integral = integrate(&samples, rate, LowFrequency::MeanRemoved).unwrap();
        for (k, back) in differentiate(&integral, rate).unwrap().iter().enumerate() {
            let expected = samples[k] - mean - nyquist * sign(k);
            // tolerance: rounding errors of four transforms of numbers up to a thousand
            prop_assert!((back - expected).abs() < 1e-9, "{back} {expected}");
        }
    }

    /// The trapezoidal rule is linear in the samples and proportional to the time step.
    #[test]
    fn trapezoids_are_linear(
        a in prop::collection::vec(-1e3..1e3_f64, 40),
        b in prop::collection::vec(-1e3..1e3_f64, 40),
        factor in -10.0..10.0_f64,
        rest in 1..40_usize,
        rate in 1e-3..1e6_f64,
    ) {
        let low = LowFrequency::AtRest { n_samples: rest };
        let of = |samples: &[f64], rate| integrate(samples, rate, low).unwrap();
        let both: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + factor * b).collect();
        let (x, y, z) = (of(&a, rate), of(&b, rate), of(&both, rate));
        let slower = of(&a, 0.5 * rate);
        for k in 0..40 {
            // tolerance: rounding errors of sums of forty numbers up to 11 000
            prop_assert!((x[k] + factor * y[k] - z[k]).abs() < 1e-9 / rate.min(1.0));
            prop_assert_eq!(slower[k].to_bits(), (2.0 * x[k]).to_bits());
        }
    }

    /// Hits and their checks do not depend on the unit of force; for a factor that is a power of
    /// two, they are the same to the last bit.
    #[test]
    fn hits_do_not_know_the_unit(
        samples in prop::collection::vec(-3.0..3.0_f64, 30..200),
        level in 0.1..2.0_f64,
        power in -300..300_i32,
    ) {
        let unit = 2.0_f64.powi(power);
        let found = |unit: f64| {
            let scaled: Vec<f64> = samples.iter().map(|x| x * unit).collect();
            let trigger = Trigger::new(INPUT, level * unit, Extent::Samples(24)).unwrap()
                .with_pre_trigger(Extent::Samples(8));
            let log = find_hits(&record([&scaled, &scaled], 1000.0), &trigger, &Criteria::default()).unwrap();
            let kinds = |hit: &labio::hits::Hit| -> Vec<_> {
                hit.reasons().iter().map(std::mem::discriminant).collect()
            };
            log.hits().iter().map(|hit| (hit.time().to_bits(), kinds(hit))).collect::<Vec<_>>()
        };
        prop_assert_eq!(found(1.0), found(unit));
    }
}
