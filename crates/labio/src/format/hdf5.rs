//! HDF5 files, read only: files of MATLAB 7.3 (saved with `-v7.3`), netCDF-4 files, and files of
//! recorders and programs such as h5py.
//!
//! Needs the feature `hdf5`.
//!
//! # Data sets
//!
//! | data set | becomes |
//! |---|---|
//! | vector of numbers `a`, real or complex, of any type | series `a`, or `group/a` if it is in a group |
//! | matrix `a` | a series for each of its rows `a[0, :]`, ..., or of its columns `a[:, 0]`, ... if these are longer |
//! | array of more axes | a series along its last axis `a[0, 0, :]`, ...; skipped if there are more than 256 and another axis is longer |
//! | single number, text, attribute of a group | property of the contents |
//! | attribute of a data set | unit (`units` or `unit`), label (`long_name`), or property of its series |
//! | variable of MATLAB | as in a file of [version 5](super::mat5), with the sampling rate: `a(:,1)`, `s.length`, `c{1}` |
//!
//! Complex numbers are pairs of numbers named `r` and `i` (h5py) or `real` and `imag` (MATLAB).
//!
//! The coordinate variable of a dimension (in netCDF, or a scale that is attached to the axis)
//! becomes the abscissa of the series along that dimension, and is not a series itself. Without a
//! coordinate variable, the abscissa is the sample index from 0. Packed variables of netCDF
//! (`scale_factor`, `add_offset`) are unpacked. A sample that is equal to `_FillValue`, or was
//! never written to a netCDF file, is missing; a missing sample rejects the variable.
//!
//! # Rejected files
//!
//! - Contents that cannot be the numbers of a series: compounds other than complex numbers,
//!   enumerations, opaque types, integers beyond $`2^{53}`$, sparse matrices and MATLAB objects. A
//!   strict reading rejects the file; a tolerant one skips the data set with a defect. Damaged data
//!   sets are treated in the same way.
//! - Contents beyond a [`MemoryLimit`], in a strict or a tolerant reading.
//!
//! Links to other files are not followed.

mod array;
mod coordinate;
mod matlab;
mod values;

use std::collections::HashSet;
use std::rc::Rc;

use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Attribute, Dataset, Hdf5File, OpenOptions};

use crate::error;
use crate::format::matlab_array::sample_at_stated_rate;
use crate::format::reading::{DEEPEST, Reading};
use crate::format::{MemoryLimit, Reader, Strictness};
use crate::{Contents, LabioError, Place};

const FORMAT: &str = "hdf5";

const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// HDF5 files, read only; see the [module](self).
///
/// # Examples
///
/// ```no_run
/// use labio::format::hdf5::Hdf5;
/// use labio::format::{Reader, Strictness};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let contents = Hdf5.read(&std::fs::read("hits.mat")?, Strictness::Strict)?;
/// for series in &contents.series {
///     println!("{}: {} samples", series.name, series.ordinate.len());
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Hdf5;

impl Reader for Hdf5 {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Returns true for the signature at the beginning or after a user block of 512, 1024 or 2048
    /// bytes. MATLAB writes its header into a user block of 512 bytes.
    fn recognises(&self, head: &[u8]) -> bool {
        let at = |offset: usize| head.get(offset..).is_some_and(|h| h.starts_with(SIGNATURE));
        [0, 512, 1024, 2048].into_iter().any(at)
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_within(bytes, strictness, MemoryLimit::of_file(bytes.len()))
    }
}

