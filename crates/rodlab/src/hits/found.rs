//! The judged hits of a test.

use labio::Record;
use labio::hits::{Hit, HitLog, Reason, Ruling};
use serde::Deserialize;

use super::SAMPLING_RATE_TOLERANCE;
use crate::outcome::{LogEntry, Setting};
use crate::{Outcome, RodlabError};

/// Treatment of a hit whose response departs from that of the other hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum OddSheet {
    /// Averaged, with the result in doubt.
    #[default]
    InDoubt,
    /// Left out.
    LeaveOut,
}

/// The hits of a test in their order, accepted and rejected.
#[derive(Debug)]
pub struct FoundHits {
    /// One log per record, with the name of the record.
    logs: Vec<(String, HitLog)>,
    /// True if hits were cut out of longer records; they are then distinguished by their times.
    by_trigger: bool,
    pub(super) settings: Vec<Setting>,
    /// Treatment of a hit that departs from the others.
    pub(super) odd: OddSheet,
}

/// One hit of [`FoundHits`].
#[derive(Debug, Clone, Copy)]
pub struct FoundHit<'a> {
    /// Number over all records, from 1.
    pub number: usize,
    /// Name of its record, such as `hits.uff, record 3`.
    pub of: &'a str,
    /// Time and samples of the hit, objections of the checks, and decision by hand.
    pub hit: &'a Hit,
    by_trigger: bool,
}

impl FoundHit<'_> {
    /// Name in the log, such as `hit 3, hits.npy at 1.204 s`.
    #[must_use]
    pub fn name(&self) -> String {
        if self.by_trigger && self.is_found() {
            format!(
                "hit {}, {} at {:.4} s",
                self.number,
                self.of,
                self.hit.time()
            )
        } else {
            format!("hit {}, {}", self.number, self.of)
        }
    }

    /// Returns true for a hit; false if this entry represents a record in which the trigger never
    /// fired.
    #[must_use]
    pub fn is_found(&self) -> bool {
        let silent = |reason: &Reason| matches!(reason, Reason::NotTriggered { .. });
        !self.hit.reasons().iter().any(silent)
    }

    /// Returns true if the hit was cut out of a longer record; its time is then the time of the
    /// trigger.
    pub(crate) fn is_by_trigger(&self) -> bool {
        self.by_trigger
    }

    /// Returns the decision about the hit, with its reasons.
    #[must_use]
    pub fn log_entry(&self) -> LogEntry {
        let mut reasons: Vec<String> = Vec::new();
        match self.hit.ruling() {
            Some(Ruling::Accepted { because }) => {
                reasons.push(format!("accepted by hand: {because}"));
            }
            Some(Ruling::Rejected { because }) => {
                reasons.push(format!("rejected by hand: {because}"));
            }
            None => {}
        }
        reasons.extend(self.hit.reasons().iter().map(ToString::to_string));
        LogEntry {
            what: self.name(),
            accepted: self.hit.is_accepted(),
            reasons,
        }
    }
}

impl FoundHits {
    pub(super) fn new(
        logs: Vec<(String, HitLog)>,
        settings: Vec<Setting>,
        by_trigger: bool,
        odd: OddSheet,
    ) -> Self {
        Self {
            logs,
            by_trigger,
            settings,
            odd,
        }
    }

