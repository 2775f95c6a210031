//! Tables as oscilloscopes and other programs write them.

use super::*;

/// A pulse; its samples are integers, in units of the last written digit.
fn pulse(k: usize) -> f64 {
    f64::from(u8::try_from(k * k % 251).unwrap()) - 100.0
}

#[test]
fn r18_a_preamble_with_empty_rows_stands_beside_its_table() {
    // a table as oscilloscopes write it: settings in the first rows, one of which is empty
    let settings = [
        "\"Record Length\",400,\"Points\"",
        "\"Sample Interval\",8.00000000e-009,s",
        "\"Trigger Point\",80,\"Samples\"",
        "\"Trigger Time\",7.83260388e-009,s",
        "\"\",,",
        "\"Horizontal Offset\",-6.40000000e-007,s",
    ];
    let mut file = String::new();
    for k in 0..400 {
        let beside = settings.get(k).unwrap_or(&",,");
        let time = -6.4e-7 + 8e-9 * k as f64;
        file += &format!("{beside},{time:.8e},{:.4e}\r\n", 1e-3 * pulse(k));
    }
    let contents = read(&file).unwrap();
    assert_eq!(contents.series.len(), 1);
    let series = &contents.series[0];
    assert_eq!(series.abscissa, even(-6.4e-7, 8e-9));
    assert_eq!(series.abscissa_axis.unit_text, "s");
    assert_eq!(series.kind, SeriesKind::TimeResponse);
    let values = real(&contents, 0);
    let written: Vec<f64> = (0..400)
        .map(|k| format!("{:.4e}", 1e-3 * pulse(k)).parse().unwrap())
        .collect();
    assert_eq!(values, written);
    let found: Vec<(&str, &str)> = contents
        .properties
        .iter()
        .map(|(key, value)| (key.as_str(), value.as_str()))
        .collect();
    assert_eq!(
        found,
        [
            ("Record Length", "400 Points"),
            ("Sample Interval", "8.00000000e-009 s"),
            ("Trigger Point", "80 Samples"),
            ("Trigger Time", "7.83260388e-009 s"),
            ("Horizontal Offset", "-6.40000000e-007 s"),
        ]
    );
    // the settings include the channel and its unit
    let mut file = String::new();
    let settings = [
        "Record Length,4.0e+02,",
        "Sample Interval,2.0e-06,",
        ",,",
        "Source,CH1,",
        "Vertical Units,V,",
        "Horizontal Units,s,",
    ];
    for k in 0..400 {
        let beside = settings.get(k).unwrap_or(&",,");
        file += &format!("{beside},{:.7},{:.5},\n", 2e-6 * k as f64, pulse(k));
    }
    let contents = read(&file).unwrap();
    assert_eq!(names(&contents), ["CH1 [V]"]);
    assert_eq!(contents.series[0].abscissa_axis.unit_text, "s");
    assert_eq!(real(&contents, 0)[7], pulse(7));
}

#[test]
fn r18_names_above_numbers_between_blanks_keep_their_units() {
    // a table as NumPy's savetxt writes it
    let table: String = (0..200)
        .map(|k| {
            format!(
                "{:.18e} {:.18e} {:.18e}\n",
                k as f64 / 51_200.0,
                pulse(k),
                0.25 * pulse(k)
            )
        })
        .collect();
    for header in [
        "# time [s] force [N] acceleration [m/s^2]\n",
        "# time [s] hammer force [N] end A [m/s^2]\n",
        "# time [s], hammer force [N], end A [m/s^2]\n",
        "# time [s]\thammer force [N]\tend A [m/s^2]\n",
        "# time(s);force(N);end A(m/s^2)\n",
        "# time/s force/N acceleration/m/s^2\n",
        "# test 7 of the rod\n# sampled on a Monday\n# time force acceleration\n# s N m/s^2\n",
        "# time force acceleration\n# [s] [N] [m/s^2]\n",
    ] {
        let contents = read(format!("{header}{table}")).unwrap();
        let units: Vec<&str> = contents
            .series
            .iter()
            .map(|series| series.ordinate_axis.unit_text.as_str())
            .collect();
        assert_eq!(units, ["N", "m/s^2"], "{header}");
        for series in &contents.series {
            assert!(
                !series.name.is_empty() && !series.name.contains(['[', ',', '(']),
                "{header}"
            );
            assert_eq!(series.abscissa_axis.label, "time", "{header}");
            assert_eq!(series.abscissa_axis.unit_text, "s", "{header}");
            assert_eq!(series.abscissa, even(0.0, 1.0 / 51_200.0), "{header}");
        }
        let expected: Vec<f64> = (0..200).map(|k| 0.25 * pulse(k)).collect();
        assert_eq!(real(&contents, 1), expected);
    }
    // two columns, of which only one has a unit
    let contents = read("# time [ms] count\n0 1\n1 5\n2 7\n").unwrap();
    assert_eq!(names(&contents), ["count []"]);
    assert_eq!(contents.series[0].abscissa_axis.unit_text, "ms");
}

