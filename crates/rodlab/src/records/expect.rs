//! What a job wants a channel to be.

use labio::{Quantity, Record};

use crate::RodlabError;

/// The channel called `name` has the quantity `wanted`, or an error that says what it has; `field` names it in the sheet.
///
/// # Errors
///
/// [`RodlabError::Request`].
pub fn expect_quantity(
    record: &Record,
    name: &str,
    wanted: Quantity,
    field: &str,
) -> Result<(), RodlabError> {
    let known = record.channels();
    match known.iter().find(|channel| channel.name() == name) {
        Some(channel) if channel.quantity() == wanted => Ok(()),
        Some(channel) => Err(RodlabError::request(
            field,
            format!("`{name}`, a channel of {}", channel.quantity().name()),
            format!("a channel of {} [{}]", wanted.name(), wanted.unit()),
        )),
        None => {
            let names: Vec<String> = known.iter().map(|c| format!("`{}`", c.name())).collect();
            Err(RodlabError::request(
                field,
                format!("`{name}`"),
                format!("one of the channels {}", names.join(", ")),
            ))
        }
    }
}
