//! Tables with the settings of the instrument that wrote them: names, units and times.

use std::f64::consts::PI;
use std::fmt::Write;

use super::*;

const N: u32 = 40;
const START: f64 = -4e-5;
const STEP: f64 = 4e-6;

/// Voltage, as printed, of a gauge that a half sine of 60 µs passes, and of a second gauge that it
/// reaches 30 µs later.
fn volts(gauge: u32, k: u32) -> String {
    let time = START + STEP * f64::from(k) - 3e-5 * f64::from(gauge);
    let passes = (0.0..=6e-5).contains(&time);
    let pulse = if passes {
        1.25 * (PI * time / 6e-5).sin()
    } else {
        0.0
    };
    format!("{:.4}", pulse / f64::from(1 + gauge))
}

fn time(k: u32) -> String {
    format!("{}.000e-6", 4 * i64::from(k) - 40)
}

fn table(header: &str, row: impl Fn(u32) -> String) -> String {
    let rows = (0..N).fold(String::new(), |mut rows, k| {
        writeln!(rows, "{}", row(k)).unwrap();
        rows
    });
    format!("{header}{rows}")
}

/// Asserts that the columns of a table are the gauges over the times of the test, to the bit.
fn expect_gauges(text: &str, columns: &[&str], time_unit: &str) -> Contents {
    let contents = read(text).unwrap();
    assert_eq!(names(&contents), columns, "{text}");
    for (gauge, series) in (0..).zip(&contents.series) {
        assert_eq!(series.abscissa, even(START, STEP), "{text}");
        assert_eq!(series.abscissa_axis.unit_text, time_unit, "{text}");
        assert_eq!(series.kind, SeriesKind::TimeResponse, "{text}");
        let printed: Vec<f64> = (0..N).map(|k| volts(gauge, k).parse().unwrap()).collect();
        assert_eq!(crate::series::values(series), printed, "{text}");
    }
    contents
}

#[test]
fn rigol_states_start_and_interval_behind_the_names() {
    // DS1000Z: the first column counts the samples
    let two = "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-4.000000e-05,4.000000e-06\n";
    let row = |k| format!("{k},{},{},", volts(0, k), volts(1, k));
    let contents = expect_gauges(&table(two, row), &["CH1 [Volt]", "CH2 [Volt]"], "s");
    assert!(contents.properties.is_empty(), "{:?}", contents.properties);
    let one = "X,CH1,Start,Increment,\nSequence,Volt,-4.000000e-05,4.000000e-06\n";
    let row = |k| format!("{k},{},", volts(0, k));
    expect_gauges(&table(one, row), &["CH1 [Volt]"], "s");
    // MSO5000, DHO800: no column counts the samples
    let row = |k| format!("{},{},,", volts(0, k), volts(1, k));
    for header in [
        "CH1V,CH2V,t0 =-4.000000e-05, tInc = 4.000000e-06,\n",
        "CH1V,CH2V,t0=-4.000000e-05,tInc=4.000000e-06\n",
    ] {
        expect_gauges(&table(header, row), &["CH1 [V]", "CH2 [V]"], "s");
    }
    let row = |k| format!("{},{},{}", time(k), volts(0, k), volts(1, k));
    let header = "Time(s),CH1V,CH2V\n";
    expect_gauges(&table(header, row), &["CH1 [V]", "CH2 [V]"], "s");
    // DS1000E: rows that end in a comma
    let row = |k| format!("{},{},{},", time(k), volts(0, k), volts(1, k));
    let header = "X,CH1,CH2,\nSecond,Volt,Volt,\n";
    expect_gauges(&table(header, row), &["CH1 [Volt]", "CH2 [Volt]"], "Second");
    // a missing sample
    let row = |k| format!("{},{},", k + k / 20, volts(0, k));
    insta::assert_snapshot!(
        read(table(one, row)).unwrap_err(),
        @"csv, line 3, column 1: abscissa is 2.1e1 in row 21, expected 2e1 to within half a step of 1e0"
    );
}

