//! Changes to the text of a sheet that leave the rest of the text, including comments, as it is.

use std::ops::Range;

use super::language::Language;
use super::tree::{self, Entry, Node, Value};
use super::without_mark;

/// A value without parts, with its place in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Leaf {
    /// Place in the sheet, such as `specimen.length`.
    pub(crate) name: String,
    /// Range of bytes in the text, including quotes.
    pub(crate) place: Range<usize>,
}

/// Returns the values of a sheet that have no parts, in the order of the text; none if the text
/// cannot be parsed.
pub(crate) fn leaves(text: &str) -> Vec<Leaf> {
    let bare = without_mark(text);
    let mut leaves = Vec::new();
    if let Ok((_, root)) = tree::of(bare) {
        gather(&root, String::new(), &mut leaves);
    }
    let mark = text.len() - bare.len();
    for leaf in &mut leaves {
        leaf.place = leaf.place.start + mark..leaf.place.end + mark;
    }
    leaves.sort_by_key(|leaf| leaf.place.start);
    leaves
}

fn gather(node: &Node, name: String, leaves: &mut Vec<Leaf>) {
    let within = |part: &str| match name.as_str() {
        "" => part.to_owned(),
        name => format!("{name}.{part}"),
    };
    match &node.value {
        Value::List(nodes) => {
            for (index, node) in nodes.iter().enumerate() {
                gather(node, format!("{name}[{index}]"), leaves);
            }
        }
        Value::Table(entries) => {
            for entry in entries {
                gather(&entry.node, within(&entry.name), leaves);
            }
        }
        Value::Choice(choice) => {
            if let Some(content) = &choice.content {
                gather(content, name, leaves);
            }
        }
        _ => leaves.push(Leaf {
            name,
            place: node.place.clone(),
        }),
    }
}

/// Decision on a hit by hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ruling {
    Accept,
    Reject,
    /// No decision by hand; the criteria decide.
    Criteria,
}

/// Names of the two lists of decisions among the hits of a sheet.
const LISTS: [(&str, Ruling); 2] = [("reject", Ruling::Reject), ("accept", Ruling::Accept)];

/// Returns the path of the hits in a sheet, which depends on the job.
fn place_of_hits(root: &Node) -> Option<&'static [&'static str]> {
    let Value::Choice(job) = &root.value else {
        return None;
    };
    match job.name.to_ascii_lowercase().as_str() {
        "frf" => Some(&["hits"]),
        "modulus" | "mobility" => Some(&["source", "hits", "hits"]),
        "force" => Some(&["problem", "response", "path", "hits"]),
        _ => None,
    }
}

/// Returns the text of a sheet with the decision `ruling` on hit `hit`, which replaces an earlier
/// decision on this hit.
///
/// # Errors
///
/// A sentence that states what to write by hand, if the text has no place for the decision.
pub(crate) fn ruled(text: &str, hit: usize, ruling: Ruling) -> Result<String, String> {
    let by_hand = || {
        format!(
            "this sheet has no place for a decision on hit {hit}: state `reject` or `accept` among its hits by hand"
        )
    };
    let path = tree::of(without_mark(text))
        .ok()
        .and_then(|(_, root)| place_of_hits(&root));
    let path = path.ok_or_else(by_hand)?;
    let cleared = without_rulings(text, path, hit).ok_or_else(by_hand)?;
    let Some((list, _)) = LISTS.into_iter().find(|(_, of)| *of == ruling) else {
        return Ok(cleared);
    };
    let changed = with_ruling(&cleared, path, list, hit).ok_or_else(by_hand)?;
    // reads the decision back, because it may be in a place where it has no effect
    if rulings(&changed, path, list).is_some_and(|hits| hits.contains(&hit)) {
        Ok(changed)
    } else {
        Err(by_hand())
    }
}

/// Returns the numbers of the hits on a list.
fn rulings(text: &str, path: &[&str], list: &str) -> Option<Vec<usize>> {
    let (_, root) = tree::of(without_mark(text)).ok()?;
    let entry = follow(&root, path).ok()?.entry(list)?;
    let Value::List(elements) = &entry.node.value else {
        return None;
    };
    Some(elements.iter().filter_map(hit_of).collect())
}

