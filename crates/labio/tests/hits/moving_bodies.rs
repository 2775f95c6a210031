//! Records of bodies that still move or ring at the end of the record.

use super::body::{Body, moving};
use super::*;

/// Spectra of `hits` minus their level at rest, completed by the motion after the record, under an
/// exponential window if one is stated.
fn completed(hits: &[Record], window: Option<AddedDamping>) -> AveragedSpectra {
    let all: Vec<&Record> = hits.iter().collect();
    let n_samples = samples_at_rest(&all, &[FORCE, "motion"]).unwrap().unwrap();
    let mut averager = SpectrumAverager::for_records_like(&hits[0], Window::Rectangular)
        .unwrap()
        .with_detrend(Detrend::Rest { n_samples })
        .with_completion()
        .unwrap();
    if let Some(window) = window {
        averager = averager.with_exponential_window(window).unwrap();
    }
    hits.iter().for_each(|hit| averager.add(hit).unwrap());
    averager.spectra().unwrap()
}

/// Lines above 0 Hz and below 1.2 kHz, the band that the impact excites.
fn band(response: &FrequencyResponse) -> impl Iterator<Item = usize> {
    let n = response.frequency_hz.partition_point(|f| *f < 1200.0);
    1..n
}

#[test]
fn s1_a_free_body_that_moves_on_has_the_response_it_has_within_its_errors() {
    for quantity in [
        Quantity::Velocity,
        Quantity::Displacement,
        Quantity::Acceleration,
    ] {
        for window in [None, Some(AddedDamping::new(8.0).unwrap())] {
            let body = Body {
                decay: 35.0,
                noise: 3e-4,
                quantity,
            };
            let sigma = window.map_or(0.0, |window| window.decay_rate());
            let (mut squares, mut n, mut beyond) = (0.0, 0.0, 0.0);
            for seed in 0..4 {
                let hits = body.hits(10, seed);
                for hit in &hits {
                    assert_eq!(reasons(hit), [], "{quantity:?}");
                }
                let response = completed(&hits, window).h1(FORCE, "motion").unwrap();
                let variance = response.variance.as_ref().unwrap();
                for line in band(&response) {
                    let s = Complex64::new(sigma, TAU * response.frequency_hz[line]);
                    let error = (response.values[line] - body.response(s)).norm_sqr();
                    squares += error / variance[line];
                    beyond += f64::from(u8::from(error > 6.0 * variance[line]));
                    n += 1.0;
                }
            }
            let first_exists = window.is_some() || quantity == Quantity::Acceleration;
            let spectra = completed(&body.hits(2, 9), window);
            let validity = spectra.h1(FORCE, "motion").unwrap().validity;
            assert_eq!(
                validity[0] == LineValidity::Valid,
                first_exists,
                "{quantity:?}"
            );
            // |error|² divided by its variance from ten hits has about the distribution F(2, 18).
            // Its mean is 1.25 to 1.4, because the response is estimated from the same hits; a bias
            // would increase it. It exceeds 6 on (1 + 6/9)^-9 = 1 % of the lines; this share may
            // double, because neighbouring lines have the error of the completion in common
            let (mean, beyond) = (squares / n, beyond / n);
            assert!(
                mean < 1.6 && beyond < 0.025,
                "{quantity:?}, {window:?}: {mean} {beyond}"
            );
        }
    }
}

#[test]
fn s1_a_velocity_that_neither_rests_nor_stays_is_not_decayed() {
    // the velocity falls to zero, as for a body on soft cords
    let body = Body {
        decay: 35.0,
        noise: 3e-4,
        quantity: Quantity::Velocity,
    };
    let hit = &body.hits(1, 1)[0];
    assert_eq!(reasons(hit), []);
    let mut samples = hit.samples().to_owned();
    for k in 400..Body::SAMPLES {
        samples[[1, k]] *= 1.0 - (k - 400) as f64 / 3700.0;
    }
    let found = only(&moving(samples, Quantity::Velocity));
    assert!(
        matches!(found, Reason::NotDecayed { ref channel, .. } if channel == "motion"),
        "{found}"
    );
}

#[test]
fn s7_the_end_of_the_record_is_judged_under_the_exponential_window() {
    let body = Body {
        decay: 4.0,
        noise: 1e-4,
        quantity: Quantity::Acceleration,
    };
    let hit = &body.hits(1, 1)[0];
    // the ringing has decayed to exp(-4 · 0.37)
    assert!(matches!(only(hit), Reason::NotDecayed { .. }));
    let judge = |criteria: Criteria| criteria.judge(hit, FORCE, None).unwrap();
    let weighed = Criteria::default().with_end_weight(1e-3).unwrap();
    assert_eq!(judge(weighed), []);
    // a window with a weight of 5 % at the end of the record is not sufficient
    let little = Criteria::default().with_end_weight(0.2).unwrap();
    assert!(matches!(judge(little)[..], [Reason::NotDecayed { .. }]));
    let by_rate = AddedDamping::to_end_weight(1e-3, hit.duration()).unwrap();
    assert_eq!(judge(Criteria::default().with_decay_rate(by_rate)), []);
}

#[test]
fn s7_what_the_end_of_the_record_cuts_off_is_stated_line_by_line() {
    for (quantity, decay, window) in [
        (Quantity::Acceleration, 12.0, None),
        (Quantity::Velocity, 12.0, None),
        (Quantity::Displacement, 14.0, None),
        (
            Quantity::Acceleration,
            3.0,
            Some(AddedDamping::new(10.0).unwrap()),
        ),
    ] {
        let body = Body {
            decay,
            noise: 4e-6,
            quantity,
        };
        let sigma = window.map_or(0.0, |window| window.decay_rate());
        let (mut squares, mut stated, mut random) = (0.0, 0.0, 0.0);
        let (mut n, mut within) = (0.0, 0.0);
        for seed in 0..3 {
            let spectra = completed(&body.hits(8, seed), window);
            let response = spectra.h1(FORCE, "motion").unwrap();
            let variance = response.variance.as_ref().unwrap();
            let leakage = spectra.leakage(FORCE, "motion").unwrap().unwrap();
            for line in band(&response) {
                let s = Complex64::new(sigma, TAU * response.frequency_hz[line]);
                let value = response.values[line];
                let error = (value - body.response(s)).norm();
                let systematic = leakage[line] * value.norm();
                if systematic.powi(2) < 10.0 * variance[line] {
                    continue;
                }
                squares += (error / value.norm()).powi(2).min(1.0);
                stated += leakage[line].powi(2).min(1.0);
                random += (variance[line].sqrt() / value.norm()).powi(2).min(1.0);
                within += f64::from(u8::from(
                    error < 2.0 * systematic.hypot(variance[line].sqrt()),
                ));
                n += 1.0;
            }
        }
        // tolerance: the error is stated to a third or, if the motion has a slope at the end, which
        // the tapered end determines less well, to a factor of two; 95 % of the lines are within
        // twice the combined errors
        let ratio = (stated / squares).sqrt();
        assert!((0.67..2.0).contains(&ratio), "{quantity:?}: {ratio}");
        assert!(within / n > 0.95);
        assert!(
            n > 100.0 && random < 0.1 * stated,
            "the end of the record must cause most of the error: {n} lines"
        );
    }
}
