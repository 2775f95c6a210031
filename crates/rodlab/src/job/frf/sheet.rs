//! Sheet of the job `frf`.

use std::fmt;

use labio::{AddedDamping, Estimator, LabioError, ResponseKind, Window};
use serde::Deserialize;

use crate::job::About;
use crate::outcome::Setting;

use crate::hits::{HitsSheet, Stretch};
use crate::records::Records;
use crate::responses::{ForceWindowSheet, MergeSheet};
use crate::sheet::{BandSheet, Duration, Exact, Frequency, ImpactMass, Ratio, Stated};

/// Sheet of the job `frf`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrfSheet {
    /// Title of the test.
    pub title: String,
    /// Persons, place, date and object of the test, for the report.
    #[serde(default)]
    pub about: About,
    /// The files and their channels.
    pub records: Records,
    /// The selection of the hits that are averaged.
    #[serde(default)]
    pub hits: HitsSheet,
    /// Averaging of long records with a stationary random excitation, over overlapping segments
    /// instead of hits.
    pub segments: Option<SegmentsSheet>,
    /// Input channel, usually the force of the hammer, such as `"hammer"`.
    pub input: String,
    /// Inputs acting together with `input`, such as `["shaker 2"]`, each with a separate response.
    /// They need `segments`.
    #[serde(default)]
    pub further_inputs: Vec<String>,
    /// Output channels; by default all others, such as `["end A"]`.
    pub outputs: Option<Vec<String>>,
    /// Estimator: `H1` (default) for noise on the outputs, `H2` for noise on the input, `Hv` for
    /// equal relative noise on both, `Hs` for noise as measured on the channels in the silence
    /// before an impact.
    pub estimator: Option<Estimator>,
    /// Window on the samples of all channels; by default `Rectangular` for hits, which must decay,
    /// and `Hann` for segments.
    pub window: Option<WindowSheet>,
    /// Window that sets the input to 0 outside the contact of the hammer.
    pub force_window: Option<ForceWindowSheet>,
    /// Exponential window on all channels, for bodies that ring longer than the record.
    pub exponential_window: Option<ExponentialWindowSheet>,
    /// Trend removed from every hit before the windows: `Rest` (default for hits with 16 samples
    /// of rest before the impact), `Nothing`, `Mean` (default for segments) or `Line`.
    pub detrend: Option<DetrendSheet>,
    /// Time before an impact in which the channels are at rest, such as `"20 ms"`. The noise for
    /// `Hs`, and the bias of the other estimators, are determined from this time. By default the
    /// pre-trigger of hits that are cut by a trigger, less the rise time of the impact, or else the
    /// rest found in the records. For segments, the time without excitation at the beginning of
    /// each record, after which the segments begin; by default none.
    pub silent: Option<Exact<Duration>>,
    /// Frequency range of the result; by default all lines above 0 Hz.
    pub band: Option<BandSheet>,
    /// `AsMeasured` (default), or one of the six responses between a force and a motion, such as
    /// `Mobility`.
    pub kind: Option<KindSheet>,
    /// Repetition of the test with a second hammer; its response is merged with the first, line by
    /// line.
    pub second_hammer: Option<SecondHammerSheet>,
    /// Weighed mass of a free body, which replaces the low-frequency lines.
    pub weighed_mass: Option<WeighedMassSheet>,
}

/// Overlapping segments of long records (Welch 1967).
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentsSheet {
    /// Length of a segment, an even number of samples, such as `"1 s"` or `"4096 samples"`: its
    /// inverse is the line spacing.
    pub length: Stretch,
    /// Overlap with the next segment; by default half a segment.
    pub overlap: Option<Exact<Ratio>>,
}

/// Window on the samples of all channels.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum WindowSheet {
    /// Equal to 1 everywhere.
    #[default]
    Rectangular,
    /// Hann, periodic.
    Hann,
    /// Hamming, periodic.
    Hamming,
    /// Blackman-Harris of four terms, periodic.
    BlackmanHarris,
    /// Flat top of five terms, periodic.
    FlatTop,
    /// Flat, with half a Hann window at either end.
    Tukey {
        /// Tapered fraction of the samples, both ends together, such as `"10 %"`.
        taper: Exact<Ratio>,
    },
}

impl FrfSheet {
    /// Returns the window of the sheet, or the default window for hits or segments.
    pub(super) fn window_or_default(&self) -> WindowSheet {
        self.window.clone().unwrap_or(match self.segments {
            None => WindowSheet::Rectangular,
            Some(_) => WindowSheet::Hann,
        })
    }

