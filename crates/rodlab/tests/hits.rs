//! The fields of a sheet about hits: limits that are stated, omitted or set to none, and their rows
//! in the report.

use labio::{Channel, Provenance, Quantity, Record};
use ndarray::Array2;
use rodlab::hits::{FoundHits, HitKind, HitsSheet};
use rodlab::records::NamedRecord;

use crate::runs::Words;

fn sheet(text: &str) -> Result<HitsSheet, String> {
    use ron::extensions::Extensions;
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES)
        .from_str(text)
        .map_err(|error| error.to_string())
}

/// A hit of 100 N after which the level of the force is higher by `shift`.
fn record(name: &str, shift: f64) -> NamedRecord {
    let force = Array2::from_shape_fn((1, 2000), |(_, k)| {
        let t = (k as f64 - 500.0) / 20.0;
        let blow = if (0.0..1.0).contains(&t) {
            100.0 * (std::f64::consts::PI * t).sin()
        } else {
            0.0
        };
        // reproducible noise
        let noise = 0.01 * ((k * k * 7919) % 1013) as f64 / 1013.0;
        blow + noise + if t > 0.0 { shift } else { 0.0 }
    });
    let channels = vec![Channel::new("hammer", Quantity::Force).unwrap()];
    NamedRecord {
        name: name.to_owned(),
        record: Record::new(force, 20e3, 0.0, channels, Provenance::computed("blow")).unwrap(),
    }
}

fn found(text: &str) -> FoundHits {
    let records = [("a.npy", 0.0), ("b.npy", 5.0), ("c.npy", 0.0)];
    found_in(
        text,
        records.map(|(name, shift)| record(name, shift)).into(),
    )
}

fn found_in(text: &str, records: Vec<NamedRecord>) -> FoundHits {
    let sheet = sheet(text).unwrap();
    sheet.find(records, "hammer", "hits").unwrap()
}

