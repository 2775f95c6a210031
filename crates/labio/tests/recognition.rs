//! Files are recognised by the reader of their format and by no other reader, except a file that
//! states two formats.

use testbed::measured;

use labio::format;

fn takers(bytes: &[u8]) -> Vec<&'static str> {
    let head = &bytes[..bytes.len().min(4096)];
    format::readers()
        .iter()
        .filter(|reader| reader.recognises(head))
        .map(|reader| reader.name())
        .collect()
}

#[test]
fn every_file_has_one_taker() {
    let cases: [(&[u8], &[&str]); 19] = [
        (crate::npy::SAVED, &["npz"]),
        (crate::mat5::PACKED, &["mat5"]),
        (crate::mat5::OLD, &["mat5"]),
        (
            b"LabVIEW Measurement\t\nSeparator\tTab\n1\t2\n3\t4\n",
            &["lvm"],
        ),
        (b"RF64\xff\xff\xff\xffWAVEds64", &["wav"]),
        (b"RIFF\x24\0\0\0WAVEfmt ", &["wav"]),
        (b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'", &["npy"]),
        (b"t;F\n0,1;2\n0,2;3\n", &["csv"]),
        (b"TDSm\x0e\0\0\0\x69\x12\0\0", &["tdms"]),
        (b"    -1\n    58\nNONE\n", &["uff58"]),
        (b"-1\n58\n3.5\n4\n", &["csv"]),
        (
            b"    -1\n   164\n         1         2\n         3         4\n",
            &["uff58"],
        ),
        (
            b"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x05\0\0\0a.txt",
            &[],
        ),
        (b"\x89HDF\r\n\x1a\n\0\0\0\0", &["hdf5"]),
        // the MATLAB header of this file states 7.3, so two readers recognise it; the first one
        // reads it
        (crate::hdf5::MATLAB, &["hdf5", "mat5"]),
        (crate::oscilloscope::FILES[0].1, &["wfm"]),
        (crate::oscilloscope::FILES[5].1, &["isf"]),
        (crate::oscilloscope::FILES[7].1, &["lecroy"]),
        (b"", &[]),
    ];
    for (bytes, expected) in cases {
        assert_eq!(
            takers(bytes),
            expected,
            "{:?}",
            String::from_utf8_lossy(bytes)
        );
    }
}

#[test]
fn the_measured_files_have_the_taker_of_their_ending() {
    let Some(folder) = measured::folder() else {
        return;
    };
    let mut seen = 0;
    for part in [
        "hammer",
        "lvm",
        "shock",
        "shpb",
        "dma",
        "dma/glassy-polymer",
        "tapered-rod",
        "tdms",
        "uff",
    ] {
        for entry in std::fs::read_dir(folder.join(part)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                continue;
            }
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let expected: &[&str] = match path.extension().and_then(|ending| ending.to_str()) {
                Some("lvm") => &["lvm"],
                Some("npy") => &["npy"],
                Some("csv") => &["csv"],
                Some("tdms") => &["tdms"],
                Some("uff") => &["uff58"],
                // a description in words has no data
                Some("txt") if name.contains("details") => &[],
                Some("txt") => &["csv"],
                _ => &[],
            };
            assert_eq!(takers(&std::fs::read(&path).unwrap()), expected, "{name}");
            seen += 1;
        }
    }
    assert!(seen > 48, "{seen} files");
}
