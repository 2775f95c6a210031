//! LabVIEW measurement files: dialects written by hand, and the measured files if they are
//! available.

use testbed::measured;

use labio::format::lvm::Lvm;
use labio::format::{Reader, Strictness};
use labio::{Abscissa, Contents, LabioError, SeriesKind};
use proptest::prelude::*;

use crate::series::{defects, even, property, real, refusals};

const SEPARATORS: [(char, &str); 3] = [('\t', "Tab"), (',', "Comma"), (';', "Semicolon")];

/// A file made from `text`, in which every `|` stands for the separator.
fn file(text: &str, separator: char, name: &str) -> String {
    text.trim_start()
        .replace("{name}", name)
        .replace('|', &separator.to_string())
}

const NO_X: &str = "
LabVIEW Measurement|
Writer_Version|2
Reader_Version|2
Separator|{name}
Decimal_Separator|.
Multi_Headings|No
X_Columns|No
Time_Pref|Absolute
Operator|tester
***End_of_Header***|
|
Channels|2|||
Samples|2|2||
Date|2020/01/01|2020/01/02||
Y_Unit_Label|N|m/s^2||
X_Dimension|Time|Time||
X0|5.0E-1|5.0E-1||
Delta_X|2.5E-1|2.5E-1||
***End_of_Header***|||
X_Value|hammer|end A|Comment
|1.5|-2.25E+1|
|2.5|3|seen
|3.5|4
|4.5|5";

fn read(text: &str) -> Result<Contents, LabioError> {
    Lvm.read(text.as_bytes(), Strictness::Strict)
}

#[test]
fn packets_under_one_header_become_blocks() {
    for (separator, name) in SEPARATORS {
        let text = file(NO_X, separator, name);
        assert!(Lvm.recognises(text.as_bytes()));
        let contents = read(&text).unwrap();
        let names: Vec<&str> = contents.series.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["hammer", "end A", "hammer", "end A"]);
        assert_eq!(real(&contents, 0), [1.5, 2.5]);
        assert_eq!(real(&contents, 1), [-22.5, 3.0]);
        assert_eq!(real(&contents, 2), [3.5, 4.5]);
        assert_eq!(real(&contents, 3), [4.0, 5.0]);
        let last = &contents.series[3];
        assert_eq!(last.kind, SeriesKind::TimeResponse);
        assert_eq!(last.abscissa, even(0.5, 0.25));
        assert_eq!(last.ordinate_axis.unit_text, "m/s^2");
        assert_eq!(property(&last.properties, "block"), Some("2"));
        assert_eq!(property(&last.properties, "Date"), Some("2020/01/02"));
        assert_eq!(property(&contents.properties, "Operator"), Some("tester"));
        assert_eq!(
            property(&contents.properties, "comment in line 22"),
            Some("seen")
        );
    }
}

#[test]
fn lines_may_end_as_they_like_and_numbers_have_a_comma() {
    let text = file(NO_X, ';', "Semicolon").replace("Decimal_Separator;.", "Decimal_Separator;,");
    let (header, rest) = text.split_at(text.find("X0").unwrap());
    let text = format!("{header}{}", rest.replace('.', ",")).replace('\n', "\r\n");
    let contents = read(&text).unwrap();
    assert_eq!(real(&contents, 1), [-22.5, 3.0]);
    assert_eq!(contents.series[0].abscissa, even(0.5, 0.25));
    // no tag for the decimal mark: it follows from the numbers of the header
    let untagged = text.replace("Decimal_Separator;,\r\n", "");
    assert_eq!(real(&read(&untagged).unwrap(), 1), [-22.5, 3.0]);
}

const ONE_X: &str = "
LabVIEW Measurement
Separator|{name}
Multi_Headings|No
X_Columns|One
***End_of_Header***

Channels|3
Samples|3|1|3
X0|0.0|0.0|0.0
Delta_X|0.333333333|1.0|0.333333333
***End_of_Header***
X_Value|a|slow|b|Comment
0.000000|1|7|4|
0.333333|2||5|
0.666667|3||6|
";

#[test]
fn a_rounded_column_of_times_gives_way_to_the_tags() {
    let contents = read(&file(ONE_X, ',', "Comma")).unwrap();
    assert_eq!(contents.series[0].abscissa, even(0.0, 0.333333333));
    assert_eq!(contents.series[1].abscissa, even(0.0, 1.0));
    assert_eq!(real(&contents, 1), [7.0]);
    assert_eq!(real(&contents, 2), [4.0, 5.0, 6.0]);
}

#[test]
fn a_column_of_times_that_contradicts_the_tags_is_taken_as_it_stands() {
    let text = file(ONE_X, ',', "Comma").replace("0.333333,", "0.433333,");
    let contents = read(&text).unwrap();
    let uneven = Abscissa::Uneven(vec![0.0, 0.433333, 0.666667]);
    assert_eq!(contents.series[0].abscissa, uneven);
    assert_eq!(contents.series[2].abscissa, uneven);
    // the column of abscissae belongs to the first channel and to those with the same tags
    assert_eq!(contents.series[1].abscissa, even(0.0, 1.0));
}

