//! Units as written in files and data sheets, and their SI values.

mod parse;
mod ratio;
mod symbol;

use std::fmt;
use std::str::FromStr;

use crate::{LabioError, Quantity};
pub(crate) use ratio::EXACT_INTEGERS;
use ratio::Ratio;
use symbol::G;

/// Exponents of the SI base units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// Metre.
    pub length: i8,
    /// Kilogram.
    pub mass: i8,
    /// Second.
    pub time: i8,
    /// Ampere.
    pub current: i8,
    /// Kelvin.
    pub temperature: i8,
}

impl Dimension {
    /// Dimension of a pure number.
    pub const NONE: Self = Self::of([0; 5]);
    /// Dimension of a time.
    pub const TIME: Self = Self::of([0, 0, 1, 0, 0]);

    pub(crate) const fn of([length, mass, time, current, temperature]: [i8; 5]) -> Self {
        Self {
            length,
            mass,
            time,
            current,
            temperature,
        }
    }

    const fn exponents(self) -> [i8; 5] {
        [
            self.length,
            self.mass,
            self.time,
            self.current,
            self.temperature,
        ]
    }

    /// Returns the dimension of a product, `None` if an exponent exceeds the range of `i8`.
    #[must_use]
    pub fn product(self, other: Self) -> Option<Self> {
        let mut sum = self.exponents();
        for (exponent, added) in sum.iter_mut().zip(other.exponents()) {
            *exponent = exponent.checked_add(added)?;
        }
        Some(Self::of(sum))
    }

    /// Returns the dimension of a quotient, `None` if an exponent exceeds the range of `i8`.
    #[must_use]
    pub fn quotient(self, other: Self) -> Option<Self> {
        self.product(other.power(-1)?)
    }

    /// Returns the dimension of a power, `None` if an exponent exceeds the range of `i8`.
    #[must_use]
    pub fn power(self, exponent: i8) -> Option<Self> {
        let mut multiple = self.exponents();
        for base in &mut multiple {
            *base = base.checked_mul(exponent)?;
        }
        Some(Self::of(multiple))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bases = ["m", "kg", "s", "A", "K"];
        let mut separator = "";
        for (base, exponent) in bases.iter().zip(self.exponents()) {
            match exponent {
                0 => continue,
                1 => write!(f, "{separator}{base}")?,
                _ => write!(f, "{separator}{base}^{exponent}")?,
            }
            separator = " ";
        }
        if separator.is_empty() {
            f.write_str("1")?;
        }
        Ok(())
    }
}

/// A unit: its text, its dimension and its SI value.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "String", into = "String"))]
pub struct Unit {
    symbol: String,
    dimension: Dimension,
    ratio: Ratio,
    offset: f64,
}

impl Unit {
    /// Returns the SI unit of `quantity`.
    #[must_use]
    pub fn si(quantity: Quantity) -> Self {
        Self {
            symbol: quantity.unit().to_owned(),
            dimension: quantity.dimension(),
            ratio: Ratio::ONE,
            offset: 0.0,
        }
    }

    /// Parses the unit in `text`; blanks and one pair of square brackets around it are ignored.
    ///
    /// Known units are the SI units of mechanics and electricity with their prefixes, also in words
    /// (`Newton`), `g` and `gn` (standard gravity, 9.80665 m/s²), `lbf`, `lbm`, `kgf`, `in`, `ft`,
    /// `l`, `cc` (cm³), `psi`, `ksi`, `bar`, `%`, `strain`, `microstrain` (`ue`, `µε`), `deg`,
    /// `degC` and `degF`.
    /// Compounds are written with `/`, `*`, `.`, `·` or a blank; powers as `s^2`, `s**2`, `s²`,
    /// `s2` or `s^-2`. A pure number is written `1`, `-` or `dimensionless`.
    ///
    /// # Validity
    ///
    /// - `g` is an acceleration, as in the `mV/g` of accelerometers; the gram is written `gram`,
    ///   the kilogram `kg`. `mg` is therefore a thousandth of standard gravity. Where the dimension
    ///   is known, [`Unit::parse_as`] reads `g/cm3` as well.
    /// - `C` is the coulomb, `F` the farad; temperatures are `degC` and `degF`. The zeros of both
    ///   differ from that of the kelvin, so they are allowed only alone: `mV/degC` is rejected.
    /// - A product after a slash needs brackets, `m/(N s)`: without them the unit is ambiguous.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownUnit`] with the part of the text that is not understood.
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::{Quantity, Unit};
    ///
    /// # fn main() -> Result<(), labio::LabioError> {
    /// let g = Unit::parse("g")?;
    /// assert_eq!(g.to_si(2.0), 19.6133);
    /// assert_eq!(g.quantity(), Some(Quantity::Acceleration));
    ///
    /// // an accelerometer's sheet: volts divided by its sensitivity are an acceleration
    /// let sensitivity = Unit::parse("mV/g")?;
    /// let quotient = Unit::parse("V")?.per(&sensitivity)?;
    /// assert_eq!(quotient.dimension(), g.dimension());
    /// # Ok(())
    /// # }
    /// ```
    pub fn parse(text: &str) -> Result<Self, LabioError> {
        Self::parse_with(text, G::Gravity)
    }

