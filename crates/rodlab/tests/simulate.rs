//! Virtual tests from sheets: their records, and the results of their evaluation.

use std::fs;
use std::path::Path;

use labio::{Ordinate, Series};
use num_complex::Complex64;
use rodlab::outcome::{Outcome, Verdict};

use crate::runs::{
    Folder, Refused, Words, answered, column, estimate, figures_of, is_found, outcome_of, words,
};

const POLYPROPYLENE: &str = r#"materials: {
    "polypropylene": (density: "912 kg/m3", law: ConstantQ(modulus: "2.6 GPa", loss_factor: "0.07", at: "1.6 kHz")),
    "steel": (density: "7800 kg/m3", law: Elastic(modulus: "206 GPa")),
},"#;

/// Experiment of paper A: a rod of 400 mm rings down within 30 ms.
const BOTH_ENDS: &str = r#"experiment: EndAccelerations(
    material: "polypropylene", length: "400 mm", diameter: "15.8 mm", accelerometer_mass: "2.9 gram",
    blows: (hits: 10, peak: "100 N", duration: "80 us"),
),"#;

const INSTRUMENT: &str = r#"instrument: (
    sampling_rate: "65.536 kHz", length: "31.25 ms", noise: "0.02 %", converter: (bits: 16),
),"#;

const PROJECTILE: &str = r#"experiment: ImpactedRod(
    length: "402 mm", diameter: "16 mm", density: "912 kg/m3", modulus: "2.6 GPa",
    law: Maxwell(viscosity: "4 MPa s"),
    section_distance: "394 mm",
    striker: (length: "30 mm", diameter: "15.8 mm", density: "2700 kg/m3", modulus: "69 GPa"),
    velocities: ["10 m/s"],
    cell: "2 mm",
),
instrument: (sampling_rate: "51.2 kHz", length: "4 ms", before: "1.25 ms", noise: "0.5 %"),"#;

fn sheet(parts: &[&str]) -> String {
    format!(
        "Simulate(title: \"a \\\"virtual\\\" test\", {})",
        parts.concat()
    )
}

fn refused(text: &str) -> String {
    outcome_of(Path::new("."), text).refused()
}

/// Writes the files into the folder of the plan, and runs the sheet `name` among them.
fn evaluated(
    made: &Outcome,
    folder: &Folder,
    name: &str,
    change: impl Fn(String) -> String,
) -> Outcome {
    folder.keep(made);
    let text = change(folder.read(name));
    let run = folder.run(&text);
    run.unwrap_or_else(|error| unreachable!("{error}\n{text}"))
}

/// The sheet that the plan has written, with further `fields`.
fn with_fields(text: &str, fields: &str) -> String {
    text.replace("\n    ],\n)", &format!("\n    ],\n    {fields},\n)"))
}

fn real(series: &Series) -> &[f64] {
    match &series.ordinate {
        Ordinate::Real(values) => values,
        Ordinate::Complex(_) => unreachable!("a history"),
    }
}

/// Storage modulus \[Pa\] and loss factor of the polypropylene above: a constant loss angle and a
/// power of the frequency.
fn polypropylene(frequency_hz: f64) -> (f64, f64) {
    let angle = 0.07_f64.atan();
    let magnitude = 2.6e9 * (frequency_hz / 1600.0).powf(2.0 * angle / std::f64::consts::PI);
    (magnitude * angle.cos(), 0.07)
}

/// Differences of storage modulus and loss factor from the true values on the valid lines, in
/// standard errors.
fn off_in_standard_errors(found: &Outcome) -> Vec<[f64; 2]> {
    let of = |name: &str| column(found, "modulus", name);
    let validity = words(found, "modulus", "validity");
    let frequency = of("frequency");
    (0..frequency.len())
        .filter(|line| validity[*line] == "valid")
        .map(|line| {
            let (storage, loss) = polypropylene(frequency[line]);
            [
                (1e9 * of("E'")[line] - storage) / (1e9 * of("standard error of E'")[line]),
                (of("loss factor")[line] - loss) / of("standard error of the loss factor")[line],
            ]
        })
        .collect()
}

/// Mean and root mean square of one part of [`off_in_standard_errors`].
fn statistics(off: &[[f64; 2]], part: usize) -> (f64, f64) {
    let n = off.len() as f64;
    let mean = off.iter().map(|o| o[part]).sum::<f64>() / n;
    let square = off.iter().map(|o| o[part] * o[part]).sum::<f64>() / n;
    (mean, square.sqrt())
}

