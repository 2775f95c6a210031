//! Files of numbers over time or frequency that are not records of sensors, such as loss factors or
//! ratios of spectra.

use std::path::Path;

use labio::{Abscissa, Contents, Dimension, Ordinate, Series, Unit, format};
use num_complex::Complex64;

use crate::cut_short;
use crate::input;
use crate::outcome::InputFile;
use crate::records::Selector;
use crate::{InStep, RodlabError};

/// A file that was read.
#[derive(Debug)]
pub(crate) struct NumberFile {
    pub(crate) contents: Contents,
    pub(crate) input: InputFile,
    /// Warning about a last line without a line ending, if there is such a line.
    pub(crate) warning: Option<String>,
}

impl NumberFile {
    /// Reads the file at `path`, relative to `folder`; `field` is its place in the sheet.
    pub(crate) fn read(path: &str, folder: &Path, field: &str) -> Result<Self, RodlabError> {
        let full = folder.join(path);
        if !full.exists() {
            return Err(RodlabError::no_file(path, folder, field));
        }
        let bytes = input::read(&full)?;
        let contents = format::read_bytes(&bytes).in_step(format!("{field}: reading {path}"))?;
        let input = InputFile::of(path, contents.format, &bytes);
        let warning = cut_short::warning(&bytes, contents.format, path).map(|text| text + ".");
        Ok(Self {
            contents,
            input,
            warning,
        })
    }

    /// Returns the column named by `selector`; columns are counted from 1, without the abscissa.
    pub(crate) fn column(
        &self,
        selector: &Selector,
        field: &str,
    ) -> Result<Column<'_>, RodlabError> {
        let field = format!("{field} ({})", self.input.path);
        let series = selector.column(&self.contents.series, |series| &series.name, &field)?;
        Ok(Column { series, field })
    }
}

/// A column of a file, with its abscissa.
#[derive(Debug)]
pub(crate) struct Column<'a> {
    series: &'a Series,
    field: String,
}

impl Column<'_> {
    /// Returns the abscissa in SI units. It must have this `dimension`; `quantity` is its name in
    /// errors.
    pub(crate) fn abscissa(
        &self,
        dimension: Dimension,
        quantity: &str,
    ) -> Result<Vec<f64>, RodlabError> {
        let axis = &self.series.abscissa_axis;
        let unit = axis.unit.as_ref().filter(|u| u.dimension() == dimension);
        let Some(unit) = unit else {
            let found = if axis.unit_text.is_empty() {
                format!("over `{}`, without a unit", axis.label)
            } else {
                format!("over `{}` [{}]", axis.label, axis.unit_text)
            };
            return Err(self.refused(&found, &format!("a column over {quantity}, with a unit")));
        };
        let count = self.series.ordinate.len();
        Ok(match &self.series.abscissa {
            Abscissa::Even { start, step } => {
                let at = |index: usize| unit.to_si(start + index as f64 * step);
                (0..count).map(at).collect()
            }
            Abscissa::Uneven(values) => values.iter().map(|value| unit.to_si(*value)).collect(),
        })
    }

    /// Returns the values as pure numbers; they may have no unit, `%` or `1`.
    pub(crate) fn pure_numbers(&self) -> Result<Vec<f64>, RodlabError> {
        let unit = self.pure_unit()?;
        match &self.series.ordinate {
            Ordinate::Real(values) => Ok(values
                .iter()
                .map(|value| unit.as_ref().map_or(*value, |unit| unit.to_si(*value)))
                .collect()),
            Ordinate::Complex(_) => Err(self.refused("of complex numbers", "real numbers")),
        }
    }

    /// Returns the values as complex numbers without a unit.
    pub(crate) fn complex_numbers(&self) -> Result<Vec<Complex64>, RodlabError> {
        self.pure_unit()?;
        match &self.series.ordinate {
            Ordinate::Complex(values) => Ok(values.clone()),
            Ordinate::Real(_) => Err(self.refused(
                "of real numbers",
                "complex numbers, or `real` and `imaginary` separately",
            )),
        }
    }

    fn pure_unit(&self) -> Result<Option<Unit>, RodlabError> {
        let axis = &self.series.ordinate_axis;
        match &axis.unit {
            Some(unit) if unit.dimension() == Dimension::NONE => Ok(Some(unit.clone())),
            None if axis.unit_text.is_empty() => Ok(None),
            _ => Err(self.refused(&format!("in [{}]", axis.unit_text), "a pure number")),
        }
    }

    fn refused(&self, found: &str, expected: &str) -> RodlabError {
        let found = format!("`{}`, a column {found}", self.series.name);
        RodlabError::request(self.field.as_str(), found, expected)
    }
}
