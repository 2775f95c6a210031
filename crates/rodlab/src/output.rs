//! Writing of the files of an outcome. Each file appears complete or not at all.

mod date;
mod gate;
mod layout;
mod lock;
mod ours;
mod together;
mod workbook;

pub use gate::stop_writing;
pub(crate) use ours::holds_result;
pub(crate) use together::{replace_by_failure, replace_summary};

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use labio::ContentHash;
use rayon::prelude::*;
use rodfigure::{Drawn, Figure};
use serde::{Deserialize, Serialize};
use tempfile::NamedTempFile;

use crate::outcome::{Outcome, Table};
use crate::report::html_of;
use crate::{InStep, RodlabError};

/// Version of the structure of `result.json`; it is increased when a field changes its name or
/// meaning.
pub const RESULT_VERSION: u32 = 3;

/// Name of the program.
const PROGRAM: &str = "rodlab";

/// Name and version of the program that made a result.
pub const SOFTWARE: &str = concat!("rodlab ", env!("CARGO_PKG_VERSION"));

/// Name of the file that is written last. If it exists, all other files of the result exist.
pub const RESULT: &str = "result.json";

/// Name of the file that states why there is no result.
pub(crate) const FAILURE: &str = "failure.json";

/// Prefix of the temporary names of files that are replaced together.
const PART: &str = ".rodlab-part-";

/// The sheet of a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SheetIdentity {
    /// Name of the file.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// Returns the default folder for the result of a sheet: next to the sheet, with the name of the
/// sheet and `-result`.
#[must_use]
pub fn default_folder(sheet: &Path) -> PathBuf {
    let stem = sheet.file_stem().unwrap_or_default().to_string_lossy();
    sheet.with_file_name(format!("{stem}-result"))
}

/// Name of the report page.
pub const REPORT: &str = "report.html";

/// Name of the workbook of all tables.
pub const WORKBOOK: &str = "tables.xlsx";

/// Name given to the report of an earlier result after a later run of its sheet has failed.
const EARLIER_REPORT: &str = "earlier-report.html";

/// A file of a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct OutputFile {
    /// Name in the folder of the result.
    pub(crate) file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub(crate) sha256: String,
}

/// Writes tables, figures, attachments, report and `result.json` of `outcome` to `folder`, and
/// returns the paths. `reads` are the files that the run has read. None of them is ever replaced.
/// The date of the report is that of the newest of them, unless `SOURCE_DATE_EPOCH` is set.
///
/// Each file appears complete. The `result.json` of an earlier run is removed first, together with
/// the files of that run that the new run does not write. The new `result.json` is written last, so
/// if it exists, all files belong to one run. If several runs write to the same folder, they do so
/// one after the other.
///
/// # Errors
///
/// [`RodlabError::Write`] or [`RodlabError::Busy`] if the folder cannot be written;
/// [`RodlabError::Taken`] for files that belong to no earlier result; [`RodlabError::OverInput`]
/// for files that the run has read; [`RodlabError::Step`] if a file cannot be made. The earlier
/// files are complete in all these cases.
pub fn write(
    outcome: &Outcome,
    sheet: &SheetIdentity,
    folder: &Path,
    reads: &[PathBuf],
) -> Result<Vec<PathBuf>, RodlabError> {
    let date = date::of(reads)?;
    ResultFiles::of(outcome, sheet, date.as_deref(), TableFiles::default())?.put(folder, reads)
}

/// Formats of the tables of a result, as options of a command.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::Args)]
pub struct TableFiles {
    /// Write the units in a second row of each CSV table; the column names contain them in any
    /// case.
    #[arg(long)]
    pub unit_row: bool,
    /// Also write all tables to one workbook, `tables.xlsx`, with one sheet per table.
    #[arg(long)]
    pub workbook: bool,
}

/// Files of a result before it is written.
pub(crate) struct ResultFiles {
    /// Names and bytes of all files except `result.json`, in the order in which they are written.
    others: Vec<(String, Vec<u8>)>,
    /// Text of `result.json`.
    pub(crate) json: String,
}

impl ResultFiles {
    /// Returns the files of `outcome`, with its tables in the formats `tables`; `date` is the date
    /// of the report.
    fn of(
        outcome: &Outcome,
        sheet: &SheetIdentity,
        date: Option<&str>,
        tables: TableFiles,
    ) -> Result<Self, RodlabError> {
        let others = all_but_result(outcome, sheet, date, tables)?;
        let json = result_of(outcome, sheet, date, &others)?;
        Ok(Self { others, json })
    }

