//! A stated uncertainty changes the result, or the sheet is refused: this is tested for every
//! quantity in every kind of sheet.
//!
//! The quantities are found in the texts of the sheets, and the fields that accept an uncertainty
//! in the source code; there is no list of them here.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use num_complex::Complex64;
use rodlab::job::parse;
use rodlab::outcome::Outcome;
use rodlab::sheet::Language;
use rodlab::templates::JobName;

use crate::runs::{Folder, Refused, Words, outcome_of, path_of_example, write_columns};
use crate::two_masses::{BODY, HAMMER, Hammer, strike};

/// A quoted text in a sheet, with its field.
struct Quoted {
    field: String,
    /// Range of the text, without the quotes.
    place: Range<usize>,
}

/// All quoted texts of a sheet, except in comments.
fn quoted(text: &str) -> Vec<Quoted> {
    let mut found = Vec::new();
    // the field at each depth of brackets
    let mut fields = vec![String::new()];
    let mut word = String::new();
    let mut letters = text.char_indices().peekable();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '/' if text[at..].starts_with("//") => {
                while letters.next_if(|(_, c)| *c != '\n').is_some() {}
            }
            '"' => {
                while letters.next_if(|(_, c)| *c != '"').is_some() {}
                let end = letters.next().unwrap().0;
                found.push(Quoted {
                    field: fields.last().unwrap().clone(),
                    place: at + 1..end,
                });
            }
            '(' | '[' | '{' => {
                let inner = if word.is_empty() {
                    fields.last().unwrap().clone()
                } else {
                    word.clone()
                };
                fields.push(inner);
                word.clear();
            }
            ')' | ']' | '}' => {
                fields.pop();
                word.clear();
            }
            ':' if !word.is_empty() => {
                *fields.last_mut().unwrap() = std::mem::take(&mut word);
            }
            c if c.is_ascii_alphanumeric() || c == '_' => word.push(c),
            ',' => word.clear(),
            _ => {}
        }
    }
    found
}

/// Number and unit of a text that is a quantity.
fn quantity(text: &str) -> Option<(f64, &str)> {
    let text = text.split('±').next().unwrap().trim();
    let end = text
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')))
        .unwrap_or(text.len());
    let number = text[..end].parse().ok()?;
    let unit = text[end..].trim();
    let is_unit = unit.is_empty() || unit == "samples" || labio::Unit::parse(unit).is_ok();
    is_unit.then_some((number, unit))
}

/// The quantity with an uncertainty that no sheet states: 3 % of its value, or a thousandth of its
/// unit if it is 0.
fn uncertain(text: &str) -> Option<String> {
    let (number, unit) = quantity(text)?;
    let stated = text.split('±').next().unwrap().trim();
    Some(if number == 0.0 {
        format!("{stated} ± 0.001 {unit}")
    } else {
        format!("{stated} ± 3 %")
    })
}

fn sources() -> String {
    let files = glob::glob(concat!(env!("CARGO_MANIFEST_DIR"), "/src/**/*.rs")).unwrap();
    let texts = files.map(|file| fs::read_to_string(file.unwrap()).unwrap());
    texts.collect()
}

/// Names of the fields and variants of sheets whose type contains one of the texts `of`.
fn declared(sources: &str, of: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in sources.lines().map(str::trim) {
        let is_code = !line.starts_with("//")
            && !line.contains("fn ")
            && !line.contains("let ")
            && !line.contains("&Stated");
        if is_code && of.iter().any(|of| line.contains(of)) && line.ends_with([',', ')']) {
            let line = line
                .trim_start_matches("pub ")
                .trim_start_matches("(super) ");
            let end = line.find([':', '(']).unwrap_or(0);
            let name = line[..end].trim_end();
            if !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                found.insert(name.to_owned());
            }
        }
    }
    found
}

/// Fields that accept an uncertainty, as declared in the source code.
fn taking_an_uncertainty() -> BTreeSet<String> {
    let found = declared(&sources(), &["Stated<", "Option<Sensitivity>"]);
    // fields that must be among them, as a check of the parser
    for field in ["density", "velocity", "poisson_ratio", "at", "sensitivity"] {
        assert!(found.contains(field), "{field} is not among {found:?}");
    }
    found
}

fn texts() -> BTreeSet<String> {
    let mut found = declared(&sources(), &["String", "Selector"]);
    // keys of maps are texts, too
    found.extend(["materials", "full_scales", "noise_of"].map(str::to_owned));
    found
}

