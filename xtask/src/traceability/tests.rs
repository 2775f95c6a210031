//! Rows that are right, and every way in which one can be wrong.

use std::path::Path;

use super::*;

const LIBRARY: &str = "
pub struct Branch;
impl Branch { pub fn closed_form(&self) {} fn step(&self) {} }
#[cfg(test)]
mod tests { #[test] fn in_the_file() {} }
";
const TEST: &str = "#[test] fn closed_form_inverts() {} fn check() {}";

fn workspace() -> Workspace {
    Workspace::of(&[
        ("crates/cmod/src/branch.rs", LIBRARY),
        ("crates/cmod/tests/branch.rs", TEST),
    ])
}

fn rows(text: &str) -> Vec<Row> {
    row::parse(Path::new("rows.ron"), text).unwrap()
}

const ROW: &str = r#"(rows: [(
    part: A, kind: Equation, number: "3", says: "closed form",
    implemented: ["crates/cmod/src/branch.rs::Branch::closed_form"],
    proved: ["crates/cmod/tests/branch.rs::closed_form_inverts", "crates/cmod/src/branch.rs::tests::in_the_file"],
    reproduced: ["reproduce-paper-a::figure-3a.svg", "reproduce-paper-a::table_1"],
    note: "as the [page](theory/branches.md#roots) says",
)])"#;

/// The messages for the row above with one piece of it exchanged.
fn messages(piece: &str, by: &str) -> Vec<String> {
    assert_eq!(ROW.matches(piece).count(), 1, "{piece}");
    let rows = rows(&ROW.replace(piece, by));
    faults_of(
        &rows[0],
        workspace_root(),
        &workspace(),
        &Reproductions::of("reproduce-paper-a", &["figure-3a.svg"], &["table_1"]),
    )
    .iter()
    .map(Fault::to_string)
    .collect()
}

#[test]
fn a_right_row_has_no_fault() {
    assert_eq!(messages("closed form\"", "the closed form\""), [""; 0]);
}

#[test]
fn each_wrong_reference_names_its_row_and_the_nearest_name() {
    for (piece, by, expected) in [
        (
            "Branch::closed_form\"]",
            "Branch::close_form\"]",
            "paper A, eq. 3, implemented: `crates/cmod/src/branch.rs` does not define `Branch::close_form`, expected perhaps \
             `Branch::closed_form`",
        ),
        (
            "src/branch.rs::Branch",
            "src/branches.rs::Branch",
            "paper A, eq. 3, implemented: no crate compiles `crates/cmod/src/branches.rs`, expected perhaps \
             `crates/cmod/src/branch.rs`",
        ),
        (
            "src/branch.rs::Branch::closed_form",
            "src/branch.rs",
            "paper A, eq. 3, implemented: `crates/cmod/src/branch.rs` is no reference, expected `file.rs::item` from the root \
             of the workspace",
        ),
        (
            "Branch::closed_form\"]",
            "Branch::step\"]",
            "paper A, eq. 3, implemented: nothing public among crates/cmod/src/branch.rs::Branch::step, expected a public item",
        ),
        (
            "src/branch.rs::Branch::closed_form",
            "tests/branch.rs::closed_form_inverts",
            "paper A, eq. 3, implemented: `crates/cmod/tests/branch.rs::closed_form_inverts` is a test, expected the code that \
             it tests",
        ),
        (
            "branch.rs::closed_form_inverts",
            "branch.rs::check",
            "paper A, eq. 3, proved: `crates/cmod/tests/branch.rs::check` is no test, expected a function with #[test]",
        ),
        (
            "src/branch.rs::tests::in_the_file",
            "tests/branch.rs::tests::in_the_file",
            "paper A, eq. 3, proved: `crates/cmod/tests/branch.rs` does not define `tests::in_the_file`, but \
             `crates/cmod/src/branch.rs` does",
        ),
        (
            "paper-a::figure-3a.svg",
            "paper-f::figure-3a.svg",
            "paper A, eq. 3, reproduced: no task `reproduce-paper-f`, expected perhaps `reproduce-paper-a`",
        ),
        (
            "figure-3a.svg",
            "figure-3b.svg",
            "paper A, eq. 3, reproduced: `reproduce-paper-a` writes no file `figure-3b.svg`, expected perhaps `figure-3a.svg`",
        ),
        (
            "::table_1",
            "::tables",
            "paper A, eq. 3, reproduced: the snapshot of `reproduce-paper-a` has no key `tables`, expected perhaps `table_1`",
        ),
        (
            "theory/branches.md#roots",
            "theory/roots.md",
            "paper A, eq. 3: link `theory/roots.md` leads nowhere, expected a file seen from docs",
        ),
        (
            "closed form\"",
            " \"",
            "paper A, eq. 3: `says` is empty, expected an entry",
        ),
    ] {
        assert_eq!(messages(piece, by), [expected], "{by}");
    }
    assert_eq!(
        messages(
            "[\"crates/cmod/tests/branch.rs::closed_form_inverts\", \"crates/cmod/src/branch.rs::tests::in_the_file\"]",
            "[]"
        ),
        ["paper A, eq. 3: `proved` is empty, expected an entry"]
    );
}

