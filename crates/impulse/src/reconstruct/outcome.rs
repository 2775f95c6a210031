//! A reconstructed force and what it is worth.

use super::Regularisation;
use crate::ForceHistory;

/// The reconstructed force and what it is worth.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ReconstructedForce {
    /// The force; time 0 is the first sample of the response.
    pub history: ForceHistory,
    /// How the lines were divided.
    pub regularisation: Regularisation,
    /// What the force leaves unexplained of the response, $`\|x - h*F\|/\|x\|`$ over all lines with a known frequency response.
    pub relative_residual: f64,
    /// Root mean square of the force \[N\] for a white noise of root mean square 1 on the response: how the method amplifies
    /// noise, before the support.
    pub noise_gain: f64,
    /// Lines that were not used, in increasing order.
    pub excluded: Vec<ExcludedLine>,
    /// Constant \[N\] that was added so that the mean outside the support is zero; 0 unless the line at 0 Hz was excluded and a support
    /// was given.
    pub added_constant: f64,
    /// Root mean square of the force \[N\] outside the support, where it was then set to zero: a measure of error, since it should
    /// be nothing. None without a support.
    pub outside_support: Option<f64>,
    /// Whether the record holds the whole response.
    pub response_end: ResponseEnd,
}

/// Why a line was not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExclusionReason {
    /// The caller left it out, as one whose frequency response is not known.
    LeftOut,
    /// It lies outside the band.
    OutsideBand,
    /// The frequency response is zero: the measured response says nothing of the force there.
    VanishingResponse,
}

/// A line that was not used, so that the force has nothing there.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ExcludedLine {
    /// Index of the line, from 0.
    pub index: usize,
    /// Its frequency \[Hz\].
    pub frequency_hz: f64,
    /// Why.
    pub reason: ExclusionReason,
}

/// Whether the response had died out when the record ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ResponseEnd {
    /// The last fiftieth of the record is below 1 % of the peak (root mean square, an offset included).
    DiedOut,
    /// It is not: the record is a piece of the response, and the division takes it for a whole period.
    CutOff {
        /// Root mean square of the last fiftieth over the peak.
        relative_level: f64,
    },
}
