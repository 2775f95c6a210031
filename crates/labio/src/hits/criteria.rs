//! What a hit must be to be accepted.

use std::collections::BTreeMap;

use crate::error::check_positive;
use crate::{AddedDamping, LabioError};

/// Limits of the checks, each with a default and the reason for it. `None` leaves a check out.
///
/// What a hit looks like depends on the method: [`Self::hammer`], which is the default, expects one short contact and a motion that comes to
/// rest; [`Self::bar`] expects waves that pass a section several times, with plateaus; [`Self::bar_pulses`] expects such waves of which
/// pulses are cut out, so that the end of the record does not matter.
///
/// | check | default | because |
/// |---|---|---|
/// | peak over noise | 10 | below 20 dB the coherence of a single line falls under 0.99 |
/// | double hit: smaller peak over larger | 0.05 | a second pulse of 5 % ripples the force spectrum by ±5 % |
/// | clipped: equal extreme samples | 3 | two can be chance, and a round peak of three has steps of less than two numbers of the converter beside it |
/// | drop-out: equal samples in a row | 8 | shorter ones the resolution of a slow signal can make |
/// | static offset over peak | 0.25 | more means that the range was spent on something else than the hit |
/// | level shift over peak | 0.02 | integrated once, it would outgrow the hit after 50 times its duration |
/// | remainder at the end over peak | 0.01 | what is cut off spreads over the spectrum at -40 dB of the peak; what passes is stated line by line ([`leakage`](crate::AveragedSpectra::leakage)) |
///
/// A level shift is not asked of velocities and displacements: a free body that is struck goes on moving. Their remainder is what is left
/// of the constant velocity, or of the straight line of the displacement, of the last quarter
/// ([`SpectrumAverager::with_completion`](crate::SpectrumAverager::with_completion)); of bars it is not asked. The remainder is that under the
/// exponential window, if one will be used ([`Self::with_end_weight`], [`Self::with_decay_rate`]).
/// The range of the recorder ([`Self::with_full_scale`]) has no default.
///
/// What [`Self::bar`] judges otherwise than [`Self::hammer`]:
///
/// | check | in the record of a bar | because |
/// |---|---|---|
/// | onset | first passage of 2 % of the largest excursion, not of 10 % | the first passage need not be the largest |
/// | double hit | left out | every passage after the first would be one |
/// | clipped | only an acceleration, or where the noise at rest exceeds the step of the converter | a striker of constant section makes a plateau, and only noise tells it from a limit |
/// | drop-out | only of an acceleration, and not at rest | between two passages, and on a plateau, a gauge stands still |
///
/// [`Self::bar_pulses`] also leaves out level shift and remainder.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "CriteriaSheet"))]
pub struct Criteria {
    pub(super) several_passages: bool,
    pub(super) force_channel: Option<String>,
    pub(super) full_scales: BTreeMap<String, f64>,
    pub(super) peak_over_noise: Option<f64>,
    pub(super) double_hit: Option<f64>,
    pub(super) clipped_run: Option<usize>,
    pub(super) drop_out_run: Option<usize>,
    pub(super) static_offset: Option<f64>,
    pub(super) level_shift: Option<f64>,
    pub(super) remainder: Option<f64>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) window: Option<Decay>,
}

/// An exponential window on hits whose length is not known yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Decay {
    /// By the weight at the end of a hit.
    EndWeight(f64),
    /// By the decay rate \[1/s\].
    Rate(AddedDamping),
}

impl Decay {
    pub(super) fn window(self, duration: f64) -> Result<AddedDamping, LabioError> {
        match self {
            Self::EndWeight(weight) => AddedDamping::to_end_weight(weight, duration),
            Self::Rate(window) => Ok(window),
        }
    }
}

impl Default for Criteria {
    fn default() -> Self {
        Self::hammer()
    }
}

impl Criteria {
    /// Criteria of a hammer hit: one short contact, and a motion that comes to rest within the record.
    #[must_use]
    pub fn hammer() -> Self {
        Self {
            several_passages: false,
            force_channel: None,
            full_scales: BTreeMap::new(),
            peak_over_noise: Some(10.0),
            double_hit: Some(0.05),
            clipped_run: Some(3),
            drop_out_run: Some(8),
            static_offset: Some(0.25),
            level_shift: Some(0.02),
            remainder: Some(0.01),
            window: None,
        }
    }

    /// Criteria of a record of waves in a bar that is transformed as a whole: several passages, plateaus, and rest at the end.
    #[must_use]
    pub fn bar() -> Self {
        Self {
            several_passages: true,
            double_hit: None,
            ..Self::hammer()
        }
    }

    /// Criteria of a record of waves in a bar of which pulses are cut out: as [`Self::bar`], and the bar may still ring at the end.
    #[must_use]
    pub fn bar_pulses() -> Self {
        Self {
            level_shift: None,
            remainder: None,
            ..Self::bar()
        }
    }

    /// Looks for double hits in this channel. By default it is the channel that triggers, if that is a force.
    #[must_use]
    pub fn with_force_channel(self, name: impl Into<String>) -> Self {
        Self {
            force_channel: Some(name.into()),
            ..self
        }
    }

