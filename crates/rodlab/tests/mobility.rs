//! Mobilities from virtual hits, from files and of computed bodies. The hits on two masses with a
//! spring and a dashpot between them are integrated in time; the expected mobility is the closed
//! form.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use num_complex::Complex64;
use rodlab::outcome::{Cells, Outcome, Verdict};

use crate::runs::{
    Refused, Words, answered, column, doubts, estimate, figures_of, outcome_of, quantity, refusal,
    words,
};
use crate::two_masses::{BODY, Body, HAMMER, Hammer, strike, struck};

const CHANNELS: &str =
    r#"channels: [(name: "hammer", from: "force"), (name: "face", from: "acceleration")]"#;

fn hits(pattern: &str) -> String {
    format!(r#"(records: (files: ["{pattern}"], {CHANNELS}), force: "hammer", response: "face")"#)
}

fn all_hits() -> String {
    format!("Hits{}", hits("hit*.csv"))
}

fn two_hammers(low: &str, high: &str) -> String {
    format!("TwoHammers(low: {low}, high: {high})")
}

fn sheet(source: &str, rest: &str) -> String {
    format!(r#"Mobility(title: "two masses", source: {source}, {rest})"#)
}

fn lines(outcome: &Outcome) -> Vec<Complex64> {
    let parts = column(outcome, "mobility", "real part").iter();
    parts
        .zip(column(outcome, "mobility", "imaginary part"))
        .map(|(re, im)| Complex64::new(*re, *im))
        .collect()
}

/// The lines with their frequencies \[Hz\].
fn with_frequencies(outcome: &Outcome) -> impl Iterator<Item = (f64, Complex64)> {
    let frequency = column(outcome, "mobility", "frequency").to_vec();
    frequency.into_iter().zip(lines(outcome))
}

/// Mean of the squared errors of the lines from 100 Hz to 4 kHz in units of their variances.
fn mean_square_error(outcome: &Outcome, body: Body) -> f64 {
    let errors = column(outcome, "mobility", "standard error");
    let mut squares = Vec::new();
    for ((f, line), error) in with_frequencies(outcome).zip(errors) {
        if (100.0..4000.0).contains(&f) {
            squares.push((line - body.mobility(f)).norm_sqr() / (error * error));
        }
    }
    squares.iter().sum::<f64>() / squares.len() as f64
}

const WEIGHED: &str = r#"support: Free(mass: "1.5 kg ± 1 gram"), up_to: "5 kHz""#;

#[test]
fn hits_give_the_mobility_within_its_errors() {
    let folder = struck("hit", BODY, HAMMER);
    let text = sheet(&all_hits(), WEIGHED);
    let outcome = answered(folder.run(&text));
    // tolerance: the variance of a line is estimated from 8 hits, so that the mean is 7/6; over 156
    // lines the mean scatters by 8 %, or more because of the tails of Student's distribution
    let found = mean_square_error(&outcome, BODY);
    assert!((0.75..1.75).contains(&found), "{found}");
    // 2 (8 - 1) = 14 degrees of freedom, and few more due to the truncation of the records
    let freedom = column(&outcome, "mobility", "degrees of freedom of the errors");
    let mut known: Vec<f64> = freedom.iter().copied().filter(|n| !n.is_nan()).collect();
    known.sort_by(f64::total_cmp);
    assert!(
        known[0] >= 14.0 - 1e-9 && known[known.len() / 2] < 20.0,
        "{known:?}"
    );
    let (mass, error) = estimate(&outcome, "mass by the low lines");
    // tolerance: the neglected elastic term of fourth order, (f/1.74 kHz)^4, contributes up to 1 %
    assert!((mass - 1.5).abs() < 4.0 * error + 0.015, "{mass} {error}");
    for check in [
        "mass by the low lines",
        "energy ahead of the impulse",
        "lines that make energy",
    ] {
        assert!(quantity(&outcome, check).valid, "{check}");
    }
    assert_eq!(outcome.log.iter().filter(|entry| entry.accepted).count(), 8);
    assert_eq!(outcome.inputs.len(), 8);
    // there is no impulse response, because the impedance of the face, with which it begins, is not
    // stated
    assert_eq!(figures_of(&outcome), "mobility, nyquist");
    outcome.warnings.must_begin("There is no impulse response");

    // the universal file is read back with the same values and errors
    let attachment = &outcome.attachments[0];
    folder.write(&attachment.name, &attachment.bytes);
    let from_file = sheet(r#"File(file: "mobility.uff")"#, WEIGHED);
    let again = folder.run(&from_file).unwrap();
    for (there, here) in lines(&outcome).iter().zip(lines(&again)).skip(1) {
        assert!((there - here).norm() < 1e-10 * there.norm()); // thirteen digits
    }
    let [there, here] = [&outcome, &again].map(|o| column(o, "mobility", "standard error"));
    for (there, here) in there.iter().zip(here).skip(1) {
        assert!((there / here - 1.0).abs() < 1e-10);
    }
}

#[test]
fn the_head_is_taken_off_and_low_lines_are_those_of_the_balance() {
    let with_head = Body {
        struck: 1.04,
        ..BODY
    };
    let folder = struck("hit", with_head, HAMMER);
    let source = all_hits();
    let loaded = folder.run(&sheet(&source, WEIGHED)).unwrap();
    // 40 g are 4 % of the struck mass, more than the errors of the lines
    assert!(mean_square_error(&loaded, BODY) > 10.0);
    let rest = format!(
        r#"{WEIGHED}, head_mass: "40 gram ± 0.5 gram", complete: (below: "100 Hz", fitted_to: "400 Hz")"#
    );
    let outcome = folder.run(&sheet(&source, &rest)).unwrap();
    let found = mean_square_error(&outcome, BODY);
    assert!((0.75..1.75).contains(&found), "{found}");
    for (f, line) in with_frequencies(&outcome) {
        if f > 0.0 && f < 100.0 {
            // tolerance: the mass is exact here; the elastic term is (f/1.2 kHz)^2 = 0.7 % at most,
            // and known to a few per cent
            let exact = BODY.mobility(f);
            assert!((line / exact - 1.0).norm() < 1e-3, "{f} Hz");
        }
    }
    assert_eq!(
        words(&outcome, "mobility", "validity")[1],
        "valid, by the weighed mass"
    );
    let change = quantity(
        &outcome,
        "largest change by the uncertainty of the head mass",
    );
    // expected: dG/G = i omega G dm is largest at the resonance below 5 kHz, of the order of 0.5 g
    // divided by the modal mass
    assert!((0.05..5.0).contains(&change.value.unwrap()), "{change:?}");
}

#[test]
fn r11_a_sensor_the_wrong_way_round_and_a_wrong_mass_put_a_mobility_in_doubt() {
    let folder = struck("hit", BODY, HAMMER);
    let source = all_hits();
    let inverted = source.replace(
        r#"from: "acceleration""#,
        r#"from: "acceleration", inverted: true"#,
    );
    let outcome = folder.run(&sheet(&inverted, WEIGHED)).unwrap();
    let making = quantity(&outcome, "lines that make energy");
    assert!(!making.valid && making.value.unwrap() > 10.0, "{making:?}");
    let said = doubts(&outcome).join("; ");
    said.must_say_all(&["screening: ", "generate energy"]);
    assert!(outcome.quantities.iter().all(|quantity| !quantity.valid));
    words(&outcome, "mobility", "validity").must_say("generates energy");
    // a wrong mass is stated, as if another body had been weighed
    let wrong = WEIGHED.replace("1.5 kg", "1.8 kg");
    let outcome = folder.run(&sheet(&source, &wrong)).unwrap();
    assert!(!quantity(&outcome, "mass by the low lines").valid);
    let said = doubts(&outcome).join("; ");
    said.must_begin("screening: ");
    said.must_say("1.8");
    // no support is stated
    let outcome = folder.run(&sheet(&source, "")).unwrap();
    assert_eq!(
        outcome.warnings,
        [
            "The support of the body is not stated (`support`), and no line at 0 Hz indicates it: the mobility is not screened, and has no impulse response."
        ]
    );
}

/// Lines that were replaced by those of the weighed mass do not confirm this mass.
#[test]
fn s5_a_wrong_mass_is_named_though_it_made_the_low_lines() {
    let folder = struck("hit", BODY, HAMMER);
    let source = all_hits();
    let complete = r#"up_to: "5 kHz", complete: (below: "250 Hz", fitted_to: "600 Hz")"#;
    let of = |mass: &str| {
        let rest = format!(r#"support: Free(mass: "{mass} ± 1 gram"), {complete}"#);
        folder.run(&sheet(&source, &rest)).unwrap()
    };
    let right = of("1.5 kg");
    assert_eq!(right.verdict, Verdict::Answered);
    let wrong = of("2.25 kg");
    let mass = quantity(&wrong, "mass by the low lines");
    // the lines that were measured give 1.5 kg
    assert!(
        !mass.valid && (mass.value.unwrap() - 1.5).abs() < 0.05,
        "{mass:?}"
    );
    doubts(&wrong).must_say("expected the weighed 2.25 kg");
}

#[test]
fn s12_a_channel_that_is_5_us_early_or_late_is_found() {
    // noise of 0.05 % of the peak of the accelerometer
    let hammer = Hammer {
        noise: 0.1,
        ..HAMMER
    };
    let folder = struck("hit", BODY, hammer);
    let source = all_hits();
    let good = answered(folder.run(&sheet(&source, WEIGHED)));
    for name in [
        "motion too early that would have been seen",
        "motion too late that would have been seen",
    ] {
        let seen = quantity(&good, name).value.unwrap();
        assert!(seen > 0.0 && seen < 5.0, "{name}: {seen} us");
    }
    for skew in ["5 us", "-5 us"] {
        let skewed = source.replace(
            r#"from: "acceleration""#,
            &format!(r#"from: "acceleration", time_skew: "{skew}""#),
        );
        let outcome = folder.run(&sheet(&skewed, WEIGHED)).unwrap();
        let reasons = doubts(&outcome).join("; ");
        let causes = ["generate energy", "the force, according to"];
        assert!(
            causes.iter().any(|cause| reasons.contains(cause)),
            "{skew}: {reasons}"
        );
    }
}

#[test]
fn s6_an_estimator_of_the_second_hammer_acts_or_is_refused() {
    let few = Hammer { hits: 3, ..HAMMER };
    let folder = struck("soft", BODY, Hammer { pulse: 1e-3, ..few });
    strike(folder.path(), "hard", BODY, Hammer { seed: 4, ..few });
    let with = |low: &str, high: &str| {
        let of = |pattern: &str, estimator: &str| {
            hits(pattern).replace("force:", &format!("estimator: {estimator}, force:"))
        };
        let source = two_hammers(&of("soft*.csv", low), &of("hard*.csv", high));
        let run = folder.run(&sheet(&source, WEIGHED));
        run.map(|outcome| lines(&outcome)[40])
    };
    let said = with("H1", "H2").refused();
    insta::assert_snapshot!(said, @"source.high.estimator is H2, expected H1, as in source.low");
    assert!((with("H1", "H1").unwrap() / with("H2", "H2").unwrap() - 1.0).norm() > 1e-9);
}

#[test]
fn r24_without_a_limit_lines_are_screened_that_carry_a_signal() {
    let folder = struck("hit", BODY, HAMMER);
    let free = WEIGHED.replace(r#", up_to: "5 kHz""#, "");
    let text = sheet(&all_hits(), &free);
    let outcome = answered(folder.run(&text));
    let named = |name: &str| outcome.settings.iter().find(|s| s.name == name);
    let screened = named("lines that are screened").unwrap();
    assert!(
        screened.by_default && screened.value.starts_with("up to "),
        "{screened:?}"
    );
}

#[test]
fn r10_one_hit_in_two_files_is_refused_in_one_hammer_and_in_two() {
    let folder = struck("hit", BODY, HAMMER);
    let hit = folder.read("hit3.csv");
    folder.write("soft_hit.csv", &hit);
    // a file with other bytes but the same numbers
    folder.write("hit9.csv", hit.clone() + "\n");
    let one = sheet(&all_hits(), WEIGHED);
    let said = folder.run(&one).refused();
    insta::assert_snapshot!(said, @"hit 3, hit3.csv and hit 9, hit9.csv have the same samples: they are one measurement, expected independent measurements: remove one of the two from the sheet");
    fs::remove_file(folder.file("hit9.csv")).unwrap();
    fs::copy(folder.file("hit4.csv"), folder.file("soft_other.csv")).unwrap();
    let two = two_hammers(&hits("soft*.csv"), &hits("hit*.csv"));
    let said = folder.run(&sheet(&two, WEIGHED)).refused();
    said.must_say("have the same content");
    // a file that is listed for both hammers is refused as well
    let two = two.replace("soft*.csv", "hit[12].csv");
    let said = folder.run(&sheet(&two, WEIGHED)).refused();
    insta::assert_snapshot!(said, @"hit 1, hit1.csv and hit 1, hit1.csv have the same samples: they are one measurement, expected independent measurements: remove one of the two from the sheet");
}

#[test]
fn a_soft_and_a_hard_hammer_become_one() {
    let soft = Hammer {
        pulse: 2e-3,
        ..HAMMER
    };
    let hard = Hammer {
        pulse: 0.2e-3,
        seed: 4,
        ..HAMMER
    };
    let folder = struck("soft", BODY, soft);
    strike(folder.path(), "hard", BODY, hard);
    for merge in ["LargerForce", "InverseVariance"] {
        let high = format!("{}, merge: {merge}", hits("hard*.csv"));
        let source = two_hammers(&hits("soft*.csv"), &high);
        let outcome = folder.run(&sheet(&source, WEIGHED)).unwrap();
        let found = mean_square_error(&outcome, BODY);
        // tolerance: the weights are estimated from 8 hits each, so that the stated variance is too
        // small by up to a half
        assert!((0.7..2.5).contains(&found), "{merge}: {found}");
        let share = column(&outcome, "mobility", "weight of the light hammer");
        for (f, share) in column(&outcome, "mobility", "frequency")
            .iter()
            .zip(share)
            .skip(1)
        {
            // the pulses have the same height, so that the long one has the larger spectrum below
            // about the inverse of its duration
            if merge == "LargerForce" && *f < 400.0 {
                assert!(share.abs() < 1e-12, "{f} Hz");
            } else if merge == "LargerForce" && *f > 1100.0 {
                assert!((share - 1.0).abs() < 1e-12, "{f} Hz");
            }
        }
        assert!(quantity(&outcome, "mass by the low lines").valid);
    }
}

#[test]
fn too_few_hits_are_no_mobility() {
    let folder = struck("hit", BODY, Hammer { hits: 2, ..HAMMER });
    let source = hits("hit*.csv").replace(
        "force: \"hammer\"",
        r#"hits: (reject: [(hit: 2, because: "slipped")]), force: "hammer""#,
    );
    let text = sheet(&format!("Hits{source}"), WEIGHED);
    let outcome = folder.run(&text).unwrap();
    insta::assert_snapshot!(refusal(&outcome), @"1 hit of 2 accepted in `source`, and a mobility with errors needs at least 2: the log states what is wrong with the others");
    assert_eq!(outcome.log[1].reasons, ["rejected by hand: slipped"]);
}

#[test]
fn a_computed_mass_has_its_mobility_and_its_impulse_response() {
    let text = r#"Mobility(title: "computed", source: Computed(body: RigidMass("2 kg"), up_to: "10 kHz", lines: 1000))"#;
    let outcome = outcome_of(Path::new("."), text).unwrap();
    for (f, line) in with_frequencies(&outcome).skip(1) {
        assert!((line * Complex64::new(0.0, TAU * f) * 2.0 - 1.0).norm() < 1e-12);
    }
    let Cells::Numbers(impulse) = &outcome.tables[1].columns[1].cells else {
        unreachable!("numbers");
    };
    // tolerance: the damped transform rounds the jump at time 0, with an error of 3e-5 one step
    // later
    assert!(impulse.iter().all(|v| (v * 2.0 - 1.0).abs() < 5e-5));
}

#[test]
fn what_cannot_be_is_refused_where_it_stands() {
    let folder = struck("hit", BODY, Hammer { hits: 2, ..HAMMER });
    folder.write(
        "odd.csv",
        "frequency [Hz],response [m/s],other\n10,1,2\n20,1,2\n30,1,2\n",
    );
    let refused = |source: &str, rest: &str| folder.run(&sheet(source, rest)).refused();
    let good = hits("hit*.csv");
    let changed = |from: &str, to: &str| refused(&format!("Hits{}", good.replace(from, to)), "");
    let refusals = [
        changed("force: \"hammer\"", "force: \"face\""),
        changed("response: \"face\"", "response: \"fase\""),
        changed("response: \"face\"", "response: \"hammer\""),
        refused(
            &format!("Hits{good}"),
            r#"complete: (below: "100 Hz", fitted_to: "400 Hz")"#,
        ),
        refused(&format!("Hits{good}"), r#"up_to: "50 Hz""#),
        refused(&format!("Hits{good}"), r#"head_mass: "4 mm""#),
        refused(&format!("TwoHammers(low: {good})"), ""),
        refused(r#"File(file: "odd.csv")"#, ""),
        refused(r#"File(file: "odd.csv", data_set: "response")"#, ""),
        refused(r#"File(file: "odd.csv", data_set: 3)"#, ""),
        refused(
            r#"Computed(body: RigidMass("1 kg"), up_to: "1 kHz", lines: 2)"#,
            "",
        ),
        refused(
            r#"Computed(body: RigidMass("1 kg"), up_to: "1 kHz", lines: 20)"#,
            r#"head_mass: "4 gram""#,
        ),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r#"
    source.force is `face`, a channel of acceleration, expected a channel of force [N]
    source.response is `fase`, expected one of the channels `hammer`, `face`
    source.response is `hammer`, a channel of force, expected a channel of acceleration, velocity or displacement
    complete is stated, expected a free body, whose weighed mass replaces the low-frequency lines
    up_to is 50 Hz, with 3 lines up to it, expected a frequency with at least 8 lines below it
    test.ron:1:206: Mobility.head_mass: `4 mm` has the dimension of a length (m), expected a mass, such as "2.9 gram" or "0 kg", with or without ±
    test.ron:1:205: Mobility.source.TwoHammers: the field `high` is missing
    source.data_set is not stated, and odd.csv has 0 complex data sets, expected one of the data sets 1 `response`, 2 `other`
    source.file is odd.csv, whose data set is in m/s, expected a response between a force and a motion, such as one in m/s/N
    source.data_set is data set 3, expected one of the data sets 1 `response`, 2 `other` (odd.csv)
    source.lines is 2, expected a number from 8 to 4194304
    head_mass is stated, expected no value: a computed body has no impedance head
    "#);
}
