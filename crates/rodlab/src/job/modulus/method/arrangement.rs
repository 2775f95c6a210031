//! Arrangements of sensors on a rod, and the data of specimen and hits that follow from them.

use super::{GaugeSheet, MethodSheet, SectionSheet, WindowSheet};
use crate::RodlabError;
use crate::job::modulus::SpecimenSheet;
use crate::sheet::{Coordinate, Exact, Length, Stated, Time, ValueWithUncertainty, Velocity};

/// Sensors of a method. Methods of one arrangement have the same names for these fields.
pub(in crate::job::modulus) enum Arrangement<'a> {
    /// The motions of both ends of a rod.
    Ends {
        impacted_end: &'a str,
        free_end: &'a str,
    },
    /// One sensor on a rod that vibrates freely.
    FreeRod(Vibration<'a>),
    /// Two sections of a rod with a free end.
    Sections {
        first: &'a SectionSheet,
        second: &'a SectionSheet,
    },
    /// One pulse at two sections.
    Pulses {
        first: &'a WindowSheet,
        second: &'a WindowSheet,
        distance: &'a Stated<Length>,
    },
    /// The incident and the reflected pulse at one section of a rod with a free end.
    OneGauge {
        section: &'a SectionSheet,
        incident: &'a (Exact<Time>, Exact<Time>),
        reflected: &'a (Exact<Time>, Exact<Time>),
    },
    /// Several gauges.
    Gauges {
        gauges: &'a [GaugeSheet],
        /// Position of the free end, if it is a condition of the method.
        free_end_at: Option<&'a Stated<Coordinate>>,
        /// True if the method corrects for an exponential window, so that hits may end while the
        /// rod rings.
        may_ring: bool,
    },
}

/// Channel of a method, its place in the sheet, and whether it must be a motion.
pub(in crate::job::modulus) struct Taken<'a> {
    pub(in crate::job::modulus) channel: &'a str,
    pub(in crate::job::modulus) field: String,
    pub(in crate::job::modulus) motion: bool,
}

/// Data of the specimen that a method uses; errors of these data become errors of the modulus.
pub(in crate::job::modulus) struct UsedOfSpecimen {
    pub(in crate::job::modulus) length: bool,
    pub(in crate::job::modulus) end_mass: bool,
}

/// Data of the hits that a method uses.
pub(in crate::job::modulus) enum FromHits<'a> {
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
        may_ring: bool,
    },
    Modes(Vibration<'a>),
}

/// Pulse in a channel, with its field in the sheet.
pub(in crate::job::modulus) struct Pulse<'a> {
    pub(in crate::job::modulus) channel: &'a str,
    pub(in crate::job::modulus) from: &'a Exact<Time>,
    pub(in crate::job::modulus) to: &'a Exact<Time>,
    pub(in crate::job::modulus) field: String,
}

/// Data of a free vibration.
pub(in crate::job::modulus) struct Vibration<'a> {
    pub(in crate::job::modulus) channel: &'a str,
    pub(in crate::job::modulus) from: &'a Exact<Time>,
    pub(in crate::job::modulus) wave_speed: &'a Exact<Velocity>,
}

/// Distance over which a method counts wavelengths.
pub(in crate::job::modulus) enum Counted<'a> {
    /// The length of the specimen.
    Length,
    /// A distance between sections \[m\].
    Between(f64),
    /// The least distance between these gauges.
    Gauges(&'a [GaugeSheet]),
}

impl MethodSheet {
    /// Returns the data of the specimen that the method uses.
    pub(in crate::job::modulus) fn use_of_specimen(&self) -> UsedOfSpecimen {
        let (length, end_mass) = match self.arrangement() {
            Arrangement::Ends { .. } | Arrangement::FreeRod(_) => (true, true),
            Arrangement::Sections { .. } | Arrangement::OneGauge { .. } => (false, true),
            Arrangement::Pulses { .. } => (false, false),
            Arrangement::Gauges { free_end_at, .. } => (false, free_end_at.is_some()),
        };
        UsedOfSpecimen { length, end_mass }
    }