    /// Calls a channel overloaded that reaches 0.99 of `full_scale`, in the SI unit in which it was recorded: the largest
    /// number of an 8-bit converter is 0.992 of its range.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is not positive.
    pub fn with_full_scale(
        mut self,
        channel: impl Into<String>,
        full_scale: f64,
    ) -> Result<Self, LabioError> {
        check_positive("full scale of a channel", full_scale)?;
        self.full_scales.insert(channel.into(), full_scale);
        Ok(self)
    }

    /// Wants the peak of the channel that triggers to be this many standard deviations of its noise.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the limit is not positive, as with all that follow.
    pub fn with_peak_over_noise(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let peak_over_noise = checked("peak over noise", limit)?;
        Ok(Self {
            peak_over_noise,
            ..self
        })
    }

    /// Takes a second contact for a double hit from this fraction of the larger peak on.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_double_hit(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let double_hit = checked("ratio of two contacts", limit)?;
        Ok(Self { double_hit, ..self })
    }

    /// Takes this many equal extreme samples for clipping.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for fewer than two.
    pub fn with_clipped_run(self, limit: Option<usize>) -> Result<Self, LabioError> {
        let clipped_run = counted("a run of clipped samples", limit)?;
        Ok(Self {
            clipped_run,
            ..self
        })
    }

    /// Takes this many equal samples in the middle of a movement for a drop-out.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for fewer than two.
    pub fn with_drop_out_run(self, limit: Option<usize>) -> Result<Self, LabioError> {
        let drop_out_run = counted("a run of lost samples", limit)?;
        Ok(Self {
            drop_out_run,
            ..self
        })
    }

    /// Accepts a rest level of up to this fraction of the peak.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_static_offset(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let static_offset = checked("static offset over peak", limit)?;
        Ok(Self {
            static_offset,
            ..self
        })
    }

    /// Accepts rest levels before and after that differ by up to this fraction of the peak.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_level_shift(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let level_shift = checked("level shift over peak", limit)?;
        Ok(Self {
            level_shift,
            ..self
        })
    }

    /// Accepts an end of up to this fraction of the peak (root mean square).
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_remainder(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let remainder = checked("remainder over peak", limit)?;
        Ok(Self { remainder, ..self })
    }

    /// Judges the remainder under the exponential window that falls to `weight` at the end of a hit.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for a weight that is not between 0 and 1.
    pub fn with_end_weight(self, weight: f64) -> Result<Self, LabioError> {
        AddedDamping::to_end_weight(weight, 1.0)?;
        let window = Some(Decay::EndWeight(weight));
        Ok(Self { window, ..self })
    }

    /// Judges the remainder under this exponential window.
    #[must_use]
    pub fn with_decay_rate(self, window: AddedDamping) -> Self {
        let window = Some(Decay::Rate(window));
        Self { window, ..self }
    }
}

fn checked(quantity: &'static str, limit: Option<f64>) -> Result<Option<f64>, LabioError> {
    limit
        .map(|limit| check_positive(quantity, limit))
        .transpose()
}

fn counted(what: &'static str, limit: Option<usize>) -> Result<Option<usize>, LabioError> {
    match limit {
        Some(found) if found < 2 => Err(LabioError::TooFewSamples {
            what,
            found,
            expected: 2,
        }),
        limit => Ok(limit),
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
struct CriteriaSheet {
    several_passages: bool,
    force_channel: Option<String>,
    full_scales: BTreeMap<String, f64>,
    peak_over_noise: Option<f64>,
    double_hit: Option<f64>,
    clipped_run: Option<usize>,
    drop_out_run: Option<usize>,
    static_offset: Option<f64>,
    level_shift: Option<f64>,
    remainder: Option<f64>,
}

#[cfg(feature = "serde")]
impl Default for CriteriaSheet {
    fn default() -> Self {
        let criteria = Criteria::default();
        Self {
            several_passages: criteria.several_passages,
            force_channel: criteria.force_channel,
            full_scales: criteria.full_scales,
            peak_over_noise: criteria.peak_over_noise,
            double_hit: criteria.double_hit,
            clipped_run: criteria.clipped_run,
            drop_out_run: criteria.drop_out_run,
            static_offset: criteria.static_offset,
            level_shift: criteria.level_shift,
            remainder: criteria.remainder,
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<CriteriaSheet> for Criteria {
    type Error = LabioError;

    fn try_from(sheet: CriteriaSheet) -> Result<Self, LabioError> {
        let mut criteria = Self::default()
            .with_peak_over_noise(sheet.peak_over_noise)?
            .with_double_hit(sheet.double_hit)?
            .with_clipped_run(sheet.clipped_run)?
            .with_drop_out_run(sheet.drop_out_run)?
            .with_static_offset(sheet.static_offset)?
            .with_level_shift(sheet.level_shift)?
            .with_remainder(sheet.remainder)?;
        for (channel, full_scale) in sheet.full_scales {
            criteria = criteria.with_full_scale(channel, full_scale)?;
        }
        Ok(Self {
            several_passages: sheet.several_passages,
            force_channel: sheet.force_channel,
            ..criteria
        })
    }
}
