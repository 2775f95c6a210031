//! Numbers, units and names in sentences, tables and file names.

use std::collections::BTreeSet;

use labio::{FrequencyResponse, LineValidity, ResponseKind};

/// A number with four significant digits and no zeros behind them.
pub(super) fn short(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() || (magnitude > 0.0 && !(1e-3..1e5).contains(&magnitude)) {
        return format!("{value:.3e}");
    }
    let decimals = [(1.0, 4), (10.0, 3), (100.0, 2), (1000.0, 1)]
        .iter()
        .find(|(limit, _)| magnitude < *limit)
        .map_or(0, |(_, decimals)| *decimals);
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A frequency, in Hz or kHz.
pub(super) fn hertz(frequency_hz: f64) -> String {
    if frequency_hz < 1000.0 {
        format!("{} Hz", short(frequency_hz))
    } else {
        format!("{} kHz", short(frequency_hz / 1000.0))
    }
}

/// What a response is, as `mobility` or `strain over force`.
pub(super) fn name_of(response: &FrequencyResponse) -> String {
    match response.kind() {
        Ok(kind) => kind.to_string(),
        Err(_) => format!(
            "{} over {}",
            response.output.quantity().name(),
            response.input.quantity().name()
        ),
    }
}

/// Its unit.
pub(super) fn unit_of(response: &FrequencyResponse) -> String {
    let (output, input) = (response.output.quantity(), response.input.quantity());
    match response.kind() {
        Ok(ResponseKind::Receptance) => "m/N".to_owned(),
        Ok(ResponseKind::Mobility) => "m/(N s)".to_owned(),
        Ok(ResponseKind::Accelerance) => "m/(N s^2)".to_owned(),
        Ok(ResponseKind::DynamicStiffness) => "N/m".to_owned(),
        Ok(ResponseKind::Impedance) => "N s/m".to_owned(),
        Ok(ResponseKind::DynamicMass) => "kg".to_owned(),
        Err(_) if output == input => String::new(),
        Err(_) => format!("{}/({})", output.unit(), input.unit()),
    }
}

/// Why a line carries no information.
pub(super) fn validity_in_words(validity: LineValidity) -> &'static str {
    match validity {
        LineValidity::Valid => "valid",
        LineValidity::NoInput => "no input",
        LineValidity::NoOutput => "no output",
        LineValidity::NoCorrelation => "no correlation",
        LineValidity::NotDefined => "not defined",
        LineValidity::DependentInputs => "dependent inputs",
        _ => "not valid",
    }
}

/// With a capital letter at its beginning.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|first| first.to_uppercase().chain(letters).collect())
        .unwrap_or_default()
}

/// Parts of file names for channels, each another: letters and digits in lower case, everything else an underscore.
pub(super) fn file_names(channels: &[String]) -> Vec<String> {
    let mut taken = BTreeSet::new();
    channels
        .iter()
        .map(|channel| {
            let plain: String = channel
                .chars()
                .map(|c| {
                    if c.is_alphanumeric() {
                        c.to_ascii_lowercase()
                    } else {
                        '_'
                    }
                })
                .collect();
            let mut name = plain.clone();
            let mut number = 2;
            while !taken.insert(name.clone()) {
                name = format!("{plain}_{number}");
                number += 1;
            }
            name
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, 0.012345, 1.0, 12.3456, 999.96, 51200.0, 1e-7, f64::NAN];
        let texts = numbers.map(short).join(" ");
        assert_eq!(texts, "0 0.0123 1 12.35 1000 51200 1.000e-7 NaN");
        assert_eq!(hertz(51_200.0), "51.2 kHz");
    }

    #[test]
    fn two_channels_never_share_a_file() {
        let names = ["end A", "end-a", "Kraft µ"].map(str::to_owned);
        assert_eq!(file_names(&names), ["end_a", "end_a_2", "kraft_µ"]);
    }
}
