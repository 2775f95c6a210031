//! Pages of the examples in a browser: what is cut, too tall, too pale, without a name, or broken.
//!
//! Each page stands in frames of several widths, light, dark and as on paper, of one page that
//! collects what `look.js` finds in them. Any browser of the kind of Chromium runs it without a
//! window; other pictures than its layout are not compared.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cargo::{self, CargoError};
use testbed::generated::workspace_root;

/// Names of programs, the first of which that is there is taken.
const PROGRAMS: [&str; 6] = [
    "chromium",
    "chromium-browser",
    "chrome-headless-shell",
    "google-chrome",
    "google-chrome-stable",
    "msedge",
];

/// A page as it is looked at.
struct View {
    name: &'static str,
    width: u32,
    is_dark: bool,
    is_paper: bool,
}

/// Telephone, tablet, notebook, screen, and the printable width of A4 and Letter.
const VIEWS: [View; 6] = [
    View::screen("390, light", 390, false),
    View::screen("390, dark", 390, true),
    View::screen("768, dark", 768, true),
    View::screen("1280, light", 1280, false),
    View::screen("1920, dark", 1920, true),
    View {
        name: "paper",
        width: 680,
        is_dark: false,
        is_paper: true,
    },
];

impl View {
    const fn screen(name: &'static str, width: u32, is_dark: bool) -> Self {
        Self {
            name,
            width,
            is_dark,
            is_paper: false,
        }
    }

    /// `page` with the rules of this view, and with the script that looks at it.
    fn of(&self, page: &str) -> Result<String, LookError> {
        let (dark, light) = if self.is_dark {
            ("all", "not all")
        } else {
            ("not all", "all")
        };
        let mut page = page
            .replace("(prefers-color-scheme: dark)", dark)
            .replace("(prefers-color-scheme: light)", light);
        if self.is_paper {
            page = page
                .replace("@media print", "@media all")
                .replace("@media screen", "@media speech");
        }
        let nonce = page
            .split_once("'nonce-")
            .and_then(|(_, behind)| behind.split_once('\''))
            .map_or(String::new(), |(nonce, _)| format!(" nonce=\"{nonce}\""));
        let script = include_str!("look.js").replace("VIEW", &format!("{:?}", self.name));
        let (head, body) = page.split_once("</head>").ok_or(LookError::NoHead)?;
        Ok(format!(
            "{head}<script{nonce}>{script}</script></head>{body}"
        ))
    }
}

/// Reason why pages were not looked at, or what was found in them.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LookError {
    #[error("no browser: `--browser` or RODLAB_BROWSER names one like Chromium, or one of {} is in the PATH", PROGRAMS.join(", "))]
    NoBrowser,
    #[error("the page has no `</head>`")]
    NoHead,
    #[error("{}: the browser told nothing of the view `{view}`", page.display())]
    Silent { page: PathBuf, view: &'static str },
    #[error("{0} findings")]
    Found(usize),
    #[error(transparent)]
    Cargo(#[from] CargoError),
    #[error("{}: {source}", path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Runs the examples, and looks at their pages and at that of the campaign.
pub(crate) fn run(
    named: Option<&Path>,
    if_installed: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let Some(browser) = browser(named) else {
        if if_installed {
            println!("no browser is on this machine: pages were not looked at");
            return Ok(());
        }
        return Err(LookError::NoBrowser.into());
    };
    let folder = cargo::target_folder().join("look");
    let results = folder.join("results");
    let mut batch = cargo::cargo();
    batch
        .current_dir(workspace_root())
        .args([
            "run",
            "--quiet",
            "--locked",
            "-p",
            "rodlab",
            "--",
            "batch",
            "crates/rodlab/examples",
            "--out",
        ])
        .arg(&results);
    // a test of the examples is not allowed, which is the status of the campaign
    let _ = batch.output();
    let mut pages = Vec::new();
    pages_of(&results, &mut pages)?;
    pages.sort();
    let mut count = 0;
    for page in &pages {
        for (view, said) in found(&browser, page, &folder)? {
            count += 1;
            println!(
                "{} ({view}): {said}",
                page.strip_prefix(&results).unwrap_or(page).display()
            );
        }
    }
    println!(
        "{} pages in {} views, {count} findings",
        pages.len(),
        VIEWS.len()
    );
    if count > 0 || pages.is_empty() {
        return Err(LookError::Found(count).into());
    }
    Ok(())
}

fn browser(named: Option<&Path>) -> Option<PathBuf> {
    if let Some(path) = named {
        return Some(path.to_path_buf());
    }
    let is_there = |name: &&str| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|said| said.status.success())
    };
    PROGRAMS
        .iter()
        .find(|name| is_there(name))
        .map(PathBuf::from)
}

