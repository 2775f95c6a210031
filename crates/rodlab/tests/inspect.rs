//! Findings of `inspect` in intact files and in faulty ones.

use testbed::measured;

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use rodlab::inspect::{inspect, inspect_bytes};

use crate::runs::{Folder, Refused, Words, npy, without_formats};

/// A table with a hit of 2 ms: time, force clipped at `range`, and acceleration with an offset.
fn table(range: f64, offset: f64) -> String {
    let mut text = "Time (ms),hammer (N),end A (g)\n".to_owned();
    for k in 0..2000 {
        let t = f64::from(k) / 10.0 - 20.0;
        let blow = if (0.0..2.0).contains(&t) {
            (PI * t / 2.0).sin()
        } else {
            0.0
        };
        let ring = if t > 0.0 {
            (-t / 10.0).exp() * (TAU * t).sin()
        } else {
            0.0
        };
        // irregular noise; the values have as many digits as those of a recorder
        let noise = (f64::from(k * k % 1009) * 12.9898).sin();
        let force = (80.0 * blow + 0.05 * noise).clamp(-range, range);
        let acceleration = 5.0 * ring + 0.002 * noise + offset;
        let _ = writeln!(text, "{t:.1},{force:.3},{acceleration:.4}");
    }
    text
}

#[test]
fn a_sound_table_is_described_in_columns() {
    let inspection = inspect_bytes(table(1e3, 0.0).as_bytes(), "hit.csv").unwrap();
    insta::assert_snapshot!(inspection.to_text(), @r"
    hit.csv: csv, 38844 bytes
    sha256 dc95614b1c60b55256ad12d46f2c14538bc86d46d4a2c54aed78140a5d1d6676

    #  name    kind           unit  samples  rate or step    from  minimum  maximum      mean    rms
    1  hammer  time response  N        2000        10 kHz  -20 ms    -0.05    80.02    0.5082  5.657
    2  end A   time response  g        2000        10 kHz  -20 ms   -4.436     4.66  0.003842  0.559

    record 1: hammer, end A (2000 samples, 0.2 s)
    ");
    let force = &inspection.series[0];
    assert!((force.sampling_rate_hz.unwrap() - 10_000.0).abs() < 1e-6);
    let levels = force.levels.unwrap();
    assert_eq!(levels.peak_at, 210);
    // expected: half a sine of 2 ms in a record of 200 ms has the rms (80²/2 · 0.01)^½, to which
    // noise with the rms 0.05/√2 is added
    assert!((levels.rms - 5.657).abs() < 0.01, "{}", levels.rms);
}

#[test]
fn clipping_and_an_offset_are_suspicious() {
    let inspection = inspect_bytes(table(60.0, 3.0).as_bytes(), "hit.csv").unwrap();
    insta::assert_snapshot!(inspection.suspicions.join("\n"), @r"
    clipped: `hammer` stays at its extreme 60.00 for 9 samples from sample 206 on
    static offset: `end A` rests at 29.42, more than 0.250 times its peak of 45.70
    ");
}

#[test]
fn what_a_file_does_not_tell_is_advised() {
    let mut values: Vec<f64> = (0..32_u32).map(|k| f64::from(k % 7)).collect();
    values[20] = f64::NAN;
    let (first, second) = values.split_at(16);
    let inspection = inspect_bytes(&npy(&[first, second]), "hits.npy").unwrap();
    assert!(
        inspection
            .series
            .iter()
            .all(|s| s.sampling_rate_hz.is_none())
    );
    assert!(
        inspection
            .records
            .iter()
            .all(|r| r.sampling_rate_hz.is_none())
    );
    let said = [inspection.suspicions, inspection.advice]
        .concat()
        .join("\n");
    insta::assert_snapshot!(said, @r"
    1 of 16 values of channel 2 (`[1, :]`) are NaN or infinite
    the file does not state the sampling rate of channels 1, 2: state `sampling_rate` in the sheet
    the file does not state a known unit of channels 1, 2: state `unit` in the sheet
    ");
}

#[test]
fn a_table_is_no_recording() {
    let text =
        "Temperatur [degC];E' [MPa];Frequenz [Hz]\n20;940;0.1\n20;950;1\n30;800;0.1\n30;820;1\n";
    let inspection = inspect_bytes(text.as_bytes(), "dma.csv").unwrap();
    assert!(inspection.suspicions.is_empty() && inspection.records.is_empty());
    insta::assert_snapshot!(inspection.advice.join("\n"), @"a table of 3 columns (degC, MPa, Hz) and 4 rows, not a recording: `rodlab fit` reads it by the names of its columns (`rodlab init fit`); a recording needs `sampling_rate` in the sheet");
}

#[test]
fn the_listing_of_many_channels_ends() {
    let row = |value: u32| (0..30_u32).map(move |k| (value * k % 7).to_string());
    let rows = (0..40_u32).map(|n| row(n).collect::<Vec<_>>().join(",") + "\n");
    let names: Vec<String> = (0..30_u32).map(|k| format!("c{k}")).collect();
    let text = names.join(",") + "\n" + &rows.collect::<String>();
    let inspection = inspect_bytes(text.as_bytes(), "wide.csv").unwrap();
    let hidden = inspection.series.len() - 20;
    let text = inspection.to_text();
    text.must_say(&format!("\nand {hidden} more\n"));
    assert!(!text.contains("c29"), "{text}");
}

#[test]
fn a_row_of_times_is_no_channel() {
    let times: Vec<f64> = (0..100_u32).map(|k| f64::from(k) / 25_600.0).collect();
    let force = (0..100_u32).map(|k| f64::from(k * k % 17)).collect();
    let inspection = inspect_bytes(&npy(&[times, force]), "hit.npy").unwrap();
    assert_eq!(inspection.records[0].channels.len(), 1);
    insta::assert_snapshot!(inspection.advice.join("\n"), @r"
    the file does not state the sampling rate of channels 1, 2: state `sampling_rate` in the sheet
    channel 1 increases evenly, like times: if they are in s, `sampling_rate` is 25600 Hz
    the file does not state a known unit of channel 2: state `unit` in the sheet
    ");
}

/// A first column of even times without a name: the advice states the sampling rate. Rounding to
/// single precision leaves it open whether the column contains times; a column with nine digits is
/// read as times, even if it begins with a `0` without decimals.
#[test]
fn a_column_without_a_head_is_recognised_as_times() {
    let inspected = |time: &dyn Fn(u32) -> String| {
        let rows = (0..8192_u32).map(|k| format!("{},{},{}\n", time(k), k % 17, k % 5));
        let text: String = rows.collect();
        let inspection = inspect_bytes(text.as_bytes(), "hit.csv").unwrap();
        assert_eq!(inspection.series.len(), 2);
        inspection.advice.join("\n")
    };
    let single = inspected(&|k| format!("{:?}", f64::from(k as f32 / 48_000.0)));
    let said = "column 1 increases evenly, like times, and channels are numbered from the next column: if it is in s, `sampling_rate` is 48000 Hz";
    single.must_say(said);
    let nine_digits = inspected(&|k| match k {
        0 => "0".to_owned(),
        _ => format!("{:.8e}", f64::from(k) / 65_536.0),
    });
    let said = "the times have no unit: if they are in s, `sampling_rate` is 65536 Hz";
    nine_digits.must_say(said);
}

#[test]
fn a_step_that_was_rounded_is_recognised() {
    let text = "Time (s),a (m/s^2)\n0,0\n0.000977,1\n0.001954,2\n0.002931,1\n";
    let inspection = inspect_bytes(text.as_bytes(), "a.csv").unwrap();
    insta::assert_snapshot!(inspection.advice.join("\n"), @r"the step of 0.000977 s may be a rounded 1024 Hz: a sheet can state `sampling_rate`");
    let exact = "Time (s),a (m/s^2)\n0,0\n0.0001,1\n0.0002,2\n0.0003,1\n";
    assert!(
        inspect_bytes(exact.as_bytes(), "a.csv")
            .unwrap()
            .advice
            .is_empty()
    );
}

#[test]
fn a_rate_from_rounded_times_is_stated_to_two_digits() {
    let rows = (0..500_u32).map(|k| format!("{:.4},{}\n", f64::from(k) / 48_000.0, k % 17));
    let text: String = std::iter::once("t,F\n".to_owned()).chain(rows).collect();
    let inspection = inspect_bytes(text.as_bytes(), "hit.csv").unwrap();
    let advice = inspection.advice.join("\n");
    let said = "`sampling_rate` is about 48 kHz, from rounded times: state the recorder's rate";
    advice.must_say(said);
}

#[test]
fn a_damaged_file_is_read_as_far_as_it_goes() {
    let text = table(1e3, 0.0);
    let cut = &text[..text.len() - 400];
    let damaged = format!("{cut}\nthe recorder stopped here\n");
    let inspection = inspect_bytes(damaged.as_bytes(), "cut.csv").unwrap();
    assert!(inspection.series[0].samples > 1900);
    // the two defects are the row that is cut and the remark
    assert_eq!(inspection.defects.len(), 2, "{:?}", inspection.defects);
    inspection.to_text().must_say("not read:");
}

#[test]
fn the_inspection_is_the_same_as_json() {
    let inspection = inspect_bytes(table(1e3, 0.0).as_bytes(), "hit.csv").unwrap();
    let json: serde_json::Value = serde_json::to_value(&inspection).unwrap();
    assert_eq!(json["format"], "csv");
    assert_eq!(json["series"][1]["quantity"], "acceleration");
    assert_eq!(json["series"][1]["unit"], "g");
    assert_eq!(json["records"][0]["samples"], 2000);
    assert_eq!(json["sha256"].as_str().unwrap().len(), 64);
}

#[test]
fn what_is_no_file_of_data_is_refused() {
    let folder = Folder::new();
    let missing = inspect(&folder.file("absent.npy")).refused();
    missing.must_begin("cannot read ");
    missing.must_say("absent.npy");
    let error = inspect_bytes(b"\x7fELF\x02\x01\x01\x00", "program").unwrap_err();
    insta::assert_snapshot!(without_formats(&error.to_string()), @r#"reading program: the 8 bytes that begin with "\u{7f}ELF\u{2}\u{1}\u{1}\u{0}" are not in a known format (FORMATS)"#);
}

#[test]
fn the_measured_files_are_all_described() {
    let Some(data) = measured::folder() else {
        return;
    };
    // a shock on a drop table; the documentation of the file states that the acquisition failed
    let failed = inspect(&data.join("shock/Test_017.lvm")).unwrap();
    assert!(!failed.suspicions.is_empty(), "{}", failed.to_text());
    let mut described = 0;
    for folder in ["hammer", "lvm", "shock", "uff", "tdms"] {
        for entry in std::fs::read_dir(data.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            match inspect(&path) {
                Ok(inspection) => {
                    described += 1;
                    let text = inspection.to_text();
                    assert!(text.lines().count() > 2, "{text}");
                }
                // only the corrupt file is reported as an error
                Err(error) => assert!(
                    path.ends_with("tdms/faulty_tdms_01.tdms"),
                    "{}: {error}",
                    path.display()
                ),
            }
        }
    }
    assert!(described > 15, "{described}");
}

/// No job accepts times that decrease or are uneven; the inspection states where they occur.
#[test]
fn times_that_decrease_or_are_uneven_are_suspicious() {
    let said = |times: [f64; 5]| {
        let rows: String = times.iter().map(|t| format!("{t},1.5\n")).collect();
        let text = format!("time [ms],force [N]\n{rows}");
        let found = inspect_bytes(text.as_bytes(), "hit.csv").unwrap();
        assert!(
            found.series[0]
                .sampling_rate_hz
                .is_none_or(|rate| rate > 0.0)
        );
        let mut times = found.suspicions.into_iter();
        times.find(|one| one.starts_with("the times"))
    };
    assert_eq!(said([0.0, 0.5, 1.0, 1.5, 2.0]), None);
    assert_eq!(
        said([2.0, 1.5, 1.0, 0.5, 0.0]).as_deref(),
        Some("the times of `force` change by -0.5 ms, expected above 0")
    );
    assert_eq!(
        said([0.0, 0.5, 1.0, 0.0, 0.5]).as_deref(),
        Some("the times of `force` change by -1 ms after 1 ms, expected above 0")
    );
    assert_eq!(
        said([0.0, 0.5, 1.0, 3.0, 3.5]).as_deref(),
        Some(
            "the times of `force` are uneven: steps of 0.5 to 2 ms, the longest after 1 ms; a job needs a `sampling_rate` that gives all times within half a step"
        )
    );
}
