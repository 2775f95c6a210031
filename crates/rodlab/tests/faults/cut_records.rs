//! Recordings that end too early.

use std::fs;
use std::path::Path;

use labio::Ordinate;
use labio::format;
use serde_json::Value;

use super::folder::files_in;
use super::program::{rodlab, run};
use super::record_files::{RecordFile, all, at_end_of_line};
use super::tally::{Came, Extent, Row};
use crate::runs::Folder;

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for file in all() {
        let mut points: Vec<usize> = (0..file.bytes.len()).step_by(10).collect();
        points.push(file.bytes.len());
        let points = extent.of(&points, 6);
        let folder = Folder::new();
        for (command, judge) in [("inspect", inspected as Judge), ("convert", converted)] {
            let whole = judge(&file, file.bytes.len(), folder.path(), None);
            let Judged::Whole(whole) = whole else {
                panic!("{} is not read when it is whole: {whole:?}", file.name);
            };
            rows.push(Row::of(
                format!("cut {}, `rodlab {command}`", file.name),
                "every tenth byte, and the end",
                &points,
                |&cut| match judge(&file, cut, folder.path(), Some(&whole)) {
                    Judged::Came(came) => came,
                    Judged::Whole(_) => Came::Right,
                },
            ));
        }
    }
    rows.push(in_a_job("npy", extent));
    rows.push(in_a_job("csv", extent));
    rows
}

#[derive(Debug)]
enum Judged {
    /// Values that were read, if there are no expected values to compare them with.
    Whole(Value),
    Came(Came),
}

type Judge = fn(&RecordFile, usize, &Path, Option<&Value>) -> Judged;

/// Judges the output of `inspect`, which skips unreadable parts, for the first `cut` bytes.
fn inspected(file: &RecordFile, cut: usize, folder: &Path, whole: Option<&Value>) -> Judged {
    let name = format!("inspected-{cut}.{}", file.ending);
    let bytes = &file.bytes[..cut];
    fs::write(folder.join(&name), bytes).unwrap();
    let ran = run(&mut rodlab(folder, &["inspect", &name, "--json"]));
    fs::remove_file(folder.join(&name)).unwrap();
    if let Some(broke) = ran.broke() {
        return Judged::Came(broke);
    }
    if ran.status != Some(0) {
        return Judged::Came(ran.refused());
    }
    let found: Value = serde_json::from_slice(&ran.out).unwrap();
    let said = !found["defects"].as_array().unwrap().is_empty() || says_so(&found["suspicions"]);
    let series = found["series"].clone();
    Judged::Came(match whole {
        None => return Judged::Whole(series),
        Some(whole) if *whole == series && (!said || cut < file.bytes.len()) => Came::Right,
        Some(_) if said => Came::Said,
        Some(_) if (file.is_whole_at)(bytes) => Came::Shorter,
        Some(_) => Came::Lost(format!(
            "{cut} bytes of {} were accepted as the whole file",
            file.name
        )),
    })
}

/// Judges the output of `convert`, which refuses unreadable parts, for the first `cut` bytes.
fn converted(file: &RecordFile, cut: usize, folder: &Path, whole: Option<&Value>) -> Judged {
    let [name, output] = [file.ending, "npz"].map(|ending| format!("converted-{cut}.{ending}"));
    let output = output.replace("converted", "new");
    let bytes = &file.bytes[..cut];
    fs::write(folder.join(&name), bytes).unwrap();
    let ran = run(&mut rodlab(folder, &["convert", &name, &output, "--json"]));
    fs::remove_file(folder.join(&name)).unwrap();
    if let Some(broke) = ran.broke() {
        return Judged::Came(broke);
    }
    let there = folder.join(&output);
    if ran.status != Some(0) {
        return Judged::Came(match ran.refused() {
            Came::Refused if there.exists() => Came::Lost(format!("{output} is there")),
            came => came,
        });
    }
    let found: Value = serde_json::from_slice(&ran.out).unwrap();
    let numbers = numbers_in(&there);
    fs::remove_file(there).unwrap();
    Judged::Came(match whole {
        None => return Judged::Whole(numbers),
        Some(whole) if *whole == numbers => Came::Right,
        Some(_) if says_so(&found["warnings"]) => Came::Said,
        Some(whole) if (file.is_whole_at)(bytes) && begins_with(whole, &numbers) => Came::Shorter,
        Some(_) => Came::Lost(format!(
            "{cut} bytes of {} were accepted as the whole file",
            file.name
        )),
    })
}

