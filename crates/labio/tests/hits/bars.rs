//! Waves in bars, and measured hits.

use super::*;

/// Strain at a section of an elastic bar with free ends, hit by a striker of constant section:
/// pulses with a plateau, whose sign changes at every passage, recorded by a converter with 256
/// steps over ±1.3.
fn bar_gauge(noise_over_step: f64, passages: usize, least: f64) -> Vec<f64> {
    let step = 2.6 / 256.0;
    let mut rng = Noise::seeded(3);
    let rise = 60.0;
    let trapezoid = |t: f64, length: f64| {
        ((t / rise).clamp(0.0, 1.0) - ((t - length) / rise).clamp(0.0, 1.0)).clamp(0.0, 1.0)
    };
    let mut arrivals = Vec::new();
    let mut time = 2000.0;
    for passage in 0..passages {
        let sign = if passage % 2 == 0 { -1.0 } else { 1.0 };
        // the first passage may be the smallest, for example behind a specimen that transmits only
        // a small part of it
        let height = if passage == 0 {
            least
        } else {
            1.05 * 0.98_f64.powi(i32::try_from(passage).unwrap())
        };
        arrivals.push((time, sign * height));
        time += if passage % 2 == 0 { 1100.0 } else { 3000.0 };
    }
    (0..20_000)
        .map(|k| {
            let t = f64::from(k);
            let wave: f64 = arrivals
                .iter()
                .map(|(arrival, height)| height * trapezoid(t - arrival, 800.0))
                .sum();
            let exact = wave + noise_over_step * step * rng.normal();
            (exact / step).round() * step
        })
        .collect()
}

fn gauge_record(samples: Vec<f64>, quantity: Quantity) -> Record {
    let n = samples.len();
    let samples = Array2::from_shape_vec((1, n), samples).unwrap();
    record_of(samples, 12.5e6, &[("gauge", quantity)])
}

fn judged(criteria: &Criteria, samples: Vec<f64>, quantity: Quantity) -> Vec<Reason> {
    let record = gauge_record(samples, quantity);
    criteria.judge(&record, "gauge", None).unwrap()
}

fn is_clipped(reasons: &[Reason]) -> bool {
    let clipped = |reason: &Reason| matches!(reason, Reason::Clipped { .. });
    reasons.iter().any(clipped)
}

#[test]
fn r17_waves_in_a_bar_are_not_judged_as_hits_of_a_hammer() {
    let judged = |criteria: &Criteria, noise: f64, passages: usize, least: f64| {
        let samples = bar_gauge(noise, passages, least);
        judged(criteria, samples, Quantity::Strain)
    };
    for noise in [0.0, 0.2, 1.5] {
        for least in [1.05, 0.3, 0.12] {
            // the bar is at rest at the end after 2 passages and still rings after 9
            for passages in [2, 9] {
                let reasons = judged(&Criteria::bar_pulses(), noise, passages, least);
                assert_eq!(
                    reasons,
                    [],
                    "noise {noise}, first {least}, {passages} passages"
                );
            }
            let reasons = judged(&Criteria::bar(), noise, 2, least);
            assert_eq!(reasons, [], "noise {noise}, first {least}");
        }
        // criteria for a record that is transformed as a whole: the bar must have come to rest
        let reasons = judged(&Criteria::bar(), noise, 9, 1.05);
        assert!(
            reasons.iter().any(|reason| matches!(reason,
                Reason::NotDecayed { peak, .. } | Reason::LevelShift { peak, .. }
                    if (peak - 1.05).abs() < 0.08)),
            "{reasons:?}"
        );
        assert!(!judged(&Criteria::hammer(), noise, 9, 1.05).is_empty());
    }
}

#[test]
fn r17_a_limit_is_found_where_noise_tells_it_from_a_plateau() {
    let mut samples = bar_gauge(1.5, 2, 1.05);
    for sample in &mut samples {
        *sample = sample.clamp(-0.8, 0.8);
    }
    for criteria in [Criteria::bar(), Criteria::bar_pulses()] {
        let reasons = judged(&criteria, samples.clone(), Quantity::Strain);
        assert!(
            matches!(reasons.as_slice(), [Reason::Clipped { value, .. }] if value.abs() == 0.8),
            "{reasons:?}"
        );
    }
    // an acceleration has no plateau, so equal samples may be clipping
    let quiet: Vec<f64> = bar_gauge(0.0, 2, 1.05);
    let reasons = judged(&Criteria::bar(), quiet, Quantity::Acceleration);
    assert!(
        reasons.is_empty() || matches!(reasons[0], Reason::Clipped { .. }),
        "{reasons:?}"
    );
}

