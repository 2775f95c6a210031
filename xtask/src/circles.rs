//! Test for circles, that is, cyclic dependencies between the modules of a crate.
//!
//! A file together with the files below it is one module. An arrow leads from a module to each
//! module that it uses. If `pub use` makes a name visible in several modules, the arrow leads to
//! the module that declares the name. Arrows are compared for modules with the same parent:
//! `estimate` and `free_end`, for example, form a circle if each uses the other. Paths are read, in
//! `use` and elsewhere, if they begin with `crate`, `self`, `super` or the name of a submodule.
//! Tests are omitted.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use testbed::generated::workspace_root;
use testbed::papers::files;

/// Arrows that are tolerated although they are part of circles, each after the folder of its
/// modules. No circle remains without these arrows. Entries may only be removed from this list.
const KNOWN: &[&str] = &[
    "crates/impulse/src/hopkinson: result -> finding",
    "crates/impulse/src/hopkinson: shot -> finding",
    "crates/impulse/src/impact: prediction -> discrete",
    "crates/impulse/src/reconstruct: path_errors -> lines",
    "crates/labio/src: spectra -> frf",
    "crates/labio/src: unit -> channel",
    "crates/maxwellid/src: fit -> profile",
    "crates/maxwellid/src: identification -> fit",
    "crates/maxwellid/src: identification -> profile",
    "crates/maxwellid/src: test -> common_error",
    "crates/maxwellid/src: test -> noise",
    "crates/maxwellid/src: test -> recorder",
    "crates/maxwellid/src: whitening -> recorder",
    "crates/rodlab/src/job/fit: columns -> errors",
    "crates/rodlab/src/job/fit: steps -> columns",
    "crates/rodlab/src/sheet/typed: access -> reading",
    "crates/rodlab/src/sheet/typed: fault -> reading",
    "crates/rodlab/src/sheet: stated -> exact",
    "crates/rodlab/src: error -> sheet",
    "crates/rodlab/src: output -> report",
];

/// Names of a path, starting at the root of the crate.
type Names = Vec<String>;

/// Source of a file, without comments, tests and `use`.
#[derive(Default)]
struct Module {
    code: String,
    /// Imported paths, each with its name in this module, and true for `pub use`.
    imports: Vec<(Names, String, bool)>,
}

impl Module {
    fn of(source: &str) -> Self {
        let mut module = Self::default();
        let bare = without_tests(source);
        let mut rest = bare.as_str();
        while let Some(at) = word(rest, "use") {
            let (before, tail) = rest.split_at(at);
            let (tree, after) = tail[3..].split_once(';').unwrap_or((&tail[3..], ""));
            let line = before.rsplit(['\n', ';', '}']).next().unwrap_or_default();
            leaves(&[], tree, &mut |path, name| {
                module.imports.push((path, name, line.contains("pub")));
            });
            module.code.push_str(before);
            rest = after;
        }
        module.code.push_str(rest);
        module
    }

    /// Returns the paths in the code that consist of two names or more.
    fn paths(&self) -> impl Iterator<Item = Names> {
        let pieces = self
            .code
            .split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        pieces.filter(|piece| piece.contains("::")).map(|piece| {
            let names = piece.split("::").filter(|name| !name.is_empty());
            names.map(str::to_owned).collect()
        })
    }
}

/// Returns the position of a whole word.
fn word(text: &str, wanted: &str) -> Option<usize> {
    let part = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    text.match_indices(wanted).map(|(at, _)| at).find(|at| {
        !part(text[..*at].chars().next_back()) && !part(text[at + wanted.len()..].chars().next())
    })
}

/// Calls `found` with each path in the tree of a `use`, and with the name under which the path is
/// imported.
fn leaves(above: &[String], tree: &str, found: &mut impl FnMut(Names, String)) {
    let tree = tree.trim();
    let (head, branches) = tree.split_once('{').unwrap_or((tree, ""));
    let (head, alias) = head.split_once(" as ").unwrap_or((head, ""));
    let mut path = above.to_vec();
    let names = head
        .split("::")
        .map(str::trim)
        .filter(|name| !name.is_empty());
    path.extend(names.map(str::to_owned));
    if tree.contains('{') {
        let inside = &branches[..branches.rfind('}').unwrap_or(branches.len())];
        let (mut depth, mut from) = (0, 0);
        for (at, c) in inside.char_indices().chain([(inside.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    leaves(&path, &inside[from..at], found);
                    from = (at + 1).min(inside.len());
                }
                _ => {}
            }
        }
    } else if let Some(last) = path.last().cloned() {
        if last == "self" {
            path.pop();
        }
        let own = path.last().cloned().unwrap_or_default();
        let name = if alias.is_empty() {
            own
        } else {
            alias.trim().to_owned()
        };
        found(path, name);
    }
}

