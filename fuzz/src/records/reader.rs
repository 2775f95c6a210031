//! Readers of `labio::format`, each with the bytes as they are.

use labio::format::{self, Reader, Strictness};
use labio::{Contents, LabioError};

use super::{blocks, contents, memory, prints, round_trip};

/// Reads in both modes: a file accepted by the strict reader is read by the tolerant one without
/// defects, and its contents, written in any format, are read again.
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
            .expect("what is read strictly is read tolerantly");
        assert!(tolerant.defects.is_empty(), "{:?}", tolerant.defects);
        assert_eq!(strict.properties, tolerant.properties);
        assert_eq!(strict.series.len(), tolerant.series.len());
        for (one, other) in strict.series.iter().zip(&tolerant.series) {
            round_trip::same(one, other, 0.0, "strictly and tolerantly");
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
    /// Text tables.
    csv: format::csv::Csv;
    /// LabVIEW measurement files.
    lvm: format::lvm::Lvm;
    /// WAVE, whole and in blocks.
    wav: format::wav::Wav, blocks::wav;
    /// An array of NumPy, whole and in blocks.
    npy: format::npy::Npy, blocks::npy;
    /// An archive of NumPy.
    npz: format::npz::Npz;
    /// Traces of Tektronix with a preamble in text.
    isf: format::oscilloscope::TektronixIsf;
    /// Traces of LeCroy.
    lecroy: format::oscilloscope::LeCroy;
    /// Traces of Tektronix in binary.
    wfm: format::oscilloscope::TektronixWfm;
    /// HDF5: MATLAB 7.3, netCDF-4, h5py.
    hdf5: format::hdf5::Hdf5;
    /// MATLAB 5.
    mat5: format::mat5::Mat5;
    /// TDMS.
    tdms: format::tdms::Tdms;
    /// Universal files.
    uff58: format::uff58::Uff58;
}
