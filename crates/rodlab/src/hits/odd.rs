//! Comparison of hits: shared extreme values, and hits that depart from the others.

use labio::hits::{Criteria, HitSpectra, Reason, find_odd_hits, samples_at_rest};
use labio::{Detrend, LabioError, Record};

use super::{FoundHits, OddSheet, comparing};
use crate::{InStep, RodlabError};

/// Returns the subtraction of the rest level for `hits`, or [`Detrend::None`] if they are not at
/// rest before the impact. `field` is the place of the choice in the sheet.
///
/// # Errors
///
/// [`RodlabError::Step`] for hits with different channels.
pub fn level_at_rest(hits: &[&Record], field: &str) -> Result<Detrend, RodlabError> {
    let channels: Vec<&str> = hits
        .first()
        .map(|hit| hit.channels().iter().map(labio::Channel::name).collect())
        .unwrap_or_default();
    let rest = samples_at_rest(hits, &channels).in_step(field)?;
    Ok(rest.map_or(Detrend::None, |n_samples| Detrend::Rest { n_samples }))
}

impl FoundHits {
    /// Compares each accepted hit with the response of `outputs` to `input` in all other hits.
    /// Depending on the sheet, a hit that departs is left out, or a reason for doubt is returned
    /// for it. A reason for doubt is also returned for each output that appears exchanged with the
    /// input, or whose response changes with the strength of the impact or between the halves of
    /// the hits.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a missing channel.
    pub fn compare(&mut self, input: &str, outputs: &[&str]) -> Result<Vec<String>, RodlabError> {
        let mut doubts = self.exchanged(input, outputs)?;
        let mut spectra = self.spectra(input, outputs)?;
        let odd = find_odd_hits(&spectra);
        let are_left_out = self.odd == OddSheet::LeaveOut && !odd.is_empty();
        doubts.extend(self.treat(odd, input, outputs)?);
        if are_left_out {
            spectra = self.spectra(input, outputs)?;
        }
        doubts.extend(self.trends(&spectra, input));
        Ok(doubts)
    }

    /// Compares each accepted hit like [`Self::compare`], but without the tests for an exchanged
    /// input and for changes over the hits. It is used if `input` and `outputs` are all responses,
    /// of which none causes another. With a single output only the ratio of two channels is
    /// compared, which does not show which channel is faulty: a reason for doubt then names both.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a missing channel.
    pub fn odd(&mut self, input: &str, outputs: &[&str]) -> Result<Vec<String>, RodlabError> {
        let odd = find_odd_hits(&self.spectra(input, outputs)?);
        self.treat(odd, input, outputs)
    }

    fn spectra(&self, input: &str, outputs: &[&str]) -> Result<HitSpectra, RodlabError> {
        let (_, hits) = self.numbered();
        let channels: Vec<&str> = [input].iter().chain(outputs).copied().collect();
        samples_at_rest(&hits, &channels)
            .and_then(|rest| HitSpectra::of(&hits, input, outputs, rest))
            .map_err(comparing)
    }

    /// Leaves out the odd hits, or returns reasons for doubt, depending on the sheet.
    fn treat(
        &mut self,
        odd: Vec<(usize, Reason)>,
        input: &str,
        outputs: &[&str],
    ) -> Result<Vec<String>, RodlabError> {
        let mut doubts = Vec::new();
        let (numbers, _) = self.numbered();
        let odd: Vec<(usize, Reason)> = odd
            .into_iter()
            .filter_map(|(hit, reason)| Some((*numbers.get(hit)?, reason)))
            .collect();
        let whose = match outputs {
            [output] => format!("; the fault may be in `{output}` or in `{input}`"),
            _ => String::new(),
        };
        match self.odd {
            OddSheet::LeaveOut => {
                for (number, reason) in odd {
                    self.object(number, reason).map_err(comparing)?;
                }
            }
            OddSheet::InDoubt => doubts.extend(odd.into_iter().map(|(number, reason)| {
                let found = self.hits().find(|found| found.number == number);
                let name = found.map(|found| found.name()).unwrap_or_default();
                format!(
                    "{name} {reason}{whose}: reject the hit, state `odd = \"leave_out\"` among the hits (in RON `odd: LeaveOut`), or find out why"
                )
            })),
        }
        Ok(doubts)
    }

    /// Rejects hits that share an extreme value, which indicates a limit of the recorder.
    pub(super) fn compare_extremes(&mut self, criteria: &Criteria) -> Result<(), RodlabError> {
        let (numbers, hits) = self.numbered();
        for (hit, reason) in criteria.judge_extremes(&hits).map_err(comparing)? {
            if let Some(number) = numbers.get(hit) {
                self.object(*number, reason).map_err(comparing)?;
            }
        }
        Ok(())
    }

    fn object(&mut self, number: usize, reason: Reason) -> Result<(), LabioError> {
        match self.log_of(number) {
            Some((log, place)) => log.object(place, reason),
            None => Ok(()),
        }
    }
}