/// A table of times in single precision printed with many digits, as written by programs that keep
/// samples in single precision.
fn single_precision(separator: &str, header: &str, n: usize, rate_hz: f64, start: f64) -> String {
    let mut file = header.to_owned();
    for k in 0..n {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the test needs times in single precision"
        )]
        let time = f64::from((start + k as f64 / rate_hz) as f32);
        file += &format!("{time:e}{separator}{:e}\n", pulse(k % 300));
    }
    file
}

#[test]
fn r18_times_of_single_precision_take_a_stated_rate() {
    let (rate_hz, n, start) = (31.25e6, 4000, -2.5e-5);
    for (separator, header) in [
        (",", "Time/s,strain\n"),
        (" ", "# time [s] strain [1]\n"),
        (",", ""),
    ] {
        let file = single_precision(separator, header, n, rate_hz, start);
        let steps_differ = read(&file)
            .map(|contents| !matches!(contents.series[0].abscissa, Abscissa::Even { step, .. } if step < 0.5))
            .unwrap();
        assert!(steps_differ, "the times alone must not determine the step");
        let contents = labio::format::read_bytes_at(file.as_bytes(), rate_hz).unwrap();
        let series = &contents.series[0];
        let Abscissa::Even { start: found, step } = series.abscissa else {
            panic!("{header}: uneven");
        };
        assert_eq!(step, 1.0 / rate_hz);
        assert!((found - start).abs() < 1e-11, "{found}");
        assert_eq!(series.abscissa_axis.unit_text, "s");
        assert_eq!(series.ordinate.len(), n);
    }
    // a rate from which the last times deviate by more than half a step
    let file = single_precision(",", "Time/s,strain\n", n, rate_hz, start);
    let error = labio::format::read_bytes_at(file.as_bytes(), 31.255e6).unwrap_err();
    assert!(
        matches!(&error, LabioError::Malformed { field, expected, .. }
            if field == "abscissa" && expected.contains("half a step")),
        "{error}"
    );
    assert!(labio::format::read_bytes_at(file.as_bytes(), 0.0).is_err());
    // times with three digits that repeat
    let rounded: String = (0..2000)
        .map(|k| format!("{:.2E},{k}\n", -1.98e-4 + 8e-8 * f64::from(k)))
        .collect();
    let file = format!("Time/s,gauge\n{rounded}");
    assert!(read(&file).is_err());
    let contents = labio::format::read_bytes_at(file.as_bytes(), 12.5e6).unwrap();
    assert_eq!(contents.series[0].abscissa, even(-1.98e-4, 8e-8));
}

#[test]
fn r18_a_table_is_known_however_much_stands_above_it() {
    let table = "time [s],force [N]\n0,1\n0.5,2\n1,4\n";
    let comments: String = (0..3000)
        .map(|i| {
            format!(
                "# column {}: setting {i} = the value of a long setting\n",
                2 + i % 8
            )
        })
        .collect();
    let words: String = (0..900)
        .map(|i| format!("setting {i}: the value of a long setting\n"))
        .collect();
    for above in [comments, words] {
        assert!(above.len() > 30_000);
        let file = format!("{above}{table}");
        assert!(Csv.recognises(file.as_bytes()));
        let contents = labio::format::read_bytes(file.as_bytes()).unwrap();
        assert_eq!(contents.format, "csv");
        assert_eq!(names(&contents), ["force [N]"]);
        assert_eq!(real(&contents, 0), [1.0, 2.0, 4.0]);
    }
    // many channels with many properties are written and read again
    let mut contents = sample();
    let one = contents.series[0].clone();
    contents.series = (0..30)
        .map(|channel| Series {
            name: format!("channel {channel}"),
            properties: (0..50)
                .map(|i| {
                    (
                        format!("setting {i}"),
                        format!("value {i} of channel {channel}"),
                    )
                })
                .collect(),
            ..one.clone()
        })
        .collect();
    let back = labio::format::read_bytes(&write(&contents).unwrap()).unwrap();
    assert_eq!(back.series, contents.series);
    assert_eq!(back.properties, contents.properties);
}

#[test]
fn r18_a_time_may_have_its_unit_behind_a_stroke_below() {
    let contents = read("time_s,strain\n0,1\n2.5,2\n5,3\n").unwrap();
    assert_eq!(contents.series[0].abscissa_axis.unit_text, "s");
    assert_eq!(contents.series[0].kind, SeriesKind::TimeResponse);
    assert_eq!(names(&contents), ["strain []"]);
}
