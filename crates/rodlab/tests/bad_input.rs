//! Messages of the program, word for word, and its exit status for an example in which one thing is
//! wrong.

use std::fs;

use crate::runs::{Folder, path_of_example, rodlab, text as text_of};

/// Runs the polypropylene example with its sheet changed by `change`; returns status and messages.
fn said_of(change: impl Fn(&str) -> String) -> String {
    let folder = Folder::of_example("polypropylene");
    let sheet = folder.file("modulus.ron");
    let text = fs::read_to_string(&sheet).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed, "the change found nothing to change");
    fs::write(&sheet, changed).unwrap();
    let run = folder.rodlab("modulus modulus.ron --quiet");
    assert_eq!(text_of(&run.stdout), "");
    let done = folder.has("modulus-result/result.json");
    // with status 2 there is no result, with status 1 there is a partial one
    assert_eq!(done, run.status.code() == Some(1));
    let here = folder.path().canonicalize().unwrap();
    let words = text_of(&run.stderr);
    let words = words.replace(&here.display().to_string(), "FOLDER");
    let lines: Vec<&str> = words.lines().map(str::trim_end).collect();
    format!(
        "status {}\n{}",
        run.status.code().unwrap(),
        lines.join("\n")
    )
}

#[test]
fn a_missing_file() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replace("hits-*.npy", "hit-*.npy")), @r"
    status 2
    error: no file matches `hit-*.npy` in the folder of the sheet, FOLDER (source.hits.records.files): the folder has hits-1.npy and 4 more
    ");
}

/// The records last 31.25 ms at 65.536 kHz and begin with 1.6 ms of silence.
#[test]
fn a_sampling_rate_in_a_wrong_unit() {
    let with = |rate: &str| said_of(|sheet| sheet.replace("65.536 kHz", rate));
    insta::assert_snapshot!(with("65.536 Hz"), @r"
    status 2
    error: band.to is `15 kHz`, expected at most 32.77 Hz, half the sampling rate of 65.536 Hz: did you mean 65.536 kHz?
    ");
    insta::assert_snapshot!(with("65.536 MHz"), @r"
    status 2
    error: source.hits.silent is `1.6 ms`, expected the time from the beginning of a record to the impact; a record is only 0.0312 ms long; is the sampling rate of 65.536 MHz right?
    ");
}

#[test]
fn a_wrong_unit() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replace("799 mm ± 0.3 mm", "799 kg")), @r#"
    status 2
      × modulus.ron:7:17: Modulus.specimen.length: `799 kg` has the dimension of a
      │ mass (kg), expected a length, such as "800 mm", with or without ±
       ╭─[modulus.ron:7:17]
     6 │     specimen: (
     7 │         length: "799 kg",
       ·                 ────┬───
       ·                     ╰── here
     8 │         diameter: "15.8 mm ± 0.03 mm",
       ╰────
    "#);
}

#[test]
fn a_unit_that_is_no_unit() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replacen("m/s2", "m/sec^", 1)), @r"
    status 2
    error: source.hits.records.channels[0].unit: `m/sec^` is not a known unit: `` occurs where an exponent is expected
    ");
}

#[test]
fn a_channel_of_another_quantity() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replacen("unit: \"m/s2\"", "unit: \"N\"", 1)), @r"
    status 2
    error: method.two_point.impacted_end is `struck end`, a channel of force, expected a channel of acceleration, velocity or displacement
    ");
}

#[test]
fn a_channel_that_no_file_has() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replace("from: 2", "from: 5")), @r"
    status 2
    error: source.hits.records.channels[1].from is channel 5, expected a number from 1 to 2 (hits-1.npy)
    ");
}

#[test]
fn a_role_for_a_channel_that_is_not_there() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replace("free_end: \"free end\"", "free_end: \"far end\"")), @r"
    status 2
    error: method.two_point.free_end is `far end`, expected one of the channels `struck end`, `free end`
    ");
}

#[test]
fn a_sampling_rate_that_nobody_tells() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replace("sampling_rate: \"65.536 kHz\",", "")), @r#"
    status 2
    error: source.hits.records.sampling_rate is not stated, expected the sampling rate, such as "51.2 kHz": hits-1.npy does not state it
    "#);
}

