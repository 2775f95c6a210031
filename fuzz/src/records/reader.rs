//! Readers of `labio::format`, each called with the unchanged bytes.

use labio::format::{self, Reader, Strictness};
use labio::{Contents, LabioError};

use super::{blocks, contents, memory, prints, round_trip};

/// Reads in both modes. Checks that a file accepted by the strict reader is read by the tolerant
/// one without defects, and that its contents, written in any format, can be read again.
pub fn both_manners(
    bytes: &[u8],
    read: impl Fn(Strictness) -> Result<Contents, LabioError>,
) -> Option<Contents> {
    let [strict, tolerant] = [Strictness::Strict, Strictness::Tolerant]
        .map(|strictness| memory::bounded(bytes, || read(strictness)));
    for (result, is_strict) in [(&strict, true), (&tolerant, false)] {
        match result {
            Ok(found) => contents::check(found, bytes, is_strict),
            Err(error) => prints(error),
        }
    }
    if let Ok(strict) = &strict {
        let tolerant = tolerant
            .as_ref()
            .expect("the tolerant reader accepts what the strict reader accepts");
        assert!(tolerant.defects.is_empty(), "{:?}", tolerant.defects);
        assert_eq!(strict.properties, tolerant.properties);
        assert_eq!(strict.series.len(), tolerant.series.len());
        for (one, other) in strict.series.iter().zip(&tolerant.series) {
            round_trip::same(one, other, 0.0, "strict and tolerant reading");
            assert_eq!(
                (&one.name, &one.properties),
                (&other.name, &other.properties)
            );
        }
    }
    let found = tolerant.ok()?;
    round_trip::check(&found);
    Some(found)
}

fn reader(reader: &dyn Reader, bytes: &[u8]) {
    if let Some(found) = both_manners(bytes, |strictness| reader.read(bytes, strictness)) {
        assert_eq!(found.format, reader.name());
    }
}

macro_rules! readers {
    ($($(#[$doc:meta])* $name:ident: $reader:expr $(, $also:expr)?;)*) => {$(
        $(#[$doc])*
        pub fn $name(bytes: &[u8]) {
            reader(&$reader, bytes);
            $($also(bytes);)?
        }
    )*};
}

readers! {
    /// Checks the reader of text tables.
    csv: format::csv::Csv;
    /// Checks the reader of LabVIEW measurement files.
    lvm: format::lvm::Lvm;
    /// Checks the readers of WAVE files, whole and in blocks.
    wav: format::wav::Wav, blocks::wav;
    /// Checks the readers of arrays of NumPy, whole and in blocks.
    npy: format::npy::Npy, blocks::npy;
    /// Checks the reader of archives of NumPy.
    npz: format::npz::Npz;
    /// Checks the reader of Tektronix traces with a preamble in text.
    isf: format::oscilloscope::TektronixIsf;
    /// Checks the reader of LeCroy traces.
    lecroy: format::oscilloscope::LeCroy;
    /// Checks the reader of binary Tektronix traces.
    wfm: format::oscilloscope::TektronixWfm;
    /// Checks the reader of HDF5 files: MATLAB 7.3, netCDF-4, h5py.
    hdf5: format::hdf5::Hdf5;
    /// Checks the reader of MATLAB 5 files.
    mat5: format::mat5::Mat5;
    /// Checks the reader of TDMS files.
    tdms: format::tdms::Tdms;
    /// Checks the reader of universal files.
    uff58: format::uff58::Uff58;
}
