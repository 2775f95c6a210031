//! Public items as lines of text that can be compared. The implementations of common traits take
//! one line per type.

use std::collections::BTreeSet;
use std::fmt;

/// Common traits, each with the methods that are not listed when a type implements it.
const PLAIN: [(&str, &[&str]); 14] = [
    ("core::clone::Clone", &["clone"]),
    ("core::cmp::Eq", &[]),
    ("core::cmp::Ord", &["cmp"]),
    ("core::cmp::PartialEq", &["eq"]),
    ("core::cmp::PartialOrd", &["partial_cmp"]),
    ("core::default::Default", &["default"]),
    ("core::error::Error", &["source", "provide"]),
    ("core::fmt::Debug", &["fmt"]),
    ("core::fmt::Display", &["fmt"]),
    ("core::hash::Hash", &["hash"]),
    ("core::marker::Copy", &[]),
    ("core::marker::StructuralPartialEq", &[]),
    ("serde_core::de::Deserialize<'de>", &["deserialize"]),
    ("serde_core::ser::Serialize", &["serialize"]),
];

/// Traits that types implement automatically: a type that lacks one is listed.
const AUTOMATIC: [&str; 7] = [
    "core::marker::Freeze",
    "core::marker::Send",
    "core::marker::Sync",
    "core::marker::Unpin",
    "core::marker::UnsafeUnpin",
    "core::panic::unwind_safe::RefUnwindSafe",
    "core::panic::unwind_safe::UnwindSafe",
];

/// Crates that every program can use without declaring them as dependencies.
const STANDARD: [&str; 3] = ["alloc", "core", "std"];

/// Pairs of a crate and of a second crate that re-exports its items.
const WITHIN: [(&str, &str); 1] = [("rand_core", "rand")];

/// Public interface of a crate.
#[derive(Debug)]
pub(super) struct Listing {
    krate: &'static str,
    lines: Vec<String>,
    /// Crates of the types that occur in signatures.
    foreign: BTreeSet<String>,
    /// Crates that are re-exported.
    handed_on: BTreeSet<String>,
}

