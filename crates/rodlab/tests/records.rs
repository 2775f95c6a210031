//! Calibrated records from files: missing information comes from the sheet, and unsuitable files
//! are reported.

mod separate_files;

use std::fs;
use std::path::Path;

use labio::format::{self, uff58::Uff58Writer};
use labio::{Abscissa, Contents, Ordinate, Quantity, Series, SeriesAxis, SeriesKind, Unit};
use rodlab::records::{Loaded, Records};

use crate::runs::{Folder, Words, without_formats, write_npy};

fn records(text: &str) -> Records {
    use ron::extensions::Extensions;
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES)
        .from_str(text)
        .unwrap()
}

fn load(folder: &Path, text: &str) -> Result<Loaded, String> {
    records(text)
        .load(folder, "records")
        // the path of the folder differs from run to run
        .map_err(|error| {
            error
                .to_string()
                .replace(&folder.display().to_string(), "FOLDER")
        })
}

fn refusals(folder: &Path, sheets: &[&str]) -> String {
    let said: Vec<String> = sheets
        .iter()
        .map(|text| load(folder, text).unwrap_err())
        .collect();
    said.join("\n")
}

pub(crate) fn series(name: &str, unit: &str, step: f64, values: &[f64]) -> Series {
    let axis = |unit: &str| SeriesAxis {
        label: String::new(),
        unit_text: unit.to_owned(),
        unit: Unit::parse(unit).ok(),
    };
    Series {
        name: name.to_owned(),
        kind: SeriesKind::TimeResponse,
        abscissa: Abscissa::Even { start: 0.0, step },
        ordinate: Ordinate::Real(values.to_vec()),
        abscissa_axis: axis("s"),
        ordinate_axis: axis(unit),
        properties: Vec::new(),
    }
}

#[test]
fn volts_of_an_array_become_quantities_by_what_the_sheet_says() {
    let folder = Folder::new();
    for (name, scale) in [("b.npy", 2.0), ("a.npy", 1.0)] {
        write_npy(
            &folder.file(name),
            // the sheet does not use the first row
            &[
                &[0.0, 1.0, 2.0, 3.0],
                &[0.0, 0.5 * scale, 0.25, 0.0],
                &[1.0, 1.0, 2.0 * scale, 1.0],
            ],
        );
    }
    let loaded = load(
        folder.path(),
        r#"(
            files: ["*.npy"],
            sampling_rate: "8 kHz",
            channels: [
                (name: "end A", from: 3, unit: "V", sensitivity: "100 mV/g", inverted: true, offset: 1.0),
                (name: "hammer", from: 2, unit: "V", sensitivity: "2 mV/N ± 1 %"),
            ],
        )"#,
    )
    .unwrap();
    let names: Vec<&str> = loaded.records.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["a.npy", "b.npy"]);
    let record = &loaded.records[1].record;
    assert_eq!(record.channels()[0].name(), "end A");
    assert_eq!(record.channels()[1].quantity(), Quantity::Force);
    // 1 V divided by 2 mV/N, and -(4 - 1) V divided by 100 mV/g, with two roundings each
    assert!((record.channel("hammer").unwrap()[1] / 500.0 - 1.0).abs() < 1e-15);
    assert!((record.channel("end A").unwrap()[2] / (-30.0 * 9.80665) - 1.0).abs() < 1e-15);
    assert!((record.sampling_rate_hz() - 8000.0).abs() < 1e-9);
    assert_eq!(loaded.inputs.len(), 2);
    assert_eq!(loaded.inputs[0].format, "npy");
    assert_ne!(loaded.inputs[0].sha256, loaded.inputs[1].sha256);
    assert!(loaded.warnings.is_empty());
}

