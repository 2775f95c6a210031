//! The program as a user calls it: its messages, its files and its exit status.

use std::fs;
use std::process::Command;

use labio::Ordinate;
use labio::format::workbook::Xlsx;
use labio::format::{Reader, Strictness};

use crate::runs::{Folder, Words, text};

/// Status and text of the standard error.
fn refused(folder: &Folder, call: &str) -> String {
    let output = folder.rodlab(call);
    assert_eq!(text(&output.stdout), "");
    format!(
        "status {}\n{}",
        output.status.code().unwrap(),
        text(&output.stderr)
    )
}

fn folder_with(files: &[(&str, &str)]) -> Folder {
    let folder = Folder::new();
    for (name, contents) in files {
        let path = folder.file(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, contents).unwrap();
    }
    folder
}

#[test]
fn a_misspelt_field_is_shown_with_the_nearest_name() {
    let folder = folder_with(&[("rod.ron", "// a rod\nModulus(\n    titel: \"a rod\",\n)\n")]);
    let said = refused(&folder, "modulus rod.ron");
    said.must_begin("status 2\n");
    said.must_say_all(&[
        "rod.ron:3:5: Modulus.titel: there is no field `titel`",
        "3 │     titel: \"a rod\",",
        "did you mean `title`?",
    ]);
}

#[test]
fn a_sheet_of_another_job_names_its_command() {
    let folder = folder_with(&[("hit.ron", FORCE)]);
    insta::assert_snapshot!(
        refused(&folder, "frf hit.ron"),
        @r"
    status 2
    error: hit.ron is a sheet for `force`, expected one for `frf`: run `rodlab force` on it
    "
    );
}

#[test]
fn a_sheet_that_is_not_there_is_named() {
    let folder = folder_with(&[]);
    let said = refused(&folder, "modulus rod.ron");
    said.must_begin("status 2\nerror: cannot read rod.ron: ");
}

#[test]
fn init_replaces_nothing() {
    let folder = folder_with(&[]);
    folder.done("init force");
    let written = folder.read("force.toml");
    written.must_begin("#");
    refused(&folder, "init force").must_begin("status 2\nerror: cannot write force.toml: ");
    assert_eq!(folder.read("force.toml"), written);
}

#[test]
fn a_demonstration_shows_its_commands_and_finds_the_material_of_its_plan() {
    let folder = folder_with(&[]);
    let shown = text(&folder.rodlab("demo first").stdout);
    for command in [
        "> rodlab init simulate",
        "> rodlab simulate",
        "> rodlab modulus",
    ] {
        shown.must_say(command);
    }
    let report = shown.lines().last().unwrap();
    let report = report.strip_prefix("The report: ").unwrap();
    assert!(folder.file(report).is_file(), "{report}");
    // the loss factor of the plan is 0.07 at 1.6 kHz and nearly constant
    let json = folder.rodlab("demo second --json").stdout;
    let result: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(result["job"], "modulus");
    assert_eq!(result["verdict"]["answer"], "answered");
    assert_eq!(result["warnings"], serde_json::json!([]));
    let sentence = result["summary"][0].as_str().unwrap();
    sentence.must_say("loss factor 0.0");
    // an existing folder is not replaced
    let said = refused(&folder, "demo first");
    said.must_begin("status 2\nerror: the folder of the demo is first, ");
    said.must_say("`rodlab demo first-2`");
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let folder = folder_with(&[]);
    let completions = folder.rodlab("completions bash");
    text(&completions.stdout).must_say("identify");
    folder.done("man pages");
    folder.read("pages/rodlab-batch.1").must_say("resume");
    let help = text(&folder.rodlab("--help").stdout);
    for line in help
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
    {
        let name = line.split_whitespace().next().unwrap();
        if name.chars().all(|letter| letter.is_ascii_lowercase())
            && !["help", "rodlab"].contains(&name)
        {
            assert!(folder.has(format!("pages/rodlab-{name}.1")), "{name}");
        }
    }
}

#[cfg(unix)]
#[test]
fn an_output_that_takes_nothing_is_said() {
    let folder = folder_with(&[]);
    let completions = Command::new("sh")
        .arg("-c")
        .arg(format!(
            "{} completions bash > /dev/full",
            env!("CARGO_BIN_EXE_rodlab")
        ))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(completions.status.code(), Some(2));
    text(&completions.stderr).must_begin("error: cannot write the standard output: ");
}

