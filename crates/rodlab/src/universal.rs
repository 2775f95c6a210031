//! Common parts of the universal files in a result.

use labio::format::Writer;
use labio::format::uff58::{Encoding, Precision, Uff58Writer};
use labio::{AddedDamping, Contents, Ordinate, Series, SeriesAxis};

use crate::outcome::Attachment;
use crate::{InStep, RodlabError};

/// Maximum number of characters written to a header line, four fewer than the 80 of the format.
const LINE: usize = 76;

/// Returns `contents` as the file called `name`. The file is written as text, which all programs
/// read.
pub(crate) fn attachment(contents: &Contents, name: &str) -> Result<Attachment, RodlabError> {
    let mut bytes = Vec::new();
    let writer = Uff58Writer {
        encoding: Encoding::Ascii,
        precision: Precision::Double,
    };
    writer
        .write(contents, &mut bytes)
        .in_step(format!("writing {name}"))?;
    Ok(Attachment {
        name: name.to_owned(),
        bytes,
    })
}

/// Returns an axis with its name in the file.
pub(crate) fn axis(label: &str, unit_text: &str) -> SeriesAxis {
    SeriesAxis {
        label: label.to_owned(),
        unit_text: unit_text.to_owned(),
        unit: None,
    }
}

/// Returns a field of the header, such as `id2`, with its text cut to the length of a line.
pub(crate) fn property(field: &str, text: &str) -> (String, String) {
    let one_line: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(LINE)
        .collect();
    (format!("uff58.{field}"), one_line.trim().to_owned())
}

/// Name of the column with the decay rate of an exponential window.
pub(crate) const DECAY_RATE: &str = "decay rate of the exponential window";

/// Label of the z-axis of a data set for the same decay rate, limited to 20 characters.
const Z_LABEL: &str = "decay of exp. window";

/// Returns the z-axis of a response with an exponential window; empty without a window.
pub(crate) fn damping(window: Option<AddedDamping>) -> Vec<(String, String)> {
    window.map_or_else(Vec::new, |window| {
        vec![
            property("z_value", &format!("{:?}", window.decay_rate())),
            property("z_label", Z_LABEL),
            property("z_unit", "1/s"),
        ]
    })
}

/// Returns the exponential window of a response, from the z-axis of `series` or a column of
/// `contents`.
///
/// # Errors
///
/// [`RodlabError::Step`] for a rate that is not positive; `place` is the place of the file in the
/// sheet.
pub(crate) fn damping_of(
    contents: &Contents,
    series: &Series,
    place: &str,
) -> Result<Option<AddedDamping>, RodlabError> {
    let text = |field: &str| {
        let name = format!("uff58.{field}");
        let mut all = series.properties.iter();
        all.find(|(known, _)| *known == name)
            .map(|(_, text)| text.trim())
    };
    let of_axis = text("z_value").filter(|_| text("z_label") == Some(Z_LABEL));
    let mut columns = contents.series.iter();
    let column = columns.find(|series| series.name.trim().starts_with(DECAY_RATE));
    let rate = match (of_axis, column.map(|column| &column.ordinate)) {
        (Some(text), _) => text.parse().unwrap_or(f64::NAN),
        (None, Some(Ordinate::Real(values))) => values.first().copied().unwrap_or(f64::NAN),
        (None, _) => return Ok(None),
    };
    let window = AddedDamping::new(rate).in_step(format!("{place}, {DECAY_RATE}"))?;
    Ok(Some(window))
}
