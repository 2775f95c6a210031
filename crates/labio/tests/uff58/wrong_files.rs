//! Files that are invalid or damaged, and contents that the format cannot represent.

use labio::Place;

use super::*;
use crate::series::{defects, refusals};

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
    the uff58 file contains no data
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
    uff58, line 16: record 12, value 8 is the end of the data set, expected 8 values, as record 7 states
    uff58, line 15: record 12, after value 6, the last is `  7.00000E+00`, expected a line `    -1` that closes the data set
    uff58, line 16: record 12, value 8 is the end of the data set, expected 9999999999 values, as record 7 states
    uff58, line 16: record 12, after value 7, the last is the end of the file, expected a line `    -1` that closes the data set
    uff58, line 16: record 12, after value 7, the last is `something`, expected a line `    -1` that closes the data set
    uff58, line 17: line between data sets is `remark`, expected a line `    -1`
    uff58, line 2: identifier line is `    -1`, expected the number of a data set
    uff58, byte 549: record 12 (24 bytes stated) is 21 bytes to the end of the file, expected 24 bytes for the 3 values of record 7, and a line `    -1` after them
    uff58, byte 549: record 12 (24 bytes stated) is 24 bytes to the end of the file, expected 24 bytes for the 3 values of record 7, and a line `    -1` after them
    uff58, line 2: identifier line, byte order is 3, expected 1 (little-endian) or 2 (big-endian)
    uff58, line 2: identifier line, floating-point format is 1, expected 2 (IEEE 754), the only supported format
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
    uff58, line 15: record 12, value 4 is the end of the data set, expected 9 values, as record 7 states
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
fn what_has_no_place_is_refused_before_the_first_byte() {
    let good = only_series(&ascii(
        1,
        2,
        2,
        0,
        "  1.00000E+00 -2.00000E+00  3.00000E+00 -4.00000E+00\n",
    ));
    let with = |change: fn(&mut Series)| {
        let mut changed = good.clone();
        change(&mut changed);
        let contents = contents_of(vec![good.clone(), changed]);
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
