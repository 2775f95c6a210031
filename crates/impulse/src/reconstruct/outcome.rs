//! A reconstructed force and its errors.

use super::{Parameter, Regularisation};
use crate::{ForceError, ForceHistory};

/// The reconstructed force and its errors.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ReconstructedForce {
    /// The force; time 0 is the first sample of the response.
    pub history: ForceHistory,
    /// The regularisation used.
    pub regularisation: Regularisation,
    /// The parameter of the regularisation and its source; `None` without a parameter.
    pub parameter: Option<ChosenParameter>,
    /// The error of the force: the noise of the responses and the variance of the frequency
    /// responses, propagated by the linear method, and the part removed by the regularisation. If
    /// tension is forbidden, it is the error of the same method with tension allowed, which is not
    /// smaller; the peak has an interval of its own ([`ReconstructedForce::peak_interval`]).
    pub error: RandomErrorOfForce,
    /// Impulse over the support, or the period, with tension allowed \[N s\]: a force without
    /// tension may turn noise into impulse. `None` without a support if the line at 0 Hz is
    /// not used: the mean is then undetermined.
    pub impulse: Option<f64>,
    /// Estimate of the part removed by the regularisation \[N\]. If frequency responses have errors
    /// on a support, the force without regularisation is like the calibration blows, and the
    /// estimate is the difference from that force; otherwise it is $`-(1-\varphi)\hat F`$ of the
    /// force found, as a history. The true force is near the force minus this estimate. The
    /// estimate includes only the force that was found: if a line is lost altogether, the estimate
    /// is too small. The error of the force contains the estimate. All zero without regularisation.
    pub regularisation_bias: Vec<f64>,
    /// Unexplained part of the responses, $`\|x - h*F\|/\|x\|`$ over all lines with a known
    /// frequency response.
    pub relative_residual: f64,
    /// Weighted residual per remaining degree of freedom: 1 on average if noise is the only cause.
    /// If it is far above, the noise is underestimated or the frequency response belongs to another
    /// body. `None` if the noise is not known, or no degrees of freedom remain.
    pub reduced_chi_square: Option<f64>,
    /// Root mean square of the force \[N\] for white noise of root mean square 1 on all responses:
    /// the noise amplification of the method.
    pub noise_gain: f64,
    /// Unused lines, in increasing order.
    pub excluded: Vec<ExcludedLine>,
    /// Number of components of the force on its support that the responses do not determine above
    /// rounding; they are set to zero.
    pub silent_components: usize,
    /// Result of the non-negativity constraint; `None` if tension is allowed.
    pub non_negativity: Option<NonNegativity>,
    /// Profile interval of the force at the time of its peak \[N\], if tension is forbidden and the
    /// noise is known or estimated; `None` if the search for one of its ends failed.
    pub peak_interval: Option<ProfileInterval>,
    /// Truncation of the responses in the records; the worst of several sensors.
    pub response_end: ResponseEnd,
}

/// The random error of a reconstructed force, or the reason why there is none.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum RandomErrorOfForce {
    /// Error from the stated noise.
    Stated(ForceError),
    /// Error from white noise, estimated from the unexplained part of the responses.
    Estimated {
        /// The error.
        error: ForceError,
        /// Standard deviation of the noise, in the unit of the responses.
        standard_deviation: f64,
    },
    /// Unknown: the noise is not known and cannot be estimated because the force explains the
    /// response exactly, as in a plain division.
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

/// A regularisation parameter and the curve used for its choice.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ChosenParameter {
    /// $`\lambda`$.
    pub value: f64,
    /// Source of the parameter.
    pub method: Parameter,
    /// Points in increasing order of the parameter; empty for a given parameter.
    pub curve: Vec<CurvePoint>,
    /// Verdict on the choice.
    pub verdict: ChoiceVerdict,
}

