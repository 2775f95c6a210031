//! Variables of MATLAB 7.3.

use std::collections::HashMap;
use std::rc::Rc;

use hdf5_reader::group::Group;
use hdf5_reader::reference::read_object_references;
use hdf5_reader::{Dataset, Datatype};

use super::values::{kind_of, numbers, shape_of};
use super::{Hierarchy, attribute, malformed, refused};
use crate::format::matlab_array::{Array, single, text_rows};
use crate::format::reading::DEEPEST;
use crate::{LabioError, Ordinate};

/// Name of the group that contains the cells and the fields of structure arrays.
const REFERENCED: &str = "#refs#";

/// Objects in the group [`REFERENCED`], by their addresses.
#[derive(Default)]
pub(super) struct Referenced {
    groups: HashMap<u64, Group>,
    datasets: HashMap<u64, Dataset>,
}

/// Classes that contain numbers.
const NUMBERS: [&str; 11] = [
    "double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
    "logical",
];

/// Adds all variables of a file.
pub(super) fn variables(root: &Group, hierarchy: &mut Hierarchy) -> Result<(), LabioError> {
    fields(root, "", 0, hierarchy)
}

/// Adds the members of a group: the variables of the file, or the fields of a structure.
fn fields(
    group: &Group,
    name: &str,
    depth: usize,
    hierarchy: &mut Hierarchy,
) -> Result<(), LabioError> {
    let at = group.address();
    if !hierarchy.visited.insert(at) || depth > DEEPEST {
        let found = format!("a structure within itself, or {depth} levels deep");
        return Err(malformed(name, at, found, "at most 64 levels"));
    }
    let (groups, datasets) = group.members().map_err(|error| refused(name, at, &error))?;
    let full = |member: &str| match name {
        "" => member.to_owned(),
        name => format!("{name}.{member}"),
    };
    for dataset in &datasets {
        let own = full(dataset.name());
        let read = variable(dataset, &own, !name.is_empty(), depth, hierarchy);
        read.or_else(|error| hierarchy.reading.pass_over(error, dataset.address()))?;
    }
    // `#refs#` and `#subsystem#` belong to the file itself
    for inner in groups.iter().filter(|one| !one.name().starts_with('#')) {
        let read = structure(inner, &full(inner.name()), depth, hierarchy);
        read.or_else(|error| hierarchy.reading.pass_over(error, inner.address()))?;
    }
    // another cell may refer to the same structure
    hierarchy.visited.remove(&at);
    Ok(())
}

fn structure(
    group: &Group,
    name: &str,
    depth: usize,
    hierarchy: &mut Hierarchy,
) -> Result<(), LabioError> {
    let class = group.attribute("MATLAB_class").ok();
    let class = class
        .and_then(|class| super::text_of(&class))
        .unwrap_or_default();
    if class == "struct" {
        return fields(group, name, depth + 1, hierarchy);
    }
    let is_sparse = group.attribute("MATLAB_sparse").is_ok();
    let found = format!(
        "class {}",
        if is_sparse { "sparse" } else { class.as_str() }
    );
    let expected = "numbers, text, struct or cell";
    Err(malformed(name, group.address(), found, expected))
}

/// Adds a variable. `within` is true for a field of a structure, which may be a structure array.
fn variable(
    dataset: &Dataset,
    name: &str,
    within: bool,
    depth: usize,
    hierarchy: &mut Hierarchy,
) -> Result<(), LabioError> {
    let at = dataset.address();
    let class = attribute(dataset, "MATLAB_class").unwrap_or_default();
    let mut shape = shape_of(dataset, name)?;
    shape.reverse();
    if attribute(dataset, "MATLAB_empty").is_some_and(|empty| empty == "1") {
        let lengths: Vec<String> = match numbers(dataset, name, hierarchy)? {
            Ordinate::Real(lengths) => lengths.iter().map(f64::to_string).collect(),
            Ordinate::Complex(_) => Vec::new(),
        };
        let text = format!("empty, {} {class}", lengths.join("x"));
        return hierarchy.reading.property(at, name.to_owned(), text);
    }
    match (class.as_str(), dataset.dtype()) {
        ("cell", Datatype::Reference { .. }) => referenced(dataset, depth, hierarchy, &|index| {
            format!("{name}{{{}}}", index + 1)
        }),
        ("", Datatype::Reference { .. }) if within => {
            let (of, field) = name.rsplit_once('.').unwrap_or((name, ""));
            referenced(dataset, depth, hierarchy, &|index| {
                format!("{of}({}).{field}", index + 1)
            })
        }
        ("char", _) => {
            let Ordinate::Real(units) = numbers(dataset, name, hierarchy)? else {
                let found = "pairs of numbers".to_owned();
                return Err(malformed(name, at, found, "characters"));
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
                hierarchy.reading.property(at, key, text)?;
            }
            Ok(())
        }
        (
            class,
            Datatype::FixedPoint { .. }
            | Datatype::FloatingPoint { .. }
            | Datatype::Compound { .. },
        ) if NUMBERS.contains(&class) || class.is_empty() => {
            let values = numbers(dataset, name, hierarchy)?;
            let array = Array {
                name,
                shape: &shape,
                class: if class.is_empty() { "double" } else { class },
            };
            if let Some(text) = single(&values) {
                return hierarchy.reading.property(at, name.to_owned(), text);
            }
            if let Some(found) = array.misplaced() {
                return hierarchy.reading.property(at, name.to_owned(), found);
            }
            for series in array.series(&values) {
                hierarchy.reading.series(at, series)?;
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
    hierarchy: &mut Hierarchy,
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
    let known = hierarchy.referenced.clone();
    let objects = match known {
        Some(known) => known,
        None => {
            let cells = hierarchy.root.group(REFERENCED).map_err(fail)?;
            let (groups, datasets) = cells.members().map_err(fail)?;
            let found = Rc::new(Referenced {
                groups: groups.into_iter().map(|one| (one.address(), one)).collect(),
                datasets: datasets
                    .into_iter()
                    .map(|one| (one.address(), one))
                    .collect(),
            });
            Rc::clone(hierarchy.referenced.insert(found))
        }
    };
    for (index, address) in addresses.into_iter().enumerate() {
        let name = name_of(index);
        let read = if let Some(found) = objects.datasets.get(&address) {
            variable(found, &name, false, depth + 1, hierarchy)
        } else if let Some(found) = objects.groups.get(&address) {
            structure(found, &name, depth + 1, hierarchy)
        } else {
            let found = format!("the address {address}");
            Err(malformed(&name, at, found, "an object of `#refs#`"))
        };
        read.or_else(|error| hierarchy.reading.pass_over(error, at))?;
    }
    Ok(())
}
