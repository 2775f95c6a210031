//! The mobility as a universal file, for other programs and for the job `force`.

use labio::format::Writer;
use labio::format::uff58::{Encoding, Precision, Uff58Writer};
use labio::{Abscissa, Contents, LineValidity, Ordinate, Series, SeriesAxis, SeriesKind};

use super::known::Known;
use crate::RodlabError;
use crate::outcome::Attachment;
use crate::responses::{STANDARD_ERROR, line_spacing_hz};

const NAME: &str = "mobility";

/// `mobility.uff`: the complex lines, their standard errors and the coherence.
pub(super) fn attachment(known: &Known, title: &str) -> Result<Attachment, RodlabError> {
    let response = &known.mobility;
    let valid = |line: &usize| response.validity[*line] == LineValidity::Valid;
    let lines: Vec<usize> = (0..response.values.len()).filter(valid).collect();
    let spacing = line_spacing_hz(response);
    let first = lines.first().copied().unwrap_or(0);
    let in_a_row = lines.iter().zip(first..).all(|(line, n)| *line == n);
    // few programs read what is no number: lines without information are left out
    let abscissa = if in_a_row {
        Abscissa::Even {
            start: first as f64 * spacing,
            step: spacing,
        }
    } else {
        Abscissa::Uneven(lines.iter().map(|n| response.frequency_hz[*n]).collect())
    };
    let series = |name: String, kind, ordinate, unit: &str, note: &str| Series {
        name,
        kind,
        abscissa: abscissa.clone(),
        ordinate,
        abscissa_axis: axis("Frequency", "Hz"),
        ordinate_axis: axis(
            if unit.is_empty() {
                "coherence"
            } else {
                "velocity"
            },
            unit,
        ),
        properties: {
            let mut said = vec![
                ("uff58.id2".to_owned(), header_line(title)),
                ("uff58.id4".to_owned(), header_line(note)),
                ("uff58.response_node".to_owned(), "1".to_owned()),
                ("uff58.response_direction".to_owned(), "1".to_owned()),
                ("uff58.reference_node".to_owned(), "1".to_owned()),
                ("uff58.reference_direction".to_owned(), "1".to_owned()),
            ];
            if !unit.is_empty() {
                said.push(("uff58.denominator_label".to_owned(), "force".to_owned()));
                said.push(("uff58.denominator_unit".to_owned(), "N".to_owned()));
            }
            said
        },
    };
    let damped = response.added_damping.map_or_else(String::new, |window| {
        format!(", exponential window {:.4} 1/s", window.decay_rate())
    });
    let mut contents = Contents::of_format("rodlab");
    contents.series.push(series(
        NAME.to_owned(),
        SeriesKind::FrequencyResponse,
        Ordinate::Complex(lines.iter().map(|n| response.values[*n]).collect()),
        "m/s",
        &format!("mobility of the face{damped}"),
    ));
    if let Some(variance) = &response.variance {
        contents.series.push(series(
            format!("{NAME}{STANDARD_ERROR}"),
            SeriesKind::General,
            Ordinate::Real(lines.iter().map(|n| variance[*n].sqrt()).collect()),
            "m/s",
            "root of the variance of the complex line",
        ));
    }
    let coherences = known
        .coherences
        .iter()
        .zip(["coherence", "coherence, second test"]);
    for (values, name) in coherences {
        let values: Vec<f64> = lines.iter().map(|n| values[*n]).collect();
        if values.iter().all(|value| value.is_finite()) {
            contents.series.push(series(
                name.to_owned(),
                SeriesKind::Coherence,
                Ordinate::Real(values),
                "",
                "ordinary coherence",
            ));
        }
    }
    let mut bytes = Vec::new();
    let writer = Uff58Writer {
        encoding: Encoding::Ascii,
        precision: Precision::Double,
    };
    writer
        .write(&contents, &mut bytes)
        .map_err(|error| RodlabError::step("writing mobility.uff", error))?;
    Ok(Attachment {
        name: "mobility.uff".to_owned(),
        bytes,
    })
}

fn axis(label: &str, unit_text: &str) -> SeriesAxis {
    SeriesAxis {
        label: label.to_owned(),
        unit_text: unit_text.to_owned(),
        unit: None,
    }
}

/// As much of a text as one line of the header holds.
fn header_line(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(76)
        .collect();
    text.trim().to_owned()
}
