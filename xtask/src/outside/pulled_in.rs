//! Dependencies of a crate, from the graph of cargo.

use std::collections::BTreeSet;

use crate::cargo::{EdgeKind, Metadata, Package};

/// Names of the dependencies of a crate, without the crate itself. If there are several versions of
/// a dependency, the name includes the version.
#[derive(Debug, Default)]
pub(crate) struct PulledIn {
    /// Part of the program on every platform.
    pub(crate) everywhere: BTreeSet<String>,
    /// Part of the program on some platforms only.
    pub(crate) somewhere: BTreeSet<String>,
    /// Macros, build scripts, and their dependencies: compiled and run, but not part of the
    /// program.
    pub(crate) compiling: BTreeSet<String>,
}

impl PulledIn {
    /// Returns the dependencies of our crate named `krate`.
    pub(crate) fn of(krate: &str, graph: &Metadata) -> Self {
        let Some(top) = graph.local(krate) else {
            return Self::default();
        };
        let in_program = |edge: &EdgeKind| edge.kind.is_none();
        let everywhere = reached(graph, &top.id, false, |edge| {
            in_program(edge) && edge.target.is_none()
        });
        let linked = reached(graph, &top.id, false, in_program);
        let all = reached(graph, &top.id, true, |edge| {
            in_program(edge) || edge.kind.as_deref() == Some("build")
        });
        let names = |packages: BTreeSet<&str>| {
            packages
                .into_iter()
                .filter_map(|id| graph.package(id))
                .map(|package| graph.told_apart(package))
                .collect::<BTreeSet<_>>()
        };
        Self {
            somewhere: names(linked.difference(&everywhere).copied().collect()),
            compiling: names(all.difference(&linked).copied().collect()),
            everywhere: names(everywhere),
        }
    }

    /// Returns the dependencies that become part of a program, on all or on some platforms.
    pub(crate) fn linked(&self) -> impl Iterator<Item = &String> {
        self.everywhere.iter().chain(&self.somewhere)
    }

    /// Returns the dependencies that are not in `less`.
    pub(crate) fn beyond(&self, less: &Self) -> Vec<&str> {
        let known: BTreeSet<_> = less.linked().chain(&less.compiling).collect();
        self.linked()
            .chain(&self.compiling)
            .filter(|name| !known.contains(name))
            .map(String::as_str)
            .collect()
    }
}

impl Metadata {
    /// Returns the name of a package. If another package has the same name, the part of the version
    /// that distinguishes them follows.
    fn told_apart(&self, package: &Package) -> String {
        let name = &package.name;
        let is_one_of_several = self
            .packages
            .iter()
            .any(|other| other.name == *name && other.id != package.id);
        if !is_one_of_several {
            return name.clone();
        }
        let mut numbers = package.version.split('.');
        match (numbers.next(), numbers.next()) {
            (Some("0"), Some(minor)) => format!("{name} 0.{minor}"),
            (Some(major), _) => format!("{name} {major}"),
            _ => name.clone(),
        }
    }
}

/// Returns the packages below `top`, along the edges that `follows` accepts; macros and their
/// dependencies are left out unless `with_macros` is set.
fn reached<'a>(
    graph: &'a Metadata,
    top: &'a str,
    with_macros: bool,
    follows: impl Fn(&EdgeKind) -> bool + Copy + 'a,
) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open = vec![top];
    while let Some(id) = open.pop() {
        for below in graph.below(id, follows) {
            let is_macro = graph
                .package(below)
                .is_some_and(|package| package.is_macro());
            if (with_macros || !is_macro) && found.insert(below) {
                open.push(below);
            }
        }
    }
    found
}