/// Returns the text without decisions on `hit`; `None` if the text is not a sheet.
fn without_rulings(text: &str, path: &[&str], hit: usize) -> Option<String> {
    let bare = without_mark(text);
    let (_, root) = tree::of(bare).ok()?;
    let Ok(hits) = follow(&root, path) else {
        return Some(text.to_owned());
    };
    let mut gone = Vec::new();
    for (name, _) in LISTS {
        let Some(Value::List(elements)) = hits.entry(name).map(|entry| &entry.node.value) else {
            continue;
        };
        for (index, element) in elements.iter().enumerate() {
            if hit_of(element) != Some(hit) {
                continue;
            }
            // the element is removed together with the comma between it and a neighbour
            let before = index.checked_sub(1).and_then(|index| elements.get(index));
            gone.push(match (before, elements.get(index + 1)) {
                (Some(before), _) => before.place.end..element.place.end,
                (None, Some(after)) => element.place.start..after.place.start,
                (None, None) => element.place.clone(),
            });
        }
    }
    gone.sort_by_key(|place| place.start);
    let mut changed = bare.to_owned();
    for place in gone.into_iter().rev() {
        changed.replace_range(place, "");
    }
    Some(with_mark_of(text, &changed))
}

/// Returns the text with `hit` on `list`.
fn with_ruling(text: &str, path: &[&str], list: &str, hit: usize) -> Option<String> {
    let bare = without_mark(text);
    let (language, root) = tree::of(bare).ok()?;
    let because = "judged by eye";
    let element = match language {
        Language::Toml => format!("{{ hit = {hit}, because = \"{because}\" }}"),
        Language::Ron => format!("(hit: {hit}, because: \"{because}\")"),
        Language::Json => format!("{{\"hit\": {hit}, \"because\": \"{because}\"}}"),
    };
    let field = |name: &str, value: &str| match language {
        Language::Toml => format!("{name} = {value}"),
        Language::Ron => format!("{name}: {value}"),
        Language::Json => format!("\"{name}\": {value}"),
    };
    let stated = field(list, &format!("[{element}]"));
    let (at, words) = match follow(&root, path) {
        Ok(hits) => match hits.entry(list).map(|entry| &entry.node) {
            Some(node) => {
                let Value::List(elements) = &node.value else {
                    return None;
                };
                match elements.last() {
                    Some(last) => (last.place.end, format!(", {element}")),
                    None => (node.place.start + 1, element),
                }
            }
            None => inserted(bare, hits, &stated)?,
        },
        // in TOML the missing tables are appended; in the other languages only `hits` can be
        // inserted in its parent
        Err(_) if language == Language::Toml => {
            let gap = if bare.ends_with('\n') { "" } else { "\n" };
            (
                bare.len(),
                format!("{gap}\n[{}]\n{stated}\n", path.join(".")),
            )
        }
        Err((parent, [hits])) => {
            let (open, close) = match language {
                Language::Json => ('{', '}'),
                _ => ('(', ')'),
            };
            inserted(
                bare,
                parent,
                &field(hits, &format!("{open}{stated}{close}")),
            )?
        }
        Err(_) => return None,
    };
    let mut changed = bare.to_owned();
    changed.insert_str(at, &words);
    Some(with_mark_of(text, &changed))
}

/// Returns the place and the text that add the field `stated` to a table.
fn inserted(text: &str, table: &Node, stated: &str) -> Option<(usize, String)> {
    let Value::Table(entries) = &table.value else {
        return None;
    };
    let rest = text.get(table.place.start..)?;
    if rest.starts_with(['{', '(']) {
        let more = if entries.is_empty() { "" } else { ", " };
        return Some((table.place.start + 1, format!("{stated}{more}")));
    }
    // for a table under a header, a new line is inserted above the first field that begins a line
    entries.iter().find_map(|Entry { name_place, .. }| {
        let line = text
            .get(..name_place.start)?
            .rfind('\n')
            .map_or(0, |at| at + 1);
        let indent = text.get(line..name_place.start)?;
        indent
            .trim()
            .is_empty()
            .then(|| (line, format!("{indent}{stated}\n")))
    })
}

/// Returns the number of the hit that an element of a list names.
fn hit_of(element: &Node) -> Option<usize> {
    match element.entry("hit")?.node.value {
        Value::Integer(hit) => usize::try_from(hit).ok(),
        _ => None,
    }
}