/// All numbers of an outcome as JSON: verdict, quantities and tables.
fn numbers(outcome: &Outcome) -> String {
    let whole = serde_json::to_value(outcome).unwrap();
    let parts = ["verdict", "quantities", "tables"].map(|part| whole[part].to_string());
    parts.join(" ")
}

/// Fields whose uncertainty changed the numbers of an outcome, and the faults found.
#[derive(Default)]
struct Walked {
    followed: BTreeSet<String>,
    n_quantities: usize,
    wrong: Vec<String>,
}

impl Walked {
    /// States an uncertainty for each quantity of the sheet, one after the other. Each must change
    /// the numbers of the outcome, or be refused with a message about it.
    fn walk(&mut self, folder: &Path, text: &str, [taking, texts]: [&BTreeSet<String>; 2]) {
        let before = match outcome_of(folder, text) {
            Ok(before) => before,
            Err(error) => return self.wrong.push(format!("{error} in\n{text}")),
        };
        let numbers_before = numbers(&before);
        for Quoted { field, place } in quoted(text) {
            let Some(stated) = uncertain(&text[place.clone()]) else {
                continue;
            };
            if texts.contains(&field) && !taking.contains(&field) {
                continue;
            }
            self.n_quantities += 1;
            let changed = format!("{}{stated}{}", &text[..place.start], &text[place.end..]);
            match outcome_of(folder, &changed) {
                Err(error) => {
                    let words = error.to_string();
                    // or the message states that the field takes no unit or only whole numbers
                    let says_why = [
                        "uncertainty",
                        "without ±",
                        "no known unit",
                        "no unit",
                        "whole number",
                    ];
                    if !says_why.iter().any(|why| words.contains(why)) {
                        self.wrong.push(format!("{field}: {words}"));
                    }
                }
                Ok(outcome) => {
                    if numbers(&outcome) == numbers_before {
                        self.wrong
                            .push(format!("`{stated}` of {field} changes nothing in\n{text}"));
                    }
                    self.followed.insert(field);
                }
            }
        }
    }
}

fn example(name: &str, sheet: &str) -> (PathBuf, String) {
    let folder = path_of_example(name);
    let text = fs::read_to_string(folder.join(sheet)).unwrap();
    (folder, text)
}

fn replaced(text: &str, from: &str, to: &str) -> String {
    text.must_say(from);
    text.replacen(from, to, 1)
}

/// Sheets for the modulus from hits.
fn moduli_of_hits() -> Vec<(PathBuf, String)> {
    let (folder, ends) = example("polypropylene", "modulus.ron");
    // fewer lines and no laws take less time
    let laws = ends.find("    // a law for").unwrap()..ends.find("    report_at").unwrap();
    let mut ends = replaced(&ends, &ends[laws], "");
    ends = replaced(&ends, "to: \"15 kHz\"", "to: \"4 kHz\"");
    ends = replaced(
        &ends,
        "unit: \"m/s2\"",
        "unit: \"m/s2\", sensitivity: \"1\", gain: \"1\", time_skew: \"0 us\", position: \"0 mm\"",
    );
    ends = replaced(
        &ends,
        "    report_at",
        "    temperature: (of_hits: [\"23 degC\"], reference: \"20 degC\", slope: \"-0.004 1/K\"),\n    report_at",
    );
    let (frame, three) = example("frame", "modulus.ron");
    let several = replaced(
        &three,
        "ThreePoint(gauges: [",
        "MultiPoint(wave_speed: \"1700 m/s\", free_end_at: \"800 mm\", gauges: [",
    );
    vec![(folder, ends), (frame.clone(), three), (frame, several)]
}

