//! Numbers, lines and words of files in text.

use labio::format::uff58::N_DATA_SETS;

use super::*;

#[test]
fn columns_that_touch_are_parted_where_they_end() {
    let rows = "-1.00000E+100-2.00000E+0003.0000000E+002.9911000E-02-10.00000E-05 5.00000E+00\n  6.00000E+00\n";
    let series = only_series(&ascii(1, 2, 7, 1, rows));
    assert_eq!(
        values(&series),
        [-1e100, -2.0, 3.0, 2.9911e-2, -1e-4, 5.0, 6.0]
    );
}

/// A negative number with three digits of exponent fills its twenty columns and touches the field
/// before it.
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
fn numbers_that_do_not_keep_to_the_columns_are_parted_by_blanks() {
    let rows = " 1.2345678E-01 2.3456789E-01 3.4567891E-01\n 4.5678912E-01\n 5\t6.\n";
    let series = only_series(&ascii(1, 2, 6, 1, rows));
    assert_eq!(
        values(&series),
        [0.12345678, 0.23456789, 0.34567891, 0.45678912, 5.0, 6.0]
    );
}

/// An odd number of points in rows of two: the place of the missing point is filled with zeros.
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
    // an ID line may look like a separator, because records are counted
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
