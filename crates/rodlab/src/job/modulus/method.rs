//! Methods for the modulus, and their channels.

use cmod::multi_point::Quantity;
use serde::Deserialize;

use crate::RodlabError;
use crate::sheet::{Coordinate, Exact, Length, Stated, Time, Velocity};

/// A method with its data.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MethodSheet {
    /// The motions of both ends of a rod struck at one of them (paper A).
    TwoPoint {
        /// Channel of the struck end.
        impacted_end: String,
        /// Channel of the other end.
        free_end: String,
        /// Solver of the equation; `Continuation` by default.
        #[serde(default)]
        solver: Option<SolverSheet>,
    },
    /// The motions of both ends, evaluated at the resonances only.
    Resonances {
        /// Channel of the struck end.
        impacted_end: String,
        /// Channel of the other end.
        free_end: String,
    },
    /// Frequencies and decays of the longitudinal modes of a rod that hangs free and was struck:
    /// metals, ceramics, glasses. One sensor of motion, strain or sound anywhere on the rod.
    FreeVibration {
        /// Channel of the sensor.
        channel: String,
        /// Beginning of the free vibration, when the hammer has left the rod, measured from the
        /// beginning of a hit's record, such as `"5 ms"`.
        from: Exact<Time>,
        /// A guess of the wave speed, such as `"5100 m/s"`, within a fifth; the modes are numbered
        /// with it.
        wave_speed: Exact<Velocity>,
    },
    /// Two sections of a rod with a free end.
    FreeEnd {
        /// The section in the numerator, usually the one nearer to the impact.
        first: SectionSheet,
        /// The section in the denominator, usually the free end.
        second: SectionSheet,
        /// A guess of the wave speed, such as `"1700 m/s"`, within 30 %; searched by default.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// One pulse at two sections, before any reflection returns.
    SeparatePulses {
        /// The section that the pulse passes first.
        first: WindowSheet,
        /// The section that the pulse passes second.
        second: WindowSheet,
        /// Distance between the two sections.
        distance: Stated<Length>,
        /// A guess of the wave speed.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// The incident and the reflected pulse at one section of a rod with a free end.
    OneGauge {
        /// The section.
        section: SectionSheet,
        /// Start and end of the incident pulse, measured from the beginning of a hit's record.
        incident: (Exact<Time>, Exact<Time>),
        /// Start and end of the reflected pulse.
        reflected: (Exact<Time>, Exact<Time>),
        /// A guess of the wave speed.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// Three equidistant gauges, in closed form (paper B).
    ThreePoint {
        /// The gauges, in order of their positions.
        gauges: Vec<GaugeSheet>,
    },
    /// Three or more gauges at any positions, or two before a free end, by least squares.
    MultiPoint {
        /// The gauges, in order of their positions.
        gauges: Vec<GaugeSheet>,
        /// A guess of the wave speed.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
        /// Position of a free end beyond the last gauge, if the rod has one. For two gauges it is
        /// the third condition, with the `accelerometer_mass` of the specimen on it; three or more
        /// gauges are checked against it.
        #[serde(default)]
        free_end_at: Option<Stated<Coordinate>>,
    },
}

/// Solvers of the equation of the two-point method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum SolverSheet {
    /// Continuation in the mass of the accelerometer.
    Continuation,
    /// Newton's iteration, as printed; for comparison.
    Newton,
    /// The series in the mass ratio; for comparison.
    Series,
}

/// A section of a rod with a free end.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionSheet {
    /// Channel.
    pub channel: String,
    /// Distance from the free end, such as `"350 mm ± 0.5 mm"`, or `"0 mm"` for the end itself.
    pub from_free_end: Stated<Coordinate>,
    /// Quantity measured there; by default the quantity of the channel. A ratio from a file has no
    /// channels: state the quantity here.
    #[serde(default)]
    pub quantity: Option<QuantitySheet>,
}

/// A pulse at a section.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindowSheet {
    /// Channel.
    pub channel: String,
    /// Beginning of the pulse, measured from the beginning of a hit's record, such as `"1.2 ms"`.
    pub from: Exact<Time>,
    /// End of the pulse.
    pub to: Exact<Time>,
}

/// A gauge.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaugeSheet {
    /// Channel.
    pub channel: String,
    /// Position along the rod, such as `"250 mm ± 0.5 mm"`.
    pub at: Stated<Coordinate>,
}

/// Quantity measured at a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum QuantitySheet {
    /// Strain, positive in tension.
    Strain,
    /// Displacement towards the free end.
    Displacement,
    /// Velocity towards the free end.
    Velocity,
    /// Acceleration towards the free end.
    Acceleration,
}

impl From<QuantitySheet> for Quantity {
    fn from(quantity: QuantitySheet) -> Self {
        match quantity {
            QuantitySheet::Strain => Self::Strain,
            QuantitySheet::Displacement => Self::Displacement,
            QuantitySheet::Velocity => Self::Velocity,
            QuantitySheet::Acceleration => Self::Acceleration,
        }
    }
}

/// The quantity of a channel in `cmod`: strain if the quantity is proportional to strain; `None`
/// for quantities that no gauge on a rod measures.
pub(super) fn of_channel(quantity: labio::Quantity) -> Option<QuantitySheet> {
    match quantity {
        // in a uniform bar they are proportional to the strain, and the factor cancels
        labio::Quantity::Strain
        | labio::Quantity::Force
        | labio::Quantity::Pressure
        | labio::Quantity::Voltage => Some(QuantitySheet::Strain),
        labio::Quantity::Displacement => Some(QuantitySheet::Displacement),
        labio::Quantity::Velocity => Some(QuantitySheet::Velocity),
        labio::Quantity::Acceleration => Some(QuantitySheet::Acceleration),
        _ => None,
    }
}

