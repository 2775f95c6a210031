//! Names of the kinds of series, for formats that have no field for the kind.

use crate::SeriesKind;

/// Returns the kind of a series in words.
pub(crate) fn kind_name(kind: SeriesKind) -> String {
    let name = match kind {
        SeriesKind::General => "general",
        SeriesKind::TimeResponse => "time response",
        SeriesKind::AutoSpectrum => "auto-spectrum",
        SeriesKind::CrossSpectrum => "cross-spectrum",
        SeriesKind::FrequencyResponse => "frequency response",
        SeriesKind::Transmissibility => "transmissibility",
        SeriesKind::Coherence => "coherence",
        SeriesKind::AutoCorrelation => "auto-correlation",
        SeriesKind::CrossCorrelation => "cross-correlation",
        SeriesKind::PowerSpectralDensity => "power spectral density",
        SeriesKind::EnergySpectralDensity => "energy spectral density",
        SeriesKind::Spectrum => "spectrum",
        SeriesKind::Other(number) => return format!("function type {number}"),
    };
    name.to_owned()
}

/// Returns the kind of a series that has this name.
pub(crate) fn kind_of_name(name: &str) -> Option<SeriesKind> {
    const NAMED: [SeriesKind; 12] = [
        SeriesKind::General,
        SeriesKind::TimeResponse,
        SeriesKind::AutoSpectrum,
        SeriesKind::CrossSpectrum,
        SeriesKind::FrequencyResponse,
        SeriesKind::Transmissibility,
        SeriesKind::Coherence,
        SeriesKind::AutoCorrelation,
        SeriesKind::CrossCorrelation,
        SeriesKind::PowerSpectralDensity,
        SeriesKind::EnergySpectralDensity,
        SeriesKind::Spectrum,
    ];
    match name.strip_prefix("function type ") {
        Some(number) => number.parse().ok().map(SeriesKind::Other),
        None => NAMED.into_iter().find(|kind| kind_name(*kind) == name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_found_by_its_name() {
        for kind in [
            SeriesKind::Coherence,
            SeriesKind::Spectrum,
            SeriesKind::Other(27),
        ] {
            assert_eq!(kind_of_name(&kind_name(kind)), Some(kind));
        }
        assert_eq!(kind_of_name("function type 256"), None);
        assert_eq!(kind_of_name(""), None);
    }
}
