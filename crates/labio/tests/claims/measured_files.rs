//! Every file beside the records: read whole, read but for a part that is named, or refused with the reason.

use std::path::{Path, PathBuf};
use std::{fs, io};

use labio::format::{self, Strictness};
use labio::{Contents, LabioError, Ordinate, Series};

use testbed::claim::{Check, Claim, Claims, NotMeasured, is_absent, refused};
use testbed::hold;

const SOURCE: &str = "description beside the records";

/// Files of a folder and how many of them, by the description, are whole, have a defect, or are to be refused.
struct Folder {
    name: &'static str,
    whole: f64,
    /// Junk at the end of a table, fewer rows than announced, times of three digits.
    with_defects: f64,
    /// Corrupt, or no data at all.
    refused: f64,
}

const FOLDERS: [Folder; 9] = [
    Folder {
        name: "hammer",
        whole: 6.0,
        with_defects: 0.0,
        refused: 0.0,
    },
    Folder {
        name: "lvm",
        whole: 4.0,
        with_defects: 2.0,
        refused: 0.0,
    },
    Folder {
        name: "shock",
        whole: 4.0,
        with_defects: 0.0,
        refused: 0.0,
    },
    Folder {
        name: "uff",
        whole: 8.0,
        with_defects: 0.0,
        refused: 0.0,
    },
    Folder {
        name: "tdms",
        whole: 1.0,
        with_defects: 1.0,
        refused: 0.0,
    },
    Folder {
        name: "shpb",
        whole: 0.0,
        with_defects: 1.0,
        refused: 1.0,
    },
    Folder {
        name: "dma",
        whole: 1.0,
        with_defects: 0.0,
        refused: 0.0,
    },
    Folder {
        name: "dma/glassy-polymer",
        whole: 0.0,
        with_defects: 22.0,
        refused: 0.0,
    },
    Folder {
        name: "tapered-rod",
        whole: 5.0,
        with_defects: 0.0,
        refused: 0.0,
    },
];

#[test]
fn claims_hold() {
    let data = testbed::measured::folder();
    hold!(report(data.as_deref()), "measured records");
}

fn report(data: Option<&Path>) -> Claims {
    let folder = data
        .ok_or_else(|| NotMeasured::Absent("no folder given (--data or RODLAB_DATA)".to_owned()));
    let mut report = Claims::default();
    for expected in &FOLDERS {
        let outcome = folder
            .clone()
            .and_then(|data| Outcome::of(&data.join(expected.name)));
        for (what, count, ours) in [
            (
                "read whole",
                expected.whole,
                outcome.as_ref().map(|o| o.whole),
            ),
            (
                "read but for a part that is named",
                expected.with_defects,
                outcome.as_ref().map(|o| o.with_defects),
            ),
            (
                "refused with the reason",
                expected.refused,
                outcome.as_ref().map(|o| o.refused),
            ),
        ] {
            let claim = counted(format!("files in {}: {what}", expected.name), count);
            report
                .checks
                .push(Check::of(claim, ours.map_err(Clone::clone)));
        }
    }
    let ours = |measure: fn(&Path) -> Result<f64, NotMeasured>| folder.clone().and_then(measure);
    let mut check = |what: &str, unit, expected, tolerance, tolerance_from, ours| {
        let claim = Claim {
            what: what.to_owned(),
            source: SOURCE,
            unit,
            expected,
            tolerance,
            tolerance_from,
        };
        report.checks.push(Check::of(claim, ours));
    };
    check(
        "universal files: text against binary, largest difference",
        "file's unit",
        0.0,
        5e-7,
        "the claim is an upper limit",
        ours(text_against_binary),
    );
    check(
        "measurement.uff: responses of 1001 lines, 1 Hz apart",
        "1",
        3.0,
        0.5,
        "a count",
        ours(|data| {
            Ok(contents(&data.join("uff/measurement.uff"))?
                .series
                .iter()
                .filter(|s| is_response(s))
                .count() as f64)
        }),
    );
    check(
        "good_tdms_1.tdms: channels",
        "1",
        8.0,
        0.5,
        "a count",
        ours(|data| Ok(contents(&data.join("tdms/good_tdms_1.tdms"))?.series.len() as f64)),
    );
    let column = |data: &Path,
                  file: &str,
                  name: &'static str,
                  pick: fn(f64, f64) -> f64,
                  first: usize|
     -> Result<f64, NotMeasured> {
        let contents = contents(&data.join(file))?;
        let values = real(&contents, name)?;
        let shown = if first == 0 {
            values
        } else {
            &values[..first.min(values.len())]
        };
        shown
            .iter()
            .copied()
            .reduce(pick)
            .ok_or_else(|| NotMeasured::Refused("no rows".to_owned()))
    };
    for (what, unit, expected, last_digit, file, name, pick, first) in [
        (
            "glassy polymer, 25 C: least storage modulus",
            "MPa",
            2721.0,
            1.0,
            "dma/glassy-polymer/T25.txt",
            "E'",
            f64::min as fn(f64, f64) -> f64,
            0,
        ),
        (
            "glassy polymer, 25 C: largest storage modulus",
            "MPa",
            2908.0,
            1.0,
            "dma/glassy-polymer/T25.txt",
            "E'",
            f64::max,
            0,
        ),
        (
            "glassy polymer, 25 C: least loss factor",
            "1",
            0.0135,
            1e-4,
            "dma/glassy-polymer/T25.txt",
            "tan_delta",
            f64::min,
            0,
        ),
        (
            "glassy polymer, 25 C: largest loss factor",
            "1",
            0.023,
            1e-3,
            "dma/glassy-polymer/T25.txt",
            "tan_delta",
            f64::max,
            0,
        ),
        (
            "tensile test, -50 C: least storage modulus",
            "MPa",
            8097.0,
            1.0,
            "dma/pyvisco_freq_user_raw.csv",
            "E_stor",
            f64::min,
            10,
        ),
        (
            "tensile test, -50 C: largest storage modulus",
            "MPa",
            9229.0,
            1.0,
            "dma/pyvisco_freq_user_raw.csv",
            "E_stor",
            f64::max,
            10,
        ),
    ] {
        let ours = folder
            .clone()
            .and_then(|data| column(data, file, name, pick, first));
        check(
            what,
            unit,
            expected,
            last_digit / 2.0,
            "half the last printed digit",
            ours,
        );
    }
    report
}

