//! A reconstructed force and what it is worth.

use super::profile::ProfileInterval;
use super::{Parameter, Regularisation};
use crate::{ForceError, ForceHistory};

/// The reconstructed force and what it is worth.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ReconstructedForce {
    /// The force; time 0 is the first sample of the response.
    pub history: ForceHistory,
    /// How little-known force was kept out.
    pub regularisation: Regularisation,
    /// The parameter of the regularisation and where it comes from; none without one.
    pub parameter: Option<ChosenParameter>,
    /// The error of the force: the noise of the responses and the variance of the frequency responses through the linear method, and
    /// what the regularisation takes off. Where tension is forbidden it is the error of the same method with tension, which is not smaller; the peak has
    /// its own ([`ReconstructedForce::peak_interval`]).
    pub error: RandomErrorOfForce,
    /// Impulse over the support, or the period, with tension allowed \[N s\]: a force that is not may turn noise into impulse. None without a
    /// support if the line at 0 Hz takes no part: nothing tells the mean.
    pub impulse: Option<f64>,
    /// An estimate of what the regularisation takes off \[N\]: the difference from the force without it, where frequency responses have errors on a
    /// support and that force is therefore like the calibration blows; otherwise $`-(1-\varphi)\hat F`$ of the force found, as a history:
    /// the truth is about the force minus this. It knows only of force that was found: where a line is lost altogether, the loss is
    /// not seen, and the estimate is too small. The error contains it. All zero without regularisation.
    pub regularisation_bias: Vec<f64>,
    /// What the force leaves unexplained of the responses, $`\|x - h*F\|/\|x\|`$ over all lines with a known frequency response.
    pub relative_residual: f64,
    /// Weighted residual per degree of freedom that is left: 1 in the mean if noise is all there is. Far above, the noise is
    /// underrated or the body is not the one of the frequency response. None if the noise is not known, or nothing is left.
    pub reduced_chi_square: Option<f64>,
    /// Root mean square of the force \[N\] for a white noise of root mean square 1 on all responses: how the method amplifies
    /// noise.
    pub noise_gain: f64,
    /// Lines that were not used, in increasing order.
    pub excluded: Vec<ExcludedLine>,
    /// Components of the force on its support of which the responses say nothing above rounding: they were left at zero.
    pub silent_components: usize,
    /// How forbidding tension ended; none if tension is allowed.
    pub non_negativity: Option<NonNegativity>,
    /// Interval by profile of the force at the time of its peak \[N\], where tension is forbidden and the noise is known or estimated; none where a minimum on
    /// the way to its ends was not found.
    pub peak_interval: Option<ProfileInterval>,
    /// Whether the records hold the whole responses; of several sensors the worst.
    pub response_end: ResponseEnd,
}

/// The random error of a reconstructed force, or why there is none.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum RandomErrorOfForce {
    /// From the noise that was stated.
    Stated(ForceError),
    /// From a white noise, estimated from what the force leaves unexplained.
    Estimated {
        /// The error.
        error: ForceError,
        /// Standard deviation of the noise, in the unit of the responses.
        standard_deviation: f64,
    },
    /// The noise is not known, and nothing is left to estimate it from: the force explains the response to the last digit, as a
    /// plain division does.
    NoiseNotKnown,
}

impl RandomErrorOfForce {
    /// The error, if there is one.
    #[must_use]
    pub fn known(&self) -> Option<&ForceError> {
        match self {
            Self::Stated(error) | Self::Estimated { error, .. } => Some(error),
            Self::NoiseNotKnown => None,
        }
    }
}

/// A regularisation parameter and the curve that it was read from.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ChosenParameter {
    /// $`\lambda`$.
    pub value: f64,
    /// Where it comes from.
    pub method: Parameter,
    /// Points in increasing order of the parameter; empty for a given one.
    pub curve: Vec<CurvePoint>,
    /// Whether the method had something to choose.
    pub verdict: ChoiceVerdict,
}

/// What a regularisation parameter would give.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CurvePoint {
    /// $`\lambda`$.
    pub parameter: f64,
    /// $`\rho^2`$: the weighted residual, over sensors, lines and both sides.
    pub squared_residual: f64,
    /// $`\eta^2 = \sum\omega^{2p}|F|^2`$ over both sides.
    pub squared_norm: f64,
    /// $`\sum\varphi`$: how many real numbers the force has left.
    pub degrees_of_freedom: f64,
    /// Number of real data minus the degrees of freedom.
    pub freedom_left: f64,
    /// What the method looks at: the function of cross validation (its minimum), minus the curvature or the distance from
    /// the chord of the L-curve (its minimum), or the relative discrepancy (its zero).
    pub score: f64,
}

/// Whether a choice was one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChoiceVerdict {
    /// The caller chose.
    Given,
    /// Inside the range of parameters that make a difference.
    Found,
    /// At its end: the data ask for no regularisation at all, or for all of it.
    AtEnd,
    /// The responses are no larger than their noise: every regularisation is excused, and the force is nearly nothing.
    NotReached,
    /// The curve has no finite point to choose; the weakest regularisation was taken.
    NoCorner,
}

/// How forbidding tension ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NonNegativity {
    /// Whether the conditions of the minimum are met.
    pub end: PivotingEnd,
    /// Sets of free samples that were tried.
    pub steps: usize,
    /// Samples of the support that are held at zero.
    pub n_at_zero: usize,
    /// Largest violation of the conditions of the minimum, relative to the largest element of the right side: rounding, if
    /// converged.
    pub relative_violation: f64,
}

/// Why the search for a force without tension ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PivotingEnd {
    /// The conditions of the minimum hold.
    Converged,
    /// The limit of steps was reached; the force is that of the last set, without its tensions.
    StepLimit,
    /// The equations of a set are singular within rounding: regularise. The force is that of the last set that could be
    /// solved, without its tensions; zero if there was none.
    NotPositiveDefinite,
}

/// Why a line was not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExclusionReason {
    /// The caller left it out, as one whose frequency response is not known, or its noise or variance is no number.
    LeftOut,
    /// It lies outside the band.
    OutsideBand,
    /// The frequency response is no larger than its errors, by the mean over the lines that the support cannot resolve.
    NotResolved,
    /// The frequency response, or its square, is zero: the measured response says nothing of the force there.
    VanishingResponse,
}

/// A line that was not used by any sensor. Without a support the force has nothing there.
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

impl ResponseEnd {
    /// One part in so many of the record, at its end, tells.
    const PARTS: usize = 50;
    /// Largest level at the end, relative to the peak, that counts as died out.
    const DIED_OUT: f64 = 0.01;

    pub(super) fn of(response: &[f64]) -> Self {
        let n = response.len();
        let n_end = n.div_ceil(Self::PARTS);
        let end = response.get(n - n_end..).unwrap_or_default();
        let peak = response.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        if peak == 0.0 {
            return Self::DiedOut;
        }
        // relative to the peak: no square then leaves the range of numbers
        let mean_square = end.iter().map(|x| (x / peak).powi(2)).sum::<f64>() / n_end as f64;
        let relative_level = mean_square.sqrt();
        if relative_level > Self::DIED_OUT {
            Self::CutOff { relative_level }
        } else {
            Self::DiedOut
        }
    }

    pub(super) fn worse(self, other: Self) -> Self {
        match (self, other) {
            (Self::CutOff { relative_level: a }, Self::CutOff { relative_level: b }) => {
                Self::CutOff {
                    relative_level: a.max(b),
                }
            }
            (Self::DiedOut, other) => other,
            (cut_off, Self::DiedOut) => cut_off,
        }
    }
}
