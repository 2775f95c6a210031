//! Methods for the modulus: their sheets and their arrangements of sensors.

mod arrangement;
mod section;

use serde::Deserialize;

use crate::sheet::{Coordinate, Exact, Language, Length, Stated, Time, Velocity};
pub(super) use arrangement::{Arrangement, Counted, FromHits, Pulse, Taken, Vibration};
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

impl MethodSheet {
    /// Returns the name of the method in the sheet, and its name for a sentence.
    fn names(&self) -> (&'static str, &'static str) {
        match self {
            Self::TwoPoint { .. } => ("TwoPoint", "the two-point method"),
            Self::Resonances { .. } => ("Resonances", "the resonances of the rod"),
            Self::FreeVibration { .. } => (
                "FreeVibration",
                "frequency and decay of the modes of the free rod",
            ),
            Self::FreeEnd { .. } => ("FreeEnd", "the method of two sections and a free end"),
            Self::SeparatePulses { .. } => ("SeparatePulses", "separate pulses at two sections"),
            Self::OneGauge { .. } => (
                "OneGauge",
                "the incident and the reflected pulse at one gauge",
            ),
            Self::ThreePoint { .. } => ("ThreePoint", "the three-point method"),
            Self::MultiPoint { .. } => ("MultiPoint", "least squares over all gauges"),
        }
    }

    /// Returns the name of the method in the sheet.
    pub(super) fn name(&self) -> &'static str {
        self.names().0
    }

    /// Returns the name of the method for a sentence.
    pub(super) fn words(&self) -> &'static str {
        self.names().1
    }

    /// Returns the place in the sheet of the field `name` of the method.
    pub(super) fn field(&self, name: &str) -> String {
        format!("method.{}.{name}", Language::Toml.name_of(self.name()))
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

    /// Returns the sensors of the method.
    pub(super) fn arrangement(&self) -> Arrangement<'_> {
        match self {
            Self::TwoPoint {
                impacted_end,
                free_end,
                ..
            }
            | Self::Resonances {
                impacted_end,
                free_end,
            } => Arrangement::Ends {
                impacted_end,
                free_end,
            },
            Self::FreeVibration {
                channel,
                from,
                wave_speed,
            } => Arrangement::FreeRod(Vibration {
                channel,
                from,
                wave_speed,
            }),
            Self::FreeEnd { first, second, .. } => Arrangement::Sections { first, second },
            Self::SeparatePulses {
                first,
                second,
                distance,
                ..
            } => Arrangement::Pulses {
                first,
                second,
                distance,
            },
            Self::OneGauge {
                section,
                incident,
                reflected,
                ..
            } => Arrangement::OneGauge {
                section,
                incident,
                reflected,
            },
            Self::ThreePoint { gauges } => Arrangement::Gauges {
                gauges,
                free_end_at: None,
                may_ring: false,
            },
            // with two gauges, the free end is the third condition
            Self::MultiPoint {
                gauges,
                free_end_at,
                ..
            } => Arrangement::Gauges {
                gauges,
                free_end_at: free_end_at.as_ref().filter(|_| gauges.len() == 2),
                may_ring: true,
            },
        }
    }
}