#[test]
fn packets_with_a_column_of_times_start_where_it_says() {
    let more = "10.000000|8|9|8|\n10.333333|8||8|\n10.666667|8||8|\n";
    let contents = read(&file(&format!("{ONE_X}{more}"), '\t', "Tab")).unwrap();
    assert_eq!(contents.series.len(), 6);
    assert_eq!(contents.series[3].abscissa, even(10.0, 0.333333333));
    let on = "1.000000|8|9|8|\n1.333333|8||8|\n1.666667|8||8|\n";
    let contents = read(&file(&format!("{ONE_X}{on}"), '\t', "Tab")).unwrap();
    // the slow channel has one sample per packet and no abscissa column of its own
    assert_eq!(contents.series.len(), 4);
    assert_eq!(real(&contents, 0), [1.0, 2.0, 3.0, 8.0, 8.0, 8.0]);
}

const MULTI_X: &str = "
LabVIEW Measurement|
Separator|{name}
Multi_Headings|Yes
X_Columns|Multi
***End_of_Header***|

Channels|2|||
***Start_Special***
anything;, goes
***End_Special***
Samples|2||3|
X0|0.0||1.0|
Delta_X|0.1||0.2|
***End_of_Header***||||
X_Value|u|X_Value|v|Comment
0.0|1|1.0|4
0.1|2|1.2|5
||1.4|6

Channels|1|||
Samples|2||
X0|0.0||
Delta_X|0.000977||
Y_Unit_Label|g||
***End_of_Header***||||
X_Value|w|Comment
0.000000|1
0.000977|2
";

