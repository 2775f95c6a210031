//! Forces from the acceleration of one of two masses, which is struck; the virtual records are
//! integrated in time. The path is given in closed form or by calibration hits.

use testbed::measured;

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use impulse::ForceHistory;
use num_complex::Complex64;
use rodlab::outcome::{Outcome, Verdict};

use crate::runs::{
    Folder, Refused, Words, answered, column, doubts, estimate, figures_of, quantity, refusal,
};
use crate::two_masses::{BODY, Body, HAMMER, Hammer, RATE, SAMPLES, strike, struck};

/// Writes the exact accelerance of `body` as a table.
fn accelerance(folder: &Path, body: Body) {
    let rigid = Complex64::from(1.0 / (body.struck + body.behind));
    let value = |f: f64| match f {
        0.0 => rigid,
        _ => body.mobility(f) * Complex64::new(0.0, TAU * f),
    };
    write_lines(&folder.join("accelerance.csv"), 0, value);
}

/// Writes a response at the frequency lines of a record, starting at line `from`.
fn write_lines(path: &Path, from: usize, value: impl Fn(f64) -> Complex64) {
    let mut text = "frequency [Hz],real part [1/kg],imaginary part [1/kg]\n".to_owned();
    for line in from..=SAMPLES / 2 {
        let f = line as f64 * RATE / SAMPLES as f64;
        let value = value(f);
        writeln!(text, "{f},{},{}", value.re, value.im).unwrap();
    }
    fs::write(path, text).unwrap();
}

const FILE: &str =
    r#"File(file: "accelerance.csv", data_set: "real part", imaginary: "imaginary part")"#;

const HITS: &str = r#"Hits(
    records: (files: ["hit*.csv"], channels: [(name: "hammer", from: "force"), (name: "face", from: "acceleration")]),
    force: "hammer", response: "face")"#;

const RECORD: &str = r#"record: (files: ["blow1.csv"], channels: [(name: "face", from: "acceleration"), (name: "hammer", from: "force")]),
    response: "face", compare_with: "hammer""#;

const TIKHONOV: &str =
    "regularisation: Tikhonov(penalty: Curvature, parameter: GeneralisedCrossValidation)";

const ACTING: &str = r#"acting: (from: "3.8 ms", to: "4.6 ms")"#;

