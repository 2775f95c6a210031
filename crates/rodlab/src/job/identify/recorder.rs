//! Filter of a recorder as stated in the sheet.

use labio::LabioError;
use labio::instrument::AntiAlias;
use maxwellid::recorder::RecorderFilter;
use rodwave::band_limited::Recorder;

use crate::job::simulate::AntiAliasSheet;
use crate::{InStep, RodlabError};

/// Returns the filter `of` a recorder that samples at `rate_hz` \[Hz\].
pub(super) fn filter(of: &AntiAliasSheet, rate_hz: f64) -> Result<RecorderFilter, RodlabError> {
    let made = match of {
        AntiAliasSheet::LinearPhase { cutoff } => RecorderFilter::linear_phase(Recorder {
            rate_hz,
            cutoff_hz: cutoff.si(),
        })
        .map(|filter| filter.named(of.in_words())),
        AntiAliasSheet::Butterworth { order, cutoff } => {
            let analogue = checked(AntiAlias::butterworth(*order, cutoff.si()))?;
            RecorderFilter::new(of.in_words(), cutoff.si(), move |f| analogue.response(f))
        }
        AntiAliasSheet::Bessel { order, cutoff } => {
            let analogue = checked(AntiAlias::bessel(*order, cutoff.si()))?;
            RecorderFilter::new(of.in_words(), cutoff.si(), move |f| analogue.response(f))
        }
    };
    made.in_step("recorder")
}

fn checked(filter: Result<AntiAlias, LabioError>) -> Result<AntiAlias, RodlabError> {
    filter.in_step("recorder")
}