#[test]
fn segments_have_headers_and_columns_of_their_own() {
    let contents = read(&file(MULTI_X, '\t', "Tab")).unwrap();
    assert_eq!(contents.series.len(), 3);
    assert_eq!(real(&contents, 1), [4.0, 5.0, 6.0]);
    assert_eq!(contents.series[1].abscissa, even(1.0, 0.2));
    let last = &contents.series[2];
    // the step is kept as written, and a property names the rate that it may represent
    assert_eq!(last.abscissa, even(0.0, 0.000977));
    assert_eq!(
        property(&last.properties, "customary rate"),
        Some("1024 Hz, a power of two")
    );
    assert_eq!(property(&last.properties, "segment"), Some("2"));
    assert_eq!(
        property(&contents.series[0].properties, "customary rate"),
        None
    );
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let tab = file(NO_X, '\t', "Tab");
    let comma = file(ONE_X, ',', "Comma");
    let wrong = [
        String::new(),
        "LabVIEW".to_owned(),
        tab[..60].to_owned(),
        tab[..tab.find("X0").unwrap()].to_owned(),
        tab.replace("Separator\tTab", "Separator\tComma"),
        tab.replace("X_Columns\tNo", "X_Columns\tNone"),
        tab.replace("Decimal_Separator\t.", "Decimal_Separator\t'"),
        comma.replace("X_Columns,One\n", ""),
        tab.replace("Channels\t2", "Channels\t-2"),
        tab.replace("Channels\t2", "Channels\t18446744073709551615"),
        tab.replace("Channels\t2", "Channels\t4000000000"),
        tab.replace("Samples\t2", "Samples\t2.5"),
        tab.replace("Delta_X\t2.5E-1\t2.5E-1", "Delta_X\t2.5E-1"),
        tab.replace("Delta_X\t2.5E-1", "Delta_X\tinf"),
        tab.replace("X_Value\thammer", "hammer"),
        tab.replace("2.5\t3\tseen", "2.5\t3..\tseen"),
        tab.replace("2.5\t3\tseen", "2.5\t3\tseen\tnot awaited"),
        tab.replace("\t2.5\t3\tseen", "2.5\t3\tseen"),
        tab[..tab.len() - 5].to_owned(),
        tab[..tab.len() - 2].to_owned(),
        comma.replace("0.333333,2,,5", "0.333333,2,8,5"),
        comma.replace("0.333333,2,,5", "one third,2,,5"),
        comma.replace("0.333333,2,,5", "NaN,2,,5"),
    ]
    .map(|text| read(&text));
    insta::assert_snapshot!(refusals(wrong), @r"
    lvm, line 1: first line is ``, expected `LabVIEW Measurement`
    lvm, line 1: first line is `LabVIEW`, expected `LabVIEW Measurement`
    lvm, line 4: tag is `Separ`, expected a tag, a separator and a value
    lvm, line 16: header is the end of the file, expected ***End_of_Header***
    lvm, line 4: Separator is `Comma`, expected the name of the character after the tag, '\t'
    lvm, line 7: X_Columns is `None`, expected `No`, `One` or `Multi`
    lvm, line 5: Decimal_Separator is `'`, expected `.` or, unless it separates columns, `,`
    lvm, line 4: X_Columns is absent, expected the tag before the end of the header
    lvm, line 12: Channels is `-2`, expected a count above 0
    lvm, line 20: row of labels is 4 columns, expected those of the 18446744073709551615 channels stated in the header
    lvm, line 20: row of labels is 4 columns, expected those of the 4000000000 channels stated in the header
    lvm, line 13, column 2: Samples is `2.5`, expected a count
    lvm, line 12: Delta_X is absent, expected the tag for every channel, since there is no column of X values
    lvm, line 18, column 2: Delta_X is `inf`, expected a finite number
    lvm, line 20: row of labels is `hammer`, expected `X_Value`
    lvm, line 22, column 3: end A is `3..`, expected a number
    lvm, line 22: row is `not awaited`, expected no column after the comments
    lvm, line 22, column 1: X_Value is `2.5`, expected an empty cell, as `X_Columns` is `No`
    lvm, line 24: Samples is 3 rows, expected 2 rows or a multiple, as stated in the header
    lvm, line 24, column 3: end A is ``, expected a number
    lvm, line 14, column 3: slow is `8`, expected an empty cell after 1 samples
    lvm, line 14, column 1: X_Value is `one third`, expected a finite number
    lvm, line 14, column 1: X_Value is `NaN`, expected a finite number
    ");
}

#[test]
fn a_tolerant_reading_lists_what_it_passed_over() {
    let text = file(NO_X, '\t', "Tab")
        .replace("2.5\t3\tseen", "2.5\t3..\tseen")
        .replace("\n\t4.5\t5", "");
    let contents = Lvm.read(text.as_bytes(), Strictness::Tolerant).unwrap();
    let values = real(&contents, 1);
    assert_eq!(values[0], -22.5);
    assert!(values[1].is_nan());
    assert_eq!(real(&contents, 2), [3.5]);
    insta::assert_snapshot!(defects(&contents), @r"
    lvm, line 22, column 3: end A is `3..`, expected a number
    lvm, line 23: Samples is 3 rows, expected 2 rows or a multiple, as stated in the header
    ");
}

/// A file of every layout.
pub(crate) fn whole() -> [Vec<u8>; 3] {
    [NO_X, ONE_X, MULTI_X].map(|text| file(text, '\t', "Tab").into_bytes())
}

proptest! {
    /// Wherever a file is cut off after the header, a strict reading never returns fewer samples
    /// than the header announces.
    #[test]
    fn a_cut_is_noticed(cut in 1..40_usize) {
        let text = file(ONE_X, ',', "Comma");
        let text = &text[..text.len() - cut];
        if let Ok(contents) = read(text) {
            prop_assert_eq!(real(&contents, 0).len(), 3);
            prop_assert_eq!(real(&contents, 2).len(), 3);
        }
    }
}

#[test]
fn the_measured_files_read() {
    let Some(folder) = measured::folder() else {
        return;
    };
    // file; number of series; samples of the first and of the last series; step of the first series
    // and the rate that it may represent; true if a strict reading accepts the file, false if it
    // has one defect
    let (shock, power) = (Some(1.953125e-5), Some("1024 Hz, a power of two"));
    #[rustfmt::skip]
    let rows = [
        ("hammer/long_single_header_multi_ch.lvm", 6, [8192, 8192], Some(0.000977), power, true),
        ("shock/Test_001.lvm", 6, [51200, 5], shock, None, true),
        ("shock/Test_002.lvm", 6, [51200, 5], shock, None, true),
        ("shock/Test_003.lvm", 6, [51200, 5], shock, None, true),
        ("shock/Test_017.lvm", 6, [51200, 5], shock, None, true),
        ("lvm/multi_time_column.lvm", 2, [3, 3], shock, None, false),
        ("lvm/no_decimal_separator.lvm", 3, [4, 4], Some(0.00025), None, true),
        ("lvm/short.lvm", 2, [10, 10], Some(3.90625e-5), None, true),
        ("lvm/short_new_line_end.lvm", 2, [10, 10], Some(3.90625e-5), None, true),
        ("lvm/with_comments.lvm", 3, [9, 9], None, None, true),
        ("lvm/with_empty_fields.lvm", 7, [7, 7], Some(0.001), None, false),
    ];
    for (name, n_series, [first, last], step, rate, is_whole) in rows {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        assert!(Lvm.recognises(&bytes[..bytes.len().min(4096)]), "{name}");
        let contents = Lvm.read(&bytes, Strictness::Tolerant).unwrap();
        assert_eq!(contents.defects.len(), usize::from(!is_whole), "{name}");
        let strictly = Lvm.read(&bytes, Strictness::Strict);
        assert_eq!(strictly.is_ok(), is_whole, "{name}");
        let series = &contents.series;
        assert_eq!(series.len(), n_series, "{name}");
        let lengths = [
            series[0].ordinate.len(),
            series[n_series - 1].ordinate.len(),
        ];
        assert_eq!(lengths, [first, last], "{name}");
        let even = match series[0].abscissa {
            Abscissa::Even { step, .. } => Some(step),
            Abscissa::Uneven(_) => None,
        };
        assert_eq!(even, step, "{name}");
        let found = property(&series[0].properties, "customary rate");
        assert_eq!(found, rate, "{name}");
    }
}
