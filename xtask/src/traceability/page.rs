//! docs/traceability.md: a table for each part of the thesis, with links.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::numbered::Part;
use super::place::{Place, Role};
use super::{COMMAND, Traced};

/// Returns the page.
pub(crate) fn markdown(items: &[Traced]) -> String {
    let mut page = format!(
        "<!-- Made by `{COMMAND}` from the citations in the sources: do not edit by hand. -->\n\n\
         # Traceability\n\n\
         Every numbered equation, table and figure of S. Ödeen's thesis (Luleå 1993), with the code and the tests that cite it, and the \
         reproduction that computes or draws it and is compared with a snapshot. `{COMMAND} --check` fails if no code or no test cites an \
         item, or if a citation names an item that the thesis does not have. [CONTRIBUTING.md](../CONTRIBUTING.md#traceability) describes \
         citations.\n"
    );
    for part in Part::ALL {
        let heading = match part {
            Part::Survey => part.title().to_owned(),
            paper => format!("Paper {paper:?}: {}", paper.title()),
        };
        let _ = write!(
            page,
            "\n## {heading}\n\n| item | code | proof | reproduced by |\n|---|---|---|---|\n"
        );
        for traced in items.iter().filter(|traced| traced.item.part == part) {
            let _ = writeln!(
                page,
                "| {} {} | {} | {} | {} |",
                traced.item.kind,
                traced.item.number,
                cell(&traced.places, Role::Implemented),
                cell(&traced.places, Role::Proved),
                cell(&traced.places, Role::Reproduced),
            );
        }
    }
    page
}

fn cell(places: &BTreeSet<Place>, role: Role) -> String {
    let links: Vec<String> = places
        .iter()
        .filter(|place| place.role == role)
        .map(|place| format!("[`{}`](../{})", place.item, place.file))
        .collect();
    links.join(", ")
}