    /// Returns the name of a length or distance that the modulus depends on and that is stated
    /// without an uncertainty.
    pub(in crate::job::modulus) fn length_without_uncertainty(
        &self,
        specimen: &SpecimenSheet,
    ) -> Option<&'static str> {
        let is_bare = |stated: ValueWithUncertainty| {
            stated.value > 0.0 && stated.standard_uncertainty.is_none()
        };
        let (is_missing, name) = match self.arrangement() {
            Arrangement::Ends { .. } | Arrangement::FreeRod(_) => (
                specimen
                    .length
                    .as_ref()
                    .is_some_and(|length| is_bare(length.with_uncertainty())),
                "The length of the specimen",
            ),
            Arrangement::Sections { .. } | Arrangement::OneGauge { .. } => (
                self.sections()
                    .iter()
                    .any(|(section, _)| is_bare(section.from_free_end.with_uncertainty())),
                "The distance of a section from the free end",
            ),
            Arrangement::Pulses { distance, .. } => (
                is_bare(distance.with_uncertainty()),
                "The distance of the sections",
            ),
            Arrangement::Gauges { gauges, .. } => (
                gauges
                    .iter()
                    .any(|gauge| gauge.at.with_uncertainty().standard_uncertainty.is_none()),
                "The position of a gauge",
            ),
        };
        is_missing.then_some(name)
    }

    /// Returns the sections of a rod with a free end, with their fields in the sheet.
    pub(in crate::job::modulus) fn sections(&self) -> Vec<(&SectionSheet, String)> {
        match self.arrangement() {
            Arrangement::Sections { first, second } => {
                vec![(first, self.field("first")), (second, self.field("second"))]
            }
            Arrangement::OneGauge { section, .. } => vec![(section, self.field("section"))],
            _ => Vec::new(),
        }
    }

    /// Returns the channels. The first one marks the beginning of a hit, unless the sheet states
    /// another channel.
    pub(in crate::job::modulus) fn channels(&self) -> Vec<Taken<'_>> {
        let taken = |channel, field: &str, motion| Taken {
            channel,
            field: self.field(field),
            motion,
        };
        match self.arrangement() {
            Arrangement::Ends {
                impacted_end,
                free_end,
            } => vec![
                taken(impacted_end, "impacted_end", true),
                taken(free_end, "free_end", true),
            ],
            Arrangement::FreeRod(vibration) => vec![taken(vibration.channel, "channel", false)],
            Arrangement::Sections { first, second } => vec![
                taken(first.channel.as_str(), "first.channel", false),
                taken(second.channel.as_str(), "second.channel", false),
            ],
            Arrangement::Pulses { first, second, .. } => vec![
                taken(first.channel.as_str(), "first.channel", false),
                taken(second.channel.as_str(), "second.channel", false),
            ],
            Arrangement::OneGauge { section, .. } => {
                vec![taken(section.channel.as_str(), "section.channel", false)]
            }
            Arrangement::Gauges { gauges, .. } => gauges
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
    pub(in crate::job::modulus) fn taken_from_hits(&self) -> FromHits<'_> {
        let pulse = |channel, (from, to), field: &str| Pulse {
            channel,
            from,
            to,
            field: self.field(field),
        };
        match self.arrangement() {
            Arrangement::Ends {
                impacted_end,
                free_end,
            } => FromHits::Ratio(impacted_end, free_end),
            Arrangement::FreeRod(vibration) => FromHits::Modes(vibration),
            Arrangement::Sections { first, second } => {
                FromHits::Ratio(&first.channel, &second.channel)
            }
            Arrangement::Pulses { first, second, .. } => FromHits::Pulses {
                earlier: pulse(&first.channel, (&first.from, &first.to), "first"),
                later: pulse(&second.channel, (&second.from, &second.to), "second"),
            },
            Arrangement::OneGauge {
                section,
                incident: (from, to),
                reflected: (later_from, later_to),
            } => FromHits::Pulses {
                earlier: pulse(&section.channel, (from, to), "incident"),
                later: pulse(&section.channel, (later_from, later_to), "reflected"),
            },
            Arrangement::Gauges {
                gauges, may_ring, ..
            } => FromHits::Gauges { gauges, may_ring },
        }
    }

    /// Returns the gauges, if the method has gauges.
    pub(in crate::job::modulus) fn gauges(&self) -> Option<&[GaugeSheet]> {
        match self.arrangement() {
            Arrangement::Gauges { gauges, .. } => Some(gauges),
            _ => None,
        }
    }

    /// Returns the position of the free end of a rod with gauges if it is a condition of the
    /// method.
    pub(in crate::job::modulus) fn used_free_end(&self) -> Option<&Stated<Coordinate>> {
        match self.arrangement() {
            Arrangement::Gauges { free_end_at, .. } => free_end_at,
            _ => None,
        }
    }

    /// Returns the distance over which the method counts wavelengths.
    pub(in crate::job::modulus) fn counted(&self) -> Counted<'_> {
        let from_end = |section: &SectionSheet| section.from_free_end.with_uncertainty().value;
        match self.arrangement() {
            Arrangement::Ends { .. } | Arrangement::FreeRod(_) => Counted::Length,
            Arrangement::Sections { first, second } => {
                Counted::Between(from_end(first).max(from_end(second)))
            }
            Arrangement::Pulses { distance, .. } => {
                Counted::Between(distance.with_uncertainty().value)
            }
            Arrangement::OneGauge { section, .. } => Counted::Between(2.0 * from_end(section)),
            Arrangement::Gauges { gauges, .. } => Counted::Gauges(gauges),
        }
    }

    /// Returns true if all channels must have the same quantity.
    pub(in crate::job::modulus) fn one_quantity(&self) -> bool {
        !matches!(self.arrangement(), Arrangement::Sections { .. })
    }

    /// Returns numerator and denominator of the ratio in a file, in words.
    pub(in crate::job::modulus) fn ratio_in_words(&self) -> Result<&'static str, RodlabError> {
        match self.arrangement() {
            Arrangement::Ends { .. } => Ok("impacted end over free end"),
            Arrangement::Sections { .. } => Ok("first section over second"),
            Arrangement::Pulses { .. } => Ok("pulse at the second section over that at the first"),
            Arrangement::OneGauge { .. } => Ok("reflected pulse over incident pulse"),
            Arrangement::Gauges { .. } => Err("the spectra of all gauges"),
            Arrangement::FreeRod(_) => Err("their histories"),
        }
        .map_err(|needed| {
            let hits = format!("hits: {} needs {needed}", self.name());
            RodlabError::request("source", "a ratio", hits)
        })
    }
}
