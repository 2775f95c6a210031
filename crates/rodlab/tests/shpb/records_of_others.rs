//! Measured shots of other laboratories, read from their unchanged files.

use std::fs;

use rodlab::Outcome;
use testbed::measured;

use super::column;
use crate::runs::{Folder, Words, without_formats};

/// The outcome of a sheet in a folder with copies of measured files; prints a message and returns
/// `None` if they do not exist.
fn outcome(files: &[&str], sheet: &str) -> Option<Outcome> {
    let data = measured::folder()?;
    let folder = Folder::new();
    for file in files {
        let path = data.join("shpb").join(file);
        if !path.exists() {
            println!("skipped: {} does not exist", path.display());
            return None;
        }
        fs::copy(&path, folder.file(path.file_name().unwrap())).unwrap();
    }
    let outcome = folder.run(sheet).unwrap();
    println!("{:?}\n{:?}", outcome.verdict, outcome.summary);
    Some(outcome)
}

fn quantity(outcome: &Outcome, name: &str) -> f64 {
    let found = outcome.quantities.iter().find(|q| q.name.contains(name));
    found.unwrap().value.unwrap()
}

/// Exit status and headline of an outcome.
fn standing(outcome: &Outcome) -> (u8, String) {
    let words = outcome.verdict.headline(&outcome.summary);
    (outcome.verdict.standing().exit_status(), words)
}

/// Impulse on the incident face divided by that on the transmitted face, and the root mean square
/// of the difference of the forces divided by the largest force, between two times \[µs\].
fn balance(outcome: &Outcome, from: f64, to: f64) -> [f64; 2] {
    let force = |face: &str| column(outcome, "faces", &format!("force of the {face} face"));
    let time = column(outcome, "faces", "time");
    let (mut sums, mut square, mut n) = ([0.0; 2], 0.0, 0.0);
    for (time, (first, second)) in time
        .iter()
        .zip(force("incident").iter().zip(force("transmitted")))
    {
        if (from..to).contains(time) {
            sums = [sums[0] + first, sums[1] + second];
            square += (first - second).powi(2);
            n += 1.0;
        }
    }
    let largest = force("transmitted")
        .iter()
        .fold(0.0_f64, |most, f| most.max(*f));
    [sums[0] / sums[1], f64::sqrt(square / n) / largest]
}

/// Wave speed [m/s] from the arrivals of the incident and the reflected front at a gauge at
/// `distance` \[m\] from the specimen; `stated` is the speed that the evaluation assumed.
fn speed(outcome: &Outcome, distance: f64, stated: f64) -> f64 {
    let arrival = |wave: &str| 1e-6 * quantity(outcome, &format!("arrival of the {wave} wave"));
    2.0 * distance / (2.0 * distance / stated + arrival("reflected") - arrival("incident"))
}

/// A sheet for the two steel bars of 20 mm of one laboratory.
fn steel(distances: [&str; 2], specimen: &str, records: &str) -> String {
    let bar = |channel: &str, at: &str, length: &str| {
        format!(
            r#"(waves: Material("steel"), diameter: "20 mm ± 0.02 mm", length: "{length}", poisson_ratio: "0.29",
            gauges: [(channel: "{channel}", at: "{at} ± 1 mm")])"#
        )
    };
    format!(
        r#"Shpb(title: "steel bars", loading: Compression,
        materials: {{"steel": (density: "7800 kg/m3 ± 0.5 %", law: Elastic(modulus: "210 GPa ± 0.5 %"))}},
        bars: (incident: {}, transmitted: {}), specimen: {specimen}, {records})"#,
        bar("incident", distances[0], "2100 mm"),
        bar("transmitted", distances[1], "1800 mm"),
    )
}

/// sqrt(E/rho) of those bars [m/s].
const STEEL: f64 = 5188.7;