/// Sheets for the modulus from one shot, with two gauges before a free end.
fn modulus_of_a_shot(folder: &Path) -> [(PathBuf, String); 2] {
    let rows = testbed::long_bar::LongBar::glassy().shot(&[1.0, 1.0], 1);
    write_columns(&folder.join("shot.csv"), &rows);
    let text = r#"Modulus(title: "Bar", specimen: (diameter: "20 mm", density: "1190 kg/m3"),
        method: MultiPoint(gauges: [(channel: "g1", at: "1600 mm"), (channel: "g2", at: "2000 mm")], free_end_at: "2500 mm"),
        source: Hits(records: (files: ["shot.csv"], sampling_rate: "250 kHz", channels: [(name: "g1", from: 1, unit: "strain"),
            (name: "g2", from: 2, unit: "strain")]), silent: "0.9 ms"),
        band: (from: "700 Hz", to: "8 kHz"))"#;
    let bar = r#"Bar(title: "Bar", bar: (length: "2500 mm", diameter: "20 mm", density: "1190 kg/m3", poisson_ratio: "0.1"),
        gauges: [(channel: "g1", from_free_end: "900 mm"), (channel: "g2", from_free_end: "500 mm")], wave_speed: "1400 m/s",
        records: (files: ["shot.csv"], sampling_rate: "250 kHz", channels: [(name: "g1", from: 1, unit: "strain"),
            (name: "g2", from: 2, unit: "strain")]), silent: "0.9 ms", band: (from: "700 Hz", to: "8 kHz"))"#;
    [text, bar].map(|text| (folder.to_owned(), text.to_owned()))
}

/// Sheets for the modulus from ratios in closed form, for each method that accepts a ratio, with
/// and without a mass on the end.
fn moduli_of_ratios(folder: &Path) -> Vec<(PathBuf, String)> {
    let gamma = |f: f64| Complex64::new(0.05, 1.0) * (TAU * f / 1700.0);
    let write = |name: &str, ratio: &dyn Fn(f64) -> Complex64| {
        let mut file = "frequency [Hz],real,imaginary\n".to_owned();
        for line in 1..=60 {
            let f = 25.0 * f64::from(line);
            let value = ratio(f);
            writeln!(file, "{f},{},{}", value.re, value.im).unwrap();
        }
        fs::write(folder.join(name), file).unwrap();
    };
    // ratio of motions, because strains vanish at the free end
    write("end.csv", &|f| {
        (gamma(f) * 0.6).cosh() / (gamma(f) * 0.2).cosh()
    });
    write("pulse.csv", &|f| (-gamma(f) * 0.6).exp());
    write("ends.csv", &|f| (gamma(f) * 0.8).cosh());
    let methods = [
        (
            "end.csv",
            r#"FreeEnd(first: (channel: "a", from_free_end: "600 mm", quantity: Velocity), second: (channel: "b", from_free_end: "200 mm", quantity: Velocity), wave_speed: "1700 m/s")"#,
        ),
        (
            "ends.csv",
            r#"FreeEnd(first: (channel: "a", from_free_end: "800 mm", quantity: Velocity), second: (channel: "b", from_free_end: "0 mm", quantity: Velocity))"#,
        ),
        (
            "pulse.csv",
            r#"SeparatePulses(first: (channel: "a", from: "1 ms", to: "2 ms"), second: (channel: "b", from: "2 ms", to: "3 ms"), distance: "600 mm", wave_speed: "1700 m/s")"#,
        ),
        (
            "pulse.csv",
            r#"OneGauge(section: (channel: "a", from_free_end: "300 mm", quantity: Velocity), incident: ("1 ms", "2 ms"), reflected: ("2 ms", "3 ms"))"#,
        ),
        (
            "ends.csv",
            r#"Resonances(impacted_end: "a", free_end: "b")"#,
        ),
        ("ends.csv", r#"TwoPoint(impacted_end: "a", free_end: "b")"#),
    ];
    let mut sheets = Vec::new();
    for (file, method) in methods {
        for mass in ["", r#", accelerometer_mass: "1 gram""#] {
            sheets.push((folder.to_owned(), format!(
                r#"Modulus(title: "{file}", specimen: (length: "800 mm", diameter: "16 mm", density: "912 kg/m3"{mass}), method: {method},
                source: Ratio(path: "{file}", values: Parts(real: "real", imaginary: "imaginary"), errors: Relative(of_value: "0.1 %")),
                band: (from: "20 Hz", to: "1.5 kHz"), limits: (storage_modulus: "1 %", loss_factor: "5 %", error_amplification: "10"),
                checks: (level: "1 %"), report_at: ["500 Hz"])"#
            )));
        }
    }
    sheets
}

