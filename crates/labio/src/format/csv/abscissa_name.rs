//! Names of abscissa columns, and the writer's description of the abscissa.

use std::fmt;

use crate::Dimension;
use crate::format::text;

const TIME_NAMES: [&str; 10] = [
    "time",
    "zeit",
    "temps",
    "tid",
    "tiempo",
    "tempo",
    "x_value",
    "second",
    "seconds",
    "timestamp",
];
const FREQUENCY_NAMES: [&str; 4] = ["frequency", "freq", "frequenz", "frekvens"];
pub(super) const INDEX_NAMES: [&str; 6] =
    ["index", "sample", "samples", "sequence", "point", "points"];

/// Returns true for a time. The letter `t` alone is a time; `T` is a temperature.
pub(super) fn is_time(name: &str, unit: &str) -> bool {
    let of_unit = text::known_unit(unit).map(|unit| unit.dimension());
    called(name, &TIME_NAMES) || name == "t" || of_unit == Some(Dimension::TIME)
}

pub(super) fn is_frequency(name: &str, unit: &str) -> bool {
    // the letter `F` is a force
    called(name, &FREQUENCY_NAMES) || name == "f" || matches!(unit, "Hz" | "kHz" | "MHz")
}

/// Returns true if a name without its unit is the name of a time or a frequency.
pub(super) fn names_abscissa(name: &str) -> bool {
    is_time(name, "") || is_frequency(name, "")
}

pub(super) fn called(name: &str, names: &[&str]) -> bool {
    names.contains(&name.to_lowercase().as_str())
}

/// Description of the abscissa that our writer puts in a comment of the header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Marker {
    Even { start: f64, step: f64 },
    Uneven,
}

impl fmt::Display for Marker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Even { start, step } => write!(f, "even, start {start:?}, step {step:?}"),
            Self::Uneven => f.write_str("uneven"),
        }
    }
}

impl Marker {
    pub(super) fn parse(text: &str) -> Option<Self> {
        if text == "uneven" {
            return Some(Self::Uneven);
        }
        let (start, step) = text.strip_prefix("even, start ")?.split_once(", step ")?;
        Some(Self::Even {
            start: start.parse().ok()?,
            step: step.parse().ok()?,
        })
    }
}