/// Steel between steel bars, in an old workbook with times in single precision. The stated position
/// of the second gauge is 29 mm off, as the order of the waves shows. With the position of the same
/// bars in another test of the laboratory the forces agree, apart from a level that differs from
/// shot to shot.
#[test]
fn hopkinson_measured_steel_is_evaluated_and_its_wrong_position_named() {
    let sheet = |at: &str| {
        steel(
            ["1020 mm", at],
            r#"(length: "4 mm ± 0.02 mm", diameter: "8 mm ± 0.02 mm")"#,
            r#"records: [(files: ["raw_microstrain.xls"], sampling_rate: "31.25 MHz", channels: [
                (name: "incident", from: 1, unit: "um/m", sensitivity: "1 ± 1 %"),
                (name: "transmitted", from: 2, unit: "um/m", sensitivity: "1 ± 1 %")])], silent: "30 us""#,
        )
    };
    let files = ["steel-945/raw_microstrain.xls"];
    let Some(stated) = outcome(&files, &sheet("770 mm")) else {
        return;
    };
    let (status, words) = standing(&stated);
    assert_eq!(status, 3, "{words}");
    words.must_say("before that of the incident face");
    // tolerance: two fronts of 10 us, whose shape the specimen changes, arrive 390 us ± 3 us apart
    let speed = speed(&stated, 1.020, STEEL);
    assert!((speed / STEEL - 1.0).abs() < 0.008, "{speed}");
    let right = outcome(&files, &sheet("741 mm")).unwrap();
    let (status, words) = standing(&right);
    assert_eq!(status, 0, "{words}");
    // before the reflection the level of the gauge is 29 um/m: 4 % of 720 um/m, the transmitted
    // strain while the steel flows
    assert!(is_remarked(&right, "2.0 % of the peak"));
    let [ratio, difference] = balance(&right, 290.0, 345.0);
    println!("{ratio} {difference}");
    assert!(
        (ratio - 0.96).abs() < 0.015 && difference < 0.06,
        "{ratio} {difference}"
    );
    // tolerance: an evaluation by hand gives 1038 MPa (two waves) and 1044 MPa (three waves), with
    // 20 MPa of noise of the converter at the peak
    let stress = quantity(&right, "largest stress");
    assert!((stress / 1024.0 - 1.0).abs() < 0.025, "{stress}");
}

/// Returns true if a warning contains `part`, such as that on the level of the incident gauge
/// before the reflection.
fn is_remarked(outcome: &Outcome, part: &str) -> bool {
    outcome.warnings.iter().any(|words| words.contains(part))
}

/// Epoxy between the same bars: the strains of the file were multiplied twice by 0.000501 strain/V,
/// as the recorded volts show.
#[test]
fn hopkinson_measured_epoxy_is_evaluated() {
    let sheet = |factor: &str| {
        let records = r#"records: [(files: ["raw_strain.csv"], sampling_rate: "12.5 MHz", channels: [
            (name: "incident", from: 1, unit: "strain", sensitivity: "FACTOR ± 1 %"),
            (name: "transmitted", from: 2, unit: "strain", sensitivity: "FACTOR ± 1 %")])], silent: "100 us""#;
        let specimen = r#"(length: "4 mm ± 0.02 mm", diameter: "10 mm ± 0.02 mm")"#;
        steel(
            ["1018 mm", "741 mm"],
            specimen,
            &records.replace("FACTOR", factor),
        )
    };
    let files = ["epoxy/raw_strain.csv"];
    // strains of half a micrometre per metre are impossible in a test that breaks epoxy
    let Some(raw) = outcome(&files, &sheet("1")) else {
        return;
    };
    let (status, words) = standing(&raw);
    assert!(
        status == 1 && words.contains("check gauge factor"),
        "{words}"
    );
    let right = outcome(&files, &sheet("0.000501")).unwrap();
    let (status, words) = standing(&right);
    assert_eq!(status, 0, "{words}");
    assert!(is_remarked(&right, "1.8 % of the peak"));
    let speed = speed(&right, 1.018, STEEL);
    assert!((speed / STEEL - 1.0).abs() < 0.008, "{speed}");
    // while the epoxy flows: 2 % due to the gauges; the 17 um/m that remain of the incident wave
    // are 6 % of 270 um/m
    let [ratio, difference] = balance(&right, 445.0, 590.0);
    println!("{ratio} {difference}");
    assert!(
        (ratio - 1.03).abs() < 0.02 && difference < 0.06,
        "{ratio} {difference}"
    );
    // a face cannot pull: with the wave speed from the passages the force on the incident face
    // stays compressive, with the speed of the stated modulus it becomes tensile
    let found = outcome(&files, &sheet("0.000501").replace("210 GPa", "208.15 GPa")).unwrap();
    let [stated, found] = [&right, &found].map(|outcome| {
        let force = column(outcome, "faces", "force of the incident face").iter();
        force.copied().fold(0.0, f64::min)
    });
    println!("{stated} {found}");
    assert!(stated < -4000.0 && found > -1000.0, "{stated} {found}");
    // an evaluation by hand gives 281 MPa, smoothed over 4 us
    let stress = quantity(&right, "largest stress");
    assert!((stress / 281.0 - 1.0).abs() < 0.02, "{stress}");
}

