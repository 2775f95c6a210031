//! Frequency responses from arrays.

use labio::{
    Channel, Estimator, LabioError, Provenance, Quantity, Record, SpectrumAverager, Window,
};
use ndarray::Array2;
use num_complex::Complex64;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::{refused, wrong};

/// Names of the two channels.
const NAMES: [&str; 2] = ["input", "output"];

/// Frequencies, values, coherence, variance, random errors of magnitude and of phase, validity.
type Response<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<Complex64>>,
    Option<Bound<'py, PyArray1<f64>>>,
    Option<Bound<'py, PyArray1<f64>>>,
    Option<Bound<'py, PyArray1<f64>>>,
    Option<Bound<'py, PyArray1<f64>>>,
    Vec<bool>,
);

/// Returns the frequency response from `input` to `output`, (n_hits, n_samples) each, by
/// `estimator`, averaged with `window`.
#[pyfunction]
#[pyo3(signature = (input, output, sampling_rate_hz, *, estimator, window))]
pub(crate) fn frequency_response<'py>(
    py: Python<'py>,
    input: PyReadonlyArray2<'py, f64>,
    output: PyReadonlyArray2<'py, f64>,
    sampling_rate_hz: f64,
    estimator: &str,
    window: &str,
) -> PyResult<Response<'py>> {
    let estimator = match estimator {
        "H1" => Estimator::H1,
        "H2" => Estimator::H2,
        "Hv" => Estimator::Hv,
        other => {
            let words = format!("estimator is `{other}`, expected `H1`, `H2` or `Hv`");
            return Err(wrong(py, words));
        }
    };
    let window = match window {
        "rectangular" => Window::Rectangular,
        "hann" => Window::HannPeriodic,
        "hamming" => Window::HammingPeriodic,
        "blackman-harris" => Window::BlackmanHarrisPeriodic,
        "flat top" => Window::FlatTopPeriodic,
        other => {
            let words = format!(
                "window is `{other}`, expected `rectangular`, `hann`, `hamming`, `blackman-harris` or `flat top`"
            );
            return Err(wrong(py, words));
        }
    };
    let (input, output) = (input.as_array(), output.as_array());
    if input.dim() != output.dim() {
        let words = format!(
            "input and output have the shapes {:?} and {:?}, expected the same shape, (n_hits, n_samples)",
            input.dim(),
            output.dim()
        );
        return Err(wrong(py, words));
    }
    let fail = |error: LabioError| refused(py, &error);
    let [first, second] = NAMES.map(|name| Channel::new(name, Quantity::Voltage));
    let channels = [first.map_err(fail)?, second.map_err(fail)?];
    let mut averager = None;
    for (input, output) in input.rows().into_iter().zip(output.rows()) {
        // copies the hit, because the arrays may change while the lock of the interpreter is
        // released
        let mut hit = Array2::zeros((2, input.len()));
        hit.row_mut(0).assign(&input);
        hit.row_mut(1).assign(&output);
        let added = py.detach(|| -> Result<SpectrumAverager, LabioError> {
            let made = Provenance::computed("array");
            let hit = Record::new(hit, sampling_rate_hz, 0.0, channels.to_vec(), made)?;
            let mut averager = match averager.take() {
                Some(averager) => averager,
                None => SpectrumAverager::for_records_like(&hit, window)?,
            };
            averager.add(&hit)?;
            Ok(averager)
        });
        averager = Some(added.map_err(fail)?);
    }
    let Some(averager) = averager else {
        return Err(wrong(
            py,
            "there are no hits, expected one or more".to_owned(),
        ));
    };
    let [first, second] = NAMES;
    let spectra = py.detach(|| averager.spectra()).map_err(fail)?;
    let response = spectra.response(estimator, first, second).map_err(fail)?;
    let (magnitude, phase) = response
        .random_error()
        .map(|errors| errors.iter().map(|e| (e.magnitude, e.phase)).unzip())
        .unzip();
    let array = |lines: Option<Vec<f64>>| lines.map(|lines| lines.into_pyarray(py));
    let valid = response.validity.iter();
    let valid = valid
        .map(|line| *line == labio::LineValidity::Valid)
        .collect();
    Ok((
        response.frequency_hz.into_pyarray(py),
        response.values.into_pyarray(py),
        array(response.coherence),
        array(response.variance),
        array(magnitude),
        array(phase),
        valid,
    ))
}