    /// Returns the files of `outcome`. The date of the report depends on `reads`, the files that
    /// the run has read, as in [`write`].
    pub(crate) fn dated(
        outcome: &Outcome,
        sheet: &SheetIdentity,
        reads: &[PathBuf],
        tables: TableFiles,
    ) -> Result<Self, RodlabError> {
        Self::of(outcome, sheet, date::of(reads)?.as_deref(), tables)
    }

    /// Writes the files to `folder`, like [`write`].
    pub(crate) fn put(
        &self,
        folder: &Path,
        reads: &[PathBuf],
    ) -> Result<Vec<PathBuf>, RodlabError> {
        let others = self.others.iter();
        let others = others.map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        let files: Vec<_> = others.chain([(RESULT, self.json.as_bytes())]).collect();
        together::replace_result(folder, &files, reads)
    }
}

/// Returns the report of `outcome`. Its date depends on the files `reads`, as in [`write`].
pub(crate) fn report_of(
    outcome: &Outcome,
    sheet: &SheetIdentity,
    reads: &[PathBuf],
) -> Result<String, RodlabError> {
    let drawn: Vec<Drawn> = outcome.figures.iter().map(Drawn::of).collect();
    html_of(outcome, &drawn, sheet, date::of(reads)?.as_deref())
}

fn all_but_result(
    outcome: &Outcome,
    sheet: &SheetIdentity,
    date: Option<&str>,
    forms: TableFiles,
) -> Result<Vec<(String, Vec<u8>)>, RodlabError> {
    let (tables, page) = rayon::join(
        || {
            let tables = outcome.tables.par_iter();
            tables
                .map(|table| Ok((table_file(table), csv_of(table, forms.unit_row)?)))
                .collect::<Result<Vec<_>, RodlabError>>()
        },
        || {
            let drawn: Vec<Drawn> = outcome.figures.par_iter().map(Drawn::of).collect();
            let page = html_of(outcome, &drawn, sheet, date)?;
            Ok::<_, RodlabError>((drawn, page))
        },
    );
    let (mut files, (drawn, page)) = (tables?, page?);
    if forms.workbook && !outcome.tables.is_empty() {
        files.push((WORKBOOK.to_owned(), workbook::of(&outcome.tables)?));
    }
    for attachment in &outcome.attachments {
        files.push((attachment.name.clone(), attachment.bytes.clone()));
    }
    for drawn in drawn {
        files.push((figure_file(&drawn.figure), drawn.svg.into_bytes()));
    }
    files.push((REPORT.to_owned(), page.into_bytes()));
    let names = files.iter().map(|(name, _)| name.as_str());
    let mut names: Vec<&str> = names.chain([RESULT]).collect();
    names.sort_unstable();
    let twice = names.windows(2).find_map(|pair| match pair {
        [name, next] if name == next => Some(*name),
        _ => None,
    });
    if let Some(twice) = twice {
        let error = io::Error::other(format!("two of them are called {twice}"));
        return Err(RodlabError::step("writing the files of the result", error));
    }
    Ok(files)
}

fn table_file(table: &Table) -> String {
    format!("{}.csv", table.name)
}

fn figure_file(figure: &Figure) -> String {
    format!("{}.svg", figure.name)
}

/// Returns true if `name` is a plain file name that does not lead to another folder.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && Path::new(name).file_name() == Some(name.as_ref())
}

/// Writes `bytes` through a temporary file in the same folder, so that `path` is never partly
/// written. An existing file is replaced, unless it is read-only.
///
/// # Errors
///
/// [`RodlabError::Write`] if the file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RodlabError> {
    let _passage = gate::pass()?;
    together::may_change(path, &[])?;
    named(staged(path, bytes, ".rodlab-")?, path)
}

/// Writes a new file like [`write_whole`], but replaces nothing.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> Result<(), RodlabError> {
    let _passage = gate::pass()?;
    match staged(path, bytes, ".rodlab-")?.persist_noclobber(path) {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => {
            Err(RodlabError::Exists {
                path: path.to_path_buf(),
            })
        }
        Err(error) => Err(RodlabError::write(path, error.error)),
    }
}

/// Returns true if no run was interrupted while it changed `folder`, and no run is changing the
/// folder now.
pub(crate) fn is_settled(folder: &Path) -> bool {
    !folder.join(lock::NAME).exists()
}

/// Writes `bytes` to the disk under a temporary name in the folder of `path`; the file is removed
/// when dropped.
fn staged(path: &Path, bytes: &[u8], prefix: &str) -> Result<NamedTempFile, RodlabError> {
    let file = written(path, bytes, prefix)?;
    on_disk(&file, path)?;
    Ok(file)
}

