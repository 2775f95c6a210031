//! Coordinates along the axes of data sets: dimension scales of HDF5 and netCDF-4.

use std::collections::HashMap;

use hdf5_reader::reference::resolve_object_reference;
use hdf5_reader::{Dataset, Datatype};

use super::values::{axis_of, is_text, numbers, unpacked};
use super::{Hierarchy, attribute, malformed, refused};
use crate::format::rounding::WrittenValues;
use crate::format::text;
use crate::{Abscissa, LabioError, Ordinate, SeriesAxis};

/// Beginning of the name of a netCDF dimension without coordinates.
const WITHOUT_VARIABLE: &str = "This is a netCDF dimension but not a netCDF variable";

/// Size in bytes of an object's address in the list of the scales of an axis.
const ADDRESS_BYTES: u8 = 8;

/// Coordinates that were read, by the addresses of their data sets. A netCDF group also uses the
/// coordinates of the groups around it.
pub(super) type Scales = HashMap<u64, (Abscissa, SeriesAxis)>;

/// Returns true for a data set that is not a series: coordinates of the axes of other data sets, or
/// a dimension without coordinates.
pub(super) fn is_scale(dataset: &Dataset) -> bool {
    let is_scale = attribute(dataset, "CLASS").is_some_and(|class| class == "DIMENSION_SCALE");
    is_scale && (is_bare(dataset) || dataset.attribute("REFERENCE_LIST").is_ok())
}

fn is_bare(dataset: &Dataset) -> bool {
    attribute(dataset, "NAME").is_some_and(|name| name.starts_with(WITHOUT_VARIABLE))
}

/// Reads the coordinates among `datasets`.
pub(super) fn collect(
    datasets: &[Dataset],
    path: &str,
    hierarchy: &mut Hierarchy,
) -> Result<(), LabioError> {
    for dataset in datasets.iter().filter(|one| is_scale(one) && !is_bare(one)) {
        let name = format!("{path}{}", dataset.name());
        if dataset.ndim() != 1 || is_text(dataset.dtype()) {
            continue;
        }
        let read = numbers(dataset, &name, hierarchy)
            .and_then(|values| unpacked(dataset, &name, values, hierarchy))
            .map(|values| abscissa(dataset, values));
        match read {
            Ok(Some(abscissa)) => {
                let axis = axis_of(dataset);
                let label = if axis.label.is_empty() {
                    dataset.name().to_owned()
                } else {
                    axis.label
                };
                let axis = SeriesAxis { label, ..axis };
                hierarchy.scales.insert(dataset.address(), (abscissa, axis));
            }
            Ok(None) => {}
            Err(error) => hierarchy.reading.pass_over(error, dataset.address())?,
        }
    }
    Ok(())
}

/// Returns the coordinates as an abscissa: evenly spaced if they are even within the rounding of
/// their type.
fn abscissa(dataset: &Dataset, values: Ordinate) -> Option<Abscissa> {
    let Ordinate::Real(values) = values else {
        return None;
    };
    let half_unit = match dataset.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => f64::from(f32::EPSILON) / 2.0,
        _ => f64::EPSILON / 2.0,
    };
    let mut written = WrittenValues::default();
    for &value in &values {
        written.push(value, half_unit * value.abs());
    }
    Some(match written.even_spacing() {
        Some((start, step)) => Abscissa::Even {
            start,
            step: step.value,
        },
        None => Abscissa::Uneven(values),
    })
}

/// Returns the abscissa of the series of `dataset` along `axis`: the coordinates that are attached
/// to the axis, or the index.
pub(super) fn along(
    dataset: &Dataset,
    axis: usize,
    length: usize,
    name: &str,
    hierarchy: &Hierarchy,
) -> Result<(Abscissa, SeriesAxis), LabioError> {
    let index = || {
        let abscissa = Abscissa::Even {
            start: 0.0,
            step: 1.0,
        };
        (abscissa, text::axis("index", ""))
    };
    let Ok(list) = dataset.attribute("DIMENSION_LIST") else {
        return Ok(index());
    };
    let fail = |error| refused(name, dataset.address(), &error);
    let Some(reference) = list
        .raw_data
        .chunks_exact(dataset.vlen_reference_size())
        .nth(axis)
    else {
        return Ok(index());
    };
    let scales = dataset
        .resolve_vlen_reference_bytes(reference, usize::from(ADDRESS_BYTES))
        .map_err(fail)?;
    if scales.is_empty() {
        return Ok(index());
    }
    let address = resolve_object_reference(&scales, ADDRESS_BYTES).map_err(fail)?;
    let Some((abscissa, axis)) = hierarchy.scales.get(&address) else {
        return Ok(index());
    };
    match abscissa {
        Abscissa::Uneven(values) if values.len() != length => {
            let found = format!(
                "{} coordinates for an axis of length {length}",
                values.len()
            );
            let expected = "as many coordinates as samples";
            Err(malformed(name, dataset.address(), found, expected))
        }
        _ => Ok((abscissa.clone(), axis.clone())),
    }
}
