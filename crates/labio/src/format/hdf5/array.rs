//! Data sets as series and properties.

use hdf5_reader::Dataset;

use super::coordinate::{along, is_scale};
use super::values::{axis_of, is_text, numbers, shape_of, unpacked};
use super::{Hierarchy, refused, text_of};
use crate::format::matlab_array::{misplaced, single};
use crate::{Abscissa, LabioError, Place, Series, SeriesKind};

/// Attributes that do not become properties of a series because they have another meaning.
const MEANT: [&str; 12] = [
    "units",
    "unit",
    "long_name",
    "scale_factor",
    "add_offset",
    "_FillValue",
    "CLASS",
    "NAME",
    "DIMENSION_LIST",
    "REFERENCE_LIST",
    "_Netcdf4Dimid",
    "_Netcdf4Coordinates",
];

/// Adds a data set to the contents.
pub(super) fn read(
    dataset: &Dataset,
    name: &str,
    hierarchy: &mut Hierarchy,
) -> Result<(), LabioError> {
    let at = dataset.address();
    if is_scale(dataset) {
        return Ok(());
    }
    if is_text(dataset.dtype()) {
        let texts = dataset
            .read_strings()
            .map_err(|error| refused(name, at, &error))?;
        for (index, text) in texts.iter().enumerate() {
            let key = match texts.len() {
                1 => name.to_owned(),
                _ => format!("{name}[{index}]"),
            };
            hierarchy
                .reading
                .property(at, key, text.trim_end_matches('\0').to_owned())?;
        }
        return Ok(());
    }
    let shape = shape_of(dataset, name)?;
    if shape.contains(&0) {
        return hierarchy
            .reading
            .property(at, name.to_owned(), "empty".to_owned());
    }
    let packed = numbers(dataset, name, hierarchy)?;
    let values = unpacked(dataset, name, packed, hierarchy)?;
    if let Some(text) = single(&values) {
        return hierarchy.reading.property(at, name.to_owned(), text);
    }
    // the last axis varies fastest
    let (last, others) = shape.split_last().map_or((1, &[][..]), |(l, o)| (*l, o));
    let n_others: usize = others.iter().product();
    let along_first = shape.len() == 2 && n_others > last;
    let (n_series, length, axis) = if along_first {
        (last, n_others, 0)
    } else {
        (n_others, last, shape.len().saturating_sub(1))
    };
    if let Some(found) = misplaced(&shape, length) {
        let text = format!("{found}, skipped: save one data set per hit");
        return hierarchy.reading.property(at, name.to_owned(), text);
    }
    let (abscissa, abscissa_axis) = along(dataset, axis, length, name, hierarchy)?;
    for index in 0..n_series {
        let (first, step) = if along_first {
            (index, last)
        } else {
            (index * last, 1)
        };
        let series_name = match (n_series, along_first) {
            (1, _) => name.to_owned(),
            (_, true) => format!("{name}[:, {index}]"),
            (_, false) => format!("{name}[{}, :]", subscripts(index, others)),
        };
        let series = Series {
            name: series_name,
            kind: SeriesKind::General,
            abscissa: abscissa.clone(),
            ordinate: values.every(first, step, length),
            abscissa_axis: abscissa_axis.clone(),
            ordinate_axis: axis_of(dataset),
            properties: properties(dataset),
        };
        if let Abscissa::Uneven(times) = &series.abscissa {
            hierarchy
                .reading
                .budget
                .take(times.len(), 8, Place::Byte(at), &series.name)?;
        }
        hierarchy.reading.series(at, series)?;
    }
    Ok(())
}

fn properties(dataset: &Dataset) -> Vec<(String, String)> {
    let attributes = dataset.attributes().into_iter();
    let own = attributes.filter(|one| !MEANT.contains(&one.name.as_str()));
    own.filter_map(|one| Some((one.name.clone(), text_of(&one)?)))
        .collect()
}

/// Returns the subscripts of series `index`, from 0; the last subscript varies fastest.
fn subscripts(mut index: usize, shape: &[usize]) -> String {
    let mut texts: Vec<String> = shape
        .iter()
        .rev()
        .map(|&length| {
            let at = index % length.max(1);
            index /= length.max(1);
            at.to_string()
        })
        .collect();
    texts.reverse();
    texts.join(", ")
}
