//! The trigger, which finds the start of a hit.

use crate::LabioError;
use crate::error::{
    check_finite, check_not_negative, check_positive, non_physical, too_few_samples,
};

/// Direction in which the signal crosses the level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Slope {
    /// Upwards.
    #[default]
    Rising,
    /// Downwards.
    Falling,
    /// Either direction.
    Either,
}

/// A length of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Extent {
    /// Number of samples.
    Samples(usize),
    /// Time \[s\], rounded to the nearest number of samples.
    Seconds(f64),
}

impl Extent {
    /// Returns the number of samples at `sampling_rate_hz`.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for a time that is negative, not finite, or longer than 9e15
    /// samples.
    pub fn samples(self, sampling_rate_hz: f64) -> Result<usize, LabioError> {
        match self {
            Self::Samples(n) => Ok(n),
            Self::Seconds(time) => {
                let samples =
                    (check_not_negative("time of an extent [s]", time)? * sampling_rate_hz).round();
                // limit of a record: 2⁵³ samples
                if samples < 9e15 {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "a whole number from 0 to 9e15"
                    )]
                    Ok(samples as usize)
                } else {
                    non_physical(
                        "time of an extent [s]",
                        time,
                        "a time of fewer than 9e15 samples",
                    )
                }
            }
        }
    }
}

/// A level trigger with slope, hysteresis, pre-trigger and hold-off.
///
/// The trigger fires at the first sample at or beyond the level if, since the last firing, the
/// signal has been on the other side of the level by at least the hysteresis, and the hold-off is
/// over. It does not fire at the first sample of a record, even if this sample is beyond the level.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "TriggerSheet"))]
pub struct Trigger {
    channel: String,
    level: f64,
    length: Extent,
    slope: Slope,
    hysteresis: f64,
    pre_trigger: Extent,
    hold_off: Option<Extent>,
}

impl Trigger {
    /// Creates a trigger that fires when the channel called `channel` rises to `level`, in SI
    /// units, and that cuts out a hit of `length`.
    ///
    /// Defaults, each with its `with_` method: rising slope; a hysteresis of half the level, which
    /// is not reached by noise or by the ringing after a hit; no pre-trigger; a hold-off to the end
    /// of the hit, so that a second contact belongs to the same hit and is found there.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the level is not finite.
    pub fn new(channel: impl Into<String>, level: f64, length: Extent) -> Result<Self, LabioError> {
        check_finite("trigger level", level)?;
        Ok(Self {
            channel: channel.into(),
            level,
            length,
            slope: Slope::Rising,
            hysteresis: level.abs() / 2.0,
            pre_trigger: Extent::Samples(0),
            hold_off: None,
        })
    }

    /// Sets the slope.
    #[must_use]
    pub fn with_slope(self, slope: Slope) -> Self {
        Self { slope, ..self }
    }

    /// Sets the hysteresis, in the unit of the level.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is negative or not finite.
    pub fn with_hysteresis(self, hysteresis: f64) -> Result<Self, LabioError> {
        check_not_negative("trigger hysteresis", hysteresis)?;
        Ok(Self { hysteresis, ..self })
    }

    /// Sets the part of the hit before the sample at which the trigger fires. Rest level and noise
    /// are estimated from this part; the longer it is, the more precise they are.
    #[must_use]
    pub fn with_pre_trigger(mut self, pre_trigger: Extent) -> Self {
        self.pre_trigger = pre_trigger;
        self
    }

    /// Sets the hold-off, during which the trigger does not fire again.
    #[must_use]
    pub fn with_hold_off(mut self, hold_off: Extent) -> Self {
        self.hold_off = Some(hold_off);
        self
    }

    /// Name of the channel that triggers.
    #[must_use]
    pub fn channel(&self) -> &str {
        &self.channel
    }

    /// The level.
    #[must_use]
    pub fn level(&self) -> f64 {
        self.level
    }

    pub(super) fn hysteresis(&self) -> f64 {
        self.hysteresis
    }

    /// Returns the extents of the trigger in samples.
    pub(super) fn at(&self, sampling_rate_hz: f64) -> Result<Timing, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        let length = self.length.samples(sampling_rate_hz)?;
        let before = self.pre_trigger.samples(sampling_rate_hz)?;
        if length < 2 || length <= before {
            return too_few_samples(
                "the hit cut by the trigger",
                length,
                before.saturating_add(1).max(2),
            );
        }
        let hold_off = match self.hold_off {
            None => length - before,
            Some(extent) => extent.samples(sampling_rate_hz)?.max(1),
        };
        Ok(Timing {
            length,
            before,
            hold_off,
        })
    }

    pub(super) fn scanner(&self, timing: Timing) -> Scanner {
        Scanner {
            level: self.level,
            hysteresis: self.hysteresis,
            slope: self.slope,
            side: None,
            hold_off: timing.hold_off,
            ready_at: 0,
        }
    }
}

/// Extents of a trigger in samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timing {
    pub(super) length: usize,
    pub(super) before: usize,
    hold_off: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Below,
    Above,
}

/// The state of a trigger between two samples.
#[derive(Debug)]
pub(super) struct Scanner {
    level: f64,
    hysteresis: f64,
    slope: Slope,
    /// The side of the level on which the signal last was beyond the hysteresis, unless it has
    /// crossed the level since.
    side: Option<Side>,
    hold_off: usize,
    ready_at: usize,
}

