//! Test for a force that a window of the analyser cuts off before the blow ends.

use labio::hits::find_cut_forces;

use super::found::ranges;
use super::{FoundHits, comparing};
use crate::RodlabError;
use crate::digits::significant;

impl FoundHits {
    /// Returns a reason for doubt if the `force` of accepted hits is cut off ([`find_cut_forces`]).
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a missing channel.
    pub fn cut_force(&self, force: &str) -> Result<Option<String>, RodlabError> {
        let (numbers, hits) = self.numbered();
        let found = find_cut_forces(&hits, force).map_err(comparing)?;
        let numbers = found.iter().filter_map(|cut| numbers.get(cut.hit).copied());
        let cut: Vec<usize> = numbers.collect();
        let most = found.iter().map(|cut| cut.part_of_peak).fold(0.0, f64::max);
        let (hits, up_to) = match cut.as_slice() {
            [] => return Ok(None),
            [_] => ("hit", ""),
            _ => ("hits", "up to "),
        };
        Ok(Some(format!(
            "the force `{force}` of {hits} {} is cut off at {up_to}{} % of its peak: a force window of the analyser ends before the blow does; record with a longer window, or without one",
            ranges(&cut),
            significant(100.0 * most, 2)
        )))
    }
}
