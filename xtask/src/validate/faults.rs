//! Faults injected into the command, as counted by the tests of the command: docs/faults.ron.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Deserialize;

use crate::Outcome;
use crate::files::read;
use testbed::generated::workspace_root;
use testbed::ron_text::parse_ron;

/// Path of the counts, relative to the root of the workspace. `crates/rodlab/tests/faults.rs`
/// documents how they are made.
const COUNTS: &str = "docs/faults.ron";

/// Heading of the section on the page.
pub(super) const HEADING: &str = "Faults of the command";

const HEAD: &str = "| fault | injected | points | refused | right | said | shorter | ended | lost | panics |\n\
                    |---|---|--:|--:|--:|--:|--:|--:|--:|--:|\n";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    fault: String,
    injected: String,
    tried: usize,
    refused: usize,
    right: usize,
    said: usize,
    shorter: usize,
    stopped: usize,
    lost: usize,
    broke: usize,
    skipped: Option<String>,
}

impl Row {
    fn counts(&self) -> [usize; 8] {
        [
            self.tried,
            self.refused,
            self.right,
            self.said,
            self.shorter,
            self.stopped,
            self.lost,
            self.broke,
        ]
    }

    fn check(&self) -> Outcome {
        let (fault, tried) = (&self.fault, self.tried);
        if self.lost + self.broke > 0 {
            let (lost, broke) = (self.lost, self.broke);
            return Err(format!(
                "{COUNTS}: \"{fault}\" counts {lost} points as lost and {broke} as broken, expected none"
            )
            .into());
        }
        let told: usize = self.counts()[1..].iter().sum();
        if told != tried {
            return Err(format!(
                "{COUNTS}: \"{fault}\" states the outcome of {told} points, expected {tried}"
            )
            .into());
        }
        Ok(())
    }
}

#[derive(Debug, Deserialize)]
struct Campaign(BTreeMap<String, Vec<Row>>);

/// Returns the section without its heading.
pub(super) fn section() -> Outcome<String> {
    let path = workspace_root().join(COUNTS);
    table(&parse_ron(&path, &read(&path)?)?)
}

fn table(campaign: &Campaign) -> Outcome<String> {
    let mut text = String::from(
        "Faults that occur in a laboratory were injected into runs of the command, at each of the points in the column \"injected\". \
         `crates/rodlab/tests/faults.rs` counts the outcomes; in the gate, it tries a few of the points. \"Refused\": status 1 or 2 with a \
         reason, and the earlier files are complete. \"Right\": the same result as without the fault. \"Said\": there is a result, which \
         states the fault of its input. \"Shorter\": the rest of the file is a complete file of its format, and the cut cannot be detected. \
         \"Ended\": the fault ended the program; every file is complete, a `result.json` exists only with all files of its run, and the \
         next run gives the right result. \"Lost\": data that are missing, mixed or wrong without a message. \"Panics\": panics, other signals, and \
         runs that do not end.\n\n",
    );
    text.push_str(HEAD);
    let mut sums = [0; 8];
    let mut skipped = Vec::new();
    for row in campaign.0.values().flatten() {
        row.check()?;
        if let Some(why) = &row.skipped {
            skipped.push(format!("{}: {why}", row.fault));
            continue;
        }
        for (sum, count) in sums.iter_mut().zip(row.counts()) {
            *sum += count;
        }
        let words = [&row.fault, &row.injected].map(|words| words.replace('|', "\\|"));
        let _ = writeln!(text, "| {} | {} |", words.join(" | "), joined(row.counts()));
    }
    let _ = writeln!(text, "| all | | {} |", joined(sums));
    match skipped.as_slice() {
        [] => text.push_str("\nNo fault was skipped.\n"),
        skipped => {
            let _ = writeln!(text, "\nSkipped: {}.", skipped.join("; "));
        }
    }
    Ok(text)
}

fn joined(counts: [usize; 8]) -> String {
    counts.map(|count| count.to_string()).join(" | ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn campaign(counts: &str) -> Campaign {
        let row = format!(
            "({{\"cuts\": [(fault: \"cut | torn\", injected: \"everywhere\", {counts}, skipped: None)]}})"
        );
        ron::from_str(&row).unwrap()
    }

    #[test]
    fn a_loss_and_a_wrong_sum_are_refused() {
        for (counts, part) in [
            (
                "tried: 1, refused: 0, right: 0, said: 0, shorter: 0, stopped: 0, lost: 1, broke: 0",
                "counts 1 points as lost",
            ),
            (
                "tried: 2, refused: 1, right: 0, said: 0, shorter: 0, stopped: 0, lost: 0, broke: 0",
                "states the outcome of 1 points, expected 2",
            ),
        ] {
            let said = table(&campaign(counts)).unwrap_err().to_string();
            assert!(said.contains(part), "{said}");
        }
    }
}
