//! Known symbols and their definitions.

use super::ratio::Ratio;
use crate::Dimension;

/// Meaning of a symbol or of a compound of symbols.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Definition {
    pub(super) dimension: Dimension,
    pub(super) ratio: Ratio,
    /// SI value of the zero of the unit.
    pub(super) offset: f64,
}

impl Definition {
    pub(super) const NUMBER: Self = Self {
        dimension: Dimension::NONE,
        ratio: Ratio::ONE,
        offset: 0.0,
    };

    /// Multiplies by a power; `None` if an exponent overflows.
    pub(super) fn times(self, other: Self, exponent: i8) -> Option<Self> {
        Some(Self {
            dimension: self.dimension.product(other.dimension.power(exponent)?)?,
            ratio: self.ratio.times(other.ratio.power(exponent)),
            offset: 0.0,
        })
    }
}

const NUMBER: Dimension = Dimension::of([0, 0, 0, 0, 0]);
const LENGTH: Dimension = Dimension::of([1, 0, 0, 0, 0]);
const VOLUME: Dimension = Dimension::of([3, 0, 0, 0, 0]);
const MASS: Dimension = Dimension::of([0, 1, 0, 0, 0]);
const TIME: Dimension = Dimension::of([0, 0, 1, 0, 0]);
const CURRENT: Dimension = Dimension::of([0, 0, 0, 1, 0]);
const TEMPERATURE: Dimension = Dimension::of([0, 0, 0, 0, 1]);
const FREQUENCY: Dimension = Dimension::of([0, 0, -1, 0, 0]);
const ACCELERATION: Dimension = Dimension::of([1, 0, -2, 0, 0]);
const FORCE: Dimension = Dimension::of([1, 1, -2, 0, 0]);
const PRESSURE: Dimension = Dimension::of([-1, 1, -2, 0, 0]);
const ENERGY: Dimension = Dimension::of([2, 1, -2, 0, 0]);
const POWER: Dimension = Dimension::of([2, 1, -3, 0, 0]);
const CHARGE: Dimension = Dimension::of([0, 0, 1, 1, 0]);
const VOLTAGE: Dimension = Dimension::of([2, 1, -3, -1, 0]);
const RESISTANCE: Dimension = Dimension::of([2, 1, -3, -2, 0]);
const CAPACITANCE: Dimension = Dimension::of([-2, -1, 4, 2, 0]);

/// Symbols that take an SI prefix, including the words used by acquisition drivers: names,
/// dimension, numerator and denominator of the SI value.
const PREFIXABLE: &[(&[&str], Dimension, f64, f64)] = &[
    (&["m", "Meters", "meter", "metre"], LENGTH, 1.0, 1.0),
    (
        &["s", "sec", "second", "seconds", "Second", "Seconds"],
        TIME,
        1.0,
        1.0,
    ),
    (&["l", "L"], VOLUME, 1.0, 1000.0),
    (&["gram"], MASS, 1.0, 1000.0),
    (&["A", "Amps"], CURRENT, 1.0, 1.0),
    (&["K", "Kelvins"], TEMPERATURE, 1.0, 1.0),
    (&["Hz"], FREQUENCY, 1.0, 1.0),
    (&["N", "Newtons", "Newton", "newton"], FORCE, 1.0, 1.0),
    (&["Pa", "Pascals", "Pascal", "pascal"], PRESSURE, 1.0, 1.0),
    (&["bar", "Bar"], PRESSURE, 100_000.0, 1.0),
    (&["J"], ENERGY, 1.0, 1.0),
    (&["W"], POWER, 1.0, 1.0),
    (&["C"], CHARGE, 1.0, 1.0),
    (&["V", "volt", "Volt", "volts", "Volts"], VOLTAGE, 1.0, 1.0),
    (
        &["ohm", "Ohm", "Ohms", "Ω", "\u{2126}"],
        RESISTANCE,
        1.0,
        1.0,
    ),
    (&["F"], CAPACITANCE, 1.0, 1.0),
    (&["rad"], NUMBER, 1.0, 1.0),
    (&["strain", "Strain", "ε"], NUMBER, 1.0, 1.0),
    // standard gravity, third General Conference on Weights and Measures (1901)
    (&["g", "gn"], ACCELERATION, 980_665.0, 100_000.0),
];

