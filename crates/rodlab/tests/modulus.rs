//! The job `modulus` as a laboratory runs it, on virtual records whose truth is known.
//!
//! The ends of the rod of paper A are by chain recursion and damped Fourier transform; the pulses
//! in a long rod by an explicit march of masses, springs and dashpots. Neither knows the equations
//! that the methods solve.

use crate::virtual_rod;

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use num_complex::Complex64;
use rodlab::outcome::{Cells, Verdict};
use rodlab::{Outcome, output};
use tempfile::TempDir;
use virtual_rod::{FAST_RATE_HZ, LongRod, RATE_HZ, SAMPLES};

use crate::runs::{column as numbers, outcome_of as run};

/// A sheet for the rod of paper A; hits in one long recording.
fn sheet(method: &str, rest: &str) -> String {
    format!(
        r#"Modulus(
    title: "Polypropylene, Test 6",
    specimen: (length: "799 mm ± 0.29 mm", diameter: "15.8 mm ± 0.03 mm", density: "912 kg/m3 ± 0.29 kg/m3",
        accelerometer_mass: "2.9 gram ± 0.03 gram"),
    // the waves of the rig are one-dimensional
    lateral_inertia: (poisson_ratio: "0"),
    method: {method},
    source: Hits(
        records: (
            files: ["hits.npy"],
            sampling_rate: "{RATE_HZ} Hz",
            channels: [
                (name: "struck end", from: 1, unit: "V", sensitivity: "0.5 mV/g"),
                (name: "free end", from: 2, unit: "V", sensitivity: "0.5 mV/g"),
            ],
        ),
        hits: (
            cut: Trigger(level: "2000 m/s2", length: "{SAMPLES} samples", pre_trigger: "1 ms"),
        ),
    ),
    {rest}
)"#
    )
}

const TWO_POINT: &str = r#"TwoPoint(impacted_end: "struck end", free_end: "free end")"#;
const BAND: &str = r#"band: (from: "50 Hz", to: "20 kHz"),"#;

fn is_valid(outcome: &Outcome) -> Vec<bool> {
    let table = outcome.tables.iter().find(|t| t.name == "modulus").unwrap();
    match &table.columns.last().unwrap().cells {
        Cells::Validity { valid, words } => {
            let said: Vec<bool> = words.iter().map(|word| word == "valid").collect();
            assert_eq!(*valid, said);
            said
        }
        _ => panic!("no validity"),
    }
}

/// Every valid line against the truth: within the accepted limits of 1 % and 5 %, and for E'
/// scattered as its errors say.
fn check_lines(outcome: &Outcome, exact: &dyn Fn(f64) -> Complex64) -> (usize, f64) {
    let frequency = numbers(outcome, "modulus", "frequency");
    let storage = numbers(outcome, "modulus", "E'");
    let storage_error = numbers(outcome, "modulus", "standard error of E'");
    let loss = numbers(outcome, "modulus", "loss factor");
    let (mut count, mut squares) = (0, 0.0);
    for (line, valid) in is_valid(outcome).iter().enumerate() {
        if !valid {
            continue;
        }
        let truth = exact(frequency[line]);
        let deviation = 1e9 * storage[line] - truth.re;
        assert!(
            deviation.abs() < 0.01 * truth.re,
            "E' at {} Hz: {} GPa, exact {}",
            frequency[line],
            storage[line],
            1e-9 * truth.re
        );
        let eta = truth.im / truth.re;
        assert!(
            (loss[line] - eta).abs() < 0.05 * eta,
            "loss factor at {} Hz: {}, exact {eta}",
            frequency[line],
            loss[line]
        );
        squares += (deviation / (1e9 * storage_error[line])).powi(2);
        count += 1;
    }
    assert!(count > 0);
    // the errors of the specimen are in the standard errors but not in the records: at most what
    // noise alone would be
    let mean_square = squares / f64::from(count);
    assert!(mean_square < 1.5, "{mean_square} of {count} lines");
    (usize::try_from(count).unwrap(), mean_square)
}