#[test]
fn nothing_far_away_is_proposed() {
    assert_eq!(
        messages("Branch::closed_form\"]", "Resonances::estimate\"]"),
        [
            "paper A, eq. 3, implemented: `crates/cmod/src/branch.rs` does not define `Resonances::estimate`"
        ]
    );
}

#[test]
fn what_implements_an_equation_cites_it() {
    let row = &rows(ROW)[0];
    let citing = |file: &str, text: &str| {
        not_cited(row, &citation::of_text(file, text)).map(|fault| fault.to_string())
    };
    let here = "crates/cmod/src/branch.rs";
    assert_eq!(citing(here, "(paper A, eqs. 2-4)"), None);
    let expected = Some(
        "paper A, eq. 3: cited in none of crates/cmod/src/branch.rs, expected `(Ödeen 1993, paper A, eq. 3)` where it is \
         implemented"
            .to_owned(),
    );
    assert_eq!(citing(here, "(paper B, eq. 3)"), expected);
    assert_eq!(
        citing("crates/cmod/src/lib.rs", "(paper A, eq. 3)"),
        expected
    );
}

#[test]
fn rows_are_those_of_the_thesis_once_and_in_its_order() {
    let row = |number: &str| {
        format!(
            "(part: A, kind: Table, number: \"{number}\", says: \"\", implemented: [], proved: [])"
        )
    };
    let expected: Vec<Numbered> = numbered::all()
        .into_iter()
        .filter(|item| (item.part, item.kind) == (Part::A, Kind::Table))
        .collect();
    let faults = |numbers: &[&str]| -> Vec<String> {
        let list: Vec<String> = numbers.iter().map(|number| row(number)).collect();
        complete(&rows(&format!("(rows: [{}])", list.join(","))), &expected)
            .iter()
            .map(Fault::to_string)
            .collect()
    };
    assert_eq!(faults(&["1", "2"]), [""; 0]);
    assert_eq!(faults(&["1"]), ["paper A, Table 2: no row, expected one"]);
    assert_eq!(
        faults(&["1", "2", "2"]),
        ["paper A, Table 2: 2 rows, expected one"]
    );
    assert_eq!(
        faults(&["1", "2", "3"]),
        [["paper A", ", Table 3: no such item, expected Table 1 to 2"].concat()]
    );
    assert_eq!(
        faults(&["2", "1"]),
        ["paper A, Table 2: out of order, expected paper A, Table 1 here"]
    );
}

#[test]
fn what_is_no_row_gives_its_line() {
    let error = row::parse(
        Path::new("rows.ron"),
        "(rows: [\n(part: A, kind: Equation, number: \"1\", say: \"\"),\n])",
    )
    .unwrap_err()
    .to_string();
    assert!(
        error.starts_with("rows.ron, line 2, column ") && error.contains("`say`"),
        "{error}"
    );
}

#[test]
fn a_row_is_a_line_of_the_page_with_its_links() {
    let page = page::markdown(&rows(
        &ROW.replace("closed form\"", "|γL| in closed form\""),
    ));
    let line = page.lines().find(|line| line.starts_with("| eq. 3 |"));
    assert_eq!(
        line,
        Some(
            "| eq. 3 | \\|γL\\| in closed form | [`Branch::closed_form`](../crates/cmod/src/branch.rs), `figure-3a.svg` by \
             [`reproduce-paper-a`](../xtask/src/reproduce/paper_a.rs) | [`closed_form_inverts`](../crates/cmod/tests/branch.rs), \
             [`in_the_file`](../crates/cmod/src/branch.rs), `table_1` of \
             [`reproduce-paper-a`](../xtask/snapshots/reproduce-paper-a.json) | as the [page](theory/branches.md#roots) says |"
        )
    );
    assert!(page.contains("\n| paper A | 1 | 0 | 0 | 2 |\n"), "{page}");
}

/// The table of this repository: every row is there, and every reference resolves.
#[test]
fn the_table_is_complete_and_current() {
    if let Err(error) = run(true) {
        panic!("{error}"); // a line a fault
    }
}
