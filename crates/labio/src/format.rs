//! File formats with a common interface: [`read`] recognises the format of a file by its content;
//! each format has a [`Reader`] and may have a [`Writer`].
//!
//! The result of reading is [`Contents`]: the data sets of the file in the file's own units. Errors
//! are [`LabioError`]s that name the file, the place and what was expected there.
//! [`Contents::records`] combines series that were sampled together into a
//! [`Record`].
//!
//! ```no_run
//! use labio::format::{self, uff58::Uff58Writer};
//!
//! # fn main() -> Result<(), labio::LabioError> {
//! let contents = format::read("hits.tdms")?;
//! for series in &contents.series {
//!     println!("{} [{}]", series.name, series.ordinate_axis.unit_text);
//! }
//! format::write("hits.uff", &contents, &Uff58Writer::default())?;
//! # Ok(())
//! # }
//! ```
//!
//! Theory: `docs/formats.md`.

use std::fmt::Debug;
use std::fs;
use std::io::Write;
use std::path::Path;

use crate::error::{check_positive, count_mismatch, not_read};
use crate::{Abscissa, Contents, Dimension, LabioError, Provenance, Record};

pub mod csv;
#[cfg(feature = "hdf5")]
pub mod hdf5;
pub mod lvm;
pub mod mat5;
pub mod npy;
pub mod npz;
pub mod octave;
pub mod oscilloscope;
pub mod tdms;
pub mod uff58;
pub mod wav;
#[cfg(feature = "workbook")]
pub mod workbook;

mod kind;
mod matlab_array;
mod memory;
mod number_type;
mod reading;
mod replace_file;
mod rounding;
mod sampled_together;
mod text;

pub use memory::MemoryLimit;
pub use rounding::{CustomaryRate, RateFamily, customary_rate};
pub use sampled_together::SampledTogether;
pub use text::DecimalMark;

/// Treatment of a part of a file that cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strictness {
    /// Reject the file.
    #[default]
    Strict,
    /// Return what can be read, and list the rest in [`Contents::defects`].
    Tolerant,
}

impl Strictness {
    /// Adds the error of a part of a file to `defects` if the rest of the file is read nevertheless.
    fn pass_over(self, error: LabioError, defects: &mut Vec<LabioError>) -> Result<(), LabioError> {
        match self {
            Self::Strict => Err(error),
            Self::Tolerant => {
                defects.push(error);
                Ok(())
            }
        }
    }
}

/// A reader of a format.
pub trait Reader: Debug + Sync {
    /// Name of the format, for example `uff58`.
    fn name(&self) -> &'static str;

    /// Returns true if a file that begins with `head` is of this format. A format with a signature
    /// needs the first 4096 bytes of a file, or the whole file if it is shorter; a text table is
    /// recognised by its first rows of numbers, however long its header is.
    fn recognises(&self, head: &[u8]) -> bool;

    /// Reads a whole file. Memory is allocated only for bytes that exist, whatever size a header
    /// states, and for packed bytes only up to the default [`MemoryLimit`].
    ///
    /// # Errors
    ///
    /// [`LabioError`] with the place of the fault; if `strictness` is tolerant, only if nothing can
    /// be read from the bytes.
    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError>;

    /// Returns true if every file of the format states its own length, so that a truncated file can
    /// be detected.
    fn states_length(&self) -> bool {
        true
    }

    /// Returns true if files of the format are tables of rows, in which one column may be the
    /// abscissa.
    fn reads_tables(&self) -> bool {
        false
    }
}

/// A writer of a format.
pub trait Writer: Debug + Sync {
    /// Name of the format.
    fn name(&self) -> &'static str;

    /// Writes `contents`. Contents that the format cannot represent cause an error before the first
    /// byte is written.
    ///
    /// # Errors
    ///
    /// [`LabioError`] for contents that the format cannot represent, or [`LabioError::Write`].
    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError>;
}

/// All formats that are recognised. The first that recognises a file reads it: formats with a
/// signature come before those that are plain text.
static READERS: &[&dyn Reader] = &[
    &tdms::Tdms,
    &wav::Wav,
    &npy::Npy,
    &npz::Npz,
    #[cfg(feature = "hdf5")]
    &hdf5::Hdf5,
    &mat5::Mat5,
    #[cfg(feature = "workbook")]
    &workbook::Xlsx,
    #[cfg(feature = "workbook")]
    &workbook::Xls,
    &oscilloscope::LeCroy,
    &oscilloscope::TektronixWfm,
    &oscilloscope::TektronixIsf,
    &uff58::Uff58,
    &lvm::Lvm,
    &octave::OctaveText,
    &csv::Csv,
];

