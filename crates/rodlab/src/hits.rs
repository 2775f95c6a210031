//! Hits of a sheet: their places in the records, the accepted hits, and the reasons for rejection.
//!
//! ```ron
//! hits: (
//!     cut: Trigger(level: "20 N", pre_trigger: "10 ms", length: "4096 samples"),
//!     criteria: (double_hit: 0.1),
//!     reject: [(hit: 3, because: "the hammer slipped")],
//! ),
//! ```

mod criteria;
mod cut;
mod exchanged;
mod force;
mod found;
mod independent;
mod odd;
mod reading;
mod silence;
mod tail;
mod trend;
mod windowed;

pub use criteria::{CriteriaSheet, HitKind, Limit};
pub use cut::Cut;
pub use found::{FoundHit, FoundHits, OddSheet};
pub(crate) use independent::{expect_independent, expect_noise};
pub use odd::level_at_rest;
pub use reading::{Reading, Stretch};
pub(crate) use silence::{expect_silence, silent_samples, trigger_of};
pub(crate) use windowed::windows_of_analyser;

use labio::hits::{Criteria, HitLog, find_hits};
use labio::{Channel, LabioError, Record};
use serde::Deserialize;

use crate::RodlabError;
use crate::outcome::Setting;
use crate::records::{NamedRecord, channel_called};

fn comparing(error: LabioError) -> RodlabError {
    RodlabError::step("comparing hits", error)
}

/// Relative difference below which two sampling rates count as equal; the spectra use the same
/// value.
const SAMPLING_RATE_TOLERANCE: f64 = 1e-9;

/// Statements of a sheet about hits: how records are cut, the criteria, and the decisions by hand.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HitsSheet {
    /// Channel that marks the beginning of a hit, by its name in the sheet; by default the channel
    /// that the job prescribes, usually the force.
    pub channel: Option<String>,
    /// The cutting of records into hits; by default each record is a hit.
    pub cut: Option<Cut>,
    /// Criteria for accepting a hit.
    #[serde(default)]
    pub criteria: CriteriaSheet,
    /// Hits rejected regardless of the criteria.
    #[serde(default)]
    pub reject: Vec<RulingSheet>,
    /// Hits accepted regardless of the criteria.
    #[serde(default)]
    pub accept: Vec<RulingSheet>,
    /// Treatment of a hit whose response departs from that of the other hits: kept, with the result
    /// in doubt (`InDoubt`, the default), or left out (`LeaveOut`). Frequency responses and
    /// mobilities need at least four hits to identify such a hit.
    #[serde(default)]
    pub odd: OddSheet,
}

/// A decision by hand.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RulingSheet {
    /// Number of the hit as in the log: from 1, counted over all files in their order.
    pub hit: usize,
    /// The reason, in a few words for the report.
    pub because: String,
}

impl HitsSheet {
    /// Returns true if the sheet states anything about hits.
    #[must_use]
    pub(crate) fn is_stated(&self) -> bool {
        let Self {
            channel,
            cut,
            criteria,
            reject,
            accept,
            odd,
        } = self;
        channel.is_some()
            || cut.is_some()
            || *criteria != CriteriaSheet::default()
            || !(reject.is_empty() && accept.is_empty())
            || *odd != OddSheet::default()
    }

    /// Finds and judges the hits in `records`. Their kind is `usual`, unless the sheet states
    /// another. `reference` is the channel that marks the beginning of a hit if the sheet names no
    /// channel; `field` is the place of this part in the sheet.
    ///
    /// All hits, accepted or not, are numbered from 1 in the order of the records. It is not an
    /// error if no hit is accepted; each job handles this case.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] with the field if a channel does not exist, the unit of a level
    /// does not suit the channel, a decision has no reason or names a hit that does not exist, is
    /// incomplete or has a decision already, accepted hits differ in sampling rate, or a hit
    /// shorter than the longest has not come to rest at its end.
    pub fn find_of(
        &self,
        usual: HitKind,
        records: Vec<NamedRecord>,
        reference: &str,
        field: &str,
    ) -> Result<FoundHits, RodlabError> {
        self.find_weighed(usual, Ok, records, reference, field)
    }

    /// Finds and judges the hits of a hammer like [`Self::find_of`].
    ///
    /// # Errors
    ///
    /// The errors of [`Self::find_of`].
    pub fn find(
        &self,
        records: Vec<NamedRecord>,
        reference: &str,
        field: &str,
    ) -> Result<FoundHits, RodlabError> {
        self.find_of(HitKind::Hammer, records, reference, field)
    }

