//! `NumPy`'s `.npy`: one array in a file.
//!
//! # A record with its times
//!
//! [`read`] and [`Blocks`] read the layout of stored hammer tests: a two-dimensional array of
//! little-endian `f64`, shape `(1 + n_channels, n_samples)`. Row 0 is time in seconds. The file has
//! no names and units: the caller supplies them, and the samples are assumed to be in SI units.
//!
//! # Any array
//!
//! [`Npy`] reads arrays of one or two axes, of integers, floating-point and complex numbers, in
//! either byte order and either memory order. The samples are along the longer axis: an array of
//! shape `(3, 4)` gives the series `[0, :]`, `[1, :]`, `[2, :]`, an array of shape `(4, 3)` the
//! series `[:, 0]`, `[:, 1]`, `[:, 2]`. The abscissa is the sample index from 0, because the file
//! has no abscissa; the properties keep the rest of the header. Names, units and abscissae cannot
//! be written: [`npz`](super::npz) stores them.

pub(super) mod array;
mod blocks;
pub(super) mod file;
pub(super) mod header;

use std::io::Read;
use std::path::Path;

use ndarray::{Array2, ArrayView1, Axis, ShapeBuilder};

use super::opened;
use crate::error::{check_count, check_positive, check_samples, not_read, too_few_samples};
use crate::{Channel, LabioError, Provenance, Record};
use array::{Array, Values};
use header::{Element, Header};

pub use blocks::Blocks;
pub use file::Npy;

const FORMAT: &str = "npy";

/// Largest relative deviation of a time step from the mean step. Times written as text with few
/// digits exceed it; steps summed in double precision over a million samples do not.
pub const TIME_STEP_TOLERANCE: f64 = 1e-6;

/// Reads the file at `path`; `channels` name the rows after the row of times.
///
/// # Errors
///
/// [`LabioError::InFile`] with the path and, as its source, the error of [`read_from`] or of
/// opening the file.
///
/// # Examples
///
/// ```no_run
/// use labio::{Channel, Quantity, format::npy};
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let channels = [
///     Channel::new("force", Quantity::Force)?,
///     Channel::new("acceleration", Quantity::Acceleration)?,
/// ];
/// let hit = npy::read("hit_1.npy", &channels)?;
/// println!("{} samples at {} Hz", hit.n_samples(), hit.sampling_rate_hz());
/// # Ok(())
/// # }
/// ```
pub fn read(path: impl AsRef<Path>, channels: &[Channel]) -> Result<Record, LabioError> {
    let path = path.as_ref();
    let record = opened(path, |file| read_from(file, channels))?;
    let provenance = record.provenance().clone().found_at(path);
    Ok(record.with_provenance(provenance))
}

/// Reads an array from `reader` to its end; `channels` name the rows after the row of times.
///
/// The sampling rate is the number of steps divided by the time between first and last sample.
///
/// # Errors
///
/// - [`LabioError::Read`]: the bytes cannot be read.
/// - [`LabioError::Malformed`], [`LabioError::WrongDimensions`], [`LabioError::WrongElement`],
///   [`LabioError::NoData`], [`LabioError::Truncated`], [`LabioError::TrailingBytes`]: the bytes
///   are not an array of the expected layout.
/// - [`LabioError::NonUniformTime`]: a time step deviates from the mean step by more than a
///   relative [`TIME_STEP_TOLERANCE`].
/// - The errors of [`Record::new`] for channels and samples.
pub fn read_from(mut reader: impl Read, channels: &[Channel]) -> Result<Record, LabioError> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(not_read)?;
    let array = parse(&bytes)?;
    let what = "rows of the array, one for the times and one per channel";
    check_count(what, array.nrows(), channels.len() + 1)?;
    let (times, samples) = array.view().split_at(Axis(0), 1);
    let clock = Clock::of(times.row(0))?;
    Record::new(
        samples.to_owned(),
        clock.sampling_rate_hz,
        clock.start_time,
        channels.to_vec(),
        Provenance::of_bytes(FORMAT, &bytes),
    )
}

/// Parses the array without trusting the shape in the header: memory is allocated only for bytes
/// that exist.
fn parse(bytes: &[u8]) -> Result<Array2<f64>, LabioError> {
    let Header {
        element,
        fortran_order,
        shape,
        ..
    } = Header::read(bytes, FORMAT, "")?;
    if element != Element::F64 {
        return Err(LabioError::WrongElement {
            format: FORMAT,
            found: format!("'{element}'"),
            expected: "'<f8'",
        });
    }
    let [n_rows, n_samples] = two_axes(&shape)?;
    let values = match Array::read(bytes, FORMAT, "")?.values {
        Values::Real(values) => values,
        Values::Complex(_) | Values::Text(_) => Vec::new(),
    };
    let shape = (n_rows, n_samples).set_f(fortran_order);
    Array2::from_shape_vec(shape, values)
        .ok()
        .filter(|array| !array.is_empty())
        .ok_or(LabioError::NoData { format: FORMAT })
}

/// Returns the lengths of the two axes of an array.
fn two_axes(shape: &[usize]) -> Result<[usize; 2], LabioError> {
    shape.try_into().map_err(|_| LabioError::WrongDimensions {
        format: FORMAT,
        found: shape.len(),
        expected: 2,
    })
}