/// Asserts that the modulus agrees with the true one within its errors. For some hundred lines the
/// mean is known to 0.1 and the root mean square to 0.05 of a standard error; neighbouring lines
/// are not quite independent, and errors estimated from ten hits add some per cent.
fn assert_modulus_is_that_of_polypropylene(found: &Outcome, lines: usize) {
    assert_eq!(found.verdict, Verdict::Answered, "{:#?}", found.summary);
    let off = off_in_standard_errors(found);
    assert!(off.len() >= lines, "{} lines are valid", off.len());
    for part in [0, 1] {
        let (mean, rms) = statistics(&off, part);
        let is_right = mean.abs() < 0.3 && (0.8..1.25).contains(&rms);
        assert!(
            is_right,
            "{part}: mean {mean}, rms {rms}, {:#?}",
            found.summary
        );
    }
}

#[test]
fn both_ends_give_the_modulus_that_was_put_in() {
    for (anti_alias, seed) in [
        ("", 3),
        (r#"anti_alias: Butterworth(order: 8, cutoff: "22 kHz"),"#, 4),
    ] {
        let folder = Folder::new();
        let instrument = INSTRUMENT.replace("noise:", &format!("{anti_alias} noise:"));
        let seed = format!("seed: {seed}");
        let text = sheet(&[POLYPROPYLENE, BOTH_ENDS, &instrument, &seed]);
        let made = answered(folder.run(&text));
        assert_eq!(made.warnings, Vec::<String>::new());
        assert_eq!(figures_of(&made), "histories, spectra");
        assert_eq!(made.attachments.len(), 11);
        let names = [0, 9, 10].map(|at: usize| made.attachments[at].name.as_str());
        assert_eq!(names, ["records-01.csv", "records-10.csv", "modulus.ron"]);
        // the table of the truth is that of the closed form
        let of = |name: &str| column(&made, "true-modulus", name).iter();
        for (f, e) in of("frequency").zip(of("storage modulus")) {
            assert!((e / polypropylene(*f).0 - 1.0).abs() < 1e-12, "{f}: {e}");
        }
        let found = evaluated(&made, &folder, "modulus.ron", |text| text);
        assert_modulus_is_that_of_polypropylene(&found, 300);
        // no check gives a false alarm
        let warnings = found.warnings.join("\n");
        assert!(!warnings.contains("fails"), "{warnings}");
    }
}

#[test]
fn gauges_of_a_frame_member_give_the_modulus() {
    let folder = Folder::new();
    let frame = |support: &str| {
        format!(
            r#"experiment: StrainsInFrame(
                material: "polypropylene", length: "800 mm", diameter: "16 mm", gauges: ["200 mm", "400 mm", "600 mm"],
                struck_end: ({support}), other_end: (mass: "100 gram"),
                blows: (hits: 10, peak: "50 N", duration: "100 us"),
            ), output: "gauges.npz","#
        )
    };
    let instrument = INSTRUMENT.replace("31.25 ms", "62.5 ms");
    let of = |support: &str| {
        let text = sheet(&[POLYPROPYLENE, &frame(support), &instrument]);
        folder.run(&text).unwrap()
    };
    let made = of(r#"mass: "15 gram""#);
    assert_eq!(made.warnings, Vec::<String>::new());
    let found = evaluated(&made, &folder, "modulus.ron", |text| text);
    assert_modulus_is_that_of_polypropylene(&found, 120);
    // on a soft spring the member swings for seconds, and the record ends while it still swings
    let warnings = of(r#"stiffness: "70 N/m", mass: "15 gram""#).warnings;
    assert!(
        warnings.len() == 1 && warnings[0].starts_with("the records end while `gauge "),
        "{warnings:?}"
    );
}

#[test]
fn a_hammer_gives_the_mobility_of_a_free_rod() {
    let folder = Folder::new();
    let body = r#"experiment: HammerOnBody(
        body: Chain(elements: [Rod(material: "polypropylene", diameter: "30 mm", length: "200 mm")]),
        blows: (hits: 10, peak: "200 N", duration: "150 us"),
    ), output: "hits.uff","#;
    let text = sheet(&[POLYPROPYLENE, body, INSTRUMENT]);
    let made = folder.run(&text).unwrap();
    let area = 0.25 * std::f64::consts::PI * 0.03_f64.powi(2);
    let mass = &made.quantities[0];
    assert_eq!(mass.name, "mass of the free body");
    assert!((mass.value.unwrap() / (912.0 * area * 0.2) - 1.0).abs() < 1e-12);
    let found = evaluated(&made, &folder, "frf.ron", |text| text);
    assert_eq!(found.verdict, Verdict::Answered, "{:#?}", found.summary);
    let of = |name: &str| column(&found, "response_face", name);
    let (mut squares, mut lines) = (0.0, 0);
    for (line, f) in of("frequency").iter().enumerate() {
        let error = 1e-2 * of("random error of the magnitude")[line];
        // a large error is known only roughly from the coherence of ten hits
        if !(50.0..=12e3).contains(f) || error.is_nan() || error >= 0.1 {
            continue;
        }
        let omega = std::f64::consts::TAU * f;
        let (storage, loss) = polypropylene(*f);
        let speed = (Complex64::new(storage, loss * storage) / 912.0).sqrt();
        // mobility of a free rod: coth(i omega L/c) divided by its impedance
        let exact = 1.0 / ((Complex64::i() * omega * 0.2 / speed).tanh() * 912.0 * area * speed);
        let parts = ["real part of mobility", "imaginary part of mobility"];
        let [re, im] = parts.map(|part| of(part)[line]);
        let measured = Complex64::new(re, im);
        squares += ((measured - exact).norm() / (exact.norm() * error)).powi(2);
        lines += 1;
    }
    assert!(lines > 300, "{lines}");
    // the squared error of the complex value is twice that of the magnitude
    let mean = 0.5 * squares / f64::from(lines);
    assert!((0.7..1.4).contains(&mean), "{mean}");
}

#[test]
fn loads_give_the_dashpot_that_was_put_in() {
    let folder = Folder::new();
    let creep = r#"experiment: CreepRecovery(
        series_modulus: "3.1 GPa", parallel_modulus: "13.1 kPa", exponent: "1.8", coefficient: 4.55e-21,
        virgin_loss_factor: "0.025", frequency: "10 kHz", error: "0.0002",
        loads: [(stress: "45 MPa", duration: "30 min"), (stress: "19 MPa", duration: "30 min")],
        read_at: ["0.5 min", "1 min", "2 min", "5 min", "10 min", "30 min", "60 min"],
    ),"#;
    let made = folder.run(&sheet(&[creep])).unwrap();
    let found = evaluated(&made, &folder, "recovery.ron", |text| text);
    assert_eq!(found.verdict, Verdict::Answered, "{:#?}", found.summary);
    for (name, truth) in [("parallel modulus (E2)", 13.1e3), ("exponent (m)", 1.8)] {
        is_found(&found, name, truth, [3.0, 0.1]);
    }
}

