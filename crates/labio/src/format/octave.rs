//! Variables that Octave saves as text (`save hits.mat a b`, its default), read only. Other
//! programs write such files too, because the format needs no library.
//!
//! # Variables
//!
//! | variable | becomes |
//! |---|---|
//! | numbers, text, structures and cell arrays | as in a MATLAB file, with the sampling rate: [`mat5`](super::mat5) |
//! | range `0:1e-5:1` | series of the values of the range |
//! | missing value `NA` | NaN |
//!
//! # Rejected files
//!
//! - Sparse, diagonal and permutation matrices, objects, function handles, reversed ranges and
//!   integers from $`2^{53}`$ on: a strict reading rejects the file, a tolerant one skips the
//!   variable with a defect.
//! - Binary files of Octave (`-binary`), which are not recognised; `save -v7` or `save -hdf5`
//!   writes files that the readers for MATLAB and HDF5 accept.

mod numbers;

use std::iter::Peekable;

use crate::format::matlab_array::{self, Array, single};
use crate::format::reading::{DEEPEST, LONGEST_NAME, Reading};
use crate::format::text;
use crate::format::{MemoryLimit, Reader, Strictness};
use crate::unit::EXACT_INTEGERS;
use crate::{Contents, LabioError, Ordinate, Place, error};

use numbers::{Numbers, next_number, real, transposed};

const FORMAT: &str = "octave";

/// Number of bytes at the start of a file within which its first variable begins.
const HEAD_BYTES: usize = 4096;

/// Text files of Octave; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OctaveText;

impl Reader for OctaveText {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Returns true for a file whose first lines are comments that include the name of a variable
    /// and, in the next line, its type.
    fn recognises(&self, head: &[u8]) -> bool {
        let head = String::from_utf8_lossy(head.get(..HEAD_BYTES).unwrap_or(head));
        let head = head.trim_start_matches('\u{feff}');
        let mut lines = text::lines(head).map(|(_, line)| line.trim());
        let mut comments = lines
            .by_ref()
            .filter(|line| !line.is_empty())
            .take_while(|line| line.starts_with(COMMENT));
        let is_name = |line: &str| field(line).is_some_and(|(key, _)| key == "name");
        comments.any(is_name)
            && lines
                .next()
                .and_then(field)
                .is_some_and(|(key, _)| key == "type")
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let (text, _) = text::decode(bytes, FORMAT)?;
        let mut file = File {
            text: &text,
            lines: text::lines(&text).peekable(),
            line: 0,
            reading: Reading::new(FORMAT, MemoryLimit::of_file(bytes.len()), strictness),
        };
        let about = file.lines.peek().map(|(_, line)| line.trim());
        let is_about = |line: &&str| {
            line.starts_with(COMMENT) && field(line).is_none_or(|(key, _)| key != "name")
        };
        if let Some(about) = about.filter(is_about) {
            let about = about.trim_start_matches(COMMENT).trim().to_owned();
            file.reading.property(0, "description".to_owned(), about)?;
        }
        while file.is_before_name()? {
            file.element(|file, name| file.variable(name.to_owned(), 0))?;
        }
        matlab_array::sample_at_stated_rate(&mut file.reading.contents);
        Ok(file.reading.contents)
    }
}

/// Characters that begin a comment; everything except the values is written in comments.
const COMMENT: [char; 2] = ['#', '%'];

/// Returns key and value of a comment.
fn field(line: &str) -> Option<(&str, &str)> {
    let (key, value) = line.trim().strip_prefix(COMMENT)?.split_once(':')?;
    Some((key.trim(), value.trim()))
}

/// The lines of a file that are still to be read, and the contents read so far.
struct File<'a, I: Iterator<Item = (u64, &'a str)>> {
    text: &'a str,
    lines: Peekable<I>,
    /// Number of the line that was read last.
    line: u64,
    reading: Reading,
}

