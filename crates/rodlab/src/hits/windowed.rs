//! Test for a window that the analyser has applied to the records.

use labio::Record;
use labio::hits::find_falling_noise;

use super::comparing;
use crate::RodlabError;
use crate::digits::significant;

/// Returns one reason for doubt for each of `channels` whose noise falls between the beginning and
/// the end of `hits` ([`find_falling_noise`]). A sheet cannot state that the analyser has applied a
/// window: the windows in a sheet are those that this program applies.
pub(crate) fn windows_of_analyser(
    hits: &[&Record],
    channels: &[&str],
) -> Result<Vec<String>, RodlabError> {
    let falling = find_falling_noise(hits, channels).map_err(comparing)?;
    let unit_of = |name: &str| {
        let known = hits.first().map(|hit| hit.channels()).unwrap_or_default();
        let channel = known.iter().find(|channel| channel.name() == name);
        let unit = channel.map_or("1", |channel| channel.quantity().unit());
        if unit == "1" {
            String::new()
        } else {
            format!(" {unit}")
        }
    };
    Ok(falling
        .iter()
        .map(|noise| {
            format!(
                "the noise of `{}` falls from {}{unit} to {}{unit} between the beginning and the end of the records, as under an exponential window of \
                 time constant {} ms: the analyser has applied a window, which changes the result, or a filter rings before the impact; record without a window (an `exponential_window` in the sheet would be applied in addition)",
                noise.channel,
                significant(noise.before, 2),
                significant(noise.after, 2),
                significant(1e3 / noise.decay_rate, 2),
                unit = unit_of(&noise.channel),
            )
        })
        .collect())
}