#[test]
fn ten_hits_on_polypropylene_give_its_modulus_within_the_stated_errors() {
    let folder = TempDir::new().unwrap();
    let rod = virtual_rod::polypropylene();
    virtual_rod::write_hits(folder.path(), 10, 1993);
    let laws = r#"laws: (laws: [Zener, GeneralisedMaxwell, PowerLaw], cards: (name: "PP", poisson_ratio: "0.40", programs: [Abaqus, Ansys, LsDyna])),"#;
    let text = sheet(
        TWO_POINT,
        &format!("{BAND}\n{laws}\nreport_at: [\"1 kHz\", \"5 kHz\", \"40 kHz\"],"),
    );
    let outcome = run(folder.path(), &text).unwrap();
    for sentence in outcome.summary.iter().chain(&outcome.warnings) {
        println!("{sentence}");
    }
    assert_eq!(outcome.verdict, Verdict::Answered);
    let (count, _) = check_lines(&outcome, &rod);
    assert!(count > 700, "{count}");

    // the first sentence, with the number that stands in the table
    assert!(
        outcome.summary[0].starts_with("E' = 2."),
        "{}",
        outcome.summary[0]
    );
    assert!(outcome.summary[0].contains("valid from"));
    let at_5_khz = outcome
        .quantities
        .iter()
        .find(|q| q.name == "storage modulus at 4.992 kHz")
        .unwrap_or_else(|| panic!("{:?}", outcome.quantities));
    let (value, error) = (at_5_khz.value.unwrap(), at_5_khz.standard_error.unwrap());
    assert!((1e9 * value - rod(4992.0).re).abs() < 3e9 * error);
    let beyond = outcome
        .quantities
        .iter()
        .find(|q| q.name == "storage modulus at 40 kHz");
    assert!(beyond.is_some_and(|q| q.value.is_none() && !q.valid));

    // all that was decided is in the log: ten hits, and the lines
    let hits = outcome
        .log
        .iter()
        .filter(|entry| entry.what.starts_with("hit "));
    assert_eq!(hits.clone().count(), 10);
    assert!(
        hits.clone().all(|entry| entry.accepted),
        "{:?}",
        outcome.log
    );
    assert!(
        outcome
            .log
            .iter()
            .any(|entry| entry.what.contains("lines are valid"))
    );
    // checks of an honest record
    for check in ["passivity", "Kramers-Kronig", "causality", "polarity"] {
        let name = format!("check: {check}");
        let made = outcome
            .quantities
            .iter()
            .find(|q| q.name.starts_with(&name));
        let made = made.unwrap_or_else(|| panic!("{name}: {:?}", outcome.log));
        assert_eq!(made.verdict, "passed", "{}", made.name);
    }
    let figures: Vec<&str> = outcome.figures.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(
        figures,
        [
            "hits",
            "ratio",
            "modulus",
            "cole_cole",
            "dispersion",
            "waves",
            "laws"
        ]
    );
    let attachments: Vec<&str> = outcome
        .attachments
        .iter()
        .map(|a| a.name.as_str())
        .collect();
    assert_eq!(
        attachments,
        ["ratio.uff", "material.json", "PP.inp", "PP.mac", "PP.k"]
    );

    // the universal file is a source as good as the hits
    fs::write(
        folder.path().join("ratio.uff"),
        &outcome.attachments[0].bytes,
    )
    .unwrap();
    let start = text.find("source: Hits").unwrap();
    let end = text.find("band:").unwrap();
    let from_file = format!(
        "{}source: Ratio(path: \"ratio.uff\", values: Complex(1), errors: Coherence(column: 2, averages: 10)),\n{}",
        &text[..start],
        &text[end..]
    );
    let other = run(folder.path(), &from_file).unwrap();
    let first = |outcome: &Outcome| numbers(outcome, "modulus", "E'").to_vec();
    for (a, b) in first(&other).iter().zip(first(&outcome)) {
        // digits of the file, amplified where lines are singular
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    // a file does not tell the power of the noise, so that its variances are not pooled over lines:
    // some at the limits differ
    let pairs = is_valid(&other).into_iter().zip(is_valid(&outcome));
    let (mut both, mut one) = (0, 0);
    for pair in pairs {
        both += usize::from(pair == (true, true));
        one += usize::from(pair.0 != pair.1);
    }
    assert!(10 * one < both, "{one} of {both}");

    let again = run(folder.path(), &text).unwrap();
    assert_eq!(
        output::json_of(&again, &identity()).unwrap(),
        output::json_of(&outcome, &identity()).unwrap()
    );
}

/// A sensitivity that is 2 % off and a skew that is none: within what the sheet says of them, the
/// lines tell; beyond, they contradict it.
#[test]
fn errors_of_the_sensors_are_found_and_taken_out() {
    let folder = TempDir::new().unwrap();
    let rod = virtual_rod::polypropylene();
    virtual_rod::write_hits(folder.path(), 10, 1993);
    let with = |sensitivity: &str, skew: &str| {
        let channel = r#"from: 2, unit: "V", sensitivity: "0.5 mV/g""#;
        let text = sheet(TWO_POINT, BAND);
        assert!(text.contains(channel));
        let changed =
            format!(r#"from: 2, unit: "V", sensitivity: "{sensitivity}", time_skew: "{skew}""#);
        run(folder.path(), &text.replace(channel, &changed)).unwrap()
    };
    let found = |outcome: &Outcome, name: &str| {
        let mut quantities = outcome.quantities.iter();
        let quantity = quantities.find(|quantity| quantity.name == name).unwrap();
        (quantity.value.unwrap(), quantity.standard_error.unwrap())
    };
    let right = with("0.51 mV/g ± 2 %", "4 us ± 3 us");
    assert_eq!(right.verdict, Verdict::Answered);
    check_lines(&right, &rod);
    let (gain, error) = found(&right, "error of the ratio of the sensitivities, found");
    // the denominator is read too small: four standard errors
    assert!(
        (gain - 100.0 * 1.02_f64.ln()).abs() < 4.0 * error && error < 0.1,
        "{gain} {error}"
    );
    let (delay, error) = found(&right, "delay between the channels, found");
    assert!(
        (delay.abs() - 4.0).abs() < 4.0 * error && error < 0.1,
        "{delay} {error}"
    );

    let wrong = with("0.6 mV/g ± 1 %", "0 us");
    let Verdict::InDoubt { reasons } = &wrong.verdict else {
        panic!("{:?}", wrong.verdict);
    };
    let reasons = reasons.join("; ");
    assert!(
        reasons.contains("more than its stated uncertainty explains"),
        "{reasons}"
    );
}

#[test]
fn two_sections_and_a_free_end_and_resonances_agree_with_the_two_point_method() {
    let folder = TempDir::new().unwrap();
    let rod = virtual_rod::polypropylene();
    virtual_rod::write_hits(folder.path(), 10, 7);
    let free_end = r#"FreeEnd(first: (channel: "struck end", from_free_end: "799 mm"), second: (channel: "free end", from_free_end: "0 mm"), wave_speed: "1700 m/s")"#;
    // the distances of the sections stand for the length
    let text = sheet(free_end, BAND).replace(" ± 0.29 mm", "");
    let outcome = run(folder.path(), &text).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    assert!(check_lines(&outcome, &rod).0 > 600);

    let resonances = r#"Resonances(impacted_end: "struck end", free_end: "free end")"#;
    let outcome = run(folder.path(), &sheet(resonances, BAND)).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    let (count, _) = check_lines(&outcome, &rod);
    // kL = (n - 1/2)π up to 20 kHz
    assert!((5..20).contains(&count), "{count}");
}

/// Gauges on a rod that is free at both ends, each hit in a file of its own.
fn gauge_sheet(method: &str, positions: &[(usize, &str)], rest: &str) -> String {
    let channels: Vec<String> = positions
        .iter()
        .map(|(from, _)| format!("(name: \"gauge {from}\", from: {from}, unit: \"µε\")"))
        .collect();
    let gauges: Vec<String> = positions
        .iter()
        .map(|(from, at)| format!("(channel: \"gauge {from}\", at: \"{at}\")"))
        .collect();
    format!(
        r#"Modulus(title: "Gauges", specimen: (diameter: "15.8 mm", density: "912 kg/m3"),
    method: {method}(gauges: [{}]{rest}),
    source: Hits(
        records: (files: ["gauges_*.npy"], sampling_rate: "{RATE_HZ} Hz", channels: [{}]),
        hits: (criteria: (peak_over_noise: 5.0)),
        silent: "1.5 ms",
    ),
    band: (from: "200 Hz", to: "12 kHz"),
    lateral_inertia: (poisson_ratio: "0"),
)"#,
        gauges.join(", "),
        channels.join(", ")
    )
}

#[test]
fn gauges_along_a_rod_give_its_modulus_and_see_its_free_end() {
    let folder = TempDir::new().unwrap();
    let rod = virtual_rod::polypropylene();
    virtual_rod::write_gauges(folder.path(), &[0.25, 0.29, 0.40, 0.48, 0.55], 5, 11);
    let five = [
        (1, "250 mm"),
        (2, "290 mm"),
        (3, "400 mm"),
        (4, "480 mm"),
        (5, "550 mm"),
    ];
    let text = gauge_sheet("MultiPoint", &five, ", free_end_at: \"800 mm\"");
    let outcome = run(folder.path(), &text).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    let (count, mean_square) = check_lines(&outcome, &rod);
    assert!(count > 400, "{count} {:?}", outcome.summary);
    // the errors are of noise alone, which the silence before the hits tells: of so many lines the
    // mean is 1 within some per cent, and the noise is known to 10 %
    assert!((mean_square - 1.0).abs() < 0.35, "{mean_square}");
    let null = outcome
        .quantities
        .iter()
        .find(|q| q.name == "check: free-end null, p-value")
        .unwrap_or_else(|| panic!("{:?}", outcome.log));
    assert!(null.valid, "{null:?}");

    // a gauge that is 8 mm from where the sheet says it is
    let moved = gauge_sheet(
        "MultiPoint",
        &[five[0], five[1], (3, "408 mm"), five[3], five[4]],
        ", free_end_at: \"800 mm\"",
    );
    let outcome = run(folder.path(), &moved).unwrap();
    let Verdict::NotAllowed { reason } = &outcome.verdict else {
        panic!("{:?}", outcome.summary)
    };
    assert!(
        reason.contains("two waves do not explain the gauges"),
        "{reason}"
    );

    let three = gauge_sheet("ThreePoint", &[five[0], five[2], five[4]], "");
    let outcome = run(folder.path(), &three).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    assert!(check_lines(&outcome, &rod).0 > 200);
}

#[test]
fn pulses_in_a_long_rod_give_the_modulus_by_two_sections_and_by_one() {
    let folder = TempDir::new().unwrap();
    let rod = LongRod {
        length: 3.0,
        stiffness: 2.6e9,
        viscosity: 2500.0,
        density: 912.0,
    };
    rod.write_pulses(folder.path(), [1.0, 2.0], 8, 3);
    let exact = |f: f64| Complex64::new(rod.stiffness, TAU * f * rod.viscosity);
    let sheet = |method: &str| {
        format!(
            r#"Modulus(title: "Pulses", specimen: (diameter: "10 mm", density: "912 kg/m3 ± 0.1 %"), method: {method},
    source: Hits(
        records: (
            files: ["pulses_*.npy"], sampling_rate: "{FAST_RATE_HZ} Hz",
            channels: [(name: "first", from: 1, unit: "µε"), (name: "second", from: 2, unit: "µε")],
        ),
        // the records end while the pulses still run to and fro
        hits: (criteria: (remainder: None, level_shift: None)),
    ),
    band: (from: "500 Hz", to: "8 kHz"), limits: (loss_factor: "20 %"),
)"#
        )
    };
    // the wave passes at 0.59 ms and 1.18 ms after the blow, and comes back to the second section
    // at 2.37 ms
    let two = r#"SeparatePulses(first: (channel: "first", from: "1.4 ms", to: "2.3 ms"), second: (channel: "second", from: "2.0 ms", to: "3.0 ms"), distance: "1000 mm ± 0.5 mm")"#;
    let one = r#"OneGauge(section: (channel: "second", from_free_end: "1000 mm"), incident: ("2.0 ms", "3.0 ms"), reflected: ("3.2 ms", "4.3 ms"))"#;
    for (method, fewest) in [(two, 10), (one, 10)] {
        let outcome = run(folder.path(), &sheet(method)).unwrap();
        assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
        let frequency = numbers(&outcome, "modulus", "frequency");
        let storage = numbers(&outcome, "modulus", "E'");
        let loss = numbers(&outcome, "modulus", "loss factor");
        let mut count = 0;
        for (line, _) in is_valid(&outcome).iter().enumerate().filter(|(_, v)| **v) {
            let truth = exact(frequency[line]);
            // the accepted errors, and what the discrete rod differs
            assert!(
                (1e9 * storage[line] / truth.re - 1.0).abs() < 0.011,
                "{} Hz",
                frequency[line]
            );
            let eta = truth.im / truth.re;
            assert!(
                (loss[line] / eta - 1.0).abs() < 0.21,
                "{} Hz",
                frequency[line]
            );
            count += 1;
        }
        assert!(count >= fewest, "{count}");
    }
}

