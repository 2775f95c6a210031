//! Records and sheets that are refused, not allowed or in doubt, and the band of the checks.

use std::path::Path;

use super::*;
use crate::runs::{Refused, Words, answered, doubts, refusal};

#[test]
fn one_hit_without_a_known_silence_is_not_allowed() {
    let folder = hits(1, 5);
    let whole = sheet(TWO_POINT, BAND);
    let cut = whole.find("cut: Trigger").unwrap();
    let end = cut + whole[cut..].find('\n').unwrap();
    let uncut = format!("{}cut: EachRecord,{}", &whole[..cut], &whole[end..]);
    let outcome = folder.run(&uncut).unwrap();
    let reason = refusal(&outcome);
    insta::assert_snapshot!(reason, @"1 hit is accepted of 1 found, expected at least 2: the coherence of a single hit is always 1. If the file contains several hits, cut it by `source.hits.hits.cut`. Or state in `source.hits.silent` how long the record is silent before the impact; the errors of one hit are then determined from this silence");
    assert_eq!(outcome.figures.len(), 1);

    // the record begins 2 ms before the hit
    let late = whole.replace("pre_trigger: \"1 ms\"", "pre_trigger: \"5 ms\"");
    let outcome = folder.run(&late).unwrap();
    refusal(&outcome).must_say("Record with a pre-trigger of about a tenth of the record");
}

#[test]
fn ends_that_are_interchanged_are_not_allowed_and_say_why() {
    let folder = hits(4, 5);
    let turned = sheet(
        r#"TwoPoint(impacted_end: "free end", free_end: "struck end")"#,
        BAND,
    );
    let turned = turned.replace("cut: Trigger", "channel: \"struck end\", cut: Trigger");
    let outcome = folder.run(&turned).unwrap();
    refusal(&outcome).must_say("number of waves in doubt");
    let warnings = &outcome.warnings;
    let mistake = "if the channels of the two ends were interchanged: interchange";
    warnings.must_say(mistake);

    // a sensor of inverted polarity
    let inverted = sheet(TWO_POINT, BAND).replace(
        "(name: \"free end\", from: 2,",
        "(name: \"free end\", from: 2, inverted: true,",
    );
    let outcome = folder.run(&inverted).unwrap();
    doubts(&outcome).must_begin("the polarity check fails");
    outcome.summary[0].must_say("polarity");
    // all hits are rejected by hand
    let all = sheet(TWO_POINT, BAND).replace(
        "cut: Trigger",
        "reject: [(hit: 1, because: \"slipped\"), (hit: 2, because: \"slipped\"), (hit: 3, because: \"slipped\")], cut: Trigger",
    );
    let outcome = folder.run(&all).unwrap();
    assert!(matches!(outcome.verdict, Verdict::NotAllowed { .. }));
    outcome
        .summary
        .must_say("1 of 4 hits accepted, rejected: by hand 3 (hits 1-3)");
}

#[test]
fn a_unit_that_is_wrong_by_g_is_named() {
    let folder = hits(10, 1993);
    let warnings = |text: &str| folder.run(text).unwrap().warnings.join("\n");
    let right = sheet(TWO_POINT, BAND);
    let wrong = right.replace(
        "(name: \"free end\", from: 2, unit: \"V\", sensitivity: \"0.5 mV/g\")",
        "(name: \"free end\", from: 2, unit: \"V\", sensitivity: \"0.5 mV/(m/s2)\")",
    );
    assert!(!warnings(&right).contains("rigid body"));
    let said = warnings(&wrong);
    said.must_say_all(&["`struck end` moves 9.", "wrong by a factor of 9.81"]);
    assert!(!said.contains("interchanged"), "{said}");
}

/// The loss factor is not known to 0.1 % on any line, but E' is.
#[test]
fn the_storage_modulus_is_stated_where_the_loss_factor_is_not_known() {
    let folder = hits(10, 1993);
    let rod = virtual_rod::polypropylene();
    let limits = "limits: (loss_factor: \"0.1 %\"), report_at: [\"5 kHz\"],";
    let text = sheet(TWO_POINT, &format!("{BAND}\n{limits}"));
    let outcome = answered(folder.run(&text));
    assert!(is_valid(&outcome).iter().all(|valid| !valid));
    let first = &outcome.summary[0];
    first.must_begin("E' = 2.");
    first.must_say("The loss factor is known on none");
    let of = |name: &str| {
        let mut quantities = outcome.quantities.iter();
        quantities.find(|q| q.name.starts_with(name)).unwrap()
    };
    let (modulus, loss) = (of("storage modulus at 4.99"), of("loss factor at 4.99"));
    assert!(modulus.valid && !loss.valid);
    let apart = 1e9 * modulus.value.unwrap() - rod(4992.0).re;
    assert!(apart.abs() < 3e9 * modulus.standard_error.unwrap()); // three standard errors
}

