//! Numbers of the kinds of series in universal files, and names for formats without a field for the
//! kind.

use crate::SeriesKind;

/// The kinds with a name.
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

/// Returns the function type of a kind in universal files, and its name, empty if it has none.
fn number_and_name(kind: SeriesKind) -> (u8, &'static str) {
    match kind {
        SeriesKind::General => (0, "general"),
        SeriesKind::TimeResponse => (1, "time response"),
        SeriesKind::AutoSpectrum => (2, "auto-spectrum"),
        SeriesKind::CrossSpectrum => (3, "cross-spectrum"),
        SeriesKind::FrequencyResponse => (4, "frequency response"),
        SeriesKind::Transmissibility => (5, "transmissibility"),
        SeriesKind::Coherence => (6, "coherence"),
        SeriesKind::AutoCorrelation => (7, "auto-correlation"),
        SeriesKind::CrossCorrelation => (8, "cross-correlation"),
        SeriesKind::PowerSpectralDensity => (9, "power spectral density"),
        SeriesKind::EnergySpectralDensity => (10, "energy spectral density"),
        SeriesKind::Spectrum => (12, "spectrum"),
        SeriesKind::Other(number) => (number, ""),
    }
}

/// Returns the function type of a kind in universal files.
pub(crate) fn function_type(kind: SeriesKind) -> u8 {
    number_and_name(kind).0
}

/// Returns the kind with this function type in universal files.
pub(crate) fn kind_of_number(function_type: u8) -> SeriesKind {
    let named = NAMED
        .into_iter()
        .find(|&kind| number_and_name(kind).0 == function_type);
    named.unwrap_or(SeriesKind::Other(function_type))
}

/// Returns the kind of a series in words.
pub(crate) fn kind_name(kind: SeriesKind) -> String {
    match number_and_name(kind) {
        (number, "") => format!("function type {number}"),
        (_, name) => name.to_owned(),
    }
}

/// Returns the kind of a series that has this name.
pub(crate) fn kind_of_name(name: &str) -> Option<SeriesKind> {
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
