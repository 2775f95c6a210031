//! Tables in text: dialects as instruments write them, round trips, and the measured files where
//! they are at hand.

use testbed::measured;

use labio::format::csv::{Csv, CsvAbscissa, CsvDialect, CsvOptions, CsvSeparator, read_with};
use labio::format::{DecimalMark, Reader, Strictness, Writer};
use labio::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};
use num_complex::Complex64;
use proptest::prelude::*;

use crate::series::{axis, defects, even, property, real, refusals};

fn read(bytes: impl AsRef<[u8]>) -> Result<Contents, LabioError> {
    Csv.read(bytes.as_ref(), Strictness::Strict)
}

fn names(contents: &Contents) -> Vec<String> {
    contents
        .series
        .iter()
        .map(|s| format!("{} [{}]", s.name, s.ordinate_axis.unit_text))
        .collect()
}

#[test]
fn oscilloscopes_are_read_with_their_preambles() {
    // PicoScope: units in parentheses, a blank line, an overload as infinity
    let pico =
        "Time,Channel A,Channel B\n(ms),(V),(mV)\n\n-0.5,0.01,3\n0.0,\u{221e},4\n0.5,0.02,5\n";
    let contents = read(pico).unwrap();
    assert_eq!(names(&contents), ["Channel A [V]", "Channel B [mV]"]);
    assert_eq!(real(&contents, 0)[1], f64::INFINITY);
    assert_eq!(contents.series[0].abscissa, even(-0.5, 0.5));
    assert_eq!(contents.series[0].abscissa_axis.unit_text, "ms");
    assert_eq!(contents.series[0].kind, SeriesKind::TimeResponse);

    // Tektronix: the interval stands beside times in few digits
    let tek = "Model,DPO4034\nSample Interval,4e-10,s\nRecord Length,4\n\nTIME,CH1\n-1.0e-09,0.5\n-6.0e-10,0.6\n-2.0e-10,0.7\n2.0e-10,0.8\n";
    let contents = read(tek).unwrap();
    assert_eq!(contents.series[0].abscissa, even(-1.0e-9, 4e-10));
    assert_eq!(property(&contents.properties, "Model"), Some("DPO4034"));
    assert_eq!(
        property(&contents.properties, "Sample Interval"),
        Some("4e-10 s")
    );

    // Tektronix, older: the preamble stands in the columns before the first samples
    let old = "Record Length,2.5e+03,,0.0,0.02,\nSample Interval,1.0e-1,,0.1,0.04,\n,,,0.2,0.06,\n,,,0.3,0.08,\n";
    let contents = read(old).unwrap();
    assert_eq!(real(&contents, 0), [0.02, 0.04, 0.06, 0.08]);
    assert_eq!(contents.series[0].abscissa, even(0.0, 0.1));

    // LeCroy
    let lecroy = "LECROYWS424,12345,Waveform\nSegments,1,SegmentSize,3\nSegment,TrigTime,TimeSinceSegment1\n#1,26-Feb-2007 15:05:48,0\nTime,Ampl\n0,0.25\n1e-3,0.5\n2e-3,0.75\n";
    let contents = read(lecroy).unwrap();
    assert_eq!(names(&contents), ["Ampl []"]);
    assert_eq!(contents.series[0].abscissa, even(0.0, 1e-3));
}

#[test]
fn the_abscissa_is_found_by_name_and_unit() {
    let axis = |text: &str| {
        let contents = read(text).unwrap();
        (
            contents.series[0].abscissa_axis.label.clone(),
            contents.series[0].abscissa.clone(),
        )
    };
    let even = |start, step| Abscissa::Even { start, step };
    assert_eq!(
        axis("F,Time\n1,0\n2,1\n3,2\n"),
        ("Time".to_owned(), even(0.0, 1.0))
    );
    assert_eq!(
        axis("Dwell [ms],F\n0,1\n2,2\n4,3\n"),
        ("Dwell".to_owned(), even(0.0, 2.0))
    );
    assert_eq!(
        axis("f,H\n0,1\n0.25,2\n0.5,3\n"),
        ("f".to_owned(), even(0.0, 0.25))
    );
    // a force and a temperature are no abscissae
    assert_eq!(
        axis("F,T\n0,1\n1,2\n2,3\n"),
        ("index".to_owned(), even(0.0, 1.0))
    );
    // without names: only if it increases evenly
    assert_eq!(
        axis("0.1,7\n0.2,8\n0.3,7\n"),
        (String::new(), even(0.1, 0.1))
    );
    let contents = read("0.3,7\n0.2,8\n0.1,7\n").unwrap();
    assert_eq!(contents.series.len(), 2);
    // uneven times are taken as they stand
    assert_eq!(
        axis("t,F\n0,1\n1,2\n4,3\n").1,
        Abscissa::Uneven(vec![0.0, 1.0, 4.0])
    );
    // one column is no abscissa of nothing
    assert_eq!(axis("t\n0\n1\n4\n").0, "index");
}

