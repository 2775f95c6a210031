//! Tables that are written and read back.

use proptest::prelude::*;

use super::*;

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
    csv cannot hold an abscissa called `#`, because a comment begins the same way
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
    // every NaN is written in the same way
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
        // names with blanks around them and tables without samples are rejected
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