impl Listing {
    /// Creates the listing of `krate`. The `items` are in the order of `public-api`, in which
    /// methods follow their `impl`.
    pub(super) fn of(krate: &'static str, items: impl Iterator<Item = String>) -> Self {
        let mut lines: Vec<String> = Vec::new();
        let mut foreign = BTreeSet::new();
        let mut handed_on = BTreeSet::new();
        let mut hidden: &[&str] = &[];
        // type whose common traits are being collected, and the index of the line that collects
        // them
        let mut plain: Option<(String, usize)> = None;
        for item in items {
            if let Some(re_export) = item.strip_prefix(&format!("pub use {krate}::"))
                && !re_export.contains("::")
            {
                handed_on.insert(re_export.to_owned());
            }
            let Some((generics, name, of)) = implementation(&item) else {
                let is_hidden = method(&item).is_some_and(|method| hidden.contains(&method));
                if !is_hidden {
                    hidden = &[];
                    foreign.extend(crates_in(&item));
                    lines.push(item);
                }
                continue;
            };
            hidden = &[];
            if AUTOMATIC.contains(&name) {
                continue;
            }
            let Some((name, methods)) = PLAIN.iter().find(|(plain, _)| *plain == name) else {
                foreign.extend(crates_in(&item));
                lines.push(item);
                continue;
            };
            hidden = methods;
            foreign.extend(crates_in(name));
            let short = name.rsplit("::").next().unwrap_or(name);
            if short == "StructuralPartialEq" {
                continue;
            }
            let key = format!("{generics} {of}");
            match &plain {
                Some((known, at)) if *known == key => {
                    if let Some((before, after)) = lines[*at].split_once(" for ") {
                        lines[*at] = format!("{before}, {short} for {after}");
                    }
                }
                _ => {
                    foreign.extend(crates_in(of));
                    lines.push(format!("impl{generics} {short} for {of}"));
                    plain = Some((key, lines.len() - 1));
                }
            }
        }
        foreign.retain(|name| name != krate && !STANDARD.contains(&name.as_str()));
        Self {
            krate,
            lines,
            foreign,
            handed_on,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    /// Returns a fault for each crate whose types occur in signatures and that is not re-exported.
    pub(super) fn not_nameable(&self) -> Vec<String> {
        self.foreign
            .iter()
            .filter(|name| {
                let roof = WITHIN
                    .iter()
                    .find(|(inner, _)| inner == name)
                    .map_or(name.as_str(), |(_, roof)| roof);
                // signatures with serde require the feature `serde`; a program that enables it
                // depends on serde
                roof != "serde" && roof != "serde_core" && !self.handed_on.contains(roof)
            })
            .map(|name| {
                let example = self
                    .lines
                    .iter()
                    .find(|line| crates_in(line).any(|found| found == *name))
                    .map_or("", String::as_str);
                format!(
                    "{}: {name} is not re-exported, but occurs in `{example}`",
                    self.krate
                )
            })
            .collect()
    }
}

impl fmt::Display for Listing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let foreign: Vec<_> = self.foreign.iter().map(String::as_str).collect();
        writeln!(
            f,
            "# Public items of {}, with all features. Written by `cargo xtask api`; a difference is a change of the interface.",
            self.krate
        )?;
        writeln!(
            f,
            "# Implementations of traits such as Clone and Debug take one line per type; automatic traits such as Send and Sync are listed only if a type lacks them."
        )?;
        writeln!(f, "# Other crates in signatures: {}.", foreign.join(", "))?;
        self.lines.iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

/// Returns generics, trait and type of an item that begins the implementation of a trait. The name
/// of the trait begins with `!` if the type is stated not to implement it.
fn implementation(item: &str) -> Option<(&str, &str, &str)> {
    let rest = item.strip_prefix("impl")?;
    let generics = if rest.starts_with('<') {
        let mut depth = 0_usize;
        let end = rest.char_indices().find_map(|(at, c)| {
            match c {
                '<' => depth += 1,
                // the `>` of an arrow is not a bracket
                '>' if !rest[..at].ends_with('-') => depth -= 1,
                _ => {}
            }
            (depth == 0).then_some(at + 1)
        })?;
        &rest[..end]
    } else {
        ""
    };
    let (name, of) = rest[generics.len()..].trim_start().split_once(" for ")?;
    Some((generics, name, of))
}

/// Returns the name of the method in a line.
fn method(item: &str) -> Option<&str> {
    let (path, _) = item
        .strip_prefix("pub fn ")?
        .split_once(['(', '<'].as_slice())?;
    // if the type has generics, the path continues after them
    let path = if item.contains(">::") {
        item.split_once(">::")?.1.split(['(', '<']).next()?
    } else {
        path
    };
    path.rsplit("::").next()
}

/// Returns the first segments of the paths in a line.
fn crates_in(line: &str) -> impl Iterator<Item = String> {
    line.match_indices("::").filter_map(|(at, _)| {
        let before = &line[..at];
        let start = before
            .rfind(|c: char| !(c.is_alphanumeric() || c == '_'))
            .map_or(0, |at| at + 1);
        let name = &before[start..];
        let begins = !before[..start].ends_with("::") && !before[..start].ends_with('\'');
        (begins && name.starts_with(|c: char| c.is_ascii_lowercase())).then(|| name.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listing(items: &[&str]) -> Listing {
        Listing::of("cmod", items.iter().map(|item| (*item).to_owned()))
    }

    #[test]
    fn a_foreign_type_has_to_be_handed_on() {
        let lines = [
            "pub use cmod::num_complex",
            "pub fn cmod::root(psi: num_complex::Complex64) -> core::option::Option<faer::Mat<f64>>",
        ];
        let found = listing(&lines);
        assert_eq!(
            found.foreign,
            ["faer", "num_complex"].map(str::to_owned).into()
        );
        assert_eq!(
            found.not_nameable(),
            [format!(
                "cmod: faer is not re-exported, but occurs in `{}`",
                lines[1]
            )]
        );
    }
}
