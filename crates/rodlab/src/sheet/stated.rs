//! Quantity stated in a sheet: number, unit, and a standard uncertainty, if known.

use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use labio::{Dimension, Unit};
use serde::de::{self, Deserialize, Deserializer, Visitor};

use super::kind::{Kind, Temperature, name_of};
use super::quantity_text::{number_and_unit_of, value_and_uncertainty};
use super::typed::QUANTITY;
use crate::RodlabError;

/// A measured quantity of a sheet, in SI units, whose uncertainty the job propagates to its result.
///
/// Written as `"799 mm"`, `"799 mm ± 0.3 mm"`, `"799 mm +- 0.3 mm"`, `"(799 ± 0.3) mm"`,
/// `"799 ± 0.3 mm"` or `"912 kg/m3 ± 0.1 %"`. The uncertainty is one standard deviation. An
/// uncertainty in % is relative to the value, whatever the quantity is: `"0.025 ± 1 %"` is
/// `"0.025 ± 0.00025"`. It is refused where it is meaningless or ambiguous: for the value 0, on a
/// scale with an offset zero (`degC`), and for a number in %, such as `"2.5 % ± 1 %"`.
///
/// A job reads the value together with its uncertainty ([`Stated::with_uncertainty`]), or refuses a
/// stated uncertainty ([`Stated::exact`]). Fields that never take an uncertainty are of the type
/// [`Exact`](super::Exact).
///
/// # Examples
///
/// ```
/// use rodlab::sheet::{Length, Ratio, Stated};
///
/// let length: Stated<Length> = "799 mm ± 0.3 mm".parse()?;
/// let stated = length.with_uncertainty();
/// assert_eq!(stated.value, 0.799);
/// assert_eq!(stated.standard_uncertainty, Some(0.0003));
/// let ratio: Stated<Ratio> = "0.025 ± 1 %".parse()?;
/// assert_eq!(ratio.with_uncertainty().standard_uncertainty, Some(0.00025));
/// let error = "799 kg".parse::<Stated<Length>>().unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "`799 kg` has the dimension of a mass (kg), expected a length, such as \"800 mm\", with or without ±"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Stated<K> {
    stated: ValueWithUncertainty,
    text: String,
    kind: PhantomData<K>,
}

/// A value and its standard uncertainty, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueWithUncertainty {
    /// Value.
    pub value: f64,
    /// Standard uncertainty, if the sheet states one.
    pub standard_uncertainty: Option<f64>,
}

impl ValueWithUncertainty {
    /// Returns the standard uncertainty, 0 if none is stated.
    #[must_use]
    pub fn uncertainty(&self) -> f64 {
        self.standard_uncertainty.unwrap_or(0.0)
    }

    /// Returns the standard uncertainty divided by the absolute value, 0 if no uncertainty is
    /// stated. The value must not be 0.
    #[must_use]
    pub fn relative(&self) -> f64 {
        self.uncertainty() / self.value.abs()
    }
}

impl<K> fmt::Debug for Stated<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}

/// Writes the text of the quantity as it is in the sheet.
impl<K> fmt::Display for Stated<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<K> Stated<K> {
    /// Returns value and standard uncertainty, for a job that propagates both to its result.
    #[must_use]
    pub fn with_uncertainty(&self) -> ValueWithUncertainty {
        self.stated
    }

    /// Returns the value of a property of a body, a material or a contact. It is for jobs that
    /// propagate the uncertainty by draws of the whole sheet, or that have refused any uncertainty
    /// before by [`WithoutUncertainty`](crate::bodies::replacement::WithoutUncertainty).
    pub(crate) fn nominal(&self) -> f64 {
        self.stated.value
    }

    /// Value taken as exact; `field` is its place in the sheet, `why` completes the message "the
    /// value without ±, because …".
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] if an uncertainty is stated.
    pub fn exact(&self, field: &str, why: &str) -> Result<f64, RodlabError> {
        if self.stated.uncertainty() > 0.0 {
            return Err(RodlabError::request(
                field,
                format!("`{self}`"),
                format!("the value without ±, because {why}{}", super::exact::ADVICE),
            ));
        }
        Ok(self.stated.value)
    }
}

