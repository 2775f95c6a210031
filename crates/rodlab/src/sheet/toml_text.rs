//! Conversion of a sheet to text in TOML.

use std::fmt::Write as _;

use super::language::snake_case;
use super::tree::{Choice, Entry, JOB, Node, Value};

/// Maximum length of a line with a whole table or a whole list, in characters.
const LONGEST_LINE: usize = 120;

/// Maximum number of values of a table that is written on the line of its name.
const VALUES_ON_A_LINE: usize = 2;

/// Returns the text of the sheet `root`, which was read from `source` in RON. Comments above and
/// after a field stay with the field.
pub(super) fn of(source: &str, root: &Node) -> String {
    let mut written = Written {
        source,
        text: String::new(),
    };
    match &root.value {
        Value::Choice(Choice {
            name,
            name_place,
            content,
        }) => {
            written.comments_above(name_place.start);
            written.line(&format!("{JOB} = {}", quoted(&snake_case(name))));
            if let Some(content) = content {
                written.table("", &fields_of(content), None);
            }
        }
        _ => written.table("", &fields_of(root), None),
    }
    written.text
}

/// A name with its value, and the place of the name in the source.
#[derive(Clone)]
struct Field<'a> {
    name: String,
    start: usize,
    node: &'a Node,
}

/// Returns the fields of a value in TOML: the fields of a table, or the name of a choice with its
/// settings.
fn fields_of(node: &Node) -> Vec<Field<'_>> {
    match &node.value {
        Value::Table(entries) => {
            let stated = entries
                .iter()
                .filter(|entry| !matches!(entry.node.value, Value::Nothing));
            stated
                .map(
                    |Entry {
                         name,
                         name_place,
                         node,
                     }| Field {
                        name: name.clone(),
                        start: name_place.start,
                        node,
                    },
                )
                .collect()
        }
        Value::Choice(Choice {
            name,
            name_place,
            content: Some(content),
        }) => vec![Field {
            name: snake_case(name),
            start: name_place.start,
            node: content,
        }],
        _ => Vec::new(),
    }
}

/// Returns true for a table, and for a choice with settings.
fn has_fields(node: &Node) -> bool {
    match &node.value {
        Value::Table(_) => true,
        Value::Choice(choice) => choice.content.is_some(),
        _ => false,
    }
}

struct Written<'a> {
    source: &'a str,
    text: String,
}

