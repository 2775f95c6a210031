//! `docs/dependencies.md`: the dependencies of each of our crates.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::Alone;
use super::pulled_in::PulledIn;
use crate::cargo::{Metadata, Package};

const HEAD: &str = "\
# Dependencies of the crates

Written by `cargo xtask outside`, not by hand: each row is a program outside the workspace that depends on one crate. Versions are those of
`Cargo.lock`. Linked crates are part of the program; macros, build scripts and their dependencies run only during compilation.

| crate | linked | on some platforms | during compilation |
|---|--:|--:|--:|
";

/// Returns the page.
pub(super) fn of(listed: &[Alone<'_>], workspace: &Metadata) -> String {
    let mut page = HEAD.to_owned();
    for Alone {
        library,
        by_default,
        by_feature,
    } in listed
    {
        row(&mut page, library.name, by_default);
        for (feature, pulled_in) in by_feature {
            row(
                &mut page,
                &format!("{}, feature {feature}", library.name),
                pulled_in,
            );
        }
    }
    page.push('\n');
    for Alone {
        library,
        by_default,
        by_feature,
    } in listed
    {
        let _ = write!(page, "## {}\n\n", library.name);
        let declared = workspace
            .local(library.name)
            .map(declared)
            .unwrap_or_default();
        paragraph(&mut page, "Direct", &declared);
        let below = by_default
            .everywhere
            .iter()
            .map(String::as_str)
            .filter(|name| !declared.contains(name))
            .collect::<Vec<_>>();
        paragraph(&mut page, "Indirect", &below);
        paragraph(
            &mut page,
            "On some platforms",
            &names(&by_default.somewhere),
        );
        paragraph(
            &mut page,
            "During compilation",
            &names(&by_default.compiling),
        );
        for (feature, pulled_in) in by_feature {
            paragraph(
                &mut page,
                &format!("Additional with the feature {feature}"),
                &pulled_in.beyond(by_default),
            );
        }
    }
    page.trim_end().to_owned() + "\n"
}

fn row(page: &mut String, name: &str, pulled_in: &PulledIn) {
    let _ = writeln!(
        page,
        "| {name} | {} | {} | {} |",
        pulled_in.everywhere.len(),
        pulled_in.somewhere.len(),
        pulled_in.compiling.len()
    );
}

/// Returns the dependencies of a manifest that are not optional.
fn declared(package: &Package) -> Vec<&str> {
    let names: BTreeSet<&str> = package
        .dependencies
        .iter()
        .filter(|dependency| dependency.kind.is_none() && !dependency.optional)
        .map(|dependency| dependency.name.as_str())
        .collect();
    names.into_iter().collect()
}

fn names(of: &BTreeSet<String>) -> Vec<&str> {
    of.iter().map(String::as_str).collect()
}

fn paragraph(page: &mut String, title: &str, names: &[&str]) {
    if !names.is_empty() {
        let _ = write!(page, "{title}: {}.\n\n", names.join(", "));
    }
}
