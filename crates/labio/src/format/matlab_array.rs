//! MATLAB arrays as series, for all versions of the file format.

use super::text;
use crate::{Abscissa, Contents, Ordinate, Series};

/// An array of numbers whose first axis varies fastest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Array<'a> {
    pub(super) name: &'a str,
    /// Lengths of the axes, whose product is the number of values.
    pub(super) shape: &'a [usize],
    /// Class of the numbers, such as `double`.
    pub(super) class: &'a str,
}

/// Largest number of series made from an array of more than two axes if another axis is longer than
/// that of the series.
const MOST_SHORT_SERIES: usize = 256;

/// Returns the shape of an array of more than two axes, such as `6 x 4096 x 2`, if its samples are
/// not along the axis of the series, which has `length` values: the array would be cut into more
/// than [`MOST_SHORT_SERIES`] short series.
pub(super) fn misplaced(shape: &[usize], length: usize) -> Option<String> {
    let others = shape.iter().product::<usize>() / length.max(1);
    let is_short = shape.iter().any(|&axis| axis > length);
    (shape.len() > 2 && is_short && others > MOST_SHORT_SERIES).then(|| {
        let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
        format!("an array of {}", lengths.join(" x "))
    })
}

/// Returns true if the number of elements, and of those of every part, does not overflow.
pub(super) fn is_countable(shape: &[usize]) -> bool {
    // a length of zero would hide an overflow of the other lengths
    let mut lengths = shape.iter().copied().filter(|&length| length > 0);
    lengths.try_fold(1, usize::checked_mul).is_some()
}

impl<'a> Array<'a> {
    /// Returns the reason for skipping an array whose samples are not along its first axis
    /// ([`misplaced`]).
    pub(super) fn misplaced(&self) -> Option<String> {
        let found = misplaced(self.shape, self.shape.first().copied().unwrap_or(1))?;
        Some(format!(
            "{found}, skipped: save one variable per hit, or the samples along the first dimension"
        ))
    }