/// Reads a whole file whose contents may take memory up to `limit`.
///
/// # Errors
///
/// The errors of [`Hdf5`] as a [`Reader`]; [`LabioError::MemoryLimit`] beyond the limit.
pub fn read_within(
    bytes: &[u8],
    strictness: Strictness,
    limit: MemoryLimit,
) -> Result<Contents, LabioError> {
    let most = usize::try_from(limit.bytes()).unwrap_or(usize::MAX);
    // each data set is read once: a cache of its chunks would only take memory
    let options = OpenOptions::default()
        .with_chunk_cache_bytes(0)
        .with_max_read_bytes(most);
    let file = Hdf5File::from_bytes_with_options(bytes, options).map_err(|e| refused("", 0, &e))?;
    let root = file.root_group().map_err(|e| refused("", 0, &e))?;
    let mut hierarchy = Hierarchy {
        reading: Reading::new(FORMAT, limit, strictness),
        visited: HashSet::new(),
        is_netcdf: root.attribute("_NCProperties").is_ok(),
        root,
        referenced: None,
        scales: coordinate::Scales::new(),
    };
    let root = hierarchy.root.clone();
    if bytes.starts_with(b"MATLAB 7.3") {
        let description: String = bytes.iter().take(116).copied().map(char::from).collect();
        let description = description.trim_end_matches([' ', '\0']).to_owned();
        hierarchy
            .reading
            .property(0, "description".to_owned(), description)?;
        matlab::variables(&root, &mut hierarchy)?;
        sample_at_stated_rate(&mut hierarchy.reading.contents);
    } else {
        hierarchy.group(&root, "", 0)?;
    }
    Ok(hierarchy.reading.contents)
}

/// Contents read so far, and the state needed to read the rest of the file.
struct Hierarchy {
    reading: Reading,
    /// Addresses of the groups that were read or, in a MATLAB file, that are being read: a group
    /// may be linked into itself.
    visited: HashSet<u64>,
    root: Group,
    /// Cells and fields of MATLAB's structure arrays by their addresses, read when first needed.
    referenced: Option<Rc<matlab::Referenced>>,
    scales: coordinate::Scales,
    /// True for a netCDF file: its default fill value marks samples that were never written.
    is_netcdf: bool,
}

impl Hierarchy {
    /// Reads all data sets of a group and of the groups within it.
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), LabioError> {
        let at = group.address();
        if !self.visited.insert(at) {
            return Ok(());
        }
        if depth > DEEPEST {
            let found = format!("{depth} levels deep");
            let error = malformed(path, at, found, "at most 64 levels");
            return self.reading.pass_over(error, at);
        }
        match group.attributes() {
            Ok(attributes) => {
                for attribute in &attributes {
                    let Some(text) = text_of(attribute) else {
                        continue;
                    };
                    self.reading
                        .property(at, format!("{path}{}", attribute.name), text)?;
                }
            }
            Err(error) => self.reading.pass_over(refused(path, at, &error), at)?,
        }
        let (groups, datasets) = match group.members() {
            Ok(members) => members,
            Err(error) => return self.reading.pass_over(refused(path, at, &error), at),
        };
        coordinate::collect(&datasets, path, self)?;
        for dataset in &datasets {
            let name = format!("{path}{}", dataset.name());
            let read = array::read(dataset, &name, self);
            read.or_else(|error| self.reading.pass_over(error, dataset.address()))?;
        }
        for inner in &groups {
            self.group(inner, &format!("{path}{}/", inner.name()), depth + 1)?;
        }
        Ok(())
    }
}

/// Returns the text or the single number of an attribute; `None` for references and arrays.
fn text_of(attribute: &Attribute) -> Option<String> {
    if let Ok(text) = attribute.read_string() {
        return Some(text.trim_end_matches(['\0', ' ']).to_owned());
    }
    let is_single = attribute.shape.iter().product::<u64>() == 1;
    is_single
        .then(|| attribute.read_as_f64().ok())?
        .map(|number| number.to_string())
}

/// Returns the attribute called `name` as a text.
fn attribute(dataset: &Dataset, name: &str) -> Option<String> {
    text_of(&dataset.attribute(name).ok()?)
}

fn refused(name: &str, at: u64, error: &Error) -> LabioError {
    malformed(name, at, error.to_string(), "a readable HDF5 object")
}

fn malformed(name: &str, at: u64, found: String, expected: &str) -> LabioError {
    let field = match name.trim_end_matches('/') {
        "" => "the file".to_owned(),
        name => format!("`{name}`"),
    };
    error::malformed(FORMAT, Place::Byte(at), &field, found, expected)
}
