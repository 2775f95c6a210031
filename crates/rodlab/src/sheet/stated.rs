//! A quantity as a sheet states it: number, unit, and a standard uncertainty where it is known.

use std::fmt;
use std::marker::PhantomData;

use labio::{Dimension, Unit};
use serde::de::{self, Deserialize, Deserializer, Visitor};

/// What kind of quantity a field of a sheet wants.
pub trait Kind {
    /// Name with article, as `a length`.
    const NAME: &'static str;
    /// How it is written.
    const EXAMPLE: &'static str;
    /// Its dimension.
    const DIMENSION: Dimension;
    /// Whether zero and negative values are refused.
    const POSITIVE: bool;
}

/// A quantity of a sheet, in SI.
///
/// Written as `"799 mm"`, `"799 mm ± 0.3 mm"`, `"799 mm +- 0.3 mm"` or `"912 kg/m3 ± 0.1 %"`; the uncertainty is one standard
/// deviation.
///
/// # Examples
///
/// ```
/// use rodlab::sheet::{Length, Stated};
///
/// let length: Stated<Length> = "799 mm ± 0.3 mm".parse()?;
/// assert_eq!(length.si(), 0.799);
/// assert_eq!(length.standard_uncertainty(), Some(0.0003));
/// let error = "799 kg".parse::<Stated<Length>>().unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "`799 kg` has the dimension kg, expected a length, as \"800 mm\" or \"800 mm ± 0.5 mm\""
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Stated<K> {
    si: f64,
    standard_uncertainty: Option<f64>,
    text: String,
    kind: PhantomData<K>,
}

impl<K> Clone for Stated<K> {
    fn clone(&self) -> Self {
        Self {
            si: self.si,
            standard_uncertainty: self.standard_uncertainty,
            text: self.text.clone(),
            kind: PhantomData,
        }
    }
}

impl<K> fmt::Debug for Stated<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}

/// As it is written in the sheet.
impl<K> fmt::Display for Stated<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<K> Stated<K> {
    /// Value in SI.
    #[must_use]
    pub fn si(&self) -> f64 {
        self.si
    }

    /// Standard uncertainty in SI, if the sheet states one.
    #[must_use]
    pub fn standard_uncertainty(&self) -> Option<f64> {
        self.standard_uncertainty
    }
}

/// Why a text is no such quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` {problem}, expected {expected}")]
pub struct Written {
    text: String,
    problem: String,
    expected: String,
}

impl<K: Kind> std::str::FromStr for Stated<K> {
    type Err = Written;

    fn from_str(text: &str) -> Result<Self, Written> {
        let wrong = |problem: String| Written {
            text: text.to_owned(),
            problem,
            expected: format!("{}, as {}", K::NAME, K::EXAMPLE),
        };
        let (value, uncertainty) = value_and_uncertainty(text);
        let (number, unit) = number_and_unit(value).map_err(wrong)?;
        if unit.dimension() != K::DIMENSION {
            return Err(wrong(if unit.symbol() == "1" {
                "has no unit".to_owned()
            } else {
                format!("has the dimension {}", unit.dimension())
            }));
        }
        let si = unit.to_si(number);
        if !si.is_finite() {
            return Err(wrong("is beyond the range of numbers".to_owned()));
        }
        if K::POSITIVE && si <= 0.0 {
            return Err(wrong("is not above 0".to_owned()));
        }
        let standard_uncertainty = uncertainty
            .map(|text| {
                let (number, unit) = number_and_unit(text).map_err(wrong)?;
                let one = unit.to_si(1.0) - unit.to_si(0.0); // a difference knows no zero of its scale
                let percent = unit.symbol() == "%" && K::DIMENSION != Dimension::NONE;
                if percent {
                    Ok(si.abs() * number / 100.0)
                } else if unit.dimension() == K::DIMENSION {
                    Ok(number * one)
                } else {
                    let found = unit.dimension();
                    Err(wrong(format!(
                        "has an uncertainty of the dimension {found}"
                    )))
                }
            })
            .transpose()?;
        if standard_uncertainty.is_some_and(|u| !u.is_finite()) {
            return Err(wrong(
                "has an uncertainty beyond the range of numbers".to_owned(),
            ));
        }
        if standard_uncertainty.is_some_and(|u| u < 0.0) {
            return Err(wrong("has an uncertainty below 0".to_owned()));
        }
        Ok(Self {
            si,
            standard_uncertainty,
            text: text.trim().to_owned(),
            kind: PhantomData,
        })
    }
}

/// What stands before and behind the sign of an uncertainty.
pub(crate) fn value_and_uncertainty(text: &str) -> (&str, Option<&str>) {
    ["±", "+-", "+/-"]
        .iter()
        .find_map(|sign| text.split_once(sign))
        .map_or((text, None), |(value, uncertainty)| {
            (value, Some(uncertainty))
        })
}

/// The number at the start of `text` and the unit behind it.
pub(crate) fn number_and_unit(text: &str) -> Result<(f64, Unit), String> {
    let text = text.trim();
    let unit_at = text
        .char_indices()
        .find(|(at, c)| {
            let exponent = matches!(c, 'e' | 'E')
                && text[at + 1..]
                    .starts_with(|next: char| next.is_ascii_digit() || matches!(next, '-' | '+'));
            !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+') || exponent)
        })
        .map_or(text.len(), |(at, _)| at);
    let (number, unit) = text.split_at(unit_at);
    let number = number
        .parse()
        .map_err(|_| "does not begin with a number".to_owned())?;
    // a pure number needs no unit
    let unit = if unit.trim().is_empty() { "1" } else { unit };
    let unit = Unit::parse(unit).map_err(|error| format!("has no unit that is known: {error}"))?;
    Ok((number, unit))
}