#[test]
fn a_projectile_gives_the_law_that_was_put_in() {
    let quick =
        |text: String| with_fields(&text, "laws: [Maxwell], compare: false, profiles: false");
    for sensors in ["", r#"sensors: Displacement(range: "20 mm"),"#] {
        let folder = Folder::new();
        let noise = if sensors.is_empty() { "0.5 %" } else { "1 um" };
        let text = PROJECTILE
            .replace("velocities:", &format!("{sensors} velocities:"))
            .replace("0.5 %", noise);
        let made = folder.run(&sheet(&[&text])).unwrap();
        let lost = column(&made, "balances", "relative loss of momentum");
        assert!(lost.iter().all(|lost| lost.abs() < 1e-9), "{lost:?}");
        let before = column(&made, "balances", "energy of the striker before")[0];
        let after = column(&made, "balances", "energy at the end")[0];
        let dissipated = column(&made, "balances", "energy dissipated")[0];
        // tolerance: when the gap closes, the contact dissipates the energy of two half cells
        assert!(((after + dissipated) / before - 1.0).abs() < 0.02);
        figures_of(&made).must_say("sections");
        let found = evaluated(&made, &folder, "identify.ron", quick);
        for (name, truth) in [
            ("Maxwell: Young's modulus E", 2.6e9),
            ("Maxwell: viscosity eta", 4e6),
        ] {
            is_found(&found, name, truth, [3.0, 0.2]);
        }
        // records computed by the solver that is to invert them are refused
        let crime =
            |text: String| quick(text).replace("rodwave::lumped", "rodwave::characteristics");
        let refused = folder.run(&crime(folder.read("identify.ron"))).refused();
        refused.must_say("the solver that would invert it");
    }
}