/// Writes `hits.npy` of the folder under another name with every sample changed.
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
    let folder = hits(2, 7);
    let two_files =
        sheet(TWO_POINT, BAND).replace("[\"hits.npy\"]", "[\"hits.npy\", \"more.npy\"]");
    let said = || folder.run(&two_files).refused();
    again(folder.path(), "more.npy", |volts| volts);
    insta::assert_snapshot!(said(), @"hits.npy and more.npy have the same content: they are one measurement, expected independent measurements: remove one of the two from the sheet");
    again(folder.path(), "more.npy", |volts| {
        f64::from(1.3_f32 * volts as f32)
    });
    insta::assert_snapshot!(said(), @"hit 1, hits.npy at 0.0020 s and hit 3, more.npy at 0.0020 s have the same samples: they are one measurement, expected independent measurements: remove one of the two from the sheet");
    let one_channel = sheet(TWO_POINT, BAND).replace("from: 2", "from: 1");
    insta::assert_snapshot!(folder.run(&one_channel).unwrap_err(), @"source.hits.records.channels[1].from is channel 1, expected another channel of hits.npy than channels[0]; if each channel has files of its own, state `files` in every channel");

    // the same hits, rounded to coarser steps
    let step = 2e-7;
    again(folder.path(), "more.npy", |volts| {
        (volts / step).round() * step
    });
    let outcome = folder.run(&two_files).unwrap();
    let reasons = doubts(&outcome);
    let copies = reasons
        .iter()
        .filter(|reason| reason.starts_with("the difference between hit "));
    assert_eq!(copies.count(), 2, "{reasons:?}");
    reasons[0].must_say("hit 1, hits.npy at 0.0020 s and hit 3, more.npy at 0.0020 s has ");

    // a doubt that the copies may cause is stated after the doubts about the copies
    let temperature = r#"temperature: (of_hits: ["20 degC", "21 degC", "22 degC", "23 degC"], reference: "20 degC", slope: "0.05 1/K ± 0.001 1/K"),"#;
    let warming = two_files.replace(BAND, &format!("{BAND} {temperature}"));
    let outcome = folder.run(&warming).unwrap();
    let reasons = doubts(&outcome);
    let of_slope = "the stated change of the modulus with temperature, ";
    assert!(
        reasons[0].starts_with("the difference between hit ")
            && reasons.iter().any(|reason| reason.starts_with(of_slope)),
        "{reasons:?}"
    );
}

#[test]
fn r10_hits_without_any_noise_are_refused() {
    let folder = hits(1, 7);
    // the second hit is the first, filtered: no copy, and a coherence of 1
    let mut bytes = folder.bytes("hits.npy");
    let begin = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let half = (bytes.len() - begin) / 2;
    for channel in 0..2 {
        let row = &mut bytes[begin + channel * half..begin + (channel + 1) * half];
        let samples: Vec<f64> = row
            .chunks_exact(8)
            .map(|number| f64::from_le_bytes(number.try_into().unwrap()))
            .collect();
        for (n, number) in row.chunks_exact_mut(8).enumerate() {
            // circular, like the discrete Fourier transform
            let before = samples[(n + samples.len() - 40) % samples.len()];
            number.copy_from_slice(&(samples[n] + 0.5 * before).to_le_bytes());
        }
    }
    folder.write("more.npy", bytes);
    let text = sheet(TWO_POINT, BAND)
        .replace("[\"hits.npy\"]", "[\"hits.npy\", \"more.npy\"]")
        .replace("cut: Trigger(level: \"2000 m/s2\", length: \"4096 samples\", pre_trigger: \"1 ms\"),", "criteria: (double_hit: None, remainder: None, static_offset: None, level_shift: None),");
    insta::assert_snapshot!(folder.run(&text).unwrap_err(), @"source: the coherence of `free end` and `struck end` is 1 within rounding over 2 hits, expected hits with independent noise: the hits are copies of one hit, or were computed without noise");
}

