//! Methods for the modulus: their sheets, and the data of specimen and hits that they need.

mod section;

use serde::Deserialize;

use crate::RodlabError;
use crate::sheet::{Coordinate, Exact, Language, Length, Stated, Time, Velocity};
pub(super) use section::of_channel;
pub use section::{GaugeSheet, QuantitySheet, SectionSheet, WindowSheet};

/// Method with its data.
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
    /// The motions of both ends of a rod, evaluated at the resonances only.
    Resonances {
        /// Channel of the struck end.
        impacted_end: String,
        /// Channel of the other end.
        free_end: String,
    },
    /// Frequencies and decays of the longitudinal modes of a freely hanging rod after a blow, for
    /// metals, ceramics and glasses. One sensor of motion, strain or sound anywhere on the rod is
    /// sufficient.
    FreeVibration {
        /// Channel of the sensor.
        channel: String,
        /// Beginning of the evaluated free vibration, after the hammer has left the rod, measured
        /// from the beginning of a hit's record, such as `"5 ms"`.
        from: Exact<Time>,
        /// Guess of the wave speed, such as `"5100 m/s"`, within a fifth of the true value; it
        /// determines the numbers of the modes.
        wave_speed: Exact<Velocity>,
    },
    /// Two sections of a rod with a free end.
    FreeEnd {
        /// The section in the numerator, usually the one nearer to the impact.
        first: SectionSheet,
        /// The section in the denominator, usually the free end.
        second: SectionSheet,
        /// Guess of the wave speed, such as `"1700 m/s"`, within 30 % of the true value; by default
        /// the speed is searched.
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
        /// Guess of the wave speed; by default the speed is searched.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// The incident pulse and the reflected pulse at one section of a rod with a free end.
    OneGauge {
        /// The section.
        section: SectionSheet,
        /// Start and end of the incident pulse, measured from the beginning of a hit's record.
        incident: (Exact<Time>, Exact<Time>),
        /// Start and end of the reflected pulse.
        reflected: (Exact<Time>, Exact<Time>),
        /// Guess of the wave speed; by default the speed is searched.
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
        /// Guess of the wave speed; by default the speed is searched.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
        /// Position of a free end beyond the last gauge, if the rod has one. For two gauges the
        /// free end, with the `accelerometer_mass` of the specimen on it, is the third condition.
        /// Three or more gauges are checked against it.
        #[serde(default)]
        free_end_at: Option<Stated<Coordinate>>,
    },
}

/// Solvers of the equation of the two-point method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum SolverSheet {
    /// Continuation in the mass of the accelerometer.
    Continuation,
    /// Newton's iteration as printed in paper A; for comparison.
    Newton,
    /// The series in the mass ratio; for comparison.
    Series,
}

/// Channel of a method, its place in the sheet, and whether it must be a motion.
pub(super) struct Taken<'a> {
    pub(super) channel: &'a str,
    pub(super) field: String,
    pub(super) motion: bool,
}

/// Data of the specimen that a method uses; errors of these data become errors of the modulus.
pub(super) struct UsedOfSpecimen {
    pub(super) length: bool,
    pub(super) end_mass: bool,
}

/// Data of the hits that a method uses.
pub(super) enum FromHits<'a> {
    /// The ratio of the first channel to the second.
    Ratio(&'a str, &'a str),
    /// The ratio of the later of two pulses to the earlier pulse.
    Pulses {
        earlier: Pulse<'a>,
        later: Pulse<'a>,
    },
    /// The spectra of all gauges.
    Gauges {
        gauges: &'a [GaugeSheet],
        /// True if the method corrects for an exponential window, so that hits may end while the
        /// rod rings.
        may_ring: bool,
    },
    /// The modes of the free vibration.
    Modes(Vibration<'a>),
}

/// Pulse in a channel, with its field in the sheet.
pub(super) struct Pulse<'a> {
    pub(super) channel: &'a str,
    pub(super) from: &'a Exact<Time>,
    pub(super) to: &'a Exact<Time>,
    pub(super) field: &'static str,
}

/// Data of a free vibration.
pub(super) struct Vibration<'a> {
    pub(super) channel: &'a str,
    pub(super) from: &'a Exact<Time>,
    pub(super) wave_speed: &'a Exact<Velocity>,
}

/// Distance over which a method counts wavelengths.
pub(super) enum Counted<'a> {
    /// The length of the specimen.
    Length,
    /// A distance between sections \[m\].
    Between(f64),
    /// The least distance between these gauges.
    Gauges(&'a [GaugeSheet]),
}