/// Waits until `file`, which will be moved to `path`, is on the disk. After a power failure, there
/// must be no file that has its name but not its contents.
fn on_disk(file: &NamedTempFile, path: &Path) -> Result<(), RodlabError> {
    let done = file.as_file().sync_all();
    done.map_err(|source| RodlabError::write(path, source))
}

/// Writes `bytes` under a temporary name in the folder of `path`; the file is removed when dropped.
fn written(path: &Path, bytes: &[u8], prefix: &str) -> Result<NamedTempFile, RodlabError> {
    let fail = |source: io::Error| RodlabError::write(path, source);
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder).map_err(fail)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    {
        // the file is readable by others, as files of programs usually are; the umask still applies
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder
        .tempfile_in(folder)
        .map_err(|error| fail(without_path(error)))?;
    file.as_file_mut().write_all(bytes).map_err(fail)?;
    Ok(file)
}

/// Returns the error of the operating system without the temporary name, which is different every
/// time.
fn without_path(error: io::Error) -> io::Error {
    let inner = error.get_ref().and_then(std::error::Error::source);
    inner
        .and_then(|inner| inner.downcast_ref::<io::Error>())
        .and_then(io::Error::raw_os_error)
        .map_or(error, io::Error::from_raw_os_error)
}

fn named(file: NamedTempFile, path: &Path) -> Result<(), RodlabError> {
    match file.persist(path) {
        Ok(_) => Ok(()),
        Err(error) => Err(RodlabError::write(path, error.error)),
    }
}

/// Returns `result.json` without a date. It contains the versions of its structure and of the
/// software, the sheet, the files and the outcome; `docs/result.schema.json` describes it.
///
/// # Errors
///
/// [`RodlabError::Step`] if a file of the result cannot be made.
pub fn json_of(outcome: &Outcome, sheet: &SheetIdentity) -> Result<String, RodlabError> {
    Ok(ResultFiles::of(outcome, sheet, None, TableFiles::default())?.json)
}

/// Returns the text of `result.json` for a result with the other files `files`.
fn result_of(
    outcome: &Outcome,
    sheet: &SheetIdentity,
    date: Option<&str>,
    files: &[(String, Vec<u8>)],
) -> Result<String, RodlabError> {
    #[derive(Serialize)]
    struct Result<'a> {
        result_version: u32,
        software: &'static str,
        sheet: &'a SheetIdentity,
        date: Option<&'a str>,
        files: Vec<&'a str>,
        outputs: Vec<OutputFile>,
        #[serde(flatten)]
        outcome: &'a Outcome,
    }
    let result = Result {
        result_version: RESULT_VERSION,
        software: SOFTWARE,
        sheet,
        date,
        files: files
            .iter()
            .map(|(name, _)| name.as_str())
            .chain([RESULT])
            .collect(),
        outputs: files
            .par_iter()
            .map(|(name, bytes)| OutputFile {
                file: name.clone(),
                sha256: ContentHash::of(bytes).to_string(),
            })
            .collect(),
        outcome,
    };
    let mut bytes = Vec::new();
    let mut serializer =
        serde_json::Serializer::with_formatter(&mut bytes, layout::ArraysOnOneLine::default());
    result
        .serialize(&mut serializer)
        .in_step("writing result.json")?;
    bytes.push(b'\n');
    String::from_utf8(bytes).in_step("writing result.json")
}

/// Returns a table as comma-separated values: names, units if `unit_row` is true, and rows. NaN is
/// an empty cell.
fn csv_of(table: &Table, unit_row: bool) -> Result<Vec<u8>, RodlabError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let rows = table.columns.first().map_or(0, |c| c.cells.len());
    if let Some(other) = table.columns.iter().find(|c| c.cells.len() != rows) {
        let error = io::Error::other(format!(
            "the column `{}` has {} rows, expected {rows} as in the first",
            other.name,
            other.cells.len()
        ));
        return Err(RodlabError::step(
            format!("writing {}.csv", table.name),
            error,
        ));
    }
    let refused = |error| RodlabError::step(format!("writing {}.csv", table.name), error);
    let columns = table.published();
    writer
        .write_record(columns.iter().map(|column| &column.name))
        .map_err(refused)?;
    if unit_row {
        writer
            .write_record(columns.iter().map(|column| column.unit))
            .map_err(refused)?;
    }
    let mut text = String::new();
    for row in 0..rows {
        for column in &columns {
            text.clear();
            column.cells.write_to(&mut text, row);
            writer.write_field(&text).map_err(refused)?;
        }
        writer.write_record(None::<&[u8]>).map_err(refused)?;
    }
    writer
        .into_inner()
        .in_step(format!("writing {}.csv", table.name))
}
