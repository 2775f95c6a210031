//! Place of a citation: whether it is in an implementation, a proof or a reproduction, and in which
//! item of the source.

/// Meaning of a citation for the cited item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    Implemented,
    Proved,
    Reproduced,
}

/// Item of a source file that contains a citation.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    pub(crate) role: Role,
    pub(crate) file: String,
    /// `Type::method` or `function`; the name of the module if the citation is in the documentation
    /// of the module.
    pub(crate) item: String,
}

/// Returns the place of line `number` of `file`, counted from 1; `None` if the file is not a source
/// of a crate or of a reproduction.
pub(crate) fn of(file: &str, text: &str, number: usize) -> Option<Place> {
    let lines: Vec<&str> = text.lines().collect();
    let at = number.checked_sub(1).filter(|at| *at < lines.len())?;
    let role = role(file, &lines[..=at])?;
    Some(Place {
        role,
        file: file.to_owned(),
        item: item(&lines, at).unwrap_or_else(|| module(file)),
    })
}

fn role(file: &str, before: &[&str]) -> Option<Role> {
    if !file.ends_with(".rs") {
        return None;
    }
    if file.starts_with("xtask/src/reproduce") {
        return Some(Role::Reproduced);
    }
    let (_, inside) = file.strip_prefix("crates/")?.split_once('/')?;
    match inside.split('/').next()? {
        "tests" => Some(Role::Proved),
        "src" if before.contains(&"#[cfg(test)]") => Some(Role::Proved),
        "src" => Some(Role::Implemented),
        _ => None,
    }
}

/// Returns the item to which the documentation in line `at` belongs, or whose body contains the
/// line.
fn item(lines: &[&str], at: usize) -> Option<String> {
    if lines[at].trim_start().starts_with("//!") {
        return None;
    }
    let is_aside = |line: &&str| {
        let line = line.trim_start();
        line.is_empty() || line.starts_with("//") || line.starts_with("#[")
    };
    let below = (at..lines.len()).find(|&line| !is_aside(&lines[line]))?;
    let (start, name) = match declared(lines[below]) {
        Some(name) if is_aside(&lines[at]) || below == at => (below, name),
        _ => above(lines, at, indentation(lines[at]))?,
    };
    let method = lines[start].trim_start().contains("fn ") && indentation(lines[start]) > 0;
    match above(lines, start, indentation(lines[start])).filter(|_| method) {
        Some((_, outer)) if outer != "tests" => Some(format!("{outer}::{name}")),
        _ => Some(name),
    }
}

/// Returns the nearest declaration above line `at` whose indentation is less than `than`.
fn above(lines: &[&str], at: usize, than: usize) -> Option<(usize, String)> {
    (0..at)
        .rev()
        .filter(|&line| indentation(lines[line]) < than.max(1))
        .find_map(|line| declared(lines[line]).map(|name| (line, name)))
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// Returns the name that a line declares; for an implementation, the name of the type.
fn declared(line: &str) -> Option<String> {
    let mut words = line
        .split_whitespace()
        .skip_while(|word| word.starts_with("pub") || ["async", "unsafe", "crate)"].contains(word));
    let mut kind = words.next()?;
    let mut name = words.next()?;
    if kind == "const" && name == "fn" {
        kind = name;
        name = words.next()?;
    }
    if kind.starts_with("impl") {
        let rest: Vec<&str> = line.split_whitespace().collect();
        let named = rest.iter().position(|word| *word == "for").map_or_else(
            || rest.iter().find(|word| !word.starts_with("impl")),
            |of| rest.get(of + 1),
        );
        name = named?;
    } else if ![
        "fn", "struct", "enum", "trait", "const", "static", "type", "mod",
    ]
    .contains(&kind)
    {
        return None;
    }
    let end = name.find(|c: char| !c.is_alphanumeric() && c != '_');
    let name = &name[..end.unwrap_or(name.len())];
    (!name.is_empty()).then(|| name.to_owned())
}

fn module(file: &str) -> String {
    let path = file.trim_end_matches("/mod.rs").trim_end_matches(".rs");
    path.rsplit('/').next().unwrap_or(path).to_owned()
}