/// Sheets about hits on a body of two masses.
fn struck_bodies(folder: &Path) -> Vec<(PathBuf, String)> {
    let hammer = Hammer { hits: 4, ..HAMMER };
    strike(folder, "hit", BODY, hammer);
    let channels = r#"records: (files: ["hit*.csv"], channels: [(name: "hammer", from: "force", sensitivity: "1"), (name: "face", from: "acceleration", gain: "1")])"#;
    let mobility = format!(
        r#"Mobility(title: "two masses", source: Hits({channels}, force: "hammer", response: "face"), support: Free(mass: "1.54 kg"), head_mass: "40 gram",
        up_to: "4 kHz", complete: (below: "100 Hz", fitted_to: "400 Hz"), front_impedance: "1000 kg/s")"#
    );
    let made = outcome_of(folder, &mobility).unwrap();
    fs::write(folder.join("body.uff"), &made.attachments[0].bytes).unwrap();
    let frf = format!(
        r#"Frf(title: "two masses", {channels}, input: "hammer", outputs: ["face"], band: (from: "20 Hz", to: "3 kHz"),
        force_window: (start: "3 ms", end: "10 ms", taper: "1 ms"), exponential_window: EndWeight(weight: "10 %"))"#
    );
    let weighed = format!(
        r#"Frf(title: "two masses", {channels}, input: "hammer", outputs: ["face"], window: Tukey(taper: "1 %"), weighed_mass: (mass: "1.5 kg", below: "100 Hz", fitted_to: "400 Hz"))"#
    );
    let measured = r#"Force(title: "measured", materials: {"pp": (density: "912 kg/m3", law: Elastic(modulus: "2.6 GPa"))}, problem: Impact(
        first: Measured(file: "body.uff", support: Free(mass: "1.5 kg"), scale_uncertainty: "1 %", front_impedance: "5000 kg/s"),
        second: LongRod(material: "pp", diameter: "30 mm"), velocity: "2 m/s", duration: "1 ms",
        lines: (up_to: "3 kHz", roll_off_from: "2 kHz"), uncertainty: (draws: 60, level: "90 %")))"#;
    let file = r#"Force(title: "response", problem: Response(path: Hits(RECORDS, force: "hammer", response: "face"),
        record: (files: ["hit2.csv"], channels: [(name: "face", from: "acceleration", sensitivity: "1")]), response: "face",
        noise: White("0.5 m/s2"), acting: (from: "3.5 ms", to: "5 ms"), uncertainty: (draws: 200, seed: 1, level: "95 %")))"#
        .replace("RECORDS", channels);
    // the same body measured at two points, with a rigid mass behind it
    let points = replaced(
        measured,
        r#"Measured(file: "body.uff", support: Free(mass: "1.5 kg"), scale_uncertainty: "1 %", front_impedance: "5000 kg/s")"#,
        r#"Assembly(face: "head, face", joints: [], members: [(name: "head", measured: (points: ["face"], support: Free(mass: "1.5 kg"), mobilities: [
            (between: ("face", "face"), response: (file: "body.uff"), front_impedance: "5000 kg/s")]))])"#,
    );
    let points = replaced(
        &points,
        r#"lines: (up_to: "3 kHz", roll_off_from: "2 kHz"),"#,
        "",
    );
    [mobility, frf, weighed, measured.to_owned(), points, file]
        .map(|text| (folder.to_owned(), text))
        .to_vec()
}