#[test]
fn values_that_only_a_slip_of_the_unit_explains() {
    let said = [
        said_of(|sheet| sheet.replace("2.9 gram ± 0.03 gram", "2.9 kg ± 0.03 kg")),
        said_of(|sheet| sheet.replace("to: \"15 kHz\"", "to: \"40 kHz\"")),
        said_of(|sheet| {
            let limits = "    limits: (loss_factor: \"20\"),\n    method:";
            sheet.replacen("    method:", limits, 1)
        }),
    ];
    insta::assert_snapshot!(said.join("\n"), @r#"
    status 2
    error: specimen.accelerometer_mass is `2.9 kg ± 0.03 kg`, 2900 g, more than the specimen, 142.9 g, expected less: gram is the usual unit
    status 2
    error: band.to is `40 kHz`, expected at most 32.77 kHz, half the sampling rate
    status 2
    error: limits.loss_factor is `20`, 2000 %, expected at most 2 without a unit: did you mean "20 %"?
    "#);
}

#[test]
fn a_field_that_is_missing() {
    insta::assert_snapshot!(said_of(|sheet| sheet.replace("density: \"912 kg/m3 ± 0.3 kg/m3\",", "")), @r#"
    status 2
      × modulus.ron:11:5: Modulus.specimen: the field `density` is missing
        ╭─[modulus.ron:11:5]
     10 │         accelerometer_mass: "2.9 gram ± 0.03 gram",
     11 │     ),
        ·     ┬
        ·     ╰── here
     12 │     method: TwoPoint(impacted_end: "struck end", free_end: "free end"),
        ╰────
      help: add `density: ...,` inside these brackets
    "#);
}

#[test]
fn too_few_hits() {
    let reject = |sheet: &str| {
        let hits: String = (1..=4)
            .map(|hit| format!("(hit: {hit}, because: \"the rod slipped\"), "))
            .collect();
        sheet.replace(
            "silent: \"1.6 ms\",",
            &format!("hits: (reject: [{hits}]), silent: \"1.6 ms\","),
        )
    };
    insta::assert_snapshot!(said_of(reject), @r"
    status 1
    not allowed: none of 465 lines is valid: error of E' above its limit (465 lines), error of the loss factor above its limit (465 lines), wavelength above five lengths (9 lines)
    ");
}

/// Returns the message about the sheet `text` of the job `job`. Fails if it takes 30 s or more.
fn said_at_once(job: &str, text: &str) -> String {
    let folder = Folder::new();
    folder.write("sheet.ron", text);
    let began = std::time::Instant::now();
    let run = rodlab(folder.path(), &[job, "sheet.ron", "--quiet"]);
    // if the sheet were not refused, its computation would take minutes
    assert!(began.elapsed().as_secs() < 30, "{:?}", began.elapsed());
    assert_eq!(run.status.code(), Some(2));
    assert!(!folder.has("sheet-result"));
    text_of(&run.stderr)
}

fn of_ends(modulus: &str, hits: &str, length: &str) -> String {
    format!(
        r#"Simulate(title: "t", materials: {{"m": (density: "900 kg/m3", law: Elastic(modulus: "{modulus}"))}},
        experiment: EndAccelerations(material: "m", length: "1 m", diameter: "10 mm",
            blows: (hits: {hits}, peak: "100 N", duration: "80 us")),
        instrument: (sampling_rate: "40 kHz", length: "{length}"), output: "hits.npy")"#
    )
}

fn of_rod(velocity: &str, cell: &str, modulus: &str) -> String {
    format!(
        r#"Simulate(title: "t", experiment: ImpactedRod(length: "1 m", diameter: "10 mm", density: "1000 kg/m3",
            modulus: "{modulus}", law: Elastic, section_distance: "0.9 m", velocities: ["2 m/s", "{velocity}"], cell: "{cell}",
            striker: (length: "30 mm", diameter: "10 mm", density: "2700 kg/m3", modulus: "69 GPa")),
        instrument: (sampling_rate: "100 kHz", length: "5 ms"), output: "shots.csv")"#
    )
}

