//! Differences between the page in the repository and the page that would be written.
//!
//! Claims, expected values and reasons are compared literally. Our numbers are not, because their
//! last digits differ between processors. The used part of the tolerance may change by 25 points:
//! some claims are about a number of lines, which may differ by one between processors.

use super::faults;
use super::page::Page;

/// Returns a line for each row that is not current.
pub(super) fn between(committed: &Page, current: &Page) -> Vec<String> {
    let mut drifts = Vec::new();
    let mut drift = |table: &str, claim: &str, how: &str| {
        drifts.push(format!("not current: {table}: {claim}: {how}"));
    };
    for table in &current.tables {
        for row in &table.rows {
            match committed.row(&table.name, &row.claim) {
                None => drift(&table.name, &row.claim, "missing from the page"),
                Some(old) => {
                    if let Some(how) = old.change_to(row) {
                        drift(&table.name, &row.claim, &how);
                    }
                }
            }
        }
    }
    if committed.faults != current.faults {
        let how = "is not that of docs/faults.ron";
        drift(faults::HEADING, "the table", how);
    }
    for table in &committed.tables {
        for row in &table.rows {
            if current.row(&table.name, &row.claim).is_none() {
                drift(&table.name, &row.claim, "no longer claimed");
            }
        }
    }
    drifts
}

#[cfg(test)]
mod tests {
    use super::super::page::{Row, Table};
    use super::*;

    fn row(claim: &str, used: &str, verdict: &str) -> Row {
        Row {
            claim: claim.to_owned(),
            used: used.to_owned(),
            verdict: verdict.to_owned(),
            ..Row::default()
        }
    }

    fn page(rows: Vec<Row>) -> Page {
        Page {
            tables: vec![Table {
                name: "rods".to_owned(),
                rows,
            }],
            ..Page::default()
        }
    }

    fn told(old: Vec<Row>, new: Vec<Row>) -> Vec<String> {
        between(&page(old), &page(new))
    }

    #[test]
    fn ours_may_move_within_25_points_of_the_tolerance() {
        let was = || vec![row("length", "12 %", "pass")];
        assert!(told(was(), vec![row("length", "< 1 %", "pass")]).is_empty());
        assert!(told(was(), vec![row("length", "37 %", "pass")]).is_empty());
        assert_eq!(
            told(was(), vec![row("length", "38 %", "pass")]),
            ["not current: rods: length: used was 12 %, is 38 %"]
        );
    }

    #[test]
    fn what_is_skipped_has_to_be_on_the_page_and_is_not_compared() {
        let skipped = || vec![row("length", "-", "skipped: lost")];
        assert!(told(vec![row("length", "12 %", "pass")], skipped()).is_empty());
        assert_eq!(told(Vec::new(), skipped()).len(), 1);
        // a page written without the records is not current on a machine that has them
        assert_eq!(
            told(skipped(), vec![row("length", "12 %", "pass")]).len(),
            1
        );
    }

    #[test]
    fn words_and_rows_are_compared_to_the_letter() {
        let mut other = row("length", "12 %", "pass");
        other.expected = "2".to_owned();
        assert_eq!(
            told(vec![row("length", "12 %", "pass")], vec![other]),
            ["not current: rods: length: expected was \"\", is \"2\""]
        );
        assert_eq!(
            told(
                vec![row("length", "12 %", "pass")],
                vec![row("width", "12 %", "pass")]
            ),
            [
                "not current: rods: width: missing from the page",
                "not current: rods: length: no longer claimed"
            ]
        );
    }
}
