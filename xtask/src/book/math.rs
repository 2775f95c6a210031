//! Equations of a page, converted from TeX to MathML: a browser then needs neither a script nor a
//! network.

use std::fmt::Write as _;

use pulldown_latex::config::DisplayMode;
use pulldown_latex::mathml::push_mathml;
use pulldown_latex::{Parser, RenderConfig, Storage};

use super::page::Equation;

/// Splits `\tag{number}` off an equation. Returns the remaining equation and the number.
pub(super) fn split_tag(tex: &str) -> Result<(String, Option<String>), String> {
    let Some((before, behind)) = tex.split_once("\\tag{") else {
        return Ok((tex.to_owned(), None));
    };
    let Some((number, after)) = behind.split_once('}') else {
        return Err(format!(
            "\\tag without a closing brace in `{}`",
            one_line(tex)
        ));
    };
    Ok((format!("{before}{after}"), Some(number.to_owned())))
}

/// Returns the HTML of an equation.
pub(super) fn of(equation: &Equation) -> Result<String, String> {
    if equation.display {
        display(&equation.tex)
    } else {
        inline(&equation.tex)
    }
}

/// Converts a formula within a sentence. Characters that have a meaning in Markdown become
/// entities.
fn inline(tex: &str) -> Result<String, String> {
    if tex.contains("\\tag") {
        let tex = one_line(tex);
        return Err(format!(
            "`{tex}` has \\tag, but an inline formula cannot have a number"
        ));
    }
    Ok(guard_from_markdown(&mathml(tex, DisplayMode::Inline)?))
}

/// Converts an equation in its own paragraph, with its number at the right.
fn display(tex: &str) -> Result<String, String> {
    let (tex, number) = split_tag(tex)?;
    let math = mathml(&tex, DisplayMode::Block)?;
    let mut html = String::from("<div class=\"equation\">");
    // a long equation scrolls on its own, and its number stays in place
    let _ = write!(html, "<div class=\"formula\">{math}</div>");
    if let Some(number) = number {
        let _ = write!(html, "<span class=\"number\">({number})</span>");
    }
    html.push_str("</div>");
    Ok(html)
}

fn mathml(tex: &str, display_mode: DisplayMode) -> Result<String, String> {
    let source = joined_primes(tex);
    let fail = |reason: String| format!("`{}`: {}", one_line(tex), one_line(&reason));
    let storage = Storage::new();
    // errors are reported here: the renderer would print them into the page in red
    let events = Parser::new(&source, &storage)
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| fail(error.to_string()))?;
    let mut html = String::new();
    let config = RenderConfig {
        display_mode,
        ..RenderConfig::default()
    };
    let events = events.into_iter().map(Ok::<_, std::convert::Infallible>);
    push_mathml(&mut html, events, config).map_err(|error| fail(error.to_string()))?;
    Ok(set_as_in_tex(&one_line(&well_formed(&html))))
}

/// Repairs two faults of the renderer: it leaves `<` and `&` as they are, and it joins some
/// attributes without a blank.
fn well_formed(html: &str) -> String {
    let mut out = String::with_capacity(html.len());
    let mut in_tag = false;
    let mut in_value = false;
    let mut characters = html.chars().peekable();
    while let Some(c) = characters.next() {
        let next = characters.peek().copied();
        match c {
            '<' if next.is_some_and(|n| n.is_ascii_alphabetic() || n == '/') => in_tag = true,
            '<' if !in_tag => {
                out.push_str("&lt;");
                continue;
            }
            '&' if next.is_none_or(|n| !n.is_ascii_alphabetic() && n != '#') => {
                out.push_str("&amp;");
                continue;
            }
            '>' => in_tag = false,
            '"' if in_tag => {
                in_value = !in_value;
                if !in_value && next.is_some_and(|n| n.is_ascii_alphabetic()) {
                    out.push_str("\" ");
                    continue;
                }
            }
            _ => {}
        }
        out.push(c);
    }
    out
}

/// Converts `E''` to one double prime. In mathematical fonts a prime is already raised, and two
/// primes would be too far apart.
fn joined_primes(tex: &str) -> String {
    tex.replace("'''", "\\trprime ").replace("''", "\\dprime ")
}