impl<'de, K: Kind> Deserialize<'de> for Stated<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text<K>(PhantomData<K>);

        impl<K: Kind> Visitor<'_> for Text<K> {
            type Value = Stated<K>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} with its unit in quotes, as {}", K::NAME, K::EXAMPLE)
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Stated<K>, E> {
                text.parse().map_err(E::custom)
            }
        }

        deserializer.deserialize_any(Text(PhantomData))
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident: $words:literal, $example:literal, $unit:expr, $positive:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub enum $name {}

        impl Kind for $name {
            const NAME: &'static str = $words;
            const EXAMPLE: &'static str = $example;
            const DIMENSION: Dimension = $unit;
            const POSITIVE: bool = $positive;
        }
    )*};
}

const fn dimension(length: i8, mass: i8, time: i8, temperature: i8) -> Dimension {
    Dimension {
        length,
        mass,
        time,
        current: 0,
        temperature,
    }
}

kinds! {
    /// A length above 0 \[m\].
    Length: "a length", "\"800 mm\" or \"800 mm ± 0.5 mm\"", dimension(1, 0, 0, 0), true;
    /// A coordinate \[m\], of any sign.
    Coordinate: "a coordinate", "\"0 mm\" or \"-12 mm\"", dimension(1, 0, 0, 0), false;
    /// A mass above 0 \[kg\].
    ImpactMass: "a mass", "\"1.5 kg\" or \"2.9 gram\"", dimension(0, 1, 0, 0), true;
    /// A mass of 0 or more \[kg\], as that of an accelerometer that is not there.
    AddedMass: "a mass", "\"2.9 gram\" or \"0 kg\"", dimension(0, 1, 0, 0), false;
    /// A density above 0 [kg/m³].
    Density: "a density", "\"1150 kg/m3\"", dimension(-3, 1, 0, 0), true;
    /// A duration above 0 \[s\].
    Duration: "a duration", "\"4 ms\"", dimension(0, 0, 1, 0), true;
    /// A time of any sign \[s\].
    Time: "a time", "\"0.5 s\" or \"120 us\"", dimension(0, 0, 1, 0), false;
    /// A frequency above 0 \[Hz\].
    Frequency: "a frequency", "\"51.2 kHz\"", dimension(0, 0, -1, 0), true;
    /// A velocity above 0 [m/s].
    Velocity: "a velocity", "\"0.93 m/s\"", dimension(1, 0, -1, 0), true;
    /// A force above 0 \[N\].
    Force: "a force", "\"5 N\" or \"2 kN\"", dimension(1, 1, -2, 0), true;
    /// A modulus or a stress above 0 \[Pa\].
    Pressure: "a modulus or stress", "\"2.6 GPa\"", dimension(-1, 1, -2, 0), true;
    /// A stress of any sign \[Pa\].
    Stress: "a stress", "\"45 MPa\" or \"0 MPa\"", dimension(-1, 1, -2, 0), false;
    /// A characteristic impedance above 0 [kg/s].
    SpecificImpedance: "a characteristic impedance", "\"1000 kg/s\" or \"1000 N s/m\"", dimension(0, 1, -1, 0), true;
    /// A stiffness above 0 [N/m].
    Stiffness: "a stiffness", "\"20 MN/m\"", dimension(0, 1, -2, 0), true;
    /// A viscosity above 0 [Pa s].
    Viscosity: "a viscosity", "\"20 kPa s\"", dimension(-1, 1, -1, 0), true;
    /// A temperature \[K\].
    Temperature: "a temperature", "\"23 degC\" or \"296 K\"", dimension(0, 0, 0, 1), true;
    /// A pure number above 0.
    Ratio: "a pure number", "\"0.094\" or \"9.4 %\"", Dimension::NONE, true;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written<K: Kind>(text: &str) -> String {
        text.parse::<Stated<K>>().unwrap_err().to_string()
    }

    #[test]
    fn a_quantity_is_a_number_with_a_unit_and_an_uncertainty() {
        let of = |text: &str| text.parse::<Stated<Density>>().unwrap();
        assert!((of("912 kg/m3").si() - 912.0).abs() < 1e-12);
        assert_eq!(of("912 kg/m3").standard_uncertainty(), None);
        for text in [
            "912 kg/m^3 ± 1.824 kg/m3",
            "9.12e2kg/m³ +- 0.2 %",
            "912 kg/m3 +/- 0.2%",
        ] {
            let density = of(text);
            // two roundings
            assert!((density.si() - 912.0).abs() < 1e-12, "{text}");
            assert!(
                (density.standard_uncertainty().unwrap() - 1.824).abs() < 1e-12,
                "{text}"
            );
        }
        let room: Stated<Temperature> = "23 degC ± 0.5 degC".parse().unwrap();
        assert!((room.si() - 296.15).abs() < 1e-12);
        assert!((room.standard_uncertainty().unwrap() - 0.5).abs() < 1e-12);
        let energetic: Stated<Time> = "1e-3 s".parse().unwrap();
        assert!((energetic.si() - 1e-3).abs() < 1e-18);
    }

    #[test]
    fn what_is_beyond_the_range_of_numbers_is_said_to_be() {
        assert_eq!(
            written::<Coordinate>("-1e999 m"),
            "`-1e999 m` is beyond the range of numbers, expected a coordinate, as \"0 mm\" or \"-12 mm\""
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
        ]
        .join("\n");
        insta::assert_snapshot!(errors);
    }
}
