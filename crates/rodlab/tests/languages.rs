//! The same sheets in TOML, RON and JSON, and messages that list all mistakes of a sheet.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use rodlab::Outcome;
use rodlab::job::{self, Sheet, Silent};
use rodlab::sheet::{self, Language};
use rodlab::templates::JobName;

use crate::runs::{Folder, Words, path_of_example, text};

/// Paths of the sheets of the examples in RON.
fn examples() -> Vec<PathBuf> {
    let pattern = path_of_example("*/*.ron");
    let found = glob::glob(pattern.to_str().unwrap()).unwrap();
    let found: Vec<PathBuf> = found.map(Result::unwrap).collect();
    assert!(found.len() >= 12, "{} examples", found.len());
    found
}

/// All fields of a sheet as text, quantities as they are written.
fn fields(text: &str) -> String {
    let read = job::parse(Path::new("sheet"), text);
    let read = read.unwrap_or_else(|error| panic!("{error}\n{text}"));
    format!("{read:#?}")
}

#[test]
fn examples_and_templates_are_the_same_sheets_in_toml() {
    let templates = JobName::ALL.map(|job| job.template(Language::Ron).to_owned());
    let examples = examples();
    let examples = examples
        .iter()
        .map(|path| fs::read_to_string(path).unwrap());
    for text in examples.chain(templates) {
        let toml = sheet::in_toml(Path::new("sheet"), &text).unwrap();
        assert_eq!(Language::of(&toml), Some(Language::Toml), "{toml}");
        assert_eq!(fields(&toml), fields(&text));
    }
}

#[test]
fn the_example_in_toml_is_that_in_ron() {
    let folder = path_of_example("polypropylene");
    let of = |name: &str| fields(&fs::read_to_string(folder.join(name)).unwrap());
    assert_eq!(of("rod.toml"), of("modulus.ron"));
}

fn outcome(path: &Path, text: &str) -> Outcome {
    let sheet = Sheet {
        path: path.to_path_buf(),
        text: text.to_owned(),
        job: job::parse(path, text).unwrap(),
    };
    job::run(&sheet, &Silent, &AtomicBool::new(false)).unwrap()
}

/// Results of the examples are equal in TOML and in RON. Virtual tests are left out because their
/// results name sheets with their extension, and the two longest examples to save time.
#[test]
fn results_do_not_depend_on_the_language() {
    let others = ["plan", "striker", "nylon/identify", "drill_string/force"];
    for path in examples() {
        if others
            .iter()
            .any(|name| path.with_extension("").ends_with(name))
        {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let toml = sheet::in_toml(&path, &text).unwrap();
        let result = |text: &str| {
            let mut outcome = outcome(&path, text);
            // settings are in the order of the sheet, and in TOML values without parts come first
            outcome.settings.sort_by(|a, b| a.name.cmp(&b.name));
            serde_json::to_string(&outcome).unwrap()
        };
        assert!(result(&toml) == result(&text), "{}", path.display());
    }
}

#[test]
fn json_has_the_form_of_toml() {
    let toml = r#"
        job = "force"
        title = "a"
        [problem.impact]
        first = { rigid_mass = "1 kg" }
        second = { impedance = "1000 kg/s" }
        velocity = "1 m/s"
        duration = "4 ms"
        contact = "rigid"
        "#;
    let json = r#"{"job": "force", "title": "a", "problem": {"impact": {"first": {"rigid_mass": "1 kg"},
        "second": {"impedance": "1000 kg/s"}, "velocity": "1 m/s", "duration": "4 ms", "contact": "rigid", "band": null}}}"#;
    let ron = r#"Force(title: "a", problem: Impact(first: RigidMass("1 kg"), second: Impedance("1000 kg/s"),
        velocity: "1 m/s", duration: "4 ms", contact: Rigid))"#;
    assert_eq!(fields(toml), fields(ron));
    assert_eq!(fields(json), fields(ron));
}

/// A stated value is listed as it is written, with the name of its field; fields that are not
/// stated follow with their defaults.
#[test]
fn settings_are_the_statements_of_a_sheet_and_what_they_leave_open() {
    let ron = r#"Force(
        title: "a",
        about: (operator: "N. N.", note: "first try"),
        materials: {"steel": (density: "7850 kg/m3", law: Elastic(modulus: "210 GPa"))},
        problem: Impact(
            first: RigidMass("1 kg ± 1 gram"),
            second: LongRod(material: "steel", diameter: "20 mm"),
            velocity: "1 m/s ± 1 %",
            duration: "4 ms",
            contact: Linear("1 MN/m"),
            uncertainty: (draws: 20),
        ),
    )"#;
    let path = Path::new("test.ron");
    let lines = |text: &str| -> Vec<String> {
        let listed = outcome(path, text).settings.into_iter().map(|setting| {
            let from = if setting.by_default { " (default)" } else { "" };
            format!("{}: {}{from}", setting.name, setting.value)
        });
        listed.collect::<Vec<_>>()
    };
    insta::assert_snapshot!(lines(ron).join("\n"), @r"
    about.operator: N. N.
    about.note: first try
    materials.steel.density: 7850 kg/m3
    materials.steel.law: Elastic
    materials.steel.law.modulus: 210 GPa
    problem: Impact
    problem.first: RigidMass 1 kg ± 1 gram
    problem.second: LongRod
    problem.second.material: steel
    problem.second.diameter: 20 mm
    problem.velocity: 1 m/s ± 1 %
    problem.duration: 4 ms
    problem.contact: Linear 1 MN/m
    problem.uncertainty.draws: 20
    problem.time_step: chosen for the band (default)
    problem.band: up to 10 kHz, Gaussian, -3 dB at its end (default)
    problem.uncertainty.seed: 1 (default)
    ");
    let toml = sheet::in_toml(path, ron).unwrap();
    let [mut in_toml, mut in_ron] = [&toml, ron].map(lines);
    in_toml.sort_unstable();
    in_ron.sort_unstable();
    assert_eq!(in_toml, in_ron);
}