/// Returns the source without comments and without test items. A test item ends at the next line of
/// the same indentation that ends in `}` or `;`.
fn without_tests(source: &str) -> String {
    let mut bare = String::new();
    let mut inside: Option<&str> = None;
    for line in source.lines() {
        let indentation = &line[..line.len() - line.trim_start().len()];
        let code = line.split("//").next().unwrap_or_default();
        match inside {
            None if line.trim() == "#[cfg(test)]" => inside = Some(indentation),
            None => bare.extend([code, "\n"]),
            Some(own) if own == indentation && code.ends_with(['}', ';']) => inside = None,
            Some(_) => {}
        }
    }
    bare
}

/// Modules of a crate by their names; the root has the empty name.
struct Modules(BTreeMap<Names, Module>);

impl Modules {
    fn below(source: &Path) -> Self {
        let mut modules = BTreeMap::new();
        let mut paths = vec![source.to_owned()];
        while let Some(path) = paths.pop() {
            if path.is_dir() {
                paths.extend(files(&path).unwrap());
                continue;
            }
            let name = path.strip_prefix(source).unwrap().with_extension("");
            let names: Names = name
                .iter()
                .map(|n| n.to_string_lossy().into_owned())
                .collect();
            let last = names.last().unwrap().as_str();
            if path.extension().is_none_or(|ending| ending != "rs") || last == "tests" {
                continue;
            }
            let root = names.len() == 1 && ["lib", "main"].contains(&last);
            let names = if root { Vec::new() } else { names };
            modules.insert(names, Module::of(&fs::read_to_string(&path).unwrap()));
        }
        Self(modules)
    }

    /// Returns the path from the root; `None` if it leads out of the crate.
    fn absolute(&self, from: &[String], path: &[String]) -> Option<Names> {
        let ups = path.iter().take_while(|name| *name == "super").count();
        let (base, rest) = match path.first()?.as_str() {
            "crate" => (&from[..0], &path[1..]),
            "self" => (from, &path[1..]),
            "super" => (&from[..from.len().checked_sub(ups)?], &path[ups..]),
            first if self.0.contains_key(&[from, &[first.to_owned()]].concat()) => (from, path),
            _ => return None,
        };
        Some([base, rest].concat())
    }

    /// Returns the module that declares the item at the end of a path.
    fn declares(&self, path: &[String], mut hops: usize) -> Option<Names> {
        let known = (0..=path.len())
            .rev()
            .find(|n| self.0.contains_key(&path[..*n]))?;
        let (module, rest) = path.split_at(known);
        let (Some((name, beyond)), Some(left)) = (rest.split_first(), hops.checked_sub(1)) else {
            return Some(module.to_vec());
        };
        hops = left;
        let imports = &self.0[module].imports;
        let named = imports.iter().filter(|(_, own, _)| own == name);
        let all = imports.iter().filter(|(_, own, _)| own == "*");
        let through = named.chain(all).find_map(|(path, own, _)| {
            let mut path = self.absolute(module, path)?;
            if own == "*" {
                path.pop();
                path.push(name.clone());
                let declared = self.declares(&path, hops)?;
                let code = &self.0.get(&declared)?.code;
                return word(code, name).map(|_| declared);
            }
            self.declares(&[&path, beyond].concat(), hops)
        });
        Some(through.unwrap_or_else(|| module.to_vec()))
    }

    /// Returns the modules that a module uses, each with a name that is used from it.
    fn used(&self, from: &Names) -> BTreeMap<Names, String> {
        let module = &self.0[from];
        let imports = module
            .imports
            .iter()
            .filter(|(_, name, public)| !public || word(&module.code, name).is_some());
        let paths = imports.map(|(path, ..)| path.clone()).chain(module.paths());
        paths
            .filter_map(|path| {
                let mut to = self.absolute(from, &path)?;
                let name = path.last().cloned().unwrap_or_default();
                if name == "*" {
                    to.pop();
                }
                Some((self.declares(&to, 16)?, name))
            })
            .collect()
    }

