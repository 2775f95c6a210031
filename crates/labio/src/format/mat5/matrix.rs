//! Arrays: numbers, texts, structures and cells.

use num_complex::Complex64;

use super::element::{Cursor, Element};
use super::{MATRIX, malformed};
use crate::format::matlab_array::{self, Array, single, text_rows};
use crate::format::reading::{DEEPEST, LONGEST_NAME, Reading};
use crate::{LabioError, Ordinate, Place};

/// Names of the numeric classes, from class number 6 on.
const NUMBERS: [&str; 10] = [
    "double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
];

/// Kinds of arrays and their numbers in the file.
const CELL: u32 = 1;
const STRUCTURE: u32 = 2;
const TEXT: u32 = 4;

/// The fields before the data of an array.
struct Head {
    class: u32,
    complex: bool,
    logical: bool,
    shape: Vec<usize>,
    name: String,
    at: u64,
}

impl Head {
    fn n(&self) -> usize {
        // checked when the head was read
        self.shape.iter().product()
    }

    fn class_name(&self) -> &'static str {
        if self.logical {
            return "logical";
        }
        let number = self
            .class
            .checked_sub(6)
            .and_then(|at| NUMBERS.get(at as usize));
        number.copied().unwrap_or(match self.class {
            CELL => "cell",
            STRUCTURE => "struct",
            3 => "object",
            TEXT => "char",
            5 => "sparse",
            16 => "function handle",
            17 => "opaque object",
            _ => "unknown",
        })
    }
}

/// Adds the array in `cursor` to `contents`, under `name` or, if `name` is empty, under the name
/// stored in the array.
pub(super) fn read(
    mut cursor: Cursor<'_>,
    name: &str,
    depth: usize,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let at = cursor.offset();
    if depth > DEEPEST {
        return Err(malformed(
            Place::Byte(at),
            "array within arrays",
            format!("{depth} levels deep"),
            &format!("at most {DEEPEST} levels"),
        ));
    }
    let Some(head) = head(&mut cursor, at)? else {
        let (found, expected) = ("opaque object".to_owned(), "numbers, text, struct or cell");
        return Err(malformed(
            Place::Byte(at),
            "class of an array",
            found,
            expected,
        ));
    };
    let name = if name.is_empty() {
        head.name.clone()
    } else {
        name.to_owned()
    };
    if name.len() > LONGEST_NAME {
        return Err(long_name(at, "name of an array", &name));
    }
    if name.is_empty() {
        // parts of objects and function handles, which are rejected where they occur
        let key = format!("array without a name at byte {at}");
        return reading.property(at, key, format!("{}, skipped", head.class_name()));
    }
    if head.n() == 0 {
        let text = matlab_array::empty(&head.shape, head.class_name());
        return reading.property(at, name, text);
    }
    match head.class {
        CELL => {
            for index in 0..head.n() {
                let element = cursor.expect(&name)?;
                let part = format!("{name}{{{}}}", index + 1);
                inner(&cursor, &element, &part, depth, reading)?;
            }
            Ok(())
        }
        STRUCTURE => {
            let fields = fields(&mut cursor, &name, reading)?;
            if fields.is_empty() {
                return reading.property(at, name, "struct without fields".to_owned());
            }
            for index in 0..head.n() {
                for field in &fields {
                    let element = cursor.expect(&name)?;
                    let part = match head.n() {
                        1 => format!("{name}.{field}"),
                        _ => format!("{name}({}).{field}", index + 1),
                    };
                    inner(&cursor, &element, &part, depth, reading)?;
                }
            }
            Ok(())
        }
        TEXT => text(&mut cursor, &head, name, reading),
        6..=15 => numbers(&mut cursor, &head, name, reading),
        _ => Err(malformed(
            Place::Byte(head.at),
            &format!("class of `{name}`"),
            head.class_name().to_owned(),
            "numbers, text, struct or cell",
        )),
    }
}

/// Reads an array within another one. In a tolerant reading, an error in it is a defect, and the
/// arrays next to it are still read.
fn inner<'a>(
    outer: &Cursor<'a>,
    element: &Element<'a>,
    name: &str,
    depth: usize,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let result = if name.len() > LONGEST_NAME {
        Err(long_name(element.at, "name of a field", name))
    } else if element.kind != MATRIX {
        let found = format!("of type {}", element.kind);
        Err(malformed(
            Place::Byte(element.at),
            name,
            found,
            "an array (14)",
        ))
    } else if element.data.is_empty() {
        reading.property(element.at, name.to_owned(), "empty".to_owned())
    } else {
        read(outer.within(element), name, depth + 1, reading)
    };
    result.or_else(|error| reading.pass_over(error, element.at))
}

/// Returns the error for a name that is too long.
fn long_name(at: u64, field: &str, name: &str) -> LabioError {
    let found = format!("{} bytes", name.len());
    malformed(
        Place::Byte(at),
        field,
        found,
        &format!("at most {LONGEST_NAME}"),
    )
}

