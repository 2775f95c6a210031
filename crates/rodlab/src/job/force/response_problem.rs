//! The data of a force from a response.

use impulse::{CalibrationLines, ResponseNoise, TimeInterval};
use labio::{FrequencyResponse, Quantity as Physical, ResponseKind};

use super::response_sheet::ResponseSheet;

/// The data of a reconstruction.
pub(super) struct Problem<'a> {
    pub(super) sheet: &'a ResponseSheet,
    /// Response over force, on the lines of the record; NaN if unknown.
    pub(super) path: FrequencyResponse,
    /// Samples of the response.
    pub(super) samples: Vec<f64>,
    pub(super) sampling_rate_hz: f64,
    /// Noise of the response, if known.
    pub(super) noise: Noise,
    /// Standard deviation of the response before the force acts, if the rest is long enough.
    pub(super) rest: Option<f64>,
    /// The calibration blows, line by line.
    pub(super) blows: Option<CalibrationLines>,
    /// Time in which the force acts: as stated in the sheet, or as long as the calibration blows
    /// act.
    pub(super) acting: Option<TimeInterval>,
    /// The measured force, if there is one.
    pub(super) measured: Option<Vec<f64>>,
    /// Unit of the response.
    pub(super) unit: &'static str,
}

/// Noise of a response.
pub(super) enum Noise {
    Unknown,
    /// Standard deviation of each sample.
    White(f64),
    /// Variance of every line, from the scatter between calibration hits.
    Lines(Vec<f64>),
}

impl Noise {
    pub(super) fn of_response(&self) -> ResponseNoise<'_> {
        match self {
            Self::Unknown => ResponseNoise::Unknown,
            Self::White(deviation) => ResponseNoise::White(*deviation),
            Self::Lines(lines) => ResponseNoise::Lines(lines),
        }
    }
}

/// The kind of response from a force to a motion of this quantity.
pub(super) fn kind_of(quantity: Physical) -> Option<ResponseKind> {
    ResponseKind::between(Physical::Force, quantity)
}