/// Text with place, field and problem of every mistake.
fn mistakes(name: &str, text: &str) -> String {
    let error = job::parse(Path::new(name), text).unwrap_err();
    let all = std::iter::once(&*error).chain(error.others());
    let lines = all.map(|mistake| {
        let advice = mistake.advice();
        let advice = advice.map_or(String::new(), |advice| format!(" | {advice}"));
        let problem = mistake.problem().replace('\n', " ");
        let problem = problem.split(", only `").next().unwrap();
        // only the first method, so that a new one does not change the snapshot
        let problem = problem.split(", `resonances`").next().unwrap();
        format!(
            "{}:{} {}: {problem}{advice}",
            mistake.line(),
            mistake.column(),
            mistake.field()
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn all_mistakes_are_listed_in_one_run() {
    let toml = r#"job = "modulus"
titel = "a rod"
report_at = ["1 kHz", "2 mm"]

[specimen]
length = "799"
diameter = "15.8 kg"
denisty = "912 furlong"

[method.two_pint]
impacted_end = "struck end"

[source.hits.records]
files = ["hits.npy"]
sampling_rate = 65536
channels = [{ name = "struck end", from = true }, { from = 2, unit = "m/s2" }]
"#;
    insta::assert_snapshot!(mistakes("rod.toml", toml), @r#"
    2:1 titel: there is no field `titel` | did you mean `title`?
    3:23 report_at[1]: `2 mm` has the dimension of a length (m), expected a frequency, such as "51.2 kHz"
    6:10 specimen.length: `799` has no unit, expected a length, such as "800 mm", with or without ±
    7:12 specimen.diameter: `15.8 kg` has the dimension of a mass (kg), expected a length, such as "800 mm", with or without ±
    8:1 specimen.denisty: there is no field `denisty` | did you mean `density`?
    8:11 specimen.denisty: `912 furlong` has no known unit: `furlong` is not among the known symbols, expected a density, such as "1150 kg/m3", with or without ±
    10:1 method.two_pint: the field `free_end` is missing | add a line `free_end = ...`
    10:9 method: found `two_pint`, expected one of `two_point` | did you mean `two_point`?
    15:17 source.hits.records.sampling_rate: found the number `65536`, expected a frequency with its unit in quotes, such as "51.2 kHz"
    16:43 source.hits.records.channels[0].from: found neither a channel nor a column, expected its number from 1 or its name in quotes
    16:51 source.hits.records.channels[1]: the field `name` is missing | add a line `name = ...`
    "#);
    let ron = r#"Modulus(
    titel: "a rod",
    report_at: ["1 kHz", "2 mm"],
    specimen: (
        length: "799",
        diameter: "15.8 kg",
        denisty: "912 furlong",
    ),
    method: TwoPint(impacted_end: "struck end"),
    source: Hits(records: (
        files: ["hits.npy"],
        sampling_rate: 65536,
        channels: [(name: "struck end", from: true), (from: 2, unit: "m/s2")],
    )),
)
"#;
    // the mistakes are in the same fields, apart from the names in each language
    let plain = |text: String| {
        let lines = text.lines().map(|line| {
            let field = line.split_whitespace().nth(1).unwrap();
            field
                .replace("Modulus.", "")
                .replace("TwoPint", "two_pint")
                .replace("Hits", "hits")
        });
        lines.collect::<BTreeSet<String>>()
    };
    let (of_toml, of_ron) = (mistakes("rod.toml", toml), mistakes("rod.ron", ron));
    assert_eq!(of_toml.lines().count(), of_ron.lines().count(), "{of_ron}");
    assert_eq!(plain(of_toml), plain(of_ron));
}

#[test]
fn a_sheet_of_no_language_is_told_what_one_is() {
    for (text, said) in [
        ("", "1:1 : not the beginning of a test sheet"),
        ("Dear all", "1:1 : not the beginning of a test sheet"),
        (
            "title = \"a\"",
            "1:1 : the field `job` is missing | begin the sheet with",
        ),
        (
            "job = \"modulos\"",
            "1:7 : found `modulos`, expected one of `frf`, `modulus`",
        ),
        (
            "job = \"frf\"\njob = \"frf\"",
            "2:1 : the field `job` is stated twice",
        ),
        ("job = \"frf\"\ntitle = \"a\nx = \"", "2:"),
        (
            "job = \"frf\"\ntitle = \"C:\\Users\"",
            "a backslash starts an escape sequence, and this sequence is not valid | write C:/Users/...",
        ),
        (
            "job = \"frf\"\n[records]\ntitle = \"a\"",
            "records.title: there is no field `title` | it is a field of the sheet itself",
        ),
        ("Frf(title: \"a\"", "1:13 : expected comma"),
        ("{\"job\": \"frf\"", "1:13 : EOF while parsing an object"),
        (
            "{\"job\": \"frf\", \"title\": \"a\", \"title\": \"b\"}",
            "title: the field `title` is stated twice",
        ),
        (
            "Frf(title: \"a\", title: \"b\")",
            "1:17 Frf.title: the field `title` is stated twice",
        ),
    ] {
        let found = mistakes("sheet", text);
        assert!(found.contains(said), "{text}: {found}");
    }
}

#[test]
fn the_terminal_shows_every_mistake_with_its_line() {
    let folder = Folder::new();
    let sheet = "job = \"force\"\ntitle = \"a\"\n[problem.impact]\nfirst = { rigid_mass = \"1 m\" }\nsecond = { impedance = \"1 kg\" }\n";
    folder.write("hit.toml", sheet);
    text(&folder.rodlab("check hit.toml").stderr).must_say_all(&[
        "hit.toml:3:1: problem.impact: the field `velocity` is missing (and 3",
        "the field `duration` is missing",
        "4 │ first = { rigid_mass = \"1 m\" }",
        "5 │ second = { impedance = \"1 kg\" }",
    ]);
}

const FORCE: &str = "job = \"force\"\ntitle = \"{{mass}}\"\n[problem.impact]\nfirst = { rigid_mass = \"{{mass}}\" }\n\
    second = { impedance = \"1000 kg/s\" }\nvelocity = \"1 m/s\"\nduration = \"4 ms\"\ntime_step = \"10 us\"\n";

#[test]
fn campaigns_take_both_languages_and_leave_other_files_alone() {
    let folder = Folder::new();
    let write = |name: &str, text: &str| folder.write(name, text);
    write("hit.template", FORCE);
    write(
        "plan.txt",
        "template = \"hit.template\"\ngrid = [{ name = \"mass\", values = [\"1 kg\", \"2 kg\"] }]\n",
    );
    let swept = folder.done("sweep plan.txt --out sheets");
    assert_eq!(swept, "2 sheets and sweep.csv in sheets\n");
    write("sheets/pyproject.toml", "[project]\nname = \"analysis\"\n");
    let ron = r#"Force(title: "c", problem: Impact(first: RigidMass("3 kg"), second: Impedance("1000 kg/s"),
        velocity: "1 m/s", duration: "4 ms", time_step: "10 us"))"#;
    write("sheets/c.ron", ron);
    write("sheets/d.toml", "job = \"force\"\nthis is wrong\n");
    let run = folder.rodlab("batch sheets --out results");
    text(&run.stdout).must_say_all(&[
        "answered     hit-1",
        "answered     hit-2",
        "answered     c",
        "wrong input  d",
        "4 tests:",
    ]);
    // a pattern may match a file that is no sheet
    text(&folder.rodlab("list sheets/*.toml").stdout).must_say("pyproject");
}

#[test]
fn init_writes_toml_unless_ron_is_asked_for() {
    let folder = Folder::new();
    for (call, status) in [
        ("init modulus", 0),
        ("init modulus --ron", 0),
        ("init frf a.ron", 0),
        ("init frf b.toml --ron", 2),
    ] {
        assert_eq!(folder.rodlab(call).status.code(), Some(status), "{call}");
    }
    let language = |name: &str| Language::of(&folder.read(name));
    assert_eq!(language("modulus.toml"), Some(Language::Toml));
    assert_eq!(language("modulus.ron"), Some(Language::Ron));
    assert_eq!(language("a.ron"), Some(Language::Ron));
    assert!(!folder.has("b.toml"));
}

#[test]
fn simulate_writes_sheets_in_the_language_of_its_own() {
    let example = path_of_example("polypropylene/plan.ron");
    let plan = fs::read_to_string(&example).unwrap();
    let folder = Folder::new();
    folder.write("plan.toml", sheet::in_toml(&example, &plan).unwrap());
    folder
        .done("simulate plan.toml")
        .must_say("`rodlab modulus modulus.toml`");
    let written = folder.read("plan-result/modulus.toml");
    written.must_say("# each record is a hit\n");
    let of_ron = outcome(&example, &plan);
    let mut files = of_ron.attachments.iter();
    let sheet = files.find(|file| file.name == "modulus.ron").unwrap();
    assert_eq!(fields(&written), fields(&text(&sheet.bytes)));
    folder.done("check plan-result/modulus.toml");
}
