//! Workbooks of Excel 97 to 2003: numbers in all of their forms, texts, dates, several worksheets,
//! files that are cut off or changed. The workbooks are written here, byte by byte after [MS-CFB]
//! and [MS-XLS].

use labio::LabioError;
use labio::format::workbook::Xls;
use labio::format::{self, Reader, Strictness};

use crate::series::{bits, even, real};

const SECTOR: usize = 512;

fn padded(mut bytes: Vec<u8>, to: usize) -> Vec<u8> {
    bytes.resize(bytes.len().div_ceil(to) * to, 0);
    bytes
}

fn chain(first: usize, n: usize) -> impl Iterator<Item = u32> {
    (1..=n).map(move |k| {
        if k == n {
            0xffff_fffe
        } else {
            u32::try_from(first + k).unwrap()
        }
    })
}

fn longs(numbers: impl Iterator<Item = u32>, to: usize) -> Vec<u8> {
    let mut bytes: Vec<u8> = numbers.flat_map(u32::to_le_bytes).collect();
    bytes.resize(bytes.len().div_ceil(to) * to, 0xff);
    bytes
}

/// A compound file with one stream, in small sectors if it has less than 4096 bytes.
fn compound(name: &str, stream: &[u8]) -> Vec<u8> {
    let small = stream.len() < 4096;
    let entry = |name: &str, kind: u8, first: usize, length: usize| {
        let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
        entry.resize(128, 0);
        entry[66] = kind;
        entry[116..120].copy_from_slice(&u32::try_from(first).unwrap().to_le_bytes());
        entry[120..124].copy_from_slice(&u32::try_from(length).unwrap().to_le_bytes());
        entry
    };
    // table of sectors, directory, table of small sectors, the stream
    let begin = 3;
    let data = padded(stream.to_vec(), SECTOR);
    let table = [0xffff_fffd, 0xffff_fffe, 0xffff_fffe].into_iter();
    let table = longs(table.chain(chain(begin, data.len() / SECTOR)), SECTOR);
    let root = entry("Root Entry", 5, begin, data.len());
    let own = entry(name, 2, if small { 0 } else { begin }, stream.len());
    let mut header = vec![0; 76];
    header[..8].copy_from_slice(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1");
    for (at, number) in [
        (44, 1),
        (48, 1),
        (56, 4096),
        (60, 2),
        (64, 1),
        (68, 0xffff_fffe_u32),
    ] {
        header[at..at + 4].copy_from_slice(&number.to_le_bytes());
    }
    header[30] = 9;
    header[32] = 6;
    header.extend(0_u32.to_le_bytes());
    header.resize(SECTOR, 0xff);
    [
        header,
        table,
        padded([root, own].concat(), SECTOR),
        longs(chain(0, stream.len().div_ceil(64)), SECTOR),
        data,
    ]
    .concat()
}

fn record(kind: u16, data: &[u8]) -> Vec<u8> {
    let length = u16::try_from(data.len()).unwrap().to_le_bytes();
    [&kind.to_le_bytes()[..], &length, data].concat()
}

fn words(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn begin(kind: u16) -> Vec<u8> {
    record(0x0809, &words(&[0x0600, kind]))
}

/// A stream of texts, displays and worksheets, each a name with its records.
fn stream(globals: &[u8], worksheets: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let named = |place: usize, name: &str| {
        let place = u32::try_from(place).unwrap().to_le_bytes();
        let length = u8::try_from(name.len()).unwrap();
        record(
            0x0085,
            &[&place[..], &[0, 0, length, 0], name.as_bytes()].concat(),
        )
    };
    let end = record(0x000a, &[]);
    let names: usize = worksheets
        .iter()
        .map(|(name, _)| named(0, name).len())
        .sum();
    let mut place = begin(5).len() + globals.len() + names + end.len();
    let mut all = [&begin(5), globals].concat();
    let mut bodies = Vec::new();
    for (name, records) in worksheets {
        all.extend(named(place, name));
        let body = [begin(0x10), records.clone(), end.clone()].concat();
        place += body.len();
        bodies.extend(body);
    }
    [all, end, bodies].concat()
}

/// Records of texts; the second text is continued in another record, changes there from one to two
/// bytes per character, and is partly in another font.
fn texts() -> Vec<u8> {
    let first = b"\x09\x00\x00Time [ms]";
    let second = b"\x0a\x00\x08\x01\x00Force ";
    let third = b"\x01\x5b\x00k\x00N\x00]\x00\0\0\0\0";
    let counts = [3_u32, 3].map(u32::to_le_bytes).concat();
    let mut last = third.to_vec();
    last.extend(b"\x08\x00\x04\x04\x00\x00\x00no digit\0\0\0\0");
    [
        record(0x00fc, &[&counts[..], first, second].concat()),
        record(0x003c, &last),
    ]
    .concat()
}

/// Records of four styles: a number, a built-in date, a date of its own format, and a number with
/// the word seconds in quotes.
fn styles() -> Vec<u8> {
    let display = |number: u16, text: &str| {
        let head = words(&[number, u16::try_from(text.len()).unwrap()]);
        record(0x041e, &[&head[..], &[0], text.as_bytes()].concat())
    };
    let style = |number: u16| record(0x00e0, &words(&[0, number, 0]));
    [
        display(164, "yyyy\\-mm"),
        display(165, "[Red]0.00\" seconds\""),
        [0, 14, 164, 165].map(style).concat(),
    ]
    .concat()
}

fn label(row: u16, column: u16, text: u32) -> Vec<u8> {
    record(
        0x00fd,
        &[words(&[row, column, 0]), text.to_le_bytes().to_vec()].concat(),
    )
}

fn number(row: u16, column: u16, style: u16, value: f64) -> Vec<u8> {
    record(
        0x0203,
        &[words(&[row, column, style]), value.to_le_bytes().to_vec()].concat(),
    )
}

fn short(value: i32) -> [u8; 4] {
    ((value << 2) | 2).to_le_bytes()
}

/// Names, and five rows with every stored form of a number.
fn table(style: u16) -> Vec<u8> {
    let hundredth = |value: i32| {
        let mut bytes = short(value);
        bytes[0] |= 1;
        bytes
    };
    let half = (0.5_f64.to_bits() >> 32) as u32;
    let pair = |row: u16, a: [u8; 4], b: [u8; 4]| {
        let cells = [
            &words(&[row, 1, 0])[..],
            &a,
            &words(&[style]),
            &b,
            &words(&[2]),
        ]
        .concat();
        record(0x00bd, &cells)
    };
    let formula = [
        &words(&[5, 2, 0])[..],
        &(-1.0_f64 / 3.0).to_le_bytes(),
        &[0; 8],
    ]
    .concat();
    [
        label(0, 1, 0),
        label(0, 2, 1),
        pair(1, short(0), short(-7)),
        record(0x027e, &[&words(&[2, 1, 0])[..], &hundredth(25)].concat()),
        number(2, 2, 0, 2.5e-308),
        record(
            0x027e,
            &[&words(&[3, 1, 0])[..], &half.to_le_bytes()].concat(),
        ),
        number(3, 2, style, 1.797_693_134_862_315_7e308),
        // a chart in the worksheet, whose own cells must not be read
        [begin(0x20), number(3, 2, 0, 99.0), record(0x000a, &[])].concat(),
        pair(4, hundredth(75), hundredth(-1)),
        number(5, 1, 0, 1.0),
        record(0x0006, &formula),
    ]
    .concat()
}

const VALUES: [f64; 5] = [
    -7.0,
    2.5e-308,
    1.797_693_134_862_315_7e308,
    -0.01,
    -1.0 / 3.0,
];

fn workbook(style: u16, pad: usize) -> Vec<u8> {
    let globals = [styles(), texts()].concat();
    let mut stream = stream(
        &globals,
        &[("shot", table(style)), ("notes", label(0, 0, 2))],
    );
    stream.resize(stream.len().max(pad), 0);
    compound("Workbook", &stream)
}

#[test]
fn old_workbooks_are_read_to_the_bit() {
    // the workbook in small and in large sectors; a number format with the word seconds in quotes
    // is not that of a date
    for bytes in [workbook(0, 0), workbook(3, 5000)] {
        let contents = format::read_bytes(&bytes).unwrap();
        assert_eq!((contents.format, contents.series.len()), ("xls", 1));
        let series = &contents.series[0];
        let unit = series.ordinate_axis.unit_text.as_str();
        assert_eq!((series.name.as_str(), unit), ("Force", "kN"));
        assert_eq!(series.abscissa, even(0.0, 0.25));
        assert_eq!(series.abscissa_axis.unit_text, "ms");
        assert_eq!(bits(real(&contents, 0)), bits(&VALUES));
        let without = ("worksheet without a table of numbers", "notes");
        let property = &contents.properties[0];
        assert_eq!((property.0.as_str(), property.1.as_str()), without);
    }
}

#[test]
fn a_date_of_an_old_workbook_is_no_number() {
    for style in [1, 2] {
        let error = format::read_bytes(&workbook(style, 0))
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("xls, line 4") && error.contains("`date 1797"),
            "{error}"
        );
    }
}

#[test]
fn what_is_older_or_encrypted_is_refused_with_the_remedy() {
    let old = [record(0x0809, &words(&[0x0500, 5])), record(0x000a, &[])].concat();
    let encrypted = stream(&record(0x002f, &words(&[1])), &[]);
    for (name, stream, said) in [
        ("Workbook", old, "Excel 95"),
        ("Book", vec![0; 10], "Excel 95"),
        ("Workbook", encrypted, "encrypted"),
        ("EncryptedPackage", vec![0; 10], "encrypted"),
        ("WordDocument", vec![0; 10], "not a workbook"),
    ] {
        let error = format::read_bytes(&compound(name, &stream))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(said) && error.contains("saved as .xlsx"),
            "{error}"
        );
    }
    let empty = compound("Workbook", &stream(&[], &[("notes", Vec::new())]));
    assert!(matches!(
        format::read_bytes(&empty),
        Err(LabioError::NoData { format: "xls" })
    ));
}

/// Files cut off after every byte, and with every byte changed, give an error or numbers, but no
/// panic and no endless chain.
#[test]
fn broken_old_workbooks_are_refused() {
    for bytes in [workbook(0, 0), workbook(0, 4096)] {
        // zeros after the last record are not part of it
        let last = bytes.iter().rposition(|byte| *byte != 0).unwrap();
        for end in 0..last {
            assert!(
                Xls.read(&bytes[..end], Strictness::Strict).is_err(),
                "{end}"
            );
        }
        for at in 0..bytes.len() {
            for flip in [0x01, 0x5a, 0xff] {
                let mut changed = bytes.clone();
                changed[at] ^= flip;
                let _ = Xls.read(&changed, Strictness::Tolerant);
            }
        }
    }
}