/// Returns the readers of all recognised formats, in the order in which they are tried.
#[must_use]
pub fn readers() -> &'static [&'static dyn Reader] {
    READERS
}

/// Returns the reader of the format called `name`, such as `uff58`.
#[must_use]
pub fn reader(name: &str) -> Option<&'static dyn Reader> {
    READERS.iter().copied().find(|reader| reader.name() == name)
}

/// Returns the reader for the whole file `bytes`, or `None` if its format is not known.
#[must_use]
pub fn recognise(bytes: &[u8]) -> Option<&'static dyn Reader> {
    READERS
        .iter()
        .copied()
        .find(|reader| reader.recognises(bytes))
}

/// Reads the file at `path`, whatever its name, and rejects it if any part of it cannot be read.
///
/// # Errors
///
/// [`LabioError::InFile`] with the path and, as its source, the error of opening the file or of
/// [`read_bytes`].
pub fn read(path: impl AsRef<Path>) -> Result<Contents, LabioError> {
    read_with(path, Strictness::Strict)
}

/// Reads the file at `path` with the given strictness.
///
/// # Errors
///
/// The errors of [`read`].
pub fn read_with(path: impl AsRef<Path>, strictness: Strictness) -> Result<Contents, LabioError> {
    let path = path.as_ref();
    fs::read(path)
        .map_err(not_read)
        .and_then(|bytes| read_bytes_with(&bytes, strictness))
        .map_err(|source| in_file(path, source))
}

/// Reads a whole file from memory, and rejects it if any part of it cannot be read.
///
/// # Errors
///
/// [`LabioError::UnknownFormat`], or the error of the format's [`Reader`]; for rows of numbers with
/// text among them, such as dates, [`LabioError::Malformed`] with the first of these cells.
pub fn read_bytes(bytes: &[u8]) -> Result<Contents, LabioError> {
    read_bytes_with(bytes, Strictness::Strict)
}

/// Reads a whole file from memory with the given strictness.
///
/// # Errors
///
/// The errors of [`read_bytes`].
pub fn read_bytes_with(bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
    reader_of(bytes)?.read(bytes, strictness)
}

/// Reads a whole file, sampled at `rate_hz`, from memory, and rejects it if any part of it cannot
/// be read.
///
/// Unevenly spaced times, for example times in single precision or with few digits, are replaced by
/// evenly spaced times at this rate if every time differs from its replacement by less than half a
/// step. Other abscissae are read as by [`read_bytes`]; a rate that contradicts them is not an
/// error.
///
/// # Errors
///
/// The errors of [`read_bytes`]; [`LabioError::NonPhysical`] for a rate that is not positive;
/// [`LabioError::Malformed`] for unevenly spaced times of a table, in a unit of time, that
/// contradict the rate.
///
/// # Examples
///
/// ```
/// use labio::{Abscissa, format};
///
/// // times in single precision: 0.1 is 0.10000000149011612
/// let file = b"time [s],force [N]\n0,1\n0.10000000149011612,2\n0.20000000298023224,3\n0.30000001192092896,4\n";
/// let contents = format::read_bytes_at(file, 10.0)?;
/// assert_eq!(contents.series[0].abscissa, Abscissa::Even { start: 0.0, step: 0.1 });
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn read_bytes_at(bytes: &[u8], rate_hz: f64) -> Result<Contents, LabioError> {
    check_positive("sampling rate [Hz]", rate_hz)?;
    let reader = reader_of(bytes)?;
    let abscissa = csv::CsvAbscissa::Rate(rate_hz);
    if reader.name() == Reader::name(&csv::Csv) {
        let options = csv::CsvOptions::default().with_abscissa(abscissa);
        return csv::read_with(bytes, Strictness::Strict, &options);
    }
    #[cfg(feature = "workbook")]
    if [Reader::name(&workbook::Xlsx), Reader::name(&workbook::Xls)].contains(&reader.name()) {
        return workbook::read_at(bytes, Strictness::Strict, abscissa);
    }
    let mut contents = reader.read(bytes, Strictness::Strict)?;
    for series in &mut contents.series {
        let (Abscissa::Uneven(times), Some(unit)) = (&series.abscissa, &series.abscissa_axis.unit)
        else {
            continue;
        };
        if unit.dimension() != Dimension::TIME {
            continue;
        }
        let step = 1.0 / (rate_hz * unit.scale());
        if let Some(start) = rounding::start_at_step(times, step) {
            series.abscissa = Abscissa::Even { start, step };
        }
    }
    Ok(contents)
}