#[test]
fn settings_name_the_columns_below_them() {
    let pair = |k| format!("{},{}", time(k), volts(0, k));
    let single = |k| volts(0, k);
    // Keysight Infiniium, with and without times
    let infiniium = "Revision:,0\nType:,raw\nStart:,0\nPoints:,40\nXDispOrg:,-4e-5\nXInc:,4.0000000e-06\nXOrg:,-4.0000000e-05\nXUnits:,Second\nYInc:,5e-5\nYOrg:,0\nYUnits:,Volt\nTime:,12:00:00\nMin Bandwidth:,0\nData:\n";
    let titled = format!("Channel 1\n{}", infiniium.replace(":,", ":"));
    for header in [infiniium, titled.as_str()] {
        expect_gauges(&table(header, pair), &[" [Volt]"], "Second");
        expect_gauges(&table(header, single), &["Data: [Volt]"], "Second");
    }
    // Yokogawa: rows that begin with a comma, or with the time
    let yokogawa = "\"Header Size\",16\n\"Model Name\",\"DLM3054\"\n\"BlockNumber\",1\n\"TraceName\",\"CH1\",\"CH2\"\n\"BlockSize\",40,40\n\"VUnit\",\"V\",\"V\"\n\"SampleRate\",2.5E+05,2.5E+05\n\"HResolution\",4.0000000E-06,4.0000000E-06\n\"HOffset\",-4.0000000E-05,-4.0000000E-05\n\"HUnit\",\"s\",\"s\"\n\"DisplayPointNo.\",1\n\"Date\",\"2024/05/08\"\n\"Time\",\"12:00:00.000\"\n\n";
    let channels = ["CH1 [V]", "CH2 [V]"];
    let row = |k| format!(",{},{},", volts(0, k), volts(1, k));
    expect_gauges(&table(yokogawa, row), &channels, "s");
    let row = |k| format!("{},{},{}", time(k), volts(0, k), volts(1, k));
    expect_gauges(&table(yokogawa, row), &channels, "s");
    // GW Instek; in its fast mode, the samples are counts from the trigger's first sample
    let instek = |mode: &str| {
        format!(
            "Format,1.0E,\nMemory Length,40,\nSource,CH1,\nVertical Units,V,\nVertical Scale,5.0e-01,\nHorizontal Units,S,\nHorizontal Scale,1.0e-05,\nSampling Period,4.000e-06,\nTime,,\nMode,{mode},\nWaveform Data,\n"
        )
    };
    let row = |k| format!("{},{},", time(k), volts(0, k));
    expect_gauges(&table(&instek("Detail"), row), &["CH1 [V]"], "s");
    let counts = read(table(&instek("Fast"), |k| format!("{},", k % 7))).unwrap();
    assert_eq!(names(&counts), ["CH1 []"]);
    assert_eq!(counts.series[0].abscissa, even(0.0, STEP));
    assert_eq!(counts.series[0].abscissa_axis.unit_text, "s");
}

#[test]
fn settings_supply_the_units_of_named_columns() {
    let tektronix = "Model,MDO3014\n\nPoint Format,Y,\nHorizontal Units,s,\nHorizontal Scale,1e-05,\nSample Interval,4e-06,\nRecord Length,40,\nGating,0.0% to 100.0%,\nVertical Units,V,V\n,\n,\nLabel,,\nTIME,CH1,CH2\n";
    let row = |k| format!("{},{},{}", time(k), volts(0, k), volts(1, k));
    let contents = expect_gauges(&table(tektronix, row), &["CH1 [V]", "CH2 [V]"], "s");
    assert_eq!(property(&contents.properties, "Model"), Some("MDO3014"));
    // the stated interval contradicts the times
    let other = tektronix.replace("4e-06", "4e-10");
    let said = read(table(&other, row)).unwrap_err().to_string();
    assert!(said.contains("half a step of 4e-10"), "{said}");
    // Siglent: the heading of the times states their unit, the settings state the unit of the
    // display
    let siglent = "Record Length,Analog:40,\nSample Interval,Analog:4.000000E-06,\nVertical Units,CH1:V,,\nHorizontal Units,us,\nModel Number,SDS1104X-U,\nSource,CH1\nSecond,Value\n";
    let row = |k| format!("{},{}", time(k), volts(0, k));
    expect_gauges(&table(siglent, row), &["Value [V]"], "s");
    let siglent = "Record Length,Analog:40\nSample Rate,250000.0\nVertical Scale,CH1: 0.05\nHorizontal Scale, 0.000010000\nSecond,Volt\n";
    expect_gauges(&table(siglent, row), &[" [Volt]"], "Second");
    // the stated interval has another unit than the times
    let row = |k: u32| format!("{},{}", 4 * i64::from(k) - 40, volts(0, k));
    let text = table("Sample Interval,4e-06,s\ntime [us],CH1 [V]\n", row);
    assert_eq!(read(text).unwrap().series[0].abscissa, even(-40.0, 4.0));
}