impl Scanner {
    /// Returns true if the trigger fires at sample `index`.
    pub(super) fn fires(&mut self, index: usize, sample: f64) -> bool {
        let passed = match self.side {
            Some(Side::Below) if sample >= self.level => self.slope != Slope::Falling,
            Some(Side::Above) if sample <= self.level => self.slope != Slope::Rising,
            _ => {
                self.arm(sample);
                return false;
            }
        };
        self.side = None;
        self.arm(sample);
        let fires = passed && index >= self.ready_at;
        if fires {
            self.ready_at = index.saturating_add(self.hold_off);
        }
        fires
    }

    fn arm(&mut self, sample: f64) {
        // a sample at the level itself is on neither side, even without hysteresis
        if sample < self.level && sample <= self.level - self.hysteresis {
            self.side = Some(Side::Below);
        } else if sample > self.level && sample >= self.level + self.hysteresis {
            self.side = Some(Side::Above);
        }
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TriggerSheet {
    channel: String,
    level: f64,
    length: Extent,
    #[serde(default)]
    slope: Slope,
    hysteresis: Option<f64>,
    pre_trigger: Option<Extent>,
    hold_off: Option<Extent>,
}

#[cfg(feature = "serde")]
impl TryFrom<TriggerSheet> for Trigger {
    type Error = LabioError;

    fn try_from(sheet: TriggerSheet) -> Result<Self, LabioError> {
        let mut trigger = Self::new(sheet.channel, sheet.level, sheet.length)?;
        if let Some(hysteresis) = sheet.hysteresis {
            trigger = trigger.with_hysteresis(hysteresis)?;
        }
        Ok(Self {
            slope: sheet.slope,
            pre_trigger: sheet.pre_trigger.unwrap_or(trigger.pre_trigger),
            hold_off: sheet.hold_off,
            ..trigger
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fired(trigger: &Trigger, samples: &[f64]) -> Vec<usize> {
        let mut scanner = trigger.scanner(trigger.at(1000.0).unwrap());
        let samples = samples.iter().enumerate();
        samples
            .filter(|(index, sample)| scanner.fires(*index, **sample))
            .map(|(index, _)| index)
            .collect()
    }

    fn trigger(slope: Slope, hysteresis: f64) -> Trigger {
        Trigger::new("force", 1.0, Extent::Samples(4))
            .unwrap()
            .with_slope(slope)
            .with_hysteresis(hysteresis)
            .unwrap()
            .with_hold_off(Extent::Samples(1))
    }

    const SWINGS: [f64; 9] = [0.0, 1.0, 2.0, 0.8, 1.2, 0.0, -1.0, 3.0, 0.5];

    #[test]
    fn the_slope_chooses_the_passage() {
        assert_eq!(fired(&trigger(Slope::Rising, 0.0), &SWINGS), [1, 4, 7]);
        assert_eq!(fired(&trigger(Slope::Falling, 0.0), &SWINGS), [3, 5, 8]);
        assert_eq!(
            fired(&trigger(Slope::Either, 0.0), &SWINGS),
            [1, 3, 4, 5, 7, 8]
        );
    }

    #[test]
    fn within_the_hysteresis_nothing_is_a_passage() {
        assert_eq!(fired(&trigger(Slope::Rising, 0.5), &SWINGS), [1, 7]);
        assert_eq!(fired(&trigger(Slope::Either, 0.5), &SWINGS), [1, 3, 7, 8]);
    }

    #[test]
    fn a_record_that_begins_beyond_the_level_does_not_fire() {
        assert_eq!(
            fired(&trigger(Slope::Rising, 0.0), &[5.0, 6.0, 5.0]),
            [0_usize; 0]
        );
        assert_eq!(fired(&trigger(Slope::Rising, 0.0), &[5.0, 0.0, 5.0]), [2]);
    }

    #[test]
    fn a_passage_during_the_hold_off_is_lost_and_not_late() {
        let held = trigger(Slope::Rising, 0.0).with_hold_off(Extent::Seconds(0.004));
        let samples = [0.0, 2.0, 0.0, 2.0, 2.0, 2.0, 2.0, 0.0, 2.0];
        assert_eq!(fired(&held, &samples), [1, 8]);
    }

    #[test]
    fn a_hit_must_be_longer_than_its_pre_trigger() {
        let short = trigger(Slope::Rising, 0.0).with_pre_trigger(Extent::Seconds(0.004));
        assert_eq!(
            short.at(1000.0).unwrap_err().to_string(),
            "the hit cut by the trigger has 4 samples, expected at least 5"
        );
        let endless = short.with_pre_trigger(Extent::Samples(usize::MAX));
        assert!(matches!(
            endless.at(1000.0),
            Err(LabioError::TooFewSamples {
                expected: usize::MAX,
                ..
            })
        ));
        assert!(Extent::Seconds(-1.0).samples(1.0).is_err());
        assert!(Extent::Seconds(1e300).samples(1e10).is_err());
        assert!(Trigger::new("force", f64::NAN, Extent::Samples(4)).is_err());
    }
}
