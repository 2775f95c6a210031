//! Rods of several lengths, and transducers with errors.

use super::*;
use crate::runs::{Folder, Words, estimate};

/// Stated uncertainties of the rods' lengths and of the gain of the response enter the errors of
/// modulus and viscosity. A test without a specimen is refused if the sheet states none for all
/// tests.
#[test]
fn rods_of_several_lengths_and_uncertain_transducers_are_followed() {
    let folder = Folder::new();
    let truth = Maxwell::new(4e6).unwrap();
    slow_and_fast(&folder, &truth);
    let maxwell = r#"cell: "4 mm", laws: [Maxwell], compare: false, profiles: false"#;
    let relative_error = |rods: [&str; 2], gain: &str| {
        let tests = [
            ("slow.csv", "3 m/s", rods[0]),
            ("fast.csv", "24 m/s", rods[1]),
        ]
        .map(|(file, velocity, length)| {
            let own = format!(
                r#"to: "2.5 ms", specimen: (length: "{length}", density: "912 kg/m3 ± 0.3 %")"#
            );
            let entry = test_entry(file, velocity, &own);
            let channel = r#"from: "free end""#;
            entry.replace(channel, &format!(r#"{channel}, gain: "{gain}""#))
        });
        let of_all = r#"specimen: (length: "394 mm ± 0 mm", density: "912 kg/m3 ± 0 %"),"#;
        let alone = sheet(&tests, maxwell).replacen(of_all, "", 1);
        let outcome = folder.run(&alone).unwrap();
        let (modulus, error) = estimate(&outcome, "Maxwell: Young's modulus E");
        let (viscosity, of_viscosity) = estimate(&outcome, "Maxwell: viscosity eta");
        let off = (modulus / MODULUS).ln() * modulus / error;
        assert!(off.abs() < 3.0, "{off}");
        [error / modulus, of_viscosity / viscosity]
    };
    let exact = relative_error(["394 mm ± 0 mm"; 2], "1");
    // the same rod in both tests: the error is twice 0.5 %, in addition to those of density and
    // noise
    let one = relative_error(["394 mm ± 0.5 %"; 2], "1");
    assert!((one[0] - 0.01_f64.hypot(exact[0])).abs() < 2e-4, "{one:?}");
    // lengths that are written differently are those of two rods, whose errors are independent and
    // have about equal weight
    let two = relative_error(["394 mm ± 0.5 %", "394.0 mm ± 0.5 %"], "1");
    let half = 0.01 / 2.0_f64.sqrt();
    assert!((two[0] - half.hypot(exact[0])).abs() < 4e-4, "{two:?}");
    // the records determine the gain to about 0.4 %, so that the stated 2 % hardly increase the
    // error of the viscosity
    let gain = relative_error(["394 mm ± 0 mm"; 2], "1 ± 2 %");
    assert!(gain[1] > 1.02 * exact[1], "{gain:?} {exact:?}");

    let without =
        sheet(&[test_entry("slow.csv", "3 m/s", "")], maxwell).replace("specimen:", "// ");
    refused(&folder, &without).must_say("tests[0].specimen");
}

#[test]
fn transducers_that_err_more_than_stated_are_found() {
    let linear = Maxwell::new(4e6).unwrap();
    let nonlinear = MaxwellNorton::from_reference_rate(1.8, 8.0, 10e6).unwrap();
    // a linear law depends only on gain and delay of the response; a nonlinear law depends on the
    // scale of the motion, too
    let of_linear = transducers_found(&linear);
    assert_eq!(of_linear.verdict, Verdict::Answered, "{of_linear:?}");
    doubts(&transducers_found(&nonlinear));
}

/// The result of a sheet that corrects a gain and a delay which the records do not have, after a
/// check that the result states both.
fn transducers_found(truth: &impl InelasticLaw) -> Outcome {
    let folder = Folder::new();
    let tests = slow_and_fast(&folder, truth).map(|entry| {
        let channel = r#"from: "free end""#;
        let wrong = format!(r#"{channel}, gain: "0.97", time_skew: "5 us""#);
        entry.replace(channel, &wrong)
    });
    let outcome = folder.run(&sheet(&tests, QUICK)).unwrap();
    let mut told = outcome.summary.iter().chain(&outcome.warnings);
    let found = told.find(|words| words.contains("With the transducers as stated"));
    let found = found.unwrap_or_else(|| panic!("{outcome:?}"));
    let after = |words: &str| -> f64 {
        let rest = found.split(words).nth(1);
        rest.and_then(|rest| rest.split(' ').next()?.parse().ok())
            .unwrap_or_else(|| panic!("{found}"))
    };
    // expected: the gain 1/0.97 and the delay of 5 us that the sheet corrects; tolerance: about
    // three standard errors
    let (gain, delay) = (
        after("a response that reads "),
        after("a delay of the response of "),
    );
    assert!((gain - 1.0 / 0.97).abs() < 0.012, "{found}");
    assert!((delay - 5.0).abs() < 0.5, "{found}");
    found.must_say("check the transducers");
    outcome
}
