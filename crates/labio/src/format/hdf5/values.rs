//! Numbers of data sets, with their label and unit.

use hdf5_reader::{ByteOrder, Dataset, Datatype};
use num_complex::Complex64;

use super::{Hierarchy, attribute, malformed, refused};
use crate::format::matlab_array::is_countable;
use crate::unit::EXACT_INTEGERS;
use crate::{LabioError, Ordinate, Place, SeriesAxis};

/// Label and unit of the numbers of a data set.
pub(super) fn axis_of(dataset: &Dataset) -> SeriesAxis {
    let unit_text = attribute(dataset, "units")
        .or_else(|| attribute(dataset, "unit"))
        .unwrap_or_default();
    let label = attribute(dataset, "long_name").unwrap_or_default();
    crate::format::text::axis(label, unit_text)
}

pub(super) fn is_text(kind: &Datatype) -> bool {
    use hdf5_reader::messages::datatype::VarLenKind;
    matches!(
        kind,
        Datatype::String { .. }
            | Datatype::VarLen {
                kind: VarLenKind::String,
                ..
            }
    )
}

/// Returns the lengths of the axes; empty for a single number.
pub(super) fn shape_of(dataset: &Dataset, name: &str) -> Result<Vec<usize>, LabioError> {
    let uncountable = || {
        let found = format!("the shape {:?}", dataset.shape());
        let expected = "lengths whose product does not overflow";
        malformed(name, dataset.address(), found, expected)
    };
    let lengths: Option<Vec<usize>> = dataset
        .shape()
        .iter()
        .map(|&length| usize::try_from(length).ok())
        .collect();
    let lengths = lengths.ok_or_else(uncountable)?;
    if is_countable(&lengths) {
        Ok(lengths)
    } else {
        Err(uncountable())
    }
}

/// Returns the numbers of a data set in the order of the file.
pub(super) fn numbers(
    dataset: &Dataset,
    name: &str,
    hierarchy: &mut Hierarchy,
) -> Result<Ordinate, LabioError> {
    let at = dataset.address();
    let count = shape_of(dataset, name)?.iter().product::<usize>();
    let fail = |error| refused(name, at, &error);
    if let Some([real, imaginary]) = complex_fields(dataset.dtype()) {
        let size = dataset.raw_element_size().map_err(fail)?;
        let place = Place::Byte(at);
        hierarchy.reading.budget.take(count, size, place, name)?;
        let bytes = dataset.read_raw_bytes().map_err(fail)?;
        let pairs: Option<Vec<Complex64>> = bytes
            .chunks_exact(size)
            .map(|one| Some(Complex64::new(real.of(one)?, imaginary.of(one)?)))
            .collect();
        hierarchy.reading.budget.give_back(count * size);
        let pairs = pairs.filter(|pairs| pairs.len() == count);
        return pairs.map(Ordinate::Complex).ok_or_else(|| {
            let found = format!("{} bytes", bytes.len());
            malformed(name, at, found, "pairs of numbers")
        });
    }
    let size = match dataset.dtype() {
        Datatype::FloatingPoint { size, .. } if ![4, 8].contains(size) => {
            let found = format!("floating-point numbers of {size} bytes");
            return Err(malformed(name, at, found, "of 4 or 8"));
        }
        Datatype::FixedPoint { size, .. } | Datatype::FloatingPoint { size, .. } => *size,
        other => {
            let found = format!("the type {}", kind_of(other));
            return Err(malformed(name, at, found, "numbers or text"));
        }
    };
    let place = Place::Byte(at);
    hierarchy.reading.budget.take(count, 8, place, name)?;
    let values = match (dataset.dtype(), size) {
        (Datatype::FloatingPoint { .. }, 4) => of_type::<f32>(dataset, f64::from),
        (Datatype::FloatingPoint { .. }, _) => of_type(dataset, |value: f64| value),
        (Datatype::FixedPoint { signed: true, .. }, 1) => of_type::<i8>(dataset, f64::from),
        (Datatype::FixedPoint { signed: true, .. }, 2) => of_type::<i16>(dataset, f64::from),
        (Datatype::FixedPoint { signed: true, .. }, 4) => of_type::<i32>(dataset, f64::from),
        (Datatype::FixedPoint { signed: true, .. }, 8) => {
            of_type(dataset, |value: i64| value as f64)
        }
        (_, 1) => of_type::<u8>(dataset, f64::from),
        (_, 2) => of_type::<u16>(dataset, f64::from),
        (_, 4) => of_type::<u32>(dataset, f64::from),
        (_, 8) => of_type(dataset, |value: u64| value as f64),
        (_, other) => {
            let found = format!("integers of {other} bytes");
            return Err(malformed(name, at, found, "of 1, 2, 4 or 8"));
        }
    }
    .map_err(fail)?;
    hierarchy.reading.budget.give_back(8 * count);
    if size == 8
        && matches!(dataset.dtype(), Datatype::FixedPoint { .. })
        && let Some(large) = values.iter().find(|value| value.abs() > EXACT_INTEGERS)
    {
        let found = format!("the integer {large}");
        return Err(malformed(name, at, found, "at most 2^53 in magnitude"));
    }
    Ok(Ordinate::Real(values))
}

