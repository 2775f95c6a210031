//! Shortening of hits to the part in which the channels move.

use labio::hits::samples_of_motion;

use super::FoundHits;
use crate::outcome::Setting;
use crate::{InStep, RodlabError};

impl FoundHits {
    /// Shortens the accepted hits to the samples in which `channels` move
    /// ([`samples_of_motion`]), and adds a setting that states this. `field` is the place of the
    /// choice in the sheet.
    pub(crate) fn leave_out_tail(
        &mut self,
        channels: &[&str],
        field: &str,
    ) -> Result<(), RodlabError> {
        let (numbers, hits) = self.numbered();
        let Some(n_samples) = samples_of_motion(&hits, channels).in_step(field)? else {
            return Ok(());
        };
        let milliseconds = hits
            .first()
            .map_or(0.0, |hit| 1e3 * n_samples as f64 / hit.sampling_rate_hz());
        let longest = hits.iter().map(|hit| hit.n_samples()).max().unwrap_or(0);
        for number in numbers {
            if let Some((log, place)) = self.log_of(number) {
                log.shorten(place, n_samples).in_step(field)?;
            }
        }
        self.settings.push(Setting::by_default(
            field,
            format!(
                "left out: {n_samples} of {longest} samples of each hit are used, {milliseconds:.4} ms; the remaining samples contain only noise"
            ),
        ));
        Ok(())
    }
}