    /// Finds and judges hits like [`Self::find_of`]; `weigh` adapts the criteria to an exponential
    /// window, by which the hits will be weighted.
    pub(crate) fn find_weighed(
        &self,
        usual: HitKind,
        weigh: impl FnOnce(Criteria) -> Result<Criteria, RodlabError>,
        records: Vec<NamedRecord>,
        reference: &str,
        field: &str,
    ) -> Result<FoundHits, RodlabError> {
        let channel = self.channel.as_deref().unwrap_or(reference);
        if let Some(first) = records.first() {
            channel_called(
                first.record.channels(),
                channel,
                &format!("{field}.channel"),
            )?;
        }
        let channels: Vec<Channel> = records
            .first()
            .map(|first| first.record.recorded_channels().to_vec())
            .unwrap_or_default();
        let criteria = self
            .criteria
            .limits(usual, &channels, &format!("{field}.criteria"))?;
        let criteria = weigh(criteria)?;
        let mut settings = vec![
            Setting::by_default(format!("{field}.channel"), channel),
            Setting::by_default(format!("{field}.cut"), Cut::EachRecord),
            Setting::by_default(format!("{field}.odd"), "in doubt"),
        ];
        let limits = CriteriaSheet::defaults(&criteria, usual, &format!("{field}.criteria"))?;
        settings.extend(limits);
        let mut logs = Vec::with_capacity(records.len());
        for NamedRecord { name, record } in records {
            let log = self
                .log_of(record, channel, &criteria, field)
                .map_err(|error| {
                    // only an error of a step gets the file name: a wrong statement in the sheet
                    // does not belong to one file
                    match error {
                        RodlabError::Step { what, source } => RodlabError::Step {
                            what: format!("{what}, {name}"),
                            source,
                        },
                        other => other,
                    }
                })?;
            logs.push((name, log));
        }
        self.rule(&mut logs, field)?;
        let by_trigger = self.cut.as_ref().is_some_and(Cut::triggers);
        let mut found = FoundHits::new(logs, settings, by_trigger, self.odd);
        found.check_alike(field)?;
        found.pad(field)?;
        found.compare_extremes(&criteria)?;
        Ok(found)
    }

    fn log_of(
        &self,
        record: Record,
        channel: &str,
        criteria: &Criteria,
        field: &str,
    ) -> Result<HitLog, RodlabError> {
        let judging = |error| RodlabError::step(format!("{field}, judging hits"), error);
        match self
            .cut
            .as_ref()
            .and_then(|cut| cut.trigger(&record, channel, field).transpose())
        {
            None => HitLog::of_records([record], channel, criteria).map_err(judging),
            Some(trigger) => find_hits(&record, &trigger?, criteria).map_err(judging),
        }
    }

    /// Adds the decisions made by hand to the logs.
    fn rule(&self, logs: &mut [(String, HitLog)], field: &str) -> Result<(), RodlabError> {
        let n_hits: usize = logs.iter().map(|(_, log)| log.hits().len()).sum();
        let lists = [("reject", &self.reject), ("accept", &self.accept)];
        let mut ruled: Vec<(usize, String)> = Vec::new();
        for (list, rulings) in lists {
            for (at, ruling) in rulings.iter().enumerate() {
                let place = format!("{field}.{list}[{at}]");
                if ruling.because.trim().is_empty() {
                    return Err(RodlabError::request(
                        format!("{place}.because"),
                        "empty",
                        "the reason for the decision, in a few words",
                    ));
                }
                if let Some((_, before)) = ruled.iter().find(|(hit, _)| *hit == ruling.hit) {
                    return Err(RodlabError::request(
                        format!("{place}.hit"),
                        format!("{}, already decided by {before}", ruling.hit),
                        "one decision per hit",
                    ));
                }
                let Some((log, number)) = within(logs, ruling.hit) else {
                    return Err(RodlabError::request(
                        format!("{place}.hit"),
                        ruling.hit.to_string(),
                        format!("the number of one of the {n_hits} hits found, from 1"),
                    ));
                };
                let decided = if list == "reject" {
                    log.reject(number, ruling.because.as_str())
                } else {
                    log.accept(number, ruling.because.as_str())
                };
                decided.map_err(|_| {
                    RodlabError::request(
                        format!("{place}.hit"),
                        format!("{}, which is not complete", ruling.hit),
                        "a complete hit",
                    )
                })?;
                ruled.push((ruling.hit, place));
            }
        }
        Ok(())
    }
}

/// Returns the log that contains hit `number`, counted from 1 over all logs, and the number of the
/// hit in that log.
fn within(logs: &mut [(String, HitLog)], number: usize) -> Option<(&mut HitLog, usize)> {
    let mut left = number.checked_sub(1)?;
    for (_, log) in logs {
        if left < log.hits().len() {
            return Some((log, left + 1));
        }
        left -= log.hits().len();
    }
    None
}
