//! A ratio of spectra computed by another program.

use labio::ResponseRatio;
use num_complex::Complex64;

use super::{Measured, RatioErrors, RatioSheet, RatioValues, Spectra};
use crate::job::JobContext;
use crate::job::modulus::ModulusSheet;
use crate::number_file::NumberFile;
use crate::outcome::Setting;
use crate::records::Selector;
use crate::sheet::{Frequency, Kind};
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
    let numbers = |column: &Selector, field: &str| {
        let column = file.column(column, &format!("source.ratio.{field}"))?;
        column.pure_numbers()
    };
    let hertz = Frequency::DIMENSION;
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
            let coherence = numbers(column, "errors.coherence.column")?;
            ResponseRatio::from_coherence(frequency_hz, values, coherence, *averages)
        }
        RatioErrors::StandardError { column } => {
            let field = "errors.standard_error.column";
            let errors = numbers(column, field)?;
            let mut lines = (1..).zip(&errors);
            if let Some((line, error)) = lines.find(|(_, error)| **error < 0.0) {
                return Err(RodlabError::request(
                    format!("source.ratio.{field}, line {line}"),
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
        inputs: vec![file.input],
        warnings: file.warning.into_iter().collect(),
        ..Measured::default()
    })
}