fn settings(found: &FoundHits) -> String {
    let settings = found.settings();
    let lines = settings.iter().map(|s| {
        let by = if s.by_default { " (default)" } else { "" };
        format!("{} = {}{by}", s.name, s.value)
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn what_is_not_stated_has_its_default_and_the_report_says_so() {
    let by_default = found("()");
    insta::assert_snapshot!(settings(&by_default), @r"
    hits.channel = hammer (default)
    hits.cut = each record is a hit (default)
    hits.odd = in doubt (default)
    hits.criteria.kind = one short contact (default)
    hits.criteria.peak_over_noise = 10.0 (default)
    hits.criteria.double_hit = 0.05 (default)
    hits.criteria.clipped_run = 3 (default)
    hits.criteria.drop_out_run = 8 (default)
    hits.criteria.static_offset = 0.25 (default)
    hits.criteria.level_shift = 0.02 (default)
    hits.criteria.remainder = 0.01 (default)
    ");
    assert_eq!((by_default.n_found(), by_default.n_accepted()), (3, 2));
    assert_eq!(by_default.accepted().len(), 2);
    insta::assert_snapshot!(by_default.in_words(), @"2 of 3 hits accepted, rejected: level shift 1 (hit 2)");
}

#[test]
fn a_check_that_is_left_out_rejects_nothing() {
    let without = found("(criteria: (level_shift: None, remainder: None, double_hit: 0.2))");
    assert_eq!(without.n_accepted(), 3);
    assert_eq!(without.in_words(), "all 3 hits are accepted");
    let said = settings(&without);
    said.must_say_all(&[
        "hits.criteria.level_shift = not checked",
        "hits.criteria.double_hit = 0.2",
        "hits.criteria.peak_over_noise = 10.0 (default)",
    ]);
}

#[test]
fn r17_every_reason_of_a_rejection_is_told_with_its_hits() {
    let records = || -> Vec<NamedRecord> {
        let shift = |i: i32| if (1..4).contains(&i) { 5.0 } else { 0.0 };
        let records = (0..6).map(|i| record(&format!("{i}.npy"), shift(i)));
        records.collect()
    };
    let rejected =
        "(reject: [(hit: 6, because: \"slipped\")], accept: [(hit: 3, because: \"warm\")])";
    let found = found_in(rejected, records());
    assert_eq!(
        found.in_words(),
        "3 of 6 hits accepted, rejected: level shift 2 (hits 2, 4), by hand 1 (hit 6)"
    );
    let none = "(cut: Trigger(level: \"1 kN\", length: \"10 ms\", pre_trigger: \"1 ms\"))";
    let found = found_in(none, records());
    found.in_words().must_say("not triggered 6 (hits 1-6)");
}

#[test]
fn r17_the_kind_of_hits_sets_the_defaults_and_a_sheet_states_another() {
    let kind = |text: &str, usual| {
        let records = vec![record("a.npy", 5.0)];
        let sheet = sheet(text).unwrap();
        let found = sheet.find_of(usual, records, "hammer", "hits").unwrap();
        (found.n_accepted(), settings(&found))
    };
    let (n, said) = kind("()", HitKind::BarPulses);
    assert_eq!(n, 1);
    said.must_say_all(&[
        "hits.criteria.kind = pulses cut out of waves in a bar (default)",
        "hits.criteria.double_hit = not checked (default)",
        "hits.criteria.level_shift = not checked (default)",
    ]);
    let (n, said) = kind("(criteria: (kind: Hammer))", HitKind::BarPulses);
    assert_eq!(n, 0);
    said.must_say("hits.criteria.remainder = 0.01 (default)");
    let pulses = "(criteria: (kind: BarPulses, level_shift: 0.02))";
    let (n, said) = kind(pulses, HitKind::Hammer);
    assert_eq!(n, 0);
    said.must_say("hits.criteria.level_shift = 0.02");
}

#[test]
fn what_is_no_level_or_stretch_says_why() {
    let said: Vec<String> = [
        r#"(cut: Trigger(level: 20, length: "0.5 s", pre_trigger: "10 ms"))"#,
        r#"(cut: Trigger(level: "20 stones", length: "0.5 s", pre_trigger: "10 ms"))"#,
        r#"(cut: Trigger(level: "20 N", length: "0.5 N", pre_trigger: "10 ms"))"#,
        r#"(cut: Trigger(level: "20 N", length: "4.5 samples", pre_trigger: "10 ms"))"#,
        r#"(cut: Trigger(level: "20 N", length: "0.5 s"))"#,
        r#"(cut: EveryRecord)"#,
        r#"(criteria: (doubel_hit: 0.1))"#,
        r#"(reject: [(hit: 3)])"#,
    ]
    .into_iter()
    .map(|text| sheet(text).unwrap_err())
    .collect();
    insta::assert_snapshot!(said.join("\n"), @r#"
    1:21-1:22: Expected string
    1:23-1:33: `20 stones` has no known unit: `stones` is not among the known symbols, expected a level, such as "20 N"
    1:39-1:45: `0.5 N` has the dimension of a force (m kg s^-2), expected a duration, such as "4 ms", or "4096 samples"
    1:39-1:51: `4.5 samples` is not a whole number of samples, such as "4096 samples"
    1:45: Unexpected missing field named `pre_trigger` in `Trigger`
    1:7-1:18: Unexpected variant named `EveryRecord` in enum `Cut`, expected either `EachRecord` or `Trigger` instead
    1:13-1:23: Unexpected field named `doubel_hit` in `CriteriaSheet`, expected one of `kind`, `force_channel`, `full_scales`, `peak_over_noise`, `double_hit`, `clipped_run`, `drop_out_run`, `static_offset`, `level_shift`, or `remainder` instead
    1:18: Unexpected missing field named `because` in `RulingSheet`
    "#);
    // a pre-trigger that is longer than the hit
    let short = r#"(cut: Trigger(level: "20 N", length: "5 ms", pre_trigger: "10 ms"))"#;
    let (short, records) = (sheet(short).unwrap(), vec![record("a.npy", 0.0)]);
    let error = short.find(records, "hammer", "hits").unwrap_err();
    insta::assert_snapshot!(error, @r"hits, judging hits, a.npy: the hit cut by the trigger has 100 samples, expected at least 201");
}