fn pages_of(folder: &Path, pages: &mut Vec<PathBuf>) -> Result<(), LookError> {
    let at = |source| LookError::File {
        path: folder.to_path_buf(),
        source,
    };
    for entry in std::fs::read_dir(folder).map_err(at)? {
        let path = entry.map_err(at)?.path();
        if path.is_dir() {
            pages_of(&path, pages)?;
        } else if path.extension().is_some_and(|ending| ending == "html") {
            pages.push(path);
        }
    }
    Ok(())
}

/// Findings of all views of `page`, with the name of the view.
fn found(browser: &Path, page: &Path, folder: &Path) -> Result<Vec<(String, String)>, LookError> {
    let at = |path: &Path| {
        let path = path.to_path_buf();
        move |source| LookError::File { path, source }
    };
    let text = std::fs::read_to_string(page).map_err(at(page))?;
    let mut frames = String::new();
    for (number, view) in VIEWS.iter().enumerate() {
        let name = format!("view-{number}.html");
        let path = folder.join(&name);
        std::fs::write(&path, view.of(&text)?).map_err(at(&path))?;
        frames += &format!(
            "<iframe src=\"{name}\" width=\"{}\" height=\"900\"></iframe>",
            view.width
        );
    }
    let host = folder.join("host.html");
    let collected = "<script>addEventListener('message', (event) => { \
        const line = document.createElement('samp'); line.textContent = JSON.stringify(event.data); \
        document.body.append(line); });</script>";
    std::fs::write(
        &host,
        format!("<!doctype html><html><head>{collected}</head><body>{frames}</body></html>"),
    )
    .map_err(at(&host))?;
    let said = cargo::run(
        Command::new(browser)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--virtual-time-budget=20000",
                "--dump-dom",
            ])
            .arg(format!("file://{}", host.display())),
    )?;
    let mut findings = Vec::new();
    let mut told = Vec::new();
    for line in said.output.split("<samp>").skip(1) {
        let line = line.split("</samp>").next().unwrap_or_default();
        let line = line
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&amp;", "&");
        let Ok(value) = serde_json::from_str::<serde_json::Value>(&line) else {
            continue;
        };
        let view = value["view"].as_str().unwrap_or_default().to_owned();
        for finding in value["found"].as_array().into_iter().flatten() {
            findings.push((
                view.clone(),
                finding.as_str().unwrap_or_default().to_owned(),
            ));
        }
        told.push(view);
    }
    match VIEWS
        .iter()
        .find(|view| !told.iter().any(|name| name == view.name))
    {
        Some(view) => Err(LookError::Silent {
            page: page.to_path_buf(),
            view: view.name,
        }),
        None => Ok(findings),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_has_its_rules_and_a_script_that_may_run() {
        let page = "<head><meta content=\"script-src 'nonce-abc'\"><style>@media (prefers-color-scheme: dark) {a{}} \
                    @media print {b{}} @media screen and (max-width: 3rem) {c{}}</style></head><body></body>";
        let [light, .., paper] = &VIEWS;
        let shown = light.of(page).unwrap();
        assert!(
            shown.contains("@media not all {a{}}") && shown.contains("@media print {b{}}"),
            "{shown}"
        );
        assert!(
            shown.contains("<script nonce=\"abc\">") && shown.contains("\"390, light\""),
            "{shown}"
        );
        let dark = VIEWS[1].of(page).unwrap();
        assert!(dark.contains("@media all {a{}}"), "{dark}");
        let printed = paper.of(page).unwrap();
        assert!(
            printed.contains("@media all {b{}}") && printed.contains("@media speech and"),
            "{printed}"
        );
        assert!(light.of("no page").is_err());
    }
}
