//! Hits found in long records and streams.

use super::*;

/// Five hits in one record: two good hits, a double hit, and a hit cut off at each end.
fn long_record() -> Record {
    let n = 60_000;
    let mut rng = Noise::seeded(8);
    let onsets = [50, 10_000, 25_000, 40_000, 59_000];
    let samples = Array2::from_shape_fn((2, n), |(channel, k)| {
        let deviation = if channel == 0 { 0.05 } else { 0.2 };
        let mut sum = deviation * rng.normal();
        for onset in onsets {
            let t = (k as f64 - f64::from(onset)) / RATE_HZ;
            sum += match channel {
                0 => 80.0 * (contact(t) + ringing(t)),
                _ => response(t),
            };
            if channel == 0 && onset == 40_000 {
                sum += 30.0 * contact(t - 0.03);
            }
        }
        sum
    });
    let channels = CHANNELS.map(|(name, quantity)| Channel::new(name, quantity).unwrap());
    let from = Provenance::computed("test");
    Record::new(samples, RATE_HZ, 2.0, channels.to_vec(), from).unwrap()
}

fn trigger() -> Trigger {
    Trigger::new(FORCE, 20.0, Extent::Seconds(0.8))
        .unwrap()
        .with_pre_trigger(Extent::Samples(400))
}

#[test]
fn a_long_record_is_cut_into_hits_with_their_reasons() {
    let log = find_hits(&long_record(), &trigger(), &Criteria::default()).unwrap();
    // a contact exceeds 20 N from its second sample on; the time axis of the record begins at 2 s
    insta::assert_snapshot!(log.to_string(), @r"
    hits in `force`: 5 found, 2 accepted
        1      2.0052 s  rejected
                          cut at the start: 348 samples are missing before the hit; start the record earlier, with a pre-trigger of about a tenth of its length
        2      3.0002 s  accepted
        3      4.5002 s  accepted
        4      6.0002 s  rejected
                          double hit: two contacts in `force`, peaks in the ratio 0.375, 30.00 ms apart
        5      7.9002 s  rejected
                          cut at the end: 6602 samples are missing after the hit
    ");
    let starts: Vec<f64> = log.accepted().map(Record::start_time).collect();
    // 2 + (10 002 - 400)/10 000; tolerance: the rounding error of one sum
    assert!((starts[0] - 2.9602).abs() < 1e-12 && (starts[1] - 4.4602).abs() < 1e-12);
    let spectra = AveragedSpectra::of(log.accepted(), Window::Rectangular).unwrap();
    assert_eq!(spectra.h1(FORCE, "response").unwrap().n_averages, 2);
}

#[test]
fn the_last_word_is_the_users() {
    let mut log = find_hits(&long_record(), &trigger(), &Criteria::default()).unwrap();
    log.reject(2, "the hammer slipped").unwrap();
    log.accept(4, "the bounce is wanted").unwrap();
    assert!(!log.hits()[1].is_accepted() && log.hits()[3].is_accepted());
    assert_eq!(log.accepted().count(), 2);
    assert!(
        log.to_string()
            .contains("rejected by hand (the hammer slipped)")
    );
    assert_eq!(
        log.accept(1, "why not").unwrap_err().to_string(),
        "hit 1 has no samples"
    );
    assert_eq!(
        log.reject(6, "").unwrap_err().to_string(),
        "hit 6 does not exist"
    );
    assert!(log.accept(0, "").is_err());
}

#[test]
fn a_trigger_that_never_fires_is_an_entry_with_the_reason() {
    let record = hit(|_, _, f, _| *f += 500.0);
    let log = find_hits(&record, &trigger(), &Criteria::default()).unwrap();
    let [entry] = log.hits() else { panic!("{log}") };
    assert!(matches!(entry.reasons()[0], Reason::NotTriggered { .. }));
    assert!(matches!(entry.reasons()[1], Reason::StaticOffset { .. }));
    let negative = hit(|_, _, f, _| *f = -*f);
    let at_minus_20 = Trigger::new(FORCE, -20.0, Extent::Seconds(0.8))
        .unwrap()
        .with_pre_trigger(Extent::Samples(400))
        .with_slope(Slope::Falling);
    let log = find_hits(&negative, &at_minus_20, &Criteria::default()).unwrap();
    assert_eq!(log.accepted().count(), 1, "{log}");
    let unknown = Trigger::new("hammer", 1.0, Extent::Seconds(0.1)).unwrap();
    assert!(matches!(
        find_hits(&record, &unknown, &Criteria::default()),
        Err(LabioError::UnknownChannel { .. })
    ));
}

#[test]
fn a_stream_that_marks_lost_samples_loses_only_that_hit() {
    let record = long_record();
    let mut samples = record.samples().to_owned();
    samples[[1, 10_100]] = f64::NAN;
    let mut source = InBlocks::new(record.channels(), RATE_HZ, samples, 5000);
    let provenance = Provenance::computed("test");
    let log =
        find_hits_in_blocks(&mut source, &provenance, &trigger(), &Criteria::default()).unwrap();
    assert_eq!(log.accepted().count(), 1);
    // sample 10 100 of the record, in a hit that begins at sample 10 002 - 400
    assert_eq!(
        log.hits()[1].reasons(),
        [Reason::NonFinite {
            channel: "response".to_owned(),
            index: 498
        }]
    );
}

/// Irregular records: constant levels, random runs, spikes and very large numbers.
fn ugly() -> impl Strategy<Value = Vec<f64>> {
    let piece = prop_oneof![
        (-5.0..5.0, 1_usize..20).prop_map(|(level, n)| vec![level; n]),
        proptest::collection::vec(-2.0..2.0, 1..20),
        prop_oneof![Just(1e308), Just(-1e308), Just(0.0), Just(5e-324)].prop_map(|x| vec![x]),
    ];
    proptest::collection::vec(piece, 2..12).prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn no_record_panics_and_streams_agree(
        samples in ugly(),
        level in -3.0..3.0,
        length in 2_usize..40,
        before in 0_usize..12,
        hold_off in 1_usize..30,
        hysteresis in 0.0..2.0,
        most in 1_usize..30,
    ) {
        prop_assume!(samples.len() > 1 && before < length);
        let n = samples.len();
        let both = Array2::from_shape_fn((2, n), |(channel, k)| {
            if channel == 0 { samples[k] } else { samples[n - 1 - k] }
        });
        let record = record_of(both, 1.0, &CHANNELS.map(|(name, _)| (name, Quantity::Force)));
        let trigger = Trigger::new(FORCE, level, Extent::Samples(length))
            .unwrap()
            .with_pre_trigger(Extent::Samples(before))
            .with_slope(Slope::Either)
            .with_hold_off(Extent::Samples(hold_off))
            .with_hysteresis(hysteresis)
            .unwrap();
        let criteria = Criteria::default().with_full_scale(FORCE, 4.0).unwrap();
        let whole = find_hits(&record, &trigger, &criteria).unwrap();
        let mut source = InBlocks::new(record.channels(), 1.0, record.samples().to_owned(), most);
        let provenance = Provenance::computed("test");
        let streamed = find_hits_in_blocks(&mut source, &provenance, &trigger, &criteria).unwrap();
        if !matches!(whole.hits()[0].reasons(), [Reason::NotTriggered { .. }, ..]) {
            prop_assert_eq!(whole, streamed);
        }
    }
}