impl<K: Kind> Stated<K> {
    /// Returns the exact value that is `standards` standard uncertainties away; `field` is the
    /// place of the quantity in the sheet, and `problem` the clause about a value out of range.
    pub(crate) fn moved(
        &self,
        standards: f64,
        field: &str,
        problem: &str,
    ) -> Result<Self, RodlabError> {
        let moved = self.stated.value + standards * self.stated.uncertainty();
        let parsed = format!("{moved:e} {}", K::DIMENSION).parse();
        parsed.map_err(|error: Written| {
            RodlabError::request(
                field,
                format!("{self}, {problem}: {error}"),
                "an uncertainty that is small compared with the value",
            )
        })
    }
}

/// Error for a text that is not a valid quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` {problem}, expected {expected}")]
pub struct Written {
    pub(super) text: String,
    pub(super) problem: String,
    pub(super) expected: String,
}

impl<K: Kind> FromStr for Stated<K> {
    type Err = Written;

    fn from_str(text: &str) -> Result<Self, Written> {
        let stated = parsed::<K>(text).map_err(|problem| Written {
            text: text.to_owned(),
            problem,
            expected: format!("{}, such as {}, with or without ±", K::NAME, K::EXAMPLE),
        })?;
        Ok(Self {
            stated,
            text: text.trim().to_owned(),
            kind: PhantomData,
        })
    }
}

/// Returns value and uncertainty from a text, or the error in the text.
pub(super) fn parsed<K: Kind>(text: &str) -> Result<ValueWithUncertainty, String> {
    let (quantity, uncertainty) = value_and_uncertainty(text);
    let (number, unit) = number_and_unit_of(&quantity, K::DIMENSION)?;
    if unit.dimension() != K::DIMENSION {
        return Err(if unit.symbol() == "1" {
            "has no unit".to_owned()
        } else {
            other_dimension::<K>(&unit)
        });
    }
    let value = unit.to_si(number);
    if !value.is_finite() {
        return Err("is beyond the range of numbers".to_owned());
    }
    if K::POSITIVE && value <= 0.0 {
        return Err("is not above 0".to_owned());
    }
    if let Some(([least, most], problem)) = K::RANGE
        && !(least..=most).contains(&value)
    {
        return Err(problem.to_owned());
    }
    let standard_uncertainty = match uncertainty {
        None => None,
        Some(text) => Some(uncertainty_of::<K>(value, &unit, &text)?),
    };
    Ok(ValueWithUncertainty {
        value,
        standard_uncertainty,
    })
}

/// Describes the fault of a unit whose dimension is not that of `K`.
fn other_dimension<K: Kind>(unit: &Unit) -> String {
    let dimension = unit.dimension();
    let found = match name_of(dimension) {
        Some(name) => format!("has the dimension of {name} ({dimension})"),
        None => format!("has the dimension {dimension}"),
    };
    // `C` is the coulomb, `F` the farad
    match unit.symbol() {
        symbol @ ("C" | "F") if K::DIMENSION == Temperature::DIMENSION => {
            format!("{found}: write deg{symbol}")
        }
        _ => found,
    }
}

/// Returns the standard uncertainty that `text` states for `value`, which is written in `unit`.
fn uncertainty_of<K: Kind>(value: f64, unit: &Unit, text: &str) -> Result<f64, String> {
    let (number, in_unit) = number_and_unit_of(text, K::DIMENSION)?;
    let in_percent = in_unit.symbol() == "%";
    if unit.symbol() == "%" {
        return Err(
            "is in % and has an uncertainty, which may be relative or in percentage points: write a pure number, such as \"0.025 ± 1 %\" \
             (1 % of it) or \"0.025 ± 0.001\""
                .to_owned(),
        );
    }
    if in_percent && unit.to_si(0.0) != 0.0 {
        return Err(format!(
            "has a relative uncertainty on a scale with an arbitrary zero: state it in {}",
            unit.symbol()
        ));
    }
    if in_percent && value == 0.0 && number != 0.0 {
        return Err(
            "has a relative uncertainty, but the value is 0: state it with a unit".to_owned(),
        );
    }
    let uncertainty = if in_percent {
        value.abs() * number / 100.0
    } else if in_unit.dimension() == K::DIMENSION {
        // a difference of two values does not depend on the zero of the scale
        number * (in_unit.to_si(1.0) - in_unit.to_si(0.0))
    } else if in_unit.dimension() == Dimension::NONE {
        return Err("has an uncertainty without a unit".to_owned());
    } else {
        return Err(format!(
            "has an uncertainty of the dimension {}",
            in_unit.dimension()
        ));
    };
    if !uncertainty.is_finite() {
        return Err("has an uncertainty beyond the range of numbers".to_owned());
    }
    if uncertainty < 0.0 {
        return Err("has an uncertainty below 0".to_owned());
    }
    Ok(uncertainty)
}