fn sheet(path: &str, rest: &str) -> String {
    format!(r#"Force(title: "blow", problem: Response(path: {path}, {RECORD}, {rest}))"#)
}

/// A hit of 300 N that is not among the calibration hits.
const BLOW: Hammer = Hammer {
    hits: 1,
    peak: 300.0,
    seed: 21,
    noise: 2.0,
    ..HAMMER
};

/// Folder with the hit and the exact path.
fn blow_and_path() -> Folder {
    let folder = struck("blow", BODY, BLOW);
    accelerance(folder.path(), BODY);
    folder
}

/// Folder with the hit and eight calibration hits.
fn blow_and_hits() -> Folder {
    let folder = struck("hit", BODY, HAMMER);
    strike(folder.path(), "blow", BODY, BLOW);
    folder
}

/// Fails unless the peak is 300 N within four standard errors plus the bias. Returns the standard
/// error.
fn peak_is_found(outcome: &Outcome) -> f64 {
    let (peak, error) = estimate(outcome, "peak force");
    let bias = quantity(outcome, "change of the peak by the regularisation");
    let allowed = 4.0 * error + bias.value.unwrap().abs();
    assert!((peak - 300.0).abs() < allowed, "{peak} {error} {bias:?}");
    error
}

#[test]
fn a_force_comes_back_within_its_band() {
    let folder = blow_and_path();
    let text = sheet(
        FILE,
        &format!(r#"{TIKHONOV}, {ACTING}, non_negative: true, noise: FromRest("3.5 ms")"#),
    );
    let outcome = answered(folder.run(&text));
    let error = peak_is_found(&outcome);
    // noise of 2 m/s2 on a mass of 1 kg corresponds to a force of 2 N
    assert!((0.2..5.0).contains(&error), "{error}");
    let held = quantity(
        &outcome,
        "part of the measured force inside the band of the whole history",
    );
    // the part inside the band is not tested: at both ends of the force the non-negative band has
    // no width, but the measured force has noise of 0.01 N
    let difference = quantity(
        &outcome,
        "root mean square difference from the measured force",
    );
    assert!(difference.value.unwrap() < 3.0, "{difference:?} {held:?}");
    // the mean of a raised cosine is half its peak
    let (impulse, error) = estimate(&outcome, "impulse");
    let away = (impulse - 0.5 * 300.0 * 0.3e-3).abs();
    assert!(away < 4.0 * error, "{impulse} {error}");
    let chi = quantity(&outcome, "weighted residual per degree of freedom");
    // tolerance: 2000 samples determine the residual to 3 %; 179 samples at rest determine the
    // noise to 5 % and its square to 10 %
    assert!((chi.value.unwrap() - 1.0).abs() < 0.35, "{chi:?}");
    let noise = quantity(&outcome, "noise of the response").value.unwrap();
    assert!((noise / 2.0 - 1.0).abs() < 0.2, "{noise}");
    assert_eq!(figures_of(&outcome), "force, path, regularisation");
    assert_eq!(outcome.warnings, Vec::<String>::new());
}

#[test]
fn without_regularisation_the_band_of_the_whole_history_holds_the_force() {
    let folder = blow_and_path();
    let text = sheet(FILE, &format!(r#"{ACTING}, noise: White("2 m/s2")"#));
    let outcome = folder.run(&text).unwrap();
    let force = column(&outcome, "force", "force");
    let measured = column(&outcome, "force", "measured force");
    let errors = column(&outcome, "force", "standard error of the force");
    let lower = column(&outcome, "force", "band of the whole history, lower");
    let upper = column(&outcome, "force", "band of the whole history, upper");
    let mut squares = Vec::new();
    for n in 195..=235 {
        // the noise of 0.01 N on the measured force is negligible compared with 2 N, the error of
        // the computed force
        assert!(lower[n] <= measured[n] && measured[n] <= upper[n], "{n}");
        squares.push(((force[n] - measured[n]) / errors[n]).powi(2));
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    // tolerance: the mean square of 41 correlated unit errors is known to about a third
    assert!((0.4..2.0).contains(&mean), "{mean}");
}

#[test]
fn calibration_hits_tell_path_and_scatter() {
    let folder = blow_and_hits();
    let rest = format!(
        r#"{TIKHONOV}, {ACTING}, noise: White("2 m/s2"), band: (from: "0.02 kHz", to: "5 kHz")"#
    );
    let outcome = answered(folder.run(&sheet(HITS, &rest)));
    peak_is_found(&outcome);
    let scatter = quantity(&outcome, "scatter between hits with the force");
    // the hits differ only by noise, which is a few per cent at most
    assert!((0.0..5.0).contains(&scatter.value.unwrap()), "{scatter:?}");
    // the log lists the lines below 20 Hz and above 5 kHz as outside the band
    let reasons: Vec<&str> = outcome
        .log
        .iter()
        .filter(|entry| !entry.accepted)
        .flat_map(|entry| entry.reasons.iter().map(String::as_str))
        .collect();
    assert!(reasons.contains(&"outside the band"), "{reasons:?}");
    assert_eq!(outcome.inputs.len(), 9);
}

#[test]
fn what_contradicts_the_noise_is_said() {
    let folder = blow_and_path();
    // the stated noise is a quarter of the true noise
    let text = sheet(
        FILE,
        &format!(r#"{TIKHONOV}, {ACTING}, noise: White("0.5 m/s2")"#),
    );
    doubts(&folder.run(&text).unwrap())[0].must_say("the noise is underestimated");
    // the path is that of a body with another spring
    accelerance(
        folder.path(),
        Body {
            stiffness: 5e7,
            ..BODY
        },
    );
    let text = sheet(
        FILE,
        &format!(r#"{TIKHONOV}, {ACTING}, noise: White("2 m/s2")"#),
    );
    let outcome = folder.run(&text).unwrap();
    let chi = quantity(&outcome, "weighted residual per degree of freedom");
    assert!(chi.value.unwrap() > 10.0, "{chi:?}");
}

#[test]
fn noise_alone_is_no_force() {
    let folder = struck("blow", BODY, Hammer { peak: 0.0, ..BLOW });
    accelerance(folder.path(), BODY);
    let judged = "hit: (criteria: (peak_over_noise: 10.0))";
    let text = sheet(
        FILE,
        &format!(r#"{ACTING}, {judged}, noise: White("2 m/s2")"#),
    );
    let outcome = folder.run(&text).unwrap();
    let none = "none of 1 hits of the record is accepted: the log states why";
    assert_eq!(refusal(&outcome), none);
    assert!(!outcome.log[0].accepted && !outcome.log[0].reasons.is_empty());
    // without criteria for the hit, the record is evaluated with warnings
    let text = sheet(FILE, &format!(r#"{ACTING}, noise: White("2 m/s2")"#));
    let outcome = folder.run(&text).unwrap();
    let warnings = &outcome.warnings;
    warnings.must_say_all(&["no hit", "below three standard errors"]);
    let rest = format!(
        r#"{ACTING}, noise: White("4 m/s2"), regularisation: Tikhonov(parameter: Discrepancy)"#
    );
    let small = "the response is no larger than its noise: any force, or none, explains it";
    assert_eq!(refusal(&folder.run(&sheet(FILE, &rest)).unwrap()), small);
}

#[test]
fn what_cannot_be_is_refused_where_it_stands() {
    let folder = blow_and_path();
    strike(folder.path(), "hit", BODY, Hammer { hits: 2, ..HAMMER });
    let lines = folder.read("accelerance.csv");
    let every_second: Vec<&str> = lines
        .lines()
        .enumerate()
        .filter(|(n, _)| *n == 0 || n % 2 == 1)
        .map(|(_, line)| line)
        .collect();
    folder.write("wide.csv", every_second.join("\n"));
    let refused = |path: &str, rest: &str| folder.run(&sheet(path, rest)).refused();
    let refusals = [
        refused(&FILE.replace("accelerance.csv", "wide.csv"), ""),
        refused(
            r#"File(file: "accelerance.csv", data_set: "real part")"#,
            "",
        ),
        refused(
            &FILE.replace("imaginary:", "kind: Mobility, imaginary:"),
            "",
        ),
        refused(FILE, "non_negative: true"),
        refused(FILE, "regularisation: Tikhonov(parameter: Discrepancy)"),
        refused(FILE, r#"noise: White("2 N")"#),
        refused(FILE, r#"noise: FromRest("10 samples")"#),
        refused(FILE, r#"acting: (from: "30 ms", to: "60 ms")"#),
        refused(FILE, r#"band: (from: "5 kHz", to: "1 kHz")"#),
        refused(
            &HITS.replace(
                "force: \"hammer\"",
                "exponential_window: \"120 %\", force: \"hammer\"",
            ),
            "",
        ),
        refused(&FILE.replace("accelerance.csv", "absent.csv"), "")
            .split(": ")
            .skip(1)
            .collect::<Vec<_>>()
            .join(": "),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    problem.path.file is wide.csv with 513 lines 50.000000 Hz apart, expected up to 1025 lines 25.000000 Hz apart, those of the record
    problem.path.imaginary is not stated, expected the column of the imaginary part: the data set is real
    problem.path.kind is mobility, expected accelerance, because accelerance.csv is in 1/kg
    problem: a force without tension needs a support, but none is given
    problem: the discrepancy principle needs the noise of the response, which is not known
    problem.noise.White is `2 N`, expected a level of `face`, which is acceleration [m/s^2]
    problem.noise.FromRest is 10 samples, expected from 20 to 2048 samples
    problem.acting is 30 ms to 60 ms, expected a time span from 0 s to 0.040000 s, the end of the record
    problem: the frequency band [Hz] runs from 5000 to 1000, expected finite and increasing limits
    problem.path.exponential_window: end weight of the exponential window [-] is 1.2, expected a weight between 0 and 1
    No such file or directory (os error 2)
    ");
}

/// Five measured hits: the force of each is reconstructed from its response and the other four
/// hits, and the measured force lies inside its band. The largest samples agree within 0.4 % in
/// four cases and within 0.8 % for the hardest hit; the root mean square difference of the
/// histories is at most 0.33 % of the peak.
#[test]
fn a_measured_blow_comes_back_from_the_other_hits() {
    let Some(hammer) = measured::folder().map(|data| data.join("hammer")) else {
        return;
    };
    let folder = Folder::new();
    let channels = r#"sampling_rate: "25.6 kHz", channels: [(name: "hammer", from: 2, unit: "N"), (name: "face", from: 3, unit: "m/s2")]"#;
    let file = |n: usize| {
        let path = hammer.join(format!("measurements_{n}.npy"));
        format!("{:?}", path.to_string_lossy())
    };
    for left_out in 1..=5 {
        let others: Vec<String> = (1..=5).filter(|n| *n != left_out).map(file).collect();
        let text = format!(
            r#"Force(title: "measured", problem: Response(
                path: Hits(records: (files: [{}], {channels}), force: "hammer", response: "face"),
                record: (files: [{}], {channels}), response: "face", compare_with: "hammer"))"#,
            others.join(", "),
            file(left_out),
        );
        let outcome = folder.run(&text).unwrap();
        assert_eq!(outcome.verdict, Verdict::Answered, "{left_out}");
        let measured = column(&outcome, "force", "measured force");
        let largest = measured.iter().fold(0.0_f64, |a, b| a.max(*b));
        let sampled = column(&outcome, "force", "force");
        let sampled = sampled.iter().fold(0.0_f64, |a, b| a.max(*b));
        assert!((sampled - largest).abs() < 0.008 * largest, "{left_out}");
        let measured = ForceHistory::new(0.0, 1.0 / 25.6e3, measured.to_vec()).unwrap();
        let largest = measured.interpolated_peak().force;
        let (peak, error) = estimate(&outcome, "peak force");
        // tolerance: the two-sided 99 % quantile of Student's t for four hits, from whose scatter
        // the error is estimated
        assert!((peak - largest).abs() < 5.8 * error, "{left_out}");
        let difference = "root mean square difference from the measured force";
        let difference = quantity(&outcome, difference).value.unwrap();
        assert!(difference < 0.0035 * largest, "{left_out}: {difference} N");
        let held = "part of the measured force inside the band of the whole history";
        let held = quantity(&outcome, held).value.unwrap();
        assert!((held - 100.0).abs() < 1e-9, "{left_out}: {held} %");
    }
}

/// All settings are default. With the path of the body the result is answered; with that of a body
/// whose frequency is 2 % lower it is in doubt, because the force does not reproduce the response.
#[test]
fn f5_a_path_that_contradicts_the_blow_is_in_doubt() {
    let folder = struck("blow", BODY, BLOW);
    let text = sheet(FILE, ACTING);
    accelerance(folder.path(), BODY);
    assert_eq!(folder.run(&text).unwrap().verdict, Verdict::Answered);
    accelerance(
        folder.path(),
        Body {
            stiffness: BODY.stiffness * 0.98 * 0.98,
            ..BODY
        },
    );
    let doubted = folder.run(&text).unwrap();
    doubts(&doubted)[0].must_say("the frequency response belongs to another body");
}

/// Eight calibration hits and another hit, with noise of 0.3 % of the peak, in a band from 20 Hz to
/// 5 kHz: peak and impulse agree with the true values within 3.5 standard errors, and these are
/// below 5 % of the values.
#[test]
fn f3_hits_in_a_band_tell_peak_and_impulse_with_their_errors() {
    let noise = 0.9;
    let (mut peaks, mut impulses) = (Vec::new(), Vec::new());
    for seed in [30, 40, 50, 60] {
        let by = |seed, hammer| Hammer {
            noise,
            seed,
            ..hammer
        };
        let folder = struck("hit", BODY, by(seed, HAMMER));
        strike(folder.path(), "blow", BODY, by(seed + 1, BLOW));
        let text = sheet(HITS, r#"band: (from: "20 Hz", to: "5 kHz")"#);
        let outcome = answered(folder.run(&text));
        // expected peak: the raised cosine, whose top is at 4.15 ms, at the nearest sample, 0.48
        // sample intervals from the top
        let beside = 4.15e-3 - (4.15e-3 * RATE).round() / RATE;
        let highest = 300.0 * (PI * beside / 0.3e-3).cos().powi(2);
        for (name, right, all) in [
            ("peak force", highest, &mut peaks),
            ("impulse", 0.5 * 300.0 * 0.3e-3, &mut impulses),
        ] {
            let (found, error) = estimate(&outcome, name);
            assert!(error < 0.05 * right, "{name}: {found} {error}");
            all.push(((found - right) / error).abs());
        }
    }
    // tolerance: one of eight standard normal values exceeds 3.5 in magnitude with a probability of
    // 0.4 %
    assert!(
        peaks.iter().chain(&impulses).all(|z| *z < 3.5),
        "{peaks:?} {impulses:?}"
    );
}

/// The response to the hit is clipped at 60 % of its peak.
#[test]
fn a_clipped_blow_is_in_doubt() {
    let folder = blow_and_hits();
    let text = folder.read("blow1.csv");
    let acceleration = |line: &str| line.split(',').nth(2).and_then(|x| x.parse::<f64>().ok());
    let peak = text.lines().filter_map(acceleration).fold(0.0, f64::max);
    folder.edit("blow1.csv", |_, line| match acceleration(line) {
        Some(value) => {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            cells[2] = value.min(0.6 * peak).to_string();
            cells.join(",")
        }
        None => line.to_owned(),
    });
    let outcome = folder.run(&sheet(HITS, ACTING)).unwrap();
    let reasons = doubts(&outcome).join("; ");
    reasons.must_say("the impact: clipped: `face`");
}

/// The spectrum of a raised cosine of 0.3 ms has its first zero at 6.7 kHz: a band up to 5 kHz cuts
/// it off, a band up to 7 kHz does not.
#[test]
fn a_band_that_ends_below_the_content_of_the_blow_is_named() {
    let noise = 0.9;
    let folder = struck("hit", BODY, Hammer { noise, ..HAMMER });
    strike(folder.path(), "blow", BODY, Hammer { noise, ..BLOW });
    for (to, is_told) in [("5 kHz", true), ("7 kHz", false)] {
        let text = sheet(HITS, &format!(r#"band: (from: "20 Hz", to: "{to}")"#));
        let outcome = folder.run(&text).unwrap();
        let told = |w: &String| w.contains("at the end of the band");
        assert_eq!(outcome.warnings.iter().any(told), is_told, "{to}");
        let peak = quantity(&outcome, "peak force");
        peak.verdict.must_say("peak of the force in the band");
    }
}

const TWO: &str = r#"record: (files: ["blow1.csv"], channels: [(name: "face", from: "acceleration"), (name: "tail", from: "behind"), (name: "hammer", from: "force")]),
    response: "face", compare_with: "hammer""#;

/// The force is determined from two responses. At 1424 Hz, the antiresonance of the struck mass,
/// the response of this mass contains no information on the force, but the response of the other
/// mass does.
#[test]
fn two_responses_tell_what_one_does_not() {
    let folder = blow_and_path();
    write_lines(&folder.file("transfer.csv"), 1, |f| {
        BODY.transfer(f) * Complex64::new(0.0, TAU * f)
    });
    let noise = r#"noise: White("2 m/s2"), band: (from: "60 Hz", to: "2990 Hz")"#; // between lines
    let by = |further: &str| {
        let text = format!(
            r#"Force(title: "blow", problem: Response(path: {FILE}, {TWO}, {noise}, {further}))"#
        );
        folder.run(&text)
    };
    let transfer = FILE
        .replace("File(", "(")
        .replace("accelerance", "transfer");
    let both =
        format!(r#"further: [(response: "tail", path: {transfer}, noise: White("2 m/s2"))]"#);
    let worst = |outcome: &Outcome| {
        let errors = column(outcome, "force", "standard error of the force");
        let force = column(outcome, "force", "force");
        let measured = column(outcome, "force", "measured force");
        let in_band = impulse::FrequencyBand {
            from_hz: 60.0,
            to_hz: 2990.0,
        }
        .of(measured, RATE);
        let squares = force.iter().zip(&in_band).zip(errors);
        let squares = squares
            .map(|((f, m), e)| ((f - m) / e).powi(2))
            .sum::<f64>();
        (errors[1000], squares / force.len() as f64)
    };
    let (one, one_square) = worst(&by("").unwrap());
    let (two, two_square) = worst(&by(&both).unwrap());
    // at 1425 Hz, |H| of the struck mass is 0.02 of that of a free mass, so that its response alone
    // gives a large error
    assert!(two < 0.5 * one, "{two} and {one}");
    // tolerance: the mean square of 236 independent values, from 118 complex lines, is known to 9 %
    assert!(
        (one_square - 1.0).abs() < 0.4 && (two_square - 1.0).abs() < 0.4,
        "{one_square} {two_square}"
    );
    // a further response is refused without its noise, without a path of its own if the path is
    // from a file, and with a name that is used already or unknown
    for (wrong, expected) in [
        (
            both.replace(r#", noise: White("2 m/s2")"#, ""),
            "further[0].noise",
        ),
        (
            r#"further: [(response: "tail", noise: White("2 m/s2"))]"#.to_owned(),
            "further[0].path",
        ),
        (
            both.replace("\"tail\"", "\"hammer\""),
            "further[0].response",
        ),
        (both.replace("\"tail\"", "\"face\""), "`face` again"),
        (both.replace("\"tail\"", "\"tale\""), "tale"),
    ] {
        by(&wrong).refused().must_say(expected);
    }
}

/// Two responses calibrated by the same hits reduce the error of the impulse by a factor of √2.
#[test]
fn two_responses_are_calibrated_by_the_same_hits() {
    let folder = blow_and_hits();
    let hits = HITS.replace(
        r#"from: "acceleration")]"#,
        r#"from: "acceleration"), (name: "back", from: "behind")]"#,
    );
    let by = |further: &str| {
        let text = format!(
            r#"Force(title: "blow", problem: Response(path: {hits}, {TWO}, noise: White("2 m/s2"), {further}))"#
        );
        folder.run(&text).unwrap()
    };
    let two = r#"further: [(response: "tail", of_hits: "back", noise: White("2 m/s2"))]"#;
    let [one, two] = ["", two].map(by);
    for outcome in [&one, &two] {
        let (peak, error) = estimate(outcome, "peak force");
        assert!((peak - 300.0).abs() < 4.0 * error, "{peak} {error}");
    }
    let error = |outcome| quantity(outcome, "impulse").standard_error.unwrap();
    // below the resonance both masses move alike, so that the impulse follows from the mean of two
    // sensors
    assert!(
        (error(&two) / error(&one) * 2.0_f64.sqrt() - 1.0).abs() < 0.2,
        "{} {}",
        error(&two),
        error(&one)
    );
    two.summary.must_say("2 responses at once");
}