/// A mass that strikes a long rod.
const FORCE: &str = r#"Force(title: "mass", problem: Impact(first: RigidMass("0.5 kg"), second: Impedance("1000 kg/s"),
    velocity: "2 m/s ± 1 %", duration: "4 ms", time_step: "10 us"))"#;

#[test]
fn a_result_is_said_in_words_and_lies_beside_the_sheet() {
    let folder = folder_with(&[("hit.ron", FORCE)]);
    folder
        .done("force hit.ron")
        .must_begin("In the band up to 10 kHz the peak force is (1.8");
    let result = folder.file("hit-result");
    let mut names: Vec<String> = fs::read_dir(&result)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".csv") || name.ends_with(".json"))
        .collect();
    names.sort();
    let expected = "contacts.csv force.csv force_in_band.csv result.json";
    assert_eq!(names.join(" "), expected);
    let table = fs::read_to_string(result.join("force.csv")).unwrap();
    let mut lines = table.lines();
    let head = lines.next().unwrap();
    head.must_begin("time_s,force_n,standard_error_force_n,");
    let first = lines.next().unwrap();
    assert!(
        first
            .split(',')
            .take(2)
            .all(|cell| cell.parse::<f64>().is_ok()),
        "numbers from the second row on: {first}"
    );
    folder.done("force hit.ron --unit-row");
    let with_units = fs::read_to_string(result.join("force.csv")).unwrap();
    let units = with_units.lines().nth(1).unwrap();
    units.must_begin("s,N,N,m/s,m/s,m");
    assert_eq!(with_units.replacen(&format!("{units}\n"), "", 1), table);

    folder.done("force hit.ron --workbook");
    let bytes = fs::read(result.join("tables.xlsx")).unwrap();
    let sheets = Xlsx.read(&bytes, Strictness::Tolerant).unwrap();
    let column = sheets.series.iter();
    let mut column = column.filter(|series| series.name == "force_in_band/force_in_band_n");
    let Some(Ordinate::Real(values)) = column.next().map(|series| &series.ordinate) else {
        panic!("{:?}", sheets.series);
    };
    let table = fs::read_to_string(result.join("force_in_band.csv")).unwrap();
    let of_csv = table.lines().skip(1);
    let of_csv = of_csv.map(|row| row.split(',').nth(1).unwrap().parse::<f64>().unwrap());
    assert_eq!(values, &of_csv.collect::<Vec<f64>>());
}

#[test]
fn json_is_the_result_and_nothing_else() {
    let folder = folder_with(&[("hit.ron", FORCE)]);
    let run = folder.rodlab("force hit.ron --json --out here");
    let printed = text(&run.stdout);
    assert_eq!(printed, folder.read("here/result.json"));
    let result: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(result["result_version"], 3);
    assert_eq!(result["sheet"]["file"], "hit.ron");
    assert_eq!(result["quantities"][0]["name"], "peak force");
    assert_eq!(result["verdict"]["answer"], "answered");
    let quiet = folder.rodlab("force hit.ron --quiet");
    assert_eq!(text(&quiet.stdout), "");
}

#[test]
fn data_that_do_not_allow_the_result_end_with_status_1_and_a_reason() {
    let stiff = FORCE.replace("time_step", "contact: Linear(\"1 TN/m\"), time_step");
    let folder = folder_with(&[("hit.ron", stiff.as_str())]);
    let run = folder.rodlab("force hit.ron");
    assert_eq!(run.status.code(), Some(1));
    text(&run.stderr).must_begin("not allowed: the time step is too long for the contact");
    // the partial results are written
    assert!(folder.has("hit-result/result.json"));
}

