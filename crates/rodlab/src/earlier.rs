//! Standing of the earlier result to which an input file belongs.

use std::path::Path;

use labio::ContentHash;
use serde::Deserialize;

use crate::input;
use crate::outcome::Verdict;
use crate::output::{OutputFile, RESULT};

/// Outputs and verdict of a `result.json`.
#[derive(Debug, Deserialize)]
struct Written {
    outputs: Vec<OutputFile>,
    verdict: Verdict,
}

/// Returns the first reason for doubt about the earlier result to which the file at `path` with
/// these `bytes` belongs; `None` if the verdict on the result is `answered`, or if no `result.json`
/// in the folder of the file lists the file with the hash of these bytes.
pub(crate) fn doubt(path: &Path, bytes: &[u8]) -> Option<String> {
    let result = input::read(&path.with_file_name(RESULT)).ok()?;
    let written: Written = serde_json::from_slice(&result).ok()?;
    let name = path.file_name()?.to_str()?;
    let hash = ContentHash::of(bytes).to_string();
    let mut outputs = written.outputs.iter();
    if !outputs.any(|output| output.file == name && output.sha256 == hash) {
        return None;
    }
    match written.verdict {
        Verdict::Answered => None,
        Verdict::InDoubt { reasons } => reasons.into_iter().next(),
        Verdict::NotAllowed { reason } => Some(reason),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn r11_a_file_has_the_standing_of_the_result_that_wrote_it() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("mobility.uff");
        let hash = ContentHash::of(b"lines");
        let standing = |verdict: &str| {
            let text = format!(
                r#"{{"outputs": [{{"file": "mobility.uff", "sha256": "{hash}"}}], "verdict": {verdict}}}"#
            );
            fs::write(folder.path().join(RESULT), text).unwrap();
        };
        assert_eq!(doubt(&path, b"lines"), None);
        standing(r#"{"answer": "in doubt", "reasons": ["one", "two"]}"#);
        assert_eq!(doubt(&path, b"lines").as_deref(), Some("one"));
        // the hash differs from that in `result.json`, so the file does not belong to this result
        assert_eq!(doubt(&path, b"other lines"), None);
        standing(r#"{"answer": "not allowed", "reasons": ["none"]}"#);
        assert_eq!(doubt(&path, b"lines").as_deref(), Some("none"));
        standing(r#"{"answer": "answered"}"#);
        assert_eq!(doubt(&path, b"lines"), None);
    }
}
