//! Report: one self-contained page for reading, printing and filing.
//!
//! The page contains the whole [`Outcome`], beginning with the answer. Each figure is contained
//! twice: as data for a short script that shows values, zooms and changes scales, and, for readers
//! without scripts, drawn as in the files. The page contains only paths as written in the sheet,
//! and not the current date, so the same outcome, sheet and date give the same bytes.

mod compact;
mod rows;

use std::fmt::Write;

use minijinja::value::Serde;
use minijinja::{Environment, HtmlEscape, UndefinedBehavior, Value};
use rodfigure::{Drawn, Figure, Mark, unit_as_read};
use serde::Serialize;

use crate::outcome::{Outcome, Verdict};
use crate::output::SheetIdentity;
use crate::{InStep, RodlabError};
use rows::{QuantityRow, TableRows};

const TEMPLATE: &str = include_str!("report/template.html");
const STYLE: &str = include_str!("report/style.css");
const SCRIPT: &str = concat!(
    include_str!("report/script.js"),
    include_str!("report/pdf.js")
);

/// Data for the template.
#[derive(Serialize)]
struct Page<'a> {
    software: &'a str,
    job: &'a str,
    title: &'a str,
    sheet: &'a SheetIdentity,
    date: Option<&'a str>,
    standing: &'static str,
    class: String,
    reasons: &'a [String],
    summary: &'a [String],
    warnings: &'a [String],
    quantities: Vec<QuantityRow<'a>>,
    about: Vec<(String, &'a str)>,
    answer: Option<FigurePart<'a>>,
    figures: Vec<FigurePart<'a>>,
    tables: Vec<TableRows<'a>>,
    log: &'a [crate::outcome::LogEntry],
    log_summary: String,
    settings: Vec<&'a crate::outcome::Setting>,
    inputs: &'a [crate::outcome::InputFile],
    attachments: Vec<&'a str>,
    style: &'a str,
    script: &'a str,
}

/// Prefix of the names of statements that are shown at the head of the page.
const ABOUT: &str = "about.";

/// A figure, as data for the script and as a drawing for readers without scripts.
#[derive(Serialize)]
struct FigurePart<'a> {
    name: &'a str,
    title: &'a str,
    caption: &'a str,
    thinned: Option<String>,
    data: String,
    drawing: &'a str,
    panels: usize,
}

/// Returns the page for the `outcome` of `sheet`, with the figures `drawn` in their order. `date`
/// is the date of the report, if known.
///
/// # Errors
///
/// [`RodlabError::Step`] if the page cannot be made.
pub fn html_of(
    outcome: &Outcome,
    drawn: &[Drawn],
    sheet: &SheetIdentity,
    date: Option<&str>,
) -> Result<String, RodlabError> {
    let rejected = outcome.log.iter().filter(|entry| !entry.accepted).count();
    let standing = outcome.verdict.standing();
    let mut figures = outcome
        .figures
        .iter()
        .zip(drawn)
        .map(|(whole, drawn)| FigurePart {
            name: &whole.name,
            title: &whole.title,
            caption: &whole.caption,
            thinned: thinning(whole, &drawn.figure),
            data: compact::json_of(&drawn.figure),
            drawing: &drawn.svg,
            panels: whole.panels.len(),
        });
    let about = outcome.settings.iter().filter_map(|setting| {
        let field = setting.name.strip_prefix(ABOUT)?;
        Some((field.to_owned(), setting.value.as_str()))
    });
    let page = Page {
        software: crate::output::SOFTWARE,
        job: outcome.job,
        title: &outcome.title,
        sheet,
        date,
        standing: standing.word(),
        class: standing.word().replace(' ', "-"),
        reasons: match &outcome.verdict {
            Verdict::Answered => &[],
            Verdict::InDoubt { reasons } => reasons,
            Verdict::NotAllowed { reason } => std::slice::from_ref(reason),
        },
        summary: &outcome.summary,
        warnings: &outcome.warnings,
        quantities: outcome.quantities.iter().map(QuantityRow::of).collect(),
        about: about.collect(),
        answer: figures.next(),
        figures: figures.collect(),
        tables: outcome.tables.iter().map(TableRows::of).collect(),
        log: &outcome.log,
        log_summary: format!("{rejected} of {} entries rejected.", outcome.log.len()),
        settings: outcome
            .settings
            .iter()
            .filter(|setting| !setting.name.starts_with(ABOUT))
            .collect(),
        inputs: &outcome.inputs,
        attachments: outcome
            .attachments
            .iter()
            .map(|a| a.name.as_str())
            .collect(),
        style: &bare(STYLE),
        script: &bare(SCRIPT),
    };
    let mut environment = Environment::new();
    // makes an unknown name in the template an error
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.add_filter("worded", worded);
    environment
        .add_template("report.html", TEMPLATE)
        .in_step("writing report.html")?;
    environment
        .get_template("report.html")
        .and_then(|template| template.render(Serde(&page)))
        .in_step("writing report.html")
}

/// Returns a sentence of the terminal as HTML: names in backquotes as code, and units as figures
/// and tables have them.
fn worded(text: &str) -> Value {
    let mut html = String::with_capacity(text.len());
    let is_paired = text.matches('`').count().is_multiple_of(2);
    for (index, part) in text.split('`').enumerate() {
        if index % 2 == 1 && is_paired {
            _ = write!(html, "<code>{}</code>", HtmlEscape(part));
            continue;
        }
        if index > 0 && !is_paired {
            html.push('`');
        }
        for word in part.split_inclusive(' ') {
            let unit = word.trim_end_matches([' ', '.', ',', ';', ':', ')']);
            let rest = word.strip_prefix(unit).unwrap_or_default();
            let read = unit_as_read(unit);
            _ = write!(html, "{}{rest}", HtmlEscape(&read));
        }
    }
    Value::from_safe_string(html)
}

/// Returns a built-in text without its indentation and comments.
fn bare(text: &str) -> String {
    let mut bare = String::with_capacity(text.len());
    for line in text.lines().map(str::trim_start) {
        if !line.is_empty() && !line.starts_with("//") {
            bare.push_str(line);
            bare.push('\n');
        }
    }
    bare
}

/// Returns a sentence about the thinning of the longest curve, if this curve is not drawn in full.
fn thinning(whole: &Figure, drawn: &Figure) -> Option<String> {
    let samples = |figure: &Figure| -> Vec<usize> {
        figure
            .panels
            .iter()
            .flat_map(|panel| &panel.marks)
            .map(|mark| match mark {
                Mark::Line { x, .. } | Mark::Points { x, .. } | Mark::Band { x, .. } => x.len(),
                Mark::At { .. } => 1,
            })
            .collect()
    };
    samples(whole)
        .into_iter()
        .zip(samples(drawn))
        .filter(|(all, drawn)| drawn < all)
        .max()
        .map(|(all, drawn)| {
            format!(
                "Long curves are drawn with their extreme values, the longest with {drawn} of {all} samples; at high zoom, samples are missing."
            )
        })
}

#[cfg(test)]
mod tests;