fn of_bodies(elements: usize, step: &str) -> String {
    let cone = r#"Cone(material: "m", near: "75 mm", far: "30 mm", length: "400 mm"), "#;
    format!(
        r#"Force(title: "t", materials: {{"m": (density: "900 kg/m3", law: Elastic(modulus: "2 GPa"))}},
        problem: Impact(first: Chain(elements: [{}]), second: LongRod(material: "m", diameter: "10 mm"),
            velocity: "1 m/s", duration: "4 ms", time_step: "{step}"))"#,
        cone.repeat(elements)
    )
}

fn of_duration(duration: &str) -> String {
    of_bodies(1, "1 us")
        .replace("4 ms", duration)
        .replace(r#", time_step: "1 us""#, "")
}

#[test]
fn r20_what_is_absurd_is_refused_with_its_numbers() {
    let said = [
        said_at_once("simulate", &of_ends("1 mPa", "2", "100 ms")),
        said_at_once("simulate", &of_ends("1e20 GPa", "2", "100 ms")),
        said_at_once("simulate", &of_ends("2 GPa", "999", "9 s")),
        said_at_once("simulate", &of_ends("2 GPa", "2", "1000 s")),
        said_at_once("simulate", &of_rod("1e9 m/s", "1 mm", "2 GPa")),
        said_at_once("simulate", &of_rod("3 m/s", "1 um", "2 GPa")),
        said_at_once("simulate", &of_rod("3 m/s", "1 mm", "2 mPa")),
        said_at_once("force", &of_bodies(3000, "1 us")),
        said_at_once("force", &of_bodies(1, "1 ns")),
        said_at_once("force", &of_duration("4 s")),
        said_at_once("force", &of_duration("4 us")),
    ];
    insta::assert_snapshot!(said.concat(), @r"
    error: materials: m is a material whose modulus and density give a wave speed of 1.054e-3 m/s, expected 20 to 20000 m/s, or `unusual` as true next to the density if this wave speed is intended
    error: materials: m is a material whose modulus and density give a wave speed of 1.054e13 m/s, expected 20 to 20000 m/s, or `unusual` as true next to the density if this wave speed is intended
    error: instrument.length is 719280000 samples of all hits, expected at most 50000000 samples of all hits
    error: instrument.length is 40000000 samples, expected 40 to 2097152
    error: experiment: ImpactedRod.velocities[1] is 1e9 m/s, expected less than the wave speed of the rod, 1414.2136 m/s
    error: experiment: ImpactedRod is 9390378054157 cells times steps of all velocities, expected at most 4000000000 cells times steps of all velocities
    error: experiment: ImpactedRod is a material whose modulus and density give a wave speed of 1.414e-3 m/s, expected 20 to 20000 m/s, or `unusual` as true next to the density if this wave speed is intended
    error: problem.first.elements is 3000 elements, expected at most 200 elements
    error: problem.time_step is 4000000 steps, expected at most 1000000 steps
    error: problem.duration is `4 s`, expected at most 3.125 s with a band up to 10 kHz
    error: problem.duration is `4 us`, expected more than 0.13 ms with a band up to 10 kHz
    ");
}

#[test]
fn r20_an_unusual_material_is_taken_if_the_sheet_says_so() {
    let slow = of_ends("100 kPa", "1", "100 ms");
    assert!(said_at_once("simulate", &slow).contains("`unusual` as true"));
    let meant = slow.replace(
        "density: \"900 kg/m3\"",
        "density: \"900 kg/m3\", unusual: true",
    );
    let folder = Folder::new();
    folder.write("sheet.ron", meant);
    folder.done("check sheet.ron");
}

#[test]
fn r20_a_recording_given_for_a_sheet_is_named() {
    let example = path_of_example("frame");
    let run = |arguments: &[&str]| {
        let run = rodlab(&example, arguments);
        assert_eq!(run.status.code(), Some(2));
        text_of(&run.stderr)
    };
    insta::assert_snapshot!(run(&["modulus", "strains-1.npy"]), @"error: strains-1.npy is a file of data (NPY), expected a test sheet, or `--impacted` and `--free` with the channels of both ends of a rod; `rodlab init modulus` writes a sheet");
    assert!(run(&["check", "strains-1.npy"]).contains("is a file of data (NPY)"));
    assert!(!example.join("strains-1-result").exists());
}
