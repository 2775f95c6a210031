//! `cargo xtask doc`: the pages of rustdoc, with equations as MathML and with links into the book.
//!
//! In the source, an equation is `` $`x`$ `` or a `math` fence, and a page of the book is a path in
//! code. rustdoc takes both for code. The task replaces them in the output of rustdoc; a second run
//! changes nothing.

use std::path::Path;

use super::math;
use super::page::Equation;
use super::source::crates;
use crate::Outcome;
use crate::cargo::cargo;
use crate::files::{files_below, read};
use testbed::generated::{workspace_root, write_whole};

const FENCE: (&str, &str) = (
    "<div class=\"example-wrap\"><pre class=\"language-math\"><code>",
    "</code></pre></div>",
);
const INLINE: (&str, &str) = ("$<code>", "</code>$");
const PAGE: (&str, &str) = ("<code>docs/", "</code>");

/// Runs `cargo doc` and rewrites its pages.
pub(crate) fn run() -> Outcome {
    let root = workspace_root();
    let status = cargo()
        .args(["doc", "--locked", "--workspace", "--no-deps"])
        .current_dir(root)
        .status()?;
    if !status.success() {
        return Err(format!("cargo doc ended with {status}").into());
    }
    let folder = root.join("target").join("doc");
    let book = root.join("target").join("book");
    let style = style(root)?;
    let mut changed = 0;
    let mut files = Vec::new();
    for one in crates(root)? {
        // the folder may contain pages of other libraries, with formulas in another notation
        let pages = folder.join(&one.name);
        if pages.exists() {
            files.extend(files_below(&pages, "html")?);
        }
    }
    for file in files {
        let html = read(&file)?;
        let depth = file
            .strip_prefix(&folder)
            .unwrap_or(&file)
            .components()
            .count();
        let set =
            set(&html, depth, &book).map_err(|reason| format!("{}: {reason}", file.display()))?;
        if set != html {
            write_whole(
                &file,
                &set.replacen("</head>", &format!("{style}</head>"), 1),
            )?;
            changed += 1;
        }
    }
    println!("{changed} pages of {} rewritten", folder.display());
    Ok(())
}

/// Returns the style of equations in the book, for use in a page of rustdoc.
fn style(root: &Path) -> Outcome<String> {
    let css = read(&root.join("docs").join("book.css"))?;
    // the rules after this comment are for the tables of the book
    let equations = css.split("/* Tables").next().unwrap_or_default();
    Ok(format!("<style>{equations}</style>"))
}

/// Returns a page with its equations converted and with links to the pages of `book`. The page is
/// `depth` folders below the folder that also contains `book`.
fn set(html: &str, depth: usize, book: &Path) -> Result<String, String> {
    let fences = replaced(html, FENCE, |tex| equation(tex, true))?;
    let formulas = replaced(&fences, INLINE, |tex| equation(tex, false))?;
    replaced(&formulas, PAGE, |name| {
        let (page, anchor) = name.split_once('#').unwrap_or((name, ""));
        let target = page.strip_suffix(".md").map(|page| format!("{page}.html"));
        Ok(match target {
            Some(target) if book.join(&target).exists() => {
                let up = "../".repeat(depth);
                let anchor = if anchor.is_empty() {
                    String::new()
                } else {
                    format!("#{anchor}")
                };
                Some(format!(
                    "<a href=\"{up}book/{target}{anchor}\"><code>docs/{name}</code></a>"
                ))
            }
            _ => None,
        })
    })
}

fn equation(tex: &str, display: bool) -> Result<Option<String>, String> {
    let equation = Equation {
        tex: tex
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&quot;", "\"")
            .replace("&#39;", "'")
            .replace("&amp;", "&"),
        display,
        span: 0..0,
        line: 0,
    };
    math::of(&equation).map(Some)
}

/// Replaces each text between the marks `open` and `close`, including the marks, by the result of
/// `by`. A text for which `by` returns `None` is unchanged.
fn replaced(
    html: &str,
    (open, close): (&str, &str),
    by: impl Fn(&str) -> Result<Option<String>, String>,
) -> Result<String, String> {
    let mut out = String::with_capacity(html.len());
    let mut rest = html;
    while let Some((before, behind)) = rest.split_once(open) {
        let Some((inner, after)) = behind.split_once(close) else {
            break;
        };
        out.push_str(before);
        // text directly after a tag with attributes is a link made by an earlier run
        let new = if inner.contains('<') || (open == PAGE.0 && before.ends_with("\">")) {
            None
        } else {
            by(inner)?
        };
        match new {
            Some(new) => {
                out.push_str(&new);
                rest = after;
            }
            None => {
                out.push_str(open);
                rest = behind;
            }
        }
    }
    out.push_str(rest);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn equations_are_set_once_and_pages_of_the_book_become_links() {
        let book = tempfile::tempdir().unwrap();
        fs::create_dir(book.path().join("theory")).unwrap();
        fs::write(book.path().join("theory/rods.html"), "").unwrap();
        let html = "<p>With $<code>a &lt; b</code>$, <code>x</code>; Theory: <code>docs/theory/rods.md#ends</code>, \
                    <code>docs/theory/none.md</code>.</p><div class=\"example-wrap\"><pre class=\"language-math\"><code>x^2 = 1\n\
                    </code></pre></div>";
        let once = set(html, 2, book.path()).unwrap();
        assert_eq!(once.matches("<math").count(), 2, "{once}");
        assert!(
            once.contains("&lt;") && once.contains("<code>x</code>"),
            "{once}"
        );
        assert!(
            once.contains("href=\"../../book/theory/rods.html#ends\""),
            "{once}"
        );
        assert!(!once.contains("none.html"), "{once}");
        assert_eq!(set(&once, 2, book.path()).unwrap(), once);
    }

    #[test]
    fn a_formula_that_cannot_be_set_is_named() {
        let error = set("$<code>\\nonsense</code>$", 1, Path::new("nowhere")).unwrap_err();
        assert!(error.contains("nonsense"), "{error}");
    }
}
