//! The response of a body from hits with one hammer and with two.

use super::*;
use crate::runs::{Folder, Words, answered, doubts, figures_of, tables_of};
use testbed::difference::largest;

/// Fails unless all values are `expected`.
#[track_caller]
fn all_are(values: &[f64], expected: f64) {
    let worst = largest(values.iter().map(|value| value - expected));
    assert!(
        worst < 1e-9 * expected.min(1.0),
        "{values:?}, expected {expected}"
    );
}

#[test]
fn the_response_is_that_of_the_body_within_its_stated_errors() {
    let folder = hits(10, 1e-3, NOISE);
    let outcome = answered(frf(&folder, "hit_*.npy", BAND));
    let log = &outcome.log;
    assert!(log.iter().all(|entry| entry.accepted), "{log:#?}");
    let (mean, beyond) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
    // For ten hits, |δH|² divided by its estimate is distributed as F(2, 18), with the mean 1.125
    // and the standard deviation 1.4. The mean over 590 lines has a standard deviation of 0.06, and
    // (1 + 4/9)^-9 = 3.6 % ± 0.8 % of the lines exceed 4. The limits are four standard deviations.
    assert!((mean - 1.125).abs() < 0.24, "{mean}");
    assert!((beyond - 0.036).abs() < 0.032, "{beyond}");

    let (averages, _) = quantity(&outcome, "averages");
    assert!((averages - 10.0).abs() < 1e-12);
    let (spacing, _) = quantity(&outcome, "distance of lines");
    assert!((spacing - 2.0).abs() < 1e-12);
    // the uncertainties of the sensors, 1 % and 2 %, are independent
    let (calibration, _) = quantity(&outcome, "uncertainty of the calibration, struck end");
    assert!((calibration - 5.0_f64.sqrt()).abs() < 1e-9);
    // the spectrum of a squared sine of T = 1 ms is 20 dB down at 1.65 kHz, where sinc(x)/(1 - x²),
    // x = f T, is a tenth
    let (end, _) = quantity(&outcome, "end of the spectrum of the input");
    assert!((1600.0..1700.0).contains(&end), "{end}");
    let (lowest, _) = quantity(&outcome, "lowest coherence, struck end");
    let coherence = column(&outcome, "response_struck_end", "coherence");
    let least = coherence.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((lowest - least).abs() < 1e-15 && lowest < 1.0);
    assert_eq!(
        figures_of(&outcome),
        "response_struck_end, nyquist_struck_end, hits, input_spectra"
    );
    assert_eq!(outcome.inputs.len(), 10);
}

