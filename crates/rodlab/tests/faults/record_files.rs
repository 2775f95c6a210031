//! A small recording in each format, and the places at which a cut leaves a complete file.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::runs::Folder;
use labio::format::npz::Npz;
use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58Writer};
use labio::format::wav::{WavEncoding, WavWriter};
use labio::format::{self, Writer};
use rodlab::convert::ConvertOptions;

/// A file, its bytes, and a flag for cuts whose remaining file cannot be distinguished from a
/// complete one.
pub(crate) struct RecordFile {
    pub(crate) name: &'static str,
    pub(crate) ending: &'static str,
    pub(crate) bytes: Vec<u8>,
    pub(crate) is_whole_at: fn(&[u8]) -> bool,
}

const N_ROWS: usize = 48;

/// A row of two channels with numbers of 17 digits.
fn sample(row: usize) -> [f64; 2] {
    let t = row as f64 / 3.0;
    [(t + 0.1).sin() * 3.7, (1.3 * t).cos() * 11.1]
}

fn table() -> Vec<u8> {
    let mut text = String::from("Time (s),hammer (N),end A (m/s^2)\n");
    for row in 0..N_ROWS {
        let [a, b] = sample(row);
        writeln!(text, "{},{a},{b}", row as f64 / 1024.0).unwrap();
    }
    text.into_bytes()
}

fn lvm() -> Vec<u8> {
    let head = "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t.\r\n\
                Multi_Headings\tNo\r\nX_Columns\tNo\r\nTime_Pref\tAbsolute\r\n***End_of_Header***\t\r\n\t\r\nChannels\t2\t\t\r\n";
    let mut text = head.to_owned();
    write!(text, "Samples\t{N_ROWS}\t{N_ROWS}\t\r\n").unwrap();
    text.push_str(
        "Date\t2020/01/01\t2020/01/01\t\r\nY_Unit_Label\tN\tm/s^2\t\r\nX_Dimension\tTime\tTime\t\r\nX0\t0.0\t0.0\t\r\n\
         Delta_X\t9.765625E-4\t9.765625E-4\t\r\n***End_of_Header***\t\t\t\r\nX_Value\thammer\tend A\tComment\r\n",
    );
    for row in 0..N_ROWS {
        let [a, b] = sample(row);
        write!(text, "\t{a:.6}\t{b:.6}\r\n").unwrap();
    }
    text.into_bytes()
}

fn written(writer: &dyn Writer) -> Vec<u8> {
    let contents = format::read_bytes(&table()).unwrap();
    let mut bytes = Vec::new();
    writer.write(&contents, &mut bytes).unwrap();
    bytes
}

fn reference(path: &str) -> Vec<u8> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/reference");
    fs::read(root.join(path)).unwrap()
}

fn universal(encoding: Encoding) -> Vec<u8> {
    written(&Uff58Writer {
        encoding,
        precision: Precision::Double,
    })
}

/// One recording in each format; formats that `labio` does not write are from SciPy and npTDMS, or
/// written by hand.
pub(crate) fn all() -> Vec<RecordFile> {
    let file = |name, ending, bytes, is_whole_at| RecordFile {
        name,
        ending,
        bytes,
        is_whole_at,
    };
    vec![
        file("table in text", "csv", table(), at_end_of_line),
        file("LabVIEW measurement", "lvm", lvm(), never),
        file(
            "WAVE",
            "wav",
            written(&WavWriter {
                encoding: WavEncoding::Float64,
            }),
            never,
        ),
        file("NumPy array", "npy", array(), never),
        file("NumPy archive", "npz", written(&Npz), never),
        file(
            "MATLAB 5",
            "mat",
            reference("mat5/plain.mat"),
            after_a_variable,
        ),
        file(
            "MATLAB 5, compressed",
            "mat",
            reference("mat5/packed.mat"),
            after_a_variable,
        ),
        file(
            "TDMS",
            "tdms",
            reference("nptdms/segments.tdms"),
            after_a_segment,
        ),
        file(
            "universal file, text",
            "uff",
            universal(Encoding::Ascii),
            after_a_data_set,
        ),
        file(
            "universal file, 58b",
            "uff",
            universal(Encoding::Binary(ByteOrder::LittleEndian)),
            after_a_data_set,
        ),
    ]
}

/// The recording as NPY, which contains only numbers: names and times are lost.
fn array() -> Vec<u8> {
    let folder = Folder::new();
    let [table_file, array] = ["hit.csv", "hit.npy"].map(|name| folder.file(name));
    fs::write(&table_file, table()).unwrap();
    rodlab::convert::convert(&table_file, &array, ConvertOptions::default()).unwrap();
    fs::read(array).unwrap()
}

fn never(_: &[u8]) -> bool {
    false
}

pub(crate) fn at_end_of_line(bytes: &[u8]) -> bool {
    bytes.ends_with(b"\n")
}

/// True after the line that closes a data set, with or without the end of this line or blanks of
/// the next line, but not after the line that opens the next data set. There is no end of line
/// between IEEE numbers and the closing line.
fn after_a_data_set(bytes: &[u8]) -> bool {
    let bytes = bytes.trim_ascii_end();
    bytes.ends_with(b"    -1") && !bytes.ends_with(b"    -1\n    -1") && bytes.len() > 6
}

/// True between the elements of a file. An element consists of its type and its length, of four
/// bytes each, and as many bytes as the length states.
fn after_a_variable(bytes: &[u8]) -> bool {
    let mut at = 128;
    while let Some(tag) = bytes.get(at..at + 8) {
        let kind = u32::from_le_bytes(tag[..4].try_into().unwrap());
        let length = u32::from_le_bytes(tag[4..].try_into().unwrap()) as usize;
        // all elements except compressed ones are padded to multiples of eight bytes
        at += 8 + if kind == 15 {
            length
        } else {
            length.next_multiple_of(8)
        };
    }
    at == bytes.len() && at > 128
}

/// True between segments, each of which states the position of the next.
fn after_a_segment(bytes: &[u8]) -> bool {
    let mut at = 0;
    while let Some(next) = bytes.get(at + 12..at + 20) {
        at += 28 + usize::try_from(u64::from_le_bytes(next.try_into().unwrap())).unwrap();
    }
    at == bytes.len() && at > 0
}
