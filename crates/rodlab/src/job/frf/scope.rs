//! Channels and frequencies of the result.

use labio::AveragedSpectra;
use rodfigure::Greyed;

use super::sheet::FrfSheet;
use crate::RodlabError;
use crate::digits::hertz;
use crate::records::Records;
use crate::sheet::plausible::without_kilo;
use crate::sheet::quoted;

/// The frequency range of the result.
#[derive(Debug, Clone, Copy)]
pub(super) struct Band {
    pub(super) from_hz: f64,
    pub(super) to_hz: f64,
}

impl Band {
    pub(super) fn holds(self, frequency_hz: f64) -> bool {
        (self.from_hz..=self.to_hz).contains(&frequency_hz)
    }
}

/// Checks the input and output channels, and returns the output channels.
pub(super) fn outputs_of(
    sheet: &FrfSheet,
    records: &Records,
    place: &str,
) -> Result<Vec<String>, RodlabError> {
    let names: Vec<&str> = records.channels.iter().map(|c| c.name.as_str()).collect();
    let expected = || format!("one of {place}records.channels: {}", quoted(&names));
    let inputs = sheet.inputs();
    for (at, input) in inputs.iter().enumerate() {
        let field = match at.checked_sub(1) {
            None => "input".to_owned(),
            Some(further) => format!("further_inputs[{further}]"),
        };
        let wrong = |expected| Err(RodlabError::request(field, format!("`{input}`"), expected));
        if !names.contains(input) {
            return wrong(expected());
        }
        if inputs.iter().take(at).any(|before| before == input) {
            return wrong("every input once".to_owned());
        }
    }
    let outputs = match &sheet.outputs {
        None => names
            .iter()
            .filter(|name| !inputs.contains(*name))
            .map(|name| (*name).to_owned())
            .collect(),
        Some(outputs) => {
            for (at, output) in outputs.iter().enumerate() {
                let wrong = |expected: String| {
                    RodlabError::request(format!("outputs[{at}]"), format!("`{output}`"), expected)
                };
                if !names.contains(&output.as_str()) {
                    return Err(wrong(expected()));
                }
                if inputs.contains(&output.as_str()) {
                    return Err(wrong("a channel other than the input".to_owned()));
                }
                if outputs.iter().take(at).any(|before| before == output) {
                    return Err(wrong("every output once".to_owned()));
                }
            }
            outputs.clone()
        }
    };
    RodlabError::refuse_empty(
        &outputs,
        "outputs",
        "at least one channel besides the input",
    )?;
    Ok(outputs)
}

/// Returns the band of the sheet, or all lines above 0 Hz.
pub(super) fn band_of(sheet: &FrfSheet, spectra: &AveragedSpectra) -> Result<Band, RodlabError> {
    let frequency = spectra.frequency_hz();
    let (spacing, last) = (
        spectra.line_spacing_hz(),
        frequency.last().copied().unwrap_or(f64::NAN),
    );
    let Some(band) = &sheet.band else {
        return Ok(Band {
            from_hz: spacing,
            to_hz: last,
        });
    };
    let stated = Band {
        from_hz: band.from.si(),
        to_hz: band.to.si(),
    };
    let range = format!(
        "a band of lines between {} and {}",
        hertz(spacing),
        hertz(last)
    );
    if stated.from_hz >= stated.to_hz || stated.to_hz > last * (1.0 + 1e-9) {
        let rate_hz = spacing * spectra.n_samples() as f64;
        let slip = without_kilo(rate_hz, stated.to_hz);
        let slip = slip.map(|slip| format!(", at a sampling rate{slip}"));
        return Err(RodlabError::request(
            "band",
            format!("from {} to {}", band.from, band.to),
            range + &slip.unwrap_or_default(),
        ));
    }
    if !frequency.iter().any(|f| stated.holds(*f)) {
        return Err(RodlabError::request(
            "band",
            format!("from {} to {}, which contains no line", band.from, band.to),
            format!("{range}, {} apart", hertz(spacing)),
        ));
    }
    Ok(stated)
}

/// Returns the ranges outside of a band that is stated in the sheet.
pub(super) fn outside_of(sheet: &FrfSheet, band: Band, spectra: &AveragedSpectra) -> Vec<Greyed> {
    const KHZ: f64 = 1e-3;
    let last = spectra.frequency_hz().last().copied().unwrap_or(f64::NAN);
    if sheet.band.is_none() {
        return Vec::new();
    }
    [
        (spectra.line_spacing_hz(), band.from_hz),
        (band.to_hz, last),
    ]
    .into_iter()
    .filter(|(from, to)| from < to)
    .map(|(from, to)| Greyed {
        from: from * KHZ,
        to: to * KHZ,
        because: "outside the band of the sheet".to_owned(),
    })
    .collect()
}