#[test]
fn names_and_units_of_a_column_are_found_wherever_they_stand() {
    let said = |header: &str, separator: &str| {
        let row = |k: u32| [format!("{k}"), volts(0, k), volts(1, k)].join(separator);
        let contents = read(table(header, row)).unwrap();
        let unit = contents.series[0].abscissa_axis.unit_text.clone();
        (names(&contents).join(", "), unit)
    };
    let expected = |columns: &str| (columns.to_owned(), "s".to_owned());
    // catman: texts for each column below its name and unit, and a tab at the end of the rows
    let catman = "catman\tV5.4\nSample rate: 1 Hz\n\nTime  1 - default sample rate\tForce\tGauge\t\ns\tkN\tV\t\ndt = 1 s\tdt = 1 s\tdt = 1 s\t\nFilter off\tBessel 1 kHz\tBessel 1 kHz\t\nTime\tSG full bridge\tSG quarter bridge\t\n\n";
    assert_eq!(said(catman, "\t"), expected("Force [kN], Gauge [V]"));
    for header in [
        "Time,Force,Gauge\ns,kN,V\ntime of the trigger,bar 1,bar 2\n",
        "s,kN,V\nTime,Force,Gauge\n",
        "Time (s),Force,Gauge (V)\n,kN,\n",
        "Time / s,Force / kN,Gauge / (V)\n",
        "Time in s,Force in kN,Gauge in V\n",
        "Time_s,Force_kN,Gauge_V\n",
        "\"Time, s\",\"Force, kN\",\"Gauge, V\"\n",
    ] {
        let found = said(header, ",");
        assert_eq!(found, expected("Force [kN], Gauge [V]"), "{header}");
    }
    // Rohde & Schwarz
    assert_eq!(
        said("in s,C1 in V,C2 in V\n", ","),
        expected("C1 [V], C2 [V]")
    );
    // names that only end like a unit
    assert_eq!(
        said("Time_s,end_A,end_V\n", ","),
        expected("end_A [], end_V []")
    );
    assert_eq!(
        said("time [s],strain in bar,force in N\n", ","),
        expected("strain in bar [], force in N []")
    );
}

#[test]
fn marks_of_lost_samples_are_no_numbers() {
    let infinite = [
        ("9.9E37", 1.0),
        ("+9.90000E+37", 1.0),
        ("-9.9E37", -1.0),
        ("3.402823E+38", 1.0),
        ("1.#INF", 1.0),
        ("-1.#INF00", -1.0),
        ("OVERFLOW", 1.0),
        ("-OL", -1.0),
        ("\u{221e}", 1.0),
        ("-Infinity", -1.0),
    ];
    let lost = ["9.91E37", "+9.910000E+37", "9.9E34", "1.#QNAN", "-1.#IND"];
    let text = |mark: &str| {
        let row = |k| match k {
            15 => format!("{},{mark}", time(k)),
            _ => format!("{},{}", time(k), volts(0, k)),
        };
        table("Time (s),gauge (V)\n", row)
    };
    let marks = infinite.iter().map(|(mark, _)| *mark).chain(lost);
    for mark in marks {
        let contents = read(text(mark)).unwrap();
        let found = real(&contents, 0)[15];
        match infinite.iter().find(|(known, _)| *known == mark) {
            Some((_, sign)) => assert_eq!(found, sign * f64::INFINITY, "{mark}"),
            None => assert!(found.is_nan(), "{mark}: {found}"),
        }
        let others = real(&contents, 0).iter().filter(|value| value.is_finite());
        assert_eq!(others.count(), 39, "{mark}");
        let together = contents.records(&labio::Provenance::of_bytes("csv", b""));
        assert!(together.records.is_empty());
        assert!(
            matches!(&together.left_out[0], LabioError::NoChannel { part: "ordinate", found, .. }
                if found.ends_with("at sample 15")),
            "{mark}: {}",
            together.left_out[0]
        );
    }
    // texts that are not marks of lost samples
    for mark in ["---", "overload!", "1.#", "9.9E37V"] {
        let said = read(text(mark)).unwrap_err().to_string();
        assert!(
            said.contains("line 17, column 2: cell is"),
            "{mark}: {said}"
        );
    }
}
