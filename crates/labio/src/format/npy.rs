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

use std::fs::File;
use std::io::Read;
use std::path::Path;

use ndarray::{Array2, ArrayView1, ArrayView2, Axis};
use ndarray_npy::{ReadNpyExt, ViewNpyError, ViewNpyExt};

use crate::error::check_positive;
use crate::{Channel, LabioError, Provenance, Record};

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
    let record = File::open(path)
        .map_err(|source| LabioError::Read { source })
        .and_then(|file| read_from(file, channels));
    match record {
        Ok(record) => {
            let provenance = record.provenance().clone().found_at(path);
            Ok(record.with_provenance(provenance))
        }
        Err(error) => Err(LabioError::InFile {
            path: path.to_path_buf(),
            source: Box::new(error),
        }),
    }
}

/// Reads an array from `reader` to its end; `channels` name the rows after the row of times.
///
/// The sampling rate is the number of steps divided by the time between first and last sample.
///
/// # Errors
///
/// - [`LabioError::Read`]: the bytes cannot be read.
/// - [`LabioError::MalformedHeader`], [`LabioError::WrongDimensions`],
///   [`LabioError::WrongElement`], [`LabioError::NoData`], [`LabioError::Truncated`],
///   [`LabioError::TrailingBytes`]: the bytes are not an array of the expected layout.
/// - [`LabioError::NonUniformTime`]: a time step deviates from the mean step by more than a
///   relative [`TIME_STEP_TOLERANCE`].
/// - The errors of [`Record::new`] for channels and samples.
pub fn read_from(mut reader: impl Read, channels: &[Channel]) -> Result<Record, LabioError> {
    let mut bytes = Vec::new();
    reader
        .read_to_end(&mut bytes)
        .map_err(|source| LabioError::Read { source })?;
    let array = parse(&bytes)?;
    if array.nrows() != channels.len() + 1 {
        return Err(LabioError::CountMismatch {
            what: "rows of the array, one for the times and one per channel",
            found: array.nrows(),
            expected: channels.len() + 1,
        });
    }
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
    match header_end(bytes) {
        Some(end) if bytes.len() == end => return Err(LabioError::NoData { format: FORMAT }),
        // the parser below would allocate memory for a header of the announced length
        Some(end) if bytes.len() < end => {
            return Err(LabioError::MalformedHeader {
                format: FORMAT,
                detail: "the file ends inside it".to_owned(),
            });
        }
        _ => {}
    }
    match ArrayView2::<f64>::view_npy(bytes) {
        Ok(view) => Ok(view.to_owned()),
        // the shape agrees with the bytes; only the alignment of the buffer in memory does not
        // allow a view
        Err(ViewNpyError::MisalignedData) => {
            Array2::read_npy(bytes).map_err(|error| LabioError::MalformedHeader {
                format: FORMAT,
                detail: error.to_string(),
            })
        }
        Err(ViewNpyError::WrongNdim(_, found)) => Err(LabioError::WrongDimensions {
            format: FORMAT,
            found,
            expected: 2,
        }),
        Err(ViewNpyError::WrongDescriptor(found)) => Err(LabioError::WrongElement {
            format: FORMAT,
            found: found.to_string(),
            expected: "'<f8'",
        }),
        Err(ViewNpyError::NonNativeEndian) => Err(LabioError::WrongElement {
            format: FORMAT,
            found: "f8 of the other byte order".to_owned(),
            expected: "'<f8'",
        }),
        Err(ViewNpyError::MissingBytes(missing_bytes)) => Err(LabioError::Truncated {
            format: FORMAT,
            missing_bytes,
        }),
        Err(ViewNpyError::ExtraBytes(extra_bytes)) => Err(LabioError::TrailingBytes {
            format: FORMAT,
            extra_bytes,
        }),
        Err(error) => Err(LabioError::MalformedHeader {
            format: FORMAT,
            detail: match error {
                ViewNpyError::ParseHeader(reason) => reason.to_string(),
                ViewNpyError::Io(_) => "the file ends inside it".to_owned(),
                other => other.to_string(),
            },
        }),
    }
}