/// Sheets for impacts of computed bodies with every element, law and contact.
fn impacts() -> Vec<(PathBuf, String)> {
    let impact = |materials: &str, problem: &str| {
        format!(
            r#"Force(title: "computed", materials: {{{materials}}}, problem: Impact({problem},
            velocity: "1 m/s", duration: "0.3 ms", time_step: "5 us", uncertainty: (draws: 8)))"#
        )
    };
    let zener = r#"(density: "1150 kg/m3", law: Zener(relaxed: "2.4 GPa", unrelaxed: "2.8 GPa", relaxation_time: "50 us"))"#;
    let maxwell =
        r#"(density: "1150 kg/m3", law: Maxwell(modulus: "3 GPa", viscosity: "2 MPa s"))"#;
    let fractional = r#"(density: "1150 kg/m3", law: FractionalZener(relaxed: "2.4 GPa", unrelaxed: "2.8 GPa", relaxation_time: "50 us", exponent: "0.5"))"#;
    let prony = r#"(density: "1150 kg/m3", law: Prony(equilibrium: "2.4 GPa", branches: [(modulus: "0.3 GPa", relaxation_time: "20 us")]))"#;
    [
        impact(
            &format!(r#""a": {zener}, "b": {maxwell}"#),
            r#"first: Chain(elements: [Mass("0.05 kg"), Spring("50 MN/m"), Rod(material: "a", diameter: "20 mm", length: "100 mm"), Dashpot("500 kg/s")], end: Mass("0.1 kg")),
            second: LongRod(material: "b", diameter: "20 mm"), contact: Linear("50 MN/m")"#,
        ),
        impact(
            &format!(r#""a": {zener}"#),
            r#"first: RigidMass("0.5 kg"), second: Assembly(face: "rod", members: [
                (name: "rod", body: Chain(elements: [Rod(material: "a", diameter: "20 mm", length: "100 mm")])), (name: "bit", body: RigidMass("0.1 kg"))],
                joints: [(between: ("rod, end", "bit")), (between: ("bit", "ground"), stiffness: "50 MN/m", resistance: "500 kg/s")])"#,
        ),
        impact(
            &format!(r#""a": {fractional}, "b": {prony}"#),
            r#"first: Chain(elements: [Rod(material: "a", diameter: "20 mm", length: "100 mm")], end: Free),
            second: LongRod(material: "b", diameter: "20 mm"), contact: FlatPunch(radius: "10 mm", modulus: "70 GPa", poisson_ratio: "0.33")"#,
        ),
        impact(
            "",
            r#"first: RigidMass("0.1 kg"), second: Impedance("1000 kg/s"), contact: Sphere(radius: "25 mm", moduli: ("70 GPa", "200 GPa"), poisson_ratios: ("0.33", "0.30"))"#,
        ),
        impact(
            "",
            r#"first: RigidMass("0.1 kg"), second: Impedance("1000 kg/s"), contact: Table([("0.01 mm", "100 N"), ("0.2 mm", "20 kN")])"#,
        ),
    ]
    .map(|text| (PathBuf::from("."), text))
    .to_vec()
}

/// A sheet for a tube between bars in torsion, with one gauge per bar.
fn twisted_tube(folder: &Path) -> (PathBuf, String) {
    let pulse = |n: f64| {
        let inside = (0.0..150.0).contains(&n);
        1e-3 * (std::f64::consts::PI * n / 150.0).sin().powi(2) * f64::from(u8::from(inside))
    };
    let times = || (0..1500).map(f64::from);
    let near = times().map(|n| pulse(n - 200.0) - 0.6 * pulse(n - 600.0));
    let far = times().map(|n| 0.4 * pulse(n - 500.0));
    write_columns(&folder.join("tube.csv"), &[near.collect(), far.collect()]);
    let sheet = r#"Shpb(title: "tube", loading: Torsion, bars: (
        incident: (waves: Speed(density: "7800 kg/m3", wave_speed: "3100 m/s"), diameter: "25 mm", length: "1900 mm", gauges: [(channel: "a", at: "620 mm")]),
        transmitted: (waves: Speed(density: "7800 kg/m3", wave_speed: "3100 m/s"), diameter: "25 mm", length: "1900 mm", gauges: [(channel: "b", at: "310 mm")])),
        specimen: (length: "3 mm", diameter: "16 mm", wall: "0.5 mm"),
        records: [(files: ["tube.csv"], sampling_rate: "1 MHz", channels: [
            (name: "a", from: 1, unit: "strain", sensitivity: "1"), (name: "b", from: 2, unit: "strain", time_skew: "0 us")])],
        silent: "150 us", band: "60 kHz")"#;
    (folder.to_owned(), sheet.to_owned())
}

fn others() -> Vec<(PathBuf, String)> {
    let (cone, force) = example("cone", "force.ron");
    // whether a number changes does not depend on the number of draws
    let few = r#"duration: "1 ms", uncertainty: (draws: 8),"#;
    let force = replaced(&force, r#"duration: "4 ms","#, few);
    let (nylon, _) = example("nylon", "identify.ron");
    let identify = r#"Identify(title: "one", specimen: (length: "394 mm", density: "1140 kg/m3"), tests: [(name: "a",
        records: (files: ["shots-1.csv"], channels: [(name: "near end", from: "near end", sensitivity: "1"), (name: "free end", from: "free end")]),
        excitation: "near end", response: "free end", impact_velocity: "3 m/s", from: "0 ms", to: "1.5 ms",
        noise: Velocities(excitation: "50 mm/s", response: "50 mm/s"), generator: "rodwave::lumped")],
        laws: [Maxwell], compare: false, profiles: false, cell: "4 mm")"#;
    let simulate = r#"Simulate(title: "creep", experiment: CreepRecovery(
        series_modulus: "3.1 GPa", parallel_modulus: "13.1 kPa", exponent: "1.8", coefficient: 4.55e-21,
        virgin_loss_factor: "0.025", frequency: "10 kHz", error: "0.0004",
        loads: [(stress: "45 MPa", duration: "30 min"), (stress: "19 MPa", duration: "30 min")], read_at: ["1 min", "5 min", "10 min"]), output: "a.csv")"#;
    let here = PathBuf::from(".");
    vec![
        (cone, force),
        (nylon, identify.to_owned()),
        (
            here.clone(),
            JobName::Recovery.template(Language::Ron).to_owned(),
        ),
        (here, simulate.to_owned()),
    ]
}

