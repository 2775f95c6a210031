//! Accepted and rejected hits, refused sheets, and measured hits.

use super::*;
use crate::runs::{Folder, Words, answered, doubts, figures_of, refusal};

/// Text of the log, one line per hit.
fn decisions(outcome: &Outcome) -> String {
    let lines = outcome.log.iter().map(|entry| {
        let reasons = entry.reasons.join("; ");
        format!("{} {} {reasons}", entry.accepted, entry.what)
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_double_hit_is_rejected_with_its_reason_and_a_hand_can_decide_otherwise() {
    let folder = hits(4, 1e-3, NOISE);
    let double = history(N, |t| {
        blow(t - ONSET, 150.0, 1e-3) + blow(t - ONSET - 0.02, 40.0, 1e-3)
    });
    write(&folder.file("hit_4.npy"), &recorded(&double, NOISE, 9));
    let by_checks = frf(&folder, "hit_*.npy", BAND).unwrap();
    insta::assert_snapshot!(decisions(&by_checks), @r"
    true hit 1, hit_0.npy 
    true hit 2, hit_1.npy 
    true hit 3, hit_2.npy 
    true hit 4, hit_3.npy 
    false hit 5, hit_4.npy double hit: two contacts in `hammer`, peaks in the ratio 0.261, 20.02 ms apart
    ");
    let counted = "4 of 5 hits accepted, rejected: double hit 1 (hit 5).";
    by_checks.summary.must_say(counted);

    let by_hand = frf(
        &folder,
        "hit_*.npy",
        &format!(
            r#"{BAND} hits: (
                    accept: [(hit: 5, because: "the response is linear")],
                    reject: [(hit: 2, because: "the hammer slipped")],
                ),"#
        ),
    )
    .unwrap();
    let decided: Vec<bool> = by_hand.log.iter().map(|entry| entry.accepted).collect();
    assert_eq!(decided, [true, false, true, true, true]);
    assert_eq!(
        by_hand.log[1].reasons,
        ["rejected by hand: the hammer slipped"]
    );
    assert_eq!(
        by_hand.log[4].reasons[0],
        "accepted by hand: the response is linear"
    );
    // a double hit causes no error for a linear system: force and response contain both impacts
    let (mean, _) = spread(&by_hand, "accelerance", |f| accelerance(on_axis(f)));
    assert!(mean < 3.0, "{mean}");
}

#[test]
fn a_long_record_is_cut_by_a_trigger() {
    let folder = Folder::new();
    // five hits, one every 0.6 s; the record ends during the last
    let long = history(5 * N + 800, |t| {
        (0..5)
            .map(|hit| {
                blow(
                    t - 0.1 - 0.6 * f64::from(hit),
                    150.0 + 10.0 * f64::from(hit),
                    1e-3,
                )
            })
            .sum()
    });
    write(&folder.file("long.npy"), &recorded(&long, NOISE, 3));
    let cut = |rest: &str| {
        format!(
            r#"{BAND} hits: (cut: Trigger(level: "20 N", pre_trigger: "50 ms", length: "4096 samples"{rest})),"#
        )
    };
    let outcome = frf(&folder, "long.npy", &cut("")).unwrap();
    insta::assert_snapshot!(decisions(&outcome), @r"
    true hit 1, long.npy at 0.1002 s 
    true hit 2, long.npy at 0.7002 s 
    true hit 3, long.npy at 1.3002 s 
    true hit 4, long.npy at 1.9001 s 
    false hit 5, long.npy at 2.5001 s cut at the end: 2887 samples are missing after the hit
    ");
    let (mean, _) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
    // for four hits the ratio is distributed as F(2, 6), with the mean 1.5 and a large variance
    assert!((1.0..4.0).contains(&mean), "{mean}");
    let silent = frf(&folder, "long.npy", &cut("").replace("20 N", "2 kN")).unwrap();
    let reason = refusal(&silent);
    insta::assert_snapshot!(reason, @r"no hit is found (hit 1, long.npy: not triggered: `hammer` never crosses 2000; its values are between -0.376 and 189.7)");
    let wrong = frf(&folder, "long.npy", &cut("").replace("20 N", "20 g"));
    insta::assert_snapshot!(wrong.unwrap_err(), @r"hits.cut.level is `20 g`, expected a level of `hammer`, which is force [N]");
}

#[test]
fn r10_a_hit_in_two_files_is_refused() {
    let folder = hits(3, 1e-3, NOISE);
    fs::copy(folder.file("hit_1.npy"), folder.file("hit_copy.npy")).unwrap();
    let error = frf(&folder, "hit_*.npy", BAND).unwrap_err();
    error.must_say("hit_copy.npy have the same content");
}

#[test]
fn r24_a_single_hit_has_no_valid_line_and_no_hit_has_no_response() {
    let folder = hits(1, 1e-3, NOISE);
    let single = frf(&folder, "hit_*.npy", BAND).unwrap();
    let reasons = doubts(&single);
    insta::assert_snapshot!(reasons.join("\n"), @"only one hit is accepted: there is no coherence, and the error of its lines is not known");
    let mut validity = words(&single, "response_struck_end", "validity").iter();
    assert!(validity.all(|word| word == "error not known from one hit"));
    let valid = runs::quantity(&single, "valid lines, struck end");
    assert!(!valid.valid && valid.value == Some(0.0), "{valid:?}");
    insta::assert_snapshot!([single.summary, single.warnings].concat().join("\n"), @r"
    Do not use this result until the failed checks are explained: only one hit is accepted: there is no coherence, and the error of its lines is not known.
    Accelerance of `struck end` over `hammer` between 20 Hz and 1.2 kHz: a single hit has no coherence and gives no random error; the calibration adds 2.236 %, common to all lines.
    The only hit is accepted.
    ");
    let mut figures = single.figures.iter();
    let figure = figures.find(|f| f.name == "response_struck_end");
    assert_eq!(figure.unwrap().panels.len(), 2); // no panel of a coherence that there is not

    let by_hand = r#"hits: (reject: [(hit: 1, because: "the rod was held")]),"#;
    let rejected = frf(&folder, "hit_*.npy", by_hand).unwrap();
    let reason = refusal(&rejected);
    insta::assert_snapshot!(reason, @r"the only hit is rejected (hit 1, hit_0.npy: rejected by hand: the rod was held)");
    // the log and the figure of the hits are kept
    assert_eq!(rejected.log.len(), 1);
    figures_of(&rejected).must_say("hits");
}

#[test]
fn noise_alone_has_no_response() {
    let folder = Folder::new();
    for hit in 0..4 {
        // the sensor of the response is not connected
        let volts = recorded(&history(N, |t| blow(t - ONSET, 150.0, 1e-3)), NOISE, hit);
        let still = recorded(&history(N, |_| 0.0), NOISE, 100 + hit);
        let rows = [volts.samples().row(0), still.samples().row(1)].map(|row| row.to_vec());
        write_npy(&folder.file(format!("hit_{hit}.npy")), &rows);
    }
    let unchecked =
        r#"hits: (criteria: (level_shift: None, remainder: None, static_offset: None)),"#;
    let outcome = frf(&folder, "hit_*.npy", &format!("{BAND} {unchecked}")).unwrap();
    let (valid, _) = quantity(&outcome, "valid lines, struck end");
    // one line of noise in twenty is coherent by chance, but only one in 9 million exceeds four
    // standard errors
    assert!(valid < 0.1, "{valid}");
    let reason = refusal(&outcome);
    insta::assert_snapshot!(reason, @r"no more lines between 20 Hz and 1.2 kHz are coherent with `hammer` than noise alone would give");
    outcome.summary[0].must_say(reason);
}

#[test]
fn the_same_sheet_gives_the_same_outcome() {
    let folder = hits(3, 1e-3, NOISE);
    let text = sheet_of("hit_*.npy", BAND);
    let [first, second] = [(); 2].map(|()| run(&folder, &text).unwrap());
    assert_eq!(json(&first), json(&second));
    assert_eq!(first.attachments, second.attachments);
    assert!(!json(&first).contains(&folder.path().display().to_string()));
}

#[test]
fn what_is_wrong_with_a_sheet_is_said_with_its_field() {
    let folder = hits(2, 1e-3, NOISE);
    let of = |rest: &str| frf(&folder, "hit_*.npy", rest).unwrap_err();
    let mut said = vec![
        of(r#"outputs: ["struck ent"],"#),
        of(r#"outputs: ["hammer"],"#),
        of(r#"outputs: ["struck end", "struck end"],"#),
        of("outputs: [],"),
        of(r#"band: (from: "2 kHz", to: "1 kHz"),"#),
        of(r#"band: (from: "2 kHz", to: "5 kHz"),"#),
        of(r#"band: (from: "20.5 Hz", to: "21.5 Hz"),"#),
        of(r#"exponential_window: EndWeight(weight: "120 %"),"#),
        of(r#"hits: (reject: [(hit: 7, because: "double")]),"#),
        of(r#"hits: (reject: [(hit: 1, because: " ")]),"#),
        of(r#"hits: (reject: [(hit: 1, because: "a")], accept: [(hit: 1, because: "b")]),"#),
        of(r#"hits: (channel: "hamer"),"#),
        of(r#"hits: (criteria: (double_hit: -1.0)),"#),
        of(r#"hits: (criteria: (full_scales: {"hammer": "10 N"})),"#),
        of("estimator: H3,"),
        of("window: Hanning,"),
        of(r#"force_window: (start: "45 ms", end: "55 ms", taper: "2 ms"), window: Hann,"#),
        of(r#"weighed_mass: (mass: "2 kg", below: "20 Hz", fitted_to: "10 Hz"),"#),
        of("colour: 3,"),
    ];
    let slow = sheet_of("hit_*.npy", BAND).replace("8192 Hz", "8.192 Hz");
    let slip = run(&folder, &slow).unwrap_err();
    assert!(
        slip.ends_with("at a sampling rate of 8.192 Hz: did you mean 8.192 kHz?"),
        "{slip}"
    );
    let text = sheet_of("hit_*.npy", "").replace(r#"input: "hammer""#, r#"input: "force""#);
    said.push(run(&folder, &text).unwrap_err());
    let text = sheet_of("hit_*.npy", "kind: Mobility,").replace("100 mV/g", "100 mV/Pa");
    said.push(run(&folder, &text).unwrap_err());
    insta::assert_snapshot!(said.join("\n"), @r"
    outputs[0] is `struck ent`, expected one of records.channels: `hammer`, `struck end`
    outputs[0] is `hammer`, expected a channel other than the input
    outputs[1] is `struck end`, expected every output once
    outputs is empty, expected at least one channel besides the input
    band is from 2 kHz to 1 kHz, expected a band of lines between 2 Hz and 4.096 kHz
    band is from 2 kHz to 5 kHz, expected a band of lines between 2 Hz and 4.096 kHz
    band is from 20.5 Hz to 21.5 Hz, which contains no line, expected a band of lines between 2 Hz and 4.096 kHz, 2 Hz apart
    exponential_window: end weight of the exponential window [-] is 1.2, expected a weight between 0 and 1
    hits.reject[0].hit is 7, expected the number of one of the 2 hits found, from 1
    hits.reject[0].because is empty, expected the reason for the decision, in a few words
    hits.accept[0].hit is 1, already decided by hits.reject[0], expected one decision per hit
    hits.channel is `hamer`, expected one of the channels `hammer`, `struck end`
    hits.criteria: ratio of two contacts is -1, expected a finite value above 0
    hits.criteria.full_scales.hammer is `10 N`, expected a level of `hammer`, which is voltage [V]
    test.ron:4:41: Frf.estimator: found `H3`, expected one of `H1`, `H2`, `Hv`, `Hs`
    test.ron:4:38: Frf.window: found `Hanning`, expected one of `Rectangular`, `Hann`, `Hamming`, `BlackmanHarris`, `FlatTop`, `Tukey`
    force_window: a force window cannot be combined with HannPeriodic
    weighed_mass: end of the band of a nearly rigid body [Hz] is 10, expected a finite frequency above its start
    test.ron:4:30: Frf.colour: there is no field `colour`, only `title`, `about`, `records`, `hits`, `segments`, `input`, `further_inputs`, `outputs`, `estimator`, `window`, `force_window`, `exponential_window`, `detrend`, `silent`, `band`, `kind`, `second_hammer`, `weighed_mass`
    input is `force`, expected one of records.channels: `hammer`, `struck end`
    kind is mobility, expected a force and a motion as input and output, not `struck end` [Pa] over `hammer` [N]
    ");
}

#[test]
fn the_template_with_its_optional_fields_is_a_sheet() {
    let text = include_str!("../../templates/frf.ron");
    // uncomments all fields except the alternatives and the second hammer, which contains an
    // ellipsis
    let mut all = String::new();
    for line in text.lines() {
        let bare = line.trim_start();
        let field = bare.strip_prefix("// ").filter(|rest| {
            let name: String = rest
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            rest[name.len()..].starts_with(": ")
                && !name.is_empty()
                && !["cut", "records", "hits", "merge", "second_hammer"].contains(&name.as_str())
                && rest.ends_with(',')
        });
        all += field.unwrap_or(line);
        all.push('\n');
    }
    assert_ne!(all, text);
    if let Err(error) = job::parse(Path::new("frf.ron"), &all) {
        panic!("{error}\n{all}");
    }
}

#[test]
fn the_measured_hits_have_the_coherence_that_is_known_of_them() {
    let Some(data) = measured::folder() else {
        return;
    };
    let folder = Folder::new();
    for hit in 1..=5 {
        let name = format!("measurements_{hit}.npy");
        fs::copy(data.join("hammer").join(&name), folder.file(&name)).unwrap();
    }
    let outcome = answered(run(
        &folder,
        r#"Frf(
            title: "Measured hits",
            records: (files: ["measurements_*.npy"], sampling_rate: "25.6 kHz", channels: [
                (name: "force", from: 2, unit: "N"),
                (name: "acceleration", from: 3, unit: "m/s^2"),
            ]),
            hits: (criteria: (remainder: None, level_shift: None)),
            input: "force",
            band: (from: "100 Hz", to: "2 kHz"),
        )"#,
    ));
    let coherence = column(&outcome, "response_acceleration", "coherence");
    let mean = coherence.iter().sum::<f64>() / coherence.len() as f64;
    // the coherence of all five hits is 0.998 to 0.9996 in parts of this band
    assert!((0.997..1.0).contains(&mean), "{mean}");
}

/// Reasons for doubt about eight hits of 150 to 220 N. `change` receives the number and the samples
/// of a hit before it is recorded, `after` the number and the value of each recorded sample of the
/// response.
fn doubts_of(
    change: impl Fn(u64, &mut Array2<f64>),
    after: impl Fn(usize, f64) -> f64,
) -> Vec<String> {
    let folder = Folder::new();
    let with = |record: &Record, samples: Array2<f64>| {
        let (channels, from) = (record.channels().to_vec(), Provenance::computed("changed"));
        Record::new(samples, RATE, 0.0, channels, from).unwrap()
    };
    for hit in 0..8 {
        let peak = 150.0 + 10.0 * hit as f64;
        let right = history(N, |t| blow(t - ONSET, peak, 1e-3));
        let mut samples = right.samples().to_owned();
        change(hit, &mut samples);
        let taken = recorded(&with(&right, samples), NOISE / 100.0, hit);
        let mut volts = taken.samples().to_owned();
        for (n, x) in volts.row_mut(1).iter_mut().enumerate() {
            *x = after(n, *x);
        }
        write(&folder.file(format!("hit_{hit}.npy")), &with(&taken, volts));
    }
    let outcome = frf(&folder, "hit_*.npy", BAND).unwrap();
    match outcome.verdict {
        Verdict::Answered => Vec::new(),
        _ => doubts(&outcome).to_vec(),
    }
}

#[test]
fn a_window_of_the_analyser_is_found_by_the_noise() {
    assert_eq!(doubts_of(|_, _| {}, |_, x| x), [""; 0]);
    let window = |n: usize| (-(n as f64) / RATE / 0.2).exp();
    let doubts = doubts_of(|_, _| {}, |n, x| x * window(n));
    doubts.must_begin("the noise of `struck end` falls from ");
    doubts.must_say("the analyser has applied a window");
    // the window makes the noise after the hit smaller than that before it, but no two hits are
    // reported as copies
    assert!(!doubts.iter().any(|said| said.contains("stored twice")));
}

#[test]
fn a_force_that_saturates_and_another_body_are_found_over_the_hits() {
    // 2 % less force at 150 N, and 5 % at 220 N
    let saturates = |_: u64, samples: &mut Array2<f64>| {
        samples
            .row_mut(0)
            .mapv_inplace(|f| f * (1.0 - 1e-6 * f * f));
    };
    let doubts = doubts_of(saturates, |_, x| x);
    doubts.must_begin("the gain of `struck end` rises by ");
    doubts.must_say("`hammer` saturates");
    let lighter = |hit: u64, samples: &mut Array2<f64>| {
        if hit >= 4 {
            samples.row_mut(1).mapv_inplace(|x| 1.05 * x);
        }
    };
    doubts_of(lighter, |_, x| x).must_begin(
        "the response of `struck end` up to hit 4 differs from that of hit 5 and later hits by ",
    );
}
