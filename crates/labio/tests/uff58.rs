//! Universal files as programs write them. Each file here is put together by hand from the
//! description of data set 58, not by the writer under test.

use testbed::measured;

use std::fmt::Write as _;

use labio::format::uff58::{
    ByteOrder, Encoding, N_DATA_SETS, Precision, SKIPPED, STEP_HALF_UNIT, Uff58, Uff58Writer,
};
use labio::format::{self, Reader, Strictness, Writer};
use labio::{Abscissa, Contents, LabioError, Ordinate, Place, Series, SeriesAxis, SeriesKind};
use num_complex::Complex64;
use proptest::prelude::*;

use crate::series::{defects, even, property, refusals, values};

/// Records 1 to 11 with the fields that matter here.
fn header(function_type: u8, data_type: u8, n: usize, even: u8) -> String {
    let mut text = String::from("end A\nNONE\n21-Nov-26 12:00:00\nNONE\nNONE\n");
    writeln!(text, "{function_type:5}         7    0         0 NONE               1   1 rig               2  -3").unwrap();
    writeln!(
        text,
        "{data_type:10}{n:10}{even:10}  2.50000E-01  1.25000E-01  0.00000E+00"
    )
    .unwrap();
    text.push_str("        17    0    0    0 Time                 s                   \n");
    text.push_str("        12    0    0    0 Acceleration         m/s^2               \n");
    text.push_str("        13    0    0    0 Force                N                   \n");
    text.push_str("         0    0    0    0 NONE                 NONE                \n");
    text
}

fn ascii(function_type: u8, data_type: u8, n: usize, even: u8, rows: &str) -> Vec<u8> {
    format!(
        "    -1\n    58\n{}{rows}    -1\n",
        header(function_type, data_type, n, even)
    )
    .into_bytes()
}

/// A 58b with `n_bytes` in its first line and `end` behind its data.
fn binary(order: u8, n_bytes: usize, header: &str, data: &[u8], end: &str) -> Vec<u8> {
    let mut bytes = format!(
        "    -1\n    58b{order:6}{:6}{:12}{n_bytes:12}{:6}{:6}{:12}{:12}\n{header}",
        2, 11, 0, 0, 0, 0
    )
    .into_bytes();
    bytes.extend(data);
    bytes.extend(end.as_bytes());
    bytes
}

fn three_doubles() -> Vec<u8> {
    let three = [0.1_f64, 0.2, 0.3].iter();
    three.flat_map(|x| x.to_le_bytes()).collect()
}

fn strict(bytes: &[u8]) -> Result<Contents, LabioError> {
    Uff58.read(bytes, Strictness::Strict)
}

fn only_series(bytes: &[u8]) -> Series {
    let mut contents = strict(bytes).unwrap();
    assert_eq!(contents.series.len(), 1);
    contents.series.remove(0)
}