/// A channel of a method, its place in the sheet, and its restriction to motions.
pub(super) struct Taken<'a> {
    pub(super) channel: &'a str,
    pub(super) field: String,
    pub(super) motion: bool,
}

/// Data of the specimen that a method uses; the errors of these data become errors of the modulus.
pub(super) struct UsedOfSpecimen {
    pub(super) length: bool,
    pub(super) end_mass: bool,
}

impl MethodSheet {
    /// Name of the method in the sheet.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::TwoPoint { .. } => "TwoPoint",
            Self::Resonances { .. } => "Resonances",
            Self::FreeVibration { .. } => "FreeVibration",
            Self::FreeEnd { .. } => "FreeEnd",
            Self::SeparatePulses { .. } => "SeparatePulses",
            Self::OneGauge { .. } => "OneGauge",
            Self::ThreePoint { .. } => "ThreePoint",
            Self::MultiPoint { .. } => "MultiPoint",
        }
    }

    /// Name of the method in a sentence.
    pub(super) fn words(&self) -> &'static str {
        match self {
            Self::TwoPoint { .. } => "the two-point method",
            Self::Resonances { .. } => "the resonances of the rod",
            Self::FreeVibration { .. } => "frequency and decay of the modes of the free rod",
            Self::FreeEnd { .. } => "the method of two sections and a free end",
            Self::SeparatePulses { .. } => "separate pulses at two sections",
            Self::OneGauge { .. } => "the incident and the reflected pulse at one gauge",
            Self::ThreePoint { .. } => "the three-point method",
            Self::MultiPoint { .. } => "least squares over all gauges",
        }
    }

    /// Returns the data of the specimen that the method uses.
    pub(super) fn use_of_specimen(&self) -> UsedOfSpecimen {
        let (length, end_mass) = match self {
            Self::TwoPoint { .. } | Self::Resonances { .. } | Self::FreeVibration { .. } => {
                (true, true)
            }
            Self::FreeEnd { .. } | Self::OneGauge { .. } => (false, true),
            Self::SeparatePulses { .. } | Self::ThreePoint { .. } => (false, false),
            Self::MultiPoint { .. } => (false, self.used_free_end().is_some()),
        };
        UsedOfSpecimen { length, end_mass }
    }

    /// The sections of a rod with a free end, with their fields in the sheet.
    pub(super) fn sections(&self) -> Vec<(&SectionSheet, &'static str)> {
        match self {
            Self::FreeEnd { first, second, .. } => {
                vec![(first, "method.first"), (second, "method.second")]
            }
            Self::OneGauge { section, .. } => vec![(section, "method.section")],
            _ => Vec::new(),
        }
    }

    /// The channels, the first of which marks the beginning of a hit unless the sheet states
    /// another.
    pub(super) fn channels(&self) -> Vec<Taken<'_>> {
        let taken = |channel, field: &str, motion| Taken {
            channel,
            field: format!("method.{field}"),
            motion,
        };
        match self {
            Self::TwoPoint {
                impacted_end,
                free_end,
                ..
            }
            | Self::Resonances {
                impacted_end,
                free_end,
            } => vec![
                taken(impacted_end.as_str(), "impacted_end", true),
                taken(free_end.as_str(), "free_end", true),
            ],
            Self::FreeVibration { channel, .. } => vec![taken(channel.as_str(), "channel", false)],
            Self::FreeEnd { first, second, .. } => vec![
                taken(first.channel.as_str(), "first.channel", false),
                taken(second.channel.as_str(), "second.channel", false),
            ],
            Self::SeparatePulses { first, second, .. } => vec![
                taken(first.channel.as_str(), "first.channel", false),
                taken(second.channel.as_str(), "second.channel", false),
            ],
            Self::OneGauge { section, .. } => {
                vec![taken(section.channel.as_str(), "section.channel", false)]
            }
            Self::ThreePoint { gauges } | Self::MultiPoint { gauges, .. } => gauges
                .iter()
                .enumerate()
                .map(|(index, gauge)| {
                    let field = format!("gauges[{index}].channel");
                    taken(gauge.channel.as_str(), &field, false)
                })
                .collect(),
        }
    }

    /// Position of the free end if it is a condition of the method, that is with two gauges.
    pub(super) fn used_free_end(&self) -> Option<&Stated<Coordinate>> {
        match self {
            Self::MultiPoint {
                gauges,
                free_end_at,
                ..
            } if gauges.len() == 2 => free_end_at.as_ref(),
            _ => None,
        }
    }

    /// Returns true if all channels must have the same quantity.
    pub(super) fn one_quantity(&self) -> bool {
        !matches!(self, Self::FreeEnd { .. })
    }

    /// Numerator and denominator of the ratio in a file, in words.
    pub(super) fn ratio_in_words(&self) -> Result<&'static str, RodlabError> {
        match self {
            Self::TwoPoint { .. } | Self::Resonances { .. } => Ok("impacted end over free end"),
            Self::FreeEnd { .. } => Ok("first section over second"),
            Self::SeparatePulses { .. } => Ok("pulse at the second section over that at the first"),
            Self::OneGauge { .. } => Ok("reflected pulse over incident pulse"),
            Self::ThreePoint { .. } | Self::MultiPoint { .. } => Err(RodlabError::request(
                "source",
                "a ratio",
                format!("hits: {} needs the spectra of all gauges", self.name()),
            )),
            Self::FreeVibration { .. } => Err(RodlabError::request(
                "source",
                "a ratio",
                "hits: FreeVibration needs their histories",
            )),
        }
    }
}