#[test]
fn names_and_units_are_told_apart() {
    let columns = |text: &str| names(&read(text).unwrap());
    assert_eq!(columns("t,F\ns,N\n0,1\n1,2\n"), ["F [N]"]);
    assert_eq!(
        columns("t,F,x\n[s],[furlong],[]\n0,1,2\n1,2,3\n"),
        ["F [furlong]", "x []"]
    );
    assert_eq!(columns("Time (s)\tF (N)\n0\t1\n1\t2\n"), ["F [N]"]);
    // a line above that holds a number is no row of names
    assert_eq!(columns("Channels,2\ns,V\n0,1\n1,2\n"), ["s []", "V []"]);
    assert_eq!(columns("run 7,left\nt,F\n0,1\n1,2\n"), ["F []"]);
}

#[test]
fn complex_numbers_and_short_columns_are_columns() {
    let text =
        "# freq, H (m/N), coherence\n0.0+0.0j,1+2j,0.5\n1.0+0.0j,-1e-3-2e-3j,\n2.0+0.0j,0+0j,\n";
    let contents = read(text).unwrap();
    assert_eq!(names(&contents), ["H [m/N]", "coherence []"]);
    let values = vec![
        Complex64::new(1.0, 2.0),
        Complex64::new(-1e-3, -2e-3),
        Complex64::new(0.0, 0.0),
    ];
    assert_eq!(contents.series[0].ordinate, Ordinate::Complex(values));
    assert_eq!(contents.series[0].abscissa, even(0.0, 1.0));
    assert_eq!(real(&contents, 1), [0.5]);
}

#[test]
fn times_in_few_digits_are_no_clock() {
    let column = |step: f64, digits: usize, n: u32| {
        let rows: String = (0..n)
            .map(|i| format!("{:.digits$e},{i}\n", f64::from(i) * step))
            .collect();
        format!("Time/s,F\n{rows}")
    };
    // five digits of 51.2 kHz over 0.2 s: the step is known to 5e-5
    let contents = read(column(1.0 / 51200.0, 4, 10_000)).unwrap();
    let Abscissa::Even { step, .. } = contents.series[0].abscissa else {
        panic!("expected an even abscissa")
    };
    assert!((step * 51200.0 - 1.0).abs() < 5e-5);
    // three digits do not tell it, and say so
    let rough = column(1.0 / 51200.0, 2, 10_000);
    insta::assert_snapshot!(read(&rough).unwrap_err(), @"csv, line 2, column 1: abscissa is values that repeat; their digits give a step of 1.9501950195019504e-5 within 5.0e-8, expected a step known to 0.0001 of itself, or one given beforehand");
    let tolerant = Csv.read(rough.as_bytes(), Strictness::Tolerant).unwrap();
    assert_eq!(tolerant.defects.len(), 1);
    let given = |step| {
        let options = CsvOptions::default().with_abscissa(CsvAbscissa::Step(step));
        read_with(rough.as_bytes(), Strictness::Strict, &options)
    };
    let step = 1.0 / 51200.0;
    assert_eq!(given(step).unwrap().series[0].abscissa, even(0.0, step));
    // rounded before they were printed in more digits
    let twice = b"f,H\n0.0000e0,1\n7.8100e-1,2\n1.5600e0,3\n2.3400e0,4\n";
    let options = CsvOptions::default().with_abscissa(CsvAbscissa::Step(0.78125));
    let contents = read_with(twice, Strictness::Strict, &options).unwrap();
    assert_eq!(contents.series[0].abscissa, even(0.0, 0.78125));
    insta::assert_snapshot!(given(2e-5).unwrap_err(), @"csv, line 2, column 1: abscissa is 4.49e-4 in row 24, expected 4.6e-4 within half a step, by the step of 2e-5");
}

