//! Modulus from the ratio of the accelerations of the ends.

use std::fmt::Write as _;

use rodlab::outcome::Quantity;

use super::*;
use crate::runs::{
    Folder, Refused, Words, answered, attachments_of, doubts, estimate, figures_of, write_npy,
};

/// The first quantity whose name begins with `name`.
fn beginning<'a>(outcome: &'a Outcome, name: &str) -> &'a Quantity {
    let mut quantities = outcome.quantities.iter();
    quantities.find(|q| q.name.starts_with(name)).unwrap()
}

#[test]
fn ten_hits_on_polypropylene_give_its_modulus_within_the_stated_errors() {
    let folder = hits(10, 1993);
    let rod = virtual_rod::polypropylene();
    let laws = r#"laws: (laws: [Zener, GeneralisedMaxwell, PowerLaw], cards: (name: "PP", poisson_ratio: "0.40", programs: [Abaqus, Ansys, LsDyna], draws: 2)),"#;
    let text = sheet(
        TWO_POINT,
        &format!("{BAND}\n{laws}\nreport_at: [\"1 kHz\", \"5 kHz\", \"40 kHz\"],"),
    );
    let outcome = answered(folder.run(&text));
    let (count, _) = check_lines(&outcome, &rod);
    assert!(count > 700, "{count}");

    // the first sentence states the modulus and the valid band
    outcome.summary[0].must_begin("E' = 2.");
    outcome.summary[0].must_say("valid from");
    let (value, error) = estimate(&outcome, "storage modulus at 4.992 kHz");
    assert!((1e9 * value - rod(4992.0).re).abs() < 3e9 * error);
    let beyond = quantity(&outcome, "storage modulus at 40 kHz");
    assert!(beyond.value.is_none() && !beyond.valid);

    // the log contains the decisions on the ten hits and on the lines
    let mut log = outcome.log.iter();
    let hits = log.clone().filter(|entry| entry.what.starts_with("hit "));
    assert!(hits.map(|entry| entry.accepted).eq([true; 10]));
    assert!(log.any(|entry| entry.what.contains("lines are valid")));
    // a record without faults passes the checks
    for check in ["passivity", "Kramers-Kronig", "causality", "polarity"] {
        let made = beginning(&outcome, &format!("check: {check}"));
        assert_eq!(made.verdict, "passed", "{}", made.name);
    }
    assert_eq!(
        figures_of(&outcome),
        "modulus, dispersion, cole_cole, waves, budget, ratio, hits, laws"
    );
    let cards = "ratio.uff, material.json, PP.inp, PP.mac, PP.k";
    let of_draws = "PP-0001.inp, PP-0001.mac, PP-0001.k";
    attachments_of(&outcome).must_begin(&format!("{cards}, {of_draws}, "));
    assert_eq!(outcome.attachments.len(), 11);
    let text_of = |index: usize| str::from_utf8(&outcome.attachments[index].bytes).unwrap();
    assert!(text_of(5).contains("** draw 1 of 2\n") && text_of(5) != text_of(8));

    // the universal file gives the same moduli as the hits
    folder.write("ratio.uff", &outcome.attachments[0].bytes);
    let start = text.find("source: Hits").unwrap();
    let end = text.find("band:").unwrap();
    let from_file = format!(
        "{}source: Ratio(path: \"ratio.uff\", values: Complex(1), errors: Coherence(column: 2, averages: 10)),\n{}",
        &text[..start],
        &text[end..]
    );
    let other = folder.run(&from_file).unwrap();
    let first = |outcome: &Outcome| numbers(outcome, "modulus", "E'").to_vec();
    for (a, b) in first(&other).iter().zip(first(&outcome)) {
        // tolerance: rounding in the file, amplified on nearly singular lines
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    // a file does not contain the power of the noise, so that variances are not pooled over lines:
    // the validity of some lines near the limits differs
    let pairs = is_valid(&other).into_iter().zip(is_valid(&outcome));
    let (mut both, mut one) = (0, 0);
    for pair in pairs {
        both += usize::from(pair == (true, true));
        one += usize::from(pair.0 != pair.1);
    }
    assert!(10 * one < both, "{one} of {both}");
}

/// A rod that warms by 1.5 K over six hits and softens by 0.3 % per kelvin: without temperatures
/// the result is in doubt because of the trend; with temperatures the slope is found, and the
/// modulus is referred to the temperature of the first hit.
#[test]
fn a_modulus_that_drifts_over_the_hits_is_named_and_referred_to_a_temperature() {
    let folder = Folder::new();
    let rod = virtual_rod::polypropylene();
    let changes: Vec<f64> = (0..6).map(|hit| -0.0009 * f64::from(hit)).collect();
    virtual_rod::write_changing_hits(folder.path(), &changes, 7);
    let unsaid = folder.run(&sheet(TWO_POINT, BAND)).unwrap();
    doubts(&unsaid).must_begin("E' changes by -0.0");

    let at = |rest: &str| {
        let degrees = (0..6).map(|hit| format!("\"{:.1} degC\",", 20.0 + 0.3 * f64::from(hit)));
        let degrees: String = degrees.collect();
        let temperatures = format!("{BAND} temperature: (of_hits: [{degrees}]{rest}),");
        folder.run(&sheet(TWO_POINT, &temperatures))
    };
    let outcome = answered(at(", reference: \"20 degC\""));
    let slope = beginning(&outcome, "change of E' with temperature");
    let (found, error) = (slope.value.unwrap(), slope.standard_error.unwrap());
    assert!(
        (found + 0.003).abs() < 4.0 * error && error < 1e-4,
        "{slope:?}"
    );
    check_lines(&outcome, &rod);
    // the hits are on average 0.75 K above the reference, so that the error of the stated slope
    // contributes 0.75 K times 0.001 1/K
    let stated = at(", reference: \"20 degC\", slope: \"-0.003 1/K ± 0.001 1/K\"").unwrap();
    let common = numbers(&stated, "modulus", "common error of E'");
    let moduli = numbers(&stated, "modulus", "E'");
    let valid = is_valid(&stated);
    let pairs = common.iter().zip(moduli).zip(valid);
    for ((common, modulus), _) in pairs.filter(|(_, valid)| *valid) {
        assert!(common / modulus > 0.000_75, "{common} {modulus}");
    }
    numbers(&stated, "budget", "change with temperature, of E'");
    at("").unwrap();
    let two = format!("{BAND} temperature: (of_hits: [\"20 degC\", \"21 degC\"]),");
    let refused = folder.run(&sheet(TWO_POINT, &two)).refused();
    refused.must_say("one temperature for each of the 6 hits");
}

/// The sheet states a gain that is 2 % off and a time skew that the records do not have. Within
/// their stated errors both are determined from the lines and corrected; larger deviations put the
/// result in doubt. So does a wrong mass on the free end.
#[test]
fn errors_of_the_sensors_are_found_and_taken_out() {
    let folder = hits(10, 1993);
    let rod = virtual_rod::polypropylene();
    let with = |sensitivity: &str, skew: &str| {
        let channel = r#"from: 2, unit: "V", sensitivity: "0.5 mV/g""#;
        let text = sheet(TWO_POINT, BAND);
        text.must_say(channel);
        let changed =
            format!(r#"from: 2, unit: "V", sensitivity: "{sensitivity}", time_skew: "{skew}""#);
        folder.run(&text.replace(channel, &changed)).unwrap()
    };
    let right = with("0.51 mV/g ± 2 %", "4 us ± 3 us");
    assert_eq!(right.verdict, Verdict::Answered);
    check_lines(&right, &rod);
    let (gain, error) = estimate(&right, "error of the ratio of the sensitivities, found");
    // the denominator is 2 % too small; tolerance: four standard errors
    assert!(
        (gain - 100.0 * 1.02_f64.ln()).abs() < 4.0 * error && error < 0.1,
        "{gain} {error}"
    );
    let (delay, error) = estimate(&right, "delay between the channels, found");
    assert!(
        (delay.abs() - 4.0).abs() < 4.0 * error && error < 0.1,
        "{delay} {error}"
    );

    let reasons = doubts(&with("0.6 mV/g ± 1 %", "0 us")).join("; ");
    reasons.must_say("more than its stated uncertainty explains");
    // the stated skew moves samples that were not late
    let reasons = doubts(&with("0.5 mV/g", "6 us ± 1 us")).join("; ");
    reasons.must_say_all(&[
        "according to the lines, the delay between the channels is ",
        "; state it as `time_skew` of a channel, such as ",
    ]);
    let unstated = folder.run(&sheet(TWO_POINT, BAND)).unwrap();
    let advice = "State it as the ± of the channels, such as `gain` \"1 ± 1 %\" and `time_skew` \"0 us ± 5 us\".";
    unstated.warnings.must_say(advice);

    let text = sheet(TWO_POINT, BAND)
        .replace(
            r#"sensitivity: "0.5 mV/g""#,
            r#"sensitivity: "0.5 mV/g ± 1 %""#,
        )
        .replace("2.9 gram ± 0.03 gram", "4 gram ± 0.04 gram");
    let heavier = folder.run(&text).unwrap();
    let reasons = doubts(&heavier).join("; ");
    reasons.must_say("the error of the mass on the free end is (1.0");
    let (mass, error) = estimate(&heavier, "error of the mass on the free end, found");
    // the lines alone give 1.1 gram; the stated 0 ± 0.04 gram reduces this value
    let expected = 1.1 * (1.0 - (error / 0.04).powi(2));
    assert!(
        (mass - expected).abs() < 4.0 * error && error < 0.02,
        "{mass} {error}"
    );
}

/// Causal estimates from hits with a sensitivity that is 2 % off, and from moduli at resonances.
#[test]
fn the_causal_modulus_is_that_of_the_rod() {
    let folder = hits(10, 1993);
    let rod = virtual_rod::polypropylene();
    let channel = r#"from: 2, unit: "V", sensitivity: "0.5 mV/g""#;
    let wrong = r#"from: 2, unit: "V", sensitivity: "0.51 mV/g ± 2 %", time_skew: "4 us ± 3 us""#;
    let rest = format!("{BAND} causal: true,");
    let text = sheet(TWO_POINT, &rest).replace(channel, wrong);
    let outcome = answered(folder.run(&text));
    let (count, z, of_loss) = check_causal(&outcome, &rod);
    let valid = is_valid(&outcome).iter().filter(|valid| **valid).count();
    assert!(count > valid, "{count} {valid}");
    // tolerance: the errors of neighbouring lines are strongly correlated, so that there are few
    // independent values
    assert!(z < 1.8, "{z}");
    let mut of_lines = numbers(&outcome, "modulus", "standard error of the loss factor").to_vec();
    of_lines.sort_by(f64::total_cmp);
    assert!(of_loss < 0.25 * of_lines[of_lines.len() / 2], "{of_loss}");
    let mut summary = outcome.summary.iter();
    let said = summary.find(|s| s.starts_with("Causal estimate of"));
    said.unwrap().must_say("delay between the channels");
    figures_of(&outcome).must_say("causal");

    let resonances = r#"Resonances(impacted_end: "struck end", free_end: "free end")"#;
    let outcome = folder.run(&sheet(resonances, &rest)).unwrap();
    let (count, z, _) = check_causal(&outcome, &rod);
    assert!((5..20).contains(&count) && z < 2.0, "{count} {z}");
}

#[test]
fn two_sections_and_a_free_end_and_resonances_agree_with_the_two_point_method() {
    let folder = hits(10, 7);
    let rod = virtual_rod::polypropylene();
    let free_end = r#"FreeEnd(first: (channel: "struck end", from_free_end: "799 mm"), second: (channel: "free end", from_free_end: "0 mm"), wave_speed: "1700 m/s")"#;
    // this method uses the distances of the sections, not the length
    let text = sheet(free_end, BAND).replace(" ± 0.29 mm", "");
    let outcome = answered(folder.run(&text));
    assert!(check_lines(&outcome, &rod).0 > 600);

    let resonances = r#"Resonances(impacted_end: "struck end", free_end: "free end")"#;
    let outcome = answered(folder.run(&sheet(resonances, BAND)));
    let (count, _) = check_lines(&outcome, &rod);
    // one modulus for each resonance: kL = (n - 1/2)π up to 20 kHz
    assert!((5..20).contains(&count), "{count}");
}

#[test]
fn a_ratio_of_another_program_is_taken_with_its_coherence() {
    let folder = Folder::new();
    let rod = virtual_rod::polypropylene();
    // the exact ratio cosh γL without an accelerometer
    let mut file = "Frequency [Hz],real,imaginary,coherence\n".to_owned();
    for j in 1..=400 {
        let f = 25.0 * f64::from(j);
        let omega = TAU * f;
        let gamma = Complex64::new(0.0, omega) * (912.0 / rod(f)).sqrt();
        let ratio = (0.8 * gamma).cosh();
        writeln!(file, "{f},{},{},0.9999", ratio.re, ratio.im).unwrap();
    }
    folder.write("psi.csv", file);
    let text = r#"Modulus(title: "By hand", specimen: (length: "800 mm", diameter: "10 mm", density: "912 kg/m3"),
    method: TwoPoint(impacted_end: "A", free_end: "B"),
    source: Ratio(
        path: "psi.csv", values: Parts(real: "real", imaginary: "imaginary"),
        errors: Coherence(column: "coherence", averages: 20),
    ),
    limits: (loss_factor: "20 %", storage_modulus: "3 %"),
    lateral_inertia: (poisson_ratio: "0.40 ± 0.02"),
)"#;
    let outcome = answered(folder.run(text));
    let frequency = numbers(&outcome, "modulus", "frequency").to_vec();
    let before = "E' before the correction of lateral inertia";
    let with = numbers(&outcome, "modulus", before).to_vec();
    let without = numbers(&outcome, "modulus", "E'");
    for (line, _) in is_valid(&outcome).iter().enumerate().filter(|(_, v)| **v) {
        let f = frequency[line];
        let truth = 1e-9 * rod(f).re;
        assert!((with[line] / truth - 1.0).abs() < 1e-6, "{f} Hz");
        assert!(without[line] >= with[line]);
    }
    // the error of the diameter affects E' only by the correction, to leading order with twice its
    // relative size
    let uncertain = text.replace("\"10 mm\"", "\"10 mm ± 1 %\"");
    let found = folder.run(&uncertain).unwrap();
    let of_diameter = numbers(&found, "budget", "diameter, of E'");
    for (line, _) in is_valid(&found).iter().enumerate().filter(|(_, v)| **v) {
        let expected = 2.0 * (1.0 - with[line] / without[line]);
        // tolerance: above λ = 15 D the next order is below 1 % of the correction, which is
        // computed with an error of 1e-10 of E'
        let (f, found) = (frequency[line], of_diameter[line]);
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "{f} Hz: {found} % {expected} %"
        );
    }
    let correction = "    lateral_inertia: (poisson_ratio: \"0.40 ± 0.02\"),\n";
    let refused = folder.run(&uncertain.replace(correction, "")).refused();
    refused.must_begin("specimen.diameter is `10 mm ± 1 %`, expected the value without ±");
    refused.must_say("nor a correction of lateral inertia");
    assert_eq!(outcome.inputs[0].path, "psi.csv");
}