#[test]
fn the_header_is_told_in_full() {
    let series = only_series(&ascii(1, 2, 2, 1, "  1.00000E+00 -2.00000E+00\n"));
    assert_eq!(series.name, "end A");
    assert_eq!(series.kind, SeriesKind::TimeResponse);
    assert_eq!(series.abscissa, even(0.25, 0.125));
    assert_eq!(series.abscissa_axis.label, "Time");
    assert_eq!(series.ordinate_axis.unit_text, "m/s^2");
    let rest: String = series
        .properties
        .iter()
        .map(|(key, value)| format!("{key} `{value}`\n"))
        .collect();
    insta::assert_snapshot!(rest, @r"
    uff58.id3 `21-Nov-26 12:00:00`
    uff58.function_id `7`
    uff58.response_node `1`
    uff58.response_direction `1`
    uff58.reference_entity `rig`
    uff58.reference_node `2`
    uff58.reference_direction `-3`
    uff58.step_half_unit `5e-7`
    uff58.abscissa_type `17`
    uff58.ordinate_type `12`
    uff58.denominator_type `13`
    uff58.denominator_label `Force`
    uff58.denominator_unit `N`
    uff58.encoding `ascii`
    uff58.precision `single`
    ");
}

#[test]
fn each_layout_of_text_is_read() {
    let complex = |re, im| Complex64::new(re, im);
    let uneven = Abscissa::Uneven(vec![1.0, 2.0, 4.0]);
    let even = even(0.25, 0.125);
    let three = Ordinate::Real(vec![-0.5, 0.25, 8.0]);
    let three_complex = Ordinate::Complex(vec![
        complex(-0.5, 1.0),
        complex(0.25, 2.0),
        complex(8.0, 3.0),
    ]);
    #[rustfmt::skip]
    let cases = [
        (2, 1, "  -5.00000E-01  2.50000E-01  8.00000E+00\n".trim_start_matches(' '), &even, &three),
        (2, 0, "  1.00000E+00 -5.00000E-01  2.00000E+00  2.50000E-01  4.00000E+00  8.00000E+00\n", &uneven, &three),
        (5, 1, " -5.00000E-01  1.00000E+00  2.50000E-01  2.00000E+00  8.00000E+00  3.00000E+00\n", &even, &three_complex),
        (5, 0, "  1.00000E+00 -5.00000E-01  1.00000E+00  2.00000E+00  2.50000E-01  2.00000E+00\n  4.00000E+00  8.00000E+00  3.00000E+00\n", &uneven, &three_complex),
        (4, 1, " -5.000000000000E-01  2.500000000000E-01  8.000000000000E+00\n", &even, &three),
        (4, 0, "  1.00000E+00 -5.000000000000E-01  2.00000E+00  2.500000000000E-01\n  4.00000E+00  8.000000000000E+00\n", &uneven, &three),
        (6, 1, " -5.000000000000E-01  1.000000000000E+00  2.500000000000E-01  2.000000000000E+00\n  8.000000000000E+00  3.000000000000E+00\n", &even, &three_complex),
        (6, 0, "  1.00000E+00 -5.000000000000E-01  1.000000000000E+00\n  2.00000E+00  2.500000000000E-01  2.000000000000E+00\n  4.00000E+00  8.000000000000E+00  3.000000000000E+00\n", &uneven, &three_complex),
    ];
    for (data_type, spacing, rows, abscissa, ordinate) in cases {
        for text in [
            rows.to_owned(),
            rows.replace('E', "D"),
            rows.replace('E', "e"),
            rows.replace('\n', "\r\n"),
            rows.replace('\n', "    \n"),
        ] {
            let series = only_series(&ascii(4, data_type, 3, spacing, &text));
            assert_eq!(
                (&series.abscissa, &series.ordinate),
                (abscissa, ordinate),
                "type {data_type}, spacing {spacing}:\n{text}"
            );
        }
    }
}

#[test]
fn each_packing_of_58b_is_read_in_both_byte_orders() {
    let numbers = [1.0, -0.5, 1.5, 2.0, 0.25, 2.5, 4.0, 8.0, 3.5];
    let pick = |per_point: [bool; 3]| {
        numbers
            .into_iter()
            .zip(per_point.into_iter().cycle())
            .filter_map(|(x, wanted)| wanted.then_some(x))
    };
    let uneven = Abscissa::Uneven(vec![1.0, 2.0, 4.0]);
    let even = even(0.25, 0.125);
    let three = Ordinate::Real(vec![-0.5, 0.25, 8.0]);
    let three_complex = Ordinate::Complex(vec![
        Complex64::new(-0.5, 1.5),
        Complex64::new(0.25, 2.5),
        Complex64::new(8.0, 3.5),
    ]);
    for (spacing, abscissa) in [(1, &even), (0, &uneven)] {
        for (types, ordinate) in [([2, 4], &three), ([5, 6], &three_complex)] {
            let wanted = [spacing == 0, true, types == [5, 6]];
            let singles: Vec<f32> = pick(wanted).map(|x| x as f32).collect();
            let doubles: Vec<f64> = pick(wanted).collect();
            let [single, double] = types;
            let blocks: [(u8, u8, Vec<u8>); 4] = [
                (
                    single,
                    1,
                    singles.iter().flat_map(|x| x.to_le_bytes()).collect(),
                ),
                (
                    single,
                    2,
                    singles.iter().flat_map(|x| x.to_be_bytes()).collect(),
                ),
                (
                    double,
                    1,
                    doubles.iter().flat_map(|x| x.to_le_bytes()).collect(),
                ),
                (
                    double,
                    2,
                    doubles.iter().flat_map(|x| x.to_be_bytes()).collect(),
                ),
            ];
            for (data_type, order, data) in blocks {
                let file = binary(
                    order,
                    data.len(),
                    &header(4, data_type, 3, spacing),
                    &data,
                    "    -1\n",
                );
                let series = only_series(&file);
                assert_eq!(
                    (&series.abscissa, &series.ordinate),
                    (abscissa, ordinate),
                    "type {data_type}, order {order}"
                );
            }
        }
    }
}

#[test]
fn an_uneven_abscissa_may_be_single_beside_double_ordinates() {
    let mut data = Vec::new();
    for (x, y) in [(1.0_f32, 0.1_f64), (2.0, 0.2), (4.0, 0.3)] {
        data.extend(x.to_le_bytes());
        data.extend(y.to_le_bytes());
    }
    let series = only_series(&binary(
        1,
        data.len(),
        &header(1, 4, 3, 0),
        &data,
        "    -1\n",
    ));
    assert_eq!(series.abscissa, Abscissa::Uneven(vec![1.0, 2.0, 4.0]));
    assert_eq!(values(&series), [0.1, 0.2, 0.3]);
}

/// Test.Lab ends the data of a 58b with CR LF, and some of its versions with LF.
#[test]
fn a_line_end_before_the_separator_of_58b_is_no_data() {
    let data = three_doubles();
    for end in ["\r\n    -1\r\n", "\n    -1\n", "    -1\r\n", "    -1"] {
        assert_eq!(
            values(&only_series(&binary(
                1,
                24,
                &header(1, 4, 3, 1),
                &data,
                end
            ))),
            [0.1, 0.2, 0.3],
            "{end:?}"
        );
    }
}

/// Numbers of bytes that were computed for another type are common: half of it for complex values,
/// or for double ones.
#[test]
fn the_number_of_points_decides_where_58b_ends() {
    let data: Vec<u8> = [0.1_f64, 0.2, 0.3, 0.4]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    for stated in [0, 16, 32, 33, 999_999_999_999] {
        let series = only_series(&binary(1, stated, &header(4, 6, 2, 1), &data, "    -1\n"));
        assert_eq!(
            series.ordinate,
            Ordinate::Complex(vec![Complex64::new(0.1, 0.2), Complex64::new(0.3, 0.4)])
        );
    }
}

#[test]
fn bytes_that_look_like_a_separator_do_not_end_58b() {
    let data = *b"\n    -1\n    -1\nabcdefghi";
    let file = binary(1, 24, &header(1, 4, 3, 1), &data, "    -1\n");
    assert_eq!(values(&only_series(&file)).len(), 3);
}

#[test]
fn columns_that_touch_are_parted_where_they_end() {
    let rows = "-1.00000E+100-2.00000E+0003.0000000E+002.9911000E-02-10.00000E-05 5.00000E+00\n  6.00000E+00\n";
    let series = only_series(&ascii(1, 2, 7, 1, rows));
    assert_eq!(
        values(&series),
        [-1e100, -2.0, 3.0, 2.9911e-2, -1e-4, 5.0, 6.0]
    );
}

/// A negative number with three digits of exponent fills its twenty columns, and touches whatever
/// stands before it.
#[test]
fn words_for_what_is_not_finite_may_touch_the_next_number() {
    let numbers = [f64::NAN, -1e100, f64::NEG_INFINITY, -2.5e-300];
    let mut series = only_series(&ascii(1, 4, 1, 1, "  1.000000000000E+00\n"));
    series.ordinate = Ordinate::Real(numbers.to_vec());
    let bytes = written(&series, Encoding::AsRead, Precision::AsRead);
    let touching = b"                 NaN-1.000000000000E+100";
    assert!(bytes.windows(touching.len()).any(|part| part == touching));
    let again = only_series(&bytes);
    assert!(values(&again)[0].is_nan());
    assert_eq!(values(&again)[1..], numbers[1..]);
}

#[test]
fn a_file_without_a_data_set_is_not_written() {
    let mut bytes = Vec::new();
    let error = Uff58Writer::default()
        .write(&Contents::of_format("test"), &mut bytes)
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "uff58 cannot hold contents without a data set"
    );
    assert!(bytes.is_empty());
}

