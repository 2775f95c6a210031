//! A ratio of spectra computed by another program.

use labio::{Dimension, ResponseRatio, Unit};
use num_complex::Complex64;

use super::{Measured, RatioErrors, RatioSheet, RatioValues, Spectra};
use crate::job::JobContext;
use crate::job::modulus::ModulusSheet;
use crate::number_file::NumberFile;
use crate::outcome::Setting;
use crate::{InStep, RodlabError};

pub(super) fn of_file(
    sheet: &ModulusSheet,
    source: &RatioSheet,
    context: &JobContext<'_>,
    settings: &mut Vec<Setting>,
) -> Result<Measured, RodlabError> {
    let taken_as = sheet.method.ratio_in_words()?;
    settings.push(Setting::by_default("ratio in the file", taken_as));
    let file = NumberFile::read(&source.path, context.folder, "source.ratio.path")?;
    let hertz = Unit::parse("Hz").map_or(Dimension::NONE, |unit| unit.dimension());
    let (values, frequency_hz) = match &source.values {
        RatioValues::Complex(selector) => {
            let column = file.column(selector, "source.ratio.values.complex")?;
            (
                column.complex_numbers()?,
                column.abscissa(hertz, "frequencies")?,
            )
        }
        RatioValues::Parts { real, imaginary } => {
            let column = file.column(real, "source.ratio.values.parts.real")?;
            let other = file.column(imaginary, "source.ratio.values.parts.imaginary")?;
            let real = column.pure_numbers()?;
            let imaginary = other.pure_numbers()?;
            let frequency_hz = column.abscissa(hertz, "frequencies")?;
            let beside = other.abscissa(hertz, "frequencies")?;
            let alike = |(a, b): (&f64, &f64)| a.total_cmp(b).is_eq();
            if beside.len() != frequency_hz.len() || !frequency_hz.iter().zip(&beside).all(alike) {
                return Err(RodlabError::request(
                    "source.ratio.values.parts.imaginary",
                    format!("a column of {} lines", beside.len()),
                    format!("the {} frequencies of the real part", frequency_hz.len()),
                ));
            }
            let pairs = real.iter().zip(&imaginary);
            (
                pairs.map(|(re, im)| Complex64::new(*re, *im)).collect(),
                frequency_hz,
            )
        }
    };
    let ratio = match &source.errors {
        RatioErrors::Coherence { column, averages } => {
            let coherence = file
                .column(column, "source.ratio.errors.coherence.column")?
                .pure_numbers()?;
            ResponseRatio::from_coherence(frequency_hz, values, coherence, *averages)
        }
        RatioErrors::StandardError { column } => {
            let errors = file
                .column(column, "source.ratio.errors.standard_error.column")?
                .pure_numbers()?;
            let mut lines = errors.iter().enumerate();
            if let Some((line, error)) = lines.find(|(_, error)| **error < 0.0) {
                return Err(RodlabError::request(
                    format!(
                        "source.ratio.errors.standard_error.column, line {}",
                        line + 1
                    ),
                    error.to_string(),
                    "a standard error of 0 or more",
                ));
            }
            let variance = errors.iter().map(|e| e * e).collect();
            ResponseRatio::from_variance(frequency_hz, values, variance)
        }
        RatioErrors::Relative { of_value } => {
            let relative = of_value.si();
            let of = |value: &Complex64| relative * relative * value.norm_sqr();
            let variance = values.iter().map(of).collect();
            ResponseRatio::from_variance(frequency_hz, values, variance)
        }
    };
    Ok(Measured {
        spectra: Some(Spectra::Ratio(ratio.in_step("source.ratio.errors")?)),
        missing: String::new(),
        inputs: vec![file.input],
        log: Vec::new(),
        figures: Vec::new(),
        in_words: Vec::new(),
        warnings: file.warning.into_iter().collect(),
        quantities: Vec::new(),
        first_hit: None,
        sampling_rate_hz: None,
        doubts: Vec::new(),
        each: Vec::new(),
        cut_pulses: Vec::new(),
        accepted: Vec::new(),
        n_found: 0,
    })
}
