//! Requirements that a job has on channels and files.

use labio::{Channel, Quantity, Record};

use crate::RodlabError;
use crate::outcome::InputFile;
use crate::sheet::quoted;

/// Returns the channel `name`; `field` is the place of the name in the sheet.
///
/// # Errors
///
/// [`RodlabError::Request`] with the known channels if there is no such channel.
pub(crate) fn channel_called<'a>(
    channels: &'a [Channel],
    name: &str,
    field: &str,
) -> Result<&'a Channel, RodlabError> {
    let found = channels.iter().find(|channel| channel.name() == name);
    found.ok_or_else(|| {
        let names = quoted(channels.iter().map(Channel::name));
        let expected = format!("one of the channels {names}");
        RodlabError::request(field, format!("`{name}`"), expected)
    })
}

/// Checks that the channel `name` has the quantity `wanted`. `field` is the place of the name in
/// the sheet.
///
/// # Errors
///
/// [`RodlabError::Request`] with the actual quantity, or with the known channels if there is no
/// such channel.
pub fn expect_quantity(
    record: &Record,
    name: &str,
    wanted: Quantity,
    field: &str,
) -> Result<(), RodlabError> {
    let found = channel_called(record.channels(), name, field)?.quantity();
    if found == wanted {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("`{name}`, a channel of {}", found.name()),
        format!("a channel of {} [{}]", wanted.name(), wanted.unit()),
    ))
}

/// Checks that the channel `name` is an acceleration, a velocity or a displacement. `field` is the
/// place of the name in the sheet.
///
/// # Errors
///
/// The errors of [`expect_quantity`].
pub(crate) fn expect_motion(record: &Record, name: &str, field: &str) -> Result<(), RodlabError> {
    match channel_called(record.channels(), name, field)?.quantity() {
        Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement => Ok(()),
        other => Err(RodlabError::request(
            field,
            format!("`{name}`, a channel of {}", other.name()),
            "a channel of acceleration, velocity or displacement",
        )),
    }
}

/// Refuses two files with the same content under different names, because one measurement must not
/// count twice.
///
/// # Errors
///
/// [`RodlabError::OneMeasurement`] with both files.
pub fn expect_different_files(inputs: &[InputFile]) -> Result<(), RodlabError> {
    let mut by_content: Vec<&InputFile> = inputs.iter().collect();
    // the sorting is stable: of equal files, the file that was read first comes first
    by_content.sort_by(|a, b| a.sha256.cmp(&b.sha256));
    let twice = by_content.windows(2).find_map(|pair| match pair {
        [a, b] if a.sha256 == b.sha256 && a.path != b.path => Some((a, b)),
        _ => None,
    });
    match twice {
        None => Ok(()),
        Some((first, second)) => Err(RodlabError::OneMeasurement {
            first: first.path.clone(),
            second: second.path.clone(),
            how: "have the same content",
        }),
    }
}