#[test]
fn numbers_that_do_not_keep_to_the_columns_are_parted_by_blanks() {
    let rows = " 1.2345678E-01 2.3456789E-01 3.4567891E-01\n 4.5678912E-01\n 5\t6.\n";
    let series = only_series(&ascii(1, 2, 6, 1, rows));
    assert_eq!(
        values(&series),
        [0.12345678, 0.23456789, 0.34567891, 0.45678912, 5.0, 6.0]
    );
}

/// An odd number of points in rows of two: the place of the point that is missing is filled with
/// zeros.
#[test]
fn zeros_that_fill_the_last_row_are_no_points() {
    let rows = "  5.00000E+00  9.93003E-01 -1.08420E-19  5.03501E+00  1.00135E+00  0.00000E+00\n  1.00000E+02  8.03837E-01  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n";
    let series = only_series(&ascii(4, 5, 3, 0, rows));
    assert_eq!(series.abscissa, Abscissa::Uneven(vec![5.0, 5.03501, 100.0]));
    let more = rows.replace(
        "1.00000E+02  8.03837E-01  0.00000E+00  0.00000E+00",
        "1.00000E+02  8.03837E-01  0.00000E+00  7.00000E+00",
    );
    assert!(strict(&ascii(4, 5, 3, 0, &more)).is_err());
}

