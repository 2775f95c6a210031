//! Units of files, and quantities of sheets with unit and uncertainty.

use labio::{LabioError, Unit};
use rodlab::sheet::{AddedMass, Coordinate, Density, Kind, Length, Ratio, Stated, Temperature};

use super::super::records::prints;

/// Parses a text as a unit and as quantities.
pub fn unit(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Unit::parse(&text) {
        Ok(unit) => known(&unit),
        Err(error) => prints(&error),
    }
    quantity::<Length>(&text);
    quantity::<Coordinate>(&text);
    quantity::<AddedMass>(&text);
    quantity::<Density>(&text);
    quantity::<Temperature>(&text);
    quantity::<Ratio>(&text);
}

/// Checks that a unit converts to SI and back, and that its symbol parses to the same unit.
fn known(unit: &Unit) {
    let scale = unit.scale();
    assert!(
        scale.is_finite() && scale > 0.0,
        "`{unit}` has the scale {scale}"
    );
    assert_eq!(
        Unit::parse(unit.symbol()).as_ref().ok(),
        Some(unit),
        "the symbol of `{unit}` does not parse to this unit"
    );
    for value in [-1.0, 0.0, 3.25e-3, 4096.0] {
        let si = unit.to_si(value);
        let back = unit.of_si(si);
        // tolerance: rounding, which is larger for units with an offset, such as °C; products of
        // units may have scales outside the range of normal numbers
        let digits = 8.0 * f64::EPSILON * (value.abs() + unit.of_si(0.0).abs());
        if si.is_normal() {
            assert!(
                (back - value).abs() <= digits,
                "{value} `{unit}` is {si} in SI, which converts back to {back}"
            );
        }
    }
    let settled = |result: Result<Unit, LabioError>| match result {
        Ok(unit) => Some(unit),
        Err(error) => {
            prints(&error);
            None
        }
    };
    if let Some(ratio) = settled(unit.per(unit)) {
        assert_eq!(ratio.dimension(), labio::Dimension::NONE, "`{ratio}`");
        assert!(
            (ratio.scale() - 1.0).abs() < 1e-12,
            "`{ratio}` is {}",
            ratio.scale()
        );
    }
    if let Some(square) = settled(unit.times(unit)) {
        assert_eq!(
            Some(square.dimension()),
            unit.dimension().power(2),
            "`{square}`"
        );
    }
}

/// Checks that a quantity is finite, above 0 if its kind requires this, and that its text parses to
/// the same quantity.
fn quantity<K: Kind + std::fmt::Debug>(text: &str) {
    match text.parse::<Stated<K>>() {
        Ok(stated) => {
            let read = stated.with_uncertainty();
            let si = read.value;
            assert!(
                si.is_finite() && (!K::POSITIVE || si > 0.0),
                "`{text}` is {si}"
            );
            let uncertainty = read.standard_uncertainty;
            assert!(
                uncertainty.is_none_or(|u| u.is_finite() && u >= 0.0),
                "`{text}`"
            );
            let again: Stated<K> = stated.to_string().parse().expect("the text of a quantity");
            assert_eq!(again.with_uncertainty(), read);
        }
        Err(error) => prints(&error),
    }
}
