//! Clipped peaks, and hits that differ from the others.

use super::body::{Body, moving};
use super::*;

/// Returns the record as recorded by converters of `bits` bits, one for each channel, whose ranges
/// are plus and minus `ranges`: rounded and clipped.
fn converted(record: &Record, bits: i32, ranges: [f64; 2]) -> Record {
    let samples = Array2::from_shape_fn((2, record.n_samples()), |(channel, k)| {
        let range = ranges[channel];
        let step = 2.0 * range / 2f64.powi(bits);
        let value = record.samples()[[channel, k]];
        ((value / step).round() * step).clamp(-range, range - step)
    });
    moving(samples, record.channels()[1].quantity())
}

#[test]
fn s10_short_peaks_at_a_limit_are_clipped_and_right_ones_are_not() {
    let body = Body {
        decay: 35.0,
        noise: 3e-4,
        quantity: Quantity::Acceleration,
    };
    let mut accused = 0;
    for seed in 0..40 {
        let hits = body.hits(5, seed);
        let greatest = |channel: &str| {
            let all = hits
                .iter()
                .flat_map(|hit| hit.channel(channel).unwrap().to_vec());
            all.fold(0.0_f64, |p, x| p.max(x.abs()))
        };
        let peaks = [greatest(FORCE), greatest("motion")];
        let judge = |bits: i32, over: [f64; 2]| {
            let ranges = [over[0] * peaks[0], over[1] * peaks[1]];
            let taken: Vec<Record> = hits
                .iter()
                .map(|hit| converted(hit, bits, ranges))
                .collect();
            let all: Vec<&Record> = taken.iter().collect();
            Criteria::default().judge_extremes(&all).unwrap()
        };
        for bits in [8, 12, 16, 24] {
            accused += judge(bits, [1.3, 1.3]).len();
        }
        // the motion reaches twice the range of the recorder
        let found = judge(16, [1.3, 0.5]);
        let clipped = |reason: &Reason| matches!(reason, Reason::Clipped { channel, .. } if channel == "motion");
        assert!(
            !found.is_empty() && found.iter().all(|(_, reason)| clipped(reason)),
            "{found:?}"
        );
        // one sample of each force is at the limit, which is found only from all five hits together
        let force = judge(16, [0.8, 1.3]);
        assert!(
            force.iter().any(|(_, reason)| !clipped(reason)),
            "{force:?}"
        );
    }
    // at most one hit in a hundred is rejected
    assert!(accused <= 8, "{accused} of 800 correct hits are rejected");
}

#[test]
fn s11_the_odd_one_of_ten_is_found_and_no_right_one_is_accused() {
    let mut accused = [0; 2];
    for seed in 0..30 {
        for (place, noise) in [1e-4, 5e-3].into_iter().enumerate() {
            let n = match seed % 3 {
                0 => 4,
                1 => 6,
                _ => 10,
            };
            let body = Body {
                decay: 35.0,
                noise,
                quantity: Quantity::Acceleration,
            };
            accused[place] += find(&body.hits(n, seed)).len();
        }
    }
    assert_eq!(
        accused,
        [0, 0],
        "correct hits that are rejected, for each noise, in 30 tests of 4, 6 or 10 hits"
    );
    for quantity in [Quantity::Acceleration, Quantity::Velocity] {
        let body = Body {
            decay: 35.0,
            noise: 1e-3,
            quantity,
        };
        let hits = body.hits(10, 5);
        type Fault = fn(&mut Vec<f64>);
        let faults: [(&str, Fault); 5] = [
            ("dead", |x| {
                let mut rng = Noise::seeded(3);
                x.iter_mut()
                    .for_each(|x| *x = 1e-3 * rng.normal() + 1e-3 * *x);
            }),
            ("inverted", |x| x.iter_mut().for_each(|x| *x = -*x)),
            ("gain", |x| x.iter_mut().for_each(|x| *x *= 1.1)),
            ("spike", |x| {
                x[2000] += 0.3 * x.iter().fold(0.0_f64, |p, x| p.max(x.abs()));
            }),
            ("shift", |x| x.rotate_right(3)),
        ];
        for (name, fault) in faults {
            let mut all = hits.clone();
            let mut samples = hits[6].samples().to_owned();
            let mut motion = samples.row(1).to_vec();
            fault(&mut motion);
            samples.row_mut(1).assign(&ndarray::Array1::from(motion));
            all[6] = moving(samples, quantity);
            let found = find(&all);
            let [
                (
                    6,
                    Reason::Departs {
                        scale,
                        delay,
                        index,
                        ..
                    },
                ),
            ] = found.as_slice()
            else {
                panic!("{quantity:?} {name}: {found:?}")
            };
            match name {
                "dead" => assert!(scale.abs() < 0.05),
                // tolerance: the mean of ten hits with noise of 1e-3 has an error of less than 1e-3
                "inverted" => assert!((scale + 1.0).abs() < 0.01),
                "gain" => assert!((scale - 1.1).abs() < 0.01),
                "spike" => assert_eq!(*index, Some(2000)),
                _ => assert!((delay - 3.0 / RATE_HZ).abs() < 1e-9),
            }
        }
    }
}

fn find(hits: &[Record]) -> Vec<(usize, Reason)> {
    let all: Vec<&Record> = hits.iter().collect();
    let rest = samples_at_rest(&all, &[FORCE, "motion"]).unwrap();
    find_odd_hits(&HitSpectra::of(&all, FORCE, &["motion"], rest).unwrap())
}