#[test]
fn the_universal_file_holds_the_response_and_its_coherence() {
    let folder = hits(3, 1e-3, NOISE);
    let outcome = frf(&folder, "hit_*.npy", &format!("kind: Mobility, {BAND}")).unwrap();
    let attachment = &outcome.attachments[0];
    assert_eq!(attachment.name, "frf.uff");
    let contents = format::read_bytes(&attachment.bytes).unwrap();
    assert_eq!(contents.format, "uff58");
    let [mobility, error, freedom, common, coherence] = contents.series.as_slice() else {
        panic!("five series");
    };
    assert_eq!(mobility.kind, SeriesKind::FrequencyResponse);
    assert_eq!(coherence.kind, SeriesKind::Coherence);
    // the mobility has no line at 0 Hz, where the accelerance cannot be integrated
    assert_eq!(
        mobility.ordinate_axis.unit.as_ref().unwrap().dimension(),
        labio::Unit::parse("m/(N s)").unwrap().dimension()
    );
    let (Abscissa::Even { start, step }, Ordinate::Complex(values)) =
        (&mobility.abscissa, &mobility.ordinate)
    else {
        panic!("complex and even");
    };
    assert!((start - 2.0).abs() < 1e-6 && (step - 2.0).abs() < 1e-6);
    let table = response(&outcome, "mobility");
    for (frequency, value) in table {
        let line = ((frequency - start) / step).round() as usize;
        // the text has thirteen digits
        assert!((values[line] - value).norm() < 1e-11 * value.norm());
    }
    // three hits give four degrees of freedom; the sensors have errors of 1 % and 2 %
    let reals = |series: &Series| match &series.ordinate {
        Ordinate::Real(values) => values.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(error.name, "struck end, standard error");
    all_are(&reals(freedom), 4.0);
    let sensors = 0.01_f64.hypot(0.02);
    all_are(&reals(common), sensors);
    let mut properties = mobility.properties.iter();
    let said = properties.find(|(field, _)| field == "uff58.id3");
    assert_eq!(said.unwrap().1, "averages: 3");

    // a mobility read from the file has the same errors and degrees of freedom
    folder.write("frf.uff", &attachment.bytes);
    let read = run(&folder, r#"Mobility(title: "read", source: File(file: "frf.uff"), support: Free(mass: "2 kg ± 1 %"), up_to: "1.2 kHz")"#)
    .unwrap();
    let random = "random error of the magnitude";
    let written = column(&outcome, "response_struck_end", random);
    // the band begins at 20 Hz, which is line 10 of the mobility; line 0 is at 0 Hz
    let again = column(&read, "mobility", "standard error of the magnitude");
    for (there, here) in written.iter().zip(&again[10..]) {
        assert!((there / here - 1.0).abs() < 1e-9);
    }
    let freedom = column(&read, "mobility", "degrees of freedom of the errors");
    all_are(&freedom[10..], 4.0);
    let common = column(&read, "mobility", "error that lines share");
    all_are(&common[10..], 100.0 * sensors);
}

/// A sheet with a second hammer of this sensitivity, which is right or 10 % off.
fn second_of(sensitivity: &str, merge: &str) -> String {
    let second = records("hard/*.npy").replace("2 mV/N ± 1 %", sensitivity);
    let rest = format!("{BAND} second_hammer: (records: {second}{merge}),");
    sheet_of("soft/*.npy", &rest)
}

#[test]
fn s6_hammers_that_differ_in_gain_are_in_doubt_and_both_sensors_count() {
    let folder = Folder::new();
    write_hits(&folder.file("soft"), 5, 2e-3, NOISE);
    write_hits_from(50, &folder.file("hard"), 5, 0.7e-3, NOISE);
    let outcome = answered(run(&folder, &second_of("2 mV/N ± 3 %", "")));
    // the common error is the mean of those of both hammers, weighted by their shares
    let common = column(&outcome, "response_struck_end", "error that lines share");
    let shares = column(&outcome, "response_struck_end", "share of the first hammer");
    for (common, share) in common.iter().zip(shares) {
        let expected =
            100.0 * (share * 0.01_f64.hypot(0.02) + (1.0 - share) * 0.03_f64.hypot(0.02));
        assert!((common / expected - 1.0).abs() < 1e-9);
    }
    let outcome = run(&folder, &second_of("2.2 mV/N ± 1 %", "")).unwrap();
    // the sensitivity is 10 % too large: the force is too small and the response 10 % too large
    doubts(&outcome).must_say("the second hammer gives 1.10");
    let common = column(&outcome, "response_struck_end", "error that lines share");
    // ln 1.1 divided by √2, 6.7 %, and 2.2 % of the sensors, added in squares
    assert!(
        common.iter().all(|error| (error - 7.1).abs() < 0.2),
        "{}",
        common[0]
    );
}

#[test]
fn motions_are_converted_and_a_weighed_mass_carries_the_low_lines() {
    let folder = hits(10, 1e-3, NOISE);
    let text = sheet_of(
        "hit_*.npy",
        r#"kind: Mobility, band: (from: "2 Hz", to: "1.2 kHz"),
           weighed_mass: (mass: "2 kg ± 1 gram", below: "20 Hz", fitted_to: "80 Hz"),"#,
    );
    let outcome = run(&folder, &text).unwrap();
    let (mass, error) = quantity(&outcome, "apparent mass, struck end");
    assert!(
        (mass - MASS).abs() < 4.0 * error.unwrap() + 0.002 * MASS,
        "{mass} {error:?}"
    );
    let validity = words(&outcome, "response_struck_end", "validity");
    for ((frequency, value), validity) in response(&outcome, "mobility").iter().zip(validity) {
        let s = on_axis(*frequency);
        let truth = accelerance(s) / s;
        if *frequency < 20.0 {
            assert_eq!(validity, "of the weighed mass");
            // tolerance: the errors are 1 gram of 2 kg and the neglected term (ω/ω_0)⁴ of the mode
            assert!((value / truth - 1.0).norm() < 2e-3, "{frequency}");
        } else {
            assert_eq!(validity, "valid");
        }
    }
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    // a wrong weighed mass does not agree with the lines
    let wrong = text.replace("2 kg ± 1 gram", "2.5 kg ± 1 gram");
    let outcome = run(&folder, &wrong).unwrap();
    doubts(&outcome)[0].must_say("the difference is larger than their errors explain");
}

#[test]
fn two_hammers_are_one_response() {
    let folder = Folder::new();
    // a soft hammer for the low frequencies and a hard one for the high frequencies
    write_hits(&folder.file("soft"), 8, 4e-3, NOISE);
    write_hits_from(50, &folder.file("hard"), 8, 0.7e-3, 10.0 * NOISE);
    for merge in ["InverseVariance", "LargerInput"] {
        let outcome = answered(run(
            &folder,
            &second_of("2 mV/N ± 1 %", &format!(", merge: {merge}")),
        ));
        let (mean, _) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
        // tolerance: the variances are estimated from 8 hits each, and the hammer with the smaller
        // estimate gets too much weight: the mean is between 7/6 and 1.6
        assert!((1.0..1.9).contains(&mean), "{merge} {mean}");
        let shares = column(&outcome, "response_struck_end", "share of the first hammer");
        let frequency = column(&outcome, "response_struck_end", "frequency");
        for (frequency, share) in frequency.iter().zip(shares) {
            match *frequency {
                f if f < 200.0 => assert!(share > 0.8, "{merge} {f} {share}"),
                f if f > 800.0 => assert!(share < 0.5, "{merge} {f} {share}"),
                _ => {}
            }
        }
        assert_eq!(outcome.inputs.len(), 16);
        figures_of(&outcome).must_say("merge_struck_end");
        tables_of(&outcome).must_say("hits_second_hammer");
    }
}
