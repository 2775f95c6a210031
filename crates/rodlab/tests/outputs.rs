//! The files of an outcome: their names, their bytes, and the documented structure of
//! `result.json`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use rodlab::output;
use rodlab::{Outcome, RodlabError};
use serde_json::Value;

use crate::rich;
use crate::runs::{Folder, Refused, Words};

fn write(outcome: &Outcome, folder: &Path) -> Result<Vec<PathBuf>, RodlabError> {
    output::write(outcome, &rich::sheet(), folder, &[])
}

fn refused(outcome: &Outcome, folder: &Path) -> String {
    write(outcome, folder).refused()
}

#[test]
fn every_part_has_its_file_and_the_result_is_the_last() {
    let folder = Folder::new();
    let files = write(&rich::outcome(), folder.path()).unwrap();
    let names: Vec<&str> = files
        .iter()
        .map(|path| path.file_name().unwrap().to_str().unwrap())
        .collect();
    insta::assert_snapshot!(names.join("\n"), @r"
    modulus.csv
    response.uff
    histories.svg
    response.svg
    modulus.svg
    cole-cole.svg
    hardly anything.svg
    report.html
    result.json
    ");
    let on_disk = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(on_disk, names.len(), "nothing else is left in the folder");
}

#[test]
fn a_result_that_cannot_be_put_there_leaves_the_earlier_one_whole() {
    let folder = Folder::new();
    let files = write(&rich::outcome(), folder.path()).unwrap();
    let mut outcome = rich::outcome();
    // a folder has the name of a file to be written
    outcome.attachments[0].name = "in the way".into();
    fs::create_dir(folder.file("in the way")).unwrap();
    let error = refused(&outcome, folder.path());
    error.must_begin("cannot write ");
    error.must_say("in the way: it exists");
    assert!(files.iter().all(|file| file.exists()));
}

#[test]
fn what_a_run_before_has_left_goes_and_nothing_else() {
    let folder = Folder::new();
    write(&rich::outcome(), folder.path()).unwrap();
    folder.write("notes.txt", "mine");
    // left-over files of an interrupted run
    folder.write(".rodlab-part-4711", "half");
    folder.write(".rodlab-lock", "process       4711\n\nhalf done.csv\n");
    folder.write("half done.csv", "1\n");
    let mut outcome = rich::outcome();
    outcome.attachments.clear();
    let files = write(&outcome, folder.path()).unwrap();
    let mut there: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    there.sort();
    let mut expected = files;
    expected.push(folder.file("notes.txt"));
    expected.sort();
    assert_eq!(there, expected);
}

#[test]
fn a_file_of_somebody_else_is_not_replaced() {
    let folder = Folder::new();
    let page = folder.file(output::REPORT);
    fs::write(&page, "a page of mine").unwrap();
    let error = refused(&rich::outcome(), folder.path());
    assert!(
        error.ends_with(
            "report.html: it exists and no earlier result lists it: choose another folder (--out), or move it away"
        ),
        "{error}"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    fs::remove_file(&page).unwrap();
    let files = write(&rich::outcome(), folder.path()).unwrap();
    // a file that the run has read is not replaced, even if an earlier result lists it as its own
    let read = &files[1..2];
    let again = output::write(&rich::outcome(), &rich::sheet(), folder.path(), read);
    let error = again.refused();
    error.must_say("response.uff: this run has read it");
}

#[test]
fn r19_a_result_of_another_program_opens_no_folder() {
    let listing = r#"{"result_version": 1, "files": ["hits.npy", "modulus.ron", "report.html", "modulus.csv"]"#;
    for result in [
        "{}".to_owned(),
        format!("{listing}}}"),
        format!("{listing}, \"software\": \"other 0.1.0\"}}"),
    ] {
        let folder = Folder::new();
        let names = ["result.json", "report.html", "hits.npy", "modulus.ron"];
        let contents = |name: &str| match name {
            "result.json" => result.clone(),
            name => format!("{name} of a laboratory"),
        };
        for name in names {
            folder.write(name, contents(name));
        }
        refused(&rich::outcome(), folder.path()).must_say("no earlier result lists it");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), names.len());
        for name in names {
            let there = folder.read(name);
            assert_eq!(there, contents(name), "{name}");
        }
    }
}