    /// Returns a series for each column or, for a matrix that is wider than tall, for each row.
    pub(super) fn series(self, values: &'a Ordinate) -> impl Iterator<Item = Series> + 'a {
        let count: usize = self.shape.iter().product();
        let n_rows = self.shape.first().copied().unwrap_or(1);
        let n_columns = count / n_rows.max(1);
        let is_matrix = self.shape.len() <= 2;
        let vector = is_matrix && (n_rows == 1 || n_columns == 1);
        let along_rows = is_matrix && n_columns > n_rows;
        let (n_series, length) = if along_rows {
            (n_rows, n_columns)
        } else {
            (n_columns, n_rows)
        };
        (0..n_series).map(move |index| {
            let (first, step) = if along_rows {
                (index, n_rows)
            } else {
                (index * n_rows, 1)
            };
            let name = match (vector, along_rows) {
                (true, _) => self.name.to_owned(),
                (_, true) => format!("{}({},:)", self.name, index + 1),
                (_, false) => {
                    let others = self.shape.get(1..).unwrap_or(&[]);
                    format!("{}(:,{})", self.name, subscripts(index, others))
                }
            };
            let properties = match self.class {
                "double" => Vec::new(),
                class => vec![("class".to_owned(), class.to_owned())],
            };
            Series::over_index(name, values.every(first, step, length), properties)
        })
    }
}

/// Property of the contents with the variable from which the sampling rate is taken, such as
/// ``variable `fs`, in Hz``; also in files of Octave and of MATLAB 7.3.
pub const RATE_SOURCE: &str = "source of the sampling rate";

/// Names of variables with a sampling rate in Hz, in lower case and without `_`.
const RATES: [&str; 6] = [
    "fs",
    "fsamp",
    "samplerate",
    "samplingrate",
    "samplefrequency",
    "samplingfrequency",
];
/// Names of variables with a sampling interval in s, in the same form.
const INTERVALS: [&str; 3] = ["dt", "sampleinterval", "samplinginterval"];
/// Lowest sampling rate \[Hz\] that is taken from a variable: a smaller number may be in kHz, and a
/// longer interval in ms.
const LOWEST_RATE: f64 = 1000.0;
/// Largest relative difference between two statements of the same rate.
const SAME_RATE: f64 = 1e-6;

/// Gives the series the times that follow from a variable with the name of a sampling rate or
/// interval, and adds the property [`RATE_SOURCE`]. Without such a variable, for a rate below
/// [`LOWEST_RATE`], if several variables contradict each other, and in a file with complex series,
/// which are spectra, the contents do not change.
pub(super) fn sample_at_stated_rate(contents: &mut Contents) {
    let mut stated = contents.properties.iter().filter_map(|(key, value)| {
        let (rate_hz, unit) = stated_rate(key, value)?;
        Some((rate_hz, format!("variable `{key}`, in {unit}")))
    });
    let Some((rate_hz, source)) = stated.next() else {
        return;
    };
    let is_same = |(other, _): (f64, String)| (other / rate_hz - 1.0).abs() < SAME_RATE;
    let is_real = |series: &Series| matches!(series.ordinate, Ordinate::Real(_));
    let is_usable = rate_hz.is_finite() && rate_hz >= LOWEST_RATE && stated.all(is_same);
    if !(is_usable && contents.series.iter().all(is_real)) {
        return;
    }
    for series in &mut contents.series {
        series.abscissa = Abscissa::Even {
            start: 0.0,
            step: 1.0 / rate_hz,
        };
        series.abscissa_axis = text::axis("time", "s");
    }
    contents.properties.push((RATE_SOURCE.to_owned(), source));
}

/// Returns the sampling rate \[Hz\] that a variable states, and the unit of the variable; `None`
/// for any other variable.
fn stated_rate(variable: &str, value: &str) -> Option<(f64, &'static str)> {
    let name = variable.rsplit('.').next().unwrap_or(variable);
    let name = name.to_lowercase().replace('_', "");
    let is_in = |names: &[&str]| names.contains(&name.as_str());
    let number = || value.parse::<f64>().ok();
    if is_in(&RATES) {
        Some((number()?, "Hz"))
    } else if is_in(&INTERVALS) {
        Some((1.0 / number()?, "s"))
    } else {
        None
    }
}

/// Returns the text that replaces an array without values.
pub(super) fn empty(shape: &[usize], class: &str) -> String {
    let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
    format!("empty, {} {class}", shape.join("x"))
}

/// Returns the text of a single number; `None` if there are several.
pub(super) fn single(values: &Ordinate) -> Option<String> {
    match values {
        Ordinate::Real(values) => match values.as_slice() {
            [one] => Some(one.to_string()),
            _ => None,
        },
        Ordinate::Complex(values) => match values.as_slice() {
            [one] => Some(one.to_string()),
            _ => None,
        },
    }
}

/// Returns the subscripts of column `index`, from 1, in MATLAB's order: the first subscript varies
/// fastest.
fn subscripts(mut index: usize, shape: &[usize]) -> String {
    let texts: Vec<String> = shape
        .iter()
        .map(|&length| {
            let at = index % length.max(1);
            index /= length.max(1);
            (at + 1).to_string()
        })
        .collect();
    texts.join(",")
}

/// Returns the rows of an array of characters with their names; `None` if the array has no rows.
pub(super) fn text_rows<'a>(
    name: &'a str,
    shape: &[usize],
    characters: &'a [char],
) -> Option<impl Iterator<Item = (String, String)> + 'a> {
    let n_rows = match *shape {
        // the shape counts code units; a character may consist of several
        [1, _] => 1,
        [n_rows, n_columns] if n_rows > 0 && n_rows * n_columns == characters.len() => n_rows,
        _ => return None,
    };
    Some((0..n_rows).map(move |row| {
        let text: String = characters.iter().skip(row).step_by(n_rows).collect();
        let key = match n_rows {
            1 => name.to_owned(),
            _ => format!("{name}({},:)", row + 1),
        };
        (key, text)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_belong_along_the_axis_of_the_series() {
        let found = misplaced(&[6, 4096, 2], 6);
        assert_eq!(found.as_deref(), Some("an array of 6 x 4096 x 2"));
        // accepted: only six series; samples along the first axis; a matrix
        assert_eq!(misplaced(&[2, 3, 2], 2), None);
        assert_eq!(misplaced(&[4096, 64, 100], 4096), None);
        assert_eq!(misplaced(&[4096, 5000], 4096), None);
    }
}