#[test]
fn check_reads_everything_and_computes_nothing() {
    let folder = folder_with(&[
        ("good.ron", FORCE),
        ("bad.ron", "Force(title: 1)"),
        ("worse.ron", "Force("),
    ]);
    let run = folder.rodlab("check good.ron bad.ron worse.ron");
    assert_eq!(run.status.code(), Some(2));
    text(&run.stdout).must_begin("good.ron: a sheet for `force`, its files can be read (");
    let said = text(&run.stderr);
    said.must_say("bad.ron:1:14: Force.title");
    said.must_say("worse.ron:1:");
    assert!(!folder.has("good-result"));
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_is_named() {
    // a file has the name of the folder: an error even for a user with all permissions
    let folder = folder_with(&[("hit.ron", FORCE), ("taken", "")]);
    let said = refused(&folder, "force hit.ron --out taken");
    said.must_begin("status 2\nerror: cannot write taken: it is a file, expected a folder");
    assert_eq!(folder.read("taken"), "");
}

#[test]
fn a_recording_is_inspected_and_converted() {
    let folder = folder_with(&[(
        "hit.csv",
        "Time (s);force (N)\n0;1\n0.001;2\n0.002;-1\n0.003;0.5\n",
    )]);
    let said = folder.done("inspect hit.csv");
    said.must_say_all(&["force", "1 kHz"]);
    let json = folder.rodlab("inspect hit.csv --json");
    assert!(serde_json::from_slice::<serde_json::Value>(&json.stdout).is_ok());

    folder.done("convert hit.csv hit.uff --binary");
    text(&folder.rodlab("inspect hit.uff").stdout).must_say_all(&["force", "1 kHz"]);
    refused(&folder, "convert hit.csv hit.xyz").must_begin("status 2\nerror: ");
    assert!(!folder.has("hit.xyz"));
    let said = refused(&folder, "inspect nothing.csv");
    said.must_begin("status 2\nerror: cannot read nothing.csv");
    folder.write("hit.ron", FORCE);
    refused(&folder, "inspect hit.ron").must_begin(
        "status 2\nerror: hit.ron is a test sheet, expected a recording: `rodlab check hit.ron`",
    );
    let said = refused(&folder, "init");
    said.must_begin("status 2\nerror: the job of the new sheet is not stated, expected one of `frf`, `modulus`, ");
    // the rig determines the job
    folder.done("init --rig dma");
    folder.read("fit.toml").must_say("job = \"fit\"");
}

/// The first channel has its unit from the file; the second has none, so that the command is
/// refused.
#[test]
fn a_refused_command_without_a_sheet_leaves_no_sheet_and_the_earlier_result() {
    let folder = folder_with(&[
        ("hit.ron", FORCE),
        (
            "hit.csv",
            "Time (s);force (N);b\n0;1;0\n0.001;2;1\n0.002;-1;0\n0.003;0.5;0\n",
        ),
    ]);
    folder.done("force hit.ron --out results");
    let result = folder.file("results/result.json");
    let earlier = fs::read(&result).unwrap();
    let call = "frf hit.csv --input 1 --output 2";
    refused(&folder, &format!("{call} --out results")).must_say_all(&[
        "frf.toml, the sheet of this command, was removed",
        "the result in results is an earlier one",
        "error: the unit in `--output 2:UNIT` is not stated",
    ]);
    assert!(!folder.has("frf.toml"));
    assert_eq!(fs::read(&result).unwrap(), earlier);
    // a sheet saved by `--save` is not removed, nor is one that existed before the command
    refused(&folder, &format!("{call} --save frf.toml"));
    refused(&folder, call);
    assert!(folder.file("frf.toml").is_file());
}

/// In the records, force and response differ from 0 in one sample each.
#[test]
fn a_unit_against_that_of_the_file_is_found_by_check_and_a_written_sheet_is_named() {
    let samples = (0..64).map(|n| {
        let force = if n == 20 { 5 } else { 0 };
        let motion = if n == 21 { 3 } else { 0 };
        format!("0.{n:03};{force};{motion}\n")
    });
    let record = format!(
        "Time (s);force (N);b (m/s^2)\n{}",
        samples.collect::<String>()
    );
    let sheet = r#"Frf(title: "a", input: "hammer", records: (files: ["hit.csv"], channels: [
        (name: "hammer", from: 1, unit: "V", sensitivity: "2 mV/N"), (name: "b", from: 2)]))"#;
    let folder = folder_with(&[("hit.csv", &record), ("frf.ron", sheet)]);
    folder.done("check frf.ron").must_say(
        "warning: hit.csv states channel 1 in N; the unit of the sheet is used instead, V.",
    );
    let run = folder.rodlab("frf hit.csv --input 1 --output 2");
    text(&run.stdout).must_say("The sheet is frf.toml: edit it and run `rodlab frf frf.toml`");
    assert!(folder.file("frf.toml").is_file());
}

#[test]
fn a_sheet_whose_files_are_missing_is_found_by_check() {
    // every template names recordings that do not exist, except those of virtual tests and of two
    // computed bodies
    let folder = folder_with(&[]);
    for job in ["frf", "modulus", "identify"] {
        folder.done(&format!("init {job}"));
        let said = refused(&folder, &format!("check {job}.toml"));
        assert!(
            said.starts_with("status 2\nerror: no file matches `"),
            "{job}: {said}"
        );
    }
    for job in ["simulate", "force"] {
        folder.done(&format!("init {job}"));
        folder.done(&format!("check {job}.toml"));
        assert!(!folder.has(format!("{job}-result")));
    }
}
