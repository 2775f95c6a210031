//! Numbers as Octave writes them, and their types.

use num_complex::Complex64;

use crate::format::text::{self, DecimalMark};

/// Numeric type of a variable.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) class: &'static str,
    pub(super) is_complex: bool,
    pub(super) is_scalar: bool,
}

impl Numbers {
    /// Returns the numeric type described by the words of `kind`, such as `float complex matrix`;
    /// `None` for any other type.
    pub(super) fn of(kind: &str) -> Option<Self> {
        const INTEGERS: [&str; 8] = [
            "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
        ];
        let (words, is_scalar) = match kind.rsplit_once(' ').unwrap_or(("", kind)) {
            (words, "scalar") => (words, true),
            (words, "matrix") => (words, false),
            ("", "bool") => ("bool", true),
            _ => return None,
        };
        let (words, is_complex) = match words.strip_suffix("complex") {
            Some(words) => (words.trim_end(), true),
            None => (words, false),
        };
        let class = match words {
            "" => "double",
            "float" => "single",
            "bool" => "logical",
            integer => INTEGERS.into_iter().find(|class| *class == integer)?,
        };
        Some(Self {
            class,
            is_complex,
            is_scalar,
        })
    }
}

/// Parses a number as Octave writes it; a missing value is NaN.
pub(super) fn real(text: &str) -> Option<f64> {
    match text {
        "NA" => Some(f64::NAN),
        _ => text::real(text, DecimalMark::Point),
    }
}

/// Parses the first number of a line, complex ones as `(1,2)`, and returns it with the rest of the
/// line.
pub(super) fn next_number(line: &str, is_complex: bool) -> Option<(Complex64, &str)> {
    if is_complex {
        let (inside, behind) = line.strip_prefix('(')?.split_once(')')?;
        let (re, im) = inside.split_once(',')?;
        let value = Complex64::new(real(re.trim())?, real(im.trim())?);
        return Some((value, behind.trim_start()));
    }
    let end = line.find(|c: char| c.is_ascii_whitespace());
    let (number, behind) = line.split_at(end.unwrap_or(line.len()));
    Some((Complex64::from(real(number)?), behind.trim_start()))
}

/// Returns the values of a matrix column by column; `by_rows` contains them row by row.
pub(super) fn transposed<T: Copy>(by_rows: &[T], n_rows: usize, n_columns: usize) -> Vec<T> {
    (0..n_columns)
        .flat_map(|column| by_rows.iter().skip(column).step_by(n_columns).take(n_rows))
        .copied()
        .collect()
}
