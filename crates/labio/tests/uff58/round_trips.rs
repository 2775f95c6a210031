//! Series that are written and read back.

use labio::SeriesAxis;
use proptest::prelude::*;

use super::*;

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

fn texts(width: usize) -> impl Strategy<Value = String> {
    prop::string::string_regex(&format!("[A-Za-z0-9 _()/^*\u{b2}\u{b5}-]{{0,{width}}}"))
        .unwrap()
        .prop_map(|text| text.trim().to_owned())
        .prop_filter("the format's word for no text", |text| {
            !text.eq_ignore_ascii_case("none")
        })
}

/// Numbers of every magnitude that the precision can represent.
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
    // a start and a step that the header can represent exactly
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
        // the properties of the series that was read give the same file again
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
        // the values agree in all written digits, 13 or 6
        let digits = if single { 5 } else { 12 };
        let text = |series: &Series| match &series.ordinate {
            Ordinate::Real(values) => values.iter().map(|x| format!("{x:.digits$e}")).collect::<Vec<_>>(),
            Ordinate::Complex(values) => values.iter().map(|z| format!("{:.digits$e} {:.digits$e}", z.re, z.im)).collect(),
        };
        prop_assert_eq!(text(&read), text(&series));
        prop_assert_eq!(written(&read, Encoding::AsRead, Precision::AsRead), file);
    }
}