fn says_so(sentences: &Value) -> bool {
    let sentences = sentences.as_array().unwrap();
    sentences
        .iter()
        .any(|sentence| sentence.as_str().unwrap().contains("was cut short"))
}

/// Bit patterns of all numbers in a file, one list for each data set.
fn numbers_in(path: &Path) -> Value {
    let contents = format::read(path).unwrap();
    let bits = |series: &labio::Series| -> Vec<u64> {
        match &series.ordinate {
            Ordinate::Real(values) => values.iter().map(|x| x.to_bits()).collect(),
            Ordinate::Complex(values) => {
                let parts = values.iter().flat_map(|z| [z.re, z.im]);
                parts.map(f64::to_bits).collect()
            }
        }
    };
    let sets: Vec<Vec<u64>> = contents.series.iter().map(bits).collect();
    serde_json::to_value(sets).unwrap()
}

/// Returns true if every data set of `shorter` is the beginning of that of `whole`.
fn begins_with(whole: &Value, shorter: &Value) -> bool {
    let (whole, shorter) = (whole.as_array().unwrap(), shorter.as_array().unwrap());
    whole.len() >= shorter.len()
        && whole.iter().zip(shorter).all(|(whole, shorter)| {
            whole
                .as_array()
                .unwrap()
                .starts_with(shorter.as_array().unwrap())
        })
}

/// Runs a modulus from five hits, the first of which is cut at a hundred places.
fn in_a_job(ending: &str, extent: Extent) -> Row {
    let folder = Folder::of_example("frame");
    let sheet = folder.file("modulus.ron");
    for number in 1..=5 {
        let [from, to] = ["npy", ending].map(|ending| format!("strains-{number}.{ending}"));
        if from != to {
            let ran = run(&mut rodlab(
                folder.path(),
                &["convert", &from, &to, "--quiet"],
            ));
            assert_eq!(ran.status, Some(0), "{}", ran.err);
        }
    }
    let text = fs::read_to_string(&sheet).unwrap();
    fs::write(&sheet, text.replace("*.npy", &format!("*.{ending}"))).unwrap();
    let record = folder.bytes(format!("strains-1.{ending}"));
    let files = files_in(folder.path());
    let result = |cut: usize| {
        let folder = Folder::new();
        super::folder::put(folder.path(), &files);
        let path = folder.file(format!("strains-1.{ending}"));
        fs::write(path, &record[..cut]).unwrap();
        let arguments = ["modulus", "modulus.ron", "--json", "--out", "out"];
        let ran = run(&mut rodlab(folder.path(), &arguments));
        let there = folder.has("out/result.json");
        (ran, there)
    };
    let of = |out: &[u8]| -> Value { serde_json::from_slice(out).unwrap() };
    let whole = of(&result(record.len()).0.out)["quantities"].clone();
    let points: Vec<usize> = (0..=100).map(|part| record.len() * part / 100).collect();
    Row::of(
        format!("cut {ending} record of a modulus, `rodlab modulus`"),
        "every hundredth part, and the end",
        &extent.of(&points, 3),
        |&cut| {
            let (ran, there) = result(cut);
            if let Some(broke) = ran.broke() {
                return broke;
            }
            if ran.status != Some(0) {
                return match ran.refused() {
                    Came::Refused if there != (ran.status == Some(1)) => {
                        Came::Lost("a result that was refused".to_owned())
                    }
                    came => came,
                };
            }
            let result = of(&ran.out);
            let rejected = || {
                let log = result["log"].as_array().unwrap();
                log.iter().any(|entry| {
                    entry["accepted"] == false
                        && entry["what"].as_str().unwrap().contains("strains-1")
                })
            };
            if result["quantities"] == whole {
                Came::Right
            } else if says_so(&result["warnings"]) || rejected() {
                Came::Said
            } else if ending == "csv" && at_end_of_line(&record[..cut]) {
                Came::Shorter
            } else {
                Came::Lost(format!("a modulus of {cut} bytes of strains-1.{ending}"))
            }
        },
    )
}