/// Accepts the step from the time at `index` to the next if it is close to the mean step.
fn check_step(index: usize, found: f64, expected: f64) -> Result<(), LabioError> {
    if (found - expected).abs() <= TIME_STEP_TOLERANCE * expected {
        return Ok(());
    }
    Err(LabioError::NonUniformTime {
        index,
        found,
        expected,
        tolerance: TIME_STEP_TOLERANCE,
    })
}

/// Start and rate of a row of evenly spaced times.
struct Clock {
    start_time: f64,
    sampling_rate_hz: f64,
}

impl Clock {
    fn of(times: ArrayView1<'_, f64>) -> Result<Self, LabioError> {
        let (Some(&first), Some(&last), true) = (times.first(), times.last(), times.len() > 1)
        else {
            return too_few_samples("the row of times", times.len(), 2);
        };
        check_samples("time", times)?;
        let expected = check_positive(
            "mean time step [s]",
            (last - first) / (times.len() - 1) as f64,
        )?;
        for (index, (earlier, later)) in times.iter().zip(times.iter().skip(1)).enumerate() {
            check_step(index, later - earlier, expected)?;
        }
        Ok(Self {
            start_time: first,
            sampling_rate_hz: 1.0 / expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;

    /// Bytes of a `.npy` file of version 1.0.
    fn npy(header: &str, data: &[f64]) -> Vec<u8> {
        let mut text = header.to_owned();
        while !(10 + text.len() + 1).is_multiple_of(64) {
            text.push(' ');
        }
        text.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(text.len()).unwrap().to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(data.iter().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    fn f8(shape: &str, data: &[f64]) -> Vec<u8> {
        npy(
            &format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"),
            data,
        )
    }

    fn channels() -> Vec<Channel> {
        vec![
            Channel::new("force", Quantity::Force).unwrap(),
            Channel::new("acceleration", Quantity::Acceleration).unwrap(),
        ]
    }

    const DATA: [f64; 12] = [
        0.5, 0.625, 0.75, 0.875, 10.0, 11.0, 12.0, 13.0, -1.0, -2.0, -3.0, -4.0,
    ];

    #[test]
    fn rows_become_channels_and_times_a_clock() {
        let bytes = f8("(3, 4)", &DATA);
        let record = read_from(bytes.as_slice(), &channels()).unwrap();
        // the times are multiples of 1/8 s: the rate is exact
        assert_eq!(record.sampling_rate_hz().to_bits(), 8.0_f64.to_bits());
        assert_eq!(record.start_time().to_bits(), 0.5_f64.to_bits());
        assert_eq!(record.channel("acceleration").unwrap().to_vec(), DATA[8..]);
        assert_eq!(record.provenance(), &Provenance::of_bytes("npy", &bytes));
    }

    #[test]
    fn the_order_of_memory_does_not_matter() {
        let columns: Vec<f64> = (0..4)
            .flat_map(|n| (0..3).map(move |c| DATA[4 * c + n]))
            .collect();
        let header = "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 4), }";
        let fortran = read_from(npy(header, &columns).as_slice(), &channels()).unwrap();
        let c = read_from(f8("(3, 4)", &DATA).as_slice(), &channels()).unwrap();
        assert_eq!(fortran.samples(), c.samples());
    }

    /// Faults of headers are tested in `tests/npy.rs`, because they are the same for any array.
    #[test]
    fn what_is_not_the_array_expected_is_refused_with_numbers() {
        let with = |index: usize, value: f64| {
            let mut data = DATA;
            data[index] = value;
            f8("(3, 4)", &data)
        };
        let big = "{'descr': '>f8', 'fortran_order': False, 'shape': (3, 4), }";
        let cases = [
            f8("(12,)", &DATA),
            f8("(4, 3)", &DATA),
            f8("(3, 1)", &DATA[..3]),
            f8("(0, 9223372036854775807)", &[]),
            npy(big, &DATA),
            with(2, 0.76),
            with(3, 0.25),
            with(1, f64::NAN),
            with(6, f64::NEG_INFINITY),
        ];
        let refusals = cases
            .map(|bytes| {
                let error = read_from(bytes.as_slice(), &channels()).unwrap_err();
                error.to_string()
            })
            .join("\n");
        insta::assert_snapshot!(refusals, @r"
        the npy array has 1 axes, expected 2
        rows of the array, one for the times and one per channel: found 4, expected 3
        the row of times has 1 samples, expected at least 2
        the npy file contains no data
        the npy array contains '>f8', expected '<f8'
        time step 1 is 0.135 s, expected 0.125 s within a relative deviation of 0.000001
        mean time step [s] is -0.08333333333333333, expected a finite value above 0
        sample 1 of channel `time` is NaN, expected a finite value
        sample 2 of channel `force` is -inf, expected a finite value
        ");
    }

    #[test]
    fn a_record_of_a_file_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hit.npy");
        let whole = f8("(3, 4)", &DATA);
        std::fs::write(&path, &whole).unwrap();
        let record = read(&path, &channels()).unwrap();
        assert_eq!(
            record.provenance(),
            &Provenance::of_file(&path, "npy", &whole)
        );
    }
}