fn counted(what: String, expected: f64) -> Claim {
    Claim {
        what,
        source: SOURCE,
        unit: "1",
        expected,
        tolerance: 0.5,
        tolerance_from: "a count",
    }
}

struct Outcome {
    whole: f64,
    with_defects: f64,
    refused: f64,
}

impl Outcome {
    fn of(folder: &Path) -> Result<Self, NotMeasured> {
        let mut outcome = Self {
            whole: 0.0,
            with_defects: 0.0,
            refused: 0.0,
        };
        for path in files(folder)? {
            let slot = if format::read(&path).is_ok() {
                &mut outcome.whole
            } else if format::read_with(&path, Strictness::Tolerant)
                .is_ok_and(|contents| !contents.defects.is_empty())
            {
                &mut outcome.with_defects
            } else {
                &mut outcome.refused
            };
            *slot += 1.0;
        }
        Ok(outcome)
    }
}

/// The files of a folder, without its subfolders.
fn files(folder: &Path) -> Result<Vec<PathBuf>, NotMeasured> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(NotMeasured::Absent(format!(
                "{} does not exist",
                folder.display()
            )));
        }
        Err(error) => return Err(refused(&error)),
    };
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| refused(&error))?.path();
        if path.is_file() {
            paths.push(path);
        }
    }
    Ok(paths)
}

/// A file whose defects, if it has any, do not concern the columns that are asked for.
fn contents(path: &Path) -> Result<Contents, NotMeasured> {
    format::read_with(path, Strictness::Tolerant).map_err(|error: LabioError| {
        if is_absent(&error) {
            NotMeasured::Absent(format!("{} does not exist", path.display()))
        } else {
            refused(&error)
        }
    })
}

fn real<'a>(contents: &'a Contents, name: &str) -> Result<&'a [f64], NotMeasured> {
    let series = contents.series.iter().find(|series| series.name == name);
    match series.map(|series| &series.ordinate) {
        Some(Ordinate::Real(values)) => Ok(values),
        _ => Err(NotMeasured::Refused(format!(
            "no column {name} of real numbers"
        ))),
    }
}

fn is_response(series: &Series) -> bool {
    let one_hertz =
        matches!(series.abscissa, labio::Abscissa::Even { step, .. } if (step - 1.0).abs() < 1e-12);
    one_hertz && series.ordinate.len() == 1001 && matches!(series.ordinate, Ordinate::Complex(_))
}

fn text_against_binary(data: &Path) -> Result<f64, NotMeasured> {
    let [text, binary] = ["Sample_UFF58_ascii.uff", "Sample_UFF58b_bin.uff"]
        .map(|name| contents(&data.join("uff").join(name)));
    let (text, binary) = (text?, binary?);
    match (&text.series[..], &binary.series[..]) {
        ([a], [b]) if a.ordinate.len() == b.ordinate.len() => match (&a.ordinate, &b.ordinate) {
            (Ordinate::Real(a), Ordinate::Real(b)) => Ok(a
                .iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)),
            _ => Err(NotMeasured::Refused("no real numbers".to_owned())),
        },
        _ => Err(NotMeasured::Refused(
            "not one series of one length in each".to_owned(),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::claim::Verdict;

    #[test]
    fn without_records_every_check_is_skipped_and_listed() {
        for data in [None, Some(Path::new("no such folder"))] {
            let report = report(data);
            let total = 3 * FOLDERS.len() + 9;
            assert_eq!(
                (report.checks.len(), report.count(Verdict::Skipped)),
                (total, total)
            );
        }
    }
}
