//! Criteria for the acceptance of a hit.

use std::collections::BTreeMap;

use crate::error::{check_positive, too_few_samples};
use crate::{AddedDamping, LabioError};

/// Limits of the checks, each with a default and the reason for it. `None` disables a check.
///
/// The shape of a hit depends on the method: [`Self::hammer`], the default, expects one short
/// contact and a motion that comes to rest; [`Self::bar`] expects waves that pass a section several
/// times, with plateaus; [`Self::bar_pulses`] expects such waves too, but only pulses are cut out
/// of them, so that the end of the record does not matter.
///
/// | check | default | reason |
/// |---|---|---|
/// | peak over noise | 10 | below 20 dB the coherence of a single line falls under 0.99 |
/// | double hit: smaller peak over larger | 0.05 | a second pulse of 5 % ripples the force spectrum by ±5 % |
/// | clipped: equal extreme samples | 3 | two can be chance; next to a round peak of three equal samples, the signal changes by less than two quantisation steps |
/// | drop-out: equal samples in a row | 8 | a slow signal with limited resolution can have shorter runs |
/// | static offset over peak | 0.25 | more means that the offset, not the hit, uses the range |
/// | level shift over peak | 0.02 | integrated once, it would exceed the hit after 50 times the duration of the hit |
/// | remainder at the end over peak | 0.01 | the truncation spreads over the spectrum at -40 dB of the peak; the error of smaller remainders is stated line by line ([`leakage`](crate::AveragedSpectra::leakage)) |
///
/// The level shift of velocities and displacements is not checked: a free body that is struck keeps
/// moving. Their remainder is the residual of the last quarter about a constant velocity or a
/// straight line of displacement
/// ([`SpectrumAverager::with_completion`](crate::SpectrumAverager::with_completion)); it is not
/// checked for bars. The remainder is computed under the exponential window if one will be used
/// ([`Self::with_end_weight`], [`Self::with_decay_rate`]). The range of the recorder
/// ([`Self::with_full_scale`]) has no default.
///
/// Differences of [`Self::bar`] from [`Self::hammer`]:
///
/// | check | for the record of a bar | reason |
/// |---|---|---|
/// | onset | first excursion above 2 % of the largest, not 10 % | the first passage need not be the largest |
/// | double hit | disabled | every passage after the first would count as a double hit |
/// | clipped | checked only for accelerations, or if the noise at rest exceeds the step of the converter | a striker of constant section causes a plateau, and only noise distinguishes a plateau from clipping |
/// | drop-out | checked only for accelerations, and not at rest | between two passages, and on a plateau, a gauge signal is constant |
///
/// [`Self::bar_pulses`] also disables level shift and remainder.
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

/// An exponential window for hits whose length is not known yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Decay {
    /// Stated as the weight at the end of a hit.
    EndWeight(f64),
    /// Stated as the decay rate \[1/s\].
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
    /// Returns the criteria for a hammer hit: one short contact, and a motion that comes to rest
    /// within the record.
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

    /// Returns the criteria for a record of waves in a bar that is transformed as a whole: several
    /// passages, plateaus, and rest at the end.
    #[must_use]
    pub fn bar() -> Self {
        Self {
            several_passages: true,
            double_hit: None,
            ..Self::hammer()
        }
    }

    /// Returns the criteria for a record of waves in a bar from which pulses are cut out: as
    /// [`Self::bar`], but the bar may still ring at the end.
    #[must_use]
    pub fn bar_pulses() -> Self {
        Self {
            level_shift: None,
            remainder: None,
            ..Self::bar()
        }
    }

    /// Sets the channel in which double hits are searched for. The default is the channel that
    /// triggers, if it is a force.
    #[must_use]
    pub fn with_force_channel(mut self, name: impl Into<String>) -> Self {
        self.force_channel = Some(name.into());
        self
    }

    /// Sets the range of a channel, in the SI unit in which it was recorded. A channel is
    /// overloaded if it reaches 0.99 of `full_scale`: the largest number of an 8-bit converter
    /// is 0.992 of its range.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the range is not positive.
    pub fn with_full_scale(
        mut self,
        channel: impl Into<String>,
        full_scale: f64,
    ) -> Result<Self, LabioError> {
        check_positive("full scale of a channel", full_scale)?;
        self.full_scales.insert(channel.into(), full_scale);
        Ok(self)
    }

    /// Sets the smallest accepted peak of the channel that triggers, in standard deviations of its
    /// noise.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the limit is not positive.
    pub fn with_peak_over_noise(mut self, limit: Option<f64>) -> Result<Self, LabioError> {
        self.peak_over_noise = checked("peak over noise", limit)?;
        Ok(self)
    }

    /// Sets the fraction of the larger peak above which a second contact counts as a double hit.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_double_hit(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let double_hit = checked("ratio of two contacts", limit)?;
        Ok(Self { double_hit, ..self })
    }

    /// Sets the number of equal extreme samples that count as clipping.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for fewer than two.
    pub fn with_clipped_run(mut self, limit: Option<usize>) -> Result<Self, LabioError> {
        self.clipped_run = counted("a run of clipped samples", limit)?;
        Ok(self)
    }

    /// Sets the number of equal samples within a movement that count as a drop-out.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for fewer than two.
    pub fn with_drop_out_run(mut self, limit: Option<usize>) -> Result<Self, LabioError> {
        self.drop_out_run = counted("a run of lost samples", limit)?;
        Ok(self)
    }

    /// Sets the largest accepted rest level, as a fraction of the peak.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_static_offset(mut self, limit: Option<f64>) -> Result<Self, LabioError> {
        self.static_offset = checked("static offset over peak", limit)?;
        Ok(self)
    }

    /// Sets the largest accepted difference between the rest levels before and after the hit, as a
    /// fraction of the peak.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_level_shift(mut self, limit: Option<f64>) -> Result<Self, LabioError> {
        self.level_shift = checked("level shift over peak", limit)?;
        Ok(self)
    }

    /// Sets the largest accepted remainder at the end (root mean square), as a fraction of the
    /// peak.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`].
    pub fn with_remainder(self, limit: Option<f64>) -> Result<Self, LabioError> {
        let remainder = checked("remainder over peak", limit)?;
        Ok(Self { remainder, ..self })
    }

    /// Sets the exponential window for the remainder, stated as its `weight` at the end of a hit.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for a weight that is not between 0 and 1.
    pub fn with_end_weight(self, weight: f64) -> Result<Self, LabioError> {
        AddedDamping::to_end_weight(weight, 1.0)?;
        let window = Some(Decay::EndWeight(weight));
        Ok(Self { window, ..self })
    }

    /// Sets the exponential window for the remainder.
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
        Some(found) if found < 2 => too_few_samples(what, found, 2),
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
