//! MATLAB arrays as series, for all versions of the file format.

use crate::series::every;
use crate::{Abscissa, Ordinate, Series, SeriesAxis, SeriesKind};

/// An array of numbers whose first axis varies fastest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Array<'a> {
    pub(super) name: &'a str,
    /// Lengths of the axes, whose product is the number of values.
    pub(super) shape: &'a [usize],
    /// Class of the numbers, such as `double`.
    pub(super) class: &'a str,
}

impl<'a> Array<'a> {
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
            Series {
                name,
                kind: SeriesKind::General,
                abscissa: Abscissa::Even {
                    start: 0.0,
                    step: 1.0,
                },
                ordinate: match values {
                    Ordinate::Real(all) => Ordinate::Real(every(all, first, step, length)),
                    Ordinate::Complex(all) => Ordinate::Complex(every(all, first, step, length)),
                },
                abscissa_axis: SeriesAxis {
                    label: "index".to_owned(),
                    ..SeriesAxis::default()
                },
                ordinate_axis: SeriesAxis::default(),
                properties: match self.class {
                    "double" => Vec::new(),
                    class => vec![("class".to_owned(), class.to_owned())],
                },
            }
        })
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
