//! The sheet of a force from a response.

use impulse::{Parameter, Penalty};
use serde::Deserialize;

use super::impact_sheet::UncertaintySheet;
use crate::hits::{HitsSheet, Reading, Stretch};
use crate::records::Records;
use crate::responses::{HitsSource, ResponseFile};
use crate::sheet::{BandSheet, Exact, Time};

/// A force that was not measured and is determined from a measured response.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseSheet {
    /// The relation of the response to the force.
    pub path: PathSheet,
    /// The files with the response, and their channels.
    pub record: Records,
    /// The hit in the record and its criteria; the first accepted hit is used. By default the whole
    /// record is the hit. Objections of the checks of hits are then only warnings, because these
    /// checks are made for forces.
    pub hit: Option<HitsSheet>,
    /// Channel of the response, such as `"face"`.
    pub response: String,
    /// Further responses to the same force, recorded together; their noise must be known.
    #[serde(default)]
    pub further: Vec<FurtherResponse>,
    /// Channel of a measured force for comparison, if there is one.
    pub compare_with: Option<String>,
    /// Noise of the response; by default the noise of each line from the scatter between three or
    /// more calibration hits, or else noise estimated from the part of the response that the force
    /// does not explain.
    #[serde(default)]
    pub noise: NoiseSheet,
    /// Regularisation of force components that the response determines poorly; none by default.
    pub regularisation: Option<RegularisationSheet>,
    /// Lines used; by default all.
    pub band: Option<BandSheet>,
    /// Time in which the force acts, counted from the first sample. By default a time about the
    /// peak that is as long as the calibration hits; without such hits the force may act at any
    /// time.
    pub acting: Option<IntervalSheet>,
    /// Excludes tension; needs `acting`.
    #[serde(default)]
    pub non_negative: bool,
    /// Bands of the force.
    #[serde(default)]
    pub uncertainty: UncertaintySheet,
}

/// A further response.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FurtherResponse {
    /// Channel of the response in the record.
    pub response: String,
    /// File of the frequency response of this channel, if the frequency response of the first
    /// response is from a file.
    pub path: Option<ResponseFile>,
    /// Channel of the response in the calibration hits; by default the channel of the same name.
    pub of_hits: Option<String>,
    /// Noise of the response, stated in the same form as the noise of the first response.
    #[serde(default)]
    pub noise: NoiseSheet,
}

/// The relation of a response to the force.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::large_enum_variant,
    reason = "a sheet contains only one of these"
)]
pub enum PathSheet {
    /// A frequency response in a file.
    File(ResponseFile),
    /// Hits with a measured force.
    Hits(HitsSource),
}

impl PathSheet {
    /// Returns the remedies for records that end before the body is at rest.
    pub(super) fn remedy_of_ringing(&self) -> &'static str {
        match self {
            Self::Hits(hits) if hits.exponential_window.is_none() => {
                "record longer, or state `problem.path.exponential_window`, such as \"1 %\""
            }
            Self::Hits(_) => {
                "record longer, or state a smaller weight in `problem.path.exponential_window`"
            }
            Self::File(_) => {
                "record longer, or measure the path under an exponential window (`exponential_window` in a sheet of `rodlab frf`)"
            }
        }
    }
}

/// Noise of a response.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum NoiseSheet {
    /// Noise of unknown size.
    #[default]
    Unknown,
    /// White noise with this standard deviation in a unit of the channel, such as `"0.5 m/s2"`.
    White(Reading),
    /// White noise, measured as the scatter over the beginning of the record at rest, such as
    /// `"4 ms"` or `"200 samples"`.
    FromRest(Stretch),
}

/// A regularisation.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RegularisationSheet {
    /// Tikhonov's method, which minimises the sum of residual and penalty.
    Tikhonov {
        /// The penalised quantity; by default the force itself.
        #[serde(default)]
        penalty: Penalty,
        /// Choice of the weight of the penalty.
        parameter: Parameter,
    },
    /// Omission of the components that the response determines too poorly: those below the limit.
    Truncated {
        /// Choice of the limit.
        parameter: Parameter,
    },
}

/// A time span.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntervalSheet {
    /// Beginning, such as `"3.5 ms"`.
    pub from: Exact<Time>,
    /// End, such as `"5 ms"`.
    pub to: Exact<Time>,
}