impl<'de, K: Kind> Deserialize<'de> for Stated<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        from_text::<Self, K, D>(deserializer)
    }
}

/// Reads a quantity of the kind `K` from its text in quotes; a pure number needs no quotes.
pub(super) fn from_text<'de, T, K, D>(deserializer: D) -> Result<T, D::Error>
where
    T: FromStr<Err = Written>,
    K: Kind,
    D: Deserializer<'de>,
{
    struct Text<T, K>(PhantomData<(T, K)>);

    impl<T: FromStr<Err = Written>, K: Kind> Text<T, K> {
        fn pure<E: de::Error>(
            self,
            number: impl fmt::Display,
            found: de::Unexpected<'_>,
        ) -> Result<T, E> {
            if K::DIMENSION == Dimension::NONE {
                number.to_string().parse().map_err(E::custom)
            } else {
                Err(E::invalid_type(found, &self))
            }
        }
    }

    impl<'de, T: FromStr<Err = Written>, K: Kind> Visitor<'de> for Text<T, K> {
        type Value = T;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(
                f,
                "{} with its unit in quotes, such as {}",
                K::NAME,
                K::EXAMPLE
            )
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<T, E> {
            text.parse().map_err(E::custom)
        }

        fn visit_f64<E: de::Error>(self, number: f64) -> Result<T, E> {
            self.pure(number, de::Unexpected::Float(number))
        }

        fn visit_i64<E: de::Error>(self, number: i64) -> Result<T, E> {
            self.pure(number, de::Unexpected::Signed(number))
        }

        fn visit_u64<E: de::Error>(self, number: u64) -> Result<T, E> {
            self.pure(number, de::Unexpected::Unsigned(number))
        }

        fn visit_newtype_struct<D: Deserializer<'de>>(self, text: D) -> Result<T, D::Error> {
            text.deserialize_any(self)
        }

        /// Returns the example in place of a faulty value, so that further mistakes can be found.
        fn visit_none<E: de::Error>(self) -> Result<T, E> {
            let example = K::EXAMPLE.split('"').nth(1).unwrap_or_default();
            example.parse().map_err(E::custom)
        }
    }

    deserializer.deserialize_newtype_struct(QUANTITY, Text::<T, K>(PhantomData))
}

#[cfg(test)]
mod tests {
    use super::super::*;
    use super::*;

    fn written<K: Kind>(text: &str) -> String {
        text.parse::<Stated<K>>().unwrap_err().to_string()
    }

    #[test]
    fn a_quantity_is_a_number_with_a_unit_and_an_uncertainty() {
        let of = |text: &str| text.parse::<Stated<Density>>().unwrap();
        assert!((of("912 kg/m3").with_uncertainty().value - 912.0).abs() < 1e-12);
        assert_eq!(
            of("912 kg/m3").with_uncertainty().standard_uncertainty,
            None
        );
        for text in [
            "912 kg/m^3 ± 1.824 kg/m3",
            "9.12e2kg/m³ +- 0.2 %",
            "912 kg/m3 +/- 0.2%",
        ] {
            let density = of(text).with_uncertainty();
            // tolerance: two rounding errors
            assert!((density.value - 912.0).abs() < 1e-12, "{text}");
            assert!((density.uncertainty() - 1.824).abs() < 1e-12, "{text}");
        }
        let room: Stated<Temperature> = "23 degC ± 0.5 degC".parse().unwrap();
        let room = room.with_uncertainty();
        assert!((room.value - 296.15).abs() < 1e-12);
        assert!((room.uncertainty() - 0.5).abs() < 1e-12);
        let energetic: Stated<Time> = "1e-3 s".parse().unwrap();
        assert!((energetic.with_uncertainty().value - 1e-3).abs() < 1e-18);
    }

