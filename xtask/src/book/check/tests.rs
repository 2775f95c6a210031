//! Deliberate faults in a small repository, each of which must be found.

use std::fs;

use super::*;

/// Returns the faults of a small correct repository after a `change`: the file, a text in it, and
/// the text that replaces it.
fn faults_with(change: Option<(&str, &str, &str)>) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let theory = "# Rods\n\nAs (A 1), see [there](../conventions.md#signs).\n\n## Validity\n\n## When not to trust it\n\n\
                  ## In the code\n\n`rodwave::chain`\n\n## Checked by\n\n`crates/rodwave/src/lib.rs`, `cargo xtask book`\n\n## References\n";
    let files = [
        (
            "docs/SUMMARY.md",
            "- [C](conventions.md)\n- [R](theory/rods.md)\n- [V](validation.md)\n",
        ),
        (
            "docs/conventions.md",
            "# Conventions\n\n## Signs\n\n$`x`$\n",
        ),
        ("docs/theory/rods.md", theory),
        ("README.md", "[rods](docs/theory/rods.md#rods)\n"),
        ("CONTRIBUTING.md", "\n"),
        ("CHANGELOG.md", "\n"),
        (
            "crates/rodwave/src/lib.rs",
            "//! Theory: `docs/theory/rods.md`.\npub mod chain;\n",
        ),
    ];
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let text = match change {
            Some((file, from, to)) if file == name => {
                assert!(text.contains(from), "{name} has no {from}");
                text.replace(from, to)
            }
            _ => text.to_owned(),
        };
        fs::write(path, text).unwrap();
    }
    let book = Book::read(folder.path(), vec!["book".to_owned()]).unwrap();
    book.check().0
}

#[test]
fn a_book_that_is_right_has_no_fault() {
    assert_eq!(faults_with(None), Vec::<String>::new());
}

#[test]
fn each_fault_is_found_where_it_is() {
    for (file, from, to, expected) in [
        (
            "docs/SUMMARY.md",
            "- [R](theory/rods.md)\n",
            "",
            "not in the summary",
        ),
        (
            "docs/SUMMARY.md",
            "validation.md",
            "elsewhere.md",
            "does not exist",
        ),
        (
            "docs/SUMMARY.md",
            "validation.md",
            "conventions.md",
            "named twice",
        ),
        ("docs/theory/rods.md", "#signs", "#sign", "no heading #sign"),
        (
            "docs/theory/rods.md",
            "[there](../conventions.md#signs)",
            "![there](../../README.md)",
            "outside of the book",
        ),
        ("docs/theory/rods.md", "(A 1)", "(A 9)", "paper A end at 7"),
        (
            "docs/theory/rods.md",
            "## Validity",
            "## Limits",
            "every page ends with",
        ),
        (
            "docs/theory/rods.md",
            "rodwave::chain",
            "rodwave::horn",
            "defines horn",
        ),
        (
            "docs/theory/rods.md",
            "`rodwave::chain`",
            "nowhere",
            "names nothing",
        ),
        (
            "docs/theory/rods.md",
            "crates/rodwave/src/lib.rs",
            "crates/rodwave/tests",
            "does not exist",
        ),
        (
            "docs/theory/rods.md",
            "xtask book",
            "xtask brook",
            "no such task",
        ),
        ("docs/conventions.md", "$`x`$", "$`\\nonsense`$", "nonsense"),
        ("README.md", "#rods", "#cones", "no heading #cones"),
        (
            "crates/rodwave/src/lib.rs",
            "rods.md",
            "cones.md",
            "cones.md does not exist",
        ),
        ("crates/rodwave/src/lib.rs", "Theory: ", "See ", "Theory: "),
    ] {
        let faults = faults_with(Some((file, from, to)));
        assert!(
            faults.iter().any(|fault| fault.contains(expected)),
            "{from} -> {to}: {faults:?}"
        );
    }
}
