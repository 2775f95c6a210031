//! Hits whose channels are in separate files, paired by the text in place of the wildcards.

use rodlab::Outcome;
use rodlab::outcome::Cells;

use super::*;
use crate::runs::Folder;

/// A sheet of records with a force and an acceleration from the files of these lists.
fn pair(of_force: &str, of_motion: &str) -> String {
    format!(
        r#"(sampling_rate: "1 kHz", channels: [
            (name: "force", files: [{of_force}], from: 1, unit: "N"),
            (name: "motion", files: [{of_motion}], from: 1, unit: "m/s2"),
        ])"#
    )
}

/// Writes one channel, whose largest sample is `peak`.
fn write_peak(folder: &Path, name: &str, peak: f64) {
    write_npy(&folder.join(name), &[&[0.0, peak, 0.0, 0.0]]);
}

fn names(loaded: &Loaded) -> Vec<&str> {
    loaded.records.iter().map(|r| r.name.as_str()).collect()
}

/// Bit patterns of all numbers in all tables, with their places.
fn bits(outcome: &Outcome) -> Vec<(String, Vec<u64>)> {
    let mut all = Vec::new();
    for table in &outcome.tables {
        for column in &table.columns {
            if let Cells::Numbers(values) = &column.cells {
                let bits = values.iter().map(|value| value.to_bits()).collect();
                all.push((format!("{}, {}", table.name, column.name), bits));
            }
        }
    }
    all
}

/// The results are equal to the last digit whether a file contains one channel or two.
#[test]
fn results_are_those_of_joined_files_to_the_bit() {
    let folder = Folder::of_example("polypropylene");
    for hit in 1..=5 {
        let path = folder.file(format!("hits-{hit}.npy"));
        let contents = format::read(path).unwrap();
        for (name, series) in ["struck", "free"].into_iter().zip(&contents.series) {
            let Ordinate::Real(samples) = &series.ordinate else {
                panic!("complex samples")
            };
            write_npy(&folder.file(format!("{name}-{hit}.npy")), &[samples]);
        }
    }
    let joined = r#"records: (files: ["hits-*.npy"], sampling_rate: "65.536 kHz", channels: [
        (name: "struck end", from: 1, unit: "m/s2"), (name: "free end", from: 2, unit: "m/s2"),
    ])"#;
    let separate = r#"records: (sampling_rate: "65.536 kHz", channels: [
        (name: "struck end", files: ["struck-*.npy"], from: 1, unit: "m/s2"),
        (name: "free end", files: ["free-*.npy"], from: 1, unit: "m/s2"),
    ])"#;
    let frf = |records: &str| {
        format!(
            r#"Frf(title: "Ends", {records}, input: "struck end", estimator: H2, silent: "1.6 ms",
            band: (from: "100 Hz", to: "15 kHz"))"#
        )
    };
    let modulus = |records: &str| {
        format!(
            r#"Modulus(title: "Ends", source: Hits({records}, silent: "1.6 ms"),
            specimen: (length: "799 mm", diameter: "15.8 mm", density: "912 kg/m3", accelerometer_mass: "2.9 gram"),
            method: TwoPoint(impacted_end: "struck end", free_end: "free end"),
            lateral_inertia: (poisson_ratio: "0"), band: (from: "100 Hz", to: "15 kHz"))"#
        )
    };
    let sheets: [&dyn Fn(&str) -> String; 2] = [&frf, &modulus];
    for sheet in sheets {
        let [of_joined, of_separate] =
            [joined, separate].map(|text| folder.run(&sheet(text)).unwrap());
        let [expected, found] = [&of_joined, &of_separate].map(bits);
        assert!(expected.iter().map(|(_, bits)| bits.len()).sum::<usize>() > 1000);
        assert_eq!(found, expected);
        assert_eq!(of_separate.quantities, of_joined.quantities);
        assert_eq!(of_separate.summary, of_joined.summary);
        assert_eq!(of_separate.verdict, of_joined.verdict);
        // every file is listed as an input with its pattern, by which a later run finds new files
        let inputs: Vec<(&str, Option<&str>)> = of_separate
            .inputs
            .iter()
            .map(|input| (input.path.as_str(), input.pattern.as_deref()))
            .collect();
        assert_eq!(inputs.len(), 10);
        assert!(inputs.contains(&("free-4.npy", Some("free-*.npy"))));
        let log: Vec<&str> = of_separate.log.iter().map(|e| e.what.as_str()).collect();
        assert!(log.contains(&"hit 3, struck-3.npy + free-3.npy"), "{log:?}");
    }
}