#[test]
fn what_an_array_does_not_tell_is_asked_for() {
    let folder = Folder::new();
    write_npy(
        &folder.file("hit.npy"),
        &[&[0.0, 1.0, 2.0, 3.0], &[0.0, 0.5, f64::NAN, 0.0]],
    );
    let said = refusals(
        folder.path(),
        &[
            r#"(files: ["hit.npy"], channels: [(name: "hammer", from: 1, unit: "V")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 1)])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 3, unit: "V")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 0, unit: "V")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 1, unit: "furlong")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 2, unit: "V")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 1, unit: "V", sensitivity: "2 pC/N")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "hammer", from: 1, unit: "V", sensitivity: "-2 mV/N")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [(name: "a", from: 1, unit: "V"), (name: "a", from: 2, unit: "V")])"#,
            r#"(files: ["hit.npy"], sampling_rate: "1 kHz", channels: [])"#,
            r#"(files: [], channels: [(name: "hammer", from: 1)])"#,
        ],
    );
    insta::assert_snapshot!(said, @r#"
    records.sampling_rate is not stated, expected the sampling rate, such as "51.2 kHz": hit.npy does not state it
    records.channels[0].unit is not stated, expected the unit of the samples, such as "V": hit.npy does not state it
    records.channels[0].from is channel 3, expected a number from 1 to 2 (hit.npy)
    records.channels[0].from is channel 0, expected a number from 1 to 2 (hit.npy)
    records.channels[0].unit: `furlong` is not a known unit: `furlong` is not among the known symbols
    records.channels[0], hit.npy: series 1 (`[1, :]`) is not a channel of a record: its ordinate is NaN at sample 2, expected finite
    records.channels[0], hit.npy: the record is in V, expected C for a sensitivity in pC/N: with a charge amplifier, state its gain, such as "10 mV/pC"
    records.channels[0].sensitivity is -2 mV/N, expected a value above 0: state `inverted` as true for a sensor that points the other way
    records.channels[1].name is `a`, expected a name other than that of channels[0]
    records.channels is empty, expected at least one channel
    records.files is empty, expected the name of at least one file; if each channel has files of its own, state `files` in every channel
    "#);
}

#[test]
fn a_hit_with_a_lost_sample_is_left_out_and_said_so() {
    let folder = Folder::new();
    for (name, sample) in [("a.npy", 0.5), ("b.npy", f64::INFINITY), ("c.npy", 0.25)] {
        let path = folder.file(name);
        write_npy(&path, &[&[0.0, 1.0, 2.0], &[0.0, sample, 0.0]]);
    }
    let sheet = r#"(files: ["*.npy"], sampling_rate: "1 kHz", channels: [
        (name: "hammer", from: 1, unit: "N"), (name: "end A", from: 2, unit: "m/s^2"),
    ])"#;
    let loaded = load(folder.path(), sheet).unwrap();
    let names: Vec<&str> = loaded.records.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["a.npy", "c.npy"]);
    // a file that is left out is listed among the inputs, too
    assert_eq!(loaded.inputs.len(), 3);
    assert_eq!(loaded.left_out.len(), 1);
    assert!(!loaded.left_out[0].accepted && loaded.left_out[0].what == "b.npy");
    insta::assert_snapshot!(loaded.warnings.join("\n"), @r"b.npy is left out: series 1 (`[1, :]`) is not a channel of a record: its ordinate is inf at sample 1, expected finite.");
}