/// Symbols without prefixes: names, dimension, numerator, denominator and SI value of the zero.
const WHOLE: &[(&[&str], Dimension, f64, f64, f64)] = &[
    (&["kg"], MASS, 1.0, 1.0, 0.0),
    (&["%"], NUMBER, 1.0, 100.0, 0.0),
    (&["ue", "uE", "microstrain"], NUMBER, 1.0, 1e6, 0.0),
    (&["millistrain"], NUMBER, 1.0, 1e3, 0.0),
    (&["min"], TIME, 60.0, 1.0, 0.0),
    (&["h"], TIME, 3600.0, 1.0, 0.0),
    // international yard and pound agreement (1959)
    (&["in", "inch", "Inches"], LENGTH, 254.0, 10_000.0, 0.0),
    (&["ft"], LENGTH, 3048.0, 10_000.0, 0.0),
    (&["cc"], VOLUME, 1.0, 1e6, 0.0),
    (&["lbm"], MASS, 45_359_237.0, 1e8, 0.0),
    // 0.45359237 kg times 9.80665 m/s^2
    (&["lbf"], FORCE, 44_482_216_152_605.0, 1e13, 0.0),
    (&["kgf", "kp"], FORCE, 980_665.0, 100_000.0, 0.0),
    // lbf divided by (0.0254 m)^2
    (
        &["psi"],
        PRESSURE,
        44_482_216_152_605.0,
        6_451_600_000.0,
        0.0,
    ),
    (&["ksi"], PRESSURE, 44_482_216_152_605.0, 6_451_600.0, 0.0),
    (&["deg", "°"], NUMBER, std::f64::consts::PI, 180.0, 0.0),
    (&["degC", "°C", "Deg C"], TEMPERATURE, 1.0, 1.0, 273.15),
    // 0 °F is 459.67 · 5/9 K
    (
        &["degF", "°F", "Deg F"],
        TEMPERATURE,
        5.0,
        9.0,
        2298.35 / 9.0,
    ),
];

/// Prefixes with numerator and denominator; both the micro sign of ISO 8859-1 and the Greek letter
/// are in use.
const PREFIXES: &[(&str, f64, f64)] = &[
    ("T", 1e12, 1.0),
    ("G", 1e9, 1.0),
    ("M", 1e6, 1.0),
    ("k", 1e3, 1.0),
    ("h", 1e2, 1.0),
    ("da", 10.0, 1.0),
    ("d", 1.0, 10.0),
    ("c", 1.0, 1e2),
    ("m", 1.0, 1e3),
    ("u", 1.0, 1e6),
    ("\u{b5}", 1.0, 1e6),
    ("\u{3bc}", 1.0, 1e6),
    ("n", 1.0, 1e9),
    ("p", 1.0, 1e12),
    ("f", 1.0, 1e15),
];

/// Meaning of the symbol `g`, which is used for two units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum G {
    /// Standard gravity, as in `mV/g`.
    Gravity,
    /// The gram, as in `g/cm3`.
    Gram,
}

/// Finds the definition of `token`; symbols without prefixes take precedence over a prefix followed
/// by a symbol.
pub(super) fn find(token: &str, g: G) -> Option<Definition> {
    whole(token)
        .or_else(|| prefixable(token, g))
        .or_else(|| prefixed(token, g))
}

fn whole(token: &str) -> Option<Definition> {
    let row = WHOLE.iter().find(|(names, ..)| names.contains(&token));
    row.map(
        |&(_, dimension, numerator, denominator, offset)| Definition {
            dimension,
            ratio: Ratio::of(numerator, denominator),
            offset,
        },
    )
}

fn prefixable(token: &str, g: G) -> Option<Definition> {
    let token = if token == "g" && g == G::Gram {
        "gram"
    } else {
        token
    };
    let row = PREFIXABLE.iter().find(|(names, ..)| names.contains(&token));
    row.map(|&(_, dimension, numerator, denominator)| Definition {
        dimension,
        ratio: Ratio::of(numerator, denominator),
        offset: 0.0,
    })
}

fn prefixed(token: &str, g: G) -> Option<Definition> {
    PREFIXES
        .iter()
        .find_map(|&(prefix, numerator, denominator)| {
            let base = prefixable(token.strip_prefix(prefix)?, g)?;
            Some(Definition {
                ratio: base.ratio.times(Ratio::of(numerator, denominator)),
                ..base
            })
        })
}