/// Reads the head of an array; `None` for an opaque object, which has no shape.
fn head(cursor: &mut Cursor<'_>, at: u64) -> Result<Option<Head>, LabioError> {
    let field = "flags of an array";
    let flags = cursor.expect(field)?;
    let words = flags.numbers(field)?;
    if flags.kind != 6 || words.len() != 2 {
        let found = format!("{} numbers of type {}", words.len(), flags.kind);
        return Err(malformed(
            Place::Byte(flags.at),
            field,
            found,
            "two of type 6",
        ));
    }
    let bytes = match (flags.data, flags.big_endian) {
        ([class, flags, ..], false) | ([_, _, flags, class, ..], true) => (*class, *flags),
        _ => (0, 0),
    };
    let (class, flags) = (u32::from(bytes.0), bytes.1);
    if class == 17 {
        return Ok(None);
    }
    const UNCOUNTABLE: &str = "lengths whose product does not overflow";
    let dimensions = cursor.expect("shape of an array")?;
    let wrong = |found: String, expected: &str| {
        malformed(
            Place::Byte(dimensions.at),
            "shape of an array",
            found,
            expected,
        )
    };
    let mut shape = Vec::new();
    let mut n = 1_usize;
    for length in dimensions.numbers("shape of an array")? {
        let whole = whole(length).ok_or_else(|| wrong(length.to_string(), "a length"))?;
        n = n
            .checked_mul(whole)
            .ok_or_else(|| wrong(length.to_string(), UNCOUNTABLE))?;
        shape.push(whole);
    }
    if shape.len() < 2 {
        return Err(wrong(format!("{} lengths", shape.len()), "at least 2"));
    }
    if !matlab_array::is_countable(&shape) {
        return Err(wrong(format!("{shape:?}"), UNCOUNTABLE));
    }
    let name = cursor.expect("name of an array")?;
    let name: String = name.characters("name of an array")?.into_iter().collect();
    Ok(Some(Head {
        class,
        complex: flags & 0x08 != 0,
        logical: flags & 0x02 != 0,
        shape,
        name: name.trim_end_matches('\0').to_owned(),
        at,
    }))
}

/// Converts a number to a count.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole, not negative and below 2^32, as just checked"
)]
fn whole(number: f64) -> Option<usize> {
    let count =
        number >= 0.0 && number <= f64::from(u32::MAX) && number.fract().abs() < f64::EPSILON;
    count.then_some(number as usize)
}

fn fields(
    cursor: &mut Cursor<'_>,
    name: &str,
    reading: &mut Reading,
) -> Result<Vec<String>, LabioError> {
    let what = format!("fields of `{name}`");
    let length = cursor.expect(&what)?;
    let names = cursor.expect(&what)?;
    let characters = names.characters(&what)?;
    if characters.is_empty() {
        return Ok(Vec::new());
    }
    let width = match length.numbers(&what)?.as_slice() {
        &[width] => whole(width).filter(|&width| width > 0),
        _ => None,
    };
    let Some(width) = width.filter(|&width| characters.len().is_multiple_of(width)) else {
        let (found, expected) = (
            format!("{} characters", characters.len()),
            "names of the stated length",
        );
        return Err(malformed(Place::Byte(length.at), &what, found, expected));
    };
    let n_fields = characters.len() / width;
    let place = Place::Byte(names.at);
    let each = size_of::<String>() + width;
    reading.budget.take(n_fields, each, place, &what)?;
    Ok(characters
        .chunks(width)
        .map(|name| name.iter().take_while(|&&c| c != '\0').collect())
        .collect())
}

fn text(
    cursor: &mut Cursor<'_>,
    head: &Head,
    name: String,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let element = cursor.expect(&name)?;
    let characters = element.characters(&name)?;
    let rows = text_rows(&name, &head.shape, &characters).ok_or_else(|| {
        let found = format!("{} characters in shape {:?}", characters.len(), head.shape);
        malformed(Place::Byte(element.at), &name, found, "rows of characters")
    })?;
    for (key, text) in rows {
        reading.property(element.at, key, text)?;
    }
    Ok(())
}

fn numbers(
    cursor: &mut Cursor<'_>,
    head: &Head,
    name: String,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let mut part = |what: String| {
        let element = cursor.expect(&what)?;
        let values = element.numbers(&what)?;
        if values.len() != head.n() {
            let found = format!("{} numbers", values.len());
            let expected = format!("{}, according to its shape", head.n());
            return Err(malformed(Place::Byte(element.at), &what, found, &expected));
        }
        Ok(values)
    };
    let real = part(format!("`{name}`"))?;
    let values = if head.complex {
        let imaginary = part(format!("imaginary part of `{name}`"))?;
        let pairs = real.into_iter().zip(imaginary);
        Ordinate::Complex(pairs.map(|(re, im)| Complex64::new(re, im)).collect())
    } else {
        Ordinate::Real(real)
    };
    let array = Array {
        name: &name,
        shape: &head.shape,
        class: head.class_name(),
    };
    if let Some(text) = single(&values) {
        return reading.property(head.at, name, text);
    }
    if let Some(found) = array.misplaced() {
        return reading.property(head.at, name, found);
    }
    for series in array.series(&values) {
        reading.series(head.at, series)?;
    }
    Ok(())
}