#[test]
fn a_ratio_of_another_program_is_taken_with_its_coherence() {
    let folder = TempDir::new().unwrap();
    let rod = virtual_rod::polypropylene();
    // cosh γL without an accelerometer, exactly
    let mut file = "Frequency [Hz],real,imaginary,coherence\n".to_owned();
    for j in 1..=400 {
        let f = 25.0 * f64::from(j);
        let omega = TAU * f;
        let gamma = Complex64::new(0.0, omega) * (912.0 / rod(f)).sqrt();
        let ratio = (0.8 * gamma).cosh();
        writeln!(file, "{f},{},{},0.9999", ratio.re, ratio.im).unwrap();
    }
    fs::write(folder.path().join("psi.csv"), file).unwrap();
    let text = r#"Modulus(title: "By hand", specimen: (length: "800 mm", diameter: "10 mm", density: "912 kg/m3"),
    method: TwoPoint(impacted_end: "A", free_end: "B"),
    source: Ratio(
        path: "psi.csv", values: Parts(real: "real", imaginary: "imaginary"),
        errors: Coherence(column: "coherence", averages: 20),
    ),
    limits: (loss_factor: "20 %", storage_modulus: "3 %"),
    lateral_inertia: (poisson_ratio: "0.40 ± 0.02"),
)"#;
    let outcome = run(folder.path(), text).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    let frequency = numbers(&outcome, "modulus", "frequency").to_vec();
    let with = numbers(&outcome, "modulus", "E' with lateral inertia in it").to_vec();
    let without = numbers(&outcome, "modulus", "E'");
    for (line, _) in is_valid(&outcome).iter().enumerate().filter(|(_, v)| **v) {
        let truth = 1e-9 * rod(frequency[line]).re;
        assert!(
            (with[line] / truth - 1.0).abs() < 1e-6,
            "{} Hz",
            frequency[line]
        );
        assert!(without[line] >= with[line]);
    }
    assert_eq!(outcome.inputs[0].path, "psi.csv");
    let again = run(folder.path(), text).unwrap();
    assert_eq!(
        output::json_of(&again, &identity()).unwrap(),
        output::json_of(&outcome, &identity()).unwrap()
    );
}