/// Corrects MathML that browsers render differently from TeX: space around vertical bars and
/// slashes, text without its spaces, µ (the prefix) in place of the letter μ, overbars that are no
/// longer than a letter.
fn set_as_in_tex(html: &str) -> String {
    const BLANK: &str = "\u{a0}"; // the character itself, because mdBook takes its name for text
    let mut html = html
        .replace('\u{b5}', "\u{3bc}")
        .replace("&amp;nbsp;", BLANK)
        .replace("&nbsp;", BLANK)
        .replace("<mtext> ", &format!("<mtext>{BLANK}"))
        .replace(" </mtext>", &format!("{BLANK}</mtext>"));
    for tight in ["|", "‖", "/"] {
        for attributes in ["", " symmetric=\"false\" stretchy=\"false\""] {
            html = html.replace(
                &format!("<mo{attributes}>{tight}</mo>"),
                &format!("<mo{attributes} lspace=\"0\" rspace=\"0\">{tight}</mo>"),
            );
        }
    }
    with_bars(html)
}

/// Replaces bars above a formula by a border, which is as long as its content. In most fonts, the
/// character for a bar is not stretched.
fn with_bars(mut html: String) -> String {
    const BAR: &str = "<mi>‾</mi></mover>";
    const OPEN: &str = "<mover>";
    while let Some(end) = html.find(BAR) {
        // the opening tag is the last one that is not closed before the bar
        let mut begin = end;
        let mut ended = 0_usize;
        loop {
            let Some(open) = html[..begin].rfind(OPEN) else {
                return html;
            };
            ended += html[open..begin].matches("</mover>").count();
            begin = open;
            if ended == 0 {
                break;
            }
            ended -= 1;
        }
        html.replace_range(end..end + BAR.len(), "</mrow>");
        html.replace_range(begin..begin + OPEN.len(), "<mrow class=\"bar\">");
    }
    html
}

/// Replaces characters between tags that have a meaning in Markdown by entities.
fn guard_from_markdown(html: &str) -> String {
    let mut out = String::with_capacity(html.len());
    let mut in_tag = false;
    for c in html.chars() {
        match c {
            '<' => in_tag = true,
            '>' => in_tag = false,
            '*' | '_' | '|' | '[' | ']' | '~' | '`' | '\\' | '$' | '"' | '\'' if !in_tag => {
                let _ = write!(out, "&#{};", u32::from(c));
                continue;
            }
            _ => {}
        }
        out.push(c);
    }
    out
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_stands_beside_its_equation_and_not_in_it() {
        let html = display("\\gamma^2 = -\\rho\\omega^2/E .\n\\tag{A 2}\n").unwrap();
        assert!(
            html.contains("<span class=\"number\">(A 2)</span>"),
            "{html}"
        );
        assert!(!html.contains("tag"), "{html}");
        assert!(
            !html.contains('\n'),
            "a blank line would end the block: {html}"
        );
    }

    #[test]
    fn primes_bars_and_letters_are_set_as_in_tex() {
        let over =
            inline("\\overline{\\hat H\\,\\overline{\\hat X}} + \\hat Y \\text{ if } \\bar A")
                .unwrap();
        assert_eq!(over.matches("<mrow class=\"bar\">").count(), 3, "{over}");
        assert_eq!(over.matches("<mover>").count(), 3, "{over}");
        assert_eq!(over.matches("</mover>").count(), 3, "{over}");
        assert!(over.contains("<mtext>\u{a0}if\u{a0}</mtext>"), "{over}");
        assert_eq!(joined_primes("E'' + f'^2"), "E\\dprime  + f'^2");
        let html = inline("E''/\\lvert\\mu\\rvert").unwrap();
        assert!(html.contains("″") && html.contains("μ"), "{html}");
        assert_eq!(
            html.matches("lspace=\"0\" rspace=\"0\"").count(),
            3,
            "{html}"
        );
    }

    #[test]
    fn markdown_finds_nothing_in_a_formula() {
        let html = inline("a*b_{[c]} \\lvert d\\rvert").unwrap();
        let mut text = String::new();
        let mut in_tag = false;
        for c in html.chars() {
            match c {
                '<' => in_tag = true,
                '>' => in_tag = false,
                _ if !in_tag => text.push(c),
                _ => {}
            }
        }
        assert!(!text.contains(['*', '_', '|', '[', ']']), "{html}");
    }

    #[test]
    fn comparisons_and_sizes_make_no_broken_tags() {
        let html = inline("\\sum_{j<n} \\Bigl( a < b > c").unwrap();
        assert_eq!(html.matches("&lt;").count(), 2, "{html}");
        assert!(!html.contains("\"minsize"), "{html}");
    }

    #[test]
    fn what_is_no_tex_is_an_error_with_the_formula() {
        let error = display("\\frac{1}{2} \\nosuchcommand").unwrap_err();
        assert!(error.contains("\\nosuchcommand"), "{error}");
        assert!(display("\\frac{1}{").is_err());
        assert!(inline("x \\tag{1}").is_err());
    }
}