#[test]
fn r21_columns_that_differ_in_length_are_refused() {
    let mut outcome = rich::outcome();
    let column = rodlab::outcome::Column::numbers("one row", "", vec![1.0]);
    outcome.tables[0].columns.push(column);
    let folder = Folder::new();
    refused(&outcome, folder.path()).must_say("`one row` has 1 rows, expected ");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn r19_a_link_to_a_result_opens_no_folder() {
    let other = Folder::new();
    write(&rich::outcome(), other.path()).unwrap();
    let folder = Folder::new();
    let result = other.file(output::RESULT);
    std::os::unix::fs::symlink(result, folder.file(output::RESULT)).unwrap();
    folder.write("modulus.csv", "measured");
    let error = write(&rich::outcome(), folder.path()).unwrap_err();
    assert!(matches!(error, RodlabError::Taken { .. }), "{error}");
    let kept = folder.read("modulus.csv");
    assert_eq!(kept, "measured");
}

#[test]
fn no_file_takes_the_place_of_another() {
    let folder = Folder::new();
    let mut outcome = rich::outcome();
    outcome.figures[0].name = "modulus".into();
    let error = refused(&outcome, folder.path());
    assert_eq!(
        error,
        "writing the files of the result: two of them are called modulus.svg"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_result_has_the_documented_structure_and_the_structure_nothing_that_is_not_there() {
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/result.schema.json");
    let schema: Value = serde_json::from_str(&fs::read_to_string(schema).unwrap()).unwrap();
    let mut seen = BTreeSet::new();
    let mut outcome = rich::outcome();
    let in_doubt = rodlab::outcome::Verdict::InDoubt {
        reasons: vec!["the polarity check fails".into()],
    };
    let answered = rodlab::outcome::Verdict::Answered;
    for verdict in [outcome.verdict.clone(), in_doubt, answered] {
        outcome.verdict = verdict;
        let result: Value =
            serde_json::from_str(&output::json_of(&outcome, &rich::sheet()).unwrap()).unwrap();
        if let Err(wrong) = check(&result, &schema, &schema, "result", &mut seen) {
            panic!("{wrong}");
        }
    }
    let mut documented = BTreeSet::new();
    properties(&schema, "", &mut documented);
    let missing: Vec<&String> = documented.difference(&seen).collect();
    assert!(
        missing.is_empty(),
        "documented, but not in the result: {missing:?}"
    );
    assert_eq!(
        schema["properties"]["result_version"]["const"],
        output::RESULT_VERSION,
        "the version of the documentation"
    );
}

/// The part of JSON Schema that the documentation uses: `$ref`, `type`, `const`, `enum`,
/// `properties`, `required`, `additionalProperties`, `items`, `oneOf`, `minItems`, `maxItems`,
/// `pattern` by length. Any other keyword is an error.
fn check(
    value: &Value,
    schema: &Value,
    root: &Value,
    place: &str,
    seen: &mut BTreeSet<String>,
) -> Result<(), String> {
    let schema = schema.as_object().unwrap();
    for (key, says) in schema {
        match key.as_str() {
            "$schema" | "$defs" | "title" | "description" => {}
            "$ref" => {
                let pointer = says.as_str().unwrap().trim_start_matches('#');
                let target = root
                    .pointer(pointer)
                    .unwrap_or_else(|| panic!("{pointer} is missing"));
                check(value, target, root, place, seen)?;
            }
            "type" => {
                let kinds: Vec<&str> = match says {
                    Value::Array(kinds) => {
                        kinds.iter().map(|kind| kind.as_str().unwrap()).collect()
                    }
                    kind => vec![kind.as_str().unwrap()],
                };
                let is = |kind: &str| match kind {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    other => panic!("type {other}"),
                };
                if !kinds.iter().any(|kind| is(kind)) {
                    return Err(format!("{place} is {value}, documented as {says}"));
                }
            }
            "const" => {
                if value != says {
                    return Err(format!("{place} is {value}, documented as {says}"));
                }
            }
            "enum" => {
                if !says.as_array().unwrap().contains(value) {
                    return Err(format!("{place} is {value}, documented as one of {says}"));
                }
            }
            "oneOf" => {
                let alternatives = says.as_array().unwrap();
                let mut wrong = Vec::new();
                let mut fits = 0;
                for alternative in alternatives {
                    let mut here = BTreeSet::new();
                    match check(value, alternative, root, place, &mut here) {
                        Ok(()) => {
                            fits += 1;
                            seen.append(&mut here);
                        }
                        Err(why) => wrong.push(why),
                    }
                }
                if fits != 1 {
                    return Err(format!(
                        "{place} fits {fits} alternatives: {}",
                        wrong.join("; ")
                    ));
                }
            }
            "properties" => {
                let known = says.as_object().unwrap();
                for (name, part) in value.as_object().into_iter().flatten() {
                    let Some(part_schema) = known.get(name) else {
                        return Err(format!("{place}.{name} is not documented"));
                    };
                    seen.insert(id(part_schema));
                    check(part, part_schema, root, &format!("{place}.{name}"), seen)?;
                }
            }
            "required" => {
                for name in says.as_array().unwrap() {
                    if value.get(name.as_str().unwrap()).is_none() {
                        return Err(format!("{place} has no {name}"));
                    }
                }
            }
            "additionalProperties" => assert_eq!(says, false),
            "items" => {
                for (index, part) in value.as_array().into_iter().flatten().enumerate() {
                    check(part, says, root, &format!("{place}[{index}]"), seen)?;
                }
            }
            "minItems" | "maxItems" => {
                let found = value.as_array().map_or(0, Vec::len) as u64;
                let limit = says.as_u64().unwrap();
                if (key == "minItems" && found < limit) || (key == "maxItems" && found > limit) {
                    return Err(format!("{place} has {found} items, documented are {limit}"));
                }
            }
            other => panic!("the schema uses {other}, which this test does not check"),
        }
    }
    Ok(())
}

/// A property is identified by its description, which is unique.
fn id(schema: &Value) -> String {
    let words = schema["description"].as_str();
    words
        .unwrap_or_else(|| panic!("{schema} has no description"))
        .to_owned()
}

fn properties(schema: &Value, place: &str, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(parts) => {
            for (name, part) in parts {
                if place == "properties" {
                    assert!(found.insert(id(part)), "described twice: {}", id(part));
                }
                properties(part, if place == "properties" { "" } else { name }, found);
            }
        }
        Value::Array(parts) => {
            for part in parts {
                properties(part, "", found);
            }
        }
        _ => {}
    }
}