#[test]
fn one_hit_without_a_known_silence_is_not_allowed() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 1, 5);
    let whole = sheet(TWO_POINT, BAND);
    let cut = whole.find("cut: Trigger").unwrap();
    let end = cut + whole[cut..].find('\n').unwrap();
    let uncut = format!("{}cut: EachRecord,{}", &whole[..cut], &whole[end..]);
    let outcome = run(folder.path(), &uncut).unwrap();
    let Verdict::NotAllowed { reason } = &outcome.verdict else {
        panic!("{:?}", outcome.summary)
    };
    insta::assert_snapshot!(reason, @"1 hit is accepted of 1 found, expected at least 2: the coherence of one is 1 whatever was measured. State in `source.silent` how long the record is silent before the blow, and the errors of one hit are read there");
    assert_eq!(outcome.figures.len(), 1);
}

#[test]
fn ends_that_are_interchanged_are_not_allowed_and_say_why() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 4, 5);
    let turned = sheet(
        r#"TwoPoint(impacted_end: "free end", free_end: "struck end")"#,
        BAND,
    );
    let turned = turned.replace("cut: Trigger", "channel: \"struck end\", cut: Trigger");
    let outcome = run(folder.path(), &turned).unwrap();
    let Verdict::NotAllowed { reason } = &outcome.verdict else {
        panic!("{:?}", outcome.summary)
    };
    assert!(reason.contains("number of waves in doubt"), "{reason}");

    // a sensor that points the other way
    let inverted = sheet(TWO_POINT, BAND).replace(
        "(name: \"free end\", from: 2,",
        "(name: \"free end\", from: 2, inverted: true,",
    );
    let outcome = run(folder.path(), &inverted).unwrap();
    let Verdict::InDoubt { reasons } = &outcome.verdict else {
        panic!("{:?}", outcome.summary)
    };
    assert!(
        reasons
            .iter()
            .any(|reason| reason.starts_with("the check of polarity fails")),
        "{reasons:?}"
    );
    assert!(
        outcome.summary[0].contains("polarity"),
        "{:?}",
        outcome.summary
    );

    // rejected by hand
    let all = sheet(TWO_POINT, BAND).replace(
        "cut: Trigger",
        "reject: [(hit: 1, because: \"slipped\"), (hit: 2, because: \"slipped\"), (hit: 3, because: \"slipped\")], cut: Trigger",
    );
    let outcome = run(folder.path(), &all).unwrap();
    assert!(matches!(outcome.verdict, Verdict::NotAllowed { .. }));
    assert!(
        outcome
            .summary
            .iter()
            .any(|s| s.contains("1 of 4 hits accepted, rejected: by hand 3 (hits 1-3)")),
        "{:?}",
        outcome.summary
    );
}

