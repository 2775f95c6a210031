//! Units of the printed tables, and their SI equivalents.
//!
//! A unit that is not in the list is an error.

use super::decimal::Decimal;

/// Printed unit: SI value = digits · factor + offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unit {
    printed: &'static str,
    /// SI unit, `1` for a pure number.
    pub si: &'static str,
    factor: Decimal,
    offset: Decimal,
    /// True for counts, which are exact.
    counts: bool,
}

/// Creates the unit `printed`, which is `digits`·10^`exponent` of `si`.
const fn unit(printed: &'static str, si: &'static str, digits: i128, exponent: i32) -> Unit {
    Unit {
        printed,
        si,
        factor: Decimal::new(digits, exponent),
        offset: Decimal::new(0, 0),
        counts: false,
    }
}

/// Creates the unit of a count.
const fn count(printed: &'static str) -> Unit {
    let mut unit = unit(printed, "1", 1, 0);
    unit.counts = true;
    unit
}

/// Creates the unit of temperature on the Celsius scale.
const fn celsius() -> Unit {
    let mut unit = unit("°C", "K", 1, 0);
    unit.offset = Decimal::new(27315, -2);
    unit
}

/// π/180 with 31 digits; a product with six more digits still fits into 38.
const DEGREE: (i128, i32) = (1_745_329_251_994_329_576_923_690_768_489, -32);

/// All units printed in the thesis, and the units of its errata and of the readings of paper D.
///
/// The prefixes of `EPa^kappa s` and `TPa^kappa s` (Ödeen 1993, paper D, Tables 4 and A1) are plain
/// factors on Pa^kappa s. Raised to the power kappa, they would give impossible relaxation times.
/// `Pa s^-2.8` is a misprint (paper C) whose erratum gives the intended unit; it is listed so that
/// it can be quoted.
const UNITS: &[Unit] = &[
    unit("1", "1", 1, 0),
    unit("%", "1", 1, -2),
    count("integer"),
    count("parts"),
    count("samples"),
    count("steps"),
    count("terms"),
    count("tests"),
    unit("°", "rad", DEGREE.0, DEGREE.1),
    unit("mm", "m", 1, -3),
    unit("1/m", "1/m", 1, 0),
    unit("m/s", "m/s", 1, 0),
    unit("g", "kg", 1, -3),
    unit("kg/m^3", "kg/m^3", 1, 0),
    unit("us", "s", 1, -6),
    unit("ms", "s", 1, -3),
    unit("s", "s", 1, 0),
    unit("h", "s", 3600, 0),
    unit("Hz", "Hz", 1, 0),
    unit("kHz", "Hz", 1, 3),
    celsius(),
    unit("°C difference", "K", 1, 0),
    unit("Pa", "Pa", 1, 0),
    unit("MPa", "Pa", 1, 6),
    unit("GPa", "Pa", 1, 9),
    unit("TPa", "Pa", 1, 12),
    unit("MPa s", "Pa s", 1, 6),
    unit("GPa s", "Pa s", 1, 9),
    unit("Pa^kappa s", "Pa^kappa s", 1, 0),
    unit("TPa^kappa s", "Pa^kappa s", 1, 12),
    unit("EPa^kappa s", "Pa^kappa s", 1, 18),
    unit("Pa s^-2.8", "Pa s^-2.8", 1, 0),
    unit("Pa^-2.8 s^-1", "Pa^-2.8 s^-1", 1, 0),
    unit("1/m (rad/s)^-0.894", "1/m (rad/s)^-0.894", 1, 0),
    unit("1/m (rad/s)^-0.970", "1/m (rad/s)^-0.970", 1, 0),
];

impl Unit {
    /// Returns the unit with this printed name, if it is known.
    pub fn named(printed: &str) -> Option<Self> {
        UNITS.iter().copied().find(|unit| unit.printed == printed)
    }

    /// Returns the SI value of a printed number.
    pub fn to_si(self, number: Decimal) -> Option<Decimal> {
        number.times(self.factor)?.plus(self.offset)
    }

    /// Returns the SI value of a printed difference, such as a tolerance: without the offset of the
    /// unit.
    pub fn difference_to_si(self, number: Decimal) -> Option<Decimal> {
        number.times(self.factor)
    }

    /// Returns half a unit of the last printed digit, in SI; zero for counts.
    pub fn tolerance(self, number: Decimal) -> Option<Decimal> {
        if self.counts {
            Some(Decimal::new(0, 0))
        } else {
            self.difference_to_si(number.half_unit_of_last_digit())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn si(number: &str, unit: &str) -> (f64, f64, &'static str) {
        let (number, unit) = (Decimal::parse(number).unwrap(), Unit::named(unit).unwrap());
        let value = unit.to_si(number).unwrap().to_f64();
        (value, unit.tolerance(number).unwrap().to_f64(), unit.si)
    }

    #[test]
    fn units_are_known_once() {
        for (index, unit) in UNITS.iter().enumerate() {
            assert!(
                UNITS[..index]
                    .iter()
                    .all(|other| other.printed != unit.printed),
                "{}",
                unit.printed
            );
        }
        assert_eq!(Unit::named("furlong"), None);
    }

    #[test]
    fn conversions_are_exact() {
        assert_eq!(si("40.85", "GPa s"), (40.85e9, 5e6, "Pa s"));
        assert_eq!(si("38.16", "EPa^kappa s"), (3.816e19, 5e15, "Pa^kappa s"));
        assert_eq!(si("10.7", "mm"), (0.0107, 5e-5, "m"));
        assert_eq!(si("1.90", "%"), (0.0190, 5e-5, "1"));
        assert_eq!(si("21.3", "°C"), (294.45, 0.05, "K"));
        assert_eq!(si("10", "°C difference"), (10.0, 0.5, "K"));
        assert_eq!(si("5", "h"), (18000.0, 1800.0, "s"));
        assert_eq!(si("4096", "samples"), (4096.0, 0.0, "1"));
    }

    #[test]
    fn the_degree_is_that_of_the_standard_library() {
        // tolerance: rounding of the product in the standard library, one part in 2⁵²
        for angle in ["3.5", "4.0", "10", "180"] {
            let expected = angle.parse::<f64>().unwrap().to_radians();
            assert!(
                (si(angle, "°").0 - expected).abs() <= f64::EPSILON * expected,
                "{angle}"
            );
        }
    }
}
