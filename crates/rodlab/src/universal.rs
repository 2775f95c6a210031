//! What every universal file of a result has in common.

use labio::format::Writer;
use labio::format::uff58::{Encoding, Precision, Uff58Writer};
use labio::{Contents, SeriesAxis};

use crate::RodlabError;
use crate::outcome::Attachment;

/// Characters that a line of the header holds, with some to spare.
const LINE: usize = 76;

/// `contents` as the file called `name`: as text, which every program reads.
pub(crate) fn attachment(contents: &Contents, name: &str) -> Result<Attachment, RodlabError> {
    let mut bytes = Vec::new();
    let writer = Uff58Writer {
        encoding: Encoding::Ascii,
        precision: Precision::Double,
    };
    writer
        .write(contents, &mut bytes)
        .map_err(|error| RodlabError::step(format!("writing {name}"), error))?;
    Ok(Attachment {
        name: name.to_owned(),
        bytes,
    })
}

/// An axis as it is called in the file.
pub(crate) fn axis(label: &str, unit_text: &str) -> SeriesAxis {
    SeriesAxis {
        label: label.to_owned(),
        unit_text: unit_text.to_owned(),
        unit: None,
    }
}

/// A field of the header, as `id2`, and as much of a text as it holds.
pub(crate) fn property(field: &str, text: &str) -> (String, String) {
    let one_line: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(LINE)
        .collect();
    (format!("uff58.{field}"), one_line.trim().to_owned())
}
