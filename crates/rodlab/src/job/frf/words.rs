//! Units and names in sentences, tables and file names.

use std::collections::BTreeSet;

use labio::{FrequencyResponse, ResponseKind};

/// Returns the name of a response, such as `mobility` or `strain over force`.
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

/// Returns a distinct part of a file name for each channel: letters and digits in lower case, with
/// an underscore for every other character.
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
    fn two_channels_never_share_a_file() {
        let names = ["end A", "end-a", "Kraft µ"].map(str::to_owned);
        assert_eq!(file_names(&names), ["end_a", "end_a_2", "kraft_µ"]);
    }
}
