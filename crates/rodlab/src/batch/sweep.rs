//! Sheets of a campaign from a template: one sheet for each combination of values and seeds.
//!
//! A plan in TOML or RON names the template and the values of its placeholders:
//!
//! ```toml
//! template = "cone.template"
//! grid = [
//!     { name = "velocity", values = ["0.5 m/s", "1 m/s"] },
//!     { name = "length", values = ["300 mm", "400 mm"] },
//! ]
//! seeds = { first = 1, count = 10 }
//! ```
//!
//! The template is the text of a sheet with `{{velocity}}`, `{{length}}` and `{{seed}}` in it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use labio::ContentHash;
use serde::{Deserialize, Serialize};

use super::summary::csv_of;
use crate::sheet::{self, Language, plausible, quoted};
use crate::{RodlabError, input, output};

/// Maximum number of sheets of a sweep.
const MOST_SHEETS: f64 = 100_000.0;

/// Placeholder of the seed.
const SEED: &str = "seed";

/// File that lists the sheets with their values.
const LIST: &str = "sweep.csv";

/// A plan, as read from its file.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Sweep", deny_unknown_fields)]
struct Plan {
    /// File of the template, relative to the plan.
    template: String,
    /// Placeholders with their values; the last one varies fastest, before the seed.
    #[serde(default)]
    grid: Vec<Axis>,
    /// Seeds of every combination of values.
    seeds: Option<Seeds>,
}

/// A placeholder and its values.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Axis {
    /// Name of the placeholder.
    name: String,
    /// Texts that replace the placeholder.
    values: Vec<String>,
}

/// Consecutive seeds.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Seeds {
    first: u32,
    count: u32,
}

/// The sheets of a sweep.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sweep {
    /// Folder of the sheets.
    pub folder: PathBuf,
    /// Names of the placeholders, in the order of the values.
    pub names: Vec<String>,
    /// The sheets.
    pub sheets: Vec<SweptSheet>,
}

/// A sheet of a sweep.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SweptSheet {
    /// Name of the file.
    pub file: String,
    /// Values of the placeholders.
    pub values: Vec<String>,
    /// SHA-256 of the sheet, hexadecimal.
    pub sha256: String,
}

/// Writes the sheets of the plan at `plan` and the list `sweep.csv` to `folder`. The default folder
/// is next to the plan and has the name of the plan with `-sheets`. All sheets are parsed before
/// the first one is written.
///
/// # Errors
///
/// [`RodlabError::Sheet`] for a mistake in the plan or in a filled template,
/// [`RodlabError::Request`] for values and placeholders that do not match, and
/// [`RodlabError::Exists`] for a file that exists already; in these cases nothing is written.
/// [`RodlabError::Read`] or [`RodlabError::Write`] for a file that cannot be read or written.
pub fn sweep(plan: &Path, folder: Option<&Path>) -> Result<Sweep, RodlabError> {
    let text = input::read_text(plan)?;
    let stated: Plan = sheet::parse_as(plan, &text)?;
    let beside = plan.parent().unwrap_or(Path::new(""));
    let template_path = beside.join(&stated.template);
    let template = input::read_text(&template_path)?;
    let axes = axes_of(stated)?;
    let parts = parts_of(&template_path, &template, &axes)?;
    let folder = folder.map_or_else(
        || {
            let stem = plan.file_stem().unwrap_or_default().to_string_lossy();
            plan.with_file_name(format!("{stem}-sheets"))
        },
        Path::to_path_buf,
    );
    let stem = template_path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let count: usize = axes.iter().map(|axis| axis.values.len()).product();
    let digits = count.to_string().len();
    let mut sheets = Vec::with_capacity(count);
    let mut texts = Vec::with_capacity(count);
    for number in 0..count {
        let values = combination(&axes, number);
        let text = filled(&parts, &values);
        let language = Language::of(&text).unwrap_or(Language::Toml);
        let file = format!("{stem}-{:0digits$}.{}", number + 1, language.extension());
        let path = folder.join(&file);
        crate::job::parse(&path, &text)?;
        if path.exists() {
            return Err(RodlabError::Exists { path });
        }
        sheets.push(SweptSheet {
            file,
            values: values.into_iter().map(str::to_owned).collect(),
            sha256: ContentHash::of(text.as_bytes()).to_string(),
        });
        texts.push(text);
    }
    let list = folder.join(LIST);
    if list.exists() {
        return Err(RodlabError::Exists { path: list });
    }
    let sweep = Sweep {
        folder,
        names: axes.into_iter().map(|axis| axis.name).collect(),
        sheets,
    };
    for (sheet, text) in sweep.sheets.iter().zip(&texts) {
        output::write_new(&sweep.folder.join(&sheet.file), text.as_bytes())?;
    }
    output::write_new(&list, &list_of(&sweep)?)?;
    Ok(sweep)
}

