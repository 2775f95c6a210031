//! Sheets of a campaign: made from a plan, and listed with the inputs on which their results
//! depend.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::runs::{Folder, Words, rodlab, text};

/// A plan with two velocities, two masses and three seeds.
const PLAN: &str = r#"Sweep(template: "hit.template", grid: [(name: "velocity", values: ["1 m/s", "2 m/s"]),
    (name: "mass", values: ["0.5 kg", "1 kg"])], seeds: (first: 7, count: 3))"#;

const TEMPLATE: &str = r#"// number {{seed}}
Force(title: "{{ mass }}, {{seed}}", problem: Impact(first: RigidMass("{{mass}}"), second: Impedance("1000 kg/s"),
    velocity: "{{velocity}}", duration: "4 ms", time_step: "10 us"))"#;

fn folder_with(plan: &str, template: &str) -> Folder {
    let folder = Folder::new();
    folder.write("plan.ron", plan);
    folder.write("hit.template", template);
    folder
}

fn listed(folder: &Path, sheets: &str, status: i32) -> Vec<Value> {
    let done = rodlab(folder, &["list", "--json", sheets]);
    assert_eq!(done.status.code(), Some(status), "{}", text(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn a_plan_makes_a_sheet_for_each_combination() {
    let folder = folder_with(PLAN, TEMPLATE);
    let done = folder.rodlab("sweep plan.ron");
    assert_eq!(
        text(&done.stdout),
        "12 sheets and sweep.csv in plan-sheets\n"
    );
    let sheets = folder.file("plan-sheets");
    let list = fs::read_to_string(sheets.join("sweep.csv")).unwrap();
    let lines: Vec<&str> = list.lines().collect();
    assert_eq!(lines.len(), 13);
    assert_eq!(lines[0], "file,velocity,mass,seed,sha256");
    lines[1].must_begin("hit-01.ron,1 m/s,0.5 kg,7,");
    lines[5].must_begin("hit-05.ron,1 m/s,1 kg,8,");
    lines[12].must_begin("hit-12.ron,2 m/s,1 kg,9,");
    let expected = TEMPLATE
        .replace("{{velocity}}", "2 m/s")
        .replace("{{mass}}", "1 kg")
        .replace("{{ mass }}", "1 kg")
        .replace("{{seed}}", "9");
    assert_eq!(
        fs::read_to_string(sheets.join("hit-12.ron")).unwrap(),
        expected
    );

    // the hashes equal those that `list` prints
    let listed = listed(folder.path(), "plan-sheets", 0);
    for (one, line) in listed.iter().zip(&lines[1..]) {
        assert_eq!(one["job"], "force");
        assert!(line.ends_with(one["sha256"].as_str().unwrap()), "{line}");
    }
    // a second sweep replaces no file, and writes no sheet at all if one of the files exists
    fs::remove_file(sheets.join("hit-01.ron")).unwrap();
    fs::write(sheets.join("hit-02.ron"), "mine").unwrap();
    let again = folder.rodlab("sweep plan.ron");
    assert_eq!(again.status.code(), Some(2));
    text(&again.stderr).must_say("hit-02.ron: it exists already");
    assert!(!sheets.join("hit-01.ron").exists());
    assert_eq!(
        fs::read_to_string(sheets.join("hit-02.ron")).unwrap(),
        "mine"
    );
}

#[test]
fn a_plan_that_does_not_fit_its_template_writes_nothing() {
    let plan = |from: &str, to: &str, said| (PLAN.replace(from, to), TEMPLATE.to_owned(), said);
    let template = |from: &str, to: &str, said| (PLAN.to_owned(), TEMPLATE.replace(from, to), said);
    let cases = [
        plan(
            "\"mass\"",
            "\"weight\"",
            "hit.template:2:15 is the placeholder `mass`, expected one of the plan: `velocity`, `weight`, `seed`",
        ),
        template("{{velocity}}", "1 m/s", "a template without `{{velocity}}`"),
        template(
            "{{velocity}}",
            "{{velocity",
            "hit.template:3:16 is `{{`, expected a name",
        ),
        plan(
            "\"1 kg\"",
            "\"0.5 kg\"",
            "grid[1].values is 2 values, 1 of them distinct",
        ),
        plan("[\"0.5 kg\", \"1 kg\"]", "[]", "grid[1].values is 0 values"),
        plan("\"mass\"", "\"velocity\"", "`velocity` a second time"),
        plan("\"mass\"", "\"seed\"", "grid[1].name is `seed`"),
        plan(
            "count: 3",
            "count: 0",
            "seeds is 0 seeds from 7, expected at least one",
        ),
        plan(
            "count: 3",
            "count: 4000000",
            "16000000 sheets, expected at most 100000",
        ),
        plan(
            "first: 7",
            "first: 4294967295",
            "expected at least one seed, all below 4294967295",
        ),
        plan("seeds", "seed", "there is no field `seed`"),
        plan("hit.template", "absent", "cannot read absent"),
        (
            "Sweep(template: \"hit.template\")".to_owned(),
            TEMPLATE.to_owned(),
            "grid is empty, expected at least one placeholder",
        ),
        plan(
            "2 m/s",
            "2 m",
            "`2 m` has the dimension of a length (m), expected a velocity",
        ),
    ];
    for (plan, template, said) in cases {
        let folder = folder_with(&plan, &template);
        let done = folder.rodlab("sweep plan.ron");
        let words = text(&done.stderr).replace("\n  │ ", " ");
        assert_eq!(done.status.code(), Some(2), "{words}");
        words.must_say(said);
        assert!(!folder.has("plan-sheets"), "{said}");
    }
}

#[test]
fn the_key_of_a_listed_sheet_is_that_of_everything_it_reads() {
    let folder = Folder::of_example("polypropylene");
    let before = listed(folder.path(), "modulus.ron", 0);
    assert_eq!(before[0]["test"], "modulus");
    assert_eq!(before[0]["inputs"].as_array().unwrap().len(), 5);
    // inputs and hash of the sheet are those of the result
    assert!(folder.rodlab("modulus modulus.ron").status.success());
    let result = folder.json("modulus-result/result.json");
    assert_eq!(before[0]["inputs"], result["inputs"]);
    assert_eq!(before[0]["sha256"], result["sheet"]["sha256"]);
    assert_eq!(before, listed(folder.path(), "modulus.ron", 0));

    let file = folder.file("hits-3.npy");
    let mut bytes = fs::read(&file).unwrap();
    *bytes.last_mut().unwrap() ^= 1; // a sign or an exponent of the last sample
    fs::write(&file, &bytes).unwrap();
    let after = listed(folder.path(), "modulus.ron", 0);
    assert_eq!(after[0]["sha256"], before[0]["sha256"]);
    assert_ne!(after[0]["key"], before[0]["key"]);
    fs::rename(&file, folder.file("hits-6.npy")).unwrap();
    assert_ne!(
        listed(folder.path(), "modulus.ron", 0)[0]["key"],
        after[0]["key"]
    );

    // a wrong sheet is listed with its error, together with the others
    folder.write("wrong.ron", "Force(title: 1)");
    let all = listed(folder.path(), "*.ron", 2);
    let tests: Vec<&str> = all
        .iter()
        .map(|one| one["test"].as_str().unwrap())
        .collect();
    assert_eq!(tests, ["modulus", "plan", "wrong"]);
    assert_eq!(all[1]["job"], "simulate");
    assert!(
        all[2]["error"]
            .as_str()
            .unwrap()
            .contains("wrong.ron:1:14: Force.title")
    );
    assert_eq!(all[2]["key"], Value::Null);
    let words = text(&folder.rodlab("list *.ron").stdout);
    words.must_say("wrong  wrong input: wrong.ron:1:14");
    words.must_say("modulus  modulus      5 files  ");
}
