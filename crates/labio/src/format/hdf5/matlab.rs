//! Variables of MATLAB 7.3.

use hdf5_reader::group::Group;
use hdf5_reader::reference::read_object_references;
use hdf5_reader::{Dataset, Datatype};

use super::values::{kind_of, numbers, shape_of};
use super::{DEEPEST, Reading, attribute, malformed, refused};
use crate::format::matlab_array::{Array, text_rows};
use crate::{LabioError, Ordinate};

/// Group of the cells and of the fields of arrays of structures.
const REFERENCED: &str = "#refs#";

/// Classes of numbers.
const NUMBERS: [&str; 11] = [
    "double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
    "logical",
];

/// Adds all variables of a file.
pub(super) fn variables(root: &Group, reading: &mut Reading) -> Result<(), LabioError> {
    fields(root, "", 0, reading)
}

/// Adds the members of a group: the variables of the file, or the fields of a structure.
fn fields(
    group: &Group,
    name: &str,
    depth: usize,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let at = group.address();
    if !reading.visited.insert(at) || depth > DEEPEST {
        let found = format!("a structure within itself, or {depth} levels deep");
        return Err(malformed(name, at, found, "at most 64 levels"));
    }
    let (groups, datasets) = group.members().map_err(|error| refused(name, at, &error))?;
    let full = |member: &str| match name {
        "" => member.to_owned(),
        name => format!("{name}.{member}"),
    };
    for dataset in &datasets {
        let read = variable(
            dataset,
            &full(dataset.name()),
            !name.is_empty(),
            depth,
            reading,
        );
        read.or_else(|error| reading.pass_over(error, dataset.address()))?;
    }
    // of the file itself `#refs#` and `#subsystem#`
    for inner in groups.iter().filter(|one| !one.name().starts_with('#')) {
        let read = structure(inner, &full(inner.name()), depth, reading);
        read.or_else(|error| reading.pass_over(error, inner.address()))?;
    }
    Ok(())
}

fn structure(
    group: &Group,
    name: &str,
    depth: usize,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let class = group.attribute("MATLAB_class").ok();
    let class = class
        .and_then(|class| super::text_of(&class))
        .unwrap_or_default();
    match class.as_str() {
        "struct" => fields(group, name, depth + 1, reading),
        other => {
            let is_sparse = group.attribute("MATLAB_sparse").is_ok();
            let found = if is_sparse { "sparse" } else { other };
            let expected = "numbers, text, struct or cell";
            Err(malformed(
                name,
                group.address(),
                format!("class {found}"),
                expected,
            ))
        }
    }
}

/// Adds a variable. `within` is true for a field of a structure, which may be an array of them.
fn variable(
    dataset: &Dataset,
    name: &str,
    within: bool,
    depth: usize,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let at = dataset.address();
    let class = attribute(dataset, "MATLAB_class").unwrap_or_default();
    let mut shape = shape_of(dataset, name)?;
    shape.reverse();
    if attribute(dataset, "MATLAB_empty").is_some_and(|empty| empty == "1") {
        let lengths: Vec<String> = match numbers(dataset, name, reading)? {
            Ordinate::Real(lengths) => lengths.iter().map(f64::to_string).collect(),
            Ordinate::Complex(_) => Vec::new(),
        };
        let text = format!("empty, {} {class}", lengths.join("x"));
        return reading.property(at, name.to_owned(), text);
    }
    match (class.as_str(), dataset.dtype()) {
        ("cell", Datatype::Reference { .. }) => referenced(dataset, depth, reading, &|index| {
            format!("{name}{{{}}}", index + 1)
        }),
        ("", Datatype::Reference { .. }) if within => {
            let (of, field) = name.rsplit_once('.').unwrap_or((name, ""));
            referenced(dataset, depth, reading, &|index| {
                format!("{of}({}).{field}", index + 1)
            })
        }
        ("char", _) => {
            let Ordinate::Real(units) = numbers(dataset, name, reading)? else {
                return Err(malformed(
                    name,
                    at,
                    "pairs of numbers".to_owned(),
                    "characters",
                ));
            };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "units of UTF-16, which are clamped to their range"
            )]
            let units: Vec<u16> = units.iter().map(|&unit| unit as u16).collect();
            let characters: Vec<char> = char::decode_utf16(units)
                .map(|one| one.unwrap_or(char::REPLACEMENT_CHARACTER))
                .collect();
            let rows = text_rows(name, &shape, &characters).ok_or_else(|| {
                let found = format!("{} characters in shape {shape:?}", characters.len());
                malformed(name, at, found, "rows of characters")
            })?;
            for (key, text) in rows {
                reading.property(at, key, text)?;
            }
            Ok(())
        }
        (
            class,
            Datatype::FixedPoint { .. }
            | Datatype::FloatingPoint { .. }
            | Datatype::Compound { .. },
        ) if NUMBERS.contains(&class) || class.is_empty() => {
            let values = numbers(dataset, name, reading)?;
            let array = Array {
                name,
                shape: &shape,
                class: if class.is_empty() { "double" } else { class },
            };
            if let Some(text) = array.single(&values) {
                return reading.property(at, name.to_owned(), text);
            }
            for series in array.series(&values) {
                reading.series(at, series)?;
            }
            Ok(())
        }
        (class, kind) => {
            let found = format!("class `{class}` of the type {}", kind_of(kind));
            Err(malformed(name, at, found, "numbers, text, struct or cell"))
        }
    }
}

/// Adds the objects that a data set refers to: cells, or a field of an array of structures.
fn referenced(
    dataset: &Dataset,
    depth: usize,
    reading: &mut Reading,
    name_of: &dyn Fn(usize) -> String,
) -> Result<(), LabioError> {
    let at = dataset.address();
    let fail = |error| refused(dataset.name(), at, &error);
    if depth > DEEPEST {
        let found = format!("{depth} levels deep");
        return Err(malformed(dataset.name(), at, found, "at most 64 levels"));
    }
    let size = dataset.raw_element_size().map_err(fail)?;
    let bytes = dataset.read_raw_bytes().map_err(fail)?;
    let width = u8::try_from(size).unwrap_or(8);
    let addresses = read_object_references(&bytes, width).map_err(fail)?;
    let cells = reading.root.group(REFERENCED).map_err(fail)?;
    let (groups, datasets) = cells.members().map_err(fail)?;
    for (index, address) in addresses.into_iter().enumerate() {
        let name = name_of(index);
        let read = if let Some(found) = datasets.iter().find(|one| one.address() == address) {
            variable(found, &name, false, depth + 1, reading)
        } else if let Some(found) = groups.iter().find(|one| one.address() == address) {
            structure(found, &name, depth + 1, reading)
        } else {
            let found = format!("the address {address}");
            Err(malformed(&name, at, found, "an object of `#refs#`"))
        };
        read.or_else(|error| reading.pass_over(error, at))?;
    }
    Ok(())
}