/// PMMA between square bars of 2.1 mm: four files of an oscilloscope, two opposite gauges per bar.
#[test]
fn hopkinson_measured_pmma_is_evaluated() {
    let names = [1, 2, 3, 4].map(|k| format!("pmma-13/180303_171828_Ch{k}.csv"));
    let bar = |first: u8, at: &str| {
        let second = first + 1;
        format!(
            r#"(waves: Speed(density: "2810 kg/m3 ± 0.5 %", wave_speed: "5051.3 m/s ± 10 m/s"), diameter: "2.38088 mm ± 0.005 mm",
            length: "204 mm", poisson_ratio: "0.3327", gauges: [(channel: "{first}", averaged_with: ["{second}"], at: "{at} ± 0.2 mm")])"#
        )
    };
    let records = [1, 2, 3, 4].map(|k| {
        format!(
            r#"(files: ["180303_171828_Ch{k}.csv"], channels: [(name: "{k}", from: 1, unit: "V", gain: "100",
            bridge: (layout: HalfOpposite, gauge_factor: "2.1 ± 1 %", excitation: "10 V"))])"#
        )
    });
    let sheet = |pair: u8| {
        format!(
            r#"Shpb(title: "PMMA", loading: Compression, bars: (incident: {}, transmitted: {}),
            specimen: (length: "1.47 mm ± 0.01 mm", diameter: "1.54 mm ± 0.01 mm"), records: [{}], silent: "75 us")"#,
            bar(1, "102.02 mm"),
            bar(pair, "101.35 mm"),
            records.join(", ")
        )
    };
    let names = names.each_ref().map(String::as_str);
    let Some(right) = outcome(&names, &sheet(3)) else {
        return;
    };
    let (status, words) = standing(&right);
    assert_eq!(status, 3, "{words}");
    // the level before the reflection is 12 um/m of 1330 um/m
    words.must_say("do not become equal");
    words.must_say("of these samples are after the largest strain");
    words.must_say("the face of the incident bar pulls");
    assert!(is_remarked(&right, "1.0 % of the peak"));
    // the impulses agree within 2.2 %, the errors of gauges and positions; a small rise before the
    // reflected front changes the forces by 8 %
    let ratio = quantity(&right, "divided by force on the transmitted face");
    let [_, difference] = balance(&right, 103.5, 111.0);
    println!("{ratio} {difference}");
    assert!(
        (ratio - 1.0).abs() < 0.025 && difference < 0.1,
        "{ratio} {difference}"
    );
    let stress = quantity(&right, "largest stress");
    assert!((stress - 169.7).abs() < 3.0, "{stress}");
    // the wave speed from passages of the pulse; the end of the transmitted bar at the specimen is
    // free for a tensile wave
    let passages = [79e-6, 158e-6].map(|from| passage(&names[2..], from));
    let speed = 2.0 * 0.10135 / (0.5 * (passages[0] + passages[1]));
    println!("{passages:?} {speed}");
    assert!((5030.0..5060.0).contains(&speed), "{speed}");
    // channels 2 and 3 are of different bars
    let wrong = outcome(&names, &sheet(2)).unwrap();
    assert!(
        standing(&wrong)
            .1
            .contains("times that of the transmitted bar throughout"),
        "{:?}",
        standing(&wrong)
    );
}

/// Lag \[s\] near 40 us after which the mean of two files is most similar to its course during
/// 20 us after the time `from` \[s\].
fn passage(names: &[&str], from: f64) -> f64 {
    let read = |name: &str| {
        let file = measured::folder().unwrap().join("shpb").join(name);
        let contents = labio::format::read(file).unwrap();
        let labio::Ordinate::Real(values) = contents.series[0].ordinate.clone() else {
            panic!("{name}")
        };
        values
    };
    let (first, second) = (read(names[0]), read(names[1]));
    let mean: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a + b).collect();
    let step = 8e-9;
    let begin = ((from + 80e-6) / step) as usize;
    let n = (20e-6 / step) as usize;
    let alike = |lag: usize| {
        let pairs = mean[begin..begin + n].iter().zip(&mean[begin + lag..]);
        let (product, square) = pairs.fold((0.0, 0.0), |(p, s), (a, b)| (p + a * b, s + b * b));
        (product / f64::sqrt(square)).abs()
    };
    let lags = (38e-6 / step) as usize..(44e-6 / step) as usize;
    let best = lags.max_by(|a, b| alike(*a).total_cmp(&alike(*b)));
    step * best.unwrap() as f64
}