/// `hits.npy` of the folder under another name, each sample changed.
fn again(folder: &Path, name: &str, change: impl Fn(f64) -> f64) {
    let mut bytes = fs::read(folder.join("hits.npy")).unwrap();
    let begin = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    for number in bytes[begin..].chunks_exact_mut(8) {
        let value = f64::from_le_bytes(number.try_into().unwrap());
        number.copy_from_slice(&change(value).to_le_bytes());
    }
    fs::write(folder.join(name), bytes).unwrap();
}

#[test]
fn r10_hits_that_are_one_measurement_are_refused_or_in_doubt() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 2, 7);
    let two_files =
        sheet(TWO_POINT, BAND).replace("[\"hits.npy\"]", "[\"hits.npy\", \"more.npy\"]");
    let said = || run(folder.path(), &two_files).unwrap_err().to_string();
    again(folder.path(), "more.npy", |volts| volts);
    insta::assert_snapshot!(said(), @"hits.npy and more.npy have the same content: they are one measurement, expected independent ones: take one of the two out of the sheet");
    again(folder.path(), "more.npy", |volts| {
        f64::from(1.3_f32 * volts as f32)
    });
    insta::assert_snapshot!(said(), @"hit 1, hits.npy at 0.0020 s and hit 3, more.npy at 0.0020 s have the same samples: they are one measurement, expected independent ones: take one of the two out of the sheet");
    let one_channel = sheet(TWO_POINT, BAND).replace("from: 2", "from: 1");
    insta::assert_snapshot!(run(folder.path(), &one_channel).unwrap_err(), @"channel `struck end` and channel `free end` of hit 1, hits.npy at 0.0020 s have the same samples: they are one measurement, expected independent ones: take one of the two out of the sheet");

    // the same hits, stored with a fifth of the bits of noise less
    let step = 2e-7;
    again(folder.path(), "more.npy", |volts| {
        (volts / step).round() * step
    });
    let outcome = run(folder.path(), &two_files).unwrap();
    let Verdict::InDoubt { reasons } = &outcome.verdict else {
        panic!("{:?}", outcome.summary)
    };
    let copies = reasons
        .iter()
        .filter(|reason| reason.contains(" differ by "));
    assert_eq!(copies.count(), 2, "{reasons:?}");
    assert!(
        reasons[0]
            .starts_with("hit 1, hits.npy at 0.0020 s and hit 3, more.npy at 0.0020 s differ by "),
        "{reasons:?}"
    );
}