/// Returns the part of the sheet at `path`, or the last existing part on the way together with the
/// rest of `path` that is missing.
fn follow<'n, 'p>(
    root: &'n Node,
    path: &'p [&'p str],
) -> Result<&'n Node, (&'n Node, &'p [&'p str])> {
    let mut node = root.content();
    let mut rest = path;
    while let [part, below @ ..] = rest {
        let next = match &node.value {
            Value::Choice(choice) if choice.name.eq_ignore_ascii_case(part) => {
                choice.content.as_deref()
            }
            _ => node.entry(part).map(|entry| &entry.node),
        };
        let Some(next) = next else {
            return Err((node, rest));
        };
        (node, rest) = (next, below);
    }
    Ok(node)
}

impl Node {
    /// Returns the settings of a sheet that is the choice of its job; any other node unchanged.
    fn content(&self) -> &Self {
        match &self.value {
            Value::Choice(choice) => choice.content.as_deref().unwrap_or(self),
            _ => self,
        }
    }

    /// Returns the field `name` of a table.
    fn entry(&self, name: &str) -> Option<&Entry> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.name == name),
            _ => None,
        }
    }
}

fn with_mark_of(text: &str, changed: &str) -> String {
    let mark = &text[..text.len() - without_mark(text).len()];
    format!("{mark}{changed}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOML: &str = "# my rod\njob = \"modulus\"\n\n[specimen]\nlength = \"799 mm ± 0.3 mm\" # ruler\n\n[source.hits.records]\nfiles = [\"a.npy\"]\n\n[source.hits.hits]\ncut = { trigger = { level = \"2000 m/s2\" } }\n";

    #[test]
    fn values_have_the_places_of_their_text() {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}{TOML}");
            let found: Vec<(String, &str)> = leaves(&text)
                .into_iter()
                .map(|leaf| (leaf.name, &text[leaf.place]))
                .collect();
            let of = |name: &str| {
                found
                    .iter()
                    .find(|(of, _)| of == name)
                    .map(|(_, text)| *text)
            };
            assert_eq!(of("specimen.length"), Some("\"799 mm ± 0.3 mm\""));
            assert_eq!(of("source.hits.records.files[0]"), Some("\"a.npy\""));
            assert_eq!(
                of("source.hits.hits.cut.trigger.level"),
                Some("\"2000 m/s2\"")
            );
        }
        assert!(leaves("no sheet").is_empty());
    }

    /// Every decision can be read back, replaces an earlier decision, and leaves the rest of the
    /// text unchanged.
    #[test]
    fn decisions_on_hits_leave_the_rest_of_the_sheet() {
        let ron = "Modulus(\n    // my rod\n    source: Hits(records: (files: [\"a.npy\"]), hits: (channel: \"x\")),\n)";
        let without = "Modulus(source: Hits(records: (files: [\"a.npy\"])))";
        let json = "{\"job\": \"frf\", \"hits\": {}}";
        let bare = "job = \"frf\"\n[records]\nfiles = [\"a.npy\"]";
        let cases = [TOML, ron, without, json, bare];
        for text in cases {
            let path = place_of_hits(&tree::of(text).unwrap().1).unwrap();
            let on = |text: &str, list| rulings(text, path, list).unwrap_or_default();
            let one = ruled(text, 3, Ruling::Reject).unwrap();
            assert_eq!(on(&one, "reject"), [3], "{one}");
            let two = ruled(&one, 5, Ruling::Reject).unwrap();
            let two = ruled(&two, 7, Ruling::Reject).unwrap();
            assert_eq!(on(&two, "reject"), [3, 5, 7], "{two}");
            let turned = ruled(&two, 3, Ruling::Accept).unwrap();
            assert_eq!(
                (on(&turned, "reject"), on(&turned, "accept")),
                (vec![5, 7], vec![3])
            );
            let last = ruled(&turned, 7, Ruling::Criteria).unwrap();
            assert_eq!(
                (on(&last, "reject"), on(&last, "accept")),
                (vec![5], vec![3]),
                "{last}"
            );
            // all values of the earlier text are unchanged
            let kept = leaves(text)
                .iter()
                .all(|leaf| last.contains(&text[leaf.place.clone()]));
            assert!(
                kept && last.contains("# my rod") == text.contains("# my rod"),
                "{last}"
            );
        }
        let none = ruled("job = \"recovery\"\n", 1, Ruling::Reject);
        assert!(none.unwrap_err().contains("by hand"));
    }
}
