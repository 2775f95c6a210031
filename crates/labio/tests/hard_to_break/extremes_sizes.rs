//! Records of ten million samples, requests that exceed any memory, and the shortest records.

use labio::hits::{Criteria, Extent, Reason, Trigger, find_hits, find_hits_in_blocks};
use labio::{
    AddedDamping, ForceWindow, LabioError, LowFrequency, Provenance, Quantity, Record,
    SpectrumAverager, Welch, Window, integrate,
};
use ndarray::Array2;

use super::{INPUT, channels, record, record_of};
use crate::records::InBlocks;

/// Ten million samples with a hit in every hundred thousand: all hits are found, and the record is
/// integrated and averaged.
#[test]
fn ten_million_samples() {
    const N: usize = 10_000_000;
    let every = 100_000;
    let samples = Array2::from_shape_fn((1, N), |(_, k)| {
        let since = k % every;
        // a half sine of 100 samples on a floor of one least significant digit
        let noise = if k % 3 == 0 { 1e-3 } else { 0.0 };
        if (5000..5100).contains(&since) {
            100.0 * (std::f64::consts::PI * (since - 5000) as f64 / 100.0).sin()
        } else {
            noise
        }
    });
    let long = record_of(samples.clone(), 1e6, &[(INPUT, Quantity::Force)]);
    let trigger = Trigger::new(INPUT, 10.0, Extent::Samples(4096))
        .unwrap()
        .with_pre_trigger(Extent::Samples(512));
    let criteria = Criteria::default();
    let log = find_hits(&long, &trigger, &criteria).unwrap();
    assert_eq!(log.hits().len(), N / every);
    let mut source = InBlocks::new(long.channels(), 1e6, samples, usize::MAX);
    let streamed =
        find_hits_in_blocks(&mut source, &Provenance::computed("t"), &trigger, &criteria).unwrap();
    assert_eq!(streamed.accepted().count(), log.accepted().count());
    assert!(log.accepted().count() == N / every);

    let row = long.channel(INPUT).unwrap().to_vec();
    let impulse = integrate(&row, 1e6, LowFrequency::AtRest { n_samples: 3 }).unwrap();
    // a hundred half sines, each with the impulse 2/π · 100 N · 100 µs; the mean of the floor is
    // removed as an offset
    let expected = 100.0 * 2.0 / std::f64::consts::PI * 100.0 * 100e-6;
    assert!(
        (impulse[N - 1] / expected - 1.0).abs() < 1e-3,
        "{}",
        impulse[N - 1]
    );

    let spectra = Welch::new(1 << 16)
        .unwrap()
        .with_overlap(0)
        .unwrap()
        .spectra(&long)
        .unwrap();
    assert_eq!(spectra.n_averages(), N >> 16);
    assert!(spectra.auto(INPUT).unwrap().iter().all(|g| g.is_finite()));
}

#[test]
fn lengths_that_no_memory_holds_are_refused() {
    for n in [usize::MAX, usize::MAX / 2, 1 << 50] {
        assert!(Window::Rectangular.sample(n).is_err());
        assert!(Window::HannPeriodic.sample(n).is_err());
        assert!(AddedDamping::new(1.0).unwrap().weights(n, 1.0).is_err());
        assert!(
            ForceWindow::new(0.0, 1.0, 0.0)
                .unwrap()
                .weights(n, 1.0)
                .is_err()
        );
        assert!(SpectrumAverager::new(&channels(), n, 1.0, Window::Rectangular).is_err());
        let short = record([&[1.0; 8], &[1.0; 8]], 1.0);
        assert!(matches!(
            Welch::new(n).unwrap().spectra(&short),
            Err(LabioError::TooFewSamples { found: 8, .. })
        ));
        let mut source = InBlocks::new(&channels(), 1e6, Array2::ones((2, 8)), 8);
        assert!(
            Welch::new(n)
                .unwrap()
                .spectra_of_stream(&mut source)
                .is_err()
        );
        let late = Trigger::new(INPUT, 0.5, Extent::Samples(n))
            .unwrap()
            .with_pre_trigger(Extent::Samples(n));
        assert!(matches!(
            find_hits(&short, &late, &Criteria::default()),
            Err(LabioError::TooFewSamples { .. })
        ));
        let patient = Trigger::new(INPUT, 0.5, Extent::Samples(n)).unwrap();
        assert!(find_hits(&short, &patient, &Criteria::default()).is_ok());
        assert!(short.part(0..n).is_err());
    }
}

/// Lost samples of the impact: the reasons state them, and not only that the trigger did not fire.
#[test]
fn lost_samples_of_an_untriggered_stream_are_told() {
    let trigger = Trigger::new(INPUT, 0.5, Extent::Samples(4)).unwrap();
    let mut samples = Array2::zeros((2, 50));
    samples[(0, 30)] = f64::NAN;
    let mut source = InBlocks::new(&channels(), 1e6, samples, 50);
    let log = find_hits_in_blocks(
        &mut source,
        &Provenance::computed("t"),
        &trigger,
        &Criteria::default(),
    )
    .unwrap();
    let reasons = log.hits()[0].reasons();
    assert!(
        matches!(
            reasons,
            [
                Reason::NotTriggered { .. },
                Reason::NonFinite { index: 30, .. }
            ]
        ),
        "{reasons:?}"
    );
}

/// Records with fewer than two samples are refused; two samples are sufficient, at any rate.
#[test]
fn the_shortest_records() {
    for (shape, channels) in [
        ((2, 1), channels()),
        ((2, 0), channels()),
        ((0, 0), Vec::new()),
    ] {
        let from = Provenance::computed("t");
        let refused = Record::new(Array2::ones(shape), 1.0, 0.0, channels, from);
        assert!(matches!(refused, Err(LabioError::TooFewSamples { .. })));
    }
    for rate in [1.0 / 3.0, std::f64::consts::PI, 44_100.0 / 7.0] {
        let two = record([&[1.0, 2.0], &[3.0, 5.0]], rate);
        let spectra = super::averaged(&[two.clone(), two.clone()]);
        assert_eq!(spectra.frequency_hz().len(), 2);
        let half = spectra.frequency_hz()[1];
        assert!((half / rate - 0.5).abs() < 1e-15);
        assert!(integrate(&[1.0, 2.0], rate, LowFrequency::MeanRemoved).is_ok());
        let trigger = Trigger::new(INPUT, 1.5, Extent::Seconds(2.0 / rate)).unwrap();
        assert_eq!(
            find_hits(&two, &trigger, &Criteria::default())
                .unwrap()
                .hits()
                .len(),
            1
        );
    }
}