#[test]
fn r24_without_a_band_the_checks_look_at_lines_with_signal_below_the_aliases() {
    let folder = hits(6, 11);
    let checked = |rest: &str| {
        let outcome = answered(folder.run(&sheet(TWO_POINT, rest)));
        let setting = outcome
            .settings
            .iter()
            .find(|s| s.name == "band of the checks");
        (setting.map(|s| s.value.clone()), outcome.warnings)
    };
    let (band, warnings) = checked("");
    let band = band.unwrap();
    band.must_say(" to 16.38 kHz: the coherence is above that of chance, no alias is expected below 16.38 kHz, half the Nyquist frequency");
    warnings.must_begin("No `band` is stated: the checks use the lines from ");
    let (band, _) = checked(r#"checks: (alias_free_to: "14 kHz"),"#);
    band.unwrap()
        .must_say("aliases are suppressed up to 14 kHz");
    assert_eq!(checked(BAND).0, None);
    // the hit has no power above 25 kHz: a wider band does not add lines to the checks
    let (band, _) = checked(r#"band: (from: "50 Hz", to: "32 kHz"),"#);
    let band = band.unwrap();
    assert!(
        band.ends_with(" kHz: the coherence is above that of chance"),
        "{band}"
    );
    let wrong = sheet(TWO_POINT, r#"checks: (alias_free_to: "40 kHz"),"#);
    insta::assert_snapshot!(folder.run(&wrong).unwrap_err(), @"checks.alias_free_to is 40 kHz, expected at most 32.77 kHz, the Nyquist frequency");
}

#[test]
fn what_is_wrong_is_said() {
    let folder = hits(2, 5);
    folder.write(
        "psi.csv",
        "Frequency [Hz],real,imaginary\n10,1,0\n20,0.9,0.1\n30,0.8,0.1\n",
    );
    let ratio = |method: &str, source: &str| {
        format!(
            "Modulus(title: \"a\", specimen: (diameter: \"10 mm\", density: \"912 kg/m3\"), method: {method}, source: Ratio({source}))"
        )
    };
    let parts = "path: \"psi.csv\", values: Parts(real: \"real\", imaginary: \"imaginary\")";
    let by_parts =
        |method: &str, errors: &str| ratio(method, &format!("{parts}, errors: {errors}"));
    let gauges = "MultiPoint(gauges: [(channel: \"a\", at: \"0 mm\")])";
    let cut = format!(
        "cut: Trigger(level: \"2000 m/s2\", length: \"{SAMPLES} samples\", pre_trigger: \"1 ms\"),"
    );
    let sheets = [
        sheet(TWO_POINT, "band: (from: \"40 kHz\", to: \"50 kHz\"),"),
        sheet(TWO_POINT, "band: (from: \"1 Hz\", to: \"2 Hz\"),"),
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
        by_parts(gauges, "Relative(of_value: \"0.1 %\")"),
        by_parts(TWO_POINT, "Coherence(column: \"gamma\", averages: 5)"),
        by_parts(TWO_POINT, "Relative(of_value: \"1 mm\")"),
        ratio(
            TWO_POINT,
            "path: \"psi.csv\", values: Complex(1), errors: Relative(of_value: \"0.1 %\")",
        ),
        by_parts(
            "FreeEnd(first: (channel: \"a\", from_free_end: \"100 mm\"), second: (channel: \"b\", from_free_end: \"0 mm\"))",
            "Relative(of_value: \"0.1 %\")",
        ),
    ];
    let uneven = "path: \"errors.csv\", values: Parts(real: 1, imaginary: 2), errors: StandardError(column: 3)";
    folder.write(
        "errors.csv",
        "Frequency [Hz],real,imaginary,error\n10,1,0,0.1\n20,0.9,0.1,-0.1\n30,0.8,0.1,0.1\n",
    );
    let more = [
        ratio(TWO_POINT, uneven),
        sheet("MultiPoint(gauges: [])", BAND),
        sheet(TWO_POINT, "laws: (laws: [Zener], most_lines: 0),"),
        sheet(TWO_POINT, "laws: (laws: []),"),
    ];
    // these uncertainties are removed because not every method propagates them
    let exact = |text: &str| {
        let of_rod = [" ± 0.03 mm", " ± 0.29 mm", " ± 0.03 gram"];
        of_rod
            .iter()
            .fold(text.to_owned(), |text, stated| text.replace(stated, ""))
    };
    let messages: Vec<String> = sheets
        .iter()
        .chain(&more)
        .map(|text| match folder.run(&exact(text)) {
            Ok(outcome) => format!("no error: {:?}", outcome.summary),
            Err(error) => error
                .to_string()
                .replace(&folder.path().display().to_string(), "FOLDER"),
        })
        .collect();
    insta::assert_snapshot!(messages.join("\n"), @r#"
    band.to is `50 kHz`, expected at most 32.77 kHz, half the sampling rate
    band is 1 Hz to 2 Hz, expected a band with lines, which are between 0 and 32768 Hz
    method.two_point.free_end is `end B`, expected one of the channels `struck end`, `free end`
    specimen.length is missing, expected the length, which TwoPoint needs
    source.hits.silent is missing, expected how long each hit's record is silent before the impact: the weights of the gauges are determined from their noise there
    checks.level is 2, expected a probability between 0 and 1
    laws.cards is requested, expected the law `generalised_maxwell` (in RON `GeneralisedMaxwell`) among `laws.laws`: cards are made from it
    finding the modulus: least coherence is 1.2, expected a value from 0 to 1
    source is a ratio, expected hits: MultiPoint needs the spectra of all gauges
    source.ratio.errors.coherence.column (psi.csv) is `gamma`, expected one of the columns `real`, `imaginary`
    test.ron:1:253: Modulus.source.Ratio.errors.Relative.of_value: `1 mm` has the dimension of a length (m), expected a pure number, such as "0.094" or "9.4 %"
    source.ratio.values.complex (psi.csv) is `real`, a column of real numbers, expected complex numbers, or `real` and `imaginary` separately
    method.free_end.first.quantity is missing, expected `strain`, `displacement`, `velocity` or `acceleration` (in RON with a capital letter): a file with a ratio does not state the quantity
    source.ratio.errors.standard_error.column, line 2 is -0.1, expected a standard error of 0 or more
    method.multi_point.gauges is empty, expected at least three gauges
    laws.most_lines is 0, expected at least 1
    laws.laws is empty, expected at least one law
    "#);
}
