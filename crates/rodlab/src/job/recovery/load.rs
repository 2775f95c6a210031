//! Loads on a specimen, as stated in a sheet.

use cmod::recovery::{LoadHistory, LoadSegment};
use serde::Deserialize;

use crate::sheet::{Duration, Frequency, NotFollowed, Stress};
use crate::{InStep, RodlabError};

/// A part of a load.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LoadSheet {
    /// A constant stress; `"0 MPa"` for a rest.
    Constant {
        /// Stress, such as `"45 MPa"`.
        stress: NotFollowed<Stress>,
        /// Duration, such as `"30 min"`.
        duration: NotFollowed<Duration>,
    },
    /// A stress that changes linearly.
    Ramp {
        /// Stress at the beginning.
        from: NotFollowed<Stress>,
        /// Stress at the end.
        to: NotFollowed<Stress>,
        /// Duration.
        duration: NotFollowed<Duration>,
    },
    /// A sine about a mean.
    Periodic {
        /// Mean stress.
        mean: NotFollowed<Stress>,
        /// Amplitude.
        amplitude: NotFollowed<Stress>,
        /// Frequency of the load, such as `"4 Hz"`.
        frequency: NotFollowed<Frequency>,
        /// Duration.
        duration: NotFollowed<Duration>,
    },
}

impl LoadSheet {
    fn segment(&self) -> LoadSegment {
        match self {
            Self::Constant { stress, duration } => LoadSegment::Constant {
                stress: stress.si(),
                duration: duration.si(),
            },
            Self::Ramp { from, to, duration } => LoadSegment::Ramp {
                from: from.si(),
                to: to.si(),
                duration: duration.si(),
            },
            Self::Periodic {
                mean,
                amplitude,
                frequency,
                duration,
            } => LoadSegment::Periodic {
                mean: mean.si(),
                amplitude: amplitude.si(),
                frequency_hz: frequency.si(),
                duration: duration.si(),
            },
        }
    }
}

/// Returns the load of all parts in sequence; `field` is the place of the load in the sheet.
pub(super) fn history(parts: &[LoadSheet], field: &str) -> Result<LoadHistory, RodlabError> {
    LoadHistory::new(parts.iter().map(LoadSheet::segment).collect()).in_step(field)
}
