//! Test sheets of all jobs. A valid sheet is also checked as the command does; an error must state
//! its place in the text.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use rodlab::job::{self, Sheet, Silent};
use rodlab::sheet::SheetError;

use super::super::records::prints;

/// Parses a sheet and, if it names no path outside its folder, which is empty, checks it as far as
/// possible without its files.
pub fn sheet(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return; // the command rejects such a file before it parses it
    };
    let job = match job::parse(Path::new("sheet.ron"), text) {
        Ok(job) => job,
        Err(error) => {
            mistake(&error, text);
            return error.others().iter().for_each(|other| mistake(other, text));
        }
    };
    assert!(!job.name().is_empty() && !format!("{job:?}").is_empty());
    let leaves_its_folder = ["\"/", "..", "\\", "#\"", "~"]
        .iter()
        .any(|part| text.contains(part));
    if leaves_its_folder {
        return;
    }
    let folder = tempfile::tempdir_in(super::table::memory()).expect("a folder");
    let sheet = Sheet {
        path: folder.path().join("sheet.ron"),
        text: text.to_owned(),
        job,
    };
    if let Err(error) = job::check(&sheet, &Silent, &AtomicBool::new(false)) {
        prints(&error);
    }
}

/// Checks that an error has a place in the text and that its excerpt can be rendered.
fn mistake(error: &SheetError, text: &str) {
    prints(error);
    assert!(
        (1..=text.split('\n').count()).contains(&error.line()),
        "line {} is not in the text",
        error.line()
    );
    assert!(error.column() >= 1);
    for label in error.labels().into_iter().flatten() {
        let end = label.offset() + label.len();
        assert!(
            text.get(label.offset()..end).is_some(),
            "bytes {}..{end} are not in the text",
            label.offset()
        );
    }
    let mut drawn = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .render_report(&mut drawn, error)
        .expect("the excerpt can be rendered");
}