    /// Returns all hits in their order.
    pub fn hits(&self) -> impl Iterator<Item = FoundHit<'_>> {
        self.logs
            .iter()
            .flat_map(|(name, log)| log.hits().iter().map(move |hit| (name.as_str(), hit)))
            .zip(1..)
            .map(|((of, hit), number)| FoundHit {
                number,
                of,
                hit,
                by_trigger: self.by_trigger,
            })
    }

    /// Returns the records of the accepted hits, which all have the same length and sampling rate.
    #[must_use]
    pub fn accepted(&self) -> Vec<&Record> {
        self.logs
            .iter()
            .flat_map(|(_, log)| log.accepted())
            .collect()
    }

    /// Returns the accepted hits with their numbers.
    pub(super) fn numbered(&self) -> (Vec<usize>, Vec<&Record>) {
        self.hits()
            .filter(|found| found.hit.is_accepted())
            .filter_map(|found| Some((found.number, found.hit.record()?)))
            .unzip()
    }

    /// Enters in `outcome` the hits of a hammer, with the doubts about the channels `input` and
    /// `outputs`. `has_window` is true with a force window, and `from_hz` is the lowest frequency of
    /// the band.
    pub(crate) fn judge(
        &mut self,
        (input, outputs): (&str, &[&str]),
        (has_window, from_hz): (bool, Option<f64>),
        outcome: &mut Outcome,
    ) -> Result<(), RodlabError> {
        outcome.doubt_all(self.compare(input, outputs)?);
        outcome.warnings.extend(self.reversed(input)?);
        outcome.doubt_all(self.doubts_about_force(input, has_window, from_hz)?);
        outcome.settings.extend_from_slice(self.settings());
        outcome.log.extend(self.log());
        Ok(())
    }

    pub(super) fn log_of(&mut self, number: usize) -> Option<(&mut HitLog, usize)> {
        super::within(&mut self.logs, number)
    }

    /// Number of hits found, accepted or not.
    #[must_use]
    pub fn n_found(&self) -> usize {
        self.logs.iter().map(|(_, log)| log.hits().len()).sum()
    }

    /// Number of accepted hits.
    #[must_use]
    pub fn n_accepted(&self) -> usize {
        self.hits().filter(|found| found.hit.is_accepted()).count()
    }

    /// Returns every decision with its reasons, for [`Outcome::log`](crate::Outcome::log).
    #[must_use]
    pub fn log(&self) -> Vec<LogEntry> {
        self.hits().map(|found| found.log_entry()).collect()
    }

    /// Returns the settings, for [`Outcome::settings`](crate::Outcome::settings).
    #[must_use]
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// Returns a sentence with the number of accepted hits and, for each reason, the rejected hits.
    /// A hit with several reasons is listed under each of them.
    #[must_use]
    pub fn in_words(&self) -> String {
        let (n_accepted, n_found) = (self.n_accepted(), self.n_found());
        let rejected = self.rejected();
        if rejected.is_empty() {
            return match n_found {
                1 => "the only hit is accepted".to_owned(),
                2 => "both hits are accepted".to_owned(),
                n => format!("all {n} hits are accepted"),
            };
        }
        let hits = |n: usize| if n == 1 { "hit" } else { "hits" };
        let reasons: Vec<String> = rejected
            .iter()
            .map(|(name, numbers)| {
                let n = numbers.len();
                format!("{name} {n} ({} {})", hits(n), ranges(numbers))
            })
            .collect();
        format!(
            "{n_accepted} of {n_found} {} accepted, rejected: {}",
            hits(n_found),
            reasons.join(", ")
        )
    }

    /// Returns the reasons for rejection in the order of their first occurrence, each with the
    /// numbers of the rejected hits.
    fn rejected(&self) -> Vec<(&'static str, Vec<usize>)> {
        let mut rejected: Vec<(&'static str, Vec<usize>)> = Vec::new();
        for found in self.hits().filter(|found| !found.hit.is_accepted()) {
            let mut names: Vec<&'static str> = match found.hit.ruling() {
                Some(_) => vec!["by hand"],
                None => found.hit.reasons().iter().map(Reason::name).collect(),
            };
            // the same reason may apply to several channels of a hit
            names.sort_unstable();
            names.dedup();
            for name in names {
                match rejected.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, numbers)) => numbers.push(found.number),
                    None => rejected.push((name, vec![found.number])),
                }
            }
        }
        rejected
    }

    /// Extends accepted hits at their rest level to the length of the longest hit, and adds a
    /// setting that states this.
    pub(super) fn pad(&mut self, field: &str) -> Result<(), RodlabError> {
        let (numbers, hits) = self.numbered();
        let lengths: Vec<usize> = hits.iter().map(|hit| hit.n_samples()).collect();
        let longest = lengths.iter().copied().max().unwrap_or(0);
        let mut padded = Vec::new();
        for (number, length) in numbers.into_iter().zip(lengths) {
            if length == longest {
                continue;
            }
            let found = self.hits().find(|found| found.number == number);
            let name = found.map(|found| found.name()).unwrap_or_default();
            if let Some((log, place)) = self.log_of(number) {
                log.pad(place, longest).map_err(|error| {
                    RodlabError::request(
                        format!("{field}: {name}"),
                        format!("{length} samples, and {error}"),
                        format!("{longest} samples, the length of the longest hit, or a hit that ends at rest, so that it can be extended"),
                    )
                })?;
                padded.push(number);
            }
        }
        if !padded.is_empty() {
            self.settings.push(Setting::by_default(
                format!("{field}: hits extended at rest to {longest} samples"),
                ranges(&padded),
            ));
        }
        Ok(())
    }

    /// Refuses accepted hits with different sampling rates.
    pub(super) fn check_alike(&self, field: &str) -> Result<(), RodlabError> {
        let mut accepted = self
            .hits()
            .filter(|found| found.hit.is_accepted())
            .filter_map(|found| Some((found, found.hit.record()?)));
        let Some((first, expected)) = accepted.next() else {
            return Ok(());
        };
        let sampling = |record: &Record| format!("{} Hz", record.sampling_rate_hz());
        let rate = expected.sampling_rate_hz();
        for (found, record) in accepted {
            let apart = (record.sampling_rate_hz() / rate - 1.0).abs();
            if apart > SAMPLING_RATE_TOLERANCE {
                return Err(RodlabError::request(
                    format!("{field}: {}", found.name()),
                    sampling(record),
                    format!("{}, as in {}", sampling(expected), first.name()),
                ));
            }
        }
        Ok(())
    }
}

/// Returns increasing numbers as text, with three or more consecutive numbers as a range:
/// `1, 2, 4-7`.
pub(super) fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let words: Vec<String> = runs
        .map(|run| match run {
            [first, _, .., last] => format!("{first}-{last}"),
            few => {
                let few: Vec<String> = few.iter().map(ToString::to_string).collect();
                few.join(", ")
            }
        })
        .collect();
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::ranges;

    #[test]
    fn numbers_that_follow_each_other_are_a_range() {
        assert_eq!(ranges(&[1, 2, 4, 5, 6, 7, 9]), "1, 2, 4-7, 9");
        assert_eq!(ranges(&[3]), "3");
        assert_eq!(ranges(&[1, 2, 3]), "1-3");
    }
}