impl MethodSheet {
    /// Returns the name of the method in the sheet.
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

    /// Returns the place in the sheet of the field `name` of the method.
    pub(super) fn field(&self, name: &str) -> String {
        format!("method.{}.{name}", Language::Toml.name_of(self.name()))
    }

    /// Returns the name of the method for a sentence.
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

    /// Returns the sections of a rod with a free end, with their fields in the sheet.
    pub(super) fn sections(&self) -> Vec<(&SectionSheet, &'static str)> {
        match self {
            Self::FreeEnd { first, second, .. } => {
                vec![
                    (first, "method.free_end.first"),
                    (second, "method.free_end.second"),
                ]
            }
            Self::OneGauge { section, .. } => vec![(section, "method.one_gauge.section")],
            _ => Vec::new(),
        }
    }

    /// Returns the channels. The first one marks the beginning of a hit, unless the sheet states
    /// another channel.
    pub(super) fn channels(&self) -> Vec<Taken<'_>> {
        let taken = |channel, field: &str, motion| Taken {
            channel,
            field: self.field(field),
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

    /// Returns the data of the hits that the method uses.
    pub(super) fn taken_from_hits(&self) -> FromHits<'_> {
        match self {
            Self::TwoPoint {
                impacted_end,
                free_end,
                ..
            }
            | Self::Resonances {
                impacted_end,
                free_end,
            } => FromHits::Ratio(impacted_end, free_end),
            Self::FreeVibration {
                channel,
                from,
                wave_speed,
            } => FromHits::Modes(Vibration {
                channel,
                from,
                wave_speed,
            }),
            Self::FreeEnd { first, second, .. } => FromHits::Ratio(&first.channel, &second.channel),
            Self::SeparatePulses { first, second, .. } => FromHits::Pulses {
                earlier: first.pulse("method.separate_pulses.first"),
                later: second.pulse("method.separate_pulses.second"),
            },
            Self::OneGauge {
                section,
                incident,
                reflected,
                ..
            } => {
                let pulse = |(from, to), field| Pulse {
                    channel: &section.channel,
                    from,
                    to,
                    field,
                };
                FromHits::Pulses {
                    earlier: pulse((&incident.0, &incident.1), "method.one_gauge.incident"),
                    later: pulse((&reflected.0, &reflected.1), "method.one_gauge.reflected"),
                }
            }
            Self::ThreePoint { gauges } => FromHits::Gauges {
                gauges,
                may_ring: false,
            },
            Self::MultiPoint { gauges, .. } => FromHits::Gauges {
                gauges,
                may_ring: true,
            },
        }
    }

    /// Returns the gauges, if the method has gauges.
    pub(super) fn gauges(&self) -> Option<&[GaugeSheet]> {
        match self.taken_from_hits() {
            FromHits::Gauges { gauges, .. } => Some(gauges),
            _ => None,
        }
    }

    /// Returns the distance over which the method counts wavelengths.
    pub(super) fn counted(&self) -> Counted<'_> {
        let from_end = |section: &SectionSheet| section.from_free_end.with_uncertainty().value;
        match self {
            Self::TwoPoint { .. } | Self::Resonances { .. } | Self::FreeVibration { .. } => {
                Counted::Length
            }
            Self::FreeEnd { first, second, .. } => {
                Counted::Between(from_end(first).max(from_end(second)))
            }
            Self::SeparatePulses { distance, .. } => {
                Counted::Between(distance.with_uncertainty().value)
            }
            Self::OneGauge { section, .. } => Counted::Between(2.0 * from_end(section)),
            Self::ThreePoint { gauges } | Self::MultiPoint { gauges, .. } => {
                Counted::Gauges(gauges)
            }
        }
    }

    /// Returns the optional field of the method, and its default in words.
    pub(super) fn left_open(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::TwoPoint { .. } => Some(("method.solver", "continuation in the mass ratio")),
            Self::FreeEnd { .. }
            | Self::SeparatePulses { .. }
            | Self::OneGauge { .. }
            | Self::MultiPoint { .. } => Some(("method.wave_speed", "searched")),
            Self::Resonances { .. } | Self::FreeVibration { .. } | Self::ThreePoint { .. } => None,
        }
    }

    /// Returns the position of the free end if it is a condition of the method, that is, with two
    /// gauges.
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

    /// Returns numerator and denominator of the ratio in a file, in words.
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
