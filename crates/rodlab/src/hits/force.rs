//! Tests whether a measured force is cut off, has mains hum, or does not return to zero.

use labio::hits::{find_cut_forces, find_hum, find_undershoot};

use super::found::ranges;
use super::{FoundHits, comparing};
use crate::RodlabError;
use crate::digits::{hertz, significant};

impl FoundHits {
    /// Returns the reasons for doubt about the `force` of accepted hits: it is cut off
    /// ([`find_cut_forces`]), and, unless the sheet states a force window, it has mains hum
    /// ([`find_hum`]) or does not return to zero after the impact ([`find_undershoot`] at
    /// `from_hz`, the lowest frequency of the band, if it is above 0).
    pub(crate) fn doubts_about_force(
        &self,
        force: &str,
        has_force_window: bool,
        from_hz: Option<f64>,
    ) -> Result<Vec<String>, RodlabError> {
        let (numbers, hits) = self.numbered();
        let mut doubts = Vec::new();
        let found = find_cut_forces(&hits, force).map_err(comparing)?;
        let cut = found.iter().filter_map(|cut| numbers.get(cut.hit).copied());
        let cut: Vec<usize> = cut.collect();
        let most = found.iter().map(|cut| cut.part_of_peak).fold(0.0, f64::max);
        if let [_, others @ ..] = cut.as_slice() {
            let (hits, up_to) = match others {
                [] => ("hit", ""),
                _ => ("hits", "up to "),
            };
            doubts.push(format!(
                "the force `{force}` of {hits} {} is cut off at {up_to}{} % of its peak: a force window of the analyser ends before the impact does; record with a longer window, or without one",
                ranges(&cut),
                significant(100.0 * most, 2)
            ));
        }
        if has_force_window {
            return Ok(doubts);
        }
        for hum in find_hum(&hits, force).map_err(comparing)? {
            doubts.push(format!(
                "`{force}` continues at {} after the impact, and {} % of its spectrum there is mains hum: remove the hum, leave out the lines there, or state a force window",
                hertz(hum.frequency_hz),
                significant((100.0 * hum.part).min(100.0), 2)
            ));
        }
        let from_hz = from_hz.filter(|f| *f > 0.0);
        if let Some(error) = find_undershoot(&hits, force, from_hz).map_err(comparing)? {
            doubts.push(format!(
                "`{force}` does not return to zero after the impact, which changes its spectrum by {} % at {} and by less at higher frequencies: its amplifier is AC-coupled, or its sensor drifts; use only the higher frequencies, or state a force window",
                significant(100.0 * error.ratio.norm(), 2),
                hertz(error.frequency_hz)
            ));
        }
        Ok(doubts)
    }
}
