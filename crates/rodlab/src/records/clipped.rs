//! Test for records that reach the limit of the recorder.

use labio::Record;
use labio::hits::{Criteria, Reason};

use crate::{InStep, RodlabError};

/// Returns a reason for doubt for each of `channels` that is clipped or has a drop-out. It is used
/// for records that are not judged as hits.
pub(crate) fn clipped(
    record: &Record,
    channels: &[&str],
    field: &str,
) -> Result<Vec<String>, RodlabError> {
    let Some(reference) = channels.first() else {
        return Ok(Vec::new());
    };
    let reasons = Criteria::bar().judge(record, reference, None);
    let reasons = reasons.in_step(field)?;
    let faults = reasons.iter().filter(|reason| is_lost(reason, channels));
    Ok(faults.map(|reason| format!("{field}: {reason}")).collect())
}

/// Returns true for a reason that states that one of `channels` is clipped or has a drop-out.
pub(crate) fn is_lost(reason: &Reason, channels: &[&str]) -> bool {
    match reason {
        Reason::Clipped { channel, .. } | Reason::DropOut { channel, .. } => {
            channels.contains(&channel.as_str())
        }
        _ => false,
    }
}
