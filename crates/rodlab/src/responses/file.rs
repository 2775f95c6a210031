//! Frequency response in a file.

use std::path::Path;

use labio::format;
use labio::{
    Abscissa, Channel, Contents, Dimension, FrequencyResponse, Ordinate, Provenance, Quantity,
    ResponseKind, Series, SeriesKind,
};
use num_complex::Complex64;
use serde::Deserialize;

use super::kind::{dimension, quantities};
use crate::outcome::InputFile;
use crate::records::Selector;
use crate::{Outcome, RodlabError, cut_short, earlier, input, universal};

/// Tolerance for the frequency of a line, as a fraction of the spacing; it allows for rounding of
/// the frequencies.
const OFF_GRID: f64 = 1e-3;

/// Maximum number of lines below the first line of a file, about a million. If the spacing is
/// rounded to nearly zero in the file, the lines would otherwise need more memory than there is.
const MOST_BEFORE: usize = 1 << 20;

/// Suffix that turns the name of a response into the name of its standard error.
pub(crate) const STANDARD_ERROR: &str = ", standard error";

/// Suffix that turns the name of a response into the name of the degrees of freedom of its standard
/// error.
pub(crate) const FREEDOM: &str = ", degrees of freedom";

/// Suffix that turns the name of a response into the name of the relative standard uncertainty that
/// is common to all of its lines.
pub(crate) const COMMON_ERROR: &str = ", error that lines share";

/// Prefix of the number of averages in the third text field of a data set.
pub(crate) const AVERAGES: &str = "averages: ";

/// A frequency response in a file: UFF58, or any other format with lines on a frequency axis.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseFile {
    /// Name of the file, relative to the sheet.
    pub file: String,
    /// Data set, by number from 1 or by name; by default the only complex data set. If real and
    /// imaginary part are two columns, the data set of the real part.
    pub data_set: Option<Selector>,
    /// Column of the imaginary part, if it is separate.
    pub imaginary: Option<Selector>,
    /// Kind of response, such as `Mobility`; by default the kind that suits the unit.
    pub kind: Option<ResponseKind>,
    /// Data set with the standard error of each line, that is the square root of the variance of
    /// the complex number, in the unit of the response. By default the data set that has the name
    /// of the response with the suffix `, standard error`, if there is one.
    pub standard_error: Option<Selector>,
    /// Data set with the coherence, from which the standard error is computed together with
    /// `averages`.
    pub coherence: Option<Selector>,
    /// Number of averaged hits.
    pub averages: Option<usize>,
}

/// Lines of a data set on the grid of a response.
struct Lines {
    spacing_hz: f64,
    /// Number of grid lines below the first line of the file.
    before: usize,
}