impl Written<'_> {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// Writes the comment lines directly above the place `start`, if only white space precedes
    /// `start` on its line.
    fn comments_above(&mut self, start: usize) {
        let before = self.source.get(..start).unwrap_or_default();
        let mut lines = before.rsplit('\n');
        if lines.next().is_none_or(|line| !line.trim().is_empty()) {
            return;
        }
        let comments: Vec<&str> = lines
            .map_while(|line| line.trim().strip_prefix("//"))
            .collect();
        for comment in comments.iter().rev() {
            self.line(&format!("#{comment}"));
        }
    }

    /// Returns the comment after a value on the last line of the value, preceded by spaces; empty
    /// if there is none.
    fn comment_behind(&self, node: &Node) -> String {
        let behind = self.source.get(node.place.end..).unwrap_or_default();
        let line = behind.lines().next().unwrap_or_default();
        let comment = line.trim_start_matches([',', ' ', ')']).strip_prefix("//");
        comment
            .map(|comment| format!("  #{comment}"))
            .unwrap_or_default()
    }

    /// Writes the fields of the table `path`: first the fields that fit on one line, then tables
    /// under headers of their own. `above` is the place of the name of a table whose header was
    /// left out; the comments above this name are written above the next header.
    fn table(&mut self, path: &str, fields: &[Field<'_>], mut above: Option<usize>) {
        let mut below = Vec::new();
        for field in fields {
            if let Some(line) = self.on_a_line(field) {
                self.comments_above(field.start);
                let comment = self.comment_behind(field.node);
                self.line(&format!("{line}{comment}"));
            } else {
                below.push(field);
            }
        }
        for Field { name, start, node } in below {
            let path = if path.is_empty() {
                key(name)
            } else {
                format!("{path}.{}", key(name))
            };
            if let Value::List(nodes) = &node.value {
                for (number, node) in nodes.iter().enumerate() {
                    self.text.push('\n');
                    if number == 0 {
                        let starts = above.take().into_iter().chain([*start]);
                        starts.for_each(|start| self.comments_above(start));
                    }
                    self.line(&format!("[[{path}]]"));
                    self.table(&path, &fields_of(node), None);
                }
                continue;
            }
            let fields = fields_of(node);
            // a table that contains only tables needs no header
            if fields.is_empty() || fields.iter().any(|field| self.on_a_line(field).is_some()) {
                self.text.push('\n');
                let starts = above.take().into_iter().chain([*start]);
                starts.for_each(|start| self.comments_above(start));
                self.line(&format!("[{path}]"));
                self.table(&path, &fields, None);
            } else {
                self.table(&path, &fields, above.take().or(Some(*start)));
            }
        }
    }

    /// Returns `name = value` for a value without tables, and for short tables without comments. A
    /// list of short tables has one line per table. Returns `None` for other values.
    fn on_a_line(&self, field: &Field<'_>) -> Option<String> {
        let line = format!("{} = {}", key(&field.name), inline(field.node));
        let has_comments = || {
            self.source
                .get(field.node.place.clone())
                .is_some_and(|text| text.contains("//"))
        };
        match &field.node.value {
            _ if has_fields(field.node) => {
                let is_short = line.chars().count() <= LONGEST_LINE
                    && values_of(field.node) <= VALUES_ON_A_LINE;
                (is_short && !has_comments()).then_some(line)
            }
            Value::List(nodes) => {
                if nodes.is_empty() || !nodes.iter().all(has_fields) {
                    return Some(line);
                }
                let lines: Vec<String> = nodes
                    .iter()
                    .map(|node| format!("    {},\n", inline(node)))
                    .collect();
                let is_short = lines
                    .iter()
                    .all(|line| line.chars().count() <= LONGEST_LINE);
                (is_short && !has_comments())
                    .then(|| format!("{} = [\n{}]", key(&field.name), lines.concat()))
            }
            _ => Some(line),
        }
    }
}

/// Number of values in a node, including those of nested tables and lists.
fn values_of(node: &Node) -> usize {
    match &node.value {
        Value::List(nodes) => nodes.iter().map(values_of).sum(),
        _ if has_fields(node) => fields_of(node)
            .iter()
            .map(|field| values_of(field.node))
            .sum(),
        _ => 1,
    }
}

/// Returns the value as text on one line.
fn inline(node: &Node) -> String {
    match &node.value {
        Value::Nothing => quoted("none"),
        Value::Bool(value) => value.to_string(),
        Value::Integer(number) => number.to_string(),
        Value::Unsigned(number) => number.to_string(),
        Value::Float(number) => format!("{number:?}"),
        Value::Text(text) => quoted(text),
        Value::List(nodes) => {
            let values: Vec<String> = nodes.iter().map(inline).collect();
            format!("[{}]", values.join(", "))
        }
        Value::Choice(Choice {
            name,
            content: None,
            ..
        }) => quoted(&snake_case(name)),
        Value::Table(_) | Value::Choice(_) => {
            let fields = fields_of(node);
            let fields: Vec<String> = fields
                .iter()
                .map(|field| format!("{} = {}", key(&field.name), inline(field.node)))
                .collect();
            if fields.is_empty() {
                "{}".to_owned()
            } else {
                format!("{{ {} }}", fields.join(", "))
            }
        }
    }
}

fn key(name: &str) -> String {
    let is_bare = !name.is_empty()
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
    if is_bare {
        name.to_owned()
    } else {
        quoted(name)
    }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            letter if letter.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(letter));
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}
