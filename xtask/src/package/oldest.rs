//! Comparison of the oldest Rust version stated by the workspace with those stated by its
//! dependencies.

use std::collections::BTreeSet;

use crate::cargo::{Metadata, Package};

/// Returns a sentence on the versions that the dependencies of `crates` state, and a fault for each
/// dependency that requires a newer Rust.
pub(super) fn of(crates: &[&Package], workspace: &Metadata) -> (String, Vec<String>) {
    let mut found: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = crates.iter().map(|package| package.id.as_str()).collect();
    while let Some(id) = open.pop() {
        let below = workspace.below(id, |edge| edge.kind.as_deref() != Some("dev"));
        open.extend(below.filter(|id| found.insert(id)));
    }
    let below: Vec<&Package> = found
        .iter()
        .filter_map(|id| workspace.package(id))
        .collect();
    let highest = below
        .iter()
        .filter_map(|package| Some((version(package.rust_version.as_deref()?)?, package)))
        .max_by_key(|(version, _)| *version);
    let silent = below
        .iter()
        .filter(|package| package.rust_version.is_none())
        .count();
    let mut faults = Vec::new();
    for ours in crates {
        let Some(stated) = ours.rust_version.as_deref().and_then(version) else {
            faults.push(format!("{}: rust-version is not a version", ours.name));
            continue;
        };
        for package in &below {
            if let Some(asked) = package.rust_version.as_deref().and_then(version)
                && asked > stated
            {
                faults.push(format!(
                    "{}: {} {} requires Rust {}.{}, but rust-version is {}.{}",
                    ours.name, package.name, package.version, asked.0, asked.1, stated.0, stated.1
                ));
            }
        }
    }
    let words = highest.map_or_else(
        || "no dependency states a Rust version".to_owned(),
        |((major, minor), package)| {
            format!(
                "the newest Rust version that a dependency states is {major}.{minor}, by {} {}; {silent} of {} state none",
                package.name,
                package.version,
                below.len()
            )
        },
    );
    (words, faults)
}

/// Returns the major and the minor number of a version.
fn version(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.split('.').map(str::parse);
    match (numbers.next(), numbers.next()) {
        (Some(Ok(major)), Some(Ok(minor))) => Some((major, minor)),
        (Some(Ok(major)), None) => Some((major, 0)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_as_numbers() {
        assert_eq!(version("1.89"), Some((1, 89)));
        assert!(version("1.100.0") > version("1.89"));
        assert_eq!(version("stable"), None);
    }

    #[test]
    fn a_dependency_that_wants_more_is_named() {
        let package = |id: &str, rust: Option<&str>| {
            serde_json::json!({
                "id": id, "name": id, "version": "2.0.0", "rust_version": rust,
                "keywords": [], "categories": [], "features": {}, "dependencies": [], "targets": [],
            })
        };
        let edge = |to: &str, kind: Option<&str>| serde_json::json!({"pkg": to, "dep_kinds": [{"kind": kind}]});
        let graph: Metadata = serde_json::from_value(serde_json::json!({
            "workspace_members": ["ours"],
            "packages": [
                package("ours", Some("1.89")), package("newer", Some("1.90.1")),
                package("silent", None), package("test", Some("1.95")),
            ],
            "resolve": {"nodes": [
                {"id": "ours", "deps": [edge("silent", None), edge("test", Some("dev"))]},
                {"id": "silent", "deps": [edge("newer", Some("build"))]},
            ]},
        }))
        .unwrap();
        let ours: Vec<&Package> = graph.packages.iter().take(1).collect();
        let (words, faults) = of(&ours, &graph);
        assert_eq!(
            faults,
            ["ours: newer 2.0.0 requires Rust 1.90, but rust-version is 1.89"]
        );
        assert!(words.ends_with("1 of 2 state none"), "{words}");
    }
}