#[test]
fn r10_hits_without_any_noise_are_refused() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 1, 7);
    // the second hit is the first, filtered: no copy, and a coherence of 1
    let mut bytes = fs::read(folder.path().join("hits.npy")).unwrap();
    let begin = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let half = (bytes.len() - begin) / 2;
    for channel in 0..2 {
        let row = &mut bytes[begin + channel * half..begin + (channel + 1) * half];
        let samples: Vec<f64> = row
            .chunks_exact(8)
            .map(|number| f64::from_le_bytes(number.try_into().unwrap()))
            .collect();
        for (n, number) in row.chunks_exact_mut(8).enumerate() {
            // circular, as the transform is
            let before = samples[(n + samples.len() - 40) % samples.len()];
            number.copy_from_slice(&(samples[n] + 0.5 * before).to_le_bytes());
        }
    }
    fs::write(folder.path().join("more.npy"), bytes).unwrap();
    let text = sheet(TWO_POINT, BAND)
        .replace("[\"hits.npy\"]", "[\"hits.npy\", \"more.npy\"]")
        .replace("cut: Trigger(level: \"2000 m/s2\", length: \"4096 samples\", pre_trigger: \"1 ms\"),", "criteria: (double_hit: None, remainder: None, static_offset: None, level_shift: None),");
    insta::assert_snapshot!(run(folder.path(), &text).unwrap_err(), @"source: the coherence of `free end` and `struck end` is 1 to rounding over 2 hits, expected hits with noise of their own: these are copies of one hit, or computed without noise");
}

