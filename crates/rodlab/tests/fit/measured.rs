//! Measured sweeps, evaluated from the file to master curve and card.

use rodlab::Outcome;
use rodlab::outcome::Verdict;

use super::{numbers, quantity};
use crate::runs::{Folder, Words};

/// The outcome of a sheet whose files are in the folder of measured data; `None` if they do not
/// exist.
fn measured(table: &str, rest: &str) -> Option<Outcome> {
    let dma = testbed::measured::folder()?.join("dma");
    if !dma.is_dir() {
        return None;
    }
    let folder = Folder::new();
    #[cfg(unix)]
    std::os::unix::fs::symlink(dma, folder.file("dma")).unwrap();
    #[cfg(not(unix))]
    return None;
    let text =
        format!("Fit(title: \"measured\", tables: [({table})], density: \"1200 kg/m3\", {rest})");
    Some(folder.run(&text).unwrap())
}

const PYVISCO: &str = r#"files: ["dma/pyvisco_freq_user_raw.csv"], frequency: "f", modulus: Parts(storage: "E_stor", loss: "E_loss"),
    temperature: Column("T")"#;

/// log₁₀ a_T of pyvisco 2.1.3 at the steps from 25 to 100 °C, which fits power laws to the storage
/// moduli of neighbouring temperatures.
const BY_PYVISCO: [f64; 11] = [
    0.0, -1.756, -3.6162, -5.412, -6.736, -7.8214, -8.7681, -9.6169, -10.3781, -11.0608, -11.6559,
];

#[test]
fn a_measured_sweep_becomes_one_curve_and_a_card() {
    let rest = r#"reference_temperature: "25 degC", laws: (laws: [FractionalZener, GeneralisedMaxwell],
        cards: (name: "PV", poisson_ratio: "0.35", programs: [Abaqus]))"#;
    let Some(outcome) = measured(PYVISCO, rest) else {
        return;
    };
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    let temperatures = numbers(&outcome, "shifts", "temperature");
    let shifts = numbers(&outcome, "shifts", "log10 of the shift");
    assert_eq!(temperatures.len(), 21);
    assert_eq!(numbers(&outcome, "data", "frequency").len(), 210);
    assert!(shifts.is_sorted_by(|a, b| a > b), "{shifts:?}");

    // tolerance: 1.5 % of |E| was found; the error of the instrument at 100 Hz is the largest part
    let residual = quantity(&outcome, "residual of the master curve");
    let residual = residual.value.unwrap();
    println!("residual {residual} % of |E|");
    assert!(residual < 1.7, "{residual}");

    // in the transition, above 47 °C, storage and loss modulus have the same shifts
    let own = &shifts[10..];
    let mut differences = Vec::new();
    for step in 4..BY_PYVISCO.len() {
        let difference = own[step] - own[step - 1] - (BY_PYVISCO[step] - BY_PYVISCO[step - 1]);
        differences.push(difference);
        assert!(difference.abs() < 0.05, "{step}: {difference}");
    }
    println!("steps of log a minus those of pyvisco: {differences:?}");
    // WLF does not describe all shifts from the glass to the rubber; its largest deviation is
    // smaller if all shifts have equal errors
    let verdict = &quantity(&outcome, "WLF, C1").verdict;
    verdict.must_begin("the shifts differ from the law by more than their errors");
    let farthest = |row: usize| {
        let of = |column: &str| numbers(&outcome, "shift_laws", column)[row];
        let (c1, c2, reference) = (of("C1"), of("C2"), temperatures[10]);
        let law = |t: f64| -c1 * (t - reference) / (c2 + t - reference);
        let all = temperatures.iter().zip(shifts).skip(6);
        let far = all.fold(0.0_f64, |far, (t, shift)| far.max((law(*t) - shift).abs()));
        println!("WLF: C1 = {c1}, C2 = {c2} K, farthest shift {far}");
        far
    };
    let (own, equal) = (farthest(0), farthest(2));
    assert!(equal < 1.0 && own > equal, "{own} {equal}");
    let card = String::from_utf8(outcome.attachments[1].bytes.clone()).unwrap();
    card.must_say("** temperature: master curve of 21 temperatures at 24.98 \u{b0}C");
    card.must_say("*VISCOELASTIC, TIME=PRONY");
}

/// 22 files in ISO-8859-1, with an index as first column and a last line without data. To save
/// time, only one of the three decades of frequency is evaluated.
#[test]
fn files_of_an_instrument_are_read_as_they_are() {
    let table = r#"files: ["dma/glassy-polymer/T*.txt"], frequency: "f", modulus: Parts(storage: "E'", loss: "E\""), temperature: Column("Ts")"#;
    let rest = r#"steps: Column("Tr"), reference_temperature: "72 degC", band: (from: "0.1 Hz", to: "1 Hz")"#;
    let Some(outcome) = measured(table, rest) else {
        return;
    };
    assert_eq!(outcome.inputs.len(), 22);
    let warnings = &outcome.warnings;
    let beyond = "The rows of 22 files, such as dma/glassy-polymer/T0.txt, are followed by text that is not a row of numbers";
    warnings.must_begin(beyond);
    warnings.must_begin("The temperatures of a step differ by up to 1.7");
    let residual = quantity(&outcome, "residual of the master curve");
    let residual = residual.value.unwrap();
    let joined = numbers(&outcome, "shifts", "temperature").len();
    println!(
        "{joined} of 22 temperatures, residual {residual} % of |E|; {:?}",
        outcome.verdict
    );
    assert!(joined >= 16 && residual < 1.0, "{joined} {residual}");
    assert_eq!(numbers(&outcome, "data", "frequency").len(), 220);
}