    /// Returns the defaults of optional fields, except those of records and hits.
    pub(super) fn defaults(&self) -> Vec<Setting> {
        let detrend = match self.segments {
            None => "rest before the impact, if there is any",
            Some(_) => "mean",
        };
        let estimator = format!("{:?}", Estimator::default());
        let window = format!("{:?}", self.window_or_default());
        let mut defaults = vec![
            Setting::by_default("outputs", "all other channels"),
            Setting::by_default("estimator", estimator),
            Setting::by_default("window", window),
            Setting::by_default("force_window", "none"),
            Setting::by_default("exponential_window", "none"),
            Setting::by_default("detrend", detrend),
            Setting::by_default("band", "all lines above 0 Hz"),
            Setting::by_default("kind", "as measured"),
        ];
        if self.segments.is_some() {
            defaults.push(Setting::by_default("segments.overlap", "50 %"));
        }
        if self.second_hammer.is_some() {
            let merge = format!("{:?}", MergeSheet::default());
            defaults.push(Setting::by_default("second_hammer.merge", merge));
        }
        defaults
    }

    pub(super) fn inputs(&self) -> Vec<&str> {
        let further = self.further_inputs.iter().map(String::as_str);
        std::iter::once(self.input.as_str())
            .chain(further)
            .collect()
    }
}

impl WindowSheet {
    pub(super) fn window(&self) -> Window {
        match self {
            Self::Rectangular => Window::Rectangular,
            Self::Hann => Window::HannPeriodic,
            Self::Hamming => Window::HammingPeriodic,
            Self::BlackmanHarris => Window::BlackmanHarrisPeriodic,
            Self::FlatTop => Window::FlatTopPeriodic,
            Self::Tukey { taper } => Window::TukeyPeriodic { taper: taper.si() },
        }
    }
}

/// An exponential window on all channels.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ExponentialWindowSheet {
    /// Defined by its weight on the last sample; the weight on the first sample is 1.
    EndWeight {
        /// The weight, such as `"1 %"`.
        weight: Exact<Ratio>,
    },
    /// Defined by the time in which the weight falls to 1/e.
    TimeConstant {
        /// The time, such as `"40 ms"`.
        time: Exact<Duration>,
    },
}

impl ExponentialWindowSheet {
    /// Returns the window for hits of `duration` \[s\].
    pub(in crate::job) fn over(&self, duration: f64) -> Result<AddedDamping, LabioError> {
        match self {
            Self::EndWeight { weight } => AddedDamping::to_end_weight(weight.si(), duration),
            Self::TimeConstant { time } => AddedDamping::new(1.0 / time.si()),
        }
    }
}

impl fmt::Display for ExponentialWindowSheet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EndWeight { weight } => write!(f, "{weight} on the last sample"),
            Self::TimeConstant { time } => write!(f, "time constant {time}"),
        }
    }
}

/// The trend removed from every hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum DetrendSheet {
    /// The mean of the samples at rest before the impact.
    Rest,
    /// Nothing.
    Nothing,
    /// The mean of the hit; this removes part of the motion too.
    Mean,
    /// The straight line of least squares; this removes part of the motion too.
    Line,
}

/// The requested kind of response.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum KindSheet {
    /// Output over input, as measured.
    #[default]
    AsMeasured,
    /// Displacement over force.
    Receptance,
    /// Velocity over force.
    Mobility,
    /// Acceleration over force.
    Accelerance,
    /// Force over displacement.
    DynamicStiffness,
    /// Force over velocity.
    Impedance,
    /// Force over acceleration.
    DynamicMass,
}

impl KindSheet {
    pub(super) fn kind(self) -> Option<ResponseKind> {
        match self {
            Self::AsMeasured => None,
            Self::Receptance => Some(ResponseKind::Receptance),
            Self::Mobility => Some(ResponseKind::Mobility),
            Self::Accelerance => Some(ResponseKind::Accelerance),
            Self::DynamicStiffness => Some(ResponseKind::DynamicStiffness),
            Self::Impedance => Some(ResponseKind::Impedance),
            Self::DynamicMass => Some(ResponseKind::DynamicMass),
        }
    }
}

/// Repetition of the test with another hammer.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondHammerSheet {
    /// Files of the test; the channels have the same names as in the first test.
    pub records: Records,
    /// The selection of the hits that are averaged.
    #[serde(default)]
    pub hits: HitsSheet,
    /// The method of merging; by default `InverseVariance`.
    pub merge: Option<MergeSheet>,
}

/// The weighed mass of a free body.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeighedMassSheet {
    /// Mass of the body, such as `"1.204 kg ± 1 gram"`.
    pub mass: Stated<ImpactMass>,
    /// Lines below this frequency are replaced, such as `"30 Hz"`.
    pub below: Exact<Frequency>,
    /// Lines from `below` up to this frequency, well below the first resonance, determine the
    /// elastic term, such as `"200 Hz"`.
    pub fitted_to: Exact<Frequency>,
}