/// Returns the placeholders with their values; the seed is the last one.
fn axes_of(plan: Plan) -> Result<Vec<Axis>, RodlabError> {
    let mut axes = plan.grid;
    let mut sheets = 1.0;
    for (at, axis) in axes.iter().enumerate() {
        let place = format!("grid[{at}]");
        let is_name = |name: &str| !name.is_empty() && name.chars().all(is_letter);
        if !is_name(&axis.name) || (axis.name == SEED && plan.seeds.is_some()) {
            return Err(RodlabError::request(
                format!("{place}.name"),
                format!("`{}`", axis.name),
                "a name of letters, digits and `_`; `seed` only without `seeds`",
            ));
        }
        if axes.iter().take(at).any(|other| other.name == axis.name) {
            return Err(RodlabError::request(
                format!("{place}.name"),
                format!("`{}` a second time", axis.name),
                "each name once",
            ));
        }
        let distinct: BTreeSet<&String> = axis.values.iter().collect();
        if axis.values.is_empty() || distinct.len() < axis.values.len() {
            return Err(RodlabError::request(
                format!("{place}.values"),
                format!(
                    "{} values, {} of them distinct",
                    axis.values.len(),
                    distinct.len()
                ),
                "one value or more, each once",
            ));
        }
        sheets *= axis.values.len() as f64;
    }
    if let Some(seeds) = &plan.seeds {
        let end = seeds.first.checked_add(seeds.count);
        let Some(end) = end.filter(|_| seeds.count > 0) else {
            return Err(RodlabError::request(
                "seeds",
                format!("{} seeds from {}", seeds.count, seeds.first),
                format!("at least one seed, all below {}", u32::MAX),
            ));
        };
        plausible::at_most(
            sheets * f64::from(seeds.count),
            MOST_SHEETS,
            "sheets",
            "seeds",
        )?;
        axes.push(Axis {
            name: SEED.to_owned(),
            values: (seeds.first..end).map(|seed| seed.to_string()).collect(),
        });
    }
    plausible::at_most(sheets, MOST_SHEETS, "sheets", "grid")?;
    RodlabError::refuse_empty(
        &axes,
        "grid",
        "at least one placeholder with its values, or `seeds`",
    )?;
    Ok(axes)
}

fn is_letter(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_'
}

/// A piece of a template.
enum TemplatePart<'a> {
    Text(&'a str),
    /// A placeholder, by the number of its axis.
    Value(usize),
}

/// Returns the pieces of `template`. It is an error if an axis has no placeholder in it, or a
/// placeholder no axis.
fn parts_of<'a>(
    path: &Path,
    template: &'a str,
    axes: &[Axis],
) -> Result<Vec<TemplatePart<'a>>, RodlabError> {
    let mut parts = Vec::new();
    let mut used = BTreeSet::new();
    let mut rest = template;
    while let Some((before, behind)) = rest.split_once("{{") {
        let name = behind
            .split_once("}}")
            .map(|(name, after)| (name.trim(), after));
        let Some((name, after)) = name.filter(|(name, _)| name.chars().all(is_letter)) else {
            return Err(misplaced(
                path,
                template,
                behind,
                "`{{`",
                "a name that is followed by `}}`",
            ));
        };
        let Some(axis) = axes.iter().position(|axis| axis.name == name) else {
            let names = quoted(axes.iter().map(|axis| &axis.name));
            let found = format!("the placeholder `{name}`");
            let expected = format!("one of the plan: {names}");
            return Err(misplaced(path, template, behind, &found, &expected));
        };
        used.insert(axis);
        parts.extend([TemplatePart::Text(before), TemplatePart::Value(axis)]);
        rest = after;
    }
    parts.push(TemplatePart::Text(rest));
    match axes
        .iter()
        .enumerate()
        .find(|(axis, _)| !used.contains(axis))
    {
        None => Ok(parts),
        Some((_, axis)) => Err(RodlabError::request(
            path.display().to_string(),
            format!("a template without `{{{{{}}}}}`", axis.name),
            "every placeholder of the plan: otherwise several sheets would be identical",
        )),
    }
}

/// Returns the error at the two braces before `behind`, which is the rest of `template`.
fn misplaced(
    path: &Path,
    template: &str,
    behind: &str,
    found: &str,
    expected: &str,
) -> RodlabError {
    let before = template.strip_suffix(behind).unwrap_or(template);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() - 1;
    RodlabError::request(
        format!("{}:{line}:{column}", path.display()),
        found,
        expected,
    )
}

/// Returns the values of the sheet with this number, from 0; the last axis varies fastest.
fn combination(axes: &[Axis], number: usize) -> Vec<&str> {
    let mut rest = number;
    let mut values: Vec<&str> = axes
        .iter()
        .rev()
        .map(|axis| {
            let at = rest % axis.values.len();
            rest /= axis.values.len();
            axis.values.get(at).map_or("", String::as_str)
        })
        .collect();
    values.reverse();
    values
}

fn filled(parts: &[TemplatePart<'_>], values: &[&str]) -> String {
    parts
        .iter()
        .map(|part| match part {
            TemplatePart::Text(text) => text,
            TemplatePart::Value(axis) => values.get(*axis).copied().unwrap_or_default(),
        })
        .collect()
}

/// Returns the text of `sweep.csv`: one line for each sheet, with its values and its hash.
fn list_of(sweep: &Sweep) -> Result<Vec<u8>, RodlabError> {
    fn row<'a>(file: &'a str, values: &'a [String], hash: &'a str) -> Vec<&'a str> {
        let values = values.iter().map(String::as_str);
        std::iter::once(file).chain(values).chain([hash]).collect()
    }
    let heads = row("file", &sweep.names, "sha256");
    let sheets = sweep.sheets.iter();
    let rows = sheets.map(|sheet| row(&sheet.file, &sheet.values, &sheet.sha256));
    csv_of("sweep.csv", std::iter::once(heads).chain(rows))
}