/// In records of one second the rod moves for 60 ms. The part after that is left out, which makes
/// more of the band valid, and the valid lines are right.
#[test]
fn the_rest_at_the_end_of_long_hits_is_left_out() {
    let folder = hits(3, 7);
    let contents = labio::format::read(folder.file("hits.npy")).unwrap();
    let mut noise = testbed::noise::Noise::seeded(7);
    for hit in 0..3 {
        let rows = contents.series.iter().map(|series| {
            let labio::Ordinate::Real(all) = &series.ordinate else {
                unreachable!("real samples");
            };
            let mut row = all[hit * SAMPLES..(hit + 1) * SAMPLES].to_vec();
            // the rod is at rest in the first half of a millisecond
            let square = row[..32].iter().map(|x| x * x).sum::<f64>() / 32.0;
            row.extend((SAMPLES..16 * SAMPLES).map(|_| square.sqrt() * noise.normal()));
            row
        });
        let rows: Vec<Vec<f64>> = rows.collect();
        write_npy(&folder.file(format!("long-{hit}.npy")), &rows);
    }
    let of_tail = |tail: &str| {
        let text = sheet(TWO_POINT, BAND)
            .replace("\"hits.npy\"", "\"long-*.npy\"")
            .replace("hits: (\n", &format!("{tail} hits: (\n"));
        let start = text.find("cut:").unwrap();
        let end = start + text[start..].find('\n').unwrap();
        let outcome = folder.run(&text.replace(&text[start..end], "")).unwrap();
        let valid = is_valid(&outcome);
        let share = valid.iter().filter(|valid| **valid).count() as f64 / valid.len() as f64;
        (outcome, valid.len(), share)
    };
    let (outcome, n_lines, share) = of_tail("");
    check_lines(&outcome, &virtual_rod::polypropylene());
    let mut settings = outcome.settings.iter();
    let setting = settings.find(|s| s.name == "source.tail");
    setting.unwrap().value.must_say("of 65536 samples");
    let (_, all, of_all) = of_tail("tail: Keep,");
    assert!(4 * n_lines < all + 8, "{n_lines} of {all}");
    assert!(share > 1.2 * of_all, "{share} {of_all}");
}
