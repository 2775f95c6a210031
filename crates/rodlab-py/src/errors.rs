//! Errors of the crates, as exceptions of the package (classes of `rodlab._errors`).

use labio::LabioError;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rodlab::RodlabError;
use rodlab::batch::in_one_line;
use rodlab::sheet::SheetError;

pub(crate) fn raised(py: Python<'_>, error: &RodlabError) -> PyErr {
    let words = in_one_line(error);
    let made = match error {
        RodlabError::Interrupted => return PyKeyboardInterrupt::new_err(words),
        RodlabError::Sheet(error) => {
            let place = Some((error.line(), error.column()));
            let others = error.others().iter();
            let others = others.map(|other| with_advice(&other.to_string(), other));
            let field = Some(error.field());
            sheet_error(py, &words, place, field, error.advice(), others.collect())
        }
        RodlabError::Encoding { line, column, .. } => {
            sheet_error(py, &words, Some((*line, *column)), None, None, Vec::new())
        }
        RodlabError::Request { field, .. } => {
            sheet_error(py, &words, None, Some(field), None, Vec::new())
        }
        RodlabError::OtherJob { .. } | RodlabError::NoSheet { .. } => {
            sheet_error(py, &words, None, None, None, Vec::new())
        }
        RodlabError::NoFile { .. }
        | RodlabError::Read { .. }
        | RodlabError::NoRegularFile { .. } => named(py, "ReadError", words),
        RodlabError::Step { what, .. } if what.starts_with("reading ") => {
            named(py, "ReadError", words)
        }
        _ if error.is_of_output() => named(py, "WriteError", words),
        _ => named(py, "Error", words),
    };
    // if the class cannot be imported, the import error is raised instead
    made.unwrap_or_else(|error| error)
}

/// Returns the exception for mistakes in the arguments of a function; `error` is the error of the
/// sheet that was built from these arguments.
pub(crate) fn raised_of_arguments(py: Python<'_>, error: &SheetError) -> PyErr {
    let others = error.others().iter();
    let others = others.map(|other| with_advice(&other.in_words(), other));
    let field = Some(error.field());
    sheet_error(
        py,
        &error.in_words(),
        None,
        field,
        error.advice(),
        others.collect(),
    )
    .unwrap_or_else(|error| error)
}

/// Returns the message of a mistake together with its advice.
fn with_advice(words: &str, mistake: &SheetError) -> String {
    match mistake.advice() {
        Some(advice) => format!("{words}; {advice}"),
        None => words.to_owned(),
    }
}

/// Returns the exception for arrays that `labio` rejects.
pub(crate) fn refused(py: Python<'_>, error: &LabioError) -> PyErr {
    named(py, "Error", in_one_line(error)).unwrap_or_else(|error| error)
}

/// Returns the exception for an argument that is not as expected.
pub(crate) fn wrong(py: Python<'_>, words: String) -> PyErr {
    named(py, "Error", words).unwrap_or_else(|error| error)
}

fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("rodlab._errors")?.getattr(name)
}

fn named(py: Python<'_>, name: &str, words: String) -> PyResult<PyErr> {
    Ok(PyErr::from_value(class(py, name)?.call1((words,))?))
}

fn sheet_error(
    py: Python<'_>,
    words: &str,
    place: Option<(usize, usize)>,
    field: Option<&str>,
    help: Option<&str>,
    others: Vec<String>,
) -> PyResult<PyErr> {
    let (line, column) = place.unzip();
    let field = field.filter(|field| !field.is_empty());
    let others = PyTuple::new(py, others)?;
    let error = class(py, "SheetError")?.call1((words, line, column, field, help, others))?;
    Ok(PyErr::from_value(error))
}
