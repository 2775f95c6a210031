//! Mobility in a universal file for other programs and for the job `force`.

use labio::{Abscissa, Contents, LineValidity, Ordinate, Series, SeriesKind};

use super::known::Known;
use crate::RodlabError;
use crate::outcome::Attachment;
use crate::responses::{
    AVERAGES, COMMON_ERROR, FREEDOM, MOST_FREEDOM, STANDARD_ERROR, line_spacing_hz,
};
use crate::universal::{self, axis, property};

const NAME: &str = "mobility";

/// Returns the file `mobility.uff` with the complex lines, their standard errors and the coherence.
#[allow(
    clippy::indexing_slicing,
    reason = "`lines` are indices of lines of the mobility, and every list has one element per line"
)]
pub(super) fn attachment(known: &Known, title: &str) -> Result<Attachment, RodlabError> {
    let response = &known.mobility;
    let valid = |line: &usize| response.validity[*line] == LineValidity::Valid;
    let lines: Vec<usize> = (0..response.values.len()).filter(valid).collect();
    let spacing = line_spacing_hz(response)?;
    let first = lines.first().copied().unwrap_or(0);
    let in_a_row = lines.iter().zip(first..).all(|(line, n)| *line == n);
    // lines without information are left out, because few programs read NaN
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
            match (unit, kind) {
                ("", SeriesKind::Coherence) => "coherence",
                ("", _) => "",
                _ => "velocity",
            },
            unit,
        ),
        properties: {
            let mut said = vec![
                property("id2", title),
                property("id3", &format!("{AVERAGES}{}", response.n_averages)),
                property("id4", note),
                property("response_node", "1"),
                property("response_direction", "1"),
                property("reference_node", "1"),
                property("reference_direction", "1"),
            ];
            if !unit.is_empty() {
                said.push(property("denominator_label", "force"));
                said.push(property("denominator_unit", "N"));
                said.extend(universal::damping(response.added_damping));
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
    let mut of_lines = |what: &str, note: &str, value: &dyn Fn(usize) -> f64| {
        contents.series.push(series(
            format!("{NAME}{what}"),
            SeriesKind::General,
            Ordinate::Real(lines.iter().map(|n| value(*n)).collect()),
            "",
            note,
        ));
    };
    if let Some(freedom) = &response.degrees_of_freedom {
        let note = "degrees of freedom of the standard error";
        of_lines(FREEDOM, note, &|n| freedom[n].min(MOST_FREEDOM));
    }
    if let Some(errors) = &response.common_error {
        let note = "relative standard uncertainty that lines share";
        of_lines(COMMON_ERROR, note, &|n| errors[n]);
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
    universal::attachment(&contents, "mobility.uff")
}