/// A plan for a rod with Norton's law.
fn norton_at_two_velocities() -> String {
    let norton = r#"Norton(exponent: "1.8", rate_at_10_mpa: "20 1/s")"#;
    sheet(&[PROJECTILE])
        .replace(r#"Maxwell(viscosity: "4 MPa s")"#, norton)
        .replace(r#"["10 m/s"]"#, r#"["5 m/s", "20 m/s"]"#)
        .replace(r#"cell: "2 mm","#, r#"cell: "1 mm","#)
}

/// The sheet that evaluates a nonlinear rod states the recorder of the plan, whether the plan
/// states it or not: without it E and exponent would be off by many of their errors.
#[test]
fn the_recorder_of_the_plan_is_part_of_its_evaluation() {
    let folder = Folder::new();
    let made = folder.run(&norton_at_two_velocities()).unwrap();
    assert_eq!(made.warnings, Vec::<String>::new());
    let quick = |text: String| {
        text.must_say("recorder: LinearPhase(cutoff: \"16");
        with_fields(&text, "laws: [Norton], compare: false, profiles: false")
    };
    let found = evaluated(&made, &folder, "identify.ron", quick);
    for (name, truth) in [
        ("Maxwell-Norton: Young's modulus E", 2.6e9),
        ("Maxwell-Norton: exponent kappa", 1.8),
        (
            "Maxwell-Norton: inelastic strain rate at 10 MPa F(10 MPa)",
            20.0,
        ),
    ] {
        is_found(&found, name, truth, [3.0, 0.1]);
    }
}

/// The planned next test, computed and evaluated together with the earlier tests, has the predicted
/// errors within a fifth.
#[test]
fn a_planned_test_tells_as_much_as_was_foretold() {
    let folder = Folder::new();
    let made = folder.run(&norton_at_two_velocities()).unwrap();
    let next = r#"
    next: (
        velocities: ["30 m/s"], repeats: [2], sharpen: "exponent",
        rods: (
            lengths: ["150 mm"], gaps: ["8 mm", "60 mm"], diameter: "16 mm",
            strikers: [
                (length: "30 mm", diameter: "15.8 mm", density: "2700 kg/m3", modulus: "69 GPa"),
                (length: "60 mm", diameter: "15.8 mm", density: "2700 kg/m3", modulus: "69 GPa"),
            ],
        ),
    ), laws: [Norton], compare: false, profiles: false, cell: "4 mm",
)"#;
    let planning = |text: String| format!("{}{next}", text.trim_end().trim_end_matches(')'));
    let planned = evaluated(&made, &folder, "identify.ron", planning);
    let named = |name: &str| column(&planned, "next_tests", name).to_vec();
    let kappa = named("standard error of exponent");
    // rows: no further test, and tests with two sections and two strikers; a further test never
    // increases the error, and the best one is first
    assert_eq!(kappa.len(), 5, "{:#?}", planned.summary);
    assert!(kappa[1..].iter().all(|then| *then < kappa[0]), "{kappa:?}");
    assert!(kappa[1..].is_sorted(), "{kappa:?}");
    let best = &words(&planned, "next_tests", "planned test")[1];
    assert!(
        best.starts_with("2 x 150 mm, section ") && best.ends_with(", 30 m/s"),
        "{best}"
    );
    planned
        .summary
        .must_begin(&format!("Of the 4 planned tests, the test `{best}` "));

    let plan = planned.attachments.iter().find(|a| a.name == "next.ron");
    let plan = String::from_utf8(plan.unwrap().bytes.clone()).unwrap();
    fs::create_dir(folder.file("next")).unwrap();
    for file in folder.run(&plan).unwrap().attachments {
        folder.write(Path::new("next").join(file.name), file.bytes);
    }
    let tests_of = |text: &str| -> String {
        let begin = text.find("tests: [").unwrap() + "tests: [".len();
        text[begin..text.rfind("],").unwrap()].to_owned()
    };
    let section = folder.read("next/identify.ron");
    let more = tests_of(&section).replace("files: [\"", "files: [\"next/");
    let length = named("impact velocity")[1];
    assert!(length > 0.0);
    // the rod of the planned test, in its own entry
    let (_, own) = section.split_once("specimen: (").unwrap();
    let (own, _) = own.split_once("),").unwrap();
    let more = more.replace("records: (", &format!("specimen: ({own}), records: ("));
    let together = |text: String| {
        let at = text.rfind("],").unwrap();
        let (before, after) = text.split_at(at);
        let after = after.trim_end().trim_end_matches(')');
        format!("{before}{more}{after}    laws: [Norton], compare: false, profiles: false,\n)")
    };
    let all = evaluated(&made, &folder, "identify.ron", together);
    let (_, error) = estimate(&all, "Maxwell-Norton: exponent kappa");
    let ratio = error / kappa[1];
    assert!((ratio - 1.0).abs() < 0.2, "{ratio} {kappa:?}");
}

/// The sheet of a virtual test of a rod with this law, recorded through a filter.
fn through_a_recorder(law: &str, velocities: &str) -> String {
    sheet(&[PROJECTILE])
        .replace(r#"law: Maxwell(viscosity: "4 MPa s"),"#, law)
        .replace(r#"["10 m/s"]"#, velocities)
        .replace(r#"cell: "2 mm","#, r#"cell: "1 mm","#)
        .replace(
            r#"noise: "0.5 %""#,
            r#"anti_alias: Butterworth(order: 8, cutoff: "17 kHz"), noise: "0.5 %""#,
        )
}

/// Eyring's law, if the sheet names it, is compared with the standard laws and identified.
#[test]
fn a_rod_of_eyring_is_found_again() {
    let folder = Folder::new();
    let text = through_a_recorder(
        r#"law: Eyring(activation_stress: "3 MPa", rate_at_10_mpa: "30 1/s"),"#,
        r#"["3 m/s", "10 m/s"]"#,
    );
    let made = folder.run(&text).unwrap();
    let found = evaluated(&made, &folder, "identify.ron", |text| {
        with_fields(&text, "laws: [Eyring], profiles: false")
    });
    found.summary[0].must_say("Maxwell-Eyring");
    for (name, truth) in [
        ("Young's modulus E", 2.6e9),
        ("activation stress sigma*", 3e6),
        ("inelastic strain rate at 10 MPa F(10 MPa)", 30.0),
    ] {
        let name = format!("Maxwell-Eyring: {name}");
        is_found(&found, &name, truth, [3.0, 0.1]);
    }
}

/// A spring in parallel with a Norton branch is identified from records with the filter of the
/// plan.
#[test]
fn a_spring_beside_the_law_is_found_again() {
    let folder = Folder::new();
    let text = through_a_recorder(
        r#"law: Norton(exponent: "2", rate_at_10_mpa: "60 1/s"), spring: "0.5","#,
        r#"["3 m/s", "27 m/s"]"#,
    );
    let made = folder.run(&text).unwrap();
    let only = "laws: [ZenerNorton], compare: false, profiles: false";
    let found = evaluated(&made, &folder, "identify.ron", |text| {
        with_fields(&text, only)
    });
    for (name, truth) in [
        ("Young's modulus E", 2.6e9),
        ("share of the spring in the modulus w_0", 0.5),
        ("exponent kappa", 2.0),
        ("inelastic strain rate at 10 MPa F(10 MPa)", 60.0),
    ] {
        is_found(&found, &format!("Zener-Norton: {name}"), truth, [3.0, 0.2]);
    }
    let wrong = refused(&text.replace(r#"spring: "0.5""#, r#"spring: "1""#));
    wrong.must_say("share of a spring in the modulus is 1, expected between 0 and 1");
}

#[test]
fn the_seed_and_nothing_else_decides() {
    let of = |more: &str| {
        let few = BOTH_ENDS.replace("hits: 10", "hits: 2");
        let text = sheet(&[POLYPROPYLENE, &few, INSTRUMENT, more]);
        outcome_of(Path::new("."), &text).unwrap()
    };
    let (first, again, other) = (of(""), of("seed: 1"), of("seed: 2"));
    assert_eq!(first.attachments, again.attachments);
    assert_eq!(first.figures, again.figures);
    // values that are not stated are reported as defaults
    let by_default = |outcome: &Outcome| -> Vec<String> {
        let settings = outcome.settings.iter().filter(|s| s.by_default);
        let words = settings.map(|s| format!("{}: {}", s.name, s.value));
        words.collect()
    };
    assert_eq!(
        by_default(&first),
        [
            "experiment.blows.shape: RaisedCosine",
            "experiment.blows.scatter: 5 %",
            "output: records.csv",
            "seed: 1",
            "instrument.before: 2 ms",
            "instrument.anti_alias: linear phase, half amplitude at 20480 Hz",
            "instrument.converter.full_scale: 125 %",
        ]
    );
    assert_ne!(first.attachments[0].bytes, other.attachments[0].bytes);
    // every format contains the same numbers
    let samples = |outcome: &Outcome| -> Vec<Vec<f64>> {
        let contents = labio::format::read_bytes(&outcome.attachments[1].bytes).unwrap();
        let series = contents.series.iter();
        series.map(|series| real(series).to_vec()).collect()
    };
    for format in ["npy", "npz", "uff", "wav"] {
        let made = of(&format!(r#"output: "one.{format}""#));
        assert_eq!(made.attachments[1].name, format!("one-2.{format}"));
        assert!(samples(&made) == samples(&first), "{format}");
        // the sheet states what files of this format do not contain
        let folder = Folder::new();
        let found = evaluated(&made, &folder, "modulus.ron", |text| text);
        assert_eq!(found.inputs.len(), 2, "{format}");
    }
}

#[test]
fn what_is_wrong_with_a_plan_is_said() {
    let ends =
        |from: &str, to: &str| sheet(&[POLYPROPYLENE, BOTH_ENDS, INSTRUMENT]).replace(from, to);
    let struck = |from: &str, to: &str| sheet(&[PROJECTILE]).replace(from, to);
    let errors = [
        sheet(&[POLYPROPYLENE, BOTH_ENDS]),
        ends(r#"material: "polypropylene""#, r#"material: "nylon""#),
        ends(
            r#"ConstantQ(modulus: "2.6 GPa", loss_factor: "0.07", at: "1.6 kHz")"#,
            "PowerLawPropagation(damping_factor: 1e-3, damping_exponent: 0.9, wave_number_factor: 4e-3, wave_number_exponent: 0.97)",
        ),
        ends("31.25 ms", "2 ms"),
        ends("noise:", r#"before: "0.1 ms", noise:"#),
        ends("noise:", r#"anti_alias: LinearPhase(cutoff: "40 kHz"), noise:"#),
        ends("0.02 %", "1 N"),
        ends("noise:", r#"noise_of: {"end": "1 %"}, noise:"#),
        ends("hits: 10", "hits: 0"),
        ends("bits: 16", "bits: 40"),
        ends("instrument:", r#"output: "hits.xlsx", instrument:"#),
        struck(r#"["10 m/s"]"#, "[]"),
        struck("394 mm", "500 mm"),
        struck("4 MPa s", "4 MPa"),
    ]
    .map(|text| refused(&text).lines().next().unwrap_or_default().to_owned());
    insta::assert_snapshot!(errors.join("\n"), @r#"
    instrument is missing, expected at least its fields `sampling_rate` and `length`: this experiment is recorded
    experiment: EndAccelerations.material is `nylon`, expected one of the materials `polypropylene`, `steel`
    experiment: EndAccelerations.material is `polypropylene`, whose law is known for real frequencies only, expected a material with a causal law, because a history is computed
    instrument.length is 2 ms, expected more than `before`, 0.002 s, and 40 samples
    instrument.before is 7 samples, expected 40 to 2097152
    instrument.anti_alias.cutoff is 40000 Hz, expected below half the sampling rate, 32768 Hz
    instrument.noise is `1 N`, expected a part of the largest value in % or a level of `struck end`, which is acceleration [m/s^2]
    instrument.noise_of is `end`, expected one of the channels `struck end`, `free end`
    experiment: EndAccelerations.blows.hits is 0, expected 1 to 999
    instrument.converter: bits of the converter is 40, expected a number from 1 to 32
    output is `hits.xlsx`, expected the name of a file in the folder of the result with one of the extensions csv, npy, npz, uff, wav
    experiment: ImpactedRod.velocities is empty, expected at least one velocity
    experiment: ImpactedRod.section_distance is 500 mm, expected at most the length of the rod, 402 mm
    test.ron:3:29: Simulate.experiment.ImpactedRod.law.Maxwell.viscosity: `4 MPa` has the dimension of a modulus or stress (m^-1 kg s^-2), expected a viscosity, such as "20 kPa s"
    "#);
}

#[test]
fn a_converter_that_is_too_small_is_said() {
    let text = sheet(&[POLYPROPYLENE, BOTH_ENDS, INSTRUMENT])
        .replace("bits: 16", r#"bits: 16, full_scale: "90 %""#);
    let made = outcome_of(Path::new("."), &text).unwrap();
    made.warnings.must_say("beyond the range of the converter");
    assert!(made.log.iter().any(|entry| !entry.accepted));
}