fn reader_of(bytes: &[u8]) -> Result<&'static dyn Reader, LabioError> {
    let unknown = || LabioError::UnknownFormat {
        head: bytes
            .iter()
            .take(16)
            .map(|&byte| char::from(byte))
            .collect(),
        n_bytes: bytes.len(),
        known: READERS.iter().map(|reader| reader.name()).collect(),
    };
    recognise(bytes).ok_or_else(|| csv::text_among_numbers(bytes).unwrap_or_else(unknown))
}

/// Reads the file at `path`, rejects it if any part of it cannot be read, and combines series that
/// were sampled together into records. The records contain the path of the file and the hash of its
/// bytes.
///
/// # Errors
///
/// The errors of [`read`].
pub fn read_records(path: impl AsRef<Path>) -> Result<SampledTogether, LabioError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| in_file(path, not_read(source)))?;
    let contents = read_bytes(&bytes).map_err(|source| in_file(path, source))?;
    Ok(contents.records(&Provenance::of_file(path, contents.format, &bytes)))
}

/// Reads the file at `path` as [`read_records`] does, and returns the one record that contains all
/// its series.
///
/// # Errors
///
/// The errors of [`read`]; [`LabioError::CountMismatch`] for a file without a record or with
/// several; if a series is in no record, the error that states why.
pub fn read_record(path: impl AsRef<Path>) -> Result<Record, LabioError> {
    let path = path.as_ref();
    let found = read_records(path)?;
    if let Some(reason) = found.left_out.into_iter().next() {
        return Err(in_file(path, reason));
    }
    let records = <[Record; 1]>::try_from(found.records);
    let [record] = records.or_else(|records| {
        count_mismatch("records in the file", records.len(), 1)
            .map_err(|source| in_file(path, source))
    })?;
    Ok(record)
}

/// Writes `contents` to the file at `path`, which is replaced only after everything has been
/// written: if an error occurs, the old file remains.
///
/// # Errors
///
/// [`LabioError::InFile`] with the path and, as its source, the error of `writer` or
/// [`LabioError::Write`].
pub fn write(
    path: impl AsRef<Path>,
    contents: &Contents,
    writer: &dyn Writer,
) -> Result<(), LabioError> {
    let path = path.as_ref();
    replace_file::replace(path, |output| writer.write(contents, output))
        .map_err(|source| in_file(path, source))
}

/// Opens the file at `path` and returns the result of `with`; an error names the file.
fn opened<T>(
    path: &Path,
    with: impl FnOnce(fs::File) -> Result<T, LabioError>,
) -> Result<T, LabioError> {
    fs::File::open(path)
        .map_err(not_read)
        .and_then(with)
        .map_err(|source| in_file(path, source))
}

fn in_file(path: &Path, source: LabioError) -> LabioError {
    LabioError::InFile {
        path: path.to_path_buf(),
        source: Box::new(source),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error;

    const UNIVERSAL: &[u8] = b"    -1\n   164\n         1SI\n    -1\n";

    #[test]
    fn what_is_known_and_not_read_is_named_with_a_way_out() {
        for (bytes, expected) in [
            (&b"\x1f\x8b\x08\0"[..], "; gzip: unpack it"),
            (
                b"CDF\x01\0\0\0\0",
                "; netCDF-3: `nccopy -k nc4 old.nc new.nc` converts it to netCDF-4, which can be read",
            ),
            (b"\x7fELF", ")"),
        ] {
            let said = read_bytes(bytes).unwrap_err().to_string();
            assert!(said.ends_with(expected), "{said}");
        }
    }

    #[test]
    fn unknown_bytes_are_shown() {
        let error = read_bytes(b"\x7fELF\x02\x01\x01\x00 and so on, and on")
            .unwrap_err()
            .to_string();
        let expected = r#"the 26 bytes that begin with "\u{7f}ELF\u{2}\u{1}\u{1}\u{0} and so " are not in a known format ("#;
        assert!(error.starts_with(expected), "{error}");
        assert!(matches!(
            read_bytes(b""),
            Err(LabioError::UnknownFormat { n_bytes: 0, .. })
        ));
    }

    #[test]
    fn errors_of_files_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.dat");
        fs::write(&path, &UNIVERSAL[..20]).unwrap();
        let error = read(&path).unwrap_err();
        assert!(error.to_string().ends_with("cut.dat"));
        assert!(error.source().unwrap().to_string().contains("data set 164"));
        assert!(read(folder.path().join("absent")).is_err());
    }
}
