//! Filter of a recorder as stated in the sheet.

use maxwellid::recorder::RecorderFilter;
use rodwave::band_limited::Recorder;

use crate::job::simulate::AntiAliasSheet;
use crate::{InStep, RodlabError};

/// Returns the filter `of` a recorder that samples at `rate_hz` \[Hz\].
pub(super) fn filter(of: &AntiAliasSheet, rate_hz: f64) -> Result<RecorderFilter, RodlabError> {
    let cutoff_hz = of.cutoff().si();
    let made = match of.analogue() {
        None => RecorderFilter::linear_phase(Recorder { rate_hz, cutoff_hz })
            .map(|filter| filter.named(of.in_words())),
        Some(analogue) => {
            let analogue = analogue.in_step("recorder")?;
            RecorderFilter::new(of.in_words(), cutoff_hz, move |f| analogue.response(f))
        }
    };
    made.in_step("recorder")
}