#[test]
fn r24_without_a_band_the_checks_look_at_lines_with_signal_below_the_aliases() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 6, 11);
    let checked = |rest: &str| {
        let outcome = run(folder.path(), &sheet(TWO_POINT, rest)).unwrap();
        assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
        let setting = outcome
            .settings
            .iter()
            .find(|s| s.name == "band of the checks");
        (setting.map(|s| s.value.clone()), outcome.warnings)
    };
    let (band, warnings) = checked("");
    let band = band.unwrap();
    assert!(
        band.contains(" to 16.38 kHz: the coherence is above that of chance, no alias is to be expected below 16.38 kHz, half the Nyquist frequency"),
        "{band}"
    );
    assert!(
        warnings
            .iter()
            .any(|w| w.starts_with("No `band` is stated: the checks look at the lines from ")),
        "{warnings:?}"
    );
    let (band, _) = checked(r#"checks: (alias_free_to: "14 kHz"),"#);
    assert!(band.unwrap().contains("aliases are kept away up to 14 kHz"));
    assert_eq!(checked(BAND).0, None);
    let wrong = sheet(TWO_POINT, r#"checks: (alias_free_to: "40 kHz"),"#);
    insta::assert_snapshot!(run(folder.path(), &wrong).unwrap_err(), @"checks.alias_free_to is 40 kHz, expected at most 32.77 kHz, the Nyquist frequency");
}

#[test]
fn what_is_wrong_is_said() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 2, 5);
    fs::write(
        folder.path().join("psi.csv"),
        "Frequency [Hz],real,imaginary\n10,1,0\n20,0.9,0.1\n30,0.8,0.1\n",
    )
    .unwrap();
    let ratio = |method: &str, source: &str| {
        format!(
            "Modulus(title: \"a\", specimen: (diameter: \"10 mm\", density: \"912 kg/m3\"), method: {method}, source: Ratio({source}))"
        )
    };
    let parts = "path: \"psi.csv\", values: Parts(real: \"real\", imaginary: \"imaginary\")";
    let gauges = "MultiPoint(gauges: [(channel: \"a\", at: \"0 mm\")])";
    let cut = format!(
        "cut: Trigger(level: \"2000 m/s2\", length: \"{SAMPLES} samples\", pre_trigger: \"1 ms\"),"
    );
    let sheets = [
        sheet(TWO_POINT, "band: (from: \"40 kHz\", to: \"50 kHz\"),"),
        sheet(TWO_POINT, BAND).replace("free_end: \"free end\"", "free_end: \"end B\""),
        sheet(TWO_POINT, BAND).replace("length: \"799 mm ± 0.29 mm\", ", ""),
        sheet(gauges, BAND)
            .replace("channel: \"a\"", "channel: \"struck end\"")
            .replace(&cut, ""),
        sheet(TWO_POINT, "checks: (level: \"2\"),"),
        sheet(
            TWO_POINT,
            "laws: (laws: [Zener], cards: (name: \"PP\", poisson_ratio: \"0.4\", programs: [Abaqus])), band: (from: \"50 Hz\", to: \"20 kHz\"),",
        ),
        sheet(TWO_POINT, "limits: (coherence: \"1.2\"),"),
        ratio(
            gauges,
            &format!("{parts}, errors: Relative(of_value: \"0.1 %\")"),
        ),
        ratio(
            TWO_POINT,
            &format!("{parts}, errors: Coherence(column: \"gamma\", averages: 5)"),
        ),
        ratio(
            TWO_POINT,
            &format!("{parts}, errors: Relative(of_value: \"1 mm\")"),
        ),
        ratio(
            TWO_POINT,
            "path: \"psi.csv\", values: Complex(1), errors: Relative(of_value: \"0.1 %\")",
        ),
        ratio(
            "FreeEnd(first: (channel: \"a\", from_free_end: \"100 mm\"), second: (channel: \"b\", from_free_end: \"0 mm\"))",
            &format!("{parts}, errors: Relative(of_value: \"0.1 %\")"),
        ),
    ];
    let uneven = "path: \"errors.csv\", values: Parts(real: 1, imaginary: 2), errors: StandardError(column: 3)";
    fs::write(
        folder.path().join("errors.csv"),
        "Frequency [Hz],real,imaginary,error\n10,1,0,0.1\n20,0.9,0.1,-0.1\n30,0.8,0.1,0.1\n",
    )
    .unwrap();
    let more = [
        ratio(TWO_POINT, uneven),
        sheet("MultiPoint(gauges: [])", BAND),
        sheet(TWO_POINT, "laws: (laws: [Zener], most_lines: 0),"),
        sheet(TWO_POINT, "laws: (laws: []),"),
    ];
    // not every method follows what is uncertain of a rod
    let exact = |text: &str| {
        let of_rod = [" ± 0.03 mm", " ± 0.29 mm", " ± 0.03 gram"];
        of_rod
            .iter()
            .fold(text.to_owned(), |text, stated| text.replace(stated, ""))
    };
    let messages: Vec<String> = sheets
        .iter()
        .chain(&more)
        .map(|text| match run(folder.path(), &exact(text)) {
            Ok(outcome) => format!("no error: {:?}", outcome.summary),
            Err(error) => error
                .to_string()
                .replace(&folder.path().display().to_string(), "FOLDER"),
        })
        .collect();
    insta::assert_snapshot!(messages.join("\n"), @r#"
    band is 40 kHz to 50 kHz, expected a band with lines, which lie between 0 and 32768 Hz
    method.free_end is `end B`, expected one of the channels `struck end`, `free end`
    specimen.length is missing, expected the length, which TwoPoint needs
    source.silent is missing, expected how long each hit's record is silent before the blow: the weights of the gauges are from their noise there
    checks.level is 2, expected a probability between 0 and 1
    laws.cards is asked for, expected `GeneralisedMaxwell` among `laws.laws`, of which cards are made
    finding the modulus: least coherence is 1.2, expected a value from 0 to 1
    source is a ratio, expected hits: MultiPoint needs the spectra of all gauges
    source.errors.column (psi.csv) is `gamma`, expected one of the columns `real`, `imaginary`
    FOLDER/test.ron:1:253: Modulus.source.Ratio.errors.Relative.of_value: `1 mm` has the dimension m, expected a pure number, as "0.094" or "9.4 %"
    source.values (psi.csv) is `real`, a column of real numbers, expected complex numbers, or `real` and `imaginary` apart
    method.first.quantity is missing, expected Strain, Displacement, Velocity or Acceleration: a ratio in a file does not tell
    source.errors.column, line 2 is -0.1, expected a standard error of 0 or more
    method.gauges is empty, expected at least three gauges
    laws.most_lines is 0, expected at least 1
    laws.laws is empty, expected at least one law
    "#);
}