    #[test]
    fn units_are_taken_as_people_write_them() {
        fn si<K: Kind>(text: &str) -> f64 {
            text.parse::<Stated<K>>().unwrap().with_uncertainty().value
        }
        // tolerance: one rounding error
        for (found, expected) in [
            (si::<Density>("1.15 g/cm3"), 1150.0),
            (si::<Density>("1.15 g/cm³"), 1150.0),
            (si::<Density>("1150 g/dm3"), 1150.0),
            (si::<ImpactMass>("2.9 g"), 2.9e-3),
            (si::<AddedMass>("2900 mg"), 2.9e-3),
            (si::<SpecificImpedance>("1000 g/s"), 1.0),
            (si::<Force>("2 kN"), 2000.0),
            (si::<Force>("2 daN"), 20.0),
            (si::<Force>("20 Newton"), 20.0),
            (si::<Stress>("45 N/mm2"), 45e6),
            (si::<Ratio>("9.4 %"), 0.094),
        ] {
            assert!(
                (found / expected - 1.0).abs() < 4e-16,
                "{found}, expected {expected}"
            );
        }
        let mass: Stated<ImpactMass> = "2.9 g ± 30 mg".parse().unwrap();
        assert!((mass.with_uncertainty().uncertainty() - 3e-5).abs() < 1e-19);
        let wrong = written::<Velocity>("3 g");
        assert!(
            wrong.contains("has the dimension of an acceleration (m s^-2)"),
            "{wrong}"
        );
    }

    #[test]
    fn what_is_beyond_the_range_of_numbers_is_said_to_be() {
        assert_eq!(
            written::<Coordinate>("-1e999 m"),
            "`-1e999 m` is beyond the range of numbers, expected a coordinate, such as \"0 mm\" or \"-12 mm\", with or without ±"
        );
        let uncertain = written::<Coordinate>("1 m ± 1e999 m");
        assert!(
            uncertain.contains("an uncertainty beyond the range of numbers"),
            "{uncertain}"
        );
    }

    #[test]
    fn what_is_no_such_quantity_says_why() {
        let errors = [
            written::<Length>("799"),
            written::<Length>("799 kg"),
            written::<Length>("-2 mm"),
            written::<Length>("mm"),
            written::<Length>("799 furlong"),
            written::<Length>("799 mm ± 1 kg"),
            written::<Frequency>("51,2 kHz"),
            written::<Frequency>("51,200 Hz"),
            written::<Temperature>("50 C"),
            written::<ImpactMass>("600 N"),
            written::<Length>("600 m ± 0.2 mm"),
            written::<Coordinate>("-600 m"),
            written::<PoissonRatio>("40"),
        ]
        .join("\n");
        insta::assert_snapshot!(errors);
    }

    #[test]
    fn r09_a_per_cent_behind_the_sign_is_relative_for_every_quantity() {
        let of = |text: &str| text.parse::<Stated<Ratio>>().unwrap().with_uncertainty();
        for (text, expected) in [
            ("0.025 ± 1 %", 0.000_25),
            ("0.025 +- 0.001", 0.001),
            ("0.40 ± 0.02", 0.02),
            ("0.40 ± 5%", 0.02),
        ] {
            let error = of(text).uncertainty() / expected - 1.0;
            assert!(error.abs() < 1e-12, "{text}: {error}");
        }
        let stress: Stated<Stress> = "-45 MPa ± 2 %".parse().unwrap();
        assert!((stress.with_uncertainty().uncertainty() - 0.9e6).abs() < 1e-6);
    }

    #[test]
    fn r09_a_per_cent_that_says_two_things_or_nothing_is_refused() {
        let errors = [
            written::<Ratio>("2.5 % ± 1 %"),
            written::<Ratio>("2.5 % ± 0.001"),
            written::<Temperature>("23 degC ± 1 %"),
            written::<Coordinate>("0 mm ± 1 %"),
        ]
        .join("\n");
        insta::assert_snapshot!(errors);
        let exact: Stated<Coordinate> = "0 mm ± 0 %".parse().unwrap();
        assert_eq!(exact.with_uncertainty().standard_uncertainty, Some(0.0));
    }
}
