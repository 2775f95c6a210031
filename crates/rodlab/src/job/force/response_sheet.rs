//! The sheet of a force from a response.

use serde::Deserialize;

use super::impact_lines::UncertaintySheet;
use crate::hits::{HitsSheet, Reading, Stretch};
use crate::records::Records;
use crate::responses::{HitsSource, ResponseFile};
use crate::sheet::{Exact, Frequency, Time};

/// A force that was not measured, from a response that was.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseSheet {
    /// How the response hangs on the force.
    pub path: PathSheet,
    /// The files with the response, and what their channels are.
    pub record: Records,
    /// Where the blow is in the record, and what it must be; the first that is accepted is taken. By default the record is the blow, and
    /// what the checks of hits have against it is a warning: they are made for forces.
    #[serde(default)]
    pub hit: Option<HitsSheet>,
    /// Channel of the response, as `"face"`.
    pub response: String,
    /// Channel of a force to compare with, where there is one.
    #[serde(default)]
    pub compare_with: Option<String>,
    /// Noise of the response; by default that of each line by the scatter between calibration hits, where there are three or more, or one that is estimated
    /// from what the force does not explain.
    #[serde(default)]
    pub noise: NoiseSheet,
    /// How what the response says too little of is kept from becoming force; by default it is not.
    #[serde(default)]
    pub regularisation: Option<RegularisationSheet>,
    /// Lines that are used; by default all.
    #[serde(default)]
    pub band: Option<BandSheet>,
    /// When the force acts, from the first sample on; by default about its peak as long as the calibration hits, or at any time where there are none.
    #[serde(default)]
    pub acting: Option<IntervalSheet>,
    /// Whether the force is nowhere tension; needs `acting`.
    #[serde(default)]
    pub non_negative: bool,
    /// Bands of the force.
    #[serde(default)]
    pub uncertainty: UncertaintySheet,
}

/// How a response hangs on the force.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::large_enum_variant, reason = "there is one of them in a sheet")]
pub enum PathSheet {
    /// By a frequency response in a file.
    File(ResponseFile),
    /// By hits of which the force was measured.
    Hits(HitsSource),
}

/// Noise of a response.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum NoiseSheet {
    /// It is not known.
    #[default]
    Unknown,
    /// White, of this standard deviation in a unit of the channel, as `"0.5 m/s2"`.
    White(Reading),
    /// White, by the scatter over the beginning of the record, when nothing has happened yet, as `"4 ms"` or `"200 samples"`.
    FromRest(Stretch),
}

/// A regularisation.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RegularisationSheet {
    /// Tikhonov's: residual and penalty together are smallest.
    Tikhonov {
        /// What is to be small; by default the force itself.
        #[serde(default)]
        penalty: PenaltySheet,
        /// Where the weight of the penalty comes from.
        parameter: ParameterSheet,
    },
    /// What the response tells less of than the parameter is left out.
    Truncated {
        /// Where the limit comes from.
        parameter: ParameterSheet,
    },
}

/// What Tikhonov's method keeps small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum PenaltySheet {
    /// The force.
    #[default]
    Size,
    /// Its rate.
    Slope,
    /// The rate of its rate.
    Curvature,
}

/// Where the parameter of a regularisation comes from.
#[derive(Debug, Clone, Copy, Deserialize)]
pub enum ParameterSheet {
    /// This number.
    Given(f64),
    /// The corner of the L-curve.
    LCurve,
    /// The minimum of the function of generalised cross validation.
    GeneralisedCrossValidation,
    /// As much as the noise excuses; needs the noise.
    Discrepancy,
}

/// A band of frequencies.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandSheet {
    /// Lower end, as `"20 Hz"`.
    pub from: Exact<Frequency>,
    /// Upper end, as `"5 kHz"`.
    pub to: Exact<Frequency>,
}

/// A time span.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntervalSheet {
    /// Begin, as `"3.5 ms"`.
    pub from: Exact<Time>,
    /// End, as `"5 ms"`.
    pub to: Exact<Time>,
}

impl RegularisationSheet {
    pub(super) fn in_words(self) -> String {
        match self {
            Self::Tikhonov { penalty, parameter } => {
                format!("Tikhonov on {penalty:?}, parameter by {parameter:?}")
            }
            Self::Truncated { parameter } => format!("truncated, parameter by {parameter:?}"),
        }
    }
}
