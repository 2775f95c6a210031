//! Every file in the folder of measured records: read completely, read except for a named part, or
//! rejected with the reason.

use std::fs;
use std::path::{Path, PathBuf};

use labio::format::{self, Strictness};
use labio::{Contents, Ordinate};

use testbed::claim::{Check, Claim, Claims, NotMeasured, Ours, unread};
use testbed::difference::largest_difference;
use testbed::hold;

const SOURCE: &str = "description supplied with the records";

/// Folder, and the numbers of its files that, according to the description, are intact; have a
/// defect (junk at the end of a table, fewer rows than announced, times of three digits); or are
/// corrupt or without data.
const FOLDERS: [(&str, [usize; 3]); 9] = [
    ("hammer", [6, 0, 0]),
    ("lvm", [4, 2, 0]),
    ("shock", [4, 0, 0]),
    ("uff", [8, 0, 0]),
    ("tdms", [1, 1, 0]),
    ("shpb", [0, 1, 1]),
    ("dma", [1, 0, 0]),
    ("dma/glassy-polymer", [0, 22, 0]),
    ("tapered-rod", [5, 0, 0]),
];

#[test]
fn claims_hold() {
    let data = testbed::measured::folder();
    hold!(report(data.as_deref()), "measured records");
}

fn report(data: Option<&Path>) -> Claims {
    let folder = data.ok_or_else(|| NotMeasured::Absent("no folder of records".to_owned()));
    let mut report = Claims::default();
    let mut check = |what: &str, unit, expected, (tolerance, why), ours| {
        let claim = Claim::new(what, SOURCE).expects(expected, unit);
        report
            .checks
            .push(Check::of(claim.within(tolerance, why), ours));
    };
    check(
        "files of nine folders: numbers of files read completely, read except for a named part, and rejected",
        "counts that differ, of 27",
        0.0,
        (0.0, "exact"),
        folder.clone().and_then(counts_that_differ),
    );
    check(
        "universal files: text against binary, largest difference",
        "file's unit",
        0.0,
        (5e-7, "the claim is an upper limit"),
        folder.clone().and_then(text_against_binary),
    );
    let polymer = "dma/glassy-polymer/T25.txt";
    let tension = "dma/pyvisco_freq_user_raw.csv";
    for (what, unit, [least, greatest], last_digit, file, column, rows) in [
        (
            "glassy polymer, 25 C: storage modulus",
            "MPa",
            [2721.0, 2908.0],
            [1.0; 2],
            polymer,
            "E'",
            usize::MAX,
        ),
        (
            "glassy polymer, 25 C: loss factor",
            "1",
            [0.0135, 0.023],
            [1e-4, 1e-3],
            polymer,
            "tan_delta",
            usize::MAX,
        ),
        (
            "tensile test, -50 C: storage modulus",
            "MPa",
            [8097.0, 9229.0],
            [1.0; 2],
            tension,
            "E_stor",
            10,
        ),
    ] {
        let found = |pick: fn(f64, f64) -> f64| {
            let values = real(&folder.clone()?.join(file), column, unit)?;
            let picked = values.into_iter().take(rows).reduce(pick);
            picked.ok_or_else(|| NotMeasured::Refused("no rows".to_owned()))
        };
        let why = "half the last printed digit";
        check(
            &format!("{what}, smallest value"),
            unit,
            least,
            (last_digit[0] / 2.0, why),
            found(f64::min),
        );
        check(
            &format!("{what}, largest value"),
            unit,
            greatest,
            (last_digit[1] / 2.0, why),
            found(f64::max),
        );
    }
    report
}

fn counts_that_differ(data: &Path) -> Ours {
    let mut differ = 0.0;
    for (folder, expected) in FOLDERS {
        let mut found = [0; 3];
        for path in files(&data.join(folder))? {
            let outcome = match format::read(&path) {
                Ok(_) => 0,
                Err(_) => match format::read_with(&path, Strictness::Tolerant) {
                    Ok(contents) if !contents.defects.is_empty() => 1,
                    _ => 2,
                },
            };
            found[outcome] += 1;
        }
        if found != expected {
            eprintln!("{folder}: {found:?}, expected {expected:?}");
        }
        let pairs = found.iter().zip(&expected);
        differ += pairs.filter(|(found, expected)| found != expected).count() as f64;
    }
    Ok(differ)
}

/// The files of a folder, without its subfolders.
fn files(folder: &Path) -> Ours<Vec<PathBuf>> {
    let absent = |error: std::io::Error| unread(folder, &error);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(absent)? {
        paths.push(entry.map_err(absent)?.path());
    }
    paths.retain(|path| path.is_file());
    Ok(paths)
}

/// Contents of a file whose defects, if any, do not affect the requested columns.
fn contents(path: &Path) -> Ours<Contents> {
    format::read_with(path, Strictness::Tolerant).map_err(|error| unread(path, &error))
}

/// A column of real numbers, with its unit if the file states one.
fn real(path: &Path, name: &str, unit: &str) -> Ours<Vec<f64>> {
    let columns = contents(path)?.series;
    let mut named = columns.into_iter().filter(|series| series.name == name);
    match named
        .next()
        .map(|series| (series.ordinate_axis.unit_text, series.ordinate))
    {
        Some((stated, Ordinate::Real(values))) if unit == "1" || stated == unit => Ok(values),
        _ => Err(NotMeasured::Refused(format!(
            "no column {name} of real numbers in {unit}"
        ))),
    }
}

fn text_against_binary(data: &Path) -> Ours {
    let read = |name: &str| {
        let mut series = contents(&data.join("uff").join(name))?.series;
        match series.pop().map(|series| series.ordinate) {
            Some(Ordinate::Real(values)) => Ok(values),
            _ => Err(NotMeasured::Refused(format!("no real numbers in {name}"))),
        }
    };
    let (text, binary) = (
        read("Sample_UFF58_ascii.uff")?,
        read("Sample_UFF58b_bin.uff")?,
    );
    Ok(largest_difference(&text, &binary))
}

#[test]
fn without_records_every_check_is_skipped_and_listed() {
    use testbed::claim::Verdict;
    for data in [None, Some(Path::new("no such folder"))] {
        let report = report(data);
        assert_eq!(
            (report.checks.len(), report.count(Verdict::Skipped)),
            (8, 8)
        );
    }
}