/// Reads numbers of type `T`, each converted by `converted`.
fn of_type<T: hdf5_reader::H5Type + Copy>(
    dataset: &Dataset,
    converted: impl Fn(T) -> f64,
) -> Result<Vec<f64>, hdf5_reader::error::Error> {
    let read = dataset.read_array::<T>()?;
    Ok(read.iter().map(|&value| converted(value)).collect())
}

/// A number within a compound type.
#[derive(Clone, Copy)]
struct Field {
    offset: usize,
    size: u8,
    big_endian: bool,
}

impl Field {
    fn of(self, bytes: &[u8]) -> Option<f64> {
        let own = bytes.get(self.offset..self.offset + usize::from(self.size))?;
        match (own.first_chunk::<4>(), own.first_chunk::<8>(), self.size) {
            (Some(four), _, 4) if self.big_endian => Some(f64::from(f32::from_be_bytes(*four))),
            (Some(four), _, 4) => Some(f64::from(f32::from_le_bytes(*four))),
            (_, Some(eight), 8) if self.big_endian => Some(f64::from_be_bytes(*eight)),
            (_, Some(eight), 8) => Some(f64::from_le_bytes(*eight)),
            _ => None,
        }
    }
}

/// Returns the real and imaginary part of a compound type that is a complex number.
fn complex_fields(kind: &Datatype) -> Option<[Field; 2]> {
    let Datatype::Compound { fields, .. } = kind else {
        return None;
    };
    let [real, imaginary] = fields.as_slice() else {
        return None;
    };
    let named = matches!(
        (real.name.as_str(), imaginary.name.as_str()),
        ("r", "i") | ("real", "imag")
    );
    let field = |field: &hdf5_reader::messages::datatype::CompoundField| match field.datatype {
        Datatype::FloatingPoint { size, byte_order } => Some(Field {
            offset: usize::try_from(field.byte_offset).ok()?,
            size,
            big_endian: byte_order == ByteOrder::BigEndian,
        }),
        _ => None,
    };
    if !named {
        return None;
    }
    Some([field(real)?, field(imaginary)?])
}

/// Returns the value that marks samples never written in a netCDF file; `None` for bytes, for which
/// every value can be a sample.
fn unwritten(kind: &Datatype) -> Option<f64> {
    match kind {
        Datatype::FloatingPoint { .. } => Some(15.0 * 2.0_f64.powi(119)),
        Datatype::FixedPoint { size, signed, .. } if *size > 1 => {
            let bits = 8 * i32::from(*size);
            // the fill values of 8-byte integers are beyond what a series can represent
            Some(match signed {
                true => 1.0 - 2.0_f64.powi(bits - 1),
                false => 2.0_f64.powi(bits) - 1.0,
            })
        }
        _ => None,
    }
}

/// Returns the physical numbers of a packed netCDF variable.
pub(super) fn unpacked(
    dataset: &Dataset,
    name: &str,
    values: Ordinate,
    hierarchy: &Hierarchy,
) -> Result<Ordinate, LabioError> {
    let number = |attribute: &str| dataset.attribute(attribute).ok()?.read_as_f64().ok();
    let Ordinate::Real(mut values) = values else {
        return Ok(values);
    };
    let by_default = hierarchy.is_netcdf.then(|| unwritten(dataset.dtype()));
    if let Some(missing) = number("_FillValue").or(by_default.flatten())
        && let Some(index) = values
            .iter()
            .position(|value| value.to_bits() == missing.to_bits())
    {
        let found = format!(
            "{missing} at sample {}, the value of missing samples",
            index + 1
        );
        return Err(malformed(name, dataset.address(), found, "all samples"));
    }
    let (factor, offset) = (number("scale_factor"), number("add_offset"));
    if factor.is_some() || offset.is_some() {
        for value in &mut values {
            *value = *value * factor.unwrap_or(1.0) + offset.unwrap_or(0.0);
        }
    }
    Ok(Ordinate::Real(values))
}

/// Name of the class of a data type.
pub(super) fn kind_of(kind: &Datatype) -> &'static str {
    match kind {
        Datatype::FixedPoint { .. } => "integer",
        Datatype::FloatingPoint { .. } => "number",
        Datatype::String { .. } => "text",
        Datatype::Compound { .. } => "compound",
        Datatype::Array { .. } => "array",
        Datatype::Enum { .. } => "enumeration",
        Datatype::VarLen { .. } => "list of variable length",
        Datatype::Opaque { .. } => "opaque",
        Datatype::Reference { .. } => "reference",
        Datatype::Bitfield { .. } => "bits",
    }
}