/// Files are paired if the names of forces and the names of motions are ordered differently.
#[test]
fn files_are_paired_by_the_matched_text_and_not_by_their_order() {
    let folder = Folder::new();
    let here = folder.path();
    assert!("10a.npy" < "1a.npy" && "1-b.npy" < "10-b.npy");
    for hit in [1.0, 2.0, 10.0] {
        write_peak(here, &format!("{hit}a.npy"), hit);
        write_peak(here, &format!("{hit}-b.npy"), -hit);
    }
    let loaded = load(here, &pair(r#""*a.npy""#, r#""*-b.npy""#)).unwrap();
    assert_eq!(
        names(&loaded),
        ["1a.npy + 1-b.npy", "10a.npy + 10-b.npy", "2a.npy + 2-b.npy"]
    );
    for (named, hit) in loaded.records.iter().zip([1.0, 10.0, 2.0]) {
        let of = |name| named.record.channel(name).unwrap()[1];
        assert_eq!([of("force"), of("motion")], [hit, -hit]);
    }
    // patterns with several wildcards and with folders
    for (day, hit) in [(1, 1.0), (1, 2.0), (2, 1.0)] {
        for (channel, sign) in [("CH1", 1.0), ("CH2", -1.0)] {
            let within = here.join(format!("day{day}/{channel}"));
            fs::create_dir_all(&within).unwrap();
            write_peak(
                &within,
                &format!("hit-{hit}.npy"),
                sign * (hit + 100.0 * f64::from(day)),
            );
        }
    }
    let loaded = load(
        here,
        &pair(r#""./day*/CH1/hit-[0-9].npy""#, r#""day?/CH2/hit-*.npy""#),
    )
    .unwrap();
    assert_eq!(loaded.records.len(), 3);
    for (named, peak) in loaded.records.iter().zip([101.0, 102.0, 201.0]) {
        let of = |name| named.record.channel(name).unwrap()[1];
        assert_eq!([of("force"), of("motion")], [peak, -peak], "{}", named.name);
    }
    // names without wildcards are paired by their places in the lists
    let loaded = load(
        here,
        &pair(r#""2a.npy", "10a.npy""#, r#""2-b.npy", "10-b.npy""#),
    )
    .unwrap();
    assert_eq!(names(&loaded), ["2a.npy + 2-b.npy", "10a.npy + 10-b.npy"]);
}

#[test]
fn two_channels_of_three_may_share_a_file() {
    let folder = Folder::new();
    for hit in 1..=2_u8 {
        let peak = f64::from(hit);
        let both: [&[f64]; 2] = [&[0.0, peak, 0.0], &[0.0, 10.0 * peak, 0.0]];
        write_npy(&folder.file(format!("both-{hit}.npy")), &both);
        let alone: [&[f64]; 1] = [&[0.0, 100.0 * peak, 0.0]];
        write_npy(&folder.file(format!("alone-{hit}.npy")), &alone);
    }
    let sheet = r#"(sampling_rate: "1 kHz", channels: [
        (name: "a", files: ["both-*.npy"], from: 1, unit: "V", sensitivity: "1 mV/N"),
        (name: "b", files: ["alone-*.npy"], from: 1, unit: "m/s2"),
        (name: "c", files: ["both-*.npy"], from: 2, unit: "m/s2", inverted: true),
    ])"#;
    let loaded = load(folder.path(), sheet).unwrap();
    assert_eq!(
        names(&loaded),
        ["both-1.npy + alone-1.npy", "both-2.npy + alone-2.npy"]
    );
    assert_eq!(loaded.inputs.len(), 4);
    for (named, peak) in loaded.records.iter().zip([1.0, 2.0]) {
        let record = &named.record;
        let channels: Vec<&str> = record.channels().iter().map(|c| c.name()).collect();
        assert_eq!(channels, ["a", "b", "c"]);
        // 1 V divided by 1 mV/N, with two roundings
        assert!((record.samples()[[0, 1]] / (1000.0 * peak) - 1.0).abs() < 1e-15);
        assert_eq!(record.samples()[[1, 1]], 100.0 * peak);
        assert_eq!(record.samples()[[2, 1]], -10.0 * peak);
    }
}

#[test]
fn a_sample_lost_in_one_file_leaves_out_the_hit() {
    let folder = Folder::new();
    for hit in 1..=3_u8 {
        let peak = f64::from(hit);
        write_peak(folder.path(), &format!("a-{hit}.npy"), peak);
        let peak = if hit == 2 { f64::NAN } else { -peak };
        write_peak(folder.path(), &format!("b-{hit}.npy"), peak);
    }
    let loaded = load(folder.path(), &pair(r#""a-*.npy""#, r#""b-*.npy""#)).unwrap();
    assert_eq!(names(&loaded), ["a-1.npy + b-1.npy", "a-3.npy + b-3.npy"]);
    assert_eq!(loaded.inputs.len(), 6);
    let left_out: Vec<&str> = loaded.left_out.iter().map(|e| e.what.as_str()).collect();
    assert_eq!(left_out, ["a-2.npy + b-2.npy"]);
    loaded
        .warnings
        .must_begin("a-2.npy + b-2.npy is left out: b-2.npy: series 0");
    loaded.warnings.must_say("NaN at sample 1");
    // if there is no other hit, it is an error that names the channel
    load(folder.path(), &pair(r#""a-2.npy""#, r#""b-2.npy""#))
        .unwrap_err()
        .must_begin("records.channels[1], b-2.npy: series 0");
}

/// Writes a universal file with one channel.
fn write_universal(folder: &Path, name: &str, series: Vec<Series>) {
    let mut contents = Contents::of_format("test");
    contents.series = series;
    format::write(folder.join(name), &contents, &Uff58Writer::default()).unwrap();
}

/// A sheet of records with two channels from universal files.
fn of_universal(of_force: &str, of_motion: &str) -> String {
    format!(
        r#"(channels: [(name: "f", files: [{of_force}], from: 1), (name: "a", files: [{of_motion}], from: "end A")])"#
    )
}

#[test]
fn files_with_several_records_are_paired_record_by_record() {
    let folder = Folder::new();
    let here = folder.path();
    let all = |name: &str, unit: &str, sign: f64| -> Vec<Series> {
        let peaks = [1.0, 2.0, 3.0].into_iter();
        peaks
            .map(|peak| series(name, unit, 1e-3, &[0.0, sign * peak, 0.0]))
            .collect()
    };
    write_universal(here, "force.uff", all("hammer", "N", 1.0));
    write_universal(here, "free.uff", all("end A", "m/s^2", -1.0));
    let mut two = all("end A", "m/s^2", -1.0);
    two.pop();
    write_universal(here, "two.uff", two);
    let loaded = load(here, &of_universal(r#""force.uff""#, r#""free.uff""#)).unwrap();
    assert_eq!(loaded.records.len(), 3);
    assert_eq!(loaded.records[2].name, "force.uff + free.uff, record 3");
    for (named, peak) in loaded.records.iter().zip([1.0, 2.0, 3.0]) {
        let of = |name| named.record.channel(name).unwrap()[1];
        assert_eq!([of("f"), of("a")], [peak, -peak]);
    }
    let said = refusals(here, &[&of_universal(r#""force.uff""#, r#""two.uff""#)]);
    insta::assert_snapshot!(said, @"records.channels[1].files is two.uff with 2 records, expected 3 records, as in force.uff");
}

#[test]
fn files_that_are_no_pairs_are_refused() {
    let folder = Folder::new();
    let here = folder.path();
    let write = |name: &str, of: &str, unit: &str, step: f64, samples: &[f64]| {
        write_universal(here, name, vec![series(of, unit, step, samples)]);
    };
    for hit in 1..=3_u8 {
        let samples = [0.0, f64::from(hit), 0.0];
        write(&format!("force-{hit}.uff"), "hammer", "N", 1e-3, &samples);
        write(
            &format!("late-0{hit}.uff"),
            "end A",
            "m/s^2",
            1e-3,
            &samples,
        );
        if hit < 3 {
            write(&format!("free-{hit}.uff"), "end A", "m/s^2", 1e-3, &samples);
        }
    }
    write("step.uff", "end A", "m/s^2", 2e-3, &[0.0, 1.0, 0.0]);
    write("long.uff", "end A", "m/s^2", 1e-3, &[0.0, 1.0, 0.0, 0.0]);
    let mut started = series("end A", "m/s^2", 1e-3, &[0.0, 1.0, 0.0]);
    started.abscissa = Abscissa::Even {
        start: 0.5e-3,
        step: 1e-3,
    };
    write_universal(here, "start.uff", vec![started]);
    let force = r#""force-1.uff""#;
    let said = refusals(
        here,
        &[
            // files without a partner
            &of_universal(r#""force-*.uff""#, r#""free-*.uff""#),
            &of_universal(r#""free-*.uff""#, r#""force-*.uff""#),
            &of_universal(r#""force-*.uff""#, r#""late-*.uff""#),
            &of_universal(r#""force-1.uff", "force-2.uff""#, r#""free-1.uff""#),
            &of_universal(r#""force-*.uff""#, r#""none-*.uff""#),
            // different times
            &of_universal(force, r#""step.uff""#),
            &of_universal(force, r#""start.uff""#),
            &of_universal(force, r#""long.uff""#),
            // files for some of the channels
            &of_universal(force, ""),
            r#"(files: ["force-1.uff"], channels: [(name: "f", from: 1), (name: "a", files: ["free-1.uff"], from: 1)])"#,
            r#"(channels: [(name: "f", from: 1)])"#,
            // files and channels that are used twice
            r#"(channels: [(name: "f", files: ["force-1.uff"], from: 1), (name: "a", files: ["force-1.uff"], from: 1)])"#,
            r#"(channels: [(name: "f", files: ["force-1.uff", "force-2.uff"], from: 1), (name: "a", files: ["force-2.uff", "force-1.uff"], from: 1)])"#,
        ],
    );
    insta::assert_snapshot!(said, @r"
    records.channels[1].files is `free-*.uff`, which matches free-1.uff, free-2.uff, expected also the partner of force-3.uff of channels[0], with `3` in place of the wildcards: every hit needs a file of each channel
    records.channels[0].files is `free-*.uff`, which matches free-1.uff, free-2.uff, expected also the partner of force-3.uff of channels[1], with `3` in place of the wildcards: every hit needs a file of each channel
    records.channels[1].files is `late-*.uff`, which matches late-01.uff, late-02.uff, late-03.uff, expected also the partner of force-1.uff of channels[0], with `1` in place of the wildcards: every hit needs a file of each channel
    records.channels[1].files is `free-1.uff`, which matches free-1.uff, expected also the partner of force-2.uff of channels[0], entry 2 of the list: every hit needs a file of each channel
    no file matches `none-*.uff` in FOLDER (records.channels[1].files)
    records.channels[1].files, step.uff is 3 samples at 500 Hz from 0 s, expected those of force-1.uff: 3 samples at 1000 Hz from 0 s
    records.channels[1].files, start.uff is 3 samples at 1000 Hz from 0.0005 s, expected those of force-1.uff: 3 samples at 1000 Hz from 0 s
    records.channels[1].files, long.uff is 4 samples at 1000 Hz from 0 s, expected those of force-1.uff: 3 samples at 1000 Hz from 0 s
    records.channels[1].files is not stated, expected the files of this channel, because channels[0] has its own files
    records.channels[1].files is stated in addition to records.files, expected only one of the two: `files` of the records for files with all channels, `files` in every channel for files with one channel each
    records.files is empty, expected the name of at least one file; if each channel has files of its own, state `files` in every channel
    records.channels[1].from is channel 1, expected another channel of force-1.uff than channels[0]
    records.channels[0].files is force-2.uff, which belongs to two hits, expected each file in one hit only
    ");
    // the files of two channels are compared, too
    fs::copy(here.join("force-1.uff"), here.join("copy.uff")).unwrap();
    let copied = r#"(channels: [(name: "f", files: ["force-1.uff"], from: 1), (name: "a", files: ["copy.uff"], from: 1)])"#;
    refusals(here, &[copied]).must_begin("force-1.uff and copy.uff have the same content");
}