#[test]
fn what_is_known_beforehand_overrides_what_is_found() {
    let text = "1 2\n10;5;0,914\n20;6;0,537\n";
    let dialect = CsvDialect::new(CsvSeparator::Semicolon, DecimalMark::Comma, 1);
    let options = CsvOptions::default()
        .with_dialect(dialect.clone())
        .with_abscissa(CsvAbscissa::Column(2));
    let contents = read_with(text.as_bytes(), Strictness::Strict, &options).unwrap();
    assert_eq!(real(&contents, 1), [0.914, 0.537]);
    assert_eq!(contents.series[0].abscissa, even(5.0, 1.0));
    let index = CsvOptions::default().with_abscissa(CsvAbscissa::Index);
    assert_eq!(
        read_with(text.as_bytes(), Strictness::Strict, &index)
            .unwrap()
            .series
            .len(),
        3
    );
    // a comma that may be either
    let single = CsvOptions::default().with_dialect(CsvDialect::new(
        CsvSeparator::Semicolon,
        DecimalMark::Comma,
        0,
    ));
    let contents = read_with(b"0,914\n0,537\n", Strictness::Strict, &single).unwrap();
    assert_eq!(real(&contents, 0), [0.914, 0.537]);
    assert_eq!(
        CsvDialect::of(b"a;b\n[s];[N]\n1,5;2\n").unwrap(),
        CsvDialect::new(CsvSeparator::Semicolon, DecimalMark::Comma, 2)
            .with_names(1)
            .with_units(2)
    );

    let wrong = [
        CsvOptions::default().with_abscissa(CsvAbscissa::Column(4)),
        CsvOptions::default().with_dialect(dialect.clone().with_names(1)),
        CsvOptions::default().with_dialect(dialect.clone().with_units(9)),
        CsvOptions::default().with_dialect(CsvDialect::new(
            CsvSeparator::Tab,
            DecimalMark::Comma,
            1,
        )),
        CsvOptions::default().with_dialect(CsvDialect::new(
            CsvSeparator::Tab,
            DecimalMark::Comma,
            9,
        )),
    ]
    .map(|options| read_with(text.as_bytes(), Strictness::Strict, &options));
    insta::assert_snapshot!(refusals(wrong), @r"
    column of the abscissa, from 1 to the number of columns: found 4, expected 3
    csv, line 1: row of names or units is `1 2`, expected 3 cells, as the rows of numbers have
    csv, line 9: row of names or units is not in the header, expected one of its 1 lines
    csv, line 2: row is `10;5;0,914`, expected a row of 1 numbers
    the csv file holds no data
    ");
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let wrong = [
        "",
        "\n \n",
        "nothing but words\n",
        "0,914\n0,537\n",
        "t,F\n0,1\n1,oops\n2,3\n",
        "t,F\n0,1\n1,2,3\n2,3\n",
        "t,F\n0,1\n1,\n2,3\n",
        "t,F\n0,1\n,2\n2,3\n",
        "t,F\n0,1\nNaN,2\n2,3\n",
        "t,F\n0,1\n1,2\n2,3\n]1[JAL03-01\n",
        "t,F,\n0,1,\n1,2,\n2,3,4\n",
        "t,F\n0,1\n1+1j,1\n2,1\n",
        "# abscissa = even, start 0.0, step 0.5\nt,F\n0.0,1\n0.6,2\n",
    ]
    .map(read);
    insta::assert_snapshot!(refusals(wrong), @r"
    the csv file holds no data
    the csv file holds no data
    csv, line 1: table is not found, expected rows of numbers within the first 1000 lines
    csv, line 1: comma is either a separator or a decimal mark, expected names above the numbers, or an explicit dialect
    csv, line 3, column 2: cell is `oops`, expected a number
    csv, line 4: row is `2,3`, expected a row of 3 numbers
    csv, line 4, column 2: cell is a number under 1 empty, expected no gap in the column
    csv, line 4, column 1: cell is a number under 1 empty, expected no gap in the column
    csv, line 3, column 1: abscissa is `NaN`, expected a finite number
    csv, line 5: row is `]1[JAL03-01`, expected a row of 2 numbers
    csv, line 4: row is `2,3,4`, expected a row of 2 numbers
    csv, line 3, column 1: abscissa is `1+1j`, expected a real number
    csv, line 3, column 1: abscissa is another value than start and step give in row 2, expected the abscissa that the header announces
    ");
}

#[test]
fn a_tolerant_reading_lists_what_it_passed_over() {
    let text = "t,F,a\n0,1,5\n1,oops,6\n2,,7\n3,4,8\nend of file\n";
    let contents = Csv.read(text.as_bytes(), Strictness::Tolerant).unwrap();
    let force = real(&contents, 0);
    assert_eq!((force[0], force[3]), (1.0, 4.0));
    assert!(force[1].is_nan() && force[2].is_nan());
    assert_eq!(real(&contents, 1), [5.0, 6.0, 7.0, 8.0]);
    insta::assert_snapshot!(defects(&contents), @r"
    csv, line 3, column 2: cell is `oops`, expected a number
    csv, line 5, column 2: cell is a number under 1 empty, expected no gap in the column
    csv, line 6: row is `end of file`, expected a row of 3 numbers
    ");
    // no more of them than can be read
    let junk = format!("t,F\n0,1\n1,2\n{}", "junk\n".repeat(5000));
    let contents = Csv.read(junk.as_bytes(), Strictness::Tolerant).unwrap();
    assert_eq!(contents.defects.len(), 101);
    assert!(
        contents.defects[100]
            .to_string()
            .contains("4900 further defects")
    );
}

#[test]
fn only_tables_are_recognised() {
    for text in ["t,F\n0,1\n1,2\n", "0.5\n0.6\n", "\u{feff}f;H\n0,1;2\n"] {
        assert!(Csv.recognises(text.as_bytes()), "{text}");
    }
    let wave = b"RIFF\x24\0\0\0WAVEfmt 1,2\n1,2\n";
    let lvm = b"LabVIEW Measurement\t\n1\t2\n1\t2\n";
    for bytes in [
        &wave[..],
        lvm,
        b"",
        b"some text\nof 3 words\n",
        b"\x93NUMPY\x01\0 1,2\n3,4\n",
    ] {
        assert!(!Csv.recognises(bytes));
    }
    // a head that ends within a row, and within a character of UTF-16
    let long: String = std::iter::once("t,F\n".to_owned())
        .chain((0..2000).map(|i| format!("{i},{i}.5\n")))
        .collect();
    assert!(Csv.recognises(&long.as_bytes()[..4096]));
    let wide: Vec<u8> = std::iter::once(0xfeff)
        .chain(long.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    assert!(Csv.recognises(&wide[..4096]));
    assert_eq!(real(&read(&wide).unwrap(), 0).len(), 2000);
}

pub(crate) fn write(contents: &Contents) -> Result<Vec<u8>, LabioError> {
    let mut bytes = Vec::new();
    Csv.write(contents, &mut bytes)?;
    Ok(bytes)
}

pub(crate) fn sample() -> Contents {
    let mut contents = Contents::of_format("csv");
    contents
        .properties
        .push(("Operator".to_owned(), "S. \u{d6}deen".to_owned()));
    let series = |name: &str, kind, ordinate| Series {
        name: name.to_owned(),
        kind,
        abscissa: even(-0.1, 0.1),
        ordinate,
        abscissa_axis: axis("Time", "s"),
        ordinate_axis: axis("", ""),
        properties: Vec::new(),
    };
    let mut force = series(
        "F, \"left\"",
        SeriesKind::TimeResponse,
        Ordinate::Real(vec![1.0, -2.5e-300]),
    );
    force.ordinate_axis = axis("", "N");
    force.properties.push(("block".to_owned(), "2".to_owned()));
    contents.series.push(force);
    contents.series.push(series(
        "",
        SeriesKind::Other(27),
        Ordinate::Complex(vec![Complex64::new(-0.0, f64::NEG_INFINITY)]),
    ));
    contents.series.push(series(
        "end A",
        SeriesKind::FrequencyResponse,
        Ordinate::Real(vec![f64::INFINITY, 0.1, 1e22]),
    ));
    contents
}

#[test]
fn a_table_is_written_with_all_that_it_means() {
    let written = write(&sample()).unwrap();
    insta::assert_snapshot!(String::from_utf8(written.clone()).unwrap(), @r#"
    # Operator = S. Ödeen
    # column 2: block = 2
    # column 3: kind = function type 27
    # column 4: kind = frequency response
    # abscissa = even, start -0.1, step 0.1
    Time,"F, ""left""",,end A
    [s],[N],[],[]
    -0.1,1.0,-0.0-infj,inf
    0.0,-2.5e-300,,0.1
    0.1,,,1e22
    "#);
    let back = read(&written).unwrap();
    assert_eq!(back.series, sample().series);
    assert_eq!(back.properties, sample().properties);
}

#[test]
fn what_a_table_cannot_hold_is_refused() {
    let with = |change: fn(&mut Contents)| {
        let mut contents = sample();
        change(&mut contents);
        write(&contents).unwrap_err().to_string()
    };
    let refusals = [
        with(|c| c.series.clear()),
        with(|c| {
            c.series
                .iter_mut()
                .for_each(|s| s.ordinate = Ordinate::Real(Vec::new()));
        }),
        with(|c| c.series[0].abscissa = even(0.0, 0.2)),
        with(|c| c.series[1].abscissa_axis.unit_text = "ms".to_owned()),
        with(|c| c.series[1].name = "two\nlines".to_owned()),
        with(|c| c.series[1].name = " padded".to_owned()),
        with(|c| c.properties[0].0 = "a = b".to_owned()),
        with(|c| c.properties[0].1 = "two\nlines".to_owned()),
        with(|c| c.properties[0].0 = "abscissa".to_owned()),
        with(|c| {
            c.series
                .iter_mut()
                .for_each(|s| s.abscissa_axis.label = "#".to_owned());
        }),
        with(|c| {
            for (s, name) in c.series.iter_mut().zip(["1", "2", "3"]) {
                s.abscissa_axis.label = String::new();
                s.name = name.to_owned();
            }
        }),
        with(|c| {
            c.series
                .iter_mut()
                .for_each(|s| s.abscissa = even(f64::NAN, 0.2));
        }),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r#"
    csv cannot hold contents without a sample
    csv cannot hold contents without a sample
    csv cannot hold `F, "left"` and `end A` in one table: they have different abscissae
    csv cannot hold `` and `end A` in one table: they have different abscissae
    csv cannot hold the name or unit `two\nlines`
    csv cannot hold the name or unit ` padded`
    csv cannot hold the property `a = b` with `S. Ödeen`
    csv cannot hold the property `Operator` with `two\nlines`
    csv cannot hold a property called `abscissa`
    csv cannot hold an abscissa called `#`, as a comment begins like that
    csv cannot hold names that are all empty or numbers
    csv cannot hold the abscissa of `F, "left"`, which is not finite
    "#);
}

fn any_series(n: usize) -> impl Strategy<Value = (String, String, Ordinate)> {
    let real = proptest::collection::vec(any::<f64>(), 0..=n).prop_map(Ordinate::Real);
    let complex =
        proptest::collection::vec((any::<f64>(), any::<f64>()), 1..=n).prop_map(|values| {
            Ordinate::Complex(
                values
                    .iter()
                    .map(|&(re, im)| Complex64::new(re, im))
                    .collect(),
            )
        });
    (
        "[a-zA-Z,;\"()/\u{b5} ]{0,8}",
        "[a-zA-Z/^()0-9]{0,6}",
        prop_oneof![real, complex],
    )
}

fn bits(ordinate: &Ordinate) -> Vec<u64> {
    // every NaN is written alike
    let bits = |x: f64| {
        if x.is_nan() {
            f64::NAN.to_bits()
        } else {
            x.to_bits()
        }
    };
    match ordinate {
        Ordinate::Real(values) => values.iter().map(|&x| bits(x)).collect(),
        Ordinate::Complex(values) => values
            .iter()
            .flat_map(|z| [bits(z.re), bits(z.im)])
            .collect(),
    }
}

proptest! {
    #[test]
    fn whatever_is_written_reads_back(
        (uneven, columns) in (1..8_usize).prop_flat_map(|n| (
            proptest::option::of(proptest::collection::vec(-1e300..1e300_f64, n)),
            proptest::collection::vec(any_series(n), 1..4),
        )),
        start in -1e3..1e3_f64,
        step in prop_oneof![1e-7..1.0_f64, Just(0.1), Just(1.0 / 51200.0)],
    ) {
        let mut contents = Contents::of_format("csv");
        for (name, unit, ordinate) in columns {
            let abscissa = match &uneven {
                Some(values) => Abscissa::Uneven(values[..ordinate.len()].to_vec()),
                None => Abscissa::Even { start, step },
            };
            contents.series.push(Series {
                name, kind: SeriesKind::TimeResponse, abscissa, ordinate,
                abscissa_axis: axis("Time", "s"),
                ordinate_axis: axis("", &unit),
                properties: Vec::new(),
            });
        }
        // names with blanks around them and tables without samples are refused
        if let Ok(bytes) = write(&contents) {
            let back = read(&bytes).unwrap();
            prop_assert_eq!(back.series.len(), contents.series.len());
            for (found, given) in back.series.iter().zip(&contents.series) {
                prop_assert_eq!(&found.name, &given.name);
                prop_assert_eq!(&found.ordinate_axis, &given.ordinate_axis);
                prop_assert_eq!(&found.abscissa, &given.abscissa);
                prop_assert_eq!(bits(&found.ordinate), bits(&given.ordinate));
            }
            prop_assert_eq!(write(&back).unwrap(), bytes);
        }
    }

}

/// A pulse in units of the last digit that is written.
fn pulse(k: usize) -> f64 {
    f64::from(u8::try_from(k * k % 251).unwrap()) - 100.0
}

#[test]
fn r18_a_preamble_with_empty_rows_stands_beside_its_table() {
    // as oscilloscopes write it: settings in the first rows, one of which is left empty
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
    // with the channel and its unit among the settings
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
    // as NumPy's savetxt writes it
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
    // a name without a unit beside one with it
    let contents = read("# time [ms] count\n0 1\n1 5\n2 7\n").unwrap();
    assert_eq!(names(&contents), ["count []"]);
    assert_eq!(contents.series[0].abscissa_axis.unit_text, "ms");
}

/// Times of single precision in a wide table, as programs hand them on that keep samples in it.
fn single_precision(separator: &str, header: &str, n: usize, rate_hz: f64, start: f64) -> String {
    let mut file = header.to_owned();
    for k in 0..n {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "single precision is what is tested"
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
        assert!(steps_differ, "the times tell their step by themselves");
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
    // a rate that leaves the last times behind by more than half a step
    let file = single_precision(",", "Time/s,strain\n", n, rate_hz, start);
    let error = labio::format::read_bytes_at(file.as_bytes(), 31.255e6).unwrap_err();
    assert!(
        matches!(&error, LabioError::Malformed { field, expected, .. }
            if field == "abscissa" && expected.contains("half a step")),
        "{error}"
    );
    assert!(labio::format::read_bytes_at(file.as_bytes(), 0.0).is_err());
    // times in three digits that repeat
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
    // what is written of many channels with many properties is read again
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

fn measured(file: &str) -> Option<Vec<u8>> {
    Some(std::fs::read(measured::folder()?.join(file)).unwrap())
}

#[test]
fn the_measured_tables_read() {
    let mut said = String::new();
    for file in [
        "shpb/impact_compression_epoxy_resin_sample_01_raw_voltage.csv",
        "shpb/impact_compression_epoxy_resin_experiment_details_en-US.txt",
        "shpb/epoxy/raw_strain.csv",
        "shpb/pmma-13/180303_171828_Ch1.csv",
        "shpb/copper/gauge_strain_records.csv",
        "dma/pyvisco_freq_user_raw.csv",
        "dma/glassy-polymer/T25.txt",
        "tapered-rod/axial_wavenumber_est_30.txt",
        "tapered-rod/beam_input_FRF.txt",
        "tapered-rod/beam_transfer_FRF.txt",
        "tapered-rod/rod_input_FRF_acc.txt",
        "tapered-rod/rod_transfer_FRF_acc.txt",
    ] {
        let Some(bytes) = measured(file) else { return };
        let recognised = Csv.recognises(&bytes);
        said += &format!(
            "{file}, {}recognised\n",
            if recognised { "" } else { "not " }
        );
        match Csv.read(&bytes, Strictness::Strict) {
            Ok(_) => said += "  strictly: reads\n",
            Err(error) => said += &format!("  strictly: {error}\n"),
        }
        let Ok(contents) = Csv.read(&bytes, Strictness::Tolerant) else {
            continue;
        };
        let names = names(&contents);
        let series = &contents.series[contents.series.len() - 1];
        let abscissa = match &series.abscissa {
            Abscissa::Even { start, step } => format!("{start} + i * {step:.6e}"),
            Abscissa::Uneven(values) => {
                format!("uneven, {} to {}", values[0], values[values.len() - 1])
            }
        };
        said += &format!(
            "  {} series of {}, over {} [{}]: {abscissa}; {:?} {} .. {}\n",
            names.len(),
            series.ordinate.len(),
            series.abscissa_axis.label,
            series.abscissa_axis.unit_text,
            series.kind,
            names[0],
            names[names.len() - 1],
        );
    }
    insta::assert_snapshot!(said, @r"
    shpb/impact_compression_epoxy_resin_sample_01_raw_voltage.csv, recognised
      strictly: csv, line 2, column 1: abscissa is values that repeat; their digits give a step of 7.990399519976e-8 within 2.8e-10, expected a step known to 0.0001 of itself, or one given beforehand
      2 series of 20000, over Time [s]: -0.000198 + i * 7.990400e-8; TimeResponse incident_bar_signal/voltage [] .. transmission_bar_signal/voltage []
    shpb/impact_compression_epoxy_resin_experiment_details_en-US.txt, not recognised
      strictly: csv, line 1: table is not found, expected rows of numbers within the first 1000 lines
    shpb/epoxy/raw_strain.csv, recognised
      strictly: csv, line 2, column 1: abscissa is values that repeat; their digits give a step of 7.990399519976e-8 within 2.8e-10, expected a step known to 0.0001 of itself, or one given beforehand
      2 series of 20000, over Time [s]: -0.000198 + i * 7.990400e-8; TimeResponse incident_bar_signal/¦Å [] .. transmission_bar_signal/¦Å []
    shpb/pmma-13/180303_171828_Ch1.csv, recognised
      strictly: reads
      1 series of 50000, over  [s]: -0.00008 + i * 8.000000e-9; TimeResponse  [] ..  []
    shpb/copper/gauge_strain_records.csv, recognised
      strictly: reads
      11 series of 801, over time [s]: uneven, 0 to 0.0020000000949949026; TimeResponse gauge1_incident_bar_strain [] .. specimen_mean_compressive_le33 []
    dma/pyvisco_freq_user_raw.csv, recognised
      strictly: reads
      4 series of 210, over f [Hz]: uneven, 0.1 to 100; General E_stor [MPa] .. Set [-]
    dma/glassy-polymer/T25.txt, recognised
      strictly: csv, line 63: row is `]6[JAL03-01_Freq0.1-100_`, expected a row of 20 numbers
      19 series of 60, over t [s]: uneven, 0 to 637.419; TimeResponse Index [#] .. Eta* [MPas]
    tapered-rod/axial_wavenumber_est_30.txt, recognised
      strictly: reads
      20 series of 3201, over frequency []: uneven, 0 to 5000; General at 0.15 m (1) [] .. at 1.35 m (4) []
    tapered-rod/beam_input_FRF.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: 0 + i * 7.812500e-1; General real(accelerance) [] .. imag(accelerance) []
    tapered-rod/beam_transfer_FRF.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: 0 + i * 7.812500e-1; General real(accelerance) [] .. imag(accelerance) []
    tapered-rod/rod_input_FRF_acc.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: uneven, 0 to 5000; General real(accelerance) [] .. imag(accelerance) []
    tapered-rod/rod_transfer_FRF_acc.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: uneven, 0 to 5000; General real(accelerance) [] .. imag(accelerance) []
    ");
}
