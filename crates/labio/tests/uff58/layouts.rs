//! The header, and every layout of the data.

use super::*;

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
            let [single, double] = types;
            for (data_type, order) in [(single, 1), (single, 2), (double, 1), (double, 2)] {
                let number = |x: f64| match (data_type == single, order) {
                    (true, 1) => (x as f32).to_le_bytes().to_vec(),
                    (true, _) => (x as f32).to_be_bytes().to_vec(),
                    (false, 1) => x.to_le_bytes().to_vec(),
                    (false, _) => x.to_be_bytes().to_vec(),
                };
                let data: Vec<u8> = pick(wanted).flat_map(number).collect();
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

/// Stated numbers of bytes that were computed for another type are common, such as half the number
/// for complex or for double values.
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