/// Result for one regularisation parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CurvePoint {
    /// $`\lambda`$.
    pub parameter: f64,
    /// $`\rho^2`$: the weighted residual, over sensors, lines and both sides.
    pub squared_residual: f64,
    /// $`\eta^2 = \sum\omega^{2p}|F|^2`$ over both sides.
    pub squared_norm: f64,
    /// Degrees of freedom of the force, $`\sum\varphi`$.
    pub degrees_of_freedom: f64,
    /// Number of real data minus the degrees of freedom.
    pub freedom_left: f64,
    /// Score, of which the method seeks the minimum: the function of cross validation, minus the
    /// curvature of the L-curve, or minus the distance of the L-curve from its chord. For the
    /// discrepancy principle, it is the relative discrepancy, of which the method seeks the zero.
    pub score: f64,
}

/// Verdict on the choice of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChoiceVerdict {
    /// Parameter given by the caller.
    Given,
    /// Optimum inside the effective range of parameters.
    Found,
    /// Optimum at the end of the range: the data require no regularisation at all, or the strongest
    /// one.
    AtEnd,
    /// Not reached: the responses do not exceed their noise, every regularisation is consistent,
    /// and the force is nearly zero.
    NotReached,
    /// The score is not finite for any parameter; the weakest regularisation is used.
    NoCorner,
}

/// Result of the non-negativity constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NonNegativity {
    /// End of the search; states whether the conditions of the minimum are met.
    pub end: PivotingEnd,
    /// Number of sets of free samples tried.
    pub steps: usize,
    /// Number of samples of the support held at zero.
    pub n_at_zero: usize,
    /// Largest violation of the conditions of the minimum, relative to the largest element of the
    /// right side: rounding, if converged.
    pub relative_violation: f64,
}

/// End of the search for a force without tension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PivotingEnd {
    /// The conditions of the minimum are met.
    Converged,
    /// The limit of steps was reached; the force is that of the last set, without its tensile
    /// samples.
    StepLimit,
    /// The equations of a set are singular within rounding: regularise. The force is that of the
    /// last solvable set, without its tensile samples; zero if there was none.
    NotPositiveDefinite,
}

/// Reason why a line was not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExclusionReason {
    /// Excluded by the caller, for example because of an unknown frequency response, or because its
    /// noise or variance is not a number.
    LeftOut,
    /// Outside the band.
    OutsideBand,
    /// The frequency response does not exceed its errors, in the mean over the lines that the
    /// support cannot resolve.
    NotResolved,
    /// The frequency response, or its square, is zero: the measured response does not determine the
    /// force there.
    VanishingResponse,
}

/// A line that no sensor used. Without a support the force is zero there.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ExcludedLine {
    /// Index of the line, from 0.
    pub index: usize,
    /// Frequency of the line \[Hz\].
    pub frequency_hz: f64,
    /// The reason.
    pub reason: ExclusionReason,
}

/// Truncation of the response at the end of the record.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ResponseEnd {
    /// Decayed: the last fiftieth of the record is below 1 % of the peak (root mean square,
    /// including an offset).
    DiedOut,
    /// Truncated: the record is a part of the response, and the division treats it as a whole
    /// period.
    CutOff {
        /// Root mean square of the last fiftieth, divided by the peak.
        relative_level: f64,
    },
}

impl ResponseEnd {
    /// Divisor of the record: its last fiftieth is checked.
    const PARTS: usize = 50;
    /// Largest level at the end, relative to the peak, that counts as decayed.
    const DIED_OUT: f64 = 0.01;

    pub(super) fn of(response: &[f64]) -> Self {
        let n = response.len();
        let n_end = n.div_ceil(Self::PARTS);
        let end = response.get(n - n_end..).unwrap_or_default();
        let peak = response.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        if peak == 0.0 {
            return Self::DiedOut;
        }
        // relative to the peak, so that no square overflows or underflows
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

/// Intervals of a number that follows from a force without tension, with the probabilities 0.683,
/// that of one standard error, and 0.95.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ProfileInterval {
    /// Value for the force found.
    pub value: f64,
    /// Lower and upper end at 0.683.
    pub standard: [f64; 2],
    /// Lower and upper end at 0.95.
    pub wide: [f64; 2],
}
