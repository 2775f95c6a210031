//! One-dimensional data sets of a file with their axes, before they become a
//! [`Record`](crate::Record).

use num_complex::Complex64;

use crate::{LabioError, Unit};

/// Kind of the numbers of a [`Series`]. The names are those of the function types of universal data
/// set 58.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SeriesKind {
    /// General or unknown.
    General,
    /// A time history.
    TimeResponse,
    /// Auto-spectrum.
    AutoSpectrum,
    /// Cross-spectrum.
    CrossSpectrum,
    /// Frequency response function.
    FrequencyResponse,
    /// Transmissibility.
    Transmissibility,
    /// Ordinary coherence.
    Coherence,
    /// Auto-correlation.
    AutoCorrelation,
    /// Cross-correlation.
    CrossCorrelation,
    /// Power spectral density.
    PowerSpectralDensity,
    /// Energy spectral density.
    EnergySpectralDensity,
    /// Spectrum.
    Spectrum,
    /// Another function type of data set 58, by its number.
    Other(u8),
}

/// Abscissa values of a [`Series`], in the unit of its abscissa axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Abscissa {
    /// Equally spaced: `start`, `start + step`, ...
    Even {
        /// First value.
        start: f64,
        /// Difference between consecutive values.
        step: f64,
    },
    /// One value for each ordinate.
    Uneven(Vec<f64>),
}

/// The values of a [`Series`], in the unit of its ordinate axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Ordinate {
    /// Real numbers.
    Real(Vec<f64>),
    /// Complex numbers.
    Complex(Vec<Complex64>),
}

impl Ordinate {
    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Complex(values) => values.len(),
        }
    }

    /// Returns true if there are no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns a contiguous copy of `n` values, starting at `first` in steps of `step`: a row or a
    /// column of a table.
    pub(crate) fn every(&self, first: usize, step: usize, n: usize) -> Self {
        fn line<T: Copy>(values: &[T], first: usize, step: usize, n: usize) -> Vec<T> {
            let line = values.iter().skip(first).step_by(step.max(1));
            line.take(n).copied().collect()
        }
        match self {
            Self::Real(values) => Self::Real(line(values, first, step, n)),
            Self::Complex(values) => Self::Complex(line(values, first, step, n)),
        }
    }
}

/// Meaning of one axis of a [`Series`], as stated in the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SeriesAxis {
    /// The label, for example `Time` or `Acceleration`; empty if the file states none.
    pub label: String,
    /// The text of the unit as written; empty if the file states none.
    pub unit_text: String,
    /// The unit, if `unit_text` is a known one.
    pub unit: Option<Unit>,
}

/// One data set of a file: values as a function of an abscissa, in the file's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name of the channel or of the data set; may be empty.
    pub name: String,
    /// Kind of the values.
    pub kind: SeriesKind,
    /// Abscissa of the values.
    pub abscissa: Abscissa,
    /// The values.
    pub ordinate: Ordinate,
    /// Meaning and unit of the abscissa.
    pub abscissa_axis: SeriesAxis,
    /// Meaning and unit of the ordinate.
    pub ordinate_axis: SeriesAxis,
    /// All other information of the file about this data set, in the order of the file.
    pub properties: Vec<(String, String)>,
}

impl Series {
    /// Creates a general series over the index of its values.
    pub(crate) fn over_index(
        name: String,
        ordinate: Ordinate,
        properties: Vec<(String, String)>,
    ) -> Self {
        Self {
            name,
            kind: SeriesKind::General,
            abscissa: Abscissa::Even {
                start: 0.0,
                step: 1.0,
            },
            ordinate,
            abscissa_axis: SeriesAxis {
                label: "index".to_owned(),
                ..SeriesAxis::default()
            },
            ordinate_axis: SeriesAxis::default(),
            properties,
        }
    }
}

/// The contents read from a file.
#[derive(Debug)]
#[non_exhaustive]
pub struct Contents {
    /// Name of the format.
    pub format: &'static str,
    /// Information about the file as a whole.
    pub properties: Vec<(String, String)>,
    /// The data sets, in the order of the file.
    pub series: Vec<Series>,
    /// Parts that could not be read and were skipped: always empty after a strict reading.
    pub defects: Vec<LabioError>,
}

impl Contents {
    /// Creates empty contents of the format called `format`.
    #[must_use]
    pub fn of_format(format: &'static str) -> Self {
        Self {
            format,
            properties: Vec::new(),
            series: Vec::new(),
            defects: Vec::new(),
        }
    }
}
