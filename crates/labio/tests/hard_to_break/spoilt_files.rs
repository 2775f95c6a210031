//! Random bytes, and files that are damaged or cut off, are read or rejected.

use std::io::Cursor;

use labio::format::{
    Reader, Strictness, csv, hdf5, lvm, mat5, npy, npz, readers, tdms, uff58, wav,
};
use proptest::prelude::*;
use proptest::sample::Index;

use crate::mat5::{BIG, LITTLE, PACKED, PLAIN, SPARSE};
use crate::tdms::{USUAL, segment};

fn any_reading(reader: &dyn Reader, bytes: &[u8]) {
    let _ = reader.recognises(bytes);
    let _ = reader.read(bytes, Strictness::Strict);
    let _ = reader.read(bytes, Strictness::Tolerant);
}

fn streams(bytes: &[u8]) {
    let _ = npy::Blocks::new(Cursor::new(bytes), &super::channels());
    let _ = npy::Blocks::new(Cursor::new(bytes), &[]);
    let _ = wav::Blocks::new(Cursor::new(bytes), &[], &[]);
}

/// Intact files of each format.
fn whole() -> Vec<(&'static dyn Reader, Vec<u8>)> {
    let mut files: Vec<(&'static dyn Reader, Vec<u8>)> = Vec::new();
    files.push((&csv::Csv, crate::csv::write(&crate::csv::sample()).unwrap()));
    files.extend(crate::lvm::whole().map(|file| (&lvm::Lvm as &dyn Reader, file)));
    let saved = [PLAIN, PACKED, SPARSE].map(<[u8]>::to_vec);
    let by_hand = [LITTLE.sample(), BIG.sample()];
    files.extend(
        saved
            .into_iter()
            .chain(by_hand)
            .map(|file| (&mat5::Mat5 as &dyn Reader, file)),
    );
    let hierarchies = crate::hdf5::whole().map(|file| (&hdf5::Hdf5 as &dyn Reader, file));
    files.extend(hierarchies);
    files.extend(crate::oscilloscope::whole());
    let [array, ours, theirs] = crate::npy::whole();
    files.push((&npy::Npy, array));
    files.extend([ours, theirs].map(|file| (&npz::Npz as &dyn Reader, file)));
    let of_nptdms = crate::reference_nptdms::FILES.map(|(_, file)| file.to_vec());
    files.extend(of_nptdms.map(|file| (&tdms::Tdms as &dyn Reader, file)));
    let of_pyuff = crate::reference_pyuff::THEIRS.map(|(_, file)| file.to_vec());
    files.extend(of_pyuff.map(|file| (&uff58::Uff58 as &dyn Reader, file)));
    files.extend(crate::wav::whole().map(|file| (&wav::Wav as &dyn Reader, file)));
    files
}

proptest! {
    #[test]
    fn any_bytes_behind_any_signature(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let after = |head: &[u8]| [head, &bytes].concat();
        let lead = [&b"TDSm\x0e\x00\x00\x00\x69\x12\x00\x00"[..], &[0xff; 8]].concat();
        for file in [
            after(b""),
            after(b"LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\n"),
            after(b"\x93NUMPY\x01\x00\x50\x00{'descr': "),
            after(b"PK\x03\x04"),
            after(b"\x0f\x0f:WFM#003"),
            after(b"WAVEDESC\0\0\0\0\0\0\0\0LECROY_2_3"),
            after(b":WFMP:BYT_N 1;"),
            after(b"\x89HDF\r\n\x1a\n\0"),
            after(b"\x89HDF\r\n\x1a\n\x02\x08\x08"),
            after(b"RIFF\x40\0\0\0WAVE"),
            after(b"    -1\n    58\n"),
            after(b"    -1\n    58b     1     2          11\n"),
            after(&lead),
            segment(USUAL, &[], &bytes),
            LITTLE.file(std::slice::from_ref(&bytes)),
            BIG.file(&[BIG.element(14, &bytes)]),
        ] {
            readers().iter().for_each(|reader| any_reading(*reader, &file));
            streams(&file);
        }
    }

    #[test]
    fn whole_files_spoilt_and_cut(
        spoils in prop::collection::vec((any::<Index>(), any::<u8>()), 0..3),
        cut in any::<Index>(),
    ) {
        for (reader, mut file) in whole() {
            any_reading(reader, &file[..cut.index(file.len())]);
            for (place, byte) in &spoils {
                let place = place.index(file.len());
                file[place] = *byte;
            }
            any_reading(reader, &file);
            streams(&file);
            file.truncate(cut.index(file.len()));
            any_reading(reader, &file);
            streams(&file);
        }
    }
}