    /// Parses the unit of a quantity of the dimension `expected`. `g` is the gram if the unit has
    /// this dimension only in that case; otherwise it is standard gravity, as for [`Unit::parse`].
    /// The resulting unit may have a dimension other than `expected`.
    ///
    /// # Errors
    ///
    /// The errors of [`Unit::parse`].
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::{Quantity, Unit};
    ///
    /// # fn main() -> Result<(), labio::LabioError> {
    /// let density = Unit::parse("kg/m3")?.dimension();
    /// assert_eq!(Unit::parse_as("g/cm3", density)?.to_si(1.15), 1150.0);
    /// let acceleration = Quantity::Acceleration.dimension();
    /// assert_eq!(Unit::parse_as("g", acceleration)?.to_si(1.0), 9.80665);
    /// # Ok(())
    /// # }
    /// ```
    pub fn parse_as(text: &str, expected: Dimension) -> Result<Self, LabioError> {
        let unit = Self::parse(text)?;
        if unit.dimension == expected {
            return Ok(unit);
        }
        let by_gram = Self::parse_with(text, G::Gram)?;
        Ok(if by_gram.dimension == expected {
            by_gram
        } else {
            unit
        })
    }

    fn parse_with(text: &str, g: G) -> Result<Self, LabioError> {
        let trimmed = text.trim();
        let symbol = trimmed
            .strip_prefix('[')
            .and_then(|inner| inner.strip_suffix(']'))
            .map_or(trimmed, str::trim);
        let parsed = parse::parse(symbol, g)?;
        Ok(Self {
            symbol: symbol.to_owned(),
            dimension: parsed.dimension,
            ratio: parsed.ratio,
            offset: parsed.offset,
        })
    }

    /// The text of the unit.
    #[must_use]
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// Exponents of the base units.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Returns true if both units have the same dimension, size and zero, whatever their symbols.
    #[must_use]
    pub fn is_same_as(&self, other: &Self) -> bool {
        self.dimension == other.dimension
            && self.scale().to_bits() == other.scale().to_bits()
            && self.offset.to_bits() == other.offset.to_bits()
    }

    /// Quantity of a channel in this unit, if there is a quantity of this dimension; a pure number
    /// counts as strain.
    #[must_use]
    pub fn quantity(&self) -> Option<Quantity> {
        Quantity::of_dimension(self.dimension)
    }

    /// SI value of a difference of one in this unit.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.ratio.value()
    }

    /// Converts `value` in this unit to the SI unit. For an SI unit the result is exactly `value`.
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        if self.offset == 0.0 {
            self.ratio.scale(value) // adding a zero would turn -0.0 into 0.0
        } else {
            self.ratio.scale(value) + self.offset
        }
    }

    /// Converts the SI value to this unit.
    #[must_use]
    pub fn of_si(&self, si: f64) -> f64 {
        if self.offset == 0.0 {
            self.ratio.inverse().scale(si)
        } else {
            self.ratio.inverse().scale(si - self.offset)
        }
    }

    /// Returns the product of two units.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownUnit`] if the zero of a unit differs from that of the SI unit, or the
    /// product overflows.
    pub fn times(&self, other: &Self) -> Result<Self, LabioError> {
        Self::parse(&format!("{} * {}", self.bracketed(), other.bracketed()))
    }

    /// Returns the quotient of two units.
    ///
    /// # Errors
    ///
    /// The errors of [`Unit::times`].
    pub fn per(&self, other: &Self) -> Result<Self, LabioError> {
        Self::parse(&format!("{}/{}", self.bracketed(), other.bracketed()))
    }

    fn bracketed(&self) -> String {
        match self.symbol.as_str() {
            "-" | "dimensionless" => "1".to_owned(),
            simple if simple.chars().all(char::is_alphanumeric) => simple.to_owned(),
            compound => format!("({compound})"),
        }
    }
}

impl FromStr for Unit {
    type Err = LabioError;

    fn from_str(text: &str) -> Result<Self, LabioError> {
        Self::parse(text)
    }
}

impl TryFrom<String> for Unit {
    type Error = LabioError;

    fn try_from(text: String) -> Result<Self, LabioError> {
        Self::parse(&text)
    }
}

impl From<Unit> for String {
    fn from(unit: Unit) -> Self {
        unit.symbol
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.symbol)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousandths_are_rounded_once() {
        let mm = Unit::parse("mm").unwrap();
        // nine times the double nearest to 0.001 differs from 0.009
        assert_eq!(mm.to_si(9.0).to_bits(), 0.009_f64.to_bits());
        assert_ne!((9.0_f64 * 0.001).to_bits(), 0.009_f64.to_bits());
        assert_eq!(mm.of_si(0.009).to_bits(), 9.0_f64.to_bits());
    }

    #[test]
    fn si_units_change_no_bit() {
        for quantity in Quantity::ALL {
            let unit = Unit::si(quantity);
            assert_eq!(
                Unit::parse(unit.symbol()).unwrap(),
                unit,
                "text and table of {}",
                quantity.name()
            );
            for value in [-0.0, 0.1, 1e308, -5e-324] {
                assert_eq!(unit.to_si(value).to_bits(), f64::to_bits(value));
                assert_eq!(unit.of_si(value).to_bits(), f64::to_bits(value));
            }
        }
    }

    #[test]
    fn dimensions_are_written_as_powers() {
        let written = ["mV/g", "1", "m", "N/V"].map(|text| {
            let unit = Unit::parse(text).unwrap();
            unit.dimension().to_string()
        });
        assert_eq!(written, ["m kg s^-1 A^-1", "1", "m", "m^-1 s A"]);
    }

    #[test]
    fn quotients_of_quotients_cancel() {
        let volt = Unit::parse("V").unwrap();
        let sensitivity = Unit::parse("mV/g").unwrap();
        let quotient = volt.per(&sensitivity).unwrap();
        assert_eq!(quotient.symbol(), "V/(mV/g)");
        // 1 V divided by 1 mV/g is 1000 g, and 9806.65 is the double nearest to 980665/100
        assert_eq!(quotient.to_si(1.0).to_bits(), 9806.65_f64.to_bits());
        assert_eq!(quotient.dimension(), Quantity::Acceleration.dimension());
        assert!(volt.times(&Unit::parse("degC").unwrap()).is_err());
    }
}
