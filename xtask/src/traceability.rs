//! `cargo xtask traceability`: docs/traceability.md, every numbered item of the thesis with its
//! code and its proof.
//!
//! Code and proof are found by their citations: the implementation of an equation cites it in its
//! documentation, and so does the test or the source of a claim that proves it. A table or figure
//! may instead be reproduced by code that compares its numbers with a snapshot.

mod citation;
mod numbered;
mod page;
mod place;

use std::collections::BTreeSet;

use testbed::generated::{ensure_file_contents, workspace_root};

use crate::{Outcome, none_of};

use numbered::{Kind, Numbered, Part};
use place::{Place, Role};

/// Command that makes the page.
const COMMAND: &str = "cargo xtask traceability";
/// Generated page.
const PAGE: &str = "docs/traceability.md";

/// Item of the thesis with everything that cites it.
#[derive(Debug)]
pub(crate) struct Traced {
    pub(crate) item: Numbered,
    pub(crate) places: BTreeSet<Place>,
}

impl Traced {
    /// Returns the fault of an item that lacks code or proof. Items of the survey are exempt,
    /// because it repeats the papers; for a table or figure, a reproduction is sufficient.
    fn fault(&self) -> Option<String> {
        if self.item.part == Part::Survey || !self.item.has_number() {
            return None;
        }
        let has = |role| self.places.iter().any(|place| place.role == role);
        let reproduced = self.item.kind != Kind::Equation && has(Role::Reproduced);
        let missing = |what| format!("{}: not cited by any {what}", self.item);
        match (has(Role::Implemented), has(Role::Proved)) {
            _ if reproduced => None,
            (true, true) => None,
            (true, false) => Some(missing("test or claim that proves it")),
            (false, _) => Some(missing("code that implements it")),
        }
    }
}

/// Writes the page; with `check`, fails if the page is not current. Also fails if an item has no
/// code or no proof.
pub(crate) fn run(check: bool) -> Outcome {
    let root = workspace_root();
    let mut items: Vec<Traced> = numbered::all()
        .into_iter()
        .map(|item| Traced {
            item,
            places: BTreeSet::new(),
        })
        .collect();
    let citations = citation::of_workspace(root)?;
    let mut faults = Vec::new();
    for citation in &citations {
        let mut items = items.iter_mut();
        match items.find(|traced| traced.item == citation.cited) {
            Some(traced) => traced.places.extend(citation.place.clone()),
            None => faults.push(citation.fault()),
        }
    }
    faults.extend(items.iter().filter_map(Traced::fault));
    none_of(&faults, "items of the thesis are not traced")?;
    ensure_file_contents(&root.join(PAGE), &page::markdown(&items), check, COMMAND)?;
    println!(
        "{} items traced by {} citations: {PAGE} is {}",
        items.len(),
        citations.len(),
        if check { "current" } else { "written" },
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn traced(kind: Kind, roles: &[Role]) -> Traced {
        let place = |role: &Role| Place {
            role: *role,
            file: "a.rs".to_owned(),
            item: "a".to_owned(),
        };
        Traced {
            item: Numbered {
                part: Part::A,
                kind,
                number: "1".to_owned(),
            },
            places: roles.iter().map(place).collect(),
        }
    }

    #[test]
    fn an_equation_wants_code_and_proof_and_a_table_may_be_reproduced() {
        use Role::{Implemented, Proved, Reproduced};
        let fault = |kind, roles: &[Role]| traced(kind, roles).fault();
        for roles in [&[] as &[Role], &[Proved], &[Reproduced, Proved]] {
            assert_eq!(
                fault(Kind::Equation, roles).as_deref(),
                Some("paper A, eq. 1: not cited by any code that implements it")
            );
        }
        assert_eq!(
            fault(Kind::Equation, &[Implemented, Reproduced]).as_deref(),
            Some("paper A, eq. 1: not cited by any test or claim that proves it")
        );
        assert_eq!(fault(Kind::Equation, &[Implemented, Proved]), None);
        assert_eq!(fault(Kind::Figure, &[Reproduced]), None);
        assert!(fault(Kind::Figure, &[Implemented]).is_some());
    }
}