/// Returns the end of the header. The length of the header follows the magic string and two bytes
/// of version; `None` if there is no such header, which the parser then reports.
fn header_end(bytes: &[u8]) -> Option<usize> {
    match bytes.strip_prefix(b"\x93NUMPY")? {
        [1, _, a, b, ..] => Some(10 + usize::from(u16::from_le_bytes([*a, *b]))),
        [2 | 3, _, a, b, c, d, ..] => {
            let length = usize::try_from(u32::from_le_bytes([*a, *b, *c, *d]));
            Some(length.map_or(usize::MAX, |length| length.saturating_add(12)))
        }
        _ => None,
    }
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
            return Err(LabioError::TooFewSamples {
                what: "the row of times",
                found: times.len(),
                expected: 2,
            });
        };
        if let Some((index, &value)) = times.iter().enumerate().find(|(_, t)| !t.is_finite()) {
            return Err(LabioError::NonFiniteSample {
                channel: "time".to_owned(),
                index,
                value,
            });
        }
        let expected = check_positive(
            "mean time step [s]",
            (last - first) / (times.len() - 1) as f64,
        )?;
        for (index, (earlier, later)) in times.iter().zip(times.iter().skip(1)).enumerate() {
            let found = later - earlier;
            if (found - expected).abs() > TIME_STEP_TOLERANCE * expected {
                return Err(LabioError::NonUniformTime {
                    index,
                    found,
                    expected,
                    tolerance: TIME_STEP_TOLERANCE,
                });
            }
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
    use std::error::Error;

    /// A `.npy` of version 1.0 put together by hand.
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
        // times are dyadic numbers: exact
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

    #[test]
    fn a_buffer_at_an_odd_address_reads_the_same() {
        let mut shifted = vec![0_u8];
        shifted.extend(f8("(3, 4)", &DATA));
        let array = parse(&shifted[1..]).unwrap();
        assert_eq!(array.as_slice().unwrap(), DATA);
    }

    #[test]
    fn what_is_not_the_array_expected_is_refused_with_numbers() {
        let whole = f8("(3, 4)", &DATA);
        let mut uneven = DATA;
        uneven[2] = 0.76;
        let mut backwards = DATA;
        backwards[3] = 0.25;
        let mut timeless = DATA;
        timeless[1] = f64::NAN;
        let mut spoiled = DATA;
        spoiled[6] = f64::NEG_INFINITY;
        let mut longer = whole.clone();
        longer.extend([0; 3]);
        let f4 = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), }";
        let big = "{'descr': '>f8', 'fortran_order': False, 'shape': (3, 4), }";
        let cases = [
            whole[..whole.len() - 5].to_vec(),
            whole[..40].to_vec(),
            longer,
            Vec::new(),
            b"time;force;acceleration\n0;1;2\n".to_vec(),
            f8("(12,)", &DATA),
            f8("(4, 3)", &DATA),
            f8("(3, 1)", &DATA[..3]),
            f8("(0, 9223372036854775807, 9223372036854775807)", &[]),
            f8("(1000000000, 100000000)", &DATA),
            f8("(9223372036854775807, 9223372036854775807)", &DATA),
            npy(f4, &DATA),
            npy(big, &DATA),
            f8("(3, 4)", &uneven),
            f8("(3, 4)", &backwards),
            f8("(3, 4)", &timeless),
            f8("(3, 4)", &spoiled),
        ];
        let refusals = cases
            .map(|bytes| {
                let error = read_from(bytes.as_slice(), &channels()).unwrap_err();
                error.to_string()
            })
            .join("\n");
        insta::assert_snapshot!(refusals, @r"
        the npy data end 5 bytes too early
        the npy header cannot be read: the file ends inside it
        3 bytes follow the npy data
        the npy header cannot be read: the file ends inside it
        the npy header cannot be read: start does not match magic string
        the npy array has 1 axes, expected 2
        rows of the array, one for the times and one per channel: found 4, expected 3
        the row of times has 1 samples, expected at least 2
        the npy file contains no data
        the npy data end 799999999999999904 bytes too early
        the npy header cannot be read: overflow computing length from shape
        the npy array contains '<f4', expected '<f8'
        the npy array contains f8 of the other byte order, expected '<f8'
        time step 1 is 0.135 s, expected 0.125 s within a relative deviation of 0.000001
        mean time step [s] is -0.08333333333333333, expected a finite value above 0
        sample 1 of channel `time` is NaN, expected a finite value
        sample 2 of channel `force` is -inf, expected a finite value
        ");
    }

    #[test]
    fn errors_of_files_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.npy");
        let whole = f8("(3, 4)", &DATA);
        std::fs::write(&path, &whole[..whole.len() - 8]).unwrap();
        let error = read(&path, &channels()).unwrap_err();
        assert!(error.to_string().ends_with("cut.npy"));
        assert_eq!(
            error.source().unwrap().to_string(),
            "the npy data end 8 bytes too early"
        );
        let absent = read(folder.path().join("absent.npy"), &channels()).unwrap_err();
        let LabioError::InFile { source, .. } = absent else {
            panic!("expected the file to be named")
        };
        assert!(matches!(*source, LabioError::Read { .. }));

        std::fs::write(&path, &whole).unwrap();
        let record = read(&path, &channels()).unwrap();
        assert_eq!(
            record.provenance(),
            &Provenance::of_file(&path, "npy", &whole)
        );
    }
}