#[test]
fn the_template_is_a_sheet_that_runs() {
    let folder = TempDir::new().unwrap();
    virtual_rod::write_hits(folder.path(), 6, 2);
    let template = include_str!("../templates/modulus.ron");
    let outcome = run(folder.path(), template).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    // two sensitivities of 1 % each, of which the lines tell more
    let mut quantities = outcome.quantities.iter();
    let gain = quantities
        .find(|quantity| quantity.name == "error of the ratio of the sensitivities, found")
        .unwrap();
    assert!(gain.standard_error.unwrap() < 0.1, "{gain:?}");
    let budget = outcome.tables.iter().find(|table| table.name == "budget");
    let columns: Vec<&str> = budget
        .unwrap()
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert!(
        columns.contains(&"ratio of the sensitivities, of E'"),
        "{columns:?}"
    );
    // what stands behind // is understood, too
    let optional = template
        .replace("    // limits: (", "    limits: (")
        .replace("    // lateral_inertia: (", "    lateral_inertia: (")
        .replace("    // checks: (", "    checks: (")
        .replace("    // laws: (", "    laws: (")
        .replace("    //     laws: [", "        laws: [")
        .replace("    //     criterion", "        criterion")
        .replace("    //     confidence", "        confidence")
        .replace("    //     most_lines: 400", "        most_lines: 40")
        .replace("    //     cards", "        cards")
        .replace(
            "    // ),\n\n    // Frequencies",
            "    ),\n\n    // Frequencies",
        )
        .replace("    // report_at", "    report_at");
    let outcome = run(folder.path(), &optional).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    let table = outcome.tables.iter().find(|t| t.name == "laws").unwrap();
    assert_eq!(table.columns[0].cells.len(), 3);
}

/// Of a sheet that is not on disk.
fn identity() -> output::SheetIdentity {
    output::SheetIdentity {
        file: "sheet.ron".to_owned(),
        sha256: String::new(),
    }
}