/// Each file of a bar, of a shock or in an unusual dialect is read unchanged, with a stated
/// sampling rate, or refused with the message in its row.
#[test]
fn hopkinson_each_record_is_read_or_refused_with_its_reason() {
    let Some(data) = measured::folder() else {
        return;
    };
    let mut said = String::new();
    for folder in [
        "shpb",
        "shpb/epoxy",
        "shpb/steel-945",
        "shpb/copper",
        "shpb/pmma-13",
        "shock",
        "lvm",
    ] {
        let entries = fs::read_dir(data.join(folder)).unwrap();
        let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.retain(|path| path.is_file());
        paths.sort();
        for path in paths {
            let name = path.strip_prefix(&data).unwrap().display().to_string();
            let bytes = fs::read(&path).unwrap();
            let rates = [None, Some(12.5e6), Some(31.25e6)].into_iter();
            let mut tries = rates.map(|rate| {
                let read = match rate {
                    None => labio::format::read_bytes(&bytes),
                    Some(rate) => labio::format::read_bytes_at(&bytes, rate),
                };
                (rate, read)
            });
            let (_, first) = tries.next().unwrap();
            let why = first.as_ref().err().map(ToString::to_string);
            let read = std::iter::once((None, first))
                .chain(tries)
                .find(|(_, read)| read.is_ok());
            said += &match (read, why) {
                (Some((None, Ok(contents))), _) => {
                    format!("{name}: read, {} series\n", contents.series.len())
                }
                (Some((Some(rate), Ok(contents))), Some(why)) => format!(
                    "{name}: read at {} MHz, {} series; without it: {}\n",
                    1e-6 * rate,
                    contents.series.len(),
                    why.replace(&data.display().to_string(), "")
                ),
                (_, why) => format!("{name}: refused: {}\n", why.unwrap_or_default()),
            };
        }
    }
    insta::assert_snapshot!(without_formats(&said), @r##"
    shpb/impact_compression_epoxy_resin_experiment_details_en-US.txt: refused: the 2293 bytes that begin with "# Experiment Det" are not in a known format (FORMATS)
    shpb/impact_compression_epoxy_resin_sample_01_raw_voltage.csv: read at 12.5 MHz, 2 series; without it: csv, line 2, column 1: abscissa is repeated values; their digits give the step 7.990399519976e-8 to within 2.8e-10, expected a step known to within a relative 0.0001, or a stated step
    shpb/epoxy/manual_processing_result.xlsx: refused: xlsx, line 3: worksheet `电压调零`: row is `-0.00911200022583202\t-0.0091120002258320...`, expected a row of 3 numbers
    shpb/epoxy/raw_strain.csv: read at 12.5 MHz, 2 series; without it: csv, line 2, column 1: abscissa is repeated values; their digits give the step 7.990399519976e-8 to within 2.8e-10, expected a step known to within a relative 0.0001, or a stated step
    shpb/steel-945/experiment_details.txt: refused: the 2487 bytes that begin with "# Experiment Det" are not in a known format (FORMATS)
    shpb/steel-945/manual_processing_result.xlsx: refused: xlsx, line 4715: worksheet `电压转应变`: row is `-3.2033333819967196e-5\t1.756666692403281...`, expected a row of 7 numbers
    shpb/steel-945/raw_microstrain.xls: read, 2 series
    shpb/copper/experiment_details.txt: refused: the 2093 bytes that begin with "# Experiment Det" are not in a known format (FORMATS)
    shpb/copper/gauge_strain_records.csv: read, 11 series
    shpb/copper/stress_strain_rate.csv: refused: csv, line 80, column 9: cell is a number below 78 empty cells, expected no empty cell above it in the column
    shpb/copper/wave_separation.csv: read, 12 series
    shpb/pmma-13/180303_171828_Ch1.csv: read, 1 series
    shpb/pmma-13/180303_171828_Ch2.csv: read, 1 series
    shpb/pmma-13/180303_171828_Ch3.csv: read, 1 series
    shpb/pmma-13/180303_171828_Ch4.csv: read, 1 series
    shpb/pmma-13/PMMA_13_Input.dat: refused: the 2641 bytes that begin with "Test Date\t3/2/18" are not in a known format (FORMATS)
    shock/Test_001.lvm: read, 6 series
    shock/Test_002.lvm: read, 6 series
    shock/Test_003.lvm: read, 6 series
    shock/Test_017.lvm: read, 6 series
    lvm/multi_time_column.lvm: refused: lvm, line 27: Samples is 3 rows, expected 51200 rows or a multiple, as stated in the header
    lvm/no_decimal_separator.lvm: read, 3 series
    lvm/short.lvm: read, 2 series
    lvm/short_new_line_end.lvm: read, 2 series
    lvm/with_comments.lvm: read, 3 series
    lvm/with_empty_fields.lvm: refused: lvm, line 30: Samples is 7 rows, expected 100 rows or a multiple, as stated in the header
    "##);
}