impl<'a, I: Iterator<Item = (u64, &'a str)>> File<'a, I> {
    /// Position of a line, in bytes.
    fn at(&self, line: &str) -> u64 {
        (line.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize) as u64
    }

    /// Returns the next line, blank or not.
    fn next(&mut self, expected: &str) -> Result<&'a str, LabioError> {
        match self.lines.next() {
            Some((number, line)) => {
                self.line = number;
                Ok(line)
            }
            None => Err(self.malformed("line", "the end of the file", expected)),
        }
    }

    /// Returns the next line that is not blank, without the blanks around it.
    fn filled(&mut self, expected: &str) -> Result<&'a str, LabioError> {
        loop {
            let line = self.next(expected)?.trim();
            if !line.is_empty() {
                return Ok(line);
            }
        }
    }

    /// Returns the value of the next comment, which must have the key `key`.
    fn header(&mut self, key: &str) -> Result<&'a str, LabioError> {
        let expected = format!("`# {key}: ...`");
        if self.coming() == Some("name") && key != "name" {
            // the name is not consumed, so that a tolerant reading can continue with it
            return Err(self.malformed("comment", "the next name", &expected));
        }
        let line = self.filled(&expected)?;
        match field(line) {
            Some((found, value)) if found == key => Ok(value),
            _ => Err(self.malformed("comment", &text::quoted(line), &expected)),
        }
    }

    /// Returns the number in the next comment.
    fn count(&mut self, key: &str) -> Result<usize, LabioError> {
        let value = self.header(key)?;
        let count = value.parse();
        count.map_err(|_| self.malformed(key, &text::quoted(value), "a count"))
    }

    /// Returns the key of the next line that is not blank, without consuming the line.
    fn coming(&mut self) -> Option<&'a str> {
        while self
            .lines
            .next_if(|(_, line)| line.trim().is_empty())
            .is_some()
        {}
        self.lines
            .peek()
            .and_then(|(_, line)| field(line))
            .map(|(key, _)| key)
    }

    /// Skips blank lines and comments between variables up to the next name; false at the end.
    fn is_before_name(&mut self) -> Result<bool, LabioError> {
        while self.coming() != Some("name") {
            let Some((number, line)) = self.lines.next() else {
                return Ok(false);
            };
            self.line = number;
            if !line.trim_start().starts_with(COMMENT) {
                let error = self.malformed("line", &text::quoted(line), "`# name: ...`");
                self.reading.pass_over(error, self.at(line))?;
                self.skip_to_name();
            }
        }
        Ok(true)
    }

    /// Skips lines up to the name of a variable; false if there is none.
    fn skip_to_name(&mut self) -> bool {
        while self.coming() != Some("name") {
            if self.lines.next().is_none() {
                return false;
            }
        }
        true
    }

    fn malformed(&self, field: &str, found: &str, expected: &str) -> LabioError {
        error::malformed(FORMAT, Place::Line(self.line), field, found, expected)
    }

    /// Reads a variable, an element of a cell array or a field: its name, and then, with `read`,
    /// its contents. In a tolerant reading, an error is a defect, and reading continues with the
    /// next name.
    fn element(
        &mut self,
        read: impl FnOnce(&mut Self, &str) -> Result<(), LabioError>,
    ) -> Result<(), LabioError> {
        let at = self.place();
        let result = self.header("name").and_then(|name| read(self, name));
        result.or_else(|error| {
            self.reading.pass_over(error, at)?;
            self.skip_to_name();
            Ok(())
        })
    }

    /// Reads a variable, starting at its type.
    fn variable(&mut self, name: String, depth: usize) -> Result<(), LabioError> {
        if name.len() > LONGEST_NAME || depth > DEEPEST {
            let found = format!("{} bytes, {depth} levels deep", name.len());
            let expected = format!("at most {LONGEST_NAME} bytes and {DEEPEST} levels");
            return Err(self.malformed("name", &found, &expected));
        }
        let kind = self.header("type")?;
        let kind = kind.strip_prefix("global ").unwrap_or(kind);
        match kind {
            "string" | "sq_string" => self.strings(&name),
            "range" | "double_range" => self.range(&name),
            "cell" => {
                let part = |index: usize, _| format!("{name}{{{index}}}");
                self.cells(&name, part, depth)
            }
            "scalar struct" => {
                self.structure(|file, field| file.variable(format!("{name}.{field}"), depth + 1))
            }
            // a structure array is stored as a cell array for each field
            "struct" => self.structure(|file, field| {
                file.header("type")?;
                let part = |index: usize, count: usize| match count {
                    1 => format!("{name}.{field}"),
                    _ => format!("{name}({index}).{field}"),
                };
                file.cells(field, part, depth)
            }),
            _ => match Numbers::of(kind) {
                Some(numbers) => self.numbers(name, numbers),
                None => Err(self.malformed(
                    &format!("type of `{name}`"),
                    &text::quoted(kind),
                    "numbers, text, range, struct or cell",
                )),
            },
        }
    }

    /// Reads the shape of an array: rows and columns, or the lengths of all axes.
    fn shape(&mut self) -> Result<Vec<usize>, LabioError> {
        let shape = if self.coming() == Some("ndims") {
            let n_axes = self.count("ndims")?;
            let line = self.filled("the lengths of the axes")?;
            let lengths = line.trim_start_matches(COMMENT).split_ascii_whitespace();
            let lengths: Result<Vec<usize>, _> = lengths.map(str::parse).collect();
            match lengths {
                Ok(lengths) if lengths.len() == n_axes && n_axes >= 2 => lengths,
                _ => {
                    let expected = format!("lengths of {n_axes} axes, two or more");
                    return Err(self.malformed("shape", &text::quoted(line), &expected));
                }
            }
        } else {
            vec![self.count("rows")?, self.count("columns")?]
        };
        if matlab_array::is_countable(&shape) {
            return Ok(shape);
        }
        let expected = "lengths whose product does not overflow";
        Err(self.malformed("shape", &format!("{shape:?}"), expected))
    }

    fn numbers(&mut self, name: String, numbers: Numbers) -> Result<(), LabioError> {
        if numbers.is_scalar {
            let values = self.values(&name, numbers, 1)?;
            let at = self.place();
            let value = single(&values).unwrap_or_default();
            return self.reading.property(at, name, value);
        }
        let by_rows = self.coming() == Some("rows");
        let shape = self.shape()?;
        let count = shape.iter().product();
        if count == 0 {
            return self.empty(name, &shape, numbers.class);
        }
        let mut values = self.values(&name, numbers, count)?;
        if let [n_rows, n_columns] = *shape.as_slice()
            && by_rows
        {
            values = match values {
                Ordinate::Real(all) => Ordinate::Real(transposed(&all, n_rows, n_columns)),
                Ordinate::Complex(all) => Ordinate::Complex(transposed(&all, n_rows, n_columns)),
            };
        }
        self.array(&name, &shape, numbers.class, &values)
    }

    fn array(
        &mut self,
        name: &str,
        shape: &[usize],
        class: &str,
        values: &Ordinate,
    ) -> Result<(), LabioError> {
        let at = self.place();
        let array = Array { name, shape, class };
        if let Some(found) = array.misplaced() {
            return self.reading.property(at, name.to_owned(), found);
        }
        for series in array.series(values) {
            self.reading.series(at, series)?;
        }
        Ok(())
    }

    fn empty(&mut self, name: String, shape: &[usize], class: &str) -> Result<(), LabioError> {
        let at = self.place();
        let said = matlab_array::empty(shape, class);
        self.reading.property(at, name, said)
    }

    /// Position of the next line, in bytes.
    fn place(&mut self) -> u64 {
        let line = self.lines.peek().map(|(_, line)| *line);
        line.map_or(self.text.len() as u64, |line| self.at(line))
    }

    /// Reads `count` numbers, with any number of them in a line.
    fn values(
        &mut self,
        name: &str,
        numbers: Numbers,
        count: usize,
    ) -> Result<Ordinate, LabioError> {
        let (mut real, mut complex) = (Vec::new(), Vec::new());
        let mut read = 0;
        while read < count {
            let expected = || format!("{count} numbers, of which {read} were read");
            let key = self.coming();
            let Some((number, line)) = self.lines.next_if(|_| key.is_none()) else {
                let found = key.map_or("the end of the file".to_owned(), |key| {
                    format!("the comment `{key}`")
                });
                return Err(self.malformed(&format!("values of `{name}`"), &found, &expected()));
            };
            self.line = number;
            let line = line.trim();
            let mut rest = line;
            while let Some((value, behind)) = next_number(rest, numbers.is_complex) {
                if numbers.class.ends_with("int64") && value.re.abs() >= EXACT_INTEGERS {
                    break;
                }
                if numbers.is_complex {
                    complex.push(value);
                } else {
                    real.push(value.re);
                }
                rest = behind;
            }
            let now = real.len() + complex.len();
            if !rest.is_empty() || now > count {
                let found = text::quoted(if rest.is_empty() { line } else { rest });
                return Err(self.malformed(&format!("values of `{name}`"), &found, &expected()));
            }
            read = now;
        }
        Ok(if numbers.is_complex {
            Ordinate::Complex(complex)
        } else {
            Ordinate::Real(real)
        })
    }

    fn strings(&mut self, name: &str) -> Result<(), LabioError> {
        // old versions write one text, preceded only by its length
        let n_rows = match self.coming() {
            Some("elements") => self.count("elements")?,
            _ => 1,
        };
        if n_rows == 0 {
            if self.coming() == Some("length") {
                self.count("length")?;
            }
            return self.empty(name.to_owned(), &[0, 0], "char");
        }
        for row in 1..=n_rows {
            let length = self.count("length")?;
            let expected = format!("a text of {length} characters");
            let (mut text, mut characters, mut is_first) = (String::new(), 0, true);
            // a text may have several lines; its length is in bytes of an unknown encoding
            while text.len() < length && characters < length {
                if !is_first {
                    text.push('\n');
                    characters += 1;
                }
                is_first = false;
                let line = self.next(&expected)?;
                text.push_str(line);
                characters += line.chars().count();
            }
            let key = match n_rows {
                1 => name.to_owned(),
                _ => format!("{name}({row},:)"),
            };
            let at = self.place();
            self.reading.property(at, key, text)?;
        }
        Ok(())
    }

    fn range(&mut self, name: &str) -> Result<(), LabioError> {
        const EXPECTED: &str = "first value, limit and step of a range that is not reversed";
        let has_length = self.filled(EXPECTED)?.contains("length");
        let line = self.filled(EXPECTED)?;
        let refused = |file: &Self| file.malformed(name, &text::quoted(line), EXPECTED);
        let numbers: Option<Vec<f64>> = line.split_ascii_whitespace().map(real).collect();
        let (first, limit, step) = match numbers.as_deref() {
            // a nonzero fourth number would reverse the range
            Some(&[first, limit, step]) => (first, limit, step),
            Some(&[first, limit, step, reversed]) if reversed.abs() < 0.5 => (first, limit, step),
            _ => return Err(refused(self)),
        };
        let n = if has_length {
            limit
        } else {
            // the last value belongs to the range if only a rounding error places it beyond the
            // limit
            ((limit - first) / step * (1.0 + 3.0 * f64::EPSILON)).floor() + 1.0
        };
        if !(n.is_finite() && first.is_finite() && step.is_finite()) {
            return Err(refused(self));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative; the memory for it is counted before it is allocated"
        )]
        let n = n.max(0.0) as usize;
        if n == 0 {
            return self.empty(name.to_owned(), &[1, 0], "double");
        }
        let place = Place::Line(self.line);
        self.reading
            .budget
            .take(n, 2 * size_of::<f64>(), place, name)?;
        let values = (0..n).map(|k| first + k as f64 * step).collect();
        self.array(name, &[1, n], "double", &Ordinate::Real(values))?;
        self.reading.budget.give_back(2 * size_of::<f64>() * n);
        Ok(())
    }

    /// Reads the elements of a cell array; `part` names an element from its number, counted from 1,
    /// and the number of elements.
    fn cells(
        &mut self,
        name: &str,
        part: impl Fn(usize, usize) -> String,
        depth: usize,
    ) -> Result<(), LabioError> {
        let shape = self.shape()?;
        let count = shape.iter().product();
        if count == 0 {
            return self.empty(name.to_owned(), &shape, "cell");
        }
        self.parts(count, |file, index, _| {
            file.variable(part(index, count), depth + 1)
        })
    }

    /// Reads `count` elements or fields. `read` reads each of them, starting at its type, and
    /// receives its number, counted from 1, and its name.
    fn parts(
        &mut self,
        count: usize,
        mut read: impl FnMut(&mut Self, usize, &str) -> Result<(), LabioError>,
    ) -> Result<(), LabioError> {
        for index in 1..=count {
            if self.coming() != Some("name") {
                let (found, expected) = ((index - 1).to_string(), count.to_string());
                return Err(self.malformed("number of elements or fields", &found, &expected));
            }
            self.element(|file, name| read(file, index, name))?;
        }
        Ok(())
    }

    /// Reads the fields of a structure; `read` reads each field, starting at its type.
    fn structure(
        &mut self,
        mut read: impl FnMut(&mut Self, &str) -> Result<(), LabioError>,
    ) -> Result<(), LabioError> {
        if self.coming() == Some("ndims") {
            self.shape()?;
        }
        let count = self.count("length")?;
        self.parts(count, |file, _, name| read(file, name))
    }
}

#[cfg(test)]
mod tests;