impl ResponseFile {
    /// Reads the response and enters the file in `outcome`. A doubt about the result to which the
    /// file belongs becomes a doubt of the outcome.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] with the file or the place below `field`.
    pub fn read(
        &self,
        folder: &Path,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<FrequencyResponse, RodlabError> {
        let path = folder.join(&self.file);
        let bytes = input::read(&path)?;
        let reading = |error| RodlabError::step(format!("reading {}", self.file), error);
        let contents = format::read_bytes(&bytes).map_err(reading)?;
        let provenance = Provenance::of_file(Path::new(&self.file), contents.format, &bytes);
        let hash = provenance.hash();
        let input = InputFile::hashed(&self.file, contents.format, &bytes, hash);
        outcome.inputs.push(input);
        if let Some(reason) = earlier::doubt(&path, &bytes) {
            outcome.doubt(format!(
                "{field}: the response of {} is in doubt: {reason}",
                self.file
            ));
        }
        outcome
            .warnings
            .extend(cut_short::warning(&bytes, contents.format, &self.file).map(|text| text + "."));
        let series = self.data_set(&contents, field)?;
        let lines = self.lines(series, field)?;
        let (kind, scale) = self.kind_and_scale(series, field, outcome)?;
        let mut values = self.values(&contents, series, field)?;
        for value in &mut values {
            *value *= scale;
        }
        let nothing = Complex64::new(f64::NAN, f64::NAN);
        values.splice(0..0, std::iter::repeat_n(nothing, lines.before));
        let [input, output] = quantities(kind);
        let channel = |quantity: Quantity| Channel::new(quantity.name(), quantity).map_err(reading);
        let mut response = FrequencyResponse::of_lines(
            channel(input)?,
            channel(output)?,
            lines.spacing_hz,
            values,
        )
        .map_err(reading)?;
        let said = series.properties.iter().find_map(|(field, text)| {
            let number = text.strip_prefix(AVERAGES)?;
            (field == "uff58.id3")
                .then(|| number.trim().parse().ok())
                .flatten()
        });
        response.n_averages = said.unwrap_or(response.n_averages);
        response.added_damping = universal::damping_of(&contents, series, field)?;
        self.with_errors(response, &contents, (&series.name, &lines), scale, field)
    }

    fn with_errors(
        &self,
        response: FrequencyResponse,
        contents: &Contents,
        (name, lines): (&str, &Lines),
        scale: f64,
        field: &str,
    ) -> Result<FrequencyResponse, RodlabError> {
        let n_lines = response.values.len();
        let reals = |selector: &Selector, name: &str| -> Result<Vec<f64>, RodlabError> {
            let place = format!("{field}.{name}");
            let series = self.selected(contents, selector, &place)?;
            let Ordinate::Real(values) = &series.ordinate else {
                return Err(RodlabError::request(
                    place,
                    format!("{selector}, which is complex"),
                    "a data set of real numbers",
                ));
            };
            // a data set that begins lower, such as a coherence at 0 Hz, has lines that the
            // response lacks
            let own = self.lines(series, &place)?;
            let mut values: Vec<f64> = std::iter::repeat_n(f64::NAN, own.before)
                .chain(values.iter().copied())
                .collect();
            if values.len() != n_lines || (own.spacing_hz / lines.spacing_hz - 1.0).abs() > OFF_GRID
            {
                return Err(RodlabError::request(
                    place,
                    format!(
                        "{} lines {} Hz apart",
                        values.len() - own.before,
                        own.spacing_hz
                    ),
                    format!("the lines of the response, up to {n_lines}"),
                ));
            }
            values.truncate(n_lines);
            Ok(values)
        };
        let step = |error| RodlabError::step(format!("{field}, {}", self.file), error);
        let beside = |what: &str| {
            let name = format!("{name}{what}");
            let called = contents.series.iter().any(|series| series.name == name);
            called.then_some(Selector::Name(name))
        };
        let by_default = beside(STANDARD_ERROR).filter(|_| self.coherence.is_none());
        let standard_error = self.standard_error.as_ref().or(by_default.as_ref());
        let mut response = match (standard_error, &self.coherence, self.averages) {
            (Some(selector), _, _) => {
                let errors = reals(selector, "standard_error")?;
                let variance = errors.iter().map(|e| (e * scale).powi(2)).collect();
                let mut response = response.with_variance(variance).map_err(step)?;
                if let Some(selector) = beside(FREEDOM) {
                    let freedom = reals(&selector, "degrees of freedom")?;
                    response = response.with_degrees_of_freedom(&freedom).map_err(step)?;
                }
                response
            }
            (None, Some(selector), Some(averages)) => response
                .with_coherence(reals(selector, "coherence")?, averages)
                .map_err(step)?,
            (None, Some(_), None) => {
                return Err(RodlabError::request(
                    format!("{field}.averages"),
                    "not stated",
                    "the number of hits, which gives the errors together with the coherence",
                ));
            }
            (None, None, Some(_)) => {
                return Err(RodlabError::request(
                    format!("{field}.coherence"),
                    "not stated",
                    "the data set of the coherence, which gives the errors together with the averages",
                ));
            }
            (None, None, None) => response,
        };
        if let Some(selector) = beside(COMMON_ERROR) {
            let errors = reals(&selector, "error that lines share")?;
            response = response.with_common_errors(&errors).map_err(step)?;
        }
        Ok(response)
    }

    /// Returns the data set of the response.
    fn data_set<'a>(&self, contents: &'a Contents, field: &str) -> Result<&'a Series, RodlabError> {
        let place = format!("{field}.data_set");
        if let Some(selector) = &self.data_set {
            return self.selected(contents, selector, &place);
        }
        let complex: Vec<&Series> = contents
            .series
            .iter()
            .filter(|series| matches!(series.ordinate, Ordinate::Complex(_)))
            .filter(|series| {
                !matches!(
                    series.kind,
                    SeriesKind::CrossSpectrum | SeriesKind::Spectrum
                )
            })
            .collect();
        match complex.as_slice() {
            [only] => Ok(only),
            several => Err(RodlabError::request(
                place,
                format!(
                    "not stated, and {} has {} complex data sets",
                    self.file,
                    several.len()
                ),
                listed(contents),
            )),
        }
    }

    fn selected<'a>(
        &self,
        contents: &'a Contents,
        selector: &Selector,
        place: &str,
    ) -> Result<&'a Series, RodlabError> {
        let asked = selector.as_asked("data set");
        let listed = listed(contents);
        let found = selector.matching(&contents.series, |series| &series.name);
        match found.as_slice() {
            [only] => Ok(only),
            [] => {
                let expected = format!("{listed} ({})", self.file);
                Err(RodlabError::request(place, asked, expected))
            }
            _ => {
                let found = format!(
                    "{asked}, which is the name of several data sets of {}",
                    self.file
                );
                let expected = format!("its number: {listed}");
                Err(RodlabError::request(place, found, expected))
            }
        }
    }

    /// Returns the lines of a data set, which must be evenly spaced, at multiples of their spacing.
    fn lines(&self, series: &Series, field: &str) -> Result<Lines, RodlabError> {
        let off = |found: String| {
            RodlabError::request(
                format!("{field}, {}", self.file),
                found,
                "lines at multiples of their spacing, in Hz",
            )
        };
        let axis = &series.abscissa_axis;
        let unit = match &axis.unit {
            Some(unit) if Some(unit.dimension()) == Dimension::NONE.quotient(Dimension::TIME) => {
                unit
            }
            Some(unit) => return Err(off(format!("over {}", unit.symbol()))),
            None => {
                return Err(off(format!(
                    "over an axis without a unit, `{}`",
                    axis.label
                )));
            }
        };
        let (start, step) = match &series.abscissa {
            Abscissa::Even { start, step } => (unit.to_si(*start), unit.to_si(*step)),
            Abscissa::Uneven(values) => {
                let (Some(first), Some(last)) = (values.first(), values.last()) else {
                    return Err(off("without a line".to_owned()));
                };
                let step = (last - first) / (values.len().max(2) - 1) as f64;
                let mut places = values.iter().enumerate();
                let on_grid = |k: usize, value: f64| {
                    (value - first - k as f64 * step).abs() <= OFF_GRID * step
                };
                // a frequency that is not a number is not on the grid
                if let Some((line, value)) = places.find(|(k, value)| !on_grid(*k, **value)) {
                    return Err(off(format!("uneven at line {line}, {value}")));
                }
                (unit.to_si(*first), unit.to_si(step))
            }
        };
        let before = (start / step).round();
        if !(step > 0.0 && before >= 0.0 && (start / step - before).abs() < OFF_GRID) {
            return Err(off(format!("lines {step} Hz apart, from {start} Hz")));
        }
        // the number is limited, because memory is also allocated for the lines below the first
        // line
        let before = (0..MOST_BEFORE).find(|n| *n as f64 >= before);
        Ok(Lines {
            spacing_hz: step,
            before: before.ok_or_else(|| off(format!("a first line at {start} Hz")))?,
        })
    }

    fn kind_and_scale(
        &self,
        series: &Series,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<(ResponseKind, f64), RodlabError> {
        let place = format!("{field}.kind");
        match (&series.ordinate_axis.unit, self.kind) {
            (Some(unit), stated) => {
                let found = ResponseKind::ALL
                    .into_iter()
                    .find(|kind| dimension(*kind) == Some(unit.dimension()));
                match (found, stated) {
                    (Some(found), None) => Ok((found, unit.scale())),
                    (Some(found), Some(kind)) if found == kind => Ok((found, unit.scale())),
                    (Some(found), Some(kind)) => Err(RodlabError::request(
                        place,
                        kind.to_string(),
                        format!("{found}, because {} is in {}", self.file, unit.symbol()),
                    )),
                    (None, _) => Err(RodlabError::request(
                        format!("{field}.file"),
                        format!("{}, whose data set is in {}", self.file, unit.symbol()),
                        "a response between a force and a motion, such as one in m/s/N",
                    )),
                }
            }
            (None, Some(kind)) => {
                outcome.warn(format!(
                    "{} states no known unit: its numbers are treated as {kind} in SI units.",
                    self.file
                ));
                Ok((kind, 1.0))
            }
            (None, None) => Err(RodlabError::request(
                place,
                "not stated",
                format!(
                    "the kind of the response, such as `mobility` (in RON `Mobility`): {} states no known unit",
                    self.file
                ),
            )),
        }
    }

    fn values(
        &self,
        contents: &Contents,
        series: &Series,
        field: &str,
    ) -> Result<Vec<Complex64>, RodlabError> {
        match (&series.ordinate, &self.imaginary) {
            (Ordinate::Complex(values), None) => Ok(values.clone()),
            (Ordinate::Complex(_), Some(selector)) => Err(RodlabError::request(
                format!("{field}.imaginary"),
                selector.to_string(),
                "no value: the data set is complex",
            )),
            (Ordinate::Real(real), Some(selector)) => {
                let place = format!("{field}.imaginary");
                match &self.selected(contents, selector, &place)?.ordinate {
                    Ordinate::Real(imaginary) if imaginary.len() == real.len() => Ok(real
                        .iter()
                        .zip(imaginary)
                        .map(|(re, im)| Complex64::new(*re, *im))
                        .collect()),
                    other => Err(RodlabError::request(
                        place,
                        format!("{selector} with {} numbers", other.len()),
                        format!("{} real numbers", real.len()),
                    )),
                }
            }
            (Ordinate::Real(_), None) => Err(RodlabError::request(
                format!("{field}.imaginary"),
                "not stated",
                "the column of the imaginary part: the data set is real",
            )),
        }
    }
}

