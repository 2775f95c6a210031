//! Cutting of records into hits.

use std::fmt;

use labio::Record;
use labio::hits::{Slope, Trigger};
use serde::Deserialize;

use super::{Reading, Stretch};
use crate::RodlabError;

/// The method of cutting records into hits.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::large_enum_variant,
    reason = "a sheet contains only one of these"
)]
pub enum Cut {
    /// Each record contains one hit, as triggered by the recorder.
    EachRecord,
    /// The records are long, and a hit begins where the channel crosses a level.
    Trigger {
        /// The level, in a unit of the channel, such as `"20 N"`.
        level: Reading,
        /// Length of a hit with its pre-trigger, such as `"0.5 s"` or `"4096 samples"`.
        length: Stretch,
        /// Time before the crossing, such as `"10 ms"`. The rest level and the noise are measured
        /// in it, so it needs at least eight samples.
        pre_trigger: Stretch,
        /// Direction of the crossing: `Rising` (default), `Falling` or `Either`.
        slope: Option<Slope>,
        /// Distance by which the signal must return past the level to re-arm the trigger, such as
        /// `"10 N"`; by default half the level.
        hysteresis: Option<Reading>,
        /// Time without a new trigger, such as `"0.5 s"`; by default until the end of the hit, so
        /// that a second contact belongs to the same hit.
        hold_off: Option<Stretch>,
    },
}

impl Cut {
    /// Returns true if hits are cut out of longer records.
    pub(super) fn triggers(&self) -> bool {
        matches!(self, Self::Trigger { .. })
    }

    /// Returns the trigger on `channel` of `record`; `None` if each record is a hit.
    pub(super) fn trigger(
        &self,
        record: &Record,
        channel: &str,
        field: &str,
    ) -> Result<Option<Trigger>, RodlabError> {
        let Self::Trigger {
            level,
            length,
            pre_trigger,
            slope,
            hysteresis,
            hold_off,
        } = self
        else {
            return Ok(None);
        };
        let refused = |error| RodlabError::step(format!("{field}.cut"), error);
        let Some(reference) = record.channels().iter().find(|c| c.name() == channel) else {
            return Err(RodlabError::request(
                format!("{field}.channel"),
                format!("`{channel}`"),
                "a channel of the records",
            ));
        };
        let level = level.of(reference, &format!("{field}.cut.level"))?;
        let mut trigger = Trigger::new(channel, level, length.extent())
            .map_err(refused)?
            .with_pre_trigger(pre_trigger.extent())
            .with_slope(slope.unwrap_or_default());
        if let Some(hysteresis) = hysteresis {
            let hysteresis = hysteresis.of(reference, &format!("{field}.cut.hysteresis"))?;
            trigger = trigger.with_hysteresis(hysteresis).map_err(refused)?;
        }
        if let Some(hold_off) = hold_off {
            trigger = trigger.with_hold_off(hold_off.extent());
        }
        Ok(Some(trigger))
    }
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Trigger {
            level,
            length,
            pre_trigger,
            slope,
            hysteresis,
            hold_off,
        } = self
        else {
            return f.write_str("each record is a hit");
        };
        let slope = match slope.unwrap_or_default() {
            Slope::Rising => "rises to",
            Slope::Falling => "falls to",
            Slope::Either => "passes",
        };
        write!(
            f,
            "{length} from {pre_trigger} before the channel {slope} {level}"
        )?;
        match hysteresis {
            Some(hysteresis) => write!(f, ", hysteresis {hysteresis}")?,
            None => f.write_str(", hysteresis half the level")?,
        }
        match hold_off {
            Some(hold_off) => write!(f, ", hold-off {hold_off}"),
            None => f.write_str(", hold-off to the end of the hit"),
        }
    }
}