#[test]
fn a_minus_one_inside_a_data_set_is_no_separator() {
    let text = header(1, 2, 1, 1)
        .replace("end A\n", "    -1 was the reading\n")
        .replace(
            "NONE               1   1 rig               2",
            "NONE              -1   1 rig              -1",
        );
    let file = format!("    -1\n    58\n{text}  1.00000E+00\n    -1\n");
    let series = only_series(file.as_bytes());
    assert_eq!(series.name, "-1 was the reading");
    assert_eq!(
        property(&series.properties, "uff58.response_node"),
        Some("-1")
    );
    // an ID line that is a separator by itself is still an ID line: records are counted
    let file = file.replace("    -1 was the reading\n", "    -1\n");
    assert_eq!(only_series(file.as_bytes()).name, "-1");
}

#[test]
fn lines_may_be_padded_to_80_columns() {
    let file = ascii(1, 2, 2, 1, "  1.00000E+00 -2.00000E+00\n");
    let padded: String = String::from_utf8(file)
        .unwrap()
        .lines()
        .map(|line| format!("{line:80}\r\n"))
        .collect();
    assert_eq!(values(&only_series(padded.as_bytes())), [1.0, -2.0]);
}

#[test]
fn a_superscript_survives_in_latin_1_and_utf_8() {
    let text = String::from_utf8(ascii(9, 2, 1, 1, "  1.00000E+00\n")).unwrap();
    let text = text.replace("m/s^2               ", "g\u{b2}/Hz               ");
    let latin_1: Vec<u8> = text
        .chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap())
        .collect();
    assert!(String::from_utf8(latin_1.clone()).is_err());
    for bytes in [latin_1, text.into_bytes()] {
        let series = only_series(&bytes);
        assert_eq!(series.ordinate_axis.unit_text, "g\u{b2}/Hz");
        assert_eq!(series.kind, SeriesKind::PowerSpectralDensity);
        let again = written(&series, Encoding::AsRead, Precision::AsRead);
        assert_eq!(only_series(&again), series);
    }
}

#[test]
fn other_data_sets_are_passed_over_and_told() {
    let mut file = b"    -1\n   151\nmodel\n    -1\n\n    -1\n   164\n         1SI: Meter (newton)\n        -1\n    -1\n".to_vec();
    file.extend(ascii(1, 2, 1, 1, "  1.00000E+00\n"));
    file.extend(b"    -1\n  2411\n    -1\n\n\x1a");
    let contents = strict(&file).unwrap();
    assert_eq!(contents.series.len(), 1);
    let skipped = ["151", "164", "2411"].map(|number| (SKIPPED.to_owned(), number.to_owned()));
    assert_eq!(contents.properties, skipped);
}

