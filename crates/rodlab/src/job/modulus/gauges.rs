//! Spectra of gauges, with the damping that the sheet states or that the ringing of the rod
//! requires.

use labio::{LabioError, Record, SectionSpectra, damping_of_ringing};

use super::method::GaugeSheet;
use crate::job::frf::ExponentialWindowSheet;
use crate::{InStep, RodlabError};

/// Damping added to hits before their transform.
pub(super) enum Damping {
    None,
    /// Exponential window stated in the sheet.
    Window(ExponentialWindowSheet),
    /// Damping that hits require because they end while the rod rings, for lines from the frequency
    /// `lowest_hz` \[Hz\] on.
    OfRinging {
        lowest_hz: f64,
    },
}

pub(super) fn of_hits(
    hits: &[&Record],
    gauges: &[GaugeSheet],
    silent: Option<usize>,
    damping: &Damping,
) -> Result<SectionSpectra, RodlabError> {
    let Some(silent) = silent else {
        return Err(RodlabError::request(
            "source.hits.silent",
            "missing",
            "how long each hit's record is silent before the impact: the weights of the gauges are determined from their noise there",
        ));
    };
    let channels: Vec<&str> = gauges.iter().map(|gauge| gauge.channel.as_str()).collect();
    let added_damping = match damping {
        Damping::None => Ok(None),
        Damping::Window(window) => {
            let cut = hits.first().map_or(0.0, |hit| {
                (hit.n_samples().saturating_sub(silent)) as f64 / hit.sampling_rate_hz()
            });
            window.over(cut).map(Some)
        }
        Damping::OfRinging { lowest_hz } => damping_of_ringing(hits, &channels, silent, *lowest_hz),
    }
    .in_step("source.hits.exponential_window")?;
    SectionSpectra::of_hits(hits, &channels, silent, added_damping).map_err(|error| {
        let of_silence = matches!(error, LabioError::TooFewSamples { .. });
        let step = if of_silence {
            "source.hits.silent"
        } else {
            "the spectra of a hit"
        };
        RodlabError::step(step, error)
    })
}