    /// Returns the arrows between modules with the same parent, by parent; each arrow has a
    /// sentence that names one of its causes.
    fn arrows(&self) -> BTreeMap<Names, Arrows> {
        let mut arrows: BTreeMap<Names, Arrows> = BTreeMap::new();
        for from in self.0.keys() {
            for (to, name) in self.used(from) {
                let above = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if above < from.len() && above < to.len() {
                    let why = format!("{} uses {name} of {}", from.join("::"), to.join("::"));
                    let arrow = (from[above].clone(), to[above].clone());
                    let place = arrows.entry(from[..above].to_vec()).or_default();
                    place.insert(arrow, why);
                }
            }
        }
        arrows
    }
}

/// Arrows from one module to another, each with a sentence that names its cause.
type Arrows = BTreeMap<(String, String), String>;

/// Returns the arrows that are part of a circle: other arrows lead back from their end to their
/// start.
fn on_circles(mut arrows: Arrows) -> Arrows {
    let all: Vec<_> = arrows.keys().cloned().collect();
    arrows.retain(|(from, to), _| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![to]);
        while let Some(at) = open.pop() {
            let next = all.iter().filter(|(from, _)| from == at);
            open.extend(next.map(|(_, to)| to).filter(|to| seen.insert(*to)));
        }
        seen.contains(from)
    });
    arrows
}

#[test]
fn modules_beside_each_other_form_no_circle() {
    let root = workspace_root();
    let mut known: BTreeSet<_> = KNOWN.iter().map(|arrow| (*arrow).to_owned()).collect();
    let mut crates = files(&root.join("crates")).unwrap();
    crates.push(root.join("xtask"));
    let mut found = String::new();
    for source in crates.iter().map(|path| path.join("src")) {
        let inside = source
            .strip_prefix(root)
            .unwrap()
            .to_string_lossy()
            .into_owned();
        for (above, arrows) in Modules::below(&source).arrows() {
            let place = [inside.as_str(), &above.join("/")].join("/");
            let place = place.trim_end_matches('/');
            let mut arrows = on_circles(arrows);
            arrows.retain(|(from, to), _| !known.remove(&format!("{place}: {from} -> {to}")));
            for why in on_circles(arrows).values() {
                found += &format!("{place}: {why}\n");
            }
        }
    }
    assert!(found.is_empty(), "arrows on circles of modules:\n{found}");
    assert!(
        known.is_empty(),
        "no longer on any circle, remove them from the list: {known:?}"
    );
}

#[test]
fn a_circle_is_found_through_what_hides_it() {
    let of = |sources: &[(&[&str], &str)]| {
        let module = |(names, source): &(&[&str], &str)| {
            (
                names.iter().map(|name| (*name).to_owned()).collect(),
                Module::of(source),
            )
        };
        let arrows = Modules(sources.iter().map(module).collect()).arrows();
        let circles = arrows.into_values().flat_map(on_circles);
        circles.map(|(_, why)| why).collect::<Vec<_>>()
    };
    let facade = "mod inner; pub use inner::{Deep as Renamed, Other}; pub struct Own;";
    let lib: &[&str] = &[];
    let found = of(&[
        (lib, "mod a; mod b;"),
        (&["a"], facade),
        (
            &["a", "inner"],
            "use super::Own; use crate::b::{self, Thing}; pub struct Deep; pub struct Other;",
        ),
        (
            &["b"],
            "/// crate::c::X\npub struct Thing; fn f(_: crate::a::Renamed) {}",
        ),
    ]);
    assert_eq!(
        found,
        ["a::inner uses Thing of b", "b uses Renamed of a::inner"]
    );
    // no circle: a module and its part, an unused re-export, a name in a comment, and a name in a
    // test
    let none = of(&[
        (lib, "mod a; mod b;"),
        (
            &["a"],
            "mod inner; pub use crate::b::Thing; use inner::Deep; pub struct Own(Deep);",
        ),
        (&["a", "inner"], "use super::Own; pub struct Deep;"),
        (
            &["b"],
            "// crate::a::Own\npub struct Thing;\n#[cfg(test)]\nmod tests {\n    use crate::a::Own;\n}",
        ),
    ]);
    assert!(none.is_empty(), "{none:?}");
}
