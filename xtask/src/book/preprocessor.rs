//! Program that mdBook calls after it has read the pages and before it writes them. Equations
//! become MathML; links that lead out of the book, to source files, become plain text.
//!
//! mdBook first calls `book-equations supports html` for an exit status, and then sends
//! `[context, book]` as JSON and expects the book back. Only `content` of the chapters is changed;
//! other members may therefore be added or removed in later versions.

use std::io::{self, Read, Write};
use std::path::Path;

use serde_json::Value;

use super::math;
use super::page::{Page, normal};
use crate::Outcome;

pub(crate) fn run(supports: Option<&str>) -> Outcome {
    if let Some(renderer) = supports {
        // MathML is part of HTML, but of no other output of mdBook
        return if renderer == "html" {
            Ok(())
        } else {
            Err(format!("equations are for html, not for {renderer}").into())
        };
    }
    let mut input = String::new();
    io::stdin().read_to_string(&mut input)?;
    let (_context, book): (Value, Value) = serde_json::from_str(&input)?;
    let book = with_equations(book)?;
    io::stdout().write_all(serde_json::to_string(&book)?.as_bytes())?;
    Ok(())
}

/// Replaces the equations in every chapter of `value`.
fn with_equations(value: Value) -> Result<Value, String> {
    Ok(match value {
        Value::Array(items) => Value::Array(
            items
                .into_iter()
                .map(with_equations)
                .collect::<Result<_, _>>()?,
        ),
        Value::Object(mut members) => {
            let name = members
                .get("name")
                .and_then(Value::as_str)
                .unwrap_or("a chapter without a name")
                .to_owned();
            let path = members
                .get("path")
                .and_then(Value::as_str)
                .unwrap_or_default()
                .to_owned();
            if let Some(Value::String(content)) = members.get_mut("content") {
                *content = page_within_the_book(content, Path::new(&path));
                *content = page_with_equations(content)
                    .map_err(|(line, error)| format!("{name}, line {line}: {error}"))?;
            }
            Value::Object(
                members
                    .into_iter()
                    .map(|(key, member)| Ok((key, with_equations(member)?)))
                    .collect::<Result<_, String>>()?,
            )
        }
        other => other,
    })
}

/// Returns the source of the page at `path`; every link that leads out of the book is replaced by
/// its text.
fn page_within_the_book(source: &str, path: &Path) -> String {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut out = String::with_capacity(source.len());
    let mut done = 0;
    for link in Page::read(source).links {
        let target = link.target.split('#').next().unwrap_or_default();
        let text = &source[link.span.clone()];
        let leads_out = !link.picture && normal(&folder.join(target)).is_none();
        if let (true, Some(end)) = (leads_out && text.starts_with('['), text.rfind("](")) {
            out.push_str(&source[done..link.span.start]);
            out.push_str(&text[1..end]);
            done = link.span.end;
        }
    }
    out.push_str(&source[done..]);
    out
}

/// Returns the source of a page with its formulas converted to MathML.
fn page_with_equations(source: &str) -> Result<String, (usize, String)> {
    let mut out = String::with_capacity(2 * source.len());
    let mut done = 0;
    for equation in Page::read(source).equations {
        let html = math::of(&equation).map_err(|error| (equation.line, error))?;
        out.push_str(&source[done..equation.span.start]);
        if equation.display {
            // a block of HTML continues to the next blank line
            out.push('\n');
            out.push_str(&html);
            out.push_str("\n\n");
        } else {
            out.push_str(&html);
        }
        done = equation.span.end;
    }
    out.push_str(&source[done..]);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chapters_at_any_depth_are_reached_and_the_rest_stays() {
        let book = serde_json::json!({
            "items": [
                {"PartTitle": "Forward $`x`$"},
                {"Chapter": {"name": "Rods", "content": "with $`x^2`$\n", "sub_items": [
                    {"Chapter": {"name": "Cones", "content": "```math\ny\n\\tag{1}\n```\n", "sub_items": []}}
                ]}},
            ],
            "other": 1,
        });
        let book = with_equations(book).unwrap();
        let rods = &book["items"][1]["Chapter"];
        assert!(rods["content"].as_str().unwrap().contains("<math"));
        let cones = rods["sub_items"][0]["Chapter"]["content"].as_str().unwrap();
        assert!(cones.contains("class=\"equation\"") && !cones.contains("```"));
        assert_eq!(book["items"][0]["PartTitle"], "Forward $`x`$");
        assert_eq!(book["other"], 1);
    }

    #[test]
    fn a_link_out_of_the_book_becomes_its_text() {
        let page =
            "[`Rod`](../../src/rod.rs#L3), [stays](../a.md), [web](https://a.b), ![p](../../p.svg)";
        assert_eq!(
            page_within_the_book(page, Path::new("theory/rods.md")),
            "`Rod`, [stays](../a.md), [web](https://a.b), ![p](../../p.svg)"
        );
        assert_eq!(page_within_the_book("[x](../y)", Path::new("page.md")), "x");
    }

    #[test]
    fn an_equation_that_cannot_be_set_is_named_with_its_chapter_and_line() {
        let book = serde_json::json!({"name": "Rods", "content": "text\n\n$`\\nonsense`$\n"});
        let error = with_equations(book).unwrap_err();
        assert!(error.starts_with("Rods, line 3: "), "{error}");
    }
}