#[test]
fn r08_a_stated_uncertainty_changes_the_result_or_the_sheet_is_refused() {
    let folder = Folder::new();
    let sheets = [
        moduli_of_hits(),
        modulus_of_a_shot(folder.path()).to_vec(),
        moduli_of_ratios(folder.path()),
        struck_bodies(folder.path()),
        impacts(),
        others(),
        vec![twisted_tube(folder.path())],
    ]
    .concat();
    let (declared, texts) = (taking_an_uncertainty(), texts());
    let mut walked = Walked::default();
    for (folder, text) in &sheets {
        walked.walk(folder, text, [&declared, &texts]);
    }
    assert!(walked.wrong.is_empty(), "{}", walked.wrong.join("\n\n"));
    assert!(walked.n_quantities > 200, "{}", walked.n_quantities);
    // every field that is declared to accept an uncertainty has changed a result
    let unseen: Vec<&String> = declared.difference(&walked.followed).collect();
    assert!(
        unseen.is_empty(),
        "{unseen:?} take an uncertainty, and no sheet here states them"
    );
}

/// Templates and plans contain fields that no sheet above states: with an uncertainty, they are
/// refused or their field is among those that change a result above.
#[test]
fn r08_every_field_of_the_templates_and_plans_takes_its_uncertainty_or_refuses_it() {
    let mut sheets: Vec<String> = JobName::ALL
        .iter()
        .map(|job| job.template(Language::Ron).to_owned())
        .collect();
    for name in ["polypropylene", "frame", "nylon"] {
        sheets.push(example(name, "plan.ron").1);
    }
    let (taking, texts) = (taking_an_uncertainty(), texts());
    let mut n_refused = 0;
    for text in &sheets {
        for Quoted { field, place } in quoted(text) {
            let Some(stated) = uncertain(&text[place.clone()]) else {
                continue;
            };
            let changed = format!("{}{stated}{}", &text[..place.start], &text[place.end..]);
            match parse(Path::new("sheet.ron"), &changed) {
                Ok(_) => assert!(
                    taking.contains(&field) || texts.contains(&field),
                    "`{stated}` of {field} is read, and nothing follows it"
                ),
                Err(error) => {
                    // the message refers to a line of the sheet
                    assert!(error.line() > 1, "{error}");
                    n_refused += 1;
                }
            }
        }
    }
    assert!(n_refused > 60, "{n_refused}");
}

/// The refusal states the place, the value, the reason and an alternative.
#[test]
fn r08_the_refusal_says_why_and_what_to_do() {
    let refused = |text: &str| parse(Path::new("s.ron"), text).refused();
    let impact = |modulus: &str, duration: &str| {
        format!(
            r#"Force(title: "a", materials: {{"pp": (density: "912 kg/m3", law: Elastic(modulus: "{modulus}"))}},
 problem: Impact(first: RigidMass("1 kg"), second: LongRod(material: "pp", diameter: "10 mm"), velocity: "1 m/s ± 1 %", duration: "{duration}"))"#
        )
    };
    let measured = |impedance: &str| {
        format!(
            r#"Force(title: "a", problem: Impact(first: Measured(file: "a.uff", support: LongRod(impedance: "{impedance}")),
 second: RigidMass("1 kg"), velocity: "1 m/s", duration: "4 ms"))"#
        )
    };
    insta::assert_snapshot!(
        [
            refused(&impact("2.6 GPa", "4 ms ± 0.1 ms")),
            refused(&measured("1000 kg/s ± 2 %")),
        ]
        .join("\n")
    );
    assert!(
        parse(Path::new("s.ron"), &impact("2.6 GPa ± 0 GPa", "4 ms ± 0 %")).is_ok(),
        "0 is exact"
    );
}