#[test]
fn a_file_that_is_missing_or_of_no_known_format_is_named() {
    let folder = Folder::new();
    folder.write("notes.bin", b"\x7fELF\x02\x01 and so on");
    let sheet = |files: &str| {
        format!(r#"(files: [{files}], channels: [(name: "hammer", from: 1, unit: "N")])"#)
    };
    let said = refusals(
        folder.path(),
        &[
            &sheet("\"hits/*.csv\""),
            &sheet("\"notes.bin\""),
            &sheet("\"[a.csv\""),
        ],
    );
    insta::assert_snapshot!(without_formats(&said), @r#"
    no file matches `hits/*.csv` in FOLDER (records.files)
    reading notes.bin: the 16 bytes that begin with "\u{7f}ELF\u{2}\u{1} and so on" are not in a known format (FORMATS)
    records.files is `[a.csv`: invalid range pattern, expected a name or a pattern
    "#);
}

#[test]
fn what_a_file_tells_is_believed_and_contradictions_are_said() {
    let folder = Folder::new();
    // 1/1024 s, rounded as a recorder does
    folder.write(
        "hit.csv",
        "Time (s),hammer (N),end A (g)\n0,0,0\n0.000977,40,1\n0.001954,10,2\n0.002931,0,1\n",
    );
    let loaded = load(
        folder.path(),
        r#"(files: ["hit.csv"], sampling_rate: "1024 Hz", channels: [
            (name: "force", from: "hammer"), (name: "a", from: "end A", unit: "V"),
        ])"#,
    )
    .unwrap();
    let record = &loaded.records[0].record;
    assert!((record.sampling_rate_hz() - 1024.0).abs() < 1e-9);
    assert!((record.channel("a").unwrap()[2] - 2.0).abs() < 1e-15);
    insta::assert_snapshot!(loaded.warnings.join("\n"), @"hit.csv states `end A` in g; the unit of the sheet is used instead, V.");
    folder.write(
        "next.csv",
        "Time (s),hammer (N),end A (g)\n0,0,0\n0.000977,41,1\n0.001954,10,2\n0.002931,0,1\n",
    );
    let both = r#"(files: ["*.csv"], sampling_rate: "1024 Hz", channels: [(name: "a", from: "end A", unit: "V")])"#;
    let loaded = load(folder.path(), both).unwrap();
    insta::assert_snapshot!(loaded.warnings.join("\n"), @"2 files, the first of them hit.csv, state `end A` in g; the unit of the sheet is used instead, V.");
    let said = refusals(
        folder.path(),
        &[
            r#"(files: ["hit.csv"], sampling_rate: "2048 Hz", channels: [(name: "force", from: "hammer")])"#,
            r#"(files: ["hit.csv"], channels: [(name: "force", from: "hamer")])"#,
            r#"(files: ["hit.csv"], channels: [(name: "force", from: 3)])"#,
            r#"(files: ["hit.csv"], sampling_rate: "1024 Hz", channels: [(name: "a", from: "end A", unit: "m/s2")])"#,
            r#"(files: ["hit.csv"], sampling_rate: "1024 Hz", channels: [(name: "a", from: "hammer", unit: "strain")])"#,
        ],
    );
    insta::assert_snapshot!(said, @r"
    records.sampling_rate is 2048 Hz, expected 1023.54 Hz, as stated in hit.csv, or the field left out
    records.channels[0].from is `hamer`, expected one of `hammer`, `end A` (hit.csv)
    records.channels[0].from is channel 3, expected a number from 1 to 2 (hit.csv); the column of times is not counted: channel 1 is the first column after it
    records.channels[0].unit is m/s2, expected `g`, as stated in hit.csv, or the field left out; if the unit of the file is wrong, correct it by `gain`
    records.channels[0].unit is a strain of 40.0 (hit.csv), expected at most 10: microstrain is `um/m`
    ");
}

/// Times with so few digits that they repeat, and times in an unknown unit: the message asks for
/// the sampling rate.
#[test]
fn rounded_times_ask_for_the_sampling_rate() {
    let folder = Folder::new();
    let rows = (0..500_u32).map(|k| format!("{:.4},{}\n", f64::from(k) / 51_200.0, k % 7));
    let text = "Time (s),hammer\n".to_owned() + &rows.collect::<String>();
    folder.write("hit.csv", text);
    folder.write("unit.csv", "Time (sek),hammer\n0,0\n0.001,1\n0.002,0\n");
    let sheet = |file: &str, rate: &str| {
        format!(r#"(files: ["{file}"],{rate} channels: [(name: "f", from: 1, unit: "N")])"#)
    };
    let said = refusals(folder.path(), &[&sheet("hit.csv", "")]);
    said.must_begin("records.sampling_rate is not stated, expected the sampling rate, such as \"51.2 kHz\", that gives all times within half a step: the times of hit.csv are rounded (repeated values; ");
    insta::assert_snapshot!(refusals(folder.path(), &[&sheet("unit.csv", "")]), @r#"records.sampling_rate is not stated, expected the sampling rate, such as "51.2 kHz": unit.csv has times in `sek`, which is not a known unit; in s they give 1000 Hz"#);
    let loaded = load(
        folder.path(),
        &sheet("hit.csv", r#" sampling_rate: "51.2 kHz","#),
    )
    .unwrap();
    assert!((loaded.records[0].record.sampling_rate_hz() - 51_200.0).abs() < 1e-6);
}

#[test]
fn the_rate_in_a_variable_is_used_and_said() {
    let folder = Folder::new();
    let text = "# Created by Octave 8.4.0\n# name: fs\n# type: scalar\n51200\n\n\n\
                # name: hammer\n# type: matrix\n# rows: 4\n# columns: 1\n 0\n 40\n 10\n 0\n";
    folder.write("hit.mat", text);
    let sheet = |rate: &str| {
        format!(r#"(files: ["hit.mat"],{rate} channels: [(name: "f", from: "hammer", unit: "N")])"#)
    };
    let loaded = load(folder.path(), &sheet("")).unwrap();
    assert!((loaded.records[0].record.sampling_rate_hz() - 51_200.0).abs() < 1e-6);
    insta::assert_snapshot!(loaded.warnings.join("\n"), @"hit.mat states the sampling rate only as the variable `fs`, in Hz; state `sampling_rate` in the sheet to confirm it.");
    let confirmed = load(folder.path(), &sheet(r#" sampling_rate: "51.2 kHz","#)).unwrap();
    assert!(confirmed.warnings.is_empty(), "{:?}", confirmed.warnings);
    let said = refusals(folder.path(), &[&sheet(r#" sampling_rate: "48 kHz","#)]);
    insta::assert_snapshot!(said, @"records.sampling_rate is 48 kHz, expected 51200 Hz, as stated in hit.mat (variable `fs`, in Hz), or the field left out; if the variable is wrong, save the file without it");
}

#[test]
fn a_universal_file_holds_many_hits_and_a_lost_channel_does_not_shift_them() {
    let folder = Folder::new();
    let hit = |peak: f64| {
        [
            series("hammer", "N", 1e-3, &[0.0, peak, 0.0]),
            series("end A", "m/s^2", 1e-3, &[0.0, 2.0 * peak, 1.0]),
            series("temperature", "V", 1e-1, &[3.0, 3.0]),
        ]
    };
    let write = |name: &str, series: Vec<Series>| {
        let mut contents = Contents::of_format("test");
        contents.series = series;
        format::write(folder.file(name), &contents, &Uff58Writer::default()).unwrap();
    };
    write("hits.uff", [hit(1.0), hit(2.0), hit(3.0)].concat());
    let sheet = |file: &str, from: &str| {
        format!(
            r#"(files: ["{file}"], channels: [(name: "f", from: "hammer"), (name: "a", from: {from})])"#
        )
    };
    for from in ["\"end A\"", "2"] {
        let loaded = load(folder.path(), &sheet("hits.uff", from)).unwrap();
        assert_eq!(loaded.records.len(), 3);
        assert_eq!(loaded.records[2].name, "hits.uff, record 3");
        for (named, peak) in loaded.records.iter().zip([1.0, 2.0, 3.0]) {
            let of = |name| named.record.channel(name).unwrap()[1];
            assert!((of("f") - peak).abs() < 1e-15 && (of("a") - 2.0 * peak).abs() < 1e-15);
        }
    }
    let mut lost = [hit(1.0), hit(2.0), hit(3.0)].concat();
    lost[4].ordinate = Ordinate::Real(vec![0.0, f64::NAN, 0.0]);
    // only a binary file can contain NaN
    let mut contents = Contents::of_format("test");
    contents.series = lost;
    let binary = Uff58Writer {
        encoding: format::uff58::Encoding::Binary(format::uff58::ByteOrder::LittleEndian),
        ..Uff58Writer::default()
    };
    format::write(folder.file("lost.uff"), &contents, &binary).unwrap();
    let mut short = [hit(1.0), hit(2.0)].concat();
    short.remove(1);
    write("short.uff", short);
    let said = refusals(
        folder.path(),
        &[
            &sheet("lost.uff", "\"end A\""),
            &sheet("short.uff", "\"end A\""),
            &sheet("hits.uff", "\"temperature\""),
        ],
    );
    insta::assert_snapshot!(said, @r"
    records.channels[1], lost.uff: series 4 (`end A`) is not a channel of a record: its ordinate is NaN at sample 1, expected finite
    records.channels[1].from is `end A`, expected a channel on the time axis of `hammer` (short.uff, record 2)
    records.channels[1].from is `temperature`, expected a channel on the time axis of `hammer` (hits.uff, record 1)
    ");
}

#[test]
fn a_name_of_several_points_is_asked_to_be_exact() {
    let folder = Folder::new();
    let at = |node: &str| {
        let mut one = series("acceleration", "m/s^2", 1e-3, &[0.0, 1.0, 0.5]);
        one.properties = vec![
            ("uff58.response_node".to_owned(), node.to_owned()),
            ("uff58.response_direction".to_owned(), "1".to_owned()),
        ];
        one
    };
    let mut contents = Contents::of_format("test");
    contents.series = vec![at("1"), at("2"), at("1"), at("2")];
    format::write(folder.file("h.uff"), &contents, &Uff58Writer::default()).unwrap();
    let sheet =
        |from: &str| format!(r#"(files: ["h.uff"], channels: [(name: "a", from: {from})])"#);
    for exact in ["\"acceleration 2+X\"", "2"] {
        assert_eq!(load(folder.path(), &sheet(exact)).unwrap().records.len(), 2);
    }
    let said = refusals(folder.path(), &[&sheet("\"acceleration\"")]);
    insta::assert_snapshot!(said, @r"records.channels[0].from is `acceleration`, which belongs to several points, expected one of `acceleration 1+X`, `acceleration 2+X` (h.uff)");
}

/// A table states the names of its columns and its sampling; sheets that contradict it are refused.
#[test]
fn names_and_times_of_the_file_contradict_no_sheet() {
    let folder = Folder::new();
    let rows = |head: &str, step: f64| {
        let rows = (0..40_u32).map(|n| format!("{},{},{}\n", f64::from(n) * step, n % 7, n % 5));
        format!("{head}\n{}", rows.collect::<String>())
    };
    let write = |name: &str, text: String| folder.write(name, text);
    write("hit.csv", rows("time,struck,force", 1e-3));
    let sheet = |rate: &str, channels: &str| {
        format!(r#"(files: ["hit.csv"], sampling_rate: "{rate}", channels: [{channels}])"#)
    };
    let first = r#"(name: "input", from: 1, unit: "N")"#;
    insta::assert_snapshot!(refusals(
        folder.path(),
        &[
            &sheet(
                "1 kHz",
                r#"(name: "Force", from: 1, unit: "N"), (name: "struck", from: 2, unit: "m/s2")"#
            ),
            &sheet("1.2 kHz", first),
            r#"(files: ["hit.csv"], channels: [(name: "input", from: 1, unit: "N")])"#,
        ]
    ));
    // accepted: sheets that agree with the file, with the right names or with the rate of times in
    // ms
    for sheet in [
        sheet(
            "1 kHz",
            r#"(name: "Force", from: 2, unit: "N"), (name: "struck", from: 1, unit: "m/s2")"#,
        ),
        sheet("1 MHz", first),
    ] {
        load(folder.path(), &sheet).unwrap();
    }
}
