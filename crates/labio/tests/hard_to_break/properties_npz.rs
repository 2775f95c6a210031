//! Archives of arrays keep every bit, whatever the records are called and however they were sampled.

use std::io::Cursor;

use labio::format::npz::Npz;
use labio::format::{Reader, Strictness, Writer};
use labio::{Abscissa, Contents, Ordinate, Quantity, Series, SeriesAxis, SeriesKind, Unit};
use proptest::prelude::*;

fn bits(series: &Series) -> Vec<u64> {
    match &series.ordinate {
        Ordinate::Real(values) => values.iter().map(|x| x.to_bits()).collect(),
        Ordinate::Complex(values) => values
            .iter()
            .flat_map(|z| [z.re.to_bits(), z.im.to_bits()])
            .collect(),
    }
}

proptest! {
    #[test]
    fn archives_round_trip(
        rows in (1..4_usize, 2..20_usize).prop_flat_map(|(c, n)| {
            prop::collection::vec((prop::collection::vec(any::<f64>(), n), 0..9_usize), c)
        }),
        start in -1e3..1e3_f64,
        step in prop_oneof![1e-7..1.0_f64, Just(1.0 / 51_200.0), Just(1.0 / 3.0)],
    ) {
        let mut contents = Contents::of_format("npz");
        for (index, (samples, quantity)) in rows.iter().enumerate() {
            let unit = Unit::si(Quantity::ALL[*quantity]);
            let axis = |label: &str, unit: Unit| SeriesAxis {
                label: label.to_owned(),
                unit_text: unit.symbol().to_owned(),
                unit: Some(unit),
            };
            contents.series.push(Series {
                name: format!("channel_{index}"),
                kind: SeriesKind::TimeResponse,
                abscissa: Abscissa::Even { start, step },
                ordinate: Ordinate::Real(samples.clone()),
                abscissa_axis: axis("Time", Unit::parse("s").unwrap()),
                ordinate_axis: axis("", unit),
                properties: Vec::new(),
            });
        }
        let mut bytes = Cursor::new(Vec::new());
        if Npz.write(&contents, &mut bytes).is_err() {
            return Ok(()); // what cannot be written is said
        }
        let back = Npz.read(&bytes.into_inner(), Strictness::Strict).unwrap();
        for given in &contents.series {
            let found = back.series.iter().find(|s| s.name == given.name).unwrap();
            prop_assert_eq!(bits(found), bits(given));
            prop_assert_eq!(&found.ordinate_axis.unit_text, &given.ordinate_axis.unit_text);
        }
    }
}
