//! Separators, preambles, names, units and the abscissa of a table.

use labio::format::DecimalMark;
use labio::format::csv::{CsvAbscissa, CsvDialect, CsvOptions, CsvSeparator, read_with};

use super::*;

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

    // Tektronix: the interval is stated next to times with few digits
    let tek = "Model,DPO4034\nSample Interval,4e-10,s\nRecord Length,4\n\nTIME,CH1\n-1.0e-09,0.5\n-6.0e-10,0.6\n-2.0e-10,0.7\n2.0e-10,0.8\n";
    let contents = read(tek).unwrap();
    assert_eq!(contents.series[0].abscissa, even(-1.0e-9, 4e-10));
    assert_eq!(property(&contents.properties, "Model"), Some("DPO4034"));
    assert_eq!(
        property(&contents.properties, "Sample Interval"),
        Some("4e-10 s")
    );

    // Tektronix, older: the preamble is in the columns before the first samples
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
    // a force and a temperature are not abscissae
    assert_eq!(
        axis("F,T\n0,1\n1,2\n2,3\n"),
        ("index".to_owned(), even(0.0, 1.0))
    );
    // a column without a name is the abscissa only if it increases evenly
    assert_eq!(
        axis("0.1,7\n0.2,8\n0.3,7\n"),
        (String::new(), even(0.1, 0.1))
    );
    let contents = read("0.3,7\n0.2,8\n0.1,7\n").unwrap();
    assert_eq!(contents.series.len(), 2);
    // uneven times are used unchanged
    assert_eq!(
        axis("t,F\n0,1\n1,2\n4,3\n").1,
        Abscissa::Uneven(vec![0.0, 1.0, 4.0])
    );
    // without a second column, times are samples over the index
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
    // a line above the numbers that contains a number is not a row of names
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
    // times at 51.2 kHz with five digits over 0.2 s: the step is known to 5e-5
    let contents = read(column(1.0 / 51200.0, 4, 10_000)).unwrap();
    let Abscissa::Even { step, .. } = contents.series[0].abscissa else {
        panic!("expected an even abscissa")
    };
    assert!((step * 51200.0 - 1.0).abs() < 5e-5);
    // three digits do not determine the step, and this is reported
    let rough = column(1.0 / 51200.0, 2, 10_000);
    insta::assert_snapshot!(read(&rough).unwrap_err(), @"csv, line 2, column 1: abscissa is repeated values; their digits give the step 1.9501950195019504e-5 to within 5.0e-8, expected a step known to within a relative 0.0001, or a stated step");
    let tolerant = Csv.read(rough.as_bytes(), Strictness::Tolerant).unwrap();
    assert_eq!(tolerant.defects.len(), 1);
    let given = |step| {
        let options = CsvOptions::default().with_abscissa(CsvAbscissa::Step(step));
        read_with(rough.as_bytes(), Strictness::Strict, &options)
    };
    let step = 1.0 / 51200.0;
    assert_eq!(given(step).unwrap().series[0].abscissa, even(0.0, step));
    // times that were rounded before they were printed with more digits
    let twice = b"f,H\n0.0000e0,1\n7.8100e-1,2\n1.5600e0,3\n2.3400e0,4\n";
    let options = CsvOptions::default().with_abscissa(CsvAbscissa::Step(0.78125));
    let contents = read_with(twice, Strictness::Strict, &options).unwrap();
    assert_eq!(contents.series[0].abscissa, even(0.0, 0.78125));
    insta::assert_snapshot!(given(2e-5).unwrap_err(), @"csv, line 2, column 1: abscissa is 4.49e-4 in row 24, expected 4.6e-4 to within half a step of 2e-5");
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
    // a comma that may be a separator or a decimal mark
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
    csv, line 1: row of names or units is `1 2`, expected 3 cells, as in the rows of numbers
    csv, line 9: row of names or units is not in the header, expected one of its 1 lines
    csv, line 2: row is `10;5;0,914`, expected a row of 1 numbers
    the csv file contains no data
    ");
}

/// Headers of two makes of oscilloscope, whose units are words; one calls its channels 1 and 2.
#[test]
fn rows_of_units_in_words_are_units() {
    for (header, name) in [
        ("x-axis,1,2\nsecond,Volt,Volt\n", "1"),
        ("Source,CH1,CH2\nSecond,Volt,Volt\n", "CH1"),
    ] {
        let text = format!("{header}-1.00000E-4,0.5,1\n+0.00000E+0,0.25,2\n+1.00000E-4,0.75,3\n");
        let contents = read(text).unwrap();
        let first = &contents.series[0];
        assert_eq!((contents.series.len(), first.name.as_str()), (2, name));
        assert_eq!(first.ordinate_axis.unit_text, "Volt");
        let Abscissa::Even { step, .. } = first.abscissa else {
            unreachable!("{:?}", first.abscissa)
        };
        // the six digits of the times
        assert!((step / 1e-4 - 1.0).abs() < 1e-5, "{step}");
        assert_eq!(first.abscissa_axis.unit.as_ref().unwrap().scale(), 1.0);
    }
}
