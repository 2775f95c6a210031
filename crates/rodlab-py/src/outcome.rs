//! Result of a job in the form in which the Python package uses it.

use std::path::PathBuf;

use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use rodfigure::Drawn;
use rodlab::RodlabError;
use rodlab::outcome::{PublishedCells, PublishedColumn};
use rodlab::output::SheetIdentity;
use rodlab::report::html_of;

use crate::errors::raised;

/// A column: name, description, unit and cells.
type Column<'py> = (String, String, String, Bound<'py, PyAny>);

/// A table: name, title and columns.
type Table<'py> = (String, String, Vec<Column<'py>>);

/// Result of a job.
#[pyclass(frozen, module = "rodlab._rodlab")]
#[derive(Debug)]
pub(crate) struct Outcome {
    outcome: rodlab::Outcome,
    sheet: SheetIdentity,
    files: Vec<PathBuf>,
    /// All parts except tables, in the form of `result.json`.
    json: String,
}

impl Outcome {
    /// Creates the result from the `outcome` of a `sheet` and the `files` that were written.
    pub(crate) fn new(
        mut outcome: rodlab::Outcome,
        sheet: SheetIdentity,
        files: Vec<PathBuf>,
    ) -> Result<Self, RodlabError> {
        let tables = std::mem::take(&mut outcome.tables);
        let json = serde_json::to_string(&outcome)
            .map_err(|error| RodlabError::step("writing the result as JSON", error))?;
        outcome.tables = tables;
        Ok(Self {
            outcome,
            sheet,
            files,
            json,
        })
    }
}

#[pymethods]
impl Outcome {
    /// All parts except tables, figures and attachments, as JSON.
    #[getter]
    fn json(&self) -> &str {
        &self.json
    }

    /// Name and SHA-256 of the sheet.
    #[getter]
    fn sheet(&self) -> (&str, &str) {
        (&self.sheet.file, &self.sheet.sha256)
    }

    /// Paths of the files that were written; `result.json` is the last.
    #[getter]
    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }

    /// Tables as (name, title, columns). A column is (name, description, unit, cells); the cells
    /// are an array of float64 or bool, or a list of str.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Vec<Table<'py>>> {
        let column = |column: PublishedColumn<'_>| -> PyResult<_> {
            let cells = match column.cells {
                PublishedCells::Numbers(values) => values.into_pyarray(py).into_any(),
                PublishedCells::Words(words) => PyList::new(py, words)?.into_any(),
                PublishedCells::Flags(flags) => flags.to_vec().into_pyarray(py).into_any(),
            };
            Ok((
                column.name,
                column.words.to_owned(),
                column.unit.to_owned(),
                cells,
            ))
        };
        let tables = self.outcome.tables.iter();
        tables
            .map(|table| {
                let columns: PyResult<_> = table.published().into_iter().map(column).collect();
                Ok((table.name.clone(), table.title.clone(), columns?))
            })
            .collect()
    }

    /// Returns the files for other programs as (name, bytes).
    fn attachments<'py>(&self, py: Python<'py>) -> Vec<(&str, Bound<'py, PyBytes>)> {
        let files = self.outcome.attachments.iter();
        files
            .map(|file| (file.name.as_str(), PyBytes::new(py, &file.bytes)))
            .collect()
    }

    /// Returns the report, one page of HTML that contains its figures. The page has no date, so
    /// that equal results give equal pages.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        let page = py.detach(|| {
            let drawn: Vec<Drawn> = self.outcome.figures.iter().map(Drawn::of).collect();
            html_of(&self.outcome, &drawn, &self.sheet, None)
        });
        page.map_err(|error| raised(py, &error))
    }
}
