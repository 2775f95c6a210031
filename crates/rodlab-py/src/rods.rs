//! Forward physics of bodies that are described as in a sheet: mobilities, transition matrices,
//! propagation of waves.

use std::f64::consts::TAU;
use std::path::Path;

use ndarray::Array3;
use num_complex::Complex64;
use numpy::{IntoPyArray, PyArray1, PyArray3, PyReadonlyArray1};
use pyo3::prelude::*;
use rodlab::RodlabError;
use rodlab::bodies::face::ComputedBody;
use rodlab::bodies::material_sheet::material_called;
use rodlab::job::Job;
use rodlab::job::force::{ForceSheet, Problem};

use crate::errors::{raised, raised_of_arguments, wrong};

/// Reads a sheet of the job `force`, whose first body is the body to be computed.
fn sheet_of(py: Python<'_>, text: &str) -> PyResult<Box<ForceSheet>> {
    match rodlab::job::parse(Path::new("arguments.ron"), text) {
        Ok(Job::Force(sheet)) => Ok(sheet),
        Ok(_) => Err(wrong(py, "the text is a sheet of another job".to_owned())),
        Err(error) => Err(raised_of_arguments(py, &error)),
    }
}

fn body_of(sheet: &ForceSheet) -> Result<ComputedBody, RodlabError> {
    match &sheet.problem {
        Problem::Impact(problem) => problem.first.body(&sheet.materials, "body"),
        Problem::Response(_) => Err(RodlabError::request(
            "body",
            "a response",
            "a body that is computed",
        )),
    }
}

/// Returns the mobility \[s/kg\] of the impact face of the first body of `text`, (n_frequencies,).
#[pyfunction]
pub(crate) fn mobility<'py>(
    py: Python<'py>,
    text: &str,
    frequency_hz: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let sheet = sheet_of(py, text)?;
    let frequencies = frequency_hz.as_array().to_vec();
    let values = py.detach(|| -> Result<Vec<Complex64>, RodlabError> {
        let body = body_of(&sheet)?;
        let refused = |error| RodlabError::step("mobility", error);
        let at = |frequency: &f64| body.mobility(*frequency).map_err(refused);
        frequencies.iter().map(at).collect()
    });
    let values = values.map_err(|error| raised(py, &error))?;
    Ok(values.into_pyarray(py))
}

/// Returns the transition matrices of (N, v) of the first body of `text`, without its end,
/// (n_frequencies, 2, 2).
#[pyfunction]
pub(crate) fn transition_matrix<'py>(
    py: Python<'py>,
    text: &str,
    frequency_hz: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray3<Complex64>>> {
    let sheet = sheet_of(py, text)?;
    let frequencies = frequency_hz.as_array().to_vec();
    let matrices = py.detach(|| -> Result<Array3<Complex64>, RodlabError> {
        let body = body_of(&sheet)?;
        let mut entries = Vec::with_capacity(4 * frequencies.len());
        for frequency in &frequencies {
            let matrix = match &body {
                ComputedBody::Analytic(chain) => chain.transition_matrix(TAU * frequency),
                ComputedBody::OnAxis(chain) => chain.transition_matrix(TAU * frequency),
                ComputedBody::Lump { .. } => {
                    return Err(RodlabError::request("body", "a lump", "a `Chain`"));
                }
                ComputedBody::Assembly(_) => {
                    return Err(RodlabError::request("body", "an assembly", "a `Chain`"));
                }
            };
            let matrix = matrix.map_err(|error| RodlabError::step("transition matrix", error))?;
            entries.extend(matrix.entries().into_iter().flatten());
        }
        Array3::from_shape_vec((frequencies.len(), 2, 2), entries)
            .map_err(|error| RodlabError::step("transition matrices", error))
    });
    let matrices = matrices.map_err(|error| raised(py, &error))?;
    Ok(matrices.into_pyarray(py))
}

/// Returns the propagation coefficient alpha + ik \[1/m\] of the material `name` of `text`,
/// (n_frequencies,).
#[pyfunction]
pub(crate) fn propagation_coefficient<'py>(
    py: Python<'py>,
    text: &str,
    name: &str,
    frequency_hz: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let sheet = sheet_of(py, text)?;
    let material = material_called(&sheet.materials, name, "material");
    let material = material.map_err(|error| raised(py, &error))?;
    let frequencies = frequency_hz.as_array();
    let values = frequencies.iter();
    let values: Vec<Complex64> = values
        .map(|frequency| material.propagation_coefficient(*frequency))
        .collect();
    Ok(values.into_pyarray(py))
}