#[test]
fn a_file_without_a_data_set_58_says_so() {
    let contents = format::read_bytes(b"    -1\n   151\nmodel\n    -1\n").unwrap();
    assert!(contents.series.is_empty());
    assert_eq!(
        contents.properties.last().unwrap(),
        &(N_DATA_SETS.to_owned(), "0".to_owned())
    );
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let good = String::from_utf8(ascii(1, 2, 7, 1, "  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00\n  7.00000E+00\n")).unwrap();
    let data = three_doubles();
    let good_58b = binary(1, 24, &header(1, 4, 3, 1), &data, "    -1\n");
    let replace = |from: &str, to: &str| good.replacen(from, to, 1).into_bytes();
    let record_7 = |to: &str| replace("         2         7         1", to);
    let cases: Vec<Vec<u8>> = vec![
        Vec::new(),
        good.as_bytes()[..3 * 20].to_vec(),
        replace("    58\n", "  five\n"),
        replace("    1         7", "  300         7"),
        replace("    1         7", "    1       7.5"),
        record_7("         3         7         1"),
        record_7("         2        -7         1"),
        record_7("         2         7         2"),
        replace("  2.50000E-01", "    two point"),
        replace("  4.00000E+00", "  4.0000oE+00"),
        replace("  4.00000E+00", "*************"),
        record_7("         2         8         1"),
        record_7("         2         6         1"),
        record_7("         29999999999         1"),
        replace("  7.00000E+00\n    -1\n", "  7.00000E+00\n"),
        replace(
            "  7.00000E+00\n    -1\n",
            "  7.00000E+00\nsomething\n    -1\n",
        ),
        [good.as_bytes(), b"remark\n"].concat(),
        [b"    -1\n", good.as_bytes()].concat(),
        good_58b[..good_58b.len() - 10].to_vec(),
        good_58b[..good_58b.len() - 7].to_vec(),
        binary(3, 24, &header(1, 4, 3, 1), &data, "    -1\n"),
        String::from_utf8_lossy(&good_58b)
            .replacen("    58b     1     2", "    58b     1     1", 1)
            .into_bytes(),
        binary(
            1,
            24,
            &header(1, 4, 3, 1).replace("         4         3", "         4999999999"),
            &data,
            "    -1\n",
        ),
    ];
    insta::assert_snapshot!(refusals(cases.iter().map(|bytes| strict(bytes))), @r"
    the uff58 file holds no data
    uff58, line 9: record 7 is the end of the file, expected a line
    uff58, line 2: identifier line is `  five`, expected the number of a data set
    uff58, line 8: record 6, field 1 (function type) is `300`, expected 0 to 255
    uff58, line 8: record 6, field 2 (function identification) is `7.5`, expected an integer
    uff58, line 9: record 7, field 1 (ordinate data type) is `3`, expected 2, 4 (real, single or double) or 5, 6 (complex)
    uff58, line 9: record 7, field 2 (number of values) is `-7`, expected 0 or more
    uff58, line 9: record 7, field 3 (abscissa spacing) is `2`, expected 0 (uneven) or 1 (even)
    uff58, line 9: record 7, field 4 (abscissa minimum) is `two point`, expected a finite number
    uff58, line 14: record 12, value 4 is `4.0000oE+00`, expected a number
    uff58, line 14: record 12, value 3 is `3.00000E+00`, expected a number
    uff58, line 16: record 12, value 8 is the end of the data set, expected 8 values, as record 7 says
    uff58, line 15: record 12, after value 6, the last is `  7.00000E+00`, expected a line `    -1` that closes the data set
    uff58, line 16: record 12, value 8 is the end of the data set, expected 9999999999 values, as record 7 says
    uff58, line 16: record 12, after value 7, the last is the end of the file, expected a line `    -1` that closes the data set
    uff58, line 16: record 12, after value 7, the last is `something`, expected a line `    -1` that closes the data set
    uff58, line 17: line between data sets is `remark`, expected a line `    -1`
    uff58, line 2: identifier line is `    -1`, expected the number of a data set
    uff58, byte 549: record 12 (24 bytes stated) is 21 bytes to the end of the file, expected 24 bytes for the 3 values of record 7, and a line `    -1` after them
    uff58, byte 549: record 12 (24 bytes stated) is 24 bytes to the end of the file, expected 24 bytes for the 3 values of record 7, and a line `    -1` after them
    uff58, line 2: identifier line, byte order is 3, expected 1 (little-endian) or 2 (big-endian)
    uff58, line 2: identifier line, floating-point format is 1, expected 2 (IEEE 754), the only one that is read
    uff58, byte 548: record 12 (24 bytes stated) is 31 bytes to the end of the file, expected 7999999992 bytes for the 999999999 values of record 7, and a line `    -1` after them
    ");
}

#[test]
fn tolerantly_read_points_that_are_there_remain() {
    let first = ascii(1, 2, 9, 1, "  1.00000E+00  2.00000E+00  3.00000E+00\n");
    let second = ascii(1, 3, 1, 1, "  1.00000E+00\n");
    let third = ascii(1, 2, 1, 1, "  7.00000E+00\n");
    let file = [first, second, b"remark\n".to_vec(), third].concat();
    let contents = Uff58.read(&file, Strictness::Tolerant).unwrap();
    assert_eq!(
        contents
            .series
            .iter()
            .map(|series| values(series).to_vec())
            .collect::<Vec<_>>(),
        [vec![1.0, 2.0, 3.0], vec![7.0]]
    );
    insta::assert_snapshot!(defects(&contents), @r"
    uff58, line 15: record 12, value 4 is the end of the data set, expected 9 values, as record 7 says
    uff58, line 24: record 7, field 1 (ordinate data type) is `3`, expected 2, 4 (real, single or double) or 5, 6 (complex)
    uff58, line 31: line between data sets is `remark`, expected a line `    -1`
    ");

    // a 58b that ends early keeps its whole points
    let data = three_doubles();
    let cut = binary(1, 80, &header(1, 4, 10, 1), &data[..20], "");
    let contents = Uff58.read(&cut, Strictness::Tolerant).unwrap();
    assert_eq!(values(&contents.series[0]), [0.1, 0.2]);
    assert_eq!(contents.defects.len(), 1);
}

#[test]
fn places_behind_a_block_of_bytes_are_bytes() {
    let data = three_doubles();
    let mut file = binary(1, 24, &header(1, 4, 3, 1), &data, "    -1\n");
    let at = u64::try_from(file.len()).unwrap();
    file.extend(b"remark\n");
    match strict(&file).unwrap_err() {
        LabioError::Malformed { place, .. } => assert_eq!(place, Place::Byte(at)),
        other => panic!("{other}"),
    }
}

#[test]
fn every_function_type_is_written_and_read_again() {
    for number in 0..=27 {
        let series = only_series(&ascii(number, 2, 1, 1, "  1.00000E+00\n"));
        let file = written(&series, Encoding::AsRead, Precision::AsRead);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains(&format!("\n{number:5}         7    0")));
        assert_eq!(only_series(&file), series);
    }
}

#[test]
fn what_has_no_place_is_refused_before_the_first_byte() {
    let good = only_series(&ascii(
        1,
        2,
        2,
        0,
        "  1.00000E+00 -2.00000E+00  3.00000E+00 -4.00000E+00\n",
    ));
    let with = |change: fn(&mut Series)| {
        let mut contents = Contents::of_format("uff58");
        contents.series.push(good.clone());
        let mut changed = good.clone();
        change(&mut changed);
        contents.series.push(changed);
        let writer = Uff58Writer {
            encoding: Encoding::Binary(ByteOrder::LittleEndian),
            precision: Precision::AsRead,
        };
        let mut output = Vec::new();
        let error = writer.write(&contents, &mut output).unwrap_err();
        assert!(output.is_empty());
        error.to_string() + "\n"
    };
    let messages = [
        with(|series| series.name = "a name that is longer than the eighty columns that the format has for the first of its ID lines".into()),
        with(|series| series.ordinate_axis.label = "two\nlines".into()),
        with(|series| series.ordinate_axis.unit_text = "a unit of many characters".into()),
        with(|series| series.abscissa = Abscissa::Uneven(vec![1.0])),
        with(|series| series.ordinate = Ordinate::Real(vec![1e300, 0.0])),
        with(|series| {
            series.properties.retain(|(key, _)| key != "uff58.response_node");
            series.properties.push(("uff58.response_node".into(), "12345678901".into()));
        }),
        with(|series| {
            series.properties.retain(|(key, _)| key != "uff58.precision");
            series.properties.push(("uff58.precision".into(), "half".into()));
        }),
    ]
    .concat();
    insta::assert_snapshot!(messages, @r"
    uff58 cannot hold ID line 1 `a name that is longer than the eighty columns that the format has for the first of its ID lines` of 95 characters in 80 columns
    uff58 cannot hold ordinate label `two\nlines`, which has control characters
    uff58 cannot hold ordinate unit `a unit of many characters` of 25 characters in 20 columns
    abscissa values of a series: found 1, expected 2
    uff58 cannot hold 1e300 in single precision
    uff58 cannot hold response node 12345678901 in 10 columns
    uff58 cannot hold `half` as uff58.precision
    ");
}

/// Both samples hold one recording of a microphone, one as text of six digits, one as 32-bit
/// numbers.
#[test]
fn measured_files_are_read() {
    let Some(folder) = measured::folder() else {
        return;
    };
    let folder = folder.join("uff");
    let read = |name: &str| {
        format::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error:?}"))
    };
    let [text, binary] = ["Sample_UFF58_ascii.uff", "Sample_UFF58b_bin.uff"].map(read);
    let [text, binary] = [&text.series[0], &binary.series[0]];
    assert_eq!(
        (text.ordinate.len(), binary.ordinate.len()),
        (79_292, 79_292)
    );
    assert_eq!(text.abscissa, binary.abscissa);
    // the step has 6 digits, which suffice to tell the rate that was meant
    let Abscissa::Even { step, .. } = text.abscissa else {
        panic!("expected an even abscissa");
    };
    let half_unit = property(&text.properties, STEP_HALF_UNIT).unwrap();
    let rate = format::customary_rate(step, half_unit.parse().unwrap()).unwrap();
    assert_eq!(rate.rate_hz, 65_536.0);
    let together = format::read_records(folder.join("Sample_UFF58b_bin.uff")).unwrap();
    let microphone = together.records[0].channel("Mic 01.0Scalar").unwrap();
    assert_eq!(microphone.len(), 79_292);

    let measurement = read("measurement.uff");
    assert_eq!(measurement.series.len(), 3);
    for series in &measurement.series {
        assert_eq!(series.kind, SeriesKind::FrequencyResponse);
        assert_eq!(series.abscissa, even(0.0, 1.0));
        assert_eq!(series.ordinate.len(), 1001);
    }
    let nothing = read("1858.uff");
    assert!(nothing.series.is_empty());
    let skipped = (SKIPPED.to_owned(), "1858".to_owned());
    assert!(nothing.properties.contains(&skipped));
    let first = |name: &str| read(name).series.remove(0);
    assert_eq!(first("binary8byte.uff").ordinate.len(), 250);
    let filled = first("time-history-not-all-columns-filled.uff");
    assert_eq!(filled.ordinate.len(), 13);
    let unit = first("non_ascii_header.uff").ordinate_axis.unit_text;
    assert_eq!(unit, "(1/N)*(m/s\u{b2})");
    let density = first("sample_dataset58_psd.uff");
    assert_eq!(density.kind, SeriesKind::PowerSpectralDensity);
    assert_eq!(density.ordinate.len(), 3201);
}

fn texts(width: usize) -> impl Strategy<Value = String> {
    prop::string::string_regex(&format!("[A-Za-z0-9 _()/^*\u{b2}\u{b5}-]{{0,{width}}}"))
        .unwrap()
        .prop_map(|text| text.trim().to_owned())
        .prop_filter("the format's word for no text", |text| {
            !text.eq_ignore_ascii_case("none")
        })
}

/// Numbers of every magnitude that the precision holds.
fn numbers(single: bool) -> impl Strategy<Value = f64> {
    let doubles = any::<f64>().prop_filter("finite", |x| x.is_finite());
    prop_oneof![
        -1e3..1e3,
        Just(0.0),
        Just(-0.0),
        if single {
            any::<f32>()
                .prop_filter("finite", |x| x.is_finite())
                .prop_map(f64::from)
                .boxed()
        } else {
            doubles.boxed()
        },
    ]
}

fn any_series(single: bool) -> impl Strategy<Value = Series> {
    let points = prop::collection::vec((numbers(single), numbers(single), numbers(single)), 0..40);
    // a start and a step that the header can hold exactly
    let clock = (-1000_i32..1000, 1_i32..1000);
    (
        points,
        any::<[bool; 2]>(),
        clock,
        0_u8..28,
        texts(80),
        [texts(20), texts(20), texts(20), texts(20)],
    )
        .prop_map(
            |(
                points,
                [is_even, complex],
                (start, step),
                function_type,
                name,
                [label, unit, x_label, x_unit],
            )| Series {
                name,
                kind: kind_of(function_type),
                abscissa: if is_even {
                    even(f64::from(start) / 8.0, f64::from(step) / 32.0)
                } else {
                    Abscissa::Uneven(points.iter().map(|p| p.0).collect())
                },
                ordinate: if complex {
                    Ordinate::Complex(points.iter().map(|p| Complex64::new(p.1, p.2)).collect())
                } else {
                    Ordinate::Real(points.iter().map(|p| p.1).collect())
                },
                abscissa_axis: SeriesAxis {
                    label: x_label,
                    unit_text: x_unit,
                    unit: None,
                },
                ordinate_axis: SeriesAxis {
                    label,
                    unit_text: unit,
                    unit: None,
                },
                properties: Vec::new(),
            },
        )
}

fn kind_of(function_type: u8) -> SeriesKind {
    only_series(&ascii(function_type, 2, 1, 1, "  1.00000E+00\n")).kind
}

fn written(series: &Series, encoding: Encoding, precision: Precision) -> Vec<u8> {
    let mut contents = Contents::of_format("uff58");
    contents.series.push(series.clone());
    let mut output = Vec::new();
    Uff58Writer {
        encoding,
        precision,
    }
    .write(&contents, &mut output)
    .unwrap();
    output
}

/// Bits of all numbers of a series.
fn bits(series: &Series) -> Vec<u64> {
    let abscissa = match &series.abscissa {
        Abscissa::Even { start, step } => vec![*start, *step],
        Abscissa::Uneven(values) => values.clone(),
    };
    let ordinate = match &series.ordinate {
        Ordinate::Real(values) => values.clone(),
        Ordinate::Complex(values) => values.iter().flat_map(|z| [z.re, z.im]).collect(),
    };
    abscissa
        .into_iter()
        .chain(ordinate)
        .map(f64::to_bits)
        .collect()
}

fn assert_same_text(read: &Series, series: &Series) -> Result<(), TestCaseError> {
    prop_assert_eq!(&read.name, &series.name);
    prop_assert_eq!(read.kind, series.kind);
    prop_assert_eq!(&read.abscissa_axis.label, &series.abscissa_axis.label);
    prop_assert_eq!(
        &read.abscissa_axis.unit_text,
        &series.abscissa_axis.unit_text
    );
    prop_assert_eq!(&read.ordinate_axis.label, &series.ordinate_axis.label);
    prop_assert_eq!(
        &read.ordinate_axis.unit_text,
        &series.ordinate_axis.unit_text
    );
    Ok(())
}

proptest! {
    #[test]
    fn double_58b_keeps_every_bit(series in any_series(false), little: bool) {
        let order = if little { ByteOrder::LittleEndian } else { ByteOrder::BigEndian };
        let file = written(&series, Encoding::Binary(order), Precision::Double);
        let read = only_series(&file);
        assert_same_text(&read, &series)?;
        prop_assert_eq!(bits(&read), bits(&series));
        // the properties ask for the same file again
        prop_assert_eq!(written(&read, Encoding::AsRead, Precision::AsRead), file);
    }

    #[test]
    fn single_58b_keeps_every_single(series in any_series(true)) {
        let mut series = series;
        if let Ordinate::Real(values) = &mut series.ordinate {
            for value in values.iter_mut() {
                *value = f64::from(*value as f32);
            }
        }
        prop_assume!(matches!(series.ordinate, Ordinate::Real(_)) && matches!(series.abscissa, Abscissa::Even { .. }));
        let file = written(&series, Encoding::Binary(ByteOrder::BigEndian), Precision::Single);
        prop_assert_eq!(bits(&only_series(&file)), bits(&series));
    }

    #[test]
    fn text_keeps_the_digits_it_prints(series in any_series(false), single: bool) {
        let precision = if single { Precision::Single } else { Precision::Double };
        let file = written(&series, Encoding::Ascii, precision);
        let read = only_series(&file);
        assert_same_text(&read, &series)?;
        prop_assert_eq!(read.ordinate.len(), series.ordinate.len());
        // half a unit of the last digit, 13 or 6 of them; an abscissa has 6 beside either
        let digits = if single { 5 } else { 12 };
        let text = |series: &Series| match &series.ordinate {
            Ordinate::Real(values) => values.iter().map(|x| format!("{x:.digits$e}")).collect::<Vec<_>>(),
            Ordinate::Complex(values) => values.iter().map(|z| format!("{:.digits$e} {:.digits$e}", z.re, z.im)).collect(),
        };
        prop_assert_eq!(text(&read), text(&series));
        prop_assert_eq!(written(&read, Encoding::AsRead, Precision::AsRead), file);
    }

    #[test]
    fn spoilt_files_are_read_or_refused(
        series in any_series(false),
        binary: bool,
        spoils in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let encoding = if binary { Encoding::Binary(ByteOrder::LittleEndian) } else { Encoding::Ascii };
        let mut file = written(&series, encoding, Precision::Double);
        for (place, byte) in spoils {
            let place = place.index(file.len());
            file[place] = byte;
        }
        let _ = strict(&file);
        let tolerant = Uff58.read(&file, Strictness::Tolerant);
        if let (Ok(strict), Ok(tolerant)) = (strict(&file), &tolerant) {
            prop_assert_eq!(strict.series.len(), tolerant.series.len());
            prop_assert!(tolerant.defects.is_empty());
        }
        file.truncate(cut.index(file.len()));
        let _ = Uff58.read(&file, Strictness::Tolerant);
    }
}