/// Returns a list of the data sets in the file.
fn listed(contents: &Contents) -> String {
    let named = contents
        .series
        .iter()
        .zip(1..)
        .map(|(series, number)| match series.name.trim() {
            "" => number.to_string(),
            name => format!("{number} `{name}`"),
        });
    let names: Vec<String> = named.take(20).collect();
    format!("one of the data sets {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use labio::{SeriesAxis, Unit};

    fn refused(abscissa: Abscissa) -> String {
        let file = ResponseFile {
            file: "response.uff".to_owned(),
            data_set: None,
            imaginary: None,
            kind: None,
            standard_error: None,
            coherence: None,
            averages: None,
        };
        let series = Series {
            name: "H".to_owned(),
            kind: SeriesKind::FrequencyResponse,
            abscissa,
            ordinate: Ordinate::Complex(vec![Complex64::ONE; 3]),
            abscissa_axis: SeriesAxis {
                unit: Unit::parse("Hz").ok(),
                ..SeriesAxis::default()
            },
            ordinate_axis: SeriesAxis::default(),
            properties: Vec::new(),
        };
        let lines = file.lines(&series, "source");
        lines.map(|lines| lines.before).unwrap_err().to_string()
    }

    #[test]
    fn a_frequency_that_is_no_number_is_on_no_grid() {
        assert_eq!(
            refused(Abscissa::Uneven(vec![0.0, f64::NAN, 2.0])),
            "source, response.uff is uneven at line 1, NaN, expected lines at multiples of their spacing, in Hz"
        );
    }

    #[test]
    fn a_spacing_of_nearly_nothing_takes_no_memory_for_the_lines_below() {
        let error = refused(Abscissa::Even {
            start: 1e4,
            step: 1e-3,
        });
        assert!(error.contains("a first line at 10000 Hz"), "{error}");
    }
}