/// Three equal samples at a crest, in noise of four converter steps: they are clipping between two
/// steep flanks, but not if one flank is flat.
#[test]
fn r17_three_equal_samples_between_noise_are_no_limit() {
    let mut rng = Noise::seeded(5);
    let rest: Vec<f64> = (0..1000).map(|_| (4.0 * rng.normal()).round()).collect();
    for (slope, is_limit) in [(4, false), (100, true)] {
        let mut samples = rest.clone();
        samples.extend((1..100).map(|k| 40.0 * f64::from(k)));
        samples.extend([4000.0; 3]);
        let falling = (1..4000 / slope).map(|k| f64::from(4000 - slope * k));
        samples.extend(falling);
        samples.extend(&rest);
        let reasons = judged(&Criteria::bar(), samples, Quantity::Strain);
        assert_eq!(is_clipped(&reasons), is_limit, "{slope}: {reasons:?}");
    }
}

/// Two equal samples are clipping if a limit cuts off a steep front in a record whose noise has no
/// steps, but not in a record in which every sample is stored twice.
#[test]
fn two_equal_samples_of_a_front_are_a_limit() {
    let mut rng = Noise::seeded(6);
    let front = |k: usize| (k > 1000).then(|| (-((k - 1001) as f64) / 40.0).exp());
    let mut clipped = 0;
    for _ in 0..40 {
        let exact: Vec<f64> = (0..3000)
            .map(|k| front(k).unwrap_or_default() + 5e-3 * rng.normal())
            .collect();
        let limit = exact[1002].min(exact[1001]).min(0.96);
        let cut: Vec<f64> = exact.iter().map(|x| x.min(limit)).collect();
        let repeated: Vec<f64> = exact.iter().flat_map(|x| [*x; 2]).collect();
        let [exact, repeated, cut] = [exact, repeated, cut]
            .map(|samples| is_clipped(&judged(&Criteria::bar(), samples, Quantity::Velocity)));
        assert!(!exact && !repeated);
        clipped += usize::from(cut);
    }
    assert_eq!(clipped, 40);
}

#[test]
fn r17_an_onset_behind_the_record_is_refused() {
    let record = gauge_record(bar_gauge(1.0, 2, 1.05), Quantity::Strain);
    assert!(matches!(
        Criteria::bar().judge(&record, "gauge", Some(20_001)),
        Err(LabioError::CountMismatch { .. })
    ));
}

#[test]
fn measured_hammer_hits_are_accepted_and_found_again_in_one_long_record() {
    let Some(folder) = measured::folder() else {
        return;
    };
    let channels = CHANNELS.map(|(name, quantity)| Channel::new(name, quantity).unwrap());
    let hits: Vec<Record> = (1..=5)
        .map(|number| {
            let path = folder.join(format!("hammer/measurements_{number}.npy"));
            npy::read(path, &channels).unwrap()
        })
        .collect();
    let log = HitLog::of_records(hits.iter().cloned(), FORCE, &Criteria::default()).unwrap();
    assert_eq!(log.accepted().count(), 5, "{log}");
    let n = hits[0].n_samples();
    let samples = Array2::from_shape_fn((2, 5 * n), |(channel, k)| {
        hits[k / n].samples()[[channel, k % n]]
    });
    let rate_hz = hits[0].sampling_rate_hz();
    let long = record_of(samples, rate_hz, &CHANNELS);
    let trigger = Trigger::new(FORCE, 10.0, Extent::Seconds(0.95))
        .unwrap()
        .with_pre_trigger(Extent::Samples(16));
    let log = find_hits(&long, &trigger, &Criteria::default()).unwrap();
    assert_eq!(log.accepted().count(), 5, "{log}");
    // every hit begins 18 to 20 samples after a full second
    for (number, hit) in log.hits().iter().enumerate() {
        let into = (hit.time() - number as f64) * rate_hz;
        assert!((17.0..21.0).contains(&into.round()), "{log}");
    }
}

#[test]
fn r17_measured_records_of_bars_are_accepted() {
    let Some(folder) = measured::folder() else {
        return;
    };
    let volt = labio::Unit::parse("V").unwrap();
    for (file, rate_hz) in [
        (
            "shpb/impact_compression_epoxy_resin_sample_01_raw_voltage.csv",
            12.5e6,
        ),
        ("shpb/epoxy/raw_strain.csv", 12.5e6),
        ("shpb/pmma-13/180303_171828_Ch1.csv", 125e6),
        ("shpb/pmma-13/180303_171828_Ch2.csv", 125e6),
        ("shpb/pmma-13/180303_171828_Ch3.csv", 125e6),
        ("shpb/pmma-13/180303_171828_Ch4.csv", 125e6),
    ] {
        let bytes = std::fs::read(folder.join(file)).unwrap();
        let mut contents = labio::format::read_bytes_at(&bytes, rate_hz).unwrap();
        for series in &mut contents.series {
            series.ordinate_axis.unit = Some(volt.clone());
        }
        let found = contents.records(&Provenance::computed("test"));
        assert_eq!(found.records.len(), 1, "{file}: {:?}", found.left_out);
        let record = &found.records[0];
        let gauge = record.channels()[0].name();
        let reasons = Criteria::bar_pulses().judge(record, gauge, None).unwrap();
        eprintln!("{file}: {reasons:?}");
        assert!(reasons.is_empty(), "{file}: {reasons:?}");
    }
}
